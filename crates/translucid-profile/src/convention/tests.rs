//! Laws of all systems: the published table, and the way there and back.

use super::*;
use crate::Configuration::{Diffuse, Searchlight};
use crate::{Medium, ParameterError, half_space_surface_albedo};

fn find(name: &str) -> &'static System {
    System::named(name).next().unwrap()
}

/// A color that leaves 1/e of the light after the distance, which is the length then.
const ONE_LENGTH: f64 = 0.36787944117144233;

/// Width d for a product of parameters of 1.
fn width_at_one(system: &System, albedo: SurfaceAlbedo) -> Result<f64, ParameterError> {
    let values: Vec<f64> = system
        .parameters
        .iter()
        .map(|parameter| match parameter.role {
            Role::Factor { per, .. } => per,
            Role::Attenuation => ONE_LENGTH,
            role => role.default(),
        })
        .collect();
    Ok(system.read(&values, albedo, Diffuse)?.d())
}

/// The table of the module's page, and so of docs/guide/conventions.md.
#[test]
fn width_at_length_one_is_that_of_the_table() {
    let table: [(&[&str], [&str; 4]); 7] = [
        (&["cycles-burley"], ["0.080", "0.080", "0.080", "0.080"]),
        (&["cycles-2.9", "sort"], ["0.027", "0.046", "0.072", "0.077"]),
        (&["pbrt-v3-disney"], ["0.200", "0.200", "0.200", "0.200"]),
        (&["moonray", "unreal-5.0", "renderman"], ["0.283", "0.279", "0.119", "0.055"]),
        (&["appleseed"], ["0.316", "0.650", "0.952", "1.083"]),
        (&["unreal"], ["0.527", "1.083", "1.587", "1.804"]),
        (&["hdrp", "materialx"], ["1.000", "1.000", "1.000", "1.000"]),
    ];
    for (names, widths) in table {
        for name in names {
            for (a, expected) in [0.2, 0.5, 0.8, 0.95].into_iter().zip(widths) {
                let d = width_at_one(find(name), SurfaceAlbedo::gray(a).unwrap()).unwrap();
                assert_eq!(format!("{d:.3}"), expected, "{name} at {a}");
            }
        }
    }
}

#[test]
fn width_at_length_one_of_eevee_depends_on_the_brightest_channel() {
    let widths = [(0.2, "0.027"), (0.5, "0.046"), (0.8, "0.072"), (0.95, "0.077")];
    for (a, beside_white) in widths {
        let d = width_at_one(find("eevee"), SurfaceAlbedo::new(a, 1.0).unwrap()).unwrap();
        assert_eq!(format!("{d:.3}"), beside_white);
        let gray = width_at_one(find("eevee"), SurfaceAlbedo::gray(a).unwrap()).unwrap();
        assert_eq!(format!("{gray:.3}"), "0.077");
    }
}

#[test]
fn width_of_rise_and_of_media_by_the_diffuse_fit_is_that_of_the_table() {
    for (a, expected) in [(0.2, "0.338"), (0.5, "0.583"), (0.8, "0.909"), (0.95, "0.972")] {
        let albedo = SurfaceAlbedo::gray(a).unwrap();
        // A transport mean free path of 1, with and without forward scattering
        for g in [0.0, 0.75] {
            let d = find("rise").read(&[1.0 - a, a / (1.0 - g), g], albedo, Searchlight).unwrap().d();
            assert_eq!(format!("{d:.3}"), expected);
        }
        for name in
            ["openpbr", "arnold", "appleseed-random-walk", "translucid", "gltf", "substrate", "karma", "vray"]
        {
            let d = width_at_one(find(name), albedo).unwrap();
            assert_eq!(format!("{d:.3}"), expected, "{name}");
        }
    }
}

/// 5.1's own comment: a mean free path of 1 is a diffuse one of 1.44 at A = 0, of 43.50 at A = 1.
#[test]
fn unreal_converts_its_lengths_as_its_comment_says() {
    for (a, dmfp) in [(0.0, "1.44"), (1.0, "43.51")] {
        let channel =
            find("unreal").read(&[1.0, 1.0, 0.1], SurfaceAlbedo::gray(a).unwrap(), Diffuse).unwrap();
        let old = find("unreal-5.0");
        let Ok(Written::Length(found)) = old.write(&channel, &old.defaults(), Diffuse) else { panic!("{a}") };
        // The comment cuts 43.508 off
        assert_eq!(format!("{found:.2}"), dmfp);
    }
}

/// RenderMan's page lists Jensen's skin2 of 2001 (σ_a = 0.013, σ'_s = 1.09 per mm, red) with 4.82: a diffuse mean
/// free path in millimeters, with the classical D.
#[test]
fn renderman_lengths_are_diffuse_mean_free_paths_in_millimeters() {
    let (sigma_a, sigma_s_prime) = (0.013f64, 1.09);
    let dmfp = 1.0 / (3.0 * sigma_a * (sigma_a + sigma_s_prime)).sqrt();
    assert_eq!(format!("{dmfp:.2}"), "4.82");
}

#[test]
fn every_system_there_and_back_is_the_same() {
    for configuration in [Searchlight, Diffuse] {
        for system in System::ALL {
            for a in [0.0, 1e-12, 0.01, 0.2, 0.5, 0.8, 0.95, 0.999, 1.0] {
                for length in [1e-100, 1e-3, 1.0, 7.3, 1e100] {
                    let albedo = SurfaceAlbedo::new(a, (a + 0.1f64).min(1.0)).unwrap();
                    let channel = Channel::from_d(albedo, length, configuration).unwrap();
                    there_and_back(system, &channel, configuration);
                }
            }
        }
    }
}

fn there_and_back(system: &System, channel: &Channel, configuration: crate::Configuration) {
    let name = system.title;
    let a = channel.albedo().of_channel();
    let mut values = system.defaults();
    match system.write(channel, &values, configuration) {
        Err(error) => {
            assert!(system.name == "unreal-signed" && a < 0.18, "{name} at {a}: {error}");
            return;
        }
        Ok(Written::Length(length)) => {
            let is_part = |p: &Parameter| matches!(p.role, Role::Length | Role::Attenuation);
            let part = system.parameters.iter().position(is_part).unwrap();
            values[part] = length;
            if system.parameters[part].role == Role::Attenuation {
                let distance = system.parameters.iter().position(|p| p.role == Role::Distance).unwrap();
                (values[part], values[distance]) = (ONE_LENGTH, length);
            }
        }
        Ok(Written::Coefficients { sigma_a, sigma_s }) => values[..2].copy_from_slice(&[sigma_a, sigma_s]),
    }
    let own = system.own_albedo(channel.albedo(), &values).unwrap();
    let back = system.read(&values, own, configuration).unwrap();
    if a > system.brightest(&values).unwrap() - 1e-9 || a < 1e-9 && own.of_channel() != a {
        assert!((back.mfp() / channel.mfp() - 1.0).abs() < 1e-12, "{name} at {a}: mfp");
        return;
    }
    assert!((back.albedo().of_channel() - a).abs() < 1e-12, "{name} at {a}: {:?}", back.albedo());
    assert!((back.d() / channel.d() - 1.0).abs() < 1e-11, "{name} at {a}: d {}", back.d() / channel.d());
    assert!((back.mfp() / channel.mfp() - 1.0).abs() < 1e-12, "{name} at {a}: mfp");
    if let Some(found) = system.surface_albedo(&values, configuration).unwrap() {
        // 1 − α has no digits beyond the sixteenth, and A = 1 − O(√(1−α)) shows it
        let allowed = 1e-12 + 3e-16 / (1.0 - a).max(1e-8);
        assert!((found - a).abs() < allowed, "{name} at {a}: {found}");
    }
}

#[test]
fn similar_media_are_one_material() {
    let pbrt = find("pbrt");
    let isotropic = [0.1, 0.9, 0.0, 1.0];
    let forward = [0.1, 9.0, 0.9, 1.0];
    let scaled = [0.01, 0.09, 0.0, 10.0];
    let a = pbrt.surface_albedo(&isotropic, Diffuse).unwrap().unwrap();
    assert!((a - half_space_surface_albedo(0.9, Diffuse)).abs() < 1e-13);
    for values in [isotropic, forward, scaled] {
        let found = pbrt.surface_albedo(&values, Diffuse).unwrap().unwrap();
        assert!((found - a).abs() < 1e-13, "{values:?}: {found}");
        let channel = pbrt.read(&values, SurfaceAlbedo::gray(a).unwrap(), Diffuse).unwrap();
        assert!((channel.mfp() - 1.0).abs() < 1e-14);
        let Ok(Written::Coefficients { sigma_a, sigma_s }) = pbrt.write(&channel, &values, Diffuse) else {
            panic!()
        };
        assert!((sigma_a / values[0] - 1.0).abs() < 1e-10 && (sigma_s / values[1] - 1.0).abs() < 1e-10);
    }
}

/// The coefficients that Cycles walks with, by its definitions of the length.
#[test]
fn transport_mean_free_paths_of_cycles_are_those_of_its_media() {
    for g in [-0.5, 0.0, 0.3, 0.9_f64] {
        for color in [0.05, 0.5, 0.9] {
            let walks = [
                ("cycles-walk", CyclesWalk::new(g), 1.0),
                // The older one knows no backward scattering
                (
                    "cycles-walk-legacy",
                    CyclesWalk::legacy(g),
                    4.0 * std::f64::consts::PI / (1.0 - g.max(0.0)),
                ),
            ];
            for (name, walk, sigma_t) in walks {
                let (g, alpha) = (walk.g(), walk.single_scattering_albedo(color).max(0.2));
                let medium = Medium::new((1.0 - alpha) * sigma_t, alpha * sigma_t, g).unwrap();
                let albedo = SurfaceAlbedo::gray(color).unwrap();
                let found = find(name).read(&[1.0, 1.0, g], albedo, Diffuse).unwrap();
                assert!((found.mfp() / medium.transport_mfp() - 1.0).abs() < 1e-12, "{name} {g} {color}");
                let expected = walk.surface_albedo(color);
                assert!((found.albedo().of_channel() - expected).abs() < 1e-12, "{name} {g} {color}");
            }
        }
    }
}

/// The medium of glTF's drafts: σ_t = −ln c/d, and α of the multi-scatter color and g, which the newer draft states.
#[test]
fn gltf_is_the_medium_of_its_drafts() {
    for (color, g) in [(0.3, 0.0), (0.8, 0.0), (0.8, 0.6), (0.5, -0.4)] {
        let s = 4.09712 + 4.20863 * color - (9.59217f64 + 41.6808 * color + 17.7126 * color * color).sqrt();
        let alpha = (1.0 - s * s) / (1.0 - g * s * s);
        let (d, c) = (0.01, 0.75f64);
        let sigma_t = -c.ln() / d;
        let medium = Medium::new((1.0 - alpha) * sigma_t, alpha * sigma_t, g).unwrap();
        let albedo = SurfaceAlbedo::gray(color).unwrap();
        let found = find("gltf").read(&[d, c, g], albedo, Diffuse).unwrap();
        assert!((found.mfp() / medium.transport_mfp() - 1.0).abs() < 1e-12, "{color} {g}");
        assert!((medium.surface_albedo(Diffuse) - color).abs() < 2.5e-3, "{color} {g}");
        assert_eq!(found.albedo().of_channel(), color);
    }
}

/// Coefficients of Adobe Standard Material as its importer of glTF has them: the extinction of the scattering part is
/// 1/(scatteringDistance scale) times max(α)/max(α, max(α)/1000), and the absorption part is added.
#[test]
fn adobe_adds_its_absorption() {
    let system = find("adobe");
    let alpha = |c: f64| {
        let s = 4.09712 + 4.20863 * c - (9.59217f64 + 41.6808 * c + 17.7126 * c * c).sqrt();
        1.0 - s * s
    };
    let greatest = 0.9;
    for color in [1e-4, 0.2, 0.9] {
        for (filter, distance) in [(1.0, 0.0), (0.5, 0.0), (1.0, 3.0), (0.4, 3.0)] {
            let (scattering_distance, scale) = (2.0, 0.7);
            let from_scattering = 1.0 / (scattering_distance * scale) * alpha(greatest)
                / alpha(color).max(alpha(greatest) / 1000.0);
            let sigma_s = alpha(color) * from_scattering;
            let more = if distance > 0.0 { -f64::ln(filter) / distance } else { 0.0 };
            let medium = Medium::new(from_scattering - sigma_s + more, sigma_s, 0.0).unwrap();
            let albedo = SurfaceAlbedo::new(color, greatest).unwrap();
            let found =
                system.read(&[scattering_distance, scale, distance, filter], albedo, Diffuse).unwrap();
            assert!((found.mfp() / medium.transport_mfp() - 1.0).abs() < 1e-12, "{color} {filter}");
            let returned = medium.surface_albedo(Diffuse);
            assert!((found.albedo().of_channel() - returned).abs() < 2.5e-3, "{color} {filter}");
        }
    }
}

#[test]
fn read_and_write_refuse_what_has_no_meaning() {
    let albedo = SurfaceAlbedo::gray(0.5).unwrap();
    for system in System::ALL {
        for bad in [-1.0, f64::NAN, f64::INFINITY, 1e-111, 1e111] {
            for i in 0..system.parameters.len() {
                let mut values = system.defaults();
                if system.has_coefficients() {
                    values[..2].copy_from_slice(&[0.5, 0.5]);
                }
                for (value, parameter) in values.iter_mut().zip(system.parameters) {
                    if parameter.role == Role::Attenuation {
                        *value = ONE_LENGTH;
                    }
                }
                values[i] = bad;
                let is_tiny_coefficient =
                    i < 2 && system.has_coefficients() && bad.abs() < 1e112 && bad > 0.0;
                let is_setting = matches!(system.parameters[i].role, Role::Setting { .. });
                let is_small_setting = is_setting && bad == 1e-111;
                let is_color = matches!(system.parameters[i].role, Role::Attenuation | Role::Filter);
                let is_black = is_color && bad == 1e-111;
                let read = system.read(&values, albedo, Diffuse);
                assert_eq!(
                    read.is_ok(),
                    is_tiny_coefficient || is_small_setting || is_black,
                    "{} {i} {bad}",
                    system.title
                );
            }
        }
    }
    let dark = SurfaceAlbedo::gray(0.1).unwrap();
    let error = find("unreal-signed").read(&[1.0], dark, Diffuse).unwrap_err();
    assert!(error.to_string().contains("s(A) is negative"), "{error}");
}

#[test]
fn names_are_fit_for_a_command_line() {
    for system in System::ALL {
        let fit = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "-.".contains(c);
        assert!(system.name.chars().all(fit) && !system.source.place.is_empty());
        let is_part = |p: &&Parameter| matches!(p.role, Role::Length | Role::Attenuation);
        let lengths = system.parameters.iter().filter(is_part).count();
        assert_eq!(lengths == 1, !system.has_coefficients(), "{}", system.name);
        // Parameters tell the ways of one system apart
        for other in System::named(system.name).filter(|other| other.title != system.title) {
            assert_ne!(other.parameters[0].name, system.parameters[0].name);
        }
    }
}

/// Media return other surface albedos than were asked for, in diffuse light and without a boundary: the figures of
/// docs/guide/conventions.md.
#[test]
fn inversions_of_the_albedo_differ_between_systems() {
    // OpenPBR and MaterialX: van de Hulst's approximation as C. Kulla and A. Conty 2017 invert it
    let open_pbr = |c: f64| {
        let s = 4.09712 + 4.20863 * c - (9.59217 + 41.6808 * c + 17.7126 * c * c).sqrt();
        1.0 - s * s
    };
    // Cycles' random walks: the fit of M. Wrenninge, R. Villemin and C. Hery 2017 at g = 0
    let cycles = |c: f64| {
        let blend = c.powf(0.25);
        let dark = 1.8260523782 * (5.112467903308 * c).atan().powf(1.09686102424);
        let bright = 0.496310210422 * (4.23500903650 * c).atan().powf(2.40602999408);
        ((1.0 - blend) * dark + blend * bright).clamp(0.0, 0.999999)
    };
    for (a, by_open_pbr, by_cycles) in
        [(0.2, "0.202", "0.202"), (0.5, "0.501", "0.505"), (0.8, "0.800", "0.812"), (0.95, "0.950", "0.998")]
    {
        assert_eq!(format!("{:.3}", half_space_surface_albedo(open_pbr(a), Diffuse)), by_open_pbr);
        assert_eq!(format!("{:.3}", half_space_surface_albedo(cycles(a), Diffuse)), by_cycles);
    }
}
