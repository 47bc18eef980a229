//! Contents of a mesh file, whatever its format.

use std::sync::Arc;

use glam::{Affine3A, Vec3};

use crate::error::nearest;
use crate::{Camera, Image, Light, Material, Object, SceneError};

/// Contents of a mesh file; indices are into its own lists.
#[derive(Clone, Debug, Default)]
pub struct MeshFile {
    /// Surfaces, at least one.
    ///
    /// A glTF file has one for each primitive of each node's mesh, named after the node, else the mesh; those of one
    /// node share a [`subsurface_group`](Object::subsurface_group).
    /// An OBJ file has one for each object (or, without objects, group) and material, named after the object, else the
    /// file; those of one name share a group, so that a change of material does not stop light.
    pub objects: Vec<Object>,
    /// Materials that [`Object::material`] refers to; empty if the file has none at all.
    ///
    /// Among others, a surface without material has the default of its format, in glTF a rough white metal.
    pub materials: Vec<Material>,
    /// Images that the materials refer to.
    pub images: Vec<Image>,
    /// Directional, point and spot lights.
    pub lights: Vec<Light>,
    /// Perspective cameras.
    pub cameras: Vec<NamedCamera>,
}

/// One of several cameras of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NamedCamera {
    /// Name to choose it by; of a camera in a glTF file that of its node, else its own. May be empty.
    pub name: String,
    /// The camera, framed for its own aspect ratio or the default film's.
    pub camera: Camera,
    /// The camera's full vertical field of view in degrees, if that is what the file states: for a film of
    /// aspect ratio a the horizontal one is 2 atan(a tan(v/2)).
    pub vertical_fov: Option<f32>,
}

impl NamedCamera {
    /// The camera of a name, or the first; none if there are none and none is asked for.
    ///
    /// # Errors
    /// There is none of this name: the message lists those that there are.
    pub(crate) fn choose<'a>(all: &'a [Self], name: Option<&str>) -> Result<Option<&'a Self>, SceneError> {
        let Some(name) = name else { return Ok(all.first()) };
        let names = || all.iter().map(|named| named.name.as_str()).filter(|name| !name.is_empty());
        all.iter().find(|named| named.name == name).map(Some).ok_or_else(|| {
            let shown: String = name.chars().take(60).collect();
            let error = SceneError::new(format!("there is no camera \"{shown}\""));
            let list = names().collect::<Vec<_>>().join(", ");
            error.with_help(match nearest(name, names()) {
                Some(near) => format!("did you mean \"{near}\"? The cameras are {list}"),
                None if list.is_empty() => String::from("the file has no camera with a name"),
                None => format!("the cameras are {list}"),
            })
        })
    }

    /// The camera for a picture of an aspect ratio a: a stated vertical field of view v makes the horizontal one
    /// 2 atan(a tan(v/2)).
    pub(crate) fn for_aspect(&self, aspect: f64) -> Camera {
        let Some(vertical) = self.vertical_fov else { return self.camera };
        Camera { horizontal_fov: horizontal_fov(f64::from(vertical).to_radians(), aspect), ..self.camera }
    }
}

/// Horizontal field of view \[degrees\] of a vertical one in radians, for a picture of an aspect ratio.
pub(super) fn horizontal_fov(vertical: f64, aspect: f64) -> f32 {
    let tangent = aspect * (0.5 * vertical).tan();
    (2.0 * tangent.atan()).to_degrees().clamp(1e-3, 179.9) as f32
}

/// Multiplies every length of a model by a factor.
pub(crate) fn scale_lengths(model: &mut MeshFile, factor: f32) {
    if factor == 1.0 {
        return;
    }
    for object in &mut model.objects {
        match Arc::get_mut(&mut object.mesh) {
            Some(mesh) if object.world_from_local == Affine3A::IDENTITY => {
                mesh.positions.iter_mut().for_each(|position| *position *= factor);
            }
            _ => {
                let scale = Affine3A::from_scale(Vec3::splat(factor));
                object.world_from_local = scale * object.world_from_local;
            }
        }
    }
    for material in &mut model.materials {
        material.transmission_depth *= factor;
        material.subsurface_radius.factor *= factor;
        drop(material.clamp());
    }
    for light in &mut model.lights {
        if let Light::Spot { position, intensity, .. } = light {
            *position *= factor;
            // Irradiance is intensity over distance squared.
            *intensity *= factor * factor;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let mut named = NamedCamera { camera, ..NamedCamera::default() };
        assert_eq!(named.for_aspect(2.0), camera);
        named.vertical_fov = Some(40.0);
        assert!((named.for_aspect(1.0).horizontal_fov - 40.0).abs() < 1e-4);
        let wide = f64::from(named.for_aspect(2.0).horizontal_fov).to_radians();
        assert!(((wide / 2.0).tan() - 2.0 * 20f64.to_radians().tan()).abs() < 1e-6);
    }

    #[test]
    fn cameras_are_chosen_by_name_or_are_the_first() {
        let named = |name: &str| NamedCamera { name: name.into(), ..NamedCamera::default() };
        let all = [named("front"), named("ear")];
        let chosen =
            |name: Option<&str>| NamedCamera::choose(&all, name).map(|found| found.unwrap().name.clone());
        assert_eq!(chosen(None).as_deref(), Ok("front"));
        assert_eq!(chosen(Some("ear")).as_deref(), Ok("ear"));
        let error = chosen(Some("eer")).unwrap_err();
        assert_eq!(
            error.to_string(),
            "there is no camera \"eer\" (did you mean \"ear\"? The cameras are front, ear)"
        );
        let error = chosen(Some("something else")).unwrap_err();
        assert_eq!(error.help.as_deref(), Some("the cameras are front, ear"));
        assert_eq!(NamedCamera::choose(&[], None), Ok(None));
        assert!(NamedCamera::choose(&[], Some("a")).is_err());
    }
}
