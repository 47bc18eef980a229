//! Built-in shapes: procedural meshes by name.
//!
//! Every shape but the rectangle and the disc is closed and manifold, with its triangles
//! counter-clockwise seen from outside, and every shape has unit shading normals.
//! The basic shapes are centered on the origin; objects that stand (fruits, candle, glass …) stand on y = 0.
//! A shape is a function of its parameters: equal ones give equal meshes, bit for bit.

mod implicit;
mod model;
mod parameters;
mod primitive;

pub use parameters::{ShapeParameter, ShapeParameterKind, ShapeParameters};

use model::{bust, candle, carving, ear, fruit, furniture, grapes, lithophane, tableware, tooth, toy};
use parameters::Values;
use primitive::basic;
use translucid_scene::{Mesh, SceneError};

/// A name, its parameters, and how it is made.
struct Shape {
    name: &'static str,
    parameters: &'static [ShapeParameter],
    build: fn(&Values) -> Result<Mesh, SceneError>,
}

#[rustfmt::skip] // A table.
const SHAPES: &[Shape] = &[
    Shape { name: "sphere", parameters: basic::SPHERE, build: basic::sphere },
    Shape { name: "rectangle", parameters: basic::RECTANGLE, build: basic::rectangle },
    Shape { name: "disc", parameters: basic::DISC, build: basic::disc },
    Shape { name: "box", parameters: basic::BOX, build: basic::cuboid },
    Shape { name: "cylinder", parameters: basic::CYLINDER, build: basic::cylinder },
    Shape { name: "cone", parameters: basic::CONE, build: basic::cone },
    Shape { name: "torus", parameters: basic::TORUS, build: basic::torus },
    Shape { name: "bust", parameters: bust::BUST, build: bust::bust },
    Shape { name: "carving", parameters: carving::CARVING, build: carving::carving },
    Shape { name: "ear", parameters: ear::EAR, build: ear::ear },
    Shape { name: "apple", parameters: fruit::APPLE, build: fruit::apple },
    Shape { name: "pear", parameters: fruit::PEAR, build: fruit::pear },
    Shape { name: "orange", parameters: fruit::ORANGE, build: fruit::orange },
    Shape { name: "orange-half", parameters: fruit::ORANGE_HALF, build: fruit::orange_half },
    Shape { name: "melon-slice", parameters: fruit::MELON_SLICE, build: fruit::melon_slice },
    Shape { name: "grapes", parameters: grapes::GRAPES, build: grapes::grapes },
    Shape { name: "lithophane", parameters: lithophane::LITHOPHANE, build: lithophane::lithophane },
    Shape { name: "tooth", parameters: tooth::TOOTH, build: tooth::tooth },
    Shape { name: "gum", parameters: tooth::GUM, build: tooth::gum },
    Shape { name: "duck", parameters: toy::DUCK, build: toy::duck },
    Shape { name: "brick", parameters: toy::BRICK, build: toy::brick },
    Shape { name: "candle", parameters: candle::CANDLE, build: candle::candle },
    Shape { name: "wick", parameters: candle::WICK, build: candle::wick },
    Shape { name: "flame", parameters: candle::FLAME, build: candle::flame },
    Shape { name: "table-top", parameters: furniture::TABLE_TOP, build: furniture::table_top },
    Shape { name: "drinking-glass", parameters: tableware::DRINKING_GLASS, build: tableware::drinking_glass },
    Shape { name: "drink", parameters: tableware::DRINK, build: tableware::drink },
];

/// Names of all shapes.
pub fn shape_names() -> Vec<&'static str> {
    SHAPES.iter().map(|shape| shape.name).collect()
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
/// use translucid_shapes::{ShapeParameters, build_shape};
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
