// The walk through a body, a flight at a time: `subsurface/transport/walk` of the renderer, without light that walks share.

// Share of the light that entered below which walks end at random.
const ROULETTE_BELOW = 0.25;
// Sets of numbers of a vertex behind those of the surface: of probes, behind which are two of their end; of a walk's first
// events, between clear surfaces and, behind two of its end, between matte ones.
const PROBE_SETS = 3u;
const CLEAR_SETS = 5u;
const MATTE_SETS = 3u;
const END_SETS = 2u;

// Numbers of a walk: stratified for its first events, then independent, behind so many single ones.
fn walk_numbers(path: ptr<function, Path>, is_clear: bool, number: u32, draws: u32) -> vec4f {
    let first = surface_sets((*path).flags) + select(END_SETS, 0u, is_clear);
    let sets = select(MATTE_SETS, CLEAR_SETS, is_clear);
    if (number < sets) {
        return stratified((*path).sampler, (*path).vertex, first + number);
    }
    return independent((*path).sampler, (*path).vertex * SETS_PER_VERTEX + first, 2u * (number - sets) + draws);
}

// The next two single numbers of a walk, in the order in which the processor takes them.
fn single_numbers(path: ptr<function, Path>, walk: ptr<function, Walk>, is_clear: bool) -> vec2f {
    let first = surface_sets((*path).flags) + select(END_SETS, 0u, is_clear);
    let sets = select(MATTE_SETS, CLEAR_SETS, is_clear);
    let taken = (*walk).events * select(1u, 2u, is_clear) - select(0u, 1u, is_clear);
    let draws = 2u * (max(taken, sets) - sets) + (*walk).draws;
    return independent((*path).sampler, (*path).vertex * SETS_PER_VERTEX + first, draws).xz;
}

// Set of numbers for the light sample at a matte end, behind which is that for the way on.
fn end_set(flags: u32, m: u32) -> u32 {
    return surface_sets(flags) + select(0u, PROBE_SETS, u32(tables[m + BELOW_KIND]) == PROFILE_BELOW);
}

// Sets of numbers of a vertex that are the surface's: its choices, the light sample, the way on.
fn surface_sets(flags: u32) -> u32 {
    return select(3u, 2u, (flags & UNLIT) != 0u);
}

// Goes below the surface that the camera, or a path, sees.
fn begin_walk(slot: u32, path: ptr<function, Path>, met: ptr<function, Met>, normal: vec3f) {
    (*path).work = ENDED;
    let m = material_at((*met).material);
    let side = select(1.0, -1.0, dot((*path).direction, (*met).geometric) > 0.0);
    let outward = (*met).geometric * side;
    let is_clear = u32(tables[m + WALK_SURFACE]) == CLEAR;
    let u = walk_numbers(path, is_clear, 0u, 0u);
    let toward = (*path).direction;
    let eta = tables[m + WALK_ETA];
    let surface = u32(tables[m + WALK_SURFACE]);
    var direction = toward;
    if (surface == CLEAR) {
        if (eta != 1.0) {
            let bent = refracted(-toward, outward, eta);
            if (!bent.exists) {
                return;
            }
            direction = bent.direction;
        }
    } else {
        let frame = frame_of(normal * side);
        var choice = u.xy;
        var is_diffuse = surface == DIFFUSE_SURFACE;
        var roughness = 1.0;
        if (surface == SKIN) {
            is_diffuse = u.x < 0.5;
            choice.x = select(2.0 * u.x - 1.0, 2.0 * u.x, is_diffuse);
        } else if (surface == ROUGH) {
            roughness = (*met).surface.specular_roughness;
        }
        if (is_diffuse) {
            direction = -(frame * sample_cosine(choice));
        } else if (eta != 1.0) {
            let wo = to_local(frame, -toward);
            let bent = refracted(wo, ggx_sample_visible(ggx_from_roughness(roughness), wo, choice), eta);
            if (!bent.exists) {
                return;
            }
            direction = frame * bent.direction;
        }
        // Where the shading normal leads outside, the mirror image leads as far in
        direction = normalize(direction - outward * (2.0 * max(dot(direction, outward), 0.0)));
    }
    let cosine = -dot(direction, outward);
    // Channels of length 0 are a matter of the surface
    let scatters = (*met).length > vec3f(0.0);
    let throughput = select(vec3f(0.0), (*path).throughput, scatters);
    let all = sum(throughput);
    if (!(cosine > 0.0) || !(all > 0.0 && all < NEVER)) {
        return;
    }
    // On the ray where it is deep enough, unless it hardly gets deeper
    let skipped = (*met).offset / max(cosine, 0.1);
    var walk: Walk;
    walk.start = (*met).position + direction * skipped - outward * ((*met).offset - skipped * cosine);
    walk.nesting = 1u;
    walk.direction = direction;
    walk.sigma_t = select(vec3f(0.0), 1.0 / max((*met).length, vec3f(1e-30)), scatters);
    walk.alpha = single_scattering_albedo((*met).material, (*met).surface.surface_albedo);
    walk.skipped = skipped;
    walk.entered = all;
    walk.side = side;
    walk.offset = (*met).offset;
    walk.pdf = NEVER;
    walk.material = (*met).material;
    if (surface == CLEAR && eta == 1.0 && !is_passed_alike(met, ((*path).flags & SOFT) != 0u)) {
        // Light that goes straight through is then found by paths alone
        (*path).mis_pdf = NEVER;
    }
    (*path).throughput = throughput;
    (*path).work = WALK_RAY;
    (*path).flags &= ~HAS_SCATTERED;
    var shells = shells_around(walk.material, walk.sigma_t, walk.offset);
    set_out(path, &walk, flight_from(&shells, 0.0), select(u.z, u.x, is_clear));
    slots[slot].walk = walk;
}

// Begins a flight in a new direction.
fn set_out(path: ptr<function, Path>, walk: ptr<function, Walk>, flight: Flight, u: f32) {
    (*walk).events += 1u;
    (*path).origin = (*walk).start;
    fly_on(path, walk, flight, u);
}

// Draws the length of the next flight from one channel, chosen in proportion to the throughput.
fn fly_on(path: ptr<function, Path>, walk: ptr<function, Walk>, flight: Flight, u: f32) {
    let length = flight_length((*path).throughput, flight.sigma_t, u);
    (*path).flags = select((*path).flags & ~AT_LIMIT, (*path).flags | AT_LIMIT, length > flight.limit);
    (*walk).length = max(min(length, flight.limit) - (*walk).skipped, 0.0);
    (*walk).done = 0.0;
}

fn flight_length(throughput: vec3f, sigma_t: vec3f, u: f32) -> f32 {
    let place = u * sum(throughput);
    var start = 0.0;
    var part = throughput.x;
    var sigma = sigma_t.x;
    if (place >= throughput.x + throughput.y) {
        start = throughput.x + throughput.y;
        part = throughput.z;
        sigma = sigma_t.z;
    } else if (place >= throughput.x) {
        start = throughput.x;
        part = throughput.y;
        sigma = sigma_t.y;
    }
    if (!(part > 0.0 && sigma > 0.0)) {
        return NEVER;
    }
    return min(-log(1.0 - clamp((place - start) / part, 0.0, 0.99999994)) / sigma, NEVER);
}

// e^{-σt}, up to a factor that all channels share: that of the channel that comes farthest is 1.
fn attenuation(throughput: vec3f, sigma_t: vec3f, length: f32) -> vec3f {
    let depth = sigma_t * min(length, 1e20);
    let lit = select(vec3f(NEVER), depth, throughput > vec3f(0.0));
    let least = min(lit.x, min(lit.y, lit.z));
    return exp(-clamp(depth - least, vec3f(0.0), vec3f(80.0)));
}

// The throughput times densities, with the sum it had.
fn reweighed(throughput: vec3f, density: vec3f) -> vec3f {
    let weighted = throughput * density;
    let all = sum(weighted);
    if (!(all > 1e-30)) {
        return vec3f(0.0);
    }
    return weighted * (sum(throughput) / all);
}

// Where a flight has ended: at a surface, or at a collision, for which walks through shells need to know how deep it is.
fn flight_step(path: ptr<function, Path>, walk: ptr<function, Walk>, light: ptr<function, Light>) {
    (*path).work = WALK_RAY;
    var way = (*walk).length;
    if ((*path).hit_triangle != NO_TRIANGLE) {
        let distance = (*walk).done + (*path).hit_t;
        let leaves = dot((*walk).direction, geometric_normal(triangle_at((*path).hit_triangle))) * (*walk).side > 0.0;
        let ends = leaves && (*walk).nesting <= 1u;
        if (ends && distance <= (*walk).length) {
            (*walk).length = distance;
            (*path).work = WALK_END;
            return;
        }
        if (ends) {
            // Nearer to the body's end than rounding allows: a little before it
            way = max(distance - (*walk).offset, 0.0);
        } else if (distance <= (*walk).length) {
            (*walk).nesting = select((*walk).nesting + 1u, (*walk).nesting - 1u, leaves);
            (*walk).done = distance + (*walk).offset;
            (*path).passes += 1u;
            if ((*path).passes >= MOST_PASSES) {
                (*path).work = ENDED;
            }
            return;
        }
    }
    let step = (*walk).direction * way;
    // To where another medium may be: a step that rounding swallows would be taken for ever
    let is_swallowed = all(abs(step) <= SWALLOWED * abs((*walk).start));
    let is_stuck = ((*path).flags & AT_LIMIT) != 0u && way > 0.0 && is_swallowed;
    (*walk).start += step;
    if (is_lost((*walk).start) || is_stuck) {
        (*path).work = ENDED;
    } else if (tables[shell_words((*walk).material)] > 0.0) {
        (*path).work = WALK_DEPTH;
        // From a depth that is known: on the surface, which it left by the offset
        (*walk).done = way + (*walk).skipped + (*walk).offset;
    } else {
        collide(path, walk, light);
    }
}

// Returns true if a point is too far off to come back to the body, or not finite.
fn is_lost(point: vec3f) -> bool {
    let off = point - table_vector(MIDDLE);
    return !(dot(off, off) <= tables[FARTHEST]);
}

fn is_last(path: ptr<function, Path>) -> bool {
    return (*path).depth >= head(MAX_DEPTH) || (*path).diffuse_depth >= head(MAX_DIFFUSE_DEPTH);
}

// A collision at the flight's end.
fn collide(path: ptr<function, Path>, walk: ptr<function, Walk>, light: ptr<function, Light>) {
    let length = (*walk).length + (*walk).skipped;
    (*walk).skipped = 0.0;
    let density = attenuation((*path).throughput, (*walk).sigma_t, length) * (*walk).sigma_t;
    (*path).throughput = reweighed((*path).throughput, density) * (*walk).alpha;
    (*path).passes = 0u;
    be_collided(path, walk, light);
}

// The medium is to scatter the walk where it is.
fn be_collided(path: ptr<function, Path>, walk: ptr<function, Walk>, light: ptr<function, Light>) {
    (*path).flags |= HAS_SCATTERED;
    let m = material_at((*walk).material);
    let is_clear = u32(tables[m + WALK_SURFACE]) == CLEAR;
    let is_given_up = (*walk).events >= u32(tables[m + MOST_FLIGHTS]);
    if (is_given_up || (is_clear && is_last(path)) || is_zero((*path).throughput)) {
        (*path).work = ENDED;
        return;
    }
    (*path).work = COLLIDED;
    (*light).kind = NO_LIGHT;
    if (is_clear && tables[m + WALK_ETA] == 1.0) {
        request_light(light, (*walk).start, vec3f(0.0));
    }
}

// Scatters the walk at its collision.
fn scatter_walk(
    path: ptr<function, Path>,
    walk: ptr<function, Walk>,
    light: ptr<function, Light>,
    shadow: ptr<function, Shadow>,
    group: u32,
) {
    let m = material_at((*walk).material);
    var shells = shells_around((*walk).material, (*walk).sigma_t, (*walk).offset);
    let g = shell_g(&shells, shell_at(&shells, (*walk).depth).number, (*walk).material);
    let before = (*walk).direction;
    // Between clear surfaces an event has a set for its light sample, too
    let is_clear = u32(tables[m + WALK_SURFACE]) == CLEAR;
    let u = walk_numbers(path, is_clear, (*walk).events * select(1u, 2u, is_clear), (*walk).draws);
    let phase = henyey_greenstein_new(g);
    let after = henyey_greenstein_sample(phase, before, u.xy);
    (*walk).pdf = henyey_greenstein_pdf(phase, dot(before, after));
    if ((*light).kind != NO_LIGHT) {
        send_from_collision(path, walk, light, shadow, shells.least, henyey_greenstein_pdf(phase, dot(before, (*light).direction)));
        (*shadow).group = group;
    }
    let survival = min(sum((*path).throughput) / (ROULETTE_BELOW * (*walk).entered), 1.0);
    (*path).work = select(ENDED, WALK_RAY, u.w < survival);
    (*path).throughput /= survival;
    (*walk).direction = after;
    set_out(path, walk, flight_from(&shells, (*walk).depth), u.z);
}

// Sends a light sample, scattered at a collision, on its way out of the body: as flights come there that are twice as long as
// the walk's own, or as those in the least dense of its media.
fn send_from_collision(
    path: ptr<function, Path>,
    walk: ptr<function, Walk>,
    light: ptr<function, Light>,
    shadow: ptr<function, Shadow>,
    least: vec3f,
    scattered: f32,
) {
    set_light(path, shadow, weighed(light, weight_of(light, scattered)) * (*path).throughput * scattered);
    if (is_zero((*shadow).matte) && is_zero((*shadow).specular)) {
        return;
    }
    (*shadow).stage = BODY_SHADOW;
    (*shadow).origin = (*walk).start;
    (*shadow).direction = (*light).direction;
    (*shadow).absorption = (*path).absorption;
    (*shadow).is_soft = u32(head(CAUSTICS) == 0u);
    (*shadow).passes = 0u;
    (*shadow).sigma_t = (*walk).sigma_t;
    (*shadow).share = (*path).throughput / sum((*path).throughput);
    (*shadow).nesting = (*walk).nesting;
    (*shadow).material = (*walk).material;
    (*shadow).depth = (*walk).depth;
    (*shadow).side = (*walk).side;
    (*shadow).offset = (*walk).offset;
    (*shadow).done = 0.0;
    (*shadow).length = flight_length((*path).throughput, 0.5 * least, (*light).random);
    (*shadow).light_distance = (*light).distance;
}

// Divides light from below between the layers of the picture.
fn set_light(path: ptr<function, Path>, shadow: ptr<function, Shadow>, light: vec3f) {
    (*shadow).layer = select(TO_SUBSURFACE, TO_SURFACE, (*path).layer == OF_SURFACE);
    (*shadow).matte = light;
    (*shadow).specular = vec3f(0.0);
    if ((*path).layer == OF_SURFACE) {
        (*shadow).specular = light * (1.0 - (*path).diffuse_share);
        (*shadow).matte = light * (*path).diffuse_share;
    }
}

// The walk is at the body's end.
fn reach_end(path: ptr<function, Path>, walk: ptr<function, Walk>, met: ptr<function, Met>, light: ptr<function, Light>) {
    let m = material_at((*walk).material);
    let way = (*walk).length + (*walk).skipped;
    (*walk).skipped = 0.0;
    var shells = shells_around((*walk).material, (*walk).sigma_t, (*walk).offset);
    let flown = flight_from(&shells, (*walk).depth).sigma_t;
    (*path).throughput = reweighed((*path).throughput, attenuation((*path).throughput, flown, way));
    (*walk).depth = 0.0;
    let eta = tables[m + WALK_ETA];
    if (u32(tables[m + WALK_SURFACE]) != CLEAR) {
        (*path).work = AT_MATTE_END;
        request_light(light, (*met).position, (*met).normal * (*walk).side);
        return;
    }
    (*path).work = ENDED;
    let outward = (*met).geometric * (*walk).side;
    var direction = (*walk).direction;
    if (eta != 1.0) {
        let u = walk_numbers(path, true, 2u * (*walk).events - 1u, (*walk).draws);
        let cosine = dot(direction, outward);
        if (u.x < fresnel_dielectric(cosine, 1.0 / eta)) {
            if ((*walk).events >= u32(tables[m + MOST_FLIGHTS])) {
                return;
            }
            (*walk).direction = normalize(direction - outward * (2.0 * cosine));
            (*walk).start = (*met).position - outward * (*walk).offset;
            (*walk).nesting = 1u;
            (*walk).pdf = NEVER;
            (*path).work = WALK_RAY;
            set_out(path, walk, flight_from(&shells, 0.0), u.y);
            return;
        }
        let bent = refracted(-direction, -outward, 1.0 / eta);
        if (!bent.exists) {
            return;
        }
        direction = bent.direction;
    }
    (*path).direction = direction;
    let has_scattered = ((*path).flags & HAS_SCATTERED) != 0u;
    var weight = surface_parameters_coat_tint_one_way((*met).surface);
    if (eta == 1.0) {
        weight = entering(met, direction, (*walk).side);
        if (!has_scattered) {
            // Nothing has happened to the light
            pass_surface(path, met, weight);
            return;
        }
    }
    (*path).diffuse_depth += u32(has_scattered);
    if (has_scattered && head(CAUSTICS) == 0u) {
        (*path).flags |= SOFT;
    }
    (*path).mis_point = (*path).origin;
    (*path).mis_normal = vec3f(0.0);
    // No light sample comes refracted to a collision
    (*path).mis_pdf = select(NEVER, min((*walk).pdf, NEVER), eta == 1.0);
    scatter(path, OF_SUBSURFACE, vec3f(0.0), ray_origin(met, direction), direction, weight);
}

// Light enters a matte surface from any direction: the light sample, and the path's way on in a cosine direction.
fn scatter_at_matte_end(
    path: ptr<function, Path>,
    walk: ptr<function, Walk>,
    probe: ptr<function, Probe>,
    met: ptr<function, Met>,
    light: ptr<function, Light>,
    shadow: ptr<function, Shadow>,
) {
    (*path).work = ENDED;
    let m = material_at((*walk).material);
    let is_probed = u32(tables[m + BELOW_KIND]) == PROFILE_BELOW;
    let normal = (*met).normal * (*walk).side;
    let geometric = (*met).geometric * (*walk).side;
    let is_soft = head(CAUSTICS) == 0u;
    let v = stratified((*path).sampler, (*path).vertex, end_set((*path).flags, m) + 1u);
    let wi = sample_cosine(v.xy);
    let drawn = normalize(frame_of(normal) * wi);
    for (var k = 0u; k < 2u; k += 1u) {
        let direction = select(drawn, (*light).direction, k == 0u);
        let cosine = select(wi.z, dot(direction, normal), k == 0u);
        if (!(cosine > 0.0 && dot(direction, geometric) > 0.0) || (k == 0u && (*light).kind == NO_LIGHT)) {
            continue;
        }
        var weight = entry_weight(met, min(cosine, 1.0));
        if (is_probed) {
            weight *= directional_weight(probe, met, normal, (*walk).direction, kernel_of((*walk).material), direction);
        }
        let density = cosine * INVERSE_PI;
        if (k == 0u) {
            set_light(path, shadow, weighed(light, weight_of(light, density)) * weight * density * (*path).throughput);
            if (!(is_zero((*shadow).matte) && is_zero((*shadow).specular))) {
                (*shadow).absorption = (*path).absorption;
                (*shadow).is_soft = u32(is_soft);
                (*shadow).passes = 0u;
                send(shadow, met, direction, (*light).distance);
            }
            continue;
        }
        (*path).mis_point = (*met).position;
        (*path).mis_normal = normal;
        (*path).mis_pdf = density;
        (*path).diffuse_depth += 1u;
        if (is_soft) {
            (*path).flags |= SOFT;
        }
        scatter(path, OF_SUBSURFACE, vec3f(0.0), ray_origin(met, direction), direction, weight);
    }
}
