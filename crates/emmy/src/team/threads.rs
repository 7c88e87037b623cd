//! A team of threads in one process, for tests and small studies.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;

use super::{GROUP, Parcel, Team, combine, larger};

/// A team whose ranks are threads of this process.
///
/// Calls that do not match are found: the ranks end with a message that names both calls instead of waiting for each
/// other.
#[derive(Debug)]
pub struct Threads {
    rank: usize,
    hub: Arc<Hub>,
}

/// A team of threads that did not reach its end.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ThreadsError {
    /// Ranks that made different calls, or ended while others were waiting.
    #[error("{0}")]
    Mismatch(String),
    /// A rank that panicked.
    #[error("rank {rank}: {message}")]
    Panic {
        /// Its number.
        rank: usize,
        /// Its message.
        message: String,
    },
}

impl Threads {
    /// Runs a function on every rank of a team of some size, and returns the results in the order of the ranks.
    ///
    /// # Errors
    /// [`ThreadsError`].
    ///
    /// ```
    /// use emmy::team::{Team, Threads};
    /// // Only one of the ranks asks for a sum.
    /// let error = Threads::run(2, |team| {
    ///     if team.rank() == 0 {
    ///         team.sum("mass", &mut [0.0]);
    ///     }
    /// });
    /// assert_eq!(error.unwrap_err().to_string(), "rank 1 has ended, rank 0 is at the sum \"mass\" of 1");
    /// ```
    pub fn run<T: Send>(
        size: usize,
        rank: impl Fn(Arc<dyn Team>) -> T + Sync,
    ) -> Result<Vec<T>, ThreadsError> {
        Threads::run_in_groups(GROUP, size, rank)
    }

    /// [`Threads::run`] with another size of the groups than [`GROUP`].
    ///
    /// # Errors
    /// [`ThreadsError`].
    ///
    /// # Panics
    /// If the size of the groups is zero.
    ///
    /// ```
    /// use emmy::team::Threads;
    /// let sums = Threads::run_in_groups(2, 4, |team| {
    ///     let mut value = [[1e16, 1.0, 1.0, 1.0][team.rank()]];
    ///     team.sum("example", &mut value);
    ///     value[0]
    /// });
    /// // (1e16 + 1) + (1 + 1): 1e16 + 1 is 1e16.
    /// assert_eq!(sums.unwrap(), [1e16 + 2.0; 4]);
    /// ```
    pub fn run_in_groups<T: Send>(
        group: usize,
        size: usize,
        rank: impl Fn(Arc<dyn Team>) -> T + Sync,
    ) -> Result<Vec<T>, ThreadsError> {
        assert!(group > 0, "groups of no ranks");
        let hub = Arc::new(Hub::new(size, group));
        let outcomes: Vec<thread::Result<T>> = thread::scope(|scope| {
            let start = |number: usize| {
                let (hub, rank) = (hub.clone(), &rank);
                scope.spawn(move || {
                    let team = Arc::new(Threads { rank: number, hub: hub.clone() });
                    let outcome = catch_unwind(AssertUnwindSafe(|| rank(team)));
                    hub.end(number);
                    outcome
                })
            };
            let ranks: Vec<_> = (0..size).map(start).collect();
            ranks.into_iter().map(|rank| rank.join().and_then(|outcome| outcome)).collect()
        });
        let is_stopped = |payload: &Box<dyn Any + Send>| payload.is::<Stopped>();
        let panics =
            outcomes.iter().enumerate().filter_map(|(rank, outcome)| Some((rank, outcome.as_ref().err()?)));
        // The others were stopped because of it.
        if let Some((rank, payload)) = panics.clone().find(|(_, payload)| !is_stopped(payload)) {
            let text = payload.downcast_ref::<String>().map(String::as_str);
            let message = text.or(payload.downcast_ref::<&str>().copied()).unwrap_or("panicked").to_string();
            return Err(ThreadsError::Panic { rank, message });
        }
        if panics.count() > 0 {
            return Err(ThreadsError::Mismatch(hub.lock().failure.clone().unwrap_or_default()));
        }
        Ok(outcomes.into_iter().flatten().collect())
    }

    /// Adds the numbers of this rank to a call, and waits for those of the others.
    fn call(&self, call: Call, numbers: Vec<f64>, parcels: Vec<(usize, Vec<f64>)>) -> Arc<Vec<Deposit>> {
        self.hub.call(self.rank, Deposit { call, numbers, parcels })
    }

    /// Combines the numbers of all ranks in groups.
    fn combine(&self, kind: &'static str, name: &'static str, values: &mut [f64], pair: fn(f64, f64) -> f64) {
        let all = self.call(Call { kind, name, length: values.len() }, values.to_vec(), Vec::new());
        let of_group = |ranks: &[Deposit]| {
            let mut of_group = vec![0.0; values.len()];
            combine(&mut of_group, ranks.iter().map(|deposit| &deposit.numbers[..]), pair);
            of_group
        };
        let groups: Vec<Vec<f64>> = all.chunks(self.hub.group).map(of_group).collect();
        combine(values, groups.iter().map(|group| &group[..]), pair);
    }
}

impl Team for Threads {
    fn size(&self) -> usize {
        self.hub.size
    }

    fn rank(&self) -> usize {
        self.rank
    }

    fn sum(&self, name: &'static str, values: &mut [f64]) {
        self.combine("sum", name, values, |sum, value| sum + value);
    }

    fn largest(&self, name: &'static str, values: &mut [f64]) {
        self.combine("largest", name, values, larger);
    }

    fn exchange(&self, name: &'static str, parcels: &mut [Parcel]) {
        let sent = parcels.iter().map(|parcel| (parcel.rank, parcel.outgoing.clone())).collect();
        let all = self.call(Call { kind: "exchange", name, length: 0 }, Vec::new(), sent);
        for parcel in parcels {
            let received = all[parcel.rank].parcels.iter().find(|(rank, _)| *rank == self.rank);
            parcel.incoming.copy_from_slice(received.map_or(&[], |(_, numbers)| numbers));
        }
    }
}

/// A call of all ranks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Call {
    kind: &'static str,
    name: &'static str,
    length: usize,
}

impl Call {
    fn text(self) -> String {
        let Call { kind, name, length } = self;
        if length == 0 {
            format!("the {kind} \"{name}\"")
        } else {
            format!("the {kind} \"{name}\" of {length}")
        }
    }
}

/// The contribution of a rank to a call.
#[derive(Debug)]
struct Deposit {
    call: Call,
    numbers: Vec<f64>,
    /// Numbers for other ranks.
    parcels: Vec<(usize, Vec<f64>)>,
}

/// Payload of the unwinding of a rank that cannot go on.
struct Stopped;

/// The place where ranks meet.
#[derive(Debug)]
struct Hub {
    size: usize,
    /// Ranks whose numbers are combined first.
    group: usize,
    state: Mutex<HubState>,
    has_changed: Condvar,
}

#[derive(Debug)]
struct HubState {
    /// Number of complete calls.
    round: usize,
    deposits: Vec<Option<Deposit>>,
    /// All deposits of the last complete call.
    complete: Arc<Vec<Deposit>>,
    has_ended: Vec<bool>,
    failure: Option<String>,
}

impl Hub {
    fn new(size: usize, group: usize) -> Self {
        let state = HubState {
            round: 0,
            deposits: (0..size).map(|_| None).collect(),
            complete: Arc::default(),
            has_ended: vec![false; size],
            failure: None,
        };
        Hub { size, group, state: Mutex::new(state), has_changed: Condvar::new() }
    }

    fn lock(&self) -> MutexGuard<'_, HubState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until every rank has made the call, and returns the deposits of all.
    fn call(&self, rank: usize, deposit: Deposit) -> Arc<Vec<Deposit>> {
        let mut state = self.lock();
        let round = state.round;
        state.deposits[rank] = Some(deposit);
        state.check();
        if state.failure.is_none() && state.deposits.iter().all(Option::is_some) {
            state.complete = Arc::new(state.deposits.iter_mut().filter_map(Option::take).collect());
            state.round += 1;
        }
        self.has_changed.notify_all();
        while state.round == round && state.failure.is_none() {
            state = self.has_changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        if state.round == round {
            drop(state);
            // Without the message of a panic: `Threads::run` has the reason.
            resume_unwind(Box::new(Stopped));
        }
        state.complete.clone()
    }

    /// Notes that a rank makes no more calls.
    fn end(&self, rank: usize) {
        let mut state = self.lock();
        state.has_ended[rank] = true;
        state.check();
        self.has_changed.notify_all();
    }
}

impl HubState {
    /// Notes a failure if calls differ, or if a rank has ended that others wait for.
    fn check(&mut self) {
        let mut calls =
            self.deposits.iter().enumerate().filter_map(|(rank, own)| Some((rank, own.as_ref()?.call)));
        let Some((first, call)) = calls.next() else { return };
        let other = calls
            .find(|(_, other)| *other != call)
            .map(|(rank, other)| (rank, format!("is at {}", other.text())));
        let ended =
            self.has_ended.iter().position(|ended| *ended).map(|rank| (rank, "has ended".to_string()));
        if let Some((rank, where_it_is)) = other.or(ended) {
            let failure = format!("rank {rank} {where_it_is}, rank {first} is at {}", call.text());
            self.failure.get_or_insert(failure);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_added_in_the_order_of_the_ranks_and_nan_is_the_largest() {
        let values = [0.1, 0.2, 0.3, 0.7];
        let results = Threads::run(4, |team| {
            let own = values[team.rank()];
            let mut sum = [own, -own];
            team.sum("sum", &mut sum);
            let mut largest = [own, if team.rank() == 2 { f64::NAN } else { 9.0 }];
            team.largest("largest", &mut largest);
            (sum, largest)
        });
        let expected = ((0.1 + 0.2) + 0.3) + 0.7;
        for (sum, largest) in results.unwrap() {
            assert_eq!(sum, [expected, -expected]);
            assert!(largest[0] == 0.7 && largest[1].is_nan());
        }
    }

    #[test]
    fn on_many_ranks_groups_are_added_first() {
        let values = [0.1, 0.2, 0.3, 0.7, 1e-17];
        let results = Threads::run_in_groups(2, 5, |team| {
            let mut sum = [values[team.rank()]];
            team.sum("sum", &mut sum);
            let mut largest = [values[team.rank()]];
            team.largest("largest", &mut largest);
            [sum[0], largest[0]]
        });
        assert_eq!(results.unwrap(), [[((0.1 + 0.2) + (0.3 + 0.7)) + 1e-17, 0.7]; 5]);
    }

    #[test]
    fn parcels_reach_their_ranks() {
        let results = Threads::run(3, |team| {
            let others = (0..3).filter(|&rank| rank != team.rank());
            let to = |rank: usize| vec![10.0 * team.rank() as f64 + rank as f64; 1 + team.rank()];
            let parcel = |rank: usize| Parcel { rank, outgoing: to(rank), incoming: vec![0.0; 1 + rank] };
            let mut parcels: Vec<Parcel> = others.map(parcel).collect();
            team.exchange("parcels", &mut parcels);
            parcels.into_iter().map(|parcel| parcel.incoming).collect::<Vec<_>>()
        });
        assert_eq!(results.unwrap()[1], [vec![1.0], vec![21.0; 3]]);
    }

    #[test]
    fn calls_that_do_not_match_end_all_ranks() {
        let error = Threads::run(3, |team| match team.rank() {
            0 => team.largest("flag", &mut [0.0]),
            _ => team.sum("mass", &mut [0.0; 3]),
        });
        let message = error.unwrap_err().to_string();
        assert!(
            message.contains("the largest \"flag\" of 1") && message.contains("the sum \"mass\" of 3"),
            "{message}"
        );
    }

    #[test]
    fn a_panic_ends_all_ranks_and_is_reported() {
        let error = Threads::run(2, |team| {
            assert!(team.rank() == 0, "no such luck");
            team.sum("never complete", &mut [0.0]);
        });
        assert_eq!(error, Err(ThreadsError::Panic { rank: 1, message: "no such luck".to_string() }));
    }
}
