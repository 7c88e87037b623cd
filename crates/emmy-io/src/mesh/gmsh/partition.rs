//! Files that are one part of a mesh in partitions.

use std::collections::{BTreeSet, HashMap};

use crate::message::counted;

/// Partitions of a mesh, and the elements that are copies for a neighbour (ghosts).
#[derive(Default)]
pub(super) struct Partitions {
    /// Number of partitions of the whole mesh, if the file says it.
    pub(super) count: Option<u64>,
    /// Partitions whose files have a copy of an element, by its number.
    ghosts: HashMap<u64, Vec<u64>>,
}

impl Partitions {
    /// Notes that the file of a partition has a copy of an element.
    pub(super) fn add_ghost(&mut self, element: u64, partition: u64) {
        self.ghosts.entry(element).or_default().push(partition);
    }

    /// Whether an element is only a copy in the file of a partition.
    pub(super) fn is_ghost(&self, element: u64, home: u64) -> bool {
        self.ghosts.get(&element).is_some_and(|partitions| partitions.contains(&home))
    }

    /// The partition to which the file belongs: the only one that has every cell, as its own or as a copy. `cells`
    /// have their numbers and partitions (0: none, as MSH 4 has it for copies).
    pub(super) fn home(&self, cells: impl Iterator<Item = (u64, u64)>) -> Option<u64> {
        let mut homes: Option<BTreeSet<u64>> = None;
        for (number, partition) in cells {
            let homes = homes.get_or_insert_with(|| {
                self.ghosts.get(&number).into_iter().flatten().copied().chain([partition]).collect()
            });
            homes.retain(|&home| home > 0 && (home == partition || self.is_ghost(number, home)));
            if homes.is_empty() {
                return None;
            }
        }
        homes.filter(|homes| homes.len() == 1)?.pop_first()
    }

    /// Remarks on a file of the partition `home`, without its copies of `n_ghosts` elements.
    pub(super) fn notes(&self, home: u64, n_ghosts: usize) -> Vec<String> {
        let ghosts = counted(n_ghosts, "ghost element is", "ghost elements are");
        let ghosts = (n_ghosts > 0).then(|| format!("{ghosts} left out"));
        let part = match self.count {
            Some(0 | 1) => None,
            Some(n) => {
                Some(format!("the file has only partition {home} of {n}; the others are in other files"))
            }
            None => Some(format!(
                "all cells belong to partition {home}; those of other partitions, if there are any, are in other files"
            )),
        };
        ghosts.into_iter().chain(part).collect()
    }
}
