//! [`AlbedoTable`](crate::AlbedoTable) in single precision, for the inner loop of a renderer.

use std::f32::consts::PI;

use crate::AlbedoTable;
use crate::math::monotone_cubic::MonotoneCubic;
use crate::table::radial_table_f32::RadialTableF32;

/// Least length that the arithmetic holds.
const LENGTH_MIN: f32 = 1e-18;
/// Greatest length that the arithmetic holds.
const LENGTH_MAX: f32 = 1e18;
/// Radii below this many units of length count as this many for a profile that is finite at r = 0.
const UNIT_RADIUS_MIN: f32 = 1e-12;

/// A model's profiles for every surface albedo, in single precision and constant time.
///
/// Twin of an [`AlbedoTable`], from which its views differ by 1e-5 of a value and less.
///
/// ```
/// use translucid_profile::{AlbedoTable, AlbedoTableF32, NormalizedDiffusion, Profile};
///
/// # fn main() -> Result<(), translucid_profile::ParameterError> {
/// // A model that does not depend on the albedo needs a single row.
/// let model = |a| Ok(Box::new(NormalizedDiffusion::from_d(a, 1.0)?) as Box<dyn Profile>);
/// let table = AlbedoTableF32::from(&AlbedoTable::new(&[1.0], model)?);
/// let profile = table.at(0.8, 2.0);
/// let r_max = profile.truncation_radius(1e-3);
/// assert!(profile.complementary_cdf(r_max) < 1.001e-3);
/// let r = profile.sample_within(0.7, r_max);
/// assert!((profile.cdf(r) / profile.cdf(r_max) - 0.7).abs() < 1e-5);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct AlbedoTableF32 {
    /// Of the rows, apart from them: what is searched lies together.
    surface_albedos: Vec<f64>,
    rows: Vec<Row>,
}

#[derive(Clone, Debug)]
struct Row {
    surface_albedo: f64,
    /// 1 / (albedo of the next row − this one); 0 for the last.
    inverse_width: f64,
    /// Median radius for length 1 as a cubic in the albedo's excess over the row's.
    median: [f64; 4],
    /// Median radius in the unit of the row's table.
    unit_median: f64,
    /// Least radius that counts, in that unit.
    unit_radius_min: f32,
    table: RadialTableF32,
}

impl From<&AlbedoTable> for AlbedoTableF32 {
    fn from(table: &AlbedoTable) -> Self {
        let rows = table.rows();
        let median: &MonotoneCubic = table.median();
        let starts: Vec<f64> = table.surface_albedos().to_vec();
        let new = |(i, (start, cubic)): (usize, (f64, [f64; 4]))| Row {
            surface_albedo: start,
            inverse_width: starts.get(i + 1).map_or(0.0, |next| 1.0 / (next - start)),
            median: cubic,
            unit_median: rows[i].unit_median,
            unit_radius_min: if rows[i].profile.table().is_finite_at_0() { UNIT_RADIUS_MIN } else { 0.0 },
            table: RadialTableF32::new(rows[i].profile.table()),
        };
        let rows = median.intervals().enumerate().map(new).collect();
        Self { surface_albedos: starts, rows }
    }
}

impl AlbedoTableF32 {
    /// The profile of a surface albedo A ∈ \[0, 1\] and a length \[L\].
    ///
    /// The albedo is clamped to \[0, 1\] and the length to \[1e-18, 1e18\]; NaN counts as the least.
    #[inline]
    pub fn at(&self, surface_albedo: f32, length: f32) -> ProfileViewF32<'_> {
        // Rows are close to each other: in single precision their difference from A would have few digits
        let surface_albedo = f64::from(surface_albedo.max(0.0).min(1.0));
        let lower = self.surface_albedos.partition_point(|start| *start <= surface_albedo).saturating_sub(1);
        let upper = (lower + 1).min(self.rows.len() - 1);
        let (lower, upper) = (&self.rows[lower], &self.rows[upper]);
        let excess = (surface_albedo - lower.surface_albedo).max(0.0);
        let mix = (excess * lower.inverse_width).min(1.0);
        let [value, slope, square, cube] = lower.median;
        let median = value + excess * (slope + excess * (square + excess * cube));
        let inverse = 1.0 / (median * f64::from(length.max(LENGTH_MIN).min(LENGTH_MAX)));
        let radius_min =
            lower.unit_radius_min.min(upper.unit_radius_min) / (lower.unit_median * inverse) as f32;
        ProfileViewF32 {
            radius_min: radius_min.max(f32::MIN_POSITIVE),
            rows: [&lower.table, &upper.table],
            scales: [lower, upper].map(|row| (row.unit_median * inverse) as f32),
            shares: [(1.0 - mix) as f32, mix as f32],
        }
    }
}

/// A profile at one surface albedo and length, in single precision: a mixture of two rows of an
/// [`AlbedoTableF32`].
///
/// Densities, cdf and sampling belong to one distribution: up to rounding, sampling is exact for what is
/// evaluated. They do not contain the surface albedo: multiply [`pdf_area`](Self::pdf_area) by A to get the
/// profile R(r). A radius that is negative or NaN counts as 0, and no argument makes a method panic or return a
/// NaN or an infinity.
#[derive(Clone, Copy, Debug)]
pub struct ProfileViewF32<'a> {
    rows: [&'a RadialTableF32; 2],
    /// Reciprocals of the rows' units of length \[L⁻¹\].
    scales: [f32; 2],
    /// The rows' shares in the mixture.
    shares: [f32; 2],
    /// Radii below this count as this for the density per area \[L\].
    radius_min: f32,
}

impl ProfileViewF32<'_> {
    /// Density per length p(r) = 2πr R(r)/A \[L⁻¹\]: the slope of [`cdf`](Self::cdf).
    #[inline]
    pub fn pdf(self, r: f32) -> f32 {
        let r = r.max(0.0);
        let row = |i: usize| self.shares[i] * self.scales[i] * self.rows[i].density(r * self.scales[i]);
        if self.shares[1] == 0.0 { row(0) } else { row(0) + row(1) }
    }

    /// Density per area p_a(r) = R(r)/A \[L⁻²\].
    ///
    /// So that it stays finite, r below the least normal number 1.2e-38 counts as that number and a density above
    /// the greatest number as that one.
    #[inline]
    pub fn pdf_area(self, r: f32) -> f32 {
        let r = r.max(self.radius_min);
        (self.pdf(r) * (0.5 / PI) / r).min(f32::MAX)
    }

    /// Share of the energy that leaves within r, with the digits of a small r.
    #[inline]
    pub fn cdf(self, r: f32) -> f32 {
        let [a, b] = self.shares_within(r);
        a + b
    }

    /// Share of the energy that leaves beyond r, with the digits of a large r.
    #[inline]
    pub fn complementary_cdf(self, r: f32) -> f32 {
        let r = r.max(0.0);
        let row = |i: usize| self.shares[i] * self.rows[i].beyond(r * self.scales[i]);
        if self.shares[1] == 0.0 { row(0) } else { row(0) + row(1) }
    }

    /// Radius of density p(r) for a random number u uniform on [0, 1) \[L\]: chooses a row by u and takes its
    /// quantile.
    ///
    /// Not monotone in u: two strata overlap in r.
    /// u is clamped to \[0, 1\]; NaN counts as 0.
    #[inline]
    pub fn sample(self, u: f32) -> f32 {
        let u = u.max(0.0).min(1.0);
        let is_lower = u < self.shares[0] || self.shares[1] <= 0.0;
        // Chosen first, so that one quantile is taken
        let i = usize::from(!is_lower);
        let u = if is_lower {
            u / self.shares[0]
        } else {
            (u - self.shares[0]) / self.shares[1].max(f32::MIN_POSITIVE)
        };
        self.row_quantile(i, u)
    }

    /// A radius beyond which the share `tail` of the energy or less leaves \[L\]: hardly farther out than need be.
    ///
    /// The tail is clamped to \[2⁻³³, 1\]; NaN counts as 1.
    #[inline]
    pub fn truncation_radius(self, tail: f32) -> f32 {
        let row = |i: usize| self.rows[i].quantile_complement(tail) / self.scales[i];
        if self.shares[1] > 0.0 { row(0).max(row(1)) } else { row(0) }
    }

    /// Radius of density p(r)/cdf(`r_max`) on \[0, `r_max`\] for a random number u uniform on [0, 1) \[L\].
    ///
    /// Like [`sample`](Self::sample) not monotone in u. u is clamped to \[0, 1\]; NaN counts as 0.
    #[inline]
    pub fn sample_within(self, u: f32, r_max: f32) -> f32 {
        let [lower, upper] = self.shares_within(r_max);
        let energy = u.max(0.0).min(1.0) * (lower + upper);
        let is_lower = energy < lower || upper <= 0.0;
        let i = usize::from(!is_lower);
        let u = (if is_lower { energy } else { energy - lower }) / self.shares[i].max(f32::MIN_POSITIVE);
        self.row_quantile(i, u).min(r_max.max(0.0))
    }

    /// Shares of all energy that are within r, row by row.
    #[inline(always)]
    fn shares_within(&self, r: f32) -> [f32; 2] {
        let r = r.max(0.0);
        let row = |i: usize| self.shares[i] * self.rows[i].within(r * self.scales[i]);
        [row(0), if self.shares[1] == 0.0 { 0.0 } else { row(1) }]
    }

    #[inline(always)]
    fn row_quantile(&self, i: usize, u: f32) -> f32 {
        self.rows[i].quantile(u) / self.scales[i]
    }
}
