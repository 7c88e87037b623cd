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
    /// Slide of a cylindrical joint along the axis of its second body \[length\]; 0 of other joints.
    #[serde(default)]
    pub slide: f64,
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
    slide: Option<Measure>,
    law: Option<Arc<JointLaw>>,
}

impl JointOutput {
    /// The output of a joint whose constraints have some numbers.
    pub(crate) fn new(
        points: [Affine; 2],
        rows: Range<usize>,
        [measure, slide]: [Option<Measure>; 2],
        law: Option<Arc<JointLaw>>,
    ) -> Self {
        let [point, other] = points;
        let (side, sign) = if point.nodes.is_empty() { (&other, -1.0) } else { (&point, 1.0) };
        let mut nodes = side.nodes.clone();
        nodes.sort_unstable();
        JointOutput { rows, nodes, sign, point, measure, slide, law }
    }

    /// Its spring, damper and motor.
    pub(crate) fn law(&self) -> Option<&Arc<JointLaw>> {
        self.law.as_ref()
    }

    /// Numbers of its constraints.
    pub(crate) fn rows(&self) -> Range<usize> {
        self.rows.clone()
    }

    /// Number of its constraints.
    pub(crate) fn n_rows(&self) -> usize {
        self.rows.len()
    }

    /// The force in a solved step or an equilibrium, whose multipliers times a factor are forces.
    pub(crate) fn state(
        &self,
        constraints: &Constraints,
        (step, times): (&StepInput<'_>, &ConstraintStep),
        (factor, multipliers): (f64, &[f64]),
        points: &[[f64; 3]],
    ) -> JointState {
        let mut state = JointState::default();
        let of_law = self.law.as_ref().map(|law| (law, law.forces(step, times.span())));
        for (stage, b) in step.rule.weights().iter().enumerate() {
            let u = |dof: usize| step.displacement_in(stage, dof);
            let about = self.point.value(u);
            // Adds a force along a degree of freedom.
            let add = |state: &mut JointState, dof: usize, size: f64| {
                let (node, axis) = (dof / 3, dof % 3);
                if self.nodes.binary_search(&(node as u32)).is_ok() {
                    let mut force = [0.0; 3];
                    force[axis] = self.sign * size;
                    let arm = [0, 1, 2].map(|d| points[node][d] + u(3 * node + d) - about[d]);
                    let moment = cross(arm, force);
                    state.force[axis] += force[axis];
                    (0..3).for_each(|d| state.moment[d] += moment[d]);
                }
            };
            for c in self.rows.clone() {
                let row = times.row(constraints, stage, c);
                let size = -b * (factor * multipliers[stage * constraints.len() + c]);
                row.for_each_gradient(&u, &mut |dof, gradient| add(&mut state, dof, size * gradient));
                state.drive += size * row.drive_arm(&u);
            }
            if let Some((law, forces)) = &of_law {
                let size = b * forces[stage];
                law.measure()
                    .for_each_gradient(&u, &mut |dof, gradient| add(&mut state, dof, size * gradient));
                state.drive += size;
            }
        }
        state
    }

    /// The coordinate at the end of a solved step, given that at its start. An angle is counted on along the path: the
    /// ends alone do not tell full turns.
    pub(crate) fn counted_on(&self, (step, times): (&StepInput<'_>, &ConstraintStep), start: f64) -> f64 {
        let Some(measure) = &self.measure else { return 0.0 };
        let end = measure.value(&|dof| step.displacement_at_end(dof));
        if measure.coordinate() != Coordinate::Angle {
            return end;
        }
        let at = |integrals: &[f64]| measure.value(&|dof| step.displacement_at(integrals, dof));
        let last = times.path().fold(start, |last, integrals| measure.counted(at(integrals), last));
        measure.counted(end, last)
    }

    /// The coordinate at some displacements, counted on from one before.
    pub(crate) fn coordinate(&self, u: &dyn Fn(usize) -> f64, before: f64) -> f64 {
        self.measure.as_ref().map_or(0.0, |measure| measure.counted(measure.value(u), before))
    }

    /// Sets coordinate and slide at some displacements, given the coordinate to half a turn.
    pub(crate) fn set_coordinates(&self, u: &dyn Fn(usize) -> f64, coordinate: f64, state: &mut JointState) {
        state.coordinate = self.coordinate(u, coordinate);
        state.slide = self.slide.as_ref().map_or(0.0, |slide| slide.value(u));
    }
}
