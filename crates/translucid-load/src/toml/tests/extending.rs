//! Scene files that extend others: what they change, what they leave, and every mistake.

use std::fs;
use std::path::{Path, PathBuf};

use glam::{Mat3, Vec3};
use tempfile::TempDir;
use translucid_profile::convention::preset;
use translucid_scene::{ColorInput, Environment, Light, Material, Place, Projection, Scene, Unit, Warning};
use translucid_testing::SplitMix;

use super::cases;
use super::mutation::mutate;
use crate::result::Result;
use crate::{LoadOptions, SceneFile, load_scene};

const BASE: &str = "unit = \"cm\"\n\
    [camera]\nposition = [0, 0, 9]\ntarget = [0, 0, 0]\n\
    [film]\nsize = [64, 32]\nexposure = 1\n\
    [[material]]\nname = \"wax\"\npreset = \"wax\"\n\
    [[material]]\nname = \"floor\"\nbase_color = \"vertex\"\n\
    [[object]]\nname = \"ball\"\nshape = \"sphere\"\nmaterial = \"wax\"\n\
    [[object]]\nname = \"table\"\nshape = \"box\"\nmaterial = \"floor\"\n\
    [[light]]\ntype = \"point\"\nposition = [0, 5, 0]\nintensity = 3\n\
    [environment]\nradiance = 0.5\nrotation = 30\n";

const TETRAHEDRON: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

/// A folder with `base.toml` and `pyramid.obj`.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        folder.file("base.toml", BASE);
        folder.file("pyramid.obj", TETRAHEDRON);
        folder
    }

    fn file(&self, name: &str, text: &str) -> PathBuf {
        let path = self.0.path().join(name);
        fs::write(&path, text).unwrap();
        path
    }

    fn try_load(&self, text: &str, options: &LoadOptions) -> Result<(Scene, Vec<Warning>)> {
        let mut warnings = Vec::new();
        let scene = load_scene(&self.file("look.toml", text), options, &mut warnings)?;
        Ok((scene, warnings))
    }

    /// The scene of a file that extends `base.toml`.
    fn changed(&self, rest: &str) -> Scene {
        let text = format!("extends = \"base.toml\"\n{rest}\n");
        let loaded = self.try_load(&text, &LoadOptions::default());
        loaded.unwrap_or_else(|error| panic!("{error}\n{text}")).0
    }

    /// Checks the message, the underlined text and the advice of a file that cannot be used.
    #[track_caller]
    fn refuse(&self, text: &str, message: &str, underlined: &str, help: &str) {
        let error = self.try_load(text, &LoadOptions::default()).map(drop).expect_err(text);
        assert_eq!(error.message, message, "in\n{text}");
        let (excerpt, span) =
            error.place.as_ref().and_then(|place| place.excerpt.as_ref()).expect("an excerpt");
        assert_eq!(&excerpt[span.clone()], underlined, "underlined for {message}");
        assert_eq!(error.help.as_deref().unwrap_or_default(), help, "advice for {message}");
    }

    #[track_caller]
    fn refuse_change(&self, rest: &str, message: &str, underlined: &str, help: &str) {
        self.refuse(&format!("extends = \"base.toml\"\n{rest}\n"), message, underlined, help);
    }

    /// Each of these changes behind a header must be refused, as [`cases`] has them.
    #[track_caller]
    fn refuse_each(&self, header: &str, list: &str) {
        for [line, message, underlined, help] in cases(list) {
            self.refuse_change(&format!("{header}{line}"), &message, &underlined, &help);
        }
    }
}

/// All of a scene but its meshes, which are compared by their equality.
fn shown(scene: &Scene) -> String {
    let objects: Vec<_> = scene.objects.iter().map(|o| (&o.name, o.material, o.subsurface_group)).collect();
    format!(
        "{:?} {:?} {:?} {:?} {objects:?} {:?} {:?} {:?} {:?}",
        scene.unit,
        scene.camera,
        scene.film,
        scene.integrator,
        scene.materials,
        scene.images,
        scene.lights,
        scene.environment
    )
}

fn assert_same(a: &Scene, b: &Scene) {
    assert_eq!(shown(a), shown(b));
    assert!(a.objects.iter().zip(&b.objects).all(|(a, b)| a.mesh == b.mesh));
}

#[test]
fn extending_without_changes_is_the_base() {
    let folder = Folder::new();
    let load = |name: &str, options: &LoadOptions| {
        load_scene(&folder.0.path().join(name), options, &mut Vec::new()).unwrap()
    };
    for size in [None, Some([40, 80])] {
        let options = LoadOptions { size, ..LoadOptions::default() };
        let same = |text: &str, base: &Scene| assert_same(&folder.try_load(text, &options).unwrap().0, base);
        same("extends = \"base.toml\"", &load("base.toml", &options));
        same("extends = \"base.toml\"\nunit = \"cm\"", &load("base.toml", &options));
        same("extends = \"pyramid.obj\"", &load("pyramid.obj", &options));
        let of_mesh = LoadOptions { preset: Some("jade".into()), unit: Some(Unit::Meter), ..options.clone() };
        same("extends = \"pyramid.obj\"\npreset = \"jade\"\nunit = \"m\"", &load("pyramid.obj", &of_mesh));
    }
    let text = "extends = \"still-life\"\n[film]\nsize = [96, 54]\n";
    let still_life =
        crate::still_life(&LoadOptions { size: Some([96, 54]), ..LoadOptions::default() }).unwrap();
    assert_same(&folder.try_load(text, &LoadOptions::default()).unwrap().0, &still_life);
}

#[test]
fn extending_changes_what_it_names() {
    let folder = Folder::new();
    let base = folder.changed("");
    let scene = folder.changed(
        "[film]\nexposure = -2\n[integrator]\nseed = 5\n\
         [[material]]\nname = \"wax\"\nsubsurface_radius = 0.25\n\
         [[object]]\nname = \"table\"\nmaterial = \"wax\"\n",
    );
    let mut expected = base.clone();
    expected.film.exposure = -2.0;
    expected.integrator.seed = 5;
    expected.materials[0].subsurface_radius.factor = 0.25;
    expected.objects[1].material = 0;
    assert_same(&scene, &expected);

    let scene = folder.changed("[camera]\nposition = [1, 0, 9]\ntarget = [0, 0, 0]\nfov = 20");
    assert_eq!(
        (scene.camera.position.x, scene.camera.projection),
        (1.0, Projection::Perspective { horizontal_fov: 20.0 })
    );
    assert_eq!(scene.lights, base.lights);
    let light = "[[light]]\ntype = \"sphere\"\ncenter = [0, 9, 0]\nradius = 1\nradiance = 1";
    assert!(matches!(folder.changed(light).lights[..], [Light::Sphere { .. }]));
}

#[test]
fn extending_can_take_away_lights_and_environment() {
    let folder = Folder::new();
    let scene = folder.changed("light = []\nenvironment = \"none\"");
    assert!(scene.lights.is_empty() && scene.environment.is_none());
    let text = "extends = \"pyramid.obj\"\nlight = []\nenvironment = \"none\"";
    let (scene, _) = folder.try_load(text, &LoadOptions::default()).unwrap();
    assert!(scene.lights.is_empty() && scene.environment.is_none() && scene.objects.len() == 2);
}

#[test]
fn extending_changes_an_environment_or_makes_a_new_one() {
    let folder = Folder::new();
    let turned = folder.changed("[environment]\nrotation = 60\nvisible = false").environment.unwrap();
    assert_eq!((turned.radiance, turned.visible), (Vec3::splat(0.5), false));
    assert_eq!(turned.world_from_environment, Mat3::from_rotation_y(60_f32.to_radians()));
    let new = folder.changed("[environment]\nfile = \"none\"\nradiance = 2").environment.unwrap();
    assert_eq!(new, Environment { radiance: Vec3::splat(2.0), ..Environment::default() });
}

#[test]
fn extending_adds_materials_and_objects() {
    let folder = Folder::new();
    let scene = folder.changed(
        "[[material]]\nname = \"gold\"\nbase_metalness = 1\n\
         [[object]]\nfile = \"pyramid.obj\"\nmaterial = \"gold\"\n\
         [[object]]\nshape = \"sphere\"\nmaterial = \"wax\"\n",
    );
    let names: Vec<&str> = scene.objects.iter().map(|object| object.name.as_str()).collect();
    assert_eq!(names, ["ball", "table", "pyramid", "sphere"]);
    let materials: Vec<usize> = scene.objects.iter().map(|object| object.material).collect();
    assert_eq!(materials, [0, 1, 2, 0]);
    let groups: Vec<u32> = scene.objects.iter().map(|object| object.subsurface_group).collect();
    assert_eq!(groups, [0, 1, 2, 3]);
}

#[test]
fn new_material_that_no_object_has_is_noticed() {
    let text = "extends = \"base.toml\"\n[[material]]\nname = \"waxx\"\n";
    let (_, warnings) = Folder::new().try_load(text, &LoadOptions::default()).unwrap();
    let messages: Vec<&str> = warnings.iter().map(|warning| warning.message.as_str()).collect();
    assert_eq!(messages, ["no object has the new material \"waxx\": did you mean \"wax\"?"]);
}

#[test]
fn preset_in_a_change_keeps_the_name() {
    let scene = Folder::new().changed("[[material]]\nindex = 1\npreset = \"jade\"");
    assert_eq!(scene.materials[1].name, "floor");
    let jade = Material::of_preset(preset("jade").unwrap(), Unit::Centimeter);
    assert_eq!(scene.materials[1].subsurface_color, jade.subsurface_color);
}

#[test]
fn tables_without_a_file_change_what_is_there() {
    let scene = Folder::new().changed("[[material]]\nname = \"floor\"\nbase_color = { factor = [1, 2, 3] }");
    let expected = ColorInput { factor: Vec3::new(1.0, 2.0, 3.0), ..ColorInput::vertex() };
    assert_eq!(scene.materials[1].base_color, expected);
    let message = "material[0].base_color needs the key file";
    let text = "[[material]]\nname = \"wax\"\nbase_color = { factor = 1 }";
    Folder::new().refuse_change(text, message, "{ factor = 1 }", "");
    let text = "[[material]]\nname = \"floor\"\nbase_color = { factor = 1, wrap = \"clamp\" }";
    let help = "the keys are file, factor, vertex_color";
    Folder::new().refuse_change(text, "material[0].base_color has no key wrap", "wrap", help);
    let text = "[[material]]\nname = \"floor\"\nbase_color = { vertex_color = false, factor = 2 }";
    let message = "material[0].base_color.factor is 2, but must be in [0, 1]";
    Folder::new().refuse_change(text, message, "2", "");
}

#[test]
fn files_extend_each_other_in_a_row() {
    let folder = Folder::new();
    folder.file("a.toml", "extends = \"base.toml\"\n[film]\nexposure = 3\nfilter_radius = 1\n");
    folder.file("b.toml", "extends = \"a.toml\"\n[film]\nexposure = 4\n");
    let (scene, _) = folder.try_load("extends = \"b.toml\"", &LoadOptions::default()).unwrap();
    assert_eq!((scene.film.exposure, scene.film.filter_radius, scene.film.width), (4.0, 1.0, 64));
}

#[test]
fn files_are_relative_to_the_file_that_names_them() {
    let folder = Folder::new();
    fs::create_dir(folder.0.path().join("looks")).unwrap();
    folder.file("looks/a.toml", "extends = \"../base.toml\"\n[[object]]\nfile = \"../pyramid.obj\"\n");
    let (scene, _) = folder.try_load("extends = \"looks/a.toml\"", &LoadOptions::default()).unwrap();
    assert_eq!(scene.objects.len(), 3);
}

#[test]
fn camera_that_is_chosen_fits_the_size_of_the_outermost() {
    let folder = Folder::new();
    folder.file("a.toml", "extends = \"pyramid.obj\"\n[film]\nsize = [30, 10]\n");
    let camera = |text: &str, size| {
        let options = LoadOptions { size, ..LoadOptions::default() };
        folder.try_load(text, &options).unwrap().0.camera
    };
    let plain = |size| {
        let options = LoadOptions { size, ..LoadOptions::default() };
        load_scene(&folder.0.path().join("pyramid.obj"), &options, &mut Vec::new()).unwrap().camera
    };
    assert_eq!(camera("extends = \"a.toml\"", None), plain(Some([30, 10])));
    assert_eq!(camera("extends = \"a.toml\"\n[film]\nsize = [10, 50]", None), plain(Some([10, 50])));
    assert_eq!(camera("extends = \"a.toml\"\n[film]\nsize = [10, 50]", Some([9, 9])), plain(Some([9, 9])));
    assert_ne!(plain(Some([30, 10])), plain(Some([10, 50])));
}

#[test]
fn options_reach_through_a_row_of_files() {
    let folder = Folder::new();
    let big = folder.file("big.obj", &TETRAHEDRON.replace("v 1 0 0", "v 3 0 0"));
    let replaced = |text: &str, name: Option<&str>| {
        let mesh_overrides = vec![(name.map(String::from), big.clone())];
        folder.try_load(text, &LoadOptions { mesh_overrides, ..LoadOptions::default() })
    };
    let width = |scene: &Scene, name: &str| {
        scene.objects.iter().find(|object| object.name == name).unwrap().mesh.bounds().1.x
    };
    // The mesh that is extended
    let (scene, _) = replaced("extends = \"pyramid.obj\"", None).unwrap();
    assert_eq!(width(&scene, "big"), 3.0);
    assert!(replaced("extends = \"absent.obj\"", Some("absent")).is_ok());
    // That of an object of a file in between
    folder.file("a.toml", "extends = \"base.toml\"\n[[object]]\nname = \"p\"\nfile = \"pyramid.obj\"\n");
    for name in [None, Some("p")] {
        assert_eq!(width(&replaced("extends = \"a.toml\"", name).unwrap().0, "p"), 3.0);
    }
    // One of several
    let text = "extends = \"a.toml\"\n[[object]]\nname = \"q\"\nfile = \"pyramid.obj\"\n";
    let (scene, _) = replaced(text, Some("q")).unwrap();
    assert_eq!((width(&scene, "p"), width(&scene, "q")), (1.0, 3.0));
    let error = replaced(text, None).map(drop).unwrap_err();
    assert_eq!(error.help.as_deref(), Some("say which one to replace as NAME=PATH; they are p, q"));
    let error = replaced("extends = \"base.toml\"", None).map(drop).unwrap_err();
    assert_eq!(error.message, "the scene has no object with a mesh file to replace");

    let options = LoadOptions { preset: Some("jade".into()), ..LoadOptions::default() };
    let error = folder.try_load("extends = \"pyramid.obj\"", &options).map(drop).unwrap_err();
    assert_eq!(error.help.as_deref(), Some("in a scene file it is the key preset at the top"));
}

/// Every mesh that can be rendered can be extended, so that a page can save what it shows.
#[test]
fn every_mesh_format_is_extended() {
    let folder = Folder::new();
    let corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]];
    let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let line = |numbers: [i32; 3]| numbers.map(|x| x.to_string()).join(" ");
    let facets = faces.map(|face| {
        let vertices = face.map(|i| format!("vertex {}\n", line(corners[i]))).concat();
        format!("facet normal 0 0 0\nouter loop\n{vertices}endloop\nendfacet\n")
    });
    folder.file("pyramid.stl", &format!("solid pyramid\n{}endsolid\n", facets.concat()));
    let header = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                  element face 4\nproperty list uchar int vertex_indices\nend_header\n";
    let rows = corners.map(|corner| line(corner) + "\n").concat();
    let polygons = faces.map(|face| format!("3 {} {} {}\n", face[0], face[1], face[2])).concat();
    folder.file("pyramid.ply", &format!("{header}{rows}{polygons}"));
    for name in ["pyramid.obj", "pyramid.ply", "pyramid.stl"] {
        let text = format!("extends = \"{name}\"\npreset = \"jade\"\n[film]\nexposure = 2\n");
        let (scene, _) = folder.try_load(&text, &LoadOptions::default()).unwrap();
        assert_eq!((scene.film.exposure, scene.materials[0].name.as_str()), (2.0, "jade"), "{name}");
        assert_eq!(scene.objects[0].mesh.triangles.len(), 4, "{name}");
    }
}

#[test]
fn broken_extends_is_refused() {
    let folder = Folder::new();
    let paths = "\"still-life\" or the path of a scene (.toml) or mesh (.glb, .gltf, .obj, .ply or .stl)";
    folder.refuse(
        "extends = \"a.fbx\"",
        &format!("extends is \"a.fbx\", but must be {paths}"),
        "\"a.fbx\"",
        "",
    );
    folder.refuse("extends = 3", "extends is a number, but must be the path of a file", "3", "");
    for (name, help) in [("no.toml", ""), ("no.ply", "put the mesh there, or give its path with --mesh PATH")]
    {
        let message = format!("the file {} does not exist", folder.0.path().join(name).display());
        folder.refuse(&format!("extends = \"{name}\""), &message, &format!("\"{name}\""), help);
    }
    let preset = "extends = \"base.toml\"\npreset = \"jade\"";
    let message = "preset is for a mesh, but extends names a scene";
    folder.refuse(preset, message, "\"jade\"", "use the key preset in a [[material]]");
    for (key, value, expected) in [
        ("up", "\"down\"", "one of \"x\", \"y\", \"z\", \"-x\", \"-y\", \"-z\""),
        (
            "floor",
            "\"shadows\"",
            "\"none\", \"backdrop\", \"shadow\", \"#rrggbb\", or one or three numbers in [0, 1]",
        ),
        ("floor", "2", "in [0, 1]"),
        (
            "view",
            "\"fron\"",
            "one of \"front\", \"back\", \"left\", \"right\", \"top\", \"bottom\", \
             or \"AZIMUTH,ELEVATION\" in degrees, the latter in [-90, 90]",
        ),
    ] {
        let text = format!("extends = \"pyramid.obj\"\n{key} = {value}");
        folder.refuse(&text, &format!("{key} is {value}, but must be {expected}"), value, "");
        let text = format!("extends = \"base.toml\"\n{key} = {value}");
        let error = folder.try_load(&text, &LoadOptions::default()).map(drop).unwrap_err();
        assert_eq!(error.message, format!("{key} is for a mesh, but extends names a scene"));
    }
    let rotate = "extends = \"pyramid.obj\"\nrotate = [0, 1e9, 0]";
    folder.refuse(rotate, "rotate[1] is 1e9, but must be in [-36000, 36000]", "1e9", "");
    let unit = "extends = \"base.toml\"\nunit = \"mm\"";
    folder.refuse(unit, "unit is \"mm\", but the scene that is extended is in cm", "\"mm\"", "leave it out");
    let unknown = "extends = \"pyramid.obj\"\npreset = \"jadee\"";
    let error = folder.try_load(unknown, &LoadOptions::default()).map(drop).unwrap_err();
    assert_eq!(error.message, "there is no preset \"jadee\"");
    let help = "did you mean extends? the keys are extends, unit, subsurface_grouping, camera, film, integrator, \
        material, object, light, environment";
    folder.refuse("extend = \"base.toml\"", "a scene has no key extend", "extend", help);
    let help = "the keys are extends, preset, unit, up, rotate, floor, view, camera, film, integrator, material, object, light, environment";
    folder.refuse_change(
        "subsurface_grouping = \"material\"",
        "a scene has no key subsurface_grouping",
        "subsurface_grouping",
        help,
    );
}

#[test]
fn circles_and_endless_rows_are_refused() {
    let folder = Folder::new();
    let itself = |name: &str| {
        format!("the file {} extends itself, over others or at once", folder.0.path().join(name).display())
    };
    folder.refuse("extends = \"look.toml\"", &itself("look.toml"), "\"look.toml\"", "");
    folder.file("a.toml", "extends = \"b.toml\"");
    folder.file("b.toml", "extends = \"./a.toml\"");
    folder.refuse("extends = \"a.toml\"", &itself("./a.toml"), "\"./a.toml\"", "");
    folder.file("0.toml", "extends = \"base.toml\"");
    for i in 1..20 {
        folder.file(&format!("{i}.toml"), &format!("extends = \"{}.toml\"", i - 1));
    }
    // With the file itself and the base sixteen
    assert!(folder.try_load("extends = \"13.toml\"", &LoadOptions::default()).is_ok());
    let message = "more than 16 scene files extend each other";
    folder.refuse("extends = \"14.toml\"", message, "\"base.toml\"", "");
}

#[test]
fn broken_choices_are_refused() {
    let folder = Folder::new();
    folder.refuse_each(
        "[[material]]\n",
        r#"
        name = "wax"\nindex = 0 | material[0] has both name and index, but must have one | 0
        base_color = 1 | material[0] needs the key name or index | [[material]]
        index = 2 | material[0].index is 2, but must be a whole number in [0, 1] | 2
        index = -1 | material[0].index is -1, but must be a whole number in [0, 1] | -1
        name = "wax"\n[[material]]\nindex = 0 | another table of the list changes this material, too | [[material]]
        name = "new"\n[[material]]\nname = 'new' | material[1].name is 'new', but must be a name that no other table of the list has | 'new'
        "#,
    );
    let error = folder.try_load(
        BASE.replace("[[object]]\nname = \"ball", "[[material]]\nindex = 1\n[[object]]\nname = \"ball")
            .as_str(),
        &LoadOptions::default(),
    );
    assert_eq!(error.map(drop).unwrap_err().message, "material[2] has no key index");
    folder.refuse_each(
        "[[object]]\n",
        r#"
        name = "bal"\nmaterial = "wax" | object[0].name is "bal", but must be the name of an object of the base | "bal" | did you mean "ball"?
        name = "cathedral"\nmaterial = "wax" | object[0].name is "cathedral", but must be the name of an object of the base | "cathedral" | a new object needs the key file or shape
        name = "ball" | object[0] needs the key material | [[object]]
        name = "ball"\nscale = 2 | object[0] has no key scale | scale | the keys are name, index, material; an object with the key file or shape is a new one and has further keys
        name = "ball"\nmaterial = "wox" | object[0].material is "wox", but must be the name of a material of this scene | "wox" | did you mean "wax"?
        name = "ball"\nshape = "box" | object[0].name is "ball", but must be a name that no other has | "ball" | without file and shape the table changes that object of the base
        "#,
    );
}

#[test]
fn names_that_several_have_are_refused() {
    let folder = Folder::new();
    let two = |name: &str| format!("o {name}\n{TETRAHEDRON}usemtl m\nf 1 3 2\n");
    folder.file("parts.obj", &two("a"));
    let text = "extends = \"parts.obj\"\n[[object]]\nname = \"a\"\nmaterial = \"backdrop\"";
    let message = "object[0].name is \"a\", but must be a name that only one of the base has";
    folder.refuse(text, message, "\"a\"", "choose by the key index instead, one of 0, 1");
    let text = text.replace("name = \"a\"", "index = 1");
    let (scene, _) = folder.try_load(&text, &LoadOptions::default()).unwrap();
    assert_ne!(scene.objects[0].material, scene.objects[1].material);
    assert_eq!(scene.materials[scene.objects[1].material].name, "backdrop");
}

#[test]
fn broken_values_are_refused_before_the_base_is_opened() {
    for (rest, message) in [
        ("[film]\nexposure = 99", "film.exposure is 99, but must be in [-32, 32]"),
        ("[camera]\nfov = 3", "camera needs the key position"),
        ("[environment]\nrotation = nan", "environment.rotation is nan, but must be in [-36000, 36000]"),
        ("environment = 5", "environment is a number, but must be a table"),
        (
            "[[light]]\ntype = \"sphere\"\ncenter = [0, 0, 0]\nradius = 0",
            "light[0].radius is 0, but must be in (0, 1e10]",
        ),
        (
            "[[object]]\nshape = \"sphere\"\nradius = -1",
            "object[0].radius is -1, but must be in [0.0001, 1e6]",
        ),
        ("[[object]]\nname = \"a\"\nmaterial = 5", "object[0].material is a number, but must be a string"),
    ] {
        let text = format!("extends = \"absent.toml\"\n{rest}\n");
        assert_eq!(SceneFile::parse(&text, Path::new("a.toml")).unwrap_err().message, message);
    }
}

#[test]
fn errors_of_the_base_point_into_the_base() {
    let folder = Folder::new();
    let path = folder.file("bad.toml", "unit = \"mm\"\n[film]\nexposure = 99\n");
    let error = folder.try_load("extends = \"bad.toml\"", &LoadOptions::default()).map(drop).unwrap_err();
    let place: Place = error.place.unwrap();
    assert_eq!((place.path, place.line), (path, Some(3)));
}

#[test]
fn mutated_changes_load_or_say_why_not() {
    let folder = Folder::new();
    let text = "extends = \"base.toml\"\nlight = []\n[camera]\nposition = [0, 0, 9]\ntarget = [0, 1, 0]\n\
        [film]\nsize = [64, 48]\n[[material]]\nname = \"wax\"\nbase_color = [0.1, 0.2, 0.3]\n\
        [[material]]\nindex = 1\nbase_color = { factor = 0.5 }\n[[object]]\nname = \"ball\"\nmaterial = \"floor\"\n\
        [environment]\nrotation = 77\n";
    assert!(folder.try_load(text, &LoadOptions::default()).is_ok());
    let mut random = SplitMix(3);
    let mut valid = 0;
    for round in 0..500 {
        match folder.try_load(&mutate(text, &mut random), &LoadOptions::default()) {
            Ok((scene, _)) => {
                assert_eq!(scene.validate(), Ok(()), "round {round}");
                valid += 1;
            }
            Err(error) => assert!(error.place.is_some(), "round {round}: {error}"),
        }
    }
    assert!((25..475).contains(&valid), "{valid} of 500 are valid");
}
