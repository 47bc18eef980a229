//! The tables of every material's profile, made before the first path.

use translucid_profile::{
    AlbedoTable, AlbedoTableF32, Appearance, Configuration, DirectionalDipoleTable, Model,
    ObliqueDiffusionTable, ParameterError, Parameterization, Profile,
};
use translucid_scene::{Material, ProfileTable, Scene, SubsurfaceModel};

use crate::subsurface::transport::walk::{WalkMedia, WalkMedium};

/// Least surface albedo that a table has a row for: the shapes of darker profiles are that one's to 1e-3.
const DARKEST: f64 = 1e-3;
/// Greatest surface albedo of a table over the diffuse mean free path, which does not exist at 1.
const BRIGHTEST_WITH_DMFP: f64 = 0.9999;

/// Below this the directional dipole's energy at grazing incidence is far from the surface albedo: without a change of
/// index it grows without end.
const LEAST_ETA_OF_DIRECTIONAL_DIPOLE: f64 = 1.1;

/// What the light under a material's surface is computed with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ProfileSource {
    /// Burley's closed form.
    NormalizedDiffusion,
    /// The table of this number.
    Table(usize),
    /// The directional dipole of this number, found by the table of its average.
    Directional {
        /// Number of the table.
        table: usize,
        /// Number of the dipole.
        dipole: usize,
    },
    /// Normalized diffusion of oblique light of this number, found by the table of its average.
    Oblique {
        /// Number of the table.
        table: usize,
        /// Number of the profiles of oblique light.
        oblique: usize,
    },
    /// None: the medium of this number is walked through.
    RandomWalk(usize),
}

impl ProfileSource {
    /// Number of the table that has the radial profile, if there is one.
    pub(crate) fn table(self) -> Option<usize> {
        match self {
            Self::NormalizedDiffusion | Self::RandomWalk(_) => None,
            Self::Table(table) | Self::Directional { table, .. } | Self::Oblique { table, .. } => Some(table),
        }
    }
}

/// The tables of a scene.
#[derive(Default)]
pub(crate) struct ProfileTables {
    /// What has been made from what.
    made: Vec<(Recipe, ProfileSource)>,
    tables: Vec<AlbedoTableF32>,
    /// For each table the surface albedo whose shape stands in above it.
    brightest: Vec<f32>,
    /// For each table whether a user has made it.
    is_from_file: Vec<bool>,
    dipoles: Vec<DirectionalDipoleTable>,
    obliques: Vec<ObliqueDiffusionTable>,
    media: WalkMedia,
    notes: Vec<String>,
}

/// All that decides a table.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Recipe {
    Model(ModelRecipe),
    /// The scene's profile table of this number.
    File(usize),
}

/// All that decides the table of a model.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ModelRecipe {
    model: Model,
    parameterization: Parameterization,
    configuration: Configuration,
    eta: f64,
    /// By which light is refracted that is then followed by its direction.
    eta_of_refraction: f64,
    g: f64,
    /// The three surface albedos of a material that is not textured.
    albedos: Option<[f64; 3]>,
}

impl ProfileTables {
    /// Number of tables.
    pub(crate) fn len(&self) -> usize {
        self.tables.len()
    }

    pub(crate) fn table(&self, index: usize) -> &AlbedoTableF32 {
        &self.tables[index]
    }

    /// Surface albedo whose shape stands in above it in a table: what follows the direction of light has to have that
    /// shape, too, or most of its light would leave where probes hardly look.
    pub(crate) fn brightest(&self, table: usize) -> f32 {
        self.brightest[table]
    }

    /// Whether a user has made the table of a profile: it may have any shape, holes included.
    pub(crate) fn is_from_file(&self, source: ProfileSource) -> bool {
        source.table().is_some_and(|table| self.is_from_file[table])
    }

    pub(crate) fn dipole(&self, index: usize) -> &DirectionalDipoleTable {
        &self.dipoles[index]
    }

    pub(crate) fn oblique(&self, index: usize) -> &ObliqueDiffusionTable {
        &self.obliques[index]
    }

    /// The medium that a walk of this number goes through.
    pub(crate) fn medium(&self, index: usize) -> &WalkMedium {
        self.media.medium(index)
    }

    /// Adds what a user should know of the scene's lights and walks.
    pub(crate) fn note_lights(&mut self, scene: &Scene) {
        self.notes.extend(WalkMedia::note_of_lights(scene));
    }

    /// What a user should know of the tables.
    pub(crate) fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Notes where points leave out what a material's model knows.
    pub(crate) fn note_of_points(&mut self, material: &Material, source: ProfileSource) {
        if matches!(source, ProfileSource::Directional { .. } | ProfileSource::Oblique { .. }) {
            let (name, model) = (&material.name, material.subsurface_model.name());
            self.notes.push(format!(
                "material {name}: {model} follows the direction of light; points hold its mean over all directions"
            ));
        }
    }

    pub(crate) fn add_note(&mut self, note: String) {
        self.notes.push(note);
    }

    /// Finds or makes what a material needs.
    pub(crate) fn source(&mut self, material: &Material, files: &[ProfileTable]) -> ProfileSource {
        if material.subsurface_model == SubsurfaceModel::RandomWalk {
            return self.walk(material);
        }
        self.notes.extend(note_of_nearest(material));
        let Some(recipe) = Recipe::of(material) else { return ProfileSource::NormalizedDiffusion };
        if let Some((_, source)) = self.made.iter().find(|(known, _)| *known == recipe) {
            return *source;
        }
        let made = match recipe {
            Recipe::Model(recipe) => self.source_of_model(&recipe, material).map_err(|e| e.to_string()),
            Recipe::File(index) => {
                files[index].table().map_err(|e| e.to_string()).map(|table| self.add(&table, 1.0, true))
            }
        };
        match made {
            Ok(source) => {
                self.made.push((recipe, source));
                source
            }
            Err(error) => {
                let (name, model) = (&material.name, material.subsurface_model.name());
                let note =
                    format!("material {name}: {model}: {error}; normalized-diffusion stands in for it");
                self.notes.push(note);
                ProfileSource::NormalizedDiffusion
            }
        }
    }

    fn walk(&mut self, material: &Material) -> ProfileSource {
        if material.subsurface_weight.factor <= 0.0 {
            return ProfileSource::NormalizedDiffusion;
        }
        match self.media.index(material) {
            Ok((index, note)) => {
                self.notes.extend(note);
                ProfileSource::RandomWalk(index)
            }
            Err(error) => {
                let name = &material.name;
                self.notes.push(format!(
                    "material {name}: random-walk: {error}; normalized-diffusion stands in for it"
                ));
                ProfileSource::NormalizedDiffusion
            }
        }
    }

    fn add(&mut self, table: &AlbedoTable, brightest: f64, is_from_file: bool) -> ProfileSource {
        self.tables.push(AlbedoTableF32::from(table));
        self.brightest.push(brightest as f32);
        self.is_from_file.push(is_from_file);
        ProfileSource::Table(self.tables.len() - 1)
    }

    fn source_of_model(
        &mut self,
        recipe: &ModelRecipe,
        material: &Material,
    ) -> Result<ProfileSource, ParameterError> {
        let (table, most) = recipe.table()?;
        let wanted = recipe.albedos.map_or(1.0, |albedos| albedos.into_iter().fold(0.0, f64::max));
        if most < wanted {
            let (name, model) = (&material.name, recipe.model);
            self.notes.push(format!(
                "material {name}: {model} reaches a surface albedo of {most:.4}; its shape there stands in above"
            ));
        }
        if recipe.model == Model::DirectionalDipole && recipe.eta < LEAST_ETA_OF_DIRECTIONAL_DIPOLE {
            self.notes.push(format!(
                "material {}: at subsurface_eta {} the directional dipole is noisy, and pale where light grazes; it is made for an index like 1.4",
                material.name, recipe.eta
            ));
        }
        let source = self.add(&table, recipe.brightest(), false);
        match source {
            ProfileSource::Table(table) if recipe.model == Model::DirectionalDipole => {
                let dipole = DirectionalDipoleTable::new(recipe.eta, recipe.g, recipe.parameterization)?;
                self.dipoles.push(dipole);
                Ok(ProfileSource::Directional { table, dipole: self.dipoles.len() - 1 })
            }
            ProfileSource::Table(table) if recipe.model == Model::NormalizedDiffusionOblique => {
                let ModelRecipe { eta_of_refraction, parameterization, configuration, .. } = *recipe;
                let oblique = ObliqueDiffusionTable::new(eta_of_refraction, parameterization, configuration)?;
                self.obliques.push(oblique);
                Ok(ProfileSource::Oblique { table, oblique: self.obliques.len() - 1 })
            }
            _ => Ok(source),
        }
    }
}

/// The g and η that a material's model is used with.
fn nearest_known(model: Model, material: &Material) -> [f64; 2] {
    let Material { subsurface_scatter_anisotropy: g, subsurface_eta: eta, .. } = *material;
    model.nearest_known(f64::from(g), f64::from(eta))
}

/// A word on a g or η that the model knows and is not fitted for.
fn note_of_nearest(material: &Material) -> Option<String> {
    let SubsurfaceModel::Profile(model) = material.subsurface_model else { return None };
    if material.subsurface_weight.factor <= 0.0 || !model.knows_boundary() {
        return None;
    }
    let asked = [material.subsurface_scatter_anisotropy, material.subsurface_eta];
    let used = nearest_known(model, material);
    let names = ["subsurface_scatter_anisotropy", "subsurface_eta"];
    let changed = (0..2).filter(|i| f64::from(asked[*i]) != used[*i]);
    let changes: Vec<String> =
        changed.map(|i| format!("{} is {}, taken for {}", names[i], asked[i], used[i])).collect();
    (!changes.is_empty())
        .then(|| format!("material {}: {model} is not fitted so far: {}", material.name, changes.join("; ")))
}

impl Recipe {
    /// `None` where no table is needed.
    fn of(material: &Material) -> Option<Self> {
        if material.subsurface_weight.factor <= 0.0 {
            return None;
        }
        match material.subsurface_model {
            SubsurfaceModel::None | SubsurfaceModel::RandomWalk => None,
            SubsurfaceModel::Profile(model) => {
                let recipe = ModelRecipe::of(model, material);
                let closed_form = model == Model::NormalizedDiffusion && recipe.g == 0.0 && recipe.eta == 1.0;
                (!closed_form).then_some(Self::Model(recipe))
            }
            SubsurfaceModel::Tabulated(index) => Some(Self::File(index)),
        }
    }
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
            albedos: (!textured).then(|| color.factor.to_array().map(fraction)),
        }
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
        let table = match self.albedos {
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
