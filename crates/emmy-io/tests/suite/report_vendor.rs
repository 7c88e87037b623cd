//! The libraries in the report match their list.

use std::fs;
use std::path::Path;

use sha2::{Digest, Sha256};

#[test]
fn vendored_files_have_their_checksums() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/report/assets/vendor");
    let list = fs::read_to_string(folder.join("README.md")).unwrap();
    let sums = list.lines().filter_map(|line| line.split_once("  "));
    let sums: Vec<(&str, &str)> = sums.filter(|(sum, _)| sum.len() == 64).collect();
    let mut scripts: Vec<String> = Vec::new();
    for library in ["ogl", "uplot"] {
        assert!(folder.join(library).join("LICENSE").is_file(), "{library}");
        let files = fs::read_dir(folder.join(library)).unwrap();
        let names = files.map(|file| format!("{library}/{}", file.unwrap().file_name().to_string_lossy()));
        scripts.extend(names.filter(|name| name.contains(".min.")));
    }
    scripts.sort();
    assert_eq!(sums.iter().map(|(_, file)| *file).collect::<Vec<_>>(), scripts);
    for (sum, file) in sums {
        let digest = Sha256::digest(fs::read(folder.join(file)).unwrap());
        let digest: String = digest.iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(digest, sum, "{file}");
    }
}
