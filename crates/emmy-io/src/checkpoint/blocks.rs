//! Blocks of a checkpoint: the numbers of nodes and cells, one block for each rank that wrote.
//!
//! | part of a block | content |
//! |---|---|
//! | runs of nodes, then of pressures | first number in the whole body and length of each, as u64, ascending |
//! | numbers | list by list, `[parts][entries of the block][width]`, as f64 |
//! | checksum | CRC-32 of the block |
//!
//! All numbers have the lowest byte first. The numbers of entries do not depend on the ranks, so that any number of
//! ranks reads what another number of ranks wrote.

use std::io::{ErrorKind, Read, Seek, SeekFrom};

use crc32fast::Hasher;
use emmy::body::Body;
use emmy::internals::body::Entries;
use emmy::motion::Snapshot;
use emmy::team::Team;
use serde::{Deserialize, Serialize};

use super::runs::{Run, Runs};

/// Bytes that are read or written at once.
pub(super) const CHUNK: usize = 1 << 16;

/// Larger shapes of lists are not plausible.
const LARGEST_SHAPE: u64 = 1000;

const NOT_FINITE: &str = "has a state that is not finite";

/// A list of numbers of entries, `[parts][n_entries][width]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct ListShape {
    pub(super) name: String,
    pub(super) entries: Entries,
    pub(super) parts: u64,
    pub(super) width: u64,
}

impl ListShape {
    /// The shape of a list of some length with n entries.
    pub(super) fn of(name: String, entries: Entries, length: usize, n: u64) -> Self {
        let of_entry = length as u64 / n.max(1);
        let [parts, width] = match entries {
            Entries::Nodes => [of_entry / 3, 3],
            Entries::Local => [1, of_entry],
        };
        debug_assert_eq!(parts * width * n, length as u64, "{name}");
        ListShape { name, entries, parts, width }
    }

    fn is_plausible(&self) -> bool {
        self.parts <= LARGEST_SHAPE && self.width <= LARGEST_SHAPE
    }

    /// Whether it belongs to the state.
    fn is_state(&self) -> bool {
        self.name.starts_with("state.")
    }
}

/// Numbers of runs and entries of a block.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct BlockShape {
    pub(super) runs: [u64; 2],
    pub(super) entries: [u64; 2],
}

/// The lists and blocks of a checkpoint.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Table {
    lists: Vec<ListShape>,
    blocks: Vec<BlockShape>,
    /// Places of the blocks in the file, and of its end.
    #[serde(skip)]
    places: Vec<u64>,
}

impl Table {
    pub(super) fn new(lists: Vec<ListShape>, blocks: Vec<BlockShape>) -> Self {
        Table { lists, blocks, places: Vec::new() }
    }

    /// Bytes of a block; `None`: more than a file can have.
    fn size(&self, block: &BlockShape) -> Option<u64> {
        let runs = block.runs.iter().try_fold(0u64, |sum, n| sum.checked_add(n.checked_mul(16)?))?;
        self.lists.iter().try_fold(runs.checked_add(4)?, |sum, list| {
            let n = block.entries[list.entries as usize].checked_mul(8 * list.parts * list.width)?;
            sum.checked_add(n)
        })
    }

    /// Sets the place of the first block in the file and returns the place of its end; `None`: no file has such lists.
    pub(super) fn begin_at(&mut self, start: u64) -> Option<u64> {
        self.lists.iter().all(ListShape::is_plausible).then_some(())?;
        let mut places = vec![start];
        let mut end = start;
        for block in &self.blocks {
            end = end.checked_add(self.size(block)?)?;
            places.push(end);
        }
        self.places = places;
        Some(end)
    }

    /// Place of a block in the file.
    pub(super) fn place(&self, block: usize) -> u64 {
        self.places[block]
    }

    fn damaged(&self, block: usize) -> String {
        match self.blocks.len() {
            1 => "is damaged".to_string(),
            n => format!("is damaged in block {} of {n}", block + 1),
        }
    }

    /// Checks the blocks that a rank of a team is responsible for.
    ///
    /// # Errors
    /// The predicate of a sentence about the file.
    pub(super) fn verify(&self, input: &mut (impl Read + Seek), team: &dyn Team) -> Result<(), String> {
        for block in (team.rank()..self.blocks.len()).step_by(team.size()) {
            Block::open(self, input, block)?.0.read(|_, _, _| {})?;
        }
        Ok(())
    }

    /// Reads the lists of a snapshot for a body, or for the part of a rank, at the entries needed.
    ///
    /// # Errors
    /// The predicate of a sentence about the file.
    pub(super) fn fill_for(
        &self,
        body: &Body,
        needed: Runs,
        input: &mut (impl Read + Seek),
        snapshot: &mut Snapshot,
    ) -> Result<(), String> {
        // With the same division, all numbers are in the blocks of this rank and its neighbours.
        let ranks = body.ranks();
        let near = std::iter::once(ranks.rank()).chain(ranks.neighbours());
        let near: Vec<usize> = near.filter(|&rank| rank < self.blocks.len()).collect();
        let far = (0..self.blocks.len()).filter(|block| !near.contains(block));
        let order: Vec<usize> = near.iter().copied().chain(far).collect();
        self.fill(needed, &order, input, snapshot)
    }

    /// Reads the lists of a snapshot of the whole body in the order of its entries, and returns their numbers.
    ///
    /// # Errors
    /// The predicate of a sentence about the file.
    pub(super) fn fill_whole(
        &self,
        input: &mut (impl Read + Seek),
        snapshot: &mut Snapshot,
    ) -> Result<Runs, String> {
        let mut all = Runs::default();
        for block in 0..self.blocks.len() {
            let of_block = Block::open(self, input, block)?.1;
            all.0.iter_mut().zip(of_block.0).for_each(|(all, of_block)| all.extend(of_block));
        }
        for runs in &mut all.0 {
            runs.sort_unstable_by_key(|run| run.number);
            if runs.windows(2).any(|pair| pair[0].end() > pair[1].number) {
                return Err("has the numbers of a node or cell twice".to_string());
            }
            let mut place = 0;
            for run in runs {
                run.place = place;
                place += run.length;
            }
        }
        self.fill(all.clone(), &Vec::from_iter(0..self.blocks.len()), input, snapshot)?;
        Ok(all)
    }

    /// Reads the lists of a snapshot at some entries from blocks in some order.
    fn fill(
        &self,
        mut needed: Runs,
        order: &[usize],
        input: &mut (impl Read + Seek),
        snapshot: &mut Snapshot,
    ) -> Result<(), String> {
        let n_entries = needed.n_entries();
        let mut targets: Vec<Option<&mut Vec<f64>>> = self.lists.iter().map(|_| None).collect();
        for (name, entries, list) in snapshot.lists_mut() {
            let index = self.lists.iter().position(|own| own.name == name && own.entries == entries);
            let index = index.ok_or_else(|| format!("has no list {name}"))?;
            let ListShape { parts, width, .. } = self.lists[index];
            list.resize((parts * width * n_entries[entries as usize]) as usize, 0.0);
            targets[index] = Some(list);
        }
        for &block in order {
            let (block, runs) = Block::open(self, input, block)?;
            let (copies, rest) = needed.split(&runs);
            if copies.0.iter().all(Vec::is_empty) {
                continue;
            }
            block.read(|list, part, numbers| {
                let Some(target) = &mut targets[list] else { return };
                let (kind, width) = (self.lists[list].entries as usize, self.lists[list].width as usize);
                let target = &mut target[part * n_entries[kind] as usize * width..];
                for [from, to, n] in copies.0[kind].iter().map(|copy| copy.map(|n| n * width)) {
                    target[to..to + n].copy_from_slice(&numbers[from..from + n]);
                }
            })?;
            needed = rest;
            if needed.is_empty() {
                break;
            }
        }
        match needed.n_entries() {
            [0, 0] => Ok(()),
            [0, n] => Err(format!("has no pressures of {n} functions in the cells of this body")),
            [n, _] => Err(format!("has no numbers of {n} nodes of this body")),
        }
    }
}

/// A block that is being read.
struct Block<'a, R> {
    table: &'a Table,
    index: usize,
    input: &'a mut R,
    sum: Hasher,
    bytes: Vec<u8>,
}

impl<'a, R: Read + Seek> Block<'a, R> {
    /// The block, and its runs with their places in it.
    fn open(table: &'a Table, input: &'a mut R, index: usize) -> Result<(Self, Runs), String> {
        input.seek(SeekFrom::Start(table.place(index))).map_err(|error| error.to_string())?;
        let mut block = Block { table, index, input, sum: Hasher::new(), bytes: Vec::new() };
        let mut runs = Runs::default();
        for (kind, runs) in runs.0.iter_mut().enumerate() {
            block.read_runs(kind, runs)?;
        }
        Ok((block, runs))
    }

    fn damaged<T>(&self) -> Result<T, String> {
        Err(self.table.damaged(self.index))
    }

    fn read_runs(&mut self, kind: usize, runs: &mut Vec<Run>) -> Result<(), String> {
        let BlockShape { runs: n_runs, entries } = &self.table.blocks[self.index];
        let (mut place, mut last) = (0, 0);
        for _ in 0..n_runs[kind] {
            self.read_bytes(16)?;
            let (numbers, _) = self.bytes.as_chunks::<8>();
            let [number, length] = [0, 1].map(|i| u64::from_le_bytes(numbers[i]));
            let is_ascending = number >= last && length > 0;
            let Some(end) = number.checked_add(length).filter(|_| is_ascending) else {
                return self.damaged();
            };
            runs.push(Run { number, place, length });
            (place, last) = (place.saturating_add(length), end);
        }
        if place == entries[kind] { Ok(()) } else { self.damaged() }
    }

    /// Reads some bytes, at most a chunk.
    fn read_bytes(&mut self, n: usize) -> Result<(), String> {
        self.bytes.resize(n, 0);
        match self.input.read_exact(&mut self.bytes) {
            Ok(()) => {}
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => return self.damaged(),
            Err(error) => return Err(error.to_string()),
        }
        self.sum.update(&self.bytes);
        Ok(())
    }

    /// Calls a function with each part of each list: number of the list, of the part, and the numbers.
    fn read(mut self, mut visit: impl FnMut(usize, usize, &[f64])) -> Result<(), String> {
        let Table { lists, blocks, .. } = self.table;
        let mut numbers = Vec::new();
        let mut is_finite = true;
        for (index, list) in lists.iter().enumerate() {
            let n = (blocks[self.index].entries[list.entries as usize] * list.width) as usize;
            for part in 0..list.parts as usize {
                self.read_numbers(n, &mut numbers)?;
                is_finite &= !list.is_state() || numbers.iter().all(|number| number.is_finite());
                visit(index, part, &numbers);
            }
        }
        let sum = self.sum.clone().finalize();
        self.read_bytes(4)?;
        match is_finite {
            _ if self.bytes != sum.to_le_bytes() => self.damaged(),
            true => Ok(()),
            false => Err(NOT_FINITE.to_string()),
        }
    }

    fn read_numbers(&mut self, n: usize, numbers: &mut Vec<f64>) -> Result<(), String> {
        numbers.clear();
        while numbers.len() < n {
            self.read_bytes((8 * (n - numbers.len())).min(CHUNK))?;
            numbers.extend(self.bytes.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes)));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_that_no_file_has_are_rejected() {
        let list = |parts, width| ListShape { name: "u".to_string(), entries: Entries::Nodes, parts, width };
        let end = |list, entries| {
            let blocks = vec![BlockShape { runs: [1, 0], entries: [entries, 0] }];
            Table::new(vec![list], blocks).begin_at(10)
        };
        assert_eq!(end(list(2, 3), 5), Some(10 + 16 + 2 * 3 * 5 * 8 + 4));
        assert_eq!(end(list(2, 3), u64::MAX / 8), None);
        assert_eq!(end(list(0, LARGEST_SHAPE + 1), 5), None);
    }
}
