// A triangle that emits on the side from which its corners are seen counter-clockwise, drawn uniformly in area. Words: corners,
// mean radiance, and where its emission varies its number among the scene's triangles, else −1.

fn triangle_light_at(triangle: u32) -> u32 {
    return lights_at + light_number(9u) + triangle * LIGHT_TRIANGLE_WORDS;
}

fn triangle_light_importance(triangle: u32, receiver: Receiver) -> f32 {
    let at = triangle_light_at(triangle);
    let luminance = luminance(table_vector(at + 9u));
    return triangle_importance(table_vector(at), table_vector(at + 3u), table_vector(at + 6u), luminance, receiver);
}

fn triangle_light_elevation(at: u32, point: vec3f) -> f32 {
    let a = table_vector(at);
    return dot(point - a, cross(table_vector(at + 3u) - a, table_vector(at + 6u) - a));
}

fn triangle_light_surface(triangle: u32) -> f32 {
    return tables[triangle_light_at(triangle) + 12u];
}

fn triangle_light_sample(triangle: u32, point: vec3f, u: vec2f) -> LightSample {
    let at = triangle_light_at(triangle);
    let a = table_vector(at);
    let b = uniform_triangle(u);
    // From the corner a, so that far from the origin the offsets keep their digits
    let offset = (a - point) + (table_vector(at + 3u) - a) * b.x + (table_vector(at + 6u) - a) * b.y;
    let distance = length(offset);
    let pdf = triangle_light_pdf(triangle, point, offset);
    if (distance <= 0.0 || pdf <= 0.0) {
        return no_light_sample();
    }
    var sample = light_sample_toward(offset / distance, distance, table_vector(at + 9u), pdf);
    sample.triangle = triangle;
    return sample;
}

// Solid-angle density at a place of this offset: distance² / (area × cosine); 0 from behind.
//
// The height of the point above the triangle is taken from a corner: from a place found by a ray it would have few digits at a
// slant.
fn triangle_light_pdf(triangle: u32, point: vec3f, offset: vec3f) -> f32 {
    let at = triangle_light_at(triangle);
    let elevation = triangle_light_elevation(at, point);
    if (elevation <= 0.0) {
        return 0.0;
    }
    let distance_squared = dot(offset, offset);
    return 2.0 * distance_squared * (sqrt(distance_squared) / elevation);
}
