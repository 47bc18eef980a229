//! Any profile as a table: evaluation, densities, cdf, quantile and sampling at one cost, whatever the model's.

use std::f64::consts::PI;
use std::sync::Arc;

use crate::SampledProfile;
use crate::error::{ParameterError, require_fraction, require_positive};
use crate::profile::{Profile, finite_quotient, methods_of};
use crate::table::precision::Number;
use crate::table::radial_table::RadialTable;
use crate::table::radial_table_build::{Built, build};

/// A profile as a table in the radius.
///
/// All methods follow from one cdf, a chain of rational functions that rises (see the crate's source,
/// `monotone_cell.rs`): the density is its exact slope and the quantile its exact inverse.
/// Sampling is therefore exact for what is evaluated, whatever the table's error against its source.
/// For the models of this crate that error is less than 1e-5 of the cdf below the median, and of 1 − cdf above it
/// as far as that is 1e-6 (6e-5 for quantized diffusion with little absorption, close to r = 0);
/// [`cdf_error`](Self::cdf_error) estimates it.
/// The density's error is some ten times that.
///
/// A clone shares the table, and so do [`scaled`](Self::scaled) ones.
/// A radius that is negative or NaN counts as 0, and no argument makes a method panic or return a NaN or an
/// infinity.
///
/// ```
/// use translucid_profile::{NormalizedDiffusion, TabulatedProfile};
///
/// # fn main() -> Result<(), translucid_profile::ParameterError> {
/// let source = NormalizedDiffusion::from_d(0.8, 0.7)?;
/// let table = TabulatedProfile::new(&source);
/// assert!(table.cdf_error() < 2e-6);
/// let r = table.sample(0.3);
/// assert!((source.cdf(r) - 0.3).abs() < 1e-6);
/// assert!((table.eval(r) / table.pdf_area(r) - 0.8).abs() < 1e-15); // the weight of a sample
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct TabulatedProfile {
    table: Arc<RadialTable>,
    surface_albedo: f64,
    /// The table's unit \[L\].
    length: f64,
    inverse_length: f64,
    cdf_error: f64,
}

impl TabulatedProfile {
    /// Tabulates a profile: asks it for some 200 to 700 numbers.
    ///
    /// A black profile gets the shape of normalized diffusion, so that it can be sampled.
    pub fn new(source: &dyn Profile) -> Self {
        let Built { table, length, error } = build(source);
        Self {
            table: Arc::new(table),
            surface_albedo: source.surface_albedo(),
            length,
            inverse_length: 1.0 / length,
            cdf_error: error,
        }
    }

    /// The profile through samples R(rᵢ) at four radii or more, which rise: [`SampledProfile`] as a table.
    ///
    /// # Errors
    /// As [`SampledProfile::new`].
    pub fn from_samples(radii: &[f64], reflectances: &[f64]) -> Result<Self, ParameterError> {
        Ok(Self::new(&SampledProfile::new(radii, reflectances)?))
    }

    /// The profile of which the energies within radii are known, E(rᵢ) = ∫₀^rᵢ R 2πr dr: what a tally of rings
    /// measures.
    ///
    /// These energies are kept. Beyond the last radius energy goes on as the last two rings say.
    ///
    /// ```
    /// use translucid_profile::{NormalizedDiffusion, TabulatedProfile};
    ///
    /// # fn main() -> Result<(), translucid_profile::ParameterError> {
    /// let source = NormalizedDiffusion::from_d(0.8, 1.0)?;
    /// let radii: Vec<f64> = (0..60).map(|i| 0.05 * 1.12_f64.powi(i)).collect();
    /// let enclosed: Vec<f64> = radii.iter().map(|r| source.enclosed(*r)).collect();
    /// let table = TabulatedProfile::from_enclosed(&radii, &enclosed)?;
    /// assert!((table.surface_albedo() - 0.8).abs() < 1e-5);
    /// assert!((table.enclosed(1.234) - source.enclosed(1.234)).abs() < 2e-5);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// As [`SampledProfile::from_enclosed`].
    pub fn from_enclosed(radii: &[f64], enclosed: &[f64]) -> Result<Self, ParameterError> {
        Ok(Self::new(&SampledProfile::from_enclosed(radii, enclosed)?))
    }

    /// The profile of which both samples and energies within radii are known; it keeps both.
    ///
    /// # Errors
    /// As [`SampledProfile::from_samples_and_enclosed`].
    pub fn from_samples_and_enclosed(
        radii: &[f64],
        reflectances: &[f64],
        enclosed: &[f64],
    ) -> Result<Self, ParameterError> {
        Ok(Self::new(&SampledProfile::from_samples_and_enclosed(radii, reflectances, enclosed)?))
    }

    /// A table that is there already; its error against a source is not known here.
    pub(crate) fn from_table(table: RadialTable, length: f64, surface_albedo: f64) -> Self {
        let inverse_length = 1.0 / length;
        Self { table: Arc::new(table), surface_albedo, length, inverse_length, cdf_error: 0.0 }
    }

    /// A profile of this shape with every length multiplied by a factor and another surface albedo; shares the table.
    ///
    /// # Errors
    /// The factor is not finite and greater than 0, or takes lengths out of range; the surface albedo is not in
    /// \[0, 1\].
    pub fn scaled(&self, length_factor: f64, surface_albedo: f64) -> Result<Self, ParameterError> {
        require_positive("length_factor", length_factor)?;
        require_fraction("surface_albedo", surface_albedo)?;
        let length = require_positive("scale", self.length * length_factor)?;
        let inverse_length = require_positive("1/scale", 1.0 / length)?;
        Ok(Self { surface_albedo, length, inverse_length, ..self.clone() })
    }

    /// Surface albedo A = ∫ R 2πr dr, the source's total.
    #[inline]
    pub fn surface_albedo(&self) -> f64 {
        self.surface_albedo
    }

    /// Estimate, good to a factor of 10 for smooth profiles, of the worst relative error against the source: of
    /// the cdf below the median, of 1 − cdf above it as far as that is 1e-6, beyond which it is relative to 1e-6.
    ///
    /// From the density in the middle of every cell, where cells have the source's cdf. Its rounding errors are
    /// left out.
    pub fn cdf_error(&self) -> f64 {
        self.cdf_error
    }

    /// Reflectance profile R(r) \[L⁻²\].
    ///
    /// r below the least normal number 2.2e-308 counts as that number, and R above the greatest number as that
    /// one.
    #[inline]
    pub fn eval(&self, r: f64) -> f64 {
        let r = self.resolved(r);
        finite_quotient(self.eval_times_r(r), r)
    }

    /// Profile times radius, r R(r) \[L⁻¹\].
    #[inline]
    pub fn eval_times_r(&self, r: f64) -> f64 {
        self.surface_albedo * (self.pdf(r) / (2.0 * PI))
    }

    /// Density per length p(r) = 2πr R(r)/A \[L⁻¹\]: the slope of [`cdf`](Self::cdf).
    #[inline]
    pub fn pdf(&self, r: f64) -> f64 {
        (self.table.density(r * self.inverse_length) * self.inverse_length).min(f64::MAX)
    }

    /// Density per area p_a(r) = R(r)/A \[L⁻²\], at r = 0 as [`eval`](Self::eval).
    #[inline]
    pub fn pdf_area(&self, r: f64) -> f64 {
        let r = self.resolved(r);
        finite_quotient(self.pdf(r) / (2.0 * PI), r)
    }

    /// Share of the energy that leaves within r, with the digits of a small r.
    #[inline]
    pub fn cdf(&self, r: f64) -> f64 {
        self.table.within(r * self.inverse_length).min(1.0)
    }

    /// Share of the energy that leaves beyond r, with the digits of a large r.
    #[inline]
    pub fn complementary_cdf(&self, r: f64) -> f64 {
        self.table.beyond(r * self.inverse_length).min(1.0)
    }

    /// Energy that leaves within r: ∫₀^r R(r') 2πr' dr' = A cdf(r).
    #[inline]
    pub fn enclosed(&self, r: f64) -> f64 {
        self.surface_albedo * self.cdf(r)
    }

    /// Radius within which the share u ∈ \[0, 1\] of the energy leaves \[L\]: the inverse of [`cdf`](Self::cdf).
    ///
    /// u is clamped to \[0, 1\]; NaN counts as 0. u = 1 gives the radius of the complement 2.2e-308.
    #[inline]
    pub fn quantile(&self, u: f64) -> f64 {
        (self.table.quantile(u) * self.length).min(f64::MAX)
    }

    /// Radius beyond which the share u ∈ \[0, 1\] of the energy leaves \[L\]: `quantile(1 − u)` with every digit
    /// of the tail.
    ///
    /// u is clamped to \[2.2e-308, 1\]; NaN counts as 1.
    #[inline]
    pub fn quantile_complement(&self, u: f64) -> f64 {
        (self.table.quantile_complement(u) * self.length).min(f64::MAX)
    }

    /// Radius of density p(r) for a random number u uniform on [0, 1) \[L\]: [`quantile`](Self::quantile), which
    /// rises with u.
    #[inline]
    pub fn sample(&self, u: f64) -> f64 {
        self.quantile(u)
    }

    pub(crate) fn table(&self) -> &RadialTable {
        &self.table
    }

    /// The radius at which R and its density per area can be told.
    #[inline(always)]
    fn resolved(&self, r: f64) -> f64 {
        let least = if self.table.is_finite_at_0() { f64::UNIT_RADIUS_MIN * self.length } else { 0.0 };
        r.max(f64::MIN_POSITIVE).max(least)
    }
}

impl Profile for TabulatedProfile {
    methods_of!(|own| own; all);

    fn scale(&self) -> f64 {
        self.length
    }
}
