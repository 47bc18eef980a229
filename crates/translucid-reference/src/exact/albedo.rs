//! From surface albedos back to single-scattering albedos.

use translucid_profile::roots::falling_root;
use translucid_profile::{Configuration, ParameterError, half_space_single_scattering_albedo, require};

use super::boundary_entrance::BoundaryEntrance;
use super::dielectric::total;
use crate::Incidence;

/// Single-scattering albedo α of the half space with the surface albedo A ∈ (0, 1]: the inverse of
/// [`HalfSpace::total`](super::HalfSpace::total), for every entry and η = n_inside/n_outside ∈ [0.5, 3].
///
/// A comes back to 1e-12, to 1e-10 of [`HalfSpace::total`](super::HalfSpace::total) under a boundary; α is as good as A
/// divided by dA/dα. Under a boundary that total has its own error, as a part of it: for α = 0.5 and
/// [`Incidence::Cosine`] 5e-9 at η = 3, 1e-6 at 1.01, 8e-5 at 1.001 and 0.999, 2e-8 at 0.99 and 0.5.
/// Takes some 0.1 ms, under a boundary 0.1 s.
///
/// ```
/// use translucid_reference::Incidence;
/// use translucid_reference::exact::{HalfSpace, single_scattering_albedo};
///
/// let alpha = single_scattering_albedo(0.5, 1.4, Incidence::Cosine)?;
/// let half_space = HalfSpace::with_boundary(alpha, 1.4, Incidence::Cosine)?;
/// assert!((half_space.total().value - 0.5).abs() < 1e-10);
/// # Ok::<(), translucid_profile::ParameterError>(())
/// ```
///
/// # Errors
/// A parameter is outside its range, or a beam is totally reflected (η < 1).
pub fn single_scattering_albedo(
    surface_albedo: f64,
    eta: f64,
    incidence: Incidence,
) -> Result<f64, ParameterError> {
    let is_allowed = surface_albedo > 0.0 && surface_albedo <= 1.0;
    require(is_allowed, "surface_albedo", surface_albedo, "in (0, 1]")?;
    let entrance = BoundaryEntrance::checked(1.0, eta, incidence)?;
    let alpha = match (incidence, eta == 1.0) {
        _ if surface_albedo == 1.0 => 1.0,
        (Incidence::Pencil { cos_theta: 1.0 }, true) => {
            half_space_single_scattering_albedo(surface_albedo, Configuration::Searchlight)
        }
        (Incidence::Cosine, true) => {
            half_space_single_scattering_albedo(surface_albedo, Configuration::Diffuse)
        }
        // A = (1 − √(1−α))²/α
        (Incidence::UniformCosine, true) => {
            4.0 * surface_albedo / ((1.0 + surface_albedo) * (1.0 + surface_albedo))
        }
        _ => {
            // A is nearly straight in √(1 − α)
            let alpha = |root: f64| (1.0 - root * root).max(f64::MIN_POSITIVE);
            let excess = |root: f64| total(alpha(root), eta, entrance) - surface_albedo;
            alpha(falling_root(excess, [1.0 - surface_albedo, -surface_albedo], |root| 1e-14 + 2e-16 / root))
        }
    };
    // What leaves has been scattered: A < α, which rounding may have lost
    Ok(alpha.clamp(f64::MIN_POSITIVE, 1.0))
}

#[cfg(test)]
mod tests {
    use translucid_testing::is_thorough;

    use super::super::HalfSpace;
    use super::*;

    #[test]
    fn single_scattering_albedo_inverts_the_total() {
        let tilted = Incidence::Pencil { cos_theta: 0.3 };
        for (eta, tolerance) in [(1.0, 1e-12), (1.4, 1e-10), (0.8, 1e-10)] {
            for incidence in [Incidence::NORMAL, Incidence::Cosine, Incidence::UniformCosine, tilted] {
                if eta < 1.0 && incidence == tilted {
                    assert!(single_scattering_albedo(0.5, eta, incidence).is_err());
                    continue;
                }
                let has_own_solution = eta == 1.0 && incidence != tilted;
                let entrance = BoundaryEntrance::checked(1.0, eta, incidence).unwrap();
                let surface_albedos = [1e-6, 0.3, 0.9999, 0.01, 0.7, 0.99];
                // Under a boundary each takes a tenth of a second
                let few = if has_own_solution || is_thorough() { 6 } else { 3 };
                for surface_albedo in surface_albedos.into_iter().take(few) {
                    let alpha = single_scattering_albedo(surface_albedo, eta, incidence).unwrap();
                    let back = if has_own_solution {
                        HalfSpace::new(alpha, incidence).unwrap().total().value
                    } else {
                        total(alpha, eta, entrance)
                    };
                    // α has no digits beyond its sixteenth
                    let allowed = tolerance * surface_albedo.max(1e-3) + 3e-16 / (1.0 - surface_albedo);
                    assert!(
                        (back - surface_albedo).abs() < allowed,
                        "{eta} {incidence:?} {surface_albedo}: {back}"
                    );
                }
            }
        }
    }

    #[test]
    fn total_is_that_of_the_half_space() {
        for (eta, incidence) in [(1.4, Incidence::NORMAL), (1.0, Incidence::Pencil { cos_theta: 0.5 })] {
            let half_space = HalfSpace::with_boundary(0.9, eta, incidence).unwrap().total();
            let entrance = BoundaryEntrance::checked(0.9, eta, incidence).unwrap();
            assert!((total(0.9, eta, entrance) - half_space.value).abs() < 1e-14 + half_space.error);
        }
    }

    #[test]
    fn single_scattering_albedo_refuses_what_has_no_meaning() {
        for albedo in [0.0, -0.1, 1.1, f64::NAN, f64::INFINITY] {
            assert!(single_scattering_albedo(albedo, 1.0, Incidence::NORMAL).is_err());
        }
        assert!(single_scattering_albedo(0.5, 9.0, Incidence::NORMAL).is_err());
        assert!(single_scattering_albedo(0.5, f64::NAN, Incidence::NORMAL).is_err());
        for eta in [1.0, 1.4] {
            assert_eq!(single_scattering_albedo(1.0, eta, Incidence::NORMAL), Ok(1.0));
            let faint = single_scattering_albedo(1e-300, eta, Incidence::Cosine).unwrap();
            assert!(faint > 0.0 && faint < 1e-290, "{faint}");
        }
    }
}
