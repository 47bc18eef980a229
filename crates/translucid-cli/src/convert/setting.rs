//! SYSTEM:PARAMETER=VALUE, as an option gives it.

use translucid_profile::convention::{Parameter, Role, System};

use super::names;
use crate::failure::Failure;

/// One parameter of one system with one value or three.
#[derive(Debug)]
pub(super) struct Setting {
    pub(super) system: String,
    parameter: String,
    pub(super) values: Vec<f64>,
}

impl Setting {
    /// Parses the values of an option, each for another parameter.
    pub(super) fn parse_all(option: &str, texts: &[String]) -> Result<Vec<Self>, Failure> {
        let mut settings: Vec<Self> = Vec::new();
        for text in texts {
            let setting = Self::parse(option, text)?;
            if settings.iter().any(|other| other.system == setting.system && other.names(&setting.parameter))
            {
                let Self { system, parameter, .. } = setting;
                return Err(Failure::input(format!("{option} gives {system}:{parameter} twice")));
            }
            settings.push(setting);
        }
        Ok(settings)
    }

    fn parse(option: &str, text: &str) -> Result<Self, Failure> {
        let parts = text.split_once(':').and_then(|(system, rest)| {
            let (parameter, values) = rest.split_once('=')?;
            Some((system.trim(), parameter.trim(), values))
        });
        let Some((system, parameter, values)) = parts else {
            return Err(Failure::input(format!(
                "{option} is \"{text}\", but must be SYSTEM:PARAMETER=VALUE"
            ))
            .with_help(format!(
                "for example renderman:dmfp=2; the systems are {}",
                names::all().join(", ")
            )));
        };
        names::systems(option, system)?;
        let numbers: Result<Vec<f64>, _> = values.split(',').map(|number| number.trim().parse()).collect();
        match numbers {
            Ok(values) if matches!(values.len(), 1 | 3) => {
                Ok(Self { system: system.to_owned(), parameter: parameter.to_owned(), values })
            }
            _ => Err(Failure::input(format!(
                "{option} {system}:{parameter} is \"{values}\", but must be a number, or three with commas between"
            ))),
        }
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

    /// The parameter that is meant, of a system among those given, which takes that many values.
    pub(super) fn resolve(&self, option: &str, systems: &[&System]) -> Result<&'static Parameter, Failure> {
        let Self { system, parameter, .. } = self;
        let mut known = Vec::new();
        for candidate in systems.iter().filter(|candidate| candidate.name == system) {
            for found in candidate.parameters {
                if self.is_of(found) {
                    return self.with_right_count(option, found);
                }
                known.push(found.name);
            }
        }
        if known.is_empty() {
            let message = format!("{option} names the system {system}, which --to leaves out");
            return Err(Failure::input(message));
        }
        known.dedup();
        Err(Failure::input(format!("{option} names \"{parameter}\", which is no parameter of {system}"))
            .with_help(names::advice(parameter, &known)))
    }

    fn with_right_count(
        &self,
        option: &str,
        found: &'static Parameter,
    ) -> Result<&'static Parameter, Failure> {
        let count = self.values.len();
        if count > 1 && !found.role.is_per_channel() {
            let (system, name) = (&self.system, found.name);
            let message = format!("{option} {system}:{name} has {count} values, but is one for all channels");
            return Err(Failure::input(message));
        }
        Ok(found)
    }
}

/// The system that the settings tell a material, in the way that their parameters say.
pub(super) fn source(settings: &[Setting]) -> Result<&'static System, Failure> {
    let first = &settings[0];
    if let Some(other) = settings.iter().find(|setting| setting.system != first.system) {
        let message = format!("--from names two systems, {} and {}", first.system, other.system);
        return Err(Failure::input(message).with_help("a material comes from one; choose others with --to"));
    }
    let ways = names::systems("--from", &first.system)?;
    for setting in settings {
        setting.resolve("--from", &ways)?;
    }
    let has = |system: &System, parameter: &Parameter| {
        system.parameters.contains(parameter) && settings.iter().any(|setting| setting.is_of(parameter))
    };
    for way in &ways {
        let knows_all = settings.iter().all(|s| way.parameters.iter().any(|parameter| s.is_of(parameter)));
        let is_length = |p: &&Parameter| matches!(p.role, Role::Length | Role::Distance);
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
    Err(Failure::input(format!("--from does not say a length, or both coefficients, of {name}"))
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
        let setting = Setting::parse("--from", "renderman:subsurface-DmfpColor=1, 0.5,0.2").unwrap();
        assert!(setting.names("dmfpColor") && !setting.names("dmfp"));
        assert_eq!(setting.values, [1.0, 0.5, 0.2]);
        assert_eq!(setting.value(2), 0.2);
    }

    #[test]
    fn parse_refuses_what_is_no_setting() {
        for text in ["", "renderman", "renderman:dmfp", "renderman:dmfp=", "renderman:dmfp=1,2", "maya:x=1"] {
            assert!(Setting::parse("--from", text).is_err(), "{text}");
        }
    }
}
