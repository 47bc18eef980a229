//! Forward model of a spot of light on a flat piece, as a camera sees it.

use std::f64::consts::PI;

use crate::response::Response;

/// A round spot of light: an evenly lit disk with a soft edge, which is a Gaussian beam where the disk is small.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Surface albedo A in \[0, 1\]: it shapes how light creeps.
    pub surface_albedo: f64,
    /// Mean free path ℓ \[L\].
    pub mfp: f64,
    /// Radius of the disk \[L\].
    pub radius: f64,
    /// Standard deviation of the light's soft edge and of the camera's blur together \[L\].
    pub blur: f64,
}

/// Spots of light seen at fixed distances from their middle, ready to be evaluated many times.
///
/// On a disk that is much wider than the spot its light is a sum of Bessel functions, each of which the piece answers with its
/// [`Response`].
///
/// ```text
/// S(r) = Σ_n 1/(πP²J₁(j_n)²) T(k_n ℓ; A) 2J₁(k_n a)/(k_n a) e^{−σ²k_n²/2} e^{−p²k_n²/12} J₀(k_n r),     k_n = j_n/P
/// ```
///
/// with the zeros j_n of J₀, the radius P of the wide disk, the pixel's width p, of which rings are means, the spot's radius a
/// and the blur σ. ∫ S 2πr dr = 1: of unit power, and over the level of even light.
#[derive(Clone, Debug)]
pub struct SpotModel {
    wave_numbers: Vec<f64>,
    /// Normalization and what a pixel's width leaves, by wave number.
    heights: Vec<f64>,
    /// J₀(k_n r), by place.
    waves: Vec<Vec<f64>>,
}

/// Radius of the wide disk over the greatest distance.
const PERIODS: f64 = 4.0;

/// Wave numbers times pixels from which on a pixel's width leaves e⁻¹⁴ and less.
const FINEST: f64 = 13.0;

impl SpotModel {
    /// For distances that are means over rings of pixels of such a width \[L\].
    pub fn new(places: &[f64], pixel_width: f64) -> Self {
        let radius = PERIODS * places.iter().fold(16.0 * pixel_width, |most, r| r.max(most));
        let count = (radius * FINEST / pixel_width / PI) as usize + 1;
        let zeros: Vec<f64> = (1..=count).map(zero_of_j0).collect();
        let wave_numbers: Vec<f64> = zeros.iter().map(|zero| zero / radius).collect();
        let height = |(zero, k): (&f64, &f64)| {
            libm::exp(-(k * pixel_width).powi(2) / 12.0) / (PI * (radius * libm::j1(*zero)).powi(2))
        };
        let heights = zeros.iter().zip(&wave_numbers).map(height).collect();
        let waves = places.iter().map(|r| wave_numbers.iter().map(|k| libm::j0(k * r)).collect());
        let waves = waves.collect();
        Self { wave_numbers, heights, waves }
    }

    /// Light at each place over the spot's power and the level of even light \[L⁻²\].
    pub fn eval(&self, response: &Response, spot: &Spot) -> Vec<f64> {
        let Spot { surface_albedo, mfp, radius, blur } = *spot;
        let transfer = response.transfer(surface_albedo, mfp);
        let amplitude = |(k, height): (&f64, &f64)| {
            let softened = libm::exp(-0.5 * (blur * k).powi(2));
            // Of what is below rounding nothing is left
            if softened < 1e-9 { 0.0 } else { height * softened * disk(k * radius) * transfer.at(*k)[0] }
        };
        let amplitudes: Vec<f64> = self.wave_numbers.iter().zip(&self.heights).map(amplitude).collect();
        let at = |waves: &Vec<f64>| waves.iter().zip(&amplitudes).map(|(wave, a)| wave * a).sum();
        self.waves.iter().map(at).collect()
    }
}

/// 2J₁(x)/x, the transform of a disk.
fn disk(x: f64) -> f64 {
    if x.abs() < 1e-4 { 1.0 - x * x / 8.0 } else { 2.0 * libm::j1(x) / x }
}

/// The n-th zero of J₀, n ≥ 1, by McMahon's series and Newton's method.
fn zero_of_j0(n: usize) -> f64 {
    let beta = PI * (n as f64 - 0.25);
    let mut zero = beta + 1.0 / (8.0 * beta) - 124.0 / (3.0 * (8.0 * beta).powi(3));
    for _ in 0..if n < 20 { 3 } else { 0 } {
        zero += libm::j0(zero) / libm::j1(zero);
    }
    zero
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use translucid_reference::Incidence;
    use translucid_reference::exact::HalfSpace;

    use super::*;

    #[test]
    fn zeros_are_those_of_tables() {
        for (n, expected) in [(1, 2.404825557695773), (2, 5.520078110286311), (20, 62.04846919022717)] {
            assert!((zero_of_j0(n) - expected).abs() < 1e-9, "{n}: {}", zero_of_j0(n));
        }
    }

    /// The spot by the profile in space: light from each point of the lit disk, ring by ring around where it is seen.
    #[test]
    fn spot_is_the_disk_of_the_profile() {
        for (surface_albedo, mfp, incidence) in [(0.8, 1.0, Incidence::Cosine), (0.4, 0.7, Incidence::NORMAL)]
        {
            let response = Response::new(1.0, incidence).unwrap();
            let half_space = HalfSpace::from_surface_albedo(surface_albedo, incidence).unwrap();
            let radius = 1.5;
            let places: Vec<f64> = (0..60).map(|i| 0.1 + 0.2 * f64::from(i)).collect();
            let model = SpotModel::new(&places, 0.02);
            let spot = Spot { surface_albedo, mfp, radius, blur: 0.0 };
            let found = model.eval(&response, &spot);
            for (r, light) in places.iter().zip(&found).filter(|(r, _)| (*r - radius).abs() > 0.15) {
                // Part of a ring of radius s around the place that is in the disk, times what comes from that far
                let (n, widest) = (3000, r + radius);
                let ring = |i: i32| {
                    let [s0, s1] = [i, i + 1].map(|i| widest * f64::from(i) / f64::from(n));
                    let s = 0.5 * (s0 + s1);
                    let cos = (r * r + s * s - radius * radius) / (2.0 * r * s);
                    let part = cos.clamp(-1.0, 1.0).acos() / PI;
                    if part == 0.0 {
                        return 0.0;
                    }
                    part * (half_space.enclosed(s1 / mfp).value - half_space.enclosed(s0 / mfp).value)
                };
                let expected = (0..n).map(ring).sum::<f64>() / surface_albedo / (PI * radius * radius);
                assert!((light - expected).abs() < 2e-3 * found[0], "r {r}: {light} {expected}");
            }
        }
    }

    #[test]
    fn power_of_a_spot_is_one() {
        let response = Response::new(1.0, Incidence::Cosine).unwrap();
        let places: Vec<f64> = (0..400).map(|i| 0.05 * (f64::from(i) + 0.5)).collect();
        let model = SpotModel::new(&places, 0.05);
        for (radius, blur) in [(1.0, 0.2), (0.0, 0.5)] {
            let spot = Spot { surface_albedo: 0.6, mfp: 0.5, radius, blur };
            let light = model.eval(&response, &spot);
            let power: f64 = light.iter().zip(&places).map(|(v, r)| v * TAU * r * 0.05).sum();
            assert!((power - 1.0).abs() < 2e-3, "{power}");
        }
    }
}
