//! The cost of AS(N) over N.

use std::time::Instant;

use emmy::motion::{Motion, State};
use emmy_io::convergence::on_one_thread;

use super::Effort;
use crate::case::Case;
use crate::claim::Item;
use crate::measure::energy_drift;
use crate::picture::{Pictures, Series};

/// Seconds per step, and the drift of the energy after the load.
struct Cost {
    seconds: f64,
    drift: f64,
}

/// The paper: the computational cost of increasing the number of time integration points turns out to be negligible.
pub(super) fn inner_points(effort: Effort, pictures: &Pictures) -> Result<Item, String> {
    let (most, repeats) = if effort.quick { (3, 1) } else { (8, 5) };
    let mut item = Item::new(
        "inner-points",
        "Cost and conservation of AS(N) over N",
        "Large-strain block until t = 3, one core; the least of several runs in turns. The inner points cost constitutive calls only.",
    );
    let mut names: Vec<String> = (1..=most).map(|n| format!("AS({n})")).collect();
    names.extend(["FE(1)", "FE(5)", "DGM"].map(String::from));
    let mut costs: Vec<Cost> = Vec::new();
    for _ in 0..repeats {
        for (i, name) in names.iter().enumerate() {
            let cost = on_one_thread(|| cost(name))??;
            match costs.get_mut(i) {
                Some(best) => best.seconds = best.seconds.min(cost.seconds),
                None => costs.push(cost),
            }
        }
    }
    let header = ["scheme", "milliseconds a step", "over AS(1)", "drift of the energy"].map(String::from);
    let line = |(name, cost): (&String, &Cost)| {
        let (seconds, drift) = (format!("{:.2}", 1e3 * cost.seconds), format!("{:.1e}", cost.drift));
        vec![name.clone(), seconds, format!("{:.2}", cost.seconds / costs[0].seconds), drift]
    };
    item.tables.push(std::iter::once(header.to_vec()).chain(names.iter().zip(&costs).map(line)).collect());
    let over = |value: fn(&Cost) -> f64| (0..most).map(|i| ((i + 1) as f64, value(&costs[i]))).collect();
    let drift = Series::marked("AS(N)", over(|cost| cost.drift));
    item.pictures.push(pictures.log_y(
        "inner-points-drift",
        "Drift of the energy in free flight",
        ["N", "largest |H - H(1)| / H(1)"],
        vec![drift],
    )?);
    item.claim(
        "each inner point makes the energy of AS(N) better by orders of magnitude",
        (0..most).map(|i| format!("{:.0e}", costs[i].drift)).collect::<Vec<_>>().join(", "),
        costs[..most.min(5)].windows(2).all(|pair| pair[1].drift < 0.1 * pair[0].drift),
    );
    if !effort.quick {
        let seconds = Series::marked("AS(N)", over(|cost| 1e3 * cost.seconds));
        item.pictures.push(pictures.linear(
            "inner-points-cost",
            "Cost",
            ["N", "milliseconds a step"],
            vec![seconds],
        )?);
        let ratio = costs[4].seconds / costs[0].seconds;
        item.claim(
            "AS(5) costs at most half as much again as AS(1) on this small block",
            format!("{ratio:.2} times"),
            ratio < 1.5,
        );
    }
    item.commands.push(Case::new("inner-points").scheme("AS(1)").command());
    Ok(item)
}

/// A run, built for one thread.
fn cost(name: &str) -> Result<Cost, String> {
    let problem = Case::new("inner-points").scheme(name).problem()?;
    let text = |error: emmy::Error| error.to_string();
    let state = State::initial(&problem.body, problem.plan.start(), &problem.initial).map_err(text)?;
    let motion = Motion::starting(&problem.body, problem.scheme, problem.newton, state);
    let mut motion = motion.map_err(text)?;
    let (started, mut free) = (Instant::now(), Vec::new());
    for step in problem.plan.steps() {
        motion.step_of_plan(&step).map_err(text)?;
        if step.end > 1.0 - 1e-9 {
            free.push(motion.record().clone());
        }
    }
    let seconds = started.elapsed().as_secs_f64() / problem.plan.n_steps() as f64;
    Ok(Cost { seconds, drift: energy_drift(&free) })
}
