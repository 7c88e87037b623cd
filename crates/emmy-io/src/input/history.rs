//! `history`: tables of the time, here or in a CSV file, or expressions.

use emmy::body::TimeFunction;
use emmy::internals::body::pole;
use emmy::internals::number::short;

use super::context::Context;
use super::expression;
use super::fault::Fault;
use super::measured;
use super::table::{Item, Read, Table};
use super::tree::Value;

/// Reads a history: a list of `[time, value]`, two columns of a file, or the text of an expression, which must be
/// finite throughout the run.
pub(super) fn read(item: Item<'_>, context: Context<'_>) -> Result<TimeFunction, Fault> {
    match item.value() {
        Value::String(text) => {
            let function = expression::read(&item, &expression::TIME)?.time_function(text.trim());
            context.run.map_or(Ok(()), |run| check_finite(&item, text, &function, run))?;
            Ok(function)
        }
        Value::Table(_) => measured::read(&Table::read(item), context),
        Value::TimeFunction(function) => Ok(function.clone()),
        _ => {
            let entries: Vec<[f64; 2]> = Read::read(item);
            let entries = entries.into_iter().map(|[time, value]| (time, value)).collect();
            TimeFunction::new(entries).map_err(|error| match error {
                emmy::Error::TimeFunction { entry, reason } => {
                    let items = item.items();
                    items.get(entry).unwrap_or(&item).fault(format!("`{}`: {reason}", item.key), reason)
                }
                other => item.fault(other.to_string(), "here"),
            })
        }
    }
}

/// Reads a history that a motion can follow: one without jumps.
pub(super) fn without_jumps(item: Item<'_>, context: Context<'_>) -> Result<TimeFunction, Fault> {
    let history = read(item, context)?;
    if let Some(time) = history.first_jump() {
        let time = short(time);
        let message = format!("`{}`: the motion jumps at t = {time}; give the jump a duration", item.key);
        return Err(item.fault(message, "two values at one time"));
    }
    Ok(history)
}

/// Size of a value at the start that is rounding in an expression that is exactly zero.
pub(super) const ROUNDING: f64 = 1e-9;

/// Number of times at which an expression is checked before a run.
const SAMPLES: usize = 1000;

/// Checks that an expression and its rate are finite throughout a run.
fn check_finite(
    item: &Item<'_>,
    text: &str,
    function: &TimeFunction,
    [start, end]: [f64; 2],
) -> Result<(), Fault> {
    let key = item.key;
    let times = (0..=SAMPLES).map(|i| start + (end - start) * i as f64 / SAMPLES as f64);
    for time in times {
        for (what, value) in [("", function.value(time)), ("the rate of ", function.rate(time))] {
            if !value.is_finite() {
                let message =
                    format!("`{key}`: {what}`{text}` is not a finite number at t = {}", short(time));
                return Err(item.fault(message, format!("{value} there")));
            }
        }
    }
    match pole(|time| function.value(time), [start, end]) {
        Some(time) => {
            let message = format!("`{key}`: `{text}` is not a finite number at t = {}", short(time));
            Err(item.fault(message, "it grows without bound towards this time"))
        }
        None => Ok(()),
    }
}

#[cfg(test)]
pub(super) mod tests {
    use std::cell::RefCell;
    use std::path::Path;

    use super::*;
    use crate::input::fault::Faults;
    use crate::input::{memory, tree};
    use crate::units::Units;

    /// The history of a load in an input of a folder.
    pub(crate) fn read_in(directory: &Path, history: &str) -> Result<TimeFunction, String> {
        let text = format!("group = 'a'\nforce = [1, 0, 0]\nhistory = {history}");
        let node = tree::parse("test", &text).unwrap();
        let notes = RefCell::default();
        let context =
            Context { directory, units: Units::default(), run: None, is_undeformed: false, notes: &notes };
        let read = |table: &Table<'_>, faults: &mut Faults| faults.keep(read(table.must("history"), context));
        memory::read_alone("load", node, read).map_err(|error| error.faults()[0].to_string())
    }
}
