//! Named numbers that a shape is made from.

use std::collections::BTreeMap;

use translucid_scene::SceneError;

/// Meaning of a parameter's number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShapeParameterKind {
    /// A length in the scene's unit \[L\].
    Length,
    /// A whole number.
    Count,
    /// A number without unit.
    Ratio,
}

/// A parameter that a shape understands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeParameter {
    /// Name as scene files write it.
    pub name: &'static str,
    /// Kind of number.
    pub kind: ShapeParameterKind,
    /// Value when it is not given.
    pub default: f64,
    /// Least value allowed.
    pub min: f64,
    /// Greatest value allowed.
    pub max: f64,
}

/// Least length that a shape accepts \[L\].
const LENGTH_MIN: f64 = 1e-4;
/// Greatest length that a shape accepts \[L\].
const LENGTH_MAX: f64 = 1e6;

impl ShapeParameter {
    /// A positive length.
    pub(super) const fn length(name: &'static str, default: f64) -> Self {
        Self { name, kind: ShapeParameterKind::Length, default, min: LENGTH_MIN, max: LENGTH_MAX }
    }

    /// A length that may be zero.
    pub(super) const fn length_or_zero(name: &'static str, default: f64) -> Self {
        Self { min: 0.0, ..Self::length(name, default) }
    }

    /// A whole number in `[min, max]`.
    pub(super) const fn count(name: &'static str, default: f64, min: f64, max: f64) -> Self {
        Self { name, kind: ShapeParameterKind::Count, default, min, max }
    }

    /// A ratio in `[min, max]`.
    pub(super) const fn ratio(name: &'static str, default: f64, min: f64, max: f64) -> Self {
        Self { name, kind: ShapeParameterKind::Ratio, default, min, max }
    }

    /// Checks a value against kind and range.
    ///
    /// # Errors
    /// The value is not finite, out of range, or not whole where a whole number is needed.
    pub fn check(&self, value: f64) -> Result<(), SceneError> {
        let Self { name, min, max, .. } = self;
        if !(*min..=*max).contains(&value) {
            return Err(SceneError::new(format!("{name} is {value}, but must be in [{min}, {max}]")));
        }
        if self.kind == ShapeParameterKind::Count && value.fract() != 0.0 {
            return Err(SceneError::new(format!("{name} is {value}, but must be a whole number")));
        }
        Ok(())
    }
}

/// Values given for a shape's parameters; what is not given has its default.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ShapeParameters {
    values: BTreeMap<String, f64>,
}

impl ShapeParameters {
    /// All defaults.
    pub fn new() -> Self {
        Self::default()
    }

    /// Sets a value; `build_shape` checks it.
    pub fn set(&mut self, name: impl Into<String>, value: f64) {
        self.values.insert(name.into(), value);
    }

    /// These parameters with one more value.
    #[must_use]
    pub fn with(mut self, name: impl Into<String>, value: f64) -> Self {
        self.set(name, value);
        self
    }

    /// The values given, by name.
    pub fn iter(&self) -> impl Iterator<Item = (&str, f64)> {
        self.values.iter().map(|(name, &value)| (name.as_str(), value))
    }

    /// Checks every value against a shape's list and fills in the defaults.
    pub(super) fn resolve(
        &self,
        shape: &str,
        known: &'static [ShapeParameter],
    ) -> Result<Values, SceneError> {
        for (name, value) in self.iter() {
            let parameter = known.iter().find(|parameter| parameter.name == name);
            parameter.ok_or_else(|| unknown_parameter(shape, name, known))?.check(value)?;
        }
        Ok(Values { known, given: self.values.clone() })
    }
}

fn unknown_parameter(shape: &str, name: &str, known: &[ShapeParameter]) -> SceneError {
    let names: Vec<&str> = known.iter().map(|parameter| parameter.name).collect();
    SceneError::new(format!("shape \"{shape}\" has no parameter \"{name}\""))
        .with_help(format!("it has {}", names.join(", ")))
}

/// A shape's parameters, checked and complete.
pub(super) struct Values {
    known: &'static [ShapeParameter],
    given: BTreeMap<String, f64>,
}

impl Values {
    /// A parameter that the shape lists; one that it does not list is a broken promise of this module.
    pub(super) fn get(&self, name: &str) -> f32 {
        let default =
            || self.known.iter().find(|parameter| parameter.name == name).map(|parameter| parameter.default);
        let value = self.given.get(name).copied().or_else(default);
        debug_assert!(value.is_some(), "shape reads the parameter {name}, which it does not list");
        value.unwrap_or(1.0) as f32
    }

    /// A whole number.
    pub(super) fn count(&self, name: &str) -> usize {
        self.get(name) as usize
    }
}
