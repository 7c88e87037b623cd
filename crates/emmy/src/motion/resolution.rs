//! Whether steps resolve the smooth functions of time that act on a body.

use std::fmt;
use std::sync::Arc;

use super::StepPlan;
use crate::average::Rule;
use crate::body::Body;
use crate::force::{MAX_COMPONENTS, Signal};
use crate::input::SignalTarget;
use crate::number::short;
use crate::polynomial::lagrange;
use crate::quadrature::{Quadrature, gauss, lobatto};
use crate::time::{MAX_DEGREE, Scheme};

/// A function of time that a step does not resolve.
#[derive(Debug, Clone, PartialEq)]
pub struct Unresolved {
    /// The load or support of the function.
    pub target: SignalTarget,
    /// Its text; empty for a field without one.
    pub text: Arc<str>,
    /// A time near which the step misses part of it.
    pub time: f64,
}

impl fmt::Display for Unresolved {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} near t = {}", self.target.with_text(&self.text), short(self.time))
    }
}

/// Compares the values of functions of time at the points of a step with a quadrature on many short panels.
///
/// Tables are integrated exactly and need no check. A function counts as resolved by panels of 1/16384 of the plan;
/// shorter features may be missed. A costly function ([`TimeFunction::of_times`](crate::body::TimeFunction::of_times),
/// [`Field::of_points`](crate::body::Field::of_points)) is compared on a few panels a step only. No element is
/// evaluated.
///
/// ```
/// use emmy::prelude::*;
/// use emmy::internals::motion::Resolution;
/// let pulse = TimeFunction::smooth("exp(-((t - 5)/0.01)^2)", |t| [(-((t - 5.0) / 0.01f64).powi(2)).exp(), 0.0, 0.0]);
/// let kind = LoadKind::Acceleration { group: None, acceleration: [1.0, 0.0, 0.0] };
/// let region = Region::new(NeoHooke::new(1000.0, 500.0)?, 1.0);
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(region).load(Load { kind, time_function: pulse }).build()?;
/// let plan = StepPlan::new(0.0, vec![Phase { until: 10.0, size: 2.0 }])?;
/// let resolution = Resolution::new(&body, TimeElement::discrete_gradient(1)?, &plan).unwrap();
/// let missed = resolution.unresolved(4.0, 2.0).unwrap();
/// assert!((missed.time - 5.0).abs() < 0.01 && resolution.unresolved(6.0, 2.0).is_none());
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug)]
pub struct Resolution {
    /// The functions, each with the largest sizes of its components in the plan.
    signals: Vec<(Signal, [f64; MAX_COMPONENTS])>,
    scheme: Scheme,
    rule: Rule,
    /// Points of a step at which the stepper evaluates loads.
    points: Quadrature<1>,
    /// Nodes of the polynomial of a given motion.
    nodes: Quadrature<1>,
    /// Longest panel of the comparison \[time\].
    panel: f64,
}

/// Tolerance for a function in a step. Features smaller than this part of the function's largest size may be missed.
#[derive(Debug, Clone, Copy)]
enum Allowance {
    /// Averages, over the mean size of the function in the step.
    Part(f64),
    /// Averages of loads as before; displacements of supports relative to a length.
    PartOrLength(f64, f64),
}

/// A function of time and its approximation in a step.
#[derive(Debug, Clone, Copy, Default)]
struct Comparison {
    /// Largest difference of the stage averages.
    defect: f64,
    /// Mean size of the function in the step.
    mean: f64,
    /// Its largest size there.
    peak: f64,
}

/// Panels of a plan, shared by all functions, and the minimum for each function.
const PANELS: usize = 1 << 14;
const MIN_PANELS: usize = 1 << 8;

/// Sampling times per panel for the largest size of a function.
const SAMPLES: usize = 4;

/// Tolerance for the average of a function over a planned step, relative to its mean size.
const PLANNED: f64 = 1e-2;

/// The same for steppers that evaluate loads at the ends of a step, which are of order two.
const PLANNED_AT_ENDS: f64 = 5e-2;

/// Range of the tolerance for adaptive steps, which is otherwise their own tolerance.
const TIGHTEST: f64 = 1e-8;
const LOOSEST: f64 = 1e-3;

/// Number of steps of a plan checked before a run.
const MAX_STEPS: usize = 100_000;

impl Resolution {
    /// The check of a plan; `None` if no smooth function of time acts on the body.
    pub fn new(body: &Body, scheme: impl Into<Scheme>, plan: &StepPlan) -> Option<Self> {
        let scheme = scheme.into();
        let signals = body.signals();
        if signals.is_empty() {
            return None;
        }
        let start = plan.start();
        let duration = plan.end() - plan.start();
        let n_functions: usize = signals.iter().map(|signal| signal.n_components).sum();
        let panels = (PANELS / n_functions).max(MIN_PANELS);
        let largest = |signal: &Signal| {
            let n_samples = if signal.is_costly { COSTLY_SAMPLES } else { SAMPLES * panels };
            // Between the ends of panels: a pole at a round number, where times are rounded, would be 1e16 times larger
            // than its surroundings.
            let times = (0..n_samples).map(|i| start + duration * (i as f64 + 0.5) / n_samples as f64);
            let mut largest = [0f64; MAX_COMPONENTS];
            for_each_value(signal, times, |values| {
                largest
                    .iter_mut()
                    .zip(values)
                    .for_each(|(largest, value)| *largest = largest.max(value.abs()));
            });
            largest
        };
        let signals = signals.into_iter().map(|signal| (largest(&signal), signal));
        let (rule, points) = rule_and_points(scheme, scheme.degree());
        Some(Resolution {
            signals: signals.map(|(largest, signal)| (signal, largest)).collect(),
            scheme,
            nodes: lobatto(rule.degree() + 2),
            rule,
            points,
            panel: duration / panels as f64,
        })
    }

    /// The first function that a planned step does not resolve.
    pub fn unresolved(&self, time: f64, size: f64) -> Option<Unresolved> {
        let part = if self.scheme.is_time_element() { PLANNED } else { PLANNED_AT_ENDS };
        self.missed(time, size, Allowance::Part(part))
    }

    /// The number of steps of a plan that do not resolve a function, and the first miss. Of a long plan only the
    /// beginning is checked; adaptive plans have no planned steps.
    pub fn unresolved_steps(&self, plan: &StepPlan) -> (usize, Option<Unresolved>) {
        if plan.adaptivity().is_some() {
            return (0, None);
        }
        let mut missed =
            plan.steps().take(MAX_STEPS).filter_map(|step| self.unresolved(step.start, step.size));
        let first = missed.next();
        (usize::from(first.is_some()) + missed.count(), first)
    }

    /// Changes the degree of the elements.
    pub(super) fn set_degree(&mut self, degree: usize) {
        if self.rule.degree() != degree {
            (self.rule, self.points) = rule_and_points(self.scheme, degree);
            self.nodes = lobatto(degree + 2);
        }
    }

    /// The largest size, `size` over a power of two, that resolves everything to a tolerance, but at least about a
    /// panel. `length`: scale of displacements.
    pub(super) fn resolved_size(&self, time: f64, size: f64, tolerance: f64, length: f64) -> f64 {
        let mut size = size;
        while size > self.panel && self.missed_within(time, size, tolerance, length).is_some() {
            size *= 0.5;
        }
        size
    }

    /// The first function that an adaptive step does not resolve.
    pub(super) fn missed_within(
        &self,
        time: f64,
        size: f64,
        tolerance: f64,
        length: f64,
    ) -> Option<Unresolved> {
        let part = tolerance.clamp(TIGHTEST, LOOSEST);
        self.missed(time, size, Allowance::PartOrLength(part, tolerance * length))
    }

    fn missed(&self, time: f64, size: f64, allowance: Allowance) -> Option<Unresolved> {
        let acting = self.signals.iter().filter(|(signal, _)| signal.until.is_none_or(|until| time < until));
        for (signal, largest) in acting {
            let first = signal.kinks.partition_point(|&kink| kink <= time);
            let kinks = signal.kinks[first..].iter().copied().take_while(|&kink| kink < time + size);
            let mut from = time;
            for to in kinks.chain([time + size]) {
                let size = to - from;
                if let Some(component) = self.missed_component(signal, largest, from, size, allowance) {
                    let time = self.place(signal, component, from, size);
                    return Some(Unresolved { target: signal.target, text: signal.text.clone(), time });
                }
                from = to;
            }
        }
        None
    }

    /// The first component of a function that is not resolved between two kinks in a step.
    fn missed_component(
        &self,
        signal: &Signal,
        largest: &[f64],
        time: f64,
        size: f64,
        allowance: Allowance,
    ) -> Option<usize> {
        match allowance {
            Allowance::PartOrLength(_, length) if signal.arm > 0.0 => {
                (signal.arm * self.deviation(signal, time, size) > length).then_some(0)
            }
            Allowance::Part(part) | Allowance::PartOrLength(part, _) => {
                let seen = self.compare(signal, time, size);
                let mut components = seen[..signal.n_components].iter().zip(largest);
                components
                    .position(|(seen, largest)| seen.peak > part * largest && seen.defect > part * seen.mean)
            }
        }
    }

    /// Points and weights of the panels of a step for a function, relative to the step.
    fn panel_points(&self, signal: &Signal, size: f64) -> impl Iterator<Item = (f64, f64)> + '_ {
        let most = if signal.is_costly { COSTLY_PANELS } else { usize::MAX };
        let n = ((size / self.panel).ceil() as usize).clamp(2, most);
        let of_panel = move |panel: usize| {
            self.points.iter().map(move |(&[s], w)| ((panel as f64 + s) / n as f64, w / n as f64))
        };
        (0..n).flat_map(of_panel)
    }

    /// Visits the points of the panels of a step with their weights and the components of a function.
    fn for_each_point(&self, signal: &Signal, time: f64, size: f64, mut visit: impl FnMut(f64, f64, &[f64])) {
        let mut points = self.panel_points(signal, size);
        let times = self.panel_points(signal, size).map(|(alpha, _)| time + alpha * size);
        for_each_value(signal, times, |values| {
            if let Some((alpha, w)) = points.next() {
                visit(alpha, w, values);
            }
        });
    }

    /// Compares the stage averages from the points of the step with the averages from its panels, for each component.
    fn compare(&self, signal: &Signal, time: f64, size: f64) -> [Comparison; MAX_COMPONENTS] {
        let k = self.rule.degree();
        let mut defects = [[0.0; MAX_DEGREE]; MAX_COMPONENTS];
        let mut seen = [Comparison::default(); MAX_COMPONENTS];
        let mut add = |alpha: f64, w: f64, values: &[f64]| {
            let mut weights = [0.0; MAX_DEGREE];
            for (i, weight) in weights[..k].iter_mut().enumerate() {
                *weight = w * self.rule.basis(i, alpha) / self.rule.weights()[i];
            }
            for (defects, value) in defects.iter_mut().zip(values) {
                defects[..k].iter_mut().zip(weights).for_each(|(defect, weight)| *defect += weight * value);
            }
        };
        let mut points = self.points.iter();
        let times = self.points.points.iter().map(|&[alpha]| time + alpha * size);
        for_each_value(signal, times, |values| {
            if let Some((&[alpha], w)) = points.next() {
                add(alpha, w, values);
            }
        });
        self.for_each_point(signal, time, size, |alpha, w, values| {
            for (seen, value) in seen.iter_mut().zip(values) {
                seen.mean += w * value.abs();
                seen.peak = seen.peak.max(value.abs());
            }
            add(alpha, -w, values);
        });
        for (seen, defects) in seen.iter_mut().zip(&defects) {
            seen.defect = defects[..k].iter().fold(0.0, |largest, defect| defect.abs().max(largest));
        }
        seen
    }

    /// Largest difference between a given motion (one component) and the polynomial of degree k + 1 through its values
    /// in the step. The error estimate sees only this polynomial.
    fn deviation(&self, signal: &Signal, time: f64, size: f64) -> f64 {
        let n = self.nodes.points.len();
        let mut places = [0.0; MAX_DEGREE + 2];
        let mut values = [0.0; MAX_DEGREE + 2];
        let mut times = [0.0; MAX_DEGREE + 2];
        for (i, &[alpha]) in self.nodes.points.iter().enumerate() {
            (places[i], times[i]) = (alpha, time + alpha * size);
        }
        signal.set_at(&times[..n], &mut values[..n]);
        let mut largest = 0f64;
        self.for_each_point(signal, time, size, |alpha, _, components| {
            let sum: f64 = (0..n).map(|i| values[i] * lagrange(&places[..n], i, alpha)).sum();
            largest = largest.max((components[0] - sum).abs());
        });
        largest
    }

    /// The time in a step at which a component is farthest from its mean.
    fn place(&self, signal: &Signal, component: usize, time: f64, size: f64) -> f64 {
        let mut mean = 0.0;
        self.for_each_point(signal, time, size, |_, w, values| mean += w * values[component]);
        let mut place = time;
        let mut farthest = -1.0;
        self.for_each_point(signal, time, size, |alpha, _, values| {
            let distance = (values[component] - mean).abs();
            if distance > farthest {
                (place, farthest) = (time + alpha * size, distance);
            }
        });
        place
    }
}

/// Samples of a costly function over a plan, for its largest size.
const COSTLY_SAMPLES: usize = 512;

/// Panels of a step for a costly function.
const COSTLY_PANELS: usize = 2;

/// Times at which a function is evaluated at once.
const AT_ONCE: usize = 64;

/// Visits the components of a function at some times; the function is called for many times at once.
fn for_each_value(signal: &Signal, mut times: impl Iterator<Item = f64>, mut visit: impl FnMut(&[f64])) {
    let (mut some, mut values) = ([0.0; AT_ONCE], [0.0; AT_ONCE * MAX_COMPONENTS]);
    let n_components = signal.n_components;
    loop {
        let mut n = 0;
        for (own, time) in some.iter_mut().zip(times.by_ref()) {
            *own = time;
            n += 1;
        }
        if n > 0 {
            let values = &mut values[..n * n_components];
            signal.set_at(&some[..n], values);
            values.chunks_exact(n_components).for_each(&mut visit);
        }
        if n < AT_ONCE {
            return;
        }
    }
}

/// The test functions of a scheme, and the points at which it evaluates loads.
fn rule_and_points(scheme: Scheme, degree: usize) -> (Rule, Quadrature<1>) {
    if !scheme.is_time_element() {
        let points = if scheme == Scheme::Bathe { lobatto(3) } else { lobatto(2) };
        return (Rule::discrete_gradient(1), points);
    }
    let rule = Rule::discrete_gradient(degree);
    let points = gauss(rule.smooth_quadrature().points.len());
    (rule, points)
}

#[cfg(test)]
mod tests;
