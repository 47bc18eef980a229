//! The medium that is asked for, and the isotropic scatterers that are fitted in its place.

use translucid_profile::{Configuration, Medium, ParameterError};
use translucid_reference::Incidence;
use translucid_reference::exact::single_scattering_albedo;

use crate::error::MeasureError;
use crate::fit::{Fit, Interval, Scale};
use crate::options::{Options, Setup};
use crate::response::Response;

/// Relation between the medium that is asked for and isotropic scatterers below its boundary, by similarity: σ_a and
/// (1 − g) σ_s are the same.
#[derive(Debug)]
pub(crate) struct SimilarMedium {
    eta: f64,
    g: f64,
    incidence: Incidence,
    /// Light of isotropic scatterers, which is fitted.
    pub(crate) response: Response,
}

impl SimilarMedium {
    /// The medium of the options.
    ///
    /// # Errors
    /// An option is out of its range, or the combination is not solved.
    pub(crate) fn new(options: &Options) -> Result<Self, MeasureError> {
        let Options { eta, g, .. } = *options;
        let (incidence, response) = match options.incidence {
            Some(angle) => (Incidence::NORMAL, beam_response(angle, options)?),
            None => {
                let incidence = Incidence::from(options.configuration.unwrap_or(Configuration::Diffuse));
                let response = match options.thickness {
                    Some(thickness) => Ok(Response::of_slab(thickness, incidence)),
                    None => Response::new(eta, incidence),
                };
                (incidence, response.map_err(|error| MeasureError::of_option("eta", &error))?)
            }
        };
        Medium::new(1.0, 1.0, g).map_err(|error| MeasureError::of_option("g", &error))?;
        Ok(Self { eta, g, incidence, response })
    }

    /// Turns the mean free paths of isotropic scatterers into those of the similar medium.
    pub(crate) fn scale(&self, fit: &mut Fit, scale: Scale) -> Result<(), MeasureError> {
        for (c, channel) in fit.channels.iter_mut().enumerate() {
            let measured = channel.surface_albedo.map_or(0.0, |albedo| albedo.value.clamp(1e-3, 0.9999));
            let albedo = scale.albedo(c).unwrap_or(measured);
            let factor = self.mfp(albedo).map_err(|error| MeasureError::new(error.to_string()))?;
            let Interval { value, likely, sure } = channel.mfp;
            channel.mfp = Interval {
                value: factor * value,
                likely: likely.map(|l| factor * l),
                sure: sure.map(|l| factor * l),
            };
        }
        Ok(())
    }

    /// Mean free path of the medium in those of the isotropic scatterers with a surface albedo.
    fn mfp(&self, surface_albedo: f64) -> Result<f64, ParameterError> {
        let alpha = single_scattering_albedo(surface_albedo, self.eta, self.incidence)?;
        Ok(Medium::from_reduced(1.0 - alpha, alpha, self.g)?.mfp())
    }
}

/// Light of a lamp at an angle \[degrees\].
fn beam_response(angle: f64, options: &Options) -> Result<Response, MeasureError> {
    if options.eta != 1.0 {
        let message = "`incidence` is for `eta` 1: below a boundary only light of all directions together is solved \
                       exactly here";
        return Err(MeasureError::new(message)
            .with_help("light the piece evenly from all around instead, with `configuration` searchlight"));
    }
    if angle != 0.0 && options.setup == Setup::Spot {
        let message = format!("`incidence` is {angle}, but the light around a spot is round only for 0");
        return Err(MeasureError::new(message));
    }
    Response::of_beam(angle.to_radians()).map_err(|error| MeasureError::of_option("incidence", &error))
}
