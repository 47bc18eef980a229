// Rays of the camera, and samples that are done.

fn filter_offset(u: f32) -> f32 {
    let place = u * f32(FILTER_INTERVALS);
    let index = min(u32(place), FILTER_INTERVALS - 1u);
    let at = head(FILTER) + index;
    return mix(tables[at], tables[at + 1u], place - f32(index));
}

// Begins the path of a sample.
fn begin(slot: u32, item: u32) {
    let pixels = settings.region.x * settings.region.y;
    let place = item % pixels;
    let pixel = settings.corner + vec2u(place % settings.region.x, place / settings.region.x);
    let sampler = sampler_of(pixel, settings.first_sample + item / pixels);
    let u = stratified(sampler, 0u, 0u);
    let offset = vec2f(filter_offset(u.x), filter_offset(u.y));
    let film = (vec2f(pixel) + 0.5 + offset) * settings.step / settings.size * 2.0 - 1.0;
    let sight = film * settings.half_size + settings.middle;
    var start = vec3f(0.0);
    var way = vec3f(sight, 1.0);
    if (settings.is_orthographic != 0u) {
        start = vec3f(sight, 0.0);
        way = vec3f(0.0, 0.0, 1.0);
    }
    if (settings.lens_radius > 0.0) {
        let lens = vec3f(concentric_disk(u.zw) * settings.lens_radius, 0.0);
        way = way * settings.focus_distance - lens;
        start += lens;
    }
    var path: Path;
    path.origin = settings.position + in_world(start);
    path.direction = normalize(in_world(way));
    path.work = FREE_RAY;
    path.item = item;
    path.throughput = vec3f(1.0);
    path.mis_point = path.origin;
    path.mis_pdf = NEVER;
    path.layer = OF_EMISSION;
    path.sampler = sampler;
    slots[slot].path = path;
    slots[slot].shadow.stage = NO_SHADOW;
    var found: Found;
    slots[slot].found = found;
}

fn in_world(v: vec3f) -> vec3f {
    return settings.right * v.x + settings.down * v.y + settings.forward * v.z;
}

fn write_sample(item: u32, found: Found) {
    let at = item * SAMPLE_WORDS;
    write_color(at, found.matte);
    write_color(at + 3u, found.specular);
    write_color(at + 6u, found.subsurface);
    write_color(at + 9u, found.emission);
    samples[at + 12u] = found.alpha;
    write_color(at + 13u, found.albedo);
    write_color(at + 16u, found.normal);
    samples[at + 19u] = found.depth;
}

fn write_color(at: u32, color: vec3f) {
    samples[at] = color.x;
    samples[at + 1u] = color.y;
    samples[at + 2u] = color.z;
}
