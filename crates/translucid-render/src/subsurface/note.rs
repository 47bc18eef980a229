//! What a user should know of a scene as it was made ready.

use std::fmt;

use translucid_scene::{Light, Material, Scene, SubsurfaceModel};

use super::kernel::{KernelError, KernelNote, NearestParameter};
use super::transport::points::PointsError;
use crate::light;

/// Something that is not rendered as the scene asks for.
#[derive(Clone, Debug, PartialEq)]
pub enum Note {
    /// Of one material's subsurface model.
    Material {
        /// Name of the material.
        material: String,
        /// The model.
        model: SubsurfaceModel,
        /// What it does not do.
        note: MaterialNote,
    },
    /// Materials whose walks under a boundary never meet lights of these kinds.
    LightsWithoutSize {
        /// Names of the materials.
        materials: Vec<String>,
        /// Kinds of light.
        lights: Vec<&'static str>,
    },
    /// Shapes do not count in how much light profiles return.
    NoNormalization(PointsError),
}

/// Something that a material's subsurface model does not do as the material asks.
#[derive(Clone, Debug, PartialEq)]
pub enum MaterialNote {
    /// Parameters beyond what the model is fitted for.
    Nearest(Vec<NearestParameter>),
    /// The profile has limits.
    Kernel(KernelNote),
    /// The profile cannot be made: `normalized-diffusion` stands in for it.
    StandIn(KernelError),
    /// Points hold the mean over all directions of light.
    MeanOverDirections,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Material { material, model, note } => {
                let model = model.name();
                write!(f, "material {material}: ")?;
                match note {
                    MaterialNote::Nearest(changes) => {
                        let changes: Vec<String> = changes.iter().map(ToString::to_string).collect();
                        write!(f, "{model} does not reach so far: {}", changes.join("; "))
                    }
                    MaterialNote::Kernel(note) => write!(f, "{model} {note}"),
                    MaterialNote::StandIn(error) => {
                        write!(f, "{model}: {error}; normalized-diffusion stands in for it")
                    }
                    MaterialNote::MeanOverDirections => write!(
                        f,
                        "{model} follows the direction of light; points hold its mean over all directions"
                    ),
                }
            }
            Self::LightsWithoutSize { materials, lights } => write!(
                f,
                "material {}: random-walk under a boundary (subsurface_eta above 1) meets lights by chance, and never those without a size: {} lights do not shine into it; give them a size, or set subsurface_eta = 1",
                materials.join(", "),
                lights.join(", ")
            ),
            Self::NoNormalization(error) => write!(f, "subsurface_normalization is left out: {error}"),
        }
    }
}

impl Note {
    /// A note on lights that no walk can find: those without a size, through a boundary that refracts.
    pub(crate) fn of_lights(scene: &Scene) -> Option<Self> {
        let refracts = |m: &&Material| {
            let walks = m.subsurface_model == SubsurfaceModel::RandomWalk && m.subsurface_weight.factor > 0.0;
            walks && m.subsurface_eta > 1.0
        };
        let mut lights: Vec<&str> =
            scene.lights.iter().filter_map(|light: &Light| light::kind_without_size(light)).collect();
        lights.sort_unstable();
        lights.dedup();
        let materials: Vec<String> =
            scene.materials.iter().filter(refracts).map(|m| m.name.clone()).collect();
        (!lights.is_empty() && !materials.is_empty()).then_some(Self::LightsWithoutSize { materials, lights })
    }
}
