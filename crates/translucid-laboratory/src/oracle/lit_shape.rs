//! Light that leaves a plane near a shape that is lit evenly.
//!
//! A profile spreads light alike in all directions, so what leaves at a place is the sum of its rings over the lit part of
//! each circle around that place:
//!
//! ```text
//! response = ∫ f(r) dE(r),     f(r): the lit part of the circle of radius r,   E(r) = ∫₀^r R 2πr' dr'
//! ```
//!
//! Integrated by parts along the shape's rim it needs E alone, which exact solutions and profiles have:
//!
//! ```text
//! edge     B(d) = 1/π ∫₀^{π/2} [A − E(d/cos θ)] dθ = 1/π ∫₀^∞ [A − E(d cosh t)] / cosh t dt        on the dark side
//! disk     1/π ∫₀^π E(ρ) a (a − x cos u)/ρ² du,       ρ² = a² + x² − 2 a x cos u
//! ```

use std::f64::consts::PI;
use std::sync::LazyLock;

use translucid_profile::Profile;
use translucid_profile::quadrature::gauss_legendre;
use translucid_reference::Estimate;
use translucid_reference::exact::HalfSpace;

/// A shape of even light on a plane, and the place that is looked at; lengths in the unit of the profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LitShape {
    /// All that is on one side of a straight line.
    Edge {
        /// Distance of the place from the line: positive on the dark side, negative on the lit one.
        distance: f64,
    },
    /// A disk.
    Disk {
        /// Its radius, greater than 0.
        radius: f64,
        /// Distance of the place from its center.
        offset: f64,
    },
    /// A straight band that has no ends.
    Line {
        /// Its width, greater than 0.
        width: f64,
        /// Distance of the place from the line in its middle.
        offset: f64,
    },
}

/// Light that leaves within and beyond a radius, of one unit that enters at a point.
pub trait Spread {
    /// All of it, the surface albedo A.
    fn total(&self) -> Estimate;
    /// The part that leaves within r.
    fn enclosed(&self, r: f64) -> Estimate;
    /// The part that leaves beyond r.
    fn beyond(&self, r: f64) -> Estimate;
}

impl Spread for HalfSpace {
    fn total(&self) -> Estimate {
        self.total()
    }

    fn enclosed(&self, r: f64) -> Estimate {
        self.enclosed(r)
    }

    fn beyond(&self, r: f64) -> Estimate {
        self.beyond(r)
    }
}

impl Spread for dyn Profile + '_ {
    fn total(&self) -> Estimate {
        Estimate { value: self.surface_albedo(), error: 0.0 }
    }

    fn enclosed(&self, r: f64) -> Estimate {
        Estimate { value: Profile::enclosed(self, r), error: 0.0 }
    }

    fn beyond(&self, r: f64) -> Estimate {
        Estimate { value: Profile::beyond(self, r), error: 0.0 }
    }
}

/// Step of t in the integral of an edge: of a Gaussian twice the step is 3e-9 off, of e^{−r} less than rounding.
const STEP: f64 = 0.125;
/// Nodes of the two rules around a disk.
const NODES: [usize; 2] = [64, 48];
/// Least angle that these resolve.
const LEAST_ANGLE: f64 = 1e-4;

impl LitShape {
    /// Part of the circle of radius r > 0 around the place that is lit, in \[0, 1\].
    pub fn lit_part_of_circle(&self, r: f64) -> f64 {
        let beyond_line = |distance: f64| libm::acos((distance / r).clamp(-1.0, 1.0)) / PI;
        match *self {
            Self::Edge { distance } => beyond_line(distance),
            Self::Line { width, offset } => {
                beyond_line(offset - 0.5 * width) - beyond_line(offset + 0.5 * width)
            }
            Self::Disk { radius, offset: 0.0 } => f64::from(r <= radius),
            Self::Disk { radius, offset } => {
                let cos = (r * r + offset * offset - radius * radius) / (2.0 * r * offset);
                libm::acos(cos.clamp(-1.0, 1.0)) / PI
            }
        }
    }

    /// Light that leaves at the place where one unit per area enters the lit shape: A far inside a large shape.
    ///
    /// The error is that of the spread, and what two rules of integration differ by.
    pub fn response(&self, spread: &(impl Spread + ?Sized)) -> Estimate {
        match *self {
            Self::Edge { distance } if distance < 0.0 => {
                minus(spread.total(), beyond_edge(spread, -distance))
            }
            Self::Edge { distance } => beyond_edge(spread, distance),
            Self::Line { width, offset } => {
                let [near, far] = [offset.abs() - 0.5 * width, offset.abs() + 0.5 * width];
                let near = Self::Edge { distance: near }.response(spread);
                minus(near, beyond_edge(spread, far))
            }
            Self::Disk { radius, offset: 0.0 } => spread.enclosed(radius),
            Self::Disk { radius, offset } => disk(spread, radius, offset.abs()),
        }
    }
}

fn minus(a: Estimate, b: Estimate) -> Estimate {
    Estimate { value: (a.value - b.value).max(0.0), error: a.error + b.error }
}

/// Light at a distance ≥ 0 from a half plane that is lit.
fn beyond_edge(spread: &(impl Spread + ?Sized), distance: f64) -> Estimate {
    if distance == 0.0 {
        let Estimate { value, error } = spread.total();
        return Estimate { value: 0.5 * value, error: 0.5 * error };
    }
    // The trapezoidal rule of an even function that ends nowhere abruptly converges exponentially
    let [mut even, mut odd] = [Estimate::ZERO; 2];
    for i in 0..320 {
        let cosh = libm::cosh(STEP * f64::from(i));
        let Estimate { value, error } = spread.beyond(distance * cosh);
        let weight = if i == 0 { 0.5 } else { 1.0 } * STEP / (PI * cosh);
        let sum = if i % 2 == 0 { &mut even } else { &mut odd };
        sum.value += weight * value;
        sum.error += weight * error;
        if weight * value <= 1e-17 * even.value {
            break;
        }
    }
    let value = even.value + odd.value;
    Estimate { value, error: even.error + odd.error + (even.value - odd.value).abs() + 1e-15 * value }
}

/// Light at a distance > 0 from the center of a lit disk.
fn disk(spread: &(impl Spread + ?Sized), radius: f64, offset: f64) -> Estimate {
    static RULES: LazyLock<[Vec<(f64, f64)>; 2]> = LazyLock::new(|| NODES.map(gauss_legendre));
    // Near the rim all happens at small angles: u = δ sinh v
    let narrow = ((radius - offset).abs() / (radius * offset).sqrt()).max(LEAST_ANGLE);
    let last = libm::asinh(PI / narrow);
    let [fine, coarse] = [0, 1].map(|rule| {
        let mut sum = Estimate::ZERO;
        for (node, weight) in &RULES[rule] {
            let v = 0.5 * last * (1.0 + node);
            let half = libm::sin(0.5 * narrow * libm::sinh(v));
            // ρ² = (a − x)² + 4 a x sin²(u/2), without cancellation near the rim
            let squared = (radius - offset).powi(2) + 4.0 * radius * offset * half * half;
            let toward = radius * (radius - offset + 2.0 * offset * half * half) / squared;
            let weight = 0.5 * last * weight * narrow * libm::cosh(v) * toward / PI;
            // From outside the whole circle counts nothing, and what leaves far away is exact
            let rho = squared.sqrt();
            let (Estimate { value, error }, weight) =
                if offset > radius { (spread.beyond(rho), -weight) } else { (spread.enclosed(rho), weight) };
            sum.value += weight * value;
            sum.error += weight.abs() * error;
        }
        sum
    });
    let value = fine.value.max(0.0);
    Estimate { value, error: fine.error + (fine.value - coarse.value).abs() + 1e-15 * value }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use translucid_profile::{NormalizedDiffusion, SumOfGaussians};
    use translucid_reference::Incidence;

    use super::*;

    const SHAPES: [LitShape; 9] = [
        LitShape::Edge { distance: 0.3 },
        LitShape::Edge { distance: 4.0 },
        LitShape::Edge { distance: -1.0 },
        LitShape::Disk { radius: 2.0, offset: 0.0 },
        LitShape::Disk { radius: 2.0, offset: 1.0 },
        LitShape::Disk { radius: 2.0, offset: 2.0 },
        LitShape::Disk { radius: 2.0, offset: 3.0 },
        LitShape::Line { width: 1.0, offset: 0.2 },
        LitShape::Line { width: 1.0, offset: 3.0 },
    ];

    /// The slow twin: the definition, ring by ring.
    #[test]
    fn response_is_the_sum_over_rings() {
        for (alpha, incidence) in [(0.99, Incidence::Cosine), (0.5, Incidence::NORMAL)] {
            let half_space = HalfSpace::new(alpha, incidence).unwrap();
            let edges: Vec<f64> = (0..=1000).map(|i| 1e-4 * libm::exp(0.014 * f64::from(i))).collect();
            let energies: Vec<f64> = edges.iter().map(|r| half_space.enclosed(*r).value).collect();
            for shape in SHAPES {
                let ring = |i: usize| {
                    let part = |k: i32| edges[i] + (f64::from(k) + 0.5) / 16.0 * (edges[i + 1] - edges[i]);
                    let lit = (0..16).map(|k| shape.lit_part_of_circle(part(k))).sum::<f64>() / 16.0;
                    lit * (energies[i + 1] - energies[i])
                };
                let sum = energies[0] * shape.lit_part_of_circle(5e-5) + (0..1000).map(ring).sum::<f64>();
                let found = shape.response(&half_space);
                assert!((found.value - sum).abs() < 1e-4, "{shape:?}: {found:?} {sum}");
                assert!(found.error < 1e-6, "{shape:?}: {found:?}");
            }
        }
    }

    /// A Gaussian of variance v an axis has an error function for an edge, and 1 − e^{−a²/2v} in the middle of a disk.
    #[test]
    fn response_of_a_gaussian_is_its_closed_form() {
        let gaussian = SumOfGaussians::from_terms(&[1.0], &[2.0], 0.5).unwrap();
        let spread: &dyn Profile = &gaussian;
        for x in [0.0, 0.01, 0.7, 3.0] {
            let found = LitShape::Edge { distance: x }.response(spread);
            let off = (found.value - 0.25 * libm::erfc(x / 2.0)).abs();
            assert!(off < 1e-15 + found.error && off < 1e-8, "{x}: {found:?}");
            let disk = LitShape::Disk { radius: x + 0.1, offset: 0.0 }.response(spread).value;
            assert!((disk - 0.5 * -libm::expm1(-(x + 0.1).powi(2) / 4.0)).abs() < 1e-12, "{x}: {disk}");
        }
        // Near the rim the rule of 64 nodes has the digits that it says
        for offset in [0.1, 1.9, 1.999, 2.0, 2.001, 2.1, 9.0] {
            let found = LitShape::Disk { radius: 2.0, offset }.response(spread);
            let (n, mut sum) = (100_000, 0.0);
            for i in 0..n {
                let u = PI * (f64::from(i) + 0.5) / f64::from(n);
                let rho2 = 4.0 + offset * offset - 4.0 * offset * libm::cos(u);
                sum -= 0.5 * libm::expm1(-rho2 / 4.0) * 2.0 * (2.0 - offset * libm::cos(u))
                    / rho2
                    / f64::from(n);
            }
            assert!((found.value - sum).abs() < 1e-9 + found.error, "{offset}: {found:?} {sum}");
            assert!(found.error < 1e-7, "{offset}: {found:?}");
        }
    }

    /// All light that enters a band or a disk leaves somewhere.
    #[test]
    fn responses_add_up_to_the_light_that_entered() {
        let profile = NormalizedDiffusion::from_d(0.7, 0.5).unwrap();
        let spread: &dyn Profile = &profile;
        let n = 20_000;
        let (mut line, mut disk) = (0.0, 0.0);
        for i in 0..n {
            let x = 20.0 * (f64::from(i) + 0.5) / f64::from(n);
            let dx = 20.0 / f64::from(n);
            line += 2.0 * dx * LitShape::Line { width: 1.5, offset: x }.response(spread).value;
            disk += TAU * x * dx * LitShape::Disk { radius: 1.5, offset: x }.response(spread).value;
        }
        assert!((line / (1.5 * 0.7) - 1.0).abs() < 1e-4, "{line}");
        assert!((disk / (PI * 2.25 * 0.7) - 1.0).abs() < 1e-4, "{disk}");
    }
}
