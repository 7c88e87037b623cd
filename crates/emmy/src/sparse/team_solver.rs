//! Solvers of `(M + lambda K) y = b` whose rows a team shares, by an engine of the team.

use std::sync::Arc;

use super::kernel::Row;
use super::shifted_solver::{MAX_ITERATIONS, gather, scatter};
use super::{
    Approximate, ConjugateGradients, Pattern, SharedRows, Shifted, ShiftedMatrix, ShiftedSolver, SweepOrder,
};
use crate::error::{Error, Result};
use crate::team::{Engine, OwnRows};

/// Conjugate gradients, preconditioned by an engine with `M + |lambda| K`.
#[derive(Debug)]
pub(crate) struct TeamSolver<const C: usize> {
    sweep: Arc<SweepOrder>,
    matrix: ShiftedMatrix<f64, C>,
    rows: Rows,
    inverse: Inverse,
    krylov: ConjugateGradients<f64, C>,
    /// tan(phi/4), for the argument phi of lambda.
    contraction: f64,
    /// Whether K has projected volumes.
    is_mixed: bool,
    refactorization_cost: f64,
}

/// The own rows of the matrix, in the numbers of all ranks.
#[derive(Debug)]
struct Rows {
    first: usize,
    n_of_ranks: usize,
    begin: Vec<usize>,
    columns: Vec<usize>,
    /// Nodes of the columns.
    nodes: Vec<u32>,
    /// Fixed components of own nodes and guests, `[n_nodes][3]`.
    held: Vec<bool>,
    blocks: Vec<f64>,
}

/// An engine as an approximate inverse in the order of the sweep.
#[derive(Debug)]
struct Inverse {
    engine: Box<dyn Engine>,
    /// A column of own rows.
    column: Vec<f64>,
}

impl<const C: usize> TeamSolver<C> {
    /// Memory for the own rows of a pattern, those of guests being fixed; `cost`: of a new stiffness, in solutions;
    /// `is_mixed`: whether K has projected volumes. A call of all ranks.
    pub(crate) fn new(
        pattern: &Pattern,
        fixed: &[bool],
        (sweep, ranks): (Arc<SweepOrder>, SharedRows),
        engine: Box<dyn Engine>,
        (cost, is_mixed): (f64, bool),
    ) -> Self {
        let n_own = ranks.subdomain().n_own();
        TeamSolver {
            matrix: ShiftedMatrix::new(&sweep, fixed),
            rows: Rows::new(pattern, fixed, &ranks),
            inverse: Inverse { engine, column: vec![0.0; 3 * n_own] },
            krylov: ConjugateGradients::new(sweep.n_rows()).on(Some(ranks)),
            contraction: 0.0,
            is_mixed,
            refactorization_cost: cost,
            sweep,
        }
    }
}

impl<const C: usize> ShiftedSolver for TeamSolver<C> {
    fn factorize(&mut self, system: &Shifted<'_>) -> Result<()> {
        let Shifted { stiffness, mass, shift, positions, .. } = *system;
        self.matrix.set(&self.sweep, shift, mass, |position| stiffness.block(position));
        self.contraction = (0.25 * shift[1].atan2(shift[0])).tan();
        self.rows.set(system, shift[0].hypot(shift[1]));
        let Rows { first, n_of_ranks, begin, columns, blocks, .. } = &self.rows;
        let positions = &positions[..self.inverse.column.len()];
        let rows = OwnRows { first: *first, n_of_ranks: *n_of_ranks, begin, columns, blocks, positions };
        let engine = &mut self.inverse.engine;
        let outcome = engine.set(&rows);
        outcome.map_err(|text| Error::Linear { reason: format!("{}: {text}", engine.name()) })
    }

    fn solve(&mut self, x: &mut [f64], tolerance: f64) -> Option<usize> {
        gather(&self.sweep, x, 1.0, &mut self.krylov.rhs);
        // As with the factorisation of one process.
        let least = if self.is_mixed { (tolerance.ln() / self.contraction.ln()).ceil() as usize } else { 0 };
        let limits = (least, MAX_ITERATIONS);
        let outcome = self.krylov.solve(&self.sweep, &self.matrix, &mut self.inverse, tolerance, limits);
        scatter(&self.sweep, &self.krylov.solution, 1.0, x);
        (outcome.relative_residual <= tolerance).then_some(outcome.iterations)
    }

    fn refactorization_cost(&self) -> f64 {
        self.refactorization_cost
    }

    fn precondition(&mut self, x: &mut [f64]) {
        gather(&self.sweep, x, 1.0, &mut self.krylov.rhs);
        self.inverse.solve(&self.sweep, &mut self.krylov.rhs);
        scatter(&self.sweep, &self.krylov.rhs, 1.0, x);
    }
}

impl Rows {
    fn new(pattern: &Pattern, fixed: &[bool], ranks: &SharedRows) -> Self {
        let part = ranks.subdomain();
        let counts = part.gather("own rows", &[part.n_own() as f64]);
        let first = counts[..part.rank()].iter().sum::<f64>() as usize;
        let mut numbers: Vec<f64> = (0..pattern.n_rows()).map(|node| (first + node) as f64).collect();
        part.exchange(
            "numbers of rows",
            1,
            &mut numbers,
            |own, i, to| to[0] = own[i],
            |own, i, from| own[i] = from[0],
        );
        let mut held: Vec<bool> = fixed.to_vec();
        let read = |held: &Vec<bool>, node: usize, numbers: &mut [f64]| {
            numbers.iter_mut().zip(&held[3 * node..]).for_each(|(to, held)| *to = f64::from(u8::from(*held)));
        };
        let write = |held: &mut Vec<bool>, node: usize, numbers: &[f64]| {
            held[3 * node..].iter_mut().zip(numbers).for_each(|(held, from)| *held = *from > 0.0);
        };
        part.exchange("fixed components", 3, &mut held, read, write);
        let nodes: Vec<u32> = (0..part.n_own()).flat_map(|row| pattern.row(row)).copied().collect();
        let ends = (0..part.n_own()).map(|row| pattern.range(row).end);
        Rows {
            first,
            n_of_ranks: counts.iter().sum::<f64>() as usize,
            begin: [0].into_iter().chain(ends).collect(),
            columns: nodes.iter().map(|&node| numbers[node as usize] as usize).collect(),
            blocks: vec![0.0; 9 * nodes.len()],
            held,
            nodes,
        }
    }

    /// Sets the blocks of `M + modulus K`.
    fn set(&mut self, system: &Shifted<'_>, modulus: f64) {
        for (row, range) in self.begin.windows(2).enumerate() {
            for position in range[0]..range[1] {
                let column = self.nodes[position] as usize;
                let (stiffness, m) = (system.stiffness.block(position), system.mass[position]);
                for (at, entry) in self.blocks[9 * position..9 * position + 9].iter_mut().enumerate() {
                    let (dof, other) = (3 * row + at / 3, 3 * column + at % 3);
                    *entry = match self.held[dof] || self.held[other] {
                        true => f64::from(u8::from(dof == other)),
                        false => modulus * stiffness[at] + if at % 4 == 0 { m } else { 0.0 },
                    };
                }
            }
        }
    }
}

impl<const C: usize> Approximate<f64, C> for Inverse {
    fn solve(&mut self, sweep: &SweepOrder, x: &mut [Row<f64, C>]) {
        let n_own = self.column.len() / 3;
        for c in 0..C {
            let own_rows = || sweep.order.iter().map(|&node| node as usize).enumerate();
            for (row, node) in own_rows().filter(|(_, node)| *node < n_own) {
                (0..3).for_each(|a| self.column[3 * node + a] = x[row][a][c]);
            }
            self.engine.apply(&mut self.column);
            for (row, node) in own_rows() {
                let solution = self.column.get(3 * node..3 * node + 3).unwrap_or(&[0.0; 3]);
                (0..3).for_each(|a| x[row][a][c] = solution[a]);
            }
        }
    }
}
