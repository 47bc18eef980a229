//! Options of a known shape.

use std::path::PathBuf;

use clap::Args;

use crate::model::ModelName;
use crate::render;

/// Options of the scene whose picture the photograph is.
#[derive(Args, Debug)]
pub(super) struct SceneArguments {
    /// Scene file with the shape, camera and lights of the photograph
    #[arg(long, value_name = "SCENE", requires = "fit", conflicts_with_all = ["mm_per_pixel", "white", "surface_albedo",
        "edge", "configuration", "ruler", "card", "exposure", "dark", "page", "setup", "center", "white_photo", "incidence", "thickness"])]
    pub(super) scene: Option<PathBuf>,
    /// Parameters to find: material.surface_albedo, material.mfp, material.g, light.radiance
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', requires = "scene")]
    pub(super) fit: Vec<String>,
    /// Name of the material to fit [default: the scene's translucent one]
    #[arg(long, value_name = "NAME", requires = "scene")]
    pub(super) material: Option<String>,
    /// Model of subsurface scattering, in place of the scene's
    #[arg(long, value_name = "MODEL", requires = "scene", hide_possible_values = true)]
    pub(super) subsurface: Option<ModelName>,
    /// Mesh file for object NAME, or for the only one
    #[arg(long, value_name = "[NAME=]PATH", value_parser = render::parse_mesh, requires = "scene")]
    pub(super) mesh: Vec<(Option<String>, PathBuf)>,
    /// Samples per pixel of each picture [default: the scene's]
    #[arg(long, value_name = "N", requires = "scene",
        value_parser = clap::value_parser!(u32).range(1..=i64::from(render::MAX_SAMPLES)))]
    pub(super) spp: Option<u32>,
    /// Seed of the random numbers [default: 0]
    #[arg(long, value_name = "S", requires = "scene")]
    pub(super) seed: Option<u64>,
    /// Threads to render with [default: one per processor]
    #[arg(long, value_name = "N", requires = "scene", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) threads: Option<u16>,
    /// File that keeps an unfinished fit [default: PHOTO.fit in the current directory]
    #[arg(long, value_name = "FILE", requires = "scene")]
    pub(super) checkpoint: Option<PathBuf>,
    /// Continue an unfinished fit
    #[arg(long, requires = "scene")]
    pub(super) resume: bool,
}
