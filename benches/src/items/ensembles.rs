//! `ensembles`: many small runs in one process, beside a process for each.

use std::time::Instant;

use emmy_io::directory;
use emmy_io::sweep::{SWEEP_KIND, SWEEP_WITNESS, Sweep, SweepFile};
use rayon::prelude::*;

use super::Settings;
use crate::job::{Case, Job};
use crate::outcome::median;
use crate::report::{Goal, Limit, Report, Table, number};
use crate::scratch::Scratch;

/// The keys, whose values combine to the runs.
const KEYS: [&str; 3] =
    ["region.0.density", "region.0.material.neo-hooke.lambda", "region.0.material.neo-hooke.mu"];
/// One run of so many is repeated as a process.
const PART: usize = 5;
/// Runs a second of the sweep over those of processes, both on all cores.
const TIMES_FASTER: f64 = 1.0;
/// Columns of the sweep whose numbers the processes must find too.
const COMPARED: [&str; 2] = ["total_energy", "steps_per_lowest_period"];
/// Relative tolerance for these numbers.
const AGREEMENT: f64 = 1e-12;

/// Runs a second of `emmy sweep` over a thousand small blocks, and of processes.
pub(super) fn measure(settings: &Settings) -> Result<Vec<Report>, String> {
    let (session, scratch) = (&settings.session, Scratch::new("ensembles")?);
    let n_values = session.choose(2, 10);
    let values = |index: usize| -> Vec<String> {
        (0..n_values)
            .map(|at| format!("{:?}", [0.5, 1000.0, 500.0][index] * (1.0 + 0.05 * at as f64)))
            .collect()
    };
    let flags: Vec<String> =
        (0..3).map(|index| format!("{}={}", KEYS[index], values(index).join(","))).collect();
    let case = Case::spinning_block(1);
    let sweep = Sweep::read(case.input(), &flags, None).map_err(|error| error.to_string())?;
    let column = |name: &str| sweep.columns().iter().position(|column| column == name);
    let compared = COMPARED.map(|name| column(name).ok_or(format!("a sweep has no column {name}")));
    let compared = compared.into_iter().collect::<Result<Vec<_>, _>>()?;
    let repeated: Vec<usize> = sweep.all().into_iter().step_by(PART).collect();
    let job = |&run: &usize| {
        let values = sweep.values(run);
        // Steps in the lowest period are a column of the sweep, and that period takes nearly as long as the steps of so
        // small a body: a process finds it too, as `emmy run` does.
        let case = case.clone().accuracy();
        Job::case(&KEYS.iter().zip(values).fold(case, |case, (key, value)| case.with(key, value)))
    };
    let jobs = repeated.iter().map(job).collect::<Result<Vec<_>, _>>()?;
    let mut rates = [Vec::new(), Vec::new()];
    for _ in 0..session.rounds {
        let started = Instant::now();
        let folder = scratch.file("sweep");
        directory::check_kind(&folder, SWEEP_KIND, SWEEP_WITNESS).map_err(|error| error.to_string())?;
        let mut file = SweepFile::create(&sweep, &folder).map_err(|error| error.to_string())?;
        let rows = emmy_io::sweep(&sweep, &sweep.all(), |_, _| false, |row| file.write(row));
        let rows =
            rows.and_then(|rows| file.finish(&rows).map(|()| rows)).map_err(|error| error.to_string())?;
        rates[0].push(rows.len() as f64 / started.elapsed().as_secs_f64());
        let started = Instant::now();
        let outcomes: Vec<_> = jobs.par_iter().with_max_len(1).map(|job| job.run(None)).collect();
        rates[1].push(jobs.len() as f64 / started.elapsed().as_secs_f64());
        for (&run, outcome) in repeated.iter().zip(outcomes) {
            let outcome = outcome?;
            let energy = outcome.kinetic_energy + outcome.strain_energy;
            let found = [Some(energy), outcome.steps_per_lowest_period];
            for ((&column, name), b) in compared.iter().zip(COMPARED).zip(found) {
                let a = rows[run].numbers[column].value();
                let agrees = b.is_some_and(|b| (a - b).abs() <= AGREEMENT * b);
                if !agrees {
                    return Err(format!("{}: {name} {a} in the sweep, {b:?} in a process", sweep.name(run)));
                }
            }
        }
    }
    let note = format!(
        "{} runs of the spinning block (r = 1, 20 steps) with other densities and moduli, on all cores: `emmy sweep`, and \
         a process for each of {} of them, as many side by side as there are cores. Both find the steps in the lowest \
         elastic period. A process writes no results.",
        sweep.n_runs(),
        jobs.len()
    );
    let mut report = Report::new("Ensembles", note);
    let mut table = Table::new(1, &["", "runs/s"]);
    for (what, rates) in ["one process", "a process for each run"].iter().zip(&rates) {
        table.push(vec![what.to_string(), number(median(rates))]);
    }
    report.tables.push(table);
    let ratios: Vec<f64> =
        rates[0].iter().zip(&rates[1]).map(|(sweep, processes)| sweep / processes).collect();
    let statement = "runs a second in one process over those of processes";
    report.goals.push(Goal::new(statement, Limit::AtLeast(TIMES_FASTER), median(&ratios)));
    Ok(vec![report])
}
