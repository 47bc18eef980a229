//! A material at one point, as the BSDF needs it.

use glam::{BVec3, Vec3};

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
    /// Factor on the Fresnel reflectance of metal and opaque dielectric. Glass keeps a Fresnel law by an
    /// index whose F₀ is scaled; 0 removes the interface.
    pub specular_weight: f32,
    /// Tint of the dielectric's reflection (light that enters is not tinted); a metal's tint at 82°.
    pub specular_color: Vec3,
    /// Perceptual roughness; the GGX width is its square.
    pub specular_roughness: f32,
    /// Index of refraction of the dielectric.
    pub specular_ior: f32,
    /// Fraction of the dielectric base that is clear.
    pub transmission_weight: f32,
    /// Tint of each crossing of the surface.
    pub transmission_tint: Vec3,
    /// Fraction of the dielectric's opaque part that scatters light under the surface.
    pub subsurface_weight: f32,
    /// Surface albedo A of the medium, relative to the light that enters.
    pub surface_albedo: Vec3,
    /// Channels with a mean free path above 0; the others are Lambertian with the same factors.
    pub subsurface_active: [bool; 3],
    /// Of a thin-walled surface the albedo of the light that is scattered to its other side, of which there is as much as of
    /// `surface_albedo`; `None` where there is an inside.
    pub thin_wall: Option<Vec3>,
    /// Strength of the clear coat.
    pub coat_weight: f32,
    /// Tint of the layers under the coat: two passes, one each way.
    pub coat_color: Vec3,
    /// Perceptual roughness of the coat.
    pub coat_roughness: f32,
    /// Index of refraction of the coat.
    pub coat_ior: f32,
}

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
            subsurface_active: [true; 3],
            thin_wall: None,
            coat_weight: 0.0,
            coat_color: Vec3::ONE,
            coat_roughness: 0.0,
            coat_ior: 1.6,
        }
    }
}

impl SurfaceParameters {
    /// Clamps every weight, color and roughness to [0, 1]; NaN becomes 0.
    pub fn clamped(&self) -> Self {
        Self {
            base_color: unit_color(self.base_color),
            metalness: unit(self.metalness),
            specular_weight: unit(self.specular_weight),
            specular_color: unit_color(self.specular_color),
            specular_roughness: unit(self.specular_roughness),
            transmission_weight: unit(self.transmission_weight),
            transmission_tint: unit_color(self.transmission_tint),
            subsurface_weight: unit(self.subsurface_weight),
            surface_albedo: unit_color(self.surface_albedo),
            thin_wall: self.thin_wall.map(unit_color),
            coat_weight: unit(self.coat_weight),
            coat_color: unit_color(self.coat_color),
            coat_roughness: unit(self.coat_roughness),
            ..*self
        }
    }

    /// The parameters above a medium of this surface albedo, in whose active channels light travels below the surface.
    #[must_use]
    pub(crate) fn with_subsurface(self, surface_albedo: Vec3, active: BVec3) -> Self {
        Self { surface_albedo, subsurface_active: active.into(), ..self }
    }

    /// The thin-walled surface whose scattering with the mean cosine `g` is divided between its sides
    /// [OpenPBR Surface 1.1, "Thin-walled mode"].
    #[must_use]
    pub fn scattered_to_both_sides(self, g: f32) -> Self {
        let half = 0.5 * self.surface_albedo;
        Self { surface_albedo: half * (1.0 - g), thin_wall: Some(half * (1.0 + g)), ..self }
    }

    /// The surface without its clear part and with rough reflections, as [soft](crate::path) paths see it.
    #[must_use]
    pub fn seen_softly(self) -> Self {
        Self {
            transmission_weight: 0.0,
            specular_roughness: self.specular_roughness.max(ROUGHNESS_AFTER_DIFFUSE),
            coat_roughness: self.coat_roughness.max(ROUGHNESS_AFTER_DIFFUSE),
            ..self
        }
    }

    /// The surface with a black base, for paths that may not be scattered diffusely any more: neither light samples nor
    /// paths then find light there.
    #[must_use]
    pub fn without_diffuse(self) -> Self {
        Self {
            subsurface_weight: 1.0,
            surface_albedo: Vec3::ZERO,
            subsurface_active: [false; 3],
            thin_wall: self.thin_wall.map(|_| Vec3::ZERO),
            ..self
        }
    }

    /// The surface without its matte base, for such paths above a body that light may pass straight.
    #[must_use]
    pub fn without_matte(self) -> Self {
        Self { base_color: Vec3::ZERO, surface_albedo: self.subsurface_albedo_active(), ..self }
    }

    /// Fraction of the surface that is clear.
    pub(crate) fn clear_part(&self) -> f32 {
        self.transmission_weight * (1.0 - self.metalness)
    }

    /// Surface albedo of the channels that light travels in below the surface.
    pub fn subsurface_albedo_active(&self) -> Vec3 {
        self.surface_albedo * Vec3::from_array(self.subsurface_active.map(|a| if a { 1.0 } else { 0.0 }))
    }

    /// Albedo of the base that reflects light where it enters: the diffuse part and the subsurface
    /// channels without a mean free path, relative to the opaque part.
    pub fn matte_albedo(&self) -> Vec3 {
        let inactive = self.surface_albedo - self.subsurface_albedo_active();
        self.base_color * (1.0 - self.subsurface_weight) + inactive * self.subsurface_weight
    }
}

// A comparison rather than `clamp`, which would keep NaN.
fn unit(x: f32) -> f32 {
    if x > 0.0 { x.min(1.0) } else { 0.0 }
}

fn unit_color(c: Vec3) -> Vec3 {
    Vec3::new(unit(c.x), unit(c.y), unit(c.z))
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
            subsurface_active: [true, false, true],
            ..SurfaceParameters::default()
        };
        assert_eq!(p.matte_albedo(), Vec3::new(0.375, 0.625, 0.375));
        assert_eq!(p.subsurface_albedo_active(), Vec3::new(1.0, 0.0, 1.0));
    }
}
