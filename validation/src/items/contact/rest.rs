//! A block that rests on a floor under its weight.

use emmy::equilibrium::Equilibrium;
use emmy::motion::Motion;

use super::Measured;
use super::data::{Problem, Run};
use crate::measure::cpu_seconds;

/// Largest change of the energy with the work of the weight, over the energy that the weight stores; largest move of a
/// node, over the edge of the block.
///
/// # Errors
/// The message of a step that fails.
pub(super) fn measure(problem: &Problem, run: &Run) -> Result<Measured, String> {
    let text = |error: emmy::Error| error.to_string();
    let input = problem.case(run).problem()?;
    let steps = run.steps.ok_or("a number of steps is needed")?;
    let equilibrium = Equilibrium::new(&input.body, 0.0, 1).map_err(text)?;
    let state =
        equilibrium.start(input.newton, &input.initial, &mut []).map_err(|error| error.to_string())?;
    let first = state.displacement.clone();
    let mut motion = Motion::starting(&input.body, input.scheme, input.newton, state).map_err(text)?;
    let start = motion.record().total_energy;
    let stored = motion.record().strain_energy + motion.record().contact_energy;
    let (mut drift, mut creep, mut corrections, begin) = (0.0f64, 0.0f64, 0, cpu_seconds());
    for step in 0..steps {
        let record = motion.step(run.size).map_err(text)?;
        drift = drift.max((record.total_energy - record.external_work - start).abs());
        corrections += record.newton_iterations;
        if step % 100 == 99 {
            let moves =
                motion.state().displacement.iter().zip(&first).map(|(now, first)| (now - first).abs());
            creep = moves.fold(creep, f64::max);
        }
    }
    Ok(Measured {
        values: vec![drift / stored, creep],
        steps,
        corrections: corrections as f64 / steps as f64,
        seconds: cpu_seconds() - begin,
        ..Measured::default()
    })
}
