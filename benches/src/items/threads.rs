//! `threads`: the same bits whatever the number of threads.

use super::Settings;
use crate::job::Case;
use crate::report::{Goal, Limit, Report, Table, number};
use crate::scratch::Scratch;

/// Numbers of threads; times of more threads than the machine has cores mean nothing.
const THREADS: [usize; 4] = [1, 2, 3, 4];

/// Bits that differ from the run with one thread, and wall times.
pub(super) fn measure(settings: &Settings) -> Result<Vec<Report>, String> {
    let session = &settings.session;
    let (r, steps) = session.choose((1, 3), (4, 20));
    let scratch = Scratch::new("threads")?;
    let case = |threads: usize| {
        let file = scratch.file(&threads.to_string());
        Case::spinning_block(r).scheme("DGM", 1).steps(steps, 0.02).threads(threads).state(file)
    };
    let runs = session.cases(&THREADS.map(case))?;
    let one = scratch.numbers("1")?;
    let note = format!(
        "DGM on the spinning block at r = {r}, h = 0.02, {steps} steps: numbers of the last state and of the energies and momenta of \
         all steps that differ in any bit from those of one thread; wall seconds a step, mean without the first."
    );
    let mut report = Report::new("Threads", note);
    let mut table =
        Table::new(0, &["threads", "numbers", "that differ", "wall s a step", "one thread / this"]);
    let mut differing = 0;
    for (threads, runs_of) in THREADS.iter().zip(&runs) {
        let n = n_differing(&one, &scratch.numbers(&threads.to_string())?);
        let ratio = runs[0].ratio(runs_of, |o| o.wall_seconds_per_step_mean);
        let seconds = runs_of.median(|o| o.wall_seconds_per_step_mean);
        let length = one.len().to_string();
        table.push(vec![threads.to_string(), length, n.to_string(), number(seconds), number(ratio)]);
        differing += n;
    }
    let statement = "numbers that depend on the number of threads";
    report.goals.push(Goal::always(statement, Limit::AtMost(0.0), differing as f64));
    report.tables.push(table);
    Ok(vec![report])
}

/// Numbers of two lists that differ in any bit, or occur in one list only.
fn n_differing(a: &[f64], b: &[f64]) -> usize {
    let differs = |(a, b): &(&f64, &f64)| a.to_bits() != b.to_bits();
    a.iter().zip(b).filter(differs).count() + a.len().abs_diff(b.len())
}
