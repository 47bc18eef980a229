//! What methods of a session take: samples, layers, regions.

use std::ops::Range;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyRange, PyRangeMethods};
use translucid_render::FilmLayer;

use crate::arrays::Any;
use crate::names;
use crate::scene::whole_numbers;

/// Most samples per pixel.
pub(crate) const MOST_SAMPLES: u64 = 1 << 24;

/// The layer that a denoiser makes of the others.
pub(crate) const DENOISED: &str = "denoised";

/// The samples of a range of Python's.
pub(crate) fn sample_range(range: &Bound<'_, PyRange>) -> PyResult<Range<u32>> {
    let (start, end, step) = (range.start()?, range.stop()?, range.step()?);
    let is_right = 0 <= start && start < end && end as u64 <= MOST_SAMPLES && step == 1;
    if is_right {
        return Ok(start as u32..end as u32);
    }
    let message = format!(
        "samples is {}, but a range must be rising by 1 within 0 and 2**24, and not empty",
        range.repr()?
    );
    Err(PyValueError::new_err(message))
}

/// The layer of a name.
pub(crate) fn layer_of(name: &str) -> PyResult<FilmLayer> {
    let names: Vec<&str> = FilmLayer::ALL.iter().map(|layer| layer.name()).chain([DENOISED]).collect();
    FilmLayer::from_name(name).ok_or_else(|| names::unknown("layer", name, &names))
}

/// The corners of a region of pixels.
pub(crate) fn region_of(argument: &Any<'_>) -> PyResult<[u32; 4]> {
    whole_numbers("region", argument, "four numbers, x0, y0, x1, y1", [0, u32::MAX])
}
