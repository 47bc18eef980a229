// Surface albedo and length of a pair of points, where a texture gives exit and entry different ones: `subsurface/pairing.rs` of
// the renderer.

// Places of a pairing's words.
const IS_SYMMETRIC = 0u;
const BRIGHTEST_ENTRY = 1u;
const WIDEST_ALBEDO = 4u;
const WIDEST_LENGTH = 7u;

// Parameters of light under a surface: lengths are 0 in channels that do not scatter there.
struct Below {
    surface_albedo: vec3f,
    length: vec3f,
}

// Place of the words of a material's pairing, 0 where the exit's parameters count alone.
fn pairing_of(material: u32) -> u32 {
    let m = material_at(material);
    let place = u32(tables[m + PAIRING]);
    return select(0u, head(MEDIA) + place, place > 0u && u32(tables[m + BELOW_KIND]) == PROFILE_BELOW);
}

fn geometric_mean(a: vec3f, b: vec3f) -> vec3f {
    // One root for each: the product of two small ones may be 0
    return sqrt(a) * sqrt(b);
}

// Parameters of light that leaves at an exit of a material and enters where a triangle is hit. In another material, whose
// lengths may mean something else, the exit's count.
fn pair_of(kernel: u32, pairing: u32, exit: Below, material: u32, offset: f32, triangle: u32, b: vec2f) -> Below {
    let point = point_at(triangle, b);
    if (point.material != material) {
        return exit;
    }
    let m = material_at(material);
    var inputs = array<u32, 3>(SUBSURFACE_COLOR, SUBSURFACE_RADIUS_SCALE, SUBSURFACE_RADIUS);
    var values: array<vec3f, 3>;
    for (var k = 0u; k < 3u; k += 1u) {
        values[k] = input_at(m + INPUT_WORDS * inputs[k], point);
    }
    var entry: Below;
    entry.surface_albedo = unit(values[0]);
    entry.length = max(values[1], vec3f(0.0)) * max(values[2].x, 0.0);
    if (tables[pairing + IS_SYMMETRIC] > 0.0) {
        entry.surface_albedo = geometric_mean(entry.surface_albedo, exit.surface_albedo);
        entry.length = geometric_mean(entry.length, exit.length);
    }
    entry.length = select(vec3f(0.0), entry.length, exit.length > vec3f(0.0));
    entry.length = resolved(kernel, entry.surface_albedo, entry.length, offset);
    return entry;
}

// Greatest surface albedo of any pair with an exit of the given one.
fn brightest_pair(pairing: u32, exit: vec3f) -> vec3f {
    let greatest = table_vector(pairing + BRIGHTEST_ENTRY);
    return select(greatest, geometric_mean(greatest, exit), tables[pairing + IS_SYMMETRIC] > 0.0);
}

// The surface that makes paths look below a dark exit where the light may have entered at a bright point; the color only sets
// how often they do.
fn brightened(p: SurfaceParameters, pairing: u32) -> SurfaceParameters {
    var surface = p;
    let brighter = max(p.surface_albedo, 0.5 * brightest_pair(pairing, p.surface_albedo));
    surface.surface_albedo = mix(p.surface_albedo, brighter, p.subsurface_active);
    return surface;
}
