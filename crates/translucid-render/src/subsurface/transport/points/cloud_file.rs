//! Points in a file, so that other pictures of the scene need not make them again.
//!
//! ```text
//! offset  bytes  content (little endian)
//!      0      8  magic "TRLPNTS\n"
//!      8      4  format version, u32
//!     12      8  fingerprint of all that decides the points, u64
//!     20      8  number of groups, number of points, u32 each
//!     28      …  per group: its number, its number of points, u32 each; spacing, f64
//!      …      …  per point: position, 3 f32; area, f32; normal, 3 f32; triangle, u32; irradiance, 3 f32
//!    end      4  CRC-32 of everything before, u32
//! ```

use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::path::Path;

use glam::Vec3;
use translucid_image::{Checksummed, OutputError, write_atomically};

use super::cloud::{CloudGroup, PointCloud};
use super::surfels::Surfel;

const MAGIC: [u8; 8] = *b"TRLPNTS\n";
const VERSION: u32 = 1;
const HEADER_BYTES: usize = 28;
const GROUP_BYTES: usize = 16;
const POINT_BYTES: usize = 44;

impl PointCloud {
    /// Writes the points so that [`load`](Self::load) gives back the same bits.
    ///
    /// # Errors
    /// The file cannot be written; an older one at `path` is then still whole.
    pub fn save(&self, path: &Path) -> Result<(), OutputError> {
        write_atomically(path, |out| {
            let mut out = Checksummed::new(out);
            out.write_all(&MAGIC)?;
            out.write_all(&VERSION.to_le_bytes())?;
            out.write_all(&self.fingerprint.to_le_bytes())?;
            out.write_all(&(self.groups.len() as u32).to_le_bytes())?;
            out.write_all(&(self.surfels.len() as u32).to_le_bytes())?;
            for group in &self.groups {
                out.write_all(&group.number.to_le_bytes())?;
                out.write_all(&group.count.to_le_bytes())?;
                out.write_all(&group.spacing.to_le_bytes())?;
            }
            for (surfel, light) in self.surfels.iter().zip(&self.irradiance) {
                out.write_all(&point_bytes(surfel, *light))?;
            }
            let (crc, out) = out.finish();
            out.write_all(&crc.to_le_bytes())
        })
    }

    /// Reads points back, if they belong to what has this fingerprint:
    /// [`PreparedScene::points_fingerprint`](crate::PreparedScene::points_fingerprint).
    ///
    /// # Errors
    /// The file cannot be read, is none of points, is cut short or damaged, or belongs to something else.
    pub fn load(path: &Path, expected_fingerprint: u64) -> Result<Self, OutputError> {
        let open = || -> io::Result<(File, u64)> {
            let file = File::open(path)?;
            let length = file.metadata()?.len();
            Ok((file, length))
        };
        let (file, length) = open().map_err(|error| unreadable(path, &error))?;
        parse(path, BufReader::with_capacity(1 << 16, file), length, expected_fingerprint)
    }
}

fn unreadable(path: &Path, error: &io::Error) -> OutputError {
    OutputError::new(path, format!("cannot read the points: {error}"))
        .with_help("see that it is there and may be read, or name another file")
}

fn point_bytes(surfel: &Surfel, light: Vec3) -> [u8; POINT_BYTES] {
    let [px, py, pz] = surfel.position.map(f32::to_bits);
    let [nx, ny, nz] = surfel.normal.map(f32::to_bits);
    let [r, g, b] = light.to_array().map(f32::to_bits);
    let words = [px, py, pz, surfel.area.to_bits(), nx, ny, nz, surfel.primitive, r, g, b];
    let mut bytes = [0; POINT_BYTES];
    for (bytes, word) in bytes.as_chunks_mut().0.iter_mut().zip(words) {
        *bytes = word.to_le_bytes();
    }
    bytes
}

fn point_of(bytes: &[u8; POINT_BYTES]) -> (Surfel, Vec3) {
    let word = |i: usize| u32::from_le_bytes(std::array::from_fn(|byte| bytes[4 * i + byte]));
    let number = |i: usize| f32::from_bits(word(i));
    let three = |i: usize| [number(i), number(i + 1), number(i + 2)];
    let surfel = Surfel { position: three(0), area: number(3), normal: three(4), primitive: word(7) };
    (surfel, three(8).into())
}

/// Reads a file of a known length.
fn parse(
    path: &Path,
    reader: impl Read,
    length: u64,
    expected_fingerprint: u64,
) -> Result<PointCloud, OutputError> {
    let unreadable = |error: io::Error| unreadable(path, &error);
    let damaged = |what: &str| {
        OutputError::new(path, format!("the file of points is damaged: {what}"))
            .with_help("delete it to make the points anew")
    };

    // Read and judge the header
    let mut file = Checksummed::new(reader);
    if length < (HEADER_BYTES + 4) as u64 {
        return Err(damaged(&format!("it ends after {length} bytes")));
    }
    let mut header = [0; HEADER_BYTES];
    file.read_exact(&mut header).map_err(unreadable)?;
    let four = |at: usize| u32::from_le_bytes(std::array::from_fn(|i| header[at + i]));
    if header[..8] != MAGIC {
        return Err(OutputError::new(path, "is no file of points").with_help("name another file"));
    }
    if four(8) != VERSION {
        return Err(OutputError::new(path, "the points were written by another version of translucid")
            .with_help("delete the file to make the points anew"));
    }
    let fingerprint = u64::from_le_bytes(std::array::from_fn(|i| header[12 + i]));
    // The length is compared before anything is allocated: a file cannot ask for more than it holds.
    let (groups, points) = (four(20), four(24));
    let bytes = |count: u32, each: usize| u64::from(count) * each as u64;
    let expected = (HEADER_BYTES + 4) as u64 + bytes(groups, GROUP_BYTES) + bytes(points, POINT_BYTES);
    if length != expected {
        return Err(damaged(&format!("it has {length} bytes instead of {expected}")));
    }

    // Read groups and points
    let mut cloud =
        PointCloud { fingerprint, groups: Vec::new(), surfels: Vec::new(), irradiance: Vec::new() };
    for _ in 0..groups {
        let mut bytes = [0; GROUP_BYTES];
        file.read_exact(&mut bytes).map_err(unreadable)?;
        let four = |at: usize| u32::from_le_bytes(std::array::from_fn(|i| bytes[at + i]));
        let spacing = f64::from_le_bytes(std::array::from_fn(|i| bytes[8 + i]));
        cloud.groups.push(CloudGroup { number: four(0), count: four(4), spacing });
    }
    for _ in 0..points {
        let mut bytes = [0; POINT_BYTES];
        file.read_exact(&mut bytes).map_err(unreadable)?;
        let (surfel, light) = point_of(&bytes);
        cloud.surfels.push(surfel);
        cloud.irradiance.push(light);
    }
    let (crc, mut file) = file.finish();
    let mut stored = [0; 4];
    file.read_exact(&mut stored).map_err(unreadable)?;
    if crc != u32::from_le_bytes(stored) {
        return Err(damaged("its checksum does not fit its content"));
    }
    if let Some(what) = defect(&cloud) {
        return Err(damaged(what));
    }
    if fingerprint != expected_fingerprint {
        return Err(OutputError::new(path, "the points belong to another scene or other settings").with_help(
            "delete the file to make the points anew, or name another one; camera, film and samples may change",
        ));
    }
    Ok(cloud)
}

/// What a cloud must not have.
fn defect(cloud: &PointCloud) -> Option<&'static str> {
    let counted: u64 = cloud.groups.iter().map(|group| u64::from(group.count)).sum();
    if counted != cloud.surfels.len() as u64 {
        return Some("its groups do not hold its points");
    }
    if cloud.groups.iter().any(|group| !(group.spacing > 0.0 && group.spacing.is_finite())) {
        return Some("a spacing is no length");
    }
    let is_sound = |(surfel, light): (&Surfel, &Vec3)| {
        let area = surfel.area > 0.0 && surfel.area.is_finite();
        let light = light.is_finite() && light.min_element() >= 0.0;
        area && light && surfel.position().is_finite() && surfel.normal().is_finite()
    };
    let all_sound = cloud.surfels.iter().zip(&cloud.irradiance).all(is_sound);
    (!all_sound).then_some("a point has no place, area or light")
}

#[cfg(test)]
mod tests {
    use super::*;

    const FINGERPRINT: u64 = 0x1234_5678_9abc_def0;

    fn cloud() -> PointCloud {
        let surfel = |i: u32| {
            let x = i as f32;
            Surfel { position: [x, -x, 1e9], area: 1.0 / (x + 1.0), normal: [0.0, 0.6, 0.8], primitive: i }
        };
        PointCloud {
            fingerprint: FINGERPRINT,
            groups: [(0, 3), (7, 2)]
                .map(|(number, count)| CloudGroup { number, count, spacing: 0.5 })
                .to_vec(),
            surfels: (0..5).map(surfel).collect(),
            irradiance: (0..5).map(|i| Vec3::new(0.0, 1e-30, i as f32)).collect(),
        }
    }

    fn saved() -> Vec<u8> {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.points");
        cloud().save(&path).unwrap();
        assert_eq!(PointCloud::load(&path, FINGERPRINT).unwrap(), cloud());
        std::fs::read(&path).unwrap()
    }

    fn parsed(bytes: &[u8]) -> Result<PointCloud, OutputError> {
        parse(Path::new("a.points"), bytes, bytes.len() as u64, FINGERPRINT)
    }

    /// The bytes with a checksum that fits.
    fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
        let end = bytes.len() - 4;
        let crc = crc32fast::hash(&bytes[..end]);
        bytes[end..].copy_from_slice(&crc.to_le_bytes());
        bytes
    }

    #[test]
    fn load_refuses_every_truncation_and_every_flipped_bit() {
        let bytes = saved();
        for length in 0..bytes.len() {
            let error = parsed(&bytes[..length]).unwrap_err();
            assert!(error.to_string().contains("a.points") && error.help.is_some(), "{error}");
        }
        for bit in 0..bytes.len() * 8 {
            let mut bytes = bytes.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            assert!(parsed(&bytes).is_err(), "bit {bit}");
        }
        assert!(parsed(&[&bytes[..], b"x"].concat()).is_err());
    }

    #[test]
    fn load_refuses_hostile_files_whose_checksum_fits() {
        let bytes = saved();
        for (at, word) in [
            (20, u32::MAX),
            (24, u32::MAX),
            (32, 4),
            (36, f32::NAN.to_bits()),
            (HEADER_BYTES + 2 * GROUP_BYTES, f32::INFINITY.to_bits()),
            (HEADER_BYTES + 2 * GROUP_BYTES + 12, 0),
            (HEADER_BYTES + 2 * GROUP_BYTES + 40, (-1.0_f32).to_bits()),
        ] {
            let mut bytes = bytes.clone();
            bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
            if at == 36 {
                bytes[36..44].copy_from_slice(&f64::NAN.to_le_bytes());
            }
            let error = parsed(&sealed(bytes)).unwrap_err();
            assert!(error.message.contains("damaged"), "{at}: {error}");
        }
    }

    #[test]
    fn load_tells_what_does_not_belong() {
        let mut bytes = saved();
        let error = parse(Path::new("a"), &bytes[..], bytes.len() as u64, 1).unwrap_err();
        assert!(error.message.contains("another scene") && error.help.is_some(), "{error}");
        bytes[8] = 9;
        assert!(parsed(&sealed(bytes)).unwrap_err().message.contains("another version"));
        assert!(parsed(&[b'x'; 200]).unwrap_err().message.contains("no file of points"));
    }
}
