// What processors compute otherwise: `elementary.rs`. The built-in functions of a device may be off by 5e-4.

const PI = 3.14159265;
const INVERSE_PI = 0.318309886;

// Cosine and sine of a number of turns, within 1e-7. Polynomials of S. L. Moshier's Cephes library, `sinf`.
fn circle(turns: f32) -> vec2f {
    let quarter = round(4.0 * turns);
    let x = (4.0 * turns - quarter) * 1.57079633;
    let s = x * x;
    let sine = x + x * s * ((-1.9515295891e-4 * s + 8.3321608736e-3) * s - 1.6666654611e-1);
    let cosine = 1.0 - 0.5 * s + s * s * ((2.443315711809948e-5 * s - 1.388731625493765e-3) * s + 4.166664568298827e-2);
    let turned = select(vec2f(cosine, sine), vec2f(-sine, cosine), (i32(quarter) & 1) != 0);
    return select(turned, -turned, (i32(quarter) & 2) != 0);
}

// Cosine and sine of an angle.
fn circle_at(angle: f32) -> vec2f {
    return circle(angle * 0.15915494);
}

// The unit vector along `v`, or `other` where it has no direction.
fn unit_or(v: vec3f, other: vec3f) -> vec3f {
    // Scaled first: squares of small areas vanish
    let size = max(abs(v.x), max(abs(v.y), abs(v.z)));
    if (!(size > 0.0)) {
        return other;
    }
    return normalize(v / size);
}

// A color whose channels are raised to a power.
fn color_power(color: vec3f, exponent: f32) -> vec3f {
    return select(vec3f(0.0), pow(max(color, vec3f(1e-30)), vec3f(exponent)), color > vec3f(0.0));
}

// Returns true if every component is 0.
fn is_zero_vector(v: vec3f) -> bool {
    return all(v == vec3f(0.0));
}

// Returns true for a number that is neither infinite nor a NaN.
fn is_finite(x: f32) -> bool {
    return abs(x) < 3.4e38;
}

// 1 or -1, by a number's sign.
fn sign_of(x: f32) -> f32 {
    return select(-1.0, 1.0, x >= 0.0);
}

// Three numbers in a row.
fn table_vector(at: u32) -> vec3f {
    return vec3f(tables[at], tables[at + 1u], tables[at + 2u]);
}

// The greatest component.
fn greatest(v: vec3f) -> f32 {
    return max(v.x, max(v.y, v.z));
}
