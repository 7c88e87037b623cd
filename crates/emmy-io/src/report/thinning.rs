//! Which rows of a long history are kept.

/// Rows that are kept, ascending: all of them up to `limit`; else of each of some stretches the first one and those with the
/// smallest and the largest number of every column that is asked for, and the last one of all. With the number of stretches.
pub(super) fn kept_rows(rows: &[Vec<f64>], columns: &[usize], limit: usize) -> (Vec<usize>, usize) {
    if rows.len() <= limit {
        return ((0..rows.len()).collect(), rows.len());
    }
    let stretches = (limit / (2 * columns.len() + 1)).max(1);
    let length = rows.len().div_ceil(stretches);
    let mut kept = Vec::new();
    for (index, stretch) in rows.chunks(length).enumerate() {
        let first = index * length;
        kept.push(first);
        for &column in columns {
            // A number that is none is an extreme of its own.
            let by = |a: &(usize, f64), b: &(usize, f64)| a.1.total_cmp(&b.1);
            let numbers = || stretch.iter().map(|row| row[column]).enumerate();
            kept.extend(numbers().min_by(by).map(|(at, _)| first + at));
            kept.extend(numbers().max_by(by).map(|(at, _)| first + at));
        }
    }
    kept.push(rows.len() - 1);
    kept.sort_unstable();
    kept.dedup();
    (kept, rows.len().div_ceil(length))
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

    #[test]
    fn short_histories_stay_whole() {
        assert_eq!(kept_rows(&noise(100), &[1, 2], 100).0, (0..100).collect::<Vec<_>>());
    }

    #[test]
    fn every_peak_of_a_long_history_stays() {
        let mut rows = noise(50_000);
        rows[31_007][2] = f64::NAN;
        rows[47_011][1] = 1e6;
        let (kept, stretches) = kept_rows(&rows, &[1, 2], 1000);
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
