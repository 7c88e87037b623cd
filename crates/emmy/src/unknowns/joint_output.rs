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

    /// The force in a solved step, and in the place of the coordinate the change of an angle.
    pub(crate) fn state(
        &self,
        constraints: &Constraints,
        (step, times): (&StepInput<'_>, &ConstraintStep),
        multipliers: &[f64],
        points: &[[f64; 3]],
    ) -> JointState {
        let mut state = JointState { coordinate: self.turning(step, times), ..JointState::default() };
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
                let size = -b / times.step_size().powi(2) * multipliers[stage * constraints.len() + c];
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

    /// The change of an angle in a step, counted on along its path: its ends alone do not tell full turns.
    fn turning(&self, step: &StepInput<'_>, times: &ConstraintStep) -> f64 {
        let Some(measure) = self.measure.as_ref().filter(|own| own.coordinate() == Coordinate::Angle) else {
            return 0.0;
        };
        let mut last = measure.value(&|dof| step.displacement[dof]);
        let mut sum = 0.0;
        for integrals in times.path() {
            let next = measure.value(&|dof| step.displacement_at(integrals, dof));
            sum += next - last - TURN * ((next - last) / TURN).round();
            last = next;
        }
        sum
    }

    /// Sets the coordinates at some displacements, an angle within half a turn of the last one.
    pub(crate) fn set_coordinates(&self, u: &dyn Fn(usize) -> f64, state: &mut JointState) {
        state.slide = self.slide.as_ref().map_or(0.0, |slide| slide.value(u));
        let Some(measure) = &self.measure else { return };
        let value = measure.value(u);
        state.coordinate = match measure.coordinate() {
            Coordinate::Angle => value + TURN * ((state.coordinate - value) / TURN).round(),
            Coordinate::Slide | Coordinate::Distance(_) => value,
        };
    }
}

const TURN: f64 = 2.0 * std::f64::consts::PI;
