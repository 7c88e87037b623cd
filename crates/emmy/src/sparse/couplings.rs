//! Blocks of a stage matrix beyond its pattern.

/// End of a list.
const NONE: u32 = u32::MAX;

/// Blocks between nodes that come near each other for a while, in the order in which they were added.
///
/// ```
/// use emmy::internals::sparse::Couplings;
/// let mut couplings = Couplings::new(1);
/// couplings.block_mut(0, 2)[0] += 3.0;
/// couplings.block_mut(0, 2)[0] += 1.0;
/// let mut y = [0.0; 9];
/// couplings.add_product(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0], &mut y);
/// assert_eq!((couplings.len(), y[0]), (1, 8.0));
/// ```
#[derive(Debug, Clone, Default)]
pub struct Couplings {
    degree: usize,
    nodes: Vec<(u32, u32)>,
    /// The latest coupling of each row, and the one before each coupling in its row: rows have so few that these lists
    /// are faster than a hash table.
    latest: Vec<u32>,
    before: Vec<u32>,
    /// `[coupling][i k + j][3 a + b]`.
    blocks: Vec<f64>,
}

impl Couplings {
    /// No couplings, of k stages.
    pub fn new(degree: usize) -> Self {
        Couplings { degree, ..Couplings::default() }
    }

    /// Number of stages k.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Number of couplings.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Removes all.
    pub fn clear(&mut self) {
        self.nodes.iter().for_each(|(row, _)| self.latest[*row as usize] = NONE);
        self.nodes.clear();
        self.before.clear();
        self.blocks.clear();
    }

    fn size(&self) -> usize {
        9 * self.degree * self.degree
    }

    /// Number of a coupling.
    fn find(&self, row: u32, column: u32) -> Option<u32> {
        let mut place = self.latest.get(row as usize).copied().unwrap_or(NONE);
        while place != NONE && self.nodes[place as usize].1 != column {
            place = self.before[place as usize];
        }
        (place != NONE).then_some(place)
    }

    /// Adds the next coupling to the list of its row.
    fn link(&mut self, place: usize) {
        let row = self.nodes[place].0 as usize;
        if self.latest.len() <= row {
            self.latest.resize(row + 1, NONE);
        }
        self.before.push(std::mem::replace(&mut self.latest[row], place as u32));
    }

    /// The blocks of a row and a column, `[i k + j][3 a + b]`; zero at first.
    pub fn block_mut(&mut self, row: u32, column: u32) -> &mut [f64] {
        let size = self.size();
        let place = self.find(row, column).unwrap_or_else(|| {
            self.nodes.push((row, column));
            self.link(self.nodes.len() - 1);
            self.blocks.resize(self.blocks.len() + size, 0.0);
            self.nodes.len() as u32 - 1
        });
        &mut self.blocks[place as usize * size..][..size]
    }

    /// The couplings with their blocks.
    pub fn iter(&self) -> impl Iterator<Item = ([usize; 2], &[f64])> {
        let nodes = self.nodes.iter().map(|&(row, column)| [row as usize, column as usize]);
        nodes.zip(self.blocks.chunks_exact(self.size().max(1)))
    }

    /// Adds the product with a vector; `x`, `y`: `[k][n_rows][3]`.
    pub fn add_product(&self, x: &[f64], y: &mut [f64]) {
        let (k, stride) = (self.degree, x.len() / self.degree.max(1));
        for ([row, column], blocks) in self.iter() {
            for i in 0..k {
                let mut sum = [0.0; 3];
                for j in 0..k {
                    let block = &blocks[9 * (i * k + j)..][..9];
                    let x = &x[j * stride + 3 * column..][..3];
                    for a in 0..3 {
                        sum[a] += block[3 * a] * x[0] + block[3 * a + 1] * x[1] + block[3 * a + 2] * x[2];
                    }
                }
                let y = &mut y[i * stride + 3 * row..][..3];
                y.iter_mut().zip(sum).for_each(|(y, sum)| *y += sum);
            }
        }
    }

    /// Moves the blocks of nodes that follow others to these, times weights.
    pub fn fold<'l>(&mut self, leaders_of: impl Fn(u32) -> Option<&'l [(u32, f64)]>) {
        for place in 0..self.nodes.len() {
            let (row, column) = self.nodes[place];
            let (own_row, own_column) = ([(row, 1.0)], [(column, 1.0)]);
            let (rows, columns) = (leaders_of(row), leaders_of(column));
            if rows.is_none() && columns.is_none() {
                continue;
            }
            let range = place * self.size()..(place + 1) * self.size();
            let own = self.blocks[range.clone()].to_vec();
            self.blocks[range].fill(0.0);
            for &(to_row, row_weight) in rows.unwrap_or(&own_row) {
                for &(to_column, weight) in columns.unwrap_or(&own_column) {
                    let sums = self.block_mut(to_row, to_column).iter_mut().zip(&own);
                    sums.for_each(|(sum, entry)| *sum += row_weight * weight * entry);
                }
            }
        }
    }

    /// Replaces the matrix by its transpose.
    pub fn transpose(&mut self) {
        let (k, size) = (self.degree, self.size());
        for (nodes, blocks) in self.nodes.iter_mut().zip(self.blocks.chunks_exact_mut(size.max(1))) {
            *nodes = (nodes.1, nodes.0);
            let own = blocks.to_vec();
            for (at, entry) in blocks.iter_mut().enumerate() {
                let (stages, within) = (at / 9, at % 9);
                *entry = own[9 * (stages % k * k + stages / k) + 3 * (within % 3) + within / 3];
            }
        }
        self.latest.fill(NONE);
        self.before.clear();
        (0..self.nodes.len()).for_each(|place| self.link(place));
    }

    /// Replaces the matrix by its symmetric part.
    pub fn symmetrize(&mut self) {
        let mut transposed = self.clone();
        transposed.transpose();
        self.blocks.iter_mut().for_each(|entry| *entry *= 0.5);
        for ([row, column], blocks) in transposed.iter() {
            let sums = self.block_mut(row as u32, column as u32).iter_mut();
            sums.zip(blocks).for_each(|(sum, entry)| *sum += 0.5 * entry);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn couplings() -> Couplings {
        let mut couplings = Couplings::new(2);
        for (at, (row, column)) in [(0, 3), (3, 0), (2, 2), (1, 3), (4, 1)].into_iter().enumerate() {
            let block = couplings.block_mut(row, column).iter_mut().enumerate();
            block.for_each(|(entry, value)| *value = ((36 * at + entry) as f64).sin());
        }
        couplings
    }

    fn product(couplings: &Couplings, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        couplings.add_product(x, &mut y);
        y
    }

    fn dot(x: &[f64], y: &[f64]) -> f64 {
        x.iter().zip(y).map(|(x, y)| x * y).sum()
    }

    #[test]
    fn the_transposed_matrix_is_adjoint_and_the_symmetric_part_is_the_mean() {
        let [x, y] = [1.0, 1.7].map(|s| (0..30).map(|i| (s * i as f64).cos()).collect::<Vec<f64>>());
        let own = couplings();
        let (mut transposed, mut symmetric) = (own.clone(), own.clone());
        transposed.transpose();
        symmetric.symmetrize();
        assert!((dot(&product(&own, &x), &y) - dot(&x, &product(&transposed, &y))).abs() < 1e-13);
        let mean = 0.5 * (dot(&product(&own, &x), &y) + dot(&product(&transposed, &x), &y));
        assert!((dot(&product(&symmetric, &x), &y) - mean).abs() < 1e-13);
    }

    /// `T^T A T` with `u = T u` of a follower.
    #[test]
    fn a_folded_matrix_has_the_products_of_the_leaders() {
        let leaders = [(0u32, 0.25), (1, 0.75)];
        let follow = |x: &[f64]| {
            let mut x = x.to_vec();
            for stage in 0..2 {
                for d in 0..3 {
                    x[15 * stage + 9 + d] = 0.25 * x[15 * stage + d] + 0.75 * x[15 * stage + 3 + d];
                }
            }
            x
        };
        let own = couplings();
        let mut folded = own.clone();
        folded.fold(|node| (node == 3).then_some(&leaders[..]));
        let [x, y] = [1.0, 1.7].map(|s| (0..30).map(|i| (s * i as f64).cos()).collect::<Vec<f64>>());
        let expected = dot(&product(&own, &follow(&x)), &follow(&y));
        assert!((dot(&product(&folded, &x), &y) - expected).abs() < 1e-13);
    }
}
