//! `history`: tables of the time, or expressions.

use emmy::body::TimeFunction;
use emmy::internals::number::short;
use emmy::motion::StepPlan;

use super::description::{self, Kind, Section};
use super::expression;
use super::fault::{Fault, Faults};
use super::table::Item;
use super::tree::{Node, Value};

/// Reads a history: a list of `[time, value]`, or the text of an expression.
pub(super) fn read(item: Item<'_>) -> Result<TimeFunction, Fault> {
    if let Some(text) = item.text() {
        return Ok(expression::read(&item, expression::TIME)?.time_function(text.trim()));
    }
    let items = item.list_or("a list of [time, value] or an expression such as \"sin(2*pi*t)\"")?;
    let pair = |item: &Item<'_>| item.numbers().map(|[time, factor]| (time, factor));
    let entries = items.iter().map(pair).collect::<Result<Vec<_>, _>>()?;
    TimeFunction::new(entries).map_err(|error| match error {
        emmy::Error::TimeFunction { entry, reason } => {
            items.get(entry).unwrap_or(&item).fault(format!("`{}`: {reason}", item.key()), reason)
        }
        other => item.fault(other.to_string(), "here"),
    })
}

/// Whether the value of a key may be an expression.
fn is_history(key: &str) -> bool {
    let of = |section: &Section| {
        section.keys.iter().any(|own| own.name == key && matches!(own.kind, Kind::TimeFunction))
    };
    description::all().into_iter().any(of)
}

/// Number of times at which an expression is checked before a run.
const SAMPLES: usize = 1000;

/// Checks that the expressions in a part of the tree, and their rates, are finite throughout a plan.
pub(super) fn check_finite(node: &Node, plan: &StepPlan, faults: &mut Faults) {
    match &node.value {
        Value::Array(items) => items.iter().for_each(|item| check_finite(item, plan, faults)),
        Value::Table(entries) => {
            for entry in entries {
                match &entry.node.value {
                    Value::String(text) if is_history(&entry.key) => {
                        faults.keep(finite(&entry.key, text, &entry.node, plan));
                    }
                    _ => check_finite(&entry.node, plan, faults),
                }
            }
        }
        _ => {}
    }
}

fn finite(key: &str, text: &str, node: &Node, plan: &StepPlan) -> Result<(), Fault> {
    // Unreadable expressions have their own fault.
    let Ok(expression) = expression::parse(text, expression::TIME) else { return Ok(()) };
    let time_function = expression.time_function(text);
    let start = plan.start();
    let end = plan.end();
    let times = (0..=SAMPLES).map(|i| start + (end - start) * i as f64 / SAMPLES as f64);
    for time in times {
        for (what, value) in [("", time_function.value(time)), ("the rate of ", time_function.rate(time))] {
            if !value.is_finite() {
                let message =
                    format!("`{key}`: {what}`{text}` is not a finite number at t = {}", short(time));
                return Err(Fault::at(&node.place, message, format!("{value} there")));
            }
        }
    }
    Ok(())
}
