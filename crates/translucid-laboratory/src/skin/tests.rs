//! Skin against published reflectances, exact profiles, and itself.

#![allow(clippy::print_stdout, reason = "how near it comes is for those who ask with --nocapture")]

use translucid_profile::convention::preset;
use translucid_reference::exact::HalfSpace;
use translucid_reference::walk::Control;

use super::*;
use crate::colorimetry::{Colorimeter, Illuminant, Observer, Spectrum, delta_e_2000};

/// A mean reflectance: its name, melanin and blood, values, and the greatest rms of differences and CIEDE2000.
struct Mean(&'static str, [f64; 2], [f64; 16], [f64; 2]);

/// Mean reflectances from 400 to 700 nm by 20 nm, what the surface reflects included, and the melanin and blood that fit them.
///
/// International Skin Spectra Archive (Y. Lu et al. 2025, *The International Skin Spectra Archive (ISSA): a multicultural human
/// skin phenotype and colour spectra collection*, Scientific Data 12), means over all records of a class of typology angle at a
/// place of the body; numbers of records are in the names. NIST: C. C. Cooksey, D. W. Allen and B. K. Tsai 2017, *Reference data
/// set of human skin reflectance*, J. Res. NIST 122, mean over 100 subjects' forearms.
///
/// CIEDE2000 is that under D65 for the observer of 1931.
#[rustfmt::skip]
const MEANS: [Mean; 10] = [
    Mean("ISSA, inner arm, very light (79)", [TONES[0].melanin, TONES[0].blood],
        [0.234, 0.225, 0.264, 0.342, 0.367, 0.383, 0.385, 0.363, 0.366, 0.378, 0.467, 0.509, 0.520, 0.525, 0.529, 0.532], [0.024, 3.3]),
    Mean("ISSA, inner arm, light (409)", [TONES[1].melanin, TONES[1].blood],
        [0.168, 0.177, 0.212, 0.274, 0.300, 0.321, 0.331, 0.320, 0.329, 0.344, 0.425, 0.466, 0.482, 0.492, 0.500, 0.505], [0.009, 2.0]),
    Mean("ISSA, inner arm, intermediate (578)", [TONES[2].melanin, TONES[2].blood],
        [0.123, 0.135, 0.167, 0.218, 0.244, 0.265, 0.277, 0.272, 0.283, 0.301, 0.377, 0.418, 0.439, 0.452, 0.465, 0.474], [0.007, 1.4]),
    Mean("ISSA, inner arm, tan (459)", [TONES[3].melanin, TONES[3].blood],
        [0.089, 0.099, 0.127, 0.166, 0.190, 0.209, 0.222, 0.223, 0.237, 0.256, 0.323, 0.363, 0.387, 0.405, 0.421, 0.433], [0.006, 0.9]),
    Mean("ISSA, inner arm, brown (159)", [TONES[4].melanin, TONES[4].blood],
        [0.064, 0.072, 0.088, 0.112, 0.129, 0.144, 0.155, 0.158, 0.170, 0.187, 0.239, 0.276, 0.300, 0.321, 0.342, 0.359], [0.006, 1.5]),
    Mean("ISSA, cheek, dark (171)", [TONES[5].melanin, TONES[5].blood],
        [0.051, 0.052, 0.055, 0.059, 0.063, 0.068, 0.073, 0.078, 0.085, 0.093, 0.115, 0.135, 0.154, 0.175, 0.198, 0.221], [0.010, 4.0]),
    Mean("ISSA, inner arm, dark (8)", [0.185, 0.0047],
        [0.055, 0.056, 0.063, 0.073, 0.080, 0.087, 0.092, 0.094, 0.101, 0.111, 0.143, 0.168, 0.187, 0.205, 0.225, 0.245], [0.011, 4.4]),
    Mean("ISSA, cheek, light (537)", [0.0194, 0.0072],
        [0.187, 0.191, 0.221, 0.260, 0.281, 0.303, 0.310, 0.294, 0.306, 0.315, 0.439, 0.498, 0.518, 0.529, 0.538, 0.544], [0.021, 3.7]),
    Mean("ISSA, cheek, tan (615)", [0.0457, 0.0094],
        [0.102, 0.110, 0.136, 0.165, 0.184, 0.204, 0.215, 0.212, 0.226, 0.241, 0.332, 0.386, 0.412, 0.431, 0.449, 0.461], [0.013, 1.7]),
    Mean("NIST, forearm, all (100)", [0.0128, 0.0088],
        [0.185, 0.184, 0.212, 0.282, 0.307, 0.328, 0.335, 0.317, 0.323, 0.335, 0.447, 0.519, 0.547, 0.565, 0.584, 0.602], [0.024, 1.2]),
];

/// All light that comes back from a perpendicular beam: as an instrument of d/8° measures, by interchange of light and eye.
fn measured(melanin: f64, blood: f64) -> Spectrum {
    let skin = Skin::new(SkinParameters { melanin, blood, ..SkinParameters::default() }).unwrap();
    let totals = skin.totals(Incidence::NORMAL).unwrap();
    assert!(totals.iter().all(|totals| totals.error < 1e-6));
    std::array::from_fn(|i| totals[i].specular_reflectance + totals[i].diffuse_reflectance)
}

fn lab(spectrum: &Spectrum) -> [f64; 3] {
    let eye = Colorimeter::new(Observer::TwoDegrees, Illuminant::D65);
    eye.lab(eye.xyz(spectrum))
}

#[test]
fn reflectance_is_near_published_means() {
    println!("skin                                 melanin  blood   rms     ΔE00   greatest difference");
    for Mean(name, [melanin, blood], mean, [rms_limit, difference_limit]) in MEANS {
        let found = measured(melanin, blood);
        let squares = mean.iter().enumerate().map(|(i, mean)| (found[4 + 4 * i] - mean).powi(2));
        let rms = (squares.sum::<f64>() / mean.len() as f64).sqrt();
        // Both sampled alike
        let sampled = |value: &dyn Fn(usize) -> f64| -> Spectrum {
            std::array::from_fn(|i| {
                let place = (i as f64 / 4.0 - 1.0).clamp(0.0, 15.0);
                let below = (place as usize).min(14);
                value(below) + (value(below + 1) - value(below)) * (place - below as f64)
            })
        };
        let difference = delta_e_2000(lab(&sampled(&|i| found[4 + 4 * i])), lab(&sampled(&|i| mean[i])));
        let differences = mean.iter().enumerate().map(|(i, mean)| (400 + 20 * i, found[4 + 4 * i] - mean));
        let (at, greatest) = differences.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).unwrap();
        println!(
            "{name:36} {melanin:.4}   {blood:.4}  {rms:.4}  {difference:.2}   {greatest:+.3} at {at} nm"
        );
        assert!(rms < rms_limit && difference < difference_limit, "{name}: {rms} {difference}");
    }
}

#[test]
fn tones_are_classes_of_the_typology_angle() {
    // A. Chardon et al. 1991; S. Del Bino and F. Bernerd 2013
    let classes = [[55.0, 90.0], [41.0, 55.0], [28.0, 41.0], [10.0, 28.0], [-30.0, 10.0], [-90.0, -30.0]];
    for (tone, [least, most]) in TONES.into_iter().zip(classes) {
        let [lightness, _, b] = lab(&measured(tone.melanin, tone.blood));
        let angle = f64::atan2(lightness - 50.0, b).to_degrees();
        println!("{:4} {angle:.1}", tone.name);
        assert!((least..most).contains(&angle), "{}: {angle}", tone.name);
    }
}

#[test]
fn walk_spreads_light_as_the_exact_half_space() {
    // A dermis alone, without a surface, whose scattering is isotropic
    let parameters = SkinParameters { epidermis: 0.001, g: 0.0, eta: 1.0, ..SkinParameters::default() };
    let skin = Skin::new(SkinParameters { melanin: 0.0, ..parameters }).unwrap();
    let medium = skin.medium(4000, &Control::default()).unwrap().unwrap();
    let totals = skin.totals(Incidence::Cosine).unwrap();
    let eye = Colorimeter::new(Observer::TwoDegrees, Illuminant::D65);
    for (radius, enclosed) in medium.enclosed.iter().step_by(9) {
        let exact: Spectrum = std::array::from_fn(|i| {
            let dermis = &skin.layers(i).layers()[1];
            let (alpha, extinction) = (dermis.scattering / dermis.extinction(), dermis.extinction());
            let half_space = HalfSpace::new(alpha, Incidence::Cosine).unwrap();
            let part = half_space.enclosed(radius * extinction).value / half_space.total().value;
            part * totals[i].diffuse_reflectance
        });
        let exact = eye.linear_srgb(eye.xyz(&exact));
        for c in 0..3 {
            let expected = exact[c] / medium.surface_albedo[c];
            // Five standard errors, the epidermis, and wavelengths between those walked
            let limit = 5.0 * medium.standard_error[c] + 0.004;
            assert!((enclosed[c] - expected).abs() < limit, "{radius} {c}: {} {expected}", enclosed[c]);
        }
    }
}

#[test]
fn what_skin_is_made_of_is_checked() {
    let default = SkinParameters::default();
    for (parameters, message) in [
        (SkinParameters { melanin: 1.5, ..default }, "melanin is 1.5, but must be in [0, 1]"),
        (SkinParameters { blood: -0.1, ..default }, "blood is -0.1, but must be in [0, 1]"),
        (SkinParameters { oxygenation: f64::NAN, ..default }, "oxygenation is NaN, but must be in [0, 1]"),
        (SkinParameters { epidermis: 0.0, ..default }, "epidermis is 0, but must be in [0.001, 10] mm"),
        (
            SkinParameters { epidermis: f64::INFINITY, ..default },
            "epidermis is inf, but must be in [0.001, 10] mm",
        ),
        (
            SkinParameters { dermis: -1.0, ..default },
            "dermis is -1, but must be in [0.01, 100] mm, or infinite",
        ),
        (SkinParameters { g: 1.0, ..default }, "g is 1, but must be in [0, 0.95]"),
        (SkinParameters { eta: 0.9, ..default }, "eta is 0.9, but must be in [1, 2]"),
    ] {
        assert_eq!(Skin::new(parameters).unwrap_err().to_string(), message);
    }
}

#[test]
fn a_thick_dermis_is_an_endless_one() {
    let endless = Skin::new(SkinParameters::default()).unwrap().totals(Incidence::NORMAL).unwrap();
    let on_fat = |dermis| {
        let skin = Skin::new(SkinParameters { dermis, ..SkinParameters::default() }).unwrap();
        skin.totals(Incidence::NORMAL).unwrap()
    };
    for ((endless, thick), thin) in endless.iter().zip(on_fat(30.0)).zip(on_fat(0.5)) {
        assert!((endless.diffuse_reflectance - thick.diffuse_reflectance).abs() < 1e-6);
        assert!(
            (thin.absorbed.iter().sum::<f64>() + thin.diffuse_reflectance)
                < 1.0 - thin.specular_reflectance + 1e-9
        );
    }
    assert!(on_fat(0.5)[64].diffuse_reflectance > 1.01 * endless[64].diffuse_reflectance);
}

#[test]
fn table_of_media_states_its_error() {
    let ranges = [[0.01, 0.1], [0.004, 0.004]];
    let table = SkinTable::new(SkinParameters::default(), ranges, 300, &Control::default(), &mut |_| {});
    let table = table.unwrap().unwrap();
    assert!(table.error[0] < 0.005 && table.error[1] < 0.2, "{:?}", table.error);
    // At a node it is the skin's own medium, and between them nearly
    for (melanin, limit) in [(0.01, 1e-12), (0.1, 1e-12), (0.03, 1.5 * table.error[0])] {
        let skin = Skin::new(SkinParameters { melanin, blood: 0.004, ..SkinParameters::default() }).unwrap();
        let medium = skin.medium(300, &Control::default()).unwrap().unwrap();
        let [albedo, mfp] = table.medium(melanin, 0.004);
        for c in 0..3 {
            assert!((albedo[c] - medium.surface_albedo[c]).abs() <= limit, "{melanin}");
            assert!((mfp[c] / medium.mfp[c] - 1.0).abs() < 0.3);
        }
    }
    assert_eq!(table.medium(0.5, 0.0), table.medium(0.1, 0.004));
    assert_eq!(table.medium(f64::NAN, 0.0), table.medium(0.01, 0.004));
}

#[test]
fn presets_are_the_media_of_tones() {
    for tone in TONES {
        let parameters =
            SkinParameters { melanin: tone.melanin, blood: tone.blood, ..SkinParameters::default() };
        let medium = Skin::new(parameters).unwrap().medium(2000, &Control::default()).unwrap().unwrap();
        let preset = preset(&format!("skin-{}", tone.name)).unwrap();
        for c in 0..3 {
            assert!(
                (preset.surface_albedo()[c] - medium.surface_albedo[c]).abs() < 5.1e-5,
                "{tone:?} {medium:?}"
            );
            // Four standard errors of so few photons
            let ratio = preset.mfp_in_millimeters()[c] / medium.mfp[c];
            assert!((ratio - 1.0).abs() < 0.1, "{tone:?} {ratio}");
        }
    }
}
