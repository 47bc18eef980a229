//! What a mesh file holds.

use std::path::Path;

use super::gltf::GltfScene;
use crate::{Camera, Image, Light, Material, Mesh, Object};

/// The contents of a mesh file, in its own unit and axes; indices are into the model's own lists.
#[derive(Clone, Debug, Default)]
pub(crate) struct Model {
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
}

impl Model {
    /// A mesh without anything else, named after its file.
    pub(crate) fn from_mesh(path: &Path, mesh: Mesh) -> Self {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let object = Object { name, mesh, material: 0, subsurface_group: 0 };
        Self { objects: vec![object], ..Self::default() }
    }
}

impl From<GltfScene> for Model {
    fn from(scene: GltfScene) -> Self {
        let GltfScene { objects, materials, images, lights, camera, .. } = scene;
        Self { objects, materials, images, lights, camera }
    }
}

/// Multiplies every length of a model by a factor.
pub(crate) fn scale_lengths(model: &mut Model, factor: f32) {
    if factor == 1.0 {
        return;
    }
    for object in &mut model.objects {
        object.mesh.positions.iter_mut().for_each(|position| *position *= factor);
    }
    for material in &mut model.materials {
        material.transmission_depth *= factor;
        material.subsurface_radius.factor *= factor;
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
    let colors = [
        &mut material.base_color,
        &mut material.specular_color,
        &mut material.transmission_color,
        &mut material.subsurface_color,
        &mut material.subsurface_radius_scale,
        &mut material.coat_color,
        &mut material.emission_color,
    ];
    let colors = colors.into_iter().filter_map(|color| color.texture.as_mut());
    let scalars = [
        &mut material.base_metalness,
        &mut material.specular_weight,
        &mut material.specular_roughness,
        &mut material.transmission_weight,
        &mut material.subsurface_weight,
        &mut material.subsurface_radius,
        &mut material.coat_weight,
        &mut material.coat_roughness,
        &mut material.geometry_opacity,
    ];
    let scalars = scalars.into_iter().filter_map(|scalar| scalar.texture.as_mut());
    let normal = material.geometry_normal.as_mut().map(|map| &mut map.texture);
    colors
        .chain(scalars.map(|(texture, _)| texture))
        .chain(normal)
        .for_each(|texture| texture.image += shift);
}
