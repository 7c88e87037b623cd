//! Inverse of the stiffness without follower loads: a factorisation, or on a team an approximation and conjugate
//! gradients.

use std::collections::HashMap;
use std::sync::Arc;

use crate::body::Body;
use crate::error::Result;
use crate::sparse::{
    Condensation, CoupledCholesky, Iterative, SharedRows, Shifted, ShiftedSolver, StageMatrix, SweepOrder,
};

/// The inverse, as a preconditioner.
#[derive(Debug)]
pub(super) enum Inverse {
    Factor(Box<CoupledCholesky>),
    OfRanks(Box<InverseOfRanks>),
}

/// Incomplete factors of the rows of each rank, with the internal nodes condensed, and the memory of conjugate
/// gradients.
#[derive(Debug)]
pub(super) struct InverseOfRanks {
    solver: Box<dyn ShiftedSolver>,
    condensation: Option<Condensation>,
    /// No mass, for each block of the pattern.
    no_mass: Vec<f64>,
    residual: Vec<f64>,
    preconditioned: Vec<f64>,
    direction: Vec<f64>,
    product: Vec<f64>,
}

/// End of an iteration of conjugate gradients.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Found {
    /// A solution after some iterations.
    Solution(usize),
    /// A direction along which the stiffness is not positive.
    NotDefinite,
    /// Neither.
    Nothing,
}

/// Iterations of conjugate gradients before giving up.
const MAX_ITERATIONS: usize = 5000;

impl Inverse {
    /// Memory for a body; symbolic factorisation.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`], [`crate::Error::Linear`].
    pub(super) fn new(body: &Body) -> Result<Self> {
        if body.space.is_shared() {
            return Ok(Inverse::OfRanks(Box::new(InverseOfRanks::new(body))));
        }
        let factor = CoupledCholesky::new(body.pattern(), body.fixed(), body.node_order()?)?;
        Ok(Inverse::Factor(Box::new(factor)))
    }

    /// Sets the stiffness. Whether it is positive definite; on a team that is not known yet.
    ///
    /// # Errors
    /// [`crate::Error::Linear`] for a stiffness that is not finite.
    pub(super) fn set(&mut self, body: &Body, stiffness: &StageMatrix) -> Result<bool> {
        match self {
            Inverse::Factor(_) => self.set_anchored(body, stiffness, &HashMap::new()),
            Inverse::OfRanks(inverse) => body.space.agree(inverse.set(body, stiffness)).map(|()| true),
        }
    }

    /// The same with a stiffness in addition at some entries of the matrix; not on a team, which has no joints.
    ///
    /// # Errors
    /// As [`Inverse::set`].
    pub(super) fn set_anchored(
        &mut self,
        body: &Body,
        stiffness: &StageMatrix,
        anchors: &HashMap<usize, f64>,
    ) -> Result<bool> {
        let Inverse::Factor(factor) = self else { return self.set(body, stiffness) };
        let anchor = |at: usize| anchors.get(&at).copied().unwrap_or(0.0);
        factor.factorize((body.pattern(), body.fixed()), stiffness, anchor)?;
        Ok(factor.cholesky.is_definite())
    }

    /// Cost of setting it, in solutions.
    pub(super) fn cost(&self) -> f64 {
        match self {
            Inverse::Factor(factor) => factor.cholesky.cost_over_solution(),
            Inverse::OfRanks(inverse) => inverse.solver.refactorization_cost(),
        }
    }

    /// `y = P^-1 y`, y zero at the fixed degrees of freedom.
    pub(super) fn apply(&mut self, body: &Body, y: &mut [f64]) {
        match self {
            Inverse::Factor(factor) => {
                let mut y = y;
                factor.cholesky.solve(1, &mut y, |y, _, row| y[row], |y, _, row, value| y[row] = value);
            }
            Inverse::OfRanks(inverse) => {
                inverse.apply(y);
                body.space.update_guests("preconditioned force", y);
            }
        }
    }
}

impl InverseOfRanks {
    fn new(body: &Body) -> Self {
        let no_mass = vec![0.0; body.pattern().n_blocks()];
        let condensation = body.condensation(&no_mass);
        let pattern = condensation.as_ref().map_or(body.pattern(), |condensation| &condensation.pattern);
        let sweep = Arc::new(SweepOrder::new(pattern));
        let rows = body.space.shared().cloned().map(|subdomain| SharedRows::new(subdomain, &sweep));
        let fixed = &body.space.inactive()[..3 * pattern.n_rows()];
        let zero = vec![0.0; body.n_dofs()];
        InverseOfRanks {
            solver: Box::new(Iterative::<1>::new(fixed, sweep, rows)),
            condensation,
            no_mass,
            residual: zero.clone(),
            preconditioned: zero.clone(),
            direction: zero.clone(),
            product: zero,
        }
    }

    fn set(&mut self, body: &Body, stiffness: &StageMatrix) -> Result<()> {
        let (mut stiffness, mut n_rows) = (stiffness, body.pattern().n_rows());
        if let Some(condensation) = &mut self.condensation {
            condensation.condense(body.pattern(), stiffness, body.fixed())?;
            (stiffness, n_rows) = (&condensation.stiffness, condensation.pattern.n_rows());
        }
        self.solver.factorize(&Shifted {
            stiffness,
            mass: &self.no_mass,
            fixed: &body.space.inactive()[..3 * n_rows],
            positions: body.mesh().points().as_flattened(),
            shift: [1.0, 0.0],
            elastic: None,
            in_single_precision: false,
        })
    }

    fn apply(&mut self, y: &mut [f64]) {
        let Some(condensation) = &mut self.condensation else { return self.solver.precondition(y) };
        self.solver.precondition(condensation.reduce(y, 1));
        condensation.expand([1.0, 0.0], y, 1);
    }

    /// Solves `K x = b` with a symmetric stiffness to a relative tolerance; `b` is zero at the fixed degrees of
    /// freedom.
    pub(super) fn solve(
        &mut self,
        body: &Body,
        stiffness: &mut StageMatrix,
        b: &[f64],
        x: &mut [f64],
        tolerance: f64,
    ) -> Found {
        x.fill(0.0);
        self.direction.fill(0.0);
        self.residual.copy_from_slice(b);
        let norm = body.space.norm(b);
        let (mut left, mut rho, mut iterations) = (norm, 1.0, 0);
        while left > tolerance * norm {
            self.preconditioned.copy_from_slice(&self.residual);
            let mut z = std::mem::take(&mut self.preconditioned);
            self.apply(&mut z);
            let new = body.space.dot(&self.residual, &z);
            let beta = if iterations == 0 { 0.0 } else { new / rho };
            rho = new;
            self.direction.iter_mut().zip(&z).for_each(|(p, z)| *p = z + beta * *p);
            self.preconditioned = z;
            body.space.update_guests("direction of a step", &mut self.direction);
            stiffness.multiply(body.pattern(), &self.direction, &mut self.product);
            body.space.clear_inactive(&mut self.product);
            let curvature = body.space.dot(&self.direction, &self.product);
            if curvature <= 0.0 {
                return Found::NotDefinite;
            }
            let alpha = rho / curvature;
            x.iter_mut().zip(&self.direction).for_each(|(x, p)| *x += alpha * p);
            self.residual.iter_mut().zip(&self.product).for_each(|(r, q)| *r -= alpha * q);
            left = body.space.norm(&self.residual);
            iterations += 1;
            if iterations == MAX_ITERATIONS || !left.is_finite() {
                return Found::Nothing;
            }
        }
        if left.is_finite() { Found::Solution(iterations) } else { Found::Nothing }
    }
}
