//! Materials that do not look as their author will have meant them: each kind is one warning.

use std::path::Path;

use translucid_scene::{Material, Object, Place, Scene, Warning};

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
        && material.transmission_color.texture.is_none()
        && material.transmission_color.factor.min_element() >= 1.0
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
    use translucid_scene::{ColorInput, Mesh, ScalarInput, TextureRef};

    use super::*;

    fn told(material: Material, mesh: Mesh) -> String {
        let object = Object { name: "ball".into(), mesh: mesh.into(), ..Object::default() };
        let scene = Scene { objects: vec![object], materials: vec![material], ..Scene::default() };
        let mut warnings = Vec::new();
        warn_of_appearance(&scene, Path::new("a.toml"), &mut warnings);
        warnings.iter().map(ToString::to_string).collect()
    }

    fn textured() -> ColorInput {
        let texture =
            TextureRef { image: 0, image_from_uv: glam::Affine2::IDENTITY, wrap: Default::default() };
        ColorInput { texture: Some(texture), ..ColorInput::constant(Vec3::ONE) }
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
