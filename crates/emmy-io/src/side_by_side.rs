//! Work on several threads, each piece of it on one.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Results of numbered pieces of work, on as many threads as the pool of the caller has. The pieces start in their
/// order.
pub(crate) fn side_by_side<T: Send>(n: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let results = Mutex::new(Vec::with_capacity(n));
    let some = || {
        loop {
            let piece = next.fetch_add(1, Ordering::Relaxed);
            if piece >= n {
                return;
            }
            let result = work(piece);
            results.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).push((piece, result));
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..rayon::current_num_threads().min(n) {
            scope.spawn(some);
        }
    });
    let mut results = results.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner());
    results.sort_by_key(|(piece, _)| *piece);
    results.into_iter().map(|(_, result)| result).collect()
}

/// Runs a function in a pool of one thread; bodies built there always work on one thread.
///
/// # Errors
/// The message of the system, if it cannot start a thread.
pub fn on_one_thread<T: Send>(work: impl FnOnce() -> T + Send) -> Result<T, String> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.map_err(|error| format!("cannot start a thread: {error}"))?;
    Ok(pool.install(work))
}
