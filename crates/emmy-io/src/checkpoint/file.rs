//! The file of a checkpoint.
//!
//! | part | content |
//! |---|---|
//! | header | `emmy checkpoint 3, Emmy 0.1.0` and a line feed: the format, and the version of Emmy that wrote the file |
//! | content | a [`Checkpoint`] as MessagePack, every field with its name |
//! | checksum | CRC-32 of header and content, 4 bytes, the lowest first |

use std::io;

use emmy::motion::State;
use serde_json::{Value, json};

use super::Checkpoint;
use crate::stored;

/// Number of the format; a file of any other format is rejected.
const FORMAT: u32 = 3;

const MARK: &str = "emmy checkpoint ";
const VERSION: &str = env!("CARGO_PKG_VERSION");
const DAMAGED: &str = "is damaged";

/// Larger counts are not plausible.
const LARGEST_COUNT: u64 = 1 << 40;

/// Steps are not halved more often: the number of parts would overflow.
const MAX_HALVINGS: u32 = 60;

/// The bytes of the file.
///
/// # Errors
/// None in practice: every checkpoint can be written.
pub(super) fn bytes(checkpoint: &Checkpoint) -> io::Result<Vec<u8>> {
    let n_numbers = 4 * checkpoint.snapshot.state.displacement.len();
    let mut bytes = Vec::with_capacity(18 * n_numbers + 65_536);
    bytes.extend(format!("{MARK}{FORMAT}, Emmy {VERSION}\n").as_bytes());
    stored::append(&mut bytes, 0, checkpoint)?;
    Ok(bytes)
}

/// Reads the bytes of a file.
///
/// # Errors
/// Why the file cannot be used, as the predicate of a sentence about it.
pub(super) fn read(bytes: &[u8]) -> Result<Checkpoint, String> {
    let content = content(bytes)?;
    let checkpoint = rmp_serde::from_slice(content)
        .map_err(|error| format!("does not have the content of checkpoint format {FORMAT} ({error})"))?;
    check(&checkpoint)?;
    Ok(checkpoint)
}

/// The part between header and checksum.
fn content(bytes: &[u8]) -> Result<&[u8], String> {
    let rest = bytes.strip_prefix(MARK.as_bytes()).ok_or("is not a checkpoint")?;
    let end = rest.iter().position(|&byte| byte == b'\n').ok_or(DAMAGED)?;
    let header = str::from_utf8(&rest[..end]).map_err(|_| DAMAGED)?;
    let (format, writer) =
        header.split_once(", ").unwrap_or((header, "a development version before Emmy 0.1.0"));
    if format.parse() != Ok(FORMAT) && is_header(format, writer) {
        return Err(format!(
            "has checkpoint format {format}, which {writer} reads; Emmy {VERSION} reads format {FORMAT} only"
        ));
    }
    let before_sum = stored::verified(bytes).ok_or(DAMAGED)?;
    before_sum.get(MARK.len() + end + 1..).ok_or_else(|| DAMAGED.into())
}

/// Whether a header can be quoted.
fn is_header(format: &str, writer: &str) -> bool {
    let is_short = format.len() <= 4 && writer.len() <= 50;
    is_short && format.bytes().all(|byte| byte.is_ascii_digit()) && writer.chars().all(|c| !c.is_control())
}

/// Rejects values that no run writes, and which would fail later.
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
    let State { time, step: _, displacement, momentum, velocity, displacement_low, momentum_error } = state;
    let lists = [displacement, momentum, velocity, displacement_low, &momentum_error[..]];
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
    use emmy::internals::time::Memory;
    use emmy::motion::{Extreme, Snapshot};

    use super::*;
    use crate::checkpoint::Identity;
    use crate::vtk::FrameTime;

    /// A checkpoint with one field in x, and numbers that text formats lose.
    fn checkpoint(x: f64) -> Checkpoint {
        let state = State {
            displacement: vec![0.0, x, -0.0],
            velocity: vec![1e-300],
            displacement_low: vec![-1e-17],
            momentum_error: [1e-20, -0.0, 5e-324],
            ..Default::default()
        };
        let mut snapshot = Snapshot { state, ..Default::default() };
        snapshot.record.smallest_determinant = f64::INFINITY;
        snapshot.record.linear_momentum = [0.1 + 0.2, -f64::MIN_POSITIVE, 5e-324];
        snapshot.statistics.worst_energy_residual = Extreme { value: f64::NAN, step: 7 };
        let mut memory = Memory::default();
        memory.keep_word("solver", "direct");
        snapshot.memory = Some(memory);
        Checkpoint {
            identity: Identity {
                input: "title = \"ä\"\n".into(),
                mesh: String::new(),
                tables: String::new(),
            },
            snapshot,
            frames: vec![FrameTime { step: 3, time: 0.5 }],
            history_checksum: 0xdead_beef,
            wall_seconds: 1.0,
            extremes: Vec::new(),
        }
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
                "has checkpoint format 2, which a development version before Emmy 0.1.0 reads; Emmy {VERSION} reads format 3 only"
            )
        );
        let error = read(b"emmy checkpoint 4, Emmy 0.2.0\n").unwrap_err();
        assert!(error.contains("format 4, which Emmy 0.2.0 reads"), "{error}");
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
        ] {
            assert!(rejected(change).contains("no run reaches"));
        }
    }
}
