//! Laws of memory: how many bytes a picture takes for each triangle, texel and pixel more.
//!
//! Each law is the difference between the peaks of two runs on one thread, so that what every run takes falls out; runs
//! agree within 3 %. It fails when it has grown by 5 %, and when it has shrunk so far that its number here is out of date.
//! A texel of a PNG is four bytes, and three while it is read. A pixel is its sums, and what is written of them.

use std::io::Write;
use std::path::Path;

use crate::common::stdout;

/// The peak of a rendering in bytes.
fn peak(directory: &Path, words: &str) -> f64 {
    stdout(directory, &format!("render {words} --threads 1 -q --stats statistics.json -o a.png"));
    let text = std::fs::read_to_string(directory.join("statistics.json")).unwrap();
    let statistics: serde_json::Value = serde_json::from_str(&text).unwrap();
    statistics["peak_memory_bytes"].as_f64().unwrap()
}

/// Holds bytes for each of so many more things between two runs against their number.
fn hold(directory: &Path, [fewer, more]: [(&str, usize); 2], bytes: f64) {
    let found = (peak(directory, more.0) - peak(directory, fewer.0)) / (more.1 - fewer.1) as f64;
    assert!((0.9 * bytes..1.05 * bytes).contains(&found), "{}: {found} bytes each, not {bytes}", more.0);
}

/// A closed body as a binary PLY file: two sheets of n × n squares, a bump on the upper one.
fn save_mesh(path: &Path, n: u32) -> usize {
    let mut file = std::io::BufWriter::new(std::fs::File::create(path).unwrap());
    let vertices = 2 * (n + 1) * (n + 1);
    let triangles = 4 * n * n;
    write!(
        file,
        "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n\
         property float z\nelement face {triangles}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    .unwrap();
    for sheet in 0..2 {
        for i in 0..(n + 1) * (n + 1) {
            let [x, z] = [i % (n + 1), i / (n + 1)].map(|at| 20.0 * at as f32 / n as f32);
            let y = sheet as f32 * (1.0 + x * (20.0 - x) * z * (20.0 - z) * 1e-3);
            [x, y, z].iter().for_each(|value| file.write_all(&value.to_le_bytes()).unwrap());
        }
    }
    for sheet in 0..2 {
        for i in 0..n * n {
            let first = sheet * (n + 1) * (n + 1) + i / n * (n + 1) + i % n;
            let [a, b, c, d] = [first, first + 1, first + n + 1, first + n + 2];
            for mut triangle in [[a, c, b], [b, c, d]] {
                if sheet == 0 {
                    triangle.reverse();
                }
                file.write_all(&[3]).unwrap();
                triangle.iter().for_each(|index| file.write_all(&index.to_le_bytes()).unwrap());
            }
        }
    }
    triangles as usize
}

fn save_image(path: &Path, edge: u32) -> usize {
    let mut encoder = png::Encoder::new(std::fs::File::create(path).unwrap(), edge, edge);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::Fast);
    let codes: Vec<u8> = (0..3 * edge * edge).map(|i| (i % 251) as u8).collect();
    encoder.write_header().unwrap().write_image_data(&codes).unwrap();
    (edge * edge) as usize
}

#[test]
fn triangles_texels_and_pixels_take_the_bytes_that_they_took() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path();
    let triangles = [200, 400].map(|n| save_mesh(&path.join(format!("{n}.ply")), n));
    let small = "--size 8x8 --spp 1";
    let mesh = |n: u32| format!("{n}.ply --unit mm {small}");
    hold(path, [(&mesh(200), triangles[0]), (&mesh(400), triangles[1])], 131.0);

    let texels = [1024, 2048].map(|edge| save_image(&path.join(format!("{edge}.png")), edge));
    let textured = |edge: u32| {
        let scene = format!(
            "unit = \"mm\"\n[[material]]\nname = \"a\"\nbase_color = {{ file = \"{edge}.png\" }}\n\
             [[object]]\nshape = \"sphere\"\nmaterial = \"a\"\n"
        );
        std::fs::write(path.join(format!("{edge}.toml")), scene).unwrap();
        format!("{edge}.toml {small}")
    };
    hold(path, [(&textured(1024), texels[0]), (&textured(2048), texels[1])], 7.5);

    std::fs::write(path.join("ball.toml"), crate::common::BALL).unwrap();
    let sized = |edge: u32| format!("ball.toml --size {edge}x{edge} --spp 1");
    hold(path, [(&sized(256), 256 * 256), (&sized(768), 768 * 768)], 334.0);
}
