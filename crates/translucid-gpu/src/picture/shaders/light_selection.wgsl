// Selection of the light to sample: few lights in proportion to their importance for the point at hand, many by their power.

// Up to this many lights are weighed for each point.
const MOST_WEIGHED = 64u;
// Share of the samples that goes evenly to all lights that can contribute, in case the important ones are hidden.
const EVEN_SHARE = 0.1f;
// Importances beyond these are as good as equal, and their sums stay in range.
const LEAST_IMPORTANCE = 1e-30f;
const GREATEST_IMPORTANCE = 1e30f;

// What turns importances at a point into probabilities.
struct LightOdds {
    // Probability of an importance of 1 less the even share.
    scale: f32,
    even: f32,
}

struct LightChoice {
    light: u32,
    // 0 if no light can contribute.
    probability: f32,
}

fn lights_are_weighed() -> bool {
    return tables[lights_at + 2u] != 0.0;
}

fn light_count() -> u32 {
    return light_number(0u) + light_number(1u);
}

// Importances of the lights at the point whose odds were found last: drivers copy what is called into every place.
var<private> light_importances: array<f32, MOST_WEIGHED>;

// Weighs the lights at a point.
fn light_odds(point: vec3f, normal: vec3f) -> LightOdds {
    if (!lights_are_weighed()) {
        return LightOdds(0.0, 0.0);
    }
    var sum = 0.0;
    var contributing = 0.0;
    let count = light_count();
    for (var light = 0u; light < count; light++) {
        let importance = light_importance(light, point, normal);
        light_importances[light % MOST_WEIGHED] = importance;
        sum += importance;
        contributing += select(0.0, 1.0, importance > 0.0);
    }
    if (sum > 0.0) {
        return LightOdds((1.0 - EVEN_SHARE) / sum, EVEN_SHARE / contributing);
    }
    return LightOdds(0.0, 0.0);
}

// Probability with which `light_choose` selects a light, at the point of the odds.
fn light_probability(odds: LightOdds, light: u32) -> f32 {
    if (!lights_are_weighed()) {
        return table_probability(0u, light);
    }
    let importance = light_importances[light % MOST_WEIGHED];
    return select(0.0, importance * odds.scale + odds.even, importance > 0.0);
}

// Selects a light by a word of 31 bits.
fn light_choose(odds: LightOdds, word: u32) -> LightChoice {
    let count = light_count();
    if (count == 0u) {
        return LightChoice(0u, 0.0);
    }
    if (!lights_are_weighed()) {
        let light = table_index(0u, count, word);
        return LightChoice(light, table_probability(0u, light));
    }
    let u = f32(word) * 0x1p-31f;
    var chosen = LightChoice(0u, 0.0);
    var end = 0.0;
    for (var light = 0u; light < count; light++) {
        let probability = light_probability(odds, light);
        if (probability > 0.0) {
            chosen = LightChoice(light, probability);
            end += probability;
            if (u < end) {
                break;
            }
        }
    }
    // The probabilities sum to 1 up to rounding: beyond their sum the last one is chosen
    return chosen;
}

// Estimate of the irradiance (luminance) that a light brings; 0 only if it cannot contribute.
fn light_importance(light: u32, point: vec3f, normal: vec3f) -> f32 {
    var importance = 0.0;
    if (light >= light_placed_count()) {
        importance = triangle_light_importance(light - light_placed_count(), point, normal);
    } else {
        let at = light_at(light);
        switch light_kind(at) {
            case LIGHT_RECTANGLE: {
                importance = rectangle_light_importance(at, point, normal);
            }
            case LIGHT_ELLIPSE: {
                importance = 0.25 * PI * rectangle_light_importance(at, point, normal);
            }
            case LIGHT_SPHERE: {
                importance = sphere_light_importance(at, point, normal);
            }
            case LIGHT_SPOT: {
                importance = spot_light_importance(at, point, normal);
            }
            case LIGHT_BEAM: {
                importance = beam_light_importance(at, point, normal);
            }
            case LIGHT_SKY, LIGHT_MAP: {
                importance = sky_importance(at, normal);
            }
            default: {
                importance = distant_light_importance(at, normal);
            }
        }
    }
    // A NaN fails the comparison
    if (importance > 0.0) {
        return clamp(importance, LEAST_IMPORTANCE, GREATEST_IMPORTANCE);
    }
    return 0.0;
}

fn has_normal(normal: vec3f) -> bool {
    return any(normal != vec3f(0.0));
}

// Cosine of a direction to the normal, 0 below the horizon; 1 without a normal.
fn light_cosine(normal: vec3f, direction: vec3f) -> f32 {
    return select(1.0, clamp(dot(normal, direction), 0.0, 1.0), has_normal(normal));
}
