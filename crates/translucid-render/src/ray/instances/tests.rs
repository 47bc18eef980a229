//! Instances against the triangles that they stand for.

use glam::{Affine3A, EulerRot, Quat};
use translucid_scene::{Material, Scene};
use translucid_shapes::{ShapeParameters, build_shape};

use super::*;
use crate::ray::{Body, FlightEnd, Geometry, SurfacePoint};

fn random(i: u32, salt: u32) -> f32 {
    sobol_burley::sample(i, salt, 13)
}

fn vector(i: u32, salt: u32) -> Vec3 {
    Vec3::new(random(i, salt), random(i, salt + 1), random(i, salt + 2)) - 0.5
}

/// Stretches of the places: turned, larger, mirrored, flat and long.
const SCALES: [Vec3; 6] = [
    Vec3::ONE,
    Vec3::new(2.0, 2.0, 2.0),
    Vec3::new(-1.0, 1.0, 1.0),
    Vec3::new(0.3, 1.0, 2.5),
    Vec3::new(-1.5, -0.5, -1.0),
    Vec3::new(0.02, 0.02, 0.02),
];

/// A torus in many places, with all that vertices may have, and a sphere of its own.
fn scene() -> Scene {
    let parameters = ShapeParameters::new().with("segments", 32.0);
    let mut mesh =
        build_shape("torus", &parameters).or_else(|_| build_shape("torus", &ShapeParameters::new()));
    let mesh = mesh.as_mut().expect("a torus");
    mesh.tangents = mesh.normals.iter().map(|n| n.any_orthonormal_vector().extend(1.0)).collect();
    mesh.colors = mesh.positions.iter().map(|p| p.abs().min(Vec3::ONE)).collect();
    let mesh = Arc::new(std::mem::take(mesh));
    let place = |i: u32| {
        let turn = Quat::from_euler(EulerRot::XYZ, 6.0 * random(i, 0), 6.0 * random(i, 1), random(i, 2));
        // Not all by similarity: a shear comes of two scales with a turn between them
        let scale = SCALES[i as usize % SCALES.len()];
        let shear = if i % 4 == 3 { Vec3::new(1.0, 0.6, 1.0) } else { Vec3::ONE };
        let far = if i.is_multiple_of(5) { 50.0 } else { 8.0 };
        Affine3A::from_scale_rotation_translation(shear, Quat::IDENTITY, far * vector(i, 3))
            * Affine3A::from_scale_rotation_translation(scale, turn, Vec3::ZERO)
    };
    let mut objects: Vec<Object> = (0..30)
        .map(|i| Object {
            name: format!("torus {i}"),
            mesh: Arc::clone(&mesh),
            world_from_local: if i == 0 { Affine3A::IDENTITY } else { place(i) },
            material: 0,
            // The last six share a group
            subsurface_group: i.min(24),
            is_movable: false,
        })
        .collect();
    let sphere = build_shape("sphere", &ShapeParameters::new()).expect("a sphere");
    objects.push(Object { mesh: sphere.into(), subsurface_group: 24, ..Object::default() });
    let scene = Scene { objects, materials: vec![Material::default()], ..Scene::default() };
    scene.validate().expect("a valid scene");
    scene
}

/// A ray toward one of the objects, from outside or near it.
fn ray(scene: &Scene, i: u32) -> Ray {
    let object = &scene.objects[i as usize % scene.objects.len()];
    let (low, high) = object.bounds();
    let size = (high - low).length();
    let target = 0.5 * (low + high) + (high - low) * vector(i, 20);
    let origin = target + vector(i, 23).normalize() * size * (0.1 + 3.0 * random(i, 26));
    let length = if i.is_multiple_of(3) { f32::INFINITY } else { size * 4.0 * random(i, 27) };
    Ray::segment(origin, (target - origin).normalize(), length)
}

/// Differences of equal numbers with rounding errors.
fn assert_same(a: &SurfacePoint, b: &SurfacePoint, error: f32) {
    assert_eq!((a.object, a.group), (b.object, b.group));
    assert!(a.position.distance(b.position) <= error, "{a:?} {b:?} {error}");
    if a.triangle == b.triangle {
        assert!(a.geometric_normal.distance(b.geometric_normal) < 1e-3, "{a:?} {b:?}");
        assert!(a.shading_normal.distance(b.shading_normal) < 2e-3, "{a:?} {b:?}");
        assert!(a.uv.distance(b.uv) < 1e-3 && a.color.distance(b.color) < 1e-3, "{a:?} {b:?}");
    }
}

/// Rays meet instances where they meet the triangles of these, but for those that pass an edge as narrowly as rounding
/// goes.
#[test]
fn instances_are_met_as_their_triangles_are() {
    let scene = scene();
    let (shared, flat) = (Geometry::sharing_all(&scene.objects), Geometry::sharing_none(&scene.objects));
    assert!(shared.memory() < flat.memory() / 8, "{} {}", shared.memory(), flat.memory());
    let (mut hits, mut differ, mut neighbors) = (0, 0, 0);
    for i in 0..60_000 {
        let ray = ray(&scene, i);
        let group = (i / 7) % 25;
        for query in 0..2 {
            let find = |geometry: &Geometry| match query {
                0 => geometry.closest(&ray),
                _ => geometry.closest_in_group(&ray, group),
            };
            let (a, b) = (find(&shared), find(&flat));
            let (Some(a), Some(b)) = (a, b) else {
                differ += u32::from(a.is_some() != b.is_some());
                continue;
            };
            hits += 1;
            let (p, q) = (shared.surface_point(&scene, &a), flat.surface_point(&scene, &b));
            if p.object != q.object {
                differ += 1;
                continue;
            }
            assert_eq!(shared.object(&a), p.object);
            assert_eq!(shared.object_and_triangle_of(&a), (p.object, p.triangle));
            let grazing = ray.direction.dot(q.geometric_normal).abs().max(1e-2);
            let error = (p.offset + 4.0 * f32::EPSILON * a.t) / grazing;
            if (a.t - b.t).abs() > error {
                // It passes one of two surfaces at its silhouette
                differ += 1;
                continue;
            }
            neighbors += u32::from(p.triangle != q.triangle);
            assert_same(&p, &q, 2.0 * error);
            assert!(shared.normal(&a).distance(p.geometric_normal) < 1e-5);
            assert_eq!(shared.position(&a), p.position);
        }
        differ += u32::from(shared.occluded(&ray) != flat.occluded(&ray));
        let count = |geometry: &Geometry| {
            let mut count = 0;
            geometry.all_in_group(&ray, group, |_| count += 1);
            count
        };
        differ += u32::from(count(&shared) != count(&flat));
    }
    assert!(hits > 30_000, "the test meets too few triangles: {hits}");
    assert!(differ < 30 && neighbors < 100, "{hits} hits, {differ} differ, {neighbors} are beside");
}

/// Points that are found by their triangle are as far from rounding errors as those that rays find, and numbers go both
/// ways.
#[test]
fn points_on_instances_are_those_of_their_triangles() {
    let scene = scene();
    let (shared, flat) = (Geometry::sharing_all(&scene.objects), Geometry::sharing_none(&scene.objects));
    for i in 0..2000 {
        let object = i % scene.objects.len() as u32;
        let triangle = (random(i, 30) * scene.objects[object as usize].mesh.triangles.len() as f32) as u32;
        let primitive = shared.primitive(object, triangle);
        assert_eq!(primitive, flat.primitive(object, triangle));
        assert_eq!(shared.object_and_triangle(primitive), (object, triangle));
        let center = scene.objects[object as usize].vertices(triangle as usize).iter().sum::<Vec3>() / 3.0;
        let (a, b) = (shared.point_on(&scene, primitive, center), flat.point_on(&scene, primitive, center));
        assert_eq!(
            (a.position, a.geometric_normal, a.shading_normal, a.uv),
            (b.position, b.geometric_normal, b.shading_normal, b.uv)
        );
        assert!(a.offset >= b.offset);
    }
}

/// No ray that starts at an instance's surface meets it again where it started, and none that starts inside gets out
/// unseen: flights end where they do among triangles.
#[test]
fn flights_in_instances_end_as_those_among_triangles() {
    let scene = scene();
    let (shared, flat) = (Geometry::sharing_all(&scene.objects), Geometry::sharing_none(&scene.objects));
    let (mut ends, mut differ) = (0, 0);
    for i in 0..40_000 {
        let object = i % 30;
        let triangle = (random(i, 30) * scene.objects[object as usize].mesh.triangles.len() as f32) as u32;
        let corners = scene.objects[object as usize].vertices(triangle as usize);
        let (u, v) = (0.6 * random(i, 31), 0.35 * random(i, 32));
        let at = corners[0] + (corners[1] - corners[0]) * u + (corners[2] - corners[0]) * v;
        let direction = vector(i, 33).normalize();
        let (low, high) = scene.objects[object as usize].bounds();
        let length = (high - low).length() * random(i, 36).powi(3);
        let end = |geometry: &Geometry| {
            let point = geometry.point_on(&scene, geometry.primitive(object, triangle), at);
            let body = Body::below(&scene, geometry, &point, 1.0);
            let (start, skipped) = body.enter(&point, direction)?;
            match body.fly(start, direction, length) {
                FlightEnd::Inside(_) => Some((length + skipped, true)),
                FlightEnd::Boundary { distance, hit } => {
                    let end = geometry.position(&hit);
                    assert!(body.connects(start, end, body.normal(&hit)) || distance < 10.0 * point.offset);
                    Some((distance + skipped, false))
                }
            }
        };
        let (Some(a), Some(b)) = (end(&shared), end(&flat)) else { continue };
        ends += u32::from(!b.1);
        let extent = (high - low).max_element();
        let is_same = a.1 == b.1 && (a.0 - b.0).abs() <= 2e-3 * extent;
        differ += u32::from(!is_same);
    }
    // Beside an edge a ray may pass on one side or the other
    assert!(ends > 5000 && differ < 60, "{ends} ends, {differ} differ");
}

/// Bounds of the distance are below the distance to every vertex, and not all of them are 0.
#[test]
fn clearances_of_instances_are_below_distances() {
    let scene = scene();
    let shared = Geometry::sharing_all(&scene.objects);
    let mut positive = 0;
    for i in 0..4000 {
        let object = i % 24;
        let placed = &scene.objects[object as usize];
        let alone = shared.alone(object).expect("an object alone in its group");
        let (low, high) = placed.bounds();
        let point = 0.5 * (low + high) + (high - low) * vector(i, 20);
        let vertices = 0..placed.mesh.positions.len() as u32;
        let nearest = vertices.map(|v| placed.position(v).distance(point)).fold(f32::INFINITY, f32::min);
        let bound = alone.clearance(point, 1e5);
        assert!(bound <= nearest, "{i}: {bound} {nearest}");
        positive += u32::from(bound > 0.0);
    }
    assert!(positive > 300, "{positive}");
    assert!(shared.alone(26).is_none() && shared.alone(30).is_none());
}

/// Ways of refracted light into an instance are those into its triangles.
#[test]
fn crossings_of_instances_are_those_of_their_triangles() {
    let scene = scene();
    let (shared, flat) = (Geometry::sharing_all(&scene.objects), Geometry::sharing_none(&scene.objects));
    let (mut found, mut missed) = (0, 0);
    for i in 0..3000 {
        let object = i % 24;
        let placed = &scene.objects[object as usize];
        let triangle = (random(i, 30) * placed.mesh.triangles.len() as f32) as u32;
        let center = placed.vertices(triangle as usize).iter().sum::<Vec3>() / 3.0;
        let (low, high) = placed.bounds();
        let size = (high - low).length();
        let beyond = match i % 2 {
            0 => LightOrigin::Along(vector(i, 40).normalize()),
            _ => LightOrigin::At(center + vector(i, 43).normalize() * size * (1.0 + random(i, 46))),
        };
        let crossings = |geometry: &Geometry| {
            let point = geometry.point_on(&scene, geometry.primitive(object, triangle), center);
            let body = Body::below(&scene, geometry, &point, 1.0);
            let (start, _) = body.enter(&point, -point.geometric_normal)?;
            let mut found = Vec::new();
            let reach = size * random(i, 47);
            body.crossings(&scene.objects, (start, reach), beyond, 1.4, |c| {
                found.push((c, body.end_at(start, &c).is_some()));
            });
            found.sort_by_key(|(crossing, _)| crossing.triangle);
            Some((found, point.offset))
        };
        let (Some((a, offset)), Some((b, _))) = (crossings(&shared), crossings(&flat)) else { continue };
        for (crossing, _) in b.iter().filter(|(_, is_met)| *is_met) {
            let Ok(place) = a.binary_search_by_key(&crossing.triangle, |(other, _)| other.triangle) else {
                missed += 1;
                continue;
            };
            let same = &a[place].0;
            missed += u32::from(!a[place].1);
            // Facets that are barely below the start are not where they are, relative to their distance
            let error = 1e-3 + 10.0 * offset / crossing.distance;
            assert!((same.distance / crossing.distance - 1.0).abs() < error, "{i}: {same:?} {crossing:?}");
            assert!((same.spread / crossing.spread - 1.0).abs() < 20.0 * error, "{i}: {same:?} {crossing:?}");
            assert!(same.direction.distance(crossing.direction) < error, "{i}: {same:?} {crossing:?}");
            found += 1;
        }
    }
    assert!(found > 1000 && missed < found / 100, "{found} found, {missed} missed");
}

/// Trees of meshes are kept where other objects are moved.
#[test]
fn trees_of_meshes_are_kept() {
    let mut scene = scene();
    let before = Geometry::sharing_all(&scene.objects);
    let moved = Affine3A::from_translation(Vec3::new(100.0, 0.0, 0.0));
    scene.objects[3].world_from_local = moved;
    let old = Instances::new(&scene.objects, &MeshSharing::new(&scene.objects, |_, _| true), None).unwrap();
    let new =
        Instances::new(&scene.objects, &MeshSharing::new(&scene.objects, |_, _| true), Some(&old)).unwrap();
    assert!(Arc::ptr_eq(&old.meshes[0], &new.meshes[0]) && new.meshes.len() == 1);
    let after = Geometry::sharing_all(&scene.objects);
    let ray = Ray::new(moved.transform_point3(Vec3::new(0.0, 20.0, 0.75)), Vec3::NEG_Y);
    assert!(after.closest(&ray).is_some_and(|hit| after.object(&hit) == 3));
    assert!(before.closest(&ray).is_none() && before.bounds().1.x < 90.0 && after.bounds().1.x > 100.0);
}
