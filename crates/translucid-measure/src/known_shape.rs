//! Parameters of a material from a photograph of a thing of known shape, whose pictures a renderer makes.
//!
//! Pictures of a Monte Carlo renderer are noisy, and so are their differences. Least squares would multiply the noise of a
//! picture by itself, in Jᵀ(y − f) and in JᵀJ, and be biased. Here each picture is rendered with two seeds, a and b, and only
//! what is independent is multiplied:
//!
//! ```text
//! S(θ) = Σ w [J̄_a (y − f_b) + J̄_b (y − f_a)]      zero at the estimate, of mean zero at the truth
//! M    = Σ w [J̄_a J_bᵀ + J̄_b J_aᵀ]                Gauss and Newton's step is M⁻¹ S
//! C    = M⁻¹ [Σ_B s_B s_Bᵀ] M⁻¹                   s_B: what a block of pixels adds to S
//! ```
//!
//! y is the photograph, f a picture, J its derivatives by central differences of pictures of the same seed, in which all paths
//! draw the same random numbers, and J̄ their mean over the pixels around: any instrument that does not know the noise of
//! the residuals leaves the estimate unbiased (Reiersøl 1945), and a smooth one has less noise of its own. C is the sandwich estimate of the covariance (White 1980; Liang and Zeger 1986 for blocks): it takes the
//! noise of photograph and renderer together from the residuals, and neighboring pixels need not be independent.

use nalgebra::{DMatrix, DVector};

use crate::fit::Interval;
use crate::linear_photo::Photo;
use crate::unknown::{Guess, Unknown};

/// Seeds that each picture is rendered with.
pub const SEEDS: usize = 2;

/// A picture that is to be rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// Its material; the factor on the radiance does not count in it.
    pub guess: Guess,
    /// Number of its seed, below [`SEEDS`].
    pub seed: usize,
}

/// Estimates of one parameter: a channel's, or that of all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The parameter.
    pub unknown: Unknown,
    /// Its channel; none where all share it.
    pub channel: Option<usize>,
    /// Value and intervals; without ends where the picture does not determine it.
    pub interval: Interval,
    /// Standard error on the unbounded scale: that of ln ℓ, ln A/(1 − A), artanh g.
    pub standard_error: f64,
}

/// A fit on its way: it asks for pictures, one after the other, until it has found the parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownShape {
    photo: Photo,
    /// Weight of each value, 0 where light is lost.
    weights: Vec<[f32; 3]>,
    /// Edge of a block in pixels.
    block: usize,
    unknowns: Vec<Unknown>,
    progress: Progress,
    /// Pictures of the guess that are there, in the order they were asked for.
    pictures: Vec<Photo>,
    /// Whether the last step was small, or one too many.
    is_done: bool,
    /// Variance of each parameter on the unbounded scale, once a step has been computed.
    variances: Vec<f64>,
}

/// A fit between two guesses: beside the photograph all that a later run needs to go on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// The guess that is tried next.
    pub guess: Guess,
    /// The last one that was better than those before, with its sum of squares.
    pub best: Option<(Guess, f64)>,
    /// Steps taken.
    pub steps: u32,
    /// Guesses in a row that were worse.
    pub retreats: u32,
}

/// Most steps.
const MOST_STEPS: u32 = 16;

/// Most times that a step is halved.
const MOST_RETREATS: u32 = 5;

/// A step of up to so many standard errors is the last, where it is short: pictures never settle beyond their noise, as walks
/// in a medium that is only a little other go other ways, and a step from within the noise has the error of any other.
const SMALL: f64 = 2.0;

/// A step that is longer than this, and than half of the standard error, is followed by another: there the pictures change
/// otherwise than in proportion.
const SHORT: f64 = 0.15;

/// A step that is shorter than this is the last, whatever the error.
const TINY: f64 = 5e-4;

/// About so many blocks make a picture.
const BLOCKS: f64 = 144.0;

impl KnownShape {
    /// A fit of a photograph that starts at a guess. Values of exactly 1 are taken as clipped and left out.
    pub fn new(photo: Photo, unknowns: &[Unknown], start: Guess) -> Self {
        let block = (((photo.width * photo.height) as f64 / BLOCKS).sqrt().round() as usize).clamp(4, 32);
        let weights = weights(&photo, block);
        let unknowns: Vec<Unknown> = Unknown::ALL.into_iter().filter(|u| unknowns.contains(u)).collect();
        let progress = Progress { guess: start, best: None, steps: 0, retreats: 0 };
        let (pictures, variances) = (Vec::new(), Vec::new());
        Self { photo, weights, block, unknowns, progress, pictures, is_done: false, variances }
    }

    /// Progress so far; the pictures of the guess that is tried do not count.
    pub fn progress(&self) -> Progress {
        self.progress
    }

    /// Goes on from where an earlier fit of the same photograph and parameters was.
    pub fn resume(&mut self, progress: Progress) {
        self.progress = progress;
        self.pictures.clear();
    }

    /// Pictures of the guess that are there.
    pub fn pictures(&self) -> usize {
        self.pictures.len()
    }

    /// The picture that is wanted next; none once the parameters are found.
    pub fn next(&self) -> Option<Request> {
        if self.is_done {
            return None;
        }
        let guess = self.progress.guess;
        let (number, seed) = (self.pictures.len() / SEEDS, self.pictures.len() % SEEDS);
        let guess = match number.checked_sub(1) {
            Some(i) => guess.moved(self.rendered().nth(i / 2)?, if i % 2 == 0 { 1.0 } else { -1.0 }),
            None => guess,
        };
        Some(Request { guess, seed })
    }

    /// Width and height of the photograph.
    pub fn size(&self) -> [usize; 2] {
        [self.photo.width, self.photo.height]
    }

    /// Pictures that a step takes.
    pub fn pictures_of_a_step(&self) -> usize {
        SEEDS * (1 + 2 * self.rendered().count())
    }

    fn rendered(&self) -> impl Iterator<Item = Unknown> {
        self.unknowns.iter().copied().filter(|unknown| unknown.is_rendered())
    }

    /// Takes the picture that was wanted.
    pub fn take(&mut self, picture: Photo) {
        self.pictures.push(picture);
        let count = self.pictures.len();
        if count == SEEDS && self.retreat() {
            return;
        }
        if count == self.pictures_of_a_step() {
            self.step();
        }
    }

    /// Goes half the way back where a guess explains the photograph worse than the last one. Says whether it did.
    fn retreat(&mut self) -> bool {
        let sums = self.products_by_block();
        let sum: f64 = sums.iter().sum();
        let error = sums.iter().map(|s| s * s).sum::<f64>().sqrt();
        if let Some((best, least)) = self.progress.best
            && sum - 2.0 * error > least
            && self.progress.retreats < MOST_RETREATS
        {
            let worse = self.progress.guess;
            for (unknown, channel) in self.parameters() {
                let [a, b] = [best, worse].map(|guess| unknown.unbounded(guess.get(unknown, channel)));
                self.progress.guess.set(unknown, channel, unknown.bounded(0.5 * (a + b)));
            }
            self.progress.retreats += 1;
            self.pictures.clear();
            return true;
        }
        self.progress.best = Some((self.progress.guess, sum));
        self.progress.retreats = 0;
        false
    }

    /// Parameters with their channels; of those that all share, the first stands for all.
    fn parameters(&self) -> Vec<(Unknown, usize)> {
        let of =
            |unknown: Unknown| (0..if unknown.is_per_channel() { 3 } else { 1 }).map(move |c| (unknown, c));
        self.unknowns.iter().copied().flat_map(of).collect()
    }

    /// Photograph minus the picture of the guess with a seed.
    fn residual(&self, seed: usize, i: usize, channel: usize) -> f64 {
        let picture = f64::from(self.pictures[seed].pixels[i][channel]);
        f64::from(self.photo.pixels[i][channel]) - self.progress.guess.radiance[channel] * picture
    }

    /// Σ w (y − f_a)(y − f_b) of each block: squares without the renderer's noise.
    fn products_by_block(&self) -> Vec<f64> {
        let mut sums = vec![0.0; self.block_of(self.photo.pixels.len() - 1) + 1];
        for (i, weights) in self.weights.iter().enumerate() {
            let product = |c: usize| f64::from(weights[c]) * self.residual(0, i, c) * self.residual(1, i, c);
            sums[self.block_of(i)] += (0..3).map(product).sum::<f64>();
        }
        sums
    }

    fn block_of(&self, i: usize) -> usize {
        let (x, y) = (i % self.photo.width, i / self.photo.width);
        y / self.block * self.photo.width.div_ceil(self.block) + x / self.block
    }

    /// Computes Gauss and Newton's step and the covariance, and moves on.
    fn step(&mut self) {
        let parameters = self.parameters();
        let slopes = self.slopes();
        self.variances = vec![f64::INFINITY; parameters.len()];
        let mut step = vec![0.0; parameters.len()];
        for group in self.groups(&parameters) {
            let (normal, scores) = self.equations(&slopes, &parameters, &group);
            let gradient = scores.iter().fold(DVector::zeros(group.len()), |sum, score| sum + score);
            let found = solution(&normal, &gradient);
            let variances = variances(&normal, &scores);
            for (i, &k) in group.iter().enumerate() {
                (step[k], self.variances[k]) = (found[i], variances[i]);
            }
        }

        let longest = parameters.iter().zip(&step).map(|((u, _), s)| s.abs() / u.limits()[0]);
        let shorten = 1.0 / longest.fold(1.0, f64::max);
        let mut is_small = true;
        for (k, &(unknown, channel)) in parameters.iter().enumerate() {
            let [_, most] = unknown.limits();
            let x = unknown.unbounded(self.progress.guess.get(unknown, channel));
            let next = (x + shorten * step[k]).clamp(-most, most);
            let error = self.variances[k].sqrt();
            is_small &= (next - x).abs() < (SMALL * error).min(SHORT.max(0.5 * error)).max(TINY);
            self.progress.guess.set(unknown, channel, unknown.bounded(next));
        }
        self.progress.steps += 1;
        self.is_done = is_small || self.progress.steps == MOST_STEPS;
        if !self.is_done {
            self.pictures.clear();
        }
    }

    /// Parameters that are found together: those of a channel, or all where the channels share one.
    fn groups(&self, parameters: &[(Unknown, usize)]) -> Vec<Vec<usize>> {
        if self.unknowns.contains(&Unknown::G) {
            return vec![(0..parameters.len()).collect()];
        }
        let of = |channel: usize| (0..parameters.len()).filter(|k| parameters[*k].1 == channel).collect();
        (0..3).map(of).collect()
    }

    /// Derivatives of the pictures of each seed by each parameter of a channel.
    fn slopes(&self) -> Vec<(Unknown, [Slope; SEEDS])> {
        let guess = &self.progress.guess;
        let (base, moved) = self.pictures.split_at(SEEDS);
        let mut moved = moved.chunks_exact(2 * SEEDS);
        let mut of = |unknown: Unknown| {
            let sides = if unknown.is_rendered() { moved.next() } else { None };
            let slope = |seed: usize| {
                let value = |i: usize, c: usize| match sides {
                    Some(sides) => {
                        let [up, down] = [seed, SEEDS + seed].map(|k| f64::from(sides[k].pixels[i][c]));
                        (guess.radiance[c] * (up - down) / unknown.difference()) as f32
                    }
                    None => guess.radiance[c] as f32 * base[seed].pixels[i][c],
                };
                let pixels = (0..self.photo.pixels.len()).map(|i| [0, 1, 2].map(|c| value(i, c)));
                let [width, height] = self.size();
                let exact = Photo { width, height, pixels: pixels.collect() };
                let smooth = smoothed(&exact, self.block / 4);
                Slope { exact, smooth }
            };
            (unknown, [slope(0), slope(1)])
        };
        self.unknowns.iter().map(|&unknown| of(unknown)).collect()
    }

    /// M of a group of parameters, and s_B of each block.
    fn equations(
        &self,
        slopes: &[(Unknown, [Slope; SEEDS])],
        parameters: &[(Unknown, usize)],
        group: &[usize],
    ) -> (DMatrix<f64>, Vec<DVector<f64>>) {
        let n = group.len();
        let mut normal = DMatrix::zeros(n, n);
        let mut scores = vec![DVector::zeros(n); self.block_of(self.photo.pixels.len() - 1) + 1];
        for c in 0..3 {
            let here: Vec<(usize, &[Slope; SEEDS])> = group
                .iter()
                .enumerate()
                .filter(|(_, k)| !parameters[**k].0.is_per_channel() || parameters[**k].1 == c)
                .filter_map(|(at, k)| Some((at, &slopes.iter().find(|(u, _)| *u == parameters[*k].0)?.1)))
                .collect();
            for (i, weights) in self.weights.iter().enumerate() {
                let weight = f64::from(weights[c]);
                if weight == 0.0 || here.is_empty() {
                    continue;
                }
                let score = &mut scores[self.block_of(i)];
                let residuals = [0, 1].map(|seed| self.residual(seed, i, c));
                for (k, of_k) in &here {
                    let [a, b] = [0, 1].map(|seed| f64::from(of_k[seed].smooth.pixels[i][c]));
                    score[*k] += weight * (a * residuals[1] + b * residuals[0]);
                    for (l, of_l) in &here {
                        let [other_a, other_b] = [0, 1].map(|seed| f64::from(of_l[seed].exact.pixels[i][c]));
                        // Symmetric but for weights that change from pixel to pixel
                        let product = 0.5 * weight * (a * other_b + b * other_a);
                        normal[(*k, *l)] += product;
                        normal[(*l, *k)] += product;
                    }
                }
            }
        }
        (normal, scores)
    }

    /// Returns `true` if the last step was small enough.
    pub fn has_converged(&self) -> bool {
        self.is_done && self.progress.steps < MOST_STEPS
    }

    /// The parameters where the fit is, with intervals once a step has been computed.
    pub fn estimates(&self) -> Vec<Estimate> {
        let parameters = self.parameters();
        let estimate = |(k, &(unknown, channel)): (usize, &(Unknown, usize))| {
            let value = self.progress.guess.get(unknown, channel);
            let standard_error = self.variances.get(k).map_or(f64::INFINITY, |variance| variance.sqrt());
            let x = unknown.unbounded(value);
            let around = |deviations: f64| {
                // An infinite error leaves the ends of the range
                [-1.0, 1.0].map(|sign| unknown.bounded(x + sign * deviations * standard_error))
            };
            let interval = Interval { value, likely: around(1.0), sure: around(1.96) };
            let channel = unknown.is_per_channel().then_some(channel);
            Estimate { unknown, channel, interval, standard_error }
        };
        parameters.iter().enumerate().map(estimate).collect()
    }

    /// Variance of the means of blocks over that which independent residuals would have: about 1 where the model is right
    /// and pixels do not depend on their neighbors.
    pub fn misfit(&self) -> f64 {
        if self.pictures.len() < SEEDS {
            return f64::NAN;
        }
        let blocks = self.block_of(self.photo.pixels.len() - 1) + 1;
        let (mut sums, mut squares) = (vec![[0.0; 3]; blocks], vec![[0.0; 3]; blocks]);
        for (i, weights) in self.weights.iter().enumerate() {
            for c in 0..3 {
                let residual = 0.5 * (self.residual(0, i, c) + self.residual(1, i, c));
                let weighted = f64::from(weights[c]).sqrt() * residual;
                sums[self.block_of(i)][c] += weighted;
                squares[self.block_of(i)][c] += weighted * weighted;
            }
        }
        let sum_of_squares = |values: &[[f64; 3]]| values.iter().flatten().map(|s| s * s).sum::<f64>();
        sum_of_squares(&sums) / squares.iter().flatten().sum::<f64>().max(f64::MIN_POSITIVE)
    }
}

/// Derivatives by one parameter of a channel, in each pixel and in the mean over those around.
struct Slope {
    exact: Photo,
    smooth: Photo,
}

/// Means over squares of pixels, as far as the picture goes.
fn smoothed(photo: &Photo, reach: usize) -> Photo {
    let along = |photo: &Photo| {
        // Means over rows, of the picture on its side: twice is both ways
        let mean = |x: usize, y: usize| {
            let (low, high) = (y.saturating_sub(reach), (y + reach + 1).min(photo.width));
            let sum = photo.pixels[x * photo.width..][low..high]
                .iter()
                .fold([0.0; 3], |sum, p| [0, 1, 2].map(|c| sum[c] + p[c]));
            sum.map(|s: f32| s / (high - low) as f32)
        };
        Photo::from_fn(photo.height, photo.width, mean)
    };
    along(&along(photo))
}

/// M⁻¹ S. Where noise, or parameters that do the same, leave no minimum, a little damping finds a way down.
fn solution(normal: &DMatrix<f64>, gradient: &DVector<f64>) -> DVector<f64> {
    let mut damping = 0.0;
    while damping < 1e6 {
        let mut damped = normal.clone();
        for i in 0..gradient.len() {
            damped[(i, i)] += damping * normal[(i, i)].abs() + f64::MIN_POSITIVE;
        }
        if let Some(factor) = damped.cholesky() {
            return factor.solve(gradient);
        }
        damping = if damping == 0.0 { 1e-2 } else { 4.0 * damping };
    }
    DVector::zeros(gradient.len())
}

/// Diagonal of M⁻¹ [Σ s_B s_Bᵀ] M⁻¹, widened for few blocks; infinite where M is not positive definite.
fn variances(normal: &DMatrix<f64>, scores: &[DVector<f64>]) -> Vec<f64> {
    let n = normal.nrows();
    let scores: Vec<_> = scores.iter().filter(|score| score.iter().any(|s| *s != 0.0)).collect();
    let factor = normal.clone().cholesky().filter(|_| scores.len() > n + 1);
    let Some(factor) = factor else { return vec![f64::INFINITY; n] };
    let mean = scores.iter().fold(DVector::zeros(n), |sum, score| sum + *score) / scores.len() as f64;
    let freedom = (scores.len() - n) as f64;
    // A normal distribution's 97.5 % quantile becomes Student's
    let student = 1.0 + (1.96 * 1.96 + 1.0) / (4.0 * freedom);
    let widened = scores.len() as f64 / freedom * student * student;
    let influences = scores.iter().map(|score| factor.solve(&(*score - &mean)));
    let sums = influences.fold(DVector::zeros(n), |sum, influence| sum + influence.component_mul(&influence));
    sums.iter().map(|sum| widened * sum).collect()
}

/// Weights as photons would have them, in parts of a channel's mean: the inverse of what the pixels around have, so that a
/// pixel's own noise does not count in its weight.
fn weights(photo: &Photo, block: usize) -> Vec<[f32; 3]> {
    let mean = photo.mean();
    let columns = photo.width.div_ceil(block);
    let local: Vec<[f64; 3]> = (0..columns * photo.height.div_ceil(block))
        .map(|i| {
            let (x, y) = (i % columns * block, i / columns * block);
            photo.part([x, y, x + block, y + block]).mean()
        })
        .collect();
    let weight = |i: usize| {
        let (x, y) = (i % photo.width, i / photo.width);
        let around = local[y / block * columns + x / block];
        std::array::from_fn(|c| {
            let value = photo.pixels[i][c];
            let is_lost = value == 1.0 || !value.is_finite() || mean[c] <= 0.0;
            if is_lost { 0.0 } else { (1.0 / (mean[c] * (around[c].max(0.0) + 0.05 * mean[c]))) as f32 }
        })
    };
    (0..photo.pixels.len()).map(weight).collect()
}

#[cfg(test)]
mod tests {
    use translucid_testing::SplitMix;

    use super::*;

    /// A stand-in for a renderer: stripes that are the brighter the higher A is, with edges that are the softer the longer ℓ
    /// is, and noise in proportion, other noise for each guess and seed.
    fn picture(guess: &Guess, noise: f64, random: &mut SplitMix) -> Photo {
        let mut pixel = |x: usize, _: usize| {
            let place = (x % 16) as f64 - 8.0;
            std::array::from_fn(|c| {
                let soft = 0.5 + 0.5 * libm::tanh(place / (10.0 * guess.mfp[c]));
                let light = guess.surface_albedo[c] * (0.2 + soft);
                let deviate: f64 = (0..12).map(|_| random.uniform()).sum::<f64>() - 6.0;
                (guess.radiance[c] * light * (1.0 + noise * deviate)) as f32
            })
        };
        let pixels = (0..48 * 48).map(|i| pixel(i % 48, i / 48)).collect();
        Photo { width: 48, height: 48, pixels }
    }

    const TRUTH: Guess =
        Guess { surface_albedo: [0.8, 0.5, 0.2], mfp: [0.4, 0.3, 0.3], g: 0.0, radiance: [1.0; 3] };

    fn fitted(photo: Photo, unknowns: &[Unknown], start: Guess, random: &mut SplitMix) -> KnownShape {
        let mut fit = KnownShape::new(photo, unknowns, start);
        while let Some(request) = fit.next() {
            fit.take(picture(&Guess { radiance: [1.0; 3], ..request.guess }, 0.2, random));
        }
        fit
    }

    /// 240 intervals of 95 %. Were each right, fewer than 216 of them would hold the truth once in 2,000 seeds, and the mean
    /// error in standard errors would be farther from 0 than 0.25 once in 9,000.
    #[test]
    fn noisy_pictures_give_unbiased_numbers_and_honest_intervals() {
        let mut random = SplitMix(1);
        let start = Guess { surface_albedo: [0.6; 3], mfp: [0.25; 3], ..TRUTH };
        let (mut count, mut held, mut away) = (0, 0, 0.0);
        for _ in 0..40 {
            let photo = picture(&TRUTH, 0.2, &mut random);
            let fit = fitted(photo, &[Unknown::Mfp, Unknown::SurfaceAlbedo], start, &mut random);
            assert!(fit.has_converged());
            for estimate in fit.estimates() {
                let channel = estimate.channel.unwrap();
                let truth = TRUTH.get(estimate.unknown, channel);
                let [low, high] = estimate.interval.sure;
                let x = |value: f64| estimate.unknown.unbounded(value);
                count += 1;
                held += usize::from(low < truth && truth < high);
                away += (x(estimate.interval.value) - x(truth)) / estimate.standard_error;
                assert!(estimate.standard_error < 0.2, "{estimate:?}");
            }
        }
        assert_eq!(count, 240);
        assert!(held >= 216, "{held} of {count}");
        assert!((away / 240.0).abs() < 0.25, "{}", away / 240.0);
    }

    /// Twice the albedo is the same picture as twice the light: neither is known.
    #[test]
    fn parameters_that_do_the_same_have_no_interval() {
        let mut random = SplitMix(2);
        let photo = picture(&TRUTH, 0.0, &mut random);
        let fit = fitted(photo, &[Unknown::SurfaceAlbedo, Unknown::Radiance], TRUTH, &mut random);
        assert!(
            fit.estimates().iter().all(|estimate| estimate.standard_error > 0.5),
            "{:?}",
            fit.estimates()
        );
    }

    #[test]
    fn fit_goes_on_where_it_was() {
        let start = Guess { surface_albedo: [0.6; 3], ..TRUTH };
        let photo = picture(&TRUTH, 0.2, &mut SplitMix(3));
        let rendered = |request: &Request| {
            let seed = 1000.0 * request.guess.surface_albedo[0] + request.seed as f64;
            picture(&request.guess, 0.1, &mut SplitMix(seed.to_bits()))
        };
        let new = || KnownShape::new(photo.clone(), &[Unknown::SurfaceAlbedo], start);
        let (mut whole, mut parts) = (new(), new());
        while let Some(request) = whole.next() {
            whole.take(rendered(&request));
            parts.take(rendered(&request));
            if whole.next().is_some() && parts.pictures() == 0 {
                let kept = parts.progress();
                parts = new();
                parts.resume(kept);
            }
        }
        assert!(parts == whole);
    }
}
