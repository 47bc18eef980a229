//! The minimum of a function of one variable.

/// Argument at which a function is least on an interval, and its value there.
///
/// The interval is searched in `steps` equal steps, and the best of them by golden section, until it is narrower than
/// `tolerance` (J. Kiefer, *Sequential Minimax Search for a Maximum*, 1953). A function that falls and rises more than
/// once between two of the steps may have a lower value elsewhere.
pub(crate) fn minimum(f: impl Fn(f64) -> f64, [from, to]: [f64; 2], steps: u32, tolerance: f64) -> [f64; 2] {
    /// 1 over the golden ratio
    const SHARE: f64 = 0.618_033_988_749_894_9;

    // Bracket the minimum
    let step = (to - from) / f64::from(steps);
    let stations = (0..=steps).map(|i| from + step * f64::from(i));
    let best = stations.map(|x| [x, f(x)]).min_by(|a, b| a[1].total_cmp(&b[1]));
    let [x, _] = best.expect("there is a station");
    let (mut low, mut high) = ((x - step).max(from), (x + step).min(to));

    // Narrow the bracket, each time by one value
    let inner = |low: f64, high: f64| [high - SHARE * (high - low), low + SHARE * (high - low)];
    let [mut left, mut right] = inner(low, high).map(|x| [x, f(x)]);
    while high - low > tolerance {
        if left[1] <= right[1] {
            high = right[0];
            right = left;
            let x = inner(low, high)[0];
            left = [x, f(x)];
        } else {
            low = left[0];
            left = right;
            let x = inner(low, high)[1];
            right = [x, f(x)];
        }
    }
    if left[1] <= right[1] { left } else { right }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn minimum_is_found_inside_and_at_an_end() {
        for center in [-0.93f64, 0.0, 0.31, 0.999] {
            let [x, value] = minimum(|x| 2.0 + (x - center).abs(), [-1.0, 1.0], 10, 1e-9);
            assert!((x - center).abs() < 1e-9 && (value - 2.0).abs() < 1e-9, "{center}: {x} {value}");
        }
        let [x, _] = minimum(|x| x, [2.0, 3.0], 7, 1e-9);
        assert!((x - 2.0).abs() < 1e-9, "{x}");
    }

    /// The deeper one of two valleys is found.
    #[test]
    fn minimum_is_that_of_the_deeper_valley() {
        let [x, _] = minimum(|x| (x * x - 1.0).powi(2) - 0.1 * x, [-2.0, 2.0], 20, 1e-6);
        assert!((x - 1.0123).abs() < 1e-3, "{x}");
    }
}
