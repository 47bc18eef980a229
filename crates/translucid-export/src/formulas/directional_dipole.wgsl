// A directional dipole: constants of its medium and boundary, lengths in transport mean free paths.
struct DirectionalDipole {
    // C_phi and C_E of the boundary, and n_inside/n_outside
    fluence: f32,
    flux: f32,
    eta: f32,
    // sigma_tr, extrapolation length, height of the virtual source over the entry point
    sigma_tr: f32,
    extrapolation: f32,
    mirror: f32,
    // Square of how far the real source is off an exit point towards whose outside light is refracted
    back_lit: f32,
    // Part of the light that entered which the source emits
    strength: f32,
}

// The dipole of a medium with 1 - alpha' = root^2 and sigma_t'/sigma_t = reduction, under a boundary whose A is mismatch.
fn directional_dipole(root: f32, alpha_prime: f32, reduction: f32, fluence: f32, flux: f32, mismatch: f32, eta: f32) -> DirectionalDipole {
    var dipole: DirectionalDipole;
    dipole.fluence = fluence;
    dipole.flux = flux;
    dipole.eta = eta;
    dipole.sigma_tr = ${dipole.root_3} * root;
    dipole.extrapolation = ${dipole.extrapolation} / sqrt(max(alpha_prime, 1e-12));
    dipole.mirror = 2.0 * mismatch * dipole.extrapolation;
    dipole.back_lit = reduction * reduction / 9.0;
    dipole.strength = alpha_prime;
    return dipole;
}

// Fluence and flux of one source, which is d away and leaves e of the light.
fn dipole_source(dipole: DirectionalDipole, d: f32, e: f32, x_omega: f32, x_n: f32, omega_n: f32) -> f32 {
    let inverse: f32 = 1.0 / d;
    let e_over_d: f32 = e * inverse;
    let p: f32 = (1.0 + dipole.sigma_tr * d) * e_over_d * inverse * inverse;
    let quadrupole: f32 = (3.0 * p + dipole.sigma_tr * dipole.sigma_tr * e_over_d) * (x_omega * inverse) * (x_n * inverse);
    return 3.0 * dipole.fluence * p * x_omega + dipole.flux * (p * x_n + quadrupole - p * omega_n);
}

// R times the square of the transport mean free path, at x from the entry [transport mean free paths]. `light` points to where
// light comes from; it and the normals at entry and exit are unit vectors.
fn directional_dipole_eval(dipole: DirectionalDipole, x: vec3f, light: vec3f, n_i: vec3f, n_o: vec3f) -> f32 {
    let mu: f32 = dot(light, n_i);
    // (eta mu_t)^2, in the form that keeps its digits near eta = 1
    let square: f32 = (dipole.eta - 1.0) * (dipole.eta + 1.0) + mu * mu;
    if (!(mu > 0.0 && square > 0.0)) {
        return 0.0;
    }
    let omega: vec3f = ((mu - sqrt(square)) * n_i - light) / dipole.eta;

    // Mirror in the plane through both points that is nearest to the entry's tangent plane
    let far: f32 = max(length(x), 1e-18);
    let along: vec3f = x / far;
    let across: vec3f = n_i - dot(along, n_i) * along;
    let sine_squared: f32 = dot(across, across);
    // Where x is along the normal, the mean of all planes lies across the beam
    var normal: vec3f = cross(n_i, omega);
    if (dot(normal, normal) < 1e-12) {
        normal = cross(n_i, select(vec3f(0.0, 1.0, 0.0), vec3f(1.0, 0.0, 0.0), abs(n_i.x) < 0.7));
    }
    normal = select(normalize(normal), across / sqrt(max(sine_squared, 1e-12)), sine_squared > 1e-12);
    let star_omega: f32 = dot(normal, omega);
    let star_n: f32 = dot(normal, n_o);
    let x_omega: f32 = dot(x, omega);
    let x_n: f32 = dot(x, n_o);
    let omega_n: f32 = dot(omega, n_o);

    // Distances of the two sources; the virtual one is the farther
    let sideways: vec3f = cross(x, omega);
    let d_e: f32 = dipole.extrapolation;
    let minus_cos_beta: f32 = length(sideways) / sqrt(far * far + d_e * d_e);
    let depth: f32 = omega_n * (omega_n / 3.0 - 2.0 * d_e * minus_cos_beta) / 3.0;
    let z2: f32 = select(dipole.back_lit, depth, omega_n < 0.0);
    let h: f32 = dipole.mirror;
    let d_r: f32 = max(sqrt(far * far + z2), 1e-9);
    let d_v: f32 = sqrt(far * far + h * h);
    let gap: f32 = (h * h - z2) / (d_v + d_r);

    // What is left of the light, and the difference of the two fluences, with its digits
    let e_r: f32 = exp(-dipole.sigma_tr * d_r);
    let less: f32 = one_minus_exp(dipole.sigma_tr * gap);
    let monopoles: f32 = e_r * (gap / d_r + less) / d_v;
    let rest: f32 = dipole_source(dipole, d_r, e_r, x_omega, x_n, omega_n)
        - dipole_source(dipole, d_v, e_r * (1.0 - less), x_omega + h * star_omega, x_n - h * star_n, omega_n - 2.0 * star_omega * star_n);
    return max(3.0 * dipole.fluence * monopoles + rest, 0.0) * dipole.strength * (0.5 * ${inverse_two_pi});
}
