//! A material under a change of primaries: channels that are mixtures of other channels.
//!
//! A linear color of other primaries is a sum of the old channels with weights w, of which those that make gray of gray add up
//! to 1. So is the light that leaves: where the old channels have the profiles A_j p_j(r), the new one has
//!
//! ```text
//! A' = Σ w_j A_j      p'(r) = Σ w_j A_j p_j(r) / A'
//! ```
//!
//! which is no profile of one medium. The channel that stands for it has its surface albedo, and the width of Burley's profile
//! that puts the least light at another radius.

use super::{Channel, SurfaceAlbedo};
use crate::error::{ParameterError, require};
use crate::{Configuration, Parameterization, scaling};

/// Differences of surface albedos that come from the rounding of sums, and of digits that were printed.
const EXACT: f64 = 1e-12;
const PRINTED: f64 = 1e-6;

/// Points of the integral over the radius.
const POINTS: usize = 1000;
/// Widths that are tried, and steps that narrow the best one down.
const WIDTHS: usize = 96;
const STEPS: usize = 60;

/// A channel that stands for a mixture of three, and how well.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MixedChannel {
    /// The channel, of the mixture's surface albedo and the nearest width.
    pub channel: Channel,
    /// Share of the light that leaves at another radius than that of the mixture: half of ∫ |p − p'| 2πr dr. No width has less.
    pub misplaced: f64,
    /// The same if the channel kept the mean free path of the old channel of its name.
    pub misplaced_if_kept: f64,
    /// The same if the mean free paths changed as colors do: ℓ' = Σ w_j ℓ_j.
    pub misplaced_if_color: f64,
}

impl MixedChannel {
    /// The three channels of other primaries, whose colors are `weights` times the old ones, row by row.
    ///
    /// # Errors
    /// A surface albedo leaves [0, 1], as that of a color outside of the new primaries' gamut does.
    pub fn of(
        channels: &[Channel; 3],
        weights: &[[f64; 3]; 3],
        configuration: Configuration,
    ) -> Result<[Self; 3], ParameterError> {
        let sum = |row: usize, of: &dyn Fn(&Channel) -> f64| -> f64 {
            weights[row].iter().zip(channels).map(|(weight, channel)| weight * of(channel)).sum()
        };
        let mut albedos = [0.0; 3];
        for (row, albedo) in albedos.iter_mut().enumerate() {
            // White is white, and black black, but for the rounding of a matrix and of printed digits
            let found = sum(row, &|channel| channel.albedo().of_channel());
            let rounded = match found {
                _ if (-PRINTED..EXACT).contains(&found) => 0.0,
                _ if (1.0 - EXACT..1.0 + PRINTED).contains(&found) => 1.0,
                _ => found,
            };
            *albedo = require((0.0..=1.0).contains(&rounded), "surface_albedo", rounded, "in [0, 1]")?;
        }
        let greatest = albedos.into_iter().fold(0.0, f64::max);
        let mix = |row: usize| {
            let a = albedos[row];
            let shares: Vec<f64> = if a > 0.0 {
                let share = |(weight, channel): (&f64, &Channel)| weight * channel.albedo().of_channel() / a;
                weights[row].iter().zip(channels).map(share).collect()
            } else {
                weights[row].to_vec()
            };
            let lengths = channels.each_ref().map(Channel::d);
            let misplaced = |d: f64| misplaced(&shares, &lengths, d);
            let d = least(&lengths, &misplaced);
            let channel = Channel::from_d(SurfaceAlbedo::new(a, greatest)?, d, configuration)?;
            let width = |mfp: f64| mfp.max(0.0) / scaling(a, Parameterization::Mfp, configuration);
            Ok(Self {
                channel,
                misplaced: misplaced(d),
                misplaced_if_kept: misplaced(width(channels[row].mfp())),
                misplaced_if_color: misplaced(width(sum(row, &Channel::mfp))),
            })
        };
        Ok([mix(0)?, mix(1)?, mix(2)?])
    }
}

/// The width at which a function is least, from a quarter of the least to four times the greatest of some widths, or one of them.
fn least(widths: &[f64; 3], of: &dyn Fn(f64) -> f64) -> f64 {
    let positive = || widths.iter().copied().filter(|d| *d > 0.0);
    let (from, to) = (positive().fold(f64::INFINITY, f64::min), positive().fold(0.0, f64::max));
    if to <= from {
        // One width, or none; beside Lambertian channels either may be the nearer
        return widths.iter().copied().min_by(|a, b| of(*a).total_cmp(&of(*b))).unwrap_or(0.0);
    }
    // By ln d, first coarsely, since there may be several minima; negative weights lead beyond the old widths
    let (from, to) = (libm::log(0.25 * from), libm::log(4.0 * to));
    let step = (to - from) / (WIDTHS - 1) as f64;
    let at = |i: usize| from + step * i as f64;
    let value = |x: f64| of(libm::exp(x));
    let best = (0..WIDTHS).min_by(|a, b| value(at(*a)).total_cmp(&value(at(*b)))).unwrap_or(0);
    let (mut low, mut high) = ((at(best) - step).max(from), (at(best) + step).min(to));
    for _ in 0..STEPS {
        let third = (high - low) / 3.0;
        if value(low + third) <= value(high - third) {
            high -= third;
        } else {
            low += third;
        }
    }
    let nearest = libm::exp(0.5 * (low + high));
    widths.iter().copied().chain([nearest]).min_by(|a, b| of(*a).total_cmp(&of(*b))).unwrap_or(nearest)
}

/// Half of the integral of the difference between a mixture of profiles of widths and the profile of the width d.
fn misplaced(shares: &[f64], widths: &[f64; 3], d: f64) -> f64 {
    let positive = || widths.iter().copied().chain([d]).filter(|d| *d > 0.0);
    let (least, most) = (positive().fold(f64::INFINITY, f64::min), positive().fold(0.0, f64::max));
    if most == 0.0 {
        return 0.0;
    }
    // By ln r, and the light within the first radius as one piece
    let cdf = |r: f64, d: f64| {
        if d == 0.0 { 1.0 } else { 1.0 - 0.25 * libm::exp(-r / d) - 0.75 * libm::exp(-r / (3.0 * d)) }
    };
    let excess = |r: f64| {
        let mixture: f64 = shares.iter().zip(widths).map(|(share, width)| share * cdf(r, *width)).sum();
        mixture - cdf(r, d)
    };
    let (from, to) = (libm::log(1e-4 * least), libm::log(60.0 * most));
    let radius = |i: usize| libm::exp(from + (to - from) * i as f64 / (POINTS - 1) as f64);
    let values: Vec<f64> = (0..POINTS).map(|i| excess(radius(i))).collect();
    0.5 * (values[0].abs() + values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum::<f64>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::NormalizedDiffusion;

    /// From linear Rec. 709 to ACEScg, with Bradford (colour-science 0.4, RGB_to_RGB).
    const ACESCG: [[f64; 3]; 3] = [
        [0.6131324, 0.3395381, 0.0473295],
        [0.0701243, 0.9163939, 0.0134818],
        [0.0205877, 0.1095746, 0.8698377],
    ];

    fn channels(albedos: [f64; 3], widths: [f64; 3]) -> [Channel; 3] {
        let channel = |i: usize| {
            let albedo = SurfaceAlbedo::new(albedos[i], 1.0).unwrap();
            Channel::from_d(albedo, widths[i], Configuration::Diffuse).unwrap()
        };
        [channel(0), channel(1), channel(2)]
    }

    #[test]
    fn gray_materials_and_the_same_primaries_change_nothing() {
        let gray = channels([0.8; 3], [2.0; 3]);
        for mixed in MixedChannel::of(&gray, &ACESCG, Configuration::Diffuse).unwrap() {
            assert!((mixed.channel.d() - 2.0).abs() < 1e-6 && mixed.misplaced < 1e-6, "{mixed:?}");
            assert!(mixed.misplaced_if_kept < 1e-6 && mixed.misplaced_if_color < 1e-6, "{mixed:?}");
        }
        let skin = channels([0.7, 0.4, 0.3], [3.0, 1.0, 0.5]);
        let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for (mixed, old) in
            MixedChannel::of(&skin, &identity, Configuration::Diffuse).unwrap().iter().zip(&skin)
        {
            assert!((mixed.channel.d() - old.d()).abs() < 1e-12 && mixed.misplaced < 1e-12, "{mixed:?}");
        }
    }

    /// The misplaced light is that of a plain sum over rings, and no other width has less.
    #[test]
    fn channels_are_the_nearest_to_the_mixture() {
        let (albedos, widths) = ([0.7, 0.4, 0.3], [3.0, 1.0, 0.5]);
        let mixed = MixedChannel::of(&channels(albedos, widths), &ACESCG, Configuration::Diffuse).unwrap();
        for (row, mixed) in mixed.iter().enumerate() {
            let d = mixed.channel.d();
            let new = NormalizedDiffusion::from_d(1.0, d).unwrap();
            let old = widths.map(|d| NormalizedDiffusion::from_d(1.0, d).unwrap());
            let a: f64 = (0..3).map(|j| ACESCG[row][j] * albedos[j]).sum();
            let mut off = 0.0;
            let n = 200_000;
            for i in 0..n {
                let (r, step) = ((f64::from(i) + 0.5) * 120.0 / f64::from(n), 120.0 / f64::from(n));
                let ring = 2.0 * std::f64::consts::PI * r * step;
                let light: f64 =
                    (0..3).map(|j| ACESCG[row][j] * albedos[j] / a * old[j].eval(r)).sum::<f64>() * ring;
                off += 0.5 * (light - new.eval(r) * ring).abs();
            }
            assert!((off - mixed.misplaced).abs() < 1e-3, "{row}: {off} {mixed:?}");
            assert!((mixed.channel.albedo().of_channel() - a).abs() < 1e-12);
            assert!(mixed.misplaced <= mixed.misplaced_if_kept, "{mixed:?}");
            assert!(mixed.misplaced <= mixed.misplaced_if_color, "{mixed:?}");
            let shares = [0, 1, 2].map(|j| ACESCG[row][j] * albedos[j] / a);
            for i in 1..100 {
                let other = 0.2 * 1.04f64.powi(i);
                assert!(misplaced(&shares, &widths, other) > mixed.misplaced - 1e-6, "{row} {other}");
            }
        }
    }

    /// From primaries that hold the new ones weights are negative, and the nearest width may be beyond all old ones.
    #[test]
    fn negative_weights_lead_beyond_the_old_widths() {
        let back = [[1.705, -0.6218, -0.0832], [-0.1303, 1.1408, -0.0105], [-0.024, -0.129, 1.153]];
        let old = channels([0.6253, 0.3849, 0.2413], [0.8, 0.5, 0.25]);
        for mixed in MixedChannel::of(&old, &back, Configuration::Diffuse).unwrap() {
            assert!(mixed.misplaced <= mixed.misplaced_if_kept, "{mixed:?}");
            assert!(mixed.misplaced <= mixed.misplaced_if_color, "{mixed:?}");
        }
        assert!(MixedChannel::of(&old, &back, Configuration::Diffuse).unwrap()[0].channel.d() > 0.8);
    }

    #[test]
    fn colors_outside_of_the_gamut_are_refused() {
        let saturated = channels([0.9, 0.0, 0.0], [1.0; 3]);
        let back = [[1.7, -0.6, -0.1], [-0.13, 1.14, -0.01], [-0.02, -0.13, 1.15]];
        let error = MixedChannel::of(&saturated, &back, Configuration::Diffuse).unwrap_err();
        assert!(error.to_string().starts_with("surface_albedo is 1.53, but must be in [0, 1]"), "{error}");
    }
}
