//! Place of the light's shape in a photograph: the line of an edge, or the circle of a spot.

use crate::edge_line::{EdgeLine, NoEdge};
use crate::error::MeasureError;
use crate::linear_photo::Photo;
use crate::options::Options;
use crate::remark::Remark;
use crate::spot_place::{NoSpot, SpotPlace};

/// Place of the light's shape in the region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Trace {
    /// The line of an edge.
    Line(EdgeLine),
    /// The center and radius of a spot.
    Spot(SpotPlace),
}

impl Trace {
    /// Distance of a pixel from the line, or from the circle in which a spot is half as bright, in pixels.
    pub fn distance(&self, x: usize, y: usize) -> f64 {
        match self {
            Self::Line(line) => line.distance(x, y).abs(),
            Self::Spot(place) => (place.distance(x, y) - place.half).abs(),
        }
    }
}

/// The line of the edge in a region, stated or found.
pub(crate) fn edge_line(
    piece: &Photo,
    [left, top]: [f64; 2],
    name: &str,
    options: &Options,
    say: &mut dyn FnMut(Remark),
) -> Result<EdgeLine, MeasureError> {
    let line = match options.edge {
        Some([x0, y0, x1, y1]) => EdgeLine::through(piece, [x0 - left, y0 - top, x1 - left, y1 - top])
            .ok_or_else(|| {
                MeasureError::new("`edge`: both points are the same, or the line misses the region")
            })?,
        None => EdgeLine::find(piece).map_err(|fault| no_edge(name, fault))?,
    };
    let angle = line.across[1].atan2(line.across[0]).to_degrees();
    let [x, y] = [line.point[0] + left, line.point[1] + top];
    say(Remark::Finding(format!("edge through ({x:.1}, {y:.1}), light at {angle:.1}° below the right")));
    Ok(line)
}

/// The place of the spot in a region, around the center that is stated or found.
pub(crate) fn spot_place(
    piece: &Photo,
    [left, top]: [f64; 2],
    name: &str,
    options: &Options,
    say: &mut dyn FnMut(Remark),
) -> Result<SpotPlace, MeasureError> {
    let place = match options.center {
        Some([x, y]) => SpotPlace::around(piece, [x - left, y - top])
            .ok_or_else(|| MeasureError::new(format!("`center`: {x},{y} is not in the region")))?,
        None => SpotPlace::find(piece).map_err(|fault| no_spot(name, fault))?,
    };
    let [x, y] = [place.center[0] + left, place.center[1] + top];
    say(Remark::Finding(format!("spot around ({x:.1}, {y:.1}), {:.1} pixels to half its light", place.half)));
    Ok(place)
}

fn no_edge(name: &str, fault: NoEdge) -> MeasureError {
    let message = match fault {
        NoEdge::TooSmall => String::from("fewer than 16 pixels on a side"),
        NoEdge::NoContrast(contrast) => format!(
            "no edge of light: the brightest tenth is {contrast:.2} times as bright as the darkest, and must be 1.5 times"
        ),
        NoEdge::NotStraight(distance) if distance.is_finite() => {
            format!("no straight edge: where light is half as bright is {distance:.0} pixels off a line")
        }
        NoEdge::NotStraight(_) => String::from("no edge that goes through the picture from side to side"),
    };
    let help = "show the edge alone by `region`, or where it is by `edge`";
    MeasureError::of_photo(name, message).with_help(help)
}

fn no_spot(name: &str, fault: NoSpot) -> MeasureError {
    let message = match fault {
        NoSpot::TooSmall => String::from("fewer than 16 pixels on a side"),
        NoSpot::NoContrast(contrast) => format!(
            "no spot of light: the brightest pixels are {contrast:.2} times as bright as the darkest tenth, and must be 1.5 times"
        ),
        NoSpot::FewPixels(count) => {
            format!("no spot of light: {count} pixels are half as bright as the brightest, and must be 12")
        }
        NoSpot::Several(count) => format!("{count} spots of light of similar size, and one is needed"),
        NoSpot::OutOfFrame => String::from("the spot of light goes on beyond the picture"),
        NoSpot::NotRound(ratio) => format!(
            "no round spot: what is bright spreads {ratio:.1} times as far as in a disk, by its mean square, and may 1.4 times"
        ),
    };
    let help = "show the spot alone by `region`, or where its center is by `center`";
    MeasureError::of_photo(name, message).with_help(help)
}
