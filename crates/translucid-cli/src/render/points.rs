//! The points of the point-based method: made before the picture, or taken from a file.

use std::path::Path;
use std::sync::OnceLock;
use std::time::Instant;

use translucid_image::check_writable;
use translucid_render::{PointCloud, PointPass, PointProgress, PreparedScene, available_memory};
use translucid_scene::Scene;

use crate::failure::Failure;
use crate::progress::{Meter, Unit, duration};
use crate::{interrupt, messages};

/// Finds out before the work whether points can be kept where they shall be.
pub(crate) fn check(scene: &Scene, file: Option<&Path>) -> Result<(), Failure> {
    use translucid_scene::SubsurfaceMethod::PointBased;

    let Some(file) = file else { return Ok(()) };
    let method = scene.integrator.subsurface_method;
    if method != PointBased {
        let message = format!("--points is given, but the method is {}", method.name());
        return Err(
            Failure::input(message).with_help("add --subsurface-method point-based, or leave --points out")
        );
    }
    if !file.exists() {
        check_writable(file)?;
    }
    Ok(())
}

/// The scene with the points that it asks for, which are kept in a file if one is named.
pub(crate) fn prepare(mut prepared: PreparedScene, file: Option<&Path>) -> Result<PreparedScene, Failure> {
    if !prepared.wants_points() {
        return Ok(prepared);
    }
    let points = match file {
        Some(file) if file.exists() => {
            let points = PointCloud::load(file, prepared.points_fingerprint())?;
            messages::line(&format!("took {} points from {}", points.len(), file.display()));
            points
        }
        _ => make(&prepared, file)?,
    };
    prepared.set_points(&points);
    Ok(prepared)
}

/// Makes the points and keeps them.
fn make(prepared: &PreparedScene, file: Option<&Path>) -> Result<PointCloud, Failure> {
    let start = Instant::now();
    let meters: [OnceLock<Meter>; 2] = [const { OnceLock::new() }; 2];
    let report = |progress: PointProgress| {
        let pass = usize::from(progress.pass == PointPass::Irradiance);
        let meter = meters[pass].get_or_init(|| {
            meters[0].get().into_iter().for_each(Meter::finish);
            messages::line(["laying points over surfaces", "light that enters at the points"][pass]);
            Meter::new(Unit::Samples)
        });
        meter.update(progress.done, progress.total);
    };
    let made = prepared.make_points(memory(prepared.scene()), &report, &interrupt::STOP);
    meters.iter().filter_map(OnceLock::get).for_each(Meter::finish);
    let Some(points) = made? else {
        let help = String::from("the points were not ready: repeat the command to make them anew");
        return Err(Failure::interrupted(help));
    };
    let seconds = duration(start.elapsed().as_secs_f64());
    messages::line(&format!("{} points with their light in {seconds}", points.len()));
    if let Some(file) = file {
        points.save(file).map_err(Failure::late)?;
        messages::line(&format!("kept them in {}", file.display()));
    }
    Ok(points)
}

/// Most memory for points, in bytes: what the scene allows and the machine has.
fn memory(scene: &Scene) -> u64 {
    let allowed = u64::from(scene.integrator.point_memory) << 20;
    available_memory().map_or(allowed, |available| allowed.min(available))
}
