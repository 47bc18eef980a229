//! `translucid reference --layers`: files of plane layers, their totals and profiles.

use crate::common::{run, stderr, stdout};
use translucid_reference::Incidence;
use translucid_reference::layers::{Ground, Layer, Layers};

const PAINT: &str = "\
[[layer]]
thickness = 0.1
scattering = 20
absorption = 0.5

[[layer]]
thickness = 0.5
scattering = 2.0
absorption = 0.5
";

fn paint(g: f64) -> Layers {
    let layers = vec![Layer::new(20.0, 0.5, 0.1).with_g(g), Layer::new(2.0, 0.5, 0.5)];
    Layers::new(1.0, layers, Ground::AIR).unwrap()
}

fn directory_with(text: &str) -> tempfile::TempDir {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("layers.toml"), text).unwrap();
    directory
}

#[test]
fn totals_are_those_of_the_library() {
    let directory = directory_with(&PAINT.replacen("absorption", "g = 0.5\nabsorption", 1));
    let oblique = Incidence::Pencil { cos_theta: 60f64.to_radians().cos() };
    for (options, incidence) in [
        ("", Incidence::NORMAL),
        ("--configuration diffuse", Incidence::Cosine),
        ("--incidence-angle 60", oblique),
    ] {
        let csv = stdout(directory.path(), &format!("reference --layers layers.toml {options}"));
        let rows: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
        assert_eq!(rows[0], ["part", "value", "error"]);
        let value =
            |part: &str| -> f64 { rows.iter().find(|row| row[0] == part).unwrap()[1].parse().unwrap() };
        let totals = paint(0.5).totals(incidence).unwrap();
        assert_eq!(value("diffuse_reflectance"), totals.diffuse_reflectance);
        assert_eq!(value("collimated_transmittance"), totals.collimated_transmittance);
        assert_eq!(value("absorbed_by_layer_2"), totals.absorbed[1]);
        let sum: f64 = rows.iter().skip(1).map(|row| row[1].parse::<f64>().unwrap()).sum();
        assert!((sum - 1.0).abs() < 1e-9, "{csv}");
    }
}

#[test]
fn profile_is_that_of_the_library() {
    let directory = directory_with(PAINT);
    let csv = stdout(directory.path(), "reference --layers layers.toml --at 0.1");
    let row: Vec<f64> = csv.lines().nth(1).unwrap().split(',').map(|word| word.parse().unwrap()).collect();
    let profile = paint(0.0).profile().unwrap();
    let [reflectance, transmittance] = [profile.reflectance(0.1), profile.transmittance(0.1)];
    let expected = [0.1, reflectance.value, reflectance.error, transmittance.value, transmittance.error];
    assert_eq!(row, expected);
}

/// A fault of the file or the command, with what its message must have.
#[test]
fn faults_are_named() {
    let layer = "[[layer]]\nscattering = 1\nabsorption = 0.1\n";
    for (text, options, expected) in [
        ("", "", "a file of layers needs the key layer"),
        ("[[layer]]\nthicknes = 1\n", "", "layer[0] has no key thicknes"),
        ("[[layr]]\nthickness = 1\n", "", "a file of layers has no key layr"),
        (
            "[[layer]]\nthickness = 1\n",
            "",
            "layer[0] needs scattering and absorption, or surface_albedo and mfp",
        ),
        (&format!("{layer}g = 0.5\nmoments = [0.5]\n"), "", "layer[0].g and layer[0].moments are given"),
        (
            &format!("{layer}phase_function = \"rayleigh\"\nmoments = [0.5]\n"),
            "",
            "layer[0].moments and layer[0].phase_function are given",
        ),
        (&format!("{layer}phase_function = \"mie\"\n"), "", "moments:X1,X2"),
        (&format!("{layer}phase_function = \"none.csv\"\n"), "", "none.csv"),
        (&format!("{layer}moments = [0.3334]\n"), "--method monte-carlo", "at every angle, for a walk"),
        ("[[layer]]\nsurface_albedo = 0.5\nmfp = 1\nmoments = [0.5]\n", "", "give scattering and absorption"),
        (
            &format!("{layer}{layer}"),
            "",
            "layer[0]: thickness is inf, but must be finite in all layers but the last",
        ),
        (&format!("{layer}[below]\neta = 1\n"), "", "thickness is inf, but must be finite above a ground"),
        (&format!("{layer}thickness = 1\n[below]\n"), "", "below needs eta, or reflectance"),
        (layer, "--method monte-carlo --at 1", "prints totals"),
        (layer, "--method monte-carlo --photons 0..9", "is a range"),
        (layer, "--method monte-carlo --photons 0", "photons is 0"),
        (layer, "--method monte-carlo --error 0.1", "--error is not for these layers"),
        (layer, "--eta 1.4", "cannot be used with '--eta"),
        (layer, "--photons 1e6", "--photons"),
        (layer, "--configuration diffuse --at 1", "profiles of layers are those of a searchlight"),
        (&format!("{layer}g = 0.95\n"), "--at 1", "layer 1: moment 32 of the phase function is 0.19"),
        (layer, "-o layers.toml", "a file that is read"),
        (layer, "-o -", "stands for no file here"),
        (layer, "--absorption 1", "--absorption is for --method monte-carlo"),
        (
            layer,
            "--method monte-carlo --absorption 1,2",
            "--absorption is 1,2, but must be 1 numbers with commas",
        ),
        (layer, "--method monte-carlo --absorption x", "--absorption is x, but must be 1 numbers"),
        (layer, "--method monte-carlo --absorption -1", "absorption is -1, but must be in [0, 1e30]"),
        (layer, "--tolerance 0.5", "tolerance is 0.5, but must be in [1e-12, 0.1]"),
        (layer, "--tolerance nan --at 1", "tolerance is nan, but must be in [1e-12, 0.1]"),
        (layer, "--method monte-carlo --tolerance 0.1", "--tolerance belongs to the exact solution"),
        ("[[layer]\n", "", "this is not valid TOML"),
    ] {
        let directory = directory_with(text);
        let output = run(directory.path(), &format!("reference --layers layers.toml {options}"));
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{text} {options}: {message}");
        assert!(message.contains(expected), "{text} {options}: {message}");
    }
}

/// A looser tolerance is near, and what is not known is said.
#[test]
fn tolerance_and_what_is_not_known_are_said() {
    let directory = directory_with(&PAINT.replacen("absorption", "g = 0.5\nabsorption", 1));
    let run = |options: &str| run(directory.path(), &format!("reference --layers layers.toml {options}"));
    let output = run("--at 0.1,1000 --tolerance 0.01");
    let (message, text) = (stderr(&output), String::from_utf8_lossy(&output.stdout).into_owned());
    assert!(message.contains("at 1 of 2 radii an error is as large as its value"), "{message}");
    let row: Vec<f64> = text.lines().nth(1).unwrap().split(',').map(|word| word.parse().unwrap()).collect();
    let exact = paint(0.5).profile().unwrap().reflectance(0.1).value;
    assert!((row[1] / exact - 1.0).abs() < 0.01 && (row[1] - exact).abs() < row[2], "{row:?} {exact}");
    assert_eq!(stderr(&run("--at 0.1 --tolerance 0.01")), "");
}

/// |z| < 5 of 4 figures, in Student's distribution: false-alarm rate 2e-5.
#[test]
fn walk_prints_the_totals_too() {
    let directory = directory_with(&PAINT.replacen("absorption", "g = 0.5\nabsorption", 1));
    let options = "--configuration diffuse --method monte-carlo --photons 1e5 --seed 2";
    let csv = stdout(directory.path(), &format!("reference --layers layers.toml {options}"));
    let totals = paint(0.5).totals(Incidence::Cosine).unwrap();
    for (part, expected) in [
        ("reflectance", totals.specular_reflectance + totals.diffuse_reflectance),
        ("transmittance", totals.collimated_transmittance + totals.diffuse_transmittance),
        ("absorbed_by_layer_1", totals.absorbed[0]),
        ("absorbed_by_layer_2", totals.absorbed[1]),
    ] {
        let row: Vec<&str> =
            csv.lines().map(|line| line.split(',').collect::<Vec<_>>()).find(|row| row[0] == part).unwrap();
        let [value, error] = [row[1], row[2]].map(|word| word.parse::<f64>().unwrap());
        assert!((value - expected).abs() < 5.0 * error, "{part}: {value} ± {error}, expected {expected}");
    }
}

/// |z| < 5 of 8 figures: false-alarm rate 4e-5.
#[test]
fn one_walk_serves_several_absorptions() {
    let directory = directory_with(PAINT);
    let sets = [[0.5, 0.5], [4.0, 0.0]];
    let options = "--method monte-carlo --photons 1e5 --seed 5 --absorption 0.5,0.5 --absorption 4,0";
    let csv = stdout(directory.path(), &format!("reference --layers layers.toml {options}"));
    let rows: Vec<[&str; 4]> = csv
        .lines()
        .skip(1)
        .map(|line| {
            let (set, rest) = line[1..].split_once("\",").unwrap();
            let rest: Vec<&str> = rest.split(',').collect();
            [set, rest[0], rest[1], rest[2]]
        })
        .collect();
    assert!(csv.starts_with("absorption,part,value,error\n"), "{csv}");
    for ([first, second], name) in sets.into_iter().zip(["0.5,0.5", "4,0"]) {
        let mut layers = paint(0.0).layers().to_vec();
        (layers[0].absorption, layers[1].absorption) = (first, second);
        let totals = Layers::new(1.0, layers, Ground::AIR).unwrap().totals(Incidence::NORMAL).unwrap();
        for (part, expected) in [
            ("reflectance", totals.specular_reflectance + totals.diffuse_reflectance),
            ("transmittance", totals.collimated_transmittance + totals.diffuse_transmittance),
            ("absorbed_by_layer_1", totals.absorbed[0]),
            ("absorbed_by_layer_2", totals.absorbed[1]),
        ] {
            let row = rows.iter().find(|row| row[0] == name && row[1] == part).unwrap();
            let [value, error] = [row[2], row[3]].map(|word| word.parse::<f64>().unwrap());
            assert!((value - expected).abs() <= 5.0 * error, "{name} {part}: {value} ± {error}, {expected}");
        }
    }
}
