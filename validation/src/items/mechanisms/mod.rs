//! Mechanisms: rigid bodies and joints, against the digits of `data/mechanisms.toml`.

mod balances;
mod data;
mod discrete;
mod peer;
mod run;

use self::data::{Discrete, File, Problem, Quantity};
use self::run::{Drifts, Outcome};
use super::Effort;
use crate::case::Case;
use crate::claim::Item;
use crate::measure::{cpu_seconds, order};
use crate::picture::{Pictures, Series};

/// Largest residual of the energy, over the largest kinetic energy, that counts as rounding.
const ENERGY: f64 = 1e-11;

/// The same for the opening of joints, over the size of the whole.
const CONSTRAINTS: f64 = 1e-12;

/// Errors below this one are not of the method alone: digits end after the twelfth.
const FLOOR: f64 = 5e-11;

/// Problems of multibody dynamics, in steps of DGM of the degrees 1, 2 and 3.
pub(super) fn mechanisms(effort: Effort, pictures: &Pictures) -> Result<Item, String> {
    let mut item = Item::new(
        "mechanisms",
        "Mechanisms",
        "Problems of multibody dynamics with their digits, which stand in validation/data/mechanisms.toml with all data and sources. \
        Steps of DGM; the error is the distance from the exact state at the end. H: largest residual of the energy since the start, over \
        the largest kinetic energy. Constraints: largest opening of a joint or change of a body's shape, over the size of the whole. \
        CPU time on one thread, from the start of the motion to its end.",
    );
    let File { problems, discrete } = data::file()?;
    item.tables.push(list(&problems, &discrete));
    for problem in problems.iter().filter(|problem| !problem.long) {
        against_digits(&mut item, problem, effort, pictures)?;
    }
    discrete::against_results(&mut item, &discrete, effort)?;
    balances::balances(&mut item, effort)?;
    if let Some(python) = effort.exudyn {
        peer::beside(&mut item, &problems, python)?;
    }
    Ok(item)
}

/// The problems with their data and sources.
fn list(problems: &[Problem], discrete: &[Discrete]) -> Vec<Vec<String>> {
    let header = ["problem", "data", "source"].map(String::from).to_vec();
    let row = |own: &Problem| vec![own.title.clone(), own.data.clone(), own.source.clone()];
    let other = |own: &Discrete| {
        vec![own.title.clone(), own.data.clone(), "an independent implementation of the method".into()]
    };
    std::iter::once(header).chain(problems.iter().map(row)).chain(discrete.iter().map(other)).collect()
}

/// Large mechanisms, and long motions.
pub(super) fn long(effort: Effort, pictures: &Pictures) -> Result<Item, String> {
    let mut item = Item::new(
        "mechanisms-long",
        "Mechanisms: large ones, and many steps",
        "As the item mechanisms: chains of four-bar linkages, in which three constraints of each loop follow from the others, and a \
        hundred thousand steps of Bricard's mechanism.",
    );
    for problem in &data::file()?.problems {
        if problem.long && problem.sizes.iter().any(|sizes| !sizes.is_empty()) {
            against_digits(&mut item, problem, effort, pictures)?;
        }
        if !effort.quick {
            digits(&mut item, problem, true)?;
        }
    }
    many_steps(&mut item, if effort.quick { 1000 } else { 100_000 })?;
    Ok(item)
}

/// Claims and the table of a problem.
fn against_digits(
    item: &mut Item,
    problem: &Problem,
    effort: Effort,
    pictures: &Pictures,
) -> Result<(), String> {
    let input = problem.case().problem()?;
    let title = &problem.title;
    let mut outcomes = Vec::new();
    for (degree, sizes) in (1..).zip(&problem.sizes) {
        let sizes = if effort.quick { problem.quick_sizes(degree) } else { sizes.clone() };
        for size in sizes {
            outcomes.push(run::run(problem, &input, degree, size)?);
        }
    }
    if !effort.quick {
        orders(item, problem, &outcomes);
        digits(item, problem, false)?;
    }
    kept(item, problem, &outcomes);
    let elsewhere = problem.elsewhere.iter().filter(|&&(degree, ..)| !effort.quick || degree == 2);
    for &(degree, size, expected) in elsewhere {
        let own = outcomes.iter().find(|own| own.degree == degree && own.size == size);
        let own = match own {
            Some(own) => own.error,
            None => run::run(problem, &input, degree, size)?.error,
        };
        item.claim(
            format!("{title}: the error of degree {degree} with h = {size} is that of an independent implementation"),
            format!("{own:.3e}, there {expected:.3e}"),
            (own / expected - 1.0).abs() < problem.within || (own - expected).abs() < 1e-11,
        );
    }
    if let Some(period) = &problem.period {
        let own = run::period(&input, period, 0.02)?;
        item.claim(
            format!("{title}: the period is {:.10} with degree 4, h = 0.02", period.value),
            format!("error {:.1e}", (own - period.value).abs()),
            (own - period.value).abs() < period.tolerance,
        );
    }
    if !effort.quick && problem.name == "bricard" {
        draw(item, title, &outcomes, pictures)?;
    }
    item.tables.push(table(title, &outcomes));
    item.commands.push(problem.case().command());
    Ok(())
}

/// Claims about the orders, by the two smallest steps whose errors are not rounding.
fn orders(item: &mut Item, problem: &Problem, outcomes: &[Outcome]) {
    for degree in 1..=3 {
        let points = outcomes.iter().filter(|own| own.degree == degree && own.error > FLOOR);
        let points: Vec<(f64, f64)> = points.map(|own| (own.size, own.error)).collect();
        let [.., coarse, fine] = points[..] else { continue };
        let (own, expected) = (order(coarse, fine), 2.0 * degree as f64);
        item.claim(
            format!("{}: degree {degree} converges with order {expected}", problem.title),
            format!("order {own:.2} from h = {} to {}", coarse.0, fine.0),
            (own - expected).abs() < 0.1,
        );
    }
}

/// The claim that two degrees agree on the digits of the data, if their runs are of this length.
fn digits(item: &mut Item, problem: &Problem, long: bool) -> Result<(), String> {
    let Some(agreement) = problem.agree.as_ref().filter(|own| own.long == long) else { return Ok(()) };
    let input = problem.case().problem()?;
    let [first, second] = agreement.runs.map(|(degree, size)| run::run(problem, &input, degree, size));
    let (first, second) = (first?, second?);
    let apart = problem.quantity.distance(&first.value, &second.value);
    let [(k, h), (l, g)] = agreement.runs;
    item.claim(
        format!(
            "{}: degrees {k} and {l} with h = {h} and {g} agree with the digits at t = {}, to {} after the point",
            problem.title,
            problem.end(),
            agreement.digits
        ),
        format!("errors {:.1e} and {:.1e}, {apart:.1e} apart", first.error, second.error),
        first.error.max(second.error).max(apart) < 10f64.powi(-agreement.digits),
    );
    if let Quantity::Motion { .. } = problem.quantity {
        let exact = &problem.state[problem.state.len() - 1].value;
        let velocity = |own: &Outcome| (3..6).map(|i| (own.value[i] - exact[i]).abs()).fold(0.0, f64::max);
        let error = velocity(&first).max(velocity(&second));
        item.claim(
            format!("{}: so do the velocities", problem.title),
            format!("error {error:.1e}"),
            error < 10f64.powi(-agreement.digits),
        );
    }
    // Not only at the end.
    let earlier = &second.errors[..second.errors.len() - 1];
    if let Some(worst) = earlier.iter().copied().reduce(f64::max) {
        item.claim(
            format!("{}: so do those at the other times, with degree {l}", problem.title),
            format!("error {worst:.1e}"),
            worst < 10f64.powi(-agreement.digits),
        );
    }
    Ok(())
}

/// Claims that energy, angular momentum and constraints are those of the start, in all runs.
fn kept(item: &mut Item, problem: &Problem, outcomes: &[Outcome]) {
    let largest = |value: &dyn Fn(&Outcome) -> f64| outcomes.iter().map(value).fold(0.0, f64::max);
    let (energy, constraints) = (largest(&Outcome::drift), largest(&|own| own.constraints));
    let steps = outcomes.iter().map(|own| own.steps).max().unwrap_or(0);
    item.claim(
        format!(
            "{}: every degree and step size keeps energy and constraints, up to {steps} steps",
            problem.title
        ),
        format!("H {energy:.1e}, constraints {constraints:.1e}"),
        energy < ENERGY && constraints < CONSTRAINTS,
    );
    if let Some(exact) = problem.energy {
        let error = largest(&|own| (own.end.0 - exact).abs() / own.scale);
        item.claim(
            format!("{}: energy and gravity potential at the end are {exact}", problem.title),
            format!("{error:.1e} of the largest kinetic energy"),
            error < ENERGY,
        );
    }
    if let Some(exact) = problem.vertical {
        let error = largest(&|own| (own.end.1[2] - exact).abs() / exact.abs());
        item.claim(
            format!("{}: the angular momentum about the vertical at the end is {exact}", problem.title),
            format!("{error:.1e} of it"),
            error < ENERGY,
        );
    }
    if let Some(bound) = problem.judged {
        let error = largest(&|own| own.energy);
        item.claim(
            format!(
                "{}: the energy is within the {bound} J by which the benchmark judges, at every step size",
                problem.title
            ),
            format!("{error:.1e} J"),
            error < bound,
        );
    }
}

/// A row per run.
fn table(title: &str, outcomes: &[Outcome]) -> Vec<Vec<String>> {
    let header = [title, "h", "steps", "error", "H", "constraints", "CPU s"].map(String::from).to_vec();
    let row = |own: &Outcome| {
        vec![
            format!("k = {}", own.degree),
            own.size.to_string(),
            own.steps.to_string(),
            format!("{:.2e}", own.error),
            format!("{:.1e}", own.drift()),
            format!("{:.1e}", own.constraints),
            format!("{:.3}", own.seconds),
        ]
    };
    std::iter::once(header).chain(outcomes.iter().map(row)).collect()
}

/// Pictures of the errors over step size and over time.
fn draw(item: &mut Item, title: &str, outcomes: &[Outcome], pictures: &Pictures) -> Result<(), String> {
    type Abscissa = fn(&Outcome) -> f64;
    let axes: [(&str, &str, Abscissa); 2] =
        [("error", "h", |own| own.size), ("cost", "CPU seconds of a run", |own| own.seconds)];
    for (stem, label, x) in axes {
        let curve = |degree: usize| {
            let points = outcomes.iter().filter(|own| own.degree == degree);
            Series::marked(&format!("k = {degree}"), points.map(|own| (x(own), own.error)).collect())
        };
        let stem = format!("{}-{stem}", item.name);
        let axes = [label.to_string(), "error at the end".to_string()];
        item.pictures.push(pictures.log_log(&stem, title, axes, (1..=3).map(curve).collect(), Vec::new())?);
    }
    Ok(())
}

/// The claim that Bricard's mechanism keeps energy and constraints through many steps.
fn many_steps(item: &mut Item, steps: usize) -> Result<(), String> {
    let (size, degree) = (0.02, 2);
    let case = Case::new("mechanisms/bricard")
        .with("time.degree", degree)
        .with("time.steps", format!("[{{ until = {}, size = {size} }}]", steps as f64 * size));
    let input = case.problem()?;
    let mut motion = run::started(&input, degree)?;
    let (start, begin) = (motion.record().total_energy, cpu_seconds());
    let mut drifts = Drifts::default();
    for _ in 0..steps {
        drifts.add(
            start,
            motion.step(size).map_err(|error| format!("many steps of Bricard's mechanism: {error}"))?,
        );
    }
    let energy = drifts.energy / drifts.scale;
    item.claim(
        format!("Bricard's mechanism keeps energy and constraints to 1e-11 through {steps} steps of degree {degree}, h = {size}"),
        format!(
            "H {energy:.1e}, constraints {:.1e}, {:.0} s of CPU time",
            drifts.constraints,
            cpu_seconds() - begin
        ),
        energy.max(drifts.constraints) < 1e-11,
    );
    item.commands.push(case.command());
    Ok(())
}
