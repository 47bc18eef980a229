//! The medium that walks of a part of a block share in, where a texture gives each exit another color.
//!
//! The light at the ends of flights depends on the medium that it comes through. So walks whose media differ little share
//! the light that would be there in one medium common to them, that of the first, and each adds by its own path how much
//! more light comes through its own medium:
//!
//! ```text
//! L_j = shared L(ᾱ) + Σ (α_jⁿ − ᾱⁿ) E_n
//! ```
//!
//! E_n is the light that its path meets after n collisions. Where the mean free path is textured, too, the common medium has
//! one of its own, and the path's flights are weighed by the ratio of both densities. The mean is exact whatever medium is
//! common, and noise grows with the difference of the two.

use std::collections::BTreeMap;

use glam::Vec3;

use crate::subsurface::transport::gathering::ExitKind;

/// Greatest ratio of the surface albedos, about, of media that share in a common one.
const NEAR: f32 = 1.5;

/// Greatest ratio of their mean free paths: each flight adds to the noise.
const NEAR_LENGTH: f32 = 1.15;

/// Surface albedo that is added to both before they are compared: darker ones are alike.
const DARK: f32 = 0.02;

/// Greatest exponent of the ratio of two flights' densities.
const MOST_EXPONENT: f32 = 60.0;

/// Common media of a part of a block; where a texture has more kinds of media further walks share nothing.
const MOST_MEDIA: usize = 8;

/// Properties common to walks with the same light in one medium: the exit's kind, the number of flights after which they are
/// given up, and `true` if they end at a matte surface.
pub(super) type WalkKind = (ExitKind, u32, bool);

/// A medium by its extinction coefficients \[L⁻¹\] and single-scattering albedos.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Medium {
    pub(super) sigma_t: Vec3,
    pub(super) alpha: Vec3,
}

impl Medium {
    /// Returns `true` if light in both is nearly the same.
    pub(super) fn is_near(&self, other: &Self) -> bool {
        let are_near = |a: Vec3, b: Vec3, ratio: f32| a.max(b).cmple(a.min(b) * ratio).all();
        let [a, b] = [self.alpha, other.alpha].map(|alpha| surface_albedo(alpha) + DARK);
        self == other || are_near(self.sigma_t, other.sigma_t, NEAR_LENGTH) && are_near(a, b, NEAR)
    }
}

/// The media of a block's walks, by part: the first walk whose medium is near none of them brings another.
#[derive(Default)]
pub(super) struct CommonMedia {
    parts: BTreeMap<[usize; 2], Vec<(WalkKind, Medium)>>,
}

impl CommonMedia {
    /// The common medium of a part for a walk of this kind and medium; `None` where there are too many.
    pub(super) fn choose(&mut self, part: [usize; 2], kind: WalkKind, medium: Medium) -> Option<Medium> {
        let media = self.parts.entry(part).or_default();
        let near = media.iter().find(|(other, common)| *other == kind && common.is_near(&medium));
        if let Some((_, common)) = near {
            return Some(*common);
        }
        (media.len() < MOST_MEDIA).then(|| {
            media.push((kind, medium));
            medium
        })
    }

    pub(super) fn clear(&mut self) {
        self.parts.clear();
    }
}

/// Surface albedo of a half space, nearly [van de Hulst 1980, "Multiple Light Scattering"].
fn surface_albedo(alpha: Vec3) -> Vec3 {
    let s = (1.0 - alpha).max(Vec3::ZERO);
    let s = Vec3::new(s.x.sqrt(), s.y.sqrt(), s.z.sqrt());
    (1.0 - s) * (1.0 - 0.139 * s) / (1.0 + 1.17 * s)
}

/// The two media of a walk that shares, its own and the common one, beside the one that it goes through: it has the mean free
/// paths of the common one, and in each channel the greater albedo.
#[derive(Clone, Copy)]
pub(super) struct Media {
    /// Single-scattering albedos.
    alphas: [Vec3; 2],
    /// These over the walk's.
    ratios: [Vec3; 2],
    /// Extinction of the own medium over that of the walk, and how much more it is.
    thicker: Vec3,
    more: Vec3,
    /// Throughput in these media over that of the walk.
    weights: [Vec3; 2],
    /// Light that has been found, through these media.
    light: [Vec3; 2],
    /// All light that has been found.
    seen: Vec3,
    /// They differ; else nothing of the above is kept up.
    differ: bool,
}

impl Media {
    pub(super) const ONE: Self = Self {
        alphas: [Vec3::ZERO; 2],
        ratios: [Vec3::ONE; 2],
        thicker: Vec3::ONE,
        more: Vec3::ZERO,
        weights: [Vec3::ONE; 2],
        light: [Vec3::ZERO; 2],
        seen: Vec3::ZERO,
        differ: false,
    };

    pub(super) fn new(own: &Medium, common: &Medium) -> Self {
        let alphas = [own.alpha, common.alpha];
        if own == common {
            return Self { alphas, ..Self::ONE };
        }
        let over = |a: Vec3, b: Vec3| Vec3::select(b.cmpgt(Vec3::ZERO), a / b, Vec3::ZERO);
        let ratios = alphas.map(|alpha| over(alpha, own.alpha.max(common.alpha)));
        let (thicker, more) = (over(own.sigma_t, common.sigma_t), own.sigma_t - common.sigma_t);
        Self { alphas, ratios, thicker, more, differ: true, ..Self::ONE }
    }

    /// Single-scattering albedos of the medium that the walk goes through.
    pub(super) fn alpha(&self) -> Vec3 {
        self.alphas[0].max(self.alphas[1])
    }

    pub(super) fn differ(&self) -> bool {
        self.differ
    }

    /// Single-scattering albedos of the own medium and the common one.
    pub(super) fn alphas(&self) -> [Vec3; 2] {
        self.alphas
    }

    /// Density of collisions after a length in the own medium over that in the walk's.
    pub(super) fn colliding(&self, length: f32) -> Vec3 {
        self.thicker * self.passing(length)
    }

    /// Part of the light that gets past a distance in the own medium over that in the walk's.
    pub(super) fn passing(&self, distance: f32) -> Vec3 {
        if self.more == Vec3::ZERO {
            return Vec3::ONE;
        }
        let exponents = (self.more * -distance.min(f32::MAX)).min(Vec3::splat(MOST_EXPONENT));
        Vec3::from_array(exponents.to_array().map(libm::expf))
    }

    /// Counts a flight to a collision.
    pub(super) fn collide(&mut self, length: f32) {
        if self.differ {
            self.weights[0] *= self.ratios[0] * self.colliding(length);
            self.weights[1] *= self.ratios[1];
        }
    }

    /// Counts a flight past a distance.
    pub(super) fn pass(&mut self, distance: f32) {
        if self.differ {
            self.weights[0] *= self.passing(distance);
        }
    }

    /// Weighs the light that has been found since the last time, at such a distance, if `all` has been found by now.
    pub(super) fn weigh(&mut self, all: Vec3, distance: f32) {
        if self.differ && all != self.seen {
            let new = all - self.seen;
            self.light[0] += self.weights[0] * self.passing(distance) * new;
            self.light[1] += self.weights[1] * new;
            self.seen = all;
        }
    }

    /// Light that has been found through the own medium and through the common one, of `all` that has been weighed.
    pub(super) fn light(&self, all: Vec3) -> [Vec3; 2] {
        if self.differ { self.light } else { [all; 2] }
    }
}

#[cfg(test)]
mod tests {
    use super::super::flight::Flights;
    use super::*;

    const OWN: Medium = Medium { sigma_t: Vec3::new(0.8, 1.0, 2.2), alpha: Vec3::new(0.9, 0.0, 0.5) };
    const COMMON: Medium = Medium { sigma_t: Vec3::new(1.0, 0.9, 2.0), alpha: Vec3::new(0.8, 0.3, 0.6) };

    /// Light that is found at collisions and past a distance is that of a walk through the own medium and through the common
    /// one: σ_t α e^{−σ_t t} integrated up to a distance, and e^{−σ_t d} beyond.
    #[test]
    fn light_is_that_of_both_media() {
        let media = Media::new(&OWN, &COMMON);
        let (flights, throughput, distance) = (Flights::new(COMMON.sigma_t), Vec3::ONE, 1.3);
        let mut found = [glam::DVec3::ZERO; 2];
        let n = 1 << 16;
        for i in 0..n {
            let mut media = media;
            let length = flights.sample(throughput, sobol_burley::sample(i, 0, 5));
            let light = if length < distance {
                media.collide(length);
                flights.collide(throughput, length) * media.alpha()
            } else {
                media.pass(distance);
                flights.pass(throughput, distance) * 3.0
            };
            media.weigh(light, 0.0);
            found.iter_mut().zip(media.light(light)).for_each(|(sum, light)| *sum += light.as_dvec3());
        }
        for (found, medium) in found.into_iter().zip([OWN, COMMON]) {
            let passed = (-medium.sigma_t * distance).exp();
            let expected = medium.alpha * (1.0 - passed) + 3.0 * passed;
            let found = found / f64::from(n);
            assert!((found - expected.as_dvec3()).abs().max_element() < 3e-3, "{found} {expected}");
        }
    }

    /// Light that is found later counts by the collisions since, and light on its way out by that way.
    #[test]
    fn light_counts_by_its_way() {
        let mut media = Media::new(&OWN, &COMMON);
        media.weigh(Vec3::ONE, 0.5);
        media.collide(0.0);
        media.weigh(Vec3::splat(3.0), 0.0);
        let [own, common] = media.light(Vec3::splat(3.0));
        let expected = (-(OWN.sigma_t - COMMON.sigma_t) * 0.5).exp()
            + 2.0 * OWN.alpha / media.alpha() * OWN.sigma_t / COMMON.sigma_t;
        assert!((own - expected).abs().max_element() < 1e-5, "{own} {expected}");
        let expected = 1.0 + 2.0 * COMMON.alpha / media.alpha();
        assert!((common - expected).abs().max_element() < 1e-5, "{common} {expected}");
    }

    #[test]
    fn media_that_are_one_need_no_weights() {
        let mut media = Media::new(&OWN, &OWN);
        media.collide(1.0);
        media.weigh(Vec3::ONE, 1.0);
        assert!(!media.differ() && media.alpha() == OWN.alpha);
        assert_eq!(media.light(Vec3::splat(2.0)), [Vec3::splat(2.0); 2]);
    }

    #[test]
    fn extremes_stay_finite() {
        let black = Medium { sigma_t: Vec3::new(0.0, 1e30, 1.0), alpha: Vec3::ZERO };
        let mut media = Media::new(&black, &Medium { sigma_t: black.sigma_t * 1.2, ..black });
        for length in [0.0, 1.0, 1e30, f32::INFINITY] {
            media.pass(length);
            media.collide(length);
            media.weigh(Vec3::splat(length.min(1.0)), length);
        }
        assert!(media.light(Vec3::ONE).iter().all(|light| light.is_finite()));
    }

    /// Walks share in the first medium that is near theirs.
    #[test]
    fn near_media_have_one_in_common() {
        let kind = |group| {
            let exit = ExitKind {
                group,
                outside: true,
                depth: 0,
                diffuse_depth: 0,
                soft: false,
                absorption: [0; 3],
            };
            (exit, 9, true)
        };
        let medium =
            |sigma_t: f32, alpha: f32| Medium { sigma_t: Vec3::splat(sigma_t), alpha: Vec3::splat(alpha) };
        let mut media = CommonMedia::default();
        let mut of = |part, group, medium| {
            media.choose([part, 0], kind(group), medium).map(|m| (m.sigma_t.x, m.alpha.x))
        };
        assert_eq!(of(0, 0, medium(1.0, 0.9)), Some((1.0, 0.9)));
        assert_eq!(of(0, 0, medium(1.1, 0.92)), Some((1.0, 0.9)));
        assert_eq!(of(1, 0, medium(1.1, 0.92)), Some((1.1, 0.92)), "another part");
        assert_eq!(of(0, 1, medium(1.1, 0.92)), Some((1.1, 0.92)), "another kind");
        assert_eq!(of(0, 0, medium(1.0, 0.3)), Some((1.0, 0.3)), "another color");
        assert_eq!(of(0, 0, medium(2.0, 0.9)), Some((2.0, 0.9)), "another length");
        for i in 4..MOST_MEDIA + 3 {
            let sigma_t = (i as f32).exp2();
            let expected = (i < MOST_MEDIA).then_some((sigma_t, 0.9));
            assert_eq!(of(0, 0, medium(sigma_t, 0.9)), expected, "too many");
        }
        media.clear();
        assert!(media.choose([0, 0], kind(0), medium(900.0, 0.9)).is_some());
    }
}
