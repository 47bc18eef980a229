//! Threads for one call, which end with it.

use rayon::ThreadPoolBuilder;

use crate::status::{Failure, TranslucidStatus};

/// Runs work on a number of threads, by 0 one per processor.
pub(crate) fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> Result<T, Failure> {
    if threads > 1024 {
        return Err(Failure::argument(format_args!("threads is {threads}, but must be in [0, 1024]")));
    }
    let pool = ThreadPoolBuilder::new().num_threads(threads);
    // Scoped: a program that unloads the library must not leave threads in it
    let result = pool.build_scoped(|thread| thread.run(), |pool| pool.install(work));
    result.map_err(|error| {
        Failure::new(TranslucidStatus::OutOfResources, format!("cannot start the threads: {error}"))
    })
}
