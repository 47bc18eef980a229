//! The entries called as C calls them, against the library behind them.

use std::ffi::{CStr, CString, c_int, c_void};
use std::ptr::{null, null_mut};

use translucid_profile::convention::{ArgumentNames, Conversion, Setting, Unit};
use translucid_profile::{
    Appearance, Configuration, Model, NormalizedDiffusion, Parameterization, Profile, TabulatedProfile,
};
use translucid_reference::Incidence;
use translucid_reference::exact::HalfSpace;

use crate::conversion::*;
use crate::exact::*;
use crate::preset::*;
use crate::profile::*;
use crate::status::*;
use crate::table::*;
use crate::walk::*;

/// A call that works, of an entry whose arguments are good.
macro_rules! ok {
    ($call:expr) => {
        // SAFETY: all pointers are those of values of this test.
        assert_eq!(unsafe { $call }, TranslucidStatus::Ok, "{}", last_error())
    };
}

/// A call that is refused with a message.
macro_rules! refused {
    ($call:expr, $message:expr) => {{
        // SAFETY: all pointers are those of values of this test, or NULL.
        assert_ne!(unsafe { $call }, TranslucidStatus::Ok);
        assert!(last_error().contains($message), "{}", last_error());
    }};
}

fn last_error() -> String {
    text(translucid_last_error())
}

fn text(text: *const std::ffi::c_char) -> String {
    // SAFETY: a text of the library.
    unsafe { CStr::from_ptr(text) }.to_str().unwrap().to_owned()
}

const JADE: TranslucidAppearance = TranslucidAppearance {
    surface_albedo: 0.6,
    mfp: 1.5,
    dmfp: 0.0,
    g: 0.0,
    eta: 0.0,
    configuration: null(),
};

fn profile(model: &str, appearance: &TranslucidAppearance) -> *mut TranslucidProfile {
    let (model, mut made) = (CString::new(model).unwrap(), null_mut());
    ok!(translucid_profile_new(model.as_ptr(), appearance, &mut made));
    made
}

type Entry = unsafe extern "C" fn(*const TranslucidProfile, *const f64, usize, *mut f64) -> TranslucidStatus;
type Method = fn(&NormalizedDiffusion, f64) -> f64;

#[test]
fn profiles_are_those_of_the_library() {
    let expected = NormalizedDiffusion::new(0.6, 1.5, Parameterization::Mfp, Configuration::Diffuse).unwrap();
    let made = profile("normalized-diffusion", &JADE);
    let r = [0.0, 0.1, 1.0, 30.0];
    let mut out = [0.0; 4];
    let pairs: [(Entry, Method); 6] = [
        (translucid_profile_eval, |p, r| p.eval(r)),
        (translucid_profile_pdf, |p, r| p.pdf(r)),
        (translucid_profile_pdf_area, |p, r| p.pdf_area(r)),
        (translucid_profile_cdf, |p, r| p.cdf(r)),
        (translucid_profile_enclosed, |p, r| p.enclosed(r)),
        (translucid_profile_beyond, |p, r| p.beyond(r)),
    ];
    for (entry, method) in pairs {
        ok!(entry(made, r.as_ptr(), 4, out.as_mut_ptr()));
        assert_eq!(out, r.map(|r| method(&expected, r)));
    }
    let u = [0.0, 0.25, 0.75, 1.0];
    ok!(translucid_profile_quantile(made, u.as_ptr(), 4, out.as_mut_ptr()));
    assert_eq!(out, u.map(|u| expected.quantile(u)));
    ok!(translucid_profile_sample(made, u.as_ptr(), 4, out.as_mut_ptr()));
    assert_eq!(out, u.map(|u| expected.sample(u)));
    let mut total = 0.0;
    ok!(translucid_profile_total(made, &mut total));
    assert_eq!(total, 0.6);
    refused!(translucid_profile_sample(made, [0.5, f64::NAN].as_ptr(), 2, out.as_mut_ptr()), "u[1] is NaN");
    refused!(translucid_profile_eval(made, [-1.0].as_ptr(), 1, out.as_mut_ptr()), "r[0] is -1");
    refused!(translucid_profile_eval(null(), r.as_ptr(), 4, out.as_mut_ptr()), "profile is NULL");
    assert_eq!(out, u.map(|u| expected.sample(u)), "a failure has written");
    ok!(translucid_profile_free(made));
}

#[test]
fn defaults_are_those_of_the_python_module() {
    let mut totals = [0.0; 2];
    for (i, appearance) in
        [JADE, TranslucidAppearance { mfp: 0.0, dmfp: 1.5, ..JADE }].into_iter().enumerate()
    {
        let mut made = null_mut();
        ok!(translucid_profile_new(null(), &appearance, &mut made));
        ok!(translucid_profile_eval(made, &1.0, 1, &mut totals[i]));
        ok!(translucid_profile_free(made));
    }
    let expected = [
        (Parameterization::Mfp, Configuration::Diffuse),
        (Parameterization::Dmfp, Configuration::Searchlight),
    ];
    let expected = expected.map(|(parameterization, configuration)| {
        let jade = Appearance { surface_albedo: 0.6, length: 1.5, parameterization, g: 0.0 };
        Model::default().profile(&jade, configuration, 1.0).unwrap().eval(1.0)
    });
    assert_eq!(totals, expected);
}

#[test]
fn appearances_are_refused_in_words() {
    let mut made = null_mut();
    let nix = CString::new("nix").unwrap();
    refused!(translucid_profile_new(nix.as_ptr(), &JADE, &mut made), "model is \"nix\"");
    refused!(translucid_profile_new(null(), null(), &mut made), "appearance is NULL");
    refused!(translucid_profile_new(null(), &JADE, null_mut()), "profile is NULL");
    let both = TranslucidAppearance { dmfp: 1.0, ..JADE };
    refused!(translucid_profile_new(null(), &both, &mut made), "mfp is 1.5 and dmfp is 1");
    let odd = TranslucidAppearance { configuration: nix.as_ptr(), ..JADE };
    refused!(translucid_profile_new(null(), &odd, &mut made), "must be one of searchlight, diffuse");
    for (appearance, message) in [
        (
            TranslucidAppearance { surface_albedo: 1.2, ..JADE },
            "surface_albedo is 1.2, but must be in [0, 1]",
        ),
        (TranslucidAppearance { mfp: f64::NAN, ..JADE }, "mfp is NaN"),
        (TranslucidAppearance { mfp: 1e-200, ..JADE }, "mfp is 1e-200"),
        (TranslucidAppearance { mfp: 0.0, dmfp: -1.0, ..JADE }, "dmfp is -1"),
        (TranslucidAppearance { eta: f64::INFINITY, ..JADE }, "eta is inf"),
    ] {
        refused!(translucid_profile_new(null(), &appearance, &mut made), message);
    }
    assert!(made.is_null());
}

#[test]
#[cfg_attr(miri, ignore = "takes minutes")]
fn media_samples_and_tables_become_profiles() {
    let medium = TranslucidMedium { sigma_a: 0.0021, sigma_s: 2.19, g: 0.0, eta: 0.0, configuration: null() };
    let (mut made, mut tabulated, mut total) = (null_mut(), null_mut(), 0.0);
    ok!(translucid_profile_from_medium(null(), &medium, &mut made));
    ok!(translucid_profile_total(made, &mut total));
    assert!((total - 0.931).abs() < 5e-4, "{total}"); // As Python's example says
    ok!(translucid_profile_free(made));

    let radii: Vec<f64> = (0..40).map(|i| 0.01 * 1.25_f64.powi(i)).collect();
    let truth = NormalizedDiffusion::new(0.8, 1.0, Parameterization::Mfp, Configuration::Diffuse).unwrap();
    let reflectances: Vec<f64> = radii.iter().map(|&r| truth.eval(r)).collect();
    let enclosed: Vec<f64> = radii.iter().map(|&r| truth.enclosed(r)).collect();
    for enclosed in [null(), enclosed.as_ptr()] {
        ok!(translucid_profile_from_samples(radii.as_ptr(), reflectances.as_ptr(), enclosed, 40, &mut made));
        ok!(translucid_profile_total(made, &mut total));
        assert!((total - 0.8).abs() < 2e-3, "{total}");
        ok!(translucid_profile_tabulated(made, &mut tabulated));
        ok!(translucid_profile_free(made));
        ok!(translucid_profile_free(tabulated));
    }
    refused!(
        translucid_profile_from_samples(radii.as_ptr(), reflectances.as_ptr(), null(), 3, &mut made),
        "but must be"
    );

    let (albedos, mut table) = ([0.2, 0.8], null_mut());
    let rows = [reflectances.clone(), reflectances].concat();
    ok!(translucid_table_from_samples(
        albedos.as_ptr(),
        2,
        radii.as_ptr(),
        40,
        rows.as_ptr(),
        null(),
        &mut table
    ));
    ok!(translucid_table_profile(table, 0.5, 2.0, &mut made));
    let (mut one, mut other, u) = (0.0, 0.0, 0.3);
    ok!(translucid_profile_sample(made, &u, 1, &mut one));
    ok!(translucid_table_sample(table, &0.5, &2.0, &u, 1, &mut other));
    assert_eq!(one, other);
    ok!(translucid_profile_eval(made, &u, 1, &mut one));
    ok!(translucid_table_eval(table, &0.5, &2.0, &u, 1, &mut other));
    assert_eq!(one, other);
    ok!(translucid_profile_pdf(made, &u, 1, &mut one));
    ok!(translucid_table_pdf(table, &0.5, &2.0, &u, 1, &mut other));
    assert_eq!(one, other);
    refused!(translucid_table_profile(table, 1.5, 1.0, &mut made), "surface_albedo is 1.5");
    refused!(translucid_table_sample(table, &0.5, &0.0, &u, 1, &mut other), "lengths[0] is 0");
    refused!(
        translucid_table_from_samples(
            albedos.as_ptr(),
            2,
            radii.as_ptr(),
            usize::MAX / 2 + 1,
            rows.as_ptr(),
            null(),
            &mut table
        ),
        "radii has"
    );
    // The profile keeps what it needs of the table
    ok!(translucid_table_free(table));
    ok!(translucid_profile_eval(made, &u, 1, &mut one));
    ok!(translucid_profile_free(made));
}

#[test]
#[cfg_attr(miri, ignore = "takes minutes")]
fn tables_of_models_are_near_their_models() {
    let (mut table, mut found) = (null_mut(), 0.0);
    let model = CString::new("dipole").unwrap();
    ok!(translucid_table_new(model.as_ptr(), &JADE, &mut table));
    let jade =
        Appearance { surface_albedo: 0.6, length: 1.5, parameterization: Parameterization::Mfp, g: 0.0 };
    let expected = Model::Dipole.profile(&jade, Configuration::Diffuse, 1.0).unwrap();
    let r = TabulatedProfile::new(&*expected).quantile(0.4);
    ok!(translucid_table_pdf(table, &0.6, &1.5, &r, 1, &mut found));
    assert!((found / expected.pdf(r) - 1.0).abs() < 1e-3, "{found}");
    ok!(translucid_table_free(table));
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("samples.csv");
    std::fs::write(&path, "r,reflectance\n0.1,0.6\n0.3,0.14\n1,0.025\n3,0.0022\n10,0.00002\n").unwrap();
    let path = CString::new(path.to_str().unwrap()).unwrap();
    ok!(translucid_table_load(path.as_ptr(), &mut table));
    ok!(translucid_table_free(table));
    let missing = CString::new("/no/such/file").unwrap();
    // SAFETY: as of every call here.
    let status = unsafe { translucid_table_load(missing.as_ptr(), &mut table) };
    assert_eq!(status, TranslucidStatus::FileError);
}

#[test]
#[cfg_attr(miri, ignore = "threads of rayon")]
fn exact_figures_are_those_of_the_library() {
    let half_space = TranslucidHalfSpace {
        surface_albedo: 0.0,
        single_scattering_albedo: 0.9,
        mfp: 2.0,
        eta: 0.0,
        configuration: c"searchlight".as_ptr(),
        incidence_angle: 0.0,
        threads: 1,
    };
    let (mut exact, mut value, mut error) = (null_mut(), 0.0, 0.0);
    ok!(translucid_exact_new(&half_space, &mut exact));
    let expected = HalfSpace::new(0.9, Incidence::NORMAL).unwrap();
    ok!(translucid_exact_eval(exact, &3.0, null(), 1, &mut value, &mut error));
    assert_eq!([value, error], [expected.eval(1.5).value / 4.0, expected.eval(1.5).error / 4.0]);
    ok!(translucid_exact_enclosed(exact, &3.0, 1, &mut value, null_mut()));
    assert_eq!(value, expected.enclosed(1.5).value);
    ok!(translucid_exact_beyond(exact, &3.0, 1, &mut value, null_mut()));
    assert_eq!(value, expected.beyond(1.5).value);
    ok!(translucid_exact_total(exact, &mut value, &mut error));
    assert_eq!(value, expected.total().value);
    refused!(translucid_exact_eval(exact, &3.0, &0.0, 1, &mut value, &mut error), "incidence_angle");
    ok!(translucid_exact_free(exact));

    let tilted = TranslucidHalfSpace { incidence_angle: 60.0, ..half_space };
    ok!(translucid_exact_new(&tilted, &mut exact));
    let (mut ahead, mut behind) = (0.0, 0.0);
    ok!(translucid_exact_eval(exact, &2.0, &0.0, 1, &mut ahead, null_mut()));
    ok!(translucid_exact_eval(exact, &2.0, &180.0, 1, &mut behind, null_mut()));
    assert!(ahead > 2.0 * behind, "{ahead} {behind}");
    ok!(translucid_exact_free(exact));
    for (wrong, message) in [
        (TranslucidHalfSpace { surface_albedo: 0.5, ..half_space }, "one of them"),
        (TranslucidHalfSpace { eta: 9.0, ..half_space }, "eta is 9, but must be in [0.5, 3]"),
        (TranslucidHalfSpace { incidence_angle: 90.0, ..half_space }, "incidence_angle is 90"),
        (TranslucidHalfSpace { threads: 2000, ..half_space }, "threads is 2000"),
    ] {
        refused!(translucid_exact_new(&wrong, &mut exact), message);
    }
}

unsafe extern "C" fn stop_at_once(_: u64, _: u64, _: *mut c_void) -> c_int {
    1
}

#[test]
#[cfg_attr(miri, ignore = "threads of rayon")]
fn walks_add_up_stop_and_are_saved() {
    let edges = [0.1, 0.3, 1.0, 3.0];
    let walk = TranslucidWalk {
        g: 0.0,
        phase_function: null(),
        eta: 0.0,
        thickness: 0.0,
        spot_radius: 0.0,
        configuration: c"searchlight".as_ptr(),
        incidence_angle: 0.0,
        reference_albedo: 0.9,
        radii: null(),
        radius_count: 0,
        edges: edges.as_ptr(),
        edge_count: 4,
        sectors: 0,
    };
    let [mut whole, mut part, mut other] = [null_mut(); 3];
    for table in [&mut whole, &mut part, &mut other] {
        ok!(translucid_white_table_new(&walk, table));
    }
    // Parts add up to the whole, exactly
    ok!(translucid_white_table_run(whole, 7, 20_000, 2, None, null_mut()));
    ok!(translucid_white_table_run_range(part, 7, 0, 8_000, 1, None, null_mut()));
    ok!(translucid_white_table_run_range(other, 7, 8_000, 20_000, 1, None, null_mut()));
    ok!(translucid_white_table_merge(part, other));
    refused!(translucid_white_table_merge(part, other), "would count twice");
    let figures = |table| {
        let (mut value, mut error) = ([0.0; 4], [0.0; 4]);
        ok!(translucid_white_table_rings(table, 0.8, null(), 4, value.as_mut_ptr(), error.as_mut_ptr()));
        (value, error)
    };
    assert_eq!(figures(part), figures(whole));

    // Near the exact solution: four standard errors are passed once in 16,000
    let (mut value, mut error) = (0.0, 0.0);
    ok!(translucid_white_table_total(whole, 0.8, null(), &mut value, &mut error));
    let exact = HalfSpace::new(0.8, Incidence::NORMAL).unwrap().total().value;
    assert!((value - exact).abs() < 4.0 * error, "{value} {error} {exact}");
    ok!(translucid_white_table_enclosed(whole, 0.8, null(), &1.0, 1, &mut value, &mut error));
    let exact = HalfSpace::new(0.8, Incidence::NORMAL).unwrap().enclosed(1.0).value;
    assert!((value - exact).abs() < 4.0 * error, "{value} {error} {exact}");
    let mut profile = null_mut();
    ok!(translucid_white_table_profile(whole, 0.8, null(), &mut profile));
    ok!(translucid_profile_free(profile));
    ok!(translucid_white_table_single_scattering_albedo(whole, 0.3, &mut value, &mut error));

    // Stopped: what was done is kept
    // SAFETY: as of every call here.
    let stopped = unsafe { translucid_white_table_run(other, 8, 1 << 60, 2, Some(stop_at_once), null_mut()) };
    assert_eq!(stopped, TranslucidStatus::Stopped);
    let mut photons = 0;
    ok!(translucid_white_table_photons(other, &mut photons));
    assert!(photons > 12_000 && photons < 1 << 60, "{photons}");

    // Saved and loaded
    let directory = tempfile::tempdir().unwrap();
    let path = CString::new(directory.path().join("table.npz").to_str().unwrap()).unwrap();
    let mut loaded = null_mut();
    ok!(translucid_white_table_save(whole, path.as_ptr()));
    ok!(translucid_white_table_load(path.as_ptr(), &mut loaded));
    assert_eq!(figures(loaded), figures(whole));
    let (mut radii, mut total) = ([0.0; 9], 0);
    ok!(translucid_white_table_edges(loaded, radii.as_mut_ptr(), 9, &mut total));
    assert_eq!((&radii[..4], total), (&edges[..], 4));

    refused!(
        translucid_white_table_total(whole, 0.95, null(), &mut value, &mut error),
        "single_scattering_albedo"
    );
    let far = c"transmitted".as_ptr();
    refused!(translucid_white_table_total(whole, 0.5, far, &mut value, &mut error), "no far side");
    refused!(translucid_white_table_rings(whole, 0.5, null(), 5, &mut value, null_mut()), "at most 4");
    refused!(translucid_white_table_enclosed(whole, 0.5, null(), &2.0, 1, &mut value, null_mut()), "index 0");
    let both = TranslucidWalk { radii: edges.as_ptr(), radius_count: 4, ..walk };
    refused!(translucid_white_table_new(&both, &mut loaded.cast()), "both radii and edges");
    for table in [whole, part, other, loaded] {
        ok!(translucid_white_table_free(table));
    }
}

#[test]
fn conversions_are_those_of_the_library() {
    let from = TranslucidSetting {
        system: c"arnold".as_ptr(),
        parameter: c"subsurface_radius".as_ptr(),
        values: [1.0, 0.0, 0.0],
        count: 1,
    };
    let to = [c"hdrp".as_ptr()];
    let conversion = TranslucidConversion {
        from: &raw const from,
        from_count: 1,
        surface_albedo: [0.5, 0.0, 0.0],
        surface_albedo_count: 1,
        unit: null(),
        to_unit: null(),
        to: to.as_ptr(),
        to_count: 1,
        set: null(),
        set_count: 0,
        configuration: null(),
    };
    let (mut converted, mut count, mut notes) = (null_mut(), 0, 0);
    ok!(translucid_convert(&conversion, &mut converted));
    ok!(translucid_converted_count(converted, &mut count, &mut notes));
    let expected = Conversion {
        from: &[Setting::new("from", "arnold", "subsurface_radius", vec![1.0]).unwrap()],
        surface_albedo: &[0.5],
        unit: Unit::Millimeter,
        to_unit: Unit::Millimeter,
        to: &["hdrp"],
        set: &[],
        configuration: Configuration::Diffuse,
        color_space: None,
        names: ArgumentNames::FIELDS,
    };
    let expected = expected.run().unwrap();
    assert_eq!((count, notes), (expected.numbers.len(), expected.notes.len()));
    for (i, row) in expected.numbers.iter().enumerate() {
        let mut found = std::mem::MaybeUninit::uninit();
        ok!(translucid_converted_number(converted, i, found.as_mut_ptr()));
        // SAFETY: the call has worked.
        let found: TranslucidConvertedNumber = unsafe { found.assume_init() };
        let texts = [found.system, found.parameter, found.channel, found.unit, found.equal].map(text);
        assert_eq!(texts, [row.system, row.parameter, row.channel, &row.unit, row.equal]);
        assert_eq!(found.value, row.value);
        assert_eq!(text(found.source), row.source);
    }
    let mut note = null();
    refused!(translucid_converted_note(converted, notes, &mut note), "must be below");
    ok!(translucid_converted_free(converted));

    let many = TranslucidConversion { surface_albedo_count: 4, ..conversion };
    refused!(translucid_convert(&many, &mut converted), "surface_albedo has 4 numbers");
    let nothing = TranslucidConversion { from_count: 0, ..conversion };
    refused!(translucid_convert(&nothing, &mut converted), "from is missing");
}

#[test]
fn names_end_with_null() {
    let all: [extern "C" fn(usize) -> *const std::ffi::c_char; 3] =
        [translucid_model_name, translucid_preset_name, translucid_system_name];
    for name_of in all {
        let count = (0..).take_while(|&index| !name_of(index).is_null()).count();
        assert!(count >= 10, "{count}");
        assert!(name_of(usize::MAX).is_null());
        assert!(!text(name_of(count - 1)).is_empty());
    }
    let mut found = std::mem::MaybeUninit::<TranslucidPreset>::uninit();
    ok!(translucid_preset(c"skin1".as_ptr(), found.as_mut_ptr()));
    // SAFETY: the call has worked.
    let found = unsafe { found.assume_init() };
    assert_eq!(found.eta, 1.3);
    assert!((found.mfp[0] - 1.2953).abs() < 5e-5, "{}", found.mfp[0]); // As Python's example says
    refused!(translucid_preset(c"nix".as_ptr(), null_mut()), "preset is NULL");
}
