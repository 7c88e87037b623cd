//! The place of a failure.

use super::EventKind;
use crate::body::Body;
use crate::error::Error;
use crate::time::State;

/// The error of a step; an inverted cell has its place, and an iteration that did not converge the contact there.
pub(super) fn placed(mut error: Error, body: &Body, state: &State, step_size: f64) -> Error {
    if let Error::NoConvergence { node, contact, .. } | Error::NotBalanced { node, contact, .. } = &mut error
    {
        *contact = body.contact_near(*node, &state.displacement).map(Box::from);
    }
    let Error::Inverted { cell, det } = *cause_of(&error) else { return error };
    let Some((kind, centre)) = body.space.at_cell(cell, |node| state.position(body, node)) else {
        return error;
    };
    Error::CellInverted {
        step: state.step + 1,
        time: state.time + step_size,
        cell,
        kind,
        position: centre,
        det,
    }
}

/// Whether a smaller step may succeed where one has failed.
pub(super) fn may_shrink_after(error: &Error) -> bool {
    let is_final = |cause: &Error| matches!(cause, Error::NotFiniteAt { .. } | Error::NotOnTeam { .. });
    !is_final(cause_of(error)) && !is_lost(error)
}

/// Whether a step was lost in the rounding of the time.
pub(super) fn is_lost(error: &Error) -> bool {
    matches!(cause_of(error), Error::NoDuration { .. })
}

/// The event of a step that is cut because of an error.
pub(super) fn event_of_cut(error: &Error) -> EventKind {
    match cause_of(error) {
        Error::Passed { .. } => EventKind::Passed,
        _ => EventKind::Cut,
    }
}

/// The error that made a step fail.
fn cause_of(error: &Error) -> &Error {
    match error {
        Error::StepFailed { cause, .. } => cause,
        error => error,
    }
}
