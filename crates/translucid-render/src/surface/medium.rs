//! The medium that a walk goes through, found from a material's surface albedo and length.

use std::ops::RangeInclusive;

use glam::Vec3;
use translucid_profile::{AlbedoInversion, Configuration, ParameterError, Parameterization};
use translucid_scene::{Material, Object, SubsurfaceLayer, WalkSurface};

use super::shells::{ShellMedia, ShellMedium, Shells};
use crate::ray::Body;

/// Mean free paths below this many rounding errors of a position count as a point: a walk would lose its way, and A be
/// off by more than 1 %.
const LEAST_OFFSETS_OF_MFP: f32 = 8.0;

/// The inputs of a medium: materials with equal recipes share one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct WalkRecipe {
    surface: WalkSurface,
    g: f64,
    eta: f64,
    configuration: Configuration,
    parameterization: Parameterization,
    most_flights: u32,
    layers: Vec<SubsurfaceLayer>,
}

/// The medium of any surface albedo.
pub(crate) struct WalkMedium {
    inversion: AlbedoInversion,
    parameterization: Parameterization,
    pub(crate) surface: WalkSurface,
    /// Mean cosine of the phase function.
    pub(crate) g: f32,
    /// Relative index of the boundary, 1 without one; of a rough surface that of its facets.
    pub(crate) eta: f32,
    /// Flights after which a walk is given up.
    pub(crate) most_flights: u32,
    /// Media of shells around it.
    shells: ShellMedia,
}

impl WalkRecipe {
    /// The medium of a material, as near as the inversion of its surface albedo reaches.
    pub(crate) fn of(material: &Material, surface: WalkSurface) -> Self {
        let within = |x: f32, range: RangeInclusive<f64>| f64::from(x).clamp(*range.start(), *range.end());
        Self {
            g: within(material.subsurface_scatter_anisotropy, AlbedoInversion::G),
            eta: match surface {
                WalkSurface::Clear | WalkSurface::Rough | WalkSurface::Skin => {
                    within(material.subsurface_eta, AlbedoInversion::ETA)
                }
                WalkSurface::Diffuse => 1.0,
            },
            configuration: match surface {
                WalkSurface::Clear => material.subsurface_configuration,
                WalkSurface::Diffuse | WalkSurface::Rough | WalkSurface::Skin => Configuration::Diffuse,
            },
            surface,
            parameterization: material.subsurface_parameter,
            most_flights: material.subsurface_flights as u32,
            layers: material.layers.clone(),
        }
    }

    /// The g and η that are used, which are the material's or the nearest within reach.
    pub(crate) fn g_and_eta(&self) -> [f64; 2] {
        [self.g, self.eta]
    }

    /// Inverts the albedos of the medium.
    pub(crate) fn make(&self) -> Result<WalkMedium, ParameterError> {
        let Self { g, eta, configuration, parameterization, surface, most_flights, ref layers } = *self;
        // Only a clear surface reflects light inside
        let eta_inside = if surface == WalkSurface::Clear { eta } else { 1.0 };
        let inversion = AlbedoInversion::new(g, eta_inside, configuration)?;
        let (g, eta, shells) = (g as f32, eta as f32, ShellMedia::new(layers)?);
        Ok(WalkMedium { inversion, parameterization, surface, g, eta, most_flights, shells })
    }
}

impl WalkMedium {
    /// Returns `true` if unscattered light goes straight on, without a boundary.
    pub(crate) fn is_matched(&self) -> bool {
        self.surface == WalkSurface::Clear && self.eta == 1.0
    }

    /// Returns `true` if shells of other media are around this one.
    pub(crate) fn has_shells(&self) -> bool {
        !self.shells.is_empty()
    }

    /// The media of the shells as words for devices.
    pub(crate) fn shell_words(&self) -> Vec<f32> {
        self.shells.words()
    }

    /// The shells of a body of this medium at a point of its surface, if there are any; `objects` are those of the scene.
    pub(crate) fn shells<'a>(
        &'a self,
        body: &Body<'a>,
        objects: &[Object],
        (surface_albedo, length): (Vec3, Vec3),
        offset: f32,
    ) -> Option<Shells<'a>> {
        if !self.has_shells() {
            return None;
        }
        let alpha = self.single_scattering_albedo(surface_albedo);
        let innermost = ShellMedium { sigma_t: length.recip().min(Vec3::MAX), alpha, g: self.g };
        let finest = (LEAST_OFFSETS_OF_MFP * offset).recip().min(f32::MAX);
        Shells::new(&self.shells, innermost, body.depths(objects), finest)
    }

    /// Returns `true` if there are shells, and they or this medium of such mean free paths are finer than positions with a
    /// rounding error of `offset` resolve.
    pub(crate) fn has_unresolved_shells(&self, length: Vec3, offset: f32) -> bool {
        let finest = (LEAST_OFFSETS_OF_MFP * offset).recip();
        let densest = length.recip().max(self.shells.densest()).max_element();
        self.has_shells() && (densest > finest || self.shells.thinnest() < offset)
    }

    /// A surface albedo above 0 in every channel in which light may come out of a body of this surface albedo.
    pub(crate) fn brightest(&self, surface_albedo: Vec3) -> Vec3 {
        self.shells.brightest(surface_albedo)
    }

    /// Mean free paths \[L\] of stated lengths, 0 where they are too short for positions with a rounding error of `offset`,
    /// but below shells the least that they resolve: no surface is there that light could leave where it enters.
    pub(crate) fn resolved(&self, surface_albedo: Vec3, stated: Vec3, offset: f32) -> Vec3 {
        let of = |c: usize| {
            let mfp = self.mfp(surface_albedo[c], stated[c]);
            let least = LEAST_OFFSETS_OF_MFP * offset;
            match self.has_shells() {
                true => mfp.max(least).max(f32::MIN_POSITIVE),
                false if mfp > least => mfp,
                false => 0.0,
            }
        };
        Vec3::new(of(0), of(1), of(2))
    }

    /// Mean free path \[L\] of a channel whose material states the surface albedo A and a length.
    fn mfp(&self, albedo: f32, length: f32) -> f32 {
        self.inversion.mfp(f64::from(albedo), f64::from(length), self.parameterization) as f32
    }

    /// Single-scattering albedo α of each channel.
    pub(crate) fn single_scattering_albedo(&self, albedo: Vec3) -> Vec3 {
        let of = |a: f32| self.inversion.single_scattering_albedo(f64::from(a)) as f32;
        Vec3::new(of(albedo.x), of(albedo.y), of(albedo.z))
    }
}
