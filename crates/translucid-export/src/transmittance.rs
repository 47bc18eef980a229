//! Light through thin parts: the transmittance of a slab of a material by its thickness.
//!
//! A shadow map or a ray tells how thick a part is between a light behind it and the point that is seen; light that arrives at
//! the other side with the irradiance E leaves here with the radiance E T/π. The table has T of plane slabs, exactly
//! ([`Layers::totals`]).

use translucid_profile::{AlbedoInversion, Configuration, ParameterError};
use translucid_reference::Incidence;
use translucid_reference::layers::{Ground, Layer, Layers};

use crate::error::ExportError;
use crate::language::Language;
use crate::material::Material;
use crate::number::literal;

/// Transmittance of the greatest channel at the last column by default: a step of 8 bits.
const LEAST: f64 = 1.0 / 256.0;
/// Most transport mean free paths to there: light that nothing absorbs falls only like 1/thickness.
const MOST_LENGTHS: f64 = 4096.0;
/// Most optical thickness: more passes nothing, either.
const MOST_DEPTH: f64 = 1e9;
/// Columns between which the error of interpolation is found.
const CHECKED: usize = 16;

/// The table of a material: T for red, green, blue.
pub(crate) struct TransmittanceTable {
    /// Thickness of the last column \[L\].
    pub(crate) most_thickness: f64,
    /// T of red, green, blue, thickness by thickness, in [0, 1].
    pub(crate) values: Vec<[f64; 3]>,
    /// Greatest error of values that are interpolated, in √thickness.
    error: f64,
    configuration: Configuration,
}

/// Slabs of a material.
struct Slabs {
    /// Single-scattering albedo and extinction coefficient of each channel.
    media: [[f64; 2]; 3],
    g: f64,
    eta: f64,
    incidence: Incidence,
}

impl TransmittanceTable {
    /// Makes the table of at least two columns; without a thickness of the last one, it is where little light is left.
    pub(crate) fn new(
        material: &Material,
        configuration: Configuration,
        [g, eta]: [f64; 2],
        columns: usize,
        most_thickness: Option<f64>,
    ) -> Result<Self, ExportError> {
        let slabs = Slabs::new(material, configuration, [g, eta])?;
        let most_thickness = match most_thickness {
            Some(thickness) => thickness,
            None => slabs.most_thickness()?,
        };
        let last = (columns - 1) as f64;
        let at = |column: f64| slabs.transmittance(most_thickness * (column / last).powi(2));
        let values = (0..columns).map(|column| at(column as f64)).collect::<Result<Vec<_>, _>>()?;
        let mut error = 0.0f64;
        for i in 0..CHECKED.min(columns - 1) {
            let column = i * (columns - 1) / CHECKED.min(columns - 1);
            let exact = at(column as f64 + 0.5)?;
            let found = |c: usize| 0.5 * (values[column][c] + values[column + 1][c]);
            error = (0..3).map(|c| (found(c) - exact[c]).abs()).fold(error, f64::max);
        }
        Ok(Self { most_thickness, values, error, configuration })
    }

    pub(crate) fn text(&self, language: Language) -> String {
        let (columns, most) = (self.values.len(), literal(self.most_thickness));
        let last = columns - 1;
        let comment = format!(
            "// Transmittance of a slab of the material for red, green, blue: the share of the light that arrives on one side that
// leaves on the other, scattered or not. Column i is the thickness {most} (i/{last})^2: interpolate between the columns
// around x = {last} sqrt(min(thickness/{most}, 1)), which is right to {:.1e} up to there.
// {}.
// Light that arrives behind with the irradiance E leaves in front with the radiance E T/pi. It arrives {}, and so does that
// of which a half space of the medium reflects the surface albedo; the mean free path is 1/sigma_t.
",
            self.error.max(1e-6),
            self.beyond(),
            match self.configuration {
                Configuration::Diffuse => "from all directions",
                Configuration::Searchlight => "along the normal",
            }
        );
        comment + &language.table("TRANSMITTANCE", &self.values)
    }
}

impl TransmittanceTable {
    /// Light beyond the last column, in words.
    pub(crate) fn beyond(&self) -> String {
        let [red, green, blue] = self.values[self.values.len() - 1];
        format!(
            "Thicker slabs pass less than the last column, {red:.3}, {green:.3}, {blue:.3}, which is too bright for them"
        )
    }
}

impl Slabs {
    fn new(
        material: &Material,
        configuration: Configuration,
        [g, eta]: [f64; 2],
    ) -> Result<Self, ParameterError> {
        let Material { surface_albedo, length, parameterization, .. } = *material;
        let inversion = AlbedoInversion::new(g, eta, configuration)?;
        let medium = |c: usize| {
            let alpha = inversion.single_scattering_albedo(surface_albedo[c]);
            [alpha, 1.0 / inversion.mfp(surface_albedo[c], length[c], parameterization)]
        };
        Ok(Self { media: [medium(0), medium(1), medium(2)], g, eta, incidence: configuration.into() })
    }

    /// T of each channel at a thickness, at which the limit stands in for 0.
    fn transmittance(&self, thickness: f64) -> Result<[f64; 3], ParameterError> {
        let thinnest = 1e-9 / self.media.iter().map(|[_, extinction]| *extinction).fold(0.0, f64::max);
        let thickness = thickness.max(thinnest);
        let mut found = [0.0; 3];
        for (t, [alpha, extinction]) in found.iter_mut().zip(self.media) {
            let extinction = extinction.min(MOST_DEPTH / thickness);
            let layer = Layer::new(alpha * extinction, (1.0 - alpha) * extinction, thickness);
            let layer = layer.with_g(self.g).with_eta(self.eta);
            let layers = Layers::new(1.0, vec![layer], Ground::AIR).map_err(|error| error.error)?;
            let totals = layers.totals(self.incidence)?;
            *t = (totals.collimated_transmittance + totals.diffuse_transmittance).clamp(0.0, 1.0);
        }
        Ok(found)
    }

    /// The thickness of the last column.
    fn most_thickness(&self) -> Result<f64, ParameterError> {
        let longest = self.media.iter().map(|[_, extinction]| 1.0 / extinction).fold(0.0, f64::max);
        let most = MOST_LENGTHS * longest / (1.0 - self.g.max(0.0));
        let mut thickness = longest;
        while thickness < most && self.transmittance(thickness)?.into_iter().fold(0.0, f64::max) > LEAST {
            thickness *= 2.0;
        }
        Ok(thickness)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use translucid_profile::Parameterization;

    const MATERIAL: Material = Material {
        surface_albedo: [1.0, 0.8, 0.0],
        length: [1.0; 3],
        parameterization: Parameterization::Mfp,
        surface: None,
    };

    fn table(columns: usize, most: Option<f64>) -> TransmittanceTable {
        TransmittanceTable::new(&MATERIAL, Configuration::Diffuse, [0.0, 1.0], columns, most).unwrap()
    }

    /// White media reach the last step of 8 bits, too, whatever their phase function and boundary.
    #[test]
    fn last_column_is_dark_by_default() {
        for (g, eta) in [(0.0, 1.0), (0.9, 1.0), (0.9, 1.5), (-0.5, 1.4)] {
            let made = TransmittanceTable::new(&MATERIAL, Configuration::Diffuse, [g, eta], 3, None).unwrap();
            let last = made.values[2];
            assert!(last.iter().all(|t| *t <= LEAST), "{g} {eta}: {last:?} at {}", made.most_thickness);
        }
        // One that is given may be bright, which the text says
        let made =
            TransmittanceTable::new(&MATERIAL, Configuration::Diffuse, [0.9, 1.0], 3, Some(64.0)).unwrap();
        let [red, ..] = made.values[2];
        assert!((0.1..0.25).contains(&red), "{red}");
        let text = made.text(Language::Glsl);
        assert!(text.contains(&format!("Thicker slabs pass less than the last column, {red:.3}")), "{text}");
    }

    /// Black slabs pass 2 E₃(τ) of diffuse light; of a beam along the normal a slab of two mean free paths with g = 0.75 passes
    /// 0.66096 (H. C. van de Hulst 1980, *Multiple Light Scattering*, table 35, as quoted by L. Wang, S. L. Jacques and L. Zheng
    /// 1995, MCML).
    #[test]
    fn values_are_those_of_published_slabs() {
        let table = table(3, Some(4.0));
        assert!(table.values[0].iter().all(|t| (t - 1.0).abs() < 1e-6), "{:?}", table.values);
        // 2 E₃(1) and 2 E₃(4)
        assert!((table.values[1][2] - 0.219_383_934).abs() < 1e-6, "{:?}", table.values);
        assert!((table.values[2][2] - 0.005_522_7).abs() < 1e-6, "{:?}", table.values);
        let media = [[0.9, 100.0]; 3];
        let slabs = Slabs { media, g: 0.75, eta: 1.0, incidence: Incidence::NORMAL };
        assert!((slabs.transmittance(0.02).unwrap()[1] - 0.66096).abs() < 5e-6);
    }

    #[test]
    fn tables_fall_and_state_their_interpolation() {
        let table = table(33, Some(64.0));
        assert_eq!(table.most_thickness, 64.0);
        for pair in table.values.windows(2) {
            assert!((0..3).all(|c| pair[1][c] <= pair[0][c] + 1e-9), "{pair:?}");
        }
        // T falls by 2h in a black channel, linearly, which is a parabola of the root
        assert!(table.error > 0.01 && table.error < 0.032, "{}", table.error);
        let short = Material { surface_albedo: [0.2; 3], ..MATERIAL };
        let short = TransmittanceTable::new(&short, Configuration::Searchlight, [0.5, 1.4], 9, None).unwrap();
        assert!(short.most_thickness < 64.0 && short.values[8][0] < LEAST, "{:?}", short.values);
        // Two faces pass what they do not reflect: 1 − 2F/(1 + F)
        let f = (0.4f64 / 2.4).powi(2);
        assert!((short.values[0][0] - (1.0 - f) / (1.0 + f)).abs() < 1e-4, "{:?}", short.values);
    }
}
