//! From a chart to a picture.
//!
//! kuva has the bitmaps, their fonts and the SVG; where things go is decided here, so that the figures of a page have
//! one size and one look, and a curve is cut off at the edge of its plot in bitmaps, too.

pub(crate) mod bitmap;
pub(crate) mod canvas;
mod legend;
mod marks;
mod polyline;
mod span;
pub(crate) mod text;
mod ticks;
mod words;

use translucid_profile::Model;

use canvas::{Anchor, Canvas, Label, Medium, Pen};
use legend::Legend;
use marks::Plot;
use polyline::Area;
use span::Span;
use ticks::Ticks;

use crate::axis::{Axis, Scale};
use crate::chart::{Chart, Mark, Series};
use crate::ink::Ink;
use crate::markup::escape;
use crate::theme::{Shade, Theme};

/// Width and height of every chart \[px\].
const SIZE: [f64; 2] = [760.0, 470.0];
/// Pixels of a PNG for one of those.
const PNG_SCALE: f32 = 2.0;
/// Around everything \[px\].
const MARGIN: f64 = 14.0;
/// Font sizes.
const TITLE: u32 = 16;
const AXIS: u32 = 14;
const TICK: u32 = 12;
/// Lengths of ticks with and without text \[px\].
const MAJOR: f64 = 6.0;
const MINOR: f64 = 3.0;
/// Radius of markers \[px\].
const MARKER: f64 = 3.8;
const BAND_OPACITY: f64 = 0.22;

/// The chart as an SVG document with a title and a description for those who cannot see it.
pub(crate) fn svg(chart: &Chart, theme: Theme) -> String {
    let svg = draw(chart, theme, Medium::Svg).0.svg();
    // kuva's root has neither a view box, without which it does not scale, nor words
    let content = svg.split_once('>').map_or("", |(_, content)| content);
    let fonts = canvas::FONTS;
    let [width, height] = SIZE;
    let text = Shade::TEXT.color(theme);
    let [title, caption] = [&chart.title, &chart.caption].map(|words| escape(words));
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
         height=\"{height}\" font-family=\"{fonts}\" fill=\"{text}\" role=\"img\"><title>{title}</title>\
         <desc>{caption}</desc>{content}"
    )
}

/// The chart as a PNG.
pub(crate) fn png(chart: &Chart) -> Result<Vec<u8>, String> {
    let (canvas, area) = draw(chart, Theme::Light, Medium::Bitmap);
    let picture = canvas.png(PNG_SCALE)?;

    // The label of the vertical axis, lying, to be set upright
    let [width, height] = [area.bottom - area.top, 2.0 * UPRIGHT];
    let mut lying = Canvas::new([width, height], Theme::Light, Medium::Bitmap);
    let text = &shortened(&chart.y, width);
    let at = [0.5 * width, 1.5 * UPRIGHT];
    lying.text(&Label { text, at, ..PLAIN });
    bitmap::with_upright(
        &picture,
        &lying.png(PNG_SCALE)?,
        [MARGIN, area.top].map(|x| x * f64::from(PNG_SCALE)),
    )
}

/// Half the height of the label of the vertical axis \[px\]; its base line is at three quarters.
const UPRIGHT: f64 = 10.0;

/// Text at an axis.
const PLAIN: Label<'_> =
    Label { text: "", at: [0.0; 2], size: AXIS, anchor: Anchor::Middle, upwards: false, bold: false };

/// Draws everything, in a bitmap but for the label of the vertical axis: kuva's letters get bold when they are turned.
fn draw(chart: &Chart, theme: Theme, medium: Medium) -> (Canvas, Area) {
    let mut canvas = Canvas::new(SIZE, theme, medium);
    let [width, height] = SIZE;
    let legend = Legend::new(chart);

    // Place title and legend around the plot
    let title = text::at_most(text::wrap(&chart.title, f64::from(TITLE), width - 2.0 * MARGIN), 2);
    let title_height = if chart.title.trim().is_empty() { 0.0 } else { 22.0 * title.len() as f64 + 6.0 };
    let legend_width = if legend.width() > 0.0 { legend.width() + 16.0 } else { 0.0 };
    let top = MARGIN + title_height;
    let bottom = height - MARGIN - 46.0;
    let right = width - MARGIN - 8.0 - legend_width;

    // The texts of the vertical axis decide where the plot begins
    let vertical = Span::new(&chart.y, numbers(&chart.series, &chart.y, 1), [bottom, top]);
    let vertical_ticks =
        Ticks::new(&vertical, if chart.y.scale == Scale::Linear { 52.0 } else { 34.0 }, &chart.y.unit);
    let texts = vertical_ticks.major.iter().map(|(_, words)| text::width(words, f64::from(TICK)));
    let left = MARGIN + 22.0 + texts.fold(0.0, f64::max).min(0.3 * width) + MAJOR + 4.0;
    let horizontal = Span::new(&chart.x, numbers(&chart.series, &chart.x, 0), [left, right]);
    let horizontal_ticks = Ticks::new(&horizontal, 68.0, &chart.x.unit);
    let area = Area { left, top, right, bottom };

    for (i, line) in title.iter().enumerate() {
        let at = [MARGIN, MARGIN + 14.0 + 22.0 * i as f64];
        canvas.text(&Label {
            text: line,
            at,
            size: TITLE,
            anchor: Anchor::Start,
            upwards: false,
            bold: true,
        });
    }
    let plot = Plot { axes: [&chart.x, &chart.y], spans: [horizontal, vertical], area };
    draw_grid(&mut canvas, &plot, [&horizontal_ticks, &vertical_ticks]);
    let mut series: Vec<&Series> = chart.series.iter().collect();
    series.sort_by_key(|series| layer(series));
    for series in series {
        plot.draw(&mut canvas, series);
    }
    draw_axes(&mut canvas, &plot, [&horizontal_ticks, &vertical_ticks]);
    words::draw(&mut canvas, &plot, &chart.series);
    legend.draw(&mut canvas, [right + 16.0, top + 2.0], bottom);
    if medium == Medium::Svg {
        let text = &shortened(&chart.y, bottom - top);
        let at = [MARGIN + 1.5 * UPRIGHT, 0.5 * (top + bottom)];
        canvas.text(&Label { text, at, upwards: true, ..PLAIN });
    }
    (canvas, area)
}

/// What is drawn first: bands, then the line of the truth, wide enough to be seen below those that follow it.
fn layer(series: &Series) -> u8 {
    match (&series.mark, series.ink) {
        (Mark::Band(_), _) => 0,
        (Mark::Line, Ink::Reference | Ink::Model(Model::Exact)) => 1,
        _ => 2,
    }
}

/// The numbers of all series along an axis that its range must hold.
fn numbers<'a>(series: &'a [Series], axis: &'a Axis, index: usize) -> impl Iterator<Item = f64> + 'a {
    series.iter().flat_map(move |series| {
        let others: &[f64] = match &series.mark {
            Mark::Band(upper) if index == 1 => upper,
            _ => &[],
        };
        let errors: &[f64] = match &series.mark {
            Mark::PointsWithErrors(errors) if index == 1 => errors,
            _ => &[],
        };
        // The height of the last point of a histogram means nothing
        let count = series.points.len()
            - usize::from(series.mark == Mark::Steps && index == 1 && !series.points.is_empty());
        let values = series.points[..count].iter().map(move |point| point[index]);
        let bars = series
            .points
            .iter()
            .zip(errors)
            .flat_map(move |(point, error)| [point[1] - error, point[1] + error]);
        let feet = (series.mark == Mark::Steps && index == 1 && axis.has(0.0)).then_some(0.0);
        values.chain(bars).chain(others.iter().copied()).chain(feet)
    })
}

fn draw_grid(canvas: &mut Canvas, plot: &Plot<'_>, [horizontal, vertical]: [&Ticks; 2]) {
    let pen = Pen::solid(Shade::GRID, 1.0);
    let Area { left, top, right, bottom } = plot.area;
    for (value, _) in &horizontal.major {
        let x = plot.spans[0].place(*value);
        canvas.line(&[[x, top], [x, bottom]], &pen);
    }
    for (value, _) in &vertical.major {
        let y = plot.spans[1].place(*value);
        canvas.line(&[[left, y], [right, y]], &pen);
    }
}

/// Draws the frame, the ticks with their texts, and what the axes show.
fn draw_axes(canvas: &mut Canvas, plot: &Plot<'_>, [horizontal, vertical]: [&Ticks; 2]) {
    let pen = Pen::solid(Shade::FRAME, 1.2);
    let Area { left, top, right, bottom } = plot.area;
    canvas.line(&[[left, top], [right, top], [right, bottom], [left, bottom], [left, top]], &pen);
    let [x, y] = plot.spans;
    let ticks = |ticks: &Ticks, span: Span| -> Vec<(f64, f64)> {
        let major = ticks.major.iter().map(|(value, _)| (*value, MAJOR));
        major
            .chain(ticks.minor.iter().map(|&value| (value, MINOR)))
            .map(|(v, l)| (span.place(v), l))
            .collect()
    };
    for (x, length) in ticks(horizontal, x) {
        canvas.line(&[[x, bottom], [x, bottom + length]], &pen);
    }
    for (y, length) in ticks(vertical, y) {
        canvas.line(&[[left - length, y], [left, y]], &pen);
    }
    let plain = Label { size: TICK, ..PLAIN };
    for (value, text) in &horizontal.major {
        canvas.text(&Label { text, at: [x.place(*value), bottom + MAJOR + 14.0], ..plain });
    }
    for (value, text) in &vertical.major {
        let at = [left - MAJOR - 4.0, y.place(*value) + 0.36 * f64::from(TICK)];
        canvas.text(&Label { text, at, anchor: Anchor::End, ..plain });
    }
    let text = &shortened(plot.axes[0], right - left);
    canvas.text(&Label { text, at: [0.5 * (left + right), bottom + MAJOR + 36.0], ..PLAIN });
}

/// What an axis shows, in at most so much room.
fn shortened(axis: &Axis, room: f64) -> String {
    text::at_most(text::wrap(&axis.caption(), f64::from(AXIS), room), 1).concat()
}
