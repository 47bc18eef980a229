//! Options of `translucid measure`, and what they say together.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, ValueEnum};
use translucid_measure::{Card, Options, Setup};

use super::scene_arguments::SceneArguments;
use crate::model::ConfigurationName;

const EXAMPLES: &str = "\
The photograph shows a flat piece in even light, half of it under an opaque card. The distance that light spreads
below the card determines the mean free path; white paper of known reflectance beside the piece determines the
surface albedo. With --setup spot a small round spot of light falls on a dark piece, and the size of the glow around
it determines the mean free path. docs/guide/measure.md describes the setups.
With --scene the piece has any known shape, and the renderer finds the parameters that reproduce the photograph.

Columns: channel, quantity, value, from and to of 68 % and of 95 % confidence, unit.

Examples:
  translucid measure examples/photographs/soap.png --mm-per-pixel 0.125 --white 210,18,222,30
  translucid measure examples/photographs/soap.png --mm-per-pixel 0.125 --surface-albedo 0.85,0.6,0.35 --format toml
  translucid measure examples/photographs/slice.png --setup slab --thickness 1.5 --mm-per-pixel 0.1 --surface-albedo 0.85,0.75,0.6 --format layers
  translucid measure examples/photographs/laser.png --setup spot --mm-per-pixel 0.1 --white-photo examples/photographs/paper.png
  translucid measure examples/photographs/ball.png --scene examples/photographs/ball.toml --fit material.surface_albedo,material.mfp";

/// Measures surface albedo and mean free path in a photograph
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct MeasureArguments {
    /// Photograph: OpenEXR or Radiance HDR (linear), PNG, TIFF or JPEG (sRGB)
    #[arg(value_name = "PHOTO")]
    pub(super) photo: PathBuf,
    /// Setup of the photograph: the thing that shapes the light on the piece
    #[arg(long, value_enum, default_value = "edge")]
    setup: SetupName,
    /// Thickness of the slab [mm]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    thickness: Option<f64>,
    /// Width of a pixel on the piece [mm]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    mm_per_pixel: Option<f64>,
    /// In its place two points of the photograph and the distance between them [mm]
    #[arg(long, value_name = "X0,Y0,X1,Y1,MM", value_parser = parse_ruler)]
    ruler: Option<[f64; 5]>,
    /// White card in the photograph, in the same light [default: none, and no surface albedo is measured]
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse_rectangle)]
    white: Option<[usize; 4]>,
    /// Another photograph with the same exposure and light and white paper in place of the piece: it corrects uneven light and
    /// dark corners of the lens, and measures the power of a spot
    #[arg(long, value_name = "PHOTO")]
    pub(super) white_photo: Option<PathBuf>,
    /// Reflectance of the white paper, in (0, 1]: one or three, comma-separated [default: 0.9, or 1 for the panel behind a slab]
    #[arg(long, value_name = "R", value_delimiter = ',')]
    white_reflectance: Vec<f64>,
    /// Relative standard error of that reflectance, in [0, 0.5] [default: 0.02, or 0 for the panel behind a slab]
    #[arg(long, value_name = "E", allow_negative_numbers = true)]
    white_tolerance: Option<f64>,
    /// Surface albedo in place of a white card, in (0, 1): one or three; the mean free path depends on it
    #[arg(long, value_name = "A", value_delimiter = ',')]
    surface_albedo: Vec<f64>,
    /// Part of the photograph that shows the edge and nothing else [default: all of it but the white card]
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse_rectangle)]
    pub(super) region: Option<[usize; 4]>,
    /// Two points of the card's edge [default: found]
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse_points)]
    edge: Option<[f64; 4]>,
    /// Center of the spot [default: found]
    #[arg(long, value_name = "X,Y", value_parser = parse_point)]
    center: Option<[f64; 2]>,
    /// Place of the card: outside the picture, as with a projector (hidden), or on the dark side (visible)
    /// [default: found]
    #[arg(long, value_enum)]
    card: Option<CardName>,
    /// Another exposure of the same view, merged with the first; may be repeated
    #[arg(long, value_name = "PHOTO")]
    pub(super) exposure: Vec<PathBuf>,
    /// Photograph with the light off and the same exposure, which is subtracted
    #[arg(long, value_name = "PHOTO")]
    pub(super) dark: Option<PathBuf>,
    /// Read integer files as linear instead of sRGB
    #[arg(long)]
    pub(super) linear: bool,
    /// Surface of the piece: matt (diffuse), or clear, in light from all around and seen from straight above (searchlight)
    /// [default: diffuse]
    #[arg(long, value_enum)]
    configuration: Option<ConfigurationName>,
    /// Angle between a lamp's rays and the normal of a clear piece, seen from straight above, in (-90, 90) degrees: positive
    /// if the rays run from the dark side to the lit one
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    incidence: Option<f64>,
    /// Relative refractive index of a smooth surface, in [0.5, 3]; 1 is index-matched
    #[arg(long, value_name = "ETA", default_value_t = 1.0)]
    eta: f64,
    /// Mean cosine of scattering, in (-1, 1); the mean free path is that of the similar medium
    #[arg(long, value_name = "G", default_value_t = 0.0, allow_negative_numbers = true)]
    g: f64,
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
    /// A file of layers for stack and reference --layers: the slab, or an endless layer
    Layers,
}

/// Setup of a photograph, named by the thing that shapes the light on the piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum SetupName {
    /// An opaque card that covers half of the piece
    Edge,
    /// A small round spot of light
    Spot,
    /// An opaque card between a slab and a panel of light behind it, which it covers in half
    Slab,
}

/// Place of the card whose edge is photographed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum CardName {
    /// Out of the picture: the dark side shows the piece, in shadow
    Hidden,
    /// On the piece: the dark side shows the card
    Visible,
}

impl MeasureArguments {
    /// The options without those of files.
    pub(super) fn options(&self) -> Options {
        Options {
            setup: match self.setup {
                SetupName::Edge => Setup::Edge,
                SetupName::Spot => Setup::Spot,
                SetupName::Slab => Setup::Slab,
            },
            thickness: self.thickness,
            mm_per_pixel: self.mm_per_pixel,
            ruler: self.ruler,
            white: self.white,
            white_reflectance: self.white_reflectance.clone(),
            white_tolerance: self.white_tolerance,
            surface_albedo: self.surface_albedo.clone(),
            region: self.region,
            edge: self.edge,
            center: self.center,
            card: self.card.map(|card| match card {
                CardName::Hidden => Card::Hidden,
                CardName::Visible => Card::Visible,
            }),
            configuration: self.configuration.map(Into::into),
            incidence: self.incidence,
            eta: self.eta,
            g: self.g,
        }
    }
}

/// So many numbers with commas between them.
fn numbers<T: FromStr, const N: usize>(text: &str) -> Option<[T; N]> {
    let numbers: Option<Vec<T>> = text.split(',').map(|text| text.trim().parse().ok()).collect();
    numbers?.try_into().ok()
}

fn parse_rectangle(text: &str) -> Result<[usize; 4], String> {
    let example = "a rectangle is X0,Y0,X1,Y1 in pixels with X0 < X1 and Y0 < Y1, like 100,50,300,200";
    numbers(text).ok_or_else(|| String::from(example))
}

fn parse_ruler(text: &str) -> Result<[f64; 5], String> {
    let example = "a ruler is X0,Y0,X1,Y1,MM: two points in pixels that are apart, and their distance in mm, like \
                   100,50,1100,55,30";
    numbers(text).ok_or_else(|| String::from(example))
}

fn parse_point(text: &str) -> Result<[f64; 2], String> {
    numbers(text).ok_or_else(|| String::from("a point is X,Y in pixels, like 320,240.5"))
}

fn parse_points(text: &str) -> Result<[f64; 4], String> {
    numbers(text).ok_or_else(|| String::from("two points are X0,Y0,X1,Y1 in pixels, like 100,50,120.5,200"))
}
