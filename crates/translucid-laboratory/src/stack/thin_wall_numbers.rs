//! Thin walls in the numbers of the systems that have them, and back to the slab of a wall.

use translucid_profile::convention::{Channel, Converted, ConvertedNumber};
use translucid_profile::{ParameterError, require};

use super::{DiffuseTransmissionWall, ScatteringWall, SlabChannel, SlabLight, ThinWall, WallSlab};

/// A thin wall in the words of a system: parameters of all channels or of each, and where the words come from.
struct Told {
    system: &'static str,
    source: &'static str,
    parameters: Vec<(&'static str, Vec<f64>)>,
    wall: ThinWall,
}

/// The light of a slab of a material, the thin walls that stand for it in the numbers of OpenPBR, Blender and glTF, and their
/// errors; lengths of the channels are in the unit of the thickness.
///
/// # Errors
/// The thickness, g or η is outside its range.
pub fn thin_wall_numbers(
    channels: &[Channel],
    thickness: f64,
    g: f64,
    eta: f64,
) -> Result<Converted, ParameterError> {
    let of_slab = |channel: &Channel| SlabChannel {
        surface_albedo: channel.albedo().of_channel(),
        transport_mfp: channel.mfp(),
    };
    let channels: Vec<SlabChannel> = channels.iter().map(of_slab).collect();
    let slabs = SlabLight::of_slab(&channels, thickness, g, eta)?;
    let column = |of: &dyn Fn(&SlabLight) -> f64| slabs.iter().map(of).collect::<Vec<f64>>();
    let exact = "exact: translucid-reference, layers";
    let mut converted = Converted::default();
    let mut push = |system, parameter, values: &[f64], source| {
        converted.numbers.extend(ConvertedNumber::computed(system, parameter, values, source));
    };
    push("slab", "reflectance", &column(&|slab| slab.diffuse[0]), exact);
    push("slab", "transmittance", &column(&|slab| slab.diffuse[1]), exact);
    push("slab", "transmittance unscattered", &column(&|slab| slab.unscattered), exact);
    for told in walls(&ScatteringWall::of(&slabs, eta), &DiffuseTransmissionWall::of(&slabs, eta), eta) {
        for (parameter, values) in &told.parameters {
            push(told.system, parameter, values, told.source);
        }
        let errors: Vec<_> =
            slabs.iter().enumerate().map(|(c, slab)| told.wall.errors(c, slab, eta)).collect();
        for (parameter, values) in [
            ("reflectance error", errors.iter().map(|e| e.reflectance).collect::<Vec<_>>()),
            ("transmittance error", errors.iter().map(|e| e.transmittance).collect()),
            ("greatest error by angle", errors.iter().map(|e| e.by_angle).collect()),
        ] {
            push(told.system, parameter, &values, "computed: the wall less the slab");
        }
    }
    if g != 0.0 {
        converted.notes.push(NOTE_OF_G.to_owned());
    }
    Ok(converted)
}

const NOTE_OF_G: &str = "lengths are transport mean free paths: the mean free path of the slab, 1/\u{3c3}_t, is 1 \u{2212} \u{3b1} g times as long";

/// The slab that has the light of a thin wall, of the color and the balance of each channel or of all: its albedos, its thickness
/// in mean free paths, and its transport mean free path in thicknesses, or in the unit of a thickness.
///
/// # Errors
/// The numbers of color or balance are not one or three, a parameter is outside its range, or no slab has the light.
pub fn wall_slab_numbers(
    color: &[f64],
    balance: &[f64],
    thickness: Option<f64>,
    g: f64,
    eta: f64,
) -> Result<Converted, ParameterError> {
    for (name, values) in [("number of colors", color), ("number of balances", balance)] {
        require(matches!(values.len(), 1 | 3), name, values.len() as f64, "1 or 3")?;
    }
    if let Some(thickness) = thickness {
        super::thin_wall::require_thickness(thickness)?;
    }
    let count = color.len().max(balance.len());
    let of = |values: &[f64], c: usize| values[c.min(values.len() - 1)];
    let slabs: Vec<WallSlab> =
        (0..count).map(|c| WallSlab::new(of(color, c), of(balance, c), g, eta)).collect::<Result<_, _>>()?;
    let mut converted = Converted::default();
    let mut push = |parameter, value: &dyn Fn(&WallSlab) -> f64| {
        let values: Vec<f64> = slabs.iter().map(value).collect();
        let source = "exact: translucid-reference, layers, solved for the light of the wall";
        converted.numbers.extend(ConvertedNumber::computed("slab", parameter, &values, source));
    };
    push("single_scattering_albedo", &|slab| slab.single_scattering_albedo);
    push("thickness in mean free paths", &|slab| slab.optical_thickness);
    push("surface_albedo", &|slab| slab.surface_albedo);
    match thickness {
        Some(thickness) => push("mfp", &|slab| thickness * slab.transport_mfp),
        None => push("mfp in thicknesses", &|slab| slab.transport_mfp),
    }
    push("transmittance unscattered", &|slab| slab.unscattered);
    if g != 0.0 {
        converted.notes.push(NOTE_OF_G.to_owned());
    }
    Ok(converted)
}

/// Both walls in the words of every system that has them.
fn walls(scattering: &ScatteringWall, diffuse: &DiffuseTransmissionWall, eta: f64) -> [Told; 5] {
    let one = |number: f64| vec![number];
    let has_interface = if eta == 1.0 { 0.0 } else { 1.0 };
    let (color, anisotropy) = (&scattering.color, scattering.anisotropy);
    [
        Told {
            system: "openpbr",
            source: "document: OpenPBR Surface 1.1.1, index.html, Thin-walled mode",
            parameters: vec![
                ("geometry_thin_walled", one(1.0)),
                ("subsurface_weight", one(1.0)),
                ("subsurface_color", color.clone()),
                ("subsurface_scatter_anisotropy", one(anisotropy)),
                ("specular_weight", one(has_interface)),
                ("specular_ior", one(eta)),
            ],
            wall: scattering.wall(),
        },
        Told {
            system: "openpbr with base",
            source: "document: OpenPBR Surface 1.1.1, index.html, Thin-walled mode",
            parameters: vec![
                ("geometry_thin_walled", one(1.0)),
                ("base_color", diffuse.base_color.clone()),
                ("subsurface_weight", one(diffuse.factor)),
                ("subsurface_color", diffuse.color.clone()),
                // All of it to the other side: (−1, 1) is open
                ("subsurface_scatter_anisotropy", one(0.9999)),
                ("specular_weight", one(has_interface)),
                ("specular_ior", one(eta)),
            ],
            wall: diffuse.wall(),
        },
        Told {
            system: "blender",
            source: "measured: pictures of Blender 5.2 (blender/tests/test_materials.py)",
            parameters: vec![
                ("Thin Wall", one(1.0)),
                ("Subsurface Weight", one(1.0)),
                ("Base Color", color.clone()),
                ("Subsurface Anisotropy", one(anisotropy)),
                ("Specular IOR Level", one(0.5 * has_interface)),
                ("IOR", one(eta)),
            ],
            wall: scattering.wall(),
        },
        Told {
            system: "gltf-scatter",
            source: "document: KhronosGroup/glTF@0addbb0, KHR_materials_scatter, README.md, Thin-Walled Mode",
            parameters: vec![
                ("transmissionFactor", one(1.0)),
                ("scatterStrengthFactor", one(1.0)),
                ("multiscatterColorFactor", color.clone()),
                ("scatterAnisotropy", one(anisotropy)),
                ("ior", one(eta)),
            ],
            wall: scattering.wall(),
        },
        Told {
            system: "gltf-diffuse-transmission",
            source: "document: KhronosGroup/glTF@097b8b7, KHR_materials_diffuse_transmission, README.md",
            parameters: vec![
                ("baseColorFactor", diffuse.base_color.clone()),
                ("diffuseTransmissionFactor", one(diffuse.factor)),
                ("diffuseTransmissionColorFactor", diffuse.color.clone()),
                ("ior", one(eta)),
            ],
            wall: diffuse.wall(),
        },
    ]
}
