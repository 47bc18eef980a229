//! Coordinates far from the origin: a scan in a map's coordinates, a character at the end of a street.
//!
//! Single precision has digits for what is near zero. So the points of a scene are counted from an
//! [origin](translucid_scene::Scene::origin) near what is seen, which is subtracted in double precision as they are read.
//! What is near the world's own origin keeps it, and its bits.

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use translucid_scene::{Light, Mesh};

use crate::mesh_file::MeshFile;
use crate::orientation::bounds;

/// Sizes from zero within which a thing is near: rounding errors of coordinates are then below 10⁻⁶ of its size.
const NEAR: f64 = 16.0;

/// The origin for a thing of this size about a point: zero on the axes where it is near that, else a round number near the
/// point.
pub(crate) fn origin_near(point: DVec3, size: f64) -> DVec3 {
    if !(point.is_finite() && size.is_normal()) {
        return DVec3::ZERO;
    }
    // A power of two: the origin has few digits, and differences of coordinates stay exact
    let step = libm::exp2(libm::log2(size).floor() - 4.0);
    let of_axis = |x: f64| if x.abs() <= NEAR * size { 0.0 } else { (x / step).round() * step };
    DVec3::from_array(point.to_array().map(of_axis))
}

/// Positions of a file as they are read, counted from a point near the first of them.
#[derive(Debug, Default)]
pub(crate) struct Anchor(Option<DVec3>);

impl Anchor {
    /// Coordinates below which they are counted from zero: single precision resolves 10⁻⁵ of the file's unit.
    const NEAR: f64 = 128.0;

    /// The anchor of files whose first position is this one.
    pub(crate) fn at(first: DVec3) -> Self {
        let of_axis = |x: f64| if x.abs() < Self::NEAR || !x.is_finite() { 0.0 } else { x.round() };
        Self(Some(DVec3::from_array(first.to_array().map(of_axis))))
    }

    /// The position from the anchor; the first one sets it.
    pub(crate) fn relative(&mut self, position: DVec3) -> Vec3 {
        if self.0.is_none() {
            *self = Self::at(position);
        }
        (position - self.position()).as_vec3()
    }

    /// Where the anchor is.
    pub(crate) fn position(&self) -> DVec3 {
        self.0.unwrap_or_default()
    }
}

/// The mesh in the coordinates of its file.
pub(crate) fn in_file_coordinates(mut mesh: Mesh, origin: DVec3) -> Mesh {
    move_mesh(&mut mesh, origin);
    mesh
}

/// Counts the positions of a mesh from another point.
fn move_mesh(mesh: &mut Mesh, by: DVec3) {
    if by != DVec3::ZERO {
        mesh.positions.iter_mut().for_each(|position| *position = (position.as_dvec3() + by).as_vec3());
    }
}

/// Counts everything in a file from the point that its objects are near, or from its own origin if that is near enough.
pub(crate) fn settle(model: &mut MeshFile) {
    let (low, high) = bounds(&model.objects);
    let (low, high) = (low.as_dvec3(), high.as_dvec3());
    let wanted = origin_near(model.origin + 0.5 * (low + high), 0.5 * (high - low).max_element());
    let by = model.origin - wanted;
    if by == DVec3::ZERO {
        return;
    }
    model.origin = wanted;
    for object in &mut model.objects {
        let is_placed = object.is_placed();
        match Arc::get_mut(&mut object.mesh) {
            Some(mesh) if !is_placed => move_mesh(mesh, by),
            _ => object.world_from_local.translation += glam::Vec3A::from(by.as_vec3()),
        }
    }
    let moved = |point: &mut Vec3| *point = (point.as_dvec3() + by).as_vec3();
    for light in &mut model.lights {
        if let Light::Spot { position, .. } = light {
            moved(position);
        }
    }
    for named in &mut model.cameras {
        moved(&mut named.camera.position);
        moved(&mut named.camera.target);
    }
}

/// The place of a file's objects, whose own coordinates are counted from an origin.
pub(crate) fn place_of_file(place: &DAffine3, origin: DVec3) -> DAffine3 {
    DAffine3 { translation: place.transform_point3(origin), ..*place }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn things_near_the_origin_keep_it() {
        for (point, size) in [(DVec3::new(15.0, -3.0, 0.0), 1.0), (DVec3::splat(1e9), 1e8), (DVec3::NAN, 1.0)]
        {
            assert_eq!(origin_near(point, size), DVec3::ZERO);
        }
        assert_eq!(origin_near(DVec3::splat(1e9), 0.0), DVec3::ZERO);
    }

    #[test]
    fn origins_of_far_things_are_near_them() {
        for size in [1e-3, 0.7, 5.0, 1e4] {
            let point = DVec3::new(512_344.987, 3.0 * size, -4_634_567.075) * size;
            let origin = origin_near(point, size);
            assert_eq!(origin.y, if point.y.abs() > 16.0 * size { origin.y } else { 0.0 });
            assert!((point - origin).with_y(0.0).abs().max_element() <= size / 32.0, "{size}: {origin}");
        }
    }

    #[test]
    fn anchored_positions_keep_their_digits() {
        let first = DVec3::new(512_344.987_134, 4_634_567.925_325, 231.0);
        let mut anchor = Anchor::default();
        for shift in [DVec3::ZERO, DVec3::new(0.001, 0.002, -0.003)] {
            let back = anchor.relative(first + shift).as_dvec3() + anchor.position();
            assert!((back - first - shift).abs().max_element() < 1e-5, "{back}");
        }
        let mut near = Anchor::default();
        assert_eq!((near.relative(DVec3::splat(100.1)), near.position()), (Vec3::splat(100.1), DVec3::ZERO));
    }
}
