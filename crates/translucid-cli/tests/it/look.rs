//! `translucid render` of a mesh of one's own: its unit, which way is up, cameras, surroundings, exposure.

use std::fs;
use std::path::{Path, PathBuf};

use crate::common::{BALL, exr_values, files, run, stderr, stdout};

/// A pyramid on the plane y = 0.
const PYRAMID: &str =
    "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv 0 3 0\nf 1 2 3\nf 1 3 4\nf 2 1 5\nf 3 2 5\nf 4 3 5\nf 1 4 5\n";

/// Options that make a picture in a moment.
const QUICK: &str = "--size 24x16 --spp 2 --threads 2";

/// A fresh directory with the mesh in it, in units of so many to its own.
fn directory_with_pyramid(scale: f32) -> (tempfile::TempDir, PathBuf) {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().to_owned();
    let scaled = |word: &str| word.parse::<f32>().map_or(word.into(), |x| (x * scale).to_string());
    let line = |line: &str| match line.strip_prefix("v ") {
        Some(numbers) => format!("v {}\n", numbers.split(' ').map(scaled).collect::<Vec<_>>().join(" ")),
        None => format!("{line}\n"),
    };
    fs::write(path.join("a.obj"), PYRAMID.lines().map(line).collect::<String>()).unwrap();
    (directory, path)
}

/// The picture that a command makes as FILE.png, its size and whether it has an alpha channel.
fn picture(directory: &Path, words: &str) -> (Vec<u8>, png::OutputInfo) {
    stdout(directory, &format!("render {words} -q -o picture.png"));
    decode(&directory.join("picture.png"))
}

fn decode(path: &Path) -> (Vec<u8>, png::OutputInfo) {
    let mut reader =
        png::Decoder::new(std::io::BufReader::new(fs::File::open(path).unwrap())).read_info().unwrap();
    let mut codes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut codes).unwrap();
    (codes, info)
}

#[test]
fn a_mesh_in_the_wrong_unit_is_doubted_before_it_is_rendered() {
    let (_keep, directory) = directory_with_pyramid(0.1 / 3.0);
    let output = run(&directory, &format!("render a.obj {QUICK} -o a.png"));
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let question =
        "the mesh is 0.1 mm across, smaller than its mean free path of 0.456 mm: is it in meters? --unit m";
    assert!(stderr(&output).contains(question), "{}", stderr(&output));
    let answer = stderr(&run(&directory, &format!("render a.obj --unit m {QUICK} -o a.png")));
    assert!(!answer.contains("across"), "{answer}");
}

#[test]
fn a_mesh_is_turned_and_seen_from_any_side() {
    let (_keep, directory) = directory_with_pyramid(10.0);
    let plain = picture(&directory, &format!("a.obj {QUICK}"));
    for option in
        ["--up z", "--up -x", "--rotate 30", "--rotate -90,0,15", "--view left", "--view -40,30", "--zoom 2"]
    {
        assert_ne!(picture(&directory, &format!("a.obj {QUICK} {option}")).0, plain.0, "{option}");
    }
    assert_eq!(picture(&directory, &format!("a.obj {QUICK} --up y --rotate 0 --zoom 1")).0, plain.0);
    assert_eq!(plain.1.color_type, png::ColorType::Rgb);
    let (codes, info) = picture(&directory, &format!("a.obj {QUICK} --floor none"));
    assert_eq!(info.color_type, png::ColorType::Rgba, "nothing is around it");
    assert_eq!(codes[..4], [0; 4]);
    let blue = picture(&directory, &format!("a.obj {QUICK} --floor #0000ff --exposure 0")).0;
    assert!(blue[2] > 2 * blue[0].max(blue[1]), "{:?}", &blue[..3]);
}

#[test]
fn options_for_a_mesh_are_refused_where_there_is_none() {
    let (_keep, directory) = directory_with_pyramid(10.0);
    fs::write(directory.join("ball.toml"), BALL).unwrap();
    for (words, named) in [
        ("ball.toml --up z", "an upward axis is for a bare mesh, but ball.toml is a scene file"),
        ("ball.toml --rotate 9", "rotate of an [[object]]"),
        ("ball.toml --floor none", "a floor is for a bare mesh"),
        ("--up z", "--up needs a mesh"),
        ("a.obj --floor shadows", "a floor is none, backdrop, shadow, #rrggbb or a grey in [0, 1]"),
        ("a.obj --view up", "front, back, left, right, top, bottom"),
        ("a.obj --zoom 0", "a zoom is a number in [0.01, 1000]"),
        ("a.obj --camera front", "there is no camera \"front\""),
        ("a.obj --camera front --view left", "cannot be used with"),
        ("a.obj --environment absent.hdr", "absent.hdr"),
        ("a.obj --turntable 1", "2..=3600"),
        ("a.obj --turntable 3 --stats s.json", "--stats is for one picture"),
        ("a.obj --exposure bright", "stops in [-32, 32], or auto"),
        ("a.obj --tone-mapping aces", "the curves are srgb, neutral, agx"),
    ] {
        let output = run(&directory, &format!("render {words} {QUICK} -o no.png"));
        assert_eq!(output.status.code(), Some(2), "{words}");
        assert!(stderr(&output).contains(named), "{words}: {}", stderr(&output));
    }
    assert_eq!(files(&directory), ["a.obj", "ball.toml"]);
}

#[test]
fn page_takes_the_options_of_a_picture_and_refuses_as_it_does() {
    let (_keep, directory) = directory_with_pyramid(10.0);
    fs::write(directory.join("ball.toml"), BALL).unwrap();
    for (words, named) in [
        ("a.obj --up w", "the axes are x, y, z, -x, -y and -z"),
        ("ball.toml --up z", "an upward axis is for a bare mesh, but ball.toml is a scene file"),
        ("--rotate 9", "--rotate needs a mesh"),
        ("a.obj --turntable 9", "unexpected argument '--turntable'"),
        ("a.obj --camera front --floor backdrop", "--floor is for the automatic camera here"),
        ("a.obj --exposure bright", "stops in [-32, 32], or auto"),
    ] {
        let output = run(&directory, &format!("view {words} --no-open"));
        assert_eq!(output.status.code(), Some(2), "{words}");
        assert!(stderr(&output).contains(named), "{words}: {}", stderr(&output));
    }
}

#[test]
fn a_camera_of_several_is_chosen_by_its_name() {
    let (_keep, directory) = directory_with_pyramid(10.0);
    let cameras = "[[camera]]\nname = \"front\"\nposition = [0, 0, 5]\ntarget = [0, 0, 0]\n\
                   [[camera]]\nname = \"near\"\nposition = [0, 0, 3]\ntarget = [0, 0, 0]\n";
    fs::write(directory.join("ball.toml"), format!("{BALL}{cameras}")).unwrap();
    let [first, front, near] = ["", "--camera front", "--camera near"]
        .map(|option| picture(&directory, &format!("ball.toml {option}")).0);
    assert_eq!(first, front);
    assert_ne!(first, near);
    fs::write(directory.join("extending.toml"), "extends = \"ball.toml\"\n[film]\nexposure = 0\n").unwrap();
    assert_eq!(picture(&directory, "extending.toml --camera near").0, near, "of the base");
    let output = run(&directory, "render ball.toml --camera nera -o no.png");
    assert_eq!(output.status.code(), Some(2));
    let message = stderr(&output);
    assert!(message.contains("did you mean \"near\"? The cameras are front, near"), "{message}");
}

#[test]
fn a_turntable_writes_numbered_pictures_of_one_exposure() {
    let (_keep, directory) = directory_with_pyramid(10.0);
    let output = run(&directory, &format!("render a.obj --turntable 3 {QUICK} -o turn.png"));
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(files(&directory), ["a.obj", "turn-001.png", "turn-002.png", "turn-003.png"]);
    let said = stderr(&output);
    let exposures: Vec<&str> =
        said.split("exposed by ").skip(1).map(|rest| rest.lines().next().unwrap()).collect();
    assert!(exposures.len() == 3 && exposures.iter().all(|stops| *stops == exposures[0]), "{said}");
    let [first, second, third] =
        ["turn-001.png", "turn-002.png", "turn-003.png"].map(|name| decode(&directory.join(name)).0);
    assert!(first != second && second != third && first != third);
    fs::write(directory.join("ball.toml"), BALL).unwrap();
    stdout(&directory, "render ball.toml -q --turntable 2 --spp 1 -o ball.exr");
    assert!(files(&directory).contains(&String::from("ball-002.exr")));
}

/// What is metered can be stated, and a scene's own exposure stays what it is.
#[test]
fn a_mesh_is_metered_and_a_scene_is_not() {
    let (_keep, directory) = directory_with_pyramid(10.0);
    let output = run(&directory, &format!("render a.obj {QUICK} -o metered.png"));
    let said = stderr(&output);
    let stops = said.split("exposed by ").nth(1).and_then(|rest| rest.split(' ').next()).expect(&said);
    let stated = picture(&directory, &format!("a.obj {QUICK} --exposure {stops}")).0;
    assert_eq!(decode(&directory.join("metered.png")).0, stated);
    let dark = picture(&directory, &format!("a.obj {QUICK} --exposure -9")).0;
    assert!(dark.iter().max() < stated.iter().max());
    let agx = picture(&directory, &format!("a.obj {QUICK} --exposure {stops} --tone-mapping agx")).0;
    assert_ne!(agx, stated);
    fs::write(directory.join("ball.toml"), BALL).unwrap();
    let [plain, zero, auto] = ["", "--exposure 0", "--exposure auto"]
        .map(|option| picture(&directory, &format!("ball.toml {option}")).0);
    assert_eq!(plain, zero);
    assert_ne!(plain, auto);
}

#[test]
fn an_environment_lights_a_mesh_in_place_of_lamps() {
    let (_keep, directory) = directory_with_pyramid(10.0);
    // Red above, black below.
    let sky: Vec<u8> =
        [b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 1\n".as_slice(), &[128, 0, 0, 129, 0, 0, 0, 0]]
            .concat();
    fs::write(directory.join("sky.hdr"), sky).unwrap();
    let words = format!("a.obj {QUICK} --exposure 0 --environment sky.hdr");
    let bright = |codes: &[u8]| codes.chunks(3).map(|pixel| u32::from(pixel[0])).sum::<u32>();
    let (codes, info) = picture(&directory, &words);
    assert_eq!(info.color_type, png::ColorType::Rgb);
    assert!(codes.chunks(3).all(|pixel| pixel[0] >= pixel[1]) && bright(&codes) > 0);
    let dim = picture(&directory, &format!("{words} --environment-strength 0.1")).0;
    assert!(bright(&dim) < bright(&codes));
    let output = run(&directory, &format!("render a.obj {QUICK} --environment sky.hdr -o sky.hdr.png"));
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}

/// A lamp of 40 cd at 0.35 m gave a white picture when candela were taken for watts per steradian.
#[test]
fn lamps_of_a_gltf_file_are_photometric_and_metered() {
    let directory = tempfile::tempdir().unwrap();
    let positions: [f32; 12] = [-0.1, 0.0, -0.1, 0.1, 0.0, -0.1, 0.0, 0.0, 0.15, 0.0, 0.2, 0.0];
    let indices: [u32; 12] = [0, 1, 2, 1, 0, 3, 2, 1, 3, 0, 2, 3];
    let mut bytes: Vec<u8> = positions.iter().flat_map(|x| x.to_le_bytes()).collect();
    bytes.extend(indices.iter().flat_map(|i| i.to_le_bytes()));
    fs::write(directory.path().join("a.bin"), bytes).unwrap();
    let file = serde_json::json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "uri": "a.bin", "byteLength": 96 }],
        "bufferViews": [{ "buffer": 0, "byteLength": 48 }, { "buffer": 0, "byteOffset": 48, "byteLength": 48 }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4 },
            { "bufferView": 1, "componentType": 5125, "type": "SCALAR", "count": 12 }
        ],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": { "KHR_lights_punctual": { "lights": [{ "type": "point", "intensity": 40 }] } },
        "nodes": [
            { "mesh": 0 },
            { "translation": [0.1, 0.1, 0.35], "extensions": { "KHR_lights_punctual": { "light": 0 } } }
        ]
    });
    fs::write(directory.path().join("a.gltf"), file.to_string()).unwrap();
    let output = run(directory.path(), "render a.gltf --view front --size 32x32 --spp 16 -o a.png");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains("photometric: 683 cd or lx"), "{}", stderr(&output));
    let (codes, _) = decode(&directory.path().join("a.png"));
    let lit: Vec<u8> = codes.chunks(4).filter(|pixel| pixel[3] > 127).map(|pixel| pixel[1]).collect();
    let white = lit.iter().filter(|code| **code > 250).count();
    let gray = lit.iter().filter(|code| (40..=250).contains(*code)).count();
    assert!(white * 5 < lit.len() && gray * 2 > lit.len(), "{white} white, {gray} gray of {}", lit.len());
}

#[test]
fn help_has_a_heading_for_a_mesh_and_one_for_the_picture() {
    let directory = tempfile::tempdir().unwrap();
    let help = stdout(directory.path(), "render --help");
    let position = |text: &str| help.find(text).unwrap_or_else(|| panic!("{text} is missing"));
    let [mesh, picture] = ["Bare mesh and view:", "Picture:"].map(position);
    for option in ["--unit", "--preset", "--up", "--view", "--turntable", "--environment-strength"] {
        assert!((mesh..picture).contains(&position(&format!("{option} <"))), "{option}");
    }
    assert!(position("--exposure <") > picture && position("--denoise") < mesh);
}

#[test]
fn floor_of_shadows_shows_nothing_but_shadows() {
    let (_keep, directory) = directory_with_pyramid(1.0);
    let values = |floor: &str, channel: &str| -> Vec<f32> {
        stdout(
            &directory,
            &format!("render a.obj -q --unit cm --floor {floor} --size 48x48 --spp 8 -o a.exr"),
        );
        let values = exr_values(&directory.join("a.exr"));
        let (_, bits) = values.into_iter().find(|(name, _)| name == channel).unwrap();
        bits.into_iter().map(f32::from_bits).collect()
    };
    let sum = |values: &[f32]| values.iter().map(|value| f64::from(*value)).sum::<f64>();
    let [alone, shadow] = ["none", "shadow"].map(|floor| values(floor, "A"));
    let [alone_depth, depth] = ["none", "shadow"].map(|floor| values(floor, "depth.Z"));
    // What is covered besides the mesh is shadow, and most of the picture is neither
    assert!(
        sum(&shadow) > 1.05 * sum(&alone) && sum(&shadow) < 0.8 * 48.0 * 48.0,
        "{} {}",
        sum(&shadow),
        sum(&alone)
    );
    assert_eq!(depth.iter().filter(|z| **z > 0.0).count(), alone_depth.iter().filter(|z| **z > 0.0).count());
}
