//! The parameters of a material by their keys.

use super::{CameraVisibility, Material, SubsurfaceModel, SubsurfaceNormalization, SubsurfaceTextureAt};
use crate::SceneError;
use crate::description::{Counts, Fallback, Key, List, Part, Rule, SceneSlot, Thing, Visit, Word, field};
use translucid_words::Interval;

use Fallback::{Plain, Words};

impl Word for SubsurfaceTextureAt {
    const WORDS: &'static [(&'static str, Self)] =
        &[("exit", Self::Exit), ("entry", Self::Entry), ("both", Self::Both)];
}

impl Word for SubsurfaceNormalization {
    const WORDS: &'static [(&'static str, Self)] = &[("none", Self::None), ("energy", Self::Energy)];
}

impl Word for CameraVisibility {
    const WORDS: &'static [(&'static str, Self)] =
        &[("surface", Self::Surface), ("shadow", Self::Shadow), ("none", Self::None)];
}

const MODEL: &[Key] = &[
    Key::new(
        "subsurface_model",
        "a model of the list below, or `\"none\"` (Lambertian)",
        Words("`\"default\"`, which is a [random walk or a profile](#which-model-by-default)"),
    ),
    Key::new(
        "subsurface_table",
        "path of a CSV file with a profile of your own, in place of `subsurface_model`",
        Words("–"),
    ),
];

const LAYERS: &[Key] = &[Key::new(
    "layer",
    "[layers](#layers) of other media, from the surface inwards, each a `[[material.layer]]`; `\"none\"` takes away those of a file that this one extends",
    Words("none"),
)];

/// Requirements of layers, which are for random walks and their own profile.
const RULES: &[Rule<Material>] = &[
    Rule::Holds { key: "subsurface_table", broken: |m| no_walk(m, true), help: LEAVE_OUT_LAYERS },
    Rule::Holds { key: "subsurface_model", broken: |m| no_walk(m, false), help: LEAVE_OUT_LAYERS },
    Rule::Holds {
        key: "subsurface_model",
        broken: |m| {
            let fault =
                m.fault_of_layered_profile().filter(|_| m.subsurface_model == SubsurfaceModel::Layers);
            fault.map(|fault| format!("a random walk or left out, because {fault}"))
        },
        help: "layers have one profile for all of a material",
    },
    Rule::Holds {
        key: "geometry_thin_walled",
        broken: |m| {
            let is_broken = !m.layers.is_empty() && m.geometry_thin_walled;
            is_broken.then(|| String::from("false, because the material has layers"))
        },
        help: LEAVE_OUT_LAYERS,
    },
];

const LEAVE_OUT_LAYERS: &str = "layer = \"none\" takes away the layers";

/// Refuses models other than walks, tables or others, for materials with layers.
fn no_walk(material: &Material, is_table: bool) -> Option<String> {
    let model = material.subsurface_model;
    let is_walk =
        matches!(model, SubsurfaceModel::Default | SubsurfaceModel::RandomWalk(_) | SubsurfaceModel::Layers);
    let is_asked = is_table == matches!(model, SubsurfaceModel::Tabulated(_));
    let is_broken = !material.layers.is_empty() && !is_walk && is_asked;
    let what = if is_table { "left out" } else { "a random walk, \"layers\" or left out" };
    is_broken.then(|| format!("{what}, because the material has layers"))
}

const NORMAL: &[Key] = &[Key::new("geometry_normal", "path of a normal map, or a table", Words("none"))];

impl Material {
    /// The keys of a material besides its parameters: its name, and the origin of what it does not state.
    pub const ORIGIN_KEYS: &[Key] = &[
        Key::new("name", "text, unique among the materials", Words("must be given")),
        Key::new(
            "preset",
            "name of a preset, which gives the defaults of all other keys; its lengths are converted to the scene's unit",
            Words("none"),
        ),
        Key::new(
            "file",
            "path of a [MaterialX document](materials.md#from-materialx) (.mtlx) in place of a preset: its material gives the defaults of all other keys",
            Words("none"),
        ),
        Key::new("file_material", "name of the material in the document", Words("the only one")),
        Key::new(
            "file_unit",
            "unit of the document's lengths that state none: `\"mm\"`, `\"cm\"` or `\"m\"`",
            Words("the scene's, with a warning"),
        ),
    ];

    /// The parameters by their keys.
    pub const DESCRIPTION: Thing<Self> = Thing {
        name: "material",
        doc: "a surface with the parameter names of OpenPBR",
        plain: Self::default,
        fields: &[
            field!(Material { base_weight } => SceneSlot::Number(base_weight, Interval::UNIT),
                "number {range}", Plain),
            field!(Material { base_color } => SceneSlot::Color(base_color, Interval::UNIT),
                "color {range}: diffuse albedo, or a metal's reflectance", Plain),
            field!(Material { base_metalness } => SceneSlot::Scalar(base_metalness, Interval::UNIT),
                "scalar {range}", Plain),
            field!(Material { specular_weight } => SceneSlot::Scalar(specular_weight, Interval::UNIT),
                "scalar {range}; 0 removes the interface", Plain),
            field!(Material { specular_color } => SceneSlot::Color(specular_color, Interval::UNIT),
                "color {range}", Plain),
            field!(Material { specular_roughness } => SceneSlot::Scalar(specular_roughness, Interval::UNIT),
                "scalar {range}", Plain),
            field!(Material { specular_ior } => SceneSlot::Number(specular_ior, Interval::IOR),
                "number {range}", Plain),
            field!(Material { transmission_weight } => SceneSlot::Scalar(transmission_weight, Interval::UNIT),
                "scalar {range}", Plain),
            field!(Material { transmission_color } => SceneSlot::Color(transmission_color, Interval::UNIT),
                "color {range}", Plain),
            field!(Material { transmission_depth } => SceneSlot::Length(transmission_depth, Interval::LENGTH),
                "length ≥ 0 at which `transmission_color` is reached; 0 tints each crossing", Plain),
            field!(Material { transmission_tint } => SceneSlot::Color(transmission_tint, Interval::UNIT),
                "color {range}: tint of each crossing beside a `transmission_depth` above 0", Plain),
            field!(Material { subsurface_weight } => SceneSlot::Scalar(subsurface_weight, Interval::UNIT),
                "scalar {range}", Plain),
            field!(Material { subsurface_color } => SceneSlot::Color(subsurface_color, Interval::UNIT),
                "color {range}: surface albedo A", Plain),
            field!(Material { subsurface_radius } => SceneSlot::Scalar(subsurface_radius, Interval::LENGTH),
                "scalar, a length ≥ 0: mean free path ℓ, or ℓ_d", Plain),
            field!(Material { subsurface_radius_scale } => SceneSlot::Color(subsurface_radius_scale, Interval::FACTOR),
                "color {range}: factor on it for each channel", Plain),
            field!(Material { subsurface_scatter_anisotropy } => SceneSlot::Number(subsurface_scatter_anisotropy, Interval::open(-1.0, 1.0)),
                "mean cosine g {range}, for models that know a phase function", Plain),
            field!(Material { subsurface_eta } => SceneSlot::Number(subsurface_eta, Interval::closed(0.5, 3.0)),
                "relative index of refraction {range} at the inside of the surface, for models that know a boundary; 1 is index-matched, whatever `specular_ior` is", Plain),
            field!(Material { subsurface_flights } => SceneSlot::Number(subsurface_flights, Interval::closed(2.0, 65536.0)),
                "flights after which a random walk is given up, a whole number {range}; fewer make bright materials darker", Plain),
            field!(Material { coat_weight } => SceneSlot::Scalar(coat_weight, Interval::UNIT),
                "scalar {range}", Plain),
            field!(Material { coat_color } => SceneSlot::Color(coat_color, Interval::UNIT),
                "color {range}", Plain),
            field!(Material { coat_roughness } => SceneSlot::Scalar(coat_roughness, Interval::UNIT),
                "scalar {range}", Plain),
            field!(Material { coat_ior } => SceneSlot::Number(coat_ior, Interval::IOR), "number {range}", Plain),
            field!(Material { emission_luminance } => SceneSlot::Number(emission_luminance, Interval::LIGHT),
                "number ≥ 0: factor on `emission_color`", Plain),
            field!(Material { emission_color } => SceneSlot::Color(emission_color, Interval::FACTOR),
                "color {range}; times the factor the emitted radiance", Plain),
            field!(Material { geometry_opacity } => SceneSlot::Scalar(geometry_opacity, Interval::UNIT),
                "scalar {range}", Plain),
            field!(Material { geometry_thin_walled } => SceneSlot::Flag(geometry_thin_walled),
                "whether it is a [sheet without an inside](materials.md#thin-walled-surfaces), such as a leaf or a pane", Plain),
            field!(Material { layers } => SceneSlot::Layers(layers); LAYERS),
            field!(Material { subsurface_model } => SceneSlot::Model(subsurface_model); MODEL),
            field!(Material { subsurface_parameter } => SceneSlot::Word(subsurface_parameter),
                "`\"mfp\"`: the radius is ℓ in the volume; `\"dmfp\"`: ℓ_d on the surface", Plain),
            field!(Material { subsurface_configuration } => SceneSlot::Word(subsurface_configuration),
                "`\"searchlight\"` or `\"diffuse\"`: the incident light that the profile is made for, for models that tell the two apart", Plain),
            field!(Material { subsurface_texture_at } => SceneSlot::Word(subsurface_texture_at),
                "`\"exit\"`, `\"entry\"` or `\"both\"`: whose A and ℓ count where textures or vertex colors give entry and exit point different ones ([what they look like](../accuracy/textures.md))", Plain),
            field!(Material { subsurface_normalization } => SceneSlot::Word(subsurface_normalization),
                "`\"none\"`, or `\"energy\"`: any shape returns A in uniform light, however thin or curved, at many times the rendering time ([when to use it](../accuracy/thin-parts.md))", Plain),
            field!(Material { camera_visibility } => SceneSlot::Word(camera_visibility),
                "what the camera sees of it: `\"surface\"`; `\"shadow\"`, only the shadows on it, black with the share of direct light that is missing as alpha; `\"none\"`. Other rays meet it as it is", Plain),
            field!(Material { geometry_normal } => SceneSlot::NormalMap(geometry_normal); NORMAL),
        ],
        rules: RULES,
    };

    /// Every key.
    pub fn keys() -> Vec<&'static str> {
        let origin = Self::ORIGIN_KEYS.iter().map(|key| key.name);
        origin.chain(Self::DESCRIPTION.keys()).collect()
    }

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
        Self::DESCRIPTION.check(self, &Counts { images, profile_tables })
    }

    /// Every reference to an image.
    pub fn for_each_image(&mut self, mut visit: impl FnMut(&mut usize)) {
        Self::DESCRIPTION.visit(self, &mut |_, part| {
            if let Part::Index(index, List::Images) = part {
                visit(index);
            }
        });
    }

    /// Brings every number into its range; what that changed, in words.
    pub fn clamp(&mut self) -> Vec<String> {
        let mut changes = Vec::new();
        Self::DESCRIPTION.visit(self, &mut |name, part| {
            let Part::Number(number, range) = part else { return };
            if name.contains(".texture") {
                return;
            }
            let nearest = range.nearest(*number);
            if nearest != *number {
                let name = name.trim_end_matches(|c: char| "[]0123456789".contains(c));
                changes.push(format!("{name} is {number}, but must be in {range}: it becomes {nearest}"));
                *number = nearest;
            }
        });
        changes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn description_holds_every_field() {
        let shown = format!("{:#?}", Material::default());
        // Fields of the material itself are indented once.
        let fields =
            shown.lines().filter_map(|line| line.strip_prefix("    ").filter(|l| !l.starts_with(' ')));
        let names = fields.filter_map(|line| line.split_once(": ").map(|(name, _)| name));
        let described = Material::keys();
        // Each layer is a table of its own
        let is_described = |name: &&str| described.contains(name) || *name == "layers";
        assert_eq!(names.filter(|name| !is_described(name)).collect::<Vec<_>>(), Vec::<&str>::new());
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
