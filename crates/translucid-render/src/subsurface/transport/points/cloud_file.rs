//! Points in a file, so that other pictures of the scene need not make them again.
//!
//! The data of the [`KeptFile`]:
//!
//! ```text
//! offset  bytes  content (little endian)
//!     20      8  number of groups, number of points, u32 each
//!     28      …  per group: its number, its number of points, u32 each; spacing, f64
//!      …      …  per point: position, 3 f32; area, f32; normal, 3 f32; triangle, u32; irradiance, 3 f32
//! ```

use std::io;
use std::path::Path;

use bytemuck::{Zeroable, bytes_of, cast_slice};
use translucid_image::{KeptData, KeptFile, OutputError, damaged};

use super::cloud::{CloudGroup, PointCloud};
use super::surfels::Surfel;

const FORMAT: KeptFile =
    KeptFile { magic: *b"TRLPNTS\n", version: 1, name: "file of points", anew: "make the points anew" };

impl PointCloud {
    /// Writes the points so that [`load`](Self::load) gives back the same bits.
    ///
    /// # Errors
    /// The file cannot be written; an older one at `path` is then still whole.
    pub fn save(&self, path: &Path) -> Result<(), OutputError> {
        FORMAT.save(path, self.fingerprint, |out| {
            out.write_all(bytes_of(&[self.groups.len() as u32, self.surfels.len() as u32]))?;
            out.write_all(cast_slice(&self.groups))?;
            self.surfels.iter().zip(&self.irradiance).try_for_each(|(surfel, light)| {
                out.write_all(bytes_of(surfel))?;
                out.write_all(bytes_of(light))
            })
        })
    }

    /// Reads points back, if they belong to what has this fingerprint:
    /// [`PreparedScene::points_fingerprint`](crate::PreparedScene::points_fingerprint).
    ///
    /// # Errors
    /// The file cannot be read, is none of points, is cut short or damaged, or belongs to something else.
    pub fn load(path: &Path, expected_fingerprint: u64) -> Result<Self, OutputError> {
        let cloud = FORMAT.load(path, expected_fingerprint, read)?;
        Ok(Self { fingerprint: expected_fingerprint, ..cloud })
    }
}

fn read(data: &mut KeptData<'_>) -> io::Result<PointCloud> {
    let [groups, points]: [u32; 2] = data.read()?;
    let bytes = |count: u32, each: usize| u64::from(count) * each as u64;
    let point_bytes = size_of::<Surfel>() + size_of::<[f32; 3]>();
    data.require_length(8 + bytes(groups, size_of::<CloudGroup>()) + bytes(points, point_bytes))?;
    let mut cloud = PointCloud {
        fingerprint: 0,
        groups: vec![CloudGroup::zeroed(); groups as usize],
        surfels: Vec::new(),
        irradiance: Vec::new(),
    };
    data.fill(&mut cloud.groups)?;
    for _ in 0..points {
        cloud.surfels.push(data.read()?);
        cloud.irradiance.push(data.read()?);
    }
    defect(&cloud).map_or(Ok(cloud), |what| Err(damaged(what)))
}

/// The first defect of a cloud, if it has any.
fn defect(cloud: &PointCloud) -> Option<&'static str> {
    let counted: u64 = cloud.groups.iter().map(|group| u64::from(group.count)).sum();
    if counted != cloud.surfels.len() as u64 {
        return Some("its groups do not hold its points");
    }
    if cloud.groups.iter().any(|group| !(group.spacing > 0.0 && group.spacing.is_finite())) {
        return Some("a spacing is no length");
    }
    let is_sound = |(surfel, light): (&Surfel, &glam::Vec3)| {
        let area = surfel.area > 0.0 && surfel.area.is_finite();
        let light = light.is_finite() && light.min_element() >= 0.0;
        area && light && surfel.position().is_finite() && surfel.normal().is_finite()
    };
    let all_sound = cloud.surfels.iter().zip(&cloud.irradiance).all(is_sound);
    (!all_sound).then_some("a point has no place, area or light")
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

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
        FORMAT.parse(Path::new("a.points"), bytes, bytes.len() as u64, FINGERPRINT, read)
    }

    /// The bytes with a checksum that fits.
    fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
        let end = bytes.len() - 4;
        let crc = crc32fast::hash(&bytes[..end]);
        bytes[end..].copy_from_slice(&crc.to_le_bytes());
        bytes
    }

    #[test]
    fn load_refuses_hostile_files_whose_checksum_fits() {
        let bytes = saved();
        for (at, word) in [
            (20, u32::MAX),
            (24, u32::MAX),
            (32, 4),
            (36, f32::NAN.to_bits()),
            (60, f32::INFINITY.to_bits()),
            (60 + 12, 0),
            (60 + 40, (-1.0_f32).to_bits()),
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
}
