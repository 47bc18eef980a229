//! How a photograph was taken, and of what.

use translucid_profile::Configuration;

use crate::error::MeasureError;
use crate::fit::{Card, Scale};

/// The thing that shapes the light on the piece.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Setup {
    /// An opaque card that covers half of the piece.
    #[default]
    Edge,
    /// A small round spot of light.
    Spot,
    /// An opaque card between a slab and a panel of light behind it, which it covers in half.
    Slab,
}

/// Setup of a photograph: how it was taken, and of what.
///
/// Pixels count from the upper left corner; rectangles go from (x0, y0) to before (x1, y1).
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The thing that shapes the light.
    pub setup: Setup,
    /// Thickness of a slab \[mm\], in (0, 1e6].
    pub thickness: Option<f64>,
    /// Width of a pixel on the piece \[mm\], in (0, 1e6].
    pub mm_per_pixel: Option<f64>,
    /// In its place two points x0, y0, x1, y1 of the photograph and the distance between them \[mm\].
    pub ruler: Option<[f64; 5]>,
    /// White card in the photograph, in the same light.
    pub white: Option<[usize; 4]>,
    /// Reflectance of what is white, in (0, 1]: one or three. By default that of paper, 0.9, or 1 for the panel behind a slab.
    pub white_reflectance: Vec<f64>,
    /// Relative standard error of that reflectance, in \[0, 0.5\]. By default 0.02, or 0 for the panel behind a slab.
    pub white_tolerance: Option<f64>,
    /// Surface albedo where nothing white is seen, in (0, 1): one or three. By default 0.7.
    pub surface_albedo: Vec<f64>,
    /// Part of the photograph that is measured; by default all of it.
    pub region: Option<[usize; 4]>,
    /// Two points x0, y0, x1, y1 of the card's edge; found by default.
    pub edge: Option<[f64; 4]>,
    /// Center x, y of the spot; found by default.
    pub center: Option<[f64; 2]>,
    /// Place of the card; found by default.
    pub card: Option<Card>,
    /// How light falls on a matt piece ([`Configuration::Diffuse`], the default), or on a clear one that is seen from straight
    /// above ([`Configuration::Searchlight`]).
    pub configuration: Option<Configuration>,
    /// Angle between a lamp's rays and the surface's normal, for a clear piece that is seen from straight above, in (−90, 90)
    /// degrees: positive where the rays run from dark to lit.
    pub incidence: Option<f64>,
    /// Relative refractive index η of a smooth piece, in \[0.5, 3\]; 1 is none.
    pub eta: f64,
    /// Mean cosine of the phase function, in (−1, 1): the mean free path is that of the similar medium.
    pub g: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            setup: Setup::default(),
            thickness: None,
            mm_per_pixel: None,
            ruler: None,
            white: None,
            white_reflectance: Vec::new(),
            white_tolerance: None,
            surface_albedo: Vec::new(),
            region: None,
            edge: None,
            center: None,
            card: None,
            configuration: None,
            incidence: None,
            eta: 1.0,
            g: 0.0,
        }
    }
}

/// Greatest length that an option states \[mm\].
const LONGEST: f64 = 1e6;

/// Greatest surface albedo that may be stated.
const GREATEST_ALBEDO: f64 = 0.9999;

/// Reflectance of white paper.
const PAPER: f64 = 0.9;

/// Relative standard error of the reflectance of white paper: of nine in ten sheets it is 0.87 to 0.93.
const PAPER_TOLERANCE: f64 = 0.02;

/// Greatest relative standard error that may be stated.
const GREATEST_TOLERANCE: f64 = 0.5;

impl Options {
    /// Refuses numbers out of their range and options that contradict each other.
    pub(crate) fn check(&self) -> Result<(), MeasureError> {
        self.check_ranges()?;
        self.check_conflicts()?;
        self.check_setup()
    }

    fn check_ranges(&self) -> Result<(), MeasureError> {
        for (name, length) in [("mm_per_pixel", self.mm_per_pixel), ("thickness", self.thickness)] {
            if let Some(length) = length.filter(|length| !(*length > 0.0 && *length <= LONGEST)) {
                let message = format!("`{name}` is {length} mm, but must be in (0, 1e6]");
                return Err(MeasureError::new(message));
            }
        }
        if let Some(ruler @ [x0, y0, x1, y1, mm]) = self.ruler
            && !(ruler.iter().all(|v| v.abs() < LONGEST) && [x0, y0] != [x1, y1] && mm > 0.0)
        {
            let message = "must be two points in pixels that are apart, and the distance between them in mm";
            return Err(MeasureError::new(format!("`ruler` is {}, but {message}", list(&ruler))));
        }
        for (name, rectangle) in [("white", self.white), ("region", self.region)] {
            check_rectangle(name, rectangle)?;
        }
        for (name, point) in
            [("edge", self.edge.as_ref().map(|e| &e[..])), ("center", self.center.as_ref().map(|c| &c[..]))]
        {
            if let Some(point) = point.filter(|point| point.iter().any(|v| !v.is_finite())) {
                let message = format!("`{name}` is {}, but must be finite numbers of pixels", list(point));
                return Err(MeasureError::new(message));
            }
        }
        if let Some(wrong) = self.white_tolerance.filter(|v| !(0.0..=GREATEST_TOLERANCE).contains(v)) {
            let message = format!("`white_tolerance` is {wrong}, but must be in [0, {GREATEST_TOLERANCE}]");
            return Err(MeasureError::new(message));
        }
        match self.incidence {
            Some(angle) if angle.is_nan() || angle.abs() >= 90.0 => {
                Err(MeasureError::new(format!("`incidence` is {angle} degrees, but must be in (-90, 90)")))
            }
            _ => Ok(()),
        }
    }

    fn check_conflicts(&self) -> Result<(), MeasureError> {
        let is_given = [
            (self.mm_per_pixel.is_some() && self.ruler.is_some(), ["ruler", "mm_per_pixel"]),
            (self.white.is_some() && !self.surface_albedo.is_empty(), ["surface_albedo", "white"]),
            (self.center.is_some() && self.edge.is_some(), ["center", "edge"]),
            (self.configuration.is_some() && self.incidence.is_some(), ["incidence", "configuration"]),
        ];
        refuse_together(&is_given)
    }

    /// Refuses options that belong to another setup.
    fn check_setup(&self) -> Result<(), MeasureError> {
        let is = |setup| self.setup == setup;
        let given = [
            (self.edge.is_some() && is(Setup::Spot), "`edge` is for `setup` edge and slab"),
            (self.card.is_some() && !is(Setup::Edge), "`card` is for `setup` edge"),
            (self.center.is_some() && !is(Setup::Spot), "`center` is for `setup` spot"),
            (self.thickness.is_some() && !is(Setup::Slab), "`thickness` is for `setup` slab"),
            (self.thickness.is_none() && is(Setup::Slab), "`setup` slab needs its `thickness`"),
            (self.incidence.is_some() && is(Setup::Slab), "`incidence` is for `setup` edge and spot"),
            (
                self.white.is_some() && is(Setup::Spot),
                "`white` is for `setup` edge and slab: the power of a spot is measured on white paper in its place, \
                 `white_photo`",
            ),
            (
                self.eta != 1.0 && is(Setup::Slab),
                "`setup` slab is for `eta` 1: light between two boundaries is not solved exactly here",
            ),
        ];
        let wrong = given.iter().find(|(is_wrong, _)| *is_wrong);
        wrong.map_or(Ok(()), |(_, message)| Err(MeasureError::new(*message)))
    }

    /// Width of a pixel \[mm\].
    pub(crate) fn pixel_width(&self) -> Result<f64, MeasureError> {
        match (self.mm_per_pixel, self.ruler) {
            (Some(width), _) => Ok(width),
            (None, Some([x0, y0, x1, y1, distance])) => Ok(distance / (x1 - x0).hypot(y1 - y0)),
            (None, None) => Err(MeasureError::new("the scale is missing: `mm_per_pixel`, `ruler` or `scene`").with_help(
                "state a pixel's width by `mm_per_pixel` 0.04, a distance by `ruler` X0,Y0,X1,Y1,MM, or, of a known shape, \
                 its scene by `scene` and what to find by `fit`",
            )),
        }
    }

    /// Scale of light without something white: shares of its own, with the surface albedos that are given.
    pub(crate) fn scale_without_white(&self) -> Result<Scale, MeasureError> {
        if self.surface_albedo.is_empty() {
            return Ok(Scale::Unknown);
        }
        three("surface_albedo", &self.surface_albedo, GREATEST_ALBEDO).map(Scale::Relative)
    }

    /// Relative standard error of the reflectance of what is white.
    pub(crate) fn white_error(&self) -> f64 {
        let by_default = if self.setup == Setup::Slab { 0.0 } else { PAPER_TOLERANCE };
        self.white_tolerance.unwrap_or(by_default)
    }

    /// Reflectances of what is white.
    pub(crate) fn white_reflectances(&self) -> Result<[f64; 3], MeasureError> {
        match (self.white_reflectance.as_slice(), self.setup) {
            ([], Setup::Slab) => Ok([1.0; 3]),
            ([], _) => Ok([PAPER; 3]),
            (given, _) => three("white_reflectance", given, 1.0),
        }
    }
}

/// Refuses options that are given together, as the first pair says that is.
pub(crate) fn refuse_together(pairs: &[(bool, [&str; 2])]) -> Result<(), MeasureError> {
    let wrong = pairs.iter().find(|(is_given, _)| *is_given);
    wrong.map_or(Ok(()), |(_, [a, b])| Err(MeasureError::new(format!("`{a}` cannot be used with `{b}`"))))
}

/// Refuses a rectangle without pixels.
pub(crate) fn check_rectangle(name: &str, rectangle: Option<[usize; 4]>) -> Result<(), MeasureError> {
    match rectangle {
        Some([x0, y0, x1, y1]) if x0 >= x1 || y0 >= y1 => Err(MeasureError::new(format!(
            "`{name}` is {x0},{y0},{x1},{y1}, but must be X0,Y0,X1,Y1 in pixels with X0 < X1 and Y0 < Y1"
        ))),
        _ => Ok(()),
    }
}

/// One or three numbers in (0, `most`].
fn three(option: &str, values: &[f64], most: f64) -> Result<[f64; 3], MeasureError> {
    if let Some(wrong) = values.iter().find(|value| !(**value > 0.0 && **value <= most)) {
        return Err(MeasureError::new(format!("`{option}` is {wrong}, but must be in (0, {most}]")));
    }
    match *values {
        [one] => Ok([one; 3]),
        [r, g, b] => Ok([r, g, b]),
        _ => {
            let message = format!("`{option}` has {} numbers, but must have one or three", values.len());
            Err(MeasureError::new(message))
        }
    }
}

fn list(values: &[f64]) -> String {
    values.iter().map(ToString::to_string).collect::<Vec<_>>().join(",")
}
