//! Outcomes of files that all ranks of a team have together.

#[cfg(test)]
mod tests;

use std::io;

use emmy::team::Subdomain;

/// The same outcome on all ranks: the error of the lowest rank that has one. `None`: no team.
pub(crate) fn agreed<T>(subdomain: Option<&Subdomain>, own: io::Result<T>) -> io::Result<T> {
    let Some(subdomain) = subdomain else { return own };
    let failed = own.as_ref().err().map(|_| subdomain.rank());
    let Some(rank) = subdomain.lowest("outcome of a file", failed) else { return own };
    let message = own.err().map(|error| error.to_string()).unwrap_or_default();
    Err(io::Error::other(subdomain.text_of(rank, &message)))
}

/// Work of the first rank, with its outcome on all. `None`: no team.
pub(crate) fn on_first_rank(
    subdomain: Option<&Subdomain>,
    work: impl FnOnce() -> io::Result<()>,
) -> io::Result<()> {
    let is_first = subdomain.is_none_or(|subdomain| subdomain.rank() == 0);
    agreed(subdomain, if is_first { work() } else { Ok(()) })
}
