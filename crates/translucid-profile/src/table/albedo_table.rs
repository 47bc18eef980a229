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

use std::f64::consts::PI;

use crate::error::{ParameterError, require};
use crate::math::monotone_cubic::MonotoneCubic;
use crate::profile::{Profile, finite_quotient};
use crate::table::radial_table::RadialTable;
use crate::table::tabulated_profile::{TabulatedProfile, UNIT_RADIUS_MIN};

/// Rows that [`AlbedoTable::for_every_albedo`] makes.
const ROWS: usize = 80;
/// Least albedo of its rows.
const LEAST_ALBEDO: f64 = 1e-3;

/// A model's profiles for every surface albedo, in constant time.
///
/// Below the first row and above the last one the shape is that of the row.
///
/// ```
/// use translucid_profile::{AlbedoTable, Configuration, NormalizedDiffusion, Parameterization, Profile};
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
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct AlbedoTable {
    rows: Vec<Row>,
    /// Median radius as a function of the albedo.
    median: MonotoneCubic,
}

#[derive(Clone, Debug)]
pub(crate) struct Row {
    pub(crate) profile: TabulatedProfile,
    /// Median radius in the unit of the row's table.
    pub(crate) unit_median: f64,
}

/// Which rows a profile is a mixture of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    pub(crate) lower: usize,
    pub(crate) upper: usize,
    /// Share of the upper row.
    pub(crate) mix: f64,
    /// Median radius for length 1.
    pub(crate) median: f64,
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
        Ok(Self::from_rows(surface_albedos, profiles))
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
        let y = |albedo: f64| (1.0 - (1.0 - albedo).cbrt()).cbrt();
        let (first, last) = (y(LEAST_ALBEDO), y(most));
        let albedo = |i: usize| {
            let y = first + (last - first) * i as f64 / (ROWS - 1) as f64;
            if i + 1 == ROWS { most } else { 1.0 - (1.0 - y * y * y).powi(3) }
        };
        let albedos: Vec<f64> = (0..ROWS).map(albedo).collect();
        Self::new(&albedos, profile_of)
    }

    /// Rows from tables of length 1 in the order of their albedos.
    pub(crate) fn from_rows(surface_albedos: &[f64], profiles: Vec<TabulatedProfile>) -> Self {
        let medians: Vec<f64> = profiles.iter().map(|profile| profile.quantile(0.5)).collect();
        let row = |profile: TabulatedProfile| Row { unit_median: profile.table().quantile(0.5), profile };
        Self {
            rows: profiles.into_iter().map(row).collect(),
            median: MonotoneCubic::new(surface_albedos, &medians),
        }
    }

    /// Surface albedos of the rows.
    pub fn surface_albedos(&self) -> &[f64] {
        self.median.abscissae()
    }

    /// The worst of the rows' [`TabulatedProfile::cdf_error`].
    pub fn cdf_error_of_rows(&self) -> f64 {
        self.rows.iter().map(|row| row.profile.cdf_error()).fold(0.0, f64::max)
    }

    /// The profile of a surface albedo A ∈ \[0, 1\] and a length \[L\].
    ///
    /// The albedo is clamped to \[0, 1\] and the length to \[1e-150, 1e150\]; NaN counts as the least.
    pub fn at(&self, surface_albedo: f64, length: f64) -> ProfileView<'_> {
        let surface_albedo = surface_albedo.max(0.0).min(1.0);
        let place = self.place(surface_albedo);
        let length = place.median * length.max(1e-150).min(1e150);
        let scaled = |row: &'_ Row| length / row.unit_median;
        let (lower, upper) = (&self.rows[place.lower], &self.rows[place.upper]);
        ProfileView {
            rows: [lower.profile.table(), upper.profile.table()],
            lengths: [scaled(lower), scaled(upper)],
            shares: [1.0 - place.mix, place.mix],
            surface_albedo,
        }
    }

    pub(crate) fn rows(&self) -> &[Row] {
        &self.rows
    }

    pub(crate) fn median(&self) -> &MonotoneCubic {
        &self.median
    }

    /// Where a surface albedo is.
    pub(crate) fn place(&self, surface_albedo: f64) -> Place {
        let albedos = self.surface_albedos();
        let last = albedos.len() - 1;
        let lower = self.median.interval(surface_albedo);
        let upper = (lower + 1).min(last);
        let width = albedos[upper] - albedos[lower];
        let mix =
            if width > 0.0 { ((surface_albedo - albedos[lower]) / width).max(0.0).min(1.0) } else { 0.0 };
        Place { lower, upper, mix, median: self.median.eval(surface_albedo) }
    }
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
/// Densities, cdf and sampling belong to one distribution, exactly.
/// A radius that is negative or NaN counts as 0, and no argument makes a method panic or return a NaN or an
/// infinity.
#[derive(Clone, Copy, Debug)]
pub struct ProfileView<'a> {
    rows: [&'a RadialTable; 2],
    /// The rows' units of length \[L\].
    lengths: [f64; 2],
    /// The rows' shares in the mixture.
    shares: [f64; 2],
    surface_albedo: f64,
}

impl ProfileView<'_> {
    /// Surface albedo A = ∫ R 2πr dr.
    pub fn surface_albedo(&self) -> f64 {
        self.surface_albedo
    }

    /// Reflectance profile R(r) \[L⁻²\].
    ///
    /// r below the least normal number 2.2e-308 counts as that number, and R above the greatest number as that
    /// one.
    pub fn eval(&self, r: f64) -> f64 {
        let r = self.resolved(r);
        finite_quotient(self.eval_times_r(r), r)
    }

    /// Profile times radius, r R(r) \[L⁻¹\].
    pub fn eval_times_r(&self, r: f64) -> f64 {
        self.surface_albedo * (self.pdf(r) / (2.0 * PI))
    }

    /// Density per length p(r) = 2πr R(r)/A \[L⁻¹\]: the slope of [`cdf`](Self::cdf).
    pub fn pdf(&self, r: f64) -> f64 {
        let [a, b] = self.of_rows(|row, length| row.density(r / length) / length);
        (a + b).min(f64::MAX)
    }

    /// Density per area p_a(r) = R(r)/A \[L⁻²\], at r = 0 as [`eval`](Self::eval).
    pub fn pdf_area(&self, r: f64) -> f64 {
        let r = self.resolved(r);
        finite_quotient(self.pdf(r) / (2.0 * PI), r)
    }

    /// Share of the energy that leaves within r, with the digits of a small r.
    pub fn cdf(&self, r: f64) -> f64 {
        let [a, b] = self.of_rows(|row, length| row.within(r / length));
        a + b
    }

    /// Share of the energy that leaves beyond r, with the digits of a large r.
    pub fn complementary_cdf(&self, r: f64) -> f64 {
        let [a, b] = self.of_rows(|row, length| row.beyond(r / length));
        a + b
    }

    /// Energy that leaves within r: A cdf(r).
    pub fn enclosed(&self, r: f64) -> f64 {
        self.surface_albedo * self.cdf(r)
    }

    /// Radius within which the share u ∈ \[0, 1\] of the energy leaves \[L\], which rises with u: a few steps of
    /// Newton between the rows' quantiles.
    ///
    /// u is clamped to \[0, 1\]; NaN counts as 0. u = 1 gives the radius of the complement 2.2e-308.
    pub fn quantile(&self, u: f64) -> f64 {
        let u = u.max(0.0).min(1.0);
        if u < 0.5 {
            self.solve(self.quantiles(|row| row.quantile(u)), |r| self.cdf(r) - u)
        } else {
            self.quantile_complement(1.0 - u)
        }
    }

    /// Radius beyond which the share u ∈ \[0, 1\] of the energy leaves \[L\], with every digit of the tail.
    ///
    /// u is clamped to \[2.2e-308, 1\]; NaN counts as 1.
    pub fn quantile_complement(&self, u: f64) -> f64 {
        let u = u.min(1.0).max(f64::MIN_POSITIVE);
        if u > 0.5 {
            return self.quantile(1.0 - u);
        }
        self.solve(self.quantiles(|row| row.quantile_complement(u)), |r| u - self.complementary_cdf(r))
    }

    /// Radius of density p(r) for a random number u uniform on [0, 1) \[L\]: chooses a row by u and takes its
    /// quantile.
    ///
    /// Cheaper than [`quantile`](Self::quantile), but not monotone in u: two strata overlap in r.
    /// u is clamped to \[0, 1\]; NaN counts as 0.
    pub fn sample(&self, u: f64) -> f64 {
        let u = u.max(0.0).min(1.0);
        let [lower, upper] = self.shares;
        if u < lower || upper <= 0.0 {
            self.row_quantile(0, u / lower)
        } else {
            self.row_quantile(1, (u - lower) / upper)
        }
    }

    /// A radius beyond which the share `tail` of the energy or less leaves \[L\]: hardly farther out than need be.
    ///
    /// The tail is clamped to \[2.2e-308, 1\]; NaN counts as 1.
    pub fn truncation_radius(&self, tail: f64) -> f64 {
        let [a, b] = self.quantiles(|row| row.quantile_complement(tail));
        if self.shares[1] > 0.0 { a.max(b) } else { a }
    }

    /// Radius of density p(r)/cdf(`r_max`) on \[0, `r_max`\] for a random number u uniform on [0, 1) \[L\].
    ///
    /// Like [`sample`](Self::sample) not monotone in u. u is clamped to \[0, 1\]; NaN counts as 0.
    pub fn sample_within(&self, u: f64, r_max: f64) -> f64 {
        let [lower, upper] = self.of_rows(|row, length| row.within(r_max / length));
        let energy = u.max(0.0).min(1.0) * (lower + upper);
        let r = if energy < lower || upper <= 0.0 {
            self.row_quantile(0, energy / self.shares[0])
        } else {
            self.row_quantile(1, (energy - lower) / self.shares[1])
        };
        r.min(r_max.max(0.0))
    }

    /// A function of both rows, times their shares.
    #[inline(always)]
    fn of_rows(&self, f: impl Fn(&RadialTable, f64) -> f64) -> [f64; 2] {
        [0, 1].map(|i| self.shares[i] * f(self.rows[i], self.lengths[i]))
    }

    fn row_quantile(&self, i: usize, u: f64) -> f64 {
        (self.rows[i].quantile(u) * self.lengths[i]).min(f64::MAX)
    }

    /// Quantiles of both rows \[L\].
    fn quantiles(&self, f: impl Fn(&RadialTable) -> f64) -> [f64; 2] {
        [0, 1].map(|i| (f(self.rows[i]) * self.lengths[i]).min(f64::MAX))
    }

    /// Root between two radii of a function that rises with the density.
    fn solve(&self, ends: [f64; 2], excess: impl Fn(f64) -> f64) -> f64 {
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

    /// The radius at which R and its density per area can be told.
    fn resolved(&self, r: f64) -> f64 {
        let is_finite = self.rows.iter().all(|row| row.is_finite_at_0());
        let least = if is_finite { UNIT_RADIUS_MIN * self.lengths[0] } else { 0.0 };
        r.max(f64::MIN_POSITIVE).max(least)
    }
}

impl Profile for ProfileView<'_> {
    fn eval_times_r(&self, r: f64) -> f64 {
        self.eval_times_r(r)
    }

    fn eval(&self, r: f64) -> f64 {
        self.eval(r)
    }

    fn enclosed(&self, r: f64) -> f64 {
        self.enclosed(r)
    }

    fn beyond(&self, r: f64) -> f64 {
        self.surface_albedo * self.complementary_cdf(r)
    }

    fn total(&self) -> f64 {
        self.surface_albedo
    }

    fn scale(&self) -> f64 {
        self.lengths[0]
    }

    fn evaluations_to_build(&self) -> u32 {
        0
    }
}
