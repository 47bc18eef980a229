//! The exact half space as `translucid-profile` carries it, against the solution that it was made from.

use std::f64::consts::FRAC_PI_2;

use translucid_profile::{Configuration, ExactProfile, Parameterization, Profile};
use translucid_reference::{Incidence, exact::HalfSpace};

const CONFIGURATIONS: [Configuration; 2] = [Configuration::Searchlight, Configuration::Diffuse];
/// Rows of the tables, which are equidistant in the angle θ with 1 − A = cos⁴θ.
const ROWS: u32 = 49;

struct Pair {
    name: String,
    table: ExactProfile,
    solution: HalfSpace,
}

fn pair(surface_albedo: f64, configuration: Configuration) -> Pair {
    let table = ExactProfile::new(surface_albedo, 1.0, Parameterization::Mfp, configuration);
    let solution = HalfSpace::from_surface_albedo(surface_albedo, Incidence::from(configuration));
    let name = format!("A {surface_albedo}, {configuration:?}");
    Pair { name, table: table.expect("valid parameters"), solution: solution.expect("valid parameters") }
}

impl Pair {
    /// Error of the energy within r, in parts of all energy.
    fn energy_error(&self, r: f64) -> f64 {
        (self.table.enclosed(r) - self.solution.enclosed(r).value).abs() / self.table.surface_albedo()
    }

    /// Relative error of R(r).
    fn profile_error(&self, r: f64) -> f64 {
        (self.table.eval(r) / self.solution.eval(r).value - 1.0).abs()
    }

    /// The least R error that is promised for the albedo.
    fn promised_profile_error(&self) -> f64 {
        if self.table.surface_albedo() < 0.02 { 1e-3 } else { 5e-5 }
    }
}

/// Radii 10^(i/8) in mean free paths.
fn radii(range: std::ops::RangeInclusive<i32>) -> impl Iterator<Item = f64> {
    range.map(|i| 10f64.powf(0.125 * f64::from(i)))
}

/// Surface albedos between rows: those of random angles, some close to 0 and 1, and the ends.
fn albedos() -> Vec<f64> {
    let mut state = 2_463_534_242u32;
    let mut uniform = || {
        // Xorshift, G. Marsaglia 2003
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        f64::from(state) / 4_294_967_296.0
    };
    let random = (0..30).map(|_| 1.0 - (FRAC_PI_2 * uniform()).cos().powi(4));
    random.chain([1e-9, 1e-4, 1e-3, 0.999, 0.99999, 1.0 - 1e-8, 1.0]).collect()
}

#[test]
fn table_is_the_solution_between_its_rows() {
    for (a, configuration) in albedos().into_iter().flat_map(|a| CONFIGURATIONS.map(|c| (a, c))) {
        let pair = pair(a, configuration);
        for r in radii(-40..=48) {
            let off = pair.energy_error(r);
            // Behind the last cell is an exponential
            let allowed = if r < 16_384.0 { 1e-6 } else { 1e-4 };
            assert!(off < allowed, "{}, r {r}: {off:e}", pair.name);
        }
        for r in radii(-40..=10) {
            let off = pair.profile_error(r);
            assert!(off < pair.promised_profile_error(), "{}, r {r}: {off:e}", pair.name);
            // Close to the point of entry the energy has its digits too
            let relative = (pair.table.enclosed(r) / pair.solution.enclosed(r).value - 1.0).abs();
            assert!(relative < 2e-5, "{}, r {r}: {relative:e}", pair.name);
        }
    }
}

/// Errors that single precision leaves where nothing is interpolated: at rows, at the ends of cells.
#[test]
fn rows_are_what_the_solution_gives_today() {
    for (row, configuration) in
        [1, 13, 30, 44, 48].into_iter().flat_map(|row| CONFIGURATIONS.map(|c| (row, c)))
    {
        let cosine = (FRAC_PI_2 * f64::from(row) / f64::from(ROWS - 1)).cos();
        let pair = pair(1.0 - cosine.powi(4), configuration);
        for r in (-12..=4).map(|exponent| f64::from(exponent).exp2()) {
            let energy = (pair.table.enclosed(r) / pair.solution.enclosed(r).value - 1.0).abs();
            assert!(energy < 2e-6, "{}, row {row}, r {r}: {energy:e}", pair.name);
            let profile = pair.profile_error(r);
            assert!(profile < 2e-6, "{}, row {row}, r {r}: {profile:e}", pair.name);
        }
    }
}

/// With a diffuse mean free path the medium is that of the solution: compared through its coefficients.
#[test]
fn dmfp_scales_the_solution() {
    for configuration in CONFIGURATIONS {
        let table =
            ExactProfile::new(0.6, 2.0, Parameterization::Dmfp, configuration).expect("valid parameters");
        let solution =
            HalfSpace::from_surface_albedo(0.6, Incidence::from(configuration)).expect("valid parameters");
        let absorbed = 1.0 - solution.single_scattering_albedo();
        // 1/ℓ_d² = σ_a/D with D = (2σ_a + σ_s)/3σ_t²
        let mfp = 2.0 * (3.0 * absorbed / (1.0 + absorbed)).sqrt();
        for r in [0.05, 0.7, 4.0] {
            let off = table.enclosed(r * mfp) - solution.enclosed(r).value;
            assert!(off.abs() < 1e-6, "{configuration:?} {r}: {off:e}");
        }
    }
}
