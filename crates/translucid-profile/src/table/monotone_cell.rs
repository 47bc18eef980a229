//! One cell of a tabulated cdf: a ratio of quadratics that rises, with a closed-form inverse.
//!
//! After J. A. Gregory and R. Delbourgo, *Piecewise Rational Quadratic Interpolation to Monotonic Data*, IMA J.
//! Numer. Anal. 2, 1982, which has w = 1. With θ ∈ [0, 1] across the cell, s ∈ [0, 1] the share of the cell's
//! energy, and slopes d₀, d₁ ≥ 0 of s at both ends:
//!
//! ```text
//! s(θ)  = [d₀ θ(1−θ) + w θ²] / Q(θ),     Q(θ) = (1−θ)² + (d₀ + w d₁) θ(1−θ) + w θ²
//! s'(θ) = [d₀ (1−θ)² + 2w θ(1−θ) + w² d₁ θ²] / Q(θ)²
//! ```
//!
//! No coefficient is negative, so s rises for every weight w > 0.
//! That leaves w to make s(½) right too, which takes the error from the fourth to the fifth order of the width:
//!
//! ```text
//! w = [d₀ (1 − s(½)) − s(½)] / [d₁ s(½) − (1 − s(½))]
//! ```
//!
//! θ and θ² are cells themselves (d₀ = d₁ = 1, and d₀ = 0, d₁ = 2, with w = 1), and every mean of the two: a cell
//! that begins at radius 0 has the right behaviour there, whether R grows like 1/r or is finite.
//!
//! For the inverse, τ = θ/(1−θ) is the positive root of w(1−s) τ² + [d₀(1−s) − w d₁ s] τ − s = 0.

/// Weights beyond this, or below its reciprocal, are taken for noise.
const WEIGHT_MAX: f64 = 256.0;

/// A cdf between two radii, in the arithmetic of one precision.
pub trait RadialCell<T>: Clone + std::fmt::Debug + PartialEq + Send + Sync {
    /// Shares of all energy before the cell, in it, and after it.
    fn shares(&self) -> [T; 3];

    /// Density per length.
    fn density(&self, x: T) -> T;

    /// Share of all energy within x.
    fn within(&self, x: T) -> T;

    /// Share of all energy beyond x.
    fn beyond(&self, x: T) -> T;

    /// x within which the share u of all energy is, for a u in the cell.
    fn quantile(&self, u: T) -> T;

    /// x beyond which the share v of all energy is, for a v in the cell.
    fn quantile_complement(&self, v: T) -> T;
}

/// A cdf between two radii in double precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Where the cell begins.
    pub(crate) start: f64,
    /// 1 / (end − start).
    pub(crate) inverse_width: f64,
    /// Share of all energy before the cell.
    pub(crate) within: f64,
    /// Share of all energy after the cell.
    pub(crate) beyond: f64,
    /// Share of all energy in the cell.
    pub(crate) share: f64,
    /// d₀.
    pub(crate) slope_in: f64,
    /// d₁.
    pub(crate) slope_out: f64,
    /// w.
    pub(crate) weight: f64,
}

/// A radius with what is known of the profile there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Knot {
    pub(crate) x: f64,
    /// Share of all energy within x.
    pub(crate) within: f64,
    /// Share of all energy beyond x.
    pub(crate) beyond: f64,
    /// Density per length.
    pub(crate) density: f64,
}

impl Knot {
    /// Energy between two knots, from those parts which have the digits.
    pub(crate) fn share_until(&self, end: &Self) -> f64 {
        let share = if self.within < 0.5 { end.within - self.within } else { self.beyond - end.beyond };
        share.max(0.0)
    }
}

impl Cell {
    /// The cell between two knots that has the share of a third knot in its middle, if a cell can.
    pub(crate) fn new(start: &Knot, middle: &Knot, end: &Knot) -> Self {
        let width = end.x - start.x;
        let share = start.share_until(end);
        let slope = |density: f64| density * width / share;
        let (slope_in, slope_out) = (slope(start.density), slope(end.density));
        let sane = share > 0.0 && slope_in < 1e100 && slope_out < 1e100;
        // Without energy there is no shape
        let (slope_in, slope_out) = if sane { (slope_in, slope_out) } else { (1.0, 1.0) };
        let share = if sane { share } else { 0.0 };
        let weight = if sane { weight(slope_in, slope_out, start.share_until(middle) / share) } else { 1.0 };
        Self {
            start: start.x,
            inverse_width: 1.0 / width,
            within: start.within,
            beyond: end.beyond,
            share,
            slope_in,
            slope_out,
            weight,
        }
    }

    #[inline(always)]
    fn theta(&self, x: f64) -> f64 {
        ((x - self.start) * self.inverse_width).max(0.0).min(1.0)
    }

    /// Q(θ), of θ and 1 − θ.
    #[inline(always)]
    fn denominator(&self, theta: f64, rest: f64) -> f64 {
        let Self { slope_in, slope_out, weight, .. } = self;
        rest * rest + theta * ((slope_in + weight * slope_out) * rest + weight * theta)
    }

    #[inline(always)]
    fn part_of_share(&self, energy: f64) -> f64 {
        (energy / self.share.max(f64::MIN_POSITIVE)).max(0.0).min(1.0)
    }

    /// x of the share s of the cell's energy, given beside 1 − s.
    #[inline(always)]
    fn inverse(&self, s: f64, rest: f64) -> f64 {
        let Self { slope_in, slope_out, weight, .. } = self;
        let b = slope_in * rest - weight * slope_out * s;
        let root = (b * b + 4.0 * weight * s * rest).sqrt();
        // Of the two forms of the root the one without a difference
        let (numerator, other) = if b >= 0.0 { (2.0 * s, b + root) } else { (root - b, 2.0 * weight * rest) };
        self.start + numerator / ((numerator + other).max(f64::MIN_POSITIVE) * self.inverse_width)
    }
}

impl RadialCell<f64> for Cell {
    #[inline(always)]
    fn shares(&self) -> [f64; 3] {
        [self.within, self.share, self.beyond]
    }

    #[inline(always)]
    fn density(&self, x: f64) -> f64 {
        let Self { slope_in, slope_out, weight, .. } = self;
        let theta = self.theta(x);
        let rest = 1.0 - theta;
        let outer = weight * theta;
        let q = self.denominator(theta, rest);
        let numerator = slope_in * rest * rest + outer * (2.0 * rest + slope_out * outer);
        self.share * self.inverse_width * (numerator / (q * q))
    }

    #[inline(always)]
    fn within(&self, x: f64) -> f64 {
        let theta = self.theta(x);
        let rest = 1.0 - theta;
        let numerator = theta * (self.slope_in * rest + self.weight * theta);
        self.within + self.share * (numerator / self.denominator(theta, rest))
    }

    #[inline(always)]
    fn beyond(&self, x: f64) -> f64 {
        let theta = self.theta(x);
        let rest = 1.0 - theta;
        let numerator = rest * (rest + self.weight * self.slope_out * theta);
        (self.beyond + self.share * (numerator / self.denominator(theta, rest))).min(1.0)
    }

    #[inline(always)]
    fn quantile(&self, u: f64) -> f64 {
        let s = self.part_of_share(u - self.within);
        self.inverse(s, 1.0 - s)
    }

    #[inline(always)]
    fn quantile_complement(&self, v: f64) -> f64 {
        let rest = self.part_of_share(v - self.beyond);
        self.inverse(1.0 - rest, rest)
    }
}

/// The weight with which the cell has the share s in its middle; 1 where none has.
fn weight(slope_in: f64, slope_out: f64, s: f64) -> f64 {
    let weight = (slope_in * (1.0 - s) - s) / (slope_out * s - (1.0 - s));
    if weight > 1.0 / WEIGHT_MAX && weight < WEIGHT_MAX { weight } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn knot(x: f64, cdf: impl Fn(f64) -> f64, density: impl Fn(f64) -> f64) -> Knot {
        Knot { x, within: cdf(x), beyond: 1.0 - cdf(x), density: density(x) }
    }

    fn cell(a: f64, b: f64, cdf: impl Fn(f64) -> f64 + Copy, density: impl Fn(f64) -> f64 + Copy) -> Cell {
        Cell::new(&knot(a, cdf, density), &knot(0.5 * (a + b), cdf, density), &knot(b, cdf, density))
    }

    #[test]
    fn cell_holds_powers_exactly() {
        for a in [0.0, 0.3, 1.0] {
            let cdf = |x: f64| 0.4 * (a * x + (1.0 - a) * x * x);
            let found = cell(0.0, 1.0, cdf, |x| 0.4 * (a + 2.0 * (1.0 - a) * x));
            for x in [1e-150, 1e-9, 0.1, 0.5, 0.9, 1.0] {
                assert!((found.within(x) / cdf(x) - 1.0).abs() < 1e-14, "{a} {x}");
                assert!(
                    (found.quantile(cdf(x)) / x - 1.0).abs() < 1e-14,
                    "{a} {x}: {}",
                    found.quantile(cdf(x))
                );
            }
        }
    }

    /// Fifth order: half the width, a 32nd of the error.
    #[test]
    fn error_falls_with_the_fifth_power_of_the_width() {
        let cdf = |x: f64| 1.0 - (-x).exp();
        let worst = |width: f64| {
            let found = cell(1.0, 1.0 + width, cdf, |x| (-x).exp());
            (1..100)
                .map(|i| 1.0 + width * f64::from(i) / 100.0)
                .map(|x| (found.within(x) - cdf(x)).abs())
                .fold(0.0, f64::max)
        };
        let (wide, narrow) = (worst(0.8), worst(0.4));
        assert!(wide < 2e-6, "{wide:e}");
        assert!((wide / narrow).log2() > 4.5 && (wide / narrow).log2() < 5.5, "{wide:e} {narrow:e}");
    }

    /// Any slopes and weight: rising, inverted exactly, and the density is the slope.
    #[test]
    fn cell_rises_and_inverts_whatever_its_numbers() {
        for d0 in [0.0, 1e-3, 1.0, 7.0, 300.0] {
            for d1 in [0.0, 1e-3, 1.0, 7.0, 300.0] {
                for weight in [1.0 / 256.0, 0.3, 1.0, 5.0, 256.0] {
                    let c = Cell {
                        start: 2.0,
                        inverse_width: 0.5,
                        within: 0.25,
                        beyond: 0.25,
                        share: 0.5,
                        slope_in: d0,
                        slope_out: d1,
                        weight,
                    };
                    let mut last = 0.25;
                    for i in 0..=200 {
                        let x = 2.0 + 0.01 * f64::from(i);
                        let (u, v) = (c.within(x), c.beyond(x));
                        assert!(u >= last && (u + v - 1.0).abs() < 1e-15, "{x}: {u} {v}");
                        last = u;
                        let (back, density) = (c.quantile(u), c.density(x));
                        // u is good to 1e-16, x to that by the density
                        let allowed = 1e-14 + 4e-16 / density.max(1e-9);
                        assert!((back - x).abs() < allowed, "{d0} {d1} {weight} {x}: {back}");
                        assert!((c.quantile_complement(v) - x).abs() < allowed, "{d0} {d1} {weight} {x}");
                        if (1..200).contains(&i) {
                            let slope = (c.within(x + 1e-6) - c.within(x - 1e-6)) / 2e-6;
                            assert!(
                                (slope - density).abs() < 1e-5 * (1.0 + density) * (1.0 + 1e2 * (d0 + d1))
                            );
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn cell_without_energy_is_flat() {
        let c = cell(1.0, 2.0, |_| 0.3, |_| 0.0);
        assert_eq!((c.within(1.5), c.beyond(1.5), c.density(1.5)), (0.3, 0.7, 0.0));
        assert!(c.quantile(0.3) >= 1.0 && c.quantile(0.3) <= 2.0);
    }
}
