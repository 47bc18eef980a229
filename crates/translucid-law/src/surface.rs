//! A material at one point, as the BSDF needs it.

use glam::{BVec3, Vec3};

use crate::dielectric::{fresnel_dielectric, scaled_ior};
use crate::thin_wall::Slab;
use crate::words::words;

/// Least roughness of reflections that a diffusely scattered path sees with caustics off.
const ROUGHNESS_AFTER_DIFFUSE: f32 = 0.5;

/// A material evaluated at a point: weights, roughnesses and colors in [0, 1], indices in [1, 4].
/// Values outside are clamped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceParameters {
    /// Diffuse albedo, or the metal's reflectance at normal incidence; `base_weight` is included.
    pub base_color: Vec3,
    /// Dielectric 0 … metal 1.
    pub metalness: f32,
    /// Tint of the dielectric's reflection (light that enters is not tinted); a metal's tint at 82°.
    pub specular_color: Vec3,
    /// Factor on the Fresnel reflectance of metal and opaque dielectric. Glass keeps a Fresnel law by an
    /// index whose F₀ is scaled; 0 removes the interface.
    pub specular_weight: f32,
    /// Tint of each crossing of the surface.
    pub transmission_tint: Vec3,
    /// Fraction of the dielectric base that is clear.
    pub transmission_weight: f32,
    /// Surface albedo A of the medium, relative to the light that enters.
    pub surface_albedo: Vec3,
    /// Fraction of the dielectric's opaque part that scatters light under the surface.
    pub subsurface_weight: f32,
    /// 1 in the channels with a mean free path above 0; the others are Lambertian with the same factors.
    pub subsurface_active: Vec3,
    /// Perceptual roughness; the GGX width is its square.
    pub specular_roughness: f32,
    /// Tint of the layers under the coat: two passes, one each way.
    pub coat_color: Vec3,
    /// Strength of the clear coat.
    pub coat_weight: f32,
    /// Albedo of the light that a thin-walled surface scatters to its other side, of which there is as much as of
    /// `surface_albedo`.
    pub thin_albedo: Vec3,
    /// Perceptual roughness of the coat.
    pub coat_roughness: f32,
    /// Index of refraction of the dielectric.
    pub specular_ior: f32,
    /// Index of refraction of the coat.
    pub coat_ior: f32,
    /// 1 where there is no inside, else 0: what devices keep holds no `bool`.
    pub thin: u32,
}

words!(SurfaceParameters {
    base_color,
    metalness,
    specular_color,
    specular_weight,
    transmission_tint,
    transmission_weight,
    surface_albedo,
    subsurface_weight,
    subsurface_active,
    specular_roughness,
    coat_color,
    coat_weight,
    thin_albedo,
    coat_roughness,
    specular_ior,
    coat_ior,
    thin
});

impl Default for SurfaceParameters {
    /// OpenPBR's defaults.
    fn default() -> Self {
        Self {
            base_color: Vec3::splat(0.8),
            metalness: 0.0,
            specular_weight: 1.0,
            specular_color: Vec3::ONE,
            specular_roughness: 0.3,
            specular_ior: 1.5,
            transmission_weight: 0.0,
            transmission_tint: Vec3::ONE,
            subsurface_weight: 0.0,
            surface_albedo: Vec3::splat(0.8),
            subsurface_active: Vec3::ONE,
            thin: 0,
            thin_albedo: Vec3::ZERO,
            coat_weight: 0.0,
            coat_color: Vec3::ONE,
            coat_roughness: 0.0,
            coat_ior: 1.6,
        }
    }
}

impl SurfaceParameters {
    /// Clamps every weight, color and roughness to [0, 1]; NaN becomes 0.
    #[inline]
    #[must_use]
    pub fn clamped(&self) -> Self {
        let mut p = *self;
        p.base_color = unit_color(p.base_color);
        p.metalness = unit_scalar(p.metalness);
        p.specular_color = unit_color(p.specular_color);
        p.specular_weight = unit_scalar(p.specular_weight);
        p.transmission_tint = unit_color(p.transmission_tint);
        p.transmission_weight = unit_scalar(p.transmission_weight);
        p.surface_albedo = unit_color(p.surface_albedo);
        p.subsurface_weight = unit_scalar(p.subsurface_weight);
        p.specular_roughness = unit_scalar(p.specular_roughness);
        p.coat_color = unit_color(p.coat_color);
        p.coat_weight = unit_scalar(p.coat_weight);
        p.thin_albedo = unit_color(p.thin_albedo);
        p.coat_roughness = unit_scalar(p.coat_roughness);
        p
    }

    /// Returns `true` where there is no inside.
    #[inline]
    pub fn is_thin(&self) -> bool {
        self.thin != 0_u32
    }

    /// The parameters above a medium of this surface albedo, in whose scattering channels light travels below the surface.
    #[inline]
    #[must_use]
    pub fn with_subsurface(self, surface_albedo: Vec3, scattering: BVec3) -> Self {
        let mut p = self;
        p.surface_albedo = surface_albedo;
        p.subsurface_active = Vec3::select(scattering, Vec3::ONE, Vec3::ZERO);
        p
    }

    /// The thin-walled surface whose scattering with the mean cosine `g` is divided between its sides
    /// [OpenPBR Surface 1.1, "Thin-walled mode"].
    #[inline]
    #[must_use]
    pub fn scattered_to_both_sides(self, g: f32) -> Self {
        let mut p = self;
        let half = 0.5 * p.surface_albedo;
        p.surface_albedo = half * (1.0 - g);
        p.thin = 1_u32;
        p.thin_albedo = half * (1.0 + g);
        p
    }

    /// The surface without its clear part and with rough reflections, as soft paths see it.
    #[inline]
    #[must_use]
    pub fn seen_softly(self) -> Self {
        let mut p = self;
        p.transmission_weight = 0.0;
        p.specular_roughness = p.specular_roughness.max(ROUGHNESS_AFTER_DIFFUSE);
        p.coat_roughness = p.coat_roughness.max(ROUGHNESS_AFTER_DIFFUSE);
        p
    }

    /// The surface with a black base, for paths that may not be scattered diffusely any more: neither light samples nor
    /// paths then find light there.
    #[inline]
    #[must_use]
    pub fn without_diffuse(self) -> Self {
        let mut p = self;
        p.subsurface_weight = 1.0;
        p.surface_albedo = Vec3::ZERO;
        p.subsurface_active = Vec3::ZERO;
        p.thin_albedo = Vec3::ZERO;
        p
    }

    /// The surface without its matte base, for such paths above a body that light may pass straight.
    #[inline]
    #[must_use]
    pub fn without_matte(self) -> Self {
        let mut p = self;
        p.base_color = Vec3::ZERO;
        p.surface_albedo = self.subsurface_albedo_active();
        p
    }

    /// Fraction of the surface that is clear.
    #[inline]
    pub fn clear_part(&self) -> f32 {
        self.transmission_weight * (1.0 - self.metalness)
    }

    /// Surface albedo of the channels that light travels in below the surface.
    #[inline]
    pub fn subsurface_albedo_active(&self) -> Vec3 {
        self.surface_albedo * self.subsurface_active
    }

    /// Albedo of the base that reflects light where it enters: the diffuse part and the subsurface
    /// channels without a mean free path, relative to the opaque part.
    #[inline]
    pub fn matte_albedo(&self) -> Vec3 {
        let inactive = self.surface_albedo - self.subsurface_albedo_active();
        self.base_color * (1.0 - self.subsurface_weight) + inactive * self.subsurface_weight
    }

    /// Tint of two passes through the coat.
    #[inline]
    pub fn coat_tint(&self) -> Vec3 {
        Vec3::ONE.lerp(self.coat_color, self.coat_weight)
    }

    /// Tint of one pass through the coat.
    #[inline]
    pub fn coat_tint_one_way(&self) -> Vec3 {
        let tint = self.coat_tint();
        Vec3::new(tint.x.sqrt(), tint.y.sqrt(), tint.z.sqrt())
    }

    /// Transmittance of a clear surface that is passed without refraction: Fresnel and tint, as of a wall whose faces are
    /// parallel.
    #[inline]
    pub fn straight_transmittance(&self, cosine: f32) -> Vec3 {
        if self.is_thin() {
            let eta = scaled_ior(self.specular_ior, self.specular_weight);
            return Slab::new(cosine.min(1.0), eta, self.transmission_tint).transmittance;
        }
        let reflected = self.specular_weight * fresnel_dielectric(cosine, self.specular_ior);
        self.transmission_tint * (1.0 - reflected)
    }
}

/// A number in [0, 1]; NaN becomes 0.
#[inline]
fn unit_scalar(x: f32) -> f32 {
    // A comparison rather than `clamp`, which would keep NaN
    if x > 0.0 { x.min(1.0) } else { 0.0 }
}

/// A color in [0, 1]; NaN becomes 0.
#[inline]
fn unit_color(c: Vec3) -> Vec3 {
    Vec3::new(unit_scalar(c.x), unit_scalar(c.y), unit_scalar(c.z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_out_of_range_are_clamped() {
        let p = SurfaceParameters {
            base_color: Vec3::new(f32::NAN, -1.0, 7.0),
            metalness: f32::INFINITY,
            coat_weight: f32::NAN,
            ..SurfaceParameters::default()
        };
        let p = p.clamped();
        assert_eq!(p.base_color, Vec3::new(0.0, 0.0, 1.0));
        assert_eq!((p.metalness, p.coat_weight), (1.0, 0.0));
    }

    #[test]
    fn matte_albedo_takes_inactive_channels() {
        let p = SurfaceParameters {
            base_color: Vec3::splat(0.5),
            subsurface_weight: 0.25,
            surface_albedo: Vec3::ONE,
            subsurface_active: Vec3::new(1.0, 0.0, 1.0),
            ..SurfaceParameters::default()
        };
        assert_eq!(p.matte_albedo(), Vec3::new(0.375, 0.625, 0.375));
        assert_eq!(p.subsurface_albedo_active(), Vec3::new(1.0, 0.0, 1.0));
    }
}
