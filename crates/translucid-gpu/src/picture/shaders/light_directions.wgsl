// Maps of numbers to directions and back, with elementary functions of known precision: the built-in ones may be wrong by
// 2⁻¹¹.

// Cosine and sine of a number of turns in [0, 1], within 2e-7.
fn turned_circle(turns: f32) -> vec2f {
    let quarter = floor(4.0 * turns + 0.5);
    // In eighths of a turn, from −1 to 1: exact
    let t = 8.0 * turns - 2.0 * quarter;
    let q = t * t;
    let s = t * (0.78539816f + q * (-0.0807454347f + q * (0.0024900068f - 3.595429e-5f * q)));
    let c = 0.9999999723f + q * (-0.30842425f + q * (0.01584991f - 3.1887748e-4f * q));
    let turned = u32(quarter) & 3u;
    let exchanged = select(vec2f(c, s), vec2f(-s, c), (turned & 1u) != 0u);
    return select(exchanged, -exchanged, (turned & 2u) != 0u);
}

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

// Unit vector by the cosine and sine of its angle to a unit axis and its angle about it in turns. The frame is that of Duff
// et al. 2017, "Building an Orthonormal Basis, Revisited".
fn polar_direction(axis: vec3f, cosine: f32, sine: f32, turns: f32) -> vec3f {
    let side = select(-1.0, 1.0, axis.z >= 0.0);
    let a = -1.0 / (side + axis.z);
    let b = axis.x * axis.y * a;
    let x = vec3f(1.0 + side * axis.x * axis.x * a, side * b, -side * axis.x);
    let y = vec3f(b, side + axis.y * axis.y * a, -axis.y);
    let around = sine * turned_circle(turns);
    return normalize(x * around.x + y * around.y + axis * cosine);
}

// Direction in a cone about an axis, uniform in solid angle; the cone is given by 1 − cos α, which is exact for narrow ones.
fn uniform_cone(axis: vec3f, one_minus_cos: f32, u: vec2f) -> vec3f {
    let x = u.x * one_minus_cos;
    return polar_direction(axis, 1.0 - x, sqrt(max(x * (2.0 - x), 0.0)), u.y);
}

fn uniform_cone_pdf(one_minus_cos: f32) -> f32 {
    return 1.0 / (2.0 * PI * one_minus_cos);
}

// 1 − cos α from sin² α.
fn one_minus_cos(sin_squared: f32) -> f32 {
    return sin_squared / (1.0 + sqrt(max(1.0 - sin_squared, 0.0)));
}

// The square on the disc, area by area, as radius and turns [Shirley & Chiu 1997, "A Low Distortion Map Between Disk and
// Square"].
fn concentric_polar(u: vec2f) -> vec2f {
    let p = 2.0 * u - 1.0;
    let larger = max(abs(p.x), abs(p.y));
    if (larger == 0.0) {
        return vec2f(0.0);
    }
    // A negative radius is as good as a half turn
    var turns = 0.0;
    if (abs(p.x) > abs(p.y)) {
        turns = 0.125 * (p.y / p.x) + select(0.0, 0.5, p.x < 0.0);
    } else {
        turns = 0.25 - 0.125 * (p.x / p.y) + select(0.0, 0.5, p.y < 0.0);
    }
    return vec2f(larger, select(turns, turns + 1.0, turns < 0.0));
}

// Direction with density cos θ/π about a unit normal.
fn cosine_direction(normal: vec3f, u: vec2f) -> vec3f {
    let at = concentric_polar(u);
    return polar_direction(normal, sqrt(max(1.0 - at.x * at.x, 0.0)), at.x, at.y);
}
