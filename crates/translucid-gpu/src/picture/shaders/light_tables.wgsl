// Choices among finitely many things in proportion to weights, in whole numbers: the probability of an entry is exactly that
// with which it is drawn.
//
// A table of n entries has n + 1 words among `images`: word i is 2³¹ times the probability of an entry below i.

// A random number in [0, 1) as 31 bits. It has 23 or 24 itself; those below come from a hash, so that entries which are less
// probable than 2⁻²³ are drawn as often as they should be.
fn light_word(x: f32, hash: u32) -> u32 {
    return (min(u32(x * 0x1p31f), 0x7fffffffu) & 0xffffff00u) | (hash & 0xffu);
}

// A hash of the random numbers of a sample.
fn light_hash(choice: f32, u: vec2f) -> u32 {
    var h = (bitcast<u32>(choice) * 0x9e3779b9u) ^ (bitcast<u32>(u.x) * 0x85ebca6bu) ^ (bitcast<u32>(u.y) * 0xc2b2ae35u);
    h = (h ^ (h >> 16u)) * 0x7feb352du;
    h = (h ^ (h >> 15u)) * 0x846ca68bu;
    return h ^ (h >> 16u);
}

// The entry of a table that a word of 31 bits draws: the last one that begins at or below it. Entries of probability 0 are
// stepped over.
fn table_index(table: u32, count: u32, word: u32) -> u32 {
    var low = 0u;
    var high = count;
    for (var i = 0u; i < 32u && high - low > 1u; i++) {
        let middle = (low + high) / 2u;
        if (images[table + middle] <= word) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

fn table_probability(table: u32, index: u32) -> f32 {
    return f32(images[table + index + 1u] - images[table + index]) * 0x1p-31f;
}

// The random number in [0, 1) that is left within the drawn entry.
fn table_rest(table: u32, index: u32, word: u32) -> f32 {
    let begin = images[table + index];
    let width = max(images[table + index + 1u] - begin, 1u);
    return min((f32(word - begin) + 0.5) / f32(width), 0x1.fffffep-1f);
}
