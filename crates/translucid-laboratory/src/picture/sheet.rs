//! A contact sheet: pictures and their maps in columns, with words.

use std::io;

use super::raster::{DIFFERENCE_RANGE, Raster, difference_color, flip_color};
use crate::chart::Shade;
use crate::drawing::canvas::{Anchor, Canvas, Label, Pen};
use crate::drawing::svg::svg;
use crate::drawing::text::Font;

/// Width of a column, and the greatest height of a picture \[px\].
const COLUMN: f64 = 340.0;
const TALLEST: f64 = 480.0;
/// Between columns, and around everything \[px\].
const GAP: f64 = 18.0;
const MARGIN: f64 = 28.0;
/// Most columns beside each other.
const ABREAST: usize = 5;
/// Fonts, and the height of a line of the small one \[px\].
const TITLE: Font = Font::bold(22.0);
const NAME: Font = Font::bold(16.0);
const SMALL: Font = Font::regular(14.0);
const LINE: f64 = 20.0;
/// Height of the heading above a row of pictures \[px\].
const HEADING: f64 = 30.0;
/// Size of a scale of colors, and room for it with its words \[px\].
const BAR: [f64; 2] = [260.0, 14.0];
const LEGEND: f64 = 74.0;

/// Column of a sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct SheetColumn {
    /// Its name.
    pub name: String,
    /// Lines below the picture.
    pub lines: Vec<String>,
    /// The picture.
    pub picture: Raster,
    /// Its ꟻLIP map and its map of relative differences; none for the picture that the others are judged by.
    pub maps: Option<[Raster; 2]>,
}

/// Pictures of one size beside each other, with their maps below them.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// Its title.
    pub title: String,
    /// A line below the title.
    pub subtitle: String,
    /// Name of the picture that the others are judged by.
    pub judge: String,
    /// The columns, from left to right; after some five a new band begins below.
    pub columns: Vec<SheetColumn>,
}

impl Sheet {
    /// The sheet as an SVG document with the pictures inside, which needs no other file and no font of its own.
    ///
    /// # Errors
    /// There is no column, or a picture is empty or too large for a PNG.
    pub fn svg(&self) -> io::Result<String> {
        let layout = Layout::new(self).ok_or_else(|| io::Error::other("there is no picture to show"))?;
        let mut canvas = Canvas::new(layout.size());
        self.draw_title(&mut canvas);
        for (index, column) in self.columns.iter().enumerate() {
            layout.draw(&mut canvas, index, column)?;
        }
        for band in 0..layout.bands {
            self.draw_headings(&mut canvas, &layout, band);
        }
        draw_legend(&mut canvas, layout.legend(), &self.judge)?;
        Ok(svg(&canvas, &self.title, &self.subtitle))
    }

    fn draw_title(&self, canvas: &mut Canvas) {
        let at = [MARGIN, MARGIN + 18.0];
        canvas.text(Label { text: &self.title, at, font: TITLE, ..PLAIN });
        canvas.text(Label { text: &self.subtitle, at: [MARGIN, MARGIN + 44.0], ..PLAIN });
    }

    /// Writes above each row of maps what it shows.
    fn draw_headings(&self, canvas: &mut Canvas, layout: &Layout, band: usize) {
        let judge = &self.judge;
        let words = [
            format!("ꟻLIP: what a viewer sees who flips between the picture and {judge}"),
            format!("Darker (blue) or brighter (orange) than {judge}"),
        ];
        for (row, words) in words.iter().enumerate() {
            let top = layout.map_top(band, row);
            canvas.text(Label { text: words, at: [MARGIN, top - 10.0], ..PLAIN });
        }
    }
}

/// Small text that begins at its place.
const PLAIN: Label<'_> = Label { text: "", at: [0.0; 2], font: SMALL, anchor: Anchor::Start, upwards: false };

/// Places of everything \[px of the layout\].
struct Layout {
    /// Columns beside each other.
    abreast: usize,
    bands: usize,
    /// Size of every picture.
    picture: [f64; 2],
    /// Lines of text below a picture, its name included.
    lines: usize,
}

impl Layout {
    fn new(sheet: &Sheet) -> Option<Self> {
        let first = &sheet.columns.first()?.picture;
        let [width, height] = [first.width(), first.height()];
        if sheet.columns.iter().any(|column| column.picture.width() * column.picture.height() == 0) {
            return None;
        }
        let scale = (COLUMN / width as f64).min(TALLEST / height as f64);
        let picture = [width, height].map(|edge| (edge as f64 * scale).round().max(1.0));
        let bands = sheet.columns.len().div_ceil(ABREAST);
        let lines = 1 + sheet.columns.iter().map(|column| column.lines.len()).max()?;
        Some(Self { abreast: sheet.columns.len().div_ceil(bands), bands, picture, lines })
    }

    /// Size of the sheet: wide enough for its title and the legend.
    fn size(&self) -> [f64; 2] {
        let columns = self.abreast.max(2) as f64;
        let width = 2.0 * MARGIN + columns * COLUMN + (columns - 1.0) * GAP;
        [width, self.legend() + LEGEND + MARGIN]
    }

    /// Height of a band: the pictures with their words, and two rows of maps.
    fn band(&self) -> f64 {
        3.0 * self.picture[1] + LINE * self.lines as f64 + 2.0 * HEADING + 40.0
    }

    /// Upper edge of the pictures of a band.
    fn top(&self, band: usize) -> f64 {
        MARGIN + 66.0 + band as f64 * self.band()
    }

    /// Upper edge of a row of maps.
    fn map_top(&self, band: usize, row: usize) -> f64 {
        let words = 12.0 + LINE * self.lines as f64;
        self.top(band) + self.picture[1] + words + HEADING + row as f64 * (self.picture[1] + HEADING)
    }

    /// Upper edge of the legend.
    fn legend(&self) -> f64 {
        self.top(self.bands)
    }

    fn left(&self, index: usize) -> f64 {
        MARGIN + (index % self.abreast) as f64 * (COLUMN + GAP)
    }

    /// Draws a picture with its name and lines below it, and its maps in their frames.
    fn draw(&self, canvas: &mut Canvas, index: usize, column: &SheetColumn) -> io::Result<()> {
        let (left, band) = (self.left(index), index / self.abreast);
        canvas.picture(column.picture.png()?, [left, self.top(band)], self.picture);
        for (row, map) in column.maps.iter().flatten().enumerate() {
            canvas.picture(map.png()?, [left, self.map_top(band, row)], self.picture);
        }
        let top = self.top(band) + self.picture[1];
        let name = NAME.wrap(&column.name, COLUMN, 1).concat();
        canvas.text(Label { text: &name, at: [left, top + LINE], font: NAME, ..PLAIN });
        for (i, line) in column.lines.iter().enumerate() {
            let line = SMALL.wrap(line, COLUMN, 1).concat();
            canvas.text(Label { text: &line, at: [left, top + LINE * (i + 2) as f64], ..PLAIN });
        }
        for row in 0..2 {
            let words = if column.maps.is_none() { "the judge" } else { "" };
            self.draw_frame(canvas, [left, self.map_top(band, row)], words);
        }
        Ok(())
    }

    /// A frame around a map, which may have the color of the sheet, or around words in its place.
    fn draw_frame(&self, canvas: &mut Canvas, [left, top]: [f64; 2], words: &str) {
        let [right, bottom] = [left + self.picture[0], top + self.picture[1]];
        let corners = [[left, top], [right, top], [right, bottom], [left, bottom], [left, top]];
        canvas.line(&corners, &Pen::solid(Shade::GRID, 2.0));
        let at = [0.5 * (left + right), 0.5 * (top + bottom) + 5.0];
        if self.picture[1] > LINE {
            canvas.text(Label { text: words, at, anchor: Anchor::Middle, ..PLAIN });
        }
    }
}

/// Both scales of colors with their words.
fn draw_legend(canvas: &mut Canvas, top: f64, judge: &str) -> io::Result<()> {
    let difference = |part: f32| difference_color((2.0 * part - 1.0) * DIFFERENCE_RANGE);
    let percent = (100.0 * DIFFERENCE_RANGE).round();
    let scales = [
        (0.0, bar(flip_color), [String::from("0"), String::from("1")], String::from("ꟻLIP")),
        (
            BAR[0] + 60.0,
            bar(difference),
            [format!("−{percent} %"), format!("+{percent} %")],
            format!("luminance against {judge}"),
        ),
    ];
    for (offset, bar, ends, title) in &scales {
        let left = MARGIN + offset;
        canvas.picture(bar.png()?, [left, top + 24.0], BAR);
        canvas.text(Label { text: title, at: [left, top + 14.0], ..PLAIN });
        let below = top + 24.0 + BAR[1] + 18.0;
        canvas.text(Label { text: &ends[0], at: [left, below], ..PLAIN });
        canvas.text(Label { text: &ends[1], at: [left + BAR[0], below], anchor: Anchor::End, ..PLAIN });
    }
    Ok(())
}

/// Colors from one end of a scale to the other.
fn bar(color: impl Fn(f32) -> [f32; 3]) -> Raster {
    const STEPS: usize = 256;
    let colors = (0..STEPS).map(|step| color((step as f32 + 0.5) / STEPS as f32));
    Raster::new(STEPS, 1, colors.collect())
}

#[cfg(test)]
mod tests {
    use base64::Engine;
    use base64::engine::general_purpose::STANDARD;

    use super::*;

    fn column(name: &str, color: [f32; 3], is_judge: bool) -> SheetColumn {
        let flat = |color| Raster::new(40, 24, vec![color; 40 * 24]);
        SheetColumn {
            name: name.to_owned(),
            lines: vec![String::from("1.0 s"), String::from("relMSE 0.1")],
            picture: flat(color),
            maps: (!is_judge).then(|| [flat([0.0, 0.0, 1.0]), flat([1.0, 1.0, 0.0])]),
        }
    }

    fn sheet(count: usize) -> Sheet {
        let columns = (0..count).map(|i| column(&format!("model-{i}"), [1.0, 0.0, 0.0], i == 0)).collect();
        let [title, subtitle, judge] = ["Side by side", "8 samples", "model-0"].map(String::from);
        Sheet { title, subtitle, judge, columns }
    }

    #[test]
    fn sheet_has_every_picture_and_map_once() {
        for number in [2, 7] {
            let svg = sheet(number).svg().unwrap();
            let document = roxmltree::Document::parse(&svg).unwrap();
            let images = || {
                document
                    .descendants()
                    .filter(|node| node.has_tag_name(("http://www.w3.org/2000/svg", "image")))
            };
            // Pictures, two maps for each but the judge, two scales
            assert_eq!(images().count(), number + 2 * (number - 1) + 2);
            let places: std::collections::HashSet<_> =
                images().map(|image| (image.attribute("x"), image.attribute("y"))).collect();
            assert_eq!(places.len(), images().count());
            let png = sheet(number).columns[0].picture.png().unwrap();
            assert_eq!(svg.matches(&STANDARD.encode(png)).count(), number);
        }
    }

    #[test]
    fn sheet_takes_pictures_of_any_shape_and_names_of_any_length() {
        for [width, height] in [[1, 1], [1000, 1], [1, 1000], [1200, 900]] {
            let mut sheet = sheet(2);
            for column in &mut sheet.columns {
                column.picture = Raster::new(width, height, Vec::new());
                column.name = "long-".repeat(100);
            }
            sheet.svg().unwrap();
        }
        assert!(sheet(0).svg().is_err());
        let mut empty = sheet(2);
        empty.columns[1].picture = Raster::new(0, 5, Vec::new());
        assert!(empty.svg().is_err());
    }
}
