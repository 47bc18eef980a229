//! A table that can be made: what it holds, and how.

use super::truth::{Fault, Kind, Truth};
use super::{ORACLE_PHOTONS, Steps};
use translucid_words::{Cell, Column};

/// Rows of a table.
pub(super) type Rows = Vec<Vec<Cell>>;

/// A table that can be made.
pub(super) struct Table {
    pub(super) name: &'static str,
    /// Its content in a sentence.
    pub(super) content: &'static str,
    pub(super) method: &'static str,
    /// What its numbers are tested against.
    pub(super) check: &'static str,
    pub(super) columns: Vec<Column>,
    pub(super) source: Source,
}

/// How rows are made.
#[derive(Clone, Copy)]
pub(super) enum Source {
    /// From the light of half spaces: the cells between the medium's and the method's.
    HalfSpaces(fn(&Kind, &Truth<'_>) -> Rows),
    /// On their own, with a number of photons where some walk.
    Own(fn(u64, &Steps<'_>) -> Result<Rows, Fault>),
}

impl Table {
    /// The command that makes it.
    pub(super) fn command(&self, photons: u64) -> String {
        let photons = if photons == ORACLE_PHOTONS { String::new() } else { format!(" --photons {photons}") };
        format!("translucid oracle --only {}{photons} -o DIR", self.name)
    }
}
