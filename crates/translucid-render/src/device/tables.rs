pub(super) fn material_tables(_: &crate::surface::bsdf::MaterialTables) -> Vec<f32> { vec![] }
