//! Meshes that no modeler would be proud of.

use std::f32::consts::{PI, TAU};
use std::fmt::Write;

use glam::Vec3;

use super::random::Random;

/// Vertices and triangles.
#[derive(Default)]
pub(crate) struct Mesh {
    pub(crate) positions: Vec<Vec3>,
    triangles: Vec<[usize; 3]>,
}

/// A mesh about as large as `size`, about a center near the origin. One in a hundred has 1e5 triangles.
pub(crate) fn random_mesh(random: &mut Random, size: f32) -> Mesh {
    let mut mesh = if random.chance(0.01) {
        sheet(random, 224)
    } else {
        match random.below(9) {
            0 | 1 => ball(random, 6),
            2 => sheet(random, 1),
            3 => sheet(random, 8),
            4 => needles(random),
            5 => coincident(random),
            6 => soup(random),
            7 => collapsed(random),
            _ => open_ball(random),
        }
    };
    let center = random.cube() * random.pick(&[0.0, 0.3, 1.0, 1e4]);
    let stretch = if random.chance(0.1) { Vec3::new(1.0, 1e-5, 1.0) } else { Vec3::ONE };
    for position in &mut mesh.positions {
        *position = (*position * stretch + center) * size;
    }
    if random.chance(0.1) {
        // A vertex at the edge of what may be
        let at = random.below(mesh.positions.len());
        mesh.positions[at] = random.direction() * 1e9;
    }
    // A component may still be beyond it by rounding.
    mesh.positions.iter_mut().for_each(|p| *p = p.clamp(Vec3::splat(-1e9), Vec3::splat(1e9)));
    if random.chance(0.2) {
        mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    }
    mesh
}

/// Closed, with zero-area triangles at the poles.
fn ball(random: &mut Random, rows: usize) -> Mesh {
    let columns = 3 + random.below(9);
    let mut mesh = Mesh::default();
    for row in 0..=rows {
        for column in 0..columns {
            let (theta, phi) = (PI * row as f32 / rows as f32, TAU * column as f32 / columns as f32);
            mesh.positions.push(Vec3::new(theta.sin() * phi.cos(), theta.cos(), -theta.sin() * phi.sin()));
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let (a, b) = (row * columns + column, row * columns + (column + 1) % columns);
            mesh.triangles.extend([[a, a + columns, b], [b, a + columns, b + columns]]);
        }
    }
    mesh
}

fn open_ball(random: &mut Random) -> Mesh {
    let mut mesh = ball(random, 6);
    let kept = 1 + random.below(mesh.triangles.len());
    mesh.triangles.drain(..mesh.triangles.len() - kept);
    mesh
}

/// A square of 2n² triangles, flat or rough.
fn sheet(random: &mut Random, n: usize) -> Mesh {
    let height = random.pick(&[0.0, 1e-6, 0.2]);
    let mut mesh = Mesh::default();
    for i in 0..=n {
        for j in 0..=n {
            let at = |k: usize| 2.0 * k as f32 / n as f32 - 1.0;
            mesh.positions.push(Vec3::new(at(i), random.signed() as f32 * height, at(j)));
        }
    }
    for i in 0..n {
        for j in 0..n {
            let a = i * (n + 1) + j;
            mesh.triangles.extend([[a, a + 1, a + n + 1], [a + 1, a + n + 2, a + n + 1]]);
        }
    }
    mesh
}

/// Triangles a million times longer than wide, one of them just wide enough to be a triangle.
fn needles(random: &mut Random) -> Mesh {
    let mut mesh = Mesh::default();
    for width in [1.1e-6, 1e-5, 1e-3, 0.1] {
        let (along, across) = (random.direction(), random.direction());
        let across = along.cross(across).normalize_or(along.any_orthonormal_vector());
        mesh.push([random.cube() * 0.1, along, along * 0.5 + across * width]);
    }
    mesh
}

/// One triangle many times, from both sides, with and without vertices of its own.
fn coincident(random: &mut Random) -> Mesh {
    let corners = [random.cube(), random.cube(), random.cube()];
    let mut mesh = Mesh::default();
    for _ in 0..1 + random.below(40) {
        mesh.push(corners);
    }
    let turned = mesh.triangles.iter().map(|&[a, b, c]| [a, c, b]).take(random.below(3));
    let turned: Vec<_> = turned.chain([[0, 1, 2], [2, 1, 0]]).collect();
    mesh.triangles.extend(turned);
    mesh
}

/// Triangles anywhere, of any size, through each other.
fn soup(random: &mut Random) -> Mesh {
    let mut mesh = Mesh::default();
    for _ in 0..1 + random.below(60) {
        let (center, size) = (random.cube(), random.pick(&[1e-4, 0.1, 1.0]));
        mesh.push([0; 3].map(|_| center + random.cube() * size));
    }
    mesh
}

/// Points and lines, which the loader leaves out, and one triangle, which it keeps.
fn collapsed(random: &mut Random) -> Mesh {
    let (point, along) = (random.cube(), random.direction());
    let mut mesh = Mesh::default();
    mesh.push([point; 3]);
    mesh.push([point, point + along, point + along * 2.0]);
    mesh.push([point, point + along, point + along.any_orthonormal_vector()]);
    mesh.push([point, point, point + along]);
    mesh
}

impl Mesh {
    /// A triangle with vertices of its own.
    fn push(&mut self, corners: [Vec3; 3]) {
        let first = self.positions.len();
        self.positions.extend(corners);
        self.triangles.push([first, first + 1, first + 2]);
    }

    /// Writes a PLY file, at times with normals, texture coordinates and colors that fit nothing.
    pub(crate) fn ply(&self, random: &mut Random) -> String {
        let (normals, uvs, colors) = (random.chance(0.3), random.chance(0.6), random.chance(0.3));
        let mut text = format!("ply\nformat ascii 1.0\nelement vertex {}\n", self.positions.len());
        for (given, names) in [
            (true, &["x", "y", "z"][..]),
            (normals, &["nx", "ny", "nz"]),
            (uvs, &["u", "v"]),
            (colors, &["red", "green", "blue"]),
        ] {
            for name in names.iter().filter(|_| given) {
                writeln!(text, "property float {name}").expect("a string takes every line");
            }
        }
        let count = self.triangles.len();
        write!(text, "element face {count}\nproperty list uchar int vertex_indices\nend_header\n")
            .expect("a string takes every line");
        for position in &self.positions {
            let mut numbers: Vec<f32> = position.to_array().to_vec();
            if normals {
                let length = random.pick(&[0.0, 1e-30, 1.0, 1e6]);
                numbers.extend((random.direction() * length).to_array());
            }
            if uvs {
                let reach = random.pick(&[0.0, 1.0, 1.0, 1e30]);
                numbers.extend([random.signed() as f32 * reach, random.signed() as f32 * reach]);
            }
            if colors {
                numbers.extend(random.color().map(|c| (c * random.pick(&[1.0, 1e9])) as f32));
            }
            let numbers: Vec<String> = numbers.iter().map(f32::to_string).collect();
            writeln!(text, "{}", numbers.join(" ")).expect("a string takes every line");
        }
        for [a, b, c] in &self.triangles {
            writeln!(text, "3 {a} {b} {c}").expect("a string takes every line");
        }
        text
    }
}
