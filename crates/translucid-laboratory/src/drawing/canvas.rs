//! Shapes and text in the shades of a theme, as kuva's scene.

use std::f64::consts::TAU;

use kuva::backend::raster::RasterBackend;
use kuva::backend::svg::SvgBackend;
use kuva::render::color::Color;
use kuva::render::render::{PathData, Primitive, Scene, TextAnchor, TextSpan};

use super::polyline::dashes;
use crate::ink::Marker;
use crate::markup::printable;
use crate::theme::{Shade, Theme};

/// Fonts of the text in an SVG, the first the one that bitmaps have.
pub(crate) const FONTS: &str = "DejaVu Sans, Verdana, Liberation Sans, Arial, sans-serif";

/// What is drawn on.
pub(crate) struct Canvas {
    scene: Scene,
    theme: Theme,
    medium: Medium,
}

/// What becomes of a canvas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Medium {
    Svg,
    Bitmap,
}

/// Which part of a text is at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// Text at a place.
#[derive(Clone, Debug)]
pub(crate) struct Label<'a> {
    pub(crate) text: &'a str,
    /// Place of the anchor on the base line \[px\].
    pub(crate) at: [f64; 2],
    pub(crate) size: u32,
    pub(crate) anchor: Anchor,
    /// Whether it goes upwards.
    pub(crate) upwards: bool,
    /// Whether it is bold; text that goes upwards is not.
    pub(crate) bold: bool,
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pen {
    pub(crate) shade: Shade,
    pub(crate) width: f64,
    pub(crate) dash: &'static [f64],
}

impl Pen {
    pub(crate) const fn solid(shade: Shade, width: f64) -> Self {
        Self { shade, width, dash: &[] }
    }
}

impl Canvas {
    /// An empty canvas of a size \[px\].
    pub(crate) fn new([width, height]: [f64; 2], theme: Theme, medium: Medium) -> Self {
        let mut scene = Scene::new(width, height).with_background(Some(Shade::BACKGROUND.color(theme)));
        scene.font_family = Some(FONTS.to_owned());
        scene.text_color = Some(Shade::TEXT.color(theme).to_owned());
        Self { scene, theme, medium }
    }

    /// A line through points.
    pub(crate) fn line(&mut self, points: &[[f64; 2]], pen: &Pen) {
        match self.medium {
            Medium::Bitmap => {
                for dash in dashes(points, pen.dash, pen.width) {
                    self.stroke(&dash, pen, None);
                }
            }
            Medium::Svg => {
                let pattern: Vec<String> = pen.dash.iter().map(f64::to_string).collect();
                self.stroke(points, pen, (!pattern.is_empty()).then(|| pattern.join(" ")));
            }
        }
    }

    fn stroke(&mut self, points: &[[f64; 2]], pen: &Pen, dash: Option<String>) {
        self.scene.add(Primitive::PolyLine {
            points: points.iter().map(|&[x, y]| (rounded(x), rounded(y))).collect(),
            stroke: self.color(pen.shade),
            stroke_width: pen.width,
            stroke_dasharray: dash,
        });
    }

    /// A filled polygon.
    pub(crate) fn polygon(&mut self, corners: &[[f64; 2]], shade: Shade, opacity: f64) {
        let data = PathData {
            d: path(corners),
            fill: Some(self.color(shade)),
            stroke: Color::None,
            stroke_width: 0.0,
            opacity: Some(opacity),
            stroke_dasharray: None,
        };
        self.scene.add(Primitive::Path(Box::new(data)));
    }

    /// A marker with a rim in the color of the background, which keeps neighbors apart.
    pub(crate) fn marker(&mut self, marker: Marker, [x, y]: [f64; 2], size: f64, shade: Shade) {
        const RIM: f64 = 0.9;
        let rim = Some(self.color(Shade::BACKGROUND));
        let bars = |turn: f64| {
            [0.0, 0.25].map(|quarter| {
                let (sin, cos) = (TAU * (turn + quarter)).sin_cos();
                [[x - size * cos, y - size * sin], [x + size * cos, y + size * sin]]
            })
        };
        match marker {
            Marker::Circle => self.scene.add(Primitive::Circle {
                cx: rounded(x),
                cy: rounded(y),
                r: size,
                fill: self.color(shade),
                fill_opacity: None,
                stroke: rim,
                stroke_width: Some(RIM),
            }),
            Marker::Cross | Marker::Plus => {
                let turn = if marker == Marker::Cross { 0.125 } else { 0.0 };
                for bar in bars(turn) {
                    self.line(&bar, &Pen::solid(shade, 2.0));
                }
            }
            _ => {
                let corners: Vec<[f64; 2]> =
                    corners(marker).iter().map(|&[dx, dy]| [x + size * dx, y + size * dy]).collect();
                let data = PathData {
                    d: path(&corners),
                    fill: Some(self.color(shade)),
                    stroke: self.color(Shade::BACKGROUND),
                    stroke_width: RIM,
                    opacity: None,
                    stroke_dasharray: None,
                };
                self.scene.add(Primitive::Path(Box::new(data)));
            }
        }
    }

    /// Text in the color of text.
    pub(crate) fn text(&mut self, label: &Label<'_>) {
        // A dollar begins a formula in kuva's text
        let text = printable(label.text);
        let content = text.replace('$', "\\$");
        let anchor = match label.anchor {
            Anchor::Start => TextAnchor::Start,
            Anchor::Middle => TextAnchor::Middle,
            Anchor::End => TextAnchor::End,
        };
        let [x, y] = label.at.map(rounded);
        let (size, color) = (label.size, Some(self.color(Shade::TEXT)));
        self.scene.add(if label.bold {
            // Plain text of kuva is never bold in a bitmap
            let spans = vec![TextSpan { bold: true, ..TextSpan::plain(text) }];
            Primitive::RichText { x, y, spans, size, anchor, color }
        } else {
            let rotate = label.upwards.then_some(-90.0);
            Primitive::Text { x, y, content, size, anchor, rotate, bold: false, color }
        });
    }

    /// The canvas as an SVG document.
    pub(crate) fn svg(&self) -> String {
        SvgBackend::default().render_scene(&self.scene)
    }

    /// The canvas as a PNG, with so many pixels for one.
    pub(crate) fn png(&self, scale: f32) -> Result<Vec<u8>, String> {
        RasterBackend::new().with_scale(scale).render_scene(&self.scene)
    }

    fn color(&self, shade: Shade) -> Color {
        Color::from(shade.color(self.theme))
    }
}

/// To a hundredth of a pixel.
fn rounded(x: f64) -> f64 {
    (100.0 * x).round() / 100.0
}

/// A closed path.
fn path(corners: &[[f64; 2]]) -> String {
    let mut path = String::new();
    for (i, &[x, y]) in corners.iter().enumerate() {
        path += if i == 0 { "M" } else { "L" };
        path += &format!("{} {} ", rounded(x), rounded(y));
    }
    path + "Z"
}

/// The corners of a marker of size 1, of about the same area for all.
fn corners(marker: Marker) -> Vec<[f64; 2]> {
    let regular = |count: u32, radius: f64, turn: f64| -> Vec<[f64; 2]> {
        let angle = |i: u32| TAU * (f64::from(i) / f64::from(count) + turn);
        (0..count).map(|i| angle(i).sin_cos()).map(|(sin, cos)| [radius * sin, -radius * cos]).collect()
    };
    match marker {
        Marker::Triangle => regular(3, 1.35, 0.0),
        Marker::TriangleDown => regular(3, 1.35, 0.5),
        Marker::Square => regular(4, 1.25, 0.125),
        Marker::Diamond => regular(4, 1.35, 0.0),
        Marker::Pentagon => regular(5, 1.2, 0.0),
        Marker::Star => {
            let (outer, inner) = (regular(5, 1.6, 0.0), regular(5, 0.65, 0.1));
            outer.into_iter().zip(inner).flat_map(|(a, b)| [a, b]).collect()
        }
        _ => regular(6, 1.15, 0.0),
    }
}
