//! Section 5.1.2: the motion in large strain.

use super::study::of_the_paper;
use super::{CONSERVED, Effort, LOST, conserved};
use crate::case::{Case, Run};
use crate::claim::Item;
use crate::measure::{energy_drift, norm};
use crate::picture::{Pictures, Series};

/// Figs. 3 and 9: the load history.
pub(super) fn figure_3(_: Effort, pictures: &Pictures) -> Result<Item, String> {
    let mut item = Item::new(
        "figure-3",
        "Figs. 3 and 9: the load over time",
        "A hat; its peak is this project's choice.",
    );
    let case = Case::new("figure-3");
    let problem = case.problem()?;
    let points = problem.loads[0].time_function.entries().to_vec();
    let hat = Series::line("f(t)", points.into_iter().chain([(4.0, 0.0)]).collect());
    item.pictures.push(pictures.linear("figure-3", "Load history", ["t", "f"], vec![hat])?);
    let run = Run::of(&problem)?;
    let momentum = run.records.iter().map(|record| norm(record.linear_momentum)).fold(0.0, f64::max);
    item.claim(
        "the tractions on the two end faces are equal and opposite: no linear momentum",
        format!("|P| = {momentum:.1e}"),
        momentum < 1e-10,
    );
    item.commands.push(case.command());
    Ok(item)
}

/// Fig. 10: configurations.
pub(super) fn figure_10(_: Effort, pictures: &Pictures) -> Result<Item, String> {
    let case = Case::new("figure-10");
    let problem = case.problem()?;
    let run = Run::of(&problem)?;
    let mut item = Item::new(
        "figure-10",
        "Fig. 10: configurations of the large-strain motion with DGM",
        "The block while it is loaded (until t = 1) and in free flight; h = 0.01, then 0.04.",
    );
    let times = [0.0, 0.5, 1.0, 1.6, 2.2, 2.8, 3.4, 4.0];
    item.pictures.push(pictures.configurations(item.name, problem.body.mesh(), &run, &times)?);
    let length = |position: &[[f64; 3]]| {
        let [a, b] = [[0.0; 3], [0.0, 10.0, 0.0]].map(|at| position[problem.body.mesh().nearest_node(at)]);
        norm([0, 1, 2].map(|i| b[i] - a[i]))
    };
    let lengths = run.positions.iter().map(|position| length(position));
    let (shortest, longest) = lengths.fold((f64::INFINITY, 0f64), |(a, b), l| (a.min(l), b.max(l)));
    item.claim(
        "the strains are large: the long edge changes its length by more than a tenth",
        format!("from {shortest:.2} to {longest:.2}, 10 in the reference"),
        run.failure.is_none() && (shortest < 9.0 || longest > 11.0),
    );
    item.commands.push(case.command());
    Ok(item)
}

/// Fig. 11: AS(5) and DGM.
pub(super) fn figure_11(_: Effort, pictures: &Pictures) -> Result<Item, String> {
    let mut item =
        Item::new("figure-11", "Fig. 11: large strain, AS(5) and DGM", "h = 0.01 until t = 1, then 0.04.");
    for name in ["AS(5)", "DGM"] {
        conserved(&mut item, pictures, name, &Case::new("figure-11").scheme(name))?;
    }
    Ok(item)
}

/// Fig. 12: the energy of FE(1) drifts.
pub(super) fn figure_12(_: Effort, pictures: &Pictures) -> Result<Item, String> {
    let mut item = Item::new(
        "figure-12",
        "Fig. 12: total energy at h = 0.04, large strain",
        "Total energy after the load.",
    );
    let mut series = Vec::new();
    for name in ["FE(1)", "AS(5)", "DGM", "FE(5)"] {
        let case = Case::new("figure-12").scheme(name);
        let run = case.run()?;
        let drift = energy_drift(run.after(1.0));
        let (claim, holds) = match name {
            "FE(1)" => ("drifts, but does not blow up", drift > LOST && drift < 0.1),
            _ => ("keeps its energy", drift < CONSERVED),
        };
        item.claim(format!("{name} {claim}"), format!("{drift:.1e}"), holds);
        series.push(Series::line(name, run.history(1.0, |r| r.total_energy)));
        item.commands.push(case.command());
    }
    item.pictures.push(pictures.linear(item.name, "Large strain: total energy", ["t", "H"], series)?);
    Ok(item)
}

/// Fig. 13: error over step size.
pub(super) fn figure_13(effort: Effort, pictures: &Pictures) -> Result<Item, String> {
    let names = ["FE(1)", "FE(5)", "AS(5)", "DGM"];
    let curves = of_the_paper("figure-13", &names, effort, pictures)?;
    let mut item = Item::new(
        "figure-13",
        "Fig. 13: error over step size, large strain",
        "All runs share the state at t = 1. The order stays below 2 while the highest modes are not resolved: \
        omega h is about 9 at h = 0.04.",
    );
    curves.show_errors(&mut item, pictures, "Large-strain motion", &[(2, "DGM", 1)])?;
    for name in names {
        let order = curves.order(name, 1);
        let holds = (order - 2.0).abs() < 0.35;
        item.claim(format!("{name} converges with order about 2"), format!("order {order:.2}"), holds);
    }
    let errors = names.map(|name| curves.last(name));
    let largest = errors.iter().copied().fold(0.0, f64::max);
    let spread = largest / errors.iter().copied().fold(f64::INFINITY, f64::min);
    item.claim(
        "all schemes are almost equally accurate",
        format!("largest over smallest error {spread:.2}"),
        spread < 2.0,
    );
    item.commands.push(
        "emmy converge validation/inputs/figure-13.toml --from 1 --sizes 0.04,0.02,0.01,0.005,0.0025 \
        --reference 0.0001 --reference-scheme DGM"
            .into(),
    );
    Ok(item)
}
