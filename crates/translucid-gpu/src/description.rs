//! Descriptions of the devices of a machine.

/// A device as its system describes it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeviceDescription {
    /// Name, as its driver gives it.
    pub name: String,
    /// Kind: "discrete GPU", "integrated GPU", "virtual GPU", "CPU" or "other".
    pub kind: &'static str,
    /// Interface by which it is reached: "vulkan", "metal" or "dx12".
    pub backend: String,
    /// Driver and its version.
    pub driver: String,
    /// Most bytes of a buffer that a shader sees at once.
    pub buffer_bytes: u64,
    /// Reason why it cannot be used; nothing where it can.
    pub fault: Option<String>,
}
