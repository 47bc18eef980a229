//! `translucid fit`: the contract that scripts depend on.

use std::fs;
use std::process::Output;
use std::sync::LazyLock;

use crate::common::{files, run, signal, start, stderr, stdout};
use crate::markdown::root;
use translucid_profile::NormalizedDiffusion;

const BURLEY: &str = "fit --configuration searchlight --parameter mfp --family burley";

/// Result of [`BURLEY`], which many tests need.
static PRINTED: LazyLock<Output> = LazyLock::new(|| run(&here(), BURLEY));

/// Standard output of [`BURLEY`].
fn printed() -> &'static str {
    assert_eq!(PRINTED.status.code(), Some(0), "{}", stderr(&PRINTED));
    std::str::from_utf8(&PRINTED.stdout).unwrap()
}

fn here() -> std::path::PathBuf {
    std::env::temp_dir()
}

fn numbers(csv: &str) -> Vec<Vec<f64>> {
    csv.lines().skip(1).map(|line| line.split(',').map(|number| number.parse().unwrap()).collect()).collect()
}

#[test]
fn burley_prints_the_best_scale_of_every_albedo() {
    let csv = printed();
    assert_eq!(csv.lines().next(), Some("surface_albedo,s,error"));
    let rows = numbers(csv);
    assert_eq!(rows.len(), 99);
    for (i, row) in rows.iter().enumerate() {
        assert_eq!(row[0], (i + 1) as f64 / 100.0);
    }
    let known = [3.950, 2.972, 2.359, 1.921, 1.594, 1.333, 1.132, 0.955, 0.816];
    for (i, s) in known.into_iter().enumerate() {
        assert!((rows[10 * i + 9][1] / s - 1.0).abs() < 0.006, "{:?}", rows[10 * i + 9]);
    }
    assert_eq!(stdout(&here(), BURLEY), csv);
}

#[test]
fn burley_reports_both_polynomials_with_their_errors() {
    for (options, talk, stated) in [
        ("--configuration searchlight --parameter mfp", "s = 1.85 - A + 7 |A - 0.8|^3", "5.47, 18.06 (0.99)"),
        ("--configuration diffuse --parameter mfp", "s = 1.9 - A + 3.5 (A - 0.8)^2", "3.86, 13.35 (0.99)"),
        ("--configuration searchlight --parameter dmfp", "s = 3.5 + 100 (A - 0.33)^4", "7.63, 88.55 (0.99)"),
    ] {
        let words = format!("fit {options} --family burley");
        let report = if words == BURLEY { stderr(&PRINTED) } else { stderr(&run(&here(), &words)) };
        for part in [talk, stated, "fitted: s = ", "r <= 8", "r <= 16", "all r"] {
            assert!(report.contains(part), "{part} is missing in\n{report}");
        }
    }
}

/// The range of radii over which the talk's mean errors come out within half a point is said, not left to the reader.
#[test]
fn burley_without_a_case_is_all_cases_of_the_talk() {
    let output = run(&here(), "fit --family burley");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let report = stderr(&output);
    for stated in [
        "the talk states a mean error of about 5.5 %: 5.47 % over r <= 16\n",
        "the talk states a mean error of about 3.9 %: 3.86 % over r <= 8\n",
        "the talk states a mean error of about 7.7 %: 7.63 % over all r\n",
    ] {
        assert!(report.contains(stated), "{stated} is missing in\n{report}");
    }
    let csv = String::from_utf8(output.stdout).unwrap();
    assert_eq!(csv.lines().next(), Some("configuration,parameter,surface_albedo,s,error"));
    assert_eq!(csv.lines().count(), 1 + 3 * 99);
    // The case alone has the same numbers
    let one = printed();
    let ours = csv.lines().filter_map(|line| line.strip_prefix("searchlight,mfp,"));
    assert!(one.lines().skip(1).eq(ours));

    let directory = tempfile::tempdir().unwrap();
    stdout(directory.path(), "fit --family burley -o all");
    let read = |name: &str| fs::read_to_string(directory.path().join("all").join(name)).unwrap();
    assert_eq!(read("points.csv"), csv);
    assert_eq!(read("coefficients.csv").lines().count(), 1 + 3 * 2);
    assert!(read("coefficients.csv").contains("\ndiffuse,mfp,talk,1.9,1,3.5,0.8,2\n"));
    assert_eq!(read("errors.csv").lines().count(), 1 + 3 * 9);
    assert_eq!(read("report.txt").matches("the talk states").count(), 3);
}

/// Mean over all albedos of the error over all radii: below that of normalized diffusion, and falling.
#[test]
fn exponentials_print_weights_and_rates() {
    for (terms, most) in [(1, 0.3), (2, 0.04)] {
        let words = format!(
            "fit --configuration searchlight --parameter mfp --family exponentials --terms {terms} --format json"
        );
        let rows: Vec<serde_json::Value> = serde_json::from_str(&stdout(&here(), &words)).unwrap();
        assert_eq!(rows.len(), 99);
        let number = |row: &serde_json::Value, name: &str| row[name].as_f64().unwrap();
        for row in &rows {
            let weights: f64 = (1..=terms).map(|k| number(row, &format!("weight_{k}"))).sum();
            assert!((weights - 1.0).abs() < 1e-12, "{row}");
            assert!((1..=terms).all(|k| number(row, &format!("rate_{k}")) > 0.0), "{row}");
        }
        let mean = rows.iter().map(|row| number(row, "error")).sum::<f64>() / 99.0;
        assert!(mean < most, "{terms}: {mean}");
    }
}

#[test]
fn directory_takes_all_tables() {
    let directory = tempfile::tempdir().unwrap();
    assert_eq!(stdout(directory.path(), &format!("{BURLEY} -o a/b")), "");
    let made = directory.path().join("a/b");
    assert_eq!(files(&made), ["coefficients.csv", "errors.csv", "points.csv", "report.txt"]);
    let read = |name: &str| fs::read_to_string(made.join(name)).unwrap();
    assert_eq!(read("points.csv"), printed());
    let coefficients = read("coefficients.csv");
    assert_eq!(coefficients.lines().next(), Some("fit,constant,slope,factor,center,power"));
    assert_eq!(coefficients.lines().last(), Some("talk,1.85,1,7,0.8,3"));
    let errors = read("errors.csv");
    assert_eq!(errors.lines().next(), Some("fit,r_max,mean_error,worst_error,worst_surface_albedo"));
    assert_eq!(errors.lines().count(), 10);
    assert!(errors.contains("\ntalk,8,0.048"), "{errors}");
    assert!(errors.contains("\ntalk,,0.062"), "{errors}");
}

/// With fewer radii that count, the error over them can only be less.
#[test]
fn max_radius_is_the_range_of_the_error() {
    let all = numbers(printed());
    let near = numbers(&stdout(&here(), &format!("{BURLEY} --max-radius 8")));
    let mean = |rows: &[Vec<f64>]| rows.iter().map(|row| row[2]).sum::<f64>() / 99.0;
    assert!((mean(&near) - 0.0406).abs() < 1e-4 && (mean(&all) - 0.0500).abs() < 1e-4);
}

#[test]
fn wrong_input_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("file"), "").unwrap();
    for (words, part) in [
        ("fit", "--family"),
        ("fit --family burley --configuration diffuse", "--parameter is missing"),
        ("fit --family burley --parameter mfp", "--configuration is missing"),
        ("fit --family exponentials", "--configuration is missing"),
        ("fit --configuration searchlight --parameter mfp --family gaussians", "gaussians"),
        ("fit --configuration oblique --parameter mfp --family burley", "oblique"),
        (&format!("{BURLEY} --terms 2"), "--terms is for"),
        (&format!("{BURLEY} --max-radius 0"), "--max-radius is 0"),
        (&format!("{BURLEY} --max-radius -1"), "--max-radius is -1"),
        (&format!("{BURLEY} --max-radius nan"), "--max-radius is NaN"),
        (&format!("{BURLEY} -o file"), "cannot make the directory"),
        (&format!("{BURLEY} -o file/below"), "cannot make the directory"),
        ("fit --configuration diffuse --parameter mfp --family exponentials --terms 0", "0"),
        ("fit --configuration diffuse --parameter mfp --family exponentials --terms 9", "9"),
    ] {
        let output = run(directory.path(), words);
        assert_eq!(output.status.code(), Some(2), "{words}: {}", stderr(&output));
        assert!(stderr(&output).contains(part) && output.stdout.is_empty(), "{words}: {}", stderr(&output));
    }
    assert_eq!(files(directory.path()), ["file"]);
}

/// A table of normalized diffusion, A = 0.6 and d = 2, with the errors given and noise within them.
fn measured(with_errors: bool) -> String {
    let truth = NormalizedDiffusion::from_d(0.6, 2.0).unwrap();
    let mut state = 5u64;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let mut text = String::from(if with_errors { "r,reflectance,error\n" } else { "r,reflectance\n" });
    for i in 1..=60 {
        let r = 0.3 * f64::from(i);
        let error = 0.02 * truth.eval(r);
        // Twelve uniform numbers make a normal one
        let noise = (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
        let reflectance = truth.eval(r) + error * noise;
        text += &if with_errors {
            format!("{r},{reflectance},{error}\n")
        } else {
            format!("{r},{reflectance}\n")
        };
    }
    text
}

/// Value and standard error of a parameter.
fn estimate(csv: &str, fit: &str, parameter: &str) -> [f64; 2] {
    let start = format!("{fit},{parameter},");
    let line = csv.lines().find_map(|line| line.strip_prefix(&start)).unwrap();
    let numbers: Vec<f64> = line.split(',').map(|text| text.parse().unwrap_or(f64::INFINITY)).collect();
    [numbers[0], numbers[1]]
}

/// Each of the four within 4 standard errors: a false alarm has a probability of 3e-4.
#[test]
fn table_is_recovered_within_the_errors() {
    let directory = tempfile::tempdir().unwrap();
    for with_errors in [true, false] {
        fs::write(directory.path().join("table.csv"), measured(with_errors)).unwrap();
        let csv = stdout(directory.path(), "fit --table table.csv");
        assert_eq!(csv.lines().next(), Some("fit,parameter,value,standard_error"));
        for (parameter, truth) in [("surface_albedo", 0.6), ("d", 2.0)] {
            let [value, error] = estimate(&csv, "normalized-diffusion", parameter);
            assert!((value - truth).abs() < 4.0 * error && error < 0.02 * truth, "{value} {error}");
        }
        // Two exponentials hold the truth, too: scales d and 3d
        let [narrow, wide] = ["scale_1", "scale_2"].map(|name| estimate(&csv, "exponentials", name));
        assert!((narrow[0] - 2.0).abs() < 4.0 * narrow[1] && (wide[0] - 6.0).abs() < 4.0 * wide[1]);
        assert!(estimate(&csv, "gaussians", "standard_deviation_1")[0] > 0.0);
    }
}

#[test]
fn table_goes_to_a_directory() {
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("table.csv"), measured(true)).unwrap();
    let printed = stdout(directory.path(), "fit --table table.csv --terms 1");
    assert_eq!(stdout(directory.path(), "fit --table table.csv --terms 1 -o out"), "");
    let out = directory.path().join("out");
    assert_eq!(files(&out), ["parameters.csv", "report.txt", "residuals.csv", "residuals.svg"]);
    assert_eq!(fs::read_to_string(out.join("parameters.csv")).unwrap(), printed);
    let residuals = fs::read_to_string(out.join("residuals.csv")).unwrap();
    let header = "r,reflectance,error,normalized_diffusion_residual,exponentials_residual,gaussians_residual";
    assert_eq!(residuals.lines().next(), Some(header));
    // χ² of 58 degrees of freedom is within 4 standard deviations of 58 with a probability of 1 - 3e-4
    let chi_square: f64 = numbers(&residuals).iter().map(|row| row[3] * row[3]).sum();
    assert!((chi_square - 58.0).abs() < 43.0, "{chi_square}");
    let drawn = fs::read_to_string(out.join("residuals.svg")).unwrap();
    for words in ["normalized-diffusion", "exponentials", "gaussians", "±1 standard error"] {
        assert!(drawn.contains(&format!(">{words}<")), "{words} is not in the figure");
    }
}

#[test]
fn parameters_that_the_table_does_not_determine_are_warned_about() {
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("table.csv"), measured(true)).unwrap();
    let output = run(directory.path(), "fit --table table.csv --terms 4");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains("exponentials: the samples do not determine"), "{}", stderr(&output));
    assert!(!stderr(&output).contains("warning: normalized-diffusion"), "{}", stderr(&output));
    assert!(stderr(&output).contains(" not determined\n"), "{}", stderr(&output));
    assert!(!stderr(&output).contains("inf\n"), "{}", stderr(&output));
    // One Gaussian is nothing like it
    let output = run(directory.path(), "fit --table table.csv --terms 1");
    assert!(stderr(&output).contains("gaussians: misses the samples"), "{}", stderr(&output));
}

/// The table that comes with MCML, of the medium σ_a = 10/cm, σ_s = 90/cm below n = 1.5: both within 4 standard errors, a false
/// alarm of a table of other photons with a probability of 1.3e-4.
#[test]
fn published_table_gives_back_its_coefficients() {
    let table = root().join("benches/measure/published/mcml-sample-1b.csv");
    let directory = tempfile::tempdir().unwrap();
    fs::copy(&table, directory.path().join("table.csv")).unwrap();
    let words = "fit --table table.csv --family half-space";
    let output = run(directory.path(), &format!("{words} --eta 1.5"));
    assert!(!stderr(&output).contains("warning"), "{}", stderr(&output));
    let csv = String::from_utf8(output.stdout).unwrap();
    for (parameter, truth, part) in
        [("sigma_a", 10.0, 0.02), ("sigma_s_prime", 90.0, 0.02), ("mfp", 0.01, 0.02)]
    {
        let [value, error] = estimate(&csv, "half-space", parameter);
        assert!(
            (value - truth).abs() < 4.0 * error && error < part * truth,
            "{parameter}: {value} ± {error}"
        );
    }
    // Without the boundary nothing of the kind explains it
    let output = run(directory.path(), words);
    assert!(stderr(&output).contains("half-space: misses the samples"), "{}", stderr(&output));

    for (words, says) in [
        ("fit --table table.csv --family exponentials", "--family is half-space with --table"),
        ("fit --table table.csv --configuration diffuse", "--configuration is for --family half-space"),
        ("fit --table table.csv --eta 1.5", "--eta is for --family half-space"),
        ("fit --table table.csv --family half-space --terms 2", "--terms is for sums"),
        ("fit --table table.csv --family half-space --eta 9", "eta"),
        ("fit --family half-space", "--family half-space fits a --table"),
    ] {
        let output = run(directory.path(), words);
        assert_eq!(output.status.code(), Some(2), "{words}: {}", stderr(&output));
        assert!(stderr(&output).contains(says), "{words}: {}", stderr(&output));
    }
}

/// Gamma is 1 in MCML's table, whose scattering is isotropic: it and the coefficients are within 4 standard errors, a false alarm
/// of a table of other photons with a probability of 2e-4. Its far rings leave gamma open.
#[test]
fn gamma_of_a_published_table_is_that_of_isotropic_scattering() {
    let table = fs::read_to_string(root().join("benches/measure/published/mcml-sample-1b.csv")).unwrap();
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("table.csv"), &table).unwrap();
    let words = "fit --table table.csv --family half-space --eta 1.5 --gamma";
    let output = run(directory.path(), &format!("{words} -o out"));
    assert!(output.status.success() && !stderr(&output).contains("warning"), "{}", stderr(&output));
    let out = directory.path().join("out");
    assert_eq!(
        files(&out),
        ["correlations.csv", "parameters.csv", "report.txt", "residuals.csv", "residuals.svg"]
    );
    let csv = fs::read_to_string(out.join("parameters.csv")).unwrap();
    for (parameter, truth, most) in
        [("sigma_a", 10.0, 0.5), ("sigma_s_prime", 90.0, 5.0), ("mfp", 0.01, 5e-4), ("gamma", 1.0, 0.1)]
    {
        let [value, error] = estimate(&csv, "half-space", parameter);
        assert!((value - truth).abs() < 4.0 * error && error < most, "{parameter}: {value} ± {error}");
    }
    let correlations = fs::read_to_string(out.join("correlations.csv")).unwrap();
    let rows: Vec<Vec<&str>> = correlations.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows[0], ["parameter", "sigma_a", "sigma_s_prime", "gamma"]);
    assert!(rows[3][0] == "gamma" && rows[3][2] == rows[2][3], "{correlations}");
    let report = fs::read_to_string(out.join("report.txt")).unwrap();
    assert!(report.contains("correlation of sigma_s_prime and gamma: "), "{report}");

    let far = table
        .lines()
        .filter(|line| line.split(',').next().and_then(|r| r.parse().ok()).is_none_or(|r: f64| r > 0.06));
    fs::write(directory.path().join("table.csv"), far.collect::<Vec<_>>().join("\n")).unwrap();
    let output = run(directory.path(), words);
    let told = "half-space: gamma is not determined by these radii: its standard error is ";
    assert!(stderr(&output).contains(told), "{}", stderr(&output));

    for (words, says) in [
        ("fit --table table.csv --gamma", "--gamma is for --family half-space"),
        ("fit --family burley --gamma", "--gamma is for --family half-space"),
        (
            "fit --table table.csv --family half-space --configuration diffuse --gamma",
            "--gamma is for --configuration searchlight, but it is diffuse",
        ),
    ] {
        let output = run(directory.path(), words);
        assert_eq!(output.status.code(), Some(2), "{words}: {}", stderr(&output));
        assert!(stderr(&output).contains(says), "{words}: {}", stderr(&output));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn interrupted_half_space_leaves_nothing_behind() {
    let table = root().join("benches/measure/published/mcml-sample-1b.csv");
    let temporary = tempfile::tempdir().unwrap();
    let words = format!("fit --family half-space --eta 1.5 -o new --table {}", table.display());
    let child = start(temporary.path(), &words);
    // It takes more than twenty seconds
    let output = signal(child, "-INT", || temporary.path().join("new").exists());
    assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
    assert!(stderr(&output).contains("nothing was written"), "{}", stderr(&output));
    assert!(files(temporary.path()).is_empty());
}

#[test]
fn wrong_tables_are_refused_with_their_line() {
    let directory = tempfile::tempdir().unwrap();
    let good = "1,1\n2,0.3\n3,0.1\n4,0.05\n5,0.02\n";
    for (text, part) in [
        (format!("r,value\n{good}"), "no column \"reflectance\""),
        (format!("r,r,reflectance\n{good}"), "two columns \"r\""),
        (format!("r,reflectance\n{good}x,1\n"), "table.csv:7"),
        (format!("r,reflectance\n{good}6,-1\n"), "reflectance is -1"),
        (format!("r,reflectance\n{good}6,nan\n"), "reflectance is \"nan\""),
        (format!("r,reflectance\n{good}0,1\n"), "r is \"0\""),
        (format!("r,reflectance\n{good}6\n"), "table.csv:7"),
        (String::from("r,reflectance,error\n1,1,0\n"), "error is \"0\""),
        (String::from("r,reflectance\n1,1\n2,0.5\n"), "there are 2 samples"),
        (String::new(), "no column"),
        (String::from("surface_albedo,r,reflectance\n0.5,1,1\n0.6,1,1\n"), "another surface_albedo"),
    ] {
        fs::write(directory.path().join("table.csv"), &text).unwrap();
        let output = run(directory.path(), "fit --table table.csv");
        assert_eq!(output.status.code(), Some(2), "{text}: {}", stderr(&output));
        assert!(stderr(&output).contains(part) && output.stdout.is_empty(), "{text}: {}", stderr(&output));
    }
    for words in ["fit --table none.csv", "fit --table .", "fit --table table.csv --family burley"] {
        assert_eq!(run(directory.path(), words).status.code(), Some(2), "{words}");
    }
}
