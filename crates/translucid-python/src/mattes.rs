//! Cryptomatte: the names that a session's picture shows, as ids and shares of each pixel.

use std::collections::HashMap;

use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use translucid_render::{MOST_MATTE_SAMPLES, Session, matte_hash, matte_id};
use translucid_scene::Scene;

use crate::arrays::Any;
use crate::live_session::LiveSession;
use crate::long_work;
use crate::names::unknown;

/// What a matte is of.
#[derive(Clone, Copy)]
pub(crate) enum Kind {
    Object,
    Material,
}

impl Kind {
    pub(crate) fn from_name(name: &str) -> PyResult<Self> {
        match name {
            "object" => Ok(Self::Object),
            "material" => Ok(Self::Material),
            _ => Err(unknown("kind", name, &["object", "material"])),
        }
    }

    /// An id for each object of a scene; `names` has other names for those in the scene.
    fn ids(self, scene: &Scene, names: &HashMap<String, String>) -> Vec<f32> {
        let own = |name: &String| matte_id(names.get(name).unwrap_or(name));
        let materials: Vec<f32> = scene.materials.iter().map(|material| own(&material.name)).collect();
        let objects = scene.objects.iter();
        match self {
            Self::Object => objects.map(|object| own(&object.name)).collect(),
            Self::Material => objects.map(|object| materials[object.material]).collect(),
        }
    }
}

/// Pairs of ids and shares of a session's pixels, (height, width, levels, 2).
pub(crate) fn mattes<'py>(
    py: Python<'py>,
    live: &LiveSession,
    kind: Kind,
    levels: usize,
    names: &HashMap<String, String>,
) -> PyResult<Any<'py>> {
    let work = |session: &mut Session, is_stopped: &(dyn Fn() -> bool + Sync)| {
        let (prepared, view) = (session.prepared(), session.view());
        let region = view.region();
        Session::require_memory(prepared.scene(), region, (levels * size_of::<[f32; 2]>()) as u64)?;
        let samples = session.film().samples().min(MOST_MATTE_SAMPLES);
        let ids = kind.ids(prepared.scene(), names);
        let pairs = prepared.mattes(view, &ids, samples, levels, is_stopped);
        Ok(pairs.map(|pairs| ([region.height, region.width].map(|edge| edge as usize), pairs)))
    };
    let found = long_work::run(py, |stop| live.work(stop, work), |_| Ok(()))??;
    let ([height, width], pairs) =
        found.ok_or_else(|| PyRuntimeError::new_err("the session was cancelled meanwhile"))?;
    Ok(pairs.into_flattened().into_pyarray(py).reshape([height, width, levels, 2])?.into_any())
}

/// The number that stands for a name in Cryptomattes.
///
/// Parameters
/// ----------
/// name : str
///     Name of an object or a material.
///
/// Returns
/// -------
/// float
///     A number of 32 bits, to be compared with the ids of `Session.cryptomatte`.
///
/// Examples
/// --------
/// >>> np.float32(translucid.cryptomatte_id("ball")).view(np.uint32) == 0x645D3BC4
/// np.True_
#[pyfunction]
pub(crate) fn cryptomatte_id(name: &str) -> f32 {
    matte_id(name)
}

/// MurmurHash3 of a name, of which an id is made.
#[pyfunction]
pub(crate) fn _cryptomatte_hash(name: &str) -> u32 {
    matte_hash(name)
}
