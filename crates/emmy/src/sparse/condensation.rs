//! Static condensation: the inner rows of a pattern eliminated from systems with `M + lambda K`.

use std::ops::Range;

use std::sync::Arc;

use super::{Pattern, StageMatrix, eliminate};
use crate::error::{Error, Result};
use crate::team::Subdomain;

/// Condensation of a symmetric K onto the outer rows of a pattern. Inner rows have no mass, so that the condensed
/// system is of the same form, with one matrix for every lambda:
///
/// ```math
/// M + lambda K~,      K~ = K_oo - C^T K_io,      C = K_ii^-1 K_io
/// ```
///
/// with the right-hand side `b_o - C^T b_i`. The inner unknowns are `x_i = K_ii^-1 b_i / lambda - C x_o`.
#[derive(Debug)]
pub(crate) struct Condensation {
    /// The pattern of the outer rows.
    pub pattern: Pattern,
    /// K~.
    pub stiffness: StageMatrix,
    /// M of the outer rows, at the positions of their pattern.
    pub mass: Vec<f64>,
    groups: Vec<Group>,
    /// The part of a team, whose guests are the last outer rows.
    subdomain: Option<Arc<Subdomain>>,
    /// C and `K_ii^-1` of each group, by rows `[i][3 n_outer + 3 n_inner]`.
    numbers: Vec<f64>,
    /// `K_ii` and `K_io` of a group, or a vector.
    work: [Vec<f64>; 2],
    /// Inner unknowns of a group, `[2][m]`.
    found: Vec<f64>,
}

/// Inner rows that are coupled with each other and the same outer rows.
#[derive(Debug)]
struct Group {
    inner: Range<usize>,
    outer: Vec<u32>,
    /// Position of every pair of the outer rows in their pattern.
    positions: Vec<u32>,
    /// Start of its numbers.
    first: usize,
}

impl Group {
    /// Number of scalar inner and outer rows.
    fn size(&self) -> (usize, usize) {
        (3 * self.inner.len(), 3 * self.outer.len())
    }
}

impl Condensation {
    /// Memory for the condensation of a pattern; `mass`: of each block.
    pub(crate) fn new(pattern: &Pattern, mass: &[f64]) -> Self {
        let outer = pattern.outer();
        let blocks = (0..outer.n_rows()).flat_map(|row| pattern.range(row).take(outer.range(row).len()));
        let mass = blocks.map(|block| mass[block]).collect();
        let (mut groups, mut n_numbers, mut largest): (Vec<Group>, _, _) = (Vec::new(), 0, [0; 3]);
        let mut row = pattern.n_outer();
        while row < pattern.n_rows() {
            let columns = pattern.row(row);
            let (of_outer, of_inner) = columns.split_at(pattern.n_outer_columns(row));
            let pairs =
                of_outer.iter().flat_map(|&a| of_outer.iter().map(move |&b| (a as usize, b as usize)));
            let group = Group {
                inner: row..row + of_inner.len(),
                outer: of_outer.to_vec(),
                positions: pairs.filter_map(|(a, b)| outer.position(a, b)).map(|at| at as u32).collect(),
                first: n_numbers,
            };
            let (m, n) = group.size();
            n_numbers += m * (n + m);
            largest = [largest[0].max(m * m), largest[1].max(m * n).max(n + m), largest[2].max(m)];
            row = group.inner.end;
            groups.push(group);
        }
        Condensation {
            stiffness: StageMatrix::new(&outer, &outer.divided(1), 1),
            pattern: outer,
            mass,
            groups,
            subdomain: None,
            numbers: vec![0.0; n_numbers],
            work: [0, 1].map(|which| vec![0.0; largest[which]]),
            found: vec![0.0; 2 * largest[2]],
        }
    }

    /// The same memory for the part of a team. It has the inner rows of all its groups, which depend on the rows of
    /// guests.
    pub(crate) fn on(self, subdomain: Option<Arc<Subdomain>>) -> Self {
        Condensation { subdomain, ..self }
    }

    /// Condenses a stiffness of one stage on the complete pattern; `fixed`: omitted components, `[n_rows][3]`.
    ///
    /// # Errors
    /// [`Error::Linear`] if the stiffness of inner rows is singular.
    pub(crate) fn condense(&mut self, full: &Pattern, stiffness: &StageMatrix, fixed: &[bool]) -> Result<()> {
        let Condensation { pattern, stiffness: condensed, groups, numbers, work, .. } = self;
        let blocks = condensed.parts_mut()[0].blocks_mut().0;
        for row in 0..pattern.n_rows() {
            for (to, from) in pattern.range(row).zip(full.range(row)) {
                blocks[to].copy_from_slice(&stiffness.block(from)[..9]);
            }
        }
        for group in groups {
            let (m, n) = group.size();
            let [inner, coupling] = work;
            let (inner, coupling) = (&mut inner[..m * m], &mut coupling[..m * n]);
            group.gather(full, stiffness, fixed, (inner, coupling));
            let own = &mut numbers[group.first..group.first + m * (n + m)];
            for (i, (own, coupling)) in own.chunks_exact_mut(n + m).zip(coupling.chunks_exact(n)).enumerate()
            {
                own[..n].copy_from_slice(coupling);
                own[n..].fill(0.0);
                own[n + i] = 1.0;
            }
            if !eliminate(inner, own, n + m) {
                return Err(Error::Linear {
                    reason: "the stiffness of incompatible modes is singular".into(),
                });
            }
            let outer = group.outer.len();
            for (pair, &position) in group.positions.iter().enumerate() {
                let (a, b) = (3 * (pair / outer), 3 * (pair % outer));
                for (coupling, own) in coupling.chunks_exact(n).zip(own.chunks_exact(n + m)) {
                    for entry in 0..9 {
                        blocks[position as usize][entry] -= coupling[a + entry / 3] * own[b + entry % 3];
                    }
                }
            }
        }
        Ok(())
    }

    /// Reduces right-hand sides, zero at fixed components, in place to the outer rows, which come first; `columns:
    /// [n_rows][3][n_columns]`. They are zero at guests.
    pub(crate) fn reduce<'c>(&mut self, columns: &'c mut [f64], n_columns: usize) -> &'c mut [f64] {
        let n_outer = self.pattern.n_rows();
        let (outer, inner) = columns.split_at_mut(3 * n_columns * n_outer);
        for group in &self.groups {
            let (m, n) = group.size();
            let own = &self.numbers[group.first..group.first + m * (n + m)];
            let right = &inner[3 * n_columns * (group.inner.start - n_outer)..];
            for c in 0..n_columns {
                let sum = &mut self.work[1][..n];
                sum.fill(0.0);
                for (own, right) in own.chunks_exact(n + m).zip(right.chunks_exact(n_columns)) {
                    sum.iter_mut().zip(&own[..n]).for_each(|(sum, C)| *sum += C * right[c]);
                }
                for (&row, sum) in group.outer.iter().zip(sum.as_chunks::<3>().0) {
                    let outer = &mut outer[3 * row as usize * n_columns..][..3 * n_columns];
                    (0..3).for_each(|a| outer[a * n_columns + c] -= sum[a]);
                }
            }
        }
        if let Some(subdomain) = &self.subdomain {
            outer[3 * n_columns * subdomain.n_own()..].fill(0.0);
        }
        outer
    }

    /// Takes the outer unknowns of guests from their owners.
    fn update_guests(&self, outer: &mut [f64], n_columns: usize) {
        let Some(subdomain) = &self.subdomain else { return };
        let n = 3 * n_columns;
        let read = |outer: &[f64], node: usize, numbers: &mut [f64]| {
            numbers.copy_from_slice(&outer[n * node..n * (node + 1)]);
        };
        let write = |outer: &mut [f64], node: usize, numbers: &[f64]| {
            outer[n * node..n * (node + 1)].copy_from_slice(numbers);
        };
        subdomain.exchange("unknowns beside condensed ones", n, outer, read, write);
    }

    /// Sets the inner unknowns from their right-hand sides and the outer unknowns; `inverse_shift`: 1/lambda.
    pub(crate) fn expand(&mut self, inverse_shift: [f64; 2], columns: &mut [f64], n_columns: usize) {
        let n_outer = self.pattern.n_rows();
        let (outer, inner) = columns.split_at_mut(3 * n_columns * n_outer);
        self.update_guests(outer, n_columns);
        let [re, im] = inverse_shift;
        for group in &self.groups {
            let (m, n) = group.size();
            let own = &self.numbers[group.first..group.first + m * (n + m)];
            let x = &mut inner[3 * n_columns * (group.inner.start - n_outer)..][..m * n_columns];
            for c in 0..n_columns {
                // C and K_ii^-1 stand side by side: one product of a row with -x_o and b_i.
                let all = &mut self.work[1][..n + m];
                for (all, &row) in all.as_chunks_mut::<3>().0.iter_mut().zip(&group.outer) {
                    let outer = &outer[3 * row as usize * n_columns..][..3 * n_columns];
                    *all = [0, 1, 2].map(|a| -outer[a * n_columns + c]);
                }
                // (b_1 + i b_2)/lambda
                for (b, x) in all[n..].iter_mut().zip(x.chunks_exact(n_columns)) {
                    let (own, other) = (x[c], x[n_columns - 1 - c]);
                    *b = re * own
                        + match (n_columns, c) {
                            (1, _) => 0.0,
                            (_, 0) => -im * other,
                            _ => im * other,
                        };
                }
                let found = &mut self.found[c * m..(c + 1) * m];
                for (found, own) in found.iter_mut().zip(own.chunks_exact(n + m)) {
                    *found = own.iter().zip(&*all).map(|(k, x)| k * x).sum();
                }
            }
            for (at, x) in x.iter_mut().enumerate() {
                *x = self.found[at % n_columns * m + at / n_columns];
            }
        }
    }
}

impl Group {
    /// Copies `K_ii` and `K_io`; fixed rows and columns are those of the unit matrix.
    fn gather(
        &self,
        full: &Pattern,
        stiffness: &StageMatrix,
        fixed: &[bool],
        (inner, coupling): (&mut [f64], &mut [f64]),
    ) {
        let (m, n) = self.size();
        for (i, row) in self.inner.clone().enumerate() {
            for (at, (position, &column)) in full.range(row).zip(full.row(row)).enumerate() {
                let block = stiffness.block(position);
                for (entry, &value) in block.iter().enumerate().take(9) {
                    let (a, b) = (entry / 3, entry % 3);
                    let (dof, other) = (3 * row + a, 3 * column as usize + b);
                    let unit = if dof == other { 1.0 } else { 0.0 };
                    let value = if fixed[dof] || fixed[other] { unit } else { value };
                    match (3 * at + b).checked_sub(n) {
                        Some(b) => inner[(3 * i + a) * m + b] = value,
                        None => coupling[(3 * i + a) * n + 3 * at + b] = value,
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two cells with two outer rows and one inner row each, one component fixed.
    #[test]
    fn a_condensed_system_has_the_solution_of_the_complete_one() {
        let lists: [&[u32]; 2] = [&[0, 1, 3], &[1, 2, 4]];
        let pattern = Pattern::new(5, lists.into_iter()).with_inner_rows_from(3);
        let mut stiffness = StageMatrix::new(&pattern, &pattern.divided(1), 1);
        let entry = |a: usize, b: usize| {
            let (low, high) = (a.min(b) as f64, a.max(b) as f64);
            if a == b { 6.0 + 0.1 * low } else { 0.3 * (low + 2.0 * high).sin() }
        };
        for row in 0..5 {
            for (position, &column) in pattern.range(row).zip(pattern.row(row)) {
                let block = stiffness.parts_mut()[0].block_mut(position, 0);
                (0..9).for_each(|at| block[at] = entry(3 * row + at / 3, 3 * column as usize + at % 3));
            }
        }
        let fixed: Vec<bool> = (0..15).map(|dof| dof == 4 || dof == 11).collect();
        let mut mass = vec![0.0; pattern.n_blocks()];
        (0..3).for_each(|row| mass[pattern.position(row, row).unwrap()] = 2.0 + row as f64);
        let mut condensation = Condensation::new(&pattern, &mass);
        condensation.condense(&pattern, &stiffness, &fixed).unwrap();
        let lambda = 0.7;
        let dense = |pattern: &Pattern, stiffness: &StageMatrix, mass: &[f64], n: usize| {
            let mut matrix = vec![0.0; n * n];
            for row in 0..n / 3 {
                for (position, &column) in pattern.range(row).zip(pattern.row(row)) {
                    for at in 0..9 {
                        let (a, b) = (3 * row + at / 3, 3 * column as usize + at % 3);
                        let own = lambda * stiffness.block(position)[at];
                        let own = own + if at % 4 == 0 { mass[position] } else { 0.0 };
                        let unit = if a == b { 1.0 } else { 0.0 };
                        matrix[a * n + b] = if fixed[a] || fixed[b] { unit } else { own };
                    }
                }
            }
            matrix
        };
        let free = |dof: usize| if fixed[dof] { 0.0 } else { 1.0 };
        let right: Vec<f64> = (0..15).map(|dof| free(dof) * (1.0 + dof as f64).cos()).collect();
        let mut complete = right.clone();
        assert!(eliminate(&mut dense(&pattern, &stiffness, &mass, 15), &mut complete, 1));
        let mut found = right;
        let outer = condensation.reduce(&mut found, 1);
        let mut matrix = dense(&condensation.pattern, &condensation.stiffness, &condensation.mass, 9);
        assert!(eliminate(&mut matrix, outer, 1));
        condensation.expand([1.0 / lambda, 0.0], &mut found, 1);
        for (found, complete) in found.iter().zip(&complete) {
            assert!((found - complete).abs() < 1e-14, "{found} {complete}");
        }
    }
}
