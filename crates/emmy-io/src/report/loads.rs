//! Time intervals in which loads and driven supports act, where their histories are tables.

use serde_json::{Value, json};
use toml::Table;

use crate::input::resolved;
use crate::message::counted;

/// Loads and driven supports of a resolved input: `[{ label, intervals }]`. `intervals` is null for a load that always
/// acts; the end of an interval is null if it does not end. Attractions are part of the strain energy and not included.
pub(super) fn loads(input: &Table) -> Vec<Value> {
    let loads = entries(input, "load").filter(|load| !load.contains_key("attraction")).map(load);
    let mut loads: Vec<Load> = loads.chain(driven_supports(input).map(driven_support)).collect();
    if loads.len() > MAX_LOADS {
        loads = together(loads);
    }
    loads
        .into_iter()
        .map(|Load { label, intervals }| json!({ "label": label, "intervals": intervals }))
        .collect()
}

/// Whether some support of a resolved input moves.
pub(super) fn is_driven(input: &Table) -> bool {
    driven_supports(input).next().is_some()
}

fn driven_supports(input: &Table) -> impl Iterator<Item = &Table> {
    let is_driven =
        |support: &&Table| ["move", "accelerate", "rotate"].iter().any(|key| support.contains_key(*key));
    entries(input, "support").filter(is_driven)
}

fn entries<'a>(input: &'a Table, name: &str) -> impl Iterator<Item = &'a Table> {
    let list = input.get(name).and_then(toml::Value::as_array);
    list.into_iter().flatten().filter_map(toml::Value::as_table)
}

/// Largest number of loads shown separately.
const MAX_LOADS: usize = 200;

/// Largest number of intervals of a load; with more, neighbouring ones are merged.
const MAX_INTERVALS: usize = 500;

type Interval = [Option<f64>; 2];

/// A load or driven support; without intervals it always acts.
struct Load {
    label: String,
    intervals: Option<Vec<Interval>>,
}

/// Merges the loads that always act, and the others.
fn together(loads: Vec<Load>) -> Vec<Load> {
    let (timed, always): (Vec<Load>, Vec<Load>) =
        loads.into_iter().partition(|load| load.intervals.is_some());
    let (n_timed, n_always) = (timed.len(), always.len());
    let all = joined(timed.into_iter().filter_map(|load| load.intervals).flatten().collect());
    let timed =
        (n_timed > 0).then(|| Load { label: counted(n_timed, "load", "loads"), intervals: Some(all) });
    let always = (n_always > 0).then(|| Load { label: counted(n_always, "load", "loads"), intervals: None });
    timed.into_iter().chain(always).collect()
}

/// Intervals in ascending order, with overlapping ones merged, up to the largest number.
fn joined(mut intervals: Vec<Interval>) -> Vec<Interval> {
    let end = |interval: &Interval| interval[1].unwrap_or(f64::INFINITY);
    let start = |interval: &Interval| interval[0].unwrap_or(f64::NEG_INFINITY);
    intervals.sort_by(|a, b| start(a).total_cmp(&start(b)));
    let mut joined: Vec<Interval> = Vec::new();
    for own in intervals {
        match joined.last_mut() {
            Some(last) if start(&own) <= end(last) => {
                if end(&own) > end(last) {
                    last[1] = own[1];
                }
            }
            _ => joined.push(own),
        }
    }
    let length = joined.len().div_ceil(MAX_INTERVALS).max(1);
    joined.chunks(length).map(|some| [some[0][0], some[some.len() - 1][1]]).collect()
}

fn driven_support(support: &Table) -> Load {
    let group = support.get("group").and_then(toml::Value::as_str).unwrap_or_default();
    let until = support.get("until").and_then(number);
    Load { label: format!("driven {group}"), intervals: until.map(|until| vec![[Some(0.0), Some(until)]]) }
}

fn number(value: &toml::Value) -> Option<f64> {
    value.as_float().or(value.as_integer().map(|whole| whole as f64))
}

fn load(load: &Table) -> Load {
    let kind = load.keys().find(|key| !matches!(key.as_str(), "group" | "history"));
    let kind = kind.map_or("load", String::as_str).replace('_', " ");
    let group = load.get("group").and_then(toml::Value::as_str);
    let label = group.map_or(kind.clone(), |group| format!("{kind} on {group}"));
    let table = match load.get("history") {
        Some(toml::Value::Array(points)) => Some(table(points)),
        Some(toml::Value::Table(file)) => {
            resolved(file).map(|table| table.entries().iter().map(|&(t, factor)| [t, factor]).collect())
        }
        // Constant, or an expression.
        _ => None,
    };
    Load { label, intervals: table.and_then(|points| intervals(&points)).map(joined) }
}

/// Times and factors of a history.
fn table(points: &[toml::Value]) -> Vec<[f64; 2]> {
    let point = |point: &toml::Value| match point.as_array().map(Vec::as_slice) {
        Some([time, factor]) => Some([number(time)?, number(factor)?]),
        _ => None,
    };
    points.iter().filter_map(point).collect()
}

/// Intervals in which a table is not zero, merged; `None` if it is zero nowhere.
fn intervals(points: &[[f64; 2]]) -> Option<Vec<Interval>> {
    let mut intervals: Vec<Interval> = Vec::new();
    let [first, last] = [points.first()?, points.last()?];
    if points.iter().all(|[_, factor]| *factor != 0.0) {
        return None;
    }
    let mut add = |from: f64, to: Option<f64>| match intervals.last_mut() {
        Some([_, end]) if *end == Some(from) => *end = to,
        _ => intervals.push([Some(from), to]),
    };
    if first[1] != 0.0 && first[0] > 0.0 {
        add(0.0, Some(first[0]));
    }
    for pair in points.windows(2) {
        let [[from, a], [to, b]] = [pair[0], pair[1]];
        if to > from && (a != 0.0 || b != 0.0) {
            add(from, Some(to));
        }
    }
    if last[1] != 0.0 {
        add(last[0], None);
    }
    Some(intervals)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loads_act_where_their_histories_are_not_zero() {
        let input: Table = r#"
            [[load]]
            group = "face-a"
            traction = [1, 2, 3]
            history = [[0.0, 0.0], [0.5, 1.0], [1.0, 0]]
            [[load]]
            acceleration = [0, 0, -9.81]
            [[load]]
            group = "tip"
            nodal_force = [1, 0, 0]
            history = "sin(t)"
            [[load]]
            group = "top"
            pressure = 2.0
            history = [[0, 0], [1, 0], [1, 1], [2, 1], [2, 0], [3, 0], [4, 2]]
            [[load]]
            attraction = { centre = [0, 0, 0], strength = 1 }
            [[support]]
            group = "y-min"
            rotate = { axis = [0, 0, 1], angle = "t" }
            until = 1
            [[support]]
            group = "y-max"
            fix = ["x"]
        "#
        .parse()
        .unwrap();
        assert_eq!(
            loads(&input),
            [
                json!({ "label": "traction on face-a", "intervals": [[0.0, 1.0]] }),
                json!({ "label": "acceleration", "intervals": null }),
                json!({ "label": "nodal force on tip", "intervals": null }),
                json!({ "label": "pressure on top", "intervals": [[1.0, 2.0], [3.0, null]] }),
                json!({ "label": "driven y-min", "intervals": [[0.0, 1.0]] }),
            ]
        );
    }

    #[test]
    fn a_measured_pulse_acts_while_its_rows_do() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("pulse.csv");
        std::fs::write(&file, "t,F\n0,0\n1,0\n2,5\n3,0\n4,0\n").unwrap();
        let text = |file: &str| {
            format!(
                "[[load]]\nforce = [1, 0, 0]\nhistory = {{ file = {file:?}, time = \"t\", value = \"F\" }}\n"
            )
        };
        let found = |file: &str| loads(&text(file).parse().unwrap())[0]["intervals"].clone();
        assert_eq!(found(file.to_str().unwrap()), json!([[1.0, 3.0]]));
        assert_eq!(found("gone.csv"), Value::Null);
    }

    #[test]
    fn very_many_loads_and_intervals_become_few() {
        let load = |i: usize| {
            format!(
                "[[load]]\ngroup = \"g{i}\"\nforce = [1, 0, 0]\nhistory = [[{i}, 0], [{i}.5, 1], [{i}.75, 0]]\n"
            )
        };
        let pulses: String = (0..10_000).map(load).collect();
        let input: Table = format!("{pulses}[[load]]\nacceleration = [0, 0, -9.81]\n").parse().unwrap();
        let found = loads(&input);
        assert_eq!(
            (found.len(), &found[0]["label"], &found[1]["label"]),
            (2, &json!("10000 loads"), &json!("1 load"))
        );
        // 20 pulses each.
        let intervals = found[0]["intervals"].as_array().unwrap();
        assert_eq!((intervals.len(), &intervals[1]), (500, &json!([20.0, 39.75])));
    }
}
