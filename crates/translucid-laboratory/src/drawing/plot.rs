//! The rectangle that series are drawn in, with its axes.

use super::area::Area;
use super::axis_span::Span;
use super::canvas::{Anchor, Canvas, Label, Pen};
use super::text::Font;
use super::ticks::Ticks;
use crate::chart::Shade;
use crate::chart::{Axis, Scale};
use crate::chart::{Chart, Mark, Series};

/// Font of what an axis shows.
const CAPTION: Font = Font::regular(14.0);
/// Font of the texts of ticks.
const TICK: Font = Font::regular(12.0);
/// Lengths of ticks with and without text \[px\].
const MAJOR: f64 = 6.0;
const MINOR: f64 = 3.0;
/// Room below a plot for its axis, and on its left for the caption of the other \[px\].
const FOOT: f64 = 46.0;
const SIDE: f64 = 22.0;

/// Rectangle with axes that series are drawn in.
pub(crate) struct Plot<'a> {
    pub(crate) axes: [&'a Axis; 2],
    pub(crate) spans: [Span; 2],
    pub(crate) area: Area,
    ticks: [Ticks; 2],
    /// Left edge of the caption of the vertical axis \[px\].
    side: f64,
}

impl<'a> Plot<'a> {
    /// The plot of a chart, which has its texts around it and all of the room \[px\].
    pub(crate) fn new(chart: &'a Chart, room: Area) -> Self {
        let Chart { x, y, series, .. } = chart;
        let Area { top, right, .. } = room;
        let bottom = room.bottom - FOOT;
        // The texts of the vertical axis decide where the plot begins
        let vertical = Span::new(y, numbers(series, y, 1), [bottom, top]);
        let spacing = if y.scale == Scale::Linear { 52.0 } else { 34.0 };
        let vertical_ticks = Ticks::new(&vertical, spacing, &y.unit);
        let texts = vertical_ticks.major.iter().map(|(_, text)| TICK.width(text)).fold(0.0, f64::max);
        let left = room.left + SIDE + texts.min(0.3 * (right - room.left)) + MAJOR + 4.0;
        let horizontal = Span::new(x, numbers(series, x, 0), [left, right]);
        let horizontal_ticks = Ticks::new(&horizontal, 68.0, &x.unit);
        Self {
            axes: [x, y],
            spans: [horizontal, vertical],
            area: Area { left, top, right, bottom },
            ticks: [horizontal_ticks, vertical_ticks],
            side: room.left,
        }
    }

    /// Place of a point \[px\], if it has one on the axes.
    pub(crate) fn place(&self, point: [f64; 2]) -> Option<[f64; 2]> {
        let has_place = self.axes[0].has(point[0]) && self.axes[1].has(point[1]);
        has_place.then(|| [self.spans[0].place(point[0]), self.spans[1].place(point[1])])
    }

    /// Places of the points of a series that are inside the plot.
    pub(crate) fn places(&self, series: &Series) -> impl Iterator<Item = [f64; 2]> {
        let places = series.points.iter().filter_map(|&point| self.place(point));
        places.filter(|&place| self.area.contains(place))
    }

    /// Draws a line at each tick with text.
    pub(crate) fn draw_grid(&self, canvas: &mut Canvas) {
        let pen = Pen::solid(Shade::GRID, 1.0);
        let Area { left, top, right, bottom } = self.area;
        for (value, _) in &self.ticks[0].major {
            let x = self.spans[0].place(*value);
            canvas.line(&[[x, top], [x, bottom]], &pen);
        }
        for (value, _) in &self.ticks[1].major {
            let y = self.spans[1].place(*value);
            canvas.line(&[[left, y], [right, y]], &pen);
        }
    }

    /// Draws the frame, the ticks with their texts, and what the axes show.
    pub(crate) fn draw_axes(&self, canvas: &mut Canvas) {
        let pen = Pen::solid(Shade::FRAME, 1.2);
        let Area { left, top, right, bottom } = self.area;
        canvas.line(&[[left, top], [right, top], [right, bottom], [left, bottom], [left, top]], &pen);
        for (x, length) in self.tick_places(0) {
            canvas.line(&[[x, bottom], [x, bottom + length]], &pen);
        }
        for (y, length) in self.tick_places(1) {
            canvas.line(&[[left - length, y], [left, y]], &pen);
        }
        let plain = |text, at, font| Label { text, at, font, anchor: Anchor::Middle, upwards: false };
        let [x, y] = self.spans;
        for (value, text) in &self.ticks[0].major {
            canvas.text(plain(text, [x.place(*value), bottom + MAJOR + 14.0], TICK));
        }
        for (value, text) in &self.ticks[1].major {
            let at = [left - MAJOR - 4.0, y.place(*value) + TICK.half_height()];
            canvas.text(Label { anchor: Anchor::End, ..plain(text, at, TICK) });
        }
        let captions = [right - left, bottom - top].into_iter().zip(self.axes);
        let captions: Vec<String> =
            captions.map(|(room, axis)| CAPTION.wrap(&axis.caption(), room, 1).concat()).collect();
        let [below, beside] =
            [[0.5 * (left + right), bottom + MAJOR + 36.0], [self.side + 15.0, 0.5 * (top + bottom)]];
        canvas.text(plain(&captions[0], below, CAPTION));
        canvas.text(Label { upwards: true, ..plain(&captions[1], beside, CAPTION) });
    }

    /// Places and lengths of the ticks along an axis.
    fn tick_places(&self, axis: usize) -> impl Iterator<Item = (f64, f64)> {
        let Ticks { major, minor } = &self.ticks[axis];
        let major = major.iter().map(|(value, _)| (*value, MAJOR));
        let all = major.chain(minor.iter().map(|value| (*value, MINOR)));
        all.map(move |(value, length)| (self.spans[axis].place(value), length))
    }
}

/// The numbers of all series along an axis that its range must hold.
fn numbers<'a>(series: &'a [Series], axis: &'a Axis, index: usize) -> impl Iterator<Item = f64> + 'a {
    series.iter().flat_map(move |series| {
        let is_vertical = index == 1;
        let (others, errors): (&[f64], &[f64]) = match &series.mark {
            Mark::Band(upper) if is_vertical => (upper, &[]),
            Mark::PointsWithErrors(errors) if is_vertical => (&[], errors),
            _ => (&[], &[]),
        };
        // The height of the last point of a histogram means nothing
        let is_histogram = is_vertical && series.mark == Mark::Steps;
        let count = series.points.len().saturating_sub(usize::from(is_histogram));
        let values = series.points[..count].iter().map(move |point| point[index]);
        let bars = series.points.iter().zip(errors).flat_map(|([_, y], error)| [y - error, y + error]);
        let foot = (is_histogram && axis.has(0.0)).then_some(0.0);
        values.chain(bars).chain(others.iter().copied()).chain(foot)
    })
}
