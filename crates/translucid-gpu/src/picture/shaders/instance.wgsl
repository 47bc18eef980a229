// Instances: places of meshes that objects share. The triangles and the tree of such a mesh are there once, in its own space.
//
// The triangles of an instance have numbers of their own, which come after those of the triangles in the world: its first
// number, and how far a triangle is behind the first of the mesh.

// Rows of an instance; those of all stand before the nodes. Three are the columns of the map into the mesh's space, the next is
// its origin in the world, three are the columns of the map back.
const FROM_WORLD = 0u;
const ORIGIN = 3u;
const TO_WORLD = 4u;
// The fourth words of the rows.
const FIRST_NUMBER = 0u;
const FIRST_TRIANGLE = 1u;
const MESH_ROOT = 2u;
const INSTANCE_MATERIAL = 3u;
const INSTANCE_GROUP = 4u;
// Factor on the rounding errors of coordinates as far from the origin.
const AMPLIFICATION = 5u;
// -1 where it mirrors the mesh: counter-clockwise is clockwise there.
const HANDEDNESS = 6u;

const NO_INSTANCE = 0xffffffffu;

fn instance_word(instance: u32, row: u32) -> u32 {
    return nodes[INSTANCE_ROWS * instance + row].w;
}

fn instance_number(instance: u32, row: u32) -> f32 {
    return bitcast<f32>(instance_word(instance, row));
}

fn instance_vector(instance: u32, row: u32) -> vec3f {
    return bitcast<vec3f>(nodes[INSTANCE_ROWS * instance + row].xyz);
}

fn instance_map(instance: u32, row: u32) -> mat3x3f {
    return mat3x3f(instance_vector(instance, row), instance_vector(instance, row + 1u), instance_vector(instance, row + 2u));
}

// A triangle in its place.
struct Triangle {
    a: vec3f,
    // Where its words are.
    stored: u32,
    b: vec3f,
    instance: u32,
    c: vec3f,
}

fn triangle_at(number: u32) -> Triangle {
    var stored = number;
    var instance = NO_INSTANCE;
    let count = head(INSTANCES);
    if (count > 0u && number >= instance_word(0u, FIRST_NUMBER)) {
        instance = 0u;
        var end = count;
        while (end - instance > 1u) {
            let middle = instance + (end - instance) / 2u;
            if (instance_word(middle, FIRST_NUMBER) <= number) {
                instance = middle;
            } else {
                end = middle;
            }
        }
        stored = number - instance_word(instance, FIRST_NUMBER) + instance_word(instance, FIRST_TRIANGLE);
    }
    let a = bitcast<vec3f>(triangles[3u * stored].xyz);
    let b = bitcast<vec3f>(triangles[3u * stored + 1u].xyz);
    let c = bitcast<vec3f>(triangles[3u * stored + 2u].xyz);
    if (instance == NO_INSTANCE) {
        return Triangle(a, stored, b, instance, c);
    }
    let to_world = instance_map(instance, TO_WORLD);
    let origin = instance_vector(instance, ORIGIN);
    return Triangle(to_world * a + origin, stored, to_world * b + origin, instance, to_world * c + origin);
}

// Unit normal on the outside of the mesh.
fn geometric_normal(triangle: Triangle) -> vec3f {
    var normal = cross(triangle.b - triangle.a, triangle.c - triangle.a);
    if (triangle.instance != NO_INSTANCE) {
        normal *= instance_number(triangle.instance, HANDEDNESS);
    }
    return unit_or(normal, vec3f(0.0, 0.0, 1.0));
}

// A normal of a mesh in the world.
fn placed_normal(normal: vec3f, instance: u32) -> vec3f {
    if (instance == NO_INSTANCE) {
        return normal;
    }
    return unit_or(normal * instance_map(instance, FROM_WORLD), normal);
}

// A tangent of a mesh in the world.
fn placed_tangent(tangent: vec3f, instance: u32) -> vec3f {
    if (instance == NO_INSTANCE) {
        return tangent;
    }
    return unit_or(instance_map(instance, TO_WORLD) * tangent, tangent);
}
