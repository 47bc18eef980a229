//! Finding the bin of a number in constant time.

use std::fmt;

/// Counts how many of a list of increasing edges lie at or below a value.
///
/// A binary search over 300 edges mispredicts some eight branches, which costs as much as ten collisions of the
/// walk. Here the upper bits of the value, read as an `f32`, name a bucket; all but the few edges in the same
/// bucket are settled by a table.
#[derive(Clone, PartialEq)]
pub(crate) struct EdgeSearch {
    /// Increasing, at least 0.
    edges: Vec<f64>,
    /// Number of edges in lower buckets, for each bucket from `base` on, and one more entry at the end.
    below: Vec<u32>,
    /// Bucket of the first edge.
    base: u32,
}

impl EdgeSearch {
    /// The edges increase and are at least 0.
    pub(crate) fn new(edges: Vec<f64>) -> Self {
        let base = edges.first().map_or(0, |&edge| bucket(edge));
        let end = edges.last().map_or(0, |&edge| bucket(edge) + 1);
        let below = (base..=end).map(|b| edges.partition_point(|&edge| bucket(edge) < b) as u32).collect();
        Self { edges, below, base }
    }

    /// Number of edges at or below a value that is at least 0: the index of its bin [edge, next edge).
    #[inline]
    pub(crate) fn count_up_to(&self, value: f64) -> usize {
        // Rounding to f32 keeps the order, so edges in a lower bucket are below, those in a higher one above.
        let Some(bucket) = bucket(value).checked_sub(self.base) else { return 0 };
        let Some(&[below, next]) = self.below.get(bucket as usize..).and_then(|rest| rest.first_chunk())
        else {
            return self.edges.len();
        };
        let edges = &self.edges[below as usize..next as usize];
        if edges.len() > 4 {
            return below as usize + edges.partition_point(|&edge| edge <= value);
        }
        // The usual case, without a call: there are none or one.
        below as usize + edges.iter().filter(|&&edge| edge <= value).count()
    }

    /// The edges.
    pub(crate) fn edges(&self) -> &[f64] {
        &self.edges
    }
}

impl fmt::Debug for EdgeSearch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.edges.fmt(f)
    }
}

/// Exponent and upper six bits of the mantissa, as an `f32` has them: 64 buckets an octave.
fn bucket(value: f64) -> u32 {
    (value as f32).to_bits() >> 17
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(edges: &[f64], value: f64) {
        let search = EdgeSearch::new(edges.to_vec());
        let expected = edges.iter().filter(|&&edge| edge <= value).count();
        assert_eq!(search.count_up_to(value), expected, "{value:e} in {edges:?}");
    }

    #[test]
    fn search_agrees_with_counting() {
        let lists: [&[f64]; 5] = [
            &[],
            &[1.0],
            &[1e-30, 1e-3, 0.5, 0.5000000001, 0.50000000011, 0.6, 7.0, 1e30],
            &[3.0, 3.0 + 1e-12, 3.0 + 2e-12],
            &[1e-60, 1e60],
        ];
        for edges in lists {
            for &edge in edges {
                for value in [edge.next_down(), edge, edge.next_up(), 0.99 * edge, 1.01 * edge] {
                    check(edges, value);
                }
            }
            for value in [0.0, 1e-300, 0.2, 1.0, 2.9999999, 5.0, 1e300, f64::INFINITY] {
                check(edges, value);
            }
        }
    }
}
