//! A force with memory, a reason to refuse, and a bound, beside those of the library.

use std::sync::Arc;

use super::*;
use crate::error::Error;
use crate::force::{ForceSource, Site};
use crate::input::{InitialVelocity, Region};
use crate::material::NeoHooke;
use crate::mesh::block;
use crate::motion::{Adaptivity, GlobalError, Motion, Phase, StepPlan};
use crate::newton::NewtonSettings;
use crate::time::{LocalError, Scheme, State, Stepper, TimeElement, TimeElementStepper};

/// A force that is zero up to a displacement of the first node along x, and refuses what is beyond; it admits a
/// part of each correction, and counts steps.
#[derive(Debug, Clone)]
struct Wall {
    limit: f64,
    part: f64,
}

impl ForceSource for Wall {
    fn force(&self, _: usize, _: &Site<'_>) -> Result<Arc<dyn Force>> {
        Ok(Arc::new(self.clone()))
    }
}

impl Force for Wall {
    fn book(&self) -> Book {
        Book::Work
    }

    fn side(&self) -> Side {
        Side::Outside
    }

    fn depends_on_place(&self) -> bool {
        true
    }

    fn assemble(
        &self,
        (step, _): (&StepInput<'_>, Request),
        _: &ForceMemory,
        _: usize,
        _: &mut Scratch,
        _: &mut RowPart,
    ) -> Result<()> {
        match step.displacement[0] + step.rates[0] <= self.limit {
            true => Ok(()),
            false => Err(Error::Refused { reason: "the wall is in the way".to_string() }),
        }
    }

    fn bounds(&self) -> bool {
        self.part < 1.0
    }

    fn largest_part(&self, _: &StepInput<'_>, _: &ForceMemory, _: &[f64]) -> f64 {
        self.part
    }

    fn n_history(&self) -> usize {
        1
    }

    fn update_history(&self, _: &StepInput<'_>, _: &ForceMemory, history: &mut [f64]) {
        history[0] += 1.0;
    }
}

/// A block that spins and flies along x with the velocity 1.
fn flight(wall: Wall) -> (Body, State) {
    let rubber = Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 1.0);
    let body = Body::builder(block([1.0; 3], [1; 3]).unwrap()).region(rubber).force(wall).build().unwrap();
    let flies = InitialVelocity {
        velocity: [1.0, 0.0, 0.0],
        angular_velocity: [1.0, 0.0, 0.0],
        ..InitialVelocity::default()
    };
    let state = State::initial(&body, 0.0, &[flies]).unwrap();
    (body, state)
}

/// Steps that are cut or rejected, and those of estimators, leave no trace in the history of a motion; it goes on after
/// another start from a snapshot.
#[test]
fn the_history_of_forces_counts_the_steps_of_a_motion() {
    let (body, state) = flight(Wall { limit: 9.0, part: 1.0 });
    let element = TimeElement::discrete_gradient(2).unwrap();
    let mut motion = Motion::starting(&body, element, NewtonSettings::default(), state).unwrap();
    let mut error = GlobalError::new(&body, element, NewtonSettings::default(), motion.state()).unwrap();
    let adaptivity = Adaptivity { first: Some(0.4), ..Adaptivity::new(1e-6) };
    let plan = StepPlan::adaptive(0.0, 2.0, adaptivity).unwrap();
    motion.march(&plan, &mut [&mut error]).unwrap();
    assert!(motion.statistics().rejections > 0 && motion.state().step > 3);
    assert_eq!(motion.state().history, [motion.state().step as f64]);
    assert_eq!(error.state().history, motion.state().history);

    let mut resumed = Motion::resumed(&body, element, NewtonSettings::default(), motion.snapshot()).unwrap();
    let steps = motion.state().step;
    resumed.step(0.1).unwrap();
    assert_eq!(resumed.state().history, [steps as f64 + 1.0]);
}

/// The wall refuses the planned step, but not a quarter of it.
#[test]
fn a_refused_step_leaves_no_trace_in_the_history() {
    let (body, state) = flight(Wall { limit: 0.9, part: 1.0 });
    let element = TimeElement::discrete_gradient(1).unwrap();
    let mut motion = Motion::starting(&body, element, NewtonSettings::default(), state).unwrap();
    motion.allow_cuts(None);
    let plan = StepPlan::new(0.0, vec![Phase { until: 2.0, size: 2.0 }]).unwrap();
    let record = motion.next_step(&plan, &mut []).unwrap().unwrap().clone();
    assert!(record.cuts > 0);
    assert_eq!(motion.state().history, [1.0]);
}

#[test]
fn forces_with_a_history_need_a_time_element() {
    let (body, state) = flight(Wall { limit: 9.0, part: 1.0 });
    for scheme in ["Newmark(0.25, 0.5)", "Bathe", "central-differences"] {
        let scheme: Scheme = scheme.parse().unwrap();
        let error = scheme.check_body(&body).unwrap_err().to_string();
        assert!(error.contains("forces with a history need a time element"), "{error}");
    }
    assert_eq!(body.without_adjoint(), Some("forces with a history are not covered"));
    let lost = State { history: Vec::new(), ..state };
    let element = TimeElement::discrete_gradient(1).unwrap();
    let error = Motion::starting(&body, element, NewtonSettings::default(), lost).unwrap_err();
    assert!(error.to_string().contains("history"), "{error}");
}

#[test]
fn a_force_refuses_a_step_with_its_own_reason() {
    let (body, mut state) = flight(Wall { limit: 0.25, part: 1.0 });
    let element = TimeElement::discrete_gradient(1).unwrap();
    let mut stepper = TimeElementStepper::new(&body, element, NewtonSettings::default()).unwrap();
    stepper.advance(&mut state, 0.2).unwrap();
    let error = stepper.advance(&mut state, 0.2).unwrap_err();
    let reason = match &error {
        Error::StepFailed { cause, .. } => cause.to_string(),
        error => error.to_string(),
    };
    assert_eq!(reason, "the wall is in the way");
}

#[test]
fn a_force_bounds_corrections() {
    let corrections = |part: f64| {
        let (body, mut state) = flight(Wall { limit: 9.0, part });
        let element = TimeElement::discrete_gradient(1).unwrap();
        let settings = NewtonSettings { max_iterations: 60, ..NewtonSettings::default() };
        let mut stepper = TimeElementStepper::new(&body, element, settings).unwrap();
        (0..5).map(|_| stepper.advance(&mut state, 0.1).unwrap().newton.iterations).sum::<usize>()
    };
    let [all, most, half] = [1.0, 0.8, 0.5].map(corrections);
    // Each correction leaves a fifth of the error, or half of it: ten digits take 14 corrections, or 33.
    assert!(most > all + 5 * 3, "{most} corrections, {all} without a bound");
    assert!(half > most + 5 * 5, "{half} corrections, {most} with another bound");
}

/// A force `-c v` on the first node along x.
#[derive(Debug, Clone)]
struct Dashpot(f64);

impl ForceSource for Dashpot {
    fn force(&self, _: usize, _: &Site<'_>) -> Result<Arc<dyn Force>> {
        Ok(Arc::new(self.clone()))
    }
}

impl Force for Dashpot {
    fn book(&self) -> Book {
        Book::Dissipated
    }

    fn side(&self) -> Side {
        Side::Outside
    }

    fn assemble(
        &self,
        (step, request): (&StepInput<'_>, Request),
        _: &ForceMemory,
        _: usize,
        _: &mut Scratch,
        sink: &mut RowPart,
    ) -> Result<()> {
        if !sink.owns(0) {
            return Ok(());
        }
        let (k, n) = (step.rule.degree(), step.displacement.len());
        let damping = self.0 * step.damping.inverse_step_size;
        for i in 0..k {
            sink.add_force(i, 0, [-damping * step.rates[i * n], 0.0, 0.0]);
            if request == Request::Tangent {
                sink.block_mut(0, i * k + i)[0] += step.tangent_factor * damping;
            }
        }
        Ok(())
    }
}

/// The work of a dashpot is dissipated, not done from outside; its impulse is booked.
#[test]
fn the_work_of_a_dashpot_is_lost() {
    for k in 1..=3 {
        let rubber = Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 1.0);
        let builder = Body::builder(block([1.0; 3], [1; 3]).unwrap()).region(rubber);
        let body = builder.force(Dashpot(0.7)).build().unwrap();
        let flies = InitialVelocity { velocity: [1.0, 0.5, 0.0], ..InitialVelocity::default() };
        let state = State::initial(&body, 0.0, &[flies]).unwrap();
        // Its force at the start, -c v, is in the acceleration from which steps are chosen.
        let mut inertia = vec![0.0; body.n_dofs()];
        body.mass_product(&LocalError::acceleration(&body, &state).unwrap(), &mut inertia);
        assert!((body.space.sum(&inertia)[0] + 0.7).abs() < 1e-12);
        assert!(body.without_adjoint().is_some_and(|reason| reason.contains("follow the motion")));
        let element = TimeElement::discrete_gradient(k).unwrap();
        let mut motion = Motion::starting(&body, element, NewtonSettings::default(), state).unwrap();
        let start = motion.record().total_energy;
        let (mut travel, mut dissipated) = (0.0, 0.0);
        for _ in 0..20 {
            let before = motion.state().displacement[0];
            let record = motion.step(0.05).unwrap().clone();
            travel += motion.state().displacement[0] - before;
            assert!(record.energy_residual.abs() < 1e-12, "{record:?}");
            assert!(record.linear_momentum_residual < 1e-12 && record.angular_momentum_residual < 1e-12);
            assert!(record.external_work.abs() < 1e-14);
            dissipated = record.dissipated_energy;
        }
        assert!(dissipated > 0.01 && (start - motion.record().total_energy - dissipated).abs() < 1e-11);
        // The impulse of -c v is -c times the way of the node.
        let momentum = 1.0 - 0.7 * travel;
        assert!((motion.record().linear_momentum[0] - momentum).abs() < 1e-11, "k = {k}");
    }
}
