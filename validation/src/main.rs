//! The paper, reproduced: Table III and the figures of Section 5 of Betsch and Steinmann (2001), each with the claims that
//! the paper makes there, checked by numbers.
//!
//!     cargo run --release -p emmy-validation -- [--quick] [--output FOLDER]
//!
//! Ends with exit code 1 if a claim fails.

mod block;
mod claim;
mod items;
mod norm;
mod page;
mod picture;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use rayon::prelude::*;

use crate::claim::Item;
use crate::items::Effort;
use crate::picture::Pictures;

/// Reproduces the results of Betsch and Steinmann (2001), Section 5, with a verdict on each claim.
#[derive(Debug, Parser)]
struct Arguments {
    /// Coarser references and fewer points, for continuous integration
    #[arg(long)]
    quick: bool,
    /// Folder for the pictures and the index page
    #[arg(long, default_value = "validation-results")]
    output: PathBuf,
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::from(2)
        }
    }
}

/// Whether every claim holds.
fn run(arguments: &Arguments) -> Result<bool, String> {
    std::fs::create_dir_all(&arguments.output)
        .map_err(|error| format!("{}: {error}", arguments.output.display()))?;
    let pictures = Pictures { folder: arguments.output.clone() };
    let effort = Effort { quick: arguments.quick };
    let start = std::time::Instant::now();
    // Items side by side: each is a handful of serial runs.
    let items: Vec<Item> =
        items::ALL.par_iter().map(|item| item(effort, &pictures)).collect::<Result<_, String>>()?;
    for item in &items {
        println!("{}", item.title);
        for claim in &item.claims {
            let word = if claim.holds { "holds" } else { "FAILS" };
            println!("  {word}: {} ({})", claim.statement, claim.measured);
        }
    }
    let set = if effort.quick { "Quick set" } else { "Full set" };
    let effort = format!("{set}, computed in {:.0} s.", start.elapsed().as_secs_f64());
    let index = arguments.output.join("index.html");
    std::fs::write(&index, page::html(&items, &effort)).map_err(|error| error.to_string())?;
    let claims = items.iter().flat_map(|item| &item.claims);
    let (held, failed): (Vec<_>, Vec<_>) = claims.partition(|claim| claim.holds);
    println!("{} claims hold, {} fail; see {}", held.len(), failed.len(), index.display());
    Ok(failed.is_empty())
}
