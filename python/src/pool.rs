//! Thread pools of Emmy's own. The global pool of rayon does not survive `fork`: its threads are missing in the child.

use std::cell::{Cell, RefCell};
use std::num::NonZero;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::function;

struct Pool {
    /// The process that started its threads.
    process: u32,
    threads: Arc<ThreadPool>,
}

/// The pool of verbs, and of all threads but the main one.
static SHARED: Mutex<Option<Pool>> = Mutex::new(None);

/// Number of threads asked for by [`set_threads`].
static ASKED: Mutex<Option<usize>> = Mutex::new(None);

thread_local! {
    /// The pool of the main thread, or of a thread that computes alone. The thread itself belongs to it, because waking
    /// another one takes up to 0.1 ms.
    static OWN: RefCell<Option<Pool>> = const { RefCell::new(None) };
    /// Whether a thread computes alone, whatever the number of threads.
    static IS_ALONE: Cell<bool> = const { Cell::new(false) };
}

/// Does some work in the pool of the present thread, without the lock of the interpreter.
///
/// # Errors
/// The first exception of a function of the body in it; `RuntimeError` if the threads cannot be started, `ValueError`
/// for a wrong `EMMY_NUM_THREADS`.
pub(crate) fn work<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    let pool = current(py)?;
    let (value, raised) = py.detach(|| pool.install(|| function::with_exception(work)));
    raised.map_or(Ok(value), Err)
}

/// Time between two looks at the signals.
const BETWEEN_SIGNALS: Duration = Duration::from_millis(50);

/// Does some long work that calls no function of Python, and reacts to Ctrl-C in the meantime. After Ctrl-C, the work
/// continues in its thread to its end, and its value is dropped.
///
/// # Errors
/// `KeyboardInterrupt`, or as [`work`].
pub(crate) fn interruptible<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    // Signals are those of the main thread.
    if IS_ALONE.get() || !is_main(py)? {
        return self::work(py, work);
    }
    let (sender, mut receiver) = mpsc::channel();
    shared()?.spawn(move || _ = sender.send(catch_unwind(AssertUnwindSafe(work))));
    loop {
        let received;
        (receiver, received) = py.detach(move || {
            let received = receiver.recv_timeout(BETWEEN_SIGNALS);
            (receiver, received)
        });
        match received {
            Ok(Ok(value)) => return Ok(value),
            Ok(Err(panic)) => resume_unwind(panic),
            Err(RecvTimeoutError::Timeout) => py.check_signals()?,
            Err(error) => return Err(PyRuntimeError::new_err(error.to_string())),
        }
    }
}

fn current(py: Python<'_>) -> PyResult<Arc<ThreadPool>> {
    let n = size()?;
    if let Some(own) = OWN.with_borrow(|own| threads_of(own, n)) {
        return Ok(own);
    }
    // In a shared pool of one thread, others would wait for a thread that does not work in it.
    if n > 1 && !is_main(py)? {
        return shared();
    }
    let builder = || ThreadPoolBuilder::new().num_threads(n).thread_name(|i| format!("emmy-{i}"));
    // A thread cannot belong to a second pool after the first one was replaced.
    let built = builder().use_current_thread().build().or_else(|_| builder().build());
    let threads = Arc::new(built.map_err(|error| cannot_start(n, &error))?);
    OWN.with_borrow_mut(|own| replace(own, &threads));
    Ok(threads)
}

fn is_main(py: Python<'_>) -> PyResult<bool> {
    let threading = py.import("threading")?;
    Ok(threading.call_method0("current_thread")?.is(&threading.call_method0("main_thread")?))
}

/// The pool of threads that have none of their own.
pub(crate) fn shared() -> PyResult<Arc<ThreadPool>> {
    let n = size()?;
    let mut pool = SHARED.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(threads) = threads_of(&pool, n) {
        return Ok(threads);
    }
    let built = ThreadPoolBuilder::new().num_threads(n).thread_name(|i| format!("emmy-shared-{i}")).build();
    let threads = Arc::new(built.map_err(|error| cannot_start(n, &error))?);
    replace(&mut pool, &threads);
    Ok(threads)
}

/// The threads of a pool of this process, if it has `n`.
fn threads_of(pool: &Option<Pool>, n: usize) -> Option<Arc<ThreadPool>> {
    let is_fit = |pool: &&Pool| pool.process == std::process::id() && pool.threads.current_num_threads() == n;
    pool.as_ref().filter(is_fit).map(|pool| pool.threads.clone())
}

fn replace(pool: &mut Option<Pool>, threads: &Arc<ThreadPool>) {
    let process = std::process::id();
    let before = pool.replace(Pool { process, threads: threads.clone() });
    // The pool of the parent process has no threads here: it must not wait for them when it is dropped.
    if before.as_ref().is_some_and(|before| before.process != process) {
        std::mem::forget(before);
    }
}

fn cannot_start(n: usize, error: &rayon::ThreadPoolBuildError) -> PyErr {
    PyRuntimeError::new_err(format!("cannot start {n} threads: {error}"))
}

/// Number of threads of the present thread's pool: `set_threads`, else `EMMY_NUM_THREADS`, else the number of cores,
/// which is the most.
fn size() -> PyResult<usize> {
    if IS_ALONE.get() {
        return Ok(1);
    }
    // More threads than cores would only wait for each other.
    let cores = std::thread::available_parallelism().map_or(1, NonZero::get);
    if let Some(n) = *ASKED.lock().unwrap_or_else(PoisonError::into_inner) {
        return Ok(n.min(cores));
    }
    let Ok(text) = std::env::var("EMMY_NUM_THREADS") else { return Ok(cores) };
    let n: Option<usize> = text.trim().parse().ok().filter(|&n| n > 0);
    n.map(|n| n.min(cores)).ok_or_else(|| {
        PyValueError::new_err(format!("EMMY_NUM_THREADS must be a positive whole number, not {text:?}"))
    })
}

/// Sets the number of threads; results do not depend on it.
#[pyfunction]
pub(crate) fn set_threads(py: Python<'_>, n: usize) -> PyResult<()> {
    if n == 0 {
        return Err(PyValueError::new_err("the number of threads must be at least 1"));
    }
    let before = ASKED.lock().unwrap_or_else(PoisonError::into_inner).replace(n);
    if let Err(error) = current(py) {
        *ASKED.lock().unwrap_or_else(PoisonError::into_inner) = before;
        return Err(error);
    }
    Ok(())
}

/// Number of threads.
#[pyfunction]
pub(crate) fn threads() -> PyResult<usize> {
    size()
}

/// Lets the calling thread compute alone, as the workers of a sweep do.
#[pyfunction]
pub(crate) fn on_one_thread() {
    IS_ALONE.set(true);
}
