//! Reflectance, transmittance and absorption of layers.

use translucid_profile::{ParameterError, require};

use super::matrix::Matrix;
use super::operators::{LayerOperators, depth, face};
use super::rays::{Rays, squared_indices};
use super::{Ground, Layer, Layers};
use crate::Incidence;
#[cfg(not(target_family = "wasm"))]
use crate::walk::Control;

/// Energies per unit of flux that arrives from above; their sum is 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Totals {
    /// Part that returns without having been scattered: reflected by the first face, and by others behind it.
    pub specular_reflectance: f64,
    /// Part that returns scattered; light from a Lambertian ground is scattered.
    pub diffuse_reflectance: f64,
    /// Part that leaves into the medium below without having been scattered.
    pub collimated_transmittance: f64,
    /// Part that leaves into the medium below scattered.
    pub diffuse_transmittance: f64,
    /// Part that each layer absorbs.
    pub absorbed: Vec<f64>,
    /// Part that the ground absorbs.
    pub absorbed_by_ground: f64,
    /// Estimate of the greatest numerical error among them: twice the difference between two rules, and what
    /// very narrow forward scattering adds.
    pub error: f64,
}

/// Rays between two indices, rule by rule.
const COUNTS: [usize; 7] = [8, 12, 16, 24, 32, 48, 64];
/// Least cosine of a pencil: nearer to grazing, a ray of its own is no part of the rules.
const LEAST_COSINE: f64 = 1e-4;
/// Error at which no finer rule is tried.
const ENOUGH: f64 = 1e-6;
/// Error by the part of scattering into a peak of no angle: for g = 0.98 the totals change with it by up to a third of
/// that.
const PEAK_DOUBT: f64 = 1e-4;
/// Most rays of a rule.
const MOST_RAYS: usize = 256;

impl Layers {
    /// Solves for the light that arrives from above: totals to 1e-6 or better.
    ///
    /// Discrete directions (S. Chandrasekhar 1950) solve each layer, adding (H. C. van de Hulst 1963, *A new look at
    /// multiple scattering*) joins them; two rules of directions tell the error, which is stated where it is larger
    /// than 1e-6: under faces of nearly equal indices, and for |g| above 0.95.
    ///
    /// ```
    /// use translucid_reference::Incidence;
    /// use translucid_reference::layers::{Ground, Layer, Layers};
    ///
    /// // H. C. van de Hulst 1980, Multiple Light Scattering, table 35: 0.09739 and 0.66096, as quoted by L. Wang,
    /// // S. L. Jacques and L. Zheng 1995, MCML
    /// let slab = Layer::new(90.0, 10.0, 0.02).with_g(0.75);
    /// let totals = Layers::new(1.0, vec![slab], Ground::AIR)?.totals(Incidence::NORMAL)?;
    /// assert!((totals.diffuse_reflectance - 0.09739).abs() < 5e-6);
    /// let transmittance = totals.collimated_transmittance + totals.diffuse_transmittance;
    /// assert!((transmittance - 0.66096).abs() < 5e-6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// A layer that scatters is thicker than 1e15 mean free paths, a pencil's cosine is not in [1e-4, 1], or the incidence is given inside a medium ([`Incidence::UniformCosine`]).
    pub fn totals(&self, incidence: Incidence) -> Result<Totals, ParameterError> {
        // Nobody stops it
        self.totals_while(ENOUGH, incidence, &mut |_| true).map(|totals| totals.expect("totals"))
    }

    /// [`totals`](Self::totals) by the first rule whose error is below a tolerance, or by the finest; nothing if it is
    /// stopped.
    ///
    /// Many layers with many indices of refraction take minutes to 1e-6, and a third of that or less to 0.01.
    /// Progress counts thousandths of all rules, some of which may not be needed.
    ///
    /// # Errors
    /// The tolerance is not in [1e-12, 0.1], or those of [`totals`](Self::totals).
    #[cfg(not(target_family = "wasm"))]
    pub fn totals_within(
        &self,
        tolerance: f64,
        incidence: Incidence,
        control: &Control,
    ) -> Result<Option<Totals>, ParameterError> {
        self.totals_while(tolerance, incidence, &mut |done| {
            (control.progress)(done);
            !control.stops()
        })
    }

    /// [`totals`](Self::totals) to a tolerance, as long as `goes_on`, which is told the thousandths done, says so.
    fn totals_while(
        &self,
        tolerance: f64,
        incidence: Incidence,
        goes_on: &mut dyn FnMut(u64) -> bool,
    ) -> Result<Option<Totals>, ParameterError> {
        require((1e-12..=0.1).contains(&tolerance), "tolerance", tolerance, "in [1e-12, 0.1]")?;
        let beam = self.beam(incidence)?;
        for layer in self.layers.iter().filter(|layer| layer.scattering > 0.0 && layer.thickness.is_finite())
        {
            let depth = depth(layer);
            let allowed = "at most 1e15 in a layer that scatters; the last layer may be infinite";
            require(depth <= 1e15, "optical thickness", depth, allowed)?;
        }
        let panels = squared_indices(self).len();
        let finest = COUNTS.iter().position(|count| count * panels > MOST_RAYS).unwrap_or(COUNTS.len() - 1);
        // A layer takes the cube of its rays
        let costs = COUNTS[..=finest.max(1)].iter().map(|count| (count * count * count) as u64);
        let all = self.layers.len() as u64 * costs.sum::<u64>();
        let mut done = 0;
        let mut totals: Option<Totals> = None;
        for count in &COUNTS[..=finest.max(1)] {
            let rays = Rays::new(self, *count, beam);
            let solved = self.totals_by(&rays, &mut || {
                done += (count * count * count) as u64;
                goes_on(1000 * done / all)
            });
            let Some(now) = solved else { return Ok(None) };
            let Some(before) = totals else {
                totals = Some(now);
                continue;
            };
            let lost = (now.sum() - 1.0).abs();
            let error = 2.0 * now.difference(&before) + PEAK_DOUBT * self.peak(&rays) + lost;
            // What is not a number is no result
            let error = if error.is_nan() { f64::INFINITY } else { error.max(1e-12) };
            totals = Some(Totals { error, ..now });
            if error < tolerance {
                break;
            }
        }
        Ok(totals)
    }

    /// Greatest part of a layer's scattering that counts as not scattered.
    fn peak(&self, rays: &Rays) -> f64 {
        let scattering = self.layers.iter().filter(|layer| layer.scattering > 0.0);
        let peak = |layer: &Layer| layer.phase_function.moment(rays.moments(rays.count(layer.eta))).abs();
        scattering.map(peak).fold(0.0, f64::max)
    }

    /// p² of a pencil.
    fn beam(&self, incidence: Incidence) -> Result<Option<f64>, ParameterError> {
        match incidence {
            Incidence::Pencil { cos_theta } if (LEAST_COSINE..=1.0).contains(&cos_theta) => {
                Ok(Some(self.eta_above * self.eta_above * (1.0 - cos_theta * cos_theta)))
            }
            Incidence::Pencil { cos_theta } => {
                Err(ParameterError::new("cos_theta", cos_theta, "in [1e-4, 1]"))
            }
            Incidence::Cosine => Ok(None),
            Incidence::UniformCosine => {
                let allowed = "outside of the layers: a pencil or a cosine distribution";
                Err(ParameterError::new("incidence", f64::NAN, allowed))
            }
        }
    }

    /// Totals by one rule; after each layer `goes_on` tells whether to go on.
    fn totals_by(&self, rays: &Rays, goes_on: &mut dyn FnMut() -> bool) -> Option<Totals> {
        let stack = Stack::new(self, rays, goes_on)?;
        let above = rays.count(self.eta_above);
        let incident: Vec<f64> = match rays.beam() {
            Some(beam) => {
                (0..above).map(|ray| if ray == beam { 1.0 / rays.root(ray) } else { 0.0 }).collect()
            }
            None => (0..above).map(|ray| rays.root(ray) / (self.eta_above * self.eta_above)).collect(),
        };
        let mut totals = stack.pass(&incident);
        // The rule's own sum of the weights is not quite 1
        for ray in (0..above).filter(|ray| incident[*ray] != 0.0) {
            let flux = incident[ray] * rays.root(ray);
            let [reflected, transmitted] = stack.unscattered(ray);
            totals.specular_reflectance += flux * reflected;
            totals.collimated_transmittance += flux * transmitted;
        }
        totals.diffuse_reflectance -= totals.specular_reflectance;
        totals.diffuse_transmittance -= totals.collimated_transmittance;
        totals.diffuse_reflectance = totals.diffuse_reflectance.max(0.0);
        totals.diffuse_transmittance = totals.diffuse_transmittance.max(0.0);
        Some(totals)
    }
}

impl Totals {
    /// Sum of all parts, which is 1.
    pub fn sum(&self) -> f64 {
        self.parts().sum()
    }

    fn parts(&self) -> impl Iterator<Item = f64> {
        [
            self.specular_reflectance,
            self.diffuse_reflectance,
            self.collimated_transmittance,
            self.diffuse_transmittance,
            self.absorbed_by_ground,
        ]
        .into_iter()
        .chain(self.absorbed.iter().copied())
    }

    fn difference(&self, other: &Self) -> f64 {
        self.parts().zip(other.parts()).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()))
    }
}

/// Layers with what lies below each, for one set of rays.
struct Stack<'a> {
    layers: &'a Layers,
    rays: &'a Rays,
    /// From top to bottom.
    levels: Vec<Level>,
    /// Reflection of the first face with all that is below.
    reflected: Matrix,
}

/// One layer and the face above it.
struct Level {
    /// Reflectance of the face above, for the rays that pass it.
    face: Vec<f64>,
    /// Amplitudes below the face, from those that arrive above.
    entered: Matrix,
    /// Reflection of this layer with all that is below.
    reflected: Matrix,
    /// Amplitudes that reach the layer's lower face, from those at its upper one.
    passed: Matrix,
    /// Reflection of what is below the layer.
    below: Matrix,
}

impl<'a> Stack<'a> {
    /// Adds layers from the ground up, as long as `goes_on` says so.
    fn new(layers: &'a Layers, rays: &'a Rays, goes_on: &mut dyn FnMut() -> bool) -> Option<Self> {
        let mut levels = Vec::new();
        let mut below = ground(layers, rays);
        for (i, layer) in layers.layers.iter().enumerate().rev() {
            let eta_above = if i == 0 { layers.eta_above } else { layers.layers[i - 1].eta };
            let LayerOperators { reflected, transmitted } = LayerOperators::new(layer, rays);
            let passed = one_minus(&reflected.times(&below)).solve(transmitted.clone());
            let returned = transmitted.times(&below.times(&passed));
            let reflected = Matrix::from_fn(reflected.size(), |i, j| reflected.at(i, j) + returned.at(i, j));
            let face = face(rays, eta_above, layer.eta);
            let entered = entered(&face, &reflected);
            let above = add_face(rays.count(eta_above), &face, &entered, &reflected);
            levels.push(Level { face, entered, reflected, passed, below });
            below = above;
            if !goes_on() {
                return None;
            }
        }
        levels.reverse();
        Some(Self { layers, rays, levels, reflected: below })
    }

    /// Sends amplitudes in from above; unscattered light counts as diffuse.
    fn pass(&self, incident: &[f64]) -> Totals {
        let flux = |amplitudes: &[f64]| self.rays.flux(amplitudes);
        let diffuse_reflectance = flux(&self.reflected.times_vector(incident));
        let mut down = incident.to_vec();
        let mut absorbed = Vec::new();
        for level in &self.levels {
            let mut arriving = down;
            arriving.truncate(level.face.len());
            arriving.resize(level.reflected.size(), 0.0);
            let top = level.entered.times_vector(&arriving);
            let bottom = level.passed.times_vector(&top);
            let up = [level.reflected.times_vector(&top), level.below.times_vector(&bottom)];
            absorbed.push(flux(&top) - flux(&bottom) - flux(&up[0]) + flux(&up[1]));
            down = bottom;
        }
        let left =
            flux(&down) - self.levels.last().map_or(0.0, |level| flux(&level.below.times_vector(&down)));
        let (transmitted, grounded) = match self.layers.ground {
            Ground::None => (0.0, 0.0),
            Ground::Medium { .. } => (left, 0.0),
            Ground::Lambertian { .. } => (0.0, left.max(0.0)),
        };
        for (absorbed, layer) in absorbed.iter_mut().zip(&self.layers.layers) {
            // What is left is rounding
            *absorbed =
                if layer.absorption == 0.0 && layer.thickness.is_finite() { 0.0 } else { absorbed.max(0.0) };
        }
        Totals {
            specular_reflectance: 0.0,
            diffuse_reflectance,
            collimated_transmittance: 0.0,
            diffuse_transmittance: transmitted,
            absorbed,
            absorbed_by_ground: grounded,
            error: 0.0,
        }
    }

    /// Light of a ray that is reflected and transmitted without being scattered.
    fn unscattered(&self, ray: usize) -> [f64; 2] {
        let layers = self.layers;
        let last = layers.layers.last().map_or(layers.eta_above, |layer| layer.eta);
        let (mut reflected, mut transmitted) = match layers.ground {
            Ground::Medium { eta } => {
                let reflected = face(self.rays, last, eta).get(ray).copied().unwrap_or(1.0);
                (reflected, 1.0 - reflected)
            }
            _ => (0.0, 0.0),
        };
        for (layer, level) in layers.layers.iter().zip(&self.levels).rev() {
            if ray >= self.rays.count(layer.eta) {
                (reflected, transmitted) = (1.0, 0.0);
                continue;
            }
            let once = libm::exp(-depth(layer) / self.rays.cosine(ray, layer.eta));
            (reflected, transmitted) = (reflected * once * once, transmitted * once);
            let face = level.face.get(ray).copied().unwrap_or(1.0);
            let between = 1.0 - face * reflected;
            if between > 0.0 {
                transmitted *= (1.0 - face) / between;
                reflected = face + (1.0 - face) * (1.0 - face) * reflected / between;
            } else {
                (reflected, transmitted) = (1.0, 0.0);
            }
        }
        [reflected, transmitted]
    }
}

/// Reflection by the ground.
fn ground(layers: &Layers, rays: &Rays) -> Matrix {
    let eta = layers.layers.last().map_or(layers.eta_above, |layer| layer.eta);
    let count = rays.count(eta);
    match layers.ground {
        Ground::None => Matrix::from_fn(count, |_, _| 0.0),
        Ground::Medium { eta: below } => {
            let mut reflectances = face(rays, eta, below);
            reflectances.resize(count, 1.0);
            Matrix::diagonal(&reflectances)
        }
        Ground::Lambertian { reflectance } => {
            let whole: f64 = (0..count).map(|ray| rays.root(ray) * rays.root(ray)).sum();
            Matrix::from_fn(count, |i, j| reflectance * rays.root(i) * rays.root(j) / whole)
        }
    }
}

fn one_minus(matrix: &Matrix) -> Matrix {
    Matrix::from_fn(matrix.size(), |i, j| f64::from(u8::from(i == j)) - matrix.at(i, j))
}

/// (1 − F R)⁻¹ (1 − F): rays that the face does not let through are reflected back and do not enter.
fn entered(face: &[f64], reflected: &Matrix) -> Matrix {
    let size = reflected.size();
    let inside = |ray: usize| face.get(ray).copied().unwrap_or(1.0);
    let between = Matrix::from_fn(size, |i, j| {
        let one = f64::from(u8::from(i == j));
        let factor = if is_trapped(face, reflected, i) { 0.0 } else { inside(i) };
        one - factor * reflected.at(i, j)
    });
    between.solve(Matrix::diagonal(&(0..size).map(|ray| 1.0 - inside(ray)).collect::<Vec<f64>>()))
}

/// Whether a ray goes to and fro in clear media without loss: no light ever gets into it.
fn is_trapped(face: &[f64], reflected: &Matrix, ray: usize) -> bool {
    ray >= face.len() && reflected.at(ray, ray) > 1.0 - 1e-12
}

/// Reflection by a face and what is below it.
fn add_face(count: usize, face: &[f64], entered: &Matrix, reflected: &Matrix) -> Matrix {
    let returned = reflected.times(entered);
    Matrix::from_fn(count, |i, j| {
        let straight = if i == j { face.get(i).copied().unwrap_or(1.0) } else { 0.0 };
        let passes = i < face.len() && j < face.len();
        straight + if passes { (1.0 - face[i]) * returned.at(i, j) } else { 0.0 }
    })
}

#[cfg(test)]
mod tests;
