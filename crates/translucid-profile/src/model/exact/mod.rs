//! The exact half space of isotropic scatterers, tabulated.

mod table;

use crate::error::ParameterError;
use crate::medium::appearance::half_space_mfp;
use crate::model::exact::table::ExactTable;
use crate::profile::methods_of;
use crate::{Configuration, Parameterization, Profile, TabulatedProfile};

/// Reflectance profile of a half space that scatters isotropically (g = 0) without a boundary (η = 1), exact.
///
/// The solution after G. B. Rybicki, *The searchlight problem with isotropic scattering*, J. Quant. Spectrosc.
/// Radiat. Transfer 11, 1971, as the crate `translucid-reference` computes it, tabulated over radius and surface
/// albedo. This is what the approximate models and fits are judged by.
///
/// Against that solution, for every surface albedo (`tests/it/exact_profile.rs` of that crate): the cdf is off by
/// less than 1e-6, and by less than 2e-5 of itself close to the point of entry; R(r) by less than 5e-5 of itself
/// up to 20 mean free paths, by less than 1e-3 of itself for albedos below 0.02, which have next to nothing left
/// there. Beyond 16,384 mean free paths an exponential takes the place of what at A = 1 is R ~ r⁻³, with 1e-4 of
/// the energy.
///
/// It is a [table](Self::tabulated): densities, quantile and sampling belong to it.
///
/// ```
/// use translucid_profile::{Configuration, ExactProfile, Parameterization, Profile};
///
/// # fn main() -> Result<(), translucid_profile::ParameterError> {
/// let profile = ExactProfile::new(0.5, 1.0, Parameterization::Mfp, Configuration::Searchlight)?;
/// assert!((profile.enclosed(1.0) - 0.253274).abs() < 1e-6);
/// let r = profile.tabulated().sample(0.7);
/// assert!((profile.tabulated().cdf(r) - 0.7).abs() < 1e-14);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct ExactProfile {
    table: TabulatedProfile,
}

impl ExactProfile {
    /// The profile of a surface albedo A ∈ \[0, 1\] and a length > 0 \[L\], which is the mean free path or, as the
    /// parameterization says, the diffuse mean free path with Grosjean's D
    /// ([`Medium::dmfp`](crate::Medium::dmfp)).
    ///
    /// A diffuse mean free path takes up to 0.3 ms to convert, a mean free path 10 µs in all.
    ///
    /// # Errors
    /// A parameter is outside its range, A is 1 with a diffuse mean free path, or the mean free path is not in
    /// \[1e-150, 1e150\].
    pub fn new(
        surface_albedo: f64,
        length: f64,
        parameterization: Parameterization,
        configuration: Configuration,
    ) -> Result<Self, ParameterError> {
        let mfp = half_space_mfp(surface_albedo, length, parameterization, configuration)?;
        let table = ExactTable::of(configuration).at(surface_albedo);
        Ok(Self { table: TabulatedProfile::from_table(table, mfp, surface_albedo) })
    }

    /// Mean free path ℓ \[L\].
    pub fn mfp(&self) -> f64 {
        self.table.scale()
    }

    /// The profile with all that a table does: densities, cdf, quantile and sampling.
    pub fn tabulated(&self) -> &TabulatedProfile {
        &self.table
    }
}

impl Profile for ExactProfile {
    methods_of!(|own| own.table; all);

    fn scale(&self) -> f64 {
        self.mfp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn profile(surface_albedo: f64, configuration: Configuration) -> ExactProfile {
        ExactProfile::new(surface_albedo, 1.0, Parameterization::Mfp, configuration)
            .expect("valid parameters")
    }

    /// Energies and profiles computed apart from this project's code: physics notes of the project, section 3.
    #[test]
    fn profile_has_the_known_values() {
        let searchlight = profile(0.5, Configuration::Searchlight);
        for (r, expected) in [(0.1, 0.041267), (1.0, 0.253274), (5.0, 0.474759), (20.0, 0.499984)] {
            assert!((searchlight.enclosed(r) - expected).abs() < 1.5e-6, "{r}: {}", searchlight.enclosed(r));
        }
        for (a, configuration, r, expected) in [
            (0.11522587770720, Configuration::Searchlight, 0.1, 0.27160357244),
            (0.11522587770720, Configuration::Searchlight, 1.0, 5.2531991084e-3),
            (0.14654438069972, Configuration::Diffuse, 1.0, 7.4036993206e-3),
            (0.41494747913082, Configuration::Searchlight, 1.0, 2.1217649785e-2),
            (0.47802448922824, Configuration::Diffuse, 1.0, 2.5383964017e-2),
            (0.75272071716030, Configuration::Searchlight, 0.1, 0.64361446601),
            (0.79456365290203, Configuration::Diffuse, 1.0, 3.539921615e-2),
        ] {
            let found = profile(a, configuration).eval(r);
            assert!((found / expected - 1.0).abs() < 2e-5, "{a} {r}: {found}");
        }
    }

    #[test]
    fn dmfp_is_that_of_the_medium() {
        for a in [0.0, 0.2, 0.8, 0.999] {
            let configuration = Configuration::Searchlight;
            let by_dmfp = ExactProfile::new(a, 3.0, Parameterization::Dmfp, configuration).expect("valid");
            let alpha = crate::half_space_single_scattering_albedo(a, configuration);
            let medium = crate::Medium::from_mfp(alpha, by_dmfp.mfp(), 0.0).expect("valid");
            assert!((medium.dmfp() / 3.0 - 1.0).abs() < 1e-9, "{a}: {}", medium.dmfp());
        }
    }

    #[test]
    fn new_refuses_what_has_no_profile() {
        let new = |a, length, parameterization| {
            ExactProfile::new(a, length, parameterization, Configuration::Diffuse)
        };
        for (a, length) in
            [(-0.1, 1.0), (1.1, 1.0), (f64::NAN, 1.0), (0.5, 0.0), (0.5, f64::NAN), (0.5, 1e160)]
        {
            assert!(new(a, length, Parameterization::Mfp).is_err(), "{a} {length}");
        }
        assert!(new(1.0, 1.0, Parameterization::Dmfp).is_err());
        assert!(new(1.0f64.next_down(), 1.0, Parameterization::Dmfp).is_ok());
        assert_eq!(new(0.5, 1e200, Parameterization::Dmfp).map_err(|error| error.value).err(), Some(1e200));
        assert!(
            new(1.0, 1.0, Parameterization::Mfp).is_ok() && new(0.0, 1.0, Parameterization::Dmfp).is_ok()
        );
    }
}
