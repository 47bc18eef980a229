// The distance from a point to the nearest triangle of a subsurface group, in the tree that rays go through. Groups whose
// distances are asked for have no instances.

// The distance, or `most` where that is less.
fn distance_to_group(point: vec3f, group: u32, most: f32) -> f32 {
    var least = most * most;
    var stack: array<u32, STACK>;
    var distances: array<f32, STACK>;
    var waiting = 0u;
    var node = head(INSTANCES) * (INSTANCE_ROWS / 2u);
    var is_done = squared_distance_to_box(node, point) >= least;
    loop {
        if (is_done) {
            // Boxes that are no nearer than what was found meanwhile are passed over
            var is_open = false;
            while (waiting > 0u && !is_open) {
                waiting -= 1u;
                node = stack[waiting];
                is_open = distances[waiting] < least;
            }
            if (!is_open) {
                break;
            }
        }
        let count = nodes[2u * node].w;
        let first = nodes[2u * node + 1u].w;
        is_done = count != 0u;
        if (is_done) {
            for (var k = 0u; k < count && count != AN_INSTANCE; k += 1u) {
                let at = 3u * (first + k);
                if (triangles[at + 2u].w == group) {
                    let a = bitcast<vec3f>(triangles[at].xyz) - point;
                    let b = bitcast<vec3f>(triangles[at + 1u].xyz) - point;
                    let c = bitcast<vec3f>(triangles[at + 2u].xyz) - point;
                    least = min(least, squared_distance_to_triangle(a, b, c));
                }
            }
        } else {
            let left = squared_distance_to_box(first, point);
            let right = squared_distance_to_box(first + 1u, point);
            let is_left_near = left <= right;
            let far = max(left, right);
            is_done = min(left, right) >= least;
            if (!is_done) {
                node = select(first + 1u, first, is_left_near);
                if (far < least && waiting < STACK) {
                    stack[waiting] = select(first, first + 1u, is_left_near);
                    distances[waiting] = far;
                    waiting += 1u;
                }
            }
        }
    }
    return min(sqrt(least), most);
}

fn squared_distance_to_box(node: u32, point: vec3f) -> f32 {
    let below = bitcast<vec3f>(nodes[2u * node].xyz) - point;
    let above = point - bitcast<vec3f>(nodes[2u * node + 1u].xyz);
    let off = max(max(below, above), vec3f(0.0));
    return dot(off, off);
}

// The squared distance from the origin to a triangle, NEVER where it has no area.
//
// It is that of a point of the triangle, whose errors along the triangle hardly count.
fn squared_distance_to_triangle(a: vec3f, b: vec3f, c: vec3f) -> f32 {
    let normal = cross(b - a, c - a);
    // Scaled: products of large areas overflow
    let size = max(abs(normal.x), max(abs(normal.y), abs(normal.z)));
    if (!(size > 0.0)) {
        return NEVER;
    }
    let axis = normal / size;
    let weights = vec3f(dot(axis, cross(b, c)), dot(axis, cross(c, a)), dot(axis, cross(a, b)));
    let all = weights.x + weights.y + weights.z;
    if (min(weights.x, min(weights.y, weights.z)) >= 0.0 && all > 0.0) {
        let nearest = (a * weights.x + b * weights.y + c * weights.z) / all;
        return dot(nearest, nearest);
    }
    return min(squared_distance_to_edge(a, b), min(squared_distance_to_edge(b, c), squared_distance_to_edge(c, a)));
}

fn squared_distance_to_edge(start: vec3f, end: vec3f) -> f32 {
    let edge = end - start;
    let along = clamp(-dot(start, edge) / max(dot(edge, edge), 1e-30), 0.0, 1.0);
    let nearest = start + edge * along;
    return dot(nearest, nearest);
}
