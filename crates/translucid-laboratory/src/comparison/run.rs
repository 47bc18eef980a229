//! Everything at once.

use rayon::prelude::*;
use translucid_profile::{Configuration, Model, Parameterization};

use super::errors::Asked;
use super::watch::{Progress, Stopped};
use super::{
    Claim, Contender, ErrorTable, FresnelCurve, MixtureErrors, Reference, Reflectance, SampleTest, Sampling,
    ScalingCase, Timing, Walk, Watch, claims, fresnel_curves, sampling, talk_albedos, timing,
};

/// Everything that a [`Comparison`] is asked for.
pub struct Settings {
    /// The contenders.
    pub contenders: Vec<Contender>,
    /// Surface albedos that get figures, each in (0, 1\].
    pub surface_albedos: Vec<f64>,
    /// Surface albedos that mean errors are over.
    pub averaged: Vec<f64>,
    /// Ways in which light enters.
    pub configurations: Vec<Configuration>,
    /// Greatest radius of the figures in mean free paths, at least 0.2.
    pub max_radius: f64,
    /// Photons of a walk in each configuration; 0 for no walk.
    pub photons: u64,
    /// Seed of the photons and of drawn radii.
    pub seed: u64,
    /// Radii that are drawn from each model.
    pub samples: u64,
    /// Rounds in which calls are timed, some 80 for figures that hold; 0 for no times.
    pub timing_rounds: usize,
}

impl Default for Settings {
    /// Everything, at the albedos of the talk.
    fn default() -> Self {
        Self {
            contenders: Contender::all(),
            surface_albedos: vec![0.2, 0.5, 0.8],
            averaged: talk_albedos(),
            configurations: vec![Configuration::Searchlight, Configuration::Diffuse],
            max_radius: 16.0,
            photons: 4_000_000,
            seed: 0,
            samples: 200_000,
            timing_rounds: 80,
        }
    }
}

impl Settings {
    /// The cases of s(A): none without the model that it is for.
    fn scaling_cases(&self) -> &'static [(Parameterization, Configuration, f64)] {
        let normalized = Model::NormalizedDiffusion.name();
        if self.contenders.iter().any(|one| one.name == normalized) { &ScalingCase::TALK } else { &[] }
    }

    fn asked(&self) -> Asked<'_> {
        let Self { contenders, configurations, averaged, surface_albedos: others, .. } = self;
        Asked { contenders, configurations, averaged, others }
    }
}

/// The numbers of all figures and tables.
///
/// But for the times they are functions of the settings, whatever the threads.
pub struct Comparison {
    /// Settings that it was made with.
    pub settings: Settings,
    /// By configuration and albedo.
    pub reflectances: Vec<Reflectance>,
    /// L1 errors.
    pub errors: ErrorTable,
    /// Claims of the talk about these errors.
    pub claims: Vec<Claim>,
    /// s(A).
    pub scaling: Vec<ScalingCase>,
    /// Histograms of the models.
    pub samples: Vec<SampleTest>,
    /// Sums of Gaussians and exponentials.
    pub mixtures: Vec<MixtureErrors>,
    /// Schlick's approximation.
    pub fresnel: Vec<FresnelCurve>,
    /// Nanoseconds a call.
    pub timings: Vec<Timing>,
    /// Surface albedo of histograms and times: the middle one of those asked for.
    pub middle_albedo: f64,
}

/// Milliseconds for all s(A) of one case, and for a histogram.
const SCALING_COST: u64 = 400;
const HISTOGRAM_COST: u64 = 30;

impl Comparison {
    /// Computes everything on all threads of the current rayon pool, the times on one while the others rest.
    ///
    /// # Errors
    /// The work was stopped.
    pub fn new(settings: Settings, watch: Watch<'_>) -> Result<Self, Stopped> {
        let progress = Progress::new(watch, work(&settings));
        let Settings { contenders, surface_albedos, configurations, .. } = &settings;
        let middle_albedo = surface_albedos.get(surface_albedos.len() / 2).copied().unwrap_or(0.5);

        // Times first: the machine is coolest and quietest before the rest
        let middle = Reference::new(middle_albedo, sampling::CONFIGURATION).ok();
        let timings = match &middle {
            Some(reference) => timing::timed(contenders, reference, settings.timing_rounds, &progress)?,
            None => Vec::new(),
        };
        let errors = settings.asked().judge(&progress)?;
        let cases = settings.scaling_cases().into_par_iter().map(|&(length, configuration, _)| {
            progress.check()?;
            let case = ScalingCase::new(length, configuration, f64::INFINITY);
            progress.add(SCALING_COST);
            Ok(case.ok())
        });
        let scaling = cases.collect::<Result<Vec<_>, Stopped>>()?.into_iter().flatten().collect();
        let sampled: Vec<&Contender> = contenders.iter().filter(|one| one.is_model()).collect();
        let draw = Sampling { seed: settings.seed, count: settings.samples };
        let histograms = sampled.into_par_iter().map(|contender| {
            progress.check()?;
            let test = middle.as_ref().and_then(|middle| SampleTest::new(contender, middle, draw).ok());
            progress.add(HISTOGRAM_COST);
            Ok(test)
        });
        let samples = histograms.collect::<Result<Vec<_>, Stopped>>()?.into_iter().flatten().collect();
        let mut reflectances = Vec::new();
        for configuration in configurations {
            reflectances.extend(reflectances_of(&settings, *configuration, &progress)?);
        }

        Ok(Self {
            claims: claims(contenders, &errors, surface_albedos),
            mixtures: MixtureErrors::of(&errors, configurations),
            fresnel: fresnel_curves(),
            reflectances,
            errors,
            scaling,
            samples,
            timings,
            middle_albedo,
            settings,
        })
    }

    /// The contender of a name.
    pub fn contender(&self, name: &str) -> Option<&Contender> {
        self.settings.contenders.iter().find(|one| one.name == name)
    }

    /// Tells whether a model was asked for.
    pub fn has(&self, model: Model) -> bool {
        self.contender(model.name()).is_some()
    }
}

/// Curves and points of one configuration.
fn reflectances_of(
    settings: &Settings,
    configuration: Configuration,
    progress: &Progress<'_>,
) -> Result<Vec<Reflectance>, Stopped> {
    let albedos = settings.surface_albedos.par_iter();
    let references: Vec<Reference> = albedos.filter_map(|a| Reference::new(*a, configuration).ok()).collect();
    let of_all: Vec<&Reference> = references.iter().collect();
    let walk = Walk::new(&of_all, settings.max_radius, settings.seed, settings.photons, progress)?;
    let contenders: Vec<&Contender> = settings.contenders.iter().collect();
    let curves = references.par_iter().map(|reference| {
        progress.check()?;
        Ok(Reflectance::new(reference, &contenders, walk.as_ref(), settings.max_radius))
    });
    curves.collect()
}

/// All work, in the units of progress.
fn work(settings: &Settings) -> u64 {
    let Settings { contenders, configurations, .. } = settings;
    let models = contenders.iter().filter(|one| one.is_model()).count() as u64;
    timing::work(contenders, settings.timing_rounds)
        + settings.asked().work()
        + SCALING_COST * settings.scaling_cases().len() as u64
        + HISTOGRAM_COST * models
        + configurations.len() as u64 * Walk::work(settings.photons)
}
