//! A screen-space pass judged: an engine's picture of a lit shape on a plane beside the exact light.
//!
//! ```text
//! setup.rs      the lit shape of a picture
//! material.rs   the exact light of a half space
//! cause.rs      reasons why a pass may be wrong, and the light that each would draw
//! ```
//!
//! # Method
//! Pixels are averaged by their distance from the shape in bins of a pixel.
//! If their RMS difference from the truth is small, and so are the differences in width and light, the pass is right.
//! If not, the light of each [`Cause`] is computed; the one that explains the picture names the part to mend.
//! A cause that explains it too little is not named: then the judgement says that the reason is not known.
//! Noise in a difference, by the scatter of the pixels of a place, counts neither for nor against a pass: where it
//! hides whether the pass is right, or which of several causes it is, the judgement says so.

mod cause;
mod material;
mod setup;

use std::fmt;

use translucid_profile::{Appearance, Configuration, ParameterError, Parameterization};

use self::cause::{Candidate, Subject};
pub use self::cause::{Cause, Part};
use self::material::Material;
pub use self::setup::Setup;
use crate::oracle::LitShape;
use crate::{Axis, Chart, Ink, Mark, Series};

/// One channel of a picture, averaged by place.
#[derive(Clone, Debug, PartialEq)]
pub struct Pass {
    /// The shape that is lit.
    pub setup: Setup,
    /// Material of the plane, a half space.
    pub appearance: Appearance,
    /// Relative index of refraction of its boundary, in \[1, 3\]; with 1 and g = 0 its light is exact, otherwise that of
    /// 400,000 photons, known to 0.001 of the light.
    pub eta: f64,
    /// How light enters.
    pub configuration: Configuration,
    /// Width of a pixel \[L\].
    pub pixel: f64,
    /// Value of a surface that returns all light where it is lit; none if it is not known.
    pub white: Option<f64>,
    /// Values by place.
    pub bins: Bins,
}

/// Mean values by place.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bins {
    /// Places, rising \[L\].
    pub places: Vec<f64>,
    /// Mean of the pixels at each place.
    pub values: Vec<f64>,
    /// Standard deviation of a pixel at each place; as the next, none at all where there is no noise.
    pub scatter: Vec<f64>,
    /// Standard error of each mean.
    pub errors: Vec<f64>,
    /// Means of those along the picture's axes, and along its diagonals: of disks, where both are there.
    pub directions: Option<[Vec<f64>; 2]>,
}

/// RMS difference up to which a pass is right, as a part of the light on a large lit shape.
pub const RIGHT_RMS: f64 = 0.01;
/// Difference of widths up to which it is right.
pub const RIGHT_WIDTH: f64 = 0.03;
/// Difference of all light up to which it is right.
pub const RIGHT_LIGHT: f64 = 0.02;
/// Parts of the light at whose places widths are compared.
pub const LEVELS: [f64; 3] = [0.25, 0.1, 0.05];
/// Least part of the light of places that count.
const LEAST: f64 = 0.02;
/// A cause explains a picture if it leaves that part of its difference, and at most that RMS difference.
const EXPLAINS: [f64; 2] = [1.0 / 3.0, 0.015];
/// Standard errors of a width that count for the pass.
const DOUBT: f64 = 3.0;
/// χ² by which a cause must be better than another for noise not to hide which of both it is.
const APART: f64 = 9.0;
/// A cause without a parameter is preferred to one that is not closer by this.
const SIMPLER: f64 = 0.6;

/// The errors of a channel of a pass.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    /// All light over what there is less 1; nothing where white is not known.
    pub light_error: Option<f64>,
    /// RMS difference from the truth, as a part of the light on a large lit shape.
    pub rms: f64,
    /// Greatest difference.
    pub largest: f64,
    /// RMS difference that noise makes of it.
    pub noise: f64,
    /// Noise of a pixel as a part of its light, the median over places with much light.
    pub pixel_noise: f64,
    /// Standard errors of the widths that were found \[L\].
    pub width_errors: [f64; 3],
    /// Whether noise hides what is allowed to a right pass.
    pub is_hidden: bool,
    /// Other reasons that noise does not tell from one another.
    pub rivals: Vec<Cause>,
    /// Distances at which light falls to [`LEVELS`], of the picture and of the truth \[L\]; not numbers where the picture
    /// ends before.
    pub widths: [[f64; 2]; 3],
    /// Reasons, the one that weighs most first; none if the pass is right, or if the reason is not known.
    pub causes: Vec<Cause>,
    /// RMS difference from the light that the first reason draws.
    pub explained_rms: Option<f64>,
    /// A sentence.
    pub sentence: String,
    /// Places, values over those of a large lit shape, the truth, and the light of the first reason.
    curves: [Vec<f64>; 4],
}

/// Why a picture cannot be judged.
#[derive(Clone, Debug, PartialEq)]
pub enum Unjudged {
    /// A parameter is outside its range.
    Parameter(ParameterError),
    /// It ends before light has fallen to a quarter: where it ends and where light has \[L\].
    TooSmall([f64; 2]),
    /// Light falls to a quarter within two pixels: where, and the width of a pixel \[L\].
    TooCoarse([f64; 2]),
    /// The channel is dark, or so few pixels beside the edge are lit that its light is not known.
    Dark,
}

impl fmt::Display for Unjudged {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Parameter(error) => error.fmt(f),
            Self::TooSmall([end, wanted]) => write!(
                f,
                "the picture ends {} from the lit shape's edge or center, but light falls to a quarter at {}, and must be \
                 seen to there",
                shown(*end),
                shown(*wanted)
            ),
            Self::TooCoarse([width, pixel]) => write!(
                f,
                "light falls to a quarter at {}, but a pixel is {} wide, and must be half of that or less",
                shown(*width),
                shown(*pixel)
            ),
            Self::Dark => {
                f.write_str("the channel is dark, or lit by fewer than three pixels beside the edge")
            }
        }
    }
}

/// A length of four digits or so.
fn shown(length: f64) -> String {
    if (0.01..1e6).contains(&length) { format!("{length:.4}") } else { format!("{length:.3e}") }
}

impl From<ParameterError> for Unjudged {
    fn from(error: ParameterError) -> Self {
        Self::Parameter(error)
    }
}

impl Pass {
    /// Judges the channel.
    ///
    /// # Errors
    /// The material is outside of all ranges, or the picture shows too little.
    pub fn judge(&self) -> Result<Judgement, Unjudged> {
        let shapes: Vec<LitShape> = self.bins.places.iter().map(|place| self.setup.shape(*place)).collect();
        let Self { setup, appearance, configuration, .. } = *self;
        let material = Material::new(appearance, self.eta);
        let places = &self.bins.places;
        let subject = Subject {
            material: &material,
            configuration,
            cell: 0.5 * self.pixel,
            setup,
            shapes: &shapes,
            places,
        };
        let truth = subject.truth(1.0)?;
        let true_widths = LEVELS.map(|level| self.width(&truth, level));
        let reach = self.bins.places.last().copied().unwrap_or(0.0);
        if true_widths[0].is_nan() {
            return Err(Unjudged::TooSmall([reach, self.wanted(&subject)?]));
        }
        if true_widths[0] < 2.0 * self.pixel {
            return Err(Unjudged::TooCoarse([true_widths[0], self.pixel]));
        }

        // Bring the picture to the light of a large lit shape
        let scale = self.scale(&truth);
        if scale.is_nan() || scale <= 0.0 {
            return Err(Unjudged::Dark);
        }
        let values: Vec<f64> = self.bins.values.iter().map(|value| value / scale).collect();
        let counting = self.counting(&truth);
        let distance = |curve: &[f64]| self.rms(&values, curve, &counting);
        let rms = distance(&truth);
        let largest = (0..values.len()).filter(|i| counting[*i]).map(|i| (values[i] - truth[i]).abs());
        let widths = [0, 1, 2].map(|i| [self.width(&values, LEVELS[i]), true_widths[i]]);
        let errors: Vec<f64> = self.bins.errors.iter().map(|error| error / scale).collect();
        let counted: Vec<f64> =
            errors.iter().zip(&counting).filter(|(_, counts)| **counts).map(|(e, _)| *e).collect();
        let count = counted.len().max(1) as f64;
        let noise = (counted.iter().map(|error| error * error).sum::<f64>() / count).sqrt();
        let clean = |rms: f64| cleaned(rms, noise);
        let pixel_noise = self.pixel_noise(scale, &truth);
        let light_error = self.white.map(|white| scale / (white * appearance.surface_albedo) - 1.0);
        let mut judgement = Judgement {
            light_error,
            rms,
            largest: largest.fold(0.0, f64::max),
            noise,
            pixel_noise,
            width_errors: true_widths.map(|width| self.width_error(&truth, &errors, width)),
            // The square of a difference is known up to that of noise times the root of 2/n
            is_hidden: noise * (8.0 / count).powf(0.25) > RIGHT_RMS,
            rivals: Vec::new(),
            widths,
            causes: Vec::new(),
            explained_rms: None,
            sentence: String::new(),
            curves: [self.bins.places.clone(), values.clone(), truth.clone(), Vec::new()],
        };

        let explains = |left: f64| clean(left) < EXPLAINS[0] * clean(rms) && clean(left) < EXPLAINS[1];
        if !judgement.has_right_shape() && !judgement.is_hidden {
            let candidates = subject.candidates(&truth, &distance)?;
            let others: Vec<(Cause, f64)> =
                candidates.iter().map(|other| (other.cause, distance(&other.curve))).collect();
            if self.is_separable(scale, &counting) {
                judgement.causes.push(Cause::Separable);
            } else if let Some((best, left)) =
                closest(candidates, &distance).filter(|(_, left)| explains(*left))
            {
                let is_near =
                    |found: f64| (found * found - left * left).abs() * count < APART * noise * noise;
                let rivals = others.into_iter().filter(|(cause, found)| {
                    !best.cause.is_a_case_of(cause) && explains(*found) && is_near(*found)
                });
                judgement.rivals = rivals.map(|(cause, _)| cause).collect();
                judgement.explained_rms = Some(left);
                if judgement.rivals.is_empty() {
                    judgement.causes.push(best.cause);
                } else {
                    judgement.rivals.insert(0, best.cause);
                }
                if matches!(best.cause, Cause::Size(_)) {
                    // All light is that of the shape that is seen
                    let scale = self.scale(&best.curve);
                    judgement.light_error =
                        self.white.map(|white| scale / (white * appearance.surface_albedo) - 1.0);
                }
                judgement.curves[3] = best.curve;
            }
        }
        if let Some(error) = judgement.light_error.filter(|error| error.abs() > RIGHT_LIGHT) {
            judgement.causes.push(Cause::Light(1.0 + error));
        }
        judgement.sentence =
            judgement.words(setup, appearance.surface_albedo, material.dmfp_over_mfp(configuration)?);
        Ok(judgement)
    }

    /// Value of a large lit shape in the picture, by which its shape has as much light as the truth.
    ///
    /// Beside an edge light that is missing on the lit side is on the dark one, whatever the profile.
    fn scale(&self, truth: &[f64]) -> f64 {
        let Bins { places, values, .. } = &self.bins;
        if self.setup == Setup::Edge {
            let reach = places.last().copied().unwrap_or(0.0).min(-places.first().copied().unwrap_or(0.0));
            let pairs = places.iter().zip(values).filter(|(x, _)| (2.0 * self.pixel..reach).contains(*x));
            let sums: Vec<f64> =
                pairs.filter_map(|(x, value)| Some(value + at(places, values, -x)?)).collect();
            return sums.iter().sum::<f64>() / sums.len() as f64;
        }
        let sum = |curve: &[f64]| -> f64 {
            places.iter().zip(curve).map(|(x, value)| self.setup.area(*x) * value).sum()
        };
        sum(values) / sum(truth)
    }

    /// Whether a place counts: there is light beside the shape, and it is not at the rim, where pixels are lit in part.
    fn counting(&self, truth: &[f64]) -> Vec<bool> {
        let peak = truth.iter().copied().fold(0.0, f64::max);
        let seen = |(x, value): (&f64, &f64)| {
            let is_bright = self.setup == Setup::Edge && *value > 1.0 - LEAST;
            *value > LEAST * peak && !is_bright && (x.abs() - self.setup.rim()).abs() > self.pixel
        };
        self.bins.places.iter().zip(truth).map(seen).collect()
    }

    /// RMS difference of two curves, of a disk and a line the second with as much light as the first.
    fn rms(&self, values: &[f64], curve: &[f64], counting: &[bool]) -> f64 {
        let light = |curve: &[f64]| -> f64 {
            self.bins.places.iter().zip(curve).map(|(x, value)| self.setup.area(*x) * value).sum()
        };
        let scale = if self.setup == Setup::Edge { 1.0 } else { light(values) / light(curve).max(1e-300) };
        let (mut sum, mut count) = (0.0, 0.0);
        for i in (0..values.len()).filter(|i| counting[*i]) {
            sum += (values[i] - scale * curve[i]).powi(2);
            count += 1.0;
        }
        if count == 0.0 { 0.0 } else { (sum / count).sqrt() }
    }

    /// Place on the dark side, or from the center on, at which a curve falls to a part of its light; not a number if it does
    /// not.
    fn width(&self, curve: &[f64], level: f64) -> f64 {
        let places = &self.bins.places;
        let first = places.partition_point(|x| *x <= 0.0);
        let whole = if self.setup == Setup::Edge { 1.0 } else { curve.get(first).copied().unwrap_or(0.0) };
        let level = level * whole;
        for i in first.max(1)..places.len() {
            let [before, after] = [curve[i - 1], curve[i]];
            if after <= level {
                let part = if before > level { (before - level) / (before - after) } else { 1.0 };
                return places[i - 1] + part * (places[i] - places[i - 1]);
            }
        }
        f64::NAN
    }

    /// Median noise of a pixel as a part of its light, where that is at least half of the most.
    fn pixel_noise(&self, scale: f64, truth: &[f64]) -> f64 {
        let most = truth.iter().copied().fold(0.0, f64::max);
        let bright = self.bins.scatter.iter().zip(truth).filter(|(_, light)| **light >= 0.5 * most);
        let mut parts: Vec<f64> = bright.map(|(scatter, light)| scatter / (scale * light)).collect();
        parts.sort_by(f64::total_cmp);
        parts.get(parts.len() / 2).copied().unwrap_or(0.0)
    }

    /// Standard error of a width by that of the light there.
    fn width_error(&self, truth: &[f64], errors: &[f64], width: f64) -> f64 {
        let places = &self.bins.places;
        let i = places.partition_point(|x| *x < width).clamp(1, places.len() - 1);
        let slope = (truth[i] - truth[i - 1]) / (places[i] - places[i - 1]);
        errors.get(i).map_or(0.0, |error| error / slope.abs().max(1e-12))
    }

    /// Where the truth falls to a quarter, beyond the picture.
    fn wanted(&self, subject: &Subject<'_>) -> Result<f64, Unjudged> {
        let mut places: Vec<f64> =
            (0..4000).map(|i| 0.25 * self.pixel * libm::exp(0.03 * f64::from(i))).collect();
        places.insert(0, 0.0);
        let shapes: Vec<LitShape> = places.iter().map(|place| self.setup.shape(*place)).collect();
        let truth = Subject { shapes: &shapes, places: &places, ..*subject }.truth(1.0)?;
        let bins = Bins { places, ..Bins::default() };
        Ok(Self { bins, ..self.clone() }.width(&truth, LEVELS[0]))
    }

    /// Whether light depends on the direction from a disk's center, beyond its rim and noise.
    fn is_separable(&self, scale: f64, counting: &[bool]) -> bool {
        let Some([axes, diagonals]) = &self.bins.directions else { return false };
        let both: Vec<[f64; 2]> = (0..counting.len())
            .filter(|i| counting[*i] && self.bins.places[*i] > self.setup.rim() + self.pixel)
            .map(|i| [axes[i] / scale, diagonals[i] / scale])
            .collect();
        let difference: f64 = both.iter().map(|[a, b]| a - b).sum();
        let light: f64 = both.iter().map(|[a, b]| a + b).sum();
        difference.abs() > SEPARABLE * light
    }
}

/// Difference of light along axes and diagonals over all of it, above which a gather is separable.
const SEPARABLE: f64 = 0.05;

/// The cause that is closest; one without a parameter if that is not much farther.
fn closest(candidates: Vec<Candidate>, distance: &dyn Fn(&[f64]) -> f64) -> Option<(Candidate, f64)> {
    let is_plain = |cause: &Cause| matches!(cause, Cause::NormalizedDiffusion | Cause::Configuration);
    let weighed = candidates.into_iter().map(|candidate| {
        let left = distance(&candidate.curve);
        let weight = if is_plain(&candidate.cause) { SIMPLER } else { 1.0 };
        (candidate, left, weight * left)
    });
    let best = weighed.min_by(|a, b| a.2.total_cmp(&b.2))?;
    Some((best.0, best.1))
}

/// Value between places, none outside.
fn at(places: &[f64], values: &[f64], x: f64) -> Option<f64> {
    let i = places.partition_point(|place| *place <= x);
    if i == 0 || i == places.len() {
        return None;
    }
    let part = (x - places[i - 1]) / (places[i] - places[i - 1]);
    Some(values[i - 1] + part * (values[i] - values[i - 1]))
}

impl Judgement {
    /// Greatest difference of the widths that both have, as a part.
    pub fn width_error(&self) -> f64 {
        let errors = self.widths.iter().map(|[found, truth]| found / truth - 1.0).filter(|e| e.is_finite());
        errors.max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0)
    }

    fn has_right_shape(&self) -> bool {
        let off =
            |([found, truth], error): (&[f64; 2], &f64)| ((found - truth).abs() - DOUBT * error) / truth;
        let widths = self.widths.iter().zip(&self.width_errors).map(off).filter(|off| off.is_finite());
        cleaned(self.rms, self.noise) <= RIGHT_RMS && widths.fold(0.0, f64::max) <= RIGHT_WIDTH
    }

    /// "right", the part that is to be mended, or "unknown".
    pub fn verdict(&self) -> &'static str {
        match self.causes.first().map(Cause::part) {
            Some(Part::Profile) => "profile",
            Some(Part::Gather) => "gather",
            Some(Part::Picture) => "picture",
            None if self.is_hidden => "unknown",
            None if self.has_right_shape() => "right",
            None => "unknown",
        }
    }

    fn words(&self, setup: Setup, surface_albedo: f64, dmfp_over_mfp: f64) -> String {
        let percent = |part: f64| format!("{:.1} %", 100.0 * part.abs());
        let [rms, width] = [self.rms, self.width_error()].map(percent);
        let light =
            self.light_error.map_or(String::new(), |error| format!(", {} of all light", percent(error)));
        let known =
            self.widths.iter().zip(&self.width_errors).map(|([_, truth], error)| DOUBT * error / truth);
        let known = known.filter(|part| part.is_finite()).fold(0.0, f64::max);
        let [noise, pixel] = [self.noise, self.pixel_noise].map(percent);
        let noise = match self.noise {
            // Less than is printed
            part if part < 5e-4 => String::new(),
            _ => format!(
                "; noise is {pixel} of a pixel, makes {noise} RMS, and lets widths be known to {}",
                percent(known)
            ),
        };
        if self.verdict() == "right" {
            return format!("right within {rms} (RMS), {width} of its width{light}{noise}");
        }
        if self.is_hidden && self.causes.is_empty() {
            return format!(
                "noise hides whether it is right: take more samples, or show more of the lit shape (off by {rms} RMS, \
                 {width} of its width{light}{noise})"
            );
        }
        let advice = |cause: &Cause| cause.advice(setup, surface_albedo, dmfp_over_mfp);
        let mut advices: Vec<String> = self.causes.iter().map(advice).collect();
        if !self.has_right_shape() && !self.causes.iter().any(|cause| !matches!(cause, Cause::Light(_))) {
            let rivals: Vec<String> = self.rivals.iter().map(advice).collect();
            advices.push(if rivals.is_empty() {
                String::from(
                    "the shape is none of those that are known: compare the kernel's weights with the table `profile` of the \
                     oracle",
                )
            } else {
                format!("noise hides which of {} it is: {}", rivals.len(), rivals.join("; or "))
            });
        }
        format!("{} (off by {rms} RMS, {width} of its width{light}{noise})", advices.join("; and "))
    }

    /// RMS difference that neither the first reason nor noise explains.
    pub fn unexplained(&self) -> f64 {
        cleaned(self.explained_rms.unwrap_or(self.rms), self.noise)
    }

    /// The judgement of a picture whose numbers were decoded as codes of sRGB, which linear ones are not.
    #[must_use]
    pub fn of_codes(mut self) -> Self {
        self.causes.insert(0, Cause::Codes);
        self.sentence = format!(
            "the numbers of the picture are codes of sRGB, not linear light: save it linear; decoded: {}",
            self.sentence
        );
        self
    }
}

/// A difference without that of noise.
fn cleaned(rms: f64, noise: f64) -> f64 {
    (rms * rms - noise * noise).max(0.0).sqrt()
}

/// Picture, truth and explanation of some channels by place; `unit` is that of lengths.
pub fn judgement_chart(channels: &[(&str, &Judgement)], unit: &str) -> Chart {
    let mut chart = Chart::new(
        "judgement",
        "The pass beside the exact light",
        Axis::linear("distance", unit),
        Axis::logarithmic("light", "of a large lit shape").between(2e-3, 1.3),
    );
    for (i, (name, judgement)) in channels.iter().enumerate() {
        let [places, values, truth, explained] = &judgement.curves;
        let points = |curve: &[f64]| places.iter().zip(curve).map(|(x, y)| [*x, *y]).collect::<Vec<_>>();
        chart.series.push(Series::new(&format!("{name}: exact"), Ink::Reference, Mark::Line, points(truth)));
        if !explained.is_empty() {
            let label = format!("{name}: explanation");
            chart.series.push(Series::new(&label, Ink::Numbered(i + 3), Mark::Line, points(explained)));
        }
        chart.series.push(Series::new(
            &format!("{name}: picture"),
            Ink::Numbered(i),
            Mark::Points,
            points(values),
        ));
    }
    chart
}

/// The diffuse mean free path of a material as its length, or the mean free path.
pub fn appearance(surface_albedo: f64, length: f64, is_dmfp: bool, g: f64) -> Appearance {
    let parameterization = if is_dmfp { Parameterization::Dmfp } else { Parameterization::Mfp };
    Appearance { surface_albedo, length, parameterization, g }
}

#[cfg(test)]
mod tests;
