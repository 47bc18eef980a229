//! `translucid measure`: a material's numbers from a photograph.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use translucid_image::check_writable;
use translucid_laboratory::Cell;
use translucid_measure::{EdgeFit, EdgeLine, Interval, NoEdge, Photo, Response, Scale};
use translucid_reference::Incidence;
use translucid_scene::{ColorSpace, Pixels, Place, load_image};

use crate::failure::Failure;
use crate::files::write_file;
use crate::messages;
use crate::model::ConfigurationName;
use crate::table::{TableFormat, exact, print};

const EXAMPLES: &str = "\
The photograph shows a flat piece, half of it under an opaque card, in light that falls on all of it evenly:
how far light creeps below the card is the mean free path. A white card of known reflectance beside it
makes the brightness of the lit half a surface albedo. How to set it up: docs/guide/measure.md.

Columns: channel, quantity, value, from and to of 68 % and of 95 % confidence, unit.

Examples:
  translucid measure soap.png --mm-per-pixel 0.042 --white 100,80,400,260 --white-reflectance 0.9
  translucid measure soap.exr --mm-per-pixel 0.042 --surface-albedo 0.8 --region 900,400,2100,1600
  translucid measure soap.png --mm-per-pixel 0.042 --white 100,80,400,260 --format toml";

/// Measures surface albedo and mean free path in a photograph of an edge of light
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct MeasureArguments {
    /// Photograph: OpenEXR or Radiance HDR (linear), PNG or JPEG (sRGB)
    #[arg(value_name = "PHOTO")]
    photo: PathBuf,
    /// Width of a pixel on the piece \[mm\]
    #[arg(long, value_name = "MM", value_parser = parse_positive)]
    mm_per_pixel: f64,
    /// White card in the photograph, in the same light [default: none, and no surface albedo is measured]
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse_rectangle)]
    white: Option<[usize; 4]>,
    /// Reflectance of the white card, in (0, 1]: one or three, comma-separated
    #[arg(long, value_name = "R", value_delimiter = ',', default_value = "0.9", requires = "white")]
    white_reflectance: Vec<f64>,
    /// Surface albedo where no white card is seen, in (0, 1): one or three; the shape hardly depends on it
    #[arg(long, value_name = "A", value_delimiter = ',', conflicts_with = "white")]
    surface_albedo: Vec<f64>,
    /// Part of the photograph that holds the edge and nothing else [default: all of it]
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse_rectangle)]
    region: Option<[usize; 4]>,
    /// Two points of the card's edge [default: found]
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse_points)]
    edge: Option<[f64; 4]>,
    /// Photograph with the light off and the same exposure, which is subtracted
    #[arg(long, value_name = "PHOTO")]
    dark: Option<PathBuf>,
    /// Whether values of integers are linear instead of sRGB
    #[arg(long)]
    linear: bool,
    /// How light falls: from all around (diffuse), or along the surface's normal (searchlight)
    #[arg(long, value_enum, default_value = "diffuse")]
    configuration: ConfigurationName,
    /// File to write instead of stdout
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// How to print
    #[arg(long, value_enum, default_value = "text")]
    format: MeasureFormat,
}

/// How a measurement is printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum MeasureFormat {
    /// For people
    Text,
    /// Comma-separated values after a header line
    Csv,
    /// An array with one object a row
    Json,
    /// A material for scene files
    Toml,
}

/// Names of the channels.
const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// Surface albedo of the shape where none is known.
const USUAL_ALBEDO: f64 = 0.7;

/// Share of pixels at the end of their range from which on a photograph counts as clipped.
const CLIPPED: f64 = 1e-3;

/// Mean square of residuals over the noise from which on the model does not explain the light.
const MISFIT: f64 = 2.0;

/// Runs the verb.
pub(crate) fn run(arguments: &MeasureArguments) -> Result<(), Failure> {
    if let Some(path) = &arguments.output {
        check_writable(path)?;
    }
    let scale = scale(arguments)?;
    let path = &arguments.photo;
    let mut photo = load(path, arguments)?;
    if let Some(dark) = &arguments.dark {
        subtract(&mut photo, &load(dark, arguments)?).map_err(|message| refusal(dark, message))?;
    }
    if let Some(white) = arguments.white {
        let reflectances = three("--white-reflectance", &arguments.white_reflectance, 1.0)?;
        let card = part(&photo, path, "--white", white)?.mean();
        if let Some(c) = (0..3).find(|&c| card[c] <= 0.0) {
            return Err(refusal(path, format!("--white: {} is {} there", CHANNELS[c], card[c])));
        }
        let gains: [f64; 3] = std::array::from_fn(|c| reflectances[c] / card[c]);
        for pixel in &mut photo.pixels {
            for (value, gain) in pixel.iter_mut().zip(gains) {
                *value = (f64::from(*value) * gain) as f32;
            }
        }
    }
    let whole = [0, 0, photo.width, photo.height];
    let region = arguments.region.unwrap_or(whole);
    let piece = part(&photo, path, "--region", region)?;
    let line = match arguments.edge {
        Some([x0, y0, x1, y1]) => {
            let [left, top] = [region[0] as f64, region[1] as f64];
            EdgeLine::through(&piece, [x0 - left, y0 - top, x1 - left, y1 - top])
                .ok_or_else(|| Failure::input("--edge: both points are the same"))?
        }
        None => EdgeLine::find(&piece).map_err(|fault| no_edge(path, fault))?,
    };
    let angle = line.across[1].atan2(line.across[0]).to_degrees();
    messages::line(&format!(
        "edge through ({:.1}, {:.1}), light at {angle:.1}° below the right",
        line.point[0] + region[0] as f64,
        line.point[1] + region[1] as f64
    ));
    let samples = line.samples(&piece, arguments.mm_per_pixel);
    let incidence = Incidence::from(translucid_profile::Configuration::from(arguments.configuration));
    let response = Response::new(1.0, incidence).map_err(|error| Failure::work(error.to_string()))?;
    let fit = EdgeFit::new(&samples, &response, scale).ok_or_else(|| {
        refusal(path, "nothing gets brighter across the edge, or it has fewer than 16 pixels on a side")
    })?;
    if fit.channels.iter().all(|channel| !channel.is_seen) {
        let message = format!(
            "no scattering is seen: the edge is as sharp as a blur of {} mm makes it",
            three_digits(fit.blur)
        );
        return Err(refusal(path, message).with_help("come closer, so that light creeps over several pixels"));
    }
    remarks(&fit, &samples.places, scale);
    let text = match arguments.format {
        MeasureFormat::Text => paragraphs(&fit),
        MeasureFormat::Csv => TableFormat::Csv.text(&COLUMNS, &rows(&fit)),
        MeasureFormat::Json => TableFormat::Json.text(&COLUMNS, &rows(&fit)),
        MeasureFormat::Toml => material(&fit, scale, path),
    };
    match &arguments.output {
        Some(path) => write_file(path, text.as_bytes()),
        None => print(&text),
    }
}

fn scale(arguments: &MeasureArguments) -> Result<Scale, Failure> {
    if arguments.white.is_some() {
        return Ok(Scale::Reflectance);
    }
    if arguments.surface_albedo.is_empty() {
        return Ok(Scale::Relative([USUAL_ALBEDO; 3]));
    }
    three("--surface-albedo", &arguments.surface_albedo, 0.9999).map(Scale::Relative)
}

/// One or three numbers in (0, `most`].
fn three(option: &str, values: &[f64], most: f64) -> Result<[f64; 3], Failure> {
    if let Some(wrong) = values.iter().find(|value| !(**value > 0.0 && **value <= most)) {
        return Err(Failure::input(format!("{option} is {wrong}, but must be in (0, {most}]")));
    }
    match *values {
        [one] => Ok([one; 3]),
        [r, g, b] => Ok([r, g, b]),
        _ => {
            Err(Failure::input(format!("{option} has {} numbers, but must have one or three", values.len())))
        }
    }
}

/// A photograph in linear numbers.
fn load(path: &Path, arguments: &MeasureArguments) -> Result<Photo, Failure> {
    let color_space = if arguments.linear { ColorSpace::Linear } else { ColorSpace::Srgb };
    let mut warnings = Vec::new();
    let image = load_image(path, color_space, &mut warnings)?;
    messages::print_warnings(&warnings);
    if let Pixels::Byte(pixels) = &image.pixels {
        let ends = pixels.iter().flat_map(|p| &p[..3]).filter(|v| **v == u8::MAX).count();
        let share = ends as f64 / (3 * pixels.len()) as f64;
        if share > CLIPPED {
            let message = format!(
                "{}: {:.1} % of the values are at the end of their range, where light is lost: \
                 expose less, or leave them out by --region",
                path.display(),
                100.0 * share
            );
            messages::print_warning(&message);
        }
        if color_space == ColorSpace::Srgb {
            let message = format!(
                "{}: 8-bit values are taken as sRGB; cameras bend them at will, so lengths may be off by tens of \
                 percent: better develop the raw file to linear OpenEXR",
                path.display()
            );
            messages::print_warning(&message);
        }
    }
    let pixel = |x: usize, y: usize| {
        let [r, g, b, _] = image.texel(x as u32, y as u32);
        [r, g, b]
    };
    Ok(Photo::from_fn(image.width as usize, image.height as usize, pixel))
}

fn subtract(photo: &mut Photo, dark: &Photo) -> Result<(), String> {
    let [size, of_dark] = [&*photo, dark].map(|photo| [photo.width, photo.height]);
    if size != of_dark {
        let [w, h] = of_dark;
        return Err(format!("is {w}×{h} pixels, but the photograph is {}×{}", size[0], size[1]));
    }
    for (pixel, dark) in photo.pixels.iter_mut().zip(&dark.pixels) {
        for (value, dark) in pixel.iter_mut().zip(dark) {
            *value -= dark;
        }
    }
    Ok(())
}

fn part(photo: &Photo, path: &Path, option: &str, rectangle: [usize; 4]) -> Result<Photo, Failure> {
    let [_, _, x1, y1] = rectangle;
    if x1 > photo.width || y1 > photo.height {
        let message = format!(
            "{option} ends at {x1},{y1}, but the photograph is {}×{} pixels",
            photo.width, photo.height
        );
        return Err(refusal(path, message));
    }
    Ok(photo.part(rectangle))
}

fn no_edge(path: &Path, fault: NoEdge) -> Failure {
    let message = match fault {
        NoEdge::TooSmall => String::from("fewer than 16 pixels on a side"),
        NoEdge::NoContrast(contrast) => format!(
            "no edge of light: the brightest tenth is {contrast:.2} times as bright as the darkest, and must be 1.5 times"
        ),
        NoEdge::NotStraight(distance) if distance.is_finite() => {
            format!("no straight edge: where light is half as bright is {distance:.0} pixels off a line")
        }
        NoEdge::NotStraight(_) => String::from("no edge that goes through the picture from side to side"),
    };
    refusal(path, message).with_help("show the edge alone by --region, or where it is by --edge")
}

/// What limits the measurement, in plain sentences.
fn remarks(fit: &EdgeFit, places: &[f64], scale: Scale) {
    if let Scale::Relative(albedos) = scale {
        let shown = albedos.map(|a| a.to_string()).join(", ");
        messages::print_note(&format!(
            "without a white card only lengths are measured, for surface albedos of {shown}"
        ));
    }
    let extent = places.last().zip(places.first()).map_or(0.0, |(last, first)| last - first);
    for (name, channel) in CHANNELS.iter().zip(&fit.channels) {
        let [low, high] = channel.mfp.sure;
        if !channel.is_seen {
            messages::print_warning(&format!(
                "{name}: no scattering is seen: the edge is as sharp as a blur of {} mm makes it: come closer",
                three_digits(fit.blur)
            ));
        } else if high > 2.0 * low {
            messages::print_note(&format!(
                "{name}: the edge does not tell the mean free path: it may be {} to {} mm",
                three_digits(low),
                three_digits(high)
            ));
        } else if channel.mfp.value > extent / 15.0 {
            messages::print_warning(&format!(
                "{name}: light creeps {} mm and more, farther than the {extent:.0} mm that are seen show: step back",
                three_digits(channel.mfp.value)
            ));
        } else if channel.mfp.value < fit.blur {
            messages::print_warning(&format!(
                "{name}: the picture's blur of {} mm hides a mean free path of {} mm: come closer",
                three_digits(fit.blur),
                three_digits(channel.mfp.value)
            ));
        }
        if channel.surface_albedo.is_some_and(|albedo| albedo.value >= 1.0) {
            messages::print_warning(&format!(
                "{name}: brighter than any surface in the light of the white card: is a highlight in the way, or \
                 --white-reflectance too high?"
            ));
        }
    }
    if fit.misfit > MISFIT {
        messages::print_warning(&format!(
            "the light is not that of an even, thick, isotropic piece: what is left is {:.1} times the noise (layers, \
             strong forward scattering, a rough or bent surface, a second light?)",
            fit.misfit.sqrt()
        ));
    }
}

const COLUMNS: [&str; 8] = ["channel", "quantity", "value", "from_68", "to_68", "from_95", "to_95", "unit"];

fn rows(fit: &EdgeFit) -> Vec<Vec<Cell>> {
    let row = |channel: &str, quantity: &str, interval: Interval, unit: &str| {
        let Interval { value, likely, sure } = interval;
        let numbers = [value, likely[0], likely[1], sure[0], sure[1]].map(Cell::from);
        let words = [Cell::from(channel), Cell::from(quantity)];
        words.into_iter().chain(numbers).chain([Cell::from(unit)]).collect()
    };
    let of_channel = |(name, channel): (&&str, &translucid_measure::ChannelFit)| {
        let albedo = channel.surface_albedo.map(|albedo| row(name, "surface_albedo", albedo, ""));
        let mfp = channel.is_seen.then(|| row(name, "mfp", channel.mfp, "mm"));
        [mfp, albedo].into_iter().flatten().collect::<Vec<_>>()
    };
    CHANNELS.iter().zip(&fit.channels).flat_map(of_channel).collect()
}

fn paragraphs(fit: &EdgeFit) -> String {
    let mut text = String::new();
    for (name, channel) in CHANNELS.iter().zip(&fit.channels) {
        let shown = |interval: Interval| {
            let [low, high] = interval.sure.map(three_digits);
            format!("{} ({low} to {high})", three_digits(interval.value))
        };
        if channel.is_seen {
            let _ = write!(text, "{name:<6} mean free path {} mm", shown(channel.mfp));
        } else {
            let _ = write!(text, "{name:<6} mean free path not seen");
        }
        if let Some(albedo) = channel.surface_albedo {
            let _ = write!(text, ", surface albedo {}", shown(albedo));
            let _ = write!(text, ", correlation {:+.2}", channel.correlation);
        }
        let _ = writeln!(text, ", stray light {:.1} %", 100.0 * channel.stray);
    }
    let _ = writeln!(
        text,
        "\nIn parentheses the 95 % confidence interval. Blur {} mm; residuals {:.2} times the noise.",
        three_digits(fit.blur),
        fit.misfit.sqrt()
    );
    text
}

fn material(fit: &EdgeFit, scale: Scale, photo: &Path) -> String {
    let list = |values: [f64; 3]| values.map(three_digits).join(", ");
    let albedos = match scale {
        Scale::Relative(albedos) => albedos,
        Scale::Reflectance => {
            fit.channels.map(|channel| channel.surface_albedo.map_or(0.0, |a| a.value.min(1.0)))
        }
    };
    let name = photo.file_stem().unwrap_or_default().to_string_lossy().replace(['"', '\\'], "_");
    format!(
        "unit = \"mm\"\n\n[[material]]\nname = \"{name}\"\nsubsurface_weight = 1\nsubsurface_color = [{}]\n\
         subsurface_radius = 1\nsubsurface_radius_scale = [{}]\n",
        list(albedos),
        // A surface whose scattering is not seen is Lambertian
        list(fit.channels.map(|channel| if channel.is_seen { channel.mfp.value } else { 0.0 }))
    )
}

/// A fault of a photograph.
fn refusal(path: &Path, message: impl Into<String>) -> Failure {
    Failure { place: Some(Place::file(path)), ..Failure::input(message) }
}

/// A number with three significant digits.
fn three_digits(value: f64) -> String {
    format!("{value:.2e}").parse::<f64>().map_or_else(|_| value.to_string(), exact)
}

fn parse_positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number| *number > 0.0 && *number <= 1e6);
    number.ok_or_else(|| String::from("a width is a number of mm in (0, 1e6]"))
}

fn parse_rectangle(text: &str) -> Result<[usize; 4], String> {
    let numbers: Option<Vec<usize>> = text.split(',').map(|text| text.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x0, y0, x1, y1]) if x0 < x1 && y0 < y1 => Ok([x0, y0, x1, y1]),
        _ => Err(String::from(
            "a rectangle is X0,Y0,X1,Y1 in pixels with X0 < X1 and Y0 < Y1, like 100,50,300,200",
        )),
    }
}

fn parse_points(text: &str) -> Result<[f64; 4], String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|text| text.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x0, y0, x1, y1]) if [x0, y0, x1, y1].iter().all(|v| v.is_finite()) => Ok([x0, y0, x1, y1]),
        _ => Err(String::from("two points are X0,Y0,X1,Y1 in pixels, like 100,50,120.5,200")),
    }
}
