//! Pictures and tables by other processors and other functions of the system: the same bits on every machine.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use crate::common::exr_values;

/// Machines, as what the command is run by: words before it, and a setting of the system's library.
const MACHINES: [(&str, &[&str], &str); 5] = [
    ("this", &[], ""),
    // The library then takes its functions for processors without these instructions
    ("this with glibc's plainer functions", &[], "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F,-SSE4_1"),
    ("one with AVX2", &["qemu-x86_64", "-cpu", "Haswell"], ""),
    ("one with SSE4.2", &["qemu-x86_64", "-cpu", "Nehalem"], ""),
    ("one with SSE2", &["qemu-x86_64", "-cpu", "qemu64"], ""),
];

/// Every kind of transport, surface, shape, light and image, small.
const SCENE: &str = r##"
unit = "cm"
[camera]
position = [0, 6, 16]
target = [0, 2, 0]
fov = 50
lens_radius = 0.1
[film]
size = [24, 16]
[integrator]
samples_per_pixel = 2
caustics = true
[[material]]
name = "walk"
subsurface_weight = 1
subsurface_color = "vertex"
subsurface_radius = 0.3
subsurface_scatter_anisotropy = 0.5
subsurface_model = "random-walk"
[[material]]
name = "oblique"
subsurface_weight = 0.8
subsurface_color = { file = "color.jpg" }
subsurface_radius = 0.2
subsurface_model = "normalized-diffusion-oblique"
coat_weight = 0.5
[[material]]
name = "photon-beam"
preset = "skin1"
subsurface_model = "normalized-diffusion"
[[material]]
name = "gloss"
base_color = "#a05030"
base_metalness = 0.5
specular_roughness = { file = "grey.jpg" }
[[material]]
name = "glass"
transmission_weight = 1
transmission_color = [0.8, 0.9, 0.7]
transmission_depth = 1
[[object]]
shape = "orange"
detail = 32
material = "walk"
translate = [-5, 0, 0]
rotate = [10, 20, 30]
[[object]]
shape = "sphere"
material = "oblique"
translate = [0, 1, 2]
[[object]]
shape = "torus"
material = "photon-beam"
translate = [4, 1, 0]
[[object]]
shape = "drinking-glass"
segments = 16
material = "glass"
translate = [4, 0, -6]
[[object]]
shape = "rectangle"
width = 60
height = 60
rotate = [-90, 0, 0]
material = "gloss"
[[light]]
type = "rectangle"
center = [-8, 12, 4]
target = [0, 1, 0]
size = [4, 4]
radiance = [20, 19, 17]
[[light]]
type = "sphere"
center = [6, 9, 6]
radius = 0.5
radiance = 60
[environment]
file = "color.jpg"
"##;

/// Commands whose tables are compared, as they are printed and as they are kept.
const TABLES: [&str; 6] = [
    "reference --method monte-carlo --surface-albedo 0.1,0.3 --g 0.6 --thickness 3 --eta 1.3 --incidence-angle 30 \
     --azimuth 60 --photons 3000..5000 --at 0.1,1 --table walk.npz",
    "reference --method monte-carlo --surface-albedo 0.5 --photons 4000 --at 1 --table matched.npz",
    "reference --method monte-carlo --single-scattering-albedo 0.9 --phase-function rayleigh --photons 2000 --at 1 \
     --table rayleigh.npz",
    "reference --method exact --surface-albedo 0.2,0.8 --at 0.1,1,10",
    "reference --method exact --single-scattering-albedo 0.9 --incidence-angle 60 --azimuth 30 --at 1",
    "sample --surface-albedo 0.8 --mfp 1 --count 50",
];

/// All that a machine makes, by name.
type Made = BTreeMap<String, Vec<u8>>;

fn make(words: &[&str], tunables: &str) -> Made {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path();
    let images = Path::new(env!("CARGO_MANIFEST_DIR")).join("../translucid-load/tests/data");
    for image in ["color.jpg", "grey.jpg"] {
        std::fs::copy(images.join(image), path.join(image)).unwrap();
    }
    std::fs::write(path.join("scene.toml"), SCENE).unwrap();

    let program = env!("CARGO_BIN_EXE_translucid");
    let run = |line: &str| {
        let mut all = words.iter().copied().chain([program]).chain(line.split_whitespace());
        let mut command = Command::new(all.next().unwrap());
        command.args(all).current_dir(path).env("GLIBC_TUNABLES", tunables);
        let output = command.output().unwrap_or_else(|error| panic!("{words:?}: {error}"));
        assert!(output.status.success(), "{words:?} {line}: {}", String::from_utf8_lossy(&output.stderr));
        output.stdout
    };
    let mut made = Made::new();
    run("render scene.toml -q -o picture.exr");
    for (channel, values) in exr_values(&path.join("picture.exr")) {
        made.insert(format!("picture, {channel}"), values.into_iter().flat_map(u32::to_le_bytes).collect());
    }
    for line in TABLES {
        made.insert(line.to_owned(), run(&format!("{line} -q")));
    }
    let models = String::from_utf8(run("models")).unwrap();
    for model in models.lines().filter_map(|line| line.split_whitespace().next()) {
        // Walks have no profile, and layers that of a scene
        if model.starts_with("random-walk") || ["none", "default", "layers"].contains(&model) {
            continue;
        }
        let line = format!("profile --model {model} --surface-albedo 0.7 --mfp 1 --at 0.01,0.3,3,30");
        made.insert(line.clone(), run(&line));
    }
    for name in ["walk.npz", "matched.npz", "rayleigh.npz"] {
        made.insert(name.to_owned(), std::fs::read(path.join(name)).unwrap());
    }
    made
}

#[test]
#[ignore = "emulates other processors; .ci/bits installs what that takes and runs it"]
fn every_machine_makes_the_same_bits() {
    let all = std::thread::scope(|scope| {
        let makers = MACHINES.map(|(_, words, tunables)| scope.spawn(move || make(words, tunables)));
        makers.map(|maker| maker.join().unwrap())
    });
    let [expected, others @ ..] = &all;
    assert!(expected.len() > 20, "{:?}", expected.keys());
    let mut differing = Vec::new();
    for ((machine, ..), found) in MACHINES[1..].iter().zip(others) {
        assert!(found.keys().eq(expected.keys()));
        for (name, bytes) in expected.iter().filter(|(name, bytes)| found[*name] != **bytes) {
            let count = bytes.iter().zip(&found[name]).filter(|(a, b)| a != b).count();
            differing.push(format!("{machine}: {name}, {count} of {} bytes", bytes.len()));
        }
    }
    assert!(differing.is_empty(), "{}", differing.join("\n"));
}
