//! The histories in a part of the tree: their files, and whether they are finite.

use emmy::internals::body::pole;
use emmy::internals::number::short;
use emmy::motion::StepPlan;

use super::catalogue;
use super::description::{Kind, Section};
use super::expression;
use super::fault::{Fault, Faults};
use super::tree::{Node, Value};

/// Whether the value of a key may be an expression.
fn is_history(key: &str) -> bool {
    let of = |section: &Section| {
        section.keys.iter().any(|own| own.name == key && matches!(own.kind, Kind::TimeFunction))
    };
    catalogue::all().into_iter().any(of)
}

/// Visits the names of the files of all histories in a part of the tree.
pub(super) fn for_each_file(node: &mut Node, visit: &mut impl FnMut(&mut Node)) {
    match &mut node.value {
        Value::Array(items) => items.iter_mut().for_each(|item| for_each_file(item, visit)),
        Value::Table(entries) => {
            for entry in entries {
                match entry.node.get_mut("file").filter(|_| is_history(&entry.key)) {
                    Some(file) => visit(file),
                    None => for_each_file(&mut entry.node, visit),
                }
            }
        }
        _ => {}
    }
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
    let Ok(expression) = expression::parse(text, &expression::TIME) else { return Ok(()) };
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
    if let Some(time) = pole(|time| time_function.value(time), [start, end]) {
        let message = format!("`{key}`: `{text}` is not a finite number at t = {}", short(time));
        return Err(Fault::at(&node.place, message, "it grows without bound towards this time"));
    }
    Ok(())
}
