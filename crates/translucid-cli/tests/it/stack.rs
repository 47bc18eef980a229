//! `translucid stack`: colors of layers, their files, and faults of these.

use std::path::Path;

use crate::common::{run, stderr, stdout};
use crate::markdown::{Page, root};

fn directory_with(text: &str) -> tempfile::TempDir {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("stack.toml"), text).unwrap();
    directory
}

/// The rows of the table by their grounds.
fn rows(directory: &Path, options: &str) -> serde_json::Value {
    serde_json::from_str(&stdout(directory, &format!("stack stack.toml --format json {options}"))).unwrap()
}

fn number(value: &serde_json::Value) -> f64 {
    value.as_f64().unwrap()
}

/// Below a clear layer without faces a ground has its own color: XYZ and CIELAB of the table by `colour-science` 0.4.7,
/// interpolated linearly by 5 nm (`sd_to_XYZ_integration`, `XYZ_to_Lab`, `XYZ_to_sRGB`).
#[test]
fn ground_below_a_clear_layer_has_its_own_color() {
    let layer = "[[layer]]\nthickness = 1\nscattering = 0\nabsorption = 0\n";
    let (wavelengths, values) = ([400, 450, 550, 600, 700], [0.3, 0.4, 0.2, 0.6, 0.7]);
    let csv: String = wavelengths.iter().zip(values).map(|(w, value)| format!("{w},{value}\n")).collect();
    let inline = format!("{{ wavelengths = {wavelengths:?}, values = {values:?} }}");
    for table in [inline.as_str(), "'ground.csv'", "'two.csv'"] {
        let directory = directory_with(&format!("{layer}[below]\nreflectance = {table}\n"));
        std::fs::write(directory.path().join("two.csv"), format!("wavelength,R\n{csv}")).unwrap();
        let wide = csv.replace('\n', ",9\n");
        std::fs::write(directory.path().join("ground.csv"), format!("wavelength,reflectance,other\n{wide}"))
            .unwrap();
        for (options, xyz, lab) in [
            ("", [44.55259106, 36.25388169, 39.58710065], [66.71345467, 31.88403982, -0.13697993]),
            (
                "--observer 10 --illuminant d50",
                [45.50906062, 37.07857583, 29.65846606],
                [67.33593981, 29.68705732, 0.85117804],
            ),
            (
                "--illuminant a",
                [57.10989247, 40.88119218, 12.72515633],
                [70.09260322, 30.95658757, 6.47345201],
            ),
        ] {
            let row = &rows(directory.path(), options)[2];
            assert_eq!(row["ground"], "below");
            for (column, expected) in
                ["X", "Y", "Z", "L", "a", "b"].into_iter().zip(xyz.into_iter().chain(lab))
            {
                let found = number(&row[column]);
                assert!((found - expected).abs() < 1e-3, "{options} {column}: {found}, expected {expected}");
            }
        }
        let row = &rows(directory.path(), "")[2];
        assert_eq!((&row["srgb"], &row["in_srgb"]), (&"#d88da4".into(), &"yes".into()));
        assert!(row["transmittance"].is_null());
        let message = stderr(&run(directory.path(), "stack stack.toml"));
        assert!(message.contains("below.reflectance covers 400 to 700 nm"), "{message}");
    }
}

/// A clear sheet of η shows all of a ground's contrast but what its faces return.
#[test]
fn clear_sheet_has_the_contrast_of_its_grounds() {
    let sheet = |more: &str| format!("[[layer]]\nthickness = 1\nscattering = 0\nabsorption = 0\n{more}");
    let directory = directory_with(&sheet(""));
    let table = rows(directory.path(), "");
    let [black, white, below] = [0, 1, 2].map(|i| &table[i]);
    assert_eq!([black, white].map(|row| row["srgb"].as_str().unwrap()), ["#000000", "#ffffff"]);
    assert!((number(&black["tp_ab"]) - 100.0).abs() < 1e-3 && number(&black["contrast_ratio"]) < 1e-9);
    assert!((number(&below["transmittance"]) - 1.0).abs() < 1e-6);

    // Fresnel's reflectance at 8° of η = 1.5 over black, all light over white, by Fresnel's formulas
    let (outside, inside) = (8f64.to_radians(), (8f64.to_radians().sin() / 1.5).asin());
    let s = (outside - inside).sin() / (outside + inside).sin();
    let p = (outside - inside).tan() / (outside + inside).tan();
    let face = 0.5 * (s * s + p * p);
    let directory = directory_with(&sheet("eta = 1.5\n"));
    let table = rows(directory.path(), "");
    assert!((number(&table[0]["reflectance"]) - face).abs() < 1e-6);
    assert!((number(&table[1]["reflectance"]) - 1.0).abs() < 1e-6);
    assert!((number(&table[0]["contrast_ratio"]) - face).abs() < 1e-6);
    assert!(number(&rows(directory.path(), "--specular excluded")[0]["reflectance"]) < 1e-9);
    // Air below the sheet: both its faces reflect
    let directory = directory_with(&sheet("eta = 1.5\n[grounds]\ncontact = 'air'\n"));
    let both = 2.0 * face / (1.0 + face);
    assert!((number(&rows(directory.path(), "")[0]["reflectance"]) - both).abs() < 1e-6);
}

#[test]
fn opaque_layer_has_one_color_and_an_endless_one_no_contrast() {
    let layer = "[[layer]]\nscattering = [9, 20, 30]\nabsorption = [0.1, 2, 0.5]\ng = 0.5\neta = 1.3\n";
    let thick = directory_with(&format!("{layer}thickness = 50\n"));
    let endless = directory_with(layer);
    let (thick, endless) = (rows(thick.path(), ""), rows(endless.path(), ""));
    assert!(number(&thick[0]["tp_2000"]) < 1e-2 && endless[0]["tp_ab"].is_null());
    assert_eq!(endless.as_array().unwrap().len(), 1);
    for column in ["X", "Y", "Z", "kubelka_munk_reflectance"] {
        assert!((number(&thick[1][column]) - number(&endless[0][column])).abs() < 1e-3, "{column}");
    }
}

#[test]
fn kubelka_munk_is_noted_where_it_is_off() {
    // Little scattering: the two fluxes of Kubelka and Munk miss by far
    let directory = directory_with("[[layer]]\nthickness = 1\nscattering = 0.3\nabsorption = 0.3\n");
    let row = &rows(directory.path(), "")[1];
    assert!(number(&row["kubelka_munk_delta_e"]) > 1.0);
    let message = stderr(&run(directory.path(), "stack stack.toml"));
    let expected = format!("{:.2} over white", number(&row["kubelka_munk_delta_e"]));
    assert!(
        message.contains("Kubelka-Munk with Saunderson's correction is off by")
            && message.contains(&expected)
    );
    let clear = directory_with("[[layer]]\nthickness = 1\nscattering = 0\nabsorption = 0\n");
    assert_eq!(stderr(&run(clear.path(), "stack stack.toml")), "");
}

/// Errors of totals reach the user: narrow forward scattering in a thin, dark layer has the largest.
#[test]
fn errors_that_matter_are_warned_of() {
    let directory =
        directory_with("[[layer]]\nthickness = 1\nscattering = 10\nabsorption = 8\ng = 0.99\neta = 1.0001\n");
    let largest = rows(directory.path(), "")
        .as_array()
        .unwrap()
        .iter()
        .map(|row| number(&row["error"]))
        .fold(0.0, f64::max);
    let message = stderr(&run(directory.path(), "stack stack.toml"));
    assert_eq!(
        message.contains("numerical errors may change colors"),
        largest > 0.01,
        "{largest}: {message}"
    );
    assert!(largest > 0.01, "{largest}");
}

#[test]
fn channels_are_those_of_the_solver() {
    use translucid_reference::Incidence;
    use translucid_reference::layers::{Ground, Layer, Layers};

    let directory = directory_with(
        "[[layer]]\nthickness = 0.5\nscattering = [4, 2, 9]\nabsorption = 0.2\ng = 0.3\neta = 1.4\n",
    );
    let csv = stdout(directory.path(), "stack stack.toml --channels");
    let lines: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(
        lines[0],
        ["channel", "reflectance_black", "reflectance_white", "reflectance_below", "transmittance", "error"]
    );
    let layer = Layer::new(2.0, 0.2, 0.5).with_g(0.3).with_eta(1.4);
    let incidence = Incidence::Pencil { cos_theta: 8f64.to_radians().cos() };
    for (column, ground) in
        [Ground::BLACK, Ground::Lambertian { reflectance: 1.0 }, Ground::AIR].into_iter().enumerate()
    {
        let totals = Layers::new(1.0, vec![layer.clone()], ground).unwrap().totals(incidence).unwrap();
        let expected = totals.specular_reflectance + totals.diffuse_reflectance;
        let found: f64 = lines[2][column + 1].parse().unwrap();
        assert!((found - expected).abs() < 1e-9, "{}: {found}, expected {expected}", lines[2][0]);
    }
    let spectral = directory_with(
        "[[layer]]\nthickness = 1\nscattering = 1\nabsorption = { wavelengths = [380, 780], values = [1, 2] }\n",
    );
    let csv = stdout(spectral.path(), "stack stack.toml --channels");
    assert!(
        csv.starts_with("wavelength,")
            && csv.lines().count() == 82
            && csv.lines().nth(81).unwrap().starts_with("780,")
    );
}

#[test]
fn swatches_are_drawn_beside_the_table() {
    let directory = directory_with("[[layer]]\nthickness = 1\nscattering = 3\nabsorption = [0.1, 0.4, 1]\n");
    let table = stdout(directory.path(), "stack stack.toml");
    for name in ["a.svg", "a.png"] {
        assert_eq!(stdout(directory.path(), &format!("stack stack.toml -o {name}")), table);
    }
    let svg = std::fs::read_to_string(directory.path().join("a.svg")).unwrap();
    let hex = table.lines().nth(1).unwrap().split(',').nth(9).unwrap();
    assert!(svg.contains(hex) && svg.contains("over white") && svg.contains("TP "));
    assert!(std::fs::read(directory.path().join("a.png")).unwrap().starts_with(b"\x89PNG"));
    stdout(directory.path(), "stack stack.toml -o a.csv");
    assert_eq!(std::fs::read_to_string(directory.path().join("a.csv")).unwrap(), table);
}

/// A fault of the file or the command, with what its message must have.
#[test]
fn faults_are_named() {
    let start = "[[layer]]\nthickness = 1\nscattering = 1\n";
    let table = |wavelengths: &str, values: &str| {
        format!("{start}absorption = {{ wavelengths = {wavelengths}, values = {values} }}\n")
    };
    let file = |name: &str| format!("{start}absorption = '{name}'\n");
    for (text, options, expected) in [
        (table("[400, 700]", "[1]"), "", "layer[0].absorption has 2 wavelengths, but 1 values"),
        (table("[]", "[]"), "", "layer[0].absorption has no values"),
        (
            table("[400, 700, 600]", "[1, 1, 1]"),
            "",
            "layer[0].absorption.wavelengths[2] is 600, but must be greater than 700",
        ),
        (table("[400, 400, 700]", "[1, 1, 1]"), "", "greater than 400, the one before it"),
        (table("[0.4, 0.7]", "[1, 1]"), "", "wavelengths[0] is 0.4, but must be in [100, 1e5]"),
        (
            table("[450, 700]", "[1, 1]"),
            "",
            "layer[0].absorption covers 450 to 700 nm, but must cover 400 to 700 nm",
        ),
        (table("[400, 700]", "[1, -1]"), "", "layer[0].absorption.values[1] is -1, but must be in [0, 1e30]"),
        (table("[400, 700]", "[1, nan]"), "", "layer[0].absorption.values[1] is nan"),
        (table("[400, 700]", "[1, 'a']"), "", "values[1] is a string, but must be a number"),
        (format!("{start}absorption = {{ values = [1] }}\n"), "", "needs the key wavelengths"),
        (
            format!("{start}absorption = [1, 2]\n"),
            "",
            "layer[0].absorption has 2 values, but must be an array of 3 numbers",
        ),
        (format!("{start}absorption = [1, 2, -3]\n"), "", "layer[0].absorption[2] is -3"),
        (
            format!("{}[below]\nreflectance = [0.1, 0.2, 0.3]\n", table("[400, 700]", "[1, 1]")),
            "",
            "below.reflectance has values for red, green and blue, but layer[0].absorption has a table",
        ),
        (
            format!("{start}absorption = [1, 2, 3]\n"),
            "--illuminant d50",
            "for the illuminant d65 and the observer 2 only",
        ),
        (
            format!("{start}absorption = 1\n[below]\nreflectance = [0.5, 0.5, 1.5]\n"),
            "",
            "below.reflectance[2] is 1.5",
        ),
        (format!("{start}absorption = 1\n[ground]\n"), "", "did you mean grounds"),
        (
            "[grounds]\nwhite = 0.9\n[[layer]]\nscattering = 1\nabsorption = 1\n".into(),
            "",
            "the last layer is endless",
        ),
        (file("missing.csv"), "", "missing.csv cannot be read"),
        (file("unsorted.csv"), "", "wavelength is 500, but must be greater than 600, the one before it"),
        (file("unsorted.csv"), "", "unsorted.csv:4"),
        (file("negative.csv"), "", "a is -1, but must be in [0, 1e30]"),
        (file("nan.csv"), "", "a is nan, but must be in [0, 1e30]"),
        (file("empty.csv"), "", "layer[0].absorption has no values"),
        (file("header.csv"), "", "there is no column wavelength; the columns are nm, a"),
        (file("columns.csv"), "", "there is no column absorption; the columns are wavelength, a, b"),
        (file("twice.csv"), "", "there are two columns wavelength"),
        (file("twice-absorption.csv"), "", "there are two columns absorption"),
        (file("scattering.csv"), "", "the column is scattering, but absorption is read from it"),
        (file("semicolons.csv"), "", "separate columns by commas"),
        (file("/dev/zero"), "", "/dev/zero has more than 16777216 bytes"),
        (format!("{start}absorption = 1\n"), "--channels --format text", "is a table, which --format text"),
        (format!("{start}absorption = 1\n"), "-o stack.toml", "a file that is read"),
        (table("[400, 700]", "[1, 1]"), "-o no/such/folder.svg", "no/such"),
    ] {
        let directory = directory_with(&text);
        for (name, text) in [
            ("unsorted.csv", "wavelength,a\n400,1\n600,1\n500,1\n700,1\n"),
            ("negative.csv", "wavelength,a\n400,1\n700,-1\n"),
            ("nan.csv", "wavelength,a\n400,nan\n700,1\n"),
            ("empty.csv", "wavelength,a\n"),
            ("header.csv", "nm,a\n400,1\n700,1\n"),
            ("twice.csv", "wavelength,wavelength\n400,1\n700,1\n"),
            ("twice-absorption.csv", "wavelength,absorption,absorption\n400,1,2\n700,1,2\n"),
            ("scattering.csv", "wavelength,scattering\n400,1\n700,1\n"),
            ("semicolons.csv", "wavelength;absorption\n400;0,1\n700;0,1\n"),
            ("columns.csv", "wavelength,a,b\n400,1,1\n700,1,1\n"),
        ] {
            std::fs::write(directory.path().join(name), text).unwrap();
        }
        let output = run(directory.path(), &format!("stack stack.toml {options}"));
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{text} {options}: {message}");
        assert!(message.contains(expected), "{text} {options}: {message}");
    }
    let directory = directory_with(&file("a.csv"));
    std::fs::write(directory.path().join("a.csv"), "wavelength,a\n400,1\n700,1\n").unwrap();
    let output = run(directory.path(), "stack stack.toml -o a.csv");
    assert!(stderr(&output).contains("a file that is read"), "{}", stderr(&output));
    // The other reader of such files takes numbers only
    let message = stderr(&run(directory.path(), "reference --layers stack.toml"));
    assert!(
        message.contains("values over wavelengths or channels") && message.contains("translucid stack"),
        "{message}"
    );
}

#[test]
fn grounds_that_are_swapped_are_warned_of() {
    let layer = "[[layer]]\nthickness = 1\nscattering = 1\nabsorption = 1\n[grounds]\n";
    for (grounds, expected) in [("black = 0.9\nwhite = 0.1\n", true), ("black = 0.1\nwhite = 0.9\n", false)] {
        let directory = directory_with(&format!("{layer}{grounds}"));
        let message = stderr(&run(directory.path(), "stack stack.toml"));
        assert_eq!(message.contains("grounds.black is lighter than grounds.white"), expected, "{message}");
    }
}

/// The guide's examples print what stands there.
#[test]
fn guide_prints_what_it_shows() {
    let directory = tempfile::tempdir().unwrap();
    let page = Page::read(&root().join("docs/guide/stack.md"));
    let (mut printed, mut shown) = (String::new(), String::new());
    for block in page.code() {
        let text = block.lines.join("\n");
        match block.language.as_str() {
            "toml" => {
                let name = block.lines[0].trim_start_matches("# ").split(':').next().unwrap();
                std::fs::write(directory.path().join(name), text).unwrap();
            }
            "csv" => std::fs::write(directory.path().join("absorption.csv"), text).unwrap(),
            "sh" | "python" => {}
            _ => {
                for line in &block.lines {
                    match line.strip_prefix("$ translucid ") {
                        Some(words) => printed += &stdout(directory.path(), words),
                        None => shown += &format!("{line}\n"),
                    }
                }
            }
        }
    }
    assert!(shown.lines().count() > 8);
    assert_eq!(printed, shown);
}

/// A filament's layer is that of its coefficients; other meanings of the transmission distance are noted, and faults named.
#[test]
fn filament_is_its_color_and_transmission_distance() {
    let layer = |keys: &str| format!("[[layer]]\nthickness = 0.4\neta = 1.46\n{keys}\n");
    let filament = |words: &str| layer(&format!("filament = {{ {words} }}"));
    let orange = "color = '#fe6e32', transmission_distance = 6.6";
    let directory = directory_with(&filament(&format!("{orange}, transmitted = 0.1")));
    let found = rows(directory.path(), "");
    let color = [0xfe, 0x6e, 0x32].map(|code| {
        let x = f64::from(code) / 255.0;
        ((x + 0.055) / 1.055_f64).powf(2.4)
    });
    let filament_of = translucid_laboratory::stack::Filament {
        color,
        transmission_distance: 6.6,
        transmitted: 0.1,
        eta: 1.46,
    };
    let [scattering, absorption] = filament_of.coefficients().unwrap();
    let plain = directory_with(&layer(&format!("scattering = {scattering:?}\nabsorption = {absorption:?}")));
    for (row, expected) in found.as_array().unwrap().iter().zip(rows(plain.path(), "").as_array().unwrap()) {
        for column in ["X", "Y", "Z"] {
            let [found, expected] = [row, expected].map(|row| number(&row[column]));
            assert!((found - expected).abs() < 1e-3, "{column}: {found}, expected {expected}");
        }
    }
    let text = stdout(directory.path(), "stack stack.toml --format text");
    let note = "ransmission distances of other meanings, transmitted 0.37, 0.10, 0.05, 0.01, change colors by up to ΔE*ab ";
    assert!(text.contains(&format!("T{note}")), "{text}");
    assert!(stderr(&run(directory.path(), "stack stack.toml")).contains(&format!("t{note}")));
    assert!(!stderr(&run(plain.path(), "stack stack.toml")).contains("ransmission distances"));
    for (keys, expected) in [
        (filament(orange), "needs the key transmitted"),
        (
            filament(&format!("{orange}, transmitted = 0.95")),
            "even a clear sheet with these faces lets only 0.9",
        ),
        (filament("transmission_distance = 2, transmitted = 0.1"), "needs the key color"),
        (
            filament(&format!("{orange}, transmitted = 0.1")) + "g = 0.5\n",
            "layer[0].g and layer[0].filament are given",
        ),
        (filament(&format!("{orange}, td = 3, transmitted = 0.1")), "has no key td"),
    ] {
        let directory = directory_with(&keys);
        let message = stderr(&run(directory.path(), "stack stack.toml"));
        assert!(message.contains(expected), "{message}");
    }
}
