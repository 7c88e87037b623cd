//! Engines of PETSc. Unsafe code, as in `shim`.

#![allow(unsafe_code)]

use std::ffi::{CStr, c_char, c_int};
use std::ptr;
use std::thread::{self, ThreadId};

use emmy::team::{Engine, EngineKind, OwnRows};

#[repr(C)]
struct Handle {
    _private: [u8; 0],
}

unsafe extern "C" {
    fn emmy_petsc_message() -> *const c_char;
    fn emmy_petsc_start() -> c_int;
    fn emmy_petsc_end() -> c_int;
    fn emmy_petsc_fits(n_rows: usize, n_entries: usize) -> c_int;
    fn emmy_petsc_set(
        engine: *mut *mut Handle,
        is_multigrid: c_int,
        n_own: usize,
        first: usize,
        begin: *const usize,
        columns: *const usize,
        blocks: *const f64,
        positions: *const f64,
    ) -> c_int;
    fn emmy_petsc_apply(engine: *mut Handle, n: usize, x: *mut f64) -> c_int;
    fn emmy_petsc_free(engine: *mut Handle) -> c_int;
}

/// Codes of failures that all ranks return together: a matrix without a factorisation, an iteration inside PETSc that
/// does not converge. Every other code ends all ranks, because the others may wait for this one.
const OF_ALL_RANKS: [c_int; 3] = [-1, 82, 91];

/// An engine, whose PETSc objects are created with its first matrix.
#[derive(Debug)]
pub(crate) struct Petsc {
    kind: EngineKind,
    engine: *mut Handle,
    n_own: usize,
    /// The thread that may call PETSc.
    thread: ThreadId,
}

// SAFETY: every call checks that it is made in the thread that created the objects.
unsafe impl Send for Petsc {}

impl Petsc {
    /// An engine for the thread that calls, which is the one of MPI.
    pub(crate) fn new(kind: EngineKind) -> Self {
        Petsc { kind, engine: ptr::null_mut(), n_own: 0, thread: thread::current().id() }
    }

    fn check_thread(&self) {
        assert!(thread::current().id() == self.thread, "an engine in another thread than that of `run`");
    }
}

/// Ends PETSc, if it has started.
pub(crate) fn end() -> Result<(), String> {
    // SAFETY: no arguments.
    match unsafe { emmy_petsc_end() } {
        0 => Ok(()),
        code => Err(text(code)),
    }
}

impl Engine for Petsc {
    fn name(&self) -> &'static str {
        match self.kind {
            EngineKind::Factorization => "MUMPS",
            EngineKind::Multigrid => "GAMG",
        }
    }

    fn set(&mut self, rows: &OwnRows<'_>) -> Result<(), String> {
        self.check_thread();
        let OwnRows { first, n_of_ranks, begin, columns, blocks, positions } = *rows;
        let n_own = begin.len() - 1;
        assert_eq!((columns.len(), blocks.len()), (begin[n_own], 9 * begin[n_own]));
        assert_eq!(positions.len(), 3 * n_own);
        // SAFETY: numbers alone.
        let fits = |n_rows, n_entries| unsafe { emmy_petsc_fits(n_rows, n_entries) } == 1;
        if !fits(3 * n_of_ranks, 0) {
            let rows = 3 * n_of_ranks;
            return Err(format!("{rows} degrees of freedom need a PETSc with 64-bit indices"));
        }
        if !fits(0, blocks.len()) {
            fail("the couplings of a rank need a PETSc with 64-bit indices");
        }
        assert!(self.engine.is_null() || n_own == self.n_own, "a matrix of another size");
        self.n_own = n_own;
        let is_multigrid = c_int::from(self.kind == EngineKind::Multigrid);
        // SAFETY: the lists have the lengths that were checked; `engine` is null or from an earlier call.
        let code = unsafe {
            let code = emmy_petsc_start();
            if code != 0 {
                fail(&text(code));
            }
            let (begin, columns) = (begin.as_ptr(), columns.as_ptr());
            let (blocks, positions) = (blocks.as_ptr(), positions.as_ptr());
            emmy_petsc_set(&mut self.engine, is_multigrid, n_own, first, begin, columns, blocks, positions)
        };
        match code {
            0 => Ok(()),
            code if OF_ALL_RANKS.contains(&code) => Err(text(code)),
            code => fail(&text(code)),
        }
    }

    fn apply(&mut self, x: &mut [f64]) {
        self.check_thread();
        assert!(!self.engine.is_null() && x.len() == 3 * self.n_own, "a vector of another matrix");
        // SAFETY: the matrix of the engine has as many own rows as x.
        let code = unsafe { emmy_petsc_apply(self.engine, x.len(), x.as_mut_ptr()) };
        match code {
            0 => {}
            code if OF_ALL_RANKS.contains(&code) => x.fill(f64::NAN),
            code => fail(&text(code)),
        }
    }
}

impl Drop for Petsc {
    /// Frees the objects, all ranks together. Those that outlive the team, or end in another thread, stay with the
    /// process.
    fn drop(&mut self) {
        if self.engine.is_null() || thread::current().id() != self.thread || thread::panicking() {
            return;
        }
        // SAFETY: the engine is from `emmy_petsc_set`, and is not used again.
        let code = unsafe { emmy_petsc_free(self.engine) };
        if code != 0 {
            fail(&text(code));
        }
    }
}

fn text(code: c_int) -> String {
    // SAFETY: a text that ends with zero, in memory that stays.
    let message = unsafe { CStr::from_ptr(emmy_petsc_message()) };
    match code {
        -1 => message.to_string_lossy().into_owned(),
        code => format!("PETSc failed with code {code}: {}", message.to_string_lossy()),
    }
}

/// Prints a message and ends all ranks: other ranks may wait inside of PETSc.
fn fail(message: &str) -> ! {
    crate::fail(None, message)
}
