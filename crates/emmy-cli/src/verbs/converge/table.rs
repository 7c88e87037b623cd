//! The result of a study on standard output.

use emmy_io::convergence::{MemberRun, Study, orders};
use serde_json::{Value, json};

use super::runs::Reference;
use crate::print::{columns, number};

/// As a table.
pub(super) fn text(rows: &[MemberRun]) -> String {
    let head = ["step size", "error", "order", "relative error", "corrections", "seconds"]
        .map(String::from)
        .to_vec();
    columns(
        std::iter::once(head)
            .chain(rows.iter().zip(orders(rows)).map(|(row, order)| line(row, order)))
            .collect(),
    )
}

/// As an object.
pub(super) fn json(study: &Study, reference: &Reference, rows: &[MemberRun]) -> Value {
    json!({
        "scheme": study.scheme.name(),
        "degree": study.scheme.degree(),
        "from": study.from,
        "window": [study.window.0, study.window.1],
        "reference": {
            "scheme": study.reference_scheme.name(),
            "step_size": study.reference_size,
            "degree": study.reference_scheme.degree(),
            "kept": reference.is_kept,
            "wall_seconds": reference.wall_seconds,
            "interpolated": reference.n_interpolated,
        },
        "rows": rows.iter().zip(orders(rows)).map(|(row, order)| object(row, order)).collect::<Vec<_>>(),
    })
}

fn line(row: &MemberRun, order: Option<f64>) -> Vec<String> {
    let measure = row.outcome.as_ref().ok();
    let relative = measure.and_then(|measure| measure.relative_error);
    vec![
        number(row.step_size),
        measure.map_or("no convergence".to_string(), |measure| format!("{:.4e}", measure.error)),
        order.map_or(String::new(), |order| format!("{order:.2}")),
        relative.map_or(String::new(), |relative| format!("{relative:.2e}")),
        measure.map_or(String::new(), |measure| measure.newton_iterations.to_string()),
        format!("{:.2}", row.wall_seconds),
    ]
}

fn object(row: &MemberRun, order: Option<f64>) -> Value {
    let measure = row.outcome.as_ref().ok();
    json!({
        "step_size": row.step_size,
        "error": row.error(),
        "order": order,
        "relative_error": measure.and_then(|measure| measure.relative_error),
        "newton_iterations": measure.map(|measure| measure.newton_iterations),
        "wall_seconds": row.wall_seconds,
        "message": row.outcome.as_ref().err(),
    })
}
