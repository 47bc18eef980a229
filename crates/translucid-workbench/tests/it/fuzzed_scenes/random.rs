//! Random choices that like extremes.

use glam::Vec3;
use translucid_testing::SplitMix;

/// Random numbers and what is made of them.
pub(crate) struct Random(SplitMix);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(SplitMix(seed))
    }

    pub(crate) fn next(&mut self) -> u64 {
        self.0.bits()
    }

    /// Uniform in [0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        self.0.uniform()
    }

    /// Uniform in [−1, 1).
    pub(crate) fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    pub(crate) fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// Below `count`.
    pub(crate) fn below(&mut self, count: usize) -> usize {
        self.0.below(count)
    }

    pub(crate) fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }

    /// In [0, 1], most often at or next to an end.
    pub(crate) fn weight(&mut self) -> f64 {
        let between = self.unit();
        self.pick(&[0.0, 1e-30, 1e-6, 0.5, between, between, 1.0 - 1e-7, 1.0, 1.0])
    }

    /// Three weights, often the same.
    pub(crate) fn color(&mut self) -> [f64; 3] {
        if self.chance(0.3) { [self.weight(); 3] } else { [self.weight(), self.weight(), self.weight()] }
    }

    /// A unit vector, often along an axis.
    pub(crate) fn direction(&mut self) -> Vec3 {
        if self.chance(0.3) {
            return self.pick(&[Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z]);
        }
        self.cube().normalize_or(Vec3::Y)
    }

    /// A point of the cube [−1, 1]³.
    pub(crate) fn cube(&mut self) -> Vec3 {
        Vec3::new(self.signed() as f32, self.signed() as f32, self.signed() as f32)
    }
}
