//! Forward model of a flat piece that an opaque card covers in part, as a camera sees it.

use std::f64::consts::{FRAC_2_PI, TAU};

use crate::response::Response;

/// An edge of light: dark at negative positions, lit at positive ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// Surface albedo A in \[0, 1\]: it shapes how light creeps.
    pub surface_albedo: f64,
    /// Mean free path ℓ \[L\].
    pub mfp: f64,
    /// Where the card ends \[L\].
    pub position: f64,
    /// Standard deviation of the camera's blur \[L\].
    pub blur: f64,
}

/// Edges of light seen at fixed places, ready to be evaluated many times.
///
/// The card's edge is one of many: the light is a pattern of stripes that are wider than light creeps, which is a sum of
/// sines, and the half space answers each with its [`Response`].
///
/// ```text
/// E(x) = ½ + Σ_{n odd} 2/(πn) T(k_n ℓ; A) e^{−σ²k_n²/2} sinc(k_n p/2) sin(k_n x),     k_n = 2πn/P
/// ```
///
/// with the period P, the pixel's width p and the blur σ.
#[derive(Clone, Debug)]
pub struct EdgeModel {
    wave_numbers: Vec<f64>,
    /// 2/(πn) and what a pixel's width leaves, by wave number.
    heights: Vec<f64>,
    /// sin and cos of k_n x, by place.
    waves: Vec<Vec<[f64; 2]>>,
}

/// Period of the stripes over the extent of the places.
const PERIODS: f64 = 8.0;

impl EdgeModel {
    /// For places that are averages over pixels of such a width \[L\].
    pub fn new(places: &[f64], pixel_width: f64) -> Self {
        let (low, high) =
            places.iter().fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(*x), high.max(*x)));
        let period = PERIODS * (high - low).max(4.0 * pixel_width);
        // Finer than a pixel there is hardly anything: its width and the blur are in the way
        let count = (period / pixel_width) as usize;
        let wave_numbers: Vec<f64> = (0..count).map(|i| TAU * (2 * i + 1) as f64 / period).collect();
        let height = |(i, k): (usize, &f64)| {
            let half = 0.5 * k * pixel_width;
            FRAC_2_PI / (2 * i + 1) as f64 * libm::sin(half) / half
        };
        let heights = wave_numbers.iter().enumerate().map(height).collect();
        let waves = places.iter().map(|x| {
            let wave = |k: &f64| {
                let (sin, cos) = libm::sincos(k * x);
                [sin, cos]
            };
            wave_numbers.iter().map(wave).collect()
        });
        let waves = waves.collect();
        Self { wave_numbers, heights, waves }
    }

    /// Light at each place over that far on the lit side, of a piece's response.
    pub fn eval(&self, response: &Response, edge: &Edge) -> Vec<f64> {
        let Edge { surface_albedo, mfp, position, blur } = *edge;
        let transfer = response.transfer(surface_albedo, mfp);
        let amplitude = |(k, height): (&f64, &f64)| {
            let blurred = height * libm::exp(-0.5 * (blur * k).powi(2));
            // Of what is below rounding nothing is left
            let [re, im] = if blurred.abs() > 1e-9 { transfer.at(*k) } else { [0.0; 2] };
            // T of sin k(x − x₀), of cos k(x − x₀) where light enters obliquely
            let (sin, cos) = libm::sincos(k * position);
            [blurred * (re * cos + im * sin), blurred * (im * cos - re * sin)]
        };
        let amplitudes: Vec<[f64; 2]> = self.wave_numbers.iter().zip(&self.heights).map(amplitude).collect();
        self.waves.iter().map(|waves| 0.5 + sum_of_products(waves, &amplitudes)).collect()
    }
}

/// Σ (sin a + cos b), in eight sums that do not wait for each other.
fn sum_of_products(waves: &[[f64; 2]], amplitudes: &[[f64; 2]]) -> f64 {
    let (waves, last_waves) = waves.as_flattened().as_chunks::<8>();
    let (amplitudes, last_amplitudes) = amplitudes.as_flattened().as_chunks::<8>();
    let mut sums = [0.0; 8];
    for (wave, amplitude) in waves.iter().zip(amplitudes) {
        for i in 0..8 {
            sums[i] += wave[i] * amplitude[i];
        }
    }
    let rest: f64 = last_waves.iter().zip(last_amplitudes).map(|(wave, amplitude)| wave * amplitude).sum();
    rest + sums.iter().sum::<f64>()
}

/// Integral of a profile over a line at a distance from the entry is that of its transfer: the exact edge by an independent
/// road, for tests.
#[cfg(test)]
fn line_integral(profile: impl Fn(f64) -> f64, x: f64, reach: f64) -> f64 {
    // ∫ R(√(x² + y²)) dy, y = x sinh t
    let n = 2000;
    let last = libm::asinh(reach / x);
    let h = last / f64::from(n);
    let at = |i: i32| {
        let t = h * f64::from(i);
        profile(x * libm::cosh(t)) * x * libm::cosh(t)
    };
    2.0 * h * ((1..n).map(at).sum::<f64>() + 0.5 * (at(0) + at(n)))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use translucid_reference::Incidence;
    use translucid_reference::exact::HalfSpace;

    use super::*;

    /// The share of light beyond a line, ∫_x^∞ LSF, from the profile in space and not from its transform.
    fn beyond_line(half_space: &HalfSpace, x: f64) -> f64 {
        let total = half_space.total().value;
        // ∫ acos(x/r)/π dE over rings
        let n = 1000;
        let ring = |i: i32| x / libm::cos(0.5 * PI * f64::from(i) / f64::from(n));
        let beyond = |i: i32| if i == n { 0.0 } else { half_space.beyond(ring(i)).value };
        let share = |i: i32| (beyond(i) - beyond(i + 1)) * (f64::from(i) + 0.5) / f64::from(2 * n);
        (0..n).map(share).sum::<f64>() / total
    }

    #[test]
    fn edge_is_the_integral_of_the_profile() {
        let response = Response::new(1.0, Incidence::Cosine).unwrap();
        for (surface_albedo, mfp) in [(0.3, 0.4), (0.8, 1.0), (0.95, 0.7)] {
            let places: Vec<f64> = (-20..=20).map(|i| 0.2 * f64::from(i)).collect();
            // Pixels so narrow that they blur nothing
            let model = EdgeModel::new(&places, 0.02);
            let edge = Edge { surface_albedo, mfp, position: 0.03, blur: 0.0 };
            let half_space = HalfSpace::from_surface_albedo(surface_albedo, Incidence::Cosine).unwrap();
            for (x, light) in places.iter().zip(model.eval(&response, &edge)) {
                let x = x - 0.03;
                let beyond = beyond_line(&half_space, x.abs() / mfp);
                let expected = if x < 0.0 { beyond } else { 1.0 - beyond };
                assert!((light - expected).abs() < 2e-3, "A {surface_albedo}, x {x}: {light} {expected}");
            }
        }
    }

    /// Light of a beam that is scattered once, by its way in and out: at a depth t it has come t tan θ along, so that
    /// E(x) = ∫ e^{−t(1/μ + 1)} [x > t tan θ] dt (1/μ + 1) = 1 − e^{−x(1/μ + 1)/tan θ} on the lit side. Of a dark piece there is
    /// hardly more.
    #[test]
    fn edge_of_an_oblique_beam_is_where_single_scattering_is() {
        let angle = 0.7_f64;
        let places: Vec<f64> = (-20..=20).map(|i| 0.1 * f64::from(i) + 0.05).collect();
        let model = EdgeModel::new(&places, 0.01);
        for sign in [1.0, -1.0] {
            let response = Response::of_beam(sign * angle).unwrap();
            let edge = Edge { surface_albedo: 0.006, mfp: 1.0, position: 0.0, blur: 0.0 };
            for (x, light) in places.iter().zip(model.eval(&response, &edge)) {
                let slope = (1.0 / libm::cos(angle) + 1.0) / libm::tan(angle);
                let beyond = libm::exp(-slope * x.abs());
                let expected = if sign * x < 0.0 { 0.0 } else { 1.0 - beyond };
                let expected = if sign > 0.0 { expected } else { 1.0 - expected };
                assert!((light - expected).abs() < 0.015, "{sign} {x}: {light} {expected}");
            }
        }
    }

    #[test]
    fn slope_of_an_edge_is_the_line_integral() {
        let half_space = HalfSpace::from_surface_albedo(0.8, Incidence::Cosine).unwrap();
        let (x, h) = (1.3, 1e-3);
        let slope = (beyond_line(&half_space, x - h) - beyond_line(&half_space, x + h)) / (2.0 * h);
        let line = line_integral(|r| half_space.eval(r).value, x, 60.0) / 0.8;
        assert!((slope / line - 1.0).abs() < 1e-3, "{slope} {line}");
    }
}
