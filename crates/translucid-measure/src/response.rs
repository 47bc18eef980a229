//! Response of a half space to light that varies across its surface.

use std::f64::consts::{LN_10, PI};
use std::sync::OnceLock;

use translucid_profile::ParameterError;
use translucid_reference::exact::{HalfSpaceTransform, SeenFromAbove, single_scattering_albedo};
use translucid_reference::{Incidence, specular_reflectance};

use crate::cubic_lagrange::lagrange_weights;
use crate::slab::{Slab, SlabTransfer};

/// Responses of pieces to stripes of light: half spaces of isotropic scatterers, or what they are compared with.
///
/// ```text
/// T(κ; A) = R̂(κ/ℓ) / R̂(0),     R̂(k) = ∫ R(r) J₀(kr) 2πr dr
/// ```
///
/// κ = kℓ is the wave number of the stripes in reciprocal mean free paths.
/// The modulation |T| is tabulated as ln(1/|T| − 1), which is a straight line in ln κ where κ is small and where it is large,
/// and smooth in √(1 − A); beside it the phase, which light has where it enters obliquely.
///
/// ```
/// use translucid_measure::Response;
/// use translucid_reference::{Incidence, exact::HalfSpace};
///
/// # fn main() -> Result<(), translucid_profile::ParameterError> {
/// let response = Response::new(1.0, Incidence::Cosine)?;
/// let exact = HalfSpace::from_surface_albedo(0.77, Incidence::Cosine)?.hankel(0.6).value / 0.77;
/// assert!((response.transfer(0.77, 2.0).at(0.3)[0] - exact).abs() < 2e-6);
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Response(Kind);

#[derive(Debug)]
enum Kind {
    HalfSpaces(HalfSpaces),
    Slab(Slab),
    Exponentials { weight: f64, ratio: f64 },
}

/// Light that enters half spaces, and the direction from which they are seen.
#[derive(Clone, Copy, Debug)]
enum Lighting {
    /// Light of an incidence, seen by its exitance (or the other way round: light of all directions, seen along one).
    Exitance { eta: f64, incidence: Incidence },
    /// A beam at this angle, seen from straight above, without a boundary.
    Beam { angle: f64 },
}

#[derive(Debug)]
struct HalfSpaces {
    lighting: Lighting,
    /// Rows by √(1 − A), each solved when it is first asked for.
    rows: Vec<OnceLock<Row>>,
}

/// A surface albedo's row.
#[derive(Clone, Debug, Default)]
struct Row {
    /// Light that is seen over that of white.
    level: f64,
    /// ln(1/|T| − 1) and the phase of T, by ln κ.
    entries: Vec<[f64; 2]>,
}

/// Greatest surface albedo of a row, and the least: its square root of 1 − A is that of the last row.
const ALBEDOS: [f64; 2] = [0.9999, 0.005];
/// Rows of a table.
const ROWS: usize = 72;
/// Decimal logarithm of the least wave number, and of the greatest.
const DECADES: [f64; 2] = [-3.5, 3.0];
/// Wave numbers of each decade.
const PER_DECADE: usize = 16;

impl Response {
    /// Half spaces of a relative refractive index η under light of an incidence, solved as far as they are asked for: a
    /// fit needs a part of the table, whose rows take long under a boundary.
    ///
    /// # Errors
    /// η is not in \[0.5, 3\], or a beam's cosine not in (0, 1].
    pub fn new(eta: f64, incidence: Incidence) -> Result<Self, ParameterError> {
        Self::lit(Lighting::Exitance { eta, incidence })
    }

    /// Half spaces without a boundary in a parallel beam at an angle to the normal \[radians\], as a camera straight above sees
    /// them; a positive angle tilts the beam toward growing places.
    ///
    /// # Errors
    /// The cosine of the angle is not in (0, 1].
    pub fn of_beam(angle: f64) -> Result<Self, ParameterError> {
        Self::lit(Lighting::Beam { angle })
    }

    /// Slabs of a thickness \[L\], without a boundary, on a Lambertian panel of light, as a camera on the other side sees them: their
    /// exitance, for [`Incidence::Cosine`], or else what leaves along the normal.
    pub fn of_slab(thickness: f64, incidence: Incidence) -> Self {
        Self(Kind::Slab(Slab::new(thickness, incidence)))
    }

    fn lit(lighting: Lighting) -> Result<Self, ParameterError> {
        let rows = (0..ROWS).map(|_| OnceLock::new()).collect();
        let half_spaces = HalfSpaces { lighting, rows };
        // What is refused is so for every surface albedo
        half_spaces.solve(ROWS / 2)?;
        Ok(Self(Kind::HalfSpaces(half_spaces)))
    }

    /// Mixtures of two exponentials with the width d in place of the mean free path, no solution of the equation of transfer,
    /// to see whether a half space explains light better:
    ///
    /// ```text
    /// R ∝ [w e^{−r/d}/d + (1 − w) e^{−r/ρd}/ρd] / r,     T = w/√(1 + κ²) + (1 − w)/√(1 + ρ²κ²),     κ = kd
    /// ```
    pub fn exponentials(weight: f64, ratio: f64) -> Self {
        Self(Kind::Exponentials { weight, ratio })
    }

    /// Normalized diffusion \[Christensen and Burley 2015\]: [exponentials](Self::exponentials) with w = ¼, ρ = 3.
    pub fn normalized_diffusion() -> Self {
        Self::exponentials(0.25, 3.0)
    }

    /// Light that is seen of an evenly lit piece, over that of a white surface.
    pub fn level(&self, surface_albedo: f64, mfp: f64) -> f64 {
        match &self.0 {
            // More scatters than there is light: it goes on in proportion
            Kind::Slab(slab) => slab.transfer(surface_albedo, mfp).level() * surface_albedo.max(1.0),
            Kind::HalfSpaces(half_spaces) => half_spaces.level(surface_albedo),
            Kind::Exponentials { .. } => surface_albedo,
        }
    }

    /// Surface albedo in \[0.005, 0.9999\] at which an evenly lit piece has a [level](Self::level), or the nearest one.
    pub(crate) fn albedo_of_level(&self, level: f64, mfp: f64) -> f64 {
        let [mut high, mut low] = ALBEDOS;
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if self.level(middle, mfp) < level { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    /// T of a surface albedo, clamped to \[0.005, 0.9999\], and a mean free path \[L\].
    pub fn transfer(&self, surface_albedo: f64, mfp: f64) -> Transfer<'_> {
        let shape = match &self.0 {
            Kind::HalfSpaces(half_spaces) => half_spaces.transfer(surface_albedo),
            Kind::Slab(slab) => Shape::Slab(slab.transfer(surface_albedo, mfp)),
            Kind::Exponentials { weight, ratio } => Shape::Exponentials { weight: *weight, ratio: *ratio },
        };
        Transfer { shape, mfp }
    }
}

/// Response of one piece to stripes of light.
#[derive(Clone, Debug)]
pub struct Transfer<'a> {
    shape: Shape<'a>,
    mfp: f64,
}

#[derive(Clone, Debug)]
enum Shape<'a> {
    /// Four rows, their weights, and what is to be added to ln(1/|T| − 1).
    Rows([&'a [[f64; 2]]; 4], [f64; 4], f64),
    Slab(SlabTransfer),
    Exponentials {
        weight: f64,
        ratio: f64,
    },
}

impl Transfer<'_> {
    /// Real and imaginary part of T of a wave number k ≥ 0 \[L⁻¹\]: of the light in phase with the stripes, and a quarter of
    /// a period before them. |T| is in \[0, 1\].
    pub fn at(&self, k: f64) -> [f64; 2] {
        let kappa = k * self.mfp;
        if kappa.is_nan() || kappa <= 0.0 {
            return [1.0, 0.0];
        }
        match &self.shape {
            Shape::Rows(rows, weights, offset) => {
                let column = (libm::log10(kappa.min(1e30)) - DECADES[0]) * PER_DECADE as f64;
                let (first, of_column) = lagrange_weights(rows[0].len(), column);
                let mut entry = [*offset, 0.0];
                for (row, of_row) in rows.iter().zip(weights) {
                    for (value, weight) in row.iter().skip(first).zip(of_column) {
                        entry[0] += of_row * weight * value[0];
                        entry[1] += of_row * weight * value[1];
                    }
                }
                let modulation = 1.0 / (1.0 + libm::exp(entry[0]));
                // Most tables have no phase
                if entry[1] == 0.0 {
                    return [modulation, 0.0];
                }
                let (sin, cos) = libm::sincos(entry[1].max(-PI).min(PI));
                [modulation * cos, modulation * sin]
            }
            Shape::Slab(slab) => [slab.at(k), 0.0],
            Shape::Exponentials { weight, ratio } => {
                let of = |kappa: f64| 1.0 / (1.0 + kappa * kappa).sqrt();
                [weight * of(kappa) + (1.0 - weight) * of(ratio * kappa), 0.0]
            }
        }
    }
}

impl HalfSpaces {
    fn row(&self, i: usize) -> &Row {
        self.rows[i].get_or_init(|| self.solve(i).unwrap_or_default())
    }

    fn solve(&self, i: usize) -> Result<Row, ParameterError> {
        let root = root_of(ALBEDOS[0]) + step() * i as f64;
        let surface_albedo = 1.0 - root * root;
        Ok(match self.lighting {
            Lighting::Exitance { eta, incidence } => {
                let alpha = single_scattering_albedo(surface_albedo, eta, incidence)?;
                let transform = HalfSpaceTransform::new(alpha, eta, incidence)?;
                Row::new(|kappa| [transform.at(kappa), 0.0])
            }
            Lighting::Beam { angle } => {
                let alpha = single_scattering_albedo(surface_albedo, 1.0, Incidence::NORMAL)?;
                let seen = SeenFromAbove::new(alpha, libm::cos(angle))?;
                let mut row = Row::new(|kappa| {
                    let [re, im] = seen.transform(kappa);
                    [re, im.copysign(-angle)]
                });
                let offset = self.offset(surface_albedo);
                row.entries.iter_mut().for_each(|[value, _]| *value -= offset);
                row
            }
        })
    }

    fn transfer(&self, surface_albedo: f64) -> Shape<'_> {
        let (first, weights) = lagrange_weights(ROWS, place_of(surface_albedo));
        let offset = self.offset(surface_albedo.max(ALBEDOS[1]).min(ALBEDOS[0]));
        Shape::Rows([0, 1, 2, 3].map(|i| self.row(first + i).entries.as_slice()), weights, offset)
    }

    /// What rows leave out of ln(1/|T| − 1): light that is scattered once goes straight back along a beam from above, 1 − T is
    /// in proportion to A where that is small.
    fn offset(&self, surface_albedo: f64) -> f64 {
        match self.lighting {
            Lighting::Beam { angle: 0.0 } => libm::log(surface_albedo),
            _ => 0.0,
        }
    }

    fn level(&self, surface_albedo: f64) -> f64 {
        if let Lighting::Exitance { eta, incidence } = self.lighting {
            // Without a row, of which below a boundary each takes a second
            return (1.0 - specular_reflectance(incidence, eta)) * surface_albedo;
        }
        let (first, weights) = lagrange_weights(ROWS, place_of(surface_albedo));
        // In proportion to A it is smooth where A is small, and goes on where A is none
        let over_albedo = |i: usize| {
            let root = root_of(ALBEDOS[0]) + step() * i as f64;
            self.row(i).level / (1.0 - root * root)
        };
        surface_albedo * (0..4).map(|i| weights[i] * over_albedo(first + i)).sum::<f64>()
    }
}

impl Row {
    fn new(transform: impl Fn(f64) -> [f64; 2]) -> Self {
        let [level, _] = transform(0.0);
        let entry = |j: usize| {
            let kappa = libm::exp(LN_10 * (DECADES[0] + j as f64 / PER_DECADE as f64));
            let [re, im] = transform(kappa);
            // Where hardly any contrast is lost, rounding may leave less than none
            [libm::log((level / re.hypot(im) - 1.0).max(1e-12)), libm::atan2(im, re)]
        };
        let columns = ((DECADES[1] - DECADES[0]) * PER_DECADE as f64) as usize + 1;
        Self { level, entries: (0..columns).map(entry).collect() }
    }
}

fn root_of(surface_albedo: f64) -> f64 {
    (1.0 - surface_albedo).sqrt()
}

fn step() -> f64 {
    (root_of(ALBEDOS[1]) - root_of(ALBEDOS[0])) / (ROWS - 1) as f64
}

/// Row of a surface albedo.
fn place_of(surface_albedo: f64) -> f64 {
    let albedo = surface_albedo.max(ALBEDOS[1]).min(ALBEDOS[0]);
    (root_of(albedo) - root_of(ALBEDOS[0])) / step()
}

#[cfg(test)]
mod tests {
    use translucid_profile::NormalizedDiffusion;
    use translucid_reference::exact::HalfSpace;

    use super::*;

    #[test]
    fn table_is_the_exact_solution() {
        for incidence in [Incidence::Cosine, Incidence::NORMAL] {
            let response = Response::new(1.0, incidence).unwrap();
            let mut worst = 0.0_f64;
            for surface_albedo in [0.01, 0.123, 0.5, 0.831, 0.97, 0.995] {
                let exact = HalfSpace::from_surface_albedo(surface_albedo, incidence).unwrap();
                for i in 0..60 {
                    let kappa = 1e-4 * libm::exp(0.3 * f64::from(i));
                    let error = response.transfer(surface_albedo, 1.0).at(kappa)[0]
                        - exact.hankel(kappa).value / surface_albedo;
                    worst = worst.max(error.abs());
                }
            }
            assert!(worst < 1e-5, "{incidence:?}: {worst}");
        }
    }

    #[test]
    fn normalized_diffusion_is_its_own_transform() {
        let response = Response::normalized_diffusion();
        let profile = NormalizedDiffusion::from_d(1.0, 1.0).unwrap();
        for kappa in [0.1, 0.7, 3.0] {
            // ∫ R J₀(κr) 2πr dr by Simpson's rule
            let (n, h) = (40_000, 60.0 / 40_000.0);
            let at = |i: i32| {
                let r = (h * f64::from(i)).max(1e-12);
                profile.eval(r) * libm::j0(kappa * r) * std::f64::consts::TAU * r
            };
            let sum: f64 = (1..n).map(|i| if i % 2 == 1 { 4.0 * at(i) } else { 2.0 * at(i) }).sum();
            let transform = (at(0) + sum + at(n)) * h / 3.0;
            assert!(
                (response.transfer(0.5, 1.0).at(kappa)[0] - transform).abs() < 1e-6,
                "{kappa}: {transform}"
            );
        }
    }

    /// Below a smooth boundary of η = 1.4 two albedos, between the table's rows.
    #[test]
    fn table_below_a_boundary_is_the_exact_solution() {
        let response = Response::new(1.4, Incidence::Cosine).unwrap();
        assert!(
            (response.level(0.4, 1.0) / 0.4 - (1.0 - specular_reflectance(Incidence::Cosine, 1.4))).abs()
                < 1e-12
        );
        for surface_albedo in [0.4, 0.87] {
            let alpha = single_scattering_albedo(surface_albedo, 1.4, Incidence::Cosine).unwrap();
            let exact = HalfSpace::with_boundary(alpha, 1.4, Incidence::Cosine).unwrap();
            for kappa in [1e-3, 0.05, 0.3, 2.0, 30.0] {
                let error = response.transfer(surface_albedo, 1.0).at(kappa)[0]
                    - exact.hankel(kappa).value / surface_albedo;
                assert!(error.abs() < 1e-5, "{surface_albedo} {kappa}: {error}");
            }
        }
        assert!(Response::new(0.1, Incidence::Cosine).is_err());
        assert!(Response::new(f64::NAN, Incidence::Cosine).is_err());
    }

    #[test]
    fn any_number_gives_a_transfer() {
        let response = Response::new(1.0, Incidence::Cosine).unwrap();
        for albedo in [f64::NAN, -1.0, 0.0, 0.5, 1.0, 2.0] {
            for kappa in [f64::NAN, -1.0, 0.0, 1e-300, 1e-3, 1.0, 1e3, 1e9, 1e300, f64::INFINITY] {
                let transfer = response.transfer(albedo, 1.0).at(kappa)[0];
                assert!((0.0..=1.0).contains(&transfer), "{albedo} {kappa}: {transfer}");
            }
        }
    }

    #[test]
    fn beam_is_the_exact_solution() {
        for angle in [0.0, 0.9, -0.9] {
            let response = Response::of_beam(angle).unwrap();
            for surface_albedo in [0.02, 0.4, 0.87, 0.98] {
                let alpha = single_scattering_albedo(surface_albedo, 1.0, Incidence::NORMAL).unwrap();
                let exact = SeenFromAbove::new(alpha, libm::cos(angle)).unwrap();
                let [level, _] = exact.transform(0.0);
                assert!((response.level(surface_albedo, 1.0) / level - 1.0).abs() < 1e-5);
                for kappa in [1e-3, 0.05, 0.3, 2.0, 30.0] {
                    let [re, im] = exact.transform(kappa).map(|v| v / level);
                    let expected = [re, if angle < 0.0 { -im } else { im }];
                    let found = response.transfer(surface_albedo, 1.0).at(kappa);
                    let error = (found[0] - expected[0]).hypot(found[1] - expected[1]);
                    assert!(error < 1e-4, "{angle} {surface_albedo} {kappa}: {found:?} {expected:?}");
                }
            }
        }
        assert!(Response::of_beam(1.6).is_err() && Response::of_beam(f64::NAN).is_err());
    }
}
