// Shells of other media below the surface of a body: `surface/shells.rs` of the renderer. The distance to the surface, the depth,
// decides which medium a point is in. Without shells the medium of the material is everywhere.

// Words behind the tables of a medium: the number of shells, surface albedos that make paths look below dark surfaces, then of
// each shell the depth at which it ends, extinction coefficients, single-scattering albedos and the mean cosine.
const BRIGHTEST_SHELL = 1u;
const SHELLS = 4u;
const SHELL_WORDS = 8u;
const SHELL_SIGMA_T = 1u;
const SHELL_ALPHA = 4u;
const SHELL_G = 7u;
// Part of a sum below which a summand is rounded away.
const SWALLOWED = 6e-8;
// Greatest depth, whose square is a number.
const DEEPEST = 1e18;

struct Shells {
    // Extinction coefficients of the medium behind them, the greatest and the least of all.
    innermost: vec3f,
    // Where their words are, and how many there are.
    at: u32,
    most: vec3f,
    count: u32,
    least: vec3f,
    // Greatest extinction coefficient that positions resolve.
    finest: f32,
    // Depth that needs not be exact, and that from which on none is known.
    enough: f32,
    reach: f32,
}

// The medium at a depth: its extinction coefficients, the number of its shell, and the radius of a ball in which there is no other.
struct ShellMedium {
    sigma_t: vec3f,
    number: u32,
    free: f32,
}

// The next flight: coefficients to draw its length by, the way after which a new one begins, and whether its medium is known.
struct Flight {
    sigma_t: vec3f,
    limit: f32,
    is_known: bool,
}

fn shell_words(material: u32) -> u32 {
    return head(MEDIA) + u32(tables[material_at(material) + MEDIUM]) + 2u * (ALBEDOS + 1u);
}

// The shells of a material around its own medium, for a body with such rounding errors of positions.
fn shells_around(material: u32, innermost: vec3f, offset: f32) -> Shells {
    let words = shell_words(material);
    var shells: Shells;
    shells.innermost = innermost;
    shells.at = words + SHELLS;
    shells.count = u32(tables[words]);
    shells.most = innermost;
    shells.least = innermost;
    if (shells.count == 0u) {
        return shells;
    }
    shells.finest = 1.0 / max(LEAST_OFFSETS_OF_MFP * offset, 1e-30);
    for (var k = 0u; k < shells.count; k += 1u) {
        let sigma_t = shell_sigma_t(&shells, k);
        shells.most = max(shells.most, sigma_t);
        shells.least = min(shells.least, sigma_t);
    }
    shells.enough = tables[shells.at + (shells.count - 1u) * SHELL_WORDS];
    shells.reach = shells.enough;
    let excess = greatest(shells.most - innermost);
    if (excess > 0.0) {
        shells.enough += 1.0 / excess;
        shells.reach = shells.enough + 1.0 / max(min(innermost.x, min(innermost.y, innermost.z)), 1e-30);
    }
    shells.reach = min(shells.reach, DEEPEST);
    return shells;
}

fn shell_sigma_t(shells: ptr<function, Shells>, number: u32) -> vec3f {
    return min(table_vector((*shells).at + number * SHELL_WORDS + SHELL_SIGMA_T), vec3f((*shells).finest));
}

fn shell_at(shells: ptr<function, Shells>, depth: f32) -> ShellMedium {
    var start = -NEVER;
    var end = NEVER;
    var number = 0u;
    for (; number < (*shells).count; number += 1u) {
        end = tables[(*shells).at + number * SHELL_WORDS];
        if (depth < end) {
            break;
        }
        start = end;
        end = NEVER;
    }
    let free = min(depth - start, end - depth);
    if (number < (*shells).count) {
        return ShellMedium(shell_sigma_t(shells, number), number, free);
    }
    return ShellMedium((*shells).innermost, number, free);
}

// Mean cosine of the phase function in a shell.
fn shell_g(shells: ptr<function, Shells>, number: u32, material: u32) -> f32 {
    if (number < (*shells).count) {
        return tables[(*shells).at + number * SHELL_WORDS + SHELL_G];
    }
    return tables[material_at(material) + WALK_G];
}

fn flight_from(shells: ptr<function, Shells>, depth: f32) -> Flight {
    if ((*shells).count == 0u) {
        return Flight((*shells).innermost, NEVER, true);
    }
    let here = shell_at(shells, depth);
    // Collisions with nothing that a flight through the medium itself spares
    if (greatest((*shells).most - here.sigma_t) * here.free > 1.0) {
        return Flight(here.sigma_t, here.free, true);
    }
    return Flight((*shells).most, NEVER, false);
}

// The depth of a point of a body, so far from one of a known depth: exact below `enough`, from there on a lower bound.
fn depth_of(shells: ptr<function, Shells>, point: vec3f, group: u32, known: f32, moved: f32) -> f32 {
    let bound = known - moved;
    if (bound >= (*shells).enough) {
        return bound;
    }
    // Only exact depths are upper bounds
    let most = select((*shells).reach, min((*shells).reach, known + moved), known < (*shells).enough);
    return distance_to_group(point, group, most);
}

// The end of a flight through shells, whose depth is known: a collision, or the next flight.
fn end_flight_in_shells(
    path: ptr<function, Path>,
    walk: ptr<function, Walk>,
    light: ptr<function, Light>,
    shells: ptr<function, Shells>,
    depth: f32,
) {
    let is_clear = u32(tables[material_at((*walk).material) + WALK_SURFACE]) == CLEAR;
    let flight = flight_from(shells, (*walk).depth);
    let is_at_limit = ((*path).flags & AT_LIMIT) != 0u;
    let length = select((*walk).length + (*walk).skipped, flight.limit, is_at_limit);
    var density = attenuation((*path).throughput, flight.sigma_t, length);
    if (!is_at_limit) {
        density *= flight.sigma_t;
    }
    (*path).throughput = reweighed((*path).throughput, density);
    (*path).passes = 0u;
    (*walk).skipped = max((*walk).skipped - length, 0.0);
    let before = (*walk).depth;
    (*walk).depth = depth;
    let numbers = single_numbers(path, walk, is_clear);
    var next = numbers.x;
    var taken = 1u;
    if (!is_at_limit) {
        // A collision with nothing, in proportion to what the medium lacks of the densest
        let here = shell_at(shells, select(depth, before, flight.is_known));
        let whole = select(vec3f(0.0), here.sigma_t / max((*shells).most, vec3f(1e-30)), (*shells).most > vec3f(0.0));
        let part = select(min(whole, vec3f(1.0)), vec3f(1.0), flight.is_known);
        let share = dot((*path).throughput, part) / max(sum((*path).throughput), 1e-30);
        if (flight.is_known || numbers.x < share) {
            var alpha = (*walk).alpha;
            if (here.number < (*shells).count) {
                alpha = table_vector((*shells).at + here.number * SHELL_WORDS + SHELL_ALPHA);
            }
            (*path).throughput *= alpha * part / max(share, 1e-30);
            (*walk).draws += select(1u, 0u, flight.is_known);
            be_collided(path, walk, light);
            return;
        }
        (*path).throughput *= (vec3f(1.0) - part) / max(1.0 - share, 1e-30);
        next = numbers.y;
        taken = 2u;
    }
    (*walk).draws += taken;
    (*path).work = select(WALK_RAY, ENDED, is_zero((*path).throughput));
    fly_on(path, walk, flight_from(shells, depth), next);
}

// Begins the way of a light sample through shells: what they take beyond the least dense medium is found at random.
fn enter_shells(slot: u32, shadow: ptr<function, Shadow>, distance: f32) {
    (*shadow).stage = SHELL_SHADOW;
    (*shadow).share = vec3f(1.0);
    (*shadow).length = distance;
    (*shadow).done = 0.0;
    let sampler = slots[slot].path.sampler;
    var random = hash_combine(sampler.seed, sampler.index);
    let origin = bitcast<vec3u>((*shadow).origin);
    let direction = bitcast<vec3u>((*shadow).direction);
    for (var axis = 0u; axis < 3u; axis += 1u) {
        random = hash_combine(hash_combine(random, origin[axis]), direction[axis]);
    }
    (*shadow).random = random;
}

// One more number in [0, 1).
fn number_of_shadow(shadow: ptr<function, Shadow>) -> f32 {
    (*shadow).random += 0x9e3779b9u;
    return f32(avalanche((*shadow).random) >> 8u) * (1.0 / 16777216.0);
}

// Goes on to where the medium may be another, or where light is lost in proportion to the medium there: ratio tracking.
fn step_in_shells(shadow: ptr<function, Shadow>, shells: ptr<function, Shells>) -> bool {
    let densest = greatest((*shells).most - (*shells).least);
    let here = shell_at(shells, (*shadow).depth);
    if (here.free * densest > 1.0) {
        let step = min(here.free, (*shadow).length - (*shadow).done);
        (*shadow).share *= exp(-min((here.sigma_t - (*shells).least) * step, vec3f(80.0)));
        if (here.free <= SWALLOWED * (*shadow).done) {
            // It would be taken for ever
            (*shadow).share = vec3f(0.0);
        }
        (*shadow).done += step;
        return false;
    }
    (*shadow).done -= log(1.0 - number_of_shadow(shadow)) / densest;
    return true;
}

// Loses light at a place of a known depth, and ends at random where little is left.
fn lose_in_shells(shadow: ptr<function, Shadow>, shells: ptr<function, Shells>, depth: f32, is_loss: bool) {
    (*shadow).depth = depth;
    if (is_loss) {
        let more = shell_at(shells, depth).sigma_t - (*shells).least;
        (*shadow).share *= max(vec3f(1.0) - more / greatest((*shells).most - (*shells).least), vec3f(0.0));
    }
    let most = greatest((*shadow).share);
    if (most < SHELL_ROULETTE_BELOW) {
        if (number_of_shadow(shadow) * SHELL_ROULETTE_BELOW >= most) {
            (*shadow).stage = NO_SHADOW;
            return;
        }
        (*shadow).share *= SHELL_ROULETTE_BELOW / most;
    }
}

// Transmittance of shells below which light is looked for at random.
const SHELL_ROULETTE_BELOW = 0.1;
