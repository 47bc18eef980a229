//! Means with their errors, and judgements by them.

use glam::Vec3;
use translucid_render::PixelSample;
use translucid_render::internals::Frame;
use translucid_testing::is_thorough;

use super::rendering::{PreparedScene, sample_ray};

/// Independent blocks that the samples of a mean fall into; their spread gives its error.
const BLOCKS: u32 = 32;

/// Number of samples in this run for a test whose whole power are so many: all of them, or a part in 32. Bounds are standard
/// errors, so that false alarms are as rare; [`precision`] says how noisy a mean may be.
pub(crate) fn samples(full: u32) -> u32 {
    if is_thorough() { full } else { full / 32 }
}

/// Mean of a function of (seed, number) with its standard error per channel.
///
/// Sobol samples of one seed are not independent: the error comes from 32 seeds, and goes with Student's t of 31 degrees
/// of freedom.
pub(crate) fn mean_of(samples: u32, sample: impl Fn(u64, u32) -> Vec3) -> (Vec3, Vec3) {
    let per_block = samples / BLOCKS;
    let block_mean = |block: u32| {
        let sum = (0..per_block).fold([0.0_f64; 3], |sum, index| {
            let light = sample(u64::from(block) + 1000, index);
            std::array::from_fn(|c| sum[c] + f64::from(light[c]))
        });
        sum.map(|s| s / f64::from(per_block))
    };
    let means: Vec<[f64; 3]> = (0..BLOCKS).map(block_mean).collect();
    let n = f64::from(BLOCKS);
    let mean: [f64; 3] = std::array::from_fn(|c| means.iter().map(|m| m[c]).sum::<f64>() / n);
    let error: [f64; 3] = std::array::from_fn(|c| {
        let variance = means.iter().map(|m| (m[c] - mean[c]).powi(2)).sum::<f64>() / (n - 1.0);
        (variance / n).sqrt()
    });
    (Vec3::from_array(mean.map(|x| x as f32)), Vec3::from_array(error.map(|x| x as f32)))
}

/// Mean of a part of the light over cosine-distributed directions at points with a normal that `place` draws by two random
/// numbers.
pub(crate) fn flux_of(
    part: impl Fn(&PixelSample) -> Vec3 + Sync,
    renderer: &PreparedScene,
    samples: u32,
    place: impl Fn([f64; 2]) -> (Vec3, Vec3),
) -> (Vec3, Vec3) {
    mean_of(samples, |seed, index| {
        let [u, v, x, y] = even(seed, index);
        let (point, normal) = place([x, y]);
        let (r, phi) = (u.sqrt(), std::f64::consts::TAU * v);
        let local = Vec3::new((r * phi.cos()) as f32, (r * phi.sin()) as f32, (1.0 - u).sqrt() as f32);
        let out = Frame::from_normal(normal).to_world(local).normalize();
        part(&sample_ray(renderer, point + out, -out, seed, index))
    })
}

/// Number `index` of a sequence that fills the unit cube evenly [R. Roberts 2018], shifted by the seed.
pub(crate) fn even(seed: u64, index: u32) -> [f64; 4] {
    let steps = [0.856_674_883_854_503, 0.733_891_856_627_126, 0.628_706_721_232_846, 0.538_596_797_867_173];
    std::array::from_fn(|i| {
        let shift = (seed as f64 * (0.618_034 + 0.1 * i as f64)).fract();
        (0.5 + shift + f64::from(index) * steps[i]).fract()
    })
}

/// Mean radiance along a ray with its standard error per channel.
pub(crate) fn measure(renderer: &PreparedScene, origin: Vec3, direction: Vec3, samples: u32) -> (Vec3, Vec3) {
    mean_of(samples, |seed, index| sample_ray(renderer, origin, direction, seed, index).radiance())
}

/// Relative precision that a measured mean has to have: 5 % at the whole power, 20 % at a part of it. The error of few
/// well-distributed samples falls faster than with the root of their number.
pub(crate) fn precision() -> f64 {
    if is_thorough() { 0.05 } else { 0.2 }
}

/// Asserts that a measured mean is within four standard errors of the truth, and precise to 5 %, or 20 % at a part of the
/// power.
///
/// By Student's t there is a false alarm in 2,700 comparisons, whatever the number of samples.
pub(crate) fn assert_within(name: &str, result: (Vec3, Vec3), expected: Vec3) {
    assert_agree(name, result, (expected, Vec3::ZERO));
}

/// Asserts that a measured mean is within four standard errors of an estimate of the truth, and the
/// difference precise to 5 %, or 20 % at a part of the power.
pub(crate) fn assert_agree(name: &str, (mean, error): (Vec3, Vec3), (expected, doubt): (Vec3, Vec3)) {
    for c in 0..3 {
        let both = error[c].hypot(doubt[c]).max(1e-6 * expected[c]);
        let z = (mean[c] - expected[c]) / both;
        assert!(
            z.abs() < 4.0,
            "{name}, channel {c}: {mean} ± {error}, expected {expected} ± {doubt}, z = {z}"
        );
        assert!(
            both <= precision() as f32 * expected[c].max(1e-3),
            "{name}, channel {c}: too noisy to tell, {both}"
        );
    }
}
