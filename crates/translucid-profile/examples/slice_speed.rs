//! Nanoseconds that slice functions of the default profile take for each of 10⁷ numbers, into memory that is there and
//! into memory that is asked for: `benches/python/speed.py` compares the Python module with them.

use std::time::Instant;

use translucid_profile::{Appearance, Configuration, Model, ParameterError, Parameterization, Quantity};

const COUNT: usize = 10_000_000;
const REPETITIONS: usize = 9;

#[expect(clippy::print_stdout, reason = "what it is for")]
fn main() -> Result<(), ParameterError> {
    let appearance =
        Appearance { surface_albedo: 0.5, length: 1.0, parameterization: Parameterization::Mfp, g: 0.0 };
    // The numbers of speed.py
    let fractions: Vec<f64> = (0..COUNT).map(|i| (i as f64 * 0.618_033_988_749_894_9).fract()).collect();
    let radii: Vec<f64> = fractions.iter().map(|u| 10.0 * u).collect();
    let mut out = vec![0.0; COUNT];
    for model in [Model::NormalizedDiffusionRefined, Model::NormalizedDiffusion] {
        let profile = model.profile(&appearance, Configuration::Diffuse, 1.0)?;
        for (name, quantity, from) in
            [("eval", Quantity::Eval, &radii), ("sample", Quantity::Sample, &fractions)]
        {
            let there = best(|| profile.apply(quantity, from, &mut out));
            let fresh = best(|| {
                let mut fresh = vec![0.0; COUNT];
                profile.apply(quantity, from, &mut fresh);
                std::hint::black_box(&fresh);
            });
            println!("{model} {name} {there} {fresh}");
        }
    }
    Ok(())
}

/// The shortest of some times, in nanoseconds for each number.
fn best(mut work: impl FnMut()) -> f64 {
    let time = |_| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64()
    };
    1e9 / COUNT as f64 * (0..REPETITIONS).map(time).fold(f64::INFINITY, f64::min)
}
