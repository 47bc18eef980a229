//! The exact half space.

use std::ffi::c_char;

use rayon::prelude::*;
use translucid_reference::exact::{HalfSpace, ObliqueHalfSpace, single_scattering_albedo};
use translucid_reference::{Estimate, Incidence};

use crate::ffi_guard::{Caller, Kind, Rule, enter};
use crate::names;
use crate::profile::RADII;
use crate::status::{Failure, TranslucidStatus};
use crate::threads::with_threads;

/// The exact solution of a half space of isotropic scatterers.
///
/// It never changes, so any number of threads may use it at once.
pub struct TranslucidExact {
    _opaque: [u8; 0],
}

/// The value behind a `TranslucidExact`.
pub(crate) struct Exact {
    solution: Solution,
    mfp: f64,
    threads: usize,
}

enum Solution {
    Radial(Box<HalfSpace>),
    /// The solution of a tilted beam.
    Oblique(Box<ObliqueHalfSpace>),
}

impl Kind for TranslucidExact {
    type Value = Exact;
    const TAG: [u8; 8] = *b"tl-exact";
    const NAME: &'static str = "TranslucidExact";
}

/// A half space of isotropic scatterers. A field that is 0 or NULL has its default.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct TranslucidHalfSpace {
    /// Share of the light that leaves again, in (0, 1]: this or the single-scattering albedo.
    pub surface_albedo: f64,
    /// Share of a collision that is scattered, in (0, 1].
    pub single_scattering_albedo: f64,
    /// Mean free path, in [1e-100, 1e100]; by default 1.
    pub mfp: f64,
    /// Relative index of refraction, inside over outside, in [0.5, 3]; by default 1.
    pub eta: f64,
    /// How light enters: "searchlight", or "diffuse", which is the default without an angle.
    pub configuration: *const c_char,
    /// Angle of a beam outside, in degrees from the normal, in [0, 90).
    pub incidence_angle: f64,
    /// Number of threads, at most 1024; by default one per processor.
    pub threads: usize,
}

/// Solves a half space, which takes milliseconds, with a boundary 0.7 s of one processor.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_exact_new(
    half_space: *const TranslucidHalfSpace,
    exact: *mut *mut TranslucidExact,
) -> TranslucidStatus {
    enter!(|caller| {
        let slot = caller.slot("exact", exact)?;
        let given = caller.structure("half_space", half_space)?;
        let mfp = names::number_or(given.mfp, 1.0);
        Rule { name: "mfp", allowed: "in [1e-100, 1e100]", least: 1e-100, most: 1e100 }.require(mfp)?;
        let eta = names::number_or(given.eta, 1.0);
        Rule { name: "eta", allowed: "in [0.5, 3]", least: 0.5, most: 3.0 }.require(eta)?;
        let incidence = names::incidence(caller, given.configuration, given.incidence_angle, eta)?;
        let albedos = (given.surface_albedo, given.single_scattering_albedo);
        let is_surface = match (albedos.0 == 0.0, albedos.1 == 0.0) {
            (false, true) => true,
            (true, false) => false,
            _ => {
                return Err(Failure::argument(format_args!(
                    "surface_albedo is {} and single_scattering_albedo is {}, but one of them must be in (0, 1], and \
                     the other 0",
                    albedos.0, albedos.1
                )));
            }
        };
        let solve = || {
            let alpha =
                if is_surface { single_scattering_albedo(albedos.0, eta, incidence)? } else { albedos.1 };
            Ok(match incidence {
                Incidence::Pencil { cos_theta } if cos_theta < 1.0 => {
                    Solution::Oblique(Box::new(ObliqueHalfSpace::new(alpha, eta, cos_theta)?))
                }
                _ => Solution::Radial(Box::new(HalfSpace::with_boundary(alpha, eta, incidence)?)),
            })
        };
        let solution = with_threads(given.threads, solve)?;
        let solution =
            solution.map_err(|error: translucid_profile::ParameterError| Failure::argument(error))?;
        slot.put_handle(Exact { solution, mfp, threads: given.threads });
        Ok(())
    })
}

/// Frees a solution. NULL is none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_exact_free(exact: *mut TranslucidExact) -> TranslucidStatus {
    enter!(|caller| caller.free("exact", exact))
}

/// Gives R(r) per unit of flux that has entered for count radii, at least 0, and an estimate of its greatest numerical
/// error, where it is not NULL.
///
/// For a tilted beam azimuths are directions from the entry in degrees, from where the beam points to; where it is NULL,
/// R is the mean over all.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_exact_eval(
    exact: *const TranslucidExact,
    r: *const f64,
    azimuths: *const f64,
    count: usize,
    value: *mut f64,
    error: *mut f64,
) -> TranslucidStatus {
    enter!(|caller| {
        let exact = caller.handle("exact", exact)?;
        if azimuths.is_null() {
            let eval = |r: f64| match &exact.solution {
                Solution::Radial(solution) => solution.eval(r),
                Solution::Oblique(solution) => solution.eval_mean(r),
            };
            return figures(caller, exact, r, None, count, [value, error], exact.mfp, |r, _| eval(r));
        }
        let Solution::Oblique(solution) = &exact.solution else {
            return Err(Failure::argument("azimuths need an incidence_angle above 0"));
        };
        let azimuths = caller.input("azimuths", azimuths, count)?;
        let finite = Rule { name: "azimuths", allowed: "finite", least: f64::MIN, most: f64::MAX };
        azimuths.require(&finite)?;
        let azimuths = azimuths.to_vec()?;
        figures(caller, exact, r, Some(&azimuths), count, [value, error], exact.mfp, |r, degrees| {
            solution.eval(r, (degrees % 360.0).to_radians())
        })
    })
}

/// Gives the energy that leaves within r, with the digits of a small r, and its error, where it is not NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_exact_enclosed(
    exact: *const TranslucidExact,
    r: *const f64,
    count: usize,
    value: *mut f64,
    error: *mut f64,
) -> TranslucidStatus {
    enter!(|caller| {
        let exact = caller.handle("exact", exact)?;
        figures(caller, exact, r, None, count, [value, error], 1.0, |r, _| match &exact.solution {
            Solution::Radial(solution) => solution.enclosed(r),
            Solution::Oblique(solution) => solution.enclosed(r),
        })
    })
}

/// Gives the energy that leaves beyond r, with the digits of a large r, and its error, where it is not NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_exact_beyond(
    exact: *const TranslucidExact,
    r: *const f64,
    count: usize,
    value: *mut f64,
    error: *mut f64,
) -> TranslucidStatus {
    enter!(|caller| {
        let exact = caller.handle("exact", exact)?;
        figures(caller, exact, r, None, count, [value, error], 1.0, |r, _| match &exact.solution {
            Solution::Radial(solution) => solution.beyond(r),
            Solution::Oblique(solution) => solution.beyond(r),
        })
    })
}

/// Gives the surface albedo, all the energy that leaves, and its error, where it is not NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_exact_total(
    exact: *const TranslucidExact,
    value: *mut f64,
    error: *mut f64,
) -> TranslucidStatus {
    enter!(|caller| {
        let exact = caller.handle("exact", exact)?;
        let (value, error) = (caller.output("value", value, 1)?, caller.optional_output("error", error, 1)?);
        let total = match &exact.solution {
            Solution::Radial(solution) => solution.total(),
            Solution::Oblique(solution) => solution.total(),
        };
        value.write(0, &[total.value]);
        error.write(0, &[total.error]);
        Ok(())
    })
}

/// Figures at radii, and their errors, in the inverse square of a unit.
#[expect(clippy::too_many_arguments, reason = "the arguments of an entry, and what is asked")]
fn figures(
    caller: &Caller,
    exact: &Exact,
    r: *const f64,
    azimuths: Option<&[f64]>,
    count: usize,
    [value, error]: [*mut f64; 2],
    unit: f64,
    figure: impl Fn(f64, f64) -> Estimate + Sync,
) -> Result<(), Failure> {
    let r = caller.input(RADII.name, r, count)?;
    let (value, error) =
        (caller.output("value", value, count)?, caller.optional_output("error", error, count)?);
    r.require(&RADII)?;
    let mut radii = r.to_vec()?;
    let mut errors = r.to_vec()?;
    let per_area = |x: f64| (x / unit / unit).min(f64::MAX);
    with_threads(exact.threads, || {
        radii.par_iter_mut().zip(&mut errors).enumerate().for_each(|(i, (r, error))| {
            let found = figure(*r / exact.mfp, azimuths.map_or(0.0, |azimuths| azimuths[i]));
            (*r, *error) = (per_area(found.value), per_area(found.error));
        });
    })?;
    value.write(0, &radii);
    error.write(0, &errors);
    Ok(())
}
