//! The degree of the elements, chosen by the work that it takes.

use super::adaptive::Control;
use super::{Controller, EventKind, Motion};
use crate::body::Body;
use crate::error::Result;
use crate::time::{LocalError, Memory, State};

/// Chooses the degree with which a unit of time costs least.
///
/// Steps of degree k have the error `c_k h^(2k+1)`; c_k is that of a step of each neighbouring degree, on trial from the state in which a step began that is done already. A
/// step of degree k costs k, since a correction of its equations has k stages to evaluate and to solve for, and degrees differ little in how many it takes. So
///
/// ```math
/// W_k = k / h_k,    h_k = h (c/e_k)^(1/(2k+1)),    c = 0.6 tolerance
/// ```
///
/// with the error e_k of the trial, of size h. The law is not trusted beyond some factor, h_k does not go beyond the largest step or the time between two outputs, and
/// another degree is taken only if it costs clearly less. Trials cost a few steps, and become rare where they change nothing. There is no clock in it: a motion has
/// the same degrees on every machine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct DegreeChoice {
    lowest: usize,
    highest: usize,
    /// Steps to go to the next trials, and from those to the ones after.
    left: usize,
    pause: usize,
}

/// Steps from a new degree to the first trials, and between trials at the most.
const PAUSE: [usize; 2] = [8, 128];

/// A step whose error is less than this part of the aim was made short to meet a time, or is one of the first.
const SHORT: f64 = 0.01;

/// Change of the size that is believed of the law at the most.
const BELIEVED: f64 = 3.0;

/// Part of the work that another degree takes at the most to be worth a change.
const WORTH: f64 = 0.8;

impl DegreeChoice {
    pub fn new([lowest, highest]: [usize; 2]) -> Self {
        DegreeChoice { lowest, highest, left: PAUSE[0], pause: PAUSE[0] }
    }

    /// Counts an accepted step; whether it is time for trials, if that step says something about the size.
    fn is_due(&mut self, is_telling: bool) -> bool {
        self.left = self.left.saturating_sub(1);
        self.left == 0 && is_telling
    }

    /// Waits for the next trials: twice as long where nothing changed.
    fn wait(&mut self, has_changed: bool) {
        self.pause = if has_changed { PAUSE[0] } else { (2 * self.pause).min(PAUSE[1]) };
        self.left = self.pause;
    }

    /// Degrees beside one.
    fn neighbours(&self, degree: usize) -> impl Iterator<Item = usize> + use<> {
        let (lowest, highest) = (self.lowest, self.highest);
        [degree - 1, degree + 1].into_iter().filter(move |k| (lowest..=highest).contains(k))
    }

    /// Keeps what the choices to come depend on.
    pub fn keep(&self, degree: usize, memory: &mut Memory) {
        memory.keep_number("degree", degree as f64);
        memory.keep_number("degree.left", self.left as f64);
        memory.keep_number("degree.pause", self.pause as f64);
    }

    /// Takes over what [`DegreeChoice::keep`] kept.
    ///
    /// # Errors
    /// [`crate::Error::Memory`].
    pub fn restore(&mut self, memory: &Memory) -> Result<()> {
        self.left = memory.number("degree.left")? as usize;
        self.pause = memory.number("degree.pause")? as usize;
        Ok(())
    }
}

/// The degree that a motion had whose choice of sizes left a memory, if its degree was chosen.
pub(super) fn degree_of(memory: &Memory) -> Option<usize> {
    memory.number("degree").ok().map(|degree| degree as usize)
}

/// Size at which an error that grows with an order is the one aimed at, by a step of a size and its error over that.
fn size_of(order: usize, size: f64, error: f64) -> f64 {
    let power = 1.0 / order as f64;
    size * error.max(f64::MIN_POSITIVE).recip().powf(power).clamp(BELIEVED.recip().powi(2), BELIEVED)
}

impl<'a> Motion<'a> {
    /// Goes over to the degree that costs least, if it is time to ask, after a step of a size with an error. `longest`: what else limits the
    /// size.
    pub(super) fn choose_degree(
        &mut self,
        control: &mut Control<'a>,
        (size, error): (f64, f64),
        longest: f64,
    ) -> Result<()> {
        let aim = Controller::AIM * control.adaptivity.tolerance;
        let Some(mut choice) = control.degrees else { return Ok(()) };
        let is_telling = error >= SHORT * aim || size >= 0.5 * longest;
        if choice.is_due(is_telling) {
            let work = |degree: usize, size: f64| degree as f64 / size.min(longest);
            let own = size_of(LocalError::order(self.scheme, self.degree), size, error / aim);
            let mut best = (WORTH * work(self.degree, own), None);
            for degree in choice.neighbours(self.degree) {
                let Some(error) = self.error_of_degree(control, degree, size) else { continue };
                let size = size_of(LocalError::order(self.scheme, degree), size, error / aim);
                if work(degree, size) < best.0 {
                    best = (work(degree, size), Some((degree, size)));
                }
            }
            choice.wait(best.1.is_some());
            if let (_, Some((degree, size))) = best {
                self.change_degree(control, degree, size)?;
            }
        }
        control.degrees = Some(choice);
        Ok(())
    }

    /// Error of a step of another degree from where the last one began; none if it fails. Trials are rare: they make all that they need anew.
    fn error_of_degree(&self, control: &Control<'a>, degree: usize, size: f64) -> Option<f64> {
        let (body, settings): (&Body, _) = (self.body, self.settings);
        let scheme = self.scheme.of_degree(degree);
        let mut end: State = control.start.clone();
        let mut stepper = scheme.stepper(body, degree, settings, &mut end).ok()?;
        let kind = control.adaptivity.estimator_of(scheme, degree);
        let mut estimator = LocalError::new(body, (scheme, degree), kind, settings, &control.start).ok()?;
        stepper.advance(&mut end, size).ok()?;
        estimator.estimate(&control.start, &end, stepper.rates(), size).ok()?;
        Some(control.size_of_error(body, &estimator)).filter(|error| error.is_finite())
    }

    fn change_degree(&mut self, control: &mut Control<'a>, degree: usize, size: f64) -> Result<()> {
        let message = format!("elements of degree {degree} after {}, steps of {size:.3e}", self.degree);
        self.degree = degree;
        let scheme = self.scheme.of_degree(degree);
        self.stepper = scheme.stepper(self.body, degree, self.settings, &mut self.state)?;
        control.estimator = self.estimator(&control.adaptivity)?;
        control.controller = Controller::new(&control.adaptivity, LocalError::order(scheme, degree), size);
        self.note(EventKind::Degree, self.state.step, message);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_follow_the_law_within_what_is_believed() {
        // 2.5^5 of the error that is aimed at: 2.5 times too large for degree 2.
        assert!((size_of(5, 1.0, 2.5f64.powi(5)) - 0.4).abs() < 1e-12);
        assert!((size_of(3, 0.1, 1.0 / 8.0) - 0.2).abs() < 1e-12);
        assert_eq!((size_of(7, 1.0, 0.0), size_of(3, 1.0, 1e30)), (3.0, 1.0 / 9.0));
    }

    #[test]
    fn trials_become_rare_and_come_back_with_a_change() {
        let mut choice = DegreeChoice::new([1, 3]);
        let mut trials = Vec::new();
        for step in 1..=200 {
            if choice.is_due(true) {
                trials.push(step);
                choice.wait(step == 56);
            }
        }
        assert_eq!(trials, [8, 24, 56, 64, 80, 112, 176]);
        assert_eq!(choice.neighbours(1).collect::<Vec<_>>(), [2]);
        assert_eq!(choice.neighbours(2).collect::<Vec<_>>(), [1, 3]);
        // Short steps say nothing about the degree.
        let mut choice = DegreeChoice::new([1, 3]);
        assert!((0..99).all(|_| !choice.is_due(false)) && choice.is_due(true));
    }
}
