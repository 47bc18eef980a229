//! Writes `scenes/bust.ply`, a mesh of centimeters to try things on: the built-in bust, coarser.
//!
//! ```text
//! cargo run --release -p translucid-shapes --example bust
//! ```

use std::error::Error;
use std::fs;
use std::path::Path;

use translucid_shapes::{ShapeParameters, build_shape};

#[allow(clippy::print_stdout, reason = "a program for a terminal")]
fn main() -> Result<(), Box<dyn Error>> {
    let mesh = build_shape("bust", &ShapeParameters::new().with("detail", 96.0))?;
    let header = format!(
        "ply\nformat binary_little_endian 1.0\ncomment the built-in bust of translucid, in centimeters\n\
         element vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        mesh.positions.len(),
        mesh.triangles.len(),
    );
    let mut bytes = header.into_bytes();
    bytes.extend(mesh.positions.iter().flat_map(|position| position.to_array()).flat_map(f32::to_le_bytes));
    for triangle in &mesh.triangles {
        bytes.push(3);
        bytes.extend(triangle.iter().flat_map(|index| index.to_le_bytes()));
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/bust.ply");
    println!("{} triangles, {} bytes", mesh.triangles.len(), bytes.len());
    Ok(fs::write(path, bytes)?)
}
