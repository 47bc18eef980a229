//! A phase function as values over the cosine of the deflection.

use std::f64::consts::PI;
use std::fmt;

use translucid_profile::{ParameterError, require};

/// Most rows.
const MOST_ROWS: usize = 10_000;
/// Moments that are kept; later ones count as 0.
const MOMENTS: usize = 1024;
/// Changes of the mean cosine g without every second row, as parts of g and of 1 − g, beyond which it is not known: a table
/// that is linear between rows is off by a third of them, if it is not far too coarse.
const COARSE: [f64; 2] = [0.01, 0.03];

/// A phase function that is linear in the cosine between rows.
///
/// ```
/// use translucid_reference::walk::PhaseTable;
///
/// // Any scale does: its integral is made 1
/// let table = PhaseTable::new(vec![[-1.0, 0.2], [0.0, 0.2], [1.0, 3.0]])?;
/// assert!((table.cdf(1.0) - 1.0).abs() < 1e-15);
/// # Ok::<(), translucid_profile::ParameterError>(())
/// ```
#[derive(Clone)]
pub struct PhaseTable {
    /// Cosines and values as they were given.
    rows: Vec<[f64; 2]>,
    /// Density over the integral of the values.
    scale: f64,
    /// Probability up to each row.
    cdf: Vec<f64>,
    /// χ₀ …
    moments: Vec<f64>,
}

impl fmt::Debug for PhaseTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "PhaseTable of {} rows", self.rows.len())
    }
}

impl PartialEq for PhaseTable {
    fn eq(&self, other: &Self) -> bool {
        self.rows == other.rows
    }
}

impl PhaseTable {
    /// Table with rows of a cosine, rising from −1 to 1, and a value in any one unit.
    ///
    /// # Errors
    /// There are fewer than 2 or more than 10 000 rows, cosines do not rise from −1 to 1, values are not finite and at
    /// least 0, or all of them are 0.
    pub fn new(rows: Vec<[f64; 2]>) -> Result<Self, ParameterError> {
        let count = rows.len();
        require(
            (2..=MOST_ROWS).contains(&count),
            "number of rows of the phase function",
            count as f64,
            "in [2, 10000]",
        )?;
        require(rows[0][0] == -1.0, "first cosine of the phase function", rows[0][0], "-1")?;
        require(rows[count - 1][0] == 1.0, "last cosine of the phase function", rows[count - 1][0], "1")?;
        for pair in rows.windows(2) {
            require(
                pair[1][0] > pair[0][0],
                "cosine of the phase function",
                pair[1][0],
                "greater than the one before",
            )?;
        }
        for [_, value] in &rows {
            let is_value = (0.0..=1e100).contains(value);
            require(is_value, "value of the phase function", *value, "in [0, 1e100]")?;
        }
        let mut cdf = vec![0.0];
        let mut sum = 0.0;
        for pair in rows.windows(2) {
            sum += 0.5 * (pair[0][1] + pair[1][1]) * (pair[1][0] - pair[0][0]);
            cdf.push(sum);
        }
        require(sum > 1e-100, "integral of the phase function", sum, "greater than 1e-100")?;
        cdf.iter_mut().for_each(|part| *part /= sum);
        let moments = moments(&rows, sum);
        let g = moments[1];
        require(g.abs() < 1.0, "mean cosine of the phase function", g, "in (-1, 1)")?;
        Ok(Self { rows, scale: 1.0 / (2.0 * PI * sum), cdf, moments })
    }

    /// Table with rows of an angle in degrees, rising from 0 to 180, and a value, as [`new`](Self::new) takes cosines.
    ///
    /// # Errors
    /// As there.
    pub fn from_degrees(rows: &[[f64; 2]]) -> Result<Self, ParameterError> {
        let ends = [rows.first(), rows.last()].map(|row| row.map_or(f64::NAN, |row| row[0]));
        require(ends[0] == 0.0, "first angle of the phase function", ends[0], "0 degrees")?;
        require(ends[1] == 180.0, "last angle of the phase function", ends[1], "180 degrees")?;
        Self::new(rows.iter().rev().map(|[angle, value]| [libm::cos(angle.to_radians()), *value]).collect())
    }

    /// Rows as they were given, over cosines.
    pub fn rows(&self) -> &[[f64; 2]] {
        &self.rows
    }

    /// The table of every second row, and the last; none if there are fewer than three.
    pub fn thinned(&self) -> Option<Self> {
        let last = *self.rows.last()?;
        let mut rows: Vec<[f64; 2]> = self.rows.iter().copied().step_by(2).collect();
        if rows.last() != Some(&last) {
            rows.push(last);
        }
        Self::new(rows).ok().filter(|thinned| thinned.rows.len() < self.rows.len())
    }

    /// Warns of rows that are too far apart for the mean cosine to be known, which tells how far light gets: every second one
    /// gives another by a part of itself, or of what it lacks of 1.
    pub fn warning(&self) -> Option<String> {
        let (g, thinned) = (self.moment(1), self.thinned()?.moment(1));
        let change = (thinned - g).abs();
        let is_known = change <= COARSE[0] * g.abs().max(0.1) && change <= COARSE[1] * (1.0 - g.abs());
        (!is_known).then(|| {
            format!(
                "the rows of the phase function are too far apart for its peak: its mean cosine is {g:.4}, but {thinned:.4} \
                 with every second row left out; give rows at smaller steps where it is steep"
            )
        })
    }

    pub(crate) fn moment(&self, l: usize) -> f64 {
        self.moments.get(l).copied().unwrap_or(0.0)
    }

    /// Density per solid angle \[sr⁻¹\].
    pub fn eval(&self, cosine: f64) -> f64 {
        let (i, part) = self.place(cosine);
        let [low, high] = [self.rows[i][1], self.rows[i + 1][1]];
        self.scale * (low + part * (high - low))
    }

    /// Probability of a cosine that is at most this one.
    pub fn cdf(&self, cosine: f64) -> f64 {
        let (i, part) = self.place(cosine);
        let [[x0, low], [x1, high]] = [self.rows[i], self.rows[i + 1]];
        let width = x1 - x0;
        self.cdf[i] + 2.0 * PI * self.scale * width * part * (low + 0.5 * part * (high - low))
    }

    /// Row before a cosine, and which part of the way to the next it is.
    fn place(&self, cosine: f64) -> (usize, f64) {
        let above = self.rows.partition_point(|row| row[0] <= cosine);
        let i = above.clamp(1, self.rows.len() - 1) - 1;
        let [x0, x1] = [self.rows[i][0], self.rows[i + 1][0]];
        (i, ((cosine - x0) / (x1 - x0)).clamp(0.0, 1.0))
    }
}

/// Moments of rows whose integral is known: −∫ p' Q_l with Q_l = ∫ P_l = (P_{l+1} − P_{l−1})/(2l + 1), which is 0 at both
/// ends, and p' constant from row to row.
fn moments(rows: &[[f64; 2]], integral: f64) -> Vec<f64> {
    let mut sums = vec![0.0; MOMENTS];
    let mut before = integrated_twice(rows[0][0]);
    for pair in rows.windows(2) {
        let slope = (pair[1][1] - pair[0][1]) / (pair[1][0] - pair[0][0]) / integral;
        let here = integrated_twice(pair[1][0]);
        for (l, sum) in sums.iter_mut().enumerate().skip(1) {
            *sum -= slope * (here[l] - before[l]);
        }
        before = here;
    }
    sums[0] = 1.0;
    sums
}

/// ∫∫ P_l: ((P_{l+2} − P_l)/(2l + 3) − (P_l − P_{l−2})/(2l − 1))/(2l + 1), and (x³/3 − x)/2 for l = 1; 0 for l = 0.
fn integrated_twice(x: f64) -> Vec<f64> {
    let mut p = vec![1.0, x];
    for n in 1..=MOMENTS {
        let order = n as f64;
        p.push(((2.0 * order + 1.0) * x * p[n] - order * p[n - 1]) / (order + 1.0));
    }
    let at = |l: usize| {
        let order = l as f64;
        let [above, below] = [p[l + 2] - p[l], p[l] - p[l - 2]];
        (above / (2.0 * order + 3.0) - below / (2.0 * order - 1.0)) / (2.0 * order + 1.0)
    };
    let first = [0.0, 0.5 * x * (x * x / 3.0 - 1.0)];
    first.into_iter().chain((2..MOMENTS).map(at)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps of a degree hold the peak of g = 0.8, but not that of g = 0.98, of which they make 0.982; nor is 0.99 near to
    /// 0.995.
    #[test]
    fn rows_too_far_apart_for_the_peak_are_told_of() {
        let by_degrees = |g: f64, steps: u32| {
            let value =
                |degrees: f64| libm::pow(1.0 + g * g - 2.0 * g * libm::cos(degrees.to_radians()), -1.5);
            let angles = (0..=steps).map(|i| 180.0 * f64::from(i) / f64::from(steps));
            PhaseTable::from_degrees(&angles.map(|angle| [angle, value(angle)]).collect::<Vec<_>>()).unwrap()
        };
        for (g, steps) in [(0.0, 10), (0.8, 180), (-0.8, 180), (0.98, 1800), (0.99, 3600)] {
            assert_eq!(by_degrees(g, steps).warning(), None, "{g}");
        }
        for (g, steps) in [(0.8, 20), (0.98, 180), (-0.98, 180), (0.995, 360)] {
            let warning = by_degrees(g, steps).warning();
            let found = format!("its mean cosine is {:.4}, but", by_degrees(g, steps).moment(1));
            assert!(warning.as_ref().is_some_and(|warning| warning.contains(&found)), "{g}: {warning:?}");
        }
        assert_eq!(PhaseTable::new(vec![[-1.0, 1.0], [1.0, 3.0]]).unwrap().warning(), None);
    }

    #[test]
    fn rows_that_are_no_phase_function_are_refused() {
        let refused = |rows: &[[f64; 2]]| PhaseTable::new(rows.to_vec()).unwrap_err().to_string();
        assert!(refused(&[[-1.0, 1.0]]).contains("number of rows of the phase function is 1"));
        assert!(refused(&[[-0.9, 1.0], [1.0, 1.0]]).contains("first cosine of the phase function is -0.9"));
        assert!(refused(&[[-1.0, 1.0], [0.9, 1.0]]).contains("last cosine of the phase function is 0.9"));
        assert!(refused(&[[-1.0, 1.0], [-1.0, 1.0], [1.0, 1.0]]).contains("greater than the one before"));
        assert!(refused(&[[-1.0, -0.1], [1.0, 1.0]]).contains("value of the phase function is -0.1"));
        assert!(refused(&[[-1.0, f64::NAN], [1.0, 1.0]]).contains("NaN"));
        assert!(refused(&[[-1.0, 0.0], [1.0, 0.0]]).contains("integral of the phase function is 0"));
    }
}
