//! Camera, lights and backdrop for meshes that come without.

use glam::{DVec3, Vec3};

use crate::{Camera, ColorInput, Environment, Light, Material, Mesh, Object, ScalarInput};

/// Share of the frame's width or height that the mesh fills, whichever it meets first.
const FILL: f64 = 0.75;

/// Horizontal field of view of the automatic camera [degrees]: a short telephoto lens.
const FIELD_OF_VIEW: f64 = 30.0;

/// Most vertices that the fit looks at; more say nothing new about a silhouette.
const MOST_VERTICES: usize = 200_000;

/// Where the meshes are and how they are looked at: everything below is placed relative to it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    /// Middle of the bounding box [L].
    center: DVec3,
    /// Half the box's diagonal [L], > 0.
    radius: f64,
    /// Lowest y [L].
    bottom: f64,
    /// Unit direction to the camera.
    to_camera: DVec3,
}

impl Frame {
    /// The frame of all objects together.
    pub(crate) fn of(objects: &[Object]) -> Self {
        let boxes = objects.iter().map(|object| object.mesh.bounds());
        let (low, high) = boxes.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).unwrap_or_default();
        let (low, high) = (low.as_dvec3(), high.as_dvec3());
        let center = 0.5 * (low + high);
        // Far from the origin, a camera nearer than this could not move in single precision.
        let least = 1e-4 * center.abs().max_element() + 1e-12;
        let radius = (0.5 * (high - low).length()).max(least);
        Self { center, radius, bottom: low.y, to_camera: viewing_direction(high - low) }
    }

    /// A camera from which the meshes fill most of an image of the given width over height.
    pub(crate) fn camera(&self, objects: &[Object], aspect: f64) -> Camera {
        let tangent = (0.5 * FIELD_OF_VIEW).to_radians().tan();
        let view = View::along(self.to_camera, [tangent, tangent / aspect]);
        let points = silhouette(objects).map(|p| view.coordinates(p.as_dvec3() - self.center) / self.radius);
        let points: Vec<DVec3> = points.collect();
        let (target, distance) = view.fit(&points);
        let target = self.center + self.radius * view.world(target);
        let position = target + self.radius * distance * self.to_camera;
        Camera {
            position: position.as_vec3(),
            target: target.as_vec3(),
            up: Vec3::Y,
            horizontal_fov: FIELD_OF_VIEW as f32,
            lens_radius: 0.0,
            focus_distance: (self.radius * distance) as f32,
        }
    }

    /// A soft key from the upper left and a strong rim from behind on the right, which shines through.
    pub(crate) fn lights(&self) -> Vec<Light> {
        vec![
            self.light(&LightPlan {
                azimuth: -50.0,
                elevation: 40.0,
                distance: 4.0,
                size: 2.2,
                radiance: Vec3::new(8.0, 7.7, 7.2),
            }),
            self.light(&LightPlan {
                azimuth: 145.0,
                elevation: 32.0,
                distance: 3.5,
                size: 1.4,
                radiance: Vec3::new(23.0, 22.0, 20.0),
            }),
        ]
    }

    /// Dim light from all around, so that no shadow is black.
    pub(crate) fn environment(&self) -> Environment {
        Environment {
            radiance: Vec3::new(0.20, 0.21, 0.23),
            image: None,
            world_from_environment: glam::Mat3::IDENTITY,
            visible: true,
        }
    }

    /// A neutral floor a little below the meshes, curving up to a wall behind them.
    pub(crate) fn backdrop(&self) -> (Mesh, Material) {
        let material = Material {
            name: String::from("backdrop"),
            base_color: ColorInput::constant(Vec3::new(0.30, 0.30, 0.31)),
            specular_weight: ScalarInput::constant(0.0),
            ..Material::default()
        };
        (self.backdrop_mesh(), material)
    }

    fn light(&self, plan: &LightPlan) -> Light {
        let horizontal = horizontal_of(self.to_camera);
        let (sine, cosine) = plan.azimuth.to_radians().sin_cos();
        let right = DVec3::Y.cross(horizontal);
        let (height, reach) = plan.elevation.to_radians().sin_cos();
        let outward = reach * (cosine * horizontal + sine * right) + height * DVec3::Y;
        let across = DVec3::Y.cross(-outward).normalize_or(DVec3::X);
        let size = plan.size * self.radius;
        Light::Rectangle {
            center: (self.center + plan.distance * self.radius * outward).as_vec3(),
            edge_x: (size * across).as_vec3(),
            edge_y: (size * (-outward).cross(across)).as_vec3(),
            radiance: plan.radiance,
            visible: false,
        }
    }

    /// A strip across the view with the profile floor, quarter circle, wall.
    fn backdrop_mesh(&self) -> Mesh {
        const WIDTH: f64 = 40.0;
        let back = -horizontal_of(self.to_camera);
        let across = back.cross(DVec3::Y);
        let origin = DVec3::new(self.center.x, self.bottom - 2e-3 * self.radius, self.center.z);
        let mut mesh = Mesh::default();
        for (point, normal) in backdrop_profile() {
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

/// A light as seen from the camera; lengths in the frame's radius, angles in degrees.
struct LightPlan {
    /// About y from the camera, positive to its right.
    azimuth: f64,
    elevation: f64,
    distance: f64,
    size: f64,
    radiance: Vec3,
}

/// Points (distance behind the center, height) and normals of the backdrop, from before the camera
/// to the top of the wall, in the frame's radius.
fn backdrop_profile() -> Vec<([f64; 2], [f64; 2])> {
    const STEPS: i32 = 24;
    const FRONT: f64 = -60.0;
    const BEND: f64 = 8.0;
    const TOP: f64 = 60.0;
    let mut profile = vec![([FRONT, 0.0], [0.0, 1.0])];
    for step in 0..=STEPS {
        let (sine, cosine) = (std::f64::consts::FRAC_PI_2 * f64::from(step) / f64::from(STEPS)).sin_cos();
        profile.push(([BEND + BEND * sine, BEND - BEND * cosine], [-sine, cosine]));
    }
    profile.push(([2.0 * BEND, TOP], [-1.0, 0.0]));
    profile
}

/// Three-quarter view from the front (+z), a little above; turned to the broad side of what is thin
/// along z and raised over what lies flat.
fn viewing_direction(extent: DVec3) -> DVec3 {
    let azimuth: f64 = if extent.x < 0.4 * extent.z { 65.0 } else { 25.0 };
    let elevation: f64 = if extent.y < 0.15 * extent.x.max(extent.z) { 40.0 } else { 12.0 };
    let (height, reach) = elevation.to_radians().sin_cos();
    let (sine, cosine) = azimuth.to_radians().sin_cos();
    DVec3::new(reach * sine, height, reach * cosine)
}

fn horizontal_of(direction: DVec3) -> DVec3 {
    DVec3::new(direction.x, 0.0, direction.z).normalize_or(DVec3::Z)
}

fn silhouette(objects: &[Object]) -> impl Iterator<Item = Vec3> {
    let vertices: usize = objects.iter().map(|object| object.mesh.positions.len()).sum();
    let step = vertices.div_ceil(MOST_VERTICES).max(1);
    objects.iter().flat_map(|object| &object.mesh.positions).step_by(step).copied()
}

/// A viewing direction with the frame's half extents at distance 1.
struct View {
    right: DVec3,
    up: DVec3,
    backward: DVec3,
    tangents: [f64; 2],
}

impl View {
    fn along(backward: DVec3, tangents: [f64; 2]) -> Self {
        let right = DVec3::Y.cross(backward).normalize_or(DVec3::X);
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
