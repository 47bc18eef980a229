//! Fits to the exact half space for every surface albedo.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;
use translucid_fit::{ErrorSummary, Exponential, Judge, Mixture, Target};
use translucid_laboratory::comparison::{R_MAX, ScalingCase, talk_albedos};
use translucid_laboratory::{Cell, DataTable};
use translucid_profile::{
    Configuration, ExactProfile, Medium, ParameterError, Parameterization,
    half_space_single_scattering_albedo,
};

use super::output::OutputArguments;
use super::report::{self, Errors};
use super::{Case, FamilyName};
use crate::failure::Failure;
use crate::progress::{Meter, Unit};
use crate::table::exact;

/// Errors of the library, which the options have ruled out.
fn unexpected(error: ParameterError) -> Failure {
    Failure::work(error.to_string())
}

/// Normalized diffusion: the best s for each surface albedo, and polynomials through them.
pub(super) fn burley(case: &Case, output: &OutputArguments) -> Result<(), Failure> {
    output.fill(&BURLEY_FILES, None, || {
        let fit = ScalingCase::new(case.parameterization, case.configuration, case.max_radius);
        let fit = fit.map_err(unexpected)?;
        output.write(&burley_report(case, &fit), &burley_tables(&fit))
    })
}

/// Fits normalized diffusion in the three cases that the talk has polynomials for; the columns begin with the case.
pub(super) fn burley_of_the_talk(max_radius: f64, output: &OutputArguments) -> Result<(), Failure> {
    output.fill(&BURLEY_FILES, None, || {
        let cases = Case::of_the_talk(max_radius);
        let fits: Result<Vec<ScalingCase>, ParameterError> = cases
            .par_iter()
            .map(|case| ScalingCase::new(case.parameterization, case.configuration, max_radius))
            .collect();
        let fits = fits.map_err(unexpected)?;
        let reports: Vec<String> =
            cases.iter().zip(&fits).map(|(case, fit)| burley_report(case, fit)).collect();
        let mut tables: Vec<DataTable> = Vec::new();
        for (case, fit) in cases.iter().zip(&fits) {
            for (i, mut table) in burley_tables(fit).into_iter().enumerate() {
                table
                    .columns
                    .splice(0..0, ["configuration", "parameter"].map(|name| String::from(name).into()));
                for row in &mut table.rows {
                    let words = [case.configuration.name(), case.parameterization.name()];
                    row.splice(0..0, words.map(Cell::from));
                }
                match tables.get_mut(i) {
                    Some(all) => all.rows.extend(table.rows),
                    None => tables.push(table),
                }
            }
        }
        output.write(&reports.join("\n"), &tables)
    })
}

const BURLEY_FILES: [&str; 3] = ["points.csv", "coefficients.csv", "errors.csv"];

fn burley_tables(fit: &ScalingCase) -> [DataTable; 3] {
    let mut points = DataTable::new("points", "", &["surface_albedo", "s", "error"]);
    points.rows = fit.points.iter().map(|point| point.map(Cell::from).to_vec()).collect();
    let columns = ["fit", "constant", "slope", "factor", "center", "power"];
    let mut coefficients = DataTable::new("coefficients", "", &columns);
    for (name, form) in [("fitted", fit.fitted), ("talk", fit.talk)] {
        let numbers = [form.constant, form.slope, form.factor, form.center, f64::from(form.power)];
        let row = [Cell::from(name)].into_iter().chain(numbers.map(Cell::from));
        coefficients.rows.push(row.collect());
    }
    [points, coefficients, report::table(&burley_errors(fit))]
}

fn burley_errors(fit: &ScalingCase) -> [Errors; 3] {
    [
        Errors { name: "best s", summaries: fit.least_errors },
        Errors { name: "fitted", summaries: fit.fitted_errors },
        Errors { name: "talk", summaries: fit.talk_errors },
    ]
}

/// Report on a fit, and on whether it is what the talk says.
fn burley_report(case: &Case, fit: &ScalingCase) -> String {
    let mut text = case.heading();
    text += &format!("fitted: {}\n", fit.fitted);
    text += &format!("talk:   {}{}\n", fit.talk, case.talk_note());
    text += &report::text(&burley_errors(fit));
    if let (Some(stated), Some((nearest, is_confirmed))) = (fit.stated, fit.reproduction()) {
        let range = report::range(R_MAX[nearest]);
        let found = 100.0 * fit.talk_errors[nearest].mean;
        let stated = format!("the talk states a mean error of about {:.1} %", 100.0 * stated);
        text += &if is_confirmed {
            format!("{stated}: {found:.2} % over {range}\n")
        } else {
            format!(
                "{stated}, which none of these ranges has within half a point; nearest is {found:.2} % over {range}\n"
            )
        };
    }
    text
}

/// A sum of exponentials for each surface albedo.
pub(super) fn exponentials(case: &Case, terms: usize, output: &OutputArguments) -> Result<(), Failure> {
    let files = ["points.csv", "errors.csv"];
    output.fill(&files, None, || {
        let albedos = talk_albedos();
        let meter = Meter::new(Unit::Albedos);
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
        let mut points = DataTable::new("points", "", &["surface_albedo"]);
        points
            .columns
            .extend((1..=terms).flat_map(|k| [format!("weight_{k}").into(), format!("rate_{k}").into()]));
        points.columns.push(String::from("error").into());
        points.rows = fits.iter().map(AlbedoFit::row).collect();
        let summary = |i: usize| {
            let errors: Vec<_> = fits.iter().map(|fit| (fit.surface_albedo, fit.errors[i])).collect();
            ErrorSummary::new(&errors)
        };
        let errors = [Errors { name: "fitted", summaries: [0, 1, 2].map(summary) }];
        let text = case.heading() + &report::text(&errors);
        output.write(&text, &[points, report::table(&errors)])
    })
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
        let configuration = case.configuration;
        let exact = ExactProfile::new(surface_albedo, 1.0, Parameterization::Mfp, configuration)?;
        let mut fits = Target::new(&exact)?.fit::<Exponential>(terms)?;
        let mixture = fits.swap_remove(terms - 1).mixture;
        let [a, b, c] = R_MAX;
        let [a, b, c, error] = Judge::new(&exact).l1_errors(&mixture, [a, b, c, case.max_radius]);
        let length = match case.parameterization {
            Parameterization::Mfp => 1.0,
            Parameterization::Dmfp => dmfp(surface_albedo, configuration)?,
        };
        Ok(Self { surface_albedo, length, mixture, errors: [a, b, c], error })
    }

    /// From the least to the greatest scale.
    fn row(&self) -> Vec<Cell> {
        let terms = self.mixture.terms().flat_map(|(weight, scale)| [weight, self.length / scale]);
        [self.surface_albedo].into_iter().chain(terms).chain([self.error]).map(Cell::from).collect()
    }
}

/// Diffuse mean free path in mean free paths.
fn dmfp(surface_albedo: f64, configuration: Configuration) -> Result<f64, ParameterError> {
    let alpha = half_space_single_scattering_albedo(surface_albedo, configuration);
    Ok(Medium::from_mfp(alpha, 1.0, 0.0)?.dmfp())
}

impl Case {
    /// The cases of the talk.
    fn of_the_talk(max_radius: f64) -> [Self; 3] {
        ScalingCase::TALK.map(|(parameterization, configuration, _)| Self {
            configuration,
            parameterization,
            family: FamilyName::Burley,
            max_radius,
        })
    }

    /// First lines of a report: family, configuration, length and norm.
    fn heading(&self) -> String {
        let family = match self.family {
            FamilyName::Burley => "normalized diffusion",
            FamilyName::Exponentials => "sum of exponentials",
            FamilyName::HalfSpace => "exact half space",
        };
        let configuration = match self.configuration {
            Configuration::Searchlight => "searchlight",
            Configuration::Diffuse => "diffuse transmission",
        };
        let length = match self.parameterization {
            Parameterization::Mfp => "mean free path",
            Parameterization::Dmfp => "diffuse mean free path (Grosjean's diffusion coefficient)",
        };
        let norm = match self.family {
            FamilyName::Burley if self.max_radius.is_finite() => {
                format!("least error up to r = {}", exact(self.max_radius))
            }
            FamilyName::Burley => String::from("least error over all r"),
            FamilyName::Exponentials | FamilyName::HalfSpace => String::from("least squares"),
        };
        format!(
            "{family}, {configuration}, by the {length}\n\
             {norm} at the surface albedos A = 0.01, 0.02, ..., 0.99; r in mean free paths\n"
        )
    }

    /// Case that the talk says its fit is for, where that is another.
    fn talk_note(&self) -> &'static str {
        match (self.parameterization, self.configuration) {
            (Parameterization::Dmfp, Configuration::Diffuse) => {
                "  (made for the searchlight; the talk has no other)"
            }
            _ => "",
        }
    }
}
