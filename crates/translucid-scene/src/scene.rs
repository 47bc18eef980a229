//! The whole scene: what a loader returns and a renderer takes.

use crate::{Camera, Environment, Film, Image, Integrator, Light, Material, Mesh, ProfileTable};

/// Length unit of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Millimeters.
    Millimeter,
    /// Centimeters.
    Centimeter,
    /// Meters.
    Meter,
}

impl Unit {
    /// Every unit by its name.
    pub(crate) const WORDS: [(&str, Self); 3] =
        [("mm", Self::Millimeter), ("cm", Self::Centimeter), ("m", Self::Meter)];

    /// The unit that scene files and the command line call `name`.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(word, _)| *word == name).map(|&(_, unit)| unit)
    }

    /// Millimeters in one unit.
    #[must_use]
    pub fn in_millimeters(self) -> f64 {
        match self {
            Self::Millimeter => 1.0,
            Self::Centimeter => 10.0,
            Self::Meter => 1000.0,
        }
    }

    /// The unit's abbreviation as scene files and the command line write it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Millimeter => "mm",
            Self::Centimeter => "cm",
            Self::Meter => "m",
        }
    }
}

/// A mesh with its material, in world space.
///
/// Loaders bake transforms into vertices (mirrored ones flip the winding, so that the geometric normal
/// still points out), and a mesh with several materials becomes several objects.
#[derive(Clone, Debug)]
pub struct Object {
    /// Name for messages and subsurface sets.
    pub name: String,
    /// Geometry in world space.
    pub mesh: Mesh,
    /// Index into [`Scene::materials`].
    pub material: usize,
    /// Objects with the same number share subsurface scattering: light may enter one and leave another.
    pub subsurface_group: u32,
}

/// Everything needed to make a picture.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Length unit of every number below.
    pub unit: Unit,
    /// The camera.
    pub camera: Camera,
    /// Image size, filter, exposure, tone mapping.
    pub film: Film,
    /// Samples per pixel and path limits.
    pub integrator: Integrator,
    /// Surfaces.
    pub objects: Vec<Object>,
    /// Materials that [`Object::material`] refers to.
    pub materials: Vec<Material>,
    /// Images that texture references and the environment refer to.
    pub images: Vec<Image>,
    /// Profiles that [`SubsurfaceModel::Tabulated`](crate::SubsurfaceModel::Tabulated) refers to.
    pub profile_tables: Vec<ProfileTable>,
    /// Lights other than emissive objects and the environment.
    pub lights: Vec<Light>,
    /// Light from infinity in all directions; `None` is black.
    pub environment: Option<Environment>,
}
