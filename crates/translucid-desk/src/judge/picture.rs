//! The picture of a pass, averaged by the distance from what is lit.

use std::path::Path;

use translucid_laboratory::judge::{Bins, Setup};
use translucid_load::load_exr;
use translucid_measure::{EdgeLine, NoEdge, NoSpot, Photo, SpotPlace};
use translucid_scene::linear_from_srgb;
use translucid_words::{Error, Place};

use super::symmetry::{self, Row};

/// Bins of red, green and blue; a message if the lit shape is not found.
pub(super) fn averaged(photo: &Photo, setup: Setup, pixel: f64) -> Result<[Bins; 3], String> {
    let place = Location::find(photo, setup)?;
    Ok([0, 1, 2].map(|channel| bins(photo, channel, &place, pixel)))
}

/// Greatest code of a picture that may be one of codes, with some noise.
const GREATEST_CODE: f32 = 1.25;

/// The picture as if its numbers were codes of sRGB; none if they cannot be.
pub(super) fn decoded(photo: &Photo) -> Option<Photo> {
    let all = (0..photo.height).flat_map(|y| (0..photo.width).map(move |x| (x, y)));
    let is_code = |(x, y)| photo.at(x, y).iter().all(|value| value.abs() <= GREATEST_CODE);
    let light =
        |x: usize, y: usize| photo.at(x, y).map(|value| linear_from_srgb(value.abs()).copysign(value));
    all.into_iter().all(is_code).then(|| Photo::from_fn(photo.width, photo.height, light))
}

/// The three channels, all of whose values must be numbers.
pub(super) fn load(path: &Path) -> Result<Photo, Error> {
    let file = load_exr(path)?;
    let refuse = |message: String| Error::at(Place::file(path), message);
    let mut planes = Vec::new();
    for name in ["R", "G", "B"] {
        let Some((_, values)) = file.channels.iter().find(|(found, _)| found == name) else {
            let names: Vec<&str> = file.channels.iter().map(|(name, _)| name.as_str()).collect();
            return Err(refuse(format!("has no channel {name}: its channels are {}", names.join(", "))));
        };
        if let Some(i) = values.iter().position(|value| !value.is_finite()) {
            let [x, y] = [i % file.size[0], i / file.size[0]];
            return Err(refuse(format!(
                "channel {name} is {} at the pixel {x},{y}, but must be a number",
                values[i]
            )));
        }
        planes.push(values);
    }
    let [width, height] = file.size;
    Ok(Photo::from_fn(width, height, |x, y| [0, 1, 2].map(|c| planes[c][y * width + x])))
}

/// Where the lit shape is.
enum Location {
    Edge(EdgeLine),
    Disk(SpotPlace),
    /// Along columns or rows, with its middle at that column or row.
    Line {
        is_upright: bool,
        middle: f64,
    },
}

impl Location {
    fn find(photo: &Photo, setup: Setup) -> Result<Self, String> {
        match setup {
            Setup::Edge => EdgeLine::find(photo).map_err(|fault| match fault {
                NoEdge::TooSmall => String::from(TOO_SMALL),
                NoEdge::NoContrast(contrast) => {
                    format!("no edge of light: its brightest tenth is {contrast:.2} times its darkest, and must be 1.5 times")
                }
                NoEdge::NotStraight(_) => String::from("no straight edge of light from side to side"),
            }).and_then(|line| Self::edge(photo, &line)),
            Setup::Disk { .. } => SpotPlace::find(photo).map(Self::Disk).map_err(|fault| match fault {
                NoSpot::TooSmall => String::from(TOO_SMALL),
                NoSpot::NoContrast(contrast) => {
                    format!("no disk of light: its brightest pixels are {contrast:.2} times its darkest tenth, and must be 1.5 times")
                }
                NoSpot::FewPixels(count) => format!("no disk of light: {count} bright pixels, and 12 are needed"),
                NoSpot::Several(count) => format!("{count} disks of light, and one is needed"),
                NoSpot::OutOfFrame => String::from("the disk of light goes on beyond the picture"),
                NoSpot::NotRound(_) => String::from("no round disk of light"),
            }),
            Setup::Line { .. } => Self::line(photo),
        }
    }

    /// An edge to a small part of a pixel: its place is an error of the width.
    fn edge(photo: &Photo, line: &EdgeLine) -> Result<Self, String> {
        let found = symmetry::edge(photo, line).map(Self::Edge);
        found.ok_or_else(|| {
            String::from(
                "the edge of light is too close to the picture's border, or the light's width too large for the picture: show more of the plane",
            )
        })
    }

    /// The brightest band along columns or rows.
    fn line(photo: &Photo) -> Result<Self, String> {
        if photo.width < 16 || photo.height < 16 {
            return Err(String::from(TOO_SMALL));
        }
        let columns = means(photo.width, photo.height, |i, k| photo.at(i, k));
        let rows = means(photo.height, photo.width, |i, k| photo.at(k, i));
        let spread = |means: &[f64]| {
            let mean = means.iter().sum::<f64>() / means.len() as f64;
            means.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / means.len() as f64
        };
        let is_upright = spread(&columns) >= spread(&rows);
        let means = if is_upright { columns } else { rows };
        let [least, most] =
            [f64::min, f64::max].map(|choose| means.iter().copied().reduce(choose).unwrap_or(0.0));
        if most < 1.5 * least || most <= 0.0 {
            return Err(String::from(
                "no line of light along rows or columns: the brightest is less than 1.5 times the darkest",
            ));
        }
        let bright: Vec<usize> = (0..means.len()).filter(|i| means[*i] > 0.5 * (least + most)).collect();
        let is_whole =
            bright.last().zip(bright.first()).is_some_and(|(last, first)| last - first + 1 == bright.len());
        if !is_whole || bright.contains(&0) || bright.contains(&(means.len() - 1)) {
            return Err(String::from("no single line of light with dark on both sides"));
        }
        let middle = bright.iter().map(|i| *i as f64 + 0.5).sum::<f64>() / bright.len() as f64;
        let middle = Row::new(means).line(middle).unwrap_or(middle);
        Ok(Self::Line { is_upright, middle })
    }

    /// Distance of a pixel's middle, in pixels, and whether it is along an axis or a diagonal as seen from a disk.
    fn of(&self, x: usize, y: usize) -> (f64, usize) {
        match self {
            Self::Edge(line) => (-line.distance(x, y), 0),
            Self::Line { is_upright, middle } => {
                let at = if *is_upright { x } else { y } as f64 + 0.5;
                ((at - middle).abs(), 0)
            }
            Self::Disk(spot) => {
                let [dx, dy] =
                    [x as f64 + 0.5 - spot.center[0], y as f64 + 0.5 - spot.center[1]].map(f64::abs);
                // Half of all directions are within 22.5 degrees of an axis
                (spot.distance(x, y), usize::from(dx.min(dy) > 0.414_213_6 * dx.max(dy)))
            }
        }
    }
}

const TOO_SMALL: &str = "is too small: fewer than 16 pixels on a side";

/// Means of the columns of a picture.
fn means(count: usize, length: usize, at: impl Fn(usize, usize) -> [f32; 3]) -> Vec<f64> {
    let gray = |i: usize, k: usize| at(i, k).iter().map(|value| f64::from(*value)).sum::<f64>() / 3.0;
    (0..count).map(|i| (0..length).map(|k| gray(i, k)).sum::<f64>() / length as f64).collect()
}

/// Means of the pixels in bins of a pixel.
fn bins(photo: &Photo, channel: usize, location: &Location, pixel: f64) -> Bins {
    let all = (0..photo.height).flat_map(|y| (0..photo.width).map(move |x| (x, y)));
    let mut sums = std::collections::BTreeMap::<i64, [Sums; 2]>::new();
    for (x, y) in all {
        let (distance, direction) = location.of(x, y);
        let sum = &mut sums.entry(distance.floor() as i64).or_default()[direction];
        sum.add(distance - distance.floor(), f64::from(photo.at(x, y)[channel]));
    }
    let is_disk = matches!(location, Location::Disk(_));
    let mut bins = Bins { directions: is_disk.then(Default::default), ..Bins::default() };
    for (first, [a, b]) in sums {
        let (count, value) = (a.count + b.count, (a.value + b.value) / (a.count + b.count));
        bins.places.push((first as f64 + (a.place + b.place) / count) * pixel);
        bins.values.push(value);
        // Each direction has its own light around a cross
        let [[left, free], [more, others]] = [a.scatter(), b.scatter()];
        let scatter = if free + others > 0.0 { ((left + more) / (free + others)).sqrt() } else { 0.0 };
        bins.scatter.push(scatter);
        bins.errors.push(scatter / count.sqrt());
        if let Some(directions) = &mut bins.directions {
            // One that has no pixels is as the other
            let mean = |own: Sums| if own.count > 0.0 { own.value / own.count } else { value };
            directions[0].push(mean(a));
            directions[1].push(mean(b));
        }
    }
    bins
}

/// Sums over the pixels of a bin, places counted from its beginning.
#[derive(Clone, Copy, Default)]
struct Sums {
    count: f64,
    place: f64,
    value: f64,
    /// Sums of the squares of places, of places times values, and of the squares of values.
    squares: [f64; 3],
}

impl Sums {
    fn add(&mut self, place: f64, value: f64) {
        self.count += 1.0;
        self.place += place;
        self.value += value;
        let [a, b, c] = self.squares;
        self.squares = [a + place * place, b + place * value, c + value * value];
    }

    /// Sum of squares that a straight line over the places leaves of the values, and its degrees of freedom.
    fn scatter(&self) -> [f64; 2] {
        let free = self.count - 2.0;
        if free <= 0.0 {
            return [0.0; 2];
        }
        let [place, value] = [self.place, self.value].map(|sum| sum / self.count);
        let [a, b, c] = self.squares;
        let [spread, both, all] =
            [a - self.count * place * place, b - self.count * place * value, c - self.count * value * value];
        let slope = if spread > 1e-6 * self.count { both / spread } else { 0.0 };
        [(all - slope * both).max(0.0), free]
    }
}
