// Four exponentials: a surface albedo, weights of sum 1, and rates [1/length].
struct Refined {
    surface_albedo: f32,
    weight_a: f32,
    weight_b: f32,
    weight_c: f32,
    weight_d: f32,
    rate_a: f32,
    rate_b: f32,
    rate_c: f32,
    rate_d: f32,
}

// The exponentials for A, clamped to [0, 1], and a mean free path, clamped to [1e-18, 1e18].
fn refined_terms(surface_albedo: f32, mean_free_path: f32) -> Refined {
    let a: f32 = min(max(surface_albedo, 0.0), 1.0);
    let mfp: f32 = min(max(mean_free_path, 1e-18), 1e18);
    // In 1 - A, as rates that are small at A = 1 would lose their digits in powers of A
    let k: f32 = 1.0 - a;
    var terms: Refined;
    terms.surface_albedo = a;
    terms.weight_a = ${refined.weight_a};
    terms.weight_b = ${refined.weight_b};
    terms.weight_c = ${refined.weight_c};
    terms.weight_d = ${refined.weight_d};
    terms.rate_a = (${refined.rate_a}) / mfp;
    terms.rate_b = (${refined.rate_b}) / mfp;
    terms.rate_c = (${refined.rate_c}) / mfp;
    terms.rate_d = (${refined.rate_d}) / mfp;
    return terms;
}

// Mean free path of a diffuse mean free path on the surface, for A in [0, 1); 0 at A = 1.
fn refined_mfp_from_dmfp(surface_albedo: f32, diffuse_mean_free_path: f32) -> f32 {
    let a: f32 = min(max(surface_albedo, 0.0), 1.0);
    return diffuse_mean_free_path * (1.0 - a) * (${mfp_per_dmfp});
}

// rate r, bounded where e^(-rate r) leaves the range of numbers.
fn refined_depth(rate: f32, r: f32) -> f32 {
    return rate * min(max(r, 0.0), 110.0 / rate);
}

// e^(-rate r).
fn refined_decay(rate: f32, r: f32) -> f32 {
    return exp(-refined_depth(rate, r));
}

// Density per length 2 pi r R(r) / A [1/length].
fn refined_pdf(terms: Refined, r: f32) -> f32 {
    return terms.weight_a * terms.rate_a * refined_decay(terms.rate_a, r)
        + terms.weight_b * terms.rate_b * refined_decay(terms.rate_b, r)
        + terms.weight_c * terms.rate_c * refined_decay(terms.rate_c, r)
        + terms.weight_d * terms.rate_d * refined_decay(terms.rate_d, r);
}

// Density per area R(r) / A [1/length^2].
fn refined_pdf_area(terms: Refined, r: f32) -> f32 {
    return bounded_ratio(refined_pdf(terms, r) * ${inverse_two_pi}, r);
}

// Profile R(r) [1/length^2], which grows like 1/r: its integral over the plane is the surface albedo A.
fn refined_eval(terms: Refined, r: f32) -> f32 {
    return bounded_ratio(terms.surface_albedo * refined_pdf(terms, r) * ${inverse_two_pi}, r);
}

// Share of the light that leaves within r.
fn refined_cdf(terms: Refined, r: f32) -> f32 {
    return terms.weight_a * one_minus_exp(refined_depth(terms.rate_a, r))
        + terms.weight_b * one_minus_exp(refined_depth(terms.rate_b, r))
        + terms.weight_c * one_minus_exp(refined_depth(terms.rate_c, r))
        + terms.weight_d * one_minus_exp(refined_depth(terms.rate_d, r));
}

// Share of the light that leaves beyond r.
fn refined_complementary_cdf(terms: Refined, r: f32) -> f32 {
    return terms.weight_a * refined_decay(terms.rate_a, r)
        + terms.weight_b * refined_decay(terms.rate_b, r)
        + terms.weight_c * refined_decay(terms.rate_c, r)
        + terms.weight_d * refined_decay(terms.rate_d, r);
}

// Radius of density refined_pdf for a random number u in [0, 1): one exponential, chosen by its weight.
fn refined_sample(terms: Refined, u: f32) -> f32 {
    let share: f32 = min(max(u, 0.0), 0.99999994);
    let end_a: f32 = terms.weight_a;
    let end_b: f32 = end_a + terms.weight_b;
    let end_c: f32 = end_b + terms.weight_c;
    let start: f32 = select(select(select(end_c, end_b, share < end_c), end_a, share < end_b), 0.0, share < end_a);
    let end: f32 = select(select(select(1.0, end_c, share < end_c), end_b, share < end_b), end_a, share < end_a);
    let late: f32 = select(terms.rate_d, terms.rate_c, share < end_c);
    let rate: f32 = select(select(late, terms.rate_b, share < end_b), terms.rate_a, share < end_a);
    // Both the rescaled number and its complement have the digits of u
    let x: f32 = max((end - share) / (end - start), 5.9604645e-8);
    let y: f32 = min((share - start) / (end - start), 0.99999994);
    return minus_log(x, y) / rate;
}
