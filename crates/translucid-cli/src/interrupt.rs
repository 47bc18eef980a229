//! Signals that ask the work to stop: Ctrl-C, SIGTERM of a queue or container, SIGHUP of a terminal that closes, and those
//! by which queues warn of an end: SIGUSR1 and SIGUSR2 of gridengine, and SIGXCPU of a limit on CPU time.
//!
//! The first asks the work to stop; a second Ctrl-C or SIGTERM ends the process at once. The others may come repeatedly:
//! SIGXCPU does every second, and a closing terminal's shell and the system both send SIGHUP.

use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::failure::Failure;
use crate::messages;

/// Set by the first signal.
pub(crate) static STOP: AtomicBool = AtomicBool::new(false);

/// Number of the signal that came last.
static SIGNAL: AtomicU8 = AtomicU8::new(SIGINT);

/// Set once the work has stopped and only its results remain to be written.
static WRITING: AtomicBool = AtomicBool::new(false);

/// Numbers of signals, which POSIX fixes.
const SIGINT: u8 = 2;
const SIGTERM: u8 = 15;

/// Exit code of work that was stopped, as shells have it: 130 for Ctrl-C, 143 for SIGTERM.
pub(crate) fn exit_code() -> u8 {
    128 + SIGNAL.load(Ordering::Relaxed)
}

/// Whether the work was asked to stop. From now on what has been asked to stop may write its results undisturbed; the
/// next Ctrl-C ends the process at once.
pub(crate) fn settle() -> bool {
    let stopped = STOP.swap(false, Ordering::Relaxed);
    WRITING.store(stopped, Ordering::Relaxed);
    stopped
}

/// Forgets the signals of an earlier command in the same process.
pub(crate) fn forget() {
    STOP.store(false, Ordering::Relaxed);
    WRITING.store(false, Ordering::Relaxed);
}

/// Signals closer together than this are one: `timeout -s INT` and some shells send it to the process and to its
/// group.
const ONE_PRESS: Duration = Duration::from_millis(300);

/// Words to print at the first signal; none before signals are caught.
static MESSAGE: Mutex<Option<&'static str>> = Mutex::new(None);

/// From now on the first signal prints `message` and sets [`STOP`].
pub(crate) fn catch(message: &'static str) -> Result<(), Failure> {
    if words().replace(message).is_some() {
        return Ok(());
    }
    let mut before: Option<Instant> = None;
    listen(move |signal| {
        let again = before.replace(Instant::now()).is_some_and(|before| before.elapsed() < ONE_PRESS);
        if again {
            return;
        }
        let is_asked = WRITING.load(Ordering::Relaxed) || STOP.swap(true, Ordering::Relaxed);
        if is_asked && ![SIGINT, SIGTERM].contains(&signal) {
            return;
        }
        SIGNAL.store(signal, Ordering::Relaxed);
        if is_asked {
            std::process::exit(exit_code().into());
        }
        let message = *words();
        messages::line(message.unwrap_or_default());
    })
    .map_err(|error| Failure::work(format!("cannot catch Ctrl-C: {error}")))
}

fn words() -> std::sync::MutexGuard<'static, Option<&'static str>> {
    MESSAGE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Calls `hear` with the number of every signal that asks to stop, on a thread of its own.
#[cfg(unix)]
fn listen(mut hear: impl FnMut(u8) + Send + 'static) -> std::io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGUSR1, SIGUSR2, SIGXCPU, SIGXFSZ};

    // A file that grows beyond `ulimit -f` is then an error of the write, and no end of the process
    let mut caught = vec![SIGINT, SIGTERM, SIGXFSZ];
    // Where the system does not tell what `nohup` has it ignore, a terminal that closes still ends the process
    caught.extend([SIGUSR1, SIGUSR2, SIGXCPU].into_iter().filter(|signal| is_ignored(*signal) != Some(true)));
    caught.extend([SIGHUP].into_iter().filter(|signal| is_ignored(*signal) == Some(false)));
    let mut signals = signal_hook::iterator::Signals::new(caught)?;
    let hear = move || {
        for signal in signals.forever().filter(|signal| *signal != SIGXFSZ) {
            hear(signal as u8);
        }
    };
    std::thread::Builder::new().name(String::from("signals")).spawn(hear).map(drop)
}

/// Whether the process was started with a signal ignored, as `nohup` does, if the system tells.
#[cfg(unix)]
fn is_ignored(signal: std::ffi::c_int) -> Option<bool> {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.map(|mask| mask >> (signal - 1) & 1 == 1)
}

#[cfg(not(unix))]
fn listen(mut hear: impl FnMut(u8) + Send + 'static) -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(move || hear(SIGINT))
}
