// Where and how photons start.

const PENCIL = 0u;
const UNIFORM_COSINE = 1u;
const COSINE_MATCHED = 2u;
const COSINE_RARER = 3u;

override incidence: u32;

// Most candidates for a cosine: a photon wants one more with a probability below 0.9.
const CANDIDATES = 1000u;

fn launched(number: u32) -> Photon {
    var photon: Photon;
    photon.number = number;
    let low = settings.first.x + number;
    photon.index = vec2u(low, settings.first.y + select(0u, 1u, low < number));

    let words = random(photon.index, 0u);
    photon.budget = u32(times(exponential(words.x), settings.collisions_per_unit));
    photon.left = photon.budget;
    let radius = times(root(unit(words.y)), settings.spot_radius);
    let place = circle(words.z);
    photon.position = vec3f(times(radius, place.x), times(radius, place.y), 0.0);
    photon.step = 1u;
    if (incidence == PENCIL) {
        photon.direction = vec3f(settings.sine, 0.0, settings.cosine);
        return photon;
    }

    // Draw the cosine of all directions
    var cosine = 1.0;
    var azimuth = 0u;
    for (var candidate = 0u; candidate < CANDIDATES; candidate++) {
        let words = random(photon.index, photon.step);
        photon.step += 1u;
        azimuth = words.z;
        cosine = unit(words.x);
        if (incidence == UNIFORM_COSINE) {
            break;
        }
        cosine = root(cosine);
        if (incidence == COSINE_MATCHED || unit(words.y) > reflectance(cosine, settings.rarer)) {
            break;
        }
    }
    var sine = complement(cosine);
    if (incidence > COSINE_RARER) {
        // Light enters a denser medium, and bends
        sine = times(sine, settings.inverse_eta);
        cosine = complement(sine);
    }
    let around = circle(azimuth);
    photon.direction = vec3f(times(sine, around.x), times(sine, around.y), cosine);
    return photon;
}
