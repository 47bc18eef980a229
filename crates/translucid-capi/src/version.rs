//! Version of the library, and of the header that a program was compiled with.

use std::ffi::c_char;

/// Major version of the header.
pub const TRANSLUCID_VERSION_MAJOR: u32 = 0;
/// Minor version of the header.
pub const TRANSLUCID_VERSION_MINOR: u32 = 1;
/// Patch version of the header.
pub const TRANSLUCID_VERSION_PATCH: u32 = 0;

/// Version of the library that runs, such as "0.1.0".
#[unsafe(no_mangle)]
pub extern "C" fn translucid_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn header_has_the_version_of_the_crate() {
        let header =
            format!("{TRANSLUCID_VERSION_MAJOR}.{TRANSLUCID_VERSION_MINOR}.{TRANSLUCID_VERSION_PATCH}");
        assert_eq!(header, env!("CARGO_PKG_VERSION"));
    }
}
