//! Rectangles, and the parts of lines and polygons that are inside of them.

/// A rectangle \[px\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Area {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
}

impl Area {
    pub(crate) fn contains(&self, [x, y]: [f64; 2]) -> bool {
        const SLACK: f64 = 0.01;
        (self.left - SLACK..=self.right + SLACK).contains(&x)
            && (self.top - SLACK..=self.bottom + SLACK).contains(&y)
    }

    /// The rectangle with a margin.
    pub(crate) fn grown(&self, by: f64) -> Self {
        Self { left: self.left - by, top: self.top - by, right: self.right + by, bottom: self.bottom + by }
    }

    /// The part of a segment that is inside \[Liang & Barsky 1984\].
    pub(crate) fn part(&self, [a, b]: [[f64; 2]; 2]) -> Option<[[f64; 2]; 2]> {
        let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
        let (mut start, mut end) = (0_f64, 1_f64);
        let edges = [
            (-dx, a[0] - self.left),
            (dx, self.right - a[0]),
            (-dy, a[1] - self.top),
            (dy, self.bottom - a[1]),
        ];
        for (p, q) in edges {
            if p == 0.0 {
                if q < 0.0 {
                    return None;
                }
            } else if p < 0.0 {
                start = start.max(q / p);
            } else {
                end = end.min(q / p);
            }
        }
        let at = |t: f64| [a[0] + t * dx, a[1] + t * dy];
        (start < end).then(|| [at(start), at(end)])
    }

    /// The pieces of a line that are inside.
    pub(crate) fn pieces(&self, line: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
        let mut pieces: Vec<Vec<[f64; 2]>> = Vec::new();
        for ends in line.windows(2) {
            let Some([a, b]) = self.part([ends[0], ends[1]]) else { continue };
            match pieces.last_mut().filter(|piece| piece.last() == Some(&a)) {
                Some(piece) => piece.push(b),
                None => pieces.push(vec![a, b]),
            }
        }
        pieces
    }

    /// The part of a polygon that is inside \[Sutherland & Hodgman 1974\].
    pub(crate) fn part_of_polygon(&self, corners: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let sides: [(usize, f64, f64); 4] =
            [(0, self.left, 1.0), (0, self.right, -1.0), (1, self.top, 1.0), (1, self.bottom, -1.0)];
        let mut inside = corners.to_vec();
        for (axis, edge, sign) in sides {
            let depth = |point: [f64; 2]| sign * (point[axis] - edge);
            let before = std::mem::take(&mut inside);
            for (i, &b) in before.iter().enumerate() {
                let a = before[(i + before.len() - 1) % before.len()];
                let [from, to] = [depth(a), depth(b)];
                if (from < 0.0) != (to < 0.0) {
                    let t = from / (from - to);
                    inside.push([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
                }
                if to >= 0.0 {
                    inside.push(b);
                }
            }
        }
        inside
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AREA: Area = Area { left: 0.0, top: 0.0, right: 10.0, bottom: 10.0 };

    #[test]
    fn pieces_end_at_the_edges() {
        let line = [[-5.0, 5.0], [5.0, 5.0], [5.0, 15.0], [8.0, 15.0], [8.0, 5.0]];
        let pieces = AREA.pieces(&line);
        assert_eq!(pieces, [vec![[0.0, 5.0], [5.0, 5.0], [5.0, 10.0]], vec![[8.0, 10.0], [8.0, 5.0]]]);
    }

    #[test]
    fn polygons_are_cut_at_the_edges() {
        let inside = AREA.part_of_polygon(&[[-5.0, -5.0], [20.0, -5.0], [20.0, 5.0], [-5.0, 5.0]]);
        assert!(inside.iter().all(|&point| AREA.contains(point)));
        let area: f64 = (0..inside.len())
            .map(|i| {
                let (a, b) = (inside[i], inside[(i + 1) % inside.len()]);
                a[0] * b[1] - a[1] * b[0]
            })
            .sum();
        assert!((0.5 * area.abs() - 50.0).abs() < 1e-9);
    }
}
