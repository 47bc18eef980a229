//! Words beside points, where they cover neither points nor each other.

use std::f64::consts::TAU;

use super::area::Area;
use super::canvas::{Anchor, Canvas, Label, Pen};
use super::plot::Plot;
use super::text::Font;
use crate::chart::Shade;
use crate::chart::{Mark, Series};

const FONT: Font = Font::regular(12.0);
/// Most words of a chart; more could not be read.
const MOST: usize = 300;
/// Number of times that each word looks for a better place, given the places of all others.
const SWEEPS: usize = 4;
/// From a point to its words, at the nearest and for those that have to go further off \[px\].
const NEAR: f64 = 8.0;
const FURTHER: [f64; 6] = [0.0, 10.0, 22.0, 36.0, 52.0, 72.0];
/// In sixteenths of a turn from the right downwards, the best first: to the right and to the left, then away from there.
const DIRECTIONS: [f64; 16] =
    [0.0, 8.0, 15.0, 1.0, 9.0, 7.0, 14.0, 2.0, 10.0, 6.0, 13.0, 3.0, 11.0, 5.0, 12.0, 4.0];
/// Cost of a pixel further off, in square pixels that are covered.
const DISTANCE: f64 = 4.0;
/// Cost of any line, however short.
const LINE: f64 = 80.0;
/// Cost of a pixel of a line across words or other points.
const CROSSING: f64 = 20.0;

/// Words that look for a place.
struct Word {
    text: String,
    width: f64,
    point: [f64; 2],
    place: Option<Place>,
}

/// A place for words.
#[derive(Clone, Copy, Debug)]
struct Place {
    area: Area,
    /// Distance beyond the nearest places \[px\].
    off: f64,
}

impl Place {
    /// The line from a point to words that are further off, which is a point for the nearest.
    fn line(&self, point: [f64; 2]) -> [[f64; 2]; 2] {
        let Area { left, top, right, bottom } = self.area;
        let end =
            if self.off > 0.0 { [point[0].clamp(left, right), point[1].clamp(top, bottom)] } else { point };
        [point, end]
    }
}

/// Draws the words at the points of all series, with a thin line to those that are further off.
pub(crate) fn draw(canvas: &mut Canvas, plot: &Plot<'_>, all: &[Series]) {
    let markers: Vec<Area> = all
        .iter()
        .filter(|series| !matches!(series.mark, Mark::Line | Mark::Steps | Mark::Band(_)))
        .flat_map(|series| plot.places(series))
        .take(10 * MOST)
        .map(|[x, y]| Area { left: x, right: x, top: y, bottom: y }.grown(6.0))
        .collect();
    let mut words = words(plot, all);
    for _ in 0..SWEEPS {
        for i in 0..words.len() {
            let others = words.iter().enumerate().filter(|(k, _)| *k != i).map(|(_, word)| word);
            let taken: Vec<(Area, [[f64; 2]; 2])> = others
                .filter_map(|word| word.place.map(|place| (place.area.grown(2.5), place.line(word.point))))
                .collect();
            let cost = |place: &Place| {
                let outside = words[i].width * FONT.size - overlap(&place.area, &plot.area);
                let covered: f64 = taken.iter().map(|(other, _)| overlap(&place.area, other)).sum();
                let hidden: f64 = markers.iter().map(|other| overlap(&place.area, other)).sum();
                let line = place.line(words[i].point);
                let crossed: f64 = taken
                    .iter()
                    .map(|(area, other)| length_within(area, line) + length_within(&place.area, *other))
                    .sum();
                let struck: f64 = markers
                    .iter()
                    .filter(|marker| !marker.contains(words[i].point))
                    .map(|marker| length_within(marker, line))
                    .sum();
                4.0 * (outside + hidden)
                    + covered
                    + CROSSING * (crossed + struck)
                    + DISTANCE * place.off
                    + if place.off > 0.0 { LINE } else { 0.0 }
            };
            let best = places(&words[i]).min_by(|a, b| cost(a).total_cmp(&cost(b)));
            words[i].place = best;
        }
    }
    for Word { text, point, place, .. } in &words {
        let Some(Place { area, off }) = place else { continue };
        if *off > 0.0 {
            canvas.line(&Place { area: *area, off: *off }.line(*point), &Pen::solid(Shade::GRAY, 0.8));
        }
        let at = [area.left, 0.5 * (area.top + area.bottom) + FONT.half_height()];
        canvas.text(Label { text, at, font: FONT, anchor: Anchor::Start, upwards: false });
    }
}

/// The words of the points inside the plot.
fn words(plot: &Plot<'_>, all: &[Series]) -> Vec<Word> {
    let widest = 0.6 * (plot.area.right - plot.area.left);
    let mut words = Vec::new();
    for series in all {
        let Mark::LabelledPoints(texts) = &series.mark else { continue };
        for (&point, text) in series.points.iter().zip(texts) {
            let place = plot.place(point).filter(|&place| plot.area.contains(place));
            let text = FONT.wrap(text, widest, 1).concat();
            if let Some(point) = place.filter(|_| !text.is_empty() && words.len() < MOST) {
                words.push(Word { width: FONT.width(&text), text, point, place: None });
            }
        }
    }
    words
}

/// Places that words may have, the best first.
fn places(word: &Word) -> impl Iterator<Item = Place> {
    FURTHER.into_iter().flat_map(move |off| {
        DIRECTIONS.into_iter().map(move |turn| {
            let (down, right) = (TAU / 16.0 * turn).sin_cos();
            let left = word.point[0] + (NEAR + off) * right + 0.5 * (right - 1.0) * word.width;
            let middle = word.point[1] + (0.5 * FONT.size + 0.9 * NEAR + off) * down;
            let area = Area {
                left,
                right: left + word.width,
                top: middle - 0.5 * FONT.size,
                bottom: middle + 0.5 * FONT.size,
            };
            Place { area, off }
        })
    })
}

/// Length of the part of a line that is within a rectangle \[px\].
fn length_within(area: &Area, line: [[f64; 2]; 2]) -> f64 {
    area.part(line).map_or(0.0, |[a, b]| (b[0] - a[0]).hypot(b[1] - a[1]))
}

/// Area that two rectangles share \[px²\].
fn overlap(a: &Area, b: &Area) -> f64 {
    let width = a.right.min(b.right) - a.left.max(b.left);
    let height = a.bottom.min(b.bottom) - a.top.max(b.top);
    width.max(0.0) * height.max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_go_all_around_and_begin_at_the_right() {
        let word = Word { text: String::from("w"), width: 40.0, point: [100.0, 100.0], place: None };
        let places: Vec<Place> = places(&word).collect();
        assert_eq!(places.len(), FURTHER.len() * DIRECTIONS.len());
        assert!((places[0].area.left - 108.0).abs() < 1e-9 && (places[0].area.top - 94.0).abs() < 1e-9);
        assert!((places[1].area.right - 92.0).abs() < 1e-9);
        let first = &places[..DIRECTIONS.len()];
        for (i, a) in first.iter().enumerate() {
            let same = |b: &Place| (a.area.left - b.area.left).hypot(a.area.top - b.area.top) < 0.1;
            assert!(!first[..i].iter().any(same), "{i}");
        }
        assert!(places.iter().all(|place| !place.area.contains(word.point)));
    }
}
