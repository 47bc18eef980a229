//! The models of the command line contract, and the options that describe a profile.

use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};
use translucid_profile::{Configuration, NormalizedDiffusion, Parameterization};

use crate::failure::Failure;
use crate::messages;
use crate::table::exact;

/// Every model that the command's contract names; those that are not available yet are not listed by
/// `--help`, but known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Model {
    NormalizedDiffusion,
    None,
    NotYet(&'static str),
}

/// Names that the contract reserves.
const NOT_YET: [&str; 9] = [
    "normalized-diffusion-refined",
    "dipole",
    "better-dipole",
    "directional-dipole",
    "quantized-diffusion",
    "photon-beam-diffusion",
    "gaussians",
    "exact",
    "random-walk",
];

const MODELS: [Model; 2 + NOT_YET.len()] = {
    let mut models = [Model::NormalizedDiffusion; 2 + NOT_YET.len()];
    models[1] = Model::None;
    let mut i = 0;
    while i < NOT_YET.len() {
        models[2 + i] = Model::NotYet(NOT_YET[i]);
        i += 1;
    }
    models
};

impl ValueEnum for Model {
    fn value_variants<'a>() -> &'a [Self] {
        &MODELS
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(match self {
            Self::NormalizedDiffusion => {
                PossibleValue::new("normalized-diffusion").help("Burley's normalized diffusion")
            }
            Self::None => PossibleValue::new("none").help("No transport under the surface"),
            Self::NotYet(name) => PossibleValue::new(*name).hide(true),
        })
    }
}

impl Model {
    /// The error of a model that is only planned.
    pub(crate) fn not_available(name: &str) -> Failure {
        Failure::input(format!("the model {name} is not available yet"))
            .with_help("the model normalized-diffusion is")
    }
}

/// How light enters the medium.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ConfigurationName {
    /// A pencil beam enters perpendicularly
    Searchlight,
    /// Light enters with a cosine distribution
    Diffuse,
}

/// The options that describe a profile.
#[derive(Args, Debug)]
pub(crate) struct ModelArguments {
    /// Model of the profile
    #[arg(long, value_name = "MODEL", default_value = "normalized-diffusion")]
    model: Model,
    /// Surface albedo A, in [0, 1]
    #[arg(long, value_name = "A", allow_negative_numbers = true)]
    surface_albedo: f64,
    /// Mean free path in the volume [any unit; radii are in the same]
    #[arg(long, value_name = "L", allow_negative_numbers = true, required_unless_present = "dmfp")]
    mfp: Option<f64>,
    /// Diffuse mean free path on the surface, in place of --mfp
    #[arg(long, value_name = "L", allow_negative_numbers = true, conflicts_with = "mfp")]
    dmfp: Option<f64>,
    /// How light enters the medium [default: diffuse with --mfp, searchlight with --dmfp]
    #[arg(long)]
    configuration: Option<ConfigurationName>,
    /// Relative index of refraction; normalized-diffusion is fitted for 1
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true)]
    eta: f64,
    /// Mean cosine of the phase function; normalized-diffusion is fitted for 0
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    g: f64,
}

impl ModelArguments {
    /// The profile that the options describe.
    pub(crate) fn profile(&self) -> Result<NormalizedDiffusion, Failure> {
        match self.model {
            Model::NormalizedDiffusion => {}
            Model::None => return Err(Failure::input("the model none has no profile")),
            Model::NotYet(name) => return Err(Model::not_available(name)),
        }
        self.require_fitted("--eta", self.eta, 1.0, "an index-matched boundary")?;
        self.require_fitted("--g", self.g, 0.0, "isotropic scattering")?;
        let (option, length, parameterization) = match (self.mfp, self.dmfp) {
            (Some(mfp), _) => ("--mfp", mfp, Parameterization::Mfp),
            (None, Some(dmfp)) => ("--dmfp", dmfp, Parameterization::Dmfp),
            (None, None) => return Err(Failure::input("--mfp or --dmfp is missing")),
        };
        let configuration = self.configuration(parameterization);
        NormalizedDiffusion::new(self.surface_albedo, length, parameterization, configuration).map_err(
            |error| {
                let name = if error.parameter == "surface_albedo" { "--surface-albedo" } else { option };
                let message =
                    format!("{name} is {}, but must be {}", exact(error.value), error.requirement());
                if length == 0.0 && name == option {
                    let help =
                        "length 0 is a Lambertian surface: light leaves where it enters, there is no profile";
                    return Failure::input(message).with_help(help);
                }
                Failure::input(message)
            },
        )
    }

    fn configuration(&self, parameterization: Parameterization) -> Configuration {
        match (self.configuration, parameterization) {
            (Some(ConfigurationName::Diffuse), Parameterization::Dmfp) => {
                messages::print_note(
                    "there is no fit for --dmfp in the diffuse configuration; the searchlight fit stands in for it",
                );
                Configuration::Diffuse
            }
            (Some(ConfigurationName::Diffuse), _) | (None, Parameterization::Mfp) => Configuration::Diffuse,
            (Some(ConfigurationName::Searchlight), _) | (None, _) => Configuration::Searchlight,
        }
    }

    fn require_fitted(&self, option: &str, found: f64, fitted: f64, meaning: &str) -> Result<(), Failure> {
        if found == fitted {
            return Ok(());
        }
        let found = exact(found);
        let message = format!("{option} is {found}, but normalized-diffusion is fitted for {fitted} only");
        Err(Failure::input(message)
            .with_help(format!("the model's coefficients were fitted to {meaning}; leave {option} out")))
    }
}
