//! The kernel's walk with the kernel's random words, in double precision and one photon at a time.
//!
//! The two differ by rounding alone: photon by photon the exits can be laid side by side, which
//! shows a bias of single precision that no comparison of independent samples would.

use super::random::{Key, Stream};
use super::{PhaseFunction, PhotonExit, Problem, Side};
use crate::Incidence;
use translucid_profile::fresnel_from_inside;

/// End of a photon's walk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct End {
    /// The exit, or nothing for an absorbed photon.
    pub(super) exit: Option<PhotonExit>,
    /// Collisions.
    pub(super) collisions: u64,
}

fn unit(word: u32) -> f64 {
    f64::from(word | 1) / 4294967296.0
}

fn signed(word: u32) -> f64 {
    f64::from((word | 1).cast_signed()) / 2147483648.0
}

fn circle(word: u32) -> [f64; 2] {
    let (sine, cosine) = (signed(word << 2) * std::f64::consts::FRAC_PI_4).sin_cos();
    let sign = if word >> 31 == 1 { -1.0 } else { 1.0 };
    if word >> 30 & 1 == 1 { [sign * sine, sign * cosine] } else { [sign * cosine, sign * sine] }
}

/// Walks one photon; pencils and the uniform cosine, without spot.
pub(super) fn replay(problem: &Problem, albedo: f64, seed: u64, index: u64) -> End {
    let parameters = problem.parameters();
    let (eta, thickness) = (parameters.eta, parameters.thickness);
    let mut stream = Stream::new(Key::new(seed), index);
    let budget = (-unit(stream.next()).ln() / -albedo.ln()).floor() as u64;

    let [mut x, mut y, mut z] = [0.0; 3];
    let mut u = match parameters.incidence {
        Incidence::Pencil { cos_theta } => {
            let sine = (1.0 - cos_theta * cos_theta).sqrt() / eta;
            [sine, 0.0, (1.0 - sine * sine).sqrt()]
        }
        Incidence::UniformCosine => {
            let cosine = unit(stream.next());
            around_axis(cosine, circle(stream.next()))
        }
        Incidence::Cosine => {
            assert_eq!(eta, 1.0);
            let cosine = unit(stream.next()).sqrt();
            around_axis(cosine, circle(stream.next()))
        }
    };
    for order in 0.. {
        let flight = -unit(stream.next()).ln();
        x += flight * u[0];
        y += flight * u[1];
        z += flight * u[2];
        while z < 0.0 || z > thickness {
            let (side, face) = if z < 0.0 { (Side::Reflected, 0.0) } else { (Side::Transmitted, thickness) };
            let reflectance = fresnel_from_inside(u[2], eta);
            if eta == 1.0 || reflectance < 1.0 && unit(stream.next()) >= reflectance {
                let beyond = (z - face) / u[2];
                let exit = PhotonExit {
                    x: (x - beyond * u[0]) as f32,
                    y: (y - beyond * u[1]) as f32,
                    cos_theta: u[2].abs() as f32,
                    order: order as u32,
                    side,
                };
                return End { exit: Some(exit), collisions: order };
            }
            z = 2.0 * face - z;
            u[2] = -u[2];
        }
        if order == budget {
            return End { exit: None, collisions: order + 1 };
        }
        let polar = stream.next();
        let point = circle(stream.next());
        u = match parameters.phase_function {
            PhaseFunction::HenyeyGreenstein { g: 0.0 } => around_axis(signed(polar), point),
            PhaseFunction::HenyeyGreenstein { g } => {
                let ratio = (1.0 - g * g) / (1.0 - g.abs() + 2.0 * g.abs() * unit(polar));
                let cosine = (1.0 + g * g - ratio * ratio) / (2.0 * g.abs());
                reflect_onto(u, around_axis(cosine * g.signum(), point))
            }
            PhaseFunction::Rayleigh => {
                let cosine = 2.0 * ((2.0 * signed(polar)).asinh() / 3.0).sinh();
                reflect_onto(u, around_axis(cosine, point))
            }
            _ => unreachable!("laws without a formula have no twin of the same words"),
        };
    }
    unreachable!("the budget is finite")
}

fn around_axis(cosine: f64, [x, y]: [f64; 2]) -> [f64; 3] {
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    [sine * x, sine * y, cosine]
}

/// Householder's reflection that takes the z axis to −s u, s = sign u_z, of (s p, s q, cos θ), times −s.
fn reflect_onto(u: [f64; 3], [p, q, cosine]: [f64; 3]) -> [f64; 3] {
    let s = if u[2].is_sign_negative() { -1.0 } else { 1.0 };
    let w = [u[0], u[1], u[2] + s];
    let v = [s * p, s * q, cosine];
    let factor = 2.0 * (w[0] * v[0] + w[1] * v[1] + w[2] * v[2]) / (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
    let turned = [0, 1, 2].map(|i| -s * (v[i] - factor * w[i]));
    let length = turned.iter().map(|c| c * c).sum::<f64>().sqrt();
    turned.map(|c| c / length)
}
