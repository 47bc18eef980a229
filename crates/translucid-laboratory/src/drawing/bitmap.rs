//! A canvas as pixels.

use std::io;

use tiny_skia::{Color, FillRule, Paint, Path, PathBuilder, Pixmap, Stroke, StrokeDash, Transform};
use ttf_parser::OutlineBuilder;

use super::canvas::{Anchor, Canvas, Fill, Label, Pen, Shape};
use super::text::Font;
use crate::chart::Shade;

/// Opaque pixels.
pub(crate) struct Bitmap {
    pixels: Pixmap,
    /// Pixels for one of the canvas.
    scale: f32,
}

impl Bitmap {
    /// Draws a canvas, with so many pixels for one of its own.
    ///
    /// # Errors
    /// It has no pixel, or more than memory.
    pub(crate) fn new(canvas: &Canvas, scale: f32) -> io::Result<Self> {
        let [width, height] = canvas.size.map(|length| (length * f64::from(scale)).round() as u32);
        let too_large = || io::Error::other("the picture is empty or too large");
        let pixels = Pixmap::new(width, height).ok_or_else(too_large)?;
        let mut bitmap = Self { pixels, scale };
        bitmap.pixels.fill(color(Shade::BACKGROUND, 1.0));
        for shape in &canvas.shapes {
            bitmap.draw(shape);
        }
        Ok(bitmap)
    }

    /// Width and height.
    pub(crate) fn size(&self) -> [usize; 2] {
        [self.pixels.width(), self.pixels.height()].map(|edge| edge as usize)
    }

    /// Red, green and blue of all pixels, row by row.
    pub(crate) fn codes(&self) -> Vec<u8> {
        self.pixels.data().chunks_exact(4).flat_map(|pixel| &pixel[..3]).copied().collect()
    }

    /// Sets pixels, row by row in a rectangle of a width with its upper left corner at a place; what is outside is
    /// left out.
    pub(crate) fn paste(
        &mut self,
        [left, top]: [usize; 2],
        width: usize,
        codes: impl Iterator<Item = [u8; 3]>,
    ) {
        let [own_width, height] = self.size();
        let data = self.pixels.data_mut();
        for (i, code) in codes.enumerate() {
            let (x, y) = (left + i % width, top + i / width);
            if x < own_width && y < height {
                let at = 4 * (y * own_width + x);
                data[at..at + 3].copy_from_slice(&code);
            }
        }
    }

    fn draw(&mut self, shape: &Shape) {
        match shape {
            Shape::Line { points, pen } => self.stroke(path(points).finish(), pen),
            Shape::Polygon { corners, fill } => {
                let mut path = path(corners);
                path.close();
                self.fill(path.finish(), fill);
            }
            Shape::Disc { center: [x, y], radius, fill } => {
                self.fill(PathBuilder::from_circle(*x as f32, *y as f32, *radius as f32), fill);
            }
            Shape::Words { text, label } => self.write(text, label),
        }
    }

    fn stroke(&mut self, path: Option<Path>, pen: &Pen) {
        let Some(path) = path else { return };
        let dash = pen.dash.iter().map(|length| *length as f32).collect();
        let stroke = Stroke {
            width: pen.width as f32,
            line_join: tiny_skia::LineJoin::Round,
            dash: StrokeDash::new(dash, 0.0),
            ..Stroke::default()
        };
        let paint = paint(pen.shade, 1.0);
        self.pixels.stroke_path(&path, &paint, &stroke, self.transform(), None);
    }

    fn fill(&mut self, path: Option<Path>, fill: &Fill) {
        let Some(path) = path else { return };
        let paint = paint(fill.shade, fill.opacity as f32);
        self.pixels.fill_path(&path, &paint, FillRule::Winding, self.transform(), None);
        if fill.rim > 0.0 {
            self.stroke(Some(path), &Pen::solid(Shade::BACKGROUND, fill.rim));
        }
    }

    /// Fills the glyphs of a text, one after the other.
    fn write(&mut self, text: &str, label: &Label<'_>) {
        let Label { font: Font { size, .. }, at: [x, y], .. } = *label;
        let Some(face) = label.font.face() else { return };
        let mut glyphs = Glyphs { path: PathBuilder::new(), x: 0.0 };
        for c in text.chars() {
            let glyph = face.glyph_index(c).unwrap_or_default();
            face.outline_glyph(glyph, &mut glyphs);
            glyphs.x += f32::from(face.glyph_hor_advance(glyph).unwrap_or(0));
        }
        let start = match label.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => -0.5 * glyphs.x,
            Anchor::End => -glyphs.x,
        };
        let Some(path) = glyphs.path.finish() else { return };
        let scale = size as f32 / f32::from(face.units_per_em());
        let transform = self
            .transform()
            .pre_translate(x as f32, y as f32)
            .pre_rotate(if label.upwards { -90.0 } else { 0.0 })
            .pre_scale(scale, -scale)
            .pre_translate(start, 0.0);
        let paint = paint(Shade::TEXT, 1.0);
        self.pixels.fill_path(&path, &paint, FillRule::Winding, transform, None);
    }

    fn transform(&self) -> Transform {
        Transform::from_scale(self.scale, self.scale)
    }
}

fn paint(shade: Shade, opacity: f32) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color(color(shade, opacity));
    paint
}

fn color(shade: Shade, opacity: f32) -> Color {
    let [red, green, blue] = shade.components();
    Color::from_rgba(red, green, blue, opacity).unwrap_or(Color::BLACK)
}

/// A path through points.
fn path(points: &[[f64; 2]]) -> PathBuilder {
    let mut path = PathBuilder::new();
    for (i, &[x, y]) in points.iter().enumerate() {
        let (x, y) = (x as f32, y as f32);
        if i == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
    }
    path
}

/// Outlines of glyphs beside each other, in units of the font with y upwards.
struct Glyphs {
    path: PathBuilder,
    /// Left end of the next glyph.
    x: f32,
}

impl OutlineBuilder for Glyphs {
    fn move_to(&mut self, x: f32, y: f32) {
        self.path.move_to(self.x + x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.path.line_to(self.x + x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.path.quad_to(self.x + x1, y1, self.x + x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.path.cubic_to(self.x + x1, y1, self.x + x2, y2, self.x + x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tells whether any pixel of a rectangle is dark.
    fn is_dark(bitmap: &Bitmap, [left, top, right, bottom]: [usize; 4]) -> bool {
        let (codes, width) = (bitmap.codes(), bitmap.size()[0]);
        (top..bottom).any(|y| (left..right).any(|x| codes[3 * (y * width + x)] < 100))
    }

    #[test]
    fn text_is_where_its_label_says() {
        let label = Label {
            text: "HHH",
            at: [50.0, 50.0],
            font: Font::regular(12.0),
            anchor: Anchor::Start,
            upwards: false,
        };
        let [right, left, up] =
            [label, Label { anchor: Anchor::End, ..label }, Label { upwards: true, ..label }].map(|label| {
                let mut canvas = Canvas::new([100.0, 100.0]);
                canvas.text(label);
                let bitmap = Bitmap::new(&canvas, 1.0).unwrap();
                [[60, 38, 90, 51], [10, 38, 36, 51], [38, 10, 51, 36]].map(|area| is_dark(&bitmap, area))
            });
        assert_eq!([right, left, up], [[true, false, false], [false, true, false], [false, false, true]]);
    }

    #[test]
    fn dashes_go_on_from_segment_to_segment() {
        let fine: Vec<[f64; 2]> = (0..=180).map(|i| [10.0 + f64::from(i), 5.5]).collect();
        let [solid, dashed] = [vec![fine[0], fine[180]], fine].map(|points| {
            let mut canvas = Canvas::new([200.0, 10.0]);
            canvas.line(&points, &Pen { shade: Shade::TEXT, width: 2.0, dash: &[7.0, 4.0] });
            Bitmap::new(&canvas, 1.0).unwrap().codes()
        });
        let differing = solid.iter().zip(&dashed).filter(|(a, b)| a.abs_diff(**b) > 2).count();
        assert_eq!(differing, 0);
        assert!(solid[3 * (5 * 200 + 13)] < 100 && solid[3 * (5 * 200 + 19)] > 200);
    }
}
