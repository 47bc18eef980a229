//! Laws that every shape obeys.

use std::collections::HashMap;
use std::sync::OnceLock;

use glam::Vec3;
use translucid_scene::Triangle;

use super::*;

/// Every shape with its defaults, and with each count and ratio at its ends.
fn samples() -> &'static [(String, Mesh)] {
    static SAMPLES: OnceLock<Vec<(String, Mesh)>> = OnceLock::new();
    SAMPLES.get_or_init(|| SHAPES.iter().flat_map(samples_of).collect())
}

fn samples_of(shape: &Shape) -> Vec<(String, Mesh)> {
    let build = |parameters: ShapeParameters| {
        (format!("{} {parameters:?}", shape.name), build_shape(shape.name, &parameters).expect(shape.name))
    };
    let mut list = vec![build(ShapeParameters::new())];
    let has_detail = shape.parameters.iter().any(|parameter| parameter.name == "detail");
    for parameter in shape.parameters.iter().filter(|p| p.kind != ShapeParameterKind::Length) {
        let coarse =
            if has_detail { ShapeParameters::new().with("detail", 40.0) } else { ShapeParameters::new() };
        // Great counts are only slow.
        let high = parameter.max.min(4.0 * parameter.default).min(64.0_f64.max(parameter.min));
        list.extend([parameter.min, high].map(|value| build(coarse.clone().with(parameter.name, value))));
    }
    list
}

fn solids() -> impl Iterator<Item = &'static (String, Mesh)> {
    samples().iter().filter(|(name, _)| !["rectangle", "disc"].iter().any(|flat| name.starts_with(flat)))
}

fn corners(mesh: &Mesh, triangle: Triangle) -> [Vec3; 3] {
    triangle.map(|vertex| mesh.positions[vertex as usize])
}

/// Vertices by position: seams have several vertices in one place.
fn welded(mesh: &Mesh) -> Vec<Triangle> {
    let mut ids = HashMap::new();
    let mut id = |p: Vec3| {
        let next = ids.len() as u32;
        // Adding zero makes −0 and 0 the same place.
        *ids.entry((p + Vec3::ZERO).to_array().map(f32::to_bits)).or_insert(next)
    };
    mesh.triangles.iter().map(|&triangle| corners(mesh, triangle).map(&mut id)).collect()
}

#[test]
fn shape_is_closed_and_manifold() {
    for (name, mesh) in solids() {
        let mut edges: HashMap<(u32, u32), usize> = HashMap::new();
        for [a, b, c] in welded(mesh) {
            for edge in [(a, b), (b, c), (c, a)] {
                *edges.entry(edge).or_default() += 1;
            }
        }
        for (&(a, b), &count) in &edges {
            assert_eq!(count, 1, "{name}: edge {a}–{b} is used {count} times in one direction");
            assert_eq!(edges.get(&(b, a)), Some(&1), "{name}: edge {a}–{b} has no partner");
        }
    }
}

#[test]
fn shape_encloses_positive_volume() {
    for (name, mesh) in solids() {
        let volume: f64 = mesh
            .triangles
            .iter()
            .map(|&triangle| {
                let [a, b, c] = corners(mesh, triangle).map(|p| p.as_dvec3());
                a.dot(b.cross(c)) / 6.0
            })
            .sum();
        assert!(volume > 0.0, "{name}: volume {volume}");
    }
}

#[test]
fn shape_has_sound_arrays() {
    for (name, mesh) in samples() {
        let count = mesh.positions.len();
        assert!(!mesh.triangles.is_empty(), "{name}");
        assert!(mesh.triangles.iter().flatten().all(|&vertex| (vertex as usize) < count), "{name}");
        assert!(mesh.positions.iter().all(|p| p.is_finite()), "{name}");
        assert_eq!(mesh.normals.len(), count, "{name}");
        assert!(mesh.uvs.is_empty() || mesh.uvs.len() == count, "{name}");
        assert!(mesh.colors.is_empty() || mesh.colors.len() == count, "{name}");
        assert!(mesh.uvs.iter().all(|uv| uv.is_finite()), "{name}");
        assert!(mesh.colors.iter().all(|c| c.min_element() >= 0.0 && c.max_element() <= 1.0), "{name}");
    }
}

#[test]
fn normals_are_unit_and_agree_with_triangles() {
    for (name, mesh) in samples() {
        assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-4), "{name}");
        for &triangle in &mesh.triangles {
            let [a, b, c] = corners(mesh, triangle);
            let geometric = (b - a).cross(c - a);
            assert!(geometric.length_squared() > 0.0, "{name}: zero area at {a}");
            for vertex in triangle {
                let agreement = geometric.normalize().dot(mesh.normals[vertex as usize]);
                assert!(
                    agreement > 0.0,
                    "{name}: normal at {} agrees by {agreement}",
                    mesh.positions[vertex as usize]
                );
            }
        }
    }
}

#[test]
fn shape_is_deterministic() {
    let defaults = format!("{:?}", ShapeParameters::new());
    for name in shape_names() {
        let (_, before) =
            samples().iter().find(|(sample, _)| *sample == format!("{name} {defaults}")).expect(name);
        assert_eq!(*before, build_shape(name, &ShapeParameters::new()).expect(name), "{name}");
    }
}

#[test]
fn parameter_out_of_range_is_refused() {
    for shape in SHAPES {
        for parameter in shape.parameters {
            for value in [parameter.min - 1.0, parameter.max * 2.0 + 1.0, f64::NAN, f64::INFINITY] {
                let parameters = ShapeParameters::new().with(parameter.name, value);
                let error = build_shape(shape.name, &parameters).expect_err(parameter.name);
                assert!(error.message.contains(parameter.name), "{error}");
            }
        }
    }
}

#[test]
fn count_must_be_whole() {
    let error =
        build_shape("sphere", &ShapeParameters::new().with("segments", 8.5)).expect_err("8.5 segments");
    assert!(error.message.contains("8.5"), "{error}");
}

#[test]
fn unknown_names_are_refused_with_the_known_ones() {
    let error = build_shape("spere", &ShapeParameters::new()).expect_err("no such shape");
    assert!(error.help.expect("help").contains("sphere"));
    let error =
        build_shape("sphere", &ShapeParameters::new().with("radus", 1.0)).expect_err("no such parameter");
    assert!(error.help.expect("help").contains("radius"));
}

#[test]
fn sphere_vertices_lie_on_it() {
    let mesh = build_shape("sphere", &ShapeParameters::new().with("segments", 256.0)).expect("sphere");
    assert!(mesh.positions.iter().all(|p| (p.length() - 1.0).abs() < 1e-6));
}
