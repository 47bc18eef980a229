//! Free flights of light whose three channels have different mean free paths.
//!
//! A flight's length is drawn from one channel, chosen in proportion to the throughput T, and weighted with the balance
//! heuristic over all three [Veach & Guibas 1995]. Its density is Σ_k T_k p_k / Σ_k T_k, so the throughput becomes
//!
//! ```text
//! T_c ← (Σ_k T_k) T_c p_c / Σ_k T_k p_k,      p = σ e^{−σt} for a collision, e^{−σd} for a flight past d
//! ```
//!
//! and the sum Σ T_c does not change: no order of flights makes a weight larger than that of all light that entered.
//! T is proportional to the probability that light which came this way is of each channel. So the mixture over a whole path
//! equals choosing one channel for it at the start.

use std::hint::select_unpredictable;

use glam::Vec3;

use super::attenuation::{attenuations, depth_reached};

/// Length of flights toward lights over that of the walk's own.
///
/// More of them get out, with a smaller weight: error times CPU time are 0.94 on the head and 0.99 on the dragon of those
/// with 1 (`benches/peers/programs.py`). Without end every collision would cost a ray.
pub(super) const STRETCH: f32 = 2.0;

/// Length of first flights for a sampled light over that of the walk's own: the light has as long a way again.
pub(super) const FIRST_STRETCH: f32 = 0.5;

/// Extinction coefficients per channel \[L⁻¹\], 0 in channels whose throughput is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flights {
    sigma_t: Vec3,
}

impl Flights {
    pub(crate) fn new(sigma_t: Vec3) -> Self {
        Self { sigma_t }
    }

    pub(crate) fn sigma_t(&self) -> Vec3 {
        self.sigma_t
    }

    /// Length of a flight for a number uniform in [0, 1); infinite if nothing is left to fly.
    pub(crate) fn sample(&self, throughput: Vec3, u: f32) -> f32 {
        // Without branches, which a processor could not foresee
        let [x, y, z] = throughput.to_array();
        let (u, [of_x, of_y, of_z]) = (u * (x + y + z), self.sigma_t.to_array());
        let (is_x, is_y) = (u < x, u < x + y);
        let one_of = |x, y, z| select_unpredictable(is_x, x, select_unpredictable(is_y, y, z));
        let rest = (u - one_of(0.0, x, x + y)) / one_of(x, y, z);
        let length = depth_reached(rest.min(1.0 - f32::EPSILON)) / one_of(of_x, of_y, of_z);
        if length.is_nan() { f32::INFINITY } else { length }
    }

    /// Throughput after a collision at the end of a flight.
    pub(crate) fn collide(&self, throughput: Vec3, length: f32) -> Vec3 {
        reweigh(throughput, self.attenuation(throughput, length) * self.sigma_t)
    }

    /// Throughput after a flight past a distance.
    pub(crate) fn pass(&self, throughput: Vec3, distance: f32) -> Vec3 {
        reweigh(throughput, self.attenuation(throughput, distance))
    }

    /// Throughput after a collision at the end of a flight that was drawn from stretched flights.
    pub(crate) fn collide_stretched(&self, drawn: &Self, throughput: Vec3, length: f32) -> Vec3 {
        let (depth, of_drawn) = (self.sigma_t * length, drawn.sigma_t * length);
        let least = Vec3::select(throughput.cmpgt(Vec3::ZERO), of_drawn, Vec3::INFINITY).min_element();
        let density =
            (throughput * attenuations((of_drawn - least).max(Vec3::ZERO)) * drawn.sigma_t).element_sum();
        let collided =
            throughput * (least - depth).exp() * self.sigma_t * (throughput.element_sum() / density);
        if collided.is_finite() { collided } else { Vec3::ZERO }
    }

    /// Throughput of a flight past a distance.
    pub(crate) fn transmit(&self, throughput: Vec3, distance: f32) -> Vec3 {
        throughput * (-self.sigma_t * distance.min(f32::MAX)).exp()
    }

    /// Flights that are longer by a factor on average.
    pub(crate) fn stretched(&self, factor: f32) -> Self {
        Self { sigma_t: self.sigma_t / factor }
    }

    /// Throughput after a flight past a distance that was drawn from stretched flights: of more that come so far each
    /// counts less.
    pub(crate) fn pass_stretched(&self, drawn: &Self, throughput: Vec3, distance: f32) -> Vec3 {
        drawn.pass(throughput, distance)
            * attenuations((self.sigma_t - drawn.sigma_t).max(Vec3::ZERO) * distance.min(f32::MAX))
    }

    /// e^{−σt}, up to a factor that all channels share: that of the channel that comes farthest is 1.
    fn attenuation(&self, throughput: Vec3, length: f32) -> Vec3 {
        let depth = self.sigma_t * length;
        let lit = throughput.cmpgt(Vec3::ZERO);
        let least = Vec3::select(lit, depth, Vec3::INFINITY).min_element();
        attenuations((depth - least).max(Vec3::ZERO))
    }
}

/// The throughput times densities, with the sum it had.
fn reweigh(throughput: Vec3, density: Vec3) -> Vec3 {
    let weighted = throughput * density;
    let scale = throughput.element_sum() / weighted.element_sum();
    if scale.is_finite() { weighted * scale } else { Vec3::ZERO }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Over many flights the mean throughput past a distance is e^{−σd} of each channel, that of collisions the rest.
    #[test]
    fn flights_are_those_of_each_channel() {
        let (sigma, start, distance) = (Vec3::new(0.5, 2.0, 9.0), Vec3::new(1.0, 0.3, 0.7), 0.4);
        let flights = Flights::new(sigma);
        let (mut past, mut collided) = (Vec3::ZERO, Vec3::ZERO);
        let n = 1 << 16;
        for i in 0..n {
            let u = sobol_burley::sample_4d(i, 0, 5);
            let length = flights.sample(start, u[0]);
            let after = if length < distance {
                flights.collide(start, length)
            } else {
                flights.pass(start, distance)
            };
            assert!((after.element_sum() - start.element_sum()).abs() < 1e-5);
            if length < distance { collided += after } else { past += after }
        }
        let expected = start * (-sigma * distance).exp();
        let close = |found: Vec3, expected: Vec3| (found / n as f32 - expected).abs().max_element() < 2e-3;
        assert!(close(past, expected), "{past} {expected}");
        assert!(close(collided, start - expected), "{collided}");
    }

    /// Drawn shorter, collisions before a distance have the same mean throughput.
    #[test]
    fn collisions_of_stretched_flights_bring_the_same() {
        let (sigma, start, distance) = (Vec3::new(0.5, 2.0, 9.0), Vec3::new(1.0, 0.3, 0.7), 0.4);
        let flights = Flights::new(sigma);
        let drawn = flights.stretched(0.5);
        let mut collided = Vec3::ZERO;
        let n = 1 << 16;
        for i in 0..n {
            let length = drawn.sample(start, sobol_burley::sample(i, 0, 5));
            if length < distance {
                collided += flights.collide_stretched(&drawn, start, length);
            }
        }
        let expected = start * (1.0 - (-sigma * distance).exp());
        assert!((collided / n as f32 - expected).abs().max_element() < 2e-3, "{collided} {expected}");
    }

    /// Longer flights have the same mean throughput past a distance, and less variance.
    #[test]
    fn stretched_flights_bring_the_same() {
        let (sigma, start, distance) = (Vec3::new(0.5, 2.0, 9.0), Vec3::new(1.0, 0.3, 0.7), 0.8);
        let flights = Flights::new(sigma);
        let stretched = flights.stretched(3.0);
        let mut past = Vec3::ZERO;
        let n = 1 << 16;
        for i in 0..n {
            if stretched.sample(start, sobol_burley::sample(i, 0, 5)) >= distance {
                let after = flights.pass_stretched(&stretched, start, distance);
                assert!(after.element_sum() <= start.element_sum());
                past += after;
            }
        }
        let expected = start * (-sigma * distance).exp();
        assert!((past / n as f32 - expected).abs().max_element() < 2e-3, "{past} {expected}");
    }

    #[test]
    fn extremes_stay_finite() {
        for sigma in [Vec3::new(1e-30, 1.0, 1e30), Vec3::ZERO, Vec3::new(0.0, 1e-38, 1.0)] {
            let flights = Flights::new(sigma);
            for throughput in [Vec3::ONE, Vec3::new(1e-38, 0.0, 1.0), Vec3::new(0.0, 0.0, 1e-30)] {
                for length in [0.0, 1e-30, 1.0, 1e30, f32::INFINITY] {
                    let stretched = flights.stretched(2.0);
                    let all = [
                        flights.collide(throughput, length),
                        flights.pass(throughput, length),
                        flights.pass_stretched(&stretched, throughput, length),
                        flights.collide_stretched(&flights.stretched(0.5), throughput, length),
                        flights.transmit(throughput, length),
                    ];
                    assert!(
                        all.iter().all(|t| t.is_finite() && t.min_element() >= 0.0),
                        "{sigma} {length}: {all:?}"
                    );
                }
                assert!(flights.sample(throughput, 0.999) >= 0.0);
            }
        }
    }
}
