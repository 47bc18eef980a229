// Selection of the light to sample: few lights in proportion to their importance for the point at hand, many by a tree, and
// those that no tree can hold beside it; too many of these by their power.

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
    // Probability of the tree.
    tree: f32,
    point: vec3f,
    normal: vec3f,
}

struct LightChoice {
    light: u32,
    // 0 if no light can contribute.
    probability: f32,
}

fn light_selection() -> u32 {
    return light_number(2u);
}

// How many lights are weighed one by one.
fn weighed_count() -> u32 {
    return select(light_count(), light_number(11u), light_selection() == BY_TREE);
}

fn weighed_light(place: u32) -> u32 {
    if (light_selection() == BY_TREE) {
        return light_number(light_number(10u) + place);
    }
    return place;
}

// Where a light is in the tree or, below 0, −1 − its place beside it.
fn light_leaf(light: u32) -> i32 {
    if (light_selection() == BY_TREE) {
        return i32(tables[lights_at + light_number(13u) + light]);
    }
    return -1 - i32(light);
}

fn light_count() -> u32 {
    return light_number(0u) + light_number(1u);
}

// Importances of the lights at the point whose odds were found last: drivers copy what is called into every place.
var<private> light_importances: array<f32, MOST_WEIGHED>;

// Weighs the lights at a point.
fn light_odds(point: vec3f, normal: vec3f) -> LightOdds {
    var odds = LightOdds(0.0, 0.0, 0.0, point, normal);
    if (light_selection() == BY_POWER) {
        return odds;
    }
    var sum = 0.0;
    var contributing = 0.0;
    let count = weighed_count();
    for (var place = 0u; place < count; place++) {
        let importance = light_importance(weighed_light(place), point, normal);
        light_importances[place % MOST_WEIGHED] = importance;
        sum += importance;
        contributing += select(0.0, 1.0, importance > 0.0);
    }
    if (light_selection() == BY_TREE) {
        let in_tree = tree_weigh(0u, point, normal).x;
        if (in_tree > 0.0) {
            odds.tree = select(1.0, (1.0 - EVEN_SHARE) * in_tree / (in_tree + sum) + 0.5 * EVEN_SHARE, sum > 0.0);
        }
    }
    if (sum > 0.0) {
        odds.scale = (1.0 - odds.tree) * (1.0 - EVEN_SHARE) / sum;
        odds.even = (1.0 - odds.tree) * EVEN_SHARE / contributing;
    }
    return odds;
}

// Probability with which `light_choose` selects a light, at the point of the odds.
fn light_probability(odds: LightOdds, light: u32) -> f32 {
    let leaf = light_leaf(light);
    if (leaf >= 0) {
        return odds.tree * tree_probability(u32(leaf), odds.point, odds.normal);
    }
    return probability_beside_tree(odds, light);
}

// The same for lights that no tree holds: those at infinity.
fn probability_beside_tree(odds: LightOdds, light: u32) -> f32 {
    if (light_selection() == BY_POWER) {
        return table_probability(0u, light);
    }
    return weighed_probability(odds, u32(-1 - light_leaf(light)));
}

fn weighed_probability(odds: LightOdds, place: u32) -> f32 {
    let importance = light_importances[place % MOST_WEIGHED];
    return select(0.0, importance * odds.scale + odds.even, importance > 0.0);
}

// Selects a light by a word of 31 bits.
fn light_choose(odds: LightOdds, word: u32) -> LightChoice {
    let count = light_count();
    if (count == 0u) {
        return LightChoice(0u, 0.0);
    }
    if (light_selection() == BY_POWER) {
        let light = table_index(0u, count, word);
        return LightChoice(light, table_probability(0u, light));
    }
    let u = f32(word) * 0x1p-31f;
    if (u >= 1.0 - odds.tree) {
        let of_tree = tree_choose(word, odds.point, odds.normal);
        return LightChoice(of_tree.light, odds.tree * of_tree.probability);
    }
    var chosen = LightChoice(0u, 0.0);
    var end = 0.0;
    let weighed = weighed_count();
    for (var place = 0u; place < weighed; place++) {
        let probability = weighed_probability(odds, place);
        if (probability > 0.0) {
            chosen = LightChoice(weighed_light(place), probability);
            end += probability;
            if (u < end) {
                break;
            }
        }
    }
    // The probabilities sum to what the tree leaves up to rounding: beyond their sum the last one is chosen
    return chosen;
}
