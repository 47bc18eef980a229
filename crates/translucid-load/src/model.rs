//! A mesh file, whatever its format: the reader is chosen by the file's extension.

use std::path::Path;

use glam::{DVec3, Vec3};
use translucid_scene::{
    ColorInput, ColorSpace, ImageKind, Material, Mesh, Object, Place, SceneError, TextureRef, Unit, Warning,
};

use crate::file::{extension, stem};
use crate::gltf::read_gltf;
use crate::image::read_image;
use crate::loading::Loading;
use crate::mesh_file::MeshFile;
use crate::obj::read_obj;
use crate::origin::settle;
use crate::ply::{PlyFile, read_ply};
use crate::result::Result;
use crate::stl::read_stl;

/// The formats of meshes, as messages list them.
pub(crate) const MESHES: &str = ".glb, .gltf, .obj, .ply or .stl";

/// Formats of scenes that other programs write.
const SCENES: [&str; 10] = ["3ds", "abc", "dae", "fbx", "max", "usd", "usda", "usdc", "usdz", "x3d"];

/// Formats of solids and bare faces; some of the programs that write them have no glTF, and Blender reads none of them.
const SOLIDS: [&str; 8] = ["3mf", "amf", "iges", "igs", "msh", "off", "step", "stp"];

/// Returns `true` if the file's extension is that of a mesh format.
pub(crate) fn is_mesh(path: &Path) -> bool {
    matches!(extension(path).as_str(), "glb" | "gltf" | "obj" | "ply" | "stl")
}

pub(crate) fn is_gltf(path: &Path) -> bool {
    matches!(extension(path).as_str(), "gltf" | "glb")
}

/// Loads a mesh file by its extension; its lengths are as the file has them.
pub(crate) fn load_model(path: &Path, loading: &mut Loading<'_>) -> Result<MeshFile> {
    let mut model = read_model(path, loading).map_err(|error| with_hint(error, path, loading))?;
    settle(&mut model);
    Ok(model)
}

/// The error with the format that the file is of, if its name says another.
fn with_hint(error: SceneError, path: &Path, loading: &mut Loading<'_>) -> SceneError {
    let named = extension(path);
    let bytes = if is_mesh(path) { loading.read(path).unwrap_or_default() } else { Vec::new() };
    match format_of(&bytes) {
        Some(format) if format != named && error.help.is_none() => {
            error.with_help(format!("the file begins as a .{format} file does: rename it, if it is one"))
        }
        _ => error,
    }
}

/// The format of a mesh file by its first bytes.
fn format_of(bytes: &[u8]) -> Option<&'static str> {
    let text = bytes.trim_ascii_start();
    let first_word = |line: &[u8]| {
        let line = line.trim_ascii();
        line[..line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len())].to_ascii_lowercase()
    };
    let mut words = text.split(|&byte| byte == b'\n').map(first_word);
    match &words.find(|word| !word.is_empty() && !word.starts_with(b"#"))?[..] {
        b"ply" => Some("ply"),
        b"solid" => Some("stl"),
        b"v" | b"vn" | b"vt" | b"mtllib" | b"o" | b"g" | b"usemtl" => Some("obj"),
        _ if bytes.starts_with(b"glTF") => Some("glb"),
        _ if text.starts_with(b"{") => Some("gltf"),
        _ => None,
    }
}

fn read_model(path: &Path, loading: &mut Loading<'_>) -> Result<MeshFile> {
    if is_gltf(path) {
        return read_gltf(path, Unit::Meter, loading);
    }
    if extension(path) == "obj" {
        return read_obj(path, loading);
    }
    let of_one_object = |(mesh, origin): (Mesh, DVec3)| {
        let object = Object { name: stem(path), mesh: mesh.into(), ..Object::default() };
        MeshFile { origin, objects: vec![object], ..MeshFile::default() }
    };
    if extension(path) == "ply" {
        let PlyFile { mesh, origin, picture } = read_ply(&loading.read(path)?, path, loading.warnings)?;
        let has_coordinates = !mesh.uvs.is_empty();
        let mut model = of_one_object((mesh, origin));
        if let Some(name) = picture.filter(|_| has_coordinates) {
            add_picture(&mut model, &path.with_file_name(name), path, loading);
        }
        return Ok(model);
    }
    if extension(path) == "stl" {
        return read_stl(&loading.read(path)?, path, loading.warnings).map(of_one_object);
    }
    let extension = extension(path);
    let message = match extension.as_str() {
        "" => String::from("a file without extension is neither a scene nor a mesh"),
        other => format!("a .{other} file is neither a scene nor a mesh"),
    };
    let formats = format!("scenes are .toml, meshes are {MESHES}");
    let help = match extension.as_str() {
        "blend" => format!("export glTF (.glb) from Blender, or render there with the extension; {formats}"),
        other if SCENES.contains(&other) => {
            format!("export glTF (.glb) from the program that wrote it, or from Blender; {formats}")
        }
        other if SOLIDS.contains(&other) => {
            format!("export STL or glTF (.glb) from the program that wrote it; {formats}")
        }
        _ => formats,
    };
    Err(SceneError::at(Place::file(path), message).with_help(help))
}

/// Gives a model a material that shows a picture; one that cannot be read is told of.
fn add_picture(model: &mut MeshFile, picture: &Path, path: &Path, loading: &mut Loading<'_>) {
    match read_image(picture, ImageKind::Color(ColorSpace::Srgb), loading) {
        Ok(image) => {
            let base_color =
                ColorInput { texture: Some(TextureRef::new(0)), ..ColorInput::constant(Vec3::ONE) };
            if model.objects.iter().any(|object| !object.mesh.colors.is_empty()) {
                let message = "the colors of vertices and faces are left out beside the picture".into();
                loading.warnings.push(Warning { message, place: Some(Place::file(path)) });
            }
            model.images.push(image);
            model.materials.push(Material { name: stem(path), base_color, ..Material::default() });
        }
        Err(error) => {
            let message = format!("the mesh is used without its picture: {error}");
            loading.warnings.push(Warning { message, place: Some(Place::file(path)) });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meshes_of_a_wrong_extension_are_told_their_format() {
        let folder = tempfile::tempdir().unwrap();
        let help = |name: &str, bytes: &[u8]| {
            let path = folder.path().join(name);
            std::fs::write(&path, bytes).unwrap();
            load_model(&path, &mut Loading::unwatched(&mut Vec::new())).unwrap_err().help.unwrap_or_default()
        };
        let obj = b"# made here\r\n\r\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        let told =
            |format: &str| format!("the file begins as a .{format} file does: rename it, if it is one");
        assert_eq!(help("a.stl", obj), told("obj"));
        assert_eq!(help("a.obj", b"ply\r\nformat ascii 1.0\n"), told("ply"));
        assert_eq!(help("b.obj", b"glTF\x02\0\0\0"), told("glb"));
        assert_eq!(help("c.obj", b"{ \"asset\": {} }"), told("gltf"));
        assert_eq!(help("a.ply", b"Solid a\nfacet normal 0 0 1\n"), told("stl"));
        assert_eq!(help("d.obj", b"v 0 0 0\n"), "");
        assert_eq!(help("a.obj", b"\x89PNG"), "");
    }

    #[test]
    fn formats_that_are_not_read_are_refused_with_those_that_help() {
        for (name, told) in [
            ("a.off", "export STL or glTF (.glb) from the program that wrote it; "),
            ("a.AMF", "export STL or glTF (.glb) from the program that wrote it; "),
            ("a.3mf", "export STL or glTF (.glb) from the program that wrote it; "),
            ("a.fbx", "export glTF (.glb) from the program that wrote it, or from Blender; "),
        ] {
            let error = load_model(Path::new(name), &mut Loading::unwatched(&mut Vec::new())).unwrap_err();
            assert!(error.help.unwrap_or_default().starts_with(told), "{name}");
        }
    }

    /// As MeshLab names it.
    #[test]
    fn ply_shows_the_picture_of_its_comment() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ply");
        let text = "ply\nformat ascii 1.0\ncomment TextureFile a b.png\nelement vertex 3\nproperty float x\n\
            property float y\nproperty float z\nproperty float s\nproperty float t\nelement face 1\n\
            property list uchar int vertex_indices\nend_header\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n";
        std::fs::write(&path, text).unwrap();
        let load = || {
            let mut warnings = Vec::new();
            let model = load_model(&path, &mut Loading::unwatched(&mut warnings)).unwrap();
            (model, warnings.iter().map(ToString::to_string).collect::<String>())
        };
        let (model, warnings) = load();
        assert!(model.materials.is_empty() && warnings.contains("without its picture"), "{warnings}");
        let mut bytes = Vec::new();
        let encoder = png::Encoder::new(&mut bytes, 1, 1);
        encoder.write_header().and_then(|mut writer| writer.write_image_data(&[9])).unwrap();
        std::fs::write(folder.path().join("a b.png"), bytes).unwrap();
        let (model, warnings) = load();
        assert_eq!((model.images.len(), warnings.as_str()), (1, ""));
        assert!(model.materials[0].base_color.texture.is_some());
        let lines = "property float t\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n";
        let colored = text.replace("property float t\n", lines);
        for (color, told) in
            [("255 255 255", ""), ("9 9 9", "vertices and faces are left out beside the picture")]
        {
            let ends = ["0 0 0 0 0\n", "1 0 0 1 0\n", "0 1 0 0 1\n"];
            let text = ends
                .iter()
                .fold(colored.clone(), |text, end| text.replace(end, &format!("{} {color}\n", end.trim())));
            std::fs::write(&path, text).unwrap();
            let (model, warnings) = load();
            assert!(warnings.contains(told) && warnings.is_empty() == told.is_empty(), "{warnings}");
            assert!(!model.materials[0].base_color.vertex_color);
        }
    }
}
