//! The non-linear equations of a step, as Newton's iteration sees them.

use super::preconditioner::Preconditioner;
use super::{State, TimeElement};
use crate::average::Want;
use crate::body::{Assembly, Body, StepInput};
use crate::error::{Error, Result};
use crate::newton::{Sizes, System};
use crate::sparse::reduce::norm;
use crate::sparse::{Gmres, LinearSystem};

/// The stage equations of a body and their memory; a step is set with [`StageSystem::start`].
#[derive(Debug)]
pub struct StageSystem<'a> {
    pub body: &'a Body,
    pub element: TimeElement,
    pub assembly: Assembly,
    pub step_size: f64,
    /// Displacement and momentum at the start of the step.
    pub displacement: Vec<f64>,
    pub momentum: Vec<f64>,
    /// Stage averages of the external force.
    pub external_force: Vec<f64>,
    force: Vec<f64>,
    /// M x_j of the last residual.
    pub mass_rates: Vec<f64>,
    preconditioner: Preconditioner,
    /// Step size for which the factorisation was made; `None`: there is none.
    factorised_for: Option<f64>,
    /// Iterations of GMRES in the last solution.
    last_iterations: usize,
    gmres: Gmres,
    negative: Vec<f64>,
    floor: f64,
}

/// More iterations than this with a factorisation of an earlier tangent, and it is renewed.
const KEEP_BELOW: usize = 12;

/// Iterations of GMRES before giving up.
const MAX_LINEAR_ITERATIONS: usize = 300;

/// Rounding floor of the residual over `eps || |h^2 K| |u| ||`: rounding errors of many terms partly cancel.
const FLOOR: f64 = 0.25;

impl<'a> StageSystem<'a> {
    pub fn new(body: &'a Body, element: TimeElement) -> Result<Self> {
        let (n, k) = (body.n_dofs(), element.degree());
        Ok(StageSystem {
            body,
            assembly: body.assembly(k),
            step_size: 0.0,
            displacement: vec![0.0; n],
            momentum: vec![0.0; n],
            external_force: vec![0.0; k * n],
            force: vec![0.0; k * n],
            mass_rates: vec![0.0; k * n],
            preconditioner: Preconditioner::new(body, &element)?,
            factorised_for: None,
            last_iterations: 0,
            gmres: Gmres::default(),
            negative: vec![0.0; k * n],
            floor: 0.0,
            element,
        })
    }

    /// Sets the step from a state.
    pub fn start(&mut self, state: &State, step_size: f64) {
        self.displacement.copy_from_slice(&state.displacement);
        self.momentum.copy_from_slice(&state.momentum);
        self.step_size = step_size;
        self.floor = 0.0;
    }

    /// Residual on all degrees of freedom, fixed ones included (there it is h^2 times the reaction), and the norms of its
    /// three parts over the free ones.
    pub fn full_residual(&mut self, x: &[f64], residual: &mut [f64]) -> Result<[f64; 3]> {
        self.assemble(x, Want::Stress)?;
        self.assembly.matrix.copy_force(&mut self.force);
        let (n, k, h) = (self.body.n_dofs(), self.element.degree(), self.step_size);
        for (x, mass_rate) in x.chunks_exact(n).zip(self.mass_rates.chunks_exact_mut(n)) {
            self.body.mass_product(x, mass_rate);
        }
        let (inverse, mut squares) = (self.element.inverse_coefficients(), [0.0; 3]);
        for i in 0..k {
            let row_sum: f64 = inverse[i * k..(i + 1) * k].iter().sum();
            for dof in 0..n {
                let inertia: f64 = (0..k).map(|j| inverse[i * k + j] * self.mass_rates[j * n + dof]).sum();
                let (internal, external) =
                    (h * h * self.force[i * n + dof], h * h * self.external_force[i * n + dof]);
                residual[i * n + dof] = inertia - row_sum * h * self.momentum[dof] + (internal - external);
                if !self.body.fixed()[dof] {
                    squares[0] += inertia * inertia;
                    squares[1] += internal * internal;
                    squares[2] += external * external;
                }
            }
        }
        Ok(squares.map(f64::sqrt))
    }

    fn assemble(&mut self, x: &[f64], want: Want) -> Result<()> {
        let step = StepInput {
            rule: self.element.rule(),
            tangent_factor: self.step_size * self.step_size,
            displacement: &self.displacement,
            rates: x,
        };
        self.body.assemble(&step, want, self.element.inverse_coefficients(), &mut self.assembly)
    }

    fn factorize(&mut self) -> Result<()> {
        self.preconditioner.factorize(self.body, &self.assembly.matrix)?;
        self.factorised_for = Some(self.step_size);
        Ok(())
    }

    fn solve(&mut self, tolerance: f64, dx: &mut [f64]) -> (usize, bool) {
        let mut system = Linearised {
            body: self.body,
            assembly: &mut self.assembly,
            preconditioner: &mut self.preconditioner,
        };
        let solution = self.gmres.solve(&mut system, &self.negative, dx, tolerance, MAX_LINEAR_ITERATIONS);
        (solution.iterations, solution.relative_residual <= tolerance)
    }

    /// Solves with the kept factorisation, or with a new one where that is too old.
    fn solve_with_fresh_enough(&mut self, tolerance: f64, dx: &mut [f64]) -> Result<usize> {
        let fresh = self.factorised_for != Some(self.step_size) || self.last_iterations > KEEP_BELOW;
        if fresh {
            self.factorize()?;
        }
        let (mut iterations, mut solved) = self.solve(tolerance, dx);
        if !solved && !fresh {
            self.factorize()?;
            let (more, solved_now) = self.solve(tolerance, dx);
            (iterations, solved) = (iterations + more, solved_now);
        }
        self.last_iterations = if solved { iterations } else { MAX_LINEAR_ITERATIONS };
        if solved {
            return Ok(iterations);
        }
        Err(Error::Linear {
            reason: format!("GMRES did not reach {tolerance:e} in {MAX_LINEAR_ITERATIONS} iterations"),
        })
    }
}

impl System for StageSystem<'_> {
    fn residual(&mut self, x: &[f64], residual: &mut [f64]) -> Result<Sizes> {
        let parts = self.full_residual(x, residual)?;
        clear_fixed(self.body, residual);
        Ok(Sizes {
            residual: norm(residual),
            scale: parts.into_iter().fold(0.0, f64::max),
            floor: self.floor,
        })
    }

    fn correction(
        &mut self,
        x: &[f64],
        residual: &[f64],
        tolerance: f64,
        rebuild: bool,
        dx: &mut [f64],
    ) -> Result<usize> {
        if rebuild {
            self.assemble(x, Want::Tangent)?;
        }
        self.negative.iter_mut().zip(residual).for_each(|(b, r)| *b = -r);
        let iterations = self.solve_with_fresh_enough(tolerance, dx)?;
        if self.floor == 0.0 {
            let increment = &x[..self.body.n_dofs()];
            let size = self.preconditioner.rounding_size(self.body, &self.displacement, increment);
            self.floor = FLOOR * f64::EPSILON * size * (self.element.degree() as f64).sqrt();
        }
        Ok(iterations)
    }
}

/// The linear system of a Newton iteration, on the free degrees of freedom.
struct Linearised<'a> {
    body: &'a Body,
    assembly: &'a mut Assembly,
    preconditioner: &'a mut Preconditioner,
}

impl LinearSystem for Linearised<'_> {
    fn product(&mut self, x: &[f64], y: &mut [f64]) {
        self.assembly.matrix.multiply(self.body.pattern(), x, y);
        clear_fixed(self.body, y);
    }

    fn precondition(&mut self, x: &[f64], y: &mut [f64]) {
        self.preconditioner.apply(x, y);
    }
}

/// Sets the entries of the fixed degrees of freedom to zero in every stage.
fn clear_fixed(body: &Body, vector: &mut [f64]) {
    for stage in vector.chunks_exact_mut(body.n_dofs()) {
        stage.iter_mut().zip(body.fixed()).filter(|(_, fixed)| **fixed).for_each(|(value, _)| *value = 0.0);
    }
}
