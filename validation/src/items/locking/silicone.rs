//! A block of silicone that tumbles.

use emmy::body::{Body, Formulation, Load, LoadKind, Region, TimeFunction};
use emmy::material::{NeoHookeIsochoric, Volumetric};
use emmy::motion::{Motion, NewtonSettings, Phase, Record, State, StepPlan};
use emmy::time::TimeElement;

use crate::claim::Item;
use crate::items::Effort;
use crate::measure::momentum_change;
use crate::picture::{Pictures, Series};

/// Poisson's ratio of silicone, and its ratio of moduli `K/mu = 2 (1 + nu) / (3 (1 - 2 nu))`, 5e4.
const POISSON: f64 = 0.49999;
const SHEAR: f64 = 500.0;

/// The L-shaped block of Betsch and Steinmann (2001), Section 5, of a softer rubber: half of the height of their load.
fn block(bulk_modulus: f64) -> Result<Body, emmy::Error> {
    let silicone = NeoHookeIsochoric::new(SHEAR, bulk_modulus, Volumetric::SimoTaylor)?;
    let traction = [256.0, 512.0, 768.0].map(|t| t / 9.0);
    let time_function = TimeFunction::new(vec![(0.0, 0.0), (0.5, 0.5), (1.0, 0.0)])?;
    let loads = [("face-a", 1.0), ("face-b", -1.0)].map(|(group, sign)| Load {
        kind: LoadKind::Traction { group: group.into(), traction: traction.map(|t| sign * t) },
        time_function: time_function.clone(),
    });
    Body::builder(emmy::mesh::l_block(1.0)?)
        .region(Region::new(silicone, 0.5).with_formulation(Formulation::ProjectedVolume(None)))
        .loads(loads)
        .build()
}

/// Drifts over the free flight.
struct Flight {
    /// (step, relative change of H, of L)
    changes: Vec<(f64, f64, f64)>,
    largest: [f64; 2],
    iterations: usize,
    steps: usize,
    /// Largest share of the strain energy.
    strained: f64,
}

fn fly(bulk_modulus: f64, steps: usize) -> Result<Flight, emmy::Error> {
    let body = block(bulk_modulus)?;
    let scheme = TimeElement::discrete_gradient(1)?;
    let state = State::initial(&body, 0.0, &[])?;
    let mut motion = Motion::starting(&body, scheme, NewtonSettings::default(), state)?;
    let plan = StepPlan::new(0.0, vec![Phase { until: 1.0, size: 0.02 }])?;
    for step in plan.steps() {
        motion.step_of_plan(&step)?;
    }
    let first = motion.record().clone();
    let mut flight = Flight { changes: vec![], largest: [0.0; 2], iterations: 0, steps, strained: 0.0 };
    for step in 1..=steps {
        flight.add(step, &first, motion.step(0.02)?);
    }
    Ok(flight)
}

impl Flight {
    fn add(&mut self, step: usize, first: &Record, record: &Record) {
        let energy = (record.total_energy / first.total_energy - 1.0).abs();
        let momentum = momentum_change(first, record);
        self.largest = [self.largest[0].max(energy), self.largest[1].max(momentum)];
        self.iterations += record.newton_iterations;
        self.strained = self.strained.max(record.strain_energy / record.total_energy);
        if step.is_multiple_of(10) {
            self.changes.push((step as f64, energy, momentum));
        }
    }
}

/// The block through 10,000 steps.
pub(in crate::items) fn item(effort: Effort, pictures: &Pictures) -> Result<Item, String> {
    let mut item = Item::new(
        "silicone",
        "Elements that do not lock: silicone in free flight",
        "The L-shaped block of silicone (isochoric neo-Hooke, mu = 500, nu = 0.49999: K = 5e4 mu; density 0.5; hex8 with a constant pressure), \
        loaded until t = 1 by the tractions of the paper at half of their height, then free: DGM with h = 0.02.",
    );
    let steps = if effort.quick { 200 } else { 10_000 };
    let text = |error: emmy::Error| error.to_string();
    let flight = fly(SHEAR * 2.0 * (1.0 + POISSON) / (3.0 * (1.0 - 2.0 * POISSON)), steps).map_err(text)?;
    let [energy, momentum] = flight.largest;
    item.claim(
        format!("energy and angular momentum are conserved through {steps} steps"),
        format!(
            "largest change of H {energy:.1e}, of L {momentum:.1e}; strain energy up to {:.0} % of H",
            100.0 * flight.strained
        ),
        energy < 1e-11 && momentum < 1e-11,
    );
    let soft = fly(10.0 * SHEAR, 200).map_err(text)?;
    let [stiff, soft] = [&flight, &soft].map(|flight| flight.iterations as f64 / flight.steps as f64);
    item.claim(
        "a step takes at most 1.3 times the corrections of one with K = 10 mu",
        format!("{stiff:.2} and {soft:.2} a step"),
        stiff <= 1.3 * soft,
    );
    let curve = |of: fn(&(f64, f64, f64)) -> f64| flight.changes.iter().map(|at| (at.0, of(at))).collect();
    item.pictures.push(pictures.log_y(
        "silicone",
        "Silicone in free flight, K = 5e4 mu",
        ["step", "relative change since t = 1"],
        vec![Series::line("energy", curve(|at| at.1)), Series::line("angular momentum", curve(|at| at.2))],
    )?);
    item.commands.push("cargo run --release -p emmy-validation -- --only silicone".into());
    Ok(item)
}
