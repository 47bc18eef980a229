// Interfaces of a material: Fresnel's laws, albedos of rough interfaces from tables, and the layers over a base. The formulas
// are those of `translucid-render`'s `dielectric.rs`, `conductor.rs`, `thin_wall.rs`, `layers.rs` and their tables.

// Fresnel reflectance of unpolarized light. `cosine` ≥ 0 is on the side where the light is, `eta` the index of the other side
// over that of this side. 1 beyond the critical angle, exactly 0 at `eta` = 1.
fn fresnel_dielectric(cosine: f32, eta: f32) -> f32 {
    // Roots of squares need not be exact
    if (eta == 1.0) {
        return 0.0;
    }
    let mu = clamp(cosine, 0.0, 1.0);
    // n² cos²θt = n² − sin²θi, without the cancellation of 1 − cos² near grazing
    let g_squared = (eta - 1.0) * (eta + 1.0) + mu * mu;
    if (g_squared <= 0.0) {
        return 1.0;
    }
    let g = sqrt(g_squared);
    let eta_squared = eta * eta;
    let s = (mu - g) / (mu + g);
    let p = (eta_squared * mu - g) / (eta_squared * mu + g);
    return 0.5 * (s * s + p * p);
}

// Index whose reflectance at normal incidence is `weight` times that of `ior` ≥ 1; 1 at `weight` = 0.
fn scaled_ior(ior: f32, weight: f32) -> f32 {
    let root = (ior - 1.0) / (ior + 1.0) * sqrt(weight);
    return (1.0 + root) / (1.0 - root);
}

struct Refracted {
    direction: vec3f,
    // `false` beyond the critical angle.
    is_refracted: bool,
}

// Direction refracted at a facet with normal `h` on the side of `wo`.
fn refract_through(wo: vec3f, h: vec3f, eta: f32) -> Refracted {
    let cosine = dot(wo, h);
    let g_squared = (eta - 1.0) * (eta + 1.0) + cosine * cosine;
    if (g_squared <= 0.0) {
        return Refracted(vec3f(0.0), false);
    }
    return Refracted(normalize((h * (cosine - sqrt(g_squared)) - wo) / eta), true);
}

// Mirror direction of `wo` about `h`.
fn mirrored(wo: vec3f, h: vec3f) -> vec3f {
    return h * (2.0 * dot(wo, h)) - wo;
}

// Reflectance of a metal: Schlick's approximation F₀ + (1 − F₀)(1 − μ)⁵ − a μ (1 − μ)⁶ with a tint at 82°
// [Kutz, Hašan & Edmondson 2021].
struct Metal {
    f0: vec3f,
    a: vec3f,
}

fn metal_of(f0: vec3f, tint: vec3f) -> Metal {
    let mu = 1.0 / 7.0;
    let m = 6.0 / 7.0;
    let schlick = f0 + (vec3f(1.0) - f0) * (m * m * m * m * m);
    return Metal(f0, schlick * (vec3f(1.0) - tint) / (mu * m * m * m * m * m * m));
}

fn metal_reflectance(metal: Metal, mu: f32) -> vec3f {
    let m = clamp(1.0 - mu, 0.0, 1.0);
    let fifth = m * m * m * m * m;
    return max(metal.f0 + (vec3f(1.0) - metal.f0) * fifth - metal.a * ((1.0 - m) * fifth * m), vec3f(0.0));
}

// 2 ∫ F(μ) μ dμ.
fn metal_average(metal: Metal) -> vec3f {
    return max(metal.f0 + (vec3f(1.0) - metal.f0) / 21.0 - metal.a / 126.0, vec3f(0.0));
}

// Reflectance of the light that leaves after several reflections between facets, when `facet_albedo` of it leaves at each
// [Kulla & Conty 2017].
fn metal_multiple_scattering(metal: Metal, facet_albedo: f32) -> vec3f {
    let f = metal_average(metal);
    return f * f * facet_albedo / max(vec3f(1.0) - f * (1.0 - facet_albedo), vec3f(1e-7));
}

// Reflectance and transmittance of a smooth clear sheet.
struct Slab {
    reflectance: vec3f,
    transmittance: vec3f,
}

// A sheet of the index `eta` ≥ 1 that is seen at `cosine` and that passes `color` of the light along its normal.
fn slab_at(cosine: f32, eta: f32, color: vec3f) -> Slab {
    let f = fresnel_dielectric(cosine, eta);
    let inside = sqrt(max(1.0 - (1.0 - cosine * cosine) / (eta * eta), 0.0));
    let passed = select(vec3f(0.0), pow(max(color, vec3f(1e-30)), vec3f(1.0 / max(inside, 1e-4))), color > vec3f(0.0));
    let reflected = passed * f;
    let transmittance = passed * ((1.0 - f) * (1.0 - f)) / max(vec3f(1.0) - reflected * reflected, vec3f(1e-6));
    return Slab(f + reflected * transmittance, transmittance);
}

// Perceptual roughness of the facets that stand for two refractions at faces of a perceptual roughness.
fn roughness_through(roughness: f32, eta: f32) -> f32 {
    let width = sqrt(max(3.4 * (eta - 1.0) / eta, 0.0)) * ((eta - 0.5) / eta);
    return min(roughness * sqrt(width), 1.0);
}

// Where the tables of a material begin in its set of tables, whose first two numbers are the indices of the base and of the
// coat. `translucid-render`'s `device/tables.rs` writes them in this order.
const SPECULAR_TABLE = 2u;
const COAT_TABLE = 987u;
const METAL_TABLE = 1972u;
const COATED_DIELECTRIC_TABLE = 2957u;
const COATED_METAL_TABLE = 3773u;
const COAT_DIELECTRIC_AVERAGES = 4589u;
const COAT_METAL_AVERAGES = 5214u;
const GLASS_TABLE = 5839u;
// Nodes over t and roughness, and of averages over roughness, whose first is the mirror's.
const COLUMNS = 40u;
const ROWS = 24u;
const AVERAGE_ROWS = 25u;
// Nodes of the losses under a coat, over t, the base's roughness and the coat's.
const LOSS_COLUMNS = 16u;
const LOSS_ROWS = 8u;
const COAT_ROWS = 6u;
// Levels of F₀ of glass: 4⁻ᵏ.
const GLASS_LEVELS = 4u;
// Roughness of the first row.
const SMOOTHEST = 0.031622777;

// A place between two nodes.
struct Place {
    node: u32,
    between: f32,
}

fn place_of(x: f32, nodes: u32) -> Place {
    let node = min(u32(max(x, 0.0)), nodes - 2u);
    return Place(node, clamp(x - f32(node), 0.0, 1.0));
}

fn row_of(roughness: f32, rows: u32) -> Place {
    return place_of((roughness - SMOOTHEST) * (f32(rows - 1u) / (1.0 - SMOOTHEST)), rows);
}

// A table's value at a cosine and a roughness that is not a mirror's, bilinear over t = √μ (1 + ρ) / (√μ + ρ) and ρ.
fn grid_value(table: u32, columns: u32, rows: u32, mu: f32, roughness: f32) -> f32 {
    let root = sqrt(mu);
    let column = place_of(root * (1.0 + roughness) / (root + roughness) * f32(columns - 1u), columns);
    let row = row_of(roughness, rows);
    let low = table + row.node * columns + column.node;
    let high = low + columns;
    return mix(
        mix(tables[low], tables[low + 1u], column.between),
        mix(tables[high], tables[high + 1u], column.between),
        row.between,
    );
}

// Rows of averages around a roughness: the mirror stands alone.
struct Rows {
    low: u32,
    high: u32,
    between: f32,
}

fn average_rows(roughness: f32) -> Rows {
    if (is_mirror(roughness)) {
        return Rows(0u, 0u, 0.0);
    }
    let row = row_of(roughness, ROWS);
    return Rows(row.node + 1u, row.node + 2u, row.between);
}

// The cosine mean of a table of reflectances or of the metal's deficit, which stands behind its values.
fn average_of(table: u32, roughness: f32) -> f32 {
    let at = table + COLUMNS * ROWS;
    let rows = average_rows(roughness);
    return mix(tables[at + rows.low], tables[at + rows.high], rows.between);
}

// Directional albedo E(μ) of a dielectric's reflection from outside.
fn rough_reflectance(table: u32, eta: f32, mu: f32, roughness: f32) -> f32 {
    let fresnel = fresnel_dielectric(mu, eta);
    if (is_mirror(roughness)) {
        return fresnel;
    }
    return clamp(fresnel + grid_value(table, COLUMNS, ROWS, mu, roughness), 0.0, 1.0);
}

// Share of light that single scattering by the facets of a lossless metal loses; 0 for a mirror.
fn metal_deficit(material: u32, mu: f32, roughness: f32) -> f32 {
    if (is_mirror(roughness)) {
        return 0.0;
    }
    return clamp(grid_value(material + METAL_TABLE, COLUMNS, ROWS, mu, roughness), 0.0, 1.0);
}

// Share of light that single scattering by the facets of lossless rough glass keeps, where the reflectance at normal incidence
// is scaled by `weight`; 1 for a mirror.
fn glass_kept(material: u32, is_inside: bool, mu: f32, roughness: f32, weight: f32) -> f32 {
    if (is_mirror(roughness)) {
        return 1.0;
    }
    let root = sqrt(weight);
    var level = 0u;
    var root_of_level = 1.0;
    for (; level + 1u < GLASS_LEVELS && root < 0.5 * root_of_level; level++) {
        root_of_level *= 0.5;
    }
    let size = COLUMNS * ROWS;
    let table = material + GLASS_TABLE + (2u * level + select(0u, 1u, is_inside)) * size;
    var kept = grid_value(table, COLUMNS, ROWS, mu, roughness);
    if (level + 1u < GLASS_LEVELS && root < 1.0) {
        kept = mix(grid_value(table + 2u * size, COLUMNS, ROWS, mu, roughness), kept, 2.0 * root / root_of_level - 1.0);
    }
    return clamp(kept, 0.1, 1.0);
}

// Light that a lobe under a coat loses to it beyond the coat's loss in the direction seen.
fn coated_loss(table: u32, mu: f32, roughness: f32, coat_roughness: f32) -> f32 {
    if (is_mirror(roughness)) {
        return 0.0;
    }
    let row = place_of(coat_roughness * f32(COAT_ROWS - 1u), COAT_ROWS);
    let size = LOSS_COLUMNS * LOSS_ROWS;
    let low = table + row.node * size;
    return mix(
        grid_value(low, LOSS_COLUMNS, LOSS_ROWS, mu, roughness),
        grid_value(low + size, LOSS_COLUMNS, LOSS_ROWS, mu, roughness),
        row.between,
    );
}

// Its cosine mean, which stands behind its values.
fn average_coated_loss(table: u32, roughness: f32, coat_roughness: f32) -> f32 {
    if (is_mirror(roughness)) {
        return 0.0;
    }
    let row = place_of(coat_roughness * f32(COAT_ROWS - 1u), COAT_ROWS);
    let base = row_of(roughness, LOSS_ROWS);
    let low = table + COAT_ROWS * LOSS_COLUMNS * LOSS_ROWS + row.node * LOSS_ROWS + base.node;
    let high = low + LOSS_ROWS;
    return mix(
        mix(tables[low], tables[low + 1u], base.between),
        mix(tables[high], tables[high + 1u], base.between),
        row.between,
    );
}

// Means over roughness of the coat (rows) and of the base (columns).
fn average_of_both(table: u32, roughness: f32, coat_roughness: f32) -> f32 {
    let coat = average_rows(coat_roughness);
    let base = average_rows(roughness);
    let low = table + coat.low * AVERAGE_ROWS;
    let high = table + coat.high * AVERAGE_ROWS;
    return mix(
        mix(tables[low + base.low], tables[low + base.high], base.between),
        mix(tables[high + base.low], tables[high + base.high], base.between),
        coat.between,
    );
}

// Coat and dielectric interface of a surface point.
struct Layers {
    // Where the material's tables begin.
    material: u32,
    specular_weight: f32,
    specular_roughness: f32,
    coat_weight: f32,
    coat_roughness: f32,
}

fn specular_ior(layers: Layers) -> f32 {
    return tables[layers.material];
}

fn coat_ior(layers: Layers) -> f32 {
    return tables[layers.material + 1u];
}

// Directional albedo of the coat.
fn coat_reflectance(layers: Layers, mu: f32) -> f32 {
    if (layers.coat_weight == 0.0) {
        return 0.0;
    }
    let table = layers.material + COAT_TABLE;
    return layers.coat_weight * rough_reflectance(table, coat_ior(layers), mu, layers.coat_roughness);
}

// Directional albedo of the dielectric, as if there were no coat.
fn specular_reflectance(layers: Layers, mu: f32) -> f32 {
    if (layers.specular_weight == 0.0) {
        return 0.0;
    }
    let table = layers.material + SPECULAR_TABLE;
    return layers.specular_weight * rough_reflectance(table, specular_ior(layers), mu, layers.specular_roughness);
}

// Part of the dielectric's reflection that is lost under the coat.
fn specular_loss(layers: Layers, mu: f32) -> f32 {
    if (layers.coat_weight == 0.0) {
        return 0.0;
    }
    let table = layers.material + COATED_DIELECTRIC_TABLE;
    let loss = coated_loss(table, mu, layers.specular_roughness, layers.coat_roughness);
    return layers.coat_weight * layers.specular_weight * loss;
}

// T(μ): share that passes both interfaces, without the coat's tint; `coat` is the coat's reflectance there.
fn transmittance_under(layers: Layers, coat: f32, mu: f32) -> f32 {
    return (1.0 - coat) * (1.0 - specular_reflectance(layers, mu)) + specular_loss(layers, mu);
}

// T̄ = 2 ∫ T(μ) μ dμ.
fn average_transmittance(layers: Layers) -> f32 {
    let material = layers.material;
    let roughness = layers.specular_roughness;
    let coat_roughness = layers.coat_roughness;
    let passed = 1.0 - layers.specular_weight * average_of(material + SPECULAR_TABLE, roughness);
    if (layers.coat_weight == 0.0) {
        return passed;
    }
    let both = average_of_both(material + COAT_DIELECTRIC_AVERAGES, roughness, coat_roughness)
        + average_coated_loss(material + COATED_DIELECTRIC_TABLE, roughness, coat_roughness);
    let coat = average_of(material + COAT_TABLE, coat_roughness);
    return passed - layers.coat_weight * (coat - layers.specular_weight * both);
}

// Light that a white metal leaves between its facets; `coat` is the coat's reflectance there.
fn metal_exchange_under(layers: Layers, coat: f32, mu: f32) -> f32 {
    let deficit = (1.0 - coat) * metal_deficit(layers.material, mu, layers.specular_roughness);
    if (layers.coat_weight == 0.0) {
        return deficit;
    }
    let table = layers.material + COATED_METAL_TABLE;
    return deficit + layers.coat_weight * coated_loss(table, mu, layers.specular_roughness, layers.coat_roughness);
}

// Its cosine mean.
fn average_metal_exchange(layers: Layers) -> f32 {
    let material = layers.material;
    let roughness = layers.specular_roughness;
    let deficit = average_of(material + METAL_TABLE, roughness);
    if (layers.coat_weight == 0.0) {
        return deficit;
    }
    let more = average_coated_loss(material + COATED_METAL_TABLE, roughness, layers.coat_roughness)
        - average_of_both(material + COAT_METAL_AVERAGES, roughness, layers.coat_roughness);
    return deficit + layers.coat_weight * more;
}
