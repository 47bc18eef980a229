//! The points of the point-based method: made before the picture, or taken from a file.

use std::path::Path;
use std::time::Instant;

use translucid_image::check_writable;
use translucid_render::{PointCloud, PointProgress, PreparedScene, View, available_memory};
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

/// The scene with the points that a view of it needs, which are kept in a file if one is named.
pub(crate) fn prepare(
    mut prepared: PreparedScene,
    view: &View,
    file: Option<&Path>,
) -> Result<PreparedScene, Failure> {
    if !prepared.wants_points() {
        return Ok(prepared);
    }
    let points = match file.filter(|file| file.exists()) {
        Some(file) => kept(&prepared, view, file)?,
        None => lay(&prepared, view)?,
    };
    let points = if points.is_finished() { points } else { light(&prepared, points, file)? };
    prepared.set_points(&points);
    Ok(prepared)
}

/// The points of a file, whose light may not be finished.
fn kept(prepared: &PreparedScene, view: &View, file: &Path) -> Result<PointCloud, Failure> {
    let points = PointCloud::load(file, prepared.points_fingerprint())?;
    if !prepared.points_serve(&points, view) {
        let message = format!(
            "{}: its points are made for wider pixels, and lie too far apart for this picture",
            file.display()
        );
        return Err(Failure::input(message).with_help("delete it to make the points anew"));
    }
    let state = if points.is_finished() { "" } else { ", whose light is not finished" };
    messages::line(&format!("took {} points from {}{state}", points.len(), file.display()));
    Ok(points)
}

/// Lays points over the surfaces, and says beforehand how many.
fn lay(prepared: &PreparedScene, view: &View) -> Result<PointCloud, Failure> {
    let plan = prepared.plan_points(view);
    let memory = memory(prepared.scene());
    messages::line(&format!("laying {}", plan.describe(prepared.scene())));
    let meter = Meter::new(Unit::Samples);
    let laid = prepared.lay_points(&plan, memory, &|progress| show(&meter, progress), &interrupt::STOP);
    meter.finish();
    laid?.ok_or_else(|| {
        Failure::interrupted(String::from("the points were not laid: repeat the command to make them anew"))
    })
}

/// Finishes the light of points and keeps them, however far it came.
fn light(prepared: &PreparedScene, points: PointCloud, file: Option<&Path>) -> Result<PointCloud, Failure> {
    let start = Instant::now();
    messages::line("light that enters at the points");
    let meter = Meter::new(Unit::Samples);
    let points = prepared.light_points(points, &|progress| show(&meter, progress), &interrupt::STOP);
    meter.finish();
    if points.is_finished() {
        let seconds = duration(start.elapsed().as_secs_f64());
        messages::line(&format!("{} points with their light in {seconds}", points.len()));
    }
    if let Some(file) = file {
        points.save(file).map_err(Failure::late)?;
        messages::line(&format!("kept them in {}", file.display()));
    }
    if points.is_finished() {
        return Ok(points);
    }
    Err(Failure::interrupted(file.map_or_else(
        || String::from("the points were not ready: name a file with --points to keep what there is of them"),
        |file| {
            format!(
                "{} has the points with a part of their light: repeat the command to go on",
                file.display()
            )
        },
    )))
}

fn show(meter: &Meter, PointProgress { part, total, .. }: PointProgress) {
    meter.update((part * total as f64) as u64, total);
}

/// Most memory for points, in bytes: what the scene allows and the machine has.
fn memory(scene: &Scene) -> u64 {
    let allowed = u64::from(scene.integrator.point_memory) << 20;
    available_memory().map_or(allowed, |available| allowed.min(available))
}
