//! Options of `translucid measure`, and what they say together.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, ValueEnum};
use translucid_measure::{Card, Scale};

use super::scene_arguments::SceneArguments;
use crate::failure::Failure;
use crate::model::ConfigurationName;

const EXAMPLES: &str = "\
The photograph shows a flat piece in even light, half of it under an opaque card. The distance that light spreads
below the card determines the mean free path; white paper of known reflectance beside the piece determines the
surface albedo. With --setup spot a small round spot of light falls on a dark piece, and the size of the glow around
it determines the mean free path. docs/guide/measure.md describes the setups.
With --scene the piece has any known shape, and the renderer finds the parameters that reproduce the photograph.

Columns: channel, quantity, value, from and to of 68 % and of 95 % confidence, unit.

Examples:
  translucid measure soap.png --mm-per-pixel 0.042 --white 100,80,400,260 --white-reflectance 0.9
  translucid measure soap.exr --mm-per-pixel 0.042 --surface-albedo 0.8 --region 900,400,2100,1600
  translucid measure soap.png --mm-per-pixel 0.042 --white-photo paper.png --format toml
  translucid measure laser.exr --setup spot --mm-per-pixel 0.042 --white-photo laser-on-paper.exr
  translucid measure ball.exr --scene ball.toml --fit material.surface_albedo,material.mfp";

/// Measures surface albedo and mean free path in a photograph
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct MeasureArguments {
    /// Photograph: OpenEXR or Radiance HDR (linear), PNG, TIFF or JPEG (sRGB)
    #[arg(value_name = "PHOTO")]
    pub(super) photo: PathBuf,
    /// Setup of the photograph: the thing that shapes the light on the piece
    #[arg(long, value_enum, default_value = "edge")]
    pub(super) setup: SetupName,
    /// Thickness of the slab [mm]
    #[arg(long, value_name = "MM", value_parser = parse_positive, required_if_eq("setup", "slab"))]
    pub(super) thickness: Option<f64>,
    /// Width of a pixel on the piece [mm]
    #[arg(long, value_name = "MM", value_parser = parse_positive)]
    pub(super) mm_per_pixel: Option<f64>,
    /// In its place two points of the photograph and the distance between them [mm]
    #[arg(long, value_name = "X0,Y0,X1,Y1,MM", value_parser = parse_ruler, conflicts_with = "mm_per_pixel")]
    pub(super) ruler: Option<[f64; 5]>,
    /// White card in the photograph, in the same light [default: none, and no surface albedo is measured]
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse_rectangle)]
    pub(super) white: Option<[usize; 4]>,
    /// Another photograph with the same exposure and light and white paper in place of the piece: it corrects uneven light and
    /// dark corners of the lens, and measures the power of a spot
    #[arg(long, value_name = "PHOTO", conflicts_with_all = ["white", "exposure"])]
    pub(super) white_photo: Option<PathBuf>,
    /// Reflectance of the white paper, in (0, 1]: one or three, comma-separated [default: 0.9, or 1 for the panel behind a slab]
    #[arg(long, value_name = "R", value_delimiter = ',')]
    pub(super) white_reflectance: Vec<f64>,
    /// Surface albedo in place of a white card, in (0, 1): one or three; the mean free path depends on it a little
    #[arg(long, value_name = "A", value_delimiter = ',', conflicts_with_all = ["white", "white_photo"])]
    pub(super) surface_albedo: Vec<f64>,
    /// Part of the photograph that shows the edge and nothing else [default: all of it]
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse_rectangle)]
    pub(super) region: Option<[usize; 4]>,
    /// Two points of the card's edge [default: found]
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse_points)]
    pub(super) edge: Option<[f64; 4]>,
    /// Middle of the spot [default: found]
    #[arg(long, value_name = "X,Y", value_parser = parse_point, conflicts_with = "edge")]
    pub(super) center: Option<[f64; 2]>,
    /// Place of the card: outside the picture, as with a projector (hidden), or on the dark side (visible)
    /// [default: found]
    #[arg(long, value_enum)]
    pub(super) card: Option<CardName>,
    /// Another exposure of the same view, merged with the first; may be repeated
    #[arg(long, value_name = "PHOTO", conflicts_with = "dark")]
    pub(super) exposure: Vec<PathBuf>,
    /// Photograph with the light off and the same exposure, which is subtracted
    #[arg(long, value_name = "PHOTO")]
    pub(super) dark: Option<PathBuf>,
    /// Read integer files as linear instead of sRGB
    #[arg(long)]
    pub(super) linear: bool,
    /// Surface of the piece: matt (diffuse), or clear, in light from all around and seen from straight above (searchlight)
    #[arg(long, value_enum, default_value = "diffuse")]
    pub(super) configuration: ConfigurationName,
    /// Angle between a lamp's rays and the normal of a clear piece, seen from straight above, in (-90, 90) degrees: positive
    /// if the rays run from the dark side to the lit one
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true, conflicts_with = "configuration",
        value_parser = parse_angle)]
    pub(super) incidence: Option<f64>,
    /// Relative refractive index of a smooth surface, in [0.5, 3]; 1 is index-matched
    #[arg(long, value_name = "ETA", default_value_t = 1.0)]
    pub(super) eta: f64,
    /// Mean cosine of scattering, in (-1, 1); the mean free path is that of the similar medium
    #[arg(long, value_name = "G", default_value_t = 0.0, allow_negative_numbers = true)]
    pub(super) g: f64,
    /// Directory for a page with the fit, its residuals and the measured place in the photograph
    #[arg(long, value_name = "DIR")]
    pub(super) page: Option<PathBuf>,
    /// File to write instead of stdout
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
    /// How to print
    #[arg(long, value_enum, default_value = "text")]
    pub(super) format: MeasureFormat,
    #[command(flatten, next_help_heading = "Known shape")]
    pub(super) shape: SceneArguments,
}

/// How a measurement is printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum MeasureFormat {
    /// For people
    Text,
    /// Comma-separated values after a header line
    Csv,
    /// An array with one object a row
    Json,
    /// A material for scene files
    Toml,
}

/// Setup of a photograph, named by the thing that shapes the light on the piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum SetupName {
    /// An opaque card that covers half of the piece
    Edge,
    /// A small round spot of light
    Spot,
    /// An opaque card between a slab and a panel of light behind it, which it covers in half
    Slab,
}

/// Place of the card whose edge is photographed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum CardName {
    /// Out of the picture: the dark side shows the piece, in shadow
    Hidden,
    /// On the piece: the dark side shows the card
    Visible,
}

impl From<CardName> for Card {
    fn from(name: CardName) -> Self {
        match name {
            CardName::Hidden => Self::Hidden,
            CardName::Visible => Self::Visible,
        }
    }
}

/// Surface albedo of the shape where none is known.
const USUAL_ALBEDO: f64 = 0.7;

impl MeasureArguments {
    /// Refuses options that belong to another setup.
    pub(super) fn check_setup(&self) -> Result<(), Failure> {
        let is = |setup| self.setup == setup;
        let given = [
            (self.edge.is_some() && is(SetupName::Spot), "--edge is for --setup edge and slab"),
            (self.card.is_some() && !is(SetupName::Edge), "--card is for --setup edge"),
            (self.center.is_some() && !is(SetupName::Spot), "--center is for --setup spot"),
            (self.thickness.is_some() && !is(SetupName::Slab), "--thickness is for --setup slab"),
            (self.incidence.is_some() && is(SetupName::Slab), "--incidence is for --setup edge and spot"),
            (
                self.white.is_some() && is(SetupName::Spot),
                "--white is for --setup edge and slab: the power of a spot is measured on white paper in its place, --white-photo",
            ),
            (
                self.eta != 1.0 && is(SetupName::Slab),
                "--setup slab is for --eta 1: light between two boundaries is not solved exactly here",
            ),
        ];
        given
            .iter()
            .find(|(is_wrong, _)| *is_wrong)
            .map_or(Ok(()), |(_, message)| Err(Failure::input(*message)))
    }

    /// Width of a pixel \[mm\].
    pub(super) fn mm_per_pixel(&self) -> Result<f64, Failure> {
        match (self.mm_per_pixel, self.ruler) {
            (Some(width), _) => Ok(width),
            (None, Some([x0, y0, x1, y1, distance])) => Ok(distance / (x1 - x0).hypot(y1 - y0)),
            (None, None) => {
                let message = "the scale is missing: --mm-per-pixel, --ruler or --scene";
                Err(Failure::input(message).with_help(
                    "state a pixel's width by --mm-per-pixel 0.04, a distance by --ruler X0,Y0,X1,Y1,MM, or, of a known \
                     shape, its scene by --scene and what to find by --fit",
                ))
            }
        }
    }

    /// Scale of the light: reflectances where something white is seen, otherwise shares of its own with the surface albedos
    /// that are given.
    pub(super) fn scale(&self) -> Result<Scale, Failure> {
        if self.white.is_some() || self.white_photo.is_some() {
            return Ok(Scale::Reflectance);
        }
        if self.surface_albedo.is_empty() {
            return Ok(Scale::Relative([USUAL_ALBEDO; 3]));
        }
        three("--surface-albedo", &self.surface_albedo, 0.9999).map(Scale::Relative)
    }
}

/// One or three numbers in (0, `most`].
pub(super) fn three(option: &str, values: &[f64], most: f64) -> Result<[f64; 3], Failure> {
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

fn parse_positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number| *number > 0.0 && *number <= 1e6);
    number.ok_or_else(|| String::from("a width is a number of mm in (0, 1e6]"))
}

/// So many numbers with commas between them.
fn numbers<T: FromStr, const N: usize>(text: &str) -> Option<[T; N]> {
    let numbers: Option<Vec<T>> = text.split(',').map(|text| text.trim().parse().ok()).collect();
    numbers?.try_into().ok()
}

fn parse_rectangle(text: &str) -> Result<[usize; 4], String> {
    match numbers(text) {
        Some([x0, y0, x1, y1]) if x0 < x1 && y0 < y1 => Ok([x0, y0, x1, y1]),
        _ => Err(String::from(
            "a rectangle is X0,Y0,X1,Y1 in pixels with X0 < X1 and Y0 < Y1, like 100,50,300,200",
        )),
    }
}

fn parse_ruler(text: &str) -> Result<[f64; 5], String> {
    match numbers::<f64, _>(text) {
        Some([x0, y0, x1, y1, mm])
            if [x0, y0, x1, y1, mm].iter().all(|v| v.abs() < 1e6) && (x0, y0) != (x1, y1) && mm > 0.0 =>
        {
            Ok([x0, y0, x1, y1, mm])
        }
        _ => Err(String::from(
            "a ruler is X0,Y0,X1,Y1,MM: two points in pixels that are apart, and their distance in mm, like \
             100,50,1100,55,30",
        )),
    }
}

fn parse_angle(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|angle: &f64| angle.abs() < 90.0);
    number.ok_or_else(|| String::from("an angle is a number of degrees in (-90, 90)"))
}

fn parse_point(text: &str) -> Result<[f64; 2], String> {
    match numbers::<f64, _>(text) {
        Some([x, y]) if x.is_finite() && y.is_finite() => Ok([x, y]),
        _ => Err(String::from("a point is X,Y in pixels, like 320,240.5")),
    }
}

fn parse_points(text: &str) -> Result<[f64; 4], String> {
    match numbers::<f64, _>(text) {
        Some([x0, y0, x1, y1]) if [x0, y0, x1, y1].iter().all(|v| v.is_finite()) => Ok([x0, y0, x1, y1]),
        _ => Err(String::from("two points are X0,Y0,X1,Y1 in pixels, like 100,50,120.5,200")),
    }
}
