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
    // Where the triangle's words are, and the instance that it is of.
    stored: u32,
    instance: u32,
}

const ROUNDING = 1.9073486e-6; // 16 units in the last place of 1

fn attribute_color(place: u32) -> vec3f {
    return vec3f(attributes[place], attributes[place + 1u], attributes[place + 2u]);
}

fn point_at(number: u32, b: vec2f) -> Point {
    let triangle = triangle_at(number);
    let a = triangle.a;
    let q = triangle.b;
    let r = triangle.c;
    let stored = triangle.stored;
    let instance = triangle.instance;
    let weights = vec3f(1.0 - b.x - b.y, b.x, b.y);
    let size = max(max(abs(a), abs(q)), abs(r));
    var point: Point;
    point.position = a * weights.x + q * weights.y + r * weights.z;
    point.geometric = geometric_normal(triangle);
    point.offset = max(size.x, max(size.y, size.z)) * ROUNDING;
    point.material = triangles[3u * stored].w;
    point.light = triangles[3u * stored + 1u].w;
    point.group = triangles[3u * stored + 2u].w;
    if (instance != NO_INSTANCE) {
        // Rays are less exact there
        let off = abs(point.position - instance_vector(instance, ORIGIN)) * instance_number(instance, AMPLIFICATION);
        point.offset = max(point.offset, max(off.x, max(off.y, off.z)) * ROUNDING);
        point.material = instance_word(instance, INSTANCE_MATERIAL);
        point.group = instance_word(instance, INSTANCE_GROUP);
    }
    point.stored = stored;
    point.instance = instance;
    let at = stored * head(ATTRIBUTE_WORDS);
    let normal = placed_normal(attribute_color(at), instance) * weights.x
        + placed_normal(attribute_color(at + 3u), instance) * weights.y
        + placed_normal(attribute_color(at + 6u), instance) * weights.z;
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
