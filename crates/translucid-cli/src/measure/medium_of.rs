//! The medium that is asked for, and the isotropic scatterers that are fitted in its place.

use translucid_measure::{Fit, Interval, Response, Scale};
use translucid_profile::Medium;
use translucid_reference::Incidence;
use translucid_reference::exact::single_scattering_albedo;

use super::arguments::{MeasureArguments, SetupName};
use crate::failure::Failure;

/// Relation between the medium that is asked for and isotropic scatterers below its boundary.
pub(super) struct MediumOf {
    eta: f64,
    g: f64,
    incidence: Incidence,
    /// Light of isotropic scatterers, which is fitted.
    pub(super) response: Response,
}

impl MediumOf {
    /// The medium of the options.
    ///
    /// # Errors
    /// An option is out of its range, or the combination is not solved.
    pub(super) fn new(arguments: &MeasureArguments) -> Result<Self, Failure> {
        let MeasureArguments { eta, g, .. } = *arguments;
        let configuration = translucid_profile::Configuration::from(arguments.configuration);
        let (incidence, response) = match arguments.incidence {
            Some(_) if eta != 1.0 => {
                let message = "--incidence is for --eta 1: below a boundary only light of all directions together is \
                               solved exactly here";
                return Err(Failure::input(message).with_help(
                    "light the piece evenly from all around instead, with --configuration searchlight",
                ));
            }
            Some(angle) if angle != 0.0 && arguments.setup == SetupName::Spot => {
                let message =
                    format!("--incidence is {angle}, but the light around a spot is round only for 0");
                return Err(Failure::input(message));
            }
            Some(angle) => {
                let beam = Response::of_beam(angle.to_radians());
                (Incidence::NORMAL, beam.map_err(|error| Failure::input(format!("--incidence: {error}")))?)
            }
            None => {
                let incidence = Incidence::from(configuration);
                let response = match arguments.thickness {
                    Some(thickness) => Ok(Response::of_slab(thickness, incidence)),
                    None => Response::new(eta, incidence),
                };
                (incidence, response.map_err(|error| Failure::input(format!("--eta: {error}")))?)
            }
        };
        Medium::new(1.0, 1.0, g).map_err(|error| Failure::input(format!("--g: {error}")))?;
        Ok(Self { eta, g, incidence, response })
    }

    /// Turns the mean free paths of isotropic scatterers into those of the similar medium: σ_a and (1 − g) σ_s are the same.
    pub(super) fn scale(&self, fit: &mut Fit, scale: Scale) -> Result<(), Failure> {
        for (c, channel) in fit.channels.iter_mut().enumerate() {
            let albedo = match (scale, channel.surface_albedo) {
                (Scale::Relative(albedos), _) => albedos[c],
                (Scale::Reflectance, albedo) => albedo.map_or(0.0, |albedo| albedo.value.clamp(1e-3, 0.9999)),
            };
            let similar = |error: translucid_profile::ParameterError| Failure::work(error.to_string());
            let alpha = single_scattering_albedo(albedo, self.eta, self.incidence).map_err(similar)?;
            let medium = Medium::from_reduced(1.0 - alpha, alpha, self.g).map_err(similar)?;
            let factor = medium.mfp();
            let Interval { value, likely, sure } = channel.mfp;
            channel.mfp = Interval {
                value: factor * value,
                likely: likely.map(|l| factor * l),
                sure: sure.map(|l| factor * l),
            };
        }
        Ok(())
    }
}
