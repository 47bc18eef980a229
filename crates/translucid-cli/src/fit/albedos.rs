//! Fits to the exact half space for every surface albedo.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;
use translucid_fit::{ErrorSummary, Exponential, Judge, Mixture, ScalingFit, ScalingPolynomial, Target};
use translucid_profile::{
    Configuration, ExactProfile, Medium, ParameterError, Parameterization,
    half_space_single_scattering_albedo,
};

use super::output::{OutputArguments, Table, Value};
use super::report::{self, Errors, R_MAX};
use super::{Case, FamilyName, ParameterName};
use crate::failure::Failure;
use crate::model::ConfigurationName;
use crate::progress::{Meter, Unit};
use crate::table::exact;

/// The surface albedos of the talk.
fn surface_albedos() -> Vec<f64> {
    (1..=99).map(|percent| f64::from(percent) / 100.0).collect()
}

/// Errors of the library, which the options have ruled out.
fn unexpected(error: ParameterError) -> Failure {
    Failure::work(error.to_string())
}

/// Normalized diffusion: the best s for each surface albedo, and polynomials through them.
pub(super) fn burley(case: &Case, output: &OutputArguments) -> Result<(), Failure> {
    let files = ["points.csv", "coefficients.csv", "errors.csv"];
    output.check(&files, None)?;
    let (parameterization, configuration) = (case.parameterization(), case.configuration());
    let fit = ScalingFit::new(parameterization, configuration, &surface_albedos(), case.max_radius)
        .map_err(unexpected)?;
    let talk = ScalingPolynomial::talk(parameterization, configuration);
    let ours = fit.polynomial(&talk);

    // Lay out the tables
    let mut points = Table::new(files[0], &["surface_albedo", "s", "error"]);
    points.rows =
        fit.points().iter().map(|p| [p.surface_albedo, p.s, p.error].map(Value::from).to_vec()).collect();
    let columns = ["fit", "constant", "slope", "factor", "center", "power"];
    let mut coefficients = Table::new(files[1], &columns);
    for (name, form) in [("fitted", ours), ("talk", talk)] {
        let numbers = [form.constant, form.slope, form.factor, form.center, f64::from(form.power)];
        let row = [Value::from(name)].into_iter().chain(numbers.map(Value::from));
        coefficients.rows.push(row.collect());
    }
    let errors = [
        Errors { name: "best s", summaries: R_MAX.map(|r_max| fit.least_errors(r_max)) },
        Errors { name: "fitted", summaries: R_MAX.map(|r_max| fit.errors(|a| ours.eval(a), r_max)) },
        Errors { name: "talk", summaries: R_MAX.map(|r_max| fit.errors(|a| talk.eval(a), r_max)) },
    ];

    // Say what came out
    let mut text = case.heading();
    text += &format!("fitted: {ours}\n");
    text += &format!("talk:   {talk}{}\n", case.talk_note());
    text += &report::text(&errors);
    output.write(&text, &[points, coefficients, report::table(&errors)])
}

/// A sum of exponentials for each surface albedo.
pub(super) fn exponentials(case: &Case, terms: usize, output: &OutputArguments) -> Result<(), Failure> {
    let files = ["points.csv", "errors.csv"];
    output.check(&files, None)?;
    let albedos = surface_albedos();
    let meter = Meter::new(Unit::Albedos, 0, None);
    let done = AtomicU64::new(0);
    let fits: Result<Vec<AlbedoFit>, ParameterError> = albedos
        .par_iter()
        .map(|surface_albedo| {
            let fit = AlbedoFit::new(case, *surface_albedo, terms);
            meter.update(done.fetch_add(1, Ordering::Relaxed) + 1, albedos.len() as u64);
            fit
        })
        .collect();
    meter.finish();
    let fits = fits.map_err(unexpected)?;

    // Lay out the tables
    let mut points = Table::new(files[0], &["surface_albedo"]);
    points.columns.extend((1..=terms).flat_map(|k| [format!("weight_{k}"), format!("rate_{k}")]));
    points.columns.push(String::from("error"));
    points.rows = fits.iter().map(AlbedoFit::row).collect();
    let summary = |i: usize| {
        let errors: Vec<_> = fits.iter().map(|fit| (fit.surface_albedo, fit.errors[i])).collect();
        ErrorSummary::new(&errors)
    };
    let errors = [Errors { name: "fitted", summaries: [0, 1, 2].map(summary) }];
    let text = case.heading() + &report::text(&errors);
    output.write(&text, &[points, report::table(&errors)])
}

/// The exponentials of one surface albedo.
struct AlbedoFit {
    surface_albedo: f64,
    /// The length that rates are in, in mean free paths.
    length: f64,
    mixture: Mixture<Exponential>,
    /// Up to each of [`R_MAX`].
    errors: [f64; 3],
    /// Up to the radius asked for.
    error: f64,
}

impl AlbedoFit {
    fn new(case: &Case, surface_albedo: f64, terms: usize) -> Result<Self, ParameterError> {
        let configuration = case.configuration();
        let exact = ExactProfile::new(surface_albedo, 1.0, Parameterization::Mfp, configuration)?;
        let mut fits = Target::new(&exact)?.fit::<Exponential>(terms)?;
        let mixture = fits.swap_remove(terms - 1).mixture;
        let [a, b, c] = R_MAX;
        let [a, b, c, error] = Judge::new(&exact).l1_errors(&mixture, [a, b, c, case.max_radius]);
        let length = match case.parameter {
            ParameterName::Mfp => 1.0,
            ParameterName::Dmfp => dmfp(surface_albedo, configuration)?,
        };
        Ok(Self { surface_albedo, length, mixture, errors: [a, b, c], error })
    }

    /// From the least to the greatest scale.
    fn row(&self) -> Vec<Value> {
        let terms = self.mixture.terms().flat_map(|(weight, scale)| [weight, self.length / scale]);
        [self.surface_albedo].into_iter().chain(terms).chain([self.error]).map(Value::from).collect()
    }
}

/// Diffuse mean free path in mean free paths.
fn dmfp(surface_albedo: f64, configuration: Configuration) -> Result<f64, ParameterError> {
    let alpha = half_space_single_scattering_albedo(surface_albedo, configuration);
    Ok(Medium::from_mfp(alpha, 1.0, 0.0)?.dmfp())
}

impl Case {
    /// What was fitted to what.
    fn heading(&self) -> String {
        let family = match self.family {
            FamilyName::Burley => "normalized diffusion",
            FamilyName::Exponentials => "sum of exponentials",
        };
        let configuration = match self.configuration {
            ConfigurationName::Searchlight => "searchlight",
            ConfigurationName::Diffuse => "diffuse transmission",
        };
        let length = match self.parameter {
            ParameterName::Mfp => "mean free path",
            ParameterName::Dmfp => "diffuse mean free path (Grosjean's diffusion coefficient)",
        };
        let norm = match self.family {
            FamilyName::Burley if self.max_radius.is_finite() => {
                format!("least error up to r = {}", exact(self.max_radius))
            }
            FamilyName::Burley => String::from("least error over all r"),
            FamilyName::Exponentials => String::from("least squares"),
        };
        format!(
            "{family}, {configuration}, by the {length}\n\
             {norm} at the surface albedos A = 0.01, 0.02, ..., 0.99; r in mean free paths\n"
        )
    }

    /// What the talk says its fit is for, where that is something else.
    fn talk_note(&self) -> &'static str {
        match (self.parameter, self.configuration) {
            (ParameterName::Dmfp, ConfigurationName::Diffuse) => {
                "  (made for the searchlight; the talk has no other)"
            }
            _ => "",
        }
    }
}
