//! The block that a rank writes.

use std::io::{self, Write};

use crc32fast::Hasher;
use emmy::body::Body;
use emmy::internals::body::Entries;
use emmy::motion::Snapshot;
use emmy::team::Team;

use super::blocks::{BlockShape, CHUNK, ListShape, Table};
use super::runs::Runs;

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
        let n_entries = [Entries::Nodes, Entries::Local].map(|kind| body.entries(kind).count() as u64);
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
        let lists = self.lists.iter().map(|(shape, _)| shape.clone());
        Table::new(lists.collect(), blocks.into_iter().map(block).collect())
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
