//! Any bytes as a file of MCML's: what is accepted can be walked and written, without a panic or a flood of memory.
#![no_main]

use translucid_reference::mcml::parse_mci;
use translucid_reference::walk::Control;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Ok(runs) = parse_mci(bytes) else { return };
    for mut run in runs.into_iter().take(2) {
        assert!(run.layers().is_ok());
        // A few photons in a few cells take no time; thick layers without absorption would
        let grid = run.nr * (run.nz + 2 * run.na);
        run.photons = run.photons.min(4);
        if grid < 10_000 && run.layers.len() < 20 && run.layers.iter().all(|layer| layer.mua > 0.01 * layer.mus) {
            if let Ok(result) = run.walk(1, &Control::default()) {
                assert!(result.figures().all(|figure| figure.density.value.is_finite()));
                assert!(result.text().starts_with("A1"));
            }
        }
    }
});
