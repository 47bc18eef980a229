//! STL meshes (3D Systems, "Stereolithography Interface Specification", 1988): binary and ascii.

use std::path::Path;

use glam::{DVec3, Vec3};
use translucid_scene::{Mesh, Place, SceneError, Warning, linear_from_srgb, repair_mesh};

use crate::creases::{Smoothing, corner_normals};
use crate::file::read_file;
use crate::origin::{Anchor, in_file_coordinates};
use crate::result::Result;
use crate::weld::{Corner, NONE, Tables, Welder, distinct};
use crate::winding::{orient, warn_of_turned};

/// Bytes before the triangles of a binary file, the last four their number.
const HEADER: usize = 84;

/// Bytes of a triangle: its normal, three vertices, and two that mean nothing or a color.
const TRIANGLE: usize = 50;

/// Angle between triangles up to which the surface is smooth across their common edge \[rad\].
const CREASE: f32 = std::f32::consts::FRAC_PI_6;

/// Loads an STL mesh.
///
/// Corners at the same place are joined.
/// Normals are smooth across edges of less than 30°, and follow the corners' order; those of the file are passed over.
/// Triangles of a closed body that wind the other way than the rest are turned, with a warning.
/// Colors of triangles in binary files, as VisCAM and SolidView or Magics write them, become vertex colors; they are sRGB.
///
/// # Errors
/// The file cannot be read, breaks the format (the message names line or triangle), or has no usable triangle.
pub fn load_stl(path: &Path, warnings: &mut Vec<Warning>) -> Result<Mesh> {
    parse_stl(&read_file(path)?, path, warnings)
}

/// Parses an STL file's bytes as [`load_stl`] does; `path` is for messages.
///
/// # Errors
/// As [`load_stl`].
pub fn parse_stl(bytes: &[u8], path: &Path, warnings: &mut Vec<Warning>) -> Result<Mesh> {
    read_stl(bytes, path, warnings).map(|(mesh, origin)| in_file_coordinates(mesh, origin))
}

/// As [`parse_stl`], with the point from which the positions are counted.
pub(crate) fn read_stl(bytes: &[u8], path: &Path, warnings: &mut Vec<Warning>) -> Result<(Mesh, DVec3)> {
    let (corners, colors) = if is_ascii(bytes) {
        (read_ascii(bytes, path)?, Vec::new())
    } else {
        (read_binary(bytes, path)?, colors(bytes))
    };
    let mut anchor = Anchor::default();
    let corners: Vec<Vec3> = corners.into_iter().map(|corner| anchor.relative(corner)).collect();
    let mut mesh = join(&corners);
    let place = Place::file(path);
    warn_of_turned(orient(&mut mesh), &place, warnings);
    let mut mesh = with_creases(mesh, &colors);
    repair_mesh(&mut mesh, &place, warnings)?;
    Ok((mesh, anchor.position()))
}

/// Distinguishes an ASCII file, which begins with "solid" in letters of any case, from a binary one that may begin so, too:
/// that is as long as its number of triangles says, or has zeros among its first triangles.
fn is_ascii(bytes: &[u8]) -> bool {
    /// Bytes that are looked at: some triangles.
    const BEGINNING: usize = 1000;
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    let begins_with =
        |word: &[u8]| text.get(..word.len()).is_some_and(|start| start.eq_ignore_ascii_case(word));
    let is_binary = triangle_count(bytes).is_some_and(|count| HEADER + count * TRIANGLE == bytes.len());
    (begins_with(b"solid") || begins_with(b"facet"))
        && !is_binary
        && !bytes[..bytes.len().min(BEGINNING)].contains(&0)
}

/// Number of triangles that a binary file states.
fn triangle_count(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(HEADER - 4..)?.first_chunk()?;
    Some(u32::from_le_bytes(*count) as usize)
}

fn read_binary(bytes: &[u8], path: &Path) -> Result<Vec<DVec3>> {
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

/// Colors of the triangles of a binary file, each five bits of the two last bytes; empty if none has one.
///
/// In files of Magics the header has "COLOR=" and four bytes, the color of the triangles whose highest bit is set; red is in
/// the lowest bits.
/// In those of VisCAM and SolidView triangles whose highest bit is set have a color; red is in the highest bits.
/// MeshLab writes the header and the order of Magics, and sets the bit of triangles that have a color.
fn colors(bytes: &[u8]) -> Vec<Vec3> {
    let key = b"COLOR=";
    let header = &bytes[..bytes.len().min(HEADER - 4)];
    let of_body = header.windows(key.len()).position(|word| word == key);
    let of_body = of_body.and_then(|at| header.get(at + key.len()..)?.first_chunk::<4>());
    let is_meshlab = of_body.is_some_and(|body| body[3] == b' ');
    let count = triangle_count(bytes).unwrap_or(0);
    let triangles = bytes.get(HEADER..).unwrap_or_default().chunks_exact(TRIANGLE).take(count);
    let linear = |rgb: [f32; 3]| Vec3::from_array(rgb.map(linear_from_srgb));
    let of_bits =
        |bits: u16, shifts: [u32; 3]| linear(shifts.map(|shift| f32::from(bits >> shift & 31) / 31.0));
    let of_triangle = |bits: u16| {
        let is_set = bits >> 15 == 1;
        match of_body {
            Some(_) if is_meshlab => is_set.then(|| of_bits(bits, [0, 5, 10])),
            Some(&[r, g, b, _]) if is_set => Some(linear([r, g, b].map(|byte| f32::from(byte) / 255.0))),
            Some(_) => Some(of_bits(bits, [0, 5, 10])),
            None => is_set.then(|| of_bits(bits, [10, 5, 0])),
        }
    };
    let bits: Vec<u16> = triangles.map(|triangle| u16::from_le_bytes([triangle[48], triangle[49]])).collect();
    if bits.iter().all(|&bits| bits == 0) {
        return Vec::new();
    }
    let colors: Vec<Option<Vec3>> = bits.into_iter().map(of_triangle).collect();
    match colors.iter().any(Option::is_some) {
        true => colors.into_iter().map(|color| color.unwrap_or(Vec3::ONE)).collect(),
        false => Vec::new(),
    }
}

/// Vertices of all solids, three for each facet.
fn read_ascii(bytes: &[u8], path: &Path) -> Result<Vec<DVec3>> {
    let mut corners = Vec::new();
    let mut loop_begins = 0;
    for (number, line) in bytes.split(|&byte| byte == b'\n').enumerate() {
        let at = |message: String| SceneError::at(Place::line(path, number + 1), message);
        let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        let mut next_word = || words.next().map(<[u8]>::to_ascii_lowercase);
        let mut word = next_word();
        if word.as_deref() == Some(b"end") {
            word = next_word().map(|of| [b"end", &of[..]].concat());
        }
        match word.as_deref() {
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
            Some(
                b"solid" | b"\xef\xbb\xbfsolid" | b"facet" | b"outer" | b"endfacet" | b"endsolid" | b"color",
            )
            | None => (),
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
    // 0 and −0 are the same place
    let (positions, numbers) = distinct(corners.iter().copied(), |corner| (corner + 0.0).to_array());
    Mesh { positions, triangles: numbers.as_chunks().0.to_vec(), ..Mesh::default() }
}

/// The mesh with normals that are smooth but across creases, at which it gets several vertices of one place, as it does
/// between colors.
fn with_creases(mesh: Mesh, colors: &[Vec3]) -> Mesh {
    let found = corner_normals(&mesh.positions, &mesh.triangles, CREASE, |_| Smoothing::Angle);
    let (colors, of_triangles) = distinct(colors.iter().copied(), |color| color.to_array());
    let corners =
        mesh.triangles.iter().zip(&found.triangles).enumerate().map(|(number, (triangle, normals))| {
            [0, 1, 2].map(|i| Corner {
                position: triangle[i],
                uv: NONE,
                normal: normals[i],
                color: of_triangles.get(number).copied().unwrap_or(NONE),
            })
        });
    let tables = Tables { positions: mesh.positions, uvs: Vec::new(), normals: found.normals, colors };
    Welder::new(&tables).weld(corners)
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

    fn parsed(bytes: &[u8]) -> Result<Mesh> {
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
    fn stl_words_are_known_in_any_case_and_apart() {
        let plain = String::from_utf8(ascii(&cube())).unwrap();
        let mesh = parsed(plain.as_bytes()).unwrap();
        let others = [
            plain.to_uppercase(),
            plain.replacen("solid", " Solid", 1),
            plain
                .replace("endloop", "end loop")
                .replace("endfacet", "end facet")
                .replace("endsolid", "end solid"),
            format!("{plain}{}", " ".repeat(100)),
            format!("\u{feff}{plain}"),
        ];
        for other in others {
            assert_eq!(parsed(other.as_bytes()).unwrap(), mesh, "{other}");
        }
        assert_eq!(
            parsed(&[plain.as_bytes(), &[0; 20]].concat()).unwrap_err().message,
            "\"\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\" is no word of the STL format"
        );
        // A binary file without a zero in its first triangles
        let mut dense =
            binary(&[[Vec3::new(1.1, 1.2, 1.3), Vec3::new(2.1, 1.2, 1.3), Vec3::new(1.1, 2.2, 1.3)]; 21]);
        dense[84..].iter_mut().filter(|byte| **byte == 0).for_each(|byte| *byte = 1);
        assert_eq!(parsed(&dense).unwrap().triangles.len(), 21);
    }

    #[test]
    fn stl_colors_of_triangles_are_read_in_both_ways() {
        let with = |header: &[u8], bits: [u16; 2]| {
            let mut bytes = binary(&cube());
            bytes[..header.len()].copy_from_slice(header);
            for (number, triangle) in bytes[HEADER..].chunks_exact_mut(TRIANGLE).enumerate() {
                triangle[48..].copy_from_slice(&bits[number / 6].to_le_bytes());
            }
            let mesh = parsed(&bytes).unwrap();
            [0, 11].map(|number| mesh.colors.get(mesh.triangles[number][0] as usize).copied())
        };
        let (red, blue) = (Some(Vec3::X), Some(Vec3::Z));
        assert_eq!(with(b"solid", [0, 0]), [None, None]);
        assert_eq!(with(b"VisCAM", [1 << 15 | 31 << 10, 1 << 15 | 31]), [red, blue]);
        assert_eq!(with(b"VisCAM", [1 << 15 | 31 << 10, 31]), [red, Some(Vec3::ONE)]);
        assert_eq!(with(b"COLOR=\x00\x00\xff\xff", [31, 1 << 15]), [red, blue]);
        assert_eq!(with(b"COLOR=\x00\x00\xff\xff", [0, 0]), [None, None]);
        let meshlab = b"COLOR=\x7f\x7f\x7f MATERIAL=\x7f\x7f\x7f";
        assert_eq!(with(meshlab, [1 << 15 | 31, 1 << 15 | 31 << 10]), [red, blue]);
    }

    #[test]
    fn stl_turns_faces_of_a_closed_body_that_wind_the_other_way() {
        let mut triangles = cube();
        triangles[7].swap(1, 2);
        let mut warnings = Vec::new();
        let mesh = parse_stl(&binary(&triangles), Path::new("a.stl"), &mut warnings).unwrap();
        assert_eq!(mesh, parsed(&binary(&cube())).unwrap());
        assert_eq!(
            warnings[0].message,
            "1 triangle of a closed body wound the other way than the rest: turned"
        );
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
