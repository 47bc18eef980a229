//! The known systems: names, versions, rules, and where each rule was read.

use super::rule::{
    Factor::{
        Fifth, OfGreatestAlpha, One, OverDiffuseMfp, OverFourPiDiffuse, OverFourPiDiffuseOfRelative,
        OverOneMinusAlphaG, OverSearchlight, OverSixTenthsSearchlight, OverSixTenthsSigned,
    },
    Rule::{self, Medium, MediumAsProfile, Mfp, Width},
};
use super::{
    CyclesMethod::{self, Burley, RandomWalk, RandomWalkLegacy, RandomWalkSkin},
    Parameter,
    Role::{self, Absorption, Attenuation, Distance, Filter, Length, Scattering},
    Source, System, Unit, parameter,
};

const fn factor(name: &'static str, default: f64, per: f64) -> Parameter {
    Role::Factor { default, per }.named(name)
}

const fn setting(
    name: &'static str,
    default: f64,
    [above, below]: [f64; 2],
    allowed: &'static str,
) -> Parameter {
    Role::Setting { default, above, below, allowed }.named(name)
}

const G: Parameter = setting("g", 0.0, [-1.0, 1.0], "in (-1, 1)");
// Cycles keeps it in [1.01, 3.8] by itself
const SKIN_IOR: Parameter = setting("subsurface_ior", 1.4, [0.0, 10.0], "in (0, 10)");
const G_OF_WALK: Parameter = setting(parameter::WALK_G, 0.0, [-0.9 - 1e-9, 0.9 + 1e-9], "in [-0.9, 0.9]");
const G_OF_GLTF: Parameter = setting("scatterAnisotropy", 0.0, [-1.0, 1.0], "in (-1, 1)");
const WALK_G: Parameter = setting(parameter::WALK_G, 0.0, [-1e-9, 0.9 + 1e-9], "in [0, 0.9]");
// A distance, of which 0 is none
const ABSORPTION_DISTANCE: Parameter =
    setting("absorptionDistance", 0.0, [-1e-110, 1e110], "0 for none, or in (0, 1e110)");

const RADIUS_AND_SCALE: &[Parameter] =
    &[Length.named("subsurface_radius"), Distance.named("subsurface_scale")];
const UNREAL: &[Parameter] = &[
    Length.named("MeanFreePathColor"),
    Distance.named("MeanFreePathDistance"),
    factor("WorldUnitScale", 0.1, 0.1),
];

/// A row of the table, whose length is in the scene's unit and has no least value: the system's name, title, version and name
/// of the surface albedo, empty where coefficients determine it; the kind and the place of its source.
const fn system(
    [name, title, version, albedo]: [&'static str; 4],
    parameters: &'static [Parameter],
    rule: Rule,
    formula: &'static str,
    [kind, place]: [&'static str; 2],
) -> System {
    System {
        name,
        title,
        version,
        albedo_name: if albedo.is_empty() { None } else { Some(albedo) },
        parameters,
        unit: None,
        rule,
        cycles: None,
        formula,
        least_length: None,
        source: Source { place, kind },
    }
}

/// A row for a method of Blender Cycles, which has its rule.
const fn cycles(
    method: CyclesMethod,
    names: [&'static str; 4],
    parameters: &'static [Parameter],
    formula: &'static str,
    source: [&'static str; 2],
) -> System {
    let rule = match method {
        Burley => Width(method.factor()),
        _ => Mfp(method.factor()),
    };
    System { cycles: Some(method), ..system(names, parameters, rule, formula, source) }
}

impl System {
    /// Every known system.
    pub const ALL: &'static [Self] = KNOWN;

    /// The ways in which the system of a name can be told a material.
    pub fn named(name: &str) -> impl Iterator<Item = &'static Self> {
        KNOWN.iter().filter(move |system| system.name == name)
    }

    const fn in_unit(self, unit: Unit) -> Self {
        Self { unit: Some(unit), ..self }
    }

    const fn at_least(self, length: f64) -> Self {
        Self { least_length: Some(length), ..self }
    }
}

/// Every known system.
#[rustfmt::skip]
const KNOWN: &[System] = &[
    system(["translucid", "translucid, mean free path", "0.1", "surface_albedo"],
        &[Length.named("mfp")], Mfp(One), "mfp = length",
        ["code", "translucid-profile, scaling.rs"]),
    system(["translucid", "translucid, diffuse mean free path", "0.1", "surface_albedo"],
        &[Length.named("dmfp")], Width(OverDiffuseMfp(0.0)), "d = length/s(A), s from dmfp",
        ["code", "translucid-profile, scaling.rs"]),
    system(["translucid", "translucid, width of Burley's profile", "0.1", "surface_albedo"],
        &[Length.named("d")], Width(One), "d = length",
        ["code", "translucid-profile, burley.rs"]),
    cycles(Burley, ["cycles-burley", "Blender Cycles, Christensen-Burley", "3.0 to 5.3", "base_color"],
        RADIUS_AND_SCALE, "d = length/(4 pi), cut at 16 d and renormalized",
        ["code", "Blender intern/cycles/kernel/closure/bssrdf.h, bssrdf_setup_radius (copy Tony7466/BLENDER@7786526)"]),
    cycles(RandomWalk, ["cycles-walk", "Blender Cycles, Random Walk since 5.2", "5.2 and 5.3", "base_color"],
        &[Length.named("subsurface_radius"), Distance.named("subsurface_scale"), G_OF_WALK],
        "mfp = length/(1 - alpha g), alpha of the color; a color comes out as another",
        ["measured", "pictures of Blender 5.2.3 and 5.3.0 (blender/tests/test_subsurface.py)"]),
    cycles(RandomWalkLegacy, ["cycles-walk-legacy", "Blender Cycles, Random Walk (Legacy), before 5.2 Random Walk, before 4.0 with Fixed Radius",
        "3.0 to 5.3", "base_color"],
        &[Length.named("subsurface_radius"), Distance.named("subsurface_scale"), WALK_G],
        "mfp = length (1 - g)/(4 pi (1 - alpha g)), alpha of the color; a color comes out as another",
        ["code", "Blender intern/cycles/kernel/closure/bssrdf.h, bssrdf_setup_radius (copy Tony7466/BLENDER@7786526)"]),
    cycles(RandomWalkSkin, ["cycles-skin", "Blender Cycles, Random Walk (Skin), before 4.0 Random Walk", "3.0 to 5.3", "base_color"],
        &[Length.named("subsurface_radius"), Distance.named("subsurface_scale"), SKIN_IOR, WALK_G],
        "mfp = length sqrt(3 (1 - alpha')) (1 - g)/(1 - alpha g), alpha' of a dipole; a color comes out as another",
        ["code", "Blender intern/cycles/kernel/closure/bssrdf.h, bssrdf_setup_radius (copy Tony7466/BLENDER@7786526)"]),
    system(["cycles-2.9", "Blender Cycles before 3.0, Christensen-Burley", "2.8 and 2.9", "subsurface_color"],
        &[Length.named("subsurface_radius")], Width(OverFourPiDiffuse), "d = length/(4 pi s(A)), s diffuse",
        ["code", "blender/blender@6529d20 intern/cycles/kernel/closure/bssrdf.h, bssrdf_burley_setup"]),
    system(["eevee", "Blender EEVEE", "3.x and 4.x", "base_color"],
        RADIUS_AND_SCALE, Width(OverFourPiDiffuseOfRelative), "d = length/(4 pi s(A/max A)), s diffuse",
        ["code", "blender/blender@103e878 .../eevee_next/shaders/eevee_subsurface_convolve_comp.glsl"]),
    system(["pbrt", "pbrt, coefficients", "v4", ""],
        &[Absorption.named("sigma_a"), Scattering.named("sigma_s"), G, factor("scale", 1.0, 1.0)], Medium,
        "mfp = 1/(scale (sigma_a + (1 - g) sigma_s))",
        ["code", "mmp/pbrt-v4@04fd052 src/pbrt/materials.h, SubsurfaceMaterial"]),
    system(["pbrt", "pbrt, reflectance and mean free path", "v4", "reflectance"],
        &[Length.named("mfp"), factor("scale", 1.0, 1.0)], Mfp(One), "mfp = length",
        ["code", "mmp/pbrt-v4@04fd052 src/pbrt/materials.h, SubsurfaceMaterial"]),
    system(["pbrt-v3-disney", "pbrt-v3, disney material", "v3", "color"],
        &[Length.named("scatterdistance")], Width(Fifth), "d = 0.2 length",
        ["code", "mmp/pbrt-v3@50bec5e src/materials/disney.cpp, DisneyBSSRDF"]),
    system(["appleseed", "appleseed, normalized diffusion", "2018", "reflectance"],
        &[Length.named("mfp"), factor("mfp_multiplier", 1.0, 1.0)], Width(OverSearchlight(0.001, 0.999)),
        "d = length/s(A), s searchlight",
        ["code", "appleseedhq/appleseed@c39aed7 .../bssrdf/normalizeddiffusionbssrdf.cpp, sss.cpp"]).at_least(1e-6),
    system(["appleseed-random-walk", "appleseed, random walk", "2018", "reflectance"],
        &[Length.named("mfp"), factor("mfp_multiplier", 1.0, 1.0)], Mfp(One), "mfp = length",
        ["code", "appleseedhq/appleseed@c39aed7 .../bssrdf/randomwalkbssrdf.cpp"]).at_least(1e-6),
    system(["moonray", "MoonRay, normalized diffusion", "2024", "albedo"],
        &[Length.named("radius")], Width(OverDiffuseMfp(0.001)), "d = length/s(A), s from dmfp",
        ["code", "dreamworksanimation/moonray@6f49185 lib/rendering/shading/bssrdf/NormalizedDiffusion.cc"]).at_least(0.001),
    system(["renderman", "RenderMan PxrSurface, Burley Normalized", "22 and later", "subsurfaceColor"],
        &[Distance.named("dmfp"), Length.named("dmfpColor"), factor("unitLength", 0.1, 1.0)], Width(OverDiffuseMfp(0.0)),
        "d = length/s(A), s from dmfp",
        ["document", "rmanwiki.pixar.com, PxrSurface: dmfp x dmfpColor x unitLength; s(A) after the talk (code not public)"]),
    system(["arnold", "Arnold standard_surface, random walk", "5 and later", "subsurface_color"],
        RADIUS_AND_SCALE, Mfp(One), "mfp = length",
        ["document", "Autodesk/standard-surface@0ee942e index.html: radii are mean free paths (code not public)"]),
    system(["unreal", "Unreal Engine, subsurface profile with mean free path", "5.1 and later", "SurfaceAlbedo"],
        UNREAL, Width(OverSixTenthsSearchlight), "d = length/(0.6 s(A)), s searchlight",
        ["code", "Unreal Engine SubsurfaceProfile.cpp, UpgradeDiffuseMeanFreePathToMeanFreePath, and \
         BurleyNormalizedSSSCommon.ush, GetMFPFromDMFPCoeff (copies)"]).in_unit(Unit::Centimeter),
    system(["unreal-5.0", "Unreal Engine, subsurface profile with diffuse mean free path", "5.0 and before", "SurfaceAlbedo"],
        UNREAL, Width(OverDiffuseMfp(0.0)), "d = length/s(A), s from dmfp",
        ["code", "Unreal Engine BurleyNormalizedSSS.cpp, GetSearchLightDiffuseScalingFactor (copy)"]).in_unit(Unit::Centimeter),
    system(["unreal-signed", "Unreal Engine, internal mean free path before s(A) had its absolute value",
        "5.0 and before", "SurfaceAlbedo"],
        &[Length.named("mean_free_path")], Width(OverSixTenthsSigned), "d = length/(0.6 s(A)), s = 1.85 - A + 7 (A - 0.8)^3",
        ["code", "Unreal Engine BurleyNormalizedSSS.cpp, GetPerpendicularScalingFactor (older copy)"]).in_unit(Unit::Centimeter),
    system(["substrate", "Unreal Engine, Substrate Slab", "5.2 and later", "DiffuseAlbedo"],
        &[Length.named("SSSMFP"), Distance.named("SSSMFPScale")], Mfp(One), "mfp = length",
        ["document", "dev.epicgames.com, Overview of Substrate Materials: the distance in centimeters before a collision"]).in_unit(Unit::Centimeter),
    system(["substrate", "Unreal Engine, Substrate Transmittance-To-MeanFreePath", "5.2 and later", "DiffuseAlbedo"],
        &[Distance.named("Thickness"), Attenuation.named("TransmittanceColor")], Mfp(One),
        "mfp = Thickness/-ln(TransmittanceColor)",
        ["document", "dev.epicgames.com, Overview of Substrate Materials: the color is reached at the thickness, \
         by default 0.01 cm"]).in_unit(Unit::Centimeter),
    system(["hdrp", "Unity HDRP, diffusion profile", "since 2018", "baseColor"],
        &[Length.named("scatteringDistance"), Distance.named("scatteringDistanceMultiplier")], Width(One), "d = length",
        ["code", "Unity-Technologies/Graphics@75b3fc1 .../DiffusionProfile/DiffusionProfileSettings.cs, UpdateKernel"]).in_unit(Unit::Millimeter),
    system(["openpbr", "OpenPBR Surface", "1.x", "subsurface_color"],
        &[Distance.named("subsurface_radius"), Length.named("subsurface_radius_scale")], Mfp(One),
        "mfp = length, in units of the scene",
        ["document", "AcademySoftwareFoundation/OpenPBR@0042276 and 1.1.1 index.html, Subsurface: mu_t = 1/r; Metadata: \
         lengths are in units of world space"]),
    system(["gltf", "glTF, KHR_materials_volume with KHR_materials_volume_scatter or KHR_materials_scatter",
        "drafts of 2025 and 2026", "multiscatterColorFactor"],
        &[Distance.named("attenuationDistance"), Attenuation.named("attenuationColor"), G_OF_GLTF], Mfp(OverOneMinusAlphaG),
        "mfp = attenuationDistance/(-ln(attenuationColor) (1 - alpha g)), alpha of the color",
        ["document", "KhronosGroup/glTF@4608553 and @0addbb0, KHR_materials_volume_scatter and KHR_materials_scatter, README.md"]).in_unit(Unit::Meter),
    system(["adobe", "Adobe Standard Material", "2026.07", "scatteringColor"],
        &[Distance.named("scatteringDistance"), Length.named("scatteringDistanceScale"), ABSORPTION_DISTANCE,
        Filter.named("absorptionColor")], Mfp(OfGreatestAlpha),
        "sigma_s = max(alpha)/length, alpha of the color; sigma_a = sigma_s (1 - alpha)/alpha - ln(absorptionColor)/absorptionDistance",
        ["code", "adobe/USD-Fileformat-plugins@6441b97 gltf/src/gltfImport.cpp, convertVolumeScatterToASM"]),
    system(["karma", "Karma, MtlX Subsurface BSDF", "Houdini 20", "color"],
        &[Length.named("radius")], Mfp(One), "mfp = length",
        ["document", "sidefx.com/docs, mtlxsubsurface_bsdf: the mean free path of the material"]),
    system(["vray", "V-Ray 7, V-Ray Material as OpenPBR", "7", "translucency_color"],
        &[Distance.named("fog_mult"), Length.named("fog_color")], Mfp(One), "mfp = length, in units of the scene",
        ["document", "docs.chaos.com, OpenPBR Shading Model: subsurface_radius and its scale by V-Ray's names"]),
    system(["materialx", "MaterialX subsurface_bsdf, as a profile", "1.39", "color"],
        &[Length.named("radius")], Width(One), "d = length",
        ["code", "MaterialX libraries/pbrlib/genglsl/lib/mx_microfacet_diffuse.glsl, and PBR specification, \
         Subsurface Scattering Model (copies)"]).at_least(0.1),
    system(["rise", "RISE, Burley normalized diffusion", "2026", ""],
        &[Absorption.named("absorption"), Scattering.named("scattering"), G], MediumAsProfile,
        "d = mfp/s(alpha'), s diffuse; alpha' counts as surface albedo",
        ["code", "aravindkrishnaswamy/RISE@0dea553 src/Library/Materials/BurleyNormalizedDiffusionProfile.cpp"]),
    system(["sort", "SORT, Disney and SSS materials", "2023", "baseColor"],
        &[Length.named("scatterDistance")], Width(OverFourPiDiffuse), "d = length/(4 pi s(A)), s diffuse",
        ["code", "JiayinCao/SORT@7d33060 src/scatteringevent/bsdf/disney.cpp, DisneyBssrdf"]),
];
