//! Files that include others.

use std::path::{Path, PathBuf};

/// Depth of nested includes.
const MAX_DEPTH: usize = 16;

/// Largest number of files of one input; a few lines could request very many.
const MAX_FILES: usize = 1000;

/// The open files, each included by the one before.
#[derive(Debug, Default)]
pub(super) struct Includes {
    open: Vec<PathBuf>,
    n_files: usize,
}

impl Includes {
    /// Opens a file; the reason and advice if it must not be.
    pub(super) fn open(&mut self, file: &Path) -> Result<(), (String, &'static str)> {
        // One file may have several paths.
        let path = file.canonicalize().unwrap_or_else(|_| file.to_path_buf());
        let again = self.open.iter().position(|open| *open == path);
        if let Some(index) = again {
            let through = self.open.len() - index - 1;
            let through = if through == 0 { "" } else { " through another file" };
            return Err((format!("the file {} includes itself{through}", file.display()), "remove the line"));
        }
        if self.open.len() > MAX_DEPTH {
            let problem = format!("more than {MAX_DEPTH} files, each included by the one before");
            return Err((problem, "include them from one file"));
        }
        if self.n_files == MAX_FILES {
            let problem = format!("more than {MAX_FILES} files are included");
            return Err((problem, "join them, or include each of them once"));
        }
        self.open.push(path);
        self.n_files += 1;
        Ok(())
    }

    /// Closes the file that was opened last.
    pub(super) fn close(&mut self) {
        self.open.pop();
    }
}

/// The path of an include relative to the including file, else to the first one; a backslash separates as well.
pub(super) fn included(files: &[PathBuf], by: u32, name: &str) -> PathBuf {
    let base = |file: usize| files[file].parent().unwrap_or(Path::new(""));
    let (here, main) = (base(by as usize), base(0));
    let slashes = name.replace('\\', "/");
    let all = [here.join(name), here.join(&slashes), main.join(name), main.join(&slashes)];
    all.iter().find(|path| path.exists()).unwrap_or(&all[1]).clone()
}
