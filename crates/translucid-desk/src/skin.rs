//! *skin*: human skin from its pigments.

mod textures;

use std::path::PathBuf;
use std::sync::LazyLock;

use translucid_laboratory::colorimetry::{Colorimeter, Illuminant, Observer, wavelength};
use translucid_laboratory::skin::{Skin, SkinMedium, SkinParameters, TONES, Tone};
use translucid_profile::{Configuration, ParameterError};
use translucid_reference::Incidence;
use translucid_reference::layers::Totals;
use translucid_reference::walk::Control as WalkControl;
use translucid_words::{
    Cell, Column, Context, DataTable, Error, Fallback, Interval, Key, Rule, Thing, WholeInterval, exact,
    field, number, optional, optional_word, path, whole, word,
};

use crate::answer::{About, Answer, Control, Form, Question, Unanswered};

use Fallback::{Plain, Words};

/// Skin, and what about it.
#[derive(Clone, Debug)]
pub struct AskedSkin {
    tone: Tone,
    melanin: Option<f64>,
    blood: Option<f64>,
    /// All but melanin and blood.
    made_of: SkinParameters,
    what: What,
    configuration: Option<Configuration>,
    photons: u64,
    melanin_texture: Option<PathBuf>,
    blood_texture: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum What {
    Medium,
    Material,
    Color,
    Spectrum,
    Profile,
}

static TONES_BY_NAME: LazyLock<[(&str, Tone); 6]> = LazyLock::new(|| TONES.map(|tone| (tone.name, tone)));

/// *skin*.
#[rustfmt::skip]
pub static SKIN: Question<AskedSkin> = Question {
    thing: Thing {
        name: "skin",
        doc: "Models human skin: pigments become a color, spectra, and a medium for renderers",
        plain: || AskedSkin {
            tone: TONES[2], melanin: None, blood: None, made_of: SkinParameters::default(), what: What::Medium,
            configuration: None, photons: 20_000, melanin_texture: None, blood_texture: None,
        },
        fields: &[
            field!(AskedSkin { tone } => word(tone, &*TONES_BY_NAME),
                "Tone that sets melanin and blood, from light to dark", Plain),
            field!(AskedSkin { melanin } => optional(melanin, Interval::UNIT),
                "Part of the epidermis that melanosomes fill, {range}", Words("the tone's")),
            field!(AskedSkin { blood } => optional(blood, Interval::UNIT),
                "Part of the dermis that blood fills, {range}", Words("the tone's")),
            field!(AskedSkin { made_of } => number(&mut made_of.eumelanin, Interval::UNIT);
                &[Key::new("eumelanin", "Part of the melanin that is eumelanin, {range}; the rest is pheomelanin", Plain)]),
            field!(AskedSkin { made_of } => number(&mut made_of.oxygenation, Interval::UNIT);
                &[Key::new("oxygenation", "Part of the hemoglobin that carries oxygen, {range}", Plain)]),
            field!(AskedSkin { made_of } => number(&mut made_of.carotene, Interval::UNIT);
                &[Key::new("carotene", "Carotene in the epidermis, in g/L, {range}", Plain)]),
            field!(AskedSkin { made_of } => number(&mut made_of.bilirubin, Interval::UNIT);
                &[Key::new("bilirubin", "Bilirubin in the dermis, in g/L, {range}", Plain)]),
            field!(AskedSkin { made_of } => number(&mut made_of.epidermis, Interval::closed(0.001, 10.0));
                &[Key::new("epidermis", "Thickness of the epidermis, in mm, {range}", Plain)]),
            field!(AskedSkin { made_of } => number(&mut made_of.dermis, Interval::closed(0.01, f64::INFINITY));
                &[Key::new("dermis", "Thickness of the dermis, in mm, in [0.01, 100], on fat; or inf", Words("endless"))]),
            field!(AskedSkin { made_of } => number(&mut made_of.g, Interval::closed(0.0, 0.95));
                &[Key::new("g", "Mean cosine of scattering, {range}", Plain)]),
            field!(AskedSkin { made_of } => number(&mut made_of.eta, Interval::closed(1.0, 2.0));
                &[Key::new("eta", "Index of refraction, {range}", Plain)]),
            field!(AskedSkin { what } => word(what, &[
                    ("medium", What::Medium), ("material", What::Material), ("color", What::Color), ("spectrum", What::Spectrum),
                    ("profile", What::Profile),
                ]),
                "Figures: surface albedo and mean free path of each channel, a material for a scene file, XYZ with CIELAB and sRGB, light by wavelength, or light within radii", Plain),
            field!(AskedSkin { configuration } => optional_word(configuration, &Configuration::WORDS),
                "Light for the color and the spectrum: a pencil beam that enters perpendicularly, or light with a cosine distribution", Words("diffuse light")),
            field!(AskedSkin { photons } => whole(photons, WholeInterval::new(0, u64::MAX)),
                "Photons for each of 31 wavelengths, at least 100, for the medium, the material and the profile", Plain),
            field!(AskedSkin { melanin_texture } => path(melanin_texture),
                "Picture of melanin, whose red channel times the melanin is that at each pixel; textures of the medium are made", Words("none")),
            field!(AskedSkin { blood_texture } => path(blood_texture),
                "Picture of blood, whose red channel times the blood is that at each pixel", Words("none")),
        ],
        rules: &[
            Rule::Holds { key: "dermis", broken: AskedSkin::wrong_dermis, help: "" },
            Rule::Holds { key: "what", broken: AskedSkin::wrong_what, help: "" },
            Rule::Holds { key: "photons", broken: AskedSkin::wrong_photons, help: "" },
            Rule::Holds { key: "configuration", broken: AskedSkin::wrong_configuration, help: "" },
        ],
    },
    about: About {
        more: "Skin is an epidermis with melanin on a dermis with blood; lengths are in mm.\n\nThe medium has for each channel of linear sRGB the surface albedo and the mean free path of one index-matched medium with isotropic scattering, in diffuse light. The albedo is exactly the skin's. The mean free path makes the light that leaves within any radius as equal as it gets.\n\nThe material is the same as a material of a scene file.\n\nThe color is XYZ, CIELAB, individual typology angle in degrees and sRGB under D65 for the observer of 1931 (quantity), with and without what the surface reflects (with_surface, without_surface).\n\nThe spectrum is the light reflected and absorbed from 380 to 780 nm: wavelength_nm, specular_reflectance, diffuse_reflectance, absorbed_by_epidermis, absorbed_by_dermis, absorbed_by_subcutis, error.\n\nThe profile is the part of the light that leaves within a radius, by channel: r_mm, enclosed_r, enclosed_g, enclosed_b.\n\nTextures of melanin or blood make a directory of surface_albedo.exr and mfp.exr, linear and in mm, and material.toml, which has both. Media are computed for some tens of skins and interpolated; a remark gives the errors.",
        source: "Pigments after S. L. Jacques 1998, Skin optics; tones are the classes of A. Chardon et al. 1991, fitted to reflectances of the International Skin Spectra Archive (Y. Lu et al. 2025, Scientific Data 12); layers as in layers.",
        is_by_element: false,
        right: || vec![Vec::new()],
        examples: &[
            "--tone III",
            "--tone V --what material",
            "--melanin 0.02 --blood 0.01 --what color",
            "--tone I --blood 0.007 --configuration searchlight --what spectrum --format json",
            "--melanin 0.2 --melanin-texture freckles.png -o textures",
        ],
        columns: &MEDIUM,
        formats: &["csv", "json"],
    },
    form: AskedSkin::form,
    answer,
};

#[rustfmt::skip]
static MEDIUM: [Column; 5] = [
    Column::new("channel", "", "r, g or b of linear sRGB"),
    Column::new("surface_albedo", "1", "part of diffuse light that returns, exactly the skin's"),
    Column::new("mfp_mm", "mm", "mean free path"),
    Column::new("deviation", "1", "greatest difference of the light within a radius, as a part of the albedo"),
    Column::new("standard_error", "1", "bound on that of the walk in deviation"),
];

#[rustfmt::skip]
const SPECTRUM: [&str; 7] = [
    "wavelength_nm", "specular_reflectance", "diffuse_reflectance",
    "absorbed_by_epidermis", "absorbed_by_dermis", "absorbed_by_subcutis", "error",
];

/// Deviation of a material above which there is a warning.
const DEVIATION: f64 = 0.1;

impl AskedSkin {
    fn wrong_dermis(&self) -> Option<String> {
        let is_right = self.made_of.dermis <= 100.0 || self.made_of.dermis.is_infinite();
        (!is_right).then(|| String::from("in [0.01, 100] mm, or infinite"))
    }

    fn wrong_photons(&self) -> Option<String> {
        let is_wrong = self.photons < 100 && !self.is_solved();
        is_wrong.then(|| String::from("at least 100"))
    }

    /// Whether layers have all that is asked for, and no photon walks.
    fn is_solved(&self) -> bool {
        matches!(self.what, What::Color | What::Spectrum)
    }

    fn wrong_what(&self) -> Option<String> {
        let is_wrong = self.has_textures() && self.what != What::Medium;
        is_wrong.then(|| String::from("medium where there are textures"))
    }

    fn wrong_configuration(&self) -> Option<String> {
        let is_wrong = self.configuration.is_some() && !self.is_solved();
        is_wrong.then(|| {
            String::from("left out unless the color or the spectrum is wanted: a medium is for diffuse light")
        })
    }

    fn has_textures(&self) -> bool {
        self.melanin_texture.is_some() || self.blood_texture.is_some()
    }

    fn form(&self) -> Form {
        match self.what {
            _ if self.has_textures() => Form::Files(textures::FILES.map(String::from).to_vec()),
            What::Material => Form::Text,
            _ => Form::Table,
        }
    }

    fn parameters(&self) -> SkinParameters {
        let melanin = self.melanin.unwrap_or(self.tone.melanin);
        SkinParameters { melanin, blood: self.blood.unwrap_or(self.tone.blood), ..self.made_of }
    }

    fn totals(&self, skin: &Skin) -> Result<Vec<Totals>, Unanswered> {
        let configuration = self.configuration.unwrap_or(Configuration::Diffuse);
        skin.totals(Incidence::from(configuration)).map_err(refused)
    }

    fn medium(&self, skin: &Skin, control: &Control<'_>) -> Result<SkinMedium, Unanswered> {
        let control = WalkControl { stop: control.stop, ..WalkControl::default() };
        skin.medium(self.photons, &control).map_err(refused)?.ok_or(Unanswered::Stopped)
    }

    /// Material of a scene file. Its walk is the one that shows A from every direction, as skin nearly does: refraction at
    /// the face and a layer above spread what enters.
    fn material(&self, call: &str, color: &str, radius: f64, radius_scale: &str) -> String {
        format!(
            "# {call}; lengths are in mm: unit = \"mm\"\n[[material]]\nname = \"skin\"\nsubsurface_weight = 1\n\
             subsurface_model = \"random-walk-diffuse\"\nsubsurface_color = {color}\nsubsurface_radius = {radius:.4}\n\
             subsurface_radius_scale = {radius_scale}\nspecular_ior = {}\n",
            exact(self.made_of.eta),
        )
    }
}

fn answer(asked: &AskedSkin, _: &Context, control: &Control<'_>) -> Result<Answer, Unanswered> {
    if asked.has_textures() {
        return textures::answer(asked, control);
    }
    let skin = Skin::new(asked.parameters()).map_err(refused)?;
    let table = match asked.what {
        What::Color => color(&asked.totals(&skin)?),
        What::Spectrum => spectrum(&asked.totals(&skin)?),
        What::Medium => medium(&asked.medium(&skin, control)?),
        What::Profile => profile(&asked.medium(&skin, control)?),
        What::Material => return Ok(material(asked, &asked.medium(&skin, control)?, control)),
    };
    Ok(Answer { tables: vec![table], ..Answer::default() })
}

fn profile(medium: &SkinMedium) -> DataTable {
    let mut table = DataTable::new("", "", &["r_mm", "enclosed_r", "enclosed_g", "enclosed_b"]);
    medium
        .enclosed
        .iter()
        .for_each(|(r, [red, green, blue])| table.push([*r, *red, *green, *blue].map(Cell::Number)));
    table
}

fn medium(medium: &SkinMedium) -> DataTable {
    let mut table = DataTable::of(&MEDIUM);
    for (c, channel) in ["r", "g", "b"].into_iter().enumerate() {
        let numbers = [medium.surface_albedo, medium.mfp, medium.deviation, medium.standard_error];
        let [albedo, mfp, deviation, error] = numbers.map(|number| Cell::from(number[c]));
        table.push([Cell::from(channel), albedo, mfp, deviation, error]);
    }
    table
}

fn material(asked: &AskedSkin, medium: &SkinMedium, control: &Control<'_>) -> Answer {
    let off = medium.deviation.iter().copied().fold(0.0, f64::max);
    let warning = (off > DEVIATION).then(|| {
        let percent = 100.0 * off;
        format!("no one medium comes near this skin: the light that leaves within a radius is off by up to {percent:.0} %")
    });
    let longest = medium.mfp.iter().copied().fold(0.0, f64::max);
    let list = |numbers: [f64; 3]| format!("[{}]", numbers.map(|number| format!("{number:.4}")).join(", "));
    let scale = list(medium.mfp.map(|mfp| mfp / longest));
    let text = asked.material(control.call, &list(medium.surface_albedo), longest, &scale);
    Answer { text: Some(text), warnings: warning.into_iter().collect(), ..Answer::default() }
}

fn spectrum(totals: &[Totals]) -> DataTable {
    let mut table = DataTable::new("", "", &SPECTRUM);
    for (i, totals) in totals.iter().enumerate() {
        let absorbed = |layer: usize| totals.absorbed.get(layer).copied().unwrap_or(0.0);
        let [specular, diffuse] = [totals.specular_reflectance, totals.diffuse_reflectance];
        let row = [wavelength(i), specular, diffuse, absorbed(0), absorbed(1), absorbed(2), totals.error];
        table.push(row.map(Cell::Number));
    }
    table
}

fn color(totals: &[Totals]) -> DataTable {
    let eye = Colorimeter::new(Observer::TwoDegrees, Illuminant::D65);
    let [with, without] = [1.0, 0.0].map(|part| {
        let light = |i: usize| totals[i].diffuse_reflectance + part * totals[i].specular_reflectance;
        let xyz = eye.xyz(&std::array::from_fn(light));
        let [lightness, a, b] = eye.lab(xyz);
        let angle = f64::atan2(lightness - 50.0, b).to_degrees();
        let [red, green, blue] = eye.linear_srgb(xyz).map(encoded);
        [xyz[0], xyz[1], xyz[2], lightness, a, b, angle, red, green, blue]
    });
    let mut table = DataTable::new("", "", &["quantity", "with_surface", "without_surface"]);
    let names = ["x", "y", "z", "l", "a", "b", "ita_degrees", "srgb_r", "srgb_g", "srgb_b"];
    for (i, name) in names.into_iter().enumerate() {
        table.push([Cell::from(name), Cell::from(with[i]), Cell::from(without[i])]);
    }
    table
}

/// Display value of sRGB (IEC 61966-2-1); colors outside become the nearest.
fn encoded(linear: f64) -> f64 {
    let linear = linear.clamp(0.0, 1.0);
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

fn refused(error: ParameterError) -> Unanswered {
    let (value, requirement) = (exact(error.value), error.requirement());
    let name = match error.parameter {
        name @ ("red" | "green" | "blue") => format!("this skin's {name} in sRGB"),
        name => String::from(name),
    };
    Unanswered::Input(Error::new(format!("{name} is {value}, but must be {requirement}")))
}
