//! Punctual lights (KHR_lights_punctual) and cameras.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use glam::{DAffine3, DVec3, Vec3};
use translucid_scene::{Camera, Film, Interval, Light, Projection};

use super::document::{Camera as CameraData, Document, Node, Orthographic, PunctualLight, SpotCone};
use super::extensions::Members;
use super::notes::Notes;
use crate::mesh_file::for_aspect;
use crate::result::Result;

/// Luminous flux of a watt \[lm\]: that of light of 540 THz, by the definition of the candela.
///
/// Lamps say nothing of their spectrum, and Blender's exporter takes this number for what it writes in candela and lux,
/// whatever the color, so that its watts come back.
const LUMENS_PER_WATT: f64 = 683.0;

/// Where glTF's lights and cameras look: along −z of their node.
fn forward(world_from_local: &DAffine3) -> Vec3 {
    world_from_local.transform_vector3(DVec3::NEG_Z).normalize_or(DVec3::NEG_Z).as_vec3()
}

/// Upward direction of a camera; a sheared node may turn its own y into the viewing direction.
fn upward(world_from_local: &DAffine3) -> Vec3 {
    let forward = forward(world_from_local);
    let up = world_from_local.transform_vector3(DVec3::Y).normalize_or(DVec3::Y).as_vec3();
    if forward.cross(up).length() > 1e-4 { up } else { forward.any_orthonormal_vector() }
}

/// A node's light, in a world of `units` scene units to the meter.
///
/// - Directional lights state illuminance (lx), which does not depend on the unit of length.
/// - Points and spots state intensity (cd): irradiance is intensity over squared distance, so that the
///   same picture in other units needs it times `units`².
/// - Both are photometric and become radiometric by [`LUMENS_PER_WATT`].
/// - `range` is a hint for renderers that cut lights off, and not used.
pub(super) fn light(
    node: &Node,
    world_from_local: &DAffine3,
    units: f64,
    part: &str,
    document: &Document,
    notes: &Notes<'_>,
) -> Result<Option<Light>> {
    let Some(data) = Members::of(&node.extensions, "KHR_lights_punctual", part, notes.path)? else {
        return Ok(None);
    };
    let light = data.require("light")?;
    let data = document.lights.get(light, part)?;
    let part = document.lights.label(light);
    let scale = if data.kind == "directional" { 1.0 } else { units * units } / LUMENS_PER_WATT;
    let color = emitted(data, scale, &part, notes);
    let position = world_from_local.translation.as_vec3();
    check_position(position, &part, notes)?;
    let direction = forward(world_from_local);
    match data.kind.as_str() {
        "directional" => {
            Ok(Some(Light::Distant { direction: -direction, angular_radius: 0.0, irradiance: color }))
        }
        "point" => Ok(Some(Light::Spot {
            position,
            direction,
            radius: 0.0,
            intensity: color,
            inner_angle: 0.0,
            outer_angle: 180.0,
            visible: true,
        })),
        "spot" => {
            let (inner_angle, outer_angle) = cone(data, &part, notes);
            Ok(Some(Light::Spot {
                position,
                direction,
                radius: 0.0,
                intensity: color,
                inner_angle,
                outer_angle,
                visible: true,
            }))
        }
        kind => {
            let message =
                format!("its type is \"{}\", but must be directional, point or spot", super::uri::clip(kind));
            Err(notes.error(&part, message))
        }
    }
}

/// Refuses a position beyond the coordinates that a scene may have.
fn check_position(position: Vec3, part: &str, notes: &Notes<'_>) -> Result<()> {
    Interval::PLACE
        .check_all("position", position.to_array())
        .map_err(|error| notes.error(part, format!("its {}", error.message)))
}

/// Color times intensity times `scale`, brought into the range of lights with a warning.
fn emitted(data: &PunctualLight, scale: f64, part: &str, notes: &Notes<'_>) -> Vec3 {
    let color = data.color.unwrap_or([1.0; 3]).map(|channel| (channel * data.intensity * scale) as f32);
    let usable = color.map(|channel| Interval::LIGHT.nearest(channel));
    if usable != color {
        let message =
            format!("its color times its intensity is not in {}: it becomes the nearest", Interval::LIGHT);
        notes.warn(part, message);
    }
    Vec3::from_array(usable)
}

/// Inner and outer half-angle in degrees, 0 ≤ inner < outer ≤ 90.
fn cone(data: &PunctualLight, part: &str, notes: &Notes<'_>) -> (f32, f32) {
    let SpotCone { inner_cone_angle, outer_cone_angle } = data.spot.unwrap_or_default();
    let outer_cone_angle = outer_cone_angle.unwrap_or(FRAC_PI_4);
    let outer = outer_cone_angle.to_degrees().clamp(0.01, 90.0) as f32;
    let inner = (inner_cone_angle.to_degrees().max(0.0) as f32).min(0.999 * outer);
    let sound = inner_cone_angle >= 0.0
        && inner_cone_angle < outer_cone_angle
        && outer_cone_angle <= FRAC_PI_2 + 1e-6;
    if !sound {
        notes.warn(
            part,
            format!("its cone angles are not 0 ≤ inner < outer ≤ π/2: {inner}° and {outer}° are used"),
        );
    }
    (inner, outer)
}

/// A camera and its projection for a square picture, or `None` with a warning.
///
/// glTF states the height of what is seen; its width follows from the aspect ratio of the picture. Without `aspectRatio`,
/// and for `xmag`, that is the default film's.
pub(super) fn camera(
    data: &CameraData,
    world_from_local: &DAffine3,
    units: f64,
    part: &str,
    notes: &Notes<'_>,
) -> Result<Option<(Camera, Projection)>> {
    let film = Film::default();
    let mut aspect = f64::from(film.width) / f64::from(film.height);
    let of_square = match (data.kind.as_str(), &data.perspective, &data.orthographic) {
        ("perspective", Some(perspective), _) => {
            aspect = perspective.aspect_ratio.unwrap_or(aspect);
            let yfov = perspective.yfov;
            if !(yfov > 0.0 && yfov < PI && aspect > 0.0 && aspect.is_finite()) {
                let message =
                    format!("its yfov is {yfov} and aspectRatio {aspect}, but must be in (0, π) and above 0");
                return Err(notes.error(part, message));
            }
            Projection::Perspective { horizontal_fov: yfov.to_degrees() as f32 }
        }
        ("orthographic", _, Some(orthographic)) => {
            let Orthographic { xmag, ymag } = *orthographic;
            aspect = (xmag / ymag).abs();
            let width = 2.0 * ymag.abs() * units;
            if !(Interval::REACH.contains(width) && Interval::REACH.contains(aspect * width)) {
                let must_be = Interval::above(0.0, Interval::REACH.high / (2.0 * units));
                let message = format!("its xmag is {xmag:?} and ymag {ymag:?}, but must be in {must_be}");
                return Err(notes.error(part, message));
            }
            Projection::Orthographic { width: width as f32 }
        }
        _ => {
            notes.warn(part, "a camera that is neither a perspective nor an orthographic one is left out");
            return Ok(None);
        }
    };
    let position = world_from_local.translation;
    // The point looked at lies far enough away to differ from the position in single precision.
    let distance = units.max(1e-3 * position.length());
    let target = position + forward(world_from_local).as_dvec3() * distance;
    check_position(position.as_vec3(), part, notes)?;
    check_position(target.as_vec3(), part, notes)?;
    let camera = Camera {
        position: position.as_vec3(),
        target: target.as_vec3(),
        up: upward(world_from_local),
        projection: for_aspect(of_square, aspect),
        focus_distance: distance as f32,
        ..Camera::default()
    };
    Ok(Some((camera, of_square)))
}
