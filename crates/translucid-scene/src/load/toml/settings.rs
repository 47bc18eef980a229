//! `[film]` and `[integrator]`.

use super::document::{Item, Table};
use crate::interval::WholeInterval;
use crate::{Film, FilterKind, Integrator, SceneError, SubsurfaceMethod, ToneMapping};

pub(super) const FILM_KEYS: &[&str] = &["size", "filter", "filter_radius", "exposure", "tone_mapping"];
pub(super) const INTEGRATOR_KEYS: &[&str] = &[
    "samples_per_pixel",
    "max_depth",
    "max_diffuse_depth",
    "caustics",
    "subsurface_tail",
    "subsurface_method",
    "subsurface_sharing",
    "point_tolerance",
    "point_memory",
    "seed",
];

const FILTERS: [(&str, FilterKind); 3] = [
    ("box", FilterKind::Box),
    ("gaussian", FilterKind::Gaussian),
    ("blackman-harris", FilterKind::BlackmanHarris),
];
const TONE_MAPPINGS: [(&str, ToneMapping); 3] =
    [("srgb", ToneMapping::Srgb), ("neutral", ToneMapping::Neutral), ("agx", ToneMapping::Agx)];

pub(super) fn read_film(table: &Table<'_>) -> Result<Film, SceneError> {
    let default = Film::default();
    let [width, height] = table.read("size", [default.width, default.height], read_size)?;
    let filter = table.read("filter", default.filter, |item| item.word(&FILTERS))?;
    Ok(Film {
        width,
        height,
        filter,
        filter_radius: table
            .read("filter_radius", usual_radius(filter), |item| item.number(Film::FILTER_RADIUS))?,
        exposure: table.read("exposure", default.exposure, |item| item.number(Film::EXPOSURE))?,
        tone_mapping: table.read("tone_mapping", default.tone_mapping, |item| item.word(&TONE_MAPPINGS))?,
    })
}

/// One pixel for the box; the usual extent for the bells.
fn usual_radius(filter: FilterKind) -> f32 {
    match filter {
        FilterKind::Box => 0.5,
        FilterKind::Gaussian | FilterKind::BlackmanHarris => Film::default().filter_radius,
    }
}

fn read_size(item: &Item<'_>) -> Result<[u32; 2], SceneError> {
    let mut size = [0; 2];
    for (extent, item) in size.iter_mut().zip(item.array::<2>("whole numbers, width and height")?) {
        *extent = item.integer(Film::EDGE)? as u32;
    }
    Ok(size)
}

pub(super) fn read_integrator(table: &Table<'_>) -> Result<Integrator, SceneError> {
    let default = Integrator::default();
    let count = |key, default: u32, range| {
        table.read(key, u64::from(default), |item| item.integer(range)).map(|n| n as u32)
    };
    Ok(Integrator {
        samples_per_pixel: count("samples_per_pixel", default.samples_per_pixel, Integrator::SAMPLES)?,
        max_depth: count("max_depth", default.max_depth, Integrator::DEPTH)?,
        max_diffuse_depth: count("max_diffuse_depth", default.max_diffuse_depth, Integrator::DIFFUSE_DEPTH)?,
        caustics: table.read("caustics", default.caustics, Item::boolean)?,
        subsurface_tail: table
            .read("subsurface_tail", default.subsurface_tail, |item| item.number(Integrator::TAIL))?,
        subsurface_method: table.read("subsurface_method", default.subsurface_method, |item| {
            item.word(&SubsurfaceMethod::WORDS)
        })?,
        subsurface_sharing: table.read("subsurface_sharing", default.subsurface_sharing, Item::boolean)?,
        point_tolerance: table
            .read("point_tolerance", default.point_tolerance, |item| item.number(Integrator::TOLERANCE))?,
        point_memory: count("point_memory", default.point_memory, Integrator::MEMORY)?,
        seed: table.read("seed", default.seed, |item| item.integer(WholeInterval::new(0, u64::MAX)))?,
    })
}
