//! Teams of processes for [`emmy`], by MPI.
//!
//! Every process of `mpirun` is a rank of a team ([`emmy::team`]), which computes the rows of its own nodes. A program
//! is the same for one process and for many:
//!
//! ```no_run
//! use emmy::mesh::{self, Share, owners};
//! use emmy::prelude::*;
//!
//! # #[cfg(not(feature = "mpi"))]
//! # fn main() {}
//! # #[cfg(feature = "mpi")]
//! fn main() -> emmy::Result<()> {
//!     emmy_mpi::run(|team| {
//!         let mesh = mesh::l_block(0.5)?;
//!         let share = Share::new(&mesh, &owners(&mesh, team.size())?, team.rank());
//!         let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 0.5);
//!         let body = Body::shared(share, team.clone()).region(rubber).build()?;
//!         let mut motion = Motion::new(&body, TimeElement::discrete_gradient(1)?)?;
//!         let record = motion.step(0.1)?;
//!         if team.rank() == 0 {
//!             println!("{:.17}", record.total_energy);
//!         }
//!         Ok(())
//!     })
//! }
//! ```
//!
//! All ranks must make the same calls in the same order. Builds with debug assertions compare the calls of all ranks
//! and end with a message where they differ; in other builds the ranks wait for each other for ever.
//!
//! Without the feature `mpi` the crate is empty; the feature `petsc` adds solvers of PETSc.

#![cfg(feature = "mpi")]

#[cfg(feature = "petsc")]
mod petsc;
mod shim;

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, ThreadId};

use emmy::team::{Engine, EngineKind, GROUP, Parcel, Team, combine, larger};

/// Exit code after a panic, or after a call of MPI that failed.
const FAILED: i32 = 101;

/// Runs a function with the team of all processes that `mpirun` started; without `mpirun`, with a team of one. The
/// function runs in the thread that calls, and only this thread may use the team, until the function returns. A panic
/// on one rank ends all ranks with the exit code 101. Builds with debug assertions detect a rank that returns while
/// others wait for its calls; in other builds the others wait for ever. Therefore return only errors that all ranks
/// have ([`emmy::Error`] of a body, a motion or a step is one).
///
/// MPI and PETSc end with the function. If the caller has started MPI, they stay, and the function may run again.
///
/// # Panics
/// As the function, with one process.
pub fn run<T>(rank: impl FnOnce(Arc<dyn Team>) -> T) -> T {
    run_in_groups(GROUP, rank)
}

/// [`run`] with another size of the groups than [`GROUP`], for example the number of ranks of a machine.
///
/// # Panics
/// As [`run`], and if the size of the groups is zero.
pub fn run_in_groups<T>(group: usize, rank: impl FnOnce(Arc<dyn Team>) -> T) -> T {
    assert!(group > 0, "groups of no ranks");
    let (number, size, is_ours) = shim::start().unwrap_or_else(|message| fail(None, &message));
    if size > group {
        shim::divide(number, group).unwrap_or_else(|message| fail(Some(number), &message));
    }
    let team = Arc::new(Ranks {
        rank: number,
        size,
        group,
        thread: thread::current().id(),
        has_ended: AtomicBool::new(false),
        gathered: Mutex::default(),
    });
    match catch_unwind(AssertUnwindSafe(|| rank(team.clone()))) {
        Ok(result) => {
            if cfg!(debug_assertions) {
                team.compare("end", "of the program", 0);
            }
            team.has_ended.store(true, Ordering::Relaxed);
            if is_ours {
                #[cfg(feature = "petsc")]
                petsc::end().unwrap_or_else(|message| fail(Some(number), &message));
                shim::end().unwrap_or_else(|message| fail(Some(number), &message));
            }
            result
        }
        Err(payload) if size == 1 => resume_unwind(payload),
        Err(_) => fail(Some(number), "panicked; all ranks end"),
    }
}

/// Prints a message and ends all ranks.
fn fail(rank: Option<usize>, message: &str) -> ! {
    match rank {
        Some(rank) => eprintln!("emmy-mpi: rank {rank}: {message}"),
        None => eprintln!("emmy-mpi: {message}"),
    }
    shim::abort(FAILED)
}

/// The team of all processes.
#[derive(Debug)]
struct Ranks {
    rank: usize,
    size: usize,
    /// Ranks whose numbers are combined first.
    group: usize,
    /// The thread that may call MPI, until the end.
    thread: ThreadId,
    has_ended: AtomicBool,
    /// Memory for the numbers of all ranks.
    gathered: Mutex<Vec<f64>>,
}

impl Ranks {
    /// Prepares a call.
    ///
    /// # Panics
    /// In another thread than that of [`run`], or after its end.
    fn begin(&self, kind: &str, name: &str, length: usize) {
        assert!(!self.has_ended.load(Ordering::Relaxed), "a call of a team after its end");
        assert!(
            thread::current().id() == self.thread,
            "a call of a team in another thread than that of `run`"
        );
        if cfg!(debug_assertions) {
            self.compare(kind, name, length);
        }
    }

    /// Combines the numbers of all ranks one by one, in the order of the ranks and groups, so that the library's own
    /// order of additions has no effect.
    fn combine(&self, values: &mut [f64], pair: impl Fn(f64, f64) -> f64) {
        if values.is_empty() {
            return;
        }
        let mut all = self.gathered.lock().unwrap_or_else(PoisonError::into_inner);
        if self.size <= self.group {
            all.resize(self.size * values.len(), 0.0);
            self.check(shim::gather(values, &mut all, self.size));
            combine(values, all.chunks_exact(values.len()), pair);
            return;
        }
        let first = self.rank - self.rank % self.group;
        let of_group = self.group.min(self.size - first);
        all.resize(of_group * values.len(), 0.0);
        self.check(shim::gather_group(values, &mut all, of_group));
        if self.rank == first {
            combine(values, all.chunks_exact(values.len()), &pair);
            let n_groups = self.size.div_ceil(self.group);
            all.resize(n_groups * values.len(), 0.0);
            self.check(shim::gather_leaders(values, &mut all, n_groups));
            combine(values, all.chunks_exact(values.len()), pair);
        }
        self.check(shim::tell_group(values));
    }

    /// Ends all ranks unless they make the same call.
    fn compare(&self, kind: &str, name: &str, length: usize) {
        // FNV-1a: 48 bits of it are exact in a number.
        let bytes = kind.bytes().chain(name.bytes()).chain(length.to_le_bytes());
        let hash = bytes.fold(0xcbf2_9ce4_8422_2325u64, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        });
        let own = (hash >> 16) as f64;
        let mut all = vec![0.0; self.size];
        self.check(shim::gather(&[own], &mut all, self.size));
        if let Some(other) = all.iter().position(|hash| *hash != own) {
            let call = format!("at the {kind} \"{name}\" of {length}; rank {other} is at another call");
            fail(Some(self.rank), &call);
        }
    }

    fn check(&self, outcome: Result<(), String>) {
        outcome.unwrap_or_else(|message| fail(Some(self.rank), &message));
    }
}

impl Team for Ranks {
    fn size(&self) -> usize {
        self.size
    }

    fn rank(&self) -> usize {
        self.rank
    }

    fn sum(&self, name: &'static str, values: &mut [f64]) {
        self.begin("sum", name, values.len());
        self.combine(values, |sum, value| sum + value);
    }

    fn largest(&self, name: &'static str, values: &mut [f64]) {
        self.begin("largest", name, values.len());
        self.combine(values, larger);
    }

    fn exchange(&self, name: &'static str, parcels: &mut [Parcel]) {
        self.begin("exchange", name, 0);
        self.check(shim::exchange(parcels));
    }

    #[cfg(feature = "petsc")]
    fn engine(&self, kind: EngineKind) -> Option<Box<dyn Engine>> {
        self.begin("engine", kind.name(), 0);
        Some(Box::new(petsc::Petsc::new(kind)))
    }

    #[cfg(not(feature = "petsc"))]
    fn engine(&self, kind: EngineKind) -> Option<Box<dyn Engine>> {
        self.begin("engine", kind.name(), 0);
        None
    }
}
