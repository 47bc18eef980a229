//! Shells of other media below the surface of a body: the distance to the surface decides which medium a point is in.
//!
//! Flights are drawn as if the densest medium were everywhere, and what they meet where there is less of it is nothing, in
//! proportion [Woodcock et al. 1965]: so nothing is assumed about where shells end along a ray. The distance is exact. Where
//! the next shell is farther than the flights that would be drawn in vain, a flight goes through the medium that is there,
//! up to that distance.

use glam::Vec3;
use translucid_profile::{AlbedoInversion, Configuration, ParameterError, half_space_surface_albedo};
use translucid_scene::{LayerMedium, SubsurfaceLayer};

use crate::ray::{Body, Depths};

/// Transmittance below which light is looked for at random.
const ROULETTE_BELOW: f32 = 0.1;
/// What may come straight through the densest layer: at the rim of a body the way through it is short.
const LEAST_STRAIGHT: f32 = 0.1;

/// Greatest depth and extinction coefficient in words.
const MOST_WORD: f32 = 1e29;

/// A medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ShellMedium {
    /// Extinction coefficient of each channel \[L⁻¹\].
    pub(crate) sigma_t: Vec3,
    /// Single-scattering albedo of each channel.
    pub(crate) alpha: Vec3,
    /// Mean cosine of the phase function.
    pub(crate) g: f32,
}

/// Media of shells from the surface inwards, each with the depth \[L\] at which it ends.
pub(crate) struct ShellMedia {
    shells: Vec<(f32, ShellMedium)>,
    /// Greatest surface albedos of endless layers of these media, about, or transmittances of the layers.
    brightest: Vec3,
}

impl ShellMedia {
    /// The media of layers.
    pub(crate) fn new(layers: &[SubsurfaceLayer]) -> Result<Self, ParameterError> {
        let mut new = Self { shells: Vec::new(), brightest: Vec3::ZERO };
        let mut depth = 0.0;
        let mut inversion = None;
        for layer in layers {
            depth += f64::from(layer.thickness);
            let g = f64::from(layer.g);
            let (sigma_t, alpha) = match layer.medium {
                LayerMedium::Appearance { surface_albedo, mfp } => {
                    let known = inversion.take().filter(|known: &AlbedoInversion| known.g() == g);
                    let known =
                        known.map_or_else(|| AlbedoInversion::new(g, 1.0, Configuration::Diffuse), Ok)?;
                    let alpha = surface_albedo.map(|a| known.single_scattering_albedo(f64::from(a)) as f32);
                    inversion = Some(known);
                    (mfp.recip(), alpha)
                }
                LayerMedium::Coefficients { scattering, absorption } => {
                    let sigma_t = scattering + absorption;
                    (sigma_t, Vec3::select(sigma_t.cmpgt(Vec3::ZERO), scattering / sigma_t, Vec3::ZERO))
                }
            };
            let albedo = alpha.map(|alpha| {
                let alpha = f64::from(alpha);
                let similar = alpha * (1.0 - g) / (1.0 - alpha * g);
                half_space_surface_albedo(similar, Configuration::Diffuse) as f32
            });
            let straight = (-sigma_t * layer.thickness).exp().max(Vec3::splat(LEAST_STRAIGHT));
            let albedo = albedo.max(straight);
            new.brightest = new.brightest.max(albedo);
            new.shells.push((depth as f32, ShellMedium { sigma_t, alpha, g: layer.g }));
        }
        Ok(new)
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.shells.is_empty()
    }

    /// The media as words: how many, [surface albedos](Self::brightest), then of each the depth at which it ends, extinction
    /// coefficients, single-scattering albedos and the mean cosine.
    pub(super) fn words(&self) -> Vec<f32> {
        let mut words = vec![self.shells.len() as f32];
        words.extend(self.brightest.to_array());
        for (end, ShellMedium { sigma_t, alpha, g }) in &self.shells {
            words.push(end.min(MOST_WORD));
            words.extend(sigma_t.min(Vec3::splat(MOST_WORD)).to_array());
            words.extend(alpha.to_array());
            words.push(*g);
        }
        words
    }

    /// Greatest extinction coefficients \[L⁻¹\].
    pub(super) fn densest(&self) -> Vec3 {
        self.shells.iter().fold(Vec3::ZERO, |densest, (_, medium)| densest.max(medium.sigma_t))
    }

    /// Least thickness \[L\].
    pub(super) fn thinnest(&self) -> f32 {
        let ends = self.shells.iter().map(|(end, _)| *end);
        let starts = std::iter::once(0.0).chain(ends.clone());
        ends.zip(starts).map(|(end, start)| end - start).fold(f32::INFINITY, f32::min)
    }

    /// A surface albedo above 0 in every channel in which light may come out of the body.
    pub(crate) fn brightest(&self, innermost: Vec3) -> Vec3 {
        innermost.max(self.brightest)
    }
}

/// Where a point is among the shells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ShellPlace {
    /// Number of its shell, that of all shells behind them.
    shell: usize,
    /// Radius \[L\] of a ball around it in which there is no other medium.
    free: f32,
}

/// The next flight from a place.
pub(crate) struct ShellFlight {
    /// Extinction coefficient to draw its length by \[L⁻¹\].
    pub(crate) sigma_t: Vec3,
    /// Way \[L\] after which a new flight begins.
    pub(crate) limit: f32,
    /// The medium, where that of the whole flight is known; else collisions count in part.
    pub(crate) medium: Option<ShellMedium>,
}

/// The shells of a body.
#[derive(Clone, Copy)]
pub(crate) struct Shells<'a> {
    shells: &'a [(f32, ShellMedium)],
    /// The medium behind them.
    innermost: ShellMedium,
    /// Greatest and least extinction coefficients of all media \[L⁻¹\].
    most: Vec3,
    least: Vec3,
    /// Greatest extinction coefficient that positions resolve \[L⁻¹\].
    finest: f32,
    /// Depth \[L\] that needs not be exact, and that from which on none is known.
    enough: f32,
    reach: f32,
    depths: Depths<'a>,
}

impl<'a> Shells<'a> {
    /// The shells of a body around its innermost medium, with `finest` the greatest extinction coefficient \[L⁻¹\] that
    /// positions resolve; `None` where there are none.
    pub(crate) fn new(
        media: &'a ShellMedia,
        innermost: ShellMedium,
        depths: Depths<'a>,
        finest: f32,
    ) -> Option<Self> {
        let total = media.shells.last()?.0;
        let (mut most, mut least) = (innermost.sigma_t, innermost.sigma_t);
        for (_, medium) in &media.shells {
            let sigma_t = medium.sigma_t.min(Vec3::splat(finest));
            (most, least) = (most.max(sigma_t), least.min(sigma_t));
        }
        let excess = (most - innermost.sigma_t).max_element();
        let (mut enough, mut reach) = (total, total);
        if excess > 0.0 {
            enough += excess.recip();
            reach = enough + innermost.sigma_t.min_element().recip();
        }
        Some(Self { shells: &media.shells, innermost, most, least, finest, enough, reach, depths })
    }

    /// Least extinction coefficients \[L⁻¹\].
    pub(crate) fn least(&self) -> Vec3 {
        self.least
    }

    /// Just below the surface.
    pub(crate) fn at_surface(&self) -> ShellPlace {
        self.at_depth(0.0)
    }

    /// The place of a point of the body.
    pub(crate) fn place(&self, body: &Body<'_>, point: Vec3) -> ShellPlace {
        self.at_depth(body.depth(&self.depths, point, self.enough, self.reach))
    }

    fn at_depth(&self, depth: f32) -> ShellPlace {
        let shell = self.shells.partition_point(|(end, _)| *end <= depth);
        let since = if shell == 0 { f32::INFINITY } else { depth - self.shells[shell - 1].0 };
        let until = self.shells.get(shell).map_or(f32::INFINITY, |(end, _)| end - depth);
        ShellPlace { shell, free: since.min(until) }
    }

    fn medium(&self, place: ShellPlace) -> ShellMedium {
        let Some((_, medium)) = self.shells.get(place.shell) else { return self.innermost };
        ShellMedium { sigma_t: medium.sigma_t.min(Vec3::splat(self.finest)), ..*medium }
    }

    /// The next flight from a place.
    pub(crate) fn flight(&self, place: ShellPlace) -> ShellFlight {
        let medium = self.medium(place);
        // Collisions with nothing that a flight through the medium itself spares
        if (self.most - medium.sigma_t).max_element() * place.free > 1.0 {
            ShellFlight { sigma_t: medium.sigma_t, limit: place.free, medium: Some(medium) }
        } else {
            ShellFlight { sigma_t: self.most, limit: f32::INFINITY, medium: None }
        }
    }

    /// The medium at a place, and the part of the collisions of the densest that are with it.
    pub(crate) fn medium_and_part(&self, place: ShellPlace) -> (ShellMedium, Vec3) {
        let medium = self.medium(place);
        let part = Vec3::select(self.most.cmpgt(Vec3::ZERO), medium.sigma_t / self.most, Vec3::ZERO);
        (medium, part.min(Vec3::ONE))
    }

    /// Transmittance of a way through the body, over that of the least extinction coefficients, estimated with random
    /// numbers: each channel's mean is exact.
    pub(crate) fn transmittance_beyond_least(
        &self,
        body: &Body<'_>,
        (from, direction, distance): (Vec3, Vec3, f32),
        mut number: impl FnMut() -> f32,
    ) -> Vec3 {
        let densest = (self.most - self.least).max_element();
        let (mut transmittance, mut way) = (Vec3::ONE, 0.0);
        if densest <= 0.0 || !distance.is_finite() {
            return transmittance;
        }
        let mut place = self.place(body, from);
        while way < distance {
            let more = self.medium(place).sigma_t - self.least;
            if place.free * densest > 1.0 {
                let step = place.free.min(distance - way);
                transmittance *= (-more * step).exp();
                if way + step == way {
                    // Rounding has swallowed the step
                    return Vec3::ZERO;
                }
                way += step;
                place = self.place(body, from + direction * way);
            } else {
                way -= libm::log1pf(-number()) / densest;
                if way >= distance {
                    break;
                }
                place = self.place(body, from + direction * way);
                let more = self.medium(place).sigma_t - self.least;
                transmittance *= (1.0 - more / densest).max(Vec3::ZERO);
            }
            let most = transmittance.max_element();
            if most < ROULETTE_BELOW {
                if number() * ROULETTE_BELOW >= most {
                    return Vec3::ZERO;
                }
                transmittance *= ROULETTE_BELOW / most;
            }
        }
        transmittance
    }
}
