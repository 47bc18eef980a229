//! `translucid compare`: the contract that scripts depend on.

use std::collections::HashMap;
use std::fs;
use std::path::Path;

use crate::common::{files, run, signal, start, stderr, stdout};
use translucid_fit::l1_error;
use translucid_profile::{
    Appearance, Configuration, ExactProfile, Model, Parameterization, Profile, fresnel_from_inside,
    schlick_from_outside,
};

/// Two models at one albedo: a second or two of work.
const SMALL: &str = "compare --models normalized-diffusion,dipole --surface-albedo 0.5 --configuration searchlight \
                     --photons 1e5 --samples 2000 --timing-rounds 2 --max-radius 8";
/// Without the model that s(A) is for, without photons and times: less.
const SMALLER: &str = "compare --models dipole --surface-albedo 0.5 --configuration searchlight --photons 0 \
                       --samples 0 --timing-rounds 0";

const APPEARANCE: Appearance =
    Appearance { surface_albedo: 0.5, length: 1.0, parameterization: Parameterization::Mfp, g: 0.0 };

/// The lines of a table by their first fields, and what follows those.
fn rows(directory: &Path, file: &str, header: &str) -> Vec<Vec<String>> {
    let text = fs::read_to_string(directory.join(file)).unwrap();
    assert_eq!(text.lines().next(), Some(header), "{file}");
    text.lines().skip(1).map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

fn number(text: &str) -> f64 {
    text.parse().unwrap_or_else(|_| panic!("{text} is no number"))
}

fn contents(directory: &Path) -> HashMap<String, Vec<u8>> {
    files(directory).into_iter().map(|name| (name.clone(), fs::read(directory.join(name)).unwrap())).collect()
}

/// Tells whether a file is about times, or the page that shows them.
fn is_timed(name: &str) -> bool {
    name.starts_with("error-against-time-") || ["timing.csv", "times.csv", "index.html"].contains(&name)
}

#[test]
fn numbers_are_those_of_the_library() {
    let temporary = tempfile::tempdir().unwrap();
    assert_eq!(stdout(temporary.path(), &format!("{SMALL} -o one --threads 1")), "");
    let one = temporary.path().join("one");
    let models = [Model::NormalizedDiffusion, Model::Dipole];
    let profile = |name: &str| {
        let model = models.into_iter().find(|model| model.name() == name).unwrap();
        model.profile(&APPEARANCE, Configuration::Searchlight, 1.0).unwrap()
    };

    // Errors, against the exact solution's table
    let mfp = Parameterization::Mfp;
    let exact = ExactProfile::new(0.5, 1.0, mfp, Configuration::Searchlight).unwrap();
    let errors = rows(&one, "errors.csv", "model,configuration,medium,surface_albedo,r_max,error");
    assert_eq!(errors.len(), 3 * 3 * 99);
    for model in models {
        for (r_max, radius) in [("8", 8.0), ("16", 16.0), ("", f64::INFINITY)] {
            let key = [model.name(), "searchlight", "own", "0.5", r_max];
            let row = errors.iter().find(|row| row[..5] == key).unwrap();
            let expected = l1_error(&*profile(model.name()), &exact, radius);
            assert!((number(&row[5]) - expected).abs() < 1e-5, "{row:?} {expected}");
        }
    }
    assert!(errors.iter().any(|row| row[..3] == ["dipole", "searchlight", "exact"]));

    // Curves
    let header = "configuration,surface_albedo,model,r,reflectance,enclosed";
    let curves = rows(&one, "reflectance.csv", header);
    assert_eq!(curves.len(), 3 * 200);
    for row in curves.iter().filter(|row| row[2] != "exact-solution") {
        let [r, reflectance, enclosed] = [3, 4, 5].map(|i| number(&row[i]));
        let profile = profile(&row[2]);
        assert!((reflectance / profile.eval(r) - 1.0).abs() < 1e-12, "{row:?}");
        assert!((enclosed - profile.enclosed(r)).abs() < 1e-12, "{row:?}");
    }

    // Photons: none of some 18 rings is off by 4.5 standard errors, with a false-alarm rate of 1e-4
    let header =
        "configuration,surface_albedo,single_scattering_albedo,r,reflectance,standard_error,exact,photons";
    let rings = rows(&one, "monte-carlo.csv", header);
    assert!((12..=20).contains(&rings.len()), "{}", rings.len());
    for row in &rings {
        let [alpha, r, reflectance, error, expected] = [2, 3, 4, 5, 6].map(|i| number(&row[i]));
        assert!((alpha - 0.938171938710).abs() < 1e-9);
        assert!((reflectance - expected).abs() < 4.5 * error, "{row:?}");
        assert!((expected / exact.eval(r) - 1.0).abs() < 2e-3, "{row:?}");
    }

    // Boundary: every eighth of a degree, from inside also where these go to, which is 0 in both
    let fresnel = rows(&one, "fresnel.csv", "side,eta,degrees,fresnel,schlick");
    assert_eq!(fresnel.len(), 3 * (721 + 721 + 720));
    for row in &fresnel {
        let [eta, degrees, exact, approximate] = [1, 2, 3, 4].map(|i| number(&row[i]));
        let cos_theta = degrees.to_radians().cos();
        match row[0].as_str() {
            "inside" => assert_eq!(exact, fresnel_from_inside(cos_theta, eta)),
            _ => assert_eq!(approximate, schlick_from_outside(cos_theta, eta)),
        }
    }

    // s(A), histograms, times
    let scaling = rows(&one, "scaling.csv", "configuration,parameter,surface_albedo,s,error");
    let half = scaling.iter().find(|row| row[..3] == ["searchlight", "mfp", "0.5"]).unwrap();
    assert!((number(&half[3]) - 1.594).abs() < 0.002, "{half:?}");
    let samples = rows(&one, "samples.csv", "model,surface_albedo,left,right,count,expected");
    let of_dipole = samples.iter().filter(|row| row[0] == "dipole");
    assert_eq!(of_dipole.map(|row| number(&row[4])).sum::<f64>(), 2000.0);
    let timing = rows(&one, "timing.csv", "model,quantity,nanoseconds,median_nanoseconds,rounds");
    assert_eq!(timing.len(), 2 * 8);
    assert!(timing.iter().all(|row| number(&row[2]) > 0.0 && number(&row[2]) <= number(&row[3])));

    page_is_self_contained(&one);
    // The same again over the files of the first, on two threads
    let before = contents(&one);
    stdout(temporary.path(), &format!("{SMALL} -o one --threads 2"));
    let after = contents(&one);
    assert_eq!(before.len(), after.len());
    for (name, content) in before {
        assert!(after[&name] == content || is_timed(&name), "{name} differs");
    }
}

/// The page needs nothing but itself, links to files that are there, and shows every chart.
fn page_is_self_contained(directory: &Path) {
    let page = fs::read_to_string(directory.join("index.html")).unwrap();
    for foreign in ["<script", "<link", "<img", "src=", "@import", "url(", "https://"] {
        assert!(!page.contains(foreign), "{foreign}");
    }
    let names = files(directory);
    let mut linked = 0;
    for link in page.split("href=\"").skip(1).map(|rest| rest.split('"').next().unwrap()) {
        match link.strip_prefix('#') {
            Some(anchor) => assert!(page.contains(&format!("id=\"{anchor}\"")), "{link}"),
            None => {
                assert!(names.iter().any(|name| name == link), "{link} is not there");
                linked += 1;
            }
        }
    }
    let charts = names.iter().filter(|name| name.ends_with(".svg")).count();
    assert!(charts >= 15 && page.matches("<figure").count() == charts && linked > 2 * charts, "{charts}");
    for name in names.iter().filter(|name| name.ends_with(".svg")) {
        let stem = name.trim_end_matches(".svg");
        assert!(names.contains(&format!("{stem}.csv")), "{stem}");
        assert!(fs::read_to_string(directory.join(name)).unwrap().starts_with("<svg"));
    }
    // What the numbers say of the talk; in tables a percent sign stays with its number
    let page = page.replace("\u{a0}%", " %");
    for part in
        ["normalized-diffusion is closer than dipole", "confirmed", "about", "5.47 %", "3.86 %", "7.63 %"]
    {
        assert!(page.contains(part), "{part}");
    }
    assert!(!page.contains("NaN") && !page.contains("inf "));
}

#[test]
fn wrong_input_is_refused_before_anything_is_written() {
    let temporary = tempfile::tempdir().unwrap();
    let path = temporary.path();
    fs::write(path.join("file"), "").unwrap();
    fs::create_dir(path.join("site")).unwrap();
    fs::write(path.join("site/index.html"), "<html>mine</html>").unwrap();
    fs::create_dir(path.join("data")).unwrap();
    fs::write(path.join("data/errors.csv"), "mine").unwrap();
    fs::create_dir(path.join("trap")).unwrap();
    fs::create_dir(path.join("trap/timing.csv")).unwrap();
    let before = files(path);
    for (options, part) in [
        ("--models dipol", "dipole"),
        ("--models dipole,dipole", "--models has dipole twice"),
        ("--models", "--models"),
        ("--models normalized-diffusion-oblique", "normalized-diffusion-refined"),
        ("--models dipole --configuration diffuse", "a perpendicular pencil beam only"),
        ("--surface-albedo 0", "--surface-albedo is 0, but must be"),
        ("--surface-albedo 1.5", "--surface-albedo is 1.5"),
        ("--surface-albedo -0.5", "--surface-albedo is -0.5"),
        ("--surface-albedo nan", "--surface-albedo is NaN"),
        ("--surface-albedo 0.5,x", "x"),
        ("--surface-albedo 0.5,0.2,0.5", "--surface-albedo has 0.5 twice"),
        (
            "--surface-albedo .1,.2,.3,.4,.5,.6,.7,.8,.9,.11,.12,.13,.14,.15,.16,.17,.18,.19,.21,.22,.23",
            "21 values",
        ),
        ("--configuration oblique", "oblique"),
        ("--max-radius 0", "--max-radius is 0, but must be"),
        ("--max-radius 1e9", "--max-radius is 1000000000"),
        ("--max-radius nan", "--max-radius is NaN"),
        ("--photons many", "many"),
        ("--photons -1", "-1"),
        ("--samples 1e3", "1e3"),
        ("--threads 0", "0"),
        ("--seed x", "x"),
        ("-o file", "cannot make the directory"),
        ("-o file/below", "cannot make the directory"),
        ("-o site", "was not made by translucid"),
        ("-o data", "was not made by translucid"),
        ("-o trap", "is a directory, not a file"),
    ] {
        let output = run(path, &format!("compare {options}"));
        assert_eq!(output.status.code(), Some(2), "{options}: {}", stderr(&output));
        assert!(stderr(&output).contains(part) && output.stdout.is_empty(), "{options}: {}", stderr(&output));
        assert_eq!(files(path), before, "{options}");
    }
    assert_eq!(fs::read_to_string(path.join("site/index.html")).unwrap(), "<html>mine</html>");
    assert_eq!(fs::read_to_string(path.join("data/errors.csv")).unwrap(), "mine");
}

#[test]
fn a_users_files_stay_and_the_default_directory_is_comparison() {
    let temporary = tempfile::tempdir().unwrap();
    fs::create_dir(temporary.path().join("comparison")).unwrap();
    fs::write(temporary.path().join("comparison/notes.txt"), "mine").unwrap();
    stdout(temporary.path(), SMALLER);
    let directory = temporary.path().join("comparison");
    assert_eq!(fs::read_to_string(directory.join("notes.txt")).unwrap(), "mine");
    let names = files(&directory);
    assert!(
        names.iter().any(|name| name == "index.html") && !names.iter().any(|name| name.contains(".part"))
    );
    // Nothing of what was not asked for
    let page = fs::read_to_string(directory.join("index.html")).unwrap();
    assert!(page.contains("No photons walked"));
    assert!(!names.iter().any(|name| name.starts_with("error-against-time-")));
    assert!(
        !names.iter().any(|name| name.starts_with("scaling-searchlight") || name.starts_with("sampling-"))
    );
}

#[cfg(target_os = "linux")]
#[test]
fn interrupt_leaves_nothing_behind() {
    let temporary = tempfile::tempdir().unwrap();
    let child = start(temporary.path(), "compare -o new --photons 1e12 --timing-rounds 0 --threads 1");
    let output = signal(child, "-INT", || temporary.path().join("new").exists());
    assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
    assert!(files(temporary.path()).is_empty());
}
