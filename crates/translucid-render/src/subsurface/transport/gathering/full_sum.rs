//! The whole sum over all places, less the light that does not arrive.
//!
//! K is known by channel without the visibility V. The whole sum without V comes first; then one place, drawn in proportion
//! to its term, is tested. If it is hidden, it represents all hidden places, and their light is subtracted.
//!
//! # Expected light
//! How many places lie near a receiver is a matter of chance, and so is how many of them are bright. Where the integral of
//! K_j V_j over all places is 1, that is taken away by a control variate, for any function h_j whose integral with K_j V_j is
//! known:
//!
//! ```text
//! L_j = ∫ K_j V_j h_j + Σ_i w_i(y_i) K_j(y_i) V_j(y_i) W_i (E_i − h_j(y_i)),     h_j = Ē + φ_j ΔĒ
//! ```
//!
//! Ē is the light to be expected inside, and Ē + ΔĒ that on surfaces. Both come from nearby receivers that share nothing
//! with these, so they do not depend on these receivers' places. φ_j, given by the receiver, is near 1 on surfaces and 0
//! inside.

use glam::Vec3;

use super::weights::{MisWeights, PlaceLanes, worth_of_channels};
use super::{Alike, BlockReceiver, COORDINATES, FoundLight, LANES, LightStatistics, Sums};
use crate::subsurface::transport::simd_loop::{SimdLoop, in_widest_vectors};

/// A receiver that fills K without V of each channel, one channel after the other.
pub(in crate::subsurface::transport) trait FullReceiver:
    BlockReceiver
{
    /// Returns `true` if no light arrives from a place.
    fn is_hidden(&self, found: &Self::FoundLight) -> bool;

    /// Returns `true` if the integral of K V over all places is 1 in every channel.
    fn is_complete(&self) -> bool;

    /// Returns `true` if another receiver may expect the light that this one finds: it shares nothing with this one, and is
    /// complete if this one is.
    fn tells_of(&self, other: &Self) -> bool;

    /// ∫ K V φ by channel, where it is complete.
    fn expected_part(&self) -> Vec3;

    /// φ by channel, one channel after the other, at places whose first ones, up to `split`, are inside and others on surfaces.
    fn fill_expected_part(&self, places: [&[f32]; COORDINATES], split: usize, part: &mut [f32]);
}

/// Light to be expected.
#[derive(Clone, Copy, Default)]
struct Expected {
    inside: Vec3,
    at_surfaces: Vec3,
}

/// Sums of all terms.
pub(in crate::subsurface::transport) struct FullSums<F> {
    /// Weights of all places; the parts are those inside and those on surfaces.
    weights: MisWeights<F>,
    /// The first receiver of each complete kind in the cohort, and the light that its finds let others expect.
    known: Vec<(usize, Expected)>,
    expected: Expected,
    /// φ of one receiver.
    part: Vec<f32>,
}

impl<F> Default for FullSums<F> {
    fn default() -> Self {
        Self {
            weights: MisWeights::default(),
            known: Vec::new(),
            expected: Expected::default(),
            part: Vec::new(),
        }
    }
}

fn is_on_surface(found: &impl FoundLight) -> bool {
    found.normal() != Vec3::ZERO
}

impl<R: FullReceiver> Sums<R> for FullSums<R::FoundLight> {
    fn look_around<'c>(&mut self, kinds: impl Iterator<Item = Alike<'c, R>>)
    where
        R: 'c,
    {
        self.known.clear();
        for alike in kinds.filter(|alike| alike.receivers().take(1).all(R::is_complete)) {
            let mut statistics = [LightStatistics::default(); 2];
            for found in alike.found().flatten() {
                statistics[usize::from(is_on_surface(found))].add(1.0, found);
            }
            let inside = statistics[0].expected();
            let at_surfaces = if statistics[1].is_empty() { inside } else { statistics[1].expected() };
            self.known.push((alike.indices[0], Expected { inside, at_surfaces }));
        }
    }

    fn prepare(&mut self, alike: &Alike<'_, R>) {
        let waiting = &alike.cohort.waiting;
        let first = &waiting[alike.indices[0]];
        let told = self.known.iter().filter(|(other, _)| waiting[*other].tells_of(first));
        // Too little light takes noise away, too; too much adds noise where it is dark
        let least = told.map(|(_, expected)| *expected).reduce(|a, b| Expected {
            inside: a.inside.min(b.inside),
            at_surfaces: a.at_surfaces.min(b.at_surfaces),
        });
        self.expected = least.unwrap_or_default();
        self.weights.arrange(alike, |_, found| usize::from(is_on_surface(found)), |_, _| ());
        self.weights.weigh(alike, 3, self.expected.inside);
    }

    fn gather(&mut self, row: usize, receiver: &R) -> Vec3 {
        let Self { weights, expected, part, .. } = self;
        let width = weights.width();
        let more = expected.at_surfaces - expected.inside;
        let mut light = expected.inside;
        let is_level = more == Vec3::ZERO;
        if !is_level {
            light += more * receiver.expected_part();
            part.resize(3 * width, 0.0);
            receiver.fill_expected_part(weights.points(), weights.split, part);
        }
        if width == 0 {
            return light;
        }
        let (places, terms) = weights.places_and_terms(row);
        let color = worth_of_channels(receiver.color());
        let expected = (!is_level).then_some((&**part, more.to_array()));
        let mut whole = [0.0; 3];
        in_widest_vectors(FullTerms { places, expected, color, terms, whole: &mut whole });
        let whole = Vec3::from_array(whole);
        let sum = weights.add_up(&(0..width));
        // Only extreme light is not finite
        if !(sum > 0.0 && sum.is_finite() && whole.is_finite()) {
            return light;
        }
        light += whole;
        let [place] = weights.find_places(&(0..width), [receiver.account().random * sum]);
        if receiver.is_hidden(&weights.found[place]) {
            let (PlaceLanes { near, bright, coefficients }, terms) = weights.places_and_terms(row);
            let term = |c: usize| {
                let i = c * width + place;
                let expected = if is_level { 0.0 } else { part[i] * (coefficients[place] * more[c]) };
                near[i] * (bright[c][place] - expected)
            };
            light -= Vec3::new(term(0), term(1), term(2)) * (sum / terms[place]);
        }
        light
    }
}

/// Light of all places for a receiver.
struct FullTerms<'a> {
    /// Their nearness is K, one channel after the other.
    places: PlaceLanes<'a>,
    /// φ, one channel after the other, and ΔĒ.
    expected: Option<(&'a [f32], [f32; 3])>,
    /// Worth of each channel.
    color: [f32; 3],
    /// Worth of each place.
    terms: &'a mut [f32],
    whole: &'a mut [f32; 3],
}

impl SimdLoop for FullTerms<'_> {
    #[inline(always)]
    fn run(mut self) {
        let n = self.terms.len() / LANES;
        let near = in_lanes(self.places.near, n);
        let bright = self.places.bright.map(|bright| &bright.as_chunks::<LANES>().0[..n]);
        if let Some((part, more)) = self.expected {
            let part = in_lanes(part, n);
            let coefficients = &self.places.coefficients.as_chunks::<LANES>().0[..n];
            self.add(n, |c, i, k| {
                near[c][i][k] * (bright[c][i][k] - part[c][i][k] * (coefficients[i][k] * more[c]))
            });
        } else {
            self.add(n, |c, i, k| near[c][i][k] * bright[c][i][k]);
        }
    }
}

impl FullTerms<'_> {
    /// Adds up n vectors of terms, by channel, vector and lane.
    #[inline(always)]
    fn add(&mut self, n: usize, term: impl Fn(usize, usize, usize) -> f32) {
        let [x, y, z] = self.color;
        let mut sums = [[0.0; LANES]; 3];
        let terms = &mut self.terms.as_chunks_mut::<LANES>().0[..n];
        for (i, terms) in terms.iter_mut().enumerate() {
            for k in 0..LANES {
                let [r, g, b] = [term(0, i, k), term(1, i, k), term(2, i, k)];
                sums[0][k] += r;
                sums[1][k] += g;
                sums[2][k] += b;
                terms[k] = r.abs() * x + g.abs() * y + b.abs() * z;
            }
        }
        *self.whole = sums.map(|sums| sums.iter().sum());
    }
}

/// Three channels' numbers in so many vectors each.
#[inline(always)]
fn in_lanes(channels: &[f32], n: usize) -> [&[[f32; LANES]]; 3] {
    let lanes = channels.as_chunks::<LANES>().0;
    [&lanes[..n], &lanes[n..2 * n], &lanes[2 * n..3 * n]]
}

#[cfg(test)]
mod tests {
    use super::super::Account;
    use super::super::toys::{Spot, density, integral, kernel, variances};
    use super::*;

    /// A receiver of one of two kinds; places above a limit are hidden, and if it is complete the others have more light.
    struct Toy {
        x: f32,
        kind: usize,
        is_complete: bool,
        limit: f32,
        factor: f32,
        expected_part: f32,
        account: Account,
    }

    impl BlockReceiver for Toy {
        type Kind = usize;
        type FoundLight = Spot;
        type Sums = FullSums<Spot>;

        fn kind(&self) -> usize {
            self.kind
        }

        fn account(&self) -> &Account {
            &self.account
        }

        /// K is that of the toys in red, twice that in green and nothing in blue.
        fn fill(&self, [y, ..]: [&[f32]; COORDINATES], row: &mut [f32], sums: &mut [f32]) {
            let n = y.len();
            row.fill(0.0);
            for (i, y) in y.iter().enumerate() {
                row[i] = self.factor * kernel(self.x, *y);
                row[n + i] = 2.0 * row[i];
                sums[i] += density(self.x, *y);
            }
        }

        fn color(&self) -> Vec3 {
            Vec3::new(0.3, 0.1, 0.2)
        }
    }

    impl FullReceiver for Toy {
        fn is_hidden(&self, spot: &Spot) -> bool {
            spot.y > self.limit
        }

        fn is_complete(&self) -> bool {
            self.is_complete
        }

        fn tells_of(&self, other: &Self) -> bool {
            self.kind != other.kind
        }

        fn expected_part(&self) -> Vec3 {
            Vec3::splat(self.expected_part)
        }

        /// 1 from x + 0.4 on.
        fn fill_expected_part(&self, [y, ..]: [&[f32]; COORDINATES], split: usize, part: &mut [f32]) {
            let n = y.len();
            for (i, y) in y.iter().enumerate() {
                // Filled up with places that nobody is near
                assert!(y.abs() > 1e3 || Spot::is_on_surface(*y) == (i >= split));
                (0..3).for_each(|c| part[c * n + i] = f32::from(u8::from(y - self.x > 0.4)));
            }
        }
    }

    fn toys(is_complete: bool, limit: f32) -> [f64; 9] {
        let visible = |x: f32, y: f32| if y > limit { 0.0 } else { kernel(x, y) };
        let known: [[f32; 2]; 9] = std::array::from_fn(|sample| {
            let x = 0.2 * sample as f32;
            let [all, part] = [-1.0, 0.4].map(|from| integral(x + from, x + 1.0, |y| visible(x, y)));
            if is_complete { [1.0 / all, part / all].map(|value| value as f32) } else { [1.0, 0.0] }
        });
        let toy = |x, account: Account| {
            let [factor, expected_part] = known[account.sample];
            Toy { x, kind: account.sample % 2, is_complete, limit, factor, expected_part, account }
        };
        variances(toy, |x, y| known[(x / 0.2).round() as usize][0] * visible(x, y))
    }

    /// Receivers expect the light that those of the other kind have found, and vary less.
    ///
    /// 18 comparisons of about 4 × 10⁴ trials, where 5 standard errors have a probability of 6e-7.
    #[test]
    fn expected_light_keeps_the_mean() {
        let [with, without] = [true, false].map(|is_complete| toys(is_complete, f32::INFINITY));
        assert!(with.iter().sum::<f64>() < 0.7 * without.iter().sum::<f64>(), "{with:?} {without:?}");
    }

    /// 18 comparisons as above.
    #[test]
    fn hidden_places_are_taken_away() {
        for is_complete in [true, false] {
            toys(is_complete, 0.7);
        }
    }
}
