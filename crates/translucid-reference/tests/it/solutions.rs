//! Exact solutions that several tests need, each solved once: one under a boundary takes most of a second.

use std::collections::HashMap;
use std::sync::{Arc, LazyLock, Mutex, OnceLock};

use translucid_reference::Incidence;
use translucid_reference::exact::{HalfSpace, ObliqueHalfSpace};

/// Values by a key, each made by the first that asks for it.
type Made<T> = LazyLock<Mutex<HashMap<String, Arc<OnceLock<T>>>>>;

fn get<T: Clone>(made: &Made<T>, key: String, make: impl FnOnce() -> T) -> T {
    let cell = Arc::clone(made.lock().unwrap().entry(key).or_default());
    cell.get_or_init(make).clone()
}

/// The half space of a single-scattering albedo and a relative index of refraction.
pub(crate) fn half_space(alpha: f64, eta: f64, incidence: Incidence) -> Arc<HalfSpace> {
    static MADE: Made<Arc<HalfSpace>> = LazyLock::new(Mutex::default);
    get(&MADE, format!("{alpha} {eta} {incidence:?}"), || {
        Arc::new(HalfSpace::with_boundary(alpha, eta, incidence).expect("valid"))
    })
}

/// The half space under a pencil beam at a cosine of incidence.
pub(crate) fn oblique(alpha: f64, eta: f64, cos_theta: f64) -> Arc<ObliqueHalfSpace> {
    static MADE: Made<Arc<ObliqueHalfSpace>> = LazyLock::new(Mutex::default);
    get(&MADE, format!("{alpha} {eta} {cos_theta}"), || {
        Arc::new(ObliqueHalfSpace::new(alpha, eta, cos_theta).expect("valid"))
    })
}
