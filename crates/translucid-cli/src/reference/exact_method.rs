//! `translucid reference --method exact`.

use std::cell::Cell;

use rayon::prelude::*;
use translucid_reference::exact::{HalfSpace, ObliqueHalfSpace};
use translucid_reference::walk::{PhaseFunction, Problem};
use translucid_reference::{Estimate, Incidence};

use super::{COLUMNS, ReferenceArguments};
use crate::failure::Failure;
use crate::progress::{Meter, Unit};
use crate::table::exact;

/// Prints the solution, albedo by albedo.
pub(super) fn run(arguments: &ReferenceArguments, problem: &Problem) -> Result<(), Failure> {
    refuse_what_is_not_solved(arguments, problem)?;
    let albedos = arguments.albedos(problem)?;
    let solve = |&(_, alpha): &(Option<f64>, f64)| Solution::new(arguments, problem, alpha);
    // Whatever can be wrong with an albedo shows before the first line is printed.
    solve(&albedos[0])?;
    // There may be billions of radii: rows are made as they are written.
    drop(arguments.radii.iter()?);
    let radii = || arguments.radii.iter().into_iter().flatten();

    let meter = Meter::new(Unit::Albedos);
    let (mut done, count) = (0, albedos.len() as u64);
    let failed: Cell<Option<Failure>> = Cell::new(None);
    let solutions = albedos.chunks(rayon::current_num_threads()).flat_map(|albedos| {
        meter.update(done, count);
        done += albedos.len() as u64;
        albedos.par_iter().map(solve).collect::<Vec<_>>()
    });
    let rows = albedos.iter().zip(solutions).map_while(|(&(surface_albedo, alpha), solution)| {
        let solution = solution.map_err(|failure| failed.set(Some(failure))).ok()?;
        let surface_albedo = surface_albedo.unwrap_or_else(|| solution.total().value);
        Some(radii().map(move |r| solution.row(r, arguments.mfp, [surface_albedo, alpha])))
    });
    let written = arguments.table.write(COLUMNS, rows.flatten());
    meter.finish();
    match failed.take() {
        Some(failure) => Err(failure),
        None => written,
    }
}

/// Refuses what is not solved, and names a replacement.
fn refuse_what_is_not_solved(arguments: &ReferenceArguments, problem: &Problem) -> Result<(), Failure> {
    let parameters = problem.parameters();
    let refuse = |what: String| {
        Err(Failure::input(format!("the exact method has no {what}"))
            .with_help("use --method monte-carlo, which does"))
    };
    match &parameters.phase_function {
        PhaseFunction::HenyeyGreenstein { g: 0.0 } => {}
        PhaseFunction::HenyeyGreenstein { g } => {
            return refuse(format!("anisotropic scattering, and --g is {}, not 0", exact(*g)));
        }
        _ => {
            let what = "phase function but the isotropic one outside of --layers";
            return refuse(String::from(what));
        }
    }
    if let Some(thickness) = arguments.thickness {
        return refuse(format!("slab, and --thickness is {}", exact(thickness)));
    }
    if parameters.spot_radius > 0.0 {
        return refuse(format!("spot of light, and --spot-radius is {}", exact(arguments.spot_radius)));
    }
    if let Some(path) = arguments.table.npz() {
        let message = format!("--output is {}, but only a walk makes such files", path.display());
        return Err(Failure::input(message).with_help("name a text file, or use --method monte-carlo"));
    }
    arguments.walk.refuse_all()
}

/// The solved half space of one albedo.
enum Solution {
    /// Around the normal, or its mean over all directions.
    Radial(HalfSpace),
    /// In one direction from the entry of a tilted beam.
    Directed(Box<ObliqueHalfSpace>, f64),
}

impl Solution {
    fn new(arguments: &ReferenceArguments, problem: &Problem, alpha: f64) -> Result<Self, Failure> {
        let parameters = problem.parameters();
        let solution = match (parameters.incidence, arguments.azimuth) {
            (Incidence::Pencil { cos_theta }, Some(degrees)) => {
                ObliqueHalfSpace::new(alpha, parameters.eta, cos_theta)
                    .map(|solution| Self::Directed(Box::new(solution), degrees.to_radians()))
            }
            _ => HalfSpace::with_boundary(alpha, parameters.eta, parameters.incidence).map(Self::Radial),
        };
        solution.map_err(|error| arguments.name_option(error))
    }

    fn total(&self) -> Estimate {
        match self {
            Self::Radial(solution) => solution.total(),
            Self::Directed(solution, _) => solution.total(),
        }
    }

    /// One line of the table, lengths turned back into the unit of the mean free path.
    fn row(&self, r: f64, mfp: f64, [surface_albedo, alpha]: [f64; 2]) -> [f64; 6] {
        let (reflectance, enclosed) = match self {
            Self::Radial(solution) => (solution.eval(r / mfp), solution.enclosed(r / mfp)),
            Self::Directed(solution, azimuth) => {
                (solution.eval(r / mfp, *azimuth), solution.enclosed(r / mfp))
            }
        };
        super::row([surface_albedo, alpha, r], mfp, reflectance, enclosed)
    }
}
