//! Outcomes of files that all ranks of a team have together.

#[cfg(test)]
mod tests;

use std::io;

use emmy::team::{self, Subdomain};

/// The same outcome on all ranks: the error of the lowest rank that has one. `None`: no team.
pub(crate) fn agreed<T>(subdomain: Option<&Subdomain>, own: io::Result<T>) -> io::Result<T> {
    match subdomain {
        Some(subdomain) => team::agree(&**subdomain.team(), own, io::Error::other),
        None => own,
    }
}

/// Work of the first rank, with its outcome on all. `None`: no team.
pub(crate) fn on_first_rank(
    subdomain: Option<&Subdomain>,
    work: impl FnOnce() -> io::Result<()>,
) -> io::Result<()> {
    let is_first = subdomain.is_none_or(|subdomain| subdomain.rank() == 0);
    agreed(subdomain, if is_first { work() } else { Ok(()) })
}
