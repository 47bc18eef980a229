//! `translucid reference --layers`.

use std::path::Path;

use translucid_desk::{LAYERS, load_layers};
use translucid_profile::Configuration;
use translucid_words::{Cell, Content, Entry, Value};

use super::layers_walk::{TOTAL_COLUMNS, print_walked_totals};
use super::{Method, ReferenceArguments};
use crate::ask::ask;
use crate::failure::Failure;
use crate::messages;
use crate::table::refuse_npz;

const PROFILE_COLUMNS: [&str; 5] =
    ["r", "reflectance", "reflectance_error", "transmittance", "transmittance_error"];

/// Prints profiles at radii, or totals.
pub(super) fn run(arguments: &ReferenceArguments, file: &Path) -> Result<(), Failure> {
    arguments.table.spare(std::iter::once(file))?;
    refuse_npz(arguments.table.file())?;
    if arguments.method == Some(Method::MonteCarlo) {
        if arguments.tolerance.is_some() {
            let message = "--tolerance belongs to the exact solution, not to a walk";
            return Err(Failure::input(message).with_help("a walk has the errors of its --photons"));
        }
        let layers = load_layers(file)?;
        layers.warnings().iter().for_each(|warning| messages::print_warning(warning));
        return print_walked_totals(arguments, file, &layers, arguments.incidence()?);
    }
    if !arguments.absorption.is_empty() {
        return Err(Failure::input(
            "--absorption is for --method monte-carlo, where one walk serves several",
        )
        .with_help("write the coefficients into the file"));
    }
    arguments.walk.refuse_all()?;
    let stated = |key: &str, value: Option<Value>| value.map(|value| Entry::new(key, value));
    let word = |name| Value::from(Configuration::from(name).name());
    let configuration = arguments.configuration.map(word);
    let radii = arguments.radii.iter()?.collect::<Vec<f64>>();
    let entries = [
        stated("layers", file.to_str().map(Value::from)),
        stated("configuration", configuration),
        stated("incidence_angle", arguments.incidence_angle.map(Value::from)),
        stated("tolerance", arguments.tolerance.map(Value::from)),
        stated("r", (!radii.is_empty()).then(|| Content::Numbers(radii.into()).into())),
    ];
    let answer =
        ask(&LAYERS, &entries.into_iter().flatten().collect::<Vec<_>>()).map_err(|failure| Failure {
            // The radii are those of --at, or of --points and --max
            message: failure.message.replace("--r ", "the radii "),
            ..failure
        })?;
    answer.warnings.iter().for_each(|warning| messages::print_warning(warning));
    let table = &answer.tables[0];
    if arguments.radii.count() == 0 {
        // A row for each part
        let parts = table.columns.len() - 1;
        let [row] = &table.rows[..] else { return Err(several(file)) };
        let rows = (0..parts)
            .map(|part| [Cell::from(&*table.columns[part].name), row[part].clone(), row[parts].clone()]);
        return arguments.table.write_cells(TOTAL_COLUMNS, rows);
    }
    if table.rows.len() != arguments.radii.count() {
        return Err(several(file));
    }
    let rows = table.rows.iter().map(|row| std::array::from_fn(|column| row[column].clone()));
    arguments.table.write_cells(PROFILE_COLUMNS, rows)
}

/// The failure of a file whose numbers differ between channels.
fn several(file: &Path) -> Failure {
    let message =
        format!("{} has values over wavelengths or channels, but this takes one number each", file.display());
    Failure::input(message).with_help("translucid stack and translucid layers read it")
}
