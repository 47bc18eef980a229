//! The thin-walled surface that stands for a slab of a material.

use clap::Args;
use translucid_laboratory::Cell;
use translucid_laboratory::stack::{
    DiffuseTransmissionWall, ScatteringWall, SlabChannel, SlabLight, ThinWall,
};
use translucid_profile::ParameterError;
use translucid_profile::convention::Channel;

use super::output::Row;
use crate::failure::Failure;
use crate::messages;

/// The slab.
#[derive(Args, Debug)]
pub(super) struct ThinArguments {
    /// Thickness of a slab, in --unit: prints the thin-walled surface that stands for it, in place of the systems' numbers
    #[arg(long, value_name = "THICKNESS", allow_negative_numbers = true, conflicts_with_all = ["to", "set", "to_unit"])]
    thin: Option<f64>,
    /// Mean cosine of the slab's phase function, in [-0.95, 0.95]
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true, requires = "thin")]
    g: f64,
    /// Index of refraction of the slab, in [1, 3]
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true, requires = "thin")]
    eta: f64,
}

/// A thin wall in the words of a system: parameters of all channels or of each, and where the words come from.
struct Told {
    system: &'static str,
    source: &'static str,
    parameters: Vec<(&'static str, Vec<f64>)>,
    wall: ThinWall,
}

impl ThinArguments {
    /// Returns whether a thin wall is asked for.
    pub(super) fn is_asked(&self) -> bool {
        self.thin.is_some()
    }

    /// The slab and the walls, for channels with lengths in the unit of the thickness.
    pub(super) fn rows(&self, channels: &[Channel]) -> Result<Vec<Row>, Failure> {
        let Self { g, eta, .. } = *self;
        let thickness = self.thin.unwrap_or_default();
        let channels: Vec<SlabChannel> = channels
            .iter()
            .map(|channel| SlabChannel {
                surface_albedo: channel.albedo().of_channel(),
                transport_mfp: channel.mfp(),
            })
            .collect();
        let slabs = SlabLight::of_slab(&channels, thickness, g, eta).map_err(|error| in_options(&error))?;
        if g != 0.0 {
            messages::print_note(
                "lengths are converted as transport mean free paths: that of the slab, 1/\u{3c3}_t, is 1 \u{2212} \u{3b1} g times as long",
            );
        }
        let column = |of: &dyn Fn(&SlabLight) -> f64| slabs.iter().map(of).collect::<Vec<f64>>();
        let exact = "exact: translucid-reference, layers";
        let mut rows = Vec::new();
        for (parameter, values) in [
            ("reflectance", column(&|slab| slab.diffuse[0])),
            ("transmittance", column(&|slab| slab.diffuse[1])),
            ("transmittance unscattered", column(&|slab| slab.unscattered)),
        ] {
            push(&mut rows, "slab", parameter, &values, exact);
        }
        let scattering = ScatteringWall::of(&slabs, eta);
        let diffuse = DiffuseTransmissionWall::of(&slabs, eta);
        for told in walls(&scattering, &diffuse, eta) {
            for (parameter, values) in &told.parameters {
                push(&mut rows, told.system, parameter, values, told.source);
            }
            let errors: Vec<_> =
                slabs.iter().enumerate().map(|(c, slab)| told.wall.errors(c, slab, eta)).collect();
            for (parameter, values) in [
                ("reflectance error", errors.iter().map(|e| e.reflectance).collect::<Vec<_>>()),
                ("transmittance error", errors.iter().map(|e| e.transmittance).collect()),
                ("greatest error by angle", errors.iter().map(|e| e.by_angle).collect()),
            ] {
                push(&mut rows, told.system, parameter, &values, "computed: the wall less the slab");
            }
        }
        Ok(rows)
    }
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

/// Adds a row for all channels, or for each.
fn push(rows: &mut Vec<Row>, system: &str, parameter: &str, values: &[f64], source: &str) {
    for (i, value) in values.iter().enumerate() {
        let channel = if values.len() == 1 { "all" } else { ["r", "g", "b"][i] };
        let [system, parameter, channel] = [system, parameter, channel].map(Cell::from);
        let empty = || Cell::from("");
        rows.push([system, parameter, channel, Cell::from(*value), empty(), empty(), Cell::from(source)]);
    }
}

/// An error of the slab in the words of the command.
fn in_options(error: &ParameterError) -> Failure {
    let option = match error.parameter {
        "thickness" => "--thin",
        "g" => "--g",
        "eta" => "--eta",
        _ => return Failure::input(format!("the slab cannot be solved: {error}")),
    };
    let (value, requirement) = (error.value, error.requirement());
    Failure::input(format!("{option} is {value}, but must be {requirement}"))
}
