//! Functions of complex numbers.
//!
//! Those of `num-complex` are made of the platform's real ones, whose last digit depends on the platform. These are less
//! careful of overflow, faster, and have the same bits everywhere.

use num_complex::Complex64;

/// r e^{iθ}.
pub(crate) fn from_polar(r: f64, theta: f64) -> Complex64 {
    let (sine, cosine) = libm::sincos(theta);
    Complex64::new(r * cosine, r * sine)
}

/// |z|.
pub(crate) fn norm(z: Complex64) -> f64 {
    libm::hypot(z.re, z.im)
}

/// e^z.
pub(crate) fn exp(z: Complex64) -> Complex64 {
    from_polar(libm::exp(z.re), z.im)
}

/// √z in the right half plane.
pub(crate) fn sqrt(z: Complex64) -> Complex64 {
    let larger = (0.5 * (z.norm_sqr().sqrt() + z.re.abs())).sqrt();
    if larger == 0.0 {
        return Complex64::ZERO;
    }
    let smaller = 0.5 * z.im / larger;
    if z.re >= 0.0 {
        Complex64::new(larger, smaller)
    } else {
        Complex64::new(smaller.abs(), larger.copysign(z.im))
    }
}

/// ln z.
pub(crate) fn ln(z: Complex64) -> Complex64 {
    Complex64::new(0.5 * libm::log(z.norm_sqr()), libm::atan2(z.im, z.re))
}

/// ln(1 + z), with every digit for small z.
pub(crate) fn ln_1p(z: Complex64) -> Complex64 {
    let square_excess = 2.0 * z.re + z.norm_sqr();
    let modulus =
        if square_excess.abs() < 0.5 { libm::log1p(square_excess) } else { libm::log((1.0 + z).norm_sqr()) };
    Complex64::new(0.5 * modulus, libm::atan2(z.im, 1.0 + z.re))
}

/// e^z − 1, with every digit for small z.
pub(crate) fn exp_m1(z: Complex64) -> Complex64 {
    // e^x cos y − 1 = (e^x − 1) cos y − (1 − cos y)
    let growth = libm::expm1(z.re);
    let (sine, cosine) = libm::sincos(z.im);
    let versine = if cosine > 0.0 { sine * sine / (1.0 + cosine) } else { 1.0 - cosine };
    Complex64::new(growth * cosine - versine, (growth + 1.0) * sine)
}

/// asinh z, Re asinh having the sign of Re z.
///
/// Its cuts lie on the imaginary axis, beyond ±i, where a quadrature's poles are as far from the real axis as they can be.
pub(crate) fn asinh(z: Complex64) -> Complex64 {
    // ln(z + √(z² + 1)); for Re z < 0 the mirror image avoids cancellation
    let root = sqrt(z * z + 1.0);
    if z.re >= 0.0 { ln(z + root) } else { -ln(root - z) }
}

/// sinh z and cosh z.
pub(crate) fn sinh_cosh(z: Complex64) -> (Complex64, Complex64) {
    let (sinh, cosh) = (libm::sinh(z.re), libm::cosh(z.re));
    let (sine, cosine) = libm::sincos(z.im);
    (Complex64::new(sinh * cosine, cosh * sine), Complex64::new(cosh * cosine, sinh * sine))
}

/// arctan z.
pub(crate) fn atan(z: Complex64) -> Complex64 {
    let turned = Complex64::I * z;
    (ln_1p(turned) - ln_1p(-turned)) / (2.0 * Complex64::I)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The platform's functions, at magnitudes from 1e-5 to 1e2.
    #[test]
    fn functions_agree_with_the_platform() {
        type Pair = (fn(Complex64) -> Complex64, fn(Complex64) -> Complex64);
        let pairs: [Pair; 7] = [
            (exp, Complex64::exp),
            (sqrt, Complex64::sqrt),
            (ln, Complex64::ln),
            (asinh, Complex64::asinh),
            (atan, Complex64::atan),
            (|z| sinh_cosh(z).0, Complex64::sinh),
            (|z| sinh_cosh(z).1, Complex64::cosh),
        ];
        for i in -20..=8 {
            for j in -5..=5 {
                let z = Complex64::from_polar(10f64.powf(0.25 * f64::from(i)), 0.3 * f64::from(j));
                for (number, (own, of_platform)) in pairs.iter().enumerate() {
                    let expected = of_platform(z);
                    let off = (own(z) - expected).norm();
                    // The platform's asinh and atan lose digits near 0
                    let allowed = 4e-15 + if (3..=4).contains(&number) { 1e-15 / z.norm() } else { 0.0 };
                    assert!(off <= allowed * expected.norm(), "function {number} of {z}: {off:e}");
                }
                assert!((norm(z) / z.norm() - 1.0).abs() < 1e-15);
                assert!((from_polar(norm(z), z.arg()) / z - 1.0).norm() < 1e-15);
            }
        }
    }

    #[test]
    fn elementary_functions_keep_their_digits() {
        for i in -60..=4 {
            for j in -10..=10 {
                let z = Complex64::from_polar(10f64.powf(0.25 * f64::from(i)), 0.3 * f64::from(j));
                assert!((sqrt(z) * sqrt(z) / z - 1.0).norm() < 1e-15 && sqrt(z).re >= 0.0);
                assert!((ln(z).exp() / z - 1.0).norm() < 1e-13);
                assert!((exp_m1(ln_1p(z)) / z - 1.0).norm() < 2e-15, "{z}");
            }
        }
        assert_eq!(sqrt(Complex64::ZERO), Complex64::ZERO);
    }
}
