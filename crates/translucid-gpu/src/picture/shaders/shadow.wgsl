// Light samples on their way to the light: surface by surface, so that they lose what paths lose.

// Part of the way to a light short of which its rays end.
const SHORT_OF_LIGHT = 1e-4;
// Transmittance below which nothing is left of light.
const LEAST_LIGHT = 1e-6;

// Sets a light sample out from a point, in the direction of a light at a distance.
fn send(shadow: ptr<function, Shadow>, point: Point, direction: vec3f, distance: f32) {
    let origin = ray_origin(point, direction);
    (*shadow).stage = FREE_SHADOW;
    (*shadow).origin = origin;
    (*shadow).direction = direction;
    (*shadow).t_max = NEVER;
    if (distance < NEVER) {
        // Aimed anew: parallel to the old direction, the ray would meet the light beside the target
        let way = point.position + direction * distance - origin;
        let whole = length(way);
        (*shadow).direction = way / max(whole, 1e-30);
        (*shadow).t_max = whole - max(SHORT_OF_LIGHT * whole, point.offset);
    }
}

// Radiance of a light sample as it sets out, weighted.
fn sent(light: LightSample, point: vec3f, weight: f32) -> vec3f {
    var radiance = light.radiance;
    if (light.triangle != NO_TRIANGLE) {
        let place = u32(tables[head(LIGHT_TRIANGLES) + light.triangle]);
        let there = point_on(place, point + light.direction * light.distance);
        radiance = emission_at(there) * opacity_at(there);
    }
    return min(radiance * min(weight, GREATEST_LIGHT), vec3f(GREATEST_LIGHT));
}

fn deposit(slot: u32, shadow: ptr<function, Shadow>) {
    if ((*shadow).is_subsurface != 0u) {
        slots[slot].found.subsurface += (*shadow).matte;
    } else {
        slots[slot].found.matte += (*shadow).matte;
        slots[slot].found.specular += (*shadow).specular;
    }
    (*shadow).stage = NO_SHADOW;
}

fn weaken(shadow: ptr<function, Shadow>, factor: vec3f) {
    (*shadow).matte *= factor;
    (*shadow).specular *= factor;
    if (is_zero((*shadow).matte) && is_zero((*shadow).specular)) {
        (*shadow).stage = NO_SHADOW;
    }
}

// Returns true if paths and shadow rays pass the body below a surface alike.
fn is_passed_alike(point: Point, is_soft: bool) -> bool {
    let m = material_at(point.material);
    return opacity_at(point) >= 1.0 && unit_at(m + BASE_METALNESS, point) == 0.0
        && (!is_soft || unit_at(m + TRANSMISSION_WEIGHT, point) == 0.0);
}

// What a light sample has met, or nothing.
fn shadow_step(slot: u32, shadow: ptr<function, Shadow>) {
    if ((*shadow).stage == FREE_SHADOW) {
        free_step(slot, shadow);
    } else {
        body_step(shadow);
    }
}

fn free_step(slot: u32, shadow: ptr<function, Shadow>) {
    let is_hit = (*shadow).hit_triangle != NO_TRIANGLE;
    let way = select((*shadow).t_max, (*shadow).hit_t, is_hit);
    if (light_intersect((*shadow).origin, (*shadow).direction, way, false).is_hit) {
        (*shadow).stage = NO_SHADOW;
        return;
    }
    if (!is_hit) {
        weaken(shadow, absorbed((*shadow).absorption, (*shadow).t_max));
        deposit(slot, shadow);
        return;
    }
    let triangle = (*shadow).hit_triangle;
    let m = material_at(material_of(triangle));
    let is_matched = tables[m + IS_MATCHED] > 0.0;
    let is_soft = (*shadow).is_soft != 0u;
    (*shadow).passes += 1u;
    if (!(is_matched || tables[m + LETS_LIGHT_THROUGH] > 0.0) || (*shadow).passes >= MOST_PASSES) {
        (*shadow).stage = NO_SHADOW;
        return;
    }
    let point = point_at(triangle, (*shadow).hit);
    let rest = (*shadow).t_max - (*shadow).hit_t;
    let direction = (*shadow).direction;
    if (is_matched && is_passed_alike(point, is_soft)) {
        weaken(shadow, absorbed((*shadow).absorption, (*shadow).hit_t));
        enter_body(shadow, point, rest);
        return;
    }
    let opacity = opacity_at(point);
    let p = surface_at(point);
    var clear = 0.0;
    if (is_soft) {
        clear = p.transmission_weight * (1.0 - p.metalness);
    }
    weaken(shadow, absorbed((*shadow).absorption, (*shadow).hit_t));
    if (clear > 0.0) {
        (*shadow).absorption = absorption_behind(point, direction, (*shadow).absorption);
    }
    let cosine = abs(dot(direction, point.shading));
    let passed = straight_transmittance(p, cosine) * (opacity * clear);
    weaken(shadow, vec3f(1.0 - opacity) + passed);
    (*shadow).origin = ray_origin(point, direction);
    (*shadow).t_max = select(rest, NEVER, (*shadow).t_max >= NEVER);
}

// Begins the way through a body of a light that nothing scatters there.
fn enter_body(shadow: ptr<function, Shadow>, point: Point, rest: f32) {
    let direction = (*shadow).direction;
    let below = below_at(point);
    let side = select(1.0, -1.0, dot(direction, point.geometric) > 0.0);
    let normal = point.geometric * side;
    let cosine = -dot(direction, normal);
    if (!(greatest(below.length) > 0.0) || !(cosine > 0.0)) {
        (*shadow).stage = NO_SHADOW;
        return;
    }
    let scatters = below.length > vec3f(0.0);
    var p = surface_at(point);
    p.surface_albedo = below.surface_albedo;
    p.subsurface_active = select(vec3f(0.0), vec3f(1.0), scatters);
    if ((*shadow).is_soft != 0u) {
        p = surface_seen_softly(p);
    }
    let frame = frame_of(shading_normal_at(point));
    weaken(shadow, share_below(p, to_local(frame, -direction)));
    if ((*shadow).stage == NO_SHADOW) {
        return;
    }
    let skipped = point.offset / max(cosine, 0.1);
    (*shadow).origin = point.position + direction * skipped - normal * (point.offset - skipped * cosine);
    (*shadow).stage = BODY_SHADOW;
    (*shadow).sigma_t = select(vec3f(NEVER), 1.0 / below.length, scatters);
    (*shadow).share = vec3f(0.0);
    (*shadow).nesting = 1u;
    (*shadow).group = point.group;
    (*shadow).side = side;
    (*shadow).offset = point.offset;
    (*shadow).done = 0.0;
    // Beyond, the last channel is dark
    (*shadow).length = min(rest, 14.0 * greatest(below.length));
    (*shadow).light_distance = rest;
}

// A flight's surface, or nothing, as `walk_step` has it.
fn body_step(shadow: ptr<function, Shadow>) {
    if ((*shadow).hit_triangle == NO_TRIANGLE) {
        (*shadow).stage = NO_SHADOW;
        return;
    }
    let triangle = (*shadow).hit_triangle;
    let distance = (*shadow).done + (*shadow).hit_t;
    let normal = geometric_normal(triangle) * (*shadow).side;
    let leaves = dot((*shadow).direction, normal) > 0.0;
    (*shadow).passes += 1u;
    if (leaves && (*shadow).nesting <= 1u) {
        // The body does not see lights inside
        if (distance > (*shadow).length || distance >= (*shadow).light_distance) {
            (*shadow).stage = NO_SHADOW;
            return;
        }
        leave_with_light(shadow, triangle, distance);
        return;
    }
    if (distance > (*shadow).length || (*shadow).passes >= MOST_PASSES) {
        (*shadow).stage = NO_SHADOW;
        return;
    }
    (*shadow).nesting = select((*shadow).nesting + 1u, (*shadow).nesting - 1u, leaves);
    (*shadow).done = distance + (*shadow).offset;
}

fn leave_with_light(shadow: ptr<function, Shadow>, triangle: u32, distance: f32) {
    let sigma = (*shadow).sigma_t;
    var attenuation = exp(-min(sigma * distance, vec3f(80.0)));
    attenuation = select(attenuation, vec3f(0.0), sigma * distance > vec3f(80.0));
    let drawn = (*shadow).share;
    if (sum(drawn) > 0.0) {
        // Of flights twice as long, of which this one came so far
        let chance = dot(drawn, exp(-min(0.5 * sigma * distance, vec3f(80.0))));
        attenuation /= max(chance, 1e-30);
    }
    let point = point_at(triangle, (*shadow).hit);
    let direction = (*shadow).direction;
    weaken(shadow, attenuation * entering(point, direction, (*shadow).side));
    if ((*shadow).stage != NO_SHADOW) {
        let rest = select((*shadow).light_distance - distance, NEVER, (*shadow).light_distance >= NEVER);
        send(shadow, point, direction, rest);
    }
}

// Share of light that comes from below, seen from a direction.
fn share_below(p: Surface, wo: vec3f) -> vec3f {
    let bsdf = bsdf_new(p, wo);
    return select(vec3f(0.0), bsdf.below, bsdf.choose_below > 0.0 && !bsdf.is_thin);
}

// Factor of a surface on a radiance that enters from a direction.
fn entering(point: Point, direction: vec3f, side: f32) -> vec3f {
    let normal = shading_normal_at(point) * side;
    return entry_weight(surface_at(point), clamp(dot(direction, normal), 0.0, 1.0));
}
