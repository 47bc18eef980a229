//! Where on a face, and after how many collisions: the bins of a table.

use std::f64::consts::PI;
use std::ops::Range;

use translucid_profile::{ParameterError, require};

use super::edge_search::EdgeSearch;
use super::orders::OrderBins;

/// Bins over radius, azimuth and order of scattering.
///
/// *Rings.* E radii make E + 1 rings: ring i reaches from radius i − 1 to radius i, ring 0 from the center,
/// ring E to infinity. A photon at a radius exactly belongs outside it.
///
/// *Sectors.* Every ring is cut into N sectors by the angle |φ| ∈ [0, π] from the plane of incidence (φ = 0 in
/// the beam's direction, +x): sector j is |φ| ∈ (jπ/N, (j+1)π/N], the first with φ = 0, both mirror images
/// together: an Nth of the ring's area. Nothing that a [`Problem`](super::Problem) can be tells y from −y, so to keep the two apart
/// would only make noise.
///
/// *Orders.* See [`OrderBins`]; the same in every sector.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    radii: Vec<f64>,
    sectors: u32,
    order_bins: OrderBins,
    /// Over r².
    ring_search: EdgeSearch,
    /// Cosine and sine of the angles between sectors.
    sector_bounds: Vec<(f64, f64)>,
}

/// A part of a face of the medium. Indices past the last of the layout are no error: a radius past the last is
/// infinite, a ring or sector past the last is empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Region {
    /// The whole face.
    Everywhere,
    /// The disc inside a radius of the layout, given by its index.
    Within(usize),
    /// The surface outside a radius of the layout, given by its index.
    Beyond(usize),
    /// A ring.
    Ring(usize),
    /// A sector of a ring.
    Sector {
        /// Index of the ring.
        ring: usize,
        /// Index of the sector.
        sector: usize,
    },
}

impl Layout {
    /// Most entries (rings × sectors × order bins) of a layout: 32 MiB a face.
    pub const MOST_ENTRIES: usize = 1 << 21;
    /// Most sectors of a ring.
    pub const MOST_SECTORS: u32 = 720;
    /// Smallest and largest radius: their squares are far inside the range of single precision.
    const RADII: std::ops::RangeInclusive<f64> = 1e-15..=1e15;
    /// Radii closer than this, relative to themselves, are taken for one by [`Layout::around`].
    const SAME: f64 = 1e-9;

    /// Rings between the given radii, with the finest order bins that fit in [`Layout::MOST_ENTRIES`]: up to
    /// 1200 rings × sectors of order 256 and below are on their own, and higher ones share bins less than 0.8 %
    /// wide; with more the bins are wider, up to 25 %.
    ///
    /// # Errors
    /// A radius is not in [1e-15, 1e15] or not greater than the one before, sectors are not in [1, 720], or there
    /// are too many of both.
    pub fn new(radii: &[f64], sectors: u32) -> Result<Self, ParameterError> {
        check_radii(radii)?;
        let cells = (radii.len() + 1).saturating_mul(sectors as usize);
        let allowed = "fewer: with their order bins at most 2097152";
        let too_many = || ParameterError::new("rings × sectors", cells as f64, allowed);
        let order_bins = OrderBins::finest(cells, Self::MOST_ENTRIES).ok_or_else(too_many)?;
        Self::with_order_bins(radii, sectors, order_bins)
    }

    /// Makes a layout as [`Layout::new`] does, with the given order bins.
    ///
    /// # Errors
    /// As for [`Layout::new`].
    pub fn with_order_bins(
        radii: &[f64],
        sectors: u32,
        order_bins: OrderBins,
    ) -> Result<Self, ParameterError> {
        check_radii(radii)?;
        require((1..=Self::MOST_SECTORS).contains(&sectors), "sectors", sectors.into(), "in [1, 720]")?;
        let cells = (radii.len() + 1).saturating_mul(sectors as usize);
        let entries = cells.saturating_mul(order_bins.len());
        let fits = entries <= Self::MOST_ENTRIES;
        require(fits, "rings × sectors × order bins", entries as f64, "at most 2097152")?;
        let ring_search = EdgeSearch::new(radii.iter().map(|r| r * r).collect());
        let angle = |bound: u32| PI * f64::from(bound) / f64::from(sectors);
        let sector_bounds =
            (1..sectors).map(|bound| (libm::cos(angle(bound)), libm::sin(angle(bound)))).collect();
        Ok(Self { radii: radii.to_vec(), sectors, order_bins, ring_search, sector_bounds })
    }

    /// Two narrow rings at each of the given radii, inside and outside, for
    /// [`AtAlbedo::at_radius`](super::AtAlbedo::at_radius); their order does not matter, nor do repetitions.
    ///
    /// The rings at r are Δ = min(r/50, 0.05 ℓ) wide, a third of the distance to the next radius where that is
    /// less. The mean exitance over both is R(r), up to noise: exactly so for R ∝ 1/r, the behavior close to the
    /// center, and (kΔ)²/6 of R(r) more for R ∝ e^(−kr)/r, at most 4e-4 for k = 1/ℓ. In a half space of isotropic
    /// scatterers it is 3e-4 r/ℓ at most up to 1 ℓ, and 1e-3 beyond: 9e-4 near 3 ℓ for α = 0.1, 2.2e-4 for 0.9,
    /// 1.1e-4 for 0.99.
    ///
    /// # Errors
    /// As for [`Layout::new`].
    pub fn around(radii: &[f64]) -> Result<Self, ParameterError> {
        Self::around_in_sectors(radii, 1)
    }

    /// Makes a layout as [`Layout::around`] does, with the rings cut into sectors, for
    /// [`AtAlbedo::at_radius_and_azimuth`](super::AtAlbedo::at_radius_and_azimuth).
    ///
    /// # Errors
    /// As for [`Layout::new`].
    pub fn around_in_sectors(radii: &[f64], sectors: u32) -> Result<Self, ParameterError> {
        let mut radii = radii.to_vec();
        radii.sort_by(f64::total_cmp);
        radii.dedup_by(|next, kept| *next - *kept <= Self::SAME * *kept);
        check_radii(&radii)?;
        let gap = |index: usize| match (radii.get(index), radii.get(index + 1)) {
            (Some(this), Some(next)) => next - this,
            _ => f64::INFINITY,
        };
        let mut edges = Vec::with_capacity(3 * radii.len());
        for (index, &r) in radii.iter().enumerate() {
            let nearest = gap(index).min(index.checked_sub(1).map_or(f64::INFINITY, gap));
            let width = (0.02 * r).min(0.05).min(nearest / 3.0);
            edges.extend([r - width, r, r + width]);
        }
        Self::new(&edges, sectors)
    }

    /// Radii between rings, in mean free paths.
    pub fn radii(&self) -> &[f64] {
        &self.radii
    }

    /// Number of rings: one more than radii.
    pub fn rings(&self) -> usize {
        self.radii.len() + 1
    }

    /// Number of sectors of a ring.
    pub fn sectors(&self) -> usize {
        self.sectors as usize
    }

    /// Bins of the order of scattering.
    pub fn order_bins(&self) -> &OrderBins {
        &self.order_bins
    }

    /// Area of a region, in square mean free paths; infinite where the region is, 0 for what is past the last.
    pub fn area(&self, region: Region) -> f64 {
        let (places, sectors) = (self.places(region), self.sectors());
        if places.is_empty() {
            return 0.0;
        }
        let disc = |rings: usize| match rings.checked_sub(1) {
            None => 0.0,
            Some(edge) => self.radii.get(edge).map_or(f64::INFINITY, |r| PI * r * r),
        };
        let (first, end) = (places.start / sectors, places.end.div_ceil(sectors));
        (disc(end) - disc(first)) * places.len() as f64 / ((end - first) * sectors) as f64
    }

    /// Number of places on a face: rings × sectors.
    pub(crate) fn place_count(&self) -> usize {
        self.rings() * self.sectors()
    }

    /// Entries of one face.
    pub(crate) fn entries(&self) -> usize {
        self.place_count() * self.order_bins.len()
    }

    /// The place, ring × sectors + sector, of a point of a face.
    pub(crate) fn place(&self, x: f32, y: f32) -> usize {
        // Squares of single precision are exact in double precision: r² has one rounding.
        let (x, y) = (f64::from(x), f64::from(y));
        let ring = self.ring_search.count_up_to(x * x + y * y);
        if self.sectors == 1 {
            return ring;
        }
        let sector = self.sector_bounds.partition_point(|(cos, sin)| cos * y.abs() > sin * x);
        ring * self.sectors() + sector
    }

    /// The sector of a direction, an angle from the plane of incidence [rad].
    pub(crate) fn sector(&self, azimuth: f64) -> usize {
        let (sin, cos) = libm::sincos(azimuth);
        self.sector_bounds.partition_point(|(bound_cos, bound_sin)| bound_cos * sin.abs() > bound_sin * cos)
    }

    /// The places of a region: there are no gaps between them.
    pub(crate) fn places(&self, region: Region) -> Range<usize> {
        let (rings, sectors) = (self.rings(), self.sectors());
        let edge_end = |edge: usize| edge.saturating_add(1).min(rings) * sectors;
        match region {
            Region::Everywhere => 0..rings * sectors,
            Region::Within(edge) => 0..edge_end(edge),
            Region::Beyond(edge) => edge_end(edge)..rings * sectors,
            Region::Ring(ring) => ring.min(rings) * sectors..edge_end(ring),
            Region::Sector { ring, sector } if ring < rings && sector < sectors => {
                let place = ring * sectors + sector;
                place..place + 1
            }
            Region::Sector { .. } => 0..0,
        }
    }

    /// Index of a radius that has rings of equal width on both sides.
    pub(crate) fn center(&self, r: f64) -> Option<usize> {
        let after = self.radii.partition_point(|&edge| edge < r);
        let distance = |index: usize| self.radii.get(index).map_or(f64::INFINITY, |edge| (edge - r).abs());
        let nearest = if after > 0 && distance(after - 1) < distance(after) { after - 1 } else { after };
        let [before, here, next] = *self.radii.get(nearest.checked_sub(1)?..)?.first_chunk()?;
        let (inner, outer) = (here - before, next - here);
        let is_here = (here - r).abs() <= Self::SAME * r;
        // Edges are rounded to 1e-16 of the radius, and can be as close as 1e-9 / 3 of it.
        (is_here && (inner - outer).abs() <= 1e-3 * inner).then_some(nearest)
    }
}

/// Refuses radii out of range or out of order.
pub(super) fn check_radii(radii: &[f64]) -> Result<(), ParameterError> {
    for &radius in radii {
        require(Layout::RADII.contains(&radius), "radius", radius, "in [1e-15, 1e15]")?;
    }
    for pair in radii.windows(2) {
        require(pair[0] < pair[1], "radius", pair[1], "greater than the radius before it")?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn place_is_where_radius_and_angle_say() {
        let layout = Layout::new(&[0.5, 1.0, 2.0], 4).unwrap();
        for ring in 0..4 {
            let r = [0.3f32, 0.7, 1.5, 5.0][ring];
            for degrees in (-175i32..=180).step_by(10) {
                let (sin, cos) = (degrees as f32).to_radians().sin_cos();
                let sector = (degrees.unsigned_abs() / 45) as usize;
                assert_eq!(layout.place(r * cos, r * sin), 4 * ring + sector.min(3), "{r} {degrees}");
            }
        }
    }

    #[test]
    fn place_of_edges_is_outside_them() {
        let layout = Layout::new(&[0.5, 1.0], 3).unwrap();
        assert_eq!(layout.place(0.0, 0.0), 0);
        assert_eq!(layout.place(0.5, 0.0), 3);
        assert_eq!(layout.place(0.5f32.next_down(), 0.0), 0);
        assert_eq!(layout.place(-1.0, 0.0), 6 + 2);
        assert_eq!(layout.place(f32::MAX, f32::MAX), 6);
        assert!(layout.place(f32::NAN, f32::NAN) < layout.place_count());
        assert!(layout.place(f32::INFINITY, f32::NEG_INFINITY) < layout.place_count());
        let whole = Layout::new(&[], 1).unwrap();
        assert_eq!((whole.place(3.0, 4.0), whole.rings()), (0, 1));
    }

    #[test]
    fn regions_cover_the_face() {
        let layout = Layout::new(&[0.5, 1.0, 2.0], 5).unwrap();
        for edge in 0..5 {
            let (within, beyond) = (layout.places(Region::Within(edge)), layout.places(Region::Beyond(edge)));
            assert_eq!((within.start, within.end, beyond.end), (0, beyond.start, 20));
        }
        for ring in 0..4 {
            let places = layout.places(Region::Ring(ring));
            for sector in 0..5 {
                let place = places.start + sector;
                assert_eq!(layout.places(Region::Sector { ring, sector }), place..place + 1);
            }
            assert_eq!(places.len(), 5);
        }
        for empty in [
            Region::Ring(4),
            Region::Ring(usize::MAX),
            Region::Beyond(usize::MAX),
            Region::Sector { ring: 4, sector: 0 },
            Region::Sector { ring: 0, sector: 5 },
        ] {
            assert!(layout.places(empty).is_empty(), "{empty:?}");
            assert_eq!(layout.area(empty), 0.0, "{empty:?}");
        }
    }

    #[test]
    fn areas_add_up() {
        let layout = Layout::new(&[0.5, 1.0, 2.0], 5).unwrap();
        assert_eq!(layout.area(Region::Within(1)), PI);
        assert_eq!(layout.area(Region::Ring(2)), 3.0 * PI);
        assert_eq!(layout.area(Region::Sector { ring: 2, sector: 4 }), 3.0 * PI / 5.0);
        for region in [Region::Everywhere, Region::Ring(3), Region::Beyond(0), Region::Within(3)] {
            assert_eq!(layout.area(region), f64::INFINITY, "{region:?}");
        }
        assert_eq!(Layout::new(&[], 1).unwrap().area(Region::Everywhere), f64::INFINITY);
    }

    #[test]
    fn around_takes_radii_as_they_come() {
        let layout = Layout::around(&[3.0, 1.0, 3.0, 0.01, 1.003]).unwrap();
        assert_eq!(layout.radii().len(), 12);
        for r in [0.01, 1.0, 1.003, 3.0] {
            let index = layout.center(r).unwrap();
            assert_eq!(layout.radii()[index], r);
            let width = r - layout.radii()[index - 1];
            let allowed: f64 = if (r - 1.0).abs() < 0.1 { 0.001 } else { (0.02 * r).min(0.05) };
            assert!((width / allowed - 1.0).abs() < 1e-9, "{r}: {width}");
            assert!(((layout.radii()[index + 1] - r) / width - 1.0).abs() < 1e-9);
        }
        for r in [0.0, 0.02, 2.0, 1.02, -1.0, f64::NAN, f64::INFINITY, layout.radii()[0], layout.radii()[11]]
        {
            assert_eq!(layout.center(r), None, "{r}");
        }
    }

    #[test]
    fn around_bears_radii_that_almost_agree() {
        for factor in [1.0, 1.0 + 1e-15, 1.0 + 1e-12, 1.0 + 1.1e-9, 1.0 + 1e-6] {
            let radii = [2.0, 2.0 * factor, 2.0 * factor * factor];
            let layout = Layout::around(&radii).unwrap();
            for r in radii {
                let index = layout.center(r).unwrap_or_else(|| panic!("{factor} {r} {:?}", layout.radii()));
                assert!((layout.radii()[index] / r - 1.0).abs() <= 1e-9);
            }
        }
        assert_eq!(Layout::around(&[]).unwrap().rings(), 1);
    }

    #[test]
    fn constructors_refuse_bad_bins() {
        for radii in [[0.0, 1.0], [1.0, 1.0], [2.0, 1.0], [1.0, f64::INFINITY], [f64::NAN, 1.0], [-1.0, 1.0]]
        {
            let error = Layout::new(&radii, 1).unwrap_err();
            assert_eq!(error.parameter, "radius", "{radii:?}: {error}");
            let sorted_and_joined = radii == [1.0, 1.0] || radii == [2.0, 1.0];
            assert_eq!(Layout::around(&radii).is_ok(), sorted_and_joined, "{radii:?}");
        }
        for sectors in [0, 721, u32::MAX] {
            assert!(Layout::new(&[1.0], sectors).is_err(), "{sectors}");
        }
        let many: Vec<f64> = (1..200_000).map(f64::from).collect();
        let error = Layout::new(&many, 1).unwrap_err();
        assert!(error.to_string().contains("at most 2097152"), "{error}");
        assert!(Layout::with_order_bins(&many[..2000], 1, OrderBins::new(1.0 / 128.0).unwrap()).is_err());
    }
}
