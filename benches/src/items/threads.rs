//! `threads`: the same bits whatever the number of threads.

use emmy::mesh::CellKind;

use super::Settings;
use crate::report::{Goal, Limit, Report, Table, number};
use crate::roofline::triad;
use crate::scratch::Scratch;
use crate::work::{Shape, Work};

/// Numbers of threads; times of more threads than the machine has cores mean nothing.
const THREADS: [usize; 4] = [1, 2, 3, 4];

/// Goals for the speed of two threads: of small bodies, the bracket among them, and of others.
const TWO_THREADS: [f64; 2] = [1.6, 1.8];
/// Largest number of degrees of freedom of a small body.
const SMALL: usize = 10_000;

/// Bits that differ from the run with one thread, and wall times.
pub(super) fn measure(settings: &Settings) -> Result<Vec<Report>, String> {
    let session = &settings.session;
    let (r, r_of_small, steps) = session.choose((1, 1, 3), (4, 2, 20));
    let soft = Work::hex8(r, false, steps);
    let small = Work::hex8(r_of_small, false, steps);
    let hex20 = Work { shape: Shape::Block(CellKind::Hex20, r_of_small), ..soft };
    let bracket = Work { shape: Shape::Bracket, ..soft };
    let motions = [
        (soft, 1),
        (small, 1),
        (soft, 2),
        (Work::hex8(r, true, steps), 1),
        (hex20, 1),
        (bracket, 1),
        (Work::steel_bracket(steps), 1),
    ];
    let of_memory = triad(2)? / triad(1)?;
    let scratch = Scratch::new("threads")?;
    let note = format!(
        "DGM, {steps} steps: numbers of the last state and of the energies and momenta of all steps that differ in any bit \
         from those of one thread; wall seconds a step, mean without the first two. A triad, which memory bounds, is \
         {of_memory:.2} times as fast with two threads."
    );
    let mut report = Report::new("Threads", note);
    let heading = ["motion", "threads", "numbers", "that differ", "wall s a step", "one thread / this"];
    let mut table = Table::new(1, &heading);
    let mut differing = 0;
    for (work, degree) in motions {
        let case = work.case(&scratch)?.scheme("DGM", degree);
        let name = format!("{work}, k = {degree}");
        let case = |threads: usize| case.clone().threads(threads).state(scratch.file(&threads.to_string()));
        let runs = session.cases(&THREADS.map(case))?;
        let one = scratch.numbers("1")?;
        for (threads, runs_of) in THREADS.iter().zip(&runs) {
            let n = n_differing(&one, &scratch.numbers(&threads.to_string())?);
            let ratio = runs[0].ratio(runs_of, |o| o.wall_seconds_per_step_mean);
            let seconds = runs_of.median(|o| o.wall_seconds_per_step_mean);
            let numbers = [*threads, one.len(), n].map(|count| count.to_string());
            let row = [name.clone()].into_iter().chain(numbers);
            table.push(row.chain([number(seconds), number(ratio)]).collect());
            differing += n;
            if *threads == 2 {
                let statement = format!("{name}: one thread over two");
                let least = TWO_THREADS[usize::from(runs_of.last().dofs > SMALL)];
                report.goals.push(Goal::new(statement, Limit::AtLeast(least), ratio));
            }
        }
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
