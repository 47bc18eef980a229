//! Mixtures of channels for every texel of a texture: [`MixedChannel`](super::MixedChannel) by a table.
//!
//! By ln r Burley's cdf is one curve that the width shifts. So it is tabulated once, widths are rounded to the table's steps of
//! half a percent, and the light at another radius is a sum of differences between shifted tables.

use super::rgb_from_rgb;
use crate::error::{ParameterError, require};
use crate::{Configuration, Parameterization, scaling};

/// Step of ln r, and of the width that is found.
const STEP: f64 = 0.005;
/// Ends of ln(r/d) in the table: the cdf is 0 and 1 beyond to seven digits.
const LEAST: f64 = -17.0;
const MOST: f64 = 4.1;
/// First step of the sum, at r = 3e-4 d: the light within is one piece.
const FIRST: isize = ((-8.0 - LEAST) / STEP) as isize;
/// Every so many steps a ring ends.
const STRIDE: isize = 16;
/// Every so many steps a width is tried at first.
const COARSE: isize = 32;

/// A change of primaries for texels.
#[derive(Clone, Debug)]
pub struct TexelMixer {
    weights: [[f64; 3]; 3],
    configuration: Configuration,
    cdf: Vec<f64>,
}

impl TexelMixer {
    /// The change from one of [`LINEAR_SPACES`](super::LINEAR_SPACES) to another; none if a name is not known.
    pub fn new(from: &str, to: &str, configuration: Configuration) -> Option<Self> {
        let cdf = |x: f64| {
            let r = libm::exp(x);
            -0.25 * libm::expm1(-r) - 0.75 * libm::expm1(-r / 3.0)
        };
        let count = ((MOST - LEAST) / STEP) as usize;
        let cdf = (0..count).map(|i| cdf(LEAST + STEP * i as f64)).collect();
        Some(Self { weights: rgb_from_rgb(from, to)?, configuration, cdf })
    }

    /// Surface albedos and mean free paths of a texel in the new space, the lengths within 2 % of the nearest ones.
    ///
    /// # Errors
    /// A surface albedo is not in [0, 1], before or after, or a mean free path is negative or not finite.
    pub fn mix(&self, surface_albedo: [f64; 3], mfp: [f64; 3]) -> Result<[[f64; 3]; 2], ParameterError> {
        for (a, length) in surface_albedo.into_iter().zip(mfp) {
            require((0.0..=1.0).contains(&a), "surface_albedo", a, "in [0, 1]")?;
            require((0.0..=1e30).contains(&length), "mfp", length, "in [0, 1e30]")?;
        }
        let s = |a: f64| scaling(a, Parameterization::Mfp, self.configuration);
        let widths = [0, 1, 2].map(|j| mfp[j] / s(surface_albedo[j]));
        let mut mixed = [[0.0; 3]; 2];
        for (row, weights) in self.weights.iter().enumerate() {
            let sum: f64 = weights.iter().zip(surface_albedo).map(|(w, a)| w * a).sum();
            // Half floats and sums are rounded
            let is_near = (-2e-3..=1.0 + 2e-3).contains(&sum);
            let a = require(is_near, "surface_albedo", sum, "in [0, 1]")?.max(0.0).min(1.0);
            let shares =
                [0, 1, 2].map(|j| if a > 0.0 { weights[j] * surface_albedo[j] / a } else { weights[j] });
            mixed[0][row] = a;
            mixed[1][row] = self.nearest(shares, widths) * s(a);
        }
        Ok(mixed)
    }

    /// The width that puts the least light at another radius.
    fn nearest(&self, shares: [f64; 3], widths: [f64; 3]) -> f64 {
        let positive = || widths.into_iter().filter(|d| *d > 0.0);
        let (least, most) = (positive().fold(f64::INFINITY, f64::min), positive().fold(0.0, f64::max));
        if most == 0.0 {
            return 0.0;
        }
        if least == most && widths.into_iter().all(|d| d > 0.0) {
            return most;
        }
        // Widths in steps from the least
        let steps = widths.map(|d| (d > 0.0).then(|| libm::round(libm::log(d / least) / STEP) as isize));
        let last = steps.into_iter().flatten().max().unwrap_or(0);
        let quarter = (libm::log(4.0) / STEP) as isize;
        let off = |k: Option<isize>| self.misplaced(shares, steps, k, last);
        let mut best = (Some(-quarter), f64::INFINITY);
        let mut look = |k: Option<isize>| {
            let value = off(k);
            if value < best.1 {
                best = (k, value);
            }
            best.0
        };
        steps.into_iter().for_each(|k| {
            look(k);
        });
        let mut center = None;
        let mut k = -quarter;
        while k <= last + quarter {
            center = look(Some(k));
            k += COARSE;
        }
        let mut step = COARSE / 2;
        while step > 0 {
            if let Some(k) = center {
                look(Some(k - step));
                center = look(Some(k + step));
            }
            step /= 2;
        }
        best.0.map_or(0.0, |k| least * libm::exp(STEP * k as f64))
    }

    /// Half of the light at another radius, between the mixture of widths and one width; none is a width of 0.
    fn misplaced(
        &self,
        shares: [f64; 3],
        steps: [Option<isize>; 3],
        step: Option<isize>,
        last: isize,
    ) -> f64 {
        // ln(r/least) = LEAST + STEP i, and a width of k steps has the cdf of i − k
        let cdf = |i: isize, k: Option<isize>| match k.map(|k| i - k) {
            None => 1.0,
            Some(i) if i < 0 => 0.0,
            Some(i) => self.cdf.get(i as usize).copied().unwrap_or(1.0),
        };
        let excess = |i: isize| {
            let mixture: f64 = shares.iter().zip(steps).map(|(share, k)| share * cdf(i, k)).sum();
            mixture - cdf(i, step)
        };
        let first = step.unwrap_or(0).min(0) + FIRST;
        let end = step.unwrap_or(0).max(last) + self.cdf.len() as isize + STRIDE;
        let mut before = excess(first);
        let mut sum = before.abs();
        let mut i = first;
        while i < end {
            i += STRIDE;
            let now = excess(i);
            sum += (now - before).abs();
            before = now;
        }
        0.5 * sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::convention::{Channel, MixedChannel, SurfaceAlbedo};

    fn channels(albedos: [f64; 3], mfps: [f64; 3]) -> [Channel; 3] {
        let greatest = albedos.into_iter().fold(0.0, f64::max);
        [0, 1, 2].map(|i| {
            let albedo = SurfaceAlbedo::new(albedos[i], greatest).unwrap();
            Channel::from_mfp(albedo, mfps[i], Configuration::Diffuse).unwrap()
        })
    }

    /// The slow twin: the same albedos, and lengths that misplace as little light.
    #[test]
    fn texels_are_those_of_the_slow_mixture() {
        let mixer = TexelMixer::new("lin_rec709", "acescg", Configuration::Diffuse).unwrap();
        let weights = rgb_from_rgb("lin_rec709", "acescg").unwrap();
        let mut seed = 1u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1u64 << 53) as f64
        };
        for _ in 0..20 {
            let albedos = [0.0; 3].map(|_| 0.02 + 0.96 * random());
            let mfps = [0.0; 3].map(|_| libm::exp(4.0 * random() - 2.0));
            let [found_albedos, found_mfps] = mixer.mix(albedos, mfps).unwrap();
            let slow = MixedChannel::of(&channels(albedos, mfps), &weights, Configuration::Diffuse).unwrap();
            for (i, slow) in slow.iter().enumerate() {
                assert!((found_albedos[i] - slow.channel.albedo().of_channel()).abs() < 1e-12);
                let ratio = found_mfps[i] / slow.channel.mfp();
                assert!((ratio - 1.0).abs() < 0.02, "{albedos:?} {mfps:?} {i}: {ratio} {slow:?}");
            }
        }
    }

    #[test]
    fn gray_texels_stay_and_wrong_ones_are_refused() {
        let mixer = TexelMixer::new("lin_rec709", "lin_rec2020", Configuration::Diffuse).unwrap();
        let [albedos, mfps] = mixer.mix([0.5; 3], [2.0; 3]).unwrap();
        for i in 0..3 {
            assert!((albedos[i] - 0.5).abs() < 1e-9 && (mfps[i] - 2.0).abs() < 1e-9, "{albedos:?} {mfps:?}");
        }
        assert_eq!(mixer.mix([0.0; 3], [0.0; 3]).unwrap(), [[0.0; 3]; 2]);
        let [_, lambertian] = mixer.mix([0.8, 0.2, 0.2], [0.0, 0.0, 1.0]).unwrap();
        assert!(lambertian.iter().all(|length| (0.0..=1.5).contains(length)), "{lambertian:?}");
        for (albedo, mfp) in [(1.1, 1.0), (-0.1, 1.0), (f64::NAN, 1.0), (0.5, -1.0), (0.5, f64::INFINITY)] {
            assert!(mixer.mix([albedo, 0.5, 0.5], [mfp, 1.0, 1.0]).is_err(), "{albedo} {mfp}");
        }
        let back = TexelMixer::new("lin_rec2020", "lin_rec709", Configuration::Diffuse).unwrap();
        assert!(back.mix([0.0, 0.9, 0.0], [1.0; 3]).is_err());
        assert!(TexelMixer::new("srgb", "acescg", Configuration::Diffuse).is_none());
    }
}
