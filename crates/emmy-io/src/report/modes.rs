//! Natural modes for a page: their table, and their frames.

use std::io;
use std::path::Path;

use serde_json::{Map, Value, json};

use super::collection::FrameSource;
use super::pack::Pack;
use super::run::{RunData, name_of, shortened, units};
use super::{MAX_FRAME_BYTES, ReportError, frames};
use crate::directory::MARK;
use crate::modes::{TABLE, WITNESS};
use crate::whole_file;

/// Whether a directory has natural modes.
pub(super) fn are_in(directory: &Path) -> bool {
    whole_file::read_text(&directory.join(WITNESS)).is_ok_and(|input| input.starts_with(MARK))
}

/// Gathers the natural modes of a directory. Frame 0 is the body at rest, frame i adds mode i to it.
pub(super) fn gather(directory: &Path) -> Result<RunData, ReportError> {
    let modes = rows(directory)?;
    let input = whole_file::read_text(&directory.join(WITNESS)).unwrap_or_default();
    let tree: toml::Table = input.parse().unwrap_or_default();
    let mut source = FrameSource::find(directory);
    if let Some((_, frames)) = &mut source {
        let steps: Vec<u32> = frames.times().iter().map(|time| time.round() as u32).collect();
        frames.set_steps(&steps);
    }
    let (collection, source) = source.unzip();
    let mut pack = Pack::default();
    let frames =
        source.map(|frames| frames::gather(&frames, &tree, MAX_FRAME_BYTES, &mut pack)).transpose()?;
    let (places, arrays) = pack.finish();
    let name = name_of(directory);
    let files = [TABLE, WITNESS].map(String::from).into_iter().chain(collection);
    let manifest = json!({
        "name": name,
        "href": "",
        "title": tree.get("title"),
        "input": shortened(input),
        "files": files.collect::<Vec<_>>(),
        "units": units(directory, &tree),
        "modes": modes,
        "frames": frames.flatten(),
        "arrays": places,
    });
    Ok(RunData { name, manifest, arrays })
}

/// Frequencies of the natural modes of a directory; NaN for one that is missing.
pub(super) fn frequencies(directory: &Path) -> Result<Vec<f64>, ReportError> {
    let rows = rows(directory)?;
    Ok(rows.iter().map(|row| row["frequency"].as_f64().unwrap_or(f64::NAN)).collect())
}

/// The rows of the table in a directory.
fn rows(directory: &Path) -> Result<Vec<Value>, ReportError> {
    let path = directory.join(TABLE);
    let system = |error| ReportError::System { path: path.clone(), error };
    table(&whole_file::read_text(&path).map_err(system)?)
        .ok_or_else(|| system(io::Error::new(io::ErrorKind::InvalidData, "is not a table of natural modes")))
}

/// The rows of the table, as objects by the names of the columns; numbers that are not finite are null.
fn table(text: &str) -> Option<Vec<Value>> {
    let mut lines = text.lines();
    let columns: Vec<&str> = lines.next()?.split(',').collect();
    let row = |line: &str| -> Option<Value> {
        let numbers = line.split(',').map(|cell| cell.parse::<f64>().ok()).collect::<Option<Vec<_>>>()?;
        let named = columns.iter().zip(&numbers).map(|(name, number)| (name.to_string(), json!(number)));
        (numbers.len() == columns.len()).then(|| Value::Object(named.collect::<Map<_, _>>()))
    };
    let rows: Vec<Value> = lines.map(row).collect::<Option<_>>()?;
    (columns.contains(&"frequency") && !rows.is_empty()).then_some(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_have_the_names_of_the_columns() {
        let rows = table("mode,frequency,period\n1,0.0,inf\n2,2.5e0,0.4\n").unwrap();
        assert_eq!(rows[0], json!({ "mode": 1.0, "frequency": 0.0, "period": null }));
        assert_eq!(rows[1]["period"], 0.4);
        for damaged in
            ["", "mode,frequency\n", "mode,period\n1,2\n", "mode,frequency\n1\n", "mode,frequency\n1,x\n"]
        {
            assert_eq!(table(damaged), None, "{damaged:?}");
        }
    }
}
