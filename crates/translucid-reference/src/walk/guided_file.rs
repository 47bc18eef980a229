//! Files of guided walks. `docs/guide/guided-walks.md` describes every member.

use std::io::{self, Read, Seek, Write};
use std::path::Path;

use super::guided::GuidedWalk;
use super::npz::{Reader, Writer, expect_shape};
use super::photon_ranges::{PhotonRange, PhotonRanges};
use super::whole_file::write_whole;
use super::{Parameters, Problem, TableError};
use crate::Entry;

const VERSION: u64 = 1;
const METHOD: &str = "guided";
const PENCIL: &str = "pencil";
const COSINE: &str = "cosine";
const UNIFORM_COSINE: &str = "uniform-cosine";
/// Longest file that is read.
const LONGEST: u64 = 64 << 20;
const MEMBERS: [&str; 8] = [
    "version",
    "method",
    "entry",
    "single_scattering_albedo",
    "radii",
    "photon_ranges",
    "collisions",
    "sums",
];

impl GuidedWalk {
    /// Writes the walk to a file from which [`GuidedWalk::load`] makes an equal one: an NPZ archive, which
    /// `numpy.load` opens; `docs/guide/guided-walks.md` says what is in it. It is written beside its target and then renamed.
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

    /// Reads a walk from a file.
    ///
    /// # Errors
    /// The file cannot be read, is not such an archive, is longer than 64 MiB, cut short, damaged or of another
    /// version, or its numbers contradict each other.
    pub fn load(path: &Path) -> Result<Self, TableError> {
        Self::read(Reader::open(path, LONGEST, &MEMBERS)?)
    }

    fn write<W: Write + Seek>(&self, out: &mut Writer<W>) -> io::Result<()> {
        let entry = match self.problem().parameters().entry {
            Entry::Pencil { .. } => PENCIL,
            Entry::Cosine => COSINE,
            Entry::UniformCosine => UNIFORM_COSINE,
        };
        out.count("version", VERSION)?;
        out.text("method", METHOD)?;
        out.text("entry", entry)?;
        out.number("single_scattering_albedo", self.single_scattering_albedo())?;
        out.words("radii", "<f8", &[self.radii().len()], self.radii().iter().map(|r| r.to_bits()))?;
        let ranges = self.photon_ranges();
        let numbers = ranges.iter().flat_map(|range| [range.seed, range.start, range.end]);
        out.words("photon_ranges", "<u8", &[ranges.len(), 3], numbers)?;
        out.count("collisions", self.tally().collisions())?;
        let sums = self.tally().numbers();
        let halves = |number: &i128| [*number as u64, (*number >> 64) as u64];
        out.words("sums", "<u8", &[sums.len(), 4], sums.iter().flatten().flat_map(halves))
    }

    fn read<R: Read + Seek>(mut reader: Reader<R>) -> Result<Self, TableError> {
        let version = reader.count("version")?;
        if version != VERSION {
            let problem = format!("is {version}, but only version {VERSION} is known");
            return Err(reader.error("version", problem));
        }
        reader.text("method", &[METHOD])?;
        let entry = match reader.text("entry", &[PENCIL, COSINE, UNIFORM_COSINE])? {
            PENCIL => Entry::NORMAL,
            COSINE => Entry::Cosine,
            _ => Entry::UniformCosine,
        };
        let alpha = reader.number("single_scattering_albedo")?;
        let one_dimension = |shape: &[u64]| match shape {
            [_] => Ok(()),
            _ => Err(format!("has the shape {shape:?}, but must have one dimension")),
        };
        let radii: Vec<_> =
            reader.list("radii", "<f8", one_dimension)?.into_iter().map(f64::from_bits).collect();
        let problem = Problem::new(Parameters { entry, ..Parameters::default() })?;
        let walk = Self::new(&problem, alpha, &radii).map_err(|error| {
            let member = if error.parameter == "radius" { "radii" } else { "single_scattering_albedo" };
            reader.error(member, error.to_string())
        })?;

        let ranges = read_ranges(&mut reader)?;
        let photons = ranges.len().unwrap_or(u64::MAX);
        let collisions = reader.count("collisions")?;
        if collisions < photons {
            return Err(
                reader.error("collisions", format!("is {collisions}, but must be at least {photons}"))
            );
        }
        let shape = [walk.tally().numbers().len() as u64, 4];
        let words = reader.list("sums", "<u8", |found| expect_shape(found, &shape))?;
        let number = |low: u64, high: u64| (i128::from(high as i64) << 64) | i128::from(low);
        let sums: Vec<_> =
            words.as_chunks().0.iter().map(|&[a, b, c, d]| [number(a, b), number(c, d)]).collect();
        let tally = walk.tally().with_numbers(photons / Self::CHUNK, collisions, &sums);
        let tally = tally.map_err(|problem| reader.error("sums", problem))?;
        Ok(walk.with_contents(ranges, tally))
    }
}

fn read_ranges<R: Read + Seek>(reader: &mut Reader<R>) -> Result<PhotonRanges, TableError> {
    let three_columns = |shape: &[u64]| match shape {
        [_, 3] => Ok(()),
        _ => Err(format!("has the shape {shape:?}, but must have two dimensions, the second of 3")),
    };
    let words = reader.list("photon_ranges", "<u8", three_columns)?;
    let rows = words.as_chunks().0.iter().map(|&[seed, start, end]| PhotonRange { seed, start, end });
    let whole = |range: &PhotonRange| {
        let ends = [range.start, range.end];
        range.start < range.end
            && range.end <= GuidedWalk::LAST_PHOTON
            && ends.iter().all(|n| n % GuidedWalk::CHUNK == 0)
    };
    if let Some(PhotonRange { start, end, .. }) = rows.clone().find(|range| !whole(range)) {
        let problem =
            format!("has a range from {start} to {end}, but both must be multiples of 1024, in order");
        return Err(reader.error("photon_ranges", problem));
    }
    let twice = |range| reader.error("photon_ranges", format!("has {range} twice"));
    let ranges = PhotonRanges::new(rows).map_err(twice)?;
    match ranges.len() {
        Some(photons) if photons <= GuidedWalk::LAST_PHOTON => Ok(ranges),
        _ => Err(reader.error("photon_ranges", "has more than 2^63 photons")),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::io::Cursor;

    use super::super::Control;
    use super::*;

    fn small_walk() -> GuidedWalk {
        let problem = Problem::new(Parameters { entry: Entry::Cosine, ..Parameters::default() }).unwrap();
        let mut walk = GuidedWalk::new(&problem, 1.0 / 3.0, &[0.1, 1.0 / 7.0, 1e6]).unwrap();
        walk.run(u64::MAX, 3000, &Control::default()).unwrap();
        walk.run(2, 9000, &Control::default()).unwrap();
        walk
    }

    fn bytes_of(walk: &GuidedWalk) -> Vec<u8> {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("walk.npz");
        walk.save(&path).unwrap();
        fs::read(&path).unwrap()
    }

    fn load_bytes(bytes: &[u8]) -> Result<GuidedWalk, TableError> {
        let path = Path::new("walk.npz");
        GuidedWalk::read(Reader::new(path, Cursor::new(bytes), bytes.len() as u64, &MEMBERS)?)
    }

    #[test]
    fn walk_survives_its_file() {
        let walk = small_walk();
        let mut loaded = load_bytes(&bytes_of(&walk)).unwrap();
        assert_eq!(loaded.tally(), walk.tally());
        assert_eq!(loaded.photon_ranges(), walk.photon_ranges());
        assert_eq!((loaded.problem(), loaded.radii()), (walk.problem(), walk.radii()));
        assert_eq!(loaded.single_scattering_albedo(), walk.single_scattering_albedo());
        assert_eq!(bytes_of(&loaded), bytes_of(&walk));
        // It goes on as if there had been no file
        let mut longer = walk.clone();
        longer.run(2, 5000, &Control::default()).unwrap();
        loaded.run(2, 5000, &Control::default()).unwrap();
        assert_eq!(loaded.tally(), longer.tally());
    }

    #[test]
    fn empty_walk_survives_its_file() {
        let problem = Problem::new(Parameters::default()).unwrap();
        let walk = GuidedWalk::new(&problem, 0.5, &[]).unwrap();
        assert_eq!(load_bytes(&bytes_of(&walk)).unwrap().tally(), walk.tally());
    }

    /// Every byte, one bit of it changed: an error, or (in what the archive does not use) the same walk.
    #[test]
    fn damaged_file_is_an_error() {
        let walk = small_walk();
        let bytes = bytes_of(&walk);
        let mut refused = 0;
        for at in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[at] ^= 1 << (at % 8);
            match load_bytes(&damaged) {
                Ok(loaded) => {
                    assert_eq!((loaded.tally(), loaded.radii()), (walk.tally(), walk.radii()), "byte {at}");
                    assert_eq!(loaded.photon_ranges(), walk.photon_ranges());
                }
                Err(error) => refused += usize::from(!error.to_string().is_empty()),
            }
        }
        assert!(refused > bytes.len() / 2);
        for length in (0..bytes.len()).step_by(97) {
            assert!(load_bytes(&bytes[..length]).is_err());
        }
    }

    #[test]
    fn impossible_numbers_are_an_error() {
        let walk = small_walk();
        let numbers = walk.tally().numbers();
        let chunks = walk.photons() / GuidedWalk::CHUNK;
        assert!(walk.tally().with_numbers(chunks, 1 << 20, &numbers).is_ok());
        for (row, column, number) in [(0, 1, -1), (0, 0, 1 << 90), (3, 0, i128::MIN), (5, 1, 1)] {
            let mut wrong = numbers.clone();
            wrong[row][column] = number;
            assert!(walk.tally().with_numbers(chunks, 1 << 20, &wrong).is_err(), "{row} {column}");
        }
    }
}
