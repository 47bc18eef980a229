//! Profiles of layers, against exact layers and walks through the same layers.

use std::f64::consts::PI;

use glam::Vec3;
use translucid_reference::layers::{DiffuseProfile, Ground, Layers};
use translucid_render::NoteKind;
use translucid_scene::{Material, Object, Scene, SubsurfaceModel, WalkSurface};

use crate::common::{
    assert_within, distant, flux_of, matte, measure, on_threads, prepare, quad, sample_ray, samples,
    uniform_environment,
};
use crate::shells::{coefficients, exact_layer, innermost, material, on_plane, per_channel, plane, skin};

/// A material of layers with their profile.
fn profiled(g: f32, eta: f32) -> Material {
    Material {
        subsurface_model: SubsurfaceModel::Layers,
        subsurface_scatter_anisotropy: g,
        subsurface_eta: eta,
        ..material(WalkSurface::Diffuse, skin(g))
    }
}

/// The profile of each channel.
fn exact(material: &Material) -> [DiffuseProfile; 3] {
    let (g, eta) = (material.subsurface_scatter_anisotropy, material.subsurface_eta);
    [0, 1, 2].map(|c| {
        let mut layers: Vec<_> = material.layers.iter().map(|layer| exact_layer(layer, c)).collect();
        layers.push(innermost(c, g, eta, f64::INFINITY));
        let layers = layers.into_iter().map(|layer| layer.with_eta(eta.into())).collect();
        Layers::new(1.0, layers, Ground::None).unwrap().diffuse_profile().unwrap()
    })
}

#[test]
fn plane_in_diffuse_light_returns_the_total_of_exact_layers() {
    for (g, eta) in [(0.0, 1.0), (0.8, 1.0), (0.6, 1.4)] {
        let material = profiled(g, eta);
        let totals = exact(&material).map(|profile| profile.total());
        let mut scene = plane(material);
        scene.environment = uniform_environment(Vec3::ONE);
        let renderer = prepare(scene);
        assert!(renderer.notes().is_empty(), "{:?}", renderer.notes());
        let result = flux_of(|sample| sample.subsurface, &renderer, samples(1 << 17), on_plane);
        assert_within(&format!("{g} {eta}"), result, per_channel(|c| totals[c]));
        let precision = (result.0 / per_channel(|c| totals[c]) - 1.0).abs().max_element();
        assert!(precision < 0.01, "{g} {eta}: {precision}");
    }
}

/// A plane whose half at x < 0 is in the shadow of an edge high above.
fn edge(material: Material) -> Scene {
    let mut scene = plane(material);
    scene.materials.push(matte(Vec3::ZERO));
    let blind = quad(Vec3::new(-500.0, 0.0, 100.0), Vec3::X * 500.0, Vec3::Y * 500.0);
    let blind = Object { mesh: blind.into(), material: 1, subsurface_group: 1, ..scene.objects[0].clone() };
    scene.objects.push(blind);
    scene.lights.push(distant(Vec3::Z));
    scene
}

/// Light that leaves at a distance into the shadow.
fn beyond_edge(profile: &DiffuseProfile, distance: f64) -> f64 {
    let (steps, step) = (1500, 0.008);
    let ring = |i: i32| {
        let r = distance * (step * (f64::from(i) + 0.5)).exp();
        2.0 * (distance / r).acos() * r * r * step * profile.reflectance(r)
    };
    (0..steps).map(ring).sum()
}

/// Light bleeds over an edge as exact layers have it, and as walks have it.
#[test]
fn edge_of_light_is_that_of_exact_layers_and_of_the_walk() {
    for g in [0.0, 0.8] {
        let material = profiled(g, 1.0);
        let profiles = exact(&material);
        let walk = Material {
            subsurface_model: SubsurfaceModel::RandomWalk(WalkSurface::Diffuse),
            ..material.clone()
        };
        let [profiled, walked] = [material, walk].map(|material| prepare(edge(material)));
        for x in [-1.2_f32, -0.4, -0.1, 0.1, 0.4] {
            let from = Vec3::new(x, 0.3, 1.0);
            let expected = per_channel(|c| {
                let across = beyond_edge(&profiles[c], f64::from(x).abs());
                (if x < 0.0 { across } else { profiles[c].total() - across }) / PI
            });
            for (name, renderer) in [("profile", &profiled), ("walk", &walked)] {
                let (mean, error) = measure(renderer, from, Vec3::NEG_Z, samples(1 << 17));
                // The solution is exact to 0.4 % of its total
                let allowed = 4.0 * error + per_channel(|c| 4e-3 * profiles[c].total() / PI);
                let off = (mean - expected).abs();
                assert!(off.cmple(allowed).all(), "{name} g {g} x {x}: {mean} ± {error}, exactly {expected}");
            }
        }
    }
}

#[test]
fn layers_that_are_not_solved_are_walked_through_and_named() {
    let layers = vec![coefficients(0.1, [1.0, 1e4, 1.0], [0.1, 0.1, 0.1], 0.0)];
    let material = Material { layers, ..profiled(0.0, 1.0) };
    let mut scene = plane(material);
    scene.environment = uniform_environment(Vec3::ONE);
    let renderer = prepare(scene);
    let notes = renderer.notes();
    assert_eq!((notes.len(), notes[0].kind), (1, NoteKind::StandIn));
    let expected = "material layered: layers: green: greatest extinction over the least is ";
    assert!(notes[0].to_string().starts_with(expected), "{}", notes[0]);
    assert!(
        notes[0].to_string().ends_with("random-walk-diffuse stands in for their profile"),
        "{}",
        notes[0]
    );
}

#[test]
fn profile_has_the_same_bits_on_any_number_of_threads() {
    let bits = |threads| {
        on_threads(threads, || {
            let renderer = prepare(edge(profiled(0.5, 1.3)));
            let from = Vec3::new(-0.2, 0.3, 1.0);
            [0, 1, 2, 3].map(|i| {
                sample_ray(&renderer, from, Vec3::NEG_Z, 5, i).radiance().to_array().map(f32::to_bits)
            })
        })
    };
    assert_eq!(bits(1), bits(3));
}
