// What a ray meets: a binary tree over triangles and instances, each with a tree below it, and the watertight intersection
// of triangles
// [S. Woop, C. Benthin, I. Wald 2013, Watertight Ray/Triangle Intersection, JCGT 2(1)].

struct Hit {
    t: f32,
    // Barycentric coordinates of corners 1 and 2.
    b: vec2f,
    triangle: u32,
    is_hit: bool,
}

// A ray whose direction is turned into (0, 0, 1) by a permutation of axes and a shear.
struct Sheared {
    origin: vec3f,
    axis: u32,
    factors: vec3f,
}

// A place along a ray: what two triangles have in common is first in that of the lower number.
struct Along {
    t: f32,
    triangle: u32,
}

// Number of triangles of a node that stands for an instance.
const AN_INSTANCE = 0xffffffffu;
const EVERY_GROUP = 0u;
const ONE_GROUP = 1u;

fn permuted(v: vec3f, axis: u32) -> vec3f {
    return select(select(v.xyz, v.zxy, axis == 1u), v.yzx, axis == 0u);
}

fn sheared(origin: vec3f, direction: vec3f) -> Sheared {
    let size = abs(direction);
    let is_x = size.x > size.y && size.x > size.z;
    let axis = select(select(2u, 1u, size.y > size.z), 0u, is_x);
    let turned = permuted(direction, axis);
    let scale = 1.0 / turned.z;
    return Sheared(permuted(origin, axis), axis, vec3f(turned.x * scale, turned.y * scale, scale));
}

// Distance to a triangle and its barycentric coordinates; the distance is NEVER where it is missed.
fn intersected(triangle: u32, ray: Sheared, t_max: f32) -> vec3f {
    let at = 3u * triangle;
    let a = corner_of(ray, triangles[at].xyz);
    let b = corner_of(ray, triangles[at + 1u].xyz);
    let c = corner_of(ray, triangles[at + 2u].xyz);
    let u = c.x * b.y - c.y * b.x;
    let v = a.x * c.y - a.y * c.x;
    let w = b.x * a.y - b.y * a.x;
    let least = min(u, min(v, w));
    let most = max(u, max(v, w));
    if (least < 0.0 && most > 0.0) {
        return vec3f(NEVER, 0.0, 0.0);
    }
    let determinant = u + v + w;
    if (determinant == 0.0) {
        return vec3f(NEVER, 0.0, 0.0);
    }
    let inverse = 1.0 / determinant;
    let t = (u * a.z + v * b.z + w * c.z) * inverse;
    if (!(t > 0.0 && t <= t_max)) {
        return vec3f(NEVER, 0.0, 0.0);
    }
    return vec3f(t, v * inverse, w * inverse);
}

fn corner_of(ray: Sheared, words: vec3u) -> vec3f {
    let local = permuted(bitcast<vec3f>(words), ray.axis) - ray.origin;
    return vec3f(local.xy - ray.factors.xy * local.z, ray.factors.z * local.z);
}

// Distance at which a ray enters a box, NEVER where it does not before `t_max`.
fn entered(node: u32, origin: vec3f, inverse: vec3f, t_max: f32) -> f32 {
    let low = (bitcast<vec3f>(nodes[2u * node].xyz) - origin) * inverse;
    let high = (bitcast<vec3f>(nodes[2u * node + 1u].xyz) - origin) * inverse;
    let near = min(low, high);
    let far = max(low, high);
    let begin = max(max(near.x, near.y), max(near.z, 0.0));
    // Rounding must not lose a box: 3 errors of 2^-24 each way [T. Ize 2013, Robust BVH Ray Traversal, JCGT 2(2)]
    let end = min(min(far.x, far.y), min(far.z, t_max)) * 1.0000008;
    return select(NEVER, begin, begin <= end);
}

fn inverse_of(direction: vec3f) -> vec3f {
    // Keeps 0 times infinity out of the test of boxes
    let is_flat = abs(direction) < vec3f(1e-18);
    let signs = select(vec3f(-1.0), vec3f(1.0), direction >= vec3f(0.0));
    return select(1.0 / direction, signs * 1e18, is_flat);
}

// The nearest surface of all groups, or of one, behind a place. With `any` the first that is found will do.
//
// Where it meets an instance the ray goes on in the mesh's space, until no node is left of what the instance has put onto the
// stack. It is not of unit length there: distances along it stay those in the world. Changes of space have a loop of their own
// around that over nodes, so that scenes without instances do nothing for them.
fn closest(origin: vec3f, direction: vec3f, after: Along, t_max: f32, groups: u32, group: u32, any: bool) -> Hit {
    var best = Hit(t_max, vec2f(0.0), 0u, false);
    if (arrayLength(&nodes) < 2u || settings.slots == 0u) {
        return best;
    }
    var stack: array<u32, STACK>;
    var distances: array<f32, STACK>;
    var depth = 0u;
    var node = head(INSTANCES) * (INSTANCE_ROWS / 2u);
    if (entered(node, origin, inverse_of(direction), best.t) >= NEVER) {
        return best;
    }
    // The instance in whose space the ray is, and the depth of the stack at which it leaves that
    var instance = NO_INSTANCE;
    var end = 0u;
    var is_done = false;
    loop {
        var start = origin;
        var along = direction;
        // Numbers of triangles are by so much beyond their places
        var beyond = 0u;
        if (instance != NO_INSTANCE) {
            let from_world = instance_map(instance, FROM_WORLD);
            start = from_world * (origin - instance_vector(instance, ORIGIN));
            along = from_world * direction;
            beyond = instance_word(instance, FIRST_NUMBER) - instance_word(instance, FIRST_TRIANGLE);
        }
        let inverse = inverse_of(along);
        let ray = sheared(start, along);
        let is_choosy = groups == ONE_GROUP && instance == NO_INSTANCE;
        var met = NO_INSTANCE;
        loop {
            if (is_done) {
                // Boxes that begin behind what was found meanwhile are passed over
                var is_open = false;
                while (depth > end && !is_open) {
                    depth -= 1u;
                    node = stack[depth];
                    is_open = distances[depth] <= best.t;
                }
                if (!is_open) {
                    break;
                }
            }
            let count = nodes[2u * node].w;
            let first = nodes[2u * node + 1u].w;
            is_done = count != 0u;
            if (count == AN_INSTANCE) {
                met = first;
                break;
            }
            if (is_done) {
                for (var k = 0u; k < count; k += 1u) {
                    let stored = first + k;
                    if (is_choosy && triangles[3u * stored + 2u].w != group) {
                        continue;
                    }
                    let found = intersected(stored, ray, best.t);
                    let triangle = stored + beyond;
                    // Those at the same distance come by their numbers
                    let is_nearer = found.x < best.t || (found.x < NEVER && (!best.is_hit || triangle < best.triangle));
                    let is_behind = found.x > after.t || (found.x == after.t && triangle > after.triangle);
                    if (is_nearer && is_behind) {
                        best = Hit(found.x, found.yz, triangle, true);
                        if (any) {
                            return best;
                        }
                    }
                }
            } else {
                let left = entered(first, start, inverse, best.t);
                let right = entered(first + 1u, start, inverse, best.t);
                let near = min(left, right);
                let far = max(left, right);
                is_done = near >= NEVER;
                if (!is_done) {
                    let is_left_near = left <= right;
                    node = select(first + 1u, first, is_left_near);
                    if (far < NEVER && depth < STACK) {
                        stack[depth] = select(first, first + 1u, is_left_near);
                        distances[depth] = far;
                        depth += 1u;
                    }
                }
            }
        }
        if (met != NO_INSTANCE && (groups == EVERY_GROUP || instance_word(met, INSTANCE_GROUP) == group)) {
            instance = met;
            end = depth;
            node = instance_word(met, MESH_ROOT);
            is_done = false;
        } else if (met != NO_INSTANCE || instance != NO_INSTANCE) {
            instance = NO_INSTANCE;
            end = 0u;
            is_done = true;
        } else {
            break;
        }
    }
    return best;
}
