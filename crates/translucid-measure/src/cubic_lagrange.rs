//! Interpolation of a table by cubic Lagrange polynomials.

/// The first of the four of `count` values around a place, and their weights in the cubic through them; beyond the ends those of
/// a straight line.
pub(crate) fn lagrange_weights(count: usize, place: f64) -> (usize, [f64; 4]) {
    let last = (count - 1) as f64;
    if place <= 0.0 {
        return (0, [1.0 - place, place, 0.0, 0.0]);
    }
    if place >= last {
        return (count - 4, [0.0, 0.0, last - place, 1.0 + place - last]);
    }
    // The interval's neighbors, one further inside at the ends
    let first = (place.floor() as usize).saturating_sub(1).min(count - 4);
    let t = place - first as f64;
    let (t1, t2, t3) = (t - 1.0, t - 2.0, t - 3.0);
    (first, [-t1 * t2 * t3 / 6.0, t * t2 * t3 / 2.0, -t * t1 * t3 / 2.0, t * t1 * t2 / 6.0])
}
