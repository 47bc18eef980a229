// Radial profiles, read from the processor's own tables: `AlbedoTableF32` of `translucid-profile`, whose words are explained
// there, behind what a kernel states of itself.

// Places of a kernel's words.
const DIRECTIONS = 0u;      // 0: all directions are alike, 1: oblique, 2: the directional dipole
const IS_SEARCHLIGHT = 1u;
const IS_DMFP = 2u;
const OBLIQUE_MEANS = 3u;
const REFRACTION_ETA = 6u;
const BRIGHTEST = 7u;
const HAS_OWN = 8u;         // surface albedos and lengths in place of the material's
const OWN_ALBEDO = 9u;
const OWN_LENGTH = 12u;
const AXES = 15u;
const ROW_COUNT = 18u;
const ROWS_OF_ALBEDO = 19u;

const DIPOLE = 2.0;

// Words of a row, of a table's head, of an octave and of a cell.
const ROW_WORDS = 9u;
const HEAD_WORDS = 6u;
const OCTAVE_WORDS = 2u;
const CELL_WORDS = 16u;

// The mixture of two rows that is the profile of a surface albedo and a length.
struct Profile {
    // Places of the rows' tables, reciprocals of their units of length, and their shares.
    rows: vec2u,
    scales: vec2f,
    shares: vec2f,
    // Radius within which probes look [L].
    longest: f32,
}

fn profile_row(kernel: u32, albedo: f32) -> u32 {
    var low = 0u;
    var high = u32(tables[kernel + ROW_COUNT]);
    while (high - low > 1u) {
        let middle = (low + high) / 2u;
        if (tables[kernel + ROWS_OF_ALBEDO + ROW_WORDS * middle] <= albedo) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

// Radius within which half of the light leaves.
fn median_radius(kernel: u32, row: u32, albedo: f32, length: f32) -> f32 {
    let at = kernel + ROWS_OF_ALBEDO + ROW_WORDS * row;
    let excess = max(albedo - tables[at], 0.0);
    let cubic = tables[at + 2u] + excess * (tables[at + 3u] + excess * (tables[at + 4u] + excess * tables[at + 5u]));
    return cubic * clamp(length, 1e-18, 1e18);
}

fn profile_of(kernel: u32, albedo: f32, length: f32) -> Profile {
    let row = profile_row(kernel, albedo);
    let rows = kernel + ROWS_OF_ALBEDO;
    let lower = rows + ROW_WORDS * row;
    let upper = rows + ROW_WORDS * min(row + 1u, u32(tables[kernel + ROW_COUNT]) - 1u);
    let mixed = min(max(albedo - tables[lower], 0.0) * tables[lower + 1u], 1.0);
    let median = median_radius(kernel, row, albedo, length);
    var p: Profile;
    p.rows = vec2u(rows + u32(tables[lower + 8u]), rows + u32(tables[upper + 8u]));
    p.scales = vec2f(tables[lower + 6u], tables[upper + 6u]) / median;
    p.shares = vec2f(1.0 - mixed, mixed);
    p.longest = tables[lower + 7u] / p.scales.x;
    if (mixed > 0.0) {
        p.longest = max(p.longest, tables[upper + 7u] / p.scales.y);
    }
    return p;
}

// The cell of a radius before the tail: its octave is the radius' exponent, its number the first bits of the fraction.
fn cell_at(row: u32, x: f32) -> u32 {
    let bits = bitcast<u32>(x);
    let octave = (bits >> 23u) - u32(tables[row]);
    let octaves = u32(tables[row + 1u]);
    let cells = row + HEAD_WORDS + OCTAVE_WORDS * octaves;
    if (octave >= octaves) {
        return cells;
    }
    let at = row + HEAD_WORDS + OCTAVE_WORDS * octave;
    let number = (bits >> u32(tables[at])) - bitcast<u32>(i32(tables[at + 1u]));
    return cells + CELL_WORDS * min(number, u32(tables[row + 2u]) - 1u);
}

// Density per length at x, and share within x, in the row's unit of length.
fn row_at(row: u32, x: f32) -> vec2f {
    let start = tables[row + 3u];
    if (x >= start) {
        let beyond = tables[row + 4u] * exp((start - x) * tables[row + 5u]);
        return vec2f(tables[row + 5u] * beyond, 1.0 - beyond);
    }
    let at = cell_at(row, x);
    let theta = (x - tables[at]) * tables[at + 1u];
    let q = 1.0 + theta * (tables[at + 2u] + theta * tables[at + 3u]);
    let density = (tables[at + 4u] + theta * (tables[at + 5u] + theta * tables[at + 6u])) / (q * q);
    let share = theta * (tables[at + 7u] + theta * tables[at + 8u]) / q;
    return vec2f(max(density, 0.0), tables[at + 10u] + share);
}

// Radius in the row's unit within which the share u is: a cell by halving, below the median by what is within it, above by
// what is beyond.
fn row_quantile(row: u32, u: f32) -> f32 {
    let cells = row + HEAD_WORDS + OCTAVE_WORDS * u32(tables[row + 1u]);
    let is_below = u < 0.5;
    let v = 1.0 - u;
    if (!is_below && v < tables[row + 4u]) {
        return tables[row + 3u] + max(log(tables[row + 4u] / max(v, 1.1641532e-10)), 0.0) / tables[row + 5u];
    }
    // The last cell that begins within u, or the first beyond which no more than v is
    var low = 0u;
    var high = u32(tables[row + 2u]) - 1u;
    while (low < high) {
        let middle = (low + high + u32(is_below)) / 2u;
        let at = cells + CELL_WORDS * middle;
        let is_up = select(v < tables[at + 11u], tables[at + 10u] <= u, is_below);
        if (is_below) {
            low = select(low, middle, is_up);
            high = select(middle - 1u, high, is_up);
        } else {
            low = select(low, middle + 1u, is_up);
            high = select(middle, high, is_up);
        }
    }
    let at = cells + CELL_WORDS * low;
    let part = clamp(select(v - tables[at + 11u], u - tables[at + 10u], is_below) / max(tables[at + 12u], 1.1754944e-38), 0.0, 1.0);
    let s = select(1.0 - part, part, is_below);
    let rest = select(part, 1.0 - part, is_below);
    let b = tables[at + 13u] * rest - tables[at + 14u] * s;
    let root = sqrt(b * b + 4.0 * tables[at + 15u] * s * rest);
    let numerator = select(root - b, 2.0 * s, b >= 0.0);
    let other = select(2.0 * tables[at + 15u] * rest, b + root, b >= 0.0);
    return tables[at] + numerator / (max(numerator + other, 1e-30) * tables[at + 1u]);
}

// Density per length [1/L], and the two rows' shares of the light within r.
fn profile_at(p: Profile, r: f32) -> vec3f {
    var sums = vec3f(0.0);
    for (var i = 0u; i < 2u; i += 1u) {
        if (p.shares[i] > 0.0) {
            let found = row_at(p.rows[i], r * p.scales[i]);
            sums.x += p.shares[i] * p.scales[i] * found.x;
            sums[i + 1u] = p.shares[i] * found.y;
        }
    }
    return sums;
}

// Radius of that density up to `longest`, within which the rows' shares are `within`.
fn profile_sample(p: Profile, within: vec2f, u: f32) -> f32 {
    let energy = u * (within.x + within.y);
    let is_lower = energy < within.x || within.y <= 0.0;
    let i = select(1u, 0u, is_lower);
    let share = select(energy - within.x, energy, is_lower) / max(p.shares[i], 1.1754944e-38);
    return min(row_quantile(p.rows[i], clamp(share, 0.0, 1.0)) / p.scales[i], p.longest);
}
