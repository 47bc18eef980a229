//! `translucid measure PHOTO --scene SCENE`: parameters of a scene whose picture is the photograph.

use std::fs;
use std::path::{Path, PathBuf};

use translucid_files::{OutputError, check_writable};
use translucid_measure::{Quantity, SceneFit, SceneOptions, StepEnd, Unknown, three_digits};
use translucid_scene::{Scene, Warning};

use super::arguments::{MeasureArguments, MeasureFormat};
use super::report::{COLUMNS, channel, keys, rows, with_interval};
use super::scene_arguments::SceneArguments;
use super::unfinished_fit::{load_progress, save_progress};
use super::{failure, load, say, write};
use crate::failure::Failure;
use crate::files::input_among;
use crate::model::ModelName;
use crate::output_lock::OutputLock;
use crate::progress::{Meter, Unit};
use crate::table::TableFormat;
use crate::{interrupt, machine, messages, render};

/// Runs the verb with a scene.
pub(super) fn run(arguments: &MeasureArguments, scene: &Path) -> Result<(), Failure> {
    machine::threads(arguments.shape.threads)?.install(|| run_here(arguments, scene))
}

fn run_here(arguments: &MeasureArguments, scene_path: &Path) -> Result<(), Failure> {
    let shape = &arguments.shape;
    let options = SceneOptions {
        unknowns: Unknown::of_names(&shape.fit).map_err(failure)?,
        material: shape.material.clone(),
        region: arguments.region,
        seed: shape.seed.unwrap_or(0),
    };
    let photo = load(&arguments.photo, arguments)?;
    let (scene, warnings) = scene(shape, scene_path)?;
    messages::print_warnings(&warnings);
    let checkpoint = checkpoint(arguments, scene_path)?;
    let _lock = OutputLock::take(&checkpoint)?;
    render::require_memory(&scene)?;
    let mut fit = SceneFit::new(&photo, scene, &options).map_err(failure)?;
    interrupt::catch("\nstopping; press Ctrl-C again to lose the work")?;
    fit.scene().notes().iter().for_each(|note| messages::print_note(&note.to_string()));
    go_on(&mut fit, &checkpoint, shape.resume)?;
    find(&mut fit, &checkpoint)?;
    fit.limitations().into_iter().for_each(say);
    let quantities = fit.quantities();
    let text = match arguments.format {
        MeasureFormat::Text => paragraphs(&fit, &quantities),
        MeasureFormat::Csv => TableFormat::Csv.text(&COLUMNS, &rows(&quantities)),
        MeasureFormat::Json => TableFormat::Json.text(&COLUMNS, &rows(&quantities)),
        MeasureFormat::Toml => material(&fit),
        MeasureFormat::Layers => {
            return Err(Failure::input("--format layers is for photographs without --scene"));
        }
    };
    write(arguments, &text)
}

fn scene(shape: &SceneArguments, path: &Path) -> Result<(Scene, Vec<Warning>), Failure> {
    let mut arguments = render::Arguments::default();
    arguments.scene = Some(path.to_owned());
    arguments.mesh.clone_from(&shape.mesh);
    arguments.spp = shape.spp;
    render::scene(&arguments, shape.subsurface.map(ModelName::model))
}

/// The file that keeps the fit while it is not finished.
fn checkpoint(arguments: &MeasureArguments, scene: &Path) -> Result<PathBuf, Failure> {
    let by_default = || {
        let mut name = arguments.photo.file_name().unwrap_or_default().to_owned();
        name.push(".fit");
        PathBuf::from(name)
    };
    let checkpoint = arguments.shape.checkpoint.clone().unwrap_or_else(by_default);
    let inputs = [arguments.photo.as_path(), scene].into_iter();
    let outputs = [checkpoint.as_path()].into_iter().chain(arguments.output.as_deref());
    if let Some(path) = input_among(outputs, inputs) {
        let message = "is a file that is read, and would be written over";
        return Err(OutputError::new(path, message).into());
    }
    check_writable(&checkpoint)?;
    Ok(checkpoint)
}

/// Takes up an unfinished fit, if that is wanted and there is one.
fn go_on(fit: &mut SceneFit, path: &Path, resume: bool) -> Result<(), Failure> {
    if !path.exists() {
        if resume {
            messages::line(&format!("there is no {} yet: starting anew", path.display()));
        }
        return Ok(());
    }
    let progress = load_progress(path)?;
    if !resume {
        let message =
            format!("the unfinished fit {} will be replaced; --resume goes on from it", path.display());
        messages::print_note(&message);
        return Ok(());
    }
    fit.resume(progress.of(path, fit.fingerprint())?);
    Ok(())
}

/// Renders until the parameters are found, and keeps how far it is after each step.
fn find(fit: &mut SceneFit, checkpoint: &Path) -> Result<(), Failure> {
    let meter = Meter::new(Unit::Samples).between(fit.paths_traced(), None);
    loop {
        let end = fit.step(&|done, expected| meter.update(done, expected), &interrupt::STOP);
        let end = end.map_err(failure)?;
        if end != StepEnd::Found {
            save_progress(checkpoint, fit.fingerprint(), &fit.progress()).map_err(Failure::late)?;
        }
        match end {
            StepEnd::Found => break,
            StepEnd::Stopped => {
                meter.finish();
                interrupt::settle();
                let help = format!("repeat the command with --resume to go on from {}", checkpoint.display());
                return Err(Failure::interrupted(help));
            }
            StepEnd::Moved if messages::is_verbose() => {
                let shown = |quantity: &Quantity| {
                    format!("{} {} {}", channel(quantity), quantity.name, with_interval(quantity.interval))
                };
                let shown: Vec<String> = fit.quantities().iter().map(shown).collect();
                let text = format!("step {}: {}", fit.progress().steps, shown.join(", "));
                meter.suspend(|| messages::line(&text));
            }
            StepEnd::Moved => {}
        }
    }
    meter.finish();
    let _ = fs::remove_file(checkpoint);
    Ok(())
}

fn paragraphs(fit: &SceneFit, quantities: &[Quantity]) -> String {
    let line = |quantity: &Quantity| {
        format!("{:<6} {:<14} {}\n", channel(quantity), quantity.name, with_interval(quantity.interval))
    };
    let lines: String = quantities.iter().map(line).collect();
    format!(
        "{lines}\nIn parentheses the 95 % confidence interval; lengths in the scene's unit. {} steps.\n",
        fit.progress().steps
    )
}

/// The material for scene files.
fn material(fit: &SceneFit) -> String {
    let guess = fit.guess();
    let unit = fit.scene().scene().unit.name();
    let keys = keys(unit, &fit.material().name, guess.surface_albedo, guess.mfp);
    format!("{keys}subsurface_scatter_anisotropy = {}\n", three_digits(guess.g))
}
