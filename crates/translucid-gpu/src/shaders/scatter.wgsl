// Deflection at a collision; the formulas are those of `translucid-reference`'s `scatter.rs`.

const ISOTROPIC = 0u;
const HENYEY_GREENSTEIN = 1u;

override phase_function: u32;

fn scattered(before: vec3f, polar: u32, azimuth: u32) -> vec3f {
    let around = circle(azimuth);
    if (phase_function == ISOTROPIC) {
        let z = signed(polar);
        let sine = complement(z);
        return vec3f(times(sine, around.x), times(sine, around.y), z);
    }
    if (phase_function == HENYEY_GREENSTEIN) {
        return turned(before, henyey_greenstein(unit(polar)), around);
    }
    return turned(before, rayleigh(signed(polar)), around);
}

// Cosine and sine of the deflection for ξ uniform in (0, 1).
fn henyey_greenstein(xi: f32) -> vec2f {
    let twice = times(xi, 2.0 * settings.g);
    let ratio = times(settings.one_minus_g, reciprocal(plus(twice, settings.one_minus_g)));
    let versine = min(times(times(plus(1.0, -xi), plus(twice, 2.0)), times(ratio, ratio)), 2.0);
    let cosine = plus(1.0, -versine);
    return vec2f(select(cosine, -cosine, settings.backwards != 0u), root(times(versine, plus(2.0, -versine))));
}

// The same for x uniform in [−1, 1]: μ³ + 3μ = 4x by a polynomial and a step of Halley's.
fn rayleigh(x: f32) -> vec2f {
    let q = times(x, x);
    var p = plus(times(-0.20843726f, q), 0.5480744f);
    p = plus(times(p, q), -0.6705609f);
    p = plus(times(p, q), 1.3298686f);
    let start = times(x, p);
    let square = times(start, start);
    let third_slope = plus(square, 1.0);
    let f = plus(times(start, plus(square, 3.0)), -4.0 * x);
    let below = plus(times(times(third_slope, third_slope), 3.0), -times(f, start));
    let cosine = clamp(plus(start, -times(times(f, third_slope), reciprocal(below))), -1.0, 1.0);
    return vec2f(cosine, complement(cosine));
}

// Turns a direction by an angle, towards a point of the circle: a reflection that exchanges it with the z axis.
fn turned(u: vec3f, deflection: vec2f, around: vec2f) -> vec3f {
    let p = times(deflection.y, around.x);
    let q = times(deflection.y, around.y);
    let d = plus(times(p, u.x), times(q, u.y));
    let k = plus(deflection.x, times(d, reciprocal(plus(abs(u.z), 1.0))));
    let x = plus(times(k, u.x), -p);
    let y = plus(times(k, u.y), -q);
    let z = plus(times(deflection.x, u.z), select(d, -d, u.z < 0.0));
    // Undo what this collision added to the length
    let square = plus(plus(times(x, x), times(y, y)), times(z, z));
    let shrink = plus(1.5, -0.5 * square);
    return vec3f(times(x, shrink), times(y, shrink), times(z, shrink));
}
