//! A number that tells scenes apart.

use std::collections::HashMap;
use std::sync::Arc;

use translucid_scene::{Pixels, Scene};

use super::view::View;

/// Hashes all of a scene and a view that decides samples: not the number of samples, not the display.
pub(crate) fn fingerprint(scene: &Scene, view: &View) -> u64 {
    let mut hash = Fnv::new();
    let film = view.film();
    let size = (film.width, film.height, film.filter, film.filter_radius);
    hash.text(&format!("{:?} {size:?} {:?} {:?}", view.camera(), view.region(), view.fraction()));
    hash.content(scene, view.seed());
    hash.0
}

/// Hashes all of a scene that decides its points and the light that enters there, whoever looks at them.
pub(crate) fn fingerprint_of_points(scene: &Scene) -> u64 {
    let mut hash = Fnv::new();
    hash.content(scene, scene.integrator.seed);
    hash.0
}

impl Fnv {
    /// All but camera and film.
    fn content(&mut self, scene: &Scene, seed: u64) {
        let mut integrator = translucid_scene::Integrator { seed, ..scene.integrator };
        integrator.samples_per_pixel = 1;
        // How much memory points may take does not change them.
        integrator.point_memory = 1;
        // Debug output of floats reads back exactly, so equal text is equal data.
        self.text(&format!(
            "{} {:?} {:?} {:?}",
            env!("CARGO_PKG_VERSION"),
            integrator,
            scene.lights,
            scene.environment,
        ));
        for material in &scene.materials {
            self.text(&format!("{material:?}"));
        }
        for table in &scene.profile_tables {
            self.text(&format!("{:?}", table.rows));
        }
        let mut known = HashMap::new();
        for (index, object) in scene.objects.iter().enumerate() {
            self.text(&format!("{} {}", object.material, object.subsurface_group));
            if object.is_movable {
                self.word(1);
            }
            let mesh = &object.mesh;
            if object.is_placed() {
                self.bytes(bytemuck::cast_slice(&object.world_from_local.to_cols_array()));
            }
            // A mesh that several objects share is hashed once
            let first = *known.entry(Arc::as_ptr(mesh).addr()).or_insert(index);
            if first != index {
                self.word(first as u64);
                continue;
            }
            self.bytes(bytemuck::cast_slice(&mesh.positions));
            self.bytes(bytemuck::cast_slice(&mesh.normals));
            self.bytes(bytemuck::cast_slice(&mesh.uvs));
            self.bytes(bytemuck::cast_slice(&mesh.tangents));
            self.bytes(bytemuck::cast_slice(&mesh.colors));
            self.bytes(bytemuck::cast_slice(&mesh.triangles));
        }
        for image in &scene.images {
            self.text(&format!("{} {} {:?}", image.width, image.height, image.color_space));
            match &image.pixels {
                Pixels::Byte(pixels) => self.bytes(bytemuck::cast_slice(pixels)),
                Pixels::Float(pixels) => self.bytes(bytemuck::cast_slice(pixels)),
            }
        }
    }
}

/// FNV-1a over 64 bits, eight bytes a step: the data is not hostile, only long.
struct Fnv(u64);

impl Fnv {
    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn word(&mut self, word: u64) {
        self.0 = (self.0 ^ word).wrapping_mul(0x0000_0100_0000_01b3);
        // Multiplication carries upward only: bring high bits down, too.
        self.0 ^= self.0 >> 29;
    }

    fn bytes(&mut self, bytes: &[u8]) {
        let mut chunks = bytes.chunks_exact(8);
        for chunk in &mut chunks {
            self.word(u64::from_le_bytes(std::array::from_fn(|i| chunk[i])));
        }
        for &byte in chunks.remainder() {
            self.word(u64::from(byte));
        }
        self.word(bytes.len() as u64);
    }

    fn text(&mut self, text: &str) {
        self.bytes(text.as_bytes());
    }
}
