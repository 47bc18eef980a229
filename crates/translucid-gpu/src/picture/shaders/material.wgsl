// A material's parameters at a point: factors, textures and vertex colors multiplied, clamped to their ranges.

// Places in the words of a material.
const BASE_COLOR = 0u;
const BASE_WEIGHT = 5u;
const BASE_METALNESS = 6u;
const SPECULAR_WEIGHT = 9u;
const SPECULAR_COLOR = 12u;
const SPECULAR_ROUGHNESS = 17u;
const SPECULAR_IOR = 20u;
const TRANSMISSION_WEIGHT = 21u;
const TRANSMISSION_COLOR = 24u;
const TRANSMISSION_DEPTH = 29u;
const SUBSURFACE_WEIGHT = 30u;
const SUBSURFACE_COLOR = 33u;
const SUBSURFACE_RADIUS = 38u;
const SUBSURFACE_RADIUS_SCALE = 41u;
const SUBSURFACE_ANISOTROPY = 46u;
const COAT_WEIGHT = 47u;
const COAT_COLOR = 50u;
const COAT_ROUGHNESS = 55u;
const COAT_IOR = 58u;
const EMISSION_LUMINANCE = 59u;
const EMISSION_COLOR = 60u;
const OPACITY = 65u;
const THIN_WALLED = 68u;
const NORMAL_MAP = 69u;
const NORMAL_SCALE = 70u;
const HIDDEN_FROM_CAMERA = 71u;
const HAS_WALK = 72u;
const WALK_SURFACE = 73u;
const WALK_ETA = 74u;
const WALK_G = 75u;
const MOST_FLIGHTS = 76u;
const MEDIUM = 77u;
const REFLECTANCES = 78u;
const LETS_LIGHT_THROUGH = 79u;
const IS_MATCHED = 80u;
const ABSORPTION = 81u;

// Intervals of a table over the surface albedo.
const ALBEDOS = 1024.0;
// Mean free paths below this many rounding errors of a position count as a point.
const LEAST_OFFSETS_OF_MFP = 8.0;
const GREATEST_EMISSION = 1e6;

fn material_at(material: u32) -> u32 {
    return head(MATERIALS) + material * head(MATERIAL_WORDS);
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
        let half = 0.5 * coordinate;
        return 1.0 - abs(2.0 * (half - floor(half)) - 1.0);
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
    let at = head(TEXTURES) + u32(texture) * head(TEXTURE_WORDS);
    let image = u32(tables[at]);
    let size = vec2u(u32(tables[at + 1u]), u32(tables[at + 2u]));
    let wrap = vec2u(u32(tables[at + 3u]), u32(tables[at + 4u]));
    let x = tables[at + 5u] * uv.x + tables[at + 7u] * uv.y + tables[at + 9u];
    let y = tables[at + 6u] * uv.x + tables[at + 8u] * uv.y + tables[at + 10u];
    let place = vec2f(wrapped(x, wrap.x), 1.0 - wrapped(y, wrap.y)) * vec2f(size) - 0.5;
    let first = floor(place);
    let part = place - first;
    let left = neighbor(i32(first.x), size.x, wrap.x);
    let right = neighbor(i32(first.x) + 1, size.x, wrap.x);
    let up = neighbor(i32(first.y), size.y, wrap.y);
    let below = neighbor(i32(first.y) + 1, size.y, wrap.y);
    let above = mix(texel(image, left, up, size.x), texel(image, right, up, size.x), part.x);
    return mix(above, mix(texel(image, left, below, size.x), texel(image, right, below, size.x), part.x), part.y);
}

fn color_at(place: u32, point: Point) -> vec3f {
    var color = table_color(place);
    if (tables[place + 3u] >= 0.0) {
        color *= textured(tables[place + 3u], point.uv).rgb;
    }
    if (tables[place + 4u] > 0.0) {
        color *= point.color;
    }
    return color;
}

fn scalar_at(place: u32, point: Point) -> f32 {
    if (tables[place + 1u] < 0.0) {
        return tables[place];
    }
    return tables[place] * textured(tables[place + 1u], point.uv)[u32(tables[place + 2u])];
}

fn unit_color_at(place: u32, point: Point) -> vec3f {
    return clamp(color_at(place, point), vec3f(0.0), vec3f(1.0));
}

fn unit_at(place: u32, point: Point) -> f32 {
    return clamp(scalar_at(place, point), 0.0, 1.0);
}

// Parameters of the surface itself; below it is no light yet.
fn surface_at(point: Point) -> Surface {
    let m = material_at(point.material);
    let is_thin = tables[m + THIN_WALLED] > 0.0;
    var p: Surface;
    p.base_color = unit_color_at(m + BASE_COLOR, point) * tables[m + BASE_WEIGHT];
    p.metalness = unit_at(m + BASE_METALNESS, point);
    p.specular_weight = unit_at(m + SPECULAR_WEIGHT, point);
    p.specular_color = unit_color_at(m + SPECULAR_COLOR, point);
    p.specular_roughness = unit_at(m + SPECULAR_ROUGHNESS, point);
    p.specular_ior = tables[m + SPECULAR_IOR];
    p.transmission_weight = unit_at(m + TRANSMISSION_WEIGHT, point);
    p.transmission_tint = vec3f(1.0);
    if (!(tables[m + TRANSMISSION_DEPTH] > 0.0) || is_thin) {
        p.transmission_tint = unit_color_at(m + TRANSMISSION_COLOR, point);
    }
    p.subsurface_weight = unit_at(m + SUBSURFACE_WEIGHT, point);
    p.surface_albedo = vec3f(0.0);
    p.subsurface_active = vec3f(0.0);
    p.thin_albedo = vec3f(0.0);
    p.is_thin = u32(is_thin);
    p.coat_weight = unit_at(m + COAT_WEIGHT, point);
    p.coat_color = unit_color_at(m + COAT_COLOR, point);
    p.coat_roughness = unit_at(m + COAT_ROUGHNESS, point);
    p.coat_ior = tables[m + COAT_IOR];
    p.tables = u32(tables[m + REFLECTANCES]);
    return p;
}

fn opacity_at(point: Point) -> f32 {
    return unit_at(material_at(point.material) + OPACITY, point);
}

fn emission_at(point: Point) -> vec3f {
    let m = material_at(point.material);
    let luminance = tables[m + EMISSION_LUMINANCE];
    if (!(luminance > 0.0)) {
        return vec3f(0.0);
    }
    return clamp(color_at(m + EMISSION_COLOR, point), vec3f(0.0), vec3f(GREATEST_EMISSION)) * luminance;
}

// The shading normal, bent by the normal map if there is one.
fn shading_normal_at(point: Point) -> vec3f {
    let m = material_at(point.material);
    let map = tables[m + NORMAL_MAP];
    if (map < 0.0) {
        return point.shading;
    }
    let at = point.triangle * head(ATTRIBUTE_WORDS) + head(TANGENT);
    let normal = point.shading;
    var tangent = attribute_color(at);
    tangent -= normal * dot(normal, tangent);
    let squared = dot(tangent, tangent);
    if (!(squared > 1e-30)) {
        return normal;
    }
    tangent *= inverseSqrt(squared);
    let bitangent = cross(normal, tangent) * attributes[at + 3u];
    let bent = 2.0 * textured(map, point.uv).rgb - 1.0;
    let scale = tables[m + NORMAL_SCALE];
    let sum = tangent * (bent.x * scale) + bitangent * (bent.y * scale) + normal * bent.z;
    let length = dot(sum, sum);
    if (length > 1e-30 && dot(sum, point.geometric) > 0.0) {
        return sum * inverseSqrt(length);
    }
    return normal;
}

// The shading normal that is nearest among those that face the seen side of a surface.
fn facing(normal: vec3f, geometric: vec3f, view: vec3f) -> vec3f {
    let seen = dot(view, geometric);
    let promised = dot(view, normal);
    if (seen * promised > 0.0 || seen == 0.0) {
        return normal;
    }
    let lifted = normal + view * (select(-1e-3, 1e-3, seen >= 0.0) - promised);
    let squared = dot(lifted, lifted);
    if (squared > 1e-30) {
        return lifted * inverseSqrt(squared);
    }
    return geometric;
}

// Value of a medium's table at a surface albedo.
fn of_albedo(table: u32, albedo: f32) -> f32 {
    let place = clamp(albedo, 0.0, 1.0) * ALBEDOS;
    let cell = min(u32(place), u32(ALBEDOS) - 1u);
    return mix(tables[table + cell], tables[table + cell + 1u], place - f32(cell));
}

struct Below {
    surface_albedo: vec3f,
    // Mean free paths; 0 in channels whose light leaves too near its entry for positions to resolve.
    length: vec3f,
}

// The medium below a point.
fn below_at(point: Point) -> Below {
    let m = material_at(point.material);
    var below: Below;
    below.surface_albedo = unit_color_at(m + SUBSURFACE_COLOR, point);
    if (!(tables[m + HAS_WALK] > 0.0)) {
        return below;
    }
    let stated = max(color_at(m + SUBSURFACE_RADIUS_SCALE, point), vec3f(0.0)) * max(scalar_at(m + SUBSURFACE_RADIUS, point), 0.0);
    let table = head(MEDIA) + u32(tables[m + MEDIUM]) + u32(ALBEDOS) + 1u;
    let albedo = below.surface_albedo;
    let of_one = vec3f(of_albedo(table, albedo.x), of_albedo(table, albedo.y), of_albedo(table, albedo.z));
    let length = stated * of_one;
    below.length = select(vec3f(0.0), length, length > vec3f(LEAST_OFFSETS_OF_MFP * point.offset));
    return below;
}

// Single-scattering albedos of the medium of a material.
fn single_scattering_albedo(material: u32, albedo: vec3f) -> vec3f {
    let table = head(MEDIA) + u32(tables[material_at(material) + MEDIUM]);
    let root = vec3f(of_albedo(table, albedo.x), of_albedo(table, albedo.y), of_albedo(table, albedo.z));
    return 1.0 - root * root;
}

// Absorption coefficient of the clear medium that a direction across a surface leads into from one of coefficient `before`.
fn absorption_behind(point: Point, direction: vec3f, before: vec3f) -> vec3f {
    let m = material_at(point.material);
    if (tables[m + THIN_WALLED] > 0.0) {
        return before;
    }
    if (dot(direction, point.geometric) < 0.0) {
        return table_color(m + ABSORPTION);
    }
    return vec3f(0.0);
}
