//! Blocks of a checkpoint: the numbers of nodes and cells, one block for each rank that wrote.
//!
//! | part of a block | content |
//! |---|---|
//! | runs of nodes, then of pressures | first number in the whole body and length of each, as u64, ascending |
//! | numbers | list by list, `[parts][entries of the block][width]`, as f64 |
//! | checksum | CRC-32 of the block |
//!
//! All numbers have the lowest byte first. The numbers of entries do not depend on the ranks, so that any number of ranks reads
//! what another number of ranks wrote.

use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};

use crc32fast::Hasher;
use emmy::body::Body;
use emmy::internals::body::Entries;
use emmy::motion::Snapshot;
use emmy::team::Team;
use serde::{Deserialize, Serialize};

/// Bytes that are read or written at once.
const CHUNK: usize = 1 << 16;

/// Larger shapes of lists are not plausible.
const LARGEST_SHAPE: u64 = 1000;

const NOT_FINITE: &str = "has a state that is not finite";

/// Consecutive entries, which have consecutive numbers in the whole body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Run {
    /// Number of the first one in the whole body.
    number: u64,
    /// Place of the first one in a list.
    place: u64,
    length: u64,
}

impl Run {
    fn end(self) -> u64 {
        self.number + self.length
    }

    /// The run without its first entries.
    fn after(self, n: u64) -> Run {
        Run { number: self.number + n, place: self.place + n, length: self.length - n }
    }
}

/// Runs of nodes and of pressures, by ascending numbers.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Runs([Vec<Run>; 2]);

impl Runs {
    /// Some entries of a body; `is_chosen(kind, place, counts)`.
    fn of(body: &Body, is_chosen: impl Fn(Entries, u64, bool) -> bool) -> Self {
        Runs([Entries::Nodes, Entries::Pressures].map(|kind| {
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

    fn of_kind(&self, kind: Entries) -> &[Run] {
        &self.0[kind as usize]
    }

    fn n_entries(&self) -> [u64; 2] {
        [0, 1].map(|kind| self.0[kind].iter().map(|run| run.length).sum())
    }

    fn is_empty(&self) -> bool {
        self.0.iter().all(Vec::is_empty)
    }

    /// The numbers that a block has, as copies, and the entries that remain.
    fn split(&self, block: &Runs) -> (Copies, Runs) {
        let [nodes, pressures] = [0, 1].map(|kind| split(&self.0[kind], &block.0[kind]));
        (Copies([nodes.0, pressures.0]), Runs([nodes.1, pressures.1]))
    }
}

/// Entries to copy from a block to a list: place in the block, place in the list, number of entries.
struct Copies([Vec<[usize; 3]>; 2]);

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

/// A list of numbers of entries, `[parts][n_entries][width]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct ListShape {
    name: String,
    entries: Entries,
    parts: u64,
    width: u64,
}

impl ListShape {
    /// The shape of a list of some length with n entries.
    fn of(name: String, entries: Entries, length: usize, n: u64) -> Self {
        let of_entry = length as u64 / n.max(1);
        let [parts, width] = match entries {
            Entries::Nodes => [of_entry / 3, 3],
            Entries::Pressures => [1, of_entry],
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
struct BlockShape {
    runs: [u64; 2],
    entries: [u64; 2],
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
    /// Bytes of a block; `None`: more than a file can have.
    fn size(&self, block: &BlockShape) -> Option<u64> {
        let runs = block.runs.iter().try_fold(0u64, |sum, n| sum.checked_add(n.checked_mul(16)?))?;
        self.lists.iter().try_fold(runs.checked_add(4)?, |sum, list| {
            let n = block.entries[list.entries as usize].checked_mul(8 * list.parts * list.width)?;
            sum.checked_add(n)
        })
    }

    /// Sets the place of the first block in the file, and returns that of its end; `None`: no file is like this.
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

    /// Checks the blocks of which a rank of a team has the care.
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
        let near = body.subdomain().map_or(vec![0], |part| {
            std::iter::once(part.rank())
                .chain(part.neighbours())
                .filter(|&rank| rank < self.blocks.len())
                .collect()
        });
        let far = (0..self.blocks.len()).filter(|block| !near.contains(block));
        let order: Vec<usize> = near.iter().copied().chain(far).collect();
        self.fill(needed, &order, input, snapshot)
    }

    /// Reads the lists of a snapshot of the whole body, in the order of the numbers of entries; returns those.
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

/// The lists of a rank.
pub(super) struct Part {
    runs: Runs,
    /// Numbers of entries of the lists, those that do not count included.
    n_entries: [u64; 2],
    lists: Vec<(ListShape, Vec<f64>)>,
}

impl Part {
    /// Takes the lists out of a snapshot of a body, or of the part of a rank.
    pub(super) fn take(snapshot: &mut Snapshot, body: &Body) -> Self {
        let n_entries = [Entries::Nodes, Entries::Pressures].map(|kind| body.entries(kind).count() as u64);
        Part::new(snapshot, Runs::counted(body), n_entries)
    }

    /// Takes the lists out of a snapshot with the entries of a whole body.
    pub(super) fn take_whole(snapshot: &mut Snapshot, runs: &Runs) -> Self {
        Part::new(snapshot, runs.clone(), runs.n_entries())
    }

    fn new(snapshot: &mut Snapshot, runs: Runs, n_entries: [u64; 2]) -> Self {
        let lists = snapshot.lists_mut().map(|(name, entries, list)| {
            let shape = ListShape::of(name, entries, list.len(), n_entries[entries as usize]);
            (shape, std::mem::take(list))
        });
        Part { lists: lists.collect(), runs, n_entries }
    }

    /// The lists and blocks of all ranks.
    pub(super) fn table(&mut self, team: &dyn Team) -> Table {
        // A rank without pressures does not know their number.
        let shape = |(shape, _): &(ListShape, Vec<f64>)| [shape.parts as f64, shape.width as f64];
        let mut shapes: Vec<f64> = self.lists.iter().flat_map(shape).collect();
        team.largest("shapes of lists", &mut shapes);
        for ((own, _), shape) in self.lists.iter_mut().zip(shapes.as_chunks::<2>().0) {
            [own.parts, own.width] = shape.map(|n| n as u64);
        }
        let [[r, s], [n, m]] = [[0, 1].map(|kind| self.runs.0[kind].len() as u64), self.runs.n_entries()];
        let mut blocks = vec![[0.0; 4]; team.size()];
        blocks[team.rank()] = [r, s, n, m].map(|n| n as f64);
        team.sum("blocks of a checkpoint", blocks.as_flattened_mut());
        let block = |block: [f64; 4]| {
            let [r, s, n, m] = block.map(|n| n as u64);
            BlockShape { runs: [r, s], entries: [n, m] }
        };
        Table {
            lists: self.lists.iter().map(|(shape, _)| shape.clone()).collect(),
            blocks: blocks.into_iter().map(block).collect(),
            places: Vec::new(),
        }
    }

    /// Writes the block.
    ///
    /// # Errors
    /// Errors of the system.
    pub(super) fn write(&self, output: &mut impl Write) -> io::Result<()> {
        let mut output = Summed { output, sum: Hasher::new(), bytes: Vec::with_capacity(CHUNK + 16) };
        for run in self.runs.0.iter().flatten() {
            output.put(run.number.to_le_bytes())?;
            output.put(run.length.to_le_bytes())?;
        }
        for (shape, numbers) in &self.lists {
            let width = shape.width as usize;
            let length = self.n_entries[shape.entries as usize] as usize * width;
            for part in numbers.chunks_exact(length.max(1)) {
                for run in self.runs.of_kind(shape.entries) {
                    let first = run.place as usize * width;
                    let of_run = &part[first..first + run.length as usize * width];
                    of_run.iter().try_for_each(|number| output.put(number.to_le_bytes()))?;
                }
            }
        }
        output.finish()
    }
}

/// Bytes that are written with their checksum.
struct Summed<W> {
    output: W,
    sum: Hasher,
    bytes: Vec<u8>,
}

impl<W: Write> Summed<W> {
    fn put(&mut self, number: [u8; 8]) -> io::Result<()> {
        self.bytes.extend(number);
        if self.bytes.len() < CHUNK { Ok(()) } else { self.flush() }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.sum.update(&self.bytes);
        self.output.write_all(&self.bytes)?;
        self.bytes.clear();
        Ok(())
    }

    fn finish(mut self) -> io::Result<()> {
        self.flush()?;
        self.output.write_all(&self.sum.finalize().to_le_bytes())
    }
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

    #[test]
    fn sizes_that_no_file_has_are_rejected() {
        let list = |parts, width| ListShape { name: "u".to_string(), entries: Entries::Nodes, parts, width };
        let end = |list, entries| {
            let blocks = vec![BlockShape { runs: [1, 0], entries: [entries, 0] }];
            Table { lists: vec![list], blocks, places: Vec::new() }.begin_at(10)
        };
        assert_eq!(end(list(2, 3), 5), Some(10 + 16 + 2 * 3 * 5 * 8 + 4));
        assert_eq!(end(list(2, 3), u64::MAX / 8), None);
        assert_eq!(end(list(0, LARGEST_SHAPE + 1), 5), None);
    }
}
