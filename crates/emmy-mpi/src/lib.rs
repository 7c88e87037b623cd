//! Teams of processes for [`emmy`], by MPI.
//!
//! Every process of `mpirun` is a rank of a team ([`emmy::team`]), which computes the rows of its own nodes. A program is the
//! same for one process and for many:
//!
//! ```no_run
//! use emmy::mesh::{self, Share, owners};
//! use emmy::prelude::*;
//!
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
//! All ranks must make the same calls in the same order. Builds with debug assertions compare the calls of all ranks and end
//! with a message where they differ; others would wait for each other.

mod shim;

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, ThreadId};

use emmy::team::{Parcel, Team};

/// Exit code after a panic, or after a call of MPI that failed.
const FAILED: i32 = 101;

/// Runs a function with the team of all processes that `mpirun` started; alone without `mpirun`. The function runs in the
/// thread that calls, and only this thread may use the team, until the function returns. A panic on one rank ends all ranks
/// with the exit code 101. A rank that returns while others wait for its calls is found in builds with debug assertions; in
/// others they wait for ever, so return errors of all ranks only ([`emmy::Error`] of a body, a motion or a step is one).
///
/// # Panics
/// As the function, with one process.
pub fn run<T>(rank: impl FnOnce(Arc<dyn Team>) -> T) -> T {
    let (number, size, is_ours) = shim::start().unwrap_or_else(|message| fail(None, &message));
    let team = Arc::new(Ranks {
        rank: number,
        size,
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

    /// Combines the numbers of all ranks one by one, in the order of the ranks, so that the library's own order of additions
    /// has no effect.
    fn combine(&self, values: &mut [f64], combine: impl Fn(f64, f64) -> f64) {
        if values.is_empty() {
            return;
        }
        let mut all = self.gathered.lock().unwrap_or_else(PoisonError::into_inner);
        all.resize(self.size * values.len(), 0.0);
        self.check(shim::gather(values, &mut all, self.size));
        let mut ranks = all.chunks_exact(values.len());
        if let Some(first) = ranks.next() {
            values.copy_from_slice(first);
        }
        for own in ranks {
            values.iter_mut().zip(own).for_each(|(value, own)| *value = combine(*value, *own));
        }
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
        self.combine(values, |most, value| if value.is_nan() || value > most { value } else { most });
    }

    fn exchange(&self, name: &'static str, parcels: &mut [Parcel]) {
        self.begin("exchange", name, 0);
        self.check(shim::exchange(parcels));
    }
}
