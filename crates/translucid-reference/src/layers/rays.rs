//! Rays of light through media of different indices of refraction, as nodes of a quadrature rule.
//!
//! Refraction keeps p = η sin θ: a ray is p, and each face only reflects and transmits it. The element of flux
//! η² μ dμ = ½ d(p²) is the same in all media, so that flux is what a ray carries.
//! Between two indices all cosines μ = √(1 − p²/η²) and reflectances are smooth in t with p² = b² − (b² − a²)t²: at p = b
//! they begin like √(b² − p²). So the rule is Gauss and Legendre's in t, piece by piece; of one medium in μ itself.

use translucid_profile::quadrature::gauss_legendre;

use super::{Ground, Layers};

/// Weight of a beam's own ray among the rays of diffuse light, in p²: negligible, but its square root is not.
const BEAM_WEIGHT: f64 = 1e-10;

/// Rays in order of p, from the normal on.
#[derive(Clone, Debug)]
pub(super) struct Rays {
    /// p².
    squares: Vec<f64>,
    /// Roots of the weights d(p²), in which amplitudes are flux over root.
    roots: Vec<f64>,
    /// Index of the beam's ray.
    beam: Option<usize>,
    /// Pieces of the rule.
    pieces: usize,
}

impl Rays {
    /// So many rays between two indices, and one of a beam of the given p².
    pub(super) fn new(layers: &Layers, count: usize, beam: Option<f64>) -> Self {
        let rule = gauss_legendre(count);
        let mut nodes = Vec::new();
        let (mut low, indices) = (0.0, squared_indices(layers));
        let pieces = indices.len();
        for high in indices {
            nodes.extend(rule.iter().map(|(x, weight)| {
                let t = 0.5 * (1.0 + x);
                [high - (high - low) * t * t, (high - low) * t * weight]
            }));
            low = high;
        }
        nodes.extend(beam.map(|square| [square, BEAM_WEIGHT * low]));
        nodes.sort_by(|a, b| a[0].total_cmp(&b[0]));
        Self {
            squares: nodes.iter().map(|node| node[0]).collect(),
            roots: nodes.iter().map(|node| node[1].sqrt()).collect(),
            beam: beam.and_then(|square| nodes.iter().position(|node| node[0] == square)),
            pieces,
        }
    }

    /// Number of rays that a medium has: the first ones.
    pub(super) fn count(&self, eta: f64) -> usize {
        self.squares.partition_point(|square| cosine_squared(*square, eta) > 1e-14)
    }

    /// Number of Legendre polynomials that the first so many rays resolve: twice as many as they are by Gauss's rule in μ,
    /// and fewer by one of several pieces, where higher ones do harm.
    pub(super) fn moments(&self, count: usize) -> usize {
        let count = count - usize::from(self.beam.is_some_and(|beam| beam < count));
        count + count / self.pieces
    }

    /// Cosine of a ray that the medium has.
    pub(super) fn cosine(&self, ray: usize, eta: f64) -> f64 {
        cosine_squared(self.squares[ray], eta).sqrt()
    }

    /// Weight dμ of a ray in a medium.
    pub(super) fn cosine_weight(&self, ray: usize, eta: f64) -> f64 {
        self.roots[ray] * self.roots[ray] / (2.0 * eta * eta * self.cosine(ray, eta))
    }

    /// √ of the weight d(p²).
    pub(super) fn root(&self, ray: usize) -> f64 {
        self.roots[ray]
    }

    /// Index of the beam's ray.
    pub(super) fn beam(&self) -> Option<usize> {
        self.beam
    }

    /// Flux of all rays from their amplitudes.
    pub(super) fn flux(&self, amplitudes: &[f64]) -> f64 {
        amplitudes.iter().zip(&self.roots).map(|(amplitude, root)| amplitude * root).sum()
    }
}

/// Different η², rising.
pub(super) fn squared_indices(layers: &Layers) -> Vec<f64> {
    let mut squares = vec![layers.eta_above * layers.eta_above];
    squares.extend(layers.layers.iter().map(|layer| layer.eta * layer.eta));
    if let Ground::Medium { eta } = layers.ground {
        squares.push(eta * eta);
    }
    squares.sort_by(f64::total_cmp);
    squares.dedup();
    squares
}

/// 1 − p²/η².
fn cosine_squared(square: f64, eta: f64) -> f64 {
    1.0 - square / (eta * eta)
}
