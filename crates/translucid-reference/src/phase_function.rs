//! Distribution of the angle by which a collision deflects light.

use std::f64::consts::PI;
use std::fmt;
use std::sync::Arc;

use translucid_profile::{ParameterError, require};

use crate::phase_table::PhaseTable;

/// Phase function p(cos θ) of scatterers, 2π ∫ p d cos θ = 1.
///
/// ```
/// use translucid_reference::walk::PhaseFunction;
///
/// // Nine parts of ten forwards, one backwards
/// let two_term = PhaseFunction::TwoTerm { weight: 0.9, g1: 0.8, g2: -0.4 };
/// assert!((two_term.mean_cosine() - 0.68).abs() < 1e-12);
/// assert!((two_term.gamma() - (1.0 - 0.592) / (1.0 - 0.68)).abs() < 1e-12);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum PhaseFunction {
    /// L. G. Henyey and J. L. Greenstein 1941, *Diffuse radiation in the galaxy*, equation 2, with the mean
    /// cosine g in (−1, 1); g = 0 is isotropic.
    HenyeyGreenstein {
        /// Mean cosine.
        g: f64,
    },
    /// J. W. Strutt (Lord Rayleigh) 1871, for unpolarized light: 3/(16π) (1 + cos²θ).
    Rayleigh,
    /// Sum of two of Henyey and Greenstein's (G. W. Kattawar 1975, *A three-parameter analytic phase function for
    /// multiple scattering calculations*).
    TwoTerm {
        /// Part w ∈ \[0, 1\] of the first; the second has 1 − w.
        weight: f64,
        /// Mean cosine of the first, in (−1, 1).
        g1: f64,
        /// Mean cosine of the second, in (−1, 1).
        g2: f64,
    },
    /// Legendre moments χ₁, χ₂, …, χ₀ = 1 being left out and those behind the last being 0:
    /// p = (1/4π) Σ (2l + 1) χ_l P_l(cos θ). The first is the mean cosine g.
    Moments(Arc<[f64]>),
    /// Values over the cosine.
    Table(Arc<PhaseTable>),
}

/// Most moments of a walk, which tabulates their sum.
const MOST_MOMENTS: usize = 1000;
/// Values of 4π p that rounding of published moments, and that of sums makes.
const ROUNDED: [f64; 2] = [-1e-3, -1e-9];

impl PhaseFunction {
    /// Every direction alike.
    pub const ISOTROPIC: Self = Self::HenyeyGreenstein { g: 0.0 };
    /// Names of the kinds.
    pub const KINDS: [&'static str; 5] = ["henyey-greenstein", "rayleigh", "two-term", "moments", "table"];
    /// The forms that [`parse`](Self::parse) reads, in words.
    pub const WORDS: [&'static str; 4] =
        ["henyey-greenstein", "rayleigh", "two-term:W,G1,G2", "moments:X1,X2,..."];

    /// Phase function from words as the command line has them, `henyey-greenstein` having the given g; nothing if they
    /// begin with none of the [`WORDS`](Self::WORDS).
    ///
    /// # Errors
    /// Numbers behind the name are none or too few, or g belongs to another one.
    pub fn parse(text: &str, g: f64) -> Result<Option<Self>, String> {
        let (name, rest) = match text.split_once(':') {
            Some((name @ ("two-term" | "moments"), rest)) => (name, Some(rest)),
            None if Self::KINDS[..2].contains(&text) => (text, None),
            _ => return Ok(None),
        };
        if g != 0.0 && name == "rayleigh" {
            return Err(format!("g is {g}, but Rayleigh's phase function has g = 0"));
        }
        if g != 0.0 && name != "henyey-greenstein" {
            return Err(format!("g is {g}, but belongs to henyey-greenstein, not to {name}"));
        }
        let number = |word: &str| {
            let number = word.trim().parse().ok().filter(|number: &f64| number.is_finite());
            number
                .ok_or_else(|| format!("{name} has {word:?}, but must have finite numbers behind the colon"))
        };
        let words = rest.into_iter().flat_map(|rest| rest.split(','));
        let numbers = words.map(number).collect::<Result<Vec<f64>, String>>()?;
        Self::from_numbers(name, g, &numbers).map(Some).map_err(|problem| format!("{name} {problem}"))
    }

    /// Name of its kind.
    pub fn name(&self) -> &'static str {
        Self::KINDS[match self {
            Self::HenyeyGreenstein { .. } => 0,
            Self::Rayleigh => 1,
            Self::TwoTerm { .. } => 2,
            Self::Moments(_) => 3,
            Self::Table(_) => 4,
        }]
    }

    /// Numbers that tell it from others of its kind, g of Henyey and Greenstein's apart.
    pub(crate) fn numbers(&self) -> Vec<f64> {
        match self {
            Self::HenyeyGreenstein { .. } | Self::Rayleigh => Vec::new(),
            Self::TwoTerm { weight, g1, g2 } => vec![*weight, *g1, *g2],
            Self::Moments(moments) => moments.to_vec(),
            Self::Table(table) => table.rows().concat(),
        }
    }

    /// Phase function with such a name and numbers.
    pub(crate) fn from_numbers(name: &str, g: f64, numbers: &[f64]) -> Result<Self, String> {
        match (name, numbers) {
            ("henyey-greenstein", []) => Ok(Self::HenyeyGreenstein { g }),
            ("rayleigh", []) => Ok(Self::Rayleigh),
            ("two-term", [weight, g1, g2]) => Ok(Self::TwoTerm { weight: *weight, g1: *g1, g2: *g2 }),
            ("moments", [_, ..]) => Ok(Self::Moments(numbers.into())),
            ("table", _) if numbers.len().is_multiple_of(2) => {
                let table =
                    PhaseTable::new(numbers.as_chunks().0.to_vec()).map_err(|error| error.to_string())?;
                Ok(Self::Table(Arc::new(table)))
            }
            ("two-term", _) => Err(format!("has {} numbers, but must have 3: W,G1,G2", numbers.len())),
            _ => Err(format!("has {} numbers, which no {name} has", numbers.len())),
        }
    }

    /// Legendre moment χ_l ∈ [−1, 1], χ₀ = 1.
    pub fn moment(&self, l: usize) -> f64 {
        match self {
            _ if l == 0 => 1.0,
            Self::HenyeyGreenstein { g } => libm::pow(*g, l as f64),
            Self::Rayleigh => [0.0, 0.0, 0.1].get(l).copied().unwrap_or(0.0),
            Self::TwoTerm { weight, g1, g2 } => {
                weight * libm::pow(*g1, l as f64) + (1.0 - weight) * libm::pow(*g2, l as f64)
            }
            Self::Moments(moments) => moments.get(l - 1).copied().unwrap_or(0.0),
            Self::Table(table) => table.moment(l),
        }
    }

    /// Warns of a table that is too coarse for its peak ([`PhaseTable::warning`]).
    pub fn warning(&self) -> Option<String> {
        if let Self::Table(table) = self { table.warning() } else { None }
    }

    /// Mean cosine g = χ₁ of the deflection.
    pub fn mean_cosine(&self) -> f64 {
        self.moment(1)
    }

    /// Second similarity parameter γ = (1 − χ₂)/(1 − χ₁), which decides R(r) near the light; 1 + g for Henyey and
    /// Greenstein's (F. Bevilacqua and C. Depeursinge 1999, *Monte Carlo study of diffuse reflectance at source–detector
    /// separations close to one transport mean free path*).
    pub fn gamma(&self) -> f64 {
        (1.0 - self.moment(2)) / (1.0 - self.moment(1))
    }

    /// Returns whether every direction is alike.
    pub fn is_isotropic(&self) -> bool {
        match self {
            Self::Moments(moments) => moments.iter().all(|moment| *moment == 0.0),
            _ => *self == Self::ISOTROPIC,
        }
    }

    /// Phase function p at the cosine of a deflection \[sr⁻¹\]; at least 0.
    pub fn eval(&self, cosine: f64) -> f64 {
        match self {
            Self::HenyeyGreenstein { g } => henyey_greenstein(*g, cosine),
            Self::Rayleigh => 3.0 / (16.0 * PI) * (1.0 + cosine * cosine),
            Self::TwoTerm { weight, g1, g2 } => {
                weight * henyey_greenstein(*g1, cosine) + (1.0 - weight) * henyey_greenstein(*g2, cosine)
            }
            Self::Moments(moments) => (legendre_sum(moments, cosine)[0] / (4.0 * PI)).max(0.0),
            Self::Table(table) => table.eval(cosine),
        }
    }

    /// Probability of a deflection whose cosine is at most this one.
    pub fn cdf(&self, cosine: f64) -> f64 {
        // 1/√a − 1/(1 + g) over g, without the cancellation at small g
        let of_g = |g: f64| {
            let root = (1.0 + g * g - 2.0 * g * cosine).sqrt();
            (1.0 - g) * (1.0 + cosine) / (root * (1.0 + g + root))
        };
        match self {
            Self::HenyeyGreenstein { g } => of_g(*g),
            Self::Rayleigh => (4.0 + cosine * (3.0 + cosine * cosine)) / 8.0,
            Self::TwoTerm { weight, g1, g2 } => weight * of_g(*g1) + (1.0 - weight) * of_g(*g2),
            Self::Moments(moments) => legendre_sum(moments, cosine)[1],
            Self::Table(table) => table.cdf(cosine),
        }
    }

    /// Checks numbers for a solution by moments.
    pub(crate) fn check(&self) -> Result<(), ParameterError> {
        let is_cosine =
            |name: &'static str, g: f64| require(g > -1.0 && g < 1.0, name, g, "in (-1, 1)").map(|_| ());
        match self {
            Self::HenyeyGreenstein { g } => is_cosine("g", *g),
            Self::TwoTerm { weight, g1, g2 } => {
                require(
                    (0.0..=1.0).contains(weight),
                    "weight of a two-term phase function",
                    *weight,
                    "in [0, 1]",
                )?;
                is_cosine("g1", *g1)?;
                is_cosine("g2", *g2)
            }
            Self::Moments(moments) => {
                moments.iter().try_for_each(|moment| is_cosine("moments", *moment))?;
                let allowed = "at least 0: these are no moments of a phase function";
                require_density(moments, ROUNDED[0], allowed)
            }
            Self::Rayleigh | Self::Table(_) => Ok(()),
        }
    }

    /// Checks numbers for a walk, which draws angles: p is nowhere below 0.
    pub(crate) fn check_for_walk(&self) -> Result<(), ParameterError> {
        self.check()?;
        match self {
            Self::Moments(moments) => {
                let count = moments.len();
                require(
                    count <= MOST_MOMENTS,
                    "number of moments",
                    count as f64,
                    "at most 1000, for a walk",
                )?;
                let allowed = "at least 0 at every angle, for a walk: give more moments or digits";
                require_density(moments, ROUNDED[1], allowed)
            }
            Self::TwoTerm { g1, g2, .. } => {
                [("g1", *g1), ("g2", *g2)].into_iter().try_for_each(|(name, g)| {
                    require(g.abs() <= 0.9999, name, g, "in [-0.9999, 0.9999], for a walk").map(|_| ())
                })
            }
            _ => Ok(()),
        }
    }
}

impl fmt::Display for PhaseFunction {
    /// Writes it as [`PhaseFunction::parse`] reads it, and a table by its name.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())?;
        if matches!(self, Self::TwoTerm { .. } | Self::Moments(_)) {
            let words: Vec<String> = self.numbers().iter().map(f64::to_string).collect();
            write!(f, ":{}", words.join(","))?;
        }
        Ok(())
    }
}

fn henyey_greenstein(g: f64, cosine: f64) -> f64 {
    let square = 1.0 + g * g - 2.0 * g * cosine;
    (1.0 - g * g) / (4.0 * PI * square * square.sqrt())
}

/// 4π p, and its cdf by ∫ (2l + 1) P_l = P_{l+1} − P_{l−1}.
fn legendre_sum(moments: &[f64], x: f64) -> [f64; 2] {
    let (mut before, mut now) = (1.0, x);
    let mut sums = [1.0, 0.5 * (1.0 + x)];
    for (l, moment) in moments.iter().enumerate() {
        let order = (l + 1) as f64;
        let next = ((2.0 * order + 1.0) * x * now - order * before) / (order + 1.0);
        sums[0] += (2.0 * order + 1.0) * moment * now;
        sums[1] += 0.5 * moment * (next - before);
        (before, now) = (now, next);
    }
    sums
}

/// Refuses moments whose sum 4π p is below a bound at some angle, of four to each oscillation.
fn require_density(moments: &[f64], least: f64, allowed: &'static str) -> Result<(), ParameterError> {
    let points = 4 * moments.len() + 8;
    let at = |i: usize| legendre_sum(moments, libm::cos(PI * i as f64 / points as f64))[0];
    let lowest = (0..=points).map(at).fold(f64::INFINITY, f64::min);
    require(lowest >= least, "4 pi times the phase function at some angle", lowest, allowed).map(|_| ())
}

#[cfg(test)]
mod tests {
    use translucid_profile::quadrature::{gauss_legendre, integrate};

    use super::*;

    fn all() -> Vec<PhaseFunction> {
        let hg = |g: f64| PhaseFunction::HenyeyGreenstein { g };
        let rows = (0..=2000).map(|i| {
            let cosine = f64::from(i) / 1000.0 - 1.0;
            [cosine, hg(0.6).eval(cosine)]
        });
        vec![
            hg(0.0),
            hg(0.7),
            hg(-0.3),
            PhaseFunction::Rayleigh,
            PhaseFunction::TwoTerm { weight: 0.85, g1: 0.75, g2: -0.4 },
            PhaseFunction::Moments([0.5, 0.3, 0.1, 0.02].into()),
            PhaseFunction::Table(Arc::new(PhaseTable::new(rows.collect()).unwrap())),
        ]
    }

    #[test]
    fn eval_integrates_to_moments_and_cdf() {
        let rule = gauss_legendre(8);
        for phase_function in all() {
            // Piece by piece: the table has edges
            let pieces = |to: f64, f: &dyn Fn(f64) -> f64| -> f64 {
                let width = (to + 1.0) / 2000.0;
                (0..2000).map(|i| f64::from(i) * width - 1.0).map(|x| integrate(&rule, x, x + width, f)).sum()
            };
            for l in 0..12usize {
                let legendre = |x: f64| {
                    let (mut before, mut now) = (1.0, x);
                    for n in 1..l {
                        let n = n as f64;
                        (before, now) = (now, ((2.0 * n + 1.0) * x * now - n * before) / (n + 1.0));
                    }
                    if l == 0 { 1.0 } else { now }
                };
                let found = pieces(1.0, &|x| 2.0 * PI * phase_function.eval(x) * legendre(x));
                let expected = phase_function.moment(l);
                assert!((found - expected).abs() < 1e-11, "{phase_function:?} {l}: {found} {expected}");
            }
            for cosine in [-1.0, -0.72, 0.0, 0.4, 0.98, 1.0] {
                let found = pieces(cosine, &|x| 2.0 * PI * phase_function.eval(x));
                let expected = phase_function.cdf(cosine);
                assert!((found - expected).abs() < 1e-8, "{phase_function:?} {cosine}: {found} {expected}");
            }
        }
    }

    #[test]
    fn names_are_read_back() {
        for phase_function in all() {
            let g = if let PhaseFunction::HenyeyGreenstein { g } = phase_function { g } else { 0.0 };
            let read = PhaseFunction::parse(&phase_function.to_string(), g).unwrap();
            let is_table = matches!(phase_function, PhaseFunction::Table(_));
            assert_eq!(read, (!is_table).then_some(phase_function));
        }
        for (text, g, expected) in [
            ("two-term:0.9,0.8", 0.0, "two-term has 2 numbers, but must have 3: W,G1,G2"),
            ("two-term:0.9,0.8,x", 0.0, "two-term has \"x\", but must have finite numbers behind the colon"),
            ("moments:", 0.0, "moments has \"\", but must have finite numbers behind the colon"),
            ("moments:0.1", 0.5, "g is 0.5, but belongs to henyey-greenstein, not to moments"),
            ("rayleigh", 0.5, "g is 0.5, but Rayleigh's phase function has g = 0"),
        ] {
            assert_eq!(PhaseFunction::parse(text, g), Err(expected.to_owned()));
        }
        for unknown in ["mie", "rayleigh:1", "moments", "henyey-greenstein:0.5"] {
            assert_eq!(PhaseFunction::parse(unknown, 0.0), Ok(None));
        }
    }

    #[test]
    fn what_is_no_phase_function_is_refused() {
        let refused =
            |phase_function: PhaseFunction| phase_function.check_for_walk().unwrap_err().to_string();
        let moments = |moments: &[f64]| PhaseFunction::Moments(moments.into());
        assert!(refused(moments(&[0.9])).contains("no moments of a phase function"));
        assert_eq!(refused(moments(&[1.0])), "moments is 1, but must be in (-1, 1)");
        let two_term = |weight, g1, g2| PhaseFunction::TwoTerm { weight, g1, g2 };
        assert!(refused(two_term(1.1, 0.5, 0.5)).contains("weight of a two-term phase function is 1.1"));
        assert!(refused(two_term(0.5, 0.5, -1.0)).contains("g2 is -1"));
        // Published digits make 1 − 1.0002: good enough to solve, not to draw angles
        let rounded = moments(&[0.3334]);
        assert!(rounded.check().is_ok());
        let message = refused(rounded);
        assert!(message.contains("at some angle is -0.000") && message.contains("for a walk"), "{message}");
    }
}
