//! `convergence.csv` and its chart.

use std::io;
use std::path::Path;

use super::Study;
use crate::chart::{Axis, Chart, Guide, Series, Style};
use crate::whole_file::replace;

/// Measurements of a member.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measure {
    /// Norm of the error \[length time^(1/2)\].
    pub error: f64,
    /// The error over the norm of the displacement of the reference.
    pub relative_error: Option<f64>,
    /// Newton iterations.
    pub newton_iterations: usize,
}

/// A member of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct MemberRun {
    /// Step size.
    pub step_size: f64,
    /// The measurements, or why the run failed.
    pub outcome: Result<Measure, String>,
    /// Duration in seconds.
    pub wall_seconds: f64,
}

impl MemberRun {
    /// The error, if there is one.
    pub fn error(&self) -> Option<f64> {
        self.outcome.as_ref().ok().map(|measure| measure.error)
    }
}

/// Observed orders, each from a member and the one before:
///
/// ```math
/// ln(e_1 / e_2) / ln(h_1 / h_2)
/// ```
///
/// `None` for the first member, and where an error is missing or zero.
pub fn orders(rows: &[MemberRun]) -> Vec<Option<f64>> {
    let order = |pair: &[MemberRun]| {
        let (coarse, fine) = (pair[0].error()?, pair[1].error()?);
        let order = (coarse / fine).ln() / (pair[0].step_size / pair[1].step_size).ln();
        order.is_finite().then_some(order)
    };
    rows.first().map(|_| None).into_iter().chain(rows.windows(2).map(order)).collect()
}

/// Writes `convergence.csv`, `convergence.svg` and `convergence.png` into a directory.
///
/// # Errors
/// Errors of the system.
pub fn write(directory: &Path, study: &Study, rows: &[MemberRun]) -> io::Result<()> {
    replace(&directory.join("convergence.csv"), csv(rows).as_bytes())?;
    chart(study, rows).write(&directory.join("convergence"))
}

/// Numbers have 17 significant digits; missing ones are empty.
fn csv(rows: &[MemberRun]) -> String {
    let number = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:.16e}"));
    let line = |(row, order): (&MemberRun, Option<f64>)| {
        let size = number(Some(row.step_size));
        let error = number(row.error());
        format!("{size},{error},{},{}\n", number(order), number(Some(row.wall_seconds)))
    };
    let lines: String = rows.iter().zip(orders(rows)).map(line).collect();
    format!("step_size,error,order,wall_seconds\n{lines}")
}

/// Error over step size, with the slope of order 2k, the order of the scheme at the time nodes.
pub fn chart(study: &Study, rows: &[MemberRun]) -> Chart {
    let mut points: Vec<(f64, f64)> =
        rows.iter().filter_map(|row| Some((row.step_size, row.error()?))).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let order = 2 * study.scheme.degree();
    // Below all points.
    let height = |(size, error): &(f64, f64)| error.ln() - order as f64 * size.ln();
    let lowest =
        points.iter().filter(|(_, error)| *error > 0.0).min_by(|a, b| height(a).total_cmp(&height(b)));
    let guide = lowest.map(|&(size, error)| Guide {
        label: format!("order {order}"),
        slope: order as f64,
        through: (size, 0.6 * error),
    });
    let (start, end) = study.window;
    Chart {
        title: String::new(),
        x: Axis::log(study.units.label("step size h", "time")),
        y: Axis::log(format!("error ‖q − q*‖, {start} ≤ t ≤ {end}")),
        series: vec![Series {
            label: format!("{}, degree {}", study.scheme.name(), study.scheme.degree()),
            points,
            style: Style::LineAndPoints,
            colour: 0,
        }],
        guides: guide.into_iter().collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(step_size: f64, error: Option<f64>) -> MemberRun {
        let measure = |error| Measure { error, relative_error: None, newton_iterations: 1 };
        MemberRun { step_size, outcome: error.map(measure).ok_or_else(String::new), wall_seconds: 0.5 }
    }

    #[test]
    fn orders_are_against_the_row_before() {
        let rows = [row(0.4, Some(1.6)), row(0.2, Some(0.1)), row(0.1, None), row(0.05, Some(0.1))];
        let orders = orders(&rows);
        assert!((orders[1].unwrap() - 4.0).abs() < 1e-12);
        assert_eq!((orders[0], orders[2], orders[3]), (None, None, None));
        let csv = csv(&rows);
        let lines: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
        assert_eq!(lines[0], ["step_size", "error", "order", "wall_seconds"]);
        assert_eq!(lines[1][..3], ["4.0000000000000002e-1", "1.6000000000000001e0", ""]);
        assert_eq!((lines[3][1], lines[3][2], lines[3].len()), ("", "", 4));
        assert!(super::orders(&[]).is_empty());
    }
}
