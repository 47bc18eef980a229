//! The exact solution for one surface albedo, with what it takes to judge others by it.

use std::sync::OnceLock;

use translucid_fit::{Burley, Exponential, Fit, Judge, Target};
use translucid_profile::{Configuration, Medium, ParameterError, half_space_single_scattering_albedo};
use translucid_reference::exact::HalfSpaceProfile;

/// The exact half space of isotropic scatterers that returns a surface albedo, with a mean free path of 1.
pub struct Reference {
    /// Surface albedo A, in (0, 1].
    pub surface_albedo: f64,
    /// Way in which light enters.
    pub configuration: Configuration,
    /// The medium that returns A exactly.
    pub medium: Medium,
    /// R(r).
    pub exact: HalfSpaceProfile,
    /// Distances from R.
    pub judge: Judge,
    target: Target,
    exponentials: OnceLock<Vec<Fit<Exponential>>>,
}

impl Reference {
    /// Most exponentials that are fitted.
    pub const MAX_EXPONENTIALS: usize = 4;

    /// Solves the half space.
    ///
    /// # Errors
    /// The surface albedo is not in (0, 1\].
    pub fn new(surface_albedo: f64, configuration: Configuration) -> Result<Self, ParameterError> {
        let exact = HalfSpaceProfile::from_surface_albedo(surface_albedo, configuration)?;
        let alpha = half_space_single_scattering_albedo(surface_albedo, configuration);
        Ok(Self {
            surface_albedo,
            configuration,
            medium: Medium::from_mfp(alpha, 1.0, 0.0)?,
            judge: Judge::new(&exact),
            target: Target::new(&exact)?,
            exact,
            exponentials: OnceLock::new(),
        })
    }

    /// Least-squares fits of 1, 2, … [`MAX_EXPONENTIALS`](Self::MAX_EXPONENTIALS) exponentials, made when they are
    /// first asked for.
    pub fn exponentials(&self) -> &[Fit<Exponential>] {
        self.exponentials.get_or_init(|| self.target.fit(Self::MAX_EXPONENTIALS).unwrap_or_default())
    }

    /// The least-squares fit of one normalized diffusion.
    ///
    /// # Errors
    /// None: one term can be fitted to any profile.
    pub fn best_normalized_diffusion(&self) -> Result<Fit<Burley>, ParameterError> {
        Ok(self.target.fit::<Burley>(1)?.swap_remove(0))
    }

    /// Single-scattering albedo α of the medium.
    pub fn single_scattering_albedo(&self) -> f64 {
        self.medium.single_scattering_albedo()
    }
}
