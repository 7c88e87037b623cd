//! Consistent mass: product and inverse.

use rayon::prelude::*;

use super::system::Body;
use crate::error::{Error, Result};
use crate::nodal;
use crate::sparse::BlockCholesky;

/// Velocity from momentum: `M_ff v_f = p_f - M_fc v_c` for the free degrees of freedom with mass, with v_c given for
/// the fixed ones. Nodes without mass get the velocity 0.
#[derive(Debug)]
pub(crate) struct MassSolver {
    /// Factorisations with the directions that share them (directions with the same fixed nodes).
    factors: Vec<(Vec<usize>, BlockCholesky)>,
    /// Conjugate gradients instead of factors, on a team.
    iteration: Option<MassIteration>,
    /// p - M v_c.
    rest: Vec<f64>,
}

impl MassSolver {
    /// Factorises the mass matrix of a body.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`].
    pub(crate) fn new(body: &Body) -> Result<Self> {
        if body.space.is_shared() {
            let iteration = Some(MassIteration::new(body));
            return Ok(MassSolver { factors: Vec::new(), iteration, rest: vec![0.0; body.n_dofs()] });
        }
        // Nodes without mass have no velocity that follows from a momentum.
        let is_given = |dof: usize| body.fixed()[dof] || body.space.internal_dofs().contains(&dof);
        let fixed = |axis: usize| -> Vec<bool> { (axis..body.n_dofs()).step_by(3).map(is_given).collect() };
        let mut factors: Vec<(Vec<usize>, BlockCholesky)> = Vec::new();
        for axis in 0..3 {
            if let Some((axes, _)) = factors.iter_mut().find(|(axes, _)| fixed(axes[0]) == fixed(axis)) {
                axes.push(axis);
                continue;
            }
            let mut factor = BlockCholesky::new(body.pattern(), 1, &fixed(axis), body.node_order()?)?;
            let mass = body.carried_mass_along(axis);
            factor.factorize(|position| mass[position])?;
            factors.push((vec![axis], factor));
        }
        Ok(MassSolver { factors, iteration: None, rest: vec![0.0; body.n_dofs()] })
    }

    /// Velocity of a momentum with the fixed degrees of freedom at rest; `momentum`, `velocity`: `[n_nodes][3]`.
    ///
    /// # Errors
    /// [`crate::Error::Linear`] on a team.
    pub(crate) fn velocity(&mut self, body: &Body, momentum: &[f64], velocity: &mut [f64]) -> Result<()> {
        velocity.fill(0.0);
        self.solve(body, momentum, velocity)
    }

    /// Sets the velocity of the free degrees of freedom from a momentum; the velocity of the fixed ones must be set.
    ///
    /// # Errors
    /// As [`MassSolver::velocity`].
    pub(crate) fn velocity_beside(
        &mut self,
        body: &Body,
        momentum: &[f64],
        velocity: &mut [f64],
    ) -> Result<()> {
        velocity.iter_mut().zip(body.fixed()).filter(|(_, fixed)| !**fixed).for_each(|(v, _)| *v = 0.0);
        let mut rest = std::mem::take(&mut self.rest);
        body.mass_product(velocity, &mut rest);
        rest.iter_mut().zip(momentum).for_each(|(rest, p)| *rest = p - *rest);
        let solved = self.solve(body, &rest, velocity);
        self.rest = rest;
        solved
    }

    /// Sets the free entries of the velocity, `M_ff v_f = p_f`, and those of tied nodes.
    fn solve(&mut self, body: &Body, momentum: &[f64], velocity: &mut [f64]) -> Result<()> {
        if let Some(iteration) = &mut self.iteration {
            return iteration.solve(body, momentum, velocity);
        }
        for (axes, factor) in &mut self.factors {
            let read = |_: &&mut [f64], column: usize, node: usize| nodal::at(momentum, node)[axes[column]];
            let write = |velocity: &mut &mut [f64], column: usize, node: usize, value: f64| {
                nodal::at_mut(velocity, node)[axes[column]] = value;
            };
            factor.solve(axes.len(), &mut &mut *velocity, read, write);
        }
        body.space.follow(velocity);
        Ok(())
    }
}

/// Conjugate gradients with the diagonal of the mass matrix: then its condition depends on the kinds of cells alone, 27
/// for hexahedra (Wathen 1987), not on densities or sizes.
#[derive(Debug)]
struct MassIteration {
    /// One over the diagonal at the free degrees of freedom, zero elsewhere.
    inverse_diagonal: Vec<f64>,
    residual: Vec<f64>,
    direction: Vec<f64>,
    product: Vec<f64>,
    solution: Vec<f64>,
}

/// Part of the right-hand side that is left in the norm of the inverse diagonal, and the largest number of iterations.
const ROUNDING: f64 = 1e-16;
const MAX_ITERATIONS: usize = 1000;

impl MassIteration {
    fn new(body: &Body) -> Self {
        let n = body.n_dofs();
        let diagonal = |node: usize| body.pattern().position(node, node).map_or(0.0, |at| body.mass()[at]);
        let is_given = |dof: usize| body.space.inactive()[dof] || body.space.internal_dofs().contains(&dof);
        let inverse = |dof: usize| if is_given(dof) { 0.0 } else { 1.0 / diagonal(dof / 3) };
        MassIteration {
            inverse_diagonal: (0..n).map(inverse).collect(),
            residual: vec![0.0; n],
            direction: vec![0.0; n],
            product: vec![0.0; n],
            solution: vec![0.0; n],
        }
    }

    /// Adds the solution of `M_ff v_f = p_f` to the velocity, whose free entries are zero.
    ///
    /// # Errors
    /// [`Error::Linear`] if the iteration does not end.
    fn solve(&mut self, body: &Body, momentum: &[f64], velocity: &mut [f64]) -> Result<()> {
        let MassIteration { inverse_diagonal: d, residual: r, direction: p, product: q, solution: v } = self;
        r.iter_mut().zip(momentum).zip(&*d).for_each(|((r, m), d)| *r = if *d > 0.0 { *m } else { 0.0 });
        p.fill(0.0);
        v.fill(0.0);
        let (mut first, mut rho) = (None, 1.0);
        for iteration in 0.. {
            q.iter_mut().zip(&*r).zip(&*d).for_each(|((z, r), d)| *z = d * r);
            let new = body.space.dot(r, q);
            if new <= ROUNDING * ROUNDING * *first.get_or_insert(new) {
                break;
            }
            if iteration == MAX_ITERATIONS || !new.is_finite() {
                let reason = "conjugate gradients found no velocity of a momentum".to_string();
                return Err(Error::Linear { reason });
            }
            p.iter_mut().zip(&*q).for_each(|(p, z)| *p = z + new / rho * *p);
            rho = new;
            body.space.update_guests("direction of a velocity", p);
            body.mass_product(p, q);
            q.iter_mut().zip(&*d).filter(|(_, d)| **d == 0.0).for_each(|(q, _)| *q = 0.0);
            let alpha = rho / body.space.dot(p, q);
            v.iter_mut().zip(&*p).for_each(|(v, p)| *v += alpha * p);
            r.iter_mut().zip(&*q).for_each(|(r, q)| *r -= alpha * q);
        }
        velocity.iter_mut().zip(&*v).for_each(|(velocity, v)| *velocity += v);
        Ok(())
    }
}

impl Body {
    /// Product with the mass matrix, `p = M v`; `v`, `p`: `[n_nodes][3]`. On a team it is zero at guests.
    pub fn mass_product(&self, v: &[f64], p: &mut [f64]) {
        let (p, of_guests) = p.split_at_mut(3 * self.space.own_nodes().end);
        of_guests.fill(0.0);
        p.par_chunks_mut(3 * ROWS).enumerate().for_each(|(task, p)| {
            for (row, p) in (ROWS * task..).zip(p.chunks_exact_mut(3)) {
                let mut sum = [0.0; 3];
                // Nodes without mass come last.
                let columns = &self.pattern().row(row)[..self.pattern().n_outer_columns(row)];
                for (mass, &column) in self.mass()[self.pattern().range(row)].iter().zip(columns) {
                    let v = &v[3 * column as usize..3 * column as usize + 3];
                    (0..3).for_each(|i| sum[i] += mass * v[i]);
                }
                p.copy_from_slice(&sum);
            }
        });
    }
}

/// Rows of one task.
const ROWS: usize = 2048;
