//! Radii drawn from a profile against its density.

use translucid_profile::{Configuration, ParameterError, TabulatedProfile};

use super::{Contender, Reference, Settings, chi_square_probability};
use crate::random;

/// A histogram of radii that a contender's `sample` has drawn, and what its density promises.
#[derive(Clone, Debug, PartialEq)]
pub struct SampleTest {
    /// [`Contender::name`].
    pub contender: &'static str,
    /// Surface albedo A.
    pub surface_albedo: f64,
    /// Whether the model's own sampler draws the radii; otherwise its table does.
    pub own_sampler: bool,
    /// Edges of the bins in mean free paths: 0, equal steps to the radius within which 99 % leave.
    pub edges: Vec<f64>,
    /// Radii in each bin, and beyond the last.
    pub counts: Vec<u64>,
    /// Expected of the model's own energies within the edges.
    pub expected: Vec<f64>,
    /// Radii, and the density per length there, 2πr R(r)/A \[ℓ⁻¹\].
    pub density: Vec<[f64; 2]>,
    /// Σ (count − expected)²/expected.
    pub chi_square: f64,
    /// Bins, and the rest beyond, less one.
    pub freedom: usize,
    /// Probability that chance alone is as far off.
    pub probability: f64,
}

impl SampleTest {
    /// Bins up to the last edge.
    pub const BINS: usize = 60;

    /// Draws radii of one model, with the seed and as many as the settings say.
    ///
    /// Number i of a seed is the same whatever their count, and for every model.
    ///
    /// # Errors
    /// The contender does not reach the surface albedo of the reference.
    pub(super) fn new(
        contender: &Contender,
        reference: &Reference,
        settings: &Settings,
    ) -> Result<Self, ParameterError> {
        let profile = contender.profile(reference)?;
        let sampled = contender.profile_to_sample(reference)?;
        let end = TabulatedProfile::new(&*profile).quantile(0.99);
        let step = end / Self::BINS as f64;
        let edges: Vec<f64> = (0..=Self::BINS).map(|i| step * i as f64).collect();

        // Count radii
        let mut counts = vec![0u64; Self::BINS + 1];
        for i in 0..settings.samples {
            let r = sampled.sample(random(settings.seed, i));
            // Where rounding puts a radius beside an edge, the edge decides
            let near = ((r / step) as usize).min(Self::BINS);
            let bin = if near > 0 && r < edges[near] { near - 1 } else { near };
            counts[bin] += 1;
        }

        // Compare with what was promised
        let share = |i: usize| match edges.get(i + 1) {
            Some(outer) => profile.cdf(*outer) - profile.cdf(edges[i]),
            None => profile.complementary_cdf(end),
        };
        let expected: Vec<f64> = (0..=Self::BINS).map(|i| settings.samples as f64 * share(i)).collect();
        let chi_square = counts.iter().zip(&expected).map(|(n, e)| (*n as f64 - e).powi(2) / e).sum();
        let fine = |i: usize| 0.25 * step * i as f64;
        Ok(Self {
            density: (0..=4 * Self::BINS).map(|i| [fine(i), profile.pdf(fine(i))]).collect(),
            contender: contender.name,
            surface_albedo: reference.surface_albedo,
            own_sampler: profile.samples_directly(),
            edges,
            counts,
            expected,
            chi_square,
            freedom: Self::BINS,
            probability: chi_square_probability(chi_square, Self::BINS),
        })
    }

    /// Radii that were drawn.
    pub fn count(&self) -> u64 {
        self.counts.iter().sum()
    }
}

/// The configuration of the histograms: the one that all models know.
pub(super) const CONFIGURATION: Configuration = Configuration::Searchlight;
