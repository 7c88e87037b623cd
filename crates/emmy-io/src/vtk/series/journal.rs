//! Frames that the copy of a series does not have yet, so that a run that is killed loses none.
//!
//! The file is a sequence of entries: their length, step, time, number of fields; of each field its place in [`FieldName::ALL`], the
//! number of its numbers, and these; a CRC-32 of all but the length. All are 8 bytes with the lowest first, but for the checksum of 4.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use emmy::body::fields::{FieldName, FieldValues};

use crate::directory::{named, remove};

/// Ending of the file, after the name of the series.
pub(super) const ENDING: &str = ".journal";

/// The file as it grows.
#[derive(Debug)]
pub(super) struct Journal {
    file: File,
    path: PathBuf,
    /// Bytes of whole entries.
    length: u64,
}

impl Journal {
    /// An empty one.
    pub(super) fn create(path: &Path) -> io::Result<Self> {
        let file = File::create(path).map_err(named(path))?;
        Ok(Journal { file, path: path.to_path_buf(), length: 0 })
    }

    /// One that keeps its entries until it is cleared.
    pub(super) fn open(path: &Path) -> io::Result<Self> {
        let options = File::options().write(true).create(true).truncate(false).open(path);
        let mut file = options.map_err(named(path))?;
        let length = file.seek(SeekFrom::End(0)).map_err(named(path))?;
        Ok(Journal { file, path: path.to_path_buf(), length })
    }

    /// Adds a frame.
    pub(super) fn add(&mut self, step: usize, time: f64, fields: &[FieldValues]) -> io::Result<()> {
        let entry = entry(step, time, fields);
        if let Err(error) = self.file.write_all(&entry) {
            let _ = self.file.set_len(self.length).and_then(|()| self.file.seek(SeekFrom::End(0)));
            return Err(named(&self.path)(error));
        }
        self.length += entry.len() as u64;
        Ok(())
    }

    /// Takes all entries out.
    pub(super) fn clear(&mut self) -> io::Result<()> {
        let cleared = self.file.set_len(0).and_then(|()| self.file.seek(SeekFrom::Start(0)));
        self.length = 0;
        cleared.map(|_| ()).map_err(named(&self.path))
    }

    /// Removes the file.
    pub(super) fn remove(&self) -> io::Result<()> {
        remove(&self.path).map_err(named(&self.path))
    }
}

fn entry(step: usize, time: f64, fields: &[FieldValues]) -> Vec<u8> {
    let n_numbers: usize = fields.iter().map(|field| field.numbers.len()).sum();
    let mut bytes = Vec::with_capacity(8 * (n_numbers + 2 * fields.len() + 4) + 4);
    bytes.extend([0; 8]);
    bytes.extend((step as u64).to_le_bytes());
    bytes.extend(time.to_le_bytes());
    bytes.extend((fields.len() as u64).to_le_bytes());
    for field in fields {
        let place = FieldName::ALL.iter().position(|&name| name == field.name).unwrap_or(usize::MAX);
        bytes.extend((place as u64).to_le_bytes());
        bytes.extend((field.numbers.len() as u64).to_le_bytes());
        field.numbers.iter().for_each(|number| bytes.extend(number.to_le_bytes()));
    }
    let sum = crc32fast::hash(&bytes[8..]);
    bytes.extend(sum.to_le_bytes());
    let length = bytes.len() as u64 - 8;
    bytes[..8].copy_from_slice(&length.to_le_bytes());
    bytes
}

/// The whole entries of a file: step, place and length of each.
#[derive(Debug)]
pub(super) struct Entries {
    file: BufReader<File>,
    entries: Vec<(usize, u64, u64)>,
}

impl Entries {
    /// Those of a file, up to the first that is not whole.
    pub(super) fn read(path: &Path) -> io::Result<Self> {
        let file = File::open(path)?;
        let end = file.metadata()?.len();
        let (mut found, mut place) = (Entries { file: BufReader::new(file), entries: Vec::new() }, 8);
        while place <= end {
            let length = u64::from_le_bytes(found.bytes(place - 8, 8)?.try_into().unwrap_or_default());
            if length < 28 || length > end - place {
                break;
            }
            let Some((step, ..)) = frame(&found.bytes(place, length)?) else { break };
            found.entries.push((step, place, length));
            place += length + 8;
        }
        Ok(found)
    }

    /// The fields of a step, if it is there.
    pub(super) fn fields(&mut self, step: usize) -> io::Result<Option<Vec<FieldValues>>> {
        let found = self.entries.iter().rev().find(|(own, ..)| *own == step);
        let Some(&(_, place, length)) = found else { return Ok(None) };
        Ok(frame(&self.bytes(place, length)?).map(|(_, fields)| fields))
    }

    fn bytes(&mut self, place: u64, length: u64) -> io::Result<Vec<u8>> {
        self.file.seek(SeekFrom::Start(place))?;
        let mut bytes = vec![0; length as usize];
        self.file.read_exact(&mut bytes)?;
        Ok(bytes)
    }
}

/// Step and fields of an entry without its length; nothing if it is damaged.
fn frame(bytes: &[u8]) -> Option<(usize, Vec<FieldValues>)> {
    let (content, sum) = bytes.split_last_chunk::<4>()?;
    if crc32fast::hash(content) != u32::from_le_bytes(*sum) {
        return None;
    }
    let (words, _) = content.as_chunks::<8>();
    let mut words = words.iter();
    let mut next = || words.next().map(|word| u64::from_le_bytes(*word));
    let (step, _, n_fields) = (next()?, next()?, next()?);
    let mut fields = Vec::new();
    for _ in 0..n_fields {
        let (place, count) = (next()?, next()?);
        let name = *FieldName::ALL.get(usize::try_from(place).ok()?)?;
        let numbers = (0..count).map(|_| next().map(f64::from_bits)).collect::<Option<_>>()?;
        fields.push(FieldValues { name, numbers });
    }
    Some((step as usize, fields))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_come_back_up_to_one_that_is_not_whole() {
        let temp = tempfile::tempdir().unwrap();
        let path = temp.path().join("a.journal");
        let fields = |x: f64| {
            let of = |name| FieldValues { name, numbers: vec![x, -0.0, 1e-300] };
            vec![of(FieldName::Displacement), of(FieldName::Velocity)]
        };
        let mut journal = Journal::create(&path).unwrap();
        (0..3).for_each(|step| journal.add(step, 0.1 * step as f64, &fields(step as f64)).unwrap());
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
        journal.add(7, 0.7, &fields(7.0)).unwrap();
        assert_eq!(Entries::read(&path).unwrap().fields(7).unwrap(), Some(fields(7.0)));
    }
}
