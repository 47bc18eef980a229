//! Profiles: of a model, a medium or samples; applied to numbers.

use std::sync::Arc;

use translucid_profile::{
    Appearance, Configuration, Medium, Model, ParameterError, Parameterization, Profile, Quantity,
    SampledProfile,
};

use crate::options::{self, Options, message, require, unknown};

const QUANTITIES: [(&str, Quantity); 8] = [
    ("eval", Quantity::Eval),
    ("pdf", Quantity::Pdf),
    ("pdfArea", Quantity::PdfArea),
    ("cdf", Quantity::Cdf),
    ("enclosed", Quantity::Enclosed),
    ("beyond", Quantity::Beyond),
    ("quantile", Quantity::Quantile),
    ("sample", Quantity::Sample),
];

/// The profile of a model.
pub(crate) fn of_appearance(mut options: Options) -> Result<Arc<dyn Profile>, String> {
    let model = model(&mut options)?;
    let surface_albedo = options.needed_number("surfaceAlbedo")?;
    let (name, length, parameterization) = match (options.number("mfp")?, options.number("dmfp")?) {
        (Some(mfp), None) => ("mfp", mfp, Parameterization::Mfp),
        (None, Some(dmfp)) => ("dmfp", dmfp, Parameterization::Dmfp),
        _ => return Err(String::from("give one of mfp and dmfp")),
    };
    let g = options.number("g")?.unwrap_or(0.0);
    let eta = options.number("eta")?.unwrap_or(1.0);
    let configuration = options.configuration()?.unwrap_or(parameterization.usual_configuration());
    options.finish()?;
    let appearance = Appearance { surface_albedo, length, parameterization, g };
    let made = model.profile(&appearance, configuration, eta).map_err(|error| {
        let is_length = matches!(error.parameter, "length" | "transport_mfp");
        message(&ParameterError { parameter: if is_length { name } else { error.parameter }, ..error })
    })?;
    Ok(made.into())
}

/// The profile of a medium.
pub(crate) fn of_medium(mut options: Options) -> Result<Arc<dyn Profile>, String> {
    let model = model(&mut options)?;
    let (sigma_a, sigma_s) = (options.needed_number("sigmaA")?, options.needed_number("sigmaS")?);
    let g = options.number("g")?.unwrap_or(0.0);
    let eta = options.number("eta")?.unwrap_or(1.0);
    let configuration = options.configuration()?.unwrap_or(Configuration::Diffuse);
    options.finish()?;
    let medium = Medium::new(sigma_a, sigma_s, g);
    let made = medium.and_then(|medium| model.profile_of_medium(&medium, configuration, eta));
    Ok(made.map_err(|error| message(&error))?.into())
}

/// The profile through samples: radii, R(r) and, where they are known, the energies within.
pub(crate) fn of_samples(mut options: Options) -> Result<Arc<dyn Profile>, String> {
    let mut column = |name| options.numbers(name);
    let (radii, reflectances, enclosed) = (column("r")?, column("reflectance")?, column("enclosed")?);
    options.finish()?;
    let radii = radii.ok_or("r is missing")?;
    let reflectances = reflectances.ok_or("reflectance is missing")?;
    for (name, column) in [("reflectance", Some(&reflectances)), ("enclosed", enclosed.as_ref())] {
        if let Some(column) = column.filter(|column| column.len() != radii.len()) {
            let (count, radii) = (column.len(), radii.len());
            return Err(format!("{name} has {count} numbers, but must have {radii}, as r has"));
        }
    }
    let made = match enclosed {
        None => SampledProfile::new(&radii, &reflectances),
        Some(enclosed) => SampledProfile::from_samples_and_enclosed(&radii, &reflectances, &enclosed),
    };
    Ok(Arc::new(made.map_err(|error| {
        let is_radius = error.parameter == "radius";
        message(&ParameterError { parameter: if is_radius { "r" } else { error.parameter }, ..error })
    })?))
}

/// Replaces radii, or shares for a quantile and samples, by a quantity.
pub(crate) fn apply(profile: &dyn Profile, mut options: Options, numbers: &mut [f64]) -> Result<(), String> {
    let (name, is_one) = (options.text("quantity")?.unwrap_or_default(), options.is_set("isOne"));
    options.finish()?;
    let found = QUANTITIES.iter().find(|(known, _)| *known == name);
    let &(_, quantity) =
        found.ok_or_else(|| unknown("quantity", &name, &QUANTITIES.map(|(known, _)| known)))?;
    match quantity {
        Quantity::Quantile | Quantity::Sample => {
            require("u", numbers, is_one, |u| (0.0..=1.0).contains(&u), "in [0, 1]")?;
        }
        _ => require_radii(numbers, is_one)?,
    }
    let from = numbers.to_vec();
    profile.apply(quantity, &from, numbers);
    Ok(())
}

pub(crate) fn require_radii(numbers: &[f64], is_one: bool) -> Result<(), String> {
    require("r", numbers, is_one, |r| r >= 0.0, "at least 0")
}

fn model(options: &mut Options) -> Result<Model, String> {
    options.text("model")?.map_or(Ok(Model::default()), |name| options::model(&name))
}
