//! The color space of a material's numbers.

use clap::Args;
use translucid_profile::convention::{ColorSpaces, LINEAR_SPACES};

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

impl ColorSpaceArguments {
    /// Both spaces, if one is asked for.
    pub(super) fn spaces(&self) -> Option<ColorSpaces<'_>> {
        let to = self.color_space.as_deref()?;
        Some(ColorSpaces { from: &self.from_color_space, to })
    }
}
