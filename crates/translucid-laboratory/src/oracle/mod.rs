//! Oracle tables: the light of media as files, for tests of other programs.
//!
//! ```text
//! lit_shape.rs   light beside an edge, a disk and a line of light on a plane, by any profile
//! truth.rs       media whose light is known: exactly, by discrete directions, or by photons
//! table.rs       a table that can be made
//! tables.rs      all of them: their columns, rows and checks
//! text.rs        their files
//! ```
//!
//! # Units
//! Lengths are mean free paths: a medium of another one has the response of an edge at x/ℓ, and the profile R(r/ℓ)/ℓ².

mod lit_shape;
mod table;
mod tables;
mod text;
mod truth;

use std::sync::atomic::Ordering;

use rayon::prelude::*;

pub use self::lit_shape::{LitShape, Spread};
use self::table::{Rows, Source, Table};
pub use self::text::SCHEMA_FILE;
use self::truth::{Fault, Kind, Truth};
use crate::comparison::{Stopped, Watch};
use translucid_words::{Cell, DataTable};

use crate::data_table::row;

/// Photons for each kind of half space that is walked, and a tenth of them for each sphere: as many as take a minute or two.
pub const ORACLE_PHOTONS: u64 = 2_000_000;

/// A table as its files.
#[derive(Clone, Debug, PartialEq)]
pub struct OracleTable {
    /// Name of the table, and of its files before their endings.
    pub name: &'static str,
    /// Rows.
    pub data: DataTable,
    /// The table as a JSON document, with the meaning of its columns and the way in which it was made.
    pub json: String,
}

/// Names of all tables.
pub fn oracle_names() -> Vec<&'static str> {
    tables::all().iter().map(|table| table.name).collect()
}

/// JSON schema of the documents.
pub fn oracle_schema() -> String {
    text::schema(&tables::all())
}

/// Makes the tables of some names, in their own order; the same bits for the same number of photons.
///
/// # Errors
/// The work was stopped.
pub fn oracle_tables(names: &[&str], photons: u64, watch: Watch<'_>) -> Result<Vec<OracleTable>, Stopped> {
    let tables: Vec<Table> = tables::all().into_iter().filter(|table| names.contains(&table.name)).collect();
    let of_half_spaces = tables.iter().filter(|table| matches!(table.source, Source::HalfSpaces(_))).count();
    let pieces = (tables.len() - of_half_spaces + usize::from(of_half_spaces > 0)).max(1) as f64;
    let mut done = 0.0;
    // Half spaces are solved once for all tables that they are in
    let mut half_spaces = Vec::new();
    if of_half_spaces > 0 {
        let progress = |part: f64| (watch.progress)(part / pieces);
        let steps = Steps { watch: Watch { progress: &progress, ..watch } };
        half_spaces = rows_of_half_spaces(&tables, photons, &steps)?;
        done = 1.0;
    }
    let mut made = Vec::new();
    let mut half_spaces = half_spaces.into_iter();
    for table in &tables {
        let rows = match table.source {
            Source::HalfSpaces(_) => half_spaces.next().unwrap_or_default(),
            Source::Own(rows) => {
                let before = done;
                done += 1.0;
                let progress = |part: f64| (watch.progress)((before + part) / pieces);
                let steps = Steps { watch: Watch { progress: &progress, ..watch } };
                rows((photons / 10).max(1), &steps)?
            }
        };
        let data = DataTable {
            name: table.name.to_owned(),
            caption: table.content.to_owned(),
            columns: table.columns.clone(),
            rows,
        };
        let json = text::json(table, &data, photons);
        made.push(OracleTable { name: table.name, data, json });
    }
    Ok(made)
}

impl From<Fault> for Stopped {
    /// Parameters of the tables are within all ranges: what is left is that somebody has stopped the work.
    fn from(fault: Fault) -> Self {
        debug_assert_eq!(fault, Fault::Stopped);
        Self
    }
}

/// Work in steps that somebody watches.
struct Steps<'a> {
    watch: Watch<'a>,
}

impl Steps<'_> {
    /// Works on each item, on all threads, unless that is stopped; results are in the order of the items.
    fn each<T: Sync, R: Send>(
        &self,
        items: &[T],
        work: impl Fn(&T) -> Result<R, Fault> + Sync,
    ) -> Result<Vec<R>, Fault> {
        let done = std::sync::atomic::AtomicUsize::new(0);
        let step = |item: &T| {
            if self.watch.stop.load(Ordering::Relaxed) {
                return Err(Fault::Stopped);
            }
            let result = work(item);
            (self.watch.progress)((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / items.len() as f64);
            result
        };
        items.par_iter().map(step).collect()
    }
}

/// Rows of all tables of half spaces.
fn rows_of_half_spaces(tables: &[Table], photons: u64, steps: &Steps<'_>) -> Result<Vec<Rows>, Fault> {
    let sources: Vec<fn(&Kind, &Truth<'_>) -> Rows> = tables
        .iter()
        .filter_map(|table| match table.source {
            Source::HalfSpaces(rows) => Some(rows),
            Source::Own(_) => None,
        })
        .collect();
    let of_kind = |kind: &Kind| {
        let albedos = kind.surface_albedos();
        let alphas = kind.media(albedos)?;
        let greatest = alphas.iter().copied().fold(0.0, f64::max);
        let silent = Watch { stop: steps.watch.stop, ..Watch::default() };
        let walk = if kind.is_exact() { None } else { Some(kind.walk(greatest, photons, &silent)?) };
        let of_medium = |(a, alpha): (&f64, &f64)| {
            if steps.watch.stop.load(Ordering::Relaxed) {
                return Err(Fault::Stopped);
            }
            let truth = Truth::of(kind, *alpha, walk.as_ref())?;
            let head = row![kind.configuration.name(), kind.g, kind.eta, *a, text::number(*alpha)];
            let whole = |own: Rows| -> Rows {
                let row = |own: Vec<_>| [&head[..], &own[..], &[Cell::from(truth.method())]].concat();
                own.into_iter().map(row).collect()
            };
            Ok(sources.iter().map(|rows| whole(rows(kind, &truth))).collect::<Vec<Rows>>())
        };
        albedos.par_iter().zip(&alphas).map(of_medium).collect::<Result<Vec<Vec<Rows>>, Fault>>()
    };
    let media: Vec<Vec<Rows>> = steps.each(&Kind::all(), of_kind)?.concat();
    Ok((0..sources.len()).map(|table| media.iter().flat_map(|rows| rows[table].clone()).collect()).collect())
}

#[cfg(test)]
mod tests;
