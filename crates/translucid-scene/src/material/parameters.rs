//! The parameters of a material that are numbers: the one list for loaders and checks.

use std::slice;

use super::{Material, SubsurfaceModel};
use crate::interval::{Interval, check_index};
use crate::{ColorInput, NormalMap, ScalarInput, SceneError, TextureRef};

/// A parameter that is a number, a scalar with an image or a color with an image.
pub struct Parameter {
    /// The field's name, which is the key in scene files, too.
    pub name: &'static str,
    /// Range of the number, or of each channel, where there is no image.
    pub range: Interval,
    slot: fn(&mut Material) -> Slot<'_>,
}

/// The place of a parameter in a material.
pub enum Slot<'a> {
    /// A number.
    Number(&'a mut f32),
    /// A scalar, which may have an image.
    Scalar(&'a mut ScalarInput),
    /// A color, which may have an image.
    Color(&'a mut ColorInput),
}

macro_rules! conversions {
    ($($input:ty => $variant:ident),*) => {
        $(impl<'a> From<&'a mut $input> for Slot<'a> {
            fn from(slot: &'a mut $input) -> Self {
                Self::$variant(slot)
            }
        })*
    };
}

conversions!(f32 => Number, ScalarInput => Scalar, ColorInput => Color);

impl Slot<'_> {
    /// The number, or the factors of all channels.
    fn numbers(&mut self) -> &mut [f32] {
        match self {
            Self::Number(number) => slice::from_mut(number),
            Self::Scalar(input) => slice::from_mut(&mut input.factor),
            Self::Color(input) => input.factor.as_mut(),
        }
    }

    /// The reference to an image.
    fn texture(&mut self) -> Option<&mut TextureRef> {
        match self {
            Self::Number(_) => None,
            Self::Scalar(input) => input.texture.as_mut().map(|(texture, _)| texture),
            Self::Color(input) => input.texture.as_mut(),
        }
    }

    /// Range of the numbers, for a parameter with a range of its own: what they multiply counts, too.
    fn range(&self, own: Interval) -> Interval {
        match self {
            Self::Scalar(ScalarInput { texture: Some(_), .. }) => ScalarInput::TEXTURED,
            Self::Color(input) if input.texture.is_some() || input.vertex_color => ColorInput::TEXTURED,
            _ => own,
        }
    }
}

macro_rules! parameters {
    ($($name:ident in $range:expr,)*) => {
        /// Every parameter that is a number, in the order of the fields.
        pub const PARAMETERS: &[Parameter] = &[$(Parameter {
            name: stringify!($name),
            range: $range,
            slot: |material| (&mut material.$name).into(),
        }),*];
    };
}

parameters! {
    base_weight in Interval::UNIT,
    base_color in Interval::UNIT,
    base_metalness in Interval::UNIT,
    specular_weight in Interval::UNIT,
    specular_color in Interval::UNIT,
    specular_roughness in Interval::UNIT,
    specular_ior in Interval::IOR,
    transmission_weight in Interval::UNIT,
    transmission_color in Interval::UNIT,
    transmission_depth in Interval::LENGTH,
    subsurface_weight in Interval::UNIT,
    subsurface_color in Interval::UNIT,
    subsurface_radius in Interval::LENGTH,
    subsurface_radius_scale in Interval::FACTOR,
    subsurface_scatter_anisotropy in Interval::open(-1.0, 1.0),
    subsurface_eta in Interval::closed(0.5, 3.0),
    subsurface_flights in Interval::closed(2.0, 65536.0),
    coat_weight in Interval::UNIT,
    coat_color in Interval::UNIT,
    coat_roughness in Interval::UNIT,
    coat_ior in Interval::IOR,
    emission_luminance in Interval::LIGHT,
    emission_color in Interval::FACTOR,
    geometry_opacity in Interval::UNIT,
}

impl Parameter {
    /// The parameter's place in a material.
    pub fn slot<'a>(&self, material: &'a mut Material) -> Slot<'a> {
        (self.slot)(material)
    }
}

/// A parameter of a material with its value, for those who show or list them all.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterValue {
    /// Its name, which is the key in scene files, too.
    pub name: &'static str,
    /// Least and greatest value of each channel where there is no image; either may itself be excluded.
    pub range: [f64; 2],
    /// The number, or the three channels of a color; with an image or vertex colors the factor on these.
    pub numbers: Vec<f32>,
    /// Whether an image has a part in it.
    pub has_image: bool,
    /// Whether the mesh's vertex colors have.
    pub has_vertex_color: bool,
}

impl NormalMap {
    /// Range of `scale`.
    pub const SCALE: Interval = Interval::closed(-100.0, 100.0);
}

impl Material {
    /// Checks every field in a scene of so many images and profile tables.
    ///
    /// # Errors
    /// A number is out of its range, or there is no image or profile table of an index.
    ///
    /// ```
    /// use translucid_scene::{ColorInput, Material};
    ///
    /// let subsurface_radius_scale = ColorInput::constant([1.0, -2.0, 0.5].into());
    /// let skin = Material { name: "skin".into(), subsurface_radius_scale, ..Material::default() };
    /// let error = skin.validate(0, 0).unwrap_err();
    /// assert_eq!(error.message, "material skin, subsurface_radius_scale[1] = -2: must be in [0, 1e6]");
    /// ```
    pub fn validate(&self, images: usize, profile_tables: usize) -> Result<(), SceneError> {
        self.check(images, profile_tables).map_err(|error| error.within_named("material", &self.name))
    }

    pub(crate) fn check(&self, images: usize, profile_tables: usize) -> Result<(), SceneError> {
        let mut copy = self.clone();
        for parameter in PARAMETERS {
            let mut slot = parameter.slot(&mut copy);
            let range = slot.range(parameter.range);
            match slot.numbers() {
                [number] => range.check(parameter.name, *number)?,
                channels => range.check_all(parameter.name, channels)?,
            }
            slot.texture().map_or(Ok(()), |texture| texture.check(parameter.name, images))?;
        }
        if let SubsurfaceModel::Tabulated(table) = self.subsurface_model {
            check_index("subsurface_model.tabulated", table, profile_tables, "profile tables")?;
        }
        if let Some(NormalMap { texture, scale }) = &self.geometry_normal {
            NormalMap::SCALE.check("geometry_normal.scale", *scale)?;
            texture.check("geometry_normal", images)?;
        }
        Ok(())
    }

    /// Every parameter that is a number or a color, in the order of the fields.
    pub fn parameters(&self) -> Vec<ParameterValue> {
        let mut copy = self.clone();
        let value = |parameter: &Parameter| {
            let mut slot = parameter.slot(&mut copy);
            ParameterValue {
                name: parameter.name,
                range: [parameter.range.low, parameter.range.high],
                numbers: slot.numbers().to_vec(),
                has_image: slot.texture().is_some(),
                has_vertex_color: matches!(&slot, Slot::Color(input) if input.vertex_color),
            }
        };
        PARAMETERS.iter().map(value).collect()
    }

    /// Every reference to an image.
    pub fn for_each_texture(&mut self, mut visit: impl FnMut(&mut TextureRef)) {
        for parameter in PARAMETERS {
            parameter.slot(self).texture().map(&mut visit);
        }
        self.geometry_normal.iter_mut().for_each(|map| visit(&mut map.texture));
    }

    /// Brings every number into its range; what that changed, in words.
    pub fn clamp(&mut self) -> Vec<String> {
        let mut changes = Vec::new();
        let mut clamp = |name: &str, number: &mut f32, range: Interval| {
            let nearest = range.nearest(*number);
            if nearest != *number {
                changes.push(format!("{name} is {number}, but must be in {range}: it becomes {nearest}"));
                *number = nearest;
            }
        };
        for parameter in PARAMETERS {
            let mut slot = parameter.slot(self);
            let range = slot.range(parameter.range);
            slot.numbers().iter_mut().for_each(|number| clamp(parameter.name, number, range));
        }
        if let Some(map) = &mut self.geometry_normal {
            clamp("geometry_normal.scale", &mut map.scale, NormalMap::SCALE);
        }
        changes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_hold_every_field_that_is_a_number() {
        let shown = format!("{:#?}", Material::default());
        // Fields of the material itself are indented once.
        let fields =
            shown.lines().filter_map(|line| line.strip_prefix("    ").filter(|l| !l.starts_with(' ')));
        let numbers = fields.filter_map(|line| line.split_once(": ")).filter(|(_, value)| {
            let is_number = value.trim_end_matches(',').parse::<f32>().is_ok();
            is_number || value.starts_with("ScalarInput") || value.starts_with("ColorInput")
        });
        let names: Vec<&str> = numbers.map(|(name, _)| name).collect();
        let listed: Vec<&str> = PARAMETERS.iter().map(|parameter| parameter.name).collect();
        assert_eq!(names, listed);
    }

    #[test]
    fn clamp_makes_a_material_valid_and_leaves_a_valid_one_alone() {
        let mut material = Material::default();
        drop(material.clamp());
        assert_eq!(material, Material::default());
        material.specular_ior = f32::NAN;
        material.subsurface_radius.factor = -1.0;
        material.emission_color.factor.y = f32::INFINITY;
        drop(material.clamp());
        assert_eq!(material.validate(0, 0), Ok(()));
    }
}
