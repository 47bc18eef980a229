//! A smooth curve through points that rises where they rise and falls where they fall.

/// Piecewise cubic through points, with a continuous slope; constant beyond the ends.
///
/// Slopes are those of parabolas through three points, limited after F. N. Fritsch and R. E. Carlson, *Monotone
/// Piecewise Cubic Interpolation*, SIAM J. Numer. Anal. 17, 1980: at most three times the lesser of the slopes of
/// both chords, and 0 where these differ in sign.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MonotoneCubic {
    xs: Vec<f64>,
    /// Coefficients of each interval: value, slope, and half the second and a sixth of the third derivative at its beginning.
    cubics: Vec<[f64; 4]>,
}

impl MonotoneCubic {
    /// The curve through at least one point; `xs` rise strictly.
    pub(crate) fn new(xs: &[f64], ys: &[f64]) -> Self {
        let chords = chords(xs, ys);
        let slopes = monotone_slopes(xs, ys);
        let cubic = |i: usize| {
            let Some([width, chord]) = chords.get(i).copied() else { return [ys[i], 0.0, 0.0, 0.0] };
            let (start, end) = (slopes[i], slopes[i + 1]);
            let square = (3.0 * chord - 2.0 * start - end) / width;
            let cube = (start + end - 2.0 * chord) / (width * width);
            [ys[i], start, square, cube]
        };
        Self { xs: xs.to_vec(), cubics: (0..xs.len()).map(cubic).collect() }
    }

    /// Number of the point at or before x; 0 before the first.
    pub(crate) fn interval(&self, x: f64) -> usize {
        self.xs.partition_point(|start| *start <= x).saturating_sub(1)
    }

    /// Value at x.
    pub(crate) fn eval(&self, x: f64) -> f64 {
        let i = self.interval(x);
        let [value, slope, square, cube] = self.cubics[i];
        let t = (x - self.xs[i]).max(0.0);
        value + t * (slope + t * (square + t * cube))
    }

    /// Beginning and coefficients of each interval.
    pub(crate) fn intervals(&self) -> impl Iterator<Item = (f64, [f64; 4])> {
        self.xs.iter().copied().zip(self.cubics.iter().copied())
    }
}

/// The slopes of the curve at its points.
pub(crate) fn monotone_slopes(xs: &[f64], ys: &[f64]) -> Vec<f64> {
    let chords = chords(xs, ys);
    (0..xs.len()).map(|i| slope(&chords, i)).collect()
}

/// Width and slope of each chord.
fn chords(xs: &[f64], ys: &[f64]) -> Vec<[f64; 2]> {
    let pairs = xs.windows(2).zip(ys.windows(2));
    pairs.map(|(x, y)| [x[1] - x[0], (y[1] - y[0]) / (x[1] - x[0])]).collect()
}

/// Slope at point i, from the widths and slopes of the chords.
fn slope(chords: &[[f64; 2]], i: usize) -> f64 {
    let before = i.checked_sub(1).and_then(|i| chords.get(i));
    match (before, chords.get(i)) {
        (Some([width_before, before]), Some([width, after])) => {
            if before * after <= 0.0 {
                return 0.0;
            }
            let parabola = (before * width + after * width_before) / (width_before + width);
            let most = 3.0 * before.abs().min(after.abs());
            parabola.clamp(-most, most)
        }
        (Some([_, only]), None) | (None, Some([_, only])) => *only,
        (None, None) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curve_goes_through_its_points_and_never_turns_between() {
        let xs = [0.0, 0.1, 0.5, 0.6, 1.0, 3.0];
        for ys in [[0.0, 1.0, 1.1, 7.0, 7.0, 8.0], [5.0, 4.0, 1.0, 0.9, 0.1, 0.0]] {
            let curve = MonotoneCubic::new(&xs, &ys);
            let rises = ys[5] > ys[0];
            let mut last = ys[0];
            for i in 0..=3000 {
                let value = curve.eval(0.001 * f64::from(i));
                assert!(if rises { value >= last - 1e-14 } else { value <= last + 1e-14 }, "{i}");
                last = value;
            }
            for (x, y) in xs.iter().zip(ys) {
                assert!((curve.eval(*x) - y).abs() < 1e-14);
            }
            assert_eq!((curve.eval(-1.0), curve.eval(9.0) > 1e9), (ys[0], false));
        }
    }

    /// Third order: half the distance between points, an eighth of the error and less.
    #[test]
    fn curve_is_close_to_a_smooth_one() {
        let worst = |n: u32| {
            let xs: Vec<f64> = (0..=n).map(|i| f64::from(i) / f64::from(n)).collect();
            let ys: Vec<f64> = xs.iter().map(|x| x.exp()).collect();
            let curve = MonotoneCubic::new(&xs, &ys);
            (100..900)
                .map(f64::from)
                .map(|i| (curve.eval(1e-3 * i) - (1e-3 * i).exp()).abs())
                .fold(0.0, f64::max)
        };
        let (coarse, fine) = (worst(20), worst(40));
        assert!(coarse < 1e-4 && coarse / fine > 7.0, "{coarse:e} {fine:e}");
    }

    #[test]
    fn one_point_is_a_constant() {
        let curve = MonotoneCubic::new(&[0.5], &[2.0]);
        assert_eq!([0.0, 0.5, 1.0].map(|x| curve.eval(x)), [2.0; 3]);
    }
}
