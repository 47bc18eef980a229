//! Materials of scene files that are in MaterialX documents.

use std::path::Path;

use translucid_scene::{Material, Scene, Unit};

use super::BALL;
use crate::result::Result;
use crate::{LoadOptions, Piece, SceneBuilder, SceneFile};

const SOAP: &str = r#"<materialx version="1.39">
  <open_pbr_surface name="SR" type="surfaceshader">
    <input name="subsurface_weight" type="float" value="1"/>
    <input name="subsurface_radius" type="float" value="0.5" unit="centimeter"/>
    <input name="base_color" type="color3" nodename="bark"/>
    <input name="fuzz_weight" type="float" value="1"/>
  </open_pbr_surface>
  <image name="bark" type="color3"><input name="file" type="filename" value="FILE"/></image>
  <surfacematerial name="Soap" type="material"><input name="surfaceshader" type="surfaceshader" nodename="SR"/></surfacematerial>
  <surfacematerial name="Bare" type="material"><input name="surfaceshader" type="surfaceshader" nodename="SR"/></surfacematerial>
</materialx>
"#;

/// A folder with a document in a folder of its own, and an image beside that.
struct Shop(tempfile::TempDir);

impl Shop {
    fn new(image: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir_all(folder.path().join("maps")).unwrap();
        std::fs::create_dir_all(folder.path().join("materials")).unwrap();
        std::fs::write(folder.path().join("materials/soap.mtlx"), SOAP.replace("FILE", image)).unwrap();
        // Radiance HDR of a pixel
        let image = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\x80\x80\x80\x80";
        std::fs::write(folder.path().join("maps/bark.hdr"), image).unwrap();
        Self(folder)
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    /// The scene of a file with a material of these lines, and its warnings.
    fn load(&self, lines: &str) -> (Result<Scene>, Vec<String>) {
        let text = format!("unit = \"mm\"\n[[material]]\nname = \"m\"\n{lines}\n{BALL}material = \"m\"\n");
        let mut warnings = Vec::new();
        let file = SceneFile::parse(&text, &self.path().join("a.toml")).unwrap();
        let scene = file.load(&LoadOptions::default(), &mut warnings);
        (scene, warnings.iter().map(ToString::to_string).collect())
    }
}

const FILE: &str = "file = \"materials/soap.mtlx\"\nfile_material = \"Soap\"";

#[test]
fn a_document_gives_the_defaults_of_a_material_and_keys_beside_it_change_them() {
    let shop = Shop::new("../maps/bark.hdr");
    let (scene, warnings) =
        shop.load(&format!("{FILE}\nsubsurface_radius_scale = 1\nbase_color = {{ factor = 0.5 }}"));
    let scene = scene.unwrap();
    let material = &scene.materials[scene.objects[0].material];
    assert_eq!((material.name.as_str(), material.subsurface_weight.factor), ("m", 1.0));
    assert_eq!(material.subsurface_radius.factor, 5.0);
    assert_eq!(material.subsurface_radius_scale.factor, glam::Vec3::ONE);
    assert_eq!((material.base_color.texture.unwrap().image, material.base_color.factor.x), (0, 0.5));
    assert!(scene.images[0].path.as_ref().unwrap().ends_with("materials/../maps/bark.hdr"));
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(
        warnings[0].contains("soap.mtlx:6: open_pbr_surface \"SR\", fuzz_weight has no counterpart"),
        "{warnings:?}"
    );
}

#[test]
fn a_document_that_several_materials_name_is_told_of_once() {
    let shop = Shop::new("../maps/bark.hdr");
    let (scene, warnings) = shop.load(&format!("{FILE}\n[[material]]\nname = \"other\"\n{FILE}"));
    let scene = scene.unwrap();
    assert_eq!(scene.materials[0].base_color.texture, scene.materials[1].base_color.texture);
    assert_eq!((scene.images.len(), warnings.len()), (1, 1), "{warnings:?}");
}

#[test]
fn images_of_documents_may_lie_anywhere() {
    let shop = Shop::new("../maps/bark.hdr");
    let absolute = shop.path().join("maps/bark.hdr");
    let other = Shop::new(absolute.to_str().unwrap());
    assert_eq!(other.load(FILE).0.unwrap().images[0].path.as_deref(), Some(absolute.as_path()));
}

#[test]
fn a_text_is_checked_without_its_documents() {
    let text = format!(
        "unit = \"mm\"\n[[material]]\nname = \"m\"\nfile = \"gone.mtlx\"\nbase_color = {{ factor = 2 }}\n{BALL}material = \"m\"\n"
    );
    let file = SceneFile::parse(&text, Path::new("a.toml")).unwrap();
    let error = file.load(&LoadOptions::default(), &mut Vec::new()).unwrap_err().to_string();
    assert_eq!(error, "a.toml:4: the file gone.mtlx does not exist");
}

#[test]
fn mistakes_of_keys_and_files_name_their_place() {
    let shop = Shop::new("../maps/gone.hdr");
    for (lines, part) in [
        ("file = \"materials/soap.mtlx\"", "the document has 2 materials, so file_material must name one"),
        ("file = \"materials/soap.mtlx\"\nfile_material = \"Soapy\"", "did you mean \"Soap\"?"),
        ("file = \"materials\\u0000.mtlx\"", "must be the path of a file"),
        ("file = \"materials\"", "must be the path of a MaterialX document (.mtlx)"),
        ("file = 3", "material[0].file is a number, but must be the path of a file"),
        ("file_material = \"Soap\"", "material[0].file_material is for a material with the key file"),
        ("file_unit = \"cm\"", "material[0].file_unit is for a material with the key file"),
        (
            &format!("{FILE}\nfile_unit = \"inch\""),
            "material[0].file_unit is \"inch\", but must be one of \"mm\", \"cm\", \"m\"",
        ),
        (&format!("{FILE}\npreset = \"wax\""), "preset and file both give all other keys"),
        (&format!("{FILE}\nbase_color = {{ factor = -1 }}"), "must be in [0, 1e6]"),
        (FILE, "soap.mtlx:8: the file"),
    ] {
        let text = format!("unit = \"mm\"\n[[material]]\nname = \"m\"\n{lines}\n{BALL}material = \"m\"\n");
        let file = SceneFile::parse(&text, &shop.path().join("a.toml"));
        let found = file.and_then(|file| file.load(&LoadOptions::default(), &mut Vec::new()));
        let message = found.unwrap_err().to_string();
        assert!(message.contains(part), "{message}\n{part}");
    }
}

#[test]
fn files_that_extend_others_take_documents() {
    let shop = Shop::new("../maps/bark.hdr");
    let base = format!("unit = \"mm\"\n[[material]]\nname = \"m\"\n{BALL}material = \"m\"\n");
    std::fs::write(shop.path().join("base.toml"), base).unwrap();
    let text = format!("extends = \"base.toml\"\n[[material]]\nname = \"m\"\n{FILE}\n");
    let file = SceneFile::parse(&text, &shop.path().join("a.toml")).unwrap();
    let mut warnings = Vec::new();
    let scene = file.load(&LoadOptions::default(), &mut warnings).unwrap();
    assert_eq!((scene.materials[0].name.as_str(), scene.materials[0].subsurface_radius.factor), ("m", 5.0));
    assert_eq!((scene.images.len(), warnings.len()), (1, 1));
}

#[test]
fn pieces_take_documents_where_a_scene_takes_files() {
    let shop = Shop::new("../maps/bark.hdr");
    let document = shop.path().join("materials/soap.mtlx");
    let text = format!("file = {document:?}\nfile_material = \"Soap\"");
    let mut builder = SceneBuilder::new(Unit::Centimeter);
    let mut warnings = Vec::new();
    builder
        .add_material(&Piece::parse("material m", &format!("name = 'm'\n{text}")).unwrap(), &mut warnings)
        .unwrap();
    let soap = builder.scene().materials[0].clone();
    assert_eq!((soap.subsurface_radius.factor, warnings.len()), (0.5, 1));
    let edit = Piece::parse("material m", &text).unwrap();
    let error = edit.material(&soap, Unit::Centimeter).unwrap_err().to_string();
    assert!(error.starts_with("material m: this scene takes no further materials from files"), "{error}");
    let (edited, images) =
        edit.material_with_images(builder.scene(), &Material::default(), &mut warnings).unwrap();
    assert_eq!((edited.base_color.texture.unwrap().image, images.len()), (1, 1));
}

/// The document and the scene of the guide, which lie beside each other.
#[test]
fn example_of_the_guide_loads_with_the_warning_that_it_shows() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/guide/materials.md");
    let page = std::fs::read_to_string(path).unwrap();
    let (_, page) = page.split_once("\n## From MaterialX\n").unwrap();
    let block = |language: &str| {
        let (_, rest) = page.split_once(&format!("```{language}\n")).unwrap();
        rest.split("```").next().unwrap()
    };
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("soap.mtlx"), block("xml")).unwrap();
    let file = SceneFile::parse(block("toml"), &folder.path().join("soap.toml")).unwrap();
    let mut warnings = Vec::new();
    let scene = file.load(&LoadOptions::default(), &mut warnings).unwrap();
    let soap = &scene.materials[0];
    assert_eq!((soap.subsurface_radius.factor, soap.specular_roughness.factor), (4.0, 0.35));
    let [warning] = &warnings[..] else { panic!("{warnings:?}") };
    let shown = warning.to_string().replace(&format!("{}/", folder.path().display()), "");
    assert!(page.contains(&format!("`{shown}`")), "{shown}");
}
