//! The renderer's BSDF as the [laws](super::laws) ask for it: many cases at a time, as a device answers them.

use glam::Vec3;

use super::{Bsdf, BsdfSample, BsdfValue, EntryBsdf, MaterialTables, SurfaceParameters};

/// Cells of a furnace's numbers along each of their three axes.
pub(super) const FURNACE_SIDE: usize = 24;

/// Values for light from directions, of surfaces that are seen from others.
pub(super) fn eval(
    tables: &MaterialTables,
    cases: impl IntoIterator<Item = (SurfaceParameters, Vec3, Vec3)>,
) -> Vec<BsdfValue> {
    cases.into_iter().map(|(p, wo, wi)| Bsdf::new(&p, tables, wo).eval(wi)).collect()
}

/// Samples of surfaces that are seen from directions, by three numbers in [0, 1).
pub(super) fn sample(
    tables: &MaterialTables,
    cases: impl IntoIterator<Item = (SurfaceParameters, Vec3, [f32; 3])>,
) -> Vec<Option<BsdfSample>> {
    cases.into_iter().map(|(p, wo, [u, v0, v1])| Bsdf::new(&p, tables, wo).sample(u, [v0, v1])).collect()
}

/// Albedos of surfaces that are seen from directions, and whether they have mirror lobes only.
pub(super) fn seen(
    tables: &MaterialTables,
    cases: impl IntoIterator<Item = (SurfaceParameters, Vec3)>,
) -> Vec<(Vec3, bool)> {
    cases
        .into_iter()
        .map(|(p, wo)| Bsdf::new(&p, tables, wo))
        .map(|bsdf| (bsdf.albedo(), bsdf.is_smooth_only()))
        .collect()
}

/// T(ωi)/T̄ with the tint of one pass through the coat.
pub(super) fn entry_weight(
    tables: &MaterialTables,
    cases: impl IntoIterator<Item = (SurfaceParameters, f32)>,
) -> Vec<Vec3> {
    cases.into_iter().map(|(p, cosine)| EntryBsdf::new(&p, tables).weight(cosine)).collect()
}
