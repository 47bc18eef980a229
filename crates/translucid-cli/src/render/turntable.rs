//! Several pictures of what turns once.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Instant;

use translucid_image::Denoiser;
use translucid_scene::SubsurfaceModel;

use super::outputs::Outputs;
use super::picture::{self, Task};
use super::{Arguments, exposure, inputs, note_lamps, require_memory, scene_turned};
use crate::failure::Failure;
use crate::{interrupt, messages};

/// Renders so many pictures at equal angles, all with the exposure of the first.
pub(super) fn run(
    arguments: &Arguments,
    model: Option<SubsurfaceModel>,
    outputs: &Outputs,
    count: u32,
) -> Result<(), Failure> {
    if arguments.watch.stats.is_some() {
        let message = "--stats is for one picture, but --turntable makes several";
        return Err(Failure::input(message).with_help("leave one of them out"));
    }
    let all = (1..=count).map(|number| outputs.numbered(number)).collect::<Result<Vec<_>, _>>()?;
    for outputs in &all {
        outputs.check()?;
        arguments.watch.check(outputs.files())?;
        if arguments.output.is_none() {
            outputs.spare_others()?;
        }
    }
    let denoiser = arguments.denoise.then(Denoiser::load).transpose()?.map(Arc::new);
    let tev = arguments.connect_to_tev()?;
    let exposure = &exposure(arguments);
    for (number, outputs) in all.into_iter().enumerate() {
        if number > 0 && interrupt::STOP.load(Ordering::Relaxed) {
            return Err(Failure::interrupted(Failure::GO_ON));
        }
        let turn = 360.0 * number as f64 / f64::from(count);
        let start = Instant::now();
        let (scene, warnings, _) =
            scene_turned(arguments, model, Some(turn)).map_err(|failure| failure.of_picture(number))?;
        outputs.spare(inputs(arguments, &scene))?;
        arguments.watch.spare(inputs(arguments, &scene))?;
        if number == 0 {
            messages::print_warnings(&warnings);
            note_lamps(arguments, &scene);
            require_memory(&scene)?;
        }
        let denoiser = denoiser.clone();
        let (tev, loading) = (tev.as_ref(), start.elapsed());
        let task = Task { arguments, outputs, denoiser, tev, part: None, exposure, loading };
        picture::render(scene, &task).map_err(|failure| failure.of_picture(number))?;
    }
    Ok(())
}
