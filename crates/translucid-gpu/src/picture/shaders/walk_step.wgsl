// The walk through a body, a flight at a time: `subsurface/transport/walk` of the renderer, without light that walks share.

const CLEAR = 0u;
const DIFFUSE_SURFACE = 1u;
const ROUGH = 2u;
const SKIN = 3u;

// Share of the light that entered below which walks end at random.
const ROULETTE_BELOW = 0.25;
// Sets of numbers of a vertex that are the surface's; then those of a walk's first events, and two of a matte end.
const SURFACE_SETS = 3u;
const WALK_SETS = 3u;
// |g| below which directions are drawn evenly: the quotient of the closed form would be rounding noise.
const ISOTROPIC = 1e-3;

// Numbers of a walk: stratified for its first events, then independent.
fn walk_numbers(path: ptr<function, Path>, number: u32) -> vec4f {
    if (number < WALK_SETS) {
        return stratified((*path).sampler, (*path).vertex, SURFACE_SETS + number);
    }
    return independent((*path).sampler, (*path).vertex, number);
}

// Goes below the surface that the camera, or a path, sees.
fn begin_walk(slot: u32, path: ptr<function, Path>, point: Point, normal: vec3f, below: Below) {
    (*path).work = ENDED;
    let m = material_at(point.material);
    let side = select(1.0, -1.0, dot((*path).direction, point.geometric) > 0.0);
    let outward = point.geometric * side;
    let u = walk_numbers(path, 0u);
    let toward = (*path).direction;
    let eta = tables[m + WALK_ETA];
    let surface = u32(tables[m + WALK_SURFACE]);
    var direction = toward;
    if (surface == CLEAR) {
        if (eta != 1.0) {
            let refracted = refract_through(-toward, outward, eta);
            if (!refracted.is_refracted) {
                return;
            }
            direction = refracted.direction;
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
            roughness = unit_at(m + SPECULAR_ROUGHNESS, point);
        }
        if (is_diffuse) {
            direction = -(frame * sample_cosine(choice));
        } else if (eta != 1.0) {
            let wo = to_local(frame, -toward);
            let refracted = refract_through(wo, sample_visible(roughness, wo, choice), eta);
            if (!refracted.is_refracted) {
                return;
            }
            direction = frame * refracted.direction;
        }
        // Where the shading normal leads outside, the mirror image leads as far in
        direction = normalize(direction - outward * (2.0 * max(dot(direction, outward), 0.0)));
    }
    let cosine = -dot(direction, outward);
    // Channels of length 0 are a matter of the surface
    let scatters = below.length > vec3f(0.0);
    let throughput = select(vec3f(0.0), (*path).throughput, scatters);
    let all = sum(throughput);
    if (!(cosine > 0.0) || !(all > 0.0 && all < NEVER)) {
        return;
    }
    // On the ray where it is deep enough, unless it hardly gets deeper
    let skipped = point.offset / max(cosine, 0.1);
    var walk: Walk;
    walk.from = point.position + direction * skipped - outward * (point.offset - skipped * cosine);
    walk.nesting = 1u;
    walk.direction = direction;
    walk.sigma_t = select(vec3f(0.0), 1.0 / max(below.length, vec3f(1e-30)), scatters);
    walk.alpha = single_scattering_albedo(point.material, below.surface_albedo);
    walk.skipped = skipped;
    walk.entered = all;
    walk.side = side;
    walk.offset = point.offset;
    walk.pdf = NEVER;
    walk.group = point.group;
    walk.material = point.material;
    if (surface == CLEAR && eta == 1.0 && !is_passed_alike(point, ((*path).flags & SOFT) != 0u)) {
        // Light that goes straight through is then found by paths alone
        (*path).mis_pdf = NEVER;
    }
    (*path).throughput = throughput;
    (*path).work = WALK_RAY;
    set_out(path, &walk, u.z);
    slots[slot].walk = walk;
}

// Draws the length of the next flight from one channel, chosen in proportion to the throughput.
fn set_out(path: ptr<function, Path>, walk: ptr<function, Walk>, u: f32) {
    let length = flight_length((*path).throughput, (*walk).sigma_t, u);
    (*walk).length = max(length - (*walk).skipped, 0.0);
    (*walk).done = 0.0;
    (*walk).events += 1u;
}

fn flight_length(throughput: vec3f, sigma_t: vec3f, u: f32) -> f32 {
    let place = u * sum(throughput);
    var start = 0.0;
    var of = throughput.x;
    var sigma = sigma_t.x;
    if (place >= throughput.x + throughput.y) {
        start = throughput.x + throughput.y;
        of = throughput.z;
        sigma = sigma_t.z;
    } else if (place >= throughput.x) {
        start = throughput.x;
        of = throughput.y;
        sigma = sigma_t.y;
    }
    if (!(of > 0.0 && sigma > 0.0)) {
        return NEVER;
    }
    return min(-log(1.0 - clamp((place - start) / of, 0.0, 0.99999994)) / sigma, NEVER);
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

fn phase(g: f32, cosine: f32) -> f32 {
    if (abs(g) < ISOTROPIC) {
        return 0.25 * INVERSE_PI;
    }
    let squared = max(1.0 + g * g - 2.0 * g * cosine, 1e-30);
    return 0.25 * INVERSE_PI * (1.0 - g * g) / (squared * sqrt(squared));
}

fn turned(g: f32, direction: vec3f, u: vec2f) -> vec3f {
    let around = circle_at(u.y);
    if (abs(g) < ISOTROPIC) {
        let cosine = 1.0 - 2.0 * u.x;
        return vec3f(sqrt(max(1.0 - cosine * cosine, 0.0)) * around, cosine);
    }
    let root = (1.0 - g * g) / (1.0 + g - 2.0 * g * u.x);
    let cosine = clamp((1.0 + g * g - root * root) / (2.0 * g), -1.0, 1.0);
    let sine = sqrt(max(1.0 - cosine * cosine, 0.0));
    return normalize(frame_of(direction) * vec3f(sine * around, cosine));
}

// A flight's surface, or nothing.
fn walk_step(slot: u32) {
    var path = slots[slot].path;
    var walk = slots[slot].walk;
    var shadow = slots[slot].shadow;
    path.work = WALK_RAY;
    let is_hit = path.hit_triangle != NO_TRIANGLE;
    if (!is_hit) {
        collide(slot, &path, &walk, &shadow, walk.length);
    } else {
        let distance = walk.done + path.hit_t;
        let leaves = dot(walk.direction, geometric_normal(path.hit_triangle)) * walk.side > 0.0;
        if (leaves && walk.nesting <= 1u) {
            if (distance <= walk.length) {
                reach_end(slot, &path, &walk, &shadow, distance);
            } else {
                // Nearer to the body's end than rounding allows: a little before it
                collide(slot, &path, &walk, &shadow, max(distance - walk.offset, 0.0));
            }
        } else if (distance > walk.length) {
            collide(slot, &path, &walk, &shadow, walk.length);
        } else {
            walk.nesting = select(walk.nesting + 1u, walk.nesting - 1u, leaves);
            walk.done = distance + walk.offset;
            path.passes += 1u;
            if (path.passes >= MOST_PASSES) {
                path.work = ENDED;
            }
        }
    }
    slots[slot].path = path;
    slots[slot].walk = walk;
    slots[slot].shadow = shadow;
}

fn is_last(path: ptr<function, Path>) -> bool {
    return (*path).depth >= head(MAX_DEPTH) || (*path).diffuse_depth >= head(MAX_DIFFUSE_DEPTH);
}

// Scatters the walk at a place along its flight.
fn collide(slot: u32, path: ptr<function, Path>, walk: ptr<function, Walk>, shadow: ptr<function, Shadow>, way: f32) {
    let length = (*walk).length + (*walk).skipped;
    (*walk).skipped = 0.0;
    let density = attenuation((*path).throughput, (*walk).sigma_t, length) * (*walk).sigma_t;
    (*path).throughput = reweighed((*path).throughput, density) * (*walk).alpha;
    (*walk).has_scattered = 1u;
    (*path).passes = 0u;
    (*walk).from += (*walk).direction * way;
    let m = material_at((*walk).material);
    let is_clear = u32(tables[m + WALK_SURFACE]) == CLEAR;
    let off = (*walk).from - table_color(MIDDLE);
    let is_lost = !(dot(off, off) <= tables[FARTHEST]);
    if (is_lost || (*walk).events >= u32(tables[m + MOST_FLIGHTS]) || is_clear && is_last(path) || is_zero((*path).throughput)) {
        (*path).work = ENDED;
        return;
    }
    let g = tables[m + WALK_G];
    if (is_clear && tables[m + WALK_ETA] == 1.0) {
        send_from_collision(path, walk, shadow, g);
    }
    let u = walk_numbers(path, 2u * (*walk).events);
    let survival = min(sum((*path).throughput) / (ROULETTE_BELOW * (*walk).entered), 1.0);
    if (u.w >= survival) {
        (*path).work = ENDED;
        return;
    }
    (*path).throughput /= survival;
    let before = (*walk).direction;
    (*walk).direction = turned(g, before, u.xy);
    (*walk).pdf = phase(g, dot(before, (*walk).direction));
    set_out(path, walk, u.z);
}

// Sends light from one sampled light, scattered at a collision, on its way out of the body: as flights come there that are
// twice as long as the walk's own.
fn send_from_collision(path: ptr<function, Path>, walk: ptr<function, Walk>, shadow: ptr<function, Shadow>, g: f32) {
    let u = walk_numbers(path, 2u * (*walk).events - 1u);
    let light = light_sample((*walk).from, vec3f(0.0), u.x, u.yz);
    if (!light.is_usable) {
        return;
    }
    let scattered = phase(g, dot((*walk).direction, light.direction));
    let mis = select(power_heuristic(light.pdf, scattered), 1.0, light.is_delta);
    (*shadow).matte = sent(light, (*walk).from, mis / light.pdf) * (*path).throughput * scattered;
    (*shadow).specular = vec3f(0.0);
    set_layer(path, shadow);
    if (is_zero((*shadow).matte) && is_zero((*shadow).specular)) {
        return;
    }
    (*shadow).stage = BODY_SHADOW;
    (*shadow).origin = (*walk).from;
    (*shadow).direction = light.direction;
    (*shadow).absorption = (*path).absorption;
    (*shadow).is_soft = u32(head(CAUSTICS) == 0u);
    (*shadow).passes = 0u;
    (*shadow).sigma_t = (*walk).sigma_t;
    (*shadow).share = (*path).throughput / sum((*path).throughput);
    (*shadow).nesting = (*walk).nesting;
    (*shadow).group = (*walk).group;
    (*shadow).side = (*walk).side;
    (*shadow).offset = (*walk).offset;
    (*shadow).done = 0.0;
    (*shadow).length = flight_length((*path).throughput, 0.5 * (*walk).sigma_t, u.w);
    (*shadow).light_distance = light.distance;
}

// Divides light between the layers of the picture.
fn set_layer(path: ptr<function, Path>, shadow: ptr<function, Shadow>) {
    (*shadow).is_subsurface = u32((*path).layer != OF_SURFACE);
    if ((*path).layer == OF_SURFACE) {
        (*shadow).specular = (*shadow).matte * (1.0 - (*path).diffuse_share);
        (*shadow).matte *= (*path).diffuse_share;
    }
}

// The walk is at the body's end.
fn reach_end(slot: u32, path: ptr<function, Path>, walk: ptr<function, Walk>, shadow: ptr<function, Shadow>, distance: f32) {
    let m = material_at((*walk).material);
    let way = distance + (*walk).skipped;
    (*walk).skipped = 0.0;
    (*path).throughput = reweighed((*path).throughput, attenuation((*path).throughput, (*walk).sigma_t, way));
    let point = point_at((*path).hit_triangle, (*path).hit);
    let eta = tables[m + WALK_ETA];
    if (u32(tables[m + WALK_SURFACE]) != CLEAR) {
        enter_matte(path, walk, shadow, point);
        return;
    }
    let outward = point.geometric * (*walk).side;
    var direction = (*walk).direction;
    if (eta != 1.0) {
        let u = walk_numbers(path, 2u * (*walk).events - 1u);
        let cosine = dot(direction, outward);
        if (u.x < fresnel_dielectric(cosine, 1.0 / eta)) {
            if ((*walk).events >= u32(tables[m + MOST_FLIGHTS])) {
                (*path).work = ENDED;
                return;
            }
            (*walk).direction = normalize(direction - outward * (2.0 * cosine));
            (*walk).from = point.position - outward * (*walk).offset;
            (*walk).nesting = 1u;
            (*walk).pdf = NEVER;
            set_out(path, walk, u.y);
            return;
        }
        let refracted = refract_through(-direction, -outward, 1.0 / eta);
        if (!refracted.is_refracted) {
            (*path).work = ENDED;
            return;
        }
        direction = refracted.direction;
    }
    (*path).direction = direction;
    (*path).work = FREE_RAY;
    var weight: vec3f;
    if (eta == 1.0) {
        weight = entering(point, direction, (*walk).side);
    } else {
        weight = coat_tint_one_way(surface_at(point));
    }
    if (eta == 1.0 && (*walk).has_scattered == 0u) {
        // Nothing has happened to the light
        pass_surface(path, point, weight);
        return;
    }
    (*path).diffuse_depth += (*walk).has_scattered;
    if ((*walk).has_scattered != 0u && head(CAUSTICS) == 0u) {
        (*path).flags |= SOFT;
    }
    (*path).mis_point = (*walk).from;
    (*path).mis_normal = vec3f(0.0);
    // No light sample comes refracted to a collision
    (*path).mis_pdf = select(NEVER, min((*walk).pdf, NEVER), eta == 1.0);
    scatter(path, OF_SUBSURFACE, vec3f(0.0), ray_origin(point, direction), direction, weight);
}

// Light enters a matte surface from any direction: one sampled light, and the path's way on in a cosine direction.
fn enter_matte(path: ptr<function, Path>, walk: ptr<function, Walk>, shadow: ptr<function, Shadow>, point: Point) {
    let normal = shading_normal_at(point) * (*walk).side;
    let geometric = point.geometric * (*walk).side;
    let p = surface_at(point);
    let is_soft = head(CAUSTICS) == 0u;
    let u = stratified((*path).sampler, (*path).vertex, SURFACE_SETS + WALK_SETS);
    let light = light_sample(point.position, normal, u.x, u.yz);
    let cosine = dot(light.direction, normal);
    if (light.is_usable && cosine > 0.0 && dot(light.direction, geometric) > 0.0) {
        let density = cosine * INVERSE_PI;
        let mis = select(power_heuristic(light.pdf, density), 1.0, light.is_delta);
        let entered = entry_weight(p, cosine) * density;
        (*shadow).matte = sent(light, point.position, mis / light.pdf) * entered * (*path).throughput;
        (*shadow).specular = vec3f(0.0);
        set_layer(path, shadow);
        if (!(is_zero((*shadow).matte) && is_zero((*shadow).specular))) {
            (*shadow).absorption = (*path).absorption;
            (*shadow).is_soft = u32(is_soft);
            (*shadow).passes = 0u;
            send(shadow, point, light.direction, light.distance);
            (*shadow).t_max = max((*shadow).t_max, 0.0);
        }
    }
    (*path).work = ENDED;
    let v = stratified((*path).sampler, (*path).vertex, SURFACE_SETS + WALK_SETS + 1u);
    let wi = sample_cosine(v.xy);
    let direction = normalize(frame_of(normal) * wi);
    if (dot(direction, geometric) <= 0.0) {
        return;
    }
    (*path).mis_point = point.position;
    (*path).mis_normal = normal;
    (*path).mis_pdf = wi.z * INVERSE_PI;
    (*path).diffuse_depth += 1u;
    if (is_soft) {
        (*path).flags |= SOFT;
    }
    scatter(path, OF_SUBSURFACE, vec3f(0.0), ray_origin(point, direction), direction, entry_weight(p, wi.z));
}
