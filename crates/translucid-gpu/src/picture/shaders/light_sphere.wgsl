// Spherical light, drawn uniformly in the cone that it fills; and the spot with a radius, each of whose points shines into the
// spot's cone. Words: center, radius, whether it has a cone, and the cone.

// Cosine up to which a place behind the horizon counts as seen, for rounding.
const SPHERE_HORIZON = 1e-3f;
// Room for the rounding of cosines.
const COSINE_ROUNDING = 1e-6f;

fn sphere_has_cone(at: u32) -> bool {
    return tables[at + 9u] != 0.0;
}

// Radiance that it sends in a unit direction.
fn sphere_light_radiance(at: u32, direction: vec3f) -> vec3f {
    let radiance = light_radiance(at);
    if (!sphere_has_cone(at)) {
        return radiance;
    }
    let cone = light_cone(at);
    return radiance * cone_falloff(cone, dot(direction, cone.axis));
}

// Squared sine of the half-angle that the sphere subtends; 0 from inside.
fn sphere_sin_squared(at: u32, point: vec3f) -> f32 {
    let distance = length(light_vector(at + 5u) - point);
    let radius = tables[at + 8u];
    if (distance <= radius) {
        return 0.0;
    }
    let sine = radius / distance;
    return select(0.0, sine * sine, sine * sine < 1.0);
}

fn sphere_light_importance(at: u32, point: vec3f, normal: vec3f) -> f32 {
    let to_center = light_vector(at + 5u) - point;
    let distance = length(to_center);
    let radius = tables[at + 8u];
    if (distance <= radius) {
        return 0.0;
    }
    let sine = radius / distance;
    var cosine = 1.0;
    if (has_normal(normal)) {
        cosine = min((dot(normal, to_center) + radius) / distance, 1.0);
    }
    if (cosine <= 0.0) {
        return 0.0;
    }
    var falloff = 1.0;
    if (sphere_has_cone(at)) {
        // The brightest direction within the angle that the sphere subtends
        let cone = light_cone(at);
        let axis_cosine = clamp(-dot(to_center, cone.axis) / distance, -1.0, 1.0);
        let rim_cosine = sqrt(max((1.0 - sine) * (1.0 + sine), 0.0));
        var best = 1.0;
        if (axis_cosine < rim_cosine) {
            best = axis_cosine * rim_cosine + sqrt((1.0 - axis_cosine) * (1.0 + axis_cosine)) * sine;
        }
        falloff = cone_falloff(cone, best + COSINE_ROUNDING);
    }
    if (falloff <= 0.0) {
        return 0.0;
    }
    let luminance = light_luminance(light_radiance(at));
    return max(PI * luminance * sine * sine * cosine * falloff, LEAST_IMPORTANCE);
}

fn sphere_light_sample(at: u32, point: vec3f, u: vec2f) -> LightSample {
    let sin_squared = sphere_sin_squared(at, point);
    if (sin_squared <= 0.0) {
        return no_light_sample();
    }
    let to_center = light_vector(at + 5u) - point;
    var axis = normalize(to_center);
    var width = one_minus_cos(sin_squared);
    var is_of_cone = false;
    if (sphere_has_cone(at)) {
        let cone = light_cone(at);
        if (cone_one_minus_cos(cone) < width) {
            axis = -cone.axis;
            width = cone_one_minus_cos(cone);
            is_of_cone = true;
        }
    }
    let direction = uniform_cone(axis, width, u);
    var distance = sphere_light_distance(at, point, direction);
    if (distance < 0.0) {
        if (is_of_cone) {
            return no_light_sample();
        }
        // At the rim rounding may let the ray miss: the foot of the perpendicular is then the nearest point
        distance = max(dot(to_center, direction), 0.0);
    }
    return light_sample_toward(direction, distance, sphere_light_radiance(at, -direction), uniform_cone_pdf(width));
}

fn sphere_light_pdf(at: u32, point: vec3f, place: vec3f) -> f32 {
    let outward = place - light_vector(at + 5u);
    let toward = point - place;
    let distance = length(toward);
    let sin_squared = sphere_sin_squared(at, point);
    if (sin_squared <= 0.0 || dot(outward, toward) < -SPHERE_HORIZON * tables[at + 8u] * distance) {
        return 0.0;
    }
    let width = one_minus_cos(sin_squared);
    if (sphere_has_cone(at)) {
        let cone = light_cone(at);
        if (cone_one_minus_cos(cone) < width) {
            let is_within = dot(toward, cone.axis) >= cone.cos_outer * distance;
            return select(0.0, uniform_cone_pdf(cone_one_minus_cos(cone)), is_within);
        }
    }
    return uniform_cone_pdf(width);
}

// Distance at which a ray from outside meets the sphere; below 0 if it misses it. By the perpendicular: b² − c would cancel for
// spheres that are far away [Haines, Günther & Akenine-Möller 2019, "Precision Improvements for Ray/Sphere Intersection"].
fn sphere_light_distance(at: u32, origin: vec3f, direction: vec3f) -> f32 {
    let to_center = light_vector(at + 5u) - origin;
    let radius = tables[at + 8u];
    let along = dot(to_center, direction);
    let across = to_center - direction * along;
    let half_chord_squared = radius * radius - dot(across, across);
    if (along <= 0.0 || half_chord_squared < 0.0 || dot(to_center, to_center) <= radius * radius) {
        return -1.0;
    }
    return max(along - sqrt(half_chord_squared), 0.0);
}
