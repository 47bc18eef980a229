//! Lights that are not emissive meshes.

use glam::{DMat3, Mat3, Vec3};

use crate::SceneError;
use crate::interval::{Interval, check_index, refusal};

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
    /// One-sided ellipse that emits uniformly along `edge_x × edge_y`.
    Ellipse {
        /// Center \[L\].
        center: Vec3,
        /// Whole axis \[L\]: the edge of the rectangle around it, perpendicular to `edge_y`.
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
    /// Light with a cone: a point, or a sphere each of whose points shines into the cone.
    Spot {
        /// Position \[L\].
        position: Vec3,
        /// Unit direction of the cone's axis.
        direction: Vec3,
        /// Radius of the sphere \[L\]; 0 is a point, which no ray can meet.
        radius: f32,
        /// Radiant intensity on the axis [per steradian].
        intensity: Vec3,
        /// Half-angle within which the intensity is constant, in degrees; ≥ 0.
        inner_angle: f32,
        /// Half-angle beyond which it is zero, in degrees; in (inner_angle, 180]. 180 is a point light.
        outer_angle: f32,
        /// Whether the camera sees it directly, if it has a radius.
        visible: bool,
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

/// White light from everywhere, which the camera sees.
impl Default for Environment {
    fn default() -> Self {
        Self { radiance: Vec3::ONE, image: None, world_from_environment: Mat3::IDENTITY, visible: true }
    }
}

/// Largest cosine between two directions that count as perpendicular.
const PERPENDICULAR: f64 = 1e-3;
/// Largest difference between 1 and the square of a length that counts as 1.
const UNIT: f64 = 0.02;

impl Light {
    /// Range of the angular radius of a distant light, in degrees.
    pub const ANGULAR_RADIUS: Interval = Interval::below(0.0, 90.0);
    /// Range of the radius of a spot \[L\].
    pub const SPOT_RADIUS: Interval = Interval::closed(0.0, Interval::REACH.high);
    /// Range of the outer angle of a spot, in degrees.
    pub const OUTER_ANGLE: Interval = Interval::above(0.0, 180.0);

    /// Range of the inner angle of a spot, in degrees.
    pub fn inner_angle_within(outer_angle: f32) -> Interval {
        Interval::below(0.0, f64::from(outer_angle))
    }

    /// The light's kind as scene files write it.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Rectangle { .. } => "rectangle",
            Self::Ellipse { .. } => "ellipse",
            Self::Sphere { .. } => "sphere",
            Self::Distant { .. } => "distant",
            Self::Spot { .. } => "spot",
            Self::Beam { .. } => "beam",
        }
    }

    /// Checks every field of the light that messages know by this number.
    ///
    /// # Errors
    /// A number is out of its range, a direction has another length than 1, or the edges of a rectangle are not
    /// perpendicular.
    pub fn validate(&self, index: usize) -> Result<(), SceneError> {
        self.check().map_err(|error| error.within(format_args!("light {index} ({})", self.kind())))
    }

    /// Checks every field: ranges, unit vectors, and that the edges of a rectangle are perpendicular.
    fn check(&self) -> Result<(), SceneError> {
        let point = |field, value: Vec3| Interval::PLACE.check_all(field, value.to_array());
        let color = |field, value: Vec3| Interval::LIGHT.check_all(field, value.to_array());
        let radius = |value| Interval::REACH.check("radius", value);
        match *self {
            Self::Rectangle { center, edge_x, edge_y, radiance, visible: _ }
            | Self::Ellipse { center, edge_x, edge_y, radiance, visible: _ } => {
                point("center", center)?;
                Self::check_edges(edge_x, edge_y)?;
                color("radiance", radiance)
            }
            Self::Sphere { center, radius: r, radiance, visible: _ } => {
                point("center", center)?;
                radius(r)?;
                color("radiance", radiance)
            }
            Self::Distant { direction, angular_radius, irradiance } => {
                Self::check_unit("direction", direction)?;
                Self::ANGULAR_RADIUS.check("angular_radius", angular_radius)?;
                color("irradiance", irradiance)
            }
            Self::Spot { position, direction, radius, intensity, inner_angle, outer_angle, visible: _ } => {
                point("position", position)?;
                Self::SPOT_RADIUS.check("radius", radius)?;
                Self::check_unit("direction", direction)?;
                Self::OUTER_ANGLE.check("outer_angle", outer_angle)?;
                Self::inner_angle_within(outer_angle).check("inner_angle", inner_angle)?;
                color("intensity", intensity)
            }
            Self::Beam { origin, direction, radius: r, power } => {
                point("origin", origin)?;
                Self::check_unit("direction", direction)?;
                radius(r)?;
                color("power", power)
            }
        }
    }

    /// Refuses a direction whose length is not 1.
    ///
    /// # Errors
    /// It is not: the message begins with the field.
    pub fn check_unit(field: &str, direction: Vec3) -> Result<(), SceneError> {
        if (direction.as_dvec3().length_squared() - 1.0).abs() <= UNIT {
            return Ok(());
        }
        Err(refusal(field, direction, "a vector of length 1"))
    }

    /// Refuses edges of a rectangle that are zero or not perpendicular to each other.
    ///
    /// # Errors
    /// They are, or a number is out of its range.
    pub fn check_edges(x: Vec3, y: Vec3) -> Result<(), SceneError> {
        for (field, edge) in [("edge_x", x), ("edge_y", y)] {
            Interval::PLACE.check_all(field, edge.to_array())?;
            if edge == Vec3::ZERO {
                return Err(refusal(field, edge, "a vector that is not zero"));
            }
        }
        let (x, y) = (x.as_dvec3(), y.as_dvec3());
        // Components near the least number in single precision have no digits left for an angle.
        let rounding = f64::from(f32::from_bits(4)) * (x.length() + y.length());
        if x.dot(y).abs() <= PERPENDICULAR * x.length() * y.length() + rounding {
            return Ok(());
        }
        Err(refusal("edge_y", y, "perpendicular to edge_x"))
    }
}

impl Environment {
    /// Whether a matrix turns without stretching or mirroring, as [`world_from_environment`](Self::world_from_environment)
    /// must.
    pub fn is_rotation(matrix: Mat3) -> bool {
        let matrix = matrix.as_dmat3();
        let difference = matrix.transpose() * matrix - DMat3::IDENTITY;
        let turns = difference.to_cols_array().iter().all(|x| x.abs() <= PERPENDICULAR);
        turns && matrix.determinant() > 0.0
    }

    /// Checks every field in a scene of so many images.
    ///
    /// # Errors
    /// A radiance is out of its range, there is no image of that index, or the matrix is not a rotation.
    pub fn validate(&self, images: usize) -> Result<(), SceneError> {
        self.check(images).map_err(|error| error.within("environment"))
    }

    fn check(&self, images: usize) -> Result<(), SceneError> {
        Interval::LIGHT.check_all("radiance", self.radiance.to_array())?;
        if let Some(image) = self.image {
            check_index("image", image, images, "images")?;
        }
        if Self::is_rotation(self.world_from_environment) {
            return Ok(());
        }
        Err(refusal("world_from_environment", self.world_from_environment, "a rotation"))
    }
}
