//! Receivers on a line that find places up to 1 away, with K = (1 + 0.3 (y − x))/2 there, for tests of the sums.

use std::sync::atomic::AtomicBool;

use glam::Vec3;
use translucid_profile::split_mix::split_mix;

use super::{Account, BlockReceiver, COORDINATES, FoundLight, Gathering};
use crate::world::Layer;

/// A place with light.
#[derive(Clone, Copy)]
pub(super) struct Spot {
    pub(super) y: f32,
    pub(super) light: f32,
}

impl Spot {
    /// Returns `true` on a surface: every other stretch of a quarter is one.
    pub(super) fn is_on_surface(y: f32) -> bool {
        (2.0 * y).rem_euclid(1.0) < 0.5
    }
}

impl FoundLight for Spot {
    fn coordinates(&self) -> [f32; COORDINATES] {
        [self.y, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    }

    fn own_weight(&self) -> f32 {
        1.0
    }

    fn light(&self) -> Vec3 {
        Vec3::splat(self.light)
    }

    fn normal(&self) -> Vec3 {
        if Self::is_on_surface(self.y) { Vec3::Z } else { Vec3::ZERO }
    }
}

pub(super) fn account(sample: usize, random: f32) -> Account {
    Account { sample, layer: Layer::Subsurface, throughput: Vec3::ONE, random }
}

/// K of a receiver at x.
pub(super) fn kernel(x: f32, y: f32) -> f32 {
    if (y - x).abs() < 1.0 { 0.5 * (1.0 + 0.3 * (y - x)) } else { 0.0 }
}

/// g of a receiver at x.
pub(super) fn density(x: f32, y: f32) -> f32 {
    if (y - x).abs() < 1.0 { 0.5 } else { 0.0 }
}

/// Integral of a function of y between two limits.
pub(super) fn integral(from: f32, to: f32, function: impl Fn(f32) -> f32) -> f64 {
    let steps = 20_000_u16;
    let width = (to - from) / f32::from(steps);
    (0..steps).map(|i| f64::from(function(from + width * (f32::from(i) + 0.5)) * width)).sum()
}

/// Variance of the light of receivers at 0, 0.2 … 1.6, made with these and the number of the trial's receiver, over many
/// trials.
///
/// Places have the light (2 + y + 1 on surfaces) times 0.5 or 1.5, of which `arriving`, K V at x and y, arrives. All means are
/// asserted to be at most 5 standard errors from the exact one.
pub(super) fn variances<R: BlockReceiver<FoundLight = Spot>>(
    make: impl Fn(f32, Account) -> R,
    arriving: impl Fn(f32, f32) -> f32,
) -> [f64; 9] {
    let mut state = 7_u64;
    let mut random = move || {
        state = split_mix(state);
        (state >> 40) as f32 / (1 << 24) as f32
    };
    let light = |y: f32| 2.0 + y + f32::from(u8::from(Spot::is_on_surface(y)));
    let mut gathering = Gathering::<R>::default();
    let mut moments = [(0.0_f64, 0.0_f64); 9];
    let trials = 40_000;
    for _ in 0..trials {
        for sample in 0..9 {
            let x = 0.2 * sample as f32;
            let receiver = make(x, account(sample, random()));
            let y = x + 2.0 * random() - 1.0;
            let light = light(y) * if random() < 0.5 { 0.5 } else { 1.5 };
            gathering.push(receiver, [Spot { y, light }]);
        }
        gathering.resolve(&AtomicBool::new(false), |sample, _, light| {
            let light = f64::from(light.x);
            moments[sample].0 += light;
            moments[sample].1 += light * light;
        });
    }
    std::array::from_fn(|sample| {
        let (sum, squared) = moments[sample];
        let (n, x) = (f64::from(trials), 0.2 * sample as f32);
        let exact = integral(x - 1.0, x + 1.0, |y| arriving(x, y) * light(y));
        let variance = squared / n - (sum / n).powi(2);
        let error = (variance / n).sqrt();
        assert!((sum / n - exact).abs() < 5.0 * error, "{sample}: {} ± {error}, not {exact}", sum / n);
        variance
    })
}
