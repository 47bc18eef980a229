//! Laws of where photons leave and in which direction: rings of single scattering, cosines, reciprocity.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use translucid_profile::quadrature::{gauss_legendre, integrate};
use translucid_profile::{fresnel_from_inside, fresnel_from_outside};

use super::chi_square::{deviate_of_count, deviate_of_counts};
use super::{Parameters, PhaseFunction, PhaseTable, PhotonCounts, PhotonExit, Problem, Side, trace};
use crate::Incidence;

/// Hands every exit to a function.
fn for_each_exit(
    parameters: Parameters,
    albedo: f64,
    seed: u64,
    photons: u64,
    mut call: impl FnMut(&PhotonExit),
) -> PhotonCounts {
    let problem = Problem::new(parameters).unwrap();
    trace(&problem, albedo, seed, 0..photons, &mut |exits| exits.iter().for_each(&mut call))
}

fn radius(exit: &PhotonExit) -> f64 {
    f64::from(exit.x).hypot(f64::from(exit.y))
}

/// Energy that leaves within r after one collision, from physics.md §3.
///
/// ```text
/// 2πα ∫₀¹ (1 − F(μ)) p(−μ) μ/(1+μ) [1 − exp(−r √((1+μ)/(1−μ)))] dμ
/// ```
///
/// A photon that the face reflects after its first collision cannot come back without a second.
fn single_scattering(parameters: &Parameters, albedo: f64, r: f64) -> f64 {
    let eta = parameters.eta;
    let critical = (1.0 - 1.0 / (eta * eta)).max(0.0).sqrt();
    let rule = gauss_legendre(64);
    // μ = critical + (1 − critical) sin² v is smooth in v at both ends
    let width = 1.0 - critical;
    integrate(&rule, 0.0, FRAC_PI_2, |v| {
        let (sine, cosine) = v.sin_cos();
        let mu = critical + width * sine * sine;
        let slope = 2.0 * width * sine * cosine;
        let far =
            if r.is_finite() { (-r * ((1.0 + mu) / (width * cosine * cosine)).sqrt()).exp() } else { 0.0 };
        let passes = 1.0 - fresnel_from_inside(mu, eta);
        2.0 * PI * albedo * passes * parameters.phase_function.eval(-mu) * mu / (1.0 + mu)
            * (1.0 - far)
            * slope
    })
}

/// χ² over 10 rings for 36 media beyond 4σ: false alarm 1.2e-3.
#[test]
fn single_scattering_leaves_in_its_rings() {
    let edges = [0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, f64::INFINITY];
    let hg = |g| PhaseFunction::HenyeyGreenstein { g };
    let (albedo, photons) = (0.6, 4_000_000);
    let two_term = PhaseFunction::TwoTerm { weight: 0.9, g1: 0.9, g2: -0.5 };
    let rayleigh = PhaseFunction::Moments([0.0, 0.1].into());
    let rows = (0..=20).map(|i| f64::from(i) / 10.0 - 1.0).map(|x| [x, (x - 0.1).abs() + 0.1 * (x + 1.0)]);
    let bent = PhaseFunction::Table(Arc::new(PhaseTable::new(rows.collect()).unwrap()));
    for phase_function in
        [hg(0.0), hg(0.5), hg(0.8), hg(0.9), hg(-0.5), PhaseFunction::Rayleigh, two_term, rayleigh, bent]
    {
        for eta in [1.0, 1.33, 1.4, 1.5] {
            let phase_function = phase_function.clone();
            let parameters = Parameters { phase_function, eta, ..Parameters::default() };
            let mut counts = [0u64; 10];
            for_each_exit(parameters.clone(), albedo, 201, photons, |exit| {
                if exit.order == 1 {
                    counts[edges.iter().position(|&edge| radius(exit) < edge).unwrap()] += 1;
                }
            });
            let mut below = 0.0;
            let expected: Vec<f64> = edges
                .iter()
                .map(|&edge| {
                    let enclosed = photons as f64 * single_scattering(&parameters, albedo, edge);
                    let ring = enclosed - below;
                    below = enclosed;
                    ring
                })
                .collect();
            let deviate = deviate_of_counts(&counts, &expected, photons);
            assert!(deviate < 4.0, "{parameters:?}: {deviate}\n{counts:?}\n{expected:?}");
        }
    }
}

/// ln H of isotropic scattering for a real albedo; as in `trace_totals`, where its numbers are checked.
fn h(alpha: f64, mu: f64) -> f64 {
    let rule = gauss_legendre(24);
    let edge = |k: i32| if k == 24 { FRAC_PI_2 } else { FRAC_PI_2 * (1.0 - 0.5f64.powi(k)) };
    let sum: f64 = (0..24)
        .map(|k| {
            integrate(&rule, edge(k), edge(k + 1), |theta| {
                let (sine, cosine) = theta.sin_cos();
                (1.0 - alpha * theta * cosine / sine).ln() / (cosine * cosine + mu * mu * sine * sine)
            })
        })
        .sum();
    (-mu / PI * sum).exp()
}

/// Under a normal beam the radiance that leaves is (α/4π) H(1) H(μ)/(1 + μ) (S. Chandrasekhar 1950, §34): the
/// energy per cosine (α/2) H(1) H(μ) μ/(1 + μ). χ² over 20 bins for 2 albedos beyond 4σ: false alarm 6e-5.
#[test]
fn cosines_of_exits_follow_the_h_function() {
    let photons = 2_000_000;
    for albedo in [0.5, 0.95] {
        let mut counts = [0u64; 20];
        for_each_exit(Parameters::default(), albedo, 202, photons, |exit| {
            counts[((20.0 * exit.cos_theta) as usize).min(19)] += 1;
        });
        let rule = gauss_legendre(8);
        let normal = h(albedo, 1.0);
        let expected: Vec<f64> = (0..20)
            .map(|i| {
                let per_cosine = |mu: f64| 0.5 * albedo * normal * h(albedo, mu) * mu / (1.0 + mu);
                let (from, to) = (f64::from(i) / 20.0, f64::from(i + 1) / 20.0);
                photons as f64 * integrate(&rule, from, to, per_cosine)
            })
            .collect();
        let deviate = deviate_of_counts(&counts, &expected, photons);
        assert!(deviate < 4.0, "{albedo} {deviate}: {counts:?} {expected:?}");
    }
}

/// Light that never collides: e^−τ of it reaches the far face, τ = t/μ, F of that is reflected, and so on. It
/// leaves at x = t tan θ, 2 t tan θ … |z| < 4 in 8 cases on both faces: false alarm 1e-3.
#[test]
fn unscattered_light_obeys_beers_law() {
    let photons = 1_000_000;
    for eta in [1.0, 1.5] {
        for (thickness, cos_theta) in [(0.3, 1.0), (1.0, 0.5), (2.0, 0.8), (0.1, 0.1)] {
            let sine = (1.0f64 - cos_theta * cos_theta).sqrt() / eta;
            let mu = (1.0 - sine * sine).sqrt();
            let passes = (-thickness / mu).exp();
            let reflects = fresnel_from_inside(mu, eta);
            let series = (1.0 - reflects) * passes / (1.0 - (reflects * passes).powi(2));
            let incidence = Incidence::Pencil { cos_theta };
            let mut counts = [0u64; 2];
            for_each_exit(
                Parameters { eta, thickness, incidence, ..Parameters::default() },
                0.5,
                203,
                photons,
                |exit| {
                    if exit.order == 0 {
                        let reflected = exit.side == Side::Reflected;
                        counts[usize::from(reflected)] += 1;
                        let crossings = f64::from(exit.x) / (thickness * sine / mu).max(1e-30);
                        let whole = crossings.round();
                        assert!((crossings - whole).abs() < 1e-4 && exit.y == 0.0, "{exit:?}");
                        assert!(sine == 0.0 || (whole % 2.0 == 0.0) == reflected, "{exit:?}");
                        assert!((f64::from(exit.cos_theta) - mu).abs() < 1e-6, "{exit:?}");
                    }
                },
            );
            let z = deviate_of_count(counts[0], photons, series);
            assert!(z.abs() < 4.0, "{eta} {thickness} {cos_theta}: z = {z}");
            if eta == 1.0 {
                assert_eq!(counts[1], 0);
            } else {
                let z = deviate_of_count(counts[1], photons, series * reflects * passes);
                assert!(z.abs() < 4.0, "{eta} {thickness} {cos_theta}: z = {z}");
            }
        }
    }
}

/// Helmholtz: in a slab the light from one cone to another equals that back, as
/// ∫ (1 − F(μ)) ρ(μ → other cone) μ dμ in cosines outside, on both faces. |z| < 4 for 8 statistics: false alarm
/// 5e-4.
#[test]
fn slab_is_reciprocal() {
    let nodes = gauss_legendre(6);
    let (steep, flat) = ((0.8, 1.0), (0.2, 0.4));
    for (eta, g, oblique) in [(1.0, 0.6, flat), (1.4, 0.8, flat), (0.8, -0.4, (0.62, 0.7)), (1.4, 0.0, flat)]
    {
        let phase_function = PhaseFunction::HenyeyGreenstein { g };
        // Energy from cone to cone per face, and its variance
        let exchange = |(from, to): (f64, f64), (low, high): (f64, f64), seed| {
            let mut energy = [(0.0, 0.0); 2];
            for (i, &(x, w)) in nodes.iter().enumerate() {
                let cos_theta = 0.5 * (from + to) + 0.5 * (to - from) * x;
                let weight = 0.5 * (to - from) * w * cos_theta * (1.0 - fresnel_from_outside(cos_theta, eta));
                let parameters = Parameters {
                    phase_function: phase_function.clone(),
                    eta,
                    thickness: 1.5,
                    incidence: Incidence::Pencil { cos_theta },
                    ..Parameters::default()
                };
                let photons = 150_000;
                let mut counts = [0u32; 2];
                for_each_exit(parameters, 0.95, seed + i as u64, photons, |exit| {
                    let inside = f64::from(exit.cos_theta);
                    let outside = (1.0 - eta * eta * (1.0 - inside * inside)).max(0.0).sqrt();
                    if exit.order > 0 && outside > low && outside < high {
                        counts[usize::from(exit.side == Side::Transmitted)] += 1;
                    }
                });
                for (sum, count) in energy.iter_mut().zip(counts) {
                    let share = f64::from(count) / photons as f64;
                    sum.0 += weight * share;
                    sum.1 += weight * weight * share * (1.0 - share) / photons as f64;
                }
            }
            energy
        };
        let there = exchange(oblique, steep, 300);
        let back = exchange(steep, oblique, 400);
        for ((a, va), (b, vb)) in there.into_iter().zip(back) {
            let z = (a - b) / (va + vb).sqrt();
            assert!(a > 0.0 && z.abs() < 4.0, "{eta} {g}: {a} {b}, z = {z}");
        }
    }
}

/// A slab without thickness shows the entry itself: cosines of diffuse light ∝ μ (1 − F(μ)) inside, points
/// evenly over the spot. χ² over 20 bins each, 5 cases beyond 4σ: false alarm 3e-4.
#[test]
fn entry_has_its_distribution() {
    let photons = 500_000;
    for eta in [0.7, 1.0, 1.4, 3.0] {
        let critical = (1.0f64 - 1.0 / (eta * eta)).max(0.0).sqrt();
        let bin = |mu: f64| (20.0 * (mu - critical) / (1.0 - critical)).clamp(0.0, 19.0) as usize;
        let mut cosines = [0u64; 20];
        let mut areas = [0u64; 20];
        let parameters = Parameters {
            eta,
            thickness: 1e-30,
            incidence: Incidence::Cosine,
            spot_radius: 2.0,
            ..Parameters::default()
        };
        for_each_exit(parameters, 0.5, 204, photons, |exit| {
            assert_eq!(exit.order, 0);
            cosines[bin(f64::from(exit.cos_theta))] += 1;
            areas[(5.0 * radius(exit).powi(2)).min(19.0) as usize] += 1;
        });
        let rule = gauss_legendre(32);
        let energy = |from: f64, to: f64| {
            // μ = from + (to − from) v² smooths the root at the critical angle
            integrate(&rule, 0.0, 1.0, |v| {
                let mu = from + (to - from) * v * v;
                2.0 * v * (to - from) * mu * (1.0 - fresnel_from_inside(mu, eta))
            })
        };
        let edge = |i: usize| critical + (1.0 - critical) * i as f64 / 20.0;
        let all: f64 = (0..20).map(|i| energy(edge(i), edge(i + 1))).sum();
        let expected: Vec<f64> =
            (0..20).map(|i| photons as f64 * energy(edge(i), edge(i + 1)) / all).collect();
        let deviate = deviate_of_counts(&cosines[1..], &expected[1..], photons);
        assert!(deviate < 4.0, "{eta} {deviate}: {cosines:?} {expected:?}");
        let deviate = deviate_of_counts(&areas[1..], &[photons as f64 / 20.0; 19], photons);
        assert!(deviate < 4.0, "{eta} {deviate}: {areas:?}");
    }
}
