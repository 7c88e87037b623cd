//! Whether steps resolve the smooth functions of time that act on a body.

use std::fmt;
use std::sync::Arc;

use super::StepPlan;
use crate::average::Rule;
use crate::body::{Body, Signal, SignalTarget};
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

/// Largest length of a text in a message.
const LONGEST: usize = 60;

impl fmt::Display for Unresolved {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.target {
            SignalTarget::Load(number) => write!(f, "load {number}")?,
            SignalTarget::Support(number) => write!(f, "moving support {number}")?,
        }
        if !self.text.is_empty() {
            let text: String = self.text.chars().take(LONGEST).collect();
            let dots = if text.len() < self.text.len() { "..." } else { "" };
            write!(f, " (\"{text}{dots}\")")?;
        }
        write!(f, " near t = {}", short(self.time))
    }
}

/// Compares the values of functions of time at the points of a step with a quadrature on many short panels.
///
/// Tables are integrated exactly and need no check. A function counts as resolved by panels of 1/16384 of the plan;
/// shorter features may be missed. No element is evaluated.
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
    /// The functions, each with its largest size in the plan.
    signals: Vec<(Signal, f64)>,
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
#[derive(Debug, Clone, Copy)]
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
        let panels = (PANELS / signals.len()).max(MIN_PANELS);
        let n_samples = SAMPLES * panels;
        let largest = |signal: &Signal| {
            let times = (0..=n_samples).map(|i| start + duration * i as f64 / n_samples as f64);
            times.map(|time| signal.at(time).abs()).fold(0.0, f64::max)
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
            let is_missed = match allowance {
                Allowance::PartOrLength(_, length) if signal.arm > 0.0 => {
                    signal.arm * self.deviation(signal, time, size) > length
                }
                Allowance::Part(part) | Allowance::PartOrLength(part, _) => {
                    let seen = self.compare(signal, time, size);
                    seen.peak > part * largest && seen.defect > part * seen.mean
                }
            };
            if is_missed {
                let time = self.place(signal, time, size);
                return Some(Unresolved { target: signal.target, text: signal.text.clone(), time });
            }
        }
        None
    }

    /// Visits points and weights of the panels of a step, relative to the step.
    fn for_each_point(&self, size: f64, mut visit: impl FnMut(f64, f64)) {
        let n = ((size / self.panel).ceil() as usize).max(2);
        for panel in 0..n {
            for (&[s], w) in self.points.iter() {
                visit((panel as f64 + s) / n as f64, w / n as f64);
            }
        }
    }

    /// Compares the stage averages from the points of the step with the averages from its panels.
    fn compare(&self, signal: &Signal, time: f64, size: f64) -> Comparison {
        let k = self.rule.degree();
        let mut defects = [0.0; MAX_DEGREE];
        let mut mean = 0.0;
        let mut peak = 0f64;
        let mut add = |alpha: f64, value: f64| {
            for (i, defect) in defects[..k].iter_mut().enumerate() {
                *defect += value * self.rule.basis(i, alpha) / self.rule.weights()[i];
            }
        };
        self.points.iter().for_each(|(&[alpha], w)| add(alpha, w * signal.at(time + alpha * size)));
        self.for_each_point(size, |alpha, w| {
            let value = signal.at(time + alpha * size);
            mean += w * value.abs();
            peak = peak.max(value.abs());
            add(alpha, -w * value);
        });
        let defect = defects[..k].iter().fold(0.0, |largest, defect| defect.abs().max(largest));
        Comparison { defect, mean, peak }
    }

    /// Largest difference between the function and the polynomial of degree k + 1 through its values in the step: the
    /// error estimate sees only this polynomial of a given motion.
    fn deviation(&self, signal: &Signal, time: f64, size: f64) -> f64 {
        let n = self.nodes.points.len();
        let mut places = [0.0; MAX_DEGREE + 2];
        let mut values = [0.0; MAX_DEGREE + 2];
        for (i, &[alpha]) in self.nodes.points.iter().enumerate() {
            (places[i], values[i]) = (alpha, signal.at(time + alpha * size));
        }
        let mut largest = 0f64;
        self.for_each_point(size, |alpha, _| {
            let sum: f64 = (0..n).map(|i| values[i] * lagrange(&places[..n], i, alpha)).sum();
            largest = largest.max((signal.at(time + alpha * size) - sum).abs());
        });
        largest
    }

    /// The time in a step at which a function is farthest from its mean.
    fn place(&self, signal: &Signal, time: f64, size: f64) -> f64 {
        let mut mean = 0.0;
        self.for_each_point(size, |alpha, w| mean += w * signal.at(time + alpha * size));
        let mut place = time;
        let mut farthest = -1.0;
        self.for_each_point(size, |alpha, _| {
            let here = time + alpha * size;
            let distance = (signal.at(here) - mean).abs();
            if distance > farthest {
                (place, farthest) = (here, distance);
            }
        });
        place
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
mod tests {
    use super::*;
    use crate::body::{Load, LoadKind, Region, Support, TimeFunction};
    use crate::material::NeoHooke;
    use crate::mesh;
    use crate::motion::Phase;
    use crate::time::{AveragingRule, TimeElement};

    const DGM: TimeElement =
        TimeElement { rule: AveragingRule::DiscreteGradient, degree: 1, spectral_radius: None };

    fn body(time_function: TimeFunction, moves: Option<TimeFunction>) -> Body {
        let rubber = NeoHooke::new(1000.0, 500.0).unwrap();
        let mesh = mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap();
        let load = Load {
            kind: LoadKind::Acceleration { group: None, acceleration: [1.0, 0.0, 0.0] },
            time_function,
        };
        let driven = moves.map(|time_function| Support {
            group: "y-min".to_string(),
            displacement: [Some(time_function), None, None],
            ..Default::default()
        });
        Body::builder(mesh)
            .region(Region::new(rubber, 1.0))
            .supports(driven.as_slice())
            .load(load)
            .build()
            .unwrap()
    }

    fn pulse(at: f64, width: f64) -> TimeFunction {
        TimeFunction::smooth(&format!("pulse {at} {width}"), move |t| {
            [(-((t - at) / width).powi(2)).exp(), 0.0, 0.0]
        })
    }

    fn resolution(body: &Body, scheme: impl Into<Scheme>) -> Resolution {
        let plan = StepPlan::new(0.0, vec![Phase { until: 10.0, size: 0.5 }]).unwrap();
        Resolution::new(body, scheme, &plan).unwrap()
    }

    #[test]
    fn tables_need_no_check() {
        let plan = StepPlan::new(0.0, vec![Phase { until: 10.0, size: 0.5 }]).unwrap();
        let body = body(TimeFunction::new(vec![(4.99, 0.0), (5.0, 1.0), (5.01, 0.0)]).unwrap(), None);
        assert!(Resolution::new(&body, DGM, &plan).is_none());
    }

    #[test]
    fn a_short_pulse_is_seen_by_every_scheme_and_degree() {
        let body = body(pulse(5.13, 0.01), None);
        let third = TimeElement { degree: 3, ..DGM };
        for scheme in [DGM.into(), third.into(), Scheme::Bathe, Scheme::CentralDifferences] {
            let resolution = resolution(&body, scheme);
            let missed = resolution.unresolved(5.0, 0.5).unwrap();
            assert!((missed.time - 5.13).abs() < 0.01 && missed.target == SignalTarget::Load(0));
            assert_eq!(resolution.unresolved(5.5, 0.5), None);
            assert_eq!(resolution.unresolved(5.13, 0.001), None);
        }
    }

    #[test]
    fn a_pulse_shows_its_load_and_its_place() {
        let plan = StepPlan::new(0.0, vec![Phase { until: 10.0, size: 0.5 }]).unwrap();
        let (count, first) =
            resolution(&body(pulse(5.13, 0.01), None), TimeElement::MID_POINT).unresolved_steps(&plan);
        assert_eq!(count, 1);
        let text = first.unwrap().to_string();
        assert!(text.starts_with("load 0 (\"pulse 5.13 0.01\") near t = 5.1"), "{text}");
    }

    #[test]
    fn a_resolved_oscillation_is_none_that_is_missed() {
        let omega = 2.0 * std::f64::consts::PI;
        let sine = TimeFunction::smooth("sine", move |t| [(omega * t).sin(), 0.0, 0.0]);
        for scheme in [DGM.into(), Scheme::CentralDifferences] {
            let resolution = resolution(&body(sine.clone(), Some(sine.clone())), scheme);
            for step in 0..20 {
                assert_eq!(resolution.unresolved(0.05 * step as f64, 0.05), None, "{scheme} {step}");
            }
        }
    }

    #[test]
    fn adaptive_steps_shrink_until_they_resolve_loads_and_given_motions() {
        let at_rest = TimeFunction::smooth("zero", |_| [0.0; 3]);
        for (body, degree) in [
            (body(pulse(5.0, 0.01), None), 1),
            (body(at_rest.clone(), Some(pulse(5.0, 0.01))), 1),
            (body(at_rest, Some(pulse(5.0, 0.01))), 3),
        ] {
            let resolution = resolution(&body, TimeElement { degree, ..DGM });
            let size = resolution.resolved_size(4.0, 6.0, 1e-4, 1.0);
            assert!((0.4..1.0).contains(&size), "{size}");
            let size = resolution.resolved_size(4.99, 5.0, 1e-4, 1.0);
            assert!((1e-4..0.03).contains(&size), "{size}");
            assert_eq!(resolution.resolved_size(6.0, 4.0, 1e-4, 1.0), 4.0);
        }
    }
}
