//! `translucid stack`: the color of layers over grounds.

mod file;
mod output;
mod spectra;

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use translucid_laboratory::colorimetry::{Colorimeter, Illuminant, Observer, delta_e_2000, delta_e_ab};
use translucid_laboratory::stack::{Color, Measurement, Specular};

use self::file::Stack;
use self::output::OutputFormat;
use crate::failure::Failure;
use crate::files::input_among;
use crate::messages;

const EXAMPLES: &str = "\
The file is that of reference --layers, in which a number may also be three, for red, green and blue (linear Rec. 709), or a
table over wavelengths in nm. [grounds] has the reflectances of black and white.

Columns: ground (black, white, below: that of the file), reflectance and transmittance (of luminance), X, Y, Z, L, a, b, srgb,
in_srgb (no where srgb is only the nearest color of a display), error (numerical, at most, in Delta E*ab),
kubelka_munk_reflectance (with Saunderson's correction), kubelka_munk_delta_e (its distance from the color in Delta E*ab); then,
the same in each row, tp_ab and tp_2000 (Delta E*ab and CIEDE2000 between the layers over white and over black) and
contrast_ratio (Y over black / Y over white).

Everything is what an instrument of the geometry d:8 measures: sphere, viewed at 8 degrees.

Examples:
  translucid stack tooth.toml
  translucid stack tooth.toml --format text --specular excluded
  translucid stack tooth.toml --channels -o spectra.csv
  translucid stack tooth.toml -o tooth.svg";

/// Prints the color of plane layers over black, white and their own ground, and draws a swatch
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct StackArguments {
    /// TOML file of the layers
    file: PathBuf,
    /// Light
    #[arg(long, value_enum, default_value = "d65")]
    illuminant: IlluminantName,
    /// Field of view of the observer in degrees: CIE 1931 or CIE 1964
    #[arg(long, value_enum, default_value = "2")]
    observer: ObserverName,
    /// Whether light that was not scattered is measured, as most instruments do unless they are told otherwise
    #[arg(long, value_enum, default_value = "included")]
    specular: SpecularName,
    /// Print reflectances and transmittances by wavelength or channel instead of colors
    #[arg(long)]
    channels: bool,
    /// File to write instead of stdout; a .svg or .png file is a swatch, beside the table on stdout
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// How to print
    #[arg(long, value_enum, default_value = "csv")]
    format: OutputFormat,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum IlluminantName {
    /// Daylight, 6504 K
    D65,
    /// Daylight of printing, 5003 K
    D50,
    /// Incandescent light, 2856 K
    A,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ObserverName {
    /// CIE 1931
    #[value(name = "2")]
    Two,
    /// CIE 1964
    #[value(name = "10")]
    Ten,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum SpecularName {
    /// Di:8
    Included,
    /// De:8, with a gloss trap
    Excluded,
}

/// Layers over one ground with their color.
struct Row {
    ground: &'static str,
    /// Color of the ground without layers.
    bare: Color,
    measured: Measurement,
    color: Color,
    /// Y of the transmitted light, over 100; not a number over a ground.
    transmittance: f64,
    /// Greatest ΔE*ab that numerical errors can make.
    error: f64,
    kubelka_munk: Color,
}

impl Row {
    /// ΔE*ab between Kubelka and Munk's color and the exact one.
    fn kubelka_munk_delta_e(&self) -> f64 {
        delta_e_ab(self.color.lab, self.kubelka_munk.lab)
    }
}

/// Differences between the layers over white and over black; not numbers below an endless layer.
struct Contrast {
    tp_ab: f64,
    tp_2000: f64,
    ratio: f64,
}

/// Error of colors, in ΔE*ab, above which there is a warning.
const ERROR: f64 = 0.01;
/// Distance of Kubelka and Munk's color, in ΔE*ab, above which it is noted.
const OFF: f64 = 1.0;

/// Runs the verb.
pub(crate) fn run(arguments: &StackArguments) -> Result<(), Failure> {
    let inputs = std::iter::once(arguments.file.as_path());
    if let Some(path) = input_among(arguments.output.iter().map(PathBuf::as_path), inputs) {
        let message =
            format!("--output is {}, a file that is read, and would be overwritten", path.display());
        return Err(Failure::input(message).with_help("choose another file"));
    }
    let stack = file::read(&arguments.file)?;
    let eye = arguments.eye(stack.below.len())?;
    stack.notes.iter().for_each(|note| messages::print_note(note));
    let rows = arguments.rows(&stack, &eye)?;
    let contrast = contrast(&rows);
    warn(&rows);
    output::write(arguments, &rows, &contrast)
}

impl StackArguments {
    fn eye(&self, channels: usize) -> Result<Colorimeter, Failure> {
        let is_usual = self.observer == ObserverName::Two && self.illuminant == IlluminantName::D65;
        if channels == 3 && !is_usual {
            return Err(Failure::input(format!(
                "{} has values for red, green and blue, which are colors for --illuminant d65 and --observer 2 only",
                self.file.display()
            ))
            .with_help("give values over wavelengths"));
        }
        let observer = match self.observer {
            ObserverName::Two => Observer::TwoDegrees,
            ObserverName::Ten => Observer::TenDegrees,
        };
        let illuminant = match self.illuminant {
            IlluminantName::D65 => Illuminant::D65,
            IlluminantName::D50 => Illuminant::D50,
            IlluminantName::A => Illuminant::A,
        };
        Ok(Colorimeter::new(observer, illuminant))
    }

    /// How colors are seen, in words.
    fn conditions(&self, channels: usize) -> String {
        let illuminant = match self.illuminant {
            IlluminantName::D65 => "D65",
            IlluminantName::D50 => "D50",
            IlluminantName::A => "A",
        };
        let observer = if self.observer == ObserverName::Two { 2 } else { 10 };
        let specular = if self.specular == SpecularName::Included { "included" } else { "excluded" };
        let rgb = if channels == 3 { ", from red, green and blue" } else { "" };
        format!("{illuminant}, {observer}° observer, d:8° with specular {specular}{rgb}")
    }

    fn rows(&self, stack: &Stack, eye: &Colorimeter) -> Result<Vec<Row>, Failure> {
        let specular = match self.specular {
            SpecularName::Included => Specular::Included,
            SpecularName::Excluded => Specular::Excluded,
        };
        let mut grounds = Vec::new();
        if let Some(both) = &stack.grounds {
            grounds.extend(
                ["black", "white"].into_iter().zip(both).map(|(name, (bare, on))| (name, bare.clone(), on)),
            );
        }
        let bare = stack.below.iter().map(file::bare_reflectance).collect();
        grounds.push(("below", bare, &stack.below));
        let row = |(ground, bare, layers): (_, Vec<f64>, &Vec<_>)| {
            let measured =
                Measurement::new(layers, specular).map_err(|error| self.refused(&error.to_string()))?;
            if measured.errors.iter().any(|error| *error > 1e-2) {
                return Err(Failure::work(
                    "these layers have no exact solution: their coefficients are too far apart",
                ));
            }
            let color = Color::new(eye, &measured.reflectance);
            let is_open = ground == "below" && file::lets_through(layers);
            Ok(Row {
                ground,
                bare: Color::new(eye, &bare),
                color,
                transmittance: if is_open {
                    Color::new(eye, &measured.transmittance).xyz[1] / 100.0
                } else {
                    f64::NAN
                },
                error: color.error(eye, &measured.errors),
                kubelka_munk: Color::new(eye, &measured.kubelka_munk),
                measured,
            })
        };
        grounds.into_iter().map(row).collect()
    }

    fn refused(&self, error: &str) -> Failure {
        Failure::input(format!("{}: {error}", self.file.display()))
    }
}

fn contrast(rows: &[Row]) -> Contrast {
    match rows {
        [black, white, _] => {
            let (black, white) = (black.color, white.color);
            Contrast {
                tp_ab: delta_e_ab(black.lab, white.lab),
                tp_2000: delta_e_2000(black.lab, white.lab),
                ratio: black.xyz[1] / white.xyz[1],
            }
        }
        _ => Contrast { tp_ab: f64::NAN, tp_2000: f64::NAN, ratio: f64::NAN },
    }
}

/// Warns of errors that matter, and notes where Kubelka and Munk are far off.
fn warn(rows: &[Row]) {
    let error = rows.iter().map(|row| row.error).fold(0.0, f64::max);
    if error > ERROR {
        messages::print_warning(&format!("numerical errors may change colors by up to {error:.2} ΔE*ab"));
    }
    let off = rows.iter().filter(|row| row.kubelka_munk_delta_e() > OFF);
    let off: Vec<String> =
        off.map(|row| format!("{:.1} over {}", row.kubelka_munk_delta_e(), row.place())).collect();
    if !off.is_empty() {
        let off = off.join(", ");
        messages::print_note(&format!("Kubelka-Munk with Saunderson's correction is off by ΔE*ab {off}"));
    }
}

impl Row {
    /// The ground in words.
    fn place(&self) -> &'static str {
        if self.ground == "below" { "the file's ground" } else { self.ground }
    }
}

/// Whether a file is to be a picture, by the end of its name.
fn is_picture(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|found| found.eq_ignore_ascii_case(extension))
}
