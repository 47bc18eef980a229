//! Numbers of samples that a film holds.

use std::fmt;
use std::ops::Range;

/// Sample numbers without repetition, as half-open ranges that are sorted, apart and not empty.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SampleRanges(Vec<Range<u32>>);

impl SampleRanges {
    /// The ranges in any order; empty ones are left out.
    ///
    /// # Errors
    /// The first numbers that are in two of them.
    pub fn new(ranges: impl IntoIterator<Item = Range<u32>>) -> Result<Self, Range<u32>> {
        let mut sorted: Vec<_> = ranges.into_iter().filter(|range| !range.is_empty()).collect();
        sorted.sort_unstable_by_key(|range| (range.start, range.end));
        let mut joined: Vec<Range<u32>> = Vec::new();
        for range in sorted {
            match joined.last_mut() {
                Some(last) if range.start < last.end => return Err(range.start..range.end.min(last.end)),
                Some(last) if last.end == range.start => last.end = range.end,
                _ => joined.push(range),
            }
        }
        Ok(Self(joined))
    }

    /// The ranges.
    pub fn as_slice(&self) -> &[Range<u32>] {
        &self.0
    }

    /// How many numbers there are.
    pub fn count(&self) -> u32 {
        self.0.iter().map(|range| range.end - range.start).sum()
    }

    /// Returns `true` if a number is among them.
    pub fn contains(&self, number: u32) -> bool {
        let after = self.0.partition_point(|range| range.end <= number);
        self.0.get(after).is_some_and(|range| range.start <= number)
    }

    /// Both together.
    ///
    /// # Errors
    /// The first numbers that are in both.
    pub fn union(&self, other: &Self) -> Result<Self, Range<u32>> {
        Self::new(self.0.iter().chain(&other.0).cloned())
    }

    /// The numbers that are in both.
    pub(super) fn intersection(&self, other: &Self) -> Self {
        let pairs =
            self.0.iter().flat_map(|a| other.0.iter().map(move |b| a.start.max(b.start)..a.end.min(b.end)));
        Self(pairs.filter(|both| !both.is_empty()).collect())
    }

    /// The numbers of a range that are not among these.
    pub fn missing(&self, from: Range<u32>) -> impl Iterator<Item = Range<u32>> {
        let starts = std::iter::once(0).chain(self.0.iter().map(|range| range.end));
        let ends = self.0.iter().map(|range| range.start).chain([u32::MAX]);
        let gaps = starts.zip(ends).map(move |(start, end)| start.max(from.start)..end.min(from.end));
        gaps.filter(|gap| !gap.is_empty())
    }

    /// Adds a number that is not among them.
    pub(super) fn insert(&mut self, number: u32) {
        let after = self.0.partition_point(|range| range.end < number);
        match self.0.get_mut(after) {
            Some(range) if range.end == number => {
                range.end += 1;
                let end = range.end;
                if let Some(next) = self.0.get(after + 1).filter(|next| next.start == end).cloned() {
                    self.0[after].end = next.end;
                    self.0.remove(after + 1);
                }
            }
            Some(range) if range.start == number + 1 => range.start = number,
            _ => self.0.insert(after, number..number + 1),
        }
    }
}

/// A range as it is.
impl From<Range<u32>> for SampleRanges {
    fn from(range: Range<u32>) -> Self {
        Self(if range.is_empty() { Vec::new() } else { vec![range] })
    }
}

/// `0..16, 32..48`; nothing for none.
impl fmt::Display for SampleRanges {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (number, Range { start, end }) in self.0.iter().enumerate() {
            write!(f, "{}{start}..{end}", if number > 0 { ", " } else { "" })?;
        }
        Ok(())
    }
}

#[cfg(test)]
#[allow(clippy::single_range_in_vec_init, reason = "a list of one range is meant")]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    fn ranges(list: &[Range<u32>]) -> SampleRanges {
        SampleRanges::new(list.iter().cloned()).unwrap()
    }

    #[test]
    fn ranges_are_sorted_and_joined() {
        let found = ranges(&[7..9, 3..7, 0..2, 5..5]);
        assert_eq!(found.as_slice(), [0..2, 3..9]);
        assert_eq!((found.count(), found.to_string()), (8, String::from("0..2, 3..9")));
        assert_eq!(SampleRanges::new([0..9, 1..2, 9..10]), Err(1..2));
    }

    /// Against sets of numbers.
    #[test]
    fn ranges_agree_with_sets() {
        let mut state = 1u64;
        let mut random = |n: u64| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            ((state >> 33) % n) as u32
        };
        let mut joined = 0;
        for _ in 0..3000 {
            let mut one = || {
                let (mut ranges, mut set) = (SampleRanges::default(), BTreeSet::new());
                for _ in 0..random(9) {
                    let number = random(24);
                    if set.insert(number) {
                        ranges.insert(number);
                    }
                }
                (ranges, set)
            };
            let ((a, a_set), (b, b_set)) = (one(), one());
            assert_eq!(SampleRanges::new(a_set.iter().map(|&number| number..number + 1)), Ok(a.clone()));
            assert_eq!(a.count() as usize, a_set.len());
            (0..26).for_each(|number| assert_eq!(a.contains(number), a_set.contains(&number)));
            let (start, end) = (random(24), random(30));
            let missing: Vec<u32> = a.missing(start..end).flatten().collect();
            let expected: Vec<u32> = (start..end).filter(|number| !a_set.contains(number)).collect();
            assert_eq!(missing, expected);
            let both: BTreeSet<u32> = a_set.intersection(&b_set).copied().collect();
            let found: BTreeSet<u32> = a.intersection(&b).as_slice().iter().cloned().flatten().collect();
            assert_eq!(found, both);
            assert_eq!(a.union(&b).is_ok(), a_set.is_disjoint(&b_set));
            if let Ok(both) = a.union(&b) {
                joined += 1;
                assert_eq!(both.count() as usize, a_set.len() + b_set.len());
            }
        }
        assert!(joined > 300, "{joined}");
    }
}
