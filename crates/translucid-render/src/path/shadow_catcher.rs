//! Shadows on a surface that is not seen itself.

use glam::Vec3;

use crate::light::{LightSample, luminance};
use crate::ray::SurfacePoint;
use crate::world::{PathState, ShadowMedium, World};

/// Number of light samples of which one gets a shadow ray. Their sum represents all light: where it varies by a share v
/// from sample to sample, shadows are off by about v²/16.
const CANDIDATES: u32 = 16;

/// 1/φ, 1/φ², 1/φ³ with φ⁴ = φ + 1: their multiples cover the unit cube evenly [Roberts 2018, "The unreasonable
/// effectiveness of quasirandom sequences"].
const STEPS: Vec3 = Vec3::new(0.819_172_5, 0.671_043_6, 0.549_700_5);

/// Share of the direct light of a diffuse surface that other surfaces keep from it: 0 or 1 for a sample, between them behind
/// clear surfaces. The mean over samples is the share.
///
/// One of several light samples is chosen in proportion to its unshadowed light [Talbot, Cline & Egbert 2005,
/// "Importance Resampling for Global Illumination"], and gets a shadow ray.
pub(super) fn missing_light(world: &World, path: &PathState, point: &SurfacePoint, u: [f32; 4]) -> f32 {
    let facing = point.shading_normal.dot(-path.ray.direction);
    let normal = point.shading_normal * 1.0_f32.copysign(facing);
    let mut all = 0.0;
    let mut chosen: Option<(LightSample, f32)> = None;
    let mut choice = u[3];
    for number in 0..CANDIDATES {
        let [a, b, c] = (Vec3::new(u[0], u[1], u[2]) + STEPS * number as f32).fract().to_array();
        let Some(light) = world.lights.sample(point.position, normal, a, [b, c]) else { continue };
        let sent = luminance(world.sent(point, &light));
        let weight = sent * normal.dot(light.direction).max(0.0) / light.pdf;
        if !(weight > 0.0 && weight.is_finite()) {
            continue;
        }
        all += weight;
        // The random number that is left of a choice decides the next one
        let share = weight / all;
        if choice < share {
            chosen = Some((light, sent));
            choice /= share;
        } else {
            choice = (choice - share) / (1.0 - share);
        }
    }
    let Some((light, sent)) = chosen else { return 0.0 };
    let soft = !world.scene.integrator.caustics;
    let medium = ShadowMedium { absorption: path.absorption, soft, random: choice };
    let arriving = luminance(world.unoccluded(point, &light, medium));
    (1.0 - arriving / sent).clamp(0.0, 1.0)
}
