//! Laws of the light from below a surface, as tests of the renderer's own choices.

use glam::Vec3;

use super::laws::{Random, direction, white};
use super::{Bsdf, BsdfSample, EntryBsdf, MaterialTables, SurfaceParameters};

/// With light from below followed beside, the surface scatters the same light, and is drawn by every sample.
///
/// 4 × 3 comparisons of the means of 2¹⁶ samples; five standard errors alarm falsely once in about 1e5.
#[test]
fn split_below_changes_no_mean() {
    let tables = MaterialTables::new(1.5, 1.6);
    let base = SurfaceParameters { subsurface_weight: 1.0, specular_roughness: 0.4, ..white() };
    let mixed = SurfaceParameters { subsurface_weight: 0.5, coat_weight: 0.7, coat_roughness: 0.3, ..base };
    for (m, p) in [base, mixed].iter().enumerate() {
        for mu in [0.9, 0.2] {
            let whole = Bsdf::new(p, &tables, direction(mu));
            let mut split = whole;
            let below = split.split_below().expect("light comes from below");
            let mut random = Random::of(m as u64);
            let [mut sums, mut squares, mut drawn] = [[0.0_f64; 2]; 3];
            let n = 1 << 16;
            for _ in 0..n {
                let [u, v0, v1] = random.triple();
                for (k, bsdf) in [&whole, &split].into_iter().enumerate() {
                    if let Some(BsdfSample::Direction { wi, weight, pdf, .. }) = bsdf.sample(u, [v0, v1]) {
                        let value = f64::from(weight.y);
                        (sums[k], squares[k], drawn[k]) =
                            (sums[k] + value, squares[k] + value * value, drawn[k] + 1.0);
                        assert!((bsdf.eval(wi).pdf - pdf).abs() <= 1e-3 * pdf);
                    }
                }
            }
            let n = f64::from(n);
            let means = sums.map(|sum| sum / n);
            let errors = [0, 1].map(|k| (squares[k] / n - means[k] * means[k]) / n);
            let allowed = 5.0 * errors.iter().sum::<f64>().sqrt();
            assert!((means[0] - means[1]).abs() < allowed, "material {m}, cos {mu}: {means:?} ± {allowed}");
            // But for directions below the horizon
            assert!(drawn[1] > 0.9 * n && errors[1] < errors[0], "{drawn:?} {errors:?}");
            // Followed with this probability, light from below has the weight that it has on average when drawn
            let (low, high) = (below.weight * below.probability, whole.below());
            assert!(low.abs_diff_eq(high, 1e-6), "{low} {high}");
        }
    }
    let bare = SurfaceParameters { subsurface_weight: 0.0, ..base };
    assert!(Bsdf::new(&bare, &tables, direction(0.5)).split_below().is_none());
}

#[test]
fn subsurface_without_extent_is_the_matte_lobe() {
    // Exit factor × A × entry factor of active channels equals the diffuse value of inactive ones.
    let mut random = Random::of(23);
    let indices = [1.5, 1.6];
    let tables = MaterialTables::new(indices[0], indices[1]);
    let mut compared = 0;
    while compared < 2000 {
        let p = SurfaceParameters {
            subsurface_weight: 0.1 + 0.9 * random.next(),
            base_color: Vec3::ZERO,
            subsurface_active: Vec3::ONE,
            ..random.material(indices)
        };
        let wo = direction(0.01 + 0.99 * random.next());
        let wi = direction(0.01 + 0.99 * random.next());
        let bsdf = Bsdf::new(&p, &tables, wo);
        let Some(BsdfSample::Subsurface { weight }) = bsdf.sample(0.0, [0.5; 2]) else { continue };
        let mut hits = 0;
        let n = 4000;
        for i in 0..n {
            let sample = bsdf.sample((i as f32 + 0.5) / n as f32, [0.5; 2]);
            hits += i32::from(matches!(sample, Some(BsdfSample::Subsurface { .. })));
        }
        if hits < 100 {
            continue;
        }
        let chance = hits as f32 / n as f32;
        let spread = weight * chance * p.surface_albedo * EntryBsdf::new(&p, &tables).eval(wi.z);
        let flat = Bsdf::new(&SurfaceParameters { subsurface_active: Vec3::ZERO, ..p }, &tables, wo)
            .eval(wi)
            .diffuse;
        let allowed = spread.max_element() * (1.0 / hits as f32 + 1e-4) + 1e-6;
        assert!((spread - flat).abs().max_element() <= allowed, "{p:?} {wo} {wi}: {spread} {flat}");
        compared += 1;
    }
}

#[test]
fn entry_sample_is_weighted_by_its_value() {
    let tables = MaterialTables::new(1.5, 1.6);
    let p = SurfaceParameters { specular_roughness: 0.2, coat_weight: 1.0, coat_roughness: 0.5, ..white() };
    let entry = EntryBsdf::new(&p, &tables);
    let (wi, weight) = entry.sample([0.3, 0.6]);
    assert!((weight * EntryBsdf::pdf(wi.z) - entry.eval(wi.z)).length() < 1e-6);
}
