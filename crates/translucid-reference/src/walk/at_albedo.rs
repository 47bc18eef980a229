//! A white table at one albedo.

use translucid_profile::{ParameterError, TabulatedProfile, require};

use super::layout::Region;
use super::photon_exit::Side;
use super::weights::{Weighed, Weights};
use super::white_table::WhiteTable;
use crate::Estimate;

/// Effective photons that a ring needs to have a say in a profile.
const PHOTONS_OF_A_RING: f64 = 100.0;

/// A [`WhiteTable`] as seen at one single-scattering albedo α.
///
/// All figures are per unit of flux that entered the medium, with β = α/α_ref, N photons, and sums over the
/// photons that left in a region:
///
/// ```text
/// energy          Ê = Σ βⁿ / N
/// standard error  √[(Σ β²ⁿ/N − Ê²) / (N−1)]
/// derivative      dÊ/dα = Σ n βⁿ / (α N)
/// ```
///
/// Sums over rings have their own second moments: the rings' errors are not independent.
///
/// # Meaning of the standard error
/// It is estimated from the same photons, and of few photons it knows little. Where n photons of equal weight are to
/// be expected, ±1.96 errors hold the truth in 95 % of cases for n above 300, in 92 % or more for n above 16, in 86 %
/// for n from 5, in 79 % for n from 3. [`effective_photons`](Self::effective_photons) says how many there are; where
/// weights differ much, as at an albedo far below the reference, a photon heavier than any seen may come yet.
///
/// A region where no photon left has the energy 0 with the error of one photon of the greatest weight there is. If the
/// energy were that large, the region would be empty in 37 % of runs; it is less than three times that with a
/// confidence of 95 %. Without photons, or with a single one, the error is infinite.
#[derive(Debug)]
pub struct AtAlbedo<'a> {
    table: &'a WhiteTable,
    single_scattering_albedo: f64,
    /// Sums by face and place.
    places: Vec<Weighed>,
}

/// Figures of a table at one radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtRadius {
    /// Exitance R(r) [ℓ⁻²], as the mean over the two rings at r; see
    /// [`Layout::around`](super::Layout::around) for how far that is from the value at r.
    pub reflectance: Estimate,
    /// Energy that leaves within r.
    pub enclosed: Estimate,
}

impl WhiteTable {
    /// Figures of the table at one albedo, per unit of flux that entered.
    ///
    /// # Errors
    /// The albedo is not in [0, reference albedo].
    pub fn at_albedo(&self, single_scattering_albedo: f64) -> Result<AtAlbedo<'_>, ParameterError> {
        let value = single_scattering_albedo;
        let allowed = "at least 0 and at most the table's reference albedo";
        let is_allowed = (0.0..=self.reference_albedo()).contains(&value);
        require(is_allowed, "single_scattering_albedo", value, allowed)?;
        Ok(AtAlbedo::new(self, value))
    }
}

impl<'a> AtAlbedo<'a> {
    /// Weighs the table's photons for α in [0, reference albedo].
    fn new(table: &'a WhiteTable, single_scattering_albedo: f64) -> Self {
        let bins = table.layout().order_bins();
        let weights = Weights::new(bins, single_scattering_albedo, table.reference_albedo());
        let faces = [Side::Reflected, Side::Transmitted].map(|side| table.cells(side, Region::Everywhere));
        let places = faces.iter().flat_map(|face| face.chunks_exact(bins.len()));
        let places = places.map(|cells| table.weigh(&weights, cells)).collect();
        Self { table, single_scattering_albedo, places }
    }

    /// Single-scattering albedo α.
    pub fn single_scattering_albedo(&self) -> f64 {
        self.single_scattering_albedo
    }

    /// Energy that leaves through a region.
    pub fn energy(&self, side: Side, region: Region) -> Estimate {
        self.sum(side, region).map_or(Estimate::ZERO, |sum| self.mean(sum))
    }

    /// Energy that leaves through a face; through the one of entry it is the surface albedo A.
    pub fn total(&self, side: Side) -> Estimate {
        self.energy(side, Region::Everywhere)
    }

    /// Energy that leaves within a radius of the layout, given by its index.
    pub fn enclosed(&self, side: Side, radius: usize) -> Estimate {
        self.energy(side, Region::Within(radius))
    }

    /// Energy that leaves through a ring.
    pub fn ring(&self, side: Side, ring: usize) -> Estimate {
        self.energy(side, Region::Ring(ring))
    }

    /// Mean exitance over a region [ℓ⁻²]: its energy by its area. 0 for regions of infinite area.
    pub fn reflectance(&self, side: Side, region: Region) -> Estimate {
        let area = self.table.layout().area(region);
        if area == 0.0 {
            return Estimate::ZERO;
        }
        let Estimate { value, error } = self.energy(side, region);
        Estimate { value: value / area, error: if error.is_finite() { error / area } else { error } }
    }

    /// Exitance at, and energy within, one of the radii of [`Layout::around`](super::Layout::around).
    ///
    /// # Errors
    /// The layout does not have rings of equal width on both sides of this radius.
    pub fn at_radius(&self, side: Side, radius: f64) -> Result<AtRadius, ParameterError> {
        self.around_radius(side, radius, Region::Ring)
    }

    /// Figures at a radius as [`at_radius`](Self::at_radius) gives them, the exitance being the mean over the sector in which the azimuth lies:
    /// an angle from the direction towards which the beam is tilted, in radians.
    ///
    /// # Errors
    /// As for [`at_radius`](Self::at_radius).
    pub fn at_radius_and_azimuth(
        &self,
        side: Side,
        radius: f64,
        azimuth: f64,
    ) -> Result<AtRadius, ParameterError> {
        let sector = self.table.layout().sector(azimuth);
        self.around_radius(side, radius, |ring| Region::Sector { ring, sector })
    }

    fn around_radius(
        &self,
        side: Side,
        radius: f64,
        region: impl Fn(usize) -> Region,
    ) -> Result<AtRadius, ParameterError> {
        let Some(edge) = self.table.layout().center(radius) else {
            let allowed = "one around which the table has a ring on both sides";
            return Err(ParameterError::new("radius", radius, allowed));
        };
        let regions = [edge, edge + 1].map(region);
        let both = regions.iter().filter_map(|&region| self.sum(side, region)).sum();
        let energy =
            if self.sum(side, Region::Everywhere).is_some() { self.mean(both) } else { Estimate::ZERO };
        let area: f64 = regions.iter().map(|&region| self.table.layout().area(region)).sum();
        let reflectance = Estimate { value: energy.value / area, error: energy.error / area };
        Ok(AtRadius { reflectance, enclosed: self.enclosed(side, edge) })
    }

    /// The profile to evaluate and to sample, in mean free paths: the energies within the layout's radii are kept, as far
    /// out as rings have 100 [effective photons](Self::effective_photons); behind them it falls exponentially.
    ///
    /// Choose rings that are filled well: their noise is the profile's.
    ///
    /// # Errors
    /// There are fewer than four such rings, or R does not fall towards the last of them.
    pub fn profile(&self, side: Side) -> Result<TabulatedProfile, ParameterError> {
        let radii = self.table.layout().radii();
        let sparse = |&ring: &usize| self.effective_photons(side, Region::Ring(ring)) < PHOTONS_OF_A_RING;
        let count = radii.len() - (0..radii.len()).rev().take_while(sparse).count();
        let enclosed: Vec<f64> = (0..count).map(|radius| self.enclosed(side, radius).value).collect();
        TabulatedProfile::from_enclosed(&radii[..count], &enclosed)?.scaled(1.0, self.total(side).value)
    }

    /// Energy that is absorbed: what does not leave.
    pub fn absorbed(&self) -> Estimate {
        let Estimate { value, error } = self.mean(self.places.iter().copied().sum());
        Estimate { value: 1.0 - value, error }
    }

    /// Derivative of the energy with respect to α; infinitely uncertain where no photon left.
    pub fn derivative(&self, side: Side, region: Region) -> Estimate {
        let Some(sum) = self.sum(side, region) else { return Estimate::ZERO };
        let slope = Weighed { first: sum.slope, second: sum.slope_second, ..sum };
        slope.mean(self.table.photons(), f64::INFINITY)
    }

    /// Number of photons of equal weight that would have the same relative error, (Σβⁿ)²/Σβ²ⁿ.
    pub fn effective_photons(&self, side: Side, region: Region) -> f64 {
        let sum = self.sum(side, region).unwrap_or_default();
        if sum.second > 0.0 { sum.first * sum.first / sum.second } else { 0.0 }
    }

    /// Greatest distance of the energy from that of the same photons with every order on its own.
    ///
    /// A rigorous limit by convexity (see [`OrderBins`](super::OrderBins)): the true sum is no farther, however
    /// unfavorably orders are spread in their bins. The actual difference is smaller by far.
    pub fn grouping_error(&self, side: Side, region: Region) -> f64 {
        let uncertainty = self.sum(side, region).unwrap_or_default().uncertainty;
        if uncertainty == 0.0 { 0.0 } else { uncertainty / self.table.photons() as f64 }
    }

    /// Sum over a region; none where there is no such place.
    fn sum(&self, side: Side, region: Region) -> Option<Weighed> {
        let layout = self.table.layout();
        let (start, places) = (side as usize * layout.place_count(), layout.places(region));
        let places = self.places.get(start + places.start..start + places.end)?;
        (!places.is_empty()).then(|| places.iter().copied().sum())
    }

    fn mean(&self, sum: Weighed) -> Estimate {
        sum.mean(self.table.photons(), self.table.greatest_weight(self.single_scattering_albedo))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Control, Layout, OrderBins, Parameters, Problem};
    use super::*;
    use crate::Incidence;

    fn table(parameters: Parameters, layout: Layout, reference_albedo: f64, photons: u64) -> WhiteTable {
        let mut table = WhiteTable::new(Problem::new(parameters).unwrap(), layout, reference_albedo).unwrap();
        table.run(1, photons, &Control::default()).unwrap();
        table
    }

    fn half_space(radii: &[f64], sectors: u32, photons: u64) -> WhiteTable {
        table(Parameters::default(), Layout::new(radii, sectors).unwrap(), 0.999, photons)
    }

    fn slab(photons: u64) -> WhiteTable {
        let slab = Parameters { thickness: 1.0, eta: 1.4, ..Parameters::default() };
        table(slab, Layout::new(&[1.0], 1).unwrap(), 0.999, photons)
    }

    #[test]
    fn energies_and_second_moments_add_up() {
        let table = half_space(&[0.2, 1.0, 5.0], 4, 20_000);
        let at = table.at_albedo(0.9).unwrap();
        let side = Side::Reflected;
        // N(N−1)σ² + (Σw)²/N = Σw², which is additive
        let n = 20_000.0;
        let second = |e: Estimate| e.error * e.error * (n - 1.0) + e.value * e.value;
        for edge in 0..3 {
            let rings: Vec<_> = (0..=edge).map(|ring| at.ring(side, ring)).collect();
            let enclosed = at.enclosed(side, edge);
            let value: f64 = rings.iter().map(|e| e.value).sum();
            assert!((enclosed.value - value).abs() < 1e-14);
            let squares: f64 = rings.iter().map(|&e| second(e)).sum();
            assert!((second(enclosed) / squares - 1.0).abs() < 1e-12);
            let beyond = at.energy(side, Region::Beyond(edge));
            assert!((enclosed.value + beyond.value - at.total(side).value).abs() < 1e-14);
        }
        for ring in 0..4 {
            let sectors = (0..4).map(|sector| at.energy(side, Region::Sector { ring, sector }).value);
            assert!((sectors.sum::<f64>() - at.ring(side, ring).value).abs() < 1e-14);
        }
        let absorbed = at.absorbed();
        assert!((absorbed.value + at.total(side).value - 1.0).abs() < 1e-14);
        assert_eq!(absorbed.error, at.total(side).error);
        let area = std::f64::consts::PI * (25.0 - 1.0);
        assert_eq!(at.reflectance(side, Region::Ring(2)).value, at.ring(side, 2).value / area);
    }

    #[test]
    fn sectors_around_a_radius_share_its_light() {
        let tilted = Parameters { incidence: Incidence::Pencil { cos_theta: 0.5 }, ..Parameters::default() };
        let layout = Layout::around_in_sectors(&[0.5, 2.0], 6).unwrap();
        let table = table(tilted, layout, 0.9, 100_000);
        let at = table.at_albedo(0.9).unwrap();
        for radius in [0.5, 2.0] {
            let ring = at.at_radius(Side::Reflected, radius).unwrap();
            let sectors: Vec<AtRadius> = (0..6)
                .map(|i| (f64::from(i) + 0.5) * std::f64::consts::FRAC_PI_6)
                .map(|azimuth| at.at_radius_and_azimuth(Side::Reflected, radius, azimuth).unwrap())
                .collect();
            let mean = sectors.iter().map(|sector| sector.reflectance.value).sum::<f64>() / 6.0;
            assert!((mean / ring.reflectance.value - 1.0).abs() < 1e-12, "{radius}: {mean} {ring:?}");
            // More comes out ahead of the beam than behind it
            assert!(sectors[0].reflectance.value > 2.0 * sectors[5].reflectance.value, "{sectors:?}");
            assert!(sectors.iter().all(|sector| sector.enclosed == ring.enclosed));
            for turned in [0.3, -0.3, 0.3 + std::f64::consts::TAU] {
                assert_eq!(at.at_radius_and_azimuth(Side::Reflected, radius, turned).unwrap(), sectors[0]);
            }
        }
    }

    #[test]
    fn slab_shares_its_light() {
        let table = slab(20_000);
        for alpha in [0.0, 0.5, 0.999] {
            let at = table.at_albedo(alpha).unwrap();
            let sum =
                at.total(Side::Reflected).value + at.total(Side::Transmitted).value + at.absorbed().value;
            assert!((sum - 1.0).abs() < 1e-14, "{alpha}");
        }
        // Without scattering e^{−1} gets to the far face, T = 1 − 0.04/1.44… of it through; reflected light
        // crosses back and may leave. |z| < 4.5, false alarm 7e-6 each.
        let at = table.at_albedo(0.0).unwrap();
        let (r, through) = ((0.4f64 / 2.4).powi(2), (-1.0f64).exp());
        let rounds = 1.0 - (r * through).powi(2);
        let expected = [(1.0 - r) * r * through * through / rounds, (1.0 - r) * through / rounds];
        for (side, expected) in [Side::Reflected, Side::Transmitted].into_iter().zip(expected) {
            let found = at.total(side);
            assert!((found.value - expected).abs() < 4.5 * found.error, "{side:?} {found:?} {expected}");
        }
    }

    #[test]
    fn derivative_is_the_slope() {
        let table = half_space(&[1.0], 1, 20_000);
        for region in [Region::Everywhere, Region::Ring(0), Region::Beyond(0)] {
            for alpha in [0.1, 0.9, 0.998] {
                let step = 1e-5 * (1.0 - alpha);
                let value = |alpha| table.at_albedo(alpha).unwrap().energy(Side::Reflected, region).value;
                let slope = (value(alpha + step) - value(alpha - step)) / (2.0 * step);
                let found = table.at_albedo(alpha).unwrap().derivative(Side::Reflected, region);
                assert!((found.value / slope - 1.0).abs() < 1e-6, "{region:?} {alpha}: {found:?} {slope}");
            }
        }
        // At α = 0 it is the probability of one collision.
        let found = table.at_albedo(0.0).unwrap().derivative(Side::Reflected, Region::Everywhere);
        let order = table.order_probability(Side::Reflected, Region::Everywhere, 1);
        assert!((found.value - order.value).abs() < 1e-15, "{found:?} {order:?}");
        assert!((found.error / order.error - 1.0).abs() < 1e-12, "{found:?} {order:?}");
    }

    #[test]
    fn table_answers_up_to_its_albedo() {
        let table = half_space(&[1.0], 1, 10);
        for alpha in [-0.1, 0.9991, 1.0, f64::NAN, f64::INFINITY] {
            assert!(table.at_albedo(alpha).is_err(), "{alpha}");
        }
        for alpha in [0.0, 5e-324, 0.999] {
            assert_eq!(table.at_albedo(alpha).unwrap().single_scattering_albedo(), alpha);
        }
    }

    #[test]
    fn what_was_not_seen_may_yet_be() {
        let far = half_space(&[1.0, 1e6], 1, 1000);
        let at = far.at_albedo(0.5).unwrap();
        let one = 0.5 / 0.999 / 1000.0;
        assert_eq!(at.ring(Side::Reflected, 2), Estimate { value: 0.0, error: one });
        assert_eq!(at.derivative(Side::Reflected, Region::Ring(2)).error, f64::INFINITY);
        // What cannot be is known.
        assert_eq!(at.total(Side::Transmitted), Estimate::ZERO);
        assert_eq!(at.ring(Side::Reflected, 3), Estimate::ZERO);
        assert_eq!(at.reflectance(Side::Reflected, Region::Ring(9)), Estimate::ZERO);
        assert_eq!(far.at_albedo(0.0).unwrap().total(Side::Reflected), Estimate::ZERO);
        // A slab may let light through without a collision.
        let at = slab(2);
        assert!(at.at_albedo(0.0).unwrap().total(Side::Reflected).error > 0.0);
    }

    #[test]
    fn no_photons_no_knowledge() {
        let empty = half_space(&[1.0], 1, 0);
        for alpha in [0.0, 0.5] {
            let at = empty.at_albedo(alpha).unwrap();
            let nothing = Estimate { value: 0.0, error: f64::INFINITY };
            for region in [Region::Everywhere, Region::Within(0), Region::Ring(1), Region::Within(7)] {
                assert_eq!(at.energy(Side::Reflected, region), nothing, "{region:?}");
                assert_eq!(at.derivative(Side::Reflected, region), nothing, "{region:?}");
                assert_eq!(at.reflectance(Side::Reflected, region), nothing, "{region:?}");
                assert_eq!(at.grouping_error(Side::Reflected, region), 0.0);
                assert_eq!(at.effective_photons(Side::Reflected, region), 0.0);
            }
            assert_eq!(at.absorbed().error, f64::INFINITY);
        }
        assert!(empty.single_scattering_albedo(0.5).is_err());
        assert_eq!(empty.mean_collisions(), 0.0);
        assert_eq!(half_space(&[1.0], 1, 1).at_albedo(0.5).unwrap().absorbed().error, f64::INFINITY);
    }

    /// Where a table with every order on its own and one with wide bins see the same photons, they differ by
    /// less than the second one says.
    #[test]
    fn grouping_error_is_not_exceeded() {
        let exact = OrderBins::from_first_orders(0..4000).unwrap();
        let radii = [0.3, 1.0, 3.0, 10.0];
        let make = |bins| {
            let layout = Layout::with_order_bins(&radii, 1, bins).unwrap();
            table(Parameters::default(), layout, 0.99, 100_000)
        };
        let (fine, finest, coarse) =
            (make(OrderBins::new(1.0 / 128.0).unwrap()), make(exact), make(OrderBins::new(0.25).unwrap()));
        assert_eq!(finest.at_albedo(0.9).unwrap().grouping_error(Side::Reflected, Region::Everywhere), 0.0);
        for alpha in [0.3, 0.9, 0.97, 0.985, 0.9899, 0.99] {
            let [fine, finest, coarse] =
                [&fine, &finest, &coarse].map(|table| table.at_albedo(alpha).unwrap());
            for region in (0..5).map(Region::Ring).chain([Region::Everywhere]) {
                let expected = finest.energy(Side::Reflected, region).value;
                for (at, relative) in [(&fine, 1e-4), (&coarse, 0.05)] {
                    let found = at.energy(Side::Reflected, region).value;
                    let limit = at.grouping_error(Side::Reflected, region);
                    assert!(
                        (found - expected).abs() <= limit + 1e-14,
                        "{alpha} {region:?} {found} {expected}"
                    );
                    assert!(limit <= relative * expected, "{alpha} {region:?}: {limit} of {expected}");
                }
            }
        }
    }

    #[test]
    fn radius_is_seen_through_its_rings() {
        let layout = Layout::around(&[1.0, 3.0]).unwrap();
        let table = table(Parameters::default(), layout, 0.99, 20_000);
        let at = table.at_albedo(0.9).unwrap();
        let found = at.at_radius(Side::Reflected, 3.0).unwrap();
        let [inner, outer] = [3, 5].map(|edge| at.enclosed(Side::Reflected, edge).value);
        let area = std::f64::consts::PI * (3.05f64.powi(2) - 2.95f64.powi(2));
        assert!((found.reflectance.value * area - (outer - inner)).abs() < 1e-14);
        assert_eq!(found.enclosed, at.enclosed(Side::Reflected, 4));
        let error = at.at_radius(Side::Reflected, 2.0).unwrap_err();
        assert!(error.to_string().starts_with("radius is 2, but must be one around which"), "{error}");
        assert_eq!(at.at_radius(Side::Transmitted, 3.0).unwrap().reflectance, Estimate::ZERO);
    }
}
