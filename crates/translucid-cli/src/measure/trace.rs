//! Place of the light's shape in a photograph: the line of an edge, or the middle and radius of a spot.

use std::path::Path;

use translucid_measure::{EdgeLine, NoEdge, NoSpot, Photo, SpotPlace};

use super::arguments::MeasureArguments;
use super::photograph::refusal;
use crate::failure::Failure;
use crate::messages;

/// Place of the light's shape in the region.
#[derive(Clone, Copy, Debug)]
pub(super) enum Trace {
    Line(EdgeLine),
    Spot(SpotPlace),
}

impl Trace {
    /// Distance of a pixel from the line, or from the circle in which a spot is half as bright, in pixels.
    pub(super) fn distance(&self, x: usize, y: usize) -> f64 {
        match self {
            Self::Line(line) => line.distance(x, y).abs(),
            Self::Spot(place) => (place.distance(x, y) - place.half).abs(),
        }
    }
}

/// The line of the edge, stated or found, of which the place is printed.
pub(super) fn edge_line(
    piece: &Photo,
    arguments: &MeasureArguments,
    region: [usize; 4],
) -> Result<EdgeLine, Failure> {
    let [left, top] = [region[0] as f64, region[1] as f64];
    let line = match arguments.edge {
        Some([x0, y0, x1, y1]) => EdgeLine::through(piece, [x0 - left, y0 - top, x1 - left, y1 - top])
            .ok_or_else(|| {
                Failure::input("--edge: both points are the same, or the line misses the region")
            })?,
        None => EdgeLine::find(piece).map_err(|fault| no_edge(&arguments.photo, fault))?,
    };
    let angle = line.across[1].atan2(line.across[0]).to_degrees();
    let [x, y] = [line.point[0] + left, line.point[1] + top];
    messages::line(&format!("edge through ({x:.1}, {y:.1}), light at {angle:.1}° below the right"));
    Ok(line)
}

/// The place of the spot around the middle that is stated or found, which is printed.
pub(super) fn spot_place(
    piece: &Photo,
    arguments: &MeasureArguments,
    [left, top]: [f64; 2],
) -> Result<SpotPlace, Failure> {
    let place = match arguments.center {
        Some([x, y]) => SpotPlace::around(piece, [x - left, y - top])
            .ok_or_else(|| Failure::input(format!("--center: {x},{y} is not in the region")))?,
        None => SpotPlace::find(piece).map_err(|fault| no_spot(&arguments.photo, fault))?,
    };
    let [x, y] = place.center;
    messages::line(&format!(
        "spot around ({:.1}, {:.1}), {:.1} pixels to half its light",
        x + left,
        y + top,
        place.half
    ));
    Ok(place)
}

/// Radius in pixels of the core in which light is lost; refuses one beyond which too little is left.
pub(super) fn check_core(piece: &Photo, place: &SpotPlace, path: &Path) -> Result<f64, Failure> {
    let core = place.core(piece);
    let [x, y] = place.center;
    let reach = x.min(y).min(piece.width as f64 - x).min(piece.height as f64 - y);
    if core > 0.5 * reach {
        let message = format!(
            "the spot is saturated: light is lost up to {core:.0} pixels from its middle, of {reach:.0} pixels that are seen all around"
        );
        return Err(refusal(path, message).with_help("expose less, or add a shorter --exposure"));
    }
    if core > 0.0 {
        messages::print_warning(&format!(
            "{}: light is lost up to {core:.0} pixels from the middle of the spot: that core is left out",
            path.display()
        ));
    }
    Ok(core)
}

fn no_edge(path: &Path, fault: NoEdge) -> Failure {
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
    refusal(path, message).with_help("show the edge alone by --region, or where it is by --edge")
}

fn no_spot(path: &Path, fault: NoSpot) -> Failure {
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
    refusal(path, message).with_help("show the spot alone by --region, or where its middle is by --center")
}
