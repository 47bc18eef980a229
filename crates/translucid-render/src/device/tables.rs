//! Tables of reflectances as numbers.

use crate::surface::bsdf::MaterialTables;

/// The set of tables of a material's two indices: all [sections](MaterialTables::sections), one after the other.
pub fn material_tables(tables: &MaterialTables) -> Vec<f32> {
    tables.sections().into_iter().flat_map(|(_, numbers)| numbers).collect()
}
