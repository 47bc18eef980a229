// The faces z = 0 and, of a slab, z = thickness.

override matched: bool;

// A smooth boundary from one of its sides.
struct Interface {
    // Index on this side over that on the other.
    eta: f32,
    eta_squared: f32,
    // 1 − η².
    one_minus_eta_squared: f32,
    // Uniform buffers hold structures of whole vectors.
    unused: f32,
}

// Fresnel's reflectance for a cosine in (0, 1]; exactly 1 beyond the critical angle.
fn reflectance(mu: f32, side: Interface) -> f32 {
    let squared = plus(times(times(mu, mu), side.eta_squared), side.one_minus_eta_squared);
    if (squared <= 0.0) {
        return 1.0;
    }
    let refracted = root(min(squared, 1.0));
    let a = times(mu, side.eta);
    let b = times(refracted, side.eta);
    let perpendicular = times(plus(a, -refracted), reciprocal(plus(a, refracted)));
    let parallel = times(plus(b, -mu), reciprocal(plus(b, mu)));
    return 0.5 * plus(times(perpendicular, perpendicular), times(parallel, parallel));
}

fn is_outside(z: f32) -> bool {
    return z < 0.0 || z > settings.thickness;
}
