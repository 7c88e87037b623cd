//! Tables, charts and files of a case.

use std::fmt::Write;
use std::io;
use std::path::Path;

use emmy_io::chart::{Axis, Chart, Figure, Series, Style};

use super::cases::Case;
use super::compare::Advantage;
use super::run::{Choice, Run, SCHEME, Sweep};
use crate::report::{Goal, Limit, Report, Table, count, number};

/// Limit of the ratio of an estimated to a true error, either way.
const ESTIMATE: f64 = 3.0;

/// The table of a case with its goals.
pub(super) fn report(case: &Case, sweep: &Sweep) -> Report {
    let mut report = Report::new(case.title, note(case, sweep));
    let heading = [
        "k",
        "steps chosen by",
        "steps",
        "repeated",
        "corrections",
        "refactorizations",
        "CPU s",
        "error",
        "estimated/true",
        "equal/this, time",
        "equal/this, steps",
    ];
    let mut table = Table::new(2, &heading);
    sweep.runs.iter().for_each(|run| table.push(row(run, &sweep.runs)));
    report.tables.push(table);
    report.goals = goals(case, sweep);
    report
}

fn note(case: &Case, sweep: &Sweep) -> String {
    let mut note = format!(
        "{SCHEME}, {} degrees of freedom. Errors against {} equal steps of degree {}; {} of degree {} differ from these by {:.0e}.",
        count(case.body.n_free_dofs()),
        count(case.references[0].1),
        case.references[0].0,
        count(case.references[1].1),
        case.references[1].0,
        sweep.doubt,
    );
    sweep.failures.iter().for_each(|failure| note += &format!(" Failed: {failure}."));
    note
}

fn row(run: &Run, runs: &[Run]) -> Vec<String> {
    let advantage = Advantage::of(run, runs);
    let ratio = |of: fn(Advantage) -> f64| advantage.map_or("-".into(), |advantage| number(of(advantage)));
    vec![
        run.degree.to_string(),
        run.choice.to_string(),
        count(run.steps),
        count(run.repeated),
        count(run.corrections),
        count(run.refactorizations),
        number(run.seconds),
        format!("{:.1e}", run.error),
        number(run.estimate / run.error),
        ratio(|advantage| advantage.seconds),
        ratio(|advantage| advantage.steps),
    ]
}

fn goals(case: &Case, sweep: &Sweep) -> Vec<Goal> {
    let times = sweep.runs.iter().filter_map(|run| Advantage::of(run, &sweep.runs)).map(|a| a.seconds);
    let least = times.reduce(f64::min);
    let faster = case.goal.zip(least).map(|(goal, least)| {
        let statement =
            format!("{}: time of equal steps over the time of adaptive ones of the same error", case.name);
        Goal::new(statement, Limit::AtLeast(goal), least)
    });
    let off = sweep.runs.iter().map(|run| (run.estimate / run.error).max(run.error / run.estimate));
    let statement = format!("{}: estimated over true error, or the reverse", case.name);
    let estimate = off.reduce(f64::max).map(|off| Goal::always(statement, Limit::AtMost(ESTIMATE), off));
    faster.into_iter().chain(estimate).collect()
}

/// The summary of all cases, without rows.
pub(super) fn summary() -> Report {
    let note = "What equal steps need for the error of adaptive ones, over what these need; smallest and largest of the tolerances whose errors \
        lie within those of equal steps. Estimated over true errors of all runs.";
    let mut report = Report::new("Summary", note);
    report.tables.push(Table::new(2, &["case", "k", "time", "steps", "estimated/true"]));
    report
}

/// The rows of a case in the summary, one per degree.
pub(super) fn summary_rows(case: &Case, sweep: &Sweep) -> Vec<Vec<String>> {
    let row = |degree: usize| {
        let of_degree = || sweep.runs.iter().filter(move |run| run.degree == degree);
        let advantages: Vec<Advantage> =
            of_degree().filter_map(|run| Advantage::of(run, &sweep.runs)).collect();
        vec![
            case.name.into(),
            degree.to_string(),
            range(advantages.iter().map(|advantage| advantage.seconds)),
            range(advantages.iter().map(|advantage| advantage.steps)),
            range(of_degree().map(|run| run.estimate / run.error)),
        ]
    };
    (1..=3).map(row).collect()
}

/// The smallest and the largest of some values; a dash without any.
fn range(values: impl Iterator<Item = f64> + Clone) -> String {
    match (values.clone().reduce(f64::min), values.reduce(f64::max)) {
        (Some(least), Some(most)) => format!("{least:.2} .. {most:.2}"),
        _ => "-".into(),
    }
}

/// Writes `NAME.csv` and `NAME.svg`.
pub(super) fn write(case: &Case, sweep: &Sweep, folder: &Path) -> io::Result<()> {
    std::fs::create_dir_all(folder)?;
    std::fs::write(folder.join(format!("{}.csv", case.name)), csv(&sweep.runs))?;
    std::fs::write(folder.join(format!("{}.svg", case.name)), figure(&sweep.runs).svg())
}

fn csv(runs: &[Run]) -> String {
    let mut text =
        "degree,equal_steps,tolerance,steps,repeated,corrections,refactorizations,seconds,error,estimate\n"
            .to_string();
    for run in runs {
        let choice = match run.choice {
            Choice::Equal(n) => format!("{n},"),
            Choice::Adaptive(tolerance) => format!(",{tolerance:e}"),
        };
        let Run { degree, steps, repeated, corrections, refactorizations, seconds, error, estimate, .. } =
            run;
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{degree},{choice},{steps},{repeated},{corrections},{refactorizations},{seconds:.4e},{error:.4e},{estimate:.4e}"
        );
    }
    text
}

/// Error over time, and error over steps.
fn figure(runs: &[Run]) -> Figure {
    let chart = |label: &str, cost: fn(&Run) -> f64| Chart {
        x: Axis::log(label),
        y: Axis::log("error at the end"),
        series: (1..=3)
            .flat_map(|degree| [false, true].map(|is_adaptive| series(runs, degree, is_adaptive, cost)))
            .collect(),
        ..Chart::default()
    };
    Figure {
        charts: vec![chart("CPU time / s", |run| run.seconds), chart("steps", Run::attempts)],
        columns: 2,
    }
}

fn series(runs: &[Run], degree: usize, is_adaptive: bool, cost: fn(&Run) -> f64) -> Series {
    let belongs =
        |run: &&Run| run.degree == degree && matches!(run.choice, Choice::Adaptive(_)) == is_adaptive;
    let (label, style) =
        if is_adaptive { ("adaptive", Style::LineAndPoints) } else { ("equal steps", Style::Dashed) };
    Series {
        label: format!("k = {degree}, {label}"),
        points: runs.iter().filter(belongs).map(|run| (cost(run), run.error)).collect(),
        style,
        colour: degree - 1,
    }
}
