//! The table of a white walk: one run, every albedo.

use std::fmt;
use std::ops::Range;

use translucid_profile::{ParameterError, require};

use super::device::Machine;
use super::layout::{Layout, Region};
use super::orders::Cell;
use super::photon_exit::{PhotonCounts, PhotonExit, Side};
use super::photon_ranges::{PhotonRange, PhotonRanges};
use super::problem::Problem;
use super::table_error::TableError;
use super::weights::{Weighed, Weights};
use crate::Estimate;

mod merging;

/// What tables of different machines differ in.
const MACHINE: &str = "the kind of machine that walked";

/// Photons that left a medium, counted over place and order of scattering at a reference albedo α_ref.
///
/// A photon that leaves after n collisions does so at any other albedo as well, with a probability (α/α_ref)ⁿ
/// times that at α_ref: one table serves all α ≤ α_ref, see [`WhiteTable::at_albedo`]. (*White Monte Carlo*: E.
/// Alerstam, S. Andersson-Engels and T. Svensson 2008, *J. Biomed. Opt.* 13, 041304.)
///
/// Counts and sums of orders are whole numbers, so a table depends on its photons alone: not on the number of
/// threads, nor on the sequence in which parts of it were run and merged. It knows which photons it holds and
/// takes none twice.
///
/// ```
/// use translucid_profile::{Configuration, half_space_surface_albedo};
/// use translucid_reference::walk::{Control, Layout, Parameters, Problem, Side, WhiteTable};
///
/// let problem = Problem::new(Parameters::default())?;
/// let layout = Layout::new(&[0.5, 1.0, 2.0], 1)?;
/// let mut table = WhiteTable::new(problem, layout, 0.99)?;
/// table.run(1, 20_000, &Control::default())?;
///
/// // Any albedo up to the reference.
/// for alpha in [0.5, 0.9, 0.99] {
///     let total = table.at_albedo(alpha)?.total(Side::Reflected);
///     let exact = half_space_surface_albedo(alpha, Configuration::Searchlight);
///     assert!((total.value - exact).abs() < 4.0 * total.error);
/// }
/// # Ok::<(), translucid_reference::walk::TableError>(())
/// ```
#[derive(Clone, PartialEq)]
pub struct WhiteTable {
    problem: Problem,
    layout: Layout,
    reference_albedo: f64,
    machine: Machine,
    ranges: PhotonRanges,
    counts: PhotonCounts,
    /// Cells by face, place and order bin, the last varying fastest.
    cells: Vec<Cell>,
}

impl WhiteTable {
    /// Highest reference albedo. The mean number of collisions in a half space grows like (1 − α)^(−1/2) and is
    /// infinite without absorption.
    pub const HIGHEST_REFERENCE_ALBEDO: f64 = 0.999999;

    /// A table without photons.
    ///
    /// # Errors
    /// The reference albedo is not in (0, 0.999999].
    pub fn new(problem: Problem, layout: Layout, reference_albedo: f64) -> Result<Self, ParameterError> {
        let cells = vec![Cell::default(); problem.faces() * layout.entries()];
        let (ranges, counts) = (PhotonRanges::default(), PhotonCounts::default());
        Self::with_contents(problem, layout, reference_albedo, ranges, counts, cells)
    }

    /// A table with photons, whose numbers are known to agree.
    ///
    /// # Errors
    /// As for [`WhiteTable::new`].
    pub(crate) fn with_contents(
        problem: Problem,
        layout: Layout,
        reference_albedo: f64,
        ranges: PhotonRanges,
        counts: PhotonCounts,
        cells: Vec<Cell>,
    ) -> Result<Self, ParameterError> {
        let is_allowed = reference_albedo > 0.0 && reference_albedo <= Self::HIGHEST_REFERENCE_ALBEDO;
        require(is_allowed, "reference_albedo", reference_albedo, "in (0, 0.999999]")?;
        Ok(Self { problem, layout, reference_albedo, machine: Machine::default(), ranges, counts, cells })
    }

    /// Medium and light of the walk.
    pub fn problem(&self) -> &Problem {
        &self.problem
    }

    /// Bins of place and order.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Single-scattering albedo α_ref of the walk.
    pub fn reference_albedo(&self) -> f64 {
        self.reference_albedo
    }

    /// The photons that the table holds: sorted, joined, not empty.
    pub fn photon_ranges(&self) -> &[PhotonRange] {
        self.ranges.as_slice()
    }

    /// The photons of a range that the table does not hold.
    pub fn missing_of(&self, range: PhotonRange) -> Vec<PhotonRange> {
        let missing = self.ranges.missing(range.seed, range.start..range.end, u64::MAX).into_iter();
        missing.map(|Range { start, end }| PhotonRange { seed: range.seed, start, end }).collect()
    }

    /// The photons that are missing between the first, 0, and the last that the table holds, of every seed that it
    /// holds any of.
    pub fn gaps(&self) -> Vec<PhotonRange> {
        self.ranges.gaps()
    }

    /// Number of photons that entered the medium.
    pub fn photons(&self) -> u64 {
        self.counts.launched
    }

    /// Number of photons that left through a region of a face, at the reference albedo.
    pub fn exits(&self, side: Side, region: Region) -> u64 {
        self.cells(side, region).iter().map(|cell| cell.count).sum()
    }

    /// Mean number of collisions of a photon at the reference albedo, the absorbing one included; 0 for a table
    /// without photons.
    pub fn mean_collisions(&self) -> f64 {
        if self.photons() == 0 { 0.0 } else { self.counts.collisions as f64 / self.photons() as f64 }
    }

    /// Probability, without absorption, that a photon leaves through a region after a number of collisions in a
    /// bin of orders: the coefficients Pₙ of R(α) = Σ Pₙ αⁿ.
    ///
    /// ```text
    /// Pₙ = (photons of order n) / (N α_refⁿ)
    /// ```
    pub fn order_probability(&self, side: Side, region: Region, bin: usize) -> Estimate {
        let bins = self.layout.order_bins();
        if bin >= bins.len() {
            return Estimate::ZERO;
        }
        let weights = Weights::new(bins, 1.0, self.reference_albedo);
        let cells = self.cells(side, region);
        if cells.is_empty() {
            return Estimate::ZERO;
        }
        let sum: Weighed = cells.chunks_exact(bins.len()).map(|orders| weights.weigh(bin, orders[bin])).sum();
        let greatest = libm::pow(self.reference_albedo, -f64::from(bins.orders(bin).0));
        sum.mean(self.photons(), greatest)
    }

    /// Single-scattering albedo at which the face where light enters returns a share A of what entered, the
    /// inverse of `at_albedo(α).total(Side::Reflected)`, with the standard error σ(A)/(dA/dα).
    ///
    /// # Errors
    /// A is outside the range that α from 0 to the reference albedo makes.
    pub fn single_scattering_albedo(&self, surface_albedo: f64) -> Result<Estimate, ParameterError> {
        let total = |alpha: f64| {
            let weights = Weights::new(self.layout.order_bins(), alpha, self.reference_albedo);
            self.weigh(&weights, self.cells(Side::Reflected, Region::Everywhere))
        };
        let target = surface_albedo * self.photons() as f64;
        let (mut low, mut high) = (0.0, self.reference_albedo);
        let reached = total(low).first <= target && target <= total(high).first;
        let allowed = "among those of the table's albedos: from that at 0 to that at its reference albedo";
        require(self.photons() > 0 && reached, "surface_albedo", surface_albedo, allowed)?;
        // R(α) is a power series without negative terms, hence convex: Newton's method comes down from the
        // right without overshooting. The bracket is for rounding.
        let mut alpha = high;
        for _ in 0..100 {
            let sum = total(alpha);
            if sum.first > target {
                high = alpha;
            } else {
                low = alpha;
            }
            let next = alpha - (sum.first - target) / sum.slope;
            let next = if next >= low && next <= high { next } else { 0.5 * (low + high) };
            if (next - alpha).abs() <= 1e-15 * alpha {
                break;
            }
            alpha = next;
        }
        let sum = total(alpha);
        let error = sum.mean(self.photons(), self.greatest_weight(alpha)).error;
        let slope = sum.slope / self.photons() as f64;
        let error = if slope > 0.0 { error / slope } else { f64::INFINITY };
        Ok(Estimate { value: alpha, error })
    }

    /// Weighs cells, whole sets of order bins.
    pub(crate) fn weigh(&self, weights: &Weights, cells: &[Cell]) -> Weighed {
        let places = cells.chunks_exact(self.layout.order_bins().len());
        let cells = places.flat_map(|orders| orders.iter().enumerate()).filter(|(_, cell)| cell.count > 0);
        cells.map(|(bin, &cell)| weights.weigh(bin, cell)).sum()
    }

    /// Greatest weight that a photon can have: only a slab lets some through without a collision.
    pub(crate) fn greatest_weight(&self, alpha: f64) -> f64 {
        if self.problem.faces() == 2 { 1.0 } else { alpha / self.reference_albedo }
    }

    /// The cells of a region; none on the far face of a half space.
    pub(crate) fn cells(&self, side: Side, region: Region) -> &[Cell] {
        let (start, bins) = (side as usize * self.layout.entries(), self.layout.order_bins().len());
        let places = self.layout.places(region);
        self.cells.get(start + places.start * bins..start + places.end * bins).unwrap_or(&[])
    }
}

/// Without the cells, of which there may be millions.
impl fmt::Debug for WhiteTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { problem, layout, reference_albedo, machine, ranges, counts, .. } = self;
        f.debug_struct("WhiteTable")
            .field("problem", problem)
            .field("layout", layout)
            .field("reference_albedo", reference_albedo)
            .field("machine", machine)
            .field("ranges", ranges)
            .field("counts", counts)
            .finish_non_exhaustive()
    }
}

/// For runs and files.
impl WhiteTable {
    /// Kind of machine that walked the photons.
    pub(crate) fn machine(&self) -> Machine {
        self.machine
    }

    /// States which kind of machine walked the photons.
    pub(crate) fn with_machine(mut self, machine: Machine) -> Self {
        self.machine = machine;
        self
    }

    /// Refuses photons of another kind of machine beside those that the table holds.
    pub(crate) fn require_machine(&mut self, machine: Machine) -> Result<(), TableError> {
        if self.photons() == 0 {
            self.machine = machine;
        }
        if self.machine == machine {
            return Ok(());
        }
        let [held, more] = [self.machine, machine].map(Machine::name);
        Err(TableError::Device(format!(
            "the photons of the table were walked by a {held}, and those of a {more} are not added to them"
        )))
    }

    /// Counts of the photons besides the cells.
    pub(crate) fn counts(&self) -> &PhotonCounts {
        &self.counts
    }

    /// All cells.
    pub(crate) fn all_cells(&self) -> &[Cell] {
        &self.cells
    }

    /// Index of the cell in which an exit counts.
    pub(crate) fn cell_index(&self, exit: &PhotonExit) -> u32 {
        let place = exit.side as usize * self.layout.place_count() + self.layout.place(exit.x, exit.y);
        let bins = self.layout.order_bins();
        (place * bins.len() + bins.bin(exit.order)) as u32
    }

    /// The first photons of a seed that the table does not hold.
    pub(crate) fn missing(&self, seed: u64, photons: u64) -> Vec<Range<u64>> {
        self.ranges.missing(seed, 0..u64::MAX, photons)
    }
}

#[cfg(test)]
mod tests {
    use super::super::problem::Parameters;
    use super::super::{Control, OrderBins};
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
    fn reference_albedo_has_a_range() {
        for albedo in [0.0, -0.5, 1.0, 0.9999999, f64::NAN, f64::INFINITY] {
            let layout = Layout::new(&[1.0], 1).unwrap();
            assert!(
                WhiteTable::new(Problem::new(Parameters::default()).unwrap(), layout, albedo).is_err(),
                "{albedo}"
            );
        }
    }

    /// Orders of scattering of entry uniform in the cosine (physics.md §3): Pₙ = 2(qₙ − qₙ₊₁), qₙ = C(2n,n)/4ⁿ.
    /// |z| < 4.5, false alarm 7e-6 each.
    #[test]
    fn order_probabilities_are_those_of_the_half_space() {
        let problem =
            Problem::new(Parameters { incidence: Incidence::UniformCosine, ..Parameters::default() })
                .unwrap();
        let layout = Layout::new(&[1.0], 1).unwrap();
        let table = after(WhiteTable::new(problem, layout, 0.99).unwrap(), 5, 400_000);
        let mut q = 1.0;
        for n in 0..=20u32 {
            let next = q * f64::from(2 * n + 1) / f64::from(2 * n + 2);
            let expected = if n == 0 { 0.0 } else { 2.0 * (q - next) };
            q = next;
            let found = table.order_probability(Side::Reflected, Region::Everywhere, n as usize);
            let z = (found.value - expected) / found.error;
            assert!(z.abs() < 4.5, "P_{n} = {expected}, found {found:?}");
            assert_eq!(n > 0, found.value > 0.0);
        }
        let parts = [Region::Within(0), Region::Beyond(0)];
        let parts = parts.map(|region| table.order_probability(Side::Reflected, region, 1).value);
        let whole = table.order_probability(Side::Reflected, Region::Everywhere, 1).value;
        assert!((parts[0] + parts[1] - whole).abs() < 1e-15);
        assert_eq!(table.order_probability(Side::Transmitted, Region::Everywhere, 1), Estimate::ZERO);
        assert_eq!(table.order_probability(Side::Reflected, Region::Everywhere, 99_999), Estimate::ZERO);
    }

    #[test]
    fn single_scattering_albedo_inverts_the_total() {
        let table = after(table(&[1.0], 1, 0.9999), 1, 50_000);
        let most = table.at_albedo(0.9999).unwrap().total(Side::Reflected).value;
        for surface_albedo in [0.0, 1e-9, 0.01, 0.2, 0.5, 0.9, 0.97, most] {
            let found = table.single_scattering_albedo(surface_albedo).unwrap();
            let at = table.at_albedo(found.value).unwrap();
            let back = at.total(Side::Reflected);
            assert!((back.value - surface_albedo).abs() < 1e-13, "{surface_albedo}: {found:?} {back:?}");
            let slope = at.derivative(Side::Reflected, Region::Everywhere).value;
            assert!((found.error * slope - back.error).abs() <= 1e-12 * back.error, "{found:?}");
        }
        for surface_albedo in [-0.1, most + 1e-9, 1.0, f64::NAN, f64::INFINITY] {
            assert!(table.single_scattering_albedo(surface_albedo).is_err(), "{surface_albedo}");
        }
    }

    /// |z| < 4.5 for the exact inverse, false alarm 7e-6 each.
    #[test]
    fn single_scattering_albedo_is_right_within_its_error() {
        let table = after(table(&[1.0], 1, 0.999), 1, 200_000);
        for surface_albedo in [0.1, 0.5, 0.8] {
            let found = table.single_scattering_albedo(surface_albedo).unwrap();
            let configuration = translucid_profile::Configuration::Searchlight;
            let exact =
                translucid_profile::half_space_single_scattering_albedo(surface_albedo, configuration);
            assert!((found.value - exact).abs() < 4.5 * found.error, "{surface_albedo}: {found:?} {exact}");
            assert!(found.error < 0.01 * (1.0 - exact), "{found:?}");
        }
    }
}
