//! `translucid measure`: a material's numbers from a photograph.

mod arguments;
mod page;
mod report;
mod scene_arguments;
mod setup_plates;
mod unfinished_fit;
mod with_scene;

use std::path::Path;

use translucid_files::check_writable;
use translucid_load::load_image;
use translucid_measure::{Experiment, MeasureError, NamedPhoto, Photographs, Remark, spelled};
use translucid_scene::ColorSpace;

pub(crate) use self::arguments::MeasureArguments;
use self::arguments::MeasureFormat;
use self::report::{conversion, layer, material, paragraphs, rows};
use crate::failure::Failure;
use crate::files::write_file;
use crate::messages;
use crate::table::{TableFormat, print};

/// Runs the verb.
pub(crate) fn run(arguments: &MeasureArguments) -> Result<(), Failure> {
    if let Some(path) = &arguments.output {
        check_writable(path)?;
    }
    if let Some(scene) = &arguments.shape.scene {
        return with_scene::run(arguments, scene);
    }
    let experiment = Experiment::new(arguments.options()).map_err(failure)?;
    let photographs = Photographs {
        photo: load(&arguments.photo, arguments)?,
        exposures: arguments.exposure.iter().map(|path| load(path, arguments)).collect::<Result<_, _>>()?,
        dark: arguments.dark.as_ref().map(|path| load(path, arguments)).transpose()?,
        white: arguments.white_photo.as_ref().map(|path| load(path, arguments)).transpose()?,
    };
    let measurement = experiment.measure(photographs, &mut say).map_err(failure)?;
    if let Some(directory) = &arguments.page {
        page::write(directory, &arguments.photo, &measurement)?;
    }
    let quantities = measurement.quantities();
    let text = match arguments.format {
        MeasureFormat::Text => paragraphs(&measurement) + &conversion(&measurement),
        MeasureFormat::Csv => TableFormat::Csv.text(&report::COLUMNS, &rows(&quantities)),
        MeasureFormat::Json => TableFormat::Json.text(&report::COLUMNS, &rows(&quantities)),
        MeasureFormat::Toml => material(&measurement, &arguments.photo),
        MeasureFormat::Layers => layer(&measurement, &arguments.photo)?,
    };
    write(arguments, &text)
}

/// Writes the result where it is wanted.
fn write(arguments: &MeasureArguments, text: &str) -> Result<(), Failure> {
    match &arguments.output {
        Some(path) => write_file(path, text.as_bytes()),
        None => print(text),
    }
}

/// A photograph in linear numbers.
fn load(path: &Path, arguments: &MeasureArguments) -> Result<NamedPhoto, Failure> {
    let color_space = if arguments.linear { ColorSpace::Linear } else { ColorSpace::Srgb };
    let mut warnings = Vec::new();
    let image = load_image(path, color_space, &mut warnings)?;
    messages::print_warnings(&warnings);
    Ok(NamedPhoto::from_image(path.display().to_string(), &image, &mut say))
}

/// Words in which options are those of the command.
fn words(text: &str) -> String {
    spelled(text, |name| format!("--{}", name.replace('_', "-")))
}

/// Prints a remark.
fn say(remark: Remark) {
    match remark {
        Remark::Finding(text) => messages::line(&words(&text)),
        Remark::Note(text) => messages::print_note(&words(&text)),
        Remark::Warning(text) => messages::print_warning(&words(&text)),
    }
}

/// An error as the command prints it.
fn failure(MeasureError { message, place, help }: MeasureError) -> Failure {
    Failure { place, help: help.map(|help| words(&help)), ..Failure::input(words(&message)) }
}
