//! The tangent of a step, approximated by one stiffness.

use std::sync::Arc;

use super::decoupling::{Mode, modes};
use super::shifted_solver::{Direct, DirectPair, Iterative, ShiftedSolver};
use super::stage_system::StageForm;
use crate::average::{Rule, Want};
use crate::body::{Assembly, Body, StepInput};
use crate::error::Result;
use crate::polynomial::lagrange_integral;
use crate::quadrature::gauss;
use crate::sparse::{SweepOrder, nested_dissection};

/// `df_i/dx_j ~ w_ij K` with the stiffness K of one displacement, in the middle of a step: symmetric, whatever the scheme. It is
/// kept until the iteration becomes slow with it.
#[derive(Debug)]
pub struct ApproximateTangent {
    modes: Vec<Mode>,
    /// Integrals of the basis up to the middle of the step, `[k]`.
    half: Vec<f64>,
    rule: Rule,
    assembly: Assembly,
    solvers: Vec<Box<dyn ShiftedSolver>>,
    is_iterative: bool,
    /// The time s of the stage equations that the solvers were made for.
    made_for: Option<f64>,
    /// Displacement of K.
    displacement: Vec<f64>,
    rest: Vec<f64>,
    /// `sum_m |K_lm|` of each row l.
    row_sums: Vec<f64>,
    columns: Vec<f64>,
}

impl ApproximateTangent {
    /// Memory; what depends on the solver is made with the first stiffness.
    ///
    /// # Errors
    /// [`crate::Error::Linear`].
    pub fn new(body: &Body, form: &StageForm) -> Result<Self> {
        let (n, nodes) = (body.n_dofs(), form.rule.nodes());
        Ok(ApproximateTangent {
            modes: modes(form)?,
            half: (0..nodes.len()).map(|j| lagrange_integral(nodes, j, 0.5)).collect(),
            rule: Rule::standard(1, &gauss(1)),
            assembly: body.assembly(1),
            solvers: Vec::new(),
            is_iterative: false,
            made_for: None,
            displacement: vec![0.0; n],
            rest: vec![0.0; n],
            row_sums: vec![0.0; n],
            columns: vec![0.0; if nodes.len() > 1 { 2 * n } else { n }],
        })
    }

    /// Whether there is a stiffness.
    pub fn is_made(&self) -> bool {
        self.made_for.is_some()
    }

    /// Takes the stiffness in the middle of a step from a displacement with rates x; at its start, if the middle is inverted.
    ///
    /// # Errors
    /// [`crate::Error::Inverted`], [`crate::Error::Linear`].
    pub fn renew(&mut self, body: &Body, displacement: &[f64], rates: &[f64], time_scale: f64) -> Result<()> {
        self.made_for = None;
        self.displacement.copy_from_slice(displacement);
        for (rates, half) in rates.chunks_exact(body.n_dofs()).zip(&self.half) {
            self.displacement.iter_mut().zip(rates).for_each(|(u, x)| *u += half * x);
        }
        if self.assemble(body).is_err() {
            self.displacement.copy_from_slice(displacement);
            self.assemble(body)?;
        }
        self.sum_rows(body);
        self.set(body, time_scale)
    }

    /// Makes the solvers fit to a time s, with the stiffness that there is.
    ///
    /// # Errors
    /// [`crate::Error::Linear`].
    pub fn fit(&mut self, body: &Body, time_scale: f64) -> Result<()> {
        if self.made_for == Some(time_scale) { Ok(()) } else { self.set(body, time_scale) }
    }

    fn assemble(&mut self, body: &Body) -> Result<()> {
        // dP/dF' is half of dP/dF in the middle.
        let step = StepInput {
            rule: &self.rule,
            tangent_factor: 2.0,
            displacement: &self.displacement,
            rates: &self.rest,
        };
        body.assemble(&step, Want::Tangent, &[0.0], &mut self.assembly)
    }

    fn set(&mut self, body: &Body, time_scale: f64) -> Result<()> {
        self.made_for = None;
        if self.solvers.is_empty() {
            self.choose(body, time_scale)?;
        }
        for (mode, solver) in self.modes.iter().zip(&mut self.solvers) {
            let shift = mode.eigenvalue.map(|part| time_scale * time_scale * part);
            solver.renew(body, &self.assembly.matrix, shift)?;
        }
        self.made_for = Some(time_scale);
        Ok(())
    }

    /// Chooses between conjugate gradients and factorisations.
    fn choose(&mut self, body: &Body, time_scale: f64) -> Result<()> {
        let largest = self.modes.iter().map(Mode::modulus).fold(0.0, f64::max);
        let stiffness = time_scale * time_scale * largest * self.stiffness_over_mass(body);
        self.is_iterative = match std::env::var("EMMY_SOLVER").as_deref() {
            Ok("direct") => false,
            Ok("iterative") => true,
            _ => stiffness < 1000.0,
        };
        if std::env::var("EMMY_SOLVER").is_ok() {
            eprintln!("kappa {stiffness}");
        }
        let pairs = self.modes.iter().any(|mode| mode.n_columns() == 2);
        let sweep =
            if self.is_iterative || pairs { Some(Arc::new(SweepOrder::new(body.pattern()))) } else { None };
        let order = if self.is_iterative { Vec::new() } else { nested_dissection(body.pattern())? };
        for mode in &self.modes {
            self.solvers.push(match (&sweep, self.is_iterative, mode.n_columns()) {
                (Some(sweep), true, 1) => Box::new(Iterative::<1>::new(body, sweep.clone())),
                (Some(sweep), true, _) => Box::new(Iterative::<2>::new(body, sweep.clone())),
                (Some(sweep), false, 2) => Box::new(DirectPair::new(body, &order, sweep.clone())?),
                _ => Box::new(Direct::new(body, &order)?),
            });
        }
        Ok(())
    }

    /// Largest ratio of a diagonal entry of K to the mass of its node.
    fn stiffness_over_mass(&self, body: &Body) -> f64 {
        let ratio = |dof: usize| {
            let node = dof / 3;
            let diagonal = body.pattern().position(node, node).unwrap_or(0);
            self.assembly.matrix.block(diagonal)[4 * (dof % 3)].abs() / body.lumped_mass()[node]
        };
        let free = (0..body.n_dofs()).filter(|&dof| !body.fixed()[dof]);
        free.map(ratio).fold(0.0, f64::max)
    }

    /// What a new stiffness costs, in corrections with the old one.
    pub fn renewal_cost(&self) -> f64 {
        4.0
    }

    /// Solves the linearised stage equations to a relative tolerance; `r`, `z`: `[k][n_nodes][3]`. Returns the number of
    /// iterations, `None` if a solver did not come there.
    pub fn solve(&mut self, r: &[f64], z: &mut [f64], tolerance: f64) -> Option<usize> {
        z.fill(0.0);
        let mut total = Some(0);
        for (mode, solver) in self.modes.iter().zip(&mut self.solvers) {
            let columns = &mut self.columns[..r.len() / self.half.len() * mode.n_columns()];
            mode.restrict(r, columns);
            total = solver.solve(columns, tolerance).and_then(|n| total.map(|total| total + n));
            mode.add_to(&mode.backward, columns, z);
        }
        total
    }

    /// `z = P^-1 r`, a linear map near the inverse of the linearised stage equations.
    pub fn precondition(&mut self, r: &[f64], z: &mut [f64]) {
        z.fill(0.0);
        for (mode, solver) in self.modes.iter().zip(&mut self.solvers) {
            let columns = &mut self.columns[..r.len() / self.half.len() * mode.n_columns()];
            mode.restrict(r, columns);
            solver.precondition(columns);
            mode.add_to(&mode.turned, columns, z);
        }
    }

    fn sum_rows(&mut self, body: &Body) {
        for row in 0..body.pattern().n_rows() {
            let mut sums = [0.0; 3];
            for position in body.pattern().range(row) {
                let block = self.assembly.matrix.block(position);
                (0..9).for_each(|at| sums[at / 3] += block[at].abs());
            }
            self.row_sums[3 * row..3 * row + 3].copy_from_slice(&sums);
        }
    }

    /// Norm of `|s^2 K| |u|` over the free degrees of freedom, u being alike at neighbours: rounding of the forces is eps times
    /// this.
    pub fn rounding_size(&self, body: &Body, displacement: &[f64], rates: &[f64], time_scale: f64) -> f64 {
        let terms = self.row_sums.iter().zip(displacement.iter().zip(rates)).zip(body.fixed());
        let square = |((sum, (u, x)), fixed): ((&f64, (&f64, &f64)), &bool)| {
            if *fixed { 0.0 } else { (sum * (u.abs() + x.abs())).powi(2) }
        };
        time_scale * time_scale * terms.map(square).sum::<f64>().sqrt()
    }
}
