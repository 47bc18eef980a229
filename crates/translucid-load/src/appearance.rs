//! Materials that do not look as their author will have meant them: each kind is one warning.

use std::path::Path;

use translucid_scene::{Image, Material, Object, Place, Scene, Warning};

use crate::mesh_file::MeshFile;
use crate::model::is_gltf;

/// Factor on a picture up to which it is told of.
const DARK: f32 = 0.5;

/// Warns of objects that cannot be seen, and of pictures on meshes without texture coordinates.
pub(super) fn warn_of_appearance(scene: &Scene, path: &Path, warnings: &mut Vec<Warning>) {
    let of_objects = |is_meant: &dyn Fn(&Object, &Material) -> bool| -> Vec<&str> {
        let is_meant = |object: &&Object| {
            scene.materials.get(object.material).is_some_and(|material| is_meant(object, material))
        };
        scene.objects.iter().filter(is_meant).map(|object| object.name.as_str()).collect()
    };
    let mut warn = |names: &[&str], [of_one, of_many]: [&str; 2], rest: &str| {
        let message = match names {
            [] => return,
            [name] => format!("object \"{name}\" {of_one} {rest}"),
            [name, ..] => format!("{} objects, \"{name}\" and others, {of_many} {rest}", names.len()),
        };
        warnings.push(Warning { message, place: Some(Place::file(path)) });
    };
    let hidden = of_objects(&|_, material| is_absent(material));
    warn(&hidden, ["cannot", "cannot"], "be seen: the opacity of the material is 0");
    let clear = of_objects(&|_, material| !is_absent(material) && is_clear(material));
    warn(&clear, ["cannot", "cannot"], "be seen: the material is clear, and its index of refraction is 1");
    // The reader of glTF names the set of coordinates
    let has_pictures: Vec<bool> = scene.materials.iter().map(has_pictures).collect();
    let bare = of_objects(&|object, _| object.mesh.uvs.is_empty() && has_pictures[object.material]);
    if !is_gltf(path) {
        let rest = "material with pictures, but no texture coordinates: all of a picture is one color there";
        warn(&bare, ["has a", "have a"], rest);
    }
}

/// Warns of an environment's image that is not twice as wide as high, which a whole panorama is.
pub fn warn_of_panorama(image: &Image, warnings: &mut Vec<Warning>) {
    let [width, height] = [image.width, image.height];
    // Others round edges
    if (f64::from(width) - 2.0 * f64::from(height)).abs() <= 0.01 * f64::from(width) + 1.0 {
        return;
    }
    let message = format!(
        "the environment has {width} x {height} pixels, but a panorama is twice as wide as high: it is stretched over all \
         directions"
    );
    warnings.push(Warning { message, place: image.path.as_deref().map(Place::file) });
}

/// Whether there is nothing of a surface.
fn is_absent(material: &Material) -> bool {
    material.geometry_opacity.factor == 0.0
}

/// Whether light goes through a surface as if there were nothing.
fn is_clear(material: &Material) -> bool {
    let clear = &material.transmission_weight;
    clear.factor >= 1.0
        && clear.texture.is_none()
        && (material.specular_ior == 1.0 || material.specular_weight.factor == 0.0)
        && material.base_metalness.factor == 0.0
        && material.coat_weight.factor == 0.0
        && material.emission_luminance == 0.0
        && [&material.transmission_color, &material.transmission_tint]
            .iter()
            .all(|color| color.texture.is_none() && color.factor.min_element() >= 1.0)
}

fn has_pictures(material: &Material) -> bool {
    let mut found = false;
    material.clone().for_each_image(|_| found = true);
    found
}

/// Warns of a mesh file's materials that darken their pictures: some programs write a default color beside each.
pub(super) fn warn_of_darkened(model: &MeshFile, path: &Path, warnings: &mut Vec<Warning>) {
    let factor = |material: &Material| material.base_color.factor.max_element();
    let is_dark = |material: &&Material| {
        material.base_color.texture.is_some() && factor(material) > 0.0 && factor(material) <= DARK
    };
    let dark: Vec<&Material> = model.materials.iter().filter(is_dark).collect();
    let Some(&first) = dark.first() else { return };
    let which = match dark.len() {
        1 => format!("material \"{}\" multiplies its picture", first.name),
        count => format!("{count} materials, \"{}\" and others, multiply their pictures", first.name),
    };
    let metal = match first.base_metalness.factor >= 1.0 && first.base_metalness.texture.is_none() {
        true => ", and is a metal",
        false => "",
    };
    let message = format!("{which} by {}{metal}, as the file says: is that meant?", factor(first));
    warnings.push(Warning { message, place: Some(Place::file(path)) });
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use translucid_scene::{ColorInput, ColorSpace, Mesh, Pixels, ScalarInput, TextureRef};

    use super::*;

    fn told(material: Material, mesh: Mesh) -> String {
        let object = Object { name: "ball".into(), mesh: mesh.into(), ..Object::default() };
        let scene = Scene { objects: vec![object], materials: vec![material], ..Scene::default() };
        let mut warnings = Vec::new();
        warn_of_appearance(&scene, Path::new("a.toml"), &mut warnings);
        warnings.iter().map(ToString::to_string).collect()
    }

    fn textured() -> ColorInput {
        ColorInput { texture: Some(TextureRef::new(0)), ..ColorInput::constant(Vec3::ONE) }
    }

    #[test]
    fn panoramas_that_are_not_twice_as_wide_as_high_are_told_of() {
        let told = |width: u32, height: u32| {
            let pixels = Pixels::Byte(vec![[0; 4]; (width * height) as usize]);
            let color_space = ColorSpace::Srgb;
            let mut warnings = Vec::new();
            let image = Image { name: "a".into(), path: None, width, height, color_space, pixels };
            warn_of_panorama(&image, &mut warnings);
            warnings.iter().map(ToString::to_string).collect::<String>()
        };
        for [width, height] in [[64, 32], [2, 1], [65, 32], [400, 201]] {
            assert_eq!(told(width, height), "", "{width} x {height}");
        }
        for [width, height] in [[64, 64], [60, 40], [300, 100], [32, 64]] {
            assert!(
                told(width, height).contains(&format!("has {width} x {height} pixels")),
                "{width} x {height}"
            );
        }
    }

    #[test]
    fn objects_that_cannot_be_seen_are_told_of() {
        let hidden = Material { geometry_opacity: ScalarInput::constant(0.0), ..Material::default() };
        assert!(
            told(hidden, Mesh::default()).starts_with("a.toml: object \"ball\" cannot be seen: the opacity")
        );
        let glass = Material { transmission_weight: ScalarInput::constant(1.0), ..Material::default() };
        assert_eq!(told(glass.clone(), Mesh::default()), "");
        let air = Material { specular_ior: 1.0, ..glass };
        assert!(told(air.clone(), Mesh::default()).contains("its index of refraction is 1"));
        let filter = Material { transmission_color: ColorInput::constant(Vec3::splat(0.5)), ..air };
        assert_eq!(told(filter, Mesh::default()), "");
    }

    #[test]
    fn pictures_on_meshes_without_coordinates_are_told_of() {
        let material = Material { subsurface_color: textured(), ..Material::default() };
        let expected = "a.toml: object \"ball\" has a material with pictures, but no texture coordinates: \
                        all of a picture is one color there";
        assert_eq!(told(material.clone(), Mesh::default()), expected);
        let mesh = Mesh { uvs: vec![glam::Vec2::ZERO], ..Mesh::default() };
        assert_eq!(told(material, mesh), "");
    }

    #[test]
    fn pictures_that_a_factor_darkens_are_told_of_once() {
        let dark = Material {
            name: "m".into(),
            base_color: ColorInput { factor: Vec3::splat(0.4), ..textured() },
            ..Material::default()
        };
        let mut warnings = Vec::new();
        let model = MeshFile { materials: vec![dark; 2], ..MeshFile::default() };
        warn_of_darkened(&model, Path::new("a.obj"), &mut warnings);
        let lines: Vec<_> = warnings.iter().map(ToString::to_string).collect();
        assert_eq!(
            lines,
            [
                "a.obj: 2 materials, \"m\" and others, multiply their pictures by 0.4, as the file says: is that meant?"
            ]
        );
    }
}
