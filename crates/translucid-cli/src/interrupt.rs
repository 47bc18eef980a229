//! Ctrl-C: the first asks the work to stop, the second ends the process at once.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::failure::Failure;
use crate::messages;

/// Set by the first Ctrl-C.
pub(crate) static STOP: AtomicBool = AtomicBool::new(false);

/// From now on the first Ctrl-C prints `message` and sets [`STOP`].
pub(crate) fn catch(message: &'static str) -> Result<(), Failure> {
    ctrlc::set_handler(move || {
        if STOP.swap(true, Ordering::Relaxed) {
            std::process::exit(1);
        }
        messages::line(message);
    })
    .map_err(|error| Failure::work(format!("cannot catch Ctrl-C: {error}")))
}
