//! The points of the point-based method, made before the picture.

use std::time::Instant;

use translucid_render::{PointPass, PointProgress, PreparedScene, View, available_memory};

use crate::failure::Failure;
use crate::progress::{Meter, Unit, duration};
use crate::{interrupt, messages};

/// The scene with the points that a view of it needs, within the memory that the scene allows and the machine has.
pub(crate) fn prepare(mut prepared: PreparedScene, view: &View) -> Result<PreparedScene, Failure> {
    if !prepared.wants_points() {
        return Ok(prepared);
    }
    let start = Instant::now();
    let allowed = u64::from(prepared.scene().integrator.point_memory) << 20;
    let memory = available_memory().map_or(allowed, |available| allowed.min(available));
    messages::line("laying points over the surfaces and computing the light that enters there");
    let meter = Meter::new(Unit::Samples).named("points");
    let show = |PointProgress { pass, part, total }: PointProgress| {
        // Laying the points takes a small part of the time
        if pass == PointPass::Irradiance {
            meter.update((part * total as f64) as u64, total);
        }
    };
    let points = prepared.make_points(view, memory, &show, &interrupt::STOP);
    meter.finish();
    let Some(points) = points? else {
        return Err(Failure::interrupted("the points were not ready, so nothing was written"));
    };
    let seconds = duration(start.elapsed().as_secs_f64());
    messages::line(&format!("{} points with their light in {seconds}", points.len()));
    prepared.set_points(&points);
    Ok(prepared)
}
