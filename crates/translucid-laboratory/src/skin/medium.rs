//! The one medium that is nearest to skin.

use translucid_profile::{ParameterError, require};
use translucid_reference::Incidence;
use translucid_reference::exact::HalfSpace;
use translucid_reference::layers::{Grid, Quantity};
use translucid_reference::walk::Control;

use super::Skin;
use crate::colorimetry::{Colorimeter, Illuminant, Observer, WAVELENGTHS};

/// One medium in place of skin, for red, green and blue of linear sRGB.
///
/// It is index-matched and scatters isotropically, as renderers' materials do unless told otherwise, and is seen in diffuse
/// light of D65. Its surface albedos are exactly the skin's color: the share of the light that entered which leaves again.
/// Its mean free paths make the light that leaves within any radius as equal as can be: the greatest difference is least.
#[derive(Clone, Debug, PartialEq)]
pub struct SkinMedium {
    /// Surface albedo A of each channel.
    pub surface_albedo: [f64; 3],
    /// Mean free path ℓ of each channel \[mm\].
    pub mfp: [f64; 3],
    /// Greatest difference between the light that leaves the medium and the skin within any radius, as a part of A.
    pub deviation: [f64; 3],
    /// Bound on the standard error of the skin's light within a radius, as a part of A.
    pub standard_error: [f64; 3],
    /// Radii \[mm\], and the part of the skin's light that leaves within each, by channel.
    pub enclosed: Vec<(f64, [f64; 3])>,
}

/// Every how many wavelengths of a spectrum photons are walked: 10 nm.
const STRIDE: usize = 2;
/// First and last wavelengths walked, 400 nm and 700 nm: beyond, the eye sees a thousandth.
const WALKED: [usize; 2] = [4, 64];
/// Rings of 5 µm, up to 20 mm.
const GRID: Grid = Grid { dz: 1.0, dr: 0.005, nz: 1, nr: 4000, na: 1 };

impl Skin {
    /// Finds the nearest medium by a walk of some photons for each of 31 wavelengths; `None` where it was stopped.
    ///
    /// The result depends on the skin and the number of photons alone.
    ///
    /// # Errors
    /// The skin's color is none of sRGB, or there are fewer than 100 photons.
    pub fn medium(&self, photons: u64, control: &Control) -> Result<Option<SkinMedium>, ParameterError> {
        require(photons >= 100, "photons", photons as f64, "at least 100")?;
        let albedos = self.albedos()?;
        let weights = channel_weights();
        let color = color_of(&albedos, &weights);
        for (channel, value) in ["red", "green", "blue"].into_iter().zip(color) {
            require(value > 0.0, channel, value, "greater than 0: no display shows this color")?;
        }
        let radii = radii();
        let walks: Vec<usize> = (WALKED[0]..=WALKED[1]).step_by(STRIDE).collect();
        let mut enclosed = vec![[0.0; 3]; radii.len()];
        let mut variance = [0.0; 3];
        for walk in walks {
            let tally = self.layers(walk).walk(Incidence::Cosine, GRID, photons, walk as u64, control)?;
            if tally.photons() < photons {
                return Ok(None);
            }
            let share = share_of(walk, &albedos, &weights);
            let total = tally.total(Quantity::Reflected).value;
            let mut rings = tally.all(Quantity::ReflectedByRing);
            let (mut within, mut ring) = (0.0, 0);
            for (&radius, enclosed) in radii.iter().zip(&mut enclosed) {
                within += rings.by_ref().take(radius - ring).map(|ring| ring.value).sum::<f64>();
                ring = radius;
                for c in 0..3 {
                    enclosed[c] += share[c] * within / total;
                }
            }
            // The variance of a part F of weights up to 1 whose mean is A is at most F (1 − F)/(A n)
            for c in 0..3 {
                variance[c] += 0.25 * share[c] * share[c] / (albedos[walk] * photons as f64);
            }
        }
        let enclosed = radii.iter().zip(&enclosed);
        let enclosed: Vec<(f64, [f64; 3])> = enclosed
            .map(|(&ring, light)| (GRID.dr * ring as f64, [0, 1, 2].map(|c| light[c] / color[c])))
            .collect();
        let mut medium = SkinMedium {
            surface_albedo: color,
            mfp: [0.0; 3],
            deviation: [0.0; 3],
            standard_error: [0, 1, 2].map(|c| variance[c].sqrt() / color[c]),
            enclosed,
        };
        for c in 0..3 {
            let curve: Vec<[f64; 2]> = medium.enclosed.iter().map(|(r, light)| [*r, light[c]]).collect();
            let fit = nearest_mfp(color[c], &curve)?;
            (medium.mfp[c], medium.deviation[c]) = fit;
        }
        Ok(Some(medium))
    }

    /// Share of the diffuse light that entered which leaves again, at every wavelength.
    fn albedos(&self) -> Result<[f64; WAVELENGTHS], ParameterError> {
        let totals = self.totals(Incidence::Cosine)?;
        let albedo = |i: usize| totals[i].diffuse_reflectance / (1.0 - totals[i].specular_reflectance);
        Ok(std::array::from_fn(albedo))
    }
}

/// Weights by which a spectrum's values make linear sRGB under D65.
fn channel_weights() -> [[f64; 3]; WAVELENGTHS] {
    let eye = Colorimeter::new(Observer::TwoDegrees, Illuminant::D65);
    std::array::from_fn(|i| {
        let mut line = [0.0; WAVELENGTHS];
        line[i] = 1.0;
        eye.linear_srgb(eye.xyz(&line))
    })
}

fn color_of(spectrum: &[f64; WAVELENGTHS], weights: &[[f64; 3]; WAVELENGTHS]) -> [f64; 3] {
    [0, 1, 2].map(|c| spectrum.iter().zip(weights).map(|(value, weight)| value * weight[c]).sum())
}

/// Light of each channel that spreads as at a walked wavelength: wavelengths between two walked ones belong to both.
fn share_of(walk: usize, albedos: &[f64; WAVELENGTHS], weights: &[[f64; 3]; WAVELENGTHS]) -> [f64; 3] {
    let belongs = |i: usize| {
        let nearest = i.clamp(WALKED[0], WALKED[1]);
        (1.0 - nearest.abs_diff(walk) as f64 / STRIDE as f64).max(0.0)
    };
    let spectrum: [f64; WAVELENGTHS] = std::array::from_fn(|i| belongs(i) * albedos[i]);
    color_of(&spectrum, weights)
}

/// Numbers of rings within the radii at which light is compared: some six in every octave, up to 20 mm.
fn radii() -> Vec<usize> {
    let mut radii = vec![1];
    while let Some(&last) = radii.last()
        && last < GRID.nr - 1
    {
        radii.push((last + 1).max(last * 9 / 8).min(GRID.nr - 1));
    }
    radii
}

/// Mean free path that makes the greatest difference to a curve of radii and light within them least, and that difference.
fn nearest_mfp(surface_albedo: f64, curve: &[[f64; 2]]) -> Result<(f64, f64), ParameterError> {
    let half_space = HalfSpace::from_surface_albedo(surface_albedo, Incidence::Cosine)?;
    let range = |mfp: f64| {
        let difference = |[r, light]: &[f64; 2]| light - half_space.enclosed(r / mfp).value / surface_albedo;
        let [least, most] = [f64::INFINITY, f64::NEG_INFINITY];
        curve.iter().map(difference).fold([least, most], |[a, b], d| [a.min(d), b.max(d)])
    };
    // Both ends of the differences rise with the mean free path: where they are opposite, the greater is least
    let [mut low, mut high] = [1e-4_f64, 1e3];
    for _ in 0..40 {
        let middle = (low * high).sqrt();
        let [least, most] = range(middle);
        if least + most < 0.0 { low = middle } else { high = middle }
    }
    let [least, most] = range(high);
    Ok((high, most.max(-least)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_free_path_of_a_medium_is_found() {
        let half_space = HalfSpace::from_surface_albedo(0.4, Incidence::Cosine).unwrap();
        for mfp in [0.01, 0.7, 5.0] {
            let curve: Vec<[f64; 2]> = (1..100)
                .map(|i| 0.1 * f64::from(i))
                .map(|r| [r, half_space.enclosed(r / mfp).value / 0.4])
                .collect();
            let (found, deviation) = nearest_mfp(0.4, &curve).unwrap();
            assert!((found / mfp - 1.0).abs() < 1e-6 && deviation < 1e-7, "{found} {deviation}");
        }
    }
}
