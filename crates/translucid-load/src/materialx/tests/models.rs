//! Shading models other than OpenPBR, by their translations to it.

use super::*;

#[test]
fn standard_surface_has_its_own_names_and_defaults() {
    let (plain, _) = sound(&document("standard_surface", "", ""));
    assert_eq!((plain.base_weight, plain.base_color.factor), (1.0, Vec3::splat(0.8)));
    assert_eq!(
        (plain.specular_roughness.factor, plain.coat_roughness.factor, plain.coat_ior),
        (0.2, 0.1, 1.5)
    );
    assert_eq!((plain.subsurface_color.factor, plain.subsurface_radius_scale.factor), (Vec3::ONE, Vec3::ONE));
    let first = "<materialx><standard_surface name=\"S\" version=\"1.0.0\"/></materialx>";
    let (first, _) = sound(first);
    assert_eq!((first.base_weight, first.base_color.factor), (0.8, Vec3::ONE));
    let inputs = [
        input("base", "float", "0.5"),
        input("specular", "float", "0.75"),
        input("specular_IOR", "float", "1.3"),
        input("subsurface", "float", "1"),
        input("subsurface_color", "color3", "0.5, 0.25, 0.125"),
        input("subsurface_radius", "color3", "1, 0.5, 0.25"),
        "<input name=\"subsurface_scale\" type=\"float\" value=\"3\" unit=\"millimeter\"/>".into(),
        input("subsurface_anisotropy", "float", "-0.5"),
        input("emission", "float", "2"),
        input("opacity", "color3", "0.5, 0.5, 0.5"),
        input("coat", "float", "0.125"),
    ];
    let (found, _) = sound(&document("standard_surface", &inputs.concat(), ""));
    assert_eq!(
        (found.base_weight, found.base_metalness.factor, found.specular_weight.factor),
        (0.5, 0.0, 0.75)
    );
    assert_eq!((found.specular_ior, found.emission_luminance, found.coat_weight.factor), (1.3, 2.0, 0.125));
    assert_eq!(found.subsurface_color.factor, Vec3::new(0.5, 0.25, 0.125));
    assert_eq!(found.subsurface_radius, ScalarInput::constant(3.0));
    assert_eq!(found.subsurface_radius_scale.factor, Vec3::new(1.0, 0.5, 0.25));
    assert_eq!((found.subsurface_scatter_anisotropy, found.geometry_opacity.factor), (-0.5, 0.5));
}

/// Copper and Metal_Brushed of MaterialX's examples: their highlight has no weight of its own, the coat of one is its color.
#[test]
fn metals_of_standard_surface_reflect_and_their_coat_is_a_tint() {
    let metal = |inputs: &str| {
        let specular = input("specular", "float", "0") + &input("specular_color", "color3", "0, 0, 0");
        let text = document("standard_surface", &(specular + &input("metalness", "float", "1") + inputs), "");
        sound(&text).0
    };
    let brushed = metal(&input("base_color", "color3", "0.5, 0.5, 0.5"));
    assert_eq!(brushed.specular_weight, ScalarInput::constant(1.0));
    assert_eq!(brushed.specular_color, ColorInput::constant(Vec3::ONE));
    assert_eq!(brushed.base_color.factor, Vec3::splat(0.5));
    let coat = input("coat_color", "color3", "0.5, 0.25, 1");
    let white = input("base_color", "color3", "1, 1, 0.5");
    for (weight, expected) in [("1", Vec3::new(0.5, 0.25, 0.5)), ("0.5", Vec3::new(0.75, 0.625, 0.5))] {
        let copper = metal(&[coat.clone(), white.clone(), input("coat", "float", weight)].concat());
        assert_eq!((copper.coat_weight.factor, copper.base_color.factor), (0.0, expected));
    }
    let (partly, warnings) = read_text(&document(
        "standard_surface",
        &(input("metalness", "float", "0.25") + &input("specular", "float", "0")),
        "",
    ));
    assert_eq!(partly.unwrap().0.specular_weight.factor, 1.0);
    assert!(warnings[0].contains("specular is left out, as for metals"), "{warnings:?}");
}

#[test]
fn gltf_pbr_is_what_gltf_means() {
    let (plain, _) = sound(&document("gltf_pbr", "", ""));
    assert_eq!((plain.base_color.factor, plain.base_metalness.factor), (Vec3::ONE, 1.0));
    assert_eq!((plain.specular_roughness.factor, plain.emission_color.factor), (1.0, Vec3::ZERO));
    let alpha = input("alpha", "float", "0.25");
    let modes = [(0, 1.0), (1, 0.0), (2, 0.25)];
    for (mode, opacity) in modes {
        let inputs = alpha.clone() + &input("alpha_mode", "integer", &mode.to_string());
        assert_eq!(sound(&document("gltf_pbr", &inputs, "")).0.geometry_opacity.factor, opacity);
    }
    let images = r#"<gltf_colorimage name="c" type="multioutput">
        <input name="file" type="filename" value="c.png" colorspace="srgb_texture"/>
        <input name="color" type="color4" value="1, 0.5, 0.25, 1"/></gltf_colorimage>
        <gltf_normalmap name="n" type="vector3"><input name="file" type="filename" value="n.png"/></gltf_normalmap>"#;
    let inputs = "<input name=\"base_color\" type=\"color3\" nodename=\"c\" output=\"outcolor\"/>
        <input name=\"alpha\" type=\"float\" nodename=\"c\" output=\"outa\"/>
        <input name=\"normal\" type=\"vector3\" nodename=\"n\"/>"
        .to_owned()
        + &input("alpha_mode", "integer", "2")
        + &input("metallic", "float", "0")
        + &input("transmission", "float", "1")
        + &input("emissive", "color3", "1, 0.5, 0");
    let (found, files) = sound(&document("gltf_pbr", &inputs, images));
    assert_eq!(files.len(), 2, "{files:?}");
    assert_eq!(found.base_color.factor, Vec3::new(1.0, 0.5, 0.25));
    assert_eq!(found.transmission_color, found.base_color);
    assert_eq!(found.geometry_opacity.texture.map(|(_, channel)| channel), Some(Channel::Alpha));
    assert!(found.geometry_normal.is_some());
    assert_eq!((found.emission_color.factor, found.emission_luminance), (Vec3::new(1.0, 0.5, 0.0), 1.0));
}

#[test]
fn usd_preview_surface_has_clear_opacity_and_two_workflows() {
    let (plain, _) = sound(&document("UsdPreviewSurface", "", ""));
    assert_eq!((plain.base_color.factor, plain.coat_roughness.factor), (Vec3::splat(0.18), 0.01));
    let with = |inputs: &[String]| sound(&document("UsdPreviewSurface", &inputs.concat(), "")).0;
    let half = input("opacity", "float", "0.25");
    assert_eq!(with(std::slice::from_ref(&half)).transmission_weight.factor, 0.75);
    let presence = with(&[half.clone(), input("opacityMode", "integer", "1")]);
    assert_eq!((presence.transmission_weight.factor, presence.geometry_opacity.factor), (0.0, 0.25));
    assert_eq!(with(&[half, input("opacityThreshold", "float", "0.5")]).geometry_opacity.factor, 0.0);
    let specular = input("specularColor", "color3", "0.04, 0.02, 0.01");
    let found =
        with(&[specular, input("useSpecularWorkflow", "integer", "1"), input("metallic", "float", "1")]);
    assert!((found.specular_ior - 1.5).abs() < 1e-6 && found.base_metalness.factor == 0.0);
    assert!(found.specular_color.factor.abs_diff_eq(Vec3::new(1.0, 0.5, 0.25), 1e-6));
}

#[test]
fn disney_principled_is_translated_by_its_definition() {
    let (plain, _) = sound(&document("disney_principled", "", ""));
    assert!((plain.specular_ior - 1.5).abs() < 1e-6 && plain.base_color.factor == Vec3::splat(0.16));
    let inputs = [
        input("baseColor", "color3", "0.5, 0.25, 1"),
        input("specular", "float", "1"),
        input("specularTint", "float", "0.5"),
        input("clearcoatGloss", "float", "0.75"),
        input("subsurface", "float", "1"),
        input("subsurfaceDistance", "color3", "1, 0.5, 0.25"),
    ];
    let (found, _) = sound(&document("disney_principled", &inputs.concat(), ""));
    let reflectance = ((found.specular_ior - 1.0) / (found.specular_ior + 1.0)).powi(2);
    assert!((reflectance - 0.08).abs() < 1e-6, "{reflectance}");
    assert_eq!(found.specular_color.factor, Vec3::new(0.75, 0.625, 1.0));
    assert_eq!((found.coat_roughness.factor, found.subsurface_weight.factor), (0.25, 1.0));
    assert_eq!(found.subsurface_color, found.base_color);
    assert_eq!(found.subsurface_radius_scale.factor, Vec3::new(1.0, 0.5, 0.25));
    let gold = input("metallic", "float", "1") + &input("specular", "float", "0");
    assert_eq!(sound(&document("disney_principled", &gold, "")).0.specular_weight.factor, 1.0);
}
