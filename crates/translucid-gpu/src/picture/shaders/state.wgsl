// Paths under way, one for each slot, and the lists of slots by the work that they wait for.

// What a slot waits for.
const IDLE = 0u;        // a sample
const FREE_RAY = 1u;    // its ray outside of bodies to be followed
const FREE_HIT = 2u;    // what the ray has met
const WALK_RAY = 3u;    // a flight through a body to be followed
const WALK_HIT = 4u;    // where the flight has ended
const WALK_END = 5u;    // the body's end there
const AT_SURFACE = 6u;  // a surface to scatter it
const COLLIDED = 7u;    // a medium to scatter it
const AT_MATTE_END = 8u; // to go on where light enters a matte surface
const ENDED = 9u;       // its light sample alone
const PROBE_NEXT = 10u; // the next probe for an entry point to be drawn
const PROBE_RAY = 11u;  // a probe to be followed to its next hit
const PROBE_HIT = 12u;  // what the probe has met
const PROBE_END = 13u;  // the entry point there
const WALK_DEPTH = 15u; // how deep the end of its flight is
const AT_CATCHER = 14u; // a light sample for the shadows on a surface that is not seen itself

// Layer of the picture that a path brings light to.
const OF_EMISSION = 0u;
const OF_SURFACE = 1u;
const OF_SUBSURFACE = 2u;

// Flags of a path.
const HAS_MET = 1u;    // a surface that the camera sees
const SOFT = 2u;       // it has left a matte surface, and there are no caustics
const IS_FIRST = 4u;   // the surface at hand is the first that the camera sees
const UNLIT = 8u;      // the surface at hand has taken no numbers for a light sample
const HAS_SCATTERED = 16u; // its walk has had a collision
const AT_LIMIT = 32u;  // the flight at hand ends where another medium may be, without a collision

// Layers that a light sample brings light to.
const TO_SURFACE = 0u;
const TO_SUBSURFACE = 1u;
const TO_ALPHA = 2u;   // what arrives takes from the shadows

// Stages of a light sample.
const NO_SHADOW = 0u;
const FREE_SHADOW = 1u;
const BODY_SHADOW = 2u;
const SHELL_SHADOW = 3u; // the same way again, through shells

struct Path {
    // Of its ray, or where its walk got the direction.
    origin: vec3f,
    work: u32,
    direction: vec3f,
    item: u32,
    throughput: vec3f,
    depth: u32,
    // Absorption coefficient of the clear medium around the ray.
    absorption: vec3f,
    diffuse_depth: u32,
    // The last point at which it was scattered, for MIS: the normal given to the selection of lights, and the density of
    // the direction, NEVER or above where lights could not be sampled instead.
    mis_point: vec3f,
    mis_pdf: f32,
    mis_normal: vec3f,
    flags: u32,
    // Part of the surface's light that is matte.
    diffuse_share: vec3f,
    layer: u32,
    sampler: Sampler,
    vertex: u32,
    // Surfaces passed straight in a row.
    passes: u32,
    hit: vec2f,
    hit_t: f32,
    hit_triangle: u32,
}

// A walk: from flight to flight through the body below the surface that the path has met.
struct Walk {
    start: vec3f,
    // Closed meshes of the group that it is in.
    nesting: u32,
    direction: vec3f,
    // Length of the flight, and the part of it that was followed.
    length: f32,
    sigma_t: vec3f,
    done: f32,
    alpha: vec3f,
    // Way from the surface to the point below it where the walk began.
    skipped: f32,
    // Sum of the throughput below which it may end at random.
    entered: f32,
    side: f32,
    offset: f32,
    // Density of its direction, NEVER where that was not drawn at a collision.
    pdf: f32,
    material: u32,
    events: u32,
    // Single numbers that it has taken, and its depth where the flight began: both for shells.
    draws: u32,
    depth: f32,
}

// Probes for the entry points of light that leaves at a point.
struct Probe {
    exit: vec3f,
    // The axis at hand, the first one with light, and the number by which a hit is picked.
    axis: u32,
    // Geometric normal at the exit.
    normal: vec3f,
    // The hit before, and its triangle.
    t: f32,
    surface_albedo: vec3f,
    triangle: u32,
    length: vec3f,
    // Importance of all hits; once it is known, how much of it comes before the hit that is picked, below 0 until then.
    sum: f32,
    goal: f32,
    t_max: f32,
    first_axis: u32,
    pick: f32,
}

// A light sample on its way from a point to the light.
struct Shadow {
    origin: vec3f,
    stage: u32,
    direction: vec3f,
    t_max: f32,
    // Light for the layers of matte and specular reflection, or all of it for another.
    matte: vec3f,
    layer: u32,
    specular: vec3f,
    passes: u32,
    absorption: vec3f,
    is_soft: u32,
    // Through a body: extinction, distance to the light, and what was followed.
    sigma_t: vec3f,
    light_distance: f32,
    // Share of each channel in flights by which the way out was drawn, 0 where it was not; what shells leave of the light.
    share: vec3f,
    done: f32,
    nesting: u32,
    group: u32,
    side: f32,
    offset: f32,
    length: f32,
    hit_triangle: u32,
    hit: vec2f,
    hit_t: f32,
    // Through shells: of which material, how deep it is, and the state of its random numbers.
    material: u32,
    depth: f32,
    random: u32,
}

// Light and features of a sample.
struct Found {
    matte: vec3f,
    alpha: f32,
    specular: vec3f,
    depth: f32,
    subsurface: vec3f,
    emission: vec3f,
    albedo: vec3f,
    normal: vec3f,
}

// A light sample for a point with a normal, or 0: all directions count.
struct Light {
    direction: vec3f,
    distance: f32,
    radiance: vec3f,
    pdf: f32,
    point: vec3f,
    // One more number.
    random: f32,
    normal: vec3f,
    // Neither, usable, or also a delta light's.
    kind: u32,
}

const NO_LIGHT = 0u;
const USABLE = 1u;
const DELTA = 2u;

struct Slot {
    path: Path,
    walk: Walk,
    shadow: Shadow,
    found: Found,
    light: Light,
    probe: Probe,
    met: Met,
    // Where the light sample is.
    shadow_met: Met,
}

@group(0) @binding(6) var<storage, read_write> slots: array<Slot>;
// Counters, then lists of slots.
@group(0) @binding(7) var<storage, read_write> queues: array<atomic<u32>>;
// Samples that are done, by their number in this call.
@group(0) @binding(8) var<storage, read_write> samples: array<f32>;

// Counters.
const NEXT_ITEM = 0u;
const DONE_ITEMS = 1u;
// Lists, which are empty at the start of a round.
const RAYS = 2u;
const SHADOWS = 3u;
const FLIGHTS = 4u;
const POINTS = 5u;
const SHADOW_HITS = 6u;
const LIGHT_REQUESTS = 7u;
const SCATTERS = 8u;
const PROBES = 9u;
// Walks and light samples that need to know how deep they are.
const DEPTHS = 10u;
const SHADOW_DEPTHS = 11u;
const_assert RAYS == FIRST_LIST && SHADOW_DEPTHS + 1u == COUNTERS;

fn enqueue(list: u32, slot: u32) {
    let place = atomicAdd(&queues[list], 1u);
    atomicStore(&queues[COUNTERS + (list - RAYS) * settings.slots + place], slot);
}

// The slot at a place of a list, or `slots` behind its end.
fn dequeue(list: u32, place: u32) -> u32 {
    if (place >= atomicLoad(&queues[list])) {
        return settings.slots;
    }
    return atomicLoad(&queues[COUNTERS + (list - RAYS) * settings.slots + place]);
}

const MOST_PASSES = 256u;
// Light beyond this is cut off.
const GREATEST_LIGHT = 1e26;

fn is_zero(color: vec3f) -> bool {
    return !(greatest(abs(color)) > 0.0);
}

// Adds light at a path's end to its layer.
fn add_light(path: ptr<function, Path>, found: ptr<function, Found>, radiance: vec3f) {
    let light = (*path).throughput * radiance;
    if ((*path).layer == OF_EMISSION) {
        (*found).emission += light;
    } else if ((*path).layer == OF_SUBSURFACE) {
        (*found).subsurface += light;
    } else {
        (*found).matte += light * (*path).diffuse_share;
        (*found).specular += light * (1.0 - (*path).diffuse_share);
    }
}

// Goes on in a new direction.
fn scatter(path: ptr<function, Path>, layer: u32, share: vec3f, origin: vec3f, direction: vec3f, weight: vec3f) {
    if ((*path).layer == OF_EMISSION) {
        (*path).layer = layer;
        (*path).diffuse_share = share;
    }
    (*path).throughput *= weight;
    (*path).origin = origin;
    (*path).direction = direction;
    (*path).depth += 1u;
    (*path).passes = 0u;
    (*path).work = select(FREE_RAY, ENDED, is_zero((*path).throughput));
}

// Goes on behind a surface in the same direction.
fn pass_surface(path: ptr<function, Path>, met: ptr<function, Met>, transmittance: vec3f) {
    (*path).throughput *= transmittance;
    (*path).origin = ray_origin(met, (*path).direction);
    (*path).passes += 1u;
    (*path).work = select(FREE_RAY, ENDED, is_zero((*path).throughput) || (*path).passes >= MOST_PASSES);
}

fn is_of_camera(path: ptr<function, Path>) -> bool {
    return (*path).depth == 0u && ((*path).flags & HAS_MET) == 0u;
}
