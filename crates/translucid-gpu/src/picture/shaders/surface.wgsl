// The BSDF of a surface point: evaluation and sampling of all its lobes; the formulas are those of `translucid-render`'s
// `surface/bsdf/`, whose `mod.rs` states them. Directions are in the shading frame, z along the normal, away from the surface.

// Below this cosine the direction seen from is bent up: the shading normal lies, or the ray grazes.
const LEAST_COSINE = 1e-4;
// Index steps below this do not bend light.
const SAME_INDEX = 1e-3;
// Least albedo by which a lobe that exists is chosen, so that table errors cannot hide it.
const LEAST_LOBE = 1e-4;
// Least roughness of reflections that a diffusely scattered path sees with caustics off.
const ROUGHNESS_AFTER_DIFFUSE = 0.5;

// Kinds of decisions.
const NOTHING = 0u;
const DIRECTION = 1u;
const BELOW = 2u;
// Lobes: over the hemisphere, by rough facets, by a mirror.
const DIFFUSE = 0u;
const GLOSSY = 1u;
const MIRROR = 2u;

// A material evaluated at a point, with the meanings of `SurfaceParameters`.
struct Surface {
    base_color: vec3f,
    metalness: f32,
    specular_color: vec3f,
    specular_weight: f32,
    transmission_tint: vec3f,
    transmission_weight: f32,
    surface_albedo: vec3f,
    subsurface_weight: f32,
    // 1 in the channels that light travels in below the surface, 0 in the others.
    subsurface_active: vec3f,
    specular_roughness: f32,
    coat_color: vec3f,
    coat_weight: f32,
    // Of a thin-walled surface, the albedo of the light that is scattered to its other side.
    thin_albedo: vec3f,
    coat_roughness: f32,
    specular_ior: f32,
    coat_ior: f32,
    is_thin: u32,
    // Where the tables of the material's two indices begin in `tables`.
    tables: u32,
}

// Everything in [0, 1]; NaN becomes 0.
fn surface_clamped(p: Surface) -> Surface {
    var clamped = p;
    clamped.base_color = unit_color(p.base_color);
    clamped.metalness = unit_color(vec3f(p.metalness)).x;
    clamped.specular_color = unit_color(p.specular_color);
    clamped.transmission_tint = unit_color(p.transmission_tint);
    clamped.surface_albedo = unit_color(p.surface_albedo);
    clamped.coat_color = unit_color(p.coat_color);
    clamped.thin_albedo = unit_color(p.thin_albedo);
    let weights = unit_color(vec3f(p.specular_weight, p.transmission_weight, p.subsurface_weight));
    clamped.specular_weight = weights.x;
    clamped.transmission_weight = weights.y;
    clamped.subsurface_weight = weights.z;
    let rest = unit_color(vec3f(p.specular_roughness, p.coat_weight, p.coat_roughness));
    clamped.specular_roughness = rest.x;
    clamped.coat_weight = rest.y;
    clamped.coat_roughness = rest.z;
    return clamped;
}

fn unit_color(color: vec3f) -> vec3f {
    return select(vec3f(0.0), min(color, vec3f(1.0)), color > vec3f(0.0));
}

// The surface without its clear part and with rough reflections, as soft paths see it.
fn surface_seen_softly(p: Surface) -> Surface {
    var soft = p;
    soft.transmission_weight = 0.0;
    soft.specular_roughness = max(p.specular_roughness, ROUGHNESS_AFTER_DIFFUSE);
    soft.coat_roughness = max(p.coat_roughness, ROUGHNESS_AFTER_DIFFUSE);
    return soft;
}

// The surface with a black base, for paths that may not be scattered diffusely any more.
fn surface_without_diffuse(p: Surface) -> Surface {
    var black = p;
    black.subsurface_weight = 1.0;
    black.surface_albedo = vec3f(0.0);
    black.subsurface_active = vec3f(0.0);
    black.thin_albedo = vec3f(0.0);
    return black;
}

// The surface without its matte base, for such paths above a body that light may pass straight.
fn surface_without_matte(p: Surface) -> Surface {
    var bare = p;
    bare.base_color = vec3f(0.0);
    bare.surface_albedo = p.surface_albedo * p.subsurface_active;
    return bare;
}

// Tint of two passes through the coat.
fn coat_tint(p: Surface) -> vec3f {
    return mix(vec3f(1.0), p.coat_color, p.coat_weight);
}

// Tint of one pass through the coat.
fn coat_tint_one_way(p: Surface) -> vec3f {
    return sqrt(coat_tint(p));
}

// Transmittance of a clear surface that is passed without refraction.
fn straight_transmittance(p: Surface, cosine: f32) -> vec3f {
    if (p.is_thin != 0u) {
        return slab_at(min(cosine, 1.0), scaled_ior(p.specular_ior, p.specular_weight), p.transmission_tint).transmittance;
    }
    return p.transmission_tint * (1.0 - p.specular_weight * fresnel_dielectric(cosine, p.specular_ior));
}

fn layers_of(p: Surface) -> Layers {
    return Layers(p.tables, p.specular_weight, p.specular_roughness, p.coat_weight, p.coat_roughness);
}

// T(ωi)/T̄ with the tint of one pass through the coat: the share of a radiance that enters a scattering medium.
fn entry_weight(parameters: Surface, cosine: f32) -> vec3f {
    let p = surface_clamped(parameters);
    let layers = layers_of(p);
    let mu = min(cosine, 1.0);
    let passed = transmittance_under(layers, coat_reflectance(layers, mu), mu);
    return coat_tint_one_way(p) * (passed / average_transmittance(layers));
}

// The BSDF of a surface point seen from a direction. The tints of the coat are in the colors of what lies under it.
struct Bsdf {
    // Directions are mirrored to the side of `wo`: wo.z > 0.
    wo: vec3f,
    side: f32,
    layers: Layers,
    coat_transmittance: f32,
    // Weight of the opaque dielectric's reflection, of the metal, and the metal's reflectance.
    dielectric: vec3f,
    metal_weight: vec3f,
    metal: Metal,
    // Reflection between facets without the factor of wi.
    facet_exchange: vec3f,
    // Weights of reflection by the clear part and of its transmission. Those of a thin wall include Fresnel's factors.
    glass_reflection: vec3f,
    glass_transmission: vec3f,
    // Index of the other side over that of the side of `wo`; 1 where light goes straight on: in a thin wall, too.
    eta: f32,
    // A (…) T(ωo) / (π T̄).
    matte: vec3f,
    // The weight of light from below; of a thin wall the matte term of its other side.
    below: vec3f,
    is_thin: bool,
    // T(ωi) is 1.
    matte_is_bare: bool,
    // Facets of transmission through a thin wall.
    roughness_through: f32,
    // Probabilities of the sampling strategies; they sum to 1, or to 0 for a black surface.
    choose_below: f32,
    choose_diffuse: f32,
    choose_coat: f32,
    choose_straight: f32,
    choose_through: f32,
    choose_facets: f32,
    // About the reflectance of light that comes from everywhere, transmission and subsurface color included.
    albedo: vec3f,
}

struct BsdfValue {
    // f·|cosθi| [1/sr] of matte reflection.
    diffuse: vec3f,
    // Density with which `bsdf_sample` makes the direction, choice of lobe included [1/sr].
    pdf: f32,
    // f·|cosθi| [1/sr] of coat, dielectric and metal, and of rough transmission.
    specular: vec3f,
}

struct BsdfSample {
    kind: u32,
    // Where the light comes from.
    wi: vec3f,
    // f|cosθi| / pdf over all lobes that share the direction. Of light from below, what leaves, without A.
    weight: vec3f,
    // Part of `weight` that is matte reflection.
    diffuse_share: vec3f,
    // Density [1/sr], 0 for a mirror.
    pdf: f32,
    lobe: u32,
    is_transmitted: bool,
}

fn mean_of(color: vec3f) -> f32 {
    return (color.x + color.y + color.z) * (1.0 / 3.0);
}

// The BSDF seen from `wo`; `wo.z` < 0 is from inside.
fn bsdf_new(parameters: Surface, wo: vec3f) -> Bsdf {
    let p = surface_clamped(parameters);
    let is_thin = p.is_thin != 0u;
    let clear = (1.0 - p.metalness) * p.transmission_weight;
    let opaque = (1.0 - p.metalness) * (1.0 - p.transmission_weight);
    // From inside a surface that is partly clear, its opaque part is bare, and its coat only tints
    let is_inside = wo.z < 0.0 && clear > 0.0 && !is_thin;
    var b: Bsdf;
    b.side = select(1.0, -1.0, wo.z < 0.0);
    b.wo = vec3f(wo.xy, wo.z * b.side);
    if (b.wo.z < LEAST_COSINE) {
        b.wo = normalize(vec3f(wo.xy, LEAST_COSINE));
    }
    let mu = b.wo.z;
    b.layers = layers_of(p);
    b.is_thin = is_thin;
    b.matte_is_bare = is_inside;
    if (is_inside) {
        b.layers.coat_weight = 0.0;
    }
    let coat = coat_reflectance(b.layers, mu);
    b.coat_transmittance = 1.0 - coat;
    let tint = select(coat_tint(p), vec3f(1.0), is_inside);
    let specular = select(specular_reflectance(b.layers, mu), 0.0, is_inside);

    // The metal
    let metal_weight = p.metalness * p.specular_weight;
    b.metal_weight = metal_weight * tint;
    b.metal = metal_of(p.base_color, p.specular_color);
    var reflection = p.specular_color * (opaque * specular) * tint;
    var exchange = vec3f(0.0);
    if (metal_weight > 0.0) {
        let roughness = p.specular_roughness;
        let single = 1.0 - metal_deficit(p.tables, mu, roughness);
        // Rough facets are seen from all angles
        let color = mix(metal_reflectance(b.metal, mu), metal_average(b.metal), roughness);
        reflection += color * (metal_weight * single) * tint;
        let average = average_metal_exchange(b.layers);
        if (!is_mirror(roughness) && average > 1e-6) {
            let out = metal_exchange_under(b.layers, coat, mu);
            let deficit = average_of(p.tables + METAL_TABLE, roughness);
            exchange = tint * metal_multiple_scattering(b.metal, 1.0 - deficit) * (metal_weight * out);
            b.facet_exchange = exchange * (INVERSE_PI / average);
        }
    }

    // The opaque base
    var passed = 1.0;
    var average_passed = 1.0;
    var subsurface = 0.0;
    var at_once = vec3f(1.0);
    if (!is_inside) {
        b.dielectric = p.specular_color * (opaque * p.specular_weight) * tint;
        passed = transmittance_under(b.layers, coat, mu);
        average_passed = average_transmittance(b.layers);
        subsurface = opaque * p.subsurface_weight * passed;
        at_once -= p.subsurface_active;
    }
    let albedo = p.base_color * (1.0 - p.subsurface_weight) + p.surface_albedo * at_once * p.subsurface_weight;
    let matte = tint * albedo * (opaque * passed);
    b.matte = matte * (INVERSE_PI / average_passed);
    var below = vec3f(0.0);
    var through = vec3f(0.0);
    if (is_thin) {
        through = tint * p.thin_albedo * subsurface;
        b.below = through * (INVERSE_PI / average_passed);
    } else {
        below = tint * p.surface_albedo * p.subsurface_active * subsurface;
        b.below = coat_tint_one_way(p) * p.subsurface_active * subsurface;
    }

    // The clear part
    b.eta = 1.0;
    var glass = vec3f(0.0);
    if (clear > 0.0) {
        let scaled = scaled_ior(specular_ior(b.layers), p.specular_weight);
        if (is_thin) {
            fill_slab(&b, p, clear * tint, scaled);
            // The albedo does not know of the facets
            reflection += b.glass_reflection;
            glass = b.glass_transmission * facet_albedo(p.tables, mu, b.roughness_through);
        } else {
            fill_glass(&b, p, clear, select(scaled, 1.0 / scaled, is_inside));
            var f = 0.0;
            if (b.eta > 1.0) {
                f = specular_reflectance(b.layers, mu);
            } else if (b.eta < 1.0) {
                f = fresnel_dielectric(mu, b.eta);
            }
            let crossing = p.transmission_tint * coat_tint_one_way(p);
            glass = (p.specular_color * tint * f + crossing * (1.0 - f)) * clear;
        }
    }

    // Choose lobes in proportion to their albedos; those of the facets are without the coat's shadow
    let has_step = b.eta != 1.0;
    let has_coat = b.layers.coat_weight > 0.0 && coat_ior(b.layers) > 1.0;
    let has_dielectric = !is_inside && any(p.specular_color * (opaque * p.specular_weight) > vec3f(0.0));
    let has_facets = metal_weight > 0.0 || (has_dielectric && specular_ior(b.layers) > 1.0)
        || (clear > 0.0 && (has_step || is_thin));
    let by_facets = mean_of(reflection) + select(0.0, mean_of(glass), has_step);
    let chance_coat = select(0.0, max(coat, LEAST_LOBE), has_coat);
    let chance_facets = select(0.0, max(by_facets, LEAST_LOBE) * b.coat_transmittance, has_facets);
    let chance_straight = select(mean_of(glass) * b.coat_transmittance, 0.0, has_step);
    let chance_diffuse = mean_of(matte + through) + mean_of(exchange);
    let chance_below = mean_of(below);
    let sum = chance_coat + chance_facets + chance_straight + chance_diffuse + chance_below;
    let scale = select(0.0, 1.0 / max(sum, 1e-30), sum > 0.0);
    b.choose_coat = scaled_chance(chance_coat, scale);
    b.choose_facets = scaled_chance(chance_facets, scale);
    b.choose_straight = scaled_chance(chance_straight, scale);
    b.choose_diffuse = scaled_chance(chance_diffuse, scale);
    b.choose_below = scaled_chance(chance_below, scale);
    if (is_thin && chance_diffuse > 0.0) {
        // Light samples look for the reflected part, too, however small it is
        b.choose_through = b.choose_diffuse * min(mean_of(through) / chance_diffuse, 0.99);
        b.choose_diffuse -= b.choose_through;
    }
    let under = (reflection + glass) * b.coat_transmittance;
    b.albedo = min(vec3f(coat) + under + exchange + matte + through + below, vec3f(1.0));
    return b;
}

// A number whose inverse is infinite makes no weight.
fn scaled_chance(chance: f32, scale: f32) -> f32 {
    return select(chance * scale, 0.0, chance * scale < 1.2e-38);
}

// Share of light that single scattering by a white metal's facets keeps.
fn facet_albedo(material: u32, mu: f32, roughness: f32) -> f32 {
    return 1.0 - metal_deficit(material, mu, roughness);
}

// The clear part of a thin-walled surface, of this weight and tint.
fn fill_slab(b: ptr<function, Bsdf>, p: Surface, weight: vec3f, eta: f32) {
    let mu = (*b).wo.z;
    let slab = slab_at(mu, eta, p.transmission_tint);
    (*b).roughness_through = roughness_through(p.specular_roughness, eta);
    // The coat takes more from a rough reflection than its share
    let under_coat = (*b).coat_transmittance * specular_reflectance((*b).layers, mu);
    let loss = specular_loss((*b).layers, mu);
    let kept = select(1.0, max(1.0 - loss / max(under_coat, 1e-30), 0.5), loss > 0.0);
    let faces = facet_albedo(p.tables, mu, p.specular_roughness);
    (*b).glass_reflection = slab.reflectance * p.specular_color * weight / (kept * faces);
    (*b).glass_transmission = slab.transmittance * weight / facet_albedo(p.tables, mu, (*b).roughness_through);
}

// The clear part of a body.
fn fill_glass(b: ptr<function, Bsdf>, p: Surface, weight: f32, eta: f32) {
    let mu = (*b).wo.z;
    var scale = weight;
    if (abs(eta - 1.0) >= SAME_INDEX) {
        (*b).eta = eta;
        let single = glass_kept(p.tables, eta < 1.0, mu, p.specular_roughness, p.specular_weight);
        // The coat takes more from a rough reflection than its share
        let kept = 1.0 - specular_loss((*b).layers, mu) / max((*b).coat_transmittance * single, 1e-30);
        // Both lobes together lose nothing
        scale = weight / (single * max(kept, 0.5));
    }
    let tint = select(coat_tint(p), vec3f(1.0), (*b).matte_is_bare);
    (*b).glass_reflection = p.specular_color * tint * scale;
    (*b).glass_transmission = p.transmission_tint * coat_tint_one_way(p) * scale;
}

// Returns `true` if light sampling finds nothing: only mirror lobes, light from below or black.
fn bsdf_is_smooth_only(b: ptr<function, Bsdf>) -> bool {
    return (*b).choose_diffuse == 0.0 && ((*b).choose_coat == 0.0 || is_mirror((*b).layers.coat_roughness))
        && ((*b).choose_facets == 0.0 || is_mirror((*b).layers.specular_roughness));
}

// The share of light that goes straight through a thin wall.
fn bsdf_straight_through_wall(b: ptr<function, Bsdf>) -> vec3f {
    let is_straight = (*b).is_thin && is_mirror((*b).roughness_through) && (*b).choose_straight > 0.0;
    return select(vec3f(0.0), (*b).glass_transmission * (*b).coat_transmittance, is_straight);
}

// Value and density for light from `wi`.
fn bsdf_eval(b: ptr<function, Bsdf>, wi: vec3f) -> BsdfValue {
    return eval_on_side(b, vec3f(wi.xy, wi.z * (*b).side));
}

// The same for a direction mirrored to the side of `wo`.
fn eval_on_side(b: ptr<function, Bsdf>, wi: vec3f) -> BsdfValue {
    if (wi.z > 0.0) {
        return eval_reflection(b, wi);
    }
    if (wi.z < 0.0) {
        if ((*b).is_thin) {
            return eval_through(b, vec3f(wi.xy, -wi.z));
        }
        return eval_transmission(b, wi);
    }
    return BsdfValue();
}

fn eval_reflection(b: ptr<function, Bsdf>, wi: vec3f) -> BsdfValue {
    var value = BsdfValue();
    let wo = (*b).wo;
    let layers = (*b).layers;
    let h = normalize(wo + wi);
    let coat_in = coat_reflectance(layers, wi.z);
    let under_coat = min((*b).coat_transmittance, 1.0 - coat_in);
    if ((*b).choose_coat > 0.0 && !is_mirror(layers.coat_roughness)) {
        let lobe = facet_reflection(layers.coat_roughness, wo, wi, h);
        let f = layers.coat_weight * fresnel_dielectric(dot(wo, h), coat_ior(layers));
        value.specular += vec3f(f * lobe.x);
        value.pdf += (*b).choose_coat * lobe.y;
    }
    if ((*b).choose_facets > 0.0 && !is_mirror(layers.specular_roughness)) {
        let lobe = facet_reflection(layers.specular_roughness, wo, wi, h);
        let split = split_at_facet(b, dot(wo, h));
        value.specular += split.reflected * (lobe.x * under_coat);
        value.pdf += (*b).choose_facets * split.reflect_probability * lobe.y;
    }
    if ((*b).choose_diffuse > 0.0) {
        if (any((*b).facet_exchange > vec3f(0.0))) {
            value.specular += (*b).facet_exchange * (metal_exchange_under(layers, coat_in, wi.z) * wi.z);
        }
        var passed = 1.0;
        if (!(*b).matte_is_bare) {
            passed = transmittance_under(layers, coat_in, wi.z);
        }
        value.diffuse = (*b).matte * (passed * wi.z);
        value.pdf += (*b).choose_diffuse * wi.z * INVERSE_PI;
    }
    return value;
}

fn eval_transmission(b: ptr<function, Bsdf>, wi: vec3f) -> BsdfValue {
    var value = BsdfValue();
    let wo = (*b).wo;
    let eta = (*b).eta;
    let roughness = (*b).layers.specular_roughness;
    if (eta == 1.0 || is_mirror(roughness)) {
        return value;
    }
    // Normal of the facet that refracts wi to wo [Walter et al. 2007, eq. 16], on the side of wo. The sum is no shorter than the
    // step of the index, but for rounding
    let sum = wo + wi * eta;
    let squared = dot(sum, sum);
    if (squared < 1e-12) {
        return value;
    }
    let h = sum * (select(1.0, -1.0, sum.z < 0.0) / sqrt(squared));
    let cosine_out = dot(wo, h);
    let cosine_in = dot(wi, h);
    if (cosine_out <= 0.0 || cosine_in >= 0.0) {
        return value;
    }
    let split = split_at_facet(b, cosine_out);
    let jacobian = eta * eta * -cosine_in / squared;
    let pdf = visible_density(roughness, wo, h) * jacobian;
    let shadowing = facet_masking_shadowing(roughness, wo.z, wi.z) / facet_masking(roughness, wo.z);
    value.specular = split.transmitted * (shadowing * pdf * (*b).coat_transmittance);
    value.pdf = (*b).choose_facets * (1.0 - split.reflect_probability) * pdf;
    return value;
}

// Value and density for light from behind a thin wall; `wi` is its direction mirrored to this side.
fn eval_through(b: ptr<function, Bsdf>, wi: vec3f) -> BsdfValue {
    var value = BsdfValue();
    let layers = (*b).layers;
    let passed = transmittance_under(layers, coat_reflectance(layers, wi.z), wi.z);
    value.diffuse = (*b).below * (passed * wi.z);
    value.pdf = (*b).choose_through * wi.z * INVERSE_PI;
    if ((*b).choose_straight > 0.0 && !is_mirror((*b).roughness_through)) {
        let lobe = facet_reflection((*b).roughness_through, (*b).wo, wi, normalize((*b).wo + wi));
        value.specular = (*b).glass_transmission * ((*b).coat_transmittance * lobe.x);
        value.pdf += (*b).choose_straight * lobe.y;
    }
    return value;
}

// Light at a facet: reflected and transmitted parts, and the chance that reflection is sampled.
struct FacetSplit {
    reflected: vec3f,
    reflect_probability: f32,
    transmitted: vec3f,
}

// Reflectance and transmittance of a base facet seen at this cosine, the coat's tints but not its shadow included.
fn split_at_facet(b: ptr<function, Bsdf>, cosine: f32) -> FacetSplit {
    var split = FacetSplit();
    if (any((*b).dielectric > vec3f(0.0))) {
        split.reflected += (*b).dielectric * fresnel_dielectric(cosine, specular_ior((*b).layers));
    }
    if (any((*b).metal_weight > vec3f(0.0))) {
        split.reflected += (*b).metal_weight * metal_reflectance((*b).metal, cosine);
    }
    if ((*b).is_thin) {
        split.reflected += (*b).glass_reflection;
    } else if ((*b).eta != 1.0) {
        let f = fresnel_dielectric(cosine, (*b).eta);
        split.reflected += (*b).glass_reflection * f;
        split.transmitted = (*b).glass_transmission * (1.0 - f);
    }
    let r = mean_of(split.reflected);
    let t = mean_of(split.transmitted);
    split.reflect_probability = 1.0;
    if (t > 0.0) {
        split.reflect_probability = r / (r + t);
    }
    return split;
}

// Chooses where light comes from; `choice` and `u` are uniform in [0, 1).
fn bsdf_sample(b: ptr<function, Bsdf>, choice: f32, u: vec2f) -> BsdfSample {
    let chosen = bsdf_choose(b, choice, u);
    if (chosen.kind != DIRECTION || chosen.lobe == MIRROR) {
        return chosen;
    }
    return bsdf_weighed(chosen, bsdf_eval(b, chosen.wi));
}

// The choice alone: the weight of a direction that is no mirror's is that of all lobes there, see `bsdf_weighed`.
fn bsdf_choose(b: ptr<function, Bsdf>, choice: f32, u: vec2f) -> BsdfSample {
    var left = choice;
    if (left < (*b).choose_below) {
        var sample = BsdfSample();
        sample.kind = BELOW;
        sample.weight = (*b).below / (*b).choose_below;
        return sample;
    }
    left -= (*b).choose_below;
    if (left < (*b).choose_diffuse) {
        return toward(b, sample_cosine(u), DIFFUSE);
    }
    left -= (*b).choose_diffuse;
    if (left < (*b).choose_coat) {
        return sample_coat(b, u);
    }
    left -= (*b).choose_coat;
    if (left < (*b).choose_straight) {
        return sample_straight(b, u);
    }
    left -= (*b).choose_straight;
    if (left < (*b).choose_through) {
        let wi = sample_cosine(u);
        return toward(b, vec3f(wi.xy, -wi.z), DIFFUSE);
    }
    left -= (*b).choose_through;
    if ((*b).choose_facets > 0.0) {
        return sample_facets(b, clamp(left / (*b).choose_facets, 0.0, 1.0), u);
    }
    return BsdfSample();
}

fn sample_coat(b: ptr<function, Bsdf>, u: vec2f) -> BsdfSample {
    let wo = (*b).wo;
    let roughness = (*b).layers.coat_roughness;
    if (is_mirror(roughness)) {
        let f = (*b).layers.coat_weight * fresnel_dielectric(wo.z, coat_ior((*b).layers));
        return mirror_sample(b, vec3f(-wo.xy, wo.z), vec3f(f / (*b).choose_coat));
    }
    let wi = mirrored(wo, sample_visible(roughness, wo, u));
    // Below the horizon it would count as light through a wall or glass
    if (wi.z <= 0.0) {
        return BsdfSample();
    }
    return toward(b, wi, GLOSSY);
}

fn sample_straight(b: ptr<function, Bsdf>, u: vec2f) -> BsdfSample {
    let wo = (*b).wo;
    if ((*b).is_thin && !is_mirror((*b).roughness_through)) {
        let wi = mirrored(wo, sample_visible((*b).roughness_through, wo, u));
        if (wi.z <= 0.0) {
            return BsdfSample();
        }
        return toward(b, vec3f(wi.xy, -wi.z), GLOSSY);
    }
    return mirror_sample(b, -wo, (*b).glass_transmission * ((*b).coat_transmittance / (*b).choose_straight));
}

fn sample_facets(b: ptr<function, Bsdf>, choice: f32, u: vec2f) -> BsdfSample {
    let wo = (*b).wo;
    let roughness = (*b).layers.specular_roughness;
    let is_smooth = is_mirror(roughness);
    var h = vec3f(0.0, 0.0, 1.0);
    if (!is_smooth) {
        h = sample_visible(roughness, wo, u);
    }
    let split = split_at_facet(b, dot(wo, h));
    // Rounding may bring the choice to 1: where nothing is transmitted, all is reflected
    let is_reflected = choice < split.reflect_probability || split.reflect_probability >= 1.0;
    var wi = mirrored(wo, h);
    var weight = split.reflected;
    var chance = split.reflect_probability;
    if (!is_reflected) {
        let refracted = refract_through(wo, h, (*b).eta);
        if (!refracted.is_refracted) {
            return BsdfSample();
        }
        wi = refracted.direction;
        weight = split.transmitted;
        chance = 1.0 - split.reflect_probability;
    }
    if (is_smooth) {
        return mirror_sample(b, wi, weight * ((*b).coat_transmittance / ((*b).choose_facets * chance)));
    }
    if ((wi.z > 0.0) != is_reflected) {
        return BsdfSample();
    }
    return toward(b, wi, GLOSSY);
}

// A sample of a mirror lobe; `wi` on the side of `wo`.
fn mirror_sample(b: ptr<function, Bsdf>, wi: vec3f, weight: vec3f) -> BsdfSample {
    let direction = vec3f(wi.xy, wi.z * (*b).side);
    return BsdfSample(DIRECTION, direction, weight, vec3f(0.0), 0.0, MIRROR, wi.z < 0.0);
}

// A direction on the side of `wo`, without its weight.
fn toward(b: ptr<function, Bsdf>, local: vec3f, lobe: u32) -> BsdfSample {
    let wi = normalize(local);
    let direction = vec3f(wi.xy, wi.z * (*b).side);
    return BsdfSample(DIRECTION, direction, vec3f(0.0), vec3f(0.0), 0.0, lobe, wi.z < 0.0);
}

// A choice with the value and density of all lobes in its direction.
fn bsdf_weighed(chosen: BsdfSample, value: BsdfValue) -> BsdfSample {
    if (value.pdf <= 0.0) {
        return BsdfSample();
    }
    var sample = chosen;
    let f = value.diffuse + value.specular;
    sample.weight = f / value.pdf;
    sample.diffuse_share = select(vec3f(0.0), value.diffuse / max(f, vec3f(1e-37)), f > vec3f(0.0));
    sample.pdf = value.pdf;
    return sample;
}
