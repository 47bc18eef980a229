//! Reasons why a pass may be wrong, and the light that each would draw.

use translucid_profile::{Configuration, Model, ParameterError, Parameterization, Profile};
use translucid_reference::Estimate;

use super::material::Material;
use super::setup::Setup;
use crate::oracle::{LitShape, Spread};

/// Reason why a pass is not as the truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cause {
    /// The right profile at so many times the width.
    Width(f64),
    /// The right profile for light that enters otherwise.
    Configuration,
    /// The right profile without the phase function and the boundary.
    Medium,
    /// The lit shape has so many times the size.
    Size(f64),
    /// Burley's normalized diffusion of 2015.
    NormalizedDiffusion,
    /// Its shape, at so many times the width.
    NormalizedDiffusionOfWidth(f64),
    /// The pixel itself has that part of all weights more than it should, or less where it is negative.
    Center(f64),
    /// R(|x|) is the kernel of blurs along x and y, in place of R(√(x² + y²)) over the plane.
    Slice,
    /// Samples of a ring of radius r count as R(r), not as R(r) 2πr.
    Unweighted,
    /// Light around a disk depends on the direction.
    Separable,
    /// The weights do not add up to 1: so many times the light.
    Light(f64),
    /// The numbers are codes by the curve of sRGB.
    Codes,
}

/// The part of a pass that is to be mended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The profile, or its width.
    Profile,
    /// The weights and places of the samples.
    Gather,
    /// The picture, or the size that is stated for it.
    Picture,
}

impl Cause {
    /// The part that is to be mended.
    pub fn part(&self) -> Part {
        match self {
            Self::Size(_) | Self::Codes => Part::Picture,
            Self::Width(_)
            | Self::Configuration
            | Self::Medium
            | Self::NormalizedDiffusion
            | Self::NormalizedDiffusionOfWidth(_) => Part::Profile,
            Self::Center(_) | Self::Slice | Self::Unweighted | Self::Separable | Self::Light(_) => {
                Part::Gather
            }
        }
    }

    /// Whether another cause is this one with any parameter.
    pub(super) fn is_a_case_of(&self, other: &Self) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(other)
            || matches!((self, other), (Self::NormalizedDiffusion, Self::NormalizedDiffusionOfWidth(_)))
    }

    /// Advice on the change, in words; `dmfp_over_mfp` is that of the material.
    pub(super) fn advice(&self, setup: Setup, surface_albedo: f64, dmfp_over_mfp: f64) -> String {
        let refined = "normalized-diffusion-refined is within 0.3 %";
        match self {
            Self::Width(s) => {
                let percent = 100.0 * (s - 1.0);
                let near = |other: f64| (s / other - 1.0).abs() < 0.03;
                let hint = if near(dmfp_over_mfp) {
                    ": a diffuse mean free path stands where a mean free path is meant"
                } else if near(1.0 / dmfp_over_mfp) {
                    ": a mean free path stands where a diffuse one is meant"
                } else {
                    ": check the unit of the length, and the pixel's width"
                };
                format!("the profile has the right shape, but its width is {percent:+.0} % off{hint}")
            }
            Self::Configuration => String::from(
                "the profile is that of the other configuration: searchlight is a perpendicular pencil, diffuse is light \
                 from all around",
            ),
            Self::Medium => String::from(
                "the profile is that of isotropic scatterers without a boundary: it has neither --g nor --eta",
            ),
            Self::Size(times) => {
                let [found, stated] = [times, &1.0].map(|times| times * setup.size());
                format!(
                    "the lit shape of the picture is {found:.4} wide, and not {stated:.4}: check the size, and the pixel's width"
                )
            }
            Self::NormalizedDiffusion => {
                format!("the gather is right, but the profile is Burley's of 2015; {refined}")
            }
            Self::NormalizedDiffusionOfWidth(s) => format!(
                "the profile has the shape of Burley's of 2015 at {s:.2} times its width for this length; {refined}"
            ),
            Self::Center(weight) => format!(
                "the profile is right, but the pixel itself weighs {:+.0} % of all light: weigh it by the light within its \
                 cell",
                100.0 * weight
            ),
            Self::Slice => String::from(
                "the gather blurs along lines by the slice R(|x|) of the profile: gather over a disk (export --what disk), or \
                 blur by the profile's best product (export --what kernel)",
            ),
            Self::Unweighted => String::from(
                "the gather weighs samples by R(r) that stand for rings: weigh them by R(r) 2πr dr, or draw radii from the \
                 cdf (export --what disk)",
            ),
            Self::Separable => String::from(
                "light around the disk depends on the direction: a separable gather is a cross; gather over a disk (export \
                 --what disk)",
            ),
            Self::Codes => String::from("the numbers of the picture are codes of sRGB: save it linear"),
            Self::Light(times) if (times / surface_albedo - 1.0).abs() < 0.01 => {
                String::from("the surface albedo counts twice: before the gather and after it")
            }
            Self::Light(times) if (times * surface_albedo - 1.0).abs() < 0.01 => {
                String::from("the surface albedo does not count")
            }
            Self::Light(times) => format!(
                "the gather returns {times:.3} times the light: divide the weights by their sum, channel by channel"
            ),
        }
    }
}

/// Light that is drawn if something is wrong, at places beside the shape.
pub(super) struct Candidate {
    pub(super) cause: Cause,
    pub(super) curve: Vec<f64>,
}

/// A material under the light of a setup, and where it is looked at.
pub(super) struct Subject<'a> {
    pub(super) material: &'a Material,
    pub(super) configuration: Configuration,
    /// Half of a pixel's width.
    pub(super) cell: f64,
    pub(super) setup: Setup,
    /// The shapes of all places.
    pub(super) shapes: &'a [LitShape],
    /// The places.
    pub(super) places: &'a [f64],
}

impl Subject<'_> {
    /// The exact light of the material, its length times a factor.
    pub(super) fn truth(&self, factor: f64) -> Result<Vec<f64>, ParameterError> {
        Ok(self.responses(&*self.material.exact(self.configuration, factor)?))
    }

    /// The light of Burley's profile, its length times a factor.
    fn burley(&self, configuration: Configuration, factor: f64) -> Result<Vec<f64>, ParameterError> {
        let profile = self.material.model(Model::NormalizedDiffusion, configuration, factor)?;
        Ok(self.responses(&*profile))
    }

    /// The exact light beside a shape of another size.
    fn resized(&self, factor: f64) -> Result<Vec<f64>, ParameterError> {
        let setup = self.setup.resized(factor);
        let shapes: Vec<LitShape> = self.places.iter().map(|place| setup.shape(*place)).collect();
        Subject { shapes: &shapes, ..*self }.truth(1.0)
    }

    /// Light at all places, as a part of that of an endless plane.
    fn responses(&self, spread: &(impl Spread + ?Sized)) -> Vec<f64> {
        let total = spread.total().value;
        self.shapes.iter().map(|shape| shape.response(spread).value / total).collect()
    }

    /// All that may be wrong, each with the parameter that brings it closest by a measure of distance.
    pub(super) fn candidates(
        &self,
        truth: &[f64],
        distance: &dyn Fn(&[f64]) -> f64,
    ) -> Result<Vec<Candidate>, ParameterError> {
        let other = match self.configuration {
            Configuration::Searchlight => Configuration::Diffuse,
            Configuration::Diffuse => Configuration::Searchlight,
        };
        let mut all = Vec::new();
        let mut add = |cause: Cause, curve: Vec<f64>| all.push(Candidate { cause, curve });
        // Burley's profile knows not every phase function
        if let Ok(curve) = self.burley(self.configuration, 1.0) {
            add(Cause::NormalizedDiffusion, curve);
            // There is one fit for diffuse mean free paths
            if self.material.appearance.parameterization == Parameterization::Mfp {
                add(Cause::NormalizedDiffusion, self.burley(other, 1.0)?);
            }
            let (factor, curve) = best_factor(&|factor| self.burley(self.configuration, factor), distance)?;
            add(Cause::NormalizedDiffusionOfWidth(factor), curve);
        }
        add(Cause::Configuration, self.responses(&*self.material.exact(other, 1.0)?));
        if !self.material.is_plain() {
            let plain = self.material.plain(self.configuration)?;
            add(Cause::Medium, self.responses(&*plain.exact(self.configuration, 1.0)?));
        }
        let (factor, curve) = best_factor(&|factor| self.truth(factor), distance)?;
        add(Cause::Width(factor), curve);
        if self.setup != Setup::Edge {
            let (factor, curve) = best_factor(&|factor| self.resized(factor), distance)?;
            add(Cause::Size(factor), curve);
        }

        // Weights of the pixel itself, which nobody can know: the best one
        let lit: Vec<f64> =
            self.shapes.iter().map(|shape| shape.lit_part_of_circle(1e-9 * self.cell)).collect();
        let (weight, curve) = best_center(truth, &lit, [-0.5, 0.95], distance);
        add(Cause::Center(weight), curve);
        let burley = self.material.model(Model::NormalizedDiffusion, self.configuration, 1.0);
        for profile in [self.material.exact(self.configuration, 1.0), burley].into_iter().flatten() {
            let rings = Line::new(&*profile, self.cell);
            if let Some(slices) = rings.slices(self.shapes) {
                add(Cause::Slice, best_center(&slices, &lit, [0.0, 0.95], distance).1);
            }
            add(Cause::Unweighted, best_center(&self.responses(&rings), &lit, [0.0, 0.95], distance).1);
        }
        Ok(all)
    }
}

/// The factor of a length that brings a curve closest, by a search on a logarithmic scale.
fn best_factor(
    curve: &dyn Fn(f64) -> Result<Vec<f64>, ParameterError>,
    distance: &dyn Fn(&[f64]) -> f64,
) -> Result<(f64, Vec<f64>), ParameterError> {
    let at = |x: f64| Ok::<f64, ParameterError>(distance(&curve(libm::exp(x))?));
    let (mut best, mut step) = (0.0, 0.4);
    let mut least = at(best)?;
    for x in (-4..=4).map(|i| 0.4 * f64::from(i)) {
        let found = at(x)?;
        if found < least {
            (best, least) = (x, found);
        }
    }
    while step > 1e-3 {
        step *= 0.5;
        for x in [best - step, best + step] {
            let found = at(x)?;
            if found < least {
                (best, least) = (x, found);
            }
        }
    }
    Ok((libm::exp(best), curve(libm::exp(best))?))
}

/// A curve mixed with light that does not spread, by the part in a range that brings it closest.
fn best_center(
    curve: &[f64],
    lit: &[f64],
    [low, high]: [f64; 2],
    distance: &dyn Fn(&[f64]) -> f64,
) -> (f64, Vec<f64>) {
    let mixed = |part: f64| -> Vec<f64> {
        curve.iter().zip(lit).map(|(curve, lit)| curve + part * (lit - curve)).collect()
    };
    let parts = (0..=200).map(|i| low + (high - low) * f64::from(i) / 200.0);
    let best = parts.map(|part| (part, distance(&mixed(part)))).min_by(|a, b| a.1.total_cmp(&b.1));
    let part = best.map_or(0.0, |(part, _)| part);
    (part, mixed(part))
}

/// Integral of R(r) along a ray from half a pixel on: what counts where rings are taken for places on a line.
struct Line {
    /// ln of the radii, from the half pixel on.
    first: f64,
    /// ∫ R dr from the half pixel to each radius.
    sums: Vec<f64>,
}

/// Step of ln r, and steps.
const STEP: f64 = 0.02;
const STEPS: usize = 700;

impl Line {
    fn new(profile: &dyn Profile, cell: f64) -> Self {
        let first = libm::log(cell);
        let value = |i: usize| profile.eval_times_r(libm::exp(first + STEP * i as f64));
        let mut sums = vec![0.0];
        for i in 1..=STEPS {
            sums.push(sums[i - 1] + 0.5 * STEP * (value(i - 1) + value(i)));
        }
        Self { first, sums }
    }

    /// Part of the integral up to r.
    fn within(&self, r: f64) -> f64 {
        let all = self.sums[STEPS];
        let place = ((libm::log(r.max(1e-300)) - self.first) / STEP).clamp(0.0, STEPS as f64 - 1e-9);
        let (i, part) = (place as usize, place.fract());
        (self.sums[i] + part * (self.sums[i + 1] - self.sums[i])) / all
    }

    /// Light of a kernel R(|x|) along x across lines; nothing for disks.
    fn slices(&self, shapes: &[LitShape]) -> Option<Vec<f64>> {
        // Light beyond x, of which as much goes to the other side
        let beyond = |x: f64| 0.5 + 0.5 * if x < 0.0 { self.within(-x) } else { -self.within(x) };
        let light = |shape: &LitShape| match *shape {
            LitShape::Edge { distance } => Some(beyond(distance)),
            LitShape::Line { width, offset } => {
                Some(beyond(offset - 0.5 * width) - beyond(offset + 0.5 * width))
            }
            LitShape::Disk { .. } => None,
        };
        shapes.iter().map(light).collect()
    }
}

impl Spread for Line {
    fn total(&self) -> Estimate {
        Estimate { value: 1.0, error: 0.0 }
    }

    fn enclosed(&self, r: f64) -> Estimate {
        Estimate { value: self.within(r), error: 0.0 }
    }

    fn beyond(&self, r: f64) -> Estimate {
        Estimate { value: 1.0 - self.within(r), error: 0.0 }
    }
}
