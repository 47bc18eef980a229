//! Shapes, pictures and text, for [`svg`](super::svg).

use std::f64::consts::TAU;

use super::text::Font;
use crate::chart::{Marker, Shade};

/// Shapes and text, the last on top.
pub(crate) struct Canvas {
    /// Width and height \[px\].
    pub(super) size: [f64; 2],
    pub(super) shapes: Vec<Shape>,
}

/// A thing on a canvas; places and lengths are in pixels.
pub(super) enum Shape {
    Line { points: Vec<[f64; 2]>, pen: Pen },
    Polygon { corners: Vec<[f64; 2]>, fill: Fill },
    Disc { center: [f64; 2], radius: f64, fill: Fill },
    Words { text: String, label: Label<'static> },
    Picture { png: Vec<u8>, at: [f64; 2], size: [f64; 2] },
}

/// Filling of an area.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fill {
    pub(super) shade: Shade,
    pub(super) opacity: f64,
    /// Width of a rim in the color of the background, 0 for none.
    pub(super) rim: f64,
}

/// The part of a text that lies at its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// Text at a place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Label<'a> {
    pub(crate) text: &'a str,
    /// Place of the anchor on the base line \[px\].
    pub(crate) at: [f64; 2],
    pub(crate) font: Font,
    pub(crate) anchor: Anchor,
    /// Whether it goes upwards.
    pub(crate) upwards: bool,
}

/// Look of a line.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pen {
    pub(crate) shade: Shade,
    pub(crate) width: f64,
    /// Lengths of dashes and gaps, empty for a solid line.
    pub(crate) dash: &'static [f64],
}

impl Pen {
    pub(crate) const fn solid(shade: Shade, width: f64) -> Self {
        Self { shade, width, dash: &[] }
    }
}

impl Canvas {
    /// An empty canvas of a size \[px\].
    pub(crate) fn new(size: [f64; 2]) -> Self {
        Self { size, shapes: Vec::new() }
    }

    /// Draws a line through points.
    pub(crate) fn line(&mut self, points: &[[f64; 2]], pen: &Pen) {
        self.shapes.push(Shape::Line { points: points.to_vec(), pen: *pen });
    }

    /// Fills a polygon.
    pub(crate) fn polygon(&mut self, corners: Vec<[f64; 2]>, shade: Shade, opacity: f64) {
        self.shapes.push(Shape::Polygon { corners, fill: Fill { shade, opacity, rim: 0.0 } });
    }

    /// Draws a marker with a rim in the color of the background, which keeps neighbors apart.
    pub(crate) fn marker(&mut self, marker: Marker, [x, y]: [f64; 2], size: f64, shade: Shade) {
        let fill = Fill { shade, opacity: 1.0, rim: 0.9 };
        let corners = match marker {
            Marker::Circle => {
                return self.shapes.push(Shape::Disc { center: [x, y], radius: size, fill });
            }
            Marker::Cross => return self.bars([x, y], size, 0.125, shade),
            Marker::Plus => return self.bars([x, y], size, 0.0, shade),
            Marker::Triangle => regular(3, 1.35, 0.0),
            Marker::TriangleDown => regular(3, 1.35, 0.5),
            Marker::Square => regular(4, 1.25, 0.125),
            Marker::Diamond => regular(4, 1.35, 0.0),
            Marker::Pentagon => regular(5, 1.2, 0.0),
            Marker::Hexagon => regular(6, 1.15, 0.0),
            Marker::Star => {
                let (outer, inner) = (regular(5, 1.6, 0.0), regular(5, 0.65, 0.1));
                outer.into_iter().zip(inner).flat_map(|(a, b)| [a, b]).collect()
            }
        };
        let corners = corners.iter().map(|[dx, dy]| [x + size * dx, y + size * dy]).collect();
        self.shapes.push(Shape::Polygon { corners, fill });
    }

    /// Draws two bars across each other, turned by a part of a whole turn.
    fn bars(&mut self, [x, y]: [f64; 2], size: f64, turn: f64, shade: Shade) {
        for turn in [turn, turn + 0.25] {
            let [dy, dx]: [f64; 2] = (TAU * turn).sin_cos().into();
            let ends = [[x - size * dx, y - size * dy], [x + size * dx, y + size * dy]];
            self.line(&ends, &Pen::solid(shade, 2.0));
        }
    }

    /// Shows a PNG with its upper left corner at a place, stretched to a size.
    pub(crate) fn picture(&mut self, png: Vec<u8>, at: [f64; 2], size: [f64; 2]) {
        self.shapes.push(Shape::Picture { png, at, size });
    }

    /// Writes text in the color of text.
    pub(crate) fn text(&mut self, label: Label<'_>) {
        let text = label.text.to_owned();
        self.shapes.push(Shape::Words { text, label: Label { text: "", ..label } });
    }
}

/// Corners of a regular polygon, the first at the top but for a part of a whole turn; the radii of markers give all
/// about the same area.
fn regular(count: u32, radius: f64, turn: f64) -> Vec<[f64; 2]> {
    let angle = |i: u32| TAU * (f64::from(i) / f64::from(count) + turn);
    (0..count).map(|i| angle(i).sin_cos()).map(|(sin, cos)| [radius * sin, -radius * cos]).collect()
}
