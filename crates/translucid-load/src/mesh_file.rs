//! Contents of a mesh file, whatever its format.

use std::sync::Arc;

use crate::result::Result;

use glam::{Affine3A, DVec3, Vec3};
use translucid_profile::nearest;
use translucid_scene::{Camera, Image, Interval, Light, Material, Object, Projection, SceneError};

/// Contents of a mesh file; indices are into its own lists.
#[derive(Clone, Debug, Default)]
pub struct MeshFile {
    /// The point of the file from which all positions below are counted \[L\]; zero where the objects are not far from the
    /// file's own origin.
    pub origin: DVec3,
    /// Surfaces, at least one.
    ///
    /// A glTF file has one for each primitive of each node's mesh, named after the node, else the mesh; those of one
    /// node share a [`subsurface_group`](Object::subsurface_group).
    /// An OBJ file has one for each object (or, without objects, group) and material, named after the object, else the
    /// file; those of one name share a subsurface group, so that a change of material does not stop light, and so do
    /// groups of one surface.
    pub objects: Vec<Object>,
    /// Materials that [`Object::material`] refers to; empty if the file has none at all.
    ///
    /// Among others, a surface without material has the default of its format, in glTF a rough white metal.
    pub materials: Vec<Material>,
    /// Images that the materials refer to.
    pub images: Vec<Image>,
    /// Directional, point and spot lights.
    pub lights: Vec<Light>,
    /// Cameras.
    pub cameras: Vec<NamedCamera>,
}

/// One of several cameras of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NamedCamera {
    /// Name to choose it by; of a camera in a glTF file that of its node, else its own. May be empty.
    pub name: String,
    /// The camera, framed for its own aspect ratio or the default film's.
    pub camera: Camera,
    /// The projection for a square picture, if the file states the height of what is seen: for a film of aspect ratio a
    /// the picture is a times as wide.
    pub of_square: Option<Projection>,
}

impl NamedCamera {
    /// The camera of a name, or the first; none if there are none and none is asked for.
    ///
    /// # Errors
    /// There is none of this name: the message lists those that there are.
    pub(crate) fn choose<'a>(all: &'a [Self], name: Option<&str>) -> Result<Option<&'a Self>> {
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

    /// The camera for a picture of an aspect ratio, which shows as much in height.
    pub(crate) fn for_aspect(&self, aspect: f64) -> Camera {
        let Some(of_square) = self.of_square else { return self.camera };
        Camera { projection: for_aspect(of_square, aspect), ..self.camera }
    }
}

/// A square picture's projection for a picture of an aspect ratio that shows as much in height.
pub(super) fn for_aspect(of_square: Projection, aspect: f64) -> Projection {
    match of_square.widened(aspect) {
        Projection::Perspective { horizontal_fov } => {
            Projection::Perspective { horizontal_fov: horizontal_fov.clamp(1e-3, 179.9) }
        }
        Projection::Orthographic { width } => {
            Projection::Orthographic { width: Interval::REACH.nearest(width) }
        }
    }
}

/// Multiplies every length of a model by a factor.
pub(crate) fn scale_lengths(model: &mut MeshFile, factor: f32) {
    if factor == 1.0 {
        return;
    }
    model.origin *= f64::from(factor);
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
        if let Light::Spot { position, radius, intensity, .. } = light {
            *position *= factor;
            *radius *= factor;
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
            projection: Projection::Perspective { horizontal_fov: 60.0 },
            focus_distance: 1.0,
            ..Camera::default()
        };
        let mut named = NamedCamera { camera, ..NamedCamera::default() };
        assert_eq!(named.for_aspect(2.0), camera);
        named.of_square = Some(Projection::Perspective { horizontal_fov: 40.0 });
        let width = |aspect: f64| named.for_aspect(aspect).projection.width_at(0.5);
        assert!((width(1.0) - 20f64.to_radians().tan()).abs() < 1e-6);
        assert!((width(2.0) - 2.0 * 20f64.to_radians().tan()).abs() < 1e-6);
        named.of_square = Some(Projection::Orthographic { width: 3.0 });
        assert_eq!(named.for_aspect(2.0).projection, Projection::Orthographic { width: 6.0 });
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
