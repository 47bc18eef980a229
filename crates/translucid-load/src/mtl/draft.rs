//! A material whose lines are being read, and what its values mean together.

use std::path::Path;

use glam::Vec3;
use translucid_scene::{ColorInput, Material, Place, ScalarInput, Warning};

use crate::metal::reflect_fully;
use crate::writer::Writer;

/// The library's program, and whether the mesh has colors of its own.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Beside {
    pub(crate) writer: Writer,
    /// Vertices have colors, which Kd multiplies.
    pub(crate) has_colors: bool,
}

/// Messages with the names of the materials, which stand for NAME.
#[derive(Default)]
pub(super) struct Notes(Vec<(&'static str, Vec<String>)>);

impl Notes {
    fn add(&mut self, message: &'static str, name: &str) {
        match self.0.iter_mut().find(|(known, _)| *known == message) {
            Some((_, names)) => names.push(name.to_owned()),
            None => self.0.push((message, vec![name.to_owned()])),
        }
    }

    /// One warning of a kind, whatever the number of materials.
    pub(super) fn warn(self, path: &Path, warnings: &mut Vec<Warning>) {
        for (message, names) in self.0 {
            let name = match &names[..] {
                [name] => format!("material \"{name}\""),
                names => format!("{} materials, \"{}\" and others", names.len(), names[0]),
            };
            let message = message.replace("NAME", &name);
            warnings.push(Warning { message, place: Some(Place::file(path)) });
        }
    }
}

/// A material whose lines are being read, with the values whose meaning depends on others.
pub(super) struct Draft {
    pub(super) material: Material,
    /// By d and by Tr.
    pub(super) opacity: Option<f32>,
    pub(super) transparency: Option<f32>,
    /// Tf.
    pub(super) filter: Option<Vec3>,
    pub(super) illumination: u32,
    pub(super) has_color: bool,
    /// Ka.
    pub(super) ambient: Option<Vec3>,
    pub(super) has_ambient_map: bool,
    /// Ks.
    pub(super) highlight: Vec3,
    pub(super) has_roughness: bool,
    pub(super) has_metalness: bool,
    pub(super) has_index: bool,
}

impl Draft {
    pub(super) fn new(name: &str) -> Self {
        Self {
            material: Material { name: name.to_owned(), ..Material::default() },
            opacity: None,
            transparency: None,
            filter: None,
            illumination: 2,
            has_color: false,
            ambient: None,
            has_ambient_map: false,
            highlight: Vec3::ZERO,
            has_roughness: false,
            has_metalness: false,
            has_index: false,
        }
    }

    pub(super) fn finish(mut self, Beside { writer, has_colors }: Beside, notes: &mut Notes) -> Material {
        let name = self.material.name.clone();
        let color = &mut self.material.base_color;
        let is_black = color.factor == Vec3::ZERO;
        let has_map = color.texture.is_some();
        if (has_map || has_colors) && (!self.has_color || is_black) {
            color.factor = Vec3::ONE;
        }
        match (is_black, has_map, has_colors) {
            (true, true, _) => {
                notes.add(
                    "the black Kd beside the map_Kd of NAME is left out: it would hide the picture",
                    &name,
                );
            }
            (true, false, true) => notes.add(
                "the black Kd of NAME is left out beside the colors of vertices: it would hide them",
                &name,
            ),
            _ => (),
        }
        color.vertex_color = has_colors && !has_map;
        if has_colors && has_map {
            notes.add("the colors of vertices are left out beside the map_Kd of NAME", &name);
        }
        // Models without a highlight.
        if matches!(self.illumination, 0 | 1) {
            self.material.specular_weight = ScalarInput::constant(0.0);
        }
        match writer.principled {
            Some(_) => self.finish_principled(),
            None => {
                self.finish_model(writer, is_black, notes);
                if !has_map && !has_colors {
                    self.finish_plain(is_black, notes);
                }
            }
        }
        if reflect_fully(&mut self.material).is_some() {
            notes.add("Ks of NAME is left out, as for metals, and so it is where it is no metal", &name);
        }
        self.material
    }

    /// Opacity and glass of the models that illum chooses.
    fn finish_model(&mut self, writer: Writer, is_black: bool, notes: &mut Notes) {
        let Material { name, specular_ior, .. } = &self.material;
        let stated = match (self.opacity, self.transparency) {
            (None, Some(opacity)) if writer.tr_is_opacity => Some(opacity),
            (None, Some(1.0)) => {
                notes.add(
                    "Tr 1 without a d would hide NAME: taken as opaque, as most programs mean it (d 0 is wholly transparent)",
                    name,
                );
                None
            }
            (None, Some(transparency)) => {
                if transparency > 0.5 {
                    notes.add(
                        "Tr of NAME, above 0.5 without a d, is taken as transparency, which nearly hides it: as an opacity, which some programs mean, it is d",
                        name,
                    );
                }
                Some(1.0 - transparency)
            }
            (opacity, _) => opacity,
        };
        let opacity = stated.unwrap_or(1.0);
        let mut clear = 0.0;
        // Models with "transparency: glass", which programs also write for what is opaque.
        if matches!(self.illumination, 4 | 6 | 7 | 9) {
            clear = 1.0 - opacity;
            if stated.is_none() && matches!(self.illumination, 6 | 7) && self.has_index && *specular_ior > 1.0
            {
                clear = if is_black { 1.0 } else { 0.0 };
                if !is_black {
                    notes.add(
                        "illum 6 or 7 of NAME is refraction, but Kd is not black and there is no d: taken as opaque (d 0 is glass)",
                        name,
                    );
                }
            }
        }
        // All programs that write Tf for what is opaque write 1, or 0 for nothing that passes
        let filter = self.filter.unwrap_or(Vec3::ONE);
        if clear == 0.0 && filter != Vec3::ONE && filter != Vec3::ZERO {
            notes.add(
                "Tf of NAME is left out, since nothing else makes it clear: taken as opaque (a d below 1 in illum 4, 6, 7 or 9 is glass)",
                name,
            );
        }
        self.material.geometry_opacity.factor = if clear > 0.0 { 1.0 } else { opacity };
        if clear > 0.0 {
            self.material.transmission_weight = ScalarInput::constant(clear);
            self.material.transmission_color = ColorInput::constant(filter);
        }
    }

    /// Colors of ambient light alone, and mirrors, of what has neither a picture nor colors of vertices.
    fn finish_plain(&mut self, is_black: bool, notes: &mut Notes) {
        let Self { material, ambient, highlight, .. } = self;
        let is_ambient = self.has_ambient_map || ambient.is_some_and(|color| color != Vec3::ZERO);
        if is_ambient && !self.has_color {
            notes.add(
                "Ka and map_Ka of NAME are left out, and there is neither Kd nor map_Kd: the color is gray, 0.8",
                &material.name,
            );
        }
        if self.has_ambient_map && is_black {
            notes.add(
                "map_Ka of NAME is left out, and Kd is black without a map_Kd: the color is black (map_Kd shows the picture)",
                &material.name,
            );
        }
        // Models that reflect Ks of what is around, which at all angles only metals do
        if matches!(self.illumination, 3 | 5 | 8) && is_black && highlight.max_element() > 0.5 {
            notes.add(
                "NAME reflects by illum, with a black Kd and a bright Ks: it is taken for a metal of the color Ks",
                &material.name,
            );
            material.base_color = ColorInput::constant(*highlight);
            material.base_metalness = ScalarInput::constant(1.0);
            material.specular_color = ColorInput::constant(Vec3::ONE);
        }
    }

    /// The values of Blender's Principled BSDF.
    fn finish_principled(&mut self) {
        let material = &mut self.material;
        let mean = |color: Vec3| color.element_sum() / 3.0;
        material.geometry_opacity.factor = self.opacity.unwrap_or(1.0);
        // A Ka of 1 is also that of what is no metal, whose model does not reflect
        let metalness = self.ambient.map_or(0.0, mean);
        if !self.has_metalness && (matches!(self.illumination, 3 | 6) || metalness != 1.0) {
            material.base_metalness = ScalarInput::constant(metalness);
        }
        material.coat_weight.factor = (0.25 * material.coat_weight.factor).min(1.0);
        if let Some(filter) = self.filter {
            material.transmission_weight = ScalarInput::constant(mean(filter));
            // Light crosses glass twice
            let factor = material.base_color.factor.map(libm::sqrtf);
            material.transmission_color = ColorInput { factor, ..material.base_color };
        }
        // Above ½ the level raises the reflectance at normal incidence beyond that of the index
        let level = mean(self.highlight);
        if level > 0.5 {
            let amplitude = (material.specular_ior - 1.0) / (material.specular_ior + 1.0);
            let amplitude = (amplitude * libm::sqrtf(2.0 * level)).min(0.6);
            material.specular_ior = (1.0 + amplitude) / (1.0 - amplitude);
        }
    }
}
