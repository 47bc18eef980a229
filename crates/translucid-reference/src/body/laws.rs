//! The walk in a body against what is exact, and against the other walks.
//!
//! Seeds are fixed. A share counts as right within four standard errors: false-alarm rate 6e-5 a comparison, below 0.3 %
//! for all of them together.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, PI};

use translucid_profile::{Configuration, half_space_single_scattering_albedo};
use translucid_testing::power;

use super::photon::Fate;
use super::{Body, Interior, Lighting, PhotonEnd, Shape, Tally};
use crate::Estimate;

fn photons() -> u64 {
    power(200_000)
}

fn isotropic(single_scattering_albedo: f64) -> Interior {
    Interior { single_scattering_albedo, g: 0.0, eta: 1.0 }
}

fn walk(shape: Shape, medium: Interior, light: Lighting) -> Tally {
    Body::new(shape, medium, light).unwrap().walk(photons(), 7)
}

fn assert_near(name: &str, found: Estimate, expected: f64) {
    let z = (found.value - expected) / found.error;
    assert!(z.abs() < 4.0, "{name}: {} ± {}, expected {expected}, z = {z}", found.value, found.error);
}

/// Midpoint sum of f over (0, 1).
fn integral(f: impl Fn(f64) -> f64) -> f64 {
    let n = 4000;
    (0..n).map(|i| f((f64::from(i) + 0.5) / f64::from(n))).sum::<f64>() / f64::from(n)
}

/// Far from any other part of the surface all bodies are half spaces: what leaves is the exact A.
#[test]
fn huge_bodies_return_the_surface_albedo() {
    let shapes = [
        Shape::Sphere { radius: 1e5 },
        Shape::Slab { thickness: 1e3 },
        Shape::Wedge { angle: FRAC_PI_3, distance: 1e3 },
        Shape::Wedge { angle: PI - 1e-9, distance: 1.0 },
    ];
    for (light, configuration) in
        [(Lighting::Uniform, Configuration::Diffuse), (Lighting::Distant, Configuration::Searchlight)]
    {
        for a in [0.2, 0.8] {
            let medium = isotropic(half_space_single_scattering_albedo(a, configuration));
            for shape in shapes {
                // All over a sphere parallel light arrives at all angles
                if light == Lighting::Uniform || !matches!(shape, Shape::Sphere { .. }) {
                    let tally = walk(shape, medium, light);
                    assert_near(&format!("{shape:?} {light:?} {a}"), tally.leaving(), a);
                }
            }
        }
    }
}

/// A pencil that has entered a half space of α = 0.9 and η = 1.4, by the exact solution of the dielectric half space.
#[test]
fn boundary_returns_what_the_exact_half_space_says() {
    let medium = Interior { eta: 1.4, ..isotropic(0.9) };
    for shape in [Shape::Slab { thickness: 300.0 }, Shape::Wedge { angle: FRAC_PI_2, distance: 300.0 }] {
        assert_near(
            &format!("{shape:?}"),
            walk(shape, medium, Lighting::Distant).leaving(),
            0.257_755_746_27,
        );
    }
}

#[test]
fn nothing_is_lost_without_absorption() {
    for medium in [isotropic(1.0), Interior { g: 0.7, eta: 1.4, ..isotropic(1.0) }] {
        for shape in [Shape::Slab { thickness: 3.0 }, Shape::Sphere { radius: 2.0 }] {
            for light in [Lighting::Uniform, Lighting::Distant] {
                assert_eq!(walk(shape, medium, light).leaving().value, 1.0, "{shape:?} {medium:?} {light:?}");
            }
        }
    }
}

/// 2 E₃(τ) through a slab, (1 − (1 + τ) e^{−τ}) 2/τ² through a sphere of diameter τ, and through a right wedge
/// (2/π) ∫₀¹ √(1 − μ²) e^{−x/μ} dμ at the distance x from its edge.
#[test]
fn straight_light_follows_beer_and_lambert() {
    let medium = isotropic(0.5);
    for tau in [0.1_f64, 1.0, 4.0] {
        let slab = walk(Shape::Slab { thickness: tau }, medium, Lighting::Uniform);
        assert_near("slab", slab.straight_through(1), integral(|mu| 2.0 * mu * (-tau / mu).exp()));
        assert_eq!(slab.straight_through(0).value, 0.0);
        let pencil = walk(Shape::Slab { thickness: tau }, medium, Lighting::Distant);
        assert_near("pencil", pencil.straight(), (-tau).exp());
        let sphere = (1.0 - (1.0 + tau) * (-tau).exp()) * 2.0 / (tau * tau);
        for light in [Lighting::Uniform, Lighting::Distant] {
            let tally = walk(Shape::Sphere { radius: 0.5 * tau }, medium, light);
            assert_near(&format!("sphere {light:?}"), tally.straight(), sphere);
        }
        let wedge = walk(Shape::Wedge { angle: FRAC_PI_2, distance: tau }, medium, Lighting::Uniform);
        let expected = 2.0 / PI * integral(|mu| (1.0 - mu * mu).sqrt() * (-tau / mu).exp());
        assert_near("wedge", wedge.straight_through(1), expected);
    }
}

/// Light that leaves a sphere after exactly one collision: 4/S ∫ P(x)² dV, because uniform light reaches x with the
/// probability P(x) with which light from x escapes; for a thin one the mean chord, 4V/S = 4ρ/3.
#[test]
fn first_collisions_of_a_sphere_have_their_closed_form() {
    for radius in [0.02, 0.5, 2.0_f64] {
        let body = Body::new(Shape::Sphere { radius }, isotropic(1.0), Lighting::Uniform).unwrap();
        let tally = Tally::of_photons(1, photons(), 11, |random| {
            let end = body.photon(random);
            let fate = if let Fate::Left(_) = end.fate { Fate::Left(0) } else { end.fate };
            PhotonEnd { fate, collisions: u64::from(end.collisions == 1), ..end }
        });
        let escape = |r: f64| {
            let chord = |mu: f64| (r * r * mu * mu + radius * radius - r * r).sqrt() - r * mu;
            0.5 * [1.0, -1.0].map(|side| integral_of(400, |mu| (-chord(side * mu)).exp())).iter().sum::<f64>()
        };
        let expected = 4.0 * radius * integral_of(400, |t| t * t * escape(radius * t).powi(2));
        assert_near(&format!("radius {radius}"), tally.scattered(), expected);
        if radius < 0.1 {
            assert!((expected / (4.0 / 3.0 * radius) - 1.0).abs() < 0.05, "{expected}");
        }
    }
}

/// Midpoint sum of n points over (0, 1).
fn integral_of(n: u32, f: impl Fn(f64) -> f64) -> f64 {
    (0..n).map(|i| f((f64::from(i) + 0.5) / f64::from(n))).sum::<f64>() / f64::from(n)
}

/// Light leaves unless a collision absorbs it.
#[test]
fn absorbed_light_is_that_of_the_collisions() {
    for shape in [
        Shape::Sphere { radius: 2.0 },
        Shape::Slab { thickness: 1.0 },
        Shape::Wedge { angle: 0.4, distance: 2.0 },
    ] {
        let medium = Interior { g: -0.4, eta: 1.3, ..isotropic(0.8) };
        let tally = walk(shape, medium, Lighting::Uniform);
        assert_near(&format!("{shape:?}"), tally.leaving(), 1.0 - 0.2 * tally.mean_collisions());
        let parts: f64 = (0..shape.parts())
            .map(|part| tally.scattered_through(part).value + tally.straight_through(part).value)
            .sum();
        assert!((parts - tally.leaving().value).abs() < 1e-12);
        assert_eq!(tally.photons(), photons());
    }
}

#[test]
fn parallel_light_leaves_a_thick_sphere_at_the_front() {
    let body = Body::new(Shape::Sphere { radius: 10.0 }, isotropic(0.9), Lighting::Distant).unwrap();
    // Few photons get to the back
    let tally = body.walk(200_000, 7);
    let rings: Vec<f64> = (0..10).map(|ring| tally.scattered_through(ring).value).collect();
    assert!(rings.is_sorted_by(|a, b| a > b) && rings[0] > 100.0 * rings[9], "{rings:?}");
}

/// Parallel light on all of a sphere meets its surface at all angles as light from everywhere does.
#[test]
fn sphere_returns_as_much_of_parallel_light_as_of_even_light() {
    for medium in [isotropic(0.9), Interior { g: 0.6, eta: 1.4, ..isotropic(0.9) }] {
        let [even, parallel] = [Lighting::Uniform, Lighting::Distant]
            .map(|light| walk(Shape::Sphere { radius: 3.0 }, medium, light));
        let (a, b) = (even.leaving(), parallel.leaving());
        assert_near(&format!("{medium:?}"), Estimate { error: a.error.hypot(b.error), ..a }, b.value);
        // Even light leaves evenly
        let of_a_ring = even.scattered().value / 10.0;
        (0..10).for_each(|ring| assert_near("ring", even.scattered_through(ring), of_a_ring));
    }
}

/// The sharper an edge, the sooner light is out.
#[test]
fn wedge_loses_more_the_wider_it_is() {
    let shares = [0.3, 1.0, 2.0].map(|angle| {
        let tally = walk(Shape::Wedge { angle, distance: 1.0 }, isotropic(0.99), Lighting::Uniform);
        tally.leaving().value
    });
    assert!(shares[0] > shares[1] && shares[1] > shares[2], "{shares:?}");
}

#[test]
fn tally_does_not_depend_on_threads() {
    let body = Body::new(Shape::Sphere { radius: 1.0 }, isotropic(0.9), Lighting::Distant).unwrap();
    let tallies = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| body.walk(50_001, 5))
    });
    assert_eq!(tallies[0], tallies[1]);
    assert_eq!(tallies[0].photons(), 50_001);
    assert_ne!(tallies[0], body.walk(50_001, 6));
}

#[test]
fn parameters_out_of_range_are_refused() {
    let refused = |shape, medium| Body::new(shape, medium, Lighting::Uniform).unwrap_err().to_string();
    let sphere = Shape::Sphere { radius: 1.0 };
    let wedge = Shape::Wedge { angle: 1.0, distance: 1.0 };
    for (shape, medium, parameter) in [
        (Shape::Sphere { radius: 0.0 }, isotropic(0.5), "radius"),
        (Shape::Sphere { radius: f64::INFINITY }, isotropic(0.5), "radius"),
        (Shape::Slab { thickness: f64::NAN }, isotropic(0.5), "thickness"),
        (Shape::Wedge { angle: PI, distance: 1.0 }, isotropic(0.5), "angle"),
        (Shape::Wedge { angle: 1.0, distance: -1.0 }, isotropic(0.5), "distance"),
        (sphere, isotropic(1.1), "single_scattering_albedo"),
        (wedge, isotropic(1.0), "single_scattering_albedo"),
        (sphere, Interior { g: 1.0, ..isotropic(0.5) }, "g"),
        (sphere, Interior { eta: 0.0, ..isotropic(0.5) }, "eta"),
    ] {
        let message = refused(shape, medium);
        assert!(message.starts_with(parameter), "{message}");
    }
}
