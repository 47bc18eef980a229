//! Fits to a table of a user's own.

use std::path::Path;
use translucid_desk::{broken_csv, read_at_most};

use csv::{ReaderBuilder, StringRecord, Trim};
use translucid_fit::{Errors, Estimate, Family, Sample, SampleFit, SampleFits};
use translucid_laboratory::{Cell, Chart, DataTable, Ink, ResidualScale, Residuals, residual_chart};
use translucid_profile::{Model, ParameterError};
use translucid_scene::{Place, SceneError};

use super::FitArguments;
use super::half_space::{self, HalfSpaceFit};
use crate::failure::Failure;

use crate::table::exact;

/// Greatest file, in bytes: a profile has some hundred radii.
const MOST_BYTES: u64 = 1 << 26;
/// Least error of a sample.
const LEAST_ERROR: f64 = 1e-250;
/// Files that -o has beside the report.
const FILES: [&str; 3] = ["parameters.csv", "residuals.csv", "residuals.svg"];
/// Most samples.
const MOST_SAMPLES: usize = 100_000;

/// Fits normalized diffusion, exponentials and Gaussians to the samples of a file.
pub(super) fn run(arguments: &FitArguments, path: &Path, terms: usize) -> Result<(), Failure> {
    let (samples, errors) = load(path)?;
    if samples.len() <= 2 * terms {
        let message = format!(
            "there are {} samples, but {terms} terms have {} parameters and need more",
            samples.len(),
            2 * terms
        );
        return Err(SceneError::at(Place::file(path), message).with_help("choose fewer --terms").into());
    }
    arguments.output.fill(&FILES, Some(path), || {
        let fail = |error: ParameterError| SceneError::at(Place::file(path), error.to_string());
        let fits = fits(&samples, errors, terms).map_err(fail)?;
        write(arguments, path, &samples, errors, &fits)
    })
}

/// Fits the exact half space to the samples of a file.
pub(super) fn run_half_space(arguments: &FitArguments, path: &Path) -> Result<(), Failure> {
    let (samples, errors) = load(path)?;
    let files = &[&FILES[..], &["correlations.csv"]].concat()[..FILES.len() + usize::from(arguments.gamma)];
    arguments.output.fill(files, Some(path), || {
        let HalfSpaceFit { fit, parameters, warnings } = half_space::fit(arguments, path, &samples, errors)?;
        let fit = Fit {
            name: "half-space",
            parameters: parameters
                .into_iter()
                .map(|(name, estimate)| (String::from(name), estimate))
                .collect(),
            chi_square: fit.chi_square(),
            degrees_of_freedom: fit.degrees_of_freedom(),
            is_singular: false,
            residuals: fit.residuals().to_vec(),
            correlations: fit.correlations(),
            warnings,
        };
        write(arguments, path, &samples, errors, &[fit])
    })
}

/// Writes the tables, the report and the chart, and warns.
fn write(
    arguments: &FitArguments,
    path: &Path,
    samples: &[Sample],
    errors: Errors,
    fits: &[Fit],
) -> Result<(), Failure> {
    let mut parameters = DataTable::new("parameters", "", &["fit", "parameter", "value", "standard_error"]);
    for fit in fits {
        for (name, estimate) in &fit.parameters {
            let words = [Cell::from(fit.name), Cell::from(name.as_str())];
            let numbers = [estimate.value, estimate.error].map(Cell::from);
            parameters.rows.push(words.into_iter().chain(numbers).collect());
        }
    }
    let mut residuals = DataTable::new("residuals", "", &["r", "reflectance", "error"]);
    residuals
        .columns
        .extend(fits.iter().map(|fit| format!("{}_residual", fit.name.replace('-', "_")).into()));
    for (i, sample) in samples.iter().enumerate() {
        let numbers = [sample.r, sample.reflectance, sample.error].into_iter();
        let all = numbers.chain(fits.iter().map(|fit| fit.residuals[i]));
        residuals.rows.push(all.map(Cell::from).collect());
    }
    let text = report(path, samples, errors, fits);
    let chart = chart(samples, errors, fits);
    let mut tables = vec![parameters, residuals];
    if let Some(correlations) = fits[0].correlations {
        let names = half_space::CORRELATED;
        let mut table = DataTable::new("correlations", "", &["parameter"]);
        table.columns.extend(names.map(|name| String::from(name).into()));
        table.rows.extend(
            names
                .iter()
                .zip(correlations)
                .map(|(name, row)| [Cell::from(*name)].into_iter().chain(row.map(Cell::from)).collect()),
        );
        tables.push(table);
    }
    arguments.output.write(&text, &tables)?;
    arguments.output.write_chart(&chart, FILES[2])?;
    warn(path, errors, fits);
    Ok(())
}

/// All fits, as they are printed.
fn fits(samples: &[Sample], errors: Errors, terms: usize) -> Result<[Fit; 3], ParameterError> {
    let fits = SampleFits::new(samples, errors, terms)?;
    Ok([
        Fit::new("normalized-diffusion", "d", samples, &fits.burley),
        Fit::new("exponentials", "scale", samples, &fits.exponentials),
        Fit::new("gaussians", "standard_deviation", samples, &fits.gaussians),
    ])
}

/// Fit as it is printed.
struct Fit {
    name: &'static str,
    parameters: Vec<(String, Estimate)>,
    chi_square: f64,
    degrees_of_freedom: usize,
    is_singular: bool,
    /// (R_fit − R)/error of each sample.
    residuals: Vec<f64>,
    correlations: Option<[[f64; 3]; 3]>,
    /// Warnings of its kind of fit.
    warnings: Vec<String>,
}

impl Fit {
    fn new<F: Family>(name: &'static str, scale: &str, samples: &[Sample], fit: &SampleFit<F>) -> Self {
        let mut parameters = vec![(String::from("surface_albedo"), fit.total())];
        for (k, (weight, length)) in fit.weights().iter().zip(fit.scales()).enumerate() {
            if name == "normalized-diffusion" {
                parameters.push((String::from(scale), *length));
            } else {
                parameters.push((format!("weight_{}", k + 1), *weight));
                parameters.push((format!("{scale}_{}", k + 1), *length));
            }
        }
        Self {
            name,
            parameters,
            chi_square: fit.chi_square(),
            degrees_of_freedom: fit.degrees_of_freedom(),
            is_singular: fit.is_singular(),
            residuals: fit.residuals(samples),
            correlations: None,
            warnings: Vec::new(),
        }
    }

    /// χ² for each degree of freedom.
    fn reduced(&self) -> f64 {
        self.chi_square / self.degrees_of_freedom as f64
    }

    /// Names of the parameters that the samples do not determine.
    fn undetermined(&self) -> Vec<&str> {
        // Of gamma, whose range is narrow, a warning of its own tells
        let is_open = |(name, estimate): &&(String, Estimate)| !estimate.is_determined() && name != "gamma";
        self.parameters.iter().filter(is_open).map(|(name, _)| name.as_str()).collect()
    }
}

/// The residuals of the fits over the radii.
fn chart(samples: &[Sample], errors: Errors, fits: &[Fit]) -> Chart {
    let radii: Vec<f64> = samples.iter().map(|sample| sample.r).collect();
    let ink = |name: &str| match name {
        "normalized-diffusion" => Ink::Model(Model::NormalizedDiffusion),
        "gaussians" => Ink::Model(Model::Gaussians),
        _ => Ink::Fit,
    };
    let drawn: Vec<Residuals<'_>> = fits
        .iter()
        .map(|fit| Residuals { label: fit.name, ink: ink(fit.name), values: &fit.residuals })
        .collect();
    let scale = match errors {
        Errors::Known => ResidualScale::StandardErrors,
        Errors::Relative => ResidualScale::Reflectance,
    };
    residual_chart(&radii, &drawn, scale)
}

fn report(path: &Path, samples: &[Sample], errors: Errors, fits: &[Fit]) -> String {
    let mut text = format!("least-squares fits to the {} samples of {}\n", samples.len(), path.display());
    text += match errors {
        Errors::Known => "parameters with standard errors, from the errors of the samples\n",
        Errors::Relative => {
            "parameters with standard errors; the file has no errors: the same relative error is taken for\n\
             each sample, as large as the residuals are\n"
        }
    };
    for fit in fits {
        let residual = match errors {
            Errors::Known => {
                format!("chi-square {:.4} for {} degrees of freedom", fit.chi_square, fit.degrees_of_freedom)
            }
            Errors::Relative => format!("relative residual {:.3} %", 100.0 * fit.reduced().sqrt()),
        };
        text += &format!("{}: {residual}\n", fit.name);
        for (name, Estimate { value, error }) in &fit.parameters {
            text += &match error.is_finite() {
                true => format!("  {name:<22}{value:>12.6e} +- {error:.1e}\n"),
                false => format!("  {name:<22}not determined\n"),
            };
        }
        if let Some(correlations) = fit.correlations {
            for (i, j) in [(0, 1), (0, 2), (1, 2)] {
                let [one, other] = [i, j].map(|k: usize| half_space::CORRELATED[k]);
                text += &format!("  correlation of {one} and {other}: {:.3}\n", correlations[i][j]);
            }
            text += half_space::ASSUMPTION;
        }
    }
    text
}

/// Reports what the samples do not determine, and which standard errors do not count.
fn warn(path: &Path, errors: Errors, fits: &[Fit]) {
    let mut warnings = Vec::new();
    let mut add = |message: String| {
        warnings.push(translucid_scene::Warning { message, place: Some(Place::file(path)) });
    };
    for fit in fits {
        let name = fit.name;
        fit.warnings.iter().for_each(|warning| add(format!("{name}: {warning}")));
        let open = fit.undetermined();
        if !open.is_empty() {
            add(format!("{name}: the samples do not determine {}", open.join(", ")));
        } else if fit.is_singular {
            add(format!("{name}: some combination of parameters has no effect on the samples"));
        }
        // A fit that holds is hardly ever this far off
        let most = 1.0 + 6.0 * (2.0 / fit.degrees_of_freedom as f64).sqrt();
        if errors == Errors::Known && fit.reduced() > most {
            let off = fit.reduced().sqrt();
            add(format!(
                "{name}: misses the samples by {off:.1} of their errors; its standard errors are too small"
            ));
        }
        if fit.parameters[0].1.value > 1.0 {
            add(format!("{name}: the surface albedo is {}, more than 1", exact(fit.parameters[0].1.value)));
        }
    }
    crate::messages::print_warnings(&warnings);
}

/// Reads the samples of a file: columns r, reflectance and optionally error or standard_error.
fn load(path: &Path) -> Result<(Vec<Sample>, Errors), SceneError> {
    let refused = |message| SceneError::at(Place::file(path), message);
    parse(&read_at_most(path, MOST_BYTES).map_err(refused)?, path)
}

fn parse(bytes: &[u8], path: &Path) -> Result<(Vec<Sample>, Errors), SceneError> {
    let mut reader = ReaderBuilder::new().trim(Trim::All).comment(Some(b'#')).from_reader(bytes);
    let broken = |error: &csv::Error| broken_csv(path, error);
    let header = reader.headers().map_err(|error| broken(&error))?.clone();
    let column = |name: &str| column(&header, name, path);
    let (r, reflectance) =
        (require(column("r")?, "r", path)?, require(column("reflectance")?, "reflectance", path)?);
    let (error, albedo) = (column("error")?.or(column("standard_error")?), column("surface_albedo")?);

    let mut samples = Vec::new();
    let mut first_albedo = None;
    for record in reader.records() {
        let record = record.map_err(|error| broken(&error))?;
        let line = record.position().map_or(0, |position| position.line() as usize);
        let fail = |message: String| SceneError::at(Place::line(path, line), message);
        let number = |column: usize, name: &str, range: [f64; 2]| {
            let text = record.get(column).unwrap_or_default();
            let [low, high] = range;
            let value = text.parse::<f64>().ok().filter(|value| (low..=high).contains(value));
            value.ok_or_else(|| {
                fail(format!("{name} is \"{text}\", but must be a number in [{low:e}, {high:e}]"))
            })
        };
        let r = number(r, "r", [1e-100, 1e100])?;
        let reflectance = number(reflectance, "reflectance", [-1e200, 1e200])?;
        let error = error.map(|error| number(error, "error", [LEAST_ERROR, 1e250])).transpose()?;
        let albedo = albedo.and_then(|column| record.get(column)).map(str::to_owned);
        if *first_albedo.get_or_insert_with(|| albedo.clone()) != albedo {
            let error = fail(String::from("another surface_albedo begins, but a fit is to one profile"));
            return Err(error.with_help("keep the lines of one surface albedo"));
        }
        // Where there are no errors, those in proportion to R
        if error.is_none() && reflectance <= 0.0 {
            return Err(fail(format!("reflectance is {reflectance}, but must be greater than 0"))
                .with_help("a file with a column \"error\" may have other reflectances"));
        }
        if samples.len() == MOST_SAMPLES {
            return Err(fail(format!("more than {MOST_SAMPLES} samples")));
        }
        samples.push(Sample { r, reflectance, error: error.unwrap_or(reflectance).max(LEAST_ERROR) });
    }
    let errors = if error.is_some() { Errors::Known } else { Errors::Relative };
    Ok((samples, errors))
}

/// Where a column is, if it is there once.
fn column(header: &StringRecord, name: &str, path: &Path) -> Result<Option<usize>, SceneError> {
    let mut columns = (0..header.len()).filter(|&i| header[i].eq_ignore_ascii_case(name));
    match (columns.next(), columns.next()) {
        (_, Some(_)) => {
            Err(SceneError::at(Place::line(path, 1), format!("there are two columns \"{name}\"")))
        }
        (first, None) => Ok(first),
    }
}

fn require(column: Option<usize>, name: &str, path: &Path) -> Result<usize, SceneError> {
    column.ok_or_else(|| {
        SceneError::at(Place::line(path, 1), format!("there is no column \"{name}\""))
            .with_help("the columns are r,reflectance and optionally error, separated by commas")
    })
}
