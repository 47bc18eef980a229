//! Materials and textures as numbers. Whole numbers are stated as floating-point ones, which hold them exactly.

use std::sync::Arc;

use glam::Vec3;
use translucid_scene::{
    Light, Material, ScalarInput, Scene, SceneError, SubsurfaceNormalization, TextureFilter, TextureRef,
    WalkSurface, Wrap,
};

use super::material_words::PlacedMaterial;
use crate::render::PreparedScene;
use crate::subsurface::transport::probes::Probes;
use crate::surface::WalkMedium;

/// Words of a texture: image, width, height, wrap modes, mapping by columns, whether the nearest pixel counts.
pub(super) const TEXTURE_WORDS: usize = 12;
/// Intervals of a table over the surface albedo.
pub(super) const ALBEDOS: usize = 1024;

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
        reflectances_at: usize,
    ) -> Result<(), SceneError> {
        let material = &self.scene.materials[index];
        let (world, transports) = prepared.parts();
        let transport = transports.of(index);
        let (mut below_at, mut pairing_at, mut smooth_at) = (0, 0, 0);
        if let Some(medium) = transport.medium() {
            let is_refracting = medium.surface == WalkSurface::Clear && medium.eta > 1.0;
            if is_refracting && self.scene.lights.iter().any(has_no_size) {
                let what = "a walk below a refracting boundary, lit by a light without size";
                let message = format!("material {} has {what}, which devices lack", material.name);
                return Err(SceneError::new(message));
            }
            below_at = self.place_of(Arc::as_ptr(medium).cast(), || medium_tables(medium));
        } else if let Some(probes) = transport.probes() {
            (below_at, pairing_at) = self.profile(probes);
            let is_normalized = material.subsurface_normalization != SubsurfaceNormalization::None;
            let normalizer = transports.normalizer().filter(|_| is_normalized);
            if let Some(smooth) = normalizer.and_then(|normalizer| normalizer.gatherer().profile(index)) {
                smooth_at = self.place_of(Arc::as_ptr(smooth).cast(), || smooth.words());
            }
        }
        let placed = PlacedMaterial {
            material,
            index,
            world,
            transport,
            below_at,
            pairing_at,
            smooth_at,
            reflectances_at,
        };
        let words = placed.words(&mut |texture| self.texture(texture));
        self.words.extend(words);
        Ok(())
    }

    /// Where the kernel of a profile begins, and the pairing of exits and entries (0 where exits count alone).
    fn profile(&mut self, probes: &Probes) -> (usize, usize) {
        let words = || probes.kernel.words(probes.cutting.tail(), probes.axes);
        let at = self.place_of(Arc::as_ptr(&probes.kernel).cast(), words);
        // Never 0: the kernel is in front of it
        let pairing_at = probes.pairing.as_ref().map_or(0, |pairing| {
            let at = self.medium_tables.len();
            self.medium_tables.extend(pairing.words(&probes.kernel));
            at
        });
        (at, pairing_at)
    }

    /// The number of a texture.
    fn texture(&mut self, texture: &TextureRef) -> usize {
        let image = &self.scene.images[texture.image];
        let wrap = texture.wrap.map(|wrap| match wrap {
            Wrap::Repeat => 0.0,
            Wrap::Mirror => 1.0,
            Wrap::Clamp => 2.0,
        });
        let size = [image.width, image.height].map(|edge| edge as f32);
        let index = self.textures.len() / TEXTURE_WORDS;
        self.textures.push(texture.image as f32);
        self.textures.extend(size.into_iter().chain(wrap));
        self.textures.extend(texture.image_from_uv.to_cols_array());
        self.textures.push(f32::from(u8::from(texture.filter == TextureFilter::Nearest)));
        index
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

/// Returns `true` if a material's emission is not the same everywhere, or only where its surface is.
pub(super) fn has_varied_emission(material: &Material) -> bool {
    let ScalarInput { factor, texture } = &material.geometry_opacity;
    let color = &material.emission_color;
    material.emission_luminance > 0.0
        && (color.texture.is_some() || color.vertex_color || texture.is_some() || *factor < 1.0)
}
