//! `translucid skin`: human skin from its pigments.

use crate::common::{run, stderr, stdout};
use translucid_laboratory::skin::{Skin, SkinParameters, TONES};
use translucid_load::load_image;
use translucid_reference::Incidence;
use translucid_reference::walk::Control;
use translucid_scene::ColorSpace;

fn numbers(csv: &str) -> Vec<Vec<f64>> {
    let number = |word: &str| word.parse().unwrap_or(f64::NAN);
    csv.lines().skip(1).map(|line| line.split(',').map(number).collect()).collect()
}

#[test]
fn what_is_printed_is_the_library_s() {
    let folder = tempfile::tempdir().unwrap();
    let made_of = |tone: usize| SkinParameters {
        melanin: TONES[tone].melanin,
        blood: 0.01,
        ..SkinParameters::default()
    };
    let medium = Skin::new(made_of(1)).unwrap().medium(500, &Control::default()).unwrap().unwrap();
    let printed = numbers(&stdout(folder.path(), "skin --tone II --blood 0.01 --photons 500 --threads 1"));
    for (c, row) in printed.iter().enumerate() {
        let expected =
            [medium.surface_albedo[c], medium.mfp[c], medium.deviation[c], medium.standard_error[c]];
        assert_eq!(row[1..], expected);
        assert!(medium.deviation[c] < 0.06, "{medium:?}");
    }
    let text = stdout(folder.path(), "skin --tone II --blood 0.01 --photons 500 --what material");
    assert!(text.contains("subsurface_model = \"random-walk-diffuse\"\n"), "{text}");
    let longest = medium.mfp[0];
    assert!(
        text.contains(&format!("subsurface_radius = {longest:.4}\nsubsurface_radius_scale = [1.0000, ")),
        "{text}"
    );
    let enclosed =
        numbers(&stdout(folder.path(), "skin --tone II --blood 0.01 --photons 500 --what profile"));
    assert_eq!(enclosed[20][1..], medium.enclosed[20].1);

    let spectrum = numbers(&stdout(folder.path(), "skin --what spectrum --tone IV --blood 0.01 --dermis 1"));
    let thin = Skin::new(SkinParameters { dermis: 1.0, ..made_of(3) }).unwrap();
    let totals = thin.totals(Incidence::Cosine).unwrap();
    assert_eq!(
        (spectrum.len(), spectrum[40][0], spectrum[40][2]),
        (81, 580.0, totals[40].diffuse_reflectance)
    );
    assert!(spectrum.iter().all(|row| (row[1..6].iter().sum::<f64>() - 1.0).abs() < 1e-9));

    let color = numbers(&stdout(folder.path(), "skin --what color --tone IV --configuration searchlight"));
    // International Skin Spectra Archive, inner arms of class tan: L* 57.4, a* 8.2, b* 19.6
    for (row, mean) in color[3..6].iter().zip([57.4, 8.2, 19.6]) {
        assert!((row[1] - mean).abs() < 1.0, "{color:?}");
    }
}

#[test]
fn material_that_is_far_off_is_warned_of() {
    let folder = tempfile::tempdir().unwrap();
    for (skin, expected) in [("--bilirubin 1", true), ("--tone III", false)] {
        let message = stderr(&run(folder.path(), &format!("skin {skin} --photons 500 --what material")));
        assert_eq!(message.contains("no one medium comes near this skin"), expected, "{message}");
    }
}

#[test]
fn skins_that_are_none_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (words, message) in [
        ("--dermis 200", "--dermis is 200, but must be in [0.01, 100] mm, or infinite"),
        ("--photons 99", "--photons is 99, but must be at least 100"),
        ("--blood 1 --bilirubin 1 --carotene 1", "this skin's blue in sRGB is -"),
        ("--configuration searchlight", "--configuration is \"searchlight\", but must be left out"),
        ("--what material --format json", "has no --format json"),
        ("--melanin-texture no.png", "-o DIR"),
        ("--melanin-texture no.png -o out", "no.png"),
        ("--melanin-texture no.png --what color", "--what is \"color\", but must be medium"),
        ("--melanin-texture no.png -o out --format csv", "has no --format"),
    ] {
        let output = run(folder.path(), &format!("skin {words}"));
        assert_eq!(output.status.code(), Some(2), "{words}");
        assert!(stderr(&output).contains(message), "{words}: {}", stderr(&output));
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn textures_are_media_of_their_pixels() {
    let folder = tempfile::tempdir().unwrap();
    let file = std::fs::File::create(folder.path().join("melanin.png")).unwrap();
    let mut encoder = png::Encoder::new(file, 2, 1);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.write_header().unwrap().write_image_data(&[51, 255]).unwrap();
    let words = "skin --melanin 0.1 --blood 0.004 --melanin-texture melanin.png --photons 100 -o textures";
    let output = run(folder.path(), words);
    assert!(output.status.success() && stderr(&output).contains("off by up to 0.00"), "{}", stderr(&output));
    let path = folder.path().join("textures/surface_albedo.exr");
    let albedo = load_image(&path, ColorSpace::Linear, &mut Vec::new()).unwrap();
    for (x, melanin) in [(0, 0.02), (1, 0.1)] {
        let csv = stdout(folder.path(), &format!("skin --melanin {melanin} --blood 0.004 --photons 100"));
        for (c, row) in numbers(&csv).iter().enumerate() {
            assert!((f64::from(albedo.texel(x, 0)[c]) - row[1]).abs() < 1e-6);
        }
    }
    let material = std::fs::read_to_string(folder.path().join("textures/material.toml")).unwrap();
    let scene = format!(
        "unit = \"mm\"\n{material}\n[[object]]\nshape = \"sphere\"\nradius = 10\nmaterial = \"skin\"\n"
    );
    std::fs::write(folder.path().join("textures/scene.toml"), scene).unwrap();
    let output = run(folder.path(), "render textures/scene.toml --size 8x8 --spp 1 -o sphere.exr");
    assert!(output.status.success() && !stderr(&output).contains("warning"), "{}", stderr(&output));
}

#[test]
fn textures_that_do_not_fit_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (name, width) in [("a.png", 2), ("b.png", 1)] {
        let file = std::fs::File::create(folder.path().join(name)).unwrap();
        let mut encoder = png::Encoder::new(file, width, 2 / width);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.write_header().unwrap().write_image_data(&[51, 255]).unwrap();
    }
    let output = run(folder.path(), "skin --melanin-texture a.png --blood-texture b.png -o out");
    assert_eq!(output.status.code(), Some(2));
    let message = stderr(&output);
    assert!(message.contains("has 2 x 1 pixels and blood_texture 1 x 2"), "{message}");
    assert!(!folder.path().join("out").exists());
}
