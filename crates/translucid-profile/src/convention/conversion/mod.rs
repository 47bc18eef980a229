//! A material in the numbers of other systems: from the parameters of one to those of all.

mod color_space;
mod names;
mod rows;
mod setting;

use super::{Channel, Parameter, Role, SurfaceAlbedo, System, Unit};
use crate::short::Short;
use crate::{Configuration, InputError, ParameterError};
pub use color_space::ColorSpaces;
pub use names::conversion_system_names;
pub use rows::ConvertedNumber;
pub use setting::Setting;

/// Names of the arguments of a [`Conversion`] in messages.
#[derive(Clone, Copy, Debug)]
pub struct ArgumentNames {
    /// Name of [`Conversion::from`].
    pub from: &'static str,
    /// Name of [`Conversion::surface_albedo`].
    pub surface_albedo: &'static str,
    /// Name of [`Conversion::to`].
    pub to: &'static str,
    /// Name of [`Conversion::set`].
    pub set: &'static str,
    /// Name of [`ColorSpaces::to`].
    pub color_space: &'static str,
    /// Name of [`ColorSpaces::from`].
    pub from_color_space: &'static str,
}

impl ArgumentNames {
    /// The names of the fields.
    pub const FIELDS: Self = Self {
        from: "from",
        surface_albedo: "surface_albedo",
        to: "to",
        set: "set",
        color_space: "color_space",
        from_color_space: "from_color_space",
    };
}

/// A material in the numbers of one system, to be expressed in those of others.
///
/// [`convention`](super) explains what is equal on both sides, and how closely.
///
/// ```
/// use translucid_profile::Configuration;
/// use translucid_profile::convention::{ArgumentNames, Conversion, Setting, Unit};
///
/// let arnold = [Setting::new("from", "arnold", "subsurface_radius", vec![1.0])?];
/// let conversion = Conversion {
///     from: &arnold,
///     surface_albedo: &[0.5],
///     unit: Unit::Millimeter,
///     to_unit: Unit::Millimeter,
///     to: &["hdrp"],
///     set: &[],
///     configuration: Configuration::Diffuse,
///     color_space: None,
///     names: ArgumentNames::FIELDS,
/// };
/// let hdrp = conversion.run()?.numbers;
/// assert_eq!(hdrp[1].parameter, "scatteringDistance");
/// # Ok::<(), translucid_profile::InputError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Conversion<'a> {
    /// Parameters of the system that the material comes from.
    pub from: &'a [Setting],
    /// Surface albedo in the terms of the system that the material comes from: one or three; none where coefficients
    /// determine it.
    pub surface_albedo: &'a [f64],
    /// Unit of lengths in the scene that the material comes from, for systems without a unit of their own.
    pub unit: Unit,
    /// Unit of lengths in the scene that it goes to.
    pub to_unit: Unit,
    /// Systems that it goes to; all where there are none.
    pub to: &'a [&'a str],
    /// Factors and distances of those systems that are to have a value.
    pub set: &'a [Setting],
    /// How light enters in the fit between the width of a profile and the mean free path of a medium.
    pub configuration: Configuration,
    /// Color spaces of the channels before and after; none where they stay what they are.
    pub color_space: Option<ColorSpaces<'a>>,
    /// Names of all these for messages.
    pub names: ArgumentNames,
}

/// A material in the numbers of other systems.
#[derive(Clone, Debug, Default)]
pub struct Converted {
    /// The numbers, system by system, the surface albedo first; behind them, under "color space", the shares of the light that
    /// a change of color space leaves at another radius.
    pub numbers: Vec<ConvertedNumber>,
    /// Systems without numbers, systems that will not use theirs as they are, and what was taken for granted.
    pub notes: Vec<String>,
}

impl Conversion<'_> {
    /// Converts.
    ///
    /// # Errors
    /// A parameter is not known, missing, or outside its range, or a system that was asked for has no numbers.
    pub fn run(&self) -> Result<Converted, InputError> {
        Setting::require_different(self.names.from, self.from)?;
        Setting::require_different(self.names.set, self.set)?;
        let (channels, shares) = self.mixed_channels()?;
        let targets = self.targets()?;
        for setting in self.set {
            self.require_target(setting, &targets)?;
        }
        let mut converted = Converted::default();
        for target in targets {
            match rows::write(target, &channels, self.set, self.to_unit, self.configuration) {
                Ok((more, note)) => {
                    // A system with several ways has one surface albedo
                    let is_told = |row: &ConvertedNumber| row.is_albedo() && row.system == target.name;
                    let is_repeated = converted.numbers.iter().any(is_told);
                    converted
                        .numbers
                        .extend(more.into_iter().filter(|row| !(is_repeated && row.is_albedo())));
                    converted.notes.extend(note);
                }
                // A system that was asked for must answer; of all systems some may have nothing to say.
                Err(error) if self.to.is_empty() && !self.names_a_setting(target, &error) => {
                    converted.notes.push(format!("{} has no numbers: {error}", target.name));
                }
                Err(error) => return Err(self.target_error(target, &error)),
            }
        }
        converted.numbers.extend(shares);
        converted.notes.extend(self.assumed_unit_length());
        Ok(converted)
    }

    /// The note on RenderMan's `unitLength` where nobody sets it, for that is easily taken for a unit of its own.
    fn assumed_unit_length(&self) -> Option<String> {
        let names = |parameter: &str| {
            self.from.iter().any(|setting| setting.system == "renderman" && setting.names(parameter))
        };
        let unit = self.unit.name();
        (names("dmfp") && !names("unitLength")).then(|| {
            format!("renderman:unitLength is taken to be 0.1, and a scene unit to be 1 {unit}: a dmfp of 1 is 0.1 {unit}")
        })
    }

    /// The material's channels, one or three, in the color space that it goes to, with lengths in the unit of the scene that it
    /// comes from; and the shares of their light that the change of color space leaves at another radius.
    ///
    /// # Errors
    /// The errors of [`run`](Self::run), as far as they concern the material.
    pub fn material(&self) -> Result<(Vec<Channel>, Vec<ConvertedNumber>), InputError> {
        Setting::require_different(self.names.from, self.from)?;
        let (channels, shares) = self.mixed_channels()?;
        let per_millimeter = 1.0 / self.unit.in_millimeters();
        let channels: Result<_, ParameterError> =
            channels.iter().map(|channel| channel.in_unit(per_millimeter)).collect();
        let fail = |error| InputError::new(format!("{} gives a material whose {error}", self.names.from));
        Ok((channels.map_err(fail)?, shares))
    }

    /// The channels in the color space that they go to, with lengths in millimeters.
    fn mixed_channels(&self) -> Result<(Vec<Channel>, Vec<ConvertedNumber>), InputError> {
        let channels = self.channels()?;
        match &self.color_space {
            Some(spaces) => spaces.mix(&channels, self.configuration, &self.names),
            None => Ok((channels, Vec::new())),
        }
    }

    /// The systems to convert to, in the order asked for.
    fn targets(&self) -> Result<Vec<&'static System>, InputError> {
        if self.to.is_empty() {
            return Ok(System::ALL.iter().collect());
        }
        let mut targets = Vec::new();
        for name in self.to {
            targets.extend(names::systems(self.names.to, name)?);
        }
        Ok(targets)
    }

    /// The material's channels, one or three, with lengths in millimeters.
    fn channels(&self) -> Result<Vec<Channel>, InputError> {
        let source = setting::source(&self.names, self.from)?;
        let count = match self.surface_albedo.len() {
            0 | 1 | 3 => {
                self.surface_albedo.len().max(self.from.iter().map(|s| s.values.len()).max().unwrap_or(1))
            }
            other => {
                let name = self.names.surface_albedo;
                return Err(InputError::new(format!(
                    "{name} has {other} numbers, but must have one or three"
                )));
            }
        };

        self.require_attenuation(source)?;

        // Let every parameter have a value in every channel
        let values: Vec<Vec<f64>> = (0..count)
            .map(|channel| {
                let value = |parameter| {
                    let given = self.from.iter().find(|setting| setting.is_of(parameter));
                    given.map_or(parameter.role.default(), |setting| setting.value(channel))
                };
                source.parameters.iter().map(value).collect()
            })
            .collect();

        // A channel of length 0 is Lambertian, but all of them are nothing to convert
        let is_zero = |values: &Vec<f64>| {
            let lengths = source.parameters.iter().zip(values);
            lengths.filter(|(p, _)| p.role.is_of_length()).any(|(_, v)| *v == 0.0)
        };
        if values.iter().all(is_zero) {
            let is_zero = |(p, value): &(&Parameter, &f64)| p.role.is_of_length() && **value == 0.0;
            let parameter = source.parameters.iter().zip(&values[0]).find(is_zero);
            let name = parameter.map_or("", |(parameter, _)| parameter.name);
            let error = InputError::new(format!(
                "{} {}:{name} is 0, but must be above 0",
                self.names.from, source.name
            ));
            return Err(error
                .with_help("length 0 is a Lambertian surface in every system: there is nothing to convert"));
        }

        // Find the surface albedos, all of them before the first rule, which may ask for the greatest
        let fail = |error: ParameterError| self.source_error(source, &error);
        let albedos = self.albedos(source, &values)?;
        let greatest = albedos.iter().copied().fold(0.0, f64::max);
        let channels: Vec<Channel> = albedos
            .iter()
            .zip(&values)
            .map(|(&a, values)| {
                let albedo = SurfaceAlbedo::new(a, greatest.max(a)).map_err(fail)?;
                let channel = source.read(values, albedo, self.configuration).map_err(fail)?;
                channel.in_unit(source.unit.unwrap_or(self.unit).in_millimeters()).map_err(fail)
            })
            .collect::<Result<_, _>>()?;

        // Absorption may have made another channel the greatest
        let greatest = channels.iter().map(|c| c.albedo().of_channel()).fold(0.0, f64::max);
        channels.into_iter().map(|channel| channel.among(greatest).map_err(fail)).collect()
    }

    /// A color at a distance needs both: neither has a default that says a length.
    fn require_attenuation(&self, source: &System) -> Result<(), InputError> {
        let parts = |p: &&Parameter| matches!(p.role, Role::Attenuation | Role::Distance);
        if !source.parameters.iter().any(|p| p.role == Role::Attenuation) {
            return Ok(());
        }
        let is_given = |p: &&Parameter| self.from.iter().any(|setting| setting.is_of(p));
        let Some(missing) = source.parameters.iter().filter(parts).find(|p| !is_given(p)) else {
            return Ok(());
        };
        let (from, system) = (self.names.from, source.name);
        let names: Vec<&str> = source.parameters.iter().filter(parts).map(|p| p.name).collect();
        Err(InputError::new(format!("{from} {system}:{} is missing", missing.name)).with_help(format!(
            "a length needs {}: the distance, and the color that is left of white light behind it",
            names.join(" and ")
        )))
    }

    fn albedos(&self, source: &System, values: &[Vec<f64>]) -> Result<Vec<f64>, InputError> {
        let name = self.names.surface_albedo;
        if !source.has_coefficients() {
            return match self.surface_albedo {
                [] => Err(InputError::new(format!("{name} is missing"))
                    .with_help("a length means nothing without it; give one number or three")),
                [gray] => Ok(vec![*gray; values.len()]),
                all => Ok(all.to_vec()),
            };
        }
        if !self.surface_albedo.is_empty() {
            let system = source.name;
            return Err(InputError::new(format!("{name} follows from the coefficients of {system}"))
                .with_help("leave it out, or give a mean free path in place of the coefficients"));
        }
        let albedo = |values: &Vec<f64>| {
            let found = source.surface_albedo(values, self.configuration);
            let albedo = found.map_err(|error| self.source_error(source, &error))?;
            Ok(albedo.unwrap_or(0.0))
        };
        values.iter().map(albedo).collect()
    }

    /// A parameter's error in the words of the caller.
    fn source_error(&self, source: &System, error: &ParameterError) -> InputError {
        let ArgumentNames { from, surface_albedo, .. } = self.names;
        let (name, value, requirement) = (source.name, Short(error.value), error.requirement());
        if error.parameter == "surface_albedo" && !source.has_coefficients() {
            return InputError::new(format!("{surface_albedo} is {value}, but must be {requirement}"));
        }
        let what = error.parameter;
        let Some(parameter) = source.parameters.iter().find(|parameter| parameter.name == what) else {
            return InputError::new(format!(
                "{from} {name} gives {what} = {value}, but it must be {requirement}"
            ));
        };
        let what = parameter.name;
        InputError::new(format!("{from} {name}:{what} is {value}, but must be {requirement}"))
    }

    /// A setting must concern a system that is converted to.
    fn require_target(&self, setting: &Setting, targets: &[&System]) -> Result<(), InputError> {
        let set = self.names.set;
        if !targets.iter().any(|target| target.name == setting.system) {
            let (system, to) = (&setting.system, self.names.to);
            return Err(InputError::new(format!("{set} names the system {system}, which {to} leaves out")));
        }
        let parameter = setting.resolve(set, targets)?;
        match parameter.role {
            Role::Factor { .. } | Role::Setting { .. } | Role::Distance => Ok(()),
            Role::Length | Role::Attenuation | Role::Filter | Role::Absorption | Role::Scattering => {
                let message =
                    format!("{set} {}:{} is what the conversion finds", setting.system, parameter.name);
                Err(InputError::new(message).with_help("only factors and distances can be chosen"))
            }
        }
    }

    fn names_a_setting(&self, target: &System, error: &ParameterError) -> bool {
        self.set.iter().any(|setting| setting.system == target.name && setting.names(error.parameter))
    }

    /// Why a system that was asked for has no numbers.
    fn target_error(&self, target: &System, error: &ParameterError) -> InputError {
        if self.names_a_setting(target, error) {
            let (value, set) = (Short(error.value), self.names.set);
            let (name, parameter, requirement) = (target.name, error.parameter, error.requirement());
            return InputError::new(format!(
                "{set} {name}:{parameter} is {value}, but must be {requirement}"
            ));
        }
        InputError::new(format!("{} has no numbers for this material: {error}", target.name))
            .with_help(format!("its rule is {}", target.formula))
    }
}
