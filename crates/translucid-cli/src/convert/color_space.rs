//! A material in the channels of another color space.

use clap::Args;
use translucid_laboratory::Cell;
use translucid_load::{LINEAR_SPACES, rgb_from_rgb};
use translucid_profile::convention::{Channel, MixedChannel};
use translucid_profile::{Configuration, ParameterError};

use super::output::Row;
use crate::failure::Failure;

/// Color spaces of the numbers.
#[derive(Args, Debug)]
pub(super) struct ColorSpaceArguments {
    /// Linear color space of the printed numbers [default: that of the material]
    #[arg(long, value_name = "SPACE")]
    color_space: Option<String>,
    /// Linear color space of the material's numbers
    #[arg(long, value_name = "SPACE", default_value = LINEAR_SPACES[0], requires = "color_space")]
    from_color_space: String,
}

/// A share of a channel's light.
type Share = fn(&MixedChannel) -> f64;

impl ColorSpaceArguments {
    /// The matrix from the material's channels to the printed ones, if they are others.
    pub(super) fn matrix(&self) -> Result<Option<[[f64; 3]; 3]>, Failure> {
        let Some(to) = &self.color_space else { return Ok(None) };
        for (option, name) in [("--color-space", to), ("--from-color-space", &self.from_color_space)] {
            if !LINEAR_SPACES.contains(&name.as_str()) {
                let known = LINEAR_SPACES.join(", ");
                let message = format!("{option} is \"{name}\", but must be one of {known}");
                return Err(Failure::input(message)
                    .with_help("lengths are no codes: decode a curve before, as that of sRGB"));
            }
        }
        if *to == self.from_color_space {
            // The product of a matrix and its inverse is not quite this
            return Ok(Some([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]));
        }
        Ok(rgb_from_rgb(&self.from_color_space, to))
    }

    /// The channels in the color space that is asked for, and how far each is from the light that it stands for, as rows.
    pub(super) fn mixed(
        &self,
        channels: &[Channel],
        matrix: &[[f64; 3]; 3],
        configuration: Configuration,
    ) -> Result<([MixedChannel; 3], Vec<Row>), Failure> {
        // One channel stands for three
        let channel = |i: usize| channels[i.min(channels.len() - 1)];
        let three = [channel(0), channel(1), channel(2)];
        let mixed = MixedChannel::of(&three, matrix, configuration).map_err(|error| self.refused(&error))?;
        let space = self.color_space.as_deref().unwrap_or_default();
        let row = |parameter: &str, c: usize, value: f64| -> Row {
            let words = ["color space", parameter, ["r", "g", "b"][c]].map(Cell::from);
            let [system, parameter, channel] = words;
            let source = format!("computed: light of Burley's profile at another radius, {space}");
            [
                system,
                parameter,
                channel,
                Cell::from(value),
                Cell::from(""),
                Cell::from(""),
                Cell::from(source),
            ]
        };
        let shares: [(&str, Share); 3] = [
            ("misplaced", |mixed| mixed.misplaced),
            ("misplaced if lengths were kept", |mixed| mixed.misplaced_if_kept),
            ("misplaced if lengths were colors", |mixed| mixed.misplaced_if_color),
        ];
        let mut rows = Vec::new();
        for (parameter, share) in shares {
            rows.extend(mixed.iter().enumerate().map(|(c, mixed)| row(parameter, c, share(mixed))));
        }
        Ok((mixed, rows))
    }

    /// A color or a length that the other space does not have.
    fn refused(&self, error: &ParameterError) -> Failure {
        let space = self.color_space.as_deref().unwrap_or_default();
        Failure::input(format!("in {space} {error}")).with_help(
            "the material's color is outside of that gamut, or its channels differ too much for a mixture of them",
        )
    }
}
