//! The thread pool of Emmy's own. The global pool of rayon does not survive `fork`: its threads are missing in the child.

use std::cell::RefCell;
use std::sync::{Arc, Mutex, PoisonError};

use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::function;

struct Pool {
    /// The process that started its threads.
    process: u32,
    threads: Arc<ThreadPool>,
}

static POOL: Mutex<Option<Pool>> = Mutex::new(None);

/// Number of threads asked for by [`set_threads`].
static ASKED: Mutex<Option<usize>> = Mutex::new(None);

thread_local! {
    /// The pool of a thread that computes alone.
    static OWN: RefCell<Option<Pool>> = const { RefCell::new(None) };
}

/// Does some work in the pool, without the lock of the interpreter.
///
/// # Errors
/// The first exception of a function of the body in it; `RuntimeError` if the threads cannot be started, `ValueError` for a wrong `EMMY_NUM_THREADS`.
pub(crate) fn work<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    let pool = current()?;
    let (value, raised) = py.detach(|| pool.install(|| function::with_exception(work)));
    raised.map_or(Ok(value), Err)
}

pub(crate) fn current() -> PyResult<Arc<ThreadPool>> {
    let process = std::process::id();
    let own = OWN
        .with_borrow(|own| own.as_ref().filter(|own| own.process == process).map(|own| own.threads.clone()));
    if let Some(own) = own {
        return Ok(own);
    }
    let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(pool) = pool.as_ref().filter(|pool| pool.process == process) {
        return Ok(pool.threads.clone());
    }
    let threads = start(asked()?)?;
    // The pool of the parent process has no threads here: it must not wait for them when it is dropped.
    std::mem::forget(pool.replace(Pool { process, threads: threads.clone() }));
    Ok(threads)
}

fn start(n: usize) -> PyResult<Arc<ThreadPool>> {
    let built = ThreadPoolBuilder::new().num_threads(n).thread_name(|i| format!("emmy-{i}")).build();
    built.map(Arc::new).map_err(|error| PyRuntimeError::new_err(format!("cannot start {n} threads: {error}")))
}

/// `set_threads`, else `EMMY_NUM_THREADS`, else 0 for all cores.
fn asked() -> PyResult<usize> {
    if let Some(n) = *ASKED.lock().unwrap_or_else(PoisonError::into_inner) {
        return Ok(n);
    }
    let Ok(text) = std::env::var("EMMY_NUM_THREADS") else { return Ok(0) };
    text.trim().parse().ok().filter(|&n| n > 0).ok_or_else(|| {
        PyValueError::new_err(format!("EMMY_NUM_THREADS must be a positive whole number, not {text:?}"))
    })
}

/// Sets the number of threads; results do not depend on it.
#[pyfunction]
pub(crate) fn set_threads(n: usize) -> PyResult<()> {
    if n == 0 {
        return Err(PyValueError::new_err("the number of threads must be at least 1"));
    }
    *ASKED.lock().unwrap_or_else(PoisonError::into_inner) = Some(n);
    let threads = start(n)?;
    let process = std::process::id();
    let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    let before = pool.replace(Pool { process, threads });
    if before.as_ref().is_some_and(|before| before.process != process) {
        std::mem::forget(before);
    }
    Ok(())
}

/// Number of threads.
#[pyfunction]
pub(crate) fn threads() -> PyResult<usize> {
    Ok(current()?.current_num_threads())
}

/// Lets the calling thread compute with one thread of its own, as the workers of a sweep do.
#[pyfunction]
pub(crate) fn on_one_thread() -> PyResult<()> {
    let own = Pool { process: std::process::id(), threads: start(1)? };
    OWN.with_borrow_mut(|pool| *pool = Some(own));
    Ok(())
}
