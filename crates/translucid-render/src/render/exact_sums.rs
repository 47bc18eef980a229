//! Sums of pixels that do not depend on the order of what is added: each is the exact sum, rounded once.
//!
//! A sum of `f32` numbers in an `f64` is exact but for numbers a hundred million times smaller than the sum. Where an
//! addition is not exact, its error is kept beside the rounded sum, and both together are the exact sum again.

use std::ops::Range;

use crate::world::layer;

/// Sums of the pixels of a tile.
#[derive(Clone, Debug, Default)]
pub(super) struct ExactSums {
    /// The exact sums, rounded to the nearest number.
    pub(super) rounded: Vec<[f64; layer::COUNT]>,
    /// Rests of sums that are not exact in an `f64`: the number of the sum and a part, in the order of the numbers, the parts
    /// of a sum from the greatest to the smallest. Each part is the rest that the parts before it leave, rounded.
    rests: Vec<(u32, f64)>,
    /// For each pixel the sums that have a rest, as bits; empty where there was none yet.
    has_rest: Vec<u32>,
}

/// Sums are equal if rounded sums and rests are.
impl PartialEq for ExactSums {
    fn eq(&self, other: &Self) -> bool {
        (&self.rounded, &self.rests) == (&other.rounded, &other.rests)
    }
}

impl ExactSums {
    /// Sums of nothing.
    pub(super) fn new(pixels: usize) -> Self {
        Self { rounded: vec![[0.0; layer::COUNT]; pixels], ..Self::default() }
    }

    /// Rests of the sums, see [`ExactSums`].
    pub(super) fn rests(&self) -> &[(u32, f64)] {
        &self.rests
    }

    /// Adds finite numbers to the sums of a pixel.
    pub(super) fn add(&mut self, pixel: usize, values: &[f64; layer::COUNT]) {
        let sums = &mut self.rounded[pixel];
        let before = *sums;
        // Without a branch, so that it becomes vector code
        let mut errors = 0.0;
        for (sum, value) in sums.iter_mut().zip(values) {
            let (rounded, error) = two_sum(*sum, *value);
            *sum = rounded;
            errors += error.abs();
        }
        let has_rest = self.has_rest.get(pixel).copied().unwrap_or(0);
        if errors > 0.0 || has_rest != 0 {
            self.rounded[pixel] = before;
            self.add_with_rests(pixel, values, has_rest);
        }
    }

    #[cold]
    fn add_with_rests(&mut self, pixel: usize, values: &[f64; layer::COUNT], has_rest: u32) {
        for (i, value) in values.iter().enumerate() {
            let (rounded, error) = two_sum(self.rounded[pixel][i], *value);
            if error == 0.0 && has_rest & 1 << i == 0 {
                self.rounded[pixel][i] = rounded;
            } else {
                self.add_exactly(pixel, i, *value);
            }
        }
    }

    /// Adds the sums of a pixel of another tile.
    pub(super) fn add_pixel(&mut self, pixel: usize, other: &Self, other_pixel: usize) {
        self.add(pixel, &other.rounded[other_pixel]);
        for &(number, part) in
            &other.rests[other.rests_of(number_of(other_pixel, 0)..number_of(other_pixel + 1, 0))]
        {
            self.add_exactly(pixel, number as usize % layer::COUNT, part);
        }
    }

    /// Sums that were read from a file; `None` where rounded sums and rests do not belong together.
    pub(super) fn from_parts(rounded: Vec<[f64; layer::COUNT]>, rests: &[(u32, f64)]) -> Option<Self> {
        let mut sums = Self { rounded, ..Self::default() };
        let (count, before) = (sums.rounded.len() * layer::COUNT, sums.rounded.clone());
        for &(number, part) in rests {
            let number = number as usize;
            let is_right = number < count && part.is_finite() && part != 0.0;
            if !is_right || !before[number / layer::COUNT][number % layer::COUNT].is_finite() {
                return None;
            }
            sums.add_exactly(number / layer::COUNT, number % layer::COUNT, part);
        }
        // Adding the rests must not have changed the rounded sums
        (sums.rounded == before && sums.rests == rests).then_some(sums)
    }

    #[cold]
    fn add_exactly(&mut self, pixel: usize, sum: usize, value: f64) {
        let number = number_of(pixel, sum);
        let place = self.rests_of(number..number + 1);
        let mut parts = Vec::new();
        let before = self.rests[place.clone()].iter().map(|(_, part)| *part);
        before.chain([self.rounded[pixel][sum], value]).for_each(|part| grow(&mut parts, part));
        self.rounded[pixel][sum] = take_rounded(&mut parts);
        let mut rest = Vec::new();
        while !parts.is_empty() {
            rest.push((number, take_rounded(&mut parts)));
        }
        if self.has_rest.is_empty() {
            self.has_rest = vec![0; self.rounded.len()];
        }
        let bit = 1 << sum;
        self.has_rest[pixel] =
            if rest.is_empty() { self.has_rest[pixel] & !bit } else { self.has_rest[pixel] | bit };
        self.rests.splice(place, rest);
    }

    /// Places of the rests of some sums.
    fn rests_of(&self, numbers: Range<u32>) -> Range<usize> {
        let place = |number: u32| self.rests.partition_point(|(of, _)| *of < number);
        place(numbers.start)..place(numbers.end)
    }
}

/// Number of a sum in a tile.
fn number_of(pixel: usize, sum: usize) -> u32 {
    (pixel * layer::COUNT + sum) as u32
}

/// A sum and the error of its rounding, which is exact [Knuth 1997, §4.2.2, theorem B].
#[inline(always)]
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

/// Adds a number to parts that do not overlap, from the smallest to the greatest, and keeps them so [Shewchuk 1997,
/// theorem 10].
fn grow(parts: &mut Vec<f64>, value: f64) {
    let mut sum = value;
    parts.retain_mut(|part| {
        let (greater, error) = two_sum(sum, *part);
        sum = greater;
        *part = error;
        error != 0.0
    });
    if sum != 0.0 {
        parts.push(sum);
    }
}

/// The sum of parts that do not overlap, rounded to the nearest number, ties to even; the parts lose it.
fn take_rounded(parts: &mut Vec<f64>) -> f64 {
    let mut lower = parts.iter().rev().copied();
    let mut rounded = lower.next().unwrap_or(0.0);
    while let Some(part) = lower.next() {
        let (sum, error) = two_sum(rounded, part);
        rounded = sum;
        if error != 0.0 {
            // A tie between two numbers is none where something is left below
            let (other, rounding) = two_sum(sum, 2.0 * error);
            if lower.next().is_some_and(|below| below.signum() == error.signum()) && rounding == 0.0 {
                rounded = other;
            }
            break;
        }
    }
    grow(parts, -rounded);
    rounded
}

#[cfg(test)]
mod tests {
    use super::*;

    fn random() -> impl FnMut() -> u64 {
        let mut state = 1_u64;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            state >> 20
        }
    }

    /// Finite numbers of all sizes and signs; some sums cancel.
    fn value(random: &mut impl FnMut() -> u64, spread: u64) -> f32 {
        let exponent = 127 - spread as i64 / 2 + (random() % spread) as i64;
        let bits = (random() as u32 & 0x007f_ffff) | (exponent.clamp(0, 254) as u32) << 23;
        f32::from_bits(bits | (random() as u32 & 1) << 31)
    }

    /// An integer of 320 bits in units of the smallest `f32`: the sums, done slowly.
    #[derive(Clone, Default, PartialEq, Debug)]
    struct Integer([i64; 12]);

    impl Integer {
        fn add(&mut self, value: f32) {
            let bits = value.to_bits();
            let exponent = (bits >> 23 & 0xff) as usize;
            let fraction = i64::from(bits & 0x007f_ffff | if exponent > 0 { 0x0080_0000 } else { 0 });
            let shift = exponent.max(1) - 1;
            let fraction = fraction << (shift % 30);
            let sign = if value < 0.0 { -1 } else { 1 };
            self.0[shift / 30] += sign * (fraction & ((1 << 30) - 1));
            self.0[shift / 30 + 1] += sign * (fraction >> 30);
        }

        /// The sum as parts whose sum it is exactly, from the lowest.
        fn parts(&self) -> impl Iterator<Item = f64> {
            let scale = |limb: usize| 2.0_f64.powi(30 * limb as i32 - 149);
            self.0.iter().enumerate().map(move |(i, limb)| *limb as f64 * scale(i))
        }
    }

    #[test]
    fn sums_are_exact_in_any_order_and_grouping() {
        let mut random = random();
        for spread in [2, 30, 60, 250] {
            let samples: Vec<[f64; layer::COUNT]> =
                (0..300).map(|_| std::array::from_fn(|_| f64::from(value(&mut random, spread)))).collect();
            let mut once = ExactSums::new(1);
            samples.iter().for_each(|sample| once.add(0, sample));
            // Some other order, in seven groups that are joined as a tree
            let mut groups = vec![ExactSums::new(1); 7];
            for sample in samples.iter().rev() {
                groups[(random() % 7) as usize].add(0, sample);
            }
            while groups.len() > 1 {
                let last = groups.pop().unwrap();
                let into = (random() % groups.len() as u64) as usize;
                groups[into].add_pixel(0, &last, 0);
            }
            assert_eq!(groups[0], once, "spread {spread}");
            assert_eq!(spread > 2, !once.rests.is_empty(), "spread {spread}");
            for channel in 0..layer::COUNT {
                let mut integer = Integer::default();
                samples.iter().for_each(|sample| integer.add(sample[channel] as f32));
                let mut parts = Vec::new();
                integer.parts().for_each(|part| grow(&mut parts, part));
                let rest = once.rests.iter().filter(|(number, _)| *number == channel as u32);
                rest.for_each(|(_, part)| grow(&mut parts, -part));
                grow(&mut parts, -once.rounded[0][channel]);
                assert!(parts.is_empty(), "spread {spread}: {parts:?} is left of sum {channel}");
                let rest = once.rests.iter().find(|(number, _)| *number == channel as u32);
                let ulp = once.rounded[0][channel].abs().next_up() - once.rounded[0][channel].abs();
                assert!(rest.is_none_or(|(_, rest)| rest.abs() <= 0.5 * ulp));
            }
        }
    }

    #[test]
    fn ties_go_to_even_unless_something_is_below() {
        let one = 2.0_f64.powi(53);
        for (values, expected) in [
            (&[one, 1.0][..], one),
            (&[one, 1.0, 2.0_f64.powi(-60)], one + 2.0),
            (&[one, 1.0, -(2.0_f64.powi(-60))], one),
            (&[one + 2.0, 1.0], one + 4.0),
            (&[one + 2.0, 1.0, -(2.0_f64.powi(-60))], one + 2.0),
            (&[-one, -1.0, -(2.0_f64.powi(-60))], -one - 2.0),
            (&[one, 1.0, -one, -1.0], 0.0),
        ] {
            let mut sums = ExactSums::new(1);
            for value in values {
                sums.add(0, &[*value; layer::COUNT]);
            }
            assert_eq!(sums.rounded[0], [expected; layer::COUNT], "{values:?}");
            assert!(sums.rounded[0][0].is_sign_positive() || expected < 0.0);
        }
    }

    #[test]
    fn rests_of_a_file_must_be_those_of_the_sums() {
        let mut sums = ExactSums::new(2);
        sums.add(1, &[1e20; layer::COUNT]);
        sums.add(1, &[1e-20; layer::COUNT]);
        let read = |rests: &[(u32, f64)]| {
            ExactSums::from_parts(sums.rounded.clone(), rests).is_some_and(|read| read == sums)
        };
        assert!(read(sums.rests()));
        let first = sums.rests()[0];
        for wrong in
            [(first.0, 0.0), (first.0, f64::NAN), (first.0, 1e19), (0, 1.0), (42, 1e-20), (u32::MAX, 1e-20)]
        {
            assert!(!read(&[&[wrong], &sums.rests()[1..]].concat()), "{wrong:?}");
        }
        assert!(!read(&[&sums.rests()[1..], &[first]].concat()), "not in order");
    }
}
