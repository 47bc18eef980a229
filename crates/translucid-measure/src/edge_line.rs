//! Where the card ends in a photograph, and the light across that line.

use crate::linear_photo::Photo;
use crate::samples::Samples;

/// A straight line through a photograph, in pixels: x to the right, y down, (0.5, 0.5) the middle of the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeLine {
    /// A point of it.
    pub point: [f64; 2],
    /// Unit vector across it, toward the light.
    pub across: [f64; 2],
}

/// Why no line was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoEdge {
    /// Fewer than 16 pixels in a direction.
    TooSmall,
    /// The brightest tenth over the darkest: less than 1.5.
    NoContrast(f64),
    /// The places where light is half as bright are that far off a straight line, in pixels.
    NotStraight(f64),
}

/// Blocks along the edge.
const BLOCKS: usize = 24;

/// Least contrast of an edge.
const LEAST_CONTRAST: f64 = 1.5;

/// Where half the light is may be this part of the extent off a line.
const STRAIGHT: f64 = 0.04;

/// Fewest lit pixels of a row whose light is its own.
const FEWEST_LIT: usize = 8;

impl EdgeLine {
    /// The line along which light is half as bright.
    ///
    /// # Errors
    /// There is no straight edge between dark and light.
    pub fn find(photo: &Photo) -> Result<Self, NoEdge> {
        let [width, height] = [photo.width, photo.height];
        if width < 16 || height < 16 {
            return Err(NoEdge::TooSmall);
        }
        let mut values: Vec<f64> = (0..width * height).map(|i| photo.gray(i % width, i / width)).collect();
        let tenth = values.len() / 10;
        let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
        let dark = mean(values.select_nth_unstable_by(tenth, f64::total_cmp).0);
        let last = values.len() - tenth - 1;
        let lit = mean(values.select_nth_unstable_by(last, f64::total_cmp).2);
        let contrast = lit / dark.max(1e-6 * lit);
        if !contrast.is_finite() || contrast < LEAST_CONTRAST {
            return Err(NoEdge::NoContrast(if contrast.is_finite() { contrast } else { 1.0 }));
        }

        // The sum of all slopes points across: inner ones cancel, and the differences of opposite borders stay
        let border = |is_end: bool| {
            let column: f64 = (0..height).map(|y| photo.gray(if is_end { width - 1 } else { 0 }, y)).sum();
            let row: f64 = (0..width).map(|x| photo.gray(x, if is_end { height - 1 } else { 0 })).sum();
            [column, row]
        };
        let ([left, top], [right, bottom]) = (border(false), border(true));
        let mut across = unit([right - left, bottom - top]).ok_or(NoEdge::NotStraight(f64::INFINITY))?;

        // Through the places of each row (or column) at which light is half as bright
        let overall = 0.5 * (dark + lit);
        let is_upright = across[0].abs() >= across[1].abs();
        let (count, length) = if is_upright { (height, width) } else { (width, height) };
        let is_rising = across[usize::from(!is_upright)] > 0.0;
        let value = |line: usize, i: usize| {
            let i = if is_rising { i } else { length - 1 - i };
            if is_upright { photo.gray(i, line) } else { photo.gray(line, i) }
        };
        let crossing = |line: usize| {
            let half = half_of((0..length).map(|i| value(line, i)), dark, overall);
            // The place that parts what is dark from what is lit with the fewest on the wrong side
            let mut wrong = (0..length).filter(|&i| value(line, i) < half).count() as i64;
            let (mut best, mut place) = (wrong, 0);
            for i in 0..length {
                wrong += if value(line, i) < half { -1 } else { 1 };
                if wrong < best {
                    (best, place) = (wrong, i + 1);
                }
            }
            let is_inside = place > 1 && place + 1 < length;
            let place = if is_rising { place as f64 } else { (length - place) as f64 };
            is_inside.then_some((line as f64 + 0.5, place))
        };
        let crossings: Vec<(f64, f64)> = (0..count).filter_map(crossing).collect();
        if crossings.len() < count / 2 {
            return Err(NoEdge::NotStraight(f64::INFINITY));
        }
        let (slope, start) = straight(&crossings);
        let off = |(line, place): &(f64, f64)| (place - start - slope * line).abs();
        let mut distances: Vec<f64> = crossings.iter().map(off).collect();
        distances.sort_by(f64::total_cmp);
        let typical = distances[distances.len() * 2 / 3];
        if typical > (STRAIGHT * length as f64).max(1.0) {
            return Err(NoEdge::NotStraight(typical));
        }
        let sign = if is_rising { 1.0 } else { -1.0 };
        let norm = sign / (1.0 + slope * slope).sqrt();
        let middle = 0.5 * count as f64;
        let place = start + slope * middle;
        let (normal, point) = ([norm, -slope * norm], [place, middle]);
        across = if is_upright { normal } else { [normal[1], normal[0]] };
        let point = if is_upright { point } else { [point[1], point[0]] };
        Ok(Self { point, across })
    }

    /// The line through two points, with the brighter side of a photograph ahead; `None` where the points are one or the
    /// photograph lies on one side of it.
    pub fn through(photo: &Photo, [x0, y0, x1, y1]: [f64; 4]) -> Option<Self> {
        let across = unit([y1 - y0, x0 - x1])?;
        let line = Self { point: [0.5 * (x0 + x1), 0.5 * (y0 + y1)], across };
        let mut sides = [(0.0, 0.0); 2];
        for i in 0..photo.width * photo.height {
            let (x, y) = (i % photo.width, i / photo.width);
            let side = &mut sides[usize::from(line.distance(x, y) > 0.0)];
            *side = (side.0 + photo.gray(x, y), side.1 + 1.0);
        }
        if sides.iter().any(|(_, count)| *count == 0.0) {
            return None;
        }
        let [behind, ahead] = sides.map(|(sum, count): (f64, f64)| sum / count.max(1.0));
        let sign = if ahead >= behind { 1.0 } else { -1.0 };
        Some(Self { across: across.map(|v| v * sign), ..line })
    }

    /// Distance of a pixel's middle in pixels, positive on the lit side.
    pub fn distance(&self, x: usize, y: usize) -> f64 {
        self.distance_of(x as f64 + 0.5, y as f64 + 0.5)
    }

    /// Distance of a place in pixels, positive on the lit side.
    pub fn distance_of(&self, x: f64, y: f64) -> f64 {
        (x - self.point[0]) * self.across[0] + (y - self.point[1]) * self.across[1]
    }

    /// How far along the line a place is, in pixels.
    pub fn along(&self, x: f64, y: f64) -> f64 {
        (y - self.point[1]) * self.across[0] - (x - self.point[0]) * self.across[1]
    }

    /// Light by the distance across, in steps of a pixel, in the rectangle along the line that holds the most.
    pub fn samples(&self, photo: &Photo, pixel_width: f64) -> Samples {
        // A line that is not upright leaves corners that a rectangle does not hold
        let lengths = (2..=10).map(|i| 0.1 * f64::from(i));
        let all = lengths.map(|part| (part, self.samples_of(photo, pixel_width, part)));
        let best =
            all.max_by(|(a, x), (b, y)| (a * x.places.len() as f64).total_cmp(&(b * y.places.len() as f64)));
        best.map_or_else(|| self.samples_of(photo, pixel_width, 1.0), |(_, samples)| samples)
    }

    /// The samples of a part of the line around its middle, as far across as every block has pixels.
    fn samples_of(&self, photo: &Photo, pixel_width: f64, part: f64) -> Samples {
        let along = |x: usize, y: usize| self.along(x as f64 + 0.5, y as f64 + 0.5);
        let [right, bottom] = [photo.width.saturating_sub(1), photo.height.saturating_sub(1)];
        let corners = [[0, 0], [right, 0], [0, bottom], [right, bottom]];
        let extent = |value: &dyn Fn(usize, usize) -> f64| {
            corners.iter().fold((f64::MAX, f64::MIN), |(low, high), &[x, y]| {
                let v = value(x, y);
                (low.min(v), high.max(v))
            })
        };
        let (near, far) = extent(&|x, y| self.distance(x, y));
        let (first, last) = extent(&along);
        let middle = 0.5 * (first + last);
        let (first, last) = (middle + part * (first - middle), middle + part * (last - middle));
        let (low, bins) = (near.floor(), (far.floor() - near.floor()) as usize + 1);
        let mut sums = vec![([0.0; 3], 0.0); BLOCKS * bins];
        for (x, y) in (0..photo.width * photo.height).map(|i| (i % photo.width, i / photo.width)) {
            if !(first..=last).contains(&along(x, y)) {
                continue;
            }
            let block = ((along(x, y) - first) / (last - first + 1e-9) * BLOCKS as f64) as usize;
            let bin = (self.distance(x, y) - low) as usize;
            let (sum, count): &mut ([f64; 3], f64) =
                &mut sums[block.min(BLOCKS - 1) * bins + bin.min(bins - 1)];
            for (sum, value) in sum.iter_mut().zip(photo.at(x, y)) {
                *sum += f64::from(value);
            }
            *count += 1.0;
        }
        let is_seen = |bin: &usize| (0..BLOCKS).all(|block| sums[block * bins + bin].1 > 0.0);
        let seen: Vec<usize> = (0..bins).filter(is_seen).collect();
        let block = |block: usize| {
            let mean = |bin: &usize| {
                let (sum, count) = sums[block * bins + bin];
                sum.map(|v| v / count)
            };
            seen.iter().map(mean).collect()
        };
        Samples {
            places: seen.iter().map(|bin| (low + *bin as f64 + 0.5) * pixel_width).collect(),
            pixel_width,
            blocks: (0..BLOCKS).map(block).collect(),
            along: [first, last].map(|v| v * pixel_width),
        }
    }
}

/// Half the light of a row in uneven light: between the dark and the row's lit side, where it has one.
fn half_of(row: impl Iterator<Item = f64>, dark: f64, overall: f64) -> f64 {
    let mut lit: Vec<f64> = row.filter(|v| *v > overall).collect();
    if lit.len() < FEWEST_LIT {
        return overall;
    }
    let middle = lit.len() / 2;
    0.5 * (dark + *lit.select_nth_unstable_by(middle, f64::total_cmp).1)
}

fn unit([x, y]: [f64; 2]) -> Option<[f64; 2]> {
    let length = x.hypot(y);
    (length > 0.0 && length.is_finite()).then(|| [x / length, y / length])
}

/// Slope and height at 0 of a straight line through points: the median of the slopes of pairs that are far apart, and of the
/// heights, which outliers do not move [H. Theil 1950].
pub(crate) fn straight(points: &[(f64, f64)]) -> (f64, f64) {
    let half = points.len() / 2;
    let slope = |i: usize| {
        let ((x0, y0), (x1, y1)) = (points[i], points[i + half]);
        (y1 - y0) / (x1 - x0)
    };
    let slope = median((0..points.len() - half).filter(|_| half > 0).map(slope).collect());
    (slope, median(points.iter().map(|(x, y)| y - slope * x).collect()))
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use translucid_testing::SplitMix;

    use super::*;

    /// A soft edge through (40.3, 28.7), light in the direction of an angle in degrees.
    fn photo(angle: f64, noise: f64) -> Photo {
        let (sin, cos) = libm::sincos(angle.to_radians());
        let mut random = SplitMix(3);
        let noise: Vec<f64> = (0..80 * 60).map(|_| noise * (random.uniform() - 0.5)).collect();
        Photo::from_fn(80, 60, |x, y| {
            let distance = (x as f64 + 0.5 - 40.3) * cos + (y as f64 + 0.5 - 28.7) * sin;
            let light = 0.1 + 0.4 * (1.0 + libm::tanh(distance / 4.0)) + noise[y * 80 + x];
            [light as f32; 3]
        })
    }

    #[test]
    fn edge_is_found_at_every_angle() {
        for angle in (0..24).map(|i| 15.0 * f64::from(i) + 3.0) {
            let line = EdgeLine::find(&photo(angle, 0.1)).unwrap();
            let (sin, cos) = libm::sincos(angle.to_radians());
            let turned = line.across[0] * sin - line.across[1] * cos;
            assert!(turned.abs() < 0.03, "{angle}: {line:?}");
            assert!(line.across[0] * cos + line.across[1] * sin > 0.9, "{angle}: {line:?}");
            let off = (40.3 - line.point[0]) * cos + (28.7 - line.point[1]) * sin;
            assert!(off.abs() < 1.0, "{angle}: {off}");
        }
    }

    #[test]
    fn given_line_finds_its_lit_side() {
        let (found, photo) = (EdgeLine::find(&photo(0.0, 0.0)).unwrap(), photo(0.0, 0.0));
        let [x, _] = found.point;
        for ends in [[x, 0.0, x, 60.0], [x, 60.0, x, 0.0]] {
            let line = EdgeLine::through(&photo, ends).unwrap();
            assert!((line.across[0] - 1.0).abs() < 1e-12, "{line:?}");
        }
        assert_eq!(EdgeLine::through(&photo, [3.0, 3.0, 3.0, 3.0]), None);
        assert_eq!(EdgeLine::through(&photo, [90.0, 3.0, 91.0, 60.0]), None);
    }

    #[test]
    fn samples_are_those_of_the_edge() {
        let photo = photo(20.0, 0.0);
        let samples = EdgeLine::find(&photo).unwrap().samples(&photo, 0.5);
        assert!(samples.places.len() > 16 && samples.blocks.len() == BLOCKS);
        assert!(samples.places.is_sorted());
        for (i, x) in samples.places.iter().enumerate() {
            let expected = 0.1 + 0.4 * (1.0 + libm::tanh(x / 0.5 / 4.0));
            for block in &samples.blocks {
                assert!((block[i][1] - expected).abs() < 0.12, "{x}: {} {expected}", block[i][1]);
            }
        }
    }

    #[test]
    fn what_is_no_edge_is_refused() {
        let even = Photo::from_fn(40, 40, |_, _| [0.5; 3]);
        assert!(matches!(EdgeLine::find(&even), Err(NoEdge::NoContrast(_))));
        let black = Photo::from_fn(40, 40, |_, _| [0.0; 3]);
        assert!(matches!(EdgeLine::find(&black), Err(NoEdge::NoContrast(_))));
        let spot = Photo::from_fn(60, 60, |x, y| {
            let r = (x as f32 - 30.0).hypot(y as f32 - 30.0);
            [if r < 12.0 { 1.0 } else { 0.1 }; 3]
        });
        assert!(EdgeLine::find(&spot).is_err());
        let mut random = SplitMix(5);
        let noise: Vec<f32> = (0..3600).map(|_| random.uniform_f32()).collect();
        assert!(EdgeLine::find(&Photo::from_fn(60, 60, |x, y| [noise[60 * y + x]; 3])).is_err());
        assert_eq!(EdgeLine::find(&Photo::from_fn(8, 40, |_, _| [0.5; 3])), Err(NoEdge::TooSmall));
        let nan = Photo::from_fn(40, 40, |_, _| [f32::NAN; 3]);
        assert!(EdgeLine::find(&nan).is_err());
    }
}
