//! Ctrl-C: the first asks the work to stop, the second ends the process at once.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use crate::failure::Failure;
use crate::messages;

/// Set by the first Ctrl-C.
pub(crate) static STOP: AtomicBool = AtomicBool::new(false);

/// What to print at the first Ctrl-C; nothing before it is caught.
static MESSAGE: Mutex<Option<&'static str>> = Mutex::new(None);

/// From now on the first Ctrl-C prints `message` and sets [`STOP`].
pub(crate) fn catch(message: &'static str) -> Result<(), Failure> {
    let lock = || MESSAGE.lock().unwrap_or_else(PoisonError::into_inner);
    if lock().replace(message).is_some() {
        return Ok(());
    }
    ctrlc::set_handler(move || {
        if STOP.swap(true, Ordering::Relaxed) {
            std::process::exit(1);
        }
        let message = *lock();
        messages::line(message.unwrap_or_default());
    })
    .map_err(|error| Failure::work(format!("cannot catch Ctrl-C: {error}")))
}
