//! The memory that a rendering needs, checked beforehand: the system would end the process without a message.

use std::collections::HashMap;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use translucid_image::PixelRect;
use translucid_scene::{Mesh, Scene, SceneError};

use super::Session;
use crate::ray::TRIANGLES_AT_ONCE;
use crate::world::{PixelSample, layer};

/// Memory that each triangle takes besides its mesh while the tree over all is built: 110 bytes each for ten million
/// triangles on two threads, those in work included.
const BYTES_PER_TRIANGLE: u64 = 116;
/// Additional memory for each triangle whose part of the tree is in work: 281 bytes each in all for a million triangles, all
/// of them in work on eight threads.
const BYTES_IN_WORK: u64 = 180;
/// Memory that each object takes, however many share its mesh.
const BYTES_PER_OBJECT: u64 = 512;
/// Address space that the C library sets aside for each thread that takes memory.
const BYTES_PER_THREAD: u64 = 64 << 20;

/// Memory that this process can still have, in bytes: the least that the system has without swapping, the limit on its
/// address space (`ulimit -v`) and those of its control groups leave; `None` where the system does not report any.
pub fn available_memory() -> Option<u64> {
    let read = |path: &str| fs::read_to_string(path).unwrap_or_default();
    let free = kilobytes(&read("/proc/meminfo"), "MemAvailable:");
    let space = room_in_address_space(&read("/proc/self/limits"), &read("/proc/self/status"));
    let groups = room_in_control_groups(&read("/proc/self/cgroup"), Path::new("/sys/fs/cgroup"));
    [free, space, groups].into_iter().flatten().min()
}

/// The number after a key of a file in /proc, in bytes.
fn kilobytes(text: &str, key: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    Some(line.split_whitespace().next()?.parse::<u64>().ok()? * 1024)
}

/// Memory that the limit on the address space leaves, when each thread has taken its own.
fn room_in_address_space(limits: &str, status: &str) -> Option<u64> {
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    let limit: u64 = line.split_whitespace().next()?.parse().ok()?;
    let threads =
        status.lines().find_map(|line| line.strip_prefix("Threads:"))?.trim().parse::<u64>().ok()?;
    let taken = kilobytes(status, "VmSize:")? + threads * BYTES_PER_THREAD;
    Some(limit.saturating_sub(taken))
}

/// Memory that the limits of the process's control groups leave: groups of version 1 and 2, and those around them. A
/// container may see its own group as the root of all.
fn room_in_control_groups(groups: &str, root: &Path) -> Option<u64> {
    let number = |path: &Path| fs::read_to_string(path).ok()?.trim().parse::<u64>().ok();
    let mut least = None;
    for line in groups.lines() {
        let mut fields = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(group)) = (fields.next(), fields.next()) else { continue };
        let (root, limit, usage, cache) = if controllers.is_empty() {
            (root.to_owned(), "memory.max", "memory.current", "inactive_file ")
        } else if controllers.split(',').any(|name| name == "memory") {
            let files = ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file ");
            (root.join("memory"), files.0, files.1, files.2)
        } else {
            continue;
        };
        let group = Path::new(group.trim_start_matches('/'));
        for directory in group.ancestors().map(|group| root.join(group)) {
            let Some(limit) = number(&directory.join(limit)) else { continue };
            let used = number(&directory.join(usage)).unwrap_or(0);
            let statistics = fs::read_to_string(directory.join("memory.stat")).unwrap_or_default();
            // Pages of files that nobody has used for long make room
            let cached = statistics.lines().find_map(|line| line.strip_prefix(cache)?.parse::<u64>().ok());
            let room = limit.saturating_sub(used.saturating_sub(cached.unwrap_or(0)));
            least = Some(least.map_or(room, |least: u64| least.min(room)));
        }
    }
    least
}

impl Session {
    /// Memory that a pixel takes while it is rendered: its sums, and a sample that waits. Denoising and writing take
    /// less.
    pub const BYTES_PER_PIXEL: u64 = (8 * layer::COUNT + size_of::<PixelSample>()) as u64;

    /// Refuses scenes and pictures that take more memory than this process can have, before anything is built.
    ///
    /// # Errors
    /// They do; the message has the numbers.
    pub fn require_memory(scene: &Scene, pixels: PixelRect, bytes_per_pixel: u64) -> Result<(), SceneError> {
        let mut uses: HashMap<usize, (&Mesh, usize)> = HashMap::new();
        for object in &scene.objects {
            uses.entry(Arc::as_ptr(&object.mesh).addr()).or_insert((&object.mesh, 0)).1 += 1;
        }
        let copies = |mesh: &Mesh, uses: usize| if mesh.is_worth_sharing(uses) { 1 } else { uses };
        let triangles: usize =
            uses.values().map(|&(mesh, uses)| mesh.triangles.len() * copies(mesh, uses)).sum();
        let triangles = triangles as u64;
        let in_work = triangles.min(rayon::current_num_threads() as u64 * TRIANGLES_AT_ONCE as u64);
        let of_scene = triangles * BYTES_PER_TRIANGLE
            + in_work * BYTES_IN_WORK
            + scene.objects.len() as u64 * BYTES_PER_OBJECT;
        let of_pixels = pixels.area().saturating_mul(bytes_per_pixel);
        let needed = of_scene.saturating_add(of_pixels);
        let has_room = |bytes: &u64| {
            // Allocated and freed again, for systems that do not report their memory
            let bytes = usize::try_from(*bytes).unwrap_or(usize::MAX);
            Vec::<u8>::new().try_reserve_exact(bytes).is_ok()
        };
        let available = available_memory();
        if available.is_none_or(|available| needed <= available) && has_room(&needed) {
            return Ok(());
        }
        let PixelRect { width, height, .. } = pixels;
        let [needed, scene, picture] = [needed, of_scene, of_pixels].map(in_words);
        let available = available.map_or_else(|| String::from("not as much"), in_words);
        let message = format!(
            "rendering needs about {needed} of memory ({scene} for {triangles} triangles, {picture} for {width}x{height} \
             pixels), but {available} can be had"
        );
        let help =
            if of_scene > of_pixels { "take meshes with fewer triangles" } else { "choose a smaller size" };
        Err(SceneError::new(message).with_help(format!(
            "{help}, fewer threads under a limit on the address space, or a larger limit"
        )))
    }
}

/// A number of bytes in words.
fn in_words(bytes: u64) -> String {
    match bytes as f64 {
        bytes if bytes >= f64::from(1 << 30) => format!("{:.1} GiB", bytes / f64::from(1 << 30)),
        bytes => format!("{:.0} MiB", bytes / f64::from(1 << 20)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(target_os = "linux")]
    #[test]
    fn memory_is_required_before_it_is_taken() {
        assert!(available_memory().unwrap() > 0);
        let largest = PixelRect::whole([1 << 20; 2]);
        let message = Session::require_memory(&Scene::default(), largest, 1 << 20).unwrap_err().message;
        let begin = "rendering needs about 1073741824.0 GiB of memory (0 MiB for 0 triangles, ";
        assert!(message.starts_with(begin) && message.contains("1048576x1048576"), "{message}");
        Session::require_memory(&Scene::default(), PixelRect::whole([1; 2]), 1).unwrap();
    }

    #[test]
    fn address_space_is_limited_less_what_is_taken() {
        let limits = |limit: &str| {
            format!("Max cpu time  1 2 seconds\nMax address space  {limit}  unlimited  bytes\n")
        };
        let status = "VmPeak:\t  9 kB\nVmSize:\t  1024 kB\nThreads:\t2\n";
        assert_eq!(room_in_address_space(&limits("unlimited"), status), None);
        assert_eq!(room_in_address_space(&limits("137363456"), status), Some((131 << 20) - (129 << 20)));
        assert_eq!(room_in_address_space(&limits("1000"), status), Some(0));
    }

    #[test]
    fn control_groups_of_both_versions_are_asked_up_to_the_root() {
        let root = tempfile::tempdir().unwrap();
        let write = |path: &str, text: &str| {
            let path = root.path().join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        };
        let room = |groups: &str| room_in_control_groups(groups, root.path());
        assert_eq!(room("0::/jobs/7\n"), None);
        write("jobs/7/memory.max", "max\n");
        assert_eq!(room("0::/jobs/7\n"), None);
        write("jobs/memory.max", "1000\n");
        write("jobs/memory.current", "700\n");
        write("jobs/memory.stat", "anon 500\ninactive_file 200\n");
        assert_eq!(room("0::/jobs/7\n"), Some(500));
        write("jobs/7/memory.max", "300\n");
        assert_eq!(room("0::/jobs/7\n"), Some(300));
        // Version 1, whose groups a container does not see by their names
        write("memory/memory.limit_in_bytes", "100\n");
        write("memory/memory.usage_in_bytes", "40\n");
        assert_eq!(room("5:cpu:/a\n4:memory,hugetlb:/docker/b\n"), Some(60));
    }
}
