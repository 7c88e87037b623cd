//! Choice of the degree by its cost.

use crate::error::Result;
use crate::time::Memory;

/// Chooses the degree with the smallest cost per unit of time.
///
/// Steps of degree k have the error `c_k h^(2k+1)`; c_k is measured by repeating the last accepted step with each
/// neighbouring degree. A step of degree k costs k: one correction evaluates and solves k stages, and the number of
/// corrections hardly depends on the degree. So
///
/// ```math
/// W_k = k / h_k,    h_k = h (c/e_k)^(1/(2k+1)),    c = 0.6 tolerance
/// ```
///
/// with the error e_k of the trial, of size h. The law is not extrapolated beyond some factor, h_k does not exceed the
/// largest step or the time between two outputs, and the degree changes only if the other one is clearly cheaper.
/// Trials cost a few steps, and become rare if they change nothing. The choice uses no clock: a motion has the same
/// degrees on every machine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::motion) struct DegreeChoice {
    lowest: usize,
    highest: usize,
    /// Steps until the next trials, and the interval after those.
    left: usize,
    pause: usize,
}

/// Steps from a new degree to the first trials, and the longest interval between trials.
const PAUSES: [usize; 2] = [8, 128];

/// A step with a smaller part of the target error was shortened to meet a time, or is one of the first.
pub(in crate::motion) const MIN_TELLING_ERROR: f64 = 0.01;

/// Largest change of the size in the extrapolation.
const MAX_SIZE_RATIO: f64 = 3.0;

/// Largest ratio of the cost of another degree to the present one at which the degree changes.
pub(in crate::motion) const MAX_WORK_RATIO: f64 = 0.8;

impl DegreeChoice {
    pub(in crate::motion) fn new([lowest, highest]: [usize; 2]) -> Self {
        DegreeChoice { lowest, highest, left: PAUSES[0], pause: PAUSES[0] }
    }

    /// Counts an accepted step; true if trials are due and the step is long enough for them.
    pub(in crate::motion) fn is_due(&mut self, is_telling: bool) -> bool {
        self.left = self.left.saturating_sub(1);
        self.left == 0 && is_telling
    }

    /// Schedules the next trials: after twice as many steps if nothing changed.
    pub(in crate::motion) fn wait(&mut self, has_changed: bool) {
        self.pause = if has_changed { PAUSES[0] } else { (2 * self.pause).min(PAUSES[1]) };
        self.left = self.pause;
    }

    /// Neighbouring degrees.
    pub(in crate::motion) fn neighbours(&self, degree: usize) -> impl Iterator<Item = usize> + use<> {
        let lowest = self.lowest;
        let highest = self.highest;
        [degree - 1, degree + 1].into_iter().filter(move |k| (lowest..=highest).contains(k))
    }

    /// Keeps the memory that later choices depend on.
    pub(in crate::motion) fn save(&self, degree: usize, memory: &mut Memory) {
        memory.save_number("degree", degree as f64);
        memory.save_number("degree.left", self.left as f64);
        memory.save_number("degree.pause", self.pause as f64);
    }

    /// Restores the data of [`DegreeChoice::save`].
    ///
    /// # Errors
    /// [`crate::Error::Memory`].
    pub(in crate::motion) fn restore(&mut self, memory: &Memory) -> Result<()> {
        self.left = memory.number("degree.left")? as usize;
        self.pause = memory.number("degree.pause")? as usize;
        Ok(())
    }
}

/// The degree in the memory of a control that chooses degrees.
pub(in crate::motion) fn degree_of(memory: &Memory) -> Option<usize> {
    memory.number("degree").ok().map(|degree| degree as usize)
}

/// Size at which an error of a given order equals the target, from a step of a size and its error over the target.
pub(in crate::motion) fn size_of(order: usize, size: f64, error: f64) -> f64 {
    let power = 1.0 / order as f64;
    size * error
        .max(f64::MIN_POSITIVE)
        .recip()
        .powf(power)
        .clamp(MAX_SIZE_RATIO.recip().powi(2), MAX_SIZE_RATIO)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_follow_the_law_within_its_limits() {
        // 2.5^5 of the target error: 2.5 times too large for degree 2.
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
