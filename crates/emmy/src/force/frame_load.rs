//! Moments on rigid bodies, and forces that turn with them.
//!
//! A force with the components f in the axes of the body acts at its centre, `F_0 = sum_i f_i d_i / s`, with the arms
//! `d_i = P_i - P_0` of its frame, which are s long. A moment M, constant or with the components m in the axes of the
//! body, `M = sum_i m_i d_i / s`, acts at every stage of a step by the forces
//!
//! ```math
//! F_i = W x d_i,    F_0 = -sum_i F_i,    (tr D 1 - D) W = M,    D = sum_i d_i d_i^T
//! ```
//!
//! They have no resultant and exactly the moment M, also inside a step, where a frame is not quite rigid.

use std::sync::Arc;

use super::integral::Scratch;
use super::interface::{Book, Force, ForceMemory, OverTime, Side};
use super::source::Site;
use super::step::{StepInput, StepStart};
use crate::average::{Request, Rule};
use crate::error::{Error, Result};
use crate::input::{Load, TimeFunction};
use crate::nodal;
use crate::sparse::RowPart;
use crate::tensor::{SYM_INDEX, cross, dot3, mat3, sym, sym_cofactor, sym_det};

/// A moment or a force on a rigid body with its factor over time.
#[derive(Debug, Clone)]
pub(crate) struct FrameLoad {
    number: usize,
    action: Action,
    /// Its vector, in the axes of space or of the body, which are those of space in the drawing.
    vector: [f64; 3],
    time_function: TimeFunction,
    /// Centre and ends of the axes of the body.
    nodes: [u32; N],
    /// Reference positions of the ends less that of the centre.
    arms: [[f64; 3]; 3],
    /// Position of each pair of nodes in the pattern, `[n][n]`.
    positions: Vec<u32>,
}

const N: usize = 4;

/// How a vector acts on a rigid body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Action {
    /// A moment that keeps its direction.
    Moment,
    /// A moment that turns with the body.
    FollowingMoment,
    /// A force at the centre that turns with the body.
    FollowingForce,
}

/// The forces of a moment in a configuration.
struct Acting {
    arms: [[f64; 3]; 3],
    /// W.
    axis: [f64; 3],
    /// `(tr D 1 - D)^-1`.
    inverse: [[f64; 3]; 3],
}

impl Acting {
    fn new(arms: [[f64; 3]; 3], moment: [f64; 3]) -> Self {
        let trace: f64 = arms.iter().map(|arm| dot3(*arm, *arm)).sum();
        let entry = |a: usize, b: usize| {
            let square: f64 = arms.iter().map(|arm| arm[a] * arm[b]).sum();
            if a == b { trace - square } else { -square }
        };
        let matrix = sym(entry);
        let (cofactor, determinant) = (sym_cofactor(&matrix), sym_det(&matrix));
        let inverse = mat3(|a, b| cofactor[SYM_INDEX[a][b]] / determinant);
        Acting { arms, axis: product(&inverse, moment), inverse }
    }

    /// The force on each node.
    fn forces(&self) -> [[f64; 3]; N] {
        with_centre(self.arms.map(|arm| cross(self.axis, arm)))
    }

    /// The change of these forces with component c of arm j.
    ///
    /// ```math
    /// dF_i = dW x d_i + delta_ij W x e_c,    (tr D 1 - D) dW = e_c (d_j . W) + d_j W_c - 2 d_jc W
    /// ```
    ///
    /// `rate`: dM_c, the change of the moment with it along the axis c; it adds to the right side.
    fn derivative(&self, j: usize, c: usize, rate: f64) -> [[f64; 3]; N] {
        let (own, w) = (self.arms[j], self.axis);
        let along = dot3(own, w) + rate;
        let right = [0, 1, 2].map(|d| if d == c { along } else { 0.0 } + own[d] * w[c] - 2.0 * own[c] * w[d]);
        let change = product(&self.inverse, right);
        let mut forces = self.arms.map(|arm| cross(change, arm));
        let mut unit = [0.0; 3];
        unit[c] = 1.0;
        let turned = cross(w, unit);
        (0..3).for_each(|d| forces[j][d] += turned[d]);
        with_centre(forces)
    }
}

/// Forces on the ends of the axes, and on the centre less their sum.
fn with_centre([a, b, c]: [[f64; 3]; 3]) -> [[f64; 3]; N] {
    [[0, 1, 2].map(|d| -(a[d] + b[d] + c[d])), a, b, c]
}

fn product(matrix: &[[f64; 3]; 3], vector: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| dot3(row, vector))
}

impl FrameLoad {
    /// The load.
    ///
    /// # Errors
    /// [`Error::NotFinite`], [`Error::Moment`] if the group is no rigid body that turns.
    pub(super) fn new(
        number: usize,
        load: &Load,
        group: &str,
        (action, vector): (Action, [f64; 3]),
        site: &Site<'_>,
    ) -> Result<Self> {
        if let Some(&value) = vector.iter().find(|value| !value.is_finite()) {
            return Err(Error::NotFinite { what: "load".into(), value });
        }
        let own = site.rigid.iter().find(|(name, _)| name == group);
        let nodes: Option<[u32; N]> =
            own.and_then(|(_, nodes)| nodes.clone().collect::<Vec<_>>().try_into().ok());
        let Some(nodes) = nodes else { return Err(Error::Moment { group: group.to_string() }) };
        let at = |node: usize| site.mesh.points()[nodes[node] as usize];
        let arms = [1, 2, 3].map(|end| [0, 1, 2].map(|d| at(end)[d] - at(0)[d]));
        let pairs = nodes.iter().flat_map(|a| nodes.iter().map(move |b| (*a as usize, *b as usize)));
        let positions = pairs.map(|(a, b)| site.pattern.coupling(a, b) as u32).collect();
        Ok(FrameLoad {
            number,
            action,
            vector,
            time_function: load.time_function.clone(),
            nodes,
            arms,
            positions,
        })
    }

    /// Components in the axes of the body over the lengths of its arms, at a factor.
    fn over_arms(&self, factor: f64) -> [f64; 3] {
        [0, 1, 2].map(|i| factor * self.vector[i] / dot3(self.arms[i], self.arms[i]).sqrt())
    }

    /// The forces on the nodes in a configuration, at a factor, and their derivatives.
    fn forces(&self, u: &dyn Fn(usize) -> f64, factor: f64) -> Forces {
        let at = |node: usize, d: usize| u(nodal::dof(self.nodes[node] as usize, d));
        let arms = [0, 1, 2].map(|i| [0, 1, 2].map(|d| self.arms[i][d] + at(i + 1, d) - at(0, d)));
        let turned = |parts: [f64; 3]| [0, 1, 2].map(|d| (0..3).map(|i| parts[i] * arms[i][d]).sum::<f64>());
        let parts = self.over_arms(factor);
        match self.action {
            Action::Moment => Forces::Moment(Acting::new(arms, self.vector.map(|x| factor * x)), [0.0; 3]),
            Action::FollowingMoment => Forces::Moment(Acting::new(arms, turned(parts)), parts),
            Action::FollowingForce => Forces::AtCentre(turned(parts), parts),
        }
    }
}

/// The forces of a load in a configuration, and the change of its vector with each arm.
enum Forces {
    Moment(Acting, [f64; 3]),
    AtCentre([f64; 3], [f64; 3]),
}

impl Forces {
    /// The force on each node.
    fn of_nodes(&self) -> [[f64; 3]; N] {
        match self {
            Forces::Moment(acting, _) => acting.forces(),
            Forces::AtCentre(force, _) => [*force, [0.0; 3], [0.0; 3], [0.0; 3]],
        }
    }

    /// The change of these forces with component c of arm j.
    fn derivative(&self, j: usize, c: usize) -> [[f64; 3]; N] {
        match self {
            Forces::Moment(acting, rates) => acting.derivative(j, c, rates[j]),
            Forces::AtCentre(_, rates) => {
                let mut forces = [[0.0; 3]; N];
                forces[0][c] = rates[j];
                forces
            }
        }
    }
}

impl Force for FrameLoad {
    fn book(&self) -> Book {
        Book::Work
    }

    fn side(&self) -> Side {
        Side::Outside
    }

    fn memory(&self, rule: &Rule) -> ForceMemory {
        ForceMemory::new(vec![0.0; rule.degree()])
    }

    fn begin(&self, start: &StepStart<'_>, memory: &mut ForceMemory, _: &mut [f64]) -> Result<bool> {
        self.stage_factors(start, memory.of_mut::<Vec<f64>>())
    }

    fn assemble(
        &self,
        (step, request): (&StepInput<'_>, Request),
        memory: &ForceMemory,
        _: usize,
        _: &mut Scratch,
        sink: &mut RowPart,
    ) -> Result<()> {
        let k = step.rule.degree();
        for (i, &factor) in memory.of::<Vec<f64>>().iter().enumerate() {
            let forces = self.forces(&|dof| step.displacement_in(i, dof), factor);
            for (&node, force) in self.nodes.iter().zip(forces.of_nodes()) {
                if sink.owns(node) {
                    sink.add_force(i, node, force);
                }
            }
            if request == Request::Stress {
                continue;
            }
            for (end, c) in (0..3).flat_map(|end| (0..3).map(move |c| (end, c))) {
                let derivative = forces.derivative(end, c);
                for a in 0..N {
                    if !sink.owns(self.nodes[a]) {
                        continue;
                    }
                    for j in 0..k {
                        let weight = -step.tangent_factor * step.rule.coefficients()[i * k + j];
                        // An arm is the end less the centre.
                        for (column, sign) in [(end + 1, 1.0), (0, -1.0)] {
                            let block = sink.block_mut(self.positions[a * N + column] as usize, i * k + j);
                            (0..3).for_each(|row| block[3 * row + c] += sign * weight * derivative[a][row]);
                        }
                    }
                }
            }
        }
        Ok(())
    }

    fn is_symmetric(&self) -> bool {
        false
    }

    fn without_adjoint(&self) -> Option<&'static str> {
        Some("moments on rigid bodies and forces that turn with them are not covered")
    }

    fn over_time(&self) -> Option<&dyn OverTime> {
        Some(self)
    }
}

impl OverTime for FrameLoad {
    fn number(&self) -> usize {
        self.number
    }

    fn time_function(&self) -> &TimeFunction {
        &self.time_function
    }

    fn in_proportion(&self, time: f64, _: usize) -> Arc<dyn Force> {
        let time_function = TimeFunction::ramp(self.time_function.value_before(time));
        Arc::new(FrameLoad { time_function, ..self.clone() })
    }

    fn add_unit_force(&self, force: &mut [f64]) {
        for (&node, own) in self.nodes.iter().zip(self.forces(&|_| 0.0, 1.0).of_nodes()) {
            let sum = nodal::at_mut(force, node as usize);
            (0..3).for_each(|d| sum[d] += own[d]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ARMS: [[f64; 3]; 3] = [[1.0, 0.2, -0.1], [0.1, 0.9, 0.3], [-0.2, 0.1, 1.1]];
    const MOMENT: [f64; 3] = [0.3, -0.7, 0.5];

    #[test]
    fn forces_have_the_moment_and_no_resultant() {
        let [centre, ends @ ..] = Acting::new(ARMS, MOMENT).forces();
        let mut moment = [0.0; 3];
        for (arm, force) in ARMS.into_iter().zip(ends) {
            let own = cross(arm, force);
            (0..3).for_each(|d| moment[d] += own[d]);
        }
        for d in 0..3 {
            assert!((moment[d] - MOMENT[d]).abs() < 1e-15, "{moment:?}");
            assert!((centre[d] + ends.iter().map(|force| force[d]).sum::<f64>()).abs() < 1e-15);
        }
    }

    #[test]
    fn derivatives_are_differences() {
        let forces = |end: usize, c: usize, step: f64| {
            let mut arms = ARMS;
            arms[end][c] += step;
            Acting::new(arms, MOMENT).forces()
        };
        let acting = Acting::new(ARMS, MOMENT);
        for (end, c) in (0..3).flat_map(|end| (0..3).map(move |c| (end, c))) {
            let (own, h) = (acting.derivative(end, c, 0.0), 1e-5);
            let (more, less) = (forces(end, c, h), forces(end, c, -h));
            for (node, d) in (0..N).flat_map(|node| (0..3).map(move |d| (node, d))) {
                let difference = (more[node][d] - less[node][d]) / (2.0 * h);
                assert!((own[node][d] - difference).abs() < 1e-9, "{end} {c} {node} {d}");
            }
        }
    }

    /// Loads that turn with the body: in a turned drawing they are turned, and derivatives are differences.
    #[test]
    fn following_loads_turn_with_the_body() {
        let load = |action| FrameLoad {
            number: 0,
            action,
            vector: MOMENT,
            time_function: TimeFunction::constant(),
            nodes: [0, 1, 2, 3],
            arms: [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]],
            positions: Vec::new(),
        };
        // A quarter turn about z: x -> y, y -> -x.
        let turn = |v: [f64; 3]| [-v[1], v[0], v[2]];
        let turned = |action| {
            let own = load(action);
            let end = |node: usize| {
                node.checked_sub(1).map_or([0.0; 3], |i| {
                    let (before, now) = (own.arms[i], turn(own.arms[i]));
                    [0, 1, 2].map(|d| now[d] - before[d])
                })
            };
            own.forces(&|dof| end(dof / 3)[dof % 3], 1.0).of_nodes()
        };
        let due = turn(MOMENT);
        let force = turned(Action::FollowingForce);
        let ends = turned(Action::FollowingMoment);
        let arms = [[0.0, 2.0, 0.0], [-2.0, 0.0, 0.0], [0.0, 0.0, 2.0]];
        let moments = [0, 1, 2].map(|i| cross(arms[i], ends[i + 1]));
        for d in 0..3 {
            assert!((force[0][d] - due[d]).abs() < 1e-15 && force[1][d] == 0.0, "{force:?}");
            assert!((moments.iter().map(|own| own[d]).sum::<f64>() - due[d]).abs() < 1e-15, "{moments:?}");
        }
        for action in [Action::FollowingForce, Action::FollowingMoment] {
            let own = load(action);
            let noise = |dof: usize| 0.3 * ((dof as f64 + 1.0) * 0.618_034).fract();
            let forces = |moved: usize, step: f64| {
                own.forces(&|dof| noise(dof) + if dof == moved { step } else { 0.0 }, 1.0)
            };
            for (end, c) in (0..3).flat_map(|end| (0..3).map(move |c| (end, c))) {
                let (h, dof) = (1e-5, 3 * (end + 1) + c);
                let derivative = forces(dof, 0.0).derivative(end, c);
                let (more, less) = (forces(dof, h).of_nodes(), forces(dof, -h).of_nodes());
                for (node, d) in (0..N).flat_map(|node| (0..3).map(move |d| (node, d))) {
                    let difference = (more[node][d] - less[node][d]) / (2.0 * h);
                    assert!(
                        (derivative[node][d] - difference).abs() < 1e-9,
                        "{action:?} {end} {c} {node} {d}"
                    );
                }
            }
        }
    }
}
