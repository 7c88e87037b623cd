//! `emmy new NAME`: writes an example input.

use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};

use clap::Args;

use crate::failure::Failure;
use crate::host::{Host, message};

/// Arguments of the verb.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Name of the example; without it, the examples are listed
    name: Option<String>,
}

/// An example input, from a file in `examples`. The package of the crate has them as `templates`, a link to that
/// folder.
#[derive(Debug, Clone, Copy)]
pub(super) struct Template {
    /// Name of the example and its file.
    pub name: &'static str,
    text: &'static str,
}

impl Template {
    /// First sentence of the file.
    pub(super) fn title(&self) -> &'static str {
        self.text.lines().next().map_or("", |line| line.trim_start_matches("# "))
    }
}

macro_rules! template {
    ($name:literal) => {
        Template { name: $name, text: include_str!(concat!("../../templates/", $name, ".toml")) }
    };
}

/// The examples.
pub(super) const TEMPLATES: [Template; 28] = [
    template!("l-block"),
    template!("quasi-rigid"),
    template!("cantilever"),
    template!("spinning-block"),
    template!("plane-beam"),
    template!("two-body"),
    template!("comet"),
    template!("struck-block"),
    template!("bar-on-a-wall"),
    template!("bouncing-ball"),
    template!("newtons-cradle"),
    template!("two-blocks"),
    template!("spring-network"),
    template!("driven-beam"),
    template!("balloon"),
    template!("rubber-mount"),
    template!("rubber-bumper"),
    template!("engine-mount"),
    template!("shock-mount"),
    template!("rubber-beam"),
    template!("soft-tissue"),
    template!("rotor-blade"),
    template!("heavy-top"),
    template!("four-bar"),
    template!("slider-crank"),
    template!("door"),
    template!("bricard"),
    template!("pendulum-chain"),
];

/// Examples with a mesh file, which `emmy new` does not write.
const ON_MESHES: [&str; 7] = [
    "bolted-bracket",
    "bracket",
    "satellite",
    "steel-bracket",
    "tied-blocks",
    "tuning-fork",
    "two-materials",
];

/// Writes the example, unless the file exists.
pub(super) fn run(arguments: &Arguments, host: &dyn Host) -> Result<(), Failure> {
    let name = arguments.name.as_deref().unwrap_or_default().trim_end_matches(".toml");
    let Some(template) = TEMPLATES.iter().find(|template| template.name == name) else {
        return Err(if ON_MESHES.contains(&name) { on_mesh(name) } else { unknown(name) });
    };
    let file = format!("{name}.toml");
    let opened = OpenOptions::new().write(true).create_new(true).open(&file);
    opened
        .and_then(|mut opened| opened.write_all(template.text.as_bytes()))
        .map_err(|error| not_written(&file, &error))?;
    message!(host, "{file} is written; `emmy check {file}` reports on it, `emmy run {file}` runs it");
    Ok(())
}

fn unknown(name: &str) -> Failure {
    let message = match name {
        "" => "which example?".to_string(),
        name => format!("there is no example `{name}`"),
    };
    let lines = TEMPLATES.iter().map(|template| format!("\n  {:16}{}", template.name, template.title()));
    let others = format!("\n(with their meshes in examples/ of Emmy's source: {})", ON_MESHES.join(", "));
    let help = format!("the examples are{}{others}", lines.collect::<String>());
    Failure::Usage { message, help: Some(help) }
}

/// Tells where to find an example with a mesh.
fn on_mesh(name: &str) -> Failure {
    let message = format!("the example `{name}` comes with a mesh, which `emmy new` does not write");
    // The bolted one has the mesh of the other bracket.
    let mesh = name.strip_prefix("bolted-").unwrap_or(name);
    let help = format!(
        "both lie in Emmy's source, as examples/{name}.toml and examples/meshes/{mesh}.msh; there, `emmy run \
         examples/{name}.toml` runs it"
    );
    Failure::Usage { message, help: Some(help) }
}

fn not_written(file: &str, error: &std::io::Error) -> Failure {
    let message = match error.kind() {
        ErrorKind::AlreadyExists => format!("{file} exists already and was not changed"),
        _ => format!("cannot write {file}: {error}"),
    };
    Failure::Files { message, help: None }
}
