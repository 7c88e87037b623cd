//! The invariants of ARCHITECTURE.md that the source shows.

use std::fs;
use std::path::{Path, PathBuf};

/// Modules in their order; each may use only earlier ones.
const ORDER: [&str; 26] = [
    "nodal",
    "number",
    "error",
    "team",
    "tensor",
    "quadrature",
    "polynomial",
    "sparse",
    "newton",
    "element",
    "mesh",
    "material",
    "average",
    "contact",
    "input",
    "space",
    "mass",
    "force",
    "unknowns",
    "body",
    "time",
    "modes",
    "motion",
    "equilibrium",
    "adjoint",
    "prelude",
];

/// The same for the files and folders inside a module.
const INSIDE: [(&str, &[&str]); 10] = [
    (
        "sparse",
        &[
            "reduce",
            "real",
            "pattern",
            "metis",
            "ordering",
            "dense",
            "eigen",
            "solver",
            "gmres",
            "lower",
            "symmetric",
            "factor",
            "block_cholesky",
            "couplings",
            "stages",
            "widened",
            "condensation",
            "lu",
            "sweep",
            "kernel",
            "shared_rows",
            "blocks",
            "row_couplings",
            "triangular",
            "shifted",
            "conjugate_gradients",
            "incomplete_cholesky",
            "shifted_solver",
            "direct",
            "team_solver",
            "multigrid",
        ],
    ),
    (
        "input",
        &[
            "span",
            "viscosity",
            "pole",
            "time_function",
            "target",
            "field",
            "symmetry",
            "region_material",
            "region",
            "joint",
            "rigid_body",
            "initial_velocity",
            "load",
            "points",
            "support",
            "tie",
            "coupling",
            "contact",
            "models",
        ],
    ),
    (
        "space",
        &[
            "geometry",
            "coupled_point",
            "ties",
            "internal_nodes",
            "drive",
            "supports",
            "reductions",
            "driven",
            "reactions",
        ],
    ),
    (
        "contact",
        &[
            "layer",
            "correction",
            "obstacle",
            "closest",
            "links",
            "pair",
            "step",
            "path",
            "tree",
            "surface",
            "candidates",
            "surface_layer",
            "surface_state",
            "apart",
        ],
    ),
    ("mass", &["regions", "points", "spread"]),
    (
        "force",
        &[
            "strain_state",
            "contact_summary",
            "batches",
            "projection",
            "facets",
            "step",
            "pressures",
            "integral",
            "signal",
            "interface",
            "source",
            "solid",
            "cells",
            "list",
            "spring",
            "attraction",
            "drag",
            "centrifugal",
            "dead",
            "surface_pressure",
            "contact",
            "frame_load",
            "field_load",
            "load",
        ],
    ),
    (
        "unknowns",
        &[
            "blocks",
            "component",
            "affine",
            "constraint",
            "constraints",
            "range",
            "rank",
            "constraint_step",
            "constraint_equations",
            "linear_constraints",
            "frame",
            "carrier",
            "attachments",
            "joint",
            "joint_force",
            "joint_output",
            "mechanism",
        ],
    ),
    (
        "body",
        &[
            "couplings",
            "system",
            "forces",
            "loads",
            "local_unknowns",
            "frequency_bound",
            "team",
            "builder",
            "mass",
            "constrained_velocity",
            "interface",
            "invariants",
            "start",
            "proportional",
            "held",
            "held_mechanism",
            "entries",
            "fields",
        ],
    ),
    (
        "time",
        &[
            "memory",
            "state",
            "scheme_force",
            "stage_coefficients",
            "time_element",
            "equations",
            "rigid_step",
            "best_fit",
            "linear",
            "stage_system",
            "prediction",
            "iteration",
            "implicit",
            "stepper",
            "element_stepper",
            "classic",
            "configuration",
            "error",
            "scheme",
        ],
    ),
    (
        "motion",
        &[
            "step_limit",
            "adaptive",
            "plan",
            "subdivision",
            "event",
            "failure",
            "record",
            "mechanism",
            "contact_statistics",
            "statistics",
            "resolution",
            "snapshot",
            "reference",
            "stepping",
            "acceleration",
            "own",
            "equations",
            "step",
            "observer",
            "samples",
            "error_norm",
            "global_error",
            "adaptive_steps",
            "march",
        ],
    ),
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

/// Files of the library, each with its top-level module.
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
    ORDER.iter().position(|own| *own == module)
}

/// Code of a file without comments and without `mod tests`.
fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).unwrap();
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap().to_string();
    text.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n")
}

#[test]
fn modules_use_only_earlier_modules() {
    let is_test = |path: &Path| {
        let names = ["tests.rs", "conformance.rs", "conformance"];
        path.components().any(|part| names.iter().any(|name| part.as_os_str() == *name))
    };
    // They name the modules, and no module names them.
    let is_face = |module: &str| module == "lib" || module == "internals";
    for (module, path) in files().into_iter().filter(|(module, path)| !is_face(module) && !is_test(path)) {
        let own = rank(&module).unwrap_or(ORDER.len());
        assert!(own < ORDER.len(), "{module} has no place in the order");
        for used in code(&path).split("crate::").skip(1) {
            let used: String = used.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            // The error has kinds of cells in its fields: data, no behaviour.
            let is_data = module == "error" && used == "mesh";
            if let Some(rank) = rank(&used).filter(|_| used != module && !is_data) {
                assert!(rank < own, "{}: {module} uses {used}", path.display());
            }
        }
    }
}

/// Paths in code that begin with `super` or `crate`; a list in braces is expanded: `super::{a, b::C}` is `super a`,
/// `super b C`.
fn paths(code: &str) -> Vec<Vec<String>> {
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    let mut paths = Vec::new();
    for start in ["super::", "crate::"].into_iter().flat_map(|word| code.match_indices(word)) {
        // The second `super` of `super::super` belongs to the path of the first.
        if code[..start.0].ends_with("::") || code[..start.0].ends_with(is_name) {
            continue;
        }
        let mut prefixes: Vec<Vec<String>> = vec![Vec::new()];
        let mut path: Vec<String> = Vec::new();
        let mut name = String::new();
        for c in code[start.0..].chars() {
            match c {
                _ if is_name(c) => name.push(c),
                ':' if !name.is_empty() => path.push(std::mem::take(&mut name)),
                ':' => {}
                '{' if !path.is_empty() && name.is_empty() => prefixes.push(path.clone()),
                ',' | '}' if prefixes.len() > 1 => {
                    if !name.is_empty() {
                        path.push(std::mem::take(&mut name));
                        paths.push(path);
                    }
                    if c == '}' {
                        prefixes.pop();
                    }
                    path = if prefixes.len() > 1 { prefixes[prefixes.len() - 1].clone() } else { Vec::new() };
                }
                _ if c.is_whitespace() && prefixes.len() > 1 => {}
                _ => {
                    if !name.is_empty() {
                        path.push(std::mem::take(&mut name));
                        paths.push(path);
                    }
                    break;
                }
            }
            if prefixes.len() == 1 && c == '}' {
                break;
            }
        }
    }
    paths
}

/// Names that a module re-exports from the files and folders in it, each with its file.
fn reexports(folder: &Path) -> Vec<(String, String)> {
    let text = code(&folder.join("mod.rs"));
    let mut names = Vec::new();
    for statement in text.split(';').filter(|statement| statement.contains("use ")) {
        let path = &statement[statement.find("use ").unwrap() + 4..];
        let Some((file, rest)) = path.split_once("::") else { continue };
        let rest = rest.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|name| !name.is_empty());
        names.extend(rest.map(|name| (name.to_string(), file.to_string())));
    }
    names
}

#[test]
fn files_use_only_earlier_files_of_their_module() {
    let mut found = 0;
    for (module, order) in INSIDE {
        let folder = source().join(module);
        let reexports = reexports(&folder);
        for (_, path) in files().into_iter().filter(|(own, _)| own == module) {
            let place: Vec<String> = path
                .strip_prefix(&folder)
                .unwrap()
                .with_extension("")
                .iter()
                .map(|part| part.to_str().unwrap().to_string())
                .collect();
            let file = &place[0];
            if file == "mod" || place.iter().any(|part| part == "tests") {
                continue;
            }
            let own = order.iter().position(|name| name == file);
            let own = own.unwrap_or_else(|| panic!("{file} has no place in the order of {module}"));
            let depth = if place[place.len() - 1] == "mod" { place.len() - 1 } else { place.len() };
            for path in paths(&code(&path)) {
                let supers = path.iter().take_while(|part| *part == "super").count();
                let used = match &path[..] {
                    [root, of, used, ..] if root == "crate" && of == module => used,
                    [..] if supers > 0 && supers == depth && path.len() > supers => &path[supers],
                    _ => continue,
                };
                let defined = reexports.iter().find(|(name, _)| name == used).map_or(used, |(_, file)| file);
                if let Some(rank) = order.iter().position(|name| name == defined).filter(|_| defined != file)
                {
                    found += 1;
                    assert!(rank < own, "{module}: {file} uses {used} of {defined}");
                }
            }
        }
    }
    assert!(found > 100, "only {found} uses were found");
}

#[test]
fn paths_are_taken_apart() {
    let code = "use super::{a, b::{C, D}, e::F};\nuse super::super::g::H;\nfn f() { crate::i::j(super::k) }";
    let found: Vec<String> = paths(code).into_iter().map(|path| path.join(" ")).collect();
    let mut expected =
        ["super a", "super b C", "super b D", "super e F", "super super g H", "crate i j", "super k"];
    let mut found: Vec<&str> = found.iter().map(String::as_str).collect();
    expected.sort();
    found.sort();
    assert_eq!(found, expected);
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
    assert_eq!(places, [source().join("sparse/metis.rs")]);
}

/// On a team a sum over the nodes that are here is not the sum over the body.
#[test]
fn sums_over_nodes_are_methods_of_the_body() {
    // Rejected on teams.
    const WHOLE_BODIES: [&str; 2] = ["time/classic/statics", "motion/error_norm.rs"];
    let is_whole = |path: &Path| WHOLE_BODIES.iter().any(|place| path.starts_with(source().join(place)));
    let is_test = |path: &Path| path.file_stem().unwrap().to_str().unwrap().ends_with("tests");
    let of_steps = files().into_iter().filter(|(module, path)| {
        ["time", "motion"].contains(&module.as_str()) && !is_whole(path) && !is_test(path)
    });
    let mut n_files = 0;
    for (_, path) in of_steps {
        n_files += 1;
        let code = code(&path);
        for word in ["reduce::", "body::sum", "sum}", "fixed().contains", "mass().iter().sum"] {
            assert!(!code.contains(word), "{} has {word}", path.display());
        }
    }
    assert!(n_files > 30, "{n_files}");
}

/// Stems of the names of special cases, which a step should not know.
const SPECIAL_CASES: [&str; 12] = [
    "pressure",
    "internal_node",
    "internal_mode",
    "dissipat",
    "projection",
    "dead_load",
    "external_force",
    "follower",
    "drag",
    "ground",
    "viscous",
    "driven",
];

/// Whether a line names a special case, outside of texts.
fn names_a_special_case(line: &str) -> bool {
    let code = line.split('"').step_by(2).collect::<Vec<_>>().join(" ").to_lowercase();
    let mut words = code.split(|c: char| !c.is_alphanumeric() && c != '_');
    words.any(|word| word.starts_with("rank") || SPECIAL_CASES.iter().any(|stem| word.contains(stem)))
}

/// A step asks lists of forces and unknowns. Where it names one of them, a new one will have to be named too.
#[test]
fn steps_name_few_special_cases() {
    let is_test = |path: &Path| path.file_stem().unwrap().to_str().unwrap().ends_with("tests");
    let of_steps = files().into_iter().filter(|(module, path)| {
        ["time", "adjoint", "modes", "equilibrium"].contains(&module.as_str()) && !is_test(path)
    });
    let mut counts: Vec<(usize, PathBuf)> = of_steps
        .map(|(_, path)| (code(&path).lines().filter(|line| names_a_special_case(line)).count(), path))
        .filter(|(n_lines, _)| *n_lines > 0)
        .collect();
    counts.sort();
    let n_lines: usize = counts.iter().map(|(n_lines, _)| n_lines).sum();
    assert!(n_lines < 150 && counts.len() <= 12, "{n_lines} lines in {} files: {counts:#?}", counts.len());
}

#[test]
fn components_of_nodes_are_numbered_in_few_places() {
    let places = files().into_iter().filter(|(_, path)| code(path).contains("3 * node"));
    let places: Vec<PathBuf> = places.map(|(_, path)| path).collect();
    assert!(places.len() <= 10, "{places:#?}");
}

/// A file of tests without a `mod` line would be ignored silently.
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
            let names_it = |line: &str| line == declaration || line == format!("pub(crate) {declaration}");
            assert!(text.lines().any(names_it), "{} lacks `{declaration}`", folder.join(root).display());
        }
        if !files.is_empty() {
            assert_names_its_modules(&path, "mod.rs");
        }
    }
}

#[test]
fn the_library_begins_with_the_first_program() {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/first_program.rs");
    let example = fs::read_to_string(example).unwrap();
    let (_, program) = example.split_once("\n\n").unwrap();
    let library = fs::read_to_string(source().join("lib.rs")).unwrap();
    let docs: Vec<&str> = library
        .lines()
        .filter_map(|line| line.strip_prefix("//!"))
        .map(|line| line.trim_start_matches(' '))
        .collect();
    let program: Vec<&str> = program.lines().map(str::trim_start).collect();
    assert!(
        docs.windows(program.len()).any(|lines| lines == program),
        "the listing in lib.rs is not the example"
    );
}
