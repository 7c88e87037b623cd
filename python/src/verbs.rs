//! The verbs of the command line.

use std::ffi::OsString;
use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::time::Duration;

use emmy_cli::Host;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::{errors, pool};

/// Time between two looks at the signals.
const BETWEEN_LOOKS: Duration = Duration::from_millis(50);

/// Text of a verb on its way to Python.
enum Text {
    Output(String),
    Message(String),
}

/// The package as the environment of a verb.
struct Package<'a> {
    texts: std::sync::Mutex<Sender<Text>>,
    is_interrupted: &'a AtomicBool,
}

impl Package<'_> {
    fn send(&self, text: Text) -> io::Result<()> {
        let texts = self.texts.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        texts.send(text).map_err(|_| io::Error::other("the receiver of the output is gone"))
    }
}

impl Host for Package<'_> {
    fn output(&self, text: &str) -> io::Result<()> {
        self.send(Text::Output(text.to_string()))
    }

    fn message(&self, text: &str) {
        let _ = self.send(Text::Message(text.to_string()));
    }

    /// `Run.accuracy` and the columns of a sweep have it.
    fn statement(&self, _: &str) {}

    fn is_interrupted(&self) -> bool {
        self.is_interrupted.load(Ordering::Relaxed)
    }
}

/// Runs a verb and returns what it prints; messages go to a function. Only the main thread hears signals, so the verb
/// runs in another one.
#[pyfunction]
pub(crate) fn verb(py: Python<'_>, argv: Vec<OsString>, messages: Option<Py<PyAny>>) -> PyResult<String> {
    let is_interrupted = AtomicBool::new(false);
    let (sender, texts) = channel();
    let host = Package { texts: std::sync::Mutex::new(sender), is_interrupted: &is_interrupted };
    let pool = pool::shared()?;
    let is_interrupted = &is_interrupted;
    let (ended, output, raised) = py.detach(move || {
        let mut output = String::new();
        let mut raised = None;
        let mut take = |py: Python<'_>, text| match text {
            Text::Output(text) => {
                output.push_str(&text);
                Ok(())
            }
            Text::Message(text) => {
                messages.as_ref().map_or(Ok(()), |messages| messages.call1(py, (text,)).map(drop))
            }
        };
        let ended = std::thread::scope(|scope| {
            let run = scope.spawn(move || {
                let ended = pool.install(|| emmy_cli::run_verb(&argv, &host));
                drop(host);
                ended
            });
            loop {
                let text = match texts.recv_timeout(BETWEEN_LOOKS) {
                    Ok(text) => Some(text),
                    Err(RecvTimeoutError::Timeout) => None,
                    Err(RecvTimeoutError::Disconnected) => break,
                };
                let looked = Python::attach(|py| {
                    py.check_signals()?;
                    text.map_or(Ok(()), |text| take(py, text))
                });
                if let Err(error) = looked {
                    is_interrupted.store(true, Ordering::Relaxed);
                    raised.get_or_insert(error);
                }
            }
            run.join()
        });
        (ended, output, raised)
    });
    if let Some(raised) = raised {
        return Err(raised);
    }
    let ended =
        ended.map_err(|_| PyRuntimeError::new_err("internal error: a verb panicked; please report it"))?;
    ended.map(|()| output).map_err(|failure| errors::failure(py, failure))
}

/// The program `emmy`: its exit code.
#[pyfunction]
pub(crate) fn main(py: Python<'_>, argv: Vec<OsString>) -> u8 {
    py.detach(|| emmy_cli::exit_code(argv))
}
