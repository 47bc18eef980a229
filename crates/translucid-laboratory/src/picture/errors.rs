//! Distances between the light of two pictures.

use super::Picture;

/// Added to the square of the reference, so that dark pixels do not count without bound \[radiance²\].
pub const RELATIVE_FLOOR: f64 = 0.01;

/// Relative mean square error of a picture against a reference of the same size:
///
/// ```text
/// mean of (x − ref)² / (ref² + 0.01)
/// ```
///
/// over all channels of all pixels that are not background in the reference; 0 where there is none.
pub fn relative_mse(picture: &Picture, reference: &Picture) -> f64 {
    mean(covered(reference).flat_map(|i| {
        let [x, truth] = [picture.radiance[i], reference.radiance[i]];
        [0, 1, 2].map(|c| (f64::from(x[c]) - f64::from(truth[c])).powi(2) / weight(truth[c]))
    }))
}

/// The part of the [`relative_mse`] of a picture against the truth that is the picture's noise.
///
/// Its first half is the mean of the first `samples[0]` of `samples[1]` samples of each pixel. As the means A of the first
/// n₁ and B of the last n₂ of n samples differ by chance alone, the variance of their mean is estimated by
///
/// ```text
/// (A − B)² n₁ n₂ / n²
/// ```
///
/// without a bias where samples are independent; samples that are spread evenly leave less noise than that.
/// The result is not a number where one of the halves is empty.
pub fn relative_noise([picture, first]: [&Picture; 2], samples: [u32; 2], reference: &Picture) -> f64 {
    let deviation = |i: usize, c: usize| f64::from(picture.radiance[i][c]) - f64::from(first.radiance[i][c]);
    noise(deviation, samples, reference)
}

/// The part of the [`relative_mse`] of a picture against a reference that is noise of either, by the halves of both
/// as in [`relative_noise`].
///
/// If both were made with the same random numbers, much of their noise is the same and cancels.
pub fn relative_noise_of_difference(
    [picture, first]: [&Picture; 2],
    [reference, reference_first]: [&Picture; 2],
    samples: [u32; 2],
) -> f64 {
    let deviation = |i: usize, c: usize| {
        let [x, x_first, truth, truth_first] =
            [picture, first, reference, reference_first].map(|picture| f64::from(picture.radiance[i][c]));
        (x - truth) - (x_first - truth_first)
    };
    noise(deviation, samples, reference)
}

/// Mean of the estimated variances, relative to a reference; `deviation` is that of all samples' mean from the first
/// half's, by pixel and channel.
fn noise(deviation: impl Fn(usize, usize) -> f64, samples: [u32; 2], reference: &Picture) -> f64 {
    let [one, all] = samples.map(f64::from);
    if one < 1.0 || all <= one {
        return f64::NAN;
    }
    // B − A = (M − A) n / n₂ with the mean M of all, so the estimate is (M − A)² n₁ / n₂
    let factor = one / (all - one);
    let deviation = &deviation;
    mean(
        covered(reference).flat_map(|i| {
            [0, 1, 2].map(|c| factor * deviation(i, c).powi(2) / weight(reference.radiance[i][c]))
        }),
    )
}

/// Difference of luminance from pixel to pixel, relative as in [`relative_mse`]:
///
/// ```text
/// (Y − Y_ref) / √(Y_ref² + 0.01)
/// ```
///
/// It is positive where the picture is brighter than the reference.
pub fn relative_difference(picture: &Picture, reference: &Picture) -> Vec<f32> {
    let pairs = picture.radiance.iter().zip(&reference.radiance);
    pairs
        .map(|(x, truth)| {
            let [y, y_truth] = [x, truth].map(|color| luminance(*color));
            ((y - y_truth) / (y_truth * y_truth + RELATIVE_FLOOR).sqrt()) as f32
        })
        .collect()
}

/// Relative luminance of a linear Rec. 709 color.
fn luminance(color: [f32; 3]) -> f64 {
    let [red, green, blue] = color.map(f64::from);
    0.2126 * red + 0.7152 * green + 0.0722 * blue
}

fn weight(truth: f32) -> f64 {
    f64::from(truth).powi(2) + RELATIVE_FLOOR
}

fn covered(reference: &Picture) -> impl Iterator<Item = usize> {
    (0..reference.radiance.len()).filter(|&i| reference.is_covered(i))
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0_u64), |(sum, count), value| (sum + value, count + 1));
    sum / count.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::super::tests::picture;
    use super::super::{Picture, PicturePixel};
    use super::*;
    use crate::random::random;

    #[test]
    fn relative_mse_meets_values_worked_by_hand() {
        let reference = picture(2, 1, |x, _| if x == 0 { [0.0, 0.3, 1.0] } else { [0.0; 3] });
        let other = picture(2, 1, |x, _| if x == 0 { [0.1, 0.4, 0.0] } else { [0.0; 3] });
        // 0.01 / 0.01, 0.01 / 0.1, 1 / 1.01, and three zeros
        let expected = (1.0 + 0.1 + 1.0 / 1.01) / 6.0;
        assert!((relative_mse(&other, &reference) - expected).abs() < 1e-7);
        assert_eq!(relative_mse(&reference, &reference), 0.0);
    }

    #[test]
    fn background_of_the_reference_does_not_count() {
        let pixel =
            |value: f32, alpha: f32| PicturePixel { radiance: [value; 3], alpha, display: [value; 3] };
        let reference = Picture::new(2, 1, [pixel(0.0, 0.0), pixel(1.0, 1.0)]);
        let other = Picture::new(2, 1, [pixel(5.0, 1.0), pixel(1.5, 1.0)]);
        assert!((relative_mse(&other, &reference) - 0.25 / 1.01).abs() < 1e-7);
        let nothing = Picture::new(2, 1, []);
        assert_eq!(relative_mse(&other, &nothing), 0.0);
    }

    #[test]
    fn relative_difference_has_the_sign_of_the_change() {
        let reference = picture(3, 1, |_, _| [1.0; 3]);
        let other = picture(3, 1, |x, _| [[0.5; 3], [1.0; 3], [1.5; 3]][x]);
        let found = relative_difference(&other, &reference);
        for (found, expected) in found.iter().zip([-0.5, 0.0, 0.5]) {
            assert!((f64::from(*found) - expected / 1.01_f64.sqrt()).abs() < 1e-6, "{found} {expected}");
        }
    }

    /// Means of n₁ = 3 of n = 8 samples, each uniform on [0, 1): the variance of the mean is 1/96, and the error is
    /// all noise. The estimates' standard errors over 30,000 values are 0.8 %, so 4 % is five of them: false alarms
    /// in one of 10⁶ seeds.
    #[test]
    fn relative_noise_is_the_error_of_independent_samples() {
        const SAMPLES: [u32; 2] = [3, 8];
        let sample = |pixel: usize, channel: usize, number: u32| {
            random(7, (pixel as u64 * 3 + channel as u64) * 8 + u64::from(number))
        };
        let mean = |count: u32| {
            move |x: usize, y: usize| {
                [0, 1, 2].map(|channel| {
                    let sum: f64 = (0..count).map(|number| sample(100 * y + x, channel, number)).sum();
                    (sum / f64::from(count)) as f32
                })
            }
        };
        let [first, all] = SAMPLES.map(|count| picture(100, 100, mean(count)));
        let truth = picture(100, 100, |_, _| [0.5; 3]);
        let variance = 1.0 / 96.0 / (0.25 + RELATIVE_FLOOR);
        let noise = relative_noise([&all, &first], SAMPLES, &truth);
        assert!((noise / variance - 1.0).abs() < 0.04, "{noise} {variance}");
        assert!((relative_mse(&all, &truth) / variance - 1.0).abs() < 0.04);
        assert!(relative_noise([&all, &all], [8, 8], &truth).is_nan());
    }

    /// As above, with the same standard errors: the reference has the noise of the picture, which is 0.2 brighter, and
    /// then another one.
    #[test]
    fn relative_noise_of_difference_leaves_out_what_both_have() {
        const SAMPLES: [u32; 2] = [3, 8];
        let mean = |seed: u64, count: u32, more: f64| {
            picture(100, 100, |x, y| {
                [0, 1, 2].map(|channel| {
                    let index = |number: u32| ((100 * y + x) as u64 * 3 + channel) * 8 + u64::from(number);
                    let sum: f64 = (0..count).map(|number| random(seed, index(number))).sum();
                    (sum / f64::from(count) + more) as f32
                })
            })
        };
        let [one, other] =
            [(7, 0.0), (8, 0.0)].map(|(seed, more)| [8, 3].map(|count| mean(seed, count, more)));
        let brighter = [8, 3].map(|count| mean(7, count, 0.2));
        let noise = |picture: &[Picture; 2], reference: &[Picture; 2]| {
            relative_noise_of_difference(picture.each_ref(), reference.each_ref(), SAMPLES)
        };
        assert!(noise(&brighter, &one) < 1e-12, "{}", noise(&brighter, &one));
        // The mean of a noisy reference's weights is known, that of its error is not: both come from the same numbers
        let weights = other[0].radiance().as_flattened().iter().map(|&truth| 1.0 / weight(truth));
        let expected = 2.0 / 96.0 * super::mean(weights);
        let found = noise(&one, &other);
        assert!((found / expected - 1.0).abs() < 0.04, "{found} {expected}");
    }
}
