//! A scene knows the files that it was read from.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use tempfile::TempDir;
use translucid_load::{LoadOptions, Piece, SceneBuilder, SceneFile, load_scene};
use translucid_scene::{Scene, Unit};

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\n";

/// A scene file, and all that it needs: a scene that it extends, a mesh with a library, images and tables.
fn write_scene(folder: &Path, name: &str) -> (PathBuf, BTreeSet<PathBuf>) {
    let file = |ending: &str| folder.join(format!("{name}{ending}"));
    let ppm = [&b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n"[..], &[128, 128, 128, 129]].concat();
    for (ending, content) in [
        (".obj", format!("mtllib {name}.mtl\n{TRIANGLE}usemtl m\nf 1/1 2/1 3/1\n").into_bytes()),
        (".mtl", format!("newmtl m\nmap_Kd {name}.hdr\n").into_bytes()),
        (".hdr", ppm.clone()),
        ("-sky.hdr", ppm),
        (".csv", b"r,reflectance\n0.1,5\n1,1\n2,0.4\n4,0.05\n".to_vec()),
        (
            ".mtlx",
            b"<materialx version=\"1.39\"><open_pbr_surface name=\"s\" type=\"surfaceshader\"/></materialx>"
                .to_vec(),
        ),
        (
            "-base.toml",
            format!(
                "unit = 'mm'\n[[material]]\nname = 'p'\nsubsurface_table = '{name}.csv'\n\
                 [[material]]\nname = 'x'\nfile = '{name}.mtlx'\n[[object]]\nfile = '{name}.obj'\n"
            )
            .into_bytes(),
        ),
        (
            ".toml",
            format!("extends = '{name}-base.toml'\n[environment]\nfile = '{name}-sky.hdr'\n").into_bytes(),
        ),
    ] {
        fs::write(file(ending), content).unwrap();
    }
    let endings = [".obj", ".mtl", ".hdr", "-sky.hdr", ".csv", ".mtlx", "-base.toml", ".toml"];
    (file(".toml"), endings.into_iter().map(file).collect())
}

fn load(path: &Path) -> Scene {
    load_scene(path, &LoadOptions::default(), &mut Vec::new()).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn scene_knows_every_file_that_it_needs() {
    let folder = TempDir::new().unwrap();
    let (path, expected) = write_scene(folder.path(), "a");
    assert_eq!(load(&path).files, expected);
    assert_eq!(
        load(&folder.path().join("a.obj")).files,
        ["a.hdr", "a.mtl", "a.obj"].map(|name| folder.path().join(name)).into()
    );
}

#[test]
fn scene_of_text_and_pieces_knows_what_these_name() {
    let folder = TempDir::new().unwrap();
    write_scene(folder.path(), "a");
    let mesh = folder.path().join("a.obj");
    let text = "unit = 'mm'\n[[object]]\nfile = 'a.obj'\n";
    let file = SceneFile::parse(text, &folder.path().join("no-file.toml")).unwrap();
    let of_mesh: BTreeSet<PathBuf> = ["a.hdr", "a.mtl", "a.obj"].map(|name| folder.path().join(name)).into();
    assert_eq!(file.load(&LoadOptions::default(), &mut Vec::new()).unwrap().files, of_mesh);
    let mut builder = SceneBuilder::new(Unit::Millimeter);
    let piece = Piece::parse("object a", &format!("file = '{}'", mesh.display())).unwrap();
    builder.add_object(&piece, &mut Vec::new()).unwrap();
    assert_eq!(builder.build(&LoadOptions::default()).unwrap().files, of_mesh);
}

/// Threads that load at the same time, again and again.
#[test]
fn scenes_of_two_threads_never_mix_their_files() {
    let folder = TempDir::new().unwrap();
    std::thread::scope(|scope| {
        for name in ["a", "b"] {
            let (path, expected) = write_scene(folder.path(), name);
            scope.spawn(move || (0..100).for_each(|_| assert_eq!(load(&path).files, expected)));
        }
    });
}
