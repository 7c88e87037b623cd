//! `history`: tables of the time, here or in a CSV file, or expressions.

use std::path::Path;

use emmy::body::TimeFunction;

use super::expression;
use super::fault::Fault;
use super::measured;
use super::table::Item;

/// The input around a history.
#[derive(Debug, Clone, Copy)]
pub(super) struct Context<'a> {
    /// Folder of the input.
    pub(super) directory: &'a Path,
    /// End of the run.
    pub(super) end: f64,
}

/// Reads a history: a list of `[time, value]`, two columns of a file, or the text of an expression.
pub(super) fn read(item: Item<'_>, context: Context<'_>) -> Result<TimeFunction, Fault> {
    if let Some(text) = item.text() {
        return Ok(expression::read(&item, &expression::TIME)?.time_function(text.trim()));
    }
    if item.is_table() {
        return measured::read(item, context.directory);
    }
    if let Some(function) = item.time_function() {
        return Ok(function.clone());
    }
    let wanted =
        "a list of [time, value], a table { file, time, value } or an expression such as \"sin(2*pi*t)\"";
    let items = item.list_or(wanted)?;
    let pair = |item: &Item<'_>| item.numbers().map(|[time, factor]| (time, factor));
    let entries = items.iter().map(pair).collect::<Result<Vec<_>, _>>()?;
    TimeFunction::new(entries).map_err(|error| match error {
        emmy::Error::TimeFunction { entry, reason } => {
            items.get(entry).unwrap_or(&item).fault(format!("`{}`: {reason}", item.key()), reason)
        }
        other => item.fault(other.to_string(), "here"),
    })
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::input::{load, tree};

    /// The history of a load in an input of a folder.
    pub(crate) fn read_in(directory: &Path, history: &str) -> Result<TimeFunction, String> {
        let text = format!("group = 'a'\nforce = [1, 0, 0]\nhistory = {history}");
        let mut tree = tree::parse("test", &format!("[load]\n{text}\n")).unwrap();
        let node = tree.get_mut("load").unwrap();
        let item = Item::of("load", node);
        match load::read(item, Context { directory, end: 1.0 }) {
            Ok(load) => Ok(load.value.time_function().unwrap().clone()),
            Err(fault) => Err(fault.to_string()),
        }
    }
}
