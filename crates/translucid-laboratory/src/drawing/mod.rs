//! From a chart to a picture: what goes where is decided here, so that the figures of a page have one size and one
//! look.

mod area;
mod axis_span;
pub(crate) mod canvas;
mod legend;
mod marks;
mod plot;
mod point_labels;
pub(crate) mod svg;
pub(crate) mod text;
mod ticks;

use translucid_profile::Model;

use area::Area;
use canvas::{Anchor, Canvas, Label};
use legend::Legend;
use plot::Plot;
use text::Font;

use crate::chart::Ink;
use crate::chart::{Chart, Mark, Series};

/// Width and height of every chart \[px\].
const SIZE: [f64; 2] = [760.0, 470.0];
/// Around everything \[px\].
const MARGIN: f64 = 14.0;
const TITLE: Font = Font::bold(16.0);
/// From line to line of the title \[px\].
const TITLE_LINE: f64 = 22.0;

impl Chart {
    /// The chart as an SVG document that needs no font of its own.
    pub fn svg(&self) -> String {
        svg::svg(&draw(self), &self.title, &self.caption)
    }
}

/// Draws everything, the title above the plot and the legend beside it.
fn draw(chart: &Chart) -> Canvas {
    let mut canvas = Canvas::new(SIZE);
    let [width, height] = SIZE;
    let top = draw_title(&mut canvas, &chart.title);
    let legend = Legend::new(chart);
    let legend_width = if legend.width() > 0.0 { legend.width() + 16.0 } else { 0.0 };
    let right = width - MARGIN - 8.0 - legend_width;
    let plot = Plot::new(chart, Area { left: MARGIN, top, right, bottom: height - MARGIN });

    plot.draw_grid(&mut canvas);
    let mut series: Vec<&Series> = chart.series.iter().collect();
    series.sort_by_key(|series| layer(series));
    series.iter().for_each(|series| plot.draw(&mut canvas, series));
    plot.draw_axes(&mut canvas);
    point_labels::draw(&mut canvas, &plot, &chart.series);
    legend.draw(&mut canvas, [right + 16.0, top + 2.0], plot.area.bottom);
    canvas
}

/// Draws the title; the upper edge of the room below it \[px\].
fn draw_title(canvas: &mut Canvas, title: &str) -> f64 {
    let lines = TITLE.wrap(title, SIZE[0] - 2.0 * MARGIN, 2);
    let mut top = MARGIN;
    for text in &lines {
        let at = [MARGIN, top + 14.0];
        canvas.text(Label { text, at, font: TITLE, anchor: Anchor::Start, upwards: false });
        top += TITLE_LINE;
    }
    if lines.is_empty() { top } else { top + 6.0 }
}

/// Place in the order of drawing: bands, then the line of the truth, wide enough to be seen below those that follow it.
fn layer(series: &Series) -> u8 {
    match (&series.mark, series.ink) {
        (Mark::Band(_), _) => 0,
        (Mark::Line, Ink::Reference | Ink::Model(Model::Exact)) => 1,
        _ => 2,
    }
}
