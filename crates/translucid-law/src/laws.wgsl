// Written by the example `laws` of `translucid-law` from its sources: change those.

// Below this cosine the direction seen from is bent up: the shading normal lies, or the ray grazes.
const LEAST_COSINE: f32 = 1e-4;

// Index steps below this do not bend light; F₀ is below 2.5e-7.
const SAME_INDEX: f32 = 1e-3;

// Least albedo by which a lobe that exists is chosen, so that table errors cannot hide it.
const LEAST_LOBE: f32 = 1e-4;

// Kind of a [BsdfDraw]: no light comes.
const NOTHING: u32 = 0u;

// Kind of a [BsdfDraw]: light comes from a direction.
const DIRECTION: u32 = 1u;

// Kind of a [BsdfDraw]: light comes from under the surface.
const BELOW: u32 = 2u;

// Lobe over the whole hemisphere.
const DIFFUSE: u32 = 0u;

// Lobe of rough facets.
const GLOSSY: u32 = 1u;

// Lobe of a mirror: no other technique can find its direction.
const MIRROR: u32 = 2u;

// f·|cosθi| of a pair of directions [1/sr], without mirror lobes and without subsurface scattering.
struct BsdfValue {
    // Matte reflection.
    diffuse: vec3f,
    // Density with which the direction is drawn, choice of lobe included [1/sr].
    pdf: f32,
    // Reflection by coat, dielectric and metal, and rough transmission.
    specular: vec3f,
}

// No light.
fn bsdf_value_none() -> BsdfValue {
    return BsdfValue(vec3f(0.0), 0.0, vec3f(0.0));
}

// A decision where light comes from.
struct BsdfDraw {
    // [NOTHING], [DIRECTION] or [BELOW].
    kind: u32,
    // Where it comes from.
    wi: vec3f,
    // f|cosθi| / pdf over all lobes that share the direction; of light from below, what leaves, without A.
    weight: vec3f,
    // Part of weight that is matte reflection, per channel in [0, 1].
    diffuse_share: vec3f,
    // Density [1/sr], 0 for a mirror.
    pdf: f32,
    // [DIFFUSE], [GLOSSY] or [MIRROR].
    lobe: u32,
    // Light crosses the surface.
    is_transmitted: bool,
}

// A decision without density.
fn bsdf_draw_of(kind: u32, wi: vec3f, weight: vec3f, lobe: u32, is_transmitted: bool) -> BsdfDraw {
    return BsdfDraw(kind, wi, weight, vec3f(0.0), 0.0, lobe, is_transmitted);
}

// No light.
fn bsdf_draw_none() -> BsdfDraw {
    return bsdf_draw_of(NOTHING, vec3f(0.0), vec3f(0.0), DIFFUSE, false);
}

// A direction with the value and density of all lobes there.
fn bsdf_draw_weighed(own: BsdfDraw, value: BsdfValue) -> BsdfDraw {
    if (!is_finite(value.pdf) || value.pdf <= 0.0) {
        return bsdf_draw_none();
    }
    let f = value.diffuse + value.specular;
    let share = value.diffuse / max(f, vec3f(1.1754944e-38));
    var draw = own;
    draw.weight = f / value.pdf;
    draw.diffuse_share = select(vec3f(0.0), share, f > vec3f(0.0));
    draw.pdf = value.pdf;
    return draw;
}

// Probabilities of the sampling strategies; they sum to 1, or to 0 for a black surface.
struct Strategies {
    // The coat.
    coat: f32,
    // Facets of the base.
    facets: f32,
    // Straight on, through glass without a step of the index or a thin wall.
    straight: f32,
    // The matte base.
    diffuse: f32,
    // Light from below.
    subsurface: f32,
}

// Chances in proportion to these.
fn strategies_normalized(own: Strategies) -> Strategies {
    let sum = own.coat + own.facets + own.straight + own.diffuse + own.subsurface;
    let scale = select(0.0, 1.0 / sum, sum >= 1.1754944e-38);
    return Strategies(scaled_chance(own.coat, scale), scaled_chance(own.facets, scale), scaled_chance(own.straight, scale), scaled_chance(own.diffuse, scale), scaled_chance(own.subsurface, scale));
}

// A scaled chance, or 0: a number whose inverse is infinite makes no weight.
fn scaled_chance(chance: f32, scale: f32) -> f32 {
    let scaled = chance * scale;
    if (scaled < 1.1754944e-38) {
        return 0.0;
    } else {
        return scaled;
    }
}

// Clear part of a material.
struct Glass {
    // Mixture weight.
    weight: f32,
    // Index of the other side over that of the side of wo.
    eta: f32,
    // Inverse of the single-scattering albedo: scales both lobes to lose nothing [after Turquin 2019]. Of a thin wall that
    // of transmission.
    compensation: f32,
    // Tint of reflection; of a thin wall its compensated reflectance.
    reflection_tint: vec3f,
    // Tint of a crossing, the coat's one-way tint included; of a thin wall its transmittance, and both ways.
    transmission_tint: vec3f,
    // No step of the index, or a thin wall: light goes straight on.
    is_straight: bool,
}

// Light at a facet: reflected and transmitted parts and the chance that reflection is sampled.
struct FacetSplit {
    // Share that is reflected.
    reflected: vec3f,
    // Share that is transmitted.
    transmitted: vec3f,
    // Chance of the former.
    reflect_probability: f32,
}

// The BSDF of a surface point seen from a direction.
struct Bsdf {
    // The interfaces.
    layers: Layers,
    // Directions are mirrored to the side of wo: wo.z > 0.
    wo: vec3f,
    // −1 where they are mirrored, else 1.
    side: f32,
    // Share that passes the coat toward wo.
    coat_transmittance: f32,
    // Tint of two passes through the coat.
    coat_tint: vec3f,
    // Weight of the opaque dielectric's reflection.
    dielectric: vec3f,
    // Weight of the metal.
    metal_weight: f32,
    // The metal's reflectance.
    metal: MetalFresnel,
    // Reflection between facets without the factor of wi: f = facet_exchange · deficit(wi).
    facet_exchange: vec3f,
    // The clear part.
    glass: Glass,
    // true for a thin wall.
    is_thin: bool,
    // Diffuse transmission of a thin wall without the factors of wi, A' (…) T(ωo) / (π T̄).
    thin_matte: vec3f,
    // Probability of sampling it.
    thin_probability: f32,
    // Facets of clear transmission through a thin wall.
    thin_facets: Ggx,
    // A (…) T(ωo) / (π T̄).
    matte: vec3f,
    // T(ωi) is 1, and does not follow the interface.
    matte_is_bare: bool,
    // The weight of light from below.
    subsurface: vec3f,
    // How lobes are chosen.
    strategies: Strategies,
    // About the hemispherical–directional reflectance, transmission and subsurface color included.
    albedo: vec3f,
}

// The BSDF seen from wo; wo.z < 0 is from inside.
//
// An opaque surface seen from inside looks as from outside; of one that is partly clear, the opaque part is bare from
// inside, and the coat only tints. A thin-walled one has no inside.
fn bsdf_new(tables: u32, parameters: SurfaceParameters, wo: vec3f) -> Bsdf {
    let p = surface_parameters_clamped(parameters);
    let glass_weight = (1.0 - p.metalness) * p.transmission_weight;
    let is_inside = wo.z < 0.0 && glass_weight > 0.0 && !surface_parameters_is_thin(p);
    let side = select(1.0, -1.0, wo.z < 0.0);
    let unlit = bsdf_unlit(p, lifted(vec3f(wo.x, wo.y, wo.z * side)), side);
    if (is_inside) {
        return bsdf_filled_from_inside(unlit, tables, p, glass_weight);
    }
    return bsdf_filled_from_outside(unlit, tables, p, glass_weight);
}

// All that does not depend on the side, without lobes.
fn bsdf_unlit(p: SurfaceParameters, wo: vec3f, side: f32) -> Bsdf {
    return Bsdf(Layers(p.specular_weight, p.specular_roughness, p.coat_weight, p.coat_roughness), wo, side, 1.0, vec3f(1.0), vec3f(0.0), 0.0, metal_fresnel_new(p.base_color, p.specular_color), vec3f(0.0), Glass(0.0, 1.0, 1.0, p.specular_color, p.transmission_tint * surface_parameters_coat_tint_one_way(p), true), surface_parameters_is_thin(p), vec3f(0.0), 0.0, Ggx(0.0), vec3f(0.0), false, vec3f(0.0), Strategies(0.0, 0.0, 0.0, 0.0, 0.0), vec3f(0.0));
}

fn bsdf_filled_from_outside(own: Bsdf, tables: u32, p: SurfaceParameters, glass_weight: f32) -> Bsdf {
    var b = own;
    let mu = b.wo.z;
    let opaque = (1.0 - p.metalness) * (1.0 - p.transmission_weight);
    let coat = layers_coat_reflectance(b.layers, tables, mu);
    let specular = layers_specular_reflectance(b.layers, tables, mu);
    let transmittance = layers_transmittance_under(b.layers, tables, coat, mu);
    b.coat_transmittance = 1.0 - coat;
    b.coat_tint = surface_parameters_coat_tint(p);
    b.dielectric = p.specular_color * (opaque * p.specular_weight);
    b.metal_weight = p.metalness * p.specular_weight;
    b.facet_exchange = bsdf_exchange(b, tables);
    let eta = scaled_ior(specular_ior(tables), p.specular_weight);
    if (surface_parameters_is_thin(p)) {
        b.thin_facets = ggx_from_roughness(roughness_through(p.specular_roughness, eta));
        b.glass = bsdf_slab(b, tables, p, glass_weight, eta);
    } else {
        b.glass = bsdf_body(b, tables, p, glass_weight, eta);
    }
    let average = layers_average_transmittance(b.layers, tables);
    let matte_albedo = b.coat_tint * surface_parameters_matte_albedo(p);
    b.matte = matte_albedo * (opaque * transmittance * 0.31830987 / average);
    let below = opaque * p.subsurface_weight * transmittance;
    b.subsurface = surface_parameters_coat_tint_one_way(p) * below * p.subsurface_active;
    let matte = matte_albedo * (opaque * transmittance);
    let reflection = (p.specular_color * (opaque * specular) + bsdf_metal_albedo(b, tables)) * b.coat_tint;
    if (!surface_parameters_is_thin(p)) {
        let subsurface = b.coat_tint * surface_parameters_subsurface_albedo_active(p) * below;
        return bsdf_chosen(b, tables, coat, reflection, matte, subsurface);
    }
    let passed = b.coat_tint * p.thin_albedo * below;
    let reflected = b.glass.reflection_tint * b.coat_tint * b.glass.weight;
    b = bsdf_chosen(b, tables, coat, reflection + reflected, matte + passed, vec3f(0.0));
    let exchanged = mean(b.facet_exchange) * 3.1415927 * layers_average_metal_exchange(b.layers, tables);
    let all = mean(matte) + mean(passed) + exchanged;
    if (all > 0.0) {
        b.thin_probability = b.strategies.diffuse * min(mean(passed) / all, 0.99);
    }
    b.thin_matte = passed * (0.31830987 / average);
    b.strategies.diffuse -= b.thin_probability;
    return b;
}

fn bsdf_filled_from_inside(own: Bsdf, tables: u32, p: SurfaceParameters, glass_weight: f32) -> Bsdf {
    var b = own;
    let opaque = (1.0 - p.metalness) * (1.0 - p.transmission_weight);
    b.layers.coat_weight = 0.0;
    b.metal_weight = p.metalness * p.specular_weight;
    b.facet_exchange = bsdf_exchange(b, tables);
    let eta = 1.0 / scaled_ior(specular_ior(tables), p.specular_weight);
    b.glass = bsdf_body(b, tables, p, glass_weight, eta);
    let bare = surface_parameters_matte_albedo(p) + surface_parameters_subsurface_albedo_active(p) * p.subsurface_weight;
    b.matte = bare * (opaque * 0.31830987);
    b.matte_is_bare = true;
    return bsdf_chosen(b, tables, 0.0, bsdf_metal_albedo(b, tables), bare * opaque, vec3f(0.0));
}

// The reflection of light between the metal's facets, without the factor of wi.
fn bsdf_exchange(own: Bsdf, tables: u32) -> vec3f {
    let roughness = own.layers.specular_roughness;
    if (own.metal_weight == 0.0 || ggx_is_smooth(ggx_from_roughness(roughness))) {
        return vec3f(0.0);
    }
    let average = layers_average_metal_exchange(own.layers, tables);
    if (average <= 1e-6) {
        return vec3f(0.0);
    }
    let out = layers_metal_exchange_under(own.layers, tables, 1.0 - own.coat_transmittance, own.wo.z);
    let color = metal_fresnel_multiple_scattering(own.metal, 1.0 - average_metal_deficit(tables, roughness));
    return own.coat_tint * color * (own.metal_weight * out * 0.31830987 / average);
}

// About the albedo of the metal in single scattering.
fn bsdf_metal_albedo(own: Bsdf, tables: u32) -> vec3f {
    if (own.metal_weight == 0.0) {
        return vec3f(0.0);
    }
    let roughness = own.layers.specular_roughness;
    let single = 1.0 - metal_deficit(tables, own.wo.z, roughness);
    let color = mix(metal_fresnel_reflectance(own.metal, own.wo.z), metal_fresnel_average(own.metal), roughness);
    return color * (own.metal_weight * single);
}

// The clear part of a thin-walled surface.
fn bsdf_slab(own: Bsdf, tables: u32, p: SurfaceParameters, weight: f32, eta: f32) -> Glass {
    let mu = own.wo.z;
    let slab = slab_new(mu, eta, p.transmission_tint);
    let roughness = roughness_through(p.specular_roughness, eta);
    let under_coat = own.coat_transmittance * layers_specular_reflectance(own.layers, tables, mu);
    let loss = layers_specular_loss(own.layers, tables, mu);
    var kept = 1.0;
    if (loss > 0.0) {
        kept = max(1.0 - loss / under_coat, 0.5);
    }
    var glass = own.glass;
    glass.weight = weight;
    glass.compensation = 1.0 / (1.0 - metal_deficit(tables, mu, roughness));
    let faces = 1.0 - metal_deficit(tables, mu, p.specular_roughness);
    glass.reflection_tint = slab.reflectance * p.specular_color / (kept * faces);
    glass.transmission_tint = slab.transmittance * own.coat_tint;
    return glass;
}

// The clear part of a body.
fn bsdf_body(own: Bsdf, tables: u32, p: SurfaceParameters, weight: f32, eta: f32) -> Glass {
    var glass = own.glass;
    glass.weight = weight;
    glass.eta = eta;
    glass.is_straight = abs(eta - 1.0) < SAME_INDEX;
    if (weight > 0.0 && !glass.is_straight) {
        let mu = own.wo.z;
        let single = glass_kept(tables, eta <= 1.0, mu, p.specular_roughness, p.specular_weight);
        let kept = 1.0 - layers_specular_loss(own.layers, tables, mu) / (own.coat_transmittance * single);
        glass.compensation = 1.0 / (single * max(kept, 0.5));
    }
    return glass;
}

// Chooses lobes in proportion to their albedos at wo; the arguments are without the coat's shadow on specular lobes.
fn bsdf_chosen(own: Bsdf, tables: u32, coat: f32, reflection: vec3f, matte: vec3f, below: vec3f) -> Bsdf {
    var b = own;
    let exchange = b.facet_exchange * (3.1415927 * layers_average_metal_exchange(b.layers, tables));
    let glass = bsdf_glass_albedo(b, tables);
    let has_step = !b.glass.is_straight;
    let under_coat = b.coat_transmittance;
    let has_coat = b.layers.coat_weight > 0.0 && coat_ior(tables) > 1.0;
    let has_facets = b.metal_weight > 0.0 || (greatest(b.dielectric) > 0.0 && specular_ior(tables) > 1.0) || (b.glass.weight > 0.0 && (has_step || b.is_thin));
    var facets = mean(reflection);
    if (has_step) {
        facets += mean(glass);
    }
    let strategies = Strategies(select(0.0, max(coat, LEAST_LOBE), has_coat), select(0.0, max(facets, LEAST_LOBE) * under_coat, has_facets), select(mean(glass) * under_coat, 0.0, has_step), mean(matte) + mean(exchange), mean(below));
    b.strategies = strategies_normalized(strategies);
    let under = (reflection + glass) * under_coat;
    b.albedo = min(vec3f(coat) + under + exchange + matte + below, vec3f(1.0));
    return b;
}

// Approximate albedo of glass: reflection and transmission.
fn bsdf_glass_albedo(own: Bsdf, tables: u32) -> vec3f {
    let glass = own.glass;
    if (glass.weight == 0.0) {
        return vec3f(0.0);
    }
    var f = 0.0;
    if (!glass.is_straight) {
        if (glass.eta > 1.0) {
            f = layers_specular_reflectance(own.layers, tables, own.wo.z);
        } else {
            f = fresnel_dielectric(own.wo.z, glass.eta);
        }
    }
    return (glass.reflection_tint * own.coat_tint * f + glass.transmission_tint * (1.0 - f)) * glass.weight;
}

// Facets of the base.
fn bsdf_base_facets(own: Bsdf) -> Ggx {
    return ggx_from_roughness(own.layers.specular_roughness);
}

// Facets of the coat.
fn bsdf_coat_facets(own: Bsdf) -> Ggx {
    return ggx_from_roughness(own.layers.coat_roughness);
}

// Returns true if light sampling finds nothing: only mirror lobes, subsurface scattering or black.
fn bsdf_is_smooth_only(own: Bsdf) -> bool {
    return own.strategies.diffuse == 0.0 && (own.strategies.coat == 0.0 || ggx_is_smooth(bsdf_coat_facets(own))) && (own.strategies.facets == 0.0 || ggx_is_smooth(bsdf_base_facets(own)));
}

// The share of light that comes from below, of a sample on average; 0 in the channels that are not active. Does not
// include A.
fn bsdf_below(own: Bsdf) -> vec3f {
    if (own.strategies.subsurface > 0.0) {
        return own.subsurface;
    } else {
        return vec3f(0.0);
    }
}

// The share of light that goes straight through, or, through a rough thin wall, about straight.
fn bsdf_straight(own: Bsdf) -> vec3f {
    return own.glass.transmission_tint * (own.glass.weight * own.coat_transmittance);
}

// The share of light that goes straight through a thin wall.
fn bsdf_straight_through_wall(own: Bsdf) -> vec3f {
    let is_straight = own.is_thin && ggx_is_smooth(own.thin_facets) && own.strategies.straight > 0.0;
    if (is_straight) {
        return bsdf_straight(own);
    } else {
        return vec3f(0.0);
    }
}

// Value and density for light from wi.
fn bsdf_eval(own: Bsdf, tables: u32, wi: vec3f) -> BsdfValue {
    let z = wi.z * own.side;
    if (z > 0.0) {
        return bsdf_eval_reflection(own, tables, vec3f(wi.x, wi.y, z));
    }
    if (z < 0.0) {
        if (own.is_thin) {
            return bsdf_eval_through(own, tables, vec3f(wi.x, wi.y, -z));
        }
        return bsdf_eval_transmission(own, tables, vec3f(wi.x, wi.y, z));
    }
    return bsdf_value_none();
}

fn bsdf_eval_reflection(own: Bsdf, tables: u32, wi: vec3f) -> BsdfValue {
    var value = bsdf_value_none();
    let mu = wi.z;
    let h = unit_or(own.wo + wi, vec3f(0.0, 0.0, 1.0));
    let coat = layers_coat_reflectance(own.layers, tables, mu);
    let under_coat = min(own.coat_transmittance, 1.0 - coat);
    let coat_facets = bsdf_coat_facets(own);
    if (own.strategies.coat > 0.0 && !ggx_is_smooth(coat_facets)) {
        let lobe = ggx_reflection(coat_facets, own.wo, wi, h);
        let f = own.layers.coat_weight * fresnel_dielectric(dot(own.wo, h), coat_ior(tables));
        value.specular += vec3f(f * lobe[0]);
        value.pdf += own.strategies.coat * lobe[1];
    }
    let facets = bsdf_base_facets(own);
    if (own.strategies.facets > 0.0 && !ggx_is_smooth(facets)) {
        let lobe = ggx_reflection(facets, own.wo, wi, h);
        let split = bsdf_split_at_facet(own, tables, dot(own.wo, h));
        value.specular += split.reflected * (lobe[0] * under_coat);
        value.pdf += own.strategies.facets * split.reflect_probability * lobe[1];
    }
    if (own.strategies.diffuse > 0.0) {
        if (!is_zero_vector(own.facet_exchange)) {
            let exchange = layers_metal_exchange_under(own.layers, tables, coat, mu);
            value.specular += own.facet_exchange * (exchange * mu);
        }
        var passed = 1.0;
        if (!own.matte_is_bare) {
            passed = layers_transmittance_under(own.layers, tables, coat, mu);
        }
        value.diffuse = own.matte * (passed * mu);
        value.pdf += own.strategies.diffuse * mu * 0.31830987;
    }
    return value;
}

fn bsdf_eval_transmission(own: Bsdf, tables: u32, wi: vec3f) -> BsdfValue {
    let eta = own.glass.eta;
    let facets = bsdf_base_facets(own);
    if (own.glass.weight == 0.0 || own.glass.is_straight || ggx_is_smooth(facets)) {
        return bsdf_value_none();
    }
    var h = unit_or(own.wo + wi * eta, vec3f(0.0));
    if (h.z < 0.0) {
        h = -h;
    }
    let cos_o = dot(own.wo, h);
    let cos_i = dot(wi, h);
    if (cos_o <= 0.0 || cos_i >= 0.0) {
        return bsdf_value_none();
    }
    let split = bsdf_split_at_facet(own, tables, cos_o);
    let root = cos_o + eta * cos_i;
    let jacobian = eta * eta * -cos_i / (root * root);
    let pdf = ggx_visible_density(facets, own.wo, h) * jacobian;
    let shadowing = ggx_masking_shadowing(facets, own.wo.z, wi.z) / ggx_masking(facets, own.wo.z);
    if (!is_finite(pdf)) {
        return bsdf_value_none();
    }
    return BsdfValue(vec3f(0.0), own.strategies.facets * (1.0 - split.reflect_probability) * pdf, split.transmitted * (shadowing * pdf * own.coat_transmittance));
}

// Value and density for light from behind a thin wall; wi is its direction mirrored to this side.
fn bsdf_eval_through(own: Bsdf, tables: u32, wi: vec3f) -> BsdfValue {
    let mu = wi.z;
    var value = BsdfValue(own.thin_matte * (layers_transmittance(own.layers, tables, mu) * mu), own.thin_probability * mu * 0.31830987, vec3f(0.0));
    if (own.strategies.straight > 0.0 && !ggx_is_smooth(own.thin_facets)) {
        let h = unit_or(own.wo + wi, vec3f(0.0, 0.0, 1.0));
        let lobe = ggx_reflection(own.thin_facets, own.wo, wi, h);
        value.specular = bsdf_straight(own) * (lobe[0] * own.glass.compensation);
        value.pdf += own.strategies.straight * lobe[1];
    }
    return value;
}

// Reflectance and transmittance of a base facet seen at a cosine, the coat's tints but not its shadow included.
fn bsdf_split_at_facet(own: Bsdf, tables: u32, cosine: f32) -> FacetSplit {
    let glass = own.glass;
    var reflected = vec3f(0.0);
    var transmitted = vec3f(0.0);
    if (greatest(own.dielectric) > 0.0) {
        reflected += own.dielectric * fresnel_dielectric(cosine, specular_ior(tables));
    }
    if (own.metal_weight > 0.0) {
        reflected += metal_fresnel_reflectance(own.metal, cosine) * own.metal_weight;
    }
    if (glass.weight > 0.0) {
        if (own.is_thin) {
            reflected += glass.reflection_tint * glass.weight;
        } else if (!glass.is_straight) {
            let f = fresnel_dielectric(cosine, glass.eta);
            let weight = glass.weight * glass.compensation;
            reflected += glass.reflection_tint * (f * weight);
            transmitted = glass.transmission_tint * ((1.0 - f) * weight);
        }
    }
    reflected *= own.coat_tint;
    let r = mean(reflected);
    let t = mean(transmitted);
    return FacetSplit(reflected, transmitted, select(1.0, r / (r + t), t > 0.0));
}

// Chooses where light comes from; u and v are uniform in [0, 1). The weight of a direction that is no mirror's is that
// of all lobes there, see [BsdfDraw::weighed].
fn bsdf_draw(own: Bsdf, tables: u32, u: f32, v: vec2f) -> BsdfDraw {
    let chances = own.strategies;
    var left = u;
    if (left < chances.subsurface) {
        return bsdf_draw_of(BELOW, vec3f(0.0), own.subsurface / chances.subsurface, DIFFUSE, false);
    }
    left -= chances.subsurface;
    if (left < chances.diffuse) {
        return bsdf_toward(own, sample_cosine(v), DIFFUSE);
    }
    left -= chances.diffuse;
    if (left < chances.coat) {
        return bsdf_draw_coat(own, tables, v);
    }
    left -= chances.coat;
    if (left < chances.straight) {
        return bsdf_draw_straight(own, v);
    }
    left -= chances.straight;
    if (left < own.thin_probability) {
        return bsdf_toward(own, through(sample_cosine(v)), DIFFUSE);
    }
    left -= own.thin_probability;
    if (chances.facets > 0.0) {
        return bsdf_draw_facets(own, tables, clamp(left / chances.facets, 0.0, 1.0), v);
    }
    return bsdf_draw_none();
}

fn bsdf_draw_coat(own: Bsdf, tables: u32, v: vec2f) -> BsdfDraw {
    let facets = bsdf_coat_facets(own);
    if (ggx_is_smooth(facets)) {
        let f = own.layers.coat_weight * fresnel_dielectric(own.wo.z, coat_ior(tables));
        return bsdf_mirror(own, mirrored(own.wo, vec3f(0.0, 0.0, 1.0)), vec3f(f / own.strategies.coat));
    }
    let wi = mirrored(own.wo, ggx_sample_visible(facets, own.wo, v));
    if (wi.z <= 0.0) {
        return bsdf_draw_none();
    }
    return bsdf_toward(own, wi, GLOSSY);
}

fn bsdf_draw_straight(own: Bsdf, v: vec2f) -> BsdfDraw {
    if (own.is_thin && !ggx_is_smooth(own.thin_facets)) {
        let wi = mirrored(own.wo, ggx_sample_visible(own.thin_facets, own.wo, v));
        if (wi.z <= 0.0) {
            return bsdf_draw_none();
        }
        return bsdf_toward(own, through(wi), GLOSSY);
    }
    let share = own.glass.weight * own.coat_transmittance / own.strategies.straight;
    return bsdf_mirror(own, -own.wo, own.glass.transmission_tint * share);
}

fn bsdf_draw_facets(own: Bsdf, tables: u32, u: f32, v: vec2f) -> BsdfDraw {
    let facets = bsdf_base_facets(own);
    let is_smooth = ggx_is_smooth(facets);
    var h = vec3f(0.0, 0.0, 1.0);
    if (!is_smooth) {
        h = ggx_sample_visible(facets, own.wo, v);
    }
    let split = bsdf_split_at_facet(own, tables, dot(own.wo, h));
    let chance = own.strategies.facets;
    let is_reflected = u < split.reflect_probability || split.reflect_probability >= 1.0;
    var wi = mirrored(own.wo, h);
    var part = split.reflected / (chance * split.reflect_probability);
    if (!is_reflected) {
        let bent = refracted(own.wo, h, own.glass.eta);
        if (!bent.exists) {
            return bsdf_draw_none();
        }
        wi = bent.direction;
        part = split.transmitted / (chance * (1.0 - split.reflect_probability));
    }
    if (is_smooth) {
        return bsdf_mirror(own, wi, part * own.coat_transmittance);
    }
    if ((wi.z > 0.0) != is_reflected) {
        return bsdf_draw_none();
    }
    return bsdf_toward(own, wi, GLOSSY);
}

// A draw of a mirror lobe; wi on the side of wo.
fn bsdf_mirror(own: Bsdf, wi: vec3f, weight: vec3f) -> BsdfDraw {
    return bsdf_draw_of(DIRECTION, vec3f(wi.x, wi.y, wi.z * own.side), weight, MIRROR, wi.z < 0.0);
}

// A direction on the side of wo, without its weight.
fn bsdf_toward(own: Bsdf, local: vec3f, lobe: u32) -> BsdfDraw {
    let wi = normalize(local);
    return bsdf_draw_of(DIRECTION, vec3f(wi.x, wi.y, wi.z * own.side), vec3f(0.0), lobe, wi.z < 0.0);
}

// How light enters a scattering medium at a point: the factor T(ωi) / (π T̄).
struct Entry {
    layers: Layers,
    // The tint of one pass through the coat.
    tint: vec3f,
    inverse_average: f32,
}

// The factor of a surface point.
fn entry_new(tables: u32, parameters: SurfaceParameters) -> Entry {
    let p = surface_parameters_clamped(parameters);
    let layers = Layers(p.specular_weight, p.specular_roughness, p.coat_weight, p.coat_roughness);
    let average = layers_average_transmittance(layers, tables);
    return Entry(layers, surface_parameters_coat_tint_one_way(p), 1.0 / average);
}

// T(ωi)/T̄ with the tint of one pass through the coat: the share of a radiance that enters.
fn entry_entering(own: Entry, tables: u32, cos_i: f32) -> vec3f {
    return own.tint * (layers_transmittance(own.layers, tables, min(cos_i, 1.0)) * own.inverse_average);
}

// A direction at least [LEAST_COSINE] over the horizon.
fn lifted(wo: vec3f) -> vec3f {
    if (wo.z >= LEAST_COSINE) {
        return wo;
    }
    return unit_or(vec3f(wo.x, wo.y, LEAST_COSINE), vec3f(0.0, 0.0, 1.0));
}

// A direction on the other side of the surface.
fn through(w: vec3f) -> vec3f {
    return vec3f(w.x, w.y, -w.z);
}

// The mean of a color's channels.
fn mean(c: vec3f) -> f32 {
    return (c.x + c.y + c.z) * (1.0 / 3.0);
}

// Light that travels in one direction through a disk.
struct BeamLight {
    // Center of the disk.
    origin: vec3f,
    // Direction of travel.
    direction: vec3f,
    // Radius of the disk.
    radius: f32,
    // Irradiance on a surface that faces the beam.
    irradiance: vec3f,
    // Power (luminance).
    power: f32,
}

fn beam_light_at(at: u32) -> BeamLight {
    return BeamLight(table_vector(at + 0u), table_vector(at + 3u), tables[at + 6u], table_vector(at + 7u), tables[at + 10u]);
}

// The irradiance.
fn beam_light_importance(own: BeamLight, receiver: Receiver) -> f32 {
    let light = beam_light_draw(own, receiver.point);
    return luminance(light.radiance) * receiver_cosine(receiver, light.direction);
}

// The one direction that the light comes from, if the point is within the beam.
fn beam_light_draw(own: BeamLight, point: vec3f) -> LightDraw {
    let offset = point - own.origin;
    let along = dot(offset, own.direction);
    let across = length(offset - own.direction * along);
    if (along > 0.0 && across <= own.radius) {
        return LightDraw(-own.direction, along, own.irradiance, 1.0);
    }
    return light_draw_none();
}

// Schlick's approximation with a tint at 82°:
//
// F(μ) = F₀ + (1 − F₀)(1 − μ)⁵ − a μ (1 − μ)⁶,    a such that F(1/7) = tint · F_Schlick(1/7)
//
// [Kutz, Hašan & Edmondson 2021, "Novel aspects of the Adobe Standard Material", Sec. 2.3].
struct MetalFresnel {
    // F₀.
    f0: vec3f,
    // a.
    a: vec3f,
}

// Reflectance f0 at normal incidence and tint at 82°, both in [0, 1]; tint 1 is Schlick's curve.
fn metal_fresnel_new(f0: vec3f, tint: vec3f) -> MetalFresnel {
    let mu = 1.0 / 7.0;
    let m = 1.0 - mu;
    let m5 = m * m * m * m * m;
    let schlick = f0 + (vec3f(1.0) - f0) * m5;
    return MetalFresnel(f0, schlick * (vec3f(1.0) - tint) / (mu * (m5 * m)));
}

// Reflectance at the cosine mu in [0, 1].
fn metal_fresnel_reflectance(own: MetalFresnel, mu: f32) -> vec3f {
    let m = clamp(1.0 - mu, 0.0, 1.0);
    let m2 = m * m;
    let m5 = m2 * m2 * m;
    return max(own.f0 + (vec3f(1.0) - own.f0) * m5 - own.a * ((1.0 - m) * m5 * m), vec3f(0.0));
}

// Cosine-weighted mean 2 ∫ F(μ) μ dμ = F₀ + (1 − F₀)/21 − a/126, or 0 where that is negative: [Self::reflectance]
// clips the dip of dark metals with a dark tint.
fn metal_fresnel_average(own: MetalFresnel) -> vec3f {
    return max(own.f0 + (vec3f(1.0) - own.f0) / 21.0 - own.a / 126.0, vec3f(0.0));
}

// Reflectance of the light that leaves after several reflections between facets, when
// facet_albedo of it leaves at each [Kulla & Conty 2017, "Revisiting Physically Based Shading at Imageworks"].
fn metal_fresnel_multiple_scattering(own: MetalFresnel, facet_albedo: f32) -> vec3f {
    let f = metal_fresnel_average(own);
    return f * f * facet_albedo / (vec3f(1.0) - f * (1.0 - facet_albedo));
}

// A cone whose light falls, between two angles from its axis, by the smooth step 3x² − 2x³ in the cosine.
struct SpotCone {
    // Unit axis.
    axis: vec3f,
    // Cosine of the angle up to which the light is even.
    cos_inner: f32,
    // Cosine of the angle from which on there is none; below −1 where it shines to all sides.
    cos_outer: f32,
}

fn spot_cone_at(at: u32) -> SpotCone {
    return SpotCone(table_vector(at + 0u), tables[at + 3u], tables[at + 4u]);
}

// Share of the light on the axis at the cosine of an angle from it.
fn spot_cone_falloff(own: SpotCone, cos: f32) -> f32 {
    if (cos >= own.cos_inner) {
        return 1.0;
    }
    let width = own.cos_inner - own.cos_outer;
    if (cos <= own.cos_outer || width <= 0.0) {
        return 0.0;
    }
    let x = clamp((cos - own.cos_outer) / width, 0.0, 1.0);
    if (x > 0.0) {
        return x * x * (3.0 - 2.0 * x);
    } else {
        return 0.0;
    }
}

// Solid angle over 2π, at most 2.
fn spot_cone_one_minus_cos(own: SpotCone) -> f32 {
    return 1.0 - max(own.cos_outer, -1.0);
}

// Fresnel reflectance of unpolarized light.
//
// cos ≥ 0 is the cosine on the side where the light is, eta the index of the other side over that of
// this side. 1 beyond the critical angle, exactly 0 at eta = 1 [Born & Wolf, *Principles of Optics*, 1.5.2].
fn fresnel_dielectric(cos: f32, eta: f32) -> f32 {
    if (eta == 1.0) {
        return 0.0;
    }
    let mu = clamp(cos, 0.0, 1.0);
    let g2 = (eta - 1.0) * (eta + 1.0) + mu * mu;
    if (g2 <= 0.0) {
        return 1.0;
    }
    let g = sqrt(g2);
    let eta2 = eta * eta;
    let s = (mu - g) / (mu + g);
    let p = (eta2 * mu - g) / (eta2 * mu + g);
    return 0.5 * (s * s + p * p);
}

// Index whose reflectance at normal incidence is weight times that of ior ≥ 1
// [OpenPBR Surface 1.1, "Dielectric base"]; 1 at weight = 0.
fn scaled_ior(ior: f32, weight: f32) -> f32 {
    let root = (ior - 1.0) / (ior + 1.0) * sqrt(weight);
    return (1.0 + root) / (1.0 - root);
}

// Direction refracted at a facet with normal h on the side of wo.
struct Refracted {
    // Unit vector.
    direction: vec3f,
    // false beyond the critical angle, where there is no direction.
    exists: bool,
}

// Refracts at a facet with normal h on the side of wo.
fn refracted(wo: vec3f, h: vec3f, eta: f32) -> Refracted {
    let cos_o = dot(wo, h);
    let g2 = (eta - 1.0) * (eta + 1.0) + cos_o * cos_o;
    if (g2 <= 0.0) {
        return Refracted(vec3f(0.0), false);
    }
    let wi = (-wo + h * (cos_o - sqrt(g2))) / eta;
    return Refracted(normalize(wi), true);
}

// Mirror direction of wo about h.
fn mirrored(wo: vec3f, h: vec3f) -> vec3f {
    return h * (2.0 * dot(wo, h)) - wo;
}

// Direction in a cone about axis, uniform in solid angle.
//
// The cone is given by 1 − cos α: cos α itself is no more than 1 for cones under half a minute of arc.
fn uniform_cone(axis: vec3f, one_minus_cos: f32, v: vec2f) -> vec3f {
    let x = v[0] * one_minus_cos;
    return polar(axis, 1.0 - x, sqrt(max(x * (2.0 - x), 0.0)), circle(v[1]));
}

// Solid-angle density of [uniform_cone].
fn uniform_cone_pdf(one_minus_cos: f32) -> f32 {
    return 1.0 / (2.0 * 3.1415927 * one_minus_cos);
}

// Direction with density cos θ/π about a unit normal, by the concentric map of the square on the disc
// [Shirley & Chiu 1997, "A Low Distortion Map Between Disk and Square"].
fn cosine_hemisphere(normal: vec3f, v: vec2f) -> vec3f {
    let a = 2.0 * v[0] - 1.0;
    let b = 2.0 * v[1] - 1.0;
    var radius = 0.0;
    var angle = 0.0;
    if (abs(a) > abs(b)) {
        radius = a;
        angle = 0.7853982 * (b / a);
    } else if (b != 0.0) {
        radius = b;
        angle = 1.5707964 - 0.7853982 * (a / b);
    }
    return polar(normal, sqrt(max(1.0 - radius * radius, 0.0)), radius, circle_at(angle));
}

// Area-preserving map of the unit square to the unit disk [Shirley & Chiu 1997].
fn concentric_disk(u: vec2f) -> vec2f {
    let a = 2.0 * u[0] - 1.0;
    let b = 2.0 * u[1] - 1.0;
    if (a == 0.0 && b == 0.0) {
        return vec2f(0.0, 0.0);
    }
    var radius = b;
    var angle = 2.0 * 0.7853982 - 0.7853982 * a / b;
    if (abs(a) > abs(b)) {
        radius = a;
        angle = 0.7853982 * b / a;
    }
    let around = circle_at(angle);
    return vec2f(radius * around.x, radius * around.y);
}

// A direction over the upper hemisphere with density cosθ/π.
fn sample_cosine(v: vec2f) -> vec3f {
    let around = circle(v[1]);
    let r = sqrt(v[0]);
    return vec3f(r * around.x, r * around.y, sqrt(max(1.0 - v[0], 1e-7)));
}

// Uniform direction.
fn uniform_sphere(v: vec2f) -> vec3f {
    return uniform_cone(vec3f(0.0, 0.0, 1.0), 2.0, v);
}

// Unit vector by the cosine and sine of its angle to the axis, and those of its angle about it.
fn polar(axis: vec3f, cos: f32, sin: f32, around: vec2f) -> vec3f {
    let frame = frame_from_normal(axis);
    return unit_or(frame_to_world(frame, vec3f(sin * around.x, sin * around.y, cos)), axis);
}

// 1 − cos α from sin² α, exact for small angles.
fn one_minus_cos(sin2: f32) -> f32 {
    return sin2 / (1.0 + sqrt(max(1.0 - sin2, 0.0)));
}

// Barycentric coordinates of a triangle's second and third corner, uniform in area
// [Heitz 2019, "A Low-Distortion Map Between Triangle and Square"].
fn uniform_triangle(v: vec2f) -> vec2f {
    if (v[1] > v[0]) {
        return vec2f(0.5 * v[0], v[1] - 0.5 * v[0]);
    }
    return vec2f(v[0] - 0.5 * v[1], 0.5 * v[1]);
}

// Discs of a smaller angular radius [degrees] are sampled as one direction: single-precision directions lie 3e-6 degrees apart,
// and a disc needs many of them.
const LEAST_ANGULAR_RADIUS: f32 = 0.01;

// A part of the sky, or one direction, that shines.
struct DistantLight {
    // Unit vector toward the light.
    direction: vec3f,
    // Irradiance on a surface that faces it.
    irradiance: vec3f,
    // sin² of the disc's angular radius; 0 of one direction.
    sin2: f32,
    // 1 − cos of it.
    one_minus_cos: f32,
}

fn distant_light_at(at: u32) -> DistantLight {
    return DistantLight(table_vector(at + 0u), table_vector(at + 3u), tables[at + 6u], tables[at + 7u]);
}

// Returns true if it fills a solid angle.
fn distant_light_is_disc(own: DistantLight) -> bool {
    return own.sin2 > 0.0;
}

// Estimate of the irradiance; 0 only below the horizon.
fn distant_light_importance(own: DistantLight, receiver: Receiver) -> f32 {
    return luminance(own.irradiance) * receiver_cosine_to_cone(receiver, own.direction, sqrt(own.sin2));
}

// Draws a direction of the disc.
fn distant_light_direction_of_disc(own: DistantLight, v: vec2f) -> vec3f {
    return uniform_cone(own.direction, own.one_minus_cos, v);
}

// Radiance from a direction: E/(π sin² α) within the disc.
fn distant_light_radiance(own: DistantLight, direction: vec3f) -> vec3f {
    if (!distant_light_covers(own, direction)) {
        return vec3f(0.0);
    }
    return own.irradiance / (3.1415927 * own.sin2);
}

// Solid-angle density of [direction_of_disc](Self::direction_of_disc).
fn distant_light_pdf(own: DistantLight, direction: vec3f) -> f32 {
    if (!distant_light_covers(own, direction)) {
        return 0.0;
    }
    return uniform_cone_pdf(own.one_minus_cos);
}

// Tests the chord, whose square is 2(1 − cos θ): a cosine is not exact enough for the rim of the sun.
fn distant_light_covers(own: DistantLight, direction: vec3f) -> bool {
    let chord = direction - own.direction;
    return distant_light_is_disc(own) && dot(chord, chord) <= 2.0 * own.one_minus_cos;
}

// A right-handed orthonormal frame whose z axis is a surface normal.
struct Frame {
    // First tangent.
    x: vec3f,
    // Second tangent.
    y: vec3f,
    // Normal.
    z: vec3f,
}

// A frame around a unit normal, continuous except at −z
// [Duff et al. 2017, "Building an Orthonormal Basis, Revisited"].
fn frame_from_normal(z: vec3f) -> Frame {
    let side = sign_of(z.z);
    let a = -1.0 / (side + z.z);
    let b = z.x * z.y * a;
    let x = vec3f(1.0 + side * z.x * z.x * a, side * b, -side * z.x);
    let y = vec3f(b, side + z.y * z.y * a, -z.y);
    return Frame(x, y, z);
}

// Local coordinates of a world direction.
fn frame_to_local(own: Frame, v: vec3f) -> vec3f {
    return vec3f(dot(v, own.x), dot(v, own.y), dot(v, own.z));
}

// World coordinates of a local direction.
fn frame_to_world(own: Frame, v: vec3f) -> vec3f {
    return own.x * v.x + own.y * v.y + own.z * v.z;
}

// Widths below this are treated as a perfect mirror.
const SMOOTH_ALPHA: f32 = 1e-3;

// GGX (Trowbridge–Reitz) facets of width α with Smith's height-correlated shadowing
// [Walter et al. 2007; Heitz 2014, "Understanding the Masking-Shadowing Function", eq. 99].
struct Ggx {
    // α².
    alpha2: f32,
}

// Facets of a perceptual roughness in [0, 1]: α = roughness².
fn ggx_from_roughness(roughness: f32) -> Ggx {
    let alpha = roughness * roughness;
    return Ggx(alpha * alpha);
}

// Returns true for a mirror: α < 0.001.
fn ggx_is_smooth(own: Ggx) -> bool {
    return own.alpha2 < SMOOTH_ALPHA * SMOOTH_ALPHA;
}

// Density of facet normals D(h), normalized as ∫ D cosθ dω = 1.
fn ggx_density(own: Ggx, h: vec3f) -> f32 {
    let t = own.alpha2 * h.z * h.z + (h.x * h.x + h.y * h.y);
    return own.alpha2 / (3.1415927 * t * t);
}

// Smith's Λ for a direction with cosine cos ≠ 0 to the normal, on either side.
fn ggx_lambda(own: Ggx, cos: f32) -> f32 {
    let cos2 = max(cos * cos, 1e-30);
    return 0.5 * (sqrt(1.0 + own.alpha2 * max(1.0 - cos2, 0.0) / cos2) - 1.0);
}

// Part of the visible facets' area that is not masked.
fn ggx_masking(own: Ggx, cos: f32) -> f32 {
    return 1.0 / (1.0 + ggx_lambda(own, cos));
}

// Masking and shadowing together, correlated by height.
fn ggx_masking_shadowing(own: Ggx, cos_o: f32, cos_i: f32) -> f32 {
    return 1.0 / (1.0 + ggx_lambda(own, cos_o) + ggx_lambda(own, cos_i));
}

// Density D_v(h) of the normals that wo (z > 0) sees, per solid angle of h.
fn ggx_visible_density(own: Ggx, wo: vec3f, h: vec3f) -> f32 {
    return ggx_masking(own, wo.z) * max(dot(wo, h), 0.0) * ggx_density(own, h) / wo.z;
}

// A facet normal with density [Ggx::visible_density]
// [Dupuy & Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps"].
fn ggx_sample_visible(own: Ggx, wo: vec3f, v: vec2f) -> vec3f {
    let alpha = sqrt(own.alpha2);
    let stretched = normalize(vec3f(wo.x * alpha, wo.y * alpha, wo.z));
    let z = (1.0 - v[0]) * (1.0 + stretched.z) - stretched.z;
    let r = sqrt(max(1.0 - z * z, 0.0));
    let around = circle(v[1]);
    let h = vec3f(r * around.x, r * around.y, z) + stretched;
    return unit_or(vec3f(h.x * alpha, h.y * alpha, max(h.z, 0.0)), vec3f(0.0, 0.0, 1.0));
}

// f cosθi of a white lobe that mirrors at these facets, and its sampling density; h is the half vector.
fn ggx_reflection(own: Ggx, wo: vec3f, wi: vec3f, h: vec3f) -> vec2f {
    let density = ggx_density(own, h) / (4.0 * wo.z);
    let lambda_o = ggx_lambda(own, wo.z);
    let lambda_i = ggx_lambda(own, wi.z);
    return vec2f(density / (1.0 + lambda_o + lambda_i), density / (1.0 + lambda_o));
}

// The interfaces of one surface point.
struct Layers {
    // Factor on the dielectric's reflectance.
    specular_weight: f32,
    // Perceptual roughness of the dielectric.
    specular_roughness: f32,
    // Strength of the coat; 0 where there is none.
    coat_weight: f32,
    // Perceptual roughness of the coat.
    coat_roughness: f32,
}

// Directional albedo of the coat.
fn layers_coat_reflectance(own: Layers, tables: u32, mu: f32) -> f32 {
    if (own.coat_weight == 0.0) {
        return 0.0;
    }
    return own.coat_weight * coat_albedo(tables, mu, own.coat_roughness);
}

// Directional albedo of the dielectric, as if there were no coat.
fn layers_specular_reflectance(own: Layers, tables: u32, mu: f32) -> f32 {
    if (own.specular_weight == 0.0) {
        return 0.0;
    }
    return own.specular_weight * specular_albedo(tables, mu, own.specular_roughness);
}

// Part of the dielectric's reflection that is lost under the coat.
fn layers_specular_loss(own: Layers, tables: u32, mu: f32) -> f32 {
    if (own.coat_weight == 0.0) {
        return 0.0;
    }
    let loss = dielectric_loss(tables, mu, own.specular_roughness, own.coat_roughness);
    return own.coat_weight * own.specular_weight * loss;
}

// T(μ): share that passes both interfaces, without the coat's tint; coat is the coat's reflectance there.
fn layers_transmittance_under(own: Layers, tables: u32, coat: f32, mu: f32) -> f32 {
    return (1.0 - coat) * (1.0 - layers_specular_reflectance(own, tables, mu)) + layers_specular_loss(own, tables, mu);
}

// T(μ): share that passes both interfaces, without the coat's tint.
fn layers_transmittance(own: Layers, tables: u32, mu: f32) -> f32 {
    return layers_transmittance_under(own, tables, layers_coat_reflectance(own, tables, mu), mu);
}

// T̄ = 2 ∫ T(μ) μ dμ.
fn layers_average_transmittance(own: Layers, tables: u32) -> f32 {
    let roughness = own.specular_roughness;
    let coat_roughness = own.coat_roughness;
    let specular = own.specular_weight * average_specular_albedo(tables, roughness);
    if (own.coat_weight == 0.0) {
        return 1.0 - specular;
    }
    let both = own.specular_weight * average_dielectric_loss(tables, roughness, coat_roughness);
    return 1.0 - specular - own.coat_weight * (average_coat_albedo(tables, coat_roughness) - both);
}

// Light that a white metal leaves between its facets; coat is the coat's reflectance there.
fn layers_metal_exchange_under(own: Layers, tables: u32, coat: f32, mu: f32) -> f32 {
    let deficit = (1.0 - coat) * metal_deficit(tables, mu, own.specular_roughness);
    if (own.coat_weight == 0.0) {
        return deficit;
    }
    return deficit + own.coat_weight * metal_loss(tables, mu, own.specular_roughness, own.coat_roughness);
}

// The cosine mean of that light.
fn layers_average_metal_exchange(own: Layers, tables: u32) -> f32 {
    let deficit = average_metal_deficit(tables, own.specular_roughness);
    if (own.coat_weight == 0.0) {
        return deficit;
    }
    return deficit + own.coat_weight * average_metal_loss(tables, own.specular_roughness, own.coat_roughness);
}

// Share of light that single scattering by the facets of lossless rough glass keeps, where the reflectance at normal incidence
// is scaled by weight; 1 for a mirror.
fn glass_kept(tables: u32, is_inside: bool, mu: f32, roughness: f32, weight: f32) -> f32 {
    if (ggx_is_smooth(ggx_from_roughness(roughness))) {
        return 1.0;
    }
    let root = sqrt(weight);
    var level = 0u;
    var root_of_level = 1.0;
    while (level + 1u < GLASS_LEVELS && root < 0.5 * root_of_level) {
        level += 1u;
        root_of_level *= 0.5;
    }
    var kept = glass_level(tables, level, is_inside, mu, roughness);
    if (level + 1u < GLASS_LEVELS && root < 1.0) {
        let next = glass_level(tables, level + 1u, is_inside, mu, roughness);
        kept = linear(next, kept, 2.0 * root / root_of_level - 1.0);
    }
    return clamp(kept, 0.1, 1.0);
}

// |g| below which directions are drawn evenly: the quotient of the closed form would be rounding noise.
const ISOTROPIC: f32 = 1e-3;

// Scattering with the mean cosine g ∈ (−1, 1).
struct HenyeyGreenstein {
    g: f32,
}

// Scattering with this mean cosine.
fn henyey_greenstein_new(g: f32) -> HenyeyGreenstein {
    return HenyeyGreenstein(select(g, 0.0, abs(g) < ISOTROPIC));
}

// Returns true if all directions are alike.
fn henyey_greenstein_is_isotropic(own: HenyeyGreenstein) -> bool {
    return own.g == 0.0;
}

// Density [1/sr] of turning by an angle of this cosine; it is the phase function, too.
fn henyey_greenstein_pdf(own: HenyeyGreenstein, cosine: f32) -> f32 {
    let g = own.g;
    if (g == 0.0) {
        return 0.25 / 3.1415927;
    }
    let squared = max(1.0 + g * g - 2.0 * g * cosine, 1.1754944e-38);
    return 0.25 / 3.1415927 * (1.0 - g * g) / (squared * sqrt(squared));
}

// A direction after scattering, for a unit direction before and two numbers uniform in [0, 1).
fn henyey_greenstein_sample(own: HenyeyGreenstein, direction: vec3f, u: vec2f) -> vec3f {
    let g = own.g;
    let around = circle(u[1]);
    var cosine = 1.0 - 2.0 * u[0];
    if (g != 0.0) {
        let root = (1.0 - g * g) / (1.0 + g - 2.0 * g * u[0]);
        cosine = clamp((1.0 + g * g - root * root) / (2.0 * g), -1.0, 1.0);
    }
    let sine = sqrt(max(1.0 - cosine * cosine, 0.0));
    let turned = vec3f(sine * around.x, sine * around.y, cosine);
    if (g == 0.0) {
        return turned;
    }
    return normalize(frame_to_world(frame_from_normal(direction), turned));
}

// A point and the side from which it takes light.
struct Receiver {
    // Where it is.
    point: vec3f,
    // Unit normal of the hemisphere that matters, or zero: all directions matter.
    normal: vec3f,
}

// Returns true if only the hemisphere about the normal matters.
fn receiver_has_normal(own: Receiver) -> bool {
    return !is_zero_vector(own.normal);
}

// Cosine of a direction to the normal, 0 below the horizon; 1 without a normal.
fn receiver_cosine(own: Receiver, direction: vec3f) -> f32 {
    if (receiver_has_normal(own)) {
        return clamp(dot(own.normal, direction), 0.0, 1.0);
    } else {
        return 1.0;
    }
}

// Bound from above, in [0, 1], on the cosine of any direction to the ball of a radius whose center is at
// to_center from the point; 0 only if the ball is below the horizon.
fn receiver_cosine_to_cone(own: Receiver, to_center: vec3f, radius: f32) -> f32 {
    if (!receiver_has_normal(own)) {
        return 1.0;
    }
    let highest = dot(own.normal, to_center) + radius;
    if (highest <= 0.0) {
        return 0.0;
    }
    return min(highest / length(to_center), 1.0);
}

// A direction toward a light that was drawn.
struct LightDraw {
    // Unit direction toward the light.
    direction: vec3f,
    // Distance to the light [L].
    distance: f32,
    // Radiance from the direction; of a light that no ray meets the irradiance on a surface that faces it.
    radiance: vec3f,
    // Solid-angle density [1/sr], of a light that no ray meets 1; 0 where there is no direction.
    pdf: f32,
}

// No direction.
fn light_draw_none() -> LightDraw {
    return LightDraw(vec3f(0.0), 0.0, vec3f(0.0), 0.0);
}

// Luminance of a linear Rec. 709 color; 0 only for black.
fn luminance(color: vec3f) -> f32 {
    return dot(color, vec3f(0.2126, 0.7152, 0.0722));
}

// Nodes over t.
const COLUMNS: u32 = 40u;

// Nodes over roughness.
const ROWS: u32 = 24u;

// Roughnesses of averages: the mirror, then the rows.
const AVERAGE_ROWS: u32 = 25u;

// Nodes of the losses under a coat over t: they are small and smooth.
const LOSS_COLUMNS: u32 = 16u;

// Nodes of the losses over the base's roughness.
const LOSS_ROWS: u32 = 8u;

// Nodes of the losses over the coat's roughness.
const COAT_ROWS: u32 = 6u;

// Levels of F₀ of glass: 4⁻ᵏ.
const GLASS_LEVELS: u32 = 4u;

// Roughness of the first row: the square root of the smallest width that is not a mirror.
const SMOOTHEST: f32 = 0.031622777;

// A place between two nodes.
struct Place {
    // The node below.
    node: u32,
    // Where it is on the way to the next one, in [0, 1].
    between: f32,
}

// The place of a coordinate in nodes.
fn place_of(x: f32, nodes: u32) -> Place {
    let node = min(u32(max(x, 0.0)), nodes - 2u);
    return Place(node, clamp(x - f32(node), 0.0, 1.0));
}

// The place of a roughness among rows.
fn row_of(roughness: f32, rows: u32) -> Place {
    return place_of((roughness - SMOOTHEST) * (f32(rows - 1u) / (1.0 - SMOOTHEST)), rows);
}

// Linear interpolation.
fn linear(a: f32, b: f32, x: f32) -> f32 {
    return a + (b - a) * x;
}

// A table's value at a cosine and a roughness that is not a mirror's, bilinear between nodes.
fn grid_value(grid: u32, columns: u32, rows: u32, mu: f32, roughness: f32) -> f32 {
    let root = sqrt(mu);
    let t = root * (1.0 + roughness) / (root + roughness);
    let column = place_of(t * f32(columns - 1u), columns);
    let row = row_of(roughness, rows);
    let low = row.node * columns + column.node;
    let high = low + columns;
    return linear(linear(tables[grid + low], tables[grid + (low + 1u)], column.between), linear(tables[grid + high], tables[grid + (high + 1u)], column.between), row.between);
}

// Rows of averages around a roughness: the mirror stands alone.
struct AverageRows {
    // The row below.
    low: u32,
    // The row above.
    high: u32,
    // Where the roughness is between them, in [0, 1].
    between: f32,
}

// The rows of averages around a roughness.
fn average_rows(roughness: f32) -> AverageRows {
    if (ggx_is_smooth(ggx_from_roughness(roughness))) {
        return AverageRows(0u, 0u, 0.0);
    }
    let row = row_of(roughness, ROWS);
    return AverageRows(row.node + 1u, row.node + 2u, row.between);
}

// The average at a roughness.
fn average_at(averages: u32, roughness: f32) -> f32 {
    let rows = average_rows(roughness);
    return linear(tables[averages + rows.low], tables[averages + rows.high], rows.between);
}

// The average at roughnesses of the coat (rows) and of the base (columns).
fn average_at_both(averages: u32, roughness: f32, coat_roughness: f32) -> f32 {
    let coat = average_rows(coat_roughness);
    let base = average_rows(roughness);
    let low = coat.low * AVERAGE_ROWS;
    let high = coat.high * AVERAGE_ROWS;
    return linear(linear(tables[averages + (low + base.low)], tables[averages + (low + base.high)], base.between), linear(tables[averages + (high + base.low)], tables[averages + (high + base.high)], base.between), coat.between);
}

// Directional albedo of a dielectric's reflection from outside, whose table holds what it exceeds Fresnel's reflectance by.
fn reflectance_at(excess: u32, eta: f32, mu: f32, roughness: f32) -> f32 {
    let fresnel = fresnel_dielectric(mu, eta);
    if (ggx_is_smooth(ggx_from_roughness(roughness))) {
        return fresnel;
    }
    return clamp(fresnel + grid_value(excess, COLUMNS, ROWS, mu, roughness), 0.0, 1.0);
}

// Share of light that single scattering by the facets of a lossless metal loses; 0 for a mirror.
fn deficit_at(deficit: u32, mu: f32, roughness: f32) -> f32 {
    if (ggx_is_smooth(ggx_from_roughness(roughness))) {
        return 0.0;
    }
    return clamp(grid_value(deficit, COLUMNS, ROWS, mu, roughness), 0.0, 1.0);
}

// Light that a lobe under a coat loses to it beyond the coat's loss in the direction seen.
fn loss_at(losses: u32, mu: f32, roughness: f32, coat_roughness: f32) -> f32 {
    if (ggx_is_smooth(ggx_from_roughness(roughness))) {
        return 0.0;
    }
    let row = place_of(coat_roughness * f32(COAT_ROWS - 1u), COAT_ROWS);
    let low = row.node * (LOSS_COLUMNS * LOSS_ROWS);
    let high = low + LOSS_COLUMNS * LOSS_ROWS;
    return linear(grid_value(losses + low, LOSS_COLUMNS, LOSS_ROWS, mu, roughness), grid_value(losses + high, LOSS_COLUMNS, LOSS_ROWS, mu, roughness), row.between);
}

// The cosine mean of that light.
fn average_loss_at(averages: u32, roughness: f32, coat_roughness: f32) -> f32 {
    if (ggx_is_smooth(ggx_from_roughness(roughness))) {
        return 0.0;
    }
    let row = place_of(coat_roughness * f32(COAT_ROWS - 1u), COAT_ROWS);
    let base = row_of(roughness, LOSS_ROWS);
    let low = row.node * LOSS_ROWS + base.node;
    let high = low + LOSS_ROWS;
    return linear(linear(tables[averages + low], tables[averages + (low + 1u)], base.between), linear(tables[averages + high], tables[averages + (high + 1u)], base.between), row.between);
}

// Cosine of the view to which a shading normal is lifted if it faces away from the side that is seen.
const LEAST_SEEN: f32 = 1e-3;

// The shading normal that is nearest among those that face the seen side of a surface.
//
// Interpolated normals of coarse meshes, and those of normal maps, may face away where the surface itself does not: light
// reflected there would count as having come through the surface, and the surface would be black.
fn facing(normal: vec3f, geometric_normal: vec3f, view: vec3f) -> vec3f {
    let seen = dot(view, geometric_normal);
    let promised = dot(view, normal);
    if (seen * promised > 0.0 || seen == 0.0) {
        return normal;
    }
    let lifted = normal + view * (LEAST_SEEN * sign_of(seen) - promised);
    return unit_or(lifted, geometric_normal);
}

// Cosine up to which a place behind the horizon counts as seen, for rounding.
const HORIZON: f32 = 1e-3;

// Room for the rounding of cosines.
const COSINE_ROUNDING: f32 = 1e-6;

// A sphere that emits.
struct SphereLight {
    // Its center.
    center: vec3f,
    // Its radius > 0.
    radius: f32,
    // Radiance, of a spot on its axis.
    radiance: vec3f,
    // Luminance of that.
    luminance: f32,
    // true if its points shine into the cone only.
    has_cone: bool,
    // That cone.
    cone: SpotCone,
    // true if the camera sees it.
    visible: bool,
}

fn sphere_light_at(at: u32) -> SphereLight {
    return SphereLight(table_vector(at + 0u), tables[at + 3u], table_vector(at + 4u), tables[at + 7u], tables[at + 8u] != 0.0, spot_cone_at(at + 9u), tables[at + 14u] != 0.0);
}

// Intensity (luminance), of a spot that on its axis.
fn sphere_light_strength(own: SphereLight) -> f32 {
    return 3.1415927 * own.radius * own.radius * own.luminance;
}

// Emitted power (luminance), not less than the true one.
fn sphere_light_power(own: SphereLight) -> f32 {
    return 2.0 * 3.1415927 * spot_cone_one_minus_cos(own.cone) * sphere_light_strength(own);
}

// Radiance that it sends in a unit direction.
fn sphere_light_radiance_toward(own: SphereLight, direction: vec3f) -> vec3f {
    if (!own.has_cone) {
        return own.radiance;
    }
    return own.radiance * spot_cone_falloff(own.cone, dot(direction, own.cone.axis));
}

// Estimate of the irradiance; 0 only from inside, outside the cone of all points and below the horizon.
fn sphere_light_importance(own: SphereLight, receiver: Receiver) -> f32 {
    let to_center = own.center - receiver.point;
    let per_distance = 1.0 / length(to_center);
    let sine = own.radius * per_distance;
    let highest = dot(receiver.normal, to_center) + own.radius;
    let cosine = select(1.0, highest * per_distance, receiver_has_normal(receiver));
    if (sine >= 1.0 || cosine <= 0.0) {
        return 0.0;
    }
    var falloff = 1.0;
    if (own.has_cone) {
        let axis_cosine = clamp(-dot(to_center, own.cone.axis) * per_distance, -1.0, 1.0);
        let rim_cosine = sqrt(max((1.0 - sine) * (1.0 + sine), 0.0));
        var best = 1.0;
        if (axis_cosine < rim_cosine) {
            let axis_sine = sqrt((1.0 - axis_cosine) * (1.0 + axis_cosine));
            best = axis_cosine * rim_cosine + axis_sine * sine;
        }
        falloff = spot_cone_falloff(own.cone, best + COSINE_ROUNDING);
    }
    if (falloff <= 0.0) {
        return 0.0;
    }
    return max(3.1415927 * own.luminance * sine * sine * min(cosine, 1.0) * falloff, 1.1754944e-38);
}

// Draws a direction; the selection is not in its density.
fn sphere_light_draw(own: SphereLight, point: vec3f, v: vec2f) -> LightDraw {
    let sin2 = sphere_light_sin2(own, point);
    if (sin2 <= 0.0) {
        return light_draw_none();
    }
    let to_center = own.center - point;
    var width = one_minus_cos(sin2);
    let is_of_cone = own.has_cone && spot_cone_one_minus_cos(own.cone) < width;
    var axis = unit_or(to_center, vec3f(0.0, 0.0, 1.0));
    if (is_of_cone) {
        width = spot_cone_one_minus_cos(own.cone);
        axis = -own.cone.axis;
    }
    let direction = uniform_cone(axis, width, v);
    var t = sphere_light_distance(own, point, direction);
    if (t < 0.0) {
        if (is_of_cone) {
            return light_draw_none();
        }
        t = dot(to_center, direction);
    }
    let radiance = sphere_light_radiance_toward(own, -direction);
    return LightDraw(direction, t, radiance, uniform_cone_pdf(width));
}

// Solid-angle density with which [draw](Self::draw) makes the direction from point to hit; 0 behind the horizon.
fn sphere_light_pdf(own: SphereLight, point: vec3f, hit: vec3f) -> f32 {
    let outward = hit - own.center;
    let toward = point - hit;
    if (dot(outward, toward) < -HORIZON * own.radius * length(toward)) {
        return 0.0;
    }
    let sin2 = sphere_light_sin2(own, point);
    if (sin2 <= 0.0) {
        return 0.0;
    }
    let subtended = one_minus_cos(sin2);
    let of_cone = spot_cone_one_minus_cos(own.cone);
    if (own.has_cone && of_cone < subtended) {
        let is_outside = dot(unit_or(toward, vec3f(0.0)), own.cone.axis) < own.cone.cos_outer;
        if (is_outside) {
            return 0.0;
        } else {
            return uniform_cone_pdf(of_cone);
        }
    }
    return uniform_cone_pdf(subtended);
}

// Distance at which a ray from outside meets the sphere; below 0 if it misses it.
fn sphere_light_distance(own: SphereLight, origin: vec3f, direction: vec3f) -> f32 {
    let to_center = own.center - origin;
    let along = dot(to_center, direction);
    let across = to_center - direction * along;
    let radius2 = own.radius * own.radius;
    let half_chord2 = radius2 - dot(across, across);
    if (half_chord2 >= 0.0 && along > 0.0 && dot(to_center, to_center) > radius2) {
        let t = along - sqrt(half_chord2);
        if (is_finite(t)) {
            return max(t, 0.0);
        }
    }
    return -1.0;
}

// Squared sine of the half-angle that the sphere subtends, in (0, 1); 0 from inside.
fn sphere_light_sin2(own: SphereLight, point: vec3f) -> f32 {
    let sine = own.radius / length(own.center - point);
    let sin2 = sine * sine;
    if (sin2 < 1.0) {
        return sin2;
    } else {
        return 0.0;
    }
}

// A point that shines into a cone.
struct SpotLight {
    // Where it is.
    position: vec3f,
    // Intensity on the axis.
    intensity: vec3f,
    // Luminance of that.
    luminance: f32,
    // The cone.
    cone: SpotCone,
}

fn spot_light_at(at: u32) -> SpotLight {
    return SpotLight(table_vector(at + 0u), table_vector(at + 3u), tables[at + 6u], spot_cone_at(at + 7u));
}

// Emitted power (luminance), not less than the true one.
fn spot_light_power(own: SpotLight) -> f32 {
    return 2.0 * 3.1415927 * spot_cone_one_minus_cos(own.cone) * own.luminance;
}

// Intensity in a unit direction.
fn spot_light_intensity_toward(own: SpotLight, direction: vec3f) -> vec3f {
    return own.intensity * spot_cone_falloff(own.cone, dot(direction, own.cone.axis));
}

// The irradiance; 0 only outside the cone and below the horizon.
fn spot_light_importance(own: SpotLight, receiver: Receiver) -> f32 {
    let offset = own.position - receiver.point;
    if (is_zero_vector(offset)) {
        return 0.0;
    }
    let per_distance = 1.0 / length(offset);
    let falloff = spot_cone_falloff(own.cone, -dot(offset, own.cone.axis) * per_distance);
    let cosine = select(1.0, dot(receiver.normal, offset) * per_distance, receiver_has_normal(receiver));
    if (falloff <= 0.0 || cosine <= 0.0) {
        return 0.0;
    }
    return max(own.luminance * falloff * per_distance * per_distance * min(cosine, 1.0), 1.1754944e-38);
}

// The one direction that the light comes from.
fn spot_light_draw(own: SpotLight, point: vec3f) -> LightDraw {
    let offset = own.position - point;
    let direction = unit_or(offset, vec3f(0.0));
    let falloff = spot_cone_falloff(own.cone, -dot(direction, own.cone.axis));
    if (is_zero_vector(direction) || falloff <= 0.0) {
        return light_draw_none();
    }
    let distance = length(offset);
    return LightDraw(direction, distance, own.intensity * falloff / distance / distance, 1.0);
}

// Least roughness of reflections that a diffusely scattered path sees with caustics off.
const ROUGHNESS_AFTER_DIFFUSE: f32 = 0.5;

// A material evaluated at a point: weights, roughnesses and colors in [0, 1], indices in [1, 4].
// Values outside are clamped.
struct SurfaceParameters {
    // Diffuse albedo, or the metal's reflectance at normal incidence; base_weight is included.
    base_color: vec3f,
    // Dielectric 0 … metal 1.
    metalness: f32,
    // Tint of the dielectric's reflection (light that enters is not tinted); a metal's tint at 82°.
    specular_color: vec3f,
    // Factor on the Fresnel reflectance of metal and opaque dielectric. Glass keeps a Fresnel law by an
    // index whose F₀ is scaled; 0 removes the interface.
    specular_weight: f32,
    // Tint of each crossing of the surface.
    transmission_tint: vec3f,
    // Fraction of the dielectric base that is clear.
    transmission_weight: f32,
    // Surface albedo A of the medium, relative to the light that enters.
    surface_albedo: vec3f,
    // Fraction of the dielectric's opaque part that scatters light under the surface.
    subsurface_weight: f32,
    // 1 in the channels with a mean free path above 0; the others are Lambertian with the same factors.
    subsurface_active: vec3f,
    // Perceptual roughness; the GGX width is its square.
    specular_roughness: f32,
    // Tint of the layers under the coat: two passes, one each way.
    coat_color: vec3f,
    // Strength of the clear coat.
    coat_weight: f32,
    // Albedo of the light that a thin-walled surface scatters to its other side, of which there is as much as of
    // surface_albedo.
    thin_albedo: vec3f,
    // Perceptual roughness of the coat.
    coat_roughness: f32,
    // Index of refraction of the dielectric.
    specular_ior: f32,
    // Index of refraction of the coat.
    coat_ior: f32,
    // 1 where there is no inside, else 0: what devices keep holds no bool.
    thin: u32,
}

fn surface_parameters_at(at: u32) -> SurfaceParameters {
    return SurfaceParameters(table_vector(at + 0u), tables[at + 3u], table_vector(at + 4u), tables[at + 7u], table_vector(at + 8u), tables[at + 11u], table_vector(at + 12u), tables[at + 15u], table_vector(at + 16u), tables[at + 19u], table_vector(at + 20u), tables[at + 23u], table_vector(at + 24u), tables[at + 27u], tables[at + 28u], tables[at + 29u], u32(tables[at + 30u]));
}

// Clamps every weight, color and roughness to [0, 1]; NaN becomes 0.
fn surface_parameters_clamped(own: SurfaceParameters) -> SurfaceParameters {
    var p = own;
    p.base_color = unit_color(p.base_color);
    p.metalness = unit_scalar(p.metalness);
    p.specular_color = unit_color(p.specular_color);
    p.specular_weight = unit_scalar(p.specular_weight);
    p.transmission_tint = unit_color(p.transmission_tint);
    p.transmission_weight = unit_scalar(p.transmission_weight);
    p.surface_albedo = unit_color(p.surface_albedo);
    p.subsurface_weight = unit_scalar(p.subsurface_weight);
    p.specular_roughness = unit_scalar(p.specular_roughness);
    p.coat_color = unit_color(p.coat_color);
    p.coat_weight = unit_scalar(p.coat_weight);
    p.thin_albedo = unit_color(p.thin_albedo);
    p.coat_roughness = unit_scalar(p.coat_roughness);
    return p;
}

// Returns true where there is no inside.
fn surface_parameters_is_thin(own: SurfaceParameters) -> bool {
    return own.thin != 0u;
}

// The parameters above a medium of this surface albedo, in whose scattering channels light travels below the surface.
fn surface_parameters_with_subsurface(own: SurfaceParameters, surface_albedo: vec3f, scattering: vec3<bool>) -> SurfaceParameters {
    var p = own;
    p.surface_albedo = surface_albedo;
    p.subsurface_active = select(vec3f(0.0), vec3f(1.0), scattering);
    return p;
}

// The thin-walled surface whose scattering with the mean cosine g is divided between its sides
// [OpenPBR Surface 1.1, "Thin-walled mode"].
fn surface_parameters_scattered_to_both_sides(own: SurfaceParameters, g: f32) -> SurfaceParameters {
    var p = own;
    let half = 0.5 * p.surface_albedo;
    p.surface_albedo = half * (1.0 - g);
    p.thin = 1u;
    p.thin_albedo = half * (1.0 + g);
    return p;
}

// The surface without its clear part and with rough reflections, as soft paths see it.
fn surface_parameters_seen_softly(own: SurfaceParameters) -> SurfaceParameters {
    var p = own;
    p.transmission_weight = 0.0;
    p.specular_roughness = max(p.specular_roughness, ROUGHNESS_AFTER_DIFFUSE);
    p.coat_roughness = max(p.coat_roughness, ROUGHNESS_AFTER_DIFFUSE);
    return p;
}

// The surface with a black base, for paths that may not be scattered diffusely any more: neither light samples nor
// paths then find light there.
fn surface_parameters_without_diffuse(own: SurfaceParameters) -> SurfaceParameters {
    var p = own;
    p.subsurface_weight = 1.0;
    p.surface_albedo = vec3f(0.0);
    p.subsurface_active = vec3f(0.0);
    p.thin_albedo = vec3f(0.0);
    return p;
}

// The surface without its matte base, for such paths above a body that light may pass straight.
fn surface_parameters_without_matte(own: SurfaceParameters) -> SurfaceParameters {
    var p = own;
    p.base_color = vec3f(0.0);
    p.surface_albedo = surface_parameters_subsurface_albedo_active(own);
    return p;
}

// Fraction of the surface that is clear.
fn surface_parameters_clear_part(own: SurfaceParameters) -> f32 {
    return own.transmission_weight * (1.0 - own.metalness);
}

// Surface albedo of the channels that light travels in below the surface.
fn surface_parameters_subsurface_albedo_active(own: SurfaceParameters) -> vec3f {
    return own.surface_albedo * own.subsurface_active;
}

// Albedo of the base that reflects light where it enters: the diffuse part and the subsurface
// channels without a mean free path, relative to the opaque part.
fn surface_parameters_matte_albedo(own: SurfaceParameters) -> vec3f {
    let inactive = own.surface_albedo - surface_parameters_subsurface_albedo_active(own);
    return own.base_color * (1.0 - own.subsurface_weight) + inactive * own.subsurface_weight;
}

// Tint of two passes through the coat.
fn surface_parameters_coat_tint(own: SurfaceParameters) -> vec3f {
    return mix(vec3f(1.0), own.coat_color, own.coat_weight);
}

// Tint of one pass through the coat.
fn surface_parameters_coat_tint_one_way(own: SurfaceParameters) -> vec3f {
    let tint = surface_parameters_coat_tint(own);
    return vec3f(sqrt(tint.x), sqrt(tint.y), sqrt(tint.z));
}

// Transmittance of a clear surface that is passed without refraction: Fresnel and tint, as of a wall whose faces are
// parallel.
fn surface_parameters_straight_transmittance(own: SurfaceParameters, cosine: f32) -> vec3f {
    if (surface_parameters_is_thin(own)) {
        let eta = scaled_ior(own.specular_ior, own.specular_weight);
        return slab_new(min(cosine, 1.0), eta, own.transmission_tint).transmittance;
    }
    let reflected = own.specular_weight * fresnel_dielectric(cosine, own.specular_ior);
    return own.transmission_tint * (1.0 - reflected);
}

// A number in [0, 1]; NaN becomes 0.
fn unit_scalar(x: f32) -> f32 {
    if (x > 0.0) {
        return min(x, 1.0);
    } else {
        return 0.0;
    }
}

// A color in [0, 1]; NaN becomes 0.
fn unit_color(c: vec3f) -> vec3f {
    return vec3f(unit_scalar(c.x), unit_scalar(c.y), unit_scalar(c.z));
}

// Reflectance and transmittance of a smooth clear sheet.
struct Slab {
    // Share that returns.
    reflectance: vec3f,
    // Share that passes.
    transmittance: vec3f,
}

// A sheet of the index eta ≥ 1 that is seen at cos and that passes color of the light along its normal.
fn slab_new(cos: f32, eta: f32, color: vec3f) -> Slab {
    let f = fresnel_dielectric(cos, eta);
    let cos_inside = sqrt(max(1.0 - (1.0 - cos * cos) / (eta * eta), 0.0));
    let passed = color_power(color, 1.0 / max(cos_inside, 1e-4));
    let reflected = passed * f;
    let transmittance = passed * ((1.0 - f) * (1.0 - f)) / max(1.0 - reflected * reflected, vec3f(1e-6));
    return Slab(f + reflected * transmittance, transmittance);
}

// Perceptual roughness of the facets that stand for two refractions at faces of a perceptual roughness: their width is
// √(3.4 (η − 1) (η − ½)² / η³) of the faces' [Kulla & Conty 2017, "Revisiting Physically Based Shading at Imageworks"; the
// slides have 3.7, where Cycles has 3.4].
fn roughness_through(roughness: f32, eta: f32) -> f32 {
    let step = (eta - 0.5) / eta;
    let width = sqrt(max(3.4 * (eta - 1.0) / eta, 0.0)) * step;
    return min(roughness * sqrt(width), 1.0);
}

// Estimate of the irradiance by a triangle's corners and the luminance of its radiance; 0 only from behind and if the triangle
// is below the horizon.
fn triangle_importance(a: vec3f, b: vec3f, c: vec3f, luminance: f32, receiver: Receiver) -> f32 {
    let to_a = a - receiver.point;
    let to_b = b - receiver.point;
    let to_c = c - receiver.point;
    let elevation = -dot(to_a, cross(b - a, c - a));
    let normal = receiver.normal;
    let highest = max(max(dot(normal, to_a), dot(normal, to_b)), dot(normal, to_c));
    if (elevation <= 0.0 || (receiver_has_normal(receiver) && highest <= 0.0)) {
        return 0.0;
    }
    let middle = (to_a + to_b + to_c) / 3.0;
    let from_a = to_a - middle;
    let from_b = to_b - middle;
    let from_c = to_c - middle;
    let radius2 = max(max(dot(from_a, from_a), dot(from_b, from_b)), dot(from_c, from_c));
    let distance = sqrt(max(dot(middle, middle), radius2));
    let cosine = select(1.0, min(highest / distance, 1.0), receiver_has_normal(receiver));
    let intensity = 0.5 * luminance * (elevation / distance);
    return max(intensity / distance / distance * cosine, 1.1754944e-38);
}
