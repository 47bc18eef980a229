//! Broken scene files: every message says what is wrong, on which line, under which characters.

use std::path::Path;

use translucid_scene::description::{COLOR_KEYS, NORMAL_KEYS, SCALAR_KEYS};
use translucid_scene::{Light, Object, SceneError, SubsurfaceModel};

use super::{BALL, PATH, load, parse};
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

const CAMERA: &str = "[camera]\nposition = [0, 0, 5]\ntarget = [0, 0, 0]\n";

#[test]
fn broken_camera_is_refused() {
    let keys =
        "the keys are name, position, target, up, projection, fov, width, shift, lens_radius, focus_distance";
    let help = format!("did you mean position? {keys}");
    refuse("[camera]\npositon = [0, 0, 5]", "camera has no key positon", "positon", &help);
    refuse("[camera]\ntarget = [0, 0, 5]", "camera needs the key position", "[camera]", "");
    let same = "[camera]\nposition = [1, 2, 3]\ntarget = [1.0, 2.0, 3.0]";
    let message = "camera.target is [1.0, 2.0, 3.0], but must be a point other than the camera's position";
    refuse(same, message, "[1.0, 2.0, 3.0]", "");
    let message = "camera.position has 2 values, but must be an array of 3 numbers";
    refuse("[camera]\nposition = [1, 2]", message, "[1, 2]", "");
    let message = "camera.position[1] is a string, but must be a number in [-1e10, 1e10]";
    refuse("[camera]\nposition = [1, \"2\", 3]", message, "\"2\"", "");
    let message = "camera.position[2] is nan, but must be in [-1e10, 1e10]";
    refuse("[camera]\nposition = [1, 2, nan]", message, "nan", "");
    let message = "camera.position is a number, but must be an array of 3 numbers";
    refuse("[camera]\nposition = 7", message, "7", "");
    let message = "camera.fov is 180, but must be in (0, 180)";
    refuse(&format!("{CAMERA}fov = 180"), message, "180", "");
    let orthographic = format!("{CAMERA}projection = 'orthographic'\n");
    refuse(&orthographic, "camera needs the key width", "[camera]", "");
    let message = "camera.fov is not a key of a camera whose projection is orthographic";
    refuse(&format!("{orthographic}width = 2\nfov = 30"), message, "30", "");
    let message = "camera.width is not a key of a camera whose projection is perspective";
    refuse(&format!("{CAMERA}width = 2"), message, "2", "");
    let message = "camera.fov is 179.9999999999, but must be in (0, 180) in single precision";
    refuse(&format!("{CAMERA}fov = 179.9999999999"), message, "179.9999999999", "");
    let message = "camera.lens_radius is -1, but must be in [0, 1e9]";
    refuse(&format!("{CAMERA}lens_radius = -1"), message, "-1", "");
    let message = "camera.focus_distance is 1e-60, but must be in (0, 1e10] in single precision";
    refuse(&format!("{CAMERA}focus_distance = 1e-60"), message, "1e-60", "");
    let message =
        "camera.up is [0, 0, -3], but must be a direction that is not parallel to the viewing direction";
    refuse(&format!("{CAMERA}up = [0, 0, -3]"), message, "[0, 0, -3]", "");
    let down = "[camera]\nposition = [0, 5, 0]\ntarget = [0, 0, 0]";
    let message = "camera.up is [0, 1, 0] by default, but must be a direction that is not parallel to the viewing direction";
    refuse(down, message, "[camera]", "give camera.up, for example [0, 0, -1]");
}

#[test]
fn broken_film_is_refused() {
    let message = "film.size[0] is 0, but must be a whole number in [1, 16384]";
    refuse("[film]\nsize = [0, 5]", message, "0", "");
    let message = "film.size[1] is 2.5, but must be a whole number in [1, 16384]";
    refuse("[film]\nsize = [5, 2.5]", message, "2.5", "");
    let message = "film.size[0] is 100_000_000_000_000_000_000_000, but must be a whole number in [1, 16384]";
    let huge = "100_000_000_000_000_000_000_000";
    refuse(&format!("[film]\nsize = [{huge}, 5]"), message, huge, "");
    let message = "film.size has 3 values, but must be an array of 2 whole numbers, width and height";
    refuse("[film]\nsize = [5, 5, 5]", message, "[5, 5, 5]", "");
    let message = "film.filter is \"gausian\", but must be one of \"box\", \"gaussian\", \"blackman-harris\"";
    refuse("[film]\nfilter = \"gausian\"", message, "\"gausian\"", "did you mean \"gaussian\"?");
    refuse("[film]\nfilter_radius = 0", "film.filter_radius is 0, but must be in (0, 8]", "0", "");
    refuse("[film]\nexposure = inf", "film.exposure is inf, but must be in [-32, 32]", "inf", "");
    let message = "film.tone_mapping is \"aces\", but must be one of \"srgb\", \"neutral\", \"agx\"";
    refuse("[film]\ntone_mapping = \"aces\"", message, "\"aces\"", "");
}

#[test]
fn broken_integrator_is_refused() {
    let message = "integrator.samples_per_pixel is 0, but must be a whole number in [1, 16777216]";
    refuse("[integrator]\nsamples_per_pixel = 0", message, "0", "");
    let message = "integrator.max_depth is a string, but must be a whole number in [1, 1024]";
    refuse("[integrator]\nmax_depth = \"12\"", message, "\"12\"", "");
    let message = "integrator.caustics is a number, but must be true or false";
    refuse("[integrator]\ncaustics = 1", message, "1", "");
    let message = "integrator.subsurface_tail is 0.5, but must be in (0, 0.1]";
    refuse("[integrator]\nsubsurface_tail = 0.5", message, "0.5", "");
    let must = "must be one of \"ray-traced\", \"point-based\", \"cycles-disk\"";
    let message = format!("integrator.subsurface_method is \"points\", but {must}");
    refuse("[integrator]\nsubsurface_method = \"points\"", &message, "\"points\"", "");
    let message = "integrator.subsurface_sharing is a string, but must be true or false";
    refuse("[integrator]\nsubsurface_sharing = \"on\"", message, "\"on\"", "");
    let message = "integrator.point_tolerance is 0, but must be in [0.001, 1]";
    refuse("[integrator]\npoint_tolerance = 0", message, "0", "");
    let message = "integrator.point_memory is 0, but must be a whole number in [1, 1048576]";
    refuse("[integrator]\npoint_memory = 0", message, "0", "");
    let message = "integrator.seed is -1, but must be a whole number in [0, 18446744073709551615]";
    refuse("[integrator]\nseed = -1", message, "-1", "");
}

fn refuse_material(line: &str, message: &str, underlined: &str, help: &str) {
    refuse(&format!("[[material]]\nname = \"m\"\n{line}"), message, underlined, help);
}

#[test]
fn broken_material_is_refused() {
    refuse("[[material]]\nbase_weight = 1", "material[0] needs the key name", "[[material]]", "");
    refuse(
        "[[material]]\nname = \"\"",
        "material[0].name is \"\", but must be a name that is not empty",
        "\"\"",
        "",
    );
    let twice = "[[material]]\nname = \"a\"\n[[material]]\nname = 'a'";
    let message = "material[1].name is 'a', but must be a name that no other table of the list has";
    refuse(twice, message, "'a'", "");
    let message = "material[0].specular_roughness is 1.5, but must be in [0, 1]";
    refuse_material("specular_roughness = 1.5", message, "1.5", "");
    let message = "material[0].specular_ior is 0.5, but must be in [1, 4]";
    refuse_material("specular_ior = 0.5", message, "0.5", "");
    let message = "material[0].subsurface_scatter_anisotropy is 1, but must be in (-1, 1)";
    refuse_material("subsurface_scatter_anisotropy = 1", message, "1", "");
    let message = "material[0].subsurface_radius is -0.1, but must be in [0, 1e9]";
    refuse_material("subsurface_radius = -0.1", message, "-0.1", "");
    let names = SubsurfaceModel::ALL.map(|model| format!("\"{}\"", model.name())).join(", ");
    let message = format!("material[0].subsurface_model is \"dipol\", but must be one of {names}");
    refuse_material("subsurface_model = \"dipol\"", &message, "\"dipol\"", "did you mean \"dipole\"?");
    let message = "material[0].subsurface_eta is 4, but must be in [0.5, 3]";
    refuse_material("subsurface_eta = 4", message, "4", "");
    let message =
        "material[0].subsurface_texture_at is \"exits\", but must be one of \"exit\", \"entry\", \"both\"";
    refuse_material("subsurface_texture_at = \"exits\"", message, "\"exits\"", "did you mean \"exit\"?");
    let message =
        "material[0].subsurface_normalization is \"energi\", but must be one of \"none\", \"energy\"";
    refuse_material(
        "subsurface_normalization = \"energi\"",
        message,
        "\"energi\"",
        "did you mean \"energy\"?",
    );
    let message = "subsurface_table is the model: leave subsurface_model out, or the table";
    let both = "subsurface_model = \"none\"\nsubsurface_table = \"a.csv\"";
    refuse_material(both, message, "\"a.csv\"", "");
    let message = "material[0].subsurface_parameter is \"mpf\", but must be one of \"mfp\", \"dmfp\"";
    refuse_material("subsurface_parameter = \"mpf\"", message, "\"mpf\"", "did you mean \"mfp\"?");
    let message = "material[0].geometry_normal is a number, but must be the path of an image or a table with an image file";
    refuse_material("geometry_normal = 1", message, "1", "");
    let message = "material[0].specular_weight is a string, but must be a number in [0, 1] or a table with an image file";
    refuse_material("specular_weight = \"full\"", message, "\"full\"", "");
}

#[test]
fn broken_layers_are_refused() {
    let refuse_layer = |lines: &str, message: &str, underlined: &str| {
        refuse_material(&format!("[[material.layer]]\n{lines}"), message, underlined, "");
    };
    let medium = "scattering = 1\nabsorption = 1\n";
    for (thickness, found) in [("0", "0"), ("-1", "-1"), ("nan", "nan"), ("2e9", "2e9"), ("inf", "inf")] {
        let message = format!("material[0].layer[0].thickness is {found}, but must be in (0, 1e9]");
        refuse_layer(&format!("{medium}thickness = {thickness}"), &message, thickness);
    }
    for (g, range) in [("1", "(-1, 1)"), ("-1.5", "(-1, 1)"), ("nan", "(-1, 1)")] {
        let message = format!("material[0].layer[0].g is {g}, but must be in {range}");
        refuse_layer(&format!("{medium}thickness = 1\ng = {g}"), &message, g);
    }
    let message = "material[0].layer[0].g is 0.97, but must be in [-0.95, 0.95]";
    refuse_layer("surface_albedo = 0.5\nmfp = 1\nthickness = 1\ng = 0.97", message, "0.97");
    let message = "material[0].layer[0].mfp is 0, but must be in [1e-9, 1e9]";
    refuse_layer("surface_albedo = 0.5\nmfp = 0\nthickness = 1", message, "0");
    let message = "material[0].layer[0].mfp is a string, but must be a number or three numbers";
    refuse_layer("surface_albedo = 0.5\nmfp = '#ff0000'\nthickness = 1", message, "'#ff0000'");
    let message = "material[0].layer[0].surface_albedo[2] is 1.5, but must be in [0, 1]";
    refuse_layer("surface_albedo = [0, 1, 1.5]\nmfp = 1\nthickness = 1", message, "1.5");
    let message = "material[0].layer[0].absorption is -1, but must be in [0, 1e9]";
    refuse_layer("scattering = 1\nabsorption = -1\nthickness = 1", message, "-1");
    refuse_layer(medium, "material[0].layer[0] needs the key thickness", "[[material.layer]]");
    let message = "material[0].layer[0].mfp needs surface_albedo beside it";
    refuse_layer("thickness = 1\nmfp = 1", message, "1");
    let message = "material[0].layer[0] needs surface_albedo and mfp, or scattering and absorption";
    refuse_layer("thickness = 1", message, "[[material.layer]]");
    let message = "material[0].layer[0].mfp and material[0].layer[0].scattering are given, but only one of them must be";
    refuse_layer("thickness = 1\nmfp = 1\nscattering = 2", message, "2");
    let message = "material[0].layer is [], but must be one layer or more, or \"none\"";
    refuse_material("layer = []", message, "[]", "");
    let message = "material[0].layer is a number, but must be an array of tables, each with the header [[material.layer]]";
    refuse_material("layer = 3", message, "3", "");
    let layer = "layer = [{ thickness = 1, scattering = 1, absorption = 1 }]";
    let message = "material[0].subsurface_model is \"dipole\", but must be a random walk, \"layers\" or left out, because the material has layers";
    refuse_material(&format!("{layer}\nsubsurface_model = \"dipole\""), message, "\"dipole\"", "");
    for (line, fault) in [
        ("subsurface_color = 'vertex'", "subsurface_color varies from point to point"),
        (
            "subsurface_configuration = 'searchlight'",
            "subsurface_configuration is \"searchlight\", and the profile that of diffuse light",
        ),
    ] {
        let message = format!(
            "material[0].subsurface_model is \"layers\", but must be a random walk or left out, because {fault}"
        );
        refuse_material(
            &format!("{layer}\nsubsurface_model = \"layers\"\n{line}"),
            &message,
            "\"layers\"",
            "",
        );
    }
    let message =
        "material[0].subsurface_table is \"a.csv\", but must be left out, because the material has layers";
    refuse_material(&format!("{layer}\nsubsurface_table = \"a.csv\""), message, "\"a.csv\"", "");
    let message =
        "material[0].geometry_thin_walled is true, but must be false, because the material has layers";
    refuse_material(&format!("{layer}\ngeometry_thin_walled = true"), message, "true", "");
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
    assert!(error.help.unwrap().starts_with("did you mean \"skin1\"? the presets are apple, "));
    let (excerpt, span) = error.place.unwrap().excerpt.unwrap();
    assert_eq!(&excerpt[span], "\"skim1\"");
}

#[test]
fn broken_colors_are_refused() {
    let must = "three numbers, \"#rrggbb\", \"vertex\" or a table with an image file";
    let message = |found: &str| format!("material[0].base_color is {found}, but must be {must}");
    refuse_material("base_color = \"red\"", &message("\"red\""), "\"red\"", "");
    refuse_material("base_color = true", &message("a truth value"), "true", "");
    let hexadecimal = "material[0].base_color is \"#12345\", but must be \"#rrggbb\" with hexadecimal digits";
    refuse_material("base_color = \"#12345\"", hexadecimal, "\"#12345\"", "");
    let message = "material[0].base_color[2] is 1.01, but must be in [0, 1]";
    refuse_material("base_color = [0.1, 0.2, 1.01]", message, "1.01", "");
    let message = "material[0].base_color has 4 values, but must be an array of 3 numbers";
    refuse_material("base_color = [0, 0, 0, 1]", message, "[0, 0, 0, 1]", "");
    let message = "material[0].base_color needs the key file";
    refuse_material("base_color = { factor = 0.5 }", message, "{ factor = 0.5 }", "");
    let keys = "the keys are file, color_space, factor, vertex_color, uv_scale, uv_offset, uv_rotation, wrap";
    let help = format!("did you mean color_space? {keys}");
    let line = "base_color = { file = \"a.png\", colorspace = \"srgb\" }";
    refuse_material(line, "material[0].base_color has no key colorspace", "colorspace", &help);
    let message = "material[0].base_color.color_space is \"rgb\", but must be one of \"srgb\", \"linear\"";
    refuse_material(
        "base_color = { file = \"a.png\", color_space = \"rgb\" }",
        message,
        "\"rgb\"",
        "did you mean \"srgb\"?",
    );
    let message =
        "material[0].base_color.wrap[1] is \"tile\", but must be one of \"repeat\", \"mirror\", \"clamp\"";
    refuse_material(
        "base_color = { file = \"a.png\", wrap = [\"clamp\", \"tile\"] }",
        message,
        "\"tile\"",
        "",
    );
    let message = "material[0].coat_weight.channel is \"r\", but must be one of \"red\", \"green\", \"blue\", \"alpha\"";
    refuse_material("coat_weight = { file = \"a.png\", channel = \"r\" }", message, "\"r\"", "");
    let message = "material[0].base_color.file is \"\", but must be the path of a file";
    refuse_material("base_color = { file = \"\" }", message, "\"\"", "");
}

fn refuse_object(lines: &str, message: &str, underlined: &str, help: &str) {
    refuse_file(&format!("unit = \"mm\"\n[[object]]\n{lines}\n"), message, underlined, help);
}

#[test]
fn broken_object_is_refused() {
    refuse_object("name = \"a\"", "object[0] needs the key file or shape", "[[object]]", "");
    let both = "file = \"a.ply\"\nshape = \"sphere\"";
    refuse_object(both, "object[0] has both file and shape, but must have one", "\"sphere\"", "");
    let message = "object[0].scale is 0, but must be in [-1e9, 1e9] and at least 1e-9 away from zero";
    refuse_object("shape = \"sphere\"\nscale = 0", message, "0", "");
    let message = "object[0].scale is [1, 0, 1], but must be in [-1e9, 1e9] and at least 1e-9 away from zero";
    refuse_object("shape = \"sphere\"\nscale = [1, 0, 1]", message, "[1, 0, 1]", "");
    let message = "object[0].matrix has 3 values, but must be an array of 16 numbers";
    refuse_object("shape = \"sphere\"\nmatrix = [1, 0, 1]", message, "[1, 0, 1]", "");
    let flat = "[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1]";
    let message = format!("object[0].matrix is {flat}, but must be invertible: its determinant is 0");
    refuse_object(&format!("shape = \"sphere\"\nmatrix = {flat}"), &message, flat, "");
    let skewed = "[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 1]";
    let message = format!(
        "object[0].matrix is {skewed}, but must be four rows of four numbers whose last row is 0, 0, 0, 1"
    );
    refuse_object(&format!("shape = \"sphere\"\nmatrix = {skewed}"), &message, skewed, "");
    let message = "object[0] has matrix and object[0].scale, but must have one of them";
    refuse_object("shape = \"sphere\"\nscale = 2\nmatrix = []", message, "2", "");
    let message = "object[0].rotate[0] is inf, but must be in [-36000, 36000]";
    refuse_object("shape = \"sphere\"\nrotate = [inf, 0, 0]", message, "inf", "");
    let message = "object[0].unit is for files; a shape is in the scene's unit";
    refuse_object("shape = \"sphere\"\nunit = \"cm\"", message, "\"cm\"", "");
    let message = "object[0].file is a number, but must be the path of a file";
    refuse_object("file = 3", message, "3", "");
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

#[test]
fn broken_shapes_suggest_the_nearest() {
    let error = parse("unit = \"mm\"\n[[object]]\nshape = \"shpere\"\n").unwrap_err();
    assert!(error.message.starts_with("object[0].shape is \"shpere\", but must be one of \"sphere\", "));
    assert_eq!(error.help.as_deref(), Some("did you mean \"sphere\"?"));
    let keys = "the keys are name, file, shape, material, unit, translate, rotate, scale, matrix, transforms, subsurface_group, radius, segments";
    let help = format!("did you mean radius? {keys}");
    refuse_object("shape = \"sphere\"\nradus = 2", "object[0] has no key radus", "radus", &help);
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
    let help = "did you mean radiance? the keys are type, center, radius, radiance, visible";
    let text = "[[light]]\ntype = \"sphere\"\nradience = 3";
    refuse(text, "light[0] has no key radience", "radience", help);
    let text = "[[light]]\ntype = \"sphere\"\ncenter = [0, 0, 0]\nradius = 0";
    refuse(text, "light[0].radius is 0, but must be in (0, 1e10]", "0", "");
    let text = "[[light]]\ntype = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\nradiance = [1, 2, -3]";
    refuse(text, "light[0].radiance[2] is -3, but must be in [0, 1e12]", "-3", "");
    let rectangle = "[[light]]\ntype = \"rectangle\"\ncenter = [1, 2, 3]\n";
    refuse(rectangle, "light[0] needs the key target or direction", "[[light]]", "");
    let text = format!("{rectangle}target = [1, 2, 3]");
    let message = "light[0].target is [1, 2, 3], but must be a point other than the light's own";
    refuse(&text, message, "[1, 2, 3]", "");
    let text = format!("{rectangle}target = [0, 0, 0]\ndirection = [1, 0, 0]");
    refuse(&text, "light[0] has both direction and target, but must have one", "[1, 0, 0]", "");
    let text = format!("{rectangle}direction = [0, 0, 0]");
    let message = "light[0].direction is [0, 0, 0], but must be a direction that is not zero";
    refuse(&text, message, "[0, 0, 0]", "");
    let spot = "[[light]]\ntype = \"spot\"\nposition = [0, 9, 0]\ntarget = [0, 0, 0]\nintensity = 1\nouter_angle = 30\n";
    let message = "light[0].inner_angle is 30, but must be in [0, 30)";
    refuse(&format!("{spot}inner_angle = 30"), message, "30", "");
    let text = "[[light]]\ntype = \"distant\"\ndirection = [0, 1, 0]\nirradiance = 1\nangular_radius = 90";
    refuse(text, "light[0].angular_radius is 90, but must be in [0, 90)", "90", "");
}

#[test]
fn broken_exact_placement_of_lights_is_refused() {
    let rectangle = "[[light]]\ntype = \"rectangle\"\ncenter = [1, 2, 3]\nradiance = 1\n";
    let one = "edge_x = [1, 0, 0]";
    refuse(&format!("{rectangle}{one}"), "light[0] needs the key edge_y", "[[light]]", "");
    let message = "light[0], edge_y = [0.5, 1, 0]: must be perpendicular to edge_x";
    refuse(&format!("{rectangle}{one}\nedge_y = [0.5, 1, 0]"), message, "[0.5, 1, 0]", "");
    let message = "light[0], edge_y = [0, 0, 0]: must be a vector that is not zero";
    refuse(&format!("{rectangle}{one}\nedge_y = [0, 0, 0]"), message, "[0, 0, 0]", "");
    let message = "light[0] has edge_x and light[0].size, but must have one of them";
    refuse(&format!("{rectangle}{one}\nedge_y = [0, 1, 0]\nsize = [1, 1]"), message, "[1, 1]", "");
    let distant = "[[light]]\ntype = \"distant\"\nirradiance = 1\n";
    let message = "light[0].unit_direction is [0, 2, 0], but must be a vector of length 1";
    refuse(&format!("{distant}unit_direction = [0, 2, 0]"), message, "[0, 2, 0]", "");
    let message = "light[0].unit_direction and light[0].direction are given, but only one of them must be";
    let both = "unit_direction = [0, 1, 0]\ndirection = [1, 0, 0]";
    refuse(&format!("{distant}{both}"), message, "[1, 0, 0]", "");
    let point = "[[light]]\ntype = \"beam\"\norigin = [0, 0, 0]\nradius = 1\npower = 1\n";
    let message = "light[0].unit_direction and light[0].target are given, but only one of them must be";
    let both = "unit_direction = [0, 1, 0]\ntarget = [1, 0, 0]";
    refuse(&format!("{point}{both}"), message, "[1, 0, 0]", "");
}

#[test]
fn broken_environment_is_refused() {
    let mirror = "[1, 0, 0, 0, 1, 0, 0, 0, -1]";
    let message = format!("environment.matrix is {mirror}, but must be a rotation, row by row");
    refuse(&format!("[environment]\nradiance = 1\nmatrix = {mirror}"), &message, mirror, "");
    let message = "environment has both rotation and matrix, but must have one";
    let turn = "[1, 0, 0, 0, 1, 0, 0, 0, 1]";
    refuse(&format!("[environment]\nradiance = 1\nrotation = 5\nmatrix = {turn}"), message, turn, "");
    refuse("[environment]", "environment needs the key radiance", "[environment]", "");
    let message = "environment.visible is a string, but must be true or false";
    refuse("[environment]\nradiance = 1\nvisible = \"no\"", message, "\"no\"", "");
    let help = "did you mean rotation? the keys are radiance, file, rotation, matrix, visible";
    refuse("[environment]\nrotaton = 1", "environment has no key rotaton", "rotaton", help);
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
