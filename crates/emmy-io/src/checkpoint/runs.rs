//! Runs of nodes and pressures with consecutive numbers: what blocks have, and what a body needs.

use emmy::body::Body;
use emmy::internals::body::Entries;

/// Consecutive entries, which have consecutive numbers in the whole body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Run {
    /// Number of the first one in the whole body.
    pub(super) number: u64,
    /// Place of the first one in a list.
    pub(super) place: u64,
    pub(super) length: u64,
}

impl Run {
    pub(super) fn end(self) -> u64 {
        self.number + self.length
    }

    /// The run without its first entries.
    fn after(self, n: u64) -> Run {
        Run { number: self.number + n, place: self.place + n, length: self.length - n }
    }
}

/// Runs of nodes and of pressures, by ascending numbers.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Runs(pub(super) [Vec<Run>; 2]);

impl Runs {
    /// Some entries of a body; `is_chosen(kind, place, counts)`.
    fn of(body: &Body, is_chosen: impl Fn(Entries, u64, bool) -> bool) -> Self {
        Runs([Entries::Nodes, Entries::Local].map(|kind| {
            let mut runs: Vec<Run> = Vec::new();
            for (place, (number, counts)) in (0..).zip(body.entries(kind)) {
                match runs.last_mut() {
                    _ if !is_chosen(kind, place, counts) => {}
                    Some(run) if run.end() == number && run.place + run.length == place => run.length += 1,
                    _ => runs.push(Run { number, place, length: 1 }),
                }
            }
            runs.sort_unstable_by_key(|run| run.number);
            runs
        }))
    }

    /// The entries of which this rank writes the numbers.
    pub(super) fn counted(body: &Body) -> Self {
        Runs::of(body, |_, _, counts| counts)
    }

    /// The entries of which this rank needs the numbers.
    pub(super) fn needed(body: &Body) -> Self {
        Runs::of(body, |_, _, _| true)
    }

    /// The nodes among them.
    pub(super) fn needed_of_nodes(body: &Body) -> Self {
        Runs::of(body, |kind, _, _| kind == Entries::Nodes)
    }

    /// The nodes of the mesh among them.
    pub(super) fn needed_of_mesh(body: &Body) -> Self {
        let n = body.mesh().n_nodes() as u64;
        Runs::of(body, |kind, place, _| kind == Entries::Nodes && place < n)
    }

    pub(super) fn of_kind(&self, kind: Entries) -> &[Run] {
        &self.0[kind as usize]
    }

    pub(super) fn n_entries(&self) -> [u64; 2] {
        [0, 1].map(|kind| self.0[kind].iter().map(|run| run.length).sum())
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.iter().all(Vec::is_empty)
    }

    /// The numbers that a block has, as copies, and the entries that remain.
    pub(super) fn split(&self, block: &Runs) -> (Copies, Runs) {
        let [nodes, pressures] = [0, 1].map(|kind| split(&self.0[kind], &block.0[kind]));
        (Copies([nodes.0, pressures.0]), Runs([nodes.1, pressures.1]))
    }
}

/// Entries to copy from a block to a list: place in the block, place in the list, number of entries.
pub(super) struct Copies(pub(super) [Vec<[usize; 3]>; 2]);

/// The numbers that the runs of a block have of those needed, and the runs that remain.
fn split(needed: &[Run], block: &[Run]) -> (Vec<[usize; 3]>, Vec<Run>) {
    let (mut copies, mut rest) = (Vec::new(), Vec::new());
    let mut block = block.iter().copied().peekable();
    for mut run in needed.iter().copied() {
        while run.length > 0 {
            while block.next_if(|given| given.end() <= run.number).is_some() {}
            let Some(given) = block.peek().filter(|given| given.number < run.end()) else {
                rest.push(run);
                break;
            };
            let gap = given.number.saturating_sub(run.number);
            if gap > 0 {
                rest.push(Run { length: gap, ..run });
                run = run.after(gap);
            }
            let given = given.after(run.number - given.number);
            let length = given.length.min(run.length);
            copies.push([given.place, run.place, length].map(|n| n as usize));
            run = run.after(length);
        }
    }
    (copies, rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn runs(of: &[[u64; 3]]) -> Vec<Run> {
        of.iter().map(|&[number, place, length]| Run { number, place, length }).collect()
    }

    #[test]
    fn numbers_are_found_in_blocks() {
        // Needed: 2 to 9, and 20 and 21. The block has 0 to 3, 5 and 6, and 21 to 24.
        let needed = runs(&[[2, 100, 8], [20, 0, 2]]);
        let block = runs(&[[0, 0, 4], [5, 4, 2], [21, 6, 4]]);
        let (copies, rest) = split(&needed, &block);
        assert_eq!(copies, [[2, 100, 2], [4, 103, 2], [6, 1, 1]]);
        assert_eq!(rest, runs(&[[4, 102, 1], [7, 105, 3], [20, 0, 1]]));
        assert_eq!(split(&rest, &runs(&[[0, 0, 50]])).1, []);
        assert_eq!(split(&needed, &[]), (Vec::new(), needed.clone()));
    }
}
