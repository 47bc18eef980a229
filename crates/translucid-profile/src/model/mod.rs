//! The models by name, each made from the same parameters.

pub(crate) mod burley;
pub(crate) mod dipole;
pub(crate) mod directional_dipole;
pub(crate) mod exact;
mod exponential_mixture;
pub(crate) mod oblique;
pub(crate) mod photon_beam_diffusion;
pub(crate) mod quantized_diffusion;
pub(crate) mod refined;
pub(crate) mod similar_refined;
pub(crate) mod sum_of_gaussians;

use crate::error::{ParameterError, require};
use crate::medium::similarity::is_plain;
use crate::rows::values;
use crate::{
    Appearance, BetterDipole, Configuration, DirectionalDipoleAverage, ExactProfile, Medium,
    NormalizedDiffusion, PhotonBeamDiffusion, Profile, QuantizedDiffusion, RefinedDiffusion,
    SimilarRefinedDiffusion, Similarity, StandardDipole, SumOfGaussians,
};

/// A model of the light that leaves a surface around the point where it entered.
///
/// All take the same parameters, so that one can be swapped for another.
///
/// ```
/// use translucid_profile::{Appearance, Configuration, Model, Parameterization};
///
/// # fn main() -> Result<(), translucid_profile::ParameterError> {
/// let jade = Appearance { surface_albedo: 0.6, length: 1.5, parameterization: Parameterization::Mfp, g: 0.0 };
/// for model in Model::ALL {
///     let profile = model.profile(&jade, Configuration::Searchlight, 1.0)?;
///     assert!((profile.surface_albedo() - 0.6).abs() < 1e-9, "{model}");
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Model {
    /// [`NormalizedDiffusion`] \[Burley 2015; Christensen & Burley 2015\].
    NormalizedDiffusion,
    /// [`RefinedDiffusion`]: four exponentials, fitted to the exact half space; with a phase function or a boundary
    /// [`SimilarRefinedDiffusion`]. The default: it has a twentieth of [`NormalizedDiffusion`]'s error at nearly the
    /// same cost.
    #[default]
    NormalizedDiffusionRefined,
    /// [`ObliqueDiffusion`](crate::ObliqueDiffusion): the same for light at any angle; its profile is the
    /// [`RefinedDiffusion`] that it has for light along the normal, or from everywhere.
    NormalizedDiffusionOblique,
    /// [`StandardDipole`] \[Jensen et al. 2001\].
    Dipole,
    /// [`BetterDipole`] \[d'Eon 2012\].
    BetterDipole,
    /// [`DirectionalDipole`](crate::DirectionalDipole) \[Frisvad et al. 2014\]; its profile is the
    /// [`DirectionalDipoleAverage`] of light along the normal.
    DirectionalDipole,
    /// [`QuantizedDiffusion`] \[d'Eon & Irving 2011\].
    QuantizedDiffusion,
    /// [`PhotonBeamDiffusion`] with single scattering \[Habel et al. 2013\].
    PhotonBeamDiffusion,
    /// [`SumOfGaussians`] of six terms \[d'Eon & Luebke 2007\], fitted to the exact half space.
    Gaussians,
    /// [`ExactProfile`], the tabulated solution for isotropic scattering without a boundary \[Rybicki 1971\].
    Exact,
}

impl Model {
    /// Every model with its name and a few words, in the order of the variants.
    #[rustfmt::skip]
    const ROWS: [(Self, [&'static str; 2]); 10] = [
        (Self::NormalizedDiffusion, ["normalized-diffusion", "Burley's normalized diffusion [Christensen & Burley 2015]"]),
        (Self::NormalizedDiffusionRefined, ["normalized-diffusion-refined", "Four exponentials, fitted to the exact solution"]),
        (Self::NormalizedDiffusionOblique, ["normalized-diffusion-oblique", "Four exponentials, of light at any angle, fitted likewise"]),
        (Self::Dipole, ["dipole", "The standard dipole of diffusion theory [Jensen et al. 2001]"]),
        (Self::BetterDipole, ["better-dipole", "The better dipole, with Grosjean's diffusion [d'Eon 2012]"]),
        (Self::DirectionalDipole, ["directional-dipole", "The directional dipole, of light at any angle [Frisvad et al. 2014]"]),
        (Self::QuantizedDiffusion, ["quantized-diffusion", "Quantized diffusion: an extended source [d'Eon & Irving 2011]"]),
        (Self::PhotonBeamDiffusion, ["photon-beam-diffusion", "Photon beam diffusion with single scattering [Habel et al. 2013]"]),
        (Self::Gaussians, ["gaussians", "A sum of Gaussians, fitted to the exact solution [d'Eon & Luebke 2007]"]),
        (Self::Exact, ["exact", "The exact solution of isotropic scattering, as a table [Rybicki 1971]"]),
    ];

    /// Every model.
    pub const ALL: [Self; 10] = values(&Self::ROWS);

    /// The name that commands and scene files use.
    pub const fn name(self) -> &'static str {
        Self::ROWS[self as usize].1[0]
    }

    /// The model of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|model| model.name() == name)
    }

    /// The model in a few words, with its source.
    pub const fn description(self) -> &'static str {
        Self::ROWS[self as usize].1[1]
    }

    /// Returns whether the model knows boundaries (η) and phase functions (g); the others are made for an
    /// index-matched boundary and isotropic scattering.
    pub const fn knows_boundary(self) -> bool {
        match self {
            Self::NormalizedDiffusionOblique | Self::Gaussians | Self::Exact => false,
            Self::NormalizedDiffusion
            | Self::NormalizedDiffusionRefined
            | Self::Dipole
            | Self::BetterDipole
            | Self::DirectionalDipole
            | Self::QuantizedDiffusion
            | Self::PhotonBeamDiffusion => true,
        }
    }

    /// Returns whether the model distinguishes a perpendicular pencil beam from diffuse light; the others are derived for the
    /// pencil, and stand in for both.
    pub const fn knows_configuration(self) -> bool {
        match self {
            Self::NormalizedDiffusion
            | Self::NormalizedDiffusionRefined
            | Self::NormalizedDiffusionOblique
            | Self::Gaussians
            | Self::Exact => true,
            Self::Dipole
            | Self::BetterDipole
            | Self::DirectionalDipole
            | Self::QuantizedDiffusion
            | Self::PhotonBeamDiffusion => false,
        }
    }

    /// The g and η that the model knows and that are nearest to these.
    ///
    /// Both forms of normalized diffusion are fitted for a range ([`Similarity::G`], [`Similarity::ETA`]); models without
    /// a boundary know g = 0 and η = 1 only; those that are derived know whatever has a meaning.
    pub fn nearest_known(self, g: f64, eta: f64) -> [f64; 2] {
        let within = |x: f64, range: std::ops::RangeInclusive<f64>| x.max(*range.start()).min(*range.end());
        match self {
            Self::NormalizedDiffusion | Self::NormalizedDiffusionRefined => {
                [within(g, Similarity::G), within(eta, Similarity::ETA)]
            }
            _ if self.knows_boundary() => [g, eta],
            _ => [0.0, 1.0],
        }
    }

    /// The profile of a surface albedo and a length.
    ///
    /// # Errors
    /// A parameter is outside its range, the model cannot reach the surface albedo, or η or g is not what the model is
    /// made for: [`nearest_known`](Self::nearest_known) tells what is.
    pub fn profile(
        self,
        appearance: &Appearance,
        configuration: Configuration,
        eta: f64,
    ) -> Result<Box<dyn Profile>, ParameterError> {
        self.require_known(eta, appearance.g)?;
        let Appearance { surface_albedo, length, parameterization, .. } = *appearance;
        Ok(match self {
            Self::NormalizedDiffusion => {
                Box::new(NormalizedDiffusion::from_appearance(appearance, eta, configuration)?)
            }
            Self::NormalizedDiffusionRefined if is_plain(appearance.g, eta) => {
                Box::new(RefinedDiffusion::new(surface_albedo, length, parameterization, configuration)?)
            }
            Self::NormalizedDiffusionOblique => {
                Box::new(RefinedDiffusion::new(surface_albedo, length, parameterization, configuration)?)
            }
            Self::NormalizedDiffusionRefined => {
                Box::new(SimilarRefinedDiffusion::new(appearance, eta, configuration)?)
            }
            Self::Dipole => Box::new(StandardDipole::new(appearance, eta)?),
            Self::BetterDipole => Box::new(BetterDipole::new(appearance, eta)?),
            Self::DirectionalDipole => Box::new(DirectionalDipoleAverage::new(appearance, eta)?),
            Self::QuantizedDiffusion => Box::new(QuantizedDiffusion::new(appearance, eta)?),
            Self::PhotonBeamDiffusion => Box::new(PhotonBeamDiffusion::new(appearance, eta)?),
            Self::Gaussians => {
                let terms = SumOfGaussians::DEFAULT_TERMS;
                Box::new(SumOfGaussians::new(surface_albedo, length, parameterization, configuration, terms)?)
            }
            Self::Exact => {
                Box::new(ExactProfile::new(surface_albedo, length, parameterization, configuration)?)
            }
        })
    }

    /// The profile of a medium.
    ///
    /// Models that are parameterized by a surface albedo get that of the half space: both forms of normalized diffusion
    /// by [`Similarity`], the others the exact one of the index-matched half space, for g ≠ 0 of the similar isotropic
    /// medium ([`Medium::surface_albedo`]).
    ///
    /// # Errors
    /// As [`profile`](Self::profile).
    pub fn profile_of_medium(
        self,
        medium: &Medium,
        configuration: Configuration,
        eta: f64,
    ) -> Result<Box<dyn Profile>, ParameterError> {
        let similar = Appearance {
            surface_albedo: medium.surface_albedo(configuration),
            length: medium.transport_mfp(),
            parameterization: crate::Parameterization::Mfp,
            g: 0.0,
        };
        Ok(match self {
            Self::NormalizedDiffusionOblique | Self::Gaussians | Self::Exact => {
                return self.profile(&similar, configuration, eta);
            }
            Self::NormalizedDiffusion | Self::NormalizedDiffusionRefined if is_plain(medium.g(), eta) => {
                return self.profile(&similar, configuration, eta);
            }
            Self::NormalizedDiffusion => {
                Box::new(NormalizedDiffusion::from_medium(medium, eta, configuration)?)
            }
            Self::NormalizedDiffusionRefined => {
                Box::new(SimilarRefinedDiffusion::from_medium(medium, eta, configuration)?)
            }
            Self::Dipole => Box::new(StandardDipole::from_medium(medium, eta)?),
            Self::BetterDipole => Box::new(BetterDipole::from_medium(medium, eta)?),
            Self::DirectionalDipole => Box::new(DirectionalDipoleAverage::from_medium(medium, eta)?),
            Self::QuantizedDiffusion => Box::new(QuantizedDiffusion::from_medium(medium, eta)?),
            Self::PhotonBeamDiffusion => Box::new(PhotonBeamDiffusion::from_medium(medium, eta)?),
        })
    }

    /// Refuses a boundary or a phase function that the model knows nothing of.
    fn require_known(self, eta: f64, g: f64) -> Result<(), ParameterError> {
        if !self.knows_boundary() {
            require(eta == 1.0, "eta", eta, "1, the index-matched boundary that this model is made for")?;
            require(g == 0.0, "g", g, "0, the isotropic scattering that this model is made for")?;
        }
        Ok(())
    }
}

impl std::fmt::Display for Model {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}
