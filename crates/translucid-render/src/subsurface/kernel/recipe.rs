//! From a material to its kernel.

use translucid_profile::{
    AlbedoTable, AlbedoTableF32, Appearance, Configuration, DirectionalDipoleTable, Model,
    ObliqueDiffusionTable, ParameterError, Parameterization, Profile,
};
use translucid_scene::{Material, ProfileTable, SubsurfaceModel};

use super::layers::LayersRecipe;
use super::{Angular, SubsurfaceKernel};
use crate::subsurface::note::{Note, NoteKind, Remark};

/// Least surface albedo with a row in a table: darker profiles have its shape to within 1e-3.
const DARKEST: f64 = 1e-3;
/// Greatest surface albedo of a table over the diffuse mean free path, which does not exist at 1.
const BRIGHTEST_WITH_DMFP: f64 = 0.9999;

/// Below this the directional dipole's energy at grazing incidence is far from the surface albedo: without a change of
/// index it grows without end.
const LEAST_ETA_OF_DIRECTIONAL_DIPOLE: f64 = 1.1;

/// The inputs of a kernel: materials with equal recipes share one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum KernelRecipe {
    Model(ModelRecipe),
    /// The scene's profile table of this number.
    File(usize),
    Layers(LayersRecipe),
}

/// The inputs of a model's kernel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ModelRecipe {
    model: Model,
    parameterization: Parameterization,
    configuration: Configuration,
    eta: f64,
    /// Index of refraction for models that follow the direction of the refracted light.
    eta_of_refraction: f64,
    g: f64,
    /// The three surface albedos of a material that is not textured.
    surface_albedos: Option<[f64; 3]>,
}

impl KernelRecipe {
    /// The recipe of a material with a model; `None` where that is no profile.
    pub(crate) fn of(material: &Material, model: SubsurfaceModel) -> Option<Self> {
        match model {
            SubsurfaceModel::Profile(model) => Some(Self::Model(ModelRecipe::of(model, material))),
            SubsurfaceModel::Tabulated(index) => Some(Self::File(index)),
            SubsurfaceModel::Layers => Some(Self::Layers(LayersRecipe::of(material))),
            SubsurfaceModel::Default | SubsurfaceModel::None | SubsurfaceModel::RandomWalk(_) => None,
        }
    }

    /// Burley's index-matched profile with a material's parameters, which stands in for profiles that cannot be made.
    pub(crate) fn stand_in(material: &Material) -> Self {
        let model = Model::NormalizedDiffusion;
        Self::Model(ModelRecipe { g: 0.0, eta: 1.0, ..ModelRecipe::of(model, material) })
    }

    /// Tabulates the kernel. Takes milliseconds to tenths of a second.
    ///
    /// # Errors
    /// The model has no profile for these parameters, or the file's samples make none: in words.
    pub(crate) fn make(&self, files: &[ProfileTable]) -> Result<SubsurfaceKernel, String> {
        match self {
            Self::Model(recipe) => recipe.make().map_err(|error| error.to_string()),
            Self::File(index) => {
                let table = files[*index].table().map_err(|error| error.to_string())?;
                Ok(SubsurfaceKernel {
                    radial: AlbedoTableF32::from(&table),
                    brightest: 1.0,
                    has_any_shape: true,
                    own: None,
                    angular: Angular::Nothing,
                    notes: Vec::new(),
                })
            }
            Self::Layers(recipe) => recipe.make(),
        }
    }
}

/// The g and η that a material's model is used with.
fn nearest_known(model: Model, material: &Material) -> [f64; 2] {
    let Material { subsurface_scatter_anisotropy: g, subsurface_eta: eta, .. } = *material;
    model.nearest_known(f64::from(g), f64::from(eta))
}

/// A remark if a model is not fitted for the g and η that a material asks for.
pub(crate) fn unfitted(material: &Material, model: SubsurfaceModel) -> Option<Remark> {
    if model == SubsurfaceModel::Layers {
        return Note::of_nearest(material, model.name(), LayersRecipe::of(material).g_and_eta());
    }
    let SubsurfaceModel::Profile(model) = model else { return None };
    let used = nearest_known(model, material);
    model.knows_boundary().then(|| Note::of_nearest(material, model.name(), used))?
}

impl ModelRecipe {
    fn of(model: Model, material: &Material) -> Self {
        let color = &material.subsurface_color;
        let textured = color.texture.is_some() || color.vertex_color;
        let [g, eta] = nearest_known(model, material);
        let fraction = |a: f32| f64::from(a.clamp(0.0, 1.0));
        Self {
            model,
            parameterization: material.subsurface_parameter,
            configuration: material.subsurface_configuration,
            eta,
            eta_of_refraction: f64::from(material.subsurface_eta),
            g,
            surface_albedos: (!textured).then(|| color.factor.to_array().map(fraction)),
        }
    }

    fn make(&self) -> Result<SubsurfaceKernel, ParameterError> {
        let (table, most) = self.table()?;
        let wanted = self.surface_albedos.map_or(1.0, |albedos| albedos.into_iter().fold(0.0, f64::max));
        let is_noisy = self.model == Model::DirectionalDipole && self.eta < LEAST_ETA_OF_DIRECTIONAL_DIPOLE;
        let limit = || format!("reaches a surface albedo of {most:.4}; its shape there stands in above");
        let noisy = || {
            format!(
                "is noisy at subsurface_eta {}, and pale where light grazes; it is made for an index like 1.4",
                self.eta
            )
        };
        let limit = (most < wanted).then(|| (NoteKind::AlbedoLimit, limit()));
        let noisy = is_noisy.then(|| (NoteKind::NoisyBoundary, noisy()));
        Ok(SubsurfaceKernel {
            radial: AlbedoTableF32::from(&table),
            brightest: self.brightest() as f32,
            has_any_shape: false,
            own: None,
            angular: self.angular()?,
            notes: limit.into_iter().chain(noisy).collect(),
        })
    }

    fn angular(&self) -> Result<Angular, ParameterError> {
        let Self { parameterization, configuration, .. } = *self;
        Ok(match self.model {
            Model::DirectionalDipole => {
                Angular::Dipole(DirectionalDipoleTable::new(self.eta, self.g, parameterization)?)
            }
            Model::NormalizedDiffusionOblique => Angular::Oblique(ObliqueDiffusionTable::new(
                self.eta_of_refraction,
                parameterization,
                configuration,
            )?),
            _ => Angular::Nothing,
        })
    }

    fn profile(&self, surface_albedo: f64) -> Result<Box<dyn Profile>, ParameterError> {
        let Self { parameterization, g, .. } = *self;
        let appearance = Appearance { surface_albedo, length: 1.0, parameterization, g };
        self.model.profile(&appearance, self.configuration, self.eta)
    }

    /// Surface albedo whose shape stands in above it.
    fn brightest(&self) -> f64 {
        if self.parameterization == Parameterization::Dmfp { BRIGHTEST_WITH_DMFP } else { 1.0 }
    }

    /// The table, and the greatest surface albedo that the model reaches.
    fn table(&self) -> Result<(AlbedoTable, f64), ParameterError> {
        let brightest = self.brightest();
        let most = match self.profile(brightest) {
            Ok(_) => brightest,
            Err(error) => error.limit.unwrap_or(brightest),
        };
        let table = match self.surface_albedos {
            Some(albedos) => {
                let mut rows = albedos.map(|a| a.max(DARKEST).min(most)).to_vec();
                rows.sort_by(f64::total_cmp);
                rows.dedup();
                AlbedoTable::new(&rows, |a| self.profile(a))?
            }
            None => AlbedoTable::for_every_albedo(|a| self.profile(a.min(brightest)))?,
        };
        Ok((table, if most == brightest { 1.0 } else { most }))
    }
}
