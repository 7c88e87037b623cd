//! Parts of messages: advice after a failed step, and names of joints that contradict each other.

use super::Error;
use crate::number::{short, short_vector};

/// Advice after a step that failed with every size.
pub(super) fn advice_on_steps(cause: &Error, has_cells: bool) -> String {
    let advice = match cause {
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
    };
    match (passing(cause), contact_of(cause)) {
        (Some(passing), _) => {
            format!("{passing}: try a smaller `smallest_step`, and look at the loads and the speeds there")
        }
        (None, Some(contact)) => format!(
            "it fails in contact \"{contact}\": try a larger `distance` of its layer, a smaller `smallest_step`, or \
             another scheme, and look at the loads at this time"
        ),
        (None, None) => advice.to_string(),
    }
}

/// Advice after a step without a starting point.
pub(super) fn advice_on_failure(cause: &Error, has_cells: bool) -> String {
    match passing(cause) {
        Some(passing) => format!(": {passing}; try a smaller step"),
        None => format!(
            "; try a smaller step, and look at the loads and {}",
            if has_cells { "the material" } else { "the joints" }
        ),
    }
}

/// Advice after increments of the load that failed with every size.
pub(super) fn advice_on_equilibrium(cause: &Error) -> String {
    match (passing(cause), contact_of(cause)) {
        (Some(passing), _) => format!("{passing}: try smaller loads, or supports that lead the body there"),
        (None, contact) => format!(
            "the body may snap through or buckle there{}: try smaller loads, more supports, or a motion in which the \
             loads grow slowly, with damping",
            contact.map_or(String::new(), |name| format!(", or slide in contact \"{name}\""))
        ),
    }
}

/// The contact in which something would pass through its opponent, with the place, if this is the error.
fn passing(error: &Error) -> Option<String> {
    match error {
        Error::Passed { contact, at } => {
            Some(format!("in contact \"{contact}\" something would pass near {}", short_vector(at)))
        }
        Error::StepFailed { cause, .. } => passing(cause),
        _ => None,
    }
}

/// The contact in which an iteration did not converge.
fn contact_of(error: &Error) -> Option<&str> {
    match error {
        Error::NoConvergence { contact, .. } | Error::NotBalanced { contact, .. } => contact.as_deref(),
        _ => None,
    }
}

/// The contact at a node, behind its position.
pub(super) fn in_contact(contact: &Option<Box<str>>) -> String {
    contact.as_ref().map_or(String::new(), |name| format!(" in contact \"{name}\""))
}

/// The contacts of a body that do not touch, with their smallest gaps and distances.
pub(super) fn far_away(contacts: &[(String, [f64; 2])]) -> String {
    let words = |(name, [gap, distance]): &(String, [f64; 2])| {
        let gap = match gap.is_finite() {
            true => format!("the smallest gap of contact \"{name}\" is {}", short(gap)),
            false => format!("nothing is near in contact \"{name}\""),
        };
        format!(
            "; {gap}, and its layer begins at a distance of {}: move it nearer, or hold it",
            short(distance)
        )
    };
    contacts.iter().take(MAX_NAMED).map(words).collect()
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
