// One-sided elliptical light, whose words are those of the rectangle around it.
//
// Where it looks large that rectangle is divided into strips of equal solid angle across its width, of which one is drawn as
// often as a disk has area in it, and in it a direction uniform in solid angle; else a place is drawn uniformly in area.

// Where the ellipse begins and ends at x.
fn ellipse_chord(seen: SeenRectangle, x: f32) -> vec2f {
    let at = (2.0 * x - seen.low.x - seen.high.x) / seen.size.x;
    let half_chord = 0.5 * seen.size.y * sqrt(max((1.0 - at) * (1.0 + at), 0.0));
    let middle = 0.5 * (seen.low.y + seen.high.y);
    return vec2f(middle - half_chord, middle + half_chord);
}

// Solid-angle density of the strip at x, given the solid angles on its two sides.
fn ellipse_strip_pdf(seen: SeenRectangle, x: f32, sides: vec2f) -> f32 {
    let whole = sides.x + sides.y;
    // A disk's density over its width
    let density = 8.0 / PI * sqrt(max(sides.x * sides.y, 0.0)) / whole;
    let of_strip = line_sines(seen, x, vec2f(seen.low.y, seen.high.y));
    let of_chord = line_sines(seen, x, ellipse_chord(seen, x));
    let height = of_chord.y - of_chord.x;
    if (height <= 0.0) {
        return 0.0;
    }
    return density * (of_strip.y - of_strip.x) / (height * whole);
}

fn ellipse_light_sample(at: u32, point: vec3f, u: vec2f) -> LightSample {
    let seen = seen_rectangle(at, point);
    if (seen.z >= 0.0) {
        return no_light_sample();
    }
    let place = concentric_disk(u);
    let solid_angle = sampled_solid_angle(seen);
    if (solid_angle > 0.0) {
        let sides = 0.5 * (1.0 + vec2f(place.x, -place.x));
        let x = rectangle_x_at(seen, solid_angle, sides.x);
        let chord = sqrt(max((1.0 - place.x) * (1.0 + place.x), 1e-12));
        let y = rectangle_y_at(seen, x, ellipse_chord(seen, x), clamp(0.5 * (place.y / chord + 1.0), 0.0, 1.0));
        return plane_light_sample(at, seen, vec2f(x, y), ellipse_strip_pdf(seen, x, sides * solid_angle));
    }
    let offset = 0.5 * (seen.low + seen.high + place * seen.size);
    return plane_light_sample(at, seen, offset, area_light_pdf(seen, offset, 0.25 * PI * seen.size.x * seen.size.y));
}

fn ellipse_light_pdf(at: u32, point: vec3f, place: vec3f) -> f32 {
    let seen = seen_rectangle(at, point);
    if (seen.z >= 0.0) {
        return 0.0;
    }
    let offset = plane_offset(at, point, place);
    if (sampled_solid_angle(seen) > 0.0) {
        let x = clamp(offset.x, seen.low.x, seen.high.x);
        let left = SeenRectangle(seen.low, vec2f(x, seen.high.y), vec2f(x - seen.low.x, seen.size.y), seen.z);
        let right = SeenRectangle(vec2f(x, seen.low.y), seen.high, vec2f(seen.high.x - x, seen.size.y), seen.z);
        return ellipse_strip_pdf(seen, x, vec2f(rectangle_solid_angle(left), rectangle_solid_angle(right)));
    }
    return area_light_pdf(seen, offset, 0.25 * PI * seen.size.x * seen.size.y);
}

fn ellipse_light_distance(at: u32, origin: vec3f, direction: vec3f) -> f32 {
    let t = rectangle_light_distance(at, origin, direction);
    if (t < 0.0) {
        return t;
    }
    let on_plane = direction * t - (table_vector(at + 5u) - origin);
    let place = 2.0 * rectangle_place(at, on_plane) / vec2f(tables[at + 17u], tables[at + 18u]) - 1.0;
    return select(-1.0, t, dot(place, place) <= 1.0);
}
