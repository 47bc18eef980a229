//! Any bytes as a table of reflectance profiles: what is accepted can be evaluated and sampled.
#![no_main]

use std::path::Path;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Ok(profiles) = translucid_load::parse_profile_table(bytes, Path::new("input.csv")) else { return };
    let table = profiles.table().expect("what is accepted can be tabulated");
    for (surface_albedo, u) in [(0.0, 0.0), (0.3, 0.5), (1.0, 1.0)] {
        let profile = table.at(surface_albedo, 1.0);
        let r = profile.sample(u);
        assert!(r.is_finite() && profile.eval(r).is_finite() && profile.enclosed(r).is_finite());
    }
});
