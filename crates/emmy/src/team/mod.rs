//! Teams of ranks that share a body: each computes the rows of its own nodes.
//!
//! A rank has its own nodes and every cell that touches one of them; the other nodes of those cells are its *guests*.
//! Values of guests come from their owners. Every sum over nodes or cells is a call of all ranks together.

mod engine;
mod subdomain;
mod threads;

pub use engine::{Engine, EngineKind, OwnRows};
pub use subdomain::Subdomain;
pub use threads::{Threads, ThreadsError};

use std::fmt;

/// The ranks that compute a body together, as one of them sees them.
///
/// All ranks make the same calls in the same order. Every call has a name, which tells mismatching calls apart, and
/// numbers of the same length on all ranks, except in [`Team::exchange`].
///
/// ```
/// use emmy::team::{Team, Threads};
/// let sums = Threads::run(3, |team| {
///     let mut values = [1.0, team.rank() as f64];
///     team.sum("example", &mut values);
///     values
/// });
/// assert_eq!(sums.unwrap(), [[3.0, 3.0]; 3]);
/// ```
pub trait Team: fmt::Debug + Send + Sync {
    /// Number of ranks.
    fn size(&self) -> usize;

    /// Number of this rank, below [`Team::size`].
    fn rank(&self) -> usize;

    /// Replaces each number by its sum over all ranks, added in the order of the ranks (see [`GROUP`]): the same bits
    /// on all of them, and in every run.
    fn sum(&self, name: &'static str, values: &mut [f64]);

    /// Replaces each number by the largest of all ranks; NaN exceeds every number.
    fn largest(&self, name: &'static str, values: &mut [f64]);

    /// Sends every parcel to the rank that it names, and receives what that rank sends here. Both have a parcel for
    /// each other.
    fn exchange(&self, name: &'static str, parcels: &mut [Parcel]);

    /// A linear solver for the rows of all ranks; `None`: the team has none of this kind. A call of all ranks.
    fn engine(&self, _: EngineKind) -> Option<Box<dyn Engine>> {
        None
    }
}

/// Ranks whose numbers are combined first. On more ranks, the numbers of each group of so many consecutive ranks are
/// combined, and then those of the groups.
pub const GROUP: usize = 64;

/// Replaces numbers by the combination of several lists, one after the other. Teams combine by this function alone, so
/// that all have the same bits.
///
/// ```
/// let lists = [[1.0, 5.0], [2.0, 6.0]];
/// let mut sum = [0.0; 2];
/// emmy::team::combine(&mut sum, lists.iter().map(|list| &list[..]), |sum, value| sum + value);
/// assert_eq!(sum, [3.0, 11.0]);
/// ```
pub fn combine<'a>(
    values: &mut [f64],
    mut lists: impl Iterator<Item = &'a [f64]>,
    combine: impl Fn(f64, f64) -> f64,
) {
    if let Some(first) = lists.next() {
        values.copy_from_slice(first);
    }
    for list in lists {
        values.iter_mut().zip(list).for_each(|(value, own)| *value = combine(*value, *own));
    }
}

/// The larger of two numbers; NaN exceeds every number.
///
/// ```
/// use emmy::team::larger;
/// assert!(larger(1.0, 2.0) == 2.0 && larger(1.0, f64::NAN).is_nan() && larger(f64::NAN, 1.0).is_nan());
/// ```
pub fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// Numbers for another rank, and from it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Parcel {
    /// The other rank.
    pub rank: usize,
    /// Numbers to send.
    pub outgoing: Vec<f64>,
    /// Numbers received; the caller gives it the length of the other rank's outgoing numbers.
    pub incoming: Vec<f64>,
}

/// A rank without others.
///
/// ```
/// use emmy::team::{Alone, Team};
/// let mut values = [2.0];
/// Alone.sum("example", &mut values);
/// assert_eq!((Alone.size(), values), (1, [2.0]));
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Alone;

impl Team for Alone {
    fn size(&self) -> usize {
        1
    }

    fn rank(&self) -> usize {
        0
    }

    fn sum(&self, _: &'static str, _: &mut [f64]) {}

    fn largest(&self, _: &'static str, _: &mut [f64]) {}

    fn exchange(&self, _: &'static str, _: &mut [Parcel]) {}
}

/// The same outcome on all ranks: the error of the lowest rank that has one. `other` turns its message into an error of
/// the ranks that have none.
///
/// ```
/// use emmy::team::{Team, Threads, agree};
/// let outcomes = Threads::run(2, |team| {
///     let own: Result<(), String> = if team.rank() == 1 { Err("no space left".into()) } else { Ok(()) };
///     agree(&*team, own, |message| message)
/// });
/// assert_eq!(outcomes.unwrap()[0], Err("rank 1: no space left".into()));
/// ```
///
/// # Errors
/// That error.
pub fn agree<T, E: fmt::Display>(
    team: &dyn Team,
    own: Result<T, E>,
    other: impl FnOnce(String) -> E,
) -> Result<T, E> {
    let mut lowest = [own.as_ref().err().map_or(f64::NEG_INFINITY, |_| -(team.rank() as f64))];
    team.largest("outcome", &mut lowest);
    if lowest[0] == f64::NEG_INFINITY {
        return own;
    }
    let rank = -lowest[0] as usize;
    let text = own.as_ref().err().map(E::to_string).unwrap_or_default();
    let message = text_of(team, rank, &text);
    own.and_then(|_| Err(other(format!("rank {rank}: {message}"))))
}

/// The text of one rank on all ranks.
///
/// ```
/// use emmy::team::{Team, Threads, text_of};
/// let texts = Threads::run(2, |team| text_of(&*team, 1, &format!("of rank {}", team.rank())));
/// assert_eq!(texts.unwrap(), ["of rank 1"; 2]);
/// ```
pub fn text_of(team: &dyn Team, rank: usize, own: &str) -> String {
    let is_own = team.rank() == rank;
    let mut length = [if is_own { own.len() as f64 } else { 0.0 }];
    team.sum("length of a text", &mut length);
    let mut letters = vec![0.0; length[0] as usize];
    if is_own {
        letters.iter_mut().zip(own.bytes()).for_each(|(letter, byte)| *letter = f64::from(byte));
    }
    team.sum("text", &mut letters);
    let bytes: Vec<u8> = letters.into_iter().map(|letter| letter as u8).collect();
    String::from_utf8_lossy(&bytes).into_owned()
}

/// The nodes that a rank shares with a neighbour, in an order that both have.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Neighbour {
    /// Its rank.
    pub rank: usize,
    /// Own nodes that are guests there.
    pub outgoing: Vec<u32>,
    /// Guests that it owns.
    pub incoming: Vec<u32>,
}
