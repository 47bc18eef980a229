//! Numbers that Rust and the shaders both state.

use glam::Vec3;
use translucid_profile::Model;
use translucid_render::PreparedScene;
use translucid_render::device::{DeviceLimits, DeviceScene, Header, shader_constants};
use translucid_scene::{
    CameraVisibility, ColorInput, Material, NormalMap, ScalarInput, SubsurfaceNormalization, TextureRef,
    WalkSurface,
};
use wgpu::naga;

use super::profile_tests::profile;
use super::tests::{matte, scene, texture, wax};
use super::*;

/// The stride of slots is that of the shaders.
#[test]
fn slots_have_the_size_of_the_shaders() {
    let text = text();
    let module = match naga::front::wgsl::parse_str(&text) {
        Ok(module) => module,
        Err(error) => panic!("{}", error.emit_to_string(&text)),
    };
    let span = module.types.iter().find_map(|(_, kind)| match (&kind.name, &kind.inner) {
        (Some(name), naga::TypeInner::Struct { span, .. }) if name == "Slot" => Some(*span),
        _ => None,
    });
    assert_eq!(span.map(u64::from), Some(SLOT_BYTES));
}

/// The number of a constant of the shaders.
fn constant(name: &str) -> f32 {
    let text = text();
    let beginning = format!("const {name} = ");
    let all: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix(&beginning)).collect();
    let [value] = all[..] else { panic!("{name} is stated {} times", all.len()) };
    value.split([';', 'u']).next().and_then(|digits| digits.parse().ok()).unwrap()
}

#[test]
fn constants_are_those_of_the_shaders() {
    let own = [
        ("SAMPLE_WORDS", SAMPLE_WORDS),
        ("COUNTERS", COUNTERS as usize),
        ("RAYS", LIST_COUNTERS.start as usize),
        ("SHADOW_DEPTHS", LIST_COUNTERS.end as usize - 1),
    ];
    for (name, value) in shader_constants().chain(own) {
        assert_eq!(constant(name), value as f32, "{name}");
    }
}

/// Materials whose numbers all differ stand where the shaders read them: inputs, constants, and what is below the surface.
#[test]
fn materials_are_where_the_shaders_read_them() {
    let mut next = 0.1;
    let mut number = || {
        next += 0.01;
        next
    };
    let mut color = || ColorInput::constant(Vec3::from_array([(); 3].map(|()| number())));
    let [
        base_color,
        specular_color,
        transmission_color,
        subsurface_color,
        subsurface_radius_scale,
        coat_color,
        emission_color,
    ] = [(); 7].map(|()| color());
    let mut scalar = || ScalarInput::constant(number());
    let [
        base_metalness,
        specular_weight,
        specular_roughness,
        transmission_weight,
        subsurface_weight,
        subsurface_radius,
        coat_weight,
        coat_roughness,
        geometry_opacity,
    ] = [(); 9].map(|()| scalar());
    let walk = Material {
        base_color,
        specular_color,
        transmission_color,
        subsurface_color,
        subsurface_radius_scale,
        coat_color,
        emission_color,
        base_metalness,
        specular_weight,
        specular_roughness,
        transmission_weight,
        subsurface_weight,
        subsurface_radius,
        coat_weight,
        coat_roughness,
        geometry_opacity,
        geometry_normal: Some(NormalMap { texture: TextureRef::new(0), scale: number() }),
        base_weight: number(),
        specular_ior: 1.0 + number(),
        transmission_depth: number(),
        subsurface_scatter_anisotropy: number(),
        coat_ior: 1.0 + number(),
        emission_luminance: number(),
        camera_visibility: CameraVisibility::Shadow,
        subsurface_eta: 1.0 + number(),
        subsurface_flights: 1234.0,
        ..wax(WalkSurface::Skin)
    };
    let thin = Material { geometry_thin_walled: true, camera_visibility: CameraVisibility::None, ..matte() };
    let below = Material {
        subsurface_normalization: SubsurfaceNormalization::Energy,
        ..profile(Model::NormalizedDiffusion)
    };
    let mut scene = scene(walk.clone(), thin);
    scene.materials.push(below.clone());
    scene.objects[1].material = 2;
    scene.images.push(Arc::new(texture()));
    let prepared = PreparedScene::new(scene).unwrap();
    let view = prepared.view().unwrap();
    let words = DeviceScene::new(&prepared, &view, &DeviceLimits { array_bytes: 1 << 27 }).unwrap().tables;
    let head = |place: Header| words[place as usize] as usize;
    let place = |name: &str| constant(name) as usize;
    let word = |material: usize, name: &str| {
        words[head(Header::Materials) + material * head(Header::MaterialWords) + place(name)]
    };
    let input = |name: &str| {
        let at = head(Header::Materials) + place("INPUT_WORDS") * place(name);
        Vec3::from_slice(&words[at..])
    };
    for (name, expected) in [
        ("BASE_COLOR", &walk.base_color),
        ("SPECULAR_COLOR", &walk.specular_color),
        ("TRANSMISSION_COLOR", &walk.transmission_color),
        ("SUBSURFACE_COLOR", &walk.subsurface_color),
        ("RADIUS_SCALE", &walk.subsurface_radius_scale),
        ("COAT_COLOR", &walk.coat_color),
        ("EMISSION_COLOR", &walk.emission_color),
    ] {
        assert_eq!(input(name), expected.factor, "{name}");
    }
    for (name, expected) in [
        ("METALNESS", &walk.base_metalness),
        ("SPECULAR_WEIGHT", &walk.specular_weight),
        ("SPECULAR_ROUGHNESS", &walk.specular_roughness),
        ("TRANSMISSION_WEIGHT", &walk.transmission_weight),
        ("SUBSURFACE_WEIGHT", &walk.subsurface_weight),
        ("SUBSURFACE_RADIUS", &walk.subsurface_radius),
        ("COAT_WEIGHT", &walk.coat_weight),
        ("COAT_ROUGHNESS", &walk.coat_roughness),
        ("OPACITY", &walk.geometry_opacity),
    ] {
        assert_eq!(input(name), Vec3::splat(expected.factor), "{name}");
    }
    assert_eq!(place("NORMAL_MAP") + 1, place("INPUTS"));
    assert_eq!(place("INPUTS") * place("INPUT_WORDS"), place("BASE_WEIGHT"));
    let texture_at = head(Header::Materials) + place("INPUT_WORDS") * place("NORMAL_MAP") + 3;
    assert_eq!(words[texture_at], 0.0, "the map is the first texture");
    for (material, name, expected) in [
        (0, "BASE_WEIGHT", walk.base_weight),
        (0, "SPECULAR_IOR", walk.specular_ior),
        (0, "TRANSMISSION_DEPTH", walk.transmission_depth),
        (0, "ANISOTROPY", walk.subsurface_scatter_anisotropy),
        (0, "COAT_IOR", walk.coat_ior),
        (0, "EMISSION_LUMINANCE", walk.emission_luminance),
        (0, "THIN_WALLED", 0.0),
        (1, "THIN_WALLED", 1.0),
        (0, "NORMAL_SCALE", walk.geometry_normal.as_ref().unwrap().scale),
        (0, "CAMERA_VISIBILITY", constant("SHADOWS_SEEN")),
        (1, "CAMERA_VISIBILITY", constant("NOT_SEEN")),
        (0, "BELOW_KIND", constant("WALK_BELOW")),
        (1, "BELOW_KIND", 0.0),
        (2, "BELOW_KIND", constant("PROFILE_BELOW")),
        (0, "WALK_SURFACE", constant("SKIN")),
        (0, "WALK_ETA", walk.subsurface_eta),
        (0, "WALK_G", walk.subsurface_scatter_anisotropy),
        (0, "MOST_FLIGHTS", walk.subsurface_flights),
        (2, "PAIRING", 0.0),
        (0, "LETS_LIGHT_THROUGH", 1.0),
        (2, "LETS_LIGHT_THROUGH", 0.0),
    ] {
        assert_eq!(word(material, name), expected, "{name} of material {material}");
    }
    let reflectances = word(0, "REFLECTANCES") as usize;
    assert_eq!(words[reflectances..reflectances + 2], [walk.specular_ior, walk.coat_ior]);
    // √(1 − α) falls from 1 to 0 over the surface albedo, behind which lengths begin
    let medium = head(Header::Media) + word(0, "MEDIUM") as usize;
    let roots = &words[medium..=medium + place("ALBEDOS")];
    assert_eq!([roots[0], roots[place("ALBEDOS")]], [1.0, 0.0]);
    assert!(roots.is_sorted_by(|a, b| a > b) && words[medium + place("ALBEDOS") + 1] > 0.0);
    // Surface albedos rise to 1 over the rows of a profile and of its smooth table
    for (name, rows, first, step) in [
        ("MEDIUM", place("ROW_COUNT"), place("ROWS_OF_ALBEDO"), place("ROW_WORDS")),
        (
            "NORMALIZATION",
            0,
            1,
            2 + 5 * ((place("OCTAVES_BELOW") + place("OCTAVES_ABOVE")) << place("CELL_BITS")),
        ),
    ] {
        let at = head(Header::Media) + word(2, name) as usize;
        let rows = words[at + rows] as usize;
        let albedos: Vec<f32> = (0..rows).map(|row| words[at + first + step * row]).collect();
        assert!(
            rows > 1 && albedos.is_sorted_by(|a, b| a < b) && albedos[rows - 1] <= 1.0,
            "{name}: {albedos:?}"
        );
    }
}
