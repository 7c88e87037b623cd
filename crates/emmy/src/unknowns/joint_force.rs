//! Springs, dampers and motors in the coordinate of a joint.
//!
//! In the scalar coordinate x they are what DGM is in the positions, so the energy of the spring balances at every step
//! size (g = dx/dq at q_i, `x'_i = g . x_i`):
//!
//! ```math
//! f_i = (V'(x_i) + (r + c/h) x'_i) g,    r = (V_2 - V_1 - sum_j b_j V'(x_j) x'_j) / sum_j b_j x'_j^2
//! ```

use std::sync::Arc;

use super::joint::{MAX_DOFS, Measure};
use crate::average::{Request, Rule};
use crate::error::{Error, Result};
use crate::force::{Book, Force, ForceMemory, Scratch, Side, StepInput, StepStart, StrainState};
use crate::input::{Joint, JointSpring, NotFinite, SignalTarget, Span, TimeFunction};
use crate::nodal;
use crate::sparse::{Pattern, RowPart};

/// A spring, a damper and a motor in the coordinate of a joint.
#[derive(Debug)]
pub(crate) struct JointLaw {
    number: usize,
    measure: Measure,
    /// Nodes, ascending.
    nodes: Vec<u32>,
    spring: JointSpring,
    rest: f64,
    damping: f64,
    motor: Option<TimeFunction>,
}

/// The coordinate in a stage.
#[derive(Debug, Clone, Copy)]
struct Stage {
    value: f64,
    rate: f64,
}

impl JointLaw {
    /// The law of a joint with a number, if it has one.
    ///
    /// # Errors
    /// [`Error::Joint`].
    pub(crate) fn new(joint: &Joint, number: usize, measure: Option<&Measure>) -> Result<Option<Self>> {
        let fault = |reason: String| Err(Error::Joint { joint: joint.name.clone(), reason });
        if !joint.has_force() {
            return Ok(None);
        }
        if joint.drive.is_some() {
            return fault("a given motion leaves a spring, a damping or a motor nothing to do".to_string());
        }
        let Some(measure) = measure else {
            let word = joint.kind.word();
            return fault(format!(
                "a {word} joint has no angle, slide or distance for a spring, damping or motor"
            ));
        };
        let mut nodes: Vec<u32> = measure.nodes().collect();
        nodes.sort_unstable();
        nodes.dedup();
        if nodes.len() > MAX_DOFS / 3 {
            return fault("its spring, damping or motor acts on too many nodes".to_string());
        }
        let spring = joint.spring.unwrap_or(JointSpring { stiffness: 0.0, rest: None });
        let is_valid = |number: f64| number >= 0.0 && number.is_finite();
        if !(is_valid(spring.stiffness) && is_valid(joint.damping) && spring.rest.is_none_or(f64::is_finite))
        {
            return fault("stiffness and damping must be at least 0, and the rest a number".to_string());
        }
        Ok(Some(JointLaw {
            number,
            nodes,
            spring,
            rest: spring.rest.unwrap_or(measure.value(&|_| 0.0)),
            damping: joint.damping,
            motor: joint.motor.clone(),
            measure: measure.clone(),
        }))
    }

    /// Its nodes, ascending.
    pub(crate) fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// Whether it has a spring or a damper.
    pub(crate) fn has_stored_force(&self) -> bool {
        self.has_spring() || self.damping > 0.0
    }

    /// Whether it has a spring.
    pub(crate) fn has_spring(&self) -> bool {
        self.spring.stiffness > 0.0
    }

    /// Whether its spring is strained where the joint is drawn.
    pub(crate) fn is_strained(&self) -> bool {
        self.rest != self.measure.value(&|_| 0.0)
    }

    /// Its coordinate.
    pub(crate) fn measure(&self) -> &Measure {
        &self.measure
    }

    /// The torques or forces on the first body in the stages of a solved step: of spring, damping and motor.
    pub(crate) fn forces(&self, step: &StepInput<'_>, span: Span) -> Vec<f64> {
        let mut forces = vec![0.0; step.rule.degree()];
        let damping = self.total_damping(step);
        // A step that the motor refuses is not solved.
        if self.set_motor(step.rule, span, &mut forces).is_err() {
            forces.fill(f64::NAN);
        }
        forces.iter_mut().enumerate().for_each(|(i, force)| *force -= self.stored_force(step, i, damping));
        forces
    }

    /// Sets the stage averages of the motor, of an equilibrium its value at the end; zeros without one.
    fn set_motor(&self, rule: &Rule, span: Span, averages: &mut [f64]) -> Result<()> {
        let Some(motor) = &self.motor else { return Ok(()) };
        let found = match rule.is_at_end() {
            true => {
                averages.fill(motor.value_before(span.end));
                let is_finite = averages.iter().all(|value| value.is_finite());
                if is_finite { Ok(()) } else { Err(NotFinite { time: span.end, value: averages[0] }) }
            }
            false => motor.averages(span.start, span.size, rule, averages),
        };
        let target = SignalTarget::Joint(self.number);
        found.map_err(|found| target.not_finite(motor.text().unwrap_or_default(), found))
    }

    /// The coordinate at the start of a step.
    fn start(&self, step: &StepInput<'_>) -> f64 {
        let value = self.measure.value(&|dof| step.displacement[dof]);
        self.counted(value, step.coordinates)
    }

    /// A value with the full turns of the coordinates of all joints; without them within half a turn.
    fn counted(&self, value: f64, coordinates: &[f64]) -> f64 {
        coordinates.get(self.number).map_or(value, |&before| self.measure.counted(value, before))
    }

    /// The coordinate in a stage, counted on from the start through the stages before.
    fn value(&self, step: &StepInput<'_>, stage: usize) -> f64 {
        let value = |i: usize| self.measure.value(&|dof| step.displacement_in(i, dof));
        (0..=stage).fold(self.start(step), |before, i| self.measure.counted(value(i), before))
    }

    /// The coordinate and its rate in a stage.
    fn stage(&self, step: &StepInput<'_>, i: usize) -> Stage {
        let (u, x) = (|dof: usize| step.displacement_in(i, dof), &step.rates[i * step.displacement.len()..]);
        let mut rate = 0.0;
        self.measure.for_each_gradient(&u, &mut |dof, value| rate += value * x[dof]);
        Stage { value: self.value(step, i), rate }
    }

    /// `V'(x_i) + d x'_i` with the damping d of [`JointLaw::total_damping`].
    fn stored_force(&self, step: &StepInput<'_>, i: usize, damping: f64) -> f64 {
        let Stage { value, rate } = self.stage(step, i);
        self.spring.stiffness * (value - self.rest) + damping * rate
    }

    fn energy(&self, value: f64) -> f64 {
        0.5 * self.spring.stiffness * (value - self.rest).powi(2)
    }

    /// `r + c/h`.
    fn total_damping(&self, step: &StepInput<'_>) -> f64 {
        self.remainder(step) + self.damping * step.damping.inverse_step_size
    }

    /// r, which closes the balance of the energy; 0 in an equilibrium.
    fn remainder(&self, step: &StepInput<'_>) -> f64 {
        if step.rule.is_at_end() {
            return 0.0;
        }
        let start = self.start(step);
        let (mut work, mut square, mut last) = (0.0, 0.0, start);
        for (i, b) in step.rule.weights().iter().enumerate() {
            let Stage { value, rate } = self.stage(step, i);
            work += b * self.spring.stiffness * (value - self.rest) * rate;
            square += b * rate * rate;
            last = value;
        }
        let end = self.measure.counted(self.measure.value(&|dof| step.displacement_at_end(dof)), last);
        let gap = self.energy(end) - self.energy(start) - work;
        let noise = 4.0 * f64::EPSILON * (start.abs() + end.abs() + self.measure.size());
        let stretch = (start - self.rest).abs() + (end - self.rest).abs() + noise;
        // A coordinate at rest has a gap of rounding over a rate of rounding.
        if gap.abs() > self.spring.stiffness * noise * stretch { gap / square } else { 0.0 }
    }

    fn local(&self, node: u32) -> usize {
        self.nodes.partition_point(|&own| own < node)
    }

    fn gradient(&self, u: &dyn Fn(usize) -> f64) -> [f64; MAX_DOFS] {
        let mut gradient = [0.0; MAX_DOFS];
        self.measure.for_each_gradient(u, &mut |dof, value| {
            gradient[nodal::dof(self.local((dof / 3) as u32), dof % 3)] += value;
        });
        gradient
    }

    /// Degrees of freedom in their order.
    fn dofs(&self) -> impl Iterator<Item = usize> {
        self.nodes.iter().flat_map(|&node| nodal::dofs(node as usize))
    }

    /// Calls a function with the derivatives of a force `t g` in a stage by the rates in all: stage, degrees of freedom
    /// among those of the nodes, and `s^2` times
    ///
    /// ```math
    /// d(t g)/dx_j = g (c a_ij g + d (delta_ij g + a_ij g' x_i)) + t a_ij g',    dt = c dx + d dx'
    /// ```
    fn for_each_derivative(
        &self,
        (step, i): (&StepInput<'_>, usize),
        [t, c, d]: [f64; 3],
        visit: &mut dyn FnMut(usize, [usize; 2], f64),
    ) {
        let n = 3 * self.nodes.len();
        let u = |dof: usize| step.displacement_in(i, dof);
        let x = &step.rates[i * step.displacement.len()..];
        let gradient = self.gradient(&u);
        let mut curvature = [0.0; MAX_DOFS * MAX_DOFS];
        let curvature = &mut curvature[..n * n];
        self.measure.add_curvature(&u, &|node| self.local(node), (curvature, n));
        let mut turning = [0.0; MAX_DOFS];
        for (sum, row) in turning.iter_mut().zip(curvature.chunks_exact(n)) {
            *sum = row.iter().zip(self.dofs()).map(|(entry, dof)| entry * x[dof]).sum();
        }
        for j in 0..step.rule.degree() {
            let a_ij = step.rule.coefficients()[i * step.rule.degree() + j];
            for (own, other) in (0..n * n).map(|at| (at / n, at % n)) {
                let same = if i == j { d * gradient[other] } else { 0.0 };
                let rate = c * a_ij * gradient[other] + same + d * a_ij * turning[other];
                let sum = gradient[own] * rate + t * a_ij * curvature[own * n + other];
                visit(j, [own, other], step.tangent_factor * sum);
            }
        }
    }

    /// Calls a function with the derivatives of the forces of spring and damper in a step, as
    /// [`JointLaw::for_each_derivative`]: both stages, both degrees of freedom of the body, and the number.
    pub(crate) fn for_each_stored_derivative(
        &self,
        step: &StepInput<'_>,
        visit: &mut dyn FnMut([usize; 2], [usize; 2], f64),
    ) {
        let total = self.total_damping(step);
        let dof = |own: usize| nodal::dof(self.nodes[own / 3] as usize, own % 3);
        for i in 0..step.rule.degree() {
            let factors = self.factors(step, self.stored_force(step, i, total));
            self.for_each_derivative((step, i), factors, &mut |j, pair, value| {
                visit([i, j], pair.map(dof), value);
            });
        }
    }

    /// Force t of spring and damper, and its derivatives by the coordinate and its rate.
    fn factors(&self, step: &StepInput<'_>, force: f64) -> [f64; 3] {
        // `r x'` hardly changes, though r is large where the coordinate is nearly at rest.
        [force, self.spring.stiffness, self.damping * step.damping.inverse_step_size]
    }
}

/// A law with its place in the pattern.
#[derive(Debug, Clone)]
struct Coupled {
    law: Arc<JointLaw>,
    /// Position of each pair of nodes in the pattern, `[n][n]`.
    positions: Vec<u32>,
    side: Side,
}

impl Coupled {
    /// Adds the force `factor g` of a stage to the rows of a part.
    fn add_force(&self, (i, factor): (usize, f64), gradient: &[f64; MAX_DOFS], sink: &mut RowPart) {
        for (&node, g) in self.law.nodes.iter().zip(gradient.as_chunks::<3>().0) {
            if sink.owns(node) {
                sink.add_force(i, node, g.map(|g| factor * g));
            }
        }
    }

    /// Adds the derivatives of a force in a stage to the blocks of a part, as
    /// [`JointLaw::for_each_derivative`].
    fn add_derivatives(&self, stage: (&StepInput<'_>, usize), factors: [f64; 3], sink: &mut RowPart) {
        let (k, n) = (stage.0.rule.degree(), self.law.nodes.len());
        self.law.for_each_derivative(stage, factors, &mut |j, [own, other], value| {
            if sink.owns(self.law.nodes[own / 3]) {
                let position = self.positions[own / 3 * n + other / 3] as usize;
                sink.block_mut(position, stage.1 * k + j)[3 * (own % 3) + other % 3] += value;
            }
        });
    }
}

/// The forces of a law, which joins to the ground or not, on a pattern that couples its nodes.
pub(crate) fn forces(law: &Arc<JointLaw>, is_grounded: bool, pattern: &Pattern) -> Vec<Arc<dyn Force>> {
    let pairs = law.nodes.iter().flat_map(|a| law.nodes.iter().map(move |b| (*a as usize, *b as usize)));
    let positions = pairs.map(|(a, b)| pattern.coupling(a, b) as u32).collect();
    let side = if is_grounded { Side::Outside } else { Side::Inside };
    let coupled = Coupled { law: law.clone(), positions, side };
    let mut forces: Vec<Arc<dyn Force>> = Vec::new();
    if law.has_stored_force() {
        forces.push(Arc::new(SpringAndDamper(coupled.clone())));
    }
    if law.motor.is_some() {
        forces.push(Arc::new(Motor(coupled)));
    }
    forces
}

/// Spring and damper of a law.
#[derive(Debug)]
struct SpringAndDamper(Coupled);

impl Force for SpringAndDamper {
    fn book(&self) -> Book {
        Book::Stored
    }

    fn side(&self) -> Side {
        self.0.side
    }

    fn assemble(
        &self,
        (step, request): (&StepInput<'_>, Request),
        _: &ForceMemory,
        _: usize,
        _: &mut Scratch,
        sink: &mut RowPart,
    ) -> Result<()> {
        let Coupled { law, .. } = &self.0;
        let damping = law.total_damping(step);
        for i in 0..step.rule.degree() {
            let gradient = law.gradient(&|dof| step.displacement_in(i, dof));
            let force = law.stored_force(step, i, damping);
            self.0.add_force((i, force), &gradient, sink);
            if request != Request::Stress {
                self.0.add_derivatives((step, i), law.factors(step, force), sink);
            }
        }
        Ok(())
    }

    fn acts_on_joint_nodes(&self) -> bool {
        true
    }

    fn dissipates(&self) -> bool {
        self.0.law.damping > 0.0
    }

    fn dissipated(&self, step: &StepInput<'_>, _: &mut Scratch) -> f64 {
        let stages = step.rule.weights().iter().enumerate();
        let squares = stages.map(|(i, b)| b * self.0.law.stage(step, i).rate.powi(2));
        self.0.law.damping * step.damping.inverse_step_size * squares.sum::<f64>()
    }

    fn strain_state(&self, displacement: &[f64], coordinates: &[f64]) -> StrainState {
        let value = self.0.law.measure.value(&|dof| displacement[dof]);
        let value = self.0.law.counted(value, coordinates);
        StrainState { strain_energy: self.0.law.energy(value), ..StrainState::NONE }
    }

    fn is_symmetric(&self) -> bool {
        self.0.law.damping == 0.0
    }

    fn without_adjoint(&self) -> Option<&'static str> {
        Some("springs and dampers of joints are not covered")
    }
}

/// A force in the coordinate of a joint that is given over time.
#[derive(Debug)]
struct Motor(Coupled);

impl Force for Motor {
    fn book(&self) -> Book {
        Book::Work
    }

    fn side(&self) -> Side {
        self.0.side
    }

    fn memory(&self, rule: &Rule) -> ForceMemory {
        ForceMemory::new(vec![0.0; rule.degree()])
    }

    fn begin(&self, start: &StepStart<'_>, memory: &mut ForceMemory, _: &mut [f64]) -> Result<bool> {
        self.0.law.set_motor(start.rule, start.span, memory.of_mut::<Vec<f64>>())?;
        Ok(true)
    }

    fn assemble(
        &self,
        (step, request): (&StepInput<'_>, Request),
        memory: &ForceMemory,
        _: usize,
        _: &mut Scratch,
        sink: &mut RowPart,
    ) -> Result<()> {
        for (i, &value) in memory.of::<Vec<f64>>().iter().enumerate() {
            let gradient = self.0.law.gradient(&|dof| step.displacement_in(i, dof));
            self.0.add_force((i, value), &gradient, sink);
            if request != Request::Stress {
                self.0.add_derivatives((step, i), [-value, 0.0, 0.0], sink);
            }
        }
        Ok(())
    }

    fn without_adjoint(&self) -> Option<&'static str> {
        Some("motors of joints are not covered")
    }
}
