//! The legend, which says what each ink of a chart stands for.

use super::canvas::{Anchor, Canvas, Label, Pen};
use super::marks;
use super::text::Font;
use crate::chart::{Chart, Mark, Series};
use crate::chart::{Ink, Style};

const FONT: Font = Font::regular(12.0);
/// Length of a sample of a line \[px\].
const SAMPLE: f64 = 36.0;
/// From a sample to its text \[px\].
const GAP: f64 = 8.0;
/// From line to line of an entry, and from entry to entry \[px\].
const LINE: f64 = 15.0;
const BETWEEN: f64 = 6.0;
/// Widest text before it is broken \[px\].
const WIDEST: f64 = 158.0;

/// The marks of all series with the same label and ink.
struct LegendEntry<'a> {
    label: &'a str,
    ink: Ink,
    lines: Vec<String>,
    marks: Vec<&'a Mark>,
}

/// Entries beside the plot.
pub(crate) struct Legend<'a> {
    entries: Vec<LegendEntry<'a>>,
}

impl<'a> Legend<'a> {
    /// The legend of all series that have a label.
    pub(crate) fn new(chart: &'a Chart) -> Self {
        let mut entries: Vec<LegendEntry<'a>> = Vec::new();
        for Series { label, ink, mark, .. } in chart.series.iter().filter(|one| !one.label.trim().is_empty())
        {
            match entries.iter_mut().find(|entry| entry.label == label && entry.ink == *ink) {
                Some(entry) => entry.marks.push(mark),
                None => {
                    let lines = FONT.wrap(label, WIDEST, 3);
                    entries.push(LegendEntry { label, ink: *ink, lines, marks: vec![mark] });
                }
            }
        }
        Self { entries }
    }

    /// Width \[px\], 0 where there is nothing to say.
    pub(crate) fn width(&self) -> f64 {
        let lines = self.entries.iter().flat_map(|entry| &entry.lines);
        let widest = lines.map(|line| FONT.width(line)).fold(0.0, f64::max);
        if self.entries.is_empty() { 0.0 } else { SAMPLE + GAP + widest }
    }

    /// Draws the entries from a place downwards, as many as end above `bottom`.
    pub(crate) fn draw(&self, canvas: &mut Canvas, [x, top]: [f64; 2], bottom: f64) {
        let write = |canvas: &mut Canvas, text: &str, y: f64| {
            let at = [x + SAMPLE + GAP, y + 0.5 * LINE + FONT.half_height()];
            canvas.text(Label { text, at, font: FONT, anchor: Anchor::Start, upwards: false });
        };
        let mut y = top;
        for (i, entry) in self.entries.iter().enumerate() {
            let height = entry.lines.len() as f64 * LINE;
            if y + height > bottom {
                return write(canvas, &format!("and {} more", self.entries.len() - i), y);
            }
            entry.draw(canvas, [x, y + 0.5 * LINE]);
            for (k, line) in entry.lines.iter().enumerate() {
                write(canvas, line, y + k as f64 * LINE);
            }
            y += height + BETWEEN;
        }
    }
}

impl LegendEntry<'_> {
    /// Draws a sample of every mark, from a place to the right.
    fn draw(&self, canvas: &mut Canvas, [x, y]: [f64; 2]) {
        let Style { shade, dash, marker, width } = self.ink.style();
        let has = |is: fn(&Mark) -> bool| self.marks.iter().any(|mark| is(mark));
        let (right, middle) = (x + SAMPLE, x + 0.5 * SAMPLE);
        let outline = [[x, y + 6.0], [x, y - 6.0], [right, y - 6.0], [right, y + 6.0]];
        if has(|mark| matches!(mark, Mark::Band(_) | Mark::Steps)) {
            canvas.polygon(outline.to_vec(), shade, marks::BAND_OPACITY);
        }
        if has(|mark| matches!(mark, Mark::Steps)) {
            canvas.line(&outline, &Pen::solid(shade, marks::STEP));
        }
        if has(|mark| matches!(mark, Mark::Line)) {
            canvas.line(&[[x, y], [right, y]], &Pen { shade, width, dash });
        }
        if has(|mark| matches!(mark, Mark::PointsWithErrors(_))) {
            marks::error_bar(canvas, middle, [y - 7.0, y + 7.0], shade);
        }
        if has(|mark| matches!(mark, Mark::Points | Mark::LabelledPoints(_) | Mark::PointsWithErrors(_))) {
            canvas.marker(marker, [middle, y], marks::MARKER, shade);
        }
    }
}
