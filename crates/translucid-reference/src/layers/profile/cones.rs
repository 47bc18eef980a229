//! Light that the two outer faces reflect, by its directions.
//!
//! All layers have one index of refraction, so that rays are straight between the outer faces. With E = e^{−(τ + iknₓz)/μ}
//! from the upper face to a node, Ē from the lower one, E_b from face to face, and the reflectances F_t and F_b, the light of
//! a plane of sources at another node that was reflected is
//!
//! ```text
//! (1/4π) ∫ dΩ/μ [F_t E E' + F_b Ē Ē' + F_t F_b E_b (E Ē' + Ē E')]/(1 − F_t F_b E_b²)
//! ```
//!
//! and what leaves through the upper face (1/4π) ∫ dΩ (1 − F_t)(E + F_b E_b Ē)/(1 − F_t F_b E_b²).
//!
//! F is 1 beyond each critical angle and analytic within its cone. So the integral over the hemisphere is a sum over cones
//! of differences: that of the narrowest takes F of both faces less what the next one takes, where its own F is 1; the
//! hemisphere takes the rest less the mirror images F_t E E' + F_b Ē Ē', F = 1, which are known
//! ([`Kernel`](super::kernel::Kernel)). Directions of a cone are the bent arcs of
//! [`dielectric_directions`](crate::exact::dielectric_directions).

use num_complex::Complex64;

use crate::exact::complex::exp;
use crate::exact::dielectric_directions::{ConeDirection, DirectionCounts, cone_directions, transmittance};

use super::depths::{Depths, stride};

/// Indices of refraction above and below over that of the layers; 1 where nothing is reflected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Faces {
    pub(super) top: f64,
    pub(super) bottom: f64,
}

/// Directions of all cones.
#[derive(Clone, Debug, Default)]
pub(super) struct Cones {
    rays: Vec<ConeRay>,
}

/// One direction, with its reflectances and those that the next cone takes there.
#[derive(Clone, Debug)]
struct ConeRay {
    direction: ConeDirection,
    here: [Complex64; 2],
    next: Next,
}

#[derive(Clone, Copy, Debug)]
enum Next {
    Cone([Complex64; 2]),
    /// Faces that have a mirror image.
    Images([bool; 2]),
}

/// Light that leaves, of sources at each node: through the upper and through the lower face; all of it, and that which
/// was not reflected.
#[derive(Clone, Debug)]
pub(super) struct Leaving {
    pub(super) all: [Vec<Complex64>; 2],
    pub(super) straight: [Vec<Complex64>; 2],
    /// A fourth of the light of the ground, which emits by the cosine law, through the upper face and back to it.
    pub(super) of_ground: [Complex64; 2],
}

impl Faces {
    fn each(self) -> [f64; 2] {
        [self.top, self.bottom]
    }

    /// Sine of the critical angle, 1 if there is none.
    fn edges(self) -> [f64; 2] {
        self.each().map(|eta| eta.min(1.0))
    }

    /// Whether a face reflects.
    pub(super) fn reflects(self) -> [bool; 2] {
        self.each().map(|eta| eta != 1.0)
    }
}

impl Cones {
    pub(super) fn new(faces: Faces, counts: DirectionCounts) -> Self {
        let [top, bottom] = faces.reflects();
        if !top && !bottom {
            return Self::default();
        }
        let mut edges: Vec<f64> = (faces.edges().into_iter().zip([top, bottom]))
            .filter_map(|(edge, reflects)| reflects.then_some(edge))
            .collect();
        // Between mirrors light goes to and fro at all angles
        if top && bottom {
            edges.push(1.0);
        }
        edges.sort_by(f64::total_cmp);
        edges.dedup();
        let mut rays = Vec::new();
        for (i, edge) in edges.iter().enumerate() {
            for direction in cone_directions(*edge, counts) {
                let at = |edge: f64| reflectances(faces, edge, &direction);
                let is_last = i + 1 == edges.len();
                let next = match edges.get(i + 1) {
                    Some(next) => Next::Cone(at(*next)),
                    // One face alone: beyond its cone there is only its image
                    None if is_last && *edge < 1.0 => Next::Cone(at(1.0)),
                    None => Next::Images(faces.reflects()),
                };
                rays.push(ConeRay { here: at(*edge), next, direction });
            }
        }
        Self { rays }
    }

    /// Adds reflected light to the matrix, less images, and to what leaves.
    pub(super) fn add(
        &self,
        depths: &Depths,
        end: [f64; 2],
        k: Complex64,
        matrix: &mut [Complex64],
        leaving: &mut Leaving,
    ) {
        let size = depths.nodes.len();
        let q = -Complex64::I * k;
        let (mut from_top, mut from_bottom) = (vec![Complex64::ZERO; size], vec![Complex64::ZERO; size]);
        let mut sums = Split::new(size * size);
        let [mut top, mut bottom] = [Split::new(size), Split::new(size)];
        for ray in &self.rays {
            let ConeDirection { n_x, mu, solid_angle, .. } = ray.direction;
            let inverse = mu.inv();
            let [straight, lateral] = [inverse, q * n_x * inverse];
            let pass = |tau: f64, z: f64| exp(-(straight * tau + lateral * z));
            let has_end = end[0].is_finite();
            let through = if has_end { pass(end[0], end[1]) } else { Complex64::ZERO };
            for (i, node) in depths.nodes.iter().enumerate() {
                from_top[i] = pass(node.tau, node.z);
                if has_end {
                    from_bottom[i] = pass(end[0] - node.tau, end[1] - node.z);
                }
            }
            let here = Paths::of(ray.here, through);
            let next = match ray.next {
                Next::Cone(next) => Paths::of(next, through),
                Next::Images(images) => Paths::images(images, through),
            };
            let emitted = solid_angle * mu * through;
            leaving.of_ground[0] += emitted * (ray.passed(0) - ray.passed_next(0));
            leaving.of_ground[1] += emitted * through * (ray.passed_next(0) - ray.passed(0));
            let weight = solid_angle * inverse;
            let [a, b, c] = here.kernel_less(&next).map(|factor| factor * weight);
            top.set(&from_top);
            bottom.set(&from_bottom);
            for i in 0..size {
                let x = a * from_top[i] + c * from_bottom[i];
                sums.add(i * size + i, x, &top, i);
                if has_end {
                    let y = b * from_bottom[i] + c * from_top[i];
                    sums.add(i * size + i, y, &bottom, i);
                }
            }
            for side in 0..2 {
                let [near, far] =
                    if side == 0 { [&from_top, &from_bottom] } else { [&from_bottom, &from_top] };
                let [here, next] = [here.leaving[side], next.leaving[side]];
                let [direct, turned] = [0, 1].map(|i| (here[i] - next[i]) * solid_angle);
                let alone = (ray.passed(side) - ray.passed_next(side)) * solid_angle;
                for i in 0..size {
                    leaving.all[side][i] += direct * near[i] + turned * far[i];
                    leaving.straight[side][i] += alone * near[i];
                }
            }
        }
        for i in 0..size {
            for j in i..size {
                let value = sums.at(i * size + j);
                matrix[i * stride(size) + j] += value * depths.nodes[j].weight;
                if i != j {
                    matrix[j * stride(size) + i] += value * depths.nodes[i].weight;
                }
            }
        }
    }
}

impl ConeRay {
    fn passed(&self, side: usize) -> Complex64 {
        1.0 - self.here[side]
    }

    fn passed_next(&self, side: usize) -> Complex64 {
        match self.next {
            Next::Cone(next) => 1.0 - next[side],
            Next::Images(images) => Complex64::from(f64::from(u8::from(!images[side]))),
        }
    }
}

/// Reflectances of both faces within the cone of an edge, as the analytic functions that they are there.
fn reflectances(faces: Faces, edge: f64, direction: &ConeDirection) -> [Complex64; 2] {
    [0, 1].map(|side| {
        let ratio = faces.each()[side];
        if ratio == 1.0 {
            Complex64::ZERO
        } else if faces.edges()[side] < edge {
            Complex64::ONE
        } else {
            let outside = crate::exact::complex::sqrt(direction.outside_squared(ratio));
            1.0 - transmittance(direction.mu, outside, 1.0 / ratio)
        }
    })
}

/// Factors of the paths of one direction.
struct Paths {
    /// Of E E', Ē Ē' and E Ē' + Ē E'.
    kernel: [Complex64; 3],
    /// By face: of the ray towards it, and of that towards the other.
    leaving: [[Complex64; 2]; 2],
}

impl Paths {
    fn of([top, bottom]: [Complex64; 2], through: Complex64) -> Self {
        let both = top * bottom * through;
        let again = (1.0 - both * through).inv();
        Self {
            kernel: [top * again, bottom * again, both * again],
            leaving: [[top, bottom], [bottom, top]].map(|[own, other]| {
                let passed = (1.0 - own) * again;
                [passed, passed * other * through]
            }),
        }
    }

    fn images(images: [bool; 2], through: Complex64) -> Self {
        let [top, bottom] = images.map(|image| Complex64::from(f64::from(u8::from(image))));
        let leaving =
            [[top, bottom], [bottom, top]].map(|[own, other]| [1.0 - own, (1.0 - own) * other * through]);
        Self { kernel: [top, bottom, Complex64::ZERO], leaving }
    }

    fn kernel_less(&self, other: &Self) -> [Complex64; 3] {
        [0, 1, 2].map(|i| self.kernel[i] - other.kernel[i])
    }
}

/// Complex numbers as two rows, for the processor's vectors.
struct Split {
    re: Vec<f64>,
    im: Vec<f64>,
}

impl Split {
    fn new(size: usize) -> Self {
        Self { re: vec![0.0; size], im: vec![0.0; size] }
    }

    fn set(&mut self, values: &[Complex64]) {
        self.re.iter_mut().zip(values).for_each(|(part, value)| *part = value.re);
        self.im.iter_mut().zip(values).for_each(|(part, value)| *part = value.im);
    }

    fn at(&self, index: usize) -> Complex64 {
        Complex64::new(self.re[index], self.im[index])
    }

    /// Adds `factor` times a row, from `from` on, to the places from `place` on.
    fn add(&mut self, place: usize, factor: Complex64, row: &Self, from: usize) {
        let count = row.re.len() - from;
        let [row_re, row_im] = [&row.re[from..], &row.im[from..]];
        let re = &mut self.re[place..][..count];
        let im = &mut self.im[place..][..count];
        for i in 0..count {
            re[i] += factor.re * row_re[i] - factor.im * row_im[i];
            im[i] += factor.re * row_im[i] + factor.im * row_re[i];
        }
    }
}
