//! The frames that a run lists in its collection (`.pvd`).

use std::fs;
use std::path::{Path, PathBuf};

use roxmltree::Document;

use crate::directory::COLLECTION_MARK;

/// A frame that a collection lists.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Listed {
    pub(super) time: f64,
    /// Number of the step, from the name of the file.
    pub(super) step: u32,
    pub(super) path: PathBuf,
}

/// Name of the collection in a directory and its frames, if there is one that Emmy wrote: that of the directory's own name
/// before others.
pub(super) fn collection(directory: &Path) -> Option<(String, Vec<Listed>)> {
    let own = directory.canonicalize().ok().and_then(|path| Some(path.file_name()?.to_os_string()));
    let mut names: Vec<PathBuf> =
        fs::read_dir(directory).ok()?.filter_map(|entry| Some(entry.ok()?.path())).collect();
    names.retain(|path| path.extension().is_some_and(|extension| extension == "pvd"));
    names.sort_by_key(|path| (path.file_stem() != own.as_deref(), path.clone()));
    names.into_iter().find_map(|path| {
        let text = fs::read_to_string(&path).ok().filter(|text| text.contains(COLLECTION_MARK))?;
        Some((path.file_name()?.to_string_lossy().into_owned(), listed(directory, &text)?))
    })
}

fn listed(directory: &Path, text: &str) -> Option<Vec<Listed>> {
    let document = Document::parse(text).ok()?;
    let sets = document.descendants().filter(|node| node.has_tag_name("DataSet"));
    let frame = |(index, node): (usize, roxmltree::Node<'_, '_>)| {
        let (time, file) = (node.attribute("timestep")?.parse().ok()?, node.attribute("file")?);
        let number = file.trim_end_matches(".vtu").rsplit('_').next().and_then(|digits| digits.parse().ok());
        Some(Listed { time, step: number.unwrap_or(index as u32), path: directory.join(file) })
    };
    Some(sets.enumerate().filter_map(frame).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_come_in_their_order_with_times_and_steps() {
        let temp = tempfile::tempdir().unwrap();
        let set = |time: &str, step: u32| {
            format!("<DataSet timestep=\"{time}\" part=\"0\" file=\"frames/a_{step:06}.vtu\"/>")
        };
        let text = format!(
            "{COLLECTION_MARK}<VTKFile><Collection>{}{}</Collection></VTKFile>",
            set("0.0", 0),
            set("1e-3", 1_000_020)
        );
        fs::write(temp.path().join("a.pvd"), text).unwrap();
        fs::write(temp.path().join("b.pvd"), "<VTKFile/>").unwrap();
        let (name, frames) = collection(temp.path()).unwrap();
        assert_eq!((name.as_str(), frames.len()), ("a.pvd", 2));
        assert_eq!((frames[1].time, frames[1].step), (1e-3, 1_000_020));
        assert!(frames[0].path.ends_with("frames/a_000000.vtu"));
        assert_eq!(collection(&temp.path().join("nothing")), None);
    }
}
