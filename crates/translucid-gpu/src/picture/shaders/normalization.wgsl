// The share N of a profile that the surfaces around an exit hold, by which the light that leaves is divided: a sum over points all
// over them, as `subsurface/transport/points/gather.rs` of the renderer explains it. A cluster is opened where its own error is too
// large for it, not in the order of all errors, so that the errors add up to no more than they may there.

// A smooth profile has cells in octaves below and above its unit.
const SMOOTH_CELLS = (OCTAVES_BELOW + OCTAVES_ABOVE) << CELL_BITS;
// Words of its row: surface albedo, unit, four words of each cell, bounds of the curvature.
const SMOOTH_WORDS = 2u + 5u * SMOOTH_CELLS;
// Bits of the first radius and of the end.
const SMOOTH_FIRST = (127u - OCTAVES_BELOW) << 23u;
const SMOOTH_END = (127u + OCTAVES_ABOVE) << 23u;

const SOFTENING = 0.5;
const NEIGHBORHOOD = 2.0;
// Share up to which sums need not be exact, and the least that there is.
const DARK_SHARE = 1e-3;
const LEAST_SHARE = 1e-6;
// A path from the root to the deepest leaf.
const MOST_OPEN = 40u;

// Two rows of each channel's profile: their places, scales, and shares times the square of the scale.
struct SmoothRows {
    places: array<u32, 6>,
    scales: array<f32, 6>,
    weights: array<f32, 6>,
}

fn smooth_rows(profile: u32, exit: Below, unit_length: f32) -> SmoothRows {
    let count = u32(tables[profile]);
    var rows: SmoothRows;
    for (var c = 0u; c < 3u; c += 1u) {
        let albedo = exit.surface_albedo[c];
        var upper = 0u;
        while (upper + 1u < count && tables[profile + 1u + SMOOTH_WORDS * upper] < albedo) {
            upper += 1u;
        }
        let upper_albedo = tables[profile + 1u + SMOOTH_WORDS * upper];
        let lower = select(upper, max(upper, 1u) - 1u, upper_albedo > albedo);
        let lower_albedo = tables[profile + 1u + SMOOTH_WORDS * lower];
        let mixed = select(0.0, (albedo - lower_albedo) / (upper_albedo - lower_albedo), upper_albedo > lower_albedo);
        for (var k = 0u; k < 2u; k += 1u) {
            let row = profile + 1u + SMOOTH_WORDS * select(upper, lower, k == 0u);
            let scale = unit_length / (exit.length[c] * tables[row + 1u]);
            let share = select(mixed, 1.0 - mixed, k == 0u);
            rows.places[2u * c + k] = row + 2u;
            rows.scales[2u * c + k] = scale;
            rows.weights[2u * c + k] = select(0.0, share * scale * scale, exit.length[c] > 0.0 && share > 0.0);
        }
    }
    return rows;
}

// Density per area, its slope and second derivative, and no less than the last two over all radii from `least` on.
fn smooth_at(row: u32, t: f32, least: f32) -> vec4f {
    var jet = vec4f(0.0);
    // Bits of positive numbers rise as these do
    let bits = max(bitcast<u32>(t), SMOOTH_FIRST);
    if (bits < SMOOTH_END) {
        let at = row + 4u * ((bits - SMOOTH_FIRST) >> (23u - CELL_BITS));
        let c = vec4f(tables[at], tables[at + 1u], tables[at + 2u], tables[at + 3u]);
        let theta = bitcast<f32>(0x3f800000u | ((bits << CELL_BITS) & 0x007fffffu)) - 1.0;
        let per_width = bitcast<f32>((254u + CELL_BITS - (bits >> 23u)) << 23u);
        jet.x = c.x + theta * (c.y + theta * (c.z + theta * c.w));
        jet.y = (c.y + theta * (2.0 * c.z + 3.0 * theta * c.w)) * per_width;
        jet.z = (2.0 * c.z + 6.0 * theta * c.w) * per_width * per_width;
    }
    let least_bits = max(bitcast<u32>(least), SMOOTH_FIRST);
    if (least_bits < SMOOTH_END) {
        jet.w = tables[row + 4u * SMOOTH_CELLS + ((least_bits - SMOOTH_FIRST) >> (23u - CELL_BITS))];
    }
    return jet;
}

// Densities of the channels per area, their derivatives, and bounds of these.
struct SmoothJets {
    value: vec3f,
    slope: vec3f,
    second: vec3f,
    curvature: vec3f,
}

fn smooth_jets(rows: ptr<function, SmoothRows>, radius: f32, least: f32) -> SmoothJets {
    var jets: SmoothJets;
    for (var i = 0u; i < 6u; i += 1u) {
        let weight = (*rows).weights[i];
        if (weight > 0.0) {
            let scale = (*rows).scales[i];
            let jet = smooth_at((*rows).places[i], radius * scale, least * scale) * weight;
            jets.value[i / 2u] += jet.x;
            jets.slope[i / 2u] += jet.y * scale;
            jets.second[i / 2u] += jet.z * scale * scale;
            jets.curvature[i / 2u] += jet.w * scale * scale;
        }
    }
    return jets;
}

// Share that a cluster holds as a whole, and the bound of its error.
struct ClusterShare {
    share: vec3f,
    error: vec3f,
}

fn cluster_share(rows: ptr<function, SmoothRows>, cluster: u32, offset: vec3f, nearest: f32) -> ClusterShare {
    let radius = sqrt(dot(offset, offset) + SOFTENING * SOFTENING);
    let jets = smooth_jets(rows, radius, sqrt(nearest * nearest + SOFTENING * SOFTENING));
    // Rows of the symmetric spread
    let a = table_vector(cluster + 5u);
    let b = vec3f(a.y, tables[cluster + 8u], tables[cluster + 9u]);
    let c = vec3f(a.z, b.z, tables[cluster + 10u]);
    let along = dot(offset, vec3f(dot(a, offset), dot(b, offset), dot(c, offset))) / (radius * radius);
    let slope = jets.slope / radius;
    let bend = 0.5 * ((jets.second - slope) * along + slope * (a.x + b.y + c.z));
    let area = tables[cluster + 4u];
    return ClusterShare((jets.value + bend) * area, 0.5 * jets.curvature * tables[cluster + 11u] + abs(bend) * area);
}

// Factor on the light that leaves at an exit of a material; 1 where nothing is to be made up for.
fn shape_factor(material: u32, group: u32, exit: Below, position: vec3f) -> vec3f {
    let profile_at_place = u32(tables[material_at(material) + NORMALIZATION]);
    let shapes = head(SHAPES);
    if (profile_at_place == 0u || shapes == 0u) {
        return vec3f(1.0);
    }
    // Group by group: halves of the number, origin, 1 / spacing, clusters, points
    var at = 0u;
    for (var k = 0u; k < u32(tables[shapes + 1u]); k += 1u) {
        let place = shapes + 2u + GROUP_WORDS * k;
        if ((u32(tables[place]) | (u32(tables[place + 1u]) << 16u)) == group) {
            at = place;
        }
    }
    if (at == 0u) {
        return vec3f(1.0);
    }
    let tolerance = tables[shapes];
    let per_spacing = tables[at + 5u];
    let clusters = shapes + u32(tables[at + 6u]);
    let points = shapes + u32(tables[at + 7u]);
    let place = (position - table_vector(at + 2u)) * per_spacing;
    var rows = smooth_rows(head(MEDIA) + profile_at_place, exit, 1.0 / per_spacing);
    var energy = vec3f(0.0);
    let kernel = kernel_of(material);
    for (var c = 0u; c < 3u; c += 1u) {
        if (exit.length[c] > 0.0) {
            let within = profile_at(profile_of(kernel, exit.surface_albedo[c], exit.length[c]), SOFTENING / per_spacing).yz;
            energy[c] = min(within.x + within.y, 1.0);
        }
    }
    let whole_area = tables[clusters + 4u];
    var open: array<u32, MOST_OPEN>;
    var count = select(0u, 1u, points > clusters);
    open[0] = 0u;
    // Two loops, for drivers that end a long one
    for (var k = 0u; k < 65536u && count > 0u; k += 1u) {
        for (var l = 0u; l < 64u && count > 0u; l += 1u) {
            count -= 1u;
            let node = open[count];
            let cluster = clusters + CLUSTER_WORDS * node;
            let radius = tables[cluster + 3u];
            let offset = table_vector(cluster) - place;
            let far = length(offset);
            let right = u32(tables[cluster + 12u]);
            if (far - radius > NEIGHBORHOOD) {
                let part = cluster_share(&rows, cluster, offset, max(far - radius, 0.0));
                let area = tables[cluster + 4u] / whole_area;
                let allowed = 0.5 * tolerance * (part.share + max(energy, vec3f(DARK_SHARE)) * area);
                if (all(part.error <= allowed)) {
                    energy += part.share;
                    continue;
                }
            }
            if (right != 0u) {
                open[count] = right;
                open[count + 1u] = node + 1u;
                count += 2u;
                continue;
            }
            let start = points + SURFEL_WORDS * u32(tables[cluster + 13u]);
            for (var i = 0u; i < u32(tables[cluster + 14u]); i += 1u) {
                let surfel = start + SURFEL_WORDS * i;
                let way = table_vector(surfel) - place;
                let radius = sqrt(dot(way, way) + SOFTENING * SOFTENING);
                energy += smooth_jets(&rows, radius, NEVER).value * tables[surfel + 3u];
            }
        }
    }
    var factor = vec3f(1.0);
    for (var c = 0u; c < 3u; c += 1u) {
        if (energy[c] > 0.0 && energy[c] < NEVER) {
            factor[c] = 1.0 / max(energy[c], LEAST_SHARE);
        }
    }
    return factor;
}
