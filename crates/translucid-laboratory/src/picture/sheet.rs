//! A contact sheet: pictures and their maps in columns, with words.

use std::io;

use super::raster::{DIFFERENCE_RANGE, Raster, difference_color, flip_color};
use crate::chart::Shade;
use crate::drawing::bitmap::Bitmap;
use crate::drawing::canvas::{Anchor, Canvas, Label, Pen};
use crate::drawing::text::Font;
use crate::png_bytes::encode_png;

/// Pixels of the sheet for one of the layout.
const SCALE: f32 = 2.0;
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
    /// The sheet as a PNG.
    ///
    /// # Errors
    /// There is no column, a picture is empty, or the sheet cannot be drawn.
    pub fn png(&self) -> io::Result<Vec<u8>> {
        let layout = Layout::new(self).ok_or_else(|| io::Error::other("there is no picture to show"))?;
        let mut canvas = Canvas::new(layout.size());
        self.draw_title(&mut canvas);
        for (index, column) in self.columns.iter().enumerate() {
            layout.draw_words(&mut canvas, index, column);
        }
        for band in 0..layout.bands {
            self.draw_headings(&mut canvas, &layout, band);
        }
        draw_legend(&mut canvas, layout.legend(), &self.judge);

        let mut bitmap = Bitmap::new(&canvas, SCALE)?;
        for (index, column) in self.columns.iter().enumerate() {
            layout.paste(&mut bitmap, index, column);
        }
        paste_bars(&mut bitmap, layout.legend());
        encode_png(bitmap.size(), &bitmap.codes(), None)
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

    /// Draws the name and the lines below a picture, and the frames of its maps.
    fn draw_words(&self, canvas: &mut Canvas, index: usize, column: &SheetColumn) {
        let (left, band) = (self.left(index), index / self.abreast);
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

    fn paste(&self, bitmap: &mut Bitmap, index: usize, column: &SheetColumn) {
        let (left, band) = (self.left(index), index / self.abreast);
        let [width, height] = self.picture.map(pixels);
        let mut paste = |raster: &Raster, top: f64| {
            bitmap.paste([pixels(left), pixels(top)], width, raster.resized(width, height).codes());
        };
        paste(&column.picture, self.top(band));
        for (row, map) in column.maps.iter().flatten().enumerate() {
            paste(map, self.map_top(band, row));
        }
    }
}

/// Pixels of the sheet for a length of the layout.
fn pixels(length: f64) -> usize {
    (length * f64::from(SCALE)).round() as usize
}

/// The words of both scales of colors.
fn draw_legend(canvas: &mut Canvas, top: f64, judge: &str) {
    let percent = (100.0 * DIFFERENCE_RANGE).round();
    let scales = [
        (0.0, [String::from("0"), String::from("1")], String::from("ꟻLIP")),
        (
            BAR[0] + 60.0,
            [format!("−{percent} %"), format!("+{percent} %")],
            format!("luminance against {judge}"),
        ),
    ];
    for (offset, ends, title) in &scales {
        let left = MARGIN + offset;
        canvas.text(Label { text: title, at: [left, top + 14.0], ..PLAIN });
        let below = top + 24.0 + BAR[1] + 18.0;
        canvas.text(Label { text: &ends[0], at: [left, below], ..PLAIN });
        canvas.text(Label { text: &ends[1], at: [left + BAR[0], below], anchor: Anchor::End, ..PLAIN });
    }
}

/// The colors of both scales.
fn paste_bars(bitmap: &mut Bitmap, top: f64) {
    let [width, height] = BAR.map(pixels);
    let bar = |color: &dyn Fn(f32) -> [f32; 3]| {
        let row: Vec<[f32; 3]> = (0..width).map(|x| color((x as f32 + 0.5) / width as f32)).collect();
        Raster::new(width, height, row.repeat(height))
    };
    let difference = |part: f32| difference_color((2.0 * part - 1.0) * DIFFERENCE_RANGE);
    for (offset, raster) in [(0.0, bar(&flip_color)), (BAR[0] + 60.0, bar(&difference))] {
        bitmap.paste([pixels(MARGIN + offset), pixels(top + 24.0)], width, raster.codes());
    }
}

#[cfg(test)]
mod tests {
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

    /// Number of pixels of a color on the sheet, and its size.
    fn count(png: &[u8], color: [u8; 3]) -> (usize, [u32; 2]) {
        let mut reader = png::Decoder::new(io::Cursor::new(png)).read_info().unwrap();
        let mut codes = vec![0; reader.output_buffer_size().unwrap()];
        let frame = reader.next_frame(&mut codes).unwrap();
        (codes.chunks(3).filter(|code| *code == color).count(), [frame.width, frame.height])
    }

    #[test]
    fn sheet_has_every_picture_and_map_once() {
        for number in [2, 7] {
            let png = sheet(number).png().unwrap();
            let area = 680 * 408; // as many pixels as 40×24 get
            let (red, [width, height]) = count(&png, [255, 0, 0]);
            assert_eq!(red, number * area, "{number}");
            assert_eq!(count(&png, [0, 0, 255]).0, (number - 1) * area, "{number}");
            assert_eq!(count(&png, [255, 255, 0]).0, (number - 1) * area, "{number}");
            assert!(width < 4000 && height < 8000, "{width}x{height}");
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
            sheet.png().unwrap();
        }
        assert!(sheet(0).png().is_err());
        let mut empty = sheet(2);
        empty.columns[1].picture = Raster::new(0, 5, Vec::new());
        assert!(empty.png().is_err());
    }
}
