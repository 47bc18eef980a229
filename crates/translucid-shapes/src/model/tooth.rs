//! Front teeth and the gum that they stand in.

use glam::Vec3;
use translucid_scene::{Mesh, SceneError};

use crate::implicit::distance::{blend, common, ellipsoid, rounded_block, smoothstep};
use crate::implicit::noise::{cell_distance, fractal_noise};
use crate::implicit::sculpture::{detail, height, sculpt};
use crate::parameters::{ShapeParameter, Values};

/// The height is that of crown and root, of which the gum covers the lower 40 %.
pub(crate) const TOOTH: &[ShapeParameter] = &[height(1.7), detail(160.0)];
/// The height is that of the peaks between teeth.
pub(crate) const GUM: &[ShapeParameter] =
    &[height(1.0), ShapeParameter::count("teeth", 3.0, 1.0, 8.0), detail(220.0)];

/// Distance between teeth in units of the design, millimeters.
const PITCH: f32 = 8.4;

/// A value along the crown, between those at equal steps from the neck to the edge.
fn along<const N: usize>(t: f32, values: [f32; N]) -> f32 {
    let at = t.clamp(0.0, 1.0) * (N - 1) as f32;
    let i = (at as usize).min(N - 2);
    // Nearly straight, with bends that are not seen
    let part = 0.6 * (at - i as f32) + 0.4 * smoothstep(0.0, 1.0, at - i as f32);
    values[i] + (values[i + 1] - values[i]) * part
}

/// An incisor whose neck is at y = 0, from a root at -7 to the edge at 10.
fn incisor(p: Vec3) -> f32 {
    let t = p.y / 10.0;
    let root = smoothstep(0.0, -0.8, t);
    let width = along(t, [2.75, 3.3, 3.8, 4.05, 4.1]) - 0.9 * root;
    let front = along(t, [3.0, 3.35, 3.2, 2.7, 1.9]) - 0.8 * root;
    let back = along(t, [-3.0, -2.5, -0.9, 0.25, 0.85]) + 0.8 * root;
    // Two shallow furrows on the face, towards the edge
    let furrows = 0.12 * smoothstep(0.35, 0.9, t) * (libm::cosf(2.2 * p.x) - 1.0);
    let (middle, depth) = (0.5 * (front + furrows + back), 0.5 * (front + furrows - back));
    let [x, z] = [(p.x / width).abs(), ((p.z - middle) / depth).abs()];
    // Between an ellipse at the neck and a rounded rectangle at the edge
    let power = 2.0 + 0.9 * smoothstep(0.0, 0.8, t);
    let flank =
        (libm::powf(libm::powf(x, power) + libm::powf(z, power), 1.0 / power) - 1.0) * depth.min(width);
    // One corner is rounder than the other
    let edge = p.y - 10.0 + 0.02 * p.x * p.x + 0.06 * smoothstep(0.5, 4.5, p.x) * p.x;
    let top = common(flank, edge, 0.9);
    common(0.6 * top, -7.0 - p.y, 0.5)
}

pub(crate) fn tooth(values: &Values) -> Result<Mesh, SceneError> {
    let bounds = [Vec3::new(-4.5, -7.0, -3.6), Vec3::new(4.5, 10.2, 3.8)];
    Ok(sculpt(bounds, incisor, |_, _| Vec3::ONE, values))
}

/// A ridge along x with a collar around each tooth and a peak between two.
fn ridge(p: Vec3, count: f32) -> f32 {
    let half = 0.5 * PITCH * count + 4.0;
    let nearest = (p.x / PITCH + 0.5 * (count - 1.0)).round().clamp(0.0, count - 1.0) - 0.5 * (count - 1.0);
    let x = p.x - PITCH * nearest;
    let side = (x / (0.5 * PITCH)).clamp(-1.0, 1.0);
    let arch = 1.0 - side * side;
    let body = rounded_block(p - Vec3::new(0.0, -5.6, 0.0), Vec3::new(half, 5.2, 5.2 + 0.3 * arch), 3.4);
    let collar = ellipsoid(Vec3::new(x, p.y + 1.6, p.z - 0.1), Vec3::new(4.1, 2.6, 3.9));
    let peak = ellipsoid(Vec3::new(x.abs() - 0.5 * PITCH, p.y + 0.4, p.z - 0.6), Vec3::new(1.5, 3.0, 2.0));
    let gum = blend(blend(body, collar, 2.2), peak, 1.6);
    // Stippled like the peel of an orange
    gum + 0.05 * smoothstep(0.0, 0.5, cell_distance(p * 1.3, 3)) + 0.12 * fractal_noise(p * 0.35, 3, 8)
}

pub(crate) fn gum(values: &Values) -> Result<Mesh, SceneError> {
    let count = values.count("teeth") as f32;
    let half = 0.5 * PITCH * count + 4.2;
    let bounds = [Vec3::new(-half, -11.0, -6.0), Vec3::new(half, 3.0, 6.0)];
    let cut = |p: Vec3| common(0.8 * ridge(p, count), -7.0 - p.y, 0.3);
    Ok(sculpt(bounds, cut, |_, _| Vec3::ONE, values))
}
