//! `translucid convert`: the same material in every other system's numbers.

mod names;
mod output;
mod rows;
mod setting;

use std::path::PathBuf;

use clap::Args;
use translucid_profile::ParameterError;
use translucid_profile::convention::{Channel, LengthUnit, Role, SurfaceAlbedo, System};
use translucid_scene::Unit;

use crate::failure::Failure;
use crate::messages;
use crate::model::{ConfigurationName, UnitName};
use crate::table::{exact, print};
use setting::Setting;

const EXAMPLES: &str = "\
Columns: system, parameter, channel (all, or r, g, b), value, unit, equal (what the conversion keeps),
source of the rule (code or document, then where it was read).

Values are numbers for all channels or three, for red, green and blue. A length or color of the system
that is not given counts as 1, RenderMan's unitLength as 0.1, other factors as what the system has.

What is equal: between systems that draw Burley's profile its width d, exactly; between systems that
walk or solve a medium the transport mean free path. From one kind to the other d = mfp/s(A) by the fit
of the --configuration. The surface albedo is passed on as it is. All is for isotropic scattering;
pbrt's g is turned into the similar isotropic medium.

Lengths are in --unit where a system takes them in scene units; Unreal's are always in cm and Unity
HDRP's in mm.

Systems: SYSTEMS.
Their parameters and rules: --from list, and docs/guide/conventions.md.

Examples:
  translucid convert --from list
  translucid convert --from renderman:dmfp=8 --from renderman:dmfpColor=1,0.4,0.2 \\
      --surface-albedo 0.8,0.5,0.4 --unit cm
  translucid convert --from cycles-burley:subsurface_radius=1,0.2,0.1 \\
      --from cycles-burley:subsurface_scale=0.05 --surface-albedo 0.8 --unit m --to unreal,hdrp --format text
  translucid convert --from pbrt:sigma_a=0.0021,0.0041,0.0071 --from pbrt:sigma_s=2.19,2.62,3.00
  translucid convert --from translucid:mfp=1 --surface-albedo 0.5 --to renderman --set renderman:unitLength=1";

/// Prints a material in the numbers of other renderers and engines
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES.replace("SYSTEMS", &names::all().join(", ")))]
pub(crate) struct ConvertArguments {
    /// A parameter of the system that the material comes from, once for each parameter; or `list` the systems
    #[arg(long, value_name = "SYSTEM:PARAMETER=VALUE", required = true)]
    from: Vec<String>,
    /// Surface albedo A, in [0, 1]: one or three, comma-separated; coefficients determine it
    #[arg(long, value_name = "A", value_delimiter = ',', allow_negative_numbers = true)]
    surface_albedo: Vec<f64>,
    /// Unit of lengths in the scene that the material comes from, for systems without a unit of their own
    #[arg(long, value_enum, default_value = "mm")]
    unit: UnitName,
    /// Unit of lengths in the scene that the material goes to [default: that of --unit]
    #[arg(long, value_enum)]
    to_unit: Option<UnitName>,
    /// Systems to print, comma-separated [default: all]
    #[arg(long, value_name = "SYSTEMS", value_delimiter = ',')]
    to: Vec<String>,
    /// A parameter of a printed system that is to have this value; once for each parameter
    #[arg(long, value_name = "SYSTEM:PARAMETER=VALUE")]
    set: Vec<String>,
    /// How light enters in the fit between the width of a profile and the mean free path of a medium
    #[arg(long, value_enum, default_value = "diffuse")]
    configuration: ConfigurationName,
    /// File to write instead of stdout
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// How to print
    #[arg(long, value_enum, default_value = "csv")]
    format: output::SettingFormat,
}

/// Millimeters in the unit of a system's lengths.
fn millimeters(unit: LengthUnit, scene: Unit) -> f64 {
    match unit {
        LengthUnit::Scene => scene.in_millimeters(),
        LengthUnit::Millimeter => 1.0,
        LengthUnit::Centimeter => 10.0,
    }
}

/// Runs the verb.
pub(crate) fn run(arguments: &ConvertArguments) -> Result<(), Failure> {
    if arguments.from == ["list"] {
        return print(&names::list());
    }
    let channels = arguments.channels()?;
    let settings = Setting::parse_all("--set", &arguments.set)?;
    let targets = arguments.targets()?;
    for setting in &settings {
        require_target(setting, &targets)?;
    }
    let scene = arguments.to_unit.unwrap_or(arguments.unit).into();
    let mut rows: Vec<rows::Row> = Vec::new();
    for target in targets {
        let written = rows::write(target, &channels, &settings, scene, arguments.configuration.into());
        match written {
            Ok(more) => {
                // A system with several ways has one surface albedo
                let is_told = |row: &rows::Row| row.is_albedo() && row.system.name == target.name;
                let is_repeated = rows.iter().any(is_told);
                rows.extend(more.into_iter().filter(|row| !(is_repeated && row.is_albedo())));
            }
            // A system that was asked for must answer; of all systems some may have nothing to say.
            Err(error) if arguments.to.is_empty() && !names_a_setting(&settings, target, &error) => {
                messages::print_note(&format!("{} has no numbers: {error}", target.name));
            }
            Err(error) => return Err(target_failure(&settings, target, &error)),
        }
    }
    output::write(&rows, arguments.format, arguments.output.as_deref())
}

impl ConvertArguments {
    /// The systems to print, in the order asked for.
    fn targets(&self) -> Result<Vec<&'static System>, Failure> {
        if self.to.is_empty() {
            return Ok(System::ALL.iter().collect());
        }
        let mut targets = Vec::new();
        for name in &self.to {
            targets.extend(names::systems("--to", name)?);
        }
        Ok(targets)
    }

    /// The material's channels, one or three, with lengths in millimeters.
    fn channels(&self) -> Result<Vec<Channel>, Failure> {
        let settings = Setting::parse_all("--from", &self.from)?;
        let source = setting::source(&settings)?;
        let count = match self.surface_albedo.len() {
            0 | 1 | 3 => {
                self.surface_albedo.len().max(settings.iter().map(|s| s.values.len()).max().unwrap_or(1))
            }
            other => {
                let message = format!("--surface-albedo has {other} numbers, but must have one or three");
                return Err(Failure::input(message));
            }
        };

        // Let every parameter have a value in every channel
        let values: Vec<Vec<f64>> = (0..count)
            .map(|channel| {
                let value = |parameter| {
                    let given = settings.iter().find(|setting| setting.is_of(parameter));
                    given.map_or(parameter.role.default(), |setting| setting.value(channel))
                };
                source.parameters.iter().map(value).collect()
            })
            .collect();

        // Find the surface albedos, all of them before the first rule, which may ask for the greatest
        let fail = |error: ParameterError| self.source_failure(source, &error);
        let albedos = self.albedos(source, &values)?;
        let greatest = albedos.iter().copied().fold(0.0, f64::max);
        albedos
            .iter()
            .zip(&values)
            .map(|(&a, values)| {
                let albedo = SurfaceAlbedo::new(a, greatest.max(a)).map_err(fail)?;
                let channel = source.read(values, albedo, self.configuration.into()).map_err(fail)?;
                channel.in_unit(millimeters(source.unit, self.unit.into())).map_err(fail)
            })
            .collect()
    }

    fn albedos(&self, source: &System, values: &[Vec<f64>]) -> Result<Vec<f64>, Failure> {
        if !source.has_coefficients() {
            return match self.surface_albedo[..] {
                [] => Err(Failure::input("--surface-albedo is missing").with_help(
                    "a length means nothing without it; give one number or three, comma-separated",
                )),
                [gray] => Ok(vec![gray; values.len()]),
                ref all => Ok(all.to_vec()),
            };
        }
        if !self.surface_albedo.is_empty() {
            let name = source.name;
            return Err(Failure::input(format!("--surface-albedo follows from the coefficients of {name}"))
                .with_help("leave it out, or give a mean free path in place of the coefficients"));
        }
        let albedo = |values: &Vec<f64>| {
            let found = source.surface_albedo(values, self.configuration.into());
            let albedo = found.map_err(|error| self.source_failure(source, &error))?;
            Ok(albedo.unwrap_or(0.0))
        };
        values.iter().map(albedo).collect()
    }

    /// A parameter's error in the words of the command line.
    fn source_failure(&self, source: &System, error: &ParameterError) -> Failure {
        let (name, value) = (source.name, exact(error.value));
        let requirement = error.requirement();
        if error.parameter == "surface_albedo" && !source.has_coefficients() {
            return Failure::input(format!("--surface-albedo is {value}, but must be {requirement}"));
        }
        let parameter = source.parameters.iter().find(|parameter| parameter.name == error.parameter);
        let Some(parameter) = parameter else {
            let what = error.parameter;
            return Failure::input(format!(
                "--from {name} gives {what} = {value}, but it must be {requirement}"
            ));
        };
        let failure = Failure::input(format!(
            "--from {name}:{} is {value}, but must be {requirement}",
            error.parameter
        ));
        if error.value == 0.0 && matches!(parameter.role, Role::Length | Role::Distance) {
            return failure
                .with_help("length 0 is a Lambertian surface in every system: there is nothing to convert");
        }
        failure
    }
}

/// A setting must concern a printed system.
fn require_target(setting: &Setting, targets: &[&System]) -> Result<(), Failure> {
    let parameter = setting.resolve("--set", targets)?;
    match parameter.role {
        Role::Factor { .. } | Role::Setting { .. } | Role::Distance => Ok(()),
        Role::Length | Role::Absorption | Role::Scattering => {
            let message = format!("--set {}:{} is what the conversion finds", setting.system, parameter.name);
            Err(Failure::input(message).with_help("only factors and distances can be chosen"))
        }
    }
}

fn names_a_setting(settings: &[Setting], target: &System, error: &ParameterError) -> bool {
    settings.iter().any(|setting| setting.system == target.name && setting.names(error.parameter))
}

/// Why a system that was asked for has no numbers.
fn target_failure(settings: &[Setting], target: &System, error: &ParameterError) -> Failure {
    if names_a_setting(settings, target, error) {
        let value = exact(error.value);
        let (name, parameter, requirement) = (target.name, error.parameter, error.requirement());
        return Failure::input(format!("--set {name}:{parameter} is {value}, but must be {requirement}"));
    }
    Failure::input(format!("{} has no numbers for this material: {error}", target.name))
        .with_help(format!("its rule is {}", target.formula))
}
