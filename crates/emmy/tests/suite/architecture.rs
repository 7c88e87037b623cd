//! The invariants of ARCHITECTURE.md that can be read off the source.

use std::fs;
use std::path::{Path, PathBuf};

/// Modules in the order in which they may use each other: each only what stands before it. Modules on one line are
/// independent of each other, but for polynomial, which integrates with a quadrature.
const ORDER: [&[&str]; 15] = [
    &["number"],
    &["error"],
    &["tensor"],
    &["quadrature"],
    &["polynomial"],
    &["sparse"],
    &["newton"],
    &["element"],
    &["mesh"],
    &["material"],
    &["average"],
    &["body"],
    &["time"],
    &["motion"],
    &["adjoint"],
];

fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

fn entries(folder: &Path) -> impl Iterator<Item = PathBuf> {
    fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path())
}

fn is_rust(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "rs")
}

fn rust_files(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in entries(folder) {
        if entry.is_dir() {
            rust_files(&entry, files);
        } else if is_rust(&entry) {
            files.push(entry);
        }
    }
}

/// Files of the library, each with its module at the root.
fn files() -> Vec<(String, PathBuf)> {
    let mut files = Vec::new();
    rust_files(&source(), &mut files);
    let module = |path: &Path| {
        let first = path.strip_prefix(source()).unwrap().iter().next().unwrap();
        first.to_str().unwrap().trim_end_matches(".rs").to_string()
    };
    files.into_iter().map(|path| (module(&path), path)).collect()
}

fn rank(module: &str) -> Option<usize> {
    ORDER.iter().position(|modules| modules.contains(&module))
}

/// Code of a file without its comments and without what stands in `mod tests`.
fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).unwrap();
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap().to_string();
    text.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n")
}

#[test]
fn modules_use_only_what_stands_before_them() {
    let is_test = |path: &Path| {
        let names = ["tests.rs", "conformance.rs", "conformance"];
        path.components().any(|part| names.iter().any(|name| part.as_os_str() == *name))
    };
    for (module, path) in files().into_iter().filter(|(module, path)| module != "lib" && !is_test(path)) {
        let own = rank(&module).unwrap_or(ORDER.len());
        assert!(own < ORDER.len(), "{module} has no place in the order");
        for used in code(&path).split("crate::").skip(1) {
            let used: String = used.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            // The error names kinds of cells in its fields: data, no behaviour.
            let is_data = module == "error" && used == "mesh";
            if let Some(rank) = rank(&used).filter(|_| used != module && !is_data) {
                assert!(rank < own, "{}: {module} uses {used}", path.display());
            }
        }
    }
}

#[test]
fn linear_algebra_crates_are_named_in_one_place() {
    for (module, path) in files() {
        let code = code(&path);
        assert!(
            module == "sparse" || !(code.contains("faer") || code.contains("metis")),
            "{}",
            path.display()
        );
    }
}

#[test]
fn the_library_does_no_input_or_output_and_has_no_clock() {
    for (_, path) in files() {
        let code = code(&path);
        for word in ["std::fs", "std::io", "std::time", "println!", "eprintln!"] {
            assert!(!code.contains(word), "{} has {word}", path.display());
        }
    }
}

#[test]
fn unsafe_code_has_one_place() {
    let places: Vec<PathBuf> = files()
        .into_iter()
        .filter(|(_, path)| code(path).contains("unsafe {"))
        .map(|(_, path)| path)
        .collect();
    assert_eq!(places, [source().join("sparse/ordering.rs")]);
}

/// A file of tests that no module names would be ignored without a word.
#[test]
fn every_file_of_tests_is_a_module() {
    for (name, suite) in [("emmy", "suite"), ("emmy-io", "suite"), ("emmy-cli", "cli")] {
        let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(name).join("tests");
        let stray: Vec<PathBuf> = entries(&tests).filter(|path| is_rust(path)).collect();
        assert_eq!(stray, Vec::<PathBuf>::new(), "belongs into {}", tests.join(suite).display());
        assert_names_its_modules(&tests.join(suite), "main.rs");
    }
}

/// Checks that a folder's root file has a `mod` for each file and folder of Rust beside it.
fn assert_names_its_modules(folder: &Path, root: &str) {
    let text = fs::read_to_string(folder.join(root));
    let text = text.unwrap_or_else(|error| panic!("{}: {error}", folder.join(root).display()));
    for path in entries(folder).filter(|path| path.file_name().unwrap() != root) {
        let mut files = Vec::new();
        if path.is_dir() {
            rust_files(&path, &mut files);
        }
        if is_rust(&path) || !files.is_empty() {
            let declaration = format!("mod {};", path.file_stem().unwrap().to_str().unwrap());
            let names_it = |line: &str| line == declaration || line == format!("pub {declaration}");
            assert!(text.lines().any(names_it), "{} lacks `{declaration}`", folder.join(root).display());
        }
        if !files.is_empty() {
            assert_names_its_modules(&path, "mod.rs");
        }
    }
}
