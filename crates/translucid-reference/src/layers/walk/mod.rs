//! The Monte Carlo walk through layers.
//!
//! Photons carry weights, of which every collision leaves a part in its layer; standard errors are those between batches.
//! The bits of a result are a function of layers, light, grid, number of photons and seed: they do not depend on threads.

mod grid;
mod many_weights;
mod medium;
mod tally;
mod weights;

pub use grid::{Grid, Quantity};
pub use tally::LayersTally;

use std::f64::consts::FRAC_PI_2;

use fearless_simd::Level;
use rayon::prelude::*;
use translucid_profile::{ParameterError, fresnel_from_outside, require};

use self::grid::Places;
use self::many_weights::Absorptions;
use self::medium::{Cells, media};
use self::tally::Batch;
use self::weights::Setup;
use super::{Ground, Layer, Layers};
use crate::walk::boundary::Medium;
use crate::walk::deflection_table::DeflectionLaw;
use crate::walk::edge_search::EdgeSearch;
use crate::walk::photon_source::PhotonSource;
use crate::walk::random::Key;
use crate::walk::{Control, Parameters, Problem};
use crate::{Incidence, specular_reflectance};

/// Least and most batches that photons are walked in, whose differences give the errors.
const BATCHES: [u64; 2] = [64, 4096];
/// Photons of a batch, where there are as many: what is lost where a walk is stopped.
const BATCH: u64 = 1 << 20;

impl Layers {
    /// Walks photons of a seed on all threads of the current rayon pool.
    ///
    /// Where it is stopped, the result is that of the batches done so far, of which there are 64 or more in all.
    ///
    /// ```
    /// use translucid_reference::Incidence;
    /// use translucid_reference::layers::{Grid, Ground, Layer, Layers, Quantity};
    /// use translucid_reference::walk::Control;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let slab = Layers::new(1.0, vec![Layer::new(90.0, 10.0, 0.02).with_g(0.75)], Ground::AIR)?;
    /// let tally = slab.walk(Incidence::NORMAL, Grid::TOTALS, 20_000, 1, &Control::default())?;
    /// let reflected = tally.total(Quantity::Reflected);
    /// assert!((reflected.value - 0.09739).abs() < 5.0 * reflected.error); // H. C. van de Hulst 1980
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// The grid is not one, the light cannot enter, moments make a phase function negative at some angle, or mean free paths
    /// and thicknesses differ by more than a factor of 1e12.
    pub fn walk(
        &self,
        incidence: Incidence,
        grid: Grid,
        photons: u64,
        seed: u64,
        control: &Control,
    ) -> Result<LayersTally, ParameterError> {
        self.walk_at_level(Level::new(), incidence, grid, photons, seed, control)
    }

    /// [`walk`](Self::walk) with a choice of instruction set.
    fn walk_at_level(
        &self,
        level: Level,
        incidence: Incidence,
        grid: Grid,
        photons: u64,
        seed: u64,
        control: &Control,
    ) -> Result<LayersTally, ParameterError> {
        require(photons > 0, "photons", photons as f64, "at least 1")?;
        let (media, unit, problem) = self.check_walk(incidence, &grid)?;
        let clear = self.clear_first(incidence);
        let specular = clear.unwrap_or_else(|| specular_reflectance(incidence, problem.parameters().eta));
        let first = usize::from(clear.is_some()).min(media.len());
        let is_clear = first == media.len();
        let setup = Setup { first, ..Setup::new(self, media, unit, grid, &problem, seed) };
        let mut tally = LayersTally::new(setup.places.clone(), specular);
        if is_clear {
            tally.add_all_transmitted(photons);
            return Ok(tally);
        }
        walk_in_batches(level, &setup, photons, control, std::slice::from_mut(&mut tally));
        Ok(tally)
    }

    /// [`walk`](Self::walk) for several sets of absorption coefficients in place of the layers' own, one for each layer, by
    /// the same photons: a tally for each set.
    ///
    /// The photons are walked once, in layers that absorb nothing, each with a weight for each set: e^{−σ_a L} for its way L
    /// in each layer. Estimates are unbiased with the errors of each set, which are those of `walk` or less, but errors of
    /// different sets go together. Sets without any absorption take as long as it takes light to find its way out.
    ///
    /// Light absorbed by depth, and by ring and depth, is known only where the grid has a single cell for it, and NaN
    /// elsewhere. Light that comes back through a clear first layer is reflected, not specular, whatever a set has there.
    ///
    /// ```
    /// use translucid_reference::Incidence;
    /// use translucid_reference::layers::{Grid, Ground, Layer, Layers, Quantity};
    /// use translucid_reference::walk::Control;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let slab = Layers::new(1.0, vec![Layer::new(90.0, 0.0, 0.02).with_g(0.75)], Ground::AIR)?;
    /// let sets = [vec![0.0], vec![1.0], vec![10.0]];
    /// let control = Control::default();
    /// let tallies = slab.walk_absorptions(&sets, Incidence::NORMAL, Grid::TOTALS, 20_000, 1, &control)?;
    /// let reflected = tallies[2].total(Quantity::Reflected);
    /// assert!((reflected.value - 0.09739).abs() < 5.0 * reflected.error); // H. C. van de Hulst 1980
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// A set does not have a coefficient in [0, 1e30] for each layer, there are none or too many sets for their counts, no
    /// layer scatters, or those of [`walk`](Self::walk).
    pub fn walk_absorptions(
        &self,
        absorptions: &[Vec<f64>],
        incidence: Incidence,
        grid: Grid,
        photons: u64,
        seed: u64,
        control: &Control,
    ) -> Result<Vec<LayersTally>, ParameterError> {
        require(photons > 0, "photons", photons as f64, "at least 1")?;
        let sets = absorptions.len();
        require(sets > 0, "number of absorptions", sets as f64, "at least 1")?;
        for set in absorptions {
            let allowed = "that of the layers";
            require(
                set.len() == self.layers.len(),
                "coefficients of an absorption",
                set.len() as f64,
                allowed,
            )?;
            let wrong = set.iter().find(|value| !(0.0..=1e30).contains(*value));
            wrong.map_or(Ok(()), |value| Err(ParameterError::new("absorption", *value, "in [0, 1e30]")))?;
        }
        let most = self.layers.iter().map(|layer| layer.scattering).fold(0.0, f64::max);
        require(most > 0.0, "scattering", most, "greater than 0 in a layer, for several absorptions")?;
        let white = self.layers.iter().map(|layer| Layer { absorption: 0.0, ..layer.clone() });
        let white = Self { layers: white.collect(), ..self.clone() };
        let (media, unit, problem) = white.check_walk(incidence, &grid)?;
        let coefficients = (0..media.len()).flat_map(|layer| {
            absorptions.iter().map(move |set| ((set[layer] * unit).min(f64::from(f32::MAX))) as f32)
        });
        let absorptions = Absorptions { sets, coefficients: coefficients.collect() };
        let setup =
            Setup { absorptions: Some(absorptions), ..Setup::new(self, media, unit, grid, &problem, seed) };
        let counts = setup.places.count() as f64 * sets as f64;
        let allowed = "at most 4000000: fewer absorptions, or a coarser grid";
        require(counts <= Grid::MOST_CELLS as f64, "counts of all absorptions", counts, allowed)?;
        let specular = specular_reflectance(incidence, problem.parameters().eta);
        let mut tallies = vec![LayersTally::new(setup.places.clone(), specular); sets];
        walk_in_batches(Level::new(), &setup, photons, control, &mut tallies);
        Ok(tallies)
    }

    /// Checks what [`walk`](Self::walk) does before its first photon.
    ///
    /// # Errors
    /// As there.
    pub fn check_for_walk(&self, incidence: Incidence, grid: &Grid) -> Result<(), ParameterError> {
        self.check_walk(incidence, grid).map(|_| ())
    }

    /// The layers, their unit of length and the light as the walk needs them.
    fn check_walk(
        &self,
        incidence: Incidence,
        grid: &Grid,
    ) -> Result<(Vec<Medium>, f64, Problem), ParameterError> {
        grid.check()?;
        let (media, unit) = media(self)?;
        let eta = self.layers()[0].eta / self.eta_above();
        let allowed = "in [0.1, 10], for a walk";
        require((0.1..=10.0).contains(&eta), "eta of the first layer over that above", eta, allowed)?;
        let problem = Problem::new(Parameters { eta, incidence, ..Parameters::default() })?;
        Ok((media, unit, problem))
    }

    /// Specular reflectance of a clear first layer under a perpendicular beam.
    fn clear_first(&self, incidence: Incidence) -> Option<f64> {
        let first = &self.layers()[0];
        if incidence != Incidence::NORMAL || first.extinction() > 0.0 {
            return None;
        }
        let below = match (self.layers().get(1), self.ground()) {
            (Some(second), _) => second.eta,
            (None, Ground::Medium { eta }) => eta,
            (None, _) => return None,
        };
        let [r1, r2] =
            [first.eta / self.eta_above(), below / first.eta].map(|eta| fresnel_from_outside(1.0, eta));
        Some(r1 + (1.0 - r1) * (1.0 - r1) * r2 / (1.0 - r1 * r2))
    }
}

impl Setup {
    /// Photons that start in the first layer.
    fn new(layers: &Layers, media: Vec<Medium>, unit: f64, grid: Grid, problem: &Problem, seed: u64) -> Self {
        Self {
            cells: Cells::new(&grid, unit),
            cosines: EdgeSearch::new(cosines(grid.na)),
            places: Places::new(grid, media.len()),
            key: Key::new(seed),
            source: PhotonSource::new(problem),
            first: 0,
            laws: layers.layers.iter().map(|layer| DeflectionLaw::new(&layer.phase_function)).collect(),
            media,
            absorptions: None,
        }
    }
}

/// Walks photons, and adds what they do to tallies, one for each absorption.
fn walk_in_batches(
    level: Level,
    setup: &Setup,
    photons: u64,
    control: &Control,
    tallies: &mut [LayersTally],
) {
    let [least, most] = BATCHES;
    let batches = photons.div_ceil(BATCH).clamp(least, most).min(photons);
    let start_of = |batch: u64| (u128::from(photons) * u128::from(batch) / u128::from(batches)) as u64;
    let ranges: Vec<_> = (0..batches).map(|batch| start_of(batch)..start_of(batch + 1)).collect();
    for wave in ranges.chunks(rayon::current_num_threads()) {
        if control.stops() {
            break;
        }
        let walk = |range: &std::ops::Range<u64>| weights::walk(level, setup, control.stop, range.clone());
        let done: Vec<Option<Batch>> = wave.par_iter().map(walk).collect();
        for Batch { photons, collisions, sums } in done.into_iter().flatten() {
            for (tally, sums) in tallies.iter_mut().zip(sums.chunks_exact(setup.places.count())) {
                tally.add(Batch { photons, collisions, sums: sums.to_vec() });
            }
        }
        (control.progress)(tallies[0].photons());
    }
}

/// Cosines between angles of equal width, from grazing up.
fn cosines(angles: usize) -> Vec<f64> {
    let between = |i: usize| libm::cos(FRAC_PI_2 * i as f64 / angles as f64);
    (1..angles).rev().map(between).collect()
}

#[cfg(test)]
mod laws;
