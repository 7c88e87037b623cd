//! The file of a checkpoint.
//!
//! | part | content |
//! |---|---|
//! | header | `emmy checkpoint 4, Emmy 0.1.0` and a line feed: the format, and the version of Emmy that wrote the file |
//! | length of the head | 8 bytes |
//! | head | a [`Checkpoint`] without the numbers of nodes and cells, and the table of the blocks, as MessagePack, every field with its name |
//! | checksum | CRC-32 of all bytes before |
//! | blocks | the numbers of nodes and cells: [`super::blocks`] |
//!
//! Integers have the lowest byte first.

use std::fs::{File, OpenOptions};
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::Path;

use emmy::motion::State;
use emmy::team::{self, Team};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::Checkpoint;
use super::blocks::Table;
use super::part::Part;
use crate::stored;
use crate::whole_file::{PART, named, put, with_ending};

/// Number of the format; a file of any other format is rejected.
const FORMAT: u32 = 4;

const MARK: &str = "emmy checkpoint ";
const VERSION: &str = env!("CARGO_PKG_VERSION");
const DAMAGED: &str = "is damaged";

/// Longest header.
const MAX_HEADER: u64 = 200;

/// Larger counts are not plausible.
const LARGEST_COUNT: u64 = 1 << 40;

/// Largest number of halvings of a step; with more, the number of parts would overflow.
const MAX_HALVINGS: u32 = 60;

/// A checkpoint without the numbers of nodes and cells, and the table of its blocks.
#[derive(Serialize, Deserialize)]
struct Head<C> {
    checkpoint: C,
    table: Table,
}

/// The bytes before the blocks.
fn head(checkpoint: &Checkpoint, table: Table) -> io::Result<Vec<u8>> {
    let content = rmp_serde::to_vec_named(&Head { checkpoint, table }).map_err(io::Error::other)?;
    let mut bytes = format!("{MARK}{FORMAT}, Emmy {VERSION}\n").into_bytes();
    bytes.extend((content.len() as u64).to_le_bytes());
    bytes.extend(content);
    bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
    Ok(bytes)
}

/// The bytes of the file with the lists of one rank that has all of them.
///
/// # Errors
/// None in practice: every checkpoint can be written.
pub(super) fn bytes(checkpoint: &Checkpoint, mut part: Part) -> io::Result<Vec<u8>> {
    let mut bytes = head(checkpoint, part.table(&team::Alone))?;
    part.write(&mut bytes)?;
    Ok(bytes)
}

/// Writes the file, each rank its own lists, and syncs it if `is_safe`; a collective call.
///
/// # Errors
/// Errors of the system on any rank, with the path; the earlier file then remains.
pub(super) fn write(
    path: &Path,
    checkpoint: &Checkpoint,
    mut part: Part,
    team: &dyn Team,
    is_safe: bool,
) -> io::Result<()> {
    let unfinished = with_ending(path, PART);
    let is_first = team.rank() == 0;
    let mut table = part.table(team);
    let create = || {
        let head = head(checkpoint, table.clone())?;
        let mut file = File::create(&unfinished)?;
        file.write_all(&head)?;
        Ok((file, head.len()))
    };
    let created = agree(team, is_first.then(create).transpose());
    let written = created.and_then(|created| {
        let mut start = [created.as_ref().map_or(0.0, |(_, length)| *length as f64)];
        team.sum("length of the head", &mut start);
        let write = || {
            table.begin_at(start[0] as u64).ok_or_else(|| io::Error::from(ErrorKind::FileTooLarge))?;
            let mut file = match created {
                Some((file, _)) => file,
                None => OpenOptions::new().write(true).open(&unfinished)?,
            };
            file.seek(SeekFrom::Start(table.place(team.rank())))?;
            part.write(&mut file)?;
            if is_safe { file.sync_all() } else { Ok(()) }
        };
        agree(team, write())
    });
    if is_first && written.is_err() {
        // The disk may be full. If the removal fails too, the first error says more.
        let _ = std::fs::remove_file(&unfinished);
    }
    written.map_err(named(path))?;
    agree(team, if is_first { put(path, is_safe) } else { Ok(()) })
}

/// The same outcome on all ranks.
pub(super) fn agree<T>(team: &dyn Team, own: io::Result<T>) -> io::Result<T> {
    team::agree(team, own, io::Error::other)
}

/// A checkpoint from its file, without the numbers of nodes and cells, and the table of its blocks.
///
/// # Errors
/// Why the file cannot be used, as the predicate of a sentence about it.
pub(super) fn read(input: &mut (impl Read + Seek)) -> Result<(Checkpoint, Table), String> {
    let bytes = start(input).map_err(|error| error.to_string())?;
    let rest = bytes.strip_prefix(MARK.as_bytes()).ok_or("is not a checkpoint")?;
    let end = rest.iter().position(|&byte| byte == b'\n').ok_or(DAMAGED)?;
    check_format(&rest[..end])?;
    let before_sum = stored::verified(&bytes).ok_or(DAMAGED)?;
    let content = before_sum.get(MARK.len() + end + 1 + 8..).ok_or(DAMAGED)?;
    let Head { checkpoint, mut table } = rmp_serde::from_slice(content)
        .map_err(|error| format!("does not have the content of checkpoint format {FORMAT} ({error})"))?;
    let length = input.seek(SeekFrom::End(0)).map_err(|error| error.to_string())?;
    if table.begin_at(bytes.len() as u64) != Some(length) {
        return Err(DAMAGED.to_string());
    }
    check(&checkpoint)?;
    Ok((checkpoint, table))
}

/// The bytes before the blocks, as far as they are there.
fn start(input: &mut (impl Read + Seek)) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    input.seek(SeekFrom::Start(0))?;
    input.by_ref().take(MAX_HEADER).read_to_end(&mut bytes)?;
    let length = head_length(&bytes).unwrap_or(bytes.len());
    input.seek(SeekFrom::Start(0))?;
    bytes.clear();
    input.by_ref().take(length as u64).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Number of bytes before the blocks, from the first of them.
fn head_length(bytes: &[u8]) -> Option<usize> {
    let place = bytes.iter().position(|&byte| byte == b'\n')? + 1;
    let length = u64::from_le_bytes(*bytes.get(place..)?.first_chunk()?);
    (place + 8 + 4).checked_add(usize::try_from(length).ok()?)
}

/// The bytes of a file of one block with right checksums, whatever else is damaged: for tests of the content.
pub(super) fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let (start, end) = (head_length(&bytes).unwrap_or(0), bytes.len());
    for (from, end) in [(0, start), (start, end)] {
        if end <= bytes.len() && from + 4 <= end {
            let sum = crc32fast::hash(&bytes[from..end - 4]);
            bytes[end - 4..end].copy_from_slice(&sum.to_le_bytes());
        }
    }
    bytes
}

/// Rejects a header of another format.
fn check_format(header: &[u8]) -> Result<(), String> {
    let header = str::from_utf8(header).map_err(|_| DAMAGED)?;
    let (format, writer) =
        header.split_once(", ").unwrap_or((header, "a development version before Emmy 0.1.0"));
    if format.parse() != Ok(FORMAT) && is_header(format, writer) {
        return Err(format!(
            "has checkpoint format {format}, which {writer} reads; Emmy {VERSION} reads format {FORMAT} only"
        ));
    }
    Ok(())
}

/// Whether a header can be quoted.
fn is_header(format: &str, writer: &str) -> bool {
    let is_short = format.len() <= 4 && writer.len() <= 50;
    is_short && format.bytes().all(|byte| byte.is_ascii_digit()) && writer.chars().all(|c| !c.is_control())
}

/// Rejects values that no run writes and that would fail later.
fn check(checkpoint: &Checkpoint) -> Result<(), String> {
    let snapshot = &checkpoint.snapshot;
    if !is_finite(&snapshot.state) {
        return Err("has a state that is not finite".into());
    }
    if snapshot.subdivision.halvings > MAX_HALVINGS {
        return Err("has a step that is halved too often".into());
    }
    let counts = json!([
        snapshot.state.step,
        snapshot.record,
        snapshot.statistics,
        snapshot.subdivision,
        snapshot.releases,
        checkpoint.frames
    ]);
    match largest_count(&counts) {
        count if count > LARGEST_COUNT => Err(format!("has a count of {count}, which no run reaches")),
        _ => Ok(()),
    }
}

/// Whether all numbers of a state are finite.
pub(super) fn is_finite(state: &State) -> bool {
    let State {
        time,
        step: _,
        displacement,
        momentum,
        velocity,
        displacement_low,
        momentum_error,
        is_equilibrium: _,
        history,
        coordinates,
    } = state;
    let lists =
        [displacement, momentum, velocity, displacement_low, &momentum_error[..], history, coordinates];
    time.is_finite() && lists.iter().all(|list| list.iter().all(|number| number.is_finite()))
}

fn largest_count(value: &Value) -> u64 {
    match value {
        Value::Number(number) => number.as_u64().unwrap_or(0),
        Value::Array(items) => items.iter().map(largest_count).max().unwrap_or(0),
        Value::Object(fields) => fields.values().map(largest_count).max().unwrap_or(0),
        Value::Null | Value::Bool(_) | Value::String(_) => 0,
    }
}

#[cfg(test)]
mod tests {
    use emmy::motion::{Extreme, Snapshot};
    use emmy::prelude::*;
    use emmy::time::Memory;

    use super::*;
    use crate::checkpoint::{self, Identity};
    use crate::vtk::FrameTime;

    fn bytes(checkpoint: &Checkpoint) -> io::Result<Vec<u8>> {
        checkpoint::bytes(checkpoint)
    }

    fn read(bytes: &[u8]) -> Result<Checkpoint, String> {
        checkpoint::parse(bytes)
    }

    /// A checkpoint of a cell with a displacement x of a node, and numbers that text formats lose.
    fn checkpoint(x: f64) -> Checkpoint {
        let rubber = Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 2.0);
        let body = Body::builder(mesh::block([1.0; 3], [1; 3]).unwrap()).region(rubber).build().unwrap();
        let motion = Motion::new(&body, TimeElement::discrete_gradient(1).unwrap()).unwrap();
        let identity =
            Identity { input: "title = \"ä\"\n".into(), mesh: String::new(), tables: String::new() };
        let whole = Checkpoint::of(identity, &motion);
        let nodal = |first: [f64; 3]| [&first[..], &[0.25; 21]].concat();
        let state = State {
            displacement: nodal([0.0, x, -0.0]),
            velocity: nodal([1e-300, 0.0, 1.0]),
            displacement_low: nodal([-1e-17, 0.0, 0.0]),
            momentum_error: [1e-20, -0.0, 5e-324],
            ..motion.state().clone()
        };
        let mut snapshot = Snapshot { state, ..Default::default() };
        snapshot.record.smallest_determinant = f64::INFINITY;
        snapshot.record.linear_momentum = [0.1 + 0.2, -f64::MIN_POSITIVE, 5e-324];
        snapshot.statistics.worst_energy_residual = Extreme { value: f64::NAN, step: 7 };
        let mut memory = Memory::default();
        memory.save_word("solver", "direct");
        memory.save_number("step", 0.1);
        memory.save_nodal("rates", &[0.5; 48]);
        snapshot.memory = Some(memory);
        let frames = vec![FrameTime { step: 3, time: 0.5 }];
        Checkpoint { snapshot, frames, history_checksum: 0xdead_beef, wall_seconds: 1.0, ..whole }
    }

    #[test]
    fn checkpoints_are_read_back_in_every_bit() {
        let written = bytes(&checkpoint(1.0)).unwrap();
        let read = read(&written).unwrap();
        assert_eq!(bytes(&read).unwrap(), written);
        assert_eq!((read.history_checksum, &read.frames), (0xdead_beef, &checkpoint(1.0).frames));
        assert_eq!(read.snapshot.state, checkpoint(1.0).snapshot.state);
        assert!(read.snapshot.state.displacement[2].is_sign_negative());
        assert!(read.snapshot.statistics.worst_energy_residual.value.is_nan());
        assert_eq!(read.snapshot.record, checkpoint(1.0).snapshot.record);
        assert_eq!(read.snapshot.memory, checkpoint(1.0).snapshot.memory);
    }

    #[test]
    fn every_damage_is_detected() {
        let whole = bytes(&checkpoint(1.0)).unwrap();
        for length in 0..whole.len() {
            assert!(read(&whole[..length]).is_err());
            let mut flipped = whole.clone();
            flipped[length] ^= 4;
            assert!(read(&flipped).is_err(), "{length}");
        }
    }

    #[test]
    fn other_formats_are_named() {
        let error = read(b"emmy checkpoint 2\n\x03\0\0\0\0\0\0\0").unwrap_err();
        assert_eq!(
            error,
            format!(
                "has checkpoint format 2, which a development version before Emmy 0.1.0 reads; Emmy {VERSION} reads format 4 only"
            )
        );
        let error = read(b"emmy checkpoint 5, Emmy 0.2.0\n").unwrap_err();
        assert!(error.contains("format 5, which Emmy 0.2.0 reads"), "{error}");
        assert_eq!(read(b"emmy reference 1\n").unwrap_err(), "is not a checkpoint");
    }

    #[test]
    fn values_that_no_run_writes_are_rejected() {
        for x in [f64::NAN, f64::INFINITY] {
            let error = read(&bytes(&checkpoint(x)).unwrap()).unwrap_err();
            assert_eq!(error, "has a state that is not finite");
        }
        let rejected = |change: fn(&mut Snapshot)| {
            let mut other = checkpoint(1.0);
            change(&mut other.snapshot);
            read(&bytes(&other).unwrap()).unwrap_err()
        };
        for change in
            [(|snapshot| snapshot.state.displacement_low[0] = f64::NAN) as fn(&mut Snapshot), |snapshot| {
                snapshot.state.momentum_error[2] = f64::INFINITY
            }]
        {
            assert_eq!(rejected(change), "has a state that is not finite");
        }
        assert!(rejected(|snapshot| snapshot.subdivision.halvings = 61).contains("halved too often"));
        for change in [
            (|snapshot| snapshot.state.step = usize::MAX) as fn(&mut Snapshot),
            |snapshot| snapshot.statistics.cuts = usize::MAX,
            |snapshot| snapshot.subdivision.substep = u64::MAX,
            |snapshot| snapshot.releases = usize::MAX,
        ] {
            assert!(rejected(change).contains("no run reaches"));
        }
    }
}
