//! A conversion's change of color space: the mixed channels, and how far each is from the light that it stands for.

use super::{ArgumentNames, ConvertedNumber};
use crate::convention::{Channel, LINEAR_SPACES, MixedChannel, rgb_from_rgb};
use crate::{Configuration, InputError, nearest};

/// Linear color spaces of a material's channels, before and after, by their names in [`LINEAR_SPACES`].
#[derive(Clone, Copy, Debug)]
pub struct ColorSpaces<'a> {
    /// Space of the numbers that the material comes from.
    pub from: &'a str,
    /// Space of the numbers that it goes to.
    pub to: &'a str,
}

/// A share of a channel's light.
type Share = fn(&MixedChannel) -> f64;

impl ColorSpaces<'_> {
    /// The matrix from the old channels to the new ones.
    ///
    /// # Errors
    /// A name is not known.
    pub fn matrix(&self, names: &ArgumentNames) -> Result<[[f64; 3]; 3], InputError> {
        for (argument, name) in [(names.color_space, self.to), (names.from_color_space, self.from)] {
            if !LINEAR_SPACES.contains(&name) {
                let known = LINEAR_SPACES.join(", ");
                let message = format!("{argument} is \"{name}\", but must be one of {known}");
                let meant = meant(name).map_or(String::new(), |near| format!("did you mean {near}? "));
                return Err(InputError::new(message).with_help(format!(
                    "{meant}Numbers are linear: decode a curve, as that of sRGB, before"
                )));
            }
        }
        rgb_from_rgb(self.from, self.to).ok_or_else(|| InputError::new("the color space is not known"))
    }

    /// The channels in the new space, and the shares of their light that are misplaced.
    pub(super) fn mix(
        &self,
        channels: &[Channel],
        configuration: Configuration,
        names: &ArgumentNames,
    ) -> Result<(Vec<Channel>, Vec<ConvertedNumber>), InputError> {
        let matrix = self.matrix(names)?;
        // One channel stands for three
        let three = [0, 1, 2].map(|i: usize| channels[i.min(channels.len() - 1)]);
        let mixed = MixedChannel::of(&three, &matrix, configuration).map_err(|error| {
            InputError::new(format!("in {} {error}", self.to)).with_help(
                "the material's color is outside of that gamut, or its channels differ too much for a mixture of them",
            )
        })?;
        let source = format!("computed: light of Burley's profile at another radius, {}", self.to);
        let shares: [(&str, Share); 3] = [
            ("misplaced", |mixed| mixed.misplaced),
            ("misplaced if lengths were kept", |mixed| mixed.misplaced_if_kept),
            ("misplaced if lengths were colors", |mixed| mixed.misplaced_if_color),
        ];
        let rows = shares.map(|(parameter, share)| {
            ConvertedNumber::computed("color space", parameter, &mixed.each_ref().map(share), &source)
        });
        Ok((mixed.map(|mixed| mixed.channel).to_vec(), rows.concat()))
    }
}

/// The space that a name may have meant.
fn meant(name: &str) -> Option<&'static str> {
    let name: String = name.to_lowercase().chars().filter(char::is_ascii_alphanumeric).take(40).collect();
    let words = ["rec709", "aces", "p3", "2020", "adobe"];
    let by_word = words.iter().zip(LINEAR_SPACES).find(|(word, _)| name.contains(*word));
    if let Some((_, space)) = by_word {
        return Some(space);
    }
    if name.contains("srgb") || name.contains("709") || name == "linear" {
        return Some(LINEAR_SPACES[0]);
    }
    nearest(&name, LINEAR_SPACES)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meant_finds_the_linear_space_of_a_name() {
        for (name, space) in [
            ("sRGB", "lin_rec709"),
            ("srgb_texture", "lin_rec709"),
            ("lin_rec709_scene", "lin_rec709"),
            ("ACES2065-1", "acescg"),
            ("acescgg", "acescg"),
            ("srgb_displayp3", "lin_displayp3"),
            ("Rec.2020", "lin_rec2020"),
            ("Adobe RGB (1998)", "lin_adobergb"),
        ] {
            assert_eq!(meant(name), Some(space), "{name}");
        }
        assert_eq!(meant(""), None);
        assert_eq!(meant("xyz"), None);
    }
}
