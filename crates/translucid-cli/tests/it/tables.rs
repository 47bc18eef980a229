//! `translucid profile` and `translucid sample`: the contract that scripts depend on.

use std::io::Read;
use std::process::Stdio;

use crate::common::{run, signal, start, stderr, stdout, translucid};
use translucid_profile::{
    Appearance, Configuration, Medium, Model, NormalizedDiffusion, Parameterization, Profile,
    RefinedDiffusion, SumOfGaussians,
};

const MODEL: &str = "--surface-albedo 0.8 --mfp 2";

fn here() -> std::path::PathBuf {
    std::env::temp_dir()
}

fn numbers(csv: &str) -> Vec<Vec<f64>> {
    csv.lines().skip(1).map(|line| line.split(',').map(|number| number.parse().unwrap()).collect()).collect()
}

fn profile(parameterization: Parameterization, configuration: Configuration) -> NormalizedDiffusion {
    NormalizedDiffusion::new(0.8, 2.0, parameterization, configuration).unwrap()
}

#[test]
fn profile_prints_the_columns_and_numbers_of_the_library() {
    let csv =
        stdout(&here(), &format!("profile --model normalized-diffusion {MODEL} --at 0,0.1,1,7.3,1e-9,300"));
    assert_eq!(csv.lines().next(), Some("r,reflectance,enclosed"));
    let expected = profile(Parameterization::Mfp, Configuration::Diffuse);
    let rows = numbers(&csv);
    assert_eq!(rows.len(), 6);
    for (row, r) in rows.iter().zip([0.0, 0.1, 1.0, 7.3, 1e-9, 300.0]) {
        // Not nearly: the text reads back exactly.
        assert_eq!(row, &[r, expected.eval(r), expected.enclosed(r)]);
    }
}

#[test]
fn profile_knows_every_parameterization() {
    for (options, parameterization, configuration) in [
        ("--mfp 2", Parameterization::Mfp, Configuration::Diffuse),
        ("--mfp 2 --configuration diffuse", Parameterization::Mfp, Configuration::Diffuse),
        ("--mfp 2 --configuration searchlight", Parameterization::Mfp, Configuration::Searchlight),
        ("--dmfp 2", Parameterization::Dmfp, Configuration::Searchlight),
        (
            "--dmfp 2 --configuration searchlight --eta 1 --g 0",
            Parameterization::Dmfp,
            Configuration::Searchlight,
        ),
    ] {
        let reflectance = |options: &str| numbers(&stdout(&here(), options))[0][1];
        let options = format!("profile --surface-albedo 0.8 {options} --at 1.5");
        let normalized = format!("{options} --model normalized-diffusion");
        assert_eq!(reflectance(&normalized), profile(parameterization, configuration).eval(1.5), "{options}");
        // Without a model: the refined profile
        let refined = RefinedDiffusion::new(0.8, 2.0, parameterization, configuration).unwrap();
        assert_eq!(reflectance(&options), refined.eval(1.5), "{options}");
    }
}

#[test]
fn profile_knows_every_model() {
    for model in Model::ALL {
        for (options, appearance, eta) in [
            ("--surface-albedo 0.6 --mfp 2", appearance(0.6, Parameterization::Mfp, 0.0), 1.0),
            ("--surface-albedo 0.6 --dmfp 2", appearance(0.6, Parameterization::Dmfp, 0.0), 1.0),
            (
                "--surface-albedo 0.6 --mfp 2 --g 0.5 --eta 1.3",
                appearance(0.6, Parameterization::Mfp, 0.5),
                1.3,
            ),
        ] {
            if eta != 1.0 && !model.knows_boundary() {
                continue;
            }
            let words =
                format!("profile --model {model} {options} --configuration searchlight --at 0.1,1,7.3");
            let rows = numbers(&stdout(&here(), &words));
            let expected = model.profile(&appearance, Configuration::Searchlight, eta).unwrap();
            for (row, r) in rows.iter().zip([0.1, 1.0, 7.3]) {
                assert_eq!(row, &[r, expected.eval(r), expected.enclosed(r)], "{words}");
            }
        }
    }
}

fn appearance(surface_albedo: f64, parameterization: Parameterization, g: f64) -> Appearance {
    Appearance { surface_albedo, length: 2.0, parameterization, g }
}

#[test]
fn profile_takes_coefficients() {
    let medium = Medium::new(0.1, 2.0, 0.5).unwrap();
    for model in Model::ALL {
        let words = format!(
            "profile --model {model} --sigma-a 0.1 --sigma-s 2 --g 0.5 --configuration searchlight --at 0.4"
        );
        let expected = model.profile_of_medium(&medium, Configuration::Searchlight, 1.0).unwrap();
        assert_eq!(numbers(&stdout(&here(), &words))[0][1], expected.eval(0.4), "{words}");
    }
}

#[test]
fn profile_says_when_more_leaves_than_enters() {
    let note = |sigma_a: &str| {
        let words = format!("profile --model directional-dipole --sigma-a {sigma_a} --sigma-s 1 --at 1");
        stderr(&run(&here(), &words))
    };
    assert!(
        note("0").contains("directional-dipole sends back 1.339 times the light that enters"),
        "{}",
        note("0")
    );
    assert!(!note("0.5").contains("sends back"));
}

/// The share of radii within each tenth of the energy: χ² over ten equal bins of 20,000 draws, 9 degrees of freedom,
/// is above 33.7 with probability 1e-4 for each model.
#[test]
fn sample_follows_every_model() {
    for model in Model::ALL {
        let words = format!(
            "sample --model {model} --surface-albedo 0.6 --mfp 2 --configuration searchlight --count 20000 --seed 3"
        );
        let appearance = appearance(0.6, Parameterization::Mfp, 0.0);
        let profile = model.profile(&appearance, Configuration::Searchlight, 1.0).unwrap();
        let mut bins = [0.0; 10];
        for row in numbers(&stdout(&here(), &words)) {
            let share = profile.enclosed(row[0]) / profile.surface_albedo();
            bins[((10.0 * share) as usize).min(9)] += 1.0;
        }
        let chi_square: f64 = bins.iter().map(|count| (count - 2000.0_f64).powi(2) / 2000.0).sum();
        assert!(chi_square < 33.7, "{model}: {chi_square}, {bins:?}");
    }
}

/// Tables that `profile` prints read back as a table with the same profile.
#[test]
fn profile_reads_a_table_of_its_own() {
    let directory = tempfile::tempdir().unwrap();
    let radii: Vec<String> = (0..200).map(|i| format!("{:e}", 1e-3 * 1.055_f64.powi(i))).collect();
    let at = radii.join(",");
    let model = "--surface-albedo 0.6 --configuration searchlight";
    let words = format!("profile --model dipole {model} --mfp 1 --at {at} -o table.csv");
    assert!(run(directory.path(), &words).status.success());
    let table = numbers(&stdout(
        directory.path(),
        "profile --table table.csv --surface-albedo 0.6 --mfp 2 --at 0.2,2,9",
    ));
    let source = numbers(&stdout(&here(), &format!("profile --model dipole {model} --mfp 2 --at 0.2,2,9")));
    for (found, expected) in table.iter().zip(&source) {
        assert!((found[1] / expected[1] - 1.0).abs() < 3e-3, "{found:?} {expected:?}");
        assert!((found[2] / expected[2] - 1.0).abs() < 1e-3, "{found:?} {expected:?}");
    }
}

#[test]
fn terms_choose_the_number_of_gaussians() {
    for terms in 1..=SumOfGaussians::MAX_TERMS {
        let model =
            format!("profile --model gaussians --terms {terms} --configuration searchlight --at 0.1,1,9");
        let medium = Medium::new(0.2, 1.0, 0.3).unwrap();
        let of_medium = medium.surface_albedo(Configuration::Searchlight);
        for (options, surface_albedo, length) in [
            ("--surface-albedo 0.6 --mfp 2", 0.6, 2.0),
            ("--sigma-a 0.2 --sigma-s 1 --g 0.3", of_medium, medium.transport_mfp()),
        ] {
            let (parameterization, configuration) = (Parameterization::Mfp, Configuration::Searchlight);
            let expected =
                SumOfGaussians::new(surface_albedo, length, parameterization, configuration, terms).unwrap();
            let rows = numbers(&stdout(&here(), &format!("{model} {options}")));
            for (row, r) in rows.iter().zip([0.1, 1.0, 9.0]) {
                assert_eq!(row, &[r, expected.eval(r), expected.enclosed(r)], "{terms} {options}");
            }
        }
    }
}

/// The table that is printed must not take the place of the one that it is printed from.
#[test]
fn table_that_is_read_is_not_written_over() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("table.csv");
    let text = "r,reflectance\n0.1,5\n1,1\n2,0.4\n4,0.05\n";
    std::fs::write(&path, text).unwrap();
    std::fs::create_dir(directory.path().join("folder")).unwrap();
    for words in [
        "profile --at 1 -o table.csv",
        "profile --at 1 -o ./folder/../table.csv",
        "sample --count 3 -o table.csv",
    ] {
        let output =
            run(directory.path(), &format!("{words} --table table.csv --surface-albedo 0.5 --mfp 1"));
        assert_eq!(output.status.code(), Some(2), "{words}");
        assert!(stderr(&output).contains("--output") && stderr(&output).contains("overwritten"), "{words}");
        assert_eq!(std::fs::read_to_string(&path).unwrap(), text, "{words}");
    }
}

#[test]
fn profile_points_are_even_and_end_at_the_maximum() {
    let rows = numbers(&stdout(&here(), &format!("profile {MODEL} --points 4 --max 10")));
    assert_eq!(rows.iter().map(|row| row[0]).collect::<Vec<_>>(), [2.5, 5.0, 7.5, 10.0]);
}

#[test]
fn json_holds_what_csv_holds() {
    let json = stdout(&here(), &format!("profile {MODEL} --at 0.1,3 --format json"));
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let rows = numbers(&stdout(&here(), &format!("profile {MODEL} --at 0.1,3")));
    assert_eq!(json.as_array().unwrap().len(), 2);
    for (object, row) in json.as_array().unwrap().iter().zip(rows) {
        for (name, value) in ["r", "reflectance", "enclosed"].iter().zip(row) {
            // This parser may miss by the last digit.
            assert!((object[name].as_f64().unwrap() / value - 1.0).abs() < 1e-15, "{name}");
        }
    }
}

#[test]
fn sample_follows_the_profile() {
    let csv = stdout(&here(), &format!("sample {MODEL} --count 20000 --seed 3"));
    assert_eq!(csv.lines().next(), Some("r"));
    let mut radii: Vec<f64> = numbers(&csv).into_iter().map(|row| row[0]).collect();
    radii.sort_by(f64::total_cmp);
    // Kolmogorov–Smirnov: √n D > 2.23 has probability 1e-4; the seed is fixed.
    let expected = profile(Parameterization::Mfp, Configuration::Diffuse);
    let n = radii.len() as f64;
    assert_eq!(n, 20_000.0);
    let distance = |(i, r): (usize, &f64)| {
        let share = expected.cdf(*r);
        (share - i as f64 / n).abs().max(((i + 1) as f64 / n - share).abs())
    };
    let worst = radii.iter().enumerate().map(distance).fold(0.0, f64::max);
    assert!(n.sqrt() * worst < 2.23, "{worst}");
}

#[test]
fn sample_depends_on_the_seed_alone() {
    let long = stdout(&here(), &format!("sample {MODEL} --count 100"));
    let short = stdout(&here(), &format!("sample {MODEL} --count 10 --seed 0"));
    assert!(long.starts_with(&short));
    assert_ne!(short, stdout(&here(), &format!("sample {MODEL} --count 10 --seed 1")));
    assert_eq!(stdout(&here(), &format!("sample {MODEL} --count 0")), "r\n");
}

#[test]
fn output_file_replaces_stdout() {
    let directory = tempfile::tempdir().unwrap();
    let printed = stdout(directory.path(), &format!("sample {MODEL} --count 5"));
    assert_eq!(stdout(directory.path(), &format!("sample {MODEL} --count 5 -o radii.csv")), "");
    assert_eq!(std::fs::read_to_string(directory.path().join("radii.csv")).unwrap(), printed);
    assert_eq!(crate::common::files(directory.path()), ["radii.csv"]);
}

#[test]
fn reader_that_leaves_early_is_no_error() {
    let words = format!("sample {MODEL} --count 100000000");
    let mut child = translucid(&here())
        .args(words.split_whitespace())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut start = [0; 100];
    child.stdout.take().unwrap().read_exact(&mut start).unwrap();
    // The pipe is closed by now.
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(stderr(&output), "");
}

#[cfg(target_os = "linux")]
#[test]
fn interrupted_table_leaves_no_file() {
    let directory = tempfile::tempdir().unwrap();
    let words = format!("sample {MODEL} --count 1000000000000 -o radii.csv");
    let grows = |entry: std::fs::DirEntry| entry.metadata().is_ok_and(|found| found.len() > 0);
    let is_there = || std::fs::read_dir(directory.path()).unwrap().any(|entry| entry.is_ok_and(grows));
    let output = signal(start(directory.path(), &words), "-INT", is_there);
    assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
    assert!(stderr(&output).contains("radii.csv was not written"), "{}", stderr(&output));
    assert!(crate::common::files(directory.path()).is_empty());
}

/// Every wrong command line: exit code 2, nothing on stdout, and the message names what is in brackets.
#[test]
fn wrong_options_are_refused_with_a_reason() {
    for (words, named) in [
        ("profile", "--surface-albedo"),
        ("profile --surface-albedo 0.8", "--mfp"),
        ("profile --surface-albedo 0.8 --mfp 1", "--at"),
        ("profile --surface-albedo 0.8 --mfp 1 --dmfp 1 --at 1", "--dmfp"),
        ("profile --surface-albedo 1.2 --mfp 1 --at 1", "--surface-albedo is 1.2"),
        ("profile --surface-albedo -0.1 --mfp 1 --at 1", "--surface-albedo is -0.1"),
        ("profile --surface-albedo nan --mfp 1 --at 1", "--surface-albedo is NaN"),
        ("profile --surface-albedo 0.8 --mfp -1 --at 1", "--mfp is -1"),
        ("profile --surface-albedo 0.8 --mfp inf --at 1", "--mfp is inf"),
        ("profile --surface-albedo 0.8 --dmfp 0 --at 1", "Lambertian"),
        ("profile --surface-albedo 0.5 --mfp 1e300 --at 1", "--mfp is 1e300, "),
        ("profile --surface-albedo 0.5 --mfp 1 --at ,", "--at"),
        ("profile --surface-albedo 0.5 --mfp 1 --at -1e300", "radius -1e300,"),
        ("profile --surface-albedo 0.5 --mfp 1 --points 3 --max inf", "--max"),
        ("sample --surface-albedo 0.5 --mfp 1 --count 1 -o /dev/null", "not a regular file"),
        ("sample --surface-albedo 0.5 --mfp 1 --count 1 -o .", "does not name a file"),
        ("profile --surface-albedo zero --mfp 1 --at 1", "zero"),
        ("profile --surface-albedo 0.8 --mfp 1 --at 1,-2", "-2"),
        ("profile --surface-albedo 0.8 --mfp 1 --at nan", "NaN"),
        ("profile --surface-albedo 0.8 --mfp 1 --at 1,x", "x"),
        ("profile --surface-albedo 0.8 --mfp 1 --at 1 --points 2 --max 1", "--points"),
        ("profile --surface-albedo 0.8 --mfp 1 --points 3", "--max"),
        ("profile --surface-albedo 0.8 --mfp 1 --points 0 --max 1", "0"),
        ("profile --surface-albedo 0.8 --mfp 1 --points 3 --max 0", "--max"),
        ("profile --surface-albedo 0.8 --mfp 1 --at 1 --model exact --eta 1.4", "--eta is 1.4"),
        ("profile --surface-albedo 0.8 --mfp 1 --at 1 --eta 1.6", "--eta is 1.6, but must be in [1, 1.5]"),
        ("sample --surface-albedo 0.8 --mfp 1 --count 1 --g 0.95", "--g is 0.95, but must be in [-0.5, 0.9]"),
        ("profile --surface-albedo 0.8 --mfp 1 --at 1 --model random-walk", "random-walk has no profile"),
        ("sample --surface-albedo 0.8 --mfp 1 --count 1 --model random-walk", "random-walk has no profile"),
        ("profile --surface-albedo 0.8 --mfp 1 --at 1 --model none", "has no profile"),
        ("profile --surface-albedo 0.8 --mfp 1 --at 1 --model default", "the model default has no profile"),
        ("profile --surface-albedo 0.8 --mfp 1 --at 1 --model dipole --eta 99", "--eta is 99"),
        ("profile --surface-albedo 0.8 --mfp 1 --at 1 --model dipole --g 1", "--g is 1"),
        ("profile --surface-albedo 0.8 --mfp 0 --at 1 --model dipole", "Lambertian"),
        ("profile --surface-albedo 1 --dmfp 1 --at 1 --model dipole", "--surface-albedo is 1"),
        ("profile --surface-albedo 0.8 --mfp 1 --at 1 --terms 2", "--terms is for --model gaussians"),
        ("profile --surface-albedo 0.8 --mfp 1 --at 1 --model gaussians --terms 7", "in [1, 6]"),
        ("profile --surface-albedo 0.8 --mfp 1 --at 1 --model gaussians --terms 0", "in [1, 6]"),
        ("profile --sigma-a 1 --at 1 --model dipole", "--sigma-s"),
        ("profile --sigma-a -1 --sigma-s 1 --at 1 --model dipole", "--sigma-a is -1"),
        ("profile --sigma-a 1 --sigma-s 1 --mfp 1 --at 1 --model dipole", "--mfp"),
        ("profile --surface-albedo 0.8 --mfp 1 --at 1 --table missing.csv", "missing.csv"),
        ("profile --surface-albedo 0.8 --mfp 1 --at 1 --table a.csv --model dipole", "--model"),
        ("profile --surface-albedo 0.8 --mfp 1 --at 1 --model normalised-diffusion", "normalized-diffusion"),
        ("profile --surface-albedo 0.8 --mfp 1 --at 1 --configuration searchlite", "searchlight"),
        ("profile --surface-albedo 0.8 --mfp 1 --at 1 --format xml", "csv"),
        ("profile --surface-albdo 0.8 --mfp 1 --at 1", "--surface-albedo"),
        ("profile --surface-albedo 0.8 --mfp 1 --at 1 -o missing-directory/a.csv", "missing-directory"),
        ("sample --surface-albedo 0.8 --mfp 1", "--count"),
        ("sample --surface-albedo 0.8 --mfp 1 --count -1", "-1"),
        ("sample --surface-albedo 0.8 --mfp 1 --count 1 --seed -1", "-1"),
        ("sampel --count 1", "sample"),
    ] {
        let output = run(&here(), words);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{words}: {message}");
        assert!(output.stdout.is_empty(), "{words}");
        assert!(message.contains(named), "{words}: {message}");
    }
}

#[test]
fn every_verb_explains_itself_with_an_example() {
    for words in
        ["--help", "render --help", "profile --help", "sample --help", "reference --help", "help profile"]
    {
        let help = stdout(&here(), words);
        assert!(help.contains("Example") && help.contains("\n  translucid "), "{words}: {help}");
    }
    assert!(stdout(&here(), "--version").starts_with("translucid "));
}
