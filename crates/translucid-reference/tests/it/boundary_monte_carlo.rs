//! The exact half space against a plain walk, where the beam is oblique or the boundary reflects.
//!
//! The walk is scalar, analog and has nothing in common with the crate's own: flight lengths −ln u, isotropic
//! scattering, absorption and reflection by the toss of a coin. Its counts are multinomial, and χ² over rings and
//! sectors (with one more cell for what is absorbed or leaves elsewhere) is below its 99.9 % quantile: with the
//! seeds fixed, each test would have raised a false alarm once in a thousand.

use std::f64::consts::{PI, TAU};

use translucid_profile::quadrature::{gauss_legendre, integrate};
use translucid_profile::{fresnel_from_inside, fresnel_from_outside};
use translucid_reference::Incidence;
use translucid_reference::exact::{HalfSpace, ObliqueHalfSpace};
use translucid_testing::{SplitMix, bound, is_thorough, power};

use crate::plain_walk::Random;
use crate::solutions::{half_space, oblique};
use crate::statistics::chi_square_deviate;

fn photons() -> u64 {
    power(1_000_000)
}

const RINGS: [f64; 12] = [0.0, 0.05, 0.1, 0.2, 0.4, 0.7, 1.0, 1.5, 2.0, 3.0, 5.0, 9.0];
/// Few octaves of radii: with a boundary each takes a second for the harmonics.
const FEW_RINGS: [f64; 5] = [0.2, 0.4, 0.7, 1.0, 1.5];
const SECTORS: usize = 6;

/// Follows a photon that has entered at the origin with the direction (sin, 0, cos); where it leaves, if it does.
fn walk(alpha: f64, eta: f64, cos: f64, random: &mut Random) -> Option<(f64, f64)> {
    let mut direction = [(1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos];
    let mut position = [0.0; 3];
    loop {
        let mut length = -random.next().ln();
        let below = position[2] + length * direction[2];
        if below < 0.0 {
            let to_surface = -position[2] / direction[2];
            let exit = [position[0] + to_surface * direction[0], position[1] + to_surface * direction[1]];
            if random.next() > fresnel_from_inside(direction[2], eta) {
                return Some((exit[0], exit[1]));
            }
            position = [exit[0], exit[1], 0.0];
            direction[2] = -direction[2];
            length -= to_surface;
        }
        for axis in 0..3 {
            position[axis] += length * direction[axis];
        }
        if random.next() > alpha {
            return None;
        }
        let cos = 2.0 * random.next() - 1.0;
        let sin = (1.0 - cos * cos).sqrt();
        let (sin_phi, cos_phi) = (TAU * random.next()).sin_cos();
        direction = [sin * cos_phi, sin * sin_phi, cos];
    }
}

/// Counts over rings and sectors of |φ|; with one sector over rings alone.
fn count(rings: &[f64], sectors: usize, mut photon: impl FnMut() -> Option<(f64, f64)>) -> Vec<f64> {
    let mut counts = vec![0.0; (rings.len() - 1) * sectors];
    for _ in 0..photons() {
        let Some((x, y)) = photon() else { continue };
        let edges_within = rings.partition_point(|&edge| edge <= x.hypot(y));
        if edges_within > 0 && edges_within < rings.len() {
            let ring = edges_within - 1;
            let sector = (y.abs().atan2(x) / PI * sectors as f64) as usize;
            counts[ring * sectors + sector.min(sectors - 1)] += 1.0;
        }
    }
    counts
}

/// Standard normal deviate of χ².
fn deviate(counts: &[f64], probabilities: &[f64]) -> f64 {
    let photons = photons() as f64;
    let cell = |observed: f64, expected: f64| (observed - expected) * (observed - expected) / expected;
    let cells = counts.iter().zip(probabilities).map(|(&count, p)| cell(count, photons * p));
    let rest =
        cell(photons - counts.iter().sum::<f64>(), photons * (1.0 - probabilities.iter().sum::<f64>()));
    chi_square_deviate(cells.sum::<f64>() + rest, counts.len())
}

/// 99.9 % quantile of the normal distribution.
const QUANTILE: f64 = 3.09;

/// Energy of each ring and sector (both sides of the plane of incidence).
fn oblique_cells(rings: &[f64], half_space: &ObliqueHalfSpace) -> Vec<f64> {
    let (radii, azimuths) = (gauss_legendre(6), gauss_legendre(5));
    let mut cells = Vec::new();
    for ring in rings.windows(2) {
        for sector in 0..SECTORS {
            let (from, to) = (PI * sector as f64 / SECTORS as f64, PI * (sector + 1) as f64 / SECTORS as f64);
            cells.push(integrate(&radii, ring[0], ring[1], |r| {
                2.0 * r * integrate(&azimuths, from, to, |phi| half_space.eval(r, phi).value)
            }));
        }
    }
    cells
}

fn refracted(eta: f64, cos: f64) -> f64 {
    (1.0 - (1.0 - cos * cos) / (eta * eta)).sqrt()
}

/// Counts of a walk, and their deviate from the exact solution.
fn compare(rings: &[f64], alpha: f64, eta: f64, cos: f64, seed: u64) -> (Vec<f64>, f64) {
    let half_space = oblique(alpha, eta, cos);
    let mut random = Random(SplitMix(seed));
    let counts = count(rings, SECTORS, || walk(alpha, eta, refracted(eta, cos), &mut random));
    let z = deviate(&counts, &oblique_cells(rings, &half_space));
    (counts, z)
}

#[test]
fn oblique_beam_agrees_with_a_walk() {
    let (counts, z) = compare(&RINGS, 0.9, 1.0, 0.5, 1);
    assert!(z < QUANTILE, "{z} standard deviations");
    // The same counts tell a beam that is one degree off
    let off = oblique(0.9, 1.0, (60.0 + bound(1.0)).to_radians().cos());
    let z = deviate(&counts, &oblique_cells(&RINGS, &off));
    assert!(z > QUANTILE, "another angle: {z} standard deviations");
}

#[test]
fn oblique_beam_through_a_boundary_agrees_with_a_walk() {
    let (counts, z) = compare(&FEW_RINGS, 0.9, 1.4, 0.5, 2);
    assert!(z < QUANTILE, "{z} standard deviations");
    // The same counts tell a beam that is not refracted
    let straight = oblique(0.9, 1.0, 0.5);
    let z = deviate(&counts, &oblique_cells(&FEW_RINGS, &straight));
    assert!(z > QUANTILE, "not refracted: {z} standard deviations");
}

#[test]
fn oblique_beam_into_a_thinner_medium_agrees_with_a_walk() {
    let (_, z) = compare(&FEW_RINGS, 0.8, 0.8, 0.8, 3);
    assert!(z < QUANTILE, "{z} standard deviations");
}

#[test]
fn rings_under_a_boundary_agree_with_a_walk() {
    for (alpha, eta, incidence, seed) in [
        (0.9, 1.33, Incidence::NORMAL, 4),
        (0.8, 1.5, Incidence::Cosine, 5),
        (0.9, 0.8, Incidence::Cosine, 6),
        (0.9, 1.4, Incidence::UniformCosine, 7),
    ] {
        let solution = half_space(alpha, eta, incidence);
        let mut random = Random(SplitMix(seed));
        let counts = count(&RINGS, 1, || {
            let cos = match incidence {
                Incidence::Pencil { cos_theta } => refracted(eta, cos_theta),
                Incidence::UniformCosine => random.next(),
                // What the boundary reflects from outside does not count as entered
                Incidence::Cosine => loop {
                    let cos = random.next().sqrt();
                    if random.next() > fresnel_from_outside(cos, eta) {
                        break refracted(eta, cos);
                    }
                },
            };
            walk(alpha, eta, cos, &mut random)
        });
        let rings = |half_space: &HalfSpace| -> Vec<f64> {
            RINGS
                .windows(2)
                .map(|ring| {
                    half_space.enclosed(ring[1]).value
                        - if ring[0] > 0.0 { half_space.enclosed(ring[0]).value } else { 0.0 }
                })
                .collect()
        };
        let z = deviate(&counts, &rings(&solution));
        assert!(z < QUANTILE, "alpha {alpha}, eta {eta}, {incidence:?}: {z} standard deviations");
        // The same counts tell another index
        if seed == 5 || is_thorough() && matches!(incidence, Incidence::Cosine) {
            let other = half_space(alpha, eta + bound(0.1), incidence);
            let z = deviate(&counts, &rings(&other));
            assert!(z > QUANTILE, "another index: {z} standard deviations");
        }
    }
}
