//! Fingerprints: everything that a picture depends on, as text that differs where scenes do.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use translucid_scene::{Image, Integrator, Object, Pixels, Scene};

use super::view::View;

/// Most objects and images that a fingerprint tells apart by name; those after them are one part of it.
const MOST_NAMED: usize = 256;
/// Longest text that stands for itself.
const LONGEST_TEXT: usize = 100;

/// Everything that the samples of a picture depend on, part by part: program, settings, hashes of long data.
///
/// Two renderings with the same one may be joined. The number of samples, the part of the picture and the display are not in
/// it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fingerprint(BTreeMap<String, String>);

impl Fingerprint {
    /// Describes the first part that differs, this fingerprint's value first; `None` if they are equal.
    pub fn difference(&self, other: &Self) -> Option<String> {
        let value = |of: &Self, key: &str| of.0.get(key).cloned().unwrap_or_else(|| String::from("missing"));
        let keys = self.0.keys().chain(other.0.keys());
        let mut pairs = keys.map(|key| (key, value(self, key), value(other, key)));
        pairs.find(|(_, ours, theirs)| ours != theirs).map(|(key, ours, theirs)| {
            let are_hashes = [&ours, &theirs].iter().all(|value| value.starts_with('#'));
            if are_hashes {
                format!("{key} differs")
            } else {
                format!("{key} is {ours} in one and {theirs} in the other")
            }
        })
    }

    /// That of samples that a device has traced.
    #[must_use]
    pub(crate) fn traced_by(mut self, device: &str) -> Self {
        self.add("device", device.to_owned());
        self
    }

    fn add(&mut self, key: impl Into<String>, text: String) {
        let value = if text.len() > LONGEST_TEXT {
            let mut hash = Fnv::new();
            hash.text(&text);
            hash.shown()
        } else {
            text
        };
        self.0.insert(key.into(), value);
    }
}

/// That of a scene's picture in a view, points left out.
pub(super) fn fingerprint(scene: &Scene, view: &View) -> Fingerprint {
    let mut found = content(scene, view.seed());
    let film = view.film();
    found.add("camera", format!("{:?}", view.camera()));
    found.add("size", format!("{}x{}", film.width, film.height));
    found.add("filter", format!("{:?} of radius {}", film.filter, film.filter_radius));
    found.add("fraction of the resolution", format!("1/{}", view.fraction().divisor()));
    found
}

/// All but camera and film.
fn content(scene: &Scene, seed: u64) -> Fingerprint {
    let mut found = Fingerprint::default();
    found.add("program", format!("translucid {}", env!("CARGO_PKG_VERSION")));
    found.add("system", format!("{}-{}", std::env::consts::ARCH, std::env::consts::OS));
    let Integrator {
        samples_per_pixel: _,
        max_depth,
        max_diffuse_depth,
        caustics,
        subsurface_tail,
        subsurface_method,
        subsurface_sharing,
        point_tolerance,
        point_memory,
        seed: _,
    } = scene.integrator;
    // Debug output of floats reads back exactly, so equal text is equal data
    for (key, text) in [
        ("seed", seed.to_string()),
        ("max_depth", max_depth.to_string()),
        ("max_diffuse_depth", max_diffuse_depth.to_string()),
        ("caustics", caustics.to_string()),
        ("subsurface_tail", format!("{subsurface_tail:?}")),
        ("subsurface_method", subsurface_method.name().to_owned()),
        ("subsurface_sharing", subsurface_sharing.to_string()),
        ("point_tolerance", format!("{point_tolerance:?}")),
        ("point_memory", point_memory.to_string()),
        ("lights", format!("{:?}", scene.lights)),
        ("environment", format!("{:?}", scene.environment)),
    ] {
        found.add(key, text);
    }
    for material in &scene.materials {
        found.add(format!("material {}", material.name), format!("{material:?}"));
    }
    for (number, table) in scene.profile_tables.iter().enumerate() {
        found.add(format!("profile table {number}"), format!("{:?}", table.rows));
    }
    let mut meshes = HashMap::new();
    let objects = scene.objects.iter().enumerate();
    add_parts(
        &mut found,
        "object",
        objects.map(|(number, object)| (object.name.as_str(), hash_of_object(number, object, &mut meshes))),
    );
    // Where a file lies may be another place on another machine
    let images = scene.images.iter().map(|image| (file_name(&image.name), hash_of_image(image)));
    add_parts(&mut found, "image", images);
    found
}

fn file_name(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or(path)
}

/// Adds hashes of many things by their number and name, those after [`MOST_NAMED`] together.
fn add_parts<'a>(found: &mut Fingerprint, kind: &str, parts: impl Iterator<Item = (&'a str, Fnv)>) {
    let mut others = Fnv::new();
    let mut count = 0;
    for (name, hash) in parts {
        if count < MOST_NAMED {
            found.0.insert(format!("{kind} {count} ({name})"), hash.shown());
        } else {
            others.word(hash.0);
        }
        count += 1;
    }
    if count > MOST_NAMED {
        found.0.insert(format!("other {kind}s"), format!("{} {}", count - MOST_NAMED, others.shown()));
    }
}

/// `meshes` knows the first object of each mesh: one that several share is hashed once.
fn hash_of_object(number: usize, object: &Object, meshes: &mut HashMap<usize, usize>) -> Fnv {
    let mut hash = Fnv::new();
    hash.text(&format!("{} {} {}", object.material, object.subsurface_group, object.is_movable));
    let mesh = &object.mesh;
    if object.is_placed() {
        hash.bytes(bytemuck::cast_slice(&object.world_from_local.to_cols_array()));
    }
    let first = *meshes.entry(Arc::as_ptr(mesh).addr()).or_insert(number);
    if first != number {
        hash.word(first as u64);
        return hash;
    }
    hash.bytes(bytemuck::cast_slice(&mesh.positions));
    hash.bytes(bytemuck::cast_slice(&mesh.normals));
    hash.bytes(bytemuck::cast_slice(&mesh.uvs));
    hash.bytes(bytemuck::cast_slice(&mesh.tangents));
    hash.bytes(bytemuck::cast_slice(&mesh.colors));
    hash.bytes(bytemuck::cast_slice(&mesh.triangles));
    hash
}

fn hash_of_image(image: &Image) -> Fnv {
    let mut hash = Fnv::new();
    hash.text(&format!("{} {} {:?}", image.width, image.height, image.color_space));
    match &image.pixels {
        Pixels::Byte(pixels) => hash.bytes(bytemuck::cast_slice(pixels)),
        Pixels::Float(pixels) => hash.bytes(bytemuck::cast_slice(pixels)),
    }
    hash
}

/// A hash of a file's content, in sixteen digits: not against malice.
pub fn content_hash(bytes: &[u8]) -> String {
    let mut hash = Fnv::new();
    hash.bytes(bytes);
    hash.shown()
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

    fn shown(&self) -> String {
        format!("#{:016x}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(parts: &[(&str, &str)]) -> Fingerprint {
        Fingerprint(parts.iter().map(|(key, value)| (key.to_string(), value.to_string())).collect())
    }

    #[test]
    fn difference_names_the_first_part() {
        let one = of(&[("camera", "#1"), ("seed", "1")]);
        assert_eq!(one.difference(&one), None);
        let difference = |parts| one.difference(&of(parts)).unwrap();
        assert_eq!(difference(&[("camera", "#1"), ("seed", "2")]), "seed is 1 in one and 2 in the other");
        assert_eq!(difference(&[("camera", "#2"), ("seed", "2")]), "camera differs");
        assert_eq!(difference(&[("camera", "#1")]), "seed is 1 in one and missing in the other");
        assert_eq!(of(&[]).difference(&one).unwrap(), "camera is missing in one and #1 in the other");
    }

    #[test]
    fn many_parts_are_told_apart_too() {
        let found = |wrong: usize| {
            let mut found = Fingerprint::default();
            add_parts(&mut found, "object", (0..300).map(|i| ("ball", Fnv(u64::from(i == wrong)))));
            found
        };
        assert_eq!(found(400).0.len(), MOST_NAMED + 1);
        assert_eq!(
            found(299).difference(&found(400)).unwrap().split(' ').take(2).collect::<Vec<_>>(),
            ["other", "objects"]
        );
        assert_eq!(found(7).difference(&found(400)).unwrap(), "object 7 (ball) differs");
    }
}
