//! Share of light that single scattering by the facets of rough glass keeps.

use std::sync::OnceLock;

use translucid_law::{GLASS_LEVELS, Ggx, fresnel_dielectric, refract, scaled_ior};

use super::reflectance_table::{FacetQuadrature, FineGrid, TableGrid, mirrored_cos, passed_share};

/// Reflected plus transmitted fraction of lossless rough glass in single scattering, by which its lobes
/// are divided [after Turquin 2019, "Practical multiple scattering compensation for microfacet models"].
///
/// There are tables for the index and for those with ¼, 1/16 and 1/64 of its F₀; weights of the
/// reflection between interpolate in √F₀, below the last is used.
///
/// Greatest error over η in [1.2, 2.4]: 0.005 from outside and 0.015 from inside at weight 1, twice that
/// for weights down to 1/64 at η = 1.5.
#[derive(Clone, Debug)]
pub struct GlassTable {
    eta: f32,
    // For F₀ · 4⁻ᵏ, computed when first asked for.
    levels: [OnceLock<Sides>; LEVELS],
}

/// Number of levels of F₀.
const LEVELS: usize = GLASS_LEVELS as usize;

#[derive(Clone, Debug)]
struct Sides {
    from_outside: FineGrid,
    from_inside: FineGrid,
}

impl GlassTable {
    /// The table of an index of refraction ≥ 1; it is computed when first asked for.
    pub fn new(eta: f32) -> Self {
        Self { eta, levels: [const { OnceLock::new() }; LEVELS] }
    }

    /// The fraction of a level.
    pub(super) fn eval(&self, level: u32, is_inside: bool, mu: f32, roughness: f32) -> f32 {
        let sides = self.level(level as usize);
        let grid = if is_inside { &sides.from_inside } else { &sides.from_outside };
        grid.eval(mu, roughness)
    }

    fn level(&self, k: usize) -> &Sides {
        self.levels[k].get_or_init(|| Sides::new(scaled_ior(self.eta, 0.25_f32.powi(k as i32))))
    }

    /// The tables of all levels, each from outside and from inside.
    pub(super) fn numbers(&self) -> Vec<f32> {
        let of = |sides: &Sides| [sides.from_outside.values(), sides.from_inside.values()].concat();
        (0..LEVELS).flat_map(|k| -> Vec<f32> { of(self.level(k)) }).collect()
    }
}

impl Sides {
    fn new(eta: f32) -> Self {
        // From inside, total reflection breaks the integrand: it needs more nodes.
        Self { from_outside: kept::<12, 8>(eta), from_inside: kept::<24, 16>(1.0 / eta) }
    }
}

fn kept<const CAP: usize, const TURN: usize>(eta: f32) -> FineGrid {
    let facets = FacetQuadrature::<CAP, TURN>::new();
    TableGrid::new(|mu, roughness| {
        let ggx = Ggx::from_roughness(roughness);
        facets.mean(mu, roughness, |wo, h| {
            let fresnel = fresnel_dielectric(wo.dot(h), eta);
            let transmitted = refract(wo, h, eta).map_or(0.0, |wi| passed_share(&ggx, wo, -wi.z));
            fresnel * passed_share(&ggx, wo, mirrored_cos(wo, h)) + (1.0 - fresnel) * transmitted
        })
    })
}

#[cfg(test)]
mod tests {
    use translucid_law::glass_kept;

    use super::super::brute_force::{COSINES, ROUGHNESSES, brute_force};
    use super::super::layers::{AskedTables, MaterialTables};
    use super::*;

    /// Greatest difference from brute force, outside and inside.
    fn worst(eta: f64, weight: f32) -> (f64, f64) {
        let tables = MaterialTables::new(eta as f32, 1.0);
        let tables = AskedTables::new(&tables, 0.0);
        let scaled = f64::from(scaled_ior(eta as f32, weight));
        let worst = |is_inside: bool, eta: f64| {
            let mut worst = 0.0_f64;
            for rho in ROUGHNESSES {
                for mu in COSINES {
                    let (r, t) = brute_force(mu, rho, eta);
                    let kept = glass_kept(&tables, is_inside, mu as f32, rho as f32, weight);
                    worst = worst.max((f64::from(kept) - r - t).abs());
                }
            }
            worst
        };
        (worst(false, scaled), worst(true, 1.0 / scaled))
    }

    #[test]
    fn glass_table_meets_brute_force() {
        for eta in [1.2, 1.5, 2.4] {
            let (outside, inside) = worst(eta, 1.0);
            assert!(outside < 5e-3 && inside < 1.5e-2, "{eta}: {outside} {inside}");
        }
    }

    #[test]
    fn glass_table_interpolates_weights() {
        for weight in [0.02, 0.1, 0.5] {
            let (outside, inside) = worst(1.5, weight);
            assert!(outside < 1e-2 && inside < 3e-2, "{weight}: {outside} {inside}");
        }
    }
}
