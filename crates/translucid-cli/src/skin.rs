//! `translucid skin`: human skin from its pigments.

mod textures;

use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use clap::{Args, ValueEnum};
use translucid_laboratory::colorimetry::{Colorimeter, Illuminant, Observer, wavelength};
use translucid_laboratory::skin::{Skin, SkinMedium, SkinParameters, TONES};
use translucid_profile::{Configuration, ParameterError};
use translucid_reference::Incidence;
use translucid_reference::layers::Totals;
use translucid_reference::walk::Control;
use translucid_words::Cell;

use crate::failure::Failure;
use crate::files::write_file;
use crate::model::ConfigurationName;
use crate::reference::parse_photons;
use crate::table::{TableArguments, exact, print};
use crate::{interrupt, machine, messages};

const EXAMPLES: &str = "\
Skin is an epidermis with melanin on a dermis with blood; lengths are in mm.

--what medium: for each channel of linear sRGB the surface albedo and the mean free path of one index-matched medium
with isotropic scattering, in diffuse light. The albedo is exactly the skin's. The mean free path makes the light that leaves
within any radius as equal as it gets: deviation is the greatest difference, standard_error a bound on that of the walk in it,
both as parts of the albedo.
--what material: the same as a material of a scene file.
--what color: XYZ, CIELAB, individual typology angle in degrees and sRGB under D65 for the observer of 1931, with and
without what the surface reflects.
--what spectrum: light reflected and absorbed from 380 to 780 nm.
--what profile: the part of the light that leaves within a radius, by channel.

With --melanin-texture and --blood-texture the directory -o gets surface_albedo.exr and mfp.exr, linear and in mm, and
material.toml, which has both. Media are computed for some tens of skins and interpolated; the message gives the errors.

Examples:
  translucid skin --tone III
  translucid skin --tone V --what material
  translucid skin --melanin 0.02 --blood 0.01 --what color
  translucid skin --tone I --blood 0.007 --configuration searchlight --what spectrum --format json
  translucid skin --melanin 0.2 --melanin-texture freckles.png -o textures";

/// Models human skin: pigments become a color, spectra, and a medium for renderers
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct SkinArguments {
    /// Tone that sets melanin and blood, from light to dark
    #[arg(long, default_value = "III", value_parser = PossibleValuesParser::new(TONES.map(|tone| tone.name)))]
    tone: String,
    /// Part of the epidermis that melanosomes fill, in [0, 1] [default: the tone's]
    #[arg(long, value_name = "PART", allow_negative_numbers = true)]
    melanin: Option<f64>,
    /// Part of the dermis that blood fills, in [0, 1] [default: the tone's]
    #[arg(long, value_name = "PART", allow_negative_numbers = true)]
    blood: Option<f64>,
    /// Part of the melanin that is eumelanin; the rest is pheomelanin
    #[arg(long, value_name = "PART", default_value_t = 1.0, allow_negative_numbers = true)]
    eumelanin: f64,
    /// Part of the hemoglobin that carries oxygen
    #[arg(long, value_name = "PART", default_value_t = 0.75, allow_negative_numbers = true)]
    oxygenation: f64,
    /// Carotene in the epidermis, in g/L
    #[arg(long, value_name = "G", default_value_t = 0.0, allow_negative_numbers = true)]
    carotene: f64,
    /// Bilirubin in the dermis, in g/L
    #[arg(long, value_name = "G", default_value_t = 0.0, allow_negative_numbers = true)]
    bilirubin: f64,
    /// Thickness of the epidermis, in mm
    #[arg(long, value_name = "MM", default_value_t = 0.06, allow_negative_numbers = true)]
    epidermis: f64,
    /// Thickness of the dermis, in mm, on fat [default: endless]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    dermis: Option<f64>,
    /// Mean cosine of scattering
    #[arg(long, default_value_t = 0.8, allow_negative_numbers = true)]
    g: f64,
    /// Index of refraction
    #[arg(long, default_value_t = 1.4, allow_negative_numbers = true)]
    eta: f64,
    /// Figures that are printed
    #[arg(long, value_enum, default_value = "medium")]
    what: What,
    /// Light for --what color and spectrum [default: diffuse]
    #[arg(long, value_enum)]
    configuration: Option<ConfigurationName>,
    /// Photons for each of 31 wavelengths, for --what medium, material and profile
    #[arg(long, value_name = "N", default_value = "20000", value_parser = parse_photons)]
    photons: u64,
    /// Number of threads [default: one per processor]; the result does not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Picture of melanin, whose red channel times --melanin is the melanin at each pixel; -o names a directory for textures
    #[arg(long, value_name = "FILE", conflicts_with_all = ["what", "configuration", "format"])]
    melanin_texture: Option<PathBuf>,
    /// Picture of blood, whose red channel times --blood is the blood at each pixel
    #[arg(long, value_name = "FILE", conflicts_with_all = ["what", "configuration", "format"])]
    blood_texture: Option<PathBuf>,
    #[command(flatten)]
    table: TableArguments,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum What {
    /// Surface albedo and mean free path of each channel
    Medium,
    /// A material for a scene file
    Material,
    /// XYZ, CIELAB and sRGB
    Color,
    /// Light by wavelength
    Spectrum,
    /// Light within radii
    Profile,
}

#[rustfmt::skip]
const SPECTRUM_COLUMNS: [&str; 7] = [
    "wavelength_nm", "specular_reflectance", "diffuse_reflectance",
    "absorbed_by_epidermis", "absorbed_by_dermis", "absorbed_by_subcutis", "error",
];

/// Deviation of a material above which there is a warning.
const DEVIATION: f64 = 0.1;

/// Runs the verb.
pub(crate) fn run(arguments: &SkinArguments) -> Result<(), Failure> {
    if arguments.melanin_texture.is_some() || arguments.blood_texture.is_some() {
        return textures::run(arguments);
    }
    arguments.table.refuse_npz()?;
    arguments.table.check()?;
    if arguments.configuration.is_some() && !matches!(arguments.what, What::Color | What::Spectrum) {
        let message =
            "--configuration belongs to --what color and spectrum: a medium is made for diffuse light";
        return Err(Failure::input(message));
    }
    if arguments.table.is_json() && arguments.what == What::Material {
        return Err(Failure::input("--what material is part of a scene file, and has no --format json"));
    }
    let skin = Skin::new(arguments.parameters()).map_err(refused)?;
    machine::threads(arguments.threads)?.install(|| match arguments.what {
        What::Color => arguments.print_color(&skin),
        What::Spectrum => arguments.print_spectrum(&skin),
        What::Medium => arguments.print_medium(&arguments.medium(&skin)?),
        What::Profile => arguments.print_profile(&arguments.medium(&skin)?),
        What::Material => arguments.print_material(&arguments.medium(&skin)?),
    })
}

impl SkinArguments {
    fn parameters(&self) -> SkinParameters {
        let tone = TONES.iter().find(|tone| tone.name == self.tone).unwrap_or(&TONES[2]);
        SkinParameters {
            melanin: self.melanin.unwrap_or(tone.melanin),
            blood: self.blood.unwrap_or(tone.blood),
            eumelanin: self.eumelanin,
            oxygenation: self.oxygenation,
            carotene: self.carotene,
            bilirubin: self.bilirubin,
            epidermis: self.epidermis,
            dermis: self.dermis.unwrap_or(f64::INFINITY),
            g: self.g,
            eta: self.eta,
        }
    }

    fn totals(&self, skin: &Skin) -> Result<Vec<Totals>, Failure> {
        let configuration = self.configuration.map_or(Configuration::Diffuse, Configuration::from);
        skin.totals(Incidence::from(configuration)).map_err(refused)
    }

    fn medium(&self, skin: &Skin) -> Result<SkinMedium, Failure> {
        interrupt::catch("\nstopping")?;
        let control = Control { stop: &interrupt::STOP, ..Control::default() };
        let medium = skin.medium(self.photons, &control).map_err(refused)?;
        medium.ok_or_else(|| Failure::interrupted("nothing was written"))
    }

    fn print_medium(&self, medium: &SkinMedium) -> Result<(), Failure> {
        let columns = ["channel", "surface_albedo", "mfp_mm", "deviation", "standard_error"];
        let row = |(c, channel): (usize, &'static str)| {
            let numbers = [medium.surface_albedo, medium.mfp, medium.deviation, medium.standard_error];
            let [albedo, mfp, deviation, error] = numbers.map(|number| Cell::from(number[c]));
            [Cell::from(channel), albedo, mfp, deviation, error]
        };
        self.table.write_cells(columns, ["r", "g", "b"].into_iter().enumerate().map(row))
    }

    fn print_profile(&self, medium: &SkinMedium) -> Result<(), Failure> {
        let rows = medium.enclosed.iter().map(|(radius, [r, g, b])| [*radius, *r, *g, *b]);
        self.table.write(["r_mm", "enclosed_r", "enclosed_g", "enclosed_b"], rows)
    }

    fn print_material(&self, medium: &SkinMedium) -> Result<(), Failure> {
        let off = medium.deviation.iter().copied().fold(0.0, f64::max);
        if off > DEVIATION {
            let percent = 100.0 * off;
            messages::print_warning(&format!(
                "no one medium comes near this skin: the light that leaves within a radius is off by up to {percent:.0} %"
            ));
        }
        let longest = medium.mfp.iter().copied().fold(0.0, f64::max);
        let list = |numbers: [f64; 3]| numbers.map(|number| format!("{number:.4}")).join(", ");
        let color = format!("[{}]", list(medium.surface_albedo));
        let scale = format!("[{}]", list(medium.mfp.map(|mfp| mfp / longest)));
        let text = self.material(&color, longest, &scale);
        self.table.file().map_or_else(|| print(&text), |path| write_file(path, text.as_bytes()))
    }

    /// Material of a scene file. Its walk is the one that shows A from every direction, as skin nearly does: refraction at
    /// the face and a layer above spread what enters.
    fn material(&self, color: &str, radius: f64, radius_scale: &str) -> String {
        format!(
            "# {}; lengths are in mm: unit = \"mm\"\n[[material]]\nname = \"skin\"\nsubsurface_weight = 1\n\
             subsurface_model = \"random-walk-diffuse\"\nsubsurface_color = {color}\nsubsurface_radius = {radius:.4}\n\
             subsurface_radius_scale = {radius_scale}\nspecular_ior = {}\n",
            crate::command_line::shown(),
            exact(self.eta),
        )
    }

    fn print_spectrum(&self, skin: &Skin) -> Result<(), Failure> {
        let totals = self.totals(skin)?;
        let rows = totals.iter().enumerate().map(|(i, totals)| {
            let absorbed = |layer: usize| totals.absorbed.get(layer).copied().unwrap_or(0.0);
            let [specular, diffuse] = [totals.specular_reflectance, totals.diffuse_reflectance];
            [wavelength(i), specular, diffuse, absorbed(0), absorbed(1), absorbed(2), totals.error]
        });
        self.table.write(SPECTRUM_COLUMNS, rows)
    }

    fn print_color(&self, skin: &Skin) -> Result<(), Failure> {
        let totals = self.totals(skin)?;
        let eye = Colorimeter::new(Observer::TwoDegrees, Illuminant::D65);
        let [with, without] = [1.0, 0.0].map(|part| {
            let light = |i: usize| totals[i].diffuse_reflectance + part * totals[i].specular_reflectance;
            let xyz = eye.xyz(&std::array::from_fn(light));
            let [lightness, a, b] = eye.lab(xyz);
            let angle = f64::atan2(lightness - 50.0, b).to_degrees();
            let [red, green, blue] = eye.linear_srgb(xyz).map(encoded);
            [xyz[0], xyz[1], xyz[2], lightness, a, b, angle, red, green, blue]
        });
        let names = ["x", "y", "z", "l", "a", "b", "ita_degrees", "srgb_r", "srgb_g", "srgb_b"];
        let rows = names.into_iter().zip(with.into_iter().zip(without));
        let rows =
            rows.map(|(name, (with, without))| [Cell::from(name), Cell::from(with), Cell::from(without)]);
        self.table.write_cells(["quantity", "with_surface", "without_surface"], rows)
    }
}

/// Display value of sRGB (IEC 61966-2-1); colors outside become the nearest.
fn encoded(linear: f64) -> f64 {
    let linear = linear.clamp(0.0, 1.0);
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// A parameter's error in the words of the command line.
fn refused(error: ParameterError) -> Failure {
    let (value, requirement) = (exact(error.value), error.requirement());
    match error.parameter {
        name @ ("red" | "green" | "blue") => {
            Failure::input(format!("this skin's {name} in sRGB is {value}, but must be {requirement}"))
        }
        name => Failure::input(format!("--{name} is {value}, but must be {requirement}")),
    }
}
