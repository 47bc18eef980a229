// Four tilted exponentials of a surface albedo, a mean free path and an angle of incidence.
struct Oblique {
    // Energy that leaves, E: the surface albedo for this angle
    total: f32,
    weight_a: f32,
    weight_b: f32,
    weight_c: f32,
    weight_d: f32,
    // Rates [1/length]
    rate_a: f32,
    rate_b: f32,
    rate_c: f32,
    rate_d: f32,
    // Eccentricities of the azimuth's density: sines and cosines of each term's own angle
    sine_a: f32,
    sine_b: f32,
    sine_c: f32,
    sine_d: f32,
    cosine_a: f32,
    cosine_b: f32,
    cosine_c: f32,
    cosine_d: f32,
}

// Deviation of the energy at a cosine from that of diffuse light, for the albedo of diffuse light.
fn oblique_deviation(diffuse_albedo: f32, mu: f32) -> f32 {
    let a: f32 = diffuse_albedo;
    // mu ln(1 + 1/mu), mu and mu^2, each less its mean over diffuse light
    let m: f32 = max(mu, 1e-18);
    let log_term: f32 = m * minus_log(m / (1.0 + m), 1.0 / (1.0 + m)) - ${oblique.mean_log};
    let sum: f32 = (${oblique.energy_a}) * log_term
        + (${oblique.energy_b}) * (mu - 2.0 / 3.0)
        + (${oblique.energy_c}) * (mu * mu - 0.5);
    return (1.0 - a) * sum;
}

// The terms for A, clamped to [0, 1], a mean free path, clamped to [1e-18, 1e18], and the cosine of the angle between
// beam and normal inside the medium, clamped to [0, 1].
fn oblique_terms(surface_albedo: f32, mean_free_path: f32, cos_theta: f32) -> Oblique {
    let albedo: f32 = min(max(surface_albedo, 0.0), 1.0);
    let mfp: f32 = min(max(mean_free_path, 1e-18), 1e18);
    let mu: f32 = min(max(cos_theta, 0.0), 1.0);
${oblique.albedos}
    // Beams that graze more have the shape of 85 degrees and their own energy
    let c: f32 = max(mu, ${oblique.least_cos_theta});
    let sine: f32 = sqrt((1.0 - c) * (1.0 + c));
    let g: f32 = 1.0 - sqrt(c);
    let k: f32 = 1.0 - a;
    var terms: Oblique;
    terms.total = min(max(energy * (1.0 - oblique_deviation(diffuse, mu)), 0.0), 1.0);
    terms.weight_a = (1.0 - g) * (${searchlight.weight_a}) + g * (${oblique.weight_a});
    terms.weight_b = (1.0 - g) * (${searchlight.weight_b}) + g * (${oblique.weight_b});
    terms.weight_c = (1.0 - g) * (${searchlight.weight_c}) + g * (${oblique.weight_c});
    terms.weight_d = (1.0 - g) * (${searchlight.weight_d}) + g * (${oblique.weight_d});
    terms.rate_a = (${searchlight.rate_a}) / mfp;
    terms.rate_b = (${searchlight.rate_b}) * (1.0 + g * (${oblique.change_b})) / mfp;
    terms.rate_c = (${searchlight.rate_c}) * (1.0 + g * (${oblique.change_c})) / mfp;
    terms.rate_d = (${searchlight.rate_d}) * (1.0 + g * (${oblique.change_d})) / mfp;
    let opposite_a: f32 = sine * (${oblique.tilt_a} + g * (${oblique.tilt_change_a}));
    let opposite_b: f32 = sine * (${oblique.tilt_b} + g * (${oblique.tilt_change_b}));
    let opposite_c: f32 = sine * (${oblique.tilt_c} + g * (${oblique.tilt_change_c}));
    let opposite_d: f32 = sine * (${oblique.tilt_d} + g * (${oblique.tilt_change_d}));
    let inverse_a: f32 = 1.0 / sqrt(c * c + opposite_a * opposite_a);
    let inverse_b: f32 = 1.0 / sqrt(c * c + opposite_b * opposite_b);
    let inverse_c: f32 = 1.0 / sqrt(c * c + opposite_c * opposite_c);
    let inverse_d: f32 = 1.0 / sqrt(c * c + opposite_d * opposite_d);
    terms.sine_a = opposite_a * inverse_a;
    terms.sine_b = opposite_b * inverse_b;
    terms.sine_c = opposite_c * inverse_c;
    terms.sine_d = opposite_d * inverse_d;
    terms.cosine_a = c * inverse_a;
    terms.cosine_b = c * inverse_b;
    terms.cosine_c = c * inverse_c;
    terms.cosine_d = c * inverse_d;
    return terms;
}

// A term's density per length of the radius times its density of the azimuth, less a factor 2 pi.
fn oblique_term(weight: f32, rate: f32, sine: f32, cosine: f32, r: f32, versine: f32) -> f32 {
    let decay: f32 = refined_decay(rate, r);
    // cos/(1 - sin cos phi), with the digits of a beam that grazes
    return weight * rate * decay * cosine / (cosine * cosine / (1.0 + sine) + sine * versine);
}

// Density per area R / E [1/length^2] at (x, y) from the entry, x towards where the beam is tilted to.
fn oblique_pdf_area(terms: Oblique, x: f32, y: f32) -> f32 {
    // r and 1 - cos phi without overflow, and with the digits of a small azimuth
    let most: f32 = max(max(abs(x), abs(y)), 1.1754944e-38);
    let p: f32 = x / most;
    let q: f32 = y / most;
    let unit: f32 = max(sqrt(p * p + q * q), 1e-9);
    let r: f32 = min(most, 1e38) * unit;
    let versine: f32 = select(q * q / ((unit + max(p, 0.0)) * unit), 1.0 - p / unit, p < 0.0);
    let density: f32 = oblique_term(terms.weight_a, terms.rate_a, terms.sine_a, terms.cosine_a, r, versine)
        + oblique_term(terms.weight_b, terms.rate_b, terms.sine_b, terms.cosine_b, r, versine)
        + oblique_term(terms.weight_c, terms.rate_c, terms.sine_c, terms.cosine_c, r, versine)
        + oblique_term(terms.weight_d, terms.rate_d, terms.sine_d, terms.cosine_d, r, versine);
    return bounded_ratio(density * ${inverse_two_pi}, r);
}

// Profile R [1/length^2] at (x, y) from the entry: its integral over the plane is terms.total.
fn oblique_eval(terms: Oblique, x: f32, y: f32) -> f32 {
    return terms.total * oblique_pdf_area(terms, x, y);
}

// An offset from the entry [length], x towards where the beam is tilted to.
struct ObliqueOffset {
    x: f32,
    y: f32,
}

// Offset of density oblique_pdf_area for two random numbers in [0, 1).
fn oblique_sample(terms: Oblique, u: f32, turn: f32) -> ObliqueOffset {
    let share: f32 = min(max(u, 0.0), 0.99999994);
    let end_a: f32 = terms.weight_a;
    let end_b: f32 = end_a + terms.weight_b;
    let end_c: f32 = end_b + terms.weight_c;
    var start: f32 = end_c;
    var end: f32 = 1.0;
    var rate: f32 = terms.rate_d;
    var sine: f32 = terms.sine_d;
    var cosine: f32 = terms.cosine_d;
    if (share < end_a) {
        start = 0.0;
        end = end_a;
        rate = terms.rate_a;
        sine = terms.sine_a;
        cosine = terms.cosine_a;
    } else if (share < end_b) {
        start = end_a;
        end = end_b;
        rate = terms.rate_b;
        sine = terms.sine_b;
        cosine = terms.cosine_b;
    } else if (share < end_c) {
        start = end_b;
        end = end_c;
        rate = terms.rate_c;
        sine = terms.sine_c;
        cosine = terms.cosine_c;
    }
    let left: f32 = max((end - share) / (end - start), 5.9604645e-8);
    let right: f32 = min((share - start) / (end - start), 0.99999994);
    let r: f32 = minus_log(left, right) / rate;
    // The azimuth phi with tan(phi/2) = cos/(1 + sin) tan(pi (turn - 1/2)), by the half angle's sine and cosine
    let h: f32 = ${pi} * (min(max(turn, 0.0), 1.0) - 0.5);
    let s: f32 = cosine / (1.0 + sine) * sin(h);
    let c: f32 = cos(h);
    let square: f32 = max(c * c + s * s, 1.1754944e-38);
    var at: ObliqueOffset;
    at.x = r * (c * c - s * s) / square;
    at.y = r * (2.0 * s * c) / square;
    return at;
}
