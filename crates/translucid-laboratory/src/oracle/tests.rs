//! Every table against something that shares no code with how it was made.
//!
//! Seeds are fixed. Photons count as right within 4.5 standard errors: false-alarm rate 7e-6 a comparison, below 1 % for all
//! of them together.

#![allow(clippy::print_stdout, reason = "sizes and times are for those who ask with --nocapture")]

use std::f64::consts::TAU;
use std::sync::LazyLock;

use translucid_profile::Configuration;
use translucid_reference::body::{Body, Interior, Lighting, Shape};
use translucid_reference::exact::{HalfSpace, single_scattering_albedo};
use translucid_reference::layers::{Ground, Layer, Layers};
use translucid_reference::walk::{
    Control, Layout, Parameters, PhaseFunction, Problem, Region, Side, WhiteTable,
};
use translucid_reference::{Estimate, Incidence};
use translucid_testing::{SplitMix, power};

use super::*;
use translucid_words::Cell;

/// Standard errors that photons may be off.
const FAR: f64 = 4.5;
const PHOTONS: u64 = 60_000;
/// Photons of a sphere.
const SPHERE: f64 = 6000.0;

/// All tables, made once.
static TABLES: LazyLock<Vec<OracleTable>> = LazyLock::new(|| {
    let mut all = Vec::new();
    for names in
        [&["profile", "edge", "disk", "line"][..], &["totals"], &["inversion"], &["slabs"], &["spheres"]]
    {
        let start = std::time::Instant::now();
        all.extend(oracle_tables(names, PHOTONS, Watch::default()).unwrap());
        println!("{names:?}: {:.1?}", start.elapsed());
    }
    all
});

/// A row of a table: its words and its numbers by the columns' names.
struct Row<'a>(&'a DataTable, &'a [Cell]);

impl Row<'_> {
    fn cell(&self, column: &str) -> &Cell {
        &self.1[self.0.columns.iter().position(|known| known.name == column).unwrap()]
    }

    fn number(&self, column: &str) -> f64 {
        match self.cell(column) {
            Cell::Number(number) => *number,
            Cell::Word(word) => panic!("{column} is {word}"),
        }
    }

    fn is(&self, words: &[&str], numbers: &[(&str, f64)]) -> bool {
        let has = |word: &&str| self.1.iter().any(|cell| *cell == Cell::from(*word));
        words.iter().all(has)
            && numbers.iter().all(|(column, value)| (self.number(column) - value).abs() < 1e-9)
    }
}

/// Rows of a table with these words and numbers, of which there must be some.
fn rows(name: &str, words: &[&str], numbers: &[(&str, f64)]) -> Vec<Row<'static>> {
    let table = &TABLES.iter().find(|table| table.name == name).unwrap().data;
    let found: Vec<_> =
        table.rows.iter().map(|row| Row(table, row)).filter(|row| row.is(words, numbers)).collect();
    assert!(!found.is_empty(), "{name}: no row {words:?} {numbers:?}");
    found
}

fn assert_close(name: &str, found: Estimate, expected: Estimate) {
    let off = (found.value - expected.value) / found.error.hypot(expected.error);
    assert!(off.abs() < FAR, "{name}: {found:?}, expected {expected:?}: {off} standard errors");
}

/// Ends of analog photons on a half space without a boundary: x of where each leaves, none if it is absorbed.
///
/// Slow and obvious: one photon after the other, and nothing of the crate's walks.
fn analog_exits(
    alpha: f64,
    g: f64,
    configuration: Configuration,
    photons: u64,
    seed: u64,
) -> Vec<Option<[f64; 2]>> {
    let mut random = SplitMix(seed);
    let mut photon = || {
        let mu = match configuration {
            Configuration::Searchlight => 1.0,
            Configuration::Diffuse => random.uniform().sqrt(),
        };
        let (mut at, mut way) = ([0.0; 3], turned([0.0, 0.0, 1.0], mu, TAU * random.uniform()));
        loop {
            let flight = -libm::log(1.0 - random.uniform());
            let next: [f64; 3] = std::array::from_fn(|i| at[i] + flight * way[i]);
            if next[2] < 0.0 {
                let part = at[2] / (at[2] - next[2]);
                return Some([0, 1].map(|i| at[i] + part * (next[i] - at[i])));
            }
            at = next;
            if random.uniform() >= alpha {
                return None;
            }
            let u = random.uniform();
            let cos = if g == 0.0 {
                2.0 * u - 1.0
            } else {
                let s = (1.0 - g * g) / (1.0 - g + 2.0 * g * u);
                (1.0 + g * g - s * s) / (2.0 * g)
            };
            way = turned(way, cos, TAU * random.uniform());
        }
    };
    (0..photons).map(|_| photon()).collect()
}

/// A direction turned by an angle, around itself by another.
fn turned(way: [f64; 3], cos: f64, phi: f64) -> [f64; 3] {
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    let [x, y, z] = way;
    // Two axes across it
    let helper = if z.abs() < 0.9 { [0.0, 0.0, 1.0] } else { [1.0, 0.0, 0.0] };
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let u = cross([x, y, z], helper);
    let length = (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]).sqrt();
    let u = u.map(|v| v / length);
    let v = cross([x, y, z], u);
    let (s, c) = libm::sincos(phi);
    std::array::from_fn(|i| cos * way[i] + sin * (c * u[i] + s * v[i]))
}

fn share(count: usize, all: usize) -> Estimate {
    let value = count as f64 / all as f64;
    Estimate { value, error: (value * (1.0 - value) / all as f64).sqrt() }
}

/// By symmetry, light at a distance d from a lit half plane is what leaves farther than d to one side of one point of entry.
#[test]
fn edges_lines_and_totals_are_those_of_photons() {
    for (g, a, configuration) in [
        (0.0, 0.5, Configuration::Searchlight),
        (0.0, 0.9, Configuration::Diffuse),
        (0.8, 0.8, Configuration::Diffuse),
    ] {
        let medium = [("g", g), ("eta", 1.0), ("surface_albedo", a)];
        let words = [configuration.name()];
        let edges = rows("edge", &words, &medium);
        let alpha = edges[0].number("single_scattering_albedo");
        let exits = analog_exits(alpha, g, configuration, power(40_000), 11);
        let left: Vec<[f64; 2]> = exits.iter().flatten().copied().collect();
        let total = share(left.len(), exits.len());
        assert_close("total", total, Estimate { value: a, error: 1e-6 });
        for row in edges.iter().step_by(4) {
            let distance = row.number("distance");
            let found = share(left.iter().filter(|[x, _]| *x > distance).count(), left.len());
            let expected = Estimate { value: row.number("dark"), error: row.number("error") };
            if found.value > 1e-3 {
                assert_close(&format!("edge g {g} A {a} at {distance}"), found, expected);
            }
        }
        for row in rows("line", &words, &medium).iter().step_by(5) {
            let (half, offset) = (0.5 * row.number("width"), row.number("offset"));
            let found = share(left.iter().filter(|[x, _]| (x - offset).abs() < half).count(), left.len());
            let expected = Estimate { value: row.number("response"), error: row.number("error") };
            if found.value > 1e-3 {
                assert_close(&format!("line g {g} A {a} {half} at {offset}"), found, expected);
            }
        }
        for row in rows("disk", &words, &medium).iter().step_by(5) {
            let (radius, offset) = (row.number("radius"), row.number("offset"));
            let is_lit = |at: &&[f64; 2]| (at[0] - offset).hypot(at[1]) < radius;
            let found = share(left.iter().filter(is_lit).count(), left.len());
            let expected = Estimate { value: row.number("response"), error: row.number("error") };
            if found.value > 1e-3 {
                assert_close(&format!("disk g {g} A {a} {radius} at {offset}"), found, expected);
            }
        }
    }
}

/// The walk from a disk of light: what leaves around its center.
#[test]
fn disks_are_those_of_the_walk_from_a_disk() {
    for row in
        rows("disk", &["searchlight"], &[("g", 0.0), ("eta", 1.4), ("surface_albedo", 0.8), ("offset", 0.0)])
    {
        let radius = row.number("radius");
        let problem =
            Problem::new(Parameters { eta: 1.4, spot_radius: radius, ..Parameters::default() }).unwrap();
        // So near the center that the light is even there
        let alpha = row.number("single_scattering_albedo");
        let mut table = WhiteTable::new(problem, Layout::new(&[0.15 * radius], 1).unwrap(), alpha).unwrap();
        table.run(3, power(60_000), &Control::default()).unwrap();
        let at = table.at_albedo(alpha).unwrap();
        let Estimate { value, error } = at.reflectance(Side::Reflected, Region::Within(0));
        let scale = std::f64::consts::PI * radius * radius / 0.8;
        let found = Estimate { value: value * scale, error: error * scale };
        let expected = row.number("response");
        // What it is not even by is below a hundredth
        assert_close(&format!("{radius}"), found, Estimate { value: expected, error: 2e-3 * expected });
    }
}

/// R(r) and energies of photons against those of layers by wave number.
#[test]
fn profiles_of_walks_are_those_of_layers() {
    let medium = [("g", 0.8), ("eta", 1.0), ("surface_albedo", 0.8)];
    let all = rows("profile", &["searchlight", "walk"], &medium);
    let alpha = all[0].number("single_scattering_albedo");
    let layer = Layer::new(alpha, 1.0 - alpha, f64::INFINITY).with_g(0.8);
    let layers =
        Layers::new(1.0, vec![layer], Ground::None).unwrap().profile_within(5e-3, &Control::default());
    let layers = layers.unwrap().unwrap();
    let mut count = 0;
    for row in all.iter().filter(|row| (0.5..20.0).contains(&row.number("r"))) {
        let expected = layers.reflectance(row.number("r"));
        let [value, error] = ["reflectance", "reflectance_error"].map(|column| row.number(column));
        assert_close(&format!("r {}", row.number("r")), Estimate { value, error }, expected);
        count += 1;
    }
    assert!(count > 12, "{count}");
}

/// Exact profiles against rings of photons, by an independent configuration of the walk.
#[test]
fn exact_profiles_are_those_of_the_walk() {
    for (eta, name) in [(1.0, "diffuse"), (1.4, "searchlight")] {
        let all = rows("profile", &[name, "exact"], &[("eta", eta), ("g", 0.0), ("surface_albedo", 0.8)]);
        let incidence = if name == "diffuse" { Incidence::Cosine } else { Incidence::NORMAL };
        let problem = Problem::new(Parameters { eta, incidence, ..Parameters::default() }).unwrap();
        let radii: Vec<f64> = all.iter().map(|row| row.number("r")).collect();
        let alpha = all[0].number("single_scattering_albedo");
        let mut table = WhiteTable::new(problem, Layout::around(&radii).unwrap(), alpha).unwrap();
        table.run(5, power(60_000), &Control::default()).unwrap();
        let at = table.at_albedo(alpha).unwrap();
        for row in all.iter().filter(|row| row.number("enclosed") < 0.79) {
            let r = row.number("r");
            let found = at.at_radius(Side::Reflected, r).unwrap();
            let number = |column: &str| row.number(column);
            let expected = Estimate { value: number("reflectance"), error: 1e-3 * number("reflectance") };
            // A ring that hardly any photon has seen knows no error
            if found.reflectance.error < 0.2 * expected.value {
                assert_close(&format!("R at {r}"), found.reflectance, expected);
            }
            assert_close(
                &format!("E at {r}"),
                found.enclosed,
                Estimate { value: number("enclosed"), error: 1e-9 },
            );
        }
    }
}

#[test]
fn totals_and_inversion_are_exact_or_those_of_the_walk() {
    for (configuration, incidence) in
        [(Configuration::Searchlight, Incidence::NORMAL), (Configuration::Diffuse, Incidence::Cosine)]
    {
        let words = [configuration.name()];
        for eta in [1.4, 1.5] {
            for row in rows("totals", &words, &[("g", 0.0), ("eta", eta)]).iter().step_by(4) {
                let alpha = row.number("single_scattering_albedo");
                let exact = HalfSpace::with_boundary(alpha, eta, incidence).unwrap().total();
                let off = (row.number("surface_albedo") - exact.value).abs();
                assert!(off <= row.number("error") + exact.error + 1e-9, "{eta} {alpha}: {off}");
            }
            for row in rows("inversion", &words, &[("g", 0.0), ("eta", eta)]).iter().step_by(6) {
                let a = row.number("surface_albedo");
                let exact = single_scattering_albedo(a, eta, incidence).unwrap();
                let more = single_scattering_albedo(1.001 * a, eta, incidence).unwrap();
                let slope = (more - exact) / (0.001 * a);
                let off = (row.number("single_scattering_albedo") - exact).abs();
                let allowed = 1.1 * slope * row.number("surface_albedo_error") + 1e-9;
                assert!(off < allowed, "{eta} {a}: {off} {allowed}");
            }
        }
        // Of every phase function
        for (g, eta) in [(0.8, 1.4), (0.5, 1.5), (0.9, 1.0)] {
            let problem = Problem::new(Parameters {
                phase_function: PhaseFunction::HenyeyGreenstein { g },
                eta,
                incidence,
                ..Parameters::default()
            });
            let mut table =
                WhiteTable::new(problem.unwrap(), Layout::new(&[1.0], 1).unwrap(), 0.999).unwrap();
            table.run(9, power(60_000), &Control::default()).unwrap();
            let total = |alpha: f64| table.at_albedo(alpha).unwrap().total(Side::Reflected);
            for (name, column) in [("totals", "error"), ("inversion", "surface_albedo_error")] {
                for row in rows(name, &words, &[("g", g), ("eta", eta)]) {
                    let alpha = row.number("single_scattering_albedo");
                    if (0.3..0.999).contains(&alpha) {
                        let expected =
                            Estimate { value: row.number("surface_albedo"), error: row.number(column) };
                        assert_close(&format!("{name} {g} {eta} {alpha}"), total(alpha), expected);
                    }
                }
            }
        }
    }
}

/// Columns of the inversion that follow from the surface albedo, beside those of a medium with the exact one.
#[test]
fn inversion_states_how_far_its_media_are_off() {
    for (configuration, incidence) in
        [(Configuration::Searchlight, Incidence::NORMAL), (Configuration::Diffuse, Incidence::Cosine)]
    {
        for row in rows("inversion", &[configuration.name()], &[("g", 0.0), ("eta", 1.4)]) {
            let a = row.number("surface_albedo");
            let alpha = single_scattering_albedo(a, 1.4, incidence).unwrap();
            let medium = translucid_profile::Medium::from_mfp(alpha, 1.0, 0.0).unwrap();
            for (column, exact) in [
                ("single_scattering_albedo", alpha),
                ("reduced_albedo", medium.alpha_prime()),
                ("dmfp", medium.dmfp()),
            ] {
                let (off, error) =
                    ((row.number(column) - exact).abs(), row.number(&format!("{column}_error")));
                assert!(off < 1.1 * error + 1e-11 * exact, "{column} {a}: {off:e} {error:e}");
                assert!(error < 1e-3 * exact, "{column} {a}: {error:e}");
            }
        }
    }
}

#[test]
fn slabs_are_those_of_photons_and_lose_nothing() {
    let parts = [
        "specular_reflectance",
        "diffuse_reflectance",
        "collimated_transmittance",
        "diffuse_transmittance",
        "absorbed",
    ];
    for row in rows("slabs", &[], &[]) {
        let sum: f64 = parts.iter().map(|part| row.number(part)).sum();
        assert!((sum - 1.0).abs() < 1e-9, "{sum}");
        assert!(row.number("error") < 1e-4, "{}", row.number("error"));
    }
    for (g, eta, thickness) in [(0.0, 1.0, 1.0), (0.8, 1.4, 3.0), (0.8, 1.0, 10.0)] {
        let row = &rows(
            "slabs",
            &["searchlight"],
            &[("g", g), ("eta", eta), ("thickness", thickness), ("single_scattering_albedo", 0.9)],
        )[0];
        let interior = Interior { single_scattering_albedo: 0.9, g, eta };
        let tally =
            Body::new(Shape::Slab { thickness }, interior, Lighting::Distant).unwrap().walk(power(40_000), 4);
        let entered = 1.0 - translucid_reference::specular_reflectance(Incidence::NORMAL, eta);
        for (part, column) in [(0, "diffuse_reflectance"), (1, "diffuse_transmittance")] {
            let Estimate { value, error } = tally.scattered_through(part);
            let found = Estimate { value: entered * value, error: entered * error };
            let expected = Estimate { value: row.number(column), error: row.number("error") };
            assert_close(&format!("{column} {g} {eta} {thickness}"), found, expected);
        }
    }
}

#[test]
fn spheres_lose_nothing_and_are_transparent_as_they_must() {
    for row in rows("spheres", &[], &[("single_scattering_albedo", 1.0)]) {
        assert_eq!([row.number("leaving"), row.number("leaving_error")], [1.0, 0.0]);
    }
    // Uniform light on a sphere, by its chords: 2μr with the density 2μ
    for row in rows("spheres", &["uniform"], &[("eta", 1.0)]) {
        let d = 2.0 * row.number("radius");
        let expected = 2.0 * (1.0 - (1.0 + d) * libm::exp(-d)) / (d * d);
        // The table's own error is that of a count
        let error = (expected * (1.0 - expected) / SPHERE).sqrt();
        let found = Estimate { value: row.number("straight"), error };
        if expected * SPHERE > 20.0 {
            assert_close(&format!("straight {d}"), found, Estimate { value: expected, error: 0.0 });
        }
        // Where no photon was counted, its bound holds: three photons' share
        if found.value == 0.0 {
            assert!(expected < row.number("straight_error"), "{d}: {expected}");
        }
    }
    let mut empty = 0;
    for row in rows("spheres", &["distant"], &[]) {
        for column in ["straight", "front", "back"] {
            let error = row.number(&format!("{column}_error"));
            assert!(error > 0.0, "{column}");
            if row.number(column) == 0.0 {
                assert!((error * SPHERE / 3.0 - 1.0).abs() < 0.01, "{column}: {error}");
                empty += 1;
            }
        }
    }
    assert!(empty > 0);
}

#[test]
fn same_bits_at_any_number_of_threads() {
    let names = ["totals", "spheres"];
    let made = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| oracle_tables(&names, 2000, Watch::default()).unwrap())
    });
    // Numbers that are none are not equal to themselves
    let texts = made
        .each_ref()
        .map(|made| made.iter().map(|table| (table.data.csv(), &table.json)).collect::<Vec<_>>());
    assert!(texts[0] == texts[1]);
    assert_eq!(made[0].iter().map(|table| table.name).collect::<Vec<_>>(), names);
}

#[test]
fn tables_have_all_their_cells_and_stop() {
    for table in TABLES.iter() {
        let width = table.data.columns.len();
        assert!(table.data.rows.iter().all(|row| row.len() == width), "{}", table.name);
        println!(
            "{:10} {:6} rows, CSV {:8} bytes, JSON {:8} bytes",
            table.name,
            table.data.rows.len(),
            table.data.csv().len(),
            table.json.len()
        );
    }
    let bytes: usize = TABLES.iter().map(|table| table.data.csv().len() + table.json.len()).sum();
    assert!(bytes < 5_000_000, "{bytes}");
    let stop = std::sync::atomic::AtomicBool::new(true);
    let stopped = oracle_tables(&oracle_names(), PHOTONS, Watch { stop: &stop, progress: &|_| {} });
    assert_eq!(stopped, Err(Stopped));
}
