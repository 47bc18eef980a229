//! Files of tables, whole, cut short, damaged and made up.

use std::fs;
use std::io::Cursor;
use std::sync::Arc;

use super::super::run::Control;
use super::*;
use crate::phase_table::PhaseTable;

fn small_table() -> WhiteTable {
    let parameters = Parameters { thickness: 0.7, eta: 1.0 + 1e-15, ..Parameters::default() };
    let layout = Layout::with_order_bins(&[0.1, 1.0 / 3.0], 2, OrderBins::new(1.0).unwrap()).unwrap();
    let mut table = WhiteTable::new(Problem::new(parameters).unwrap(), layout, 0.9).unwrap();
    table.run(u64::MAX, 3000, &Control::default()).unwrap();
    table.run(2, 100, &Control::default()).unwrap();
    table
}

fn bytes_of(table: &WhiteTable) -> Vec<u8> {
    let mut bytes = Vec::new();
    table.write(&mut bytes).unwrap();
    bytes
}

fn load_bytes(bytes: &[u8]) -> Result<WhiteTable, TableError> {
    WhiteTable::read(bytes, Path::new("table.npz"))
}

/// Members of an archive.
type Members = Vec<(String, Vec<u8>)>;

fn members(bytes: &[u8]) -> Members {
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
    let count = archive.len();
    let read = |index| {
        let mut file = archive.by_index(index).unwrap();
        let mut data = Vec::new();
        file.read_to_end(&mut data).unwrap();
        (file.name().unwrap().into_owned(), data)
    };
    (0..count).map(read).collect()
}

fn archive(members: &Members, method: zip::CompressionMethod) -> Vec<u8> {
    let mut out = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, data) in members {
        out.start_file(name, zip::write::SimpleFileOptions::default().compression_method(method)).unwrap();
        out.write_all(data).unwrap();
    }
    out.finish().unwrap().into_inner()
}

/// The error of a table with a member changed.
fn error_with(name: &str, change: impl FnOnce(&mut Vec<u8>)) -> String {
    let mut members = members(&bytes_of(&small_table()));
    let member = members.iter_mut().find(|(found, _)| *found == format!("{name}.npy")).unwrap();
    change(&mut member.1);
    let error = load_bytes(&archive(&members, zip::CompressionMethod::Stored)).unwrap_err().to_string();
    assert!(error.contains("table.npz"), "{error}");
    error
}

fn set_last(word: u64) -> impl Fn(&mut Vec<u8>) {
    move |data| {
        let at = data.len() - 8;
        data[at..].copy_from_slice(&word.to_le_bytes());
    }
}

#[test]
fn table_comes_back_bit_by_bit() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("table.npz");
    let base = Parameters::default();
    let hg = PhaseFunction::HenyeyGreenstein { g: -0.1 };
    let moments = PhaseFunction::Moments([1.0 / 3.0, 0.1].into());
    let two_term = PhaseFunction::TwoTerm { weight: 0.9, g1: 1.0 / 3.0, g2: -0.7 };
    let rows = vec![[-1.0, 0.1], [1.0 / 3.0, 0.7], [1.0, 1e-20]];
    let table = PhaseFunction::Table(Arc::new(PhaseTable::new(rows).unwrap()));
    let oblique = Incidence::Pencil { cos_theta: 1.0 / 3.0 };
    for (parameters, radii, sectors) in [
        (base.clone(), vec![0.1, 0.2, 1e3], 1),
        (Parameters { phase_function: moments, ..base.clone() }, vec![1.0], 1),
        (Parameters { phase_function: two_term, ..base.clone() }, vec![1.0], 1),
        (Parameters { phase_function: table, ..base.clone() }, vec![1.0], 1),
        (Parameters { phase_function: PhaseFunction::Rayleigh, thickness: 1e-3, ..base.clone() }, vec![], 1),
        (
            Parameters { phase_function: hg, incidence: Incidence::Cosine, spot_radius: 0.1, ..base.clone() },
            vec![1.0],
            5,
        ),
        (Parameters { eta: 1.4, incidence: oblique, ..base.clone() }, vec![1e-15, 1e15], 720),
        (
            Parameters { incidence: Incidence::UniformCosine, thickness: f64::MAX, ..base.clone() },
            vec![1.0],
            1,
        ),
    ] {
        let bins = OrderBins::new(1.0).unwrap();
        let layout = Layout::with_order_bins(&radii, sectors, bins).unwrap();
        let mut table = WhiteTable::new(Problem::new(parameters).unwrap(), layout, 0.95).unwrap();
        for photons in [0, 2000] {
            table.run(3, photons, &Control::default()).unwrap();
            let bytes = bytes_of(&table);
            fs::write(&path, &bytes).unwrap();
            let back = WhiteTable::load(&path).unwrap();
            assert_eq!(back, table);
            assert_eq!(bytes_of(&back), bytes);
        }
    }
}

#[test]
fn table_goes_on_after_a_file() {
    let mut table = small_table();
    let mut back = load_bytes(&bytes_of(&table)).unwrap();
    for table in [&mut table, &mut back] {
        table.run(2, 500, &Control::default()).unwrap();
    }
    assert_eq!(back, table);
}

#[test]
fn cut_files_are_refused() {
    let whole = bytes_of(&small_table());
    for length in (0..whole.len()).step_by(37).chain(whole.len() - 30..whole.len()) {
        let error = load_bytes(&whole[..length]).unwrap_err().to_string();
        assert!(error.contains("table.npz"), "{length}: {error}");
    }
}

/// A flipped bit is either noticed or without meaning (a time, say).
#[test]
fn flipped_bits_change_nothing_unnoticed() {
    let table = small_table();
    let mut bytes = bytes_of(&table);
    let (mut noticed, mut all) = (0, 0);
    for bit in (0..8 * bytes.len()).step_by(61).chain(8 * (bytes.len() - 1200)..8 * bytes.len()) {
        bytes[bit / 8] ^= 1 << (bit % 8);
        all += 1;
        match load_bytes(&bytes) {
            Ok(found) => assert_eq!(found, table, "bit {bit}"),
            Err(error) => {
                noticed += 1;
                assert!(error.to_string().contains("table.npz"), "{error}");
            }
        }
        bytes[bit / 8] ^= 1 << (bit % 8);
    }
    assert!(2 * noticed > all, "{noticed} of {all}");
}

/// With checksums that fit, as somebody might make them on purpose: another table, or an error.
#[test]
fn changed_members_never_panic() {
    let all = members(&bytes_of(&small_table()));
    let mut state = 1u64;
    let mut random = |n: usize| {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) as usize % n
    };
    let (mut tables, mut errors) = (0, 0);
    for _ in 0..3000 {
        let mut changed = all.clone();
        let data = &mut changed[random(all.len())].1;
        for _ in 0..=random(3) {
            let at = random(data.len());
            match random(4) {
                0 => data[at] = b"0123456789(){},' :<"[random(19)],
                1 => data[at] = random(256) as u8,
                2 => data.truncate(at.max(1)),
                _ => data.insert(at, random(256) as u8),
            }
        }
        match load_bytes(&archive(&changed, zip::CompressionMethod::Stored)) {
            Ok(table) => {
                tables += 1;
                assert!(table.at_albedo(0.0).unwrap().absorbed().value.is_finite());
            }
            Err(error) => {
                errors += 1;
                assert!(error.to_string().contains("table.npz"), "{error}");
            }
        }
    }
    assert!(tables > 10 && errors > 1000, "{tables} {errors}");
}

#[test]
fn damaged_data_is_named() {
    let mut bytes = bytes_of(&small_table());
    let last = bytes.windows(14).rposition(|window| window == b"order_sums.npy").unwrap();
    // Far before the directory's entry: in the data
    bytes[last - 1000] ^= 1;
    let error = load_bytes(&bytes).unwrap_err().to_string();
    assert!(error.contains("order_sums.npy") && error.contains("checksum"), "{error}");
}

#[test]
fn missing_unknown_and_repeated_members_are_named() {
    let all = members(&bytes_of(&small_table()));
    let stored = zip::CompressionMethod::Stored;
    for (index, (name, _)) in all.iter().enumerate() {
        let mut rest = all.clone();
        rest.remove(index);
        let error = load_bytes(&archive(&rest, stored)).unwrap_err().to_string();
        assert!(error.contains(&format!("{name}: is missing")), "{error}");
    }
    let mut more = all.clone();
    more.push(("more.npy".to_owned(), vec![]));
    let error = load_bytes(&archive(&more, stored)).unwrap_err().to_string();
    assert!(error.contains("has an unknown member \"more.npy\""), "{error}");
    assert!(load_bytes(&archive(&vec![], stored)).is_err());
    // In another sequence it is the same table.
    more.pop();
    more.reverse();
    assert_eq!(load_bytes(&archive(&more, stored)).unwrap(), small_table());
}

#[test]
fn impossible_numbers_are_named() {
    let number = |value: f64| set_last(value.to_bits());
    for (name, change, expected) in [
        ("version", set_last(2), "version.npy: is 2, but only version 1 is known"),
        ("absorbed", set_last(7), "counts.npy: has "),
        ("absorbed", set_last(u64::MAX), "counts.npy: has "),
        ("collisions", set_last(7), "collisions.npy: is 7, but must be at least "),
        ("sectors", set_last(0), "sectors.npy: sectors is 0, but must be in [1, 720]"),
        ("sectors", set_last(u64::MAX), "sectors.npy: has 18446744073709551615, but at most 4294967295"),
        ("sectors", set_last(3), "counts.npy: has the shape [2, 3, 2, 26], but must have [2, 3, 3, 26]"),
        ("first_orders", set_last(3), "first_orders.npy: first order of a bin is 3, but must be greater"),
        ("first_orders", set_last(u64::MAX), "first_orders.npy: has 18446744073709551615, but at most"),
        ("photon_ranges", set_last(u64::MAX), "photon_ranges.npy: has more photons than fit in 64 bits"),
        ("photon_ranges", set_last(9999), "counts.npy: has "),
        ("photon_ranges", set_last(0), "photon_ranges.npy: has a range from 0 to 0, but the end"),
        ("counts", set_last(u64::MAX), "order_sums.npy: has the sum 0 for 18446744073709551615 photons"),
        ("order_sums", set_last(1), "order_sums.npy: has the sum 1 for 0 photons of orders"),
    ] {
        let error = error_with(name, change);
        assert!(error.contains(expected), "{name}: {error}");
    }
    for (name, value, expected) in [
        ("g", 1.0, "g.npy: g is 1, but must be in (-1, 1)"),
        ("g", f64::NAN, "g.npy: g is NaN, but must be in (-1, 1)"),
        ("eta", 0.0, "eta.npy: eta is 0, but must be in [0.1, 10]"),
        ("thickness", -1.0, "thickness.npy: thickness is -1, but must be greater than 0"),
        ("thickness", f64::INFINITY, "counts.npy: has the shape [2, 3, 2, 26], but must have [1, 3, 2, 26]"),
        ("cos_theta", 2.0, "cos_theta.npy: cos_theta is 2, but"),
        ("spot_radius", f64::INFINITY, "spot_radius.npy: spot_radius is inf, but"),
        (
            "reference_albedo",
            1.0,
            "reference_albedo.npy: reference_albedo is 1, but must be in (0, 0.999999]",
        ),
        ("radii", 0.1, "radii.npy: radius is 0.1, but must be greater than the radius before it"),
        ("radii", f64::NAN, "radii.npy: radius is NaN, but must be in [1e-15, 1e15]"),
    ] {
        let error = error_with(name, number(value));
        assert!(error.contains(expected), "{name}: {error}");
    }
}

#[test]
fn wrong_arrays_are_named() {
    let replace = |old: &'static str, new: &'static str| {
        move |data: &mut Vec<u8>| {
            let at = data.windows(old.len()).position(|window| window == old.as_bytes()).unwrap();
            data.splice(at..at + old.len(), new.bytes());
        }
    };
    for (name, old, new, expected) in [
        ("radii", "<f8", "<u8", "radii.npy: has elements of type \"<u8\", but they must be \"<f8\""),
        ("counts", "<u8", ">u8", "counts.npy: has elements of type \">u8\", but they must be \"<u8\""),
        ("counts", "False", "True ", "counts.npy: has the header"),
        ("counts", "(2, 3, 2, 26)", "(2, 3, 52   )", "counts.npy: has the shape [2, 3, 52], but must have"),
        ("radii", "(2,)", "(9,)", "radii.npy: has 16 bytes of data, but its shape [9] asks for 72"),
        ("radii", "(2,), }                    ", "(99999999999999999,), }    ", "radii.npy: has 16 bytes"),
        ("radii", "(2,), }                    ", "(4611686018427387904,), }  ", "which is too large"),
        ("radii", "(2,)", "(  )", "radii.npy: has the shape [], but must have one dimension"),
        ("photon_ranges", "(2, 3)", "(3, 2)", "photon_ranges.npy: has the shape [3, 2], but"),
        ("entry", "|S6", "|S5", "entry.npy: has 6 bytes of data, but its shape [] asks for 5"),
        ("entry", "|S6", "<U6", "entry.npy: has the type \"<U6\", but must be \"|S\""),
        ("entry", "pencil", "Pencil", "entry.npy: is \"Pencil\", but must be one of pencil, cosine, uniform"),
        ("version", "NUMPY", "NUMPX", "version.npy: is not an array of version 1.0"),
    ] {
        let error = error_with(name, replace(old, new));
        assert!(error.contains(expected), "{name}: {error}");
    }
    let error = error_with("order_sums", |data| data.truncate(data.len() - 8));
    assert!(error.contains("order_sums.npy: has 2488 bytes of data"), "{error}");
    let error = error_with("order_sums", |data| data.extend([0; 8]));
    assert!(error.contains("order_sums.npy: has 2504 bytes of data"), "{error}");
    let error = error_with("order_sums", |data| data.truncate(5));
    assert!(error.contains("order_sums.npy: cannot be read"), "{error}");
}

#[test]
fn files_that_are_no_tables_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let error = WhiteTable::load(directory.path()).unwrap_err().to_string();
    assert!(error.contains("not a regular file"), "{error}");
    let error = WhiteTable::load(&directory.path().join("none.npz")).unwrap_err().to_string();
    assert!(error.contains("cannot read") && error.contains("none.npz"), "{error}");
    let path = directory.path().join("long.npz");
    File::create(&path).unwrap().set_len(LONGEST + 1).unwrap();
    let error = WhiteTable::load(&path).unwrap_err().to_string();
    assert!(error.contains("has more than 83886080 bytes"), "{error}");
    assert!(load_bytes(b"").unwrap_err().to_string().contains("is not an NPZ archive"));
    assert!(load_bytes(&[b'x'; 5000]).unwrap_err().to_string().contains("is not an NPZ archive"));
}
