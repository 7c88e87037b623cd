//! Checks that hold for every call.

use std::fs;
use std::path::Path;

use crate::emmy::Outcome;

/// Largest length of a message in bytes.
const MAX_MESSAGE: usize = 20_000;

/// Documented exit codes.
const CODES: [i32; 6] = [0, 1, 2, 3, 4, 130];

/// Signal of the CPU time limit.
const OUT_OF_TIME: i32 = 24;

/// Checks a call: no panic, no signal, no hang, and a message after a failure.
///
/// # Errors
/// The fault.
pub fn check(outcome: &Outcome) -> Result<(), String> {
    let fault = |what: String| Err(format!("{what}: {}\n{}", outcome.call, excerpt(&outcome.stderr)));
    if outcome.is_hung || outcome.signal == Some(OUT_OF_TIME) {
        return fault("hangs".into());
    }
    if let Some(signal) = outcome.signal {
        return fault(format!("ended by signal {signal}"));
    }
    let code = outcome.code.unwrap_or(-1);
    if !CODES.contains(&code) || outcome.stderr.contains("panicked at") {
        return fault(format!("exit code {code}"));
    }
    if code != 0 && outcome.stderr.trim().is_empty() {
        return fault(format!("exit code {code} without a message"));
    }
    if outcome.stderr.len() > MAX_MESSAGE {
        return fault(format!("a message of {} bytes", outcome.stderr.len()));
    }
    is_printable(&outcome.stderr).or_else(fault)
}

/// Checks that text has no control characters, which a terminal would execute.
///
/// # Errors
/// The first control character.
pub fn is_printable(text: &str) -> Result<(), String> {
    match text.chars().find(|c| c.is_control() && !matches!(c, '\n' | '\t' | '\r')) {
        Some(c) => Err(format!("control character in the output: {c:?}")),
        None => Ok(()),
    }
}

/// Checks a call that must succeed.
///
/// # Errors
/// The fault.
pub fn succeeds(outcome: &Outcome) -> Result<(), String> {
    ends_with(outcome, &[0])
}

/// Checks a call that must end with one of some codes.
///
/// # Errors
/// The fault.
pub fn ends_with(outcome: &Outcome, codes: &[i32]) -> Result<(), String> {
    check(outcome)?;
    match outcome.code {
        Some(code) if codes.contains(&code) => Ok(()),
        code => Err(format!(
            "exit code {}, not one of {codes:?}: {}\n{}",
            code.unwrap_or(-1),
            outcome.call,
            excerpt(&outcome.stderr)
        )),
    }
}

/// Checks that a history has numbers only.
///
/// # Errors
/// The fault.
pub fn is_finite(history: &Path) -> Result<(), String> {
    let text = fs::read_to_string(history).map_err(|error| format!("{}: {error}", history.display()))?;
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap_or("").split(',').collect();
    for line in lines {
        // A body of links has an infinite determinant; one column has words.
        let others = ["smallest_determinant", "limited_by"];
        let cells = names.iter().zip(line.split(',')).filter(|(name, _)| !others.contains(*name));
        let is_number = |cell: &str| cell.is_empty() || cell.parse().is_ok_and(f64::is_finite);
        if let Some((name, cell)) = cells.into_iter().find(|(_, cell)| !is_number(cell)) {
            return Err(format!("{name} is {cell} in {}: {line}", history.display()));
        }
    }
    Ok(())
}

/// The status in the summary of a directory; empty if it is missing.
pub fn status(directory: &Path) -> String {
    let text = fs::read_to_string(directory.join("summary.json")).unwrap_or_default();
    let summary: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
    summary["status"].as_str().unwrap_or_default().to_string()
}

/// Checks that the summary of an ended run does not have the status `running`.
///
/// # Errors
/// The fault.
pub fn has_ended(directory: &Path) -> Result<(), String> {
    match status(directory).as_str() {
        "running" => Err(format!("still `running` in the summary after the end: {}", directory.display())),
        _ => Ok(()),
    }
}

/// The first lines of a text.
pub fn excerpt(text: &str) -> String {
    let lines = text.lines().take(8).map(|line| {
        let short: String = line.chars().take(200).flat_map(char::escape_debug).collect();
        format!("    {short}")
    });
    lines.collect::<Vec<_>>().join("\n")
}
