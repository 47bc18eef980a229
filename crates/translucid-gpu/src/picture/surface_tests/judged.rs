//! The device's BSDF as the laws ask for it, many cases at a time.

use std::array;

use glam::Vec3;
use translucid_law::Words;
use translucid_render::internals::bsdf::{BsdfSample, BsdfValue, Lobe, MaterialTables, SurfaceParameters};

use crate::picture::evaluate::Evaluation;
use crate::program::LAWS;

/// Words of a surface, and of a case: a surface and two triples.
const SURFACE_WORDS: usize = 31;
const CASE_WORDS: usize = SURFACE_WORDS + 6;
/// Cases that a device answers at a time: their buffers are smaller than every device's largest.
const MOST_CASES: usize = 1 << 18;

/// Cells of a furnace's numbers along each of their three axes: the laws allow for the errors of the means.
pub(super) const FURNACE_SIDE: usize = 12;

/// Reads a surface whose tables are the only ones.
const READ: &str = "
fn triple_at(i: u32) -> vec3f {
    return vec3f(inputs[i], inputs[i + 1u], inputs[i + 2u]);
}
fn surface_at(i: u32) -> SurfaceParameters {
    return SurfaceParameters(
        triple_at(i), inputs[i + 3u], triple_at(i + 4u), inputs[i + 7u], triple_at(i + 8u), inputs[i + 11u],
        triple_at(i + 12u), inputs[i + 15u], triple_at(i + 16u), inputs[i + 19u], triple_at(i + 20u), inputs[i + 23u],
        triple_at(i + 24u), inputs[i + 27u], inputs[i + 28u], inputs[i + 29u], u32(inputs[i + 30u]),
    );
}
fn put(o: u32, triple: vec3f) {
    outputs[o] = triple.x;
    outputs[o + 1u] = triple.y;
    outputs[o + 2u] = triple.z;
}
";

/// The shaders of surfaces.
pub(super) const SHADERS: [&str; 3] = [LAWS[0], LAWS[1], READ];

/// Outputs of statements for cases: a surface, `surface_at(i)`, and two triples at `i + 31u` and `i + 34u`.
pub(super) fn answers<const N: usize>(
    tables: &MaterialTables,
    body: &str,
    cases: impl IntoIterator<Item = (SurfaceParameters, [f32; 3], [f32; 3])>,
) -> Vec<[f32; N]> {
    let tables: Vec<f32> = tables.sections().into_iter().flat_map(|(_, numbers)| numbers).collect();
    let widths = [CASE_WORDS, N];
    let evaluation = Evaluation { shaders: &SHADERS, body, tables: &tables, images: &[0], widths };
    let inputs: Vec<f32> =
        cases.into_iter().flat_map(|(p, a, b)| p.words().into_iter().chain(a).chain(b)).collect();
    let outputs: Vec<f32> =
        inputs.chunks(MOST_CASES * CASE_WORDS).flat_map(|inputs| evaluation.run(inputs)).collect();
    outputs.chunks_exact(N).map(|output| array::from_fn(|k| output[k])).collect()
}

fn triple(words: &[f32]) -> Vec3 {
    Vec3::new(words[0], words[1], words[2])
}

/// Values for light from directions, of surfaces that are seen from others.
pub(super) fn eval(
    tables: &MaterialTables,
    cases: impl IntoIterator<Item = (SurfaceParameters, Vec3, Vec3)>,
) -> Vec<BsdfValue> {
    let body = "
        let b = bsdf_new(0u, surface_at(i), triple_at(i + 31u));
        let value = bsdf_eval(b, 0u, triple_at(i + 34u));
        put(o, value.diffuse);
        put(o + 3u, value.specular);
        outputs[o + 6u] = value.pdf;";
    let cases = cases.into_iter().map(|(p, wo, wi)| (p, wo.to_array(), wi.to_array()));
    let value = |w: [f32; 7]| BsdfValue { diffuse: triple(&w[..3]), specular: triple(&w[3..6]), pdf: w[6] };
    answers(tables, body, cases).into_iter().map(value).collect()
}

/// Samples of surfaces that are seen from directions, by three numbers in [0, 1).
pub(super) fn sample(
    tables: &MaterialTables,
    cases: impl IntoIterator<Item = (SurfaceParameters, Vec3, [f32; 3])>,
) -> Vec<Option<BsdfSample>> {
    let body = "
        let b = bsdf_new(0u, surface_at(i), triple_at(i + 31u));
        let u = triple_at(i + 34u);
        var drawn = bsdf_draw(b, 0u, u.x, u.yz);
        if (drawn.kind == DIRECTION && drawn.lobe != MIRROR) {
            drawn = bsdf_draw_weighed(drawn, bsdf_eval(b, 0u, drawn.wi));
        }
        outputs[o] = f32(drawn.kind);
        outputs[o + 1u] = f32(drawn.lobe);
        outputs[o + 2u] = select(0.0, 1.0, drawn.is_transmitted);
        outputs[o + 3u] = drawn.pdf;
        put(o + 4u, drawn.wi);
        put(o + 7u, drawn.weight);
        put(o + 10u, drawn.diffuse_share);";
    let drawn = |w: [f32; 13]| {
        let weight = triple(&w[7..10]);
        match w[0] {
            0.0 => None,
            1.0 => Some(BsdfSample::Direction {
                wi: triple(&w[4..7]),
                weight,
                diffuse_share: triple(&w[10..]),
                pdf: w[3],
                lobe: [Lobe::Diffuse, Lobe::Glossy, Lobe::Delta][w[1] as usize],
                transmitted: w[2] == 1.0,
            }),
            2.0 => Some(BsdfSample::Subsurface { weight }),
            kind => panic!("no kind of decisions: {kind}"),
        }
    };
    let cases = cases.into_iter().map(|(p, wo, numbers)| (p, wo.to_array(), numbers));
    answers(tables, body, cases).into_iter().map(drawn).collect()
}

/// Albedos of surfaces that are seen from directions, and whether they have mirror lobes only.
pub(super) fn seen(
    tables: &MaterialTables,
    cases: impl IntoIterator<Item = (SurfaceParameters, Vec3)>,
) -> Vec<(Vec3, bool)> {
    let body = "
        let b = bsdf_new(0u, surface_at(i), triple_at(i + 31u));
        put(o, b.albedo);
        outputs[o + 3u] = select(0.0, 1.0, bsdf_is_smooth_only(b));";
    let cases = cases.into_iter().map(|(p, wo)| (p, wo.to_array(), [0.0; 3]));
    answers(tables, body, cases).into_iter().map(|w: [f32; 4]| (triple(&w[..3]), w[3] == 1.0)).collect()
}

/// T(ωi)/T̄ with the tint of one pass through the coat.
pub(super) fn entry_weight(
    tables: &MaterialTables,
    cases: impl IntoIterator<Item = (SurfaceParameters, f32)>,
) -> Vec<Vec3> {
    let body = "put(o, entry_entering(entry_new(0u, surface_at(i)), 0u, inputs[i + 31u]));";
    let cases = cases.into_iter().map(|(p, cosine)| (p, [cosine, 0.0, 0.0], [0.0; 3]));
    answers(tables, body, cases).into_iter().map(|w: [f32; 3]| triple(&w)).collect()
}
