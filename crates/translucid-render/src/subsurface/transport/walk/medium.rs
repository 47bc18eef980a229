//! What a walk goes through: the medium behind a material's surface albedo and length.

use glam::Vec3;
use translucid_profile::{AlbedoInversion, Configuration, ParameterError, Parameterization};
use translucid_scene::{Material, Scene, SubsurfaceModel};

use crate::light;

/// The media of a scene, one for each phase function, boundary and configuration.
#[derive(Default)]
pub(crate) struct WalkMedia {
    made: Vec<(Recipe, WalkMedium)>,
}

/// All that decides a medium for every surface albedo.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Recipe {
    g: f64,
    eta: f64,
    configuration: Configuration,
    parameterization: Parameterization,
}

/// The medium of any surface albedo.
pub(crate) struct WalkMedium {
    inversion: AlbedoInversion,
    parameterization: Parameterization,
    /// Mean cosine of the phase function.
    pub(crate) g: f32,
    /// Relative index of the boundary, 1 without one.
    pub(crate) eta: f32,
}

impl WalkMedium {
    /// Mean free path \[L\] of a channel whose material states the surface albedo A and a length.
    pub(crate) fn mfp(&self, albedo: f32, length: f32) -> f32 {
        self.inversion.mfp(f64::from(albedo), f64::from(length), self.parameterization) as f32
    }

    /// Single-scattering albedo α of each channel.
    pub(crate) fn single_scattering_albedo(&self, albedo: Vec3) -> Vec3 {
        let of = |a: f32| self.inversion.single_scattering_albedo(f64::from(a)) as f32;
        Vec3::new(of(albedo.x), of(albedo.y), of(albedo.z))
    }
}

impl WalkMedia {
    pub(crate) fn medium(&self, index: usize) -> &WalkMedium {
        &self.made[index].1
    }

    /// Finds or makes the media of a material, with a note on what it cannot be walked with.
    pub(crate) fn index(&mut self, material: &Material) -> Result<(usize, Option<String>), ParameterError> {
        let asked = [material.subsurface_scatter_anisotropy, material.subsurface_eta].map(f64::from);
        let within = |x: f64, range: std::ops::RangeInclusive<f64>| x.clamp(*range.start(), *range.end());
        let used = [within(asked[0], AlbedoInversion::G), within(asked[1], AlbedoInversion::ETA)];
        let names = ["subsurface_scatter_anisotropy", "subsurface_eta"];
        let changes: Vec<String> = (0..2)
            .filter(|i| asked[*i] != used[*i])
            .map(|i| format!("{} is {}, taken for {}", names[i], asked[i] as f32, used[i] as f32))
            .collect();
        let note = (!changes.is_empty()).then(|| {
            let changes = changes.join("; ");
            format!("material {}: random-walk does not reach so far: {changes}", material.name)
        });
        let [g, eta] = used;
        let recipe = Recipe {
            g,
            eta,
            configuration: material.subsurface_configuration,
            parameterization: material.subsurface_parameter,
        };
        if let Some(index) = self.made.iter().position(|(known, _)| *known == recipe) {
            return Ok((index, note));
        }
        let inversion = AlbedoInversion::new(g, eta, recipe.configuration)?;
        let parameterization = recipe.parameterization;
        self.made.push((recipe, WalkMedium { inversion, parameterization, g: g as f32, eta: eta as f32 }));
        Ok((self.made.len() - 1, note))
    }

    /// A word on lights that no walk can find: those without a size, through a boundary that refracts.
    pub(crate) fn note_of_lights(scene: &Scene) -> Option<String> {
        let refracts = |m: &&Material| {
            let walks = m.subsurface_model == SubsurfaceModel::RandomWalk && m.subsurface_weight.factor > 0.0;
            walks && m.subsurface_eta > 1.0
        };
        let mut kinds: Vec<&str> = scene.lights.iter().filter_map(light::kind_without_size).collect();
        kinds.sort_unstable();
        kinds.dedup();
        let names: Vec<&str> = scene.materials.iter().filter(refracts).map(|m| m.name.as_str()).collect();
        (!kinds.is_empty() && !names.is_empty()).then(|| {
            format!(
                "material {}: random-walk under a boundary (subsurface_eta above 1) meets lights by chance, and never those without a size: {} lights do not shine into it; give them a size, or set subsurface_eta = 1",
                names.join(", "),
                kinds.join(", ")
            )
        })
    }
}
