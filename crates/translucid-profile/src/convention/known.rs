//! The known systems: names, versions, rules, and where each rule was read.

use super::rule::{Factor, Rule};
use super::{CyclesMethod, LengthUnit, Parameter, Role, Source, System, parameter};

const fn length(name: &'static str) -> Parameter {
    Parameter { name, role: Role::Length }
}

const fn distance(name: &'static str) -> Parameter {
    Parameter { name, role: Role::Distance }
}

const fn attenuation(name: &'static str) -> Parameter {
    Parameter { name, role: Role::Attenuation }
}

const fn factor(name: &'static str, default: f64, per: f64) -> Parameter {
    Parameter { name, role: Role::Factor { default, per } }
}

const fn setting(
    name: &'static str,
    default: f64,
    [above, below]: [f64; 2],
    allowed: &'static str,
) -> Parameter {
    Parameter { name, role: Role::Setting { default, above, below, allowed } }
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

const CYCLES: &[Parameter] = &[length("subsurface_radius"), distance("subsurface_scale")];
const UNREAL: &[Parameter] =
    &[length("MeanFreePathColor"), distance("MeanFreePathDistance"), factor("WorldUnitScale", 0.1, 0.1)];

const fn code(place: &'static str) -> Source {
    Source { place, kind: "code" }
}

const fn document(place: &'static str) -> Source {
    Source { place, kind: "document" }
}

const fn measured(place: &'static str) -> Source {
    Source { place, kind: "measured" }
}

/// A system whose length is in the scene's unit and has no least value.
const fn system(
    name: &'static str,
    title: &'static str,
    version: &'static str,
    parameters: &'static [Parameter],
    rule: Rule,
    formula: &'static str,
    source: Source,
) -> System {
    System {
        name,
        title,
        version,
        albedo_name: match rule {
            Rule::Width(_) | Rule::Mfp(_) => Some("surface_albedo"),
            Rule::Medium | Rule::MediumAsProfile => None,
        },
        parameters,
        unit: LengthUnit::Scene,
        rule,
        cycles: None,
        formula,
        least_length: None,
        source,
    }
}

/// A method of Blender Cycles, which has its rule.
const fn cycles(
    method: CyclesMethod,
    name: &'static str,
    title: &'static str,
    version: &'static str,
    parameters: &'static [Parameter],
    formula: &'static str,
    source: Source,
) -> System {
    let rule = match method {
        CyclesMethod::Burley => Rule::Width(method.factor()),
        _ => Rule::Mfp(method.factor()),
    };
    let system = system(name, title, version, parameters, rule, formula, source);
    System { cycles: Some(method), ..system.albedo("base_color") }
}

impl System {
    /// Every known system.
    pub const ALL: &'static [Self] = KNOWN;

    /// The ways in which the system of a name can be told a material.
    pub fn named(name: &str) -> impl Iterator<Item = &'static Self> {
        KNOWN.iter().filter(move |system| system.name == name)
    }

    const fn albedo(mut self, name: &'static str) -> Self {
        self.albedo_name = Some(name);
        self
    }

    const fn in_unit_of_its_own(mut self, unit: LengthUnit) -> Self {
        self.unit = unit;
        self
    }

    const fn at_least(mut self, length: f64) -> Self {
        self.least_length = Some(length);
        self
    }
}

/// Every known system.
const KNOWN: &[System] = &[
    system(
        "translucid",
        "translucid, mean free path",
        "0.1",
        &[length("mfp")],
        Rule::Mfp(Factor::One),
        "mfp = length",
        code("translucid-profile, scaling.rs"),
    ),
    system(
        "translucid",
        "translucid, diffuse mean free path",
        "0.1",
        &[length("dmfp")],
        Rule::Width(Factor::OverDiffuseMfp(0.0)),
        "d = length/s(A), s from dmfp",
        code("translucid-profile, scaling.rs"),
    ),
    system(
        "translucid",
        "translucid, width of Burley's profile",
        "0.1",
        &[length("d")],
        Rule::Width(Factor::One),
        "d = length",
        code("translucid-profile, burley.rs"),
    ),
    cycles(
        CyclesMethod::Burley,
        "cycles-burley",
        "Blender Cycles, Christensen-Burley",
        "3.0 to 5.3",
        CYCLES,
        "d = length/(4 pi), cut at 16 d and renormalized",
        code("Blender intern/cycles/kernel/closure/bssrdf.h, bssrdf_setup_radius (copy Tony7466/BLENDER@7786526)"),
    ),
    cycles(
        CyclesMethod::RandomWalk,
        "cycles-walk",
        "Blender Cycles, Random Walk since 5.2",
        "5.2 and 5.3",
        &[length("subsurface_radius"), distance("subsurface_scale"), G_OF_WALK],
        "mfp = length/(1 - alpha g), alpha of the color; a color comes out as another",
        measured("pictures of Blender 5.2.3 and 5.3.0 (blender/tests/test_subsurface.py)"),
    ),
    cycles(
        CyclesMethod::RandomWalkLegacy,
        "cycles-walk-legacy",
        "Blender Cycles, Random Walk (Legacy), before 5.2 Random Walk, before 4.0 with Fixed Radius",
        "3.0 to 5.3",
        &[length("subsurface_radius"), distance("subsurface_scale"), WALK_G],
        "mfp = length (1 - g)/(4 pi (1 - alpha g)), alpha of the color; a color comes out as another",
        code("Blender intern/cycles/kernel/closure/bssrdf.h, bssrdf_setup_radius (copy Tony7466/BLENDER@7786526)"),
    ),
    cycles(
        CyclesMethod::RandomWalkSkin,
        "cycles-skin",
        "Blender Cycles, Random Walk (Skin), before 4.0 Random Walk",
        "3.0 to 5.3",
        &[length("subsurface_radius"), distance("subsurface_scale"), SKIN_IOR, WALK_G],
        "mfp = length sqrt(3 (1 - alpha')) (1 - g)/(1 - alpha g), alpha' of a dipole; a color comes out as another",
        code("Blender intern/cycles/kernel/closure/bssrdf.h, bssrdf_setup_radius (copy Tony7466/BLENDER@7786526)"),
    ),
    system(
        "cycles-2.9",
        "Blender Cycles before 3.0, Christensen-Burley",
        "2.8 and 2.9",
        &[length("subsurface_radius")],
        Rule::Width(Factor::OverFourPiDiffuse),
        "d = length/(4 pi s(A)), s diffuse",
        code("blender/blender@6529d20 intern/cycles/kernel/closure/bssrdf.h, bssrdf_burley_setup"),
    )
    .albedo("subsurface_color"),
    system(
        "eevee",
        "Blender EEVEE",
        "3.x and 4.x",
        CYCLES,
        Rule::Width(Factor::OverFourPiDiffuseOfRelative),
        "d = length/(4 pi s(A/max A)), s diffuse",
        code("blender/blender@103e878 .../eevee_next/shaders/eevee_subsurface_convolve_comp.glsl"),
    )
    .albedo("base_color"),
    system(
        "pbrt",
        "pbrt, coefficients",
        "v4",
        &[
            Parameter { name: "sigma_a", role: Role::Absorption },
            Parameter { name: "sigma_s", role: Role::Scattering },
            G,
            factor("scale", 1.0, 1.0),
        ],
        Rule::Medium,
        "mfp = 1/(scale (sigma_a + (1 - g) sigma_s))",
        code("mmp/pbrt-v4@04fd052 src/pbrt/materials.h, SubsurfaceMaterial"),
    ),
    system(
        "pbrt",
        "pbrt, reflectance and mean free path",
        "v4",
        &[length("mfp"), factor("scale", 1.0, 1.0)],
        Rule::Mfp(Factor::One),
        "mfp = length",
        code("mmp/pbrt-v4@04fd052 src/pbrt/materials.h, SubsurfaceMaterial"),
    )
    .albedo("reflectance"),
    system(
        "pbrt-v3-disney",
        "pbrt-v3, disney material",
        "v3",
        &[length("scatterdistance")],
        Rule::Width(Factor::Fifth),
        "d = 0.2 length",
        code("mmp/pbrt-v3@50bec5e src/materials/disney.cpp, DisneyBSSRDF"),
    )
    .albedo("color"),
    system(
        "appleseed",
        "appleseed, normalized diffusion",
        "2018",
        &[length("mfp"), factor("mfp_multiplier", 1.0, 1.0)],
        Rule::Width(Factor::OverSearchlight(0.001, 0.999)),
        "d = length/s(A), s searchlight",
        code("appleseedhq/appleseed@c39aed7 .../bssrdf/normalizeddiffusionbssrdf.cpp, sss.cpp"),
    )
    .albedo("reflectance")
    .at_least(1e-6),
    system(
        "appleseed-random-walk",
        "appleseed, random walk",
        "2018",
        &[length("mfp"), factor("mfp_multiplier", 1.0, 1.0)],
        Rule::Mfp(Factor::One),
        "mfp = length",
        code("appleseedhq/appleseed@c39aed7 .../bssrdf/randomwalkbssrdf.cpp"),
    )
    .albedo("reflectance")
    .at_least(1e-6),
    system(
        "moonray",
        "MoonRay, normalized diffusion",
        "2024",
        &[length("radius")],
        Rule::Width(Factor::OverDiffuseMfp(0.001)),
        "d = length/s(A), s from dmfp",
        code("dreamworksanimation/moonray@6f49185 lib/rendering/shading/bssrdf/NormalizedDiffusion.cc"),
    )
    .albedo("albedo")
    .at_least(0.001),
    system(
        "renderman",
        "RenderMan PxrSurface, Burley Normalized",
        "22 and later",
        &[distance("dmfp"), length("dmfpColor"), factor("unitLength", 0.1, 1.0)],
        Rule::Width(Factor::OverDiffuseMfp(0.0)),
        "d = length/s(A), s from dmfp",
        document("rmanwiki.pixar.com, PxrSurface: dmfp x dmfpColor x unitLength; s(A) after the talk (code not public)"),
    )
    .albedo("subsurfaceColor"),
    system(
        "arnold",
        "Arnold standard_surface, random walk",
        "5 and later",
        &[length("subsurface_radius"), distance("subsurface_scale")],
        Rule::Mfp(Factor::One),
        "mfp = length",
        document("Autodesk/standard-surface@0ee942e index.html: radii are mean free paths (code not public)"),
    )
    .albedo("subsurface_color"),
    system(
        "unreal",
        "Unreal Engine, subsurface profile with mean free path",
        "5.1 and later",
        UNREAL,
        Rule::Width(Factor::OverSixTenthsSearchlight),
        "d = length/(0.6 s(A)), s searchlight",
        code("Unreal Engine SubsurfaceProfile.cpp, UpgradeDiffuseMeanFreePathToMeanFreePath, and \
              BurleyNormalizedSSSCommon.ush, GetMFPFromDMFPCoeff (copies)"),
    )
    .albedo("SurfaceAlbedo")
    .in_unit_of_its_own(LengthUnit::Centimeter),
    system(
        "unreal-5.0",
        "Unreal Engine, subsurface profile with diffuse mean free path",
        "5.0 and before",
        UNREAL,
        Rule::Width(Factor::OverDiffuseMfp(0.0)),
        "d = length/s(A), s from dmfp",
        code("Unreal Engine BurleyNormalizedSSS.cpp, GetSearchLightDiffuseScalingFactor (copy)"),
    )
    .albedo("SurfaceAlbedo")
    .in_unit_of_its_own(LengthUnit::Centimeter),
    system(
        "unreal-signed",
        "Unreal Engine, internal mean free path before s(A) had its absolute value",
        "5.0 and before",
        &[length("mean_free_path")],
        Rule::Width(Factor::OverSixTenthsSigned),
        "d = length/(0.6 s(A)), s = 1.85 - A + 7 (A - 0.8)^3",
        code("Unreal Engine BurleyNormalizedSSS.cpp, GetPerpendicularScalingFactor (older copy)"),
    )
    .albedo("SurfaceAlbedo")
    .in_unit_of_its_own(LengthUnit::Centimeter),
    system(
        "substrate",
        "Unreal Engine, Substrate Slab",
        "5.2 and later",
        &[length("SSSMFP"), distance("SSSMFPScale")],
        Rule::Mfp(Factor::One),
        "mfp = length",
        document("dev.epicgames.com, Overview of Substrate Materials: the distance in centimeters before a collision"),
    )
    .albedo("DiffuseAlbedo")
    .in_unit_of_its_own(LengthUnit::Centimeter),
    system(
        "substrate",
        "Unreal Engine, Substrate Transmittance-To-MeanFreePath",
        "5.2 and later",
        &[distance("Thickness"), attenuation("TransmittanceColor")],
        Rule::Mfp(Factor::One),
        "mfp = Thickness/-ln(TransmittanceColor)",
        document("dev.epicgames.com, Overview of Substrate Materials: the color is reached at the thickness, by default 0.01 cm"),
    )
    .albedo("DiffuseAlbedo")
    .in_unit_of_its_own(LengthUnit::Centimeter),
    system(
        "hdrp",
        "Unity HDRP, diffusion profile",
        "since 2018",
        &[length("scatteringDistance"), distance("scatteringDistanceMultiplier")],
        Rule::Width(Factor::One),
        "d = length",
        code("Unity-Technologies/Graphics@75b3fc1 .../DiffusionProfile/DiffusionProfileSettings.cs, UpdateKernel"),
    )
    .albedo("baseColor")
    .in_unit_of_its_own(LengthUnit::Millimeter),
    system(
        "openpbr",
        "OpenPBR Surface",
        "1.x",
        &[distance("subsurface_radius"), length("subsurface_radius_scale")],
        Rule::Mfp(Factor::One),
        "mfp = length, in units of the scene",
        document("AcademySoftwareFoundation/OpenPBR@0042276 and 1.1.1 index.html, Subsurface: mu_t = 1/r; Metadata: lengths are in \
             units of world space"),
    )
    .albedo("subsurface_color"),
    system(
        "gltf",
        "glTF, KHR_materials_volume with KHR_materials_volume_scatter or KHR_materials_scatter",
        "drafts of 2025 and 2026",
        &[distance("attenuationDistance"), attenuation("attenuationColor"), G_OF_GLTF],
        Rule::Mfp(Factor::OverOneMinusAlphaG),
        "mfp = attenuationDistance/(-ln(attenuationColor) (1 - alpha g)), alpha of the color",
        document("KhronosGroup/glTF@4608553 and @0addbb0, KHR_materials_volume_scatter and KHR_materials_scatter, README.md"),
    )
    .albedo("multiscatterColorFactor")
    .in_unit_of_its_own(LengthUnit::Meter),
    system(
        "adobe",
        "Adobe Standard Material",
        "2026.07",
        &[
            distance("scatteringDistance"),
            length("scatteringDistanceScale"),
            ABSORPTION_DISTANCE,
            Parameter { name: "absorptionColor", role: Role::Filter },
        ],
        Rule::Mfp(Factor::OfGreatestAlpha),
        "sigma_s = max(alpha)/length, alpha of the color; sigma_a = sigma_s (1 - alpha)/alpha - ln(absorptionColor)/absorptionDistance",
        code("adobe/USD-Fileformat-plugins@6441b97 gltf/src/gltfImport.cpp, convertVolumeScatterToASM"),
    )
    .albedo("scatteringColor"),
    system(
        "karma",
        "Karma, MtlX Subsurface BSDF",
        "Houdini 20",
        &[length("radius")],
        Rule::Mfp(Factor::One),
        "mfp = length",
        document("sidefx.com/docs, mtlxsubsurface_bsdf: the mean free path of the material"),
    )
    .albedo("color"),
    system(
        "vray",
        "V-Ray 7, V-Ray Material as OpenPBR",
        "7",
        &[distance("fog_mult"), length("fog_color")],
        Rule::Mfp(Factor::One),
        "mfp = length, in units of the scene",
        document("docs.chaos.com, OpenPBR Shading Model: subsurface_radius and its scale by V-Ray's names"),
    )
    .albedo("translucency_color"),
    system(
        "materialx",
        "MaterialX subsurface_bsdf, as a profile",
        "1.39",
        &[length("radius")],
        Rule::Width(Factor::One),
        "d = length",
        code("MaterialX libraries/pbrlib/genglsl/lib/mx_microfacet_diffuse.glsl, and PBR specification, Subsurface \
              Scattering Model (copies)"),
    )
    .albedo("color")
    .at_least(0.1),
    system(
        "rise",
        "RISE, Burley normalized diffusion",
        "2026",
        &[
            Parameter { name: "absorption", role: Role::Absorption },
            Parameter { name: "scattering", role: Role::Scattering },
            G,
        ],
        Rule::MediumAsProfile,
        "d = mfp/s(alpha'), s diffuse; alpha' counts as surface albedo",
        code("aravindkrishnaswamy/RISE@0dea553 src/Library/Materials/BurleyNormalizedDiffusionProfile.cpp"),
    ),
    system(
        "sort",
        "SORT, Disney and SSS materials",
        "2023",
        &[length("scatterDistance")],
        Rule::Width(Factor::OverFourPiDiffuse),
        "d = length/(4 pi s(A)), s diffuse",
        code("JiayinCao/SORT@7d33060 src/scatteringevent/bsdf/disney.cpp, DisneyBssrdf"),
    )
    .albedo("baseColor"),
];
