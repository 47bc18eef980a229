//! `translucid judge`: an engine's picture of a lit shape on a plane beside the exact light.

mod picture;
mod symmetry;

use std::ffi::OsStr;
use std::ops::RangeInclusive;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use translucid_files::check_writable;
use translucid_laboratory::judge::{Judgement, LEVELS, Pass, Setup, appearance, judgement_chart};
use translucid_measure::CHANNELS;
use translucid_profile::{AlbedoInversion, Configuration, Parameterization, scaling};
use translucid_words::Cell;

use crate::failure::Failure;
use crate::files::{input_among, write_file};
use crate::messages;
use crate::model::ConfigurationName;
use crate::table::{ReadableFormat, exact, print};

const EXAMPLES: &str = "\
The picture is linear OpenEXR with channels R, G, B: a plane seen straight from above, orthographically, whose irradiance is 1
in a shape and 0 elsewhere. Make it by the pass under test, with borders that repeat the last pixel for an edge or a line:
  edge  one half is lit, whatever the direction of the straight line between both
  disk  a disk of the diameter --size is lit
  line  a band of the width --size is lit, along rows or columns
The plane is a half space. Its light is exact with --g 0 and --eta 1. Otherwise 400,000 photons walk for it, and the light
across an edge is known to 0.001 (one standard error).

A channel is right if its RMS difference is at most 0.01 of the light on a large lit shape, its widths are within 3 %, and all
its light within 2 %, which takes --white. If it is not, the light that known mistakes draw is compared with it. The one that
explains the picture gives the verdict: profile, gather, or picture (a wrong --size). unknown means that none does.

--dmfp is the exact one of this surface albedo and --configuration (diffuse unless stated). export takes it for the
searchlight's unless stated, and convert goes by Burley's fit: a note prints all three in mean free paths.

Columns: channel, verdict, light_error (empty without --white), rms_error, largest_error, then by the level 25, 10, 5 (per cent
of the light) width_N and exact_width_N in the unit of the lengths, explained_rms (what the cause leaves), sentence.

Examples:
  translucid judge pass.exr --setup edge --pixel 0.05 --surface-albedo 0.9,0.6,0.4 --mfp 1,0.5,0.3
  translucid judge pass.exr --setup disk --size 2 --pixel 0.05 --surface-albedo 0.8 --mfp 0.5 --white 1 -o judgement.svg
  translucid judge pass.exr --setup edge --pixel 0.05 --surface-albedo 0.8 --mfp 0.5 --g 0.8 --eta 1.4";

/// Judges a screen-space pass by a picture of it: light, width, and what to change
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct JudgeArguments {
    /// Linear OpenEXR file of the lit plane
    #[arg(value_name = "PICTURE")]
    picture: PathBuf,
    /// Shape that is lit
    #[arg(long, value_enum)]
    setup: SetupName,
    /// Diameter of the disk or width of the line [unit of the lengths]
    #[arg(long, value_name = "L", allow_negative_numbers = true)]
    size: Option<f64>,
    /// Width of a pixel on the plane [unit of the lengths]
    #[arg(long, value_name = "L", allow_negative_numbers = true)]
    pixel: f64,
    /// Surface albedo in (0, 1): one, or red, green and blue
    #[arg(long, value_name = "A,...", value_delimiter = ',', allow_negative_numbers = true, required = true)]
    surface_albedo: Vec<f64>,
    /// Mean free path in the volume: one, or three [any unit]
    #[arg(
        long,
        value_name = "L,...",
        value_delimiter = ',',
        allow_negative_numbers = true,
        required_unless_present = "dmfp"
    )]
    mfp: Vec<f64>,
    /// Diffuse mean free path on the surface, in place of --mfp
    #[arg(
        long,
        value_name = "L,...",
        value_delimiter = ',',
        allow_negative_numbers = true,
        conflicts_with = "mfp"
    )]
    dmfp: Vec<f64>,
    /// How light enters the medium
    #[arg(long, value_enum, default_value = "diffuse")]
    configuration: ConfigurationName,
    /// Mean cosine of the phase function, in [-0.95, 0.95]
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    g: f64,
    /// Relative index of refraction of the smooth boundary, in [1, 3]
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true)]
    eta: f64,
    /// Value of a lit pixel of a surface that returns all light and does not scatter below; with it all light is compared
    #[arg(long, value_name = "V", allow_negative_numbers = true)]
    white: Option<f64>,
    /// File to write instead of stdout; a .svg file is a plot, beside the table on stdout
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// How to print
    #[arg(long, value_enum, default_value = "text")]
    format: ReadableFormat,
}

/// Shapes that can be lit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum SetupName {
    /// A half plane
    Edge,
    /// A disk
    Disk,
    /// A band
    Line,
}

const COLUMNS: [&str; 13] = [
    "channel",
    "verdict",
    "light_error",
    "rms_error",
    "largest_error",
    "width_25",
    "exact_width_25",
    "width_10",
    "exact_width_10",
    "width_5",
    "exact_width_5",
    "explained_rms",
    "sentence",
];

/// Runs the verb.
pub(crate) fn run(arguments: &JudgeArguments) -> Result<(), Failure> {
    let setup = arguments.setup()?;
    let [albedos, lengths] = [arguments.surface_albedos()?, arguments.lengths()?];
    let white = arguments.white.map(|white| positive("--white", white)).transpose()?;
    let output = arguments.output.as_deref();
    if let Some(path) = input_among(output.into_iter(), std::iter::once(arguments.picture.as_path())) {
        let message = format!("--output is {}, the picture that is judged", path.display());
        return Err(Failure::input(message).with_help("choose another file"));
    }
    output.map_or(Ok(()), check_writable)?;
    within("--g", arguments.g, AlbedoInversion::G)?;
    within("--eta", arguments.eta, AlbedoInversion::ETA)?;
    let bins = picture::read(&arguments.picture, setup, arguments.pixel)?;
    if !arguments.dmfp.is_empty() {
        arguments.note_lengths(albedos)?;
    }
    let mut judged = Vec::new();
    for ((channel, bins), (surface_albedo, length)) in
        CHANNELS.into_iter().zip(bins).zip(albedos.into_iter().zip(lengths))
    {
        let pass = Pass {
            setup,
            appearance: appearance(surface_albedo, length, !arguments.dmfp.is_empty(), arguments.g),
            eta: arguments.eta,
            configuration: Configuration::from(arguments.configuration),
            pixel: arguments.pixel,
            white,
            bins,
        };
        let fail = |fault: translucid_laboratory::judge::Unjudged| {
            Failure::input(format!("{}: {channel}: {fault}", arguments.picture.display()))
        };
        judged.push((channel, pass.judge().map_err(fail)?));
    }
    arguments.write(&judged)
}

impl JudgeArguments {
    fn setup(&self) -> Result<Setup, Failure> {
        positive("--pixel", self.pixel)?;
        match (self.setup, self.size) {
            (SetupName::Edge, None) => Ok(Setup::Edge),
            (SetupName::Edge, Some(_)) => {
                Err(Failure::input("--size is for a disk or a line, but --setup is edge")
                    .with_help("leave --size out"))
            }
            (_, None) => {
                Err(Failure::input("--size is missing: the diameter of the disk, or the width of the line"))
            }
            (SetupName::Disk, Some(size)) => Ok(Setup::Disk { radius: 0.5 * positive("--size", size)? }),
            (SetupName::Line, Some(size)) => Ok(Setup::Line { width: positive("--size", size)? }),
        }
    }

    fn surface_albedos(&self) -> Result<[f64; 3], Failure> {
        let albedos = three("--surface-albedo", &self.surface_albedo)?;
        match albedos.into_iter().find(|a| !(*a > 0.0 && *a < 1.0)) {
            Some(a) => {
                Err(Failure::input(format!("--surface-albedo is {}, but must be in (0, 1)", exact(a))))
            }
            None => Ok(albedos),
        }
    }

    fn lengths(&self) -> Result<[f64; 3], Failure> {
        let (option, given) =
            if self.dmfp.is_empty() { ("--mfp", &self.mfp) } else { ("--dmfp", &self.dmfp) };
        let lengths = three(option, given)?;
        lengths.into_iter().try_for_each(|length| positive(option, length).map(|_| ()))?;
        Ok(lengths)
    }

    /// Says how long a diffuse mean free path is, here and where else it is asked for.
    fn note_lengths(&self, albedos: [f64; 3]) -> Result<(), Failure> {
        let listed = |ratio: &dyn Fn(f64) -> f64| albedos.map(|a| format!("{:.3}", ratio(a))).join(", ");
        let exact = |configuration| {
            let inversion = AlbedoInversion::new(self.g, self.eta, configuration)
                .map_err(|error| Failure::input(error.to_string()))?;
            Ok::<_, Failure>(listed(&|a| 1.0 / inversion.mfp(a, 1.0, Parameterization::Dmfp)))
        };
        let configuration = Configuration::from(self.configuration);
        let fit = |a| {
            scaling(a, Parameterization::Dmfp, configuration)
                / scaling(a, Parameterization::Mfp, configuration)
        };
        messages::print_note(&format!(
            "a diffuse mean free path is {} mean free paths in diffuse light and {} of a searchlight, exactly, of which {} \
             counts here; {} by Burley's fits, which convert goes by",
            exact(Configuration::Diffuse)?,
            exact(Configuration::Searchlight)?,
            if configuration == Configuration::Diffuse { "the former" } else { "the latter" },
            listed(&fit)
        ));
        Ok(())
    }

    fn write(&self, judged: &[(&str, Judgement)]) -> Result<(), Failure> {
        let rows: Vec<Vec<Cell>> =
            judged.iter().map(|(channel, judgement)| row(channel, judgement)).collect();
        let text = self.format.text(&COLUMNS, &rows, || words(judged));
        let extension = |path: &PathBuf| path.extension().map(OsStr::to_ascii_lowercase);
        match &self.output {
            None => print(&text),
            Some(path) if extension(path).is_some_and(|end| end == "svg") => {
                let channels: Vec<(&str, &Judgement)> =
                    judged.iter().map(|(name, one)| (*name, one)).collect();
                write_file(path, judgement_chart(&channels, "").svg().as_bytes())?;
                print(&text)
            }
            Some(path) => write_file(path, text.as_bytes()),
        }
    }
}

/// A length or a value of light.
fn positive(option: &str, value: f64) -> Result<f64, Failure> {
    within(option, value, 1e-18..=1e18)
}

fn within(option: &str, value: f64, range: RangeInclusive<f64>) -> Result<f64, Failure> {
    if range.contains(&value) {
        return Ok(value);
    }
    let [low, high] = [range.start(), range.end()];
    Err(Failure::input(format!("{option} is {}, but must be in [{low:?}, {high:?}]", exact(value))))
}

/// One number for all channels, or three.
fn three(option: &str, values: &[f64]) -> Result<[f64; 3], Failure> {
    match *values {
        [all] => Ok([all; 3]),
        [red, green, blue] => Ok([red, green, blue]),
        _ => Err(Failure::input(format!("{option} has {} values, but must have 1 or 3", values.len()))),
    }
}

fn row(channel: &str, judgement: &Judgement) -> Vec<Cell> {
    let known = |value: Option<f64>| Cell::Number(value.unwrap_or(f64::NAN));
    let mut cells = vec![Cell::from(channel), Cell::from(judgement.verdict()), known(judgement.light_error)];
    cells.extend([judgement.rms, judgement.largest].map(Cell::Number));
    cells.extend(judgement.widths.iter().flatten().map(|width| Cell::Number(*width)));
    cells.extend([known(judgement.explained_rms), Cell::from(judgement.sentence.as_str())]);
    cells
}

/// Lines for people.
fn words(judged: &[(&str, Judgement)]) -> String {
    let mut text = String::new();
    for (channel, judgement) in judged {
        text += &format!("{channel}: {}\n", judgement.sentence);
        for (level, [found, truth]) in LEVELS.iter().zip(&judgement.widths) {
            let found =
                if found.is_nan() { String::from("beyond the picture") } else { format!("at {found:.4}") };
            let truth = if truth.is_nan() { String::from("beyond it") } else { format!("at {truth:.4}") };
            text += &format!("  light falls to {:2.0} % {found}, exact {truth}\n", 100.0 * level);
        }
    }
    text
}
