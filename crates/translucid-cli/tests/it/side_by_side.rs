//! `translucid render --subsurface a,b,c`: one scene with several models.

use std::collections::HashMap;
use std::fs;
use std::path::Path;

use crate::common::{BALL, directory_with_ball, exr_values, files, run, signal, start, stderr, stdout};

const HEADER: &str = "model,against,samples,seconds,cpu_seconds,relative_mse,noise,mean_flip,max_flip";

/// The rows of errors.csv: the fields of each by the names of their columns.
fn errors(directory: &Path) -> Vec<HashMap<String, String>> {
    let text = fs::read_to_string(directory.join("errors.csv")).unwrap();
    assert_eq!(text.lines().next(), Some(HEADER));
    let names = || HEADER.split(',').map(str::to_owned);
    text.lines().skip(1).map(|line| names().zip(line.split(',').map(str::to_owned)).collect()).collect()
}

fn number(row: &HashMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("{column} of {row:?}"))
}

/// Width, height and red, green and blue of a PNG with eight bits and no alpha.
fn png(path: &Path) -> ([u32; 2], Vec<u8>) {
    let mut reader =
        png::Decoder::new(std::io::BufReader::new(fs::File::open(path).unwrap())).read_info().unwrap();
    let mut codes = vec![0; reader.output_buffer_size().unwrap()];
    let frame = reader.next_frame(&mut codes).unwrap();
    assert_eq!(frame.color_type, png::ColorType::Rgb);
    ([frame.width, frame.height], codes)
}

/// The pixels of every picture in a directory, by file; the metadata of OpenEXR has the time.
fn pictures(directory: &Path) -> HashMap<String, Vec<u8>> {
    let pixels = |name: &String| match name.ends_with(".exr") {
        true => format!("{:?}", exr_values(&directory.join(name))).into_bytes(),
        false => fs::read(directory.join(name)).unwrap(),
    };
    let names = files(directory).into_iter();
    let names = names.filter(|name| name.ends_with(".exr") || name.ends_with(".png"));
    names.map(|name| (name.clone(), pixels(&name))).collect()
}

#[test]
fn several_models_are_rendered_and_compared() {
    let (_keep, directory) = directory_with_ball();
    let output = run(&directory, "render ball.toml --subsurface dipole,exact,none --threads 2");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    for part in ["dipole (1 of 3)", "exact (2 of 3)", "none (3 of 3)", "index.html"] {
        assert!(stderr(&output).contains(part), "{}", stderr(&output));
    }
    assert_eq!(files(&directory), ["ball-side-by-side", "ball.toml"]);
    let found = directory.join("ball-side-by-side");
    let mut expected: Vec<String> = ["errors.csv", "index.html", "sheet.svg"].map(String::from).into();
    for model in ["dipole", "exact", "none"] {
        expected.extend([".exr", ".png", "-flip.png", "-difference.png"].map(|end| format!("{model}{end}")));
    }
    expected.sort();
    assert_eq!(files(&found), expected);

    // The pictures are those that one model alone gives
    stdout(&directory, "render ball.toml -q --subsurface dipole -o alone.exr");
    assert_eq!(exr_values(&directory.join("alone.exr")), exr_values(&found.join("dipole.exr")));
    assert_eq!(fs::read(directory.join("alone.png")).unwrap(), fs::read(found.join("dipole.png")).unwrap());

    // The table: exact is the judge, and no difference from itself
    let rows = errors(&found);
    assert_eq!(rows.iter().map(|row| row["model"].as_str()).collect::<Vec<_>>(), ["dipole", "exact", "none"]);
    for row in &rows {
        assert_eq!((row["against"].as_str(), row["samples"].as_str()), ("exact", "8"));
        assert!(number(row, "seconds") > 0.0 && number(row, "noise") > 0.0, "{row:?}");
        let error = number(row, "relative_mse");
        let [mean, max] = ["mean_flip", "max_flip"].map(|column| number(row, column));
        match row["model"].as_str() {
            "exact" => assert_eq!([error, mean, max], [0.0; 3]),
            _ => assert!(error > 0.0 && 0.0 < mean && mean < max && max <= 1.0, "{row:?}"),
        }
    }

    // Maps are pictures, and the sheet has all
    let size = [40, 24];
    assert!(png(&found.join("exact-difference.png")) == (size, vec![255; 3 * 40 * 24]));
    assert!(png(&found.join("exact-flip.png")) == (size, [0, 0, 4].repeat(40 * 24)));
    assert_ne!(png(&found.join("dipole-flip.png")), png(&found.join("exact-flip.png")));
    let sheet = fs::read_to_string(found.join("sheet.svg")).unwrap();
    // Three pictures, two maps of each but the judge, two scales
    assert_eq!(sheet.matches("<image ").count(), 3 + 4 + 2);
    assert!(["dipole", "exact", "none"].iter().all(|model| sheet.contains(&format!(">{model}<"))));
    let page = fs::read_to_string(found.join("index.html")).unwrap();
    assert!(page.contains("Side by side: ball.toml") && page.matches("<img ").count() == 7);
    assert!(!page.contains("src=\"http") && page.contains("data:image/png;base64,"));
}

/// relMSE from the OpenEXR files, by another way than the command's.
#[test]
fn errors_are_those_of_the_images() {
    let (_keep, directory) = directory_with_ball();
    stdout(&directory, "render ball.toml -q --subsurface dipole,none --against none -o two");
    let channels = |model: &str| -> HashMap<String, Vec<f32>> {
        let values = exr_values(&directory.join(format!("two/{model}.exr"))).into_iter();
        values.map(|(name, bits)| (name, bits.into_iter().map(f32::from_bits).collect())).collect()
    };
    let [dipole, none] = ["dipole", "none"].map(channels);
    let (mut sum, mut count) = (0.0, 0.0);
    for i in (0..40 * 24).filter(|&i| none["A"][i] > 0.0) {
        for channel in ["R", "G", "B"] {
            let [x, truth] = [&dipole, &none].map(|image| f64::from(image[channel][i]));
            sum += (x - truth).powi(2) / (truth * truth + 0.01);
            count += 1.0;
        }
    }
    let row = &errors(&directory.join("two"))[0];
    assert!((number(row, "relative_mse") / (sum / count) - 1.0).abs() < 1e-9, "{row:?} {}", sum / count);
}

#[test]
fn models_that_change_nothing_have_no_error() {
    let (_keep, directory) = directory_with_ball();
    fs::write(
        directory.join("plain.toml"),
        BALL.replace("subsurface_weight = 1.0", "subsurface_weight = 0.0"),
    )
    .unwrap();
    stdout(&directory, "render plain.toml -q --spp 1 --subsurface dipole,gaussians,none -o plain");
    for row in errors(&directory.join("plain")) {
        let zeros = ["relative_mse", "mean_flip", "max_flip"].map(|column| number(&row, column));
        assert_eq!((zeros, row["against"].as_str(), row["noise"].as_str()), ([0.0; 3], "dipole", ""));
    }
}

#[test]
fn wrong_options_are_refused_before_the_work() {
    let (_keep, directory) = directory_with_ball();
    fs::write(directory.join("file"), "precious").unwrap();
    let before = files(&directory);
    let many = vec!["dipole"; 17].join(",");
    let many = format!("render ball.toml --subsurface {many}");
    for (words, named) in [
        ("render ball.toml --subsurface dipole,exact -o a.exr", "a.exr, but several models"),
        ("render ball.toml --subsurface dipole,exact -o a.PNG", "directory"),
        ("render ball.toml --subsurface dipole,exact,dipole -o two", "dipole twice"),
        ("render ball.toml --subsurface dipole,dipol -o two", "dipole"),
        ("render ball.toml --subsurface dipole, -o two", "--subsurface"),
        ("render ball.toml --subsurface dipole,exact --against none -o two", "--against is none"),
        ("render ball.toml --subsurface dipole --against dipole -o two.exr", "--against"),
        ("render ball.toml --subsurface dipole,exact -o file", "file"),
        ("render ball.toml --subsurface dipole,exact -o file/two", "file"),
        ("render ball.toml --subsurface dipole,exact --size 16384x16384", "16777216"),
        ("render missing.toml --subsurface dipole,exact -o two", "missing.toml"),
        (&many, "17 models"),
    ] {
        let output = run(&directory, words);
        assert_eq!(output.status.code(), Some(2), "{words}: {}", stderr(&output));
        assert!(stderr(&output).contains(named), "{words}: {}", stderr(&output));
        assert_eq!(files(&directory), before, "{words}");
    }
}

#[test]
fn files_of_others_are_spared() {
    let (_keep, directory) = directory_with_ball();
    let words = "render ball.toml -q --spp 1 --subsurface dipole,none -o two";
    for name in ["sheet.svg", "none.exr", "dipole-flip.png", "errors.csv", "index.html"] {
        fs::create_dir_all(directory.join("two")).unwrap();
        fs::write(directory.join("two").join(name), "precious").unwrap();
        let output = run(&directory, words);
        assert_eq!(output.status.code(), Some(2), "{name}: {}", stderr(&output));
        assert!(stderr(&output).contains(name) && stderr(&output).contains("-o DIR"), "{}", stderr(&output));
        assert_eq!(fs::read(directory.join("two").join(name)).unwrap(), b"precious");
        assert_eq!(files(&directory.join("two")), [name]);
        fs::remove_dir_all(directory.join("two")).unwrap();
    }
    // Its own are replaced, and a picture that the scene reads is not
    stdout(&directory, words);
    stdout(&directory, words);
    let scene = BALL.replace("[0.8, 0.5, 0.3]", "{ file = \"two/dipole.png\" }");
    fs::write(directory.join("textured.toml"), scene).unwrap();
    let output = run(&directory, "render textured.toml -q --spp 1 --subsurface dipole,none -o two");
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("overwritten"), "{}", stderr(&output));
    // Nor does another verb take the page for one of its own
    let output = run(&directory, "compare --models dipole --photons 0 --samples 0 -o two");
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
}

/// Every model is cut off in its turn; what comes in the end is what comes undisturbed.
#[test]
fn resumed_work_ends_in_the_same_pictures() {
    let (_keep, directory) = directory_with_ball();
    let words = "render ball.toml -q --size 64x48 --spp 12 --subsurface dipole,none,gaussians";
    stdout(&directory, &format!("{words} --threads 2 -o whole"));
    // A part of every picture: of the first beyond its half, of the second before, of the third nothing
    let parts = directory.join("parts");
    stdout(&directory, &format!("{words} --resume -o parts"));
    for name in files(&parts).iter().filter(|name| !name.contains("dipole") || name.contains("half")) {
        fs::remove_file(parts.join(name)).unwrap();
    }
    let few = words.replace("--spp 12", "--spp 4").replace(",gaussians", "");
    stdout(&directory, &format!("{few} --resume -o parts"));
    let output = run(&directory, &format!("{} --threads 1 --resume -o parts", words.replace(" -q", "")));
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains("continuing from 12") && stderr(&output).contains("continuing from 4"));
    assert_eq!(pictures(&directory.join("whole")), pictures(&parts));
    // The first had no half any more, and so no estimate of the noise; the second got there on its way
    let rows = errors(&parts);
    assert_eq!((rows[0]["noise"].as_str(), rows[0]["cpu_seconds"].as_str()), ("", ""));
    assert!(parts.join("none.half.checkpoint").exists() && parts.join("dipole.exr.checkpoint").exists());
}

/// The first half is found again by those who go on in the second.
#[test]
fn resumed_work_knows_its_noise() {
    let (_keep, directory) = directory_with_ball();
    let words = "render ball.toml -q --subsurface dipole,none --resume -o two";
    stdout(&directory, words);
    let before: Vec<f64> = errors(&directory.join("two")).iter().map(|row| number(row, "noise")).collect();
    stdout(&directory, words);
    let after: Vec<f64> = errors(&directory.join("two")).iter().map(|row| number(row, "noise")).collect();
    assert_eq!(before, after);
    // Without --resume nothing is kept
    stdout(&directory, &words.replace("--resume", ""));
    assert!(!files(&directory.join("two")).iter().any(|name| name.contains("checkpoint")));
}

#[test]
fn time_is_for_each_model_and_for_all_runs_together() {
    let (_keep, directory) = directory_with_ball();
    let words = "render ball.toml -q --time 0.3 --subsurface dipole,none --resume -o two";
    stdout(&directory, words);
    let before = errors(&directory.join("two"));
    for row in &before {
        assert!(number(row, "samples") > 0.0 && row["noise"].is_empty(), "{row:?}");
        assert!(number(row, "seconds") > 0.25, "{row:?}");
    }
    stdout(&directory, words);
    let samples = |rows: &[HashMap<String, String>]| -> Vec<f64> {
        rows.iter().map(|row| number(row, "samples")).collect()
    };
    let (before, after) = (samples(&before), samples(&errors(&directory.join("two"))));
    // The time was up: at most what a tile takes to find that out is added, to hundreds of samples unless the machine is busy
    let is_same = |(before, after): (&f64, &f64)| *after < 1.5 * before + 16.0;
    assert!(before.iter().zip(&after).all(is_same), "{before:?} {after:?}");
}

#[cfg(target_os = "linux")]
#[test]
fn interrupt_keeps_what_there_is_and_the_way_on() {
    let (_keep, directory) = directory_with_ball();
    let words = "render ball.toml --spp 120 --size 80x56 --subsurface none,dipole -o two";
    let interrupted = || signal(start(&directory, words), "-INT", || directory.join("two/none.png").exists());
    let mut output = interrupted();
    // A busy machine may have come too late for the second picture
    while output.status.success() {
        fs::remove_dir_all(directory.join("two")).unwrap();
        output = interrupted();
    }
    assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
    assert!(stderr(&output).contains("--resume"), "{}", stderr(&output));
    let found = files(&directory.join("two"));
    assert!(
        found.contains(&String::from("none.exr.checkpoint")) && !found.contains(&String::from("index.html"))
    );
    let output = run(&directory, &format!("{words} --resume"));
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains("continuing from 120"), "{}", stderr(&output));
    stdout(&directory, &words.replace("-o two", "-q -o whole"));
    assert_eq!(pictures(&directory.join("two")), pictures(&directory.join("whole")));
}
