//! Two point sources of diffusing light, one in the medium and its mirror image outside, as the surface sees them.
//!
//! In an infinite medium a source of unit power has the fluence φ = e^{−σd}/(4πD d) at the distance d, where
//! σ = σ_tr. A source at the depth z_r with the power 1 and one at the height z_v with the power −1 make φ vanish
//! on the plane halfway between them, which is how a dipole meets the boundary of a half space.
//! H. W. Jensen, S. R. Marschner, M. Levoy and P. Hanrahan, *A Practical Model for Subsurface Light Transport*,
//! 2001, section 2.3.
//!
//! Every sum here is one of terms of the same sign, so that no radius and no σ costs digits.

use std::f64::consts::PI;

use crate::math::elementary::{Double, exp_negative};

/// Greatest radius whose powers the arithmetic holds.
const RADIUS_MAX: f64 = 1e150;

/// A real source below the surface and its negative image above it.
///
/// Lengths are in one unit, for which the models take the transport mean free path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SourcePair {
    /// Effective transport coefficient σ_tr.
    sigma_tr: f64,
    /// Depth z_r of the real source, greater than 0.
    real: f64,
    /// Height z_v ≥ z_r of the image.
    image: f64,
}

impl SourcePair {
    /// Sources at the depth z_r > 0 and the height z_v ≥ z_r, for σ_tr ≥ 0.
    pub(crate) fn new(sigma_tr: f64, real: f64, image: f64) -> Self {
        Self { sigma_tr, real, image }
    }

    /// D φ at the radius r of the surface: (e^{−σd_r}/d_r − e^{−σd_v}/d_v)/4π.
    pub(crate) fn fluence(&self, r: f64) -> f64 {
        let [d_r, d_v] = self.distances(r);
        let gap = self.distance_gap(d_r, d_v);
        let (near, _) = exp_negative::<Double>(self.sigma_tr * d_r);
        let (_, lost) = exp_negative::<Double>(self.sigma_tr * gap);
        near * (gap / d_r / d_v + lost / d_v) / (4.0 * PI)
    }

    /// ∫ D φ 2πr' dr' from r to infinity: (e^{−σd_r} − e^{−σd_v})/2σ.
    pub(crate) fn fluence_beyond(&self, r: f64) -> f64 {
        let [d_r, d_v] = self.distances(r);
        let (near, _) = exp_negative::<Double>(self.sigma_tr * d_r);
        0.5 * near * damped(self.sigma_tr, self.distance_gap(d_r, d_v))
    }

    /// ∫ D φ 2πr' dr' from 0 to r.
    ///
    /// With Δ = d_v − d_r at r and Δ₀ = z_v − z_r, and (1 − e^{−σΔ})/σ written H(Δ),
    ///
    /// ```text
    /// 2∫ = (e^{−σz_r} − e^{−σd_r}) H(Δ₀) + e^{−σ(d_r + Δ)} H(Δ₀ − Δ)
    /// Δ₀ − Δ = Δ₀ (d_r − z_r + d_v − z_v)/(d_r + d_v)
    /// ```
    pub(crate) fn fluence_enclosed(&self, r: f64) -> f64 {
        let [d_r, d_v] = self.distances(r);
        let [beyond_real, beyond_image] = self.excesses(r);
        let widest = self.image - self.real;
        let narrowed = widest * ((beyond_real + beyond_image) / (d_r + d_v));
        let (at_axis, _) = exp_negative::<Double>(self.sigma_tr * self.real);
        let (_, lost) = exp_negative::<Double>(self.sigma_tr * beyond_real);
        let (far, _) = exp_negative::<Double>(self.sigma_tr * d_v);
        0.5 * (at_axis * lost * damped(self.sigma_tr, widest) + far * damped(self.sigma_tr, narrowed))
    }

    /// ∫ D φ 2πr dr over the whole surface.
    pub(crate) fn fluence_total(&self) -> f64 {
        let (at_axis, _) = exp_negative::<Double>(self.sigma_tr * self.real);
        0.5 * at_axis * damped(self.sigma_tr, self.image - self.real)
    }

    /// Flux D ∂φ/∂z through the surface at the radius r: Σ z (1 + σd) e^{−σd}/(4πd³) over both sources.
    pub(crate) fn flux(&self, r: f64) -> f64 {
        let [d_r, d_v] = self.distances(r);
        let of = |z: f64, d: f64| {
            let t = (self.sigma_tr * d).min(1e3);
            let (damping, _) = exp_negative::<Double>(t);
            (1.0 + t) * damping * (z / d / d / d)
        };
        (of(self.real, d_r) + of(self.image, d_v)) / (4.0 * PI)
    }

    /// ∫ flux 2πr' dr' from r to infinity: Σ z e^{−σd}/2d.
    pub(crate) fn flux_beyond(&self, r: f64) -> f64 {
        let [d_r, d_v] = self.distances(r);
        let of = |z: f64, d: f64| z / d * exp_negative::<Double>(self.sigma_tr * d).0;
        0.5 * (of(self.real, d_r) + of(self.image, d_v))
    }

    /// ∫ flux 2πr' dr' from 0 to r: Σ e^{−σz} (1 − (z/d) e^{−σ(d−z)})/2.
    pub(crate) fn flux_enclosed(&self, r: f64) -> f64 {
        let distances = self.distances(r);
        let excesses = self.excesses(r);
        let of = |z: f64, d: f64, excess: f64| {
            let (at_axis, _) = exp_negative::<Double>(self.sigma_tr * z);
            let (kept, lost) = exp_negative::<Double>(self.sigma_tr * excess);
            at_axis * (lost + excess / d * kept)
        };
        0.5 * (of(self.real, distances[0], excesses[0]) + of(self.image, distances[1], excesses[1]))
    }

    /// ∫ flux 2πr dr over the whole surface.
    pub(crate) fn flux_total(&self) -> f64 {
        let (real, _) = exp_negative::<Double>(self.sigma_tr * self.real);
        let (image, _) = exp_negative::<Double>(self.sigma_tr * self.image);
        0.5 * (real + image)
    }

    /// Distances d_r and d_v of both sources from the surface at r.
    fn distances(&self, r: f64) -> [f64; 2] {
        let r = bounded(r);
        [self.real, self.image].map(|z| (r * r + z * z).sqrt())
    }

    /// d_r − z_r and d_v − z_v, with all digits at small r.
    fn excesses(&self, r: f64) -> [f64; 2] {
        let r = bounded(r);
        [self.real, self.image].map(|z| r / ((r * r + z * z).sqrt() + z) * r)
    }

    /// d_v − d_r, with all digits at large r.
    fn distance_gap(&self, d_r: f64, d_v: f64) -> f64 {
        (self.image - self.real) * ((self.image + self.real) / (d_v + d_r))
    }
}

/// (1 − e^{−σx})/σ for σ, x ≥ 0; x where σ = 0.
pub(crate) fn damped(sigma: f64, x: f64) -> f64 {
    let t = sigma * x;
    if t < 1e-20 { x } else { exp_negative::<Double>(t).1 / t * x }
}

/// A radius in [0, 1e150]; NaN becomes 0.
pub(crate) fn bounded(r: f64) -> f64 {
    r.max(0.0).min(RADIUS_MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIGMAS: [f64; 6] = [0.0, 1e-200, 1e-12, 0.03, 0.7, 1.7];

    #[test]
    fn fields_match_their_formulas() {
        for sigma in SIGMAS {
            let pair = SourcePair::new(sigma, 1.0, 2.4);
            for r in [0.0, 0.01, 0.3, 1.0, 4.0, 20.0] {
                let d_r = f64::hypot(r, 1.0);
                let d_v = f64::hypot(r, 2.4);
                let fluence = ((-sigma * d_r).exp() / d_r - (-sigma * d_v).exp() / d_v) / (4.0 * PI);
                assert!((pair.fluence(r) / fluence - 1.0).abs() < 1e-13, "{sigma} {r}");
                let of = |z: f64, d: f64| z * (1.0 + sigma * d) * (-sigma * d).exp() / d.powi(3);
                let flux = (of(1.0, d_r) + of(2.4, d_v)) / (4.0 * PI);
                assert!((pair.flux(r) / flux - 1.0).abs() < 1e-13, "{sigma} {r}");
            }
        }
    }

    #[test]
    fn within_and_beyond_make_the_total() {
        for sigma in SIGMAS {
            let pair = SourcePair::new(sigma, 1.0, 2.4);
            for r in [0.0, 1e-200, 1e-9, 0.01, 0.3, 1.0, 4.0, 20.0, 1e3, 1e9, 1e200, f64::INFINITY] {
                let fluence = pair.fluence_enclosed(r) + pair.fluence_beyond(r);
                assert!((fluence / pair.fluence_total() - 1.0).abs() < 1e-15, "{sigma} {r}: {fluence}");
                let flux = pair.flux_enclosed(r) + pair.flux_beyond(r);
                assert!((flux / pair.flux_total() - 1.0).abs() < 1e-15, "{sigma} {r}: {flux}");
            }
        }
    }

    /// Near the axis the field is that of the axis, far away a power: no digit of either is lost.
    #[test]
    fn integrals_keep_their_digits_at_both_ends() {
        for sigma in SIGMAS {
            let pair = SourcePair::new(sigma, 1.0, 2.4);
            for r in [1e-150, 1e-30, 1e-9] {
                let disc = PI * r * r;
                assert!(
                    (pair.fluence_enclosed(r) / (disc * pair.fluence(0.0)) - 1.0).abs() < 1e-14,
                    "{sigma} {r}"
                );
                assert!((pair.flux_enclosed(r) / (disc * pair.flux(0.0)) - 1.0).abs() < 1e-14, "{sigma} {r}");
            }
        }
        let pair = SourcePair::new(0.0, 1.0, 2.4);
        for r in [1e9, 1e30, 1e100] {
            let fluence = 0.25 * (2.4 * 2.4 - 1.0) / r;
            assert!((pair.fluence_beyond(r) / fluence - 1.0).abs() < 1e-14, "{r}");
            assert!((2.0 * PI * r * r * pair.fluence(r) / fluence - 1.0).abs() < 1e-14, "{r}");
            assert!((pair.flux_beyond(r) / (1.7 / r) - 1.0).abs() < 1e-14, "{r}");
        }
    }
}
