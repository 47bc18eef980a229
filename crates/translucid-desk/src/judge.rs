//! *judge*: an engine's picture of a lit shape on a plane beside the exact light.

mod picture;
mod symmetry;

use std::path::PathBuf;
use std::sync::atomic::Ordering;

use translucid_laboratory::judge::{Judgement, LEVELS, Pass, Setup, appearance, judgement_chart};
use translucid_measure::{CHANNELS, Photo};
use translucid_profile::{AlbedoInversion, Configuration, Parameterization, scaling};
use translucid_scene::linear_from_srgb;
use translucid_words::{
    Cell, Column, Context, DataTable, Entry, Error, Fallback, Interval, Place, Rule, Thing, Value, field,
    number, numbers, optional, path, word,
};

use crate::answer::{About, Answer, Control, Form, NamedFile, Question, Unanswered};

use Fallback::{Plain, Required, Words};

/// Lengths, and values of light.
const POSITIVE: Interval = Interval::closed(1e-18, 1e18);

/// A picture, and what it should show.
#[derive(Clone, Debug)]
pub struct AskedJudge {
    picture: Option<PathBuf>,
    setup: Shape,
    size: Option<f64>,
    pixel: f64,
    surface_albedo: Vec<f64>,
    mfp: Vec<f64>,
    dmfp: Vec<f64>,
    configuration: Configuration,
    g: f64,
    eta: f64,
    white: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shape {
    Edge,
    Disk,
    Line,
}

const SHAPES: &[(&str, Shape)] = &[("edge", Shape::Edge), ("disk", Shape::Disk), ("line", Shape::Line)];

/// *judge*.
#[rustfmt::skip]
pub static JUDGE: Question<AskedJudge> = Question {
    thing: Thing {
        name: "judge",
        doc: "Judges a screen-space pass by a picture of it: light, width, and what to change",
        plain: || AskedJudge {
            picture: None, setup: Shape::Edge, size: None, pixel: 1.0, surface_albedo: Vec::new(), mfp: Vec::new(),
            dmfp: Vec::new(), configuration: Configuration::Diffuse, g: 0.0, eta: 1.0, white: None,
        },
        fields: &[
            field!(AskedJudge { picture } => path(picture), "Linear OpenEXR file of the lit plane", Required),
            field!(AskedJudge { setup } => word(setup, SHAPES), "Shape that is lit: a half plane, a disk, or a band", Required),
            field!(AskedJudge { size } => optional(size, POSITIVE),
                "Diameter of the disk or width of the line, in the unit of the lengths, {range}", Words("none")),
            field!(AskedJudge { pixel } => number(pixel, POSITIVE),
                "Width of a pixel on the plane, in the unit of the lengths, {range}", Required),
            field!(AskedJudge { surface_albedo } => numbers(surface_albedo, Interval::open(0.0, 1.0), [1, 3]),
                "Surface albedo, {range}: one, or red, green and blue", Required),
            field!(AskedJudge { mfp } => numbers(mfp, POSITIVE, [1, 3]),
                "Mean free path in the volume, in any unit, {range}: one, or three", Words("none")),
            field!(AskedJudge { dmfp } => numbers(dmfp, POSITIVE, [1, 3]),
                "Diffuse mean free path on the surface, {range}, in place of the mean free path", Words("none")),
            field!(AskedJudge { configuration } => word(configuration, &Configuration::WORDS),
                "How light enters the medium: as a pencil beam, perpendicularly, or with a cosine distribution", Plain),
            field!(AskedJudge { g } => number(g, Interval::closed(*AlbedoInversion::G.start(), *AlbedoInversion::G.end())),
                "Mean cosine of the phase function, {range}", Plain),
            field!(AskedJudge { eta } => number(eta, Interval::closed(*AlbedoInversion::ETA.start(), *AlbedoInversion::ETA.end())),
                "Relative index of refraction of the smooth boundary, {range}", Plain),
            field!(AskedJudge { white } => optional(white, POSITIVE),
                "Value of a lit pixel of a surface that returns all light and does not scatter below, {range}; with it all light is compared", Words("none")),
        ],
        rules: &[
            Rule::OneOf(&[&["mfp"], &["dmfp"]]),
            Rule::Holds { key: "surface_albedo", broken: |asked| one_or_three(&asked.surface_albedo), help: "" },
            Rule::Holds { key: "mfp", broken: |asked| one_or_three(&asked.mfp), help: "" },
            Rule::Holds { key: "dmfp", broken: |asked| one_or_three(&asked.dmfp), help: "" },
            Rule::Holds {
                key: "size",
                broken: |asked| {
                    let is_wrong = asked.setup == Shape::Edge && asked.size.is_some();
                    is_wrong.then(|| String::from("left out: it is for a disk or a line"))
                },
                help: "",
            },
        ],
    },
    about: About {
        more: "The picture is linear OpenEXR with channels R, G, B: a plane seen straight from above, orthographically, whose irradiance is 1 in a shape and 0 elsewhere. Make it by the pass under test, with borders that repeat the last pixel for an edge or a line:\n  edge: one half is lit, whatever the direction of the straight line between both;\n  disk: a disk whose diameter is the size is lit;\n  line: a band whose width is the size is lit, along rows or columns.\nThe plane is a half space. Its light is exact with g 0 and eta 1. Otherwise 400,000 photons walk for it, and the light across an edge is known to 0.001 (one standard error).\n\nA channel is right if its RMS difference is at most 0.01 of the light on a large lit shape, its widths are within 3 %, and all its light within 2 %, which takes white. If it is not, the light that known mistakes draw is compared with it. The one that explains the picture gives the verdict: profile, gather, or picture (a wrong size, or codes of sRGB in place of light). unknown means that none does, or that noise hides which.\n\nPixels are averaged along the edge or line, or around the disk, and their scatter tells the noise, which counts neither for nor against the pass.\n\nThe diffuse mean free path is the exact one of this surface albedo and configuration. export takes it for the searchlight's unless stated, and convert goes by Burley's fit: a note prints all three in mean free paths.",
        source: "",
        is_by_element: false,
        right: || {
            let said = |setup: &str, length: &str, others: &[Entry]| {
                let own = [
                    Entry::new("picture", "pass.exr"),
                    Entry::new("setup", setup),
                    Entry::new("pixel", 0.05),
                    Entry::new("surface_albedo", Value::list(&[0.9, 0.6, 0.4])),
                    Entry::new(length, 1.0),
                ];
                [&own[..], others].concat()
            };
            vec![said("edge", "mfp", &[]), said("disk", "dmfp", &[Entry::new("size", 2.0)])]
        },
        examples: &[
            "examples/judge/right.exr --setup disk --size 2 --pixel 0.1 --surface-albedo 0.9,0.6,0.4 --mfp 0.5,0.35,0.25 --white 1",
            "examples/judge/too-wide.exr --setup disk --size 2 --pixel 0.1 --surface-albedo 0.9,0.6,0.4 --mfp 0.5,0.35,0.25 --white 1 -o judgement.svg",
            "pass.exr --setup edge --pixel 0.05 --surface-albedo 0.8 --mfp 0.5 --g 0.8 --eta 1.4",
        ],
        columns: &COLUMNS,
        formats: &["text", "csv", "json"],
    },
    form: |_| Form::Table,
    answer,
};

#[rustfmt::skip]
static COLUMNS: [Column; 14] = [
    Column::new("channel", "", "red, green or blue"),
    Column::new("verdict", "", "right, profile, gather, picture or unknown"),
    Column::new("light_error", "1", "all light over what there is less 1; empty without white"),
    Column::new("rms_error", "1", "RMS difference, as a part of the light on a large lit shape"),
    Column::new("largest_error", "1", "greatest difference"),
    Column::new("noise", "1", "RMS difference that the picture's noise makes of it"),
    Column::new("width_25", "L", "distance at which light falls to 25 %"),
    Column::new("exact_width_25", "L", "the same of the exact light"),
    Column::new("width_10", "L", "distance at which light falls to 10 %"),
    Column::new("exact_width_10", "L", "the same of the exact light"),
    Column::new("width_5", "L", "distance at which light falls to 5 %"),
    Column::new("exact_width_5", "L", "the same of the exact light"),
    Column::new("explained_rms", "1", "RMS difference that the cause leaves"),
    Column::new("sentence", "", "the verdict for people"),
];

/// Requirement on a number for all channels or for each.
fn one_or_three(numbers: &[f64]) -> Option<String> {
    (numbers.len() == 2).then(|| String::from("one number or three"))
}

/// The number of a channel.
fn at(numbers: &[f64], channel: usize) -> f64 {
    numbers[if numbers.len() == 1 { 0 } else { channel }]
}

impl AskedJudge {
    fn setup(&self) -> Result<Setup, Error> {
        match (self.setup, self.size) {
            (Shape::Edge, _) => Ok(Setup::Edge),
            (Shape::Disk, Some(size)) => Ok(Setup::Disk { radius: 0.5 * size }),
            (Shape::Line, Some(size)) => Ok(Setup::Line { width: size }),
            (_, None) => Err(Error::new(
                "size is missing: it must be the diameter of the disk, or the width of the line",
            )),
        }
    }

    /// How long a diffuse mean free path is, here and where else it is asked for.
    fn note(&self) -> Result<String, Error> {
        let albedos = [0, 1, 2].map(|channel| at(&self.surface_albedo, channel));
        let listed = |ratio: &dyn Fn(f64) -> f64| albedos.map(|a| format!("{:.3}", ratio(a))).join(", ");
        let exact = |configuration| {
            let inversion = AlbedoInversion::new(self.g, self.eta, configuration)
                .map_err(|error| Error::new(error.to_string()))?;
            Ok::<_, Error>(listed(&|a| 1.0 / inversion.mfp(a, 1.0, Parameterization::Dmfp)))
        };
        let fit = |a| {
            scaling(a, Parameterization::Dmfp, self.configuration)
                / scaling(a, Parameterization::Mfp, self.configuration)
        };
        Ok(format!(
            "a diffuse mean free path is {} mean free paths in diffuse light and {} of a searchlight, exactly, of which {} \
             counts here; {} by Burley's fits, which convert goes by",
            exact(Configuration::Diffuse)?,
            exact(Configuration::Searchlight)?,
            if self.configuration == Configuration::Diffuse { "the former" } else { "the latter" },
            listed(&fit)
        ))
    }
}

fn answer(asked: &AskedJudge, _: &Context, control: &Control<'_>) -> Result<Answer, Unanswered> {
    let Some(path) = &asked.picture else { return Ok(Answer::default()) };
    let setup = asked.setup()?;
    let photo = picture::load(path)?;
    let is_dmfp = asked.mfp.is_empty();
    let lengths = if is_dmfp { &asked.dmfp } else { &asked.mfp };
    let notes = if is_dmfp { vec![asked.note()?] } else { Vec::new() };
    let judge = |photo: &Photo, white: Option<f64>| {
        let bins = picture::averaged(photo, setup, asked.pixel);
        let bins = bins.map_err(|message| Error::at(Place::file(path), message))?;
        let mut judged = Vec::new();
        for (i, (channel, bins)) in CHANNELS.into_iter().zip(bins).enumerate() {
            let pass = Pass {
                setup,
                appearance: appearance(at(&asked.surface_albedo, i), at(lengths, i), is_dmfp, asked.g),
                eta: asked.eta,
                configuration: asked.configuration,
                pixel: asked.pixel,
                white,
                bins,
            };
            let fail = |fault| Error::new(format!("{}: {channel}: {fault}", path.display()));
            judged.push((channel, pass.judge().map_err(fail)?));
            if control.stop.load(Ordering::Relaxed) {
                return Err(Unanswered::Stopped);
            }
            (control.progress)(judged.len() as f64 / CHANNELS.len() as f64);
        }
        Ok(judged)
    };
    let judged = match judge(&photo, asked.white) {
        Err(Unanswered::Stopped) => return Err(Unanswered::Stopped),
        linear => match picture::decoded(&photo).filter(|_| !linear.as_ref().is_ok_and(all_are_right)) {
            None => linear?,
            Some(photo) => {
                let white = asked.white.map(|white| f64::from(linear_from_srgb(white.min(1e6) as f32)));
                match judge(&photo, white) {
                    Err(Unanswered::Stopped) => return Err(Unanswered::Stopped),
                    Ok(decoded) if are_codes(&linear, &decoded) => decoded
                        .into_iter()
                        .map(|(channel, judgement)| (channel, judgement.of_codes()))
                        .collect(),
                    _ => linear?,
                }
            }
        },
    };
    let channels: Vec<(&str, &Judgement)> = judged.iter().map(|(name, one)| (*name, one)).collect();
    let svg = judgement_chart(&channels, "").svg().into_bytes();
    let rows = channels.iter().map(|(channel, judgement)| row(channel, judgement)).collect();
    Ok(Answer {
        tables: vec![DataTable { rows, ..DataTable::of(&COLUMNS) }],
        text: Some(sentences(&channels)),
        files: vec![NamedFile { name: "judgement.svg".into(), bytes: svg }],
        notes,
        ..Answer::default()
    })
}

/// A judgement of each channel.
type Judged = Vec<(&'static str, Judgement)>;

fn all_are_right(judged: &Judged) -> bool {
    judged.iter().all(|(_, judgement)| judgement.verdict() == "right")
}

/// Part of what is unexplained of a picture that codes of sRGB may leave, if it is one of them.
const CODES_LEAVE: f64 = 0.7;

/// Whether a picture that is not right is better explained by its being one of codes.
fn are_codes(linear: &Result<Judged, Unanswered>, decoded: &Judged) -> bool {
    let Ok(linear) = linear else { return all_are_right(decoded) };
    let left = |judged: &Judged| judged.iter().map(|(_, judgement)| judgement.unexplained()).sum::<f64>();
    let is_known = decoded.iter().all(|(_, judgement)| judgement.verdict() != "unknown");
    is_known && left(decoded) < CODES_LEAVE * left(linear)
}

fn row(channel: &str, judgement: &Judgement) -> Vec<Cell> {
    let known = |value: Option<f64>| Cell::Number(value.unwrap_or(f64::NAN));
    let mut cells = vec![Cell::from(channel), Cell::from(judgement.verdict()), known(judgement.light_error)];
    cells.extend([judgement.rms, judgement.largest, judgement.noise].map(Cell::Number));
    cells.extend(judgement.widths.iter().flatten().map(|width| Cell::Number(*width)));
    cells.extend([known(judgement.explained_rms), Cell::from(judgement.sentence.as_str())]);
    cells
}

/// Lines for people.
fn sentences(judged: &[(&str, &Judgement)]) -> String {
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
