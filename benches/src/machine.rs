//! The machine of the measurements, as far as the system describes it.

use std::process::Command;

/// Goal for the fastest other program over Emmy: their arithmetic gains less from wide registers.
pub(crate) fn times_faster() -> f64 {
    if has_avx512() { 10.0 } else { 8.0 }
}

fn has_avx512() -> bool {
    #[cfg(target_arch = "x86_64")]
    return std::is_x86_feature_detected!("avx512f");
    #[cfg(not(target_arch = "x86_64"))]
    false
}

/// A line about machine, date and versions, for the top of the tables.
pub(crate) fn heading() -> String {
    let cpus = std::thread::available_parallelism().map_or(1, usize::from);
    let rustc = first_line("rustc", &["--version"]).unwrap_or("an unknown rustc".into());
    let commit = commit().unwrap_or_default();
    let date = first_line("date", &["+%Y-%m-%d"]).unwrap_or("unknown date".into());
    let load = load().unwrap_or_default();
    let build = if cfg!(debug_assertions) { ", a build for tests: its times mean nothing" } else { "" };
    format!(
        "{date}; {} {} AVX-512, {cpus} CPUs{load}; {rustc}; Emmy {}{commit}{build}",
        processor(),
        if has_avx512() { "with" } else { "without" },
        env!("CARGO_PKG_VERSION")
    )
}

fn processor() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    name.map_or(std::env::consts::ARCH, |(_, name)| name).to_string()
}

/// Processes that were running or waiting in the last minute: other users of the machine.
fn load() -> Option<String> {
    let text = std::fs::read_to_string("/proc/loadavg").ok()?;
    Some(format!(", load {} at the start", text.split_whitespace().next()?))
}

fn commit() -> Option<String> {
    let folder = env!("CARGO_MANIFEST_DIR");
    let commit = first_line("git", &["-C", folder, "rev-parse", "--short", "HEAD"])?;
    let changed = first_line("git", &["-C", folder, "status", "--porcelain", "--untracked-files=no"]);
    Some(format!(", commit {commit}{}", if changed.is_some() { " with changes" } else { "" }))
}

/// First line printed by a program; `None` if it does not run.
fn first_line(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    let text = String::from_utf8_lossy(&output.stdout);
    text.lines().next().filter(|_| output.status.success()).map(str::to_string)
}
