//! Tables of one model for every surface albedo, as a texture of albedos needs them.
//!
//! A row is the [table](crate::TabulatedProfile) of the model at one surface albedo and length 1.
//! Between two rows the distribution of radii is a mixture of theirs, in radii that the medians scale:
//!
//! ```text
//! cdf(r; A) = (1 − m) cdf₀(r w₀/w(A)) + m cdf₁(r w₁/w(A)),     m = (A − A₀)/(A₁ − A₀)
//! ```
//!
//! where w(A) goes through the rows' medians as a monotone cubic.
//! A mixture is sampled by choosing one of the two and sampling that: as exactly as a row.

use crate::error::{ParameterError, require};
use crate::math::monotone_cubic::MonotoneCubic;
use crate::profile::{Profile, finite_quotient, methods_of};
use crate::table::precision::{Number, Precision};
use crate::table::radial_table::RadialTable;
use crate::table::tabulated_profile::TabulatedProfile;

/// Number of rows that [`AlbedoTable::for_every_albedo`] makes.
const ROWS: usize = 80;
/// Least albedo of its rows.
const LEAST_ALBEDO: f64 = 1e-3;

/// A model's profiles for every surface albedo, in constant time.
///
/// Below the first row and above the last one the shape is that of the row.
/// A table is made in double precision; [`AlbedoTableF32`] is one for the inner loop of a renderer, whose views differ by
/// 1e-5 of a value and less.
///
/// ```
/// use translucid_profile::{
///     AlbedoTable, AlbedoTableF32, Configuration, NormalizedDiffusion, Parameterization, Profile,
/// };
///
/// # fn main() -> Result<(), translucid_profile::ParameterError> {
/// let model = |surface_albedo| {
///     let (parameterization, configuration) = (Parameterization::Mfp, Configuration::Searchlight);
///     let profile = NormalizedDiffusion::new(surface_albedo, 1.0, parameterization, configuration)?;
///     Ok(Box::new(profile) as Box<dyn Profile>)
/// };
/// let table = AlbedoTable::for_every_albedo(model)?;
/// // A texel of albedo 0.4321 with a mean free path of 2 mm
/// let profile = table.at(0.4321, 2.0);
/// let expected = NormalizedDiffusion::new(0.4321, 2.0, Parameterization::Mfp, Configuration::Searchlight)?;
/// assert!((profile.cdf(3.0) - expected.cdf(3.0)).abs() < 1e-5);
/// assert!((profile.eval(3.0) / expected.eval(3.0) - 1.0).abs() < 1e-4);
///
/// let single = AlbedoTableF32::from(&table);
/// let profile = single.at(0.4321, 2.0);
/// let r_max = profile.truncation_radius(1e-3);
/// let r = profile.sample_within(0.7, r_max);
/// assert!(r < r_max && profile.pdf(r) > 0.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct AlbedoTable<T: Precision = f64> {
    /// Albedos of the rows, apart from them: what is searched lies together.
    surface_albedos: Vec<f64>,
    rows: Vec<Row<T>>,
}

/// An [`AlbedoTable`] in single precision.
pub type AlbedoTableF32 = AlbedoTable<f32>;

#[derive(Clone, Debug)]
struct Row<T: Precision> {
    /// 1 / (albedo of the next row − this one); 0 for the last.
    inverse_width: f64,
    /// Median radius for length 1 as a cubic in the albedo's excess over the row's.
    median: [f64; 4],
    /// Median radius in the unit of the row's table.
    unit_median: f64,
    /// Least radius that counts for the density per area, in that unit.
    unit_radius_min: T,
    /// The row's [`TabulatedProfile::cdf_error`].
    cdf_error: f64,
    table: RadialTable<T>,
}

impl AlbedoTable {
    /// Makes a row for each of the surface albedos, which rise, from the profiles of length 1 that `profile_of`
    /// gives.
    ///
    /// A black row gets the shape of the next one.
    ///
    /// # Errors
    /// There is no albedo, one is not in \[0, 1\] or not greater than the one before, or the model refuses one.
    pub fn new(
        surface_albedos: &[f64],
        mut profile_of: impl FnMut(f64) -> Result<Box<dyn Profile>, ParameterError>,
    ) -> Result<Self, ParameterError> {
        require(!surface_albedos.is_empty(), "number of surface albedos", 0.0, "at least 1")?;
        let mut before = -1.0;
        for &albedo in surface_albedos {
            let is_next = (0.0..=1.0).contains(&albedo) && albedo > before;
            before = require(is_next, "surface_albedo", albedo, "in [0, 1] and greater than the one before")?;
        }
        let profiles = surface_albedos.iter().map(|&albedo| Ok(TabulatedProfile::new(&*profile_of(albedo)?)));
        let mut profiles: Vec<TabulatedProfile> = profiles.collect::<Result<_, ParameterError>>()?;
        if let [black, next, ..] = &mut profiles[..]
            && black.surface_albedo() == 0.0
        {
            *black = next.scaled(1.0, 0.0)?;
        }
        Ok(Self::from_rows(surface_albedos, &profiles))
    }

    /// Makes rows for all the surface albedos that the model reaches, closer to each other towards 0 and 1.
    ///
    /// There are 80, from 1e-3 to the most that the model reaches. Between rows the cdf is off by less
    /// than 1e-4, by less than 3e-4 for quantized diffusion above 0.999.
    ///
    /// # Errors
    /// The model refuses an albedo below the one that it names as its limit, or below 0.9.
    pub fn for_every_albedo(
        mut profile_of: impl FnMut(f64) -> Result<Box<dyn Profile>, ParameterError>,
    ) -> Result<Self, ParameterError> {
        let most = greatest_albedo(&mut profile_of)?;
        // 1 − A = (1 − y³)³, in equal steps of y: shapes change with α ~ √A in dark media, and their tails ever
        // faster towards 1
        let y = |albedo: f64| libm::cbrt(1.0 - libm::cbrt(1.0 - albedo));
        let (first, last) = (y(LEAST_ALBEDO), y(most));
        let albedo = |i: usize| {
            let y = first + (last - first) * i as f64 / (ROWS - 1) as f64;
            if i + 1 == ROWS { most } else { 1.0 - (1.0 - y * y * y).powi(3) }
        };
        let albedos: Vec<f64> = (0..ROWS).map(albedo).collect();
        Self::new(&albedos, profile_of)
    }

    /// Rows from tables of length 1 in the order of their albedos.
    fn from_rows(surface_albedos: &[f64], profiles: &[TabulatedProfile]) -> Self {
        let medians: Vec<f64> = profiles.iter().map(|profile| profile.quantile(0.5)).collect();
        let median = MonotoneCubic::new(surface_albedos, &medians);
        let row = |(i, (profile, (_, median))): (usize, (&TabulatedProfile, (f64, [f64; 4])))| {
            let table = profile.table();
            Row {
                median,
                inverse_width: surface_albedos
                    .get(i + 1)
                    .map_or(0.0, |next| 1.0 / (next - surface_albedos[i])),
                unit_median: table.quantile(0.5),
                unit_radius_min: if table.is_finite_at_0() { f64::UNIT_RADIUS_MIN } else { 0.0 },
                cdf_error: profile.cdf_error(),
                table: table.clone(),
            }
        };
        Self {
            surface_albedos: surface_albedos.to_vec(),
            rows: profiles.iter().zip(median.intervals()).enumerate().map(row).collect(),
        }
    }
}

impl From<&AlbedoTable> for AlbedoTableF32 {
    fn from(table: &AlbedoTable) -> Self {
        let row = |row: &Row<f64>| Row {
            inverse_width: row.inverse_width,
            median: row.median,
            unit_median: row.unit_median,
            unit_radius_min: if row.unit_radius_min > 0.0 { f32::UNIT_RADIUS_MIN } else { 0.0 },
            cdf_error: row.cdf_error,
            table: RadialTable::from(&row.table),
        };
        Self { surface_albedos: table.surface_albedos.clone(), rows: table.rows.iter().map(row).collect() }
    }
}

impl AlbedoTableF32 {
    /// The table for a shader: of each row the surface albedo, the reciprocal distance to the next one, four coefficients of
    /// the median radius, the median and the radius beyond which the share `tail` is in the row's unit, and the place of its
    /// table; then these tables.
    #[doc(hidden)]
    pub fn words(&self, tail: f32) -> Vec<f32> {
        let mut rows = Vec::new();
        let mut tables = Vec::new();
        for (albedo, row) in self.surface_albedos.iter().zip(&self.rows) {
            let [value, slope, square, cube] = row.median;
            let numbers = [*albedo, row.inverse_width, value, slope, square, cube, row.unit_median];
            rows.extend(numbers.map(|number| number as f32));
            let at = 9 * self.rows.len() + tables.len();
            rows.extend([row.table.quantile_complement(tail), at as f32]);
            tables.extend(row.table.words());
        }
        rows.extend(tables);
        rows
    }
}

impl<T: Precision> AlbedoTable<T> {
    /// Surface albedos of the rows.
    pub fn surface_albedos(&self) -> &[f64] {
        &self.surface_albedos
    }

    /// The worst of the rows' [`TabulatedProfile::cdf_error`].
    pub fn cdf_error_of_rows(&self) -> f64 {
        self.rows.iter().map(|row| row.cdf_error).fold(0.0, f64::max)
    }

    /// The profile of a surface albedo A ∈ \[0, 1\] and a length \[L\].
    ///
    /// The albedo is clamped to \[0, 1\] and the length to \[1e-150, 1e150\], in single precision to \[1e-18, 1e18\];
    /// NaN counts as the least.
    #[inline]
    pub fn at(&self, surface_albedo: T, length: T) -> ProfileView<'_, T> {
        let surface_albedo = surface_albedo.max(T::ZERO).min(T::ONE);
        let (i, excess, median) = self.row_of(surface_albedo);
        let (lower, upper) = (&self.rows[i], &self.rows[(i + 1).min(self.rows.len() - 1)]);
        let mix = (excess * lower.inverse_width).min(1.0);
        let inverse = 1.0 / (median * usual(length).wide());
        let scales = [lower, upper].map(|row| T::nearest(row.unit_median * inverse));
        let radius_min = lower.unit_radius_min.min(upper.unit_radius_min) / scales[0];
        ProfileView {
            rows: [&lower.table, &upper.table],
            scales,
            shares: [T::nearest(1.0 - mix), T::nearest(mix)],
            radius_min: radius_min.max(T::MIN_POSITIVE),
            surface_albedo,
        }
    }

    /// The radius within which half of the energy of that profile leaves \[L\].
    #[inline]
    pub fn median_radius(&self, surface_albedo: T, length: T) -> T {
        let (_, _, median) = self.row_of(surface_albedo.max(T::ZERO).min(T::ONE));
        T::nearest(median * usual(length).wide())
    }

    /// The row below a surface albedo in \[0, 1\], how far that is above the row's, and the median radius for length 1.
    #[inline]
    fn row_of(&self, surface_albedo: T) -> (usize, f64, f64) {
        // Rows are close to each other: in single precision their difference from A would have few digits
        let wide = surface_albedo.wide();
        let i = self.surface_albedos.partition_point(|start| *start <= wide).saturating_sub(1);
        let excess = (wide - self.surface_albedos[i]).max(0.0);
        let [value, slope, square, cube] = self.rows[i].median;
        (i, excess, value + excess * (slope + excess * (square + excess * cube)))
    }
}

/// A length that tables can be scaled by.
#[inline]
fn usual<T: Precision>(length: T) -> T {
    length.max(T::LENGTHS[0]).min(T::LENGTHS[1])
}

/// The greatest surface albedo for which the model has a profile of length 1.
fn greatest_albedo(
    profile_of: &mut impl FnMut(f64) -> Result<Box<dyn Profile>, ParameterError>,
) -> Result<f64, ParameterError> {
    let Err(error) = profile_of(1.0) else { return Ok(1.0) };
    let limit = error.limit.unwrap_or(1.0).min(1.0);
    let mut last_error = error;
    for below in [0.0, 1e-9, 1e-6, 1e-4, 1e-3, 1e-2, 0.1] {
        let albedo = limit * (1.0 - below);
        match profile_of(albedo) {
            Ok(_) => return Ok(albedo),
            Err(error) => last_error = error,
        }
    }
    Err(last_error)
}

/// A profile at one surface albedo and length: a mixture of two rows of an [`AlbedoTable`].
///
/// Densities, cdf and sampling belong to one distribution: up to rounding, sampling is exact for what is evaluated.
/// They do not contain the surface albedo: R(r) is A times [`pdf_area`](Self::pdf_area).
/// A radius that is negative or NaN counts as 0, and no argument makes a method panic or return a NaN or an
/// infinity.
#[derive(Clone, Copy, Debug)]
pub struct ProfileView<'a, T: Precision = f64> {
    rows: [&'a RadialTable<T>; 2],
    /// Reciprocals of the rows' units of length \[L⁻¹\].
    scales: [T; 2],
    /// The rows' shares in the mixture.
    shares: [T; 2],
    /// Radii below this count as this for the density per area \[L\].
    radius_min: T,
    surface_albedo: T,
}

/// A [`ProfileView`] in single precision.
pub type ProfileViewF32<'a> = ProfileView<'a, f32>;

impl<T: Precision> ProfileView<'_, T> {
    /// Surface albedo A = ∫ R 2πr dr.
    #[inline]
    pub fn surface_albedo(self) -> T {
        self.surface_albedo
    }

    /// Density per length p(r) = 2πr R(r)/A \[L⁻¹\]: the slope of [`cdf`](Self::cdf).
    #[inline]
    pub fn pdf(self, r: T) -> T {
        let r = r.max(T::ZERO);
        let row = |i: usize| self.shares[i] * self.scales[i] * self.rows[i].density(r * self.scales[i]);
        if self.shares[1] == T::ZERO { row(0) } else { row(0) + row(1) }
    }

    /// Density per area p_a(r) = R(r)/A \[L⁻²\].
    ///
    /// So that it stays finite, r below the least normal number, 2.2e-308 or 1.2e-38, counts as that number and a
    /// density above the greatest number as that one.
    #[inline]
    pub fn pdf_area(self, r: T) -> T {
        let r = r.max(self.radius_min);
        (self.pdf(r) * T::INVERSE_TURN / r).min(T::MAX)
    }

    /// Share of the energy that leaves within r, with the digits of a small r.
    #[inline]
    pub fn cdf(self, r: T) -> T {
        let [a, b] = self.shares_within(r);
        (a + b).min(T::ONE)
    }

    /// Share of the energy that leaves beyond r, with the digits of a large r.
    #[inline]
    pub fn complementary_cdf(self, r: T) -> T {
        let r = r.max(T::ZERO);
        let row = |i: usize| self.shares[i] * self.rows[i].beyond(r * self.scales[i]);
        if self.shares[1] == T::ZERO { row(0) } else { (row(0) + row(1)).min(T::ONE) }
    }

    /// Radius of density p(r) for a random number u uniform on [0, 1) \[L\]: chooses a row by u and takes its
    /// quantile.
    ///
    /// Not monotone in u: two strata overlap in r.
    /// u is clamped to \[0, 1\]; NaN counts as 0.
    #[inline]
    pub fn sample(self, u: T) -> T {
        let u = u.max(T::ZERO).min(T::ONE);
        let is_lower = u < self.shares[0] || self.shares[1] <= T::ZERO;
        // Chosen first, so that one quantile is taken
        let i = usize::from(!is_lower);
        let u = if is_lower {
            u / self.shares[0]
        } else {
            (u - self.shares[0]) / self.shares[1].max(T::MIN_POSITIVE)
        };
        self.row_quantile(i, u)
    }

    /// A radius beyond which the share `tail` of the energy or less leaves \[L\]: hardly farther out than need be.
    ///
    /// The tail is clamped to \[2.2e-308, 1\], in single precision to \[2⁻³³, 1\]; NaN counts as 1.
    #[inline]
    pub fn truncation_radius(self, tail: T) -> T {
        let row = |i: usize| self.rows[i].quantile_complement(tail) / self.scales[i];
        if self.shares[1] > T::ZERO { row(0).max(row(1)) } else { row(0) }
    }

    /// Radius of density p(r)/cdf(`r_max`) on \[0, `r_max`\] for a random number u uniform on [0, 1) \[L\].
    ///
    /// Like [`sample`](Self::sample) not monotone in u. u is clamped to \[0, 1\]; NaN counts as 0.
    #[inline]
    pub fn sample_within(self, u: T, r_max: T) -> T {
        let [lower, upper] = self.shares_within(r_max);
        let energy = u.max(T::ZERO).min(T::ONE) * (lower + upper);
        let is_lower = energy < lower || upper <= T::ZERO;
        let i = usize::from(!is_lower);
        let u = (if is_lower { energy } else { energy - lower }) / self.shares[i].max(T::MIN_POSITIVE);
        self.row_quantile(i, u).min(r_max.max(T::ZERO))
    }

    /// Shares of all energy that are within r, row by row.
    #[inline(always)]
    fn shares_within(&self, r: T) -> [T; 2] {
        let r = r.max(T::ZERO);
        let row = |i: usize| self.shares[i] * self.rows[i].within(r * self.scales[i]);
        [row(0), if self.shares[1] == T::ZERO { T::ZERO } else { row(1) }]
    }

    #[inline(always)]
    fn row_quantile(&self, i: usize, u: T) -> T {
        self.rows[i].quantile(u) / self.scales[i]
    }
}

impl ProfileView<'_> {
    /// Reflectance profile R(r) \[L⁻²\].
    ///
    /// r below the least normal number 2.2e-308 counts as that number, and R above the greatest number as that
    /// one.
    pub fn eval(self, r: f64) -> f64 {
        let r = r.max(self.radius_min);
        finite_quotient(self.eval_times_r(r), r)
    }

    /// Profile times radius, r R(r) \[L⁻¹\].
    pub fn eval_times_r(self, r: f64) -> f64 {
        self.surface_albedo * (self.pdf(r) * f64::INVERSE_TURN)
    }

    /// Energy that leaves within r: A cdf(r).
    pub fn enclosed(self, r: f64) -> f64 {
        self.surface_albedo * self.cdf(r)
    }

    /// Radius within which the share u ∈ \[0, 1\] of the energy leaves \[L\], which rises with u: a few steps of
    /// Newton between the rows' quantiles.
    ///
    /// u is clamped to \[0, 1\]; NaN counts as 0. u = 1 gives the radius of the complement 2.2e-308.
    pub fn quantile(self, u: f64) -> f64 {
        let u = u.max(0.0).min(1.0);
        if u < 0.5 {
            self.solve(|row| row.quantile(u), |r| self.cdf(r) - u)
        } else {
            self.quantile_complement(1.0 - u)
        }
    }

    /// Radius beyond which the share u ∈ \[0, 1\] of the energy leaves \[L\], with every digit of the tail.
    ///
    /// u is clamped to \[2.2e-308, 1\]; NaN counts as 1.
    pub fn quantile_complement(self, u: f64) -> f64 {
        let u = u.min(1.0).max(f64::MIN_POSITIVE);
        if u > 0.5 {
            return self.quantile(1.0 - u);
        }
        self.solve(|row| row.quantile_complement(u), |r| u - self.complementary_cdf(r))
    }

    /// Root between the radii of both rows of a function that rises with the density.
    fn solve(&self, quantile: impl Fn(&RadialTable) -> f64, excess: impl Fn(f64) -> f64) -> f64 {
        let ends = [0, 1].map(|i| quantile(self.rows[i]) / self.scales[i]);
        let (mut low, mut high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
        let mut r = self.shares[0] * ends[0] + self.shares[1] * ends[1];
        for _ in 0..60 {
            let value = excess(r);
            if value > 0.0 {
                high = r;
            } else {
                low = r;
            }
            let newton = r - value / self.pdf(r);
            let next = if newton >= low && newton <= high { newton } else { 0.5 * (low + high) };
            if (next - r).abs() <= 4e-16 * r {
                return next;
            }
            r = next;
        }
        r
    }
}

impl Profile for ProfileView<'_> {
    methods_of!(|own| (*own); all);

    fn scale(&self) -> f64 {
        1.0 / self.scales[0]
    }
}
