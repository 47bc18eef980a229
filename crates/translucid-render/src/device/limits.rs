//! How much a device holds.

use translucid_scene::SceneError;

/// The limits of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DeviceLimits {
    /// Most bytes of an array.
    pub array_bytes: u64,
}

impl DeviceLimits {
    /// Refuses more of something than an array holds.
    pub(super) fn check(&self, what: &str, count: u64, bytes: u64) -> Result<(), SceneError> {
        let most = self.array_bytes / bytes.max(1);
        if count <= most {
            return Ok(());
        }
        Err(SceneError::new(format!("the scene has {count} {what} but the device holds at most {most}")))
    }
}
