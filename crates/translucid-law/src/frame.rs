//! Orthonormal frames for local directions.

use glam::Vec3;

use crate::elementary::sign_of;

/// A right-handed orthonormal frame whose z axis is a surface normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// First tangent.
    pub x: Vec3,
    /// Second tangent.
    pub y: Vec3,
    /// Normal.
    pub z: Vec3,
}

impl Frame {
    /// A frame around a unit normal, continuous except at −z
    /// [Duff et al. 2017, "Building an Orthonormal Basis, Revisited"].
    #[inline]
    pub fn from_normal(z: Vec3) -> Self {
        let side = sign_of(z.z);
        let a = -1.0 / (side + z.z);
        let b = z.x * z.y * a;
        let x = Vec3::new(1.0 + side * z.x * z.x * a, side * b, -side * z.x);
        let y = Vec3::new(b, side + z.y * z.y * a, -z.y);
        Self { x, y, z }
    }

    /// One of the three axes by its number: x, y, z.
    #[inline]
    pub fn axis(&self, index: usize) -> Vec3 {
        match index {
            0 => self.x,
            1 => self.y,
            _ => self.z,
        }
    }

    /// Local coordinates of a world direction.
    #[inline]
    pub fn to_local(&self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.x), v.dot(self.y), v.dot(self.z))
    }

    /// World coordinates of a local direction.
    #[inline]
    pub fn to_world(&self, v: Vec3) -> Vec3 {
        self.x * v.x + self.y * v.y + self.z * v.z
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::TAU;

    use super::*;

    #[test]
    fn frame_is_orthonormal_for_any_normal() {
        for i in 0..2000 {
            let t = i as f32 * 0.618_034;
            let z = 1.0 - 2.0 * (i as f32 + 0.5) / 2000.0;
            let r = (1.0 - z * z).sqrt();
            let n = Vec3::new(r * (t * TAU).cos(), r * (t * TAU).sin(), z).normalize();
            let f = Frame::from_normal(n);
            for (a, b) in [(f.x, f.y), (f.y, f.z), (f.z, f.x)] {
                assert!(a.dot(b).abs() < 1e-5 && (a.length() - 1.0).abs() < 1e-5, "{n}");
            }
            assert!((f.x.cross(f.y) - f.z).length() < 1e-5, "{n}");
        }
    }
}
