//! `translucid convert`: rows, units, the way there and back, and what wrong input is told.

use crate::common::{run, stderr, stdout, translucid};

fn here() -> std::path::PathBuf {
    std::env::temp_dir()
}

/// One line of the CSV, whose quoted fields are the last.
#[derive(Clone, Debug, PartialEq)]
struct Row {
    system: String,
    parameter: String,
    channel: String,
    value: f64,
    unit: String,
    equal: String,
}

fn rows(words: &str) -> Vec<Row> {
    let csv = stdout(&here(), &format!("convert {words}"));
    assert_eq!(csv.lines().next(), Some("system,parameter,channel,value,unit,equal,source"));
    let row = |line: &str| {
        let fields: Vec<&str> = line.splitn(7, ',').collect();
        let text = |i: usize| fields[i].to_owned();
        let (kind, _) = fields[6].trim_start_matches('"').split_once(": ").expect("a kind of source");
        assert!(["code", "document", "measured", "computed"].contains(&kind), "{kind}");
        Row {
            system: text(0),
            parameter: text(1),
            channel: text(2),
            value: fields[3].parse().unwrap(),
            unit: text(4),
            equal: text(5),
        }
    };
    csv.lines().skip(1).map(row).collect()
}

/// The value of a system's parameter in a channel.
fn value(rows: &[Row], system: &str, parameter: &str, channel: &str) -> f64 {
    let found: Vec<_> = rows
        .iter()
        .filter(|r| r.system == system && r.parameter == parameter && r.channel == channel)
        .collect();
    assert_eq!(found.len(), 1, "{system} {parameter} {channel}: {found:?}");
    found[0].value
}

fn close(found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < 1e-12, "{found} is not {expected}");
}

/// Runs the command with input that is wrong and returns what it says.
fn refused(words: &str) -> String {
    let output = run(&here(), &format!("convert {words}"));
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{words}: {message}");
    assert!(output.stdout.is_empty() && !message.contains("panicked"), "{words}: {message}");
    message
}

#[test]
fn a_length_of_one_has_the_widths_of_the_published_table() {
    for (from, widths) in [
        ("cycles-burley:subsurface_radius=1", [0.080, 0.080, 0.080]),
        ("eevee:subsurface_radius=1", [0.027, 0.046, 0.077]),
        ("pbrt-v3-disney:scatterdistance=1", [0.200, 0.200, 0.200]),
        ("moonray:radius=1", [0.283, 0.279, 0.042]),
        ("appleseed:mfp=1", [0.316, 0.650, 1.104]),
        ("unreal:MeanFreePathColor=1", [5.27, 10.83, 18.40]),
        ("hdrp:scatteringDistance=1", [1.0, 1.0, 1.0]),
        ("arnold:subsurface_radius=1", [0.338, 0.583, 0.962]),
    ] {
        let found = rows(&format!("--from {from} --surface-albedo 0.2,0.5,1 --to translucid"));
        for (channel, d) in ["r", "g", "b"].into_iter().zip(widths) {
            let in_mm = value(&found, "translucid", "d", channel);
            assert!((in_mm - d).abs() < 0.6e-3 * d.max(1.0), "{from} {channel}: {in_mm}");
        }
    }
}

#[test]
fn renderman_goes_to_every_other_system() {
    // d = 20 · 0.1/(3.5 + 100 (A − 0.33)⁴) at A = 0.5
    let found = rows("--from renderman:dmfp=20 --surface-albedo 0.5");
    let d = 2.0 / 3.583521;
    close(value(&found, "cycles-burley", "subsurface_scale", "all"), 4.0 * std::f64::consts::PI * d);
    close(value(&found, "cycles-burley", "subsurface_radius", "all"), 1.0);
    close(value(&found, "pbrt-v3-disney", "scatterdistance", "all"), 5.0 * d);
    close(value(&found, "appleseed", "mfp", "all"), 1.539 * d);
    close(value(&found, "moonray", "radius", "all"), 2.0);
    close(value(&found, "renderman", "dmfp", "all"), 20.0);
    close(value(&found, "renderman", "unitLength", "all"), 0.1);
    // Unreal's centimeters
    close(value(&found, "unreal-5.0", "MeanFreePathDistance", "all"), 0.2);
    close(value(&found, "unreal", "MeanFreePathDistance", "all"), 0.06 * 1.539 * d);
    close(value(&found, "hdrp", "scatteringDistanceMultiplier", "all"), d);
    close(value(&found, "openpbr", "subsurface_radius", "all"), 1.715 * d);
    close(value(&found, "cycles-walk", "subsurface_scale", "all"), 1.715 * d);
    close(
        value(&found, "cycles-walk-legacy", "subsurface_scale", "all"),
        4.0 * std::f64::consts::PI * 1.715 * d,
    );
    // The other configuration concerns the media only
    let pencil = rows("--from renderman:dmfp=20 --surface-albedo 0.5 --configuration searchlight");
    close(value(&pencil, "openpbr", "subsurface_radius", "all"), 1.539 * d);
    close(value(&pencil, "hdrp", "scatteringDistanceMultiplier", "all"), d);
    assert!(found.iter().any(|r| r.equal == "d") && found.iter().any(|r| r.equal == "mfp"));
}

#[test]
fn colors_and_distances_multiply_to_the_lengths() {
    let words = "--from renderman:dmfp=8 --from renderman:dmfpColor=1,0.4,0.2 --surface-albedo 0.8,0.5,0.4";
    let found = rows(words);
    for (channel, mm) in [("r", 0.8), ("g", 0.32), ("b", 0.16)] {
        close(value(&found, "moonray", "radius", channel), mm);
        let color = value(&found, "renderman", "dmfpColor", channel);
        close(color * value(&found, "renderman", "dmfp", "all") * 0.1, mm);
    }
    let colors = ["r", "g", "b"].map(|channel| value(&found, "unreal", "MeanFreePathColor", channel));
    assert_eq!(colors.iter().copied().fold(0.0, f64::max), 1.0);
    // A distance and a factor may be chosen
    let set =
        "--set unreal:MeanFreePathDistance=0.1 --set renderman:unitLength=1 --to unreal,renderman,moonray";
    let chosen = rows(&format!("{words} {set}"));
    close(value(&chosen, "renderman", "dmfp", "all"), 0.8);
    assert_eq!(value(&chosen, "unreal", "MeanFreePathDistance", "all"), 0.1);
    let product = value(&chosen, "unreal", "MeanFreePathColor", "g") * 0.1;
    close(product, colors[1] * value(&found, "unreal", "MeanFreePathDistance", "all"));
}

#[test]
fn units_are_those_of_the_scenes() {
    let meters = rows("--from arnold:radius=0.002 --surface-albedo 0.5 --unit m --to-unit cm");
    close(value(&meters, "openpbr", "subsurface_radius", "all"), 0.2);
    let unit = |system: &str, parameter: &str| {
        meters.iter().find(|r| r.system == system && r.parameter == parameter).unwrap().unit.clone()
    };
    assert_eq!(unit("openpbr", "subsurface_radius"), "cm");
    assert_eq!(unit("pbrt", "sigma_a"), "1/cm");
    assert_eq!(unit("hdrp", "scatteringDistanceMultiplier"), "mm");
    assert_eq!(unit("renderman", "dmfp"), "unitLength*cm");
    assert_eq!(unit("unreal", "MeanFreePathDistance"), "cm");
    let millimeters = rows("--from arnold:radius=2 --surface-albedo 0.5");
    close(
        value(&meters, "hdrp", "scatteringDistanceMultiplier", "all"),
        value(&millimeters, "hdrp", "scatteringDistanceMultiplier", "all"),
    );
    close(
        value(&meters, "unreal", "MeanFreePathDistance", "all"),
        value(&millimeters, "unreal", "MeanFreePathDistance", "all"),
    );
    // A system with a unit of its own does not mind that of the scene
    let engine = rows("--from unreal:MeanFreePathDistance=0.3 --surface-albedo 0.5 --unit m --to hdrp");
    close(value(&engine, "hdrp", "scatteringDistanceMultiplier", "all"), 3.0 / (0.6 * 1.539));
}

#[test]
fn coefficients_bring_their_surface_albedo() {
    // Marble of Jensen et al. 2001, in 1/mm
    let found = rows("--from pbrt:sigma_a=0.0021,0.0041,0.0071 --from pbrt:sigma_s=2.19,2.62,3.00");
    for (channel, sigma_a, sigma_s) in [("r", 0.0021, 2.19), ("g", 0.0041, 2.62), ("b", 0.0071, 3.0)] {
        let a = value(&found, "translucid", "surface_albedo", channel);
        assert!(a > 0.88 && a < 0.94, "{a}");
        close(value(&found, "translucid", "mfp", channel), 1.0 / (sigma_a + sigma_s));
        assert!((value(&found, "pbrt", "sigma_a", channel) / sigma_a - 1.0).abs() < 1e-9);
        close(value(&found, "pbrt", "sigma_s", channel), sigma_s);
    }
    // Forward scattering is turned into the similar isotropic medium
    let forward =
        rows("--from pbrt:sigma_a=0.1 --from pbrt:sigma_s=9 --from pbrt:g=0.9 --to translucid,pbrt");
    close(value(&forward, "translucid", "mfp", "all"), 1.0);
    close(value(&forward, "pbrt", "sigma_s", "all"), 0.9);
    let same =
        rows("--from pbrt:sigma_a=0.1 --from pbrt:sigma_s=9 --from pbrt:g=0.9 --to pbrt --set pbrt:g=0.9");
    close(value(&same, "pbrt", "sigma_s", "all"), 9.0);
}

#[test]
fn every_system_there_and_back_is_the_same() {
    let first = "--from translucid:d=3.1,1.7e-3,420 --surface-albedo 0.87,0.31,0.5";
    let all = rows(first);
    let expected: Vec<f64> = ["r", "g", "b"].map(|channel| value(&all, "translucid", "d", channel)).to_vec();
    let mut systems: Vec<String> = all.iter().map(|r| r.system.clone()).collect();
    systems.dedup();
    assert!(systems.len() >= 25, "{systems:?}");
    for system in systems {
        // Of a system with several ways, the first
        let of_system: Vec<&Row> = all.iter().filter(|r| r.system == system).collect();
        let mut words = String::new();
        let mut names: Vec<&str> = of_system.iter().map(|r| r.parameter.as_str()).collect();
        let with_coefficients = ["pbrt", "rise"].contains(&system.as_str());
        names.dedup();
        if system == "translucid" {
            names.truncate(2);
        }
        if system == "pbrt" {
            names.truncate(4);
        }
        if system == "substrate" {
            names.truncate(3);
        }
        for name in names {
            let numbers: Vec<&&Row> = of_system.iter().filter(|r| r.parameter == name).take(3).collect();
            let is_albedo = numbers[0].equal == "surface_albedo";
            if is_albedo && with_coefficients {
                continue;
            }
            let numbers: Vec<String> = numbers.iter().map(|r| format!("{}", r.value)).collect();
            if is_albedo {
                words += &format!("--surface-albedo {} ", numbers.join(","));
                continue;
            }
            let numbers = if numbers.len() == 3 { numbers.join(",") } else { numbers[0].clone() };
            words += &format!("--from {system}:{name}={numbers} ");
        }
        let back = rows(&format!("{words} --to translucid"));
        for (channel, expected) in ["r", "g", "b"].into_iter().zip(&expected) {
            let found = value(&back, "translucid", "d", channel);
            assert!((found / expected - 1.0).abs() < 1e-12, "{words}: {found} is not {expected}");
        }
    }
}

/// Cycles' walks return another color than they are told, whatever their anisotropy, and none beyond 0.92.
#[test]
fn walks_of_cycles_are_told_what_comes_out() {
    let there =
        rows("--from arnold:radius=1 --surface-albedo 0.8 --to cycles-walk,cycles-walk-legacy,cycles-skin");
    for (system, told) in [("cycles-walk", 0.802), ("cycles-walk-legacy", 0.79), ("cycles-skin", 0.79)] {
        let color = value(&there, system, "base_color", "all");
        assert!((color - told).abs() < 0.005, "{system}: {color}");
        let length = value(&there, system, "subsurface_scale", "all");
        let words = format!("--from {system}:subsurface_scale={length} --surface-albedo {color} --to arnold");
        let back = rows(&words);
        assert!((value(&back, "arnold", "subsurface_color", "all") - 0.8).abs() < 1e-12);
        assert!((value(&back, "arnold", "subsurface_scale", "all") - 1.0).abs() < 1e-12);
    }
    let forward =
        "--from cycles-walk-legacy:subsurface_radius=1 --from cycles-walk-legacy:subsurface_anisotropy=0.6";
    let forward = rows(&format!("{forward} --surface-albedo 0.5 --to arnold"));
    // As measured in Blender 5.0.1
    assert!((value(&forward, "arnold", "subsurface_color", "all") - 0.488).abs() < 0.008);
    let words = "convert --from arnold:radius=1 --surface-albedo 0.99 --to cycles-walk";
    let note = stderr(&run(&here(), words));
    assert!(note.contains("reaches a surface albedo of 0.919"), "{note}");
}

/// A channel of length 0 is Lambertian, in Blender and everywhere.
#[test]
fn channels_of_length_zero_stay_zero() {
    let words = "--from cycles-burley:subsurface_radius=1,0,0.1 --surface-albedo 0.5 --to arnold,hdrp";
    let found = rows(words);
    assert_eq!(value(&found, "arnold", "subsurface_radius", "g"), 0.0);
    assert_eq!(value(&found, "hdrp", "scatteringDistance", "g"), 0.0);
    assert!(value(&found, "hdrp", "scatteringDistance", "b") > 0.0);
}

#[test]
fn json_holds_what_csv_holds() {
    let words = "--from arnold:radius=1,0.5,0.2 --surface-albedo 0.8";
    let json = stdout(&here(), &format!("convert {words} --format json"));
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let rows = rows(words);
    assert_eq!(json.as_array().unwrap().len(), rows.len());
    for (object, row) in json.as_array().unwrap().iter().zip(rows) {
        let text = |name: &str| object[name].as_str().unwrap().to_owned();
        let value = object["value"].as_f64().unwrap();
        assert!((value - row.value).abs() <= 1e-15 * row.value.abs());
        let found = Row {
            system: text("system"),
            parameter: text("parameter"),
            channel: text("channel"),
            value: row.value,
            unit: text("unit"),
            equal: text("equal"),
        };
        assert_eq!(found, row);
        assert!(text("source").contains(": "));
    }
}

#[test]
fn list_names_every_parameter() {
    let list = stdout(&here(), "convert --from list");
    for row in rows("--from translucid:d=1 --surface-albedo 0.5") {
        let line = list.lines().find(|line| line.starts_with(&row.system) && line.contains(&row.parameter));
        assert!(row.equal == "surface_albedo" || line.is_some(), "{row:?}");
    }
    assert!(list.contains("unitLength (0.1)"), "{list}");
}

#[test]
fn output_file_replaces_stdout() {
    let directory = tempfile::tempdir().unwrap();
    let words = "convert --from translucid:mfp=1 --surface-albedo 0.5";
    let printed = stdout(directory.path(), words);
    assert_eq!(stdout(directory.path(), &format!("{words} -o table.csv")), "");
    assert_eq!(std::fs::read_to_string(directory.path().join("table.csv")).unwrap(), printed);
    let output = run(directory.path(), &format!("{words} -o nowhere/table.csv"));
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn what_a_system_will_not_use_is_said() {
    let output = run(&here(), "convert --from translucid:d=1e-5 --surface-albedo 0.1 --to moonray");
    assert_eq!(output.status.code(), Some(0));
    assert!(stderr(&output).contains("moonray uses 0.001 in place of the length"), "{}", stderr(&output));
    // Among all systems one without an answer is passed over with a note; asked for, it is an error
    let output = run(&here(), "convert --from translucid:d=1 --surface-albedo 0.1");
    assert_eq!(output.status.code(), Some(0));
    assert!(stderr(&output).contains("unreal-signed has no numbers"), "{}", stderr(&output));
    let message = refused("--from translucid:d=1 --surface-albedo 0.1 --to unreal-signed");
    assert!(message.contains("negative below") && message.contains("(A - 0.8)^3"), "{message}");
    let message = refused("--from unreal-signed:mean_free_path=1 --surface-albedo 0.1");
    assert!(message.contains("--surface-albedo is 0.1") && message.contains("negative below"), "{message}");
}

#[test]
fn extremes_convert_or_are_refused() {
    for a in ["0", "1", "1e-12"] {
        for length in ["1e-100", "1e100"] {
            let found = rows(&format!("--from renderman:dmfp={length} --surface-albedo {a}"));
            assert!(found.iter().all(|r| r.value.is_finite() && r.value >= 0.0));
        }
    }
    assert!(
        refused("--from renderman:dmfp=1e-300 --surface-albedo 0.5").contains("must be in [1e-110, 1e110]")
    );
    assert!(refused("--from renderman:dmfp=inf --surface-albedo 0.5").contains("is inf"));
    assert!(refused("--from renderman:dmfp=nan --surface-albedo 0.5").contains("is NaN"));
}

#[test]
fn wrong_input_is_told_what_is_allowed() {
    for (words, says) in [
        ("--from rendermann:dmfp=2 --surface-albedo 0.5", "did you mean renderman?"),
        ("--from cycles:radius=2 --surface-albedo 0.5", "did you mean cycles-burley or cycles-walk"),
        ("--from maya:dmfp=2 --surface-albedo 0.5", "known are translucid"),
        (
            "--from unreal-5.2:MeanFreePathDistance=1 --surface-albedo 0.5",
            "did you mean unreal (5.1 and later) or",
        ),
        ("--from translucid:d=1 --surface-albedo 0.5 --to blender", "or cycles-walk (5.2 and 5.3) or"),
        (
            "--from renderman:dmpf=2 --surface-albedo 0.5",
            "did you mean dmfp? Known are dmfp, dmfpColor, unitLength",
        ),
        ("--from renderman:dmf=2 --surface-albedo 0.5", "did you mean dmfp"),
        ("--from renderman --surface-albedo 0.5", "must be SYSTEM:PARAMETER=VALUE"),
        ("--from renderman:dmfp=x --surface-albedo 0.5", "must be a number, or three"),
        ("--from renderman:dmfp=1,2 --surface-albedo 0.5", "must be a number, or three"),
        ("--from renderman:dmfp=1,2,3 --surface-albedo 0.5", "is one for all channels"),
        ("--from renderman:unitLength=1 --surface-albedo 0.5", "does not say a length"),
        ("--from renderman:dmfp=2", "--surface-albedo is missing"),
        ("--from renderman:dmfp=2 --surface-albedo 0.1,0.2", "--surface-albedo has 2 numbers"),
        ("--from renderman:dmfp=0 --surface-albedo 0.5", "Lambertian"),
        ("--from renderman:dmfp=-1 --surface-albedo 0.5", "--from renderman:dmfp is -1, but must be"),
        ("--from renderman:dmfp=1 --from renderman:DMFP=2 --surface-albedo 0.5", "twice"),
        ("--from renderman:dmfp=1 --from arnold:radius=2 --surface-albedo 0.5", "two systems"),
        ("--from pbrt:sigma_a=1 --from pbrt:sigma_s=2 --surface-albedo 0.5", "follows from the coefficients"),
        ("--from pbrt:sigma_a=1", "both coefficients"),
        ("--from pbrt:sigma_a=0 --from pbrt:sigma_s=0", "sigma_t"),
        ("--from pbrt:sigma_a=1 --from pbrt:sigma_s=1 --from pbrt:g=1", "must be in (-1, 1)"),
        ("--from translucid:d=1 --surface-albedo 0.5 --to unreel", "did you mean unreal"),
        ("--from translucid:d=1 --surface-albedo 0.5 --set moonray:radius=1", "what the conversion finds"),
        (
            "--from translucid:d=1 --surface-albedo 0.5 --set renderman:unitLength=0",
            "--set renderman:unitLength is 0",
        ),
        (
            "--from translucid:d=1 --surface-albedo 0.5 --to hdrp --set renderman:unitLength=1",
            "--to leaves out",
        ),
        ("--from gltf:attenuationDistance=1 --surface-albedo 0.5", "--from gltf:attenuationColor is missing"),
        (
            "--from gltf:attenuationColor=0.5 --surface-albedo 0.5",
            "--from gltf:attenuationDistance is missing",
        ),
        (
            "--from substrate:Thickness=0.01 --surface-albedo 0.5",
            "--from substrate:TransmittanceColor is missing",
        ),
        (
            "--from gltf:attenuationDistance=1 --from gltf:attenuationColor=1 --surface-albedo 0.5",
            "gltf:attenuationColor is 1, but must be in [0, 1)",
        ),
        (
            "--from adobe:scatteringDistance=1 --from adobe:absorptionColor=0 --surface-albedo 0.5",
            "absorptionColor is 0, but must be in (0, 1]",
        ),
        (
            "--from adobe:scatteringDistance=1 --from adobe:absorptionDistance=-1 --surface-albedo 0.5",
            "absorptionDistance is -1, but must be 0 for none",
        ),
        (
            "--from gltf:attenuationDistance=0 --from gltf:attenuationColor=0.5 --surface-albedo 0.5",
            "gltf:attenuationDistance is 0, but must be above 0",
        ),
        ("--from translucid:d=1 --surface-albedo 0.5 --g 0.5", "--thin"),
        ("--from translucid:d=1 --surface-albedo 0.5 --thin 1 --to hdrp", "--to"),
        (
            "--from translucid:d=1 --surface-albedo 0.5 --color-space srgb",
            "--color-space is \"srgb\", but must be one of lin_rec709",
        ),
        (
            "--from translucid:d=1 --surface-albedo 0.5 --color-space srgb",
            "did you mean lin_rec709? Numbers are linear",
        ),
        (
            "--from translucid:d=1 --surface-albedo 0.5 --color-space acescg --from-color-space rec2020",
            "--from-color-space is \"rec2020\", but must be one of lin_rec709",
        ),
        ("--wall-color 0.5", "--wall-balance"),
        ("--wall-balance 0.5", "--wall-color"),
        ("--wall-color 0.5,0.2 --wall-balance 0.5", "number of colors is 2, but must be 1 or 3"),
        ("--wall-color 0.5 --wall-balance 1e-5", "--wall-balance is 1e-5, but must be greater: no slab"),
        ("--wall-color 0.9 --wall-balance 1 --eta 1.5", "--wall-balance is 1, but must be less: no slab"),
        ("--wall-color 0.5 --wall-balance 0.5 --from hdrp:scatteringDistance=1", "--from"),
        (
            "--from translucid:d=1 --surface-albedo 0.1,0.9,0.1 --from-color-space acescg --color-space lin_rec709",
            "in lin_rec709 surface_albedo is -",
        ),
        ("--surface-albedo 0.5", "--from"),
    ] {
        let message = refused(words);
        assert!(message.contains(says), "{words}: {message}");
    }
}

/// A slab of a gray material: the walls have its light, and it is that of two conservative sums.
#[test]
fn a_slab_has_a_thin_wall_that_stands_for_it() {
    let thin = |words: &str| -> Vec<Vec<String>> {
        let csv = stdout(&here(), &format!("convert {words}"));
        csv.lines().skip(1).map(|line| line.splitn(7, ',').map(String::from).collect()).collect()
    };
    let find = |rows: &[Vec<String>], system: &str, parameter: &str, channel: &str| -> f64 {
        let is_it = |row: &&Vec<String>| row[0] == system && row[1] == parameter && row[2] == channel;
        rows.iter().find(is_it).unwrap_or_else(|| panic!("{system} {parameter}"))[3].parse().unwrap()
    };
    let gray = thin("--from translucid:mfp=1 --surface-albedo 0.8 --thin 2 --unit cm");
    let [reflectance, transmittance] =
        ["reflectance", "transmittance"].map(|name| find(&gray, "slab", name, "all"));
    assert!(reflectance < 0.8 && reflectance + transmittance < 1.0 && transmittance > 0.1, "{gray:?}");
    let color = find(&gray, "openpbr", "subsurface_color", "all");
    let g = find(&gray, "openpbr", "subsurface_scatter_anisotropy", "all");
    assert!((0.5 * color * (1.0 - g) - reflectance).abs() < 1e-12);
    assert!((0.5 * color * (1.0 + g) - transmittance).abs() < 1e-12);
    let factor = find(&gray, "gltf-diffuse-transmission", "diffuseTransmissionFactor", "all");
    let passed = find(&gray, "gltf-diffuse-transmission", "diffuseTransmissionColorFactor", "all");
    assert!((factor * passed - transmittance).abs() < 1e-12);
    for system in ["openpbr", "blender", "gltf-scatter", "gltf-diffuse-transmission"] {
        assert!(find(&gray, system, "reflectance error", "all").abs() < 1e-12, "{system}");
        let by_angle = find(&gray, system, "greatest error by angle", "all");
        assert!(by_angle > 0.05 && by_angle < 0.5, "{system}: {by_angle}");
    }
    // The same in another unit, and by another system's numbers
    let same = thin("--from openpbr:subsurface_radius=10 --surface-albedo 0.8 --thin 20");
    assert!((find(&same, "slab", "reflectance", "all") - reflectance).abs() < 1e-9);
    // A color: unlike channels are told apart, and what one balance cannot have is said
    let colored =
        thin("--from translucid:mfp=0.3,0.2,0.1 --surface-albedo 0.8,0.6,0.3 --thin 0.2 --g 0.5 --eta 1.4");
    let off = find(&colored, "openpbr", "transmittance error", "b");
    assert!(off > 0.01 && off < 0.3, "{off}");
    let text = stdout(&here(), "convert --from translucid:mfp=1 --surface-albedo 0.8 --thin 2 --format text");
    assert!(text.starts_with("slab\n  reflectance") && text.contains("\n\nblender\n"), "{text}");
}

/// From a material to its thin wall and back, and what is wrong leaves no file.
#[test]
fn a_thin_wall_leads_back_to_the_material() {
    let find = |csv: &str, parameter: &str| -> Vec<f64> {
        let start = format!("slab,{parameter},");
        let of_row = |line: &str| line.split(',').nth(3).unwrap().parse().unwrap();
        csv.lines().filter(|line| line.starts_with(&start)).map(of_row).collect()
    };
    let words = "convert --from translucid:mfp=0.5 --surface-albedo 0.8 --thin 0.7 --g 0.3 --eta 1.4";
    let wall = stdout(&here(), words);
    let value = |parameter: &str| -> f64 {
        let start = format!("openpbr,{parameter},all,");
        let line = wall.lines().find(|line| line.starts_with(&start)).unwrap();
        line.split(',').nth(3).unwrap().parse().unwrap()
    };
    let (color, balance) = (value("subsurface_color"), 0.5 * (1.0 + value("subsurface_scatter_anisotropy")));
    let words = format!("convert --wall-color {color} --wall-balance {balance} --thin 0.7 --g 0.3 --eta 1.4");
    let slab = stdout(&here(), &words);
    assert!((find(&slab, "mfp")[0] / 0.5 - 1.0).abs() < 1e-3, "{slab}");
    assert!((find(&slab, "surface_albedo")[0] - 0.8).abs() < 1e-4, "{slab}");
    let alpha = find(&slab, "single_scattering_albedo")[0];
    let depth = 0.7 / (0.5 * (1.0 - 0.3 * alpha));
    assert!((find(&slab, "thickness in mean free paths")[0] / depth - 1.0).abs() < 1e-3, "{slab}");
    let three = stdout(&here(), "convert --wall-color 0.7,0.5,0.3 --wall-balance 0.4");
    assert_eq!(find(&three, "mfp in thicknesses").len(), 3, "{three}");

    let directory = tempfile::tempdir().unwrap();
    let output = run(directory.path(), "convert --wall-color 2 --wall-balance 0.4 -o wall.csv");
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 0);
}

/// Gray stays gray in any color space; a color has the matrix's surface albedo, and lengths that are neither kept nor colors.
#[test]
fn other_primaries_mix_the_channels() {
    let csv = |words: &str| stdout(&here(), &format!("convert {words}"));
    let value = |csv: &str, start: &str| -> f64 {
        let line =
            csv.lines().find(|line| line.starts_with(start)).unwrap_or_else(|| panic!("{start}: {csv}"));
        line.split(',').nth(3).unwrap().parse().unwrap()
    };
    let gray = csv("--from translucid:d=2 --surface-albedo 0.6 --color-space acescg --to translucid");
    for channel in ["r", "g", "b"] {
        assert!((value(&gray, &format!("translucid,d,{channel}")) - 2.0).abs() < 1e-9);
        assert!((value(&gray, &format!("translucid,surface_albedo,{channel}")) - 0.6).abs() < 1e-9);
        assert!(value(&gray, &format!("color space,misplaced,{channel}")) < 1e-9);
    }
    let skin = "--from translucid:d=3,1,0.5 --surface-albedo 0.7,0.4,0.3";
    let acescg = csv(&format!("{skin} --color-space acescg --to translucid"));
    let red = value(&acescg, "translucid,surface_albedo,r");
    assert!((red - (0.6131 * 0.7 + 0.3395 * 0.4 + 0.0473 * 0.3)).abs() < 2e-3, "{red}");
    // Three quarters of the light are the old red's
    let d = value(&acescg, "translucid,d,r");
    assert!(d > 2.0 && d < 2.8, "{d}");
    let [mixed, kept] = ["misplaced,r", "misplaced if lengths were kept,r"]
        .map(|name| value(&acescg, &format!("color space,{name}")));
    assert!(mixed > 0.01 && mixed < kept, "{mixed} {kept}");
    let words = "--from translucid:d=3,1,0.5 --surface-albedo 0.6,0.5,0.4 --from-color-space acescg --color-space lin_rec709";
    let back = csv(&format!("{words} --to translucid"));
    assert!(value(&back, "translucid,surface_albedo,r") > 0.6);
    let [mixed, kept] = ["misplaced,g", "misplaced if lengths were kept,g"]
        .map(|name| value(&back, &format!("color space,{name}")));
    assert!(mixed <= kept, "{mixed} {kept}");
    let same = csv(&format!("{skin} --color-space lin_rec709 --to hdrp"));
    assert!(value(&same, "color space,misplaced,r").abs() < 1e-9);
}

/// Texels become what the command says of their numbers, and what is wrong leaves no file.
#[test]
fn textures_change_their_color_space_texel_by_texel() {
    let directory = tempfile::tempdir().unwrap();
    let write = |name: &str, pixels: [[f32; 3]; 2]| {
        let path = directory.path().join(name);
        exr::prelude::write_rgb_file(path, 2, 1, |x, _| (pixels[x][0], pixels[x][1], pixels[x][2])).unwrap();
    };
    write("albedo.exr", [[0.75, 0.5, 0.25], [0.5, 0.5, 0.5]]);
    write("mfp.exr", [[3.0, 1.0, 0.5], [2.0, 2.0, 2.0]]);
    let words = "convert --albedo-texture albedo.exr --mfp-texture mfp.exr --color-space acescg -o out";
    let output = run(directory.path(), words);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let [albedo, mfp] = ["surface_albedo.exr", "mfp.exr"].map(|name| {
        let image = translucid_load::load_exr(&directory.path().join("out").join(name)).unwrap();
        ["R", "G", "B"].map(|channel| {
            let (_, values) = image.channels.iter().find(|(name, _)| name == channel).unwrap();
            [f64::from(values[0]), f64::from(values[1])]
        })
    });
    let found = rows(
        "--from translucid:mfp=3,1,0.5 --surface-albedo 0.75,0.5,0.25 --color-space acescg --to translucid",
    );
    for (i, channel) in ["r", "g", "b"].into_iter().enumerate() {
        assert!((albedo[i][0] - value(&found, "translucid", "surface_albedo", channel)).abs() < 1e-6);
        let ratio = mfp[i][0] / value(&found, "translucid", "mfp", channel);
        assert!((ratio - 1.0).abs() < 0.02, "{channel}: {ratio}");
        assert!((albedo[i][1] - 0.5).abs() < 1e-6 && (mfp[i][1] - 2.0).abs() < 1e-6);
    }
    for (words, says) in [
        ("--albedo-texture albedo.exr --mfp-texture mfp.exr -o new", "--color-space"),
        ("--albedo-texture albedo.exr --color-space acescg -o new", "--mfp-texture"),
        ("--albedo-texture albedo.exr --mfp-texture none.exr --color-space acescg -o new", "none.exr"),
        (
            "--albedo-texture albedo.exr --mfp-texture mfp.exr --color-space srgb -o new",
            "did you mean lin_rec709?",
        ),
        (
            "--albedo-texture mfp.exr --mfp-texture albedo.exr --color-space acescg -o new",
            "mfp.exr, pixel (0, 0): to acescg surface_albedo is 3, but must be in [0, 1]",
        ),
    ] {
        let output = run(directory.path(), &format!("convert {words}"));
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{words}: {message}");
        assert!(message.contains(says), "{words}: {message}");
        assert!(!directory.path().join("new").exists(), "{words}");
    }
}

/// Every example of the documentation prints what stands below it there.
#[test]
fn documentation_prints_what_it_shows() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/guide/conventions.md");
    let text = std::fs::read_to_string(path).unwrap();
    let mut examples = 0;
    for block in text.split("```text\n$ translucid ").skip(1) {
        let (command, rest) = block.split_once("\n\n").unwrap();
        let shown = rest.split("```").next().unwrap();
        let words = command.replace("\\\n", " ");
        let output = translucid(&here()).args(words.split_whitespace()).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{words}: {}", stderr(&output));
        assert_eq!(String::from_utf8(output.stdout).unwrap().trim_end(), shown.trim_end(), "{words}");
        examples += 1;
    }
    assert_eq!(examples, 3);
}
