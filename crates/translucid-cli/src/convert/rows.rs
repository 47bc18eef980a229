//! A material as the rows of one system.

use translucid_profile::convention::{Channel, Equal, LengthUnit, Parameter, Role, System, Written};
use translucid_profile::{Configuration, ParameterError};
use translucid_scene::Unit;

use super::millimeters;
use super::setting::Setting;
use crate::messages;
use crate::table::exact;

/// One number of one system.
pub(super) struct Row {
    pub(super) system: &'static System,
    pub(super) parameter: &'static str,
    /// "all", or "r", "g", "b".
    pub(super) channel: &'static str,
    pub(super) value: f64,
    pub(super) unit: String,
    pub(super) equal: &'static str,
}

impl Row {
    pub(super) fn is_albedo(&self) -> bool {
        self.equal == "surface_albedo"
    }
}

/// The rows of a system, for channels with lengths in millimeters.
pub(super) fn write(
    system: &'static System,
    channels: &[Channel],
    settings: &[Setting],
    scene: Unit,
    configuration: Configuration,
) -> Result<Vec<Row>, ParameterError> {
    // Convert every channel
    let given = |parameter: &Parameter| {
        settings.iter().find(|setting| setting.system == system.name && setting.is_of(parameter))
    };
    let values: Vec<f64> = system
        .parameters
        .iter()
        .map(|p| given(p).map_or(p.role.default(), |setting| setting.value(0)))
        .collect();
    let millimeters = millimeters(system.unit, scene);
    let written: Vec<Written> = channels
        .iter()
        .map(|channel| system.write(&channel.in_unit(1.0 / millimeters)?, &values, configuration))
        .collect::<Result<_, _>>()?;

    // Let the distance be the greatest length, where there is one that nobody has chosen
    let lengths: Vec<f64> =
        written.iter().map(|w| if let Written::Length(l) = w { *l } else { 0.0 }).collect();
    let has_distance = system.parameters.iter().any(|p| p.role == Role::Distance);
    let chosen = system.parameters.iter().find(|p| p.role == Role::Distance).and_then(given);
    let greatest = lengths.iter().copied().fold(0.0, f64::max);
    let distance = if has_distance { chosen.map_or(greatest, |setting| setting.value(0)) } else { 1.0 };
    warn_of_short_lengths(system, &lengths);

    // Print every parameter, the surface albedo first
    let mut rows = Vec::new();
    let mut push = |parameter, channel, value, unit: &str, equal| {
        rows.push(Row { system, parameter, channel, value, unit: unit.to_owned(), equal });
    };
    if let Some(name) = system.albedo_name {
        for (i, channel) in channels.iter().enumerate() {
            push(name, channel_name(i, channels.len()), channel.albedo().of_channel(), "", "surface_albedo");
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
            Role::Length | Role::Absorption | Role::Scattering => {
                for (i, written) in written.iter().enumerate() {
                    let (value, unit) = match (parameter.role, *written) {
                        (Role::Absorption, Written::Coefficients { sigma_a, .. }) => {
                            (sigma_a, format!("1/{unit}"))
                        }
                        (_, Written::Coefficients { sigma_s, .. }) => (sigma_s, format!("1/{unit}")),
                        (_, Written::Length(length)) => (length / distance, length_unit.to_owned()),
                    };
                    push(parameter.name, channel_name(i, channels.len()), value, &unit, equal);
                }
            }
        }
    }
    Ok(rows)
}

/// Unit of a length, with the factor that the system multiplies it by.
fn unit_name(system: &System, scene: Unit) -> String {
    let unit = match system.unit {
        LengthUnit::Scene => scene.name(),
        LengthUnit::Millimeter => "mm",
        LengthUnit::Centimeter => "cm",
    };
    // A factor that starts as what changes nothing leaves the unit as it is
    let factor =
        system.parameters.iter().find(|p| matches!(p.role, Role::Factor { default, per } if default != per));
    factor.map_or(unit.to_owned(), |factor| format!("{}*{unit}", factor.name))
}

fn channel_name(index: usize, count: usize) -> &'static str {
    if count == 1 { "all" } else { ["r", "g", "b"][index.min(2)] }
}

/// Says where a system will not use the numbers as they are.
fn warn_of_short_lengths(system: &System, lengths: &[f64]) {
    let Some(least) = system.least_length else { return };
    if let Some(short) = lengths.iter().find(|&&length| length > 0.0 && length < least) {
        let (name, short, least) = (system.name, exact(*short), exact(least));
        messages::print_note(&format!("{name} uses {least} in place of the length {short}, in scene units"));
    }
}
