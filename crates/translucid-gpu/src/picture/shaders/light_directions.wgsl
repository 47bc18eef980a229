// An elementary function of known precision: the built-in one may be wrong by 2⁻¹¹.

// Angle of (x, y) from the x axis in turns, in [−1/2, 1/2], relative to 3e-7; 0 for the point 0.
fn turns_of(y: f32, x: f32) -> f32 {
    let least = min(abs(x), abs(y));
    let greatest = max(abs(x), abs(y));
    if (greatest == 0.0) {
        return 0.0;
    }
    let t = least / greatest;
    let q = t * t;
    // Least squares for atan(t)/(2π t), weighted toward the least relative error, which is 1e-7
    var p = 0.0038598813f - 0.0007469557f * q;
    p = -0.009467542f + q * p;
    p = 0.01577908f + q * p;
    p = -0.022312693f + q * p;
    p = 0.031782802f + q * p;
    p = -0.053049512f + q * p;
    p = 0.15915492f + q * p;
    var turns = t * p;
    turns = select(turns, 0.25 - turns, abs(y) > abs(x));
    turns = select(turns, 0.5 - turns, x < 0.0);
    return select(turns, -turns, y < 0.0);
}
