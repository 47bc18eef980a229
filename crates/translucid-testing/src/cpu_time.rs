//! CPU time, which a busy machine disturbs less than wall time.

use std::fs::read_to_string;
use std::sync::OnceLock;
use std::time::Instant;

/// CPU seconds of this process and all its threads, in steps of a hundredth; wall time where the system does not tell.
#[must_use]
pub fn cpu_seconds() -> f64 {
    // Fields 14 and 15 of the line, counted behind the command's closing parenthesis: clock ticks, of which Linux has 100
    // a second for user space.
    let ticks = |text: String| -> Option<f64> {
        let fields: Vec<&str> = text.rsplit(')').next()?.split_whitespace().collect();
        Some(fields.get(11)?.parse::<f64>().ok()? + fields.get(12)?.parse::<f64>().ok()?)
    };
    read_to_string("/proc/self/stat").ok().and_then(ticks).map_or_else(wall_seconds, |ticks| ticks / 100.0)
}

/// CPU seconds of this thread; wall time where the system does not tell.
#[must_use]
pub fn thread_cpu_seconds() -> f64 {
    std::thread::yield_now(); // Linux brings the account up to date when a thread yields
    let nanoseconds = |text: String| text.split_whitespace().next()?.parse::<f64>().ok();
    let account = read_to_string("/proc/thread-self/schedstat").ok();
    account.and_then(nanoseconds).map_or_else(wall_seconds, |ns| ns * 1e-9)
}

fn wall_seconds() -> f64 {
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_secs_f64()
}
