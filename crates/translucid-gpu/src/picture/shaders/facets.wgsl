// The isotropic GGX microfacet distribution; the formulas are those of `translucid-render`'s `ggx.rs`, with facets given by their
// perceptual roughness: their width α is its square. Directions are in the shading frame, z along the normal.

const PI = 3.14159265;
const INVERSE_PI = 0.318309886;
// The square of the width below which facets are a perfect mirror.
const SMOOTH_ALPHA_SQUARED = 1e-6;

fn alpha_squared(roughness: f32) -> f32 {
    let alpha = roughness * roughness;
    return alpha * alpha;
}

fn is_mirror(roughness: f32) -> bool {
    return alpha_squared(roughness) < SMOOTH_ALPHA_SQUARED;
}

// D(h), normalized as ∫ D cosθ dω = 1.
fn facet_density(roughness: f32, h: vec3f) -> f32 {
    let squared = alpha_squared(roughness);
    // sin² from x and y keeps its digits where 1 − cos² would lose them
    let t = squared * h.z * h.z + dot(h.xy, h.xy);
    return squared / (PI * t * t);
}

// Smith's Λ for a cosine ≠ 0 to the normal, on either side.
fn facet_lambda(roughness: f32, cosine: f32) -> f32 {
    // Squares of the least cosines would vanish
    let squared = max(cosine * cosine, 1e-30);
    return 0.5 * (sqrt(1.0 + alpha_squared(roughness) * max(1.0 - squared, 0.0) / squared) - 1.0);
}

// Part of the visible facets' area that is not masked.
fn facet_masking(roughness: f32, cosine: f32) -> f32 {
    return 1.0 / (1.0 + facet_lambda(roughness, cosine));
}

// Masking and shadowing together, correlated by height.
fn facet_masking_shadowing(roughness: f32, cosine_out: f32, cosine_in: f32) -> f32 {
    return 1.0 / (1.0 + facet_lambda(roughness, cosine_out) + facet_lambda(roughness, cosine_in));
}

// Density of the facet normals that `wo` (z > 0) sees, per solid angle of h.
fn visible_density(roughness: f32, wo: vec3f, h: vec3f) -> f32 {
    return facet_masking(roughness, wo.z) * max(dot(wo, h), 0.0) * facet_density(roughness, h) / wo.z;
}

// A facet normal with that density [Dupuy & Benyoub 2023].
fn sample_visible(roughness: f32, wo: vec3f, u: vec2f) -> vec3f {
    let alpha = roughness * roughness;
    let stretched = normalize(vec3f(wo.xy * alpha, wo.z));
    let z = (1.0 - u.x) * (1.0 + stretched.z) - stretched.z;
    let r = sqrt(max(1.0 - z * z, 0.0));
    let h = vec3f(r * circle_at(u.y), z) + stretched;
    let unstretched = vec3f(h.xy * alpha, max(h.z, 0.0));
    let squared = dot(unstretched, unstretched);
    if (squared < 1e-30) {
        return vec3f(0.0, 0.0, 1.0);
    }
    return unstretched / sqrt(squared);
}

// f cosθi of a white facet lobe, and its sampling density; h is the half vector.
fn facet_reflection(roughness: f32, wo: vec3f, wi: vec3f, h: vec3f) -> vec2f {
    let density = facet_density(roughness, h) / (4.0 * wo.z);
    let lambda_out = facet_lambda(roughness, wo.z);
    return vec2f(density / (1.0 + lambda_out + facet_lambda(roughness, wi.z)), density / (1.0 + lambda_out));
}

// A direction over the upper hemisphere with density cosθ/π.
fn sample_cosine(u: vec2f) -> vec3f {
    // Never exactly on the horizon
    return vec3f(sqrt(u.x) * circle_at(u.y), sqrt(max(1.0 - u.x, 1e-7)));
}

// Cosine and sine of a part of a turn in [0, 1], within 1e-7: the built-in functions of a device may be off by 5e-4.
// Polynomials of S. L. Moshier's Cephes library, `sinf`.
fn circle_at(turn: f32) -> vec2f {
    let quarter = round(4.0 * turn);
    let x = (4.0 * turn - quarter) * (0.5 * PI);
    let s = x * x;
    let sine = x + x * s * ((-1.9515295891e-4 * s + 8.3321608736e-3) * s - 1.6666654611e-1);
    let cosine = 1.0 - 0.5 * s + s * s * ((2.443315711809948e-5 * s - 1.388731625493765e-3) * s + 4.166664568298827e-2);
    let turned = select(vec2f(cosine, sine), vec2f(-sine, cosine), (u32(quarter) & 1u) != 0u);
    return select(turned, -turned, (u32(quarter) & 2u) != 0u);
}
