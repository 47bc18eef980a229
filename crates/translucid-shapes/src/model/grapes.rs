//! A bunch of grapes that has settled on a table.

use std::f32::consts::TAU;

use glam::{Quat, Vec2, Vec3};
use translucid_scene::{Mesh, SceneError};

use crate::parameters::{ShapeParameter, Values};
use crate::primitive::lathe::{curve_profile, revolve};

pub(crate) const GRAPES: &[ShapeParameter] = &[
    ShapeParameter::count("count", 42.0, 1.0, 400.0),
    ShapeParameter::length("radius", 0.95),
    ShapeParameter::count("segments", 40.0, 6.0, 256.0),
    ShapeParameter::count("seed", 1.0, 0.0, 65535.0),
];

/// A grape: middle, mean radius, how much longer than wide, and how it is turned.
struct Grape {
    center: Vec3,
    radius: f32,
    stretch: f32,
    turn: Quat,
}

/// Numbers in [0, 1): additive recurrences on the golden ratio's kin (M. Roberts 2018) fill space evenly.
fn scatter(index: usize, seed: usize, axis: usize) -> f32 {
    const STEPS: [f64; 5] = [
        0.856_674_883_854_502_9,
        0.733_891_856_627_126,
        0.628_706_721_013_884,
        0.538_597_257_223_612,
        0.461_402_742_776_388,
    ];
    ((index + 1 + 101 * seed) as f64 * STEPS[axis]).fract() as f32
}

pub(crate) fn grapes(values: &Values) -> Result<Mesh, SceneError> {
    let (count, radius, seed) = (values.count("count"), values.get("radius"), values.count("seed"));
    let mut bunch = first_guess(count, seed);
    settle(&mut bunch);
    let mut mesh = Mesh::default();
    let segments = values.count("segments");
    let grape = unit_grape(segments);
    for (index, one) in bunch.iter().enumerate() {
        push_grape(&mut mesh, &grape, one, radius, scatter(index, seed, 4));
    }
    drop_to_floor(&mut mesh);
    Ok(mesh)
}

fn drop_to_floor(mesh: &mut Mesh) {
    let low = mesh.positions.iter().map(|p| p.y).fold(f32::MAX, f32::min);
    mesh.positions.iter_mut().for_each(|p| p.y -= low);
}

/// Grapes of radius about 1 around a stalk along x, wide at one end.
fn first_guess(count: usize, seed: usize) -> Vec<Grape> {
    let length = 2.3 * libm::cbrtf(count as f32);
    (0..count)
        .map(|index| {
            let u = |axis| scatter(index, seed, axis);
            let along = u(0);
            let width = 0.34 * length * (1.0 - 0.7 * along);
            let around = width * u(1).sqrt() * Vec2::from_angle(TAU * u(2));
            let center = Vec3::new(length * (along - 0.4), 0.8 + width + around.x, around.y);
            // Grapes hang from the stalk by their ends, so they point away from it, and down.
            let outward = Vec3::new(0.3, around.x - 0.5, around.y).normalize_or(Vec3::Y);
            Grape {
                center,
                radius: 0.9 + 0.16 * u(3),
                stretch: 1.1 + 0.12 * u(4),
                turn: Quat::from_rotation_arc(Vec3::Y, outward),
            }
        })
        .collect()
}

/// Lets the grapes fall together until none overlaps: gravity, a pull to the stalk, contact.
fn settle(bunch: &mut [Grape]) {
    let rounds = 260;
    for round in 0..rounds {
        // The pulls fade, so that contact has the last word.
        let pull = 0.012 * (1.0 - round as f32 / (0.7 * rounds as f32)).max(0.0);
        for grape in bunch.iter_mut() {
            grape.center -= pull * Vec3::new(0.4 * grape.center.x, 1.0, 1.6 * grape.center.z);
        }
        for i in 0..bunch.len() {
            for j in i + 1..bunch.len() {
                let apart = bunch[j].center - bunch[i].center;
                let least = 1.09 * (bunch[i].radius + bunch[j].radius);
                let distance = apart.length();
                if distance < least {
                    let push = 0.5 * (least - distance) * apart.normalize_or(Vec3::X);
                    bunch[i].center -= push;
                    bunch[j].center += push;
                }
            }
        }
        for grape in bunch.iter_mut() {
            grape.center.y = grape.center.y.max(1.1 * grape.radius);
        }
    }
}

fn unit_grape(segments: usize) -> Mesh {
    let rings = (segments / 2).max(3);
    let mut profile = curve_profile(|t| Vec2::from_angle(0.5 * TAU * (t - 0.5)), rings);
    for (i, point) in profile.iter_mut().enumerate() {
        point.normal = point.position;
        if i == 0 || i == rings {
            (point.position.x, point.normal.x) = (0.0, 0.0);
        }
    }
    revolve(&profile, segments)
}

fn push_grape(mesh: &mut Mesh, unit: &Mesh, grape: &Grape, radius: f32, shade: f32) {
    let first = mesh.positions.len() as u32;
    let axes = grape.radius * Vec3::new(1.0, grape.stretch, 1.0);
    let tint = Vec3::new(0.86, 0.92, 0.8).lerp(Vec3::ONE, shade);
    for (&p, &n) in unit.positions.iter().zip(&unit.normals) {
        mesh.positions.push(radius * (grape.turn * (axes * p) + grape.center));
        mesh.normals.push((grape.turn * (n / axes)).normalize());
        // The blossom end is browner.
        let end = ((p.y - 0.985) / 0.01).clamp(0.0, 1.0);
        mesh.colors.push(tint.lerp(Vec3::new(0.35, 0.25, 0.12), end));
    }
    mesh.uvs.extend(&unit.uvs);
    mesh.triangles.extend(unit.triangles.iter().map(|triangle| triangle.map(|vertex| vertex + first)));
}
