//! Synthetic photographs of an edge of light with a white card, whose material is known.

use std::f64::consts::{FRAC_PI_2, TAU};

use translucid_measure::{NamedPhoto, Photo, Photographs, Samples};
use translucid_reference::Incidence;
use translucid_reference::exact::HalfSpace;
use translucid_testing::SplitMix;

/// Width of a pixel \[mm\].
pub(crate) const PIXEL: f64 = 0.1;

const SIZE: [usize; 2] = [150, 90];

/// Half the edge of the white card, and of the part of it that is named.
const CARD: usize = 8;
const NAMED: usize = 5;

/// The reflectance that is stated of the white card, and the relative standard deviation of the true one.
const WHITE: f64 = 0.9;
const WHITE_ERROR: f64 = 0.02;

/// Light beside an edge by the exact profile in space, for surface albedos 0.2, 0.25, … 0.95.
pub(crate) struct ExactEdges(Vec<Vec<f64>>);

/// Distances of the table \[ℓ\].
const STEP: f64 = 0.05;
const STEPS: usize = 400;

impl ExactEdges {
    const ALBEDOS: usize = 16;

    pub(crate) fn new() -> Self {
        Self((0..Self::ALBEDOS).map(|i| beyond_lines(Self::albedo(i))).collect())
    }

    pub(crate) fn albedo(i: usize) -> f64 {
        0.2 + 0.05 * i as f64
    }

    /// Light across an edge with hardly any noise, of three surface albedos and ℓ = 0.5 mm.
    #[allow(dead_code, reason = "the test needs photographs only")]
    pub(crate) fn samples(&self, albedos: [usize; 3], random: &mut SplitMix) -> Samples {
        let places: Vec<f64> = (-70..70).map(|i| PIXEL * (f64::from(i) + 0.5)).collect();
        let mut value = |i: usize, x: f64| Self::albedo(i) * self.at(i, x / 0.5) + 1e-4 * normal(random);
        let blocks =
            (0..12).map(|_| places.iter().map(|x| albedos.map(|i| value(i, *x))).collect()).collect();
        Samples { places, pixel_width: PIXEL, blocks, along: [0.0; 2] }
    }

    /// Over the light far on the lit side, at a distance toward the light \[ℓ\].
    fn at(&self, i: usize, x: f64) -> f64 {
        let place = (x.abs() / STEP).min(STEPS as f64 - 2.0);
        let (j, t) = (place as usize, place.fract());
        let beyond = self.0[i][j] + t * (self.0[i][j + 1] - self.0[i][j]);
        if x < 0.0 { beyond } else { 1.0 - beyond }
    }
}

/// The share of light beyond lines at distances 0, h, 2h, …
fn beyond_lines(surface_albedo: f64) -> Vec<f64> {
    let half_space =
        HalfSpace::from_surface_albedo(surface_albedo, Incidence::Cosine).expect("it is in [0, 1)");
    // The logarithm over that of the radius: straight to 1e-5 in between
    let (first, step) = ((0.9 * STEP).ln(), 0.01);
    let outside_at = |i: i32| half_space.beyond((first + step * f64::from(i)).exp()).value.max(1e-300).ln();
    let logarithms: Vec<f64> = (0..1200).map(outside_at).collect();
    let outside = |r: f64| {
        let place = ((r.ln() - first) / step).min(1198.0);
        let (i, t) = (place as usize, place.fract());
        (logarithms[i] + t * (logarithms[i + 1] - logarithms[i])).exp()
    };
    let n = 200;
    let beyond = |x: f64| {
        let outside = |i: i32| match i {
            _ if i == n => 0.0,
            _ => outside(x / (FRAC_PI_2 * f64::from(i) / f64::from(n)).cos()),
        };
        // ∫ acos(x/r)/π dE over rings
        let share = |i: i32| (outside(i) - outside(i + 1)) * (f64::from(i) + 0.5) / f64::from(2 * n);
        (0..n).map(share).sum::<f64>() / surface_albedo
    };
    (0..STEPS).map(|i| if i == 0 { 0.5 } else { beyond(STEP * i as f64) }).collect()
}

/// A photograph, its material, and how it is to be measured.
pub(crate) struct Synthetic {
    pub(crate) photographs: Photographs,
    pub(crate) surface_albedos: [f64; 3],
    /// \[mm\]
    pub(crate) mfps: [f64; 3],
    /// The named part of the white card.
    pub(crate) white: [usize; 4],
    /// Whether the dark side shows the card.
    #[allow(dead_code, reason = "the test does not ask")]
    pub(crate) is_card_seen: bool,
}

impl Synthetic {
    /// A photograph of random material, light and camera.
    pub(crate) fn new(edges: &ExactEdges, random: &mut SplitMix) -> Self {
        let mut between = |low: f64, high: f64| low + (high - low) * random.uniform();
        let albedos =
            [0; 3].map(|_| (between(0.0, ExactEdges::ALBEDOS as f64) as usize).min(ExactEdges::ALBEDOS - 1));
        let mfps = [0; 3].map(|_| PIXEL * between(2.5, 5.0));
        let stray = between(0.0, 0.05);
        let slopes = [0; 2].map(|_| between(-0.3, 0.3));
        let (blur, noise) = (between(0.3, 1.0), between(0.003, 0.015));
        let angle = between(-0.15, 0.15) + if between(0.0, 1.0) < 0.5 { 0.0 } else { TAU / 2.0 };
        let position = between(-20.0, -8.0);
        let is_card_seen = between(0.0, 1.0) < 0.5;
        let card = between(0.0, 0.04);
        let white = WHITE * (1.0 + WHITE_ERROR * normal(random));

        let [width, height] = SIZE;
        let (sin, cos) = angle.sin_cos();
        // The corner far in the light
        let center = if cos > 0.0 { [width - 2 * CARD, 2 * CARD] } else { [2 * CARD, height - 2 * CARD] };
        let profiles = [0, 1, 2].map(|c| {
            let lit = |x: f64| {
                let light = ExactEdges::albedo(albedos[c]) * edges.at(albedos[c], PIXEL * x / mfps[c]);
                if is_card_seen && x < 0.0 { card } else { light }
            };
            Profile::new(lit, blur, 1.3 * width as f64)
        });
        let photo = Photo::from_fn(width, height, |_, _| [0.0; 3]);
        let pixels = (0..width * height).map(|i| {
            let [x, y] = [i % width, i / width];
            let offset = [x as f64 + 0.5 - 0.5 * width as f64, y as f64 + 0.5 - 0.5 * height as f64];
            let light = 1.0 + slopes[0] * offset[0] / width as f64 + slopes[1] * offset[1] / height as f64;
            let distance = offset[0] * cos + offset[1] * sin - position;
            let is_white = x.abs_diff(center[0]) < CARD && y.abs_diff(center[1]) < CARD;
            std::array::from_fn(|c| {
                let reflectance = if is_white { white } else { profiles[c].at(distance) };
                let value = 0.7 * (light * reflectance + stray);
                (value + noise * (0.1 + value).sqrt() * normal(random)) as f32
            })
        });
        let photo = Photo { pixels: pixels.collect(), ..photo };
        Self {
            photographs: Photographs {
                photo: NamedPhoto { name: String::from("synthetic"), photo },
                exposures: Vec::new(),
                dark: None,
                white: None,
            },
            surface_albedos: albedos.map(ExactEdges::albedo),
            mfps,
            white: [center[0] - NAMED, center[1] - NAMED, center[0] + NAMED, center[1] + NAMED],
            is_card_seen,
        }
    }
}

/// Light by the distance across the edge \[pixels\], blurred by the camera and by the width of a pixel.
struct Profile(Vec<f64>, f64);

const PER_PIXEL: f64 = 20.0;

impl Profile {
    fn new(light: impl Fn(f64) -> f64, blur: f64, reach: f64) -> Self {
        let n = (2.0 * reach * PER_PIXEL) as usize;
        let sharp: Vec<f64> = (0..n).map(|i| light((i as f64 + 0.5) / PER_PIXEL - reach)).collect();
        let half = (4.0 * blur * PER_PIXEL) as usize;
        let gauss: Vec<f64> = (0..=2 * half)
            .map(|i| (-0.5 * ((i as f64 - half as f64) / PER_PIXEL / blur).powi(2)).exp())
            .collect();
        let pixel = vec![1.0; PER_PIXEL as usize + 1];
        Self(smoothed(&smoothed(&sharp, &gauss), &pixel), reach)
    }

    fn at(&self, x: f64) -> f64 {
        let place = ((x + self.1) * PER_PIXEL - 0.5).clamp(0.0, self.0.len() as f64 - 2.0);
        let (i, t) = (place as usize, place.fract());
        self.0[i] + t * (self.0[i + 1] - self.0[i])
    }
}

/// Means with weights around each value; the ends go on.
fn smoothed(values: &[f64], weights: &[f64]) -> Vec<f64> {
    let (sum, half) = (weights.iter().sum::<f64>(), weights.len() / 2);
    let at = |i: usize| {
        let value = |(j, w): (usize, &f64)| w * values[(i + j).saturating_sub(half).min(values.len() - 1)];
        weights.iter().enumerate().map(value).sum::<f64>() / sum
    };
    (0..values.len()).map(at).collect()
}

fn normal(random: &mut SplitMix) -> f64 {
    (-2.0 * (1.0 - random.uniform()).ln()).sqrt() * (TAU * random.uniform()).cos()
}
