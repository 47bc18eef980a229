//! `translucid reference`: the contract that scripts depend on.

use crate::common::{cpu_seconds, files, run, send, signal, start, stderr, stdout, translucid};
use translucid_reference::Incidence;
use translucid_reference::exact::HalfSpace;
use translucid_testing::power;

const HEADER: &str = "surface_albedo,single_scattering_albedo,r,reflectance,enclosed,standard_error";

fn here() -> std::path::PathBuf {
    std::env::temp_dir()
}

/// The table that a command prints, its header checked.
fn table(words: &str) -> Vec<[f64; 6]> {
    let csv = stdout(&here(), &format!("reference {words}"));
    assert_eq!(csv.lines().next(), Some(HEADER), "{words}");
    let row = |line: &str| {
        let numbers: Vec<f64> = line.split(',').map(|number| number.parse().unwrap()).collect();
        numbers.try_into().unwrap()
    };
    csv.lines().skip(1).map(row).collect()
}

#[test]
fn exact_prints_the_numbers_of_the_library() {
    for (options, eta, incidence) in [
        ("--configuration searchlight", 1.0, Incidence::NORMAL),
        ("--configuration diffuse", 1.0, Incidence::Cosine),
        ("", 1.0, Incidence::Cosine),
        ("--configuration searchlight --eta 1.4", 1.4, Incidence::NORMAL),
        ("--incidence-angle 0", 1.0, Incidence::NORMAL),
    ] {
        let rows = table(&format!("--method exact --single-scattering-albedo 0.9,0.5 {options} --at 0.1,1"));
        assert_eq!(rows.len(), 4, "{options}");
        for (row, (albedo, r)) in rows.iter().zip([(0.9, 0.1), (0.9, 1.0), (0.5, 0.1), (0.5, 1.0)]) {
            let solution = HalfSpace::with_boundary(albedo, eta, incidence).unwrap();
            let (reflectance, enclosed) = (solution.eval(r), solution.enclosed(r));
            let total = solution.total().value;
            let expected = [total, albedo, r, reflectance.value, enclosed.value, reflectance.error];
            assert_eq!(row, &expected, "{options}");
            assert!(row[5] < 1e-6 * row[3], "{options}: {row:?}");
        }
    }
}

/// Numbers of an independent solution.
#[test]
fn exact_prints_known_numbers() {
    let searchlight = table(
        "--method exact --configuration searchlight --single-scattering-albedo 0.5,0.9,0.99 --at 0.1,1",
    );
    for (row, [total, reflectance]) in searchlight.iter().zip([
        [0.11522587770720, 0.27160357244],
        [0.11522587770720, 5.2531991084e-3],
        [0.41494747913082, 0.56107802802],
        [0.41494747913082, 2.1217649785e-2],
        [0.75272071716030, 0.64361446601],
        [0.75272071716030, 3.1387826006e-2],
    ]) {
        assert!((row[0] - total).abs() < 1e-13 && (row[3] / reflectance - 1.0).abs() < 1e-10, "{row:?}");
    }
    // A = ½, whose energies within a radius are known to six digits
    let half = table("--method exact --configuration searchlight --surface-albedo 0.5 --at 0.1,1,5,20");
    for (row, enclosed) in half.iter().zip([0.041267, 0.253274, 0.474759, 0.499984]) {
        assert!((row[1] - 0.938171938710).abs() < 1e-11 && row[0] == 0.5, "{row:?}");
        assert!((row[4] - enclosed).abs() < 6e-7, "{row:?}");
    }
    let glass =
        table("--method exact --configuration searchlight --single-scattering-albedo 0.9 --eta 1.4 --at 1");
    assert!((glass[0][0] - 0.25775574626).abs() < 1e-10 && (glass[0][3] / 1.159402e-2 - 1.0).abs() < 1e-6);
}

#[test]
fn surface_albedo_leads_to_the_single_scattering_albedo() {
    for options in ["--configuration searchlight", "", "--eta 1.4", "--incidence-angle 60"] {
        for row in table(&format!("--method exact --surface-albedo 0.05,0.5,0.9 {options} --at 1e9")) {
            // Within so large a radius is everything
            assert!((row[4] / row[0] - 1.0).abs() < 1e-9, "{options}: {row:?}");
        }
    }
}

/// Nine photon tables against the exact method: |z| < 4.5 for 30 numbers, false alarm 2e-4.
///
/// The others are sums over photons, whose standard errors are below 1e-3 with the fewest of them.
#[test]
fn both_methods_print_the_same() {
    for options in [
        "--configuration searchlight --single-scattering-albedo 0.3,0.9",
        "--configuration diffuse --surface-albedo 0.5",
        "--configuration searchlight --eta 1.4 --single-scattering-albedo 0.9",
        "--incidence-angle 60 --single-scattering-albedo 0.9",
        "--incidence-angle 60 --azimuth 5 --single-scattering-albedo 0.9",
        "--incidence-angle 45 --azimuth 180 --single-scattering-albedo 0.9",
        "--incidence-angle 60 --azimuth 0 --single-scattering-albedo 0.9",
        "--incidence-angle 60 --azimuth -33.3 --single-scattering-albedo 0.9",
        "--configuration diffuse --mfp 0.25 --single-scattering-albedo 0.95",
    ] {
        let options = format!("{options} --at 0.5,1,3");
        let exact = table(&format!("--method exact {options}"));
        let walk = table(&format!("--method monte-carlo {options} --photons {} --seed 5", power(2_000_000)));
        assert_eq!(exact.len(), walk.len());
        for (exact, walk) in exact.iter().zip(&walk) {
            assert_eq!(exact[1..3], walk[1..3], "{options}");
            assert!((exact[0] - walk[0]).abs() < 4e-3, "{options}: {exact:?} {walk:?}");
            // A ring of ±2 % is not its center
            let allowed = 4.5 * walk[5] + 1e-3 * exact[3];
            assert!((exact[3] - walk[3]).abs() < allowed, "{options}: {exact:?} {walk:?}");
            assert!((exact[4] - walk[4]).abs() < 4e-3, "{options}: {exact:?} {walk:?}");
        }
    }
}

#[test]
fn lengths_scale_with_the_mean_free_path() {
    for method in ["exact", "monte-carlo --photons 1e5"] {
        let options = format!("--method {method} --configuration searchlight --single-scattering-albedo 0.9");
        let one = table(&format!("{options} --at 0.5,4"));
        let four = table(&format!("{options} --mfp 4 --at 2,16"));
        for (one, four) in one.iter().zip(&four) {
            assert_eq!(
                (one[2] * 4.0, one[3] / 16.0, one[4], one[5] / 16.0),
                (four[2], four[3], four[4], four[5])
            );
        }
    }
}

#[test]
fn walk_depends_on_seed_and_photons_alone() {
    let words = "--method monte-carlo --single-scattering-albedo 0.9 --g 0.5 --photons 200000 --at 1,2";
    let one = table(&format!("{words} --threads 1"));
    assert_eq!(one, table(&format!("{words} --threads 3 --seed 0")));
    assert_ne!(one, table(&format!("{words} --seed 1")));
}

#[test]
fn walk_reaches_the_error_that_is_asked_for() {
    let rows = table("--method monte-carlo --surface-albedo 0.3,0.6 --g 0.5 --error 0.02 --at 0.5,2");
    assert_eq!(rows.len(), 4);
    let worst = rows.iter().map(|row| row[5] / row[3]).fold(0.0, f64::max);
    assert!(worst <= 0.02 && worst > 0.01, "{worst}");
}

#[test]
fn tables_are_kept_continued_and_joined() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path();
    let walk = "reference --method monte-carlo --single-scattering-albedo 0.9 --at 1";
    let at_once = stdout(path, &format!("{walk} --photons 300000"));

    // Continued
    stdout(path, &format!("{walk} --photons 100000 --table a.npz"));
    assert_eq!(stdout(path, &format!("{walk} --photons 300000 --table a.npz --resume")), at_once);
    // Nothing more to walk: the same answer, the same file
    let bytes = std::fs::read(path.join("a.npz")).unwrap();
    assert_eq!(stdout(path, &format!("{walk} --photons 300000 --table a.npz --resume")), at_once);
    assert_eq!(std::fs::read(path.join("a.npz")).unwrap(), bytes);

    // Joined: two seeds in either order make the same file
    stdout(path, &format!("{walk} --photons 100000 --seed 1 --table b.npz"));
    let joined = stdout(path, &format!("{walk} --photons 0 --merge a.npz,b.npz --table ab.npz"));
    assert_eq!(stdout(path, &format!("{walk} --photons 0 --merge b.npz,a.npz --table ba.npz")), joined);
    assert_eq!(std::fs::read(path.join("ab.npz")).unwrap(), std::fs::read(path.join("ba.npz")).unwrap());
    assert_ne!(joined, at_once);

    // No photon counts twice
    let output = run(path, &format!("{walk} --photons 0 --merge a.npz,a.npz"));
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("twice"), "{}", stderr(&output));
    let output = run(path, &format!("{walk} --photons 0"));
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("--photons is 0, but no table"), "{}", stderr(&output));
    let output = run(path, &format!("{walk} --photons 10 --table a.npz"));
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("--resume"), "{}", stderr(&output));
    assert_eq!(std::fs::read(path.join("a.npz")).unwrap(), bytes);

    // A damaged file is named, and stays as it is
    std::fs::write(path.join("c.npz"), &bytes[..bytes.len() / 2]).unwrap();
    let output = run(path, &format!("{walk} --table c.npz --resume"));
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("c.npz"), "{}", stderr(&output));
    assert_eq!(files(path), ["a.npz", "ab.npz", "b.npz", "ba.npz", "c.npz"]);
}

/// Killed at whatever moment, a walk leaves the old table or the new one, whole, and goes on from it to the same bits.
#[test]
fn killed_walks_leave_whole_tables() {
    use std::process::Stdio;

    let directory = tempfile::tempdir().unwrap();
    let path = directory.path();
    let walk = "reference --method monte-carlo --single-scattering-albedo 0.9 --at 1 --photons";
    let start = std::time::Instant::now();
    stdout(path, &format!("{walk} 65000 --table whole.npz"));
    let duration = start.elapsed();
    for kill in 1..=12 {
        let words = format!("{walk} {} --table killed.npz --resume", 5000 * kill);
        let mut command = translucid(path);
        let child = command.args(words.split_whitespace()).stdout(Stdio::null()).stderr(Stdio::null());
        let mut child = child.spawn().unwrap();
        // Weyl's sequence leaves no moment out for long
        std::thread::sleep(duration.mul_f64((f64::from(kill) * 0.618_033_988_749_895).fract()));
        child.kill().unwrap();
        child.wait().unwrap();
    }
    stdout(path, &format!("{walk} 65000 --table killed.npz --resume"));
    let [whole, killed] = ["whole.npz", "killed.npz"].map(|name| std::fs::read(path.join(name)).unwrap());
    assert!(whole == killed);
    assert_eq!(files(path), ["killed.npz", "whole.npz"]);
}

#[cfg(target_os = "linux")]
#[test]
fn interrupted_walk_keeps_what_it_has() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path();
    let walk = "reference --method monte-carlo --single-scattering-albedo 0.9 --at 1 --table walk.npz";
    let child = start(path, &format!("{walk} --photons 1e15 --threads 1"));
    // Twice at once is once: some programs signal a process and its group
    let id = child.id();
    let output = signal(child, "-INT", || {
        let is_there = cpu_seconds(id) > 0.5;
        if is_there {
            send(id, "-INT");
        }
        is_there
    });
    assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
    assert!(stderr(&output).contains("--resume"), "{}", stderr(&output));
    // What was found so far is printed, and is what the file says
    let printed = String::from_utf8(output.stdout).unwrap();
    assert_eq!(printed.lines().count(), 2, "{printed}");
    assert_eq!(stdout(path, &format!("{walk} --photons 0 --resume")), printed);
}

/// Every wrong command line: exit code 2, nothing on stdout, and the message names what is in brackets.
#[test]
fn wrong_options_are_refused_with_a_reason() {
    for (words, named) in [
        ("", "--at"),
        ("--at 1", "--surface-albedo"),
        ("--surface-albedo 0.5 --single-scattering-albedo 0.5 --at 1", "cannot be used with"),
        ("--surface-albedo 0.5,1 --at 1", "--surface-albedo has 1,"),
        ("--surface-albedo 0 --at 1", "--surface-albedo has 0,"),
        ("--single-scattering-albedo 1.1 --at 1", "--single-scattering-albedo has 1.1,"),
        ("--single-scattering-albedo nan --at 1", "NaN"),
        ("--single-scattering-albedo 0.9 --at -1", "radius -1"),
        ("--single-scattering-albedo 0.9 --at 1 --mfp 0", "--mfp is 0"),
        ("--single-scattering-albedo 0.9 --at 1 --g 0.5", "monte-carlo"),
        ("--single-scattering-albedo 0.9 --at 1 --g 1 --method monte-carlo", "--g is 1"),
        ("--single-scattering-albedo 0.9 --at 1 --phase-function rayleigh", "monte-carlo"),
        ("--single-scattering-albedo 0.9 --at 1 --phase-function rayleigh --g 0.5", "--g is 0.5"),
        ("--single-scattering-albedo 0.9 --at 1 --phase-function moments:0.1", "outside of --layers"),
        ("--single-scattering-albedo 0.9 --at 1 --phase-function mie", "two-term:W,G1,G2"),
        ("--single-scattering-albedo 0.9 --at 1 --phase-function two-term:1,2", "two-term has 2 numbers"),
        ("--single-scattering-albedo 0.9 --at 1 --phase-function two-term:2,0,0", "weight of a two-term"),
        ("--single-scattering-albedo 0.9 --at 1 --phase-function moments:0.3334", "for a walk"),
        (
            "--single-scattering-albedo 0.9 --at 1 --phase-function moments:0.9",
            "no moments of a phase function",
        ),
        ("--single-scattering-albedo 0.9 --at 1 --phase-function none.csv", "cannot be read"),
        ("--single-scattering-albedo 0.9 --at 1 --phase-function none.csv --g 0.5", "--g is 0.5"),
        ("--single-scattering-albedo 0.9 --at 1 --thickness 2", "monte-carlo"),
        ("--single-scattering-albedo 0.9 --at 1 --thickness 0 --method monte-carlo", "--thickness is 0"),
        ("--single-scattering-albedo 0.9 --at 1 --spot-radius 1", "monte-carlo"),
        ("--single-scattering-albedo 0.9 --at 1 --spot-radius -1", "--spot-radius"),
        ("--single-scattering-albedo 0.9 --at 1 --side transmitted", "--thickness"),
        ("--single-scattering-albedo 0.9 --at 1 --eta 0", "--eta is 0"),
        ("--single-scattering-albedo 0.9 --at 1 --incidence-angle 90", "--incidence-angle is 90"),
        (
            "--single-scattering-albedo 0.9 --at 1 --incidence-angle 60 --configuration diffuse",
            "--incidence-angle",
        ),
        ("--single-scattering-albedo 0.9 --at 1 --incidence-angle 60 --eta 0.8", "53.1301"),
        ("--single-scattering-albedo 0.9 --at 1 --azimuth 60", "--incidence-angle"),
        ("--single-scattering-albedo 0.9 --at 1 --photons 1000", "--method monte-carlo"),
        ("--single-scattering-albedo 0.9 --at 1 --error 0.1", "--method monte-carlo"),
        ("--single-scattering-albedo 0.9 --at 1 --method monte-carlo --photons 1.5", "whole number"),
        ("--single-scattering-albedo 0.9 --at 1 --method monte-carlo --photons -1", "-1"),
        ("--single-scattering-albedo 0.9 --at 1 --method monte-carlo --error 0", "--error is 0"),
        ("--single-scattering-albedo 0.9 --at 1 --method monte-carlo --error 0.1 --photons 9", "--photons"),
        ("--single-scattering-albedo 0.9 --at 1 --method monte-carlo --resume", "--table"),
        ("--single-scattering-albedo 0.9 --at 1 --method monte-carlo --merge none.npz", "none.npz"),
        ("--single-scattering-albedo 0.9 --at 1 --method monte-carlo --table missing/a.npz", "missing"),
        ("--single-scattering-albedo 0.9 --at 0 --method monte-carlo", "radius is 0"),
        ("--single-scattering-albedo 1 --at 1 --method monte-carlo", "exact method"),
        ("--surface-albedo 0.9 --thickness 0.5 --at 1 --method monte-carlo", "reflects from 0.0000 to 0."),
        ("--surface-albedo 0.001 --eta 1.5 --thickness 0.5 --at 1 --method monte-carlo", "reflects from 0."),
        ("--surface-albedo 0.9999 --at 1 --method monte-carlo", "--surface-albedo has 0.9999"),
        ("--single-scattering-albedo 1e-200 --at 1 --method monte-carlo", "1e-100"),
        ("--single-scattering-albedo 0.9 --at 1 --mfp 1e200", "--mfp is 1e200"),
        ("--single-scattering-albedo 0.9 --at 1 --eta 4", "--method monte-carlo"),
        ("--single-scattering-albedo 0.9 --at 1 --seed 3", "--seed"),
        ("--single-scattering-albedo 0.9 --at 1 --threads 0", "--threads"),
        (
            "--single-scattering-albedo 0.9 --at 1 --method monte-carlo --table a.npz -o ./a.npz",
            "overwritten",
        ),
        ("--single-scattering-albedo 0.9 --points 1000000000 --max 1 --method monte-carlo", "too many"),
    ] {
        let output = run(&here(), &format!("reference {words}"));
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{words}: {message}");
        assert!(output.stdout.is_empty(), "{words}");
        assert!(message.contains(named), "{words}: {message}");
    }
}

/// Ranges walked apart and joined are bit for bit one run; a range goes on from where it was killed.
#[test]
fn ranges_of_photons_make_the_table_of_one_run() {
    use std::process::Stdio;

    let directory = tempfile::tempdir().unwrap();
    let path = directory.path();
    let walk = "reference --method monte-carlo --single-scattering-albedo 0.9 --at 1 -q";
    let printed = stdout(path, &format!("{walk} --photons 60000 --table whole.npz"));
    assert_eq!(stdout(path, &format!("{walk} --photons 2e4..45e3 -o b.npz")), "");
    for wait in [30, 60, 90] {
        let mut command = translucid(path);
        let words = format!("{walk} --photons 0..20000 -o a.npz --resume");
        let child = command.args(words.split_whitespace()).stdout(Stdio::null()).stderr(Stdio::null());
        let mut child = child.spawn().unwrap();
        std::thread::sleep(std::time::Duration::from_millis(wait));
        child.kill().unwrap();
        child.wait().unwrap();
    }
    stdout(path, &format!("{walk} --photons 0..20000 -o a.npz --resume"));
    // The rest is walked on top of the others
    let joined = stdout(path, &format!("{walk} --photons 45000..60000 --merge b.npz,a.npz --table all.npz"));
    assert_eq!(joined, printed);
    let [whole, all] = ["whole.npz", "all.npz"].map(|name| std::fs::read(path.join(name)).unwrap());
    assert!(whole == all);

    for (words, named) in [
        ("--photons 19999..45000 --merge a.npz", "hold 1 of these photons"),
        ("--photons 9..9", "--photons is 9..9"),
        ("--photons 9..5", "A is not greater than B"),
        ("--photons 0..9 --g 0.5 -o a.npz --resume", "another problem"),
        ("--photons 0..9 -o a.npz", "--resume"),
        ("--photons 0..9 -o a.npz --table b.npz", "--table is b.npz"),
        ("--photons 0..9 --error 0.1", "--error"),
    ] {
        let output = run(path, &format!("{walk} {words}"));
        assert_eq!(output.status.code(), Some(2), "{words}");
        assert!(stderr(&output).contains(named), "{words}: {}", stderr(&output));
    }
    let output = run(path, &format!("{} --photons 0..9 -o c.npz", walk.replace("monte-carlo", "exact")));
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(files(path), ["a.npz", "all.npz", "b.npz", "whole.npz"]);
}

const RUN: &str = "1\n1\nskin.mco A\n20000\n0.1 0.1\n5 4 3\n1\n1\n1.4 1 10 0.8 0.5\n1\n";

/// A folder with a file of MCML's.
fn folder_with(text: &str) -> tempfile::TempDir {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("in.mci"), text).unwrap();
    directory
}

/// The figures of the runs are those of the library, in an .mco file for each run, in one of another name, and in a table.
#[test]
fn layers_of_mcml_become_its_output() {
    use translucid_reference::mcml::parse_mci;
    use translucid_reference::walk::Control;

    let second = RUN.split_once("1\n1\n").unwrap().1.replace("skin", "tooth").replace("1.4 1", "1.6 3");
    let two = format!("1\n2\n{}{second}", RUN.split_once("1\n1\n").unwrap().1);
    let directory = folder_with(&two.replace('\n', "\r\n"));
    let path = directory.path();
    assert_eq!(stdout(path, "reference --layers in.mci --seed 5"), "");
    assert_eq!(files(path), ["in.mci", "skin.mco", "tooth.mco"]);
    let mut rows = 0;
    for run in parse_mci(two.as_bytes()).unwrap() {
        let result = run.walk(5, &Control::default()).unwrap();
        let text = std::fs::read_to_string(path.join(&run.output)).unwrap();
        assert_eq!(text, result.text());
        rows += 1 + result.figures().count();
    }

    let one = folder_with(RUN);
    stdout(one.path(), "reference --layers in.mci --seed 5 --threads 1 -o other.mco");
    assert_eq!(files(one.path()), ["in.mci", "other.mco"]);
    let [a, b] =
        [one.path().join("other.mco"), path.join("skin.mco")].map(|path| std::fs::read(path).unwrap());
    assert_eq!(a, b);

    stdout(path, "reference --layers in.mci --seed 5 --method monte-carlo -o all.csv");
    let table = std::fs::read_to_string(path.join("all.csv")).unwrap();
    assert_eq!(table.lines().next(), Some("run,quantity,layer,r,z,angle,value,standard_error"));
    assert_eq!(table.lines().count(), 1 + rows);
    assert!(table.contains("tooth.mco,Rd_ra,,"), "{table}");
}

/// Every wrong file and option: exit code 2, the message names what is in brackets, and no file is there that was not.
#[test]
fn layers_that_cannot_be_walked_are_refused() {
    let named = |name: &str| RUN.replace("skin.mco", name);
    for (text, options, message) in [
        (RUN.replace("0.8 0.5", "0.8 -1"), "", "in.mci:9"),
        (RUN.replace("0.8 0.5", "0.8"), "", "but must have 5"),
        (named("../skin.mco"), "", "in that of the .mci file"),
        (named("/elsewhere/skin.mco"), "", "in that of the .mci file"),
        (named("a\\skin.mco"), "", "in that of the .mci file"),
        (named(".."), "", "in that of the .mci file"),
        (named("in.mci"), "", "would be overwritten"),
        (named("thesis.tex"), "", "would be overwritten"),
        (RUN.to_owned(), "-o in.mci", "is the file that is read"),
        (RUN.to_owned(), "-o missing/skin.mco", "missing"),
        (RUN.to_owned(), "--method exact", "asks for photons"),
        (RUN.to_owned(), "--g 0.5", "--g"),
        (RUN.to_owned(), "--at 1", "--at"),
        (RUN.to_owned(), "--photons 100", "--photons"),
        (RUN.to_owned(), "--surface-albedo 0.5", "--surface-albedo"),
        (RUN.replace("1 10 0.8 0.5", "0.1 0.1 0.8 1e-12"), "", "in.mci:3"),
    ] {
        let directory = folder_with(&text);
        std::fs::write(directory.path().join("thesis.tex"), "years").unwrap();
        let output = run(directory.path(), &format!("reference --layers in.mci {options}"));
        let found = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{options} {text}: {found}");
        assert!(found.contains(message), "{options} {text}: {found}");
        assert_eq!(files(directory.path()), ["in.mci", "thesis.tex"]);
    }
    let two = RUN.replacen("1\n1\n", "1\n2\n", 1) + &named("other.mco")[4..];
    let output = run(folder_with(&two).path(), "reference --layers in.mci -o one.mco");
    assert!(stderr(&output).contains("has 2 runs"), "{}", stderr(&output));
    let output = run(&here(), "reference --layers none.mci");
    assert!(output.status.code() == Some(2) && stderr(&output).contains("none.mci"), "{}", stderr(&output));
}

#[test]
fn layers_warn_of_what_is_not_as_in_the_file() {
    let directory = folder_with(&RUN.replace("mco A", "mco B"));
    let output = run(directory.path(), "reference --layers in.mci");
    assert!(output.status.success() && stderr(&output).contains("written as text"), "{}", stderr(&output));
    let white = RUN.replace("20000", "1000").replace("1.4 1 10 0.8 0.5", "1.4 0 10 0.8 1e8");
    let directory = folder_with(&white);
    let output = run(directory.path(), "reference --layers in.mci");
    assert!(output.status.success() && stderr(&output).contains("given up"), "{}", stderr(&output));
}

#[cfg(target_os = "linux")]
#[test]
fn interrupted_layers_keep_whole_batches() {
    let directory = folder_with(&RUN.replace("20000", "100000000"));
    let child = start(directory.path(), "reference --layers in.mci");
    // Some batches, of 96
    let id = child.id();
    let output = signal(child, "-INT", || cpu_seconds(id) > 4.0);
    assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
    if let Ok(text) = std::fs::read_to_string(directory.path().join("skin.mco")) {
        let photons = text.lines().find(|line| line.contains("number of photons")).unwrap();
        let photons: u64 = photons.split_whitespace().next().unwrap().parse().unwrap();
        // 96 batches of about 2^20 photons, a third of which have one less than the others
        let is_whole =
            |done: u64| (100_000_000 / 96 * done..=(100_000_000 / 96 + 1) * done).contains(&photons);
        assert!((1..96).any(is_whole), "{photons}");
    }
}
