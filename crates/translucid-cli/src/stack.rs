//! `translucid stack`: the color of layers over grounds.

mod file;
mod output;
mod spectra;

use std::path::PathBuf;

use clap::Args;
use translucid_laboratory::colorimetry::{Colorimeter, Illuminant, Observer, delta_e_2000, delta_e_ab};
use translucid_laboratory::stack::{Color, MEANINGS, Measurement, Specular};
use translucid_reference::layers::Ground;

use self::file::{Stack, StackFile};
use crate::failure::Failure;
use crate::files::input_among;
use crate::messages;
use crate::table::ReadableFormat;

const EXAMPLES: &str = "\
The file is that of reference --layers, in which a number may also be three, for red, green and blue (linear Rec. 709), or a
table over wavelengths in nm, and a layer may be a filament by its color and transmission distance. [grounds] has the
reflectances of black and white.

Columns: ground (black, white, below: that of the file), reflectance and transmittance (of luminance), X, Y, Z, L, a, b, srgb,
in_srgb (no where srgb is only the nearest color of a display), error (numerical, at most, in Delta E*ab),
kubelka_munk_reflectance (with Saunderson's correction), kubelka_munk_delta_e (its distance from the color in Delta E*ab); then,
the same in each row, tp_ab and tp_2000 (Delta E*ab and CIEDE2000 between the layers over white and over black) and
contrast_ratio (Y over black / Y over white).

Everything is what an instrument of the geometry d:8 measures: light from everywhere, viewed at 8 degrees.

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
    /// Light: daylight of 6504 K, that of printing of 5003 K, or incandescent light
    #[arg(long, value_parser = ["d65", "d50", "a"], default_value = "d65")]
    illuminant: String,
    /// Field of view of the observer in degrees: CIE 1931 or CIE 1964
    #[arg(long, value_parser = ["2", "10"], default_value = "2")]
    observer: String,
    /// Light that returns without having been scattered: included is what recipes and quality control use
    #[arg(long, value_parser = ["included", "excluded"], default_value = "included")]
    specular: String,
    /// Print reflectances and transmittances by wavelength or channel instead of colors
    #[arg(long)]
    channels: bool,
    /// File to write instead of stdout; a .svg or .png file is a swatch, beside the table on stdout
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// How to print
    #[arg(long, value_enum, default_value = "csv")]
    format: ReadableFormat,
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
    fn new(stack: &Stack, specular: Specular, eye: &Colorimeter) -> Result<Self, Failure> {
        let measured =
            Measurement::new(&stack.layers, specular).map_err(|error| Failure::input(error.to_string()))?;
        if measured.errors.iter().any(|error| *error > 1e-2) {
            let message = "these layers have no exact solution: their coefficients are too far apart";
            return Err(Failure::work(message));
        }
        let color = Color::new(eye, &measured.reflectance);
        let is_open = stack.layers.iter().all(|layers| matches!(layers.ground(), Ground::Medium { .. }));
        let transmittance = Color::new(eye, &measured.transmittance).xyz[1] / 100.0;
        Ok(Self {
            ground: stack.ground,
            bare: Color::new(eye, &stack.bare),
            color,
            transmittance: if is_open { transmittance } else { f64::NAN },
            error: color.error(eye, &measured.errors),
            kubelka_munk: Color::new(eye, &measured.kubelka_munk),
            measured,
        })
    }

    /// ΔE*ab between Kubelka and Munk's color and the exact one.
    fn kubelka_munk_delta_e(&self) -> f64 {
        delta_e_ab(self.color.lab, self.kubelka_munk.lab)
    }

    /// The ground in words.
    fn place(&self) -> &'static str {
        if self.ground == "below" { "the file's ground" } else { self.ground }
    }
}

/// Error of colors, in ΔE*ab, above which there is a warning.
const ERROR: f64 = 0.01;
/// Distance of Kubelka and Munk's color, in ΔE*ab, above which it is noted.
const OFF: f64 = 1.0;

/// Runs the verb.
pub(crate) fn run(arguments: &StackArguments) -> Result<(), Failure> {
    if arguments.channels && arguments.format == ReadableFormat::Text {
        return Err(Failure::input("--channels is a table, which --format text does not print")
            .with_help("use --format csv or json"));
    }
    let file = file::read(&arguments.file, None)?;
    let inputs = std::iter::once(&arguments.file).chain(&file.files).map(PathBuf::as_path);
    let output = arguments.output.as_deref();
    if let Some(path) = input_among(output.into_iter(), inputs) {
        let message =
            format!("--output is {}, a file that is read, and would be overwritten", path.display());
        return Err(Failure::input(message).with_help("choose another file"));
    }
    output.map_or(Ok(()), translucid_files::check_writable)?;
    let channels = file.stacks[0].layers.len();
    let eye = arguments.eye(channels)?;
    file.notes.iter().for_each(|note| messages::print_note(note));
    let specular = if arguments.specular == "included" { Specular::Included } else { Specular::Excluded };
    let solve = |file: &StackFile| {
        let row = |stack: &Stack| Row::new(stack, specular, &eye);
        file.stacks.iter().map(row).collect::<Result<Vec<Row>, Failure>>()
    };
    let rows = solve(&file)?;
    let mut spread = vec![0.0; if file.has_filaments { rows.len() } else { 0 }];
    for meaning in MEANINGS.into_iter().filter(|_| file.has_filaments) {
        for ((most, row), other) in
            spread.iter_mut().zip(&rows).zip(solve(&file::read(&arguments.file, Some(meaning))?)?)
        {
            *most = f64::max(*most, delta_e_ab(row.color.lab, other.color.lab));
        }
    }
    let error = rows.iter().map(|row| row.error).fold(0.0, f64::max);
    if error > ERROR {
        messages::print_warning(&format!("numerical errors may change colors by up to {error:.2} ΔE*ab"));
    }
    if let [black, white, _] = &rows[..]
        && black.bare.xyz[1] > white.bare.xyz[1]
    {
        messages::print_warning("grounds.black is lighter than grounds.white");
    }
    let words = kubelka_munk_words(&rows, OFF);
    if arguments.format != ReadableFormat::Text {
        words.into_iter().chain(spread_words(&rows, &spread)).for_each(|words| messages::print_note(&words));
    }
    let [observer, specular] = [&arguments.observer, &arguments.specular];
    let rgb = if channels == 3 { ", from red, green and blue" } else { "" };
    let illuminant = arguments.illuminant.to_uppercase();
    let conditions = format!("{illuminant}, {observer}° observer, d:8° with specular {specular}{rgb}");
    output::write(arguments, &rows, spread_words(&rows, &spread).as_deref(), &conditions)
}

impl StackArguments {
    fn eye(&self, channels: usize) -> Result<Colorimeter, Failure> {
        let (observer, illuminant) = (self.observer.as_str(), self.illuminant.as_str());
        if channels == 3 && (observer, illuminant) != ("2", "d65") {
            return Err(Failure::input(format!(
                "{} has values for red, green and blue, which are colors for --illuminant d65 and --observer 2 only",
                self.file.display()
            ))
            .with_help("give values over wavelengths"));
        }
        let observer = if observer == "2" { Observer::TwoDegrees } else { Observer::TenDegrees };
        Ok(Colorimeter::new(
            observer,
            match illuminant {
                "d50" => Illuminant::D50,
                "a" => Illuminant::A,
                _ => Illuminant::D65,
            },
        ))
    }
}

/// How far Kubelka and Munk are off, where it is more than a limit.
fn kubelka_munk_words(rows: &[Row], limit: f64) -> Option<String> {
    let off = rows.iter().filter(|row| row.kubelka_munk_delta_e() > limit);
    let off: Vec<String> =
        off.map(|row| format!("{:.2} over {}", row.kubelka_munk_delta_e(), row.place())).collect();
    let name = "Kubelka-Munk with Saunderson's correction is off by ΔE*ab";
    (!off.is_empty()).then(|| format!("{name} {}", off.join(", ")))
}

/// How far colors are off if transmission distances mean what other sources say, if there are any.
fn spread_words(rows: &[Row], spread: &[f64]) -> Option<String> {
    let off: Vec<String> =
        rows.iter().zip(spread).map(|(row, off)| format!("{off:.2} over {}", row.place())).collect();
    let parts = MEANINGS.map(|part| format!("{part:.2}")).join(", ");
    let name = "transmission distances of other meanings, transmitted";
    (!off.is_empty()).then(|| format!("{name} {parts}, change colors by up to ΔE*ab {}", off.join(", ")))
}

/// ΔE*ab and CIEDE2000 between the layers over white and over black, and Y over black divided by Y over white; not numbers
/// below an endless layer.
fn contrast(rows: &[Row]) -> [f64; 3] {
    let [black, white, _] = rows else { return [f64::NAN; 3] };
    let (black, white) = (black.color, white.color);
    [delta_e_ab(black.lab, white.lab), delta_e_2000(black.lab, white.lab), black.xyz[1] / white.xyz[1]]
}
