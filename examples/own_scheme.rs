//! A user's scheme: the method of Forest and Ruth (1990), which has order 4, and a block of rubber that tumbles by it.
//!
//!     cargo run --release -p emmy --example own_scheme

use emmy::body::Reaction;
use emmy::prelude::*;
use emmy::time::{PointForces, StepOutcome, Stepper};

/// Size of the first and the third Verlet step over that of the whole, w = 1 / (2 - 2^(1/3)).
const W: f64 = 1.351_207_191_959_657_8;

/// Drifts with the velocity and kicks by the forces, in turn, over the step size: Verlet steps of w, 1 - 2 w and w.
const STAGES: [(f64, f64); 4] =
    [(0.0, W / 2.0), (W, (1.0 - W) / 2.0), (1.0 - 2.0 * W, (1.0 - W) / 2.0), (W, W / 2.0)];

/// The method with the lumped mass m: `p = m v`.
#[derive(Debug)]
struct ForestRuth<'a> {
    forces: PointForces<'a>,
    /// Mean velocity during a kick.
    mean: Vec<f64>,
}

impl<'a> ForestRuth<'a> {
    fn new(body: &'a Body) -> emmy::Result<Self> {
        Ok(ForestRuth { forces: PointForces::new(body)?, mean: vec![0.0; body.n_dofs()] })
    }
}

impl Stepper for ForestRuth<'_> {
    fn name(&self) -> &'static str {
        "Forest-Ruth"
    }

    fn start(&mut self, state: &mut State) -> emmy::Result<()> {
        let mass = self.forces.body().lumped_mass();
        let momenta = state.momentum.iter_mut().zip(&state.velocity).enumerate();
        momenta.for_each(|(dof, (p, v))| *p = mass[dof / 3] * v);
        Ok(())
    }

    fn advance(&mut self, state: &mut State, h: f64) -> emmy::Result<StepOutcome> {
        let body = self.forces.body();
        let mut time = state.time;
        self.forces.begin();
        for (drift, kick) in STAGES {
            state.displacement.iter_mut().zip(&state.velocity).for_each(|(u, v)| *u += drift * h * v);
            time += drift * h;
            let net = self.forces.evaluate(&state.displacement, time)?;
            for dof in (0..body.n_dofs()).filter(|&dof| !body.fixed()[dof]) {
                let before = state.velocity[dof];
                state.momentum[dof] += kick * h * net[dof];
                state.velocity[dof] = state.momentum[dof] / body.lumped_mass()[dof / 3];
                self.mean[dof] = 0.5 * (before + state.velocity[dof]);
            }
            self.forces.book(kick * h, &self.mean, None)?;
        }
        StepOutcome::new(body, state, self.forces.end(h))
    }

    fn reactions(&self) -> &[Reaction] {
        self.forces.reactions()
    }
}

/// The block, which spins and stretches.
fn block() -> emmy::Result<(Body, State)> {
    let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 1.0);
    let body = Body::builder(mesh::block([1.0, 2.0, 1.0], [2, 4, 2])?).region(rubber).build()?;
    let gradient = [[0.0, 3.0, 0.0], [0.0, -2.0, 0.0], [0.0, 0.0, 1.0]];
    let spin = InitialVelocity { angular_velocity: [3.0, 1.0, 6.0], gradient, ..Default::default() };
    let state = State::initial(&body, 0.0, &[spin])?;
    Ok((body, state))
}

/// Records of a motion until t = 0.64, and its end.
fn tumble(steps: usize) -> emmy::Result<(Vec<Record>, State)> {
    let (body, state) = block()?;
    let mut motion = Motion::with_stepper(&body, ForestRuth::new(&body)?)?.from(state)?;
    let mut records = vec![motion.record().clone()];
    for _ in 0..steps {
        records.push(motion.step(0.64 / steps as f64)?.clone());
    }
    Ok((records, motion.state().clone()))
}

/// Largest distance of two displacements.
fn distance(a: &State, b: &State) -> f64 {
    a.displacement.iter().zip(&b.displacement).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn main() -> emmy::Result<()> {
    // Distances of the ends of runs with n and n/2 steps.
    let (mut last, mut change) = (tumble(128)?.1, f64::NAN);
    for steps in [256, 512, 1024, 2048] {
        let (records, end) = tumble(steps)?;
        let energy = records[0].total_energy;
        let drift =
            records.iter().map(|record| (record.total_energy / energy - 1.0).abs()).fold(0.0, f64::max);
        let before = std::mem::replace(&mut change, distance(&last, &end));
        print!("{steps:5} steps: energy within {drift:.1e}");
        println!(
            "{}",
            if before.is_nan() { String::new() } else { format!(", order {:.2}", (before / change).log2()) }
        );
        last = end;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use emmy::time::Scheme;

    #[test]
    fn its_order_is_four_and_its_momenta_are_kept() {
        let runs = [256, 512, 1024].map(|steps| tumble(steps).unwrap());
        let [coarse, fine] = [0, 1].map(|run| distance(&runs[run].1, &runs[run + 1].1));
        let order = (coarse / fine).log2();
        assert!((order - 4.0).abs() < 0.1, "{order}");

        // Central differences integrate the same equations with order 2.
        let end = |steps: usize| {
            let (body, state) = block().unwrap();
            let mut motion = Motion::new(&body, Scheme::CentralDifferences).unwrap().from(state).unwrap();
            (0..steps).for_each(|_| _ = motion.step(0.64 / steps as f64).unwrap());
            distance(motion.state(), &runs[2].1)
        };
        let order = (end(512) / end(1024)).log2();
        assert!((order - 2.0).abs() < 0.05, "{order}");

        let (records, _) = &runs[0];
        for record in records {
            for i in 0..3 {
                let change = record.angular_momentum[i] - records[0].angular_momentum[i];
                assert!(change.abs() < 1e-12, "{change}");
            }
            assert!(record.strain_energy < 0.9 * record.total_energy);
        }
        assert!(records.iter().any(|record| record.strain_energy > 0.05 * record.total_energy));
    }
}
