// The tables of a material's two indices of refraction, which laws ask for albedos of its interfaces: they are known by the place
// in `tables` where they begin, with the indices of the base and of the coat. `translucid-render`'s `device/tables.rs` writes
// them in this order.

const SPECULAR_TABLE = 2u;
const COAT_TABLE = 987u;
const METAL_TABLE = 1972u;
const COATED_DIELECTRIC_TABLE = 2957u;
const COATED_METAL_TABLE = 3773u;
const COAT_DIELECTRIC_AVERAGES = 4589u;
const COAT_METAL_AVERAGES = 5214u;
const GLASS_TABLE = 5839u;
// Where averages stand behind a table.
const AVERAGES = COLUMNS * ROWS;
const LOSS_AVERAGES = COAT_ROWS * LOSS_COLUMNS * LOSS_ROWS;

fn specular_ior(at: u32) -> f32 {
    return tables[at];
}

fn coat_ior(at: u32) -> f32 {
    return tables[at + 1u];
}

fn specular_albedo(at: u32, mu: f32, roughness: f32) -> f32 {
    return reflectance_at(at + SPECULAR_TABLE, specular_ior(at), mu, roughness);
}

fn average_specular_albedo(at: u32, roughness: f32) -> f32 {
    return average_at(at + SPECULAR_TABLE + AVERAGES, roughness);
}

fn coat_albedo(at: u32, mu: f32, roughness: f32) -> f32 {
    return reflectance_at(at + COAT_TABLE, coat_ior(at), mu, roughness);
}

fn average_coat_albedo(at: u32, roughness: f32) -> f32 {
    return average_at(at + COAT_TABLE + AVERAGES, roughness);
}

fn metal_deficit(at: u32, mu: f32, roughness: f32) -> f32 {
    return deficit_at(at + METAL_TABLE, mu, roughness);
}

fn average_metal_deficit(at: u32, roughness: f32) -> f32 {
    return average_at(at + METAL_TABLE + AVERAGES, roughness);
}

fn dielectric_loss(at: u32, mu: f32, roughness: f32, coat_roughness: f32) -> f32 {
    return loss_at(at + COATED_DIELECTRIC_TABLE, mu, roughness, coat_roughness);
}

fn average_dielectric_loss(at: u32, roughness: f32, coat_roughness: f32) -> f32 {
    return average_at_both(at + COAT_DIELECTRIC_AVERAGES, roughness, coat_roughness)
        + average_loss_at(at + COATED_DIELECTRIC_TABLE + LOSS_AVERAGES, roughness, coat_roughness);
}

fn metal_loss(at: u32, mu: f32, roughness: f32, coat_roughness: f32) -> f32 {
    return loss_at(at + COATED_METAL_TABLE, mu, roughness, coat_roughness);
}

fn average_metal_loss(at: u32, roughness: f32, coat_roughness: f32) -> f32 {
    return average_loss_at(at + COATED_METAL_TABLE + LOSS_AVERAGES, roughness, coat_roughness)
        - average_at_both(at + COAT_METAL_AVERAGES, roughness, coat_roughness);
}

fn glass_level(at: u32, level: u32, is_inside: bool, mu: f32, roughness: f32) -> f32 {
    let grid = at + GLASS_TABLE + (2u * level + select(0u, 1u, is_inside)) * AVERAGES;
    return grid_value(grid, COLUMNS, ROWS, mu, roughness);
}
