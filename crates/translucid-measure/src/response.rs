//! How a half space answers light that varies across its surface.

use std::f64::consts::LN_10;
use std::sync::OnceLock;

use translucid_profile::ParameterError;
use translucid_reference::exact::{HalfSpace, single_scattering_albedo};
use translucid_reference::{Incidence, specular_reflectance};

/// Modulation transfer function of half spaces of isotropic scatterers: how much of a stripe pattern's contrast is left in
/// the light that leaves.
///
/// ```text
/// T(κ; A) = R̂(κ/ℓ) / A,     R̂(k) = ∫ R(r) J₀(kr) 2πr dr
/// ```
///
/// κ = kℓ is the wave number of the stripes in reciprocal mean free paths.
/// It is tabulated as ln(1/T − 1), which is a straight line in ln κ where κ is small and where it is large, and smooth in
/// √(1 − A).
///
/// ```
/// use translucid_measure::Response;
/// use translucid_reference::{Incidence, exact::HalfSpace};
///
/// # fn main() -> Result<(), translucid_profile::ParameterError> {
/// let response = Response::new(1.0, Incidence::Cosine)?;
/// let exact = HalfSpace::from_surface_albedo(0.77, Incidence::Cosine)?.hankel(0.6).value / 0.77;
/// assert!((response.at(0.77, 0.6) - exact).abs() < 2e-6);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Response(Transfer);

#[derive(Clone, Debug)]
enum Transfer {
    HalfSpaces(HalfSpaces),
    NormalizedDiffusion,
}

#[derive(Clone, Debug)]
struct HalfSpaces {
    eta: f64,
    incidence: Incidence,
    /// ln(1/T − 1), by √(1 − A) and ln κ; a row is solved when it is asked for.
    rows: Vec<OnceLock<Vec<f64>>>,
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
    /// Half spaces of a relative refractive index η under light of an incidence, solved as far as they are asked for: the
    /// whole table is 0.5 s without a boundary (η = 1) and half a minute with one, of which a fit needs a part.
    ///
    /// # Errors
    /// η is not in \[0.5, 3\], or a beam's cosine not in (0, 1].
    pub fn new(eta: f64, incidence: Incidence) -> Result<Self, ParameterError> {
        let rows = (0..ROWS).map(|_| OnceLock::new()).collect();
        let half_spaces = HalfSpaces { eta, incidence, rows };
        // What is refused is so for every surface albedo
        half_spaces.solve(ROWS / 2)?;
        Ok(Self(Transfer::HalfSpaces(half_spaces)))
    }

    /// Normalized diffusion of the width d in place of the mean free path \[Christensen and Burley 2015\], to see whether a
    /// half space explains light better:
    ///
    /// ```text
    /// T = ¼/√(1 + κ²) + ¾/√(1 + 9κ²),     κ = kd
    /// ```
    pub fn normalized_diffusion() -> Self {
        Self(Transfer::NormalizedDiffusion)
    }

    /// Part of the incident light that the boundary lets in, in (0, 1].
    pub fn entering(&self) -> f64 {
        match &self.0 {
            Transfer::HalfSpaces(HalfSpaces { eta, incidence, .. }) => {
                1.0 - specular_reflectance(*incidence, *eta)
            }
            Transfer::NormalizedDiffusion => 1.0,
        }
    }

    /// T of a surface albedo, clamped to \[0.005, 0.9999\], and a wave number κ = kℓ ≥ 0, in \[0, 1\].
    pub fn at(&self, surface_albedo: f64, kappa: f64) -> f64 {
        if kappa.is_nan() || kappa <= 0.0 {
            return 1.0;
        }
        match &self.0 {
            Transfer::HalfSpaces(half_spaces) => half_spaces.at(surface_albedo, kappa),
            Transfer::NormalizedDiffusion => {
                0.25 / (1.0 + kappa * kappa).sqrt() + 0.75 / (1.0 + 9.0 * kappa * kappa).sqrt()
            }
        }
    }
}

impl HalfSpaces {
    fn row(&self, i: usize) -> &[f64] {
        // An empty row is none that a response has
        self.rows[i].get_or_init(|| self.solve(i).unwrap_or_default())
    }

    fn solve(&self, i: usize) -> Result<Vec<f64>, ParameterError> {
        let root = root_of(ALBEDOS[0]) + step() * i as f64;
        let surface_albedo = 1.0 - root * root;
        let alpha = single_scattering_albedo(surface_albedo, self.eta, self.incidence)?;
        let half_space = HalfSpace::with_boundary(alpha, self.eta, self.incidence)?;
        let total = half_space.hankel(0.0).value;
        let entry = |j: usize| {
            let kappa = libm::exp(LN_10 * (DECADES[0] + j as f64 / PER_DECADE as f64));
            // Where hardly any contrast is lost, rounding may leave less than none
            libm::log((total / half_space.hankel(kappa).value - 1.0).max(1e-12))
        };
        let columns = ((DECADES[1] - DECADES[0]) * PER_DECADE as f64) as usize + 1;
        Ok((0..columns).map(entry).collect())
    }

    fn at(&self, surface_albedo: f64, kappa: f64) -> f64 {
        let albedo = surface_albedo.max(ALBEDOS[1]).min(ALBEDOS[0]);
        let row = (root_of(albedo) - root_of(ALBEDOS[0])) / step();
        let column = (libm::log10(kappa.min(1e30)) - DECADES[0]) * PER_DECADE as f64;
        let value = cubic(self.rows.len(), row, |i| {
            let row = self.row(i);
            cubic(row.len(), column, |j| row[j])
        });
        1.0 / (1.0 + libm::exp(value))
    }
}

fn root_of(surface_albedo: f64) -> f64 {
    (1.0 - surface_albedo).sqrt()
}

fn step() -> f64 {
    (root_of(ALBEDOS[1]) - root_of(ALBEDOS[0])) / (ROWS - 1) as f64
}

/// Cubic through the four of `count` values around a place; a straight line beyond the ends.
fn cubic(count: usize, place: f64, value: impl Fn(usize) -> f64) -> f64 {
    let last = (count - 1) as f64;
    if place <= 0.0 {
        return value(0) + place * (value(1) - value(0));
    }
    if place >= last {
        return value(count - 1) + (place - last) * (value(count - 1) - value(count - 2));
    }
    // The interval's neighbors, one further inside at the ends
    let first = (place.floor() as usize).saturating_sub(1).min(count - 4);
    let t = place - first as f64;
    let [a, b, c, d] = [0, 1, 2, 3].map(|i| value(first + i));
    let (t1, t2, t3) = (t - 1.0, t - 2.0, t - 3.0);
    -a * t1 * t2 * t3 / 6.0 + b * t * t2 * t3 / 2.0 - c * t * t1 * t3 / 2.0 + d * t * t1 * t2 / 6.0
}

#[cfg(test)]
mod tests {
    use translucid_profile::NormalizedDiffusion;

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
                    let error =
                        response.at(surface_albedo, kappa) - exact.hankel(kappa).value / surface_albedo;
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
            assert!((response.at(0.5, kappa) - transform).abs() < 1e-6, "{kappa}: {transform}");
        }
    }

    /// Below a smooth boundary of η = 1.4 two albedos, between the table's rows.
    #[test]
    fn table_below_a_boundary_is_the_exact_solution() {
        let response = Response::new(1.4, Incidence::Cosine).unwrap();
        assert!((response.entering() - (1.0 - specular_reflectance(Incidence::Cosine, 1.4))).abs() < 1e-15);
        for surface_albedo in [0.4, 0.87] {
            let alpha = single_scattering_albedo(surface_albedo, 1.4, Incidence::Cosine).unwrap();
            let exact = HalfSpace::with_boundary(alpha, 1.4, Incidence::Cosine).unwrap();
            for kappa in [1e-3, 0.05, 0.3, 2.0, 30.0] {
                let error = response.at(surface_albedo, kappa) - exact.hankel(kappa).value / surface_albedo;
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
                let transfer = response.at(albedo, kappa);
                assert!((0.0..=1.0).contains(&transfer), "{albedo} {kappa}: {transfer}");
            }
        }
    }
}
