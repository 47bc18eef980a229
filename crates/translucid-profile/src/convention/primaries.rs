//! Linear color spaces by name, and the matrices between them.

/// Three rows of three numbers.
pub type Matrix = [[f64; 3]; 3];

const D65: [f64; 2] = [0.3127, 0.329];
/// The white of ACES, near D60.
const ACES_WHITE: [f64; 2] = [0.32168, 0.33767];

/// Names of the linear color spaces that [`rgb_from_rgb`] knows.
pub const LINEAR_SPACES: [&str; 5] = ["lin_rec709", "acescg", "lin_displayp3", "lin_rec2020", "lin_adobergb"];

/// Chromaticities x, y of red, green, blue and white: ITU-R BT.709, ACES AP1 (S-2014-004), SMPTE EG 432-1 with D65,
/// ITU-R BT.2020, Adobe RGB (1998).
const PRIMARIES: [[[f64; 2]; 4]; 5] = [
    [[0.64, 0.33], [0.3, 0.6], [0.15, 0.06], D65],
    [[0.713, 0.293], [0.165, 0.83], [0.128, 0.044], ACES_WHITE],
    [[0.68, 0.32], [0.265, 0.69], [0.15, 0.06], D65],
    [[0.708, 0.292], [0.17, 0.797], [0.131, 0.046], D65],
    [[0.64, 0.33], [0.21, 0.71], [0.15, 0.06], D65],
];

/// Cones of red, green and blue by X, Y, Z (Bradford, K. M. Lam 1985).
pub const CONES: Matrix = [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]];

/// The matrix, row by row, from the linear channels of one color space of [`LINEAR_SPACES`] to those of another, with white as
/// white; none if a name is not known.
///
/// ```
/// use translucid_profile::convention::rgb_from_rgb;
///
/// let [red, ..] = rgb_from_rgb("lin_rec709", "acescg").unwrap();
/// assert!((red[0] - 0.613).abs() < 1e-3 && (red.iter().sum::<f64>() - 1.0).abs() < 1e-9);
/// assert!(rgb_from_rgb("lin_rec709", "srgb").is_none());
/// ```
pub fn rgb_from_rgb(from: &str, to: &str) -> Option<[[f64; 3]; 3]> {
    let find = |name| LINEAR_SPACES.iter().position(|known| *known == name).map(|i| PRIMARIES[i]);
    let (from, to) = (find(from)?, find(to)?);
    if from == to {
        // The product of a matrix and its inverse is not quite this
        return Some(diagonal([1.0; 3]));
    }
    let adapted = times(&adaptation(xyz(from[3]), xyz(to[3])), &xyz_from_rgb(from));
    Some(times(&inverse(&xyz_from_rgb(to)), &adapted))
}

/// Matrix from linear channels to X, Y, Z (SMPTE RP 177).
fn xyz_from_rgb(primaries: [[f64; 2]; 4]) -> Matrix {
    let [red, green, blue] = [0, 1, 2].map(|i| xyz(primaries[i]));
    let columns = [0, 1, 2].map(|row| [red[row], green[row], blue[row]]);
    times(&columns, &diagonal(apply(&inverse(&columns), xyz(primaries[3]))))
}

/// X, Y, Z of chromaticities at Y = 1.
fn xyz([x, y]: [f64; 2]) -> [f64; 3] {
    [x / y, 1.0, (1.0 - x - y) / y]
}

/// Chromatic adaptation of X, Y, Z from one white to another.
fn adaptation(from: [f64; 3], to: [f64; 3]) -> Matrix {
    let (from, to) = (apply(&CONES, from), apply(&CONES, to));
    times(&inverse(&CONES), &times(&diagonal([0, 1, 2].map(|i| to[i] / from[i])), &CONES))
}

fn diagonal(values: [f64; 3]) -> Matrix {
    [0, 1, 2].map(|row| [0, 1, 2].map(|column| if row == column { values[row] } else { 0.0 }))
}

/// Product of a matrix and a vector.
pub fn apply(matrix: &Matrix, vector: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row.iter().zip(vector).map(|(a, b)| a * b).sum())
}

/// Product of two matrices.
pub fn times(left: &Matrix, right: &Matrix) -> Matrix {
    left.map(|row| [0, 1, 2].map(|column| (0..3).map(|i| row[i] * right[i][column]).sum()))
}

/// Inverse by cofactors.
pub fn inverse(m: &Matrix) -> Matrix {
    let cofactor = |row: usize, column: usize| {
        let ([a, b], [c, d]) = ([(row + 1) % 3, (row + 2) % 3], [(column + 1) % 3, (column + 2) % 3]);
        m[a][c] * m[b][d] - m[a][d] * m[b][c]
    };
    let determinant: f64 = (0..3).map(|column| m[0][column] * cofactor(0, column)).sum();
    [0, 1, 2].map(|row| [0, 1, 2].map(|column| cofactor(column, row) / determinant))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_is_white_and_there_and_back_is_the_same() {
        for from in LINEAR_SPACES {
            for to in LINEAR_SPACES {
                let (there, back) = (rgb_from_rgb(from, to).unwrap(), rgb_from_rgb(to, from).unwrap());
                for value in apply(&there, [1.0; 3]) {
                    assert!((value - 1.0).abs() < 1e-12, "{from} {to}: {value}");
                }
                let color = [0.2, 0.5, 0.7];
                let same = apply(&back, apply(&there, color));
                assert!((0..3).all(|i| (same[i] - color[i]).abs() < 1e-12), "{from} {to}: {same:?}");
            }
        }
        assert_eq!(rgb_from_rgb("acescg", "acescg"), Some(diagonal([1.0; 3])));
    }

    /// The matrix that colour 0.4 prints, RGB_to_RGB of ACEScg and ITU-R BT.709 with Bradford.
    #[test]
    fn green_of_acescg_is_outside_of_rec_709() {
        let color = apply(&rgb_from_rgb("acescg", "lin_rec709").unwrap(), [0.2, 0.8, 0.2]);
        for (found, expected) in color.into_iter().zip([-0.1731, 0.8845, 0.1226]) {
            assert!((found - expected).abs() < 2e-4, "{color:?}");
        }
    }
}
