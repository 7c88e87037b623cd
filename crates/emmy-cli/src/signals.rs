//! Ctrl-C and SIGTERM: a run stops at the end of its step; a second one ends the program at once.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};

use emmy::motion::{Observer, View};

use crate::failure::{Failure, INTERRUPTED};

static ASKED: AtomicBool = AtomicBool::new(false);

/// Has signals heard from now on.
pub fn listen() -> Result<(), Failure> {
    let heard = || {
        if ASKED.swap(true, Ordering::SeqCst) {
            std::process::exit(INTERRUPTED.into());
        }
        eprintln!("stopping at the end of this step; once more ends at once");
    };
    ctrlc::set_handler(heard).map_err(|error| Failure::Other(format!("cannot listen to signals: {error}")))
}

/// Ends a march once a signal has come.
#[derive(Debug)]
pub struct Stop;

/// The march was stopped from outside.
#[derive(Debug)]
pub struct Interrupted {
    step: usize,
    time: f64,
}

impl fmt::Display for Interrupted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "stopped after step {}, t = {}", self.step, self.time)
    }
}

impl std::error::Error for Interrupted {}

impl Observer for Stop {
    fn observe(&mut self, view: View<'_>) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        let (step, time) = (view.record.step, view.record.time);
        if ASKED.load(Ordering::SeqCst) { Err(Box::new(Interrupted { step, time })) } else { Ok(()) }
    }
}
