//! Mean free paths and surface albedos that explain the light around a spot.
//!
//! ```text
//! v_c(r) = b_c + g_c S(r; A_c, ℓ_c, a, σ)
//! ```
//!
//! for a channel c with the gain g and stray light b; the spot's radius a and its soft edge σ, which holds the camera's blur,
//! are the same for all channels. Where v is over the spot's power, A tells the gain, too.
//! Light that is uneven by a slope leaves the means over rings as they are.

use crate::clusters::{Clusters, CommonErrors};
use crate::detectability::is_detectable;
use crate::fit::{ChannelFit, Fit, Outline, Scale, White};
use crate::recent_curves::RecentCurves;
use crate::response::Response;
use crate::samples::Samples;
use crate::spot::{Spot, SpotModel};

/// Parameters that all channels share, and those of each.
const SHARED: usize = 2;
const OF_CHANNEL: usize = 3;

/// Fits a spot of light in values by distance from its middle. For [`Scale::Reflectance`] they are over the power that falls on
/// the piece \[L⁻²\].
/// `None` where there are fewer than six sectors or 16 places, numbers that are not finite, or nothing brighter in the middle.
pub fn fit_spot(samples: &Samples, response: &Response, scale: Scale) -> Option<Fit> {
    let problem = Problem::new(samples, response, scale)?;
    let light = |p: &[f64], c: usize| problem.light(p, c);
    let common_errors = |p: &[f64]| problem.common_errors(p);
    let found = problem.clusters.fit(light, common_errors, &problem.starts(), &problem.scales())?;
    let p = &found.parameters;
    let curves = [0, 1, 2].map(|c| problem.light(p, c));
    let channel = |c: usize| {
        let first = SHARED + c * OF_CHANNEL;
        let stray = p[first + 2];
        ChannelFit {
            mfp: found.interval(first, libm::exp),
            surface_albedo: scale.is_reflectance().then(|| found.interval(first + 1, |a| a)),
            is_seen: is_detectable(samples, p[1], p[first], found.error(first)),
            correlation: found.correlation(first, first + 1),
            stray: stray / (curves[c][0] - stray).max(f64::MIN_POSITIVE),
            unevenness: 0.0,
        }
    };
    Some(Fit {
        channels: [channel(0), channel(1), channel(2)],
        outline: Outline::Spot { radius: p[0].abs() },
        blur: p[1].abs(),
        misfit: found.misfit,
        light: (0..samples.places.len()).map(|i| std::array::from_fn(|c| curves[c][i])).collect(),
        errors: problem.clusters.errors(),
    })
}

/// Everything that the residuals are made of.
struct Problem<'a> {
    samples: &'a Samples,
    clusters: Clusters<'a>,
    response: &'a Response,
    scale: Scale,
    model: SpotModel,
    /// Spots that were asked for last, as most parameters change one channel's or none.
    curves: RecentCurves<Spot>,
}

impl<'a> Problem<'a> {
    fn new(samples: &'a Samples, response: &'a Response, scale: Scale) -> Option<Self> {
        let places = &samples.places;
        let last = places.len().checked_sub(1)?;
        // Pixels of a ring
        let count = |i: usize| places[i] * (places[(i + 1).min(last)] - places[i.saturating_sub(1)]);
        if (0..=last).any(|i| count(i).is_nan() || count(i) <= 0.0) {
            return None;
        }
        let clusters = Clusters::new(samples, count)?;
        let model = SpotModel::new(places, samples.pixel_width);
        let problem = Self { samples, clusters, response, scale, model, curves: RecentCurves::new() };
        (0..3).all(|c| problem.clusters.means[c] > problem.stray(c)).then_some(problem)
    }

    /// Mean of the farthest tenth of the places.
    fn stray(&self, c: usize) -> f64 {
        let n = self.samples.places.len();
        let tenth = (n / 10).max(1);
        (n - tenth..n).map(|i| self.clusters.means[3 * i + c]).sum::<f64>() / tenth as f64
    }

    /// What a channel's gain is at the start, and the power of the light in it, ring by ring.
    fn gain(&self, c: usize, mfp: f64) -> f64 {
        let places = &self.samples.places;
        let mut power = 0.0;
        let mut inner = 0.0;
        for (i, r) in places.iter().enumerate() {
            let outer = places.get(i + 1).map_or(*r, |next| 0.5 * (r + next));
            let area = std::f64::consts::PI * (outer * outer - inner * inner);
            power += area * (self.clusters.means[3 * i + c] - self.stray(c)).max(0.0);
            inner = outer;
        }
        if self.scale.is_reflectance() {
            self.response.albedo_of_level(power, mfp)
        } else {
            power.max(f64::MIN_POSITIVE)
        }
    }

    /// Distance at which light is half as bright as in the middle.
    fn half(&self) -> f64 {
        let mean = |i: usize| (0..3).map(|c| self.clusters.means[3 * i + c] - self.stray(c)).sum::<f64>();
        let places = &self.samples.places;
        (0..places.len()).find(|i| mean(*i) < 0.5 * mean(0)).map_or(places[0], |i| places[i])
    }

    fn starts(&self) -> Vec<Vec<f64>> {
        let (half, pixel, extent) = (self.half(), self.samples.pixel_width, self.samples.extent());
        // A disk that creeping softens, a beam that it widens, and both without
        let shapes =
            [(half, pixel, 0.1 * extent), (0.3 * half, 0.5 * half, 0.5 * half), (half, pixel, 0.2 * pixel)];
        let start = |(radius, blur, mfp): (f64, f64, f64)| {
            let of_channel = (0..3).flat_map(|c| [libm::log(mfp), self.gain(c, mfp), self.stray(c)]);
            [radius, blur].into_iter().chain(of_channel).collect()
        };
        shapes.map(start).to_vec()
    }

    /// Sizes of steps that change something.
    fn scales(&self) -> Vec<f64> {
        let mut scales = vec![self.samples.pixel_width; SHARED];
        for c in 0..3 {
            let gain = self.gain(c, self.samples.extent());
            scales.extend([0.3, 0.1 * gain, 0.1 * self.clusters.means[c].abs()]);
        }
        scales
    }

    /// The error of the reflectance's scale, which the sectors share.
    fn common_errors(&self, p: &[f64]) -> CommonErrors {
        let Scale::Reflectance(White { error, .. }) = self.scale else { return CommonErrors::default() };
        let curves = [0, 1, 2].map(|c| self.light(p, c));
        let scaled = (0..self.samples.places.len()).flat_map(|i| [0, 1, 2].map(|c| error[c] * curves[c][i]));
        CommonErrors { normal: vec![scaled.collect()], ..CommonErrors::default() }
    }

    /// The model's values of a channel.
    fn light(&self, p: &[f64], c: usize) -> Vec<f64> {
        let [log_mfp, value, stray]: [f64; OF_CHANNEL] =
            std::array::from_fn(|i| p[SHARED + c * OF_CHANNEL + i]);
        let mfp = libm::exp(log_mfp).max(1e-3 * self.samples.pixel_width).min(30.0 * self.samples.extent());
        let (surface_albedo, gain) = match self.scale.albedo(c) {
            None => (value, self.response.level(value, mfp)),
            Some(albedo) => (albedo, value),
        };
        let spot = Spot { surface_albedo, mfp, radius: p[0].abs(), blur: p[1].abs() };
        let curve = self.curves.get(&spot, |spot| self.model.eval(self.response, spot));
        curve.iter().map(|light| stray + gain * light).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use translucid_reference::Incidence;
    use translucid_reference::exact::HalfSpace;
    use translucid_testing::{SplitMix, power};

    use super::*;

    /// The light of a disk by the profile in space, blurred by a Gaussian: not by way of the model's Bessel functions.
    struct Truth {
        /// At distances 0, h, 2h, …, over the power that falls on the disk.
        light: Vec<f64>,
    }

    impl Truth {
        const STEP: f64 = 0.05;

        fn new(surface_albedo: f64, mfp: f64, radius: f64, blur: f64) -> Self {
            let half_space = HalfSpace::from_surface_albedo(surface_albedo, Incidence::Cosine).unwrap();
            let n = 400;
            let widest = 12.0;
            let edge = |i: i32| widest * (f64::from(i) / f64::from(n)).powi(2);
            let enclosed: Vec<f64> = (0..=n)
                .map(|i| if i == 0 { 0.0 } else { half_space.enclosed(edge(i) / mfp).value })
                .collect();
            let sharp = |r: f64| {
                // Part of a ring around the place that is in the disk, times what comes from that far
                let ring = |i: i32| {
                    let s = 0.5 * (edge(i) + edge(i + 1));
                    let cos = (r * r + s * s - radius * radius) / (2.0 * r * s);
                    cos.clamp(-1.0, 1.0).acos() / PI * (enclosed[i as usize + 1] - enclosed[i as usize])
                };
                (0..n).map(ring).sum::<f64>() / (PI * radius * radius)
            };
            let sharp: Vec<f64> = (0..240).map(|i| sharp(Self::STEP * f64::from(i).max(0.01))).collect();
            let at = |r: f64| {
                let place = (r / Self::STEP).min(238.0);
                let (i, t) = (place as usize, place.fract());
                sharp[i] + t * (sharp[i + 1] - sharp[i])
            };
            let blurred = |r: f64| {
                let (mut sum, mut all) = (0.0, 0.0);
                for i in 0..24 {
                    let t = (f64::from(i) + 0.5) / 6.0;
                    let weight = t * (-0.5 * t * t).exp();
                    for j in 0..16 {
                        let angle = PI * (f64::from(j) + 0.5) / 16.0;
                        let (x, y) = (r + blur * t * angle.cos(), blur * t * angle.sin());
                        (sum, all) = (sum + weight * at(x.hypot(y)), all + weight);
                    }
                }
                sum / all
            };
            Self { light: (0..200).map(|i| blurred(Self::STEP * f64::from(i))).collect() }
        }

        fn at(&self, r: f64) -> f64 {
            let place = (r / Self::STEP).min(198.0);
            let (i, t) = (place as usize, place.fract());
            self.light[i] + t * (self.light[i + 1] - self.light[i])
        }
    }

    fn normal(random: &mut SplitMix) -> f64 {
        (-2.0 * libm::log(1.0 - random.uniform())).sqrt() * libm::cos(TAU * random.uniform())
    }

    const ALBEDOS: [f64; 3] = [0.85, 0.6, 0.35];
    const MFPS: [f64; 3] = [1.1, 0.6, 0.35];

    /// Rings of a picture with stray light and noise, some of which is the same for a sector's neighboring rings.
    fn photographed(truths: &[Truth; 3], noise: f64, random: &mut SplitMix) -> Samples {
        let places: Vec<f64> = (3..70).map(|i| 0.1 * f64::from(i) + 0.05).collect();
        let clean: Vec<[f64; 3]> =
            places.iter().map(|r| std::array::from_fn(|c| truths[c].at(*r) + 2e-4)).collect();
        let blocks = (0..12).map(|_| {
            let mut drift = 0.0;
            let noisy = |(pixel, r): (&[f64; 3], &f64)| {
                drift = 0.8 * drift + 0.6 * normal(random);
                // Means over the pixels of a ring's sector
                let noise = noise / (TAU * r / 0.1 / 12.0).sqrt();
                pixel.map(|v| v + noise * ((0.05 * v).sqrt() * normal(random) + 0.01 * drift))
            };
            clean.iter().zip(&places).map(noisy).collect()
        });
        Samples { pixel_width: 0.1, blocks: blocks.collect(), along: [0.0; 2], places }
    }

    /// Intervals of three channels hold the truth as often as they say to 4.5 standard deviations, which a run would miss once
    /// in a hundred thousand if they were independent; those of a picture are not quite.
    #[test]
    fn truth_is_in_its_interval_as_often_as_it_says() {
        let response = Response::new(1.0, Incidence::Cosine).unwrap();
        let truths = [0, 1, 2].map(|c| Truth::new(ALBEDOS[c], MFPS[c], 0.9, 0.15));
        let mut random = SplitMix(41);
        let (mut of_mfp, mut of_albedo, mut likely) = (0, 0, 0);
        let mut worst = 0.0_f64;
        let pictures = power(120);
        for _ in 0..pictures {
            let samples = photographed(&truths, 0.05, &mut random);
            let fit = fit_spot(&samples, &response, Scale::Reflectance(White::PERFECT)).unwrap();
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
                "{held} of {count}, not {share}; worst {worst}"
            );
        }
        assert!(worst < 0.15, "{worst}");
    }

    /// Light by the shape alone: lengths without albedos.
    #[test]
    fn shape_alone_tells_lengths() {
        let response = Response::new(1.0, Incidence::Cosine).unwrap();
        let truths = [0, 1, 2].map(|c| Truth::new(ALBEDOS[c], MFPS[c], 0.5, 0.3));
        let samples = photographed(&truths, 0.02, &mut SplitMix(5));
        let fit = fit_spot(&samples, &response, Scale::Relative(ALBEDOS)).unwrap();
        // Errors are those that the misfit counts in
        let left = (0..samples.places.len()).flat_map(|i| {
            let [mean, light, errors] = [samples.means()[i], fit.light[i], fit.errors[i]];
            (0..3).map(move |c| (mean[c] - light[c]) / errors[c])
        });
        let free = 3 * samples.places.len() - SHARED - 3 * OF_CHANNEL;
        let misfit = left.map(|left| left * left).sum::<f64>() / free as f64;
        assert!((misfit / fit.misfit - 1.0).abs() < 1e-9, "{misfit} {}", fit.misfit);
        for (c, channel) in fit.channels.iter().enumerate() {
            assert_eq!(channel.surface_albedo, None);
            let half = 0.5 * (channel.mfp.sure[1] - channel.mfp.sure[0]);
            assert!((channel.mfp.value - MFPS[c]).abs() < 2.0 * half && half < 0.1 * MFPS[c], "{channel:?}");
        }
        // Nothing brighter in the middle
        let even = Samples { blocks: vec![vec![[0.5; 3]; samples.places.len()]; 12], ..samples };
        assert_eq!(fit_spot(&even, &response, Scale::Relative(ALBEDOS)), None);
    }
}
