//! The models of the transport under a surface.

use translucid_profile::Model;

/// Model of the light under the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SubsurfaceModel {
    /// None is named: [`Material::model`](crate::Material::model) chooses.
    #[default]
    Default,
    /// A reflectance profile.
    Profile(Model),
    /// The profile of a file: index into [`Scene::profile_tables`](crate::Scene::profile_tables).
    Tabulated(usize),
    /// The profile of the material's layers on its medium, as they are solved exactly for diffuse light.
    Layers,
    /// No profile: a walk through the volume, scattering event by scattering event, between surfaces of a kind.
    RandomWalk(WalkSurface),
    /// No transport under the surface: `subsurface_color` becomes a Lambertian color.
    None,
}

/// The surface at which random walks begin and end: what it does to the direction of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WalkSurface {
    /// Light keeps its direction, or is refracted where `subsurface_eta` is above 1: the boundary of the volume itself.
    Clear,
    /// Light enters and leaves in all directions as through a diffuse surface, whichever way it came: the configuration that
    /// profiles for diffuse light are made for.
    Diffuse,
    /// Light enters as through a diffuse surface; the view is refracted by facets of `specular_roughness` and the index
    /// `subsurface_eta`, without a loss, as production renderers have it.
    Rough,
    /// Light enters as through a diffuse surface; one half of the view is refracted by facets of roughness 1 and the index
    /// `subsurface_eta`, the other goes on in all directions, as Blender Cycles has it for skin.
    Skin,
}

impl WalkSurface {
    /// All kinds.
    pub const ALL: [Self; 4] = [Self::Clear, Self::Diffuse, Self::Rough, Self::Skin];

    /// Name of the walk between such surfaces.
    pub const fn name_of_walk(self) -> &'static str {
        match self {
            Self::Clear => "random-walk",
            Self::Diffuse => "random-walk-diffuse",
            Self::Rough => "random-walk-rough",
            Self::Skin => "random-walk-skin",
        }
    }

    /// Description of the walk between such surfaces, in a line.
    const fn description_of_walk(self) -> &'static str {
        match self {
            Self::Clear => "No profile: a walk through the volume itself, for pictures only",
            Self::Diffuse => "A walk through the volume that begins and ends at a diffuse surface",
            Self::Rough => {
                "A walk that the view enters through rough facets and light through a diffuse surface"
            }
            Self::Skin => "The same where half of the view enters through a diffuse surface",
        }
    }
}

impl SubsurfaceModel {
    /// Every model that can be asked for by its name alone.
    pub const ALL: [Self; Model::ALL.len() + 7] = {
        let mut all = [Self::None; Model::ALL.len() + 7];
        let mut i = 0;
        while i < WalkSurface::ALL.len() {
            all[Model::ALL.len() + i] = Self::RandomWalk(WalkSurface::ALL[i]);
            i += 1;
        }
        i = 0;
        while i < Model::ALL.len() {
            all[i] = Self::Profile(Model::ALL[i]);
            i += 1;
        }
        all[Model::ALL.len() + 5] = Self::Default;
        all[Model::ALL.len() + 6] = Self::Layers;
        all
    };

    /// The model's name as scene files and the command line write it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Default => "default",
            Self::Profile(model) => model.name(),
            Self::Tabulated(_) => "tabulated",
            Self::Layers => "layers",
            Self::RandomWalk(surface) => surface.name_of_walk(),
            Self::None => "none",
        }
    }

    /// Description of the model, in a line.
    pub const fn description(self) -> &'static str {
        match self {
            Self::Default => {
                "random-walk (-rough if η > 1), or a profile where a scene asks for what walks do not do"
            }
            Self::Profile(model) => model.description(),
            Self::Tabulated(_) => "The profile of a file",
            Self::Layers => "The exact profile of a material's layers in diffuse light",
            Self::RandomWalk(surface) => surface.description_of_walk(),
            Self::None => "No light under the surface: a Lambertian color",
        }
    }

    /// The model of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|model| model.name() == name)
    }
}
