//! Ranges of photons that a table holds.

use std::fmt;
use std::ops::Range;

/// Range of photons of a seed. A photon's walk is a function of seed and index, so these numbers say all about it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PhotonRange {
    /// Seed of the random numbers.
    pub seed: u64,
    /// Index of the first photon.
    pub start: u64,
    /// Index after the last photon.
    pub end: u64,
}

impl PhotonRange {
    /// Number of photons.
    #[allow(clippy::len_without_is_empty, reason = "a list of ranges has no empty ones")]
    pub fn len(&self) -> u64 {
        self.end.saturating_sub(self.start)
    }
}

impl fmt::Display for PhotonRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { seed, start, end } = self;
        write!(f, "photons {start}..{end} of seed {seed}")
    }
}

/// Photons without repetition, as ranges that are sorted, apart and not empty.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct PhotonRanges(Vec<PhotonRange>);

impl PhotonRanges {
    /// The ranges in any order; empty ones are left out.
    ///
    /// # Errors
    /// The first photons that are in two of them.
    pub(crate) fn new(ranges: impl IntoIterator<Item = PhotonRange>) -> Result<Self, PhotonRange> {
        let mut sorted: Vec<_> = ranges.into_iter().filter(|range| range.len() > 0).collect();
        sorted.sort_unstable();
        let mut joined: Vec<PhotonRange> = Vec::new();
        for range in sorted {
            match joined.last_mut() {
                Some(last) if last.seed == range.seed && range.start < last.end => {
                    return Err(PhotonRange { end: range.end.min(last.end), ..range });
                }
                Some(last) if last.seed == range.seed && last.end == range.start => last.end = range.end,
                _ => joined.push(range),
            }
        }
        Ok(Self(joined))
    }

    /// The ranges, sorted and joined.
    pub(crate) fn as_slice(&self) -> &[PhotonRange] {
        &self.0
    }

    /// Number of photons, or nothing where it does not fit.
    pub(crate) fn len(&self) -> Option<u64> {
        self.0.iter().try_fold(0u64, |sum, range| sum.checked_add(range.len()))
    }

    /// Both together.
    ///
    /// # Errors
    /// The first photons that are in both.
    pub(crate) fn union(&self, other: &Self) -> Result<Self, PhotonRange> {
        Self::new(self.0.iter().chain(&other.0).copied())
    }

    /// The first `count` photons of a seed, among those in `within`, that are not among these; fewer where there are
    /// no more.
    pub(crate) fn missing(&self, seed: u64, within: Range<u64>, count: u64) -> Vec<Range<u64>> {
        let mut found = Vec::new();
        let (mut next, mut left) = (within.start, count);
        let held = self.0.iter().filter(|range| range.seed == seed).map(|range| (range.start, range.end));
        for (start, end) in held.chain([(within.end, within.end)]) {
            let length = left.min(start.min(within.end).saturating_sub(next));
            if length > 0 {
                found.push(next..next + length);
            }
            left -= length;
            next = next.max(end);
        }
        found
    }

    /// The photons that are missing between the first, 0, and the last that is held, of every seed.
    pub(crate) fn gaps(&self) -> Vec<PhotonRange> {
        let mut gaps = Vec::new();
        for seed in self.0.chunk_by(|a, b| a.seed == b.seed) {
            let (seed, end) = (seed[0].seed, seed[seed.len() - 1].end);
            let missing = self.missing(seed, 0..end, u64::MAX).into_iter();
            gaps.extend(missing.map(|Range { start, end }| PhotonRange { seed, start, end }));
        }
        gaps
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn range(seed: u64, start: u64, end: u64) -> PhotonRange {
        PhotonRange { seed, start, end }
    }

    fn ranges(list: &[(u64, u64, u64)]) -> PhotonRanges {
        PhotonRanges::new(list.iter().map(|&(seed, start, end)| range(seed, start, end))).unwrap()
    }

    #[test]
    fn ranges_are_sorted_and_joined() {
        let found = ranges(&[(2, 0, 5), (1, 7, 9), (1, 3, 7), (1, 0, 2), (1, 5, 5), (2, 9, 3)]);
        assert_eq!(found.as_slice(), [range(1, 0, 2), range(1, 3, 9), range(2, 0, 5)]);
        assert_eq!(found.len(), Some(13));
    }

    #[test]
    fn ranges_refuse_repetition() {
        assert_eq!(PhotonRanges::new([range(1, 0, 5), range(1, 4, 6)]), Err(range(1, 4, 5)));
        assert_eq!(PhotonRanges::new([range(1, 0, 9), range(1, 1, 2), range(1, 9, 10)]), Err(range(1, 1, 2)));
        assert!(PhotonRanges::new([range(1, 0, 5), range(2, 4, 6)]).is_ok());
    }

    #[test]
    fn union_finds_what_is_shared() {
        let a = ranges(&[(1, 0, 10), (1, 20, 30), (3, 0, 10)]);
        assert_eq!(a.union(&ranges(&[(1, 12, 15), (1, 25, 40)])), Err(range(1, 25, 30)));
        assert_eq!(a.union(&ranges(&[(0, 0, 99), (2, 0, 99), (3, 9, 10)])), Err(range(3, 9, 10)));
        assert_eq!(a.union(&a), Err(range(1, 0, 10)));
        let b = ranges(&[(1, 10, 20), (2, 0, 10), (3, 10, 11)]);
        let both = ranges(&[(1, 0, 30), (2, 0, 10), (3, 0, 11)]);
        assert_eq!((a.union(&b), b.union(&a)), (Ok(both.clone()), Ok(both)));
    }

    /// Against a set of photons.
    #[test]
    fn union_agrees_with_sets() {
        use std::collections::BTreeSet;
        let mut state = 1u64;
        let mut random = |n: u64| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 33) % n
        };
        let mut outcomes = [0, 0];
        for _ in 0..2000 {
            let mut one = || {
                let list: Vec<_> = (0..1 + random(3))
                    .map(|_| {
                        let (seed, start) = (random(2), random(20));
                        range(seed, start, start + random(6))
                    })
                    .collect();
                let photons = list.iter().flat_map(|r| (r.start..r.end).map(|i| (r.seed, i)));
                (PhotonRanges::new(list.clone()), photons.clone().count(), photons.collect::<BTreeSet<_>>())
            };
            let ((a, a_count, a_set), (b, b_count, b_set)) = (one(), one());
            assert_eq!((a.is_ok(), b.is_ok()), (a_count == a_set.len(), b_count == b_set.len()));
            let (Ok(a), Ok(b)) = (a, b) else { continue };
            let found = a.union(&b);
            outcomes[usize::from(found.is_ok())] += 1;
            assert_eq!(found.is_ok(), a_set.is_disjoint(&b_set), "{a:?} {b:?}");
            if let Ok(both) = found {
                assert_eq!(both.len(), Some((a_set.len() + b_set.len()) as u64));
            }
        }
        assert!(outcomes.iter().all(|&n| n > 100), "{outcomes:?}");
    }

    #[test]
    fn missing_photons_come_first_to_last() {
        let held = ranges(&[(1, 5, 10), (1, 12, 20), (2, 0, 100)]);
        let missing = |ranges: &PhotonRanges, seed, count| {
            let found = ranges.missing(seed, 0..u64::MAX, count);
            found.into_iter().map(|range| (range.start, range.end)).collect::<Vec<_>>()
        };
        assert_eq!(missing(&held, 1, 3), [(0, 3)]);
        assert_eq!(missing(&held, 1, 9), [(0, 5), (10, 12), (20, 22)]);
        assert_eq!(missing(&held, 2, 7), [(100, 107)]);
        assert_eq!(missing(&held, 9, 7), [(0, 7)]);
        assert_eq!(missing(&held, 9, 0), []);
        let full = ranges(&[(1, 0, u64::MAX - 2)]);
        assert_eq!(missing(&full, 1, 50), [(u64::MAX - 2, u64::MAX)]);
        assert_eq!(full.len(), Some(u64::MAX - 2));
        assert_eq!(ranges(&[(1, 0, u64::MAX), (2, 0, 1)]).len(), None);
    }

    /// Against a set of photons.
    #[test]
    fn missing_photons_are_those_of_the_range_that_are_not_held() {
        let held = ranges(&[(1, 5, 10), (1, 12, 20), (2, 0, 100)]);
        for (start, end) in (0..25).flat_map(|start| (0..25).map(move |end| (start, end))) {
            for count in [0, 1, 4, u64::MAX] {
                let is_held = |photon: &u64| (5..10).contains(photon) || (12..20).contains(photon);
                let expected: Vec<u64> =
                    (start..end).filter(|photon| !is_held(photon)).take(count.min(99) as usize).collect();
                let found: Vec<u64> = held.missing(1, start..end, count).into_iter().flatten().collect();
                assert_eq!(found, expected, "{start}..{end}, {count}");
            }
        }
    }

    #[test]
    fn gaps_are_before_the_last_photon_of_a_seed() {
        let held = ranges(&[(1, 5, 10), (1, 12, 20), (2, 0, 100), (7, 3, 4)]);
        assert_eq!(held.gaps(), [range(1, 0, 5), range(1, 10, 12), range(7, 0, 3)]);
        assert_eq!(ranges(&[]).gaps(), []);
    }
}
