//! Directional albedos of rough interfaces, tabulated.
//!
//! Tables are over (t, ρ), ρ the perceptual roughness and
//!
//! ```text
//! t = √μ (1 + ρ) / (√μ + ρ)
//! ```
//!
//! in which shadowing at grazing angles, a function of μ/α, keeps its shape however small α = ρ² gets.

use super::dielectric::{fresnel_dielectric, refract};
use super::ggx::Ggx;
use glam::Vec3;
use std::f32::consts::PI;
use std::sync::LazyLock;

/// Nodes over t.
const COLUMNS: usize = 32;
/// Nodes over roughness.
const ROWS: usize = 24;
/// Roughness of the first row: the square root of the smallest width that is not a mirror.
const SMOOTHEST: f32 = 0.031_622_777;
/// Nodes of the quadrature over facets: cosine in the spherical cap and half turn.
const CAP_NODES: usize = 12;
const TURN_NODES: usize = 8;
/// Nodes of the quadrature over μ.
pub(super) const COSINE_NODES: usize = 32;
/// Roughnesses of averages: the mirror, then the rows.
pub(super) const AVERAGE_ROWS: usize = ROWS + 1;

/// Values over (t, ρ), bilinear between the nodes.
#[derive(Clone, Debug)]
struct Grid {
    values: Box<[[f32; COLUMNS]; ROWS]>,
}

impl Grid {
    /// Tabulates `f(μ, ρ)`.
    fn new(f: impl Fn(f32, f32) -> f32) -> Self {
        let mut values = Box::new([[0.0; COLUMNS]; ROWS]);
        for (row, line) in values.iter_mut().enumerate() {
            let roughness = row_roughness(row);
            for (column, value) in line.iter_mut().enumerate() {
                let t = column as f32 / (COLUMNS - 1) as f32;
                let root = t * roughness / (1.0 + roughness - t);
                *value = f(root * root, roughness);
            }
        }
        Self { values }
    }

    fn eval(&self, mu: f32, roughness: f32) -> f32 {
        let root = mu.sqrt();
        let t = root * (1.0 + roughness) / (root + roughness);
        let (column, s) = split(t * (COLUMNS - 1) as f32, COLUMNS);
        let (row, r) = row_position(roughness);
        let [a, b] = [&self.values[row], &self.values[row + 1]];
        let low = a[column] + (a[column + 1] - a[column]) * s;
        let high = b[column] + (b[column + 1] - b[column]) * s;
        low + (high - low) * r
    }
}

/// Cell and place in it of a coordinate in nodes.
fn split(x: f32, nodes: usize) -> (usize, f32) {
    let cell = (x as usize).min(nodes - 2);
    (cell, (x - cell as f32).clamp(0.0, 1.0))
}

fn row_roughness(row: usize) -> f32 {
    SMOOTHEST + (1.0 - SMOOTHEST) * row as f32 / (ROWS - 1) as f32
}

fn row_position(roughness: f32) -> (usize, f32) {
    split((roughness - SMOOTHEST) * ((ROWS - 1) as f32 / (1.0 - SMOOTHEST)), ROWS)
}

/// Rows of averages around a roughness: the mirror stands alone.
pub(super) fn average_position(roughness: f32) -> (usize, usize, f32) {
    if Ggx::from_roughness(roughness).is_smooth() {
        return (0, 0, 0.0);
    }
    let (row, r) = row_position(roughness);
    (row + 1, row + 2, r)
}

/// Roughness that a row of averages stands for.
pub(super) fn average_roughness(row: usize) -> f32 {
    if row == 0 { 0.0 } else { row_roughness(row - 1) }
}

/// Mean over the facets that are visible from `mu` of `f(wo, h)`.
///
/// Gauss–Legendre in the cosine over the cap of normals [Dupuy & Benyoub 2023], midpoints over half a turn.
fn mean_over_facets(
    mu: f32,
    roughness: f32,
    nodes: &[(f32, f32); CAP_NODES],
    f: impl Fn(Vec3, Vec3) -> f32,
) -> f32 {
    let mu = mu.clamp(1e-4, 1.0);
    let alpha = roughness * roughness;
    let wo = Vec3::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, mu);
    let stretched = Vec3::new(wo.x * alpha, 0.0, wo.z).normalize();
    let turns: [(f32, f32); TURN_NODES] =
        std::array::from_fn(|j| ((j as f32 + 0.5) * (PI / TURN_NODES as f32)).sin_cos());
    let mut sum = 0.0;
    for (u, weight) in nodes {
        let z = (1.0 - u) * (1.0 + stretched.z) - stretched.z;
        let r = (1.0 - z * z).max(0.0).sqrt();
        for (sin, cos) in turns {
            let h = Vec3::new((r * cos + stretched.x) * alpha, r * sin * alpha, (z + stretched.z).max(0.0));
            sum += weight * f(wo, h.normalize_or(Vec3::Z));
        }
    }
    sum / TURN_NODES as f32
}

/// Share of the light reflected at a visible facet that is not shadowed on its way out.
fn reflected_share(ggx: &Ggx, wo: Vec3, h: Vec3) -> f32 {
    passed_share(ggx, wo, 2.0 * wo.dot(h) * h.z - wo.z)
}

/// … transmitted through a visible facet.
fn transmitted_share(ggx: &Ggx, wo: Vec3, h: Vec3, eta: f32) -> f32 {
    refract(wo, h, eta).map_or(0.0, |wi| passed_share(ggx, wo, -wi.z))
}

fn passed_share(ggx: &Ggx, wo: Vec3, cos_i: f32) -> f32 {
    if cos_i <= 0.0 { 0.0 } else { ggx.masking_shadowing(wo.z, cos_i) / ggx.masking(wo.z) }
}

/// Gauss–Legendre nodes and weights on [0, 1], by Newton's method on the Legendre polynomial.
pub(super) fn gauss_legendre<const N: usize>() -> [(f32, f32); N] {
    std::array::from_fn(|i| {
        let n = N as f64;
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..8 {
            let (mut p, mut previous) = (x, 1.0);
            for k in 2..=N {
                let k = k as f64;
                (p, previous) = (((2.0 * k - 1.0) * x * p - (k - 1.0) * previous) / k, p);
            }
            slope = n * (x * p - previous) / (x * x - 1.0);
            x -= p / slope;
        }
        ((0.5 * (1.0 + x)) as f32, (1.0 / ((1.0 - x * x) * slope * slope)) as f32)
    })
}

/// Directional albedo E(μ, roughness) of a dielectric's reflection from outside:
///
/// ```text
/// E(μ) = ∫ F(o·h) D(h) G₂ / (4 μ) dωi
/// ```
///
/// exactly Fresnel's reflectance for a mirror. What is tabulated is E − F.
#[derive(Clone, Debug)]
pub struct ReflectanceTable {
    eta: f32,
    excess: Grid,
}

impl ReflectanceTable {
    /// The table of an index of refraction ≥ 1.
    #[must_use]
    pub fn new(eta: f32) -> Self {
        let nodes = gauss_legendre();
        let excess = Grid::new(|mu, roughness| {
            let ggx = Ggx::from_roughness(roughness);
            let albedo = mean_over_facets(mu, roughness, &nodes, |wo, h| {
                fresnel_dielectric(wo.dot(h), eta) * reflected_share(&ggx, wo, h)
            });
            albedo - fresnel_dielectric(mu, eta)
        });
        Self { eta, excess }
    }

    /// Index of refraction.
    #[must_use]
    pub fn eta(&self) -> f32 {
        self.eta
    }

    /// Fraction of the light to or from a direction with cosine `mu` that is reflected.
    #[must_use]
    pub fn eval(&self, mu: f32, roughness: f32) -> f32 {
        let fresnel = fresnel_dielectric(mu, self.eta);
        if Ggx::from_roughness(roughness).is_smooth() {
            return fresnel;
        }
        (fresnel + self.excess.eval(mu, roughness)).clamp(0.0, 1.0)
    }
}

/// What single scattering by the facets of a lossless metal loses: light that meets several facets.
#[derive(Clone, Debug)]
pub struct MetalTable {
    deficit: Grid,
    average: [f32; AVERAGE_ROWS],
}

impl MetalTable {
    /// The table; there is one for all metals.
    #[must_use]
    pub fn shared() -> &'static Self {
        static TABLE: LazyLock<MetalTable> = LazyLock::new(MetalTable::new);
        &TABLE
    }

    fn new() -> Self {
        let nodes = gauss_legendre();
        let deficit = Grid::new(|mu, roughness| {
            let ggx = Ggx::from_roughness(roughness);
            1.0 - mean_over_facets(mu, roughness, &nodes, |wo, h| reflected_share(&ggx, wo, h))
        });
        let average = std::array::from_fn(|row| {
            let roughness = average_roughness(row);
            if row == 0 { 0.0 } else { cosine_mean(|mu| deficit.eval(mu, roughness)) }
        });
        Self { deficit, average }
    }

    /// 1 − E(μ) of a white metal; 0 for a mirror.
    #[must_use]
    pub fn deficit(&self, mu: f32, roughness: f32) -> f32 {
        if Ggx::from_roughness(roughness).is_smooth() {
            return 0.0;
        }
        self.deficit.eval(mu, roughness).clamp(0.0, 1.0)
    }

    /// 2 ∫ (1 − E(μ)) μ dμ.
    #[must_use]
    pub fn average_deficit(&self, roughness: f32) -> f32 {
        let (low, high, r) = average_position(roughness);
        self.average[low] + (self.average[high] - self.average[low]) * r
    }
}

/// Reflected plus transmitted fraction of lossless rough glass in single scattering, seen from outside
/// and from inside.
#[derive(Clone, Debug)]
pub struct GlassTable {
    from_outside: Grid,
    from_inside: Grid,
}

impl GlassTable {
    /// The table of an index of refraction ≥ 1.
    #[must_use]
    pub fn new(eta: f32) -> Self {
        Self { from_outside: Self::side(eta), from_inside: Self::side(1.0 / eta) }
    }

    fn side(eta: f32) -> Grid {
        let nodes = gauss_legendre();
        Grid::new(|mu, roughness| {
            let ggx = Ggx::from_roughness(roughness);
            mean_over_facets(mu, roughness, &nodes, |wo, h| {
                let fresnel = fresnel_dielectric(wo.dot(h), eta);
                let transmitted = if fresnel < 1.0 { transmitted_share(&ggx, wo, h, eta) } else { 0.0 };
                fresnel * reflected_share(&ggx, wo, h) + (1.0 - fresnel) * transmitted
            })
        })
    }

    /// The fraction for light seen from outside at cosine `mu`; 1 for a mirror.
    #[must_use]
    pub fn from_outside(&self, mu: f32, roughness: f32) -> f32 {
        Self::eval(&self.from_outside, mu, roughness)
    }

    /// … seen from inside.
    #[must_use]
    pub fn from_inside(&self, mu: f32, roughness: f32) -> f32 {
        Self::eval(&self.from_inside, mu, roughness)
    }

    fn eval(side: &Grid, mu: f32, roughness: f32) -> f32 {
        if Ggx::from_roughness(roughness).is_smooth() {
            return 1.0;
        }
        side.eval(mu, roughness).clamp(0.1, 1.0)
    }
}

/// 2 ∫ f(μ) μ dμ.
fn cosine_mean(f: impl Fn(f32) -> f32) -> f32 {
    gauss_legendre::<COSINE_NODES>().iter().map(|(mu, weight)| 2.0 * mu * weight * f(*mu)).sum()
}
