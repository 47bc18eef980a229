//! Normalized diffusion and the refined profile with phase functions and boundaries, against the exact solution and
//! walks: what similarity alone is off by, and what its repair leaves.

#[path = "../../examples/similarity/tables.rs"]
mod tables;

use tables::{CONFIGURATIONS, Case, Point};
use translucid_profile::{
    Appearance, NormalizedDiffusion, Parameterization, Profile, RefinedDiffusion, SimilarRefinedDiffusion,
    Similarity,
};

const SURFACE_ALBEDOS: [f64; 2] = [0.3, 0.7];

/// L1 errors of normalized diffusion and of the refined profile, by similarity alone and repaired.
fn errors(case: Case, point: &Point) -> [[f64; 2]; 2] {
    let Case { g, eta, configuration } = case;
    let a = point.surface_albedo;
    let mfp = Parameterization::Mfp;
    let appearance = Appearance { surface_albedo: a, length: 1.0, parameterization: mfp, g };
    let transport_mfp = point.transport_mfp(g);
    let error = |profile: &dyn Profile| point.l1_error(|r| profile.enclosed(r) / a);
    [
        [
            error(&NormalizedDiffusion::new(a, transport_mfp, mfp, configuration).unwrap()),
            error(&NormalizedDiffusion::from_appearance(&appearance, eta, configuration).unwrap()),
        ],
        [
            error(&RefinedDiffusion::new(a, transport_mfp, mfp, configuration).unwrap()),
            error(&SimilarRefinedDiffusion::new(&appearance, eta, configuration).unwrap()),
        ],
    ]
}

/// Against the exact solution, at an index between those of the fit: the example `similarity` prints 20 % and 6 % for the worst
/// of neighboring indices at these albedos.
#[test]
fn boundary_is_repaired_as_stated() {
    for configuration in CONFIGURATIONS {
        for a in SURFACE_ALBEDOS {
            let case = Case { g: 0.0, eta: 1.35, configuration };
            let [normalized_diffusion, refined] = errors(case, &case.exact(a));
            let at = || format!("{configuration:?} {a}: {normalized_diffusion:?} {refined:?}");
            assert!(normalized_diffusion[0] > 0.25 && normalized_diffusion[1] < 0.2, "{}", at());
            assert!(refined[0] > 0.25 && refined[1] < 0.06, "{}", at());
        }
    }
}

/// Against a walk with seed 1, of which the two halves say that noise adds 1 % at most to an error: the limits leave
/// more than five times that above the stated errors of the neighbors on the grid, so a false alarm is rarer than 1e-6.
/// With a phase function and a boundary at once the limit is tight, for what they do together is seen nowhere else: the
/// 2 % that are stated on average, and the noise.
/// α is right within 5 standard errors and 3 % of 1 − α.
#[test]
fn phase_function_is_repaired_as_stated() {
    for configuration in CONFIGURATIONS {
        for (a, g, eta, most) in
            [(0.3, 0.6, 1.0, 0.1), (0.5, 0.5, 1.4, 0.03), (0.5, 0.85, 1.45, 0.1), (0.5, -0.4, 1.0, 0.1)]
        {
            let case = Case { g, eta, configuration };
            let point = case.walked_alone(a, 2.5e8);
            assert!(point.noise() < 0.01, "{}", point.noise());
            let [normalized_diffusion, refined] = errors(case, &point);
            let at = || format!("{configuration:?} {a} {g} {eta}: {normalized_diffusion:?} {refined:?}");
            assert!(normalized_diffusion[1] < normalized_diffusion[0].min(0.35), "{}", at());
            assert!(refined[1] < 0.5 * refined[0] && refined[1] < most, "{}", at());

            let found = Similarity::new(a, g, eta, configuration).unwrap().single_scattering_albedo();
            let [alpha, error] = point.single_scattering_albedo;
            assert!((found - alpha).abs() < 5.0 * error + 0.03 * (1.0 - alpha), "{}: {found} {alpha}", at());
        }
    }
}
