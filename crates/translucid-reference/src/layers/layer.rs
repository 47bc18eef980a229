//! One plane layer.

use translucid_profile::{AlbedoInversion, ParameterError, Parameterization, require};

use crate::phase_function::PhaseFunction;

/// A plane layer, to be filled in; [`Layers::new`](super::Layers::new) checks it.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Scattering coefficient σ_s \[L⁻¹\], at least 0.
    pub scattering: f64,
    /// Absorption coefficient σ_a \[L⁻¹\], at least 0; a layer that neither scatters nor absorbs is clear.
    pub absorption: f64,
    /// Phase function.
    pub phase_function: PhaseFunction,
    /// Index of refraction η, absolute as that of the medium above, in [0.1, 10].
    pub eta: f64,
    /// Thickness \[L\], greater than 0; infinite is allowed in the last layer.
    pub thickness: f64,
}

impl Layer {
    /// A layer of isotropic scatterers with η = 1.
    pub fn new(scattering: f64, absorption: f64, thickness: f64) -> Self {
        Self { scattering, absorption, phase_function: PhaseFunction::ISOTROPIC, eta: 1.0, thickness }
    }

    /// A layer of the medium whose half space has the surface albedo A ∈ (0, 1\] and the mean free path or diffuse mean
    /// free path `length` \[L\].
    ///
    /// The inversion states how light enters that half space, its η and g; the layer has its g, and η = 1 until
    /// [`with_eta`](Self::with_eta).
    ///
    /// # Errors
    /// A parameter is outside its range.
    pub fn from_surface_albedo(
        inversion: &AlbedoInversion,
        surface_albedo: f64,
        length: f64,
        parameterization: Parameterization,
        thickness: f64,
    ) -> Result<Self, ParameterError> {
        let is_albedo = surface_albedo > 0.0 && surface_albedo <= 1.0;
        require(is_albedo, "surface_albedo", surface_albedo, "in (0, 1]")?;
        let name = match parameterization {
            Parameterization::Mfp => "mfp",
            Parameterization::Dmfp => "dmfp",
        };
        require(length > 0.0 && length.is_finite(), name, length, "finite and greater than 0")?;
        let alpha = inversion.single_scattering_albedo(surface_albedo);
        let extinction = 1.0 / inversion.mfp(surface_albedo, length, parameterization);
        let layer = Self::new(alpha * extinction, (1.0 - alpha) * extinction, thickness);
        Ok(layer.with_g(inversion.g()))
    }

    /// Layer with Henyey and Greenstein's phase function of the mean cosine g ∈ (−1, 1), in all else this one.
    #[must_use]
    pub fn with_g(self, g: f64) -> Self {
        self.with_phase_function(PhaseFunction::HenyeyGreenstein { g })
    }

    /// Layer with the phase function of the Legendre moments χ₁, χ₂, …, in all else this one.
    #[must_use]
    pub fn with_moments(self, moments: Vec<f64>) -> Self {
        self.with_phase_function(PhaseFunction::Moments(moments.into()))
    }

    /// Layer with this phase function, in all else this one.
    #[must_use]
    pub fn with_phase_function(self, phase_function: PhaseFunction) -> Self {
        Self { phase_function, ..self }
    }

    /// Layer with this index of refraction, in all else this one.
    #[must_use]
    pub fn with_eta(self, eta: f64) -> Self {
        Self { eta, ..self }
    }

    /// Extinction coefficient σ_t = σ_s + σ_a \[L⁻¹\].
    pub fn extinction(&self) -> f64 {
        self.scattering + self.absorption
    }

    /// Checks all but the place among other layers.
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        let is_coefficient = |value: f64| (0.0..=1e30).contains(&value);
        require(is_coefficient(self.scattering), "scattering", self.scattering, "in [0, 1e30]")?;
        require(is_coefficient(self.absorption), "absorption", self.absorption, "in [0, 1e30]")?;
        require(ETA.contains(&self.eta), "eta", self.eta, "in [0.1, 10]")?;
        require(self.thickness > 0.0, "thickness", self.thickness, "greater than 0")?;
        self.phase_function.check()
    }
}

/// Indices of refraction that are allowed.
pub(super) const ETA: std::ops::RangeInclusive<f64> = 0.1..=10.0;
