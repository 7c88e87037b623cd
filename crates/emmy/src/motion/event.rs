//! Events of a march.

/// An event of a march, such as a cut or a rejection.
///
/// ```
/// use emmy::motion::{Event, EventKind};
/// let event = Event { step: 3, time: 0.3, kind: EventKind::Cut, message: "step size 0.05".into() };
/// assert_eq!(event.kind.name(), "cut");
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Event {
    /// Number of its step.
    pub step: usize,
    /// Its time \[time\].
    pub time: f64,
    /// Its kind.
    pub kind: EventKind,
    /// Description.
    pub message: String,
}

/// Kinds of events.
///
/// ```
/// assert_eq!(emmy::motion::EventKind::RoundingFloor.name(), "rounding-floor");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EventKind {
    /// A failed step is cut by two.
    Cut,
    /// A step in which something would pass through its opponent in contact is cut by two.
    Passed,
    /// A step is rejected because of its error, and repeated with a smaller size.
    Rejected,
    /// The step size is doubled again after cuts.
    Grown,
    /// The degree of the elements changes.
    Degree,
    /// A support or a joint is released.
    Release,
    /// Newton's iteration ended at its rounding floor, for the first time.
    RoundingFloor,
    /// A step does not resolve a function of time or the turn of a rigid body, for the first time.
    Unresolved,
}

impl EventKind {
    /// Key word of the kind.
    pub const fn name(self) -> &'static str {
        match self {
            EventKind::Cut => "cut",
            EventKind::Passed => "passed",
            EventKind::Rejected => "rejected",
            EventKind::Grown => "grown",
            EventKind::Degree => "degree",
            EventKind::Release => "release",
            EventKind::RoundingFloor => "rounding-floor",
            EventKind::Unresolved => "unresolved",
        }
    }
}
