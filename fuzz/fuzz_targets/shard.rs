//! A shard or checkpoint with changed bytes; its checksums are not compared while fuzzing.
#![no_main]

use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use translucid_fuzz::edited;
use translucid_load::SceneFile;
use translucid_render::{CheckpointPlan, Plan, PreparedScene, Session, ShardMerge, ShardReader, View};

const SCENE: &str = r#"
unit = "mm"

[film]
size = [6, 5]

[camera]
position = [0, 0, 5]
target = [0, 0, 0]

[[light]]
type = "distant"
direction = [0, 0, -1]
irradiance = 1

[[material]]
name = "wax"

[[object]]
shape = "sphere"
material = "wax"
"#;

/// A shard of a small picture.
static SHARD: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let scene = SceneFile::parse(SCENE, Path::new("scene.toml")).unwrap();
    let scene = scene.load(&Default::default(), &mut Vec::new()).unwrap();
    let view = View::new(scene.camera, scene.film, 1).unwrap();
    let checkpoint = CheckpointPlan { path: place("whole"), interval: Duration::ZERO };
    let plan = Plan { checkpoint: Some(checkpoint), ..Plan::samples(2) };
    let mut session = Session::new(PreparedScene::new(scene).unwrap(), view);
    session.run(&plan, &|_| (), &AtomicBool::new(false)).unwrap();
    std::fs::read(place("whole")).unwrap()
});

fn place(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("translucid-fuzz-{}-{name}", std::process::id()))
}

libfuzzer_sys::fuzz_target!(|edits: &[u8]| {
    let path = place("input");
    std::fs::write(&path, edited(&SHARD, edits)).unwrap();
    let _ = ShardReader::open(&path).and_then(ShardReader::film);
    let merge = ShardMerge::new(&[path.clone()], 1 << 28);
    let _ = merge.and_then(|mut merge| merge.add(&path));
});
