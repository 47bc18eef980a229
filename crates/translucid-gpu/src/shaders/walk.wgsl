// Photons through a half space or a slab, a bounded number of steps at a time.

struct Settings {
    key: vec4u,
    // The faces from inside, and from the side of the lower index.
    face: Interface,
    rarer: Interface,
    // Index of the first photon, its low and its high word.
    first: vec2u,
    // Photons of this batch.
    photons: u32,
    // Photons under way at a time.
    slots: u32,
    // Steps of a dispatch.
    steps: u32,
    zero: u32,
    // Radii between rings, sectors of a ring, bins of orders.
    radii: u32,
    sectors: u32,
    order_bins: u32,
    // Collisions that a photon survives in the mean, over those of an exponential with mean 1.
    collisions_per_unit: f32,
    thickness: f32,
    spot_radius: f32,
    g: f32,
    one_minus_g: f32,
    // 1 where g is negative.
    backwards: u32,
    sine: f32,
    cosine: f32,
    inverse_eta: f32,
}

// A photon that is about to fly. One that reflection has left beyond a face is about to meet that face.
struct Photon {
    // One more than its number in the batch; 0 for none.
    number: u32,
    index: vec2u,
    step: u32,
    left: u32,
    budget: u32,
    position: vec3f,
    direction: vec3f,
}

struct Counters {
    // Photons launched, and how often another was asked for in vain.
    asked: atomic<u32>,
    ended: atomic<u32>,
    absorbed: atomic<u32>,
    collisions_low: atomic<u32>,
    collisions_high: atomic<u32>,
}

@group(0) @binding(0) var<uniform> settings: Settings;
// Squared radii rounded, cosines and sines between sectors, first orders of bins but the first, and what the rounding of
// squared radii left out.
@group(0) @binding(1) var<storage, read> bounds: array<u32>;
@group(0) @binding(2) var<storage, read_write> slots: array<u32>;
@group(0) @binding(3) var<storage, read_write> counters: Counters;
// Photons, and the low and high word of the sum of their orders, by face, place and bin.
@group(0) @binding(4) var<storage, read_write> cells: array<atomic<u32>>;

override group_size: u32 = 64u;

// Goes on to the photon's end or next collision: 0 where it goes on, 1 where it left, 2 where it was absorbed.
fn walked(photon: ptr<function, Photon>) -> u32 {
    let words = random((*photon).index, (*photon).step);
    (*photon).step += 1u;
    var p = (*photon).position;
    var u = (*photon).direction;
    if (!is_outside(p.z)) {
        let flight = exponential(words.x);
        p = vec3f(plus(p.x, times(flight, u.x)), plus(p.y, times(flight, u.y)), plus(p.z, times(flight, u.z)));
    }
    if (is_outside(p.z)) {
        let upper = p.z < 0.0;
        if (matched || unit(words.y) >= reflectance(abs(u.z), settings.face)) {
            let beyond = times(select(plus(p.z, -settings.thickness), -p.z, upper), reciprocal(abs(u.z)));
            let x = plus(p.x, -times(beyond, u.x));
            let y = plus(p.y, -times(beyond, u.y));
            count_exit(x, y, (*photon).budget - (*photon).left, select(1u, 0u, upper));
            return 1u;
        }
        if (upper) {
            p.z = -p.z;
        } else {
            p.z = plus(2.0 * settings.thickness, -p.z);
        }
        u.z = -u.z;
    }
    (*photon).position = p;
    (*photon).direction = u;
    if (is_outside(p.z)) {
        return 0u;
    }
    if ((*photon).left == 0u) {
        return 2u;
    }
    (*photon).left -= 1u;
    (*photon).direction = scattered(u, words.z, words.w);
    return 0u;
}

@compute @workgroup_size(group_size)
fn walk(@builtin(global_invocation_id) id: vec3u) {
    let slot = id.x;
    if (slot >= settings.slots) {
        return;
    }
    var photon = loaded(slot);
    var ended = 0u;
    var absorbed = 0u;
    var collisions = 0u;
    for (var i = 0u; i < settings.steps; i++) {
        if (photon.number == 0u) {
            // Once all are launched nobody adds to the counter, which so cannot overflow
            if (atomicLoad(&counters.asked) >= settings.photons) {
                break;
            }
            let number = atomicAdd(&counters.asked, 1u);
            if (number >= settings.photons) {
                break;
            }
            photon = launched(number);
            photon.number = number + 1u;
        }
        let before = photon.left;
        let outcome = walked(&photon);
        collisions += before - photon.left;
        if (outcome != 0u) {
            ended += 1u;
            absorbed += outcome - 1u;
            photon.number = 0u;
        }
    }
    store(slot, photon);
    if (ended + collisions > 0u) {
        collisions += absorbed;
        atomicAdd(&counters.ended, ended);
        atomicAdd(&counters.absorbed, absorbed);
        let low = atomicAdd(&counters.collisions_low, collisions);
        if (low + collisions < low) {
            atomicAdd(&counters.collisions_high, 1u);
        }
    }
}

// The word of a photon in a slot: those of neighbors lie side by side.
fn place_of(word: u32, slot: u32) -> u32 {
    return word * settings.slots + slot;
}

fn loaded(slot: u32) -> Photon {
    var photon: Photon;
    photon.number = slots[place_of(0u, slot)];
    photon.index = vec2u(slots[place_of(1u, slot)], slots[place_of(2u, slot)]);
    photon.step = slots[place_of(3u, slot)];
    photon.left = slots[place_of(4u, slot)];
    photon.budget = slots[place_of(5u, slot)];
    for (var i = 0u; i < 3u; i++) {
        photon.position[i] = bitcast<f32>(slots[place_of(6u + i, slot)]);
        photon.direction[i] = bitcast<f32>(slots[place_of(9u + i, slot)]);
    }
    return photon;
}

fn store(slot: u32, photon: Photon) {
    slots[place_of(0u, slot)] = photon.number;
    slots[place_of(1u, slot)] = photon.index.x;
    slots[place_of(2u, slot)] = photon.index.y;
    slots[place_of(3u, slot)] = photon.step;
    slots[place_of(4u, slot)] = photon.left;
    slots[place_of(5u, slot)] = photon.budget;
    for (var i = 0u; i < 3u; i++) {
        slots[place_of(6u + i, slot)] = bitcast<u32>(photon.position[i]);
        slots[place_of(9u + i, slot)] = bitcast<u32>(photon.direction[i]);
    }
}
