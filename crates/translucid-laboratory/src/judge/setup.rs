//! The lit shape of a picture.

use crate::oracle::LitShape;

/// Lit shape that a pass draws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Setup {
    /// A half plane; places are distances from its edge, positive on the dark side.
    Edge,
    /// A disk of a radius \[L\]; places are distances from its center.
    Disk {
        /// Its radius.
        radius: f64,
    },
    /// A band of a width \[L\]; places are distances from the line in its middle.
    Line {
        /// Its width.
        width: f64,
    },
}

impl Setup {
    pub(super) fn shape(&self, place: f64) -> LitShape {
        match *self {
            Self::Edge => LitShape::Edge { distance: place },
            Self::Disk { radius } => LitShape::Disk { radius, offset: place },
            Self::Line { width } => LitShape::Line { width, offset: place },
        }
    }

    /// Where light begins.
    pub(super) fn rim(&self) -> f64 {
        match *self {
            Self::Edge => 0.0,
            Self::Disk { radius } => radius,
            Self::Line { width } => 0.5 * width,
        }
    }

    /// Area by the place, as far as sums of light need it.
    pub(super) fn area(&self, place: f64) -> f64 {
        if matches!(self, Self::Disk { .. }) { place.abs() } else { 1.0 }
    }

    /// Diameter or width; 0 of an edge.
    pub(super) fn size(&self) -> f64 {
        2.0 * self.rim()
    }

    /// A shape of so many times the size.
    pub(super) fn resized(&self, factor: f64) -> Self {
        match *self {
            Self::Edge => Self::Edge,
            Self::Disk { radius } => Self::Disk { radius: factor * radius },
            Self::Line { width } => Self::Line { width: factor * width },
        }
    }
}
