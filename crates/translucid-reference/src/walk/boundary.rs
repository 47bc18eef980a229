//! The faces of the medium: where photons cross them, and whether they get through.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, mask32x16};

use super::lanes::{Floats, FusedMulAdd};
use super::{Problem, Side};

/// A smooth boundary between two media, seen from one of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Interface {
    /// Index on this side over that on the other.
    eta: f32,
    /// 1 − η².
    one_minus_square: f32,
    /// Light with a lower squared cosine reflects totally; negative where none does.
    total_below: f32,
}

impl Interface {
    pub(crate) fn new(eta: f64) -> Self {
        let one_minus_square = (1.0 - eta) * (1.0 + eta);
        Self {
            eta: eta as f32,
            one_minus_square: one_minus_square as f32,
            total_below: (-one_minus_square / (eta * eta)) as f32,
        }
    }

    /// Returns which cosines are beyond the critical angle.
    #[inline(always)]
    pub(crate) fn reflects_totally<S: Simd>(&self, mu: Floats<S>) -> mask32x16<S> {
        (mu * mu).simd_lt(self.total_below)
    }

    /// Fresnel's reflectance (A.-J. Fresnel 1823) for η ≠ 1 and cosines in (0, 1]; 1 beyond the critical angle.
    #[inline(always)]
    pub(crate) fn reflectance<S: Simd>(&self, simd: S, mu: Floats<S>) -> Floats<S> {
        let squared =
            (mu * mu).fused_mul_add(self.eta * self.eta, Floats::splat(simd, self.one_minus_square));
        let refracted = squared.max(0.0).min(1.0).sqrt();
        let perpendicular = (mu * self.eta - refracted) / (mu * self.eta + refracted);
        let parallel = (refracted * self.eta - mu) / (refracted * self.eta + mu);
        (perpendicular * perpendicular + parallel * parallel) * 0.5
    }
}

/// The faces z = 0 and, of a slab, z = thickness.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Boundary {
    /// Thickness; infinite for the half space.
    pub(crate) thickness: f32,
    /// True where all light gets through: η = 1.
    pub(crate) matched: bool,
    /// Either face, from inside.
    pub(crate) interface: Interface,
}

/// Position and direction of one photon.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    pub(crate) x: f32,
    pub(crate) y: f32,
    pub(crate) z: f32,
    pub(crate) ux: f32,
    pub(crate) uy: f32,
    pub(crate) uz: f32,
}

impl Boundary {
    pub(crate) fn new(problem: &Problem) -> Self {
        let parameters = problem.parameters();
        Self {
            // A slab thinner than single precision can say is the thinnest it can say
            thickness: (parameters.thickness as f32).max(f32::MIN_POSITIVE),
            matched: parameters.eta == 1.0,
            interface: Interface::new(parameters.eta),
        }
    }

    /// Returns which depths are beyond a face.
    #[inline(always)]
    pub(crate) fn are_outside<S: Simd>(&self, z: Floats<S>) -> mask32x16<S> {
        z.simd_lt(0.0) | z.simd_gt(self.thickness)
    }

    /// Mirrors depths beyond a face once.
    #[inline(always)]
    pub(crate) fn mirrored<S: Simd>(&self, simd: S, z: Floats<S>) -> Floats<S> {
        z.simd_lt(0.0).select(-z, Floats::splat(simd, 2.0 * self.thickness) - z)
    }

    /// Sees to a photon that one reflection has taken beyond the other face of a thin slab.
    ///
    /// `share` is uniform in (0, 1], `reflectance` that of the face. As the cosine stays, the number of further
    /// reflections in a row is geometric and is drawn at once, then compared with the faces that the flight
    /// meets: no slab is so thin that this takes long. Returns the face that the photon left through, with
    /// `ray` on it, or nothing, with `ray` inside.
    pub(crate) fn cross_again(&self, ray: &mut Ray, share: f32, reflectance: f32) -> Option<Side> {
        let logs = [share, reflectance].map(|share| libm::log(f64::from(share)).abs());
        let reflections = (logs[0] / logs[1]).floor();
        let faces = 1.0 + (self.beyond(ray) / f64::from(self.thickness)).floor();
        if reflections < faces && reflectance < 1.0 {
            return Some(self.leave(ray, reflections));
        }
        self.fold(ray);
        None
    }

    /// Distance of a depth beyond the nearer face.
    fn beyond(&self, ray: &Ray) -> f64 {
        if ray.z < 0.0 { f64::from(-ray.z) } else { f64::from(ray.z) - f64::from(self.thickness) }
    }

    /// Takes a photon beyond a face back to it, or to the face that it meets after some reflections.
    fn leave(&self, ray: &mut Ray, reflections: f64) -> Side {
        let upwards = ray.z < 0.0;
        let missed = if reflections == 0.0 { 0.0 } else { reflections * f64::from(self.thickness) };
        let back = ((self.beyond(ray) - missed) / f64::from(ray.uz.abs())) as f32;
        ray.x -= back * ray.ux;
        ray.y -= back * ray.uy;
        let upwards = upwards != (reflections % 2.0 == 1.0);
        ray.uz = if upwards { -ray.uz.abs() } else { ray.uz.abs() };
        ray.z = if upwards { 0.0 } else { self.thickness };
        if upwards { Side::Reflected } else { Side::Transmitted }
    }

    /// All total reflections of a flight at once: the depth as a triangle wave of period 2 thickness.
    fn fold(&self, ray: &mut Ray) {
        if ray.z < 0.0 {
            ray.z = -ray.z;
            ray.uz = -ray.uz;
        }
        if ray.z > self.thickness {
            let thickness = f64::from(self.thickness);
            let within = f64::from(ray.z) % (2.0 * thickness);
            let falling = within > thickness;
            let folded = if falling { 2.0 * thickness - within } else { within };
            ray.z = (folded as f32).clamp(0.0, self.thickness);
            ray.uz = if falling { -ray.uz } else { ray.uz };
        }
    }
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};
    use translucid_profile::fresnel_from_inside;

    use super::super::chi_square::deviate_of_count;
    use super::super::random::{Key, Stream};
    use super::super::{Parameters, Problem};
    use super::*;

    fn boundary(eta: f64, thickness: f64) -> Boundary {
        Boundary::new(&Problem::new(Parameters { eta, thickness, ..Parameters::default() }).unwrap())
    }

    #[test]
    fn reflectance_is_fresnels() {
        #[inline(always)]
        fn lanes<S: Simd>(simd: S, interface: Interface, mu: f32) -> (f32, bool) {
            let mu = Floats::splat(simd, mu);
            (interface.reflectance(simd, mu)[0], interface.reflects_totally(mu).all_true())
        }
        for eta in [0.1, 0.7, 0.999, 1.001, 1.33, 1.5, 3.0, 10.0] {
            let interface = Interface::new(eta);
            for i in 1..=1000 {
                let mu = i as f32 / 1000.0;
                let exact = fresnel_from_inside(f64::from(mu), eta);
                let (found, total) = dispatch!(Level::new(), simd => lanes(simd, interface, mu));
                let cosine_outside = (1.0 - eta * eta * (1.0 - f64::from(mu).powi(2))).max(0.0).sqrt();
                // Beside the critical angle F rises as a root, and so does a rounding of the cosine
                let bound = 4e-7 + 2e-6 * eta / cosine_outside.max(1e-3);
                assert!((f64::from(found) - exact).abs() < bound, "{eta} {mu}: {found} {exact}");
                assert!(cosine_outside < 1e-3 || total == (exact == 1.0), "{eta} {mu}");
            }
        }
    }

    /// Drawing all reflections at once gives the same faces and places as one by one. |z| < 4 for 5 counts and
    /// a mean: false alarm 4e-4.
    #[test]
    fn reflections_in_a_row_equal_those_one_by_one() {
        let (thickness, reflectance, photons) = (0.25f32, 0.6f32, 100_000);
        let boundary = boundary(1.5, f64::from(thickness));
        let mut stream = Stream::new(Key::new(5), 0);
        let mut uniform = || (stream.next() | 1) as f32 * (1.0 / 4294967296.0);
        // Beyond the far face by 0.6: that face and two more
        let ray = Ray { x: 3.0, y: 0.0, z: 0.85, ux: 0.8, uy: 0.0, uz: 0.6 };
        let mut counts = [0u64; 4];
        for _ in 0..photons {
            let mut ray = ray;
            let side = boundary.cross_again(&mut ray, uniform(), reflectance);
            let back = 0.8 / 0.6;
            let (outcome, x, z) = match side {
                Some(Side::Transmitted) if ray.x < 2.4 => (0, 3.0 - 0.6 * back, 0.25),
                Some(Side::Reflected) => (1, 3.0 - 0.35 * back, 0.0),
                Some(Side::Transmitted) => (2, 3.0 - 0.1 * back, 0.25),
                None => (3, 3.0, 0.15),
            };
            assert!((ray.x - x).abs() < 1e-6 && (ray.z - z).abs() < 1e-6, "{ray:?}");
            assert_eq!(ray.uz > 0.0, outcome % 2 == 0, "{ray:?}");
            counts[outcome] += 1;
        }
        for (i, count) in counts.into_iter().enumerate() {
            let stays = f64::from(reflectance).powi(i as i32);
            let z = deviate_of_count(count, photons, if i < 3 { stays * 0.4 } else { stays });
            assert!(z.abs() < 4.0, "{i}: z = {z}");
        }
    }

    #[test]
    fn crossing_again_ends_on_a_face_or_inside() {
        let mut stream = Stream::new(Key::new(5), 0);
        let mut uniform = || (stream.next() | 1) as f32 * (1.0 / 4294967296.0);
        for thickness in [1e-300, 1e-20, 1e-6, 0.3, 5.0] {
            let boundary = boundary(1.5, thickness);
            for reflectance in [0.0, 1e-30, 0.5, 0.999_999_94, 1.0] {
                for _ in 0..300 {
                    let uz = 2.0 * uniform() - 1.0;
                    let flight = -uniform().ln();
                    let start = boundary.thickness.min(1.0) * uniform();
                    let ux = (1.0 - uz * uz).sqrt();
                    let mut ray = Ray { x: flight * ux, y: 0.0, z: start + flight * uz, ux, uy: 0.0, uz };
                    if ray.z >= 0.0 && ray.z <= boundary.thickness {
                        continue;
                    }
                    let side = boundary.cross_again(&mut ray, uniform(), reflectance);
                    match side {
                        None => assert!(ray.z >= 0.0 && ray.z <= boundary.thickness, "{thickness}: {ray:?}"),
                        Some(Side::Reflected) => assert!(ray.z == 0.0 && ray.uz < 0.0, "{ray:?}"),
                        Some(Side::Transmitted) => {
                            assert!(ray.z == boundary.thickness && ray.uz > 0.0, "{ray:?}");
                        }
                    }
                    let farthest = flight * ux * 1.000001 + 1e-6;
                    assert!((-1e-6..=farthest).contains(&ray.x), "{thickness}: {ray:?}");
                }
            }
        }
    }

    /// Many total reflections in one step end where one after the other does.
    #[test]
    fn folding_equals_reflecting_one_by_one() {
        let boundary = boundary(1.5, 0.25);
        for i in 0..1000 {
            let z = 3.0 * (i as f32 / 500.0 - 1.0);
            let uz = 0.5f32.copysign(z);
            let mut folded = Ray { x: 0.0, y: 0.0, z, ux: 0.0, uy: 0.0, uz };
            boundary.fold(&mut folded);
            let (mut depth, mut cosine) = (z, uz);
            while !(0.0..=0.25).contains(&depth) {
                depth = if depth < 0.0 { -depth } else { 0.5 - depth };
                cosine = -cosine;
            }
            assert!((folded.z - depth).abs() < 1e-6, "{z}: {} {depth}", folded.z);
            let at_face = !(1e-6..=0.25 - 1e-6).contains(&depth);
            assert!(folded.uz == cosine || at_face, "{z}");
        }
    }
}
