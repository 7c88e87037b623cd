//! Contact: problems with exact numbers, from `data/contact.toml`.

mod balances;
mod ball;
mod balls;
mod bar_on_wall;
mod bouncing_bar;
mod chapter;
mod cradle;
mod data;
mod equal_bars;
mod hertz_impact;
mod hertz_static;
mod patch;
mod patch_pair;
mod peer;
mod rest;
mod row;
mod slow_bar;
mod trace;
mod two_blocks;
mod unequal_bars;

use self::data::{Problem, Run};
use self::trace::Trace;
use super::Effort;
use crate::claim::Item;
use crate::picture::{Pictures, Series};

/// The numbers of a run.
#[derive(Debug, Default)]
struct Measured {
    /// In the order of the quantities of the problem.
    values: Vec<f64>,
    /// Steps, corrections of a step on average, CPU time \[s\].
    steps: usize,
    corrections: f64,
    seconds: f64,
    /// A curve for the picture of the problem.
    curve: Vec<(f64, f64)>,
}

impl Measured {
    fn of(values: Vec<f64>, trace: &Trace) -> Self {
        let (steps, corrections, seconds) = (trace.forces.len(), trace.corrections(), trace.seconds);
        Measured { values, steps, corrections, seconds, curve: Vec::new() }
    }

    fn with_curve(self, curve: Vec<(f64, f64)>) -> Self {
        Measured { curve, ..self }
    }
}

/// Measures a run of a problem.
type Measure = fn(&Problem, &Run) -> Result<Measured, String>;

/// The measurement of each problem, and the axes of its picture.
const MEASURES: [(&str, Measure, Option<[&str; 2]>); 18] = [
    ("bar-on-a-wall", bar_on_wall::measure, None),
    ("bouncing-bar", bouncing_bar::measure, Some(["t", "pressure"])),
    ("slow-bar", slow_bar::measure, None),
    ("hertz-static", hertz_static::measure, None),
    ("hertz-impact", hertz_impact::measure, Some(["t / duration", "force / largest force"])),
    ("rest", rest::measure, None),
    ("patch", patch::measure, None),
    ("block", balances::measure, Some(["t", "H over that at the start"])),
    ("equal-bars", equal_bars::measure, None),
    ("unequal-bars", unequal_bars::measure, None),
    ("cradle-of-blocks", cradle::blocks, None),
    ("cradle-of-bars", cradle::bars, None),
    ("two-blocks", two_blocks::measure, None),
    ("two-blocks-peer", two_blocks::peer, None),
    ("patch-pair", patch_pair::measure, None),
    ("patch-pair-quadratic", patch_pair::measure, None),
    ("patch-pair-matching", patch_pair::measure, None),
    ("balls", balls::measure, None),
];

/// Contact with obstacles, and between bodies.
pub(super) fn contact(effort: Effort, pictures: &Pictures) -> Result<Item, String> {
    let mut item = Item::new(
        "contact",
        "Contact",
        "Problems of contact with exact numbers, which stand in validation/data/contact.toml with all data and \
        sources. Errors in brackets are relative to the exact number, those of times to the duration of the \
        contact. Changes of H are the largest ones, over the energy at the start; d is the thickness of the layer.",
    );
    let problems = data::problems()?;
    item.tables.push(list(&problems));
    chapter::draw(&mut item, pictures)?;
    let block = problems.iter().find(|own| own.name == "block");
    if let (Some(program), Some(problem)) = (effort.ccx, block) {
        peer::calculix(&mut item, (problem, &problem.run[0]), program, pictures)?;
    }
    if let (Some(python), Some(problem)) = (effort.mujoco, block) {
        peer::mujoco(&mut item, (problem, &problem.run[0]), python, pictures)?;
    }
    for problem in &problems {
        against_numbers(&mut item, problem, &|run| !run.long && (run.quick || !effort.quick), pictures)?;
    }
    Ok(item)
}

/// Long runs of the same problems.
pub(super) fn long(_: Effort, pictures: &Pictures) -> Result<Item, String> {
    let mut item = Item::new("contact-long", "Contact: fine meshes and many steps", "As the item contact.");
    for problem in &data::problems()? {
        against_numbers(&mut item, problem, &|run| run.long, pictures)?;
    }
    Ok(item)
}

/// The problems with their data and sources.
fn list(problems: &[Problem]) -> Vec<Vec<String>> {
    let header = ["problem", "data", "source", "limits"].map(String::from).to_vec();
    let row =
        |own: &Problem| vec![own.title.clone(), own.data.clone(), own.source.clone(), own.limits.clone()];
    std::iter::once(header).chain(problems.iter().map(row)).collect()
}

/// Claims, table and picture of some runs of a problem.
fn against_numbers(
    item: &mut Item,
    problem: &Problem,
    wanted: &dyn Fn(&Run) -> bool,
    pictures: &Pictures,
) -> Result<(), String> {
    let (_, measure, axes) =
        MEASURES.iter().find(|own| own.0 == problem.name).ok_or("a problem has a measurement")?;
    let runs = problem.run.iter().filter(|run| wanted(run));
    let measured = runs.map(|run| Ok((run, measure(problem, run)?)));
    let measured = measured.collect::<Result<Vec<_>, String>>()?;
    if measured.is_empty() {
        return Ok(());
    }
    for (number, quantity) in problem.quantity.iter().enumerate() {
        let Some(within) = quantity.within else { continue };
        let checked = measured.iter().filter(|(run, _)| run.checked).map(|(_, own)| own.values[number]);
        let worst = checked.max_by(|a, b| quantity.error(*a).abs().total_cmp(&quantity.error(*b).abs()));
        let Some(worst) = worst else { continue };
        item.claim(
            format!("{}: {} is {} within {within:e}", problem.title, quantity.title, quantity.exact),
            quantity.words(worst),
            quantity.error(worst).abs() < within,
        );
    }
    item.tables.push(table(problem, &measured));
    let drawn = measured.iter().filter(|(run, _)| run.drawn);
    let series: Vec<Series> = drawn.map(|(run, own)| Series::line(&run.label(), own.curve.clone())).collect();
    if let Some(axes) = axes.filter(|_| !series.is_empty()) {
        let stem = format!("{}-{}", item.name, problem.name);
        item.pictures.push(pictures.linear(&stem, &problem.title, axes, series)?);
    }
    Ok(())
}

/// A row per run.
fn table(problem: &Problem, measured: &[(&Run, Measured)]) -> Vec<Vec<String>> {
    let titles = problem.quantity.iter().map(|own| own.title.clone());
    let header = [problem.title.clone()].into_iter().chain(titles);
    let header = header.chain(["steps", "corrections", "CPU s"].map(String::from)).collect();
    let exact = problem.quantity.iter().map(|own| own.exact.to_string());
    let exact =
        std::iter::once("exact".to_string()).chain(exact).chain([const { String::new() }; 3]).collect();
    let row = |(run, own): &(&Run, Measured)| {
        let values = problem.quantity.iter().zip(&own.values).map(|(quantity, value)| quantity.words(*value));
        let mut cost =
            [own.steps.to_string(), format!("{:.2}", own.corrections), format!("{:.1}", own.seconds)];
        if own.steps == 0 {
            cost[..2].fill(String::new());
        }
        std::iter::once(run.label()).chain(values).chain(cost).collect()
    };
    [header, exact].into_iter().chain(measured.iter().map(row)).collect()
}
