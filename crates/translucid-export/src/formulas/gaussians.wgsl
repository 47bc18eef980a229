// Six Gaussians: a surface albedo, weights of sum 1, and standard deviations in x and in y [length].
struct Gaussians {
    surface_albedo: f32,
    weight_a: f32,
    weight_b: f32,
    weight_c: f32,
    weight_d: f32,
    weight_e: f32,
    weight_f: f32,
    deviation_a: f32,
    deviation_b: f32,
    deviation_c: f32,
    deviation_d: f32,
    deviation_e: f32,
    deviation_f: f32,
}

// r / deviation, bounded where e^(-x^2/2) leaves the range of numbers.
fn gaussians_ratio(deviation: f32, r: f32) -> f32 {
    return min(max(r, 0.0), 15.0 * deviation) / deviation;
}

// e^(-r^2/(2 deviation^2)).
fn gaussians_decay(deviation: f32, r: f32) -> f32 {
    let x: f32 = gaussians_ratio(deviation, r);
    return exp(-0.5 * x * x);
}

// A term's density per length [1/length].
fn gaussians_ring(weight: f32, deviation: f32, r: f32) -> f32 {
    return weight * gaussians_ratio(deviation, r) * gaussians_decay(deviation, r) / deviation;
}

// A term's density per area, less a factor 2 pi [1/length^2]; deviations below 1e-19 count as that.
fn gaussians_peak(weight: f32, deviation: f32, r: f32) -> f32 {
    let inverse: f32 = min(1.0 / deviation, 1e19);
    return weight * inverse * gaussians_decay(deviation, r) * inverse;
}

// Share of a term within r.
fn gaussians_within(weight: f32, deviation: f32, r: f32) -> f32 {
    let x: f32 = gaussians_ratio(deviation, r);
    return weight * one_minus_exp(0.5 * x * x);
}

// Density per length 2 pi r R(r) / A [1/length].
fn gaussians_pdf(terms: Gaussians, r: f32) -> f32 {
    return gaussians_ring(terms.weight_a, terms.deviation_a, r)
        + gaussians_ring(terms.weight_b, terms.deviation_b, r)
        + gaussians_ring(terms.weight_c, terms.deviation_c, r)
        + gaussians_ring(terms.weight_d, terms.deviation_d, r)
        + gaussians_ring(terms.weight_e, terms.deviation_e, r)
        + gaussians_ring(terms.weight_f, terms.deviation_f, r);
}

// Density per area R(r) / A [1/length^2].
fn gaussians_pdf_area(terms: Gaussians, r: f32) -> f32 {
    let sum: f32 = gaussians_peak(terms.weight_a, terms.deviation_a, r)
        + gaussians_peak(terms.weight_b, terms.deviation_b, r)
        + gaussians_peak(terms.weight_c, terms.deviation_c, r)
        + gaussians_peak(terms.weight_d, terms.deviation_d, r)
        + gaussians_peak(terms.weight_e, terms.deviation_e, r)
        + gaussians_peak(terms.weight_f, terms.deviation_f, r);
    return ${inverse_two_pi} * sum;
}

// Profile R(r) [1/length^2], finite at r = 0: its integral over the plane is the surface albedo A.
fn gaussians_eval(terms: Gaussians, r: f32) -> f32 {
    return terms.surface_albedo * gaussians_pdf_area(terms, r);
}

// Share of the light that leaves within r.
fn gaussians_cdf(terms: Gaussians, r: f32) -> f32 {
    return gaussians_within(terms.weight_a, terms.deviation_a, r)
        + gaussians_within(terms.weight_b, terms.deviation_b, r)
        + gaussians_within(terms.weight_c, terms.deviation_c, r)
        + gaussians_within(terms.weight_d, terms.deviation_d, r)
        + gaussians_within(terms.weight_e, terms.deviation_e, r)
        + gaussians_within(terms.weight_f, terms.deviation_f, r);
}

// Share of the light that leaves beyond r.
fn gaussians_complementary_cdf(terms: Gaussians, r: f32) -> f32 {
    return terms.weight_a * gaussians_decay(terms.deviation_a, r)
        + terms.weight_b * gaussians_decay(terms.deviation_b, r)
        + terms.weight_c * gaussians_decay(terms.deviation_c, r)
        + terms.weight_d * gaussians_decay(terms.deviation_d, r)
        + terms.weight_e * gaussians_decay(terms.deviation_e, r)
        + terms.weight_f * gaussians_decay(terms.deviation_f, r);
}

// Radius of density gaussians_pdf for a random number u in [0, 1): one Gaussian, chosen by its weight.
fn gaussians_sample(terms: Gaussians, u: f32) -> f32 {
    let share: f32 = min(max(u, 0.0), 0.99999994);
    let end_a: f32 = terms.weight_a;
    let end_b: f32 = end_a + terms.weight_b;
    let end_c: f32 = end_b + terms.weight_c;
    let end_d: f32 = end_c + terms.weight_d;
    let end_e: f32 = end_d + terms.weight_e;
    var start: f32 = end_e;
    var end: f32 = 1.0;
    var deviation: f32 = terms.deviation_f;
    if (share < end_a) {
        start = 0.0;
        end = end_a;
        deviation = terms.deviation_a;
    } else if (share < end_b) {
        start = end_a;
        end = end_b;
        deviation = terms.deviation_b;
    } else if (share < end_c) {
        start = end_b;
        end = end_c;
        deviation = terms.deviation_c;
    } else if (share < end_d) {
        start = end_c;
        end = end_d;
        deviation = terms.deviation_d;
    } else if (share < end_e) {
        start = end_d;
        end = end_e;
        deviation = terms.deviation_e;
    }
    // Both the rescaled number and its complement have the digits of u
    let x: f32 = max((end - share) / (end - start), 5.9604645e-8);
    let y: f32 = min((share - start) / (end - start), 0.99999994);
    return deviation * sqrt(2.0 * minus_log(x, y));
}
