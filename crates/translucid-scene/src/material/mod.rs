//! Surface material with the parameter names of OpenPBR Surface 1.1.

mod parameters;
mod preset;
mod subsurface_layer;
mod subsurface_model;

use glam::Vec3;
use translucid_profile::Model;
pub use translucid_profile::{Configuration, Parameterization as SubsurfaceParameter};

use crate::{ColorInput, Integrator, NormalMap, ScalarInput, SubsurfaceMethod};

pub use subsurface_layer::{LayerMedium, SubsurfaceLayer};
pub use subsurface_model::{SubsurfaceModel, WalkSurface};

/// Point whose surface albedo and mean free path count where a texture gives the exit point and the entry point
/// different ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SubsurfaceTextureAt {
    /// The parameters at the exit point x_o, where light leaves.
    #[default]
    Exit,
    /// The parameters at the entry point x_i, where light enters.
    Entry,
    /// The geometric means of both points: light goes both ways alike.
    Both,
}

/// Treatment of the share of a profile for which a thin or curved thing has no surface, or has it twice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SubsurfaceNormalization {
    /// The profile is that of a half space, whatever the shape.
    #[default]
    None,
    /// Light that leaves at a point is divided by the share of the profile that the surface around it has, so that even
    /// light returns the surface albedo from any shape.
    Energy,
}

/// Visibility of a surface to the camera. All other rays meet it as it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CameraVisibility {
    /// The surface.
    #[default]
    Surface,
    /// The shadows on it alone: black, covering as much as the share of light that others keep from it.
    Shadow,
    /// Nothing.
    None,
}

/// A surface: weights and roughnesses in [0, 1], colors ≥ 0, indices of refraction in [1, 4].
///
/// Layers from outside in: opacity, coat, then by `base_metalness` a metal or a dielectric; under the
/// dielectric's specular reflection by `transmission_weight` clear transmission, else by
/// `subsurface_weight` subsurface scattering, else diffuse reflection.
/// Textured values are clamped to their ranges where they are evaluated.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name for messages.
    pub name: String,
    /// Factor on `base_color`.
    pub base_weight: f32,
    /// Diffuse albedo, or the metal's reflectance at normal incidence.
    pub base_color: ColorInput,
    /// Dielectric 0 … metal 1.
    pub base_metalness: ScalarInput,
    /// Strength of the specular reflection (scales F₀); 0 removes the interface.
    pub specular_weight: ScalarInput,
    /// Tint of the specular reflection.
    pub specular_color: ColorInput,
    /// Perceptual roughness; the GGX width is its square.
    pub specular_roughness: ScalarInput,
    /// Index of refraction of the dielectric.
    pub specular_ior: f32,
    /// Fraction of the dielectric base that is clear.
    pub transmission_weight: ScalarInput,
    /// Color after `transmission_depth`, or the tint of each crossing where that is 0.
    pub transmission_color: ColorInput,
    /// Depth at which `transmission_color` is reached \[L\]; 0: tint at the surface.
    pub transmission_depth: f32,
    /// Tint of each crossing where `transmission_color` is that of a depth; no parameter of OpenPBR.
    pub transmission_tint: ColorInput,
    /// Fraction of the dielectric base that scatters light under the surface.
    pub subsurface_weight: ScalarInput,
    /// Surface albedo A of the medium: the share of the light that enters which leaves again, not counting what the
    /// interface reflects.
    #[doc(alias = "surface_albedo")]
    #[doc(alias = "albedo")]
    #[doc(alias = "diffuse_reflectance")]
    pub subsurface_color: ColorInput,
    /// Mean free path (or diffuse mean free path, see `subsurface_parameter`) \[L\], ≥ 0.
    pub subsurface_radius: ScalarInput,
    /// Factor on `subsurface_radius` for each channel.
    pub subsurface_radius_scale: ColorInput,
    /// Mean cosine of the phase function, in (−1, 1).
    pub subsurface_scatter_anisotropy: f32,
    /// Layers of other media that follow the surface, from there inwards: the distance to it decides which medium a point
    /// is in. The medium of the parameters above lies behind them, and the boundary has one index.
    pub layers: Vec<SubsurfaceLayer>,
    /// Model of the transport under the surface, as it is named: see [`Material::model`].
    pub subsurface_model: SubsurfaceModel,
    /// Meaning of `subsurface_radius`.
    pub subsurface_parameter: SubsurfaceParameter,
    /// How light enters the medium in the profile's model.
    pub subsurface_configuration: Configuration,
    /// Relative index of refraction of the boundary in models that know one, in [0.5, 3]; 1 is index-matched.
    pub subsurface_eta: f32,
    /// Flights after which a random walk is given up, a whole number in [2, 65536].
    pub subsurface_flights: f32,
    /// Whose textured albedo and mean free path count.
    pub subsurface_texture_at: SubsurfaceTextureAt,
    /// Whether the shape counts in how much light a profile returns.
    pub subsurface_normalization: SubsurfaceNormalization,
    /// Strength of the clear coat.
    pub coat_weight: ScalarInput,
    /// Tint of what lies under the coat.
    pub coat_color: ColorInput,
    /// Perceptual roughness of the coat.
    pub coat_roughness: ScalarInput,
    /// Index of refraction of the coat.
    pub coat_ior: f32,
    /// Factor on `emission_color`: emitted radiance.
    pub emission_luminance: f32,
    /// Color of the emission.
    pub emission_color: ColorInput,
    /// 0: the surface is not there; 1: it is.
    pub geometry_opacity: ScalarInput,
    /// Whether the surface is a sheet without an inside. Under its interface clear transmission then goes straight on, and
    /// subsurface scattering is diffuse reflection and transmission.
    pub geometry_thin_walled: bool,
    /// Normal map, if any.
    pub geometry_normal: Option<NormalMap>,
    /// What the camera sees of it.
    pub camera_visibility: CameraVisibility,
}

impl Default for Material {
    /// OpenPBR's defaults, but for `subsurface_configuration`: a surface is lit from all sides.
    fn default() -> Self {
        Self {
            name: String::from("default"),
            base_weight: 1.0,
            base_color: ColorInput::constant(Vec3::splat(0.8)),
            base_metalness: ScalarInput::constant(0.0),
            specular_weight: ScalarInput::constant(1.0),
            specular_color: ColorInput::constant(Vec3::ONE),
            specular_roughness: ScalarInput::constant(0.3),
            specular_ior: 1.5,
            transmission_weight: ScalarInput::constant(0.0),
            transmission_color: ColorInput::constant(Vec3::ONE),
            transmission_depth: 0.0,
            transmission_tint: ColorInput::constant(Vec3::ONE),
            subsurface_weight: ScalarInput::constant(0.0),
            subsurface_color: ColorInput::constant(Vec3::splat(0.8)),
            subsurface_radius: ScalarInput::constant(1.0),
            subsurface_radius_scale: ColorInput::constant(Vec3::new(1.0, 0.5, 0.25)),
            subsurface_scatter_anisotropy: 0.0,
            subsurface_model: SubsurfaceModel::default(),
            subsurface_parameter: SubsurfaceParameter::Mfp,
            subsurface_configuration: Configuration::Diffuse,
            subsurface_eta: 1.0,
            subsurface_flights: 65536.0,
            layers: Vec::new(),
            subsurface_texture_at: SubsurfaceTextureAt::Exit,
            subsurface_normalization: SubsurfaceNormalization::None,
            coat_weight: ScalarInput::constant(0.0),
            coat_color: ColorInput::constant(Vec3::ONE),
            coat_roughness: ScalarInput::constant(0.0),
            coat_ior: 1.6,
            emission_luminance: 0.0,
            emission_color: ColorInput::constant(Vec3::ONE),
            geometry_opacity: ScalarInput::constant(1.0),
            geometry_thin_walled: false,
            geometry_normal: None,
            camera_visibility: CameraVisibility::Surface,
        }
    }
}

impl Material {
    /// Returns `true` if light travels below the surface.
    pub fn has_subsurface(&self) -> bool {
        self.subsurface_weight.factor > 0.0 && !self.geometry_thin_walled
    }

    /// The color by which clear light is multiplied where it crosses the surface.
    pub fn crossing_tint(&self) -> &ColorInput {
        let is_tint_below = self.transmission_depth > 0.0 && !self.geometry_thin_walled;
        if is_tint_below { &self.transmission_tint } else { &self.transmission_color }
    }

    /// The model of the transport under the surface: the one that is named; where none is, the walk, which makes the better
    /// picture in the same time, but a profile where walks cannot do what is asked for. Layers are walked through unless
    /// their profile is named.
    ///
    /// Where η is above 1, the walk is that between rough surfaces: in most scenes its picture is nearer to the truth of a smooth
    /// boundary than one that is reflected inside is in the same time, or a profile's. Of the profiles, oblique light is solved
    /// for isotropic scattering without a boundary only; the refined one knows the rest.
    ///
    /// ```
    /// use translucid_scene::{Integrator, Material, SubsurfaceMethod};
    ///
    /// let (marble, probes) = (Material::default(), Integrator::default());
    /// assert_eq!(marble.model(&probes).name(), "random-walk");
    /// let points = Integrator { subsurface_method: SubsurfaceMethod::PointBased, ..probes };
    /// assert_eq!(marble.model(&points).name(), "normalized-diffusion-oblique");
    /// let glazed = Material { subsurface_eta: 1.4, ..marble };
    /// assert_eq!(glazed.model(&probes).name(), "random-walk-rough");
    /// assert_eq!(glazed.model(&points).name(), "normalized-diffusion-refined");
    /// ```
    pub fn model(&self, integrator: &Integrator) -> SubsurfaceModel {
        if self.subsurface_model != SubsurfaceModel::Default {
            return self.subsurface_model;
        }
        let is_matched = self.subsurface_eta == 1.0;
        // Walks take a lesser index for 1, and those between rough surfaces are for diffuse light
        let is_rough = self.subsurface_eta > 1.0;
        let is_diffuse = self.subsurface_configuration == Configuration::Diffuse;
        let is_for_walks = (!is_rough || is_diffuse) && self.keys_of_profiles(integrator).is_empty();
        if is_for_walks || !self.layers.is_empty() {
            return SubsurfaceModel::RandomWalk(if is_rough && is_diffuse {
                WalkSurface::Rough
            } else {
                WalkSurface::Clear
            });
        }
        let is_isotropic = self.subsurface_scatter_anisotropy == 0.0;
        SubsurfaceModel::Profile(if is_isotropic && is_matched {
            Model::NormalizedDiffusionOblique
        } else {
            Model::NormalizedDiffusionRefined
        })
    }

    /// What keeps the material from the profile of its layers, if something does, in words.
    pub fn fault_of_layered_profile(&self) -> Option<String> {
        let varies = |color: &ColorInput| color.texture.is_some() || color.vertex_color;
        let textured = [
            (varies(&self.subsurface_color), "subsurface_color"),
            (self.subsurface_radius.texture.is_some(), "subsurface_radius"),
            (varies(&self.subsurface_radius_scale), "subsurface_radius_scale"),
        ];
        if let Some((_, key)) = textured.into_iter().find(|(varies, _)| *varies) {
            return Some(format!("{key} varies from point to point"));
        }
        let is_diffuse = self.subsurface_configuration == Configuration::Diffuse;
        (!is_diffuse).then(|| {
            String::from("subsurface_configuration is \"searchlight\", and the profile that of diffuse light")
        })
    }

    /// The keys, with a value other than their default, that say something of profiles alone.
    pub fn keys_of_profiles(&self, integrator: &Integrator) -> Vec<&'static str> {
        let has_points = integrator.subsurface_method == SubsurfaceMethod::PointBased;
        let pairs = self.subsurface_texture_at != SubsurfaceTextureAt::Exit;
        let normalizes = self.subsurface_normalization != SubsurfaceNormalization::None;
        let keys = [
            (has_points, "subsurface_method = \"point-based\""),
            (pairs, "subsurface_texture_at"),
            (normalizes, "subsurface_normalization"),
        ];
        keys.into_iter().filter(|(is_set, _)| *is_set).map(|(_, key)| key).collect()
    }
}
