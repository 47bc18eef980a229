// The kernels of a round. Each works off lists of slots that others have filled, so that neighbors do alike work, and ends
// soon: no walk is followed to its end, for systems kill what takes seconds.
//
//   begin_samples   all slots → samples that are done are written, others begun; slots into lists
//   trace           rays, flights, probes and light samples → what they meet
//   end_flights     flights → a collision, the body's end, or on
//   find_depths     ends of flights and light samples among layers → a collision, or on
//   weigh_probes    hits of probes → the next hit, or the entry point
//   look            what was met → the material's values there
//   pass_on         light samples at surfaces and lights → further, there, or gone
//   meet_surfaces   paths at lights, surfaces and bodies' ends → gone, on, or to be scattered beside a light sample
//   sample_lights   light samples
//   scatter_paths   paths → their way on; light samples set out

override group_size: u32 = 64u;

// As in `path/shadow_catcher.rs` of the renderer.
const SHADOW_CANDIDATES = 16u;
const SHADOW_STEPS = vec3f(0.8191725, 0.6710436, 0.5497005);

@compute @workgroup_size(group_size)
fn begin_samples(@builtin(global_invocation_id) id: vec3u) {
    let slot = id.x;
    if (slot >= settings.slots) {
        return;
    }
    var work = slots[slot].path.work;
    let has_shadow = slots[slot].shadow.stage != NO_SHADOW;
    if (work == ENDED && !has_shadow) {
        write_sample(slots[slot].path.item, slots[slot].found);
        atomicAdd(&queues[DONE_ITEMS], 1u);
        slots[slot].path.work = IDLE;
        work = IDLE;
    }
    // Counted only while there are any, or the counter would turn over
    if (work == IDLE && settings.is_stopped == 0u && atomicLoad(&queues[NEXT_ITEM]) < settings.items) {
        let item = atomicAdd(&queues[NEXT_ITEM], 1u);
        if (item < settings.items) {
            begin(slot, item);
            work = FREE_RAY;
        }
    }
    if (work == FREE_RAY || work == WALK_RAY || work == PROBE_RAY) {
        enqueue(RAYS, slot);
    }
    if (work == PROBE_NEXT) {
        enqueue(PROBES, slot);
    }
    // Those that wait for their last light sample
    if (work == AT_SURFACE || work == COLLIDED || work == AT_MATTE_END || work == AT_CATCHER) {
        enqueue(SCATTERS, slot);
    }
    if (has_shadow && work != IDLE) {
        enqueue(select(SHADOWS, SHADOW_DEPTHS, slots[slot].shadow.stage == SHELL_SHADOW), slot);
    }
}

@compute @workgroup_size(group_size)
fn trace(@builtin(global_invocation_id) id: vec3u) {
    let rays = atomicLoad(&queues[RAYS]);
    if (id.x < rays) {
        trace_path(dequeue(RAYS, id.x));
        return;
    }
    let slot = dequeue(SHADOWS, id.x - rays);
    if (slot < settings.slots) {
        trace_shadow(slot);
    }
}

fn trace_path(slot: u32) {
    let work = slots[slot].path.work;
    var origin = slots[slot].path.origin;
    var direction = slots[slot].path.direction;
    var way = NEVER;
    var after = Along(0.0, NO_TRIANGLE);
    if (work == WALK_RAY) {
        let done = slots[slot].walk.done;
        direction = slots[slot].walk.direction;
        origin = slots[slot].walk.start + direction * done;
        way = slots[slot].walk.length - done + slots[slot].walk.offset;
    } else if (work == PROBE_RAY) {
        way = slots[slot].probe.t_max;
        after = Along(slots[slot].probe.t, slots[slot].probe.triangle);
    }
    let groups = select(ONE_GROUP, EVERY_GROUP, work == FREE_RAY);
    // Below a surface, that of what was met there
    let hit = closest(origin, direction, after, way, groups, slots[slot].met.group, false);
    if (work == FREE_RAY) {
        slots[slot].path.work = FREE_HIT;
        enqueue(POINTS, slot);
    } else if (work == WALK_RAY) {
        slots[slot].path.work = WALK_HIT;
        enqueue(FLIGHTS, slot);
    } else {
        slots[slot].path.work = PROBE_HIT;
        enqueue(PROBES, slot);
    }
    slots[slot].path.hit_t = hit.t;
    slots[slot].path.hit = hit.b;
    slots[slot].path.hit_triangle = select(NO_TRIANGLE, hit.triangle, hit.is_hit);
}

fn trace_shadow(slot: u32) {
    let origin = slots[slot].shadow.origin;
    let direction = slots[slot].shadow.direction;
    let start = Along(0.0, NO_TRIANGLE);
    var hit: Hit;
    if (slots[slot].shadow.stage == FREE_SHADOW) {
        let any = head(SHADOWS_LOOK) == 0u;
        hit = closest(origin, direction, start, slots[slot].shadow.t_max, EVERY_GROUP, 0u, any);
    } else {
        let done = slots[slot].shadow.done;
        let way = slots[slot].shadow.length - done + slots[slot].shadow.offset;
        hit = closest(origin + direction * done, direction, start, way, ONE_GROUP, slots[slot].shadow.group, false);
    }
    slots[slot].shadow.hit_t = hit.t;
    slots[slot].shadow.hit = hit.b;
    slots[slot].shadow.hit_triangle = select(NO_TRIANGLE, hit.triangle, hit.is_hit);
    enqueue(SHADOW_HITS, slot);
}

@compute @workgroup_size(group_size)
fn end_flights(@builtin(global_invocation_id) id: vec3u) {
    let slot = dequeue(FLIGHTS, id.x);
    if (slot >= settings.slots) {
        return;
    }
    var path = slots[slot].path;
    var walk = slots[slot].walk;
    var light = slots[slot].light;
    flight_step(&path, &walk, &light);
    if (path.work == WALK_END) {
        enqueue(POINTS, slot);
    }
    if (path.work == WALK_DEPTH) {
        enqueue(DEPTHS, slot);
    }
    if (path.work == COLLIDED) {
        enqueue_scattering(slot, light.kind);
    }
    slots[slot].path = path;
    slots[slot].walk = walk;
    slots[slot].light = light;
}

@compute @workgroup_size(group_size)
fn find_depths(@builtin(global_invocation_id) id: vec3u) {
    let walks = atomicLoad(&queues[DEPTHS]);
    let is_shadow = id.x >= walks;
    var slot = 0u;
    if (is_shadow) {
        slot = dequeue(SHADOW_DEPTHS, id.x - walks);
    } else {
        slot = dequeue(DEPTHS, id.x);
    }
    if (slot >= settings.slots) {
        return;
    }
    var walk = slots[slot].walk;
    var shadow = slots[slot].shadow;
    var shells: Shells;
    var point = walk.start;
    var group = slots[slot].met.group;
    var depth = walk.depth;
    var moved = walk.done;
    var is_loss = false;
    if (is_shadow) {
        shells = shells_around(shadow.material, shadow.sigma_t, shadow.offset);
        let before = shadow.done;
        is_loss = step_in_shells(&shadow, &shells);
        if (shadow.done >= shadow.length) {
            var met = slots[slot].shadow_met;
            shadow.stage = FREE_SHADOW;
            weaken(&shadow, shadow.share);
            if (shadow.stage != NO_SHADOW) {
                leave_body(&shadow, &met, shadow.length);
            }
            slots[slot].shadow = shadow;
            return;
        }
        point = shadow.origin + shadow.direction * shadow.done;
        group = shadow.group;
        depth = shadow.depth;
        moved = shadow.done - before + shadow.offset;
    } else {
        shells = shells_around(walk.material, walk.sigma_t, walk.offset);
    }
    depth = depth_of(&shells, point, group, depth, moved);
    if (is_shadow) {
        lose_in_shells(&shadow, &shells, depth, is_loss);
        slots[slot].shadow = shadow;
        return;
    }
    var path = slots[slot].path;
    var light = slots[slot].light;
    end_flight_in_shells(&path, &walk, &light, &shells, depth);
    if (path.work == COLLIDED) {
        enqueue_scattering(slot, light.kind);
    }
    slots[slot].path = path;
    slots[slot].walk = walk;
    slots[slot].light = light;
}

fn enqueue_scattering(slot: u32, light: u32) {
    enqueue(SCATTERS, slot);
    if (light != NO_LIGHT) {
        enqueue(LIGHT_REQUESTS, slot);
    }
}

@compute @workgroup_size(group_size)
fn weigh_probes(@builtin(global_invocation_id) id: vec3u) {
    let slot = dequeue(PROBES, id.x);
    if (slot >= settings.slots) {
        return;
    }
    var path = slots[slot].path;
    var probe = slots[slot].probe;
    let material = slots[slot].walk.material;
    let exit = Below(probe.surface_albedo, probe.length);
    probe_step(&path, &probe, material, slots[slot].walk.offset);
    if (path.work == PROBE_END) {
        path.throughput *= shape_factor(material, slots[slot].met.group, exit, probe.exit);
        enqueue(POINTS, slot);
    }
    slots[slot].path = path;
    slots[slot].probe = probe;
}

@compute @workgroup_size(group_size)
fn look(@builtin(global_invocation_id) id: vec3u) {
    let points = atomicLoad(&queues[POINTS]);
    let is_shadow = id.x >= points;
    var slot = 0u;
    if (is_shadow) {
        slot = dequeue(SHADOW_HITS, id.x - points);
    } else {
        slot = dequeue(POINTS, id.x);
    }
    if (slot >= settings.slots) {
        return;
    }
    let triangle = select(slots[slot].path.hit_triangle, slots[slot].shadow.hit_triangle, is_shadow);
    if (triangle == NO_TRIANGLE) {
        return;
    }
    let met = met_at(triangle, select(slots[slot].path.hit, slots[slot].shadow.hit, is_shadow));
    if (is_shadow) {
        slots[slot].shadow_met = met;
    } else {
        slots[slot].met = met;
    }
}

@compute @workgroup_size(group_size)
fn pass_on(@builtin(global_invocation_id) id: vec3u) {
    lights_at = head(LIGHTS);
    let slot = dequeue(SHADOW_HITS, id.x);
    if (slot < settings.slots) {
        var shadow = slots[slot].shadow;
        var met = slots[slot].shadow_met;
        shadow_step(slot, &shadow, &met);
        slots[slot].shadow = shadow;
    }
}

@compute @workgroup_size(group_size)
fn meet_surfaces(@builtin(global_invocation_id) id: vec3u) {
    lights_at = head(LIGHTS);
    let slot = dequeue(POINTS, id.x);
    if (slot >= settings.slots) {
        return;
    }
    var path = slots[slot].path;
    var light = slots[slot].light;
    var met = slots[slot].met;
    if (path.work == FREE_HIT) {
        var found = slots[slot].found;
        meet(&path, &found, &met, &light);
        slots[slot].found = found;
    } else if (path.work == PROBE_END) {
        path.work = AT_MATTE_END;
        request_light(&light, met.position, met.normal * slots[slot].walk.side);
    } else {
        var walk = slots[slot].walk;
        reach_end(&path, &walk, &met, &light);
        slots[slot].walk = walk;
    }
    if (path.work == AT_SURFACE || path.work == AT_MATTE_END || path.work == AT_CATCHER) {
        enqueue_scattering(slot, light.kind);
    }
    slots[slot].path = path;
    slots[slot].light = light;
}

@compute @workgroup_size(group_size)
fn sample_lights(@builtin(global_invocation_id) id: vec3u) {
    lights_at = head(LIGHTS);
    let slot = dequeue(LIGHT_REQUESTS, id.x);
    if (slot >= settings.slots) {
        return;
    }
    let work = slots[slot].path.work;
    var u: vec4f;
    if (work == COLLIDED) {
        var path = slots[slot].path;
        u = walk_numbers(&path, true, 2u * slots[slot].walk.events - 1u, slots[slot].walk.draws);
    } else {
        let is_of_surface = work == AT_SURFACE || work == AT_CATCHER;
        let of_end = end_set(slots[slot].path.flags, material_at(slots[slot].walk.material));
        let number = select(of_end, 1u, is_of_surface);
        u = stratified(slots[slot].path.sampler, slots[slot].path.vertex, number);
    }
    var light = slots[slot].light;
    light.kind = NO_LIGHT;
    // One of several samples for shadows that are all that is seen, in proportion to its light
    let candidates = select(1u, SHADOW_CANDIDATES, work == AT_CATCHER);
    var choice = u.w;
    var all = 0.0;
    for (var n = 0u; n < candidates; n += 1u) {
        let v = fract(u.xyz + SHADOW_STEPS * f32(n));
        let sample = light_sample(light.point, light.normal, v.x, v.yz);
        if (!sample.is_usable) {
            continue;
        }
        var radiance = sample.radiance;
        if (sample.triangle != NO_TRIANGLE) {
            let place = triangle_light_surface(sample.triangle);
            if (place >= 0.0) {
                radiance = emission_at(u32(place), uniform_triangle(v.yz));
            }
        }
        if (work == AT_CATCHER) {
            let weight = luminance(radiance) * max(dot(light.normal, sample.direction), 0.0) / sample.pdf;
            if (!(weight > 0.0 && weight < NEVER)) {
                continue;
            }
            all += weight;
            // What is left of a choice decides the next one
            let share = weight / all;
            let is_chosen = choice < share;
            choice = select((choice - share) / (1.0 - share), choice / share, is_chosen);
            if (!is_chosen) {
                continue;
            }
        }
        light.direction = sample.direction;
        light.distance = min(sample.distance, NEVER);
        light.radiance = radiance;
        light.pdf = sample.pdf;
        light.random = choice;
        light.kind = select(USABLE, DELTA, sample.is_delta);
    }
    slots[slot].light = light;
}

@compute @workgroup_size(group_size)
fn scatter_paths(@builtin(global_invocation_id) id: vec3u) {
    let slot = dequeue(SCATTERS, id.x);
    if (slot >= settings.slots || slots[slot].shadow.stage != NO_SHADOW) {
        return;
    }
    var path = slots[slot].path;
    var light = slots[slot].light;
    var shadow = slots[slot].shadow;
    if (path.work == AT_SURFACE) {
        var met = slots[slot].met;
        var found = slots[slot].found;
        scatter_at_surface(slot, &path, &found, &met, &light, &shadow);
        slots[slot].found = found;
    } else if (path.work == AT_CATCHER) {
        var met = slots[slot].met;
        var found = slots[slot].found;
        look_for_shadow(&path, &found, &met, &light, &shadow);
        slots[slot].found = found;
    } else {
        var walk = slots[slot].walk;
        if (path.work == COLLIDED) {
            scatter_walk(&path, &walk, &light, &shadow, slots[slot].met.group);
        } else {
            var met = slots[slot].met;
            var probe = slots[slot].probe;
            scatter_at_matte_end(&path, &walk, &probe, &met, &light, &shadow);
        }
        slots[slot].walk = walk;
    }
    slots[slot].path = path;
    slots[slot].shadow = shadow;
}
