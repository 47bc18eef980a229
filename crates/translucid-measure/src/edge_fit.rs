//! Mean free paths and surface albedos that explain the light beside an opaque card.
//!
//! ```text
//! v_c(x) = b_c + g_c (1 + m_c x) E(x; A_c, ℓ_c, x₀, σ)
//! ```
//!
//! for a channel c with the gain g, stray light b and the slope m of uneven light; where the card ends and the camera's blur
//! are the same for all channels. Where v is reflectance, g is the surface albedo itself, less what a boundary reflects.
//! Where the camera sees the card instead of what is below it, the lit side alone tells:
//!
//! ```text
//! v_c(x) = G_σ * [ x > x₀ : g_c (1 + m_c x) E(x; A_c, ℓ_c, x₀, 0),  else b_c ]
//! ```
//!
//! Neighboring pixels are not independent, and the noise of a photograph is not known.
//! So the picture is cut along the edge into blocks, whose differences tell how far to trust their mean: covariances are
//! those of clusters [K.-Y. Liang and S. L. Zeger, *Longitudinal Data Analysis Using Generalized Linear Models*, 1986].

use std::cell::RefCell;
use std::collections::VecDeque;
use std::f64::consts::FRAC_1_SQRT_2;
use std::ops::RangeInclusive;
use std::rc::Rc;

use nalgebra::{DMatrix, DVector};

use crate::edge::{Edge, EdgeModel};
use crate::least_squares::minimize;
use crate::response::Response;

/// Values across an edge of light, which is dark at small places.
#[derive(Clone, Debug)]
pub struct EdgeSamples {
    /// Places across the edge, rising \[L\].
    pub places: Vec<f64>,
    /// Width of a pixel \[L\].
    pub pixel_width: f64,
    /// Blocks along the edge: for each place the linear values of three channels.
    pub blocks: Vec<Vec<[f64; 3]>>,
}

impl EdgeSamples {
    /// Means of the blocks, by place.
    pub fn means(&self) -> Vec<[f64; 3]> {
        let count = self.blocks.len().max(1) as f64;
        let mean = |i: usize, c: usize| self.blocks.iter().map(|block| block[i][c]).sum::<f64>() / count;
        (0..self.places.len()).map(|i| std::array::from_fn(|c| mean(i, c))).collect()
    }
}

/// What the values are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// Reflectance, by a white card under the same light.
    Reflectance,
    /// Anything in proportion to it: surface albedos are given.
    Relative([f64; 3]),
}

/// What hides the light from the dark side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Card {
    /// Nothing that the camera sees: the dark side shows the piece, as in the shadow that a projector throws.
    Hidden,
    /// A card on the piece: the dark side shows the card.
    Visible,
}

/// A value, and where the truth is with so much confidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The most likely value.
    pub value: f64,
    /// Of 68 %.
    pub likely: [f64; 2],
    /// Of 95 %.
    pub sure: [f64; 2],
}

/// What is known of a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelFit {
    /// Mean free path \[L\]; where [none is seen](Self::is_seen), without meaning.
    pub mfp: Interval,
    /// Whether light is seen to creep: else the edge is as sharp as blur makes it, or brightens evenly across the picture.
    pub is_seen: bool,
    /// Surface albedo, where the values are reflectance.
    pub surface_albedo: Option<Interval>,
    /// Correlation of the two errors, where both are measured.
    pub correlation: f64,
    /// Stray light over the lit side's; the card's own where it is visible.
    pub stray: f64,
    /// Uneven light: by how much it changes over the places, over its mean.
    pub unevenness: f64,
}

/// The fit of all channels.
#[derive(Clone, Debug, PartialEq)]
pub struct EdgeFit {
    /// Red, green and blue.
    pub channels: [ChannelFit; 3],
    /// What the dark side shows.
    pub card: Card,
    /// Where the card ends \[L\].
    pub position: f64,
    /// Standard deviation of the camera's blur \[L\].
    pub blur: f64,
    /// Mean square of the means' residuals over what the blocks' differences lead to expect: 1 where the model is right.
    pub misfit: f64,
    /// The model's values, by place.
    pub light: Vec<[f64; 3]>,
}

/// Parameters that all channels share, and those of each.
const SHARED: usize = 2;
const OF_CHANNEL: usize = 4;
const COUNT: usize = SHARED + 3 * OF_CHANNEL;

/// Mean square of residuals over the noise up to which a hidden card explains the light.
const EXPLAINED: f64 = 1.5;

/// Standard error of ln ℓ from which on nothing is known of a mean free path.
const UNSEEN: f64 = 1.0;

/// Fewest blocks whose differences tell anything.
const FEWEST_BLOCKS: usize = 6;

impl EdgeFit {
    /// Fits the edge, of a card that is hidden where that explains the light, and else of the one that explains it better.
    /// `None` where there are fewer than six blocks or 16 places, numbers that are not finite, or nothing that gets brighter.
    pub fn new(samples: &EdgeSamples, response: &Response, scale: Scale) -> Option<Self> {
        let hidden = Self::with_card(samples, response, scale, Card::Hidden);
        if hidden.as_ref().is_some_and(|fit| fit.misfit < EXPLAINED) {
            return hidden;
        }
        let visible = Self::with_card(samples, response, scale, Card::Visible);
        [hidden, visible].into_iter().flatten().min_by(|a, b| a.misfit.total_cmp(&b.misfit))
    }

    /// Fits the edge of a card that is hidden or visible; `None` as for [`new`](Self::new).
    pub fn with_card(samples: &EdgeSamples, response: &Response, scale: Scale, card: Card) -> Option<Self> {
        let problem = Problem::new(samples, response, scale, card)?;
        let mut steps = problem.scales();
        let residuals = |p: &[f64]| problem.residuals(p, &problem.means);
        let square = |p: &[f64]| residuals(p).iter().map(|r| r * r).sum::<f64>();
        // From far creeping none finds a way to a sharp edge
        let extent = samples.places[samples.places.len() - 1] - samples.places[0];
        let mfps = [0.05 * extent, 0.2 * samples.pixel_width];
        let minima = mfps.map(|mfp| minimize(residuals, &problem.start(mfp), &steps));
        let minimum =
            minima.into_iter().min_by(|a, b| square(&a.parameters).total_cmp(&square(&b.parameters)))?;
        let p = &minimum.parameters;
        steps.truncate(COUNT);
        let covariance = problem.covariance(p, &minimum.weights, &steps)?;
        let degrees = (samples.blocks.len() - 1) as f64;
        let interval = |value: f64, error: f64, map: fn(f64) -> f64| {
            let around = |t: f64| [map(value - t * error), map(value + t * error)];
            Interval {
                value: map(value),
                likely: around(student(0.994_457_883, degrees)),
                sure: around(student(1.959_963_985, degrees)),
            }
        };
        let channel = |c: usize| {
            let first = SHARED + c * OF_CHANNEL;
            // An interval of e^±100 is one of nothing, too
            let error = |i: usize| covariance[(first + i, first + i)].max(0.0).sqrt().min(100.0);
            let is_measured = scale == Scale::Reflectance;
            ChannelFit {
                mfp: interval(p[first], error(0), libm::exp),
                surface_albedo: is_measured.then(|| {
                    // Of the light that the boundary lets in
                    let entering = response.entering();
                    interval(p[first + 1] / entering, error(1) / entering, |a| a)
                }),
                is_seen: error(0) > 0.0 && error(0) < UNSEEN && problem.log_mfps(p[1]).contains(&p[first]),
                correlation: if error(0) * error(1) > 0.0 {
                    (covariance[(first, first + 1)] / error(0) / error(1)).clamp(-1.0, 1.0)
                } else {
                    0.0
                },
                stray: p[first + 2] / p[first + 1],
                unevenness: p[first + 3] * extent,
            }
        };
        let curves = [0, 1, 2].map(|c| problem.light(p, c));
        Some(Self {
            channels: [channel(0), channel(1), channel(2)],
            card,
            position: p[0],
            blur: p[1].abs(),
            misfit: square(p) / (problem.means.len() - COUNT) as f64,
            light: (0..samples.places.len()).map(|i| std::array::from_fn(|c| curves[c][i])).collect(),
        })
    }
}

/// Everything that the residuals are made of.
struct Problem<'a> {
    samples: &'a EdgeSamples,
    response: &'a Response,
    scale: Scale,
    card: Card,
    model: EdgeModel,
    /// Means over blocks, channel by channel at each place.
    means: Vec<f64>,
    /// 1 over their standard errors, by a noise model of the values.
    inverse_errors: Vec<f64>,
    /// Edges that were asked for last, as most parameters change one channel's or none.
    curves: RefCell<VecDeque<(Edge, Rc<Vec<f64>>)>>,
}

/// Edges that are kept: those of three channels, changed and unchanged.
const KEPT: usize = 8;

impl<'a> Problem<'a> {
    fn new(samples: &'a EdgeSamples, response: &'a Response, scale: Scale, card: Card) -> Option<Self> {
        let EdgeSamples { places, pixel_width, blocks } = samples;
        let n = places.len();
        let is_usable = blocks.len() >= FEWEST_BLOCKS
            && n >= 16
            && *pixel_width > 0.0
            && places.iter().all(|x| x.is_finite())
            && blocks.iter().all(|block| block.len() == n && block.iter().flatten().all(|v| v.is_finite()));
        if !is_usable {
            return None;
        }
        let count = blocks.len() as f64;
        let of = |i: usize| blocks.iter().map(move |block| block[i / 3][i % 3]);
        let means: Vec<f64> = (0..3 * n).map(|i| of(i).sum::<f64>() / count).collect();
        let variance = |i: usize| of(i).map(|v| (v - means[i]).powi(2)).sum::<f64>() / (count - 1.0) / count;
        let variances: Vec<f64> = (0..3 * n).map(variance).collect();
        let inverse_errors = noise_model(&means, &variances)?;
        let model = EdgeModel::new(places, *pixel_width);
        let curves = RefCell::default();
        let problem = Self { samples, response, scale, card, model, means, inverse_errors, curves };
        (0..3).all(|c| problem.level(c, true) > problem.level(c, false)).then_some(problem)
    }

    /// Mean of the darkest or the brightest tenth of the places, at the end where it belongs.
    fn level(&self, c: usize, is_lit: bool) -> f64 {
        let n = self.samples.places.len();
        let tenth = (n / 10).max(1);
        let range = if is_lit { n - tenth..n } else { 0..tenth };
        range.map(|i| self.means[3 * i + c]).sum::<f64>() / tenth as f64
    }

    fn extent(&self) -> f64 {
        self.samples.places[self.samples.places.len() - 1] - self.samples.places[0]
    }

    /// Logarithms of mean free paths that a picture of such a blur and such an extent can tell from none and from all: a
    /// lens blurs not quite like a Gaussian.
    fn log_mfps(&self, blur: f64) -> RangeInclusive<f64> {
        libm::log(0.25 * blur.abs().max(self.samples.pixel_width))..=libm::log(3.0 * self.extent())
    }

    fn start(&self, mfp: f64) -> Vec<f64> {
        let places = &self.samples.places;
        // The mean of the channels is half as bright at the shadow's end, and rises most where the card ends
        let mean = |i: usize| self.means[3 * i..3 * i + 3].iter().sum::<f64>();
        let [lit, dark] = [true, false].map(|is_lit| (0..3).map(|c| self.level(c, is_lit)).sum::<f64>());
        let middle = match self.card {
            Card::Hidden => (0..places.len()).find(|i| mean(*i) > 0.5 * (lit + dark)),
            Card::Visible => {
                let rise = |i: &usize| mean(i + 1) - mean(i - 1);
                (1..places.len() - 1).max_by(|i, j| rise(i).total_cmp(&rise(j)))
            }
        };
        let middle = middle.unwrap_or(places.len() / 2);
        let mut start = vec![places[middle], self.samples.pixel_width];
        for c in 0..3 {
            let (lit, dark) = (self.level(c, true), self.level(c, false));
            start.extend([libm::log(mfp), lit - dark, dark, 0.0]);
        }
        start
    }

    /// Sizes of steps that change something.
    fn scales(&self) -> Vec<f64> {
        let mut scales = vec![self.samples.pixel_width; SHARED];
        for c in 0..3 {
            let lit = self.level(c, true);
            scales.extend([0.3, 0.1 * lit, 0.1 * lit, 0.1 / self.extent()]);
        }
        scales
    }

    fn curve(&self, edge: &Edge) -> Rc<Vec<f64>> {
        let mut curves = self.curves.borrow_mut();
        if let Some(i) = curves.iter().position(|(known, _)| known == edge)
            && let Some(found) = curves.remove(i)
        {
            // Last used, last to go
            curves.push_front(found);
        } else {
            curves.truncate(KEPT - 1);
            curves.push_front((*edge, Rc::new(self.model.eval(self.response, edge))));
        }
        Rc::clone(&curves[0].1)
    }

    /// The model's values of a channel.
    fn light(&self, p: &[f64], c: usize) -> Vec<f64> {
        let [position, blur] = [p[0], p[1]];
        let [log_mfp, gain, stray, slope]: [f64; OF_CHANNEL] =
            std::array::from_fn(|i| p[SHARED + c * OF_CHANNEL + i]);
        let surface_albedo = match self.scale {
            Scale::Reflectance => gain / self.response.entering(),
            Scale::Relative(albedos) => albedos[c],
        };
        let mfp = libm::exp(log_mfp).max(1e-3 * self.samples.pixel_width).min(30.0 * self.extent());
        let places = &self.samples.places;
        let lit = |curve: &[f64]| -> Vec<f64> {
            let lit = |(x, light): (&f64, &f64)| gain * (1.0 + slope * (x - position)) * light;
            places.iter().zip(curve).map(lit).collect()
        };
        match self.card {
            Card::Hidden => {
                let curve = self.curve(&Edge { surface_albedo, mfp, position, blur });
                lit(&curve).into_iter().map(|light| stray + light).collect()
            }
            Card::Visible => {
                let curve = self.curve(&Edge { surface_albedo, mfp, position, blur: 0.0 });
                let beside_card = |(x, light): (&f64, f64)| {
                    let covered = (0.5 - (x - position) / self.samples.pixel_width).max(0.0).min(1.0);
                    covered * stray + (1.0 - covered) * light
                };
                let sharp: Vec<f64> = places.iter().zip(lit(&curve)).map(beside_card).collect();
                blurred(&sharp, blur.abs() / self.samples.pixel_width)
            }
        }
    }

    /// Values less the model's over their errors, channel by channel at each place.
    fn residuals(&self, p: &[f64], values: &[f64]) -> Vec<f64> {
        let curves = [0, 1, 2].map(|c| self.light(p, c));
        let residual = |i: usize| (values[i] - curves[i % 3][i / 3]) * self.inverse_errors[i];
        (0..values.len()).map(residual).collect()
    }

    /// Covariance of the parameters by the scores of the blocks.
    fn covariance(&self, p: &[f64], weights: &[f64], steps: &[f64]) -> Option<DMatrix<f64>> {
        let column = |i: usize| {
            let at = |sign: f64| {
                let mut moved = p.to_vec();
                moved[i] += sign * 1e-4 * steps[i];
                self.residuals(&moved, &self.means)
            };
            let slope = |(a, b): (&f64, &f64)| (a - b) / (2e-4 * steps[i]);
            DVector::from_iterator(self.means.len(), at(1.0).iter().zip(&at(-1.0)).map(slope))
        };
        let jacobian = DMatrix::from_columns(&(0..COUNT).map(column).collect::<Vec<_>>());
        let weighted = DMatrix::from_fn(jacobian.nrows(), COUNT, |row, i| jacobian[(row, i)] * weights[row]);
        // A picture without blur says nothing of it: only its size counts
        let step = DMatrix::from_diagonal(&DVector::from_row_slice(steps));
        let normal = &step * (jacobian.transpose() * &weighted) * &step;
        let bread = &step * normal.clone().pseudo_inverse(1e-12 * normal.amax()).ok()? * &step;
        let count = self.samples.blocks.len() as f64;
        let mut meat = DMatrix::<f64>::zeros(COUNT, COUNT);
        for block in &self.samples.blocks {
            // What a block alone would move: its difference from the mean
            let difference =
                |i: usize| (block[i / 3][i % 3] - self.means[i]) * self.inverse_errors[i] / count;
            let difference = DVector::from_iterator(self.means.len(), (0..self.means.len()).map(difference));
            let score = weighted.transpose() * difference;
            meat += &score * score.transpose();
        }
        Some(&bread * meat * &bread * (count / (count - 1.0)))
    }
}

/// Means over pixels under a Gaussian blur, whose standard deviation is in pixels; the ends go on.
fn blurred(values: &[f64], blur: f64) -> Vec<f64> {
    let blur = blur.min(values.len() as f64);
    let reach = (4.0 * blur).ceil() as usize + 1;
    let below =
        |x: f64| if blur > 1e-6 { 0.5 * libm::erfc(-x / blur * FRAC_1_SQRT_2) } else { f64::from(x > 0.0) };
    let weights: Vec<f64> = (0..2 * reach + 1)
        .map(|i| i as f64 - reach as f64)
        .map(|x| below(x + 0.5) - below(x - 0.5))
        .collect();
    let last = values.len() - 1;
    let at = |i: usize| {
        let value = |(j, weight): (usize, &f64)| weight * values[(i + j).saturating_sub(reach).min(last)];
        weights.iter().enumerate().map(value).sum::<f64>()
    };
    (0..values.len()).map(at).collect()
}

/// 1 over the standard errors of means, by a straight line through their variances: reading noise and that of photons.
fn noise_model(means: &[f64], variances: &[f64]) -> Option<Vec<f64>> {
    let n = means.len() as f64;
    let (mean, variance) = (means.iter().sum::<f64>() / n, variances.iter().sum::<f64>() / n);
    let spread: f64 = means.iter().map(|m| (m - mean).powi(2)).sum();
    let joint: f64 = means.iter().zip(variances).map(|(m, v)| (m - mean) * (v - variance)).sum();
    let slope = if spread > 0.0 { (joint / spread).max(0.0) } else { 0.0 };
    let lowest = means.iter().copied().fold(f64::MAX, f64::min);
    // Nothing is exact, and nothing far more so than all the rest
    let least = (0.05 * variance).max(1e-12 * mean * mean);
    let at = |m: f64| (variance + slope * (m - mean)).max(least).max(slope * (m - lowest) * 0.1);
    (least > 0.0).then(|| means.iter().map(|m| 1.0 / at(*m).sqrt()).collect())
}

/// Quantile of Student's t where that of the normal distribution is z, for five degrees of freedom and more, to 0.5 %
/// [E. A. Cornish and R. A. Fisher 1937].
fn student(z: f64, degrees: f64) -> f64 {
    let z2 = z * z;
    let first = z * (z2 + 1.0) / 4.0;
    let second = z * (5.0 * z2 * z2 + 16.0 * z2 + 3.0) / 96.0;
    let third = z * (3.0 * z2.powi(3) + 19.0 * z2 * z2 + 17.0 * z2 - 15.0) / 384.0;
    z + first / degrees + second / degrees.powi(2) + third / degrees.powi(3)
}

#[cfg(test)]
mod tests {
    use translucid_reference::Incidence;
    use translucid_reference::exact::HalfSpace;
    use translucid_testing::{SplitMix, power};

    use super::*;

    /// The edge of a half space by its profile in space, blurred by a Gaussian: not by way of the model's stripes.
    struct Truth {
        /// Light at distances 0, h, 2h, … into the dark.
        beyond: Vec<f64>,
        step: f64,
        surface_albedo: f64,
        mfp: f64,
    }

    impl Truth {
        fn new(surface_albedo: f64, mfp: f64) -> Self {
            let half_space = HalfSpace::from_surface_albedo(surface_albedo, Incidence::Cosine).unwrap();
            let (n, step) = (400, 0.05);
            // ∫ acos(x/r)/π dE over rings
            let beyond = |x: f64| {
                let ring = |i: i32| x / libm::cos(0.5 * std::f64::consts::PI * f64::from(i) / f64::from(n));
                let outside = |i: i32| if i == n { 0.0 } else { half_space.beyond(ring(i)).value };
                let share = |i: i32| (outside(i) - outside(i + 1)) * (f64::from(i) + 0.5) / f64::from(2 * n);
                (0..n).map(share).sum::<f64>() / surface_albedo
            };
            let beyond = (0..400).map(|i| if i == 0 { 0.5 } else { beyond(step * f64::from(i)) }).collect();
            Self { beyond, step, surface_albedo, mfp }
        }

        fn sharp(&self, x: f64) -> f64 {
            let place = (x.abs() / self.mfp / self.step).min(398.0);
            let (i, t) = (place as usize, place.fract());
            let beyond = self.beyond[i] + t * (self.beyond[i + 1] - self.beyond[i]);
            self.surface_albedo * if x < 0.0 { beyond } else { 1.0 - beyond }
        }

        fn blurred(&self, x: f64, blur: f64) -> f64 {
            let nodes = (-40..=40).map(|i| 0.1 * f64::from(i));
            let weight = |t: f64| libm::exp(-0.5 * t * t);
            let sum: f64 = nodes.clone().map(weight).sum();
            nodes.map(|t| weight(t) * self.sharp(x + t * blur)).sum::<f64>() / sum
        }
    }

    fn normal(random: &mut SplitMix) -> f64 {
        (-2.0 * libm::log(1.0 - random.uniform())).sqrt()
            * libm::cos(std::f64::consts::TAU * random.uniform())
    }

    const ALBEDOS: [f64; 3] = [0.85, 0.6, 0.35];
    const MFPS: [f64; 3] = [1.1, 0.6, 0.35];

    /// A picture with stray light, uneven light and noise, some of which is the same for a block's neighboring places.
    fn photographed(truths: &[Truth; 3], noise: f64, random: &mut SplitMix) -> EdgeSamples {
        let places: Vec<f64> = (-60..60).map(|i| 0.1 * f64::from(i) + 0.05).collect();
        let light = |x: f64, c: usize| (1.0 + 0.01 * x) * truths[c].blurred(x - 0.23, 0.12) + 0.01;
        let clean: Vec<[f64; 3]> = places.iter().map(|x| std::array::from_fn(|c| light(*x, c))).collect();
        let blocks = (0..16).map(|_| {
            let mut drift = 0.0;
            let noisy = |pixel: &[f64; 3]| {
                drift = 0.8 * drift + 0.6 * normal(random);
                pixel.map(|v| v + noise * (v.sqrt() * normal(random) + 0.5 * drift))
            };
            clean.iter().map(noisy).collect()
        });
        EdgeSamples { pixel_width: 0.1, blocks: blocks.collect(), places }
    }

    /// Intervals of three channels hold the truth as often as they say to 4.5 standard deviations, which a run would miss once
    /// in a hundred thousand if they were independent; those of a picture are not quite.
    #[test]
    fn truth_is_in_its_interval_as_often_as_it_says() {
        let response = Response::new(1.0, Incidence::Cosine).unwrap();
        let truths = [0, 1, 2].map(|c| Truth::new(ALBEDOS[c], MFPS[c]));
        let mut random = SplitMix(7);
        let (mut of_mfp, mut of_albedo, mut likely) = (0, 0, 0);
        let mut worst = 0.0_f64;
        let pictures = power(160);
        for _ in 0..pictures {
            let samples = photographed(&truths, 0.01, &mut random);
            let fit = EdgeFit::new(&samples, &response, Scale::Reflectance).unwrap();
            for c in 0..3 {
                let holds = |interval: [f64; 2], truth| interval[0] <= truth && truth <= interval[1];
                let ChannelFit { mfp, surface_albedo, .. } = fit.channels[c];
                of_mfp += i32::from(holds(mfp.sure, MFPS[c]));
                likely += i32::from(holds(mfp.likely, MFPS[c]));
                of_albedo += i32::from(holds(surface_albedo.unwrap().sure, ALBEDOS[c]));
                worst = worst.max((mfp.value / MFPS[c] - 1.0).abs());
                assert!(fit.channels[c].is_seen);
            }
        }
        let count = 3.0 * pictures as f64;
        for (held, share) in [(of_mfp, 0.95), (of_albedo, 0.95), (likely, 0.68)] {
            let off = f64::from(held) - share * count;
            assert!(
                off.abs() < 4.5 * (count * share * (1.0 - share)).sqrt(),
                "{held} of {count}, not {share}"
            );
        }
        assert!(worst < 0.1, "{worst}");
    }

    /// A card of reflectance 0.03 that the camera sees; what is below it tells nothing.
    #[test]
    fn visible_card_is_recognized_and_tells_by_the_lit_side() {
        let response = Response::new(1.0, Incidence::Cosine).unwrap();
        let truths = [0, 1, 2].map(|c| Truth::new(ALBEDOS[c], MFPS[c]));
        let mut random = SplitMix(23);
        let places: Vec<f64> = (-40..140).map(|i| 0.1 * f64::from(i) + 0.05).collect();
        // Gaussian blur of the sharp picture by fine steps
        let sharp = |x: f64, c: usize| if x < 0.23 { 0.03 } else { truths[c].sharp(x - 0.23) };
        let light = |x: f64, c: usize| {
            let nodes = (-60..=60).map(|i| f64::from(i) / 15.0);
            let weight = |t: f64| libm::exp(-0.5 * t * t);
            let sum: f64 = nodes.clone().map(weight).sum();
            nodes.map(|t| weight(t) * sharp(x + 0.12 * t, c)).sum::<f64>() / sum
        };
        let clean: Vec<[f64; 3]> = places.iter().map(|x| std::array::from_fn(|c| light(*x, c))).collect();
        let noisy = |pixel: &[f64; 3], random: &mut SplitMix| pixel.map(|v| v + 0.004 * normal(random));
        let blocks = (0..16).map(|_| clean.iter().map(|pixel| noisy(pixel, &mut random)).collect()).collect();
        let samples = EdgeSamples { pixel_width: 0.1, blocks, places };
        let fit = EdgeFit::new(&samples, &response, Scale::Reflectance).unwrap();
        assert_eq!(fit.card, Card::Visible);
        assert!(fit.misfit < 1.5, "{}", fit.misfit);
        for (c, channel) in fit.channels.iter().enumerate() {
            let albedo = channel.surface_albedo.unwrap();
            for (found, truth, part) in [(channel.mfp, MFPS[c], 0.1), (albedo, ALBEDOS[c], 0.01)] {
                assert!((found.value / truth - 1.0).abs() < part, "{c}: {found:?} is not {truth}");
                let half = 0.5 * (found.sure[1] - found.sure[0]);
                assert!((found.value - truth).abs() < 2.0 * half, "{c}: {found:?} is not {truth}");
            }
            assert!((channel.stray * albedo.value - 0.03).abs() < 0.003, "{channel:?}");
        }
    }

    /// An opaque surface, whose edge only the camera blurs.
    #[test]
    fn sharp_edge_shows_no_scattering() {
        let response = Response::new(1.0, Incidence::Cosine).unwrap();
        let mut random = SplitMix(11);
        for blur in [0.0, 0.15] {
            let places: Vec<f64> = (-60..60).map(|i| 0.1 * f64::from(i) + 0.05).collect();
            let light = |x: f64| {
                if blur > 0.0 {
                    0.5 * (1.0 + libm::erf(x / blur / 2.0_f64.sqrt()))
                } else {
                    f64::from(x > 0.0)
                }
            };
            let noisy = |x: &f64, random: &mut SplitMix| [0.6 * light(*x) + 0.004 * normal(random); 3];
            let blocks = (0..16).map(|_| places.iter().map(|x| noisy(x, &mut random)).collect()).collect();
            let samples = EdgeSamples { pixel_width: 0.1, blocks, places };
            let fit = EdgeFit::new(&samples, &response, Scale::Reflectance).unwrap();
            for channel in fit.channels {
                assert!(!channel.is_seen, "blur {blur}: {channel:?}");
                assert!(channel.correlation.abs() <= 1.0);
            }
        }
    }

    #[test]
    fn quantiles_are_those_of_tables() {
        for (degrees, expected) in [(5.0, 2.5706), (10.0, 2.2281), (30.0, 2.0423)] {
            assert!((student(1.959_963_985, degrees) / expected - 1.0).abs() < 5e-3, "{degrees}");
        }
    }
}
