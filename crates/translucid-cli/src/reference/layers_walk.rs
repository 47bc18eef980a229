//! Walks of photons through layers, as the user sees them.

use std::path::Path;
use std::time::Instant;

use translucid_profile::ParameterError;
use translucid_reference::layers::{Grid, Layers, LayersTally, Quantity};
use translucid_reference::walk::Control;
use translucid_reference::{Estimate, Incidence};
use translucid_words::Cell;

use super::ReferenceArguments;
use crate::failure::Failure;
use crate::progress::{Meter, Unit, duration};
use crate::table::exact;
use crate::{interrupt, machine, messages};

/// Columns of totals.
pub(super) const TOTAL_COLUMNS: [&str; 3] = ["part", "value", "error"];

/// Walks with progress, and reports what it took and what was left out.
pub(super) fn watched<T>(
    name: &str,
    photons: u64,
    walk: impl FnOnce(&Control) -> Result<T, ParameterError>,
    tally: impl Fn(&T) -> &LayersTally,
) -> Result<T, ParameterError> {
    let (start, cpu_before) = (Instant::now(), machine::cpu_seconds());
    let meter = Meter::new(Unit::Photons).named(name);
    let control = Control {
        stop: &interrupt::STOP,
        progress: &|done| meter.update(done, photons),
        ..Control::default()
    };
    let result = walk(&control);
    meter.finish();
    let result = result?;
    let cpu = cpu_before
        .zip(machine::cpu_seconds())
        .map_or(String::new(), |(before, after)| format!(" ({:.1} s of CPU)", after - before));
    let (walked, time) = (tally(&result).photons(), duration(start.elapsed().as_secs_f64()));
    messages::line(&format!("{name}: walked {walked} photons in {time}{cpu}"));
    let lost = tally(&result).total(Quantity::Lost).value;
    if lost > 0.0 {
        messages::print_warning(&format!(
            "{name}: {:.2} % of the light was given up after 2^24 collisions, and is in no figure",
            100.0 * lost
        ));
    }
    Ok(result)
}

/// Prints totals of layers under some light.
pub(super) fn print_walked_totals(
    arguments: &ReferenceArguments,
    file: &Path,
    layers: &Layers,
    incidence: Incidence,
) -> Result<(), Failure> {
    arguments.walk.refuse_for_layers(true)?;
    if arguments.radii.count() > 0 {
        return Err(Failure::input("a walk through layers prints totals, and has no radii")
            .with_help("leave the radii out, use --method exact, or an .mci file, whose grid has rings"));
    }
    let Some(photons) = arguments.walk.count() else {
        return Err(Failure::input("--photons is a range, but a walk through layers takes a number"));
    };
    arguments.table.check()?;
    interrupt::catch("\nstopping; press Ctrl-C again to lose the work")?;
    let sets = absorption_sets(arguments, layers.layers().len())?;
    let (grid, seed) = (Grid::TOTALS, arguments.walk.seed());
    let walk = |control: &Control| {
        if sets.is_empty() {
            return layers.walk(incidence, grid, photons, seed, control).map(|tally| vec![tally]);
        }
        layers.walk_absorptions(&sets, incidence, grid, photons, seed, control)
    };
    let tallies =
        watched(&file.display().to_string(), photons, walk, |tallies| &tallies[0]).map_err(refused)?;
    let interrupted = interrupt::settle();
    if tallies[0].photons() == 0 {
        return Err(Failure::interrupted("nothing was walked yet"));
    }
    if sets.is_empty() {
        let rows = parts(&tallies[0]).into_iter().map(|(part, Estimate { value, error })| {
            [Cell::Word(part), Cell::Number(value), Cell::Number(error)]
        });
        arguments.table.write_cells(TOTAL_COLUMNS, rows)?;
    } else {
        let rows = arguments.absorption.iter().zip(&tallies).flat_map(|(set, tally)| {
            parts(tally).into_iter().map(move |(part, Estimate { value, error })| {
                [Cell::from(set.as_str()), Cell::Word(part), Cell::Number(value), Cell::Number(error)]
            })
        });
        let [part, value, error] = TOTAL_COLUMNS;
        arguments.table.write_cells(["absorption", part, value, error], rows)?;
    }
    if interrupted {
        return Err(Failure::interrupted(format!("the table is that of {} photons", tallies[0].photons())));
    }
    Ok(())
}

/// Figures of a walk by their names.
fn parts(tally: &LayersTally) -> Vec<(String, Estimate)> {
    let reflected = tally.total(Quantity::Reflected);
    let reflected = Estimate { value: tally.specular() + reflected.value, ..reflected };
    let mut parts = vec![
        (String::from("reflectance"), reflected),
        (String::from("transmittance"), tally.total(Quantity::Transmitted)),
    ];
    let absorbed = tally.all(Quantity::AbsorbedByLayer).enumerate();
    parts.extend(absorbed.map(|(i, part)| (format!("absorbed_by_layer_{}", i + 1), part)));
    parts.push((String::from("absorbed_by_ground"), tally.total(Quantity::Ground)));
    parts
}

/// The sets of --absorption, each of a coefficient for each layer.
fn absorption_sets(arguments: &ReferenceArguments, layers: usize) -> Result<Vec<Vec<f64>>, Failure> {
    let read = |text: &String| {
        let numbers: Option<Vec<f64>> = text.split(',').map(|word| word.trim().parse().ok()).collect();
        numbers.filter(|numbers| numbers.len() == layers).ok_or_else(|| {
            Failure::input(format!(
                "--absorption is {text}, but must be {layers} numbers with commas between"
            ))
            .with_help("give one for each layer, from top to bottom")
        })
    };
    arguments.absorption.iter().map(read).collect()
}

/// The error of a parameter of layers or of light on them.
pub(super) fn refused(error: ParameterError) -> Failure {
    let (parameter, value) = (error.parameter, exact(error.value));
    let failure = Failure::input(format!("{parameter} is {value}, but must be {}", error.requirement()));
    if parameter == "cos_theta" {
        return failure.with_help("cos_theta is the cosine of --incidence-angle: choose a smaller angle");
    }
    failure
}
