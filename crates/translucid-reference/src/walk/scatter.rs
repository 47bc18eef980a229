//! Deflection at a collision, in 16 lanes.

use fearless_simd::Simd;
use fearless_simd::prelude::*;

use super::deflection_table::{DeflectionLaw, DeflectionTable};
use super::lanes::{Floats, FusedMulAdd, Words, circle, complement, polynomial, signed, unit};

/// Unit vectors.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Directions<S: Simd> {
    pub(crate) x: Floats<S>,
    pub(crate) y: Floats<S>,
    pub(crate) z: Floats<S>,
}

/// Cosine and sine of the angle of deflection.
pub(crate) type Deflection<S> = (Floats<S>, Floats<S>);

/// A way to scatter; a type of its own, so that the kernel is compiled for each.
pub(crate) trait Scatter: Copy {
    /// True where the new direction depends on the old one.
    const REMEMBERS: bool;

    /// The direction after a collision, from two words.
    fn scatter<S: Simd>(self, simd: S, before: Directions<S>, words: [Words<S>; 2]) -> Directions<S>;
}

/// Every direction alike: the old one does not matter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Isotropic;

impl Scatter for Isotropic {
    const REMEMBERS: bool = false;

    #[inline(always)]
    fn scatter<S: Simd>(self, simd: S, _: Directions<S>, [polar, azimuth]: [Words<S>; 2]) -> Directions<S> {
        let z = signed(polar);
        let sine = complement(z);
        let (x, y) = circle(simd, azimuth);
        Directions { x: sine * x, y: sine * y, z }
    }
}

/// Henyey and Greenstein's phase function.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HenyeyGreenstein {
    /// |g|
    g: f32,
    /// 1 − |g|, which has its digits where g is near 1.
    one_minus_g: f32,
    /// The sign of g.
    sign: f32,
}

impl HenyeyGreenstein {
    /// g in (−1, 1).
    pub(crate) fn new(g: f64) -> Self {
        let one_minus_g = ((1.0 - g.abs()) as f32).max(f32::MIN_POSITIVE);
        Self { g: g.abs() as f32, one_minus_g, sign: if g < 0.0 { -1.0 } else { 1.0 } }
    }

    /// Inverts the cumulative distribution: with ξ uniform in (0, 1] and g ≥ 0
    ///
    /// ```text
    /// 1 − cos θ = 2 (1 − ξ)(1 + g ξ) [(1 − g)/(1 − g + 2gξ)]²
    /// ```
    ///
    /// which is the usual (1 + g² − ((1 − g²)/(1 − g + 2gξ))²)/2g, less its division by g (g → 0 has no limit
    /// to take) and its cancellation (a deflection by 1e-3 has a cosine of 1 − 5e-7, four digits short in
    /// single precision). A negative g deflects by π − θ.
    #[inline(always)]
    pub(crate) fn deflection<S: Simd>(self, simd: S, word: Words<S>) -> Deflection<S> {
        let xi = unit(word);
        let twice = xi * (2.0 * self.g);
        let ratio = Floats::splat(simd, self.one_minus_g) / (twice + self.one_minus_g);
        let one = Floats::splat(simd, 1.0);
        let versine = (one - xi) * (twice + 2.0) * (ratio * ratio);
        let versine = versine.min(2.0);
        let sine = (versine * (2.0 - versine)).sqrt();
        ((one - versine) * self.sign, sine)
    }
}

impl Scatter for HenyeyGreenstein {
    const REMEMBERS: bool = true;

    #[inline(always)]
    fn scatter<S: Simd>(self, simd: S, before: Directions<S>, words: [Words<S>; 2]) -> Directions<S> {
        turn(before, self.deflection(simd, words[0]), circle(simd, words[1]))
    }
}

/// Rayleigh's phase function.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rayleigh;

/// 2 sinh(asinh(2√q)/3)/√q on [0, 1]: worst error 3.5e-3.
const RAYLEIGH: [f32; 4] = [1.3298685900912068, -0.670560884871901, 0.5480744191266288, -0.20843725348568184];

impl Rayleigh {
    /// Inverts the cumulative distribution: μ³ + 3μ = 4x for x uniform in [−1, 1], by a polynomial and one step
    /// of Halley's iteration, μ − 2 f f'/(2 f'² − f f'').
    #[inline(always)]
    pub(crate) fn deflection<S: Simd>(simd: S, word: Words<S>) -> Deflection<S> {
        let x = signed(word);
        let start = x * polynomial(simd, x * x, RAYLEIGH);
        let square = start * start;
        let third_slope = square + 1.0;
        let f = start.fused_mul_add(square + 3.0, x * -4.0);
        let cosine = start - f * third_slope / (third_slope * third_slope * 3.0 - f * start);
        let cosine = cosine.max(-1.0).min(1.0);
        (cosine, complement(cosine))
    }
}

impl Scatter for Rayleigh {
    const REMEMBERS: bool = true;

    #[inline(always)]
    fn scatter<S: Simd>(self, simd: S, before: Directions<S>, words: [Words<S>; 2]) -> Directions<S> {
        turn(before, Self::deflection(simd, words[0]), circle(simd, words[1]))
    }
}

/// Any other phase function, by a table.
#[derive(Clone, Copy)]
pub(crate) struct Tabulated<'a>(pub(crate) &'a DeflectionTable);

impl Tabulated<'_> {
    #[inline(always)]
    pub(crate) fn deflection<S: Simd>(self, simd: S, word: Words<S>) -> Deflection<S> {
        let versine = self.0.versine(simd, word);
        (Floats::splat(simd, 1.0) - versine, (versine * (2.0 - versine)).sqrt())
    }
}

impl Scatter for Tabulated<'_> {
    const REMEMBERS: bool = true;

    #[inline(always)]
    fn scatter<S: Simd>(self, simd: S, before: Directions<S>, words: [Words<S>; 2]) -> Directions<S> {
        turn(before, self.deflection(simd, words[0]), circle(simd, words[1]))
    }
}

/// Any of them, for vectors that are not worth a kernel for each.
#[derive(Clone, Copy)]
pub(crate) enum AnyScatter<'a> {
    Isotropic(Isotropic),
    HenyeyGreenstein(HenyeyGreenstein),
    Rayleigh(Rayleigh),
    Tabulated(Tabulated<'a>),
}

impl<'a> From<&'a DeflectionLaw> for AnyScatter<'a> {
    fn from(law: &'a DeflectionLaw) -> Self {
        match law {
            DeflectionLaw::Isotropic => Self::Isotropic(Isotropic),
            DeflectionLaw::HenyeyGreenstein { g } => Self::HenyeyGreenstein(HenyeyGreenstein::new(*g)),
            DeflectionLaw::Rayleigh => Self::Rayleigh(Rayleigh),
            DeflectionLaw::Table(table) => Self::Tabulated(Tabulated(table)),
        }
    }
}

impl Scatter for AnyScatter<'_> {
    const REMEMBERS: bool = true;

    #[inline(always)]
    fn scatter<S: Simd>(self, simd: S, before: Directions<S>, words: [Words<S>; 2]) -> Directions<S> {
        match self {
            Self::Isotropic(isotropic) => isotropic.scatter(simd, before, words),
            Self::HenyeyGreenstein(henyey_greenstein) => henyey_greenstein.scatter(simd, before, words),
            Self::Rayleigh(rayleigh) => rayleigh.scatter(simd, before, words),
            Self::Tabulated(tabulated) => tabulated.scatter(simd, before, words),
        }
    }
}

/// Turns directions by an angle, towards a point of the circle.
///
/// Not by a rotation but by a reflection (A. S. Householder 1958) that exchanges u with the z axis: as the
/// azimuth is uniform, handedness and zero of the azimuth are free. With s the sign of u_z and (p, q) =
/// sin θ (cos φ, sin φ):
///
/// ```text
/// d = p u_x + q u_y,   k = cos θ + d/(1 + |u_z|)
/// v = (k u_x − p, k u_y − q, cos θ u_z + s d)
/// ```
///
/// It has one division and no case for u along the axis. Lengths drift by roundings only; a Newton step towards
/// 1 undoes what this collision added.
#[inline(always)]
fn turn<S: Simd>(
    before: Directions<S>,
    (cosine, sine): Deflection<S>,
    (x, y): (Floats<S>, Floats<S>),
) -> Directions<S> {
    let Directions { x: ux, y: uy, z: uz } = before;
    let (p, q) = (sine * x, sine * y);
    let d = p.fused_mul_add(ux, q * uy);
    let k = cosine + d / (uz.abs() + 1.0);
    let (vx, vy) = (k.fused_mul_add(ux, -p), k.fused_mul_add(uy, -q));
    // s d as d with the sign of u_z put upon it
    let sign = uz.bitcast::<Words<S>>() & 0x8000_0000;
    let signed_d: Floats<S> = (d.bitcast::<Words<S>>() ^ sign).bitcast();
    let vz = cosine.fused_mul_add(uz, signed_d);

    let square = vx.fused_mul_add(vx, vy.fused_mul_add(vy, vz * vz));
    let shrink = square.fused_mul_add(-0.5, 1.5);
    Directions { x: vx * shrink, y: vy * shrink, z: vz * shrink }
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};

    use super::super::PhaseFunction;
    use super::super::deflection_table::DeflectionLaw;
    use super::*;

    /// Deflections for words that lie evenly: (cosine, sine) pairs.
    fn deflections(phase_function: &PhaseFunction, words: &[u32]) -> Vec<(f64, f64)> {
        #[inline(always)]
        fn map<S: Simd>(simd: S, law: &DeflectionLaw, words: &[u32]) -> Vec<(f64, f64)> {
            let deflect = |word| match law {
                DeflectionLaw::Isotropic => HenyeyGreenstein::new(0.0).deflection(simd, word),
                DeflectionLaw::HenyeyGreenstein { g } => HenyeyGreenstein::new(*g).deflection(simd, word),
                DeflectionLaw::Rayleigh => Rayleigh::deflection(simd, word),
                DeflectionLaw::Table(table) => Tabulated(table).deflection(simd, word),
            };
            let pairs = words.chunks_exact(16).map(|chunk| deflect(Words::from_slice(simd, chunk)));
            pairs.flat_map(|(c, s)| (0..16).map(move |i| (f64::from(c[i]), f64::from(s[i])))).collect()
        }
        let law = DeflectionLaw::new(phase_function);
        dispatch!(Level::new(), simd => map(simd, &law, words))
    }

    /// The midpoints of 2ᵏ cells.
    fn even_words(power: u32) -> Vec<u32> {
        (0..1u32 << power).map(|i| (i << (32 - power)) + (1 << (31 - power))).collect()
    }

    const ANISOTROPIES: [f64; 11] = [-0.999, -0.8, -0.3, -1e-6, 1e-30, 1e-6, 0.1, 0.5, 0.8, 0.99, 0.9999];

    #[test]
    fn henyey_greenstein_has_its_legendre_moments() {
        for g in ANISOTROPIES {
            let found = deflections(&PhaseFunction::HenyeyGreenstein { g }, &even_words(20));
            let n = found.len() as f64;
            // Of Legendre's polynomials P₁ and P₂ the means are g and g²; 1 − P₁ where g is near 1
            let first = found.iter().map(|(cosine, _)| cosine).sum::<f64>() / n;
            let second = found.iter().map(|(cosine, _)| 1.5 * cosine * cosine - 0.5).sum::<f64>() / n;
            assert!((first - g).abs() < 1e-6, "g = {g}: {first}");
            assert!((second - g * g).abs() < 2e-6, "g = {g}: {second}");
        }
    }

    /// Word by word against the textbook's inversion in double precision.
    #[test]
    fn henyey_greenstein_inverts_its_cumulative_distribution() {
        for g in [-0.9f64, -0.3, 0.1, 0.5, 0.9, 0.999] {
            let words = even_words(16);
            for (&word, (cosine, sine)) in
                words.iter().zip(deflections(&PhaseFunction::HenyeyGreenstein { g }, &words))
            {
                let xi = f64::from(word | 1) / 4294967296.0;
                let ratio = (1.0 - g * g) / (1.0 - g.abs() + 2.0 * g.abs() * xi);
                let exact = (1.0 + g * g - ratio * ratio) / (2.0 * g);
                // Five roundings of the versine, and those of ξ and of 1 − |g| + 2|g|ξ
                let bound = 1.2e-7 + 6e-7 * (1.0 - exact * g.signum());
                assert!((cosine - exact).abs() < bound, "g = {g}, {word:#x}: {cosine} {exact}");
                assert!((sine * sine + cosine * cosine - 1.0).abs() < 3e-7);
            }
        }
    }

    /// With g near 1 the deflection has its digits although the cosine has none: the mean of sin² θ is
    /// ⅔ (1 − g²).
    #[test]
    fn henyey_greenstein_keeps_small_angles() {
        for g in [0.999, 0.999_999, -0.999_999] {
            let found = deflections(&PhaseFunction::HenyeyGreenstein { g }, &even_words(20));
            // Without the rare large angles, which even words miss: medians
            let mut sines: Vec<f64> = found.iter().map(|(_, sine)| *sine).collect();
            sines.sort_by(f64::total_cmp);
            let median = sines[sines.len() / 2];
            // ξ = ½: 1 − cos θ = (1 − ½)(2 + |g|) (1 − |g|)²
            let versine = 0.5 * (2.0 + g.abs()) * (1.0 - g.abs()).powi(2);
            let exact = (versine * (2.0 - versine)).sqrt();
            assert!((median / exact - 1.0).abs() < 1e-5, "g = {g}: {median} {exact}");
        }
    }

    #[test]
    fn rayleigh_inverts_its_cumulative_distribution() {
        let words = even_words(16);
        for (&word, (cosine, sine)) in words.iter().zip(deflections(&PhaseFunction::Rayleigh, &words)) {
            let x = f64::from((word | 1).cast_signed()) / 2147483648.0;
            let exact = 2.0 * ((2.0 * x).asinh() / 3.0).sinh();
            assert!((cosine - exact).abs() < 3e-7, "{word:#x}: {cosine} {exact}");
            assert!((sine * sine + cosine * cosine - 1.0).abs() < 3e-7);
        }
    }

    #[test]
    fn deflections_are_numbers_at_every_edge() {
        let words =
            [0, 1, 2, 3, u32::MAX, u32::MAX - 1, 1 << 31, (1 << 31) - 1, 1 << 30, 7, 8, 9, 10, 11, 12, 13];
        let nearest = 1.0 - f64::EPSILON / 2.0;
        let gs = ANISOTROPIES.into_iter().chain([nearest, -nearest, f64::MIN_POSITIVE]);
        let two_term = PhaseFunction::TwoTerm { weight: 0.5, g1: 0.9999, g2: -0.9999 };
        let kinds = gs.map(|g| PhaseFunction::HenyeyGreenstein { g });
        let kinds = kinds.chain([PhaseFunction::Rayleigh, two_term]);
        for kind in kinds {
            for (cosine, sine) in deflections(&kind, &words) {
                assert!(cosine.abs() <= 1.0 && (0.0..=1.0).contains(&sine), "{kind:?}: {cosine} {sine}");
            }
        }
    }

    /// The new direction has the cosine asked for to the old one, unit length, and an azimuth that goes round
    /// once as the point on the circle does, also from the poles.
    #[test]
    fn turning_keeps_angle_and_length() {
        #[inline(always)]
        fn turned<S: Simd>(simd: S, u: [f32; 3], cosine: f32, point: [f32; 2]) -> [f64; 3] {
            let splat = |x| Floats::splat(simd, x);
            let before = Directions { x: splat(u[0]), y: splat(u[1]), z: splat(u[2]) };
            let sine = (1.0 - cosine * cosine).sqrt();
            let v = turn(before, (splat(cosine), splat(sine)), (splat(point[0]), splat(point[1])));
            [f64::from(v.x[0]), f64::from(v.y[0]), f64::from(v.z[0])]
        }
        let axis =
            std::iter::once([0.0, 0.0, 1.0f32]).chain([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, -1.0, -0.0]]);
        let oblique = (0..200).map(|i| {
            let (z, phi) = (i as f32 / 100.0 - 0.995, i as f32);
            let s = (1.0 - z * z).sqrt();
            [s * phi.cos(), s * phi.sin(), z]
        });
        for u in axis.chain(oblique) {
            for cosine in [-1.0, -0.7, 0.0, 0.3, 0.999, 1.0f32] {
                let mut sum = [0.0; 3];
                for i in 0..8 {
                    let (y, x) = (std::f32::consts::FRAC_PI_4 * i as f32).sin_cos();
                    let v = dispatch!(Level::new(), simd => turned(simd, u, cosine, [x, y]));
                    let dot: f64 = v.iter().zip(u).map(|(v, u)| v * f64::from(u)).sum();
                    let square: f64 = v.iter().map(|v| v * v).sum();
                    assert!((dot - f64::from(cosine)).abs() < 5e-7, "{u:?} {cosine}: {dot}");
                    assert!((square - 1.0).abs() < 5e-7, "{u:?} {cosine}: {square}");
                    sum.iter_mut().zip(v).for_each(|(sum, v)| *sum += v / 8.0);
                }
                // Around the circle the parts across u cancel
                for (sum, u) in sum.iter().zip(u) {
                    assert!((sum - f64::from(cosine * u)).abs() < 5e-7, "{u:?} {cosine}: {sum}");
                }
            }
        }
    }
}
