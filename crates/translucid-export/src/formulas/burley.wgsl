// Scale s(A) for a mean free path; a pencil beam enters perpendicularly (Christensen & Burley 2015, equation 5).
fn burley_scale_mfp_searchlight(surface_albedo: f32) -> f32 {
    let a: f32 = min(max(surface_albedo, 0.0), 1.0);
    let x: f32 = abs(a - ${mfp_searchlight.center});
    return ${mfp_searchlight.constant} - a + ${mfp_searchlight.factor} * x * x * x;
}

// Scale s(A) for a mean free path; light enters with a cosine distribution (equation 6).
fn burley_scale_mfp_diffuse(surface_albedo: f32) -> f32 {
    let a: f32 = min(max(surface_albedo, 0.0), 1.0);
    let x: f32 = a - ${mfp_diffuse.center};
    return ${mfp_diffuse.constant} - a + ${mfp_diffuse.factor} * x * x;
}

// Scale s(A) for a diffuse mean free path on the surface; a pencil beam enters perpendicularly (equation 8).
fn burley_scale_dmfp_searchlight(surface_albedo: f32) -> f32 {
    let a: f32 = min(max(surface_albedo, 0.0), 1.0);
    let x: f32 = (a - ${dmfp_searchlight.center}) * (a - ${dmfp_searchlight.center});
    return ${dmfp_searchlight.constant} + ${dmfp_searchlight.factor} * x * x;
}

// Width d = length / s(A) of the profile, clamped to [1e-18, 1e18].
fn burley_width(mean_free_path: f32, scale: f32) -> f32 {
    return min(max(mean_free_path / scale, 1e-18), 1e18);
}

// r / 3d, bounded where e^(-r/3d) leaves the range of numbers.
fn burley_depth(r: f32, d: f32) -> f32 {
    return min(max(r, 0.0), 330.0 * d) / (3.0 * d);
}

// Density per length 2 pi r R(r) / A [1/length].
fn burley_pdf(r: f32, d: f32) -> f32 {
    let x: f32 = exp(-burley_depth(r, d));
    return 0.25 * x * (1.0 + x * x) / d;
}

// Density per area R(r) / A [1/length^2]: what a renderer divides R by.
fn burley_pdf_area(r: f32, d: f32) -> f32 {
    return bounded_ratio(burley_pdf(r, d) * ${inverse_two_pi}, r);
}

// Profile R(r) [1/length^2], which grows like 1/r: its integral over the plane is the surface albedo A.
fn burley_eval(surface_albedo: f32, r: f32, d: f32) -> f32 {
    return bounded_ratio(surface_albedo * burley_pdf(r, d) * ${inverse_two_pi}, r);
}

// Profile times radius r R(r) [1/length], finite at r = 0.
fn burley_eval_times_r(surface_albedo: f32, r: f32, d: f32) -> f32 {
    return surface_albedo * burley_pdf(r, d) * ${inverse_two_pi};
}

// Share of the light that leaves within r.
fn burley_cdf(r: f32, d: f32) -> f32 {
    // In y = 1 - e^(-r/3d): 1 - e^(-r/d)/4 - 3 e^(-r/3d)/4 would lose the digits of a small r
    let y: f32 = one_minus_exp(burley_depth(r, d));
    return 0.25 * y * (6.0 + y * (y - 3.0));
}

// Share of the light that leaves beyond r.
fn burley_complementary_cdf(r: f32, d: f32) -> f32 {
    let x: f32 = exp(-burley_depth(r, d));
    return 0.25 * x * (3.0 + x * x);
}

// Radius within which the share u in [0, 1) of the light leaves: rises with u, for stratified numbers.
//
// With x = e^(-r/3d) the share is 1 - (x^3 + 3x)/4, so x = 2 sinh(asinh(2 - 2u)/3). That form loses digits where r is
// small and takes three slow functions. A quadratic and one step of Halley's method reach the same root to rounding,
// for x above the median and for 1 - x below it.
fn burley_quantile(u: f32, d: f32) -> f32 {
    let share: f32 = min(max(u, 0.0), 0.99999994);
    let is_below: bool = share < 0.5;
    let v: f32 = select(1.0 - share, share, is_below);
    // w^3 + 3b w^2 + a w = 4v
    let a: f32 = select(3.0, 6.0, is_below);
    let b: f32 = select(0.0, -1.0, is_below);
    let from_below: f32 = ${start_below};
    let from_above: f32 = ${start_above};
    let start: f32 = v * select(from_above, from_below, is_below);
    let excess: f32 = start * (a + start * (start + 3.0 * b)) - 4.0 * v;
    let slope: f32 = start * (start + 2.0 * b) + a * (1.0 / 3.0);
    let w: f32 = start - excess * slope / (3.0 * slope * slope - excess * (start + b));
    return 3.0 * d * minus_log(select(w, 1.0 - w, is_below), select(1.0 - w, w, is_below));
}

// Radius of density burley_pdf for a random number u in [0, 1): one of two exponentials, the cheapest way.
// It does not rise with u; where strata of u should stay apart take burley_quantile.
fn burley_sample(u: f32, d: f32) -> f32 {
    let share: f32 = min(max(u, 0.0), 0.99999994);
    let is_narrow: bool = share < 0.25;
    // Both the rescaled number and its complement have the digits of u
    let y: f32 = select((share - 0.25) * (4.0 / 3.0), 4.0 * share, is_narrow);
    let x: f32 = select((1.0 - share) * (4.0 / 3.0), 1.0 - 4.0 * share, is_narrow);
    return select(3.0, 1.0, is_narrow) * d * minus_log(x, y);
}
