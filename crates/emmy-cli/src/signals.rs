//! Signals: Ctrl-C and SIGTERM stop a run at the end of its step, and a second one ends the program at once. After
//! every signal that can be handled, the status in the summary is no longer `running`.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use emmy::motion::{Observer, View};
use emmy_io::summary::{self, Status};

use crate::failure::{Failure, INTERRUPTED};
use crate::host::Host;
use crate::program::line;

static ASKED: AtomicBool = AtomicBool::new(false);

/// Installs the handlers; they announce the end of the run if it `is_shown`.
pub(crate) fn listen(is_shown: bool) -> Result<(), Failure> {
    let deaf = |error: &dyn fmt::Display| Failure::Other(format!("cannot listen to signals: {error}"));
    listen_to_others(is_shown).map_err(|error| deaf(&error))?;
    ctrlc::set_handler(move || heard(is_shown)).map_err(|error| deaf(&error))
}

/// A signal of a user.
fn heard(is_shown: bool) {
    if ASKED.swap(true, Ordering::SeqCst) {
        end("stopped at once by a second signal");
    }
    if is_shown {
        line("stopping at the end of this step; a second signal stops at once");
    }
}

/// Turns a file beyond the system's limit on its size into an error of writing, with a message; otherwise a signal
/// would end the program silently. Programs call it first.
pub fn report_file_limits() {
    #[cfg(unix)]
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Default::default());
}

/// Ends the program at once.
fn end(why: &str) -> ! {
    summary::abandon(Status::Interrupted, why);
    std::process::exit(INTERRUPTED.into());
}

/// Handles further signals than `ctrlc`; otherwise they would end the program silently.
#[cfg(unix)]
fn listen_to_others(is_shown: bool) -> std::io::Result<()> {
    use signal_hook::consts::{SIGQUIT, SIGUSR1, SIGUSR2, SIGXCPU};
    // Batch systems send these before they kill a job, some of them more than once.
    let mut signals = signal_hook::iterator::Signals::new([SIGQUIT, SIGUSR1, SIGUSR2, SIGXCPU])?;
    std::thread::spawn(move || {
        for signal in signals.forever() {
            if signal == SIGQUIT {
                heard(is_shown);
            } else if !ASKED.swap(true, Ordering::SeqCst) && is_shown {
                line(&format!("stopping at the end of this step because of signal {signal}"));
            }
        }
    });
    Ok(())
}

#[cfg(not(unix))]
fn listen_to_others(_: bool) -> std::io::Result<()> {
    Ok(())
}

/// Whether a signal has asked to stop.
pub(crate) fn is_asked() -> bool {
    ASKED.load(Ordering::SeqCst)
}

/// Name of a file in the directory of a run that stops it at the end of its step.
const STOP_FILE: &str = "stop";

/// Ends a march when the host asks to stop, when there is a file `stop` in the directory of the run, or when its time
/// is over. On a team one rank is enough: all end at the same step.
#[derive(Debug)]
pub(crate) struct Stop<'h> {
    host: &'h dyn Host,
    /// The file, on the rank that looks for it.
    file: Option<PathBuf>,
    /// When the time is over.
    end: Option<Instant>,
}

impl<'h> Stop<'h> {
    /// The observer of a run in a directory, which has time until `end`. A file that an earlier run left is removed.
    pub(crate) fn new(host: &'h dyn Host, directory: &Path, end: Option<Instant>) -> Self {
        let is_first = host.team().is_none_or(|team| team.rank() == 0);
        let file = is_first.then(|| directory.join(STOP_FILE));
        let stop = Stop { host, file, end };
        stop.has_file();
        stop
    }

    /// Whether there is the file; it is removed.
    fn has_file(&self) -> bool {
        self.file.as_ref().is_some_and(|file| std::fs::remove_file(file).is_ok())
    }
}

/// The march was stopped by the host.
#[derive(Debug)]
pub(crate) struct Interrupted {
    step: usize,
    time: f64,
    reason: &'static str,
}

/// Reason why a march is stopped, as the end of a sentence; empty if the host has given it.
const REASONS: [&str; 3] = ["", ", by the file `stop`", ", by --wall-limit"];

impl fmt::Display for Interrupted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "stopped after step {}, t = {}{}", self.step, self.time, self.reason)
    }
}

impl std::error::Error for Interrupted {}

impl Observer for Stop<'_> {
    fn observe(&mut self, view: View<'_>) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        let step = view.record.step;
        let time = view.record.time;
        let is_over = self.end.is_some_and(|end| Instant::now() >= end);
        let asked = [self.host.is_interrupted(), self.has_file(), is_over];
        // Number of the reason, from one; any other rank may have one.
        let mut reason = [asked.into_iter().rposition(|asked| asked).map_or(0.0, |index| (index + 1) as f64)];
        if let Some(team) = self.host.team() {
            team.largest("whether to stop", &mut reason);
        }
        match reason[0] as usize {
            0 => Ok(()),
            number => Err(Box::new(Interrupted { step, time, reason: REASONS[number - 1] })),
        }
    }
}
