//! Points in a file, so that other pictures of the scene need not make them again.
//!
//! The data of the [`KeptFile`]:
//!
//! ```text
//! offset  bytes  content (little endian)
//!     20     24  numbers of groups, points, irradiances, darks, sums and counts, u32 each
//!     44      …  groups: number, number of points, u32 each; spacing, width of pixels, f64 each
//!      …      …  points: position, 3 f32; area, f32; normal, 3 f32; triangle, u32
//!      …      …  irradiances, one for each point if the light is finished: 3 f32
//!      …      …  darks, one for each group if it is known what counts as dark: 3 f64
//!      …      …  sums, one for each point if the light is begun: two halves of 3 f64
//!      …      …  counts, one for each cluster of points if the light is begun: u32
//! ```

use std::io;
use std::path::Path;

use bytemuck::{Pod, bytes_of, cast_slice};
use glam::{DVec3, Vec3};
use translucid_image::{KeptData, KeptFile, OutputError, damaged};

use super::cloud::{CloudGroup, PointCloud};
use super::irradiance::{BegunLight, MOST_SAMPLES, PointLight};
use super::surfels::Surfel;

const FORMAT: KeptFile =
    KeptFile { magic: *b"TRLPNTS\n", version: 2, name: "file of points", anew: "make the points anew" };

impl PointCloud {
    /// Writes the points so that [`load`](Self::load) gives back the same bits.
    ///
    /// # Errors
    /// The file cannot be written; an older one at `path` is then still whole.
    pub fn save(&self, path: &Path) -> Result<(), OutputError> {
        let nothing = BegunLight::default();
        let (irradiance, begun) = match &self.light {
            PointLight::Finished(irradiance) => (&irradiance[..], &nothing),
            PointLight::Begun(begun) => (&[][..], begun),
        };
        let BegunLight { dark, sums, counts } = begun;
        let lengths =
            [self.groups.len(), self.surfels.len(), irradiance.len(), dark.len(), sums.len(), counts.len()];
        FORMAT.save(path, self.fingerprint, |out| {
            out.write_all(bytes_of(&lengths.map(|length| length as u32)))?;
            out.write_all(cast_slice(&self.groups))?;
            out.write_all(cast_slice(&self.surfels))?;
            out.write_all(cast_slice(irradiance))?;
            out.write_all(cast_slice(dark))?;
            out.write_all(cast_slice(sums))?;
            out.write_all(cast_slice(counts))
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
    let lengths: [u32; 6] = data.read()?;
    let each = [
        size_of::<CloudGroup>(),
        size_of::<Surfel>(),
        size_of::<Vec3>(),
        size_of::<DVec3>(),
        size_of::<[DVec3; 2]>(),
        size_of::<u32>(),
    ];
    let bytes: u64 = lengths.iter().zip(each).map(|(&length, each)| u64::from(length) * each as u64).sum();
    data.require_length(size_of_val(&lengths) as u64 + bytes)?;
    let [groups, points, irradiance, dark, sums, counts] = lengths.map(|length| length as usize);
    let (groups, surfels, irradiance) =
        (values(data, groups)?, values(data, points)?, values(data, irradiance)?);
    let begun =
        BegunLight { dark: values(data, dark)?, sums: values(data, sums)?, counts: values(data, counts)? };
    let is_begun = begun != BegunLight::default();
    let light = if irradiance.is_empty() {
        PointLight::Begun(begun)
    } else if is_begun {
        return Err(damaged("its light is finished and is not"));
    } else {
        PointLight::Finished(irradiance)
    };
    let cloud = PointCloud { fingerprint: 0, groups, surfels, light };
    defect(&cloud).map_or(Ok(cloud), |what| Err(damaged(what)))
}

fn values<T: Pod>(data: &mut KeptData<'_>, count: usize) -> io::Result<Vec<T>> {
    let mut values = vec![T::zeroed(); count];
    data.fill(&mut values)?;
    Ok(values)
}

/// The first defect of a cloud, if it has any.
fn defect(cloud: &PointCloud) -> Option<&'static str> {
    let PointCloud { groups, surfels, light, .. } = cloud;
    let counted: u64 = groups.iter().map(|group| u64::from(group.count)).sum();
    if counted != surfels.len() as u64 {
        return Some("its groups do not hold its points");
    }
    let is_length = |length: f64| length >= 0.0 && length.is_finite();
    if !groups.iter().all(|g| is_length(g.spacing) && g.spacing > 0.0 && is_length(g.pixel_width)) {
        return Some("a spacing is no length");
    }
    let is_placed =
        |s: &Surfel| s.area > 0.0 && s.area.is_finite() && s.position().is_finite() && s.normal().is_finite();
    let is_lit = match light {
        PointLight::Finished(irradiance) => {
            let is_light = |light: &Vec3| light.is_finite() && light.min_element() >= 0.0;
            irradiance.len() == surfels.len() && irradiance.iter().all(is_light)
        }
        PointLight::Begun(BegunLight { dark, sums, counts }) => {
            let clusters = BegunLight::clusters(groups.iter().map(|group| group.count as usize));
            let fits = |length: usize, whole: usize| length == 0 || length == whole;
            let is_light = |light: &DVec3| light.is_finite() && light.min_element() >= 0.0;
            fits(dark.len(), groups.len())
                && fits(sums.len(), surfels.len())
                && fits(counts.len(), clusters)
                && sums.is_empty() == counts.is_empty()
                && dark.iter().chain(sums.iter().flatten()).all(is_light)
                && counts.iter().all(|&count| count <= MOST_SAMPLES)
        }
    };
    (!(is_lit && surfels.iter().all(is_placed))).then_some("a point has no place, area or light")
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    const FINGERPRINT: u64 = 0x1234_5678_9abc_def0;

    fn cloud(light: PointLight) -> PointCloud {
        let surfel = |i: u32| {
            let x = i as f32;
            Surfel { position: [x, -x, 1e9], area: 1.0 / (x + 1.0), normal: [0.0, 0.6, 0.8], primitive: i }
        };
        PointCloud {
            fingerprint: FINGERPRINT,
            groups: [(0, 3), (7, 2)]
                .map(|(number, count)| CloudGroup { number, count, spacing: 0.5, pixel_width: 0.25 })
                .to_vec(),
            surfels: (0..5).map(surfel).collect(),
            light,
        }
    }

    fn finished() -> PointLight {
        PointLight::Finished((0..5).map(|i| Vec3::new(0.0, 1e-30, i as f32)).collect())
    }

    fn begun() -> PointLight {
        let sums = (0..5).map(|i| [DVec3::splat(f64::from(i)), DVec3::X]).collect();
        PointLight::Begun(BegunLight { dark: vec![DVec3::Y; 2], counts: vec![8, 9], sums })
    }

    fn saved(light: PointLight) -> Vec<u8> {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.points");
        cloud(light.clone()).save(&path).unwrap();
        assert_eq!(PointCloud::load(&path, FINGERPRINT).unwrap(), cloud(light));
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
        // Groups begin at 44, points at 44 + 2 · 24, the light at 92 + 5 · 32
        let corrupt = |light: PointLight, at: usize, word: u32| {
            let mut bytes = saved(light);
            bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
            let error = parsed(&sealed(bytes)).unwrap_err();
            assert!(error.message.contains("damaged"), "{at}: {error}");
        };
        for (at, word) in [
            (20, u32::MAX),
            (24, u32::MAX),
            (48, 4),
            (56, f64::NAN.to_bits() as u32 | 0x7ff0_0000),
            (64, 0xfff0_0000),
            (92, f32::INFINITY.to_bits()),
            (92 + 12, 0),
            (252, (-1.0_f32).to_bits()),
        ] {
            corrupt(finished(), at, word);
        }
        let end = saved(begun()).len() - 4;
        for (at, word) in
            [(28, 1), (40, 1), (252 + 4, 0xbff0_0000), (300 + 4, 0x7ff0_0000), (end - 4, u32::MAX)]
        {
            corrupt(begun(), at, word);
        }
    }
}
