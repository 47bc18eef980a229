//! Written scene files: whatever was edited reads back to the same bits.

use std::fs;
use std::sync::Arc;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::{Mat3, Quat, Vec2, Vec3};
use tempfile::TempDir;
use translucid_scene::description::{Content, Provenance, SceneSlot, Value, quoted};
use translucid_scene::{
    CameraVisibility, ColorInput, Configuration, Environment, FilterKind, Image, LayerMedium, Light,
    Material, Projection, Scene, SubsurfaceLayer, SubsurfaceMethod, SubsurfaceModel, SubsurfaceNormalization,
    SubsurfaceParameter, SubsurfaceTextureAt, ToneMapping, Unit,
};
use translucid_testing::{SplitMix, power};

use crate::result::Result;
use crate::{
    ExtendedBase, Floor, LoadOptions, MeshBase, Surroundings, UpAxis, Viewpoint, load_image, load_scene,
    still_life,
};

/// A triangle with texture coordinates and vertex colors, twice under one name; two materials share a name, too.
fn textured_gltf() -> String {
    let floats: [f32; 27] = [
        0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, // positions
        0.0, 0.0, 1.0, 0.0, 0.0, 1.0, // texture coordinates
        1.0, 0.5, 0.25, 1.0, 1.0, 0.5, 0.25, 1.0, 1.0, 0.5, 0.25, 1.0, // colors
    ];
    let buffer = STANDARD.encode(floats.map(f32::to_le_bytes).concat());
    let image = STANDARD.encode(png());
    format!(
        r#"{{ "asset": {{ "version": "2.0" }},
        "buffers": [{{ "byteLength": 108, "uri": "data:application/octet-stream;base64,{buffer}" }}],
        "bufferViews": [
            {{ "buffer": 0, "byteLength": 36 }},
            {{ "buffer": 0, "byteOffset": 36, "byteLength": 24 }},
            {{ "buffer": 0, "byteOffset": 60, "byteLength": 48 }}],
        "accessors": [
            {{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0] }},
            {{ "bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2" }},
            {{ "bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC4" }}],
        "images": [{{ "uri": "data:image/png;base64,{image}" }}],
        "textures": [{{ "source": 0 }}],
        "materials": [
            {{ "name": "skin", "normalTexture": {{ "index": 0, "scale": 0.5 }},
               "pbrMetallicRoughness": {{ "baseColorTexture": {{ "index": 0 }}, "baseColorFactor": [1, 0.5, 0.25, 1],
                                          "metallicRoughnessTexture": {{ "index": 0 }} }} }},
            {{ "name": "skin" }},
            {{ "emissiveFactor": [0.5, 0.25, 0] }}],
        "meshes": [{{ "name": "part", "primitives": [
            {{ "attributes": {{ "POSITION": 0, "TEXCOORD_0": 1, "COLOR_0": 2 }}, "material": 0 }},
            {{ "attributes": {{ "POSITION": 0 }}, "material": 1 }},
            {{ "attributes": {{ "POSITION": 0 }}, "material": 2 }}] }}],
        "nodes": [{{ "mesh": 0 }}] }}"#
    )
}

/// A picture of one pixel.
fn png() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header().and_then(|mut writer| writer.write_image_data(&[200, 100, 50])).unwrap();
    bytes
}

/// A base to edit, in a folder of its own.
struct Editing {
    folder: TempDir,
    base: ExtendedBase,
    scene: Scene,
}

impl Editing {
    fn of(file: &str, text: &str, preset: Option<&str>, unit: Option<Unit>) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let preset = preset.map(String::from);
        let mesh = MeshBase { preset, unit, ..MeshBase::default() };
        let options = mesh.apply(LoadOptions::default());
        let base = ExtendedBase { extends: file.into(), mesh };
        let scene = if file == "still-life" {
            still_life(&LoadOptions::default()).unwrap()
        } else {
            fs::write(folder.path().join(file), text).unwrap();
            load_scene(&folder.path().join(file), &options, &mut Vec::new()).unwrap()
        };
        fs::write(folder.path().join("sky.png"), png()).unwrap();
        Self { folder, base, scene }
    }

    fn mesh() -> Self {
        let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
        Self::of("pyramid.obj", text, Some("jade"), Some(Unit::Centimeter))
    }

    fn gltf() -> Self {
        Self::of("parts.gltf", &textured_gltf(), None, None)
    }

    fn sky(&self) -> Arc<Image> {
        let path = self.folder.path().join("sky.png");
        Arc::new(load_image(&path, translucid_scene::ColorSpace::Srgb, &mut Vec::new()).unwrap())
    }

    fn text(&self, edited: &Scene) -> Result<String> {
        self.base.write(&self.scene, edited, Some("sky.png"))
    }

    /// The scene of the file that is written for an edited scene.
    fn read_back(&self, edited: &Scene) -> (String, Scene) {
        let text = self.text(edited).unwrap_or_else(|error| panic!("{error}"));
        let path = self.folder.path().join("saved.toml");
        fs::write(&path, &text).unwrap();
        let scene = load_scene(&path, &LoadOptions::default(), &mut Vec::new());
        (text.clone(), scene.unwrap_or_else(|error| panic!("{error}\n{text}")))
    }

    fn check(&self, edited: &Scene) {
        let (text, mut scene) = self.read_back(edited);
        // Whichever images are no longer used, the others have the same numbers then
        let edited = &mut edited.clone();
        [&mut scene, edited].into_iter().for_each(Scene::drop_unused_images);
        // Their text tells 0 from -0, too.
        let shown = |scene: &Scene| {
            let objects = scene.objects.iter().map(|o| (&o.name, o.material, o.subsurface_group));
            let objects: Vec<_> = objects.collect();
            let Scene { unit, camera, film, integrator, materials, lights, environment, .. } = scene;
            format!(
                "{unit:?} {camera:?} {film:?} {integrator:?} {objects:?} {materials:#?} {lights:?} {environment:?}"
            )
        };
        assert_eq!(shown(&scene), shown(edited), "{text}");
        assert!(scene.images == edited.images && scene.profile_tables == edited.profile_tables);
        assert!(scene.objects.iter().zip(&edited.objects).all(|(a, b)| a.mesh == b.mesh));
    }
}

/// Random edits.
struct Random(SplitMix);

impl Random {
    fn of(seed: u64) -> Self {
        Self(SplitMix(seed))
    }

    fn chance(&mut self, one_in: usize) -> bool {
        self.0.below(one_in) == 0
    }

    /// Any finite number, most of them of the size of 1.
    fn number(&mut self) -> f32 {
        match self.0.below(6) {
            0 => Some(f32::from_bits(self.0.bits() as u32)).filter(|x| x.is_finite()).unwrap_or(1.0),
            1 => [0.0, -0.0, 1.0, 0.1, 1e-45, 1e10][self.0.below(6)],
            _ => 2.0 * self.0.uniform_f32() - 0.5,
        }
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.number(), self.number(), self.number())
    }

    /// Near length 1 only, as sums of rounded numbers are.
    fn direction(&mut self) -> Vec3 {
        let v = Vec3::new(self.0.uniform_f32() - 0.5, self.0.uniform_f32() - 0.5, self.0.uniform_f32() - 0.4);
        let exact = v.as_dvec3().normalize().as_vec3();
        if self.chance(2) { exact } else { v.normalize() * (1.0 + 1e-6 * self.0.uniform_f32()) }
    }

    fn rotation(&mut self) -> Mat3 {
        Mat3::from_quat(Quat::from_axis_angle(self.direction().normalize(), 6.0 * self.0.uniform_f32()))
    }

    fn one<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.0.below(list.len())]
    }

    fn light(&mut self) -> Light {
        let place = self.vector().clamp(Vec3::splat(-1e10), Vec3::splat(1e10));
        let color = if self.chance(3) {
            Vec3::splat(self.0.uniform_f32())
        } else {
            self.vector().abs().min(Vec3::splat(1e12))
        };
        let (radius, direction, visible) = (self.0.uniform_f32() + 1e-3, self.direction(), self.chance(2));
        match self.0.below(6) {
            0 => {
                let turn = self.rotation();
                let [edge_x, edge_y] = [turn.x_axis * radius, turn.y_axis * self.0.uniform_f32().max(0.1)];
                if self.chance(2) {
                    Light::Rectangle { center: place, edge_x, edge_y, radiance: color, visible }
                } else {
                    Light::Ellipse { center: place, edge_x, edge_y, radiance: color, visible }
                }
            }
            1 => Light::Sphere { center: place, radius, radiance: color, visible },
            2 => Light::Distant { direction, angular_radius: 80.0 * self.0.uniform_f32(), irradiance: color },
            3 => Light::Spot {
                radius: 0.0,
                visible: true,
                position: place,
                direction,
                intensity: color,
                inner_angle: 0.0,
                outer_angle: 180.0,
            },
            4 => {
                let outer_angle = 179.0 * self.0.uniform_f32() + 0.5;
                let inner_angle = 0.99 * outer_angle * self.0.uniform_f32();
                Light::Spot {
                    position: place,
                    direction,
                    radius,
                    intensity: color,
                    inner_angle,
                    outer_angle,
                    visible,
                }
            }
            _ => Light::Beam { origin: place, direction, radius, power: color },
        }
    }

    fn edit_material(&mut self, material: &mut Material) {
        for parameter in Material::DESCRIPTION.fields {
            if !self.chance(4) {
                continue;
            }
            match (parameter.slot)(material) {
                SceneSlot::Number(number, _) | SceneSlot::Length(number, _) => *number = self.number(),
                SceneSlot::Scalar(input, _) => {
                    input.factor = self.number();
                    input.texture = input.texture.filter(|_| !self.chance(4));
                }
                SceneSlot::Color(input, _) => {
                    input.factor = if self.chance(3) { Vec3::splat(self.number()) } else { self.vector() };
                    match self.0.below(8) {
                        0 => input.texture = None,
                        1 => *input = ColorInput::vertex(),
                        2 => input.vertex_color = !input.vertex_color,
                        _ => {}
                    }
                }
                _ => {}
            }
        }
        if self.chance(4) {
            material.subsurface_model = self.one(&SubsurfaceModel::ALL);
        }
        if self.chance(4) {
            material.subsurface_parameter = self.one(&[SubsurfaceParameter::Mfp, SubsurfaceParameter::Dmfp]);
            material.subsurface_configuration =
                self.one(&[Configuration::Diffuse, Configuration::Searchlight]);
            material.subsurface_normalization =
                self.one(&[SubsurfaceNormalization::None, SubsurfaceNormalization::Energy]);
            material.subsurface_texture_at =
                self.one(&[SubsurfaceTextureAt::Exit, SubsurfaceTextureAt::Entry, SubsurfaceTextureAt::Both]);
        }
        if self.chance(4) {
            material.camera_visibility =
                self.one(&[CameraVisibility::Surface, CameraVisibility::Shadow, CameraVisibility::None]);
        }
        if let Some(map) = &mut material.geometry_normal {
            map.scale = self.number();
        }
        if self.chance(4) {
            material.geometry_normal = None;
        }
        if self.chance(3) {
            let [thickness, surface_albedo, mfp] =
                [self.number(), self.number(), self.number()].map(f32::abs);
            let surface_albedo = Vec3::splat(surface_albedo);
            let medium = match self.chance(2) {
                true => LayerMedium::Appearance { surface_albedo, mfp: Vec3::splat(mfp) },
                false => LayerMedium::Coefficients { scattering: surface_albedo, absorption: self.vector() },
            };
            let layer = SubsurfaceLayer { thickness, medium, g: self.number() };
            material.layers = vec![layer; self.0.below(3)];
        }
        if !material.layers.is_empty() {
            material.subsurface_model = self.one(&[SubsurfaceModel::Default, SubsurfaceModel::Layers]);
        }
        if material.fault_of_layered_profile().is_some()
            && material.subsurface_model == SubsurfaceModel::Layers
        {
            material.subsurface_model = SubsurfaceModel::Default;
        }
        drop(material.clamp());
    }

    fn edit_environment(&mut self, scene: &mut Scene, sky: &Arc<Image>) {
        match self.0.below(5) {
            0 => scene.environment = None,
            1 => {
                scene.images.push(sky.clone());
                let image = Some(scene.images.len() - 1);
                scene.environment = Some(Environment { image, ..scene.environment.unwrap_or_default() });
            }
            2 => scene.environment = Some(Environment::default()),
            _ => {}
        }
        let Some(environment) = &mut scene.environment else { return };
        if self.chance(2) {
            environment.radiance = self.vector().abs().min(Vec3::splat(1e12));
            environment.visible = self.chance(2);
        }
        match self.0.below(4) {
            0 => environment.world_from_environment = self.rotation(),
            1 => {
                let odd = self.0.uniform_f32();
                let angle = self.one(&[0.0, 30.0, -90.0, 180.0, 12.5, 359.0, 720.5]) + self.one(&[0.0, odd]);
                environment.world_from_environment = Mat3::from_rotation_y(angle.to_radians());
            }
            _ => {}
        }
    }

    /// A valid scene that differs here and there.
    fn edited(&mut self, editing: &Editing) -> Scene {
        let mut scene = editing.scene.clone();
        for material in &mut scene.materials {
            if self.chance(2) {
                self.edit_material(material);
            }
        }
        if self.chance(3) {
            scene.drop_unused_images();
        }
        if self.chance(3) {
            scene.lights = (0..self.0.below(4)).map(|_| self.light()).collect();
        }
        self.edit_environment(&mut scene, &editing.sky());
        if self.chance(2) {
            scene.camera.position = self.vector().clamp(Vec3::splat(-1e10), Vec3::splat(1e10));
            scene.camera.up = self.direction();
            scene.camera.projection = if self.chance(2) {
                Projection::Perspective { horizontal_fov: 1.0 + 170.0 * self.0.uniform_f32() }
            } else {
                Projection::Orthographic { width: 1e-3 + 100.0 * self.0.uniform_f32() }
            };
            scene.camera.shift = Vec2::new(self.0.uniform_f32() - 0.5, self.0.uniform_f32());
            scene.camera.lens_radius = self.0.uniform_f32();
        }
        let film = &mut scene.film;
        match self.0.below(4) {
            0 => film.exposure = 20.0 * self.0.uniform_f32() - 10.0,
            1 => film.width = 1 + self.0.below(3000) as u32,
            2 => {
                film.filter = self.one(&[FilterKind::Box, FilterKind::Gaussian, FilterKind::BlackmanHarris]);
                film.filter_radius = self.one(&[film.filter_radius, 0.5, 1.25]);
            }
            _ => film.tone_mapping = self.one(&[ToneMapping::Srgb, ToneMapping::Agx, ToneMapping::Neutral]),
        }
        let integrator = &mut scene.integrator;
        match self.0.below(4) {
            0 => integrator.seed = self.0.bits(),
            1 => integrator.subsurface_method = SubsurfaceMethod::PointBased,
            2 => {
                integrator.subsurface_tail = 0.1 * self.0.uniform_f32() + 1e-9;
                integrator.point_tolerance = 0.001 + 0.5 * self.0.uniform_f32();
                integrator.max_depth = 1 + self.0.below(1024) as u32;
                integrator.caustics = self.chance(2);
            }
            _ => {
                integrator.samples_per_pixel = 1 + self.0.below(5000) as u32;
                integrator.subsurface_sharing = self.chance(2);
                integrator.point_memory = 1 + self.0.below(5000) as u32;
                integrator.max_diffuse_depth = self.0.below(1024) as u32;
            }
        }
        scene
    }

    /// Checks so many edits; returns how many of them could be made.
    fn check(&mut self, editing: &Editing, rounds: u64) {
        let mut checked = 0;
        for _ in 0..rounds {
            let edited = self.edited(editing);
            if edited.validate().is_ok() {
                editing.check(&edited);
                checked += 1;
            }
        }
        assert!(2 * checked > rounds, "only {checked} of {rounds} edits were valid");
    }
}

#[test]
fn edits_of_a_mesh_read_back_exactly() {
    Random::of(1).check(&Editing::mesh(), power(2000));
}

#[test]
fn edits_of_a_textured_gltf_read_back_exactly() {
    let editing = Editing::gltf();
    assert!(editing.scene.materials.iter().any(|material| material.geometry_normal.is_some()));
    assert!(
        editing.scene.materials.iter().any(|m| m.base_color.texture.is_some() && m.base_color.vertex_color)
    );
    Random::of(2).check(&editing, power(2000));
}

#[test]
fn edits_of_the_still_life_read_back_exactly() {
    Random::of(3).check(&Editing::of("still-life", "", None, None), power(32));
}

#[test]
fn saved_edits_can_be_edited_and_saved_again() {
    let editing = Editing::gltf();
    let mut random = Random::of(4);
    for _ in 0..power(80) {
        let edited = random.edited(&editing);
        if edited.validate().is_err() {
            continue;
        }
        let (_, scene) = editing.read_back(&edited);
        let base = ExtendedBase { extends: "saved.toml".into(), ..ExtendedBase::default() };
        let mut again = scene.clone();
        again.film.exposure = 7.5;
        let text = base.write(&scene, &again, None).unwrap();
        let expected = "extends = \"saved.toml\"\n\n[film]\nexposure = 7.5\n";
        assert_eq!(text, expected);
        let path = editing.folder.path().join("again.toml");
        fs::write(&path, text).unwrap();
        let loaded = load_scene(&path, &LoadOptions::default(), &mut Vec::new()).unwrap();
        assert_eq!(format!("{:?}", loaded.materials), format!("{:?}", edited.materials));
        assert_eq!(loaded.film, again.film);
    }
}

#[test]
fn nothing_changed_is_nothing_written() {
    let editing = Editing::mesh();
    let text = editing.text(&editing.scene).unwrap();
    assert_eq!(text, "extends = \"pyramid.obj\"\npreset = \"jade\"\nunit = \"cm\"\n");
}

#[test]
fn written_changes_are_short() {
    let editing = Editing::gltf();
    let mut scene = editing.scene.clone();
    scene.materials[1].subsurface_radius.factor = 0.3;
    scene.materials[0].base_color.factor = Vec3::new(0.5, 0.25, 1.0);
    scene.materials[0].geometry_normal = None;
    let lines = editing.text(&scene).unwrap();
    let expected = "extends = \"parts.gltf\"\n\n\
        [[material]]\nindex = 0\nbase_color = { factor = [0.5, 0.25, 1.0], vertex_color = true }\n\
        geometry_normal = \"none\"\n\n[[material]]\nindex = 1\nsubsurface_radius = 0.3\n";
    assert_eq!(lines, expected);

    let mut scene = editing.scene.clone();
    scene.lights = Vec::new();
    scene.environment = Some(Environment {
        world_from_environment: Mat3::from_rotation_y(37.5_f32.to_radians()),
        ..Environment::default()
    });
    let lines = editing.text(&scene).unwrap();
    assert!(lines.ends_with("\n[environment]\nradiance = 1.0\nrotation = 37.5\n"), "{lines}");
}

#[test]
fn object_with_another_material_is_written() {
    let editing = Editing::mesh();
    let mut scene = editing.scene.clone();
    scene.objects[0].material = 1;
    editing.check(&scene);
    // The first material of a name is the one that is read
    let editing = Editing::gltf();
    let mut scene = editing.scene.clone();
    scene.objects[2].material = 1;
    let error = editing.text(&scene).unwrap_err();
    let name = &scene.objects[2].name;
    assert_eq!(
        error.message,
        format!("the change of object {name} cannot be written in a scene file that extends another")
    );
}

#[test]
fn what_cannot_be_said_is_refused() {
    let editing = Editing::gltf();
    let refusal = |change: fn(&mut Scene), file: Option<&str>| {
        let mut scene = editing.scene.clone();
        change(&mut scene);
        editing.base.write(&editing.scene, &scene, file).unwrap_err().message
    };
    let message = |what: &str| format!("{what} cannot be written in a scene file that extends another");
    let uses_sky = |scene: &mut Scene| {
        scene.images.push(Arc::new(Image::clone(&scene.images[0])));
        scene.environment =
            Some(Environment { image: Some(scene.images.len() - 1), ..Environment::default() });
    };
    assert_eq!(refusal(uses_sky, None), message("the image of the environment, without a file for it,"));
    let other_image = |scene: &mut Scene| {
        scene.environment = Some(Environment { image: Some(0), ..Environment::default() });
    };
    assert_eq!(
        refusal(other_image, Some("a.exr")),
        message("the image of the environment, without a file for it,")
    );
    assert_eq!(
        refusal(|scene| scene.materials[0].name.push('x'), None),
        message("the change of material skinx")
    );
    let texture =
        |scene: &mut Scene| scene.materials[1].base_color.texture = scene.materials[0].base_color.texture;
    assert_eq!(refusal(texture, None), message("the change of material skin"));
    let tabulated = |scene: &mut Scene| scene.materials[1].subsurface_model = SubsurfaceModel::Tabulated(0);
    assert_eq!(refusal(tabulated, None), message("the table of material skin"));
    let fewer = |scene: &mut Scene| drop(scene.materials.pop());
    assert!(refusal(fewer, None).ends_with("but both must have as many"));
}

#[test]
fn every_number_reads_back() {
    let mut random = SplitMix(5);
    for i in 0..200_000_u32 {
        let bits = if i < 4096 { i << 20 } else { random.bits() as u32 };
        let x = f32::from_bits(bits);
        if x.is_finite() {
            let text = Value::from(x).to_string();
            assert_eq!((text.parse::<f64>().unwrap() as f32).to_bits(), bits, "{text}");
        }
    }
}

#[test]
fn every_text_reads_back() {
    for text in ["", "a b", "\"\\\"", "tab\tline\nnull\0", "ä\u{85}\u{1f600}'"] {
        let source = Provenance::file("a.toml".as_ref(), &format!("extends = {}", quoted(text)));
        let entries = crate::toml::parse::parse(&source).unwrap();
        assert_eq!(entries[0].value.content, Content::Text(text.to_owned()));
    }
}

/// Layers are written as a whole, and taken away by a word.
#[test]
fn layers_are_written_and_taken_away() {
    let plain = still_life(&LoadOptions::default()).unwrap();
    let mut layered = plain.clone();
    let medium =
        LayerMedium::Coefficients { scattering: Vec3::new(0.1, 2.0, 3.0), absorption: Vec3::splat(1e-7) };
    layered.materials[0].layers = vec![SubsurfaceLayer { thickness: 0.25, medium, g: 0.5 }];
    let base = ExtendedBase { extends: "still-life".into(), ..ExtendedBase::default() };
    let text = base.write(&plain, &layered, None).unwrap();
    let line = "layer = [{ thickness = 0.25, scattering = [0.1, 2.0, 3.0], absorption = 1e-7, g = 0.5 }]";
    assert!(text.contains(line), "{text}");
    let text = base.write(&layered, &plain, None).unwrap();
    assert!(text.ends_with("layer = \"none\"\n"), "{text}");
}

/// A mesh in every stance, with all that is seen of it, is the same scene by its file.
#[test]
fn mesh_is_written_with_all_that_its_base_is_made_by() {
    let editing = Editing::mesh();
    let mesh_path = editing.folder.path().join("pyramid.obj");
    let stances = [
        MeshBase { up: Some(UpAxis::Z), ..MeshBase::default() },
        MeshBase { up: Some(UpAxis::MinusX), rotate: [10.5, -0.1, 1e-3], ..MeshBase::default() },
        MeshBase {
            floor: Some(Floor::Shadow),
            viewpoint: Viewpoint::from_text("right"),
            ..MeshBase::default()
        },
        MeshBase {
            floor: Floor::from_text("#3050a0"),
            viewpoint: Some(Viewpoint::of(-30.25, 15.1)),
            ..MeshBase::default()
        },
    ];
    for mesh in stances {
        let load = |options: LoadOptions| load_scene(&mesh_path, &options, &mut Vec::new()).unwrap();
        let scene = load(mesh.apply(LoadOptions::default()));
        // What an option changes beyond the base is written as any edit
        let zoomed = load(LoadOptions { zoom: Some(1.5), ..mesh.apply(LoadOptions::default()) });
        let base = ExtendedBase { extends: "pyramid.obj".into(), mesh };
        let turned = Editing { folder: tempfile::tempdir().unwrap(), base, scene };
        fs::copy(&mesh_path, turned.folder.path().join("pyramid.obj")).unwrap();
        turned.check(&turned.scene.clone());
        turned.check(&zoomed);
    }
}

/// Surroundings in place of automatic lights are written with their file, over a base without a floor.
#[test]
fn surroundings_of_a_mesh_are_written() {
    let editing = Editing::mesh();
    let mesh = MeshBase { floor: Some(Floor::None), ..editing.base.mesh.clone() };
    let options = mesh.apply(LoadOptions::default());
    let path = editing.folder.path().join("pyramid.obj");
    let scene = load_scene(&path, &options, &mut Vec::new()).unwrap();
    let file = Some(editing.folder.path().join("sky.png"));
    let surroundings = Surroundings { file, rotation: Some(33.0), strength: Some(2.0) };
    let lit = load_scene(&path, &LoadOptions { surroundings, ..options }, &mut Vec::new()).unwrap();
    let base = ExtendedBase { mesh, ..editing.base.clone() };
    Editing { base, scene, ..editing }.check(&lit);
}

#[test]
fn preset_is_written_by_its_name_and_names_what_came_from_one() {
    let editing = Editing::mesh();
    let given = |name: &str| {
        let preset = translucid_profile::convention::preset(name).unwrap();
        Material::of_preset(preset, Unit::Centimeter)
    };
    let mut edited = editing.scene.clone();
    edited.materials[0] = given("skin1");
    let head =
        "extends = \"pyramid.obj\"\npreset = \"jade\"\nunit = \"cm\"\n\n[[material]]\nname = \"jade\"\n";
    assert_eq!(editing.text(&edited).unwrap(), format!("{head}preset = \"skin1\"\n"));
    editing.check(&edited);
    edited.materials[0].specular_ior = 1.7;
    assert_eq!(editing.text(&edited).unwrap(), format!("{head}preset = \"skin1\"\nspecular_ior = 1.7\n"));
    editing.check(&edited);
    // A name that another material has stays free of it, and so does one that no preset has
    edited.materials[1] = Material { name: "skin1".into(), ..edited.materials[1].clone() };
    assert!(editing.text(&edited).is_err(), "there is no key for another name");
    let mut editing = editing;
    editing.scene.materials[1].name = "skin1".into();
    edited.materials[0] = Material { name: "jade".into(), ..given("skin1") };
    let text = editing.text(&edited).unwrap();
    assert_eq!(text, format!("{head}preset = \"skin1\"\n"));
}
