//! Long free flight.

use emmy::motion::{MarchError, Motion, Observer, Record, State, View};

use super::{CONSERVED, Effort, LOST};
use crate::case::Case;
use crate::claim::Item;
use crate::measure::momentum_change;
use crate::picture::{Pictures, Series};

/// The schemes that conserve both, and the largest drift of H: round-off for DGM, the error of the inner rule for the
/// others.
const CONSERVING: [(&str, f64); 3] = [("DGM", 1e-11), ("AS(8)", CONSERVED), ("AS(5)", LOST)];
const OTHERS: [&str; 6] =
    ["FE(1)", "FE(5)", "Newmark(0.25, 0.5)", "HHT(0.05)", "generalized-alpha(0.8)", "Bathe"];

/// Observations of a flight, at every hundredth step.
#[derive(Debug, Default)]
struct Watch {
    first: Option<Record>,
    /// (step, relative change of H, of L)
    changes: Vec<(f64, f64, f64)>,
    largest: (f64, f64),
    /// Number of successful steps.
    steps: usize,
    failure: Option<String>,
}

impl Observer for Watch {
    fn observe(&mut self, view: View<'_>) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        let record = view.record;
        let first = self.first.get_or_insert_with(|| record.clone());
        let energy = record.total_energy / first.total_energy - 1.0;
        let momentum = momentum_change(first, record);
        self.largest = (self.largest.0.max(energy.abs()), self.largest.1.max(momentum));
        self.steps = record.step;
        if record.step > 0 && record.step.is_multiple_of(100) {
            self.changes.push((record.step as f64, energy, momentum));
        }
        Ok(())
    }
}

fn fly(case: &Case) -> Result<Watch, String> {
    let problem = case.problem()?;
    let text = |error: emmy::Error| error.to_string();
    let state = State::initial(&problem.body, problem.plan.start(), &problem.initial).map_err(text)?;
    let motion = Motion::starting(&problem.body, problem.scheme, problem.newton, state);
    let mut watch = Watch::default();
    match motion.map_err(text)?.march(&problem.plan, &mut [&mut watch]) {
        Ok(()) => Ok(watch),
        Err(MarchError::Step(error)) => Ok(Watch { failure: Some(error.to_string()), ..watch }),
        Err(error) => Err(error.to_string()),
    }
}

/// Every scheme for 100,000 steps.
pub(super) fn free_flight(effort: Effort, pictures: &Pictures) -> Result<Item, String> {
    let mut item = Item::new(
        "free-flight",
        "Beyond the paper: long free flight",
        "A soft bar of four cells spins, stretches and shears for 100,000 steps of h = 0.04 (2,000 in the quick set). The physics \
        conserves energy and angular momentum; the table shows them for each scheme. Central differences take as many steps of 0.008, below their critical step.",
    );
    let n_steps = if effort.quick { 2_000 } else { 100_000 };
    let names = CONSERVING.iter().map(|(name, _)| *name).chain(OTHERS).chain(["central-differences"]);
    let mut flights = Vec::new();
    for name in names {
        let size = if name == "central-differences" { 0.008 } else { 0.04 };
        let steps = format!("[{{ until = {}, size = {size} }}]", size * f64::from(n_steps));
        let case = Case::new("free-flight").scheme(name).with("time.steps", steps);
        item.commands.push(case.command());
        flights.push((name, fly(&case)?));
    }
    show(&mut item, pictures, &flights)?;
    let find = |wanted: &str| flights.iter().find(|(name, _)| *name == wanted).map(|(_, watch)| watch);
    for (name, bound) in CONSERVING {
        let Some(watch) = find(name) else { continue };
        item.claim(
            format!("{name} keeps energy (below {bound:e}) and angular momentum (below 1e-11) through {n_steps} steps"),
            watch.words(),
            watch.failure.is_none() && watch.largest.0 < bound && watch.largest.1 < 1e-11,
        );
    }
    for name in OTHERS {
        let Some(watch) = find(name) else { continue };
        let (energy, momentum) = match name {
            "FE(1)" => (false, true),
            "FE(5)" => (true, false),
            _ => (false, false),
        };
        let words = |kept: bool| if kept { "keeps" } else { "loses" };
        item.claim(
            format!("{name} {} the energy, {} the angular momentum", words(energy), words(momentum)),
            watch.words(),
            (watch.largest.0 < LOST) == energy && (watch.largest.1 < LOST) == momentum,
        );
    }
    if let Some(watch) = find("central-differences") {
        item.claim(
            "central-differences keeps the angular momentum, and its energy within a band",
            watch.words(),
            watch.largest.1 < CONSERVED && watch.largest.0 < 0.05,
        );
    }
    Ok(item)
}

impl Watch {
    fn words(&self) -> String {
        let drift = format!("largest change of H {:.1e}, of L {:.1e}", self.largest.0, self.largest.1);
        match &self.failure {
            None => drift,
            Some(_) => format!("{drift}, no convergence after {} steps", self.steps),
        }
    }
}

fn show(item: &mut Item, pictures: &Pictures, flights: &[(&'static str, Watch)]) -> Result<(), String> {
    let curve = |value: fn(&(f64, f64, f64)) -> f64| {
        let of =
            move |watch: &Watch| watch.changes.iter().map(|change| (change.0, value(change).abs())).collect();
        flights.iter().map(|(name, watch)| Series::line(name, of(watch))).collect::<Vec<_>>()
    };
    let energy = pictures.log_log(
        "free-flight-energy",
        "Change of the total energy",
        ["step".to_string(), "|H - H(0)| / H(0)".to_string()],
        curve(|change| change.1),
        vec![],
    )?;
    let momentum = pictures.log_log(
        "free-flight-momentum",
        "Change of the angular momentum",
        ["step".to_string(), "|L - L(0)| / |L(0)|".to_string()],
        curve(|change| change.2),
        vec![],
    )?;
    item.pictures.extend([energy, momentum]);
    let header = ["scheme", "steps", "H at the end over the start", "largest change of L"].map(String::from);
    let line = |(name, watch): &(&str, Watch)| {
        let energy = watch.changes.last().map_or(f64::NAN, |change| change.1);
        let energy =
            if energy.abs() < 1e-4 { format!("1 {energy:+.1e}") } else { format!("{:.3}", 1.0 + energy) };
        let steps = match watch.failure {
            None => watch.steps.to_string(),
            Some(_) => format!("{}, then no convergence", watch.steps),
        };
        vec![name.to_string(), steps, energy, format!("{:.1e}", watch.largest.1)]
    };
    item.tables.push(std::iter::once(header.to_vec()).chain(flights.iter().map(line)).collect());
    Ok(())
}
