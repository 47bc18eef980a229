//! One of a few things, in proportion to shares.

/// Picks an index in proportion to shares that sum to one; returns the remainder of the random number,
/// uniform in [0, 1) again.
pub(crate) fn choose<const N: usize>(shares: [f32; N], u: f32) -> (usize, f32) {
    let mut rest = u;
    let mut last = 0;
    for (index, &share) in shares.iter().enumerate() {
        if share <= 0.0 {
            continue;
        }
        if rest < share {
            return (index, (rest / share).min(1.0 - f32::EPSILON));
        }
        rest -= share;
        last = index;
    }
    (last, 1.0 - f32::EPSILON)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choose_is_proportional_and_rescales() {
        let shares = [0.25, 0.0, 0.75];
        let n = 10_000;
        let mut counts = [0; 3];
        let mut rests = [0.0; 3];
        for i in 0..n {
            let (index, rest) = choose(shares, (i as f32 + 0.5) / n as f32);
            counts[index] += 1;
            rests[index] += rest;
        }
        assert_eq!(counts, [n / 4, 0, n * 3 / 4]);
        assert!((rests[0] / counts[0] as f32 - 0.5).abs() < 1e-3);
        assert!((rests[2] / counts[2] as f32 - 0.5).abs() < 1e-3);
        assert_eq!(choose([0.0, 1.0, 0.0], 0.999_999_9).0, 1);
    }
}
