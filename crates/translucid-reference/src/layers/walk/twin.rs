//! The walk through layers once more, slow and obvious: one photon, double precision, straight from the physics.
//!
//! It shares nothing with the kernel but the layers: other random numbers, library functions, absorption drawn at each
//! collision, flights that begin anew at every face, Fresnel's formula from `translucid-profile`, textbook deflection.

use std::f64::consts::TAU;

use translucid_profile::{fresnel_from_inside, fresnel_from_outside};

use crate::Incidence;
use crate::layers::{Ground, Layers};
use crate::ray::{Ray, across, deflection};
use crate::split_mix::SplitMix;

/// End of a photon: where it is, and in which direction and layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum End {
    /// Reflected: by the first face without entering, or later; distance from the axis and cosine outside.
    Specular,
    Reflected(f64, f64),
    Transmitted(f64, f64),
    /// Layer, distance from the axis, depth.
    Absorbed(usize, f64, f64),
    Ground,
}

/// Walks one photon that arrives from above.
pub(super) fn photon(layers: &Layers, incidence: Incidence, random: &mut SplitMix) -> End {
    let eta = layers.layers()[0].eta / layers.eta_above();
    let (cosine, azimuth) = match incidence {
        Incidence::Pencil { cos_theta } => (cos_theta, 0.0),
        _ => (random.uniform().sqrt(), TAU * random.uniform()),
    };
    if random.uniform() < fresnel_from_outside(cosine, eta) {
        return End::Specular;
    }
    let sine = (1.0 - cosine * cosine).sqrt() / eta;
    let direction = [sine * azimuth.cos(), sine * azimuth.sin(), (1.0 - sine * sine).sqrt()];
    let mut ray = Ray { position: [0.0; 3], direction };
    let tops: Vec<f64> = layers
        .layers()
        .iter()
        .scan(0.0, |depth, layer| {
            let top = *depth;
            *depth += layer.thickness;
            Some(top)
        })
        .collect();
    let mut layer = 0;
    loop {
        // Fly to a collision, or to a face
        let medium = &layers.layers()[layer];
        let down = ray.direction[2] > 0.0;
        let face = if down { tops[layer] + medium.thickness } else { tops[layer] };
        let to_face = ((face - ray.position[2]) / ray.direction[2]).max(0.0);
        let flight = -random.uniform().ln() / medium.extinction();
        let radius = |ray: &Ray| ray.position[0].hypot(ray.position[1]);
        if flight < to_face {
            ray.advance(flight);
            if random.uniform() * medium.extinction() < medium.absorption {
                return End::Absorbed(layer, radius(&ray), ray.position[2]);
            }
            let cosine = deflection(&medium.phase_function, random);
            ray.direction = across(ray.direction, cosine, TAU * random.uniform());
            continue;
        }

        // At a face: through it or back
        ray.advance(to_face);
        ray.position[2] = face;
        let there = if down && layer + 1 == tops.len() {
            match layers.ground() {
                Ground::Medium { eta } => eta,
                Ground::Lambertian { reflectance } => {
                    if random.uniform() >= reflectance {
                        return End::Ground;
                    }
                    ray.direction = across([0.0, 0.0, -1.0], random.uniform().sqrt(), TAU * random.uniform());
                    continue;
                }
                Ground::None => panic!("the last layer ends"),
            }
        } else if down {
            layers.layers()[layer + 1].eta
        } else if layer == 0 {
            layers.eta_above()
        } else {
            layers.layers()[layer - 1].eta
        };
        let eta = medium.eta / there;
        if random.uniform() < fresnel_from_inside(ray.direction[2].abs(), eta) {
            ray.direction[2] = -ray.direction[2];
            continue;
        }
        let [x, y] = [eta * ray.direction[0], eta * ray.direction[1]];
        let cosine = (1.0 - x * x - y * y).max(0.0).sqrt();
        ray.direction = [x, y, if down { cosine } else { -cosine }];
        match (down, layer) {
            (true, _) if layer + 1 == tops.len() => return End::Transmitted(radius(&ray), cosine),
            (true, _) => layer += 1,
            (false, 0) => return End::Reflected(radius(&ray), cosine),
            (false, _) => layer -= 1,
        }
    }
}
