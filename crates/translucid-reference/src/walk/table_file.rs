//! Files of tables. `docs/guide/white-tables.md` describes every member.

use std::io::{self, Read, Seek, Write};
use std::path::Path;

use super::exit::PhotonCounts;
use super::layout::Layout;
use super::npz::{Reader, Writer, expect_shape};
use super::orders::{Cell, OrderBins};
use super::photon_ranges::{PhotonRange, PhotonRanges};
use super::problem::{Parameters, PhaseFunction, Problem};
use super::table_error::TableError;
use super::white_table::{WhiteTable, faces};
use super::whole_file::write_whole;
use crate::Entry;

/// Version of the format that is written, and the only one that is read.
const VERSION: u64 = 1;
/// Longest file that is read: two faces of most entries, and 16 MiB for all else.
const LONGEST: u64 = 2 * 16 * Layout::MOST_ENTRIES as u64 + (16 << 20);
/// All members.
const MEMBERS: [&str; 17] = [
    "version",
    "phase_function",
    "g",
    "eta",
    "thickness",
    "entry",
    "cos_theta",
    "spot_radius",
    "reference_albedo",
    "radii",
    "sectors",
    "first_orders",
    "photon_ranges",
    "absorbed",
    "collisions",
    "counts",
    "order_sums",
];
const HENYEY_GREENSTEIN: &str = "henyey-greenstein";
const RAYLEIGH: &str = "rayleigh";
const PENCIL: &str = "pencil";
const COSINE: &str = "cosine";
const UNIFORM_COSINE: &str = "uniform-cosine";

impl WhiteTable {
    /// Writes the table to a file from which [`WhiteTable::load`] makes an equal one.
    ///
    /// The file is an NPZ archive, which `numpy.load` opens; `docs/guide/white-tables.md` says what is in it. It is
    /// written beside its target and then renamed, so that there is always either the old file or the new one,
    /// whole. Equal tables make equal bytes.
    ///
    /// # Errors
    /// The file cannot be written. An older one at `path` is then still there.
    pub fn save(&self, path: &Path) -> Result<(), TableError> {
        write_whole(path, |out| {
            let mut writer = Writer::new(out);
            self.write(&mut writer)?;
            writer.finish()
        })
    }

    /// Reads a table from a file.
    ///
    /// ```no_run
    /// use std::path::Path;
    /// use translucid_reference::walk::{Control, WhiteTable};
    ///
    /// // Double what is there.
    /// let path = Path::new("half-space.npz");
    /// let mut table = WhiteTable::load(path)?;
    /// table.run(1, table.photons(), &Control::default())?;
    /// table.save(path)?;
    /// # Ok::<(), translucid_reference::walk::TableError>(())
    /// ```
    ///
    /// # Errors
    /// The file cannot be read, is not such an archive, is longer than 80 MiB, cut short, damaged (every member has
    /// a checksum) or of another version, or its numbers contradict each other.
    pub fn load(path: &Path) -> Result<Self, TableError> {
        Self::read(Reader::open(path, LONGEST, &MEMBERS)?)
    }

    fn read<R: Read + Seek>(mut reader: Reader<R>) -> Result<Self, TableError> {
        let version = reader.count("version")?;
        if version != VERSION {
            let problem = format!("is {version}, but only version {VERSION} is known");
            return Err(reader.error("version", problem));
        }
        let (problem, layout) = (read_problem(&mut reader)?, read_layout(&mut reader)?);
        let reference_albedo = reader.number("reference_albedo")?;
        let (ranges, counts) = read_photons(&mut reader)?;
        let cells = read_cells(&mut reader, &problem, &layout)?;
        check_sums(&reader, &counts, &cells)?;
        Self::with_contents(problem, layout, reference_albedo, ranges, counts, cells)
            .map_err(|error| reader.error("reference_albedo", error.to_string()))
    }

    fn write<W: Write + Seek>(&self, out: &mut Writer<W>) -> io::Result<()> {
        // Write what was walked
        let Parameters { phase_function, eta, thickness, entry, spot_radius } = *self.problem().parameters();
        let (phase_name, g) = match phase_function {
            PhaseFunction::HenyeyGreenstein { g } => (HENYEY_GREENSTEIN, g),
            PhaseFunction::Rayleigh => (RAYLEIGH, 0.0),
        };
        let (entry_name, cos_theta) = match entry {
            Entry::Pencil { cos_theta } => (PENCIL, cos_theta),
            Entry::Cosine => (COSINE, 1.0),
            Entry::UniformCosine => (UNIFORM_COSINE, 1.0),
        };
        out.count("version", VERSION)?;
        out.text("phase_function", phase_name)?;
        out.number("g", g)?;
        out.number("eta", eta)?;
        out.number("thickness", thickness)?;
        out.text("entry", entry_name)?;
        out.number("cos_theta", cos_theta)?;
        out.number("spot_radius", spot_radius)?;
        out.number("reference_albedo", self.reference_albedo())?;

        // Write the bins
        let (layout, bins) = (self.layout(), self.layout().order_bins());
        out.words("radii", "<f8", &[layout.radii().len()], layout.radii().iter().map(|r| r.to_bits()))?;
        out.count("sectors", layout.sectors() as u64)?;
        out.words("first_orders", "<u8", &[bins.len()], bins.first_orders().map(u64::from))?;

        // Write what they hold
        let (counts, ranges) = (self.counts(), self.photon_ranges());
        let numbers = ranges.iter().flat_map(|range| [range.seed, range.start, range.end]);
        out.words("photon_ranges", "<u8", &[ranges.len(), 3], numbers)?;
        out.count("absorbed", counts.absorbed)?;
        out.count("collisions", counts.collisions)?;
        let (cells, shape) = (self.all_cells(), shape(self.problem(), layout));
        out.words("counts", "<u8", &shape, cells.iter().map(|cell| cell.count))?;
        out.words("order_sums", "<u8", &shape, cells.iter().map(|cell| cell.order_sum))
    }
}

/// Faces, rings, sectors, order bins.
fn shape(problem: &Problem, layout: &Layout) -> [usize; 4] {
    [faces(problem), layout.rings(), layout.sectors(), layout.order_bins().len()]
}

fn read_problem<R: Read + Seek>(reader: &mut Reader<R>) -> Result<Problem, TableError> {
    let g = reader.number("g")?;
    let phase_function = match reader.text("phase_function", &[HENYEY_GREENSTEIN, RAYLEIGH])? {
        RAYLEIGH if g != 0.0 => {
            return Err(reader.error("g", format!("is {g}, but must be 0 with {RAYLEIGH}")));
        }
        RAYLEIGH => PhaseFunction::Rayleigh,
        _ => PhaseFunction::HenyeyGreenstein { g },
    };
    let cos_theta = reader.number("cos_theta")?;
    let entry = match reader.text("entry", &[PENCIL, COSINE, UNIFORM_COSINE])? {
        PENCIL => Entry::Pencil { cos_theta },
        other if cos_theta != 1.0 => {
            return Err(reader.error("cos_theta", format!("is {cos_theta}, but must be 1 with {other}")));
        }
        COSINE => Entry::Cosine,
        _ => Entry::UniformCosine,
    };
    let (eta, thickness) = (reader.number("eta")?, reader.number("thickness")?);
    let spot_radius = reader.number("spot_radius")?;
    Problem::new(Parameters { phase_function, eta, thickness, entry, spot_radius })
        .map_err(|error| reader.error(error.parameter, error.to_string()))
}

fn read_layout<R: Read + Seek>(reader: &mut Reader<R>) -> Result<Layout, TableError> {
    let one_dimension = |shape: &[u64]| match shape {
        [_] => Ok(()),
        _ => Err(format!("has the shape {shape:?}, but must have one dimension")),
    };
    let radii: Vec<_> = reader.list("radii", "<f8", one_dimension)?.into_iter().map(f64::from_bits).collect();
    let sectors = reader.count("sectors")?;
    let sectors = fit(reader, "sectors", sectors)?;
    let words = reader.list("first_orders", "<u8", one_dimension)?;
    let first_orders: Vec<_> =
        words.into_iter().map(|word| fit(reader, "first_orders", word)).collect::<Result<_, _>>()?;
    let order_bins = OrderBins::from_first_orders(first_orders)
        .map_err(|error| reader.error("first_orders", error.to_string()))?;
    Layout::with_order_bins(&radii, sectors, order_bins).map_err(|error| {
        let member = if error.parameter == "sectors" { "sectors" } else { "radii" };
        reader.error(member, error.to_string())
    })
}

/// A number of a member as one of 32 bits.
fn fit<R: Read + Seek>(reader: &Reader<R>, member: &str, word: u64) -> Result<u32, TableError> {
    u32::try_from(word)
        .map_err(|_| reader.error(member, format!("has {word}, but at most {} is allowed", u32::MAX)))
}

fn read_photons<R: Read + Seek>(reader: &mut Reader<R>) -> Result<(PhotonRanges, PhotonCounts), TableError> {
    let three_columns = |shape: &[u64]| match shape {
        [_, 3] => Ok(()),
        _ => Err(format!("has the shape {shape:?}, but must have two dimensions, the second of 3")),
    };
    let words = reader.list("photon_ranges", "<u8", three_columns)?;
    let rows = words.as_chunks().0.iter().map(|&[seed, start, end]| PhotonRange { seed, start, end });
    if let Some(PhotonRange { start, end, .. }) = rows.clone().find(|range| range.start >= range.end) {
        let problem =
            format!("has a range from {start} to {end}, but the end must be greater than the start");
        return Err(reader.error("photon_ranges", problem));
    }
    let twice = |range| reader.error("photon_ranges", format!("has {range} twice"));
    let ranges = PhotonRanges::new(rows).map_err(twice)?;
    let too_many = || reader.error("photon_ranges", "has more photons than fit in 64 bits");
    let launched = ranges.len().ok_or_else(too_many)?;
    let (absorbed, collisions) = (reader.count("absorbed")?, reader.count("collisions")?);
    Ok((ranges, PhotonCounts { launched, absorbed, collisions }))
}

fn read_cells<R: Read + Seek>(
    reader: &mut Reader<R>,
    problem: &Problem,
    layout: &Layout,
) -> Result<Vec<Cell>, TableError> {
    let shape = shape(problem, layout).map(|n| n as u64);
    let mut cells: Vec<Cell> = Vec::new();
    let accept = |found: &[u64]| expect_shape(found, &shape);
    reader.words("counts", "<u8", accept, |count| {
        if cells.is_empty() {
            // By now the file is known to be long enough.
            cells.reserve_exact(faces(problem) * layout.entries());
        }
        cells.push(Cell { count, order_sum: 0 });
    })?;
    let mut rest = cells.iter_mut();
    reader.words("order_sums", "<u8", accept, |order_sum| {
        if let Some(cell) = rest.next() {
            cell.order_sum = order_sum;
        }
    })?;

    let bins = layout.order_bins();
    for (index, cell) in cells.iter().enumerate() {
        let (first, last) = bins.orders(index % bins.len());
        let [least, most] =
            [first, last.unwrap_or(u32::MAX)].map(|order| u128::from(cell.count) * u128::from(order));
        if !(least..=most).contains(&u128::from(cell.order_sum)) {
            let problem = format!(
                "has the sum {} for {} photons of orders {first} to {}, which is impossible (element {index})",
                cell.order_sum,
                cell.count,
                last.map_or("any".to_owned(), |last| last.to_string()),
            );
            return Err(reader.error("order_sums", problem));
        }
    }
    Ok(cells)
}

/// Every photon that entered left or was absorbed; every order and absorption is a collision.
fn check_sums<R: Read + Seek>(
    reader: &Reader<R>,
    counts: &PhotonCounts,
    cells: &[Cell],
) -> Result<(), TableError> {
    let exits: u128 = cells.iter().map(|cell| u128::from(cell.count)).sum();
    let orders: u128 = cells.iter().map(|cell| u128::from(cell.order_sum)).sum();
    let PhotonCounts { launched, absorbed, collisions } = *counts;
    if exits + u128::from(absorbed) != u128::from(launched) {
        let problem =
            format!("has {exits} photons, but {launched} entered and {absorbed} of them were absorbed");
        return Err(reader.error("counts", problem));
    }
    let least = orders + u128::from(absorbed);
    if u128::from(collisions) < least {
        return Err(reader.error("collisions", format!("is {collisions}, but must be at least {least}")));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::io::Cursor;

    use super::super::Control;
    use super::*;

    fn small_table() -> WhiteTable {
        let parameters = Parameters { thickness: 0.7, eta: 1.0 + 1e-15, ..Parameters::default() };
        let layout = Layout::with_order_bins(&[0.1, 1.0 / 3.0], 2, OrderBins::new(1.0).unwrap()).unwrap();
        let mut table = WhiteTable::new(Problem::new(parameters).unwrap(), layout, 0.9).unwrap();
        table.run(u64::MAX, 3000, &Control::default()).unwrap();
        table.run(2, 100, &Control::default()).unwrap();
        table
    }

    fn bytes_of(table: &WhiteTable) -> Vec<u8> {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("table.npz");
        table.save(&path).unwrap();
        fs::read(&path).unwrap()
    }

    fn load_bytes(bytes: &[u8]) -> Result<WhiteTable, TableError> {
        let path = Path::new("table.npz");
        WhiteTable::read(Reader::new(path, Cursor::new(bytes), bytes.len() as u64, &MEMBERS)?)
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
            out.start_file(name, zip::write::SimpleFileOptions::default().compression_method(method))
                .unwrap();
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
        let oblique = Entry::Pencil { cos_theta: 1.0 / 3.0 };
        for (parameters, radii, sectors) in [
            (base, vec![0.1, 0.2, 1e3], 1),
            (Parameters { phase_function: PhaseFunction::Rayleigh, thickness: 1e-3, ..base }, vec![], 1),
            (Parameters { phase_function: hg, entry: Entry::Cosine, spot_radius: 0.1, ..base }, vec![1.0], 5),
            (Parameters { eta: 1.4, entry: oblique, ..base }, vec![1e-15, 1e15], 720),
            (Parameters { entry: Entry::UniformCosine, thickness: f64::MAX, ..base }, vec![1.0], 1),
        ] {
            let bins = OrderBins::new(1.0).unwrap();
            let layout = Layout::with_order_bins(&radii, sectors, bins).unwrap();
            let mut table = WhiteTable::new(Problem::new(parameters).unwrap(), layout, 0.95).unwrap();
            for photons in [0, 2000] {
                table.run(3, photons, &Control::default()).unwrap();
                table.save(&path).unwrap();
                let back = WhiteTable::load(&path).unwrap();
                assert_eq!(back, table);
                assert_eq!(bytes_of(&back), fs::read(&path).unwrap());
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
            (
                "thickness",
                f64::INFINITY,
                "counts.npy: has the shape [2, 3, 2, 26], but must have [1, 3, 2, 26]",
            ),
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
            (
                "counts",
                "(2, 3, 2, 26)",
                "(2, 3, 52   )",
                "counts.npy: has the shape [2, 3, 52], but must have",
            ),
            ("radii", "(2,)", "(9,)", "radii.npy: has 16 bytes of data, but its shape [9] asks for 72"),
            (
                "radii",
                "(2,), }                    ",
                "(99999999999999999,), }    ",
                "radii.npy: has 16 bytes",
            ),
            ("radii", "(2,), }                    ", "(4611686018427387904,), }  ", "which is too large"),
            ("radii", "(2,)", "(  )", "radii.npy: has the shape [], but must have one dimension"),
            ("photon_ranges", "(2, 3)", "(3, 2)", "photon_ranges.npy: has the shape [3, 2], but"),
            ("entry", "|S6", "|S5", "entry.npy: has 6 bytes of data, but its shape [] asks for 5"),
            ("entry", "|S6", "<U6", "entry.npy: has the type \"<U6\", but must be \"|S\""),
            (
                "entry",
                "pencil",
                "Pencil",
                "entry.npy: is \"Pencil\", but must be one of pencil, cosine, uniform",
            ),
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
        fs::File::create(&path).unwrap().set_len(LONGEST + 1).unwrap();
        let error = WhiteTable::load(&path).unwrap_err().to_string();
        assert!(error.contains("has 83886081 bytes, but at most 83886080 are allowed"), "{error}");
        assert!(load_bytes(b"").unwrap_err().to_string().contains("is not an NPZ archive"));
        assert!(load_bytes(&[b'x'; 5000]).unwrap_err().to_string().contains("is not an NPZ archive"));
    }
}
