//! `emmy split FILE --parts N`: the mesh of an input in parts, for `emmy-mpi --parts`.

use std::path::PathBuf;

use clap::Args;
use emmy::mesh::owners;
use emmy_io::input::{self, Overrides};
use emmy_io::message::counted;
use emmy_io::shares;

use crate::failure::Failure;
use crate::host::{Host, message};

/// Arguments of the verb.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Input file (TOML)
    file: PathBuf,
    /// Number of parts; must equal the number of ranks of the run
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    parts: u32,
    /// Directory of the parts [default: the name of the input with the ending .parts]
    #[arg(long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Change a value of the input, such as mesh.scale=0.001 (repeatable)
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
}

/// Writes the parts.
pub(super) fn run(arguments: &Arguments, host: &dyn Host) -> Result<(), Failure> {
    let overrides = Overrides { set: arguments.set.clone(), ..Overrides::default() };
    let (file, source) = input::read_mesh(&arguments.file, &overrides)?;
    file.notes.iter().for_each(|note| message!(host, "note: {note}"));
    let owners = owners(&file.mesh, arguments.parts as usize)?;
    let directory = arguments.output.clone().unwrap_or_else(|| arguments.file.with_extension("parts"));
    emmy_io::directory::prepare_kind(&directory, "mesh in parts", shares::INDEX)?;
    let written = shares::write(&directory, &file.mesh, &owners, source);
    let index = written.map_err(|error| Failure::Other(format!("the parts cannot be written: {error}")))?;
    let (nodes, cells) = (index.nodes, index.cells);
    let [nodes, cells] = [counted(nodes, "node", "nodes"), counted(cells, "cell", "cells")];
    let parts = counted(index.parts, "part", "parts");
    message!(host, "{nodes} and {cells} in {parts}: {}", directory.display());
    Ok(())
}
