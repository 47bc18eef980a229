// A point of a surface with its attributes.

struct Point {
    position: vec3f,
    // Unit normals on the outside of the mesh; the shading normal is within 90 degrees of the geometric one.
    geometric: vec3f,
    shading: vec3f,
    color: vec3f,
    uv: vec2f,
    // Distance by which a ray's origin has to leave the surface to clear rounding errors.
    offset: f32,
    material: u32,
    light: u32,
    group: u32,
    triangle: u32,
}

const ROUNDING = 1.9073486e-6; // 16 units in the last place of 1

fn corner(triangle: u32, number: u32) -> vec3f {
    return bitcast<vec3f>(triangles[3u * triangle + number].xyz);
}

fn geometric_normal(triangle: u32) -> vec3f {
    let a = corner(triangle, 0u);
    let normal = cross(corner(triangle, 1u) - a, corner(triangle, 2u) - a);
    // Scaled first: squares of small areas vanish
    let size = max(abs(normal.x), max(abs(normal.y), abs(normal.z)));
    if (!(size > 0.0)) {
        return vec3f(0.0, 0.0, 1.0);
    }
    return normalize(normal / size);
}

fn material_of(triangle: u32) -> u32 {
    return triangles[3u * triangle].w;
}

fn group_of(triangle: u32) -> u32 {
    return triangles[3u * triangle + 2u].w;
}

fn attribute_color(place: u32) -> vec3f {
    return vec3f(attributes[place], attributes[place + 1u], attributes[place + 2u]);
}

fn point_at(triangle: u32, b: vec2f) -> Point {
    let a = corner(triangle, 0u);
    let q = corner(triangle, 1u);
    let r = corner(triangle, 2u);
    let weights = vec3f(1.0 - b.x - b.y, b.x, b.y);
    let size = max(max(abs(a), abs(q)), abs(r));
    var point: Point;
    point.position = a * weights.x + q * weights.y + r * weights.z;
    point.geometric = geometric_normal(triangle);
    point.offset = max(size.x, max(size.y, size.z)) * ROUNDING;
    point.material = triangles[3u * triangle].w;
    point.light = triangles[3u * triangle + 1u].w;
    point.group = triangles[3u * triangle + 2u].w;
    point.triangle = triangle;
    let at = triangle * head(ATTRIBUTE_WORDS);
    let normal = attribute_color(at) * weights.x + attribute_color(at + 3u) * weights.y + attribute_color(at + 6u) * weights.z;
    let squared = dot(normal, normal);
    let shading = normal * inverseSqrt(max(squared, 1e-30));
    // One from the other side (broken input) would turn the surface inside out
    point.shading = select(point.geometric, shading, squared > 1e-30 && dot(shading, point.geometric) > 0.0);
    let uv = head(UV);
    if (uv > 0u) {
        let first = at + uv;
        point.uv = vec2f(attributes[first], attributes[first + 1u]) * weights.x
            + vec2f(attributes[first + 2u], attributes[first + 3u]) * weights.y
            + vec2f(attributes[first + 4u], attributes[first + 5u]) * weights.z;
    }
    point.color = vec3f(1.0);
    let color = head(COLOR);
    if (color > 0u) {
        let first = at + color;
        point.color = attribute_color(first) * weights.x + attribute_color(first + 3u) * weights.y
            + attribute_color(first + 6u) * weights.z;
    }
    return point;
}
