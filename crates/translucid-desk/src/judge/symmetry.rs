//! Places of edges and lines of light to a small part of a pixel, by the symmetry that light has beside them.
//!
//! Whatever spreads light alike in all directions, what an edge lacks on the lit side is on the dark one: light is odd around
//! half of it. Beside a line it is even. So with the light v along a row, for every half width w,
//!
//! ```text
//! edge at p    ∫ v over [p − w, p + w] = w (v(p − w) + v(p + w))
//! line at p    ∫ v over [p − w, p]     = ∫ v over [p, p + w]
//! ```
//!
//! Integrals do not mind where pixels are, as a level at which light is half as bright does.
//! Noise of a pixel moves the place of an edge by some w times as much, so that narrow widths weigh most, by w⁻².

use translucid_measure::{EdgeLine, Photo};

/// Least half width in pixels.
const LEAST_WIDTH: f64 = 6.0;
/// Steps of Newton's method, each of a pixel at most, and the step that ends it.
const STEPS: usize = 60;
const ENOUGH: f64 = 1e-7;

/// Light along a row or a column, straight between the middles of pixels.
pub(super) struct Row {
    values: Vec<f64>,
    /// Integral from the first pixel's middle to that of each.
    sums: Vec<f64>,
}

impl Row {
    pub(super) fn new(values: Vec<f64>) -> Self {
        let mut sums = vec![0.0];
        for pair in values.windows(2) {
            sums.push(sums[sums.len() - 1] + 0.5 * (pair[0] + pair[1]));
        }
        Self { values, sums }
    }

    /// Light at a place, and its integral up to there.
    fn at(&self, x: f64) -> [f64; 2] {
        let last = self.values.len() - 2;
        let place = (x - 0.5).clamp(0.0, (last + 1) as f64);
        let i = (place as usize).min(last);
        let part = place - i as f64;
        let value = self.values[i] + part * (self.values[i + 1] - self.values[i]);
        [value, self.sums[i] + 0.5 * part * (self.values[i] + value)]
    }

    /// Greatest half width around a place that moves by a pixel or two.
    fn reach(&self, x: f64) -> f64 {
        x.min(self.values.len() as f64 - x) - 3.0
    }

    /// Place of an edge near another one; none too close to the end of the row.
    fn edge(&self, near: f64) -> Option<f64> {
        self.solve(near, |p, reach| {
            let (mut off, mut slope) = (0.0, 0.0);
            for w in (0..).map(|i| LEAST_WIDTH + f64::from(i)).take_while(|w| *w <= reach) {
                let ([left, before], [right, after]) = (self.at(p - w), self.at(p + w));
                off += (after - before - w * (left + right)) / (w * w);
                slope += (right - left) / (w * w);
            }
            off / slope
        })
    }

    /// Middle of a line near another place.
    pub(super) fn line(&self, near: f64) -> Option<f64> {
        self.solve(near, |p, reach| {
            let [[left, before], [middle, half], [right, after]] =
                [p - reach, p, p + reach].map(|x| self.at(x));
            (2.0 * half - before - after) / (2.0 * middle - left - right)
        })
    }

    /// Where a distance, of the place from the one that is sought, is 0.
    fn solve(&self, near: f64, distance: impl Fn(f64, f64) -> f64) -> Option<f64> {
        let (reach, mut p) = (self.reach(near), near);
        if reach < LEAST_WIDTH {
            return None;
        }
        for _ in 0..STEPS {
            let step = distance(p, reach);
            if !step.is_finite() || (p - near).abs() > 3.0 {
                return None;
            }
            p -= step.clamp(-1.0, 1.0);
            if step.abs() < ENOUGH {
                return Some(p);
            }
        }
        None
    }
}

/// The edge near a line that was found to a pixel: a straight line through its places in all rows, or columns.
pub(super) fn edge(photo: &Photo, near: &EdgeLine) -> Option<EdgeLine> {
    let is_upright = near.across[0].abs() >= near.across[1].abs();
    let turn = |[x, y]: [f64; 2]| if is_upright { [x, y] } else { [y, x] };
    let ([across, along], [x, y]) = (turn(near.across), turn(near.point));
    let (rows, length) = if is_upright { (photo.height, photo.width) } else { (photo.width, photo.height) };
    let gray = |row: usize, i: usize| {
        let [r, g, b] = if is_upright { photo.at(i, row) } else { photo.at(row, i) };
        f64::from(r) + f64::from(g) + f64::from(b)
    };
    let place = |row: usize| {
        let line = row as f64 + 0.5;
        let values = Row::new((0..length).map(|i| gray(row, i)).collect());
        Some([line, values.edge(x - (line - y) * along / across)?])
    };
    let places: Vec<[f64; 2]> = (0..rows).filter_map(place).collect();
    if places.len() < rows / 3 {
        return None;
    }
    // Least squares
    let count = places.len() as f64;
    let mean = [0, 1].map(|i| places.iter().map(|place| place[i]).sum::<f64>() / count);
    let moment =
        |i: usize| -> f64 { places.iter().map(|place| (place[0] - mean[0]) * (place[i] - mean[i])).sum() };
    let slope = moment(1) / moment(0).max(f64::MIN_POSITIVE);
    let norm = across.signum() / (1.0 + slope * slope).sqrt();
    Some(EdgeLine { point: turn([mean[1], mean[0]]), across: turn([norm, -slope * norm]) })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Odd light that is steepest at 0, as under a surface, the mean over a pixel's width.
    fn odd(x: f64) -> f64 {
        let at = |x: f64| x.signum() * x.abs().powf(0.9) / (3.0 + x.abs().powf(0.9));
        (0..16).map(|i| at(x + (f64::from(i) + 0.5) / 16.0 - 0.5)).sum::<f64>() / 16.0
    }

    #[test]
    fn edges_are_found_at_every_place_and_angle() {
        for (degrees, offset) in [
            (0.0, 0.0),
            (0.0, 0.23),
            (0.0, 0.5),
            (90.0, 0.5),
            (180.0, 0.31),
            (3.0, 0.4),
            (30.0, 0.7),
            (45.0, 0.1),
            (250.0, 0.2),
        ] {
            let (sin, cos) = f64::to_radians(degrees).sin_cos();
            let center = [60.0 + offset, 50.0 + offset];
            let light = |x: usize, y: usize| {
                let d = (x as f64 + 0.5 - center[0]) * cos + (y as f64 + 0.5 - center[1]) * sin;
                [0.5 + 0.5 * odd(d) as f32, 0.3, 0.5 + 0.25 * odd(d) as f32]
            };
            let photo = Photo::from_fn(120, 100, light);
            let rough = EdgeLine::find(&photo).unwrap();
            let found = edge(&photo, &rough).unwrap_or_else(|| panic!("{degrees} {offset}: {rough:?}"));
            let turned = found.across[0] * sin - found.across[1] * cos;
            assert!(
                turned.abs() < 1e-3 && found.across[0] * cos + found.across[1] * sin > 0.9,
                "{degrees}: {found:?}"
            );
            let off = found.distance_of(center[0], center[1]);
            assert!(off.abs() < 0.03, "{degrees} {offset}: {off}");
        }
    }

    #[test]
    fn lines_are_found_at_every_place() {
        for middle in [40.0, 40.2, 40.5, 43.9] {
            let row = Row::new((0..80).map(|i| 1.0 - odd(f64::from(i) + 0.5 - middle).abs()).collect());
            let found = row.line(middle + 0.6).unwrap();
            assert!((found - middle).abs() < 0.02, "{middle}: {found}");
        }
        assert_eq!(Row::new(vec![1.0; 80]).line(40.0), None);
        assert_eq!(Row::new((0..80).map(f64::from).collect()).edge(3.0), None);
    }
}
