//! The directional dipole against a second, naive implementation, from the derivation rather than from the
//! formula.
//!
//! The fluence of a directed source in an infinite medium is that of a point source, e^{−σd}/(4πDd), less the
//! distance 1/σ'_t times its slope along the direction. Exitance is C_φ φ − C_E D ∂φ/∂n. Here both slopes are
//! central differences of that one function, sources sit where the paper puts them, the mirrored direction is that
//! of a mirrored point, and the moments of the reflectance are sums.

use std::f64::consts::PI;

use translucid_profile::{DirectionalDipole, DirectionalDipoleAverage, Medium, Profile};

type Vector = [f64; 3];

fn add(a: Vector, scale: f64, b: Vector) -> Vector {
    [a[0] + scale * b[0], a[1] + scale * b[1], a[2] + scale * b[2]]
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn normalize(a: Vector) -> Vector {
    a.map(|c| c / dot(a, a).sqrt())
}

/// Reflectance of light from inside at the cosine μ, by the amplitudes of both polarizations.
fn reflectance_from_inside(mu: f64, eta: f64) -> f64 {
    let sine_outside = eta * (1.0 - mu * mu).sqrt();
    if sine_outside >= 1.0 {
        return 1.0;
    }
    let mu_outside = (1.0 - sine_outside * sine_outside).sqrt();
    let across = (eta * mu - mu_outside) / (eta * mu + mu_outside);
    let along = (mu - eta * mu_outside) / (mu + eta * mu_outside);
    0.5 * (across * across + along * along)
}

/// ∫₀¹ F μⁿ dμ by the midpoint rule.
fn moment(eta: f64, n: i32) -> f64 {
    let count = 1_000_000;
    let at = |i: i32| (f64::from(i) + 0.5) / f64::from(count);
    (0..count).map(|i| reflectance_from_inside(at(i), eta) * at(i).powi(n)).sum::<f64>() / f64::from(count)
}

struct Naive {
    sigma_a: f64,
    sigma_s: f64,
    g: f64,
    eta: f64,
}

/// Arguments of a question: offset, direction to the light, normals at entry and exit.
type Question = [Vector; 4];

impl Naive {
    /// Four-point central difference; the step is large for accuracy of 1e-9, as the function is smooth.
    fn slope(f: impl Fn(Vector) -> f64, at: Vector, along: Vector, step: f64) -> f64 {
        let f = |k: f64| f(add(at, k * step, along));
        (8.0 * (f(1.0) - f(-1.0)) - (f(2.0) - f(-2.0))) / (12.0 * step)
    }

    /// Exitance of a directed source at the vector `from_source`, as if the distance to it were `distance` there:
    /// the paper takes formulas in d and x·ω and then replaces d.
    fn source(&self, from_source: Vector, omega: Vector, distance: f64, n_o: Vector) -> f64 {
        let sigma_t_prime = self.sigma_a + (1.0 - self.g) * self.sigma_s;
        let d = 1.0 / (3.0 * sigma_t_prime);
        let sigma_tr = (self.sigma_a / d).sqrt();
        // The squared distance is longer by a constant, for every position
        let extra = distance * distance - dot(from_source, from_source);
        let point = |x: Vector| {
            let r = (dot(x, x) + extra).sqrt();
            (-sigma_tr * r).exp() / (4.0 * PI * d * r)
        };
        let step = 1e-3 * distance;
        let fluence = |x: Vector| point(x) - Self::slope(point, x, omega, step) / sigma_t_prime;
        let flux = -d * Self::slope(fluence, from_source, n_o, step);
        let (c_1, c_2) = (moment(self.eta, 1), moment(self.eta, 2));
        0.25 * (1.0 - 2.0 * c_1) * fluence(from_source) + 0.5 * (1.0 - 3.0 * c_2) * flux
    }

    fn eval(&self, [offset, omega_i, n_i, n_o]: Question) -> f64 {
        let sigma_s_prime = (1.0 - self.g) * self.sigma_s;
        let sigma_t_prime = self.sigma_a + sigma_s_prime;
        let alpha_prime = sigma_s_prime / sigma_t_prime;
        let d = 1.0 / (3.0 * sigma_t_prime);
        let d_e = 2.131 * d / alpha_prime.sqrt();
        let (c_1, c_2) = (moment(self.eta, 1), moment(self.eta, 2));
        let reflection = (1.0 + 3.0 * c_2) / (1.0 - 2.0 * c_1);

        // Snell's law for the angle
        let sideways = add(omega_i, -dot(omega_i, n_i), n_i);
        let sine = dot(sideways, sideways).sqrt() / self.eta;
        let omega = if sine > 0.0 {
            add(normalize(sideways).map(|c| -sine * c), -sine.asin().cos(), n_i)
        } else {
            n_i.map(|c| -c)
        };

        let r = dot(offset, offset).sqrt();
        let n_star = cross(normalize(offset), normalize(cross(n_i, offset)));
        let mirror = |v: Vector| add(v, -2.0 * dot(v, n_star), n_star);
        let mu_0 = -dot(omega, n_o);
        let d_r = if mu_0 > 0.0 {
            let along = dot(offset, omega);
            let cos_beta = -((r * r - along * along) / (r * r + d_e * d_e)).sqrt();
            (r * r + d * mu_0 * (d * mu_0 - 2.0 * d_e * cos_beta)).sqrt()
        } else {
            (r * r + 1.0 / (9.0 * (self.sigma_a + self.sigma_s).powi(2))).sqrt()
        };
        let from_virtual = add(offset, -2.0 * reflection * d_e, n_star);
        let d_v = dot(from_virtual, from_virtual).sqrt();
        alpha_prime
            * (self.source(offset, omega, d_r, n_o) - self.source(from_virtual, mirror(omega), d_v, n_o))
    }
}

/// The derivation is that of a source at the distance |x|: where the distance is replaced the slopes are those of
/// the replaced formula with the vector as it is, which the naive one has by its constant excess.
#[test]
fn eval_agrees_with_the_derivation() {
    let up = [0.0, 0.0, 1.0];
    let media = [
        Naive { sigma_a: 0.1, sigma_s: 0.9, g: 0.0, eta: 1.4 },
        Naive { sigma_a: 0.02, sigma_s: 3.0, g: 0.7, eta: 1.3 },
        Naive { sigma_a: 0.5, sigma_s: 0.6, g: -0.4, eta: 1.0 },
        Naive { sigma_a: 1e-3, sigma_s: 0.4, g: 0.2, eta: 0.8 },
    ];
    let questions: [Question; 6] = [
        [[0.7, 0.0, 0.0], normalize([-1.0, 0.0, 1.0]), up, up],
        [[-0.3, 0.4, 0.0], normalize([0.5, -0.2, 1.0]), up, up],
        // Normals that differ, the exit below the entry's plane
        [[0.5, 0.6, -0.4], normalize([-0.3, 0.4, 0.9]), up, normalize([0.3, 0.1, 1.0])],
        [
            [0.2, -0.1, 0.3],
            normalize([0.1, 0.2, 1.0]),
            normalize([0.1, -0.2, 1.0]),
            normalize([-0.2, 0.4, 0.8]),
        ],
        // The other side of a thin sheet
        [[0.3, 0.2, -1.1], normalize([-0.2, 0.3, 1.0]), up, [0.0, 0.0, -1.0]],
        [[1.5, 0.0, -2.0], normalize([-0.5, 0.1, 1.0]), up, normalize([1.0, 0.2, -0.3])],
    ];
    for medium in &media {
        let Naive { sigma_a, sigma_s, g, eta } = *medium;
        let dipole = DirectionalDipole::from_medium(&Medium::new(sigma_a, sigma_s, g).unwrap(), eta).unwrap();
        for question in questions {
            let [offset, omega_i, n_i, n_o] = question;
            let found = dipole.eval_unclamped(offset, omega_i, n_i, n_o);
            let expected = medium.eval(question);
            let off = (found - expected).abs();
            assert!(off < 1e-7 * expected.abs() + 1e-9, "{eta} {question:?}: {found} {expected}");
            assert_eq!(dipole.eval(offset, omega_i, n_i, n_o), found.max(0.0));
        }
    }
}

/// Figures that the naive implementation printed, as a net under both.
#[test]
fn eval_has_its_spot_values() {
    let up = [0.0, 0.0, 1.0];
    let medium = Medium::new(0.1, 0.9, 0.0).unwrap();
    let dipole = DirectionalDipole::from_medium(&medium, 1.4).unwrap();
    let spots: [(Question, f64); 5] = [
        ([[0.7, 0.0, 0.0], [-1.0, 0.0, 1.0], up, up], 5.05492286e-2),
        ([[-0.3, 0.4, 0.0], [0.5, -0.2, 1.0], up, up], 7.02296812e-2),
        ([[0.5, 0.6, -0.4], [-0.3, 0.4, 0.9], up, [0.3, 0.1, 1.0]], 2.66538494e-2),
        ([[0.3, 0.2, -1.1], [-0.2, 0.3, 1.0], up, [0.0, 0.0, -1.0]], 5.33242907e-2),
        ([[1.5, 0.0, -2.0], [-0.5, 0.1, 1.0], up, [1.0, 0.2, -0.3]], 7.90769650e-3),
    ];
    for ([offset, omega_i, n_i, n_o], expected) in spots {
        let found = dipole.eval(offset, omega_i, n_i, n_o);
        assert!((found / expected - 1.0).abs() < 1e-8, "{offset:?}: {found:e} {expected:e}");
    }
}

/// The naive model at normal incidence, integrated by a sum over radii.
#[test]
fn average_agrees_with_the_derivation() {
    let naive = Naive { sigma_a: 0.2, sigma_s: 0.8, g: 0.0, eta: 1.2 };
    let profile = DirectionalDipoleAverage::from_medium(&Medium::new(0.2, 0.8, 0.0).unwrap(), 1.2).unwrap();
    let up = [0.0, 0.0, 1.0];
    for r in [0.05, 0.3, 1.0, 4.0] {
        let expected = naive.eval([[r, 0.0, 0.0], up, up, up]);
        assert!((profile.eval(r) / expected - 1.0).abs() < 1e-7, "{r}: {} {expected}", profile.eval(r));
    }
}
