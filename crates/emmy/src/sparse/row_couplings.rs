//! Couplings beyond a pattern, on the rows of a sweep.

use super::Couplings;
use super::blocks::times;
use super::kernel::Row;
use super::real::Real;
use super::sweep::SweepOrder;
use crate::tensor::Mat3;
use crate::tensor::rotation::{IDENTITY, product, transposed};

/// A factor, and the rotation of each node.
pub(super) type CouplingScale<'r> = (f64, &'r dyn Fn(usize) -> Mat3<f64>);

/// A symmetric matrix of couplings beyond a pattern, by rows in the order of a sweep.
#[derive(Debug, Clone, Default)]
pub(super) struct RowCouplings<T> {
    /// Row and column of each block, ascending.
    places: Vec<[u32; 2]>,
    /// Blocks by columns.
    blocks: Vec<[[T; 4]; 3]>,
    /// Memory for couplings before they are sorted, with their numbers, and for their blocks.
    unsorted: Vec<([u32; 2], u32)>,
    turned: Vec<Mat3<f64>>,
    /// Row of each node; empty before the first couplings.
    row_of: Vec<u32>,
}

impl<T: Real> RowCouplings<T> {
    /// Sets the matrix to `factor R^T A R` with the symmetric part A of couplings of one stage. Nodes beyond the sweep
    /// have no rows.
    pub(super) fn set(&mut self, sweep: &SweepOrder, couplings: &Couplings, (factor, R): CouplingScale<'_>) {
        let RowCouplings { places, blocks, unsorted, turned, row_of } = self;
        places.clear();
        blocks.clear();
        if couplings.is_empty() {
            return;
        }
        if row_of.is_empty() {
            row_of.resize(sweep.n_rows(), 0);
            (0..).zip(&sweep.order).for_each(|(row, node)| row_of[*node as usize] = row);
        }
        unsorted.clear();
        turned.clear();
        for (nodes, block) in couplings.iter() {
            if let [Some(&row), Some(&column)] = nodes.map(|node| row_of.get(node)) {
                // A block is even, its transpose odd.
                let number = 2 * turned.len() as u32;
                unsorted.extend([([row, column], number), ([column, row], number + 1)]);
                let block = [0, 1, 2].map(|a| [block[3 * a], block[3 * a + 1], block[3 * a + 2]]);
                let rotations = nodes.map(R);
                turned.push(match rotations == [IDENTITY; 2] {
                    true => block,
                    false => product(&transposed(&rotations[0]), &product(&block, &rotations[1])),
                });
            }
        }
        unsorted.sort_unstable();
        for &(place, number) in &*unsorted {
            if places.last() != Some(&place) {
                places.push(place);
                blocks.push([[T::default(); 4]; 3]);
            }
            let Some(sum) = blocks.last_mut() else { continue };
            let (turned, is_transpose) = (&turned[number as usize / 2], number % 2 == 1);
            for a in 0..3 {
                for b in 0..3 {
                    let entry = if is_transpose { turned[b][a] } else { turned[a][b] };
                    sum[b][a] += T::of(0.5 * factor * entry);
                }
            }
        }
    }

    /// Adds the product with a vector to consecutive rows from `first` on.
    pub(super) fn add_product<const C: usize>(&self, x: &[Row<T, C>], first: usize, y: &mut [Row<T, C>]) {
        let begin = self.places.partition_point(|place| (place[0] as usize) < first);
        for ([row, column], block) in self.places[begin..].iter().zip(&self.blocks[begin..]) {
            let Some(y) = y.get_mut(*row as usize - first) else { return };
            let product = times(block, &x[*column as usize]);
            (0..4).for_each(|a| (0..C).for_each(|c| y[a][c] += product[a][c]));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Pattern;
    use super::*;

    #[test]
    fn products_are_those_of_the_symmetric_part() {
        let n = 5;
        let pattern = Pattern::new(n, [&[0u32, 1, 2][..], &[2, 3, 4]].into_iter());
        let sweep = SweepOrder::new(&pattern);
        let mut couplings = Couplings::new(1);
        for (at, nodes) in [(0, 3), (3, 0), (2, 2), (1, 4), (0, 9)].into_iter().enumerate() {
            let block = couplings.block_mut(nodes.0, nodes.1).iter_mut().enumerate();
            block.for_each(|(entry, value)| *value = ((9 * at + entry) as f64).sin());
        }
        let mut rows = RowCouplings::<f64>::default();
        // Quarter turns of some nodes about z.
        let turned_nodes = [0, 3];
        let turn = |node: usize| match turned_nodes.contains(&node) {
            true => [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
            false => IDENTITY,
        };
        rows.set(&sweep, &couplings, (2.0, &turn));
        let x: Vec<f64> = (0..3 * 10).map(|i| if i < 3 * n { (i as f64).cos() } else { 0.0 }).collect();
        let (mut expected, mut turned) = (vec![0.0; x.len()], x.clone());
        turned_nodes.iter().for_each(|node| {
            let x = &mut turned.as_chunks_mut::<3>().0[*node];
            *x = [-x[1], x[0], x[2]];
        });
        couplings.add_product(&turned, &mut expected);
        couplings.transpose();
        couplings.add_product(&turned, &mut expected);
        turned_nodes.iter().for_each(|node| {
            let y = &mut expected.as_chunks_mut::<3>().0[*node];
            *y = [y[1], -y[0], y[2]];
        });
        let of_rows: Vec<Row<f64, 1>> = (sweep.order.iter())
            .map(|&node| [0, 1, 2, 3].map(|a| [if a < 3 { x[3 * node as usize + a] } else { 0.0 }]))
            .collect();
        let mut y = vec![[[0.0]; 4]; n];
        let (first, last) = y.split_at_mut(2);
        rows.add_product(&of_rows, 0, first);
        rows.add_product(&of_rows, 2, last);
        for (y, &node) in y.iter().zip(&sweep.order) {
            (0..3).for_each(|a| assert!((y[a][0] - expected[3 * node as usize + a]).abs() < 1e-14));
        }
    }
}
