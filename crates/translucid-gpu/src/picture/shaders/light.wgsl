// The lights of a scene: a direction toward one of them from a point, and the density of drawing it.
//
// `light_sample` selects one light and draws a direction toward it. The query functions give the density with which it would
// have drawn a direction found otherwise. As in `translucid-render`'s `light/mod.rs`, light from infinity adds up: radiance
// and density of the environment and of the discs of distant lights are those of all of them together.
//
// `translucid-render`'s `device/lights.rs` documents the words. Those among `images` begin at the first, those among `tables`
// at `lights_at`, which the entry point sets.

var<private> lights_at: u32;

// The number of a triangle that is none.
const NO_TRIANGLE = 0xffffffffu;
// The distance of what is infinitely far, and of a ray without an end.
const INFINITE_DISTANCE = 1e30f;
// Where the words of a light's shape begin.
const LIGHT_SHAPE = 2u;
// A density up to which a sample counts.
const GREATEST_DENSITY = 1e37f;

struct LightSample {
    // Unit vector toward the light.
    direction: vec3f,
    // INFINITE_DISTANCE for lights at infinity.
    distance: f32,
    // Radiance from the direction; of a delta light the irradiance on a surface that faces it; of a triangle its mean.
    radiance: vec3f,
    // Solid-angle density, selection included; of a delta light the probability of its selection.
    pdf: f32,
    is_delta: bool,
    is_usable: bool,
    // Number of the emissive triangle, or NO_TRIANGLE.
    triangle: u32,
}

struct LightHit {
    t: f32,
    radiance: vec3f,
    light: u32,
    is_hit: bool,
    position: vec3f,
}

fn no_light_sample() -> LightSample {
    return LightSample(vec3f(0.0), 0.0, vec3f(0.0), 0.0, false, false, NO_TRIANGLE);
}

// A sample with the density toward the chosen light alone.
fn light_sample_toward(direction: vec3f, distance: f32, radiance: vec3f, pdf: f32) -> LightSample {
    return LightSample(direction, distance, radiance, pdf, false, true, NO_TRIANGLE);
}

// What a law has drawn.
fn light_sample_of(draw: LightDraw, is_delta: bool) -> LightSample {
    let is_usable = draw.pdf > 0.0 && draw.distance >= 0.0;
    return LightSample(draw.direction, draw.distance, draw.radiance, draw.pdf, is_delta, is_usable, NO_TRIANGLE);
}

fn light_number(place: u32) -> u32 {
    return u32(tables[lights_at + place]);
}

fn light_placed_count() -> u32 {
    return light_number(0u);
}

fn light_at(light: u32) -> u32 {
    return lights_at + LIGHT_HEADER + light * LIGHT_WORDS;
}

fn light_kind(at: u32) -> u32 {
    return u32(tables[at]);
}

fn light_radiance(at: u32) -> vec3f {
    return table_vector(at + 2u);
}

// Draws a direction toward a light, chosen by the first number. `normal` is the unit normal of the hemisphere from which light
// matters, or 0: all directions matter. All numbers are in [0, 1).
fn light_sample(point: vec3f, normal: vec3f, choice: f32, u: vec2f) -> LightSample {
    let odds = light_odds(point, normal);
    let chosen = light_choose(odds, light_word(choice, light_hash(choice, u)));
    if (chosen.probability <= 0.0) {
        return no_light_sample();
    }
    var sample: LightSample;
    if (chosen.light >= light_placed_count()) {
        sample = triangle_light_sample(chosen.light - light_placed_count(), point, u);
        sample.pdf *= chosen.probability;
    } else {
        let at = light_at(chosen.light);
        let shape = at + LIGHT_SHAPE;
        switch light_kind(at) {
            case LIGHT_SKY, LIGHT_MAP, LIGHT_DISC: {
                var direction = vec3f(0.0);
                if (light_kind(at) == LIGHT_DISC) {
                    direction = distant_light_direction_of_disc(distant_light_at(shape), u);
                } else {
                    direction = sky_direction(at, normal, u);
                }
                let pdf = infinite_light_pdf(odds, normal, direction);
                sample = light_sample_toward(direction, INFINITE_DISTANCE, environment_radiance(direction), pdf);
            }
            case LIGHT_RECTANGLE: {
                sample = rectangle_light_sample(at, point, u);
            }
            case LIGHT_ELLIPSE: {
                sample = ellipse_light_sample(at, point, u);
            }
            case LIGHT_SPHERE: {
                sample = light_sample_of(sphere_light_draw(sphere_light_at(shape), point, u), false);
            }
            case LIGHT_SPOT: {
                sample = light_sample_of(spot_light_draw(spot_light_at(shape), point), true);
            }
            case LIGHT_BEAM: {
                sample = light_sample_of(beam_light_draw(beam_light_at(shape), point), true);
            }
            default: {
                let light = distant_light_at(shape);
                sample = light_sample_of(LightDraw(light.direction, INFINITE_DISTANCE, light.irradiance, 1.0), true);
            }
        }
        if (sample.distance < INFINITE_DISTANCE || sample.is_delta) {
            sample.pdf *= chosen.probability;
        }
    }
    sample.is_usable = sample.is_usable && sample.pdf > 0.0 && sample.pdf < GREATEST_DENSITY;
    return sample;
}

// Estimate of the irradiance (luminance) that a light brings; 0 only if it cannot contribute.
fn light_importance(light: u32, point: vec3f, normal: vec3f) -> f32 {
    let receiver = Receiver(point, normal);
    var importance = 0.0;
    if (light >= light_placed_count()) {
        importance = triangle_light_importance(light - light_placed_count(), receiver);
    } else {
        let at = light_at(light);
        let shape = at + LIGHT_SHAPE;
        switch light_kind(at) {
            case LIGHT_RECTANGLE: {
                importance = rectangle_light_importance(at, receiver);
            }
            case LIGHT_ELLIPSE: {
                importance = 0.25 * PI * rectangle_light_importance(at, receiver);
            }
            case LIGHT_SPHERE: {
                importance = sphere_light_importance(sphere_light_at(shape), receiver);
            }
            case LIGHT_SPOT: {
                importance = spot_light_importance(spot_light_at(shape), receiver);
            }
            case LIGHT_BEAM: {
                importance = beam_light_importance(beam_light_at(shape), receiver);
            }
            case LIGHT_SKY, LIGHT_MAP: {
                importance = sky_importance(at, receiver);
            }
            default: {
                importance = distant_light_importance(distant_light_at(shape), receiver);
            }
        }
    }
    // A NaN fails the comparison
    if (importance > 0.0) {
        return clamp(importance, LEAST_IMPORTANCE, GREATEST_IMPORTANCE);
    }
    return 0.0;
}

// The nearest light with a surface that a ray meets before `t_max` on the side that emits; the camera looks through those that
// it does not see.
fn light_intersect(origin: vec3f, direction: vec3f, t_max: f32, of_camera: bool) -> LightHit {
    var hit = LightHit(t_max, vec3f(0.0), 0u, false, vec3f(0.0));
    let count = light_number(5u);
    for (var i = 0u; i < count; i++) {
        let light = light_number(light_number(6u) + i);
        let at = light_at(light);
        if (of_camera && tables[at + 1u] == 0.0) {
            continue;
        }
        // Not before the origin where the light is missed
        var t = -1.0;
        switch light_kind(at) {
            case LIGHT_RECTANGLE: {
                t = rectangle_light_distance(at, origin, direction);
            }
            case LIGHT_ELLIPSE: {
                t = ellipse_light_distance(at, origin, direction);
            }
            default: {
                t = sphere_light_distance(sphere_light_at(at + LIGHT_SHAPE), origin, direction);
            }
        }
        if (t >= 0.0 && t < hit.t) {
            hit.t = t;
            hit.light = light;
            hit.is_hit = true;
        }
    }
    if (hit.is_hit) {
        let at = light_at(hit.light);
        hit.position = origin + direction * hit.t;
        hit.radiance = light_radiance(at);
        if (light_kind(at) == LIGHT_SPHERE) {
            hit.radiance = sphere_light_radiance_toward(sphere_light_at(at + LIGHT_SHAPE), -direction);
        }
    }
    return hit;
}

// Density with which `light_sample` makes the direction from a point toward a hit, selection by the odds there included.
fn light_hit_pdf(odds: LightOdds, hit: LightHit, point: vec3f) -> f32 {
    let at = light_at(hit.light);
    var density = 0.0;
    switch light_kind(at) {
        case LIGHT_RECTANGLE: {
            density = rectangle_light_pdf(at, point, hit.position);
        }
        case LIGHT_ELLIPSE: {
            density = ellipse_light_pdf(at, point, hit.position);
        }
        default: {
            density = sphere_light_pdf(sphere_light_at(at + LIGHT_SHAPE), point, hit.position);
        }
    }
    if (density <= 0.0) {
        return 0.0;
    }
    return usable_density(light_probability(odds, hit.light) * density);
}

// The same for a hit on an emissive triangle; 0 if it does not emit to there.
fn emissive_triangle_pdf(odds: LightOdds, light_triangle: u32, point: vec3f, hit: vec3f) -> f32 {
    let density = triangle_light_pdf(light_triangle, point, hit - point);
    if (density <= 0.0) {
        return 0.0;
    }
    let light = light_placed_count() + light_triangle;
    return usable_density(light_probability(odds, light) * density);
}

// Densities that no sample has count as 0.
fn usable_density(density: f32) -> f32 {
    return select(0.0, density, density < GREATEST_DENSITY);
}

// Radiance that arrives from infinity, which scattered paths see: environment and discs of distant lights.
fn environment_radiance(direction: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    let count = light_number(3u);
    for (var i = 0u; i < count; i++) {
        let at = light_at(light_number(light_number(4u) + i));
        if (light_kind(at) == LIGHT_DISC) {
            sum += distant_light_radiance(distant_light_at(at + LIGHT_SHAPE), direction);
        } else {
            sum += sky_radiance(at, direction);
        }
    }
    return sum;
}

// Radiance of the environment alone, which the camera sees behind everything.
fn background_radiance(direction: vec3f) -> vec3f {
    let sky = light_number(7u);
    if (sky == 0u) {
        return vec3f(0.0);
    }
    return sky_radiance(light_at(sky - 1u), direction);
}

fn environment_is_visible() -> bool {
    return tables[lights_at + 8u] != 0.0;
}

// Density with which `light_sample` makes a direction to infinity, selection included.
fn environment_pdf(odds: LightOdds, normal: vec3f, direction: vec3f) -> f32 {
    if (light_number(3u) == 0u) {
        return 0.0;
    }
    return usable_density(infinite_light_pdf(odds, normal, direction));
}

// The density of all lights at infinity together.
fn infinite_light_pdf(odds: LightOdds, normal: vec3f, direction: vec3f) -> f32 {
    var sum = 0.0;
    let count = light_number(3u);
    for (var i = 0u; i < count; i++) {
        let light = light_number(light_number(4u) + i);
        let at = light_at(light);
        var density = 0.0;
        if (light_kind(at) == LIGHT_DISC) {
            density = distant_light_pdf(distant_light_at(at + LIGHT_SHAPE), direction);
        } else {
            density = sky_pdf(at, normal, direction);
        }
        if (density > 0.0) {
            sum += probability_beside_tree(odds, light) * density;
        }
    }
    return sum;
}
