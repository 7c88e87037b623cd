//! Sensitivities and error of the tip displacement of a beam, from one adjoint motion.
//!
//!     cargo run --release --example sensitivity

use std::f64::consts::PI;

use emmy::adjoint::{Goal, Parameter, Trajectory};
use emmy::body::{Body, Field, Load, LoadKind, Region, Support, TimeFunction};
use emmy::material::NeoHooke;
use emmy::motion::{Motion, NewtonSettings, Phase, State, StepPlan};
use emmy::time::TimeElement;

const LAMBDA: f64 = 600.0;
const MU: f64 = 300.0;
const DENSITY: f64 = 1.0;

/// A beam along x, fixed at one end and loaded at the other for two units of time.
fn beam(lambda: f64, mu: f64, density: f64) -> emmy::Result<Body> {
    // Without kinks, which would excite modes that no step resolves.
    let strength = |t: f64| if t < 2.0 { (0.5 * PI * t).sin().powi(4) } else { 0.0 };
    let field = Field::new(move |_, t| [0.0, 8.0 * strength(t), 3.0 * strength(t)]);
    let push = Load {
        kind: LoadKind::TractionField { group: "x-max".into(), field },
        time_function: TimeFunction::constant(),
    };
    let held = Support { group: "x-min".into(), fix: [true; 3], ..Default::default() };
    let mesh = emmy::mesh::block([4.0, 1.0, 1.0], [4, 1, 1])?;
    Body::builder(mesh)
        .region(Region::new(NeoHooke::new(lambda, mu)?, density))
        .support(held)
        .load(push)
        .build()
}

/// Position of the tip along y at the end, its derivatives, and its estimated error.
#[derive(Debug)]
struct Tip {
    place: f64,
    by_lambda: f64,
    by_mu: f64,
    by_density: f64,
    error: f64,
}

fn settings() -> NewtonSettings {
    NewtonSettings { tolerance: 1e-12, ..NewtonSettings::default() }
}

fn tip(step_size: f64) -> emmy::Result<Tip> {
    let body = beam(LAMBDA, MU, DENSITY)?;
    let state = State::initial(&body, 0.0, &[])?;
    let mut motion = Motion::starting(&body, TimeElement::discrete_gradient(2)?, settings(), state)?;
    let mut trajectory = Trajectory::new(&motion)?;
    let plan = StepPlan::new(0.0, vec![Phase { until: 3.0, size: step_size }])?;
    for step in plan.steps() {
        trajectory.record(&motion)?;
        motion.step_of_plan(&step)?;
    }
    trajectory.record(&motion)?;
    let corner = body.mesh().n_nodes() - 1;
    let goal = Goal::displacement_at(&body, corner, [0.0, 1.0, 0.0]);
    let parameters = [
        Parameter::linear(LAMBDA, LAMBDA, |lambda| beam(lambda, MU, DENSITY))?,
        Parameter::linear(MU, MU, |mu| beam(LAMBDA, mu, DENSITY))?,
        Parameter::linear(DENSITY, DENSITY, |density| beam(LAMBDA, MU, density))?,
    ];
    let by = trajectory.gradient(&goal, &parameters)?.parameters;
    let error = trajectory.goal_error(&goal)?.total();
    Ok(Tip { place: goal.value(motion.state()), by_lambda: by[0], by_mu: by[1], by_density: by[2], error })
}

fn main() -> emmy::Result<()> {
    for step_size in [0.1, 0.05] {
        let tip = tip(step_size)?;
        println!(
            "steps of {step_size}: the tip has moved by {:.6}, with an error of {:.1e}",
            tip.place, tip.error
        );
        println!("  one percent more of lambda, mu, density moves it by");
        let percents =
            [tip.by_lambda * LAMBDA, tip.by_mu * MU, tip.by_density * DENSITY].map(|slope| 0.01 * slope);
        println!("  {:+.6}, {:+.6}, {:+.6}", percents[0], percents[1], percents[2]);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(mu: f64, degree: usize, step_size: f64) -> f64 {
        let body = beam(LAMBDA, mu, DENSITY).unwrap();
        let state = State::initial(&body, 0.0, &[]).unwrap();
        let mut motion =
            Motion::starting(&body, TimeElement::discrete_gradient(degree).unwrap(), settings(), state)
                .unwrap();
        motion
            .march(&StepPlan::new(0.0, vec![Phase { until: 3.0, size: step_size }]).unwrap(), &mut [])
            .unwrap();
        motion.state().displacement[motion.state().displacement.len() - 2]
    }

    #[test]
    fn slopes_and_errors_match_other_motions() {
        let tip = tip(0.1).unwrap();
        let slope = (place(1.001 * MU, 2, 0.1) - place(0.999 * MU, 2, 0.1)) / (0.002 * MU);
        assert!((tip.by_mu / slope - 1.0).abs() < 1e-4, "{tip:?} {slope}");
        let error = tip.place - place(MU, 3, 0.05);
        assert!((0.8..1.25).contains(&(tip.error / error)), "{tip:?} {error}");
    }

    /// The ratios in the book.
    #[test]
    fn errors_are_estimated_the_better_the_smaller_the_steps() {
        let exact = place(MU, 4, 0.05);
        for (step_size, quoted) in [(0.1, 1.11), (0.05, 0.99)] {
            let tip = tip(step_size).unwrap();
            let ratio = tip.error / (tip.place - exact);
            assert!((ratio - quoted).abs() < 0.01, "{step_size}: {ratio}");
        }
    }
}
