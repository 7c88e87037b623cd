//! The local error of a step: what a step makes of a state, less what the motion makes of it.

use super::classic::{Forces, Start};
use super::{Memory, Scheme, State, Stepper};
use crate::body::Body;
use crate::error::Result;
use crate::newton::NewtonSettings;

/// Estimates the error of each step of a time element, in positions and velocities at its end.
///
/// *By differences*, for degree 1. All elements of degree 1 end with `u_2 = u_1 + h (v_1 + v_2)/2`: the trapezoidal rule, whose error is
///
/// ```math
/// du = h^3/12 u''',    u''' ~ 2 (a_n - a_(n-1)) / (h_n + h_(n-1)),    a_n = (v_(n+1) - v_n) / h_n
/// ```
///
/// with mean accelerations, which are those of the middles of the steps (Zienkiewicz and Xie 1991, A simple error estimator and
/// adaptive time stepping procedure for dynamic analysis, Earthquake Engineering and Structural Dynamics 20, for accelerations at the
/// ends). The error of the velocity is the same with one derivative more. It costs nothing. Modes that the step does not resolve swing from
/// step to step, `|a_n - a_(n-1)| <= 4 |v|/h`, and count with `h |v|/3` at most.
///
/// *By an element of degree k + 1* from the same state, for k > 1: the difference of the two ends. The one has the error
/// `c h^(2k+1)`, the other `c h^(2k+3)`, so that the estimate is exact in the limit. It costs a step of that element.
#[derive(Debug)]
pub struct LocalError<'a> {
    body: &'a Body,
    kind: Kind<'a>,
    /// Error of the positions at the end of the last step, `[n_nodes][3]`.
    displacement: Vec<f64>,
    /// Error of the velocities.
    velocity: Vec<f64>,
}

#[derive(Debug)]
enum Kind<'a> {
    Difference(Box<Difference>),
    Element { stepper: Box<dyn Stepper + 'a>, end: State },
}

/// What differences are taken of.
#[derive(Debug)]
struct Difference {
    /// Acceleration at a time before the step, and how far that lies before its start.
    acceleration: Vec<f64>,
    before: f64,
    /// Third derivative of the displacement at the start of the step before, and how far that lies before.
    third: Vec<f64>,
    third_before: Option<f64>,
    /// What a step that is accepted puts in their place.
    new_acceleration: Vec<f64>,
    new_third: Vec<f64>,
}

impl<'a> LocalError<'a> {
    /// The estimator for steps of a scheme from a state.
    ///
    /// # Errors
    /// Those of [`Scheme::stepper`]; [`crate::Error::Inverted`], [`crate::Error::Linear`].
    pub fn new(
        body: &'a Body,
        scheme: Scheme,
        degree: usize,
        settings: NewtonSettings,
        state: &State,
    ) -> Result<Self> {
        let n = body.n_dofs();
        let kind = if degree == 1 {
            Kind::Difference(Box::new(Difference::new(n)))
        } else {
            let mut end = state.clone();
            let stepper = scheme.of_degree(degree + 1).stepper(body, degree + 1, settings, &mut end)?;
            Kind::Element { stepper, end }
        };
        let mut estimator = LocalError { body, kind, displacement: vec![0.0; n], velocity: vec![0.0; n] };
        estimator.restart(state)?;
        Ok(estimator)
    }

    /// Acceleration of a state, `M a = F(t) - f(u)` on the free degrees of freedom, `[n_nodes][3]`.
    ///
    /// # Errors
    /// [`crate::Error::Inverted`], [`crate::Error::Linear`].
    pub fn acceleration(body: &Body, state: &State) -> Result<Vec<f64>> {
        Ok(Start::new(&mut Forces::new(body), state)?.acceleration)
    }

    /// Power of the step size with which the error grows.
    pub fn order(degree: usize) -> usize {
        2 * degree + 1
    }

    /// Begins anew at a state, where a load has jumped.
    ///
    /// # Errors
    /// [`crate::Error::Inverted`], [`crate::Error::Linear`].
    pub fn restart(&mut self, state: &State) -> Result<()> {
        if let Kind::Difference(difference) = &mut self.kind {
            difference.acceleration = LocalError::acceleration(self.body, state)?;
            (difference.before, difference.third_before) = (0.0, None);
        }
        Ok(())
    }

    /// Estimates the error of a step between two states.
    ///
    /// # Errors
    /// Those of [`Stepper::advance`]: the element of degree k + 1 may fail where that of degree k did not.
    pub fn estimate(&mut self, start: &State, end: &State, step_size: f64) -> Result<()> {
        match &mut self.kind {
            Kind::Difference(difference) => {
                difference.estimate(start, end, step_size, &mut self.displacement, &mut self.velocity);
            }
            Kind::Element { stepper, end: better } => {
                better.copy_from(start);
                stepper.advance(better, step_size)?;
                set_difference(&mut self.displacement, &end.displacement, &better.displacement);
                set_difference(&mut self.velocity, &end.velocity, &better.velocity);
            }
        }
        for (dof, _) in self.body.fixed().iter().enumerate().filter(|(_, fixed)| **fixed) {
            (self.displacement[dof], self.velocity[dof]) = (0.0, 0.0);
        }
        Ok(())
    }

    /// Goes over to the next step.
    pub fn accept(&mut self, step_size: f64) {
        if let Kind::Difference(difference) = &mut self.kind {
            difference.accept(step_size);
        }
    }

    /// Error of the positions at the end of the last step that was estimated, `[n_nodes][3]` \[length\].
    pub fn displacement(&self) -> &[f64] {
        &self.displacement
    }

    /// Error of the velocities \[length/time\].
    pub fn velocity(&self) -> &[f64] {
        &self.velocity
    }

    /// What the estimates to come depend on.
    pub fn memory(&self) -> Memory {
        match &self.kind {
            Kind::Difference(difference) => {
                let mut memory = Memory::default();
                memory.keep("acceleration", &difference.acceleration);
                memory.keep("before", &[difference.before]);
                memory.keep("third", &difference.third);
                memory.keep("third_before", difference.third_before.as_slice());
                memory
            }
            Kind::Element { stepper, .. } => stepper.memory(),
        }
    }

    /// Takes over the memory of another estimator of the same kind.
    ///
    /// # Errors
    /// [`crate::Error::Memory`], and those of [`Stepper::restore`].
    pub fn restore(&mut self, memory: &Memory) -> Result<()> {
        match &mut self.kind {
            Kind::Difference(difference) => {
                memory.fill("acceleration", &mut difference.acceleration)?;
                [difference.before] = memory.array("before")?;
                memory.fill("third", &mut difference.third)?;
                difference.third_before = memory.option("third_before")?;
                Ok(())
            }
            Kind::Element { stepper, .. } => stepper.restore(memory),
        }
    }
}

impl Difference {
    fn new(n: usize) -> Self {
        let zero = vec![0.0; n];
        Difference {
            acceleration: zero.clone(),
            before: 0.0,
            third: zero.clone(),
            third_before: None,
            new_acceleration: zero.clone(),
            new_third: zero,
        }
    }

    fn estimate(
        &mut self,
        start: &State,
        end: &State,
        h: f64,
        displacement: &mut [f64],
        velocity: &mut [f64],
    ) {
        // The mean acceleration is that of the middle of the step.
        let distance = self.before + 0.5 * h;
        let factor = h * h * h / 12.0;
        for dof in 0..start.velocity.len() {
            let acceleration = (end.velocity[dof] - start.velocity[dof]) / h;
            let third = (acceleration - self.acceleration[dof]) / distance;
            self.new_acceleration[dof] = acceleration;
            self.new_third[dof] = third;
            displacement[dof] = factor * third;
            velocity[dof] = match self.third_before {
                Some(before) => factor * (third - self.third[dof]) / (before + 0.5 * (0.5 * h - self.before)),
                None => 0.0,
            };
        }
    }

    fn accept(&mut self, h: f64) {
        std::mem::swap(&mut self.acceleration, &mut self.new_acceleration);
        std::mem::swap(&mut self.third, &mut self.new_third);
        // The third derivative is that half way between the two accelerations.
        self.third_before = Some(h - 0.5 * (0.5 * h - self.before));
        self.before = 0.5 * h;
    }
}

fn set_difference(difference: &mut [f64], first: &[f64], second: &[f64]) {
    let terms = first.iter().zip(second);
    difference.iter_mut().zip(terms).for_each(|(difference, (first, second))| *difference = first - second);
}
