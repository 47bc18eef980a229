//! Random numbers of a walk: well distributed at first, then independent.

use translucid_profile::split_mix::{STEP, split_mix};

use crate::sampling::Sampler;

/// Random numbers, four at a time: those of the sampler for the first collisions, on which pictures depend most, then
/// S. Vigna's SplitMix64, for walks have no greatest length.
pub(crate) struct WalkRandom {
    /// Sets that are left to take from the sampler.
    stratified: u32,
    state: u64,
}

impl WalkRandom {
    /// Numbers of a walk that takes so many sets from the sampler.
    pub(crate) fn new(sampler: &Sampler, stratified: u32) -> Self {
        Self { stratified, state: sampler.fork() }
    }

    /// The next four numbers in [0, 1), of the same sampler.
    pub(crate) fn next_4d(&mut self, sampler: &mut Sampler) -> [f32; 4] {
        if self.stratified > 0 {
            self.stratified -= 1;
            return sampler.next_4d();
        }
        let (first, second) = (self.next_u64(), self.next_u64());
        [unit(first), unit(first >> 32), unit(second), unit(second >> 32)]
    }

    /// One more number, independent of all others.
    pub(crate) fn next_1d(&mut self) -> f32 {
        unit(self.next_u64())
    }

    fn next_u64(&mut self) -> u64 {
        let bits = split_mix(self.state);
        self.state = self.state.wrapping_add(STEP);
        bits
    }
}

/// A number in [0, 1) from the lowest 24 bits: single precision holds no more there.
fn unit(bits: u64) -> f32 {
    (bits & 0xff_ffff) as f32 * (1.0 / 16_777_216.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_repeat_and_are_even() {
        let draw = |index: u32| {
            let mut sampler = Sampler::new(3, 1, 2, index);
            let mut random = WalkRandom::new(&sampler, 5);
            (0..40).map(|_| random.next_4d(&mut sampler)).collect::<Vec<_>>()
        };
        assert_eq!(draw(7), draw(7));
        assert_ne!(draw(7)[30], draw(8)[30]);
        // 4·35·200 independent numbers; five standard errors
        let late: Vec<f32> = (0..200).flat_map(|index| draw(index).split_off(5)).flatten().collect();
        let mean = late.iter().map(|x| f64::from(*x)).sum::<f64>() / late.len() as f64;
        let allowed = 5.0 / (12.0 * late.len() as f64).sqrt();
        assert!((mean - 0.5).abs() < allowed, "{mean}");
        assert!(late.iter().all(|x| (0.0..1.0).contains(x)));
    }
}
