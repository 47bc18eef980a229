//! A canvas as an SVG document.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::canvas::{Anchor, Canvas, Fill, Label, Shape};
use super::text::Weight;
use crate::chart::Shade;
use crate::markup::escape;

/// Fonts of the text, the first the one whose widths the layout goes by.
const FONTS: &str = "DejaVu Sans, Verdana, Liberation Sans, Arial, sans-serif";

/// The canvas as an SVG document with a title and a description for those who cannot see it.
///
/// Each color has an attribute of its own, which a page in dark mode replaces.
pub(crate) fn svg(canvas: &Canvas, title: &str, description: &str) -> String {
    let [width, height] = canvas.size;
    let (text, background) = (Shade::TEXT.light, Shade::BACKGROUND.light);
    let [title, description] = [title, description].map(escape);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
         height=\"{height}\" font-family=\"{FONTS}\" fill=\"{text}\" stroke-linejoin=\"round\" role=\"img\">\n\
         <title>{title}</title>\n<desc>{description}</desc>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"{background}\"/>\n"
    );
    for shape in &canvas.shapes {
        svg += &match shape {
            Shape::Line { points, pen } => {
                let pattern = pen.dash.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
                let dash = attribute("stroke-dasharray", &pattern);
                let (points, stroke) = (places(points), pen.shade.light);
                let width = pen.width;
                format!(
                    "<polyline points=\"{points}\" fill=\"none\" stroke=\"{stroke}\" stroke-width=\"{width}\"{dash}/>\n"
                )
            }
            Shape::Polygon { corners, fill } => {
                format!("<polygon points=\"{}\"{}/>\n", places(corners), filled(fill))
            }
            Shape::Disc { center, radius, fill } => {
                let ([x, y], radius) = (center.map(rounded), rounded(*radius));
                format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"{}/>\n", filled(fill))
            }
            Shape::Words { text, label } => words(text, label),
            Shape::Picture { png, at, size } => picture(png, *at, *size),
        };
    }
    svg + "</svg>\n"
}

fn words(text: &str, label: &Label<'_>) -> String {
    let [x, y] = label.at.map(rounded);
    let anchor = match label.anchor {
        Anchor::Start => "",
        Anchor::Middle => "middle",
        Anchor::End => "end",
    };
    let weight = if label.font.weight == Weight::Bold { "bold" } else { "" };
    let turn = if label.upwards { format!("rotate(-90 {x} {y})") } else { String::new() };
    let attributes = [("text-anchor", anchor), ("font-weight", weight), ("transform", &turn)];
    let attributes: String = attributes.iter().map(|(name, value)| attribute(name, value)).collect();
    let size = label.font.size;
    format!("<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\"{attributes}>{}</text>\n", escape(text))
}

/// A picture inside the document. `xlink:href` is what the oldest readers know.
fn picture(png: &[u8], at: [f64; 2], size: [f64; 2]) -> String {
    let ([x, y], [width, height]) = (at.map(rounded), size.map(rounded));
    format!(
        "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\" \
         xmlns:xlink=\"http://www.w3.org/1999/xlink\" xlink:href=\"data:image/png;base64,{}\"/>\n",
        STANDARD.encode(png)
    )
}

/// An attribute, or nothing where it has no value.
fn attribute(name: &str, value: &str) -> String {
    if value.is_empty() { String::new() } else { format!(" {name}=\"{value}\"") }
}

/// Attributes of an area.
fn filled(fill: &Fill) -> String {
    let Fill { shade, opacity, rim } = *fill;
    let opacity = if opacity < 1.0 { opacity.to_string() } else { String::new() };
    let mut attributes = format!(" fill=\"{}\"{}", shade.light, attribute("fill-opacity", &opacity));
    if rim > 0.0 {
        attributes += &format!(" stroke=\"{}\" stroke-width=\"{rim}\"", Shade::BACKGROUND.light);
    }
    attributes
}

fn places(points: &[[f64; 2]]) -> String {
    let places = points.iter().map(|point| point.map(rounded)).map(|[x, y]| format!("{x},{y}"));
    places.collect::<Vec<_>>().join(" ")
}

/// A length to a hundredth of a pixel, without a negative zero.
fn rounded(length: f64) -> f64 {
    (100.0 * length).round() / 100.0 + 0.0
}
