//! The kernel of a material of layers where their exact solution is not compiled: there is none.

use translucid_scene::Material;

use super::SubsurfaceKernel;

/// A material of layers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LayersRecipe {
    g_and_eta: [f64; 2],
}

impl LayersRecipe {
    pub(super) fn of(material: &Material) -> Self {
        let g_and_eta = [material.subsurface_scatter_anisotropy, material.subsurface_eta].map(f64::from);
        Self { g_and_eta }
    }

    pub(super) fn g_and_eta(&self) -> [f64; 2] {
        self.g_and_eta
    }

    /// # Errors
    /// Always.
    pub(super) fn make(&self) -> Result<SubsurfaceKernel, String> {
        Err(String::from("the profile of layers is not solved in WebAssembly"))
    }
}
