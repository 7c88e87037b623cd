//! Differences between runs: keys of their inputs, and peaks of their columns.

use serde::Serialize;
use toml::Value;

use crate::comparison::Run;
use crate::history::{Peak, column_of_peak};

/// A key with other values in the inputs of some runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct KeyDifference {
    /// The key, such as `support.0.move.x`.
    pub key: String,
    /// Its value in each run, as in the file; `None`: the input does not have it.
    pub values: Vec<Option<String>>,
}

/// Differences between some runs.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Differences {
    /// Every key in which their inputs differ, but their folders.
    pub inputs: Vec<KeyDifference>,
    /// The peaks of all columns that the inputs ask for and all runs have.
    pub peaks: Vec<PeakDifference>,
}

impl Differences {
    /// The differences between some runs.
    pub fn between(runs: &[Run]) -> Self {
        Differences { inputs: of_inputs(runs), peaks: of_peaks(runs) }
    }
}

fn of_inputs(runs: &[Run]) -> Vec<KeyDifference> {
    let inputs: Vec<Value> = runs.iter().map(|run| Value::Table(run.input.clone())).collect();
    let mut found = Vec::new();
    add("", &inputs.iter().map(Some).collect::<Vec<_>>(), &mut found);
    found.retain(|own| own.key != "output.directory");
    found
}

/// Adds the keys below one that differ.
fn add(key: &str, values: &[Option<&Value>], found: &mut Vec<KeyDifference>) {
    if values.windows(2).all(|pair| pair[0] == pair[1]) {
        return;
    }
    let below = |name: &str| if key.is_empty() { name.to_string() } else { format!("{key}.{name}") };
    let tables: Vec<_> = values.iter().flatten().filter_map(|value| value.as_table()).collect();
    let lists: Vec<_> = values.iter().flatten().filter_map(|value| value.as_array()).collect();
    let n_given = values.iter().flatten().count();
    let has_tables = lists.iter().copied().flatten().any(Value::is_table);
    if tables.len() == n_given {
        let mut names: Vec<&String> = Vec::new();
        for name in tables.iter().flat_map(|table| table.keys()) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        for name in names {
            let own = values.iter().map(|value| value.and_then(|value| value.get(name)));
            add(&below(name), &own.collect::<Vec<_>>(), found);
        }
    } else if lists.len() == n_given && has_tables {
        for place in 0..lists.iter().map(|list| list.len()).max().unwrap_or(0) {
            let own = values.iter().map(|value| value.and_then(|value| value.get(place)));
            add(&below(&place.to_string()), &own.collect::<Vec<_>>(), found);
        }
    } else {
        let values = values.iter().map(|value| value.map(Value::to_string)).collect();
        found.push(KeyDifference { key: key.to_string(), values });
    }
}

/// The peak of a column in some runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PeakDifference {
    /// The column.
    pub column: String,
    /// The number of the largest size in each run.
    pub values: Vec<f64>,
    /// The difference of its magnitude from that of the first run, over the largest magnitude of all components of the
    /// quantity in the first run.
    pub differences: Vec<f64>,
}

fn of_peaks(runs: &[Run]) -> Vec<PeakDifference> {
    let Some(first) = runs.first() else { return Vec::new() };
    let number = |run: &Run, name: &str| run.summary[name].as_f64();
    let peak = |run: &Run, column: &str| -> Option<f64> {
        let [_, smallest, _, largest, _] = Peak::names(column).map(|name| number(run, &name));
        let (smallest, largest) = (smallest?, largest?);
        Some(if smallest.abs() > largest.abs() { smallest } else { largest })
    };
    let names = first.summary.as_object().into_iter().flat_map(|summary| summary.keys());
    let columns = names.filter(|name| name.ends_with("_max")).filter_map(|name| column_of_peak(name));
    let rows: Vec<(&str, Vec<f64>)> = columns
        .filter_map(|column| Some((column, runs.iter().map(|run| peak(run, column)).collect::<Option<_>>()?)))
        .collect();
    let size = |column: &str| {
        let of_quantity = rows.iter().filter(|(own, _)| quantity(own) == quantity(column));
        of_quantity.map(|(_, values)| values[0].abs()).fold(0.0, f64::max)
    };
    let row = |(column, values): &(&str, Vec<f64>)| {
        let size = size(column);
        PeakDifference {
            column: column.to_string(),
            differences: values[1..].iter().map(|own| (own.abs() - values[0].abs()) / size).collect(),
            values: values.clone(),
        }
    };
    rows.iter().map(row).collect()
}

/// The name of a column without that of its component.
fn quantity(column: &str) -> &str {
    const COMPONENTS: [&str; 12] =
        ["_x", "_y", "_z", "_xx", "_yy", "_zz", "_xy", "_yz", "_xz", "_1", "_2", "_3"];
    COMPONENTS.iter().find_map(|ending| column.strip_suffix(ending)).unwrap_or(column)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn run(input: &str, summary: serde_json::Value) -> Run {
        Run {
            name: String::new(),
            history: Default::default(),
            summary,
            input: input.parse().unwrap_or_default(),
        }
    }

    #[test]
    fn every_key_that_differs_is_found() {
        let none = || json!({});
        let first =
            "time = { scheme = 'DGM', steps = [{ until = 1, size = 0.1 }] }\noutput.directory = 'a'\n";
        let second = "time = { scheme = 'AS(2)', degree = 2, steps = [{ until = 1, size = 0.2 }, { until = 2, size = 1 }] }\n\
                      output.directory = 'b'\nsupport = [{ group = 'x', fix = ['x'] }]\n";
        let found = of_inputs(&[run(first, none()), run(second, none()), run(first, none())]);
        let of = |key: &str| {
            let own = found.iter().find(|own| own.key == key).unwrap_or_else(|| panic!("{key}: {found:?}"));
            own.values.iter().map(|value| value.as_deref().unwrap_or("-")).collect::<Vec<_>>()
        };
        assert_eq!(of("time.scheme"), ["\"DGM\"", "\"AS(2)\"", "\"DGM\""]);
        assert_eq!(of("time.degree"), ["-", "2", "-"]);
        assert_eq!(of("time.steps.0.size"), ["0.1", "0.2", "0.1"]);
        assert_eq!(of("time.steps.1.until"), ["-", "2", "-"]);
        assert_eq!(of("support.0.group"), ["-", "\"x\"", "-"]);
        assert_eq!(found.len(), 7, "{found:?}");
        assert!(of_inputs(&[run(first, none()), run(first, none())]).is_empty());
    }

    #[test]
    fn peaks_differ_in_parts_of_the_quantity() {
        let of = |x: f64, y: f64| json!({ "tip_x": 0, "tip_x_min": -x, "tip_x_max": 0.5 * x, "tip_y_min": 0.0, "tip_y_max": y });
        let found = of_peaks(&[run("", of(2.0, 1e-15)), run("", of(2.2, 3e-15))]);
        assert_eq!((found.len(), found[0].column.as_str()), (2, "tip_x"));
        assert_eq!(found[0].values, [-2.0, -2.2]);
        assert!((found[0].differences[0] - 0.1).abs() < 1e-14);
        // Rounding beside a large component is no difference.
        assert!(found[1].differences[0].abs() < 1e-14);
    }
}
