//! The legend: what each ink of a chart stands for.

use super::canvas::{Anchor, Canvas, Label, Pen};
use super::text;
use crate::chart::{Chart, Mark};
use crate::ink::Style;

/// Font size \[px\].
pub(crate) const SIZE: u32 = 12;
/// Length of a sample of a line \[px\].
const SAMPLE: f64 = 36.0;
/// From a sample to its text \[px\].
const GAP: f64 = 8.0;
/// From line to line of an entry, and from entry to entry \[px\].
const LINE: f64 = 15.0;
const BETWEEN: f64 = 6.0;
/// Widest text before it is broken \[px\].
const WIDEST: f64 = 158.0;

/// An entry: the marks of all series with the same label and ink.
struct Entry {
    lines: Vec<String>,
    style: Style,
    has_line: bool,
    has_marker: bool,
    has_bar: bool,
    is_band: bool,
    is_histogram: bool,
}

/// What stands beside the plot.
pub(crate) struct Legend {
    entries: Vec<Entry>,
}

impl Legend {
    pub(crate) fn new(chart: &Chart) -> Self {
        let mut entries: Vec<(&str, crate::Ink, Entry)> = Vec::new();
        for series in chart.series.iter().filter(|series| !series.label.trim().is_empty()) {
            let known =
                entries.iter().position(|(label, ink, _)| *label == series.label && *ink == series.ink);
            let index = known.unwrap_or_else(|| {
                let lines = text::at_most(text::wrap(&series.label, f64::from(SIZE), WIDEST), 3);
                let style = series.ink.style();
                let entry = Entry {
                    lines,
                    style,
                    has_line: false,
                    has_marker: false,
                    has_bar: false,
                    is_band: false,
                    is_histogram: false,
                };
                entries.push((&series.label, series.ink, entry));
                entries.len() - 1
            });
            let entry = &mut entries[index].2;
            match &series.mark {
                Mark::Line => entry.has_line = true,
                Mark::Steps => entry.is_histogram = true,
                Mark::Points | Mark::LabelledPoints(_) => entry.has_marker = true,
                Mark::PointsWithErrors(_) => [entry.has_marker, entry.has_bar] = [true; 2],
                Mark::Band(_) => entry.is_band = true,
            }
        }
        Self { entries: entries.into_iter().map(|(_, _, entry)| entry).collect() }
    }

    /// Width \[px\], 0 where there is nothing to say.
    pub(crate) fn width(&self) -> f64 {
        let lines = self.entries.iter().flat_map(|entry| &entry.lines);
        let widest = lines.map(|line| text::width(line, f64::from(SIZE))).fold(0.0, f64::max);
        if self.entries.is_empty() { 0.0 } else { SAMPLE + GAP + widest }
    }

    /// Draws the entries from a place downwards, as many as end above `bottom`.
    pub(crate) fn draw(&self, canvas: &mut Canvas, [x, top]: [f64; 2], bottom: f64) {
        let mut y = top;
        for (i, entry) in self.entries.iter().enumerate() {
            let height = entry.lines.len() as f64 * LINE;
            if y + height > bottom {
                let more = format!("and {} more", self.entries.len() - i);
                draw_line(canvas, &more, [x + SAMPLE + GAP, y + 0.75 * LINE]);
                return;
            }
            entry.draw(canvas, [x, y + 0.5 * LINE]);
            for (k, line) in entry.lines.iter().enumerate() {
                draw_line(
                    canvas,
                    line,
                    [x + SAMPLE + GAP, y + (k as f64 + 0.5) * LINE + 0.36 * f64::from(SIZE)],
                );
            }
            y += height + BETWEEN;
        }
    }
}

fn draw_line(canvas: &mut Canvas, text: &str, at: [f64; 2]) {
    canvas.text(&Label { text, at, size: SIZE, anchor: Anchor::Start, upwards: false, bold: false });
}

impl Entry {
    /// Draws the sample, from a place to the right.
    fn draw(&self, canvas: &mut Canvas, [x, y]: [f64; 2]) {
        let Style { shade, dash, marker, width, .. } = self.style;
        let middle = x + 0.5 * SAMPLE;
        if self.is_band || self.is_histogram {
            let corners = [[x, y - 6.0], [x + SAMPLE, y - 6.0], [x + SAMPLE, y + 6.0], [x, y + 6.0]];
            canvas.polygon(&corners, shade, super::BAND_OPACITY);
        }
        if self.is_histogram {
            let outline = [[x, y + 6.0], [x, y - 6.0], [x + SAMPLE, y - 6.0], [x + SAMPLE, y + 6.0]];
            canvas.line(&outline, &Pen::solid(shade, super::marks::STEP));
        }
        if self.has_line {
            canvas.line(&[[x, y], [x + SAMPLE, y]], &Pen { shade, width, dash });
        }
        if self.has_bar {
            super::marks::error_bar(canvas, middle, [y - 7.0, y + 7.0], shade);
        }
        if self.has_marker {
            canvas.marker(marker, [middle, y], super::MARKER, shade);
        }
    }
}
