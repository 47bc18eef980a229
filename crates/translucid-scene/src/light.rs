//! Lights that are not emissive meshes.

use glam::{Mat3, Vec3};

/// A light with its placement. Colors are linear Rec. 709 and non-negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// One-sided rectangle that emits uniformly along `edge_x × edge_y`.
    Rectangle {
        /// Center \[L\].
        center: Vec3,
        /// Full edge vectors \[L\], perpendicular to each other.
        edge_x: Vec3,
        /// See `edge_x`.
        edge_y: Vec3,
        /// Emitted radiance.
        radiance: Vec3,
        /// Whether the camera sees it directly.
        visible: bool,
    },
    /// Sphere that emits uniformly outward.
    Sphere {
        /// Center \[L\].
        center: Vec3,
        /// Radius \[L\], > 0.
        radius: f32,
        /// Emitted radiance.
        radiance: Vec3,
        /// Whether the camera sees it directly.
        visible: bool,
    },
    /// Parallel light from infinity, or from a disc of the sky with an angular radius.
    Distant {
        /// Unit direction from the scene toward the light.
        direction: Vec3,
        /// Half the angle that the light subtends, in degrees, in [0, 90); 0 is a delta light.
        angular_radius: f32,
        /// Irradiance on a surface that faces the light.
        irradiance: Vec3,
    },
    /// Point light with a cone.
    Spot {
        /// Position \[L\].
        position: Vec3,
        /// Unit direction of the cone's axis.
        direction: Vec3,
        /// Radiant intensity on the axis [per steradian].
        intensity: Vec3,
        /// Half-angle within which the intensity is constant, in degrees; ≥ 0.
        inner_angle: f32,
        /// Half-angle beyond which it is zero, in degrees; in (inner_angle, 180]. 180 is a point light.
        outer_angle: f32,
    },
    /// Parallel beam of finite radius: a laser spot.
    Beam {
        /// Center of the disc that the beam leaves from \[L\].
        origin: Vec3,
        /// Unit direction of travel.
        direction: Vec3,
        /// Radius of the beam \[L\], > 0.
        radius: f32,
        /// Total power; irradiance within the beam is power / (π radius²).
        power: Vec3,
    },
}

/// Light from infinity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Environment {
    /// Radiance where there is no image; a factor on the image where there is one.
    pub radiance: Vec3,
    /// Latitude–longitude image (index into `Scene::images`); its middle column is seen along −z
    /// of the environment's frame, its top row along +y.
    pub image: Option<usize>,
    /// World direction from environment direction (a rotation).
    pub world_from_environment: Mat3,
    /// Whether the camera sees it; if not the background is black with alpha 0.
    pub visible: bool,
}
