//! Figures of a walk through layers, with their errors.

use super::grid::{Grid, Places, Quantity};
use crate::Estimate;

/// Light that a walk through layers counted, as parts of the light that arrived.
///
/// Standard errors are those between batches of photons.
#[derive(Clone, Debug, PartialEq)]
pub struct LayersTally {
    places: Places,
    specular: f64,
    photons: u64,
    collisions: u64,
    batches: u64,
    /// Sums over photons that entered.
    sums: Vec<f64>,
    /// Sums over batches of squares over photons.
    squares: Vec<f64>,
}

/// Counts of a batch of photons.
pub(super) struct Batch {
    pub(super) photons: u64,
    pub(super) collisions: u64,
    pub(super) sums: Vec<f64>,
}

impl LayersTally {
    pub(super) fn new(places: Places, specular: f64) -> Self {
        let zeros = vec![0.0; places.count()];
        Self { places, specular, photons: 0, collisions: 0, batches: 0, sums: zeros.clone(), squares: zeros }
    }

    /// Adds a batch; the order counts, by roundings.
    pub(super) fn add(&mut self, mut batch: Batch) {
        self.places.sum_up(&mut batch.sums);
        self.photons += batch.photons;
        self.collisions += batch.collisions;
        self.batches += 1;
        let photons = batch.photons as f64;
        for ((sum, square), value) in self.sums.iter_mut().zip(&mut self.squares).zip(batch.sums) {
            *sum += value;
            *square += value * value / photons;
        }
    }

    /// Adds photons that all pass straight through.
    pub(super) fn add_all_transmitted(&mut self, photons: u64) {
        let half = photons.div_ceil(2);
        for photons in [half, photons - half].into_iter().filter(|photons| *photons > 0) {
            let mut sums = vec![0.0; self.places.count()];
            sums[self.places.of(Quantity::TransmittedByRingAndAngle).start] = photons as f64;
            self.add(Batch { photons, collisions: 0, sums });
        }
    }

    /// Grid of the walk.
    pub fn grid(&self) -> &Grid {
        &self.places.grid
    }

    /// Number of photons walked.
    pub fn photons(&self) -> u64 {
        self.photons
    }

    /// Number of collisions.
    pub fn collisions(&self) -> u64 {
        self.collisions
    }

    /// Part of the light that is reflected before it enters, exactly.
    ///
    /// It is Fresnel's reflectance of the first face; under a perpendicular beam on a clear first layer that of both its
    /// faces, with all reflections between them, as MCML defines it.
    #[doc(alias = "Rsp")]
    pub fn specular(&self) -> f64 {
        self.specular
    }

    /// The only figure, or the first, of a quantity.
    pub fn total(&self, quantity: Quantity) -> Estimate {
        self.estimate(self.places.of(quantity).start)
    }

    /// All figures of a quantity in order: parts of the light that arrived, per cell.
    pub fn all(&self, quantity: Quantity) -> impl ExactSizeIterator<Item = Estimate> {
        self.places.of(quantity).map(|place| self.estimate(place))
    }

    /// Reflectance per area in a ring \[L⁻²\], the mean over it; the last ring's also counts all beyond it.
    pub fn reflectance(&self, ring: usize) -> Estimate {
        self.per_area(Quantity::ReflectedByRing, ring)
    }

    /// Transmittance per area in a ring \[L⁻²\].
    pub fn transmittance(&self, ring: usize) -> Estimate {
        self.per_area(Quantity::TransmittedByRing, ring)
    }

    fn per_area(&self, quantity: Quantity, ring: usize) -> Estimate {
        let Estimate { value, error } = self.estimate(self.places.of(quantity).start + ring);
        let area = self.grid().ring_area(ring);
        Estimate { value: value / area, error: error / area }
    }

    fn estimate(&self, place: usize) -> Estimate {
        let entered = 1.0 - self.specular;
        let (photons, batches) = (self.photons as f64, self.batches as f64);
        if self.batches < 2 {
            let value = if self.photons == 0 { 0.0 } else { entered * self.sums[place] / photons };
            return Estimate { value, error: f64::INFINITY };
        }
        let mean = self.sums[place] / photons;
        if mean.is_nan() {
            return Estimate { value: mean, error: mean };
        }
        // Batches differ by a photon at most, and each counts by its photons
        let squares = self.squares[place] - self.sums[place] * mean;
        let variance = squares.max(0.0) / (photons * (batches - 1.0));
        // Where nothing was seen, or always the same, a single photon may still have been missed
        let error = variance.sqrt().max(if mean == 0.0 { 1.0 / photons } else { 0.0 });
        Estimate { value: entered * mean, error: entered * error }
    }
}
