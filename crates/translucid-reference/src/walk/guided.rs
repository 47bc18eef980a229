//! A walk for one albedo, guided towards the surface.
//!
//! The white walk serves every albedo, phase function and boundary. This one serves one albedo of the half space
//! that has an exact solution, with as little CPU time for a given error as could be found: it is the independent
//! judge of that solution, and nothing else.
//!
//! # Parts and their gains
//! Relative variance × collisions for MCML's scheme (implicit capture, late roulette), in which every collision
//! costs much the same, divided by the same with the parts below added one by one. Total and ring from 1 to 3 ℓ
//! under a pencil beam, measured with a plain loop in double precision to which the parts are added one by one.
//!
//! ```text
//! α                                      0.5          0.9          0.99         0.999
//!                                    total ring   total ring   total ring   total ring
//! analog absorption                    1.5  1.4     2.3  2.6     2.2  3.5     2.1  3.6
//! guided flights                        18  6.8     133   11     635  9.1    2240  7.7
//! from the second collision on          97   25     227   16     840   11    2800  8.8
//! all azimuths of the last flight        –   33       –   25       –   16       –   13
//! roulette with a control variate       97   33     226   25     840   21    3070   31
//! lattice                              495  127     449   53    1080   29    3400   40
//! ```
//!
//! 1. *Guided flights* (Dwivedi; `guided_sampling.rs` has the formulas): directions and lengths are drawn so that the
//!    weight is known from where a photon is. No photon is absorbed, and what it carries out is 1 − kμ, times a
//!    constant.
//! 2. *From the second collision on:* light scattered once is a closed form
//!    ([`SingleScattering`](crate::exact::SingleScattering)).
//! 3. *All azimuths of the last flight:* given its slope, it ends on a circle around the last collision. The part of
//!    that circle in each ring is an arc cosine.
//! 4. *Roulette with a control variate:* a photon far from all rings tells nothing about them. At a distance D from the
//!    entry it is followed only with the weight (D/b)^1.5, b = last radius + 1: the square root of the chance, and
//!    of the time, to come back. Light that comes from afar leaves on average with the weight c = E\[1 − kμ\] whatever
//!    it has been through, so a photon that ends counts c for the total, and one that goes on with twice the weight
//!    counts c less. This has no bias for any c.
//! 5. *Lattice:* the start and the first three flights of a chunk of 1024 photons take their numbers from one rank-1
//!    lattice, shifted at random. Chunks are independent; the standard error comes from their scatter.
//! 6. *Sixteen lanes*, breadth first, some 10 ns for a photon at α = 0.5 and 46 ns at α = 0.999 (`guided_chunk.rs`).
//!
//! In CPU time to 0.1 % of the total and to 1 % of the ring, beside analog absorption in lanes of the same kind:
//! some 320 and 90 times less (α = 0.5), 250 and 25 (0.9), 580 and 10 (0.99), 1270 and 9 (0.999).
//!
//! Tried and left out: scoring the expected escape at every collision (2 times less variance per collision at
//! α = 0.5, more variance from α = 0.9 on, and each score costs as much as a flight); k below the discrete
//! eigenvalue, with absorption (always worse); roulette by D or by D² (less gain, or rare heavy photons).
//!
//! # Figures
//! Weights are single precision, sums are whole numbers: the same in any order, on any number of threads. Against the exact
//! solution no deviation was found down to relative errors of 10⁻⁶ (64 million photons, α from 10⁻⁶ to 0.99999).

use fearless_simd::Level;
use rayon::prelude::*;
use translucid_profile::ParameterError;

use super::guided_chunk::{BLOCK, CHUNK, Workspace, walk_block};
use super::guided_sampling::Guide;
use super::guided_scoring::{ChunkSums, Scoring};
use super::guided_tally::GuidedTally;
use super::instruction_sets::dispatched;
use super::problem::{Parameters, PhaseFunction, Problem, require};
use crate::exact::{Entrance, SingleScattering};
use crate::{Estimate, Incidence};

/// Total and rings of one albedo, by a walk with little variance: of an index-matched half space of isotropic
/// scatterers, under a pencil along the normal, cosine or uniform incidence.
///
/// All figures are per unit of flux that entered the medium. Their standard errors come from the scatter of chunks
/// of [`GuidedWalk::CHUNK`] photons; with n chunks they are themselves uncertain by a part of 1/√(2n), and infinite
/// with less than two. Of rings that few photons reach they know little. A ring that none has reached has the energy
/// of light scattered once, and the error of one photon.
///
/// ```
/// use translucid_reference::walk::{GuidedWalk, Parameters, Problem};
///
/// let problem = Problem::new(Parameters::default())?;
/// let walk = GuidedWalk::run(&problem, 0.9, &[1.0, 3.0], 1, 200)?;
/// let total = walk.total();
/// assert!((total.value - 0.41494747913082).abs() < 4.0 * total.error && total.relative_error() < 1e-3);
/// let ring = walk.ring(1);
/// assert!((ring.value - 0.136886).abs() < 4.0 * ring.error);
/// # Ok::<(), translucid_profile::ParameterError>(())
/// ```
#[derive(Clone, Debug)]
pub struct GuidedWalk {
    radii: Vec<f64>,
    /// Profile of the light scattered once.
    single_scattering: SingleScattering,
    tally: GuidedTally,
}

impl GuidedWalk {
    /// Photons of a chunk.
    pub const CHUNK: u64 = CHUNK as u64;

    /// Smallest and largest radius.
    const RADII: std::ops::RangeInclusive<f64> = 1e-15..=1e15;

    /// Walks the first chunks of photons of a seed, on all threads of the current rayon pool, and tallies the rings
    /// between increasing radii \[ℓ\]: ring i reaches from radius i − 1 to radius i, ring 0 from the center, the last
    /// one to infinity. Indices past the last are no error: a radius past the last is infinite, a ring past the last
    /// is empty.
    ///
    /// The tally's bits do not depend on the threads. Photons that have strayed from all rings are followed less
    /// often: the larger the last radius, the longer a photon takes, up to some 1/√(1−α) collisions.
    ///
    /// # Errors
    /// α is not in (0, 1), a radius is not in [1e-15, 1e15] or not greater than the one before, or the problem is not
    /// the half space that the guide is made for: isotropic scattering, η = 1, a pencil along the normal, cosine
    /// or uniform incidence at one point.
    pub fn run(
        problem: &Problem,
        single_scattering_albedo: f64,
        radii: &[f64],
        seed: u64,
        chunks: u32,
    ) -> Result<Self, ParameterError> {
        let entrance = entrance_to_guide(problem)?;
        let alpha = single_scattering_albedo;
        let allowed = "in (0, 1) for the guided walk";
        require(alpha > 0.0 && alpha < 1.0, "single_scattering_albedo", alpha, allowed)?;
        let mut least = 0.0;
        for &radius in radii {
            let increases = radius > least && Self::RADII.contains(&radius);
            require(increases, "radius", radius, "in [1e-15, 1e15] and greater than the one before")?;
            least = radius;
        }
        Ok(Self {
            radii: radii.to_vec(),
            single_scattering: SingleScattering::new(alpha, entrance),
            tally: tally(alpha, entrance, radii, seed, u64::from(chunks)),
        })
    }

    /// Number of photons walked.
    pub fn photons(&self) -> u64 {
        self.tally.photons()
    }

    /// Mean number of collisions that a photon was followed through, the first included; 0 without photons.
    pub fn mean_collisions(&self) -> f64 {
        if self.photons() == 0 { 0.0 } else { self.tally.collisions() as f64 / self.photons() as f64 }
    }

    /// Surface albedo A = ∫ R 2πr dr.
    pub fn total(&self) -> Estimate {
        shifted(self.tally.total(), self.single_scattering.total().value)
    }

    /// Energy that leaves through a ring.
    pub fn ring(&self, ring: usize) -> Estimate {
        let Some(estimate) = self.tally.ring(ring) else { return Estimate::ZERO };
        let single = &self.single_scattering;
        let inner = ring.checked_sub(1).and_then(|i| self.radii.get(i));
        let enclosed = |radius: Option<&f64>| radius.map_or(0.0, |&radius| single.enclosed(radius).value);
        let beyond = |radius: Option<&f64>| radius.map(|&radius| single.beyond(radius).value);
        let once = match self.radii.get(ring) {
            Some(outer) if *outer < 1.0 => enclosed(Some(outer)) - enclosed(inner),
            // Far out the energy inside has no digits left for a ring
            outer => beyond(inner).unwrap_or(single.total().value) - beyond(outer).unwrap_or(0.0),
        };
        shifted(estimate, once)
    }

    /// Mean exitance over a ring \[ℓ⁻²\]: its energy by its area. 0 for the last ring, whose area is infinite.
    pub fn reflectance(&self, ring: usize) -> Estimate {
        let Some(&outer) = self.radii.get(ring) else { return Estimate::ZERO };
        let inner = ring.checked_sub(1).map_or(0.0, |i| self.radii[i]);
        let area = std::f64::consts::PI * (outer - inner) * (outer + inner);
        let Estimate { value, error } = self.ring(ring);
        Estimate { value: value / area, error: error / area }
    }

    /// Energy that leaves within a radius, given by its index.
    pub fn enclosed(&self, radius: usize) -> Estimate {
        match (self.tally.enclosed(radius), self.radii.get(radius)) {
            (Some(estimate), Some(&radius)) => {
                shifted(estimate, self.single_scattering.enclosed(radius).value)
            }
            _ => self.total(),
        }
    }
}

/// Walks chunks of photons, some of them at a time.
fn tally(alpha: f64, entrance: Entrance, radii: &[f64], seed: u64, chunks: u64) -> GuidedTally {
    let (guide, scoring) = (Guide::new(alpha, entrance), Scoring::new(radii));
    // Light scattered twice or more is of this order where α is small
    let empty = || GuidedTally::new(radii.len(), alpha * alpha, guide.greatest_weight());
    let walk = |workspace: &mut Workspace, block: u64| {
        let first = block * BLOCK as u64;
        let count = (chunks - first).min(BLOCK as u64) as usize;
        let mut sums = vec![ChunkSums::new(radii.len()); count];
        dispatched!(Level::new(), simd => walk_block(simd, &guide, &scoring, seed, first, &mut sums, workspace));
        let mut tally = empty();
        sums.iter().for_each(|sums| tally.add(sums));
        tally
    };
    let blocks = (0..chunks.div_ceil(BLOCK as u64)).into_par_iter();
    blocks.map_init(Workspace::new, walk).reduce(empty, |all, part| all.merged(&part))
}

fn shifted(estimate: Estimate, by: f64) -> Estimate {
    Estimate { value: estimate.value + by, ..estimate }
}

/// Directions of entering light for which the guide serves.
fn entrance_to_guide(problem: &Problem) -> Result<Entrance, ParameterError> {
    let Parameters { phase_function, eta, thickness, incidence, spot_radius } = *problem.parameters();
    let g = phase_function.mean_cosine();
    let isotropic = phase_function == PhaseFunction::ISOTROPIC;
    require(isotropic, "g", g, "0, of isotropic scattering, for the guided walk: use the white walk")?;
    require(eta == 1.0, "eta", eta, "1 for the guided walk: use the white walk")?;
    let infinite = thickness == f64::INFINITY;
    require(infinite, "thickness", thickness, "infinite for the guided walk: use the white walk")?;
    require(spot_radius == 0.0, "spot_radius", spot_radius, "0 for the guided walk: use the white walk")?;
    match incidence {
        Incidence::Pencil { cos_theta } => {
            require(cos_theta == 1.0, "cos_theta", cos_theta, "1 for the guided walk: use the white walk")?;
            Ok(Entrance::Normal)
        }
        Incidence::Cosine => Ok(Entrance::Cosine),
        Incidence::UniformCosine => Ok(Entrance::UniformCosine),
    }
}
