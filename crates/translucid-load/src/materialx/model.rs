//! The shading models that are read, and how each becomes OpenPBR, whose parameters a material has.

use std::collections::BTreeMap;

use glam::Vec3;
use roxmltree::Node;
use translucid_scene::description::{Field, SceneSlot};
use translucid_scene::{ColorInput, Material, ScalarInput};

use super::graph::Signal;

/// Inputs that become parameters together with others, by their names.
pub(super) type Together = BTreeMap<&'static str, Signal>;

/// Says something of the shader.
type Tell<'t> = &'t dyn Fn(String);

/// A shading model: how its inputs are called, what they are by default, and what they mean.
pub(super) struct ShadingModel {
    category: &'static str,
    /// The material of a shader in which no input is stated.
    pub(super) defaults: fn(Node<'_, '_>) -> Material,
    /// Makes the material that the inputs mean of one that has their numbers.
    pub(super) translate: fn(&mut Material, &Together, Tell<'_>),
    /// Whether `emission_luminance` is in cd/m².
    pub(super) is_photometric: bool,
    /// Inputs that become parameters only together with others.
    pub(super) together: &'static [&'static str],
    /// Inputs with another name than the parameter that they are.
    pub(super) renamed: &'static [(&'static str, &'static str)],
    /// Inputs that have no counterpart, with the value at which they change nothing.
    pub(super) lost: &'static [(&'static str, &'static str)],
    /// Inputs that mean something only beside one of those.
    pub(super) silent: &'static [&'static str],
}

/// OpenPBR Surface 1.1.1, whose names and defaults are ours.
const OPEN_PBR: ShadingModel = ShadingModel {
    category: "open_pbr_surface",
    defaults: |_| Material::default(),
    translate: |_, _, _| {},
    is_photometric: true,
    together: &[],
    renamed: &[],
    lost: &[
        ("base_diffuse_roughness", "0"),
        ("specular_roughness_anisotropy", "0"),
        ("transmission_scatter", "0, 0, 0"),
        ("transmission_dispersion_scale", "0"),
        ("fuzz_weight", "0"),
        ("coat_roughness_anisotropy", "0"),
        ("coat_darkening", "1"),
        ("thin_film_weight", "0"),
        ("geometry_coat_normal", ""),
        ("geometry_tangent", ""),
        ("geometry_coat_tangent", ""),
    ],
    silent: &[
        "transmission_scatter_anisotropy",
        "transmission_dispersion_abbe_number",
        "fuzz_color",
        "fuzz_roughness",
        "thin_film_thickness",
        "thin_film_ior",
    ],
};

/// Autodesk Standard Surface 1.0.1.
const STANDARD: ShadingModel = ShadingModel {
    category: "standard_surface",
    defaults: standard_defaults,
    translate: translate_standard,
    is_photometric: false,
    together: &[],
    renamed: &[
        ("base", "base_weight"),
        ("base_color", "base_color"),
        ("metalness", "base_metalness"),
        ("specular", "specular_weight"),
        ("specular_color", "specular_color"),
        ("specular_roughness", "specular_roughness"),
        ("specular_IOR", "specular_ior"),
        ("transmission", "transmission_weight"),
        ("transmission_color", "transmission_color"),
        ("transmission_depth", "transmission_depth"),
        ("subsurface", "subsurface_weight"),
        ("subsurface_color", "subsurface_color"),
        ("subsurface_scale", "subsurface_radius"),
        ("subsurface_radius", "subsurface_radius_scale"),
        ("subsurface_anisotropy", "subsurface_scatter_anisotropy"),
        ("coat", "coat_weight"),
        ("coat_color", "coat_color"),
        ("coat_roughness", "coat_roughness"),
        ("coat_IOR", "coat_ior"),
        ("emission", "emission_luminance"),
        ("emission_color", "emission_color"),
        ("opacity", "geometry_opacity"),
        ("normal", "geometry_normal"),
    ],
    lost: &[
        ("diffuse_roughness", "0"),
        ("specular_anisotropy", "0"),
        ("transmission_scatter", "0, 0, 0"),
        ("transmission_dispersion", "0"),
        ("transmission_extra_roughness", "0"),
        ("sheen", "0"),
        ("coat_anisotropy", "0"),
        ("coat_affect_color", "0"),
        ("coat_affect_roughness", "0"),
        ("thin_film_thickness", "0"),
        ("coat_normal", ""),
        ("tangent", ""),
    ],
    silent: &[
        "specular_rotation",
        "transmission_scatter_anisotropy",
        "sheen_color",
        "sheen_roughness",
        "coat_rotation",
        "thin_film_IOR",
    ],
};

/// glTF PBR 2.0.1.
const GLTF: ShadingModel = ShadingModel {
    category: "gltf_pbr",
    defaults: gltf_defaults,
    translate: translate_gltf,
    is_photometric: false,
    together: &["alpha", "alpha_mode", "alpha_cutoff", "attenuation_color", "attenuation_distance"],
    renamed: &[
        ("base_color", "base_color"),
        ("metallic", "base_metalness"),
        ("roughness", "specular_roughness"),
        ("normal", "geometry_normal"),
        ("transmission", "transmission_weight"),
        ("specular", "specular_weight"),
        ("specular_color", "specular_color"),
        ("ior", "specular_ior"),
        ("clearcoat", "coat_weight"),
        ("clearcoat_roughness", "coat_roughness"),
        ("emissive", "emission_color"),
        ("emissive_strength", "emission_luminance"),
    ],
    lost: &[
        ("iridescence", "0"),
        ("sheen_color", "0, 0, 0"),
        ("anisotropy_strength", "0"),
        ("dispersion", "0"),
        ("clearcoat_normal", "0, 0, 1"),
        ("tangent", ""),
    ],
    silent: &[
        "occlusion",
        "thickness",
        "iridescence_ior",
        "iridescence_thickness",
        "sheen_roughness",
        "anisotropy_rotation",
    ],
};

/// UsdPreviewSurface 2.6.
const USD: ShadingModel = ShadingModel {
    category: "UsdPreviewSurface",
    defaults: usd_defaults,
    translate: translate_usd,
    is_photometric: false,
    together: &["opacity", "opacityMode", "opacityThreshold", "useSpecularWorkflow", "specularColor"],
    renamed: &[
        ("diffuseColor", "base_color"),
        ("emissiveColor", "emission_color"),
        ("metallic", "base_metalness"),
        ("roughness", "specular_roughness"),
        ("clearcoat", "coat_weight"),
        ("clearcoatRoughness", "coat_roughness"),
        ("ior", "specular_ior"),
        ("normal", "geometry_normal"),
    ],
    lost: &[("displacement", "0")],
    silent: &["occlusion"],
};

/// Disney Principled, as MaterialX defines it.
const DISNEY: ShadingModel = ShadingModel {
    category: "disney_principled",
    defaults: disney_defaults,
    translate: translate_disney,
    is_photometric: false,
    together: &["specular", "specularTint", "clearcoatGloss"],
    renamed: &[
        ("baseColor", "base_color"),
        ("metallic", "base_metalness"),
        ("roughness", "specular_roughness"),
        ("clearcoat", "coat_weight"),
        ("specTrans", "transmission_weight"),
        ("ior", "specular_ior"),
        ("subsurface", "subsurface_weight"),
        ("subsurfaceDistance", "subsurface_radius_scale"),
    ],
    lost: &[("anisotropic", "0"), ("sheen", "0")],
    silent: &["sheenTint"],
};

/// The parameters of a material that are numbers, scalars or colors.
pub(super) fn numbers() -> impl Iterator<Item = &'static Field<Material>> {
    let mut plain = Material::default();
    Material::DESCRIPTION.fields.iter().filter(move |field| {
        let slot = (field.slot)(&mut plain);
        matches!(
            slot,
            SceneSlot::Number(..) | SceneSlot::Length(..) | SceneSlot::Scalar(..) | SceneSlot::Color(..)
        )
    })
}

impl ShadingModel {
    const ALL: [&'static Self; 5] = [&OPEN_PBR, &STANDARD, &GLTF, &USD, &DISNEY];

    /// Categories of the shaders that can be read.
    pub(super) const CATEGORIES: [&'static str; 5] =
        [OPEN_PBR.category, STANDARD.category, GLTF.category, USD.category, DISNEY.category];

    /// The model of a shader.
    pub(super) fn of(shader: Node<'_, '_>) -> Option<&'static Self> {
        Self::ALL.into_iter().find(|model| model.category == shader.tag_name().name())
    }

    /// The parameter that an input is, by our name.
    pub(super) fn parameter(&self, input: &str) -> Option<&'static str> {
        if self.category != OPEN_PBR.category {
            return self.renamed.iter().find(|(name, _)| *name == input).map(|&(_, parameter)| parameter);
        }
        let plain = numbers().map(Field::key).chain(["geometry_normal"]);
        // Those that OpenPBR does not have
        plain
            .filter(|name| !matches!(*name, "subsurface_eta" | "subsurface_flights"))
            .find(|name| *name == input)
    }

    pub(super) fn inputs(&self) -> impl Iterator<Item = &'static str> {
        let ours = numbers().map(Field::key).filter(|name| self.parameter(name).is_some());
        let renamed = self.renamed.iter().map(|(name, _)| *name).chain(self.together.iter().copied());
        ours.chain(renamed).chain(self.lost.iter().map(|(name, _)| *name)).chain(self.silent.iter().copied())
    }

    /// Whether its surfaces can be sheets without an inside, by an input of this name.
    pub(super) fn has_thin_walls(&self, input: &str) -> bool {
        (self.category == OPEN_PBR.category && input == "geometry_thin_walled")
            || (self.category == STANDARD.category && input == "thin_walled")
    }
}

/// The materials of a document; where there are none, the shaders.
pub(super) fn materials<'d>(root: Node<'d, 'd>) -> Vec<Node<'d, 'd>> {
    let of = |categories: &[&str]| -> Vec<Node<'d, 'd>> {
        let is_one =
            |child: &Node<'d, 'd>| child.is_element() && categories.contains(&child.tag_name().name());
        root.children().filter(is_one).collect()
    };
    let all = of(&["surfacematerial"]);
    if all.is_empty() { of(&ShadingModel::CATEGORIES) } else { all }
}

fn standard_defaults(shader: Node<'_, '_>) -> Material {
    // Version 1.0.0 has the weight in `base`, 1.0.1 in `base_color`
    let is_first = shader.attribute("version") == Some("1.0.0");
    let (base_weight, base_color) = if is_first { (0.8, 1.0) } else { (1.0, 0.8) };
    Material {
        base_weight,
        base_color: ColorInput::constant(Vec3::splat(base_color)),
        specular_roughness: ScalarInput::constant(0.2),
        subsurface_color: ColorInput::constant(Vec3::ONE),
        subsurface_radius_scale: ColorInput::constant(Vec3::ONE),
        coat_roughness: ScalarInput::constant(0.1),
        coat_ior: 1.5,
        ..Material::default()
    }
}

/// Translates metals as NG_standard_surface_to_open_pbr_surface of MaterialX 1.39 does: the weight of their highlight is 1, a
/// black edge is none, and their coat is a tint alone.
///
/// It tints what is under the coat of other materials, too, and keeps the coat's color besides; here that counts once, as in
/// Standard Surface itself.
fn translate_standard(material: &mut Material, _: &Together, tell: Tell<'_>) {
    if material.base_metalness.factor <= 0.0 {
        return;
    }
    let whole = ScalarInput::constant(1.0);
    if material.base_metalness != whole && material.specular_weight != whole {
        tell(String::from(
            "specular is left out, as for metals, and so it is where the material is no metal",
        ));
    }
    material.specular_weight = whole;
    if material.specular_color.factor == Vec3::ZERO {
        material.specular_color = ColorInput::constant(Vec3::ONE);
    }
    let coat = std::mem::replace(&mut material.coat_weight, ScalarInput::constant(0.0));
    let (tint, base) = (material.coat_color, &mut material.base_color);
    match (coat.texture, tint.texture, base.texture) {
        (None, None, _) => base.factor *= Vec3::ONE.lerp(tint.factor, coat.factor),
        (None, Some(_), None) if coat.factor == 1.0 => {
            *base = ColorInput { factor: base.factor * tint.factor, ..tint };
        }
        _ if coat.factor == 0.0 || tint == ColorInput::constant(Vec3::ONE) => {}
        _ => {
            tell(String::from("coat_color tints metals by constants alone: the coat stays over the metal"));
            material.coat_weight = coat;
        }
    }
}

fn gltf_defaults(_: Node<'_, '_>) -> Material {
    Material {
        base_color: ColorInput::constant(Vec3::ONE),
        base_metalness: ScalarInput::constant(1.0),
        specular_roughness: ScalarInput::constant(1.0),
        coat_roughness: ScalarInput::constant(0.0),
        coat_ior: 1.5,
        emission_color: ColorInput::constant(Vec3::ZERO),
        emission_luminance: 1.0,
        ..Material::default()
    }
}

fn translate_gltf(material: &mut Material, together: &Together, tell: Tell<'_>) {
    reflect_fully(material, tell);
    let mode = constant(together, "alpha_mode", 0.0, tell);
    if let Some(alpha) = together.get("alpha").filter(|_| mode != 0.0) {
        let cutoff = constant(together, "alpha_cutoff", 0.5, tell);
        material.geometry_opacity = match mode {
            1.0 => cut(alpha, cutoff, tell),
            _ => scalar(alpha),
        };
    }
    let distance = constant(together, "attenuation_distance", 0.0, tell);
    if distance > 0.0
        && material.transmission_weight.factor > 0.0
        && together.contains_key("attenuation_color")
    {
        tell(String::from("attenuation_color and attenuation_distance have no counterpart here: left out"));
    }
    material.transmission_color = material.base_color;
}

fn usd_defaults(_: Node<'_, '_>) -> Material {
    Material {
        base_color: ColorInput::constant(Vec3::splat(0.18)),
        specular_roughness: ScalarInput::constant(0.5),
        coat_roughness: ScalarInput::constant(0.01),
        emission_color: ColorInput::constant(Vec3::ZERO),
        emission_luminance: 1.0,
        ..Material::default()
    }
}

fn translate_usd(material: &mut Material, together: &Together, tell: Tell<'_>) {
    // IMP_UsdPreviewSurface_surfaceshader has one index for both interfaces
    material.coat_ior = material.specular_ior;
    if constant(together, "useSpecularWorkflow", 0.0, tell) == 1.0 {
        material.base_metalness = ScalarInput::constant(0.0);
        match together.get("specularColor") {
            Some(Signal { texture: Some(_), .. }) => {
                tell(String::from("specularColor may not vary over the surface here: ior counts"));
            }
            found => {
                let color = found.map_or(Vec3::ZERO, Signal::color);
                let greatest = color.max_element().clamp(0.0, 0.99);
                material.specular_ior = ior_of(greatest);
                material.specular_color = ColorInput::constant(color / greatest.max(1e-6));
                material.specular_weight = ScalarInput::constant(if greatest > 0.0 { 1.0 } else { 0.0 });
            }
        }
    }
    let Some(opacity) = together.get("opacity") else { return };
    let threshold = constant(together, "opacityThreshold", 0.0, tell);
    let is_presence = constant(together, "opacityMode", 0.0, tell) == 1.0;
    match opacity.texture {
        _ if threshold > 0.0 => material.geometry_opacity = cut(opacity, threshold, tell),
        _ if is_presence => material.geometry_opacity = scalar(opacity),
        Some(_) => {
            tell(String::from("opacity by an image is taken as presence, in place of refraction"));
            material.geometry_opacity = scalar(opacity);
        }
        None => {
            let opacity = opacity.factor[0].clamp(0.0, 1.0);
            material.transmission_weight = ScalarInput::constant(1.0 - opacity);
        }
    }
}

fn disney_defaults(_: Node<'_, '_>) -> Material {
    Material {
        base_color: ColorInput::constant(Vec3::splat(0.16)),
        specular_roughness: ScalarInput::constant(0.5),
        coat_roughness: ScalarInput::constant(0.0),
        coat_ior: 1.5,
        subsurface_radius_scale: ColorInput::constant(Vec3::ONE),
        ..Material::default()
    }
}

/// NG_disney_principled, whose highlight reflects 0.08 times `specular` where light comes straight.
fn translate_disney(material: &mut Material, together: &Together, tell: Tell<'_>) {
    material.transmission_color = material.base_color;
    material.subsurface_color = material.base_color;
    material.coat_roughness =
        ScalarInput::constant(1.0 - constant(together, "clearcoatGloss", 1.0, tell).clamp(0.0, 1.0));
    if material.transmission_weight.factor == 0.0 {
        material.specular_ior = ior_of((0.08 * constant(together, "specular", 0.5, tell)).clamp(0.0, 0.99));
    }
    let tint = constant(together, "specularTint", 0.0, tell).clamp(0.0, 1.0);
    if tint > 0.0 {
        if material.base_color.texture.is_some() {
            tell(String::from("specularTint of an image is left out: the highlight is white"));
        } else {
            material.specular_color = ColorInput::constant(Vec3::ONE.lerp(material.base_color.factor, tint));
        }
    }
    reflect_fully(material, tell);
}

fn reflect_fully(material: &mut Material, tell: Tell<'_>) {
    if let Some(change) = crate::metal::reflect_fully(material) {
        tell(change.to_owned());
    }
}

/// The number of an input that may not vary over the surface.
fn constant(together: &Together, name: &'static str, otherwise: f32, tell: Tell<'_>) -> f32 {
    match together.get(name) {
        Some(Signal { texture: Some(_), .. }) => {
            tell(format!("{name} may not vary over the surface here, but has an image: it is {otherwise}"));
            otherwise
        }
        Some(Signal { factor: [number, ..], .. }) => *number,
        None => otherwise,
    }
}

fn scalar(signal: &Signal) -> ScalarInput {
    let factor = signal.factor[0].clamp(0.0, 1.0);
    ScalarInput { factor, texture: signal.texture.map(|texture| (texture, signal.channel)) }
}

/// An opacity that is 0 below a cutoff and else 1.
fn cut(signal: &Signal, cutoff: f32, tell: Tell<'_>) -> ScalarInput {
    if signal.texture.is_some() {
        tell(format!("an image of opacity is not cut at {cutoff}: it is opacity as it is"));
        return scalar(signal);
    }
    ScalarInput::constant(if signal.factor[0] >= cutoff { 1.0 } else { 0.0 })
}

/// The index of refraction of a reflectance at normal incidence.
fn ior_of(reflectance: f32) -> f32 {
    (1.0 + reflectance.sqrt()) / (1.0 - reflectance.sqrt())
}
