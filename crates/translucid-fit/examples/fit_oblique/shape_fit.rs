//! Tilts, weights and rates as polynomials of the surface albedo A, fitted at all A and angles together.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};
use translucid_fit::{LevenbergMarquardt, Residuals, least_squares};
use translucid_profile::{Configuration, Parameterization, RefinedDiffusion};

/// Exponentials, as many as the profile of light along the normal has.
pub(crate) const TERMS: usize = RefinedDiffusion::TERMS;
/// Coefficients of the polynomial for a tilt, or for its change.
pub(crate) const OF_TILT: usize = 3;
/// Coefficients of the polynomial for a weight at grazing incidence.
pub(crate) const OF_WEIGHT: usize = 3;
/// Coefficients of the polynomial for the change of a rate.
pub(crate) const OF_RATE: usize = 2;
/// The weight of the last term is what the others leave of 1, and the slowest rate does not change.
const FREE: usize = TERMS - 1;
const PARAMETERS: usize = 2 * TERMS * OF_TILT + FREE * (OF_WEIGHT + OF_RATE);
/// The greatest angle of the fit, at which the ranges of everything end.
pub(crate) const MOST_DEGREES: f64 = 85.0;
/// Least tilt, least weight at grazing incidence, and by which factor other rates stay above the slowest.
const LEAST: [f64; 3] = [0.02, 0.002, 1.02];
/// Number of times that the weights of the least squares are made anew.
const STAGES: u32 = 12;
/// Share by which the sum of squares no longer gets better where each ends.
const TOLERANCE: f64 = 1e-4;

/// c₀ + c₁x + c₂x² + …
pub(crate) fn polynomial(coefficients: &[f64], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

/// Grazing of an angle: 0 along the normal, 1 along the surface.
pub(crate) fn grazing(cos_theta: f64) -> f64 {
    1.0 - cos_theta.sqrt()
}

/// The coefficients.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape {
    /// tan θ_k / tan θ₀ at normal incidence, and what is added at grazing incidence.
    pub(crate) tilts: [[[f64; OF_TILT]; 2]; TERMS],
    /// Weights at grazing incidence of all terms but the last.
    pub(crate) weights: [[f64; OF_WEIGHT]; FREE],
    /// Relative changes of all rates but the slowest at grazing incidence.
    pub(crate) rates: [[f64; OF_RATE]; FREE],
}

/// The terms for one surface albedo and angle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Terms {
    pub(crate) weights: [f64; TERMS],
    pub(crate) rates: [f64; TERMS],
    pub(crate) cosines: [f64; TERMS],
    pub(crate) sines: [f64; TERMS],
}

impl Shape {
    /// Near enough to the optimum: terms that reach far are tilted less.
    const START: Self = Self {
        tilts: [
            [[1.8, -1.7, 0.0], [0.0; 3]],
            [[1.5, -1.2, 0.0], [0.0; 3]],
            [[1.0, 0.0, 0.0], [0.0; 3]],
            [[0.3, 1.5, 0.0], [0.0; 3]],
        ],
        weights: [[0.15, 0.0, 0.0], [0.5, 0.0, 0.0], [0.3, 0.0, 0.0]],
        rates: [[0.0; 2]; FREE],
    };

    /// Terms of the profile at a surface albedo and a cosine, from those along the normal.
    pub(crate) fn terms(&self, normal: &RefinedDiffusion, cos_theta: f64) -> Terms {
        let (a, grazing) = (normal.surface_albedo(), grazing(cos_theta));
        let tan = (1.0 - cos_theta * cos_theta).sqrt() / cos_theta;
        let mut at_grazing = [1.0; TERMS];
        for (k, coefficients) in self.weights.iter().enumerate() {
            at_grazing[k] = polynomial(coefficients, a);
            at_grazing[FREE] -= at_grazing[k];
        }
        let weight = |k: usize| (1.0 - grazing) * normal.weights()[k] + grazing * at_grazing[k];
        let change = |k: usize| if k == 0 { 0.0 } else { polynomial(&self.rates[k - 1], a) };
        let tilted = |k: usize| {
            let [at_normal, change] = &self.tilts[k];
            tan * (polynomial(at_normal, a) + grazing * polynomial(change, a))
        };
        let cosines: [f64; TERMS] = std::array::from_fn(|k| tilted(k).hypot(1.0).recip());
        Terms {
            weights: std::array::from_fn(weight),
            rates: std::array::from_fn(|k| normal.rates()[k] * (1.0 + grazing * change(k))),
            cosines,
            sines: std::array::from_fn(|k| tilted(k) * cosines[k]),
        }
    }

    /// Distance of the shape from the limits of what is allowed at a surface albedo: tilts, weights and rates.
    fn margins(&self, a: f64) -> Vec<f64> {
        let normal = along_normal(a);
        let grazing = grazing(MOST_DEGREES.to_radians().cos());
        let tilt = |[at_normal, change]: &[[f64; OF_TILT]; 2]| {
            let at_normal = polynomial(at_normal, a);
            [at_normal - LEAST[0], at_normal + grazing * polynomial(change, a) - LEAST[0]]
        };
        let mut margins: Vec<f64> = self.tilts.iter().flat_map(tilt).collect();
        let weights = self.weights.map(|coefficients| polynomial(&coefficients, a));
        margins.extend(weights.map(|weight| weight - LEAST[1]));
        margins.push(1.0 - weights.iter().sum::<f64>() - LEAST[1]);
        let rate = |k: usize| normal.rates()[k + 1] * (1.0 + grazing * polynomial(&self.rates[k], a));
        margins.extend((0..FREE).map(|k| rate(k) / normal.rates()[0] - LEAST[2]));
        margins
    }

    /// Panics unless tilts and weights are positive and no rate falls below the slowest, at 2,001 surface albedos.
    pub(crate) fn assert_valid(&self) {
        for i in 0..=2000 {
            let least = self.margins(f64::from(i) / 2e3).into_iter().fold(f64::INFINITY, f64::min);
            assert!(least > -0.9 * LEAST[1], "{least} at {i}: {self:?}");
        }
    }

    /// Every coefficient as a multiple of a unit.
    pub(crate) fn rounded(&self, unit: f64) -> Self {
        let parameters: Vec<f64> = self.parameters().iter().map(|c| (c / unit).round() * unit).collect();
        Self::from_parameters(&parameters)
    }

    fn from_parameters(parameters: &[f64]) -> Self {
        let mut rest = parameters.iter().copied();
        let mut next = || rest.next().expect("as many as PARAMETERS says");
        let mut shape = Self::START;
        shape.tilts.as_flattened_mut().as_flattened_mut().iter_mut().for_each(|c| *c = next());
        shape.weights.as_flattened_mut().iter_mut().for_each(|c| *c = next());
        shape.rates.as_flattened_mut().iter_mut().for_each(|c| *c = next());
        shape
    }

    fn parameters(&self) -> Vec<f64> {
        let tilts = self.tilts.as_flattened().as_flattened();
        tilts.iter().chain(self.weights.as_flattened()).chain(self.rates.as_flattened()).copied().collect()
    }
}

/// The profile of light along the normal, for a mean free path of 1.
pub(crate) fn along_normal(surface_albedo: f64) -> RefinedDiffusion {
    let configuration = Configuration::Searchlight;
    RefinedDiffusion::new(surface_albedo, 1.0, Parameterization::Mfp, configuration).expect("in [0, 1]")
}

impl Terms {
    /// Density per area at a distance and the cosine of an azimuth.
    pub(crate) fn density(&self, r: f64, cos_phi: f64) -> f64 {
        let term = |k: usize| {
            let along_azimuth = self.cosines[k] / (1.0 - self.sines[k] * cos_phi);
            self.weights[k] * self.rates[k] * (-self.rates[k] * r).exp() * along_azimuth
        };
        (0..TERMS).map(term).sum::<f64>() / (2.0 * PI * r)
    }
}

/// The exact profile of one surface albedo and angle as shares of the energy in cells of the plane.
#[derive(Clone, Debug)]
pub(crate) struct Exact {
    pub(crate) surface_albedo: f64,
    pub(crate) degrees: f64,
    /// r, cos φ, area of a cell with its mirror image, share of the energy.
    pub(crate) cells: Vec<[f64; 4]>,
}

impl Exact {
    /// Σ |share of the fit − share| over all cells.
    pub(crate) fn error(&self, shape: &Shape) -> f64 {
        let terms = shape.terms(&along_normal(self.surface_albedo), self.degrees.to_radians().cos());
        let difference = |&[r, cos_phi, area, share]: &[f64; 4]| terms.density(r, cos_phi) * area - share;
        self.cells.iter().map(|cell| difference(cell).abs()).sum()
    }
}

/// The optimum for some exact profiles: the least sum of L1 errors.
///
/// The sum of √(x² + ε²) over all differences x, by least squares whose weights 1/√(x² + ε²) are made anew as ε falls,
/// is the sum of |x| in the end.
pub(crate) fn minimize_l1(exact: &[Exact]) -> Shape {
    let search = LevenbergMarquardt::new().with_ftol(TOLERANCE).with_patience(1);
    let mut problem = Problem::new(exact);
    let mut parameters = Shape::START.parameters();
    for stage in 0..STAGES {
        // From a percent of the energy in a cell to what no longer matters
        problem.reweight(&parameters, 0.01 * 0.01f64.powf(f64::from(stage) / f64::from(STAGES - 1)));
        parameters = least_squares(search, &parameters, &problem);
    }
    Shape::from_parameters(&parameters)
}

/// The differences in all cells, each times the root of its weight, and how far limits are overstepped.
struct Problem<'a> {
    exact: &'a [Exact],
    roots: Vec<f64>,
}

/// Weight of overstepping a limit by 1, in differences.
const PENALTY: f64 = 30.0;
/// Surface albedos at which limits are watched.
const WATCHED: u32 = 40;

impl<'a> Problem<'a> {
    fn new(exact: &'a [Exact]) -> Self {
        let cells = exact.iter().map(|exact| exact.cells.len()).sum();
        Self { exact, roots: vec![1.0; cells] }
    }

    fn reweight(&mut self, parameters: &[f64], epsilon: f64) {
        self.roots.fill(1.0);
        let residuals = self.residuals(parameters);
        let root = |x: &f64| x.hypot(epsilon).sqrt().recip();
        self.roots = residuals.iter().take(self.roots.len()).map(root).collect();
    }
}

impl Residuals for Problem<'_> {
    fn residuals(&self, parameters: &[f64]) -> Vec<f64> {
        let shape = Shape::from_parameters(parameters);
        let mut residuals = Vec::with_capacity(self.roots.len() + (WATCHED as usize + 1) * 15);
        let mut roots = self.roots.iter();
        for exact in self.exact {
            let terms = shape.terms(&along_normal(exact.surface_albedo), exact.degrees.to_radians().cos());
            residuals.extend(
                exact.cells.iter().zip(&mut roots).map(|(&[r, cos_phi, area, share], root)| {
                    root * (terms.density(r, cos_phi) * area - share)
                }),
            );
        }
        let watched = (0..=WATCHED).map(|i| f64::from(i) / f64::from(WATCHED));
        residuals.extend(watched.flat_map(|a| shape.margins(a)).map(|margin| PENALTY * margin.min(0.0)));
        residuals
    }

    /// By differences: the fit needs no more.
    fn jacobian(&self, parameters: &[f64]) -> DMatrix<f64> {
        const STEP: f64 = 1e-6;
        let here = self.residuals(parameters);
        let column = |j: usize| {
            let mut moved = parameters.to_vec();
            moved[j] += STEP;
            let slope = |(there, here): (&f64, &f64)| (there - here) / STEP;
            DVector::from_vec(self.residuals(&moved).iter().zip(&here).map(slope).collect())
        };
        DMatrix::from_columns(&(0..PARAMETERS).map(column).collect::<Vec<_>>())
    }
}
