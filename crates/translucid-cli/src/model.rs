//! Names that options give models, configurations and units, and the options that describe a profile.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};
use translucid_load::load_profile_table;
use translucid_profile::{
    Appearance, Configuration, Medium, Model, ParameterError, Parameterization, Profile, SumOfGaussians,
    TabulatedProfile,
};
use translucid_scene::{SubsurfaceModel, Unit};

use crate::failure::Failure;
use crate::messages;
use crate::table::exact;

/// A model as the command line names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ModelName(SubsurfaceModel);

impl ValueEnum for ModelName {
    fn value_variants<'a>() -> &'a [Self] {
        static MODELS: LazyLock<Vec<ModelName>> =
            LazyLock::new(|| SubsurfaceModel::ALL.into_iter().map(ModelName).collect());
        &MODELS
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(self.0.name()).help(self.0.description()))
    }
}

impl ModelName {
    const NORMALIZED_DIFFUSION: Self = Self(SubsurfaceModel::Profile(Model::NormalizedDiffusion));

    /// The model.
    pub(crate) fn model(self) -> SubsurfaceModel {
        self.0
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

impl From<ConfigurationName> for Configuration {
    fn from(name: ConfigurationName) -> Self {
        match name {
            ConfigurationName::Searchlight => Self::Searchlight,
            ConfigurationName::Diffuse => Self::Diffuse,
        }
    }
}

/// Units of length.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum UnitName {
    /// Millimeters
    Mm,
    /// Centimeters
    Cm,
    /// Meters
    M,
}

impl From<UnitName> for Unit {
    fn from(name: UnitName) -> Self {
        match name {
            UnitName::Mm => Self::Millimeter,
            UnitName::Cm => Self::Centimeter,
            UnitName::M => Self::Meter,
        }
    }
}

/// The options that describe a profile.
#[derive(Args, Debug)]
pub(crate) struct ModelArguments {
    /// Model of the profile; `translucid models` lists them
    #[arg(long, value_name = "MODEL", default_value = Model::default().name(), hide_possible_values = true)]
    model: ModelName,
    /// CSV file of a profile of your own in place of a model: columns r, reflectance and optionally surface_albedo,
    /// radii in units of --mfp
    #[arg(
        long,
        value_name = "FILE",
        conflicts_with_all = ["model", "terms", "sigma_a", "configuration", "eta", "g"]
    )]
    table: Option<PathBuf>,
    /// Number of Gaussians, 1 to 6, for the model gaussians [default: 6]
    #[arg(long, value_name = "K", value_parser = parse_terms)]
    terms: Option<usize>,
    /// Surface albedo A, in [0, 1]
    #[arg(long, value_name = "A", allow_negative_numbers = true, required_unless_present = "sigma_a")]
    surface_albedo: Option<f64>,
    /// Mean free path in the volume [any unit; radii are in the same]
    #[arg(
        long,
        value_name = "L",
        allow_negative_numbers = true,
        required_unless_present_any = ["dmfp", "sigma_a"]
    )]
    mfp: Option<f64>,
    /// Diffuse mean free path on the surface, in place of --mfp
    #[arg(long, value_name = "L", allow_negative_numbers = true, conflicts_with = "mfp")]
    dmfp: Option<f64>,
    /// Absorption coefficient [per unit of length], with --sigma-s in place of --surface-albedo and --mfp
    #[arg(
        long,
        value_name = "S",
        allow_negative_numbers = true,
        requires = "sigma_s",
        conflicts_with_all = ["surface_albedo", "mfp", "dmfp"]
    )]
    sigma_a: Option<f64>,
    /// Scattering coefficient [per unit of length]
    #[arg(long, value_name = "S", allow_negative_numbers = true, requires = "sigma_a")]
    sigma_s: Option<f64>,
    /// How light enters the medium [default: diffuse with --mfp, searchlight with --dmfp]
    #[arg(long)]
    configuration: Option<ConfigurationName>,
    /// Relative index of refraction, for the models that know a boundary
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true)]
    eta: f64,
    /// Mean cosine of the phase function, for the models that know one
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    g: f64,
}

fn parse_terms(text: &str) -> Result<usize, String> {
    let most = SumOfGaussians::MAX_TERMS;
    let terms = text.parse().ok().filter(|terms| (1..=most).contains(terms));
    terms.ok_or_else(|| format!("a number of Gaussians is in [1, {most}]"))
}

fn gaussians(
    appearance: &Appearance,
    configuration: Configuration,
    terms: usize,
) -> Result<Box<dyn Profile>, ParameterError> {
    let Appearance { surface_albedo, length, parameterization, .. } = *appearance;
    Ok(Box::new(SumOfGaussians::new(surface_albedo, length, parameterization, configuration, terms)?))
}

impl ModelArguments {
    /// The file that the profile is read from, if it is.
    pub(crate) fn table_file(&self) -> Option<&Path> {
        self.table.as_deref()
    }

    /// The profile that the options describe in a form that is sampled in constant time: normalized diffusion in closed
    /// form, every other one as a table.
    pub(crate) fn profile_to_sample(&self) -> Result<Box<dyn Profile>, Failure> {
        let profile = self.profile()?;
        if self.table.is_none() && self.model == ModelName::NORMALIZED_DIFFUSION {
            return Ok(profile);
        }
        Ok(Box::new(TabulatedProfile::new(&*profile)))
    }

    /// The profile that the options describe.
    pub(crate) fn profile(&self) -> Result<Box<dyn Profile>, Failure> {
        if let Some(path) = &self.table {
            return self.tabulated(path);
        }
        let model = match self.model.model() {
            SubsurfaceModel::Profile(model) => model,
            SubsurfaceModel::RandomWalk(surface) => {
                let model = surface.name_of_walk();
                let message =
                    format!("the model {model} has no profile: it walks through the volume of a scene");
                let help = "use it with render; the exact profile of the same medium is --model exact";
                return Err(Failure::input(message).with_help(help));
            }
            SubsurfaceModel::Layers => {
                let message = "the model layers has the profile of a scene's material, and here is none";
                return Err(Failure::input(message)
                    .with_help("that of layers in a file is printed by reference --layers FILE --at R"));
            }
            SubsurfaceModel::Default | SubsurfaceModel::Tabulated(_) | SubsurfaceModel::None => {
                return Err(Failure::input(format!(
                    "the model {} has no profile",
                    self.model.model().name()
                )));
            }
        };
        self.require_known(model)?;
        let fail = |error| self.name_option(model, error);
        if let (Some(sigma_a), Some(sigma_s)) = (self.sigma_a, self.sigma_s) {
            let medium = Medium::new(sigma_a, sigma_s, self.g).map_err(fail)?;
            let configuration = self.configuration(model, Parameterization::Mfp);
            if let Some(terms) = self.terms {
                let surface_albedo = medium.surface_albedo(configuration);
                let (length, parameterization) = (medium.transport_mfp(), Parameterization::Mfp);
                let similar = Appearance { surface_albedo, length, parameterization, g: 0.0 };
                return gaussians(&similar, configuration, terms).map_err(fail);
            }
            let profile = model.profile_of_medium(&medium, configuration, self.eta).map_err(fail)?;
            if profile.surface_albedo() > 1.0 + 1e-6 {
                let total = profile.surface_albedo();
                messages::print_note(&format!("{model} sends back {total:.3} times the light that enters"));
            }
            return Ok(profile);
        }
        let appearance = self.appearance()?;
        let configuration = self.configuration(model, appearance.parameterization);
        match self.terms {
            Some(terms) => gaussians(&appearance, configuration, terms),
            None => model.profile(&appearance, configuration, self.eta),
        }
        .map_err(fail)
    }

    /// The profile of a table from a file: its shape at the surface albedo and length asked for.
    fn tabulated(&self, path: &Path) -> Result<Box<dyn Profile>, Failure> {
        let table = load_profile_table(path)?.table()?;
        let appearance = self.appearance()?;
        let Appearance { surface_albedo, length, .. } = appearance;
        // Normalized diffusion takes what a table takes: any albedo in [0, 1], and any length
        let like = Model::NormalizedDiffusion;
        like.profile(&appearance, Configuration::default(), 1.0).map_err(|e| self.name_option(like, e))?;
        Ok(Box::new(table.into_profile(surface_albedo, length)))
    }

    fn appearance(&self) -> Result<Appearance, Failure> {
        let (length, parameterization) = match (self.mfp, self.dmfp) {
            (Some(mfp), _) => (mfp, Parameterization::Mfp),
            (None, Some(dmfp)) => (dmfp, Parameterization::Dmfp),
            (None, None) => return Err(Failure::input("--mfp or --dmfp is missing")),
        };
        let Some(surface_albedo) = self.surface_albedo else {
            return Err(Failure::input("--surface-albedo is missing"));
        };
        Ok(Appearance { surface_albedo, length, parameterization, g: self.g })
    }

    fn configuration(&self, model: Model, parameterization: Parameterization) -> Configuration {
        let Some(name) = self.configuration else { return parameterization.usual_configuration() };
        let configuration = Configuration::from(name);
        if configuration == Configuration::Diffuse && !model.knows_configuration() {
            messages::print_note(&format!(
                "{model} is derived for a perpendicular pencil beam; the same profile stands in for diffuse light"
            ));
        }
        if configuration == Configuration::Diffuse
            && parameterization == Parameterization::Dmfp
            && model == Model::NormalizedDiffusion
        {
            messages::print_note(
                "there is no fit for --dmfp in the diffuse configuration; the searchlight fit stands in for it",
            );
        }
        configuration
    }

    /// Refuses a number of terms, a boundary or a phase function that the model knows nothing of.
    fn require_known(&self, model: Model) -> Result<(), Failure> {
        if self.terms.is_some() && model != Model::Gaussians {
            let message = format!("--terms is for --model gaussians, but the model is {model}");
            return Err(Failure::input(message));
        }
        if model.knows_boundary() {
            return Ok(());
        }
        self.require_fitted(model, "--eta", self.eta, 1.0, "an index-matched boundary")?;
        // A medium is replaced by the similar isotropic one
        if self.sigma_a.is_some() {
            return Ok(());
        }
        self.require_fitted(model, "--g", self.g, 0.0, "isotropic scattering")
    }

    fn require_fitted(
        &self,
        model: Model,
        option: &str,
        found: f64,
        fitted: f64,
        meaning: &str,
    ) -> Result<(), Failure> {
        if found == fitted {
            return Ok(());
        }
        let known = Model::ALL.into_iter().filter(|model| model.knows_boundary()).map(Model::name);
        let known = known.collect::<Vec<_>>().join(", ");
        let message = format!("{option} is {}, but {model} is fitted for {fitted} only", exact(found));
        let help = format!("the model stands for {meaning}; leave {option} out, or use one of {known}");
        Err(Failure::input(message).with_help(help))
    }

    /// States an error of the library in the words of the command.
    fn name_option(&self, model: Model, error: ParameterError) -> Failure {
        let length_option = if self.dmfp.is_some() { "--dmfp" } else { "--mfp" };
        let option = match error.parameter {
            "surface_albedo" => "--surface-albedo",
            "length" | "mfp" | "transport_mfp" => length_option,
            "eta" => "--eta",
            "g" => "--g",
            "sigma_a" => "--sigma-a",
            "sigma_s" => "--sigma-s",
            "sigma_t = sigma_a + sigma_s" => "--sigma-a + --sigma-s",
            other => other,
        };
        let message = format!("{option} is {}, but must be {}", exact(error.value), error.requirement());
        if option == length_option && error.value == 0.0 {
            let help = "length 0 is a Lambertian surface: light leaves where it enters, there is no profile";
            return Failure::input(message).with_help(help);
        }
        if error.limit.is_some() {
            let help = format!("no medium makes {model} return more; choose another --model");
            return Failure::input(message).with_help(help);
        }
        Failure::input(message)
    }
}
