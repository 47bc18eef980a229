//! Two fluxes of light in layers.

use translucid_profile::{fresnel_from_outside, fresnel_moment_1_from_inside, fresnel_moment_1_from_outside};
use translucid_reference::layers::{Ground, Layer, Layers};

use super::{COS_8_DEGREES, Specular};

/// Reflectance of layers by P. Kubelka and F. Munk, "Ein Beitrag zur Optik der Farbanstriche", 1931, in the form of
/// P. Kubelka, "New contributions to the optics of intensely light-scattering materials. Part I", 1948.
///
/// K = 2σ_a and S = ¾σ_s(1 − g) − ¼σ_a, as M. J. C. van Gemert and W. M. Star 1987 have them (in W.-F. Cheong, S. A. Prahl and
/// A. J. Welch, "A review of the optical properties of biological tissues", 1990); S is at least 0.
/// Faces are those of J. L. Saunderson, "Calculation of the color of pigmented plastics", 1942:
///
/// ```text
/// R = k₁ + (1 − k₁)(1 − k₂) R_i / (1 − k₂ R_i)
/// ```
///
/// The first face reflects k₁ of the light at 8° and k₂ of diffuse light from inside; all other faces meet diffuse light.
pub fn kubelka_munk(layers: &Layers, specular: Specular) -> f64 {
    let etas: Vec<f64> =
        std::iter::once(layers.eta_above()).chain(layers.layers().iter().map(|layer| layer.eta)).collect();
    let last = etas[etas.len() - 1];
    let mut reflectance = match layers.ground() {
        Ground::None => 0.0,
        Ground::Medium { eta } => 2.0 * fresnel_moment_1_from_outside(eta / last),
        Ground::Lambertian { reflectance } => reflectance,
    };
    for (i, layer) in layers.layers().iter().enumerate().rev() {
        let [inside, passed] = two_fluxes(layer);
        reflectance = over([inside, inside], passed * passed, reflectance);
        let eta = layer.eta / etas[i];
        if i > 0 {
            let [outside, inside] =
                [2.0 * fresnel_moment_1_from_outside(eta), 2.0 * fresnel_moment_1_from_inside(eta)];
            reflectance = over([outside, inside], (1.0 - outside) * (1.0 - inside), reflectance);
        }
    }
    let eta = etas[1] / etas[0];
    let (k1, k2) = (fresnel_from_outside(COS_8_DEGREES, eta), 2.0 * fresnel_moment_1_from_inside(eta));
    let gloss = if specular == Specular::Included { k1 } else { 0.0 };
    over([gloss, k2], (1.0 - k1) * (1.0 - k2), reflectance)
}

/// Reflectance of what has the reflectances from above and below, and lets a part pass to and fro, over something.
fn over([above, below]: [f64; 2], passed: f64, ground: f64) -> f64 {
    if passed == 0.0 { above } else { above + passed * ground / (1.0 - below * ground) }
}

/// Reflectance and transmittance of a layer without faces.
fn two_fluxes(layer: &Layer) -> [f64; 2] {
    let k = 2.0 * layer.absorption;
    let g = layer.phase_function.moment(1);
    let s = (0.75 * layer.scattering * (1.0 - g) - 0.25 * layer.absorption).max(0.0);
    let root = (k * (k + 2.0 * s)).sqrt();
    if layer.thickness.is_infinite() {
        return [if s > 0.0 { s / (s + k + root) } else { 0.0 }, 0.0];
    }
    let depth = root * layer.thickness;
    // (1 − exp(−2 depth))/root, which has a limit where nothing is absorbed
    let lost = if root > 0.0 { -libm::expm1(-2.0 * depth) / root } else { 2.0 * layer.thickness };
    let denominator = (s + k) * lost + 1.0 + libm::exp(-2.0 * depth);
    [s * lost / denominator, 2.0 * libm::exp(-depth) / denominator]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn black(layer: Layer) -> f64 {
        kubelka_munk(&Layers::new(1.0, vec![layer], Ground::BLACK).unwrap(), Specular::Included)
    }

    /// R∞ = 1 + K/S − √((K/S)² + 2K/S); over a ground R = (1 − R_g(a − b coth bSd))/(a − R_g + b coth bSd) (P. Kubelka 1948).
    #[test]
    fn known_forms_are_met() {
        let (scattering, absorption): (f64, f64) = (4.0, 0.2);
        let (k, s) = (2.0 * absorption, 0.75 * scattering * 0.5 - 0.25 * absorption);
        let endless = Layer::new(scattering, absorption, f64::INFINITY).with_g(0.5);
        let layers = Layers::new(1.0, vec![endless], Ground::None).unwrap();
        let expected = 1.0 + k / s - ((k / s).powi(2) + 2.0 * k / s).sqrt();
        assert!((kubelka_munk(&layers, Specular::Included) - expected).abs() < 1e-14);
        for ground in [0.0, 0.3, 1.0] {
            let layer = Layer::new(scattering, absorption, 0.7).with_g(0.5);
            let layers = Layers::new(1.0, vec![layer], Ground::Lambertian { reflectance: ground }).unwrap();
            let a = (s + k) / s;
            let b = (a * a - 1.0).sqrt();
            let b_coth = b / (b * s * 0.7).tanh();
            let expected = (1.0 - ground * (a - b_coth)) / (a - ground + b_coth);
            let found = kubelka_munk(&layers, Specular::Included);
            assert!((found - expected).abs() < 1e-14, "{ground}: {found}, expected {expected}");
        }
    }

    /// Without absorption Sd/(1 + Sd), without scattering only the ground, of two halves the whole.
    #[test]
    fn limits_are_met() {
        assert!((black(Layer::new(4.0, 0.0, 0.5)) - 1.5 / 2.5).abs() < 1e-14);
        assert!((black(Layer::new(4.0, 1e-14, 0.5)) - 1.5 / 2.5).abs() < 1e-6);
        assert_eq!(black(Layer::new(0.0, 3.0, 0.5)), 0.0);
        assert_eq!(black(Layer::new(1e30, 0.0, 1e30)), 1.0);
        let half = Layer::new(4.0, 0.2, 0.35).with_eta(1.3);
        let whole = Layer { thickness: 0.7, ..half.clone() };
        let ground = Ground::Lambertian { reflectance: 0.4 };
        let [two, one] = [vec![half.clone(), half], vec![whole]]
            .map(|layers| kubelka_munk(&Layers::new(1.0, layers, ground).unwrap(), Specular::Excluded));
        assert!((two - one).abs() < 1e-14);
    }
}
