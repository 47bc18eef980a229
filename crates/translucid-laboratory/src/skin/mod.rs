//! Optics of human skin, from pigments to a color and to one medium.
//!
//! Skin is an epidermis with melanin on a dermis with blood, which is endless or lies on fat: [`Skin`] has their absorption and
//! scattering at every wavelength of a [`Spectrum`](crate::colorimetry::Spectrum), so that
//! [`layers`](translucid_reference::layers) solves them. [`SkinMedium`] is the one medium that renderers know, as near to them
//! as it gets.
//!
//! # Units
//! Millimeters, and g/L for what is dissolved.
//!
//! # Out of scope
//! The rough surface and its oil, blood vessels (blood is evenly spread), hair.

mod medium;
mod pigments;
mod table;

pub use medium::SkinMedium;
pub use table::SkinTable;

use rayon::prelude::*;
use translucid_profile::{ParameterError, require};
use translucid_reference::Incidence;
use translucid_reference::layers::{Ground, Layer, Layers, Totals};

use self::pigments::Scattering;
use crate::colorimetry::{WAVELENGTHS, wavelength};

/// A tone of skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tone {
    /// I, the lightest, to VI.
    pub name: &'static str,
    /// Part of the epidermis that melanosomes fill.
    pub melanin: f64,
    /// Part of the dermis that blood fills.
    pub blood: f64,
}

/// Six tones: the classes of A. Chardon et al. 1991 (*Skin colour typology and suntanning pathways*), from very light to dark.
///
/// Their melanin and blood fit mean reflectances of inner arms, and for VI of cheeks, in the International Skin Spectra Archive
/// (Y. Lu et al. 2025, Scientific Data 12), class by class; this module's tests say how well. The melanin is within the range that S. L. Jacques
/// 1998 (*Skin optics*) gives, 1.3 % to 43 %.
pub const TONES: [Tone; 6] = [
    Tone { name: "I", melanin: 0.0145, blood: 0.0027 },
    Tone { name: "II", melanin: 0.027, blood: 0.003 },
    Tone { name: "III", melanin: 0.039, blood: 0.0038 },
    Tone { name: "IV", melanin: 0.056, blood: 0.0047 },
    Tone { name: "V", melanin: 0.093, blood: 0.0057 },
    Tone { name: "VI", melanin: 0.225, blood: 0.0055 },
];

/// Amounts and thicknesses that make skin, to be filled in; [`Skin::new`] checks them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkinParameters {
    /// Part of the epidermis that melanosomes fill, in [0, 1].
    pub melanin: f64,
    /// Part of the melanin that is eumelanin, which is brown or black; the rest is reddish pheomelanin. In [0, 1].
    pub eumelanin: f64,
    /// Part of the dermis that blood fills, in [0, 1].
    pub blood: f64,
    /// Part of the hemoglobin that carries oxygen, in [0, 1].
    pub oxygenation: f64,
    /// β-carotene in the epidermis \[g/L\], in [0, 1].
    pub carotene: f64,
    /// Bilirubin in the dermis \[g/L\], in [0, 1].
    pub bilirubin: f64,
    /// Thickness of the epidermis \[mm\], in [0.001, 10].
    pub epidermis: f64,
    /// Thickness of the dermis \[mm\], in [0.01, 100], or infinite; fat lies below it.
    pub dermis: f64,
    /// Mean cosine g of scattering, in [0, 0.95].
    pub g: f64,
    /// Index of refraction η, in [1, 2].
    pub eta: f64,
}

impl Default for SkinParameters {
    /// Skin of tone III.
    ///
    /// The thickness of the epidermis is Jacques' (1998), g and η are those that E. Salomatina et al. 2006 took to measure the
    /// scattering, the oxygenation is that of A. Krishnaswamy and G. V. G. Baranoski 2004 (*A biophysically-based spectral
    /// model of light interaction with human skin*).
    fn default() -> Self {
        Self {
            melanin: TONES[2].melanin,
            eumelanin: 1.0,
            blood: TONES[2].blood,
            oxygenation: 0.75,
            carotene: 0.0,
            bilirubin: 0.0,
            epidermis: 0.06,
            dermis: f64::INFINITY,
            g: 0.8,
            eta: 1.4,
        }
    }
}

/// Skin, known to be valid.
#[derive(Clone, Debug)]
pub struct Skin {
    layers: Vec<Layers>,
}

impl Skin {
    /// Skin made of this.
    ///
    /// ```
    /// use translucid_laboratory::skin::{Skin, SkinParameters};
    /// use translucid_reference::Incidence;
    ///
    /// # fn main() -> Result<(), translucid_profile::ParameterError> {
    /// let pale = Skin::new(SkinParameters { melanin: 0.01, ..SkinParameters::default() })?;
    /// let dark = Skin::new(SkinParameters { melanin: 0.3, ..SkinParameters::default() })?;
    /// let green = |skin: &Skin| Ok(skin.layers(34).totals(Incidence::NORMAL)?.diffuse_reflectance);
    /// assert!(green(&pale)? > 4.0 * green(&dark)?);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// A parameter is outside its range.
    pub fn new(parameters: SkinParameters) -> Result<Self, ParameterError> {
        let p = &parameters;
        for (name, value) in [
            ("melanin", p.melanin),
            ("eumelanin", p.eumelanin),
            ("blood", p.blood),
            ("oxygenation", p.oxygenation),
            ("carotene", p.carotene),
            ("bilirubin", p.bilirubin),
        ] {
            require((0.0..=1.0).contains(&value), name, value, "in [0, 1]")?;
        }
        require((0.001..=10.0).contains(&p.epidermis), "epidermis", p.epidermis, "in [0.001, 10] mm")?;
        let is_thickness = (0.01..=100.0).contains(&p.dermis) || p.dermis == f64::INFINITY;
        require(is_thickness, "dermis", p.dermis, "in [0.01, 100] mm, or infinite")?;
        require((0.0..=0.95).contains(&p.g), "g", p.g, "in [0, 0.95]")?;
        require((1.0..=2.0).contains(&p.eta), "eta", p.eta, "in [1, 2]")?;
        let layers = (0..WAVELENGTHS).map(|index| parameters.layers(wavelength(index)));
        layers.collect::<Result<_, _>>().map(|layers| Self { layers })
    }

    /// Layers at a [`wavelength`] of a spectrum: epidermis, dermis and, where the dermis ends, fat.
    pub fn layers(&self, index: usize) -> &Layers {
        &self.layers[index]
    }

    /// Light reflected and absorbed at every wavelength of a spectrum.
    ///
    /// # Errors
    /// The light is none that [`Layers::totals`] knows.
    pub fn totals(&self, incidence: Incidence) -> Result<Vec<Totals>, ParameterError> {
        self.layers.par_iter().map(|layers| layers.totals(incidence)).collect()
    }
}

impl SkinParameters {
    fn layers(&self, wavelength: f64) -> Result<Layers, ParameterError> {
        let layer = |scattering: Scattering, absorption, thickness| {
            let scattering = scattering.reduced(wavelength) / (1.0 - self.g);
            Layer::new(scattering, absorption, thickness).with_g(self.g).with_eta(self.eta)
        };
        let bare = pigments::bare(wavelength);
        let melanin = self.eumelanin * pigments::eumelanin(wavelength)
            + (1.0 - self.eumelanin) * pigments::pheomelanin(wavelength);
        let epidermis = self.melanin * melanin
            + (1.0 - self.melanin) * bare
            + pigments::carotene(wavelength, self.carotene);
        let dermis = self.blood * pigments::blood(wavelength, self.oxygenation)
            + (1.0 - self.blood) * bare
            + pigments::bilirubin(wavelength, self.bilirubin);
        let mut layers = vec![
            layer(Scattering::EPIDERMIS, epidermis, self.epidermis),
            layer(Scattering::DERMIS, dermis, self.dermis),
        ];
        if self.dermis.is_finite() {
            layers.push(layer(Scattering::SUBCUTIS, pigments::fat(wavelength), f64::INFINITY));
        }
        Layers::new(1.0, layers, Ground::None).map_err(|error| error.error)
    }
}

#[cfg(test)]
mod tests;
