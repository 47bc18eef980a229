//! Pre-integrated light on a sphere: how bright a curved surface is by N·L and curvature.
//!
//! E. Penner, *Pre-Integrated Skin Shading*, SIGGRAPH 2011 course notes, integrates over a ring; here it is the sphere
//! that the ring stands for:
//!
//! ```text
//! D(θ, ρ) = ∫ max(n'·l, 0) R(|x' − x|) dA' / ∫ R(|x' − x|) dA'
//! ```
//!
//! On a sphere of radius ρ an area at the chord r from x is 2πr dr, as on a plane; so the integral over r is one over the
//! profile's shares, and the mean of max(n'·l, 0) around x has a closed form.

use std::f64::consts::PI;

use translucid_profile::Profile;

use crate::language::Language;
use crate::number::literal;

/// Strata of the energy; twice as many change no value by more than 3e-4.
const SHARES: usize = 1024;

/// The table of a material: D for red, green, blue.
#[derive(Clone, Debug, PartialEq)]
pub struct CurvatureTable {
    /// Columns, N·L from −1 to 1, and rows, curvature from 0 to [`most_curvature`](Self::most_curvature).
    pub size: [usize; 2],
    /// Curvature 1/ρ of the last row \[L⁻¹\].
    pub most_curvature: f64,
    /// D of red, green, blue, row by row, in [0, 1].
    pub values: Vec<[f64; 3]>,
}

impl CurvatureTable {
    /// Makes the table of three profiles, of at least 2 columns and rows.
    pub(crate) fn new(profiles: &[Box<dyn Profile>; 3], size: [usize; 2], most_curvature: f64) -> Self {
        let [width, height] = size;
        let mut values = vec![[0.0; 3]; width * height];
        for (c, profile) in profiles.iter().enumerate() {
            let radii: Vec<f64> =
                (0..SHARES).map(|i| profile.quantile((i as f64 + 0.5) / SHARES as f64)).collect();
            for row in 0..height {
                let curvature = most_curvature * row as f64 / (height - 1) as f64;
                for column in 0..width {
                    let cosine = 2.0 * column as f64 / (width - 1) as f64 - 1.0;
                    values[row * width + column][c] = light(&radii, cosine, curvature);
                }
            }
        }
        Self { size, most_curvature, values }
    }

    pub(crate) fn text(&self, language: Language) -> String {
        let [width, height] = self.size;
        let most = literal(self.most_curvature);
        let comment = format!(
            "// Pre-integrated light on a sphere, {width} columns by {height} rows: a multiple of the light that arrives where it
// stands straight, to be multiplied by the surface albedo. Column i is N.L = 2 i/{} - 1, row j the curvature
// 1/radius = {most} j/{} [1/length]. Quadrature on the sphere, to 3e-4; E. Penner, Pre-Integrated Skin Shading, SIGGRAPH 2011
// course notes, integrates over a ring.
",
            width - 1,
            height - 1
        );
        comment + &language.table("LUT", &self.values)
    }
}

/// D, by radii that all stand for as much energy.
fn light(radii: &[f64], cosine: f64, curvature: f64) -> f64 {
    let sine = ((1.0 - cosine) * (1.0 + cosine)).max(0.0).sqrt();
    let (mut sum, mut count) = (0.0, 0);
    for r in radii {
        // The chord r spans an angle with this half sine; longer ones leave the sphere
        let half = 0.5 * r * curvature;
        if half > 1.0 {
            break;
        }
        let cos_way = 1.0 - 2.0 * half * half;
        let sin_way = 2.0 * half * (1.0 - half * half).sqrt();
        sum += mean_around(cosine * cos_way, sine * sin_way);
        count += 1;
    }
    // On a sphere so small that every stratum leaves it light is everywhere the same
    if count == 0 { 0.25 } else { sum / f64::from(count) }
}

/// Mean of max(a + b cos φ, 0) over φ, for b ≥ 0.
fn mean_around(a: f64, b: f64) -> f64 {
    if a >= b {
        return a;
    }
    if a <= -b {
        return 0.0;
    }
    let end = (-a / b).acos();
    (a * end + b * end.sin()) / PI
}

#[cfg(test)]
mod tests {
    use super::*;
    use translucid_profile::NormalizedDiffusion;

    fn table(most_curvature: f64) -> CurvatureTable {
        let profiles = [1.0, 0.5, 0.25]
            .map(|d| Box::new(NormalizedDiffusion::from_d(0.8, d).unwrap()) as Box<dyn Profile>);
        CurvatureTable::new(&profiles, [65, 9], most_curvature)
    }

    #[test]
    fn a_plane_is_lambertian() {
        let table = table(1.0);
        for (column, value) in table.values[..65].iter().enumerate() {
            let cosine = (column as f64 / 32.0 - 1.0).max(0.0);
            assert!(value.iter().all(|v| (v - cosine).abs() < 1e-12), "{column}: {value:?}");
        }
    }

    /// What enters a sphere leaves it: the mean of D over the sphere is that of max(N·L, 0), a quarter.
    #[test]
    fn spheres_keep_energy() {
        let table = table(2.0);
        for row in table.values.chunks(65) {
            for c in 0..3 {
                let trapezoid: f64 =
                    row.windows(2).map(|pair| 0.5 * (pair[0][c] + pair[1][c])).sum::<f64>() / 64.0;
                assert!((trapezoid - 0.25).abs() < 1e-3, "{trapezoid}");
            }
        }
    }

    /// Against the double integral over the sphere's surface, which knows no closed form.
    #[test]
    fn light_is_the_integral_over_the_sphere() {
        let profile = NormalizedDiffusion::from_d(1.0, 0.4).unwrap();
        let radii: Vec<f64> =
            (0..SHARES).map(|i| profile.quantile((i as f64 + 0.5) / SHARES as f64)).collect();
        for cosine in [-0.6, 0.0, 0.3, 0.9] {
            let sine = f64::sqrt(1.0 - cosine * cosine);
            let (mut above, mut below) = (0.0, 0.0);
            let n = 1500;
            for i in 0..n {
                // Angles crowd around the point, where the profile grows like 1/r
                let t = (f64::from(i) + 0.5) / f64::from(n);
                let (way, weight) = (PI * t * t, 2.0 * PI * t);
                let r = 2.0 * (0.5 * way).sin();
                for j in 0..400 {
                    let phi = 2.0 * PI * (f64::from(j) + 0.5) / 400.0;
                    let light = (cosine * way.cos() + sine * way.sin() * phi.cos()).max(0.0);
                    let area = weight * way.sin() * profile.eval(r);
                    above += light * area;
                    below += area;
                }
            }
            let found = light(&radii, cosine, 1.0);
            assert!((found - above / below).abs() < 1e-3, "{cosine}: {found} {}", above / below);
        }
    }
}
