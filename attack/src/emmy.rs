//! Runs the binary under attack, within limits.

use std::cell::OnceCell;
use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::base::Base;
use crate::place::Place;

/// CPU seconds after which a command counts as hung.
const CPU_SECONDS: u64 = 10;

/// Wall seconds after which a command counts as hung; larger because the machine may be busy.
const WALL_SECONDS: u64 = 30;

/// Limit of the memory in kilobytes.
const MEMORY: u64 = 2 << 20;

/// The binary.
#[derive(Debug)]
pub struct Emmy {
    path: PathBuf,
    base: OnceCell<Base>,
}

/// The result of a call.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The call, for messages.
    pub call: String,
    /// Exit code; `None` after a signal.
    pub code: Option<i32>,
    /// The signal that ended it.
    pub signal: Option<i32>,
    /// Whether it was stopped because it took too long.
    pub is_hung: bool,
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
}

/// A call of the binary in a directory.
#[derive(Debug)]
pub struct Call<'a> {
    emmy: &'a Emmy,
    directory: PathBuf,
    arguments: Vec<OsString>,
    before: String,
    shell: String,
    kill_after: Option<Duration>,
}

impl Emmy {
    /// The binary at a path.
    pub fn new(path: PathBuf) -> Self {
        Emmy { path, base: OnceCell::new() }
    }

    /// Finished runs, computed once.
    pub fn base(&self) -> &Base {
        self.base.get_or_init(|| Base::new(self))
    }

    /// A call in a directory.
    pub fn call<S: AsRef<OsStr>>(
        &self,
        directory: impl AsRef<Path>,
        arguments: impl IntoIterator<Item = S>,
    ) -> Call<'_> {
        Call {
            emmy: self,
            directory: directory.as_ref().to_path_buf(),
            arguments: arguments.into_iter().map(|argument| argument.as_ref().to_os_string()).collect(),
            before: String::new(),
            shell: "exec \"$@\"".into(),
            kill_after: None,
        }
    }

    /// Names in a list of the binary.
    ///
    /// # Panics
    /// If it lists nothing.
    pub fn list(&self, what: &str) -> Vec<String> {
        let outcome = self.call("/", ["list", what, "--json"]).run();
        let list: serde_json::Value = serde_json::from_str(&outcome.stdout).expect("JSON");
        let name = |item: &serde_json::Value| item["name"].as_str().expect("a name").to_string();
        list.as_array().expect("a list").iter().map(name).collect()
    }
}

impl Call<'_> {
    /// Adds a shell command before the call, such as a limit.
    pub fn after(mut self, command: &str) -> Self {
        self.before = format!("{command}; ");
        self
    }

    /// Replaces the call by a shell command, in which `"$@"` is the call.
    pub fn within(mut self, shell: &str) -> Self {
        self.shell = shell.into();
        self
    }

    /// Kills the call after a time.
    pub fn killed_after(mut self, time: Duration) -> Self {
        self.kill_after = Some(time);
        self
    }

    /// Runs the call.
    ///
    /// # Panics
    /// If there is no shell.
    pub fn run(self) -> Outcome {
        let streams = Place::new();
        let mut child = self.start(&streams);
        let (start, mut is_hung) = (Instant::now(), false);
        let limit = self.kill_after.unwrap_or(Duration::from_secs(WALL_SECONDS));
        let status = loop {
            if let Some(status) = child.try_wait().expect("a child") {
                break status;
            }
            let left = limit.saturating_sub(start.elapsed());
            if left.is_zero() {
                is_hung = self.kill_after.is_none();
                child.kill().expect("a child that can be killed");
                break child.wait().expect("a child");
            }
            std::thread::sleep(left.min(Duration::from_millis(1)));
        };
        let text = |name: &str| {
            let bytes = fs::read(streams.path(name)).unwrap_or_default();
            String::from_utf8_lossy(&bytes).into_owned()
        };
        Outcome {
            call: self.text(),
            code: status.code(),
            signal: status.signal(),
            is_hung,
            stdout: text("stdout"),
            stderr: text("stderr"),
        }
    }

    fn start(&self, streams: &Place) -> Child {
        let limits = format!("ulimit -c 0; ulimit -t {CPU_SECONDS}; ulimit -v {MEMORY}; ");
        let file = |name: &str| File::create(streams.path(name)).expect("a file of its own");
        Command::new("sh")
            .args(["-c", &format!("{limits}{}{}", self.before, self.shell), "sh"])
            .arg(&self.emmy.path)
            .args(&self.arguments)
            .current_dir(&self.directory)
            .env("NO_COLOR", "1")
            .env("RAYON_NUM_THREADS", "1")
            .stdin(Stdio::null())
            .stdout(file("stdout"))
            .stderr(file("stderr"))
            .spawn()
            .expect("a shell")
    }

    fn text(&self) -> String {
        let arguments = self.arguments.iter().map(|argument| argument.to_string_lossy());
        let call = format!("emmy {}", arguments.collect::<Vec<_>>().join(" "));
        match self.shell.as_str() {
            "exec \"$@\"" => format!("{}{call}", self.before),
            shell => format!("{}{}", self.before, shell.replace("\"$@\"", &call)),
        }
    }
}
