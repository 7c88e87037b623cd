//! A coordinate of a joint that is given over time.

use super::{Constraint, Coordinate, Drive, Ends, JointParts, Result, TimeFunction};

/// Gives the coordinate of a joint: an angle or a slide by one more constraint, a distance in its own.
pub(super) fn add(ends: &Ends<'_>, number: usize, law: &TimeFunction, parts: &mut JointParts) -> Result<()> {
    let Some(measure) = &parts.measure else {
        let word = ends.joint.kind.word();
        return Err(ends.fault(format!("a {word} joint has no angle, slide or distance to give")));
    };
    let coordinate = measure.coordinate();
    let drive = Some(Drive::new(law.clone(), number, coordinate, ends.joint.until));
    match (coordinate, parts.constraints.last_mut()) {
        (Coordinate::Distance(_), Some(own)) => own.drive = drive,
        (Coordinate::Distance(_), None) => {
            return Err(ends.fault("a line has no given motion; a distance has"));
        }
        _ => parts.constraints.push(Constraint { drive, ..measure.constraint() }),
    }
    if let Some(time) = law.first_jump() {
        return Err(ends.fault(format!("its motion jumps at t = {time}")));
    }
    if !law.has_rate() {
        return Err(ends.fault("its motion has no rate"));
    }
    Ok(())
}
