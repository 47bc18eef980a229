// The kernels of a round. Each works off lists of slots that others have filled, so that neighbors do alike work, and ends
// soon: no walk is followed to its end, for systems kill what takes seconds.
//
//   begin      all slots → samples that are done are written, others begun; slots into lists
//   trace      rays and light samples → what they meet
//   pass       light samples at surfaces and lights → further, there, or gone
//   surfaces   paths at surfaces → their way on, a light sample
//   walks      walks at the ends of flights → the next flight, or a path outside

override group_size: u32 = 64u;

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
    if (work == IDLE && settings.is_stopped == 0u) {
        let item = atomicAdd(&queues[NEXT_ITEM], 1u);
        if (item < settings.items) {
            begin(slot, item);
            work = FREE_RAY;
        }
    }
    if (work == FREE_RAY || work == WALK_RAY) {
        enqueue(RAYS, slot);
    }
    // Those that wait for their light sample
    if (work == FREE_HIT) {
        enqueue(SURFACES, slot);
    }
    if (work == WALK_HIT) {
        enqueue(WALKS, slot);
    }
    if (has_shadow && work != IDLE) {
        enqueue(SHADOWS, slot);
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
    var hit: Hit;
    if (slots[slot].path.work == FREE_RAY) {
        hit = closest(slots[slot].path.origin, slots[slot].path.direction, NEVER, EVERY_GROUP, 0u, false);
        slots[slot].path.work = FREE_HIT;
        enqueue(SURFACES, slot);
    } else {
        let done = slots[slot].walk.done;
        let direction = slots[slot].walk.direction;
        let way = slots[slot].walk.length - done + slots[slot].walk.offset;
        hit = closest(slots[slot].walk.from + direction * done, direction, way, ONE_GROUP, slots[slot].walk.group, false);
        slots[slot].path.work = WALK_HIT;
        enqueue(WALKS, slot);
    }
    slots[slot].path.hit_t = hit.t;
    slots[slot].path.hit = hit.b;
    slots[slot].path.hit_triangle = select(NO_TRIANGLE, hit.triangle, hit.is_hit);
}

fn trace_shadow(slot: u32) {
    let origin = slots[slot].shadow.origin;
    let direction = slots[slot].shadow.direction;
    var hit: Hit;
    if (slots[slot].shadow.stage == FREE_SHADOW) {
        hit = closest(origin, direction, slots[slot].shadow.t_max, EVERY_GROUP, 0u, head(SHADOWS_LOOK) == 0u);
    } else {
        let done = slots[slot].shadow.done;
        let way = slots[slot].shadow.length - done + slots[slot].shadow.offset;
        hit = closest(origin + direction * done, direction, way, ONE_GROUP, slots[slot].shadow.group, false);
    }
    slots[slot].shadow.hit_t = hit.t;
    slots[slot].shadow.hit = hit.b;
    slots[slot].shadow.hit_triangle = select(NO_TRIANGLE, hit.triangle, hit.is_hit);
    enqueue(SHADOW_HITS, slot);
}

@compute @workgroup_size(group_size)
fn pass_on(@builtin(global_invocation_id) id: vec3u) {
    lights_at = head(LIGHTS);
    let slot = dequeue(SHADOW_HITS, id.x);
    if (slot < settings.slots) {
        var shadow = slots[slot].shadow;
        shadow_step(slot, &shadow);
        slots[slot].shadow = shadow;
    }
}

@compute @workgroup_size(group_size)
fn at_surfaces(@builtin(global_invocation_id) id: vec3u) {
    lights_at = head(LIGHTS);
    let slot = dequeue(SURFACES, id.x);
    if (slot < settings.slots && slots[slot].shadow.stage == NO_SHADOW) {
        surface_step(slot);
    }
}

@compute @workgroup_size(group_size)
fn in_walks(@builtin(global_invocation_id) id: vec3u) {
    lights_at = head(LIGHTS);
    let slot = dequeue(WALKS, id.x);
    if (slot < settings.slots && slots[slot].shadow.stage == NO_SHADOW) {
        walk_step(slot);
    }
}
