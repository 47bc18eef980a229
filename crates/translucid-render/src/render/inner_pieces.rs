//! Pieces of a mesh inside the body that its other pieces enclose: what booleans, scanners and voxel programs leave there, or
//! the back of an eye.
//!
//! No light from outside reaches them, but a random walk would end at an open sheet among them, and a profile would take them
//! for surfaces that light enters. They are left out.
//! A cavity, whose faces look into it, stays, and what is in it.

use std::collections::HashMap;
use std::sync::{Arc, Weak};

use glam::Vec3;
use translucid_scene::{Material, Mesh, Object, ScalarInput, Scene};

use crate::ray::{Geometry, Ray, orientation};
use crate::subsurface::{Note, NoteKind};

/// Closed pieces of a mesh in which others are looked for, the largest first.
const MOST_CLOSED: usize = 32;

/// The direction in which the nearest surface must show its inside, at no round angle.
const DIRECTION: Vec3 = Vec3::new(0.283, 0.768, 0.402);

/// Meshes that are given, and what is left of them.
#[derive(Default)]
pub(super) struct InnerPieces {
    /// By the address of the mesh that was given.
    known: HashMap<usize, Known>,
}

struct Known {
    /// Keeps the address from being used again.
    _given: Weak<Mesh>,
    without: Option<Without>,
}

/// A mesh without its inner pieces.
struct Without {
    given: Arc<Mesh>,
    mesh: Arc<Mesh>,
    /// Triangles that are left out.
    count: usize,
}

impl InnerPieces {
    /// Leaves inner pieces out of the scene's opaque bodies, and puts back those of others; whether anything changed.
    pub(super) fn leave_out(&mut self, scene: &mut Scene) -> bool {
        let given: HashMap<usize, Arc<Mesh>> =
            self.left().map(|(address, without)| (address, Arc::clone(&without.given))).collect();
        let mut known = HashMap::new();
        let mut changes = false;
        for object in &mut scene.objects {
            let given = given.get(&Arc::as_ptr(&object.mesh).addr()).unwrap_or(&object.mesh).clone();
            let address = Arc::as_ptr(&given).addr();
            let is_body = hides_its_inside(&scene.materials[object.material]);
            if !is_body && !self.known.contains_key(&address) {
                continue;
            }
            let found = known.entry(address).or_insert_with(|| {
                let known = self.known.remove(&address);
                known.unwrap_or_else(|| Known { _given: Arc::downgrade(&given), without: without(&given) })
            });
            let mesh = match &found.without {
                Some(without) if is_body => Arc::clone(&without.mesh),
                _ => given,
            };
            changes |= !Arc::ptr_eq(&mesh, &object.mesh);
            object.mesh = mesh;
        }
        self.known = known;
        changes
    }

    /// What is left of meshes, by its own address.
    fn left(&self) -> impl Iterator<Item = (usize, &Without)> {
        let all = self.known.values().filter_map(|known| known.without.as_ref());
        all.map(|without| (Arc::as_ptr(&without.mesh).addr(), without))
    }

    /// A note on each object that lacks pieces.
    pub(super) fn notes(&self, scene: &Scene) -> Vec<Note> {
        let left: HashMap<usize, &Without> = self.left().collect();
        let note = |object: &Object| {
            let without = left.get(&Arc::as_ptr(&object.mesh).addr())?;
            let message = format!(
                "object {}: {} of its faces are inside its closed surface, where no light comes to them; they are left out \
                 (faces of a cavity look into it)",
                object.name, without.count
            );
            Some(Note { kind: NoteKind::InnerPieces, material: None, message })
        };
        scene.objects.iter().filter_map(note).collect()
    }
}

/// Whether nobody sees or lights what is inside a body.
fn hides_its_inside(material: &Material) -> bool {
    material.has_subsurface()
        && material.geometry_opacity == ScalarInput::constant(1.0)
        && material.transmission_weight == ScalarInput::constant(0.0)
        && !material.geometry_thin_walled
        && material.emission_luminance == 0.0
}

/// A mesh without its inner pieces, if it has any.
fn without(given: &Arc<Mesh>) -> Option<Without> {
    let inner = inner_triangles(given);
    if inner.is_empty() {
        return None;
    }
    let mut mesh = Mesh::clone(given);
    let mut number = 0..;
    mesh.triangles.retain(|_| number.next().is_some_and(|number| inner.binary_search(&number).is_err()));
    Some(Without { given: Arc::clone(given), mesh: Arc::new(mesh), count: inner.len() })
}

/// Triangles that share places with each other, and with no others.
struct Piece {
    triangles: Vec<usize>,
    bounds: [Vec3; 2],
}

impl Piece {
    fn encloses_bounds_of(&self, other: &Self) -> bool {
        self.bounds[0].cmplt(other.bounds[0]).all() && self.bounds[1].cmpgt(other.bounds[1]).all()
    }

    fn corners<'a>(&'a self, mesh: &'a Mesh) -> impl Iterator<Item = [Vec3; 3]> + 'a {
        self.triangles.iter().map(|&t| mesh.triangles[t].map(|corner| mesh.positions[corner as usize]))
    }
}

/// Numbers, in their order, of the triangles in pieces of a mesh that lie inside the body which its closed pieces enclose.
fn inner_triangles(mesh: &Mesh) -> Vec<usize> {
    let mut pieces = pieces(mesh);
    if pieces.len() < 2 {
        return Vec::new();
    }
    pieces.sort_by(|a, b| {
        let size = |piece: &Piece| piece.bounds[0].distance(piece.bounds[1]);
        size(b).total_cmp(&size(a))
    });
    let orientation_of = |piece: &Piece| orientation(|| piece.corners(mesh));
    let orientations: Vec<f32> = pieces.iter().map(orientation_of).collect();
    let closed: Vec<usize> =
        (0..pieces.len()).filter(|&i| orientations[i] != 0.0).take(MOST_CLOSED).collect();
    // Those that have something in their box, each with a tree of its own
    let has_candidates = |i: &usize| pieces.iter().any(|other| pieces[*i].encloses_bounds_of(other));
    let trees: Vec<(usize, Geometry)> =
        closed.into_iter().filter(has_candidates).map(|i| (i, tree(mesh, &pieces[i]))).collect();
    let is_inner = |(i, piece): &(usize, &Piece)| {
        let around: Vec<&Geometry> = trees
            .iter()
            .filter(|(outer, _)| pieces[*outer].encloses_bounds_of(piece))
            .map(|(_, tree)| tree)
            .collect();
        orientations[*i] >= 0.0
            && !around.is_empty()
            && piece.corners(mesh).all(|corners| corners.into_iter().all(|place| is_inside(&around, place)))
    };
    let inner = pieces.iter().enumerate().filter(is_inner);
    let mut found: Vec<usize> = inner.flat_map(|(_, piece)| piece.triangles.iter().copied()).collect();
    found.sort_unstable();
    found
}

/// Whether the nearest of surfaces shows its inside.
fn is_inside(surfaces: &[&Geometry], place: Vec3) -> bool {
    let ray = Ray::new(place, DIRECTION.normalize());
    let hits = surfaces.iter().filter_map(|surface| surface.closest(&ray).map(|hit| (*surface, hit)));
    let nearest = hits.min_by(|(_, a), (_, b)| a.t.total_cmp(&b.t));
    nearest.is_some_and(|(surface, hit)| surface.normal(&hit).dot(DIRECTION) > 0.0)
}

fn tree(mesh: &Mesh, piece: &Piece) -> Geometry {
    let positions: Vec<Vec3> = piece.corners(mesh).flatten().collect();
    let triangles = (0..piece.triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mesh = Mesh { positions, triangles, ..Mesh::default() };
    Geometry::new(&[Object { mesh: mesh.into(), ..Object::default() }])
}

/// The pieces of a mesh; corners at the same place are one.
fn pieces(mesh: &Mesh) -> Vec<Piece> {
    let mut sets = Sets::new(mesh.positions.len());
    mesh.triangles.iter().for_each(|corners| sets.join(corners));
    let is_one = |sets: &mut Sets| {
        let mut roots = mesh.triangles.iter().map(|corners| sets.root(corners[0]));
        roots.next().is_none_or(|first| roots.all(|root| root == first))
    };
    if is_one(&mut sets) {
        return Vec::new();
    }
    let mut places: HashMap<[u32; 3], u32> = HashMap::new();
    for (corner, position) in (0..).zip(&mesh.positions) {
        // 0 and −0 are the same place
        let place = (*position + 0.0).to_array().map(f32::to_bits);
        let first = *places.entry(place).or_insert(corner);
        sets.join(&[corner, first]);
    }
    let mut numbers: HashMap<u32, usize> = HashMap::new();
    let mut found: Vec<Piece> = Vec::new();
    for (triangle, corners) in mesh.triangles.iter().enumerate() {
        let number = *numbers.entry(sets.root(corners[0])).or_insert_with(|| {
            found.push(Piece { triangles: Vec::new(), bounds: [Vec3::INFINITY, Vec3::NEG_INFINITY] });
            found.len() - 1
        });
        let piece = &mut found[number];
        piece.triangles.push(triangle);
        for corner in corners {
            let position = mesh.positions[*corner as usize];
            piece.bounds = [piece.bounds[0].min(position), piece.bounds[1].max(position)];
        }
    }
    found
}

/// Sets that are joined, by a number of each (R. E. Tarjan 1975, with halved paths).
struct Sets(Vec<u32>);

impl Sets {
    fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    fn root(&mut self, mut member: u32) -> u32 {
        while self.0[member as usize] != member {
            let above = self.0[self.0[member as usize] as usize];
            self.0[member as usize] = above;
            member = above;
        }
        member
    }

    fn join(&mut self, members: &[u32]) {
        for pair in members.windows(2) {
            let [a, b] = [self.root(pair[0]), self.root(pair[1])];
            self.0[a.max(b) as usize] = a.min(b);
        }
    }
}

#[cfg(test)]
mod tests {
    use translucid_shapes::{ShapeParameters, build_shape};

    use super::*;

    /// Spheres of radii and places, each turned inside out where its radius is negative, in one mesh.
    fn spheres(of: &[(f32, Vec3)]) -> Mesh {
        let sphere = build_shape("sphere", &ShapeParameters::new()).expect("a sphere");
        let mut all = Mesh::default();
        for &(radius, center) in of {
            let first = all.positions.len() as u32;
            all.positions.extend(sphere.positions.iter().map(|p| *p * radius + center));
            all.triangles.extend(sphere.triangles.iter().map(|corners| corners.map(|i| i + first)));
        }
        all
    }

    /// Numbers of the spheres that are inner.
    fn inner_spheres(mesh: &Mesh, count: usize) -> Vec<usize> {
        let each = mesh.triangles.len() / count;
        let inner = inner_triangles(mesh);
        let of = |number: usize| inner.iter().filter(|&&t| t / each == number).count();
        let whole: Vec<usize> = (0..count).filter(|&number| of(number) == each).collect();
        assert_eq!(inner.len(), whole.len() * each, "pieces are left out whole");
        whole
    }

    #[test]
    fn pieces_inside_a_closed_piece_are_inner() {
        let middle = Vec3::ZERO;
        for (of, inner) in [
            (vec![(1.0, middle)], vec![]),
            (vec![(1.0, middle), (0.5, middle)], vec![1]),
            (vec![(0.3, Vec3::X * 0.6), (1.0, middle), (0.2, Vec3::Y * 0.7)], vec![0, 2]),
            // Beside, through the surface, around
            (vec![(1.0, middle), (0.5, Vec3::X * 3.0)], vec![]),
            (vec![(1.0, middle), (0.5, Vec3::X * 0.7)], vec![]),
            // In a corner of the box
            (vec![(1.0, middle), (0.1, Vec3::splat(0.8))], vec![]),
            // A cavity, and a ball in it
            (vec![(1.0, middle), (-0.5, middle)], vec![]),
            (vec![(1.0, middle), (-0.5, middle), (0.2, middle)], vec![]),
            // Inside out, it encloses nothing
            (vec![(-1.0, middle), (0.5, middle)], vec![]),
        ] {
            assert_eq!(inner_spheres(&spheres(&of), of.len()), inner, "{of:?}");
        }
    }

    #[test]
    fn open_sheets_are_inner_and_triangles_need_not_share_corners() {
        let mut mesh = spheres(&[(1.0, Vec3::ZERO), (0.5, Vec3::ZERO)]);
        let whole = mesh.triangles.len() / 2;
        mesh.triangles.truncate(whole + 1);
        assert_eq!(inner_triangles(&mesh), [whole]);
        let positions = mesh.triangles.iter().flatten().map(|&i| mesh.positions[i as usize]).collect();
        let triangles = (0..=whole as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        assert_eq!(inner_triangles(&Mesh { positions, triangles, ..Mesh::default() }), [whole]);
    }
}
