//! `[film]` and `[integrator]`.

use translucid_scene::{
    Film, FilterKind, Integrator, SceneError, SubsurfaceMethod, ToneMapping, WholeInterval,
};

use super::document::{Item, Setting};
use super::text::{number, quoted, word_of};

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

/// A key that is a field of the same name: how it is read, and as what text it is written.
macro_rules! field {
    ($field:ident: $read:ident($($range:expr)?), |$value:ident| $text:expr) => {
        Setting {
            key: stringify!($field),
            read: |item, to| item.$read($($range)?).map(|value| to.$field = value),
            write: |of| {
                let $value = of.$field;
                $text
            },
        }
    };
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
    field!(filter_radius: number(Film::FILTER_RADIUS), |x| number(x)),
    field!(exposure: number(Film::EXPOSURE), |x| number(x)),
    field!(tone_mapping: word(&ToneMapping::WORDS), |word| quoted(word_of(&ToneMapping::WORDS, word))),
];

pub(super) const INTEGRATOR: &[Setting<Integrator>] = &[
    field!(samples_per_pixel: count(Integrator::SAMPLES), |n| n.to_string()),
    field!(max_depth: count(Integrator::DEPTH), |n| n.to_string()),
    field!(max_diffuse_depth: count(Integrator::DIFFUSE_DEPTH), |n| n.to_string()),
    field!(caustics: boolean(), |is_on| is_on.to_string()),
    field!(subsurface_tail: number(Integrator::TAIL), |x| number(x)),
    field!(subsurface_method: word(&SubsurfaceMethod::WORDS), |method| quoted(method.name())),
    field!(subsurface_sharing: boolean(), |is_on| is_on.to_string()),
    field!(point_tolerance: number(Integrator::TOLERANCE), |x| number(x)),
    field!(point_memory: count(Integrator::MEMORY), |n| n.to_string()),
    field!(seed: integer(WholeInterval::new(0, u64::MAX)), |n| n.to_string()),
];
