//! Ctrl-C: the first asks the work to stop, the second ends the process at once.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::failure::Failure;
use crate::messages;

/// Set by the first Ctrl-C.
pub(crate) static STOP: AtomicBool = AtomicBool::new(false);

/// Set once the work has stopped and only its results remain to be written.
static WRITING: AtomicBool = AtomicBool::new(false);

/// Whether Ctrl-C was pressed. From now on what has been asked to stop may write its results undisturbed; the next
/// Ctrl-C ends the process at once.
pub(crate) fn settle() -> bool {
    let stopped = STOP.swap(false, Ordering::Relaxed);
    WRITING.store(stopped, Ordering::Relaxed);
    stopped
}

/// Forgets a Ctrl-C of an earlier command in the same process.
pub(crate) fn forget() {
    STOP.store(false, Ordering::Relaxed);
    WRITING.store(false, Ordering::Relaxed);
}

/// Signals closer together than this are one: `timeout -s INT` and some shells send it to the process and to its
/// group.
const ONE_PRESS: Duration = Duration::from_millis(300);

/// Words to print at the first Ctrl-C; none before it is caught.
static MESSAGE: Mutex<Option<&'static str>> = Mutex::new(None);

/// From now on the first Ctrl-C prints `message` and sets [`STOP`].
pub(crate) fn catch(message: &'static str) -> Result<(), Failure> {
    let lock = || MESSAGE.lock().unwrap_or_else(PoisonError::into_inner);
    if lock().replace(message).is_some() {
        return Ok(());
    }
    let mut pressed: Option<Instant> = None;
    ctrlc::set_handler(move || {
        let again = pressed.replace(Instant::now()).is_some_and(|before| before.elapsed() < ONE_PRESS);
        if again {
            return;
        }
        if STOP.swap(true, Ordering::Relaxed) || WRITING.load(Ordering::Relaxed) {
            std::process::exit(1);
        }
        let message = *lock();
        messages::line(message.unwrap_or_default());
    })
    .map_err(|error| Failure::work(format!("cannot catch Ctrl-C: {error}")))
}
