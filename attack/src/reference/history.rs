//! Functions of time, and their integrals.

use super::numbers::gauss;

/// A function of time.
#[derive(Debug, Clone, PartialEq)]
pub enum History {
    /// 1.
    Constant,
    /// Linear between entries, constant outside.
    Table(Vec<[f64; 2]>),
    /// `factor sin(rate t + phase)`.
    Sine {
        /// Amplitude.
        factor: f64,
        /// Angular frequency.
        rate: f64,
        /// Phase.
        phase: f64,
    },
    /// Double integral of a table, from rest at 0.
    Integrated(Vec<[f64; 2]>),
    /// `factor t^2`.
    Square(f64),
}

impl History {
    /// As Emmy's input has it.
    pub fn text(&self) -> String {
        match self {
            History::Constant => "1".into(),
            History::Table(rows) => format!("{rows:?}"),
            History::Sine { factor, rate, phase } => format!("\"{factor:?}*sin({rate:?}*t + {phase:?})\""),
            History::Integrated(rows) => format!("{rows:?}"),
            History::Square(factor) => format!("\"{factor:?}*t^2\""),
        }
    }

    /// The value; at a jump that after it.
    pub fn at(&self, t: f64) -> f64 {
        match self {
            History::Constant => 1.0,
            History::Sine { factor, rate, phase } => factor * (rate * t + phase).sin(),
            History::Integrated(rows) => integral(rows, t, |s| t - s),
            History::Square(factor) => factor * t * t,
            History::Table(rows) => {
                let after = rows.iter().position(|row| row[0] > t);
                match after {
                    Some(0) => rows[0][1],
                    None => rows[rows.len() - 1][1],
                    Some(i) => {
                        let [[t0, y0], [t1, y1]] = [rows[i - 1], rows[i]];
                        y0 + (y1 - y0) * (t - t0) / (t1 - t0)
                    }
                }
            }
        }
    }

    /// The rate on one side of a time.
    pub fn rate(&self, t: f64, is_before: bool) -> f64 {
        match self {
            History::Constant => 0.0,
            History::Sine { factor, rate, phase } => factor * rate * (rate * t + phase).cos(),
            History::Integrated(rows) => integral(rows, t, |_| 1.0),
            History::Square(factor) => 2.0 * factor * t,
            History::Table(rows) => {
                // The end of a step, which is its start and its size, may lie beside the kink by a rounding.
                let t = rows.iter().map(|row| row[0]).find(|kink| (kink - t).abs() < 1e-13).unwrap_or(t);
                let covers = |pair: &&[[f64; 2]]| match is_before {
                    true => pair[0][0] < t && t <= pair[1][0],
                    false => pair[0][0] <= t && t < pair[1][0],
                };
                let slope = |pair: &[[f64; 2]]| (pair[1][1] - pair[0][1]) / (pair[1][0] - pair[0][0]);
                rows.windows(2).find(covers).map_or(0.0, slope)
            }
        }
    }

    /// Times at which it has kinks or jumps.
    pub fn kinks(&self) -> Vec<f64> {
        match self {
            History::Table(rows) | History::Integrated(rows) => rows.iter().map(|row| row[0]).collect(),
            _ => Vec::new(),
        }
    }
}

/// Integral of a table with a weight, from 0 to a time.
fn integral(rows: &[[f64; 2]], t: f64, weight: impl Fn(f64) -> f64) -> f64 {
    let table = History::Table(rows.to_vec());
    let sum = pieces(0.0, t.max(1e-300), &table.kinks()).into_iter();
    sum.map(|(a, w)| w * t * table.at(a * t) * weight(a * t)).sum()
}

/// Fractions of a step with weights, for a function that is smooth between kinks.
pub fn pieces(t: f64, h: f64, kinks: &[f64]) -> Vec<(f64, f64)> {
    let inside = kinks.iter().map(|kink| (kink - t) / h).filter(|a| *a > 1e-12 && *a < 1.0 - 1e-12);
    let mut ends: Vec<f64> = [0.0, 1.0].into_iter().chain(inside).collect();
    ends.sort_by(f64::total_cmp);
    let piece = |pair: &[f64]| {
        let (start, length) = (pair[0], pair[1] - pair[0]);
        gauss(14).into_iter().map(move |(a, w)| (start + length * a, length * w)).collect::<Vec<_>>()
    };
    ends.windows(2).flat_map(piece).collect()
}
