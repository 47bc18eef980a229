//! Named materials.

use std::ffi::c_char;

use translucid_profile::convention::{self, presets};

use crate::ffi_guard::enter;
use crate::names::{self, Names};
use crate::status::{Failure, TranslucidStatus};

/// A named translucent material, its numbers for red, green and blue.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct TranslucidPreset {
    /// Surface albedo, in [0, 1].
    pub surface_albedo: [f64; 3],
    /// Mean free path in millimeters.
    pub mfp: [f64; 3],
    /// Index of refraction of the surface.
    pub eta: f64,
    /// Perceptual roughness of the surface, by eye.
    pub roughness: f64,
}

/// Name of a preset by its index: NULL behind the last.
///
/// The text lasts as long as the program.
#[unsafe(no_mangle)]
pub extern "C" fn translucid_preset_name(index: usize) -> *const c_char {
    static NAMES: Names = Names::new();
    names::name_of(&NAMES, index, || presets().iter().map(|preset| preset.name).collect())
}

/// Gives the preset of a name; case, spaces and hyphens do not matter.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_preset(
    name: *const c_char,
    preset: *mut TranslucidPreset,
) -> TranslucidStatus {
    enter!(|caller| {
        let slot = caller.slot("preset", preset)?;
        let found = convention::preset(caller.text("name", name)?).map_err(Failure::argument)?;
        slot.put(TranslucidPreset {
            surface_albedo: found.surface_albedo(),
            mfp: found.mfp_in_millimeters(),
            eta: found.eta,
            roughness: found.roughness,
        });
        Ok(())
    })
}
