//! Deflection at a collision, in 16 lanes.

use fearless_simd::Simd;
use fearless_simd::prelude::*;

use super::PhaseFunction;
use super::lanes::{Floats, Words, circle, complement, polynomial, signed, unit};

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
    /// Whether the new direction depends on the old one.
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
        let f = start.mul_add(square + 3.0, x * -4.0);
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
    let d = p.mul_add(ux, q * uy);
    let k = cosine + d / (uz.abs() + 1.0);
    let (vx, vy) = (k.mul_add(ux, -p), k.mul_add(uy, -q));
    // s d as d with the sign of u_z put upon it
    let sign = uz.bitcast::<Words<S>>() & 0x8000_0000;
    let signed_d: Floats<S> = (d.bitcast::<Words<S>>() ^ sign).bitcast();
    let vz = cosine.mul_add(uz, signed_d);

    let square = vx.mul_add(vx, vy.mul_add(vy, vz * vz));
    let shrink = square.mul_add(-0.5, 1.5);
    Directions { x: vx * shrink, y: vy * shrink, z: vz * shrink }
}

/// Runs a generic function with the type that stands for a phase function.
pub(crate) trait WithScatter {
    /// What comes out.
    type Output;
    /// Runs with it.
    fn run<P: Scatter>(self, scatter: P) -> Self::Output;
}

/// Picks the type for a phase function; g = 0 is isotropic, whatever its name.
pub(crate) fn with_scatter<W: WithScatter>(phase_function: PhaseFunction, with: W) -> W::Output {
    match phase_function {
        PhaseFunction::HenyeyGreenstein { g } if g == 0.0 => with.run(Isotropic),
        PhaseFunction::HenyeyGreenstein { g } => with.run(HenyeyGreenstein::new(g)),
        PhaseFunction::Rayleigh => with.run(Rayleigh),
    }
}
