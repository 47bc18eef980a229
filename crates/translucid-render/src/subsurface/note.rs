//! Notes for the user on parts of a scene that are not rendered as it asks.

use std::fmt;

use translucid_scene::{Material, Scene};

/// A way in which something is not rendered as the scene asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum NoteKind {
    /// The model's profile cannot be made: `normalized-diffusion` stands in for it.
    StandIn,
    /// g or η are beyond the model's range: the nearest values in it are used.
    NearestParameters,
    /// The model does not reach the greatest surface albedos: its shape at the greatest stands in there.
    AlbedoLimit,
    /// The model is noisy at so small a relative index of refraction.
    NoisyBoundary,
    /// Points hold the mean over all directions of light.
    MeanOverDirections,
    /// Keys of the scene are about a profile, but a random walk has none.
    NoProfile,
    /// Profiles are not normalized by the shape.
    NoNormalization,
    /// Light leaves too near where it enters for the rounding errors of positions so far from the scene's origin.
    Unresolved,
    /// Layers of a body of several meshes follow surfaces inside it.
    LayersInside,
    /// A lamp or the camera is inside a translucent body.
    Enclosed,
    /// Faces inside a translucent body's closed surface are left out.
    InnerPieces,
    /// A translucent body and glass have their surfaces at the same place.
    Touching,
}

/// Kind and words of a note on a material.
pub(super) type Remark = (NoteKind, String);

/// A note on something that is not rendered as the scene asks for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// Its kind.
    pub kind: NoteKind,
    /// Name of the material that it is about, if it is one material's.
    pub material: Option<String>,
    /// The substitution that was made, and a way to avoid it.
    pub message: String,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.material.as_ref().map_or(Ok(()), |material| write!(f, "material {material}: "))?;
        f.write_str(&self.message)
    }
}

impl Note {
    /// A remark if keys of a walk's material are about profiles.
    pub(crate) fn of_walk(scene: &Scene, material: &Material) -> Option<Remark> {
        let keys = material.keys_of_profiles(&scene.integrator);
        let model = material.model(&scene.integrator).name();
        let words = || format!("{model} has no profile: {} does not concern it", keys.join(", "));
        (!keys.is_empty()).then(|| (NoteKind::NoProfile, words()))
    }

    /// A remark if the model uses another g or η than the material states.
    pub(crate) fn of_nearest(material: &Material, model: &str, used: [f64; 2]) -> Option<Remark> {
        let stated = [material.subsurface_scatter_anisotropy, material.subsurface_eta];
        let names = ["subsurface_scatter_anisotropy", "subsurface_eta"];
        let changes: Vec<String> = (0..2)
            .filter(|&i| f64::from(stated[i]) != used[i])
            .map(|i| format!("{} is {}, taken for {}", names[i], stated[i], used[i] as f32))
            .collect();
        let words = || format!("{model} does not reach so far: {}", changes.join("; "));
        (!changes.is_empty()).then(|| (NoteKind::NearestParameters, words()))
    }
}
