//! `translucid export`: profiles as text for other people's renderers.

use std::io::{self, IsTerminal, Write};
use std::path::PathBuf;
use std::sync::LazyLock;

use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};
use translucid_export::{Export, ExportError, Material, Sizes, Subject, Target};
use translucid_files::check_writable;
use translucid_profile::convention::preset;
use translucid_profile::{Model, Parameterization};
use translucid_scene::{SubsurfaceModel, Unit};

use crate::command_line;
use crate::failure::Failure;
use crate::files::write_file;
use crate::model::{ConfigurationName, ModelName, UnitName};
use crate::table::{print, printed};

const EXAMPLES: &str = "\
The text is self-contained. Its head has formula, source, units, ranges, largest errors, and its license: MIT-0, so it
may be pasted anywhere. Without a material, functions take its parameters as arguments; with one, its numbers are also
constants, and models without a closed form become sums of exponentials or Gaussians.
One file may have several subjects and models; shared functions are in it once.

Examples:
  translucid export --to glsl --what sampler -o burley.glsl
  translucid export --to c --what profile,sampler --model normalized-diffusion-refined -o refined.h
  translucid export --to hlsl --what profile --preset skin1 --unit cm
  translucid export --to wgsl --what profile --surface-albedo 0.8,0.5,0.4 --mfp 1.3,0.9,0.7
  translucid export --to glsl --what sampler --model gaussians --preset skin1
  translucid export --to cpp --what probe,fresnel -o probe.hpp
  translucid export --to osl --what inversion --g 0.8 --eta 1.4
  translucid export --to hlsl --what disk,kernel --preset skin1 --taps 17 -o skin.hlsl
  translucid export --to exr --what lut --model exact --preset skin1 -o skin.exr
  translucid export --to hlsl --what transmittance --preset skin1 --eta 1.4 -o skin.hlsl
  translucid export --to materialx --what material --preset marble --unit cm -o marble.mtlx";

/// Writes profiles and tables of materials for other renderers: shaders, C, C++, OSL, MaterialX, images
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct ExportArguments {
    /// Language or format of images to write
    #[arg(long, value_name = "LANGUAGE")]
    to: TargetName,
    /// Subjects of the text, comma-separated
    #[arg(long, value_name = "SUBJECTS", value_delimiter = ',', required = true)]
    what: Vec<SubjectName>,
    /// Models of the profile, comma-separated [default: normalized-diffusion]
    #[arg(long, value_name = "MODELS", value_delimiter = ',', hide_possible_values = true)]
    model: Vec<ModelName>,
    /// Material whose numbers become constants; `translucid render --preset list` shows all
    #[arg(long, value_name = "NAME", conflicts_with_all = ["surface_albedo", "mfp", "dmfp"])]
    preset: Option<String>,
    /// Unit of the lengths of a preset
    #[arg(long, value_enum, default_value = "mm", requires = "preset")]
    unit: UnitName,
    /// Surface albedo A of a material, in [0, 1]: one or three, comma-separated
    #[arg(long, value_name = "A", value_delimiter = ',', allow_negative_numbers = true)]
    surface_albedo: Vec<f64>,
    /// Mean free path in the volume, one or three [any unit; radii are in the same]
    #[arg(
        long,
        value_name = "L",
        value_delimiter = ',',
        allow_negative_numbers = true,
        requires = "surface_albedo"
    )]
    mfp: Vec<f64>,
    /// Diffuse mean free path on the surface, in place of --mfp; the text's head lists the mean free paths that it means
    #[arg(
        long,
        value_name = "L",
        value_delimiter = ',',
        allow_negative_numbers = true,
        requires = "surface_albedo",
        conflicts_with = "mfp"
    )]
    dmfp: Vec<f64>,
    /// How light enters the medium [default: diffuse; with --dmfp searchlight, which judge and convert do not mean]
    #[arg(long)]
    configuration: Option<ConfigurationName>,
    /// Mean cosine of the phase function, for an inversion and a transmittance, in [-0.95, 0.95]
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    g: f64,
    /// Relative index of refraction, for an inversion, a transmittance and moments of the Fresnel reflectance
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true)]
    eta: f64,
    /// Number of taps of a disk or a kernel, 3 to 1024 [default: 25]
    #[arg(long, value_name = "N")]
    taps: Option<usize>,
    /// Columns and rows of a lut, 2 to 1024 each; a transmittance has the columns [default: 128x32]
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<[usize; 2]>,
    /// Greatest curvature of a lut, per length [default: 1 over the longest length of the material]
    #[arg(long, value_name = "C", allow_negative_numbers = true)]
    most_curvature: Option<f64>,
    /// Greatest thickness of a transmittance [default: where less than 1/256 is left of the brightest channel]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    most_thickness: Option<f64>,
    /// File to write instead of stdout
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// A target as the command line names it.
#[derive(Clone, Copy, Debug)]
struct TargetName(Target);

impl ValueEnum for TargetName {
    fn value_variants<'a>() -> &'a [Self] {
        static NAMES: LazyLock<Vec<TargetName>> =
            LazyLock::new(|| Target::ALL.into_iter().map(TargetName).collect());
        &NAMES
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(self.0.name()).help(self.0.description()))
    }
}

/// A subject as the command line names it.
#[derive(Clone, Copy, Debug)]
struct SubjectName(Subject);

impl ValueEnum for SubjectName {
    fn value_variants<'a>() -> &'a [Self] {
        static NAMES: LazyLock<Vec<SubjectName>> =
            LazyLock::new(|| Subject::ALL.into_iter().map(SubjectName).collect());
        &NAMES
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(self.0.name()).help(self.0.description()))
    }
}

/// Runs the verb.
pub(crate) fn run(arguments: &ExportArguments) -> Result<(), Failure> {
    if let Some(path) = &arguments.output {
        check_writable(path)?;
    }
    let subjects: Vec<Subject> = arguments.what.iter().map(|name| name.0).collect();
    require_used(arguments, &subjects)?;
    let mut models = arguments.model.iter().map(|name| model(*name)).collect::<Result<Vec<_>, _>>()?;
    if models.is_empty() {
        models.push(Model::NormalizedDiffusion);
    }
    let by_default =
        if arguments.dmfp.is_empty() { ConfigurationName::Diffuse } else { ConfigurationName::Searchlight };
    let export = Export {
        target: arguments.to.0,
        subjects: &subjects,
        models: &models,
        material: material(arguments)?,
        configuration: arguments.configuration.unwrap_or(by_default).into(),
        g: arguments.g,
        eta: arguments.eta,
        sizes: sizes(arguments),
        command: &command_line::shown(),
    };
    let bytes = export.bytes().map_err(|error| name_option(arguments, &error))?;
    match (&arguments.output, export.target) {
        (Some(path), _) => write_file(path, &bytes),
        (None, Target::Text(_) | Target::MaterialX) => print(&String::from_utf8_lossy(&bytes)),
        (None, binary) if io::stdout().is_terminal() => {
            Err(Failure::input(format!("{} is not text for a terminal", binary.name()))
                .with_help("name a file with -o FILE"))
        }
        (None, _) => printed(io::stdout().lock().write_all(&bytes)),
    }
}

/// Refuses options that no subject makes use of.
fn require_used(arguments: &ExportArguments, subjects: &[Subject]) -> Result<(), Failure> {
    let has = |list: &[Subject]| subjects.iter().any(|subject| list.contains(subject));
    let names = || subjects.iter().map(|subject| subject.name()).collect::<Vec<_>>().join(",");
    for (option, is_given, is_used, users) in [
        (
            "--model",
            !arguments.model.is_empty(),
            subjects.iter().any(|subject| subject.has_model()),
            "subjects with a profile",
        ),
        ("--taps", arguments.taps.is_some(), has(&[Subject::Disk, Subject::Kernel]), "disk and kernel"),
        (
            "--size",
            arguments.size.is_some(),
            has(&[Subject::Lut, Subject::Transmittance]),
            "lut and transmittance",
        ),
        ("--most-curvature", arguments.most_curvature.is_some(), has(&[Subject::Lut]), "lut"),
        (
            "--most-thickness",
            arguments.most_thickness.is_some(),
            has(&[Subject::Transmittance]),
            "transmittance",
        ),
    ] {
        if is_given && !is_used {
            return Err(Failure::input(format!("{option} is for {users}, but --what is {}", names()))
                .with_help(format!("leave {option} out")));
        }
    }
    Ok(())
}

fn sizes(arguments: &ExportArguments) -> Sizes {
    let usual = Sizes::default();
    Sizes {
        taps: arguments.taps.unwrap_or(usual.taps),
        lut: arguments.size.unwrap_or(usual.lut),
        most_curvature: arguments.most_curvature,
        most_thickness: arguments.most_thickness,
    }
}

fn parse_size(text: &str) -> Result<[usize; 2], String> {
    let sides =
        text.split_once('x').and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    sides.ok_or_else(|| String::from("a size is two whole numbers with an x between, such as 128x32"))
}

fn model(name: ModelName) -> Result<Model, Failure> {
    match name.model() {
        SubsurfaceModel::Profile(model) => Ok(model),
        other => Err(Failure::input(format!("the model {} has no profile", other.name()))),
    }
}

/// The material that the options describe, if they do.
fn material(arguments: &ExportArguments) -> Result<Option<Material>, Failure> {
    if let Some(name) = &arguments.preset {
        let preset = preset(name)?;
        let millimeters = Unit::from(arguments.unit).in_millimeters();
        return Ok(Some(Material::of_preset(preset, millimeters)));
    }
    if arguments.surface_albedo.is_empty() {
        return Ok(None);
    }
    let (option, lengths, parameterization) = match (&arguments.mfp[..], &arguments.dmfp[..]) {
        ([], []) => {
            return Err(
                Failure::input("--mfp or --dmfp is missing").with_help("a material has a length, too")
            );
        }
        ([], dmfp) => ("--dmfp", dmfp, Parameterization::Dmfp),
        (mfp, _) => ("--mfp", mfp, Parameterization::Mfp),
    };
    Ok(Some(Material {
        surface_albedo: of_channels("--surface-albedo", &arguments.surface_albedo)?,
        length: of_channels(option, lengths)?,
        parameterization,
        surface: None,
    }))
}

/// One number for all channels, or one for each.
fn of_channels(option: &str, numbers: &[f64]) -> Result<[f64; 3], Failure> {
    match numbers {
        [all] => Ok([*all; 3]),
        [red, green, blue] => Ok([*red, *green, *blue]),
        _ => {
            Err(Failure::input(format!("{option} has {} numbers, but must have one or three", numbers.len())))
        }
    }
}

/// States an error of the library in the words of the command.
fn name_option(arguments: &ExportArguments, error: &ExportError) -> Failure {
    let option = match error.parameter {
        "surface_albedo" => "--surface-albedo",
        "length" if arguments.dmfp.is_empty() => "--mfp",
        "length" => "--dmfp",
        "model" => "--model",
        "g" => "--g",
        "eta" => "--eta",
        "taps" => "--taps",
        "size" => "--size",
        "most_curvature" => "--most-curvature",
        "most_thickness" => "--most-thickness",
        "to" => "--to",
        "what" => "--what",
        other => other,
    };
    Failure::input(format!("{option} is {}, but must be {}", error.found, error.allowed))
}
