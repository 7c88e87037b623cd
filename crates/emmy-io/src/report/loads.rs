//! When loads and driven supports of an input act, as far as their histories are tables.

use serde_json::{Value, json};
use toml::Table;

/// What does work on the body of a resolved input: `[{ label, intervals }]`; `intervals`: null for what acts throughout, an end
/// of null for what does not end. Attractions belong to the energy of the body and are no loads here.
pub(super) fn loads(input: &Table) -> Vec<Value> {
    let entries = |name: &str| {
        let list = input.get(name).and_then(toml::Value::as_array);
        list.into_iter().flatten().filter_map(toml::Value::as_table)
    };
    let loads = entries("load").filter(|load| !load.contains_key("attraction")).map(load);
    let is_driven = |support: &&Table| support.contains_key("move") || support.contains_key("rotate");
    loads.chain(entries("support").filter(is_driven).map(driven_support)).collect()
}

fn driven_support(support: &Table) -> Value {
    let group = support.get("group").and_then(toml::Value::as_str).unwrap_or_default();
    let until = support.get("until").and_then(number);
    json!({ "label": format!("driven {group}"), "intervals": until.map(|until| [[0.0, until]]) })
}

fn number(value: &toml::Value) -> Option<f64> {
    value.as_float().or(value.as_integer().map(|whole| whole as f64))
}

fn load(load: &Table) -> Value {
    let kind = load.keys().find(|key| !matches!(key.as_str(), "group" | "history"));
    let kind = kind.map_or("load", String::as_str).replace('_', " ");
    let group = load.get("group").and_then(toml::Value::as_str);
    let label = group.map_or(kind.clone(), |group| format!("{kind} on {group}"));
    let table = load.get("history").and_then(toml::Value::as_array).map(|points| table(points));
    json!({ "label": label, "intervals": table.and_then(|points| intervals(&points)) })
}

/// Times and factors of a history; what is none of them is left out, for the input has been checked.
fn table(points: &[toml::Value]) -> Vec<[f64; 2]> {
    let point = |point: &toml::Value| match point.as_array().map(Vec::as_slice) {
        Some([time, factor]) => Some([number(time)?, number(factor)?]),
        _ => None,
    };
    points.iter().filter_map(point).collect()
}

/// Intervals in which a table is not zero, joined; `None` if it is zero nowhere.
fn intervals(points: &[[f64; 2]]) -> Option<Vec<[Option<f64>; 2]>> {
    let mut intervals: Vec<[Option<f64>; 2]> = Vec::new();
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
}
