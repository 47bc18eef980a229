//! The dipoles and quantized diffusion against a second implementation: the papers' formulas written down as they
//! stand, in millimeters, with every integral by adaptive quadrature. No code is shared with the crate.

use std::f64::consts::PI;

use translucid_profile::{
    Appearance, BetterDipole, Medium, Parameterization, Profile, QuantizedDiffusion, StandardDipole,
};

/// ∫ f from a to b by Simpson's rule, halved until two refinements agree to `tolerance`.
fn adaptive(f: &dyn Fn(f64) -> f64, a: f64, b: f64, tolerance: f64) -> f64 {
    fn simpson(width: f64, values: [f64; 3]) -> f64 {
        width / 6.0 * (values[0] + 4.0 * values[1] + values[2])
    }
    fn refine(f: &dyn Fn(f64) -> f64, ends: [f64; 2], values: [f64; 3], tolerance: f64, depth: u32) -> f64 {
        let middle = 0.5 * (ends[0] + ends[1]);
        let quarters = [f(0.5 * (ends[0] + middle)), f(0.5 * (middle + ends[1]))];
        let (left, right) = ([values[0], quarters[0], values[1]], [values[1], quarters[1], values[2]]);
        let half = 0.5 * (ends[1] - ends[0]);
        let coarse = simpson(ends[1] - ends[0], values);
        let fine = simpson(half, left) + simpson(half, right);
        if depth == 0 || (fine - coarse).abs() < 15.0 * tolerance {
            return fine + (fine - coarse) / 15.0;
        }
        refine(f, [ends[0], middle], left, 0.5 * tolerance, depth - 1)
            + refine(f, [middle, ends[1]], right, 0.5 * tolerance, depth - 1)
    }
    // Eight panels to start with, so that no narrow feature hides between three points
    let edge = |i: i32| a + (b - a) * f64::from(i) / 8.0;
    (0..8)
        .map(|i| {
            let ends = [edge(i), edge(i + 1)];
            let values = [f(ends[0]), f(0.5 * (ends[0] + ends[1])), f(ends[1])];
            refine(f, ends, values, tolerance / 8.0, 40)
        })
        .sum()
}

#[test]
fn adaptive_integrates_what_is_known() {
    assert!((adaptive(&|x| x.sin(), 0.0, PI, 1e-13) - 2.0).abs() < 1e-12);
    assert!((adaptive(&|x| (-x).exp() / (1.0 + x), 0.0, 40.0, 1e-13) - 0.596347362323194).abs() < 1e-12);
}

/// ∫₀¹ F(μ) μⁿ dμ of light that comes from inside, by Snell's law and Fresnel's formulas.
fn moment_from_inside(eta: f64, n: i32) -> f64 {
    let reflectance = |mu: f64| {
        let sine = eta * (1.0 - mu * mu).max(0.0).sqrt();
        if sine >= 1.0 {
            return 1.0;
        }
        let mu_out = (1.0 - sine * sine).sqrt();
        let s = (eta * mu - mu_out) / (eta * mu + mu_out);
        let p = (eta * mu_out - mu) / (eta * mu_out + mu);
        if mu == 0.0 { 1.0 } else { 0.5 * (s * s + p * p) }
    };
    let critical = (1.0 - 1.0 / (eta * eta)).max(0.0).sqrt();
    // Total reflection in closed form; squares take the root out of the rest
    let total = critical.powi(n + 1) / f64::from(n + 1);
    let rest = |u: f64| {
        let mu = critical + (1.0 - critical) * u * u;
        reflectance(mu) * mu.powi(n) * 2.0 * (1.0 - critical) * u
    };
    total + adaptive(&rest, 0.0, 1.0, 1e-14)
}

/// A medium in 1/mm with a boundary.
#[derive(Clone, Copy, Debug)]
struct Tissue {
    sigma_a: f64,
    sigma_s_prime: f64,
    c_1: f64,
    c_2: f64,
}

impl Tissue {
    fn new(sigma_a: f64, sigma_s: f64, g: f64, eta: f64) -> Self {
        let (c_1, c_2) = (moment_from_inside(eta, 1), moment_from_inside(eta, 2));
        Self { sigma_a, sigma_s_prime: sigma_s * (1.0 - g), c_1, c_2 }
    }

    fn sigma_t_prime(&self) -> f64 {
        self.sigma_a + self.sigma_s_prime
    }

    fn alpha_prime(&self) -> f64 {
        self.sigma_s_prime / self.sigma_t_prime()
    }

    /// Jensen et al. 2001, equation 4.
    fn standard_dipole(&self, r: f64) -> f64 {
        let diffusion = 1.0 / (3.0 * self.sigma_t_prime());
        let sigma_tr = (3.0 * self.sigma_a * self.sigma_t_prime()).sqrt();
        let f_dr = 2.0 * self.c_1;
        let z_r = 1.0 / self.sigma_t_prime();
        let z_v = z_r + 4.0 * (1.0 + f_dr) / (1.0 - f_dr) * diffusion;
        let d_r = r.hypot(z_r);
        let d_v = r.hypot(z_v);
        let real = z_r * (sigma_tr * d_r + 1.0) * (-sigma_tr * d_r).exp() / d_r.powi(3);
        let image = z_v * (sigma_tr * d_v + 1.0) * (-sigma_tr * d_v).exp() / d_v.powi(3);
        self.alpha_prime() / (4.0 * PI) * (real + image)
    }

    /// The better dipole of d'Eon 2012 without its α'², its source at the depth z.
    fn grosjean_dipole(&self, r: f64, z: f64) -> f64 {
        let diffusion = (2.0 * self.sigma_a + self.sigma_s_prime) / (3.0 * self.sigma_t_prime().powi(2));
        let sigma_tr = (self.sigma_a / diffusion).sqrt();
        let a_f = (1.0 + 3.0 * self.c_2) / (1.0 - 2.0 * self.c_1);
        let c_phi = 0.25 * (1.0 - 2.0 * self.c_1);
        let c_e = 0.5 * (1.0 - 3.0 * self.c_2);
        let z_v = z + 4.0 * a_f * diffusion;
        let d_r = r.hypot(z);
        let d_v = r.hypot(z_v);
        let fluence = ((-sigma_tr * d_r).exp() / d_r - (-sigma_tr * d_v).exp() / d_v) / diffusion;
        let real = z * (1.0 + sigma_tr * d_r) * (-sigma_tr * d_r).exp() / d_r.powi(3);
        let image = z_v * (1.0 + sigma_tr * d_v) * (-sigma_tr * d_v).exp() / d_v.powi(3);
        (c_phi * fluence + c_e * (real + image)) / (4.0 * PI)
    }

    fn better_dipole(&self, r: f64) -> f64 {
        self.alpha_prime().powi(2) * self.grosjean_dipole(r, 1.0 / self.sigma_t_prime())
    }

    /// Quantized diffusion in the limit of quanta without extent: the sum over the beam's depths.
    fn beam(&self, r: f64) -> f64 {
        let sigma_t = self.sigma_t_prime();
        // z = e^x: depths of the order of r and of the mean free path alike
        let at = |x: f64| {
            let z = x.exp();
            z * sigma_t * (-sigma_t * z).exp() * self.grosjean_dipole(r, z)
        };
        let scale = at((r.min(1.0 / sigma_t)).ln());
        self.alpha_prime().powi(2) * adaptive(&at, -30.0, (50.0 / sigma_t).ln(), 1e-10 * scale)
    }
}

/// ∫ 2πr R dr between two radii, over ln r.
fn energy(profile: &dyn Fn(f64) -> f64, from: f64, to: f64, tolerance: f64) -> f64 {
    let ring = |x: f64| 2.0 * PI * (2.0 * x).exp() * profile(x.exp());
    adaptive(&ring, from.ln(), to.ln(), tolerance)
}

/// (σ_a, σ_s) in 1/mm, g, η and the radius in mm.
const SPOTS: [[f64; 5]; 7] = [
    [0.0021, 2.19, 0.0, 1.5, 0.3],
    [0.0021, 2.19, 0.0, 1.5, 12.0],
    [0.3, 0.7, 0.0, 1.0, 0.02],
    [0.3, 0.7, 0.0, 1.0, 4.0],
    [0.01, 20.0, 0.9, 1.33, 1.0],
    [5.0, 3.0, -0.5, 1.4, 0.1],
    [0.1, 4.0, 0.4, 0.8, 2.0],
];

/// Worst relative difference of a profile from the naive one over the spots.
fn worst(
    naive: fn(&Tissue, f64) -> f64,
    from_medium: fn(&Medium, f64) -> Box<dyn Profile>,
) -> (f64, [f64; 5]) {
    let off = |[sigma_a, sigma_s, g, eta, r]: [f64; 5]| {
        let expected = naive(&Tissue::new(sigma_a, sigma_s, g, eta), r);
        let found = from_medium(&Medium::new(sigma_a, sigma_s, g).unwrap(), eta).eval(r);
        (found / expected - 1.0).abs()
    };
    SPOTS.map(|spot| (off(spot), spot)).into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
}

#[test]
fn standard_dipole_is_the_naive_one() {
    let (off, spot) = worst(Tissue::standard_dipole, |medium, eta| {
        Box::new(StandardDipole::from_medium(medium, eta).unwrap())
    });
    assert!(off < 1e-12, "{off:e} at {spot:?}");
}

#[test]
fn better_dipole_is_the_naive_one() {
    let (off, spot) =
        worst(Tissue::better_dipole, |medium, eta| Box::new(BetterDipole::from_medium(medium, eta).unwrap()));
    assert!(off < 1e-12, "{off:e} at {spot:?}");
}

/// The tolerance is what 40 Gaussians leave.
#[test]
fn quantized_diffusion_is_the_naive_beam() {
    let (off, spot) =
        worst(Tissue::beam, |medium, eta| Box::new(QuantizedDiffusion::from_medium(medium, eta).unwrap()));
    assert!(off < 1e-4, "{off:e} at {spot:?}");
}

/// Energies by quadrature of the naive profiles, which have no closed integral here.
#[test]
fn energies_are_integrals_of_the_naive_profiles() {
    let (sigma_a, sigma_s, g, eta) = (0.3, 1.5, 0.2, 1.33);
    let tissue = Tissue::new(sigma_a, sigma_s, g, eta);
    let medium = Medium::new(sigma_a, sigma_s, g).unwrap();
    let check = |naive: &dyn Fn(f64) -> f64, profile: &dyn Profile, tolerance: f64| {
        let within = energy(naive, 1e-9, 0.8, 0.1 * tolerance);
        let beyond = energy(naive, 0.8, 100.0, 0.1 * tolerance);
        assert!((profile.enclosed(0.8) - within).abs() < tolerance, "{} {within}", profile.enclosed(0.8));
        assert!((profile.beyond(0.8) - beyond).abs() < tolerance, "{} {beyond}", profile.beyond(0.8));
        assert!(
            (profile.surface_albedo() - within - beyond).abs() < 2.0 * tolerance,
            "{}",
            profile.surface_albedo()
        );
    };
    let standard = StandardDipole::from_medium(&medium, eta).unwrap();
    check(&|r| tissue.standard_dipole(r), &standard, 1e-11);
    let better = BetterDipole::from_medium(&medium, eta).unwrap();
    check(&|r| tissue.better_dipole(r), &better, 1e-11);
    let quantized = QuantizedDiffusion::from_medium(&medium, eta).unwrap();
    check(&|r| tissue.beam(r), &quantized, 1e-6);
}

/// From a surface albedo: the naive way bisects on the numerical integral of the naive profile.
#[test]
fn new_is_the_naive_inversion() {
    let (surface_albedo, mfp, g, eta) = (0.6, 0.5, 0.3, 1.4);
    let tissue = |alpha: f64| Tissue::new((1.0 - alpha) / mfp, alpha / mfp, g, eta);
    let bisect = |naive: fn(&Tissue, f64) -> f64| {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..45 {
            let alpha = 0.5 * (low + high);
            let t = tissue(alpha);
            let total = energy(&|r| naive(&t, r), 1e-7, 1e4, 1e-12);
            *(if total < surface_albedo { &mut low } else { &mut high }) = alpha;
        }
        tissue(low)
    };
    let appearance = Appearance { surface_albedo, length: mfp, parameterization: Parameterization::Mfp, g };
    let standard = StandardDipole::new(&appearance, eta).unwrap();
    let better = BetterDipole::new(&appearance, eta).unwrap();
    let (naive_standard, naive_better) = (bisect(Tissue::standard_dipole), bisect(Tissue::better_dipole));
    for r in [0.01, 0.2, 1.0, 5.0, 20.0] {
        let (found, expected) = (standard.eval(r), naive_standard.standard_dipole(r));
        assert!((found / expected - 1.0).abs() < 1e-9, "{r}: {found} {expected}");
        let (found, expected) = (better.eval(r), naive_better.better_dipole(r));
        assert!((found / expected - 1.0).abs() < 1e-9, "{r}: {found} {expected}");
    }
}
