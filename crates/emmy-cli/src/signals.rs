//! Signals: Ctrl-C and SIGTERM stop a run at the end of its step, and a second one ends the program at once. After
//! every signal that can be handled, the status in the summary is no longer `running`.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};

use emmy::motion::{Observer, View};
use emmy_io::summary::{self, Status};

use crate::failure::{Failure, INTERRUPTED};
use crate::host::Host;
use crate::program::line;

static ASKED: AtomicBool = AtomicBool::new(false);

/// Installs the handlers.
pub(crate) fn listen() -> Result<(), Failure> {
    let deaf = |error: &dyn fmt::Display| Failure::Other(format!("cannot listen to signals: {error}"));
    listen_to_others().map_err(|error| deaf(&error))?;
    let heard = || {
        if ASKED.swap(true, Ordering::SeqCst) {
            end("stopped at once by a second signal");
        }
        line("stopping at the end of this step; a second signal stops at once");
    };
    ctrlc::set_handler(heard).map_err(|error| deaf(&error))
}

/// Ends the program at once.
fn end(why: &str) -> ! {
    summary::abandon(Status::Interrupted, why);
    std::process::exit(INTERRUPTED.into());
}

/// Handles further signals than `ctrlc`; otherwise they would end the program silently.
#[cfg(unix)]
fn listen_to_others() -> std::io::Result<()> {
    use signal_hook::consts::{SIGQUIT, SIGUSR1, SIGUSR2, SIGXCPU, SIGXFSZ};
    // With a handler, a file that exceeds the size limit is a write error.
    signal_hook::flag::register(SIGXFSZ, Default::default())?;
    // Batch systems send these before they kill a job, some of them more than once.
    let mut signals = signal_hook::iterator::Signals::new([SIGQUIT, SIGUSR1, SIGUSR2, SIGXCPU])?;
    std::thread::spawn(move || {
        for signal in signals.forever() {
            if signal == SIGQUIT {
                end("stopped at once by SIGQUIT");
            } else if !ASKED.swap(true, Ordering::SeqCst) {
                line(&format!("stopping at the end of this step because of signal {signal}"));
            }
        }
    });
    Ok(())
}

#[cfg(not(unix))]
fn listen_to_others() -> std::io::Result<()> {
    Ok(())
}

/// Whether a signal has asked to stop.
pub(crate) fn is_asked() -> bool {
    ASKED.load(Ordering::SeqCst)
}

/// Ends a march when the host asks to stop.
#[derive(Debug)]
pub(crate) struct Stop<'h>(pub &'h dyn Host);

/// The march was stopped by the host.
#[derive(Debug)]
pub(crate) struct Interrupted {
    step: usize,
    time: f64,
}

impl fmt::Display for Interrupted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "stopped after step {}, t = {}", self.step, self.time)
    }
}

impl std::error::Error for Interrupted {}

impl Observer for Stop<'_> {
    fn observe(&mut self, view: View<'_>) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        let step = view.record.step;
        let time = view.record.time;
        if self.0.is_interrupted() { Err(Box::new(Interrupted { step, time })) } else { Ok(()) }
    }
}
