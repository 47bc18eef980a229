//! Denoising of a finished film by Intel Open Image Denoise, where that is installed.
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
use std::path::{Path, PathBuf};
use std::ptr;

use libloading::Library;

use super::exr::{finite, pixels};
use crate::render::film::{FilmSums, layer};

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

/// Why a picture was not denoised.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DenoiseError {
    /// What is wrong; no final stop.
    pub message: String,
    /// What to do, if that is known.
    pub help: Option<String>,
}

impl DenoiseError {
    fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), help: None }
    }

    fn not_found(message: String) -> Self {
        let help = format!(
            "install Open Image Denoise (https://www.openimagedenoise.org), or set {DENOISER_VARIABLE} to the path \
             of its library"
        );
        Self { message, help: Some(help) }
    }
}

impl fmt::Display for DenoiseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)?;
        self.help.as_ref().map_or(Ok(()), |help| write!(f, " ({help})"))
    }
}

impl Error for DenoiseError {}

/// A denoised picture of a film.
#[derive(Clone, Debug, PartialEq)]
pub struct Denoised {
    /// Radiance of each pixel, row by row, multiplied by coverage as the film's; finite and at least 0.
    pub radiance: Vec<[f32; 3]>,
    /// What has denoised it, with its version.
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
}

impl fmt::Debug for Denoiser {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Denoiser").finish_non_exhaustive()
    }
}

impl Denoiser {
    /// Opens the library that [`DENOISER_VARIABLE`] names, or else the system's.
    ///
    /// # Errors
    /// There is none, or it is another library.
    pub fn load() -> Result<Self, DenoiseError> {
        match env::var_os(DENOISER_VARIABLE) {
            Some(path) if !path.is_empty() => Self::load_from(Path::new(&path)),
            _ => {
                let mut failures = Vec::new();
                for name in NAMES {
                    match open(Path::new(name)) {
                        Ok(library) => return Self::from_library(library, name),
                        Err(error) => failures.push(format!("{name}: {}", reason(&error))),
                    }
                }
                let tried = failures.join("; ");
                Err(DenoiseError::not_found(format!("there is no library to denoise with: {tried}")))
            }
        }
    }

    /// Opens the library at a path, or in a folder.
    ///
    /// # Errors
    /// It is not there, or it is another library.
    pub fn load_from(path: &Path) -> Result<Self, DenoiseError> {
        let wrong =
            |what: &str| DenoiseError::not_found(format!("{}: {what}, so it cannot denoise", path.display()));
        let file = if path.is_dir() {
            library_in(path, "OpenImageDenoise").ok_or_else(|| wrong("has no Open Image Denoise in it"))?
        } else {
            path.to_owned()
        };
        if !file.is_file() {
            return Err(wrong("there is no such library"));
        }
        // Packages have the library of threads beside it, under a name that the loader alone would not find.
        if let Some(threads) = file.parent().and_then(|folder| library_in(folder, "tbb"))
            && let Ok(library) = open(&threads)
        {
            std::mem::forget(library);
        }
        let library = open(&file).map_err(|error| wrong(&reason(&error)))?;
        Self::from_library(library, &file.display().to_string())
    }

    fn from_library(library: Library, name: &str) -> Result<Self, DenoiseError> {
        let interface = Interface::new(&library).map_err(|missing| {
            DenoiseError::not_found(format!("{name} is not Open Image Denoise: it has no {missing}"))
        })?;
        // Its threads may outlive the last call, so it stays until the process ends.
        std::mem::forget(library);
        Ok(Self { interface })
    }

    /// Denoises a film, on `threads` threads or, if that is 0, as many as there are.
    ///
    /// # Errors
    /// The library reports one; its words are in the message.
    pub fn denoise(&self, film: &FilmSums, threads: usize) -> Result<Denoised, DenoiseError> {
        let limit = f64::from(f32::MAX);
        let single = |value: f64| finite(value, limit) as f32;
        let mut color = Vec::new();
        let (mut albedo, mut normal) = (Vec::new(), Vec::new());
        for (x, y) in pixels(film) {
            let mean = film.mean(x, y);
            color.push(film.radiance(x, y).map(|value| single(value).max(0.0)));
            albedo.push(layer::ALBEDO.map_array(|index| single(mean[index]).clamp(0.0, 1.0)));
            normal.push(layer::NORMAL.map_array(|index| single(mean[index]).clamp(-1.0, 1.0)));
        }
        let size = [film.width as usize, film.height as usize];
        let device = Device::new(&self.interface, threads)?;
        let mut radiance = color.clone();
        device.filter(Images { color, albedo, normal, size }, &mut radiance)?;
        for ((x, y), pixel) in pixels(film).zip(&mut radiance) {
            if !pixel.iter().all(|value| value.is_finite()) {
                *pixel = film.radiance(x, y).map(single);
            }
            *pixel = pixel.map(|value| value.max(0.0));
        }
        Ok(Denoised { radiance, by: device.version() })
    }
}

/// Three indices in a row as an array.
trait MapArray {
    fn map_array(&self, f: impl Fn(usize) -> f32) -> [f32; 3];
}

impl MapArray for std::ops::Range<usize> {
    fn map_array(&self, f: impl Fn(usize) -> f32) -> [f32; 3] {
        std::array::from_fn(|i| f(self.start + i))
    }
}

/// Opens a library, which runs its initializers.
fn open(path: &Path) -> Result<Library, libloading::Error> {
    // SAFETY: initializers are code that the user has chosen to run, by name or by installing it, as any
    // library that a program links to; those of Open Image Denoise and TBB have no preconditions.
    unsafe { Library::new(path) }
}

/// The system's words on a library that cannot be opened, such as another one that it needs.
fn reason(error: &libloading::Error) -> String {
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
    fn check(&self, device: Handle) -> Result<(), DenoiseError> {
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
        Err(DenoiseError::new(format!("Open Image Denoise reports: {text}")))
    }
}

/// What a filter reads: color, albedo and normal of `size` pixels, row by row.
struct Images {
    color: Vec<[f32; 3]>,
    albedo: Vec<[f32; 3]>,
    normal: Vec<[f32; 3]>,
    size: [usize; 2],
}

/// A device of the library, released when dropped.
struct Device<'a> {
    interface: &'a Interface,
    handle: Handle,
}

impl<'a> Device<'a> {
    fn new(interface: &'a Interface, threads: usize) -> Result<Self, DenoiseError> {
        // SAFETY: takes a number, gives a handle or null.
        let handle = unsafe { (interface.new_device)(DEVICE_CPU) };
        if handle.is_null() {
            interface.check(handle)?;
            return Err(DenoiseError::new("Open Image Denoise has no device for this processor"));
        }
        let device = Self { interface, handle };
        if let Ok(threads @ 1..) = c_int::try_from(threads) {
            // SAFETY: the handle is valid, the name ends in NUL and is read during the call.
            unsafe { (interface.set_device_int)(handle, c"numThreads".as_ptr(), threads) };
        }
        // SAFETY: the handle is valid.
        unsafe { (interface.commit_device)(handle) };
        interface.check(handle)?;
        Ok(device)
    }

    /// Name and version of the library.
    fn version(&self) -> String {
        // SAFETY: the handle is valid, the name ends in NUL and is read during the call.
        let version = unsafe { (self.interface.get_device_int)(self.handle, c"version".as_ptr()) };
        format!("Open Image Denoise {}.{}.{}", version / 10_000, version / 100 % 100, version % 100)
    }

    /// Runs the filter for path tracers from `images` to `output`, which has as many pixels.
    fn filter(&self, mut images: Images, output: &mut [[f32; 3]]) -> Result<(), DenoiseError> {
        let Images { color, albedo, normal, size: [width, height] } = &mut images;
        let count = width.checked_mul(*height).unwrap_or(0);
        let all_fit = [color.len(), albedo.len(), normal.len(), output.len()].iter().all(|n| *n == count);
        if count == 0 || !all_fit {
            return Err(DenoiseError::new("the picture to denoise is empty, or its layers differ in size"));
        }
        let filter = Filter::new(self)?;
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
        self.interface.check(self.handle)?;
        // SAFETY: the handle is valid and committed without error; the call returns when the output is written.
        unsafe { (self.interface.execute_filter)(filter.handle) };
        self.interface.check(self.handle)
    }
}

impl Drop for Device<'_> {
    fn drop(&mut self) {
        // SAFETY: the handle is valid and not used again.
        unsafe { (self.interface.release_device)(self.handle) };
    }
}

/// A filter of a device, released when dropped.
struct Filter<'a> {
    interface: &'a Interface,
    handle: Handle,
}

impl<'a> Filter<'a> {
    fn new(device: &Device<'a>) -> Result<Self, DenoiseError> {
        let interface = device.interface;
        // SAFETY: the handle is valid, the name ends in NUL and is read during the call.
        let handle = unsafe { (interface.new_filter)(device.handle, c"RT".as_ptr()) };
        if handle.is_null() {
            interface.check(device.handle)?;
            return Err(DenoiseError::new("Open Image Denoise has no filter for path tracers"));
        }
        Ok(Self { interface, handle })
    }
}

impl Drop for Filter<'_> {
    fn drop(&mut self) {
        // SAFETY: the handle is valid and not used again.
        unsafe { (self.interface.release_filter)(self.handle) };
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use translucid_scene::{LoadOptions, SceneFile};

    use super::*;
    use crate::{Goal, Renderer};

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
        let error = Denoiser::from_library(library, "libm.so.6").unwrap_err();
        assert_eq!(error.message, "libm.so.6 is not Open Image Denoise: it has no oidnNewDevice");
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

    /// A ball of wax under a lamp.
    fn picture(samples: u32, seed: u64) -> FilmSums {
        let text = "
            unit = \"cm\"
            [camera]
            position = [0.0, 1.0, 5.0]
            target = [0.0, 0.0, 0.0]
            [[light]]
            type = \"rectangle\"
            center = [-4.0, 4.0, 2.0]
            target = [0.0, 0.0, 0.0]
            size = [2.0, 2.0]
            radiance = [10.0, 10.0, 10.0]
            [[material]]
            name = \"wax\"
            subsurface_weight = 1.0
            subsurface_radius = 0.2
            [[object]]
            shape = \"sphere\"
            material = \"wax\"
            [[object]]
            shape = \"rectangle\"
            width = 20.0
            height = 20.0
            translate = [0.0, 0.0, -2.0]
        ";
        let file = SceneFile::parse(text, Path::new("ball.toml")).unwrap();
        let options = LoadOptions { size: Some([96, 64]), ..LoadOptions::default() };
        let mut scene = file.load(&options, &mut Vec::new()).unwrap();
        scene.integrator.seed = seed;
        let renderer = Renderer::new(scene);
        let mut film = FilmSums::new(96, 64);
        renderer.render(&mut film, Goal { samples, deadline: None }, &|_| {}, &AtomicBool::new(false));
        film
    }

    /// Mean of (x − ref)² / (ref² + 0.01) over all channels.
    fn relative_mse(image: impl Fn(u32, u32) -> [f64; 3], reference: &FilmSums) -> f64 {
        let mut sum = 0.0;
        for (x, y) in pixels(reference) {
            for (value, truth) in image(x, y).into_iter().zip(reference.radiance(x, y)) {
                sum += (value - truth).powi(2) / (truth * truth + 0.01);
            }
        }
        sum / f64::from(3 * reference.width * reference.height)
    }

    /// Runs where the library is, else it says that it does not.
    #[test]
    #[allow(clippy::print_stderr, reason = "a test that does nothing must say so")]
    fn denoised_picture_is_closer_to_the_truth() {
        let denoiser = match Denoiser::load() {
            Ok(denoiser) => denoiser,
            Err(error) => return eprintln!("skipped: {error}"),
        };
        let mut noisy = picture(4, 1);
        let reference = picture(1024, 2);
        let denoised = denoiser.denoise(&noisy, 1).unwrap();
        assert!(denoised.by.starts_with("Open Image Denoise "), "{}", denoised.by);
        let before = relative_mse(|x, y| noisy.radiance(x, y), &reference);
        let at = |x: u32, y: u32| denoised.radiance[(y * noisy.width + x) as usize].map(f64::from);
        let after = relative_mse(at, &reference);
        assert!(after < 0.5 * before, "relMSE {before} before and {after} after");

        // What is not a number comes out as one
        noisy.tiles[0].pixels[0] = [f64::NAN; layer::COUNT];
        noisy.tiles[0].pixels[1] = [f64::INFINITY; layer::COUNT];
        let denoised = denoiser.denoise(&noisy, 0).unwrap();
        assert!(denoised.radiance.iter().flatten().all(|value| value.is_finite() && *value >= 0.0));
    }
}
