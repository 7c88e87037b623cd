//! A force with memory, a reason to refuse, and a bound, beside those of the library.

use std::sync::Arc;

use super::*;
use crate::error::Error;
use crate::force::{ForceSource, Site};
use crate::input::{InitialVelocity, Region};
use crate::material::NeoHooke;
use crate::mesh::block;
use crate::newton::NewtonSettings;
use crate::time::{State, Stepper, TimeElement, TimeElementStepper};

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

    fn memory(&self, _: &Rule) -> ForceMemory {
        ForceMemory::new(vec![0.0])
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

    fn accept(&self, _: &StepInput<'_>, memory: &mut ForceMemory) {
        memory.of_mut::<Vec<f64>>().unwrap()[0] += 1.0;
    }

    fn saved<'m>(&self, memory: &'m ForceMemory) -> &'m [f64] {
        memory.of::<Vec<f64>>().unwrap()
    }

    fn restore(&self, memory: &mut ForceMemory, saved: &[f64]) {
        memory.of_mut::<Vec<f64>>().unwrap().copy_from_slice(saved);
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

#[test]
fn a_force_keeps_memory_over_steps() {
    let (body, mut state) = flight(Wall { limit: 9.0, part: 1.0 });
    let stepper = || {
        let element = TimeElement::discrete_gradient(2).unwrap();
        TimeElementStepper::new(&body, element, NewtonSettings::default()).unwrap()
    };
    let mut first = stepper();
    (0..3).for_each(|_| first.advance(&mut state, 0.1).map(|_| ()).unwrap());
    assert_eq!(first.memory().list("forces").unwrap(), [3.0]);
    let mut second = stepper();
    second.restore(&first.memory()).unwrap();
    second.advance(&mut state, 0.1).unwrap();
    assert_eq!(second.memory().list("forces").unwrap(), [4.0]);
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
        let mut stepper = TimeElementStepper::new(&body, element, NewtonSettings::default()).unwrap();
        let outcomes = (0..5).map(|_| stepper.advance(&mut state, 0.1).unwrap().newton.iterations);
        outcomes.sum::<usize>()
    };
    let (all, most) = (corrections(1.0), corrections(0.8));
    // Each correction leaves a fifth of the error: ten digits take 14 corrections.
    assert!(most > all + 5 * 3, "{most} corrections, {all} without a bound");
}
