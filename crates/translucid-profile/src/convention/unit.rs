//! Length units of scenes.

/// Length unit of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Unit {
    /// Millimeters.
    #[default]
    Millimeter,
    /// Centimeters.
    Centimeter,
    /// Meters.
    Meter,
}

impl Unit {
    /// Every unit by its name, in the order of the variants.
    pub const WORDS: [(&str, Self); 3] =
        [("mm", Self::Millimeter), ("cm", Self::Centimeter), ("m", Self::Meter)];

    /// The unit that scene files and the command line call `name`.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(word, _)| *word == name).map(|&(_, unit)| unit)
    }

    /// Millimeters in one unit.
    pub fn in_millimeters(self) -> f64 {
        match self {
            Self::Millimeter => 1.0,
            Self::Centimeter => 10.0,
            Self::Meter => 1000.0,
        }
    }

    /// The unit in a sentence: "meters".
    pub fn plural(self) -> &'static str {
        match self {
            Self::Millimeter => "millimeters",
            Self::Centimeter => "centimeters",
            Self::Meter => "meters",
        }
    }

    /// The unit's abbreviation as scene files and the command line write it.
    pub fn name(self) -> &'static str {
        Self::WORDS[self as usize].0
    }
}
