// Random numbers of a path, a function of seed, pixel and sample: Sobol's sequence under scrambles of its own for every four
// dimensions [B. Burley 2020, Practical Hash-based Owen Scrambling, JCGT 9(4)], then S. Vigna's SplitMix64 in walks, as on the
// processor.

struct Sampler {
    seed: u32,
    index: u32,
}

const SETS_PER_VERTEX = 8u;

fn sampler_of(pixel: vec2u, sample: u32) -> Sampler {
    var state = 0x9e3779b9u;
    state = hash_combine(state, settings.seed.x);
    state = hash_combine(state, settings.seed.y);
    state = hash_combine(state, pixel.x);
    state = hash_combine(state, pixel.y);
    // The sequence ends after 2^16 points: it goes on with another scramble
    state = hash_combine(state, sample >> 16u);
    return Sampler(state, sample & 0xffffu);
}

// Four numbers in [0, 1): a set of those of a vertex of the path.
fn stratified(sampler: Sampler, vertex: u32, number: u32) -> vec4f {
    let seed = hash_combine(sampler.seed, vertex * SETS_PER_VERTEX + number);
    let reversed = owen_scrambled(reverseBits(sampler.index), avalanche(seed ^ 0x79c68e4au));
    var sobol = vec4u(0u);
    let directions = head(SOBOL);
    for (var bit = 0u; bit < 16u; bit += 1u) {
        if ((reversed & (0x80000000u >> bit)) != 0u) {
            let at = directions + 8u * bit;
            sobol ^= vec4u(word_at(at), word_at(at + 2u), word_at(at + 4u), word_at(at + 6u));
        }
    }
    let scramble = vec4u(0x912f69bau, 0x174f18abu, 0x691e72cau, 0xb40cc1b8u) ^ vec4u(seed * 0x9c8f2d3bu);
    let scrambled = vec4u(
        owen_scrambled(sobol.x, avalanche(scramble.x)),
        owen_scrambled(sobol.y, avalanche(scramble.y)),
        owen_scrambled(sobol.z, avalanche(scramble.z)),
        owen_scrambled(sobol.w, avalanche(scramble.w)),
    );
    return in_unit(reverseBits(scrambled));
}

// Four independent numbers in [0, 1), two of a word, behind so many words: of those that are forked where a set is the next one.
fn independent(sampler: Sampler, next: u32, words: u32) -> vec4f {
    let low = hash_combine(hash_combine(sampler.seed, next), sampler.index);
    let start = vec2u(low, hash_combine(low ^ 0x5bd1e995u, sampler.index));
    let step = vec2u(0x7f4a7c15u, 0x9e3779b9u);
    var bits = vec4u(0u);
    for (var k = 0u; k < 2u; k += 1u) {
        let word = mixed_64(sum_64(start, product_64(step, vec2u(words + k + 1u, 0u))));
        bits = select(vec4u(bits.xy, word), vec4u(word, 0u, 0u), k == 0u);
    }
    return vec4f(bits & vec4u(0xffffffu)) * (1.0 / 16777216.0);
}

// Arithmetic of 64 bits, the lower first.
fn sum_64(a: vec2u, b: vec2u) -> vec2u {
    let low = a.x + b.x;
    return vec2u(low, a.y + b.y + select(0u, 1u, low < a.x));
}

fn product_64(a: vec2u, b: vec2u) -> vec2u {
    let a_parts = vec2u(a.x & 0xffffu, a.x >> 16u);
    let b_parts = vec2u(b.x & 0xffffu, b.x >> 16u);
    let outer = a_parts * b_parts;
    let inner = a_parts * b_parts.yx;
    let middle = (outer.x >> 16u) + (inner.x & 0xffffu) + (inner.y & 0xffffu);
    let high = outer.y + (inner.x >> 16u) + (inner.y >> 16u) + (middle >> 16u);
    return vec2u((outer.x & 0xffffu) | (middle << 16u), high + a.x * b.y + a.y * b.x);
}

fn mixed_64(word: vec2u) -> vec2u {
    var z = product_64(shifted_into(word, 30u), vec2u(0x1ce4e5b9u, 0xbf58476du));
    z = product_64(shifted_into(z, 27u), vec2u(0x133111ebu, 0x94d049bbu));
    return shifted_into(z, 31u);
}

// z ^ (z >> by).
fn shifted_into(z: vec2u, by: u32) -> vec2u {
    return z ^ vec2u((z.x >> by) | (z.y << (32u - by)), z.y >> by);
}

fn word_at(place: u32) -> u32 {
    return u32(tables[place]) | (u32(tables[place + 1u]) << 16u);
}

fn in_unit(bits: vec4u) -> vec4f {
    // 24 bits are exact, and never 1
    return vec4f(bits >> vec4u(8u)) * (1.0 / 16777216.0);
}

fn owen_scrambled(reversed: u32, seed: u32) -> u32 {
    var x = reversed ^ (reversed * 0x3d20adeau);
    x += seed;
    x *= (seed >> 16u) | 1u;
    x ^= x * 0x05526c56u;
    return x ^ (x * 0x53a22864u);
}

fn avalanche(word: u32) -> u32 {
    var x = word ^ 0xe6fe3bebu;
    x = (x ^ (x >> 16u)) * 0x7feb352du;
    x = (x ^ (x >> 15u)) * 0x846ca68bu;
    return x ^ (x >> 16u);
}

fn hash_combine(state: u32, value: u32) -> u32 {
    let product = value * 0x9e3779b9u;
    var x = state ^ ((product << 15u) | (product >> 17u));
    x = (x ^ (x >> 16u)) * 0x21f0aaadu;
    x = (x ^ (x >> 15u)) * 0x735a2d97u;
    return x ^ (x >> 15u);
}
