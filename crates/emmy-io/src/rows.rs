//! Files of rows, one a step or more, whose first column is the number of the step.

use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::directory::named;

/// A file that grows by whole rows.
#[derive(Debug)]
pub struct RowFile {
    file: File,
    path: PathBuf,
    /// Bytes of whole rows.
    length: u64,
}

impl RowFile {
    /// A new file with its header.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn create(path: &Path, header: &str) -> io::Result<Self> {
        let file = File::create(path).map_err(named(path))?;
        let mut rows = RowFile { file, path: path.to_path_buf(), length: 0 };
        rows.write(header)?;
        Ok(rows)
    }

    /// A file that goes on after a step: rows of later ones, and one that is not whole, are cut off.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn resume(path: &Path, step: usize) -> io::Result<Self> {
        let text = std::fs::read_to_string(path).map_err(named(path))?;
        let mut file = File::options().write(true).open(path).map_err(named(path))?;
        let length = kept(&text, step) as u64;
        file.set_len(length).and_then(|()| file.seek(SeekFrom::End(0))).map_err(named(path))?;
        Ok(RowFile { file, path: path.to_path_buf(), length })
    }

    /// Writes a row, given without its end. A row that does not fit onto the disk is taken back.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn write(&mut self, row: &str) -> io::Result<()> {
        let line = format!("{row}\n");
        if let Err(error) = self.file.write_all(line.as_bytes()).and_then(|()| self.file.flush()) {
            // What cannot be written may not be cut off either; readers leave a last line without its end out.
            let _ = self.file.set_len(self.length).and_then(|()| self.file.seek(SeekFrom::End(0)));
            return Err(named(&self.path)(error));
        }
        self.length += line.len() as u64;
        Ok(())
    }

    /// Has the system put all rows on the disk itself.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn sync(&self) -> io::Result<()> {
        self.file.sync_data().map_err(named(&self.path))
    }
}

/// Bytes of the header and the whole rows up to a step.
fn kept(text: &str, step: usize) -> usize {
    let mut length = 0;
    for (i, line) in text.split_inclusive('\n').enumerate() {
        let of_row = line.split(',').next().and_then(|number| number.parse::<usize>().ok());
        let is_kept = i == 0 || of_row.is_some_and(|own| own <= step);
        if !line.ends_with('\n') || !is_kept {
            break;
        }
        length += line.len();
    }
    length
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_later_steps_are_cut_off() {
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
    }

    #[test]
    fn a_row_that_was_not_finished_is_cut_off() {
        assert_eq!(kept("step,x\n0,1\n1,", 5), 11);
        assert_eq!(kept("step,x\n0,1\n10,2\n", 1), 11);
        assert_eq!(kept("step,x", 1), 0);
    }
}
