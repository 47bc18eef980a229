//! The faces of a PLY mesh, and what their corners have of their own.

use glam::{Vec2, Vec3};
use translucid_scene::Triangle;

use super::header::{Element, Kind, Property};
use super::values::{Fault, Values};
use super::{COLOR, NAMES, color_scale, skip};
use crate::polygon::triangulate;

/// Triangles, in pieces of polygons or strips.
#[derive(Debug, Default)]
pub(super) struct Faces {
    pub(super) triangles: Vec<Triangle>,
    /// For each triangle, as it is in the file, the texture coordinates of its corners, or empty.
    pub(super) uvs: Vec<[Vec2; 3]>,
    /// For each triangle its color, or empty.
    pub(super) colors: Vec<Vec3>,
    /// Pictures other than the first are named.
    pub(super) has_other_pictures: bool,
    /// Faces whose list of texture coordinates is not as long as it must be.
    pub(super) misfits: usize,
}

/// What a property of a face is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    Indices,
    TextureCoordinates,
    TextureNumber,
    /// Red, green or blue.
    Color(usize),
    Other,
}

/// The properties of faces or strips.
pub(super) struct FaceColumns {
    columns: Vec<(Kind, Role)>,
    has_uv: bool,
    has_color: bool,
    color_scale: f64,
    is_strip: bool,
}

impl FaceColumns {
    pub(super) fn of(element: &Element) -> Result<Self, String> {
        let columns: Vec<_> =
            element.properties.iter().map(|property| (property.kind, role(property))).collect();
        let has = |role: Role| columns.iter().any(|column| column.1 == role);
        if !has(Role::Indices) {
            let name = &element.name;
            return Err(format!("element \"{name}\" has no list \"vertex_indices\" or \"vertex_index\""));
        }
        let red = columns.iter().find(|column| column.1 == Role::Color(0));
        Ok(Self {
            has_uv: has(Role::TextureCoordinates),
            has_color: (0..3).all(|channel| has(Role::Color(channel))),
            color_scale: red.map_or(1.0, |&(kind, _)| color_scale(kind)),
            is_strip: element.name == "tristrips",
            columns,
        })
    }

    /// Reads a face or a list of strips; positions are those read so far.
    pub(super) fn read(
        &self,
        values: &mut impl Values,
        positions: &[Vec3],
        scratch: &mut Scratch,
        faces: &mut Faces,
    ) -> Result<(), Fault> {
        let Scratch { indices, uvs } = scratch;
        indices.clear();
        uvs.clear();
        let mut color = Vec3::ZERO;
        for &(kind, role) in &self.columns {
            match (kind, role) {
                (Kind::List { count, item }, Role::Indices) => {
                    for _ in 0..values.list_length(count)? {
                        indices.push(index(values.value(item)?)?);
                    }
                }
                (Kind::List { count, item }, Role::TextureCoordinates) => {
                    for _ in 0..values.list_length(count)? {
                        uvs.push(values.value(item)? as f32);
                    }
                }
                (Kind::Scalar(scalar), Role::TextureNumber) => {
                    faces.has_other_pictures |= values.value(scalar)? > 0.0;
                }
                (Kind::Scalar(scalar), Role::Color(channel)) => {
                    color[channel] = (values.value(scalar)? / self.color_scale) as f32;
                }
                (kind, _) => skip(values, kind)?,
            }
        }
        let before = faces.triangles.len();
        if self.is_strip {
            strips(indices, &mut faces.triangles);
        } else {
            self.add_polygon(positions, scratch, faces);
        }
        if self.has_color {
            faces.colors.resize(faces.colors.len() + faces.triangles.len() - before, color);
        }
        Ok(())
    }

    fn add_polygon(&self, positions: &[Vec3], Scratch { indices, uvs }: &Scratch, faces: &mut Faces) {
        let position = |vertex: u32| positions.get(vertex as usize).copied();
        if !self.has_uv {
            return triangulate(indices, position, |triangle| faces.triangles.push(triangle));
        }
        let fits = uvs.len() == 2 * indices.len();
        faces.misfits += usize::from(!fits);
        let uv = |corner: usize| {
            if fits { Vec2::new(uvs[2 * corner], uvs[2 * corner + 1]) } else { Vec2::ZERO }
        };
        let corners: Vec<usize> = (0..indices.len()).collect();
        triangulate(
            &corners,
            |corner| position(indices[corner]),
            |triangle| {
                faces.triangles.push(triangle.map(|corner| indices[corner]));
                faces.uvs.push(triangle.map(uv));
            },
        );
    }
}

/// Lists of the face that is being read.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    indices: Vec<u32>,
    uvs: Vec<f32>,
}

fn role(property: &Property) -> Role {
    let color = || NAMES[COLOR..].iter().position(|names| names.contains(&property.name.as_str()));
    match (property.kind, property.name.as_str()) {
        (Kind::List { .. }, "vertex_indices" | "vertex_index") => Role::Indices,
        (Kind::List { .. }, "texcoord") => Role::TextureCoordinates,
        (Kind::Scalar(_), "texnumber") => Role::TextureNumber,
        (Kind::Scalar(_), _) => color().map_or(Role::Other, Role::Color),
        _ => Role::Other,
    }
}

/// Triangles of strips, which negative indices end; every other one is turned, so that all wind the same way.
fn strips(indices: &[u32], triangles: &mut Vec<Triangle>) {
    for strip in indices.split(|&index| index == u32::MAX) {
        let turned =
            |(i, w): (usize, &[u32])| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] };
        let has_area = |t: &Triangle| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
        triangles.extend(strip.windows(3).enumerate().map(turned).filter(has_area));
    }
}

/// An index; a negative one becomes one that is out of range in any mesh.
fn index(value: f64) -> Result<u32, Fault> {
    match value {
        value if value.fract() != 0.0 => Err(Fault::NotWhole),
        value if value >= 0.0 => Ok(value as u32),
        _ => Ok(u32::MAX),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_wind_one_way_and_begin_again_behind_a_negative_index() {
        let mut triangles = Vec::new();
        strips(&[0, 1, 2, 3, u32::MAX, 4, 5, 6, 6, 7], &mut triangles);
        assert_eq!(triangles, [[0, 1, 2], [2, 1, 3], [4, 5, 6]]);
        assert_eq!(index(-1.0), Ok(u32::MAX));
    }
}
