//! Tables of materials' surfaces, made when a path first meets one.

use std::sync::{Arc, OnceLock};

use translucid_scene::{Integrator, Material};

use super::bsdf::MaterialTables;

/// The reflectance tables of a scene's materials, and the materials that light may pass.
pub(crate) struct SurfaceTables {
    /// For each material; those with the same indices of refraction share one.
    tables: Vec<Arc<TablesOfIors>>,
    /// For each material, `true` if light may pass it: shadow rays then evaluate it.
    lets_light_through: Vec<bool>,
}

/// The tables of a specular index of refraction and a coat's: they take milliseconds, and files may have thousands.
struct TablesOfIors {
    iors: [f32; 2],
    made: OnceLock<MaterialTables>,
}

impl SurfaceTables {
    pub(crate) fn new(materials: &[Material], integrator: &Integrator) -> Self {
        let mut new = Self { tables: Vec::new(), lets_light_through: Vec::new() };
        materials.iter().for_each(|material| new.push(material, integrator));
        new
    }

    /// Makes the tables of a changed material.
    pub(crate) fn update(&mut self, index: usize, material: &Material, integrator: &Integrator) {
        self.tables[index] = self.tables_of(material);
        self.lets_light_through[index] = lets_light_through(material, integrator);
    }

    /// Makes the tables of one more material.
    pub(crate) fn push(&mut self, material: &Material, integrator: &Integrator) {
        self.tables.push(self.tables_of(material));
        self.lets_light_through.push(lets_light_through(material, integrator));
    }

    /// Forgets a material; those behind it move up.
    pub(crate) fn remove(&mut self, index: usize) {
        self.tables.remove(index);
        self.lets_light_through.remove(index);
    }

    /// The tables of a material's indices of refraction, which other materials may have had.
    fn tables_of(&self, material: &Material) -> Arc<TablesOfIors> {
        let iors = [material.specular_ior, material.coat_ior];
        let known = self.tables.iter().find(|tables| tables.iors == iors).cloned();
        known.unwrap_or_else(|| Arc::new(TablesOfIors { iors, made: OnceLock::new() }))
    }

    #[inline]
    pub(crate) fn of(&self, material: usize) -> &MaterialTables {
        let TablesOfIors { iors: [specular_ior, coat_ior], made } = &*self.tables[material];
        made.get_or_init(|| MaterialTables::new(*specular_ior, *coat_ior))
    }

    pub(crate) fn lets_light_through(&self, material: usize) -> bool {
        self.lets_light_through[material]
    }

    /// Returns `true` if light may pass any material.
    pub(crate) fn any_lets_light_through(&self) -> bool {
        self.lets_light_through.contains(&true)
    }
}

fn lets_light_through(material: &Material, integrator: &Integrator) -> bool {
    let opacity = &material.geometry_opacity;
    // A pane does not bend light, whether caustics are asked for or not
    let is_straight = material.geometry_thin_walled || !integrator.caustics;
    let is_clear = material.transmission_weight.factor > 0.0 && is_straight;
    opacity.factor < 1.0 || opacity.texture.is_some() || is_clear
}
