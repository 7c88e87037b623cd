//! Multigrid by smoothed aggregation.

mod aggregates;
mod galerkin;
mod level;
mod prolongation;
mod smoother;

use std::sync::Arc;

use self::level::{CoarseMatrix, Level, Vectors};
use self::prolongation::{Block, COARSE, Nodes};
#[cfg(test)]
use super::StageMatrix;
use super::blocks::Blocks;
use super::conjugate_gradients::Approximate;
use super::kernel::Row;
use super::row_couplings::CouplingScale;
use super::shifted_solver::{MAX_ITERATIONS, Shifted, gather, scatter};
use super::{
    BlockCholesky, ConjugateGradients, Couplings, Pattern, SharedRows, ShiftedMatrix, ShiftedSolver,
    SweepOrder, nested_dissection,
};
use crate::error::Result;

/// Conjugate gradients, preconditioned by a V-cycle of multigrid with `M + |lambda| K`.
#[derive(Debug)]
pub(crate) struct Multigrid<const C: usize> {
    sweep: Arc<SweepOrder>,
    pattern: Pattern,
    matrix: ShiftedMatrix<f32, C>,
    /// `M + |lambda| K` for a complex lambda.
    real: Option<ShiftedMatrix<f32, 1>>,
    hierarchy: Hierarchy<C>,
    krylov: ConjugateGradients<f64, C>,
}

/// Hierarchy of smoothed aggregation (Vanek, Mandel and Brezina 1996). The near-null space is the six rigid modes at
/// the present positions: each level has a node of six components for an aggregate of nodes of the previous level. The
/// last level is factorised. A V-cycle smooths by a Gauss-Seidel sweep before and after the coarser levels.
#[derive(Debug)]
struct Hierarchy<const C: usize> {
    first: Level<3>,
    rest: Vec<Level<COARSE>>,
    /// Matrices of `rest`.
    matrices: Vec<CoarseMatrix>,
    /// Vectors of all levels.
    vectors: Vec<Vectors<C>>,
    last: BlockCholesky,
}

/// Largest number of nodes of a level that is factorised. With 400, plates take twice as many iterations.
const MOST_NODES: usize = 1200;

impl<const C: usize> Multigrid<C> {
    /// Memory for the matrices of a pattern.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`], [`crate::Error::Linear`].
    pub(crate) fn new(pattern: &Pattern, fixed: &[bool], sweep: Arc<SweepOrder>) -> Result<Self> {
        Ok(Multigrid {
            matrix: ShiftedMatrix::new(&sweep, fixed),
            real: (C == 2).then(|| ShiftedMatrix::new(&sweep, fixed)),
            hierarchy: Hierarchy::new(pattern, &sweep)?,
            krylov: ConjugateGradients::new(sweep.n_rows()),
            pattern: pattern.clone(),
            sweep,
        })
    }

    /// The same for rows that a team shares: each rank has a cycle for its own rows, those of guests being fixed.
    pub(crate) fn on(self, ranks: Option<SharedRows>) -> Self {
        Multigrid { krylov: self.krylov.on(ranks), ..self }
    }
}

impl<const C: usize> ShiftedSolver for Multigrid<C> {
    fn factorize(&mut self, system: &Shifted<'_>) -> Result<()> {
        let block = |position: usize| system.stiffness.block(position);
        self.matrix.set(&self.sweep, system.shift, system.mass, block);
        let modulus = system.shift[0].hypot(system.shift[1]);
        let finest = match &mut self.real {
            Some(real) => {
                real.set(&self.sweep, [modulus, 0.0], system.mass, block);
                (&real.blocks, &real.remainders)
            }
            None => (&self.matrix.blocks, &self.matrix.remainders),
        };
        self.hierarchy.set(&self.pattern, &self.sweep, system, finest)
    }

    fn solve(&mut self, x: &mut [f64], tolerance: f64) -> Option<usize> {
        gather(&self.sweep, x, 1.0, &mut self.krylov.rhs);
        let finest = self.real.as_ref().map_or(&self.matrix.blocks, |real| &real.blocks);
        let mut cycle = Cycle { finest, hierarchy: &mut self.hierarchy };
        let limits = (0, MAX_ITERATIONS);
        let outcome = self.krylov.solve(&self.sweep, &self.matrix, &mut cycle, tolerance, limits);
        scatter(&self.sweep, &self.krylov.solution, 1.0, x);
        (outcome.relative_residual <= tolerance).then_some(outcome.iterations)
    }

    /// With 4, a hierarchy replaced too early costs up to 1.7 times the time of a step; 10 to 30 make no difference.
    fn refactorization_cost(&self) -> f64 {
        16.0
    }

    fn takes_couplings(&self) -> bool {
        C == 1
    }

    fn couple(&mut self, couplings: &Couplings, scale: CouplingScale<'_>) {
        self.matrix.couple(&self.sweep, couplings, scale);
    }

    fn precondition(&mut self, x: &mut [f64]) {
        gather(&self.sweep, x, 1.0, &mut self.krylov.rhs);
        let finest = self.real.as_ref().map_or(&self.matrix.blocks, |real| &real.blocks);
        Cycle { finest, hierarchy: &mut self.hierarchy }.solve(&self.sweep, &mut self.krylov.rhs);
        scatter(&self.sweep, &self.krylov.rhs, 1.0, x);
    }
}

impl<const C: usize> Hierarchy<C> {
    fn new(pattern: &Pattern, sweep: &SweepOrder) -> Result<Self> {
        let mut first = Level::<3>::new(pattern);
        let mut rest: Vec<Level<COARSE>> = Vec::new();
        let mut matrices: Vec<CoarseMatrix> = Vec::new();
        let mut n = first.n_coarse();
        let mut last = first.galerkin.pattern.clone();
        while n > MOST_NODES {
            let level = Level::<COARSE>::new(&last);
            if 2 * level.n_coarse() > n {
                break;
            }
            n = level.n_coarse();
            matrices.push(CoarseMatrix::new(&last));
            last = level.galerkin.pattern.clone();
            rest.push(level);
        }
        let natural: Vec<u32> = (0..2 * n as u32).collect();
        let mut orders: Vec<&[u32]> = vec![&sweep.order];
        orders.extend(matrices.iter().map(|matrix| &matrix.sweep.order[..]));
        orders.push(&natural);
        first.connect(orders[0], orders[1]);
        for (level, orders) in rest.iter_mut().zip(orders[1..].windows(2)) {
            level.connect(orders[0], orders[1]);
        }
        Ok(Hierarchy {
            vectors: orders.iter().map(|order| Vectors::new(order.len())).collect(),
            last: BlockCholesky::new(&last, COARSE, &vec![false; COARSE * n], &nested_dissection(&last)?)?,
            first,
            rest,
            matrices,
        })
    }

    fn set(
        &mut self,
        pattern: &Pattern,
        sweep: &SweepOrder,
        system: &Shifted<'_>,
        (finest, remainders): (&Blocks<f32>, &Vec<[[f64; 4]; 3]>),
    ) -> Result<()> {
        let Hierarchy { first, rest, matrices, last, .. } = self;
        let fine = Finest::new(pattern, system);
        first.set(&fine);
        first.set_smoother(sweep, finest, |row| remainders[row], |node, a| fine.is_held(node, a));
        let mut coarse = first.coarse();
        for (level, matrix) in rest.iter_mut().zip(matrices) {
            matrix.set(coarse.blocks);
            level.set(&coarse);
            level.set_smoother(&matrix.sweep, &matrix.blocks, |_| [[0.0; 4]; 3], |_, _| false);
            coarse = level.coarse();
        }
        last.factorize(|source| coarse.blocks[source / 36].as_flattened()[source % 36])
    }

    /// `x = P^-1 r` of the first vectors: a V-cycle.
    fn cycle(&mut self, sweep: &SweepOrder, finest: &Blocks<f32>) {
        let Hierarchy { first, rest, matrices, vectors, last, .. } = self;
        let (own, coarser) = vectors.split_at_mut(1);
        let (own, next) = (&mut own[0], &mut coarser[0]);
        first.smoother.forward(sweep, finest, &own.r, (&mut own.x, &mut own.t));
        first.down.set_product(&own.t, &mut next.r);
        let levels = rest.iter().zip(matrices.iter()).enumerate();
        for (index, (level, matrix)) in levels.clone() {
            let (own, next) = pair(coarser, index);
            level.smoother.forward(&matrix.sweep, &matrix.blocks, &own.r, (&mut own.x, &mut own.t));
            level.down.set_product(&own.t, &mut next.r);
        }
        if let Some(vectors) = coarser.last_mut() {
            let read = |vectors: &Vectors<C>, c: usize, at: usize| vectors.r[at / 3][at % 3][c];
            let write = |vectors: &mut Vectors<C>, c: usize, at: usize, value: f64| {
                vectors.x[at / 3][at % 3][c] = value;
            };
            last.solve(C, vectors, read, write);
        }
        for (index, (level, matrix)) in levels.rev() {
            let (own, next) = pair(coarser, index);
            level.up.add_product(&next.x, &mut own.x);
            level.smoother.backward(&matrix.sweep, &matrix.blocks, &own.r, &mut own.x);
        }
        first.up.add_product(&coarser[0].x, &mut own.x);
        first.smoother.backward(sweep, finest, &own.r, &mut own.x);
    }
}

/// `M + |lambda| K` by nodes.
struct Finest<'a> {
    pattern: &'a Pattern,
    system: &'a Shifted<'a>,
    modulus: f64,
    /// Mean position, the centre of the rotations.
    middle: [f64; 3],
}

impl<'a> Finest<'a> {
    fn new(pattern: &'a Pattern, system: &'a Shifted<'a>) -> Self {
        let positions = &system.positions.as_chunks::<3>().0[..pattern.n_rows()];
        let share = 1.0 / positions.len() as f64;
        let middle = [0, 1, 2].map(|a| positions.iter().map(|x| x[a]).sum::<f64>() * share);
        Finest { pattern, system, modulus: system.shift[0].hypot(system.shift[1]), middle }
    }
}

impl Nodes<3> for Finest<'_> {
    fn pattern(&self) -> &Pattern {
        self.pattern
    }

    #[inline(always)]
    fn block(&self, position: usize) -> [[f64; 3]; 3] {
        let block = self.system.stiffness.block(position);
        let m = self.system.mass[position];
        [0, 1, 2].map(|a| [0, 1, 2].map(|b| self.modulus * block[3 * a + b] + if a == b { m } else { 0.0 }))
    }

    fn is_held(&self, node: usize, component: usize) -> bool {
        self.system.fixed[3 * node + component]
    }

    fn position(&self, node: usize) -> [f64; 3] {
        [0, 1, 2].map(|a| self.system.positions[3 * node + a] - self.middle[a])
    }

    fn modes(&self, node: usize) -> Block<f64, 3> {
        let [x, y, z] = self.position(node);
        [[1.0, 0.0, 0.0, 0.0, z, -y], [0.0, 1.0, 0.0, -z, 0.0, x], [0.0, 0.0, 1.0, y, -x, 0.0]]
    }
}

/// The vectors of a level and of the next one.
fn pair<const C: usize>(vectors: &mut [Vectors<C>], level: usize) -> (&mut Vectors<C>, &mut Vectors<C>) {
    let (own, next) = vectors.split_at_mut(level + 1);
    (&mut own[level], &mut next[0])
}

/// A cycle as an approximate inverse.
struct Cycle<'a, const C: usize> {
    finest: &'a Blocks<f32>,
    hierarchy: &'a mut Hierarchy<C>,
}

impl<const C: usize> Approximate<f64, C> for Cycle<'_, C> {
    fn solve(&mut self, sweep: &SweepOrder, x: &mut [Row<f64, C>]) {
        self.hierarchy.vectors[0].r.copy_from_slice(x);
        self.hierarchy.cycle(sweep, self.finest);
        x.copy_from_slice(&self.hierarchy.vectors[0].x);
    }
}

#[cfg(test)]
mod tests {
    use super::super::incomplete_cholesky::tests::elastic;
    use super::super::sweep::tests::grid;
    use super::*;

    #[test]
    fn sweeps_leave_the_residual_they_return_and_are_adjoint() {
        let pattern = grid([6, 5, 320]);
        let (mass, stiffness) = elastic(&pattern);
        let sweep = SweepOrder::new(&pattern);
        assert!(sweep.interiors.len() > 1);
        let fixed: Vec<bool> = (0..3 * pattern.n_rows()).map(|dof| dof % 50 == 7).collect();
        let mut matrix = ShiftedMatrix::<f32, 1>::new(&sweep, &fixed);
        let block = |position: usize| &stiffness[9 * position..9 * position + 9];
        matrix.set(&sweep, [1.0, 0.0], &mass, block);
        let mut level = Level::<3>::new(&pattern);
        let is_held = |node: usize, a: usize| fixed[3 * node + a];
        level.set_smoother(&sweep, &matrix.blocks, |row| matrix.remainders[row], is_held);
        let vector = |frequency: f64| -> Vec<Row<f64, 1>> {
            let value = |row: usize, a: usize| {
                let is_zero = a == 3 || is_held(sweep.order[row] as usize, a);
                if is_zero { 0.0 } else { (frequency * (3 * row + a) as f64).sin() }
            };
            (0..sweep.n_rows()).map(|row| [0, 1, 2, 3].map(|a| [value(row, a)])).collect()
        };
        let zero = vec![[[0.0]; 4]; sweep.n_rows()];
        let product = |x: &[Row<f64, 1>]| {
            let mut y = zero.clone();
            matrix.multiply(&sweep, x, &mut y, &mut vec![[0.0; 2]; sweep.n_rows().div_ceil(2048)]);
            y
        };
        let dot = |x: &[Row<f64, 1>], y: &[Row<f64, 1>]| {
            x.as_flattened().iter().zip(y.as_flattened()).map(|(x, y)| x[0] * y[0]).sum::<f64>()
        };
        let (r, s) = (vector(1.0), vector(0.7));
        let (mut x, mut t) = (zero.clone(), zero.clone());
        level.smoother.forward(&sweep, &matrix.blocks, &r, (&mut x, &mut t));
        for (row, (left, r)) in product(&x).iter().zip(&r).enumerate() {
            for a in (0..3).filter(|&a| !is_held(sweep.order[row] as usize, a)) {
                assert!((r[a][0] - left[a][0] - t[row][a][0]).abs() < 1e-12);
            }
        }
        // (D + L)^-1 r . s = r . (D + L^T)^-1 s
        let mut y = zero.clone();
        level.smoother.backward(&sweep, &matrix.blocks, &s, &mut y);
        assert!((dot(&x, &s) - dot(&r, &y)).abs() < 1e-10 * dot(&r, &y).abs());
    }

    #[test]
    fn a_cycle_is_symmetric_and_contracts() {
        let pattern = grid([14, 9, 11]);
        let (mass, stiffness) = elastic(&pattern);
        let sweep = Arc::new(SweepOrder::new(&pattern));
        let n = 3 * pattern.n_rows();
        let fixed: Vec<bool> = (0..n).map(|dof| dof < 300).collect();
        let mut matrix = StageMatrix::new(&pattern, &pattern.divided(1), 1);
        matrix.parts_mut()[0].blocks_mut().0.as_flattened_mut().copy_from_slice(&stiffness);
        let positions: Vec<f64> =
            (0..pattern.n_rows()).flat_map(|i| [i % 14, i / 14 % 9, i / 126].map(|x| x as f64)).collect();
        let mut solver = Multigrid::<1>::new(&pattern, &fixed, sweep).unwrap();
        let shift = [1e4, 0.0];
        let system = Shifted {
            stiffness: &matrix,
            mass: &mass,
            fixed: &fixed,
            positions: &positions,
            shift,
            elastic: None,
            in_single_precision: false,
        };
        solver.factorize(&system).unwrap();
        let vector = |frequency: f64| -> Vec<f64> {
            (0..n).map(|dof| if fixed[dof] { 0.0 } else { (frequency * dof as f64).sin() }).collect()
        };
        let (r, s) = (vector(1.0), vector(0.7));
        let (mut x, mut y) = (r.clone(), s.clone());
        solver.precondition(&mut x);
        solver.precondition(&mut y);
        let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
        assert!((dot(&x, &s) - dot(&r, &y)).abs() < 1e-10 * dot(&x, &s).abs());
        assert!(solver.solve(&mut x, 1e-8).is_some_and(|iterations| iterations < 25));
    }

    #[test]
    fn the_number_of_threads_does_not_change_a_bit() {
        let pattern = grid([7, 6, 300]);
        let (mass, stiffness) = elastic(&pattern);
        let sweep = Arc::new(SweepOrder::new(&pattern));
        assert!(sweep.interiors.len() > 1);
        let n = 3 * pattern.n_rows();
        let mut matrix = StageMatrix::new(&pattern, &pattern.divided(1), 1);
        matrix.parts_mut()[0].blocks_mut().0.as_flattened_mut().copy_from_slice(&stiffness);
        let positions: Vec<f64> =
            (0..pattern.n_rows()).flat_map(|i| [i % 7, i / 7 % 6, i / 42].map(|x| x as f64)).collect();
        let fixed = vec![false; n];
        let on = |n_threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
            pool.install(|| {
                let mut solver = Multigrid::<2>::new(&pattern, &fixed, sweep.clone()).unwrap();
                let (shift, mass) = ([0.3, 0.5], &mass[..]);
                let system = Shifted {
                    stiffness: &matrix,
                    mass,
                    fixed: &fixed,
                    positions: &positions,
                    shift,
                    elastic: None,
                    in_single_precision: false,
                };
                solver.factorize(&system).unwrap();
                let mut x: Vec<f64> = (0..2 * n).map(|at| (at as f64).sin()).collect();
                (solver.solve(&mut x, 1e-6), x)
            })
        };
        let one = on(1);
        assert!(one.0.is_some(), "not converged");
        assert!(on(3) == one, "threads");
    }
}
