//! A picture of layers over grounds.

use std::io;

use translucid_image::CodedPicture;

use super::Color;
use crate::chart::Shade;
use crate::drawing::canvas::{Anchor, Canvas, Label, Pen};
use crate::drawing::svg::svg;
use crate::drawing::text::Font;

/// Layers over one ground.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Name of the ground.
    pub name: String,
    /// Color of the bare ground.
    pub ground: Color,
    /// Color of the layers over it.
    pub layers: Color,
    /// Lines below it.
    pub lines: Vec<String>,
}

/// A sheet of layers that lies across grounds, as on a drawdown card.
#[derive(Clone, Debug, PartialEq)]
pub struct Swatch {
    /// Its title.
    pub title: String,
    /// Lines below the title.
    pub lines: Vec<String>,
    /// Grounds from left to right.
    pub fields: Vec<Field>,
}

/// Edges of a field, and what of the ground is seen beside the sheet \[px\].
const WIDTH: usize = 280;
const HEIGHT: usize = 240;
const BARE: usize = 36;
const MARGIN: f64 = 28.0;
const LINE: f64 = 20.0;
const SMALL: Font = Font::regular(14.0);
const PLAIN: Label<'_> = Label { text: "", at: [0.0; 2], font: SMALL, anchor: Anchor::Start, upwards: false };

impl Swatch {
    /// The sheet and its grounds as a PNG, whose text "Description" has the lines.
    ///
    /// # Errors
    /// There is no field.
    pub fn png(&self) -> io::Result<Vec<u8>> {
        let width = WIDTH * self.fields.len();
        let code = |x: usize, y: usize| {
            let field = &self.fields[x / WIDTH];
            let is_bare = |at: usize, edge: usize| !(BARE..edge - BARE).contains(&at);
            let color = if is_bare(x, width) || is_bare(y, HEIGHT) { field.ground } else { field.layers };
            color.display().map(|value| (value * 255.0).round() as u8)
        };
        let row = |y: usize| (0..width).flat_map(move |x| code(x, y));
        let codes: Vec<u8> = (0..HEIGHT).flat_map(row).collect();
        let software = concat!("translucid ", env!("CARGO_PKG_VERSION"));
        CodedPicture::rgb([width, HEIGHT], &codes)
            .with_text("Software", software)
            .with_text("Title", &self.title)
            .with_text("Description", &self.description("\n"))
            .encode()
    }

    /// The same as an SVG document with its values in words.
    ///
    /// # Errors
    /// There is no field.
    pub fn svg(&self) -> io::Result<String> {
        let count = self.fields.len();
        let card = [(WIDTH * count) as f64, HEIGHT as f64];
        let most = self.fields.iter().map(|field| field.lines.len()).max().unwrap_or(0);
        let width = card[0].max(2.0 * WIDTH as f64);
        let top = MARGIN + 36.0 + LINE * self.lines.len() as f64;
        let bottom = top + card[1] + LINE * (most + 1) as f64;
        let mut canvas = Canvas::new([width + 2.0 * MARGIN, bottom + MARGIN]);
        let title = Font::bold(22.0).wrap(&self.title, width, 1).concat();
        canvas.text(Label { text: &title, at: [MARGIN, MARGIN + 18.0], font: Font::bold(22.0), ..PLAIN });
        for (i, line) in self.lines.iter().enumerate() {
            let line = SMALL.wrap(line, width, 1).concat();
            canvas.text(Label { text: &line, at: [MARGIN, MARGIN + 44.0 + LINE * i as f64], ..PLAIN });
        }
        canvas.picture(self.png()?, [MARGIN, top], card);
        let [right, below] = [MARGIN + card[0], top + card[1]];
        let corners = [[MARGIN, top], [right, top], [right, below], [MARGIN, below], [MARGIN, top]];
        canvas.line(&corners, &Pen::solid(Shade::FRAME, 1.0));
        for (i, field) in self.fields.iter().enumerate() {
            let left = MARGIN + (WIDTH * i) as f64 + 2.0;
            let name = Font::bold(14.0).wrap(&field.name, WIDTH as f64 - 12.0, 1).concat();
            canvas.text(Label {
                text: &name,
                at: [left, below + LINE + 4.0],
                font: Font::bold(14.0),
                ..PLAIN
            });
            for (j, line) in field.lines.iter().enumerate() {
                let at = [left, below + LINE * (j + 2) as f64 + 4.0];
                canvas.text(Label { text: line, at, ..PLAIN });
            }
        }
        Ok(svg(&canvas, &self.title, &self.description(" ")))
    }

    fn description(&self, separator: &str) -> String {
        let fields = self.fields.iter().map(|field| format!("{}: {}.", field.name, field.lines.join("; ")));
        self.lines.iter().cloned().chain(fields).collect::<Vec<_>>().join(separator)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colorimetry::{Colorimeter, Illuminant, Observer};

    fn swatch(count: usize) -> Swatch {
        let eye = Colorimeter::new(Observer::TwoDegrees, Illuminant::D65);
        let field = |i: usize| Field {
            name: format!("over {i} <"),
            ground: Color::new(&eye, &[i as f64]),
            layers: Color::new(&eye, &[0.2, 0.4, 0.6]),
            lines: vec![String::from("L*a*b* 1 2 3")],
        };
        let lines = vec![String::from("TP 3 & more")];
        Swatch { title: String::from("stack.toml"), lines, fields: (0..count).map(field).collect() }
    }

    #[test]
    fn swatch_shows_colors_and_values() {
        let png = swatch(2).png().unwrap();
        let mut reader = png::Decoder::new(io::Cursor::new(png)).read_info().unwrap();
        let mut codes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut codes).unwrap();
        let at = |x: usize, y: usize| &codes[3 * (2 * WIDTH * y + x)..][..3];
        assert_eq!([at(0, 0), at(2 * WIDTH - 1, HEIGHT / 2)], [[0; 3], [255; 3]]);
        for x in [BARE, WIDTH - 1, WIDTH, 2 * WIDTH - BARE - 1] {
            assert_eq!(at(x, HEIGHT / 2), [124, 170, 203]);
        }
        let text = reader.info().utf8_text.iter().find(|text| text.keyword == "Description").unwrap();
        assert!(text.get_text().unwrap().contains("over 1 <: L*a*b* 1 2 3."));
    }

    #[test]
    fn swatch_is_an_svg_of_any_number_of_fields() {
        for count in 1..=3 {
            let svg = swatch(count).svg().unwrap();
            let document = roxmltree::Document::parse(&svg).unwrap();
            let texts = document
                .descendants()
                .filter(|node| node.has_tag_name(("http://www.w3.org/2000/svg", "text")));
            assert_eq!(texts.count(), 2 + 2 * count);
        }
        assert!(swatch(0).svg().is_err());
    }
}
