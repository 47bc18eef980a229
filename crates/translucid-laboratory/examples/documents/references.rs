//! The exact solution at the surface albedos that all tables and figures show.

use translucid_laboratory::comparison::Reference;
use translucid_profile::Configuration;

/// Surface albedos of the talk.
pub(crate) const ALBEDOS: [f64; 3] = [0.2, 0.5, 0.8];
pub(crate) const CONFIGURATIONS: [Configuration; 2] = [Configuration::Searchlight, Configuration::Diffuse];

/// The exact solution at [`ALBEDOS`].
pub(crate) struct References {
    pub(crate) searchlight: Vec<Reference>,
    pub(crate) diffuse: Vec<Reference>,
}

impl References {
    pub(crate) fn new() -> Result<Self, String> {
        let of = |configuration| -> Result<Vec<Reference>, String> {
            let made = ALBEDOS.iter().map(|a| Reference::new(*a, configuration));
            made.collect::<Result<_, _>>().map_err(|error| error.to_string())
        };
        Ok(Self { searchlight: of(Configuration::Searchlight)?, diffuse: of(Configuration::Diffuse)? })
    }
}
