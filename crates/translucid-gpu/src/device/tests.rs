//! A device against the twin: `TRANSLUCID_DEVICE` names it, else it is the first that the system has, of any kind.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use translucid_reference::walk::{Control, Layout, Parameters, PhotonRange, Problem, WhiteTable};

use super::*;
use crate::twin::Twin;
use crate::twin::laws::{RADII, cases, check_against_the_exact_solution, table};

fn open() -> Gpu {
    let first =
        || devices().into_iter().next().expect("a device: on a machine without one, Mesa's llvmpipe").name;
    Gpu::open(&std::env::var("TRANSLUCID_DEVICE").unwrap_or_else(|_| first())).unwrap()
}

fn gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(open)
}

fn all_cases() -> Vec<(Parameters, f64)> {
    let mut cases = cases();
    cases.push((Parameters::default(), 0.9));
    cases.push((Parameters { eta: 1.33, ..Parameters::default() }, 0.999));
    cases
}

#[test]
fn a_device_has_the_bits_of_the_twin() {
    for (parameters, albedo) in all_cases() {
        let [found, expected] = [gpu() as &dyn Device, &Twin].map(|device| {
            table(
                parameters.clone(),
                albedo,
                0xfedc_ba98_7654_3210,
                translucid_testing::power(400_000),
                Some(device),
            )
        });
        // Tables print long
        assert!(
            found == expected,
            "{parameters:?} on {}: {} {} collisions",
            gpu().name(),
            found.mean_collisions(),
            expected.mean_collisions()
        );
    }
}

#[test]
fn shares_of_work_have_no_part_in_the_bits() {
    let (parameters, albedo) = cases().swap_remove(2);
    let expected = table(parameters.clone(), albedo, 1, 5000, Some(&Twin));
    for (slots, group, steps) in
        [(1, 1, 4096), (7, 64, 1), (64, 32, 3), (4096, 256, 50), (u32::MAX, u32::MAX, u32::MAX)]
    {
        let gpu = open().with_shares(slots.min(1 << 20), group, steps);
        let found = table(
            parameters.clone(),
            albedo,
            1,
            if slots == 1 || steps == 1 { 300 } else { 5000 },
            Some(&gpu),
        );
        if found.photons() == expected.photons() {
            assert!(found == expected, "{slots} {group} {steps}");
        } else {
            assert!(
                found == table(parameters.clone(), albedo, 1, 300, Some(&Twin)),
                "{slots} {group} {steps}"
            );
        }
    }
}

/// Indices beyond 32 bits, a range cut in two, and a stop: what was launched is the first of the range.
#[test]
fn ranges_join_and_stops_leave_the_first_photons() {
    let empty = || {
        let layout = Layout::new(&RADII, 3).unwrap();
        WhiteTable::new(Problem::new(Parameters::default()).unwrap(), layout, 0.99).unwrap()
    };
    let range = |start: u64, end: u64| PhotonRange {
        seed: 2,
        start: (7 << 32) - 500 + start,
        end: (7 << 32) - 500 + end,
    };
    let control = |device| Control { device: Some(device), ..Control::default() };
    let mut expected = empty();
    expected.run_range(range(0, 2000), &control(&Twin)).unwrap();
    let mut parts = empty();
    parts.run_range(range(1200, 2000), &control(gpu())).unwrap();
    parts.run_range(range(0, 1200), &control(gpu())).unwrap();
    assert!(parts == expected);

    let (stop, calls) = (AtomicBool::new(false), AtomicBool::new(false));
    let progress = |done: u64| {
        calls.store(true, Ordering::Relaxed);
        stop.store(done > 0, Ordering::Relaxed);
    };
    let small = open().with_shares(64, 64, 16);
    let mut stopped = empty();
    let launched = stopped
        .run(
            2,
            1 << 40,
            &Control { stop: &stop, progress: &progress, device: Some(&small), ..Control::default() },
        )
        .unwrap();
    assert!(launched > 0 && launched < 1 << 20 && calls.load(Ordering::Relaxed), "{launched}");
    let mut twin = empty();
    twin.run(2, launched, &control(&Twin)).unwrap();
    assert!(stopped == twin);
}

#[test]
fn totals_and_profiles_are_those_of_the_exact_solution() {
    check_against_the_exact_solution(gpu(), translucid_testing::power(2_000_000));
}

#[test]
fn devices_that_are_not_there_are_named_with_those_that_are() {
    let error = Gpu::open("no such thing").unwrap_err();
    assert!(error.starts_with("there is no device \"no such thing\", but: "), "{error}");
    assert!(error.contains(gpu().name()), "{error}");
}
