//! Materials, textures and images.

use glam::{Vec2, Vec3};
use serde_json::{Value, json};
use translucid_load::load_gltf;
use translucid_scene::{
    Channel, ColorInput, ColorSpace, Material, Pixels, ScalarInput, SubsurfaceModel, TextureFilter,
    TextureRef, Unit, Wrap,
};

use super::builder::{File, Loaded, parse, png};

/// A file whose only material is this one, with textures 0 and 1 on two images.
fn with_textures(material: Value) -> File {
    let mut file = File::with_material(material);
    for pixels in [[[10, 20, 30, 40], [50, 60, 70, 200]], [[128, 128, 255, 255], [0, 0, 0, 0]]] {
        let view = file.view(&png(2, 1, &pixels));
        let image = file.push("images", json!({ "bufferView": view, "mimeType": "image/png" }));
        file.push("textures", json!({ "source": image }));
    }
    file
}

fn read(material: Value) -> (Material, Vec<String>) {
    let loaded = with_textures(material).load();
    let [material] = &loaded.scene.materials[..] else {
        panic!("{} materials", loaded.scene.materials.len())
    };
    (material.clone(), loaded.warnings)
}

fn texture(image: usize) -> Option<TextureRef> {
    Some(TextureRef::new(image))
}

fn extended(name: &str, extension: Value) -> Value {
    json!({ "extensions": { name: extension } })
}

#[test]
fn metallic_roughness_becomes_base_and_specular() {
    let (material, warnings) = read(json!({
        "name": "brass",
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.5, 0.25, 1.0, 0.5],
            "baseColorTexture": { "index": 0 },
            "metallicFactor": 0.75,
            "roughnessFactor": 0.5,
            "metallicRoughnessTexture": { "index": 1 }
        }
    }));
    assert_eq!(material.name, "brass");
    let factor = Vec3::new(0.5, 0.25, 1.0);
    assert_eq!(material.base_color, ColorInput { factor, texture: texture(0), vertex_color: true });
    let data = TextureRef::new(1);
    assert_eq!(material.base_metalness, ScalarInput { factor: 0.75, texture: Some((data, Channel::Blue)) });
    assert_eq!(
        material.specular_roughness,
        ScalarInput { factor: 0.5, texture: Some((data, Channel::Green)) }
    );
    assert_eq!(material.geometry_opacity, ScalarInput::constant(1.0));
    assert_eq!((material.specular_ior, material.specular_weight.factor), (1.5, 1.0));
    assert_eq!(warnings, [""; 0]);
}

#[test]
fn a_primitive_without_material_among_others_gets_the_specification_s_default() {
    let mut file = with_textures(json!({ "name": "first" }));
    let mut bare = file.primitive().clone();
    bare.as_object_mut().unwrap().remove("material");
    file.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(bare);
    let scene = file.load().scene;
    let material = &scene.materials[scene.objects[1].material];
    assert_eq!(material.name, "default material");
    assert_eq!(material.base_color.factor, Vec3::ONE);
    assert_eq!((material.base_metalness.factor, material.specular_roughness.factor), (1.0, 1.0));
}

#[test]
fn a_file_without_materials_leaves_the_choice_to_the_caller() {
    assert!(File::tetrahedron().load().scene.materials.is_empty());
}

#[test]
fn images_are_decoded_once_for_each_color_space() {
    let loaded = with_textures(json!({
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "metallicRoughnessTexture": { "index": 0 } },
        "normalTexture": { "index": 0, "scale": 0.5 },
        "emissiveTexture": { "index": 0 },
        "emissiveFactor": [1, 1, 1]
    }))
    .load();
    let spaces: Vec<ColorSpace> = loaded.scene.images.iter().map(|image| image.color_space).collect();
    assert_eq!(spaces, [ColorSpace::Srgb, ColorSpace::Linear]);
    let material = &loaded.scene.materials[0];
    assert_eq!(material.base_color.texture, texture(0));
    assert_eq!(material.emission_color.texture, texture(0));
    let normal = material.geometry_normal.unwrap();
    assert_eq!((normal.texture, normal.scale), (TextureRef::new(1), 0.5));
    assert_eq!(loaded.scene.images[0].pixels, Pixels::Byte(vec![[10, 20, 30, 40], [50, 60, 70, 200]]));
}

#[test]
fn blended_alpha_is_the_opacity() {
    let (material, _) = read(json!({
        "alphaMode": "BLEND",
        "pbrMetallicRoughness": { "baseColorFactor": [1, 1, 1, 0.5], "baseColorTexture": { "index": 0 } }
    }));
    let expected = ScalarInput { factor: 0.5, texture: Some((TextureRef::new(0), Channel::Alpha)) };
    assert_eq!(material.geometry_opacity, expected);
}

#[test]
fn masked_alpha_is_cut_at_the_cutoff() {
    // Alpha is 0.8 × 40/255 = 0.13 and 0.8 × 200/255 = 0.63.
    for (cutoff, expected) in [(0.1, [255, 255]), (0.5, [0, 255]), (0.7, [0, 0])] {
        let loaded = with_textures(json!({
            "alphaMode": "MASK", "alphaCutoff": cutoff,
            "pbrMetallicRoughness": { "baseColorFactor": [1, 1, 1, 0.8], "baseColorTexture": { "index": 0 } }
        }))
        .load();
        let opacity = loaded.scene.materials[0].geometry_opacity;
        let (reference, channel) = opacity.texture.unwrap();
        assert_eq!((opacity.factor, channel), (1.0, Channel::Alpha));
        let Pixels::Byte(pixels) = &loaded.scene.images[reference.image].pixels else { panic!() };
        assert_eq!(pixels.iter().map(|p| p[3]).collect::<Vec<u8>>(), expected, "cutoff {cutoff}");
    }
    for (alpha, opacity) in [(0.4, 0.0), (0.5, 1.0)] {
        let factor = json!({ "baseColorFactor": [1, 1, 1, alpha] });
        let (material, _) = read(json!({ "alphaMode": "MASK", "pbrMetallicRoughness": factor }));
        assert_eq!(material.geometry_opacity, ScalarInput::constant(opacity));
    }
}

#[test]
fn emission_is_factor_times_texture_times_strength() {
    let (material, _) = read(json!({
        "emissiveFactor": [0.5, 0, 1], "emissiveTexture": { "index": 0 },
        "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 12 } }
    }));
    assert_eq!(material.emission_color.factor, Vec3::new(0.5, 0.0, 1.0));
    assert_eq!((material.emission_color.texture, material.emission_luminance), (texture(0), 12.0));
    assert_eq!(read(json!({ "emissiveFactor": [0.5, 0, 1] })).0.emission_luminance, 1.0);
    assert_eq!(read(json!({})).0.emission_luminance, 0.0);
}

#[test]
fn ior_and_specular_are_read() {
    assert_eq!(read(extended("KHR_materials_ior", json!({ "ior": 1.33 }))).0.specular_ior, 1.33);
    let (material, warnings) = read(extended("KHR_materials_ior", json!({ "ior": 0 })));
    assert_eq!(material.specular_ior, 1.0);
    assert!(
        warnings[0].contains("material 0: specular_ior is 0, but must be in [1, 4]: it becomes 1"),
        "{warnings:?}"
    );
    let mut dielectric = extended(
        "KHR_materials_specular",
        json!({
            "specularFactor": 0.5, "specularTexture": { "index": 1 },
            "specularColorFactor": [2, 1, 0], "specularColorTexture": { "index": 0 }
        }),
    );
    dielectric["pbrMetallicRoughness"]["metallicFactor"] = json!(0);
    let (material, _) = read(dielectric);
    assert_eq!(material.specular_weight.factor, 0.5);
    assert_eq!(material.specular_weight.texture.unwrap().1, Channel::Alpha);
    assert_eq!(material.specular_color.factor, Vec3::new(2.0, 1.0, 0.0));
    assert!(material.specular_color.texture.is_some());
}

#[test]
fn clearcoat_becomes_the_coat() {
    let (material, _) = read(extended(
        "KHR_materials_clearcoat",
        json!({
            "clearcoatFactor": 0.75, "clearcoatTexture": { "index": 1 },
            "clearcoatRoughnessFactor": 0.25, "clearcoatRoughnessTexture": { "index": 1 }
        }),
    ));
    let data = TextureRef::new(0);
    assert_eq!(material.coat_weight, ScalarInput { factor: 0.75, texture: Some((data, Channel::Red)) });
    assert_eq!(material.coat_roughness, ScalarInput { factor: 0.25, texture: Some((data, Channel::Green)) });
    assert_eq!(material.coat_ior, 1.5);
}

#[test]
fn transmission_is_tinted_by_the_base_beside_what_the_volume_absorbs() {
    let glass = |volume: Value| {
        let mut file = with_textures(json!({
            "pbrMetallicRoughness": { "baseColorFactor": [0.9, 0.8, 0.7, 1] },
            "extensions": { "KHR_materials_transmission": { "transmissionFactor": 0.5 } }
        }));
        if !volume.is_null() {
            file.json["materials"][0]["extensions"]["KHR_materials_volume"] = volume;
        }
        let loaded = file.load_in(Unit::Millimeter);
        (loaded.scene.materials[0].clone(), loaded.warnings)
    };
    let volume =
        json!({ "thicknessFactor": 1, "attenuationDistance": 0.005, "attenuationColor": [0.1, 0.2, 0.3] });
    let (material, warnings) = glass(volume);
    assert_eq!(material.transmission_weight, ScalarInput::constant(0.5));
    assert_eq!(material.transmission_color.factor, Vec3::new(0.1, 0.2, 0.3));
    assert_eq!(material.transmission_depth, 5.0);
    assert_eq!(material.transmission_tint.factor, Vec3::new(0.9, 0.8, 0.7));
    assert_eq!(material.crossing_tint(), &material.base_color);
    assert!(warnings.is_empty() && !material.geometry_thin_walled, "{warnings:?}");
    // A pane, whose attenuation has no length to act on
    for volume in [Value::Null, json!({ "attenuationDistance": 0.005, "attenuationColor": [0.1, 0.2, 0.3] })]
    {
        let (material, warnings) = glass(volume);
        assert_eq!(material.crossing_tint().factor, Vec3::new(0.9, 0.8, 0.7));
        assert_eq!(material.transmission_depth, 0.0);
        assert!(warnings.is_empty() && material.geometry_thin_walled, "{warnings:?}");
    }
}

/// KHR_materials_specular: "the specular factor and color only affect the dielectric BRDF".
#[test]
fn the_specular_factor_is_none_of_metals() {
    let with = |metallic: f64| {
        let metallic = json!({ "metallicFactor": metallic });
        let specular =
            json!({ "KHR_materials_specular": { "specularFactor": 0, "specularColorFactor": [0, 0, 1] } });
        File::with_material(json!({ "pbrMetallicRoughness": metallic, "extensions": specular })).load()
    };
    let highlight = |loaded: &Loaded| {
        let material = &loaded.scene.materials[0];
        (material.specular_weight.factor, material.specular_color.factor)
    };
    assert_eq!(highlight(&with(0.0)), (0.0, Vec3::Z));
    assert_eq!(highlight(&with(1.0)), (1.0, Vec3::ONE));
    let partly = with(0.5);
    assert!(
        highlight(&partly) == (1.0, Vec3::ONE) && partly.warned_of("as for metals"),
        "{:?}",
        partly.warnings
    );
}

/// The example of KHR_materials_volume_scatter's specification: a skin of 10 mm.
fn skin() -> Value {
    json!({ "extensions": {
        "KHR_materials_volume_scatter": { "multiscatterColorFactor": [0.572, 0.227, 0.075], "scatterAnisotropy": 0.3 },
        "KHR_materials_volume": { "attenuationColor": [0.9, 0.5, 0.1], "attenuationDistance": 0.01, "thicknessFactor": 1 },
        "KHR_materials_diffuse_transmission": { "diffuseTransmissionFactor": 0.75 }
    } })
}

#[test]
fn volume_scattering_becomes_subsurface_scattering() {
    let loaded = with_textures(skin()).load_in(Unit::Millimeter);
    let material = &loaded.scene.materials[0];
    assert_eq!(material.subsurface_weight, ScalarInput::constant(0.75));
    assert_eq!(material.subsurface_color.factor, Vec3::new(0.572, 0.227, 0.075));
    assert_eq!(material.subsurface_scatter_anisotropy, 0.3);
    assert_eq!(material.subsurface_model, SubsurfaceModel::Default);
    let path = material.subsurface_radius.factor * material.subsurface_radius_scale.factor;
    // After 10 mm the attenuation color is left: exp(−10/ℓ).
    let left = Vec3::from_array((-10.0 / path).to_array().map(f32::exp));
    assert!(left.abs_diff_eq(Vec3::new(0.9, 0.5, 0.1), 1e-6), "{left}");
    assert_eq!(material.transmission_weight, ScalarInput::constant(0.0));
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
}

#[test]
fn scattering_entered_through_clear_transmission_is_subsurface_too() {
    let mut material = skin();
    let extensions = material["extensions"].as_object_mut().unwrap();
    extensions.remove("KHR_materials_diffuse_transmission");
    extensions.insert("KHR_materials_transmission".into(), json!({ "transmissionFactor": 0.5 }));
    let (material, _) = read(material);
    assert_eq!(material.subsurface_weight, ScalarInput::constant(0.5));
    assert_eq!(material.transmission_weight, ScalarInput::constant(0.0));
}

/// Transmission takes its factor first, diffuse transmission its of the rest, and one of 0 is as if it were not there.
#[test]
fn transmission_goes_before_diffuse_transmission() {
    let both = |clear: Value, diffuse: Value| {
        let mut material = skin();
        material["extensions"]["KHR_materials_transmission"] = clear;
        material["extensions"]["KHR_materials_diffuse_transmission"] = diffuse;
        let (found, warnings) = read(material);
        ([found.subsurface_weight.factor, found.subsurface_color.factor.x / 0.572], warnings)
    };
    let tinted = |factor: f64| json!({ "diffuseTransmissionFactor": factor, "diffuseTransmissionColorFactor": [0.5, 1, 1] });
    let clear = |factor: f64| json!({ "transmissionFactor": factor });
    for (t, d, expected) in [
        (1.0, 0.0, [1.0, 1.0]),
        (0.5, 0.0, [0.5, 1.0]),
        (0.0, 0.5, [0.5, 0.5]),
        (0.5, 0.5, [0.75, (0.5 + 0.25 * 0.5) / 0.75]),
        (0.25, 0.8, [0.85, (0.25 + 0.6 * 0.5) / 0.85]),
    ] {
        let (found, warnings) = both(clear(t), tinted(d));
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{t} {d}: {found:?}");
        assert!(warnings.is_empty(), "{warnings:?}");
    }
    let mut image = tinted(0.5);
    image["diffuseTransmissionTexture"] = json!({ "index": 1 });
    let (found, warnings) = both(clear(0.5), image.clone());
    assert!(
        (found[0] - 0.75).abs() < 1e-6 && warnings[0].contains("diffuseTransmissionTexture is left out"),
        "{warnings:?}"
    );
    assert_eq!(both(clear(0.0), image).1, [""; 0]);
    // A solid that absorbs, and is not entered diffusely at all
    let mut solid = skin();
    solid["extensions"].as_object_mut().unwrap().remove("KHR_materials_volume_scatter");
    solid["extensions"]["KHR_materials_transmission"] = clear(1.0);
    solid["extensions"]["KHR_materials_diffuse_transmission"] = tinted(0.0);
    let (solid, _) = read(solid);
    assert_eq!((solid.subsurface_weight.factor, solid.transmission_weight.factor), (0.0, 1.0));
}

#[test]
fn the_base_color_of_light_that_enters_a_scattering_volume_is_told_of() {
    let told = |clear: f64, base: [f64; 4]| {
        let mut material = skin();
        material["pbrMetallicRoughness"] = json!({ "baseColorFactor": base });
        material["extensions"]["KHR_materials_transmission"] = json!({ "transmissionFactor": clear });
        read(material).1.concat()
    };
    assert!(
        told(0.5, [0.9, 1.0, 1.0, 1.0])
            .contains("the base color of light that transmissionFactor lets in is left out")
    );
    assert_eq!([told(0.5, [1.0; 4]), told(0.0, [0.9, 1.0, 1.0, 1.0])], ["", ""]);
}

#[test]
fn diffuse_transmission_is_a_sheet_or_the_boundary_of_a_volume() {
    let diffuse = json!({
        "diffuseTransmissionFactor": 0.5, "diffuseTransmissionTexture": { "index": 1 },
        "diffuseTransmissionColorFactor": [0.3, 0.2, 0.1], "diffuseTransmissionColorTexture": { "index": 0 }
    });
    let mut material = extended("KHR_materials_diffuse_transmission", diffuse);
    for thickness in [None, Some(0.0), Some(1.0)] {
        if let Some(thickness) = thickness {
            let mut volume = skin()["extensions"]["KHR_materials_volume"].clone();
            volume["thicknessFactor"] = json!(thickness);
            material["extensions"]["KHR_materials_volume"] = volume;
        }
        let (found, warnings) = read(material.clone());
        assert!(warnings.is_empty(), "{warnings:?}");
        assert_eq!(found.subsurface_weight.factor, 0.5);
        assert_eq!(found.subsurface_weight.texture.unwrap().1, Channel::Alpha);
        assert_eq!(found.subsurface_color.factor, Vec3::new(0.3, 0.2, 0.1));
        assert!(found.subsurface_color.texture.is_some());
        let is_thin = thickness != Some(1.0);
        assert_eq!(found.geometry_thin_walled, is_thin);
        // All of it passes to the other side
        assert_eq!(found.subsurface_scatter_anisotropy, if is_thin { 0.9999 } else { 0.0 });
    }
}

/// The thin-walled BSDF of KHR_materials_scatter's draft, and of KHR_materials_diffuse_transmission beside
/// KHR_materials_transmission: shares of the base's light that are reflected, scattered back and through, and passed clearly.
#[test]
fn shares_of_a_thin_sheet_are_those_of_the_specifications() {
    let shares = |material: &Material| {
        let (clear, scattered) = (material.transmission_weight.factor, material.subsurface_weight.factor);
        let g = material.subsurface_scatter_anisotropy;
        let scattered = (1.0 - clear) * scattered;
        let diffuse = 1.0 - clear - scattered;
        [diffuse, scattered * (1.0 - g) / 2.0, scattered * (1.0 + g) / 2.0, clear]
    };
    for t in [0.0, 0.3, 1.0] {
        for s in [0.0, 1e-9, 0.25, 1.0] {
            let g = 0.2;
            let (sheet, warnings) = read(json!({ "extensions": {
                "KHR_materials_scatter": { "scatterStrengthFactor": s, "multiscatterColorFactor": [0.8, 0.6, 0.5], "scatterAnisotropy": g },
                "KHR_materials_transmission": { "transmissionFactor": t },
            } }));
            let expected = [1.0 - t, t * s * (1.0 - g) / 2.0, t * s * (1.0 + g) / 2.0, t * (1.0 - s)];
            for (found, expected) in shares(&sheet).into_iter().zip(expected) {
                assert!((found - expected).abs() < 1e-6, "{t} {s}: {:?}", shares(&sheet));
            }
            assert!(warnings.is_empty() && sheet.geometry_thin_walled == (t > 0.0), "{warnings:?}");
            assert!(s == 0.0 || sheet.subsurface_color.factor == Vec3::new(0.8, 0.6, 0.5));
            assert_eq!(sheet.validate(0, 0), Ok(()));

            let (sheet, _) = read(json!({ "extensions": {
                "KHR_materials_diffuse_transmission": { "diffuseTransmissionFactor": s },
                "KHR_materials_transmission": { "transmissionFactor": t },
            } }));
            let expected = [(1.0 - t) * (1.0 - s), 0.0, (1.0 - t) * s, t];
            for (found, expected) in shares(&sheet).into_iter().zip(expected) {
                assert!((found - expected).abs() < 1e-4, "{t} {s}: {:?}", shares(&sheet));
            }
        }
    }
}

#[test]
fn an_image_of_transmission_counts_where_a_sheet_scatters_all_of_it() {
    let sheet = |strength: f64| {
        read(json!({ "extensions": {
            "KHR_materials_scatter": { "scatterStrengthFactor": strength },
            "KHR_materials_transmission": { "transmissionFactor": 0.5, "transmissionTexture": { "index": 1 } },
        } }))
    };
    let (material, warnings) = sheet(1.0);
    let found = (material.subsurface_weight.factor, material.subsurface_weight.texture.is_some());
    assert_eq!((found, material.transmission_weight), ((0.5, true), ScalarInput::constant(0.0)));
    assert!(warnings.is_empty(), "{warnings:?}");
    let (material, warnings) = sheet(0.5);
    assert_eq!(material.transmission_weight, ScalarInput::constant(0.25));
    assert!(warnings[0].contains("transmissionTexture is left out"), "{warnings:?}");
}

/// [`skin`] with the members of an extension changed.
fn skin_with(extension: &str, members: Value) -> Value {
    let mut material = skin();
    let object = &mut material["extensions"][extension];
    members.as_object().unwrap().iter().for_each(|(key, value)| object[key] = value.clone());
    material
}

#[test]
fn scattering_colors_are_read_in_both_spellings_and_the_later_counts() {
    let read = |scatter: Value| {
        let mut material = skin();
        material["extensions"]["KHR_materials_volume_scatter"] = scatter;
        read(material).0.subsurface_color.factor
    };
    let (old, new) = ([0.25, 0.5, 0.75], [0.5, 0.125, 1.0]);
    assert_eq!(read(json!({ "multiscatterColor": old })), Vec3::from(old));
    assert_eq!(read(json!({ "multiscatterColorFactor": new })), Vec3::from(new));
    assert_eq!(read(json!({ "multiscatterColor": old, "multiscatterColorFactor": new })), Vec3::from(new));
    // The drafts' default: no scattering, all black
    assert_eq!(read(json!({})), Vec3::ZERO);
}

#[test]
fn scattering_color_is_factor_times_texture_times_tint() {
    let textured = json!({ "multiscatterColorTexture": { "index": 0 } });
    let mut material = skin_with("KHR_materials_volume_scatter", textured);
    let tint = json!({ "diffuseTransmissionFactor": 1, "diffuseTransmissionColorFactor": [0.5, 1, 1] });
    material["extensions"]["KHR_materials_diffuse_transmission"] = tint;
    let (found, warnings) = read(material.clone());
    assert_eq!(found.subsurface_color.factor, Vec3::new(0.286, 0.227, 0.075));
    assert_eq!((found.subsurface_color.texture, &warnings[..]), (texture(0), &[][..]));
    material["extensions"]["KHR_materials_diffuse_transmission"]["diffuseTransmissionColorTexture"] =
        json!({ "index": 1 });
    let (found, warnings) = read(material);
    assert_eq!(found.subsurface_color.texture, texture(0));
    assert!(warnings[0].contains("diffuseTransmissionColorTexture is left out"), "{warnings:?}");
}

/// The volumetric example of KHR_materials_scatter's draft, switched on.
fn candle() -> Value {
    json!({ "extensions": {
        "KHR_materials_scatter": { "scatterStrengthFactor": 1, "multiscatterColorFactor": [0.8, 0.6, 0.5], "scatterAnisotropy": 0.2 },
        "KHR_materials_transmission": { "transmissionFactor": 0.75 },
        "KHR_materials_volume": { "thicknessFactor": 1, "attenuationDistance": 0.01, "attenuationColor": [0.95, 0.85, 0.75] }
    } })
}

#[test]
fn the_draft_that_unites_scattering_is_that_of_a_volume_with_its_strength_in_the_color() {
    let (material, warnings) = read(candle());
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(material.subsurface_weight, ScalarInput::constant(0.75));
    assert_eq!(material.subsurface_color.factor, Vec3::new(0.8, 0.6, 0.5));
    assert_eq!(material.subsurface_scatter_anisotropy, 0.2);
    // The same volume states the same mean free path by the other draft
    let mut other = skin();
    other["extensions"]["KHR_materials_volume"] = candle()["extensions"]["KHR_materials_volume"].clone();
    let other = read(other).0;
    assert_eq!(
        (material.subsurface_radius, material.subsurface_radius_scale),
        (other.subsurface_radius, other.subsurface_radius_scale)
    );
    let with_strength = |strength: f32| {
        let mut material = candle();
        material["extensions"]["KHR_materials_scatter"]["scatterStrengthFactor"] = json!(strength);
        read(material).0
    };
    assert_eq!(with_strength(0.5).subsurface_color.factor, Vec3::new(0.4, 0.3, 0.25));
    let clear = with_strength(0.0);
    assert_eq!((clear.subsurface_weight.factor, clear.transmission_weight.factor), (0.0, 0.75));
    // It takes the place of the two others, and says so
    let mut both = candle();
    both["extensions"]["KHR_materials_diffuse_transmission"] = json!({ "diffuseTransmissionFactor": 0.25 });
    let (material, warnings) = read(both);
    assert_eq!(material.subsurface_weight.factor, 0.75);
    let expected = "KHR_materials_diffuse_transmission is left out beside KHR_materials_scatter";
    assert!(warnings[0].contains(expected), "{warnings:?}");
}

#[test]
fn what_scattering_cannot_be_translated_is_told() {
    let cases = [
        (
            "KHR_materials_scatter",
            json!({ "scatterStrengthTexture": { "index": 1 } }),
            "scatterStrengthTexture is left out",
        ),
        (
            "KHR_materials_volume",
            json!({ "attenuationDistance": null }),
            "scattering in a KHR_materials_volume without attenuationDistance",
        ),
        (
            "KHR_materials_volume",
            json!({ "attenuationDistance": 0 }),
            "an attenuationDistance that is not above 0",
        ),
        (
            "KHR_materials_scatter",
            json!({ "scatterStrengthFactor": 1.5 }),
            "scatterStrengthFactor is 1.5, but must be in [0, 1]",
        ),
        (
            "KHR_materials_scatter",
            json!({ "multiscatterColorFactor": [0, -1, 2] }),
            "multiscatterColorFactor is -1, but must be in [0, 1]",
        ),
        (
            "KHR_materials_scatter",
            json!({ "scatterAnisotropy": 1 }),
            "scatterAnisotropy is 1, but must be in (-1, 1): it becomes 0.99",
        ),
        (
            "KHR_materials_scatter",
            json!({ "scatterAnisotropy": -1e39 }),
            "scatterAnisotropy is -inf, but must be in (-1, 1)",
        ),
    ];
    for (extension, members, expected) in cases {
        let mut material = candle();
        let object = &mut material["extensions"][extension];
        members.as_object().unwrap().iter().for_each(|(key, value)| object[key] = value.clone());
        let (material, warnings) = read(material);
        assert!(warnings.iter().any(|warning| warning.contains(expected)), "{warnings:?}: {expected}");
        assert_eq!(material.validate(2, 0), Ok(()));
    }
    // Pieces that are missing: no volume, nothing that lets light in
    let mut alone = skin();
    alone["extensions"].as_object_mut().unwrap().remove("KHR_materials_volume");
    let (material, warnings) = read(alone);
    assert!(material.geometry_thin_walled && material.subsurface_color.factor == Vec3::ONE);
    assert!(warnings[0].contains("without KHR_materials_volume is left out"), "{warnings:?}");
    let mut closed = candle();
    closed["extensions"].as_object_mut().unwrap().remove("KHR_materials_transmission");
    assert_eq!(read(closed).0.subsurface_weight, ScalarInput::constant(0.0));
}

#[test]
fn scattering_of_a_wrong_type_is_refused_with_its_material_extension_and_key() {
    for (extension, key, value, reason) in [
        ("KHR_materials_scatter", "multiscatterColorFactor", json!("red"), "invalid type: string \"red\""),
        (
            "KHR_materials_scatter",
            "multiscatterColorFactor",
            json!([1, 2]),
            "invalid length 2, expected an array of length 3",
        ),
        (
            "KHR_materials_scatter",
            "scatterStrengthFactor",
            json!([1]),
            "invalid type: sequence, expected f32",
        ),
        ("KHR_materials_scatter", "multiscatterColorTexture", json!(0), "invalid type: integer `0`"),
        (
            "KHR_materials_volume_scatter",
            "scatterAnisotropy",
            json!("0.3"),
            "invalid type: string \"0.3\", expected f32",
        ),
        (
            "KHR_materials_volume",
            "attenuationDistance",
            json!(true),
            "invalid type: boolean `true`, expected f64",
        ),
        (
            "KHR_materials_diffuse_transmission",
            "diffuseTransmissionColorFactor",
            json!({}),
            "invalid type: map",
        ),
    ] {
        let mut material = if extension == "KHR_materials_scatter" { candle() } else { skin() };
        material["extensions"][extension][key] = value;
        let message = parse(&with_textures(material).glb(), Unit::Meter).err().unwrap();
        let place = format!("nowhere/x.gltf, material 0, {extension}, {key}: {reason}");
        assert!(message.starts_with(&place), "{message}\n{place}");
    }
}

#[test]
fn unlit_materials_emit_their_base_color() {
    let (material, _) = read(json!({
        "pbrMetallicRoughness": { "baseColorFactor": [0.9, 0.8, 0.7, 1], "baseColorTexture": { "index": 0 } },
        "extensions": { "KHR_materials_unlit": {} }
    }));
    assert_eq!(material.emission_color.factor, Vec3::new(0.9, 0.8, 0.7));
    assert_eq!((material.emission_color.texture, material.emission_luminance), (texture(0), 1.0));
    assert_eq!((material.base_weight, material.specular_weight.factor), (0.0, 0.0));
}

#[test]
fn unread_extensions_are_named_in_one_warning() {
    let mut file = with_textures(extended("KHR_materials_sheen", json!({ "sheenRoughnessFactor": 1 })));
    file.push("materials", extended("KHR_materials_iridescence", json!({})));
    let mut second = file.primitive().clone();
    second["material"] = json!(1);
    file.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(second);
    let warnings = file.load().warnings;
    let names = "left out: KHR_materials_iridescence, KHR_materials_sheen";
    assert!(matches!(&warnings[..], [only] if only.ends_with(names)), "{warnings:?}");
}

#[test]
fn samplers_set_the_wrap_modes() {
    let mut file = with_textures(json!({ "normalTexture": { "index": 0 } }));
    file.push("samplers", json!({ "wrapS": 33071, "wrapT": 33648 }));
    file.json["textures"][0]["sampler"] = json!(0);
    let texture = file.load().scene.materials[0].geometry_normal.unwrap().texture;
    assert_eq!(texture.wrap, [Wrap::Clamp, Wrap::Mirror]);
}

/// glTF 2.0, section 5.26: 9728 is NEAREST. What is seen from afar is averaged by samples in any case.
#[test]
fn samplers_of_nearest_pixels_show_them() {
    let filter = |sampler: Value| {
        let mut file = with_textures(json!({ "normalTexture": { "index": 0 } }));
        file.push("samplers", sampler);
        file.json["textures"][0]["sampler"] = json!(0);
        let loaded = file.load();
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
        loaded.scene.materials[0].geometry_normal.unwrap().texture.filter
    };
    assert_eq!(filter(json!({ "magFilter": 9728, "minFilter": 9728 })), TextureFilter::Nearest);
    for sampler in [json!({}), json!({ "magFilter": 9729 }), json!({ "minFilter": 9728 })] {
        assert_eq!(filter(sampler.clone()), TextureFilter::Linear, "{sampler}");
    }
}

#[test]
fn texture_transforms_reach_the_pixel_that_gltf_means() {
    let transform = json!({ "offset": [0.25, 0.5], "scale": [0.5, 2], "rotation": 0.3 });
    let info = json!({ "index": 0, "extensions": { "KHR_texture_transform": transform } });
    let loaded = with_textures(json!({ "normalTexture": info })).load();
    let texture = loaded.scene.materials[0].geometry_normal.unwrap().texture;
    // The builder's third vertex has glTF coordinates (0, 0.75): scaled (0, 1.5), then rotated by the
    // extension's rule, then moved; at last v is turned up.
    let (sin, cos) = 0.3f32.sin_cos();
    let expected = Vec2::new(1.5 * sin + 0.25, 1.0 - (1.5 * cos + 0.5));
    let found = texture.coordinates(loaded.mesh().uvs[2]);
    assert!(found.abs_diff_eq(expected, 1e-6), "{found} {expected}");
}

#[test]
fn mixed_texture_coordinates_are_reported() {
    let (_, warnings) = read(json!({
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } },
        "normalTexture": { "index": 0, "texCoord": 1 }
    }));
    assert!(warnings[0].contains("material 0: its textures use TEXCOORD_0 and TEXCOORD_1"), "{warnings:?}");
}

#[test]
fn a_missing_texture_file_is_a_warning_that_names_material_and_file() {
    let mut file = File::with_material(json!({
        "name": "skin", "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "roughnessFactor": 0.25 }
    }));
    file.push("images", json!({ "uri": "textures/no%20such.png" }));
    file.push("textures", json!({ "source": 0 }));
    let loaded = file.load();
    assert!(loaded.scene.materials[0].base_color.texture.is_none());
    assert_eq!(loaded.scene.materials[0].specular_roughness.factor, 0.25);
    let [warning] = &loaded.warnings[..] else { panic!("{:?}", loaded.warnings) };
    assert!(
        warning.starts_with("nowhere/x.gltf, material 0 \"skin\": image 0 is left out: nowhere/textures/no such.png cannot be read"),
        "{warning}"
    );
}

#[test]
fn textures_that_cannot_be_decoded_are_left_out_with_a_warning() {
    let mut file = with_textures(json!({ "normalTexture": { "index": 0 }, "name": "skin" }));
    file.json["textures"][0] = json!({ "extensions": { "KHR_texture_basisu": { "source": 0 } } });
    let loaded = file.load();
    assert!(loaded.warned_of("material 0 \"skin\": texture 0 is left out: KHR_texture_basisu is not read"));
    let view = file.view(b"not an image");
    file.json["textures"][0] = json!({ "source": 0 });
    file.json["images"][0]["bufferView"] = json!(view);
    let loaded = file.load();
    assert!(loaded.scene.materials[0].geometry_normal.is_none());
    assert!(loaded.warned_of("material 0 \"skin\": image 0 is left out"), "{:?}", loaded.warnings);
}

#[test]
fn image_files_beside_the_gltf_are_read() {
    let mut file = File::with_material(json!({ "normalTexture": { "index": 0 } }));
    file.push("images", json!({ "uri": "maps/bump.png" }));
    file.push("textures", json!({ "source": 0 }));
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("maps")).unwrap();
    std::fs::write(folder.path().join("maps/bump.png"), png(1, 1, &[[1, 2, 3, 4]])).unwrap();
    let path = folder.path().join("x.glb");
    std::fs::write(&path, file.glb()).unwrap();
    let mut warnings = Vec::new();
    let scene = load_gltf(&path, Unit::Meter, &mut warnings).unwrap();
    assert_eq!(scene.images[0].pixels, Pixels::Byte(vec![[1, 2, 3, 4]]));
    assert!(scene.images[0].name.contains("maps/bump.png"), "{}", scene.images[0].name);
    assert!(warnings.is_empty(), "{warnings:?}");
}

#[test]
fn factors_out_of_range_are_clamped_with_a_warning() {
    let (material, warnings) = read(json!({
        "name": "odd",
        "pbrMetallicRoughness": { "baseColorFactor": [2, -1, 0.5, 1], "metallicFactor": -0.5, "roughnessFactor": 1e39 },
        "emissiveFactor": [1, 1, 1],
        "extensions": {
            "KHR_materials_emissive_strength": { "emissiveStrength": -3 },
            "KHR_materials_specular": { "specularColorFactor": [-1, 0, 0] }
        }
    }));
    assert_eq!(material.base_color.factor, Vec3::new(1.0, 0.0, 0.5));
    assert_eq!((material.base_metalness.factor, material.specular_roughness.factor), (0.0, 1.0));
    assert_eq!(material.emission_luminance, 0.0);
    assert_eq!(material.specular_color.factor, Vec3::ZERO);
    let expected = "material 0 \"odd\": baseColorFactor is 2, but must be in [0, 1]: it becomes 1";
    assert!(warnings.iter().any(|w| w.contains(expected)), "{warnings:?}");
    assert!(warnings.iter().any(|w| w.contains("metallicFactor is -0.5")), "{warnings:?}");
    assert!(warnings.iter().any(|w| w.contains("roughnessFactor is inf")), "{warnings:?}");
}
