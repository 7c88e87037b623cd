//! A run as the page takes it: small things as JSON, numbers as packed arrays.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use super::collection::Frames;
use super::events::events;
use super::loads::loads;
use super::pack::Pack;
use super::thinning::kept_rows;
use super::{ReportError, Room, frames};
use crate::comparison::Run;
use crate::directory::FILES;
use crate::history::{COLUMNS, History};
use crate::newton;

/// What a page calls a run, and how it finds its directory.
#[derive(Debug, Clone, Default)]
pub(super) struct Place {
    /// Its name; without one that of the directory.
    pub(super) name: Option<String>,
    /// Link to the directory, with a slash behind; empty for the page's own.
    pub(super) href: String,
}

/// A run, gathered from its directory.
#[derive(Debug)]
pub(super) struct RunData {
    /// What the page calls it.
    pub(super) name: String,
    /// The small things, and where the arrays stand.
    pub(super) manifest: Value,
    /// The arrays, packed as text.
    pub(super) arrays: String,
}

impl RunData {
    /// Gathers a run. Only history and summary must be there.
    pub(super) fn gather(directory: &Path, place: Place, room: Room) -> Result<Self, ReportError> {
        let run = Run::read(directory)?;
        let name = place.name.unwrap_or_else(|| name_of(directory, run.name));
        let input = fs::read_to_string(directory.join("input.toml")).unwrap_or_default();
        let tree: toml::Table = input.parse().unwrap_or_default();
        let mut pack = Pack::default();
        let (history, steps) = pack_history(&run.history, room.rows, &mut pack);
        pack_newton(&directory.join("newton.csv"), &run.history, &steps, &mut pack);
        let (collection, frames) = Frames::find(directory, &run.history).unzip();
        let frames =
            frames.map(|frames| frames::gather(&frames, room.frame_bytes, &mut pack)).transpose()?.flatten();
        let (places, arrays) = pack.finish();
        let events = fs::read_to_string(directory.join("events.csv")).unwrap_or_default();
        let files = FILES.iter().chain(&["input.toml"]).map(|file| file.to_string()).chain(collection);
        let is_there = |file: &String| {
            directory.join(file).is_file() && (file != "report.html" || !place.href.is_empty())
        };
        let manifest = json!({
            "name": name,
            "href": place.href,
            "summary": run.summary,
            "input": input,
            "loads": loads(&tree),
            "events": self::events(&events),
            "probes": probes(&tree),
            "files": files.filter(is_there).collect::<Vec<_>>(),
            "history": history,
            "frames": frames,
            "arrays": places,
        });
        Ok(RunData { name, manifest, arrays })
    }
}

/// The last part of a path, also of `.`.
fn name_of(directory: &Path, otherwise: String) -> String {
    let whole = directory.canonicalize().ok();
    whole.and_then(|path| Some(path.file_name()?.to_string_lossy().into_owned())).unwrap_or(otherwise)
}

fn probes(input: &toml::Table) -> Vec<&str> {
    let list = input.get("output").and_then(|output| output.get("probes")?.as_array());
    list.into_iter().flatten().filter_map(|probe| probe.get("name")?.as_str()).collect()
}

/// Packs the columns of a history; what the page needs to know of it, and the rows that are kept.
fn pack_history(history: &History, limit: usize, pack: &mut Pack) -> (Value, Vec<usize>) {
    let (columns, rows) = (history.columns(), history.rows());
    // Time and count go only upwards: the first row of a stretch will do.
    let is_steady = |name: &str| matches!(name, "step" | "time" | "wall_seconds");
    let peaked: Vec<usize> =
        (0..columns.len().min(COLUMNS.len() + 1 + 12)).filter(|&i| !is_steady(&columns[i])).collect();
    let (kept, stretches) = kept_rows(rows, &peaked, limit);
    for (index, name) in columns.iter().enumerate() {
        let column: Vec<f64> = kept.iter().map(|&row| rows[row][index]).collect();
        pack.push(&format!("history/{name}"), &column);
    }
    let known =
        json!({ "columns": columns, "written": rows.len(), "kept": kept.len(), "buckets": stretches });
    (known, kept)
}

/// Packs Newton's residuals of the steps whose rows are kept, with the times between which the page shows them.
fn pack_newton(path: &Path, history: &History, kept: &[usize], pack: &mut Pack) {
    let (Some(step), Some(time)) = (history.column("step"), history.column("time")) else { return };
    let numbers: Vec<usize> = kept.iter().map(|&row| step[row] as usize).collect();
    let Ok(steps) = newton::read(path, |step| numbers.binary_search(&step).is_ok()) else { return };
    let (mut start, mut end) = (Vec::new(), Vec::new());
    for of_step in &steps {
        let Ok(at) = numbers.binary_search(&of_step.step) else { continue };
        // Steps that are left out are covered by the next one.
        start.push(time[kept[at.saturating_sub(1)]]);
        end.push(time[kept[at]]);
    }
    pack.push("newton/start", &start);
    pack.push("newton/end", &end);
    pack.push("newton/count", &steps.iter().map(|step| step.residuals.len() as u32).collect::<Vec<_>>());
    pack.push(
        "newton/residual",
        &steps.iter().flat_map(|s| s.residuals.iter().map(|&r| r as f32)).collect::<Vec<_>>(),
    );
    pack.push("newton/target", &steps.iter().map(|step| step.target as f32).collect::<Vec<_>>());
}
