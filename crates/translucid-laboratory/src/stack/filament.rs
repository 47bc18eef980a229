//! Filaments of printers by the two numbers that their makers state.

use translucid_reference::Incidence;
use translucid_reference::layers::{Ground, Layer, Layers};

use super::COS_8_DEGREES;

/// Parts of the light that, after one source or another, a sheet of the transmission distance lets through.
///
/// That of 1/e and a tenth are in use as such, as is a twentieth for "95 % opaque"; a hundredth stands for "no perceptible
/// light", to which no source gives a number.
pub const MEANINGS: [f64; 4] = [0.367_879_441_171_442_33, 0.1, 0.05, 0.01];

/// Least part of the light that a thick piece counts as returning: less makes no visible difference.
const DARKEST: f64 = 1e-3;

/// A filament by its color and its transmission distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filament {
    /// Color of a thick piece without its gloss, in linear Rec. 709: the part of the light that entered which leaves again.
    pub color: [f64; 3],
    /// Thickness of a sheet in air that lets the part [`Self::transmitted`] of the light through \[L\].
    pub transmission_distance: f64,
    /// That part, of the luminance of a beam at 8°, scattered or not.
    pub transmitted: f64,
    /// Index of refraction of its faces.
    pub eta: f64,
}

impl Filament {
    /// Scattering and absorption coefficients for red, green and blue \[L⁻¹\].
    ///
    /// Two numbers cannot state six coefficients. The color gives the ratio of each channel's, the transmission distance their
    /// size; it is assumed that all channels scatter alike, and equally in all directions.
    ///
    /// # Errors
    /// The words tell why no coefficients have these numbers.
    pub fn coefficients(&self) -> Result<[[f64; 3]; 2], String> {
        let ratio = |color: f64| self.absorption_ratio(color.clamp(DARKEST, 1.0));
        let [r, g, b] = self.color.map(ratio);
        let ratios = [r?, g?, b?];
        let clear = self.luminance(0.0, ratios)?;
        if self.transmitted >= clear {
            return Err(format!(
                "transmitted is {}, but even a clear sheet with these faces lets only {clear:.3} of the light through",
                self.transmitted
            ));
        }
        let [mut low, mut high] = [1e-6_f64, 1e6].map(libm::log);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            let is_too_thin = self.luminance(libm::exp(middle), ratios)? > self.transmitted;
            *(if is_too_thin { &mut low } else { &mut high }) = middle;
        }
        let scattering = libm::exp(0.5 * (low + high)) / self.transmission_distance;
        Ok([[scattering; 3], ratios.map(|ratio| scattering * ratio)])
    }

    /// σ_a/σ_s of an endless piece of a color.
    fn absorption_ratio(&self, color: f64) -> Result<f64, String> {
        let returned = |ratio: f64| {
            let layer = Layer::new(1.0, ratio, f64::INFINITY).with_eta(self.eta);
            let totals = totals(layer, Ground::None)?;
            Ok::<_, String>(totals.0 / (1.0 - totals.1))
        };
        let [mut low, mut high] = [1e-9_f64, 1e4].map(libm::log);
        if returned(libm::exp(low))? <= color {
            return Ok(0.0);
        }
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            *(if returned(libm::exp(middle))? > color { &mut low } else { &mut high }) = middle;
        }
        Ok(libm::exp(0.5 * (low + high)))
    }

    /// Part of the luminance that a sheet of an optical thickness of scattering lets through.
    fn luminance(&self, depth: f64, ratios: [f64; 3]) -> Result<f64, String> {
        let mut sum = 0.0;
        for (weight, ratio) in [0.2126, 0.7152, 0.0722].into_iter().zip(ratios) {
            let sheet = Layer::new(depth, depth * ratio, 1.0).with_eta(self.eta);
            sum += weight * totals(sheet, Ground::AIR)?.2;
        }
        Ok(sum)
    }
}

/// Diffuse and specular reflectance and the transmittance of a layer in air at 8°.
fn totals(layer: Layer, ground: Ground) -> Result<(f64, f64, f64), String> {
    let layers = Layers::new(1.0, vec![layer], ground).map_err(|error| error.to_string())?;
    let totals =
        layers.totals(Incidence::Pencil { cos_theta: COS_8_DEGREES }).map_err(|error| error.to_string())?;
    let transmittance = totals.collimated_transmittance + totals.diffuse_transmittance;
    Ok((totals.diffuse_reflectance, totals.specular_reflectance, transmittance))
}

#[cfg(test)]
mod tests {
    use super::super::{Measurement, Specular};
    use super::*;

    fn stack(filament: &Filament, thickness: f64, ground: Ground) -> Vec<Layers> {
        let [scattering, absorption] = filament.coefficients().unwrap();
        let layer = |c: usize| Layer::new(scattering[c], absorption[c], thickness).with_eta(filament.eta);
        (0..3).map(|c| Layers::new(1.0, vec![layer(c)], ground).unwrap()).collect()
    }

    /// A thick piece has the color, and a sheet of the transmission distance lets the stated part through.
    #[test]
    fn coefficients_have_the_two_numbers() {
        for (color, eta) in [([0.99, 0.16, 0.03], 1.46), ([0.7, 0.66, 0.55], 1.46), ([0.04; 3], 1.0)] {
            for (transmission_distance, transmitted) in [(6.6, 0.1), (0.3, 0.01), (2.0, MEANINGS[0])] {
                let filament = Filament { color, transmission_distance, transmitted, eta };
                let thick =
                    Measurement::new(&stack(&filament, f64::INFINITY, Ground::None), Specular::Excluded)
                        .unwrap();
                let face = translucid_profile::fresnel_from_outside(COS_8_DEGREES, eta);
                for (found, expected) in thick.reflectance.iter().zip(color) {
                    let found = found / (1.0 - face);
                    assert!((found - expected).abs() < 2e-6, "{found}, expected {expected}");
                }
                let sheet = stack(&filament, transmission_distance, Ground::AIR);
                let sheet = Measurement::new(&sheet, Specular::Included).unwrap().transmittance;
                let found = 0.2126 * sheet[0] + 0.7152 * sheet[1] + 0.0722 * sheet[2];
                assert!((found / transmitted - 1.0).abs() < 1e-4, "{found}, expected {transmitted}");
            }
        }
    }

    #[test]
    fn extremes_have_coefficients_or_a_reason() {
        let filament =
            |color, transmitted| Filament { color, transmission_distance: 1.0, transmitted, eta: 1.46 };
        // White absorbs nothing, and a channel without light as much as the darkest
        let [_, absorption] = filament([1.0, 0.0, DARKEST], 0.05).coefficients().unwrap();
        assert!(absorption[0] == 0.0 && absorption[1] == absorption[2] && absorption[1] > 0.0);
        let error = filament([0.5; 3], 0.95).coefficients().unwrap_err();
        assert!(error.contains("a clear sheet with these faces lets only 0.9"), "{error}");
    }
}
