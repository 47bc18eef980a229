//! The exact half space of isotropic scatterers.

use rayon::prelude::*;
use translucid_reference::exact::{HalfSpace, single_scattering_albedo};
use translucid_reference::{Estimate, Incidence};

use crate::options::{Options, message, require, unknown};
use crate::profile::require_radii;

/// A solution, and the mean free path that its lengths are multiples of.
pub(crate) struct Exact {
    solution: Box<HalfSpace>,
    mfp: f64,
}

impl Exact {
    pub(crate) fn new(mut options: Options) -> Result<Self, String> {
        let albedos = (options.number("surfaceAlbedo")?, options.number("singleScatteringAlbedo")?);
        let mfp = options.number("mfp")?.unwrap_or(1.0);
        let eta = options.number("eta")?.unwrap_or(1.0);
        let incidence = options.configuration()?.map_or(Incidence::Cosine, Incidence::from);
        options.finish()?;
        require("mfp", &[mfp], true, |x| (1e-100..=1e100).contains(&x), "in [1e-100, 1e100]")?;
        require("eta", &[eta], true, |x| (0.5..=3.0).contains(&x), "in [0.5, 3]")?;
        let alpha = match albedos {
            (Some(surface_albedo), None) => single_scattering_albedo(surface_albedo, eta, incidence),
            (None, Some(alpha)) => Ok(alpha),
            _ => return Err(String::from("give one of surfaceAlbedo and singleScatteringAlbedo")),
        };
        let solution = alpha.and_then(|alpha| HalfSpace::with_boundary(alpha, eta, incidence));
        Ok(Self { solution: Box::new(solution.map_err(|error| message(&error))?), mfp })
    }

    /// Replaces radii by a quantity of each, and appends the numerical error of each.
    pub(crate) fn apply(&self, mut options: Options, numbers: &mut Vec<f64>) -> Result<(), String> {
        let (name, is_one) = (options.text("quantity")?.unwrap_or_default(), options.is_set("isOne"));
        options.finish()?;
        require_radii(numbers, is_one)?;
        let Self { solution, mfp } = self;
        let per_area = |x: f64| (x / mfp / mfp).min(f64::MAX);
        let estimates: Vec<Estimate> = match name.as_str() {
            "eval" => each(numbers, *mfp, |r| {
                let found = solution.eval(r);
                Estimate { value: per_area(found.value), error: per_area(found.error) }
            }),
            "enclosed" => each(numbers, *mfp, |r| solution.enclosed(r)),
            "beyond" => each(numbers, *mfp, |r| solution.beyond(r)),
            "total" => vec![solution.total()],
            other => return Err(unknown("quantity", other, &["eval", "enclosed", "beyond", "total"])),
        };
        let values = estimates.iter().map(|estimate| estimate.value);
        *numbers = values.chain(estimates.iter().map(|estimate| estimate.error)).collect();
        Ok(())
    }
}

fn each(radii: &[f64], mfp: f64, quantity: impl Fn(f64) -> Estimate + Sync) -> Vec<Estimate> {
    radii.par_iter().map(|r| quantity(r / mfp)).collect()
}
