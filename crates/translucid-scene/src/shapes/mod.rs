//! Built-in shapes: procedural meshes by name.
//!
//! Every shape except the flat ones ([`FLAT_SHAPES`]) is closed and manifold, with its triangles
//! counter-clockwise seen from outside, and every shape has unit shading normals.
//! The basic shapes are centered on the origin; objects that stand (fruits, candle, glass …) stand on y = 0.
//! A shape is a function of its parameters: equal ones give equal meshes, bit for bit.

mod implicit;
mod model;
mod parameters;
mod primitive;

pub use parameters::{ShapeParameter, ShapeParameterKind, ShapeParameters};

use model::{bust, candle, fruit, furniture, grapes, tableware, toy};
use parameters::Values;
use primitive::basic;

use crate::{Mesh, SceneError};

/// A name, what it is, its parameters, and how it is made.
struct Shape {
    name: &'static str,
    meaning: &'static str,
    parameters: &'static [ShapeParameter],
    build: fn(&Values) -> Result<Mesh, SceneError>,
}

/// Shapes that are open surfaces, not solids.
pub const FLAT_SHAPES: [&str; 2] = ["rectangle", "disc"];

#[rustfmt::skip] // A table.
const SHAPES: &[Shape] = &[
    Shape { name: "sphere", meaning: "a sphere", parameters: basic::SPHERE, build: basic::sphere },
    Shape { name: "rectangle", meaning: "a flat rectangle facing +z", parameters: basic::RECTANGLE, build: basic::rectangle },
    Shape { name: "disc", meaning: "a flat disc facing +z", parameters: basic::DISC, build: basic::disc },
    Shape { name: "box", meaning: "a box with rounded edges", parameters: basic::BOX, build: basic::cuboid },
    Shape { name: "cylinder", meaning: "a cylinder about y with rounded edges", parameters: basic::CYLINDER, build: basic::cylinder },
    Shape { name: "cone", meaning: "a cone or truncated cone about y", parameters: basic::CONE, build: basic::cone },
    Shape { name: "torus", meaning: "a ring about y", parameters: basic::TORUS, build: basic::torus },
    Shape { name: "bust", meaning: "a woman's bust facing +z; vertex colors vein it", parameters: bust::BUST, build: bust::bust },
    Shape { name: "apple", meaning: "an apple with its stalk; vertex colors", parameters: fruit::APPLE, build: fruit::apple },
    Shape { name: "pear", meaning: "a pear with its stalk; vertex colors", parameters: fruit::PEAR, build: fruit::pear },
    Shape { name: "orange", meaning: "an orange; vertex colors", parameters: fruit::ORANGE, build: fruit::orange },
    Shape { name: "orange-half", meaning: "half an orange, cut face up; vertex colors", parameters: fruit::ORANGE_HALF, build: fruit::orange_half },
    Shape { name: "melon-slice", meaning: "a slice of watermelon along x; vertex colors", parameters: fruit::MELON_SLICE, build: fruit::melon_slice },
    Shape { name: "grapes", meaning: "a bunch of grapes along x; vertex colors tint them", parameters: grapes::GRAPES, build: grapes::grapes },
    Shape { name: "duck", meaning: "a bath duck facing +z; vertex colors", parameters: toy::DUCK, build: toy::duck },
    Shape { name: "brick", meaning: "a building brick with studs", parameters: toy::BRICK, build: toy::brick },
    Shape { name: "candle", meaning: "a candle's wax with molten rim and drips", parameters: candle::CANDLE, build: candle::candle },
    Shape { name: "wick", meaning: "a candle's wick; vertex colors", parameters: candle::WICK, build: candle::wick },
    Shape { name: "flame", meaning: "a candle's flame; vertex colors for its emission", parameters: candle::FLAME, build: candle::flame },
    Shape { name: "table-top", meaning: "a board table's top, its upper side at y = 0; vertex colors", parameters: furniture::TABLE_TOP, build: furniture::table_top },
    Shape { name: "drinking-glass", meaning: "a tumbler with thick walls", parameters: tableware::DRINKING_GLASS, build: tableware::drinking_glass },
    Shape { name: "drink", meaning: "the contents of a drinking-glass", parameters: tableware::DRINK, build: tableware::drink },
];

/// Names of all shapes.
pub fn shape_names() -> Vec<&'static str> {
    SHAPES.iter().map(|shape| shape.name).collect()
}

/// Description of a shape in a few words; `None` if there is no such shape.
pub fn shape_meaning(name: &str) -> Option<&'static str> {
    SHAPES.iter().find(|shape| shape.name == name).map(|shape| shape.meaning)
}

/// The parameters that a shape understands; `None` if there is no such shape.
pub fn shape_parameters(name: &str) -> Option<&'static [ShapeParameter]> {
    SHAPES.iter().find(|shape| shape.name == name).map(|shape| shape.parameters)
}

/// Makes a shape.
///
/// # Errors
/// There is no such shape or parameter, or a value is out of its range.
///
/// ```
/// use translucid_scene::{ShapeParameters, build_shape};
/// let ball = build_shape("sphere", &ShapeParameters::new().with("radius", 2.0))?;
/// assert!(ball.positions.iter().all(|p| (p.length() - 2.0).abs() < 1e-5));
/// # Ok::<(), translucid_scene::SceneError>(())
/// ```
pub fn build_shape(name: &str, parameters: &ShapeParameters) -> Result<Mesh, SceneError> {
    let shape = SHAPES.iter().find(|shape| shape.name == name).ok_or_else(|| unknown_shape(name))?;
    (shape.build)(&parameters.resolve(name, shape.parameters)?)
}

fn unknown_shape(name: &str) -> SceneError {
    SceneError::new(format!("there is no shape \"{name}\""))
        .with_help(format!("the shapes are {}", shape_names().join(", ")))
}

#[cfg(test)]
mod tests;
