//! The local error of a step: the end of the step less the exact motion from the same start.

use super::Estimator;
use super::defect_correction::DefectCorrection;
use super::reconstruction::Reconstruction;
use super::sampling::Sampling;
use crate::body::{Body, ConstrainedVelocity};
use crate::error::Result;
use crate::input::SAME_TIME;
use crate::newton::NewtonSettings;
use crate::time::classic::{Forces, Start};
use crate::time::{AveragingRule, Memory, State, Stepper, TimeElement, TimeElementStepper};

/// Estimates the error of each step of a time element, in positions and velocities at its end.
///
/// *By differences*, for degree 1. All elements of degree 1 end with `u_2 = u_1 + h (v_1 + v_2)/2`: the trapezoidal
/// rule, whose error is
///
/// ```math
/// du = h^3/12 u''',    u''' ~ 2 (a_n - a_(n-1)) / (h_n + h_(n-1)),    a_n = (v_(n+1) - v_n) / h_n
/// ```
///
/// with mean accelerations, which belong to the middles of the steps (Zienkiewicz and Xie 1991, A simple error
/// estimator and adaptive time stepping procedure for dynamic analysis, Earthquake Engineering and Structural Dynamics
/// 20, for accelerations at the ends). The error of the velocity has one more derivative. The estimate costs nothing.
/// Modes that the step does not resolve alternate from step to step, `|a_n - a_(n-1)| <= 4 |v|/h`, and contribute at
/// most `h |v|/3`.
///
/// *By an element of degree k + 1* from the same state: the difference of the two ends. The element has the error `c
/// h^(2k+1)`, the higher one `c h^(2k+3)`, so that the estimate is exact in the limit. It costs a step of the higher
/// element, which starts from the reconstruction described next.
///
/// *By the residual*. The velocity v^h of the step, of degree k, and its integral `u~ = u_1 + h integral v^h` have the
/// nodal values of the step, so that their errors at its end, `d = u~ - u` and `w = v^h - v`, are the wanted ones. With
/// the strong residual r of the momentum equation they satisfy
///
/// ```math
/// M r = M v^h'/h + f(u~) - F,    d' = h w,    w' = h (r - M^-1 K d) + ..,    d(0) = w(0) = 0
/// ```
///
/// up to squares of d, so `(d, w)(1) = h integral Phi(1, alpha) (0, r) dalpha` with the propagator Phi of the
/// linearised motion. The component of r along the Legendre polynomial P_j has the order h^(2k-j) for j <= k, for a
/// method of order 2k; the component of Phi has the order h^j. So all j <= k contribute equally: for k = 1 `w(1) = h
/// integral r` and `d(1) = h^2 integral (1 - alpha) r` are the leading terms, for k > 1 powers of `h^2 K` up to degree
/// k are needed as well, and no quadrature of r alone is the error. The equations are solved with the Gauss method of
/// degree k + 1,
///
/// ```math
/// sum_j (a^-1)_ij M dx_j + h^2 a_ij K dx_j = -h^2 M r(c_i),    d(1) = -sum_j b_j dx_j
/// ```
///
/// whose right-hand side is its own stage residual at the rates of u~. It is exact to order h^(2k+3): a defect
/// correction (Zadunaisky 1976, On the estimation of errors propagated in the numerical integration of ordinary
/// differential equations, Numerische Mathematik 27; Frank and Ueberhuber 1977, Iterated defect correction for
/// differential equations, BIT 17). Inside the step the error of v^h has the order h^(k+1), and a correction with one
/// reused K leaves a part of order h^2. So `floor(k/2) + 1` corrections leave less than h^(2k+1), and the estimate is
/// exact in the limit. They cost as many evaluations of f at k + 1 points, and one more to check their result; if K is
/// inaccurate, more corrections follow.
///
/// *Sampled*: by the residual in the first two steps, and then in fewer steps while the extrapolation holds. Between
/// two samples, the error is the last one times powers of the changes of the step size and of the (k + 1)-th derivative
/// (`Sampling`).
///
/// On `u'' = -omega^2 u`, z = h omega, the Gauss method of degree 2 has the errors `-z^5/720 v/omega` in u and `z^5/720
/// omega u` in v. The quadrature `h^2 integral (1 - alpha) r` gives the first one, but `h integral r` gives 0.
#[derive(Debug)]
pub struct LocalError<'a> {
    body: &'a Body,
    kind: Kind<'a>,
    /// Error of the positions at the end of the last step, `[n_nodes][3]`.
    displacement: Vec<f64>,
    /// Error of the velocities.
    velocity: Vec<f64>,
    /// Of a mechanism, what constraints allow of velocities: the rest carries an error of low order that never reaches
    /// the positions.
    allowed: Option<ConstrainedVelocity>,
}

#[derive(Debug)]
enum Kind<'a> {
    Difference(Box<Difference>),
    Element(Box<NextDegree<'a>>),
    Sampled(Box<NextDegree<'a>>, Box<Sampling>),
}

/// The element of degree k + 1 of the estimate.
#[derive(Debug)]
struct NextDegree<'a> {
    stepper: TimeElementStepper<'a>,
    reconstruction: Reconstruction,
    /// Approximate solver for its equations: corrections, and their minimum number.
    correction: Option<(DefectCorrection, usize)>,
    end: State,
}

/// Memory of the differences.
#[derive(Debug)]
struct Difference {
    /// An earlier acceleration, and its time before the start of the step.
    acceleration: Vec<f64>,
    before: f64,
    /// An earlier third derivative of the displacement, and its time before the start of the step.
    third: Vec<f64>,
    third_before: Option<f64>,
    /// Their new values after the step is accepted.
    new_acceleration: Vec<f64>,
    new_third: Vec<f64>,
}

impl<'a> LocalError<'a> {
    /// The estimator for steps of a time element from a state.
    ///
    /// # Errors
    /// [`crate::Error::Scheme`] if there is no such element, [`crate::Error::Adaptivity`] if the estimator does not fit
    /// the degree; [`crate::Error::Constrained`], [`crate::Error::Inverted`], [`crate::Error::Linear`].
    pub fn new(
        body: &'a Body,
        element: TimeElement,
        estimator: Estimator,
        settings: NewtonSettings,
        state: &State,
    ) -> Result<Self> {
        estimator.check(element)?;
        if estimator != Estimator::Element {
            body.check_unconstrained("this estimate of the error")?;
        }
        let n = body.n_dofs();
        let next = || NextDegree::new(body, element, estimator, settings, state).map(Box::new);
        let kind = match estimator {
            Estimator::Difference => Kind::Difference(Box::new(Difference::new(n))),
            Estimator::Element | Estimator::Residual => Kind::Element(next()?),
            Estimator::Sampled => {
                let sampling = Sampling::new(element.degree, LocalError::order(element), n);
                Kind::Sampled(next()?, Box::new(sampling))
            }
        };
        let (displacement, velocity) = (vec![0.0; n], vec![0.0; n]);
        let allowed = if body.mechanism.is_empty() { None } else { Some(ConstrainedVelocity::new(body)?) };
        let mut estimator = LocalError { body, kind, displacement, velocity, allowed };
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

    /// Power of the step size in the error: one more than the order of the scheme.
    pub fn order(element: TimeElement) -> usize {
        element.order() + 1
    }

    /// Starts again from a state, after a jump of a load.
    ///
    /// # Errors
    /// [`crate::Error::Inverted`], [`crate::Error::Linear`].
    pub fn restart(&mut self, state: &State) -> Result<()> {
        match &mut self.kind {
            Kind::Difference(difference) => {
                difference.acceleration = LocalError::acceleration(self.body, state)?;
                (difference.before, difference.third_before) = (0.0, None);
            }
            Kind::Element(_) => {}
            Kind::Sampled(_, sampling) => sampling.restart(),
        }
        Ok(())
    }

    /// Estimates the error of a step between two states with the rates of [`Stepper::rates`].
    ///
    /// # Errors
    /// As [`Stepper::advance`]: the element of degree k + 1 may fail where the element of degree k did not.
    pub fn estimate(&mut self, start: &State, end: &State, rates: &[f64], step_size: f64) -> Result<()> {
        match &mut self.kind {
            Kind::Difference(difference) => {
                difference.estimate(start, end, step_size, &mut self.displacement, &mut self.velocity);
                self.clear_fixed();
            }
            Kind::Element(_) => self.solve(start, end, rates, step_size)?,
            Kind::Sampled(_, sampling) => {
                sampling.observe(self.body, rates, step_size);
                if !sampling.extrapolate(step_size, &mut self.displacement, &mut self.velocity) {
                    self.solve(start, end, rates, step_size)?;
                }
            }
        }
        Ok(())
    }

    /// Whether the error of the last step was extrapolated from an earlier one ([`Estimator::Sampled`]).
    pub fn is_extrapolated(&self) -> bool {
        matches!(&self.kind, Kind::Sampled(_, sampling) if sampling.is_extrapolated())
    }

    /// Estimates the last estimated step by its own residual, if its error was extrapolated; returns whether it was.
    ///
    /// # Errors
    /// As [`LocalError::estimate`].
    pub fn confirm(&mut self, start: &State, end: &State, rates: &[f64], step_size: f64) -> Result<bool> {
        let is_extrapolated = self.is_extrapolated();
        if is_extrapolated {
            self.solve(start, end, rates, step_size)?;
        }
        Ok(is_extrapolated)
    }

    /// Sets the errors to the difference from the end of the element of degree k + 1.
    fn solve(&mut self, start: &State, end: &State, rates: &[f64], step_size: f64) -> Result<()> {
        if let Kind::Element(next) | Kind::Sampled(next, _) = &mut self.kind {
            next.advance(start, rates, step_size)?;
            set_difference(&mut self.displacement, &end.displacement, &next.end.displacement);
            if let Some(allowed) = &mut self.allowed {
                let time = [start.time + step_size, -SAME_TIME * step_size];
                self.velocity.copy_from_slice(&end.velocity);
                allowed.project(self.body, time, &end.displacement, &mut self.velocity)?;
                let State { displacement, velocity, .. } = &mut next.end;
                allowed.project(self.body, time, displacement, velocity)?;
                self.velocity.iter_mut().zip(&*velocity).for_each(|(v, better)| *v -= better);
            } else {
                set_difference(&mut self.velocity, &end.velocity, &next.end.velocity);
            }
        }
        self.clear_fixed();
        if let Kind::Sampled(_, sampling) = &mut self.kind {
            sampling.resample(self.body, step_size, &self.displacement, &self.velocity);
        }
        Ok(())
    }

    /// Fixed degrees of freedom have no error.
    fn clear_fixed(&mut self) {
        for (dof, _) in self.body.fixed().iter().enumerate().filter(|(_, fixed)| **fixed) {
            (self.displacement[dof], self.velocity[dof]) = (0.0, 0.0);
        }
        self.body.space.follow(&mut self.displacement);
        self.body.space.follow(&mut self.velocity);
    }

    /// Advances to the next step.
    pub fn accept(&mut self, step_size: f64) {
        match &mut self.kind {
            Kind::Difference(difference) => difference.accept(step_size),
            Kind::Element(_) => {}
            Kind::Sampled(_, sampling) => sampling.accept(step_size),
        }
    }

    /// Error of the positions at the end of the last estimated step, `[n_nodes][3]` \[length\].
    pub fn displacement(&self) -> &[f64] {
        &self.displacement
    }

    /// Error of the velocities \[length/time\].
    pub fn velocity(&self) -> &[f64] {
        &self.velocity
    }

    /// Memory that later estimates depend on.
    pub fn memory(&self) -> Memory {
        match &self.kind {
            Kind::Difference(difference) => {
                let mut memory = Memory::default();
                memory.save_nodal("acceleration", &difference.acceleration);
                memory.save_number("before", difference.before);
                memory.save_nodal("third", &difference.third);
                memory.save_option("third_before", difference.third_before);
                memory
            }
            Kind::Element(next) => next.memory(),
            Kind::Sampled(next, sampling) => {
                let mut memory = next.memory();
                sampling.save(&mut memory);
                memory
            }
        }
    }

    /// Restores the memory of another estimator of the same kind.
    ///
    /// # Errors
    /// [`crate::Error::Memory`], and as [`Stepper::restore`].
    pub fn restore(&mut self, memory: &Memory) -> Result<()> {
        match &mut self.kind {
            Kind::Difference(difference) => {
                memory.fill("acceleration", &mut difference.acceleration)?;
                difference.before = memory.number("before")?;
                memory.fill("third", &mut difference.third)?;
                difference.third_before = memory.option("third_before")?;
                Ok(())
            }
            Kind::Element(next) => next.restore(memory),
            Kind::Sampled(next, sampling) => {
                sampling.restore(memory)?;
                next.restore(memory)
            }
        }
    }
}

impl<'a> NextDegree<'a> {
    fn new(
        body: &'a Body,
        element: TimeElement,
        estimator: Estimator,
        settings: NewtonSettings,
        state: &State,
    ) -> Result<Self> {
        element.check()?;
        let degree = element.degree;
        // At the Gauss points the stage residual of FE(k + 1) is the strong residual.
        let (next, correction) = match estimator {
            Estimator::Element => (element.conserving().at_degree(degree + 1)?, None),
            Estimator::Difference | Estimator::Residual | Estimator::Sampled => {
                let next = TimeElement::new(AveragingRule::Standard(degree + 1), degree + 1)?;
                (next, Some((DefectCorrection::default(), degree / 2 + 1)))
            }
        };
        Ok(NextDegree {
            stepper: TimeElementStepper::new(body, next, settings)?,
            reconstruction: Reconstruction::new(degree, body.n_dofs()),
            correction,
            end: state.clone(),
        })
    }

    /// Sets the end of a step from a state.
    fn advance(&mut self, start: &State, rates: &[f64], step_size: f64) -> Result<()> {
        self.end.copy_from(start);
        self.reconstruction.set(&start.velocity, rates, step_size);
        let given = &self.reconstruction.rates;
        if let Some((correction, least)) = &mut self.correction
            && self.stepper.correct_from(&mut self.end, step_size, given, |system, rates| {
                correction.solve(system, rates, *least)
            })?
        {
            return Ok(());
        }
        self.stepper.advance_from(&mut self.end, step_size, Some(given)).map(|_| ())
    }

    fn memory(&self) -> Memory {
        let mut memory = self.stepper.memory();
        if let Some((correction, _)) = &self.correction {
            correction.save(&mut memory);
        }
        memory
    }

    fn restore(&mut self, memory: &Memory) -> Result<()> {
        if let Some((correction, _)) = &mut self.correction {
            correction.restore(memory)?;
        }
        self.stepper.restore(memory)
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
        // The mean acceleration is the acceleration in the middle of the step.
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
        // The third derivative belongs half way between the two accelerations.
        self.third_before = Some(h - 0.5 * (0.5 * h - self.before));
        self.before = 0.5 * h;
    }
}

fn set_difference(difference: &mut [f64], first: &[f64], second: &[f64]) {
    let terms = first.iter().zip(second);
    difference.iter_mut().zip(terms).for_each(|(difference, (first, second))| *difference = first - second);
}
