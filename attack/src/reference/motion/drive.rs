//! Motions of driven degrees of freedom.

use crate::reference::history::History;

/// Motion of a driven degree of freedom.
#[derive(Debug, Clone)]
pub enum Drive {
    /// It does not move.
    Fixed,
    /// Factor times a history.
    Move(f64, History),
    /// Rotation about the z axis through a point by a history of the angle, for component 0 or 1 of a node at an arm.
    Turn {
        /// Arm x, y of the node.
        arm: [f64; 2],
        /// Component.
        component: usize,
        /// Angle over time.
        angle: History,
    },
}

impl Drive {
    pub(super) fn displacement(&self, t: f64) -> f64 {
        match self {
            Drive::Fixed => 0.0,
            Drive::Move(factor, history) => factor * history.at(t),
            Drive::Turn { arm, component, angle } => {
                let (s, c) = angle.at(t).sin_cos();
                [c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]][*component] - arm[*component]
            }
        }
    }

    pub(super) fn velocity(&self, t: f64, is_before: bool) -> f64 {
        match self {
            Drive::Fixed => 0.0,
            Drive::Move(factor, history) => factor * history.rate(t, is_before),
            Drive::Turn { arm, component, angle } => {
                let (s, c) = angle.at(t).sin_cos();
                let rate = angle.rate(t, is_before);
                rate * [-s * arm[0] - c * arm[1], c * arm[0] - s * arm[1]][*component]
            }
        }
    }

    pub(super) fn kinks(&self) -> Vec<f64> {
        match self {
            Drive::Move(_, history) | Drive::Turn { angle: history, .. } => history.kinks(),
            Drive::Fixed => Vec::new(),
        }
    }
}
