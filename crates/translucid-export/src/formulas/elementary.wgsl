// 1 - e^(-t) for t >= 0, with every digit of a small t.
fn one_minus_exp(t: f32) -> f32 {
    // 1 - e^(-t) = t (1 - t/2 (1 - t/3 (1 - ...))), which nine terms end at 1e-9 for t < 1/2
    let s: f32 = min(t, 0.5);
    let late: f32 = 1.0 - s * (1.0 / 6.0) * (1.0 - s * (1.0 / 7.0) * (1.0 - s * (1.0 / 8.0) * (1.0 - s * (1.0 / 9.0))));
    let series: f32 = 1.0 - s * 0.5 * (1.0 - s * (1.0 / 3.0) * (1.0 - s * 0.25 * (1.0 - s * 0.2 * late)));
    return select(1.0 - exp(-t), t * series, t < 0.5);
}

// -ln(x) for x in (0, 1] given beside y = 1 - x, with every digit of a small y.
fn minus_log(x: f32, y: f32) -> f32 {
    // -ln(1 - y) = 2 artanh(z) with z = y/(2 - y), which eight terms end at 1e-9 for y < 1/2
    let z: f32 = min(y, 0.5) / (1.0 + max(x, 0.5));
    let q: f32 = z * z;
    let late: f32 = 1.0 / 9.0 + q * (1.0 / 11.0 + q * (1.0 / 13.0 + q * (1.0 / 15.0)));
    let series: f32 = 1.0 + q * (1.0 / 3.0 + q * (1.0 / 5.0 + q * (1.0 / 7.0 + q * late)));
    return select(-log(x), 2.0 * z * series, y < 0.5);
}

// q / r for q, r >= 0, at most 1e38; r below 1.1755e-38 counts as that.
fn bounded_ratio(q: f32, r: f32) -> f32 {
    return q / max(max(r, 1.1754944e-38), q * 1e-19 * 1e-19);
}
