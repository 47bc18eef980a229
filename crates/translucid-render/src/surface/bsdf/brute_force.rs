//! Directional albedos of rough interfaces by brute force, for tests.

use std::f64::consts::TAU;

/// Cosines between the tables' nodes.
pub(super) const COSINES: [f64; 9] = [0.003, 0.013, 0.04, 0.11, 0.23, 0.41, 0.63, 0.85, 1.0];
/// Roughnesses between the tables' nodes.
pub(super) const ROUGHNESSES: [f64; 9] = [0.04, 0.07, 0.13, 0.21, 0.33, 0.52, 0.71, 0.88, 1.0];

fn fresnel(cos: f64, eta: f64) -> f64 {
    let sin2 = (1.0 - cos * cos) / (eta * eta);
    if sin2 >= 1.0 {
        return 1.0;
    }
    let cos_t = (1.0 - sin2).sqrt();
    let s = (cos - eta * cos_t) / (cos + eta * cos_t);
    let p = (eta * cos - cos_t) / (eta * cos + cos_t);
    0.5 * (s * s + p * p)
}

fn lambda(cos: f64, alpha: f64) -> f64 {
    0.5 * ((1.0 + alpha * alpha * (1.0 / (cos * cos) - 1.0)).sqrt() - 1.0)
}

/// Reflected and transmitted fractions by brute force: facets drawn from D cosθ, in double precision.
pub(super) fn brute_force(mu: f64, roughness: f64, eta: f64) -> (f64, f64) {
    let alpha = roughness * roughness;
    let wo = [(1.0 - mu * mu).sqrt(), mu];
    let (n, m) = (300, 120);
    let (mut reflected, mut transmitted) = (0.0, 0.0);
    for i in 0..n {
        // Denser toward u = 1, where the facets stand steep.
        let x = (f64::from(i) + 0.5) / f64::from(n);
        let (u, slope) = (x * x * (3.0 - 2.0 * x), 6.0 * x * (1.0 - x));
        let tan2 = alpha * alpha * u / (1.0 - u);
        let hz = 1.0 / (1.0 + tan2).sqrt();
        let hr = (1.0 - hz * hz).max(0.0).sqrt();
        for j in 0..m {
            let hx = hr * ((f64::from(j) + 0.5) / f64::from(m) * TAU / 2.0).cos();
            let c = wo[0] * hx + wo[1] * hz;
            if c <= 0.0 {
                continue;
            }
            let f = fresnel(c, eta);
            let weight = slope * c / (mu * hz);
            let up = 2.0 * c * hz - mu;
            if up > 0.0 {
                reflected += f * weight / (1.0 + lambda(mu, alpha) + lambda(up, alpha));
            }
            let g2 = eta * eta - 1.0 + c * c;
            if f < 1.0 && g2 > 0.0 {
                let down = (mu - (c - g2.sqrt()) * hz) / eta;
                if down > 0.0 {
                    transmitted += (1.0 - f) * weight / (1.0 + lambda(mu, alpha) + lambda(down, alpha));
                }
            }
        }
    }
    let count = f64::from(n * m);
    (reflected / count, transmitted / count)
}
