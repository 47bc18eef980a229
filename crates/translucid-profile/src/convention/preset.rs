//! Ready-made translucent materials: measured ones with their source, and everyday ones by eye.

use std::sync::LazyLock;

use crate::{Configuration, InputError, half_space_surface_albedo, nearest};

/// Numbers of a preset's inside, measured or chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
enum PresetNumbers {
    /// Reduced scattering σ'_s and absorption σ_a for red, green, blue [1/mm].
    Measured { sigma_s_prime: [f64; 3], sigma_a: [f64; 3] },
    /// Surface albedo A and mean free path ℓ for red, green, blue [mm].
    Chosen { surface_albedo: [f64; 3], mfp: [f64; 3] },
}

/// A named translucent material.
///
/// Measured media are converted to the parameters of a profile by similarity: isotropic scattering with
/// σ'_s in place of σ_s, so that
/// ```text
/// ℓ = 1 / (σ_a + σ'_s)          A = diffuse reflectance of the index-matched half space of albedo α' = σ'_s ℓ
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    /// Name as scene files and the command line write it.
    pub name: &'static str,
    /// Where the numbers come from: a publication, or that they were chosen by eye.
    pub source: &'static str,
    /// Index of refraction of the surface.
    pub eta: f64,
    /// Perceptual roughness of the surface, by eye for all presets but for clear liquids, which are smooth.
    pub roughness: f64,
    /// Weight and perceptual roughness of a clear coat, such as a glaze or a natural wax; by eye. A weight of 0 is no coat.
    pub coat: [f64; 2],
    /// Kind of substance, by which lists are sorted.
    pub group: PresetGroup,
    numbers: PresetNumbers,
}

/// Kinds of presets, for lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum PresetGroup {
    /// Stones and minerals.
    Stone,
    /// Human skin.
    Skin,
    /// Solid food.
    Food,
    /// Waxes and soaps.
    Wax,
    /// Plastics and ceramics.
    Plastic,
    /// Milk of any kind.
    Milk,
    /// Drinks and other liquids, solved powders among them.
    Liquid,
    /// Frozen water.
    Snow,
}

impl PresetGroup {
    /// All, in the order of lists.
    pub const ALL: [Self; 8] =
        [Self::Stone, Self::Skin, Self::Food, Self::Wax, Self::Plastic, Self::Milk, Self::Liquid, Self::Snow];

    /// Its name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stone => "stone",
            Self::Skin => "skin",
            Self::Food => "food",
            Self::Wax => "wax and soap",
            Self::Plastic => "plastic and ceramics",
            Self::Milk => "milk",
            Self::Liquid => "drinks and liquids",
            Self::Snow => "snow",
        }
    }
}

/// Reduced scattering [1/mm] below which a liquid counts as clear: five centimeters of it let e^(−1/2) or more pass straight.
const CLEAR: f64 = 0.01;

impl Preset {
    /// Depth that the color of a clear liquid is stated for \[mm\].
    pub const CLEAR_DEPTH: f64 = 10.0;

    /// Surface albedo A for red, green, blue, in [0, 1].
    pub fn surface_albedo(&self) -> [f64; 3] {
        match self.numbers {
            PresetNumbers::Chosen { surface_albedo, .. } => surface_albedo,
            PresetNumbers::Measured { sigma_s_prime, sigma_a } => {
                let channel = |i: usize| {
                    let alpha_prime = sigma_s_prime[i] / (sigma_s_prime[i] + sigma_a[i]);
                    half_space_surface_albedo(alpha_prime, Configuration::Diffuse)
                };
                [channel(0), channel(1), channel(2)]
            }
        }
    }

    /// Absorption σ_a for red, green, blue \[1/mm\] of a liquid that is clear: light goes through a glass of it almost straight.
    /// None for what scatters, σ'_s > 0.01 / mm in any channel.
    pub fn clear_absorption(&self) -> Option<[f64; 3]> {
        match self.numbers {
            PresetNumbers::Measured { sigma_s_prime, sigma_a } => {
                sigma_s_prime.iter().all(|&s| s < CLEAR).then_some(sigma_a)
            }
            PresetNumbers::Chosen { .. } => None,
        }
    }

    /// Color of white light behind [`CLEAR_DEPTH`](Self::CLEAR_DEPTH) of a clear liquid (Beer and Lambert). None for what
    /// scatters.
    pub fn clear_color(&self) -> Option<[f64; 3]> {
        self.clear_absorption().map(|absorption| absorption.map(|a| libm::exp(-a * Self::CLEAR_DEPTH)))
    }

    /// Mean free path ℓ for red, green, blue \[mm\].
    pub fn mfp_in_millimeters(&self) -> [f64; 3] {
        match self.numbers {
            PresetNumbers::Chosen { mfp, .. } => mfp,
            PresetNumbers::Measured { sigma_s_prime, sigma_a } => {
                [0, 1, 2].map(|i| 1.0 / (sigma_s_prime[i] + sigma_a[i]))
            }
        }
    }
}

/// All presets, by group.
pub fn presets() -> &'static [Preset] {
    &PRESETS
}

/// The preset of a name; case, spaces and hyphens do not matter.
///
/// # Errors
/// There is none: the message suggests the nearest name.
///
/// ```
/// let skin = translucid_profile::convention::preset("skin1")?;
/// assert!((skin.mfp_in_millimeters()[0] - 1.2953).abs() < 1e-4);
/// # Ok::<(), translucid_profile::InputError>(())
/// ```
pub fn preset(name: &str) -> Result<&'static Preset, InputError> {
    PRESETS.iter().find(|preset| plain(preset.name) == plain(name)).ok_or_else(|| {
        let shown: String = name.chars().take(60).collect();
        let names = || PRESETS.iter().map(|preset| preset.name);
        let all = format!("the presets are {}", names().collect::<Vec<_>>().join(", "));
        InputError::new(format!("there is no preset \"{shown}\"")).with_help(match nearest(name, names()) {
            Some(near) => format!("did you mean \"{near}\"? {all}"),
            None => all,
        })
    })
}

fn plain(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// H. W. Jensen, S. Marschner, M. Levoy, P. Hanrahan, "A Practical Model for Subsurface Light Transport", SIGGRAPH 2001.
const JENSEN: &str = "measured: Jensen et al. 2001, figure 5";
/// S. G. Narasimhan, M. Gupta, C. Donner, R. Ramamoorthi, S. K. Nayar, H. W. Jensen, SIGGRAPH 2006; σ'_s = (1 − g) σ_s.
const NARASIMHAN: &str = "measured: Narasimhan et al. 2006, undiluted; index of refraction of water";
const BY_EYE: &str = "chosen by eye";

/// A preset without a coat, chosen by eye; its section of the table tells the group.
const fn of(name: &'static str, numbers: PresetNumbers, [eta, roughness]: [f64; 2]) -> Preset {
    Preset { name, source: BY_EYE, eta, roughness, coat: [0.0; 2], group: PresetGroup::Stone, numbers }
}

const fn measured(
    name: &'static str,
    sigma_s_prime: [f64; 3],
    sigma_a: [f64; 3],
    surface: [f64; 2],
) -> Preset {
    Preset { source: JENSEN, ..of(name, PresetNumbers::Measured { sigma_s_prime, sigma_a }, surface) }
}

const fn liquid(name: &'static str, sigma_s_prime: [f64; 3], sigma_a: [f64; 3]) -> Preset {
    Preset { source: NARASIMHAN, ..measured(name, sigma_s_prime, sigma_a, [1.33, 0.05]) }
}

const fn by_eye(name: &'static str, surface_albedo: [f64; 3], mfp: [f64; 3], surface: [f64; 2]) -> Preset {
    of(name, PresetNumbers::Chosen { surface_albedo, mfp }, surface)
}

/// Media nearest to modeled skins, to four digits; `translucid skin` computes them.
const fn skin(name: &'static str, source: &'static str, surface_albedo: [f64; 3], mfp: [f64; 3]) -> Preset {
    Preset { source, ..by_eye(name, surface_albedo, mfp, [1.4, 0.4]) }
}

const fn alias(name: &'static str, source: &'static str, preset: Preset) -> Preset {
    Preset { name, source, ..preset }
}

const MARBLE: Preset = measured("marble", [2.19, 2.62, 3.00], [0.0021, 0.0041, 0.0071], [1.5, 0.2]);
const SKIN1: Preset = measured("skin1", [0.74, 0.88, 1.01], [0.032, 0.17, 0.48], [1.3, 0.4]);
const WHOLEMILK: Preset = measured("wholemilk", [2.55, 3.21, 3.77], [0.0011, 0.0024, 0.014], [1.3, 0.05]);
const WAX: Preset = by_eye("wax", [0.94, 0.87, 0.68], [3.4, 2.6, 1.7], [1.44, 0.35]);

impl Preset {
    const fn coated(self, weight: f64, roughness: f64) -> Self {
        Self { coat: [weight, roughness], ..self }
    }
}

static PRESETS: LazyLock<Vec<Preset>> = LazyLock::new(|| {
    let in_group = |&(group, presets): &(PresetGroup, &'static [Preset])| {
        presets.iter().map(move |preset| {
            let roughness = if preset.clear_absorption().is_some() { 0.0 } else { preset.roughness };
            Preset { group, roughness, ..*preset }
        })
    };
    SECTIONS.iter().flat_map(in_group).collect()
});

#[rustfmt::skip] // A table. measured, liquid: σ'_s, σ_a [1/mm]; by_eye: A, ℓ [mm]; then η, roughness.
const SECTIONS: &[(PresetGroup, &[Preset])] = &[
    (PresetGroup::Stone, &[
        by_eye("alabaster", [0.93, 0.90, 0.84], [4.0, 3.4, 2.8], [1.52, 0.25]),
        by_eye("jade", [0.12, 0.27, 0.15], [2.8, 4.8, 3.2], [1.62, 0.1]),
        MARBLE,
        by_eye("rose-quartz", [0.80, 0.55, 0.56], [9.0, 6.0, 6.0], [1.54, 0.1]),
    ]),
    (PresetGroup::Skin, &[
        alias("skin", "skin1 of Jensen et al. 2001", SKIN1),
        SKIN1,
        measured("skin2", [1.09, 1.59, 1.79], [0.013, 0.070, 0.145], [1.3, 0.4]),
        // Means of inner arms and cheeks, by class of typology angle: A, ℓ [mm].
        skin("skin-i", "modeled: translucid skin --tone I", [0.5180, 0.3957, 0.2826], [0.8283, 0.5957, 0.3748]),
        skin("skin-ii", "modeled: translucid skin --tone II", [0.4582, 0.3245, 0.2083], [0.8609, 0.6164, 0.3720]),
        skin("skin-iii", "modeled: translucid skin --tone III", [0.4080, 0.2679, 0.1585], [0.8852, 0.6196, 0.3592]),
        skin("skin-iv", "modeled: translucid skin --tone IV", [0.3517, 0.2119, 0.1135], [0.9131, 0.6195, 0.3281]),
        skin("skin-v", "modeled: translucid skin --tone V", [0.2668, 0.1402, 0.0625], [0.9576, 0.6097, 0.2564]),
        skin("skin-vi", "modeled: translucid skin --tone VI", [0.1247, 0.0486, 0.0146], [0.9792, 0.4716, 0.0574]),
    ]),
    (PresetGroup::Food, &[
        measured("apple", [2.29, 2.39, 1.97], [0.0030, 0.0034, 0.046], [1.3, 0.25]).coated(0.6, 0.15),
        by_eye("butter", [0.93, 0.83, 0.42], [1.6, 1.2, 0.6], [1.46, 0.3]),
        by_eye("cheese", [0.92, 0.72, 0.30], [2.2, 1.5, 0.7], [1.4, 0.4]),
        measured("chicken1", [0.15, 0.21, 0.38], [0.015, 0.077, 0.19], [1.3, 0.3]),
        measured("chicken2", [0.19, 0.25, 0.32], [0.018, 0.088, 0.20], [1.3, 0.3]),
        measured("cream", [7.38, 5.47, 3.15], [0.0002, 0.0028, 0.0163], [1.3, 0.1]),
        by_eye("grape", [0.42, 0.62, 0.18], [4.0, 5.0, 2.5], [1.35, 0.25]),
        by_eye("gummy", [0.50, 0.05, 0.04], [9.0, 2.5, 2.0], [1.45, 0.15]),
        measured("ketchup", [0.18, 0.07, 0.03], [0.061, 0.97, 1.45], [1.3, 0.1]),
        measured("potato", [0.68, 0.70, 0.55], [0.0024, 0.0090, 0.12], [1.3, 0.4]),
        by_eye("salmon", [0.85, 0.40, 0.26], [2.6, 1.2, 0.8], [1.38, 0.3]),
    ]),
    (PresetGroup::Wax, &[
        by_eye("beeswax", [0.93, 0.68, 0.30], [3.2, 2.0, 1.0], [1.44, 0.4]),
        alias("candle", "wax, chosen by eye", WAX),
        by_eye("soap", [0.91, 0.89, 0.80], [2.6, 2.3, 1.8], [1.46, 0.35]),
        WAX,
    ]),
    (PresetGroup::Plastic, &[
        by_eye("plastic", [0.85, 0.85, 0.85], [0.6, 0.6, 0.6], [1.5, 0.2]),
        by_eye("porcelain", [0.93, 0.92, 0.90], [0.5, 0.45, 0.4], [1.55, 0.3]).coated(1.0, 0.03),
        measured("spectralon", [11.6, 20.4, 14.9], [0.0, 0.0, 0.0], [1.3, 0.8]),
    ]),
    (PresetGroup::Milk, &[
        alias("milk", "wholemilk of Jensen et al. 2001", WHOLEMILK),
        liquid("lowfat-milk", [0.89187, 1.5136, 2.532], [0.002875, 0.00575, 0.0115]),
        liquid("reduced-milk", [2.4858, 3.1669, 4.5214], [0.0025556, 0.0051111, 0.012778]),
        liquid("regular-milk", [4.5513, 5.8294, 7.136], [0.0015333, 0.0046, 0.019933]),
        measured("skimmilk", [0.70, 1.22, 1.90], [0.0014, 0.0025, 0.0142], [1.3, 0.05]),
        WHOLEMILK,
        liquid("lowfat-soy-milk", [0.30576, 0.34233, 0.61664], [0.0014375, 0.0071875, 0.035937]),
        liquid("regular-soy-milk", [0.59223, 0.73866, 1.4693], [0.0019167, 0.0095833, 0.065167]),
        liquid("lowfat-chocolate-milk", [0.64925, 0.83916, 1.1057], [0.0115, 0.0368, 0.1564]),
        liquid("regular-chocolate-milk", [1.4585, 2.1289, 2.9527], [0.010063, 0.043125, 0.14375]),
    ]),
    (PresetGroup::Liquid, &[
        liquid("espresso", [0.72378, 0.84557, 1.0247], [4.7984, 6.5751, 8.8493]),
        liquid("mint-mocha-coffee", [0.31602, 0.38538, 0.48131], [3.772, 5.8228, 7.82]),
        liquid("coke", [8.9053e-5, 8.372e-5, 0.0], [0.10014, 0.16503, 0.2468]),
        liquid("pepsi", [6.1697e-5, 4.2564e-5, 0.0], [0.091641, 0.14158, 0.20729]),
        liquid("sprite", [6.0306e-6, 6.4139e-6, 6.5504e-6], [0.001886, 0.0018308, 0.0020025]),
        liquid("gatorade", [0.0024574, 0.003007, 0.0037325], [0.024794, 0.019289, 0.008878]),
        liquid("chardonnay", [1.7982e-5, 1.3758e-5, 1.2023e-5], [0.010782, 0.011855, 0.023997]),
        liquid("white-zinfandel", [1.7501e-5, 1.9069e-5, 1.288e-5], [0.012072, 0.016184, 0.019843]),
        liquid("merlot", [2.1129e-5, 0.0, 0.0], [0.11632, 0.25191, 0.29434]),
        liquid("budweiser-beer", [2.4356e-5, 2.4079e-5, 1.0564e-5], [0.011492, 0.024911, 0.057786]),
        liquid("coors-light-beer", [5.0922e-5, 4.301e-5, 0.0], [0.006164, 0.013984, 0.034983]),
        liquid("clorox", [0.0024035, 0.0031373, 0.003991], [0.0033542, 0.014892, 0.026297]),
        liquid("apple-juice", [0.00013612, 0.00015836, 0.000227], [0.012957, 0.023741, 0.052184]),
        liquid("cranberry-juice", [0.00010402, 0.00011646, 7.8139e-5], [0.039437, 0.094223, 0.12426]),
        liquid("grape-juice", [5.382e-5, 0.0, 0.0], [0.10404, 0.23958, 0.29325]),
        liquid("ruby-grapefruit-juice", [0.011002, 0.010927, 0.011036], [0.085867, 0.18314, 0.25262]),
        liquid("white-grapefruit-juice", [0.22826, 0.23998, 0.32748], [0.0138, 0.018831, 0.056781]),
        liquid("shampoo", [0.0007176, 0.0008303, 0.0009016], [0.014107, 0.045693, 0.061717]),
        liquid("strawberry-shampoo", [0.00015671, 0.00015947, 1.518e-5], [0.01449, 0.05796, 0.075823]),
        liquid("head-and-shoulders-shampoo", [0.023805, 0.028804, 0.034306], [0.084621, 0.15688, 0.20365]),
        liquid("lemon-tea-powder", [0.040224, 0.045264, 0.051081], [2.4288, 4.5757, 7.2127]),
        liquid("orange-powder", [0.00015617, 0.00017482, 0.0001762], [0.001449, 0.003441, 0.007863]),
        liquid("pink-lemonade-powder", [0.00012103, 0.00013073, 0.00012528], [0.001165, 0.002366, 0.003195]),
        liquid("cappuccino-powder", [1.8436, 2.5851, 2.1662], [35.844, 49.547, 61.084]),
        liquid("salt-powder", [0.027333, 0.032451, 0.031979], [0.28415, 0.3257, 0.34148]),
        liquid("sugar-powder", [0.00022272, 0.00025513, 0.000271], [0.012638, 0.031051, 0.050124]),
        liquid("suisse-mocha-powder", [2.7979, 3.5452, 4.3365], [17.502, 27.004, 35.433]),
        liquid("pacific-ocean-water", [0.0001764, 0.00032095, 0.00019617], [0.031845, 0.031324, 0.030147]),
    ]),
    (PresetGroup::Snow, &[
        by_eye("snow", [0.98, 0.98, 0.985], [3.0, 3.2, 3.6], [1.31, 0.7]),
    ]),
];

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_near(found: [f64; 3], expected: [f64; 3], tolerance: f64) {
        let is_near = |i: usize| (found[i] - expected[i]).abs() < tolerance;
        assert!((0..3).all(is_near), "{found:?} {expected:?}");
    }

    #[test]
    fn preset_skin1_has_the_exact_half_space_albedo() {
        let skin = preset("skin1").unwrap();
        // Van de Hulst's approximation has 0.6250, 0.3836, 0.2394.
        assert_near(skin.surface_albedo(), [0.625310, 0.384914, 0.241310], 1e-6);
        assert_near(skin.mfp_in_millimeters(), [1.2953, 0.9524, 0.6711], 6e-5);
    }

    #[test]
    fn preset_marble_has_the_exact_half_space_albedo() {
        let marble = preset("marble").unwrap();
        assert_near(marble.surface_albedo(), [0.931151, 0.912963, 0.894142], 1e-6);
        assert_near(marble.mfp_in_millimeters(), [0.45618, 0.38108, 0.33255], 6e-6);
    }

    #[test]
    fn preset_names_are_unique_and_found_in_any_spelling() {
        for (i, preset_of_list) in presets().iter().enumerate() {
            assert_eq!(preset(preset_of_list.name).unwrap(), preset_of_list);
            let others = &presets()[i + 1..];
            assert!(others.iter().all(|other| plain(other.name) != plain(preset_of_list.name)));
        }
        assert_eq!(preset("Whole Milk").unwrap().name, "wholemilk");
        assert_eq!(preset("SKIN_1").unwrap().name, "skin1");
    }

    #[test]
    fn preset_values_are_within_the_material_ranges() {
        for preset in presets() {
            let (albedo, mfp) = (preset.surface_albedo(), preset.mfp_in_millimeters());
            assert!(albedo.iter().all(|a| (0.0..=1.0).contains(a)), "{}: {albedo:?}", preset.name);
            assert!(mfp.iter().all(|&mfp| mfp > 0.0 && mfp < 1000.0), "{}: {mfp:?}", preset.name);
            assert!((1.0..=4.0).contains(&preset.eta) && (0.0..=1.0).contains(&preset.roughness));
            assert!(preset.coat.iter().all(|x| (0.0..=1.0).contains(x)));
            assert!(!preset.source.is_empty());
        }
    }

    #[test]
    fn presets_stand_by_group() {
        let groups: Vec<PresetGroup> = presets().iter().map(|preset| preset.group).collect();
        assert!(groups.is_sorted());
        assert!(PresetGroup::ALL.iter().all(|group| groups.contains(group)));
    }

    #[test]
    fn preset_of_a_clear_drink_has_its_absorption() {
        let clear = |name: &str| preset(name).unwrap().clear_absorption();
        assert_eq!(clear("merlot"), Some([0.11632, 0.25191, 0.29434]));
        assert!(clear("sprite").is_some() && clear("apple-juice").is_some());
        assert!(
            clear("milk").is_none() && clear("white-grapefruit-juice").is_none() && clear("jade").is_none()
        );
    }

    #[test]
    fn preset_unknown_suggests_the_nearest() {
        let error = preset("skinn1").unwrap_err();
        assert_eq!(error.message, "there is no preset \"skinn1\"");
        assert!(error.help.unwrap().starts_with("did you mean \"skin1\"? the presets are alabaster, "));
        let error = preset("zzzzzzzz").unwrap_err();
        assert!(error.help.unwrap().starts_with("the presets are alabaster, "));
    }
}
