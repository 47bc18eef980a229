//! Directional albedos of rough interfaces, tabulated as `translucid-law` reads them.

use std::f32::consts::PI;
use std::sync::LazyLock;

use glam::Vec3;
use translucid_law::{
    Ggx, SMOOTHEST, average_at, deficit_at, fresnel_dielectric, grid_value, reflectance_at,
};
use translucid_profile::quadrature;

/// Nodes of the tables over t and over roughness.
const COLUMNS: usize = translucid_law::COLUMNS as usize;
const ROWS: usize = translucid_law::ROWS as usize;
/// Nodes of the quadrature over facets: cosine in the cap of normals, half a turn.
const CAP_NODES: usize = 14;
const TURN_NODES: usize = 12;
/// Nodes of the quadrature over μ.
pub(super) const COSINE_NODES: usize = 32;
/// Roughnesses of averages: the mirror, then the rows.
pub(super) const AVERAGE_ROWS: usize = translucid_law::AVERAGE_ROWS as usize;

/// Values over (t, ρ), bilinear between `C` × `R` nodes.
#[derive(Clone, Debug)]
pub(super) struct TableGrid<const C: usize, const R: usize> {
    values: Box<[[f32; C]; R]>,
}

/// The resolution of the tables here.
pub(super) type FineGrid = TableGrid<COLUMNS, ROWS>;

impl<const C: usize, const R: usize> TableGrid<C, R> {
    /// Tabulates `f(μ, ρ)`.
    pub(super) fn new(f: impl Fn(f32, f32) -> f32) -> Self {
        let mut values = Box::new([[0.0; C]; R]);
        for (row, line) in values.iter_mut().enumerate() {
            let roughness = Self::row_roughness(row);
            for (column, value) in line.iter_mut().enumerate() {
                let t = column as f32 / (C - 1) as f32;
                let root = t * roughness / (1.0 + roughness - t);
                *value = f(root * root, roughness);
            }
        }
        Self { values }
    }

    /// The value at a cosine and a roughness that is not a mirror's.
    pub(super) fn eval(&self, mu: f32, roughness: f32) -> f32 {
        grid_value(self.values(), C as u32, R as u32, mu, roughness)
    }

    /// All values, row by row.
    pub(super) fn values(&self) -> &[f32] {
        self.values.as_flattened()
    }

    /// Roughness of a row.
    pub(super) fn row_roughness(row: usize) -> f32 {
        SMOOTHEST + (1.0 - SMOOTHEST) * row as f32 / (R - 1) as f32
    }
}

/// Roughness that a row of averages stands for.
pub(super) fn average_roughness(row: usize) -> f32 {
    if row == 0 { 0.0 } else { FineGrid::row_roughness(row - 1) }
}

/// 2 ∫ f(μ) μ dμ.
pub(super) fn cosine_mean(f: impl Fn(f32) -> f32) -> f32 {
    gauss_legendre::<COSINE_NODES>().iter().map(|(mu, weight)| 2.0 * mu * weight * f(*mu)).sum()
}

/// Quadrature over the facets that are visible from a direction.
///
/// Gauss–Legendre in the cosine over the cap of normals [Dupuy & Benyoub 2023], midpoints over half a turn.
pub(super) struct FacetQuadrature<const CAP: usize, const TURN: usize> {
    cap: [(f32, f32); CAP],
    turn: [(f32, f32); TURN],
}

impl<const CAP: usize, const TURN: usize> FacetQuadrature<CAP, TURN> {
    pub(super) fn new() -> Self {
        let step = PI / TURN as f32;
        Self { cap: gauss_legendre(), turn: std::array::from_fn(|j| libm::sincosf((j as f32 + 0.5) * step)) }
    }

    /// Mean of `f(wo, h)` over the facets h visible from the cosine `mu`.
    pub(super) fn mean(&self, mu: f32, roughness: f32, f: impl Fn(Vec3, Vec3) -> f32) -> f32 {
        let mu = mu.clamp(1e-4, 1.0);
        let alpha = roughness * roughness;
        let wo = Vec3::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, mu);
        let stretched = Vec3::new(wo.x * alpha, 0.0, wo.z).normalize();
        let mut sum = 0.0;
        for (u, weight) in &self.cap {
            let z = (1.0 - u) * (1.0 + stretched.z) - stretched.z;
            let r = (1.0 - z * z).max(0.0).sqrt();
            for (sin, cos) in self.turn {
                let h =
                    Vec3::new((r * cos + stretched.x) * alpha, r * sin * alpha, (z + stretched.z).max(0.0));
                sum += weight * f(wo, h.normalize_or(Vec3::Z));
            }
        }
        sum / TURN as f32
    }
}

/// The quadrature of reflection.
pub(super) type ReflectionQuadrature = FacetQuadrature<CAP_NODES, TURN_NODES>;

/// Cosine of the direction that a facet mirrors to `wo`.
pub(super) fn mirrored_cos(wo: Vec3, h: Vec3) -> f32 {
    2.0 * wo.dot(h) * h.z - wo.z
}

/// Unshadowed share of the light that a visible facet sends to a direction of cosine `cos_i`.
pub(super) fn passed_share(ggx: &Ggx, wo: Vec3, cos_i: f32) -> f32 {
    if cos_i <= 0.0 { 0.0 } else { ggx.masking_shadowing(wo.z, cos_i) / ggx.masking(wo.z) }
}

/// Gauss–Legendre nodes and weights on [0, 1].
pub(super) fn gauss_legendre<const N: usize>() -> [(f32, f32); N] {
    let rule = quadrature::gauss_legendre(N);
    std::array::from_fn(|i| ((0.5 * (1.0 + rule[i].0)) as f32, (0.5 * rule[i].1) as f32))
}

/// Directional albedo E(μ, roughness) of a dielectric's reflection from outside:
///
/// ```text
/// E(μ) = ∫ F(o·h) D(h) G₂ / (4 μ) dωi
/// ```
///
/// exactly Fresnel's reflectance for a mirror. The table holds E − F; the greatest error for indices
/// in [1.2, 4] is 0.0016 at μ > 0.02 and 0.0029 below.
#[derive(Clone, Debug)]
pub struct ReflectanceTable {
    eta: f32,
    excess: FineGrid,
    average: [f32; AVERAGE_ROWS],
}

impl ReflectanceTable {
    /// The table of an index of refraction ≥ 1.
    pub fn new(eta: f32) -> Self {
        let facets = ReflectionQuadrature::new();
        let excess = TableGrid::new(|mu, roughness| {
            let ggx = Ggx::from_roughness(roughness);
            let albedo = facets.mean(mu, roughness, |wo, h| {
                fresnel_dielectric(wo.dot(h), eta) * passed_share(&ggx, wo, mirrored_cos(wo, h))
            });
            albedo - fresnel_dielectric(mu, eta)
        });
        let mut table = Self { eta, excess, average: [0.0; AVERAGE_ROWS] };
        table.average = std::array::from_fn(|row| cosine_mean(|mu| table.eval(mu, average_roughness(row))));
        table
    }

    /// Index of refraction.
    pub fn eta(&self) -> f32 {
        self.eta
    }

    /// Fraction of the light to or from a direction with cosine `mu` that is reflected.
    pub fn eval(&self, mu: f32, roughness: f32) -> f32 {
        reflectance_at(self.excess.values(), self.eta, mu, roughness)
    }

    /// The table, then the averages.
    pub(super) fn numbers(&self) -> Vec<f32> {
        [self.excess.values(), &self.average].concat()
    }

    /// 2 ∫ E(μ) μ dμ.
    pub fn average(&self, roughness: f32) -> f32 {
        average_at(&self.average, roughness)
    }
}

/// Share of light that single scattering by the facets of a lossless metal loses: light that meets several facets.
#[derive(Clone, Debug)]
pub struct MetalTable {
    deficit: FineGrid,
    average: [f32; AVERAGE_ROWS],
}

impl MetalTable {
    /// The table; there is one for all metals.
    pub fn shared() -> &'static Self {
        static TABLE: LazyLock<MetalTable> = LazyLock::new(MetalTable::new);
        &TABLE
    }

    fn new() -> Self {
        let facets = ReflectionQuadrature::new();
        let deficit = TableGrid::new(|mu, roughness| {
            let ggx = Ggx::from_roughness(roughness);
            1.0 - facets.mean(mu, roughness, |wo, h| passed_share(&ggx, wo, mirrored_cos(wo, h)))
        });
        let mut table = Self { deficit, average: [0.0; AVERAGE_ROWS] };
        table.average =
            std::array::from_fn(|row| cosine_mean(|mu| table.deficit(mu, average_roughness(row))));
        table
    }

    /// 1 − E(μ) of a white metal; 0 for a mirror.
    pub fn deficit(&self, mu: f32, roughness: f32) -> f32 {
        deficit_at(self.deficit.values(), mu, roughness)
    }

    /// The table, then the averages.
    pub(super) fn numbers(&self) -> Vec<f32> {
        [self.deficit.values(), &self.average].concat()
    }

    /// 2 ∫ (1 − E(μ)) μ dμ.
    pub fn average_deficit(&self, roughness: f32) -> f32 {
        average_at(&self.average, roughness)
    }
}

#[cfg(test)]
mod tests {
    use super::super::brute_force::{COSINES, ROUGHNESSES, brute_force};
    use super::*;

    /// Greatest difference from brute force over the cosines up from `lowest`.
    fn worst(eta: f64, lowest: f64) -> f64 {
        let table = ReflectanceTable::new(eta as f32);
        let mut worst = 0.0_f64;
        for rho in ROUGHNESSES {
            for mu in COSINES.into_iter().filter(|mu| *mu >= lowest) {
                let (e, _) = brute_force(mu, rho, eta);
                worst = worst.max((f64::from(table.eval(mu as f32, rho as f32)) - e).abs());
            }
        }
        worst
    }

    #[test]
    fn reflectance_meets_brute_force() {
        for eta in [1.2, 1.5, 2.4, 4.0] {
            let (usual, grazing) = (worst(eta, 0.02), worst(eta, 0.0));
            assert!(usual < 1.8e-3 && grazing < 3.2e-3, "{eta}: {usual} {grazing}");
        }
    }

    #[test]
    fn reflectance_of_mirrors_and_without_index_step_is_exact() {
        let glass = ReflectanceTable::new(1.5);
        let nothing = ReflectanceTable::new(1.0);
        for mu in [0.0, 0.001, 0.1, 0.5, 1.0] {
            assert_eq!(glass.eval(mu, 0.0), fresnel_dielectric(mu, 1.5));
            for rho in [0.0, 0.1, 0.5, 1.0] {
                assert_eq!(nothing.eval(mu, rho), 0.0);
            }
        }
    }

    #[test]
    fn reflectance_average_is_fresnel_average_for_mirrors() {
        // 2 ∫ F μ dμ = 0.0918 at n = 1.5 [Walsh 1926].
        let average = ReflectanceTable::new(1.5).average(0.0);
        let midpoints: f32 = (0..100_000)
            .map(|i| {
                let mu = (i as f32 + 0.5) / 1e5;
                2e-5 * mu * fresnel_dielectric(mu, 1.5)
            })
            .sum();
        assert!(
            (average - midpoints).abs() < 2e-5 && (average - 0.0918).abs() < 5e-5,
            "{average} {midpoints}"
        );
    }
}
