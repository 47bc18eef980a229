//! The points of the point-based method: made before the picture, or taken from a file.

use std::path::Path;
use std::sync::OnceLock;
use std::time::Instant;

use translucid_image::check_writable;
use translucid_render::{PointCloud, PointPass, PointProgress, Renderer};
use translucid_scene::Scene;

use crate::failure::Failure;
use crate::progress::{Meter, Unit, duration};
use crate::{interrupt, machine, messages};

/// How points are to be made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PointOptions<'a> {
    /// File that they are kept in, if any.
    pub(crate) file: Option<&'a Path>,
    /// Whether to print errors and warnings only.
    pub(crate) quiet: bool,
}

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

/// The renderer with the points that its scene asks for.
pub(crate) fn prepare(renderer: Renderer, options: PointOptions<'_>) -> Result<Renderer, Failure> {
    if !renderer.wants_points() {
        return Ok(renderer);
    }
    let points = match options.file {
        Some(file) if file.exists() => {
            let points = PointCloud::load(file, renderer.points_fingerprint())?;
            if !options.quiet {
                messages::line(&format!("took {} points from {}", points.len(), file.display()));
            }
            points
        }
        _ => make(&renderer, options)?,
    };
    Ok(renderer.with_points(&points))
}

/// Makes the points and keeps them.
fn make(renderer: &Renderer, options: PointOptions<'_>) -> Result<PointCloud, Failure> {
    let start = Instant::now();
    let meter = || {
        if options.quiet { Meter::quiet(Unit::Samples, 0, None) } else { Meter::new(Unit::Samples, 0, None) }
    };
    let meters: [OnceLock<Meter>; 2] = [const { OnceLock::new() }; 2];
    let report = |progress: PointProgress| {
        let pass = usize::from(progress.pass == PointPass::Irradiance);
        let meter = meters[pass].get_or_init(|| {
            meters[0].get().into_iter().for_each(Meter::finish);
            if !options.quiet {
                messages::line(["laying points over surfaces", "light that enters at the points"][pass]);
            }
            meter()
        });
        meter.update(progress.done, progress.total);
    };
    let made = renderer.make_points(memory(renderer.scene()), &report, &interrupt::STOP);
    meters.iter().filter_map(OnceLock::get).for_each(Meter::finish);
    let Some(points) = made.map_err(|error| Failure::input(error.message).with_help(error.help))? else {
        let help = String::from("the points were not ready: repeat the command to make them anew");
        return Err(Failure::Interrupted { help });
    };
    if !options.quiet {
        let seconds = duration(start.elapsed().as_secs_f64());
        messages::line(&format!("{} points with their light in {seconds}", points.len()));
    }
    if let Some(file) = options.file {
        points.save(file).map_err(Failure::late)?;
        if !options.quiet {
            messages::line(&format!("kept them in {}", file.display()));
        }
    }
    Ok(points)
}

/// Most memory for points, in bytes: what the scene allows and the machine has.
fn memory(scene: &Scene) -> u64 {
    let allowed = u64::from(scene.integrator.point_memory) << 20;
    machine::available_memory().map_or(allowed, |available| allowed.min(available))
}
