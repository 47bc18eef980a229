//! The area-weighted L1 distance of a profile from a reference.

use std::f64::consts::PI;

use translucid_profile::Profile;

/// Area-weighted L1 distance of a profile from a reference, for radii up to `r_max` \[L\], which may be infinite.
///
/// ```text
/// ∫₀^r_max |R_fit − R| 2πr dr  /  ∫₀^r_max R 2πr dr
/// ```
///
/// Energy that a profile puts in the wrong place counts where it is and where it should be, so that two profiles of
/// equal energy that nowhere overlap have the distance 2.
/// With `r_max` between 8 mean free paths and infinity this gives the mean errors that P. H.
/// Christensen and B. Burley, *Approximate Reflectance Profiles for Efficient Subsurface Scattering*, 2015, state.
/// Numerical error below 1e-6; [`Judge`] measures several profiles against one reference.
/// A reference without energy within `r_max` gives 0 if the profile has none either, else the greatest number.
pub fn l1_error(fit: &dyn Profile, reference: &dyn Profile, r_max: f64) -> f64 {
    Judge::new(reference).l1_error(fit, r_max)
}

/// A reference profile with what it takes to judge others by it.
///
/// With D(r) the difference of the energies within r, the distance is the total variation of D, ∫|dD|. Nothing is
/// integrated: on a grid of radii D is known, and so is its slope, whose changes of sign are the only places
/// between two radii that matter; there D is taken for a cubic in ln r.
#[derive(Clone, Debug)]
pub struct Judge {
    nodes: Vec<Node>,
    total: f64,
}

/// A profile at one radius.
#[derive(Clone, Copy, Debug)]
struct Node {
    r: f64,
    enclosed: f64,
    /// Slope of `enclosed` over ln r.
    slope: f64,
}

impl Node {
    fn new(profile: &dyn Profile, r: f64) -> Self {
        Self { r, enclosed: profile.enclosed(r), slope: 2.0 * PI * r * profile.eval_times_r(r) }
    }
}

impl Judge {
    /// Nodes to a factor of 2 in r.
    const NODES_PER_OCTAVE: f64 = 14.0;
    /// Range of the nodes in octaves about the reference's scale: 1e-7 to 1e4 times it.
    const OCTAVES: std::ops::Range<f64> = -24.0..14.0;

    /// Evaluates the reference at some 530 radii.
    pub fn new(reference: &dyn Profile) -> Self {
        let step = |octaves: f64| (octaves * Self::NODES_PER_OCTAVE) as i32;
        let radius = |i: i32| reference.scale() * libm::exp2(f64::from(i) / Self::NODES_PER_OCTAVE);
        let range = step(Self::OCTAVES.start)..=step(Self::OCTAVES.end);
        let nodes = range.map(|i| Node::new(reference, radius(i))).collect();
        Self { nodes, total: reference.surface_albedo() }
    }

    /// Distance of a profile from the reference, as [`l1_error`].
    pub fn l1_error(&self, fit: &dyn Profile, r_max: f64) -> f64 {
        let [error] = self.l1_errors(fit, [r_max]);
        error
    }

    /// Distances for several greatest radii, at the cost of one.
    pub fn l1_errors<const N: usize>(&self, fit: &dyn Profile, r_max: [f64; N]) -> [f64; N] {
        let differences: Vec<Node> = self.nodes.iter().map(|node| difference(fit, node)).collect();
        r_max.map(|r_max| {
            // Within the first node either profile grows in proportion to its energy
            let within_first = differences.first().map_or(0.0, |node| node.enclosed.abs());
            let cells = self.nodes.windows(2).zip(differences.windows(2));
            let wrong: f64 = cells
                .filter(|(ends, _)| ends[0].r < r_max)
                .map(|(ends, differences)| {
                    let ln_step = libm::log(ends[1].r / ends[0].r);
                    let share = (libm::log(r_max / ends[0].r) / ln_step).min(1.0);
                    Cubic::new(differences, ln_step).variation(share)
                })
                .sum();
            let last = differences.last().map_or(0.0, |node| node.enclosed);
            let end = self.nodes.last().map_or(0.0, |node| node.r);
            let beyond_last =
                if r_max > end { ((fit.surface_albedo() - self.total) - last).abs() } else { 0.0 };
            quotient(within_first + wrong + beyond_last, self.enclosed(r_max))
        })
    }

    /// Energy of the reference within a radius.
    fn enclosed(&self, r_max: f64) -> f64 {
        let Some(ends) = self.nodes.windows(2).find(|ends| ends[1].r >= r_max) else { return self.total };
        let ln_step = libm::log(ends[1].r / ends[0].r);
        Cubic::new(ends, ln_step).eval((libm::log(r_max / ends[0].r) / ln_step).max(0.0))
    }
}

fn difference(fit: &dyn Profile, reference: &Node) -> Node {
    let fit = Node::new(fit, reference.r);
    Node { enclosed: fit.enclosed - reference.enclosed, slope: fit.slope - reference.slope, ..fit }
}

/// a/b with 0/0 = 0.
fn quotient(a: f64, b: f64) -> f64 {
    if a == 0.0 { 0.0 } else { (a / b).min(f64::MAX) }
}

/// Polynomial c₀ + c₁t + c₂t² + c₃t³ of t ∈ [0, 1].
struct Cubic([f64; 4]);

impl Cubic {
    /// The polynomial with the values and slopes of two nodes.
    fn new(ends: &[Node], ln_step: f64) -> Self {
        let rise = ends[1].enclosed - ends[0].enclosed;
        let slopes = [ends[0].slope * ln_step, ends[1].slope * ln_step];
        let c2 = 3.0 * rise - 2.0 * slopes[0] - slopes[1];
        Self([ends[0].enclosed, slopes[0], c2, slopes[0] + slopes[1] - 2.0 * rise])
    }

    fn eval(&self, t: f64) -> f64 {
        let [c0, c1, c2, c3] = self.0;
        c0 + t * (c1 + t * (c2 + t * c3))
    }

    /// Way that the value travels, up and down, as t goes from 0 to `end`.
    fn variation(&self, end: f64) -> f64 {
        let [turn_1, turn_2] = self.turns();
        let stations = [0.0, turn_1.clamp(0.0, end), turn_2.clamp(0.0, end), end];
        stations.windows(2).map(|pair| (self.eval(pair[1]) - self.eval(pair[0])).abs()).sum()
    }

    /// Arguments at which the slope c₁ + 2c₂t + 3c₃t² is 0, in ascending order; 0 where it is not.
    fn turns(&self) -> [f64; 2] {
        let [_, c, b, a] = [0.0, self.0[1], self.0[2], 3.0 * self.0[3]];
        let discriminant = b * b - a * c;
        if discriminant <= 0.0 {
            return [0.0; 2];
        }
        // The sum whose terms have one sign, and the other root by the product of both
        let q = -(b + discriminant.sqrt().copysign(b));
        let roots = [q / a, c / q].map(|root| if root.is_finite() { root } else { 0.0 });
        [roots[0].min(roots[1]), roots[0].max(roots[1])]
    }
}

#[cfg(test)]
mod tests {
    use translucid_profile::NormalizedDiffusion;

    use super::*;
    use crate::{Gaussian, Mixture};

    fn burley(surface_albedo: f64, d: f64) -> NormalizedDiffusion {
        NormalizedDiffusion::from_d(surface_albedo, d).unwrap()
    }

    fn gaussians() -> Mixture<Gaussian> {
        Mixture::new(0.5, &[(0.3, 0.1), (0.3, 0.8), (0.4, 3.0)]).unwrap()
    }

    /// Error by brute force: the trapezoidal rule in ln r with steps so small that kinks do not matter.
    fn twin(fit: &dyn Profile, reference: &dyn Profile, r_max: f64) -> f64 {
        let end = r_max.min(3e3);
        let step = 1e-4;
        let term = |i: i32| {
            let r = end * (-step * f64::from(i)).exp();
            let weight = if i == 0 { 0.5 } else { 1.0 };
            let off = (fit.eval_times_r(r) - reference.eval_times_r(r)).abs();
            [weight * step * 2.0 * PI * r * off, weight * step * 2.0 * PI * r * reference.eval_times_r(r)]
        };
        let sums = (0..240_000).map(term).fold([0.0; 2], |sum, term| [sum[0] + term[0], sum[1] + term[1]]);
        sums[0] / sums[1]
    }

    #[test]
    fn l1_error_agrees_with_brute_force() {
        let reference = burley(0.5, 1.0);
        for r_max in [0.7, 8.0, 16.0, f64::INFINITY] {
            for fit in [&gaussians() as &dyn Profile, &burley(0.5, 1.2), &burley(0.4, 1.5)] {
                let (found, expected) = (l1_error(fit, &reference, r_max), twin(fit, &reference, r_max));
                assert!((found - expected).abs() < 1e-6, "{r_max}: {found} {expected}");
            }
        }
    }

    /// Two widths of one exponential cross once, where the energies within differ by a closed form.
    #[test]
    fn l1_error_agrees_with_a_closed_form() {
        let exponential = |s: f64| Mixture::<crate::Exponential>::new(1.0, &[(1.0, s)]).unwrap();
        let (a, b) = (1.0, 1.7f64);
        let crossing = (b / a).ln() / (1.0 / a - 1.0 / b);
        let expected = 2.0 * ((-crossing / b).exp() - (-crossing / a).exp());
        let found = l1_error(&exponential(b), &exponential(a), f64::INFINITY);
        assert!((found - expected).abs() < 1e-7, "{found} {expected}");
    }

    #[test]
    fn l1_error_is_zero_for_the_reference_and_scales_with_the_unit() {
        for r_max in [1.0, f64::INFINITY] {
            assert_eq!(l1_error(&burley(0.3, 2.0), &burley(0.3, 2.0), r_max), 0.0);
        }
        let unit = l1_error(&burley(0.3, 1.3), &burley(0.3, 1.0), 5.0);
        for length in [1e-100, 1e100] {
            let found = l1_error(&burley(0.3, 1.3 * length), &burley(0.3, length), 5.0 * length);
            assert!((found - unit).abs() < 1e-13, "{length}: {found} {unit}");
        }
    }

    #[test]
    fn l1_error_of_profiles_without_energy_is_a_number() {
        assert_eq!(l1_error(&burley(0.0, 1.0), &burley(0.0, 1.0), 8.0), 0.0);
        assert_eq!(l1_error(&burley(0.5, 1.0), &burley(0.0, 1.0), 8.0), f64::MAX);
        assert!((l1_error(&burley(0.0, 1.0), &burley(0.5, 1.0), 8.0) - 1.0).abs() < 1e-12);
        assert!((l1_error(&burley(0.5, 1.0), &burley(0.25, 1.0), f64::INFINITY) - 1.0).abs() < 1e-12);
    }
}
