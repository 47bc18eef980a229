//! `translucid reference --layers`.

use std::path::Path;

use translucid_laboratory::Cell;
use translucid_reference::Incidence;
use translucid_reference::layers::{Layers, LayersProfile};

use super::layers_file::read_layers;
use super::layers_walk::{TOTAL_COLUMNS, print_walked_totals, refused};
use super::{Method, ReferenceArguments};
use crate::failure::Failure;

const PROFILE_COLUMNS: [&str; 5] =
    ["r", "reflectance", "reflectance_error", "transmittance", "transmittance_error"];

/// Prints profiles at radii, or totals.
pub(super) fn run(arguments: &ReferenceArguments, file: &Path) -> Result<(), Failure> {
    arguments.table.spare(std::iter::once(file))?;
    arguments.table.refuse_npz()?;
    let incidence = arguments.incidence()?;
    let layers = read_layers(file)?;
    if arguments.method == Some(Method::MonteCarlo) {
        return print_walked_totals(arguments, file, &layers, incidence);
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
    let profile = layers.profile().map_err(|error| {
        Failure::input(format!("{} has no exact profile: {error}", file.display())).with_help(
            "leave the radii out for its totals, or walk photons through an .mci file of these layers",
        )
    })?;
    let row = |r: f64| row(&profile, r);
    arguments.table.write(PROFILE_COLUMNS, arguments.radii.iter()?.map(row))
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
    let totals = layers.totals(incidence).map_err(refused)?;
    if totals.error > 1e-2 {
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
