//! Bins of the order of scattering, and what their width costs.
//!
//! A white walk records after how many collisions n a photon left, and gives it the weight βⁿ afterwards, where
//! β = α/α_ref. Orders run into the millions, so high ones share bins. A bin [a, b] of orders keeps the number
//! of its photons and the sum of their orders, hence their mean n̄. βⁿ is convex in n, so the mean weight of the
//! bin's photons is at least that of a photon of order n̄ and at most the chord's:
//!
//! ```text
//! βⁿ̄ ≤ mean of βⁿ ≤ (1−t) βᵃ + t βᵇ,   t = (n̄−a)/(b−a)
//! ```
//!
//! The two differ by at most λ²(b−a)²/8 · βᵃ with λ = −ln β (the second derivative of βⁿ is at most λ²βᵃ), and
//! λ²a² e^{−λa} ≤ 4/e² whatever the albedo, so the weight is known to within ((b−a)/a)²/(2e²): see
//! [`OrderBins::weight_error_bound`]. What weight is taken inside these limits
//! is the matter of [`Weights`](super::weights::Weights).

use translucid_profile::{ParameterError, require};

use super::edge_search::EdgeSearch;

/// Bins of the order of scattering: 0, 1, 2, … on their own, then growing in proportion to the order.
///
/// The last has no end.
///
/// ```
/// use translucid_reference::walk::OrderBins;
///
/// let bins = OrderBins::new(0.125)?;
/// assert_eq!(bins.orders(3), (3, Some(3))); // order 3 alone
/// assert_eq!(bins.orders(bins.bin(100)), (91, Some(101)));
/// assert!(bins.weight_error_bound() < 0.0011);
/// # Ok::<(), translucid_profile::ParameterError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct OrderBins {
    /// The first orders of all bins but bin 0, which starts at 0.
    search: EdgeSearch,
}

impl OrderBins {
    /// Latest start of the bin without an end: at the highest reference albedo fewer than one photon
    /// in 10⁷ gets there.
    const LAST: u32 = 1 << 24;
    /// Most bins that a layout may have.
    pub(crate) const MOST: usize = 4096;

    /// Bins of one order up to 2/growth, then of `growth` times their first order, rounded down.
    ///
    /// # Errors
    /// `growth` is not in [1/256, 1].
    pub fn new(growth: f64) -> Result<Self, ParameterError> {
        require((1.0 / 256.0..=1.0).contains(&growth), "growth", growth, "in [1/256, 1]")?;
        let next = |&first: &u32| {
            let width = (growth * f64::from(first)).floor().max(1.0);
            Some(first + width as u32).filter(|&next| next <= Self::LAST)
        };
        Self::from_first_orders(std::iter::successors(Some(0), next))
    }

    /// Bins that start at the given orders: 0 first, then strictly increasing.
    pub(crate) fn from_first_orders(first: impl IntoIterator<Item = u32>) -> Result<Self, ParameterError> {
        let first: Vec<f64> = first.into_iter().map(f64::from).collect();
        let (name, least) = ("first order of a bin", first.first().copied().unwrap_or(f64::NAN));
        require(least == 0.0, name, least, "0 for the first bin")?;
        for pair in first.windows(2) {
            require(pair[0] < pair[1], name, pair[1], "greater than that of the bin before")?;
        }
        require(first.len() <= Self::MOST, "number of order bins", first.len() as f64, "at most 4096")?;
        Ok(Self { search: EdgeSearch::new(first[1..].to_vec()) })
    }

    /// The finest of a few sets of bins of which `cells` copies have at most `most` entries, if any has.
    pub(crate) fn finest(cells: usize, most: usize) -> Option<Self> {
        let sets = [128.0, 64.0, 32.0, 16.0, 8.0, 4.0].into_iter().filter_map(|n| Self::new(1.0 / n).ok());
        sets.into_iter().find(|bins| bins.len().checked_mul(cells).is_some_and(|entries| entries <= most))
    }

    /// Number of bins, at least 1.
    #[allow(clippy::len_without_is_empty, reason = "there is always a bin")]
    pub fn len(&self) -> usize {
        self.search.edges().len() + 1
    }

    /// The bin of an order.
    pub fn bin(&self, order: u32) -> usize {
        self.search.count_up_to(f64::from(order))
    }

    /// First and last order of a bin; the last bin has no last order, nor has any index after it.
    pub fn orders(&self, bin: usize) -> (u32, Option<u32>) {
        let edges = self.search.edges();
        let first = bin.min(edges.len()).checked_sub(1).map_or(0, |before| edges[before] as u32);
        (first, edges.get(bin).map(|&next| next as u32 - 1))
    }

    /// First orders of all bins.
    pub(crate) fn first_orders(&self) -> impl Iterator<Item = u32> {
        (0..self.len()).map(|bin| self.orders(bin).0)
    }

    /// Greatest distance of the mean weight of a bin's photons from what count and mean order say, at any albedo, for
    /// all bins but the last: ((b−a)/a)²/(2e²).
    ///
    /// A weight is at most 1, the photon's at the reference albedo. So this is also the greatest possible error
    /// of an energy, as a part of the energy in the same place at the reference albedo. Relative to the energy at
    /// a lower albedo the limit depends on what the table holds:
    /// [`AtAlbedo::grouping_error`](super::AtAlbedo::grouping_error).
    pub fn weight_error_bound(&self) -> f64 {
        let relative_width = |bin| match self.orders(bin) {
            (first, Some(last)) if last > first => f64::from(last - first) / f64::from(first),
            _ => 0.0,
        };
        let widest = (0..self.len()).map(relative_width).fold(0.0, f64::max);
        widest * widest / (2.0 * std::f64::consts::E.powi(2))
    }
}

/// Number of photons in a place that left after orders of scattering in one bin, and the sum of these orders.
///
/// Whole numbers: their sums do not depend on who adds them up, or in which sequence.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Cell {
    pub(crate) count: u64,
    pub(crate) order_sum: u64,
}

impl Cell {
    /// Sum, or nothing where a number does not fit.
    pub(crate) fn checked_add(self, other: Self) -> Option<Self> {
        let count = self.count.checked_add(other.count)?;
        let order_sum = self.order_sum.checked_add(other.order_sum)?;
        Some(Self { count, order_sum })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_cover_every_order_once() {
        for growth in [1.0 / 256.0, 1.0 / 128.0, 0.1, 0.25, 1.0] {
            let bins = OrderBins::new(growth).unwrap();
            assert!(bins.len() <= OrderBins::MOST, "{growth}: {}", bins.len());
            let mut next = 0;
            for bin in 0..bins.len() {
                let (first, last) = bins.orders(bin);
                assert_eq!(first, next);
                assert_eq!((bins.bin(first), last.map(|last| bins.bin(last))), (bin, last.map(|_| bin)));
                match last {
                    Some(last) => next = last + 1,
                    None => assert_eq!(bin, bins.len() - 1),
                }
            }
            assert_eq!(bins.bin(u32::MAX), bins.len() - 1);
        }
    }

    #[test]
    fn bins_are_exact_at_first_and_grow_in_proportion() {
        let bins = OrderBins::new(1.0 / 128.0).unwrap();
        for order in 0..256 {
            assert_eq!(bins.orders(order), (order as u32, Some(order as u32)));
        }
        for bin in 256..bins.len() - 1 {
            let (first, Some(last)) = bins.orders(bin) else { panic!("bin {bin} has no end") };
            let width = f64::from(last - first + 1) / f64::from(first);
            assert!(width <= 1.0 / 128.0 && width > 1.0 / 128.0 - 1.0 / f64::from(first), "{first} {last}");
        }
    }

    #[test]
    fn finest_bins_fit() {
        for (cells, most) in [(300, 1 << 21), (10_800, 1 << 21), (25_000, 1 << 21)] {
            let bins = OrderBins::finest(cells, most).unwrap();
            assert!(bins.len() * cells <= most);
        }
        assert!(OrderBins::finest(300, 1 << 21).unwrap().weight_error_bound() < 4.2e-6);
        assert_eq!(OrderBins::finest(usize::MAX, usize::MAX), None);
    }

    #[test]
    fn constructors_refuse_what_makes_no_bins() {
        for growth in [0.0, -1.0, 1.1, f64::NAN, f64::INFINITY] {
            assert!(OrderBins::new(growth).is_err(), "{growth}");
        }
        for first in [vec![], vec![1], vec![0, 2, 2], vec![0, 3, 1], (0..5000).collect()] {
            assert!(OrderBins::from_first_orders(first.clone()).is_err(), "{first:?}");
        }
        let alone = OrderBins::from_first_orders([0]).unwrap();
        assert_eq!((alone.len(), alone.orders(0), alone.orders(7)), (1, (0, None), (0, None)));
    }
}
