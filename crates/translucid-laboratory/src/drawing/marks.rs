//! The marks of series on a plot.

use super::area::Area;
use super::canvas::{Canvas, Pen};
use super::plot::Plot;
use crate::chart::Shade;
use crate::chart::{Mark, Series};

/// Width of the outline of a histogram, which is never dashed: dashes and steps would be hard to tell apart \[px\].
pub(crate) const STEP: f64 = 1.5;
/// Radius of markers \[px\].
pub(crate) const MARKER: f64 = 3.8;
pub(crate) const BAND_OPACITY: f64 = 0.22;
/// Half width of the caps of an error bar \[px\].
const CAP: f64 = 3.0;
/// Number of points from which markers get smaller.
const MANY: f64 = 40.0;

impl Plot<'_> {
    /// Draws a series, but for its words.
    pub(crate) fn draw(&self, canvas: &mut Canvas, series: &Series) {
        let style = series.ink.style();
        let pen = Pen { shade: style.shade, width: style.width, dash: style.dash };
        match &series.mark {
            Mark::Line => self.draw_line(canvas, &series.points, &pen),
            Mark::Steps => {
                let outline = self.outline(&series.points);
                self.fill(canvas, &outline, style.shade);
                self.draw_line(canvas, &outline, &Pen::solid(style.shade, STEP));
            }
            Mark::Band(upper) => self.draw_band(canvas, &series.points, upper, style.shade),
            Mark::PointsWithErrors(errors) => {
                for (&[x, y], &error) in series.points.iter().zip(errors) {
                    self.draw_error(canvas, [x, y], error, style.shade);
                }
                self.draw_markers(canvas, series);
            }
            Mark::Points | Mark::LabelledPoints(_) => self.draw_markers(canvas, series),
        }
    }

    fn draw_line(&self, canvas: &mut Canvas, points: &[[f64; 2]], pen: &Pen) {
        for run in self.runs(points) {
            for piece in self.area.pieces(&run) {
                canvas.line(&piece, pen);
            }
        }
    }

    /// The runs of points that have a place, each at least two points long.
    fn runs(&self, points: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
        let places: Vec<Option<[f64; 2]>> = points.iter().map(|&point| self.place(point)).collect();
        let runs = places.split(Option::is_none).map(|run| run.iter().flatten().copied().collect());
        runs.filter(|run: &Vec<_>| run.len() > 1).collect()
    }

    /// The outline of a histogram: its steps, from and to the foot of the plot.
    fn outline(&self, bins: &[[f64; 2]]) -> Vec<[f64; 2]> {
        // A bin whose height has no place (an empty one on a logarithmic axis) reaches down to the foot
        let foot = if self.axes[1].range.is_none() && self.spans[1].contains(0.0) {
            0.0
        } else {
            self.spans[1].range[0]
        };
        let height = |y: f64| if self.axes[1].has(y) { y } else { foot };
        let mut outline = Vec::new();
        let mut last = foot;
        for ends in bins.windows(2) {
            let [[left, y], [right, _]] = [ends[0], ends[1]];
            outline.extend([[left, last], [left, height(y)], [right, height(y)]]);
            last = height(y);
        }
        if let Some(&[right, _]) = bins.last().filter(|_| bins.len() > 1) {
            outline.push([right, foot]);
        }
        outline
    }

    fn draw_band(&self, canvas: &mut Canvas, lower: &[[f64; 2]], upper: &[f64], shade: Shade) {
        let pairs: Vec<Option<[[f64; 2]; 2]>> = lower
            .iter()
            .zip(upper)
            .map(|(&[x, y], &up)| Some([self.place([x, y])?, self.place([x, up])?]))
            .collect();
        for run in pairs.split(Option::is_none) {
            let run: Vec<[[f64; 2]; 2]> = run.iter().flatten().copied().collect();
            let there = run.iter().map(|pair| pair[0]);
            let back = run.iter().rev().map(|pair| pair[1]);
            let corners = self.area.part_of_polygon(&there.chain(back).collect::<Vec<_>>());
            if corners.len() > 2 {
                canvas.polygon(corners, shade, BAND_OPACITY);
            }
        }
    }

    /// Fills the area below an outline.
    fn fill(&self, canvas: &mut Canvas, outline: &[[f64; 2]], shade: Shade) {
        for run in self.runs(outline) {
            let corners = self.area.part_of_polygon(&run);
            if corners.len() > 2 {
                canvas.polygon(corners, shade, BAND_OPACITY);
            }
        }
    }

    fn draw_markers(&self, canvas: &mut Canvas, series: &Series) {
        let style = series.ink.style();
        let places: Vec<[f64; 2]> = self.places(series).collect();
        let crowd = (MANY / places.len().max(1) as f64).sqrt().clamp(0.6, 1.0);
        for place in places {
            canvas.marker(style.marker, place, crowd * MARKER, style.shade);
        }
    }

    /// Draws the bar of ± the error.
    fn draw_error(&self, canvas: &mut Canvas, [x, y]: [f64; 2], error: f64, shade: Shade) {
        let Some([place, _]) = self.place([x, y]).filter(|_| error.is_finite() && error > 0.0) else {
            return;
        };
        let Area { left, top, right, bottom } = self.area;
        if !(left..=right).contains(&place) {
            return;
        }
        // A bar that reaches beyond every place on the axis ends at the edge
        let end =
            |value: f64, edge: f64| if self.axes[1].has(value) { self.spans[1].place(value) } else { edge };
        let ends = [end(y + error, top), end(y - error, bottom)];
        if ends[0] <= bottom && ends[1] >= top {
            error_bar(canvas, place, ends.map(|y| y.clamp(top, bottom)), shade);
        }
    }
}

/// A bar with caps.
pub(crate) fn error_bar(canvas: &mut Canvas, x: f64, [top, bottom]: [f64; 2], shade: Shade) {
    let pen = Pen::solid(shade, 1.2);
    canvas.line(&[[x, top], [x, bottom]], &pen);
    for y in [top, bottom] {
        canvas.line(&[[x - CAP, y], [x + CAP, y]], &pen);
    }
}
