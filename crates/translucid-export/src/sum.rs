//! Sums of exponentials or Gaussians for the channels of a material, as functions that return their terms.
//!
//! Gaussians are a model of their own. Any other model that is no closed form is a sum that is fitted to its profile by
//! least squares, with what it misses: of exponentials, or of Gaussians where the density 2πr R(r) is 0 at r = 0, as
//! that of dipoles is.

use translucid_fit::{Exponential, Family, Gaussian, Mixture, fit, l1_error};
use translucid_profile::{Model, ParameterError, Profile, SumOfGaussians};

use crate::number::literal;

/// Weights below count as none: single precision rounds them away.
const LEAST_WEIGHT: f64 = 1e-9;

/// Terms of a sum: what its functions are called after, and what the text calls them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Terms {
    Exponentials,
    Gaussians,
}

impl Terms {
    /// The terms of a model's sum.
    pub(crate) fn of(model: Model) -> Self {
        match model {
            Model::Gaussians | Model::Dipole | Model::BetterDipole | Model::DirectionalDipole => {
                Self::Gaussians
            }
            _ => Self::Exponentials,
        }
    }

    /// How many there are.
    const fn count(self) -> usize {
        match self {
            Self::Exponentials => 4,
            Self::Gaussians => SumOfGaussians::DEFAULT_TERMS,
        }
    }
}

/// A sum for each channel.
pub(crate) struct Sum {
    terms: Terms,
    /// What is in it, as a comment.
    comment: String,
    /// Surface albedo, weights, and rates or deviations of red, green, blue.
    channels: [(f64, Vec<f64>, Vec<f64>); 3],
}

/// The four exponentials that stand for a profile in exported texts \[L\].
///
/// # Errors
/// As [`fit`].
pub fn exponentials(profile: &dyn Profile) -> Result<Mixture<Exponential>, ParameterError> {
    fitted(profile, Terms::Exponentials)
}

/// The terms next to a profile \[L\]; without light, one of the profile's width.
fn fitted<F: Family>(profile: &dyn Profile, terms: Terms) -> Result<Mixture<F>, ParameterError> {
    if profile.surface_albedo() == 0.0 {
        let mut alone = vec![(0.0, profile.scale()); terms.count()];
        alone[terms.count() - 1].0 = 1.0;
        return Mixture::new(0.0, &alone);
    }
    // There are as many fits as terms
    let last = fit::<F>(profile, terms.count())?.into_iter().last();
    let mixture = last.ok_or(ParameterError::new("terms", 0.0, "at least 1"))?.mixture;
    // A fit may leave terms without light, at any scale, also at one that no shader has: they go to the heaviest
    let (light, dark): (Vec<_>, Vec<_>) = mixture.terms().partition(|term| term.0 > LEAST_WEIGHT);
    if dark.is_empty() {
        return Ok(mixture);
    }
    let heaviest =
        light.iter().fold((0.0, 0.0), |most: (f64, f64), term| if term.0 > most.0 { *term } else { most });
    let dark = dark.iter().map(|_| (0.0, heaviest.1));
    Mixture::new(mixture.surface_albedo(), &dark.chain(light).collect::<Vec<_>>())
}

impl Sum {
    /// The sum that is fitted to a model's profiles.
    pub(crate) fn of_fits(model: Model, profiles: &[Box<dyn Profile>; 3]) -> Result<Self, ParameterError> {
        match Terms::of(model) {
            Terms::Exponentials => Self::of_family::<Exponential>(model, profiles, |scale| 1.0 / scale),
            Terms::Gaussians => Self::of_family::<Gaussian>(model, profiles, |scale| scale),
        }
    }

    fn of_family<F: Family>(
        model: Model,
        profiles: &[Box<dyn Profile>; 3],
        width: fn(f64) -> f64,
    ) -> Result<Self, ParameterError> {
        let terms = Terms::of(model);
        let mut channels: [(f64, Vec<f64>, Vec<f64>); 3] = Default::default();
        let mut errors = [0.0; 3];
        for c in 0..3 {
            let mixture = fitted::<F>(&*profiles[c], terms)?;
            if profiles[c].surface_albedo() > 0.0 {
                errors[c] = 100.0 * l1_error(&mixture, &*profiles[c], f64::INFINITY);
            }
            let widths = mixture.scales().iter().map(|scale| width(*scale)).collect();
            channels[c] = (profiles[c].surface_albedo(), mixture.weights().to_vec(), widths);
        }
        let [red, green, blue] = errors;
        let comment = format!(
            ": the least squares fit to {}.
// Of the light {red:.2}, {green:.2}, {blue:.2} percent is not where that profile has it.",
            model.name()
        );
        Ok(Self { terms, comment, channels })
    }

    pub(crate) fn of_gaussians(profiles: [SumOfGaussians; 3]) -> Self {
        let channels = profiles
            .map(|sum| (sum.surface_albedo(), sum.weights().to_vec(), sum.standard_deviations().to_vec()));
        Self { terms: Terms::Gaussians, comment: String::from("."), channels }
    }

    /// The function in WGSL.
    pub(crate) fn wgsl(&self) -> String {
        let (structure, function, width) = match self.terms {
            Terms::Exponentials => ("Exponentials", "exponentials_of_channel", "rate"),
            Terms::Gaussians => ("Gaussians", "gaussians_of_channel", "deviation"),
        };
        let of_channel = |c: usize| {
            let (total, weights, widths) = &self.channels[c];
            let mut text = format!("        terms.surface_albedo = {};\n", literal(*total));
            for (name, numbers) in [("weight", weights), (width, widths)] {
                for (letter, number) in ('a'..).zip(numbers) {
                    text += &format!("        terms.{name}_{letter} = {};\n", literal(*number));
                }
            }
            text
        };
        let [red, green, blue] = [0, 1, 2].map(of_channel);
        let comment = &self.comment;
        format!(
            "\n// {structure} of a channel, 0 for red, 1 for green, 2 for blue{comment}
fn {function}(channel: f32) -> {structure} {{
    var terms: {structure};
    if (channel < 0.5) {{\n{red}    }} else if (channel < 1.5) {{\n{green}    }} else {{\n{blue}    }}
    return terms;
}}
"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use translucid_profile::{Appearance, Configuration, Parameterization};

    /// The fit to quantized diffusion leaves terms of skin without light at 1e-168.
    #[test]
    fn terms_without_light_have_scales_of_others() {
        let profiles = [0.6253105, 0.384913585, 0.241309824].map(|surface_albedo| {
            let parameterization = Parameterization::Mfp;
            let appearance = Appearance { surface_albedo, length: 1.0, parameterization, g: 0.0 };
            Model::QuantizedDiffusion.profile(&appearance, Configuration::Diffuse, 1.0).unwrap()
        });
        let sum = Sum::of_fits(Model::QuantizedDiffusion, &profiles).unwrap();
        for (_, weights, rates) in &sum.channels {
            assert!(weights[weights.len() - 1] > 0.0, "{weights:?}");
            assert!(weights.iter().all(|weight| *weight == 0.0 || *weight > LEAST_WEIGHT), "{weights:?}");
            assert!(rates.iter().all(|rate| (1e-3..1e3).contains(rate)), "{rates:?}");
        }
    }

    /// Largest errors that were found are 4.8 % for exponentials (quantized diffusion) and 2.8 % for Gaussians (dipole).
    #[test]
    fn sums_are_next_to_every_model() {
        let models = [Model::Dipole, Model::DirectionalDipole, Model::QuantizedDiffusion, Model::Exact];
        for model in models {
            let profiles = [0.0, 0.5, 0.99].map(|surface_albedo| {
                let parameterization = Parameterization::Mfp;
                let appearance = Appearance { surface_albedo, length: 0.3, parameterization, g: 0.0 };
                model.profile(&appearance, Configuration::Diffuse, 1.0).unwrap()
            });
            let sum = Sum::of_fits(model, &profiles).unwrap();
            for ((total, weights, widths), surface_albedo) in sum.channels.iter().zip([0.0, 0.5, 0.99]) {
                assert!((total - surface_albedo).abs() < 1e-9, "{}: {total}", model.name());
                assert_eq!([weights.len(), widths.len()], [sum.terms.count(); 2]);
                // The last takes what the others leave of 1, so it must not be empty
                assert!(weights[weights.len() - 1] > 0.0, "{} {surface_albedo}", model.name());
            }
            let percents = sum.comment.split("light ").nth(1).and_then(|rest| rest.split(" percent").next());
            for percent in percents.unwrap().split(", ") {
                assert!(percent.parse::<f64>().unwrap() < 5.0, "{}: {percent}", model.name());
            }
        }
    }
}
