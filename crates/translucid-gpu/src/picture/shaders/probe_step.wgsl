// Probes for the entry points of light that leaves at a point: `subsurface/transport/probes` of the renderer, a hit at a time.
//
// A probe is a segment along one of three axes. Its hits come in their order, each by a ray of its own: first their weights are
// summed up, then they are gone through again to the one that stands for all.

// Part of a probe's length within which two hits that face the same way are one.
const SAME_PLACE = 1e-6;
// |n · axis| below which a hit is left out: its density would be rounding noise.
const GRAZING = 1e-6;
// Profiles by which entries are found: the exit's, and where entries count the widest that there are; then that of a hit.
const PROFILES = 9u;
// Axes, and the number of none.
const AXIS_COUNT = 3u;
const NO_AXIS = 0xffffffffu;

// Goes below the surface that the camera, or a path, sees.
fn begin_probes(slot: u32, path: ptr<function, Path>, met: ptr<function, Met>, normal: vec3f) {
    (*path).work = PROBE_NEXT;
    (*path).hit_triangle = NO_TRIANGLE;
    var probe: Probe;
    probe.exit = (*met).position;
    probe.normal = (*met).geometric;
    probe.surface_albedo = (*met).surface.surface_albedo;
    probe.length = (*met).length;
    probe.axis = NO_AXIS;
    probe.first_axis = NO_AXIS;
    probe.triangle = NO_TRIANGLE;
    probe.goal = -1.0;
    slots[slot].probe = probe;
    slots[slot].walk.material = (*met).material;
    slots[slot].walk.offset = (*met).offset;
    let side = select(1.0, -1.0, dot((*path).direction, (*met).geometric) > 0.0);
    slots[slot].walk.side = side;
    // No walk has it meanwhile
    slots[slot].walk.direction = normal * side;
}

fn axis_of(frame: mat3x3f, axis: u32) -> vec3f {
    return select(select(frame[2], frame[1], axis == 1u), frame[0], axis == 0u);
}

// A hit of a probe, or none: weighs it, and sets the next ray.
fn probe_step(path: ptr<function, Path>, probe: ptr<function, Probe>, material: u32, offset: f32) {
    let kernel = kernel_of(material);
    let pairing = pairing_of(material);
    let is_hit = (*path).hit_triangle != NO_TRIANGLE;
    let exit = Below((*probe).surface_albedo, (*probe).length);
    let scatters = exit.length > vec3f(0.0);
    var brightest = exit.surface_albedo;
    var widest = exit;
    // Of the hit
    var below = exit;
    var proposals = 3u;
    var profile_count = 3u;
    if (pairing != 0u) {
        brightest = brightest_pair(pairing, exit.surface_albedo);
        widest = Below(table_vector(pairing + WIDEST_ALBEDO), table_vector(pairing + WIDEST_LENGTH));
        proposals = 6u;
        profile_count = select(6u, PROFILES, is_hit);
        if (is_hit) {
            below = pair_of(kernel, pairing, exit, material, offset, (*path).hit_triangle, (*path).hit);
        }
    }
    var shares = select(vec3f(0.0), brightest, scatters) * (*path).throughput;
    let all = sum(shares);
    (*path).work = ENDED;
    if (!(all > 0.0 && all < NEVER)) {
        return;
    }
    shares /= all * f32(proposals / 3u);
    // Channels that do not scatter have the profile of the first that does
    let first = select(select(2u, 1u, scatters.y), 0u, scatters.x);
    var profiles: array<Profile, PROFILES>;
    var within: array<vec2f, PROFILES>;
    for (var i = 0u; i < profile_count; i += 1u) {
        var parameters = below;
        if (i < 3u) {
            parameters = exit;
        } else if (i < 6u) {
            parameters = widest;
        }
        let c = select(first, i % 3u, scatters[i % 3u]);
        profiles[i] = profile_of(kernel, parameters.surface_albedo[c], parameters.length[c]);
        within[i] = profile_at(profiles[i], profiles[i].longest).yz;
    }
    let axes = table_vector(kernel + AXES);
    let frame = frame_of((*probe).normal);
    if (!is_hit) {
        next_probe(path, probe, &profiles, &within, proposals, shares, axes, frame);
        return;
    }

    // Weight of the hit: R over the density of all axes and channels, which have the projected distances
    let triangle = triangle_at((*path).hit_triangle);
    let before = (*probe).triangle;
    let normal = geometric_normal(triangle);
    let is_near = before != NO_TRIANGLE && (*path).hit_t - (*probe).t <= SAME_PLACE * (*probe).t_max;
    (*probe).t = (*path).hit_t;
    (*probe).triangle = (*path).hit_triangle;
    (*path).work = PROBE_RAY;
    if (abs(dot(axis_of(frame, (*probe).axis), normal)) < GRAZING) {
        return;
    }
    if (is_near && dot(normal, geometric_normal(triangle_at(before))) > 0.999) {
        return;
    }
    let b = (*path).hit;
    let position = triangle.a * (1.0 - b.x - b.y) + triangle.b * b.x + triangle.c * b.y;
    let passage = to_local(frame, position - (*probe).exit);
    let cosines = axes * abs(to_local(frame, normal));
    let distance = length(passage);
    let squares = passage * passage;
    let projected = max(sqrt(squares.yzx + squares.zxy), vec3f(distance * 1e-6));
    let radii = vec4f(projected, distance);
    var density = 0.0;
    var value = vec3f(0.0);
    for (var k = 0u; k < 4u; k += 1u) {
        var densities = vec3f(0.0);
        let is_value = k == 3u;
        for (var i = select(0u, profile_count - 3u, is_value); i < select(proposals, profile_count, is_value); i += 1u) {
            if (distance <= profiles[i].longest) {
                densities[i % 3u] += profile_at(profiles[i], radii[k]).x / min(within[i].x + within[i].y, 1.0);
            }
        }
        if (k < 3u) {
            density += cosines[k] * select(1.0, distance / radii[k], distance > 0.0) * dot(shares, densities);
        } else {
            value = select(vec3f(0.0), below.surface_albedo * densities, below.length > vec3f(0.0));
        }
    }
    if (!(density > 0.0)) {
        return;
    }
    let weight = value / density;
    let importance = dot(weight, (*path).throughput);
    if ((*probe).goal < 0.0) {
        (*probe).sum += importance;
        if (importance > 0.0 && (*probe).first_axis == NO_AXIS) {
            (*probe).first_axis = (*probe).axis;
        }
        return;
    }
    // The hit at which the running sum passes the goal stands for all of them
    (*probe).goal -= importance;
    if ((*probe).goal < 0.0) {
        (*path).throughput *= weight * ((*probe).sum / importance);
        (*path).work = PROBE_END;
        // By which light enters there
        (*probe).surface_albedo = below.surface_albedo;
        (*probe).length = below.length;
    }
}

// The ray of the next axis that is probed; from the first axis with light again once all are summed up.
fn next_probe(
    path: ptr<function, Path>,
    probe: ptr<function, Probe>,
    profiles: ptr<function, array<Profile, PROFILES>>,
    within: ptr<function, array<vec2f, PROFILES>>,
    proposals: u32,
    shares: vec3f,
    axes: vec3f,
    frame: mat3x3f,
) {
    (*path).work = ENDED;
    var axis = (*probe).axis + 1u;
    // All axes once more, at the most
    for (var k = 0u; k < 2u * AXIS_COUNT; k += 1u) {
        if (axis >= AXIS_COUNT) {
            let all = (*probe).sum;
            if ((*probe).goal >= 0.0 || !(all > 0.0 && all < NEVER)) {
                return;
            }
            // The last axis has the number by which a hit is picked
            (*probe).goal = (*probe).pick * all;
            axis = (*probe).first_axis;
        }
        let u = stratified((*path).sampler, (*path).vertex, surface_sets((*path).flags) + axis);
        (*probe).pick = u.w;
        if (u.x < axes[axis]) {
            var rest = u.x / axes[axis];
            var chosen = 0u;
            for (var i = 0u; i < proposals; i += 1u) {
                let share = shares[i % 3u];
                if (share > 0.0) {
                    chosen = i;
                    if (rest < share) {
                        break;
                    }
                    rest -= share;
                }
            }
            if (set_segment(path, probe, (*profiles)[chosen], (*within)[chosen], u.yz, axis, frame)) {
                return;
            }
        }
        axis += 1u;
    }
}

// The segment of a probe, inside the ball of its channel, and near the scene: false where there is nothing to meet.
fn set_segment(
    path: ptr<function, Path>,
    probe: ptr<function, Probe>,
    profile: Profile,
    within: vec2f,
    u: vec2f,
    axis: u32,
    frame: mat3x3f,
) -> bool {
    let radius = profile_sample(profile, within, u.x);
    let half_way = sqrt(max(profile.longest - radius, 0.0)) * sqrt(profile.longest + radius);
    let around = circle(u.y) * radius;
    let across = axis_of(frame, (axis + 1u) % 3u) * around.x + axis_of(frame, (axis + 2u) % 3u) * around.y;
    let center = (*probe).exit + across;
    let direction = -axis_of(frame, axis);
    let middle = dot(table_vector(MIDDLE) - center, direction);
    let reach = tables[DIAGONAL];
    let start = max(-half_way, middle - reach);
    let end = min(half_way, middle + reach);
    (*path).origin = center + direction * start;
    (*path).direction = direction;
    (*path).work = PROBE_RAY;
    (*probe).t_max = end - start;
    (*probe).t = 0.0;
    (*probe).triangle = NO_TRIANGLE;
    (*probe).axis = axis;
    return start < end;
}

// Factor on light that enters from a direction: the profile of oblique light, or the directional dipole, over the radial one,
// by which entry points are found. Terms and formulas are those of exports.
fn directional_weight(
    probe: ptr<function, Probe>,
    met: ptr<function, Met>,
    normal: vec3f,
    exit_normal: vec3f,
    kernel: u32,
    toward: vec3f,
) -> vec3f {
    if (tables[kernel + DIRECTIONS] == 0.0) {
        return vec3f(1.0);
    }
    let is_dipole = tables[kernel + DIRECTIONS] == DIPOLE;
    oblique_means = table_vector(kernel + OBLIQUE_MEANS);
    oblique_is_searchlight = tables[kernel + IS_SEARCHLIGHT] > 0.0;
    let cos_outside = min(dot(toward, normal), 1.0);
    let onward = cos_outside * normal - toward;
    let sin_outside = length(onward);
    let sin_inside = sin_outside / tables[kernel + REFRACTION_ETA];
    if (!(cos_outside > 0.0 && sin_inside < 1.0)) {
        return vec3f(0.0);
    }
    let cos_inside = sqrt((1.0 - sin_inside) * (1.0 + sin_inside));
    let offset = (*probe).exit - (*met).position;
    let r = length(offset);
    let versine = 1.0 - share_of(dot(offset, onward), r * sin_outside);
    let rise = share_of(dot(offset, normal), r);
    var factor = vec3f(0.0);
    for (var c = 0u; c < 3u; c += 1u) {
        let albedo = min((*probe).surface_albedo[c], tables[kernel + BRIGHTEST]);
        var mfp = (*probe).length[c];
        if (!(mfp > 0.0 && albedo > 0.0)) {
            continue;
        }
        let radial = albedo * profile_at(profile_of(kernel, albedo, mfp), r).x;
        if (is_dipole) {
            let value = dipole_density(kernel, albedo, mfp, offset, toward, normal, exit_normal);
            if (radial > 0.0 && value < NEVER * radial) {
                factor[c] = value / radial;
            }
            continue;
        }
        if (tables[kernel + IS_DMFP] > 0.0) {
            mfp = refined_mfp_from_dmfp(min(albedo, 0.9999999), mfp);
        }
        let terms = oblique_terms(albedo, mfp, cos_inside);
        let weights = vec4f(terms.weight_a, terms.weight_b, terms.weight_c, terms.weight_d);
        let rates = vec4f(terms.rate_a, terms.rate_b, terms.rate_c, terms.rate_d);
        let sines = vec4f(terms.sine_a, terms.sine_b, terms.sine_c, terms.sine_d);
        let cosines = vec4f(terms.cosine_a, terms.cosine_b, terms.cosine_c, terms.cosine_d);
        // Off the plane each term's density of the azimuth has the eccentricity of the part along it
        let lifted = sqrt(cosines * cosines + sines * sines * (rise * rise));
        let around = lifted / (cosines * cosines / (1.0 + sines) + sines * versine);
        let value = dot(weights * rates, exp(-min(rates * r, vec4f(80.0))) * around) * terms.total;
        if (radial > 0.0 && value < NEVER * radial) {
            factor[c] = value / radial;
        }
    }
    return factor;
}

// Part of a whole, in [-1, 1]; 0 at the entry, and for light along the normal.
fn share_of(part: f32, whole: f32) -> f32 {
    if (!(whole > 0.0)) {
        return 0.0;
    }
    return clamp(part / whole, -1.0, 1.0);
}
