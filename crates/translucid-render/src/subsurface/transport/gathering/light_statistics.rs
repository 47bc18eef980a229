//! Mean and variance of the light at some places.

use glam::Vec3;

use super::FoundLight;

/// Relative variance of light from which on none is expected: it may be elsewhere.
///
/// Greater values give head and dragon less noise, and more to dark places beside a bright lamp.
const UNFORESEEABLE: f32 = 2.0;

/// Sums over places: the mean and variance of their light, and the variance of their normals.
#[derive(Clone, Copy, Default)]
pub(in crate::subsurface::transport) struct LightStatistics {
    count: f32,
    light: Vec3,
    /// Sum over the places of the square of their light, channels added up.
    light_squared: f32,
    normal: Vec3,
}

impl LightStatistics {
    /// Adds a place, so many times.
    pub(super) fn add(&mut self, times: f32, found: &impl FoundLight) {
        let light = found.light();
        self.count += times;
        self.light += times * light;
        self.light_squared += times * light.element_sum().powi(2);
        self.normal += times * found.normal();
    }

    /// Returns `true` if there are no places.
    pub(super) fn is_empty(&self) -> bool {
        self.count == 0.0
    }

    /// Variance of the light over its mean squared; 0 where nothing is known.
    pub(in crate::subsurface::transport) fn variance(&self) -> f32 {
        let square = self.light.element_sum().powi(2);
        if square > 0.0 { self.count * self.light_squared / square - 1.0 } else { 0.0 }
    }

    /// Light to be expected elsewhere, by channel.
    pub(super) fn expected(&self) -> Vec3 {
        // Rounding may leave a variance below 0
        let part = (1.0 - self.variance() / UNFORESEEABLE).clamp(0.0, 1.0);
        let expected = self.light / self.count * part;
        if expected.is_finite() { expected } else { Vec3::ZERO }
    }

    /// Variance of the normals.
    pub(in crate::subsurface::transport) fn roughness(&self) -> f32 {
        if self.count > 0.0 { 1.0 - self.normal.length_squared() / (self.count * self.count) } else { 1.0 }
    }
}
