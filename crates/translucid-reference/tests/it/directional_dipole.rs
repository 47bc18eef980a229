//! Errors of the directional dipole by angle of incidence: against the exact half space where there is no
//! boundary, the walk where there is one.
//!
//! Errors are area-weighted L1 distances ∫|R_model − R| dA / ∫ R dA over the whole surface. They are figures of
//! the model, not of its implementation, which `naive_directional.rs` in `translucid-profile` checks; they are
//! asserted as they are, to 0.005, so that whoever changes the model sees what it did.

use std::collections::HashMap;
use std::f64::consts::PI;
use std::sync::{Arc, LazyLock, Mutex, OnceLock};

use translucid_profile::quadrature::{gauss_legendre, integrate};
use translucid_profile::{
    Appearance, Configuration, DirectionalDipole, Medium, NormalizedDiffusion, Parameterization, Profile,
    StandardDipole, fresnel_from_outside,
};
use translucid_reference::Incidence;
use translucid_reference::exact::HalfSpace;
use translucid_reference::walk::{Control, Layout, Parameters, Problem, Region, Side, WhiteTable};
use translucid_testing::{bound, power};

use crate::solutions::{half_space, oblique};

const UP: [f64; 3] = [0.0, 0.0, 1.0];
const ALPHAS: [f64; 3] = [0.5, 0.9, 0.99];
const DEGREES: [f64; 4] = [0.0, 30.0, 60.0, 80.0];

/// R(r, φ) of a dipole on a plane, for light that arrives at an angle and goes on towards φ = 0.
fn on_plane(dipole: &DirectionalDipole, cos_theta: f64, r: f64, phi: f64) -> f64 {
    let sin_theta = (1.0 - cos_theta * cos_theta).sqrt();
    dipole.eval([r * phi.cos(), r * phi.sin(), 0.0], [-sin_theta, 0.0, cos_theta], UP, UP)
}

fn appearance(surface_albedo: f64) -> Appearance {
    Appearance { surface_albedo, length: 1.0, parameterization: Parameterization::Mfp, g: 0.0 }
}

/// The exact profile at the middles of cells, and its energy where they begin and in all.
struct Exact {
    /// r, φ, R and area of a cell and its mirror image.
    cells: Vec<[f64; 4]>,
    inner: f64,
    total: f64,
}

const R_MIN: f64 = 0.02;
const R_MAX: f64 = 60.0;
const RINGS: u32 = 40;
const SECTORS: u32 = 16;

impl Exact {
    /// The profile of an albedo and angle, made once.
    fn of(alpha: f64, cos_theta: f64) -> Arc<Self> {
        type Made = Mutex<HashMap<[u64; 2], Arc<OnceLock<Arc<Exact>>>>>;
        static MADE: LazyLock<Made> = LazyLock::new(Mutex::default);
        let key = [alpha.to_bits(), cos_theta.to_bits()];
        let cell = Arc::clone(MADE.lock().unwrap().entry(key).or_default());
        Arc::clone(cell.get_or_init(|| Arc::new(Self::new(alpha, cos_theta))))
    }

    fn new(alpha: f64, cos_theta: f64) -> Self {
        let half_space = oblique(alpha, 1.0, cos_theta);
        let step = (R_MAX / R_MIN).ln() / f64::from(RINGS);
        let sectors = if cos_theta == 1.0 { 1 } else { SECTORS };
        let mut cells = Vec::new();
        for ring in 0..RINGS {
            let r = R_MIN * (step * (f64::from(ring) + 0.5)).exp();
            for sector in 0..sectors {
                let phi = PI * (f64::from(sector) + 0.5) / f64::from(sectors);
                let area = 2.0 * PI * r * r * step / f64::from(sectors);
                cells.push([r, phi, half_space.eval(r, phi).value, area]);
            }
        }
        Self { cells, inner: half_space.enclosed(R_MIN).value, total: half_space.total().value }
    }

    /// L1 error of a model, as a part of the energy.
    ///
    /// The inner disc, a few percent of the energy, counts as one cell.
    fn error(&self, model: impl Fn(f64, f64) -> f64) -> f64 {
        let inner = PI * R_MIN * R_MIN * model(0.5 * R_MIN, 0.5 * PI);
        let outer: f64 =
            self.cells.iter().map(|&[r, phi, exact, area]| (model(r, phi) - exact).abs() * area).sum();
        (outer + (inner - self.inner).abs()) / self.total
    }
}

/// Energy of a dipole on a plane at a cosine of incidence.
fn energy(dipole: &DirectionalDipole, cos_theta: f64) -> f64 {
    let (step, sectors) = (0.05, 48);
    let ring = |i: i32| {
        let r = (step * f64::from(i)).exp();
        let mean: f64 = (0..sectors)
            .map(|j| on_plane(dipole, cos_theta, r, PI * (f64::from(j) + 0.5) / f64::from(sectors)))
            .sum::<f64>()
            / f64::from(sectors);
        2.0 * PI * r * r * step * mean
    };
    (-400..160).map(ring).sum()
}

fn cosine(degrees: f64) -> f64 {
    if degrees == 0.0 { 1.0 } else { degrees.to_radians().cos() }
}

/// Errors of the directional dipole, the standard dipole and normalized diffusion, by α (rows) and angle
/// (columns).
///
/// The directional dipole is the best of the three at 60°, and better than the standard dipole at 30° too.
/// At 80° all are far off. Along the normal normalized diffusion is what was fitted to the truth.
const AT_EQUAL_ALBEDO: [[[f64; 3]; 4]; 3] = [
    [[0.261, 0.741, 0.045], [0.330, 0.740, 0.405], [0.619, 0.909, 0.773], [1.103, 1.044, 0.990]],
    [[0.227, 0.479, 0.028], [0.273, 0.528, 0.335], [0.516, 0.747, 0.658], [0.942, 0.919, 0.881]],
    [[0.340, 0.314, 0.064], [0.356, 0.400, 0.289], [0.496, 0.639, 0.575], [0.873, 0.856, 0.818]],
];

/// With the surface albedo of the exact half space under light along the normal, which is how renderers are told.
#[test]
fn errors_at_equal_surface_albedo_are_what_they_are() {
    for (row, alpha) in ALPHAS.into_iter().enumerate() {
        let albedo = HalfSpace::new(alpha, Incidence::NORMAL).expect("valid").total().value;
        let dipole = DirectionalDipole::new(&appearance(albedo), 1.0).expect("reachable");
        let standard = StandardDipole::new(&appearance(albedo), 1.0).expect("reachable");
        let burley =
            NormalizedDiffusion::new(albedo, 1.0, Parameterization::Mfp, Configuration::Searchlight).unwrap();
        for (column, degrees) in DEGREES.into_iter().enumerate() {
            let cos_theta = cosine(degrees);
            let exact = Exact::of(alpha, cos_theta);
            let found = [
                exact.error(|r, phi| on_plane(&dipole, cos_theta, r, phi)),
                exact.error(|r, _| standard.eval(r)),
                exact.error(|r, _| burley.eval(r)),
            ];
            let expected = AT_EQUAL_ALBEDO[row][column];
            for (found, expected) in found.iter().zip(expected) {
                assert!((found - expected).abs() < 0.005, "{alpha} {degrees}°: {found:.3?} {expected:.3?}");
            }
            // What the direction is worth
            let [directional, standard, burley] = found;
            if degrees == 60.0 {
                assert!(directional < standard && directional < burley, "{alpha}: {found:.3?}");
            }
        }
    }
}

/// Errors of the directional dipole, the same as published, and the standard dipole, by α (rows) and at 0° and
/// 60°.
///
/// The factor α', which the published formula lacks, always helps: at α = 0.5 it takes two thirds of the error.
/// With it energy is still too much (0.64 where 0.41 is right), and the standard dipole is closer along the
/// normal.
const FOR_EQUAL_MEDIA: [[[f64; 3]; 2]; 3] = [
    [[0.682, 2.106, 0.591], [0.839, 2.278, 0.851]],
    [[0.628, 0.787, 0.421], [0.611, 0.713, 0.726]],
    [[0.484, 0.497, 0.307], [0.482, 0.489, 0.635]],
];

#[test]
fn errors_for_equal_media_are_what_they_are() {
    for (row, alpha) in ALPHAS.into_iter().enumerate() {
        let medium = Medium::from_mfp(alpha, 1.0, 0.0).expect("valid");
        let dipole = DirectionalDipole::from_medium(&medium, 1.0).expect("valid");
        let published = DirectionalDipole::as_published(&medium, 1.0).expect("valid");
        let standard = StandardDipole::from_medium(&medium, 1.0).expect("valid");
        for (column, degrees) in [0.0, 60.0].into_iter().enumerate() {
            let cos_theta = cosine(degrees);
            let exact = Exact::of(alpha, cos_theta);
            let found = [
                exact.error(|r, phi| on_plane(&dipole, cos_theta, r, phi)),
                exact.error(|r, phi| on_plane(&published, cos_theta, r, phi)),
                exact.error(|r, _| standard.eval(r)),
            ];
            let expected = FOR_EQUAL_MEDIA[row][column];
            for (found, expected) in found.iter().zip(expected) {
                assert!((found - expected).abs() < 0.005, "{alpha} {degrees}°: {found:.3?} {expected:.3?}");
            }
            assert!(found[0] < found[1], "{alpha} {degrees}°: {found:.3?}");
        }
    }
}

/// Under a boundary, against the walk.
#[test]
fn errors_under_a_boundary_are_what_they_are() {
    const ETA: f64 = 1.4;
    const SECTORS: usize = 8;
    let radii = [0.05, 0.1, 0.2, 0.35, 0.6, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 9.0, 14.0];
    let alpha = 0.9;
    let cos_theta = 60f64.to_radians().cos();
    let parameters =
        Parameters { eta: ETA, incidence: Incidence::Pencil { cos_theta }, ..Parameters::default() };
    let layout = Layout::new(&radii, SECTORS as u32).expect("valid");
    let mut walk = WhiteTable::new(Problem::new(parameters).expect("valid"), layout, alpha).expect("valid");
    walk.run(1, power(4_000_000), &Control::default()).expect("runs");
    let at = walk.at_albedo(alpha).expect("the albedo of the walk");

    let albedo = half_space(alpha, ETA, Incidence::NORMAL).total().value;
    let dipole = DirectionalDipole::new(&appearance(albedo), ETA).expect("reachable");
    let standard = StandardDipole::new(&appearance(albedo), ETA).expect("reachable");
    let rule = gauss_legendre(6);
    let models: [&dyn Fn(f64, f64) -> f64; 2] =
        [&|r, phi| on_plane(&dipole, cos_theta, r, phi), &|r, _| standard.eval(r)];
    let (mut errors, mut noise) = ([0.0; 2], 0.0);
    let mut from = 0.0;
    for (ring, &to) in radii.iter().enumerate() {
        for sector in 0..SECTORS {
            let found = at.energy(Side::Reflected, Region::Sector { ring, sector });
            noise += found.error;
            let bounds = [sector, sector + 1].map(|s| PI * s as f64 / SECTORS as f64);
            for (error, model) in errors.iter_mut().zip(models) {
                let expected = integrate(&rule, from, to, |r| {
                    2.0 * r * integrate(&rule, bounds[0], bounds[1], |phi| model(r, phi))
                });
                *error += (found.value - expected).abs();
            }
        }
        from = to;
    }
    // 47.0 % and 56.6 %, of which noise feigns 0.9 % at most
    let total = at.total(Side::Reflected);
    let [directional, standard] = errors.map(|error| error / total.value);
    assert!(noise < bound(0.01) * total.value, "{noise}");
    assert!((directional - 0.470).abs() < bound(0.01), "{directional}");
    assert!((standard - 0.566).abs() < bound(0.01), "{standard}");
    // The walk returns 0.2769 ± 0.0002 of the light that entered at 60°, and 0.2578 of a beam along the normal
    let found = energy(&dipole, cos_theta);
    assert!(
        (found - 0.2861).abs() < 1e-4 && (found - total.value) > 20.0 / bound(1.0) * total.error,
        "{found} {total:?}"
    );
}

/// Energies of light from everywhere, as a furnace has it, by η and α: of the exact half space, and of the dipole
/// that has its surface albedo along the normal.
const OF_DIFFUSE_LIGHT: [[[f64; 2]; 3]; 2] = [
    [[0.1465, 0.1613], [0.4780, 0.4927], [0.7946, 0.8089]],
    [[0.0576, 0.0613], [0.2696, 0.2754], [0.6326, 0.6348]],
];

#[test]
fn energies_of_diffuse_light_are_what_they_are() {
    let rule = gauss_legendre(12);
    for (eta, row) in [1.0, 1.4].into_iter().zip(OF_DIFFUSE_LIGHT) {
        for (alpha, [exact, expected]) in ALPHAS.into_iter().zip(row) {
            let total = |incidence| half_space(alpha, eta, incidence).total().value;
            assert!(
                (total(Incidence::Cosine) - exact).abs() < 1e-4,
                "{eta} {alpha}: {}",
                total(Incidence::Cosine)
            );
            let dipole =
                DirectionalDipole::new(&appearance(total(Incidence::NORMAL)), eta).expect("reachable");
            let along_normal = energy(&dipole, 1.0);
            assert!((along_normal - total(Incidence::NORMAL)).abs() < 1e-5, "{eta} {alpha}: {along_normal}");
            let enters = |mu: f64| 2.0 * mu * (1.0 - fresnel_from_outside(mu, eta));
            let entered = integrate(&rule, 0.0, 1.0, enters);
            let found = integrate(&rule, 0.0, 1.0, |mu| enters(mu) * energy(&dipole, mu)) / entered;
            assert!((found - expected).abs() < 3e-4, "{eta} {alpha}: {found}");
        }
    }
}

/// Without refraction the energy of grazing light grows like −ln cos θ, where the truth is at most 1.
#[test]
fn energy_of_grazing_light_grows_without_end() {
    let dipole = DirectionalDipole::new(&appearance(0.5), 1.0).expect("reachable");
    let energies = [1e-1, 1e-2, 1e-3, 1e-4].map(|cos_theta| energy(&dipole, cos_theta));
    for decade in energies.windows(2) {
        let growth = decade[1] - decade[0];
        assert!((growth - 0.228).abs() < 0.003, "{energies:?}");
    }
    assert!((energies[0] - 0.792).abs() < 1e-3, "{energies:?}");
}
