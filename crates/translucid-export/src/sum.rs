//! Sums of exponentials or Gaussians for the channels of a material, as functions that return their terms.
//!
//! Gaussians are a model of their own. Exponentials stand for any model that is no closed form: fitted to its profile by
//! least squares, with what they miss of it.

use translucid_fit::{Exponential, Mixture, fit, l1_error};
use translucid_profile::{Model, ParameterError, Profile, SumOfGaussians};

use crate::number::literal;

/// Number of exponentials.
const EXPONENTIALS: usize = 4;

/// A sum for each channel.
pub(crate) struct Sum {
    /// Struct of the terms, and the function that returns them.
    names: [&'static str; 2],
    /// What it is, as a comment.
    comment: String,
    /// Surface albedo, weights, and rates or deviations of red, green, blue.
    channels: [(f64, Vec<f64>, Vec<f64>); 3],
}

/// Exponentials next to a profile \[L\]; without light, one of the profile's width.
///
/// # Errors
/// As [`fit`].
pub fn exponentials(profile: &dyn Profile) -> Result<Mixture<Exponential>, ParameterError> {
    if profile.surface_albedo() == 0.0 {
        let none = (0.0, profile.scale());
        return Mixture::new(0.0, &[none, none, none, (1.0, profile.scale())]);
    }
    let fits = fit::<Exponential>(profile, EXPONENTIALS)?;
    // There are as many fits as terms
    let last = fits.into_iter().last();
    last.map(|fit| fit.mixture).ok_or(ParameterError::new("terms", 0.0, "at least 1"))
}

impl Sum {
    pub(crate) fn of_exponentials(
        model: Model,
        profiles: &[Box<dyn Profile>; 3],
    ) -> Result<Self, ParameterError> {
        let mut channels: [(f64, Vec<f64>, Vec<f64>); 3] = Default::default();
        let mut errors = [0.0; 3];
        for c in 0..3 {
            let mixture = exponentials(&*profiles[c])?;
            if profiles[c].surface_albedo() > 0.0 {
                errors[c] = 100.0 * l1_error(&mixture, &*profiles[c], f64::INFINITY);
            }
            let rates = mixture.scales().iter().map(|scale| 1.0 / scale).collect();
            channels[c] = (profiles[c].surface_albedo(), mixture.weights().to_vec(), rates);
        }
        let [red, green, blue] = errors;
        let comment = format!(
            "// The exponentials of a channel, 0 for red, 1 for green, 2 for blue: the least squares fit to {}.
// Of the light {red:.2}, {green:.2}, {blue:.2} percent is not where that profile has it.",
            model.name()
        );
        Ok(Self { names: ["Exponentials", "exponentials_of_channel"], comment, channels })
    }

    pub(crate) fn of_gaussians(profiles: [SumOfGaussians; 3]) -> Self {
        let channels = profiles
            .map(|sum| (sum.surface_albedo(), sum.weights().to_vec(), sum.standard_deviations().to_vec()));
        let comment = String::from("// The Gaussians of a channel, 0 for red, 1 for green, 2 for blue.");
        Self { names: ["Gaussians", "gaussians_of_channel"], comment, channels }
    }

    /// The function in WGSL.
    pub(crate) fn wgsl(&self) -> String {
        let [structure, function] = self.names;
        let width = if structure == "Gaussians" { "deviation" } else { "rate" };
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
            "\n{comment}\nfn {function}(channel: f32) -> {structure} {{
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

    #[test]
    fn exponentials_are_next_to_every_model() {
        for model in Model::ALL {
            for surface_albedo in [0.0, 0.01, 0.5, 0.99] {
                let parameterization = Parameterization::Mfp;
                let appearance = Appearance { surface_albedo, length: 0.3, parameterization, g: 0.0 };
                let Ok(profile) = model.profile(&appearance, Configuration::Diffuse, 1.0) else {
                    continue;
                };
                let mixture = exponentials(&*profile).unwrap();
                assert_eq!(mixture.weights().len(), EXPONENTIALS);
                // The last takes what the others leave of 1, so it must not be empty
                assert!(mixture.weights()[EXPONENTIALS - 1] > 0.0, "{} {surface_albedo}", model.name());
                if surface_albedo > 0.0 {
                    let error = l1_error(&mixture, &*profile, f64::INFINITY);
                    assert!(error < 0.2, "{} {surface_albedo}: {error}", model.name());
                }
            }
        }
    }
}
