//! Frames that the copy of a series does not contain yet, so that a killed run loses none.
//!
//! The file is a sequence of entries. Each has its length in 8 bytes, the frame as a MessagePack map with named fields,
//! and a CRC-32 of the map in 4 bytes; the lowest byte is first.

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use emmy::body::{FieldName, FieldValues};
use serde::{Deserialize, Serialize};

use crate::stored;
use crate::vtk::FrameTime;
use crate::whole_file::{self, named, remove};

/// Ending of the file, after the name of the series.
pub(super) const ENDING: &str = ".journal";

/// The file as it grows.
#[derive(Debug)]
pub(super) struct Journal {
    file: File,
    path: PathBuf,
    /// Bytes of complete entries.
    length: u64,
}

impl Journal {
    /// A new, empty journal.
    pub(super) fn create(path: &Path) -> io::Result<Self> {
        let file = File::create(path).map_err(named(path))?;
        Ok(Journal { file, path: path.to_path_buf(), length: 0 })
    }

    /// A journal that keeps its entries until it is cleared.
    pub(super) fn open(path: &Path) -> io::Result<Self> {
        let options = File::options().write(true).create(true).truncate(false).open(path);
        let mut file = options.map_err(named(path))?;
        let length = file.seek(SeekFrom::End(0)).map_err(named(path))?;
        Ok(Journal { file, path: path.to_path_buf(), length })
    }

    /// Adds a frame.
    pub(super) fn add(&mut self, at: FrameTime, fields: &[FieldValues]) -> io::Result<()> {
        let entry = entry(at, fields)?;
        if let Err(error) = self.file.write_all(&entry) {
            let _ = self.file.set_len(self.length).and_then(|()| self.file.seek(SeekFrom::End(0)));
            return Err(named(&self.path)(error));
        }
        self.length += entry.len() as u64;
        Ok(())
    }

    /// Removes all entries.
    pub(super) fn clear(&mut self) -> io::Result<()> {
        let cleared = self.file.set_len(0).and_then(|()| self.file.seek(SeekFrom::Start(0)));
        self.length = 0;
        cleared.map(|_| ()).map_err(named(&self.path))
    }

    /// Removes the file.
    pub(super) fn remove(&self) -> io::Result<()> {
        remove(&self.path)
    }
}

/// A frame as stored.
#[derive(Serialize, Deserialize)]
struct StoredFrame<'a> {
    step: usize,
    time: f64,
    #[serde(borrow)]
    fields: Vec<StoredField<'a>>,
}

#[derive(Serialize, Deserialize)]
struct StoredField<'a> {
    name: Cow<'a, str>,
    numbers: Cow<'a, [f64]>,
}

impl<'a> StoredField<'a> {
    fn of(values: &'a FieldValues) -> Self {
        StoredField { name: Cow::Borrowed(values.name.name()), numbers: Cow::Borrowed(&values.numbers) }
    }
}

fn entry(at: FrameTime, fields: &[FieldValues]) -> io::Result<Vec<u8>> {
    let n_numbers: usize = fields.iter().map(|field| field.numbers.len()).sum();
    let mut bytes = Vec::with_capacity(9 * n_numbers + 1024);
    bytes.extend([0; 8]);
    let FrameTime { step, time } = at;
    let frame = StoredFrame { step, time, fields: fields.iter().map(StoredField::of).collect() };
    stored::append(&mut bytes, 8, &frame)?;
    let length = bytes.len() as u64 - 8;
    bytes[..8].copy_from_slice(&length.to_le_bytes());
    Ok(bytes)
}

/// The complete entries of a file: step, offset and length of each.
#[derive(Debug)]
pub(super) struct Entries {
    file: BufReader<File>,
    entries: Vec<(usize, u64, u64)>,
}

impl Entries {
    /// The entries of a file, up to the first incomplete one.
    pub(super) fn read(path: &Path) -> io::Result<Self> {
        let file = whole_file::open(path)?;
        let end = file.metadata()?.len();
        let mut found = Entries { file: BufReader::new(file), entries: Vec::new() };
        let mut offset = 8;
        while offset <= end {
            let length = u64::from_le_bytes(found.bytes(offset - 8, 8)?.try_into().unwrap_or_default());
            if length < 4 || length > end - offset {
                break;
            }
            let Some((step, ..)) = frame(&found.bytes(offset, length)?) else { break };
            found.entries.push((step, offset, length));
            offset += length + 8;
        }
        Ok(found)
    }

    /// The fields of a step, if the journal has it.
    pub(super) fn fields(&mut self, step: usize) -> io::Result<Option<Vec<FieldValues>>> {
        let found = self.entries.iter().rev().find(|(own, ..)| *own == step);
        let Some(&(_, offset, length)) = found else { return Ok(None) };
        Ok(frame(&self.bytes(offset, length)?).map(|(_, fields)| fields))
    }

    fn bytes(&mut self, offset: u64, length: u64) -> io::Result<Vec<u8>> {
        self.file.seek(SeekFrom::Start(offset))?;
        let mut bytes = vec![0; length as usize];
        self.file.read_exact(&mut bytes)?;
        Ok(bytes)
    }
}

/// Step and fields of an entry without its length; `None` if it is damaged.
fn frame(bytes: &[u8]) -> Option<(usize, Vec<FieldValues>)> {
    let frame: StoredFrame<'_> = rmp_serde::from_slice(stored::verified(bytes)?).ok()?;
    let values = |field: StoredField<'_>| {
        Some(FieldValues { name: FieldName::from_name(&field.name)?, numbers: field.numbers.into_owned() })
    };
    Some((frame.step, frame.fields.into_iter().map(values).collect::<Option<_>>()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_read_up_to_the_first_incomplete_one() {
        let temp = tempfile::tempdir().unwrap();
        let path = temp.path().join("a.journal");
        let fields = |x: f64| {
            let of = |name| FieldValues { name, numbers: vec![x, -0.0, 1e-300] };
            vec![of(FieldName::Displacement), of(FieldName::Velocity)]
        };
        let at = |step| FrameTime { step, time: 0.1 * step as f64 };
        let mut journal = Journal::create(&path).unwrap();
        (0..3).for_each(|step| journal.add(at(step), &fields(step as f64)).unwrap());
        let whole = std::fs::read(&path).unwrap();
        for length in 0..=whole.len() {
            std::fs::write(&path, &whole[..length]).unwrap();
            let mut entries = Entries::read(&path).unwrap();
            let n = 3 * length / whole.len();
            let there = |step| entries.fields(step).unwrap() == Some(fields(step as f64));
            assert_eq!((0..3).map(there).collect::<Vec<_>>(), [n > 0, n > 1, n > 2], "{length}");
        }
        let mut damaged = whole.clone();
        damaged[whole.len() / 2] ^= 1;
        std::fs::write(&path, &damaged).unwrap();
        assert_eq!(Entries::read(&path).unwrap().entries.len(), 1);
        let mut journal = Journal::open(&path).unwrap();
        journal.clear().unwrap();
        journal.add(at(7), &fields(7.0)).unwrap();
        assert_eq!(Entries::read(&path).unwrap().fields(7).unwrap(), Some(fields(7.0)));
    }
}
