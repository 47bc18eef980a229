//! Time and memory of a mesh of ten million triangles, from a PLY file to a picture.
//!
//! ```text
//! cargo bench -p translucid-workbench --bench huge_mesh [-- --triangles 10000000]
//! ```
//!
//! The mesh is a ring with bumps, written to a temporary file that is removed in the end, triangles in rows as a scanner
//! would have them.
//! Another process loads and renders it as `translucid render mesh.ply --preset marble` would, 256² at one sample per
//! pixel, on all cores, and prints after each step the seconds it took and the most memory it has had so far.

#![allow(clippy::print_stdout, reason = "the table is the bench's output")]

use std::f32::consts::TAU;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::time::Instant;

use translucid_load::{LoadOptions, load_scene};
use translucid_render::{FilmSums, PreparedScene, internals};
use translucid_testing::cpu_seconds;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let value = |option: &str| arguments.get(arguments.iter().position(|a| a == option)? + 1);
    if let Some(path) = value("--render") {
        return render(Path::new(path));
    }
    let triangles = value("--triangles").and_then(|n| n.parse().ok()).unwrap_or(10_000_000_u64);
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("ring.ply");
    write_ring(&path, triangles).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let program = std::env::current_exe().expect("this program's own path");
    let status = std::process::Command::new(program).arg("--render").arg(&path).status();
    assert!(status.is_ok_and(|status| status.success()), "the rendering failed");
}

fn render(path: &Path) {
    println!("| step | s | CPU s | peak memory, MB |");
    println!("|---|---|---|---|");
    let step = |name: &str, start: (Instant, f64)| {
        let (wall, cpu) = (start.0.elapsed().as_secs_f64(), cpu_seconds() - start.1);
        println!("| {name} | {wall:.2} | {cpu:.2} | {:.0} |", peak_memory() as f64 * 1e-6);
    };
    let now = || (Instant::now(), cpu_seconds());

    let start = now();
    let options =
        LoadOptions { preset: Some("marble".into()), size: Some([256, 256]), ..LoadOptions::default() };
    let scene = load_scene(path, &options, &mut Vec::new()).unwrap_or_else(|error| panic!("{error}"));
    let triangles: usize = scene.objects.iter().map(|object| object.mesh.triangles.len()).sum();
    step("load", start);
    let start = now();
    let renderer = PreparedScene::new(scene).expect("a valid scene");
    step("prepare", start);
    let start = now();
    let mut film = FilmSums::new(256, 256);
    internals::add_samples(&renderer, &mut film, 1).expect("a valid view");
    step("render", start);
    println!(
        "{triangles} triangles, {:.0} bytes of peak memory each",
        peak_memory() as f64 / triangles as f64
    );
}

/// Writes a ring with bumps, of at least so many triangles.
fn write_ring(path: &Path, triangles: u64) -> std::io::Result<()> {
    let rows = (triangles as f64 / 8.0).sqrt().ceil() as u32;
    let columns = 4 * rows;
    let mut file = BufWriter::new(std::fs::File::create(path)?);
    write!(
        file,
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n\
         property float z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
        rows * columns,
        2 * rows * columns
    )?;
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        let (u, v) = (TAU * row as f32 / rows as f32, TAU * column as f32 / columns as f32);
        let bump = 0.3 * ((9.0 * u).sin() * (40.0 * v).sin() + 0.2 * (60.0 * u).sin() * (250.0 * v).cos());
        let (radius, height) = (40.0 + (10.0 + bump) * u.cos(), (10.0 + bump) * u.sin());
        for x in [radius * v.cos(), radius * v.sin(), height] {
            file.write_all(&x.to_le_bytes())?;
        }
    }
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        let at = |row: u32, column: u32| (row % rows) * columns + column % columns;
        let [a, b] = [at(row, column), at(row, column + 1)];
        let [c, d] = [at(row + 1, column + 1), at(row + 1, column)];
        for [i, j, k] in [[a, b, c], [a, c, d]] {
            file.write_all(&[3])?;
            file.write_all(bytemuck::cast_slice(&[i.to_le(), j.to_le(), k.to_le()]))?;
        }
    }
    file.flush()
}

/// Most memory that the process has had, in bytes; 0 where the system does not report it.
fn peak_memory() -> u64 {
    let kilobytes = |text: String| -> Option<u64> {
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
        line.split_whitespace().next()?.parse().ok()
    };
    std::fs::read_to_string("/proc/self/status").ok().and_then(kilobytes).map_or(0, |kb| kb * 1024)
}
