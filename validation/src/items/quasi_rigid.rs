//! Section 5.1.1: the quasi-rigid motion.

use super::study::of_the_paper;
use super::{CONSERVED, Effort, conserved};
use crate::case::Case;
use crate::claim::Item;
use crate::measure::{energy_drift, momentum_drift};
use crate::picture::{Pictures, Series};

/// Fig. 4: the motion with AS(1) at h = 0.2.
pub(super) fn figure_4(_: Effort, pictures: &Pictures) -> Result<Item, String> {
    let case = Case::new("figure-4");
    let problem = case.problem()?;
    let run = crate::case::Run::of(&problem)?;
    let mut item = Item::new(
        "figure-4",
        "Fig. 4: configurations of the quasi-rigid motion with AS(1), h = 0.2",
        "The block at every fourth step of the free flight, and the path of one corner.",
    );
    item.pictures.push(pictures.configurations(
        item.name,
        problem.body.mesh(),
        &run,
        &[0.0, 1.0, 1.8, 2.6, 3.4],
    )?);
    let tip = problem.body.mesh().nearest_node([0.0, 10.0, 0.0]);
    let path = |axis: usize| {
        let points = run.records.iter().zip(&run.positions);
        points.map(|(record, position)| (record.time, position[tip][axis])).collect()
    };
    let series = ["x", "y", "z"].iter().enumerate().map(|(axis, label)| Series::line(label, path(axis)));
    item.pictures.push(pictures.linear(
        "figure-4-path",
        "The corner that starts at (0, 10, 0)",
        ["t", "position"],
        series.collect(),
    )?);
    let drift = energy_drift(run.after(1.0)).max(momentum_drift(run.after(1.0)));
    item.claim(
        "AS(1) marches with h = 0.2 through the quasi-rigid motion and keeps energy and angular momentum",
        format!("drift {drift:.1e}"),
        run.failure.is_none() && drift < CONSERVED,
    );
    item.commands.push(case.command());
    Ok(item)
}

/// Fig. 5: error over step size.
pub(super) fn figure_5(effort: Effort, pictures: &Pictures) -> Result<Item, String> {
    let names = ["FE(1)", "FE(5)", "AS(1)"];
    let curves = of_the_paper("figure-5", &names, effort, pictures)?;
    let mut item = Item::new(
        "figure-5",
        "Fig. 5: error over step size, quasi-rigid motion",
        "All runs share the state at t = 1.",
    );
    curves.show_errors(&mut item, pictures, "Quasi-rigid motion", &[(2, "AS(1)", 1)])?;
    for name in ["FE(1)", "AS(1)"] {
        let order = curves.order(name, 1);
        let holds = (order - 2.0).abs() < 0.2;
        item.claim(format!("{name} converges with order 2"), format!("order {order:.2}"), holds);
    }
    let ratio = curves.last("FE(1)") / curves.last("AS(1)");
    item.claim(
        "AS(1) is more accurate than FE(1), four to five times",
        format!("{ratio:.2} times"),
        (3.8..5.2).contains(&ratio),
    );
    let worse = curves.last("FE(5)") / curves.last("FE(1)");
    item.claim(
        "FE(5), which conserves energy only, is worse than both",
        format!("{worse:.1} times FE(1)"),
        worse > 1.0,
    );
    item.commands.push(
        "emmy converge validation/inputs/figure-5.toml --from 1 --sizes 0.04,0.02,0.01,0.005,0.0025 \
        --reference 0.0001 --reference-scheme DGM"
            .into(),
    );
    Ok(item)
}

/// Fig. 6: FE(5), a change of step makes the angular momentum oscillate.
pub(super) fn figure_6(_: Effort, pictures: &Pictures) -> Result<Item, String> {
    let mut item = Item::new(
        "figure-6",
        "Fig. 6: FE(5), change of step at t = 2",
        "Component L_3 of the angular momentum over time.",
    );
    let mut series = Vec::new();
    for size in [0.02, 0.025, 0.04] {
        let case = Case::new("figure-6").with("time.steps.1.size", size);
        let run = case.run()?;
        let (momentum, energy) = (momentum_drift(run.after(2.0)), energy_drift(run.after(2.0)));
        item.claim(
            format!("h = {size}: the angular momentum is lost, the energy kept"),
            format!("drift of L {momentum:.1e}, of H {energy:.1e}"),
            momentum > 1e-2 && energy < CONSERVED,
        );
        series.push(Series::line(&format!("h = {size}"), run.history(0.0, |r| r.angular_momentum[2])));
        item.commands.push(case.command());
    }
    item.pictures.push(pictures.linear(item.name, "FE(5): angular momentum", ["t", "L_3"], series)?);
    Ok(item)
}

/// Fig. 7: FE(1), a change of step makes the energy blow up.
pub(super) fn figure_7(_: Effort, pictures: &Pictures) -> Result<Item, String> {
    let mut item = Item::new("figure-7", "Fig. 7: FE(1), change of step at t = 2", "Total energy over time.");
    let mut series = Vec::new();
    for size in [0.02, 0.025] {
        let case = Case::new("figure-7").with("time.steps.1.size", size);
        let run = case.run()?;
        let free = run.after(2.0);
        let largest = free.iter().map(|r| r.total_energy).fold(0.0, f64::max) / free[0].total_energy;
        let momentum = momentum_drift(free);
        item.claim(
            format!("h = {size}: the energy oscillates severely and blows up, the angular momentum is kept"),
            format!("largest energy {largest:.0} times that at t = 2, drift of L {momentum:.1e}"),
            largest > 5.0 && momentum < CONSERVED,
        );
        series.push(Series::line(&format!("h = {size}"), run.history(1.5, |r| r.total_energy)));
        item.commands.push(case.command());
    }
    item.pictures.push(pictures.log_y(item.name, "FE(1): total energy", ["t", "H"], series)?);
    Ok(item)
}

/// Fig. 8: changes of step do not affect AS(1).
pub(super) fn figure_8(_: Effort, pictures: &Pictures) -> Result<Item, String> {
    let mut item = Item::new(
        "figure-8",
        "Fig. 8: AS(1), steps 0.01, 0.04, 0.2",
        "Energy and angular momentum over time.",
    );
    conserved(&mut item, pictures, "AS(1)", &Case::new("figure-8"))?;
    Ok(item)
}
