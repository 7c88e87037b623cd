//! The limits that set the sizes of adaptive steps.

use serde::{Deserialize, Serialize};

/// The limit that set the size of an adaptive step.
///
/// ```
/// use emmy::motion::StepLimit;
/// assert_eq!(StepLimit::from_name("kink"), Some(StepLimit::Kink));
/// assert!(StepLimit::ALL.iter().all(|limit| StepLimit::from_name(limit.name()) == Some(*limit)));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StepLimit {
    /// Sizes still grow from the first one.
    Start,
    /// The estimated error.
    Error,
    /// Newton's iteration took many corrections, or failed.
    Corrections,
    /// A kink or a jump of a load or a driven support: the step ends there, or sizes still grow from the first one
    /// after it.
    Kink,
    /// A smooth function of time that longer steps do not resolve.
    Load,
    /// An output time, at which the step ends.
    Output,
    /// The end of a phase or of the plan, at which the step ends.
    Phase,
    /// The largest size.
    Largest,
    /// The smallest size.
    Smallest,
}

impl StepLimit {
    /// All of them.
    pub const ALL: [StepLimit; 9] = [
        StepLimit::Start,
        StepLimit::Error,
        StepLimit::Corrections,
        StepLimit::Kink,
        StepLimit::Load,
        StepLimit::Output,
        StepLimit::Phase,
        StepLimit::Largest,
        StepLimit::Smallest,
    ];

    /// The word in histories and summaries.
    pub const fn name(self) -> &'static str {
        match self {
            StepLimit::Start => "start",
            StepLimit::Error => "error",
            StepLimit::Corrections => "corrections",
            StepLimit::Kink => "kink",
            StepLimit::Load => "load",
            StepLimit::Output => "output",
            StepLimit::Phase => "phase",
            StepLimit::Largest => "max_size",
            StepLimit::Smallest => "min_size",
        }
    }

    /// The limit of a word.
    pub fn from_name(name: &str) -> Option<Self> {
        StepLimit::ALL.into_iter().find(|limit| limit.name() == name)
    }

    /// Its place in [`StepLimit::ALL`].
    pub const fn index(self) -> usize {
        self as usize
    }
}

/// Numbers of adaptive steps by what set their sizes.
///
/// ```
/// use emmy::motion::{StepLimit, StepLimits};
/// let mut limits = StepLimits::default();
/// for limit in [StepLimit::Kink, StepLimit::Error, StepLimit::Kink] {
///     limits.add(limit);
/// }
/// assert_eq!(limits.counts().collect::<Vec<_>>(), [(StepLimit::Kink, 2), (StepLimit::Error, 1)]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct StepLimits([usize; 9]);

impl StepLimits {
    /// Counts a step.
    pub fn add(&mut self, limit: StepLimit) {
        self.0[limit.index()] += 1;
    }

    /// The limits of some steps, and how many steps each of them set; the most frequent first.
    pub fn counts(&self) -> impl Iterator<Item = (StepLimit, usize)> + use<> {
        let mut counts = StepLimit::ALL.map(|limit| (limit, self.0[limit.index()]));
        counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        counts.into_iter().filter(|(_, count)| *count > 0)
    }
}
