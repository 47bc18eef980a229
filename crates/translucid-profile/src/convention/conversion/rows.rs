//! A material as the numbers of one system.

use super::setting::Setting;
use crate::convention::{Channel, Equal, Parameter, Role, System, Unit, Written as Number};
use crate::short::Short;
use crate::{Configuration, ParameterError};

/// One number of one system, or one that was computed beside those.
#[derive(Clone, Debug)]
pub struct ConvertedNumber {
    /// Name of the system, or of what else the number is about.
    pub system: &'static str,
    /// The way to specify a material in the system, if it is one that materials are converted between.
    pub way: Option<&'static System>,
    /// Name of the parameter in the system.
    pub parameter: &'static str,
    /// "all", or "r", "g", "b".
    pub channel: &'static str,
    /// The number.
    pub value: f64,
    /// Its unit, with the factors that the system multiplies it by; empty for numbers without one.
    pub unit: String,
    /// Quantity that the conversion keeps: "surface_albedo", "d" or "mfp"; empty for other numbers.
    pub equal: &'static str,
    /// Kind of the source and its place, with a colon between.
    pub source: String,
}

impl ConvertedNumber {
    /// Numbers without a unit that no system's rule gives, one for all channels, or one for each.
    pub fn computed(
        system: &'static str,
        parameter: &'static str,
        values: &[f64],
        source: &str,
    ) -> Vec<Self> {
        let number = |(i, &value): (usize, &f64)| Self {
            system,
            way: None,
            parameter,
            channel: channel_name(i, values.len()),
            value,
            unit: String::new(),
            equal: "",
            source: source.to_owned(),
        };
        values.iter().enumerate().map(number).collect()
    }

    /// Returns whether it is the surface albedo, which all ways of a system share.
    pub(super) fn is_albedo(&self) -> bool {
        self.equal == "surface_albedo"
    }
}

/// The numbers of a system, for channels with lengths in millimeters, and a note if it will not use them as they are.
pub(super) fn write(
    system: &'static System,
    channels: &[Channel],
    settings: &[Setting],
    scene: Unit,
    configuration: Configuration,
) -> Result<(Vec<ConvertedNumber>, Option<String>), ParameterError> {
    // Convert every channel
    let given = |parameter: &Parameter| {
        settings.iter().find(|setting| setting.system == system.name && setting.is_of(parameter))
    };
    let values: Vec<f64> = system
        .parameters
        .iter()
        .map(|p| given(p).map_or(p.role.default(), |setting| setting.value(0)))
        .collect();
    let millimeters = system.unit.unwrap_or(scene).in_millimeters();
    let written: Vec<Number> = channels
        .iter()
        .map(|channel| system.write(&channel.in_unit(1.0 / millimeters)?, &values, configuration))
        .collect::<Result<_, _>>()?;

    // Let the distance be the greatest length, where there is one that nobody has chosen
    let lengths: Vec<f64> =
        written.iter().map(|w| if let Number::Length(l) = w { *l } else { 0.0 }).collect();
    let has_distance = system.parameters.iter().any(|p| p.role == Role::Distance);
    let chosen = system.parameters.iter().find(|p| p.role == Role::Distance).and_then(given);
    let greatest = lengths.iter().copied().fold(0.0, f64::max);
    // A color of e^(−300) still has all its digits
    let has_attenuation = system.parameters.iter().any(|p| p.role == Role::Attenuation);
    let least = lengths.iter().copied().filter(|length| *length > 0.0).fold(f64::INFINITY, f64::min);
    let greatest = if has_attenuation { greatest.min(300.0 * least) } else { greatest };
    let distance = if has_distance { chosen.map_or(greatest, |setting| setting.value(0)) } else { 1.0 };

    // Print every parameter, the surface albedo first
    let mut rows = Vec::new();
    let mut push = |parameter, channel, value, unit: &str, equal| {
        rows.push(ConvertedNumber {
            system: system.name,
            way: Some(system),
            parameter,
            channel,
            value,
            unit: unit.to_owned(),
            equal,
            source: format!("{}: {}", system.source.kind, system.source.place),
        });
    };
    if let Some(name) = system.albedo_name {
        for (i, channel) in channels.iter().enumerate() {
            let own = system.own_albedo(channel.albedo(), &values)?.of_channel();
            push(name, channel_name(i, channels.len()), own, "", "surface_albedo");
        }
    }
    let equal = match system.equal() {
        Equal::Width => "d",
        Equal::MeanFreePath => "mfp",
    };
    let unit = unit_name(system, scene);
    for (parameter, &value) in system.parameters.iter().zip(&values) {
        let length_unit = if has_distance { "" } else { unit.as_str() };
        match parameter.role {
            Role::Distance => push(parameter.name, "all", distance, &unit, equal),
            Role::Factor { .. } | Role::Setting { .. } => push(parameter.name, "all", value, "", equal),
            Role::Filter => push(parameter.name, "all", value, "", equal),
            Role::Length | Role::Attenuation | Role::Absorption | Role::Scattering => {
                for (i, written) in written.iter().enumerate() {
                    let (value, unit) = match (parameter.role, *written) {
                        (Role::Absorption, Number::Coefficients { sigma_a, .. }) => {
                            (sigma_a, format!("1/{unit}"))
                        }
                        (_, Number::Coefficients { sigma_s, .. }) => (sigma_s, format!("1/{unit}")),
                        (Role::Attenuation, Number::Length(length)) => {
                            (libm::exp(-distance / length), String::new())
                        }
                        (_, Number::Length(length)) => (length / distance, length_unit.to_owned()),
                    };
                    push(parameter.name, channel_name(i, channels.len()), value, &unit, equal);
                }
            }
        }
    }
    let brightest = system.brightest(&values)?;
    let is_beyond = |channel: &Channel| channel.albedo().of_channel() > brightest;
    let note = channels.iter().any(is_beyond).then(|| {
        let name = system.name;
        format!("{name} reaches a surface albedo of {brightest:.3}: brighter channels become that")
    });
    let is_faint = |length: &f64| has_attenuation && *length > 0.0 && distance < 1e-6 * length;
    let note = note.or_else(|| {
        let name = system.name;
        lengths.iter().any(is_faint).then(|| {
            format!("{name} holds a length a million times the distance of its color in few digits or none")
        })
    });
    Ok((rows, note.or_else(|| note_of_short_lengths(system, &lengths))))
}

/// Unit of a length, with the factor that the system multiplies it by.
fn unit_name(system: &System, scene: Unit) -> String {
    let unit = system.unit.unwrap_or(scene).name();
    // A factor that starts as what changes nothing leaves the unit as it is
    let factor =
        system.parameters.iter().find(|p| matches!(p.role, Role::Factor { default, per } if default != per));
    factor.map_or(unit.to_owned(), |factor| format!("{}*{unit}", factor.name))
}

fn channel_name(index: usize, count: usize) -> &'static str {
    if count == 1 { "all" } else { ["r", "g", "b"][index.min(2)] }
}

/// Note that a system will not use the numbers as they are.
fn note_of_short_lengths(system: &System, lengths: &[f64]) -> Option<String> {
    let least = system.least_length?;
    let short = lengths.iter().find(|&&length| length > 0.0 && length < least)?;
    let (name, short, least) = (system.name, Short(*short), Short(least));
    Some(format!("{name} uses {least} in place of the length {short}, in scene units"))
}
