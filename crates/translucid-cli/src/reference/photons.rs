//! Numbers of photons as one would type them.

use std::fmt;
use std::ops::Range;

use translucid_reference::walk::{PhotonRange, WhiteTable};

/// Photons that are wanted: so many of a seed, or a half-open range of them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Photons {
    /// The first ones, those of tables included.
    Count(u64),
    /// Photons of a range, whatever else tables hold.
    Range(Range<u64>),
}

impl Photons {
    /// Reads `N` or `A..B`.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let Some((start, end)) = text.split_once("..") else { return parse_photons(text).map(Self::Count) };
        let range = parse_photons(start)?..parse_photons(end)?;
        if range.start > range.end {
            return Err(String::from("must be a range A..B in which A is not greater than B"));
        }
        Ok(Self::Range(range))
    }

    /// Returns whether they are no photons at all.
    pub(super) fn are_none(&self) -> bool {
        match self {
            Self::Count(count) => *count == 0,
            Self::Range(range) => range.is_empty(),
        }
    }

    /// Number of photons that a table lacks.
    pub(super) fn lacking(&self, table: &WhiteTable, seed: u64) -> u64 {
        match self {
            Self::Count(count) => count.saturating_sub(table.photons()),
            Self::Range(range) => {
                let range = PhotonRange { seed, start: range.start, end: range.end };
                table.missing_of(range).iter().map(PhotonRange::len).sum()
            }
        }
    }
}

impl fmt::Display for Photons {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Count(count) => count.fmt(f),
            Self::Range(Range { start, end }) => write!(f, "{start}..{end}"),
        }
    }
}

/// Reads a number of photons, 10000000 or 1e7.
pub(crate) fn parse_photons(text: &str) -> Result<u64, String> {
    if let Ok(count) = text.parse::<u64>() {
        return Ok(count);
    }
    match text.parse::<f64>() {
        Ok(count) if count >= 0.0 && count < (1u64 << 63) as f64 && count.fract() == 0.0 => Ok(count as u64),
        _ => Err(String::from("must be a whole number below 2^63, such as 10000000 or 1e7")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn photons_are_a_number_or_a_range() {
        assert_eq!(Photons::parse("1e7"), Ok(Photons::Count(10_000_000)));
        assert_eq!(Photons::parse("5..1e3"), Ok(Photons::Range(5..1000)));
        assert_eq!(Photons::parse("7..7"), Ok(Photons::Range(7..7)));
        for wrong in ["", "..", "5..", "..5", "5..=9", "9..5", "-1..5", "0.5..1", "1..2..3", "1e30..2e30"] {
            assert!(Photons::parse(wrong).is_err(), "{wrong}");
        }
    }
}
