//! Picking: the object that a pixel shows.

use std::sync::Arc;

use glam::Vec3;

use super::view::View;
use crate::ray::Geometry;

/// Finds the objects that pixels of a view show, while the scene is rendered and edited elsewhere.
#[derive(Clone)]
pub struct Picker {
    geometry: Arc<Geometry>,
}

/// The first surface behind a point of the film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Picked {
    /// Index of the object.
    pub object: usize,
    /// Point on its surface, in world space \[L\].
    pub position: Vec3,
    /// Distance from the camera \[L\].
    pub distance: f32,
}

impl Picker {
    pub(super) fn new(geometry: Arc<Geometry>) -> Self {
        Self { geometry }
    }

    /// The first surface behind a point of the film, in pixels of the whole film from its upper left; `None` where there is
    /// none, or a coordinate is not finite.
    ///
    /// It is the surface in focus through the middle of the lens; how opaque it is does not matter.
    pub fn pick(&self, view: &View, point: [f32; 2]) -> Option<Picked> {
        if !point.iter().all(|x| x.is_finite()) {
            return None;
        }
        let ray = view.ray_through(point);
        let hit = self.geometry.closest(&ray)?;
        let position = ray.origin + ray.direction * hit.t;
        Some(Picked { object: self.geometry.object(&hit) as usize, position, distance: hit.t })
    }

    /// Corners of the box around everything.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        self.geometry.bounds()
    }
}

#[cfg(test)]
mod tests {
    use glam::{Affine3A, Vec3};
    use translucid_scene::{Camera, Material, Object, Projection, Scene};
    use translucid_shapes::{ShapeParameters, build_shape};

    use crate::PreparedScene;

    /// A ball on a table, seen from aside.
    fn table() -> Scene {
        let object = |name: &str, shape: &str, parameters: ShapeParameters, y: f32| Object {
            name: name.into(),
            mesh: build_shape(shape, &parameters)
                .unwrap()
                .transformed(&Affine3A::from_translation(Vec3::Y * y))
                .into(),
            ..Object::default()
        };
        let wide = ShapeParameters::new().with("width", 100.0).with("depth", 100.0);
        Scene {
            camera: Camera {
                position: Vec3::new(2.0, 9.0, 7.0),
                target: Vec3::new(0.2, 0.5, 0.0),
                projection: Projection::Perspective { horizontal_fov: 35.0 },
                ..Camera::default()
            },
            objects: vec![
                object("ball", "sphere", ShapeParameters::new(), 1.0),
                object("table", "box", wide.with("height", 2.0), -1.0),
            ],
            materials: vec![Material::default()],
            ..Scene::default()
        }
    }

    #[test]
    fn picked_points_are_where_their_pixels_are() {
        let prepared = PreparedScene::new(table()).unwrap();
        let view = prepared.view().unwrap();
        let picker = prepared.picker();
        let mut names = Vec::new();
        for point in [[480.0, 270.0], [250.5, 320.25], [630.0, 150.0], [20.0, 530.0]] {
            let picked = picker.pick(&view, point).unwrap();
            let camera = *view.camera();
            assert!((picked.position.distance(camera.position) / picked.distance - 1.0).abs() < 1e-5);

            // Back into the picture by the definition of the field of view
            let forward = (camera.target - camera.position).normalize();
            let right = forward.cross(camera.up).normalize();
            let offset = picked.position - camera.position;
            let scale = 960.0 / camera.projection.width_at(offset.dot(forward).into()) as f32;
            let [x, y] = [offset.dot(right), -offset.dot(right.cross(forward))].map(|at| at * scale);
            assert!((x + 480.0 - point[0]).abs() < 0.05 && (y + 270.0 - point[1]).abs() < 0.05, "{x} {y}");
            names.push(prepared.scene().objects[picked.object].name.clone());
        }
        assert!(["ball", "table"].iter().all(|name| names.contains(&String::from(*name))), "{names:?}");
        for odd in [[f32::NAN, 0.0], [f32::INFINITY, 1.0]] {
            assert_eq!(picker.pick(&view, odd), None);
        }
    }
}
