//! Table III, measured.

use super::{CONSERVED, Effort, LOST};
use crate::case::Case;
use crate::claim::Item;
use crate::measure::{energy_drift, momentum_drift};
use crate::picture::Pictures;

/// The paper's statements on a scheme: whether it conserves angular momentum, energy of St. Venant-Kirchhoff, energy in
/// general.
const PAPER: [(&str, [bool; 3]); 5] = [
    ("FE(1)", [true, false, false]),
    ("FE(5)", [false, true, true]),
    ("AS(1)", [true, true, false]),
    ("AS(5)", [true, true, true]),
    ("DGM", [true, true, true]),
];

/// Table III: free flight after the load, with a change of step.
pub(super) fn table_3(_: Effort, _: &Pictures) -> Result<Item, String> {
    let mut item = Item::new(
        "table-3",
        "Table III: what the schemes conserve",
        "Drift over free flight after t = 1, with a change of step size \
        (quasi-rigid: 0.01 to 0.02; large strain: 0.01 to 0.04), relative to the value at t = 1.",
    );
    let header = ["scheme", "angular momentum", "energy, St. Venant-Kirchhoff", "energy, neo-Hooke"];
    let mut table = vec![header.map(String::from).to_vec()];
    for (name, expected) in PAPER {
        let cases = ["table-3-quasi-rigid", "table-3-large-strain"].map(|file| Case::new(file).scheme(name));
        let [stiff, soft] = cases.clone().map(|case| case.run());
        let (stiff, soft) = (stiff?, soft?);
        let momentum = momentum_drift(stiff.after(1.0)).max(momentum_drift(soft.after(1.0)));
        let drifts = [momentum, energy_drift(stiff.after(1.0)), energy_drift(soft.after(1.0))];
        let is_kept = |(&drift, kept)| if kept { drift < CONSERVED } else { drift > LOST };
        let words = expected.map(|kept| if kept { "yes" } else { "no" }).join(", ");
        let measured = drifts.map(|drift| format!("{drift:.1e}"));
        item.claim(
            format!("{name} conserves angular momentum, energy of St. Venant-Kirchhoff, energy in general: {words}"),
            measured.join(", "),
            drifts.iter().zip(expected).all(is_kept),
        );
        table.push(std::iter::once(name.to_string()).chain(measured).collect());
        item.commands.extend(cases.map(|case| case.command()));
    }
    item.tables.push(table);
    Ok(item)
}
