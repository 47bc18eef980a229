//! Documents that are sound, and hostile ones.

use glam::{Vec2, Vec3};
use translucid_scene::description::SceneSlot;
use translucid_scene::{Channel, ColorInput, ColorSpace, ScalarInput, TextureFilter, Wrap};
use translucid_testing::mutants;

use super::*;
use crate::result::Result;

mod models;

type Found = Result<(Material, Vec<FileRequest<ImageKind>>)>;

fn read_bytes(bytes: &[u8], choice: MaterialChoice<'_>) -> (Found, Vec<String>) {
    let mut warnings = Vec::new();
    let found = read(bytes, Path::new("shop/a.mtlx"), choice, &mut warnings);
    (found, warnings.iter().map(ToString::to_string).collect())
}

const MILLIMETERS: MaterialChoice<'static> =
    MaterialChoice { name: None, length_unit: None, unit: Unit::Millimeter };

fn read_text(text: &str) -> (Found, Vec<String>) {
    read_bytes(text.as_bytes(), MILLIMETERS)
}

/// A document with a shader "S" of these inputs on its third line and on, and more after it.
fn document(category: &str, inputs: &str, rest: &str) -> String {
    format!(
        "<materialx version=\"1.39\">\n<{category} name=\"S\" type=\"surfaceshader\">\n{inputs}\n</{category}>\n{rest}\n\
         </materialx>\n"
    )
}

fn open_pbr(inputs: &str) -> String {
    document("open_pbr_surface", inputs, "")
}

/// The material of a document without warnings, whose lengths are in mm.
fn sound(text: &str) -> (Material, Vec<FileRequest<ImageKind>>) {
    let choice = MaterialChoice { length_unit: Some(Unit::Millimeter), ..MILLIMETERS };
    let (found, warnings) = read_bytes(text.as_bytes(), choice);
    assert_eq!(warnings, [""; 0], "{text}");
    found.unwrap()
}

fn error(text: &str) -> String {
    read_text(text).0.unwrap_err().to_string()
}

fn input(name: &str, kind: &str, value: &str) -> String {
    format!("<input name=\"{name}\" type=\"{kind}\" value=\"{value}\"/>")
}

#[test]
fn every_parameter_of_openpbr_is_read_and_nothing_else_changes() {
    for parameter in model::numbers() {
        let name = parameter.key();
        if matches!(name, "subsurface_eta" | "subsurface_flights") {
            let (_, warnings) = read_text(&open_pbr(&input(name, "float", "1.25")));
            assert!(warnings[0].contains(&format!("{name} is no input that is known")), "{warnings:?}");
            continue;
        }
        let (value, expected) = match name {
            "specular_ior" | "coat_ior" => ("1.25", 1.25),
            // Lumens per watt
            "emission_luminance" => ("1366", 2.0),
            _ => ("0.125", 0.125),
        };
        let mut changed = Material { name: "S".into(), ..Material::default() };
        let kind = match (parameter.slot)(&mut changed) {
            SceneSlot::Number(number, _) | SceneSlot::Length(number, _) => {
                *number = expected;
                "float"
            }
            SceneSlot::Scalar(input, _) => {
                input.factor = expected;
                "float"
            }
            SceneSlot::Color(input, _) => {
                input.factor = Vec3::splat(expected);
                "color3"
            }
            _ => unreachable!(),
        };
        let value = if kind == "color3" { [value; 3].join(", ") } else { value.to_owned() };
        let (found, _) = sound(&open_pbr(&input(name, kind, &value)));
        assert_eq!(found, changed, "{name}");
    }
}

/// The tiled wood of MaterialX's examples, with a map of normals besides.
const WOOD: &str = r#"<?xml version="1.0"?>
<materialx version="1.39" colorspace="lin_rec709">
  <!-- a remark -->
  <nodegraph name="NG" fileprefix="../images/">
    <tiledimage name="color" type="color3">
      <input name="file" type="filename" value="wood.jpg" colorspace="srgb_texture"/>
      <input name="uvtiling" type="vector2" value="4.0, 2.0"/>
      <input name="uvoffset" type="vector2" value="0.5, 0.25"/>
    </tiledimage>
    <image name="roughness" type="float">
      <input name="file" type="filename" value="wood_rough.png"/>
      <input name="uaddressmode" type="string" value="mirror"/>
      <input name="vaddressmode" type="string" value="clamp"/>
      <input name="filtertype" type="string" value="closest"/>
    </image>
    <image name="bumps" type="vector3"><input name="file" type="filename" value="wood_normal.png"/></image>
    <normalmap name="normals" type="vector3">
      <input name="in" type="vector3" nodename="bumps"/>
      <input name="scale" type="float" value="0.5"/>
    </normalmap>
    <output name="out_color" type="color3" nodename="color"/>
    <output name="out_roughness" type="float" nodename="roughness"/>
    <output name="out_normal" type="vector3" nodename="normals"/>
  </nodegraph>
  <standard_surface name="SR_wood" type="surfaceshader">
    <input name="base_color" type="color3" nodegraph="NG" output="out_color"/>
    <input name="specular_roughness" type="float" nodegraph="NG" output="out_roughness"/>
    <input name="normal" type="vector3" nodegraph="NG" output="out_normal"/>
  </standard_surface>
  <surfacematerial name="Wood" type="material">
    <input name="surfaceshader" type="surfaceshader" nodename="SR_wood"/>
  </surfacematerial>
</materialx>
"#;

#[test]
fn images_come_through_graphs_with_their_files_spaces_and_mappings() {
    let (wood, images) = sound(WOOD);
    assert_eq!(wood.name, "Wood");
    let files: Vec<_> = images.iter().map(|image| (image.path.to_str().unwrap(), image.kind)).collect();
    let expected = [
        ("shop/../images/wood.jpg", ImageKind::Plain(ColorSpace::Srgb)),
        ("shop/../images/wood_rough.png", ImageKind::Plain(ColorSpace::Linear)),
        ("shop/../images/wood_normal.png", ImageKind::Plain(ColorSpace::Linear)),
    ];
    assert_eq!(files, expected);
    assert_eq!(images[0].place.line, Some(6));
    let color = wood.base_color.texture.unwrap();
    assert_eq!((color.image, wood.base_color.factor), (0, Vec3::ONE));
    // uv · uvtiling − uvoffset
    assert_eq!(color.coordinates(Vec2::new(0.25, 0.75)), Vec2::new(0.5, 1.25));
    let (roughness, channel) = wood.specular_roughness.texture.unwrap();
    assert_eq!((roughness.image, roughness.wrap, channel), (1, [Wrap::Mirror, Wrap::Clamp], Channel::Red));
    assert_eq!([color.filter, roughness.filter], [TextureFilter::Linear, TextureFilter::Nearest]);
    let normals = wood.geometry_normal.unwrap();
    assert_eq!((normals.texture.image, normals.scale), (2, 0.5));
}

#[test]
fn nodes_of_values_channels_and_interfaces_are_computed() {
    let graph = r#"<nodegraph name="NG">
        <input name="tint" type="color3" value="0.5, 0.25, 1" />
        <image name="i" type="color4"><input name="file" type="filename" value="i.png"/></image>
        <convert name="i3" type="color3"><input name="in" type="color4" nodename="i"/></convert>
        <dot name="d" type="color3"><input name="in" type="color3" nodename="i3"/></dot>
        <constant name="c" type="color3"><input name="value" type="color3" value="1, 1, 0.5"/></constant>
        <multiply name="ct" type="color3"><input name="in1" type="color3" nodename="c"/><input name="in2" type="color3" interfacename="tint"/></multiply>
        <multiply name="m" type="color3"><input name="in1" type="color3" nodename="ct"/><input name="in2" type="color3" nodename="d"/></multiply>
        <separate4 name="s" type="multioutput"><input name="in" type="color4" nodename="i"/></separate4>
        <extract name="e" type="float"><input name="in" type="color3" nodename="m"/><input name="index" type="integer" value="1"/></extract>
        <output name="color" type="color3" nodename="m"/>
        <output name="alpha" type="float" nodename="s" output="outa"/>
        <output name="green" type="float" nodename="e"/>
        </nodegraph>"#;
    let inputs = r#"<input name="base_color" type="color3" nodegraph="NG" output="color"/>
        <input name="geometry_opacity" type="float" nodegraph="NG" output="alpha"/>
        <input name="specular_roughness" type="float" nodegraph="NG" output="green"/>"#;
    let (found, images) = sound(&document("open_pbr_surface", inputs, graph));
    assert_eq!(images.len(), 1, "{images:?}");
    assert_eq!(found.base_color.factor, Vec3::new(0.5, 0.25, 0.5));
    assert_eq!(found.geometry_opacity.texture.map(|(_, channel)| channel), Some(Channel::Alpha));
    assert_eq!((found.geometry_opacity.factor, found.specular_roughness.factor), (1.0, 0.25));
    assert_eq!(found.specular_roughness.texture.map(|(_, channel)| channel), Some(Channel::Green));
}

/// Connections with channels, and the nodes that `readFromXmlFile` of MaterialX 1.39.5 makes of each: extract, separate,
/// combine, convert and constants.
#[test]
fn channels_of_older_documents_are_those_of_their_conversion() {
    let graph = r#"<nodegraph name="NG"><input name="tint" type="color3" value="0.1, 0.2, 0.3"/>
        <constant name="c" type="color3"><input name="value" type="color3" value="0.1, 0.2, 0.3"/></constant>
        <constant name="c4" type="color4"><input name="value" type="color4" value="0.1, 0.2, 0.3, 0.4"/></constant>
        <constant name="f" type="float"><input name="value" type="float" value="0.7"/></constant>
        <constant name="v" type="vector2"><input name="value" type="vector2" value="0.7, 0.8"/></constant>
        <image name="i" type="color4"><input name="file" type="filename" value="i.png"/></image>
        <multiply name="m" type="color3"><input name="in1" type="color3" nodename="c" channels="bgr"/></multiply>
        <multiply name="n" type="color3"><input name="in1" type="color3" interfacename="tint" channels="bgr"/></multiply>
        <swizzle name="z" type="color3"><input name="in" type="color3" nodename="c"/>
        <input name="channels" type="string" value="grb"/></swizzle>
        OUTPUT</nodegraph>"#;
    let read = |version: &str, output: &str, input: &str| {
        let text = document("open_pbr_surface", input, &graph.replace("OUTPUT", output));
        read_text(&text.replace("1.39", version))
    };
    let color = r#"<input name="base_color" type="color3" nodegraph="NG"/>"#;
    let of =
        |node: &str, rest: &str| format!("<output name=\"o\" type=\"color3\" nodename=\"{node}\" {rest}/>");
    for (output, input, expected) in [
        (of("m", ""), color, [0.3, 0.2, 0.1]),
        (of("n", ""), color, [0.3, 0.2, 0.1]),
        (of("z", ""), color, [0.2, 0.1, 0.3]),
        (of("c", "channels=\"grb\""), color, [0.2, 0.1, 0.3]),
        (of("c", "channels=\"grb\""), &color.replace("/>", " channels=\"brr\"/>"), [0.3, 0.2, 0.2]),
        (of("c", "channels=\"r01\""), color, [0.1, 0.0, 1.0]),
        (of("f", "channels=\"rrr\""), color, [0.7, 0.7, 0.7]),
        (of("v", "channels=\"xyx\""), color, [0.7, 0.8, 0.7]),
        (of("c4", "channels=\"rgb\""), color, [0.1, 0.2, 0.3]),
        (
            of("c", ""),
            r#"<input name="base_color" type="color3" value="0.1, 0.2, 0.3" channels="bgr"/>"#,
            [0.3, 0.2, 0.1],
        ),
    ] {
        let (found, warnings) = read("1.38", &output, input);
        assert_eq!(warnings, [""; 0], "{output}");
        assert_eq!(found.unwrap().0.base_color, ColorInput::constant(Vec3::from(expected)), "{output}");
    }
    let metal = r#"<input name="base_metalness" type="float" nodegraph="NG" channels="b"/>"#;
    assert_eq!(read("1.38", &of("c", ""), metal).0.unwrap().0.base_metalness, ScalarInput::constant(0.3));
    let texture = read("1.37", &of("i", "channels=\"rgb\""), metal).0.unwrap().0.base_metalness.texture;
    assert_eq!(texture.map(|(_, channel)| channel), Some(Channel::Blue));
    let alpha = metal.replace("\"b\"", "\"a\"");
    let output = of("i", "").replace("color3", "color4");
    let texture = read("1.38", &output, &alpha).0.unwrap().0.base_metalness.texture;
    assert_eq!(texture.map(|(_, channel)| channel), Some(Channel::Alpha));
    for (version, output, part) in [
        (
            "1.38",
            of("i", "channels=\"bgr\""),
            "base_color keeps its default: channels \"bgr\" changes the order of an image's",
        ),
        ("1.39", of("c", "channels=\"bgr\""), "channels \"bgr\" is left out: it is of MaterialX up to 1.38"),
    ] {
        let (found, warnings) = read(version, &output, color);
        assert!(found.is_ok() && warnings.len() == 1 && warnings[0].contains(part), "{warnings:?}");
    }
    for letters in ["rg", "rga", "rgba", "rgq", "", "rgbrgbrgb"] {
        let message =
            read("1.38", &of("c", &format!("channels=\"{letters}\"")), color).0.unwrap_err().to_string();
        assert!(
            message.contains(&format!("channels is \"{letters}\", but must be the letters of")),
            "{message}"
        );
    }
    let moved = r#"<image name="j" type="color3"><input name="file" type="filename" value="i.png"/>
        <input name="texcoord" type="vector2" nodename="v" channels="yx"/></image>"#;
    let (_, warnings) = read("1.38", &format!("{moved}{}", of("j", "")), color);
    assert!(warnings[0].contains("channels \"yx\" is left out: it has no counterpart here"), "{warnings:?}");
}

#[test]
fn images_without_a_file_are_their_defaults() {
    let default = r#"<input name="default" type="color3" value="0.1, 0.2, 0.3"/>"#;
    for (node, file, expected) in [
        ("image", "", [0.1, 0.2, 0.3]),
        ("tiledimage", r#"<input name="file" type="filename" value=""/>"#, [0.1, 0.2, 0.3]),
        ("gltf_image", r#"<input name="factor" type="color3" value="0.5, 1, 1"/>"#, [0.05, 0.2, 0.3]),
    ] {
        let node = format!("<{node} name=\"i\" type=\"color3\">{file}{default}</{node}>");
        let shader = "<input name=\"base_color\" type=\"color3\" nodename=\"i\"/>";
        let (found, images) = sound(&document("open_pbr_surface", shader, &node));
        assert_eq!((found.base_color, images.len()), (ColorInput::constant(Vec3::from(expected)), 0));
    }
}

/// Against the node's own steps in the standard library: subtract, divide, rotate2d, subtract, add.
#[test]
fn place2d_is_what_the_standard_library_computes() {
    for order in [0, 1] {
        let nodes = format!(
            r#"<texcoord name="t" type="vector2"/>
            <place2d name="p" type="vector2"><input name="texcoord" type="vector2" nodename="t"/>
            <input name="pivot" type="vector2" value="0.5, 0.25"/><input name="scale" type="vector2" value="2, 4"/>
            <input name="rotate" type="float" value="30" unit="degree"/><input name="offset" type="vector2" value="0.1, 0.2"/>
            <input name="operationorder" type="integer" value="{order}"/></place2d>
            <image name="i" type="color3"><input name="file" type="filename" value="i.png"/>
            <input name="texcoord" type="vector2" nodename="p"/></image>"#
        );
        let shader = "<input name=\"base_color\" type=\"color3\" nodename=\"i\"/>";
        let texture = sound(&document("open_pbr_surface", shader, &nodes)).0.base_color.texture.unwrap();
        let (pivot, scale, offset) = (Vec2::new(0.5, 0.25), Vec2::new(2.0, 4.0), Vec2::new(0.1, 0.2));
        let (sin, cos) = 30_f32.to_radians().sin_cos();
        let rotated = |v: Vec2| Vec2::new(cos * v.x + sin * v.y, -sin * v.x + cos * v.y);
        for uv in [Vec2::ZERO, Vec2::new(0.3, 0.9), Vec2::new(-2.0, 5.0)] {
            let expected = match order {
                0 => rotated((uv - pivot) / scale) - offset + pivot,
                _ => rotated(uv - pivot - offset) / scale + pivot,
            };
            let found = texture.coordinates(uv);
            assert!(found.abs_diff_eq(expected, 1e-5), "{order}: {uv} becomes {found}, not {expected}");
        }
    }
}

#[test]
fn lengths_have_the_unit_that_is_stated_else_the_scenes_which_is_told() {
    let with_unit = |unit: &str| {
        let unit =
            if unit.is_empty() { String::new() } else { format!(" unit=\"{unit}\" unittype=\"distance\"") };
        open_pbr(&format!(
            "{}<input name=\"subsurface_radius\" type=\"float\" value=\"2\"{unit}/>",
            input("subsurface_weight", "float", "1")
        ))
    };
    let radius = |text: &str, unit: Unit, length_unit: Option<Unit>| {
        let (found, warnings) = read_bytes(text.as_bytes(), MaterialChoice { name: None, length_unit, unit });
        (found.unwrap().0.subsurface_radius.factor, warnings)
    };
    for (name, millimeters) in
        [("millimeter", 2.0), ("centimeter", 20.0), ("meter", 2000.0), ("inch", 50.8), ("micron", 0.002)]
    {
        for (unit, own) in [(Unit::Millimeter, 1.0), (Unit::Centimeter, 10.0), (Unit::Meter, 1000.0)] {
            let (found, warnings) = radius(&with_unit(name), unit, Some(Unit::Meter));
            assert!((found - millimeters / own).abs() < 1e-6 * found, "{name}: {found}");
            assert_eq!(warnings, [""; 0]);
        }
    }
    // OpenPBR 1.1.1: lengths are in the units of world space
    let (found, warnings) = radius(&with_unit(""), Unit::Centimeter, None);
    assert_eq!(found, 2.0);
    let expected = "shop/a.mtlx:2: open_pbr_surface \"S\", subsurface_radius without a unit: taken in the scene's, cm (file_unit";
    assert!(warnings.len() == 1 && warnings[0].starts_with(expected), "{warnings:?}");
    assert_eq!(radius(&with_unit(""), Unit::Millimeter, Some(Unit::Centimeter)), (20.0, vec![]));
    // The default of 1 has no unit either; one that does nothing is not worth a word
    let (_, warnings) = read_text(&open_pbr(&input("subsurface_weight", "float", "1")));
    assert!(warnings[0].contains("subsurface_radius without a unit"), "{warnings:?}");
    let (found, warnings) = read_text(&document("standard_surface", &input("subsurface", "float", "1"), ""));
    assert!(found.is_ok() && warnings[0].contains("subsurface_scale without a unit"), "{warnings:?}");
    assert_eq!(read_text(&open_pbr(&input("subsurface_radius", "float", "3"))).1, [""; 0]);
}

#[test]
fn colors_have_the_space_of_the_nearest_element_that_states_one() {
    let text = r#"<materialx colorspace="acescg"><nodegraph name="NG" colorspace="srgb_texture">
        <constant name="c" type="color3"><input name="value" type="color3" value="0.5, 0.5, 0.5"/></constant>
        <constant name="l" type="color3"><input name="value" type="color3" value="0.5, 0.5, 0.5" colorspace="none"/></constant>
        <output name="c" type="color3" nodename="c"/><output name="l" type="color3" nodename="l"/></nodegraph>
        <open_pbr_surface name="S" type="surfaceshader">
        <input name="base_color" type="color3" nodegraph="NG" output="c"/>
        <input name="specular_color" type="color3" nodegraph="NG" output="l"/>
        <input name="emission_color" type="color3" value="0, 1, 0"/>
        <input name="specular_roughness" type="float" value="0.5"/>
        </open_pbr_surface></materialx>"#;
    let (found, warnings) = read_text(text);
    let (found, _) = found.unwrap();
    assert!((found.base_color.factor - Vec3::splat(0.214_041)).abs().max_element() < 1e-6);
    assert_eq!(found.specular_color.factor, Vec3::splat(0.5));
    assert_eq!(found.specular_roughness.factor, 0.5);
    // The green of ACEScg is beyond Rec. 709: two channels are negative, and set to 0 with a warning each
    let green = found.emission_color.factor;
    assert!(green.x == 0.0 && green.z == 0.0 && (green.y - 1.1408).abs() < 1e-3, "{green}");
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    assert!(
        warnings[0].contains("emission_color is -0.62") && warnings[0].contains("it becomes 0"),
        "{warnings:?}"
    );
    let unknown =
        open_pbr("<input name=\"base_color\" type=\"color3\" value=\"1,1,1\" colorspace=\"sRGB\"/>");
    let (found, warnings) = read_text(&unknown);
    assert_eq!(found.unwrap().0.base_color.factor, Vec3::ONE);
    assert!(warnings[0].contains("the color space sRGB is not known: taken as lin_rec709"), "{warnings:?}");
}

/// Rows of a table whose columns are apart by " | ".
fn rows<const N: usize>(table: &'static str) -> impl Iterator<Item = [&'static str; N]> {
    let rows = table.lines().map(str::trim).filter(|row| !row.is_empty());
    rows.map(|row| row.split('|').map(str::trim).collect::<Vec<_>>().try_into().expect(row))
}

/// Inputs as they are, or one by its name, type, and value or "@" and the node that it is connected to.
fn inputs_of(text: &str) -> String {
    let words: Vec<&str> = text.splitn(3, ' ').collect();
    match words[..] {
        [name, kind, value] if !name.starts_with('<') => match value.strip_prefix('@') {
            Some(node) => format!("<input name=\"{name}\" type=\"{kind}\" nodename=\"{node}\"/>"),
            None => input(name, kind, value),
        },
        _ => text.to_owned(),
    }
}

/// Inputs that cannot be translated, each with more elements and with the words of its only warning behind the place
/// "shop/a.mtlx:3: ".
const UNTRANSLATED: &str = r#"
    fuzz_weight float 0.5 | | fuzz_weight has no counterpart here: left out
    <input name="geometry_thin_walled" type="boolean"/> | | geometry_thin_walled keeps its default: it has no value of its own
    transmission_scatter color3 0,0,1 | | transmission_scatter has no counterpart
    coat_darkening float @i | <image name="i" type="float"><input name="file" type="filename" value="i.png"/></image> | coat_darkening has no counterpart
    base_colour color3 1,1,1 | | base_colour is no input that is known: left out: did you mean base_color?
    base_color color3 1,1.5,1 | | base_color is 1.5, but must be in [0, 1]: it becomes 1
    subsurface_radius float -2 | | subsurface_radius is -2, but must be in [0, 1e9]: it becomes 0
    specular_ior float 0 | | specular_ior is 0, but must be in [1, 4]: it becomes 1
    specular_ior float @i | <image name="i" type="float"><input name="file" type="filename" value="i.png"/></image> | specular_ior keeps its default: it may not vary over the surface
    <input name="base_color" type="color3"/> | | base_color keeps its default: it has neither a value nor a connection
    <input name="specular_roughness" type="float" value="0.5" unit="millimeter"/> | | specular_roughness is no length: its unit is left out
    specular_roughness float @i | <noise2d name="i" type="float"/> | specular_roughness keeps its default: the node noise2d "i" has no counterpart here
    specular_roughness float @i | <dot name="i" type="float"/> | keeps its default: dot "i" has no input in
    specular_roughness float @i | <image name="i" type="float"><input name="file" type="filename" value="i.png"/><input name="filtertype" type="string" value="cubic"/></image> | filtertype "cubic" of image "i" is left out
    specular_roughness float @i | <image name="i" type="float"><input name="file" type="filename" value="i.png"/><input name="uaddressmode" type="string" value="constant"/></image> | uaddressmode constant of image "i" is taken as clamp
    specular_roughness float @i | <image name="i" type="float"><input name="file" type="filename" value="i.&lt;UDIM&gt;.png"/></image> | the file name "i.<UDIM>.png" has parts to be substituted
    base_color color3 @i | <image name="i" type="color3"><input name="file" type="filename" colorspace="acescg" value="i.png"/></image> | images in the color space acescg are read as lin_rec709
    geometry_normal vector3 @i | <image name="i" type="vector3"><input name="file" type="filename" value="i.png"/></image> | geometry_normal keeps its default: image "i" is no normalmap
    <token name="t"/> | | token "t" of open_pbr_surface "S" is left out
    | <xi:include xmlns:xi="http://www.w3.org/2001/XInclude" href="/etc/passwd"/> | the document "/etc/passwd" that is included is left out
"#;

#[test]
fn what_cannot_be_translated_is_told_once_with_its_place() {
    for [inputs, rest, expected] in rows(UNTRANSLATED) {
        let (found, warnings) = read_text(&document("open_pbr_surface", &inputs_of(inputs), rest));
        let (material, images) = found.unwrap();
        material.validate(images.len(), 0).unwrap();
        // An image that nothing shows is not asked for
        let shown =
            [material.base_color.texture, material.specular_roughness.texture.map(|(texture, _)| texture)];
        assert_eq!(images.len(), shown.into_iter().flatten().count(), "{expected}");
        assert!(warnings.len() == 1 && warnings[0].contains(expected), "{warnings:?}\n{expected}");
        let line = if rest.is_empty() { "shop/a.mtlx:3: " } else { "shop/a.mtlx:" };
        assert!(warnings[0].starts_with(line), "{warnings:?}");
    }
    // What changes nothing is not worth a word
    sound(&open_pbr(&format!(
        "{}{}{}<input name=\"geometry_normal\" type=\"vector3\" defaultgeomprop=\"Nworld\"/>",
        input("coat_darkening", "float", "1.0"),
        input("transmission_scatter", "color3", "0, 0.0, 0"),
        input("fuzz_color", "color3", "1, 0, 0"),
    )));
}

#[test]
fn thin_walls_are_those_of_the_shader() {
    for (category, name) in
        [("open_pbr_surface", "geometry_thin_walled"), ("standard_surface", "thin_walled")]
    {
        for (word, expected) in [("true", true), ("false", false)] {
            let text = document(category, &input(name, "boolean", word), "");
            assert_eq!(sound(&text).0.geometry_thin_walled, expected);
        }
        let wrong = error(&document(category, &input(name, "boolean", "yes"), ""));
        assert!(wrong.contains("it is \"yes\", but must be true or false"), "{wrong}");
    }
}

/// Mistakes of values and references: the input on line 3, more elements, and what the error says after the line.
const MISTAKES: &str = r#"
    base_color color3 red | | base_color: it is "red", but must be 3 finite numbers (color3)
    base_color color3 1, 0 | | base_color: it is "1, 0", but must be 3 finite numbers
    base_color color3 1, nan, 0 | | base_color: it is "1, nan, 0", but must be 3
    base_color color3 1, 1, 1, 1, 1, 1 | | but must be 3 finite numbers
    base_color string red | | base_color: it is "red", but must be of a type with numbers, not string
    base_color float 0.5 | | base_color has 1 channels, but must be a color3
    specular_roughness color3 1,1,1 | | specular_roughness has 3 channels, but must be a float
    subsurface_radius float inf | | subsurface_radius: it is "inf", but must be a finite number
    subsurface_radius float 1e39 | | it is "1e39", but must be a finite number
    <input name="subsurface_radius" type="float" value=""/> | | it is "", but must be a finite number
    <input name="subsurface_radius" type="float" value="1" unit="furlong"/> | | unit is "furlong", but must be one of nanometer, micron, millimeter, centimeter
    base_color color3 @gone | | the document has no node named "gone"
    <input name="base_color" type="color3" nodegraph="gone" output="out"/> | | the document has no node named "gone"
    <input name="base_color" type="color3" interfacename="gone"/> | | the document has no input named "gone"
    <input name="base_weight" type="float" value="1"/><input name="base_weight" type="float" value="1"/> | | open_pbr_surface "S" has several elements named "base_weight"
    specular_roughness float @n | <nodegraph name="n"><output name="a" type="float"/><output name="b" type="float"/></nodegraph> | nodegraph "n" does not have one output, so one must be named
    specular_roughness float @n | <constant name="n" type="float"><input name="value" type="float" value="one"/></constant> | value is "one", but must be a finite number
    specular_roughness float @n | <extract name="n" type="float"><input name="in" type="color3" value="1,1,1"/><input name="index" type="integer" value="3"/></extract> | extract "n" asks for a channel that its input of 3 has not
    specular_roughness float @n | <image name="n" type="float"/> | image "n" names no file
    specular_roughness float @n | <image name="n" type="float"><input name="file" type="filename" value="a.png"/><input name="vaddressmode" type="string" value="stretch"/></image> | vaddressmode is "stretch", but must be constant, clamp, periodic or mirror
    specular_roughness float @n | <tiledimage name="n" type="float"><input name="file" type="filename" value="a.png"/><input name="uvtiling" type="vector2" value="1e9, 1"/></tiledimage> | tiledimage "n" scales or moves texture coordinates too far
    specular_roughness float @n | <tiledimage name="n" type="float"><input name="file" type="filename" value="a.png"/><input name="realworldimagesize" type="vector2" value="0, 0"/></tiledimage> | tiledimage "n" scales or moves texture coordinates too far
    specular_roughness float @n | <multiply name="n" type="float"><input name="in1" type="float" value="1e38"/><input name="in2" type="float" value="1e38"/></multiply> | multiply "n" is beyond all numbers
"#;

#[test]
fn mistakes_are_errors_that_name_line_input_value_and_what_is_allowed() {
    for [inputs, rest, expected] in rows(MISTAKES) {
        let message = error(&document("open_pbr_surface", &inputs_of(inputs), rest));
        assert!(message.starts_with("shop/a.mtlx:") && message.contains(expected), "{message}\n{expected}");
    }
}

#[test]
fn materials_are_chosen_by_name_where_there_are_several() {
    let materials = r#"<materialx>
        <open_pbr_surface name="A" type="surfaceshader"><input name="base_weight" type="float" value="0.25"/></open_pbr_surface>
        <lama_surface name="B" type="surfaceshader"/>
        <surfacematerial name="Wax" type="material"><input name="surfaceshader" type="surfaceshader" nodename="A"/></surfacematerial>
        <surfacematerial name="Tin" type="material"><input name="surfaceshader" type="surfaceshader" nodename="B"/></surfacematerial>
        <surfacematerial name="Void" type="material"/></materialx>"#;
    let choose = |name: Option<&str>| {
        let (found, _) = read_bytes(materials.as_bytes(), MaterialChoice { name, ..MILLIMETERS });
        found.map(|(material, _)| (material.name, material.base_weight)).map_err(|error| error.to_string())
    };
    assert_eq!(choose(Some("Wax")), Ok(("Wax".into(), 0.25)));
    for (name, expected) in [
        (None, "1: the document has 3 materials, so file_material must name one (they are Wax, Tin, Void)"),
        (Some("wex"), "1: the document has no material \"wex\" (did you mean \"Wax\"?)"),
        (
            Some("Tin"),
            "3: the shader is lama_surface \"B\", but must be one of open_pbr_surface, standard_surface, gltf_pbr, \
             UsdPreviewSurface, disney_principled",
        ),
        (Some("Void"), "6: surfacematerial \"Void\" has no surfaceshader that is connected"),
    ] {
        assert_eq!(choose(name).unwrap_err(), format!("shop/a.mtlx:{expected}"));
    }
    assert!(error("<materialx/>").contains("the document has no surfacematerial, and no open_pbr_surface"));
    assert!(error("<svg/>").contains("the document is a svg, but must be a materialx"));
}

#[test]
fn what_is_no_sound_xml_is_refused_with_its_line() {
    for (text, expected) in [
        ("", ":1: this is not valid XML: "),
        ("<materialx>\n<open_pbr_surface>\n</materialx>", ":3: this is not valid XML: "),
        ("<materialx a='1' a='2'/>", "this is not valid XML: attribute 'a' at 1:18 is already defined"),
        ("<materialx>&unknown;</materialx>", "this is not valid XML: "),
        ("<materialx><x:y/></materialx>", "this is not valid XML: "),
        ("{\"asset\": {}}", "this is not valid XML: "),
        (
            "<materialx><a value=\"i.<UDIM>.png\"/></materialx>",
            "(a < in a value, as in <UDIM>, is written &lt;)",
        ),
    ] {
        let message = error(text);
        assert!(message.starts_with("shop/a.mtlx:") && message.contains(expected), "{message}\n{expected}");
    }
    for bytes in [&b"<materialx name=\"\xff\"/>"[..], b"\xff\xfe<\0m\0", b"\0\0\0"] {
        assert!(read_bytes(bytes, MILLIMETERS).0.is_err());
    }
    let message = read_bytes(b"<materialx name=\"\xff\"/>", MILLIMETERS).0.unwrap_err().to_string();
    assert_eq!(message, "shop/a.mtlx, byte 17: a MaterialX document must be UTF-8 text, but this is not");
}

/// "Billion laughs", and an entity that is another file.
#[test]
fn documents_with_a_type_are_refused_before_any_entity_is_expanded() {
    let laughs = (1..30).fold(String::from("<!ENTITY l0 \"ha\">"), |text, n| {
        format!("{text}<!ENTITY l{n} \"{}\">", format!("&l{};", n - 1).repeat(10))
    });
    let outside = "<!ENTITY l29 SYSTEM \"file:///etc/passwd\">".to_owned();
    for entities in [laughs, outside] {
        let text = format!("<!DOCTYPE materialx [{entities}]><materialx>&l29;</materialx>");
        let message = error(&text);
        assert!(message.contains("the document has a document type, which is not read"), "{message}");
    }
}

#[test]
fn nodes_in_a_circle_or_without_end_are_refused() {
    let dot = |name: &str, of: &str| {
        format!(
            "<dot name=\"{name}\" type=\"float\"><input name=\"in\" type=\"float\" nodename=\"{of}\"/></dot>"
        )
    };
    let connected = "<input name=\"specular_roughness\" type=\"float\" nodename=\"n0\"/>";
    let circle = [dot("n0", "n1"), dot("n1", "n2"), dot("n2", "n0")].concat();
    let message = error(&document("open_pbr_surface", connected, &circle));
    assert!(message.contains("specular_roughness: dot \"n0\" feeds itself"), "{message}");
    assert!(error(&document("open_pbr_surface", connected, &dot("n0", "n0"))).contains("feeds itself"));
    let graph = "<nodegraph name=\"n0\"><input name=\"i\" type=\"float\" interfacename=\"i\"/>\
        <output name=\"o\" type=\"float\" output=\"o\"/></nodegraph>";
    assert!(
        error(&document("open_pbr_surface", connected, graph))
            .contains("references in a row, or in a circle")
    );
    let place = "<image name=\"n0\" type=\"float\"><input name=\"file\" type=\"filename\" value=\"a.png\"/>\
        <input name=\"texcoord\" type=\"vector2\" nodename=\"p\"/></image>\
        <place2d name=\"p\" type=\"vector2\"><input name=\"texcoord\" type=\"vector2\" nodename=\"p\"/></place2d>";
    assert!(error(&document("open_pbr_surface", connected, place)).contains("place2d \"p\" feeds itself"));
    // A chain of a million nodes, and forty that each use the one before twice: 2⁴⁰ ways
    let chain: String = (0..100_000).map(|n| dot(&format!("n{n}"), &format!("n{}", n + 1))).collect();
    assert!(error(&document("open_pbr_surface", connected, &chain)).contains("too many nodes lie behind it"));
    let square = |n: usize| {
        let next = format!("type=\"float\" nodename=\"n{}\"", n + 1);
        format!(
            "<multiply name=\"n{n}\" type=\"float\"><input name=\"in1\" {next}/><input name=\"in2\" {next}/></multiply>"
        )
    };
    let squares: String = (0..40).map(square).collect();
    let end =
        format!("{squares}<constant name=\"n40\" type=\"float\">{}</constant>", input("value", "float", "1"));
    assert!(error(&document("open_pbr_surface", connected, &end)).contains("too many nodes lie behind it"));
}

#[test]
fn huge_documents_are_read_or_refused_and_warnings_have_an_end() {
    // 200,000 elements that nothing refers to, and 100,000 inputs that mean nothing
    let many: String = (0..200_000).map(|n| format!("<dot name=\"d{n}\"/>")).collect();
    sound(&document("open_pbr_surface", &input("base_weight", "float", "0.5"), &many));
    let inputs: String = (0..100_000).map(|n| format!("<input name=\"i{n}\"/>")).collect();
    let (found, warnings) = read_text(&open_pbr(&inputs));
    assert!(found.is_ok());
    assert_eq!(warnings.len(), 256);
    assert!(warnings[255].contains("no more are listed"), "{}", warnings[255]);
    let beyond = "<a/>".repeat(1 << 20);
    assert!(error(&open_pbr(&beyond)).contains("more than 1048576 elements and texts"));
    let deep = format!("<materialx>{}{}</materialx>", "<a>".repeat(500_000), "</a>".repeat(500_000));
    assert!(error(&deep).contains("no surfacematerial"));
    let long = open_pbr(&input("base_color", "color3", &"9".repeat(1 << 20)));
    assert!(error(&long).len() < 400);
}

#[test]
fn any_mutation_is_an_error_or_a_valid_material() {
    let (mut read, mut refused) = (0, 0);
    for mutant in mutants(WOOD.as_bytes(), 4_000) {
        match read_bytes(&mutant, MILLIMETERS).0 {
            Ok((material, images)) => {
                read += 1;
                material.validate(images.len(), 0).unwrap();
            }
            Err(error) => {
                refused += 1;
                assert!(error.to_string().starts_with("shop/a.mtlx"), "{error}");
            }
        }
    }
    assert!(read > 100 && refused > 100, "{read} {refused}");
}

#[test]
fn constants_of_images_inputs_have_no_vertex_colors() {
    let (found, _) = sound(&open_pbr(&input("base_color", "color3", "0.1 0.2 0.3")));
    assert_eq!(found.base_color, ColorInput::constant(Vec3::new(0.1, 0.2, 0.3)));
}
