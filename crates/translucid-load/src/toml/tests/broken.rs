//! Broken scene files: every message says what is wrong, on which line, under which characters.

use std::path::Path;

use translucid_scene::description::{COLOR_KEYS, NORMAL_KEYS, SCALAR_KEYS};
use translucid_scene::{Light, Object, SceneError, SubsurfaceModel};

use super::{BALL, PATH, cases, load, parse};
use crate::LoadOptions;

/// Checks an error's message, the underlined text, its line, and the advice.
fn assert_error(error: &SceneError, text: &str, message: &str, underlined: &str, help: &str) {
    assert_eq!(error.message, message, "in\n{text}");
    let place = error.place.as_ref().expect("an error of a file has a place");
    assert_eq!(place.path, Path::new(PATH));
    let (excerpt, span) = place.excerpt.as_ref().expect("an error of a text has an excerpt");
    assert_eq!(&excerpt[span.clone()], underlined, "underlined for {message}");
    assert_eq!(place.line, Some(1 + text[..span.start].matches('\n').count()));
    assert_eq!(error.help.as_deref().unwrap_or_default(), help, "advice for {message}");
}

/// A scene in millimeters with a ball and one more piece of text must fail to parse.
#[track_caller]
fn refuse(piece: &str, message: &str, underlined: &str, help: &str) {
    let text = format!("unit = \"mm\"\n{BALL}{piece}\n");
    let error = parse(&text).expect_err(&text);
    assert_error(&error, &text, message, underlined, help);
}

/// A whole file must fail to parse.
#[track_caller]
fn refuse_file(text: &str, message: &str, underlined: &str, help: &str) {
    assert_error(&parse(text).expect_err(text), text, message, underlined, help);
}

/// Each of these lines behind a ball and some text must fail to parse, as [`cases`] has them.
#[track_caller]
fn refuse_each(before: &str, list: &str) {
    refuse_each_in(&format!("unit = \"mm\"\n{BALL}{before}"), list);
}

#[track_caller]
fn refuse_each_in(text: &str, list: &str) {
    for [line, message, underlined, help] in cases(list) {
        refuse_file(&format!("{text}{line}\n"), &message, &underlined, &help);
    }
}

#[test]
fn broken_toml_is_a_syntax_error() {
    refuse_file(
        "unit = \n",
        "this is not valid TOML: string values must be quoted, expected literal string",
        "",
        "",
    );
    refuse_file("unit = \"mm\"\nx", "this is not valid TOML: key with no value, expected `=`", "", "");
    refuse_file("[camera\n", "this is not valid TOML: unclosed table, expected `]`", "", "");
    refuse_file("unit = \"mm\"\nunit = \"m\"\n", "this is not valid TOML: duplicate key", "unit", "");
}

const ROOT_KEYS: &str = "the keys are extends, unit, subsurface_grouping, camera, film, integrator, material, object, light, environment";

#[test]
fn broken_top_level_is_refused() {
    refuse_file("", "a scene needs the key unit", "", "");
    refuse_file("unit = \"mm\"\n", "the scene has no [[object]]", "", "add one with the key file or shape");
    refuse_file(
        "unit = \"inch\"\n",
        "unit is \"inch\", but must be one of \"mm\", \"cm\", \"m\"",
        "\"inch\"",
        "",
    );
    refuse_file("unit = 1\n", "unit is a number, but must be one of \"mm\", \"cm\", \"m\"", "1", "");
    let help = format!("did you mean camera? {ROOT_KEYS}");
    refuse("[camra]\nfov = 3", "a scene has no key camra", "camra", &help);
    refuse("[shader]", "a scene has no key shader", "shader", ROOT_KEYS);
    let must = "object is a table, but must be an array of tables, each with the header [[object]]";
    refuse_file("unit = \"mm\"\n[object]\nshape = \"sphere\"\n", must, "[object]", "");
    refuse("[[camera]]\nfov = 30", "camera[0] needs the key position", "[[camera]]", "");
    refuse_file("unit = \"mm\"\ncamera = []\n", "camera is [], but must be one table or more", "[]", "");
    refuse_file(
        "unit = \"mm\"\ncamera = 3\n",
        "camera is a number, but must be a table, or several with names",
        "3",
        "",
    );
    let camera = |name: &str| format!("[[camera]]\n{name}\nposition = [0, 0, 5]\ntarget = [0, 0, 0]\n");
    let nameless = camera("name = 'a'") + &camera("");
    refuse(&nameless, "camera[1] needs the key name", "[[camera]]", "");
    let twice = camera("name = 'a'") + &camera("name = \"a\"");
    refuse(
        &twice,
        "camera[1].name is \"a\", but must be a name that no other table of the list has",
        "\"a\"",
        "",
    );
    refuse_file("unit = \"mm\"\nobject = [1]\n", "object[0] is a number, but must be a table", "1", "");
}

#[test]
fn broken_camera_is_refused() {
    let keys =
        "the keys are name, position, target, up, projection, fov, width, shift, lens_radius, focus_distance";
    let help = format!("did you mean position? {keys}");
    refuse("[camera]\npositon = [0, 0, 5]", "camera has no key positon", "positon", &help);
    refuse_each(
        "[camera]\n",
        r#"
        target = [0, 0, 5] | camera needs the key position | [camera]
        position = [1, 2, 3]\ntarget = [1.0, 2.0, 3.0] | camera.target is [1.0, 2.0, 3.0], but must be a point other than the camera's position | [1.0, 2.0, 3.0]
        position = [1, 2] | camera.position has 2 values, but must be an array of 3 numbers | [1, 2]
        position = [1, "2", 3] | camera.position[1] is a string, but must be a number in [-1e10, 1e10] | "2"
        position = [1, 2, nan] | camera.position[2] is nan, but must be in [-1e10, 1e10] | nan
        position = 7 | camera.position is a number, but must be an array of 3 numbers | 7
        position = [0, 5, 0]\ntarget = [0, 0, 0] | camera.up is [0, 1, 0] by default, but must be a direction that is not parallel to the viewing direction | [camera] | give camera.up, for example [0, 0, -1]
        "#,
    );
    refuse_each(
        "[camera]\nposition = [0, 0, 5]\ntarget = [0, 0, 0]\n",
        "
        fov = 180 | camera.fov is 180, but must be in (0, 180) | 180
        projection = 'orthographic' | camera needs the key width | [camera]
        projection = 'orthographic'\\nwidth = 2\\nfov = 30 | camera.fov is not a key of a camera whose projection is orthographic | 30
        width = 2 | camera.width is not a key of a camera whose projection is perspective | 2
        fov = 179.9999999999 | camera.fov is 179.9999999999, but must be in (0, 180) in single precision | 179.9999999999
        lens_radius = -1 | camera.lens_radius is -1, but must be in [0, 1e9] | -1
        focus_distance = 1e-60 | camera.focus_distance is 1e-60, but must be in (0, 1e10] in single precision | 1e-60
        up = [0, 0, -3] | camera.up is [0, 0, -3], but must be a direction that is not parallel to the viewing direction | [0, 0, -3]
        ",
    );
}

#[test]
fn broken_film_is_refused() {
    refuse_each(
        "[film]\n",
        r#"
        size = [0, 5] | film.size[0] is 0, but must be a whole number in [1, 16384] | 0
        size = [5, 2.5] | film.size[1] is 2.5, but must be a whole number in [1, 16384] | 2.5
        size = [100_000_000_000_000_000_000_000, 5] | film.size[0] is 100_000_000_000_000_000_000_000, but must be a whole number in [1, 16384] | 100_000_000_000_000_000_000_000
        size = [5, 5, 5] | film.size has 3 values, but must be an array of 2 whole numbers, width and height | [5, 5, 5]
        filter = "gausian" | film.filter is "gausian", but must be one of "box", "gaussian", "blackman-harris" | "gausian" | did you mean "gaussian"?
        filter_radius = 0 | film.filter_radius is 0, but must be in (0, 8] | 0
        exposure = inf | film.exposure is inf, but must be in [-32, 32] | inf
        tone_mapping = "aces" | film.tone_mapping is "aces", but must be one of "srgb", "neutral", "agx" | "aces"
        "#,
    );
}

#[test]
fn broken_integrator_is_refused() {
    refuse_each(
        "[integrator]\n",
        r#"
        samples_per_pixel = 0 | integrator.samples_per_pixel is 0, but must be a whole number in [1, 16777216] | 0
        max_depth = "12" | integrator.max_depth is a string, but must be a whole number in [1, 1024] | "12"
        caustics = 1 | integrator.caustics is a number, but must be true or false | 1
        subsurface_tail = 0.5 | integrator.subsurface_tail is 0.5, but must be in (0, 0.1] | 0.5
        subsurface_method = "points" | integrator.subsurface_method is "points", but must be one of "ray-traced", "point-based", "cycles-disk" | "points"
        subsurface_sharing = "on" | integrator.subsurface_sharing is a string, but must be true or false | "on"
        point_tolerance = 0 | integrator.point_tolerance is 0, but must be in [0.001, 1] | 0
        point_memory = 0 | integrator.point_memory is 0, but must be a whole number in [1, 1048576] | 0
        seed = -1 | integrator.seed is -1, but must be a whole number in [0, 18446744073709551615] | -1
        "#,
    );
}

const MATERIAL: &str = "[[material]]\nname = \"m\"\n";

fn refuse_material(line: &str, message: &str, underlined: &str, help: &str) {
    refuse(&format!("{MATERIAL}{line}"), message, underlined, help);
}

#[test]
fn broken_material_is_refused() {
    refuse_each(
        "[[material]]\n",
        r#"
        base_weight = 1 | material[0] needs the key name | [[material]]
        name = "" | material[0].name is "", but must be a name that is not empty | ""
        name = "a"\n[[material]]\nname = 'a' | material[1].name is 'a', but must be a name that no other table of the list has | 'a'
        "#,
    );
    let names = SubsurfaceModel::ALL.map(|model| format!("\"{}\"", model.name())).join(", ");
    let message = format!("material[0].subsurface_model is \"dipol\", but must be one of {names}");
    refuse_material("subsurface_model = \"dipol\"", &message, "\"dipol\"", "did you mean \"dipole\"?");
    refuse_each(
        MATERIAL,
        r#"
        specular_roughness = 1.5 | material[0].specular_roughness is 1.5, but must be in [0, 1] | 1.5
        specular_ior = 0.5 | material[0].specular_ior is 0.5, but must be in [1, 4] | 0.5
        subsurface_scatter_anisotropy = 1 | material[0].subsurface_scatter_anisotropy is 1, but must be in (-1, 1) | 1
        subsurface_radius = -0.1 | material[0].subsurface_radius is -0.1, but must be in [0, 1e9] | -0.1
        subsurface_eta = 4 | material[0].subsurface_eta is 4, but must be in [0.5, 3] | 4
        subsurface_texture_at = "exits" | material[0].subsurface_texture_at is "exits", but must be one of "exit", "entry", "both" | "exits" | did you mean "exit"?
        subsurface_normalization = "energi" | material[0].subsurface_normalization is "energi", but must be one of "none", "energy" | "energi" | did you mean "energy"?
        subsurface_model = "none"\nsubsurface_table = "a.csv" | subsurface_table is the model: leave subsurface_model out, or the table | "a.csv"
        subsurface_parameter = "mpf" | material[0].subsurface_parameter is "mpf", but must be one of "mfp", "dmfp" | "mpf" | did you mean "mfp"?
        geometry_normal = 1 | material[0].geometry_normal is a number, but must be the path of an image or a table with an image file | 1
        specular_weight = "full" | material[0].specular_weight is a string, but must be a number in [0, 1] or a table with an image file | "full"
        "#,
    );
}

#[test]
fn broken_layers_are_refused() {
    refuse_each(
        &format!("{MATERIAL}[[material.layer]]\nscattering = 1\nabsorption = 1\n"),
        "
        thickness = 0 | material[0].layer[0].thickness is 0, but must be in (0, 1e9] | 0
        thickness = -1 | material[0].layer[0].thickness is -1, but must be in (0, 1e9] | -1
        thickness = nan | material[0].layer[0].thickness is nan, but must be in (0, 1e9] | nan
        thickness = 2e9 | material[0].layer[0].thickness is 2e9, but must be in (0, 1e9] | 2e9
        thickness = inf | material[0].layer[0].thickness is inf, but must be in (0, 1e9] | inf
        thickness = 1\\ng = 1 | material[0].layer[0].g is 1, but must be in (-1, 1) | 1
        thickness = 1\\ng = -1.5 | material[0].layer[0].g is -1.5, but must be in (-1, 1) | -1.5
        thickness = 1\\ng = nan | material[0].layer[0].g is nan, but must be in (-1, 1) | nan
        g = 0 | material[0].layer[0] needs the key thickness | [[material.layer]]
        ",
    );
    refuse_each(
        &format!("{MATERIAL}[[material.layer]]\nthickness = 1\n"),
        "
        g = 0.97\\nsurface_albedo = 0.5\\nmfp = 1 | material[0].layer[0].g is 0.97, but must be in [-0.95, 0.95] | 0.97
        surface_albedo = 0.5\\nmfp = 0 | material[0].layer[0].mfp is 0, but must be in [1e-9, 1e9] | 0
        surface_albedo = 0.5\\nmfp = '#ff0000' | material[0].layer[0].mfp is a string, but must be a number or three numbers | '#ff0000'
        surface_albedo = [0, 1, 1.5]\\nmfp = 1 | material[0].layer[0].surface_albedo[2] is 1.5, but must be in [0, 1] | 1.5
        scattering = 1\\nabsorption = -1 | material[0].layer[0].absorption is -1, but must be in [0, 1e9] | -1
        mfp = 1 | material[0].layer[0].mfp needs surface_albedo beside it | 1
        g = 0 | material[0].layer[0] needs surface_albedo and mfp, or scattering and absorption | [[material.layer]]
        mfp = 1\\nscattering = 2 | material[0].layer[0].mfp and material[0].layer[0].scattering are given, but only one of them must be | 2
        ",
    );
    refuse_each(
        MATERIAL,
        r#"
        layer = [] | material[0].layer is [], but must be one layer or more, or "none" | []
        layer = 3 | material[0].layer is a number, but must be an array of tables, each with the header [[material.layer]] | 3
        "#,
    );
    refuse_each(
        &format!("{MATERIAL}layer = [{{ thickness = 1, scattering = 1, absorption = 1 }}]\n"),
        r#"
        subsurface_model = "dipole" | material[0].subsurface_model is "dipole", but must be a random walk, "layers" or left out, because the material has layers | "dipole"
        subsurface_model = "layers"\nsubsurface_color = 'vertex' | material[0].subsurface_model is "layers", but must be a random walk or left out, because subsurface_color varies from point to point | "layers"
        subsurface_model = "layers"\nsubsurface_configuration = 'searchlight' | material[0].subsurface_model is "layers", but must be a random walk or left out, because subsurface_configuration is "searchlight", and the profile that of diffuse light | "layers"
        subsurface_table = "a.csv" | material[0].subsurface_table is "a.csv", but must be left out, because the material has layers | "a.csv"
        geometry_thin_walled = true | material[0].geometry_thin_walled is true, but must be false, because the material has layers | true
        "#,
    );
    let many = vec!["{ thickness = 1, scattering = 1, absorption = 1 }"; 101].join(", ");
    let message = "there are 101 of material[0].layer, but at most 100 are allowed";
    let list = format!("[{many}]");
    refuse_material(&format!("layer = {list}"), message, &list, "");
}

#[test]
fn broken_material_names_suggest_the_nearest() {
    let text = format!("unit = \"mm\"\n{BALL}[[material]]\nname = \"m\"\nsubsurface_colour = 1\n");
    let error = parse(&text).unwrap_err();
    assert_eq!(error.message, "material[0] has no key subsurface_colour");
    assert!(error.help.unwrap().starts_with(
        "did you mean subsurface_color? the keys are name, preset, file, file_material, file_unit, "
    ));
    let text = format!("unit = \"mm\"\n{BALL}[[material]]\nname = \"m\"\npreset = \"skim1\"\n");
    let error = parse(&text).unwrap_err();
    assert_eq!(error.message, "there is no preset \"skim1\"");
    assert!(error.help.unwrap().starts_with("did you mean \"skin1\"? the presets are alabaster, "));
    let (excerpt, span) = error.place.unwrap().excerpt.unwrap();
    assert_eq!(&excerpt[span], "\"skim1\"");
}

#[test]
fn broken_colors_are_refused() {
    let keys = "the keys are file, color_space, factor, vertex_color, uv_scale, uv_offset, uv_rotation, wrap, filter";
    let help = format!("did you mean color_space? {keys}");
    let line = "base_color = { file = \"a.png\", colorspace = \"srgb\" }";
    refuse_material(line, "material[0].base_color has no key colorspace", "colorspace", &help);
    refuse_each(
        MATERIAL,
        r##"
        base_color = "red" | material[0].base_color is "red", but must be three numbers, "#rrggbb", "vertex" or a table with an image file | "red"
        base_color = true | material[0].base_color is a truth value, but must be three numbers, "#rrggbb", "vertex" or a table with an image file | true
        base_color = "#12345" | material[0].base_color is "#12345", but must be "#rrggbb" with hexadecimal digits | "#12345"
        base_color = [0.1, 0.2, 1.01] | material[0].base_color[2] is 1.01, but must be in [0, 1] | 1.01
        base_color = [0, 0, 0, 1] | material[0].base_color has 4 values, but must be an array of 3 numbers | [0, 0, 0, 1]
        base_color = { factor = 0.5 } | material[0].base_color needs the key file | { factor = 0.5 }
        base_color = { file = "a.png", color_space = "rgb" } | material[0].base_color.color_space is "rgb", but must be one of "srgb", "linear" | "rgb" | did you mean "srgb"?
        base_color = { file = "a.png", wrap = ["clamp", "tile"] } | material[0].base_color.wrap[1] is "tile", but must be one of "repeat", "mirror", "clamp" | "tile"
        coat_weight = { file = "a.png", channel = "r" } | material[0].coat_weight.channel is "r", but must be one of "red", "green", "blue", "alpha" | "r"
        base_color = "a.png" | material[0].base_color is "a.png", but must be three numbers, "#rrggbb", "vertex" or a table with an image file | "a.png" | an image is written { file = "a.png" }
        coat_weight = "a.png" | material[0].coat_weight is a string, but must be a number in [0, 1] or a table with an image file | "a.png" | an image is written { file = "a.png" }
        base_color = { file = "" } | material[0].base_color.file is "", but must be the path of a file | ""
        "##,
    );
}

#[test]
fn broken_object_is_refused() {
    refuse_each_in(
        "unit = \"mm\"\n[[object]]\n",
        r#"
        name = "a" | object[0] needs the key file or shape | [[object]]
        file = "a.ply"\nshape = "sphere" | object[0] has both file and shape, but must have one | "sphere"
        file = 3 | object[0].file is a number, but must be the path of a file | 3
        "#,
    );
    refuse_each_in(
        "unit = \"mm\"\n[[object]]\nshape = \"sphere\"\n",
        r#"
        scale = 0 | object[0].scale is 0, but must be in [-1e9, 1e9] and at least 1e-9 away from zero | 0
        scale = [1, 0, 1] | object[0].scale is [1, 0, 1], but must be in [-1e9, 1e9] and at least 1e-9 away from zero | [1, 0, 1]
        matrix = [1, 0, 1] | object[0].matrix has 3 values, but must be an array of 16 numbers | [1, 0, 1]
        matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1] | object[0].matrix is [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1], but must be invertible: its determinant is 0 | [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1]
        matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 1] | object[0].matrix is [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 1], but must be four rows of four numbers whose last row is 0, 0, 0, 1 | [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 1]
        scale = 2\nmatrix = [] | object[0] has matrix and object[0].scale, but must have one of them | 2
        rotate = [inf, 0, 0] | object[0].rotate[0] is inf, but must be in [-36000, 36000] | inf
        unit = "cm" | object[0].unit is for files; a shape is in the scene's unit | "cm"
        "#,
    );
}

#[test]
fn broken_material_references_suggest_the_nearest() {
    let materials = "[[material]]\nname = \"marble\"\n[[material]]\nname = \"floor\"\n";
    let text = |name: &str| format!("unit = \"mm\"\n{BALL}material = \"{name}\"\n{materials}");
    let message = |name: &str| {
        format!("object[0].material is \"{name}\", but must be the name of a material of this scene")
    };
    refuse_file(&text("mable"), &message("mable"), "\"mable\"", "did you mean \"marble\"?");
    refuse_file(&text("gold"), &message("gold"), "\"gold\"", "the materials are marble, floor");
    let text = format!("unit = \"mm\"\n{BALL}material = \"gold\"\n");
    refuse_file(&text, &message("gold"), "\"gold\"", "the scene has no [[material]]");
}

/// Names that other programs have for our keys.
#[test]
fn foreign_keys_suggest_ours() {
    let suggested = |lines: &str| {
        let error = parse(&format!("unit = \"mm\"\n{lines}\n")).unwrap_err();
        assert!(error.message.contains(" has no key "), "{}", error.message);
        error.help.unwrap().split('?').next().unwrap_or_default().to_owned()
    };
    assert_eq!(suggested("[[object]]\nmesh = \"a.ply\""), "did you mean file");
    assert_eq!(
        suggested("[[object]]\nshape = \"sphere\"\ntranslation = [0, 0, 1]"),
        "did you mean translate"
    );
    let of_material = |line: &str| suggested(&format!("{BALL}[[material]]\nname = \"m\"\n{line}"));
    assert_eq!(of_material("roughness = 0.2"), "did you mean specular_roughness");
    assert_eq!(of_material("mfp = 0.2"), "did you mean subsurface_radius");
    assert_eq!(of_material("surface_albedo = 0.2"), "did you mean subsurface_color");
    assert_eq!(of_material("base_color = { texture = \"a.png\" }"), "did you mean file");
}

#[test]
fn broken_shapes_suggest_the_nearest() {
    let error = parse("unit = \"mm\"\n[[object]]\nshape = \"shpere\"\n").unwrap_err();
    assert!(error.message.starts_with("object[0].shape is \"shpere\", but must be one of \"sphere\", "));
    assert_eq!(error.help.as_deref(), Some("did you mean \"sphere\"?"));
    let keys = "the keys are name, file, shape, material, unit, translate, rotate, scale, matrix, transforms, subsurface_group, radius, segments";
    let help = format!("did you mean radius? {keys}");
    let text = "unit = \"mm\"\n[[object]]\nshape = \"sphere\"\nradus = 2";
    refuse_file(text, "object[0] has no key radus", "radus", &help);
    let error = parse("unit = \"mm\"\n[[object]]\nshape = \"sphere\"\nradius = -1\n").unwrap_err();
    assert!(error.message.starts_with("object[0].radius is -1, but must be in ["), "{}", error.message);
    let error = parse("unit = \"mm\"\n[[object]]\nshape = \"sphere\"\nsegments = 8.5\n").unwrap_err();
    assert!(error.message.starts_with("object[0].segments is 8.5, but must be a whole number in ["));
}

#[test]
fn broken_shape_combinations_point_at_the_shape() {
    let text = "unit = \"mm\"\n[[object]]\nshape = \"torus\"\nradius = 1\ntube_radius = 2\n";
    let error = refuse_to_load(text);
    let message = "tube_radius is 2, but must be less than radius = 1";
    assert_error(&error, text, message, "\"torus\"", "");
}

#[test]
fn broken_light_is_refused() {
    refuse("[[light]]\npower = 1", "light[0] needs the key type", "[[light]]", "");
    let types = Light::KINDS.map(|kind| format!("\"{}\"", kind.name)).join(", ");
    let message = format!("light[0].type is \"rectangel\", but must be one of {types}");
    refuse("[[light]]\ntype = \"rectangel\"", &message, "\"rectangel\"", "did you mean \"rectangle\"?");
    refuse_each(
        "[[light]]\ntype = \"sphere\"\n",
        "
        radience = 3 | light[0] has no key radience | radience | did you mean radiance? the keys are type, center, radius, radiance, visible
        center = [0, 0, 0]\\nradius = 0 | light[0].radius is 0, but must be in (0, 1e10] | 0
        center = [0, 0, 0]\\nradius = 1\\nradiance = [1, 2, -3] | light[0].radiance[2] is -3, but must be in [0, 1e12] | -3
        ",
    );
    refuse_each(
        "[[light]]\ncenter = [1, 2, 3]\n",
        "
        type = 'rectangle' | light[0] needs the key target or direction | [[light]]
        type = 'rectangle'\\ntarget = [1, 2, 3] | light[0].target is [1, 2, 3], but must be a point other than the light's own | [1, 2, 3]
        type = 'rectangle'\\ntarget = [0, 0, 0]\\ndirection = [1, 0, 0] | light[0] has both direction and target, but must have one | [1, 0, 0]
        type = 'rectangle'\\ndirection = [0, 0, 0] | light[0].direction is [0, 0, 0], but must be a direction that is not zero | [0, 0, 0]
        ",
    );
    refuse_each(
        "[[light]]\n",
        "
        type = 'spot'\\nposition = [0, 9, 0]\\ntarget = [0, 0, 0]\\nintensity = 1\\nouter_angle = 30\\ninner_angle = 30 | light[0].inner_angle is 30, but must be in [0, 30) | 30
        type = 'distant'\\ndirection = [0, 1, 0]\\nirradiance = 1\\nangular_radius = 90 | light[0].angular_radius is 90, but must be in [0, 90) | 90
        ",
    );
}

#[test]
fn broken_exact_placement_of_lights_is_refused() {
    refuse_each(
        "[[light]]\ntype = \"rectangle\"\ncenter = [1, 2, 3]\nradiance = 1\nedge_x = [1, 0, 0]\n",
        "
        visible = true | light[0] needs the key edge_y | [[light]]
        edge_y = [0.5, 1, 0] | light[0], edge_y = [0.5, 1, 0]: must be perpendicular to edge_x | [0.5, 1, 0]
        edge_y = [0, 0, 0] | light[0], edge_y = [0, 0, 0]: must be a vector that is not zero | [0, 0, 0]
        edge_y = [0, 1, 0]\\nsize = [1, 1] | light[0] has edge_x and light[0].size, but must have one of them | [1, 1]
        ",
    );
    refuse_each(
        "[[light]]\ntype = \"distant\"\nirradiance = 1\n",
        "
        unit_direction = [0, 2, 0] | light[0].unit_direction is [0, 2, 0], but must be a vector of length 1 | [0, 2, 0]
        unit_direction = [0, 1, 0]\\ndirection = [1, 0, 0] | light[0].unit_direction and light[0].direction are given, but only one of them must be | [1, 0, 0]
        ",
    );
    refuse_each(
        "[[light]]\ntype = \"beam\"\norigin = [0, 0, 0]\nradius = 1\npower = 1\n",
        "unit_direction = [0, 1, 0]\\ntarget = [1, 0, 0] | light[0].unit_direction and light[0].target are given, but only one of them must be | [1, 0, 0]",
    );
}

#[test]
fn broken_environment_is_refused() {
    refuse_each(
        "[environment]\n",
        r#"
        radiance = 1\nmatrix = [1, 0, 0, 0, 1, 0, 0, 0, -1] | environment.matrix is [1, 0, 0, 0, 1, 0, 0, 0, -1], but must be a rotation, row by row | [1, 0, 0, 0, 1, 0, 0, 0, -1]
        radiance = 1\nrotation = 5\nmatrix = [1, 0, 0, 0, 1, 0, 0, 0, 1] | environment has both rotation and matrix, but must have one | [1, 0, 0, 0, 1, 0, 0, 0, 1]
        rotation = 0 | environment needs the key radiance | [environment]
        radiance = 1\nvisible = "no" | environment.visible is a string, but must be true or false | "no"
        rotaton = 1 | environment has no key rotaton | rotaton | did you mean rotation? the keys are radiance, file, rotation, matrix, visible
        "#,
    );
}

#[test]
fn broken_object_names_must_be_unique() {
    let text =
        "unit = \"mm\"\n[[object]]\nname = \"a\"\nshape = \"box\"\n[[object]]\nname = 'a'\nshape = \"box\"\n";
    let message = "object[1].name is 'a', but must be a name that no other table of the list has";
    refuse_file(text, message, "'a'", "");
}

#[test]
fn every_allowed_key_is_read() {
    // A date fits nowhere: a key that is listed but never read would let it pass.
    let object_keys: Vec<&str> = Object::KEYS.iter().map(|key| key.name).collect();
    let object = (String::from("object"), String::from("[[object]]\nfile = \"a.ply\"\n"), &object_keys[..]);
    let image = |key: &str, keys: &'static [&'static str]| {
        (key.to_owned(), format!("[[material]]\nname = \"m\"\n[material.{key}]\nfile = \"a.png\"\n"), keys)
    };
    let images = [
        image("base_color", COLOR_KEYS),
        image("coat_weight", SCALAR_KEYS),
        image("geometry_normal", NORMAL_KEYS),
    ];
    for (name, text, keys) in images.into_iter().chain([object]) {
        let complete = format!("unit = \"mm\"\n{BALL}{text}");
        parse(&complete).unwrap_or_else(|error| panic!("{error}\n{complete}"));
        for key in keys {
            let kept = text.lines().filter(|line| !line.starts_with(&format!("{key} ")));
            let lines: Vec<&str> = kept.collect();
            let text = format!("unit = \"mm\"\n{BALL}{}\n{key} = 1979-05-27\n", lines.join("\n"));
            let error = parse(&text).expect_err(&format!("{name}.{key} is never read"));
            assert!(error.message.contains(key) && error.message.contains("a date"), "{}", error.message);
        }
    }
}

#[test]
fn broken_mesh_and_image_paths_point_into_the_scene_file() {
    let text = "unit = \"mm\"\n[[object]]\nname = \"head\"\nfile = \"absent.ply\"\n";
    let error = refuse_to_load(text);
    let path = Path::new("scenes").join("absent.ply");
    let message = format!("the file {} does not exist", path.display());
    let help = "put the mesh there, or give its path with --mesh head=PATH";
    assert_error(&error, text, &message, "\"absent.ply\"", help);

    let text = format!("unit = \"mm\"\n{BALL}[environment]\nfile = \"absent.exr\"\n");
    let error = refuse_to_load(&text);
    let message = format!("the file {} does not exist", Path::new("scenes").join("absent.exr").display());
    assert_error(&error, &text, &message, "\"absent.exr\"", "");
}

#[test]
fn broken_placement_is_refused_where_the_object_names_its_shape() {
    let text = "unit = \"mm\"\n[[object]]\nshape = \"sphere\"\nscale = 9e8\ntranslate = [9e8, 0, 0]\n";
    let error = refuse_to_load(text);
    let message = "the object reaches to 1.8e9 in x, y or z, but coordinates must be in [-1e9, 1e9]";
    assert_error(&error, text, message, "\"sphere\"", "");
    // The same object where it fits.
    load("unit = \"mm\"\n[[object]]\nshape = \"sphere\"\nscale = 9e8\n");
}

/// The error of a file whose text is right.
fn refuse_to_load(text: &str) -> SceneError {
    let loaded = parse(text).unwrap().load(&LoadOptions::default(), &mut Vec::new());
    loaded.map(drop).unwrap_err()
}
