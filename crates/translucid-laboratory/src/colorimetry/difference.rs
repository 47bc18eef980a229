//! Differences of colors.

use std::f64::consts::PI;

/// ΔE*ab of two CIELAB colors: their distance (ISO/CIE 11664-4:2019).
pub fn delta_e_ab(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// CIEDE2000 of two CIELAB colors (ISO/CIE 11664-6:2022) with k_L = k_C = k_H = 1.
///
/// Symbols and order are those of G. Sharma, W. Wu and E. N. Dalal 2005, *The CIEDE2000 color-difference formula*, Color
/// Research & Application 30, equations 2 to 22.
/// The formula jumps where the hues of two colors are 180° apart, as its authors state.
pub fn delta_e_2000([l1, a1, b1]: [f64; 3], [l2, a2, b2]: [f64; 3]) -> f64 {
    let to_the_7th = |c: f64| libm::pow(c, 7.0);
    let saturation = |c: f64| (to_the_7th(c) / (to_the_7th(c) + to_the_7th(25.0))).sqrt();

    // Compute C' and h'
    let mean = 0.5 * (libm::hypot(a1, b1) + libm::hypot(a2, b2));
    let stretch = 1.0 + 0.5 * (1.0 - saturation(mean));
    let [(c1, h1), (c2, h2)] = [(a1, b1), (a2, b2)].map(|(a, b)| {
        let a = stretch * a;
        (libm::hypot(a, b), if a == 0.0 && b == 0.0 { 0.0 } else { libm::atan2(b, a).rem_euclid(2.0 * PI) })
    });

    // Compute ΔL', ΔC', ΔH'
    let is_gray = c1 * c2 == 0.0;
    let between = h2 - h1;
    let turn = if is_gray {
        0.0
    } else if between > PI {
        between - 2.0 * PI
    } else if between < -PI {
        between + 2.0 * PI
    } else {
        between
    };
    let (dl, dc, dh) = (l2 - l1, c2 - c1, 2.0 * (c1 * c2).sqrt() * libm::sin(0.5 * turn));

    // Compute CIEDE2000
    let (l, c) = (0.5 * (l1 + l2), 0.5 * (c1 + c2));
    let h = if is_gray {
        h1 + h2
    } else if between.abs() <= PI {
        0.5 * (h1 + h2)
    } else if h1 + h2 < 2.0 * PI {
        0.5 * (h1 + h2) + PI
    } else {
        0.5 * (h1 + h2) - PI
    };
    let cosine = |times: f64, degrees: f64| libm::cos(times * h - degrees.to_radians());
    let t = 1.0 - 0.17 * cosine(1.0, 30.0) + 0.24 * cosine(2.0, 0.0) + 0.32 * cosine(3.0, -6.0)
        - 0.20 * cosine(4.0, 63.0);
    let off_blue = (h.to_degrees() - 275.0) / 25.0;
    let rotation = 60f64.to_radians() * libm::exp(-off_blue * off_blue);
    let off_middle = (l - 50.0) * (l - 50.0);
    let s_l = 1.0 + 0.015 * off_middle / (20.0 + off_middle).sqrt();
    let (s_c, s_h) = (1.0 + 0.045 * c, 1.0 + 0.015 * c * t);
    let r_t = -libm::sin(rotation) * 2.0 * saturation(c);
    let (dl, dc, dh) = (dl / s_l, dc / s_c, dh / s_h);
    (dl * dl + dc * dc + dh * dh + r_t * dc * dh).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// G. Sharma, W. Wu and E. N. Dalal 2005, table 1, without its pair 14, whose hues are 180° apart up to rounding.
    const PAIRS: [([f64; 3], [f64; 3], f64); 33] = [
        ([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485], 2.0425),
        ([50.0, 3.1571, -77.2803], [50.0, 0.0, -82.7485], 2.8615),
        ([50.0, 2.8361, -74.02], [50.0, 0.0, -82.7485], 3.4412),
        ([50.0, -1.3802, -84.2814], [50.0, 0.0, -82.7485], 1.0),
        ([50.0, -1.1848, -84.8006], [50.0, 0.0, -82.7485], 1.0),
        ([50.0, -0.9009, -85.5211], [50.0, 0.0, -82.7485], 1.0),
        ([50.0, 0.0, 0.0], [50.0, -1.0, 2.0], 2.3669),
        ([50.0, -1.0, 2.0], [50.0, 0.0, 0.0], 2.3669),
        ([50.0, 2.49, -0.001], [50.0, -2.49, 0.0009], 7.1792),
        ([50.0, 2.49, -0.001], [50.0, -2.49, 0.001], 7.1792),
        ([50.0, 2.49, -0.001], [50.0, -2.49, 0.0011], 7.2195),
        ([50.0, 2.49, -0.001], [50.0, -2.49, 0.0012], 7.2195),
        ([50.0, -0.001, 2.49], [50.0, 0.0009, -2.49], 4.8045),
        ([50.0, -0.001, 2.49], [50.0, 0.0011, -2.49], 4.7461),
        ([50.0, 2.5, 0.0], [50.0, 0.0, -2.5], 4.3065),
        ([50.0, 2.5, 0.0], [73.0, 25.0, -18.0], 27.1492),
        ([50.0, 2.5, 0.0], [61.0, -5.0, 29.0], 22.8977),
        ([50.0, 2.5, 0.0], [56.0, -27.0, -3.0], 31.903),
        ([50.0, 2.5, 0.0], [58.0, 24.0, 15.0], 19.4535),
        ([50.0, 2.5, 0.0], [50.0, 3.1736, 0.5854], 1.0),
        ([50.0, 2.5, 0.0], [50.0, 3.2972, 0.0], 1.0),
        ([50.0, 2.5, 0.0], [50.0, 1.8634, 0.5757], 1.0),
        ([50.0, 2.5, 0.0], [50.0, 3.2592, 0.335], 1.0),
        ([60.2574, -34.0099, 36.2677], [60.4626, -34.1751, 39.4387], 1.2644),
        ([63.0109, -31.0961, -5.8663], [62.8187, -29.7946, -4.0864], 1.263),
        ([61.2901, 3.7196, -5.3901], [61.4292, 2.248, -4.962], 1.8731),
        ([35.0831, -44.1164, 3.7933], [35.0232, -40.0716, 1.5901], 1.8645),
        ([22.7233, 20.0904, -46.694], [23.0331, 14.973, -42.5619], 2.0373),
        ([36.4612, 47.858, 18.3852], [36.2715, 50.5065, 21.2231], 1.4146),
        ([90.8027, -2.0831, 1.441], [91.1528, -1.6435, 0.0447], 1.4441),
        ([90.9257, -0.5406, -0.9208], [88.6381, -0.8985, -0.7239], 1.5381),
        ([6.7747, -0.2908, -2.4247], [5.8714, -0.0985, -2.2286], 0.6377),
        ([2.0776, 0.0795, -1.135], [0.9033, -0.0636, -0.5514], 0.9082),
    ];

    #[test]
    fn delta_e_2000_is_that_of_its_authors() {
        for (a, b, expected) in PAIRS {
            for found in [delta_e_2000(a, b), delta_e_2000(b, a)] {
                assert!((found - expected).abs() < 5e-5, "{a:?}, {b:?}: {found}, expected {expected}");
            }
        }
    }

    #[test]
    fn differences_of_a_color_from_itself_are_0() {
        for color in [[50.0, 10.0, -20.0], [0.0; 3], [100.0, 0.0, 1e-12]] {
            assert_eq!([delta_e_ab(color, color), delta_e_2000(color, color)], [0.0; 2]);
        }
        assert_eq!(delta_e_ab([1.0, 2.0, 3.0], [1.0, 5.0, 7.0]), 5.0);
    }
}
