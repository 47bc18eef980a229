//! Vectors and colors as values.

use glam::{DVec3, Vec2, Vec3};
use translucid_words::{Error, Interval, Item};

/// Values that are vectors.
///
/// # Errors
/// The value is of another kind, or a component is out of the range.
pub trait Vectors {
    /// Two numbers.
    fn vec2(&self, range: Interval) -> Result<Vec2, Error>;
    /// Three numbers.
    fn vec3(&self, range: Interval) -> Result<Vec3, Error>;
    /// Three numbers in double precision.
    fn double3(&self, range: Interval) -> Result<DVec3, Error>;
    /// A point, counted from the origin of the scene.
    fn point(&self) -> Result<Vec3, Error>;
    /// A color: a number, three numbers, or `"#rrggbb"`.
    fn color(&self, range: Interval) -> Result<Vec3, Error>;
}

impl Vectors for Item<'_> {
    fn vec2(&self, range: Interval) -> Result<Vec2, Error> {
        self.numbers(range).map(Vec2::from_array)
    }

    fn vec3(&self, range: Interval) -> Result<Vec3, Error> {
        self.numbers(range).map(Vec3::from_array)
    }

    fn double3(&self, range: Interval) -> Result<DVec3, Error> {
        self.doubles(range).map(DVec3::from_array)
    }

    fn point(&self) -> Result<Vec3, Error> {
        self.double3(Interval::PLACE).map(|point| (point - DVec3::from_array(self.origin())).as_vec3())
    }

    fn color(&self, range: Interval) -> Result<Vec3, Error> {
        self.rgb(range).map(Vec3::from_array)
    }
}
