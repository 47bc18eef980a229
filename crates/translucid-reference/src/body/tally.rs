//! What became of photons.

use super::photon::End;
use crate::Estimate;

/// Whole numbers of photons, and the shares that they stand for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tally {
    photons: u64,
    collisions: u64,
    /// Photons that left after a collision, for each part of the surface.
    scattered: Vec<u64>,
    /// Photons that left without one.
    straight: Vec<u64>,
}

impl Tally {
    pub(super) fn new(parts: usize) -> Self {
        Self { photons: 0, collisions: 0, scattered: vec![0; parts], straight: vec![0; parts] }
    }

    pub(super) fn count(&mut self, end: &End) {
        self.photons += 1;
        self.collisions += end.collisions;
        if let Some(part) = end.part {
            let counts = if end.collisions > 0 { &mut self.scattered } else { &mut self.straight };
            counts[part] += 1;
        }
    }

    pub(super) fn merged(mut self, other: &Self) -> Self {
        let add = |own: &mut [u64], others: &[u64]| own.iter_mut().zip(others).for_each(|(a, b)| *a += b);
        self.photons += other.photons;
        self.collisions += other.collisions;
        add(&mut self.scattered, &other.scattered);
        add(&mut self.straight, &other.straight);
        self
    }

    /// Photons that entered.
    pub fn photons(&self) -> u64 {
        self.photons
    }

    /// Collisions of a photon on average, the one that absorbs it included.
    pub fn mean_collisions(&self) -> f64 {
        self.collisions as f64 / self.photons as f64
    }

    /// Share of the light that entered that is scattered and leaves through a part of the surface.
    ///
    /// # Panics
    /// There is no such part, see [`Shape::parts`](super::Shape::parts).
    pub fn scattered_through(&self, part: usize) -> Estimate {
        self.share(self.scattered[part])
    }

    /// Share of the light that entered that leaves through a part of the surface without a collision.
    ///
    /// # Panics
    /// There is no such part, see [`Shape::parts`](super::Shape::parts).
    pub fn straight_through(&self, part: usize) -> Estimate {
        self.share(self.straight[part])
    }

    /// Share of the light that entered that is scattered and leaves: what profiles stand for.
    pub fn scattered(&self) -> Estimate {
        self.share(self.scattered.iter().sum())
    }

    /// Share of the light that entered that leaves without a collision.
    pub fn straight(&self) -> Estimate {
        self.share(self.straight.iter().sum())
    }

    /// Share of the light that entered that leaves.
    pub fn leaving(&self) -> Estimate {
        self.share(self.scattered.iter().chain(&self.straight).sum())
    }

    /// A share with the standard error of a count among `photons`.
    fn share(&self, count: u64) -> Estimate {
        let n = self.photons as f64;
        let value = count as f64 / n;
        Estimate { value, error: (value * (1.0 - value) / n).sqrt() }
    }
}
