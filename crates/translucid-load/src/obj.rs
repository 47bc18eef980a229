//! Wavefront OBJ meshes (Wavefront Technologies, "Advanced Visualizer Manual", appendix B1, 1995).

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use glam::{DVec3, Vec2, Vec3};
use translucid_scene::{ColorInput, Material, Object, Place, SceneError, Triangle, Warning, repair_mesh};

use super::MeshFile;
use super::mtl::{Beside, ImagePool, parse_mtl};
use super::polygon::triangulate;
use crate::bodies::join;
use crate::creases::{SHARED_CREASE, Smoothing, corner_normals};
use crate::file::{is_file, stem};
use crate::loading::Loading;
use crate::origin::Anchor;
use crate::result::Result;
use crate::vertex_colors::make_linear;
use crate::weld::{Corner, NONE, Tables, Welder};
use crate::winding::{reversed, warn_of_turned};
use crate::writer::Writer;

/// Loads an OBJ mesh with its material libraries and their images.
///
/// Polygons are cut into triangles.
/// Corners without a normal get the smooth normal of their position, over all parts and texture seams: within a smoothing
/// group (`s 1`) whatever the angle, without one (`s off`) never, and in a file that says nothing across edges of less
/// than 60°.
/// Triangles of a closed body that wind the other way than the rest are turned, with a warning.
/// Vertex colors (`v x y z r g b` and perhaps an opacity, which is passed over) are sRGB, as MeshLab and trimesh write
/// them; those from 0 to 255 are known by a value above 2.
/// ZBrush writes them as comments, `#MRGB MMRRGGBB…`, behind the vertices.
/// They multiply the materials' `Kd`, but do not count beside a `map_Kd`, with a warning, nor where all are white.
/// Groups (`g`) whose surface goes on across an edge that they share are one body; objects (`o`) are bodies of their own.
/// Lines, curves and free-form surfaces are passed over.
/// A library, material or image that is missing adds a warning.
///
/// # Errors
/// The file cannot be read, a line breaks the format (the message names it), or no triangle is usable.
pub fn load_obj(path: &Path, warnings: &mut Vec<Warning>) -> Result<MeshFile> {
    read_obj(path, &mut Loading::unwatched(warnings))
}

/// As [`load_obj`], as a part of a load.
pub(crate) fn read_obj(path: &Path, loading: &mut Loading<'_>) -> Result<MeshFile> {
    parse(&loading.read(path)?, path, loading)
}

/// Parses an OBJ file's bytes as [`load_obj`] does; libraries and images are beside `path`.
///
/// # Errors
/// As [`load_obj`].
pub fn parse_obj(bytes: &[u8], path: &Path, warnings: &mut Vec<Warning>) -> Result<MeshFile> {
    parse(bytes, path, &mut Loading::unwatched(warnings))
}

fn parse(bytes: &[u8], path: &Path, loading: &mut Loading<'_>) -> Result<MeshFile> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut file = ObjFile::default();
    let mut joined = Vec::new();
    for (number, line) in bytes.split(|&byte| byte == b'\n').enumerate() {
        let line = line.trim_ascii();
        if let Some(start) = line.strip_suffix(b"\\") {
            joined.extend_from_slice(start);
            joined.push(b' ');
            continue;
        }
        let at = |message| SceneError::at(Place::line(path, number + 1), message);
        if joined.is_empty() {
            file.read_line(line, number + 1).map_err(at)?;
        } else {
            joined.extend_from_slice(line);
            file.read_line(&joined, number + 1).map_err(at)?;
            joined.clear();
        }
    }
    file.into_scene(bytes, path, loading)
}

/// An index that points nowhere, whatever the file still holds.
const BROKEN: u32 = u32::MAX - 1;

/// Faces of one part, as they are read.
#[derive(Debug)]
struct Faces {
    name: String,
    /// The name is that of a group.
    is_group: bool,
    material: Option<String>,
    /// Their indices are from 0, or [`NONE`], or out of range.
    triangles: Vec<[Corner; 3]>,
    smoothing: Vec<Smoothing>,
}

/// The tables of the file.
#[derive(Debug, Default)]
struct ObjFile {
    /// Colors are as many as positions or fewer: the rest is white.
    tables: Tables,
    /// Where the positions are counted from.
    anchor: Anchor,
    faces: Vec<Faces>,
    /// The first vertex since the last face, to which ZBrush's colors belong.
    first_painted: usize,
    is_after_faces: bool,
    smoothing: Smoothing,
    /// Number of each part in `faces`.
    numbers: HashMap<(String, Option<String>), usize>,
    /// Where the next face goes, once known.
    current: Option<usize>,
    object: String,
    has_objects: bool,
    material: Option<String>,
    /// Line of each library's name and of the first use of each material.
    libraries: Vec<(usize, String)>,
    uses: HashMap<String, usize>,
    /// First line with an index that is not there (yet).
    first_beyond: Option<usize>,
    /// Faces with fewer than three corners.
    slivers: usize,
    polygon: Vec<Corner>,
}

impl ObjFile {
    fn read_line(&mut self, line: &[u8], number: usize) -> Result<(), String> {
        let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
        let (keyword, rest) = line.split_at(end);
        match keyword {
            b"v" => self.read_vertex(rest),
            b"vt" => {
                let ([u, v, ..], _) = numbers(rest, 1..=3)?;
                self.tables.uvs.push(Vec2::new(u as f32, v as f32));
                Ok(())
            }
            b"vn" => {
                let ([x, y, z, ..], _) = numbers(rest, 3..=3)?;
                self.tables.normals.push(DVec3::new(x, y, z).as_vec3());
                Ok(())
            }
            b"f" => self.read_face(rest, number),
            b"s" => {
                self.smoothing = smoothing(rest);
                Ok(())
            }
            b"o" => {
                self.has_objects = true;
                self.begin_object(name(rest));
                Ok(())
            }
            b"g" if !self.has_objects => {
                self.begin_object(name(rest));
                Ok(())
            }
            b"usemtl" => {
                let material = name(rest);
                self.uses.entry(material.clone()).or_insert(number);
                self.material = Some(material);
                self.current = None;
                Ok(())
            }
            b"mtllib" => {
                self.libraries.push((number, name(rest)));
                Ok(())
            }
            b"#MRGB" => {
                self.read_painted(rest.trim_ascii());
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn begin_object(&mut self, name: String) {
        self.object = name;
        self.current = None;
    }

    /// Position, then perhaps a color, or a weight, which is one of curves. After a color there may be an opacity.
    fn read_vertex(&mut self, rest: &[u8]) -> Result<(), String> {
        let (v, count) = numbers(rest, 3..=7)?;
        let Tables { positions, colors, .. } = &mut self.tables;
        if count >= 6 {
            colors.resize(positions.len(), Vec3::ONE);
            colors.push(DVec3::from_slice(&v[3..6]).as_vec3());
        }
        if std::mem::take(&mut self.is_after_faces) {
            self.first_painted = positions.len();
        }
        positions.push(self.anchor.relative(DVec3::from_slice(&v)));
        Ok(())
    }

    /// Colors of the next vertices without one, each a mask, red, green and blue of two hexadecimal digits.
    fn read_painted(&mut self, rest: &[u8]) {
        let digits = |word: &[u8]| u32::from_str_radix(str::from_utf8(word).ok()?, 16).ok();
        let colors = rest.as_chunks::<8>().0.iter().map_while(|word| digits(word));
        let linear = |color: u32| Vec3::from([16, 8, 0].map(|shift| (color >> shift & 255) as f32 / 255.0));
        let Self { tables, first_painted, .. } = self;
        if tables.colors.len() < *first_painted {
            tables.colors.resize(*first_painted, Vec3::ONE);
        }
        tables.colors.extend(colors.map(linear));
    }

    fn read_face(&mut self, rest: &[u8], line: usize) -> Result<(), String> {
        let mut polygon = std::mem::take(&mut self.polygon);
        polygon.clear();
        for word in words(rest) {
            polygon.push(self.corner(word, line)?);
        }
        if polygon.len() < 3 {
            self.slivers += 1;
        } else {
            let part = self.part();
            let Self { tables, faces, .. } = self;
            let position = |corner: Corner| tables.positions.get(corner.position as usize).copied();
            let faces = &mut faces[part];
            triangulate(&polygon, position, |triangle| faces.triangles.push(triangle));
            faces.smoothing.resize(faces.triangles.len(), self.smoothing);
        }
        self.polygon = polygon;
        self.is_after_faces = true;
        Ok(())
    }

    /// Number of the part that faces now go to.
    fn part(&mut self) -> usize {
        *self.current.get_or_insert_with(|| {
            let key = (self.object.clone(), self.material.clone());
            *self.numbers.entry(key).or_insert_with(|| {
                let (name, material) = (self.object.clone(), self.material.clone());
                let is_group = !self.has_objects;
                let (triangles, smoothing) = (Vec::new(), Vec::new());
                self.faces.push(Faces { name, is_group, material, triangles, smoothing });
                self.faces.len() - 1
            })
        })
    }

    /// Parses "position", "position/uv", "position//normal" or "position/uv/normal".
    fn corner(&mut self, word: &[u8], line: usize) -> Result<Corner, String> {
        let Tables { positions, uvs, normals, .. } = &self.tables;
        let counts = [positions.len(), uvs.len(), normals.len()];
        let mut found = [NONE; 3];
        for (i, text) in word.split(|&byte| byte == b'/').enumerate() {
            let slot = found.get_mut(i).filter(|_| i > 0 || !text.is_empty());
            let slot = slot.ok_or_else(|| format!("\"{}\" is not a corner like 1/2/3", quote(word)))?;
            if !text.is_empty() {
                *slot = index(text, counts[i])?;
                if *slot as usize >= counts[i] {
                    self.first_beyond.get_or_insert(line);
                }
            }
        }
        let [position, uv, normal] = found;
        Ok(Corner { position, uv, normal, color: position })
    }

    fn into_scene(mut self, bytes: &[u8], path: &Path, loading: &mut Loading<'_>) -> Result<MeshFile> {
        if self.faces.is_empty() {
            return Err(SceneError::at(Place::file(path), "has no faces: is it an OBJ mesh?"));
        }
        make_linear(&mut self.tables.colors, &Place::file(path), loading.warnings);
        if self.slivers > 0 {
            let message = format!("faces with fewer than three corners: {} left out", self.slivers);
            loading.warnings.push(Warning { message, place: Some(Place::file(path)) });
        }
        let mut pool = ImagePool::default();
        let mut materials = self.load_libraries(bytes, path, &mut pool, loading)?;
        let plain = materials.len();
        let has_colors = !self.tables.colors.is_empty();
        let origin = self.anchor.position();
        let objects = self.build_objects(path, &materials, loading.warnings)?;
        if plain > 0 && objects.iter().any(|object| object.material == plain) {
            let base_color = if has_colors { ColorInput::vertex() } else { Material::default().base_color };
            materials.push(Material { base_color, ..Material::default() });
        }
        Ok(MeshFile { origin, objects, materials, images: pool.into_images(), ..MeshFile::default() })
    }

    fn load_libraries(
        &self,
        obj: &[u8],
        path: &Path,
        pool: &mut ImagePool,
        loading: &mut Loading<'_>,
    ) -> Result<Vec<Material>> {
        let mut materials: Vec<Material> = Vec::new();
        for (line, names) in &self.libraries {
            for library in library_paths(path, names) {
                match loading.read(&library) {
                    Ok(bytes) => {
                        let has_colors = !self.tables.colors.is_empty();
                        let beside = Beside { writer: Writer::of_library(&bytes, obj), has_colors };
                        materials.extend(parse_mtl(&bytes, &library, beside, pool, loading)?);
                    }
                    Err(error) => {
                        let message = format!("material library {error}");
                        loading.warnings.push(Warning { message, place: Some(Place::line(path, *line)) });
                    }
                }
            }
        }
        let known: HashSet<&str> = materials.iter().map(|material| material.name.as_str()).collect();
        let mut missing: Vec<_> =
            self.uses.iter().filter(|(name, _)| !known.contains(name.as_str())).collect();
        missing.sort_by_key(|(_, line)| **line);
        for (name, line) in missing {
            let message = format!("there is no material \"{name}\" in the material libraries");
            loading.warnings.push(Warning { message, place: Some(Place::line(path, *line)) });
        }
        Ok(materials)
    }

    /// An object of each part, with the index after the last for those without a material.
    fn build_objects(
        mut self,
        path: &Path,
        materials: &[Material],
        warnings: &mut Vec<Warning>,
    ) -> Result<Vec<Object>> {
        let lost = self.leave_out_beyond();
        warn_of_turned(self.orient(), &Place::file(path), warnings);
        self.add_normals();
        let mut welder = Welder::new(&self.tables);
        let (mut objects, mut fault) = (Vec::new(), None);
        let bodies = self.bodies();
        // The last definition of a name counts.
        let named: HashMap<&str, usize> =
            materials.iter().enumerate().map(|(number, material)| (material.name.as_str(), number)).collect();
        for (faces, subsurface_group) in self.faces.iter().zip(bodies) {
            let mut mesh = welder.weld(faces.triangles.iter().copied());
            match repair_mesh(&mut mesh, &Place::file(path), warnings) {
                Ok(()) => {
                    let name = faces.material.as_deref();
                    let material = name.and_then(|name| named.get(name)).copied().unwrap_or(materials.len());
                    let name = if faces.name.is_empty() { stem(path) } else { faces.name.clone() };
                    objects.push(Object {
                        name,
                        mesh: mesh.into(),
                        material,
                        subsurface_group,
                        ..Object::default()
                    });
                }
                Err(error) => {
                    let message = format!("part \"{}\" is left out: {}", faces.name, error.message);
                    warnings.push(Warning { message, place: error.place.clone() });
                    fault = Some(error);
                }
            }
        }
        let place = self.first_beyond.map_or_else(|| Place::file(path), |line| Place::line(path, line));
        let messages = messages(lost);
        match fault {
            Some(error) if objects.is_empty() => {
                let reason = messages.first().unwrap_or(&error.message);
                return Err(SceneError::at(place, format!("no face can be used: {reason}")));
            }
            _ => (),
        }
        warnings.extend(messages.into_iter().map(|message| Warning { message, place: Some(place.clone()) }));
        Ok(objects)
    }

    /// Leaves out triangles, texture coordinates and normals with an index that points nowhere; returns their numbers.
    fn leave_out_beyond(&mut self) -> [usize; 3] {
        let mut lost = [0; 3];
        if self.first_beyond.is_none() {
            return lost;
        }
        let Tables { positions, uvs, normals, .. } = &self.tables;
        for Faces { triangles, smoothing, .. } in &mut self.faces {
            let is_there = |triangle: &[Corner; 3]| {
                triangle.iter().all(|corner| (corner.position as usize) < positions.len())
            };
            let mut kept = triangles.iter().map(is_there);
            smoothing.retain(|_| kept.next().unwrap_or(true));
            let before = triangles.len();
            triangles.retain(is_there);
            lost[0] += before - triangles.len();
            for corner in triangles.as_flattened_mut() {
                let kinds = [(&mut corner.uv, uvs.len()), (&mut corner.normal, normals.len())];
                for ((index, count), lost) in kinds.into_iter().zip(&mut lost[1..]) {
                    if *index != NONE && *index as usize >= count {
                        (*index, *lost) = (NONE, *lost + 1);
                    }
                }
            }
        }
        lost
    }

    /// For each part the number of its body: of one name, or of groups whose surface goes on from one to the other.
    fn bodies(&self) -> Vec<u32> {
        let mut numbers = HashMap::new();
        let mut body_of = Vec::new();
        for faces in &self.faces {
            let next = numbers.len() as u32; // A file's parts are far fewer than 2³².
            body_of.push(*numbers.entry(&faces.name).or_insert(next));
        }
        let groups = body_of.iter().copied().zip(&self.faces).filter(|(_, faces)| faces.is_group);
        let groups: Vec<_> = groups.map(|(body, faces)| (body, &faces.triangles[..])).collect();
        join(&mut body_of, &self.tables.positions, groups);
        body_of
    }

    /// The positions of all triangles.
    fn triangles(&self) -> Vec<Triangle> {
        let triangles = self.faces.iter().flat_map(|faces| &faces.triangles);
        triangles.map(|triangle| triangle.map(|corner| corner.position)).collect()
    }

    /// Turns triangles of closed bodies that wind the other way than the rest, and leaves out normals of theirs that point
    /// in; returns how many.
    fn orient(&mut self) -> usize {
        let is_turned = reversed(&self.tables.positions, &self.triangles());
        let Tables { positions, normals, .. } = &self.tables;
        let mut count = 0;
        for (triangle, _) in self
            .faces
            .iter_mut()
            .flat_map(|faces| &mut faces.triangles)
            .zip(is_turned)
            .filter(|(_, is_turned)| *is_turned)
        {
            count += 1;
            triangle.swap(1, 2);
            let [a, b, c] = triangle.map(|corner| positions[corner.position as usize]);
            let outward = (b - a).cross(c - a);
            for corner in triangle {
                if normals.get(corner.normal as usize).is_some_and(|normal| normal.dot(outward) < 0.0) {
                    corner.normal = NONE;
                }
            }
        }
        count
    }

    /// Computes the normals of corners that have none.
    fn add_normals(&mut self) {
        let lacking = |corner: &Corner| corner.normal == NONE;
        if !self.faces.iter().any(|faces| faces.triangles.as_flattened().iter().any(lacking)) {
            return;
        }
        let smoothing: Vec<Smoothing> =
            self.faces.iter().flat_map(|faces| &faces.smoothing).copied().collect();
        let triangles = self.triangles();
        let Tables { positions, normals, .. } = &mut self.tables;
        let found = corner_normals(positions, &triangles, SHARED_CREASE, |number| smoothing[number]);
        let first = normals.len() as u32;
        normals.extend(found.normals);
        let corners = self.faces.iter_mut().flat_map(|faces| faces.triangles.as_flattened_mut());
        for (corner, number) in corners.zip(found.triangles.into_flattened()) {
            if corner.normal == NONE {
                corner.normal = first + number;
            }
        }
    }
}

/// Things left out, of all parts.
fn messages(lost: [usize; 3]) -> Vec<String> {
    let kinds = [
        "triangles with an index out of range: left out",
        "corners with a texture coordinate index out of range: set to (0, 0)",
        "corners with a normal index out of range: normals computed",
    ];
    let lost = lost.iter().zip(kinds).filter(|(count, _)| **count > 0);
    lost.map(|(count, kind)| format!("{count} {kind}")).collect()
}

/// The smoothing group of a line; group 0 is none.
fn smoothing(rest: &[u8]) -> Smoothing {
    match words(rest).next().map(<[u8]>::to_ascii_lowercase).as_deref() {
        None | Some(b"off" | b"0" | b"null") => Smoothing::Flat,
        Some(word) => {
            let number = str::from_utf8(word).ok().and_then(|word| word.parse().ok());
            Smoothing::Group(number.unwrap_or(1)) // "on"
        }
    }
}

/// Files of a line of libraries: one whose name may have spaces if there is such a file, else several.
fn library_paths(path: &Path, names: &str) -> Vec<PathBuf> {
    let names = names.replace('\\', "/");
    let whole = path.with_file_name(&names);
    if is_file(&whole) || names.is_empty() {
        return vec![whole];
    }
    names.split_whitespace().map(|name| path.with_file_name(name)).collect()
}

/// Words up to a comment.
fn words(rest: &[u8]) -> impl Iterator<Item = &[u8]> {
    let words = rest.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
    words.take_while(|word| !word.starts_with(b"#"))
}

/// The rest of a line as a name.
fn name(rest: &[u8]) -> String {
    String::from_utf8_lossy(rest.trim_ascii()).into_owned()
}

/// A word for a message.
fn quote(word: &[u8]) -> String {
    String::from_utf8_lossy(&word[..word.len().min(40)]).into_owned()
}

/// Parses the numbers of a line, whose count is limited.
fn numbers(rest: &[u8], allowed: std::ops::RangeInclusive<usize>) -> Result<([f64; 7], usize), String> {
    let mut values = [0.0; 7];
    let mut count = 0;
    for word in words(rest).take(values.len()) {
        let number = str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        values[count] = number.ok_or_else(|| format!("\"{}\" is not a number", quote(word)))?;
        count += 1;
    }
    if count < *allowed.start() {
        return Err(format!("{count} numbers, but at least {} are needed", allowed.start()));
    }
    Ok((values, count.min(*allowed.end())))
}

/// An index from 0 of one from 1, or of a negative one that counts from the end.
fn index(text: &[u8], count: usize) -> Result<u32, String> {
    let parsed = str::from_utf8(text).ok().and_then(|text| text.parse::<i64>().ok());
    let given = parsed.ok_or_else(|| format!("\"{}\" is not an index", quote(text)))?;
    let from_zero = if given > 0 { given - 1 } else { given.saturating_add(count as i64) };
    let valid = given != 0 && (0..i64::from(BROKEN)).contains(&from_zero);
    Ok(if valid { from_zero as u32 } else { BROKEN })
}

#[cfg(test)]
mod tests {
    use translucid_scene::{Mesh, linear_from_srgb};
    use translucid_testing::mutants;

    use super::*;

    fn parsed_at(path: &Path, text: &str) -> Result<(MeshFile, String)> {
        let mut warnings = Vec::new();
        let scene = parse_obj(text.as_bytes(), path, &mut warnings)?;
        let lines: Vec<_> = warnings.iter().map(ToString::to_string).collect();
        Ok((scene, lines.join("\n")))
    }

    fn parsed(text: &str) -> Result<(MeshFile, String)> {
        parsed_at(Path::new("no/such/folder/a.obj"), text)
    }

    fn mesh(text: &str) -> Mesh {
        let (scene, warnings) = parsed(text).unwrap();
        assert_eq!((scene.objects.len(), warnings.as_str()), (1, ""));
        Mesh::clone(&scene.objects[0].mesh)
    }

    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    #[test]
    fn obj_reads_polygons_and_computes_normals() {
        let mesh = mesh(&format!("# square\n{SQUARE}f 1 2 3 4 # all\n"));
        assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y]);
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(mesh.normals, [Vec3::Z; 4]);
        assert!(mesh.uvs.is_empty() && mesh.colors.is_empty());
    }

    #[test]
    fn obj_reads_negative_indices_continued_lines_and_windows_ends() {
        let expected = mesh(&format!("{SQUARE}f 1 2 3\nf 1 3 4"));
        assert_eq!(mesh(&format!("{SQUARE}f -4 -3 -2\nf 1 -2 -1\n")), expected);
        assert_eq!(mesh(&format!("{SQUARE}f 1 \\\n2 \\\n3\nf 1 3 4\n")), expected);
        assert_eq!(mesh(&format!("{SQUARE}f 1 2 3\nf 1 3 4\n").replace('\n', "\r\n")), expected);
    }

    #[test]
    fn obj_makes_one_vertex_of_each_different_corner() {
        let tables = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\nvn 0 0 3\n";
        let text = format!("{SQUARE}{tables}f 1/1/1 2/2/1 3/3/1\nf 1/1/1 3/3/2 4/4/1\n");
        let mesh = mesh(&text);
        assert_eq!(mesh.positions.len(), 5);
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 3, 4]]);
        assert_eq!(mesh.uvs[4], Vec2::Y);
        assert_eq!(mesh.normals, [Vec3::Z; 5]);
    }

    #[test]
    fn obj_smooths_across_seams_and_parts_where_normals_are_missing() {
        // A roof of two planes, whose ridge has different texture coordinates and materials on its sides.
        let text = "v 0 0 0\nv 0 1 0\nv 2 0 -1\nv -2 0 -1\nvt 0 0\nvt 1 0\no left\nf 1/1 2/1 4/1\n\
            o right\nf 2/2 1/2 3/2\n";
        let (scene, _) = parsed(text).unwrap();
        assert_eq!(scene.objects.len(), 2);
        for part in &scene.objects {
            let ridge = part.mesh.positions.iter().position(|p| *p == Vec3::ZERO).unwrap();
            assert!(part.mesh.normals[ridge].distance(Vec3::Z) < 1e-6, "{}", part.mesh.normals[ridge]);
        }
    }

    /// MeshLab and trimesh write bytes / 255; those behind may be an opacity, and a fourth number is a weight.
    #[test]
    fn obj_reads_vertex_colors_as_srgb() {
        let linear = |rgb: [f32; 3]| Vec3::from(rgb.map(linear_from_srgb));
        let expected = [linear([1.0, 0.5, 0.0]), linear([0.0, 0.25, 0.0]), Vec3::ONE];
        let of_units = mesh("v 0 0 0 1 .5 0\nv 1 0 0 0 .25 0 .125\nv 0 1 0 7\nf 1 2 3\n");
        assert_eq!(of_units.colors, expected);
        assert_eq!(of_units.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
        let (scene, warnings) =
            parsed("v 0 0 0 255 128 0\nv 1 0 0 0 64 0\nv 0 1 0 255 255 255\nf 1 2 3\n").unwrap();
        let colors = &scene.objects[0].mesh.colors;
        assert!(colors.iter().zip(expected).all(|(a, b)| a.distance(b) < 5e-3), "{colors:?}");
        assert!(warnings.contains("vertex colors reach 255, so they are taken for values from 0 to 255"));
        let rounded = mesh("v 0 0 0 1.004 .5 0\nv 1 0 0 0 .25 0\nv 0 1 0 1 1 1\nf 1 2 3\n");
        assert_eq!(rounded.colors, expected);
    }

    /// ZBrush writes 64 colors a line, for each of its tools behind its vertices.
    #[test]
    fn obj_reads_polypaint() {
        let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
        let text = format!(
            "{corners}#MRGB ffff0000ff00ff00\n#MRGB 000000ff\n# End of MRGB block\nf 1 2 3\n\
             {corners}f 4 5 6\n{corners}#MRGB ffff0000ffff0000ffff0000\nf 7 8 9\n"
        );
        let colors: Vec<Vec3> =
            [Vec3::X, Vec3::Y, Vec3::Z].into_iter().chain([Vec3::ONE; 3]).chain([Vec3::X; 3]).collect();
        assert_eq!(mesh(&text).colors, colors);
        assert_eq!(mesh(&format!("{corners}#MRGB block of colors\nf 1 2 3\n")).colors, []);
    }

    #[test]
    fn obj_may_begin_with_a_byte_order_mark() {
        assert_eq!(mesh("\u{feff}v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").positions.len(), 3);
    }

    /// Faces of a cube, with a line before each.
    fn cube(line: impl Fn(usize) -> String) -> String {
        let corner = |i: usize| format!("v {} {} {}\n", i & 1, i >> 1 & 1, i >> 2);
        let faces = [[1, 3, 4, 2], [5, 6, 8, 7], [1, 2, 6, 5], [3, 7, 8, 4], [1, 5, 7, 3], [2, 4, 8, 6]];
        let face =
            |(i, f): (usize, &[usize; 4])| format!("{}f {} {} {} {}\n", line(i), f[0], f[1], f[2], f[3]);
        (0..8).map(corner).chain(faces.iter().enumerate().map(face)).collect()
    }

    #[test]
    fn obj_follows_smoothing_groups_and_has_creases_without() {
        let largest = |text: &str| {
            let mesh = mesh(text);
            let of_corner = |&i: &u32| mesh.normals[i as usize].abs().max_element();
            mesh.triangles.iter().flatten().map(of_corner).fold(1.0, f32::min)
        };
        // Flat normals lie along an axis, smooth ones of a cube along a diagonal
        for flat in ["", "s off\n", "s 0\n", "s\n"] {
            assert!(largest(&format!("{flat}{}", cube(|_| String::new()))) > 0.9999, "{flat}");
        }
        assert!(largest(&cube(|i| format!("s {}\n", i + 1))) > 0.9999);
        for smooth in ["s 1\n", "s on\n"] {
            assert!(
                (largest(&format!("{smooth}{}", cube(|_| String::new()))) - 3f32.sqrt().recip()).abs() < 1e-4
            );
        }
    }

    #[test]
    fn obj_turns_faces_of_a_closed_body_that_wind_the_other_way() {
        let right = cube(|_| String::new());
        let (scene, warnings) = parsed(&right.replace("f 1 2 6 5", "usemtl m\nf 5 6 2 1")).unwrap();
        assert!(warnings.contains("2 triangles of a closed body wound the other way than the rest: turned"));
        for object in &scene.objects {
            for [a, b, c] in object.mesh.triangles.iter().filter_map(|t| object.mesh.corners(t)) {
                assert!((b - a).cross(c - a).dot(a - 0.5) > 0.0);
            }
        }
    }

    #[test]
    fn obj_parts_share_object_and_material() {
        let text = format!(
            "{SQUARE}g ignored later\no a b\nf 1 2 3\nusemtl m\nf 1 3 4\ng x\nf 1 2 4\no c\nf 2 3 4\n"
        );
        let (scene, warnings) = parsed(&text).unwrap();
        let parts: Vec<_> = scene
            .objects
            .iter()
            .map(|part| (part.name.as_str(), part.mesh.triangles.len(), part.material))
            .collect();
        assert_eq!(parts, [("a b", 1, 0), ("a b", 2, 0), ("c", 1, 0)]);
        assert!(warnings.contains("a.obj:8: there is no material \"m\""), "{warnings}");
    }

    /// ZBrush and DAZ write sets of faces as groups; Minecraft's exporters blocks.
    #[test]
    fn obj_groups_of_one_surface_are_one_body() {
        let bodies = |text: &str| -> Vec<u32> {
            parsed(text).unwrap().0.objects.iter().map(|object| object.subsurface_group).collect()
        };
        let cut = |line: &str| cube(|i| if i % 2 == 0 { format!("{line} part{i}\n") } else { String::new() });
        assert_eq!(bodies(&cut("g")), [0; 3]);
        assert_eq!(bodies(&cut("o")), [0, 1, 2]);
        assert_eq!(bodies(&format!("o all\n{}", cut("g"))), [0]);
        // A roof whose planes have corners of their own, at the same places
        let roof = "v 0 0 0\nv 0 1 0\nv 2 0 -1\ng a\nf 2 1 3\nv 0 0 0\nv 0 1 0\nv -2 0 -1\ng b\nf -3 -2 -1\n";
        assert_eq!(bodies(roof), [0, 0]);
        // Two cubes that touch in a face, each closed, and a square apart from another
        let second = cube(|i| if i == 0 { "g second\n".into() } else { String::new() });
        let second: String = second
            .lines()
            .map(|line| match line.split_once(' ') {
                Some(("f", rest)) => {
                    let numbers =
                        rest.split(' ').map(|word| (word.parse::<usize>().unwrap() + 8).to_string());
                    format!("f {}\n", numbers.collect::<Vec<_>>().join(" "))
                }
                Some(("v", rest)) => format!("v {rest} \n").replacen("v 0", "v 2", 1),
                _ => format!("{line}\n"),
            })
            .collect();
        assert_eq!(bodies(&format!("g first\n{}{second}", cube(|_| String::new()))), [0, 1]);
        let apart = "v 5 0 0\nv 6 0 0\nv 6 1 0\ng b\nf 5 6 7\n";
        assert_eq!(bodies(&format!("g a\n{SQUARE}f 1 2 3 4\n{apart}g a\nf 1 2 3\n")), [0, 1]);
        let corner = "v 1 -1 0\nv 2 -1 0\ng b\nf 2 5 6\n";
        assert_eq!(bodies(&format!("g a\n{SQUARE}f 1 2 3 4\n{corner}")), [0, 1], "a corner alone");
    }

    #[test]
    fn obj_repairs_with_a_warning() {
        for (faces, part) in [
            ("f 1 2 3\nf 1 2 9\n", "a.obj:6: 1 triangles with an index out of range"),
            ("f 1 2 3\nf 0 1 2\n", "a.obj:6: 1 triangles with an index out of range"),
            ("f 1 2 3\nf -9 1 2\n", "a.obj:6: 1 triangles with an index out of range"),
            ("f 1 2 3\nf 99999999999999 1 2\n", "a.obj:6: 1 triangles with an index out of range"),
            ("f 1/7 2/7 3/7\n", "a.obj:5: 3 corners with a texture coordinate index"),
            ("f 1//7 2//7 3//7\n", "a.obj:5: 3 corners with a normal index"),
            ("f 1 2 3\nf 1 2\nf 1\n", "fewer than three corners: 2 left out"),
            ("f 1 2 3\nf 1 1 2\n", "1 triangle of zero area"),
            ("v nan 0 0\nf 1 2 3\nf 1 2 5\n", "1 triangle with a vertex that is NaN"),
            ("v 1e99 0 0\nf 1 2 3\nf 1 2 5\n", "1 triangle with a vertex that is NaN"),
            ("vn 0 0 0\nf 1//1 2//1 3//1\n", "3 normals without a direction"),
            (
                "mtllib gone.mtl\nf 1 2 3\n",
                "a.obj:5: material library no/such/folder/gone.mtl: cannot be read",
            ),
            ("f 1 2 3\no dot\nf 1 1 1\n", "part \"dot\" is left out"),
        ] {
            let (scene, warnings) = parsed(&format!("{SQUARE}{faces}")).unwrap();
            assert!(warnings.contains(part), "{warnings}: {part}");
            assert_eq!(scene.objects.len(), 1);
            assert_eq!(scene.objects[0].mesh.triangles, [[0, 1, 2]]);
            assert_eq!(scene.objects[0].mesh.normals, [Vec3::Z; 3]);
        }
    }

    #[test]
    fn obj_that_is_broken_is_refused_with_its_place() {
        for (text, part) in [
            ("", "has no faces"),
            ("glTF\u{2}\u{0}", "has no faces"),
            (SQUARE, "has no faces"),
            ("v 1 2\n", "a.obj:1: 2 numbers, but at least 3 are needed"),
            ("v 1 2 3\nv 1 2 z\n", "a.obj:2: \"z\" is not a number"),
            ("\nvn 1 0\n", "a.obj:2: 2 numbers"),
            ("vt\n", "a.obj:1: 0 numbers, but at least 1"),
            ("vt x\n", "a.obj:1: \"x\" is not a number"),
            ("f 1 2 three\n", "a.obj:1: \"three\" is not an index"),
            ("f 1/2/3/4 1 1\n", "a.obj:1: \"1/2/3/4\" is not a corner"),
            ("f /1 /2 /3\n", "a.obj:1: \"/1\" is not a corner"),
            ("f 1.5 2 3\n", "a.obj:1: \"1.5\" is not an index"),
            ("f 1 2 3\n", "a.obj:1: no face can be used: 1 triangles with an index out of range"),
            ("v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n", "no face can be used: none of the mesh's 1 triangles"),
            ("f 1\n", "has no faces"),
        ] {
            let message = parsed(text).unwrap_err().to_string();
            assert!(
                message.starts_with("no/such/folder/a.obj") && message.contains(part),
                "{message}: {part}"
            );
        }
    }

    #[test]
    fn obj_survives_any_mutation() {
        let text = format!(
            "mtllib a.mtl\n{SQUARE}vt 0 0\nvt 1 1\nvn 0 0 1\no one\nusemtl m\nf 1/1/1 2/2/1 3/1/1\nf -4 -2 -1\n\
             g two\nv 1 2 3 .1 .2 .3\nf 1//1 2//1 3//1 5//1 4//1\n"
        );
        for mutant in mutants(text.as_bytes(), 5_000) {
            if let Ok(scene) = parse_obj(&mutant, Path::new("no/such/a.obj"), &mut Vec::new()) {
                for Object { mesh, .. } in &scene.objects {
                    assert!(mesh.positions.iter().chain(&mesh.normals).all(|v| v.is_finite()));
                    assert!(mesh.triangles.iter().flatten().all(|&i| (i as usize) < mesh.positions.len()));
                }
            }
        }
    }
}
