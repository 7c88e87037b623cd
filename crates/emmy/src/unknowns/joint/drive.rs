//! A coordinate of a joint that is given over time.

use super::{Constraint, Coordinate, Drive, Ends, JointParts, Measure, Result, TimeFunction, dot3};

/// Gives the coordinate of a joint: an angle or a slide by one more constraint, a distance in its own.
pub(super) fn add(ends: &Ends<'_>, law: &TimeFunction, parts: &mut JointParts) -> Result<()> {
    let drive = |coordinate| Some(Drive::new(law.clone(), coordinate));
    let own = &mut parts.constraints;
    match &parts.measure {
        Some(Measure::Angle([own_axis, first, second])) => {
            let pairs = [(first, 0.0), (second, 1.0)].map(|(other, c)| (own_axis.clone(), other.clone(), c));
            let angle = Constraint::new(pairs.to_vec(), 0.0);
            own.push(Constraint { drive: drive(Coordinate::Angle), ..angle });
        }
        Some(Measure::Slide([offset, axis])) => {
            let slide = Constraint::new(vec![(offset.clone(), axis.clone(), 1.0)], 0.0);
            own.push(Constraint { drive: drive(Coordinate::Slide), ..slide });
        }
        Some(Measure::Distance(arm)) => {
            let length = dot3(arm.reference, arm.reference).sqrt();
            own[0].drive = drive(Coordinate::Distance(length));
        }
        None => {
            let word = ends.joint.kind.word();
            return Err(ends.fault(format!("a {word} joint has no angle, slide or distance to give")));
        }
    }
    if let Some(time) = law.first_jump() {
        return Err(ends.fault(format!("its motion jumps at t = {time}")));
    }
    if !law.has_rate() {
        return Err(ends.fault("its motion has no rate"));
    }
    Ok(())
}
