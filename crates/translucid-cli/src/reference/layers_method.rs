//! `translucid reference --layers`.

use std::cell;
use std::path::Path;

use translucid_laboratory::Cell;
use translucid_reference::Incidence;
use translucid_reference::layers::{Layers, LayersProfile};
use translucid_reference::walk::Control;

use super::layers_file::read_layers;
use super::layers_walk::{TOTAL_COLUMNS, print_walked_totals, refused};
use super::{Method, ReferenceArguments};
use crate::failure::Failure;
use crate::progress::{Meter, Unit};
use crate::{interrupt, messages};

const PROFILE_COLUMNS: [&str; 5] =
    ["r", "reflectance", "reflectance_error", "transmittance", "transmittance_error"];

/// Prints profiles at radii, or totals.
pub(super) fn run(arguments: &ReferenceArguments, file: &Path) -> Result<(), Failure> {
    arguments.table.spare(std::iter::once(file))?;
    arguments.table.refuse_npz()?;
    let incidence = arguments.incidence()?;
    let layers = read_layers(file)?;
    if arguments.method == Some(Method::MonteCarlo) {
        if arguments.tolerance.is_some() {
            let message = "--tolerance belongs to the exact solution, not to a walk";
            return Err(Failure::input(message).with_help("a walk has the errors of its --photons"));
        }
        return print_walked_totals(arguments, file, &layers, incidence);
    }
    if !arguments.absorption.is_empty() {
        return Err(Failure::input(
            "--absorption is for --method monte-carlo, where one walk serves several",
        )
        .with_help("write the coefficients into the file"));
    }
    arguments.walk.refuse_all()?;
    if arguments.radii.count() == 0 {
        return print_totals(arguments, &layers, incidence);
    }
    if incidence != Incidence::NORMAL {
        return Err(Failure::input("profiles of layers are those of a searchlight along the normal")
            .with_help("leave the radii out for totals under any light"));
    }
    drop(arguments.radii.iter()?);
    let profile = solved(|control| {
        layers.profile_within(arguments.tolerance.unwrap_or(1e-4), control).map_err(|error| {
            if error.error.parameter == "tolerance" {
                return refused(error.error);
            }
            Failure::input(format!("{} has no exact profile: {error}", file.display())).with_help(
                "leave the radii out for its totals, or walk photons through an .mci file of these layers",
            )
        })
    })?;
    let unknown = cell::Cell::new(0);
    let row = |r: f64| {
        let row = row(&profile, r);
        let [_, reflectance, error, transmittance, other] = row;
        if error > 0.0 && error >= reflectance || other > 0.0 && other >= transmittance {
            unknown.set(unknown.get() + 1);
        }
        row
    };
    arguments.table.write(PROFILE_COLUMNS, arguments.radii.iter()?.map(row))?;
    if unknown.get() > 0 {
        let (count, all) = (unknown.get(), arguments.radii.count());
        messages::print_warning(&format!(
            "at {count} of {all} radii an error is as large as its value: hardly any light is left there, or too little is known"
        ));
    }
    Ok(())
}

/// Solves with progress, unless Ctrl-C ends it.
fn solved<T>(solve: impl FnOnce(&Control) -> Result<Option<T>, Failure>) -> Result<T, Failure> {
    interrupt::catch("\nstopping")?;
    let meter = Meter::new(Unit::Parts);
    let progress = |part| meter.update(part, 1000);
    let outcome = solve(&Control { stop: &interrupt::STOP, progress: &progress, ..Control::default() });
    meter.finish();
    outcome?.ok_or_else(|| Failure::interrupted("nothing was written"))
}

fn row(profile: &LayersProfile, r: f64) -> [f64; 5] {
    let (reflectance, transmittance) = (profile.reflectance(r), profile.transmittance(r));
    [r, reflectance.value, reflectance.error, transmittance.value, transmittance.error]
}

fn print_totals(
    arguments: &ReferenceArguments,
    layers: &Layers,
    incidence: Incidence,
) -> Result<(), Failure> {
    let totals = solved(|control| {
        let tolerance = arguments.tolerance.unwrap_or(1e-6);
        layers.totals_within(tolerance, incidence, control).map_err(refused)
    })?;
    if totals.error > arguments.tolerance.unwrap_or(0.0).max(1e-2) {
        return Err(Failure::work(
            "these layers have no exact solution: their coefficients are too far apart",
        )
        .with_help("try --method monte-carlo"));
    }
    let mut parts = vec![
        (String::from("specular_reflectance"), totals.specular_reflectance),
        (String::from("diffuse_reflectance"), totals.diffuse_reflectance),
        (String::from("collimated_transmittance"), totals.collimated_transmittance),
        (String::from("diffuse_transmittance"), totals.diffuse_transmittance),
    ];
    let absorbed = totals.absorbed.iter().enumerate();
    parts.extend(absorbed.map(|(i, part)| (format!("absorbed_by_layer_{}", i + 1), *part)));
    parts.push((String::from("absorbed_by_ground"), totals.absorbed_by_ground));
    let rows = parts
        .into_iter()
        .map(|(part, value)| [Cell::Word(part), Cell::Number(value), Cell::Number(totals.error)]);
    arguments.table.write_cells(TOTAL_COLUMNS, rows)
}
