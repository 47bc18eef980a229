//! `translucid devices`: who can trace paths and walk photons, a line each.

use std::fmt::Write as _;

use translucid_gpu::devices;

use crate::failure::Failure;
use crate::messages;
use crate::table::print;

/// Prints the processor, and every device by its name.
pub(crate) fn run() -> Result<(), Failure> {
    let mut text = format!("cpu: {} threads\n", rayon::current_num_threads());
    let found = devices().unwrap_or_else(|reason| {
        messages::print_note(&reason);
        Vec::new()
    });
    for device in &found {
        let state = match &device.fault {
            Some(fault) => format!("cannot be used: {fault}"),
            None => format!("buffers of {} MiB", device.buffer_bytes >> 20),
        };
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{}: {}, {} ({}), {state}",
            device.name, device.kind, device.backend, device.driver
        );
    }
    print(&text)
}
