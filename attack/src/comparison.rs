//! Bitwise comparison of two runs.

use std::fs;
use std::path::Path;

use emmy::team::Alone;
use emmy_io::checkpoint;
use emmy_io::vtk::SeriesReader;

use crate::place::files;

/// Checks that histories, frames and checkpoints of two directories of the same name are bitwise identical, except for
/// wall times.
///
/// # Errors
/// The first difference.
pub fn same(own: &Path, expected: &Path) -> Result<(), String> {
    same_rows(own, expected)?;
    same_frames(own, expected)?;
    same_checkpoints(own, expected)
}

/// Checks that two histories are equal except for `wall_seconds`.
///
/// # Errors
/// The first row that differs.
pub fn same_rows(own: &Path, expected: &Path) -> Result<(), String> {
    let [own_rows, expected_rows] = [rows(own)?, rows(expected)?];
    let pairs = own_rows.iter().zip(&expected_rows);
    if let Some((row, _)) = pairs.enumerate().find(|(_, (own, expected))| own != expected) {
        return Err(format!(
            "histories differ: row {row} of {}\n{}\n{}",
            own.display(),
            own_rows[row],
            expected_rows[row]
        ));
    }
    match (own_rows.len(), expected_rows.len()) {
        (own_length, length) if own_length != length => {
            Err(format!("histories differ: {own_length} rows in {}, not {length}", own.display()))
        }
        _ => Ok(()),
    }
}

fn rows(directory: &Path) -> Result<Vec<String>, String> {
    let path = directory.join("history.csv");
    let text =
        fs::read_to_string(&path).map_err(|error| format!("no history: {}: {error}", path.display()))?;
    let header: Vec<&str> = text.lines().next().unwrap_or("").split(',').collect();
    let wall = header.iter().position(|name| *name == "wall_seconds");
    let without = |line: &str| {
        let cells = line.split(',').enumerate().filter(|(i, _)| Some(*i) != wall);
        cells.map(|(_, cell)| cell).collect::<Vec<_>>().join(",")
    };
    Ok(text.lines().map(without).collect())
}

/// Checks that the frames and their list are equal.
fn same_frames(own: &Path, expected: &Path) -> Result<(), String> {
    let is_frame =
        |name: &Path| name.extension().is_some_and(|extension| extension == "vtu" || extension == "pvd");
    let frames = |directory| files(directory).into_iter().filter(|name| is_frame(name)).collect::<Vec<_>>();
    let (own_names, names) = (frames(own), frames(expected));
    if own_names != names {
        let other = own_names.iter().filter(|name| !names.contains(name));
        let missing = names.iter().filter(|name| !own_names.contains(name));
        let list: Vec<_> = missing.chain(other).take(5).collect();
        return Err(format!("frames differ: {} files, not {}: {list:?}", own_names.len(), names.len()));
    }
    for name in names {
        if fs::read(own.join(&name)).ok() != fs::read(expected.join(&name)).ok() {
            return Err(format!("frames differ: {} in {}", name.display(), own.display()));
        }
    }
    for series in files(expected).into_iter().filter(|name| name.extension().is_some_and(|e| e == "vtkhdf")) {
        same_series(&own.join(&series), &expected.join(&series))?;
    }
    Ok(())
}

fn same_series(own: &Path, expected: &Path) -> Result<(), String> {
    let open = |path: &Path| {
        SeriesReader::open(path).map_err(|error| format!("frames differ: {}: {error}", path.display()))
    };
    let (own_series, series) = (open(own)?, open(expected)?);
    if own_series.times() != series.times() {
        let (n, of) = (own_series.times().len(), series.times().len());
        return Err(format!("frames differ: {n} in {}, not {of}, or at other times", own.display()));
    }
    for (frame, field) in
        (0..series.times().len()).flat_map(|i| series.fields().into_iter().map(move |f| (i, f)))
    {
        let values = |series: &SeriesReader| {
            let values = series.values(field, frame).unwrap_or_default();
            values.into_iter().map(f64::to_bits).collect::<Vec<_>>()
        };
        if values(&own_series) != values(&series) {
            return Err(format!("frames differ: {field} of frame {frame} in {}", own.display()));
        }
    }
    Ok(())
}

fn same_checkpoints(own: &Path, expected: &Path) -> Result<(), String> {
    let content = |directory: &Path| {
        let (newest, _) = checkpoint::newest(directory, &Alone).ok()?;
        let mut newest = newest.complete().ok()?;
        // The checksum of the history depends on the seconds in its rows.
        (newest.wall_seconds, newest.history_checksum) = (0.0, 0);
        Some(format!("{newest:?}"))
    };
    match content(own) == content(expected) {
        true => Ok(()),
        false => Err(format!("checkpoints differ: {}", own.display())),
    }
}
