//! Wavefront OBJ meshes (Wavefront Technologies, "Advanced Visualizer Manual", appendix B1, 1995).

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use glam::{DVec3, Vec2, Vec3};
use translucid_scene::{Material, Mesh, Object, Place, SceneError, Warning, repair_mesh};

use super::MeshFile;
use super::mtl::{ImagePool, parse_mtl};
use super::polygon::triangulate;
use crate::file::stem;
use crate::loading::Loading;
use crate::origin::Anchor;

/// Loads an OBJ mesh with its material libraries and their images.
///
/// Polygons are cut into triangles.
/// Corners without a normal get the smooth normal of their position, over all parts and texture seams;
/// smoothing groups are passed over, and so are lines, curves and free-form surfaces.
/// Vertex colors (`v x y z r g b`) are linear.
/// A library, material or image that is missing adds a warning.
///
/// # Errors
/// The file cannot be read, a line breaks the format (the message names it), or no triangle is usable.
pub fn load_obj(path: &Path, warnings: &mut Vec<Warning>) -> Result<MeshFile, SceneError> {
    read_obj(path, &mut Loading::unwatched(warnings))
}

/// As [`load_obj`], as a part of a load.
pub(crate) fn read_obj(path: &Path, loading: &mut Loading<'_>) -> Result<MeshFile, SceneError> {
    parse(&loading.read(path)?, path, loading)
}

/// Parses an OBJ file's bytes as [`load_obj`] does; libraries and images are beside `path`.
///
/// # Errors
/// As [`load_obj`].
pub fn parse_obj(bytes: &[u8], path: &Path, warnings: &mut Vec<Warning>) -> Result<MeshFile, SceneError> {
    parse(bytes, path, &mut Loading::unwatched(warnings))
}

fn parse(bytes: &[u8], path: &Path, loading: &mut Loading<'_>) -> Result<MeshFile, SceneError> {
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
    file.into_scene(path, loading)
}

/// No index.
const NONE: u32 = u32::MAX;
/// An index that points nowhere, whatever the file still holds.
const BROKEN: u32 = u32::MAX - 1;

/// A vertex of a face: indices from 0, or [`NONE`], or out of range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Corner {
    position: u32,
    uv: u32,
    normal: u32,
}

/// Faces of one part, as they are read.
#[derive(Debug)]
struct Faces {
    name: String,
    material: Option<String>,
    triangles: Vec<[Corner; 3]>,
}

/// The tables of the file.
#[derive(Debug, Default)]
struct ObjFile {
    positions: Vec<Vec3>,
    /// Where the positions are counted from.
    anchor: Anchor,
    /// As long as `positions` or shorter: the rest is white.
    colors: Vec<Vec3>,
    uvs: Vec<Vec2>,
    normals: Vec<Vec3>,
    faces: Vec<Faces>,
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
                self.uvs.push(Vec2::new(u as f32, v as f32));
                Ok(())
            }
            b"vn" => {
                let ([x, y, z, ..], _) = numbers(rest, 3..=3)?;
                self.normals.push(DVec3::new(x, y, z).as_vec3());
                Ok(())
            }
            b"f" => self.read_face(rest, number),
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
            _ => Ok(()),
        }
    }

    fn begin_object(&mut self, name: String) {
        self.object = name;
        self.current = None;
    }

    /// Position, then perhaps a weight, then perhaps a color.
    fn read_vertex(&mut self, rest: &[u8]) -> Result<(), String> {
        let (v, count) = numbers(rest, 3..=7)?;
        if count >= 6 {
            self.colors.resize(self.positions.len(), Vec3::ONE);
            self.colors.push(DVec3::from_slice(&v[count - 3..]).as_vec3());
        }
        self.positions.push(self.anchor.relative(DVec3::from_slice(&v)));
        Ok(())
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
            let Self { positions, faces, .. } = self;
            let position = |corner: Corner| positions.get(corner.position as usize).copied();
            triangulate(&polygon, position, |triangle| faces[part].triangles.push(triangle));
        }
        self.polygon = polygon;
        Ok(())
    }

    /// Number of the part that faces now go to.
    fn part(&mut self) -> usize {
        *self.current.get_or_insert_with(|| {
            let key = (self.object.clone(), self.material.clone());
            *self.numbers.entry(key).or_insert_with(|| {
                let (name, material) = (self.object.clone(), self.material.clone());
                self.faces.push(Faces { name, material, triangles: Vec::new() });
                self.faces.len() - 1
            })
        })
    }

    /// Parses "position", "position/uv", "position//normal" or "position/uv/normal".
    fn corner(&mut self, word: &[u8], line: usize) -> Result<Corner, String> {
        let counts = [self.positions.len(), self.uvs.len(), self.normals.len()];
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
        Ok(Corner { position, uv, normal })
    }

    fn into_scene(mut self, path: &Path, loading: &mut Loading<'_>) -> Result<MeshFile, SceneError> {
        if self.faces.is_empty() {
            return Err(SceneError::at(Place::file(path), "has no faces: is it an OBJ mesh?"));
        }
        if !self.colors.is_empty() {
            self.colors.resize(self.positions.len(), Vec3::ONE);
        }
        if self.slivers > 0 {
            let message = format!("faces with fewer than three corners: {} left out", self.slivers);
            loading.warnings.push(Warning { message, place: Some(Place::file(path)) });
        }
        let mut pool = ImagePool::default();
        let mut materials = self.load_libraries(path, &mut pool, loading)?;
        let plain = materials.len();
        let origin = self.anchor.position();
        let objects = self.build_objects(path, &materials, loading.warnings)?;
        if plain > 0 && objects.iter().any(|object| object.material == plain) {
            materials.push(Material::default());
        }
        Ok(MeshFile { origin, objects, materials, images: pool.into_images(), ..MeshFile::default() })
    }

    fn load_libraries(
        &self,
        path: &Path,
        pool: &mut ImagePool,
        loading: &mut Loading<'_>,
    ) -> Result<Vec<Material>, SceneError> {
        let mut materials: Vec<Material> = Vec::new();
        for (line, names) in &self.libraries {
            for library in library_paths(path, names) {
                match loading.read(&library) {
                    Ok(bytes) => materials.extend(parse_mtl(&bytes, &library, pool, loading)?),
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
        self,
        path: &Path,
        materials: &[Material],
        warnings: &mut Vec<Warning>,
    ) -> Result<Vec<Object>, SceneError> {
        let smooth = self.smooth_normals();
        let mut builder = Builder::new(&self, &smooth);
        let (mut objects, mut fault) = (Vec::new(), None);
        let mut groups = HashMap::new();
        // The last definition of a name counts.
        let named: HashMap<&str, usize> =
            materials.iter().enumerate().map(|(number, material)| (material.name.as_str(), number)).collect();
        for faces in &self.faces {
            let mut mesh = builder.build(faces);
            match repair_mesh(&mut mesh, &Place::file(path), warnings) {
                Ok(()) => {
                    let name = faces.material.as_deref();
                    let material = name.and_then(|name| named.get(name)).copied().unwrap_or(materials.len());
                    let next = groups.len() as u32; // A file's parts are far fewer than 2³².
                    let subsurface_group = *groups.entry(&faces.name).or_insert(next);
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
        let messages = builder.messages();
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

    /// Smooth normals for each position, if any corner needs them.
    fn smooth_normals(&self) -> Vec<Vec3> {
        let lacking = |corner: &Corner| corner.normal as usize >= self.normals.len();
        let triangles = || self.faces.iter().flat_map(|faces| &faces.triangles);
        if !triangles().flatten().any(lacking) {
            return Vec::new();
        }
        let triangles = triangles().map(|triangle| triangle.map(|corner| corner.position)).collect();
        Mesh { positions: self.positions.clone(), triangles, ..Mesh::default() }.smooth_normals()
    }
}

/// Makes one vertex of each different corner.
struct Builder<'a> {
    file: &'a ObjFile,
    smooth: &'a [Vec3],
    /// For each position the part that last used it, and its newest vertex there.
    newest: Vec<(u32, u32)>,
    part: u32,
    /// For each vertex of the part its corner, and the next older vertex of the same position.
    vertices: Vec<(Corner, u32)>,
    /// Triangles, texture coordinates and normals with an index that points nowhere.
    lost: [usize; 3],
}

impl<'a> Builder<'a> {
    fn new(file: &'a ObjFile, smooth: &'a [Vec3]) -> Self {
        Self {
            file,
            smooth,
            newest: vec![(0, NONE); file.positions.len()],
            part: 0,
            vertices: Vec::new(),
            lost: [0; 3],
        }
    }

    fn build(&mut self, faces: &Faces) -> Mesh {
        self.part += 1;
        self.vertices.clear();
        let mut mesh = Mesh::default();
        mesh.triangles.reserve(faces.triangles.len());
        for triangle in &faces.triangles {
            if triangle.iter().all(|corner| (corner.position as usize) < self.file.positions.len()) {
                let triangle = triangle.map(|corner| self.vertex(corner, &mut mesh));
                mesh.triangles.push(triangle);
            } else {
                self.lost[0] += 1;
            }
        }
        if self.vertices.iter().all(|(corner, _)| corner.uv == NONE) {
            mesh.uvs = Vec::new();
        }
        mesh
    }

    /// The number of a corner's vertex.
    fn vertex(&mut self, corner: Corner, mesh: &mut Mesh) -> u32 {
        let corner = self.checked(corner);
        let (part, newest) = self.newest[corner.position as usize];
        let mut candidate = if part == self.part { newest } else { NONE };
        while let Some(&(other, older)) = self.vertices.get(candidate as usize) {
            if other == corner {
                return candidate;
            }
            candidate = older;
        }
        let number = self.vertices.len() as u32;
        self.vertices.push((corner, if part == self.part { newest } else { NONE }));
        self.newest[corner.position as usize] = (self.part, number);
        self.push(corner, mesh);
        number
    }

    /// The corner without indices that point nowhere.
    fn checked(&mut self, mut corner: Corner) -> Corner {
        if corner.uv != NONE && corner.uv as usize >= self.file.uvs.len() {
            corner.uv = NONE;
            self.lost[1] += 1;
        }
        if corner.normal != NONE && corner.normal as usize >= self.file.normals.len() {
            corner.normal = NONE;
            self.lost[2] += 1;
        }
        corner
    }

    fn push(&self, corner: Corner, mesh: &mut Mesh) {
        let position = corner.position as usize;
        mesh.positions.push(self.file.positions[position]);
        mesh.uvs.push(self.file.uvs.get(corner.uv as usize).copied().unwrap_or_default());
        let smooth = || self.smooth.get(position).copied().unwrap_or(Vec3::Z);
        mesh.normals.push(self.file.normals.get(corner.normal as usize).copied().unwrap_or_else(smooth));
        if let Some(&color) = self.file.colors.get(position) {
            mesh.colors.push(color);
        }
    }

    /// Things left out, of all parts.
    fn messages(&self) -> Vec<String> {
        let kinds = [
            "triangles with an index out of range: left out",
            "corners with a texture coordinate index out of range: set to (0, 0)",
            "corners with a normal index out of range: normals computed",
        ];
        let lost = self.lost.iter().zip(kinds).filter(|(count, _)| **count > 0);
        lost.map(|(count, kind)| format!("{count} {kind}")).collect()
    }
}

/// Files of a line of libraries: one whose name may have spaces if there is such a file, else several.
fn library_paths(path: &Path, names: &str) -> Vec<PathBuf> {
    let names = names.replace('\\', "/");
    let whole = path.with_file_name(&names);
    if whole.is_file() || names.is_empty() {
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
    use translucid_testing::mutants;

    use super::*;

    fn parsed_at(path: &Path, text: &str) -> Result<(MeshFile, String), SceneError> {
        let mut warnings = Vec::new();
        let scene = parse_obj(text.as_bytes(), path, &mut warnings)?;
        let lines: Vec<_> = warnings.iter().map(ToString::to_string).collect();
        Ok((scene, lines.join("\n")))
    }

    fn parsed(text: &str) -> Result<(MeshFile, String), SceneError> {
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
        let text = "v 0 0 0\nv 0 1 0\nv 1 0 -1\nv -1 0 -1\nvt 0 0\nvt 1 0\no left\nf 1/1 2/1 4/1\n\
            o right\nf 2/2 1/2 3/2\n";
        let (scene, _) = parsed(text).unwrap();
        assert_eq!(scene.objects.len(), 2);
        for part in &scene.objects {
            let ridge = part.mesh.positions.iter().position(|p| *p == Vec3::ZERO).unwrap();
            assert!(part.mesh.normals[ridge].distance(Vec3::Z) < 1e-6, "{}", part.mesh.normals[ridge]);
        }
    }

    #[test]
    fn obj_reads_vertex_colors() {
        let mesh = mesh("v 0 0 0 1 .5 0\nv 1 0 0 1 0 .25 0\nv 0 1 0 1\nf 1 2 3\n");
        assert_eq!(mesh.colors, [Vec3::new(1.0, 0.5, 0.0), Vec3::new(0.0, 0.25, 0.0), Vec3::ONE]);
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
