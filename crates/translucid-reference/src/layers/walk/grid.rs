//! Cells in which a walk counts light.

use std::ops::Range;

use translucid_profile::{ParameterError, require};

/// Rings, depths and angles in which a walk counts light, as MCML does.
///
/// The last ring and the last depth also take what is beyond them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Depth of a cell \[L\].
    pub dz: f64,
    /// Width of a ring \[L\].
    pub dr: f64,
    /// Number of cells in depth.
    pub nz: usize,
    /// Number of rings.
    pub nr: usize,
    /// Number of angles, of equal width between 0 and 90 degrees from the normal.
    pub na: usize,
}

impl Grid {
    /// Totals alone.
    pub const TOTALS: Self = Self { dz: 1.0, dr: 1.0, nz: 1, nr: 1, na: 1 };
    /// Most cells: nr (nz + 2 na).
    pub const MOST_CELLS: usize = 4_000_000;

    /// Checks the grid.
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        for (name, value) in [("dz", self.dz), ("dr", self.dr)] {
            require((1e-100..=1e100).contains(&value), name, value, "in [1e-100, 1e100]")?;
        }
        for (name, count) in [("nz", self.nz), ("nr", self.nr), ("na", self.na)] {
            require(count > 0, name, count as f64, "at least 1")?;
        }
        let cells = self.nr as f64 * (self.nz as f64 + 2.0 * self.na as f64);
        require(cells <= Self::MOST_CELLS as f64, "nr (nz + 2 na)", cells, "at most 4000000").map(|_| ())
    }

    /// Returns whether absorbed light is told apart by place.
    pub(super) fn has_map(&self) -> bool {
        self.nr * self.nz > 1
    }

    /// Center of a ring \[L\].
    pub fn radius(&self, ring: usize) -> f64 {
        (ring as f64 + 0.5) * self.dr
    }

    /// Area of a ring \[L²\].
    pub fn ring_area(&self, ring: usize) -> f64 {
        std::f64::consts::TAU * self.radius(ring) * self.dr
    }
}

/// Light that a walk counts, each as a part of the light that arrives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Reflected after entering: all light that comes out on top, but for the specular part.
    #[doc(alias = "Rd")]
    Reflected,
    /// Transmitted, also without a collision.
    #[doc(alias = "Tt")]
    Transmitted,
    /// Absorbed in the layers.
    #[doc(alias = "A")]
    Absorbed,
    /// Absorbed by a Lambertian ground.
    Ground,
    /// Still under way after 2²⁴ collisions, where it is given up; 0 but in media without absorption.
    Lost,
    /// Absorbed by each layer.
    #[doc(alias = "A_l")]
    AbsorbedByLayer,
    /// Absorbed in each depth.
    #[doc(alias = "A_z")]
    AbsorbedByDepth,
    /// Reflected in each ring.
    #[doc(alias = "Rd_r")]
    ReflectedByRing,
    /// Reflected into each angle.
    #[doc(alias = "Rd_a")]
    ReflectedByAngle,
    /// Transmitted in each ring.
    #[doc(alias = "Tt_r")]
    TransmittedByRing,
    /// Transmitted into each angle.
    #[doc(alias = "Tt_a")]
    TransmittedByAngle,
    /// Absorbed in each ring, and in it in each depth.
    #[doc(alias = "A_rz")]
    AbsorbedByRingAndDepth,
    /// Reflected in each ring, and from it into each angle.
    #[doc(alias = "Rd_ra")]
    ReflectedByRingAndAngle,
    /// Transmitted in each ring, and from it into each angle.
    #[doc(alias = "Tt_ra")]
    TransmittedByRingAndAngle,
}

impl Quantity {
    const ALL: [Self; 14] = [
        Self::Reflected,
        Self::Transmitted,
        Self::Absorbed,
        Self::Ground,
        Self::Lost,
        Self::AbsorbedByLayer,
        Self::AbsorbedByDepth,
        Self::ReflectedByRing,
        Self::ReflectedByAngle,
        Self::TransmittedByRing,
        Self::TransmittedByAngle,
        Self::AbsorbedByRingAndDepth,
        Self::ReflectedByRingAndAngle,
        Self::TransmittedByRingAndAngle,
    ];
}

/// Places of all quantities in one list of numbers.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Places {
    pub(super) grid: Grid,
    /// Start of every quantity, and the end of the last.
    starts: [usize; Quantity::ALL.len() + 1],
}

impl Places {
    pub(super) fn new(grid: Grid, layers: usize) -> Self {
        let Grid { nz, nr, na, .. } = grid;
        let mut starts = [0; Quantity::ALL.len() + 1];
        for (i, quantity) in Quantity::ALL.into_iter().enumerate() {
            let count = match quantity {
                Quantity::AbsorbedByLayer => layers,
                Quantity::AbsorbedByDepth => nz,
                Quantity::ReflectedByRing | Quantity::TransmittedByRing => nr,
                Quantity::ReflectedByAngle | Quantity::TransmittedByAngle => na,
                Quantity::AbsorbedByRingAndDepth => nr * nz,
                Quantity::ReflectedByRingAndAngle | Quantity::TransmittedByRingAndAngle => nr * na,
                _ => 1,
            };
            starts[i + 1] = starts[i] + count;
        }
        Self { grid, starts }
    }

    pub(super) fn of(&self, quantity: Quantity) -> Range<usize> {
        self.starts[quantity as usize]..self.starts[quantity as usize + 1]
    }

    pub(super) fn count(&self) -> usize {
        self.starts[Quantity::ALL.len()]
    }

    /// Sums up over angles, depths, rings and layers what was counted in cells.
    pub(super) fn sum_up(&self, sums: &mut [f64]) {
        use Quantity as Q;
        let of = |quantity| self.of(quantity).start;
        if !self.grid.has_map() {
            // One cell holds all
            sums[of(Q::AbsorbedByRingAndDepth)] = sums[self.of(Q::AbsorbedByLayer)].iter().sum();
        }
        for (cells, columns, by_row, by_column) in [
            (Q::ReflectedByRingAndAngle, self.grid.na, Some(Q::ReflectedByRing), Q::ReflectedByAngle),
            (Q::TransmittedByRingAndAngle, self.grid.na, Some(Q::TransmittedByRing), Q::TransmittedByAngle),
            (Q::AbsorbedByRingAndDepth, self.grid.nz, None, Q::AbsorbedByDepth),
        ] {
            for row in 0..self.grid.nr {
                for column in 0..columns {
                    let value = sums[of(cells) + row * columns + column];
                    sums[of(by_column) + column] += value;
                    if let Some(by_row) = by_row {
                        sums[of(by_row) + row] += value;
                    }
                }
            }
        }
        for (total, parts) in [
            (Q::Reflected, Q::ReflectedByRing),
            (Q::Transmitted, Q::TransmittedByRing),
            (Q::Absorbed, Q::AbsorbedByLayer),
        ] {
            sums[of(total)] = sums[self.of(parts)].iter().sum();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_lie_one_behind_the_other() {
        let places = Places::new(Grid { nz: 3, nr: 5, na: 2, ..Grid::TOTALS }, 7);
        let mut end = 0;
        for (i, quantity) in Quantity::ALL.into_iter().enumerate() {
            assert_eq!((quantity as usize, places.of(quantity).start), (i, end));
            end = places.of(quantity).end;
        }
        assert_eq!((end, places.count()), (places.count(), 5 + 7 + 3 + 2 * 5 + 2 * 2 + 15 + 20));
    }
}
