//! Links between directories.

use std::path::{Component, Path};

/// Link from a directory to another one, with a final slash; absolute if there is no relative one.
pub(crate) fn relative(from: &Path, to: &Path) -> String {
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    let whole = |path: &Path| path.canonicalize().unwrap_or_else(|_| absolute(path));
    let (from, to) = (whole(from), whole(to));
    let from: Vec<Component<'_>> = from.components().collect();
    let to: Vec<Component<'_>> = to.components().collect();
    let common = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    if common == 0 {
        let parts = to.iter().map(|part| part.as_os_str().to_string_lossy()).filter(|part| part != "/");
        return parts.fold("file://".to_string(), |link, part| link + "/" + &part) + "/";
    }
    let down = to[common..].iter().map(|part| part.as_os_str().to_string_lossy());
    let up = from[common..].iter().map(|_| "..".into());
    up.chain(down).fold(String::new(), |link, part: std::borrow::Cow<'_, str>| link + &part + "/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_lead_from_one_directory_to_another() {
        let link = |from: &str, to: &str| relative(Path::new(from), Path::new(to));
        assert_eq!(link("/no/such/compare", "/no/such/run"), "../run/");
        assert_eq!(link("/no/such", "/no/such/a b/c"), "a b/c/");
        assert_eq!(link("/no/such/run", "/no/such/run"), "");
    }
}
