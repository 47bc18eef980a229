// One-sided rectangular light.
//
// Where it looks large a direction is drawn uniformly in solid angle [C. Ureña, M. Fajardo & A. King 2013, "An
// Area-Preserving Parametrization for Spherical Rectangles", Computer Graphics Forum 32(4)], else a place uniformly in area.
// The processor does the former in double precision. Here sines and differences of squares that would cancel have forms of
// their own, and the solid angle, which is the density, is exact relative to itself by another formula; so a direction is
// wrong by some 1e-7.

// Rectangles that look smaller [sr] are drawn from uniformly in area.
const LEAST_SOLID_ANGLE = 0.01f;

// A rectangle as it is seen from a point, in its own frame.
struct SeenRectangle {
    low: vec2f,
    high: vec2f,
    // From afar the difference of the two above has few digits.
    size: vec2f,
    // Height of its plane: below 0 where it shines on the point.
    z: f32,
}

// Words: corner, unit vectors along the edges, normal, size.
fn seen_rectangle(at: u32, point: vec3f) -> SeenRectangle {
    let offset = table_vector(at + 5u) - point;
    let corner = vec2f(dot(offset, table_vector(at + 8u)), dot(offset, table_vector(at + 11u)));
    let size = vec2f(tables[at + 17u], tables[at + 18u]);
    return SeenRectangle(corner, corner + size, size, dot(offset, table_vector(at + 14u)));
}

// Estimate of the irradiance: solid angle, seen from afar A cos/d², from near up to 2π, times the height of the highest corner
// above the horizon over the distance of the middle, at most 1.
fn rectangle_light_importance(at: u32, receiver: Receiver) -> f32 {
    let normal = receiver.normal;
    let seen = seen_rectangle(at, receiver.point);
    if (seen.z >= 0.0) {
        return 0.0;
    }
    let middle = length(vec3f(0.5 * (seen.low + seen.high), seen.z));
    var cosine = 1.0;
    if (receiver_has_normal(receiver)) {
        let rise = max(vec2f(dot(normal, table_vector(at + 8u)), dot(normal, table_vector(at + 11u))) * seen.size, vec2f(0.0));
        let highest = dot(normal, table_vector(at + 5u) - receiver.point) + rise.x + rise.y;
        cosine = min(highest / middle, 1.0);
    }
    if (cosine <= 0.0) {
        return 0.0;
    }
    // In units of the distance cubes neither overflow nor vanish
    let nearest = nearest_offset(seen) / middle;
    let z = seen.z / middle;
    let flux = (seen.size.x / middle) * (seen.size.y / middle) * -z;
    let solid_angle = flux / (dot(nearest, nearest) + z * z + flux * (0.5 / PI));
    return max(luminance(light_radiance(at)) * solid_angle * cosine, LEAST_IMPORTANCE);
}

// Offset within the plane from the foot of the point to the rectangle.
fn nearest_offset(seen: SeenRectangle) -> vec2f {
    return max(max(seen.low, -seen.high), vec2f(0.0));
}

// Solid angle of the rectangle, relative to 1e-6. Its parts in the four quadrants about the foot of the point are added:
// within a quadrant nothing cancels.
fn rectangle_solid_angle(seen: SeenRectangle) -> f32 {
    var sum = 0.0;
    for (var quadrant = 0u; quadrant < 4u; quadrant++) {
        let is_mirrored = vec2((quadrant & 1u) != 0u, (quadrant & 2u) != 0u);
        let low = select(seen.low, -seen.high, is_mirrored);
        let high = select(seen.high, -seen.low, is_mirrored);
        let begin = max(low, vec2f(0.0));
        if (all(high > begin)) {
            let size = select(high - begin, seen.size, low >= vec2f(0.0));
            sum += quadrant_solid_angle(begin, high, size, -seen.z);
        }
    }
    return sum;
}

// The solid angle of two triangles [A. van Oosterom & J. Strackee 1983, "The Solid Angle of a Plane Triangle", IEEE Trans.
// Biomed. Eng. 30].
fn quadrant_solid_angle(low: vec2f, high: vec2f, size: vec2f, z: f32) -> f32 {
    let corners = vec4f(
        length(vec3f(low, z)),
        length(vec3f(high.x, low.y, z)),
        length(vec3f(high, z)),
        length(vec3f(low.x, high.y, z)),
    );
    let a = vec3f(low, z) / corners.x;
    let b = vec3f(high.x, low.y, z) / corners.y;
    let c = vec3f(high, z) / corners.z;
    let d = vec3f(low.x, high.y, z) / corners.w;
    let volume = (size.x / corners.x) * (size.y / corners.z) * z;
    let diagonal = 1.0 + dot(a, c);
    let first = turns_of(volume / corners.y, diagonal + dot(a, b) + dot(b, c));
    let second = turns_of(volume / corners.w, diagonal + dot(a, d) + dot(d, c));
    return 4.0 * PI * (first + second);
}

// The solid angle, or 0 where directions are drawn uniformly in area.
fn sampled_solid_angle(seen: SeenRectangle) -> f32 {
    let nearest = nearest_offset(seen);
    let distance_squared = dot(nearest, nearest) + seen.z * seen.z;
    let distance = sqrt(distance_squared);
    // Area × cosine / distance² at the nearest point is no less than the solid angle
    if ((seen.size.x / distance) * (seen.size.y / distance) * -seen.z <= LEAST_SOLID_ANGLE * distance) {
        return 0.0;
    }
    let solid_angle = rectangle_solid_angle(seen);
    return select(0.0, solid_angle, solid_angle >= LEAST_SOLID_ANGLE);
}

// Solid-angle density at an offset of the plane of what is uniform in an area.
fn area_light_pdf(seen: SeenRectangle, offset: vec2f, area: f32) -> f32 {
    let distance = length(vec3f(offset, seen.z));
    return (distance / -seen.z) * (distance * distance / area);
}

fn rectangle_light_sample(at: u32, point: vec3f, u: vec2f) -> LightSample {
    let seen = seen_rectangle(at, point);
    if (seen.z >= 0.0) {
        return no_light_sample();
    }
    let solid_angle = sampled_solid_angle(seen);
    if (solid_angle > 0.0) {
        let x = rectangle_x_at(seen, solid_angle, u.x);
        let y = rectangle_y_at(seen, x, vec2f(seen.low.y, seen.high.y), u.y);
        return plane_light_sample(at, seen, vec2f(x, y), 1.0 / solid_angle);
    }
    let offset = seen.low + u * seen.size;
    return plane_light_sample(at, seen, offset, area_light_pdf(seen, offset, seen.size.x * seen.size.y));
}

// The sample of a place on the plane.
fn plane_light_sample(at: u32, seen: SeenRectangle, offset: vec2f, pdf: f32) -> LightSample {
    let local = vec3f(offset, seen.z);
    let distance = length(local);
    let toward = local / distance;
    let x = table_vector(at + 8u);
    let y = table_vector(at + 11u);
    let direction = x * toward.x + y * toward.y + table_vector(at + 14u) * toward.z;
    return light_sample_toward(direction, distance, light_radiance(at), pdf);
}

fn rectangle_light_pdf(at: u32, point: vec3f, place: vec3f) -> f32 {
    let seen = seen_rectangle(at, point);
    if (seen.z >= 0.0) {
        return 0.0;
    }
    let solid_angle = sampled_solid_angle(seen);
    if (solid_angle > 0.0) {
        return 1.0 / solid_angle;
    }
    return area_light_pdf(seen, plane_offset(at, point, place), seen.size.x * seen.size.y);
}

fn plane_offset(at: u32, point: vec3f, place: vec3f) -> vec2f {
    let offset = place - point;
    return vec2f(dot(offset, table_vector(at + 8u)), dot(offset, table_vector(at + 11u)));
}

// The x up to which a share of the solid angle lies. Where the paper adds angles, numbers e^iγ are multiplied.
fn rectangle_x_at(seen: SeenRectangle, solid_angle: f32, share: f32) -> f32 {
    let z = -seen.z;
    let to_low = vec2f(length(vec2f(seen.low.x, z)), length(vec2f(seen.low.y, z)));
    let to_high_y = length(vec2f(seen.high.y, z));
    // z of the normals of the planes through the edges
    let n_low = seen.low / to_low;
    let b_low = -n_low.y;
    let b_high = seen.high.y / to_high_y;
    // e^iγ of the inner angles at the corners of the edge x0: the sines do not cancel
    let upper = vec2f(n_low.x * b_high, z / to_low.x * (length(vec3f(seen.low.x, seen.high.y, z)) / to_high_y));
    let lower = vec2f(n_low.x * b_low, z / to_low.x * (length(vec3f(seen.low, z)) / to_low.y));
    let angles = complex_times(upper, lower);
    let turned = complex_times(circle(share * solid_angle * (0.5 / PI)), vec2f(angles.x, -angles.y));
    // x = z/√(f² − (1 − b²)) with f = (cos b − b')/sin, times the sine above and below
    let f = turned.x * b_low - b_high;
    let sine = turned.y * z / to_low.y;
    let below = sqrt(max((f - sine) * (f + sine), 1e-30));
    let x = z * abs(turned.y) / below;
    return clamp(select(x, -x, f * turned.y < 0.0), seen.low.x, seen.high.x);
}

fn complex_times(a: vec2f, b: vec2f) -> vec2f {
    return vec2f(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x);
}

// Sines of the elevations of two points of the line at x.
fn line_sines(seen: SeenRectangle, x: f32, ends: vec2f) -> vec2f {
    let across = vec2f(x, seen.z);
    return ends / vec2f(length(vec3f(across, ends.x)), length(vec3f(across, ends.y)));
}

// The y of the line at x between two ends that lies at a share of the way in the sine of the elevation.
fn rectangle_y_at(seen: SeenRectangle, x: f32, ends: vec2f, share: f32) -> f32 {
    let sines = line_sines(seen, x, ends);
    let h = sines.x + share * (sines.y - sines.x);
    let y = h * length(vec2f(x, seen.z)) / sqrt(max((1.0 - h) * (1.0 + h), 1e-12));
    return clamp(y, ends.x, ends.y);
}

// Distance at which a ray meets the emitting side; below 0 if it misses it.
fn rectangle_light_distance(at: u32, origin: vec3f, direction: vec3f) -> f32 {
    let normal = table_vector(at + 14u);
    let approach = dot(direction, normal);
    if (approach >= 0.0) {
        return -1.0;
    }
    let to_corner = table_vector(at + 5u) - origin;
    let t = dot(to_corner, normal) / approach;
    if (!(t > 0.0 && t < INFINITE_DISTANCE)) {
        return -1.0;
    }
    let place = rectangle_place(at, direction * t - to_corner);
    let size = vec2f(tables[at + 17u], tables[at + 18u]);
    let is_inside = all(place >= vec2f(0.0)) && all(place <= size);
    return select(-1.0, t, is_inside);
}

fn rectangle_place(at: u32, from_corner: vec3f) -> vec2f {
    return vec2f(dot(from_corner, table_vector(at + 8u)), dot(from_corner, table_vector(at + 11u)));
}
