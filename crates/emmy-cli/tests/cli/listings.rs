//! Every listing of README.md, CONTRIBUTING.md and the book is run, or is a part of a file that is tested.
//!
//! The listings of a page are a session in one folder. The words after the three backticks select the test:
//!
//! | listing | test |
//! |---|---|
//! | `toml NAME` | written to NAME, for the commands below it |
//! | `toml FOLDER/NAME` | lines of this file, which is copied to NAME for the commands below |
//! | `toml` | parts of an input: a small input with them passes `emmy check` |
//! | `sh`, `sh exit N` | `emmy` and `cargo run --release --` are run; commands of cargo must name existing tests |
//! | `text output` | lines of the last output, except for numbers; `...` stands for any others |
//! | `rust FILE`, `python FILE`, `geo FILE`, `csv FILE` | lines of FILE, which another test runs |
//! | `text FILE` | output of the Python program FILE, for `tests/pyvista/frames.py` |
//! | `bash` | a script of a batch system, which nobody runs |
//! | `python`, `text python` | a script and its output, for `python/tests/test_book.py` |
//!
//! `UPDATE_LISTINGS=1 cargo test -p emmy-cli --test cli listings` writes the present output into the pages.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use regex_lite::Regex;

use super::{BOX, Place};

/// Pages whose listings are tested elsewhere (`tests/editor/taplo.py`), or are computed (`validation/tests/book.rs`).
const ELSEWHERE: [&str; 2] = ["book/src/editors.md", "book/src/paper/results.md"];

/// In the root of the repository, this starts the program.
const CARGO_RUN: &str = "cargo run --release -- ";

/// Programs in the pages that this test does not start.
const OTHERS: &[&str] = &[
    "cargo",
    "just",
    "maturin",
    "mypy",
    "basedpyright",
    "ruff",
    "pdoc",
    "pip",
    "pytest",
    "python",
    "python3",
    "abi3audit",
    "apt-get",
    "export",
    "git",
    "twine",
    "gmsh",
    "mdbook",
    "module",
    "mpirun",
    "pkg-config",
    "touch",
    "fuzz/run",
    "taplo",
    "EMMY_DRAW=1017",
    "UPDATE_LISTINGS=1",
    "INSTA_UPDATE=always",
    "EMMY_GALLERY=book/src/python",
    "EMMY_UPDATE_DOCS=1",
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// Pages, by their paths in the repository.
fn pages() -> Vec<String> {
    let mut folders = vec!["book/src".to_string()];
    let mut pages = vec!["README.md".to_string(), "CONTRIBUTING.md".to_string()];
    while let Some(folder) = folders.pop() {
        for name in super::names(&root().join(&folder)) {
            let path = format!("{folder}/{name}");
            match root().join(&path).is_dir() {
                true => folders.push(path),
                false if name.ends_with(".md") => pages.push(path),
                false => {}
            }
        }
    }
    pages.retain(|page| !ELSEWHERE.iter().any(|other| page.starts_with(other)));
    pages.sort();
    pages
}

/// A listing: the words of its first line, and its text.
struct Listing {
    words: Vec<String>,
    text: String,
    /// Position of the text in the page.
    place: std::ops::Range<usize>,
}

fn listings(page: &str) -> Vec<Listing> {
    let text = fs::read_to_string(root().join(page)).unwrap();
    let fence = Regex::new(r"(?ms)^```([^\n]+)\n(.*?)^```$").unwrap();
    let listing = |found: regex_lite::Captures<'_>| Listing {
        words: found[1].split_whitespace().map(String::from).collect(),
        text: found[2].to_string(),
        place: found.get(2).unwrap().range(),
    };
    fence.captures_iter(&text).map(listing).collect()
}

/// A page in the test, with the folder for its commands.
struct Session<'a> {
    page: &'a str,
    place: Place,
    output: String,
}

impl<'a> Session<'a> {
    fn new(page: &'a str) -> Self {
        let place = Place::new();
        let examples = root().join("examples");
        copy(&examples, &place.path("examples"));
        copy(&examples.join("meshes"), &place.path("meshes"));
        copy(&examples.join("meshes"), &place.path("examples/meshes"));
        for name in ["l-block.toml", "pulse.csv"] {
            fs::copy(examples.join(name), place.path(name)).unwrap();
        }
        Session { page, place, output: String::new() }
    }

    /// Runs a listing; returns its new text if it shows output.
    fn run(&mut self, listing: &Listing) -> Option<String> {
        let words: Vec<&str> = listing.words.iter().map(String::as_str).collect();
        match words[..] {
            ["toml"] => self.check_parts(&listing.text),
            ["toml", file] if file.contains('/') => {
                self.is_part_of(&listing.text, file);
                let name = Path::new(file).file_name().unwrap();
                fs::copy(root().join(file), self.place.path(name.to_str().unwrap())).unwrap();
            }
            ["toml", name] => self.place.write(name, &listing.text),
            ["sh"] => self.commands(&listing.text, 0),
            ["sh", "exit", code] => self.commands(&listing.text, code.parse().unwrap()),
            ["text", "output"] => return Some(self.shown(&listing.text)),
            ["rust" | "python" | "geo" | "csv", file] => self.is_part_of(&listing.text, file),
            // `tests/pyvista/frames.py` compares these.
            ["text", script, ..] if script.ends_with(".py") => {}
            // `python/tests/test_book.py` runs these.
            ["python"] | ["text", "python"] => {}
            ["math"] => {}
            // A batch script needs its system.
            ["bash"] => {}
            _ => panic!("{}: nobody tests a listing of {words:?}", self.page),
        }
        None
    }

    /// Inserts parts of an input into a small one.
    fn check_parts(&self, text: &str) {
        if let Ok(parts) = text.parse::<toml::Table>() {
            return self.check(parts);
        }
        // Incompatible lines are alternatives.
        text.lines().filter(|line| !line.is_empty()).for_each(|line| self.check(line.parse().unwrap()));
    }

    fn check(&self, parts: toml::Table) {
        let mut input: toml::Table = BOX.parse().unwrap();
        for (key, value) in parts {
            let section = match key.as_str() {
                "material" | "viscosity" | "density" => Some("region"),
                "history" | "force" | "traction" => Some("load"),
                "scheme" | "degree" | "steps" | "adaptive" => Some("time"),
                _ => None,
            };
            let table = match section.map(|section| &mut input[section]) {
                None => &mut input,
                Some(toml::Value::Array(items)) => items[0].as_table_mut().unwrap(),
                Some(table) => table.as_table_mut().unwrap(),
            };
            if key == "adaptive" {
                table.remove("steps");
                table.insert("until".into(), 1.0.into());
            }
            table.insert(key, value);
        }
        self.place.write("parts.toml", &input.to_string());
        let outcome = self.place.emmy(&["check", "parts.toml"]);
        assert_eq!(outcome.code, 0, "{}: {input}\n{}", self.page, outcome.stderr);
    }

    fn commands(&mut self, text: &str, code: i32) {
        let text = text.replace("\\\n", " ").replace(CARGO_RUN, "emmy ");
        if text.lines().any(|line| line.starts_with("emmy ")) {
            self.output.clear();
        }
        for command in text.lines().filter(|line| !line.trim().is_empty()) {
            let program = command.split_whitespace().next().unwrap();
            if program != "emmy" {
                assert!(OTHERS.contains(&program), "{}: who runs `{command}`?", self.page);
                continue;
            }
            if command.contains('>') {
                continue; // the schema, which `tests/editor/taplo.py` writes
            }
            let outcome = self.shell(command);
            assert_eq!(outcome.0, code, "{}: {command}\n{}", self.page, outcome.1);
            self.output.push_str(&outcome.1);
        }
    }

    /// Exit code and output.
    fn shell(&self, command: &str) -> (i32, String) {
        let binary = Path::new(env!("CARGO_BIN_EXE_emmy")).parent().unwrap();
        let path = format!("{}:{}", binary.display(), std::env::var("PATH").unwrap());
        let output = Command::new("sh")
            .args(["-c", command])
            .current_dir(self.place.path(""))
            .env("PATH", path)
            .env("NO_COLOR", "1")
            .output()
            .unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        (output.status.code().unwrap(), text(output.stdout) + &text(output.stderr))
    }

    /// The shown lines of an output with their present text.
    fn shown(&self, shown: &str) -> String {
        let mut lines = self.output.lines().map(str::trim_end);
        let now = shown.lines().map(|line| match line {
            "..." => Some(line),
            line => lines.find(|own| without_numbers(own) == without_numbers(line)),
        });
        let now: Option<Vec<&str>> = now.collect();
        match now {
            Some(now) if shown.trim() != "..." => now.join("\n") + "\n",
            _ => self.output.clone(),
        }
    }

    fn is_part_of(&self, text: &str, file: &str) {
        let whole = fs::read_to_string(root().join(file)).unwrap_or_else(|error| panic!("{file}: {error}"));
        assert!(whole.contains(text.trim_end()), "{}: this is not in {file}:\n{text}", self.page);
    }
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for name in super::names(from) {
        let path = from.join(&name);
        if path.is_file() {
            fs::copy(path, to.join(name)).unwrap();
        }
    }
}

/// A line with `#` for each number, and single blanks.
fn without_numbers(line: &str) -> String {
    let numbers = Regex::new(r"-?\d+(\.\d+)?(e-?\d+)?").unwrap();
    let line = numbers.replace_all(line, "#").into_owned();
    line.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn run_page(page: &str) {
    let mut session = Session::new(page);
    let mut text = fs::read_to_string(root().join(page)).unwrap();
    let mut shift = 0;
    for listing in listings(page) {
        let Some(now) = session.run(&listing) else { continue };
        if std::env::var_os("UPDATE_LISTINGS").is_some() {
            let place = (listing.place.start as isize + shift) as usize
                ..(listing.place.end as isize + shift) as usize;
            shift += now.len() as isize - place.len() as isize;
            text.replace_range(place, &now);
        } else {
            assert_eq!(without_numbers(&now), without_numbers(&listing.text), "{page}");
        }
    }
    if shift != 0 || std::env::var_os("UPDATE_LISTINGS").is_some() {
        fs::write(root().join(page), text).unwrap();
    }
}

#[test]
fn listings_of_the_readme() {
    run_page("README.md");
}

#[test]
fn listings_of_the_tutorials() {
    ["quick-start", "bracket"].iter().for_each(|name| run_page(&format!("book/src/{name}.md")));
}

#[test]
fn listings_of_the_other_pages() {
    let own = ["README.md", "book/src/quick-start.md", "book/src/bracket.md"];
    pages().iter().filter(|page| !own.contains(&page.as_str())).for_each(|page| run_page(page));
}

/// `cargo test -p PACKAGE --test TARGET FILTER` names an existing test.
#[test]
fn commands_of_cargo_name_tests_that_exist() {
    let command = Regex::new(r"cargo test [^`\n#|(;]*").unwrap();
    let mut n_commands = 0;
    for page in pages() {
        let text = fs::read_to_string(root().join(&page)).unwrap();
        for found in command.find_iter(&text) {
            check_test(&page, found.as_str());
            n_commands += 1;
        }
    }
    assert!(n_commands > 10);
}

fn check_test(page: &str, command: &str) {
    let words: Vec<&str> = command.split_whitespace().take_while(|word| *word != "--").collect();
    let after = |flag: &str| words.iter().position(|word| *word == flag).map(|at| words[at + 1]);
    let Some(package) = after("-p") else { return };
    let folder = match package {
        "emmy-validation" => "validation".to_string(),
        "emmy-bench" => "benches".to_string(),
        "emmy-attack" => "attack".to_string(),
        other => format!("crates/{other}"),
    };
    let Some(target) = after("--test") else { return };
    let folder = root().join(folder).join("tests");
    let (file, folder) = (folder.join(format!("{target}.rs")), folder.join(target));
    assert!(file.exists() || folder.exists(), "{page}: {command}: there is no {}", folder.display());
    let filter = words.iter().skip(2).enumerate().find_map(|(i, word)| {
        let follows_flag = i > 0 && ["-p", "--test", "--example"].contains(&words[i + 1]);
        (!word.starts_with('-') && !follows_flag && *word != package && *word != target).then_some(*word)
    });
    let Some(filter) = filter else { return };
    let last = filter.trim_end_matches(':').rsplit("::").next().unwrap();
    let texts = if folder.is_dir() { sources(&folder) } else { fs::read_to_string(file).unwrap() };
    assert!(texts.contains(last), "{page}: {command}: no test has {last} in its name");
}

/// Texts of the files below a folder, and their names.
fn sources(folder: &Path) -> String {
    let part = |name: String| {
        let path = folder.join(&name);
        match path.is_dir() {
            true => name + &sources(&path),
            false if name.ends_with(".rs") => name + &fs::read_to_string(path).unwrap(),
            false => String::new(),
        }
    };
    super::names(folder).into_iter().map(part).collect()
}
