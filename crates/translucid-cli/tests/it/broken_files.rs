//! Broken inputs through the command: each ends with exit code 2, a message that names the place, and no
//! output file.

use std::path::Path;
use std::process::Command;

/// A file that cannot be used, and what its message has to say beside the file's name.
struct Broken {
    file: &'static str,
    content: Vec<u8>,
    says: &'static [&'static str],
}

fn text(file: &'static str, content: &str, says: &'static [&'static str]) -> Broken {
    Broken { file, content: content.as_bytes().to_vec(), says }
}

fn bytes(file: &'static str, content: &[u8], says: &'static [&'static str]) -> Broken {
    Broken { file, content: content.to_vec(), says }
}

/// A valid scene but for one part, which `change` replaces.
fn scene(old: &str, new: &str, says: &'static [&'static str]) -> Broken {
    let valid = "unit = \"mm\"\n\n[camera]\nposition = [0, 0, 9]\ntarget = [0, 0, 0]\nfov = 40\n\n\
        [film]\nsize = [8, 8]\n\n[integrator]\nsamples_per_pixel = 1\n\n\
        [[material]]\nname = \"wax\"\nsubsurface_weight = 1\nsubsurface_color = [0.9, 0.8, 0.7]\nsubsurface_radius = 1.0\n\n\
        [[object]]\nshape = \"sphere\"\nradius = 1\nmaterial = \"wax\"\n\n\
        [[light]]\ntype = \"sphere\"\ncenter = [5, 5, 5]\nradius = 1\nradiance = [9, 9, 9]\n";
    assert!(valid.contains(old), "{old}");
    text("scene.toml", &valid.replace(old, new), says)
}

fn scene_files() -> Vec<Broken> {
    vec![
        scene("unit = \"mm\"", "unit = \"inch\"", &["scene.toml:1", "inch", "mm"]),
        scene("unit = \"mm\"\n", "", &["scene.toml", "unit"]),
        scene("fov = 40", "fov = 400", &["scene.toml:6", "fov", "400", "180"]),
        scene("fov = 40", "fow = 40", &["scene.toml:6", "fow", "fov"]),
        scene("fov = 40", "fov = \"wide\"", &["scene.toml:6", "fov"]),
        scene("fov = 40", "fov = nan", &["scene.toml:6", "fov"]),
        scene("fov = 40", "fov = ", &["scene.toml:6"]),
        scene("fov = 40", "fov = 40\nfov = 41", &["scene.toml:7", "fov"]),
        scene("position = [0, 0, 9]", "position = [0, 9]", &["scene.toml:4", "position"]),
        scene("position = [0, 0, 9]", "position = [0, 0, 0]", &["scene.toml", "position", "target"]),
        scene("position = [0, 0, 9]", "position = [0, 0, 1e300]", &["scene.toml:4", "position"]),
        scene("[camera]", "[kamera]", &["scene.toml:3", "kamera", "camera"]),
        scene("size = [8, 8]", "size = [0, 8]", &["scene.toml:9", "size"]),
        scene("size = [8, 8]", "size = [99999999, 8]", &["scene.toml:9", "size", "16384"]),
        scene("size = [8, 8]", "size = [8, 8]\nfilter = \"bocks\"", &["scene.toml:10", "bocks", "box"]),
        scene("samples_per_pixel = 1", "samples_per_pixel = 0", &["scene.toml:12", "samples_per_pixel"]),
        scene("samples_per_pixel = 1", "samples_per_pixel = 1.5", &["scene.toml:12", "samples_per_pixel"]),
        scene("samples_per_pixel = 1", "subsurface_tail = 0.5", &["scene.toml:12", "subsurface_tail", "0.1"]),
        scene("[0.9, 0.8, 0.7]", "[1.2, 0.8, 0.7]", &["scene.toml:17", "subsurface_color", "1.2"]),
        scene("[0.9, 0.8, 0.7]", "[0.9, 0.8]", &["scene.toml:17", "subsurface_color"]),
        scene("[0.9, 0.8, 0.7]", "\"#12345\"", &["scene.toml:17", "#12345"]),
        scene("[0.9, 0.8, 0.7]", "{ file = \"gone.png\" }", &["gone.png"]),
        scene(
            "subsurface_radius = 1.0",
            "subsurface_radius = -1.0",
            &["scene.toml:18", "subsurface_radius", "-1"],
        ),
        scene("subsurface_radius = 1.0", "subsurface_radios = 1.0", &["scene.toml:18", "subsurface_radius"]),
        scene("subsurface_radius = 1.0", "subsurface_model = \"dipol\"", &["scene.toml:18", "dipol"]),
        scene("subsurface_radius = 1.0", "preset = \"marbel\"", &["scene.toml:18", "marbel", "marble"]),
        scene("material = \"wax\"", "material = \"wacks\"", &["scene.toml:23", "wacks", "wax"]),
        scene("shape = \"sphere\"", "shape = \"spere\"", &["scene.toml:21", "spere", "sphere"]),
        scene("shape = \"sphere\"\nradius = 1\n", "file = \"gone.ply\"\n", &["gone.ply"]),
        scene("shape = \"sphere\"\nradius = 1\n", "", &["scene.toml:20"]),
        scene(
            "shape = \"sphere\"\nradius = 1",
            "shape = \"sphere\"\nradius = -1",
            &["scene.toml:22", "radius"],
        ),
        scene("radius = 1\nmaterial", "radius = 1\nscale = [1, 0, 1]\nmaterial", &["scene.toml:23", "scale"]),
        scene("type = \"sphere\"", "type = \"sun\"", &["scene.toml:26", "sun"]),
        scene("radiance = [9, 9, 9]", "radiance = [9, -9, 9]", &["scene.toml:29", "radiance"]),
        scene("[[light]]", "[[lamp]]", &["scene.toml:25", "lamp", "light"]),
        text("empty.toml", "", &["empty.toml"]),
        bytes("latin.toml", b"unit = \"mm\" # \xe9\n", &["latin.toml"]),
    ]
}

const PLY_HEAD: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
    property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";

fn ply(old: &str, new: &str, body: &str, says: &'static [&'static str]) -> Broken {
    assert!(PLY_HEAD.contains(old), "{old}");
    text("mesh.ply", &(PLY_HEAD.replace(old, new) + body), says)
}

fn ply_files() -> Vec<Broken> {
    let good = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    vec![
        text("mesh.ply", "", &["mesh.ply"]),
        text("mesh.ply", "plx\n", &["mesh.ply", "ply"]),
        ply("format ascii 1.0", "format ascii 2.0", good, &["mesh.ply:2"]),
        ply("vertex 3", "vertex 4000000000", good, &["mesh.ply"]),
        ply("vertex 3", "vertex many", good, &["mesh.ply:3", "many"]),
        ply("float y", "flaot y", good, &["mesh.ply:5", "flaot"]),
        ply("property float z\n", "", good, &["mesh.ply"]),
        ply("end_header\n", "", "", &["mesh.ply", "end_header"]),
        ply("ply", "ply", "0 0 0\n1 0 0\n", &["mesh.ply"]),
        ply("ply", "ply", "0 0 0\n1 0 zero\n0 1 0\n3 0 1 2\n", &["mesh.ply:11", "zero"]),
        ply("ply", "ply", "0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n", &["mesh.ply"]),
        ply("ply", "ply", "0 0 0\n1 0 0\n0 1 0\n3 0 1 9\n", &["mesh.ply"]),
        ply("ply", "ply", "0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n", &["mesh.ply"]),
        ply("face 1", "face 0", "0 0 0\n1 0 0\n0 1 0\n", &["mesh.ply"]),
        ply("format ascii 1.0", "format binary_little_endian 1.0", "\0\0\0", &["mesh.ply"]),
    ]
}

fn obj_files() -> Vec<Broken> {
    vec![
        text("mesh.obj", "", &["mesh.obj"]),
        text("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1\nf 1 2 3\n", &["mesh.obj:3"]),
        text("mesh.obj", "v 0 0 0\nv 1 0 x\nv 0 1 0\nf 1 2 3\n", &["mesh.obj:2"]),
        text("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n", &["mesh.obj:4", "out of range"]),
        text("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n", &["mesh.obj:4"]),
        text("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n", &["mesh.obj"]),
        text("mesh.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", &["mesh.obj"]),
    ]
}

fn gltf(json: &str, says: &'static [&'static str]) -> Broken {
    text("model.gltf", json, says)
}

fn gltf_files() -> Vec<Broken> {
    let asset = r#""asset":{"version":"2.0"}"#;
    let with = |rest: &str| format!("{{{asset},{rest}}}");
    let mesh = r#""meshes":[{"name":"thing","primitives":[{"attributes":{"POSITION":0}}]}]"#;
    vec![
        gltf("", &["model.gltf"]),
        gltf("{\"asset\":\n{\"version\": }}", &["model.gltf, line 2"]),
        gltf("{}", &["model.gltf", "asset"]),
        gltf(r#"{"asset":{"version":"1.0"}}"#, &["model.gltf", "1.0"]),
        gltf(&with(r#""nodes":[]"#), &["model.gltf"]),
        gltf(&with(r#""scenes":[{"nodes":[5]}],"nodes":[{}]"#), &["model.gltf", "5"]),
        gltf(
            &with(r#""scenes":[{"nodes":[0]}],"nodes":[{"children":[1]},{"children":[0]}]"#),
            &["model.gltf", "node"],
        ),
        gltf(
            &with(&format!(r#""scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],{mesh}"#)),
            &["model.gltf", "accessor"],
        ),
        gltf(
            &with(&format!(
                r#""scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],{mesh},"accessors":[{{"bufferView":0,"componentType":5126,"count":4000000000,"type":"VEC3"}}],"bufferViews":[{{"buffer":0,"byteLength":36}}],"buffers":[{{"byteLength":36,"uri":"gone.bin"}}]"#
            )),
            &["model.gltf"],
        ),
        gltf(&with(r#""extensionsRequired":["KHR_texture_basisu"]"#), &["model.gltf", "KHR_texture_basisu"]),
        bytes("model.glb", b"glTF\x02\0\0\0", &["model.glb"]),
        bytes("model.glb", b"glTF\x02\0\0\0\xff\xff\xff\xff\x04\0\0\0JSON{}  ", &["model.glb"]),
        bytes("model.glb", b"not a glTF file at all", &["model.glb"]),
    ]
}

/// Images reach a loader through a scene's texture.
fn image_files() -> Vec<Broken> {
    vec![
        bytes("map.png", b"", &["map.png"]),
        bytes("map.png", b"\x89PNG\r\n\x1a\n", &["map.png"]),
        bytes(
            "map.png",
            b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\xff\xff\xff\xff\xff\xff\xff\xff\x08\x06\0\0\0\0\0\0\0",
            &["map.png"],
        ),
        bytes("map.jpg", b"\xff\xd8\xff\xe0\0\x10JFIF\0", &["map.jpg"]),
        bytes("map.exr", b"\x76\x2f\x31\x01\x02\0\0\0", &["map.exr"]),
        bytes("map.hdr", b"#?RADIANCE\n\n-Y 99999999 +X 99999999\n", &["map.hdr"]),
        bytes("map.gif", b"GIF89a", &["map.gif"]),
    ]
}

/// Runs the command on a file and checks exit code, message and that nothing was written.
fn check(folder: &Path, input: &str, broken: &Broken) -> Result<(), String> {
    let output = Command::new(env!("CARGO_BIN_EXE_translucid"))
        .current_dir(folder)
        .args(["render", input, "-o", "out.exr", "--spp", "1", "--size", "8x8"])
        .output()
        .map_err(|error| error.to_string())?;
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    if output.status.code() != Some(2) {
        return Err(format!("exit code {:?} instead of 2: {message}", output.status.code()));
    }
    if let Some(missing) = broken.says.iter().find(|word| !message.contains(*word)) {
        return Err(format!("does not say {missing:?}: {message}"));
    }
    if folder.join("out.exr").exists() || folder.join("out.png").exists() {
        return Err(String::from("wrote a picture"));
    }
    Ok(())
}

#[test]
fn broken_files_end_with_exit_code_2_and_name_the_place() {
    let mut failures = Vec::new();
    let mut count = 0;
    let direct = [scene_files(), ply_files(), obj_files(), gltf_files()].into_iter().flatten();
    let through_scene = image_files().into_iter();
    for (broken, is_image) in direct.map(|b| (b, false)).chain(through_scene.map(|b| (b, true))) {
        let folder = tempfile::tempdir().expect("a folder for the test");
        std::fs::write(folder.path().join(broken.file), &broken.content).expect("a file for the test");
        let mut input = broken.file;
        if is_image {
            let key = format!("{{ file = \"{}\" }}", broken.file);
            let scene = scene("[0.9, 0.8, 0.7]", &key, &[]);
            std::fs::write(folder.path().join("scene.toml"), scene.content).expect("a file for the test");
            input = "scene.toml";
        }
        if let Err(failure) = check(folder.path(), input, &broken) {
            let content = String::from_utf8_lossy(&broken.content).into_owned();
            failures.push(format!("{}: {failure}\n--- content:\n{content}", broken.file));
        }
        count += 1;
    }
    assert!(count >= 60, "{count} files");
    assert!(failures.is_empty(), "{} of {count}:\n\n{}", failures.len(), failures.join("\n\n"));
}
