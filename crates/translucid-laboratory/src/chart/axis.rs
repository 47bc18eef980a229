//! An axis of a chart.

/// Spacing of numbers along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Equal differences have equal lengths.
    Linear,
    /// Equal ratios have equal lengths; only positive numbers have a place.
    Logarithmic,
}

/// An axis: what it shows, in which unit, how and from where to where.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The quantity, as "r".
    pub label: String,
    /// Its unit, as "ℓ", or empty for a pure number.
    pub unit: String,
    /// Spacing of numbers.
    pub scale: Scale,
    /// The least and greatest number shown; the range of the data if there is none.
    ///
    /// For a range that the axis cannot show (not rising, not finite, not positive on a logarithmic axis) the range of
    /// the data is taken.
    pub range: Option<[f64; 2]>,
}

impl Axis {
    /// A linear axis over the range of the data.
    pub fn linear(label: &str, unit: &str) -> Self {
        Self { label: label.to_owned(), unit: unit.to_owned(), scale: Scale::Linear, range: None }
    }

    /// A logarithmic axis over the range of the data.
    pub fn logarithmic(label: &str, unit: &str) -> Self {
        Self { scale: Scale::Logarithmic, ..Self::linear(label, unit) }
    }

    /// The axis from `low` to `high`.
    #[must_use]
    pub fn between(self, low: f64, high: f64) -> Self {
        Self { range: Some([low, high]), ..self }
    }

    /// Label and unit as they stand beside the axis: the quantity over its unit is a number.
    ///
    /// ```
    /// # use translucid_laboratory::Axis;
    /// assert_eq!(Axis::linear("r", "ℓ").caption(), "r / ℓ");
    /// assert_eq!(Axis::linear("cdf", "").caption(), "cdf");
    /// ```
    pub fn caption(&self) -> String {
        if self.unit.is_empty() { self.label.clone() } else { format!("{} / {}", self.label, self.unit) }
    }

    /// Returns whether a number has a place on the axis.
    ///
    /// Numbers beyond [`Self::GREATEST`] have none: differences of them are not finite.
    pub(crate) fn has(&self, value: f64) -> bool {
        value.abs() <= Self::GREATEST && (self.scale == Scale::Linear || value >= 1.0 / Self::GREATEST)
    }

    /// Greatest number with a place on an axis.
    pub(crate) const GREATEST: f64 = 1e300;
}
