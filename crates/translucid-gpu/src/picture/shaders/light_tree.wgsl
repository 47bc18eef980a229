// The light tree: selects one of many lights at a point, at a cost that grows with the logarithm of their number
// [A. Conty Estevez & C. Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting", Proc. ACM Comput.
// Graph. Interact. Tech. 1(2)].
//
// The tree is the processor's, and so is the weight of a cluster. The choice begins at the root; a light is weighed as a
// cluster of one.

// Children of a node; the words of one are center, half size, radius, axis, cosine and sine of θ_o, cosine of θ_e, strength,
// mean, lean, alike, child (0 none, a node's number + 1, −(a light's number + 1)).
const TREE_WIDTH = 8u;
// Nodes from the root to a light, at most.
const TREE_DEPTH = 64u;
// Share of a node's samples that goes evenly to all children that can contribute, in case the important ones are hidden.
const TREE_EVEN_SHARE = 0.02f;
// Room for rounding in the cosines of cones, and in the height above the horizon.
const COSINE_ROOM = 1e-3f;
const HORIZON_ROOM = 1e-6f;
// Least share of the mean intensity that a cluster is taken to shed in any direction where it may shed light at all.
const LEAST_LEAN = 0.1f;
// Distances to a cluster count as at least this share of its radius.
const NEAREST = 0.5f;

// Weights of the children of the node that was weighed last.
var<private> tree_weights: array<f32, TREE_WIDTH>;

// Weighs a node's children: the sum, and how many can contribute.
fn tree_weigh(node: u32, point: vec3f, normal: vec3f) -> vec2f {
    var sums = vec2f(0.0);
    for (var lane = 0u; lane < TREE_WIDTH; lane++) {
        let weight = tree_weight(tree_lane(node, lane), point, normal);
        tree_weights[lane] = weight;
        sums += vec2f(weight, select(0.0, 1.0, weight > 0.0));
    }
    return sums;
}

fn tree_lane(node: u32, lane: u32) -> u32 {
    return lights_at + light_number(12u) + (node * TREE_WIDTH + lane) * TREE_LANE;
}

// Probability of a child of the node that was weighed last.
fn tree_share(lane: u32, sums: vec2f) -> f32 {
    let weight = tree_weights[lane % TREE_WIDTH];
    let share = (1.0 - TREE_EVEN_SHARE) * weight / sums.x + TREE_EVEN_SHARE / sums.y;
    return select(0.0, share, weight > 0.0);
}

// Estimate of the irradiance (luminance) that a cluster brings; 0 only if it cannot contribute.
fn tree_weight(at: u32, point: vec3f, normal: vec3f) -> f32 {
    let strength = tables[at + 13u];
    if (!(strength > 0.0)) {
        return 0.0;
    }
    // Distance to the center, not less than the box's radius
    let to = table_vector(at) - point;
    let half_size = table_vector(at + 3u);
    let radius = tables[at + 6u];
    let distance2 = dot(to, to);
    let distance = sqrt(distance2);
    let per_distance = 1.0 / max(distance, radius);
    // θ, from the axis to the receiver, less θ_o
    let cos = -dot(table_vector(at + 7u), to) * per_distance;
    let sin = sqrt(max(1.0 - cos * cos, 0.0));
    let cos_o = tables[at + 10u];
    let sin_o = tables[at + 11u];
    let in_cone = cos >= cos_o;
    let cos_x = select(cos * cos_o + sin * sin_o, 1.0, in_cone);
    let sin_x = select(sin * cos_o - cos * sin_o, 0.0, in_cone);
    // … less θ_u, half the angle at which the receiver sees the box
    let sin_u = radius * per_distance;
    let cos_u = sqrt(max(1.0 - sin_u * sin_u, 0.0));
    let is_facing = distance2 <= radius * radius || cos_x >= cos_u;
    let cos_emitted = select(cos_x * cos_u + sin_x * sin_u, 1.0, is_facing);
    // The bound as an estimate where all normals are the same, else the mean over directions and how it leans
    let bound = strength * max(cos_emitted, COSINE_ROOM);
    let mean = tables[at + 14u];
    let moments = max(mean - dot(table_vector(at + 15u), to) * per_distance, LEAST_LEAN * mean);
    let alike = tables[at + 18u];
    let intensity = alike * bound + (1.0 - alike) * min(moments, bound);
    // Mean cosine over heights from the lowest to the highest corner, above the horizon
    let middle = dot(normal, to) * per_distance;
    let reach = dot(abs(normal), half_size) * per_distance + HORIZON_ROOM;
    let highest = middle + reach;
    var cosine = 1.0;
    if (!is_zero_vector(normal)) {
        if (highest <= 0.0) {
            return 0.0;
        }
        cosine = min(select(highest * highest / (4.0 * reach), middle, middle >= reach), 1.0);
    }
    if (cos_emitted < tables[at + 12u]) {
        return 0.0;
    }
    let nearness = 1.0 / max(distance, NEAREST * radius);
    return clamp(intensity * nearness * nearness * cosine, LEAST_IMPORTANCE, GREATEST_IMPORTANCE);
}

// Selects a light of the tree by a word. Where bounds are too wide, it may turn out that none can contribute.
fn tree_choose(word: u32, point: vec3f, normal: vec3f) -> LightChoice {
    var state = word;
    var probability = 1.0;
    var node = 0u;
    for (var depth = 0u; depth < TREE_DEPTH; depth++) {
        let sums = tree_weigh(node, point, normal);
        if (!(sums.x > 0.0)) {
            return LightChoice(0u, 0.0);
        }
        // A number of its own for each node: 24 bits are too few to choose by what is left of them
        state = state * 747796405u + 2891336453u;
        let hash = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
        let u = f32(((hash >> 22u) ^ hash) >> 8u) * 0x1p-24f;
        var end = 0.0;
        var share = 0.0;
        var chosen = 0u;
        for (var lane = 0u; lane < TREE_WIDTH; lane++) {
            let lane_share = tree_share(lane, sums);
            if (lane_share > 0.0) {
                chosen = lane;
                share = lane_share;
                end += lane_share;
                if (u < end) {
                    break;
                }
            }
        }
        probability *= share;
        let child = tables[tree_lane(node, chosen) + 19u];
        if (child < 0.0) {
            return LightChoice(u32(-child) - 1u, probability);
        }
        node = u32(child) - 1u;
    }
    return LightChoice(0u, 0.0);
}

// Probability with which `tree_choose` selects the light in a lane, counted over all nodes.
fn tree_probability(leaf: u32, point: vec3f, normal: vec3f) -> f32 {
    var probability = 1.0;
    var place = leaf;
    for (var depth = 0u; depth < TREE_DEPTH; depth++) {
        let node = place / TREE_WIDTH;
        let sums = tree_weigh(node, point, normal);
        probability *= tree_share(place % TREE_WIDTH, sums);
        if (node == 0u || !(probability > 0.0)) {
            return probability;
        }
        place = light_number(light_number(14u) + node);
    }
    return 0.0;
}
