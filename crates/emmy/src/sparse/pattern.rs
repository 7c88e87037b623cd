//! Pattern of couplings between nodes.

/// Couplings of nodes: compressed rows, columns ascending, the diagonal included, structurally symmetric.
///
/// ```
/// use emmy::internals::sparse::Pattern;
/// let pattern = Pattern::new(3, [&[0u32, 1][..], &[1, 2]].into_iter());
/// assert_eq!(pattern.row(1), [0, 1, 2]);
/// assert_eq!(pattern.position(1, 2), Some(4));
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern {
    row_begin: Vec<usize>,
    columns: Vec<u32>,
    /// First inner row.
    inner_from: usize,
}

impl Pattern {
    /// The pattern that couples all nodes of each list with each other.
    pub fn new<'a>(n_rows: usize, lists: impl Iterator<Item = &'a [u32]>) -> Self {
        let (begin, list_of_row, lists) = lists_by_row(n_rows, lists);
        let mut row_begin = vec![0];
        let mut columns = Vec::new();
        let mut seen = vec![u32::MAX; n_rows];
        for row in 0..n_rows {
            let start = columns.len();
            seen[row] = row as u32;
            columns.push(row as u32);
            for &list in &list_of_row[begin[row]..begin[row + 1]] {
                for &column in lists[list as usize] {
                    if seen[column as usize] != row as u32 {
                        seen[column as usize] = row as u32;
                        columns.push(column);
                    }
                }
            }
            columns[start..].sort_unstable();
            row_begin.push(columns.len());
        }
        Pattern { row_begin, columns, inner_from: n_rows }
    }

    /// The pattern of compressed rows; each has its diagonal, columns are ascending, and the structure is symmetric.
    pub(super) fn from_rows(row_begin: Vec<usize>, columns: Vec<u32>) -> Self {
        Pattern { inner_from: row_begin.len() - 1, row_begin, columns }
    }

    /// The pattern with further couplings and their mirror images.
    pub(super) fn with_couplings(&self, pairs: &[[u32; 2]]) -> Self {
        let mut further: Vec<[u32; 2]> = pairs.iter().flat_map(|&[a, b]| [[a, b], [b, a]]).collect();
        further.sort_unstable();
        let (mut row_begin, mut columns) = (vec![0], Vec::with_capacity(self.columns.len() + further.len()));
        for row in 0..self.n_rows() {
            let first = further.partition_point(|[own, _]| (*own as usize) < row);
            let own = further[first..].iter().take_while(|[own, _]| *own as usize == row);
            let mut all: Vec<u32> =
                self.row(row).iter().copied().chain(own.map(|[_, column]| *column)).collect();
            all.sort_unstable();
            all.dedup();
            columns.extend(all);
            row_begin.push(columns.len());
        }
        Pattern { row_begin, columns, inner_from: self.inner_from }
    }

    /// The pattern with the rows from a number on as *inner* rows: each is coupled within one list alone, so that the
    /// elimination of the inner rows before the others has no fill. The orders of factorisations heed it.
    pub fn with_inner_rows_from(self, row: usize) -> Self {
        Pattern { inner_from: row, ..self }
    }

    /// Number of outer rows, which come first.
    pub(super) fn n_outer(&self) -> usize {
        self.inner_from
    }

    /// Number of outer columns of a row; they come first.
    pub(crate) fn n_outer_columns(&self, row: usize) -> usize {
        match self.inner_from == self.n_rows() {
            true => self.row(row).len(),
            false => self.row(row).partition_point(|&column| (column as usize) < self.inner_from),
        }
    }

    /// Number of couplings of outer rows with each other.
    pub fn n_outer_blocks(&self) -> usize {
        (0..self.inner_from).map(|row| self.n_outer_columns(row)).sum()
    }

    /// The pattern of the outer rows.
    pub(super) fn outer(&self) -> Pattern {
        let mut row_begin = vec![0];
        let mut columns = Vec::with_capacity(self.n_outer_blocks());
        for row in 0..self.inner_from {
            columns.extend_from_slice(&self.row(row)[..self.n_outer_columns(row)]);
            row_begin.push(columns.len());
        }
        Pattern { row_begin, columns, inner_from: self.inner_from }
    }

    /// An order of all rows from one of the outer rows: each inner row comes right before the first of its outer
    /// neighbours.
    pub(super) fn with_inner_rows(&self, outer: Vec<usize>) -> Vec<usize> {
        let mut order = Vec::with_capacity(self.n_rows());
        let mut seen = vec![false; self.n_rows() - self.inner_from];
        for row in outer {
            for &inner in &self.row(row)[self.n_outer_columns(row)..] {
                if !std::mem::replace(&mut seen[inner as usize - self.inner_from], true) {
                    order.push(inner as usize);
                }
            }
            order.push(row);
        }
        order
    }

    /// Number of rows.
    pub fn n_rows(&self) -> usize {
        self.row_begin.len() - 1
    }

    /// Number of couplings.
    pub fn n_blocks(&self) -> usize {
        self.columns.len()
    }

    /// Columns of a row, ascending.
    pub fn row(&self, row: usize) -> &[u32] {
        &self.columns[self.range(row)]
    }

    /// Positions of a row's couplings.
    pub fn range(&self, row: usize) -> std::ops::Range<usize> {
        self.row_begin[row]..self.row_begin[row + 1]
    }

    /// Position of the coupling of a row with a column.
    pub fn position(&self, row: usize, column: usize) -> Option<usize> {
        let found = self.row(row).binary_search(&(column as u32));
        found.ok().map(|offset| self.row_begin[row] + offset)
    }

    /// Position of a column in a row that has it.
    ///
    /// # Panics
    /// If the row does not have the column.
    pub fn coupling(&self, row: usize, column: usize) -> usize {
        self.position(row, column).expect("the pattern has every coupling of a body")
    }

    /// Contiguous ranges of all rows with about equal numbers of couplings.
    pub fn divided(&self, n_parts: usize) -> Vec<std::ops::Range<usize>> {
        self.divided_until(self.n_rows(), n_parts)
    }

    /// Contiguous ranges of the first rows with about equal numbers of couplings.
    pub fn divided_until(&self, n_rows: usize, n_parts: usize) -> Vec<std::ops::Range<usize>> {
        let boundary = |part: usize| {
            let wanted = self.row_begin[n_rows] * part / n_parts;
            self.row_begin.partition_point(|&begin| begin < wanted).min(n_rows)
        };
        (0..n_parts)
            .map(|part| boundary(part)..if part + 1 == n_parts { n_rows } else { boundary(part + 1) })
            .collect()
    }
}

/// For every row its lists, as compressed rows.
fn lists_by_row<'a>(
    n_rows: usize,
    lists: impl Iterator<Item = &'a [u32]>,
) -> (Vec<usize>, Vec<u32>, Vec<&'a [u32]>) {
    let lists: Vec<&[u32]> = lists.collect();
    let mut begin = vec![0; n_rows + 1];
    lists.iter().flat_map(|list| list.iter()).for_each(|&row| begin[row as usize + 1] += 1);
    (0..n_rows).for_each(|row| begin[row + 1] += begin[row]);
    let mut next = begin.clone();
    let mut list_of_row = vec![0; begin[n_rows]];
    for (index, list) in lists.iter().enumerate() {
        for &row in *list {
            list_of_row[next[row as usize]] = index as u32;
            next[row as usize] += 1;
        }
    }
    (begin, list_of_row, lists)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_cover_all_rows_once() {
        let lists: Vec<[u32; 2]> = (0..9).map(|i| [i, i + 1]).collect();
        let pattern = Pattern::new(10, lists.iter().map(|list| &list[..]));
        for n_parts in 1..14 {
            let parts = pattern.divided(n_parts);
            assert_eq!((parts.len(), parts[0].start, parts[n_parts - 1].end), (n_parts, 0, 10));
            assert!(parts.windows(2).all(|pair| pair[0].end == pair[1].start));
        }
    }
}
