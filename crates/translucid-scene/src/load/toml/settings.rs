//! `[film]` and `[integrator]`.

use super::document::{Item, Setting};
use super::text::{number, quoted, word_of};
use crate::interval::WholeInterval;
use crate::{Film, FilterKind, Integrator, SceneError, SubsurfaceMethod, ToneMapping};

const FILTERS: [(&str, FilterKind); 3] = [
    ("box", FilterKind::Box),
    ("gaussian", FilterKind::Gaussian),
    ("blackman-harris", FilterKind::BlackmanHarris),
];

/// Width and height.
pub(super) fn read_size(item: &Item<'_>) -> Result<[u32; 2], SceneError> {
    let size = item.array::<2>("whole numbers, width and height")?;
    Ok([size[0].count(Film::EDGE)?, size[1].count(Film::EDGE)?])
}

pub(super) const FILM: &[Setting<Film>] = &[
    Setting {
        key: "size",
        read: |item, film| read_size(item).map(|size| [film.width, film.height] = size),
        write: |film| format!("[{}, {}]", film.width, film.height),
    },
    Setting {
        key: "filter",
        read: |item, film| {
            film.filter = item.word(&FILTERS)?;
            if film.filter == FilterKind::Box {
                film.filter_radius = 0.5; // One pixel; that of the bells is their usual extent.
            }
            Ok(())
        },
        write: |film| quoted(word_of(&FILTERS, film.filter)),
    },
    Setting {
        key: "filter_radius",
        read: |item, film| item.number(Film::FILTER_RADIUS).map(|x| film.filter_radius = x),
        write: |film| number(film.filter_radius),
    },
    Setting {
        key: "exposure",
        read: |item, film| item.number(Film::EXPOSURE).map(|x| film.exposure = x),
        write: |film| number(film.exposure),
    },
    Setting {
        key: "tone_mapping",
        read: |item, film| item.word(&ToneMapping::WORDS).map(|word| film.tone_mapping = word),
        write: |film| quoted(word_of(&ToneMapping::WORDS, film.tone_mapping)),
    },
];

pub(super) const INTEGRATOR: &[Setting<Integrator>] = &[
    Setting {
        key: "samples_per_pixel",
        read: |item, to| item.count(Integrator::SAMPLES).map(|n| to.samples_per_pixel = n),
        write: |of| of.samples_per_pixel.to_string(),
    },
    Setting {
        key: "max_depth",
        read: |item, to| item.count(Integrator::DEPTH).map(|n| to.max_depth = n),
        write: |of| of.max_depth.to_string(),
    },
    Setting {
        key: "max_diffuse_depth",
        read: |item, to| item.count(Integrator::DIFFUSE_DEPTH).map(|n| to.max_diffuse_depth = n),
        write: |of| of.max_diffuse_depth.to_string(),
    },
    Setting {
        key: "caustics",
        read: |item, to| item.boolean().map(|is_on| to.caustics = is_on),
        write: |of| of.caustics.to_string(),
    },
    Setting {
        key: "subsurface_tail",
        read: |item, to| item.number(Integrator::TAIL).map(|x| to.subsurface_tail = x),
        write: |of| number(of.subsurface_tail),
    },
    Setting {
        key: "subsurface_method",
        read: |item, to| item.word(&SubsurfaceMethod::WORDS).map(|word| to.subsurface_method = word),
        write: |of| quoted(of.subsurface_method.name()),
    },
    Setting {
        key: "subsurface_sharing",
        read: |item, to| item.boolean().map(|is_on| to.subsurface_sharing = is_on),
        write: |of| of.subsurface_sharing.to_string(),
    },
    Setting {
        key: "point_tolerance",
        read: |item, to| item.number(Integrator::TOLERANCE).map(|x| to.point_tolerance = x),
        write: |of| number(of.point_tolerance),
    },
    Setting {
        key: "point_memory",
        read: |item, to| item.count(Integrator::MEMORY).map(|n| to.point_memory = n),
        write: |of| of.point_memory.to_string(),
    },
    Setting {
        key: "seed",
        read: |item, to| item.integer(WholeInterval::new(0, u64::MAX)).map(|n| to.seed = n),
        write: |of| of.seed.to_string(),
    },
];
