//! One scene with each of several models: pictures, their differences, a sheet, a table and a page.

mod files;
mod report;

use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use translucid_image::PixelRect;
use translucid_render::Session;
use translucid_scene::{Film, Scene, SubsurfaceModel};
use translucid_view::comparable;

use super::picture::{self, Part, Rendering, Task};
use super::tev::Tev;
use super::{Arguments, exposure, inputs, scene, scene_name, stem};
use crate::failure::Failure;
use crate::files::Directory;
use crate::model::ModelName;
use crate::{interrupt, messages};
use report::{Entry, Report};

/// Most models of one sheet.
const MOST_MODELS: usize = 16;
/// Most pixels of a picture: what the perceptual difference takes.
const MOST_PIXELS: u64 = 1 << 24;
/// Models that know better than others, the best first.
const JUDGES: [&str; 2] = ["random-walk", "exact"];
/// Memory that a pixel of a picture takes while the others are rendered.
const BYTES_PER_PICTURE_PIXEL: u64 = 64;

/// Renders the scene with each of two or more models, and writes their differences.
pub(super) fn run(arguments: &Arguments, models: &[SubsurfaceModel]) -> Result<(), Failure> {
    require_distinct(models)?;
    let judge = judge(models, arguments.against)?;
    let path = directory_path(arguments)?;
    arguments.watch.check(std::iter::empty())?;
    let tev = arguments.connect_to_tev()?;
    let start = Instant::now();
    let (first, warnings) = scene(arguments, models.first().copied())?;
    let loading = start.elapsed();
    messages::print_warnings(&warnings);
    require_size(&first, models.len())?;
    arguments.watch.spare(inputs(arguments, &first))?;
    Directory::fill(&path, |directory| {
        files::check(directory, models, inputs(arguments, &first))?;
        let entries = render_all(arguments, models, (first, loading), directory, tev.as_ref())?;
        write(arguments, directory, entries, judge)
    })
}

/// Refuses a model that is named twice, and more models than a sheet has room for.
fn require_distinct(models: &[SubsurfaceModel]) -> Result<(), Failure> {
    if models.len() > MOST_MODELS {
        let message =
            format!("--subsurface has {} models, but at most {MOST_MODELS} fit on a sheet", models.len());
        return Err(Failure::input(message));
    }
    match (1..models.len()).find(|&i| models[..i].contains(&models[i])) {
        Some(i) => Err(Failure::input(format!("--subsurface has {} twice", models[i].name()))),
        None => Ok(()),
    }
}

/// Index of the model that the others are compared with.
fn judge(models: &[SubsurfaceModel], against: Option<ModelName>) -> Result<usize, Failure> {
    let position = |name: &str| models.iter().position(|model| model.name() == name);
    let Some(against) = against else {
        return Ok(JUDGES.into_iter().find_map(position).unwrap_or(0));
    };
    let name = against.model().name();
    position(name).ok_or_else(|| {
        let names: Vec<&str> = models.iter().map(|model| model.name()).collect();
        let message = format!("--against is {name}, but must be among those of --subsurface");
        Failure::input(message).with_help(format!("these are: {}", names.join(", ")))
    })
}

/// Directory to write to: that of `-o`, or one named after the scene.
fn directory_path(arguments: &Arguments) -> Result<PathBuf, Failure> {
    let Some(path) = &arguments.output else {
        let mut name = stem(arguments).to_owned();
        name.push("-side-by-side");
        return Ok(name.into());
    };
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    if matches!(extension.as_str(), "exr" | "png") {
        let message =
            format!("--output is the file {}, but several models write to a directory", path.display());
        return Err(Failure::input(message).with_help("name a directory with -o DIR, or one model only"));
    }
    Ok(path.clone())
}

/// Refuses pictures that cannot be compared, or do not fit into memory.
fn require_size(scene: &Scene, models: usize) -> Result<(), Failure> {
    let (width, height) = (scene.film.width, scene.film.height);
    if u64::from(width) * u64::from(height) > MOST_PIXELS {
        let message = format!(
            "the picture has {width}x{height} pixels, but at most {MOST_PIXELS} can be put side by side"
        );
        return Err(Failure::input(message).with_help("choose a smaller --size, or one model"));
    }
    // The film, its first half, and the pictures of all models
    let bytes = 2 * Session::BYTES_PER_PIXEL + models as u64 * BYTES_PER_PICTURE_PIXEL;
    let pixels = PixelRect::whole([scene.film.width, scene.film.height]);
    Session::require_memory(scene, pixels, bytes).map_err(Failure::of_machine)
}

/// Renders the scene with one model after the other.
fn render_all(
    arguments: &Arguments,
    models: &[SubsurfaceModel],
    first: (Scene, Duration),
    directory: &Directory,
    tev: Option<&Tev>,
) -> Result<Vec<Entry>, Failure> {
    let mut loaded = Some(first);
    let mut entries = Vec::new();
    let exposure = &exposure(arguments);
    for (number, &model) in models.iter().enumerate() {
        if interrupt::STOP.load(Ordering::Relaxed) {
            return Err(Failure::interrupted(Failure::GO_ON));
        }
        let start = Instant::now();
        let (scene, loading) = match loaded.take() {
            Some(first) => first,
            // Its warnings are those that the first has had
            None => {
                let (scene, _) =
                    scene(arguments, Some(model)).map_err(|failure| failure.of_picture(number))?;
                (scene, start.elapsed())
            }
        };
        let mut film = scene.film;
        let goal = scene.integrator.samples_per_pixel;
        let part = Part {
            label: format!("{} ({} of {})", model.name(), number + 1, models.len()),
            first_half: files::first_half(directory, model.name()),
        };
        let outputs = files::outputs(directory, model.name());
        let task = Task { arguments, outputs, denoiser: None, tev, part: Some(part), exposure, loading };
        let rendering = picture::render(scene, &task)?;
        film.exposure = exposure.metered().unwrap_or(film.exposure);
        entries.push(entry(model, &rendering, &film, goal));
    }
    Ok(entries)
}

/// The part of a rendering that is compared.
fn entry(model: SubsurfaceModel, rendering: &Rendering, settings: &Film, goal: u32) -> Entry {
    let first_half = rendering.first_half.as_ref().filter(|_| rendering.is_finished);
    Entry {
        model: model.name().to_owned(),
        picture: comparable(&rendering.film, settings),
        first_half: first_half.map(|half| (comparable(half, settings), [half.samples(), goal])),
        samples: rendering.film.samples(),
        seconds: rendering.seconds,
        cpu_seconds: rendering.cpu_seconds,
        is_finished: rendering.is_finished,
    }
}

/// Compares the pictures, writes what that gives, and takes away what was kept for an interruption.
fn write(
    arguments: &Arguments,
    directory: &Directory,
    entries: Vec<Entry>,
    judge: usize,
) -> Result<(), Failure> {
    let unfinished: Vec<bool> = entries.iter().map(|entry| !entry.is_finished).collect();
    let report = Report { scene: scene_name(arguments), entries, judge };
    directory.write(&report.files()?)?;
    for (entry, unfinished) in report.entries.iter().zip(unfinished) {
        if !unfinished && !arguments.resume {
            files::remove_checkpoints(directory, &entry.model);
        }
    }
    let page = directory.file(files::PAGE);
    messages::line(&format!("wrote {}; open {}", directory.path().display(), page.display()));
    Ok(())
}
