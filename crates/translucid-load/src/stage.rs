//! Camera, lights and backdrop for meshes that come without.

use glam::{DVec3, Vec3};
use translucid_scene::{
    Camera, ColorInput, Environment, Light, Material, Mesh, Object, Projection, ScalarInput,
};

use super::orientation::bounds;
use crate::Viewpoint;

/// Share of the frame's width or height that the mesh fills, whichever it meets first.
const FILL: f64 = 0.75;

/// Horizontal field of view of the automatic camera [degrees]: a short telephoto lens.
const FIELD_OF_VIEW: f64 = 30.0;

/// Farthest that the automatic camera stands from the meshes \[L\]: within the places that a camera may have.
const FARTHEST: f64 = 7e9;

/// Most vertices that the fit looks at; more say nothing new about a silhouette.
const MOST_VERTICES: usize = 200_000;

/// Place of the meshes and the view of them: everything below is placed relative to it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stage {
    /// Middle of the bounding box [L].
    center: DVec3,
    /// Half the box's diagonal [L], > 0.
    radius: f64,
    /// Lowest y [L].
    bottom: f64,
    /// Where the camera is.
    viewpoint: Viewpoint,
    /// Whether the meshes will turn about the vertical line through their middle.
    is_turntable: bool,
}

impl Stage {
    /// The frame of all objects together.
    pub(crate) fn of(objects: &[Object]) -> Self {
        let (low, high) = bounds(objects);
        let (low, high) = (low.as_dvec3(), high.as_dvec3());
        let center = 0.5 * (low + high);
        // Far from the origin, a camera nearer than this could not move in single precision.
        let least = 1e-4 * center.abs().max_element() + 1e-12;
        let radius = (0.5 * (high - low).length()).max(least);
        Self { center, radius, bottom: low.y, viewpoint: usual_viewpoint(high - low), is_turntable: false }
    }

    /// The frame seen from another side, if one is given.
    pub(crate) fn seen_from(self, viewpoint: Option<Viewpoint>) -> Self {
        Self { viewpoint: viewpoint.unwrap_or(self.viewpoint), ..self }
    }

    /// The frame seen from where a camera is, if there is one.
    pub(crate) fn seen_by(self, camera: Option<&Camera>) -> Self {
        let direction = |camera: &Camera| camera.position.as_dvec3() - self.center;
        self.seen_from(camera.map(|camera| Viewpoint::toward(direction(camera))))
    }

    /// The frame of meshes that may turn.
    pub(crate) fn turning(self, is_turntable: bool) -> Self {
        Self { is_turntable, ..self }
    }

    /// Middle of the meshes.
    pub(crate) fn center(&self) -> DVec3 {
        self.center
    }

    /// Whether a camera is above the floor of the [`backdrop`](Self::backdrop).
    pub(crate) fn is_above_floor(&self, camera: &Camera) -> bool {
        f64::from(camera.position.y) > self.floor()
    }

    /// Height of the backdrop's floor, a little below the meshes.
    fn floor(&self) -> f64 {
        self.bottom - 2e-3 * self.radius
    }

    /// A camera from which the meshes fill most of an image of the given width over height.
    pub(crate) fn camera(&self, objects: &[Object], aspect: f64) -> Camera {
        let tangent = libm::tan((0.5 * FIELD_OF_VIEW).to_radians());
        let view = View::from(self.viewpoint, [tangent, tangent / aspect]);
        let points = silhouette(objects).map(|p| (p.as_dvec3() - self.center) / self.radius);
        let points: Vec<DVec3> = if self.is_turntable {
            points.flat_map(ring).map(|p| view.coordinates(p)).collect()
        } else {
            points.map(|p| view.coordinates(p)).collect()
        };
        let (target, distance) = view.fit(&points);
        let distance = distance.min(FARTHEST / self.radius);
        let target = self.center + self.radius * view.world(target);
        let position = target + self.radius * distance * self.viewpoint.direction();
        Camera {
            position: position.as_vec3(),
            target: target.as_vec3(),
            up: self.viewpoint.up().as_vec3(),
            projection: Projection::Perspective { horizontal_fov: FIELD_OF_VIEW as f32 },
            focus_distance: (self.radius * distance) as f32,
            ..Camera::default()
        }
    }

    /// A soft key from the upper left and a strong rim from behind on the right, which shines through.
    ///
    /// The rim is a sphere: a rectangle behind the meshes would leave the backdrop behind its own plane
    /// dark, with an edge across the picture.
    pub(crate) fn lights(&self) -> Vec<Light> {
        let (key, toward_key) = self.place(-58.0, 40.0, 4.0);
        let across = DVec3::Y.cross(-toward_key).normalize_or(DVec3::X);
        let size = 3.2 * self.radius;
        let (rim, _) = self.place(146.0, 42.0, 5.0);
        vec![
            Light::Rectangle {
                center: key.as_vec3(),
                edge_x: (size * across).as_vec3(),
                edge_y: (size * (-toward_key).cross(across)).as_vec3(),
                radiance: Vec3::new(6.6, 6.4, 6.1),
                visible: false,
            },
            Light::Sphere {
                center: rim.as_vec3(),
                radius: (1.1 * self.radius) as f32,
                radiance: Vec3::new(92.0, 87.0, 79.0),
                visible: false,
            },
        ]
    }

    /// Dim light from all around, so that no shadow is black.
    pub(crate) fn environment(&self) -> Environment {
        Environment { radiance: Vec3::new(0.16, 0.17, 0.19), ..Environment::default() }
    }

    /// Color of the backdrop where none is asked for: dark and neutral.
    pub(crate) const BACKDROP_COLOR: Vec3 = Vec3::splat(0.085);

    /// A floor a little below the meshes, as a sweep with a curve up to a wall behind them, so wide
    /// that the rim light fades over it without an edge.
    pub(crate) fn backdrop(&self, color: Vec3, shape: BackdropShape) -> (Mesh, Material) {
        let material = Material {
            name: String::from("backdrop"),
            base_color: ColorInput::constant(color),
            specular_weight: ScalarInput::constant(0.0),
            ..Material::default()
        };
        (self.backdrop_mesh(shape), material)
    }

    /// A point about the meshes, and the unit direction to it from their middle.
    ///
    /// `azimuth` is about y from the camera, positive to its right, `elevation` above the horizon, both in
    /// degrees; `distance` is in the frame's radius.
    fn place(&self, azimuth: f64, elevation: f64, distance: f64) -> (DVec3, DVec3) {
        let horizontal = self.viewpoint.horizontal();
        let right = DVec3::Y.cross(horizontal);
        let (sine, cosine) = libm::sincos(azimuth.to_radians());
        let (height, reach) = libm::sincos(elevation.to_radians());
        let outward = reach * (cosine * horizontal + sine * right) + height * DVec3::Y;
        (self.center + distance * self.radius * outward, outward)
    }

    /// A strip across the view.
    fn backdrop_mesh(&self, shape: BackdropShape) -> Mesh {
        const WIDTH: f64 = 40.0;
        let back = -self.viewpoint.horizontal();
        let across = back.cross(DVec3::Y);
        let origin = DVec3::new(self.center.x, self.floor(), self.center.z);
        let mut mesh = Mesh::default();
        for (point, normal) in backdrop_profile(shape) {
            for side in [-WIDTH, WIDTH] {
                let position = across * side + back * point[0] + DVec3::Y * point[1];
                mesh.positions.push((origin + self.radius * position).as_vec3());
                mesh.normals.push((back * normal[0] + DVec3::Y * normal[1]).as_vec3());
            }
        }
        let strips = (mesh.positions.len() / 2 - 1) as u32;
        for i in (0..strips).map(|i| 2 * i) {
            mesh.triangles.extend([[i, i + 1, i + 3], [i, i + 3, i + 2]]);
        }
        mesh
    }
}

/// The profile of what is below and behind the meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BackdropShape {
    /// Floor, quarter circle, wall.
    Sweep,
    /// Floor alone: no shadow falls on a wall that is not there.
    Flat,
}

/// Points (distance behind the center, height) and normals of the backdrop, from before the camera
/// to the top of the wall, in the frame's radius.
fn backdrop_profile(shape: BackdropShape) -> Vec<([f64; 2], [f64; 2])> {
    const STEPS: i32 = 32;
    const FRONT: f64 = -60.0;
    /// Where the floor begins to rise.
    const START: f64 = 3.0;
    /// Radius of the curve.
    const BEND: f64 = 9.0;
    const TOP: f64 = 60.0;
    let mut profile = vec![([FRONT, 0.0], [0.0, 1.0])];
    if shape == BackdropShape::Flat {
        profile.push(([TOP, 0.0], [0.0, 1.0]));
        return profile;
    }
    for step in 0..=STEPS {
        let (sine, cosine) = libm::sincos(std::f64::consts::FRAC_PI_2 * f64::from(step) / f64::from(STEPS));
        profile.push(([START + BEND * sine, BEND - BEND * cosine], [-sine, cosine]));
    }
    profile.push(([START + BEND, TOP], [-1.0, 0.0]));
    profile
}

/// Three-quarter view from the front (+z), a little above; turned to the broad side of what is thin
/// along z and raised over what lies flat.
fn usual_viewpoint(extent: DVec3) -> Viewpoint {
    let azimuth = if extent.x < 0.4 * extent.z { 65.0 } else { 25.0 };
    let elevation = if extent.y < 0.15 * extent.x.max(extent.z) { 40.0 } else { 12.0 };
    Viewpoint::of(azimuth, elevation)
}

/// Points all around the y axis where a point comes by that turns about it.
fn ring(p: DVec3) -> impl Iterator<Item = DVec3> {
    const STEPS: u8 = 24;
    let radius = libm::hypot(p.x, p.z);
    (0..STEPS).map(move |step| {
        let (sine, cosine) = libm::sincos(std::f64::consts::TAU * f64::from(step) / f64::from(STEPS));
        DVec3::new(radius * sine, p.y, radius * cosine)
    })
}

fn silhouette(objects: &[Object]) -> impl Iterator<Item = Vec3> {
    let vertices: usize = objects.iter().map(|object| object.mesh.positions.len()).sum();
    let step = vertices.div_ceil(MOST_VERTICES).max(1);
    // From object to object, not from vertex to vertex: shared meshes may add up to billions
    let mut next = 0;
    objects.iter().flat_map(move |object| {
        let count = object.mesh.positions.len();
        let first = next;
        next = first + count.saturating_sub(first).div_ceil(step) * step - count;
        (first..count).step_by(step).map(|vertex| object.position(vertex as u32))
    })
}

/// A viewing direction with the frame's half extents at distance 1.
struct View {
    right: DVec3,
    up: DVec3,
    backward: DVec3,
    tangents: [f64; 2],
}

impl View {
    fn from(viewpoint: Viewpoint, tangents: [f64; 2]) -> Self {
        let backward = viewpoint.direction();
        let right = viewpoint.up().cross(backward).normalize_or(DVec3::X);
        Self { right, up: backward.cross(right), backward, tangents }
    }

    fn coordinates(&self, p: DVec3) -> DVec3 {
        DVec3::new(self.right.dot(p), self.up.dot(p), self.backward.dot(p))
    }

    fn world(&self, p: DVec3) -> DVec3 {
        self.right * p.x + self.up * p.y + self.backward * p.z
    }

    /// Target and distance at which the points fill [`FILL`] of the frame and lie in its middle.
    ///
    /// A point is within the frame's share when |x| ≤ FILL tan (distance − z): on each axis the two
    /// extreme values of z ± x / (FILL tan) give the distance and the shift that balances both sides.
    fn fit(&self, points: &[DVec3]) -> (DVec3, f64) {
        let [tan_x, tan_y] = self.tangents.map(|tangent| FILL * tangent);
        let highest = |slope: &dyn Fn(&DVec3) -> f64| points.iter().map(slope).fold(-10.0, f64::max);
        let (right, left) = (highest(&|p| p.z + p.x / tan_x), highest(&|p| p.z - p.x / tan_x));
        let (top, bottom) = (highest(&|p| p.z + p.y / tan_y), highest(&|p| p.z - p.y / tan_y));
        let shift = DVec3::new(0.5 * (right - left) * tan_x, 0.5 * (top - bottom) * tan_y, 0.0);
        let nearest = highest(&|p| p.z);
        // Half the radius stays between the lens and the nearest point, whatever the frame's shape.
        (shift, (0.5 * (right + left)).max(0.5 * (top + bottom)).max(nearest + 0.5))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn object(positions: Vec<Vec3>) -> Object {
        let triangles = (0..positions.len() as u32 - 2).map(|i| [i, i + 1, i + 2]).collect();
        let mesh = Mesh { positions, triangles, ..Mesh::default() };
        Object {
            name: String::new(),
            mesh: mesh.into(),
            material: 0,
            subsurface_group: 0,
            ..Object::default()
        }
    }

    /// Points of a lopsided blob, scaled and moved.
    fn blob(scale: f32, offset: Vec3) -> Object {
        let point = |i: i32| {
            let t = i as f32 * 0.37;
            Vec3::new(1.6 * t.sin(), 0.9 * (1.7 * t).cos() + 0.2 * t.sin(), 0.7 * (2.3 * t).sin().max(-0.5))
        };
        object((0..200).map(|i| offset + scale * point(i)).collect())
    }

    /// Lowest and highest image coordinates of an object, ±1 at the frame's edges.
    fn extent(object: &Object, camera: &Camera, aspect: f64) -> [[f64; 2]; 2] {
        let position = camera.position.as_dvec3();
        let backward = (position - camera.target.as_dvec3()).normalize();
        let right = DVec3::Y.cross(backward).normalize();
        let up = backward.cross(right);
        let tangent = camera.projection.width_at(0.5);
        let mut extent = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for point in &object.mesh.positions {
            let p = point.as_dvec3() - position;
            let depth = -p.dot(backward);
            assert!(depth > 0.0, "{point} is behind the camera");
            let image = [p.dot(right) / (tangent * depth), p.dot(up) * aspect / (tangent * depth)];
            for (range, x) in extent.iter_mut().zip(image) {
                *range = [range[0].min(x), range[1].max(x)];
            }
        }
        extent
    }

    #[test]
    fn camera_fills_three_quarters_of_the_frame_at_any_scale_and_aspect() {
        for (scale, offset) in
            [(1.0, Vec3::ZERO), (1e-6, Vec3::ZERO), (1e6, Vec3::ZERO), (2.0, Vec3::new(30.0, -50.0, 10.0))]
        {
            for aspect in [0.3, 1.0, 16.0 / 9.0, 5.0] {
                let object = blob(scale, offset);
                let objects = [object];
                let camera = Stage::of(&objects).camera(&objects, aspect);
                let [x, y] = extent(&objects[0], &camera, aspect);
                let fill = x[1].max(-x[0]).max(y[1]).max(-y[0]);
                assert!((fill - FILL).abs() < 0.01, "scale {scale}, aspect {aspect}: {x:?} {y:?}");
                // The axis that decides is centered.
                let limit = if (x[1] - x[0]) > (y[1] - y[0]) { x } else { y };
                assert!((limit[0] + limit[1]).abs() < 0.01, "{x:?} {y:?}");
            }
        }
    }

    /// Middle, size and radiance of an automatic light.
    fn summary(light: &Light) -> (Vec3, Vec3, Vec3) {
        match *light {
            Light::Rectangle { center, edge_x, radiance, .. } => (center, edge_x, radiance),
            Light::Sphere { center, radius, radiance, .. } => (center, Vec3::splat(radius), radiance),
            _ => panic!("an automatic light is a rectangle or a sphere"),
        }
    }

    #[test]
    fn frame_is_the_same_picture_at_any_scale() {
        let lights_and_camera = |scale: f32| {
            let objects = [blob(scale, Vec3::ZERO)];
            let frame = Stage::of(&objects);
            (
                frame.camera(&objects, 1.5),
                frame.lights(),
                frame.backdrop(Stage::BACKDROP_COLOR, BackdropShape::Sweep).0,
            )
        };
        let (camera, lights, backdrop) = lights_and_camera(1.0);
        for scale in [1e-6_f32, 1e-3, 1e6] {
            let near = |a: Vec3, b: Vec3| (a / scale).distance(b) < 1e-4 * b.length().max(1.0);
            let (camera_here, lights_here, backdrop_here) = lights_and_camera(scale);
            assert!(near(camera_here.position, camera.position), "{scale}");
            assert!((camera_here.focus_distance / scale / camera.focus_distance - 1.0).abs() < 1e-4);
            for (here, there) in lights_here.iter().zip(&lights) {
                let ((center, size, radiance), (c, s, r)) = (summary(here), summary(there));
                assert!(near(center, c) && near(size, s) && radiance == r, "{scale}");
            }
            for (here, there) in backdrop_here.positions.iter().zip(&backdrop.positions) {
                assert!(near(*here, *there), "{scale}: {here} {there}");
            }
        }
    }

    #[test]
    fn frame_stands_flat_and_tiny_bounds() {
        let quad = |u: Vec3, v: Vec3| object(vec![Vec3::ZERO, u, v, u + v]);
        let far = Vec3::splat(1e8);
        let speck = object(vec![far, far + Vec3::new(8.0, 0.0, 0.0), far + Vec3::new(0.0, 8.0, 0.0)]);
        for object in [
            quad(Vec3::X, Vec3::Y),
            quad(Vec3::Y, Vec3::Z),
            quad(Vec3::Z, Vec3::X),
            quad(Vec3::X, Vec3::new(0.0, 1e-9, 0.0)),
            object(vec![Vec3::ONE; 3]),
            object(vec![Vec3::ZERO; 3]),
            speck,
        ] {
            let objects = [object];
            let frame = Stage::of(&objects);
            let camera = frame.camera(&objects, 1.0);
            assert!(camera.position.is_finite() && camera.position != camera.target, "{camera:?}");
            assert!(camera.focus_distance > 0.0);
            let view = (camera.target - camera.position).normalize();
            assert!(view.cross(Vec3::Y).length() > 0.1 && view.is_finite());
            for light in frame.lights() {
                let (center, size, _) = summary(&light);
                assert!(center.is_finite() && size.is_finite() && size != Vec3::ZERO, "{light:?}");
                if let Light::Rectangle { edge_x, edge_y, .. } = light {
                    assert!(edge_y.is_finite() && edge_x.cross(edge_y) != Vec3::ZERO);
                }
            }
        }
    }

    #[test]
    fn automatic_key_faces_the_mesh_from_the_camera_side_and_the_rim_is_behind() {
        let objects = [blob(3.0, Vec3::X)];
        let frame = Stage::of(&objects);
        let [key, rim] = frame.lights().try_into().unwrap();
        let Light::Rectangle { center, edge_x, edge_y, .. } = key else { panic!() };
        let to_mesh = (frame.center.as_vec3() - center).normalize();
        assert!(edge_x.cross(edge_y).normalize().distance(to_mesh) < 1e-5);
        assert!(edge_x.dot(edge_y).abs() < 1e-4 * edge_x.length() * edge_y.length());
        assert!(to_mesh.dot(frame.viewpoint.direction().as_vec3()) < 0.0);
        let Light::Sphere { center, radius, .. } = rim else { panic!() };
        let from_mesh = center - frame.center.as_vec3();
        assert!(from_mesh.dot(frame.viewpoint.direction().as_vec3()) < 0.0);
        // Outside of the meshes, and before the backdrop.
        assert!(radius + (frame.radius as f32) < from_mesh.length());
        let (backdrop, _) = frame.backdrop(Stage::BACKDROP_COLOR, BackdropShape::Sweep);
        for triangle in &backdrop.triangles {
            let [a, b, c] = triangle.map(|i| backdrop.positions[i as usize]);
            let normal = (b - a).cross(c - a).normalize();
            assert!(normal.dot(center - a) > radius, "the rim light is in the backdrop");
        }
    }

    #[test]
    fn backdrop_is_below_the_mesh_and_behind_everything() {
        let objects = [blob(2.0, Vec3::Y)];
        let frame = Stage::of(&objects);
        let (mesh, material) = frame.backdrop(Stage::BACKDROP_COLOR, BackdropShape::Sweep);
        let lowest = objects[0].mesh.bounds().0.y;
        let (low, _) = mesh.bounds();
        assert!(low.y < lowest && low.y > lowest - 0.01 * frame.radius as f32);
        assert!(material.specular_weight.factor == 0.0);
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|i| mesh.positions[i as usize]);
            let normal = (b - a).cross(c - a).normalize();
            // Wound so that it faces up and toward the camera, as its shading normals do.
            assert!(normal.dot(mesh.normals[triangle[0] as usize]) > 0.9);
            assert!(normal.dot(Vec3::Y + frame.viewpoint.direction().as_vec3()) > 0.0);
        }
        let camera = frame.camera(&objects, 1.0);
        assert!(camera.position.y > low.y, "the camera is above the floor");
    }
}
