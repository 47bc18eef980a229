//! The emissive triangles of a scene as one light, sampled uniformly in emitted light over their area.

use glam::Vec3;

use super::LightSample;
use super::distribution::Discrete;
use super::receiver::{Receiver, luminance};

/// A triangle that emits on the side from which its vertices are seen counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmissiveTriangle {
    /// Corners in world space \[L\].
    pub vertices: [Vec3; 3],
    /// Emitted radiance, mean over the triangle.
    pub radiance: Vec3,
    /// Number that the renderer knows the triangle by.
    pub primitive: u32,
}

impl EmissiveTriangle {
    /// Twice the area times the unit normal.
    fn cross(&self) -> Vec3 {
        let [a, b, c] = self.vertices;
        (b - a).cross(c - a)
    }

    fn area(&self) -> f32 {
        0.5 * self.cross().length()
    }

    /// Area × luminance.
    fn weight(&self) -> f64 {
        f64::from(self.area()) * f64::from(luminance(self.radiance))
    }
}

/// All emissive triangles.
#[derive(Clone, Debug)]
pub(crate) struct Mesh {
    /// Those that emit, by their primitive's number.
    triangles: Vec<EmissiveTriangle>,
    distribution: Discrete,
    /// Sum of area × luminance.
    weight: f32,
    /// Ball around all of them.
    center: Vec3,
    radius: f32,
}

impl Mesh {
    /// None if no triangle emits.
    pub(crate) fn new(mut triangles: Vec<EmissiveTriangle>) -> Option<Self> {
        triangles.retain(|triangle| {
            let weight = triangle.weight();
            weight > 0.0 && weight.is_finite()
        });
        triangles.sort_by_key(|triangle| triangle.primitive);
        let distribution = Discrete::new(triangles.iter().map(EmissiveTriangle::weight))?;
        let weight = triangles.iter().map(EmissiveTriangle::weight).sum::<f64>() as f32;
        let vertices = || triangles.iter().flat_map(|triangle| triangle.vertices);
        let low = vertices().reduce(Vec3::min)?;
        let high = vertices().reduce(Vec3::max)?;
        let center = low.midpoint(high);
        let radius = vertices().map(|v| v.distance(center)).fold(0.0, f32::max);
        Some(Self { triangles, distribution, weight, center, radius })
    }

    /// Emitted power (luminance).
    pub(crate) fn power(&self) -> f32 {
        std::f32::consts::PI * self.weight
    }

    /// Estimate of the irradiance; 0 only if all of them are below the horizon.
    pub(crate) fn importance(&self, receiver: &Receiver) -> f32 {
        let distance = receiver.point.distance(self.center).max(0.5 * self.radius);
        // Half: the mean cosine at the triangles.
        0.5 * self.weight / distance / distance * receiver.cosine_to_ball(self.center, self.radius)
    }

    /// Draws a point of a triangle; the selection is not in its density.
    pub(crate) fn sample(&self, point: Vec3, u: f64, v: [f32; 2]) -> Option<LightSample> {
        let choice = self.distribution.sample(u);
        let triangle = &self.triangles[choice.index];
        let [a, b, c] = triangle.vertices;
        // From the corner a, so that far from the origin the offsets keep their digits.
        let [s, t] = uniform_barycentric(v);
        let offset = (a - point) + (b - a) * s + (c - a) * t;
        let direction = offset.try_normalize()?;
        let pdf = self.solid_angle_pdf(choice.index, offset, triangle.cross().normalize_or_zero());
        let mut sample = LightSample::new(direction, offset.length(), triangle.radiance, pdf);
        sample.primitive = Some(triangle.primitive);
        Some(sample)
    }

    /// Solid-angle density with which `sample` makes the direction from `point` to `hit` on a triangle.
    pub(crate) fn pdf(&self, primitive: u32, offset: Vec3, normal: Vec3) -> f32 {
        let found = self.triangles.binary_search_by_key(&primitive, |triangle| triangle.primitive);
        found.map_or(0.0, |index| self.solid_angle_pdf(index, offset, normal))
    }

    /// Probability of the triangle / area × distance² / cosine; 0 from behind.
    fn solid_angle_pdf(&self, index: usize, offset: Vec3, normal: Vec3) -> f32 {
        let per_area = self.distribution.probability(index) / f64::from(self.triangles[index].area());
        let offset = offset.as_dvec3();
        // −offset·normal = distance × cosine.
        let facing = -offset.dot(normal.as_dvec3());
        if facing > 0.0 { (per_area * offset.length().powi(3) / facing) as f32 } else { 0.0 }
    }
}

/// Barycentric coordinates of the second and third corner, uniform in area
/// [Heitz 2019, "A Low-Distortion Map Between Triangle and Square"].
fn uniform_barycentric([x, y]: [f32; 2]) -> [f32; 2] {
    if y > x { [0.5 * x, y - 0.5 * x] } else { [x - 0.5 * y, 0.5 * y] }
}
