//! Where the values of a photograph pile up: at the greatest that a sensor, a file or a developer has let through.
//!
//! Light that is clipped leaves one greatest value that many pixels share.
//! A sensor's range may end below that of the file (14 bits in 16), a developer may have scaled it, by another factor for each
//! channel, and a JPEG may have blurred it.
//! An evenly lit side without noise, as a rendering may have, piles up, too.
//! Light was cut off where it shows one of two signs:
//!
//! - Noise: darker pixels are noisy, so that brighter ones are not equal.
//! - A straight way up: nine times as far below the pile there are nine times as many pixels. Light that nears its greatest
//!   value has hardly fewer just below it.

use crate::linear_photo::Photo;

/// Share of the values that may be above the pile: hot pixels.
const HOT: f64 = 1e-4;

/// Widths of a pile, over the greatest value: of rounding, of coarse integers, of a JPEG's noise.
const WIDTHS: [f64; 3] = [3e-6, 4e-3, 0.02];

/// Width up to which values are equal.
const EQUAL: f64 = 1e-5;

/// Least distance below the pile, over the greatest value, within which light is near it.
const NEAR: f64 = 1e-3;

/// Light up to this many times as far is compared with the near.
const FAR: usize = 10;

/// A pile has this many times the pixels that are near it.
const PILE: f64 = 2.0;

/// Farther light has this many times the pixels of the near, where it is cut off.
const STRAIGHT: f64 = 4.0;

/// Least share of the values that is a pile, or shows that it is one.
const LEAST: f64 = 1e-3;

/// Fewest pixels of a pile.
const FEWEST: f64 = 16.0;

/// Steps of a file's integers, and part of the greatest value, that noise exceeds: with so much equal values are rare.
const NOISY: f64 = 0.8;
const LEAST_NOISE: f64 = 2e-4;

/// Values of a channel that are cut off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PileUp {
    /// The least value of the pile.
    pub(crate) from: f32,
    /// The greatest value.
    pub(crate) greatest: f32,
    /// Share of the channel's values.
    pub(crate) share: f64,
}

impl Photo {
    /// The pile of a channel's greatest values, where light is lost; `None` where there is none.
    pub(crate) fn pile_up(&self, c: usize) -> Option<PileUp> {
        let mut values: Vec<f32> =
            self.pixels.iter().map(|pixel| pixel[c]).filter(|value| value.is_finite()).collect();
        values.sort_unstable_by(f32::total_cmp);
        let count = values.len() as f64;
        let greatest = f64::from(*values.get((count - HOT * count) as usize - 1)?);
        if greatest <= 0.0 {
            return None;
        }
        let above = |value: f64| values.len() - values.partition_point(|v| f64::from(*v) < value);
        let coarse = coarseness(&values, greatest);
        WIDTHS.iter().find_map(|width| {
            let from = (1.0 - width) * greatest;
            let pile = above(from);
            let below = |reach: f64| (above(from - reach) - pile) as f64;
            let is_pile = |near: f64| pile as f64 > (PILE * near).max(LEAST * count).max(FEWEST);
            let is_straight = || {
                let reach = (NEAR * greatest).max(2.0 * width * greatest).max(2.5 * coarse);
                let steps: Vec<f64> = (0..=FAR).map(|i| below(i as f64 * reach)).collect();
                let (near, far) = (steps[1], steps[FAR] - steps[1]);
                // One row of pixels beside a sharp edge shows nothing
                let filled = steps.windows(2).skip(1).filter(|pair| pair[1] > pair[0]).count();
                is_pile(near) && far > STRAIGHT * near + LEAST * count && 2 * filled >= FAR
            };
            let is_equal = || {
                let is_noisy = || self.noise_below(c, from) > (NOISY * coarse).max(LEAST_NOISE * greatest);
                *width <= EQUAL
                    && is_pile(below((2.0 * coarse).max(0.5 * LEAST_NOISE * greatest)))
                    && is_noisy()
            };
            (is_straight() || is_equal()).then(|| PileUp {
                from: from as f32,
                greatest: greatest as f32,
                share: pile as f64 / count,
            })
        })
    }

    /// Channels in which a white card's values are equal though the rest of the photograph is noisy, and none there is brighter:
    /// where one is, such a card is even, and not clipped.
    pub(crate) fn clipped_whites(&self, card: [usize; 4]) -> [bool; 3] {
        let card = self.part(card);
        let Some(first) = card.pixels.first().copied() else { return [false; 3] };
        let brighter = |c: usize| self.pixels.iter().filter(|pixel| pixel[c] > first[c]).count();
        let is_equal = |c: usize| {
            let greatest = f64::from(first[c]);
            let is_noisy = || {
                let mut all: Vec<f32> = self.pixels.iter().map(|pixel| pixel[c]).collect();
                all.sort_unstable_by(f32::total_cmp);
                let least = (NOISY * coarseness(&all, greatest)).max(LEAST_NOISE * greatest);
                self.noise_below(c, greatest) > least
            };
            card.pixels.iter().all(|pixel| pixel[c] == first[c]) && is_noisy()
        };
        let equal = [0, 1, 2].map(is_equal);
        let is_even = (0..3).any(|c| equal[c] && brighter(c) as f64 > HOT * self.pixels.len() as f64);
        equal.map(|is_equal| is_equal && !is_even)
    }

    /// Noise of a channel's pixels below a value: the median of second differences, in the row or in the column, whichever
    /// is less. Smooth light has hardly any.
    fn noise_below(&self, c: usize, most: f64) -> f64 {
        let value = |i: usize| f64::from(self.pixels[i][c]);
        let second = |i: usize, step: usize| (value(i - step) - 2.0 * value(i) + value(i + step)).abs();
        let inner = (1..self.height.saturating_sub(1))
            .flat_map(|y| (1..self.width.saturating_sub(1)).map(move |x| y * self.width + x));
        let below = inner.filter(|i| (f64::MIN_POSITIVE..most).contains(&value(*i)));
        let mut all: Vec<f64> = below.map(|i| second(i, 1).min(second(i, self.width))).collect();
        let middle = all.len() / 2;
        if all.is_empty() { 0.0 } else { *all.select_nth_unstable_by(middle, f64::total_cmp).1 }
    }
}

/// The least step between bright values that differ: that of a file's integers, or hardly any.
fn coarseness(sorted: &[f32], greatest: f64) -> f64 {
    let bright = &sorted[sorted.partition_point(|v| f64::from(*v) < 0.5 * greatest)..];
    let steps = bright.windows(2).map(|pair| f64::from(pair[1]) - f64::from(pair[0]));
    let least = steps.filter(|step| *step > WIDTHS[0] * greatest).fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use translucid_testing::SplitMix;

    use super::*;

    /// A camera's picture of an edge: the distance over which light creeps in pixels, the angle, the noise, and what is done
    /// to the values.
    fn photo(creep: f64, angle: f64, noise: f64, finish: impl Fn(f64) -> f64) -> Photo {
        let (sin, cos) = libm::sincos(angle);
        let mut random = SplitMix(9);
        let mut normal = || (0..12).map(|_| random.uniform()).sum::<f64>() - 6.0;
        let pixels = (0..150 * 90).map(|i| {
            let x = f64::from(i % 150 - 60) * cos + f64::from(i / 150 - 45) * sin;
            let light = if x < 0.0 { 0.03 } else { 1.0 - 0.4 * libm::exp(-x / creep) };
            [finish(0.5 * light + noise * normal()) as f32; 3]
        });
        Photo { width: 150, height: 90, pixels: pixels.collect() }
    }

    /// sRGB codes of so many levels as linear values.
    fn coded(levels: f64) -> impl Fn(f64) -> f64 {
        move |value| libm::pow((levels * libm::pow(value.max(0.0).min(1.0), 1.0 / 2.2)).round() / levels, 2.2)
    }

    #[test]
    fn even_light_is_no_pile() {
        for creep in [0.3, 1.0, 3.0, 10.0] {
            for angle in [0.0, 0.1, 0.7] {
                for noise in [0.0, 3e-4, 2e-3, 8e-3] {
                    let finishes: [(&str, &dyn Fn(f64) -> f64); 4] = [
                        ("float", &|v| v),
                        ("14 bits", &|v| (16383.0 * v).round() / 65535.0),
                        ("16 bits", &coded(65535.0)),
                        ("8 bits", &coded(255.0)),
                    ];
                    for (name, finish) in finishes {
                        let pile = photo(creep, angle, noise, finish).pile_up(1);
                        assert_eq!(pile, None, "{creep} {angle} {noise} {name}");
                    }
                }
            }
        }
    }

    /// Noise of less than half a step of 8 bits is not told from none.
    #[test]
    fn clipped_light_is_a_pile() {
        let mut faults = String::new();
        for creep in [3.0, 10.0] {
            for angle in [0.0, 0.1, 0.7] {
                for noise in [2e-3, 8e-3] {
                    for limit in [0.35, 0.47, 0.495] {
                        let finishes: [(&str, &dyn Fn(f64) -> f64); 4] = [
                            ("float, scaled", &|v| 1.234_5 * v.min(limit)),
                            ("14 bits", &|v| (16383.0 * v.min(limit)).round() / 65535.0),
                            ("16 bits", &|v| coded(65535.0)(0.9 * v.min(limit))),
                            ("8 bits", &|v| coded(255.0)(0.9 * v.min(limit))),
                        ];
                        for (name, finish) in finishes {
                            let found = photo(creep, angle, noise, finish).pile_up(1);
                            let share = found.map_or(0.0, |pile| pile.share);
                            if share < 0.2 && (noise > 0.004 || name != "8 bits") {
                                faults += &format!("{creep} {angle} {noise} {limit} {name}: {found:?}\n");
                            }
                        }
                    }
                }
            }
        }
        assert!(faults.is_empty(), "{faults}");
    }
}
