//! Denoising of a finished picture by Intel Open Image Denoise, where that is installed.
//!
//! The library is opened at run time by its C interface, of which versions 1 and 2 share the part used here
//! ([its documentation](https://www.openimagedenoise.org/documentation.html)); nothing links to it.
//! It is given the beauty, albedo and normal of each pixel and returns another beauty, which is biased: it goes
//! beside the noisy layers, never in their place, and into no comparison.

use std::env;
use std::error::Error;
use std::ffi::{CStr, OsString, c_char, c_int, c_void};
use std::fmt;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::ptr;

#[cfg(not(target_family = "wasm"))]
use libloading::{Error as LibraryError, Library};
#[cfg(target_family = "wasm")]
use no_libraries::{Library, LibraryError};

use crate::picture::finite_single;
use crate::python_packages::package_folders;
use crate::{OutputError, Picture};

/// The environment variable with the path of the library, or of the folder that it is in.
pub const DENOISER_VARIABLE: &str = "TRANSLUCID_OIDN";

/// Names that the system's loader is asked for, the newest first.
const NAMES: &[&str] = if cfg!(target_os = "windows") {
    &["OpenImageDenoise.dll"]
} else if cfg!(target_os = "macos") {
    &["libOpenImageDenoise.2.dylib", "libOpenImageDenoise.1.dylib", "libOpenImageDenoise.dylib"]
} else {
    &["libOpenImageDenoise.so.2", "libOpenImageDenoise.so.1", "libOpenImageDenoise.so"]
};

/// `OIDN_DEVICE_TYPE_CPU`: the only device that surely reads this program's memory.
const DEVICE_CPU: c_int = 1;
/// `OIDN_FORMAT_FLOAT3`.
const FORMAT_FLOAT3: c_int = 3;
/// `OIDN_ERROR_NONE`.
const ERROR_NONE: c_int = 0;

/// Handle of a device or filter; null where there is none.
type Handle = *mut c_void;

/// A denoised picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Denoised {
    /// Radiance of each pixel, row by row, multiplied by coverage; finite and at least 0.
    pub radiance: Vec<[f32; 3]>,
    /// Program that has denoised it, with its version.
    pub by: String,
}

/// The functions of the library that are needed.
struct Interface {
    new_device: unsafe extern "C" fn(c_int) -> Handle,
    set_device_int: unsafe extern "C" fn(Handle, *const c_char, c_int),
    get_device_int: unsafe extern "C" fn(Handle, *const c_char) -> c_int,
    commit_device: unsafe extern "C" fn(Handle),
    get_device_error: unsafe extern "C" fn(Handle, *mut *const c_char) -> c_int,
    release_device: unsafe extern "C" fn(Handle),
    new_filter: unsafe extern "C" fn(Handle, *const c_char) -> Handle,
    set_image: SetImage,
    set_filter_bool: unsafe extern "C" fn(Handle, *const c_char, bool),
    commit_filter: unsafe extern "C" fn(Handle),
    execute_filter: unsafe extern "C" fn(Handle),
    release_filter: unsafe extern "C" fn(Handle),
}

/// `oidnSetSharedFilterImage`: filter, name, memory, format, width, height, offset, bytes between pixels and rows
/// (0 where they are packed).
type SetImage =
    unsafe extern "C" fn(Handle, *const c_char, *mut c_void, c_int, usize, usize, usize, usize, usize);

/// Open Image Denoise, opened and ready.
pub struct Denoiser {
    interface: Interface,
    name: String,
}

impl fmt::Debug for Denoiser {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Denoiser").field("name", &self.name).finish_non_exhaustive()
    }
}

impl Denoiser {
    /// Opens the library that [`DENOISER_VARIABLE`] names and no other; where that is not set, the system's, or else that of the
    /// Python package pyoidn, in the first of the folders of packages that has it.
    ///
    /// # Errors
    /// There is none, it is another library, or it has no device for this processor.
    pub fn load() -> Result<Self, OutputError> {
        if let Some(path) = env::var_os(DENOISER_VARIABLE).filter(|path| !path.is_empty()) {
            return Self::load_from(Path::new(&path));
        }
        let folders: Vec<PathBuf> = package_folders().into_iter().filter(|folder| folder.is_dir()).collect();
        let system = NAMES.iter().map(|name| (PathBuf::from(name), "the system's"));
        let packaged = folders.iter().filter_map(|folder| Some((library_of_pyoidn(folder)?, "pyoidn")));
        let mut failures = Vec::new();
        for (path, origin) in system.chain(packaged) {
            match Self::open(&path, origin) {
                Ok(denoiser) => return Ok(denoiser),
                Err(fault) => failures.push(fault),
            }
        }
        if failures.len() == NAMES.len() {
            let folders: Vec<_> = folders.iter().map(|folder| folder.display().to_string()).collect();
            failures.push(format!("Python's packages have no pyoidn, in [{}]", folders.join(", ")));
        }
        Err(not_found(format!("there is no library to denoise with: {}", failures.join("; "))))
    }

    /// Opens the library at a path, or in a folder.
    ///
    /// # Errors
    /// It is not there, or it is another library.
    pub fn load_from(path: &Path) -> Result<Self, OutputError> {
        let wrong = |what: &str| not_found(format!("{}: {what}, so it cannot denoise", path.display()));
        let file = if path.is_dir() {
            library_in(path, "OpenImageDenoise").ok_or_else(|| wrong("has no Open Image Denoise in it"))?
        } else {
            path.to_owned()
        };
        if !file.is_file() {
            return Err(wrong("there is no such library"));
        }
        // Of a bare name the loader would look in the system's folders only
        let file = std::path::absolute(&file).unwrap_or(file);
        Self::open(&file, DENOISER_VARIABLE).map_err(|fault| {
            let fault = fault.strip_prefix(&format!("{}: ", file.display())).unwrap_or(&fault);
            wrong(fault)
        })
    }

    /// Opens a library by its path, or the system's by a bare name; the error names the file.
    fn open(file: &Path, origin: &str) -> Result<Self, String> {
        // Packages have the library of threads beside it, under a name that the loader alone would not find.
        let threads =
            file.parent().filter(|_| file.is_absolute()).and_then(|folder| library_in(folder, "tbb"));
        if let Some(Ok(library)) = threads.map(|threads| open(&threads)) {
            std::mem::forget(library);
        }
        let about = |fault: &str| {
            // The loader names the file, too
            let name = format!("{}: ", file.display());
            format!("{name}{}", fault.strip_prefix(&name).unwrap_or(fault))
        };
        let library = open(file).map_err(|error| about(&reason(&error)))?;
        Self::from_library(library, origin).map_err(|fault| about(&fault))
    }

    fn from_library(library: Library, origin: &str) -> Result<Self, String> {
        let interface = Interface::new(&library)
            .map_err(|missing| format!("it is not Open Image Denoise: it has no {missing}"))?;
        // Its threads may outlive the last call, so it stays until the process ends.
        std::mem::forget(library);
        let version = Device::new(&interface, 1).map_err(|error| error.message)?.version();
        Ok(Self { interface, name: format!("{version} ({origin})") })
    }

    /// The library's name and version, and where it was found: "Open Image Denoise 2.5.1 (pyoidn)".
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Denoises a picture, on `threads` threads or, if that is 0, as many as there are.
    ///
    /// It needs the channels `R`, `G`, `B`, `albedo.R`, `albedo.G`, `albedo.B`, `normal.X`, `normal.Y` and `normal.Z`.
    ///
    /// # Errors
    /// A channel is missing, or the library reports an error; its words are in the message.
    pub fn denoise(&self, picture: &Picture<'_>, threads: usize) -> Result<Denoised, OutputError> {
        let images = FilterImages::read(picture)
            .map_err(|error| OutputError::without_file(format!("cannot denoise the picture: {error}")))?;
        let device = Device::new(&self.interface, threads)?;
        let mut radiance = images.color.clone();
        let images = device.filter(images, &mut radiance)?;
        for (pixel, noisy) in radiance.iter_mut().zip(&images.color) {
            if !pixel.iter().all(|value| value.is_finite()) {
                *pixel = *noisy;
            }
            *pixel = pixel.map(|value| value.max(0.0));
        }
        Ok(Denoised { radiance, by: device.version() })
    }
}

/// Libraries where programs open none.
#[cfg(target_family = "wasm")]
mod no_libraries {
    use std::fmt;
    use std::path::Path;

    pub(super) enum Library {}

    #[derive(Debug)]
    pub(super) struct LibraryError;

    impl fmt::Display for LibraryError {
        fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("WebAssembly opens no libraries")
        }
    }

    impl std::error::Error for LibraryError {}

    impl Library {
        pub(super) unsafe fn new(_: &Path) -> Result<Self, LibraryError> {
            Err(LibraryError)
        }

        pub(super) unsafe fn get<F>(&self, _: &[u8]) -> Result<&F, LibraryError> {
            match *self {}
        }
    }
}

/// The error of a library that is not there, or is another one.
fn not_found(message: String) -> OutputError {
    OutputError::without_file(message).with_help(format!(
        "pip install pyoidn, or set {DENOISER_VARIABLE} to the path of the library of Open Image Denoise \
         (https://www.openimagedenoise.org) or of its folder"
    ))
}

/// The library that the package pyoidn has brought into a folder of packages.
fn library_of_pyoidn(packages: &Path) -> Option<PathBuf> {
    let inner = if cfg!(target_os = "windows") { "bin" } else { "lib" };
    library_in(&packages.join("pyoidn").join("oidn").join(inner), "OpenImageDenoise")
}

/// Opens a library, which runs its initializers.
#[cfg(not(windows))]
fn open(path: &Path) -> Result<Library, LibraryError> {
    // SAFETY: initializers are code that the user has chosen to run, by name or by installing it, as any
    // library that a program links to; those of Open Image Denoise and TBB have no preconditions.
    unsafe { Library::new(path) }
}

/// Opens a library, which runs its initializers; those that it needs are looked for beside it.
#[cfg(windows)]
fn open(path: &Path) -> Result<Library, LibraryError> {
    use libloading::os::windows::{LOAD_WITH_ALTERED_SEARCH_PATH, Library};
    // The system takes the flag with absolute paths only
    let flags = if path.is_absolute() { LOAD_WITH_ALTERED_SEARCH_PATH } else { 0 };
    // SAFETY: as on other systems; the flag changes where libraries are looked for.
    unsafe { Library::load_with_flags(path, flags).map(Into::into) }
}

/// The system's words on a library that cannot be opened, such as another one that it needs.
fn reason(error: &LibraryError) -> String {
    error.source().map_or_else(|| error.to_string(), ToString::to_string)
}

/// The first library in a folder, in the order of names, whose name begins so.
fn library_in(folder: &Path, stem: &str) -> Option<PathBuf> {
    let (prefix, ending) = (format!("{}{stem}.", env::consts::DLL_PREFIX), env::consts::DLL_EXTENSION);
    let is_library = |name: &OsString| {
        let name = name.to_string_lossy();
        name.starts_with(&prefix) && name.contains(&format!(".{ending}"))
    };
    let mut names: Vec<OsString> =
        fs::read_dir(folder).ok()?.flatten().map(|entry| entry.file_name()).filter(is_library).collect();
    names.sort();
    Some(folder.join(names.first()?))
}

impl Interface {
    /// Looks all functions up; the error is the name of one that is not there.
    fn new(library: &Library) -> Result<Self, &'static str> {
        /// Finds a function by the first of its names, which differ between versions.
        fn find<F: Copy>(library: &Library, names: &[&'static str]) -> Result<F, &'static str> {
            let find = |name: &&str| {
                // SAFETY: the types below are those of oidn.h for these names, the same in versions 1 and 2;
                // `F` is a function pointer there, of a pointer's size, which `Library::get` checks.
                unsafe { library.get::<F>(name.as_bytes()) }.ok().map(|symbol| *symbol)
            };
            names.iter().find_map(find).ok_or(names[0])
        }
        Ok(Self {
            new_device: find(library, &["oidnNewDevice"])?,
            set_device_int: find(library, &["oidnSetDeviceInt", "oidnSetDevice1i"])?,
            get_device_int: find(library, &["oidnGetDeviceInt", "oidnGetDevice1i"])?,
            commit_device: find(library, &["oidnCommitDevice"])?,
            get_device_error: find(library, &["oidnGetDeviceError"])?,
            release_device: find(library, &["oidnReleaseDevice"])?,
            new_filter: find(library, &["oidnNewFilter"])?,
            set_image: find(library, &["oidnSetSharedFilterImage"])?,
            set_filter_bool: find(library, &["oidnSetFilterBool", "oidnSetFilter1b"])?,
            commit_filter: find(library, &["oidnCommitFilter"])?,
            execute_filter: find(library, &["oidnExecuteFilter"])?,
            release_filter: find(library, &["oidnReleaseFilter"])?,
        })
    }

    /// The device's pending error, if any; `device` is a handle from `new_device` that is not released, or null.
    fn check(&self, device: Handle) -> Result<(), OutputError> {
        let mut message: *const c_char = ptr::null();
        // SAFETY: the handle is valid or null, which asks for the thread's own error, and `message` is a place to
        // write a pointer to.
        let code = unsafe { (self.get_device_error)(device, &raw mut message) };
        if code == ERROR_NONE {
            return Ok(());
        }
        let text = if message.is_null() {
            format!("error {code}")
        } else {
            // SAFETY: the library has set it to a string that ends in NUL and lives until the next error.
            unsafe { CStr::from_ptr(message) }.to_string_lossy().into_owned()
        };
        Err(OutputError::without_file(format!("Open Image Denoise reports: {text}")))
    }
}

/// Input of a filter: color, albedo and normal of `size` pixels, row by row.
struct FilterImages {
    color: Vec<[f32; 3]>,
    albedo: Vec<[f32; 3]>,
    normal: Vec<[f32; 3]>,
    size: [usize; 2],
}

impl FilterImages {
    /// Collects the channels of a picture, as finite numbers within their ranges.
    fn read(picture: &Picture<'_>) -> io::Result<Self> {
        picture.check()?;
        let places = [
            picture.indices_of(["R", "G", "B"])?,
            picture.indices_of(["albedo.R", "albedo.G", "albedo.B"])?,
            picture.indices_of(["normal.X", "normal.Y", "normal.Z"])?,
        ];
        let mut images =
            Self { color: Vec::new(), albedo: Vec::new(), normal: Vec::new(), size: picture.size() };
        let mut row = picture.new_row();
        for y in picture.region.rows() {
            picture.read_row(y, &mut row);
            for pixel in row.chunks_exact(picture.channels.len()) {
                let [color, albedo, normal] =
                    places.map(|indices| indices.map(|index| finite_single(pixel[index])));
                images.color.push(color.map(|value| value.max(0.0)));
                images.albedo.push(albedo.map(|value| value.clamp(0.0, 1.0)));
                images.normal.push(normal.map(|value| value.clamp(-1.0, 1.0)));
            }
        }
        Ok(images)
    }
}

/// A device or filter of the library, released when dropped.
struct Owned {
    handle: Handle,
    release: unsafe extern "C" fn(Handle),
}

impl Drop for Owned {
    fn drop(&mut self) {
        // SAFETY: the handle is valid, of the kind that the function releases, and not used again.
        unsafe { (self.release)(self.handle) };
    }
}

/// A device of the library.
struct Device<'a> {
    interface: &'a Interface,
    owned: Owned,
}

impl<'a> Device<'a> {
    fn new(interface: &'a Interface, threads: usize) -> Result<Self, OutputError> {
        // SAFETY: takes a number, gives a handle or null.
        let handle = unsafe { (interface.new_device)(DEVICE_CPU) };
        if handle.is_null() {
            interface.check(handle)?;
            return Err(OutputError::without_file("Open Image Denoise has no device for this processor"));
        }
        let owned = Owned { handle, release: interface.release_device };
        if let Ok(threads @ 1..) = c_int::try_from(threads) {
            // SAFETY: the handle is valid, the name ends in NUL and is read during the call.
            unsafe { (interface.set_device_int)(handle, c"numThreads".as_ptr(), threads) };
        }
        // SAFETY: the handle is valid.
        unsafe { (interface.commit_device)(handle) };
        interface.check(handle)?;
        Ok(Self { interface, owned })
    }

    /// A filter for path tracers.
    fn new_filter(&self) -> Result<Owned, OutputError> {
        // SAFETY: the handle is valid, the name ends in NUL and is read during the call.
        let handle = unsafe { (self.interface.new_filter)(self.owned.handle, c"RT".as_ptr()) };
        if handle.is_null() {
            self.interface.check(handle)?;
            return Err(OutputError::without_file("Open Image Denoise has no filter for path tracers"));
        }
        Ok(Owned { handle, release: self.interface.release_filter })
    }

    /// Name and version of the library.
    fn version(&self) -> String {
        // SAFETY: the handle is valid, the name ends in NUL and is read during the call.
        let version = unsafe { (self.interface.get_device_int)(self.owned.handle, c"version".as_ptr()) };
        format!("Open Image Denoise {}.{}.{}", version / 10_000, version / 100 % 100, version % 100)
    }

    /// Runs the filter for path tracers from `images`, which it gives back, to `output`, which has as many pixels.
    fn filter(&self, mut images: FilterImages, output: &mut [[f32; 3]]) -> Result<FilterImages, OutputError> {
        let FilterImages { color, albedo, normal, size: [width, height] } = &mut images;
        let count = width.checked_mul(*height).unwrap_or(0);
        let all_fit = [color.len(), albedo.len(), normal.len(), output.len()].iter().all(|n| *n == count);
        if count == 0 || !all_fit {
            return Err(OutputError::without_file(
                "the picture to denoise is empty, or its layers differ in size",
            ));
        }
        let filter = self.new_filter()?;
        let inputs = [(c"color", color), (c"albedo", albedo), (c"normal", normal)];
        for (name, memory) in inputs
            .into_iter()
            .map(|(name, memory)| (name, memory.as_mut_slice()))
            .chain([(c"output", output)])
        {
            // SAFETY: the handle is valid and the name ends in NUL. The memory holds width × height packed pixels of
            // three `f32`, as was checked above, and outlives the filter, which is dropped at the end of this
            // function and declared after all that it refers to; nothing else touches it until then.
            unsafe {
                (self.interface.set_image)(
                    filter.handle,
                    name.as_ptr(),
                    memory.as_mut_ptr().cast(),
                    FORMAT_FLOAT3,
                    *width,
                    *height,
                    0,
                    0,
                    0,
                );
            }
        }
        // SAFETY: the handle is valid, the name ends in NUL and is read during the call.
        unsafe { (self.interface.set_filter_bool)(filter.handle, c"hdr".as_ptr(), true) };
        // SAFETY: the handle is valid.
        unsafe { (self.interface.commit_filter)(filter.handle) };
        self.interface.check(self.owned.handle)?;
        // SAFETY: the handle is valid and committed without error; the call returns when the output is written.
        unsafe { (self.interface.execute_filter)(filter.handle) };
        self.interface.check(self.owned.handle)?;
        drop(filter);
        Ok(images)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn denoiser_that_is_not_there_is_an_error_with_a_way_out() {
        let error = Denoiser::load_from(Path::new("/nowhere/libOpenImageDenoise.so")).unwrap_err();
        assert!(error.message.contains("/nowhere/libOpenImageDenoise.so"), "{error}");
        assert!(error.help.unwrap().contains(DENOISER_VARIABLE));
        let folder = tempfile::tempdir().unwrap();
        let error = Denoiser::load_from(folder.path()).unwrap_err();
        assert!(error.message.contains("has no Open Image Denoise in it"), "{error}");
    }

    #[test]
    fn denoiser_that_is_no_library_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        for content in [&b""[..], b"not a library", b"\x7fELF\x02\x01\x01"] {
            let path = folder.path().join("libOpenImageDenoise.so");
            fs::write(&path, content).unwrap();
            let error = Denoiser::load_from(&path).unwrap_err();
            assert!(error.message.contains("cannot denoise"), "{error}");
        }
    }

    #[test]
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    fn denoiser_that_is_another_library_is_an_error() {
        let library = open(Path::new("libm.so.6")).unwrap();
        let fault = Denoiser::from_library(library, "the system's").unwrap_err();
        assert_eq!(fault, "it is not Open Image Denoise: it has no oidnNewDevice");
    }

    #[test]
    fn library_in_a_folder_is_found_by_its_beginning() {
        let folder = tempfile::tempdir().unwrap();
        let name = |stem: &str, end: &str| {
            format!("{}{stem}.{}{end}", env::consts::DLL_PREFIX, env::consts::DLL_EXTENSION)
        };
        for file in
            [name("OpenImageDenoise", ".1.4.3"), name("tbb", ""), String::from("OpenImageDenoise.txt")]
        {
            fs::write(folder.path().join(file), b"").unwrap();
        }
        let found = library_in(folder.path(), "OpenImageDenoise").unwrap();
        assert_eq!(found.file_name().unwrap().to_string_lossy(), name("OpenImageDenoise", ".1.4.3"));
        assert_eq!(library_in(folder.path(), "embree"), None);
    }

    #[test]
    fn library_of_pyoidn_is_found_in_its_folder() {
        let packages = tempfile::tempdir().unwrap();
        assert_eq!(library_of_pyoidn(packages.path()), None);
        let inner = if cfg!(target_os = "windows") { "bin" } else { "lib" };
        let folder = packages.path().join("pyoidn").join("oidn").join(inner);
        fs::create_dir_all(&folder).unwrap();
        let name = |stem: &str| format!("{}{stem}{}", env::consts::DLL_PREFIX, env::consts::DLL_SUFFIX);
        for stem in ["OpenImageDenoise_core", "OpenImageDenoise", "tbb"] {
            fs::write(folder.join(name(stem)), b"").unwrap();
        }
        assert_eq!(library_of_pyoidn(packages.path()), Some(folder.join(name("OpenImageDenoise"))));
    }
}
