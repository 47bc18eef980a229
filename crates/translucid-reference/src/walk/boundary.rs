//! The faces of the medium: where photons cross them, and whether they get through.

use super::random::Stream;
use super::{Problem, Side};

/// The faces z = 0 and, of a slab, z = thickness.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Boundary {
    /// Thickness; infinite for the half space.
    pub(crate) thickness: f32,
    /// Whether all light gets through, η = 1.
    pub(crate) matched: bool,
    /// n_inside/n_outside.
    eta: f32,
    /// 1 − η².
    one_minus_square: f32,
    /// Light with a lower squared cosine reflects totally; negative where none does.
    pub(crate) total_below: f32,
}

/// Position and direction of a photon.
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
        let eta = parameters.eta;
        let one_minus_square = (1.0 - eta) * (1.0 + eta);
        Self {
            // A slab thinner than single precision can say is the thinnest it can say
            thickness: (parameters.thickness as f32).max(f32::MIN_POSITIVE),
            matched: eta == 1.0,
            eta: eta as f32,
            one_minus_square: one_minus_square as f32,
            total_below: (-one_minus_square / (eta * eta)) as f32,
        }
    }

    /// Whether a depth is beyond a face.
    #[inline(always)]
    pub(crate) fn is_outside(&self, z: f32) -> bool {
        z < 0.0 || z > self.thickness
    }

    /// Brings a photon back whose flight ended beyond a face, or lets it out.
    ///
    /// `ray` is at the end of a flight that does not know of faces, beyond one. A reflection mirrors what was beyond the
    /// face, the rest of the flight in one step. Returns the face that the photon left through, with `ray` on
    /// it, or nothing, with `ray` inside.
    pub(crate) fn cross(&self, ray: &mut Ray, stream: &mut Stream<u32>) -> Option<Side> {
        debug_assert!(self.is_outside(ray.z), "{ray:?}");
        if ray.uz * ray.uz < self.total_below {
            self.fold(ray);
            return None;
        }
        let reflectance = if self.matched { 0.0 } else { self.reflectance(ray.uz.abs()) };
        if self.matched || unit(stream.next()) >= reflectance {
            return Some(self.leave(ray, 0.0));
        }
        let face = if ray.z < 0.0 { 0.0 } else { self.thickness };
        ray.z = 2.0 * face - ray.z;
        ray.uz = -ray.uz;
        if !self.is_outside(ray.z) {
            return None;
        }

        // A thin slab: draw at once how many more reflections in a row there are, and compare with the faces
        // that the flight meets
        let logs = [unit(stream.next()), reflectance].map(|share| f64::from(share).ln().abs());
        let reflections = (logs[0] / logs[1]).floor();
        let faces = 1.0 + (self.beyond(ray) / f64::from(self.thickness)).floor();
        if reflections < faces {
            return Some(self.leave(ray, reflections));
        }
        self.fold(ray);
        None
    }

    /// How far the depth is beyond the nearer face.
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

    /// Fresnel's reflectance from inside (A.-J. Fresnel 1823) for η ≠ 1 and a cosine above the critical one.
    fn reflectance(&self, mu: f32) -> f32 {
        let outside = (self.eta * self.eta * mu * mu + self.one_minus_square).clamp(0.0, 1.0).sqrt();
        let perpendicular = (self.eta * mu - outside) / (self.eta * mu + outside);
        let parallel = (self.eta * outside - mu) / (self.eta * outside + mu);
        0.5 * (perpendicular * perpendicular + parallel * parallel)
    }
}

/// Uniform in (0, 1], as the lanes have it.
#[inline(always)]
fn unit(word: u32) -> f32 {
    (word | 1) as f32 * (1.0 / 4294967296.0)
}

#[cfg(test)]
mod tests {
    use translucid_profile::fresnel_from_inside;

    use super::super::random::Key;
    use super::super::{Parameters, Problem};
    use super::*;

    fn boundary(eta: f64, thickness: f64) -> Boundary {
        Boundary::new(&Problem::new(Parameters { eta, thickness, ..Parameters::default() }).unwrap())
    }

    #[test]
    fn reflectance_is_fresnels() {
        for eta in [0.1, 0.7, 0.999, 1.001, 1.33, 1.5, 3.0, 10.0] {
            let boundary = boundary(eta, f64::INFINITY);
            for i in 1..=1000 {
                let mu = i as f32 / 1000.0;
                let exact = fresnel_from_inside(f64::from(mu), eta);
                let total = mu * mu < boundary.total_below;
                let found = if total { 1.0 } else { boundary.reflectance(mu) };
                // Beside the critical angle F rises steeply: a rounding of the cosine counts as its root
                let near = (f64::from(mu * mu) - f64::from(boundary.total_below)).abs() * eta * eta;
                let bound = if near < 1e-4 { 5e-3 } else { 2e-6 * (1.0 + eta / near.sqrt()) };
                assert!((f64::from(found) - exact).abs() < bound, "{eta} {mu}: {found} {exact}");
            }
        }
    }

    #[test]
    fn crossing_ends_on_a_face_or_inside() {
        let mut stream = Stream::new(Key::new(5), 0);
        for eta in [0.1, 0.7, 1.0, 1.4, 10.0] {
            for thickness in [1e-300, 1e-20, 1e-6, 0.3, 5.0, f64::INFINITY] {
                let boundary = boundary(eta, thickness);
                for _ in 0..300 {
                    let uz = 2.0 * unit(stream.next()) - 1.0;
                    let flight = -unit(stream.next()).ln();
                    let start = boundary.thickness.min(1.0) * unit(stream.next());
                    let ux = (1.0 - uz * uz).sqrt();
                    let mut ray = Ray { x: flight * ux, y: 0.0, z: start + flight * uz, ux, uy: 0.0, uz };
                    if !boundary.is_outside(ray.z) {
                        continue;
                    }
                    let side = boundary.cross(&mut ray, &mut stream);
                    match side {
                        None => assert!(!boundary.is_outside(ray.z), "{eta} {thickness}: {ray:?}"),
                        Some(Side::Reflected) => assert!(ray.z == 0.0 && ray.uz < 0.0, "{ray:?}"),
                        Some(Side::Transmitted) => {
                            assert!(ray.z == boundary.thickness && ray.uz > 0.0, "{ray:?}")
                        }
                    }
                    assert!(
                        ray.x >= -1e-6 && ray.x <= flight * ux * 1.000001 + 1e-6,
                        "{eta} {thickness}: {ray:?}"
                    );
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
            while boundary.is_outside(depth) {
                depth = if depth < 0.0 { -depth } else { 0.5 - depth };
                cosine = -cosine;
            }
            assert!((folded.z - depth).abs() < 1e-6, "{z}: {} {depth}", folded.z);
            assert!(folded.uz == cosine || depth < 1e-6 || depth > 0.25 - 1e-6, "{z}");
        }
    }
}
