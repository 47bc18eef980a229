//! `translucid measure`: a material's numbers from a photograph.

mod known_shape;
mod page;
mod resolution;
mod setup;
mod shown;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use translucid_image::check_writable;
use translucid_laboratory::{Cell, DataTable};
use translucid_measure::{
    Card, ChannelFit, EdgeLine, Fit, Interval, NoEdge, NoSpot, Outline, Photo, Response, Samples, Scale,
    SpotPlace, fit_edge, fit_edge_of, fit_spot,
};
use translucid_profile::Medium;
use translucid_reference::Incidence;
use translucid_reference::exact::single_scattering_albedo;
use translucid_scene::{ColorSpace, Pixels, Place, load_image};

use self::shown::Shown;
use crate::failure::Failure;
use crate::files::write_file;
use crate::messages;
use crate::model::ConfigurationName;
use crate::table::{TableFormat, exact, print};

const EXAMPLES: &str = "\
The photograph shows a flat piece, half of it under an opaque card, in light that falls on all of it evenly:
how far light creeps below the card is the mean free path. White paper of known reflectance beside it
makes the brightness of the lit half a surface albedo. With --setup spot there is a small round spot of light
on a dark piece, and how far around it the piece glows is the mean free path. How to set it up:
docs/guide/measure.md.
With --scene it shows a thing of any shape, and the renderer finds the parameters with which it is that picture.

Columns: channel, quantity, value, from and to of 68 % and of 95 % confidence, unit.

Examples:
  translucid measure soap.png --mm-per-pixel 0.042 --white 100,80,400,260 --white-reflectance 0.9
  translucid measure soap.exr --mm-per-pixel 0.042 --surface-albedo 0.8 --region 900,400,2100,1600
  translucid measure soap.png --mm-per-pixel 0.042 --white-photo paper.png --format toml
  translucid measure laser.exr --setup spot --mm-per-pixel 0.042 --white-photo laser-on-paper.exr
  translucid measure ball.exr --scene ball.toml --fit material.surface_albedo,material.mfp";

/// Measures surface albedo and mean free path in a photograph of an edge of light or of a spot
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct MeasureArguments {
    /// Photograph: OpenEXR or Radiance HDR (linear), PNG, TIFF or JPEG (sRGB)
    #[arg(value_name = "PHOTO")]
    photo: PathBuf,
    /// What casts the light's shape on the piece
    #[arg(long, value_enum, default_value = "edge")]
    setup: Setup,
    /// Thickness of the slab \[mm\]
    #[arg(long, value_name = "MM", value_parser = parse_positive, required_if_eq("setup", "slab"))]
    thickness: Option<f64>,
    /// Width of a pixel on the piece \[mm\]
    #[arg(long, value_name = "MM", value_parser = parse_positive)]
    mm_per_pixel: Option<f64>,
    /// In its place two points of the photograph and the distance between them \[mm\]
    #[arg(long, value_name = "X0,Y0,X1,Y1,MM", value_parser = parse_ruler, conflicts_with = "mm_per_pixel")]
    ruler: Option<[f64; 5]>,
    /// White card in the photograph, in the same light [default: none, and no surface albedo is measured]
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse_rectangle)]
    white: Option<[usize; 4]>,
    /// Another photograph of the same exposure and light, with white paper in place of the piece: it makes light even that is
    /// not, and corners that the lens darkens; of a spot it tells the power
    #[arg(long, value_name = "PHOTO", conflicts_with_all = ["white", "exposure"])]
    white_photo: Option<PathBuf>,
    /// Reflectance of what is white, in (0, 1]: one or three, comma-separated [default: 0.9, or 1 of the panel behind a slab]
    #[arg(long, value_name = "R", value_delimiter = ',')]
    white_reflectance: Vec<f64>,
    /// Surface albedo where no white card is seen, in (0, 1): one or three; the shape hardly depends on it
    #[arg(long, value_name = "A", value_delimiter = ',', conflicts_with_all = ["white", "white_photo"])]
    surface_albedo: Vec<f64>,
    /// Part of the photograph that holds the edge and nothing else [default: all of it]
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse_rectangle)]
    region: Option<[usize; 4]>,
    /// Two points of the card's edge [default: found]
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse_points)]
    edge: Option<[f64; 4]>,
    /// Middle of the spot [default: found]
    #[arg(long, value_name = "X,Y", value_parser = parse_point, conflicts_with = "edge")]
    center: Option<[f64; 2]>,
    /// What the dark side shows: the piece (hidden, as in a projector's shadow) or the card (visible) [default: found]
    #[arg(long, value_enum)]
    card: Option<CardName>,
    /// Another exposure of the same view, to be merged; may be repeated
    #[arg(long, value_name = "PHOTO", conflicts_with = "dark")]
    exposure: Vec<PathBuf>,
    /// Photograph with the light off and the same exposure, which is subtracted
    #[arg(long, value_name = "PHOTO")]
    dark: Option<PathBuf>,
    /// Whether values of integers are linear instead of sRGB
    #[arg(long)]
    linear: bool,
    /// How light falls on a matt piece: from all around (diffuse); or on a clear one that is seen from straight above
    /// (searchlight)
    #[arg(long, value_enum, default_value = "diffuse")]
    configuration: ConfigurationName,
    /// Angle between a lamp's rays and the surface's normal, for a clear piece that is seen from straight above, in (-90, 90)
    /// degrees: positive where the rays run from dark to lit
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true, conflicts_with = "configuration",
        value_parser = parse_angle)]
    incidence: Option<f64>,
    /// Relative refractive index of a piece that is smooth, in \[0.5, 3\]; 1 is none
    #[arg(long, value_name = "ETA", default_value_t = 1.0)]
    eta: f64,
    /// Mean cosine of scattering, in (-1, 1): the mean free path is that of the similar medium
    #[arg(long, value_name = "G", default_value_t = 0.0, allow_negative_numbers = true)]
    g: f64,
    /// Directory for a page: the fit, what it leaves over, where in the photograph it was made
    #[arg(long, value_name = "DIR")]
    page: Option<PathBuf>,
    /// File to write instead of stdout
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// How to print
    #[arg(long, value_enum, default_value = "text")]
    format: MeasureFormat,
    #[command(flatten, next_help_heading = "Known shape")]
    shape: known_shape::SceneArguments,
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

/// What casts the light's shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Setup {
    /// An opaque card that covers half of the piece
    Edge,
    /// A small round spot of light
    Spot,
    /// An opaque card between a slab and a panel of light behind it, which it covers in half
    Slab,
}

/// What the dark side of an edge shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum CardName {
    /// The piece, in shadow
    Hidden,
    /// A card that lies on it
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

/// Names of the channels.
const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// Surface albedo of the shape where none is known.
const USUAL_ALBEDO: f64 = 0.7;

/// Reflectance of white paper.
const PAPER: f64 = 0.9;

/// Share of pixels at the end of their range from which on a photograph counts as clipped.
const CLIPPED: f64 = 1e-3;

/// Difference of χ² from which on one model is better than another: of Gaussian noise exp(-10) as likely.
const DECIDED: f64 = 20.0;

/// Share from which on nothing is measured.
const TOO_MUCH_CLIPPED: f64 = 0.05;

/// Part of the light by which the dark may be brighter because a file holds nothing below 0.
const CUT_NOISE: f64 = 1e-3;

/// Change of the light across the picture, over its mean, from which on it is called uneven.
const UNEVEN: f64 = 0.5;

/// Mean square of residuals over the noise from which on the model does not explain the light.
const MISFIT: f64 = 2.0;

/// Runs the verb.
pub(crate) fn run(arguments: &MeasureArguments) -> Result<(), Failure> {
    if let Some(path) = &arguments.output {
        check_writable(path)?;
    }
    if let Some(scene) = &arguments.shape.scene {
        return known_shape::run(arguments, scene);
    }
    check_setup(arguments)?;
    let scale = scale(arguments)?;
    let medium_of = MediumOf::new(arguments)?;
    let mm_per_pixel = mm_per_pixel(arguments)?;
    let path = &arguments.photo;
    let mut photo = load(path, arguments)?;
    if !arguments.exposure.is_empty() {
        let mut exposures = vec![photo];
        for path in &arguments.exposure {
            exposures.push(load(path, arguments)?);
        }
        photo = Photo::merged(&exposures).ok_or_else(|| {
            Failure::input(
                "--exposure: the photographs have other sizes or nothing in common that none of them clips",
            )
        })?;
    }
    let region = arguments.region.unwrap_or([0, 0, photo.width, photo.height]);
    let piece = part(&photo, path, "--region", region)?;
    let [left, top] = [region[0] as f64, region[1] as f64];
    // What is found may be anywhere before light is lost there
    let place = match arguments.setup {
        Setup::Spot => Some(spot_place(&piece, arguments, [left, top])?),
        Setup::Edge | Setup::Slab => None,
    };
    let core = match place {
        Some(place) => check_core(&piece, &place, path)?,
        None => {
            check_clipping(&piece, path)?;
            0.0
        }
    };
    if let Some(white) = arguments.white {
        check_clipping(&part(&photo, path, "--white", white)?, path)?;
    }
    let dark =
        arguments.dark.as_ref().map(|dark| load(dark, arguments).map(|photo| (dark, photo))).transpose()?;
    if let Some((path, dark)) = &dark {
        subtract(&mut photo, dark).map_err(|message| refusal(path, message))?;
        warn_of_cut_noise(dark, path, &photo);
    }
    let gains = gains(
        &photo,
        place.map(|place| place.moved([left, top])),
        dark.map(|(_, dark)| dark).as_ref(),
        arguments,
    )?;
    gains.apply(&mut photo);
    let piece = part(&photo, path, "--region", region)?;
    let response = &medium_of.response;
    let (samples, trace, mut fit) = match place {
        None => {
            let line = edge_line(&piece, arguments, region)?;
            let samples = line.samples(&piece, mm_per_pixel);
            let fit = |samples: &Samples| match arguments.card {
                // The camera sees the slab on both sides
                None if arguments.setup == Setup::Slab => fit_edge_of(Card::Hidden, samples, response, scale),
                None => fit_edge(samples, response, scale),
                Some(card) => fit_edge_of(card.into(), samples, response, scale),
            };
            let (samples, fit) = resolution::fit(samples, fit).ok_or_else(|| {
                refusal(
                    path,
                    "nothing gets brighter across the edge, or it has fewer than 16 pixels on a side",
                )
            })?;
            (samples, Trace::Line(line), fit)
        }
        Some(place) => {
            let samples = place.samples(&piece, mm_per_pixel, core);
            let fit = fit_spot(&samples, response, scale).ok_or_else(|| {
                refusal(path, "nothing gets brighter toward the middle of the spot, or there are fewer than 16 rings around it")
                    .with_help("show more of the piece around the spot, or set --center")
            })?;
            (samples, Trace::Spot(place), fit)
        }
    };
    gains.widen(&mut fit);
    if fit.channels.iter().all(|channel| !channel.is_seen) {
        // What a camera in focus does not blur either
        if fit.misfit > MISFIT && fit.blur > 3.0 * samples.pixel_width {
            return Err(refusal(path, unlike(&fit)));
        }
        let message = format!(
            "no scattering is seen: the {} is as sharp as a blur of {} mm makes it",
            outline_name(&fit),
            three_digits(fit.blur)
        );
        return Err(refusal(path, message).with_help("come closer, so that light creeps over several pixels"));
    }
    match fit.outline {
        Outline::Edge { card: Card::Hidden, .. } => {
            messages::line("the dark side shows light that creeps into a shadow (--card hidden)");
        }
        Outline::Edge { card: Card::Visible, .. } => {
            messages::line("the dark side shows the card: the lit side is measured (--card visible)");
        }
        Outline::Spot { radius } => messages::line(&format!(
            "a spot of {} mm radius, its edge as soft as {} mm",
            three_digits(radius),
            three_digits(fit.blur)
        )),
    }
    let rival = Rival::best(&fit, &samples, scale);
    let mut limits = remarks(&fit, &samples, scale);
    if let Some(warning) = rival.warning(&fit, &samples) {
        messages::print_warning(&warning);
        limits.push(warning);
    }
    medium_of.scale(&mut fit, scale)?;
    if let Some(directory) = &arguments.page {
        let shown =
            Shown { photo: &photo, region, trace: &trace, samples: &samples, fit: &fit, limits: &limits };
        let setup = match (fit.outline, trace) {
            (Outline::Edge { card, position }, Trace::Line(line))
                if arguments.setup == Setup::Edge && arguments.incidence.is_none() =>
            {
                Some(setup::Setup {
                    line,
                    card,
                    position,
                    mm_per_pixel,
                    surface_albedos: surface_albedos(&fit, scale),
                    configuration: arguments.configuration.into(),
                    eta: arguments.eta,
                    g: arguments.g,
                })
            }
            _ => None,
        };
        page::write(directory, path, &shown, setup.as_ref(), DataTable { rows: rows(&fit), ..table() })?;
    }
    let text = match arguments.format {
        MeasureFormat::Text => paragraphs(&fit, &rival) + &conversion(&fit, scale),
        MeasureFormat::Csv => TableFormat::Csv.text(&COLUMNS, &rows(&fit)),
        MeasureFormat::Json => TableFormat::Json.text(&COLUMNS, &rows(&fit)),
        MeasureFormat::Toml => material(&fit, scale, arguments),
    };
    match &arguments.output {
        Some(path) => write_file(path, text.as_bytes()),
        None => print(&text),
    }
}

/// Where in the region the light's shape is.
#[derive(Clone, Copy, Debug)]
enum Trace {
    Line(EdgeLine),
    Spot(SpotPlace),
}

impl Trace {
    /// Distance of a pixel from the line, or from the circle in which a spot is half as bright, in pixels.
    fn distance(&self, x: usize, y: usize) -> f64 {
        match self {
            Self::Line(line) => line.distance(x, y).abs(),
            Self::Spot(place) => (place.distance(x, y) - place.half).abs(),
        }
    }
}

fn edge_line(piece: &Photo, arguments: &MeasureArguments, region: [usize; 4]) -> Result<EdgeLine, Failure> {
    let [left, top] = [region[0] as f64, region[1] as f64];
    let line = match arguments.edge {
        Some([x0, y0, x1, y1]) => EdgeLine::through(piece, [x0 - left, y0 - top, x1 - left, y1 - top])
            .ok_or_else(|| {
                Failure::input("--edge: both points are the same, or the line misses the region")
            })?,
        None => EdgeLine::find(piece).map_err(|fault| no_edge(&arguments.photo, fault))?,
    };
    let angle = line.across[1].atan2(line.across[0]).to_degrees();
    let [x, y] = [line.point[0] + left, line.point[1] + top];
    messages::line(&format!("edge through ({x:.1}, {y:.1}), light at {angle:.1}° below the right"));
    Ok(line)
}

fn spot_place(
    piece: &Photo,
    arguments: &MeasureArguments,
    [left, top]: [f64; 2],
) -> Result<SpotPlace, Failure> {
    let place = match arguments.center {
        Some([x, y]) => SpotPlace::around(piece, [x - left, y - top])
            .ok_or_else(|| Failure::input(format!("--center: {x},{y} is not in the region")))?,
        None => SpotPlace::find(piece).map_err(|fault| no_spot(&arguments.photo, fault))?,
    };
    let [x, y] = place.center;
    messages::line(&format!(
        "spot around ({:.1}, {:.1}), {:.1} pixels to half its light",
        x + left,
        y + top,
        place.half
    ));
    Ok(place)
}

/// Radius in pixels of the core in which light is lost; refuses one beyond which too little is left.
fn check_core(piece: &Photo, place: &SpotPlace, path: &Path) -> Result<f64, Failure> {
    let core = place.core(piece);
    let [x, y] = place.center;
    let reach = x.min(y).min(piece.width as f64 - x).min(piece.height as f64 - y);
    if core > 0.5 * reach {
        let message = format!(
            "the spot is saturated: light is lost up to {core:.0} pixels from its middle, of {reach:.0} pixels that are seen all around"
        );
        return Err(refusal(path, message).with_help("expose less, or add a shorter --exposure"));
    }
    if core > 0.0 {
        messages::print_warning(&format!(
            "{}: light is lost up to {core:.0} pixels from the middle of the spot: that core is left out",
            path.display()
        ));
    }
    Ok(core)
}

/// What makes values of a photograph those that a fit takes.
enum Gains {
    /// Factors of all pixels.
    Even([f64; 3]),
    /// A photograph of something white to divide by, times its reflectance.
    Flat(Photo, [f64; 3]),
    /// Factors, and the relative standard error of the power that they hold.
    Power([f64; 3], [f64; 3]),
}

impl Gains {
    fn apply(&self, photo: &mut Photo) {
        let scaled = |value: f32, gain: f64| (f64::from(value) * gain) as f32;
        for (i, pixel) in photo.pixels.iter_mut().enumerate() {
            for (c, value) in pixel.iter_mut().enumerate() {
                *value = match self {
                    Self::Even(gains) | Self::Power(gains, _) => scaled(*value, gains[c]),
                    Self::Flat(white, reflectances) => {
                        let light = f64::from(white.pixels[i][c]);
                        // Where no light falls there is none to measure
                        if light > 0.0 { scaled(*value, reflectances[c] / light) } else { 0.0 }
                    }
                };
            }
        }
    }

    /// Lets intervals of surface albedos hold the error of the power.
    fn widen(&self, fit: &mut Fit) {
        let Self::Power(_, errors) = self else { return };
        for (channel, error) in fit.channels.iter_mut().zip(errors) {
            if let Some(Interval { value, likely, sure }) = &mut channel.surface_albedo {
                for (interval, normal) in [(likely, 0.994_457_883), (sure, 1.959_963_985)] {
                    let [down, up] = [*value - interval[0], interval[1] - *value];
                    let more = *value * error * normal;
                    *interval = [*value - down.hypot(more), *value + up.hypot(more)];
                }
            }
        }
    }
}

/// By white paper in the photograph or in another one; a spot's by the power of the light.
fn gains(
    photo: &Photo,
    place: Option<SpotPlace>,
    dark: Option<&Photo>,
    arguments: &MeasureArguments,
) -> Result<Gains, Failure> {
    let path = &arguments.photo;
    let reflectances = match (arguments.white_reflectance.as_slice(), arguments.setup) {
        ([], Setup::Slab) => [1.0; 3],
        ([], _) => [PAPER; 3],
        (given, _) => three("--white-reflectance", given, 1.0)?,
    };
    let ratio = |of: [f64; 3], path: &Path, option: &str| match (0..3).find(|&c| of[c] <= 0.0) {
        Some(c) => Err(refusal(path, format!("{option}: {} is {} there", CHANNELS[c], of[c]))),
        None => Ok(std::array::from_fn(|c| reflectances[c] / of[c])),
    };
    if let Some(white) = arguments.white {
        return ratio(part(photo, path, "--white", white)?.mean(), path, "--white").map(Gains::Even);
    }
    let Some(white_path) = &arguments.white_photo else { return Ok(Gains::Even([1.0; 3])) };
    let mut white = load(white_path, arguments)?;
    if [white.width, white.height] != [photo.width, photo.height] {
        let message = format!(
            "is {}×{} pixels, but the photograph is {}×{}",
            white.width, white.height, photo.width, photo.height
        );
        return Err(refusal(white_path, message));
    }
    check_clipping(&white, white_path)?;
    if let Some(dark) = dark {
        subtract(&mut white, dark).map_err(|message| refusal(white_path, message))?;
    }
    if place.is_some() && white.clipped() > 0.0 {
        let message = "light is lost in it, and with it the power of the spot is unknown";
        return Err(refusal(white_path, message).with_help("expose less, the photograph, too"));
    }
    let Some(place) = place else {
        ratio(white.mean(), white_path, "--white-photo")?;
        return Ok(Gains::Flat(white, reflectances));
    };
    let powers = place.power(&white);
    // Per pixel's area
    let gains = ratio(powers.map(|(power, _)| power), white_path, "--white-photo")?;
    let area = mm_per_pixel(arguments)?.powi(2);
    Ok(Gains::Power(gains.map(|gain: f64| gain / area), powers.map(|(power, error)| error / power)))
}

/// Width of a pixel \[mm\].
fn mm_per_pixel(arguments: &MeasureArguments) -> Result<f64, Failure> {
    match (arguments.mm_per_pixel, arguments.ruler) {
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

/// Options that belong to another setup.
fn check_setup(arguments: &MeasureArguments) -> Result<(), Failure> {
    let is = |setup| arguments.setup == setup;
    let given = [
        (arguments.edge.is_some() && is(Setup::Spot), "--edge is for --setup edge and slab"),
        (arguments.card.is_some() && !is(Setup::Edge), "--card is for --setup edge"),
        (arguments.center.is_some() && !is(Setup::Spot), "--center is for --setup spot"),
        (arguments.thickness.is_some() && !is(Setup::Slab), "--thickness is for --setup slab"),
        (arguments.incidence.is_some() && is(Setup::Slab), "--incidence is for --setup edge and spot"),
        (
            arguments.white.is_some() && is(Setup::Spot),
            "--white is for --setup edge and slab: the power of a spot is measured on white paper in its place, --white-photo",
        ),
        (
            arguments.eta != 1.0 && is(Setup::Slab),
            "--setup slab is for --eta 1: light between two boundaries is not solved exactly here",
        ),
    ];
    given.iter().find(|(is_wrong, _)| *is_wrong).map_or(Ok(()), |(_, message)| Err(Failure::input(*message)))
}

/// What explains light as well that is no half space.
struct Rival {
    misfit: f64,
    name: &'static str,
}

impl Rival {
    /// The best of normalized diffusion and mixtures of two exponentials.
    fn best(fit: &Fit, samples: &Samples, scale: Scale) -> Self {
        let of = |name, response: &Response| {
            let rival = match fit.outline {
                Outline::Edge { card, .. } => fit_edge_of(card, samples, response, scale),
                Outline::Spot { .. } => fit_spot(samples, response, scale),
            };
            Self { misfit: rival.map_or(f64::INFINITY, |fit| fit.misfit), name }
        };
        let diffusion = of("normalized diffusion", &Response::normalized_diffusion());
        // Two exponentials from one that is hardly two to a narrow peak on a wide glow
        let mixtures = [(0.5, 3.0), (0.25, 8.0), (0.5, 8.0), (0.75, 8.0)];
        let mixtures = mixtures.map(|(weight, ratio)| {
            of("a mixture of two exponentials", &Response::exponentials(weight, ratio))
        });
        mixtures
            .into_iter()
            .fold(diffusion, |best, rival| if rival.misfit < best.misfit { rival } else { best })
    }

    /// That the shape contradicts a half space.
    fn warning(&self, fit: &Fit, samples: &Samples) -> Option<String> {
        let decided = (fit.misfit - self.misfit) * 3.0 * samples.places.len() as f64;
        (decided > DECIDED * self.misfit.max(1.0)).then(|| {
            format!(
                "{}, no solution of the equation of transfer, explains the light better than a half space or slab of \
                 isotropic scatterers: the piece is not one, or the light is not as --configuration says",
                self.name
            )
        })
    }
}

fn scale(arguments: &MeasureArguments) -> Result<Scale, Failure> {
    if arguments.white.is_some() || arguments.white_photo.is_some() {
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
    if matches!(image.pixels, Pixels::Byte(_)) && color_space == ColorSpace::Srgb {
        let message = format!(
            "{}: 8-bit values are taken as sRGB; cameras bend them at will, and lengths with them: better \
                 develop the raw file to linear OpenEXR",
            path.display()
        );
        messages::print_warning(&message);
    }
    let pixel = |x: usize, y: usize| {
        let [r, g, b, _] = image.texel(x as u32, y as u32);
        [r, g, b]
    };
    Ok(Photo::from_fn(image.width as usize, image.height as usize, pixel))
}

/// Warns of light that is cut off, and refuses where that is much of it.
fn check_clipping(part: &Photo, path: &Path) -> Result<(), Failure> {
    let share = part.clipped();
    let message =
        format!("{:.1} % of the values are at the end of their range, where light is lost", 100.0 * share);
    let help = "expose less, add a shorter --exposure, or leave highlights out by --region";
    if share > TOO_MUCH_CLIPPED {
        return Err(refusal(path, message).with_help(help));
    }
    if share > CLIPPED {
        messages::print_warning(&format!("{}: {message}: {help}", path.display()));
    }
    warn_of_cut_noise(part, path, part);
    Ok(())
}

/// Warns of values below 0 that the file has as 0, which makes the dark brighter, where that counts beside the light.
fn warn_of_cut_noise(part: &Photo, path: &Path, lit: &Photo) {
    let light = lit.mean().into_iter().fold(f64::MIN_POSITIVE, f64::max);
    let gained = part.cut_noise() / light;
    if gained > CUT_NOISE {
        messages::print_warning(&format!(
            "{}: noise below 0 is cut off, which brightens the dark by up to {} % of the light: save as OpenEXR with \
             negative values, or without the camera's black level subtracted, which --dark does better",
            path.display(),
            three_digits(100.0 * gained)
        ));
    }
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

fn no_spot(path: &Path, fault: NoSpot) -> Failure {
    let message = match fault {
        NoSpot::TooSmall => String::from("fewer than 16 pixels on a side"),
        NoSpot::NoContrast(contrast) => format!(
            "no spot of light: the brightest pixels are {contrast:.2} times as bright as the darkest tenth, and must be 1.5 times"
        ),
        NoSpot::FewPixels(count) => {
            format!("no spot of light: {count} pixels are half as bright as the brightest, and must be 12")
        }
        NoSpot::Several(count) => format!("{count} spots of light of similar size, and one is needed"),
        NoSpot::OutOfFrame => String::from("the spot of light goes on beyond the picture"),
        NoSpot::NotRound(ratio) => format!(
            "no round spot: what is bright spreads {ratio:.1} times as far as in a disk, by its mean square, and may 1.4 times"
        ),
    };
    refusal(path, message).with_help("show the spot alone by --region, or where its middle is by --center")
}

/// What casts the light's shape, in a word.
fn outline_name(fit: &Fit) -> &'static str {
    match fit.outline {
        Outline::Edge { .. } => "edge",
        Outline::Spot { .. } => "spot",
    }
}

/// Says what limits the measurement, and returns it in plain sentences.
fn remarks(fit: &Fit, samples: &Samples, scale: Scale) -> Vec<String> {
    let mut notes = Vec::new();
    let mut warnings = Vec::new();
    if let Scale::Relative(albedos) = scale {
        let shown = albedos.map(|a| a.to_string()).join(", ");
        notes.push(format!("without a white card only lengths are measured, for surface albedos of {shown}"));
    }
    let (extent, outline) = (samples.extent(), outline_name(fit));
    for (name, channel) in CHANNELS.iter().zip(&fit.channels) {
        let [low, high] = channel.mfp.sure;
        let [value, blur] = [channel.mfp.value, fit.blur].map(three_digits);
        if !channel.is_seen {
            warnings.push(format!(
                "{name}: no scattering is seen: the {outline} is as sharp as a blur of {blur} mm makes it: come closer"
            ));
        } else if high > 2.0 * low {
            let [low, high] = [low, high].map(three_digits);
            notes.push(format!(
                "{name}: the {outline} does not tell the mean free path: it may be {low} to {high} mm"
            ));
        } else if channel.mfp.value > extent / samples_needed(fit) {
            warnings.push(format!(
                "{name}: light creeps {value} mm and more, farther than the {extent:.0} mm that are seen show: step back"
            ));
        } else if channel.mfp.value < fit.blur {
            warnings.push(format!(
                "{name}: the picture's blur of {blur} mm hides a mean free path of {value} mm: come closer"
            ));
        }
        if channel.surface_albedo.is_some_and(|albedo| albedo.value >= 1.0) {
            warnings.push(format!(
                "{name}: brighter than any surface in the light of the white card: is a highlight in the way, or \
                 --white-reflectance too high?"
            ));
        }
        if channel.unevenness.abs() > UNEVEN {
            warnings.push(format!(
                "{name}: the light changes by {:.0} % across the picture: is the piece tilted, or the lamp close?",
                100.0 * channel.unevenness.abs()
            ));
        }
    }
    if fit.misfit > MISFIT {
        warnings.push(unlike(fit));
    }
    notes.iter().for_each(|note| messages::print_note(note));
    warnings.iter().for_each(|warning| messages::print_warning(warning));
    notes.into_iter().chain(warnings).collect()
}

/// Mean free paths that a picture must show.
fn samples_needed(fit: &Fit) -> f64 {
    match fit.outline {
        // Of both sides
        Outline::Edge { .. } => 15.0,
        Outline::Spot { .. } => 5.0,
    }
}

/// That no half space explains the light.
fn unlike(fit: &Fit) -> String {
    format!(
        "the light is not that of an even, thick, isotropic piece: what is left is {:.1} times the noise (layers, strong \
         forward scattering, a rough, bent or patterned surface, moiré, a second light?)",
        fit.misfit.sqrt()
    )
}

/// What mean free paths of isotropic scatterers below a boundary are to the medium that is asked for.
struct MediumOf {
    eta: f64,
    g: f64,
    incidence: Incidence,
    response: Response,
}

impl MediumOf {
    fn new(arguments: &MeasureArguments) -> Result<Self, Failure> {
        let MeasureArguments { eta, g, .. } = *arguments;
        let configuration = translucid_profile::Configuration::from(arguments.configuration);
        let (incidence, response) = match arguments.incidence {
            Some(_) if eta != 1.0 => {
                let message = "--incidence is for --eta 1: below a boundary only light of all directions together is \
                               solved exactly here";
                return Err(Failure::input(message).with_help(
                    "light the piece evenly from all around instead, with --configuration searchlight",
                ));
            }
            Some(angle) if angle != 0.0 && arguments.setup == Setup::Spot => {
                let message =
                    format!("--incidence is {angle}, but the light around a spot is round only for 0");
                return Err(Failure::input(message));
            }
            Some(angle) => {
                let beam = Response::of_beam(angle.to_radians());
                (Incidence::NORMAL, beam.map_err(|error| Failure::input(format!("--incidence: {error}")))?)
            }
            None => {
                let incidence = Incidence::from(configuration);
                let response = match arguments.thickness {
                    Some(thickness) => Ok(Response::of_slab(thickness, incidence)),
                    None => Response::new(eta, incidence),
                };
                (incidence, response.map_err(|error| Failure::input(format!("--eta: {error}")))?)
            }
        };
        Medium::new(1.0, 1.0, g).map_err(|error| Failure::input(format!("--g: {error}")))?;
        Ok(Self { eta, g, incidence, response })
    }

    /// Turns the mean free paths of isotropic scatterers into those of the similar medium: σ_a and (1 − g) σ_s are the same.
    fn scale(&self, fit: &mut Fit, scale: Scale) -> Result<(), Failure> {
        for (c, channel) in fit.channels.iter_mut().enumerate() {
            let albedo = match (scale, channel.surface_albedo) {
                (Scale::Relative(albedos), _) => albedos[c],
                (Scale::Reflectance, albedo) => albedo.map_or(0.0, |albedo| albedo.value.clamp(1e-3, 0.9999)),
            };
            let similar = |error: translucid_profile::ParameterError| Failure::work(error.to_string());
            let alpha = single_scattering_albedo(albedo, self.eta, self.incidence).map_err(similar)?;
            let medium = Medium::from_reduced(1.0 - alpha, alpha, self.g).map_err(similar)?;
            let factor = medium.mfp();
            let Interval { value, likely, sure } = channel.mfp;
            channel.mfp = Interval {
                value: factor * value,
                likely: likely.map(|l| factor * l),
                sure: sure.map(|l| factor * l),
            };
        }
        Ok(())
    }
}

const COLUMNS: [&str; 8] = ["channel", "quantity", "value", "from_68", "to_68", "from_95", "to_95", "unit"];

fn table() -> DataTable {
    DataTable::new("measured", "What is measured, with intervals of 68 and of 95 % confidence.", &COLUMNS)
}

fn row(channel: &str, quantity: &str, interval: Interval, unit: &str) -> Vec<Cell> {
    let Interval { value, likely, sure } = interval;
    let numbers = [value, likely[0], likely[1], sure[0], sure[1]].map(Cell::from);
    let words = [Cell::from(channel), Cell::from(quantity)];
    words.into_iter().chain(numbers).chain([Cell::from(unit)]).collect()
}

fn rows(fit: &Fit) -> Vec<Vec<Cell>> {
    let of_channel = |(name, channel): (&&str, &ChannelFit)| {
        let albedo = channel.surface_albedo.map(|albedo| row(name, "surface_albedo", albedo, ""));
        let mfp = channel.is_seen.then(|| row(name, "mfp", channel.mfp, "mm"));
        [mfp, albedo].into_iter().flatten().collect::<Vec<_>>()
    };
    CHANNELS.iter().zip(&fit.channels).flat_map(of_channel).collect()
}

fn paragraphs(fit: &Fit, rival: &Rival) -> String {
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
        "\nIn parentheses the 95 % confidence interval. Blur {} mm; residuals {:.2} times the noise, of {} {:.2}.",
        three_digits(fit.blur),
        fit.misfit.sqrt(),
        rival.name,
        rival.misfit.sqrt()
    );
    text
}

/// The command that says the same in other renderers' numbers.
fn conversion(fit: &Fit, scale: Scale) -> String {
    let list = |values: [f64; 3]| values.map(three_digits).join(",");
    let mfps = list(fit.channels.map(|channel| if channel.is_seen { channel.mfp.value } else { 0.0 }));
    let albedos = list(surface_albedos(fit, scale));
    format!(
        "In other renderers: translucid convert --from translucid:mfp={mfps} --surface-albedo {albedos} --format text\n"
    )
}

/// Surface albedos that a material has, measured or given.
fn surface_albedos(fit: &Fit, scale: Scale) -> [f64; 3] {
    match scale {
        Scale::Relative(albedos) => albedos,
        Scale::Reflectance => {
            fit.channels.map(|channel| channel.surface_albedo.map_or(0.0, |a| a.value.clamp(0.0, 1.0)))
        }
    }
}

fn material(fit: &Fit, scale: Scale, arguments: &MeasureArguments) -> String {
    let MeasureArguments { photo, eta, g, .. } = arguments;
    let list = |values: [f64; 3]| values.map(three_digits).join(", ");
    let albedos = surface_albedos(fit, scale);
    let mut rest = String::new();
    if *g != 0.0 {
        let _ = writeln!(rest, "subsurface_scatter_anisotropy = {g}");
    }
    if *eta != 1.0 {
        let _ = writeln!(rest, "specular_ior = {eta}");
    }
    let name = photo.file_stem().unwrap_or_default().to_string_lossy().replace(['"', '\\'], "_");
    format!(
        "unit = \"mm\"\n\n[[material]]\nname = \"{name}\"\nsubsurface_weight = 1\nsubsurface_color = [{}]\n\
         subsurface_radius = 1\nsubsurface_radius_scale = [{}]\n{rest}",
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

fn parse_ruler(text: &str) -> Result<[f64; 5], String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|text| text.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x0, y0, x1, y1, mm])
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
    let numbers: Option<Vec<f64>> = text.split(',').map(|text| text.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y]) if x.is_finite() && y.is_finite() => Ok([x, y]),
        _ => Err(String::from("a point is X,Y in pixels, like 320,240.5")),
    }
}

fn parse_points(text: &str) -> Result<[f64; 4], String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|text| text.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x0, y0, x1, y1]) if [x0, y0, x1, y1].iter().all(|v| v.is_finite()) => Ok([x0, y0, x1, y1]),
        _ => Err(String::from("two points are X0,Y0,X1,Y1 in pixels, like 100,50,120.5,200")),
    }
}
