//! Damaged files by the thousand: whatever happens to the bytes, the loader returns.

use std::sync::Arc;

use serde_json::json;
use translucid_load::MeshFile;
use translucid_scene::{Material, Scene, Unit};
use translucid_testing::{SplitMix, power};

use super::builder::{File, parse, png};

/// A file with a bit of everything.
fn everything() -> File {
    let mut file = File::with_material(json!({
        "name": "m",
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "metallicFactor": 0.5, "baseColorFactor": [1, 1, 1, 0.5] },
        "normalTexture": { "index": 0, "texCoord": 1, "extensions": { "KHR_texture_transform": { "offset": [0, 1], "rotation": 1, "scale": [2, 2] } } },
        "emissiveFactor": [1, 0, 0], "alphaMode": "MASK",
        "extensions": {
            "KHR_materials_volume": { "attenuationColor": [0.9, 0.5, 0.1], "attenuationDistance": 0.01 },
            "KHR_materials_volume_scatter": { "multiscatterColorFactor": [0.5, 0.2, 0.1], "multiscatterColorTexture": { "index": 0 } },
            "KHR_materials_diffuse_transmission": { "diffuseTransmissionFactor": 0.5 },
            "KHR_materials_transmission": { "transmissionFactor": 0.5 },
            "KHR_materials_clearcoat": { "clearcoatFactor": 1 }, "KHR_materials_ior": { "ior": 1.4 }
        }
    }));
    let image = file.view(&png(2, 1, &[[1, 2, 3, 4]; 2]));
    file.push("images", json!({ "bufferView": image, "mimeType": "image/png" }));
    file.push("samplers", json!({ "wrapS": 33071 }));
    file.push("textures", json!({ "source": 0, "sampler": 0 }));
    let colors = file.accessor("VEC4", 5121, 16, &[200; 16]);
    file.json["accessors"][colors]["normalized"] = json!(true);
    file.attribute("COLOR_0", colors);
    let normals = file.floats("VEC3", &[0.0, 0.6, 0.8].repeat(4));
    file.attribute("NORMAL", normals);
    let indices = file.view(&[1, 3]);
    let values = file.view(&[0x3f; 24]);
    file.json["accessors"][0]["sparse"] = json!({
        "count": 2, "indices": { "bufferView": indices, "componentType": 5121 }, "values": { "bufferView": values }
    });
    let translation = file.floats("VEC3", &[0.0, 0.0, 0.0, 7.0, 0.0, 0.0]);
    file.push(
        "nodes",
        json!({
            "mesh": 0, "rotation": [0, 0, 0, 1], "scale": [1, -1, 2],
            "extensions": { "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": translation } } }
        }),
    );
    file.push("cameras", json!({ "type": "perspective", "perspective": { "yfov": 1, "znear": 1 } }));
    file.json["extensions"]["KHR_lights_punctual"]["lights"] = json!([{ "type": "spot", "spot": {} }]);
    file.push(
        "nodes",
        json!({
            "children": [0, 1], "camera": 0, "extensions": { "KHR_lights_punctual": { "light": 0 } },
            "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 2, 3, 1]
        }),
    );
    let joints = file.accessor("VEC4", 5121, 16, &[0, 1, 0, 0].repeat(4));
    let weights = file.floats("VEC4", &[0.5, 0.5, 0.0, 0.0].repeat(4));
    file.attribute("JOINTS_0", joints);
    file.attribute("WEIGHTS_0", weights);
    file.primitive()["targets"] = json!([{ "POSITION": 0, "NORMAL": normals }]);
    file.json["meshes"][0]["weights"] = json!([0.25]);
    file.push("skins", json!({ "joints": [0, 1] }));
    file.push(
        "nodes",
        json!({ "mesh": 0, "skin": 0, "extensions": { "KHR_node_visibility": { "visible": true } } }),
    );
    file.push("scenes", json!({ "nodes": [2, 3] }));
    file
}

/// Words that may stand where a digit stood.
const NUMBERS: [&[u8]; 8] =
    [b"-1", b"0", b"99", b"1e39", b"4294967296", b"18446744073709551615", b"0.5", b"null"];

/// One to three damages: a flipped bit, a random byte, a piece cut out or doubled, or another number.
fn damage(bytes: &mut Vec<u8>, random: &mut SplitMix) {
    for _ in 0..=random.below(3) {
        if bytes.is_empty() {
            return;
        }
        let at = random.below(bytes.len());
        let end = (at + 1 + random.below(16)).min(bytes.len());
        match random.below(16) {
            0 => bytes[at] ^= 1 << random.below(8),
            1 => bytes[at] = random.below(256) as u8,
            2 => drop(bytes.drain(at..end)),
            3 => bytes.splice(at..at, bytes[at..end].to_vec()).for_each(drop),
            _ => {
                let Some(digit) = (at..bytes.len()).find(|&i| bytes[i].is_ascii_digit()) else { continue };
                bytes
                    .splice(digit..=digit, NUMBERS[random.below(NUMBERS.len())].iter().copied())
                    .for_each(drop);
            }
        }
    }
}

/// Makes a GLB's header fit its damaged JSON again, so that the damage is met further in.
fn mend_lengths(bytes: &mut [u8], json_growth: isize) {
    let total = bytes.len() as u32;
    if bytes.len() >= 20 {
        let json = u32::from_le_bytes([bytes[12], bytes[13], bytes[14], bytes[15]]);
        bytes[8..12].copy_from_slice(&total.to_le_bytes());
        bytes[12..16].copy_from_slice(
            &(i64::from(json) + json_growth as i64).clamp(0, i64::from(total)).to_le_bytes()[..4],
        );
    }
}

/// The file as a scene of its own.
fn scene_of(file: MeshFile) -> Scene {
    let MeshFile { origin: _, objects, mut materials, images, lights, cameras } = file;
    if materials.is_empty() {
        materials.push(Material::default());
    }
    let images = images.into_iter().map(Arc::new).collect();
    let camera = cameras.first().map(|named| named.camera).unwrap_or_default();
    Scene { objects, materials, images, lights, camera, ..Scene::default() }
}

#[test]
fn no_damage_makes_the_loader_panic_or_return_a_scene_that_is_not_valid() {
    let file = everything();
    let originals = [file.glb(), file.gltf()];
    let mut random = SplitMix(2015);
    let (mut sound, rounds) = (0, power(6000) as usize);
    for round in 0..rounds {
        let original = &originals[round % 2];
        let mut bytes = original.clone();
        damage(&mut bytes, &mut random);
        if round % 4 == 0 {
            let growth = bytes.len() as isize - original.len() as isize;
            mend_lengths(&mut bytes, growth);
        }
        if let Ok(loaded) = parse(&bytes, Unit::Millimeter) {
            sound += 1;
            assert_eq!(scene_of(loaded.scene).validate(), Ok(()), "round {round}");
        }
    }
    // Damage that is always refused at the door would test nothing behind it.
    assert!(sound > rounds / 12, "{sound} of {rounds} damaged files were still read");
    assert!(parse(&originals[0], Unit::Meter).is_ok());
}
