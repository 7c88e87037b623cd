//! Elastic bodies with joints and ties, against an independent implementation.

use super::Effort;
use super::data::{Discrete, DiscreteRun};
use super::run::{Drifts, started};
use crate::case::Case;
use crate::claim::Item;
use crate::measure::norm;

/// Claims that results with the same degree and step size are those of an independent implementation.
///
/// # Errors
/// The message of a step that fails.
pub(super) fn against_results(item: &mut Item, problems: &[Discrete], effort: Effort) -> Result<(), String> {
    let header = ["elastic bodies", "k", "h", "kinetic", "strain", "work", "position", "H", "constraints"];
    let mut table = vec![header.map(String::from).to_vec()];
    for problem in problems {
        let mut worst: f64 = 0.0;
        let runs = if effort.quick { &problem.runs[..1] } else { &problem.runs };
        for run in runs {
            let (errors, drifts) = errors(problem, run)?;
            worst = errors.iter().copied().fold(worst, f64::max);
            let mut row = vec![problem.title.clone(), run.degree.to_string(), run.size.to_string()];
            row.extend(errors.iter().map(|error| format!("{error:.1e}")));
            row.push(format!("{:.1e}", drifts.energy / drifts.scale));
            row.push(format!("{:.1e}", drifts.constraints));
            table.push(row);
        }
        item.claim(
            format!(
                "{}: energies, work and position are those of an independent implementation",
                problem.title
            ),
            format!("largest difference {worst:.1e}"),
            worst < 1e-8,
        );
        item.commands.push(Case::new(&problem.input).command());
    }
    item.tables.push(table);
    Ok(())
}

/// Differences of kinetic energy, strain energy, work and position at the end.
fn errors(problem: &Discrete, run: &DiscreteRun) -> Result<([f64; 4], Drifts), String> {
    let input = Case::new(&problem.input).problem()?;
    let mut motion = started(&input, run.degree)?;
    let (start, mut drifts) = (motion.record().total_energy, Drifts::default());
    for _ in 0..(problem.until / run.size).round() as usize {
        drifts.add(start, motion.step(run.size).map_err(|error| format!("{}: {error}", problem.title))?);
    }
    let (record, body) = (motion.record(), &input.body);
    let own = motion.state().position(body, body.mesh().nearest_node(problem.point));
    let differences = [
        (record.kinetic_energy - run.kinetic_energy).abs(),
        (record.strain_energy - run.strain_energy).abs(),
        (record.external_work - run.work).abs(),
        norm([0, 1, 2].map(|d| own[d] - run.position[d])),
    ];
    Ok((differences, drifts))
}
