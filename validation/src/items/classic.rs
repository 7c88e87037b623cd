//! Schemes of other codes, on the paper's block.

use super::study::{Curves, Member, Reference, error_within, study};
use super::{CONSERVED, Effort, LOST};
use crate::case::{Case, Run};
use crate::claim::Item;
use crate::measure::{energy_change, energy_drift, momentum_change, momentum_drift};
use crate::picture::{Pictures, Series};

/// Average acceleration, and the others with their usual dissipation.
const IMPLICIT: [&str; 4] = ["Newmark(0.25, 0.5)", "HHT(0.05)", "generalized-alpha(0.8)", "Bathe"];
const EXPLICIT: &str = "central-differences";

/// Large strain: energy and angular momentum over time.
pub(super) fn large_strain(_: Effort, pictures: &Pictures) -> Result<Item, String> {
    let mut item = Item::new(
        "classic-large-strain",
        "Schemes of other codes: large strain",
        "The block of Fig. 12 until t = 6 with the schemes of other codes, h = 0.04 as there; central differences with h = 0.004, \
        below their critical step.",
    );
    let case = || Case::new("classic-large-strain");
    let mut flights = vec![fly(&mut item, "DGM", case())?];
    for name in IMPLICIT {
        flights.push(fly(&mut item, name, case())?);
    }
    let explicit = case().with("time.steps", "[{ until = 6.0, size = 0.004 }]");
    flights.push(fly(&mut item, EXPLICIT, explicit)?);
    show(&mut item, pictures, &flights)?;
    flights[0].keeps_both(&mut item);
    flights[1..5].iter().for_each(|flight| flight.keeps_neither(&mut item));
    for flight in &flights[2..5] {
        let lost = -energy_change(flight.free());
        item.claim(
            format!("{} dissipates energy of the motion itself", flight.name),
            format!("{:.1} % lost by t = 6", 100.0 * lost),
            lost > 0.01,
        );
    }
    let explicit = &flights[5];
    item.claim(
        "central differences keep the angular momentum; their energy oscillates and stays bounded",
        explicit.words(),
        explicit.momentum() < CONSERVED && (LOST..1e-2).contains(&explicit.energy()),
    );
    Ok(item)
}

/// Quasi-rigid motion.
pub(super) fn quasi_rigid(_: Effort, pictures: &Pictures) -> Result<Item, String> {
    let mut item = Item::new(
        "classic-quasi-rigid",
        "Schemes of other codes: quasi-rigid motion",
        "The stiff block with h = 0.01 while it is loaded, then 0.02. None of them fails, but none keeps the angular momentum of a body that \
        is all but rigid.",
    );
    let mut flights = vec![fly(&mut item, "AS(1)", Case::new("classic-quasi-rigid"))?];
    for name in IMPLICIT {
        flights.push(fly(&mut item, name, Case::new("classic-quasi-rigid"))?);
    }
    show(&mut item, pictures, &flights)?;
    flights[0].keeps_both(&mut item);
    flights[1..].iter().for_each(|flight| flight.keeps_neither(&mut item));
    Ok(item)
}

/// A scheme's run.
struct Flight {
    name: &'static str,
    run: Run,
}

fn fly(item: &mut Item, name: &'static str, case: Case) -> Result<Flight, String> {
    let case = case.scheme(name);
    item.commands.push(case.command());
    Ok(Flight { name, run: case.run()? })
}

impl Flight {
    /// Records after the load.
    fn free(&self) -> &[emmy::motion::Record] {
        self.run.after(1.0)
    }

    fn energy(&self) -> f64 {
        energy_drift(self.free())
    }

    fn momentum(&self) -> f64 {
        momentum_drift(self.free())
    }

    fn words(&self) -> String {
        format!("drift of H {:.1e}, of L {:.1e}", self.energy(), self.momentum())
    }

    fn keeps_both(&self, item: &mut Item) {
        let holds = self.run.failure.is_none() && self.energy().max(self.momentum()) < CONSERVED;
        item.claim(format!("{} keeps energy and angular momentum", self.name), self.words(), holds);
    }

    fn keeps_neither(&self, item: &mut Item) {
        let holds = self.energy().min(self.momentum()) > LOST;
        item.claim(format!("{} keeps neither energy nor angular momentum", self.name), self.words(), holds);
    }
}

/// Total energy, and the change of the angular momentum, over time.
fn show(item: &mut Item, pictures: &Pictures, flights: &[Flight]) -> Result<(), String> {
    let energy = |flight: &Flight| Series::line(flight.name, flight.run.history(1.0, |r| r.total_energy));
    let momentum = |flight: &Flight| {
        let first = &flight.free()[0];
        // The start has no change, which a logarithmic axis cannot show.
        let change = flight.run.history(1.0, |r| momentum_change(first, r));
        Series::line(flight.name, change.into_iter().skip(1).collect())
    };
    let stem = |end: &str| format!("{}-{end}", item.name);
    let energies = flights.iter().map(energy).collect();
    let energies = pictures.linear(&stem("energy"), "Total energy", ["t", "H"], energies)?;
    let momenta = flights.iter().map(momentum).collect();
    let momenta = pictures.log_y(
        &stem("momentum"),
        "Change of the angular momentum",
        ["t", "|L - L(1)| / |L(1)|"],
        momenta,
    )?;
    item.pictures.extend([energies, momenta]);
    Ok(())
}

/// Error over cost, compared with the paper's schemes.
pub(super) fn cost(effort: Effort, pictures: &Pictures) -> Result<Item, String> {
    let sizes = effort.sizes();
    let names = ["AS(5)", "DGM", "Newmark(0.25, 0.5)", "HHT(0.05)", "generalized-alpha(0.8)", "Bathe"];
    let mut members: Vec<Member> = names.map(|name| Member::new(name, sizes)).into();
    let second: &[f64] = if effort.quick { &[0.1, 0.05] } else { &[0.1, 0.05, 0.025, 0.0125, 0.00625] };
    members.push(Member { scheme: "DGM", degree: 2, sizes: second.to_vec() });
    let reference = Reference("DGM", 3, if effort.quick { 0.005 } else { 0.001 });
    let case = Case::new("figure-13");
    let curves = study(&case, (1.0, 2.0), &reference, members, &pictures.folder)?;
    let mut item = Item::new(
        "classic-cost",
        "Schemes of other codes: error over step size and over time",
        "The large-strain block, free flight on 1 < t < 2 from the shared state at t = 1.",
    );
    curves.show_errors(&mut item, pictures, "Error over step size", &[(2, "Bathe", 1)])?;
    curves.show_costs(&mut item, pictures, "Error over time")?;
    for name in &names[2..] {
        let order = curves.order(name, 1);
        item.claim(
            format!("{name} converges with order about 2"),
            format!("order {order:.2}"),
            (order - 2.0).abs() < 0.35,
        );
    }
    let best = names[2..5].iter().map(|name| curves.last(name)).fold(f64::INFINITY, f64::min);
    let ratio = curves.last("DGM") / best;
    item.claim(
        "conservation is not paid for with accuracy: DGM is within a factor of two of the best of Newmark's family at the same step",
        format!("{ratio:.2} times its error"),
        ratio < 2.0,
    );
    if !effort.quick {
        price(&mut item, &curves);
    }
    Ok(item)
}

/// Claims about time: the cost of conservation at degree 1, and the gain at degree 2.
fn price(item: &mut Item, curves: &Curves) {
    const FAMILY: [&str; 3] = ["Newmark(0.25, 0.5)", "HHT(0.05)", "generalized-alpha(0.8)"];
    let last = |scheme, degree| curves.costs(scheme, degree).last().copied().unwrap_or((f64::NAN, f64::NAN));
    let ratio = last("DGM", 1).0 / last(FAMILY[0], 1).0;
    item.claim(
        "conservation has a price at degree 1: a run of DGM takes longer than one of average acceleration, but less than twice as long",
        format!("{ratio:.2} times"),
        ratio > 1.0 && ratio < 2.0,
    );
    let second = curves.costs("DGM", 2);
    let gains = FAMILY.map(|name| {
        let (cost, error) = last(name, 1);
        error / error_within(&second, cost).unwrap_or(f64::NAN)
    });
    let least = gains.iter().copied().fold(f64::INFINITY, f64::min);
    item.claim(
        "DGM of degree 2 has a smaller error than each of Newmark's family in the time that this one takes",
        gains.map(|gain| format!("{gain:.1} times")).join(", "),
        gains.iter().all(|gain| gain.is_finite()) && least > 1.0,
    );
}
