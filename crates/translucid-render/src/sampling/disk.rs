//! Points in the unit disk.

/// Area-preserving map of the unit square to the unit disk [Shirley & Chiu 1997].
pub(crate) fn concentric_disk(u: [f32; 2]) -> [f32; 2] {
    let (a, b) = (2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0);
    if a == 0.0 && b == 0.0 {
        return [0.0, 0.0];
    }
    let quarter = std::f32::consts::FRAC_PI_4;
    let (r, angle) =
        if a.abs() > b.abs() { (a, quarter * b / a) } else { (b, 2.0 * quarter - quarter * a / b) };
    [r * libm::cosf(angle), r * libm::sinf(angle)]
}
