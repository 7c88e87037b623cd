//! Chooses the rows of a long history while it is read, so that only the chosen rows are in memory.

use std::rc::Rc;

/// A row with its index.
pub(super) type KeptRow = (usize, Rc<Vec<f64>>);

/// Chooses at most `limit` of `n` rows; returns them in ascending order, and how many intervals they form. If rows are
/// left out, each interval keeps its first row and the rows with the smallest and the largest value of every peaked
/// column; the last row is kept too.
pub(super) fn kept_rows<E>(
    rows: impl Iterator<Item = Result<Vec<f64>, E>>,
    n: usize,
    columns: &[usize],
    limit: usize,
) -> Result<(Vec<KeptRow>, usize), E> {
    let stretches = if n <= limit { n } else { (limit / (2 * columns.len() + 1)).max(1) };
    let length = n.div_ceil(stretches.max(1)).max(1);
    let (mut kept, mut extremes): (Vec<KeptRow>, Vec<[KeptRow; 2]>) = (Vec::new(), Vec::new());
    let mut last = None;
    for (index, row) in rows.take(n).enumerate() {
        let row: KeptRow = (index, Rc::new(row?));
        if index % length == 0 {
            kept.extend(extremes.drain(..).flatten());
            kept.push(row.clone());
            extremes = vec![[row.clone(), row.clone()]; if length > 1 { columns.len() } else { 0 }];
        }
        for ([least, most], &column) in extremes.iter_mut().zip(columns) {
            // NaN is an extreme too.
            let by = |other: &KeptRow| row.1[column].total_cmp(&other.1[column]);
            if by(least).is_lt() {
                *least = row.clone();
            }
            // A first row without a number stays in any case.
            if by(most).is_ge() || (most.0 % length == 0 && most.1[column].is_nan()) {
                *most = row.clone();
            }
        }
        last = Some(row);
    }
    kept.extend(extremes.into_iter().flatten());
    kept.extend(last);
    kept.sort_unstable_by_key(|row| row.0);
    kept.dedup_by_key(|row| row.0);
    Ok((kept, n.div_ceil(length)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(n: usize) -> Vec<Vec<f64>> {
        // Fractions of multiples of irrational numbers.
        (0..n)
            .map(|i| vec![i as f64, (i as f64 * 0.618_033_988_7).fract(), (i as f64 * 0.414_213_562).fract()])
            .collect()
    }

    fn kept_of(rows: &[Vec<f64>], limit: usize) -> (Vec<usize>, usize) {
        let all = rows.iter().cloned().map(Ok::<_, ()>);
        let (kept, stretches) = kept_rows(all, rows.len(), &[1, 2], limit).unwrap();
        assert!(
            kept.iter()
                .all(|(index, row)| row.iter().zip(&rows[*index]).all(|(a, b)| a.to_bits() == b.to_bits()))
        );
        (kept.into_iter().map(|(index, _)| index).collect(), stretches)
    }

    #[test]
    fn short_histories_stay_whole() {
        assert_eq!(kept_of(&noise(100), 100).0, (0..100).collect::<Vec<_>>());
        assert_eq!(kept_of(&[], 100).0, [0; 0]);
    }

    /// Reactions have no value at the start.
    #[test]
    fn a_first_row_without_a_number_hides_no_peak() {
        let mut rows = noise(50_000);
        rows[0][1] = f64::NAN;
        rows[7][1] = 1e6;
        let (kept, _) = kept_of(&rows, 1000);
        assert!(kept[0] == 0 && kept.contains(&7));
    }

    #[test]
    fn every_peak_of_a_long_history_stays() {
        let mut rows = noise(50_000);
        rows[31_007][2] = f64::NAN;
        rows[47_011][1] = 1e6;
        let (kept, stretches) = kept_of(&rows, 1000);
        assert!(kept.len() <= 1001 && kept.len() > 600, "{}", kept.len());
        assert!(kept.is_sorted() && kept[0] == 0 && kept.last() == Some(&49_999));
        assert!(kept.contains(&31_007) && kept.contains(&47_011));
        let length = rows.len().div_ceil(stretches);
        let range = |rows: &mut dyn Iterator<Item = usize>, all: &[Vec<f64>]| {
            rows.map(|row| all[row][1]).fold([f64::MAX, f64::MIN], |[a, b], x| [a.min(x), b.max(x)])
        };
        for begin in (0..rows.len()).step_by(length) {
            let inside = begin..(begin + length).min(rows.len());
            let mut kept = kept.iter().copied().filter(|row| inside.contains(row));
            assert_eq!(range(&mut kept, &rows), range(&mut inside.clone(), &rows));
        }
    }
}
