//! Builds the table of a profile with as few evaluations as its accuracy takes.
//!
//! Octave by octave, cells are halved until the density in their middles is the profile's: a cell has the right
//! shares at both ends and in the middle whatever its density there, so that its density's error tells that of its
//! shares in between. Halving wastes nothing, as middles become ends.

use std::f64::consts::PI;

use crate::table::monotone_cell::{Cell, Knot, RadialCell};
use crate::table::radial_table::{RadialTable, Tail};
use crate::{NormalizedDiffusion, Profile};

/// Relative error of shares at which a cell is good enough.
const TOLERANCE: f64 = 1e-6;
/// Shares beyond a radius are looked after in relative terms down to this one.
pub(crate) const LEAST_TAIL: f64 = 1e-6;
/// Where the table leaves the rest to an exponential.
const TAIL_SHARE: f64 = 1e-8;
/// Greatest share before the first octave.
const HEAD_SHARE: f64 = 1e-3;
/// An octave has at most 2^this cells.
const OCTAVE_BITS_MAX: u32 = 6;
/// Octaves of the table on either side of the profile's scale.
const OCTAVES_MAX: i32 = 40;
/// Error of a cell's share over that of its density in the middle times its width: of θ²(θ−½)(1−θ)², the leading
/// term, the greatest value 0.00894 over the slope 1/16 in the middle; twice that, as the lesser of share and
/// complement may be half as great there as in the middle.
const SHARE_ERROR: f64 = 0.286;

/// A table and what it was made with.
pub(crate) struct Built {
    pub(crate) table: RadialTable,
    /// The table's unit of length in the profile's.
    pub(crate) length: f64,
    /// Worst error of a share over the lesser of the share and its complement.
    pub(crate) error: f64,
}

/// Which of its two energies a profile is asked for.
#[derive(Clone, Copy, PartialEq)]
enum Side {
    BelowMedian,
    Unknown,
    AboveMedian,
}

/// A profile in units of its scale and total.
struct Source<'a> {
    profile: &'a dyn Profile,
    length: f64,
    inverse_total: f64,
}

/// Tabulates a profile. One without energy gets the shape of normalized diffusion, so that it can be sampled.
pub(crate) fn build(profile: &dyn Profile) -> Built {
    let length = profile.scale();
    let source = Source { profile, length, inverse_total: 1.0 };
    let total = source.enclosed(1.0) + source.beyond(1.0);
    if total >= f64::MIN_POSITIVE && total.is_finite() {
        return Source { inverse_total: 1.0 / total, ..source }.build();
    }
    let unit = NormalizedDiffusion::from_d(1.0, 1.0).expect("valid parameters");
    Built { length, ..build(&unit) }
}

impl Source<'_> {
    fn build(self) -> Built {
        // Find where octaves begin and end
        let (edges, first_exponent, below_first) = self.edges();
        let origin = Knot { x: 0.0, within: 0.0, beyond: 1.0, density: self.density(0.0) };
        let head = Cell::new(&origin, &below_first, &edges[0]);
        let mut error = share_error(&head, &below_first);
        let mut cells = vec![head];
        let mut bits_of_octaves = Vec::new();
        let mut end = edges[0];

        // Fill them
        for pair in edges.windows(2) {
            let octave = self.octave(&pair[0], &pair[1]);
            error = error.max(octave.error);
            bits_of_octaves.push(octave.bits);
            cells.extend(octave.cells);
            end = octave.end;
            // An octave that is not full is the last one: the cells of the next would not be where they are sought
            if end.beyond < TAIL_SHARE {
                break;
            }
        }
        let mut tail = Tail::new(&end);
        make_consistent(&mut cells, &mut tail);
        let table = RadialTable::new(first_exponent, &bits_of_octaves, cells, tail);
        Built { table, length: self.length, error }
    }

    /// Knots at powers of two, the exponent of the first, and the knot at half of the first.
    fn edges(&self) -> (Vec<Knot>, i32, Knot) {
        let origin = self.density(0.0);
        let origin = Knot { x: 0.0, within: 0.0, beyond: 1.0, density: origin };
        let middle = self.knot(1.0, Side::Unknown);
        let is_below = middle.within < 0.5;

        // Outward until hardly anything is left
        let mut edges = vec![middle];
        let mut side = if is_below { Side::Unknown } else { Side::AboveMedian };
        for exponent in 1..=OCTAVES_MAX {
            let last = edges[edges.len() - 1];
            if last.beyond < TAIL_SHARE && exponent > 1 {
                break;
            }
            let next = self.knot(libm::exp2(f64::from(exponent)), side);
            side = if next.within < 0.5 { Side::Unknown } else { Side::AboveMedian };
            edges.push(next);
        }

        // Inward until one cell is good for all the rest
        let mut side = if is_below { Side::BelowMedian } else { Side::Unknown };
        let mut inward = Vec::new();
        let (mut edge, mut exponent) = (middle, 0);
        loop {
            let next = self.knot(libm::exp2(f64::from(exponent - 1)), side);
            let head = Cell::new(&origin, &next, &edge);
            let is_good = edge.within < HEAD_SHARE && share_error(&head, &next) < TOLERANCE;
            if is_good || exponent <= -OCTAVES_MAX {
                inward.reverse();
                inward.extend(edges);
                return (inward, exponent, next);
            }
            side = if next.within < 0.5 { Side::BelowMedian } else { Side::Unknown };
            inward.push(next);
            (edge, exponent) = (next, exponent - 1);
        }
    }

    /// The cells of an octave.
    fn octave(&self, start: &Knot, end: &Knot) -> OctaveCells {
        let side = match () {
            () if end.within < 0.5 => Side::BelowMedian,
            () if start.within >= 0.5 => Side::AboveMedian,
            () => Side::Unknown,
        };
        let mut knots = vec![*start, *end];
        for bits in 0.. {
            // Leave out what the tail does as well
            let kept =
                knots.iter().position(|knot| knot.beyond < TAIL_SHARE).map_or(knots.len(), |last| last + 1);
            knots.truncate(kept.max(2));
            let middles: Vec<Knot> =
                knots.windows(2).map(|pair| self.knot(0.5 * (pair[0].x + pair[1].x), side)).collect();
            let cells: Vec<Cell> = (knots.windows(2).zip(&middles))
                .map(|(pair, middle)| Cell::new(&pair[0], middle, &pair[1]))
                .collect();
            let error = cells
                .iter()
                .zip(&middles)
                .map(|(cell, middle)| share_error(cell, middle))
                .fold(0.0, f64::max);
            if error < TOLERANCE || bits == OCTAVE_BITS_MAX {
                let end = knots[knots.len() - 1];
                return OctaveCells { cells, bits, end, error };
            }
            let both = knots.iter().zip(&middles).flat_map(|(knot, middle)| [*knot, *middle]);
            knots = both.chain(knots.last().copied()).collect();
        }
        unreachable!("the loop returns at the last depth")
    }

    fn knot(&self, x: f64, side: Side) -> Knot {
        let density = self.density(x);
        if side == Side::AboveMedian {
            let beyond = self.beyond(x);
            return Knot { x, within: 1.0 - beyond, beyond, density };
        }
        let within = self.enclosed(x);
        let beyond = if side == Side::Unknown && within >= 0.5 { self.beyond(x) } else { 1.0 - within };
        Knot { x, within, beyond, density }
    }

    fn density(&self, x: f64) -> f64 {
        let times_r = self.profile.eval_times_r(x * self.length).max(0.0);
        // The unit of length times 1/L: neither alone may leave the range
        2.0 * PI * self.inverse_total * (times_r * self.length)
    }

    fn enclosed(&self, x: f64) -> f64 {
        self.profile.enclosed(x * self.length).max(0.0) * self.inverse_total
    }

    fn beyond(&self, x: f64) -> f64 {
        self.profile.beyond(x * self.length).max(0.0) * self.inverse_total
    }
}

/// Sums up shares from both sides, where each keeps its digits: the source's energies may not rise in the last
/// one, or not agree with each other.
fn make_consistent(cells: &mut [Cell], tail: &mut Tail) {
    let total = cells.iter().map(|cell| cell.share).sum::<f64>() + tail.share;
    tail.share /= total;
    let mut within = 0.0;
    for cell in cells.iter_mut() {
        cell.share /= total;
        cell.within = within;
        within += cell.share;
    }
    let mut beyond = tail.share;
    for cell in cells.iter_mut().rev() {
        cell.beyond = beyond;
        beyond += cell.share;
    }
    // All is beyond r = 0, to the last digit
    cells[0].beyond = 1.0 - cells[0].share;
}

/// The cells of an octave: 2^`bits`, or fewer where the tail begins before its end.
struct OctaveCells {
    cells: Vec<Cell>,
    bits: u32,
    /// Where the last cell ends.
    end: Knot,
    error: f64,
}

/// Estimated error of a cell's shares over the lesser of the share and its complement, or over [`LEAST_TAIL`].
fn share_error(cell: &Cell, middle: &Knot) -> f64 {
    let between = SHARE_ERROR * (cell.density(middle.x) - middle.density).abs() / cell.inverse_width;
    let at_middle = if middle.within < 0.5 {
        (cell.within(middle.x) - middle.within).abs()
    } else {
        (cell.beyond(middle.x) - middle.beyond).abs()
    };
    (between + at_middle) / middle.within.min(middle.beyond.max(LEAST_TAIL)).max(f64::MIN_POSITIVE)
}
