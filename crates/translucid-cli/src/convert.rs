//! `translucid convert`: the same material in every other system's numbers.

mod color_space;
mod output;
mod setting;
mod textures;
mod thin;

use std::path::PathBuf;

use clap::Args;
use translucid_profile::convention::{
    ArgumentNames, Conversion, Converted, LINEAR_SPACES, conversion_system_names,
};

use self::color_space::ColorSpaceArguments;
use self::textures::TextureArguments;
use self::thin::ThinArguments;
use crate::failure::Failure;
use crate::messages;
use crate::model::{ConfigurationName, UnitName};
use crate::table::ReadableFormat;

const EXAMPLES: &str = "\
Columns: system, parameter, channel (all, or r, g, b), value, unit, equal (what the conversion keeps), source of the rule:
how it was seen (code, document or measured pictures; exact or computed for numbers of no system's), and where.

A value is one number for all channels, or three for red, green and blue. A missing length or color is 1, but for the color that
light has behind a distance (glTF, Substrate), which needs both; a missing factor is the system's default (RenderMan's
unitLength 0.1).

A conversion keeps the width d between systems that draw Burley's profile, and the transport mean free path
between systems that walk or solve a medium. From one kind to the other d = mfp/s(A), by the fit of the
--configuration. It keeps the surface albedo, except for the random walks of Cycles. Scattering is isotropic;
a g of pbrt, RISE, glTF or Cycles' walks is replaced by the similar isotropic medium.

Lengths are in --unit if a system takes scene units; Unreal's are always in cm, Unity HDRP's in mm and glTF's in m.

--thin prints what a slab of the material reflects and passes, exactly, the thin-walled surface of OpenPBR, Blender and
glTF that stands for it, and the errors of that, all as shares of the light that arrives. --wall-color and --wall-balance lead
back: from the color of a thin wall, and the share of its light that goes to the other side, (1 + a)/2 of OpenPBR's
subsurface_scatter_anisotropy a, to the slab that has such a reflectance and transmittance.

--color-space prints the numbers for channels of other primaries: surface albedos change as colors do, and each new
channel is the medium nearest to the mixture of old channels that it is. The rows `color space` have the share of the
light that leaves at another radius than that mixture's: so, if lengths were kept, and if they changed as colors do.
With --albedo-texture and --mfp-texture each texel is converted so, and two OpenEXR files are written; integers of the first are
albedos by the curve of sRGB, in the primaries of --from-color-space.
Linear color spaces: SPACES.

Systems: SYSTEMS.
Their parameters and rules: --from list, and docs/guide/conventions.md.

Examples:
  translucid convert --from list
  translucid convert --from renderman:dmfp=8 --from renderman:dmfpColor=1,0.4,0.2 \\
      --surface-albedo 0.8,0.5,0.4 --unit cm
  translucid convert --from cycles-burley:subsurface_radius=1,0.2,0.1 \\
      --from cycles-burley:subsurface_scale=0.05 --surface-albedo 0.8 --unit m --to unreal,hdrp --format text
  translucid convert --from pbrt:sigma_a=0.0021,0.0041,0.0071 --from pbrt:sigma_s=2.19,2.62,3.00
  translucid convert --from translucid:mfp=1 --surface-albedo 0.5 --to renderman --set renderman:unitLength=1
  translucid convert --from translucid:mfp=0.3,0.2,0.1 --surface-albedo 0.8,0.6,0.3 --thin 0.2 --format text
  translucid convert --wall-color 0.7,0.5,0.3 --wall-balance 0.4 --thin 0.2 --format text
  translucid convert --from translucid:mfp=3.7,1.4,0.7 --surface-albedo 0.44,0.22,0.13 --color-space acescg --to openpbr
  translucid convert --albedo-texture albedo.png --mfp-texture mfp.exr --color-space acescg -o textures";

/// Converts a material to the parameters of other renderers and engines
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES
    .replace("SYSTEMS", &conversion_system_names().join(", "))
    .replace("SPACES", &LINEAR_SPACES.join(", ")))]
pub(crate) struct ConvertArguments {
    /// A parameter of the source system, repeated for each parameter; or `list` for all systems
    #[arg(long, value_name = "SYSTEM:PARAMETER=VALUE", required_unless_present_any = ["wall_color", "albedo_texture"])]
    from: Vec<String>,
    /// Surface albedo A, in [0, 1]: one or three, comma-separated; coefficients determine it
    #[arg(long, value_name = "A", value_delimiter = ',', allow_negative_numbers = true)]
    surface_albedo: Vec<f64>,
    /// Unit of lengths in the source scene, for systems without a unit of their own
    #[arg(long, value_enum, default_value = "mm")]
    unit: UnitName,
    /// Unit of lengths in the target scene [default: that of --unit]
    #[arg(long, value_enum)]
    to_unit: Option<UnitName>,
    /// Systems to print, comma-separated [default: all]
    #[arg(long, value_name = "SYSTEMS", value_delimiter = ',')]
    to: Vec<String>,
    /// A fixed parameter of a printed system; repeated for each parameter
    #[arg(long, value_name = "SYSTEM:PARAMETER=VALUE")]
    set: Vec<String>,
    /// How light enters, for the fit between the width of a profile and the mean free path of a medium
    #[arg(long, value_enum, default_value = "diffuse")]
    configuration: ConfigurationName,
    #[command(flatten)]
    color_space: ColorSpaceArguments,
    #[command(flatten)]
    textures: TextureArguments,
    #[command(flatten)]
    thin: ThinArguments,
    /// File to write instead of stdout, or directory for textures
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// How to print
    #[arg(long, value_enum, default_value = "csv")]
    format: ReadableFormat,
}

const NAMES: ArgumentNames = ArgumentNames {
    from: "--from",
    surface_albedo: "--surface-albedo",
    to: "--to",
    set: "--set",
    color_space: "--color-space",
    from_color_space: "--from-color-space",
};

/// Runs the verb.
pub(crate) fn run(arguments: &ConvertArguments) -> Result<(), Failure> {
    if arguments.from == ["list"] {
        return output::write_text(&output::list(), arguments.output.as_deref());
    }
    arguments.thin.require_slab()?;
    if let (Some(paths), Some(spaces), Some(output)) =
        (arguments.textures.files(), arguments.color_space.spaces(), &arguments.output)
    {
        return textures::run(paths, spaces, &NAMES, arguments.configuration.into(), output);
    }
    let converted = if arguments.thin.is_of_wall() { arguments.thin.slab()? } else { convert(arguments)? };
    converted.notes.iter().for_each(|note| messages::print_note(note));
    output::write(&converted.numbers, arguments.format, arguments.output.as_deref())
}

fn convert(arguments: &ConvertArguments) -> Result<Converted, Failure> {
    let to: Vec<&str> = arguments.to.iter().map(String::as_str).collect();
    let conversion = Conversion {
        from: &setting::parse_all("--from", &arguments.from)?,
        surface_albedo: &arguments.surface_albedo,
        unit: arguments.unit.into(),
        to_unit: arguments.to_unit.unwrap_or(arguments.unit).into(),
        to: &to,
        set: &setting::parse_all("--set", &arguments.set)?,
        configuration: arguments.configuration.into(),
        color_space: arguments.color_space.spaces(),
        names: NAMES,
    };
    if !arguments.thin.is_asked() {
        return Ok(conversion.run()?);
    }
    let (channels, shares) = conversion.material()?;
    let mut converted = arguments.thin.walls(&channels)?;
    converted.numbers.extend(shares);
    Ok(converted)
}
