//! Valid scene files: every feature, and the defaults of what is left out.

use glam::{DVec3, Mat3, Vec2, Vec3};
use translucid_profile::convention::preset;
use translucid_scene::{
    Camera, CameraVisibility, Channel, ColorInput, ColorSpace, Configuration, Film, FilterKind, ImageKind,
    Integrator, LayerMedium, Light, Material, Projection, ScalarInput, SubsurfaceLayer, SubsurfaceMethod,
    SubsurfaceModel, SubsurfaceNormalization, SubsurfaceParameter, SubsurfaceTextureAt, TextureFilter,
    ToneMapping, Unit, Wrap,
};

use super::{BALL, load, parse};
use crate::{LoadOptions, Surroundings, Viewpoint};

fn with_ball(piece: &str) -> String {
    format!("unit = \"mm\"\n{BALL}{piece}\n")
}

/// The only material of a text.
fn material(lines: &str) -> Material {
    let text = with_ball(&format!("[[material]]\nname = \"m\"\n{lines}"));
    parse(&text).unwrap_or_else(|error| panic!("{error}")).scene.materials.swap_remove(0)
}

/// The only light of a text.
fn light(lines: &str) -> Light {
    parse(&with_ball(&format!("[[light]]\n{lines}"))).unwrap_or_else(|error| panic!("{error}")).scene.lights
        [0]
}

#[test]
fn scene_of_a_ball_has_every_default() {
    let scene = load(&format!("unit = \"cm\"\n{BALL}"));
    assert_eq!(scene.unit, Unit::Centimeter);
    assert_eq!((scene.film, scene.integrator), (Film::default(), Integrator::default()));
    assert_eq!(scene.materials, [Material::default()]);
    assert_eq!((scene.objects.len(), scene.objects[0].name.as_str()), (1, "sphere"));
    assert!(!scene.lights.is_empty() && scene.environment.is_some());
}

#[test]
fn camera_reads_every_key() {
    let text = "[camera]\nposition = [1, 2, 3]\ntarget = [4, 6, 3]\nup = [0, 0, 2]\nfov = 35.5\nshift = [0.25, -0.5]\nlens_radius = 0.25\nfocus_distance = 7";
    let expected = Camera {
        position: Vec3::new(1.0, 2.0, 3.0),
        target: Vec3::new(4.0, 6.0, 3.0),
        up: Vec3::new(0.0, 0.0, 2.0),
        projection: Projection::Perspective { horizontal_fov: 35.5 },
        shift: Vec2::new(0.25, -0.5),
        lens_radius: 0.25,
        focus_distance: 7.0,
    };
    assert_eq!(parse(&with_ball(text)).unwrap().camera(None), Ok(Some(expected)));
    let text = "[camera]\nposition = [1, 2, 3]\ntarget = [4, 6, 3]";
    let Camera { position, target, .. } = expected;
    let expected = Camera { position, target, ..Camera::default() };
    assert_eq!(parse(&with_ball(text)).unwrap().camera(None), Ok(Some(expected)));
    let text = format!("{text}\nprojection = \"orthographic\"\nwidth = 7.5");
    let expected = Camera { projection: Projection::Orthographic { width: 7.5 }, ..expected };
    assert_eq!(parse(&with_ball(&text)).unwrap().camera(None), Ok(Some(expected)));
}

#[test]
fn several_cameras_have_names_to_choose_them_by() {
    let text = with_ball(
        "[[camera]]\nname = 'front'\nposition = [0, 0, 5]\ntarget = [0, 0, 0]\n\
         [[camera]]\nname = 'ear'\nposition = [4, 0, 0]\ntarget = [0, 0, 0]",
    );
    let load = |camera: Option<&str>| {
        let options = LoadOptions { camera: camera.map(String::from), ..LoadOptions::default() };
        parse(&text).unwrap().load(&options, &mut Vec::new()).map(|scene| scene.camera.position)
    };
    assert_eq!(load(None), Ok(Vec3::new(0.0, 0.0, 5.0)));
    assert_eq!(load(Some("ear")), Ok(Vec3::new(4.0, 0.0, 0.0)));
    let error = load(Some("nose")).unwrap_err();
    assert_eq!(error.message, "there is no camera \"nose\"");
    assert_eq!(error.help.as_deref(), Some("the cameras are front, ear"));
}

#[test]
fn view_and_zoom_move_the_camera_of_a_scene_about_its_target() {
    let text = with_ball("[camera]\nposition = [1, 0, 6]\ntarget = [1, 0, 0]\nshift = [0.5, 0]\nfov = 60");
    let load = |options: &LoadOptions| parse(&text).unwrap().load(options, &mut Vec::new()).unwrap().camera;
    let seen = load(&LoadOptions { viewpoint: Viewpoint::from_text("right"), ..LoadOptions::default() });
    assert!(seen.position.abs_diff_eq(Vec3::new(7.0, 0.0, 0.0), 1e-5), "{seen:?}");
    let turned = load(&LoadOptions { turn: Some(90.0), ..LoadOptions::default() });
    assert!(turned.position.abs_diff_eq(Vec3::new(-5.0, 0.0, 0.0), 1e-5), "{turned:?}");
    let near = load(&LoadOptions { zoom: Some(2.0), ..LoadOptions::default() });
    let width = near.projection.width_at(0.5);
    assert!((2.0 * width - 30f64.to_radians().tan()).abs() < 1e-6, "{near:?}");
    // What was in the middle of the picture stays there
    assert_eq!(near.shift, Vec2::new(1.0, 0.0));
    let options = LoadOptions { zoom: Some(f32::NAN), ..LoadOptions::default() };
    assert!(parse(&text).unwrap().load(&options, &mut Vec::new()).is_err());
}

#[test]
fn surroundings_replace_the_environment_and_the_lights_that_were_chosen() {
    let folder = tempfile::tempdir().unwrap();
    let sky = folder.path().join("sky.hdr");
    std::fs::write(
        &sky,
        b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\x80\x40\x20\x81\x80\x80\x80\x81",
    )
    .unwrap();
    let load = |text: &str, surroundings: Surroundings| {
        let options = LoadOptions { surroundings, ..LoadOptions::default() };
        parse(text).unwrap().load(&options, &mut Vec::new())
    };
    let changes = Surroundings { file: Some(sky.clone()), rotation: Some(90.0), strength: Some(0.5) };
    let scene = load(&with_ball(""), changes.clone()).unwrap();
    let environment = scene.environment.unwrap();
    assert_eq!((scene.lights.len(), environment.image, environment.radiance), (0, Some(0), Vec3::splat(0.5)));
    assert_eq!(scene.images[0].path.as_deref(), Some(sky.as_path()));
    assert!((environment.world_from_environment * Vec3::Z).abs_diff_eq(Vec3::X, 1e-6));
    // What a scene states of both stays, but for what is changed.
    let lit = with_ball(
        "[environment]\nradiance = 2\n[[light]]\ntype = 'point'\nposition = [0, 9, 0]\nintensity = 1",
    );
    let scene = load(&lit, Surroundings { file: None, ..changes.clone() }).unwrap();
    assert_eq!((scene.lights.len(), scene.environment.unwrap().radiance), (1, Vec3::ONE));
    let lamp = with_ball("[[light]]\ntype = 'point'\nposition = [0, 9, 0]\nintensity = 1");
    let error = load(&lamp, Surroundings { file: None, ..changes.clone() }).unwrap_err();
    assert_eq!(error.message, "the scene has no environment that could be turned or made brighter");
    let error = load(&lit, Surroundings { strength: Some(-1.0), ..Surroundings::default() }).unwrap_err();
    assert!(error.message.starts_with("environment, radiance[0] = -2: must be in [0, "), "{error}");
    let error = load(&lit, Surroundings { file: Some("absent.exr".into()), ..changes }).unwrap_err();
    assert!(error.message.starts_with("cannot be read"), "{error}");
}

#[test]
fn film_and_integrator_read_every_key() {
    let text = "[film]\nsize = [640, 0x1e0]\nfilter = \"gaussian\"\nfilter_radius = 2\nexposure = -1.5\ntone_mapping = \"agx\"\n\
                [integrator]\nsamples_per_pixel = 1_024\nmax_depth = 7\nmax_diffuse_depth = 3\ncaustics = true\nsubsurface_tail = 1e-4\n\
                subsurface_method = \"point-based\"\nsubsurface_sharing = false\npoint_tolerance = 0.125\npoint_memory = 77\nseed = 18446744073709551615";
    let file = parse(&with_ball(text)).unwrap();
    let film = Film {
        width: 640,
        height: 480,
        filter: FilterKind::Gaussian,
        filter_radius: 2.0,
        exposure: -1.5,
        tone_mapping: ToneMapping::Agx,
    };
    let integrator = Integrator {
        samples_per_pixel: 1024,
        max_depth: 7,
        max_diffuse_depth: 3,
        caustics: true,
        subsurface_tail: 1e-4,
        subsurface_method: SubsurfaceMethod::PointBased,
        subsurface_sharing: false,
        point_tolerance: 0.125,
        point_memory: 77,
        seed: u64::MAX,
    };
    assert_eq!((file.scene.film, file.scene.integrator), (film, integrator));
    assert_eq!(parse(&with_ball("[film]\nfilter = \"box\"")).unwrap().scene.film.filter_radius, 0.5);
}

#[test]
fn material_reads_every_constant() {
    let text = "base_weight = 0.5\nbase_color = [0.1, 0.2, 0.3]\nbase_metalness = 1\nspecular_weight = 0.25\n\
        specular_color = 0.5\nspecular_roughness = 0.75\nspecular_ior = 1.25\ntransmission_weight = 0.125\n\
        transmission_color = \"#ff0000\"\ntransmission_depth = 3\ntransmission_tint = [0.5, 1, 0.25]\nsubsurface_weight = 1\n\
        subsurface_color = \"vertex\"\nsubsurface_radius = 2\nsubsurface_radius_scale = [3, 2, 1]\n\
        subsurface_scatter_anisotropy = -0.5\nsubsurface_model = \"none\"\nsubsurface_parameter = \"dmfp\"\n\
        subsurface_configuration = \"searchlight\"\nsubsurface_eta = 1.4\nsubsurface_flights = 250\n\
        subsurface_texture_at = \"both\"\nsubsurface_normalization = \"energy\"\ncamera_visibility = \"shadow\"\ncoat_weight = 0.5\ncoat_color = [1, 1, 0]\n\
        coat_roughness = 0.1\ncoat_ior = 1.4\nemission_luminance = 100\nemission_color = [5, 6, 7]\ngeometry_opacity = 0.5\ngeometry_thin_walled = true";
    let color = |r, g, b| ColorInput::constant(Vec3::new(r, g, b));
    let expected = Material {
        name: String::from("m"),
        base_weight: 0.5,
        base_color: color(0.1, 0.2, 0.3),
        base_metalness: ScalarInput::constant(1.0),
        specular_weight: ScalarInput::constant(0.25),
        specular_color: color(0.5, 0.5, 0.5),
        specular_roughness: ScalarInput::constant(0.75),
        specular_ior: 1.25,
        transmission_weight: ScalarInput::constant(0.125),
        transmission_color: color(1.0, 0.0, 0.0),
        transmission_depth: 3.0,
        transmission_tint: color(0.5, 1.0, 0.25),
        subsurface_weight: ScalarInput::constant(1.0),
        subsurface_color: ColorInput::vertex(),
        subsurface_radius: ScalarInput::constant(2.0),
        subsurface_radius_scale: color(3.0, 2.0, 1.0),
        subsurface_scatter_anisotropy: -0.5,
        subsurface_model: SubsurfaceModel::None,
        subsurface_parameter: SubsurfaceParameter::Dmfp,
        subsurface_configuration: Configuration::Searchlight,
        subsurface_eta: 1.4,
        subsurface_flights: 250.0,
        layers: Vec::new(),
        subsurface_texture_at: SubsurfaceTextureAt::Both,
        subsurface_normalization: SubsurfaceNormalization::Energy,
        coat_weight: ScalarInput::constant(0.5),
        coat_color: color(1.0, 1.0, 0.0),
        coat_roughness: ScalarInput::constant(0.1),
        coat_ior: 1.4,
        emission_luminance: 100.0,
        emission_color: color(5.0, 6.0, 7.0),
        geometry_opacity: ScalarInput::constant(0.5),
        geometry_thin_walled: true,
        geometry_normal: None,
        camera_visibility: CameraVisibility::Shadow,
    };
    assert_eq!(material(text), expected);
    assert_eq!(material(""), Material { name: String::from("m"), ..Material::default() });
}

#[test]
fn material_reads_layers() {
    let layers = "[[material.layer]]\nthickness = 0.1\nsurface_albedo = '#ffffff'\nmfp = [0.3, 0.2, 0.1]\ng = 0.8\n\
                  [[material.layer]]\nthickness = 1e9\nscattering = 2\nabsorption = [0, 0.5, 0]";
    let expected = vec![
        SubsurfaceLayer {
            thickness: 0.1,
            medium: LayerMedium::Appearance { surface_albedo: Vec3::ONE, mfp: Vec3::new(0.3, 0.2, 0.1) },
            g: 0.8,
        },
        SubsurfaceLayer {
            thickness: 1e9,
            medium: LayerMedium::Coefficients {
                scattering: Vec3::splat(2.0),
                absorption: Vec3::new(0.0, 0.5, 0.0),
            },
            g: 0.0,
        },
    ];
    assert_eq!(material(layers).layers, expected);
    // Layers are for walks, whatever else asks for profiles
    let points = Integrator { subsurface_method: SubsurfaceMethod::PointBased, ..Integrator::default() };
    for (text, model) in [
        ("", "random-walk"),
        ("subsurface_texture_at = \"both\"\n", "random-walk"),
        ("subsurface_eta = 1.4\n", "random-walk-rough"),
        ("subsurface_eta = 1.4\nsubsurface_configuration = \"searchlight\"\n", "random-walk"),
        ("subsurface_model = \"random-walk-diffuse\"\n", "random-walk-diffuse"),
    ] {
        assert_eq!(material(&format!("{text}{layers}")).model(&points).name(), model, "{text}");
    }
    assert_eq!(material("layer = \"none\"").layers, []);
}

/// The walk, between rough surfaces where there is a boundary; where a key asks for profiles, the one that knows the medium:
/// oblique light is solved without phase function and boundary, the round profile knows both.
#[test]
fn material_without_a_model_walks_but_where_it_asks_for_a_profile() {
    let probes = Integrator::default();
    let points = Integrator { subsurface_method: SubsurfaceMethod::PointBased, ..probes };
    let (oblique, refined) = ("normalized-diffusion-oblique", "normalized-diffusion-refined");
    for (text, with_probes, with_points) in [
        ("", "random-walk", oblique),
        ("preset = \"skin1\"", "random-walk", oblique),
        ("subsurface_model = \"default\"", "random-walk", oblique),
        ("subsurface_configuration = \"searchlight\"", "random-walk", oblique),
        ("subsurface_scatter_anisotropy = 0.5", "random-walk", refined),
        ("subsurface_eta = 1.4", "random-walk-rough", refined),
        ("subsurface_eta = 1.4\nsubsurface_configuration = \"searchlight\"", refined, refined),
        ("subsurface_eta = 0.9", "random-walk", refined),
        ("subsurface_eta = 1.4\nsubsurface_texture_at = \"both\"", refined, refined),
        ("subsurface_texture_at = \"entry\"", oblique, oblique),
        ("subsurface_texture_at = \"both\"\nsubsurface_scatter_anisotropy = 0.5", refined, refined),
        ("subsurface_normalization = \"energy\"", oblique, oblique),
        ("subsurface_eta = 1.4\nsubsurface_model = \"dipole\"", "dipole", "dipole"),
        ("subsurface_model = \"random-walk\"\nsubsurface_eta = 1.4", "random-walk", "random-walk"),
        (
            "subsurface_model = \"random-walk\"\nsubsurface_texture_at = \"both\"",
            "random-walk",
            "random-walk",
        ),
        ("subsurface_model = \"none\"", "none", "none"),
    ] {
        let material = material(text);
        let models = [probes, points].map(|integrator| material.model(&integrator).name());
        assert_eq!(models, [with_probes, with_points], "{text}");
    }
}

#[test]
fn material_preset_fills_in_what_is_not_said() {
    let skin = Material::of_preset(preset("skin1").unwrap(), Unit::Millimeter);
    let expected = Material { name: String::from("m"), coat_weight: ScalarInput::constant(1.0), ..skin };
    assert_eq!(material("preset = \"skin1\"\ncoat_weight = 1"), expected);
}

#[test]
fn material_textures_have_their_mapping() {
    let text = with_ball(
        "[[material]]\nname = \"m\"\n\
         base_color = { file = \"a.png\", factor = [1, 2, 3], uv_scale = [2, 3], uv_offset = [0.5, 0], uv_rotation = 90, wrap = [\"clamp\", \"mirror\"], vertex_color = true }\n\
         subsurface_color = { file = \"a.png\" }\n\
         coat_weight = { file = \"a.png\", channel = \"blue\", factor = 0.5, wrap = \"clamp\", filter = \"nearest\" }\n\
         geometry_normal = { file = \"n.png\", scale = -2 }",
    );
    let file = parse(&text).unwrap();
    let m = &file.scene.materials[0];
    let kinds: Vec<ImageKind> = file.images.iter().map(|image| image.kind).collect();
    // One image in two color spaces is two images; the same in the same space is one.
    let data = ImageKind::Plain(ColorSpace::Linear);
    assert_eq!(kinds, [ImageKind::Color(ColorSpace::Srgb), data, data]);
    let base = m.base_color.texture.unwrap();
    assert_eq!((base.image, m.subsurface_color.texture.unwrap().image), (0, 0));
    assert_eq!(base.wrap, [Wrap::Clamp, Wrap::Mirror]);
    assert_eq!((m.base_color.factor, m.base_color.vertex_color), (Vec3::new(1.0, 2.0, 3.0), true));
    // (1, 1) is scaled to (2, 3), turned to (−3, 2), moved to (−2.5, 2).
    assert!(base.coordinates(Vec2::ONE).distance(Vec2::new(-2.5, 2.0)) < 1e-6);
    let (coat, channel) = m.coat_weight.texture.unwrap();
    assert_eq!([base.filter, coat.filter], [TextureFilter::Linear, TextureFilter::Nearest]);
    assert_eq!(
        (coat.image, channel, coat.wrap, m.coat_weight.factor),
        (1, Channel::Blue, [Wrap::Clamp; 2], 0.5)
    );
    let normal = m.geometry_normal.unwrap();
    assert_eq!((normal.texture.image, normal.scale), (2, -2.0));
}

#[test]
fn object_transform_scales_then_turns_then_moves() {
    let text = "unit = \"mm\"\n[[object]]\nshape = \"box\"\nscale = [2, 1, 1]\nrotate = [0, 0, 90]\ntranslate = [0, 0, 5]\n";
    let map = parse(text).unwrap().objects[0].places[0];
    // x doubles, then turns to y, then moves along z.
    assert!(map.transform_point3(DVec3::X).distance(DVec3::new(0.0, 2.0, 5.0)) < 1e-6);
    // About x first, then about z: y goes to z and stays; z goes to −y and then to x.
    let text = "unit = \"mm\"\n[[object]]\nshape = \"box\"\nrotate = [90, 0, 90]\n";
    let map = parse(text).unwrap().objects[0].places[0];
    assert!(map.transform_point3(DVec3::Y).distance(DVec3::Z) < 1e-6);
    assert!(map.transform_point3(DVec3::Z).distance(DVec3::X) < 1e-6);
}

#[test]
fn object_matrix_is_written_row_by_row() {
    let text = "unit = \"mm\"\n[[object]]\nshape = \"box\"\nmatrix = [1, 2, 0, 10,  0, 1, 0, 20,  0, 0, -1, 30,  0, 0, 0, 1]\n";
    let map = parse(text).unwrap().objects[0].places[0];
    assert_eq!(map.transform_point3(DVec3::new(1.0, 1.0, 1.0)), DVec3::new(13.0, 21.0, 29.0));
}

#[test]
fn object_shape_parameters_reach_the_shape() {
    let scene =
        load("unit = \"mm\"\n[[object]]\nname = \"ball\"\nshape = \"sphere\"\nradius = 2.5\nsegments = 16\n");
    let positions = &scene.objects[0].mesh.positions;
    assert!(positions.iter().all(|p| (p.length() - 2.5).abs() < 1e-5));
    assert!(positions.len() < 200);
    assert_eq!(scene.objects[0].name, "ball");
}

#[test]
fn objects_share_subsurface_scattering_by_material_on_request() {
    let object = |keys: &str| format!("[[object]]\nshape = \"box\"\n{keys}\n");
    let (wax, milk) = ("material = \"wax\"", "material = \"milk\"");
    let named = "material = \"wax\"\nsubsurface_group = \"apart\"";
    let objects: String = [wax, milk, wax, named].map(object).concat();
    let groups = |grouping: &str| -> Vec<u32> {
        let materials = "[[material]]\nname = \"wax\"\n[[material]]\nname = \"milk\"\n";
        let scene = load(&format!("unit = \"mm\"\n{grouping}\n{materials}{objects}"));
        scene.objects.iter().map(|object| object.subsurface_group).collect()
    };
    assert_eq!(groups("subsurface_grouping = \"material\""), [0, 1, 0, 2]);
    assert_eq!(groups(""), [0, 1, 2, 3]);
}

#[test]
fn objects_share_subsurface_scattering_by_group_name() {
    let object = |group: &str| format!("[[object]]\nshape = \"box\"\n{group}\n");
    let (a, b) = ("subsurface_group = \"a\"", "subsurface_group = \"b\"");
    let text: String = [a, "", a, "", b].map(object).concat();
    let scene = load(&format!("unit = \"mm\"\n{text}"));
    let groups: Vec<u32> = scene.objects.iter().map(|object| object.subsurface_group).collect();
    assert_eq!(groups, [0, 1, 0, 2, 3]);
    let names: Vec<&str> = scene.objects.iter().map(|object| object.name.as_str()).collect();
    assert_eq!(names[..2], ["box", "box (object 2)"]);
}

#[test]
fn light_rectangle_faces_its_target_with_its_edges_upright() {
    let text = "type = \"rectangle\"\ncenter = [0, 0, 10]\ntarget = [0, 0, 0]\nsize = [4, 2]\nradiance = 3";
    let expected = Light::Rectangle {
        center: Vec3::new(0.0, 0.0, 10.0),
        edge_x: Vec3::new(-4.0, 0.0, 0.0),
        edge_y: Vec3::new(0.0, 2.0, 0.0),
        radiance: Vec3::splat(3.0),
        visible: true,
    };
    assert_eq!(light(text), expected);
    for target in ["[3, -7, 2]", "[0, -1, 10]", "[0, 1, 10]", "[1e-3, -1e3, 10]"] {
        let text = format!(
            "type = \"rectangle\"\ncenter = [0, 0, 10]\ntarget = {target}\nsize = [4, 2]\nradiance = 3"
        );
        let Light::Rectangle { edge_x, edge_y, .. } = light(&text) else { panic!() };
        assert!((edge_x.length() - 4.0).abs() < 1e-5 && (edge_y.length() - 2.0).abs() < 1e-5);
        assert!(edge_x.dot(edge_y).abs() < 1e-5 && edge_x.y.abs() < 1e-5, "{target}: {edge_x} {edge_y}");
    }
}

#[test]
fn lights_read_every_key() {
    let text = "type = \"sphere\"\ncenter = [1, 2, 3]\nradius = 4\nradiance = [5, 6, 7]\nvisible = false";
    let (center, color) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(5.0, 6.0, 7.0));
    assert_eq!(light(text), Light::Sphere { center, radius: 4.0, radiance: color, visible: false });
    let text = "type = \"distant\"\ndirection = [0, 2, 0]\nangular_radius = 0.27\nirradiance = [5, 6, 7]";
    assert_eq!(light(text), Light::Distant { direction: Vec3::Y, angular_radius: 0.27, irradiance: color });
    let text = "type = \"spot\"\nposition = [1, 2, 3]\ntarget = [1, 2, 9]\ninner_angle = 10\nouter_angle = 20\nintensity = [5, 6, 7]";
    let spot = |direction, inner_angle, outer_angle| Light::Spot {
        radius: 0.0,
        visible: true,
        position: center,
        direction,
        intensity: color,
        inner_angle,
        outer_angle,
    };
    assert_eq!(light(text), spot(Vec3::Z, 10.0, 20.0));
    let text = "type = \"point\"\nposition = [1, 2, 3]\nintensity = [5, 6, 7]";
    assert_eq!(light(text), spot(Vec3::NEG_Y, 0.0, 180.0));
    let text = "type = \"beam\"\norigin = [1, 2, 3]\ndirection = [-3, 0, 0]\nradius = 0.5\npower = [5, 6, 7]";
    let beam = Light::Beam { origin: center, direction: Vec3::NEG_X, radius: 0.5, power: color };
    assert_eq!(light(text), beam);
}

#[test]
fn environment_reads_every_key() {
    let text = "[environment]\nradiance = [1, 2, 3]\nfile = \"sky.exr\"\nrotation = 90\nvisible = false";
    let file = parse(&with_ball(text)).unwrap();
    let environment = file.scene.environment.unwrap();
    assert_eq!((environment.radiance, environment.image), (Vec3::new(1.0, 2.0, 3.0), Some(0)));
    assert!(!environment.visible);
    // The middle of the image, −z, turns to −x.
    let turned = environment.world_from_environment * Vec3::NEG_Z;
    assert!(turned.distance(Vec3::NEG_X) < 1e-6, "{turned}");
    let plain = parse(&with_ball("[environment]\nradiance = 0.5")).unwrap().scene.environment.unwrap();
    assert_eq!((plain.radiance, plain.image, plain.visible), (Vec3::splat(0.5), None, true));
    assert_eq!(plain.world_from_environment, Mat3::IDENTITY);
}

#[test]
fn scene_with_a_light_of_its_own_gets_no_other() {
    let scene = load(&with_ball("[environment]\nradiance = 1"));
    assert!(scene.lights.is_empty());
    let scene = load(&with_ball("[[light]]\ntype = \"point\"\nposition = [0, 9, 0]\nintensity = 1"));
    assert!(scene.lights.len() == 1 && scene.environment.is_none());
    let glowing = "unit = \"mm\"\n[[material]]\nname = \"glow\"\nemission_luminance = 1\n[[object]]\nshape = \"sphere\"\nmaterial = \"glow\"\n";
    let scene = load(glowing);
    assert!(scene.lights.is_empty() && scene.environment.is_none());
}

#[test]
fn option_size_changes_the_film_and_the_framing() {
    let text = with_ball("[film]\nsize = [100, 50]\nexposure = 1");
    let options = LoadOptions { size: Some([50, 200]), ..LoadOptions::default() };
    let wide = parse(&text).unwrap().load(&LoadOptions::default(), &mut Vec::new()).unwrap();
    let tall = parse(&text).unwrap().load(&options, &mut Vec::new()).unwrap();
    assert_eq!((tall.film.width, tall.film.height, tall.film.exposure), (50, 200, 1.0));
    // The frame's height limits the wide picture, so that its camera stands further off.
    assert!(wide.camera.focus_distance > 1.5 * tall.camera.focus_distance);
}
