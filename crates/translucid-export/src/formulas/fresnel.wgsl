// Reflectance of a smooth dielectric for unpolarized light from outside; eta = n_inside / n_outside in [0.05, 20].
fn fresnel_from_outside(cos_theta: f32, eta: f32) -> f32 {
    let m: f32 = min(abs(cos_theta), 1.0);
    // eta^2 - 1; near eta = 1 both numerators are written as multiples of it, so that no digit is lost
    let e: f32 = (eta - 1.0) * (eta + 1.0);
    let transmitted: f32 = e + m * m;
    let t: f32 = sqrt(max(transmitted, 0.0));
    let sum: f32 = max(m + t, 1e-9);
    let perpendicular: f32 = e / (sum * sum);
    let product: f32 = eta * eta * m;
    let weighted: f32 = max(product + t, 1e-9);
    let near_one: f32 = e * ((eta * eta + 1.0) * m * m - 1.0) / (weighted * weighted);
    let parallel: f32 = select((product - t) / weighted, near_one, abs(e) < 0.3);
    let f: f32 = min(0.5 * (perpendicular * perpendicular + parallel * parallel), 1.0);
    // Light that grazes or is beyond the critical angle is reflected whole
    return select(select(f, 1.0, transmitted <= 0.0 || m <= 0.0), 0.0, eta == 1.0);
}

// Reflectance for light from inside; cos_theta is that of the angle inside. 1 beyond the critical angle.
fn fresnel_from_inside(cos_theta: f32, eta: f32) -> f32 {
    return fresnel_from_outside(cos_theta, 1.0 / eta);
}

// Schlick's approximation of fresnel_from_outside for eta >= 1: off by at most 0.025 up to 60 degrees and 0.114 beyond.
fn fresnel_schlick(cos_theta: f32, eta: f32) -> f32 {
    let root: f32 = (eta - 1.0) / (eta + 1.0);
    let m: f32 = 1.0 - min(abs(cos_theta), 1.0);
    let fifth: f32 = m * m * (m * m) * m;
    return select(root * root + (1.0 - root * root) * fifth, 0.0, eta == 1.0);
}
