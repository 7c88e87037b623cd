//! Work of one rank of a team, and outcomes that all ranks have together.

#[cfg(test)]
mod tests;

use std::{fmt, io};

use emmy::team::{self, Team};

use crate::input::Problem;

/// The same outcome on all ranks: the error of the lowest rank that has one.
pub(crate) fn agreed<T>(team: &dyn Team, own: io::Result<T>) -> io::Result<T> {
    team::agree(team, own, io::Error::other)
}

/// The lowest rank whose text differs from that of rank 0; `None` if all agree. A collective call, with any texts.
///
/// ```
/// use emmy::team::{Team, Threads};
/// use emmy_io::team::other_than_first;
/// let ranks = |texts: [&'static str; 3]| {
///     Threads::run(3, |team| other_than_first(&*team, "example", texts[team.rank()])).unwrap()
/// };
/// assert_eq!(ranks(["a", "a", "a"]), [None; 3]);
/// assert_eq!(ranks(["a", "b", "c"]), [Some(1); 3]);
/// ```
pub fn other_than_first(team: &dyn Team, name: &'static str, own: &str) -> Option<usize> {
    let own = [f64::from(crc32fast::hash(own.as_bytes())), own.len() as f64];
    let mut first = if team.rank() == 0 { own } else { [0.0; 2] };
    team.sum(name, &mut first);
    let mut lowest = [if first == own { f64::NEG_INFINITY } else { -(team.rank() as f64) }];
    team.largest(name, &mut lowest);
    (lowest[0] > f64::NEG_INFINITY).then_some(-lowest[0] as usize)
}

/// Work of the first rank, with its outcome on all.
pub(crate) fn on_first_rank(team: &dyn Team, work: impl FnOnce() -> io::Result<()>) -> io::Result<()> {
    agreed(team, if team.rank() == 0 { work() } else { Ok(()) })
}

impl Problem {
    /// Number of the rank of this process; 0 without a team.
    pub fn rank(&self) -> usize {
        self.body.ranks().rank()
    }

    /// The same outcome on all ranks of a team; `other` turns the message of another rank into an error.
    ///
    /// # Errors
    /// That of the lowest rank that has one.
    pub fn agree<T, E: fmt::Display>(
        &self,
        own: Result<T, E>,
        other: impl FnOnce(String) -> E,
    ) -> Result<T, E> {
        team::agree(&**self.body.ranks().team(), own, other)
    }

    /// Runs a function on rank 0 alone; if it fails, all ranks fail with its error.
    ///
    /// # Errors
    /// Those of the function.
    pub fn on_first_rank<T, E: fmt::Display>(
        &self,
        work: impl FnOnce() -> Result<T, E>,
        other: impl FnOnce(String) -> E,
    ) -> Result<Option<T>, E> {
        let own = (self.rank() == 0).then(work).transpose();
        self.agree(own, other)
    }
}
