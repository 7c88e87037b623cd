//! Parts of messages: advice after a failed step, and names of joints that contradict each other.

use super::Error;

/// Advice after a step that failed with every size.
pub(super) fn advice_on_steps(cause: &Error, has_cells: bool) -> &'static str {
    match cause {
        Error::Tolerance { .. } => "allow smaller steps, or a larger tolerance",
        Error::ConstraintsLost { .. } | Error::NoMotion { .. } => {
            "look at the joints and their given motions at this time"
        }
        _ if !has_cells => {
            "try another scheme, or a smaller `smallest_step`, and look at the joints, their springs and the loads at this time"
        }
        _ => {
            "try another scheme or material, a finer mesh, or a smaller `smallest_step`, and look at the loads at this time"
        }
    }
}

/// Why joints with given motions, given by their names, leave no motion.
pub(super) fn contradiction(driven: &[String]) -> String {
    match driven {
        [] => "given motions contradict each other".to_string(),
        [one] => format!("the given motion of \"{one}\" contradicts other joints"),
        several => format!("the given motions of {} contradict each other", named(several)),
    }
}

/// Which constraints do not hold after a step of a mechanism with given motions of some joints, and why.
pub(super) fn lost(joints: &[String], driven: &[String]) -> String {
    match driven {
        [] => {
            format!(", most at {}; the mechanism may be at a dead point: try other step sizes", named(joints))
        }
        [_] => format!(
            ", most at {}; {}, or the mechanism is at a dead point",
            named(joints),
            contradiction(driven)
        ),
        // Their names are enough.
        _ => format!(": {}, or the mechanism is at a dead point", contradiction(driven)),
    }
}

/// Largest number of names in a message.
const MAX_NAMED: usize = 6;

/// Names in a sentence: `"a", "b" and "c"`.
fn named(names: &[String]) -> String {
    let quoted = |name: &String| format!("\"{name}\"");
    let (first, rest) = names.split_at(names.len().min(MAX_NAMED));
    let mut parts: Vec<String> = first.iter().map(quoted).collect();
    if !rest.is_empty() {
        parts.push(format!("{} more", rest.len()));
    }
    match parts.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, before)) => format!("{} and {last}", before.join(", ")),
        None => String::new(),
    }
}
