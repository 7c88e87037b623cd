//! An order of the rows of a pattern for iterative solvers: neighbours are close to each other, and several threads can
//! sweep through the rows.

use std::ops::Range;

use super::Pattern;

/// Rows in the order of Cuthill and McKee (1969), divided into chunks whose interiors are not coupled with each other.
///
/// A chunk is a range of that order. Its rows that are coupled with a later chunk form its *interface*, the others its
/// *interior*. All interiors come first, then all interfaces. A triangular sweep treats all interiors in parallel, and
/// then all interfaces. The division depends on the pattern alone, not on the number of threads.
#[derive(Debug, Clone)]
pub(crate) struct SweepOrder {
    /// Old number of each row, `[new]`.
    pub order: Vec<u32>,
    /// Start of the couplings of each row left of its diagonal, `[n_rows + 1]`. Those of all rows come first: a
    /// triangular sweep then reads its half of a matrix without gaps.
    pub left_begin: Vec<usize>,
    /// Start of the other couplings of each row, beginning with its diagonal, `[n_rows + 1]`.
    pub right_begin: Vec<usize>,
    /// Columns in the new numbers, ascending in each half of a row.
    pub columns: Vec<u32>,
    /// Position of each coupling in the pattern.
    pub source: Vec<u32>,
    /// Position of the transposed coupling (column, row) for each coupling (row, column).
    pub mirror: Vec<u32>,
    /// Rows of the interiors, then of the interfaces; the ranges of a kind are consecutive.
    pub interiors: Vec<Range<usize>>,
    /// Rows of the interfaces.
    pub interfaces: Vec<Range<usize>>,
}

/// Largest number of chunks: threads that can sweep in parallel.
const MAX_CHUNKS: usize = 8;

/// Smallest number of rows of a chunk, lower for two chunks than for more. Every interface costs iterations: in the
/// block of `benches`, 10 % more with two chunks and 19 % with four than with one at r = 4, 11 % and 16 % at r = 6.
const MIN_ROWS: usize = 6144;
const MIN_ROWS_OF_TWO: usize = 4096;

impl SweepOrder {
    /// The order of a pattern.
    pub(crate) fn new(pattern: &Pattern) -> Self {
        let levels = cuthill_mckee(pattern);
        let n = pattern.n_rows();
        let most = (n / MIN_ROWS).max((n / MIN_ROWS_OF_TWO).min(2)).clamp(1, MAX_CHUNKS);
        // A power of two: equal parts for two threads and for four.
        let mut n_chunks = 1 << most.ilog2();
        loop {
            let (order, interiors, interfaces) = divided(pattern, &levels, n_chunks);
            let sweep = SweepOrder::renumbered(pattern, order, interiors, interfaces);
            // Thin chunks have interfaces that meet; then there are fewer chunks.
            if n_chunks == 1 || sweep.interfaces_are_apart() {
                return sweep;
            }
            n_chunks /= 2;
        }
    }

    /// Number of rows.
    pub(crate) fn n_rows(&self) -> usize {
        self.order.len()
    }

    /// Couplings of a row left of its diagonal.
    #[inline(always)]
    pub(crate) fn left(&self, row: usize) -> Range<usize> {
        self.left_begin[row]..self.left_begin[row + 1]
    }

    /// Coupling of a row with itself.
    #[inline(always)]
    pub(crate) fn diagonal(&self, row: usize) -> usize {
        self.right_begin[row]
    }

    /// Couplings of a row right of its diagonal.
    #[inline(always)]
    pub(crate) fn right(&self, row: usize) -> Range<usize> {
        self.right_begin[row] + 1..self.right_begin[row + 1]
    }

    /// Both halves of a row, the second one with the diagonal.
    #[inline(always)]
    pub(crate) fn halves(&self, row: usize) -> [Range<usize>; 2] {
        [self.left(row), self.right_begin[row]..self.right_begin[row + 1]]
    }

    /// Number of rows in all interiors.
    pub(crate) fn n_interior(&self) -> usize {
        self.interiors.last().map_or(0, |range| range.end)
    }

    fn renumbered(
        pattern: &Pattern,
        order: Vec<u32>,
        interiors: Vec<Range<usize>>,
        interfaces: Vec<Range<usize>>,
    ) -> Self {
        let mut number = vec![0u32; order.len()];
        order.iter().enumerate().for_each(|(new, &old)| number[old as usize] = new as u32);
        let mut columns = Vec::with_capacity(pattern.n_blocks());
        let mut source = Vec::with_capacity(pattern.n_blocks());
        let mut row: Vec<(u32, u32)> = Vec::new();
        let mut half = |is_left: bool| -> Vec<usize> {
            let mut begin = vec![columns.len()];
            for (new, &old) in order.iter().enumerate() {
                let couplings = pattern.row(old as usize).iter().zip(pattern.range(old as usize));
                let couplings = couplings.map(|(&column, at)| (number[column as usize], at as u32));
                row.clear();
                row.extend(couplings.filter(|&(column, _)| ((column as usize) < new) == is_left));
                row.sort_unstable();
                columns.extend(row.iter().map(|(column, _)| column));
                source.extend(row.iter().map(|(_, position)| position));
                begin.push(columns.len());
            }
            begin
        };
        let (left_begin, right_begin) = (half(true), half(false));
        let mirror = mirrored(&left_begin, &right_begin, &columns);
        SweepOrder { order, left_begin, right_begin, columns, source, mirror, interiors, interfaces }
    }

    /// Columns of the couplings of some rows.
    fn columns_of(&self, rows: &Range<usize>) -> impl Iterator<Item = usize> {
        let left = &self.columns[self.left_begin[rows.start]..self.left_begin[rows.end]];
        let right = &self.columns[self.right_begin[rows.start]..self.right_begin[rows.end]];
        left.iter().chain(right).map(|&column| column as usize)
    }

    fn interfaces_are_apart(&self) -> bool {
        let is_apart = |rows: &Range<usize>| {
            self.columns_of(rows).all(|column| column < self.n_interior() || rows.contains(&column))
        };
        self.interfaces.iter().all(is_apart)
    }
}

/// Position of the transpose of each coupling.
fn mirrored(left_begin: &[usize], right_begin: &[usize], columns: &[u32]) -> Vec<u32> {
    let (mut next_left, mut next_right) = (left_begin.to_vec(), right_begin.to_vec());
    let mut mirror = vec![0; columns.len()];
    // Rows ascend: the couplings of a column are met in their order in its row, its diagonal before those on the right.
    for row in 0..left_begin.len() - 1 {
        let halves = [left_begin[row]..left_begin[row + 1], right_begin[row]..right_begin[row + 1]];
        for position in halves.into_iter().flatten() {
            let column = columns[position] as usize;
            let next = if column > row { &mut next_left } else { &mut next_right };
            mirror[position] = next[column] as u32;
            next[column] += 1;
        }
    }
    mirror
}

/// Breadth-first order of the rows, from a row far from the middle, component by component.
fn cuthill_mckee(pattern: &Pattern) -> Vec<u32> {
    let n = pattern.n_rows();
    let mut order = Vec::with_capacity(n);
    let mut seen = vec![false; n];
    for row in 0..n {
        if seen[row] {
            continue;
        }
        // The last row of a first search is at the rim of the component.
        let start = order.len();
        search(pattern, row, &mut seen, &mut order);
        let rim = order[order.len() - 1] as usize;
        order[start..].iter().for_each(|&row| seen[row as usize] = false);
        order.truncate(start);
        search(pattern, rim, &mut seen, &mut order);
    }
    order
}

/// Appends the rows reachable from a row, nearest first; among neighbours, rows with few couplings first.
fn search(pattern: &Pattern, from: usize, seen: &mut [bool], order: &mut Vec<u32>) {
    let mut next = order.len();
    seen[from] = true;
    order.push(from as u32);
    while next < order.len() {
        let first = order.len();
        for &row in pattern.row(order[next] as usize) {
            if !seen[row as usize] {
                seen[row as usize] = true;
                order.push(row);
            }
        }
        order[first..].sort_by_key(|&row| (pattern.range(row as usize).len(), row));
        next += 1;
    }
}

/// Divides an order into chunks: all interiors, then all interfaces.
fn divided(
    pattern: &Pattern,
    levels: &[u32],
    n_chunks: usize,
) -> (Vec<u32>, Vec<Range<usize>>, Vec<Range<usize>>) {
    let n = levels.len();
    let mut chunk_of = vec![0u32; n];
    let chunk = |chunk: usize| chunk * n / n_chunks..(chunk + 1) * n / n_chunks;
    for index in 0..n_chunks {
        levels[chunk(index)].iter().for_each(|&row| chunk_of[row as usize] = index as u32);
    }
    let is_interface = |row: u32| {
        let own = chunk_of[row as usize];
        pattern.row(row as usize).iter().any(|&column| chunk_of[column as usize] > own)
    };
    let mut order = Vec::with_capacity(n);
    let mut ranges = [Vec::new(), Vec::new()];
    for (kind, ranges) in ranges.iter_mut().enumerate() {
        for index in 0..n_chunks {
            let start = order.len();
            order.extend(levels[chunk(index)].iter().filter(|&&row| is_interface(row) == (kind == 1)));
            ranges.push(start..order.len());
        }
    }
    let [interiors, interfaces] = ranges;
    (order, interiors, interfaces)
}

/// Works on consecutive ranges, each with its own part of a slice; `at(row)`: start of a row in the slice.
pub(super) fn side_by_side<T: Send>(
    slice: &mut [T],
    ranges: &[Range<usize>],
    at: &(impl Fn(usize) -> usize + Sync),
    work: &(impl Fn(&mut [T], Range<usize>) + Sync),
) {
    match ranges {
        [] => {}
        [rows] => work(slice, rows.clone()),
        _ => {
            let (left, right) = ranges.split_at(ranges.len() / 2);
            let (low, high) = slice.split_at_mut(at(right[0].start) - at(left[0].start));
            rayon::join(|| side_by_side(low, left, at, work), || side_by_side(high, right, at, work));
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A box of nodes, each coupled with its 26 neighbours.
    pub(crate) fn grid(size: [usize; 3]) -> Pattern {
        let node = |x: usize, y: usize, z: usize| ((z * size[1] + y) * size[0] + x) as u32;
        let mut cells = Vec::new();
        for z in 0..size[2] - 1 {
            for y in 0..size[1] - 1 {
                for x in 0..size[0] - 1 {
                    cells.push([0, 1, 2, 3, 4, 5, 6, 7].map(|c| node(x + c % 2, y + c / 2 % 2, z + c / 4)));
                }
            }
        }
        Pattern::new(size.iter().product(), cells.iter().map(|cell| &cell[..]))
    }

    #[test]
    fn every_row_comes_once_and_mirrors_are_transposes() {
        let pattern = grid([7, 6, 640]);
        let sweep = SweepOrder::new(&pattern);
        assert!(sweep.interiors.len() > 2, "{:?}", sweep.interiors);
        let mut rows = sweep.order.clone();
        rows.sort_unstable();
        assert!(rows.iter().enumerate().all(|(index, &row)| index == row as usize));
        for row in 0..sweep.n_rows() {
            assert_eq!(sweep.columns[sweep.diagonal(row)] as usize, row);
            assert!(sweep.columns[sweep.left(row)].iter().all(|&column| (column as usize) < row));
            assert!(sweep.columns[sweep.right(row)].iter().all(|&column| column as usize > row));
            for position in sweep.halves(row).into_iter().flatten() {
                let column = sweep.columns[position] as usize;
                let mirror = sweep.mirror[position] as usize;
                assert_eq!(sweep.columns[mirror] as usize, row);
                assert!(sweep.halves(column).iter().any(|half| half.contains(&mirror)));
                let old = pattern.position(sweep.order[row] as usize, sweep.order[column] as usize);
                assert_eq!(old, Some(sweep.source[position] as usize));
            }
        }
    }

    #[test]
    fn interiors_are_coupled_with_themselves_and_interfaces_only() {
        let sweep = SweepOrder::new(&grid([5, 5, 700]));
        assert!(sweep.interfaces_are_apart());
        for rows in &sweep.interiors {
            let is_inside = |column: usize| rows.contains(&column) || column >= sweep.n_interior();
            assert!(sweep.columns_of(rows).all(is_inside));
        }
    }

    #[test]
    fn parts_that_are_not_coupled_are_all_reached() {
        let pattern = Pattern::new(5, [[0u32, 1], [3, 4]].iter().map(|list| &list[..]));
        assert_eq!(SweepOrder::new(&pattern).n_rows(), 5);
    }
}
