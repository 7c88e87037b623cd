//! The rank of many constraints that touch few nodes each.

use std::collections::BTreeMap;

/// The rank of rows that come one by one: each is rotated into a triangular matrix, which stays sparse where bodies
/// form a chain (George and Heath, Linear Algebra Appl. 34 (1980) 69).
#[derive(Debug, Default)]
pub(crate) struct Rank {
    /// Rows by their first column: entries (column, number), ascending.
    rows: BTreeMap<usize, Vec<(usize, f64)>>,
}

/// Size of an entry over that of its row, at first, that is rounding.
const LEAST: f64 = 1e-8;

impl Rank {
    /// Adds a row. Returns whether it does not follow from those before it.
    pub(crate) fn add(&mut self, row: BTreeMap<usize, f64>) -> bool {
        let least = LEAST * row.values().map(|x| x * x).sum::<f64>().sqrt();
        let mut row: Vec<(usize, f64)> = row.into_iter().collect();
        loop {
            let lead = row.iter().position(|(_, x)| x.abs() > least);
            let Some(lead) = lead else { return false };
            row.drain(..lead);
            let Some(own) = self.rows.get_mut(&row[0].0) else {
                self.rows.insert(row[0].0, row);
                return true;
            };
            let (a, b) = (own[0].1, row[0].1);
            let length = a.hypot(b);
            row = rotate(own, &row, [a / length, b / length]);
        }
    }
}

/// Applies a Givens rotation, given by its cosine and sine, to two rows with the same first column. Returns the rest
/// of the second row, which has no entry there.
fn rotate(own: &mut Vec<(usize, f64)>, row: &[(usize, f64)], [c, s]: [f64; 2]) -> Vec<(usize, f64)> {
    let (mut turned, mut rest) =
        (Vec::with_capacity(own.len() + row.len()), Vec::with_capacity(own.len() + row.len()));
    let (mut i, mut j) = (0, 0);
    while i < own.len() || j < row.len() {
        let column = |all: &[(usize, f64)], at: usize| all.get(at).map_or(usize::MAX, |entry| entry.0);
        let next = column(own, i).min(column(row, j));
        let take = |all: &[(usize, f64)], at: &mut usize| {
            let is_here = column(all, *at) == next;
            *at += usize::from(is_here);
            if is_here { all[*at - 1].1 } else { 0.0 }
        };
        let (x, y) = (take(own, &mut i), take(row, &mut j));
        turned.push((next, c * x + s * y));
        rest.push((next, c * y - s * x));
    }
    *own = turned;
    rest.remove(0);
    rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_follow_from_others_are_found() {
        let row = |entries: &[(usize, f64)]| entries.iter().copied().collect::<BTreeMap<usize, f64>>();
        let mut rank = Rank::default();
        let rows = [
            (row(&[(0, 1.0), (1, 2.0), (4, -1.0)]), true),
            (row(&[(1, 0.3), (2, 0.1)]), true),
            (row(&[(0, 2.0), (1, 4.9), (2, 0.3), (4, -2.0)]), false),
            (row(&[(0, 1.0), (1, 2.0), (4, 1.0)]), true),
            (row(&[(4, 3.0)]), false),
            (row(&[]), false),
            (row(&[(3, 1e-3)]), true),
        ];
        for (n, (row, is_new)) in rows.into_iter().enumerate() {
            assert_eq!(rank.add(row), is_new, "row {n}");
        }
        assert_eq!(rank.rows.len(), 4);
    }
}
