//! Profiles as smooth tables with bounds on their curvature.
//!
//! A cluster of points stands in for its points with an error that the curvature of the profile bounds (see
//! `gather.rs`), so a sum over clusters needs profiles with a second derivative that is bounded everywhere,
//! and the bound. Here a profile p(r) = R(r)/A is a cubic Hermite spline with sixteen cells an octave: value and
//! slope are continuous, and within a cell the second derivative is linear. Against the profile it is off by
//! less than 1e-3 of its value where that matters (tested for every model).
//! The profile need not fall monotonically.

use translucid_profile::ProfileViewF32;

/// Cells an octave of the radius: 2 to the power of this.
pub(crate) const CELL_BITS: u32 = 4;
/// Fraction bits of an `f32`.
const FRACTION_BITS: u32 = 23;
/// Number of mantissa bits below the cell's.
const SHIFT: u32 = FRACTION_BITS - CELL_BITS;
/// Octaves below and above the profile's scale that the table spans.
pub(crate) const OCTAVES_BELOW: u32 = 20;
pub(crate) const OCTAVES_ABOVE: u32 = 14;
const CELLS: usize = ((OCTAVES_BELOW + OCTAVES_ABOVE) << CELL_BITS) as usize;
/// Bits of the table's first radius, 2⁻²⁰, in units of the scale.
const FIRST_BITS: u32 = (127 - OCTAVES_BELOW) << FRACTION_BITS;
/// Bits of its end.
const END_BITS: u32 = (127 + OCTAVES_ABOVE) << FRACTION_BITS;

/// A radial profile per area, p(r) = R(r)/A, in units of a length near its median radius.
///
/// Below 2⁻²⁰ of that length it is constant, beyond 2¹⁴ zero.
#[derive(Clone, Debug)]
pub(crate) struct SmoothProfile {
    /// Length of the unit, for a profile of length 1.
    scale: f32,
    /// Per cell the polynomial in θ ∈ [0, 1).
    pub(super) cells: Vec<[f32; 4]>,
    /// Per cell: no greater is max(|p''|, |p'|/r) from its start on.
    pub(super) curvature: Vec<f32>,
}

/// Value and derivatives at a radius.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Jet {
    pub(crate) value: f32,
    pub(crate) slope: f32,
    pub(crate) second: f32,
}

impl SmoothProfile {
    /// A row of a table, of length 1.
    pub(crate) fn tabulated(view: ProfileViewF32<'_>) -> Self {
        Self::new(view.truncation_radius(0.5), |r| view.pdf_area(r))
    }

    /// Tabulates a density per area at the radii around `scale`.
    fn new(scale: f32, density: impl Fn(f32) -> f32) -> Self {
        let scale = scale.clamp(1e-15, 1e15);
        let knot = |i: usize| f64::from(f32::from_bits(FIRST_BITS + ((i as u32) << SHIFT)));
        let square = f64::from(scale).powi(2);
        let at = |t: f64| f64::from(density(t as f32 * scale)) * square;
        let mut values: Vec<f64> = (0..=CELLS).map(|i| at(knot(i))).collect();
        values[CELLS] = 0.0;
        let slope = |i: usize| {
            // Flat at both ends, where constants adjoin
            if i == 0 || i == CELLS {
                return 0.0;
            }
            let step = knot(i) / 256.0;
            (at(knot(i) + step) - at(knot(i) - step)) / (2.0 * step)
        };
        let cell = |i: usize| {
            let width = knot(i + 1) - knot(i);
            let (m0, m1) = (slope(i) * width, slope(i + 1) * width);
            let rise = values[i + 1] - values[i];
            [values[i], m0, 3.0 * rise - 2.0 * m0 - m1, m0 + m1 - 2.0 * rise].map(|c| c as f32)
        };
        let cells: Vec<[f32; 4]> = (0..CELLS).map(cell).collect();
        let mut curvature: Vec<f32> = Vec::with_capacity(CELLS);
        let mut most = 0.0_f64;
        for (i, cell) in cells.iter().enumerate().rev() {
            most = most.max(bend(cell, knot(i), knot(i + 1) - knot(i)));
            curvature.push((most * (1.0 + 1e-6)) as f32);
        }
        curvature.reverse();
        Self { scale, cells, curvature }
    }

    /// Length of the unit, for a profile of length 1.
    pub(crate) fn scale(&self) -> f32 {
        self.scale
    }

    /// Value and derivatives at t ≥ 0 units.
    #[inline]
    pub(crate) fn eval(&self, t: f32) -> Jet {
        let bits = t.max(f32::from_bits(FIRST_BITS)).to_bits();
        if bits >= END_BITS {
            return Jet::default();
        }
        let [c0, c1, c2, c3] = self.cells[((bits - FIRST_BITS) >> SHIFT) as usize];
        // The mantissa below the cell's bits is θ, exactly
        let theta = f32::from_bits(0x3f80_0000 | (bits << CELL_BITS) & 0x007f_ffff) - 1.0;
        let per_width = f32::from_bits((254 + CELL_BITS - (bits >> FRACTION_BITS)) << FRACTION_BITS);
        Jet {
            value: c0 + theta * (c1 + theta * (c2 + theta * c3)),
            slope: (c1 + theta * (2.0 * c2 + 3.0 * theta * c3)) * per_width,
            second: (2.0 * c2 + 6.0 * theta * c3) * per_width * per_width,
        }
    }

    /// No less than |p''| and |p'|/r at any radius from t units on.
    #[inline]
    pub(crate) fn curvature_from(&self, t: f32) -> f32 {
        let bits = t.max(f32::from_bits(FIRST_BITS)).to_bits();
        if bits >= END_BITS { 0.0 } else { self.curvature[((bits - FIRST_BITS) >> SHIFT) as usize] }
    }
}

/// Greatest |p''| and |p'|/r in a cell.
fn bend(cell: &[f32; 4], start: f64, width: f64) -> f64 {
    let [_, c1, c2, c3] = cell.map(f64::from);
    let slope = |theta: f64| (c1 + theta * (2.0 * c2 + 3.0 * theta * c3)).abs();
    let second = (2.0 * c2).abs().max((2.0 * c2 + 6.0 * c3).abs()) / (width * width);
    let mut steepest = slope(0.0).max(slope(1.0));
    let turning = -c2 / (3.0 * c3);
    if turning > 0.0 && turning < 1.0 {
        steepest = steepest.max(slope(turning));
    }
    second.max(steepest / (width * start))
}

#[cfg(test)]
mod tests {
    use translucid_profile::NormalizedDiffusion;

    use super::*;

    /// Burley's closed form of width d = 1.
    fn normalized_diffusion() -> SmoothProfile {
        let profile = NormalizedDiffusion::from_d(1.0, 1.0).unwrap();
        SmoothProfile::new(profile.quantile(0.5) as f32, |r| profile.pdf_area(f64::from(r)) as f32)
    }

    #[test]
    fn table_agrees_with_normalized_diffusion() {
        let table = normalized_diffusion();
        let exact = NormalizedDiffusion::from_d(1.0, 1.0).unwrap();
        let mut worst = 0.0_f32;
        for i in 0..20_000 {
            let r = 1e-5 * (i as f32 * 7.5e-4).exp();
            let density = table.eval(r / table.scale()).value / table.scale().powi(2);
            // Relative to the value, or to a millionth of the energy a ring of that radius would hold
            let exact = exact.pdf_area(f64::from(r)) as f32;
            let error = (density - exact).abs() / (exact + 1e-6 / (r * r));
            worst = worst.max(error);
        }
        assert!(worst < 1e-3, "{worst}");
    }

    /// |p(t) − p(s) − p'(s)(t − s)| ≤ ½ K (t − s)² for all radii from the least on, as clusters need it.
    #[test]
    fn curvature_bounds_the_error_of_tangents() {
        let table = normalized_diffusion();
        for i in 0..200_u32 {
            let random = |salt: u32| sobol_burley::sample(i, salt, 5);
            let least = (20.0 * random(0) - 15.0).exp2();
            let at = |u: f32| least * (1.0 + 4.0 * u * u * u);
            for (s, t) in [(at(random(1)), at(random(2))), (least, at(random(1)))] {
                let (from, to) = (table.eval(s), table.eval(t));
                let error = (to.value - from.value - from.slope * (t - s)).abs();
                let bound = 0.5 * table.curvature_from(least) * (t - s).powi(2);
                let rounding = 4e-6 * (to.value.abs() + from.value.abs() + (from.slope * (t - s)).abs());
                assert!(error <= bound + rounding, "{s} to {t}: {error:e} > {bound:e}");
                let slope = table.eval(t).slope.abs() / t;
                assert!(slope <= table.curvature_from(least) * 1.0001, "{t}: {slope}");
            }
        }
    }
}
