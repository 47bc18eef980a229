//! Tables of photons joined into one.

use std::path::{Path, PathBuf};

use translucid_files::{check_writable, write_atomically};
use translucid_reference::walk::{PhotonRange, TableError, WhiteTable};

use super::walk_method::table_failure;
use crate::failure::Failure;
use crate::files::input_among;
use crate::messages;
use crate::output_lock::OutputLock;

/// Most gaps that are listed one by one.
const GAPS_LISTED: usize = 20;

/// Joins tables into the one of all their photons, bit for bit that of one run, whatever their order.
///
/// There are never more than two of them in memory. With `allow_gaps` photons may be missing between the first and the
/// last of a seed.
///
/// # Errors
/// A table cannot be read, is of another walk, holds photons of another one or is to be written over, or photons are
/// missing. Nothing is written then.
pub(crate) fn merge_tables(out: &Path, parts: &[PathBuf], allow_gaps: bool) -> Result<(), Failure> {
    let [first, others @ ..] = parts else {
        return Err(Failure::input(String::from("there is no table to merge")));
    };
    check_writable(out)?;
    if let Some(path) = input_among([out].into_iter(), parts.iter().map(PathBuf::as_path)) {
        let message = format!("{} is one of the tables to merge, and would be overwritten", path.display());
        return Err(Failure::input(message).with_help("choose another file for the result"));
    }
    let _lock = OutputLock::take(out)?;

    let mut table = WhiteTable::load(first).map_err(table_failure)?;
    let mut held = vec![(first, table.photon_ranges().to_vec())];
    for path in others {
        let part = WhiteTable::load(path).map_err(table_failure)?;
        table.merge(&part).map_err(|error| refusal(error, first, path, &held))?;
        held.push((path, part.photon_ranges().to_vec()));
    }
    report_gaps(&table.gaps(), allow_gaps)?;
    write_atomically(out, |file| table.write(file)).map_err(Failure::late)
}

/// The reason why a table was not added, with the files that it is about.
fn refusal(error: TableError, first: &Path, path: &Path, held: &[(&PathBuf, Vec<PhotonRange>)]) -> Failure {
    match error {
        TableError::Differs { what, here, there } => Failure::input(format!(
            "{} and {} differ in {what}: {here} and {there}",
            first.display(),
            path.display()
        ))
        .with_help("only tables of one command can be merged, except for --photons and --seed"),
        TableError::Repeated(photons) => {
            let holds = |ranges: &[PhotonRange]| {
                ranges.iter().any(|range| {
                    range.seed == photons.seed && (range.start..range.end).contains(&photons.start)
                })
            };
            let other = held.iter().find(|(_, ranges)| holds(ranges)).map_or(first, |(path, _)| path);
            let message = format!("{} and {} both hold {photons}", other.display(), path.display());
            Failure::input(message).with_help("no photon counts twice: leave one of them out")
        }
        error => table_failure(error),
    }
}

/// Reports which photons are missing, and how to walk them.
fn report_gaps(gaps: &[PhotonRange], allow_gaps: bool) -> Result<(), Failure> {
    if gaps.is_empty() {
        return Ok(());
    }
    let options = |gap: &PhotonRange| format!("--photons {}..{} --seed {}", gap.start, gap.end, gap.seed);
    let mut list = gaps.iter().take(GAPS_LISTED).map(options).collect::<Vec<_>>().join(", ");
    if gaps.len() > GAPS_LISTED {
        list += &format!(" and {} more", gaps.len() - GAPS_LISTED);
    }
    let message = format!("photons are missing: {list}");
    if allow_gaps {
        messages::line(&message);
        return Ok(());
    }
    Err(Failure::work(message)
        .with_help("walk them and merge again, or merge without them with --allow-gaps"))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use translucid_reference::walk::{Control, Layout, OrderBins, Parameters, Problem};
    use translucid_testing::SplitMix;

    use super::*;

    /// Writes the table of some photons at an index of refraction.
    fn write(path: &Path, eta: f64, ranges: &[PhotonRange]) -> PathBuf {
        let problem = Problem::new(Parameters { eta, ..Parameters::default() }).unwrap();
        let layout = Layout::with_order_bins(&[0.1, 1.0], 2, OrderBins::new(1.0).unwrap()).unwrap();
        let mut table = WhiteTable::new(problem, layout, 0.9).unwrap();
        for &range in ranges {
            table.run_range(range, &Control::default()).unwrap();
        }
        write_atomically(path, |file| table.write(file)).unwrap();
        path.to_owned()
    }

    fn photons(seed: u64, start: u64, end: u64) -> PhotonRange {
        PhotonRange { seed, start, end }
    }

    /// Photons 0..3000 of seeds 4 and 5, cut at random places and dealt to up to nine parts, some without any.
    fn deal(random: &mut SplitMix, directory: &Path) -> Vec<PathBuf> {
        let mut parts = vec![Vec::new(); 1 + random.below(9)];
        for seed in [4, 5] {
            let mut cuts: Vec<u64> = (0..random.below(12)).map(|_| random.below(3001) as u64).collect();
            cuts.extend([0, 3000]);
            cuts.sort_unstable();
            for cut in cuts.windows(2) {
                let part = random.below(parts.len());
                parts[part].push(photons(seed, cut[0], cut[1]));
            }
        }
        let write = |(number, ranges): (usize, &Vec<_>)| {
            write(&directory.join(format!("part-{number}.npz")), 1.3, ranges)
        };
        parts.iter().enumerate().map(write).collect()
    }

    /// Whatever the split, the order, the groups and the tree of merges.
    #[test]
    fn merged_tables_are_bit_for_bit_that_of_one_run() {
        let directory = tempfile::tempdir().unwrap();
        let whole = [photons(4, 0, 3000), photons(5, 0, 3000)];
        let whole = fs::read(write(&directory.path().join("whole.npz"), 1.3, &whole)).unwrap();
        let mut random = SplitMix(21);
        for split in 0..40 {
            let mut parts = deal(&mut random, directory.path());
            let mut merges = 0;
            while parts.len() > 1 || merges == 0 {
                // Some parts from anywhere become one
                let count = (1 + random.below(4)).min(parts.len());
                let some: Vec<_> = (0..count).map(|_| parts.swap_remove(random.below(parts.len()))).collect();
                let is_last = parts.is_empty();
                let out = directory.path().join(format!("merged-{merges}.npz"));
                merge_tables(&out, &some, !is_last).unwrap();
                parts.push(out);
                merges += 1;
            }
            assert!(fs::read(&parts[0]).unwrap() == whole, "split {split}, {merges} merges");
        }
    }

    #[test]
    fn gaps_are_named_and_end_the_merge_unless_they_are_allowed() {
        let directory = tempfile::tempdir().unwrap();
        let path = |name: &str| directory.path().join(name);
        let parts = [
            write(&path("a.npz"), 1.0, &[photons(1, 10, 20), photons(2, 0, 5)]),
            write(&path("b.npz"), 1.0, &[photons(1, 25, 30)]),
        ];
        let failure = merge_tables(&path("out.npz"), &parts, false).unwrap_err();
        assert_eq!(failure.exit_code(), Some(1));
        let missing = "--photons 0..10 --seed 1, --photons 20..25 --seed 1";
        assert!(failure.message.ends_with(missing), "{}", failure.message);
        assert!(!path("out.npz").exists());
        merge_tables(&path("out.npz"), &parts, true).unwrap();
        assert_eq!(WhiteTable::load(&path("out.npz")).unwrap().photons(), 20);
    }

    /// Every fault: exit code 2, the message names the files and what is wrong, and no file has changed.
    #[test]
    fn faults_are_named_and_nothing_is_written() {
        let directory = tempfile::tempdir().unwrap();
        let path = |name: &str| directory.path().join(name);
        write(&path("a.npz"), 1.0, &[photons(1, 0, 10), photons(3, 0, 10)]);
        write(&path("b.npz"), 1.0, &[photons(1, 10, 20)]);
        write(&path("overlapping.npz"), 1.0, &[photons(1, 20, 30), photons(1, 4, 6)]);
        write(&path("foreign.npz"), 1.5, &[photons(1, 20, 30)]);
        let whole = fs::read(path("b.npz")).unwrap();
        fs::write(path("half.npz"), &whole[..whole.len() / 2]).unwrap();
        fs::write(path("empty.npz"), "").unwrap();
        let mut damaged = whole.clone();
        // In the counts, far from the directory at the end
        let at = damaged.len() / 2;
        damaged[at] ^= 1;
        fs::write(path("damaged.npz"), &damaged).unwrap();
        fs::write(path("newer.npz"), of_version(2, &whole)).unwrap();
        fs::write(path("out.npz"), "kept").unwrap();

        for (parts, named) in [
            (vec![], vec!["no table"]),
            (vec!["a.npz", "b.npz", "a.npz"], vec!["a.npz and", "both hold photons 0..10 of seed 1"]),
            (
                vec!["b.npz", "a.npz", "overlapping.npz"],
                vec!["a.npz and", "overlapping.npz", "photons 4..6 of seed 1"],
            ),
            (vec!["a.npz", "foreign.npz"], vec!["a.npz and", "foreign.npz", "eta", "1 and 1.5"]),
            (vec!["a.npz", "half.npz"], vec!["half.npz", "damaged"]),
            (vec!["a.npz", "empty.npz"], vec!["empty.npz"]),
            (vec!["a.npz", "damaged.npz"], vec!["damaged.npz"]),
            (vec!["newer.npz", "a.npz"], vec!["newer.npz", "version.npy", "is 2"]),
            (vec!["a.npz", "none.npz"], vec!["none.npz"]),
            (vec!["a.npz", "out.npz"], vec!["out.npz is one of the tables", "overwritten"]),
        ] {
            let files: Vec<_> = parts.iter().map(|name| path(name)).collect();
            let failure = merge_tables(&path("out.npz"), &files, true).unwrap_err();
            assert_eq!(failure.exit_code(), Some(2), "{parts:?}: {failure:?}");
            for word in named {
                assert!(failure.message.contains(word), "{parts:?}: {failure:?}");
            }
            assert_eq!(fs::read(path("out.npz")).unwrap(), b"kept", "{parts:?}");
        }
    }

    /// The archive with another number of version, its checksums set right.
    fn of_version(version: u64, archive: &[u8]) -> Vec<u8> {
        let find = |bytes: &[u8], from: usize| {
            (from..archive.len()).find(|&at| archive[at..].starts_with(bytes)).unwrap()
        };
        // The first member: a header of 128 bytes of NumPy's, then the number
        let member = find(b"\x93NUMPY", 0);
        let mut changed = archive.to_vec();
        changed[member + 128..][..8].copy_from_slice(&version.to_le_bytes());
        let checksums = [archive, &changed].map(|bytes| crc_32(&bytes[member..member + 136]).to_le_bytes());
        let mut from = 0;
        while let Some(at) = (from..archive.len()).find(|&at| archive[at..].starts_with(&checksums[0])) {
            changed[at..at + 4].copy_from_slice(&checksums[1]);
            from = at + 4;
        }
        changed
    }

    /// The checksum of ZIP files (IEEE 802.3), bit by bit.
    fn crc_32(bytes: &[u8]) -> u32 {
        let step = |crc: u32| if crc & 1 == 0 { crc >> 1 } else { (crc >> 1) ^ 0xedb8_8320 };
        !bytes.iter().fold(!0, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), |crc, _| step(crc)))
    }
}
