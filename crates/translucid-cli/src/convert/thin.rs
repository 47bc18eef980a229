//! The thin wall that stands for a slab, and the slab of a thin wall.

use clap::Args;
use translucid_laboratory::stack::{thin_wall_numbers, wall_slab_numbers};
use translucid_profile::ParameterError;
use translucid_profile::convention::{Channel, Converted};

use crate::failure::Failure;

/// The slab.
#[derive(Args, Debug)]
pub(super) struct ThinArguments {
    /// Thickness of a slab, in --unit: prints the thin-walled surface that stands for it, in place of the systems' numbers
    #[arg(long, value_name = "THICKNESS", allow_negative_numbers = true, conflicts_with_all = ["to", "set", "to_unit"])]
    thin: Option<f64>,
    /// Color of a thin-walled surface, one or three: prints the slab that has its light, of the thickness of --thin if there is one
    #[arg(long, value_name = "C", value_delimiter = ',', allow_negative_numbers = true, requires = "wall_balance",
        conflicts_with_all = ["from", "surface_albedo", "color_space", "to", "set", "to_unit"])]
    wall_color: Vec<f64>,
    /// Share of the surface's light that goes to the other side, in (0, 1], one or three
    #[arg(
        long,
        value_name = "SHARE",
        value_delimiter = ',',
        allow_negative_numbers = true,
        requires = "wall_color"
    )]
    wall_balance: Vec<f64>,
    /// Mean cosine of the slab's phase function, in [-0.95, 0.95] [default: 0]
    #[arg(long, allow_negative_numbers = true)]
    g: Option<f64>,
    /// Index of refraction of the slab, in [1, 3] [default: 1]
    #[arg(long, allow_negative_numbers = true)]
    eta: Option<f64>,
}

impl ThinArguments {
    /// Checks that there is a slab where there is something of one.
    pub(super) fn require_slab(&self) -> Result<(), Failure> {
        let given = [("--g", self.g), ("--eta", self.eta)].into_iter().find(|(_, value)| value.is_some());
        match given {
            Some((option, _)) if self.thin.is_none() && !self.is_of_wall() => {
                Err(Failure::input(format!("{option} is that of a slab, but there is none"))
                    .with_help("give --thin, or --wall-color with --wall-balance"))
            }
            _ => Ok(()),
        }
    }

    /// Returns whether the slab of a thin wall is asked for.
    pub(super) fn is_of_wall(&self) -> bool {
        !self.wall_color.is_empty()
    }

    /// Returns whether a thin wall is asked for.
    pub(super) fn is_asked(&self) -> bool {
        self.thin.is_some()
    }

    /// The slab and the walls, for channels with lengths in the unit of the thickness.
    pub(super) fn walls(&self, channels: &[Channel]) -> Result<Converted, Failure> {
        let (g, eta) = self.medium();
        let thickness = self.thin.unwrap_or_default();
        thin_wall_numbers(channels, thickness, g, eta).map_err(|error| in_options(&error))
    }

    /// The slab of the wall.
    pub(super) fn slab(&self) -> Result<Converted, Failure> {
        let (g, eta) = self.medium();
        wall_slab_numbers(&self.wall_color, &self.wall_balance, self.thin, g, eta)
            .map_err(|error| in_options(&error))
    }

    fn medium(&self) -> (f64, f64) {
        (self.g.unwrap_or(0.0), self.eta.unwrap_or(1.0))
    }
}

/// An error of the slab in the words of the command.
fn in_options(error: &ParameterError) -> Failure {
    let option = match error.parameter {
        "thickness" => "--thin",
        "g" => "--g",
        "eta" => "--eta",
        "color" => "--wall-color",
        "balance" => "--wall-balance",
        _ => return Failure::input(format!("the slab cannot be solved: {error}")),
    };
    Failure::input(error.to_string().replacen(error.parameter, option, 1))
}
