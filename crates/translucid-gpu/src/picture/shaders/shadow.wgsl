// Light samples on their way to the light: surface by surface, so that they lose what paths lose.

// Part of the way to a light short of which its rays end.
const SHORT_OF_LIGHT = 1e-4;
// Transmittance below which nothing is left of light.
const LEAST_LIGHT = 1e-6;

// Sets a light sample out from a point, in the direction of a light at a distance.
fn send(shadow: ptr<function, Shadow>, met: ptr<function, Met>, direction: vec3f, distance: f32) {
    let origin = ray_origin(met, direction);
    (*shadow).stage = FREE_SHADOW;
    (*shadow).origin = origin;
    (*shadow).direction = direction;
    (*shadow).t_max = NEVER;
    if (distance < NEVER) {
        // Aimed anew: parallel to the old direction, the ray would meet the light beside the target
        let way = (*met).position + direction * distance - origin;
        let whole = length(way);
        (*shadow).direction = way / max(whole, 1e-30);
        (*shadow).t_max = max(whole - max(SHORT_OF_LIGHT * whole, (*met).offset), 0.0);
    }
}

// Radiance of a light sample, weighted.
fn weighed(light: ptr<function, Light>, weight: f32) -> vec3f {
    return min((*light).radiance * min(weight, GREATEST_LIGHT), vec3f(GREATEST_LIGHT));
}

// Weight of a light sample whose direction would have been drawn with a density, over its own density.
fn weight_of(light: ptr<function, Light>, pdf: f32) -> f32 {
    return select(power_heuristic((*light).pdf, pdf), 1.0, (*light).kind == DELTA) / (*light).pdf;
}

fn deposit(slot: u32, shadow: ptr<function, Shadow>) {
    if ((*shadow).layer == TO_SUBSURFACE) {
        slots[slot].found.subsurface += (*shadow).matte;
    } else if ((*shadow).layer == TO_ALPHA) {
        slots[slot].found.alpha -= coverage(slots[slot].path.throughput) * min(luminance((*shadow).matte), 1.0);
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

// What a light sample has met, or nothing.
fn shadow_step(slot: u32, shadow: ptr<function, Shadow>, met: ptr<function, Met>) {
    if ((*shadow).stage == FREE_SHADOW) {
        free_step(slot, shadow, met);
    } else {
        body_step(slot, shadow, met);
    }
}

fn free_step(slot: u32, shadow: ptr<function, Shadow>, met: ptr<function, Met>) {
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
    let m = material_at((*met).material);
    let is_matched = tables[m + IS_MATCHED] > 0.0;
    let is_soft = (*shadow).is_soft != 0u;
    (*shadow).passes += 1u;
    if (!(is_matched || tables[m + LETS_LIGHT_THROUGH] > 0.0) || (*shadow).passes >= MOST_PASSES) {
        (*shadow).stage = NO_SHADOW;
        return;
    }
    let rest = select((*shadow).t_max - (*shadow).hit_t, NEVER, (*shadow).t_max >= NEVER);
    let direction = (*shadow).direction;
    weaken(shadow, absorbed((*shadow).absorption, (*shadow).hit_t));
    let is_body = is_matched && is_passed_alike(met, is_soft);
    let p = (*met).surface;
    let is_wall = p.thin != 0u && !is_soft;
    var bsdf: Bsdf;
    if (is_body || is_wall) {
        var seen = p;
        var normal = (*met).normal;
        if (is_soft) {
            seen = surface_parameters_seen_softly(p);
        }
        if (is_body && dot(direction, normal) < 0.0) {
            // As paths look below
            seen.surface_albedo = max(seen.surface_albedo, table_vector(shell_words((*met).material) + BRIGHTEST_SHELL));
        }
        if (is_wall) {
            normal = facing(normal, (*met).geometric, -direction);
        }
        bsdf = bsdf_new((*met).tables, seen, to_local(frame_of(normal), -direction));
    }
    if (is_body) {
        enter_body(shadow, met, rest, bsdf_below(bsdf));
        return;
    }
    var passed = vec3f(1.0 - (*met).opacity);
    let clear = select(0.0, p.transmission_weight * (1.0 - p.metalness), is_soft);
    if (clear > 0.0) {
        (*shadow).absorption = absorption_behind(met, direction, (*shadow).absorption);
        let cosine = abs(dot(direction, (*met).smooth_normal));
        passed += surface_parameters_straight_transmittance(p, cosine) * ((*met).opacity * clear);
    }
    if (is_wall) {
        passed += bsdf_straight_through_wall(bsdf) * (*met).opacity;
    }
    weaken(shadow, passed);
    (*shadow).origin = ray_origin(met, direction);
    (*shadow).t_max = rest;
}

// Begins the way through a body of a light that nothing scatters there; its surface lets a part in.
fn enter_body(shadow: ptr<function, Shadow>, met: ptr<function, Met>, rest: f32, passed: vec3f) {
    let direction = (*shadow).direction;
    let side = select(1.0, -1.0, dot(direction, (*met).geometric) > 0.0);
    let normal = (*met).geometric * side;
    let cosine = -dot(direction, normal);
    if (!(greatest((*met).length) > 0.0) || !(cosine > 0.0)) {
        (*shadow).stage = NO_SHADOW;
        return;
    }
    let scatters = (*met).length > vec3f(0.0);
    weaken(shadow, passed);
    if ((*shadow).stage == NO_SHADOW) {
        return;
    }
    let skipped = (*met).offset / max(cosine, 0.1);
    (*shadow).origin = (*met).position - normal * ((*met).offset - skipped * cosine);
    (*shadow).stage = BODY_SHADOW;
    (*shadow).sigma_t = select(vec3f(NEVER), 1.0 / max((*met).length, vec3f(1e-30)), scatters);
    (*shadow).share = vec3f(0.0);
    (*shadow).nesting = 1u;
    (*shadow).group = (*met).group;
    (*shadow).material = (*met).material;
    (*shadow).depth = 0.0;
    (*shadow).side = side;
    (*shadow).offset = (*met).offset;
    // The ray begins below the surface, the way on it
    (*shadow).done = skipped;
    // Beyond, the last channel is dark
    let shells = shells_around((*met).material, (*shadow).sigma_t, (*met).offset);
    let least = min(shells.least.x, min(shells.least.y, shells.least.z));
    (*shadow).length = min(rest, 14.0 / max(least, 14.0 / NEVER));
    (*shadow).light_distance = rest;
}

// A flight's surface, or nothing, as `flight_step` has it.
fn body_step(slot: u32, shadow: ptr<function, Shadow>, met: ptr<function, Met>) {
    if ((*shadow).hit_triangle == NO_TRIANGLE) {
        (*shadow).stage = NO_SHADOW;
        return;
    }
    let distance = (*shadow).done + (*shadow).hit_t;
    let leaves = dot((*shadow).direction, (*met).geometric) * (*shadow).side > 0.0;
    (*shadow).passes += 1u;
    if (leaves && (*shadow).nesting <= 1u) {
        // The body does not see lights inside
        if (distance > (*shadow).length || distance >= (*shadow).light_distance) {
            (*shadow).stage = NO_SHADOW;
            return;
        }
        leave_with_light(slot, shadow, met, distance);
        return;
    }
    if (distance > (*shadow).length || (*shadow).passes >= MOST_PASSES) {
        (*shadow).stage = NO_SHADOW;
        return;
    }
    (*shadow).nesting = select((*shadow).nesting + 1u, (*shadow).nesting - 1u, leaves);
    (*shadow).done = distance + (*shadow).offset;
}

fn leave_with_light(slot: u32, shadow: ptr<function, Shadow>, met: ptr<function, Met>, distance: f32) {
    let shells = shells_around((*shadow).material, (*shadow).sigma_t, (*shadow).offset);
    let sigma = shells.least;
    var attenuation = exp(-min(sigma * distance, vec3f(80.0)));
    attenuation = select(attenuation, vec3f(0.0), sigma * distance > vec3f(80.0));
    let drawn = (*shadow).share;
    if (sum(drawn) > 0.0) {
        // Of flights twice as long, of which this one came so far
        let chance = dot(drawn, exp(-min(0.5 * sigma * distance, vec3f(80.0))));
        attenuation /= max(chance, 1e-30);
    }
    weaken(shadow, attenuation * entering(met, (*shadow).direction, (*shadow).side));
    if ((*shadow).stage == NO_SHADOW) {
        return;
    }
    if (greatest(shells.most - shells.least) > 0.0) {
        enter_shells(slot, shadow, distance);
    } else {
        leave_body(shadow, met, distance);
    }
}

// Goes on outside, where it has left a body after a distance.
fn leave_body(shadow: ptr<function, Shadow>, met: ptr<function, Met>, distance: f32) {
    let rest = select((*shadow).light_distance - distance, NEVER, (*shadow).light_distance >= NEVER);
    send(shadow, met, (*shadow).direction, rest);
}

// Factor of a surface on a radiance that enters from a direction.
fn entering(met: ptr<function, Met>, direction: vec3f, side: f32) -> vec3f {
    return entry_weight(met, clamp(dot(direction, (*met).normal) * side, 0.0, 1.0));
}

// The share of a radiance that enters a scattering medium at a cosine.
fn entry_weight(met: ptr<function, Met>, cosine: f32) -> vec3f {
    return entry_entering(entry_new((*met).tables, (*met).surface), (*met).tables, cosine);
}
