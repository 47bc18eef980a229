//! Contents of a mesh file, whatever its format.

use std::collections::HashMap;
use std::path::Path;

use super::gltf::GltfScene;
use super::obj::{ObjPart, ObjScene};
use crate::{Camera, Image, Light, Material, Mesh, Object};

/// The contents of a mesh file, in its own unit and axes; indices are into the model's own lists.
#[derive(Clone, Debug, Default)]
pub(crate) struct MeshFile {
    /// Meshes with their material; the index counts only where `materials` is not empty.
    pub(crate) objects: Vec<Object>,
    /// The file's materials; empty if it has none.
    pub(crate) materials: Vec<Material>,
    /// Images that the materials refer to.
    pub(crate) images: Vec<Image>,
    /// The file's lights.
    pub(crate) lights: Vec<Light>,
    /// The file's first camera.
    pub(crate) camera: Option<Camera>,
    /// Its full vertical field of view in degrees, if that is what the file states.
    pub(crate) vertical_fov: Option<f32>,
}

impl MeshFile {
    /// A mesh without anything else, named after its file.
    pub(crate) fn from_mesh(path: &Path, mesh: Mesh) -> Self {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let object = Object { name, mesh, material: 0, subsurface_group: 0 };
        Self { objects: vec![object], ..Self::default() }
    }

    /// An OBJ file's parts; those without a material get a default one if others have one, and those of
    /// one name share subsurface scattering, so that a change of material does not stop it.
    pub(crate) fn from_obj(path: &Path, scene: ObjScene) -> Self {
        let ObjScene { parts, mut materials, images } = scene;
        let plain = materials.len();
        if plain > 0 && parts.iter().any(|part| part.material.is_none()) {
            materials.push(Material::default());
        }
        let mut groups: HashMap<String, u32> = HashMap::new();
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let mut object = |part: ObjPart| {
            // A file's parts are far fewer than 2³².
            let next = groups.len() as u32;
            let subsurface_group = *groups.entry(part.name.clone()).or_insert(next);
            let name = if part.name.is_empty() { stem.clone() } else { part.name };
            Object { name, mesh: part.mesh, material: part.material.unwrap_or(plain), subsurface_group }
        };
        let objects = parts.into_iter().map(&mut object).collect();
        Self { objects, materials, images, ..Self::default() }
    }

    /// The file's camera for a picture of an aspect ratio a: a stated vertical field of view v makes the
    /// horizontal one 2 atan(a tan(v/2)).
    pub(crate) fn camera_for(&self, aspect: f64) -> Option<Camera> {
        let camera = self.camera?;
        let Some(vertical) = self.vertical_fov else { return Some(camera) };
        let tangent = aspect * (0.5 * f64::from(vertical).to_radians()).tan();
        let horizontal_fov = (2.0 * tangent.atan()).to_degrees().clamp(1e-3, 179.9) as f32;
        Some(Camera { horizontal_fov, ..camera })
    }
}

impl From<GltfScene> for MeshFile {
    fn from(scene: GltfScene) -> Self {
        let GltfScene { objects, materials, images, lights, camera, vertical_fov } = scene;
        Self { objects, materials, images, lights, camera, vertical_fov }
    }
}

/// Multiplies every length of a model by a factor.
pub(crate) fn scale_lengths(model: &mut MeshFile, factor: f32) {
    if factor == 1.0 {
        return;
    }
    for object in &mut model.objects {
        object.mesh.positions.iter_mut().for_each(|position| *position *= factor);
    }
    for material in &mut model.materials {
        material.transmission_depth *= factor;
        material.subsurface_radius.factor *= factor;
        material.clamp();
    }
    for light in &mut model.lights {
        if let Light::Spot { position, intensity, .. } = light {
            *position *= factor;
            // Irradiance is intensity over distance squared.
            *intensity *= factor * factor;
        }
    }
}

/// Adds `shift` to the index of every image that a material refers to.
pub(crate) fn shift_images(material: &mut Material, shift: usize) {
    material.for_each_texture(|texture| texture.image += shift);
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn model_of_an_obj_groups_parts_by_name_and_gives_every_part_a_material() {
        let part = |name: &str, material| ObjPart { name: name.to_owned(), mesh: Mesh::default(), material };
        let parts = vec![part("a", Some(0)), part("", None), part("a", None)];
        let scene = ObjScene { parts, materials: vec![Material::default()], images: Vec::new() };
        let model = MeshFile::from_obj(Path::new("folder/file.obj"), scene);
        let objects: Vec<_> =
            model.objects.iter().map(|o| (o.name.as_str(), o.material, o.subsurface_group)).collect();
        assert_eq!(objects, [("a", 0, 0), ("file", 1, 1), ("a", 1, 0)]);
        assert_eq!(model.materials.len(), 2);
    }

    #[test]
    fn camera_for_a_square_picture_sees_as_wide_as_high() {
        let camera = Camera {
            position: Vec3::ZERO,
            target: Vec3::Z,
            up: Vec3::Y,
            horizontal_fov: 60.0,
            lens_radius: 0.0,
            focus_distance: 1.0,
        };
        let mut model = MeshFile { camera: Some(camera), ..MeshFile::default() };
        assert_eq!(model.camera_for(2.0), Some(camera));
        model.vertical_fov = Some(40.0);
        assert!((model.camera_for(1.0).unwrap().horizontal_fov - 40.0).abs() < 1e-4);
        let wide = f64::from(model.camera_for(2.0).unwrap().horizontal_fov).to_radians();
        assert!(((wide / 2.0).tan() - 2.0 * 20f64.to_radians().tan()).abs() < 1e-6);
    }
}
