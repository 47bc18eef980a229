// Arithmetic in single precision whose every bit is prescribed.
//
// Sums and products of two numbers are rounded alike on all devices. What differs are a product and a sum that a compiler
// joins to one operation, expressions that it rearranges (Mesa makes y of (x + y) − x), and the built-in division, roots
// and elementary functions. So each sum and product passes through `fixed`, which no compiler can see through, but for those
// by a power of two, which are exact; and all else is made of sums and products here.
// `twin.rs` has the same operations in Rust.

// The number itself. `settings.zero` is 0, which only the host knows.
fn fixed(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) ^ settings.zero);
}

fn times(a: f32, b: f32) -> f32 {
    return fixed(a * b);
}

fn plus(a: f32, b: f32) -> f32 {
    return fixed(a + b);
}

// 1/x for x in [1e-38, 1e38]: a first guess by the exponent, then three of Newton's steps; within 2 units in the last place.
fn reciprocal(x: f32) -> f32 {
    var y = bitcast<f32>(0x7ef311c7u - bitcast<u32>(x));
    y = times(y, plus(2.0, -times(x, y)));
    y = times(y, plus(2.0, -times(x, y)));
    return times(y, plus(2.0, -times(x, y)));
}

// The square root of x ≥ 0, by its inverse: a first guess by half the exponent, then three of Newton's steps; within 3 units in
// the last place, and 0 for 0.
fn root(x: f32) -> f32 {
    let half = 0.5 * x;
    var y = bitcast<f32>(0x5f375a86u - (bitcast<u32>(x) >> 1u));
    y = times(y, plus(1.5, -times(times(half, y), y)));
    y = times(y, plus(1.5, -times(times(half, y), y)));
    y = times(y, plus(1.5, -times(times(half, y), y)));
    return times(x, y);
}

// √(1 − x²) for |x| ≤ 1.
fn complement(x: f32) -> f32 {
    return root(times(plus(1.0, -abs(x)), plus(1.0, abs(x))));
}

// Uniform in (0, 1): the midpoints of 2²³ cells.
fn unit(word: u32) -> f32 {
    return f32((word >> 8u) | 1u) * 0x1p-24f;
}

// Uniform in (−1, 1), symmetric: the midpoints of 2²³ cells.
fn signed(word: u32) -> f32 {
    return f32((bitcast<i32>(word) >> 8u) | 1) * 0x1p-23f;
}

// Exponential with mean 1, in [0, 22.2]: −ln u, by u = 2^−k (1 + t) with 1 + t in [√½, √2) and the polynomial of
// `translucid-reference`'s `lanes.rs` for ln(1 + t)/t.
fn exponential(word: u32) -> f32 {
    let odd = word | 1u;
    let zeros = countLeadingZeros(odd);
    let bits = 0x3f800000u | ((((odd << zeros) >> 8u) | 1u) & 0x7fffffu);
    let above = select(0u, 1u, bits > 0x3fb504f3u);
    let t = plus(bitcast<f32>(bits - (above << 23u)), -1.0);
    var p = plus(times(0.08533313f, t), -0.14269258f);
    p = plus(times(p, t), 0.1497740128f);
    p = plus(times(p, t), -0.16577993f);
    p = plus(times(p, t), 0.19955933f);
    p = plus(times(p, t), -0.25001352f);
    p = plus(times(p, t), 0.33334193f);
    p = plus(times(p, t), -0.49999996f);
    p = plus(times(p, t), 0.9999999741f);
    return plus(times(f32(zeros + 1u - above), 0.69314718f), -times(t, p));
}

// Uniform on the unit circle: 30 bits turn by up to an eighth of it, one exchanges the coordinates, one changes both signs.
fn circle(word: u32) -> vec2f {
    let t = signed(word << 2u);
    let q = times(t, t);
    var s = plus(times(-3.595429e-5f, q), 0.0024900068f);
    s = plus(times(s, q), -0.0807454347f);
    s = plus(times(s, q), 0.78539816f);
    var c = plus(times(-3.1887748e-4f, q), 0.01584991f);
    c = plus(times(c, q), -0.30842425f);
    c = plus(times(c, q), 0.9999999723f);
    let turned = vec2f(c, times(s, t));
    let exchanged = select(turned, turned.yx, (word & 0x40000000u) != 0u);
    return select(exchanged, -exchanged, (word & 0x80000000u) != 0u);
}
