//! Adaptive step sizes: settings and controller.

use crate::error::{Error, Result};
use crate::motion::StepLimit;
use crate::number::short;
use crate::time::{Estimator, MAX_DEGREE, Memory, TimeElement};

/// Settings of steps whose sizes are chosen by their error.
///
/// The error of a step is a length, in the mean over the mass,
///
/// ```math
/// e = |du|_M / l,    |du|_M^2 = sum_a m_a |du_a|^2 / m
/// ```
///
/// with the error du of the positions at its end, the lumped masses m_a, their sum m and a length l of the body. With a
/// scale of velocities, the larger of e and the same mean for the velocities counts. A step is accepted if e does not
/// exceed the tolerance.
///
/// ```
/// use emmy::motion::Adaptivity;
/// let adaptivity = Adaptivity { largest: 0.1, ..Adaptivity::new(1e-4) };
/// assert!(adaptivity.check().is_ok());
/// assert!(Adaptivity { smallest: 0.2, ..adaptivity }.check().is_err());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Adaptivity {
    /// Largest error of a step that is accepted, relative to the scales.
    pub tolerance: f64,
    /// Smallest step \[time\]; a smaller one is done only to end at a given time.
    pub smallest: f64,
    /// Largest step \[time\].
    pub largest: f64,
    /// Size of the first step; `None`: chosen from velocity and acceleration at the start.
    pub first: Option<f64>,
    /// Scale l of positions \[length\]; `None`: [`crate::body::Body::radius_of_gyration`], of the lumped masses.
    pub length: Option<f64>,
    /// Scale of velocities \[length/time\]; `None`: errors of velocities do not count.
    pub velocity: Option<f64>,
    /// How the error is estimated; `None`: as [`Estimator::of`] says.
    pub estimator: Option<Estimator>,
    /// Lowest and highest degree of the elements, from which the cheapest is chosen; `None`: the degree of the motion.
    pub degrees: Option<[usize; 2]>,
}

impl Adaptivity {
    /// Steps of any size.
    pub fn new(tolerance: f64) -> Self {
        Adaptivity {
            tolerance,
            smallest: 0.0,
            largest: f64::INFINITY,
            first: None,
            length: None,
            velocity: None,
            estimator: None,
            degrees: None,
        }
    }

    /// The estimator of an element: the requested one; otherwise the sampled residual if degrees are chosen, else
    /// [`Estimator::of`].
    pub fn estimator_of(&self, element: TimeElement) -> Estimator {
        let own = || if self.degrees.is_some() { Estimator::Sampled } else { Estimator::of(element) };
        self.estimator.unwrap_or_else(own)
    }

    /// Checks that the settings fit the time element of a motion.
    ///
    /// # Errors
    /// [`Error::Adaptivity`].
    pub fn check_degree(&self, element: TimeElement) -> Result<()> {
        let degree = element.degree;
        let fail = |setting, reason: String| Err(Error::Adaptivity { setting, reason });
        let [lowest, highest] = self.degrees.unwrap_or([degree; 2]);
        if lowest < 1 || lowest > highest {
            return fail("min_degree", format!("{lowest} is not between 1 and max_degree = {highest}"));
        }
        if highest >= MAX_DEGREE {
            let most = MAX_DEGREE - 1;
            return fail(
                "max_degree",
                format!("must be at most {most}: the error of a degree is that over the next"),
            );
        }
        if degree > highest {
            return fail("max_degree", format!("{highest} is less than the degree {degree} of the start"));
        }
        if degree < lowest {
            return fail("min_degree", format!("{lowest} is more than the degree {degree} of the start"));
        }
        let highest = TimeElement { degree: highest, ..element };
        self.estimator.map_or(Ok(()), |estimator| estimator.check(highest))
    }

    /// Checks that the settings are consistent.
    ///
    /// # Errors
    /// [`Error::Adaptivity`].
    pub fn check(&self) -> Result<()> {
        let fail = |setting, reason: String| Err(Error::Adaptivity { setting, reason });
        let is_positive = |value: f64| value > 0.0 && value.is_finite();
        if !(is_positive(self.tolerance) && self.tolerance < 1.0) {
            return fail("tolerance", format!("must be between 0 and 1, not {}", self.tolerance));
        }
        if !(self.smallest >= 0.0 && self.smallest.is_finite()) {
            return fail("min_size", format!("must not be negative, and finite, not {}", self.smallest));
        }
        if self.largest.is_nan() || self.largest <= 0.0 {
            return fail("max_size", format!("must be positive, not {}", self.largest));
        }
        if self.smallest > self.largest {
            let reason =
                format!("= {} is larger than `max_size` = {}", short(self.smallest), short(self.largest));
            return fail("min_size", reason);
        }
        for (setting, value) in
            [("first_size", self.first), ("length", self.length), ("velocity", self.velocity)]
        {
            if let Some(value) = value.filter(|value| !is_positive(*value)) {
                return fail(setting, format!("must be positive and finite, not {}", short(value)));
            }
        }
        match self.first {
            Some(first) if first > self.largest || first < self.smallest => {
                fail("first_size", format!("= {first} is not between `min_size` and `max_size`"))
            }
            _ => Ok(()),
        }
    }
}

/// Chooses step sizes from errors: the predictive controller of Gustafsson (1994, Control-theoretic techniques for
/// stepsize selection in implicit Runge-Kutta methods, ACM Transactions on Mathematical Software 20),
///
/// ```math
/// h_(n+1) = h_n (c/e_n)^(1/q) (e_(n-1)/e_n)^(1/q) (h_n/h_(n-1))
/// ```
///
/// for errors that grow like h^q, with c a part of the tolerance. The trend from the last step to this one is
/// extrapolated, so that a body that approaches another one takes smaller steps in time. The factor is limited smoothly
/// (Soederlind and Wang 2006, Adaptive time-stepping and computational stability, Journal of Computational and Applied
/// Mathematics 185). A size that would change little is kept, because a new one needs new factors of the linear solver.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::motion) struct Controller {
    tolerance: f64,
    smallest: f64,
    largest: f64,
    /// Power q of the step size in the error.
    order: f64,
    /// Size of the next step, and what set it.
    size: f64,
    limit: StepLimit,
    /// Error of the last accepted step over the tolerance, and its size.
    last: Option<(f64, f64)>,
    /// Whether the last attempt was rejected: the step that follows does not grow.
    was_rejected: bool,
}

/// Smallest error over the tolerance in the controller: a step without error says nothing about larger ones.
const LEAST_ERROR: f64 = 1e-6;

/// Range of factors within which the size is not changed.
const UNCHANGED_WITHIN: [f64; 2] = [0.95, 1.2];

/// Largest factor on the size after a step was rejected.
const MAX_REJECTION_FACTOR: f64 = 0.9;

/// Smallest factor on the size after a step was rejected.
const MIN_REJECTION_FACTOR: f64 = 0.1;

impl Controller {
    /// Target error, as a part of the tolerance.
    pub(in crate::motion) const AIM: f64 = 0.6;

    /// A controller of errors that grow like `h^order`; `limit`: what set the first size.
    pub(in crate::motion) fn new(
        adaptivity: &Adaptivity,
        order: usize,
        first: f64,
        limit: StepLimit,
    ) -> Self {
        let Adaptivity { tolerance, smallest, largest, .. } = *adaptivity;
        let size = first.clamp(smallest, largest);
        Controller {
            tolerance,
            smallest,
            largest,
            order: order as f64,
            size,
            limit,
            last: None,
            was_rejected: false,
        }
    }

    /// Size of the next step.
    pub(in crate::motion) fn size(&self) -> f64 {
        self.size
    }

    /// The limit that set it.
    pub(in crate::motion) fn limit(&self) -> StepLimit {
        match self.size {
            size if size >= self.largest => StepLimit::Largest,
            size if size <= self.smallest => StepLimit::Smallest,
            _ => self.limit,
        }
    }

    /// Size of the next step, given the time left to one that must be met: it is met exactly, without a tiny last step.
    pub(in crate::motion) fn size_within(&self, left: f64) -> f64 {
        if self.size >= left * (1.0 - 1e-9) {
            left
        } else if self.size > 0.5 * left {
            0.5 * left
        } else {
            self.size
        }
    }

    /// Whether an error is within the tolerance; NaN is not.
    pub(in crate::motion) fn accepts(&self, error: f64) -> bool {
        error <= self.tolerance
    }

    /// Whether a step may be made smaller.
    pub(in crate::motion) fn can_shrink(&self, size: f64) -> bool {
        size > self.smallest && size > 0.0
    }

    /// Notes a step that was accepted. `is_hard`: Newton's iteration had difficulties, the size does not grow.
    pub(in crate::motion) fn accept(&mut self, size: f64, error: f64, is_hard: bool) {
        let error = (error / self.tolerance / Controller::AIM).max(LEAST_ERROR);
        let (last_error, last_size) = self.last.unwrap_or((error, size));
        let factor = (last_error / (error * error)).powf(1.0 / self.order) * (size / last_size);
        let mut factor = 1.0 + (factor - 1.0).atan();
        let grows = factor > UNCHANGED_WITHIN[1];
        if is_hard || self.was_rejected {
            factor = factor.min(1.0);
        }
        self.last = Some((error, size));
        self.was_rejected = false;
        // A step shortened only to meet a time does not reduce the next one.
        let was_limited = size < self.size * (1.0 - 1e-9);
        let proposed =
            if was_limited && factor >= 1.0 { self.size.max(factor * size) } else { factor * size };
        self.limit = match grows {
            true if is_hard => StepLimit::Corrections,
            // The limit that set the size from which it grows.
            true => self.limit,
            false if was_limited && factor >= 1.0 => self.limit,
            false => StepLimit::Error,
        };
        let change = proposed / self.size;
        if !(UNCHANGED_WITHIN[0]..=UNCHANGED_WITHIN[1]).contains(&change) {
            self.size = proposed.clamp(self.smallest, self.largest);
        }
    }

    /// Makes the next attempt smaller after a step with too large an error.
    pub(in crate::motion) fn reject(&mut self, size: f64, error: f64) {
        let factor = (Controller::AIM * self.tolerance / error).powf(1.0 / self.order);
        let factor = if factor.is_nan() {
            MIN_REJECTION_FACTOR
        } else {
            factor.clamp(MIN_REJECTION_FACTOR, MAX_REJECTION_FACTOR)
        };
        self.cut(factor * size, StepLimit::Error);
    }

    /// Makes the next attempt half as large after a step that failed.
    pub(in crate::motion) fn fail(&mut self, size: f64) {
        self.cut(0.5 * size, StepLimit::Corrections);
    }

    fn cut(&mut self, size: f64, limit: StepLimit) {
        self.size = size.max(self.smallest);
        self.limit = limit;
        self.was_rejected = true;
    }

    /// Forgets the errors so far, which say nothing after a jump of the loads; the next step has at most a size, which
    /// `limit` has set.
    pub(in crate::motion) fn restart(&mut self, size: f64, limit: StepLimit) {
        if size < self.size {
            self.size = size.max(self.smallest);
            self.limit = limit;
        }
        self.last = None;
    }

    /// Keeps everything that the next sizes depend on.
    pub(in crate::motion) fn save(&self, memory: &mut Memory) {
        memory.save_number("controller.size", self.size);
        memory.save_option("controller.last_error", self.last.map(|(error, _)| error));
        memory.save_option("controller.last_size", self.last.map(|(_, size)| size));
        memory.save_flag("controller.was_rejected", self.was_rejected);
        memory.save_number("controller.order", self.order);
        memory.save_word("controller.limit", self.limit.name());
    }

    /// Restores the data of [`Controller::save`].
    ///
    /// # Errors
    /// [`Error::Memory`].
    pub(in crate::motion) fn restore(&mut self, memory: &Memory) -> Result<()> {
        self.size = memory.number("controller.size")?.clamp(self.smallest, self.largest);
        let last = memory.option("controller.last_error")?.zip(memory.option("controller.last_size")?);
        let is_same_order = memory.number("controller.order")? == self.order;
        self.last = last.filter(|(error, _)| *error >= 0.0 && is_same_order);
        self.was_rejected = memory.flag("controller.was_rejected")?;
        let limit = memory.word("controller.limit").ok().and_then(StepLimit::from_name);
        self.limit = limit.unwrap_or(StepLimit::Error);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn controller() -> Controller {
        Controller::new(&Adaptivity::new(1e-4), 3, 0.1, StepLimit::Start)
    }

    #[test]
    fn sizes_settle_where_the_error_is_the_aim() {
        // e = 2 h^3: the target is met at h = (0.6e-4 / 2)^(1/3), within the range of unchanged sizes.
        let mut controller = controller();
        let mut rejected = 0;
        for _ in 0..60 {
            let size = controller.size_within(f64::INFINITY);
            let error = 2.0 * size.powi(3);
            match controller.accepts(error) {
                true => controller.accept(size, error, false),
                false => {
                    controller.reject(size, error);
                    rejected += 1;
                }
            }
        }
        let ideal = (0.6e-4f64 / 2.0).cbrt();
        let size = controller.size_within(f64::INFINITY);
        assert!((0.85..1.15).contains(&(size / ideal)), "{size} is not {ideal}");
        assert!(rejected <= 2, "{rejected}");
    }

    #[test]
    fn times_are_met_without_slivers() {
        let controller = controller();
        assert_eq!(controller.size_within(0.05), 0.05);
        assert_eq!(controller.size_within(0.1 + 1e-12), 0.1 + 1e-12);
        assert_eq!(controller.size_within(0.13), 0.065);
        assert_eq!(controller.size_within(0.5), 0.1);
    }

    #[test]
    fn a_step_that_meets_a_time_does_not_take_back_the_size() {
        let mut controller = controller();
        controller.accept(1e-3, 1e-12, false);
        assert!(controller.size_within(f64::INFINITY) >= 0.1);
        // If even the short step had a large error, the size falls.
        let mut controller = self::controller();
        controller.accept(0.01, 1e-4, false);
        assert!(controller.size_within(f64::INFINITY) < 0.0101);
    }

    #[test]
    fn limits_hold_and_hard_steps_do_not_grow() {
        let adaptivity = Adaptivity { smallest: 0.01, largest: 0.2, ..Adaptivity::new(1e-4) };
        let mut controller = Controller::new(&adaptivity, 3, 0.1, StepLimit::Start);
        controller.accept(0.1, 0.0, true);
        assert_eq!(controller.size_within(9.0), 0.1);
        (0..9).for_each(|_| controller.accept(controller.size, 0.0, false));
        assert_eq!(controller.size_within(9.0), 0.2);
        (0..9).for_each(|_| controller.reject(controller.size, f64::NAN));
        assert_eq!(controller.size_within(9.0), 0.01);
        assert!(!controller.can_shrink(0.01) && controller.can_shrink(0.02));
    }

    #[test]
    fn limits_are_told_and_kept_while_sizes_grow() {
        let adaptivity = Adaptivity { smallest: 1e-3, largest: 0.5, ..Adaptivity::new(1e-4) };
        let mut controller = Controller::new(&adaptivity, 3, 0.01, StepLimit::Start);
        controller.accept(0.01, 1e-12, false);
        assert!(controller.size() > 0.02 && controller.limit() == StepLimit::Start);
        controller.accept(controller.size(), 0.6e-4, false);
        assert_eq!(controller.limit(), StepLimit::Error);
        controller.accept(controller.size(), 1e-9, true);
        assert_eq!(controller.limit(), StepLimit::Corrections);
        controller.fail(controller.size());
        assert_eq!(controller.limit(), StepLimit::Corrections);
        controller.restart(0.002, StepLimit::Kink);
        // The first step after a failure does not grow.
        (0..2).for_each(|_| controller.accept(0.002, 1e-12, false));
        assert!(controller.size() > 0.004 && controller.limit() == StepLimit::Kink);
        controller.restart(1e-9, StepLimit::Kink);
        assert_eq!((controller.size(), controller.limit()), (1e-3, StepLimit::Smallest));
        (0..9).for_each(|_| controller.accept(controller.size(), 0.0, false));
        assert_eq!((controller.size(), controller.limit()), (0.5, StepLimit::Largest));
        controller.reject(0.5, 1e-3);
        assert_eq!(controller.limit(), StepLimit::Error);
    }

    #[test]
    fn settings_that_contradict_each_other_are_named() {
        let good = Adaptivity::new(1e-4);
        for (setting, bad) in [
            ("tolerance", Adaptivity { tolerance: 0.0, ..good }),
            ("tolerance", Adaptivity { tolerance: -1e-3, ..good }),
            ("tolerance", Adaptivity { tolerance: f64::NAN, ..good }),
            ("tolerance", Adaptivity { tolerance: 2.0, ..good }),
            ("min_size", Adaptivity { smallest: -1.0, ..good }),
            ("max_size", Adaptivity { largest: 0.0, ..good }),
            ("min_size", Adaptivity { smallest: 0.2, largest: 0.1, ..good }),
            ("first_size", Adaptivity { first: Some(0.5), largest: 0.1, ..good }),
            ("length", Adaptivity { length: Some(0.0), ..good }),
            ("velocity", Adaptivity { velocity: Some(f64::INFINITY), ..good }),
        ] {
            match bad.check() {
                Err(Error::Adaptivity { setting: named, .. }) => assert_eq!(named, setting),
                other => panic!("{setting}: {other:?}"),
            }
        }
    }

    #[test]
    fn memory_is_all_that_the_next_steps_depend_on() {
        let mut first = controller();
        first.accept(0.1, 3e-5, false);
        first.reject(0.1, 3e-4);
        let mut second = controller();
        let mut memory = Memory::default();
        first.save(&mut memory);
        second.restore(&memory).unwrap();
        assert_eq!(first, second);
    }
}
