//! Results of a measurement.

/// Scale of the values of a photograph.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// Reflectances, by something white under the same light.
    Reflectance(White),
    /// Anything in proportion to them: surface albedos are given.
    Relative([f64; 3]),
    /// Anything in proportion to them, and nothing is known of the surface albedos: the fit takes [`USUAL_ALBEDO`].
    Unknown,
}

/// Surface albedo of a fit where none is known.
pub const USUAL_ALBEDO: f64 = 0.7;

/// Something white, by which light becomes a reflectance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct White {
    /// Its reflectances.
    pub reflectance: [f64; 3],
    /// Relative standard errors of the reflectances that it leads to.
    pub error: [f64; 3],
    /// Its place across the edge \[L\]; none where the light on the piece is known everywhere.
    pub place: Option<f64>,
}

impl White {
    /// Something white that is known exactly, in the light of the whole piece.
    pub const PERFECT: Self = Self { reflectance: [1.0; 3], error: [0.0; 3], place: None };
}

impl Scale {
    /// Whether values are reflectances.
    pub fn is_reflectance(&self) -> bool {
        matches!(self, Self::Reflectance(_))
    }

    /// The surface albedo of a channel, where it is not measured.
    pub fn albedo(&self, c: usize) -> Option<f64> {
        match self {
            Self::Reflectance(_) => None,
            Self::Relative(albedos) => Some(albedos[c]),
            Self::Unknown => Some(USUAL_ALBEDO),
        }
    }
}

/// A value, and where the truth is with so much confidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The most likely value.
    pub value: f64,
    /// The 68 % interval.
    pub likely: [f64; 2],
    /// The 95 % interval.
    pub sure: [f64; 2],
}

/// Result of the fit for a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelFit {
    /// Mean free path \[L\]; where [none is seen](Self::is_seen), without meaning.
    pub mfp: Interval,
    /// Whether light visibly spreads; if not, its edge is as sharp as the blur, or it brightens evenly across the picture.
    pub is_seen: bool,
    /// Surface albedo, where the values are reflectance.
    pub surface_albedo: Option<Interval>,
    /// Correlation of the two errors, where both are measured.
    pub correlation: f64,
    /// Stray light over the lit side's, or over the spot's middle; the card's own where it is visible.
    pub stray: f64,
    /// Uneven light: by how much it changes over the places, over that where its scale is known.
    pub unevenness: f64,
}

/// Shape of the light, by the thing that casts it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outline {
    /// A card that ends at a place \[L\].
    Edge {
        /// Place of the card.
        card: Card,
        /// Where the card ends \[L\].
        position: f64,
    },
    /// A spot of light.
    Spot {
        /// Radius of the evenly lit disk \[L\]; much less than the blur where the spot is a Gaussian.
        radius: f64,
    },
}

impl Outline {
    /// A word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Edge { .. } => "edge",
            Self::Spot { .. } => "spot",
        }
    }
}

/// The card that keeps light from the dark side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Card {
    /// Nothing that the camera sees: the dark side shows the piece, as in the shadow that a projector throws.
    Hidden,
    /// A card on the piece: the dark side shows the card.
    Visible,
}

/// The fit of all channels.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Red, green and blue.
    pub channels: [ChannelFit; 3],
    /// The light's shape.
    pub outline: Outline,
    /// Standard deviation of the camera's blur \[L\], and of a spot's soft edge.
    pub blur: f64,
    /// Mean square of the means' residuals over what the blocks' differences lead to expect: 1 where the model is right.
    pub misfit: f64,
    /// The model's values, by place.
    pub light: Vec<[f64; 3]>,
    /// Standard errors of the means of the blocks, by place, as a model of the noise has them.
    pub errors: Vec<[f64; 3]>,
}
