//! A run must not remove or overwrite a file that it reads.

use std::fs;
use std::path::{Path, PathBuf};

use super::contents::{FILES, collections, is_removed};
use super::{DirectoryError, lock};
use crate::checkpoint;
use crate::report::pictures;
use crate::vtk::{is_of_frame, name_of};
use crate::whole_file::PART;

/// Checks that a run in a directory does not remove or overwrite any of some files. It may read its own `input.toml`,
/// which is replaced by the same input.
///
/// # Errors
/// [`DirectoryError::Source`].
pub(crate) fn check(directory: &Path, files: &[PathBuf]) -> Result<(), DirectoryError> {
    let Ok(whole) = directory.canonicalize() else { return Ok(()) };
    let is_in_danger = |file: &Path| {
        places(file)
            .iter()
            .any(|place| place.strip_prefix(&whole).is_ok_and(|inside| is_of_a_run(directory, inside)))
    };
    match files.iter().find(|file| is_in_danger(file)) {
        Some(file) => Err(DirectoryError::Source { path: directory.to_path_buf(), file: file.clone() }),
        None => Ok(()),
    }
}

/// Links followed at most.
const MAX_LINKS: usize = 40;

/// Place of a file, and of the links that lead to it.
fn places(file: &Path) -> Vec<PathBuf> {
    let mut places = Vec::new();
    let mut next = Some(file.to_path_buf());
    while let Some(path) = next.take().filter(|_| places.len() < MAX_LINKS) {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let (Ok(folder), Some(name)) = (folder.canonicalize(), path.file_name()) else { break };
        next = fs::read_link(&path).ok().map(|target| folder.join(target));
        places.push(folder.join(name));
    }
    places.extend(file.canonicalize());
    places
}

/// Whether a run removes or writes a path in its directory.
fn is_of_a_run(directory: &Path, inside: &Path) -> bool {
    let parts: Option<Vec<&str>> = inside.iter().map(|part| part.to_str()).collect();
    let own = name_of(directory);
    match parts.as_deref() {
        Some([file]) => {
            let is_own =
                [".pvd", ".vtkhdf"].iter().any(|ending| file.strip_suffix(ending) == Some(own.as_str()));
            FILES.contains(file) || *file == lock::FILE || is_own || is_removed(directory, file)
        }
        Some([checkpoint::DIRECTORY, file]) => checkpoint::FILES.contains(&file.trim_end_matches(PART)),
        Some([pictures::DIRECTORY, file]) => pictures::is_own(file),
        Some(["frames", path @ ..]) => {
            let collections = collections(directory).unwrap_or_default();
            collections.iter().chain([&own]).any(|name| is_of_frame(path, name))
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vtk::COLLECTION_MARK;

    #[test]
    fn files_that_a_run_would_remove_are_told_from_others() {
        let temp = tempfile::tempdir().unwrap();
        let out = temp.path().join("out");
        fs::create_dir_all(out.join("frames")).unwrap();
        fs::write(out.join("old.pvd"), COLLECTION_MARK).unwrap();
        let is_taken = |file: &str| {
            fs::create_dir_all(out.join(file).parent().unwrap()).unwrap();
            fs::write(out.join(file), if file == "old.pvd" { COLLECTION_MARK } else { "x" }).unwrap();
            check(&out, &[out.join(file)]).is_err()
        };
        for file in [
            "history.csv",
            "report.html",
            "out.pvd",
            "old.pvd",
            "out.vtkhdf.part",
            "frames/out_000001.vtu",
            "frames/old_000001.vtu",
            "frames/old_000001.pvtu",
            "frames/out_000001/0000.vtu",
            "checkpoint/a.checkpoint",
            "pictures/speed.png",
            "pictures/mode-12.png.part",
        ] {
            assert!(is_taken(file), "{file}");
        }
        for file in [
            "input.toml",
            "mesh.msh",
            "other.pvd",
            "pictures/mine.png",
            "frames/mesh.vtu",
            "frames/other_000001.vtu",
            "frames/out_000001/mesh.vtu",
            "sub/history.csv",
        ] {
            assert!(!is_taken(file), "{file}");
        }
        assert!(check(&temp.path().join("new"), &[out.join("history.csv")]).is_ok());
    }

    #[cfg(unix)]
    #[test]
    fn links_and_dots_lead_to_the_same_file() {
        use std::os::unix::fs::symlink;
        let temp = tempfile::tempdir().unwrap();
        let path = |name: &str| temp.path().join(name);
        fs::create_dir_all(path("out/frames")).unwrap();
        fs::create_dir_all(path("elsewhere")).unwrap();
        fs::write(path("out/frames/out_000001.vtu"), "x").unwrap();
        fs::write(path("mesh.vtu"), "x").unwrap();
        symlink("../out/frames/out_000001.vtu", path("elsewhere/to-a-frame.vtu")).unwrap();
        symlink("../mesh.vtu", path("out/run.log")).unwrap();
        symlink("out/run.log", path("over-the-run")).unwrap();
        symlink(path("out"), path("same")).unwrap();
        for (directory, file) in [
            ("out", "elsewhere/to-a-frame.vtu"),
            ("out", "elsewhere/../out/./frames/out_000001.vtu"),
            // The link itself would be removed.
            ("out", "over-the-run"),
            ("same/../out", "same/frames/out_000001.vtu"),
        ] {
            assert!(check(&path(directory), &[path(file)]).is_err(), "{directory} {file}");
        }
        assert!(check(&path("out"), &[path("mesh.vtu")]).is_ok());
    }
}
