//! Parameters of systems with their values.

use super::ArgumentNames;
use super::names::{advice, systems};
use crate::InputError;
use crate::convention::{Parameter, Role, System};

/// One parameter of one system with one value or three.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    pub(super) system: String,
    parameter: String,
    pub(super) values: Vec<f64>,
}

impl Setting {
    /// Makes the setting of a system's parameter, for all channels or for red, green and blue; `argument` is what messages
    /// call the caller's argument that it comes from.
    ///
    /// # Errors
    /// The system is not known, or the values are not one or three.
    pub fn new(argument: &str, system: &str, parameter: &str, values: Vec<f64>) -> Result<Self, InputError> {
        systems(argument, system)?;
        if !matches!(values.len(), 1 | 3) {
            let count = values.len();
            let message =
                format!("{argument} {system}:{parameter} has {count} values, but must have one or three");
            return Err(InputError::new(message));
        }
        Ok(Self { system: system.to_owned(), parameter: parameter.to_owned(), values })
    }

    /// Refuses two settings of one parameter.
    pub(super) fn require_different(argument: &str, settings: &[Self]) -> Result<(), InputError> {
        for (i, setting) in settings.iter().enumerate() {
            let is_same = |other: &Self| other.system == setting.system && other.names(&setting.parameter);
            if settings[..i].iter().any(is_same) {
                let Self { system, parameter, .. } = setting;
                return Err(InputError::new(format!("{argument} gives {system}:{parameter} twice")));
            }
        }
        Ok(())
    }

    /// Whether this is a parameter's name, written as the system or as one would say it.
    pub(super) fn names(&self, parameter: &str) -> bool {
        plain(&self.parameter) == plain(parameter)
    }

    /// Whether this is the parameter, within its system.
    pub(super) fn is_of(&self, parameter: &Parameter) -> bool {
        self.names(parameter.name)
    }

    /// The value in a channel.
    pub(super) fn value(&self, channel: usize) -> f64 {
        self.values.get(channel).copied().unwrap_or(self.values[0])
    }

    /// The parameter that is meant, of the system among those given, which takes that many values.
    pub(super) fn resolve(
        &self,
        argument: &str,
        systems: &[&System],
    ) -> Result<&'static Parameter, InputError> {
        let Self { system, parameter, .. } = self;
        let mut known = Vec::new();
        for candidate in systems.iter().filter(|candidate| candidate.name == system) {
            for found in candidate.parameters {
                if self.is_of(found) {
                    return self.with_right_count(argument, found);
                }
                known.push(found.name);
            }
        }
        known.dedup();
        Err(InputError::new(format!("{argument} names \"{parameter}\", which is no parameter of {system}"))
            .with_help(advice(parameter, &known)))
    }

    fn with_right_count(
        &self,
        argument: &str,
        found: &'static Parameter,
    ) -> Result<&'static Parameter, InputError> {
        let count = self.values.len();
        if count > 1 && !found.role.is_per_channel() {
            let (system, name) = (&self.system, found.name);
            let message =
                format!("{argument} {system}:{name} has {count} values, but is one for all channels");
            return Err(InputError::new(message));
        }
        Ok(found)
    }
}

/// The system that the settings tell a material, in the way that their parameters say.
pub(super) fn source(names: &ArgumentNames, settings: &[Setting]) -> Result<&'static System, InputError> {
    let ArgumentNames { from, to, .. } = *names;
    let Some(first) = settings.first() else {
        return Err(InputError::new(format!("{from} is missing")));
    };
    if let Some(other) = settings.iter().find(|setting| setting.system != first.system) {
        let message = format!("{from} names two systems, {} and {}", first.system, other.system);
        return Err(
            InputError::new(message).with_help(format!("a material comes from one; choose others with {to}"))
        );
    }
    let ways = systems(from, &first.system)?;
    for setting in settings {
        setting.resolve(from, &ways)?;
    }
    let has = |system: &System, parameter: &Parameter| {
        system.parameters.contains(parameter) && settings.iter().any(|setting| setting.is_of(parameter))
    };
    for way in &ways {
        let knows_all = settings.iter().all(|s| way.parameters.iter().any(|parameter| s.is_of(parameter)));
        let is_length = |p: &&Parameter| p.role.is_of_length();
        let is_coefficient = |p: &&Parameter| matches!(p.role, Role::Absorption | Role::Scattering);
        let has_length = way.parameters.iter().filter(is_length).any(|p| has(way, p));
        let has_coefficients =
            way.has_coefficients() && way.parameters.iter().filter(is_coefficient).all(|p| has(way, p));
        if knows_all && (has_length || has_coefficients) {
            return Ok(way);
        }
    }
    let name = &first.system;
    let all: Vec<String> = ways
        .iter()
        .map(|way| way.parameters.iter().map(|parameter| parameter.name).collect::<Vec<_>>().join(", "))
        .collect();
    Err(InputError::new(format!("{from} does not say a length, or both coefficients, of {name}"))
        .with_help(format!("{name} takes {}", all.join("; or "))))
}

/// A name without case, separators and the word that half of the systems put before it.
fn plain(name: &str) -> String {
    let name = name.to_lowercase().replace(['_', '-', ' '], "");
    name.strip_prefix("subsurface").map_or(name.clone(), str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_forgives_case_separators_and_prefix() {
        let setting = Setting::new("from", "renderman", "subsurface-DmfpColor", vec![1.0, 0.5, 0.2]).unwrap();
        assert!(setting.names("dmfpColor") && !setting.names("dmfp"));
        assert_eq!(setting.values, [1.0, 0.5, 0.2]);
        assert_eq!(setting.value(2), 0.2);
    }

    #[test]
    fn new_refuses_what_is_no_setting() {
        for (system, values) in
            [("", vec![1.0]), ("maya", vec![1.0]), ("renderman", vec![]), ("renderman", vec![1.0; 2])]
        {
            assert!(Setting::new("from", system, "dmfp", values).is_err(), "{system}");
        }
    }
}
