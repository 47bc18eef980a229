//! Photon beam diffusion against a second, naive implementation: the integrals of R. Habel et al. 2013 as they
//! stand, by panels of a high-order rule over the length along the beam, with a Fresnel formula of its own.

use std::f64::consts::PI;

use translucid_profile::quadrature::{gauss_legendre, integrate};
use translucid_profile::{Medium, PhotonBeamDiffusion, Profile};

/// ∫₀^end f with panels that double in size from the smallest scale on.
fn graded(smallest: f64, end: f64, f: impl Fn(f64) -> f64) -> f64 {
    let rule = gauss_legendre(30);
    let (mut from, mut size, mut sum) = (0.0, smallest, 0.0);
    while from < end {
        let to = (from + size).min(end);
        sum += integrate(&rule, from, to, &f);
        (from, size) = (to, (2.0 * size).min(1.0));
    }
    sum
}

/// Reflectance from inside, by Snell's law and the amplitudes of both polarizations.
fn reflected(mu: f64, eta: f64) -> f64 {
    let sin_out = eta * (1.0 - mu * mu).max(0.0).sqrt();
    if sin_out >= 1.0 {
        return 1.0;
    }
    let out = (1.0 - sin_out * sin_out).sqrt();
    let perpendicular = (eta * mu - out) / (eta * mu + out);
    let parallel = (mu - eta * out) / (mu + eta * out);
    (perpendicular.powi(2) + parallel.powi(2)) / 2.0
}

/// ∫ F μⁿ dμ over the angle from the normal on both sides of the critical angle.
fn moment(eta: f64, n: i32) -> f64 {
    let rule = gauss_legendre(200);
    let f = |theta: f64| reflected(theta.cos(), eta) * theta.cos().powi(n) * theta.sin();
    let critical = (1.0 / eta).min(1.0).asin();
    // θ = θ_c − x² removes the square root at the critical angle
    let below = integrate(&rule, 0.0, critical.sqrt(), |x| 2.0 * x * f(critical - x * x));
    below + integrate(&rule, critical, PI / 2.0, f)
}

/// A material in the paper's own letters.
struct Naive {
    sigma_a: f64,
    sigma_s: f64,
    g: f64,
    eta: f64,
}

impl Naive {
    /// The integrand of multiple scattering from a real source at the depth t.
    fn dipole(&self, c: [f64; 2], t: f64, r: f64) -> f64 {
        let sigma_s = self.sigma_s * (1.0 - self.g);
        let sigma_t = self.sigma_a + sigma_s;
        let alpha = sigma_s / sigma_t;
        let d = (2.0 * self.sigma_a + sigma_s) / (3.0 * sigma_t * sigma_t);
        let s = (self.sigma_a / d).sqrt();
        let z_b = 2.0 * d * (1.0 + 3.0 * c[1]) / (1.0 - 2.0 * c[0]);
        let (c_phi, c_e) = ((1.0 - 2.0 * c[0]) / 4.0, (1.0 - 3.0 * c[1]) / 2.0);
        let (d_r, d_v) = (r.hypot(t), r.hypot(t + 2.0 * z_b));
        let phi = alpha / (4.0 * PI * d) * ((-s * d_r).exp() / d_r - (-s * d_v).exp() / d_v);
        let flux = |z: f64, d: f64| z * (1.0 + s * d) * (-s * d).exp() / d.powi(3);
        let e = alpha / (4.0 * PI) * (flux(t, d_r) + flux(t + 2.0 * z_b, d_v));
        let kappa = -(-2.0 * sigma_t * (d_r + t)).exp_m1();
        alpha * sigma_t * (-sigma_t * t).exp() * kappa * (c_phi * phi + c_e * e)
    }

    fn moments(&self) -> [f64; 2] {
        [moment(self.eta, 1), moment(self.eta, 2)]
    }

    fn multiple(&self, r: f64) -> f64 {
        let c = self.moments();
        graded(r / 8.0, 60.0, |t| self.dipole(c, t, r))
    }

    /// Light scattered at the length t along the beam, by an angle of cosine cos Θ, over the distance d, under μ.
    fn scattered(&self, t: f64, cosine: f64, d: f64, mu: f64) -> f64 {
        let (g, sigma_t) = (self.g, self.sigma_a + self.sigma_s);
        let phase = (1.0 - g * g) / (1.0 + g * g - 2.0 * g * cosine).powf(1.5) / (4.0 * PI);
        self.sigma_s * (-sigma_t * (t + d)).exp() * phase * (1.0 - reflected(mu, self.eta)) * mu / (d * d)
    }

    fn single(&self, r: f64) -> f64 {
        // t = t₀ + x² removes the square root at the critical angle
        let first = r * (self.eta * self.eta - 1.0).max(0.0).sqrt();
        graded(0.1 * r.sqrt(), 8.0, |x| {
            let t = first + x * x;
            let d = r.hypot(t);
            2.0 * x * self.scattered(t, -t / d, d, t / d)
        })
    }
}

fn close(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((found / expected - 1.0).abs() < tolerance, "{what}: {found:e} {expected:e}");
}

const MATERIALS: [[f64; 4]; 7] = [
    [0.1, 0.9, 0.0, 1.0],
    [0.0, 1.0, 0.0, 1.0],
    [0.5, 1.0, 0.5, 1.0],
    [1e-3, 0.999, 0.0, 1.4],
    [0.3, 0.5, -0.5, 0.7],
    [0.05, 4.0, 0.8, 3.0],
    [0.02, 1.0, 0.3, 1.001],
];
const RADII: [f64; 7] = [1e-6, 1e-3, 0.03, 0.3, 1.0, 4.0, 15.0];

fn for_each(check: impl Fn(&PhotonBeamDiffusion, &Naive, f64, &str)) {
    for [sigma_a, sigma_s, g, eta] in MATERIALS {
        let naive = Naive { sigma_a, sigma_s, g, eta };
        let medium = Medium::new(sigma_a, sigma_s, g).expect("valid");
        let profile = PhotonBeamDiffusion::from_medium(&medium, eta).expect("valid");
        for r in RADII {
            check(&profile, &naive, r, &format!("{sigma_a} {sigma_s} {g} {eta} at {r}"));
        }
    }
}

#[test]
fn multiple_scattering_agrees() {
    for_each(|profile, naive, r, what| {
        close(profile.multiple_scattering().eval(r), naive.multiple(r), 2e-8, what);
    });
}

#[test]
fn single_scattering_agrees() {
    for_each(|profile, naive, r, what| {
        close(profile.single_scattering().eval(r), naive.single(r), 2e-8, what);
    });
}

#[test]
fn sum_agrees() {
    for_each(|profile, naive, r, what| {
        close(profile.eval(r), naive.multiple(r) + naive.single(r), 2e-8, what);
    });
}
