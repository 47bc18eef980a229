//! Everything at once.

use rayon::prelude::*;
use translucid_profile::{Configuration, Model};

use super::watch::{Progress, Stopped};
use super::{
    Claim, Contender, ErrorTable, FresnelCurve, Reference, Reflectance, SampleTest, ScalingCase, Settings,
    Timing, Walk, Watch, claims, fresnel_curves, sampling, timing,
};

/// The numbers of all figures and tables.
///
/// But for the times they are functions of the settings, whatever the threads.
pub struct Comparison {
    /// Settings that it was made with.
    pub settings: Settings,
    /// Reflectances sorted by configuration and albedo.
    pub reflectances: Vec<Reflectance>,
    /// L1 errors.
    pub errors: ErrorTable,
    /// Claims of the talk about these errors.
    pub claims: Vec<Claim>,
    /// s(A).
    pub scaling: Vec<ScalingCase>,
    /// Histograms of the models.
    pub samples: Vec<SampleTest>,
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
        let errors = ErrorTable::new(&settings, &progress)?;
        let cases = settings.scaling_cases().into_par_iter().map(|&(length, configuration, _)| {
            progress.check()?;
            let case = ScalingCase::new(length, configuration, f64::INFINITY);
            progress.add(SCALING_COST);
            Ok(case.ok())
        });
        let scaling = cases.collect::<Result<Vec<_>, Stopped>>()?.into_iter().flatten().collect();
        let sampled: Vec<&Contender> = contenders.iter().filter(|one| one.is_model()).collect();
        let histograms = sampled.into_par_iter().map(|contender| {
            progress.check()?;
            let test = middle.as_ref().and_then(|middle| SampleTest::new(contender, middle, &settings).ok());
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

    /// Returns whether a model was asked for.
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
        + ErrorTable::work(settings)
        + SCALING_COST * settings.scaling_cases().len() as u64
        + HISTOGRAM_COST * models
        + configurations.len() as u64 * Walk::work(settings.photons)
}
