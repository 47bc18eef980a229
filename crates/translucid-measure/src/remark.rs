//! Remarks on a measurement, in words.

/// A remark on a measurement that goes on.
///
/// In remarks and errors the names of [options](crate::Options) stand between backticks, for [`spelled`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Remark {
    /// Something that was found or chosen on the way.
    Finding(String),
    /// Something worth knowing that needs no action.
    Note(String),
    /// Something that limits the measurement.
    Warning(String),
}

impl Remark {
    /// The words.
    pub fn text(&self) -> &str {
        match self {
            Self::Finding(text) | Self::Note(text) | Self::Warning(text) => text,
        }
    }
}

/// Names of the channels.
pub const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// Names that stand between backticks.
const NAMES: [&str; 24] = [
    "card",
    "center",
    "configuration",
    "dark",
    "edge",
    "eta",
    "exposure",
    "fit",
    "g",
    "incidence",
    "material",
    "mm_per_pixel",
    "region",
    "ruler",
    "scene",
    "seed",
    "setup",
    "spp",
    "surface_albedo",
    "thickness",
    "white",
    "white_photo",
    "white_reflectance",
    "white_tolerance",
];

/// A text in which the name of each option is spelled as the caller does: `--mm-per-pixel` for a command.
///
/// ```
/// let text = "the scale is missing: `mm_per_pixel` or `ruler`";
/// let option = |name: &str| format!("--{}", name.replace('_', "-"));
/// assert_eq!(translucid_measure::spelled(text, option), "the scale is missing: --mm-per-pixel or --ruler");
/// ```
pub fn spelled(text: &str, spelling: impl Fn(&str) -> String) -> String {
    let spell = |text: String, name: &&str| text.replace(&format!("`{name}`"), &spelling(name));
    NAMES.iter().fold(text.to_owned(), spell)
}

/// A number with three significant digits.
pub fn three_digits(value: f64) -> String {
    let rounded = format!("{value:.2e}").parse().unwrap_or(value);
    let magnitude = f64::abs(rounded);
    if magnitude != 0.0 && !(1e-5..1e16).contains(&magnitude) {
        format!("{rounded:e}")
    } else {
        format!("{rounded}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        let cases =
            [(0.0, "0"), (1.0, "1"), (0.123_45, "0.123"), (1_234_567.0, "1230000"), (1.2345e-7, "1.23e-7")];
        for (value, text) in
            cases.into_iter().chain([(-0.5, "-0.5"), (1.2345e20, "1.23e20"), (f64::NAN, "NaN")])
        {
            assert_eq!(three_digits(value), text);
        }
    }
}
