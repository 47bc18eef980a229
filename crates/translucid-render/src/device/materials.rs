//! Materials and textures as numbers. Whole numbers are stated as floating-point ones, which hold them exactly.

use std::sync::Arc;

use glam::Vec3;
use translucid_scene::{
    CameraVisibility, ColorInput, Light, Material, ScalarInput, Scene, SceneError, SubsurfaceNormalization,
    TextureRef, WalkSurface, Wrap,
};

use crate::render::PreparedScene;
use crate::subsurface::transport::SubsurfaceTransport;
use crate::subsurface::transport::probes::Probes;
use crate::surface::{self, WalkMedium};

/// Words of a texture: image, width, height, wrap modes, mapping by columns.
pub(super) const TEXTURE_WORDS: usize = 11;
/// Number of a texture that is not there.
const NO_TEXTURE: f32 = -1.0;
/// Intervals of a table over the surface albedo.
const ALBEDOS: usize = 1024;

/// Words of an input: three factors, a texture, what of it counts.
const INPUT_WORDS: usize = 5;
/// Inputs of a material.
const INPUTS: usize = 17;

/// Numbers of materials, textures and media, which grow as materials are added.
pub(super) struct Materials<'a> {
    scene: &'a Scene,
    pub(super) words: Vec<f32>,
    pub(super) textures: Vec<f32>,
    /// Media, kernels and smooth profiles, with the place of their tables.
    known: Vec<(*const (), usize)>,
    /// Tables of what is below surfaces: of a medium for each surface albedo √(1 − α), and the mean free path of a length 1,
    /// then its shells; of anything else its words.
    pub(super) medium_tables: Vec<f32>,
}

impl<'a> Materials<'a> {
    /// Number of words of a material.
    pub(super) const WORDS: usize = 106;

    pub(super) fn new(scene: &'a Scene) -> Self {
        let (words, textures) = (Vec::new(), Vec::new());
        Self { scene, words, textures, known: Vec::new(), medium_tables: Vec::new() }
    }

    /// Adds a material whose reflectance tables begin at a place.
    ///
    /// # Errors
    /// It needs something that devices lack.
    pub(super) fn push(
        &mut self,
        prepared: &PreparedScene,
        index: usize,
        reflectance_at: usize,
    ) -> Result<(), SceneError> {
        let material = &self.scene.materials[index];
        let (world, transports) = prepared.parts();
        let lacks = |what: &str| {
            Err(SceneError::new(format!("material {} has {what}, which devices lack", material.name)))
        };
        let below = match transports.of(index) {
            SubsurfaceTransport::Lambertian => [0.0; 6],
            SubsurfaceTransport::Walk(walks)
                if walks.medium.surface == WalkSurface::Clear
                    && walks.medium.eta > 1.0
                    && self.scene.lights.iter().any(has_no_size) =>
            {
                return lacks("a walk below a refracting boundary, lit by a light without size");
            }
            SubsurfaceTransport::Walk(walks) => self.medium(&walks.medium),
            SubsurfaceTransport::Probes(probes) | SubsurfaceTransport::Shared(probes) => {
                let [kind, pairing, .., at] = self.profile(probes);
                let is_normalized = material.subsurface_normalization != SubsurfaceNormalization::None;
                let normalizer = transports.normalizer().filter(|_| is_normalized);
                let smooth = normalizer.and_then(|normalizer| normalizer.gatherer().profile(index));
                let smooth_at =
                    smooth.map_or(0, |smooth| self.place_of(Arc::as_ptr(smooth).cast(), || smooth.words()));
                [kind, pairing, number(smooth_at), 0.0, 0.0, at]
            }
        };
        let start = self.words.len();
        for input in [
            &material.base_color,
            &material.specular_color,
            &material.transmission_color,
            &material.subsurface_color,
            &material.subsurface_radius_scale,
            &material.coat_color,
            &material.emission_color,
        ] {
            self.color(input);
        }
        for input in [
            &material.base_metalness,
            &material.specular_weight,
            &material.specular_roughness,
            &material.transmission_weight,
            &material.subsurface_weight,
            &material.subsurface_radius,
            &material.coat_weight,
            &material.coat_roughness,
            &material.geometry_opacity,
        ] {
            self.scalar(input);
        }
        let map = material.geometry_normal.as_ref();
        let texture = map.map_or(NO_TEXTURE, |map| self.texture(&map.texture));
        self.words.extend([1.0, 1.0, 1.0, texture, 0.0]);
        debug_assert_eq!(self.words.len() - start, INPUTS * INPUT_WORDS);
        self.words.extend([
            material.base_weight,
            material.specular_ior,
            material.transmission_depth,
            material.subsurface_scatter_anisotropy,
            material.coat_ior,
            material.emission_luminance.max(0.0),
            number(material.geometry_thin_walled.into()),
            map.map_or(1.0, |map| map.scale),
            match material.camera_visibility {
                CameraVisibility::Surface => 0.0,
                CameraVisibility::None => 1.0,
                CameraVisibility::Shadow => 2.0,
            },
        ]);
        self.words.extend(below);
        self.words.push(number(reflectance_at));
        self.words.push(number(world.surfaces.lets_light_through(index).into()));
        self.words.push(number(world.media.of(index).is_some().into()));
        self.words.extend(surface::absorption(material).to_array());
        debug_assert_eq!(self.words.len() - start, Self::WORDS);
        Ok(())
    }

    /// A color as an input: 1 stands for vertex colors beside a texture's.
    fn color(&mut self, input: &ColorInput) {
        let texture = input.texture.as_ref().map_or(NO_TEXTURE, |texture| self.texture(texture));
        self.words.extend(input.factor.to_array());
        self.words.extend([texture, number(input.vertex_color.into())]);
    }

    /// A number as an input: 2 stands for a texture's first channel.
    fn scalar(&mut self, input: &ScalarInput) {
        let (texture, channel) = match &input.texture {
            Some((texture, channel)) => (self.texture(texture), *channel as usize),
            None => (NO_TEXTURE, 0),
        };
        self.words.extend([input.factor, input.factor, input.factor, texture, number(2 + channel)]);
    }

    /// The number of a texture.
    fn texture(&mut self, texture: &TextureRef) -> f32 {
        let image = &self.scene.images[texture.image];
        let wrap = texture.wrap.map(|wrap| match wrap {
            Wrap::Repeat => 0.0,
            Wrap::Mirror => 1.0,
            Wrap::Clamp => 2.0,
        });
        let size = [image.width, image.height].map(|edge| edge as f32);
        let index = self.textures.len() / TEXTURE_WORDS;
        self.textures.push(number(texture.image));
        self.textures.extend(size.into_iter().chain(wrap));
        self.textures.extend(texture.image_from_uv.to_cols_array());
        number(index)
    }

    /// Six words of what is below a surface: 1 for a medium, its surface, relative index, mean cosine, most flights, where its
    /// tables begin.
    fn medium(&mut self, medium: &Arc<WalkMedium>) -> [f32; 6] {
        let at = self.place_of(Arc::as_ptr(medium).cast(), || medium_tables(medium));
        let surface = match medium.surface {
            WalkSurface::Clear => 0.0,
            WalkSurface::Diffuse => 1.0,
            WalkSurface::Rough => 2.0,
            WalkSurface::Skin => 3.0,
        };
        let most = medium.most_flights as f32;
        [1.0, surface, medium.eta, medium.g, most, number(at)]
    }

    /// Six words of what is below a surface: 2 for a profile, where the pairing of exits and entries begins (0 where exits count
    /// alone), where the smooth profile begins by which shapes are normalized (0 for none), and where its kernel begins.
    fn profile(&mut self, probes: &Probes) -> [f32; 6] {
        let words = || probes.kernel.words(probes.cutting.tail(), probes.axes);
        let at = self.place_of(Arc::as_ptr(&probes.kernel).cast(), words);
        // Never 0: the kernel is in front of it
        let pairing_at = probes.pairing.as_ref().map_or(0, |pairing| {
            let at = self.medium_tables.len();
            self.medium_tables.extend(pairing.words(&probes.kernel));
            at
        });
        [2.0, number(pairing_at), 0.0, 0.0, 0.0, number(at)]
    }

    /// Where the tables of a medium or kernel begin, which are made where they are new.
    fn place_of(&mut self, of: *const (), make: impl FnOnce() -> Vec<f32>) -> usize {
        if let Some((_, at)) = self.known.iter().find(|(known, _)| *known == of) {
            return *at;
        }
        let at = self.medium_tables.len();
        self.known.push((of, at));
        self.medium_tables.extend(make());
        at
    }
}

fn medium_tables(medium: &WalkMedium) -> Vec<f32> {
    let albedo = |i: usize| Vec3::splat(i as f32 / ALBEDOS as f32);
    // Nearly linear in A, where α itself is not
    let root = |i| (1.0 - medium.single_scattering_albedo(albedo(i)).x).max(0.0).sqrt();
    let length = |i| medium.resolved(albedo(i), Vec3::ONE, 0.0).x;
    (0..=ALBEDOS).map(root).chain((0..=ALBEDOS).map(length)).chain(medium.shell_words()).collect()
}

/// Returns `true` if no path meets a light by chance.
fn has_no_size(light: &Light) -> bool {
    match *light {
        Light::Spot { radius, .. } => radius == 0.0,
        Light::Distant { angular_radius, .. } => angular_radius == 0.0,
        Light::Beam { .. } => true,
        Light::Rectangle { .. } | Light::Ellipse { .. } | Light::Sphere { .. } => false,
    }
}

/// The number as a floating-point one.
fn number(of: usize) -> f32 {
    of as f32
}

/// Returns `true` if a material's emission is not the same everywhere, or only where its surface is.
pub(super) fn has_varied_emission(material: &Material) -> bool {
    let ScalarInput { factor, texture } = &material.geometry_opacity;
    let color = &material.emission_color;
    material.emission_luminance > 0.0
        && (color.texture.is_some() || color.vertex_color || texture.is_some() || *factor < 1.0)
}
