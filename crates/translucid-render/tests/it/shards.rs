//! Parts of a picture in files, joined: the bits of one rendering, or a refusal with its reason.

use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use glam::Vec3;
use translucid_image::PixelRect;
use translucid_render::{
    FilmSums, Goal, LiveFilm, PreparedScene, ShardMerge, ShardNotes, ShardReader, ShardRun, View, save_shard,
};
use translucid_scene::{Scene, SubsurfaceMethod};
use translucid_testing::SplitMix;
use translucid_workbench::{BrokenScene, broken_scenes, scene_of_everything};

use crate::common::{
    GRAY, matte, on_threads, prepare, prepare_with_points, scene, sphere, uniform_environment,
};

const SAMPLES: u32 = 5;
/// Memory for points: some dozens of them.
const POINT_BYTES: u64 = 1 << 14;
/// One of so many scenes that are sound with a value changed.
const SOUND: usize = 11;

/// Renders samples of a view into a file.
fn render_shard(prepared: &PreparedScene, view: &View, samples: Range<u32>, path: &Path) {
    let region = view.region();
    let film = LiveFilm::new(FilmSums::new(region.width, region.height));
    let notes = ShardNotes { samples_per_pixel: SAMPLES, ..ShardNotes::default() };
    prepared.render(view, &film, &Goal { samples, deadline: None }, &|_| {}, &AtomicBool::new(false));
    let place = (region, view.whole_size());
    save_shard(path, &film.sums(), prepared.fingerprint(view), place, notes).expect("room");
}

fn merged(parts: &[PathBuf]) -> Result<ShardMerge, String> {
    let mut merge = ShardMerge::new(parts, u64::MAX).map_err(|error| error.to_string())?;
    parts.iter().try_for_each(|part| merge.add(part)).map_err(|error| error.to_string())?;
    Ok(merge)
}

fn film(path: &Path) -> FilmSums {
    ShardReader::open(path).and_then(ShardReader::film).expect("a whole shard").0
}

/// A rectangle cut into at most four, at random places.
fn cut(rect: PixelRect, random: &mut SplitMix) -> Vec<PixelRect> {
    let (right, bottom) = (rect.left + rect.width, rect.top + rect.height);
    let x = rect.left + random.below(rect.width as usize) as u32;
    let y = rect.top + random.below(rect.height as usize) as u32;
    let spans = |start: u32, at: u32, end: u32| [(start, at - start), (at, end - at)];
    let columns = spans(rect.left, x, right);
    let rows = spans(rect.top, y, bottom);
    let rects = rows
        .into_iter()
        .flat_map(|(top, height)| columns.map(|(left, width)| PixelRect { left, top, width, height }));
    rects.filter(|rect| rect.area() > 0).collect()
}

/// Scenes with a bit of everything and one extreme value, in random parts by one to three threads, joined in random order by a random tree.
#[test]
fn random_parts_of_extreme_scenes_join_to_the_bits_of_one_rendering() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut random = SplitMix(21);
    let whole_scene = scene_of_everything();
    let mut scenes = 0;
    let sound = broken_scenes(&whole_scene)
        .filter(|broken| !broken.place.starts_with("film") && broken.scene.validate().is_ok());
    let methods = [SubsurfaceMethod::RayTraced, SubsurfaceMethod::PointBased];
    for (BrokenScene { place, change, mut scene, .. }, method) in
        sound.step_by(SOUND).zip(methods.into_iter().cycle()).take(24)
    {
        (scene.film.width, scene.film.height) = (41, 29);
        scene.integrator.subsurface_method = method;
        let Ok(prepared) = prepare_with_points(scene, POINT_BYTES) else { continue };
        let view = prepared.view().expect("a valid view");
        let whole = folder.path().join("whole.shard");
        on_threads(1, || render_shard(&prepared, &view, 0..SAMPLES, &whole));
        let mut parts = Vec::new();
        for rect in cut(view.region(), &mut random) {
            let region = [rect.left, rect.top, rect.left + rect.width, rect.top + rect.height];
            let view = view.with_region(region).expect("within the film");
            let middle = 1 + random.below(SAMPLES as usize - 1) as u32;
            for samples in [middle..SAMPLES, 0..middle] {
                let path = folder.path().join(format!("part-{}.shard", parts.len()));
                on_threads(1 + random.below(3), || render_shard(&prepared, &view, samples, &path));
                parts.push(path);
            }
        }
        let mut joined = 0;
        while parts.len() > 1 {
            let count = 2 + random.below(parts.len().min(4) - 1);
            let some: Vec<PathBuf> =
                (0..count).map(|_| parts.swap_remove(random.below(parts.len()))).collect();
            let path = folder.path().join(format!("joined-{joined}.shard"));
            merged(&some).expect("parts of one picture").save(&path).expect("room");
            parts.push(path);
            joined += 1;
        }
        let (whole, joined) = (film(&whole), film(&parts[0]));
        let tile = |film: &FilmSums, x, y| film.mean(x, y).map(f64::to_bits);
        for (x, y) in view.region().pixels() {
            assert_eq!(tile(&whole, x, y), tile(&joined, x, y), "{place} = {change}, pixel {x}, {y}");
        }
        assert!(merged(&[parts.remove(0)]).expect("whole").gaps(SAMPLES).is_empty());
        scenes += 1;
    }
    assert!(scenes >= 12, "only {scenes} scenes");
}

/// A ball under an even sky on a film that is no multiple of tiles.
fn ball() -> Scene {
    let mut scene = scene(vec![sphere(1.0, 6)], matte(GRAY));
    (scene.film.width, scene.film.height) = (50, 36);
    scene.camera.position = Vec3::Z * 4.0;
    scene.environment = uniform_environment(Vec3::ONE);
    scene
}

/// Four samples of the ball in a file.
fn shard_of(scene: Scene, samples: Range<u32>, path: PathBuf) -> PathBuf {
    let prepared = prepare(scene);
    let view = prepared.view().expect("a valid view");
    render_shard(&prepared, &view, samples, &path);
    path
}

#[test]
fn damage_anywhere_is_found_before_anything_is_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = shard_of(ball(), 0..4, folder.path().join("a.shard"));
    let bytes = fs::read(&path).expect("just written");
    let damaged = folder.path().join("b.shard");
    let refused = |bytes: &[u8]| {
        fs::write(&damaged, bytes).expect("room");
        let error = merged(std::slice::from_ref(&damaged)).expect_err("damaged");
        assert!(error.contains("b.shard") && error.contains('(') || error.contains("no shard"), "{error}");
    };
    for length in (0..bytes.len()).step_by(1 + bytes.len() / 200).chain(bytes.len() - 5..bytes.len()) {
        refused(&bytes[..length]);
    }
    refused(&[&bytes[..], b"x"].concat());
    // Damage passes a checksum with probability 2⁻³²; the seed is fixed
    let mut random = SplitMix(5);
    for _ in 0..300 {
        let mut bytes = bytes.clone();
        let bit = random.below(8 * bytes.len());
        bytes[bit / 8] ^= 1 << (bit % 8);
        refused(&bytes);
    }
    let mut older = bytes.clone();
    older[8] = 1;
    fs::write(&damaged, older).expect("room");
    assert!(merged(&[damaged]).expect_err("older").contains("another version"));
}

#[test]
fn others_and_repetitions_are_refused_by_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| folder.path().join(name);
    let first = shard_of(ball(), 0..4, file("first.shard"));
    let beyond = shard_of(ball(), 3..6, file("beyond.shard"));
    let other = |name: &str, change: fn(&mut Scene)| {
        let mut scene = ball();
        change(&mut scene);
        shard_of(scene, 4..6, file(name))
    };
    let seed = other("seed.shard", |scene| scene.integrator.seed = 7);
    let color = other("color.shard", |scene| scene.materials[0].base_weight = 0.25);
    let shape = other("shape.shard", |scene| scene.objects[0].mesh = sphere(1.0, 7).into());
    let size = other("size.shard", |scene| scene.film.width = 51);
    for (parts, words) in [
        (vec![&first, &first], &["first.shard", "samples 0..4"][..]),
        (vec![&first, &beyond], &["first.shard", "beyond.shard", "samples 3..4"]),
        (vec![&first, &seed], &["seed.shard", "seed is 0 in one and 7"]),
        (vec![&first, &color], &["color.shard", "material"]),
        (vec![&first, &shape], &["shape.shard", "object 0"]),
        (vec![&first, &size], &["size.shard", "50x36", "51x36"]),
        (vec![], &["no shards"]),
    ] {
        let error = merged(&parts.into_iter().cloned().collect::<Vec<_>>()).expect_err("refused");
        assert!(words.iter().all(|word| error.contains(word)), "{error}");
    }
    // Where tiles of a film differ, the header does not list all samples
    let prepared = prepare(ball());
    let view = prepared.view().expect("a valid view");
    let mut uneven = film(&first);
    let fuller = film(&shard_of(ball(), 0..5, file("fuller.shard")));
    uneven.tiles[3] = fuller.tiles[3].clone();
    let place = (view.region(), view.whole_size());
    let path = file("uneven.shard");
    save_shard(&path, &uneven, prepared.fingerprint(&view), place, ShardNotes::default()).expect("room");
    let late = shard_of(ball(), 4..6, file("late.shard"));
    let error = merged(&[path, late]).expect_err("sample 4 of a tile is in both");
    assert!(error.contains("samples 4..5") && error.contains("uneven.shard"), "{error}");
}

#[test]
fn gaps_are_said_as_what_to_render() {
    let folder = tempfile::tempdir().expect("a folder");
    let prepared = prepare(ball());
    let view = prepared.view().expect("a valid view");
    let mut parts = Vec::new();
    for (region, samples) in [([0, 0, 50, 20], 0..5), ([0, 20, 30, 36], 0..2), ([0, 20, 30, 36], 3..4)] {
        let path = folder.path().join(format!("{}.shard", parts.len()));
        render_shard(&prepared, &view.with_region(region).expect("inside"), samples, &path);
        parts.push(path);
    }
    let merge = merged(&parts).expect("parts of one picture");
    let mut gaps: Vec<_> = merge.gaps(5).into_iter().map(|gap| (gap.region, gap.samples)).collect();
    gaps.sort_by_key(|(region, samples)| (*region, samples.start));
    let expected = [([0, 20, 30, 36], 2..3), ([0, 20, 30, 36], 4..5), ([30, 20, 50, 36], 0..5)];
    assert_eq!(gaps, expected);
    assert_eq!((merge.film().mean(40, 30), merge.film().samples()), ([0.0; 21], 0));
    for (number, (region, samples)) in gaps.into_iter().enumerate() {
        let path = folder.path().join(format!("gap-{number}.shard"));
        render_shard(&prepared, &view.with_region(region).expect("inside"), samples, &path);
        parts.push(path);
    }
    let whole = shard_of(ball(), 0..5, folder.path().join("whole.shard"));
    let merge = merged(&parts).expect("parts of one picture");
    assert!(merge.gaps(5).is_empty());
    view.region().pixels().for_each(|(x, y)| assert_eq!(merge.film().mean(x, y), film(&whole).mean(x, y)));
}

/// Clocks of machines are wrong, and go back: no result depends on the times in a shard.
#[test]
fn clocks_that_jump_change_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let prepared = prepare(ball());
    let view = prepared.view().expect("a valid view");
    let mut parts = Vec::new();
    for (samples, began) in [(0..2, u64::MAX), (2..3, 0), (3..5, 1 << 40)] {
        let film = film(&shard_of(ball(), samples, folder.path().join("any.shard")));
        let run = ShardRun { began, seconds: 1.5, ..ShardRun::default() };
        let notes = ShardNotes { samples_per_pixel: SAMPLES, runs: vec![run], ..ShardNotes::default() };
        let path = folder.path().join(format!("{began}.shard"));
        let place = (view.region(), view.whole_size());
        save_shard(&path, &film, prepared.fingerprint(&view), place, notes).expect("room");
        parts.push(path);
    }
    let whole = shard_of(ball(), 0..5, folder.path().join("whole.shard"));
    let merge = merged(&parts).expect("parts of one picture");
    assert!(*merge.film() == film(&whole));
    assert_eq!((merge.notes().seconds(), merge.gaps(SAMPLES)), (4.5, Vec::new()));
}

#[test]
fn a_thousand_empty_shards_change_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut parts = vec![shard_of(ball(), 0..3, folder.path().join("first.shard"))];
    let empty = shard_of(ball(), 3..3, folder.path().join("empty.shard"));
    for number in 0..1000 {
        let path = folder.path().join(format!("empty-{number}.shard"));
        fs::hard_link(&empty, &path).expect("the same disk");
        parts.insert(number % 7, path);
    }
    let merge = merged(&parts).expect("parts of one picture");
    let first = film(&folder.path().join("first.shard"));
    assert!(*merge.film() == first);
    let none = merged(
        &parts[parts.len() - 10..]
            .iter()
            .filter(|path| !path.ends_with("first.shard"))
            .cloned()
            .collect::<Vec<_>>(),
    );
    let none = none.expect("empty is no error here");
    assert_eq!((none.film().paths(), none.gaps(3).len()), (0, 1));
}
