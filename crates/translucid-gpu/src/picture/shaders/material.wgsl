// A material's parameters at a point: factors, textures and vertex colors multiplied, clamped to their ranges.

// Mean free paths below this many rounding errors of a position count as a point.
const LEAST_OFFSETS_OF_MFP = 8.0;
const GREATEST_EMISSION = 1e6;

fn material_at(material: u32) -> u32 {
    return head(MATERIALS) + material * MATERIAL_WORDS;
}

fn texel(image: u32, x: u32, y: u32, width: u32) -> vec4f {
    let at = images[head(IMAGES) + image] + 2u * (y * width + x);
    return vec4f(unpack2x16float(images[at]), unpack2x16float(images[at + 1u]));
}

fn wrapped(coordinate: f32, wrap: u32) -> f32 {
    if (wrap == 0u) {
        return coordinate - floor(coordinate);
    }
    if (wrap == 1u) {
        let halved = 0.5 * coordinate;
        return 1.0 - abs(2.0 * (halved - floor(halved)) - 1.0);
    }
    return clamp(coordinate, 0.0, 1.0);
}

fn neighbor(index: i32, size: u32, wrap: u32) -> u32 {
    let last = i32(size) - 1;
    if (wrap == 0u && index < 0) {
        return u32(last);
    }
    if (wrap == 0u && index > last) {
        return 0u;
    }
    return u32(clamp(index, 0, last));
}

fn textured(texture: f32, uv: vec2f) -> vec4f {
    let at = head(TEXTURES) + u32(texture) * TEXTURE_WORDS;
    let image = u32(tables[at]);
    let size = vec2u(u32(tables[at + 1u]), u32(tables[at + 2u]));
    let wrap = vec2u(u32(tables[at + 3u]), u32(tables[at + 4u]));
    let x = tables[at + 5u] * uv.x + tables[at + 7u] * uv.y + tables[at + 9u];
    let y = tables[at + 6u] * uv.x + tables[at + 8u] * uv.y + tables[at + 10u];
    let place = vec2f(wrapped(x, wrap.x), 1.0 - wrapped(y, wrap.y)) * vec2f(size) - 0.5;
    let first = floor(place);
    let between = place - first;
    // The pixel whose square holds the place, where that is asked for
    let part = select(between, step(vec2f(0.5), between), tables[at + 11u] > 0.0);
    let left = neighbor(i32(first.x), size.x, wrap.x);
    let right = neighbor(i32(first.x) + 1, size.x, wrap.x);
    let up = neighbor(i32(first.y), size.y, wrap.y);
    let below = neighbor(i32(first.y) + 1, size.y, wrap.y);
    let above = mix(texel(image, left, up, size.x), texel(image, right, up, size.x), part.x);
    return mix(above, mix(texel(image, left, below, size.x), texel(image, right, below, size.x), part.x), part.y);
}

// A point of a surface with all that its material states there.
struct Met {
    position: vec3f,
    // Distance by which a ray's origin has to leave the surface to clear rounding errors.
    offset: f32,
    // Unit normals on the outside of the mesh, the shading normal as the mesh has it, and bent by a normal map.
    geometric: vec3f,
    material: u32,
    smooth_normal: vec3f,
    group: u32,
    normal: vec3f,
    // Number as a light.
    light: u32,
    emission: vec3f,
    opacity: f32,
    // Mean free paths of the medium below; 0 in channels whose light leaves too near its entry for positions to resolve.
    length: vec3f,
    // Where the tables of the material's two indices begin.
    tables: u32,
    // The surface over the medium's albedo.
    surface: SurfaceParameters,
}

// The value of an input at a point.
fn input_at(place: u32, point: Point) -> vec3f {
    var value = table_vector(place);
    let kind = u32(tables[place + 4u]);
    if (tables[place + 3u] >= 0.0) {
        let texel = textured(tables[place + 3u], point.uv);
        if (kind < 2u) {
            value *= texel.rgb;
        } else {
            value *= texel[kind - 2u];
        }
    }
    if (kind == 1u) {
        value *= point.color;
    }
    return value;
}

// Emission at a place of a triangle, on average over whether the surface is there.
fn emission_at(triangle: u32, b: vec2f) -> vec3f {
    let point = point_at(triangle, b);
    let m = material_at(point.material);
    var values: array<vec3f, 2>;
    for (var k = 0u; k < 2u; k += 1u) {
        values[k] = input_at(m + INPUT_WORDS * select(GEOMETRY_OPACITY, EMISSION_COLOR, k == 0u), point);
    }
    return emitted(values[0], m) * unit(values[1]).x;
}

fn emitted(color: vec3f, m: u32) -> vec3f {
    return clamp(color, vec3f(0.0), vec3f(GREATEST_EMISSION)) * tables[m + EMISSION_LUMINANCE];
}

// Everything at a point: one loop over inputs, for drivers copy what is called into every place.
fn met_at(triangle: u32, b: vec2f) -> Met {
    let point = point_at(triangle, b);
    let m = material_at(point.material);
    var values: array<vec3f, INPUTS>;
    for (var k = 0u; k < INPUTS; k += 1u) {
        values[k] = input_at(m + INPUT_WORDS * k, point);
    }
    var met: Met;
    met.position = point.position;
    met.offset = point.offset;
    met.geometric = point.geometric;
    met.material = point.material;
    met.smooth_normal = point.shading;
    met.group = point.group;
    met.light = point.light;
    met.normal = bent_normal(point, m, values[GEOMETRY_NORMAL]);
    met.opacity = clamp(values[GEOMETRY_OPACITY].x, 0.0, 1.0);
    met.emission = emitted(values[EMISSION_COLOR], m);
    let is_thin = tables[m + GEOMETRY_THIN_WALLED] > 0.0;
    var p: SurfaceParameters;
    p.base_color = unit(values[BASE_COLOR]) * tables[m + BASE_WEIGHT];
    p.metalness = unit(values[BASE_METALNESS]).x;
    p.specular_weight = unit(values[SPECULAR_WEIGHT]).x;
    p.specular_color = unit(values[SPECULAR_COLOR]);
    p.specular_roughness = unit(values[SPECULAR_ROUGHNESS]).x;
    p.specular_ior = tables[m + SPECULAR_IOR];
    p.transmission_weight = unit(values[TRANSMISSION_WEIGHT]).x;
    p.transmission_tint = unit(values[TRANSMISSION_COLOR]);
    p.subsurface_weight = unit(values[SUBSURFACE_WEIGHT]).x;
    p.surface_albedo = unit(values[SUBSURFACE_COLOR]);
    p.coat_weight = unit(values[COAT_WEIGHT]).x;
    p.coat_color = unit(values[COAT_COLOR]);
    p.coat_roughness = unit(values[COAT_ROUGHNESS]).x;
    p.coat_ior = tables[m + COAT_IOR];
    met.tables = u32(tables[m + REFLECTANCES]);
    let stated = max(values[SUBSURFACE_RADIUS_SCALE], vec3f(0.0)) * max(values[SUBSURFACE_RADIUS].x, 0.0);
    if (u32(tables[m + BELOW_KIND]) == PROFILE_BELOW) {
        set_profile(&met, &p, kernel_of(point.material), stated);
    } else if (u32(tables[m + BELOW_KIND]) == WALK_BELOW) {
        let table = head(MEDIA) + u32(tables[m + MEDIUM]) + ALBEDOS + 1u;
        let length = stated * of_albedos(table, p.surface_albedo);
        let least = vec3f(LEAST_OFFSETS_OF_MFP * point.offset);
        // Below shells there is no surface that light could leave where it enters
        let unresolved = select(vec3f(0.0), least, tables[shell_words(point.material)] > 0.0);
        met.length = select(unresolved, length, length > least);
    }
    p.subsurface_active = select(vec3f(0.0), vec3f(1.0), met.length > vec3f(0.0));
    if (is_thin) {
        p = surface_parameters_scattered_to_both_sides(p, tables[m + SUBSURFACE_SCATTER_ANISOTROPY]);
    }
    met.surface = p;
    return met;
}

// Place of the words of a material's profile.
fn kernel_of(material: u32) -> u32 {
    return head(MEDIA) + u32(tables[material_at(material) + MEDIUM]);
}

// Surface albedos of a profile, and lengths, 0 in channels half of whose light leaves too near its entry.
fn set_profile(met: ptr<function, Met>, p: ptr<function, SurfaceParameters>, kernel: u32, stated: vec3f) {
    var length = stated;
    if (tables[kernel + HAS_OWN] > 0.0) {
        (*p).surface_albedo = table_vector(kernel + OWN_ALBEDO);
        length = table_vector(kernel + OWN_LENGTH);
    }
    (*met).length = resolved(kernel, (*p).surface_albedo, length, (*met).offset);
}

// Lengths, 0 in channels half of whose light leaves too near its entry for positions to tell it.
fn resolved(kernel: u32, surface_albedo: vec3f, stated: vec3f, offset: f32) -> vec3f {
    var length = vec3f(0.0);
    for (var c = 0u; c < 3u; c += 1u) {
        let albedo = surface_albedo[c];
        let median = median_radius(kernel, profile_row(kernel, albedo), albedo, stated[c]);
        length[c] = select(0.0, stated[c], stated[c] > 0.0 && median > offset);
    }
    return length;
}

fn unit(color: vec3f) -> vec3f {
    return clamp(color, vec3f(0.0), vec3f(1.0));
}

// The shading normal, bent by a texel of the normal map if there is one.
fn bent_normal(point: Point, m: u32, texel: vec3f) -> vec3f {
    let normal = point.shading;
    if (tables[m + INPUT_WORDS * GEOMETRY_NORMAL + 3u] < 0.0) {
        return normal;
    }
    let at = point.stored * head(ATTRIBUTE_WORDS) + head(TANGENT);
    var tangent = vec3f(0.0);
    // One, or those of the corners
    for (var k = 0u; k < head(TANGENTS); k += 1u) {
        tangent += placed_tangent(attribute_color(at + select(3u * k + 1u, 0u, k == 0u)), point.instance);
    }
    var sign = attributes[at + 3u];
    if (point.instance != NO_INSTANCE) {
        sign *= instance_number(point.instance, HANDEDNESS);
    }
    tangent -= normal * dot(normal, tangent);
    let squared = dot(tangent, tangent);
    if (!(squared > 1e-30)) {
        return normal;
    }
    tangent *= inverseSqrt(squared);
    let bitangent = cross(normal, tangent) * sign;
    let bent = 2.0 * texel - 1.0;
    let scale = tables[m + NORMAL_SCALE];
    let summed = tangent * (bent.x * scale) + bitangent * (bent.y * scale) + normal * bent.z;
    let length = dot(summed, summed);
    if (length > 1e-30 && dot(summed, point.geometric) > 0.0) {
        return summed * inverseSqrt(length);
    }
    return normal;
}

// Values of a medium's table at surface albedos.
fn of_albedos(table: u32, albedo: vec3f) -> vec3f {
    let place = clamp(albedo, vec3f(0.0), vec3f(1.0)) * f32(ALBEDOS);
    let cell = min(vec3u(place), vec3u(ALBEDOS - 1u));
    let at = vec3u(table) + cell;
    let low = vec3f(tables[at.x], tables[at.y], tables[at.z]);
    let high = vec3f(tables[at.x + 1u], tables[at.y + 1u], tables[at.z + 1u]);
    return mix(low, high, place - vec3f(cell));
}

// Single-scattering albedos of the medium of a material.
fn single_scattering_albedo(material: u32, albedo: vec3f) -> vec3f {
    let root = of_albedos(head(MEDIA) + u32(tables[material_at(material) + MEDIUM]), albedo);
    return 1.0 - root * root;
}

// Absorption coefficient of the clear medium that a direction across a surface leads into from one of coefficient `before`.
fn absorption_behind(met: ptr<function, Met>, direction: vec3f, before: vec3f) -> vec3f {
    let m = material_at((*met).material);
    if (tables[m + GEOMETRY_THIN_WALLED] > 0.0) {
        return before;
    }
    if (dot(direction, (*met).geometric) < 0.0) {
        return table_vector(m + ABSORPTION);
    }
    return vec3f(0.0);
}

// A ray's origin on the side of the surface that a direction points to.
fn ray_origin(met: ptr<function, Met>, direction: vec3f) -> vec3f {
    let is_outside = dot((*met).geometric, direction) >= 0.0;
    return (*met).position + (*met).geometric * select(-(*met).offset, (*met).offset, is_outside);
}

// Returns true if paths and shadow rays pass the body below a surface alike.
fn is_passed_alike(met: ptr<function, Met>, is_soft: bool) -> bool {
    return (*met).opacity >= 1.0 && (*met).surface.metalness == 0.0
        && (!is_soft || (*met).surface.transmission_weight == 0.0);
}
