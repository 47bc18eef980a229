//! Counts of photons by how their walk ended.

use rayon::prelude::*;

use super::photon::{Fate, PhotonEnd};
use crate::Estimate;
use crate::split_mix::SplitMix;

/// Photons that one thread follows in a row.
const CHUNK: u64 = 4096;

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
    /// Follows photons on all threads and counts how they end, by part of the surface. The counts are a function of
    /// seed and number of photons alone.
    pub(super) fn of_photons(
        parts: usize,
        photons: u64,
        seed: u64,
        follow: impl Fn(&mut SplitMix) -> PhotonEnd + Sync,
    ) -> Self {
        let chunk = |number: u64| {
            let first = number * CHUNK;
            let mut tally = Self::new(parts);
            for index in first..(first + CHUNK).min(photons) {
                tally.count(&follow(&mut SplitMix::of_photon(seed, index)));
            }
            tally
        };
        let chunks = (0..photons.div_ceil(CHUNK)).into_par_iter();
        chunks.map(chunk).reduce(|| Self::new(parts), |all, part| all.merged(&part))
    }

    fn new(parts: usize) -> Self {
        Self { photons: 0, collisions: 0, scattered: vec![0; parts], straight: vec![0; parts] }
    }

    fn count(&mut self, end: &PhotonEnd) {
        self.photons += 1;
        self.collisions += end.collisions;
        if let Fate::Left(part) = end.fate {
            let counts = if end.collisions > 0 { &mut self.scattered } else { &mut self.straight };
            counts[part] += 1;
        }
    }

    fn merged(mut self, other: &Self) -> Self {
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

    /// Collisions of a photon on average, the one that absorbs it included; 0 without photons.
    pub fn mean_collisions(&self) -> f64 {
        if self.photons == 0 { 0.0 } else { self.collisions as f64 / self.photons as f64 }
    }

    /// Share of the light that entered that is scattered and leaves through a part of the surface.
    ///
    /// Nothing leaves through a part that is not there, see [`Shape::parts`](super::Shape::parts).
    pub fn scattered_through(&self, part: usize) -> Estimate {
        self.scattered.get(part).map_or(Estimate::ZERO, |&count| self.share(count))
    }

    /// Share of the light that entered that leaves through a part of the surface without a collision.
    ///
    /// Nothing leaves through a part that is not there, see [`Shape::parts`](super::Shape::parts).
    pub fn straight_through(&self, part: usize) -> Estimate {
        self.straight.get(part).map_or(Estimate::ZERO, |&count| self.share(count))
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

    /// A share with the standard error of a count among `photons`; without photons nothing is known.
    fn share(&self, count: u64) -> Estimate {
        if self.photons == 0 {
            return Estimate { value: 0.0, error: f64::INFINITY };
        }
        let n = self.photons as f64;
        let value = count as f64 / n;
        Estimate { value, error: (value * (1.0 - value) / n).sqrt() }
    }
}
