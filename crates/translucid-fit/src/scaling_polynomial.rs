//! The forms in which P. H. Christensen and B. Burley state the scale of normalized diffusion.

use std::fmt;

use translucid_profile::{Configuration, Parameterization};

/// Scale of normalized diffusion as a function of the surface albedo A, dimensionless.
///
/// ```text
/// s(A) = constant − slope A + factor |A − center|^power
/// ```
///
/// P. H. Christensen and B. Burley, *Approximate Reflectance Profiles for Efficient Subsurface Scattering*, 2015,
/// equations 5, 6 and 8.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScalingPolynomial {
    /// Constant term.
    pub constant: f64,
    /// Slope with which it falls with A; 0 or 1.
    pub slope: f64,
    /// Factor of the power.
    pub factor: f64,
    /// Surface albedo at which the power is 0.
    pub center: f64,
    /// Exponent, 2 or more.
    pub power: i32,
}

impl ScalingPolynomial {
    /// The talk's for a length and a configuration; for (ℓ_d, diffuse) it has none, that for (ℓ_d, searchlight) stands
    /// in.
    pub fn talk(parameterization: Parameterization, configuration: Configuration) -> Self {
        match (parameterization, configuration) {
            (Parameterization::Mfp, Configuration::Searchlight) => {
                Self { constant: 1.85, slope: 1.0, factor: 7.0, center: 0.8, power: 3 }
            }
            (Parameterization::Mfp, Configuration::Diffuse) => {
                Self { constant: 1.9, slope: 1.0, factor: 3.5, center: 0.8, power: 2 }
            }
            (Parameterization::Dmfp, _) => {
                Self { constant: 3.5, slope: 0.0, factor: 100.0, center: 0.33, power: 4 }
            }
        }
    }

    /// s(A).
    pub fn eval(&self, surface_albedo: f64) -> f64 {
        let power = (surface_albedo - self.center).abs().powi(self.power);
        self.constant - self.slope * surface_albedo + self.factor * power
    }

    /// The constants that a fit moves: constant, factor, center.
    pub(crate) fn constants(&self) -> [f64; 3] {
        [self.constant, self.factor, self.center]
    }

    pub(crate) fn with_constants(self, [constant, factor, center]: [f64; 3]) -> Self {
        Self { constant, factor, center, ..self }
    }

    /// Slopes of s(A) over the constants.
    pub(crate) fn slopes(&self, surface_albedo: f64) -> [f64; 3] {
        let off = surface_albedo - self.center;
        let power = off.abs().powi(self.power);
        let slope = off.abs().powi(self.power - 1).copysign(off) * f64::from(self.power);
        [1.0, power, -self.factor * slope]
    }
}

/// Writes the formula, with five significant digits of each constant.
impl fmt::Display for ScalingPolynomial {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "s = {}", digits(self.constant))?;
        match self.slope {
            0.0 => {}
            1.0 => write!(out, " - A")?,
            slope => write!(out, " - {} A", digits(slope))?,
        }
        let (sign, factor) = if self.factor < 0.0 { ('-', -self.factor) } else { ('+', self.factor) };
        let base = format!("A - {}", digits(self.center));
        let base = if self.power % 2 == 0 { format!("({base})") } else { format!("|{base}|") };
        write!(out, " {sign} {} {base}^{}", digits(factor), self.power)
    }
}

fn digits(value: f64) -> String {
    let places = 4 - libm::log10(value.abs().max(1e-4)).floor() as i32;
    let text = format!("{value:.*}", places.max(0) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use translucid_profile::scaling;

    use super::*;

    const CASES: [(Parameterization, Configuration); 4] = [
        (Parameterization::Mfp, Configuration::Searchlight),
        (Parameterization::Mfp, Configuration::Diffuse),
        (Parameterization::Dmfp, Configuration::Searchlight),
        (Parameterization::Dmfp, Configuration::Diffuse),
    ];

    #[test]
    fn talk_is_what_the_profile_takes() {
        for (parameterization, configuration) in CASES {
            for i in 0..=20 {
                let a = 0.05 * f64::from(i);
                let found = ScalingPolynomial::talk(parameterization, configuration).eval(a);
                assert!((found / scaling(a, parameterization, configuration) - 1.0).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn slopes_are_those_of_eval() {
        for (parameterization, configuration) in CASES {
            let form = ScalingPolynomial::talk(parameterization, configuration);
            for a in [0.1, 0.5, 0.95] {
                for (i, slope) in form.slopes(a).into_iter().enumerate() {
                    let moved = |by: f64| {
                        let mut constants = form.constants();
                        constants[i] += by;
                        form.with_constants(constants).eval(a)
                    };
                    assert!(((moved(1e-5) - moved(-1e-5)) / 2e-5 - slope).abs() < 1e-6, "{a} {i}");
                }
            }
        }
    }

    #[test]
    fn formula_reads_as_in_the_talk() {
        let of = |p, c| ScalingPolynomial::talk(p, c).to_string();
        assert_eq!(of(CASES[0].0, CASES[0].1), "s = 1.85 - A + 7 |A - 0.8|^3");
        assert_eq!(of(CASES[1].0, CASES[1].1), "s = 1.9 - A + 3.5 (A - 0.8)^2");
        assert_eq!(of(CASES[2].0, CASES[2].1), "s = 3.5 + 100 (A - 0.33)^4");
    }
}
