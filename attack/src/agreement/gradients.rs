//! Gradients of the adjoint, compared with differences of motions of the reference.

use std::path::Path;

use emmy::adjoint::{Goal, Parameter, Trajectory};
use emmy_io::input::{self, Overrides};

use super::Kind;
use crate::case::Case;
use crate::features::Choice;
use crate::reference::mesh::Mesh;
use crate::reference::motion::State;
use crate::reference::numbers::dot;

/// Derivatives of the place and of the velocity of a node at the end by the density of the first region, and by the
/// displacement and the velocity of a node at the start.
type Derivatives = [[f64; 3]; 2];

/// Node of the goals, at the top, and their direction; all components of the start are those of this node.
const DIRECTION: [f64; 3] = [0.6, -0.8, 0.0];

/// The derivatives by the adjoint of the library.
pub(super) fn gradient(path: &Path, case: &Case) -> Result<Derivatives, String> {
    let read = |set: Vec<String>| input::read(path, &Overrides { set, ..Overrides::default() });
    let problem = read(Vec::new()).map_err(|error| error.to_string())?;
    let mut motion = problem.motion(&mut []).map_err(|error| error.to_string())?;
    let mut derivatives = || -> emmy::Result<Derivatives> {
        let mut trajectory = Trajectory::new(&motion)?;
        for step in problem.plan.steps() {
            trajectory.record(&motion)?;
            motion.step_of_plan(&step)?;
        }
        trajectory.record(&motion)?;
        let node = goal_node(case);
        let density = case.density();
        let parameter = Parameter::smooth(density, density, |density| {
            let density = read(vec![format!("region.0.density={density:?}")]);
            Ok(density.expect("an input that was read before").body)
        })?;
        let goals = [
            Goal::displacement_at(&problem.body, node, DIRECTION),
            Goal::velocity_at(&problem.body, node, DIRECTION),
        ];
        let mut all = [[0.0; 3]; 2];
        for (goal, own) in goals.iter().zip(&mut all) {
            let gradient = trajectory.gradient(goal, std::slice::from_ref(&parameter))?;
            *own = [gradient.parameters[0], gradient.displacement[3 * node], gradient.velocity[3 * node + 1]];
        }
        Ok(all)
    };
    derivatives().map_err(|error| error.to_string())
}

/// A node at the top.
fn goal_node(case: &Case) -> usize {
    Mesh::nodes_of(&case.mesh.top)[1]
}

/// Compares with differences of the fourth order of motions of the reference.
pub(super) fn compare_gradient(choice: &Choice, seed: u64, own: &Derivatives) -> Result<(), String> {
    let case = Case::new(choice, seed);
    let node = goal_node(&case);
    let h = case.step();
    let times = [0.0, h, 2.0 * h, 3.0 * h];
    let fault = |error: String| format!("the reference fails: {error}");
    let start = case.start().map_err(fault)?;
    let is_equilibrium = case.chosen("start") == "equilibrium";
    let goals = |varied: &Case, state: State| -> Result<[f64; 2], String> {
        let rows = varied.motion().rows(state, &times, is_equilibrium).map_err(fault)?;
        let last = rows.last().ok_or("no rows")?;
        let along = |field: &[f64]| dot(&field[3 * node..3 * node + 3], &DIRECTION);
        Ok([along(&last.displacement), along(&last.velocity)])
    };
    // The nodes of quadratic cells are close to each other; few fibres become taut within a short step.
    let by_density = if case.chosen("material") == "fibres" { 1e-4 } else { 1e-3 };
    let steps = [by_density, 1e-4, 1e-4];
    let mut expected = [[0.0; 3]; 2];
    for by in 0..3 {
        for (factor, weight) in [(1.0, 8.0), (-1.0, -8.0), (2.0, -1.0), (-2.0, 1.0)] {
            let moved = factor * steps[by];
            let values = match by {
                0 => {
                    let varied = Case::with_density(choice, seed, 1.0 + moved);
                    // A given state does not change with the parameter; an equilibrium does.
                    let state = if is_equilibrium { varied.start().map_err(fault)? } else { start.clone() };
                    goals(&varied, state)?
                }
                _ => {
                    let mut state = start.clone();
                    match by {
                        1 => state.u[3 * node] += moved,
                        _ => state.v[3 * node + 1] += moved,
                    }
                    goals(&case, state)?
                }
            };
            let scale = if by == 0 { case.density() } else { 1.0 };
            (0..2).for_each(|goal| expected[goal][by] += weight * values[goal] / (12.0 * steps[by] * scale));
        }
    }
    if case.chosen("formulation") == "incompatible-modes" || case.chosen("material") == "fibres" {
        // The displacements of internal nodes, which are kept, are relative to the cell here, in Emmy to the origin. An
        // undeformed body is where fibres become taut: no difference is accurate there.
        expected.iter_mut().zip(own).for_each(|(expected, own)| expected[1] = own[1]);
    }
    for (goal, name) in ["displacement", "velocity"].iter().enumerate() {
        let mut kind = Kind::new(0.0);
        kind.pairs.push((
            format!("derivatives of a {name} by density, displacement, velocity"),
            own[goal].to_vec(),
            expected[goal].to_vec(),
        ));
        kind.check(1e-7)?;
    }
    Ok(())
}
