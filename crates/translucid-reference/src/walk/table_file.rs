//! Files of tables. `docs/guide/white-tables.md` describes every member.

use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::Path;

use super::device::Machine;
use super::layout::Layout;
use super::npz::{Reader, Writer, expect_shape};
use super::orders::{Cell, OrderBins};
use super::photon_exit::PhotonCounts;
use super::photon_ranges::{PhotonRange, PhotonRanges};
use super::problem::{Parameters, Problem};
use super::table_error::TableError;
use super::white_table::WhiteTable;
use crate::Incidence;
use crate::phase_function::PhaseFunction;

/// Version of the format, the only one that is written and read.
const VERSION: u64 = 1;
/// Length of the longest file that is read: two faces of most entries, and 16 MiB for all else.
const LONGEST: u64 = 2 * 16 * Layout::MOST_ENTRIES as u64 + (16 << 20);
/// Names of all members.
const MEMBERS: [&str; 19] = [
    "version",
    "machine",
    "phase_function",
    "phase_numbers",
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
const PENCIL: &str = "pencil";
const COSINE: &str = "cosine";
const MACHINES: [Machine; 2] = [Machine::Processor, Machine::Device];
const UNIFORM_COSINE: &str = "uniform-cosine";

impl WhiteTable {
    /// Writes the table as an NPZ archive, from which [`WhiteTable::read`] makes an equal one.
    ///
    /// `numpy.load` opens the archive; `docs/guide/white-tables.md` says what is in it. Equal tables make equal bytes.
    ///
    /// # Errors
    /// `out` does not take all bytes. A file written directly is then cut short: an application writes it beside its
    /// target first.
    pub fn write(&self, mut out: impl Write) -> io::Result<()> {
        let mut writer = Writer::new();
        self.write_members(&mut writer)?;
        out.write_all(&writer.finish()?)
    }

    /// Reads a table from a file.
    ///
    /// ```no_run
    /// use std::fs::File;
    /// use std::path::Path;
    /// use translucid_reference::walk::{Control, WhiteTable};
    ///
    /// // Double what is there.
    /// let mut table = WhiteTable::load(Path::new("half-space.npz"))?;
    /// table.run(1, table.photons(), &Control::default())?;
    /// table.write(File::create("doubled.npz")?)?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As for [`WhiteTable::read`], or it is not a regular file.
    pub fn load(path: &Path) -> Result<Self, TableError> {
        let unreadable = TableError::unreadable(path);
        // Before it is opened: opening a pipe waits for its other end
        if !fs::metadata(path).map_err(&unreadable)?.is_file() {
            return Err(unreadable(io::Error::other("it is not a regular file")));
        }
        Self::read(File::open(path).map_err(&unreadable)?, path)
    }

    /// Reads a table from the bytes of a file; errors call it by its path.
    ///
    /// # Errors
    /// The bytes cannot be read, are no such archive, more than 80 MiB, cut short, damaged (every member has a
    /// checksum) or of another version, or their numbers contradict each other.
    pub fn read(input: impl Read, path: &Path) -> Result<Self, TableError> {
        let mut reader = Reader::new(path, input, LONGEST, &MEMBERS)?;
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
        let machine = match reader.has("machine") {
            true => reader.text("machine", &MACHINES.map(Machine::name))?,
            false => Machine::default().name(),
        };
        let machine = MACHINES.into_iter().find(|known| known.name() == machine).unwrap_or_default();
        Self::with_contents(problem, layout, reference_albedo, ranges, counts, cells)
            .map(|table| table.with_machine(machine))
            .map_err(|error| reader.error("reference_albedo", error.to_string()))
    }

    fn write_members(&self, out: &mut Writer) -> io::Result<()> {
        // Write what was walked
        let Parameters { phase_function, eta, thickness, incidence, spot_radius } =
            self.problem().parameters();
        let g = if let PhaseFunction::HenyeyGreenstein { g } = phase_function { *g } else { 0.0 };
        let (incidence_name, cos_theta) = match incidence {
            Incidence::Pencil { cos_theta } => (PENCIL, *cos_theta),
            Incidence::Cosine => (COSINE, 1.0),
            Incidence::UniformCosine => (UNIFORM_COSINE, 1.0),
        };
        out.count("version", VERSION)?;
        // Left out in tables that have been written since before there were devices
        if self.machine() != Machine::Processor {
            out.text("machine", self.machine().name())?;
        }
        out.text("phase_function", phase_function.name())?;
        let numbers = phase_function.numbers();
        if !numbers.is_empty() {
            out.words(
                "phase_numbers",
                "<f8",
                &[numbers.len()],
                numbers.iter().map(|number| number.to_bits()),
            )?;
        }
        out.number("g", g)?;
        out.number("eta", *eta)?;
        out.number("thickness", *thickness)?;
        out.text("entry", incidence_name)?;
        out.number("cos_theta", cos_theta)?;
        out.number("spot_radius", *spot_radius)?;
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
    [problem.faces(), layout.rings(), layout.sectors(), layout.order_bins().len()]
}

fn read_problem(reader: &mut Reader) -> Result<Problem, TableError> {
    let g = reader.number("g")?;
    let phase_function = read_phase_function(reader, g)?;
    let cos_theta = reader.number("cos_theta")?;
    let incidence = match reader.text("entry", &[PENCIL, COSINE, UNIFORM_COSINE])? {
        PENCIL => Incidence::Pencil { cos_theta },
        other if cos_theta != 1.0 => {
            return Err(reader.error("cos_theta", format!("is {cos_theta}, but must be 1 with {other}")));
        }
        COSINE => Incidence::Cosine,
        _ => Incidence::UniformCosine,
    };
    let (eta, thickness) = (reader.number("eta")?, reader.number("thickness")?);
    let spot_radius = reader.number("spot_radius")?;
    Problem::new(Parameters { phase_function, eta, thickness, incidence, spot_radius })
        .map_err(|error| reader.error(error.parameter, error.to_string()))
}

fn read_phase_function(reader: &mut Reader, g: f64) -> Result<PhaseFunction, TableError> {
    let name = reader.text("phase_function", &PhaseFunction::KINDS)?;
    if name != PhaseFunction::KINDS[0] && g != 0.0 {
        return Err(reader.error("g", format!("is {g}, but must be 0 with {name}")));
    }
    let numbers = match reader.has("phase_numbers") {
        true => reader.words("phase_numbers", "<f8", one_dimension)?,
        false => Vec::new(),
    };
    let numbers: Vec<f64> = numbers.into_iter().map(f64::from_bits).collect();
    PhaseFunction::from_numbers(name, g, &numbers).map_err(|problem| reader.error("phase_numbers", problem))
}

fn one_dimension(shape: &[u64]) -> Result<(), String> {
    match shape {
        [_] => Ok(()),
        _ => Err(format!("has the shape {shape:?}, but must have one dimension")),
    }
}

fn read_layout(reader: &mut Reader) -> Result<Layout, TableError> {
    let radii: Vec<_> =
        reader.words("radii", "<f8", one_dimension)?.into_iter().map(f64::from_bits).collect();
    let sectors = reader.count("sectors")?;
    let sectors = fit(reader, "sectors", sectors)?;
    let words = reader.words("first_orders", "<u8", one_dimension)?;
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
fn fit(reader: &Reader, member: &str, word: u64) -> Result<u32, TableError> {
    u32::try_from(word)
        .map_err(|_| reader.error(member, format!("has {word}, but at most {} is allowed", u32::MAX)))
}

fn read_photons(reader: &mut Reader) -> Result<(PhotonRanges, PhotonCounts), TableError> {
    let three_columns = |shape: &[u64]| match shape {
        [_, 3] => Ok(()),
        _ => Err(format!("has the shape {shape:?}, but must have two dimensions, the second of 3")),
    };
    let words = reader.words("photon_ranges", "<u8", three_columns)?;
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

fn read_cells(reader: &mut Reader, problem: &Problem, layout: &Layout) -> Result<Vec<Cell>, TableError> {
    let shape = shape(problem, layout).map(|n| n as u64);
    let accept = |found: &[u64]| expect_shape(found, &shape);
    let [counts, order_sums] = ["counts", "order_sums"].map(|name| reader.words(name, "<u8", accept));
    let pairs = counts?.into_iter().zip(order_sums?);
    let cells: Vec<Cell> = pairs.map(|(count, order_sum)| Cell { count, order_sum }).collect();

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
fn check_sums(reader: &Reader, counts: &PhotonCounts, cells: &[Cell]) -> Result<(), TableError> {
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
mod damaged;
