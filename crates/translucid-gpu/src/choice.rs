//! The choice of a device by the name that a user gives it.

use std::sync::Arc;

use translucid_reference::walk::Device;
use translucid_render::OnDevice;
use translucid_render::device::TracingDevice;

use crate::description::DeviceDescription;

/// A choice between the processor and devices: `D` is what the device is to do.
#[derive(Default)]
pub struct Choice<D> {
    /// A device; none for the processor.
    pub device: Option<D>,
    /// A line for the user, who left the choice to us.
    pub note: Option<String>,
}

impl Choice<Box<dyn Device + Send>> {
    /// Opens what a name means, in any case of letters, to walk photons: `cpu` the processor; `gpu` the best graphics
    /// processor; `auto` that, or the processor where there is none; else a device by a part of its name.
    ///
    /// # Errors
    /// There is no such device, it cannot be used, or the program was built without devices; the message says what there is.
    pub fn open(name: &str) -> Result<Self, String> {
        Self::of(name, "walks", open_walker)
    }
}

impl Choice<Arc<dyn TracingDevice>> {
    /// Opens what a name means to trace the paths of pictures, as [`Choice::open`] does.
    ///
    /// # Errors
    /// As there.
    pub fn open_for_pictures(name: &str) -> Result<Self, String> {
        Self::of(name, "traces", open_tracer)
    }

    /// The device for a session or a page: one that was left to us gives way where it cannot take a scene.
    pub fn on_device(&self) -> Option<OnDevice> {
        let kind = if self.note.is_some() { OnDevice::preferred } else { OnDevice::required };
        self.device.clone().map(kind)
    }
}

impl<D> Choice<D> {
    fn of(name: &str, does: &str, open: fn(&str) -> Result<(D, String), String>) -> Result<Self, String> {
        if name.trim().is_empty() {
            return Err("the name of the device is empty".to_owned());
        }
        match name.to_lowercase().as_str() {
            "cpu" => Ok(Self { device: None, note: None }),
            "auto" => Ok(match open("gpu") {
                Ok((device, name)) => {
                    Self { device: Some(device), note: Some(format!("the device is {name}")) }
                }
                Err(reason) => Self { device: None, note: Some(format!("the processor {does}: {reason}")) },
            }),
            _ => open(name).map(|(device, _)| Self { device: Some(device), note: None }),
        }
    }
}

/// Why there are no devices in a program that was built without the feature `device`.
#[cfg(not(feature = "device"))]
const WITHOUT: &str = "this build of translucid knows no graphics processors: published programs do, and those built with `--features gpu`";

#[cfg(feature = "device")]
fn open_walker(name: &str) -> Result<(Box<dyn Device + Send>, String), String> {
    let gpu = crate::device::Gpu::open(name)?;
    let name = gpu.name().to_owned();
    Ok((Box::new(gpu), name))
}

#[cfg(not(feature = "device"))]
fn open_walker(_: &str) -> Result<(Box<dyn Device + Send>, String), String> {
    Err(WITHOUT.to_owned())
}

#[cfg(feature = "device")]
fn open_tracer(name: &str) -> Result<(Arc<dyn TracingDevice>, String), String> {
    let gpu = crate::device::Gpu::open(name)?;
    let name = gpu.name().to_owned();
    Ok((Arc::new(crate::picture::Tracer::new(gpu)?), name))
}

#[cfg(not(feature = "device"))]
fn open_tracer(_: &str) -> Result<(Arc<dyn TracingDevice>, String), String> {
    Err(WITHOUT.to_owned())
}

/// The devices of this machine: none where there is no driver.
///
/// # Errors
/// The program was built without devices.
#[cfg(feature = "device")]
pub fn devices() -> Result<Vec<DeviceDescription>, String> {
    Ok(crate::device::devices())
}

/// The devices of this machine: none where there is no driver.
///
/// # Errors
/// The program was built without devices.
#[cfg(not(feature = "device"))]
pub fn devices() -> Result<Vec<DeviceDescription>, String> {
    Err(WITHOUT.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_in_any_case_and_not_empty() {
        assert!(Choice::open("CPU").unwrap().device.is_none());
        let auto = Choice::open("Auto").unwrap();
        assert!(auto.note.is_some_and(|note| note.starts_with("the ")));
        for empty in ["", " "] {
            assert_eq!(Choice::open(empty).err().unwrap(), "the name of the device is empty");
        }
    }
}
