//! Files of rows, one or more for each step, whose first column is the number of the step.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::whole_file::{self, named};

/// A file that grows row by row.
#[derive(Debug)]
pub(crate) struct RowFile {
    file: File,
    path: PathBuf,
    /// Bytes of complete rows.
    length: u64,
}

impl RowFile {
    /// A new file with its header.
    ///
    /// # Errors
    /// Errors of the system.
    pub(crate) fn create(path: &Path, header: &str) -> io::Result<Self> {
        let file = File::create(path).map_err(named(path))?;
        let mut rows = RowFile { file, path: path.to_path_buf(), length: 0 };
        rows.write(header)?;
        Ok(rows)
    }

    /// A file that is resumed after a step: rows of later steps and an incomplete row are removed.
    ///
    /// # Errors
    /// Errors of the system.
    pub(crate) fn resume(path: &Path, step: usize) -> io::Result<Self> {
        let reader = BufReader::new(whole_file::open(path).map_err(named(path))?);
        RowFile::resume_at(path, kept(reader, step).map_err(named(path))?)
    }

    /// A file that is resumed after its first bytes.
    ///
    /// # Errors
    /// Errors of the system.
    pub(crate) fn resume_at(path: &Path, length: u64) -> io::Result<Self> {
        let mut file = File::options().write(true).open(path).map_err(named(path))?;
        file.set_len(length).and_then(|()| file.seek(SeekFrom::End(0))).map_err(named(path))?;
        Ok(RowFile { file, path: path.to_path_buf(), length })
    }

    /// Writes a row, given without its line feed. A row that does not fit onto the disk is removed.
    ///
    /// # Errors
    /// Errors of the system.
    pub(crate) fn write(&mut self, row: &str) -> io::Result<()> {
        let line = format!("{row}\n");
        if let Err(error) = self.file.write_all(line.as_bytes()).and_then(|()| self.file.flush()) {
            // If this fails too, readers leave the incomplete line out.
            let _ = self.file.set_len(self.length).and_then(|()| self.file.seek(SeekFrom::End(0)));
            return Err(named(&self.path)(error));
        }
        self.length += line.len() as u64;
        Ok(())
    }

    /// Checks that the file still has its length.
    ///
    /// # Errors
    /// How the file has changed.
    pub(crate) fn verify(&self) -> io::Result<()> {
        let message = match std::fs::metadata(&self.path) {
            Ok(found) if found.len() == self.length => return Ok(()),
            Ok(found) => {
                format!(
                    "it was changed during the run: it has {} bytes instead of {}",
                    found.len(),
                    self.length
                )
            }
            Err(error) => format!("it was removed during the run ({error})"),
        };
        Err(named(&self.path)(io::Error::other(message)))
    }

    /// The file.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Syncs all rows to the disk.
    ///
    /// # Errors
    /// Errors of the system.
    pub(crate) fn sync(&self) -> io::Result<()> {
        self.file.sync_data().map_err(named(&self.path))
    }
}

/// The step of a complete row.
pub(crate) fn step_of(line: &[u8]) -> Option<usize> {
    let number = line.strip_suffix(b"\n")?.split(|&byte| byte == b',').next()?;
    std::str::from_utf8(number).ok()?.parse().ok()
}

/// Bytes of the header and of the complete rows up to a step.
fn kept(mut reader: impl BufRead, step: usize) -> io::Result<u64> {
    let mut length = 0;
    let mut line = Vec::new();
    let mut is_first = true;
    loop {
        line.clear();
        reader.read_until(b'\n', &mut line)?;
        let is_kept = match is_first {
            true => line.ends_with(b"\n"),
            false => step_of(&line).is_some_and(|own| own <= step),
        };
        if !is_kept {
            return Ok(length);
        }
        length += line.len() as u64;
        is_first = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_later_steps_are_removed() {
        let temp = tempfile::tempdir().unwrap();
        let path = temp.path().join("rows.csv");
        let mut rows = RowFile::create(&path, "step,x").unwrap();
        for step in [0, 1, 1, 2] {
            rows.write(&format!("{step},0.5")).unwrap();
        }
        drop(rows);
        let mut rows = RowFile::resume(&path, 1).unwrap();
        rows.write("2,0.7").unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "step,x\n0,0.5\n1,0.5\n1,0.5\n2,0.7\n");
        rows.verify().unwrap();
        std::fs::write(&path, "step,x\n").unwrap();
        assert!(rows.verify().unwrap_err().to_string().contains("it has 7 bytes instead of 31"));
        std::fs::remove_file(&path).unwrap();
        assert!(rows.verify().unwrap_err().to_string().contains("rows.csv: it was removed during the run"));
    }

    #[test]
    fn an_incomplete_row_is_removed() {
        assert_eq!(kept(&b"step,x\n0,1\n1,"[..], 5).unwrap(), 11);
        assert_eq!(kept(&b"step,x\n0,1\n10,2\n"[..], 1).unwrap(), 11);
        assert_eq!(kept(&b"step,x"[..], 1).unwrap(), 0);
    }
}
