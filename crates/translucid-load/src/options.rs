//! Wishes of the caller when a scene is loaded.

use std::path::PathBuf;
use std::sync::Arc;

use glam::Mat3;
use translucid_scene::description::hexadecimal_color;
use translucid_scene::{
    Camera, ColorSpace, Environment, Film, ImageKind, Scene, SceneError, SubsurfaceModel, Unit,
};

use super::image::read_image;
use super::loading::Loading;
use super::orientation::{Orientation, UpAxis};
use super::result::Result;
use super::watch::LoadWatch;
use crate::Viewpoint;
use crate::viewpoint::turned_about_target;

/// Wishes of the caller in place of the file's own values.
#[derive(Clone, Debug, Default)]
pub struct LoadOptions {
    /// Preset for a bare mesh, in place of the file's own materials.
    pub preset: Option<String>,
    /// Unit of a bare mesh's coordinates; by default m for glTF and mm otherwise.
    pub unit: Option<Unit>,
    /// Mesh files in place of those of a scene file's objects, by the object's name.
    /// Without a name it is the scene's only object with a mesh file.
    pub mesh_overrides: Vec<(Option<String>, PathBuf)>,
    /// Width and height in pixels, in place of the file's or the default.
    pub size: Option<[u32; 2]>,
    /// Model of the transport under all surfaces, in place of the materials' own.
    pub subsurface_model: Option<SubsurfaceModel>,
    /// Axis of a bare mesh that points up; by default y, or the axis across the flat underside of a mesh other than glTF.
    pub up: Option<UpAxis>,
    /// Angles about x, then y, then z by which the objects of a bare mesh are turned about their middle \[degrees\], once
    /// y is up.
    pub rotate: [f32; 3],
    /// Floor under a bare mesh; by default a backdrop where neither camera nor lights nor surroundings are given.
    pub floor: Option<Floor>,
    /// Name of the camera, of those that the file has; by default the first.
    pub camera: Option<String>,
    /// Viewpoint: for a bare mesh, of the camera that is made for it; for a scene file, an orbit about the camera's target.
    pub viewpoint: Option<Viewpoint>,
    /// Factor by which things are larger in the picture.
    pub zoom: Option<f32>,
    /// Angle by which what is seen has turned \[degrees\]: the objects of a bare mesh about the vertical line through their
    /// middle, with a camera from which they fit into the picture at any angle; in a scene file the camera goes about its
    /// target instead.
    pub turn: Option<f64>,
    /// Hears how far it is, and may end it.
    pub watch: LoadWatch,
    /// Changes of what is around the scene.
    pub surroundings: Surroundings,
}

/// The floor under a bare mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Floor {
    /// Nothing: around the mesh the picture is transparent, unless there is an environment to see.
    None,
    /// A dark sweep.
    Backdrop,
    /// A plane of which only the shadows on it are seen: around them the picture is transparent.
    Shadow,
    /// A sweep of this linear color.
    Color([f32; 3]),
}

impl Floor {
    /// The floor of a word: `none`, `backdrop`, `shadow`, or a color as `#rrggbb` in sRGB or a linear grey in [0, 1].
    ///
    /// ```
    /// use translucid_load::Floor;
    ///
    /// assert_eq!(Floor::from_text("#ffffff"), Some(Floor::Color([1.0; 3])));
    /// assert_eq!(Floor::from_text("0.18"), Some(Floor::Color([0.18; 3])));
    /// assert_eq!(Floor::from_text("1.8"), None);
    /// ```
    pub fn from_text(text: &str) -> Option<Self> {
        let grey = || text.parse().ok().filter(|grey| (0.0..=1.0).contains(grey)).map(|grey: f32| [grey; 3]);
        match text {
            "none" => Some(Self::None),
            "backdrop" => Some(Self::Backdrop),
            "shadow" => Some(Self::Shadow),
            _ => hexadecimal_color(text).or_else(grey).map(Self::Color),
        }
    }
}

/// Changes of the environment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surroundings {
    /// Latitude–longitude image in place of the environment, and of the lights of a scene that states none.
    pub file: Option<PathBuf>,
    /// Rotation about y \[degrees\].
    pub rotation: Option<f32>,
    /// Factor on the radiance.
    pub strength: Option<f32>,
}

impl Surroundings {
    /// Makes the changes.
    ///
    /// # Errors
    /// The image cannot be used, a number is out of range, or there is no environment to change.
    pub(super) fn apply(&self, scene: &mut Scene, loading: &mut Loading<'_>) -> Result<()> {
        if *self == Self::default() {
            return Ok(());
        }
        if let Some(path) = &self.file {
            let image = Some(scene.images.len());
            scene.images.push(Arc::new(read_image(path, ImageKind::Color(ColorSpace::Srgb), loading)?));
            scene.environment = Some(Environment { image, ..Environment::default() });
        }
        let Some(environment) = &mut scene.environment else {
            let error = SceneError::new("the scene has no environment that could be turned or made brighter");
            return Err(error.with_help("name the image of one"));
        };
        environment.radiance *= self.strength.unwrap_or(1.0);
        if let Some(rotation) = self.rotation {
            let turned = Mat3::from_rotation_y(rotation.to_radians());
            environment.world_from_environment = turned * environment.world_from_environment;
        }
        scene.validate_environment()
    }
}

impl LoadOptions {
    /// The film with the size that is asked for, kept within what a film may have.
    pub(super) fn film(&self, film: Film) -> Film {
        let [width, height] = self.size.unwrap_or([film.width, film.height]).map(|n| Film::EDGE.nearest(n));
        Film { width, height, ..film }
    }

    /// A scene's camera, moved about its target to where it is to look from.
    pub(super) fn moved(&self, camera: Camera) -> Camera {
        let seen = self.viewpoint.map_or(camera, |viewpoint| viewpoint.of_camera(&camera));
        self.turned(seen)
    }

    /// A scene's camera, carried about its target instead of what it sees.
    pub(super) fn turned(&self, camera: Camera) -> Camera {
        self.turn.map_or(camera, |degrees| turned_about_target(&camera, degrees))
    }

    /// The scene with the model and the zoom that are asked for, if it is valid.
    pub(super) fn finish(&self, mut scene: Scene) -> Result<Scene> {
        if let Some(model) = self.subsurface_model {
            scene.materials.iter_mut().for_each(|material| material.subsurface_model = model);
        }
        if let Some(zoom) = self.zoom {
            scene.camera = scene.camera.zoomed(zoom);
        }
        scene.validate()?;
        Ok(scene)
    }
}

impl Orientation {
    /// The loader's options with this in place of theirs.
    pub fn apply(self, options: LoadOptions) -> LoadOptions {
        LoadOptions { up: Some(self.up), rotate: self.rotate, ..options }
    }
}
