//! The paper, reproduced: Table III and the figures of Section 5 of Betsch and Steinmann (2001), each with its claims,
//! checked by numbers; also the schemes of other codes, higher degrees, long flights, and elements that do not lock.
//!
//!     cargo run --release -p emmy-validation -- [--quick] [--only NAME,...] [--output FOLDER]
//!         [--exudyn PYTHON] [--ccx CCX] [--mujoco PYTHON]
//!
//! Ends with exit code 1 if a claim fails.

mod case;
mod claim;
mod items;
mod measure;
mod page;
mod picture;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use emmy_io::convergence::on_one_thread;
use rayon::prelude::*;

use crate::claim::Item;
use crate::items::{Effort, Entry};
use crate::page::Page;
use crate::picture::Pictures;

/// Reproduces the results of Betsch and Steinmann (2001), Section 5, with a verdict on each claim.
#[derive(Debug, Parser)]
struct Arguments {
    /// Coarser references, fewer points, no claims about time: for continuous integration
    #[arg(long)]
    quick: bool,
    /// Only these items, such as table-3,figure-5
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    only: Vec<String>,
    /// Interpreter of Python with EXUDYN, beside which `mechanisms` then stands (benches/peers/README.md)
    #[arg(long, value_name = "PATH")]
    exudyn: Option<PathBuf>,
    /// The program ccx of CalculiX, beside which `contact` and `harmonic-response` then stand
    #[arg(long, value_name = "PATH")]
    ccx: Option<PathBuf>,
    /// Python with MuJoCo (`pip install mujoco`), beside which `contact` then stands
    #[arg(long, value_name = "PYTHON")]
    mujoco: Option<PathBuf>,
    /// Folder for the pictures, the pages (index.html, results.md) and the kept references
    #[arg(long, default_value = "validation-results")]
    output: PathBuf,
}

fn main() -> ExitCode {
    // Inside the pool, like `emmy run`.
    match rayon::scope(|_| run(&Arguments::parse())) {
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
    let entries = arguments.entries()?;
    std::fs::create_dir_all(&arguments.output)
        .map_err(|error| format!("{}: {error}", arguments.output.display()))?;
    let pictures = Pictures { folder: arguments.output.clone() };
    let start = std::time::Instant::now();
    // Until the program ends.
    let kept = |path: &Option<PathBuf>| path.clone().map(|path| &*Box::leak(path.into_boxed_path()));
    let [exudyn, ccx, mujoco] = [&arguments.exudyn, &arguments.ccx, &arguments.mujoco].map(kept);
    let items = items(&entries, Effort { quick: arguments.quick, exudyn, ccx, mujoco }, &pictures)?;
    for item in &items {
        println!("{}", item.title);
        for claim in &item.claims {
            let word = if claim.holds { "holds" } else { "FAILS" };
            println!("  {word}: {} ({})", claim.statement, claim.measured);
        }
    }
    let page = Page { items: &items, quick: arguments.quick, seconds: start.elapsed().as_secs_f64() };
    page.write(&arguments.output).map_err(|error| error.to_string())?;
    let claims = items.iter().flat_map(|item| &item.claims);
    let (held, failed): (Vec<_>, Vec<_>) = claims.partition(|claim| claim.holds);
    let index = arguments.output.join("index.html");
    println!("{} claims hold, {} fail; see {}", held.len(), failed.len(), index.display());
    Ok(failed.is_empty())
}

impl Arguments {
    /// The requested items; if none is named, all but the long ones.
    fn entries(&self) -> Result<Vec<Entry>, String> {
        let names: Vec<&str> = items::ALL.iter().map(|entry| entry.name).collect();
        if let Some(unknown) = self.only.iter().find(|name| !names.contains(&name.as_str())) {
            return Err(format!("--only {unknown}: there is no such item; there are {}", names.join(", ")));
        }
        let is_wanted = |entry: &&Entry| match self.only.is_empty() {
            true => !entry.long,
            false => self.only.iter().any(|name| name == entry.name),
        };
        Ok(items::ALL.iter().filter(is_wanted).copied().collect())
    }
}

/// All items in their order: in parallel, each on one thread, except items that measure times, which run alone.
fn items(entries: &[Entry], effort: Effort, pictures: &Pictures) -> Result<Vec<Item>, String> {
    let reproduce = |entry: &Entry| {
        let item = on_one_thread(|| (entry.reproduce)(effort, pictures)).and_then(|item| item);
        eprintln!("{}: {}", entry.name, if item.is_ok() { "done" } else { "failed" });
        item.map_err(|message| format!("{}: {message}", entry.name))
    };
    let (timed, others): (Vec<_>, Vec<_>) = (0..entries.len()).partition(|&i| entries[i].timed);
    let others = others.par_iter().map(|&i| Ok((i, reproduce(&entries[i])?)));
    let mut items = others.collect::<Result<Vec<(usize, Item)>, String>>()?;
    for i in timed {
        items.push((i, reproduce(&entries[i])?));
    }
    items.sort_by_key(|(i, _)| *i);
    Ok(items.into_iter().map(|(_, item)| item).collect())
}
