//! Inks of series: what they stand for, and their look.

use translucid_profile::Model;

use super::Shade;

/// Meaning of a series, which decides its look.
///
/// It has the same color, dash pattern and marker in every chart, so that a reader who has learned it once knows it
/// everywhere.
/// Colors are those of Okabe and Ito (*Color Universal Design*, 2008) as far as they are readable on white; no two
/// inks of a kind share both color and dash pattern, so that series can be told apart in gray, too.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Ink {
    /// A model.
    Model(Model),
    /// The truth that others are measured against: the exact solution, or a walk of photons. Its line is wide and lies
    /// below all others, so that those which follow it are seen.
    Reference,
    /// Numbers that the seed talk published \[Christensen & Burley 2015\].
    Talk,
    /// Fits made here.
    Fit,
    /// The n-th of series that need nothing but to be told apart; they repeat after [`Ink::NUMBERED`].
    Numbered(usize),
    /// A line that helps to read, as that of zero.
    Guide,
}

/// Look of an ink.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Style {
    pub(crate) shade: Shade,
    /// Lengths of dashes and gaps, empty for a solid line.
    pub(crate) dash: &'static [f64],
    /// Marker of points.
    pub(crate) marker: Marker,
    /// Width of lines.
    pub(crate) width: f64,
}

/// Shapes of points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Marker {
    Circle,
    Square,
    Triangle,
    TriangleDown,
    Diamond,
    Cross,
    Plus,
    Star,
    Pentagon,
    Hexagon,
}

const SOLID: &[f64] = &[];
const LONG: &[f64] = &[12.0, 4.0];
const LONG_SHORT: &[f64] = &[12.0, 3.0, 5.0, 3.0];
const SPARSE: &[f64] = &[4.0, 7.0];
const DASHED: &[f64] = &[7.0, 4.0];
const DOTTED: &[f64] = &[2.0, 3.0];
const DASH_DOT: &[f64] = &[8.0, 3.0, 2.0, 3.0];
const DASH_DOT_DOT: &[f64] = &[8.0, 3.0, 2.0, 3.0, 2.0, 3.0];
const SHORT: &[f64] = &[4.0, 3.0];

/// The numbered inks.
const NUMBERED: [Style; 18] = [
    line(Shade::VERMILION, SOLID, Marker::Circle),
    line(Shade::BLUE, SOLID, Marker::Square),
    line(Shade::GREEN, DASHED, Marker::Triangle),
    line(Shade::PURPLE, DASH_DOT, Marker::Diamond),
    line(Shade::ORANGE, SOLID, Marker::TriangleDown),
    line(Shade::WINE, DOTTED, Marker::Cross),
    line(Shade::SKY, LONG, Marker::Pentagon),
    line(Shade::GRAY, DASH_DOT_DOT, Marker::Plus),
    line(Shade::VERMILION, SHORT, Marker::Star),
    line(Shade::BLUE, DASH_DOT, Marker::Hexagon),
    line(Shade::GREEN, SOLID, Marker::Square),
    line(Shade::WINE, LONG, Marker::Circle),
    line(Shade::PURPLE, SOLID, Marker::TriangleDown),
    line(Shade::ORANGE, DASH_DOT, Marker::Star),
    line(Shade::SKY, SHORT, Marker::Triangle),
    line(Shade::GRAY, SOLID, Marker::Circle),
    line(Shade::WINE, SOLID, Marker::Square),
    line(Shade::PURPLE, LONG_SHORT, Marker::Plus),
];

const fn line(shade: Shade, dash: &'static [f64], marker: Marker) -> Style {
    Style { shade, dash, marker, width: 2.0 }
}

impl Ink {
    /// Number of [`Ink::Numbered`] inks.
    pub const NUMBERED: usize = NUMBERED.len();

    pub(crate) fn style(self) -> Style {
        match self {
            Self::Model(model) => match model {
                Model::NormalizedDiffusion => line(Shade::VERMILION, SOLID, Marker::Circle),
                Model::NormalizedDiffusionRefined => line(Shade::BLUE, LONG, Marker::Square),
                Model::NormalizedDiffusionOblique => line(Shade::BLUE, SPARSE, Marker::Plus),
                Model::Dipole => line(Shade::ORANGE, DOTTED, Marker::Triangle),
                Model::BetterDipole => line(Shade::GREEN, DASH_DOT, Marker::TriangleDown),
                Model::DirectionalDipole => line(Shade::SKY, DASHED, Marker::Diamond),
                Model::QuantizedDiffusion => line(Shade::PURPLE, DASH_DOT_DOT, Marker::Pentagon),
                Model::PhotonBeamDiffusion => line(Shade::WINE, SHORT, Marker::Star),
                Model::Gaussians => line(Shade::GRAY, LONG_SHORT, Marker::Cross),
                Model::Exact => Style { width: 3.2, ..line(Shade::BLACK, SOLID, Marker::Hexagon) },
            },
            Self::Reference => Style { width: 3.2, ..line(Shade::BLACK, SOLID, Marker::Circle) },
            Self::Talk => line(Shade::VERMILION, DASHED, Marker::Diamond),
            Self::Fit => line(Shade::BLUE, SOLID, Marker::Square),
            Self::Numbered(n) => NUMBERED[n % NUMBERED.len()],
            Self::Guide => Style { width: 1.0, ..line(Shade::GRAY, SOLID, Marker::Plus) },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn are_told_apart(inks: &[Ink]) {
        for (i, a) in inks.iter().enumerate() {
            for b in &inks[..i] {
                let (x, y) = (a.style(), b.style());
                assert!(x.shade != y.shade || x.dash != y.dash, "{a:?} and {b:?} draw the same line");
                assert!(x.shade != y.shade || x.marker != y.marker, "{a:?} and {b:?} draw the same points");
            }
        }
    }

    #[test]
    fn models_differ_in_dashes_alone() {
        let dashes = Model::ALL.map(|model| Ink::Model(model).style().dash);
        let solid = dashes.iter().filter(|dash| dash.is_empty()).count();
        assert_eq!(solid, 2, "normalized diffusion in color, and the exact solution in black");
        for (i, dash) in dashes.iter().enumerate() {
            assert!(dash.is_empty() || !dashes[..i].contains(dash), "{dash:?}");
        }
    }

    #[test]
    fn inks_of_a_chart_differ() {
        are_told_apart(&Model::ALL.map(Ink::Model));
        are_told_apart(&(0..Ink::NUMBERED).map(Ink::Numbered).collect::<Vec<_>>());
        are_told_apart(&[Ink::Reference, Ink::Talk, Ink::Fit, Ink::Guide]);
    }
}
