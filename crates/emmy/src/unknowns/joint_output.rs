//! Forces and coordinates of joints.

use std::ops::Range;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::affine::Affine;
use super::constraint::Coordinate;
use super::constraint_step::ConstraintStep;
use super::constraints::Constraints;
use super::joint::Measure;
use super::joint_force::JointLaw;
use crate::force::StepInput;
use crate::tensor::cross;

/// Force and coordinate of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct JointState {
    /// Force on the first body, its mean over the last step \[force\].
    pub force: [f64; 3],
    /// Moment on the first body about its point of the joint, its mean over the last step \[force length\].
    pub moment: [f64; 3],
    /// The torque about the axis, the force along it, or the force that opens the distance, by which a drive, a spring,
    /// a damping or a motor acts on the first body, its mean over the last step.
    pub drive: f64,
    /// The angle of the first body about the axis of the second, counted on over full turns \[rad\], its slide along
    /// the axis, or the distance of the points \[length\]; 0 of other joints.
    pub coordinate: f64,
}

/// The output of a joint, from constraints and positions.
#[derive(Debug)]
pub(crate) struct JointOutput {
    /// Numbers of its constraints.
    rows: Range<usize>,
    /// Nodes of the body whose forces are summed, ascending, and their sign: the first body, unless it is the ground.
    nodes: Vec<u32>,
    sign: f64,
    /// The point of the first body.
    point: Affine,
    measure: Option<Measure>,
    law: Option<Arc<JointLaw>>,
}

impl JointOutput {
    /// The output of a joint whose constraints have some numbers.
    pub(crate) fn new(
        points: [Affine; 2],
        rows: Range<usize>,
        measure: Option<Measure>,
        law: Option<Arc<JointLaw>>,
    ) -> Self {
        let [point, other] = points;
        let (side, sign) = if point.nodes.is_empty() { (&other, -1.0) } else { (&point, 1.0) };
        let mut nodes = side.nodes.clone();
        nodes.sort_unstable();
        JointOutput { rows, nodes, sign, point, measure, law }
    }

    /// Its spring, damper and motor.
    pub(crate) fn law(&self) -> Option<&Arc<JointLaw>> {
        self.law.as_ref()
    }

    /// Number of its constraints.
    pub(crate) fn n_rows(&self) -> usize {
        self.rows.len()
    }

    /// Adds the part of a stage to the force of the last step.
    pub(crate) fn add_force(
        &self,
        constraints: &Constraints,
        (step, times): (&StepInput<'_>, &ConstraintStep),
        (stage, multipliers): (usize, &[f64]),
        points: &[[f64; 3]],
        state: &mut JointState,
    ) {
        let u = |dof: usize| step.displacement_in(stage, dof);
        let about = self.point.value(u);
        // Adds a force along a degree of freedom.
        let add = |state: &mut JointState, dof: usize, size: f64| {
            let (node, axis) = (dof / 3, dof % 3);
            if self.nodes.binary_search(&(node as u32)).is_ok() {
                let mut force = [0.0; 3];
                force[axis] = self.sign * size;
                let moment = cross([0, 1, 2].map(|d| points[node][d] + u(3 * node + d) - about[d]), force);
                state.force[axis] += force[axis];
                (0..3).for_each(|d| state.moment[d] += moment[d]);
            }
        };
        let b = step.rule.weights()[stage];
        for c in self.rows.clone() {
            let row = times.row(constraints, stage, c);
            let size = -b / times.step_size().powi(2) * multipliers[stage * constraints.len() + c];
            row.for_each_gradient(&u, &mut |dof, gradient| add(state, dof, size * gradient));
            state.drive += size * row.drive_arm(&u);
        }
        if let Some(law) = &self.law {
            let size = b * law.force(step, stage, times.time(stage));
            law.measure().for_each_gradient(&u, &mut |dof, gradient| add(state, dof, size * gradient));
            state.drive += size;
        }
    }

    /// The coordinate at some displacements, an angle within half a turn of the last one.
    pub(crate) fn coordinate(&self, last: f64, u: &dyn Fn(usize) -> f64) -> f64 {
        let Some(measure) = &self.measure else { return 0.0 };
        let value = measure.value(u);
        match measure.coordinate() {
            Coordinate::Angle => value + TURN * ((last - value) / TURN).round(),
            Coordinate::Slide | Coordinate::Distance(_) => value,
        }
    }
}

const TURN: f64 = 2.0 * std::f64::consts::PI;
