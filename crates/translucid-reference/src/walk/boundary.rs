//! Layers and their faces, in single precision: where photons cross them, and whether they get through.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, mask32x16};

use super::lanes::{Floats, FusedMulAdd, unit};
use super::photons::Group;
use super::scatter::Directions;

/// A smooth boundary between two media, seen from one of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Interface {
    /// Index on this side over that on the other.
    eta: f32,
    /// 1 − η².
    one_minus_square: f32,
    /// Light with a lower squared cosine reflects totally; negative where none does.
    total_below: f32,
}

impl Interface {
    pub(crate) fn new(eta: f64) -> Self {
        let one_minus_square = (1.0 - eta) * (1.0 + eta);
        Self {
            eta: eta as f32,
            one_minus_square: one_minus_square as f32,
            total_below: (-one_minus_square / (eta * eta)) as f32,
        }
    }

    /// Returns which cosines are beyond the critical angle.
    #[inline(always)]
    pub(crate) fn reflects_totally<S: Simd>(&self, mu: Floats<S>) -> mask32x16<S> {
        (mu * mu).simd_lt(self.total_below)
    }

    /// Fresnel's reflectance (A.-J. Fresnel 1823) for η ≠ 1 and cosines in (0, 1]; 1 beyond the critical angle.
    #[inline(always)]
    pub(crate) fn reflectance<S: Simd>(&self, simd: S, mu: Floats<S>) -> Floats<S> {
        let squared =
            (mu * mu).fused_mul_add(self.eta * self.eta, Floats::splat(simd, self.one_minus_square));
        let refracted = squared.max(0.0).min(1.0).sqrt();
        let perpendicular = (mu * self.eta - refracted) / (mu * self.eta + refracted);
        let parallel = (refracted * self.eta - mu) / (refracted * self.eta + mu);
        (perpendicular * perpendicular + parallel * parallel) * 0.5
    }
}

/// Free path in a layer without collisions, in units of the walk: beyond every face.
pub(crate) const CLEAR: f32 = 1e30;

/// A layer, its lengths in units of the walk.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Medium {
    /// Mean free path.
    pub(crate) mfp: f32,
    /// Thickness; infinite for a half space.
    pub(crate) thickness: f32,
    /// Depth of its top.
    pub(crate) top: f32,
    /// Part of the light that a collision absorbs, where light has weights.
    pub(crate) absorbed: f32,
    pub(crate) above: Face,
    pub(crate) below: Face,
}

/// A face of a layer, seen from inside.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Face {
    pub(crate) interface: Interface,
    /// Index of refraction here over that beyond.
    pub(crate) eta: f32,
    pub(crate) beyond: Beyond,
}

/// Place that light gets to through a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Beyond {
    Layer(usize),
    Outside,
    /// A Lambertian ground of this reflectance.
    Ground(f32),
}

/// Least cosine of refracted light.
const GRAZING: f32 = 1e-6;

impl Face {
    pub(crate) fn new(eta: f64, beyond: Beyond) -> Self {
        Self { interface: Interface::new(eta), eta: eta as f32, beyond }
    }

    /// Returns whether all light gets through.
    pub(crate) fn is_matched(&self) -> bool {
        self.eta == 1.0
    }

    /// Draws which photons of a mask pass the face.
    #[inline(always)]
    pub(crate) fn passes<S: Simd>(
        &self,
        simd: S,
        photons: &mut Group<S>,
        uz: Floats<S>,
        mask: mask32x16<S>,
    ) -> mask32x16<S> {
        if self.is_matched() || !mask.any_true() {
            return mask;
        }
        let chance = mask & !self.interface.reflects_totally(uz);
        let share = draw(photons, chance);
        chance & share.simd_ge(self.interface.reflectance(simd, uz.abs()))
    }

    /// Directions beyond the face, by Snell's law.
    #[inline(always)]
    pub(crate) fn refracted<S: Simd>(&self, simd: S, directions: Directions<S>) -> Directions<S> {
        if self.is_matched() {
            return directions;
        }
        let (Directions { x, y, z }, eta) = (directions, self.eta);
        // 1 − η² (1 − μ²), in a form that keeps its digits near perpendicular light
        let squared = (z * z).fused_mul_add(eta * eta, Floats::splat(simd, (1.0 - eta) * (1.0 + eta)));
        let cosine = squared.max(GRAZING * GRAZING).min(1.0).sqrt();
        Directions { x: x * eta, y: y * eta, z: z.simd_gt(0.0).select(cosine, -cosine) }
    }
}

impl Medium {
    /// Returns whether light has no collisions in it.
    pub(crate) fn is_clear(&self) -> bool {
        self.mfp >= CLEAR
    }

    /// Returns which depths are beyond a face.
    #[inline(always)]
    pub(crate) fn are_outside<S: Simd>(&self, z: Floats<S>) -> mask32x16<S> {
        z.simd_lt(0.0) | z.simd_gt(self.thickness)
    }

    /// Returns which cosines both faces reflect totally.
    #[inline(always)]
    fn traps<S: Simd>(&self, mu: Floats<S>) -> mask32x16<S> {
        self.above.interface.reflects_totally(mu) & self.below.interface.reflects_totally(mu)
    }

    /// Returns which photons the face that they are beyond reflects totally.
    #[inline(always)]
    pub(crate) fn reflects_totally<S: Simd>(&self, z: Floats<S>, uz: Floats<S>) -> mask32x16<S> {
        (z.simd_lt(0.0) & self.above.interface.reflects_totally(uz))
            | (z.simd_gt(self.thickness) & self.below.interface.reflects_totally(uz))
    }

    /// Mirrors those of some photons beyond a face that one reflection brings inside; the photons beyond a face that remain.
    #[inline(always)]
    pub(crate) fn mirror<S: Simd>(
        &self,
        simd: S,
        photons: &mut Group<S>,
        total: mask32x16<S>,
    ) -> mask32x16<S> {
        let (z, uz) = (photons.z, photons.directions.z);
        let outside = self.are_outside(z);
        let mirrored = z.simd_lt(0.0).select(-z, Floats::splat(simd, 2.0 * self.thickness) - z);
        let inside = outside & total & !self.are_outside(mirrored);
        photons.z = inside.select(mirrored, z);
        photons.directions.z = inside.select(-uz, uz);
        outside & !inside
    }

    /// Draws which photons of a mask, each on a face, pass it.
    #[inline(always)]
    pub(crate) fn passes<S: Simd>(
        &self,
        simd: S,
        photons: &mut Group<S>,
        uz: Floats<S>,
        down: mask32x16<S>,
        mask: mask32x16<S>,
    ) -> mask32x16<S> {
        let upwards = self.above.passes(simd, photons, uz, mask & !down);
        upwards | self.below.passes(simd, photons, uz, mask & down)
    }

    /// Ends flights from a face between two that reflect them totally: which they are, the depths at their ends, and which
    /// then go the other way. Depth is a triangle wave.
    #[inline(always)]
    pub(crate) fn fold<S: Simd>(
        &self,
        simd: S,
        uz: Floats<S>,
        flight: Floats<S>,
    ) -> (mask32x16<S>, Floats<S>, mask32x16<S>) {
        let thickness = Floats::splat(simd, self.thickness);
        let depth = flight * uz.abs();
        let periods = (depth * (0.5 / self.thickness)).floor();
        let within = (-periods).fused_mul_add(thickness + thickness, depth).max(0.0);
        let returns = within.simd_gt(thickness);
        let travelled = returns.select(thickness + thickness - within, within).max(0.0);
        (self.traps(uz), uz.simd_gt(0.0).select(travelled, thickness - travelled), returns)
    }
}

/// Uniform numbers for the photons of a mask; the streams of others stay where they are.
#[inline(always)]
pub(crate) fn draw<S: Simd>(photons: &mut Group<S>, mask: mask32x16<S>) -> Floats<S> {
    let mut streams = photons.streams;
    let drawn = unit(streams.next());
    for (word, after) in photons.streams.0.iter_mut().zip(streams.0) {
        *word = mask.select(after, *word);
    }
    drawn
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};
    use translucid_profile::fresnel_from_inside;

    use super::*;

    #[test]
    fn reflectance_is_fresnels() {
        #[inline(always)]
        fn lanes<S: Simd>(simd: S, interface: Interface, mu: f32) -> (f32, bool) {
            let mu = Floats::splat(simd, mu);
            (interface.reflectance(simd, mu)[0], interface.reflects_totally(mu).all_true())
        }
        for eta in [0.1, 0.7, 0.999, 1.001, 1.33, 1.5, 3.0, 10.0] {
            let interface = Interface::new(eta);
            for i in 1..=1000 {
                let mu = i as f32 / 1000.0;
                let exact = fresnel_from_inside(f64::from(mu), eta);
                let (found, total) = dispatch!(Level::new(), simd => lanes(simd, interface, mu));
                let cosine_outside = (1.0 - eta * eta * (1.0 - f64::from(mu).powi(2))).max(0.0).sqrt();
                // Beside the critical angle F rises as a root, and so does a rounding of the cosine
                let bound = 4e-7 + 2e-6 * eta / cosine_outside.max(1e-3);
                assert!((f64::from(found) - exact).abs() < bound, "{eta} {mu}: {found} {exact}");
                assert!(cosine_outside < 1e-3 || total == (exact == 1.0), "{eta} {mu}");
            }
        }
    }
    /// Many total reflections in one step end where one after the other does.
    #[test]
    fn folding_equals_reflecting_one_by_one() {
        #[inline(always)]
        fn lanes<S: Simd>(simd: S, medium: &Medium, uz: f32, flight: f32) -> (f32, bool) {
            let [uz, flight] = [uz, flight].map(|value| Floats::splat(simd, value));
            let (_, depth, returns) = medium.fold(simd, uz, flight);
            (depth[0], returns.all_true())
        }
        let face = Face::new(1.5, Beyond::Outside);
        let medium = Medium { mfp: 1.0, thickness: 0.25, top: 0.0, absorbed: 0.0, above: face, below: face };
        for i in 0..1000 {
            for uz in [0.5f32, -0.5] {
                let flight = i as f32 / 166.0;
                let (mut depth, mut cosine) = (if uz > 0.0 { 0.0 } else { 0.25 } + flight * uz, uz);
                while !(0.0..=0.25).contains(&depth) {
                    depth = if depth < 0.0 { -depth } else { 0.5 - depth };
                    cosine = -cosine;
                }
                let (found, returns) = dispatch!(Level::new(), simd => lanes(simd, &medium, uz, flight));
                assert!((found - depth).abs() < 1e-6, "{flight} {uz}: {found} {depth}");
                let at_face = !(1e-6..=0.25 - 1e-6).contains(&depth);
                assert!(returns == (cosine != uz) || at_face, "{flight} {uz}");
            }
        }
    }
}
