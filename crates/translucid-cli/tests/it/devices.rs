//! `translucid devices`, and `reference --device`.

use crate::common::{run, stderr, stdout};

const WALK: &str = "reference --method monte-carlo --single-scattering-albedo 0.9 --at 1 --photons 1e4";

/// The message of a command that is refused.
fn refused(folder: &std::path::Path, words: &str) -> String {
    let output = run(folder, words);
    assert_eq!(output.status.code(), Some(2), "{words}: {}", stderr(&output));
    stderr(&output)
}

#[test]
fn the_processor_is_the_default() {
    let folder = tempfile::tempdir().unwrap();
    let list = stdout(folder.path(), "devices");
    assert!(list.starts_with("cpu: "), "{list}");
    assert_eq!(stdout(folder.path(), &format!("{WALK} --device cpu")), stdout(folder.path(), WALK));
    let message = refused(folder.path(), "reference --surface-albedo 0.5 --at 1 --device gpu");
    assert!(message.contains("--device belongs to the walk"), "{message}");
}

#[cfg(not(feature = "gpu"))]
#[test]
fn a_build_without_devices_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let listed = run(folder.path(), "devices");
    assert!(stderr(&listed).starts_with("note: this build"), "{}", stderr(&listed));
    let message = refused(folder.path(), &format!("{WALK} --device gpu"));
    assert!(message.contains("this build of translucid knows no graphics processors"), "{message}");
    let walked = run(folder.path(), &format!("{WALK} --device auto"));
    assert!(stderr(&walked).contains("note: the processor walks: this build"), "{}", stderr(&walked));
    assert_eq!(String::from_utf8_lossy(&walked.stdout), stdout(folder.path(), WALK));
}

/// On the device that `TRANSLUCID_DEVICE` names.
#[cfg(feature = "gpu")]
#[test]
fn devices_walk_continue_and_keep_to_themselves() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let device =
        std::env::var("TRANSLUCID_DEVICE").expect("a name or a part of one that `translucid devices` prints");
    assert!(stdout(folder, "devices").to_lowercase().contains(&device), "{device}");
    let walk = format!("{WALK} --device {device}");
    stdout(folder, &format!("{walk} -o whole.npz"));
    stdout(folder, &walk.replace("1e4", "0..4e3 -o part.npz"));
    stdout(folder, &format!("{walk} --table part.npz --resume"));
    let bytes = |name: &str| std::fs::read(folder.join(name)).unwrap();
    assert_eq!(bytes("part.npz"), bytes("whole.npz"));

    // The processor's photons are others, and just as many
    let message = refused(folder, &WALK.replace("1e4", "2e4 --table part.npz --resume"));
    assert!(message.contains("were walked by a device, and those of a processor are not added"), "{message}");
    assert_eq!(bytes("part.npz"), bytes("whole.npz"));
    let rows = [walk.as_str(), WALK].map(|line| {
        let table = stdout(folder, line);
        table
            .lines()
            .nth(1)
            .unwrap()
            .split(',')
            .map(|word| word.parse().unwrap_or(f64::NAN))
            .collect::<Vec<f64>>()
    });
    let z = (rows[0][3] - rows[1][3]) / rows[0][5].hypot(rows[1][5]);
    assert!(z.abs() < 4.5 && z != 0.0, "{rows:?}");

    let message = refused(folder, &format!("{WALK} --device nonesuch"));
    assert!(message.contains("there is no device \"nonesuch\", but: "), "{message}");
    let message = refused(folder, &format!("{walk} --g 0.99999"));
    assert!(message.contains("g is 0.99999, but a device walks with g in [-0.9999, 0.9999]"), "{message}");
}

/// A ball under an even sky.
const BALL: &str = "unit = \"mm\"\n[[material]]\nname = \"m\"\nsubsurface_weight = 1.0\n[[object]]\nshape = \"sphere\"\nmaterial = \"m\"\n\
                    [environment]\nradiance = 1\n";
const RENDER: &str = "render ball.toml --size 16x12 --spp 4 -o ball.exr";

#[cfg(not(feature = "gpu"))]
#[test]
fn pictures_are_the_processors_without_devices() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("ball.toml"), BALL).unwrap();
    let message = refused(folder.path(), &format!("{RENDER} --device gpu"));
    assert!(message.contains("this build of translucid knows no graphics processors"), "{message}");
    assert!(!folder.path().join("ball.exr").exists());
    let rendered = run(folder.path(), &format!("{RENDER} --device auto"));
    assert!(rendered.status.success() && stderr(&rendered).contains("the processor traces: this build"));
}

/// On the device that `TRANSLUCID_DEVICE` names.
#[cfg(feature = "gpu")]
#[test]
fn devices_render_and_refuse_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let device = std::env::var("TRANSLUCID_DEVICE").expect("a name or a part of one");
    std::fs::write(folder.join("ball.toml"), BALL).unwrap();
    stdout(folder, &format!("{RENDER} --device {device}"));
    assert!(folder.join("ball.exr").exists() && folder.join("ball.png").exists());
    let points = RENDER.replace("ball.exr", "points.exr");
    let message = refused(folder, &format!("{points} --device {device} --subsurface-method point-based"));
    assert!(message.contains("integrator.subsurface_method is not \"ray-traced\""), "{message}");
    assert!(!folder.join("points.exr").exists());
    let message = refused(folder, &format!("{RENDER} --device nonesuch"));
    assert!(message.contains("there is no device \"nonesuch\""), "{message}");
}
