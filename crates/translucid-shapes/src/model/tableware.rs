//! A drinking glass and what is in it.

use glam::Vec2;
use translucid_scene::{Mesh, SceneError};

use crate::parameters::{ShapeParameter, Values};
use crate::primitive::lathe::{Corner, fillet_profile, revolve};

const SEGMENTS: ShapeParameter = ShapeParameter::count("segments", 128.0, 8.0, 4096.0);
const GLASS_HEIGHT: ShapeParameter = ShapeParameter::length("height", 11.0);
const BOTTOM_RADIUS: ShapeParameter = ShapeParameter::length("bottom_radius", 2.9);
const TOP_RADIUS: ShapeParameter = ShapeParameter::length("top_radius", 3.7);
const WALL: ShapeParameter = ShapeParameter::length("wall", 0.22);
const BASE: ShapeParameter = ShapeParameter::length("base", 0.9); // Thickness of the bottom

/// Pieces of each rounded edge.
const ARC: usize = 10;

pub(crate) const DRINKING_GLASS: &[ShapeParameter] =
    &[GLASS_HEIGHT, BOTTOM_RADIUS, TOP_RADIUS, WALL, BASE, SEGMENTS];

/// Inside of a tumbler: a truncated cone.
struct Tumbler {
    height: f32,
    bottom_radius: f32,
    top_radius: f32,
    wall: f32,
    base: f32,
}

impl Tumbler {
    fn new(values: &Values) -> Result<Self, SceneError> {
        let [height, bottom_radius, top_radius, wall, base] =
            ["height", "bottom_radius", "top_radius", "wall", "base"].map(|name| values.get(name));
        if wall >= bottom_radius.min(top_radius) {
            let message = format!("wall is {wall}, but must be less than bottom_radius and top_radius");
            return Err(SceneError::new(message));
        }
        if base >= height {
            return Err(SceneError::new(format!("base is {base}, but must be less than height = {height}")));
        }
        Ok(Self { height, bottom_radius, top_radius, wall, base })
    }

    /// Radius of the wall's inner side at a height.
    fn inner_radius(&self, y: f32) -> f32 {
        self.bottom_radius + (self.top_radius - self.bottom_radius) * y / self.height - self.wall
    }
}

/// A tumbler with thick walls and a heavy bottom.
pub(crate) fn drinking_glass(values: &Values) -> Result<Mesh, SceneError> {
    let glass = Tumbler::new(values)?;
    let rim = 0.48 * glass.wall;
    let corners = [
        Corner::sharp(0.0, 0.04 * glass.base),
        // A shallow hollow under the foot.
        Corner::rounded(0.75 * glass.bottom_radius, 0.04 * glass.base, 0.3 * glass.base),
        Corner::rounded(0.85 * glass.bottom_radius, 0.0, 0.2 * glass.base),
        Corner::rounded(glass.bottom_radius, 0.0, 0.35 * glass.base),
        Corner::rounded(glass.top_radius, glass.height, rim),
        Corner::rounded(glass.inner_radius(glass.height), glass.height, rim),
        Corner::rounded(glass.inner_radius(glass.base), glass.base, 0.6 * glass.base),
        Corner::sharp(0.0, glass.base),
    ];
    Ok(revolve(&fillet_profile(&corners, ARC), values.count("segments")))
}

pub(crate) const DRINK: &[ShapeParameter] = &[
    GLASS_HEIGHT,
    BOTTOM_RADIUS,
    TOP_RADIUS,
    WALL,
    BASE,
    ShapeParameter::ratio("fill", 0.75, 0.05, 0.98), // Filled share of the glass
    ShapeParameter::length_or_zero("overlap", 0.02), // How far the drink reaches into the glass
    SEGMENTS,
];

/// The contents of a `drinking-glass` with the same numbers, with a meniscus.
///
/// The drink reaches a little into the wall: a gap of air between them would mirror, and shared
/// faces would be in each other's place.
pub(crate) fn drink(values: &Values) -> Result<Mesh, SceneError> {
    let glass = Tumbler::new(values)?;
    let overlap = values.get("overlap");
    if overlap >= glass.wall.min(glass.base) {
        return Err(SceneError::new(format!("overlap is {overlap}, but must be less than wall and base")));
    }
    let bottom = glass.base - overlap;
    let level = glass.base + values.get("fill") * (glass.height - glass.base);
    let climb = 0.12_f32.min(0.3 * (level - bottom));
    let radius = |y: f32| glass.inner_radius(y) + overlap;
    let mut corners = vec![
        Corner::sharp(0.0, bottom),
        Corner::rounded(radius(bottom), bottom, 0.6 * glass.base + overlap),
        Corner::rounded(radius(level + climb), level + climb, 0.25 * climb),
    ];
    // The surface falls exponentially from the wall, over a capillary length of about 2.7 mm.
    let rim = radius(level + climb) - overlap;
    corners.extend((1..=8).map(|k| {
        let away = (0.12 * k as f32).min(0.1 * rim * k as f32);
        let position = Vec2::new(rim - away, level + climb * libm::expf(-3.7 * away));
        Corner::rounded(position.x, position.y, 0.05)
    }));
    corners.push(Corner::sharp(0.0, level));
    Ok(revolve(&fillet_profile(&corners, 4), values.count("segments")))
}
