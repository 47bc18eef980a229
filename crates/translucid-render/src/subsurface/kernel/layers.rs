//! The kernel of a material of layers: the profile of their exact solution in diffuse light.

use glam::Vec3;
use rayon::prelude::*;
use translucid_profile::{
    AlbedoInversion, AlbedoTable, AlbedoTableF32, Configuration, ParameterError, Parameterization, ProfileRow,
};
use translucid_reference::layers::{Ground, Layer, Layers};
use translucid_scene::{LayerMedium, Material, SubsurfaceLayer};

use super::{Angular, SubsurfaceKernel};
use crate::subsurface::parameters::Subsurface;

/// Names of channels in messages.
const CHANNELS: [&str; 3] = ["red", "green", "blue"];
/// Total below which a channel is black.
const BLACK: f64 = 1e-6;
/// Factor between the surface albedos of channels that are alike: a table tells profiles apart by theirs.
const APART: f32 = 1.0 - 1e-6;

/// The inputs of the profile of layers: materials with equal recipes share one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LayersRecipe {
    /// What keeps the material from the profile.
    fault: Option<String>,
    g: f64,
    eta: f64,
    parameterization: Parameterization,
    surface_albedo: [f32; 3],
    length: [f32; 3],
    layers: Vec<SubsurfaceLayer>,
}

/// The profile of a channel.
struct ChannelRow {
    /// Radii are in `length`.
    row: ProfileRow,
    surface_albedo: f32,
    length: f32,
}

impl LayersRecipe {
    /// The layers of a material on its medium.
    pub(super) fn of(material: &Material) -> Self {
        let within =
            |x: f32, range: std::ops::RangeInclusive<f64>| f64::from(x).clamp(*range.start(), *range.end());
        let length = material.subsurface_radius.factor * material.subsurface_radius_scale.factor;
        Self {
            fault: material.fault_of_layered_profile(),
            g: within(material.subsurface_scatter_anisotropy, AlbedoInversion::G),
            eta: within(material.subsurface_eta, AlbedoInversion::ETA),
            parameterization: material.subsurface_parameter,
            surface_albedo: material.subsurface_color.factor.clamp(Vec3::ZERO, Vec3::ONE).to_array(),
            length: length.to_array(),
            layers: material.layers.clone(),
        }
    }

    /// The g and η that are used, which are the material's or the nearest within reach.
    pub(super) fn g_and_eta(&self) -> [f64; 2] {
        [self.g, self.eta]
    }

    /// Solves for the profiles of all channels.
    ///
    /// # Errors
    /// The material's medium varies, or the layers are not solved: in words.
    pub(super) fn make(&self) -> Result<SubsurfaceKernel, String> {
        if let Some(fault) = &self.fault {
            return Err(fault.clone());
        }
        let stacks = self.stacks().map_err(|error| error.to_string())?;
        let solve = |(c, stack): (usize, Vec<Layer>)| -> Result<Option<ChannelRow>, String> {
            let refused = |error: String| format!("{}: {error}", CHANNELS[c]);
            if stack.iter().all(|layer| layer.scattering == 0.0) {
                return Ok(None);
            }
            let layers = Layers::new(1.0, stack, Ground::None).map_err(|error| refused(error.to_string()))?;
            let profile = layers.diffuse_profile().map_err(|error| refused(error.to_string()))?;
            if profile.total() <= BLACK {
                return Ok(None);
            }
            let row = profile.row().map_err(|error| refused(error.to_string()))?;
            Ok(Some(ChannelRow::new(row)))
        };
        let rows: Result<Vec<Option<ChannelRow>>, String> =
            stacks.into_par_iter().enumerate().map(solve).collect();
        Self::kernel(rows?)
    }

    /// The layers of each channel, from the surface inwards.
    fn stacks(&self) -> Result<[Vec<Layer>; 3], ParameterError> {
        // Light leaves the medium behind the layers through the boundary, but that of a layer is stated without one
        let own = AlbedoInversion::new(self.g, self.eta, Configuration::Diffuse)?;
        let mut known: Vec<AlbedoInversion> = Vec::new();
        let mut stacks: [Vec<Layer>; 3] = Default::default();
        for layer in &self.layers {
            let (g, thickness) = (f64::from(layer.g), f64::from(layer.thickness));
            let is_appearance = matches!(layer.medium, LayerMedium::Appearance { .. });
            if is_appearance && known.iter().all(|inversion| inversion.g() != g) {
                known.push(AlbedoInversion::new(g, 1.0, Configuration::Diffuse)?);
            }
            for (c, stack) in stacks.iter_mut().enumerate() {
                let medium = match layer.medium {
                    LayerMedium::Coefficients { scattering, absorption } => {
                        Layer::new(scattering[c].into(), absorption[c].into(), thickness).with_g(g)
                    }
                    LayerMedium::Appearance { surface_albedo, mfp } => {
                        let inversion = known.iter().find(|known| known.g() == g).unwrap_or(&own);
                        medium(inversion, surface_albedo[c], mfp[c], Parameterization::Mfp, thickness)
                    }
                };
                stack.push(medium.with_eta(self.eta));
            }
        }
        for (c, stack) in stacks.iter_mut().enumerate() {
            let (albedo, length) = (self.surface_albedo[c], self.length[c]);
            let innermost = medium(&own, albedo, length, self.parameterization, f64::INFINITY);
            stack.push(innermost.with_eta(self.eta));
        }
        Ok(stacks)
    }

    fn kernel(mut channels: Vec<Option<ChannelRow>>) -> Result<SubsurfaceKernel, String> {
        // From the brightest on, each has its own surface albedo
        let mut order: Vec<&mut ChannelRow> = channels.iter_mut().flatten().collect();
        order.sort_by(|a, b| b.surface_albedo.total_cmp(&a.surface_albedo));
        let mut most = f32::INFINITY;
        for channel in &mut order {
            channel.surface_albedo = channel.surface_albedo.min(most);
            channel.row.surface_albedo = Some(channel.surface_albedo.into());
            most = channel.surface_albedo * APART;
        }
        let rows: Vec<ProfileRow> = order.iter().rev().map(|channel| channel.row.clone()).collect();
        if rows.is_empty() {
            return Err(String::from("no channel returns light"));
        }
        let table = AlbedoTable::from_profile_rows(&rows).map_err(|error| error.to_string())?;
        let of = |f: fn(&ChannelRow) -> f32| {
            let values: Vec<f32> = channels.iter().map(|channel| channel.as_ref().map_or(0.0, f)).collect();
            Vec3::from_slice(&values)
        };
        let own = Subsurface {
            surface_albedo: of(|channel| channel.surface_albedo),
            length: of(|channel| channel.length),
        };
        Ok(SubsurfaceKernel {
            radial: AlbedoTableF32::from(&table),
            brightest: 1.0,
            has_any_shape: true,
            own: Some(own),
            angular: Angular::Nothing,
            notes: Vec::new(),
        })
    }
}

impl ChannelRow {
    /// In the length within which half of the light leaves.
    fn new(mut row: ProfileRow) -> Self {
        let total = row.surface_albedo.unwrap_or(1.0);
        let half = row.enclosed.partition_point(|within| *within < 0.5 * total).min(row.radii.len() - 1);
        let length = row.radii[half] as f32;
        let unit = f64::from(length);
        row.radii.iter_mut().for_each(|r| *r /= unit);
        row.reflectances.iter_mut().for_each(|reflectance| *reflectance *= unit * unit);
        Self { row, surface_albedo: total as f32, length }
    }
}

/// A layer of the medium of a surface albedo and a length; a black one only absorbs.
fn medium(
    inversion: &AlbedoInversion,
    surface_albedo: f32,
    length: f32,
    parameterization: Parameterization,
    thickness: f64,
) -> Layer {
    let (albedo, length) = (f64::from(surface_albedo), f64::from(length));
    let alpha = inversion.single_scattering_albedo(albedo);
    let extinction = 1.0 / inversion.mfp(albedo, length, parameterization);
    Layer::new(alpha * extinction, (1.0 - alpha) * extinction, thickness).with_g(inversion.g())
}
