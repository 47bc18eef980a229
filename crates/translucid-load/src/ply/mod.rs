//! PLY meshes (G. Turk, "The PLY Polygon File Format", 1994): ascii and binary of either byte order.

mod faces;
mod header;
mod values;

use std::path::Path;

use faces::{FaceColumns, Faces, Scratch};
use glam::{DVec3, Vec2, Vec3};
use header::{Element, Format, Header, Kind};
use translucid_scene::{Mesh, Place, SceneError, Warning, repair_mesh};
use values::{Ascii, Binary, Fault, Values};

use super::number::NumberType;
use crate::creases::{SHARED_CREASE, Smoothing, corner_normals};
use crate::file::read_file;
use crate::origin::{Anchor, in_file_coordinates};
use crate::result::Result;
use crate::vertex_colors::make_linear;
use crate::weld::{Corner, NONE, Tables, Welder, distinct};
use crate::winding::{orient, warn_of_turned};

/// Loads a PLY mesh.
///
/// Read are, of element `vertex`, the properties x y z, nx ny nz, one of (s, t), (u, v),
/// (texture_u, texture_v), (texture_s, texture_t), and red green blue; of element `face` the list
/// `vertex_indices` or `vertex_index`, the list `texcoord` of its corners' texture coordinates, and red green blue;
/// instead of faces the lists of strips of element `tristrips`; all in any of the format's types.
/// Colors are sRGB, floats too, from 0 to 1 or, known by a value above 2, from 0 to 255: three.js writes them so, and
/// Blender reads them so.
/// Colors of vertices count before those of faces, with a warning, unless all are white.
/// Everything else is passed over.
/// Polygons are cut into triangles; triangles of a closed body that wind the other way than the rest are turned, with a
/// warning.
/// A mesh without normals gets smooth ones, but across edges of 60° and more; where triangles do not share vertices it is
/// sharp, too.
///
/// # Errors
/// The file cannot be read, breaks the format (the message names line or byte, element and row), or has
/// no usable triangle.
pub fn load_ply(path: &Path, warnings: &mut Vec<Warning>) -> Result<Mesh> {
    parse_ply(&read_file(path)?, path, warnings)
}

/// Parses a PLY file's bytes as [`load_ply`] does; `path` is for messages.
///
/// # Errors
/// As [`load_ply`].
pub fn parse_ply(bytes: &[u8], path: &Path, warnings: &mut Vec<Warning>) -> Result<Mesh> {
    read_ply(bytes, path, warnings).map(|file| in_file_coordinates(file.mesh, file.origin))
}

/// What is in a file.
pub(crate) struct PlyFile {
    pub(crate) mesh: Mesh,
    /// The point from which the positions are counted.
    pub(crate) origin: DVec3,
    /// Name of the mesh's picture, if a comment has one.
    pub(crate) picture: Option<String>,
}

/// As [`parse_ply`], with all that is in the file.
pub(crate) fn read_ply(bytes: &[u8], path: &Path, warnings: &mut Vec<Warning>) -> Result<PlyFile> {
    let header = Header::parse(bytes, path)?;
    let body = header.length;
    let (mut mesh, mut faces, anchor) = match header.format {
        Format::Ascii => read_mesh(&header, Ascii::new(&bytes[body..], header.lines), path),
        Format::LittleEndian => read_mesh(&header, Binary::<false> { bytes, position: body }, path),
        Format::BigEndian => read_mesh(&header, Binary::<true> { bytes, position: body }, path),
    }?;
    let place = Place::file(path);
    warn_of_lost(&faces, &place, warnings);
    for colors in [&mut mesh.colors, &mut faces.colors] {
        make_linear(colors, &place, warnings);
    }
    if !mesh.colors.is_empty() && !faces.colors.is_empty() {
        let message = "the colors of faces are left out beside those of vertices".into();
        warnings.push(Warning { message, place: Some(place.clone()) });
    }
    mesh.triangles = match faces.uvs.is_empty() {
        true => std::mem::take(&mut faces.triangles),
        false => faces.triangles.clone(),
    };
    warn_of_turned(orient(&mut mesh), &place, warnings);
    let mut mesh = with_corners(mesh, &faces, &place, warnings);
    repair_mesh(&mut mesh, &place, warnings)?;
    Ok(PlyFile { mesh, origin: anchor.position(), picture: header.picture })
}

/// Warns of textures that cannot be what is meant.
fn warn_of_lost(faces: &Faces, place: &Place, warnings: &mut Vec<Warning>) {
    let mut warn = |message: String| warnings.push(Warning { message, place: Some(place.clone()) });
    if faces.misfits > 0 {
        let count = faces.misfits;
        warn(format!("{count} faces have not two texture coordinates for each corner: set to (0, 0)"));
    }
    if faces.has_other_pictures {
        warn(String::from(
            "the faces have several pictures by texnumber, but a material has one: all get the same",
        ));
    }
}

/// The mesh with what its corners have of their own, and with normals; several vertices of a place where these differ.
fn with_corners(mesh: Mesh, faces: &Faces, place: &Place, warnings: &mut Vec<Warning>) -> Mesh {
    let own_normals = mesh
        .normals
        .is_empty()
        .then(|| corner_normals(&mesh.positions, &mesh.triangles, SHARED_CREASE, |_| Smoothing::Angle));
    let has_own_colors = !faces.colors.is_empty() && mesh.colors.is_empty();
    let count = mesh.positions.len();
    let is_plain = own_normals.as_ref().is_none_or(|own| own.normals.len() == count);
    if is_plain && faces.uvs.is_empty() && !has_own_colors {
        let normals = own_normals.map_or(mesh.normals, |own| own.normals);
        return Mesh { normals, ..mesh };
    }
    let (normals, of_corners) = match own_normals {
        Some(own) => (own.normals, own.triangles),
        None => (mesh.normals, mesh.triangles.clone()),
    };
    let (colors, of_triangles) = match has_own_colors {
        true => distinct(faces.colors.iter().copied(), |color| color.to_array()),
        false => (mesh.colors, Vec::new()),
    };
    let has_own_uvs = !faces.uvs.is_empty();
    let has_uvs = !mesh.uvs.is_empty();
    let (uvs, of_uvs) = match has_own_uvs {
        true => distinct(faces.uvs.iter().flatten().copied(), |uv| uv.to_array()),
        false => (mesh.uvs, Vec::new()),
    };
    let corner = |number: usize, i: usize| {
        let vertex = mesh.triangles[number][i];
        // Where the triangle was turned, so are its texture coordinates
        let is_turned = faces.triangles.get(number).is_some_and(|&read| read != mesh.triangles[number]);
        let read = if is_turned { [0, 2, 1][i] } else { i };
        Corner {
            position: vertex,
            uv: match (has_own_uvs, has_uvs) {
                (true, _) => of_uvs[3 * number + read],
                (false, true) => vertex,
                (false, false) => NONE,
            },
            normal: of_corners[number][i],
            color: if has_own_colors { of_triangles[number] } else { vertex },
        }
    };
    let is_there = |number: &usize| mesh.triangles[*number].iter().all(|&i| (i as usize) < count);
    let there: Vec<usize> = (0..mesh.triangles.len()).filter(is_there).collect();
    let lost = mesh.triangles.len() - there.len();
    if lost > 0 {
        let message = format!("{lost} triangles with an index out of range: left out");
        warnings.push(Warning { message, place: Some(place.clone()) });
    }
    let tables = Tables { positions: mesh.positions, uvs, normals, colors };
    Welder::new(&tables).weld(there.into_iter().map(|number| [0, 1, 2].map(|i| corner(number, i))))
}

fn read_mesh(header: &Header, mut values: impl Values, path: &Path) -> Result<(Mesh, Faces, Anchor)> {
    let absent = |message: &str| SceneError::at(Place::file(path), message);
    let has = |name: &str| header.elements.iter().any(|element| element.name == name);
    if !has("vertex") {
        return Err(absent("has no element \"vertex\""));
    }
    if !has("face") && !has("tristrips") {
        return Err(absent("has no element \"face\": a cloud of points cannot be rendered"));
    }
    let (mut mesh, mut faces, mut anchor) = (Mesh::default(), Faces::default(), Anchor::default());
    for element in header.elements.iter().filter(|element| !element.properties.is_empty()) {
        match element.name.as_str() {
            "vertex" if mesh.positions.is_empty() => {
                let columns = Columns::of(element).map_err(|message| absent(&message))?;
                columns.reserve(element.count, &mut mesh);
                read_rows(&mut values, element, path, |values| {
                    columns.read_vertex(values, &mut mesh, &mut anchor)
                })?;
            }
            "face" | "tristrips" if faces.triangles.is_empty() => {
                let columns = FaceColumns::of(element).map_err(|message| absent(&message))?;
                faces.triangles.reserve(element.count);
                let mut scratch = Scratch::default();
                // Where faces come before vertices there are no positions yet, and all polygons pass for convex.
                read_rows(&mut values, element, path, |values| {
                    columns.read(values, &mesh.positions, &mut scratch, &mut faces)
                })?;
            }
            _ => read_rows(&mut values, element, path, |values| {
                element.properties.iter().try_for_each(|property| skip(values, property.kind))
            })?,
        }
    }
    Ok((mesh, faces, anchor))
}

/// Reads all rows of an element, and says in which one a fault was.
fn read_rows<V: Values>(
    values: &mut V,
    element: &Element,
    path: &Path,
    mut read_row: impl FnMut(&mut V) -> Result<(), Fault>,
) -> Result<()> {
    for row in 0..element.count {
        let read = values.begin_row().and_then(|()| read_row(values)).and_then(|()| values.end_row());
        read.map_err(|fault| values.error(path, fault, &format!("{} {row}", element.name)))?;
    }
    Ok(())
}

fn skip(values: &mut impl Values, kind: Kind) -> Result<(), Fault> {
    match kind {
        Kind::Scalar(scalar) => values.skip(scalar, 1),
        Kind::List { count, item } => {
            let length = values.list_length(count)?;
            values.skip(item, length)
        }
    }
}

/// Names of the values of a vertex that are read; where a row has several, any one will do.
const NAMES: [&[&str]; 11] = [
    &["x"],
    &["y"],
    &["z"],
    &["nx"],
    &["ny"],
    &["nz"],
    &["s", "u", "texture_u", "texture_s"],
    &["t", "v", "texture_v", "texture_t"],
    &["red", "r", "diffuse_red"],
    &["green", "g", "diffuse_green"],
    &["blue", "b", "diffuse_blue"],
];
const POSITION: usize = 0;
const NORMAL: usize = 3;
const UV: usize = 6;
const COLOR: usize = 8;

/// A property's place in [`NAMES`], or none.
struct Column {
    kind: Kind,
    target: Option<usize>,
}

/// Which property of a vertex is what.
struct Columns {
    columns: Vec<Column>,
    has_normal: bool,
    has_uv: bool,
    has_color: bool,
    /// The value of a color that is 1.
    color_scale: f64,
}

impl Columns {
    fn of(element: &Element) -> Result<Self, String> {
        let target = |name: &str| NAMES.iter().position(|names| names.contains(&name));
        let column = |property: &header::Property| Column {
            kind: property.kind,
            target: target(&property.name).filter(|_| matches!(property.kind, Kind::Scalar(_))),
        };
        let columns: Vec<Column> = element.properties.iter().map(column).collect();
        let has = |wanted: usize| columns.iter().any(|column| column.target == Some(wanted));
        if let Some(missing) = (POSITION..NORMAL).find(|&axis| !has(axis)) {
            return Err(format!("element \"vertex\" has no property \"{}\"", NAMES[missing][0]));
        }
        let red = columns.iter().find(|column| column.target == Some(COLOR));
        let color_scale = red.map_or(1.0, |column| color_scale(column.kind));
        let [has_normal, has_uv, has_color] =
            [(NORMAL, UV), (UV, COLOR), (COLOR, NAMES.len())].map(|(first, end)| (first..end).all(has));
        Ok(Self { has_normal, has_uv, has_color, color_scale, columns })
    }

    /// Makes room without slack: the header's count has been checked against the file's length.
    fn reserve(&self, count: usize, mesh: &mut Mesh) {
        mesh.positions.reserve_exact(count);
        mesh.normals.reserve_exact(if self.has_normal { count } else { 0 });
        mesh.uvs.reserve_exact(if self.has_uv { count } else { 0 });
        mesh.colors.reserve_exact(if self.has_color { count } else { 0 });
    }

    fn read_vertex(
        &self,
        values: &mut impl Values,
        mesh: &mut Mesh,
        anchor: &mut Anchor,
    ) -> Result<(), Fault> {
        let mut position = DVec3::ZERO;
        let mut row = [0.0_f32; NAMES.len()];
        for column in &self.columns {
            match (column.kind, column.target) {
                (Kind::Scalar(scalar), Some(target)) => {
                    let value = values.value(scalar)?;
                    if target < NORMAL {
                        position[target] = value;
                    }
                    let scale = if target >= COLOR { self.color_scale } else { 1.0 };
                    row[target] = (value / scale) as f32;
                }
                (kind, _) => skip(values, kind)?,
            }
        }
        mesh.positions.push(anchor.relative(position));
        if self.has_normal {
            mesh.normals.push(Vec3::from_slice(&row[NORMAL..]));
        }
        if self.has_uv {
            mesh.uvs.push(Vec2::from_slice(&row[UV..]));
        }
        if self.has_color {
            mesh.colors.push(Vec3::from_slice(&row[COLOR..]));
        }
        Ok(())
    }
}

/// The value of a color's channel that is 1.
fn color_scale(kind: Kind) -> f64 {
    match kind {
        Kind::Scalar(NumberType::F32 | NumberType::F64) => 1.0,
        Kind::Scalar(NumberType::U16 | NumberType::I16) => 65535.0,
        _ => 255.0,
    }
}

#[cfg(test)]
mod tests {
    use translucid_testing::{mutants, power};

    use super::*;

    fn parsed(bytes: &[u8]) -> Result<(Mesh, String)> {
        let mut warnings = Vec::new();
        let mesh = parse_ply(bytes, Path::new("a.ply"), &mut warnings)?;
        let lines: Vec<_> = warnings.iter().map(ToString::to_string).collect();
        Ok((mesh, lines.join("\n")))
    }

    fn file(format: &str, vertex: &str, face: &str, data: &[u8]) -> Vec<u8> {
        let header = format!(
            "ply\nformat {format} 1.0\ncomment made here\nelement vertex 4\n{vertex}\
             element face 2\n{face}end_header\n"
        );
        [header.as_bytes(), data].concat()
    }

    const POSITION_LINES: &str = "property float x\nproperty float y\nproperty float z\n";
    const LIST_LINE: &str = "property list uchar int vertex_indices\n";

    fn ascii(data: &str) -> Vec<u8> {
        file("ascii", POSITION_LINES, LIST_LINE, data.as_bytes())
    }

    const SQUARE: &str = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";

    fn square() -> Mesh {
        Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y],
            normals: vec![Vec3::Z; 4],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        }
    }

    /// The square with every attribute, short indices and properties to pass over, in binary.
    fn rich(big_endian: bool) -> Vec<u8> {
        let vertex = "property list uchar short rings\nproperty double x\nproperty float32 y\n\
            property float z\nproperty float nx\nproperty float ny\nproperty float nz\n\
            property float s\nproperty float t\nproperty uchar red\nproperty uchar green\n\
            property uchar blue\nproperty uchar alpha\n";
        let face = "property int8 flags\nproperty list ushort uint16 vertex_index\n\
            property list uint8 float weights\n";
        let mut data = Vec::new();
        let mut put = |little: &[u8]| {
            let mut bytes = little.to_vec();
            if big_endian {
                bytes.reverse();
            }
            data.extend(bytes);
        };
        for p in square().positions {
            put(&[2]);
            put(&7_i16.to_le_bytes());
            put(&(-7_i16).to_le_bytes());
            put(&f64::from(p.x).to_le_bytes());
            for value in [p.y, p.z, 0.0, 0.0, 2.0, p.x, p.y] {
                put(&value.to_le_bytes());
            }
            for byte in [255, 188, 0, 9] {
                put(&[byte]);
            }
        }
        for triangle in square().triangles {
            put(&[0xff]);
            put(&3_u16.to_le_bytes());
            triangle.iter().for_each(|&index| put(&(index as u16).to_le_bytes()));
            put(&[1]);
            put(&0.5_f32.to_le_bytes());
        }
        file(if big_endian { "binary_big_endian" } else { "binary_little_endian" }, vertex, face, &data)
    }

    #[test]
    fn ply_reads_ascii_and_computes_normals() {
        assert_eq!(parsed(&ascii(SQUARE)).unwrap(), (square(), String::new()));
        let windows = String::from_utf8(ascii(SQUARE)).unwrap().replace('\n', "\r\n");
        assert_eq!(parsed(windows.trim_end().as_bytes()).unwrap().0, square());
        let spaced = ascii("0 0 0\n\n 1 0\t0 \n1 1 0\n0 1 0\n\n3 0 1 2\n3 0 2 3");
        assert_eq!(parsed(&spaced).unwrap().0, square());
    }

    #[test]
    fn ply_reads_both_byte_orders_alike_with_every_attribute() {
        let (mesh, warnings) = parsed(&rich(false)).unwrap();
        assert_eq!(warnings, "");
        assert_eq!(mesh, parsed(&rich(true)).unwrap().0);
        assert_eq!(mesh.positions, square().positions);
        assert_eq!(mesh.triangles, square().triangles);
        assert_eq!(mesh.normals, vec![Vec3::Z; 4]);
        assert_eq!(mesh.uvs[2], Vec2::ONE);
        assert!(mesh.colors[0].distance(Vec3::new(1.0, 0.502_886, 0.0)) < 1e-5, "{}", mesh.colors[0]);
    }

    /// three.js 0.187 writes 0.5 0.25 0.1, which are linear, so, with an exponent of 0.41666 in place of 1/2.4.
    #[test]
    fn ply_takes_float_colors_as_srgb() {
        let floats = "property float red\nproperty float green\nproperty float blue\n";
        let color = ".735360635 .537104203 .349196420";
        let of = |has_vertices: bool, kind: &str| {
            let lines = |first: &str, has: bool| format!("{first}{}", if has { floats } else { "" });
            let [vertex, face] = [has_vertices, !has_vertices].map(|has| if has { color } else { "" });
            let corners = ["0 0 0", "1 0 0", "1 1 0", "0 1 0"].map(|corner| format!("{corner} {vertex}\n"));
            let data = format!("{}3 0 1 2 {face}\n3 0 2 3 {face}\n", corners.concat());
            let vertices = lines(POSITION_LINES, has_vertices).replace("float", kind);
            parsed(&file("ascii", &vertices, &lines(LIST_LINE, !has_vertices), data.as_bytes())).unwrap()
        };
        for (has_vertices, kind) in [(true, "float"), (true, "double"), (false, "float")] {
            let (mesh, warnings) = of(has_vertices, kind);
            assert_eq!(warnings, "");
            assert!(
                mesh.colors.iter().all(|c| c.distance(Vec3::new(0.5, 0.25, 0.1)) < 2e-5),
                "{:?}",
                mesh.colors
            );
        }
    }

    /// MeshLab writes white vertices beside colored faces.
    #[test]
    fn ply_shows_colors_of_faces_where_vertices_have_none() {
        let bytes = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
        let of = |vertex: &str, face: &str| {
            let corners = ["0 0 0", "1 0 0", "1 1 0", "0 1 0"].map(|corner| format!("{corner} {vertex}\n"));
            let data = format!("{}3 0 1 2 {face}\n3 0 2 3 {face}\n", corners.concat());
            let [vertices, faces] = [POSITION_LINES, LIST_LINE].map(|line| format!("{line}{bytes}"));
            let (mesh, warnings) = parsed(&file("ascii", &vertices, &faces, data.as_bytes())).unwrap();
            (mesh.colors.first().copied(), mesh.colors.len(), warnings)
        };
        let [white, red, blue] = ["255 255 255", "255 0 0", "0 0 255"];
        assert_eq!(of(white, red), (Some(Vec3::X), 4, String::new()));
        assert_eq!(of(blue, white), (Some(Vec3::Z), 4, String::new()));
        assert_eq!(of(white, white), (None, 0, String::new()));
        let told = "a.ply: the colors of faces are left out beside those of vertices";
        assert_eq!(of(blue, red), (Some(Vec3::Z), 4, told.into()));
    }

    #[test]
    fn ply_takes_floats_from_0_to_255_as_integers() {
        let floats = "property float red\nproperty float green\nproperty float blue\n";
        let bytes = floats.replace("float", "uchar");
        let told = "a.ply: vertex colors reach 255, so they are taken for values from 0 to 255";
        let of_vertices = "0 0 0 255 128 0\n1 0 0 0 64 9\n1 1 0 1 1 1\n0 1 0 0 0 0\n3 0 1 2\n3 0 2 3\n";
        let of_faces = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 255 128 0\n3 0 2 3 0 64 9\n";
        for (vertex, face, data) in [(true, false, of_vertices), (false, true, of_faces)] {
            let lines =
                |first: &str, colors: &str, has: bool| format!("{first}{}", if has { colors } else { "" });
            let of = |colors: &str| {
                let vertex = lines(POSITION_LINES, colors, vertex);
                parsed(&file("ascii", &vertex, &lines(LIST_LINE, colors, face), data.as_bytes())).unwrap()
            };
            let ((a, warnings), (b, _)) = (of(floats), of(&bytes));
            assert_eq!((a, warnings.as_str()), (b, told));
        }
    }

    #[test]
    fn ply_reads_every_type() {
        for (name, size) in [
            ("char", 1),
            ("int8", 1),
            ("uchar", 1),
            ("uint8", 1),
            ("short", 2),
            ("int16", 2),
            ("ushort", 2),
            ("uint16", 2),
            ("int", 4),
            ("int32", 4),
            ("uint", 4),
            ("uint32", 4),
        ] {
            let vertex = POSITION_LINES.replace("float", name);
            let face = format!("property list {name} {name} vertex_indices\n");
            let mut data = Vec::new();
            let mut put = |value: u8| {
                data.push(value);
                data.resize(data.len() + size - 1, 0);
            };
            square().positions.iter().flat_map(Vec3::to_array).for_each(|x| put(x as u8));
            for triangle in square().triangles {
                put(3);
                triangle.iter().for_each(|&index| put(index as u8));
            }
            let (mesh, _) = parsed(&file("binary_little_endian", &vertex, &face, &data)).unwrap();
            assert_eq!(mesh, square(), "{name}");
        }
    }

    #[test]
    fn ply_cuts_polygons() {
        let data = ascii("0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n4 1 2 3 0\n");
        let (mesh, _) = parsed(&data).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [1, 2, 3], [1, 3, 0]]);
    }

    /// Lists of corners as MeshLab writes them, at a seam, and colors of faces.
    #[test]
    fn ply_reads_what_corners_and_faces_have_of_their_own() {
        let face = format!(
            "{LIST_LINE}property list uchar float texcoord\nproperty int texnumber\nproperty uchar red\n\
             property uchar green\nproperty uchar blue\n"
        );
        let data =
            "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 6 0 0 1 0 1 1 0 255 0 0\n3 0 2 3 6 .5 0 1 1 0 1 0 0 0 255\n";
        let (mesh, warnings) = parsed(&file("ascii", POSITION_LINES, &face, data.as_bytes())).unwrap();
        assert_eq!(warnings, "");
        let of_corners = |number: usize| mesh.triangles[number].map(|i| mesh.uvs[i as usize]);
        assert_eq!(of_corners(0), [Vec2::ZERO, Vec2::X, Vec2::ONE]);
        assert_eq!(of_corners(1), [Vec2::new(0.5, 0.0), Vec2::ONE, Vec2::Y]);
        for (number, color) in [(0, Vec3::X), (1, Vec3::Z)] {
            assert!(mesh.triangles[number].iter().all(|&i| mesh.colors[i as usize] == color));
        }
        assert_eq!(mesh.normals, vec![Vec3::Z; 6]);
        let broken = data.replace("6 0 0 1 0 1 1", "2 0 0").replace("0 0 0 255", "1 0 0 255");
        let (_, warnings) = parsed(&file("ascii", POSITION_LINES, &face, broken.as_bytes())).unwrap();
        assert!(warnings.contains("1 faces have not two texture coordinates for each corner"), "{warnings}");
        assert!(warnings.contains("several pictures by texnumber"), "{warnings}");
    }

    /// As in the Stanford archives.
    #[test]
    fn ply_reads_strips() {
        let text = String::from_utf8(ascii("0 0 0\n1 0 0\n1 1 0\n0 1 0\n8 0 1 3 2 -1 0 1 2\n")).unwrap();
        let text = text.replace("element face 2", "element tristrips 1").replace("list uchar", "list int");
        let (mesh, warnings) = parsed(text.as_bytes()).unwrap();
        assert_eq!((mesh.triangles, warnings.as_str()), (vec![[0, 1, 3], [3, 1, 2], [0, 1, 2]], ""));
    }

    #[test]
    fn ply_has_creases_and_turns_faces_of_a_closed_body() {
        let vertices: String = (0..8).map(|i| format!("{} {} {}\n", i & 1, i >> 1 & 1, i >> 2)).collect();
        let faces = "4 0 2 3 1\n4 4 5 7 6\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 5 7 3 1\n";
        let text = String::from_utf8(ascii(&format!("{vertices}{faces}"))).unwrap();
        let text = text.replace("vertex 4", "vertex 8").replace("face 2", "face 6");
        let (mesh, warnings) = parsed(text.as_bytes()).unwrap();
        assert_eq!(warnings, "a.ply: 2 triangles of a closed body wound the other way than the rest: turned");
        assert_eq!(mesh.positions.len(), 24);
        for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
            assert!(normal.abs().max_element() > 0.9999 && normal.dot(position - 0.5) > 0.4);
        }
    }

    #[test]
    fn ply_repairs_with_a_warning() {
        let (mesh, warnings) = parsed(&ascii("0 0 0\n1 0 0\n1 1 0\n0 1 nan\n3 0 1 2\n3 0 2 -1\n")).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2]]);
        assert_eq!(mesh.positions.len(), 3);
        assert!(warnings.contains("a.ply: 1 triangle with an index out of range"), "{warnings}");
    }

    #[test]
    fn ply_that_is_broken_is_refused_with_its_place() {
        let text = |from: &str, to: &str| {
            let good = String::from_utf8(ascii(SQUARE)).unwrap();
            assert!(good.contains(from));
            good.replacen(from, to, 1).into_bytes()
        };
        let binary = |length: usize| rich(false)[..length].to_vec();
        let mut negative = rich(false);
        let list = negative.len() - 2 * 14 + 1;
        negative[list..list + 2].copy_from_slice(&[0xff, 0xff]);
        for (bytes, parts) in [
            (Vec::new(), ["a.ply:1", "not a PLY file"]),
            (b"PK\x03\x04 zip".to_vec(), ["a.ply:1", "not a PLY file"]),
            (text("end_header\n", ""), ["a.ply", "\"0 0 0\" is no line of a PLY header"]),
            (b"ply\nformat ascii 1.0\n".to_vec(), ["a.ply:3", "no \"end_header\""]),
            (text("format ascii 1.0\n", ""), ["a.ply", "no \"format\""]),
            (text("ascii", "utf8"), ["a.ply:2", "unknown format \"utf8\""]),
            (text("element vertex 4", "element vertex four"), ["a.ply:4", "\"four\" is not a number"]),
            (text("element vertex 4", "element vertex -4"), ["a.ply:4", "\"-4\""]),
            (
                text("element vertex 4", "element vertex 4000000000"),
                ["a.ply", "4000000000 elements \"vertex\""],
            ),
            (text("element vertex 4", "element vertex 18446744073709551615"), ["a.ply", "too short"]),
            (text("element face 2", "element face 100000"), ["a.ply", "100000 elements \"face\""]),
            (text("element vertex 4\n", ""), ["a.ply:4", "a property before any element"]),
            (text("property float x", "property real x"), ["a.ply:5", "unknown type \"real\""]),
            (text("property float x", "property float"), ["a.ply:5", "a type and a name"]),
            (text("property float z\n", ""), ["a.ply", "no property \"z\""]),
            (text("list uchar", "list float"), ["a.ply:9", "cannot be a float"]),
            (text("vertex_indices", "corners"), ["a.ply", "no list \"vertex_indices\""]),
            (text("element face 2", "element edge 2"), ["a.ply", "cloud of points"]),
            (text("element vertex 4", "element point 4"), ["a.ply", "no element \"vertex\""]),
            (text("1 1 0\n", "1 1\n"), ["a.ply:13", "vertex 2 has fewer values"]),
            (
                text("1 1 0\n", "1 1 0 5\n"),
                ["a.ply:13", "vertex 2 has more values than its properties, from \"5\""],
            ),
            (text("1 1 0\n", "1 one 0\n"), ["a.ply:13", "\"one\" in vertex 2 is not a number"]),
            (text("3 0 1 2\n", "-3 0 1 2\n"), ["a.ply:15", "face 0 has a list of length -3"]),
            (text("3 0 1 2\n", "9 0 1 2\n"), ["a.ply:15", "face 0 has fewer values"]),
            (text("3 0 1 2\n", "3 0 1.5 2\n"), ["a.ply:15", "face 0 has the index 1.5"]),
            (text("element face 2", "element vertex 2"), ["a.ply:8", "there are two elements \"vertex\""]),
            (text("3 0 1 2\n3 0 2 3\n", "3 0 1 2         \n"), ["a.ply:15", "the file ends before face 1"]),
            (text("3 0 1 2\n3 0 2 3\n", "3 0 1 7\n3 0 0 3\n"), ["a.ply", "none of the mesh's 2 triangles"]),
            (text("element face 2", "element face 0"), ["a.ply", "no triangles"]),
            (binary(rich(false).len() - 1), ["byte", "ends in face 1"]),
            (binary(rich(false).len() - 13), ["byte", "ends in face 1"]),
            (binary(rich(false).len() - 100), ["a.ply", "too short"]),
            (negative, ["a.ply, byte", "the file ends in face 0"]),
        ] {
            let message = parsed(&bytes).unwrap_err().to_string();
            assert!(message.starts_with("a.ply"), "{message}");
            assert!(parts.iter().all(|part| message.contains(part)), "{message}: {parts:?}");
        }
    }

    #[test]
    fn ply_survives_any_mutation() {
        for file in [ascii(SQUARE), rich(false), rich(true)] {
            for mutant in mutants(&file, power(3_000)) {
                if let Ok((mesh, _)) = parsed(&mutant) {
                    assert!(mesh.positions.iter().chain(&mesh.normals).all(|v| v.is_finite()));
                    assert!(mesh.triangles.iter().flatten().all(|&i| (i as usize) < mesh.positions.len()));
                }
            }
        }
    }
}
