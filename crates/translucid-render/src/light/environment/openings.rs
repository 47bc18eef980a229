//! Where the sky is seen from inside rooms.
//!
//! In a room a window is a small part of the directions, and the sky's own densities know nothing of the walls. Rays from
//! random places find through which directions light comes into each part of the scene. Where these are few, half of the
//! directions are drawn among them; the other half are drawn as under an open sky, for light that no such ray has found.

use std::f32::consts::{PI, TAU};

use glam::Vec3;
use rayon::prelude::*;
use translucid_law::uniform_sphere;
use translucid_profile::split_mix::{STEP, split_mix};

use super::super::distribution::Discrete;
use crate::ray::{Geometry, Ray};

/// Cells along each edge of the scene's bounds.
const CELLS: usize = 5;

/// Parts of equal solid angle in azimuth and in elevation.
const PARTS: [usize; 2] = [32, 16];

/// Solid angle of a part [sr].
const SOLID_ANGLE: f32 = 4.0 * PI / (PARTS[0] * PARTS[1]) as f32;

/// Rays from each cell.
///
/// With a fourth of them the picture of a room with one window is much noisier; four times as many gain little.
const RAYS: u64 = 16_384;

/// Rays from each cell that a first look takes.
const FIRST_LOOK: u64 = 16;

/// Share of a cell's rays that reach the sky from which on it is open.
const OPEN: f32 = 0.15;

/// Share of the cells that are open from which on the scene is no room.
const OPEN_CELLS: f32 = 0.25;

/// Largest number below 1.
const ALMOST_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

/// Share of the directions that are drawn through openings.
const SHARE: f32 = 0.5;

/// The directions in which the sky is seen from each part of a scene.
#[derive(Clone, Debug)]
pub(crate) struct Openings {
    least: Vec3,
    /// Cells per length.
    scale: Vec3,
    /// A choice among the parts of the sphere; none where the sky is open, or not seen.
    cells: Vec<Option<Discrete>>,
}

impl Openings {
    /// The openings through which light of a luminance by direction comes; `None` if no part of the scene is a room.
    pub(crate) fn new(geometry: &Geometry, luminance: impl Fn(Vec3) -> f32 + Sync) -> Option<Self> {
        let (least, most) = geometry.bounds();
        let size = most - least;
        if !(size.is_finite() && size.min_element() > 0.0) {
            return None;
        }
        let step = size / CELLS as f32;
        let rays = |cell: usize| {
            let at = [cell % CELLS, cell / CELLS % CELLS, cell / CELLS / CELLS].map(|at| at as f32);
            CellRays {
                geometry,
                corner: least + Vec3::from_array(at) * step,
                step,
                state: split_mix(cell as u64),
            }
        };
        let count = CELLS * CELLS * CELLS;
        let first_look = |cell: &usize| {
            let seen = rays(*cell).take(FIRST_LOOK as usize).filter(Option::is_some).count();
            seen as f32 > OPEN * FIRST_LOOK as f32
        };
        let is_open: Vec<bool> = (0..count).map(|cell| first_look(&cell)).collect();
        if is_open.iter().filter(|is_open| **is_open).count() as f32 > OPEN_CELLS * count as f32 {
            return None;
        }
        let of_cell = |cell: usize| if is_open[cell] { None } else { seen_by(rays(cell), &luminance) };
        let cells: Vec<_> = (0..count).into_par_iter().map(of_cell).collect();
        let is_any = cells.iter().any(Option::is_some);
        is_any.then(|| Self { least, scale: step.recip(), cells })
    }

    fn of(&self, point: Vec3) -> Option<&Discrete> {
        let place =
            ((point - self.least) * self.scale).to_array().map(|at| (at.max(0.0) as usize).min(CELLS - 1));
        self.cells[(place[2] * CELLS + place[1]) * CELLS + place[0]].as_ref()
    }

    /// Draws a direction for a point, or leaves numbers to draw one as under an open sky.
    pub(crate) fn sample(&self, point: Vec3, [u, v]: [f32; 2]) -> Result<Vec3, [f32; 2]> {
        let Some(parts) = self.of(point) else { return Err([u, v]) };
        // Numbers below 1 may be rounded to it
        if u >= SHARE {
            return Err([((u - SHARE) / (1.0 - SHARE)).min(ALMOST_ONE), v]);
        }
        let choice = parts.sample(f64::from(u / SHARE));
        let (column, row) = (choice.index % PARTS[0], choice.index / PARTS[0]);
        let cos = 1.0 - 2.0 * ((row as f64 + choice.rest) / PARTS[1] as f64) as f32;
        let (sin_phi, cos_phi) = libm::sincosf(TAU * (column as f32 + v) / PARTS[0] as f32);
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        Ok(Vec3::new(sin * cos_phi, sin * sin_phi, cos).normalize_or(Vec3::Z))
    }

    /// Density of [`sample`](Self::sample), given that under an open sky.
    pub(crate) fn pdf(&self, point: Vec3, direction: Vec3, open: f32) -> f32 {
        let Some(parts) = self.of(point) else { return open };
        let through = parts.probability(part_of(direction)) as f32 / SOLID_ANGLE;
        SHARE * through + (1.0 - SHARE) * open
    }
}

/// The part of the sphere that a direction lies in.
fn part_of(direction: Vec3) -> usize {
    let turn = libm::atan2f(direction.y, direction.x) / TAU;
    let turn = if turn < 0.0 { turn + 1.0 } else { turn };
    let column = ((turn * PARTS[0] as f32) as usize).min(PARTS[0] - 1);
    let row = ((0.5 * (1.0 - direction.z) * PARTS[1] as f32).max(0.0) as usize).min(PARTS[1] - 1);
    row * PARTS[0] + column
}

/// Rays from random places of a cell in random directions; the direction of each that reaches the sky.
struct CellRays<'a> {
    geometry: &'a Geometry,
    corner: Vec3,
    step: Vec3,
    state: u64,
}

impl CellRays<'_> {
    fn number(&mut self) -> f32 {
        self.state = self.state.wrapping_add(STEP);
        (split_mix(self.state) >> 40) as f32 / 16_777_216.0
    }
}

impl Iterator for CellRays<'_> {
    type Item = Option<Vec3>;

    fn next(&mut self) -> Option<Option<Vec3>> {
        let place = Vec3::new(self.number(), self.number(), self.number());
        let direction = uniform_sphere([self.number(), self.number()]);
        let is_hidden = self.geometry.occluded(&Ray::new(self.corner + self.step * place, direction));
        Some((!is_hidden).then_some(direction))
    }
}

/// Light from the sky that rays find, by part of the sphere; `None` where there is none, or the sky is open.
fn seen_by(rays: CellRays<'_>, luminance: &impl Fn(Vec3) -> f32) -> Option<Discrete> {
    let mut light = vec![0.0_f64; PARTS[0] * PARTS[1]];
    let mut seen = 0;
    for direction in rays.take(RAYS as usize).flatten() {
        seen += 1;
        light[part_of(direction)] += f64::from(luminance(direction).max(0.0));
    }
    if seen as f32 > OPEN * RAYS as f32 { None } else { Discrete::new(light.into_iter()) }
}

#[cfg(test)]
mod tests {
    use translucid_scene::{Mesh, Object};

    use super::*;

    /// A room from −1 to 1 with a window of half its width and height in the wall at x = 1, or without that wall.
    fn room(has_window: bool) -> Geometry {
        let mut mesh = Mesh::default();
        let mut quad = |corner: Vec3, a: Vec3, b: Vec3| {
            let first = mesh.positions.len() as u32;
            mesh.positions.extend([corner, corner + a, corner + a + b, corner + b]);
            mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        };
        let [x, y, z] = [Vec3::X * 2.0, Vec3::Y * 2.0, Vec3::Z * 2.0];
        let low = Vec3::splat(-1.0);
        for (corner, a, b) in [(low, x, y), (low, y, z), (low, x, z), (low + y, x, z), (low + z, x, y)] {
            quad(corner, a, b);
        }
        if has_window {
            let wall = low + x;
            quad(wall, y, z * 0.25);
            quad(wall + z * 0.75, y, z * 0.25);
            quad(wall + z * 0.25, y * 0.25, z * 0.5);
            quad(wall + z * 0.25 + y * 0.75, y * 0.25, z * 0.5);
        }
        Geometry::new(&[Object { mesh: mesh.into(), ..Object::default() }])
    }

    /// Draws far more directions through the window than an open sky would, with the density that it states.
    #[test]
    fn openings_are_found_and_their_density_is_exact() {
        let geometry = room(true);
        let openings = Openings::new(&geometry, |_| 1.0).expect("a room");
        let open = 1.0 / (4.0 * PI);
        for point in [Vec3::new(-0.7, 0.1, -0.9), Vec3::ZERO, Vec3::new(-0.2, -0.8, 0.3)] {
            let n = 1 << 14;
            let [mut seen, mut solid_angle, mut through] = [0.0_f64; 3];
            for i in 0..n {
                let u = sobol_burley::sample_4d(i, 0, 5);
                let sees = |direction| f64::from(u8::from(!geometry.occluded(&Ray::new(point, direction))));
                let direction = openings.sample(point, [u[0], u[1]]).unwrap_or_else(uniform_sphere);
                seen += sees(direction);
                through += sees(direction) / f64::from(openings.pdf(point, direction, open));
                solid_angle += sees(uniform_sphere([u[2], u[3]])) / f64::from(open);
            }
            let n = f64::from(n);
            // Under an open sky the share is that of the window in the sphere
            let share = solid_angle / n * f64::from(open);
            assert!(seen / n > 2.5 * share, "{point}: {seen} of {n}, {share}");
            assert!((through / solid_angle - 1.0).abs() < 0.03, "{point}: {through} {solid_angle}");
        }
    }

    #[test]
    fn only_rooms_have_openings() {
        // Without the wall at x = 1 it is open as seen from too many places
        assert!(Openings::new(&room(false), |_| 1.0).is_none());
        let tetrahedron = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z],
            triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
            ..Mesh::default()
        };
        let body = Geometry::new(&[Object { mesh: tetrahedron.into(), ..Object::default() }]);
        assert!(Openings::new(&body, |_| 1.0).is_none());
    }
}
