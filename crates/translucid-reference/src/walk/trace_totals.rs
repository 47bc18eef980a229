//! Laws of the walk's totals: how many photons leave, after how many collisions.
//!
//! The expectations are computed here, from closed forms and from Chandrasekhar's H-function as an integral; the
//! crate's exact solution has no part in them.

use std::f64::consts::FRAC_PI_2;

use num_complex::Complex64;
use translucid_profile::quadrature::gauss_legendre;

use super::chi_square::{deviate, deviate_of_count, deviate_of_counts};
use super::{Parameters, PhaseFunction, PhotonCounts, Problem, Side, trace};
use crate::Incidence;

/// Exits by order of scattering (the last bin takes the rest), of both faces together.
fn orders<const N: usize>(
    parameters: Parameters,
    albedo: f64,
    seed: u64,
    photons: u64,
) -> ([u64; N], PhotonCounts) {
    let mut orders = [0; N];
    let problem = Problem::new(parameters).unwrap();
    let counts = trace(&problem, albedo, seed, 0..photons, &mut |exits| {
        for exit in exits {
            orders[(exit.order as usize).min(N - 1)] += 1;
        }
    });
    (orders, counts)
}

/// Nodes and weights for [0, π/2], in panels that shrink towards π/2, where the integrand of [`h`] is steep.
fn graded_rule() -> Vec<(f64, f64)> {
    let rule = gauss_legendre(12);
    let edge = |k: i32| FRAC_PI_2 * (1.0 - 0.5f64.powi(k));
    (0..24)
        .flat_map(|k| {
            let (from, to) = (edge(k), if k == 23 { FRAC_PI_2 } else { edge(k + 1) });
            let half = 0.5 * (to - from);
            rule.clone().into_iter().map(move |(x, w)| (from + half * (1.0 + x), half * w))
        })
        .collect()
}

/// H(μ) of isotropic scattering, for a complex albedo inside the unit circle.
///
/// ```text
/// ln H(μ) = −(μ/π) ∫₀^{π/2} ln(1 − α θ cot θ)/(cos²θ + μ² sin²θ) dθ
/// ```
///
/// S. Chandrasekhar, *Radiative Transfer*, 1950, §39, with t = tan θ.
fn h(alpha: Complex64, mu: f64, rule: &[(f64, f64)]) -> Complex64 {
    let sum: Complex64 = rule
        .iter()
        .map(|&(theta, weight)| {
            let (sine, cosine) = theta.sin_cos();
            let log = (1.0 - alpha * (theta * cosine / sine)).ln();
            weight * log / (cosine * cosine + mu * mu * sine * sine)
        })
        .sum();
    (-mu / std::f64::consts::PI * sum).exp()
}

/// R of a half space of isotropic scatterers, η = 1, as an analytic function of the albedo.
///
/// Pencil: 1 − H(1) √(1−α). Cosine: 1 − 2 √(1−α) ∫₀¹ μ H dμ.
fn half_space(incidence: Incidence, alpha: Complex64) -> Complex64 {
    let rule = graded_rule();
    let root = (1.0 - alpha).sqrt();
    match incidence {
        Incidence::Cosine => {
            // μ = v² smooths the logarithm at μ = 0
            let nodes = gauss_legendre(24).into_iter().map(|(x, w)| (0.5 * (1.0 + x), 0.5 * w));
            let moment: Complex64 = nodes.map(|(v, w)| 2.0 * v * w * v * v * h(alpha, v * v, &rule)).sum();
            1.0 - 2.0 * root * moment
        }
        _ => 1.0 - root * h(alpha, 1.0, &rule),
    }
}

/// P₁…P₂₀ in R(α) = Σ Pₙ αⁿ, by Cauchy's integral over |α| = ½: 64 points repeat P₆₅ in P₁ with 2⁻⁶⁴.
fn orders_of_half_space(incidence: Incidence) -> [f64; 20] {
    let points = 64;
    let values: Vec<(Complex64, Complex64)> = (0..points)
        .map(|k| {
            let turn = Complex64::cis(std::f64::consts::TAU * f64::from(k) / f64::from(points));
            (turn, half_space(incidence, 0.5 * turn))
        })
        .collect();
    std::array::from_fn(|i| {
        let n = i as i32 + 1;
        let sum: Complex64 = values.iter().map(|&(turn, value)| value * turn.powi(-n)).sum();
        sum.re / f64::from(points) * 2f64.powi(n)
    })
}

/// Expected counts of the orders 1…20 out of so many photons.
fn expected(orders: &[f64; 20], albedo: f64, photons: u64) -> Vec<f64> {
    orders.iter().zip(1..).map(|(p, n)| photons as f64 * p * albedo.powi(n)).collect()
}

#[test]
fn expectations_equal_known_numbers() {
    // physics.md §3
    let [searchlight, diffuse] = [Incidence::NORMAL, Incidence::Cosine].map(orders_of_half_space);
    assert!((searchlight[0] - 0.5 * (1.0 - std::f64::consts::LN_2)).abs() < 1e-11, "{searchlight:?}");
    assert!((searchlight[1] - 0.0972733365).abs() < 1e-10);
    assert!((diffuse[0] - 0.2045685463).abs() < 1e-10, "{diffuse:?}");
    assert!((diffuse[1] - 0.1158020630).abs() < 1e-10);
    for (incidence, alpha, total) in [
        (Incidence::NORMAL, 0.5, 0.11522587770720),
        (Incidence::NORMAL, 0.9, 0.41494747913082),
        (Incidence::NORMAL, 0.99, 0.75272071716030),
        (Incidence::Cosine, 0.5, 0.14654438069972),
        (Incidence::Cosine, 0.9, 0.47802448922824),
        (Incidence::Cosine, 0.99, 0.79456365290203),
    ] {
        let found = half_space(incidence, alpha.into()).re;
        assert!((found - total).abs() < 2e-9, "{incidence:?} {alpha}: {found} {total}");
    }
}

/// Light that starts uniformly in the cosine: R = 1 − (2/α)(√(1−α) − (1−α)), whose power series has
/// Pₙ = 2(qₙ − qₙ₊₁), qₙ = C(2n, n)/4ⁿ. Two statistics beyond 4σ: false alarm 1e-4.
#[test]
fn uniform_cosine_has_its_closed_form() {
    let parameters = Parameters { incidence: Incidence::UniformCosine, ..Parameters::default() };
    let (albedo, photons) = (0.95f64, 3_000_000);
    let (counts, all) = orders::<22>(parameters, albedo, 101, photons);

    let total = 1.0 - 2.0 / albedo * ((1.0 - albedo).sqrt() - (1.0 - albedo));
    let z = deviate_of_count(all.launched - all.absorbed, photons, total);
    assert!(z.abs() < 4.0, "z = {z}");

    let q = |n: u32| (1..=n).map(|k| f64::from(2 * k - 1) / f64::from(2 * k)).product::<f64>();
    let exact = std::array::from_fn(|i| 2.0 * (q(i as u32 + 1) - q(i as u32 + 2)));
    let deviate = deviate_of_counts(&counts[1..21], &expected(&exact, albedo, photons), photons);
    assert!(deviate < 4.0, "{deviate}: {counts:?}");
}

/// χ² over P₁…P₂₀ and the rest, for both entries beyond 4σ: false alarm 6e-5.
#[test]
fn orders_of_scattering_have_their_probabilities() {
    let (albedo, photons) = (0.98, 3_000_000);
    for incidence in [Incidence::NORMAL, Incidence::Cosine] {
        let (counts, _) =
            orders::<22>(Parameters { incidence, ..Parameters::default() }, albedo, 102, photons);
        assert_eq!(counts[0], 0);
        let expected = expected(&orders_of_half_space(incidence), albedo, photons);
        let deviate = deviate_of_counts(&counts[1..21], &expected, photons);
        assert!(deviate < 4.0, "{incidence:?} {deviate}: {counts:?}");
    }
}

/// 15 albedos for both entries: |z| < 4 each and χ² over all 30 within 4σ; false alarm 2e-3.
#[test]
fn totals_equal_the_h_function() {
    let mut chi2 = 0.0;
    let albedos = [0.01, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.98, 0.99, 0.995];
    for incidence in [Incidence::NORMAL, Incidence::Cosine] {
        for albedo in albedos {
            let photons = 1_000_000;
            let (_, counts) =
                orders::<1>(Parameters { incidence, ..Parameters::default() }, albedo, 103, photons);
            let exact = half_space(incidence, albedo.into()).re;
            let z = deviate_of_count(counts.launched - counts.absorbed, photons, exact);
            assert!(z.abs() < 4.0, "{incidence:?} {albedo}: z = {z}");
            chi2 += z * z;
        }
    }
    let deviate = deviate(chi2, 30.0);
    assert!(deviate < 4.0, "χ² = {chi2}");
}

/// Each collision absorbs with probability 1 − α, whatever happened before: absorbed − (1−α) collisions is a
/// martingale of variance α(1−α) collisions. With (1−R)/(1−α) collisions in the mean. |z| < 4 in 9 cases:
/// false alarm 6e-4.
#[test]
fn collisions_absorb_at_the_reference_albedo() {
    let hg = PhaseFunction::HenyeyGreenstein { g: 0.7 };
    for parameters in [
        Parameters::default(),
        Parameters { phase_function: hg, eta: 1.4, incidence: Incidence::Cosine, ..Parameters::default() },
        Parameters { thickness: 0.5, ..Parameters::default() },
    ] {
        for albedo in [0.3, 0.9, 0.99999] {
            let (_, counts) = orders::<1>(parameters.clone(), albedo, 104, 200_000);
            let collisions = counts.collisions as f64;
            let z = (counts.absorbed as f64 - (1.0 - albedo) * collisions)
                / (albedo * (1.0 - albedo) * collisions).sqrt();
            assert!(z.abs() < 4.0, "{parameters:?} {albedo}: z = {z}");
        }
    }
}

/// Giovanelli's half space, n = 1.5, α = 0.9, isotropic: 0.2599185699 of a normal beam outside comes back, 0.04
/// of it from the surface. (R. G. Giovanelli, *Reflection by semi-infinite diffusers*, 1955, gives 0.2600; more
/// digits from physics.md §3.) |z| < 4: false alarm 6e-5.
#[test]
fn giovanellis_half_space_returns_its_light() {
    let photons = 3_000_000;
    let (_, counts) = orders::<1>(Parameters { eta: 1.5, ..Parameters::default() }, 0.9, 105, photons);
    let specular = crate::specular_reflectance(Incidence::NORMAL, 1.5);
    let exact = (0.2599185699 - specular) / (1.0 - specular);
    let z = deviate_of_count(counts.launched - counts.absorbed, photons, exact);
    assert!(z.abs() < 4.0, "z = {z}");
}

/// Van de Hulst's slab, n = 1, g = 0.75, optical depth 2, α = 0.9 (H. C. van de Hulst, *Multiple Light
/// Scattering*, 1980, table 35): R 0.09739, T 0.66096, light that crosses untouched included. Beside the
/// tables' last digit |z| < 4 for both: false alarm 1.3e-4.
#[test]
fn van_de_hulsts_slab_divides_its_light() {
    let photons = 4_000_000;
    let problem = Problem::new(Parameters {
        phase_function: PhaseFunction::HenyeyGreenstein { g: 0.75 },
        thickness: 2.0,
        ..Parameters::default()
    });
    let mut reflected = 0;
    let counts = trace(&problem.unwrap(), 0.9, 106, 0..photons, &mut |exits| {
        reflected += exits.iter().filter(|exit| exit.side == Side::Reflected).count() as u64;
    });
    let transmitted = photons - counts.absorbed - reflected;
    for (count, exact) in [(reflected, 0.09739), (transmitted, 0.66096)] {
        let digit = 5e-6 * photons as f64;
        let sigma = (photons as f64 * exact * (1.0 - exact)).sqrt();
        let off = (count as f64 - exact * photons as f64).abs();
        assert!(off < 4.0 * sigma + digit, "{} instead of {exact}", count as f64 / photons as f64);
    }
}
