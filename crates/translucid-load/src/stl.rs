//! STL meshes (3D Systems, "Stereolithography Interface Specification", 1988): binary and ascii.

use std::collections::HashMap;
use std::path::Path;

use glam::{DVec3, Vec3};
use translucid_scene::{Mesh, Place, SceneError, Triangle, Warning, repair_mesh};

use crate::file::read_file;
use crate::origin::{Anchor, in_file_coordinates};

/// Bytes before the triangles of a binary file, the last four their number.
const HEADER: usize = 84;

/// Bytes of a triangle: its normal, three vertices, and two that mean nothing.
const TRIANGLE: usize = 50;

/// Angle between triangles up to which the surface is smooth across their common corner \[rad\].
const CREASE: f32 = std::f32::consts::FRAC_PI_6;

/// Loads an STL mesh.
///
/// Corners at the same place are joined.
/// Normals are smooth where triangles meet at less than 30°, and follow the corners' order; those of the file, and
/// colors that some programs add, are passed over.
///
/// # Errors
/// The file cannot be read, breaks the format (the message names line or triangle), or has no usable triangle.
pub fn load_stl(path: &Path, warnings: &mut Vec<Warning>) -> Result<Mesh, SceneError> {
    parse_stl(&read_file(path)?, path, warnings)
}

/// Parses an STL file's bytes as [`load_stl`] does; `path` is for messages.
///
/// # Errors
/// As [`load_stl`].
pub fn parse_stl(bytes: &[u8], path: &Path, warnings: &mut Vec<Warning>) -> Result<Mesh, SceneError> {
    read_stl(bytes, path, warnings).map(|(mesh, origin)| in_file_coordinates(mesh, origin))
}

/// As [`parse_stl`], with the point from which the positions are counted.
pub(crate) fn read_stl(
    bytes: &[u8],
    path: &Path,
    warnings: &mut Vec<Warning>,
) -> Result<(Mesh, DVec3), SceneError> {
    let corners = if is_ascii(bytes) { read_ascii(bytes, path) } else { read_binary(bytes, path) }?;
    let mut anchor = Anchor::default();
    let corners: Vec<Vec3> = corners.into_iter().map(|corner| anchor.relative(corner)).collect();
    let mut mesh = join(&corners);
    repair_mesh(&mut mesh, &Place::file(path), warnings)?;
    Ok((with_creases(&mesh), anchor.position()))
}

/// Distinguishes an ASCII file, which begins with "solid" and is text, from a binary one that may begin so, too.
fn is_ascii(bytes: &[u8]) -> bool {
    bytes.trim_ascii_start().starts_with(b"solid") && !bytes.contains(&0)
}

/// Number of triangles that a binary file states.
fn triangle_count(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(HEADER - 4..)?.first_chunk()?;
    Some(u32::from_le_bytes(*count) as usize)
}

fn read_binary(bytes: &[u8], path: &Path) -> Result<Vec<DVec3>, SceneError> {
    let failure = |message: String| SceneError::at(Place::file(path), message);
    let Some(count) = triangle_count(bytes) else {
        let message =
            format!("is neither an ascii STL file nor a binary one, which has {HEADER} bytes at least");
        return Err(failure(message));
    };
    let triangles = bytes[HEADER..].chunks_exact(TRIANGLE);
    if triangles.len() < count {
        let there = triangles.len();
        return Err(failure(format!("ends after {there} of the {count} triangles that its header states")));
    }
    let numbers = triangles.take(count).flat_map(|triangle| triangle[12..48].as_chunks().0);
    let coordinates: Vec<f64> = numbers.map(|number| f32::from_le_bytes(*number).into()).collect();
    Ok(coordinates.as_chunks().0.iter().copied().map(DVec3::from_array).collect())
}

/// Vertices of all solids, three for each facet.
fn read_ascii(bytes: &[u8], path: &Path) -> Result<Vec<DVec3>, SceneError> {
    let mut corners = Vec::new();
    let mut loop_begins = 0;
    for (number, line) in bytes.split(|&byte| byte == b'\n').enumerate() {
        let at = |message: String| SceneError::at(Place::line(path, number + 1), message);
        let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        match words.next().map(<[u8]>::to_ascii_lowercase).as_deref() {
            Some(b"vertex") => {
                let mut vertex = DVec3::ZERO;
                for axis in 0..3 {
                    let word =
                        words.next().ok_or_else(|| at(String::from("a vertex has three coordinates")))?;
                    let text = String::from_utf8_lossy(word);
                    vertex[axis] = text
                        .parse()
                        .map_err(|_| at(format!("a coordinate is \"{text}\", which is no number")))?;
                }
                corners.push(vertex);
            }
            Some(b"endloop") => {
                let count = corners.len() - loop_begins;
                if count != 3 {
                    return Err(at(format!("a facet has {count} vertices, but must have three")));
                }
                loop_begins = corners.len();
            }
            Some(b"solid" | b"facet" | b"outer" | b"endfacet" | b"endsolid") | None => (),
            Some(word) => {
                let word = String::from_utf8_lossy(word).into_owned();
                return Err(at(format!("\"{word}\" is no word of the STL format")));
            }
        }
    }
    if loop_begins < corners.len() {
        return Err(SceneError::at(Place::file(path), "ends within a facet"));
    }
    Ok(corners)
}

/// A mesh in which triangles share the vertices at the same place.
fn join(corners: &[Vec3]) -> Mesh {
    let mut mesh = Mesh::default();
    let mut numbers = HashMap::new();
    let mut number = |corner: Vec3| {
        // 0 and −0 are the same place
        *numbers.entry((corner + 0.0).to_array().map(f32::to_bits)).or_insert_with(|| {
            mesh.positions.push(corner);
            mesh.positions.len() as u32 - 1
        })
    };
    let triangles: Vec<Triangle> =
        corners.as_chunks().0.iter().map(|triangle| triangle.map(&mut number)).collect();
    Mesh { triangles, ..mesh }
}

/// The mesh with normals that are smooth but across creases, at which it gets several vertices of one place.
fn with_creases(mesh: &Mesh) -> Mesh {
    let weighted: Vec<Vec3> = mesh
        .triangles
        .iter()
        .map(|triangle| {
            let [a, b, c] = triangle.map(|i| mesh.positions[i as usize]);
            (b - a).cross(c - a)
        })
        .collect();
    let mut around = vec![Vec::new(); mesh.positions.len()];
    for (number, triangle) in mesh.triangles.iter().enumerate() {
        triangle.iter().for_each(|&i| around[i as usize].push(number));
    }
    let mut creased = Mesh::default();
    let mut vertices = HashMap::new();
    for (triangle, own) in mesh.triangles.iter().zip(&weighted) {
        let own = own.normalize_or_zero();
        creased.triangles.push(triangle.map(|i| {
            let is_smooth = |other: &Vec3| other.normalize_or_zero().dot(own) >= libm::cosf(CREASE);
            let neighbors = around[i as usize].iter().map(|&number| weighted[number]);
            let normal = neighbors.filter(is_smooth).sum::<Vec3>().try_normalize().unwrap_or(own);
            *vertices.entry((i, normal.to_array().map(f32::to_bits))).or_insert_with(|| {
                creased.positions.push(mesh.positions[i as usize]);
                creased.normals.push(normal);
                creased.positions.len() as u32 - 1
            })
        }));
    }
    creased
}

#[cfg(test)]
mod tests {
    use translucid_testing::mutants;

    use super::*;

    const CUBE: [[u8; 4]; 6] =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

    /// Triangles of a cube from 0 to 1.
    fn cube() -> Vec<[Vec3; 3]> {
        let corner = |i: u8| Vec3::new(f32::from(i & 1), f32::from(i >> 1 & 1), f32::from(i >> 2));
        CUBE.iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).map(|t| t.map(|&i| corner(i))).collect()
    }

    fn binary(triangles: &[[Vec3; 3]]) -> Vec<u8> {
        let mut bytes = b"solid, although binary".to_vec();
        bytes.resize(80, b' ');
        bytes.extend((triangles.len() as u32).to_le_bytes());
        for triangle in triangles {
            bytes.extend([0; 12]);
            bytes.extend(triangle.iter().flat_map(|v| v.to_array()).flat_map(f32::to_le_bytes));
            bytes.extend([0; 2]);
        }
        bytes
    }

    fn ascii(triangles: &[[Vec3; 3]]) -> Vec<u8> {
        let mut text = String::from("solid a cube\n");
        for triangle in triangles {
            text += "facet normal 0 0 0\n outer loop\n";
            triangle.iter().for_each(|v| text += &format!("  vertex {} {:e} {}\r\n", v.x, v.y, v.z));
            text += " endloop\nendfacet\n";
        }
        (text + "endsolid\n").into_bytes()
    }

    fn parsed(bytes: &[u8]) -> Result<Mesh, SceneError> {
        parse_stl(bytes, Path::new("a.stl"), &mut Vec::new())
    }

    fn refused(bytes: &[u8]) -> String {
        parsed(bytes).unwrap_err().to_string()
    }

    #[test]
    fn stl_cube_has_sharp_edges_in_both_formats() {
        let mesh = parsed(&binary(&cube())).unwrap();
        assert_eq!(mesh, parsed(&ascii(&cube())).unwrap());
        assert_eq!((mesh.positions.len(), mesh.triangles.len()), (24, 12));
        for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
            assert_eq!(normal.abs().element_sum(), 1.0);
            assert!((position - 0.5).dot(*normal) > 0.0, "{position} {normal}");
        }
    }

    #[test]
    fn stl_is_smooth_where_triangles_are_almost_parallel() {
        let [a, b, c, d] = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.2), Vec3::new(0.0, 1.0, 0.0)];
        let mesh = parsed(&binary(&[[a, b, c], [a, c, d]])).unwrap();
        assert_eq!(mesh.positions.len(), 4);
    }

    #[test]
    fn stl_faults_are_named() {
        let whole = binary(&cube());
        assert_eq!(
            refused(&whole[..whole.len() - 1]),
            "a.stl: ends after 11 of the 12 triangles that its header states"
        );
        assert!(refused(b"").contains("is neither an ascii STL file nor a binary one"));
        for (text, message) in [
            ("solid\nvertex 1 2\n", "a.stl:2: a vertex has three coordinates"),
            ("solid\nvertex 1 2 x\n", "a.stl:2: a coordinate is \"x\", which is no number"),
            ("solid\nvertex 1 2 3\nendloop\n", "a.stl:3: a facet has 1 vertices, but must have three"),
            ("solid\nvertex 1 2 3\n", "a.stl: ends within a facet"),
            ("solid\nverteks 1 2 3\n", "a.stl:2: \"verteks\" is no word of the STL format"),
        ] {
            assert_eq!(refused(text.as_bytes()), message);
        }
    }

    #[test]
    fn stl_survives_any_mutation() {
        for mutant in mutants(&ascii(&cube()), 2_000).chain(mutants(&binary(&cube()), 2_000)) {
            if let Ok(mesh) = parsed(&mutant) {
                mesh.validate().unwrap();
            }
        }
    }
}
