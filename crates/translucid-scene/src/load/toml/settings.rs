//! `[film]` and `[integrator]`.

use super::document::Key;
use crate::interval::WholeInterval;
use crate::{Film, FilterKind, Integrator, SubsurfaceMethod, ToneMapping};

const FILTERS: [(&str, FilterKind); 3] = [
    ("box", FilterKind::Box),
    ("gaussian", FilterKind::Gaussian),
    ("blackman-harris", FilterKind::BlackmanHarris),
];

pub(super) const FILM: &[Key<Film>] = &[
    ("size", |item, film| {
        let size = item.array::<2>("whole numbers, width and height")?;
        film.width = size[0].count(Film::EDGE)?;
        film.height = size[1].count(Film::EDGE)?;
        Ok(())
    }),
    ("filter", |item, film| {
        film.filter = item.word(&FILTERS)?;
        if film.filter == FilterKind::Box {
            film.filter_radius = 0.5; // One pixel; that of the bells is their usual extent.
        }
        Ok(())
    }),
    ("filter_radius", |item, film| item.number(Film::FILTER_RADIUS).map(|x| film.filter_radius = x)),
    ("exposure", |item, film| item.number(Film::EXPOSURE).map(|x| film.exposure = x)),
    ("tone_mapping", |item, film| item.word(&ToneMapping::WORDS).map(|word| film.tone_mapping = word)),
];

pub(super) const INTEGRATOR: &[Key<Integrator>] = &[
    ("samples_per_pixel", |item, to| item.count(Integrator::SAMPLES).map(|n| to.samples_per_pixel = n)),
    ("max_depth", |item, to| item.count(Integrator::DEPTH).map(|n| to.max_depth = n)),
    ("max_diffuse_depth", |item, to| item.count(Integrator::DIFFUSE_DEPTH).map(|n| to.max_diffuse_depth = n)),
    ("caustics", |item, to| item.boolean().map(|is_on| to.caustics = is_on)),
    ("subsurface_tail", |item, to| item.number(Integrator::TAIL).map(|x| to.subsurface_tail = x)),
    ("subsurface_method", |item, to| {
        item.word(&SubsurfaceMethod::WORDS).map(|word| to.subsurface_method = word)
    }),
    ("subsurface_sharing", |item, to| item.boolean().map(|is_on| to.subsurface_sharing = is_on)),
    ("point_tolerance", |item, to| item.number(Integrator::TOLERANCE).map(|x| to.point_tolerance = x)),
    ("point_memory", |item, to| item.count(Integrator::MEMORY).map(|n| to.point_memory = n)),
    ("seed", |item, to| item.integer(WholeInterval::new(0, u64::MAX)).map(|n| to.seed = n)),
];
