//! `translucid render`: files, exit codes, resuming, interruption.

use std::fs;
use std::path::Path;

use crate::common::{
    BALL, cpu_seconds, directory_with_ball, exr_values, files, run, signal, start, stderr, stdout, translucid,
};

#[test]
fn render_writes_both_images_named_after_the_scene() {
    let (_keep, directory) = directory_with_ball();
    let output = run(&directory, "render ball.toml");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(files(&directory), ["ball.exr", "ball.png", "ball.toml"]);
    assert!(output.stdout.is_empty());
    let summary = stderr(&output);
    for part in ["8 samples per pixel at 40x24", "M samples/s", "wrote ball.exr and ball.png"] {
        assert!(summary.contains(part), "{summary}");
    }
    let channels = exr_values(&directory.join("ball.exr"));
    let red = &channels.iter().find(|(name, _)| name == "R").unwrap().1;
    assert!(red.iter().any(|&bits| f32::from_bits(bits) > 0.01), "the picture is black");
    for (name, values) in channels {
        assert!(values.iter().all(|&bits| f32::from_bits(bits).is_finite()), "{name}");
    }
}

#[test]
fn render_output_option_decides_the_files() {
    let (_keep, directory) = directory_with_ball();
    stdout(&directory, "render ball.toml --spp 1 -q -o one.png");
    assert_eq!(files(&directory), ["ball.toml", "one.png"]);
    stdout(&directory, "render ball.toml --spp 1 -q -o two.exr");
    assert_eq!(files(&directory), ["ball.toml", "one.png", "two.exr", "two.png"]);
}

#[test]
fn render_is_the_same_for_any_number_of_threads() {
    let (_keep, directory) = directory_with_ball();
    stdout(&directory, "render ball.toml -q --threads 1 -o one.exr");
    stdout(&directory, "render ball.toml -q --threads 2 -o two.exr");
    stdout(&directory, "render ball.toml -q --threads 2 --seed 1 -o other.exr");
    let bytes = |name: &str| fs::read(directory.join(name)).unwrap();
    assert_eq!(bytes("one.png"), bytes("two.png"));
    assert_eq!(exr_values(&directory.join("one.exr")), exr_values(&directory.join("two.exr")));
    assert_ne!(bytes("one.png"), bytes("other.png"));
}

/// The region's pixels are those of the whole picture, and the file says where they lie in it.
#[test]
fn render_region_is_a_part_of_the_picture() {
    use exr::prelude::*;

    let (_keep, directory) = directory_with_ball();
    stdout(&directory, "render ball.toml -q --spp 3 -o whole.exr");
    stdout(&directory, "render ball.toml -q --spp 3 --region 7,5,31,20 -o part.exr");
    let image = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer();
    let image = image.all_attributes().from_file(directory.join("part.exr")).unwrap();
    let (layer, display) = (&image.layer_data, image.attributes.display_window);
    assert_eq!((layer.size, layer.attributes.layer_position), (Vec2(24, 15), Vec2(7, 5)));
    assert_eq!((display.position, display.size), (Vec2(0, 0), Vec2(40, 24)));
    let [whole, part] = ["whole.exr", "part.exr"].map(|name| exr_values(&directory.join(name)));
    for ((name, whole), (_, part)) in whole.iter().zip(&part) {
        for (row, values) in part.chunks(24).enumerate() {
            assert_eq!(values, &whole[(row + 5) * 40 + 7..][..24], "{name}");
        }
    }
    for (region, word) in [("0,0,41,24", "41"), ("9,9,9,10", "X0 < X1"), ("1,2,3", "X0,Y0,X1,Y1")] {
        let output = run(&directory, &format!("render ball.toml --region {region} -o no.exr"));
        assert_eq!(output.status.code(), Some(2), "{region}");
        assert!(stderr(&output).contains(word), "{}", stderr(&output));
    }
    assert!(!directory.join("no.exr").exists());
}

#[test]
fn render_resumes_to_the_same_bits() {
    let (_keep, directory) = directory_with_ball();
    stdout(&directory, "render ball.toml -q --spp 9 -o whole.exr");
    stdout(&directory, "render ball.toml -q --spp 4 --resume -o parts.exr");
    assert!(files(&directory).contains(&String::from("parts.exr.checkpoint")));
    let output = run(&directory, "render ball.toml --spp 9 --resume -o parts.exr");
    assert!(stderr(&output).contains("continuing from 4 samples"), "{}", stderr(&output));
    assert_eq!(exr_values(&directory.join("whole.exr")), exr_values(&directory.join("parts.exr")));
    assert_eq!(
        fs::read(directory.join("whole.png")).unwrap(),
        fs::read(directory.join("parts.png")).unwrap()
    );
}

#[test]
fn render_ends_in_time_and_can_be_resumed() {
    let (_keep, directory) = directory_with_ball();
    stdout(&directory, "render ball.toml -q --time 0.3 -o timed.exr");
    assert_eq!(files(&directory), ["ball.toml", "timed.exr", "timed.exr.checkpoint", "timed.png"]);
    stdout(&directory, "render ball.toml -q --spp 1 --resume -o timed.exr");
}

#[test]
fn render_cut_off_in_the_middle_resumes_to_the_same_bits() {
    let (_keep, directory) = directory_with_ball();
    let settings = "render ball.toml -q --size 96x64 --spp 24";
    stdout(&directory, &format!("{settings} --threads 2 -o whole.exr"));
    // Times that end between tiles: some have more samples than others.
    stdout(&directory, &format!("{settings} --threads 1 --time 0.1 --resume -o parts.exr"));
    stdout(&directory, &format!("{settings} --threads 2 --time 0.1 --resume -o parts.exr"));
    stdout(&directory, &format!("{settings} --threads 2 --resume -o parts.exr"));
    assert_eq!(exr_values(&directory.join("whole.exr")), exr_values(&directory.join("parts.exr")));
}

#[test]
fn render_with_checkpoints_without_end_comes_to_the_same_bits() {
    let (_keep, directory) = directory_with_ball();
    stdout(&directory, "render ball.toml -q -o whole.exr");
    stdout(&directory, "render ball.toml -q --checkpoint 1e-9 -o parts.exr");
    assert_eq!(exr_values(&directory.join("whole.exr")), exr_values(&directory.join("parts.exr")));
    assert_eq!(files(&directory), ["ball.toml", "parts.exr", "parts.png", "whole.exr", "whole.png"]);
}

#[test]
fn resume_refuses_what_does_not_belong_to_the_scene() {
    let (_keep, directory) = directory_with_ball();
    stdout(&directory, "render ball.toml -q --spp 1 --resume -o a.exr");
    let before = fs::read(directory.join("a.exr.checkpoint")).unwrap();
    for (words, named) in [
        ("render ball.toml -q --spp 2 --resume --seed 5 -o a.exr", "another scene or other settings"),
        ("render ball.toml -q --spp 2 --resume --size 30x20 -o a.exr", "another scene or other settings"),
    ] {
        let output = run(&directory, words);
        assert_eq!(output.status.code(), Some(2), "{words}");
        assert!(stderr(&output).contains(named) && stderr(&output).contains("a.exr.checkpoint"));
    }
    assert_eq!(fs::read(directory.join("a.exr.checkpoint")).unwrap(), before);
    fs::write(directory.join("a.exr.checkpoint"), &before[..before.len() / 2]).unwrap();
    let output = run(&directory, "render ball.toml -q --spp 2 --resume -o a.exr");
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("damaged"), "{}", stderr(&output));
}

#[cfg(target_os = "linux")]
#[test]
fn interrupt_keeps_the_picture_and_the_way_on() {
    let (_keep, directory) = directory_with_ball();
    let child = start(&directory, "render ball.toml --spp 4000000 --threads 1 -v -o long.exr");
    let id = child.id();
    let output = signal(child, "-INT", || cpu_seconds(id) > 0.5);
    assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
    assert!(stderr(&output).contains("--resume"), "{}", stderr(&output));
    assert_eq!(files(&directory), ["ball.toml", "long.exr", "long.exr.checkpoint", "long.png"]);
    assert!(!exr_values(&directory.join("long.exr")).is_empty());
    // The checkpoint is whole: a run with a goal that is already met ends at once.
    let output = run(&directory, "render ball.toml --spp 1 --resume -o long.exr");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}

/// Every wrong command line: exit code 2, no new file, and the message names what is in brackets.
#[test]
fn wrong_options_are_refused_with_a_reason() {
    let (_keep, directory) = directory_with_ball();
    fs::write(directory.join("broken.toml"), BALL.replace("subsurface_color", "subsurface_colour")).unwrap();
    fs::write(directory.join("mesh.ply"), "ply\nformat ascii 1.0\nelement vertex 99999999999\n").unwrap();
    fs::write(directory.join("picture.jpg"), "x").unwrap();
    fs::write(directory.join("protected.png"), "precious").unwrap();
    let mut permissions = fs::metadata(directory.join("protected.png")).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(directory.join("protected.png"), permissions).unwrap();
    let before = files(&directory);
    for (words, named) in [
        ("render missing.toml", "missing.toml"),
        ("render missing.glb", "missing.glb"),
        ("render picture.jpg", "picture.jpg"),
        ("render .", "."),
        ("render mesh.ply", "mesh.ply"),
        ("render broken.toml", "subsurface_color"),
        ("render broken.toml", "broken.toml:"),
        ("render ball.toml -o a.tiff", ".exr, .png or .shard"),
        ("render ball.toml -o nowhere/a.exr", "nowhere"),
        ("render ball.toml -o ball.toml/a.exr", "ball.toml"),
        ("render ball.toml -o protected.png", "write-protected"),
        ("render ball.toml --size 960", "960x540"),
        ("render ball.toml --size 0x10", "[1, 16384]"),
        ("render ball.toml --size 99999x10", "[1, 16384]"),
        ("render ball.toml --spp 0", "--spp"),
        ("render ball.toml --spp 99999999999", "--spp"),
        ("render ball.toml --time 0", "--time"),
        ("render ball.toml --time -3", "--time"),
        ("render ball.toml --time soon", "--time"),
        ("render ball.toml --checkpoint 0", "--checkpoint"),
        ("render ball.toml --checkpoint -1", "--checkpoint"),
        ("render ball.toml --checkpoint nan", "--checkpoint"),
        ("render ball.toml --seed x", "--seed"),
        ("render ball.toml --threads 0", "--threads"),
        ("render ball.toml --subsurface dipol", "dipole"),
        ("render ball.toml --subsurface random-wal", "random-walk"),
        ("render ball.toml --subsurface normalised-diffusion", "normalized-diffusion"),
        ("render ball.toml --preset marble", "preset"),
        ("render ball.toml --unit mm", "unit"),
        ("render ball.toml --unit inch", "mm"),
        ("render ball.toml --mesh nobody=mesh.ply", "nobody"),
        ("render mesh.ply --preset marbel", "marble"),
        ("render --preset marble", "--preset"),
        ("render ball.toml another.toml", "another.toml"),
        ("render ball.toml --resum", "--resume"),
    ] {
        let output = run(&directory, words);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{words}: {message}");
        assert!(message.contains(named), "{words}: {message}");
        assert_eq!(files(&directory), before, "{words}");
    }
    assert_eq!(fs::read(directory.join("protected.png")).unwrap(), b"precious");
}

#[test]
fn error_in_a_scene_shows_its_line() {
    let (_keep, directory) = directory_with_ball();
    fs::write(directory.join("broken.toml"), BALL.replace("subsurface_radius", "subsurface_radios")).unwrap();
    let message = stderr(&run(&directory, "render broken.toml"));
    assert!(message.contains("subsurface_radios = 0.2"), "{message}");
    assert!(message.contains("subsurface_radius"), "{message}");
    assert!(!message.contains('\u{1b}'), "colors are for terminals: {message}");
}

#[test]
fn quiet_says_nothing() {
    let (_keep, directory) = directory_with_ball();
    let output = run(&directory, "render ball.toml -q --spp 1");
    assert_eq!((stderr(&output), output.status.code()), (String::new(), Some(0)));
}

#[test]
fn verbose_says_what_takes_how_long() {
    let (_keep, directory) = directory_with_ball();
    let message = stderr(&run(&directory, "render ball.toml -v --spp 1"));
    assert!(message.contains("loaded") && message.contains("prepared the scene"), "{message}");
}

#[test]
fn verbose_says_which_model_a_material_has() {
    let (_keep, directory) = directory_with_ball();
    for (options, model) in [
        ("", "random-walk, by default"),
        ("--subsurface-method point-based", "normalized-diffusion-oblique, by default"),
        ("--subsurface default", "random-walk, by default"),
        ("--subsurface dipole", "dipole"),
    ] {
        let message = stderr(&run(&directory, &format!("render ball.toml -v --spp 1 {options}")));
        assert!(message.lines().any(|line| line == format!("material stuff: {model}")), "{message}");
    }
}

#[test]
fn verbose_says_how_open_a_translucent_body_is() {
    let (_keep, directory) = directory_with_ball();
    fs::write(directory.join("sheet.obj"), "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n").unwrap();
    let sheet = format!("{BALL}[[object]]\nfile = \"sheet.obj\"\nmaterial = \"stuff\"\n");
    fs::write(directory.join("sheet.toml"), sheet).unwrap();
    let lines = |options: &str| -> Vec<String> {
        let message = stderr(&run(&directory, &format!("render sheet.toml --spp 1 {options}")));
        message.lines().filter(|line| line.contains("one face only")).map(String::from).collect()
    };
    let line = "object sheet: 4 edges have one face only (80.00 % of all)";
    assert!(matches!(&lines("-v")[..], [only] if only.starts_with(line)), "{:?}", lines("-v"));
    assert!(lines("").is_empty() && lines("-v --subsurface dipole").is_empty());
}

#[test]
fn subsurface_option_changes_the_picture() {
    let (_keep, directory) = directory_with_ball();
    stdout(&directory, "render ball.toml -q --spp 2 -o with.png");
    stdout(&directory, "render ball.toml -q --spp 2 --subsurface none -o without.png");
    let bytes = |name: &str| fs::read(directory.join(name)).unwrap();
    assert_ne!(bytes("with.png"), bytes("without.png"));
}

#[test]
fn scene_that_extends_a_mesh_is_the_picture_of_the_mesh_with_its_options() {
    let (_keep, directory) = directory_with_ball();
    fs::write(
        directory.join("a.obj"),
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
    )
    .unwrap();
    let look = "extends = \"a.obj\"\npreset = \"jade\"\nunit = \"cm\"\n[film]\nsize = [48, 32]\n";
    fs::write(directory.join("look.toml"), look).unwrap();
    stdout(&directory, "render a.obj --preset jade --unit cm --size 48x32 --spp 2 -q -o mesh.exr");
    stdout(&directory, "render look.toml --spp 2 -q -o look.exr");
    assert!(exr_values(&directory.join("mesh.exr")) == exr_values(&directory.join("look.exr")));
    let output = run(&directory, "render look.toml --preset jade");
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("it is the key preset at the top"), "{}", stderr(&output));
}

#[test]
fn preset_list_is_a_table() {
    let table = stdout(Path::new("."), "render --preset list");
    for name in ["marble", "skin1", "wholemilk"] {
        assert!(table.lines().any(|line| line.starts_with(name)), "{table}");
    }
}

/// A picture that the scene reads: the image stays as it is, whatever name leads to it.
#[test]
fn render_never_writes_over_its_inputs() {
    let (_keep, directory) = directory_with_ball();
    stdout(&directory, "render ball.toml -q --spp 1 -o bark.png");
    let scene =
        BALL.replace("subsurface_color = [0.8, 0.5, 0.3]", "subsurface_color = { file = \"bark.png\" }");
    fs::write(directory.join("bark.toml"), &scene).unwrap();
    let gltf = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":0}]}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
                     {"bufferView":0,"componentType":5126,"count":3,"type":"VEC2"}],
        "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"uri":"bark.bin","byteLength":36}],
        "textures":[{"source":0}],"images":[{"uri":"bark.png"}],
        "materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}]}"#;
    fs::write(directory.join("bark.gltf"), gltf).unwrap();
    let corners: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let bytes: Vec<u8> = corners.iter().flat_map(|x| x.to_le_bytes()).collect();
    fs::write(directory.join("bark.bin"), bytes).unwrap();
    let triangle = "mtllib bark.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";
    fs::write(directory.join("bark.obj"), triangle).unwrap();
    fs::write(directory.join("bark.mtl"), "newmtl a\nmap_Kd bark.png\n").unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink(directory.join("bark.png"), directory.join("link.png")).unwrap();
    fs::write(directory.join("look.toml"), "extends = \"bark.gltf\"\n").unwrap();
    let before = fs::read(directory.join("bark.png")).unwrap();
    let files_before = files(&directory);
    for words in [
        "render bark.toml --spp 2",
        "render bark.toml --spp 2 -o bark.exr",
        "render bark.toml --spp 2 -o ./bark.png",
        "render bark.gltf --spp 2 --size 8x8",
        "render bark.obj --spp 2 --size 8x8",
        "render look.toml --spp 2 --size 8x8 -o bark.exr",
        #[cfg(unix)]
        "render bark.toml --spp 2 -o link.png",
    ] {
        let output = run(&directory, words);
        assert_eq!(output.status.code(), Some(2), "{words}: {}", stderr(&output));
        assert!(stderr(&output).contains("overwritten"), "{words}: {}", stderr(&output));
        assert_eq!(fs::read(directory.join("bark.png")).unwrap(), before, "{words}");
        assert_eq!(files(&directory), files_before, "{words}");
    }
    stdout(&directory, "render bark.toml -q --spp 1 -o other.png");

    // A table of profiles, whatever its name
    let table = "r,reflectance\n0.1,5\n1,1\n2,0.4\n4,0.05\n";
    fs::write(directory.join("table.png"), table).unwrap();
    let colored = "subsurface_color = [0.8, 0.5, 0.3]";
    let scene = BALL.replace(colored, &format!("{colored}\nsubsurface_table = \"table.png\""));
    fs::write(directory.join("measured.toml"), scene).unwrap();
    let output = run(&directory, "render measured.toml --spp 2 -o table.exr");
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("overwritten"), "{}", stderr(&output));
    assert_eq!(fs::read_to_string(directory.join("table.png")).unwrap(), table);
}

#[test]
fn empty_picture_replaces_nothing() {
    let (_keep, directory) = directory_with_ball();
    stdout(&directory, "render ball.toml -q --spp 1 -o a.png");
    let before = fs::read(directory.join("a.png")).unwrap();
    let output = run(&directory, "render ball.toml --time 0.000000001 -o a.png");
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(stderr(&output).contains("nothing was written"), "{}", stderr(&output));
    assert_eq!(fs::read(directory.join("a.png")).unwrap(), before);
    assert_eq!(files(&directory), ["a.png", "ball.toml"]);
}

#[test]
fn default_names_replace_own_pictures_only() {
    let (_keep, directory) = directory_with_ball();
    stdout(&directory, "render ball.toml -q --spp 1");
    stdout(&directory, "render ball.toml -q --spp 1");
    fs::write(directory.join("ball.png"), "a texture, say").unwrap();
    let output = run(&directory, "render ball.toml -q --spp 1");
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("-o FILE") && stderr(&output).contains("ball.png"));
    assert_eq!(fs::read(directory.join("ball.png")).unwrap(), b"a texture, say");
    stdout(&directory, "render ball.toml -q --spp 1 -o ball.png");
}

#[test]
fn output_names_that_cannot_be_are_refused_before_the_work() {
    let (_keep, directory) = directory_with_ball();
    let long = "x".repeat(300);
    for output in [format!("{long}.png"), String::from("ball.exr/"), String::from("/dev/stdout.png")] {
        let output = run(&directory, &format!("render ball.toml -o {output}"));
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        assert_eq!(files(&directory), ["ball.toml"]);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn names_that_are_not_unicode_are_kept() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;

    let (_keep, directory) = directory_with_ball();
    let path = |end: &str| directory.join(OsStr::from_bytes(&[b"b\xff", end.as_bytes()].concat()));
    fs::write(path(".toml"), BALL).unwrap();
    let output =
        translucid(&directory).args(["render", "-q", "--spp", "1"]).arg(path(".toml")).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(path(".exr").exists() && path(".png").exists());
}

#[test]
fn render_refuses_to_denoise_without_the_library_before_it_begins() {
    let (_keep, directory) = directory_with_ball();
    for path in ["nowhere/libOpenImageDenoise.so", "ball.toml", "."] {
        let output = translucid(&directory)
            .args(["render", "ball.toml", "--denoise"])
            .env("TRANSLUCID_OIDN", path)
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2), "{path}: {}", stderr(&output));
        let message = stderr(&output);
        assert!(message.contains("set TRANSLUCID_OIDN to the path"), "{message}");
        assert!(message.starts_with(&format!("error: {path}: ")), "{message}");
        assert!(path == "." || message.matches(path).count() == 1, "{message}");
        // A bare name is that of a file here, which the loader has looked into, not one of the system's
        assert!(!message.contains("cannot open shared object"), "{message}");
        assert_eq!(files(&directory), ["ball.toml"], "{path}");
    }
}

/// Where the system has the library, the environment's is not asked.
#[test]
#[cfg(unix)]
fn render_looks_for_the_denoiser_in_the_active_environment() {
    let (_keep, directory) = directory_with_ball();
    let folder = directory.join("env/lib/python3.12/site-packages/pyoidn/oidn/lib");
    fs::create_dir_all(&folder).unwrap();
    let library = folder.join(format!("libOpenImageDenoise{}", std::env::consts::DLL_SUFFIX));
    fs::write(&library, "no library").unwrap();
    let output = translucid(&directory)
        .args(["render", "ball.toml", "-v", "--denoise", "-o", "clean.png"])
        .env_remove("TRANSLUCID_OIDN")
        .env("VIRTUAL_ENV", directory.join("env"))
        .env_remove("CONDA_PREFIX")
        .env("PATH", "")
        .env("HOME", &*directory)
        .output()
        .unwrap();
    let message = stderr(&output);
    if output.status.code() == Some(0) {
        return assert!(message.contains("denoised the picture by Open Image Denoise"), "{message}");
    }
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert_eq!(message.matches(&*library.display().to_string()).count(), 1, "{message}");
    assert!(message.contains("pip install pyoidn"), "{message}");
}

#[test]
fn render_denoises_no_comparison() {
    let (_keep, directory) = directory_with_ball();
    let output = run(&directory, "render ball.toml --subsurface dipole,none --denoise -o both");
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("--denoise is for one model"), "{}", stderr(&output));
    assert_eq!(files(&directory), ["ball.toml"]);
}

/// Runs where the library is: the noisy layers stay what they are.
#[test]
fn render_with_denoise_keeps_every_layer() {
    let (_keep, directory) = directory_with_ball();
    stdout(&directory, "render ball.toml -q -o plain.exr");
    let output = run(&directory, "render ball.toml -v --denoise -o clean.exr");
    if stderr(&output).contains("no library to denoise with") {
        assert_eq!(files(&directory), ["ball.toml", "plain.exr", "plain.png"]);
        return;
    }
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains("denoised the picture by Open Image Denoise"), "{}", stderr(&output));
    let [plain, clean] = ["plain.exr", "clean.exr"].map(|name| exr_values(&directory.join(name)));
    for channel in &plain {
        assert!(clean.contains(channel), "{}", channel.0);
    }
    assert_eq!(clean.len(), plain.len() + 3);
    let [plain, clean] = ["plain.png", "clean.png"].map(|name| fs::read(directory.join(name)).unwrap());
    assert_ne!(plain, clean);
}
