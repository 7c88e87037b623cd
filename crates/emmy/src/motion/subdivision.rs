//! Subdivision of planned steps that fail.

use serde::{Deserialize, Serialize};

use super::PlannedStep;

/// Subdivision of a planned step into `2^halvings` equal substeps, and the progress of the motion in it.
///
/// A failed step is cut by two, repeatedly if needed; the following steps are subdivided in the same way. After
/// [`GOOD_STEPS`] consecutive successes the number of halvings falls by one, as soon as a larger substep can start. So
/// every planned step ends at its own time, and all its substeps have exactly the same size.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Subdivision {
    /// Number of halvings of a planned step.
    pub halvings: u32,
    /// Substeps of the present planned step that are done.
    pub substep: u64,
    /// Successes since the number of halvings changed.
    pub successes: u32,
}

/// Successes before the step size is doubled.
pub const GOOD_STEPS: u32 = 4;

/// State of the subdivision after a substep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SubstepEnd {
    /// Whether the planned step is done.
    pub is_done: bool,
    /// Whether the step size is doubled.
    pub has_grown: bool,
}

impl Subdivision {
    /// Size and end of the next substep of a planned step.
    pub fn next(&self, step: &PlannedStep) -> (f64, f64) {
        let size = step.size / self.n_substeps() as f64;
        let is_last = self.substep + 1 == self.n_substeps();
        (size, if is_last { step.end } else { step.start + (self.substep + 1) as f64 * size })
    }

    /// Time at which the next substep of a planned step starts.
    pub fn start(&self, step: &PlannedStep) -> f64 {
        match self.substep {
            0 => step.start,
            substep => step.start + substep as f64 * (step.size / self.n_substeps() as f64),
        }
    }

    /// Halves the next substep.
    pub fn cut(&mut self) {
        *self = Subdivision { halvings: self.halvings + 1, substep: 2 * self.substep, successes: 0 };
    }

    /// Notes that a substep is done.
    pub fn pass(&mut self) -> SubstepEnd {
        self.substep += 1;
        self.successes += 1;
        let has_grown = self.halvings > 0 && self.successes >= GOOD_STEPS && self.substep.is_multiple_of(2);
        if has_grown {
            *self = Subdivision { halvings: self.halvings - 1, substep: self.substep / 2, successes: 0 };
        }
        let is_done = self.substep == self.n_substeps();
        if is_done {
            self.substep = 0;
        }
        SubstepEnd { is_done, has_grown }
    }

    fn n_substeps(&self) -> u64 {
        1 << self.halvings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_fill_the_steps_and_grow_back() {
        let step = |i: usize| PlannedStep { start: i as f64, end: i as f64 + 1.0, size: 1.0 };
        let mut subdivision = Subdivision::default();
        (0..3).for_each(|_| subdivision.cut());
        let (mut ends, mut sizes) = (Vec::new(), Vec::new());
        for i in 0..4 {
            loop {
                let (size, end) = subdivision.next(&step(i));
                assert_eq!(subdivision.start(&step(i)) + size, end);
                ends.push(end);
                sizes.push(size);
                if subdivision.pass().is_done {
                    break;
                }
            }
        }
        // Four steps of each size; a fifth of the halves, because half of a planned step is left after four.
        let expected: Vec<f64> = [0.125; 4].into_iter().chain([0.25; 4]).chain([0.5; 5]).collect();
        assert_eq!(sizes, expected);
        assert_eq!((sizes.iter().sum(), ends[ends.len() - 1]), (4.0, 4.0));
        assert_eq!(subdivision, Subdivision { halvings: 0, substep: 0, successes: subdivision.successes });
    }
}
