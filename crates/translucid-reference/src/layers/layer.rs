//! One plane layer.

use translucid_profile::{AlbedoInversion, ParameterError, Parameterization, require};

use crate::walk::PhaseFunction;

/// Distribution of the angle by which a collision deflects light in a layer.
#[derive(Clone, Debug, PartialEq)]
pub enum Deflection {
    /// A phase function by its name.
    Named(PhaseFunction),
    /// Legendre moments χ₁, χ₂, … of any phase function, χ₀ = 1 being left out and those behind the last being 0:
    /// p = (1/4π) Σ (2l + 1) χ_l P_l(cos θ). The first is the mean cosine g.
    Moments(Vec<f64>),
}

impl Deflection {
    /// Every direction alike.
    pub const ISOTROPIC: Self = Self::Named(PhaseFunction::ISOTROPIC);

    /// Legendre moment χ_l ∈ [−1, 1], χ₀ = 1.
    pub fn moment(&self, l: usize) -> f64 {
        match self {
            _ if l == 0 => 1.0,
            Self::Named(PhaseFunction::HenyeyGreenstein { g }) => libm::pow(*g, l as f64),
            Self::Named(PhaseFunction::Rayleigh) => [0.0, 0.0, 0.1].get(l).copied().unwrap_or(0.0),
            Self::Moments(moments) => moments.get(l - 1).copied().unwrap_or(0.0),
        }
    }

    /// Whether every direction is alike.
    pub fn is_isotropic(&self) -> bool {
        match self {
            Self::Named(phase_function) => *phase_function == PhaseFunction::ISOTROPIC,
            Self::Moments(moments) => moments.iter().all(|moment| *moment == 0.0),
        }
    }
}

/// A plane layer, to be filled in; [`Layers::new`](super::Layers::new) checks it.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Scattering coefficient σ_s \[L⁻¹\], at least 0.
    pub scattering: f64,
    /// Absorption coefficient σ_a \[L⁻¹\], at least 0; a layer that neither scatters nor absorbs is clear.
    pub absorption: f64,
    /// Phase function.
    pub deflection: Deflection,
    /// Index of refraction η, absolute as that of the medium above, in [0.1, 10].
    pub eta: f64,
    /// Thickness \[L\], greater than 0; infinite is allowed in the last layer.
    pub thickness: f64,
}

impl Layer {
    /// A layer of isotropic scatterers with η = 1.
    pub fn new(scattering: f64, absorption: f64, thickness: f64) -> Self {
        Self { scattering, absorption, deflection: Deflection::ISOTROPIC, eta: 1.0, thickness }
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
        let deflection = Deflection::Named(PhaseFunction::HenyeyGreenstein { g });
        Self { deflection, ..self }
    }

    /// Layer with the phase function of the Legendre moments χ₁, χ₂, …, in all else this one.
    #[must_use]
    pub fn with_moments(self, moments: Vec<f64>) -> Self {
        Self { deflection: Deflection::Moments(moments), ..self }
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
        match &self.deflection {
            Deflection::Named(PhaseFunction::HenyeyGreenstein { g }) => {
                require(*g > -1.0 && *g < 1.0, "g", *g, "in (-1, 1)").map(|_| ())
            }
            Deflection::Named(PhaseFunction::Rayleigh) => Ok(()),
            Deflection::Moments(moments) => {
                let fault = moments.iter().find(|moment| !(-1.0 < **moment && **moment < 1.0));
                fault.map_or(Ok(()), |moment| Err(ParameterError::new("moments", *moment, "in (-1, 1)")))?;
                check_density(moments)
            }
        }
    }
}

/// Indices of refraction that are allowed.
pub(super) const ETA: std::ops::RangeInclusive<f64> = 0.1..=10.0;

/// Refuses moments whose sum is below 0 somewhere, by more than rounding of published moments.
fn check_density(moments: &[f64]) -> Result<(), ParameterError> {
    let points = 4 * moments.len() + 8;
    for i in 0..=points {
        let x = libm::cos(std::f64::consts::PI * i as f64 / points as f64);
        let (mut before, mut now, mut sum) = (1.0, x, 1.0);
        for (l, moment) in moments.iter().enumerate() {
            let order = (l + 1) as f64;
            sum += (2.0 * order + 1.0) * moment * now;
            (before, now) = (now, ((2.0 * order + 1.0) * x * now - order * before) / (order + 1.0));
        }
        let allowed = "at least 0: these are no moments of a phase function";
        require(sum >= -1e-3, "4 pi times the phase function at some angle", sum, allowed)?;
    }
    Ok(())
}
