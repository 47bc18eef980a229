//! Laws of the twin, which hold for every device that has its bits.

use translucid_reference::Incidence;
use translucid_reference::exact::HalfSpace;
use translucid_reference::walk::{
    Control, Layout, Parameters, PhaseFunction, Problem, Region, Side, TableError, WhiteTable,
};
use translucid_testing::power;

use super::*;

/// Words that reach every corner: small, large, powers of two, and many between.
fn words() -> impl Iterator<Item = u32> {
    let corners = (0..4096).flat_map(|i| [i, u32::MAX - i, i << 20]);
    let powers = (0..32).flat_map(|k| [1u32 << k, (1u32 << k).wrapping_sub(1), 3 << k]);
    corners.chain(powers).chain((0..300_000u32).map(|i| i.wrapping_mul(2_654_435_769)))
}

#[test]
fn functions_are_what_they_are_called() {
    for word in words() {
        let x = f32::from_bits((word >> 1).clamp(0x0100_0000, 0x7d00_0000));
        let exact = f64::from(x);
        assert!((f64::from(reciprocal(x)) * exact - 1.0).abs() < 2.4e-7, "1/{x:e}");
        assert!((f64::from(root(x)) / exact.sqrt() - 1.0).abs() < 3.6e-7, "root of {x:e}");

        // The word of an exponential has a truncated last bit: 6e-8 of u
        let u = f64::from(word | 1) / 4_294_967_296.0;
        let (found, exact) = (f64::from(exponential(word)), -u.ln());
        assert!(
            (found - exact).abs() < 2.4e-7 * exact + 1.3e-7 && found >= 0.0,
            "{word:#x}: {found} {exact}"
        );

        let [x, y] = circle(word).map(f64::from);
        let eighth = f64::from(((word << 2) | 1).cast_signed()) / 2_147_483_648.0;
        let (sine, cosine) = (eighth * std::f64::consts::FRAC_PI_4).sin_cos();
        let sign = if word >> 31 == 1 { -1.0 } else { 1.0 };
        let [exact_x, exact_y] = if word >> 30 & 1 == 1 { [sine, cosine] } else { [cosine, sine] };
        assert!((x - sign * exact_x).abs().max((y - sign * exact_y).abs()) < 2.4e-7, "{word:#x}: {x} {y}");

        let signed = signed(word);
        let exact = (1.0 - f64::from(signed).powi(2)).sqrt();
        assert!((f64::from(complement(signed)) - exact).abs() < 3e-7 && signed.abs() < 1.0, "{word:#x}");
        assert!(unit(word) > 0.0 && unit(word) < 1.0);
    }
    assert_eq!((root(0.0), reflectance(0.1, &Interface::new(1.5))), (0.0, 1.0));
}

/// Means over words that lie evenly: −ln u and its square, and that the units' mean is ½ to the bit.
#[test]
fn numbers_have_their_moments() {
    // Evenly in the upper bits, without a pattern in the lower ones
    let words = || (0..1u32 << 20).map(|i| (i << 12) | (i.wrapping_mul(2_654_435_769) >> 20));
    let mean = |f: &dyn Fn(u32) -> f64| words().map(f).sum::<f64>() / f64::from(1 << 20);
    let u = |word: u32| f64::from(word | 1) / 4_294_967_296.0;
    for power in 1..=3 {
        let found = mean(&|word| f64::from(exponential(word)).powi(power));
        let exact = mean(&|word| (-u(word).ln()).powi(power));
        assert!((found / exact - 1.0).abs() < 3e-8 * f64::from(power), "power {power}: {found} {exact}");
    }
    assert!((mean(&|word| f64::from(unit(word))) - 0.5).abs() < 1e-7);
}

/// Each bit of seed, index and step flips half of the bits of all four words. Fixed inputs; false alarm of 6σ over
/// 160 × 128 frequencies: 4e-5.
#[test]
fn every_bit_of_seed_index_and_step_is_scattered() {
    let trials = 2000u64;
    for flipped in 0..160 {
        let mut counts = [0u64; 128];
        for trial in 0..trials {
            let (seed, index, step) = (trial, 1000 * trial + 3, (trial % 50) as u32);
            let bit =
                |from: u32| if (from..from + 64).contains(&flipped) { 1u64 << (flipped - from) } else { 0 };
            let other_step = if flipped >= 128 { step ^ 1 << (flipped - 128) } else { step };
            let one = random(walk_numbers::key(seed), index, step);
            let two = random(walk_numbers::key(seed ^ bit(0)), index ^ bit(64), other_step);
            for (place, count) in counts.iter_mut().enumerate() {
                *count += u64::from((one[place / 32] ^ two[place / 32]) >> (place % 32) & 1);
            }
        }
        for (place, count) in counts.into_iter().enumerate() {
            let z = (count as f64 - 0.5 * trials as f64) / (0.25 * trials as f64).sqrt();
            assert!(z.abs() < 6.0, "input {flipped}, output {place}: {count}");
        }
    }
}

/// Words of neighboring photons, of successive steps and of one step, as pairs of their upper 4-bit digits, of which the
/// walk is made: χ² over 256 cells. 3 × 4 × 4 × 4 × 6 statistics, each beyond 6σ with 4e-8: false alarm 5e-5.
#[test]
fn neighbors_steps_and_words_are_independent() {
    let (photons, key) = (1u64 << 16, walk_numbers::key(9));
    for step in 0..4u32 {
        let mut counts = vec![[0u64; 256]; 3 * 4 * 4 * 6];
        for index in 0..photons {
            let one = random(key, index, step);
            let others = [random(key, index + 1, step), random(key, index, step + 1), one];
            for (kind, other) in others.iter().enumerate() {
                for (a, b) in
                    (0..4).flat_map(|a| (0..4).map(move |b| (a, b))).filter(|(a, b)| kind < 2 || a < b)
                {
                    for digit in 0..6 {
                        let cut = |word: u32| (word >> (28 - 4 * digit) & 15) as usize;
                        counts[((kind * 4 + a) * 4 + b) * 6 + digit][16 * cut(one[a]) + cut(other[b])] += 1;
                    }
                }
            }
        }
        for cells in counts.iter().filter(|cells| cells.iter().any(|count| *count > 0)) {
            let expected = photons as f64 / 256.0;
            let chi2: f64 = cells.iter().map(|&count| (count as f64 - expected).powi(2) / expected).sum();
            let z = (chi2 - 255.0) / (2.0f64 * 255.0).sqrt();
            assert!(z.abs() < 6.0, "step {step}: χ² = {chi2}");
        }
    }
}

pub(crate) const RADII: [f64; 6] = [0.03, 0.2, 0.6, 1.5, 4.0, 9.0];

/// A table that a device walked.
pub(crate) fn table(
    parameters: Parameters,
    albedo: f64,
    seed: u64,
    photons: u64,
    device: Option<&dyn Device>,
) -> WhiteTable {
    let layout = Layout::new(&RADII, 3).unwrap();
    let mut table = WhiteTable::new(Problem::new(parameters).unwrap(), layout, albedo).unwrap();
    table.run(seed, photons, &Control { device, ..Control::default() }).unwrap();
    table
}

/// Points across rings as narrow as are allowed, at all magnitudes: each is in the ring of its exact place.
#[test]
fn rings_are_as_narrow_as_their_radii_say() {
    for radius in [1e-12, 0.03, 1.0, 999.0, 4e4, 1e12] {
        let radii: Vec<f64> = (0..8).map(|i| radius * (1.0 + 1.1e-6 * f64::from(i))).collect();
        let layout = Layout::new(&radii, 1).unwrap();
        let problem = Problem::new(Parameters::default()).unwrap();
        let walk = DeviceWalk { problem: &problem, layout: &layout, reference_albedo: 0.9, seed: 0 };
        let numbers = WalkNumbers::new(&walk).unwrap();
        for i in 0..20_000u32 {
            let (r, angle) = (radius * (1.0 + 5e-10 * f64::from(i)), 0.37 * f64::from(i));
            let (sine, cosine) = libm::sincos(angle);
            let place = [(r * cosine) as f32, (r * sine) as f32];
            let mut tally =
                DeviceTally { exits: vec![(0, 0); numbers.bins.cells()], ..DeviceTally::default() };
            numbers.count(place, 0, false, &mut tally);
            let [x, y] = place.map(f64::from);
            let ring = |shift: f64| {
                let square = (x * x + y * y) * (1.0 + shift);
                radii.iter().filter(|radius| *radius * *radius <= square).count()
            };
            let found = tally.exits.iter().position(|cell| cell.0 == 1).unwrap() / layout.order_bins().len();
            assert!(found == ring(-1e-10) || found == ring(1e-10), "{radius} {i}: {found} {}", ring(0.0));
        }
    }
    // Squares that overflow are beyond all radii
    let walk = Parameters { spot_radius: 1e30, ..Parameters::default() };
    assert_eq!(table(walk, 0.5, 1, 100, Some(&Twin)).exits(Side::Reflected, Region::Within(5)), 0);
}

/// 448 figures against the exact solution: four indices, light at the normal and from everywhere, eight albedos from one
/// walk, total and energies within six radii. |z| < 5, false alarm 3e-4 in all; less than 100 photons in effect say
/// nothing of their own error.
pub(crate) fn check_against_the_exact_solution(device: &dyn Device, photons: u64) {
    let mut figures = 0;
    for eta in [1.0, 0.75, 1.33, 1.5] {
        for incidence in [Incidence::NORMAL, Incidence::Cosine] {
            let table = table(
                Parameters { eta, incidence, ..Parameters::default() },
                0.999,
                7,
                photons,
                Some(device),
            );
            for albedo in [0.2, 0.5, 0.7, 0.8, 0.9, 0.95, 0.99, 0.999] {
                let exact = HalfSpace::with_boundary(albedo, eta, incidence).unwrap();
                let at = table.at_albedo(albedo).unwrap();
                let within = |index: usize| (Region::Within(index), exact.enclosed(RADII[index]));
                for (region, exact) in (0..6).map(within).chain([(Region::Everywhere, exact.total())]) {
                    let found = match region {
                        Region::Within(index) => at.enclosed(Side::Reflected, index),
                        _ => at.total(Side::Reflected),
                    };
                    figures += 1;
                    if at.effective_photons(Side::Reflected, region) > 100.0 {
                        let z = (found.value - exact.value) / found.error;
                        assert!(z.abs() < 5.0, "η {eta}, {incidence:?}, α {albedo}, {region:?}: z = {z}");
                    }
                }
            }
        }
    }
    assert_eq!(figures, 448);
}

#[test]
fn totals_and_profiles_are_those_of_the_exact_solution() {
    check_against_the_exact_solution(&Twin, power(160_000));
}

/// Cases that the exact solution has not: phase functions, slabs, tilted beams, spots.
pub(crate) fn cases() -> Vec<(Parameters, f64)> {
    let hg = |g| PhaseFunction::HenyeyGreenstein { g };
    let base = Parameters::default();
    let tilted = Incidence::Pencil { cos_theta: 0.3 };
    vec![
        (Parameters { phase_function: hg(0.8), incidence: tilted, ..base.clone() }, 0.99),
        (
            Parameters {
                phase_function: hg(-0.6),
                eta: 1.4,
                incidence: Incidence::UniformCosine,
                ..base.clone()
            },
            0.95,
        ),
        (
            Parameters {
                phase_function: hg(0.9),
                eta: 1.5,
                thickness: 3.0,
                spot_radius: 0.5,
                ..base.clone()
            },
            0.99,
        ),
        (
            Parameters { phase_function: PhaseFunction::Rayleigh, eta: 0.8, thickness: 0.02, ..base.clone() },
            0.9,
        ),
        (
            Parameters {
                phase_function: PhaseFunction::Rayleigh,
                incidence: Incidence::Cosine,
                ..base.clone()
            },
            0.98,
        ),
        (Parameters { eta: 1.5, thickness: 0.5, incidence: Incidence::Cosine, ..base.clone() }, 0.9),
        (Parameters { eta: 3.0, thickness: 20.0, incidence: tilted, ..base.clone() }, 0.999),
        (Parameters { thickness: 1.0, incidence: tilted, spot_radius: 2.0, ..base.clone() }, 0.5),
    ]
}

/// Against the processor's walk, which shares no line with it: 8 cases, both faces, totals and 21 sectors. |z| < 5,
/// false alarm 2e-4.
#[test]
fn other_media_are_those_of_the_processors_walk() {
    let photons = power(200_000);
    for (parameters, albedo) in cases() {
        let [one, other] = [Some(&Twin as &dyn Device), None]
            .map(|device| table(parameters.clone(), albedo, 3, photons, device));
        let faces = if parameters.thickness.is_finite() { 2 } else { 1 };
        for side in [Side::Reflected, Side::Transmitted].into_iter().take(faces) {
            let sectors = (0..7).flat_map(|ring| (0..3).map(move |sector| Region::Sector { ring, sector }));
            for region in sectors.chain([Region::Everywhere]) {
                let [a, b] = [&one, &other].map(|table| table.exits(side, region) as f64);
                if a + b > 50.0 {
                    let p = (a + b) / (2 * photons) as f64;
                    let z = (a - b) / ((a + b) * (1.0 - p)).sqrt();
                    assert!(z.abs() < 5.0, "{parameters:?} {side:?} {region:?}: {a} {b}");
                }
            }
        }
        let [a, b] = [&one, &other].map(WhiteTable::mean_collisions);
        let spread = a / (photons as f64).sqrt();
        assert!((a - b).abs() < 12.0 * spread, "{parameters:?}: {a} {b} collisions");
    }
}

/// Tables of devices are made, kept, joined and refused as those of the processor are.
#[test]
fn tables_of_devices_are_tables() {
    let control = Control { device: Some(&Twin), ..Control::default() };
    let whole = table(Parameters::default(), 0.9, 5, 3000, Some(&Twin));
    let mut parts = table(Parameters::default(), 0.9, 5, 1000, Some(&Twin));
    assert_eq!(parts.run(5, 2000, &control).unwrap(), 2000);
    assert!(parts == whole);

    let mut bytes = Vec::new();
    whole.write(&mut bytes).unwrap();
    let read = WhiteTable::read(&*bytes, "walk.npz".as_ref()).unwrap();
    assert!(read == whole);

    let refused = |result: Result<u64, TableError>| result.unwrap_err().to_string();
    let expected = |held, more| {
        format!(
            "the photons of the table were walked by a {held}, and those of a {more} are not added to them"
        )
    };
    assert_eq!(refused(parts.run(5, 1, &Control::default())), expected("device", "processor"));
    let mut other = table(Parameters::default(), 0.9, 6, 10, None);
    assert_eq!(refused(other.run(6, 1, &control)), expected("processor", "device"));
    let error = other.merge(&whole).unwrap_err().to_string();
    assert_eq!(
        error,
        "the tables differ in the kind of machine that walked: processor in one, device in the other"
    );
}

#[test]
fn what_single_precision_does_not_do_is_refused() {
    let hg = |g| PhaseFunction::HenyeyGreenstein { g };
    let base = Parameters::default();
    for (parameters, radii, expected) in [
        (
            Parameters { eta: 1.5, thickness: 0.001, ..base.clone() },
            vec![1.0],
            "thickness of the slab is 0.001",
        ),
        (Parameters { phase_function: hg(-0.99999), ..base.clone() }, vec![1.0], "g is -0.99999"),
        (
            Parameters { phase_function: PhaseFunction::Moments([0.1].into()), ..base.clone() },
            vec![1.0],
            "the phase function is moments, but a device walks with",
        ),
        (base.clone(), vec![1.0, 1.0000001], "too close"),
    ] {
        let problem = Problem::new(parameters).unwrap();
        let mut table = WhiteTable::new(problem, Layout::new(&radii, 1).unwrap(), 0.9).unwrap();
        let error = table.run(1, 10, &Control { device: Some(&Twin), ..Control::default() }).unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
        assert_eq!(table.photons(), 0);
    }
    // Without a boundary no slab is too thin, and no light is lost
    let table = table(Parameters { thickness: 1e-30, ..base.clone() }, 0.9, 1, 100, Some(&Twin));
    let through = table.at_albedo(0.9).unwrap().total(Side::Transmitted);
    assert_eq!(through.value, 1.0);
}
