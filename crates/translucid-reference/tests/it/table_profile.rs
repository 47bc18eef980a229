//! A walk's table as a profile that renderers evaluate and sample.

use translucid_reference::Incidence;
use translucid_reference::exact::HalfSpace;
use translucid_reference::walk::{Control, Layout, Parameters, Problem, Side, WhiteTable};

/// Energies within any radius are the exact ones within four standard errors of a million photons, and 1e-3 for what is
/// between the rings: 40 figures, false-alarm rate below 0.3 % (seed fixed).
#[test]
fn profile_of_a_table_is_the_exact_one() {
    let radii: Vec<f64> = (0..60).map(|i| 0.01 * 1.15_f64.powi(i)).collect();
    let layout = Layout::new(&radii, 1).unwrap();
    let mut table = WhiteTable::new(Problem::new(Parameters::default()).unwrap(), layout, 0.999).unwrap();
    let photons = 1_000_000;
    table.run(7, photons, &Control::default()).unwrap();
    for alpha in [0.5, 0.95] {
        let exact = HalfSpace::new(alpha, Incidence::NORMAL).unwrap();
        let seen = table.at_albedo(alpha).unwrap();
        let profile = seen.profile(Side::Reflected).unwrap();
        assert!((profile.surface_albedo() - seen.total(Side::Reflected).value).abs() < 1e-12);
        for i in 0..20 {
            let r = 0.02 * 1.45_f64.powi(i);
            let (found, expected) = (profile.enclosed(r), exact.enclosed(r).value);
            let error = (expected * (1.0 - expected) / photons as f64).sqrt();
            assert!(
                (found - expected).abs() < 4.0 * error + 1e-3 * expected,
                "{alpha} {r}: {found} {expected}"
            );
        }
    }
}

#[test]
fn profile_needs_rings_with_photons() {
    let layout = Layout::new(&[100.0, 200.0, 300.0, 400.0, 500.0], 1).unwrap();
    let mut table = WhiteTable::new(Problem::new(Parameters::default()).unwrap(), layout, 0.9).unwrap();
    table.run(1, 1000, &Control::default()).unwrap();
    assert!(table.at_albedo(0.5).unwrap().profile(Side::Reflected).is_err());
}
