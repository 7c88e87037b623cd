//! Odd names and special files as inputs, meshes, output directories and runs.

use std::ffi::{OsStr, OsString};
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;

use crate::attack::{Attack, Cases, Trial};
use crate::base::INPUT;
use crate::faults;
use crate::place;

/// The attack.
pub(super) const ATTACK: Attack = Attack {
    name: "paths",
    what: "names that are not UTF-8, long or odd, and special files, as input, mesh, output, run",
    share: 1.0,
    cases: Cases::Listed(|_| USES.len() * (names().len() + SPECIAL.len())),
    trial,
};

/// Use of a path.
const USES: [Use; 7] =
    [Use::Input, Use::Output, Use::Mesh, Use::Resume, Use::Report, Use::Compare, Use::Folder];

#[derive(Debug, Clone, Copy, PartialEq)]
enum Use {
    Input,
    Output,
    Mesh,
    Resume,
    Report,
    Compare,
    /// The parent directory.
    Folder,
}

/// Unusual but valid file names.
fn names() -> Vec<OsString> {
    let long = "n".repeat(240);
    let too_long = "n".repeat(300);
    let deep = ["d"; 60].map(|name| name.repeat(60)).join("/");
    let texts = [
        "with space",
        "line\nfeed",
        "tab\tulator",
        "quo\"te'",
        "-dash",
        "a&b<c>",
        "%41",
        "\u{1b}[31m",
        "größe 字",
        ".",
    ];
    let texts = texts.into_iter().chain([&*long, &too_long, &deep]);
    let bytes = [&b"b\xff"[..], b"\xc3\x28 .x"];
    texts.map(OsString::from).chain(bytes.map(|name| OsStr::from_bytes(name).to_os_string())).collect()
}

/// Paths that are not regular files; `fifo`, `directory`, `loop` and `empty` are created.
const SPECIAL: [&str; 9] =
    ["/dev/zero", "/dev/null", "/dev/full", "/dev/stdin", "fifo", "directory", "loop", "empty", "not-there"];

fn trial(trial: &mut Trial<'_>) -> Result<(), String> {
    let (number, names) = (trial.number as usize, names());
    let used = USES[number % USES.len()];
    match names.get(number / USES.len()) {
        Some(name) => odd_name(trial, used, name),
        None => special_file(trial, used, SPECIAL[number / USES.len() - names.len()]),
    }
}

/// An unusual but valid name works; an invalid name gives a message.
fn odd_name(trial: &Trial<'_>, used: Use, name: &OsStr) -> Result<(), String> {
    let (emmy, place) = (trial.emmy, &trial.place);
    let name = Path::new("./").join(name);
    let is_possible = name.as_os_str().len() < 200 && name != Path::new("./.");
    let root = if used == Use::Folder { place.path(&name) } else { place.path("") };
    if fs::create_dir_all(&root).is_err() {
        return Ok(());
    }
    let write = |path: &Path, text: &str| fs::write(root.join(path), text).is_ok();
    let base = emmy.base().place.path("vtu/run");
    let own = |name: &Path| [OsStr::new("run").into(), name.as_os_str().to_os_string()];
    let quiet = [OsString::from("--quiet"), "--output".into()];
    let file = if used == Use::Input { name.clone() } else { Path::new("box.toml").into() };
    let text = match (used, name.to_str()) {
        (Use::Mesh, Some(text)) => input_with_mesh(text),
        (Use::Mesh, None) => return Ok(()),
        _ => INPUT.to_string(),
    };
    if !write(&file, &text) || used == Use::Mesh && !write(&name, TET) {
        return Ok(());
    }
    let output = if used == Use::Output { name.clone() } else { Path::new("run").into() };
    let arguments: Vec<OsString> = match used {
        Use::Resume | Use::Report | Use::Compare => {
            if name.as_os_str().len() < 250 && name != Path::new("./.") {
                place::copy(&base, &root.join(&name));
            }
            return directories(trial, used, &name, is_possible);
        }
        _ => own(&file).into_iter().chain(quiet).chain([output.clone().into_os_string()]).collect(),
    };
    let outcome = emmy.call(&root, &arguments).run();
    faults::ends_with(&outcome, if is_possible { &[0] } else { &[0, 1, 2] })?;
    if outcome.code == Some(0) { is_complete(&root.join(&output)) } else { Ok(()) }
}

fn directories(trial: &Trial<'_>, used: Use, name: &Path, is_possible: bool) -> Result<(), String> {
    let name = name.as_os_str();
    let arguments: Vec<&OsStr> = match used {
        Use::Resume => {
            ["resume", "--quiet", "--until", "0.8"].map(OsStr::new).into_iter().chain([name]).collect()
        }
        Use::Report => vec![OsStr::new("report"), name],
        _ => vec![OsStr::new("compare"), name, name, OsStr::new("--output"), OsStr::new("compared")],
    };
    let outcome = trial.emmy.call(trial.place.path(""), arguments).run();
    faults::ends_with(&outcome, if is_possible { &[0] } else { &[0, 1, 2] })
}

/// A special file is rejected at once.
fn special_file(trial: &Trial<'_>, used: Use, name: &str) -> Result<(), String> {
    let (emmy, place) = (trial.emmy, &trial.place);
    match name {
        "fifo" => {
            let made = std::process::Command::new("mkfifo").arg(place.path(name)).status();
            made.map_err(|error| error.to_string())?;
        }
        "directory" => fs::create_dir(place.path(name)).map_err(|error| error.to_string())?,
        "loop" => std::os::unix::fs::symlink("loop", place.path(name)).map_err(|error| error.to_string())?,
        "empty" => place.write(name, ""),
        _ => {}
    }
    let text = if used == Use::Mesh { input_with_mesh(name) } else { INPUT.to_string() };
    place.write("box.toml", text);
    let is_writable = used == Use::Output && matches!(name, "directory" | "not-there");
    let arguments: &[&str] = match used {
        Use::Input => &["run", name, "--quiet", "--output", "run"],
        Use::Output => &["run", "box.toml", "--quiet", "--output", name],
        Use::Mesh => &["run", "box.toml", "--quiet"],
        Use::Resume => &["resume", name],
        Use::Report => &["report", name],
        Use::Compare => &["compare", name, name, "--output", "compared"],
        Use::Folder => &["check", name],
    };
    faults::ends_with(&emmy.call(place.path(""), arguments).run(), if is_writable { &[0] } else { &[2] })
}

/// An input with a mesh file, whose path is a TOML string.
fn input_with_mesh(path: &str) -> String {
    let quoted = serde_json::Value::from(path).to_string().replace("\\u001b", "\\u001B");
    format!(
        "mesh.file = {quoted}\n[[region]]\ndensity = 1.0\nmaterial.neo-hooke = {{ lambda = 1.0, mu = 1.0 }}\n\
         [initial]\nvelocity = [1, 0, 0]\n[time]\nscheme = \"DGM\"\nsteps = [{{ until = 0.2, size = 0.1 }}]\n"
    )
}

/// One tetrahedron, Gmsh 2.2.
pub(super) const TET: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n\
                       $Elements\n1\n1 4 2 1 1 1 2 3 4\n$EndElements\n";

/// Checks that a run is complete: a report, and a collection whose frames exist.
fn is_complete(directory: &Path) -> Result<(), String> {
    faults::is_finite(&directory.join("history.csv"))?;
    if faults::status(directory) != "done" {
        return Err(format!("not done after exit code 0: {}", directory.display()));
    }
    if !directory.join("report.html").is_file() {
        return Err(format!("no report: {}", directory.display()));
    }
    let collections =
        place::files(directory).into_iter().filter(|name| name.extension() == Some(OsStr::new("pvd")));
    for collection in collections {
        let text = fs::read_to_string(directory.join(&collection)).map_err(|error| error.to_string())?;
        let document = roxmltree::Document::parse(&text);
        let document =
            document.map_err(|error| format!("collection is no XML: {}: {error}", collection.display()))?;
        let files = document.descendants().filter_map(|node| node.attribute("file"));
        for file in files {
            if !directory.join(file).is_file() {
                return Err(format!("collection names a missing file: {file:?} in {}", directory.display()));
            }
        }
    }
    Ok(())
}
