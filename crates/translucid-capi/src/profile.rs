//! Profiles: made of a model and parameters, of a medium or of samples; evaluated and sampled on arrays.

use std::ffi::c_char;
use std::sync::Arc;

use translucid_profile::{
    Appearance, Configuration, Medium, Model, ParameterError, Parameterization, Profile, Quantity,
    SampledProfile, TabulatedProfile,
};

use crate::ffi_guard::{Caller, Kind, Rule, enter};
use crate::names::{self, Names};
use crate::status::{Failure, TranslucidStatus};

/// A reflectance profile R(r): the light that leaves a flat surface at the distance r from the point where one unit of
/// flux entered, per area.
///
/// It never changes, so any number of threads may use it at once.
pub struct TranslucidProfile {
    _opaque: [u8; 0],
}

impl Kind for TranslucidProfile {
    type Value = Arc<dyn Profile>;
    const TAG: [u8; 8] = *b"tlprofil";
    const NAME: &'static str = "TranslucidProfile";
}

/// Looks of a translucent material. A field that is 0 or NULL has its default.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct TranslucidAppearance {
    /// Surface albedo A, the share of the light that leaves again, in [0, 1].
    pub surface_albedo: f64,
    /// Mean free path in the volume, greater than 0, in any unit of length: this or dmfp.
    pub mfp: f64,
    /// Diffuse mean free path on the surface, greater than 0.
    pub dmfp: f64,
    /// Mean cosine of the phase function, in (-1, 1); models without one take 0 only.
    pub g: f64,
    /// Relative index of refraction, inside over outside; by default 1, and models without a boundary take 1 only.
    pub eta: f64,
    /// How light enters: "searchlight", a pencil beam along the normal, or "diffuse", from all directions; by default
    /// "diffuse" with an mfp and "searchlight" with a dmfp, the fits that renderers use.
    pub configuration: *const c_char,
}

/// A medium by its coefficients. A field that is 0 or NULL has its default.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct TranslucidMedium {
    /// Absorption coefficient, at least 0, in the inverse of the unit of radii.
    pub sigma_a: f64,
    /// Scattering coefficient, at least 0, likewise.
    pub sigma_s: f64,
    /// Mean cosine of the phase function, in (-1, 1). Models that know isotropic scattering only get the similar
    /// isotropic medium, of (1 - g) sigma_s.
    pub g: f64,
    /// Relative index of refraction, inside over outside; by default 1, and models without a boundary take 1 only.
    pub eta: f64,
    /// How light enters: "searchlight", or "diffuse", which is the default.
    pub configuration: *const c_char,
}

pub(crate) const RADII: Rule = Rule { name: "r", allowed: "at least 0", least: 0.0, most: f64::INFINITY };
pub(crate) const SHARES: Rule = Rule { name: "u", allowed: "in [0, 1]", least: 0.0, most: 1.0 };

/// Name of a model by its index: NULL behind the last.
///
/// The text lasts as long as the program.
#[unsafe(no_mangle)]
pub extern "C" fn translucid_model_name(index: usize) -> *const c_char {
    static NAMES: Names = Names::new();
    names::name_of(&NAMES, index, || Model::ALL.map(Model::name).to_vec())
}

/// Makes the profile of a model: one of translucid_model_name, by default "normalized-diffusion-refined".
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_profile_new(
    model: *const c_char,
    appearance: *const TranslucidAppearance,
    profile: *mut *mut TranslucidProfile,
) -> TranslucidStatus {
    enter!(|caller| {
        let slot = caller.slot("profile", profile)?;
        let described = Described::read(caller, model, appearance)?;
        slot.put_handle(described.profile(&described.appearance).map_err(Failure::argument)?.into());
        Ok(())
    })
}

/// Makes the profile of a medium by a model, which is as in translucid_profile_new.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_profile_from_medium(
    model: *const c_char,
    medium: *const TranslucidMedium,
    profile: *mut *mut TranslucidProfile,
) -> TranslucidStatus {
    enter!(|caller| {
        let slot = caller.slot("profile", profile)?;
        let model = names::model(caller, model)?;
        let given = caller.structure("medium", medium)?;
        let configuration = names::configuration(caller, given.configuration)?;
        let configuration = configuration.unwrap_or(Configuration::Diffuse);
        let medium = Medium::new(given.sigma_a, given.sigma_s, given.g).map_err(Failure::argument)?;
        let made = model.profile_of_medium(&medium, configuration, names::number_or(given.eta, 1.0));
        slot.put_handle(made.map_err(Failure::argument)?.into());
        Ok(())
    })
}

/// Makes the profile through count samples that somebody measured or simulated: at least four radii, greater than 0,
/// rising, and R(r), at least 0, falling towards the end.
///
/// Where the energies within the radii are known, they are kept; else enclosed is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_profile_from_samples(
    radii: *const f64,
    reflectances: *const f64,
    enclosed: *const f64,
    count: usize,
    profile: *mut *mut TranslucidProfile,
) -> TranslucidStatus {
    enter!(|caller| {
        let slot = caller.slot("profile", profile)?;
        let radii = caller.input("radii", radii, count)?.to_vec()?;
        let reflectances = caller.input("reflectances", reflectances, count)?.to_vec()?;
        let made = if enclosed.is_null() {
            SampledProfile::new(&radii, &reflectances)
        } else {
            let enclosed = caller.input("enclosed", enclosed, count)?.to_vec()?;
            SampledProfile::from_samples_and_enclosed(&radii, &reflectances, &enclosed)
        };
        slot.put_handle(Arc::new(made.map_err(Failure::argument)?));
        Ok(())
    })
}

/// Makes a table of a profile, whose cdf, quantile and samples take some ten nanoseconds for every model; off by some
/// 1e-5 of the cdf at most.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_profile_tabulated(
    profile: *const TranslucidProfile,
    tabulated: *mut *mut TranslucidProfile,
) -> TranslucidStatus {
    enter!(|caller| {
        let slot = caller.slot("tabulated", tabulated)?;
        let profile = caller.handle("profile", profile)?;
        slot.put_handle(Arc::new(TabulatedProfile::new(&**profile)));
        Ok(())
    })
}

/// Frees a profile. NULL is none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_profile_free(profile: *mut TranslucidProfile) -> TranslucidStatus {
    enter!(|caller| caller.free("profile", profile))
}

/// Gives the energy that leaves altogether, the surface albedo; where a model makes more than there is, greater than 1.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_profile_total(
    profile: *const TranslucidProfile,
    total: *mut f64,
) -> TranslucidStatus {
    enter!(|caller| {
        let slot = caller.slot("total", total)?;
        slot.put(caller.handle("profile", profile)?.surface_albedo());
        Ok(())
    })
}

/// Gives R(r) for count radii, at least 0, in the inverse square of their unit; at r = 0 the greatest finite number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_profile_eval(
    profile: *const TranslucidProfile,
    r: *const f64,
    count: usize,
    out: *mut f64,
) -> TranslucidStatus {
    enter!(|caller| apply(caller, profile, Quantity::Eval, r, count, out))
}

/// Gives the probability density per length of the radius at which light leaves, 2 pi r R(r) / A: that of samples.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_profile_pdf(
    profile: *const TranslucidProfile,
    r: *const f64,
    count: usize,
    out: *mut f64,
) -> TranslucidStatus {
    enter!(|caller| apply(caller, profile, Quantity::Pdf, r, count, out))
}

/// Gives the probability density per area of the point at which light leaves, R(r) / A.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_profile_pdf_area(
    profile: *const TranslucidProfile,
    r: *const f64,
    count: usize,
    out: *mut f64,
) -> TranslucidStatus {
    enter!(|caller| apply(caller, profile, Quantity::PdfArea, r, count, out))
}

/// Gives the share of the light that leaves within r, in [0, 1].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_profile_cdf(
    profile: *const TranslucidProfile,
    r: *const f64,
    count: usize,
    out: *mut f64,
) -> TranslucidStatus {
    enter!(|caller| apply(caller, profile, Quantity::Cdf, r, count, out))
}

/// Gives the energy that leaves within r, which rises to the total.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_profile_enclosed(
    profile: *const TranslucidProfile,
    r: *const f64,
    count: usize,
    out: *mut f64,
) -> TranslucidStatus {
    enter!(|caller| apply(caller, profile, Quantity::Enclosed, r, count, out))
}

/// Gives the energy that leaves beyond r, with the digits of a large r.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_profile_beyond(
    profile: *const TranslucidProfile,
    r: *const f64,
    count: usize,
    out: *mut f64,
) -> TranslucidStatus {
    enter!(|caller| apply(caller, profile, Quantity::Beyond, r, count, out))
}

/// Gives the radius within which the share u of the light leaves, u in [0, 1]: the inverse of the cdf.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_profile_quantile(
    profile: *const TranslucidProfile,
    u: *const f64,
    count: usize,
    out: *mut f64,
) -> TranslucidStatus {
    enter!(|caller| apply(caller, profile, Quantity::Quantile, u, count, out))
}

/// Gives a radius of the density pdf for each random number u, uniform on [0, 1).
///
/// It need not rise with u. Models without a closed form search: sample a table of them where there are more than some
/// dozens.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_profile_sample(
    profile: *const TranslucidProfile,
    u: *const f64,
    count: usize,
    out: *mut f64,
) -> TranslucidStatus {
    enter!(|caller| apply(caller, profile, Quantity::Sample, u, count, out))
}

fn apply(
    caller: &Caller,
    profile: *const TranslucidProfile,
    quantity: Quantity,
    x: *const f64,
    count: usize,
    out: *mut f64,
) -> Result<(), Failure> {
    let profile = caller.handle("profile", profile)?;
    let rule = if matches!(quantity, Quantity::Quantile | Quantity::Sample) { SHARES } else { RADII };
    let (x, out) = (caller.input(rule.name, x, count)?, caller.output("out", out, count)?);
    x.require(&rule)?;
    x.map(&out, |_, from, to| profile.apply(quantity, from, to));
    Ok(())
}

/// A model and its parameters as a call gives them.
pub(crate) struct Described {
    model: Model,
    pub(crate) appearance: Appearance,
    configuration: Configuration,
    eta: f64,
}

impl Described {
    pub(crate) fn read(
        caller: &Caller,
        model: *const c_char,
        appearance: *const TranslucidAppearance,
    ) -> Result<Self, Failure> {
        let given = caller.structure("appearance", appearance)?;
        let TranslucidAppearance { surface_albedo, mfp, dmfp, g, .. } = given;
        let (length, parameterization) = match (mfp == 0.0, dmfp == 0.0) {
            (false, true) => (mfp, Parameterization::Mfp),
            (true, false) => (dmfp, Parameterization::Dmfp),
            _ => {
                return Err(Failure::argument(format_args!(
                    "mfp is {mfp} and dmfp is {dmfp}, but one of them must be greater than 0, and the other 0"
                )));
            }
        };
        let configuration = names::configuration(caller, given.configuration)?;
        Ok(Self {
            model: names::model(caller, model)?,
            appearance: Appearance { surface_albedo, length, parameterization, g },
            configuration: configuration.unwrap_or(parameterization.usual_configuration()),
            eta: names::number_or(given.eta, 1.0),
        })
    }

    /// The profile of other looks in place of those that were given; an error calls the length as the header does.
    pub(crate) fn profile(&self, appearance: &Appearance) -> Result<Box<dyn Profile>, ParameterError> {
        self.model.profile(appearance, self.configuration, self.eta).map_err(|error| {
            let is_length = matches!(error.parameter, "length" | "transport_mfp");
            let length = appearance.parameterization.name();
            ParameterError { parameter: if is_length { length } else { error.parameter }, ..error }
        })
    }
}
