//! From numbers to places along an axis.

use crate::chart::{Axis, Scale};

/// A range of an axis and the pixels that it is drawn over.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Span {
    pub(crate) scale: Scale,
    /// Least and greatest number.
    pub(crate) range: [f64; 2],
    /// Their places \[px\].
    pub(crate) pixels: [f64; 2],
}

impl Span {
    /// The span of an axis that shows the values.
    pub(crate) fn new(axis: &Axis, values: impl Iterator<Item = f64>, pixels: [f64; 2]) -> Self {
        let is_shown = |&[low, high]: &[f64; 2]| axis.has(low) && axis.has(high) && low < high;
        let range = match axis.range.filter(is_shown) {
            Some(range) => widened(range, axis.scale),
            None => padded(around(axis, values), axis.scale),
        };
        Self { scale: axis.scale, range, pixels }
    }

    /// Place of a number \[px\]; far outside of the range only on the right side of it.
    pub(crate) fn place(&self, value: f64) -> f64 {
        const FAR: f64 = 1e4;
        let along = |x: f64| x;
        let f = match self.scale {
            Scale::Linear => along,
            Scale::Logarithmic => f64::log10,
        };
        let [low, high] = self.range.map(f);
        let t = ((f(value) - low) / (high - low)).clamp(-FAR, FAR);
        self.pixels[0] + t * (self.pixels[1] - self.pixels[0])
    }

    /// Returns whether a number is in the range, but for rounding.
    pub(crate) fn contains(&self, value: f64) -> bool {
        let [low, high] = self.range;
        let slack = match self.scale {
            Scale::Linear => 1e-9 * (high - low),
            Scale::Logarithmic => 1e-9 * value,
        };
        low - slack <= value && value <= high + slack
    }
}

/// Least and greatest of the values that have a place on the axis, in 0…1 or 1…10 where there are none.
fn around(axis: &Axis, values: impl Iterator<Item = f64>) -> [f64; 2] {
    let start = [f64::INFINITY, f64::NEG_INFINITY];
    let [low, high] = values
        .filter(|&value| axis.has(value))
        .fold(start, |[low, high], value| [low.min(value), high.max(value)]);
    match axis.scale {
        _ if low <= high => [low, high],
        Scale::Linear => [0.0, 1.0],
        Scale::Logarithmic => [1.0, 10.0],
    }
}

/// The range with a margin; a linear one that begins near zero begins there.
fn padded(range: [f64; 2], scale: Scale) -> [f64; 2] {
    const MARGIN: f64 = 0.04;
    let [low, high] = widened(range, scale);
    match scale {
        Scale::Linear => {
            let margin = MARGIN * (high - low);
            let near_zero = 0.2 * (high - low);
            let start = if (0.0..near_zero).contains(&low) { 0.0 } else { low - margin };
            let end = if (-near_zero..=0.0).contains(&high) { 0.0 } else { high + margin };
            [start, end]
        }
        Scale::Logarithmic => {
            let factor = (high / low).min(Axis::GREATEST).powf(MARGIN);
            [(low / factor).max(1.0 / Axis::GREATEST), (high * factor).min(Axis::GREATEST)]
        }
    }
}

/// A range that is wide enough to be told apart by ticks.
fn widened([low, high]: [f64; 2], scale: Scale) -> [f64; 2] {
    match scale {
        Scale::Linear => {
            let size = low.abs().max(high.abs());
            if high - low > 1e-9 * size && high - low > 1e-290 {
                [low, high]
            } else if size > 1e-280 {
                [low - 0.1 * size, high + 0.1 * size]
            } else {
                [-1.0, 1.0]
            }
        }
        Scale::Logarithmic if high > 1.05 * low => [low, high],
        Scale::Logarithmic => {
            let [low, high] = [low / 2.0, high * 2.0];
            [low.max(1.0 / Axis::GREATEST), high.min(Axis::GREATEST)]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EXTREMES: [f64; 12] =
        [0.0, -0.0, 1.0, -1.0, 1e-300, 1e300, -1e300, 1e-320, f64::MAX, f64::NAN, f64::INFINITY, 1.0 + 1e-15];

    #[test]
    fn every_range_rises_and_every_place_is_finite() {
        for axis in [Axis::linear("", ""), Axis::logarithmic("", "")] {
            for a in EXTREMES {
                for b in EXTREMES {
                    let spans = [
                        Span::new(&axis, [a, b].into_iter(), [0.0, 100.0]),
                        Span::new(&axis.clone().between(a, b), [a].into_iter(), [0.0, 100.0]),
                    ];
                    for span in spans {
                        let [low, high] = span.range;
                        assert!(low < high && high - low < f64::INFINITY, "{a} {b} {span:?}");
                        for value in [a, b].into_iter().filter(|&value| axis.has(value)) {
                            assert!(span.place(value).is_finite(), "{value} in {span:?}");
                        }
                        assert!((span.place(low)).abs() < 1e-9 && (span.place(high) - 100.0).abs() < 1e-9);
                    }
                }
            }
        }
    }

    #[test]
    fn logarithmic_places_are_even_in_ratios() {
        let span = Span::new(&Axis::logarithmic("", "").between(1e-3, 1e3), [].into_iter(), [0.0, 600.0]);
        assert!((span.place(0.1) - 200.0).abs() < 1e-9 && (span.place(100.0) - 500.0).abs() < 1e-9);
    }
}
