//! Photons of one white table added to another's.

use std::ops::Range;

use super::super::orders::Cell;
use super::super::photon_exit::PhotonCounts;
use super::super::photon_ranges::{PhotonRange, PhotonRanges};
use super::super::problem::Parameters;
use super::super::table_error::TableError;
use super::{MACHINE, WhiteTable};
use crate::phase_function::PhaseFunction;

impl WhiteTable {
    /// Adds the photons of another table, exactly.
    ///
    /// # Errors
    /// The tables differ in problem, layout or reference albedo, or share photons. `self` is then unchanged.
    pub fn merge(&mut self, other: &Self) -> Result<(), TableError> {
        self.require_same_walk(other)?;
        self.add(&other.ranges, other.counts, &other.cells)
    }

    /// Refuses another table unless all of both walks but the photons is the same.
    fn require_same_walk(&self, other: &Self) -> Result<(), TableError> {
        let pairs = self.walk_in_words().into_iter().zip(other.walk_in_words());
        match pairs.into_iter().find(|(here, there)| here != there) {
            Some(((what, here), (_, there))) => Err(TableError::Differs { what, here, there }),
            None => Ok(()),
        }
    }

    /// Names and values of all that two walks may differ in.
    fn walk_in_words(&self) -> Vec<(&'static str, String)> {
        let Parameters { phase_function, eta, thickness, incidence, spot_radius } = self.problem.parameters();
        let (layout, bins) = (&self.layout, self.layout.order_bins());
        let numbers = phase_function.numbers();
        let name = match phase_function {
            PhaseFunction::Moments(_) | PhaseFunction::Table(_) => {
                format!("{} of {} numbers", phase_function.name(), numbers.len())
            }
            named => format!("{named:?}"),
        };
        let mut words = vec![("phase function", name)];
        words.extend(numbers.iter().map(|number| ("a number of the phase function", number.to_string())));
        words.extend([
            ("entry", format!("{incidence:?}")),
            ("eta", eta.to_string()),
            ("thickness", thickness.to_string()),
            ("spot radius", spot_radius.to_string()),
            ("reference albedo", self.reference_albedo.to_string()),
            (MACHINE, self.machine.name().to_owned()),
            ("the number of radii", layout.radii().len().to_string()),
            ("the number of sectors", layout.sectors().to_string()),
            ("the number of bins of orders of scattering", bins.len().to_string()),
        ]);
        words.extend(layout.radii().iter().map(|radius| ("a radius of the layout", radius.to_string())));
        words.extend(bins.first_orders().map(|first| ("the first order of a bin", first.to_string())));
        words
    }

    /// Adds the photons of a run: pieces of a seed that are new, and cells, as a whole or none (an empty list).
    ///
    /// # Errors
    /// A number does not fit. `self` is then unchanged.
    pub(crate) fn take_in(
        &mut self,
        seed: u64,
        done: &[(Range<u64>, PhotonCounts)],
        tallies: Vec<Vec<Cell>>,
    ) -> Result<(), TableError> {
        let (mut ranges, mut counts) = (Vec::new(), PhotonCounts::default());
        for (piece, more) in done {
            ranges.push(PhotonRange { seed, start: piece.start, end: piece.end });
            counts = counts.checked_add(*more).ok_or(TableError::TooMany)?;
        }
        let mut tallies = tallies.into_iter().filter(|tally| !tally.is_empty());
        let Some(mut cells) = tallies.next() else { return Ok(()) };
        tallies.try_for_each(|tally| add_cells(&mut cells, &tally)).ok_or(TableError::TooMany)?;
        let ranges = PhotonRanges::new(ranges).map_err(TableError::Repeated)?;
        self.add(&ranges, counts, &cells)
    }

    /// Adds photons, all or none.
    fn add(&mut self, ranges: &PhotonRanges, counts: PhotonCounts, cells: &[Cell]) -> Result<(), TableError> {
        let ranges = self.ranges.union(ranges).map_err(TableError::Repeated)?;
        let counts = self.counts.checked_add(counts).ok_or(TableError::TooMany)?;
        add_cells(&mut self.cells, cells).ok_or(TableError::TooMany)?;
        (self.ranges, self.counts) = (ranges, counts);
        Ok(())
    }
}

/// Adds cell by cell: all, or nothing where a number does not fit.
fn add_cells(cells: &mut [Cell], more: &[Cell]) -> Option<()> {
    cells.iter().zip(more).try_for_each(|(cell, more)| cell.checked_add(*more).map(drop))?;
    for (cell, more) in cells.iter_mut().zip(more) {
        cell.count += more.count;
        cell.order_sum += more.order_sum;
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::super::super::{Control, Layout, OrderBins, PhaseFunction, Problem, Region, Side, trace};
    use super::*;
    use crate::Incidence;

    fn table(radii: &[f64], sectors: u32, reference_albedo: f64) -> WhiteTable {
        let layout = Layout::with_order_bins(radii, sectors, OrderBins::new(0.125).unwrap()).unwrap();
        WhiteTable::new(Problem::new(Parameters::default()).unwrap(), layout, reference_albedo).unwrap()
    }

    fn after(mut table: WhiteTable, seed: u64, photons: u64) -> WhiteTable {
        table.run(seed, photons, &Control::default()).unwrap();
        table
    }

    #[test]
    fn merged_tables_are_the_table_of_all_photons() {
        let empty = table(&[0.1, 1.0], 2, 0.95);
        let whole = after(after(empty.clone(), 1, 7000), 2, 2000);
        let first = after(empty.clone(), 1, 3000);
        let rest = {
            let mut rest = after(empty.clone(), 2, 2000);
            let done = [(3000..7000, trace(&rest.problem, 0.95, 1, 3000..7000, &mut |_| {}))];
            let mut cells = vec![Cell::default(); rest.cells.len()];
            trace(&rest.problem, 0.95, 1, 3000..7000, &mut |exits| {
                for exit in exits {
                    let cell = &mut cells[rest.cell_index(exit) as usize];
                    cell.count += 1;
                    cell.order_sum += u64::from(exit.order);
                }
            });
            rest.take_in(1, &done, vec![cells]).unwrap();
            rest
        };
        let (mut one, mut other) = (first.clone(), rest.clone());
        one.merge(&rest).unwrap();
        other.merge(&first).unwrap();
        assert_eq!(one, whole);
        assert_eq!(other, whole);
        assert_eq!(whole.photons(), 9000);
        let exits = whole.exits(Side::Reflected, Region::Everywhere);
        assert_eq!(exits + whole.counts.absorbed, 9000);
    }

    #[test]
    fn merge_refuses_photons_that_it_holds() {
        let empty = table(&[1.0], 1, 0.5);
        let (mut a, b) = (after(empty.clone(), 1, 3000), after(after(empty, 2, 10), 1, 20));
        let before = a.clone();
        let error = a.merge(&b).unwrap_err();
        assert_eq!(error.to_string(), "photons 0..20 of seed 1 would count twice");
        assert_eq!(a, before);
    }

    #[test]
    fn merge_says_in_what_tables_differ() {
        let make = |parameters, radii: &[f64], sectors, growth, albedo| {
            let bins = OrderBins::new(growth).unwrap();
            let layout = Layout::with_order_bins(radii, sectors, bins).unwrap();
            WhiteTable::new(Problem::new(parameters).unwrap(), layout, albedo).unwrap()
        };
        let base = Parameters::default();
        let hg = PhaseFunction::HenyeyGreenstein { g: 0.5 };
        let moments = |numbers: &[f64]| PhaseFunction::Moments(numbers.into());
        let with = |numbers: &[f64]| {
            make(Parameters { phase_function: moments(numbers), ..base.clone() }, &[1.0], 1, 0.1, 0.9)
        };
        let error = with(&[0.3, 0.1]).merge(&with(&[0.3, 0.11])).unwrap_err().to_string();
        assert!(error.contains("a number of the phase function: 0.1 in one, 0.11 in the other"), "{error}");
        for (other, expected) in [
            (
                make(Parameters { eta: 1.4, ..base.clone() }, &[1.0], 1, 0.1, 0.9),
                "the tables differ in eta: 1 in one, 1.4 in the other",
            ),
            (
                make(Parameters { thickness: 2.0, ..base.clone() }, &[1.0], 1, 0.1, 0.9),
                "thickness: inf in one, 2 in",
            ),
            (
                make(Parameters { spot_radius: 2.0, ..base.clone() }, &[1.0], 1, 0.1, 0.9),
                "spot radius: 0 in one, 2 in",
            ),
            (
                make(Parameters { incidence: Incidence::Cosine, ..base.clone() }, &[1.0], 1, 0.1, 0.9),
                "entry: Pencil",
            ),
            (
                make(Parameters { phase_function: hg, ..base.clone() }, &[1.0], 1, 0.1, 0.9),
                "phase function: Henyey",
            ),
            (
                with(&[0.3]),
                "phase function: HenyeyGreenstein { g: 0.0 } in one, moments of 1 numbers in the other",
            ),
            (make(base.clone(), &[1.5], 1, 0.1, 0.9), "a radius of the layout: 1 in one, 1.5 in"),
            (make(base.clone(), &[1.0, 1.5], 1, 0.1, 0.9), "the number of radii: 1 in one, 2 in"),
            (make(base.clone(), &[1.0], 2, 0.1, 0.9), "the number of sectors: 1 in one, 2 in"),
            (make(base.clone(), &[1.0], 1, 0.2, 0.9), "the number of bins of orders of scattering: "),
            (make(base.clone(), &[1.0], 1, 0.1, 0.91), "reference albedo: 0.9 in one, 0.91 in"),
        ] {
            let mut table = make(base.clone(), &[1.0], 1, 0.1, 0.9);
            let error = table.merge(&other).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
    }

    #[test]
    fn merge_refuses_sums_that_do_not_fit() {
        let mut a = after(table(&[1.0], 1, 0.5), 1, 100);
        let mut b = after(table(&[1.0], 1, 0.5), 2, 100);
        let last = b.cells.len() - 1;
        b.cells[last].order_sum = u64::MAX;
        a.cells[last].order_sum = 1;
        let before = a.clone();
        assert!(matches!(a.merge(&b), Err(TableError::TooMany)));
        assert_eq!(a, before);
    }
}
