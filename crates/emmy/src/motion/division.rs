//! How the steps of the plan are divided where they fail.

use serde::{Deserialize, Serialize};

use super::PlannedStep;

/// Division of a planned step into `2^level` equal parts, and how far the motion is in it.
///
/// A step that fails is cut by two, again and again; the level then stays for the steps that follow. After [`GOOD_STEPS`] steps
/// that succeed one after the other it falls by one, as soon as that many of the smaller steps are done that the larger ones fit
/// behind them. So every planned step ends at its own time, and all parts of one have the same bits in their size.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Division {
    /// Number of times that a planned step is cut by two.
    pub level: u32,
    /// Parts of the present planned step that are done.
    pub part: u64,
    /// Steps that succeeded since the level changed.
    pub good: u32,
}

/// Steps that must succeed before the step size grows back by two.
pub const GOOD_STEPS: u32 = 4;

/// Where a step that was done leaves the division.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Passed {
    /// Whether the planned step is done.
    pub is_done: bool,
    /// Whether the next steps are larger.
    pub has_grown: bool,
}

impl Division {
    /// Size and end of the next part of a planned step.
    pub fn next(&self, step: &PlannedStep) -> (f64, f64) {
        let size = step.size / self.n_parts() as f64;
        let is_last = self.part + 1 == self.n_parts();
        (size, if is_last { step.end } else { step.start + (self.part + 1) as f64 * size })
    }

    /// Time at which the next part of a planned step starts.
    pub fn start(&self, step: &PlannedStep) -> f64 {
        match self.part {
            0 => step.start,
            part => step.start + part as f64 * (step.size / self.n_parts() as f64),
        }
    }

    /// Cuts the next part by two.
    pub fn cut(&mut self) {
        *self = Division { level: self.level + 1, part: 2 * self.part, good: 0 };
    }

    /// Notes a part that is done.
    pub fn pass(&mut self) -> Passed {
        self.part += 1;
        self.good += 1;
        let has_grown = self.level > 0 && self.good >= GOOD_STEPS && self.part.is_multiple_of(2);
        if has_grown {
            *self = Division { level: self.level - 1, part: self.part / 2, good: 0 };
        }
        let is_done = self.part == self.n_parts();
        if is_done {
            self.part = 0;
        }
        Passed { is_done, has_grown }
    }

    fn n_parts(&self) -> u64 {
        1 << self.level
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_fill_the_steps_and_grow_back() {
        let step = |i: usize| PlannedStep { start: i as f64, end: i as f64 + 1.0, size: 1.0 };
        let mut division = Division::default();
        (0..3).for_each(|_| division.cut());
        let (mut ends, mut sizes) = (Vec::new(), Vec::new());
        for i in 0..4 {
            loop {
                let (size, end) = division.next(&step(i));
                assert_eq!(division.start(&step(i)) + size, end);
                ends.push(end);
                sizes.push(size);
                if division.pass().is_done {
                    break;
                }
            }
        }
        // Four steps of each size; a fifth of the halves, because after four of them half of a planned step is left.
        let expected: Vec<f64> = [0.125; 4].into_iter().chain([0.25; 4]).chain([0.5; 5]).collect();
        assert_eq!(sizes, expected);
        assert_eq!((sizes.iter().sum(), ends[ends.len() - 1]), (4.0, 4.0));
        assert_eq!(division, Division { level: 0, part: 0, good: division.good });
    }
}
