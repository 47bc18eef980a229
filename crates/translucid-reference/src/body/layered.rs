//! Layers as a place for slow walks: the judge of the fast walks and of solutions.
//!
//! Regions are the layers; part 0 of the surface is the top, part 1 the bottom.

use std::f64::consts::TAU;

use translucid_profile::fresnel_from_outside;

use super::photon::{Beyond, PhotonEnd, Space, Wall, follow};
use super::shape::nearest;
use crate::Incidence;
use crate::layers::{Ground, Layers};
use crate::phase_function::PhaseFunction;
use crate::ray::{Ray, Vector, across, henyey_greenstein};
use crate::split_mix::SplitMix;

const DOWN: Vector = [0.0, 0.0, 1.0];

impl Space for Layers {
    fn extinction(&self, region: usize) -> f64 {
        self.layers()[region].extinction()
    }

    fn single_scattering_albedo(&self, region: usize) -> f64 {
        self.layers()[region].scattering / self.extinction(region)
    }

    fn scatter(&self, region: usize, direction: Vector, random: &mut SplitMix) -> Vector {
        let cosine = deflection(&self.layers()[region].phase_function, random);
        across(direction, cosine, TAU * random.uniform())
    }

    fn wall(&self, region: usize, ray: &Ray) -> Option<Wall> {
        let (layer, next) = (&self.layers()[region], self.layers().get(region + 1));
        let top: f64 = self.layers()[..region].iter().map(|layer| layer.thickness).sum();
        let planes = [(DOWN, top), ([0.0, 0.0, -1.0], -top - layer.thickness)];
        let (face, distance, inward) = nearest(planes, ray)?;
        let (eta, beyond) = match (face, region.checked_sub(1), next, self.ground()) {
            (0, None, ..) => (self.eta_above(), Beyond::Outside(0)),
            (0, Some(above), ..) => (self.layers()[above].eta, Beyond::Region(above)),
            (_, _, Some(next), _) => (next.eta, Beyond::Region(region + 1)),
            (_, _, _, Ground::Medium { eta }) => (eta, Beyond::Outside(1)),
            (_, _, _, Ground::Lambertian { reflectance }) => (layer.eta, Beyond::Ground(reflectance)),
            (_, _, _, Ground::None) => return None,
        };
        Some(Wall { distance, inward, eta: layer.eta / eta, beyond })
    }
}

/// Follows a photon that arrives from above; `None` where the first face reflects it.
pub(crate) fn arriving(layers: &Layers, incidence: Incidence, random: &mut SplitMix) -> Option<PhotonEnd> {
    let (cosine, azimuth) = match incidence {
        Incidence::Pencil { cos_theta } => (cos_theta, 0.0),
        Incidence::Cosine => (random.uniform().sqrt(), TAU * random.uniform()),
        Incidence::UniformCosine => {
            let direction = across(DOWN, random.uniform(), TAU * random.uniform());
            return Some(follow(layers, 0, Ray { position: [0.0; 3], direction }, random));
        }
    };
    let eta = layers.layers()[0].eta / layers.eta_above();
    let enters = random.uniform() >= fresnel_from_outside(cosine, eta);
    enters.then(|| follow(layers, 0, Ray::entering([0.0; 3], DOWN, [cosine, azimuth], eta), random))
}

/// Draws the cosine of a deflection; where no formula does, from under the greatest value of p that even steps find, with
/// some to spare.
fn deflection(phase_function: &PhaseFunction, random: &mut SplitMix) -> f64 {
    match phase_function {
        PhaseFunction::HenyeyGreenstein { g } => henyey_greenstein(*g, random),
        PhaseFunction::Rayleigh => rejected(1.0, random, |cosine| 0.5 * (1.0 + cosine * cosine)),
        PhaseFunction::TwoTerm { weight, g1, g2 } => {
            let g = if random.uniform() < *weight { *g1 } else { *g2 };
            henyey_greenstein(g, random)
        }
        other => {
            let most = (0..=64).map(|i| other.eval(f64::from(i) / 32.0 - 1.0)).fold(0.0, f64::max);
            rejected(1.5 * most, random, |cosine| other.eval(cosine))
        }
    }
}

fn rejected(most: f64, random: &mut SplitMix, density: impl Fn(f64) -> f64) -> f64 {
    loop {
        let cosine = 2.0 * random.uniform() - 1.0;
        if most * random.uniform() < density(cosine) {
            return cosine;
        }
    }
}
