//! Mean free paths and surface albedos that explain the light beside an opaque card.
//!
//! ```text
//! v_c(x) = b_c + s_c g_c (1 + m_c (x − x_w)) E(x; A_c, ℓ_c, x₀, σ)
//! ```
//!
//! for a channel c with the gain g, stray light b and the slope m of uneven light; where the card ends and the camera's blur
//! are the same for all channels. Where v is reflectance, A determines the gain, too, x_w is the place of what is white, else
//! x₀, and s = 1 − b/ρ: stray light in the camera lies on what is white, too, whose reflectance is ρ.
//! Where the camera sees the card instead of what is below it, only the lit side counts:
//!
//! ```text
//! v_c(x) = G_σ * [ x > x₀ : g_c (1 + m_c (x − x_w)) E(x; A_c, ℓ_c, x₀, 0),  else b_c ]
//! ```
//!
//! and of the card only what is beside its edge.
//! There the light of the card may be its own or stray light: intervals hold both, and all between.
//! They hold, too, that the scale of reflectances has errors, and that uneven light may be bent.

use std::f64::consts::FRAC_1_SQRT_2;

use crate::clusters::{Clusters, CommonErrors};
use crate::detectability::is_detectable;
use crate::edge::{Edge, EdgeModel};
use crate::fit::{Card, ChannelFit, Fit, Outline, Scale, White};
use crate::recent_curves::RecentCurves;
use crate::response::Response;
use crate::samples::Samples;

/// Parameters that all channels share, and those of each.
const SHARED: usize = 2;
const OF_CHANNEL: usize = 4;

/// Pixels of a blur below which there may be none.
const HARDLY_BLURRED: f64 = 0.2;

/// Mean square of residuals over the noise up to which a hidden card explains the light.
const EXPLAINED: f64 = 1.5;

/// Fits an edge of light, dark at small places, of a card that is hidden where that explains the light, and else of the one
/// that explains it better. `None` where there are fewer than six blocks or 16 places, numbers that are not finite, or nothing
/// that gets brighter.
pub fn fit_edge(samples: &Samples, response: &Response, scale: Scale) -> Option<Fit> {
    let hidden = fit_edge_of(Card::Hidden, samples, response, scale);
    if hidden.as_ref().is_some_and(|fit| fit.misfit < EXPLAINED) {
        return hidden;
    }
    let visible = fit_edge_of(Card::Visible, samples, response, scale);
    [hidden, visible].into_iter().flatten().min_by(|a, b| a.misfit.total_cmp(&b.misfit))
}

/// Fits an edge of a card that is hidden or visible; `None` as for [`fit_edge`].
pub fn fit_edge_of(card: Card, samples: &Samples, response: &Response, scale: Scale) -> Option<Fit> {
    let problem = Problem::new(samples, response, scale, card)?;
    // From far creeping none finds a way to a sharp edge
    let mfps = [0.05 * samples.extent(), 0.2 * samples.pixel_width];
    let starts = mfps.map(|mfp| problem.start(mfp));
    let light = |p: &[f64], c: usize| problem.light(p, c);
    let fit = |starts: &[Vec<f64>]| {
        problem.clusters.fit(light, |p| problem.common_errors(p), starts, &problem.scales())
    };
    let mut found = fit(&starts)?;
    if found.parameters[1].abs() < HARDLY_BLURRED * samples.pixel_width {
        // Nothing changes with a blur that is none, and a search stays there
        let mut start = found.parameters.clone();
        start[1] = 0.5 * samples.pixel_width;
        found = fit(&[start]).filter(|other| other.misfit < found.misfit).unwrap_or(found);
    }
    let p = &found.parameters;
    let channel = |c: usize| {
        let first = SHARED + c * OF_CHANNEL;
        let (_, gain) = problem.albedo_and_gain(p, c);
        ChannelFit {
            mfp: found.interval(first, libm::exp),
            surface_albedo: scale.is_reflectance().then(|| found.interval(first + 1, |a| a)),
            is_seen: is_detectable(samples, p[1], p[first], found.error(first)),
            correlation: found.correlation(first, first + 1),
            stray: p[first + 2] / gain,
            unevenness: p[first + 3] * samples.extent(),
        }
    };
    let curves = [0, 1, 2].map(|c| problem.light(p, c));
    Some(Fit {
        channels: [channel(0), channel(1), channel(2)],
        outline: Outline::Edge { card, position: p[0] },
        blur: p[1].abs(),
        misfit: found.misfit,
        light: (0..samples.places.len()).map(|i| std::array::from_fn(|c| curves[c][i])).collect(),
        errors: problem.clusters.errors(),
    })
}

/// Places on a card that is seen, beside its edge, that count: what is farther tells nothing, and light on it is uneven, too.
const BESIDE_CARD: usize = 8;

/// Everything that the residuals are made of.
struct Problem<'a> {
    samples: &'a Samples,
    clusters: Clusters<'a>,
    response: &'a Response,
    scale: Scale,
    card: Card,
    model: EdgeModel,
    /// Edges that were asked for last, as most parameters change one channel's or none.
    curves: RecentCurves<Edge>,
}

impl<'a> Problem<'a> {
    fn new(samples: &'a Samples, response: &'a Response, scale: Scale, card: Card) -> Option<Self> {
        let clusters = Clusters::new(samples, |_| 1.0)?;
        let model = EdgeModel::new(&samples.places, samples.pixel_width);
        let curves = RecentCurves::new();
        let mut problem = Self { samples, clusters, response, scale, card, model, curves };
        if card == Card::Visible {
            let beside = BESIDE_CARD.min(problem.middle() / 2);
            problem.clusters.leave_out(problem.middle() - beside);
        }
        (0..3).all(|c| problem.level(c, true) > problem.level(c, false)).then_some(problem)
    }

    /// Mean of the darkest or the brightest tenth of the places, at the end where it belongs.
    fn level(&self, c: usize, is_lit: bool) -> f64 {
        let n = self.samples.places.len();
        let tenth = (n / 10).max(1);
        let range = if is_lit { n - tenth..n } else { 0..tenth };
        range.map(|i| self.clusters.means[3 * i + c]).sum::<f64>() / tenth as f64
    }

    /// The first of the places beyond the card: the mean of the channels is half as bright at the shadow's end, and rises most
    /// where a card ends that is seen.
    fn middle(&self) -> usize {
        let places = &self.samples.places;
        let mean = |i: usize| self.clusters.means[3 * i..3 * i + 3].iter().sum::<f64>();
        let [lit, dark] = [true, false].map(|is_lit| (0..3).map(|c| self.level(c, is_lit)).sum::<f64>());
        let middle = match self.card {
            Card::Hidden => (0..places.len()).find(|i| mean(*i) > 0.5 * (lit + dark)),
            Card::Visible => {
                let rise = |i: &usize| mean(i + 1) - mean(i - 1);
                (1..places.len() - 1).max_by(|i, j| rise(i).total_cmp(&rise(j)))
            }
        };
        middle.unwrap_or(places.len() / 2)
    }

    fn start(&self, mfp: f64) -> Vec<f64> {
        let (places, middle) = (&self.samples.places, self.middle());
        let mut start = vec![places[middle], self.samples.pixel_width];
        for c in 0..3 {
            let (lit, dark) = (self.level(c, true), self.level(c, false));
            let gain = if self.scale.is_reflectance() {
                self.response.albedo_of_level(lit - dark, mfp)
            } else {
                lit - dark
            };
            start.extend([libm::log(mfp), gain, dark, 0.0]);
        }
        start
    }

    /// Sizes of steps that change something.
    fn scales(&self) -> Vec<f64> {
        let mut scales = vec![self.samples.pixel_width; SHARED];
        for c in 0..3 {
            let lit = self.level(c, true);
            let of_gain = if self.scale.is_reflectance() {
                0.1 * self.response.albedo_of_level(lit, self.samples.extent()).max(0.1)
            } else {
                0.1 * lit
            };
            scales.extend([0.3, of_gain, 0.1 * lit, 0.1 / self.samples.extent()]);
        }
        scales
    }

    fn mfp(&self, p: &[f64], c: usize) -> f64 {
        let mfp = libm::exp(p[SHARED + c * OF_CHANNEL]);
        mfp.max(1e-3 * self.samples.pixel_width).min(30.0 * self.samples.extent())
    }

    /// Surface albedo and gain of a channel.
    fn albedo_and_gain(&self, p: &[f64], c: usize) -> (f64, f64) {
        let value = p[SHARED + c * OF_CHANNEL + 1];
        match self.scale.albedo(c) {
            None => (value, self.response.level(value, self.mfp(p, c))),
            Some(albedo) => (albedo, value),
        }
    }

    /// The place at which the light's scale is known, and the reflectance of what is white; infinite where nothing is.
    fn white(&self, position: f64, c: usize) -> (f64, f64) {
        match self.scale {
            Scale::Reflectance(White { reflectance, place, .. }) => {
                (place.unwrap_or(position), reflectance[c])
            }
            _ => (position, f64::INFINITY),
        }
    }

    /// Errors that the blocks share: of the reflectance's scale, of uneven light that is bent, and of light of the card that
    /// may be stray light.
    fn common_errors(&self, p: &[f64]) -> CommonErrors {
        let places = &self.samples.places;
        let curves = [0, 1, 2].map(|c| self.light(p, c));
        let each = |of: &dyn Fn(usize, f64, f64) -> f64| -> Vec<f64> {
            let at = |(i, x): (usize, &f64)| [0, 1, 2].map(|c| of(c, *x, curves[c][i]));
            places.iter().enumerate().flat_map(at).collect()
        };
        let middle = 0.5 * (p[0].max(places[0]) + places[places.len() - 1]);
        let slope = |c: usize| p[SHARED + c * OF_CHANNEL + 3];
        // The square that an exponential has beside a straight line
        let bent = each(&|c, x, v| 0.5 * (slope(c) * (x - middle)).powi(2) * v);
        let scaled = match self.scale {
            Scale::Reflectance(White { error, place, .. }) => {
                let bent = |c: usize| place.map_or(0.0, |place| 0.5 * (slope(c) * (place - middle)).powi(2));
                Some(each(&|c, _, v| error[c].hypot(bent(c)) * v))
            }
            _ => None,
        };
        let stray = |c: usize, v: f64| {
            let stray = p[SHARED + c * OF_CHANNEL + 2].max(0.0);
            -stray * (1.0 - v / self.white(p[0], c).1)
        };
        let is_card = self.card == Card::Visible;
        let up_to = is_card.then(|| each(&|c, _, v| stray(c, v)));
        CommonErrors {
            normal: scaled.into_iter().chain([bent]).collect(),
            up_to: up_to.into_iter().collect(),
        }
    }

    /// The model's values of a channel.
    fn light(&self, p: &[f64], c: usize) -> Vec<f64> {
        let [position, blur] = [p[0], p[1]];
        let [stray, slope] = [2, 3].map(|i| p[SHARED + c * OF_CHANNEL + i]);
        let ((surface_albedo, gain), mfp) = (self.albedo_and_gain(p, c), self.mfp(p, c));
        let places = &self.samples.places;
        let (known, reflectance) = self.white(position, c);
        let lit = |curve: &[f64]| -> Vec<f64> {
            let lit = |(x, light): (&f64, &f64)| gain * (1.0 + slope * (x - known)) * light;
            places.iter().zip(curve).map(lit).collect()
        };
        let curve = |blur: f64| {
            let edge = Edge { surface_albedo, mfp, position, blur };
            self.curves.get(&edge, |edge| self.model.eval(self.response, edge))
        };
        match self.card {
            Card::Hidden => {
                let curve = curve(blur);
                let rest = 1.0 - stray / reflectance;
                lit(&curve).into_iter().map(|light| stray + rest * light).collect()
            }
            Card::Visible => {
                let curve = curve(0.0);
                let beside_card = |(x, light): (&f64, f64)| {
                    let covered = (0.5 - (x - position) / self.samples.pixel_width).max(0.0).min(1.0);
                    covered * stray + (1.0 - covered) * light
                };
                let sharp: Vec<f64> = places.iter().zip(lit(&curve)).map(beside_card).collect();
                blurred(&sharp, blur.abs() / self.samples.pixel_width)
            }
        }
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
    fn photographed(truths: &[Truth; 3], noise: f64, random: &mut SplitMix) -> Samples {
        let places: Vec<f64> = (-60..60).map(|i| 0.1 * f64::from(i) + 0.05).collect();
        // Stray light lies on white, too
        let light = |x: f64, c: usize| ((1.0 + 0.01 * x) * truths[c].blurred(x - 0.23, 0.12) + 0.01) / 1.01;
        let clean: Vec<[f64; 3]> = places.iter().map(|x| std::array::from_fn(|c| light(*x, c))).collect();
        let blocks = (0..16).map(|_| {
            let mut drift = 0.0;
            let noisy = |pixel: &[f64; 3]| {
                drift = 0.8 * drift + 0.6 * normal(random);
                pixel.map(|v| v + noise * (v.sqrt() * normal(random) + 0.5 * drift))
            };
            clean.iter().map(noisy).collect()
        });
        Samples { pixel_width: 0.1, blocks: blocks.collect(), along: [-3.0, 3.0], places }
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
        let pictures = power(64);
        for _ in 0..pictures {
            let samples = photographed(&truths, 0.01, &mut random);
            let fit = fit_edge(&samples, &response, Scale::Reflectance(White::PERFECT)).unwrap();
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
        let samples = Samples { pixel_width: 0.1, blocks, along: [-3.0, 3.0], places };
        let fit = fit_edge(&samples, &response, Scale::Reflectance(White::PERFECT)).unwrap();
        assert!(matches!(fit.outline, Outline::Edge { card: Card::Visible, .. }), "{:?}", fit.outline);
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
            let samples = Samples { pixel_width: 0.1, blocks, along: [-3.0, 3.0], places };
            let fit = fit_edge(&samples, &response, Scale::Reflectance(White::PERFECT)).unwrap();
            for channel in fit.channels {
                assert!(!channel.is_seen, "blur {blur}: {channel:?}");
                assert!(channel.correlation.abs() <= 1.0);
            }
        }
    }
}
