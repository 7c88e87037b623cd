//! The tangent of a step, approximated by one stiffness.

use std::sync::Arc;

use rayon::prelude::*;

use super::Memory;
use super::decoupling::{Mode, modes};
use super::prediction::rigid::RigidStep;
use super::prediction::rotation::{UNIT, exp, product};
use super::shifted_solver::{Direct, DirectPair, Iterative, ShiftedSolver};
use super::stage_system::StageForm;
use super::straining::Straining;
use crate::average::{Rule, Want};
use crate::body::{Assembly, Body, StepDamping, StepInput};
use crate::error::Result;
use crate::polynomial::lagrange_integral;
use crate::quadrature::gauss;
use crate::sparse::{Solver, SolverChoice, SweepOrder, inverse};
use crate::tensor::Mat3;

/// `df_i/dx_j ~ w_ij K` with the stiffness K of one displacement, in the middle of a step: symmetric, whatever the scheme. It is
/// kept until the iteration becomes slow with it.
#[derive(Debug)]
pub struct ApproximateTangent {
    modes: Vec<Mode>,
    /// Coefficients of the inertia without drag, and of the response, `[i k + j]`.
    mass: Vec<f64>,
    response: Vec<f64>,
    /// Modulus of the largest eigenvalue of the response.
    response_size: f64,
    /// Integrals of the basis up to the middle of the step, or to its end if the rule finds the middle, `[k]`.
    passed: Vec<f64>,
    rule: Rule,
    assembly: Assembly,
    solvers: Vec<Box<dyn ShiftedSolver>>,
    /// The solver asked for.
    wanted: Solver,
    choice: Option<SolverChoice>,
    /// Rotation from the body of K to that in the middle of the step.
    orientation: Mat3<f64>,
    /// Rotation vector of the step.
    rotation: [f64; 3],
    /// Rotations from the middle of the step to its Gauss points, `[k]`.
    stage_rotations: Vec<Mat3<f64>>,
    /// Whether the body turns under a rule that takes strains from rates.
    turns: bool,
    straining: Straining,
    turned: Vec<f64>,
    /// The time s of the stage equations that the solvers were made for.
    made_for: Option<f64>,
    /// Factor on viscosities in K.
    viscous_rate: f64,
    /// The time s that the modes were made for, where they depend on it.
    modes_for: Option<f64>,
    /// Displacement of K.
    displacement: Vec<f64>,
    rates: Vec<f64>,
    /// `sum_m |K_lm|` of each row l.
    row_sums: Vec<f64>,
    columns: Vec<f64>,
}

impl ApproximateTangent {
    /// Memory; what depends on the solver is made with the first stiffness.
    ///
    /// # Errors
    /// [`crate::Error::Linear`].
    pub fn new(body: &Body, form: &StageForm, solver: Solver) -> Result<Self> {
        let (n, nodes) = (body.n_dofs(), form.rule.nodes());
        let (rule, until) = if form.rule.is_energy_momentum() && nodes.len() == 1 {
            (Rule::straining_rates(), 1.0)
        } else {
            (Rule::standard(1, &gauss(1)), 0.5)
        };
        let modes = modes(&form.inverse_mass, &form.response)?;
        // m^-1 w is the square of w.
        let response_size = modes.iter().map(Mode::modulus).fold(0.0, f64::max).sqrt();
        Ok(ApproximateTangent {
            modes,
            response_size,
            mass: form.mass.clone(),
            response: form.response.clone(),
            viscous_rate: 0.0,
            modes_for: None,
            passed: (0..nodes.len()).map(|j| lagrange_integral(nodes, j, until)).collect(),
            rule,
            assembly: body.assembly(1),
            solvers: Vec::new(),
            wanted: solver,
            choice: None,
            orientation: UNIT,
            rotation: [0.0; 3],
            stage_rotations: vec![UNIT; nodes.len()],
            turns: false,
            straining: Straining::new(nodes.len(), n),
            turned: vec![0.0; n * nodes.len()],
            made_for: None,
            displacement: vec![0.0; n],
            rates: vec![0.0; n],
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
        self.orientation = UNIT;
        self.place(displacement, rates);
        self.viscous_rate = self.rate(time_scale);
        if self.assemble(body).is_err() {
            self.displacement.copy_from_slice(displacement);
            self.rates.fill(0.0);
            self.assemble(body)?;
        }
        self.sum_rows(body);
        self.set(body, time_scale)
    }

    /// Keeps what the next steps depend on. The stiffness itself follows from displacement and rates.
    pub fn keep(&self, memory: &mut Memory) {
        memory.keep("tangent.displacement", &self.displacement);
        memory.keep("tangent.rates", &self.rates);
        memory.keep_number("tangent.viscous_rate", self.viscous_rate);
        memory.keep("tangent.orientation", self.orientation.as_flattened());
        memory.keep("tangent.rotation", &self.rotation);
        memory.keep_option("tangent.made_for", self.made_for);
        memory.keep_flag("tangent.has_solvers", !self.solvers.is_empty());
        memory.keep_word("solver.wanted", self.wanted.name());
        memory.keep_flag("solver.is_chosen", self.choice.is_some());
        if let Some(choice) = self.choice {
            memory.keep_flag("solver.is_iterative", choice.is_iterative);
            memory.keep_number("solver.stiffness", choice.stiffness);
            memory.keep_option("solver.limit", choice.limit);
        }
    }

    /// Takes over what [`ApproximateTangent::keep`] kept, and makes stiffness and factors of it again.
    ///
    /// # Errors
    /// [`crate::Error::Memory`], [`crate::Error::Inverted`], [`crate::Error::Linear`].
    pub fn restore(&mut self, body: &Body, memory: &Memory) -> Result<()> {
        memory.fill("tangent.displacement", &mut self.displacement)?;
        memory.fill("tangent.rates", &mut self.rates)?;
        self.viscous_rate = memory.number("tangent.viscous_rate")?;
        memory.fill("tangent.orientation", self.orientation.as_flattened_mut())?;
        self.rotation = memory.array("tangent.rotation")?;
        let wanted = memory.word("solver.wanted")?;
        self.wanted = Solver::named(wanted).unwrap_or(self.wanted);
        self.choice = None;
        if memory.flag("solver.is_chosen")? {
            self.choice = Some(SolverChoice {
                is_iterative: memory.flag("solver.is_iterative")?,
                stiffness: memory.number("solver.stiffness")?,
                limit: memory.option("solver.limit")?,
            });
        }
        self.solvers.clear();
        self.made_for = None;
        let has_solvers = memory.flag("tangent.has_solvers")?;
        if let Some(choice) = self.choice.filter(|_| has_solvers) {
            self.make_solvers(body, choice)?;
        }
        if let Some(time_scale) = memory.option("tangent.made_for")? {
            self.assemble(body)?;
            self.sum_rows(body);
            self.set(body, time_scale)?;
        }
        Ok(())
    }

    /// Sets displacement and rates to those from which the rule of K sees the middle of the step.
    fn place(&mut self, displacement: &[f64], rates: &[f64]) {
        let n = displacement.len();
        self.displacement.copy_from_slice(displacement);
        self.rates.fill(0.0);
        let sum = if self.rule.is_energy_momentum() { &mut self.rates } else { &mut self.displacement };
        for (rates, passed) in rates.chunks_exact(n).zip(&self.passed) {
            sum.iter_mut().zip(rates).for_each(|(sum, x)| *sum += passed * x);
        }
    }

    /// Goes over to the next step, in which the body turns by a rotation vector: `M + lambda K` turns with it, so that K stays
    /// near, however often the body turns around.
    pub fn turn(&mut self, step: &RigidStep, rule: &Rule) {
        for half in [&self.rotation, &step.rotation] {
            self.orientation = product(&exp(&half.map(|w| 0.5 * w)), &self.orientation);
        }
        self.rotation = step.rotation;
        for (stage, c) in self.stage_rotations.iter_mut().zip(rule.nodes()) {
            *stage = exp(&step.rotation.map(|w| (c - 0.5) * w));
        }
        self.turns = rule.is_energy_momentum() && step.rotation != [0.0; 3];
        if self.turns {
            self.straining.turn(rule, &step.spins);
        }
    }

    /// The solver, once there is one.
    pub fn choice(&self) -> Option<SolverChoice> {
        self.choice
    }

    /// Makes the solvers fit to a time s, with the stiffness that there is.
    ///
    /// # Errors
    /// [`crate::Error::Linear`].
    pub fn fit(&mut self, body: &Body, time_scale: f64) -> Result<()> {
        if self.made_for == Some(time_scale) { Ok(()) } else { self.set(body, time_scale) }
    }

    /// Factor on viscosities in the stiffness: by the size of w they have there the weight that they have in the stage equations.
    fn rate(&self, time_scale: f64) -> f64 {
        0.5 / (time_scale * self.response_size)
    }

    /// Sets the modes of a body with viscosity or drag. Viscosities are taken as a time t_v by which the stiffness is multiplied.
    ///
    /// ```math
    /// m_ij + s alpha delta_ij,    w_ij + t_v/s delta_ij
    /// ```
    fn set_modes(&mut self, body: &Body, time_scale: f64) -> Result<()> {
        let with_diagonal = |matrix: &[f64], value: f64| {
            let (k, mut matrix) = (matrix.len().isqrt(), matrix.to_vec());
            (0..k).for_each(|i| matrix[i * k + i] += value);
            matrix
        };
        let mass = with_diagonal(&self.mass, time_scale * body.drag());
        let response = with_diagonal(&self.response, body.viscous_time() / time_scale);
        self.modes = modes(&inverse(&mass), &response)?;
        self.modes_for = Some(time_scale);
        Ok(())
    }

    fn assemble(&mut self, body: &Body) -> Result<()> {
        // dP/dF' is half of dP/dF in the middle; with viscosities it is `K (1 + 2 rate t_v)/2` where they are those of the modes.
        let step = StepInput {
            rule: &self.rule,
            tangent_factor: 2.0 / (1.0 + 2.0 * self.viscous_rate * body.viscous_time()),
            displacement: &self.displacement,
            rates: &self.rates,
            damping: StepDamping { rate: self.viscous_rate, excess: 0.0 },
        };
        body.assemble(&step, Want::Tangent, &[0.0], &mut self.assembly)
    }

    fn set(&mut self, body: &Body, time_scale: f64) -> Result<()> {
        self.made_for = None;
        if (body.drag() > 0.0 || body.is_viscous()) && self.modes_for != Some(time_scale) {
            self.set_modes(body, time_scale)?;
        }
        self.choose(body, time_scale)?;
        for (mode, solver) in self.modes.iter().zip(&mut self.solvers) {
            let shift = mode.eigenvalue.map(|part| time_scale * time_scale * part);
            solver.renew(body, &self.assembly.matrix, shift)?;
        }
        self.made_for = Some(time_scale);
        Ok(())
    }

    /// Makes the solvers of the kind that was asked for, or of the one that costs less: other ones than there are, where step size or
    /// stiffness have changed by so much that it clearly costs less.
    fn choose(&mut self, body: &Body, time_scale: f64) -> Result<()> {
        if !self.solvers.is_empty() && self.wanted != Solver::Auto {
            return Ok(());
        }
        let largest = self.modes.iter().map(Mode::modulus).fold(0.0, f64::max);
        let stiffness = time_scale * time_scale * largest * self.stiffness_over_mass(body);
        let limit = iterative_limit(body);
        if let Some(choice) = self.choice.filter(|_| !self.solvers.is_empty()) {
            let is_iterative =
                if choice.is_iterative { stiffness < limit * CLEARLY } else { stiffness < limit / CLEARLY };
            if is_iterative == choice.is_iterative {
                return Ok(());
            }
            self.solvers.clear();
        }
        let choice = match self.wanted {
            Solver::Auto => SolverChoice { is_iterative: stiffness < limit, stiffness, limit: Some(limit) },
            wanted => SolverChoice { is_iterative: wanted == Solver::Iterative, stiffness, limit: None },
        };
        self.choice = Some(choice);
        self.make_solvers(body, choice)
    }

    fn make_solvers(&mut self, body: &Body, choice: SolverChoice) -> Result<()> {
        let has_pairs = self.modes.iter().any(|mode| mode.n_columns() == 2);
        let sweep = (choice.is_iterative || has_pairs).then(|| Arc::new(SweepOrder::new(body.pattern())));
        for mode in &self.modes {
            self.solvers.push(match (&sweep, choice.is_iterative, mode.n_columns()) {
                (Some(sweep), true, 1) => Box::new(Iterative::<1>::new(body, sweep.clone())),
                (Some(sweep), true, _) => Box::new(Iterative::<2>::new(body, sweep.clone())),
                (Some(sweep), false, 2) => {
                    Box::new(DirectPair::new(body, body.node_order()?, sweep.clone())?)
                }
                _ => Box::new(Direct::new(body, body.node_order()?)?),
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
        let costs = self.solvers.iter().map(|solver| solver.renewal_cost());
        costs.fold(0.0, f64::max)
    }

    /// Solves the linearised stage equations to a relative tolerance; `r`, `z`: `[k][n_nodes][3]`. Returns the number of
    /// iterations, `None` if a solver did not come there.
    pub fn solve(&mut self, r: &[f64], z: &mut [f64], tolerance: f64) -> Option<usize> {
        let mut total = Some(0);
        self.in_modes(
            r,
            z,
            |solver, columns| {
                total = solver.solve(columns, tolerance).and_then(|n| total.map(|total| total + n));
            },
            |mode| &mode.backward,
        );
        if total.is_none() {
            self.give_up();
        }
        total
    }

    /// `z = P^-1 r`, a linear map near the inverse of the linearised stage equations.
    pub fn precondition(&mut self, r: &[f64], z: &mut [f64]) {
        self.in_modes(r, z, |solver, columns| solver.precondition(columns), |mode| &mode.turned);
    }

    /// Solves mode by mode, in the orientation of K.
    fn in_modes(
        &mut self,
        r: &[f64],
        z: &mut [f64],
        mut solve: impl FnMut(&mut dyn ShiftedSolver, &mut [f64]),
        backward: impl Fn(&Mode) -> &Vec<f64>,
    ) {
        let n = r.len() / self.passed.len();
        self.turned.copy_from_slice(r);
        for (stage, R) in self.turned.chunks_exact_mut(n).zip(&self.stage_rotations) {
            rotate(stage, &transposed(&product(R, &self.orientation)));
        }
        z.fill(0.0);
        for (mode, solver) in self.modes.iter().zip(&mut self.solvers) {
            let columns = &mut self.columns[..n * mode.n_columns()];
            mode.restrict(&self.turned, columns);
            solve(&mut **solver, columns);
            mode.add_to(backward(mode), columns, z);
        }
        for (stage, R) in z.chunks_exact_mut(n).zip(&self.stage_rotations) {
            rotate(stage, &product(R, &self.orientation));
        }
        // Where the mass dominates the change of basis would do more harm to its part than good to that of K.
        if self.turns && self.choice.is_some_and(|choice| !choice.is_iterative) {
            self.straining.undo(z);
        }
    }

    /// Goes over to a factorisation with the next stiffness, where the solver was left open.
    fn give_up(&mut self) {
        if self.wanted == Solver::Auto && self.choice.is_some_and(|choice| choice.is_iterative) {
            self.wanted = Solver::Direct;
            self.solvers.clear();
        }
        self.made_for = None;
    }

    fn sum_rows(&mut self, body: &Body) {
        let matrix = &self.assembly.matrix;
        self.row_sums.as_chunks_mut::<3>().0.par_iter_mut().enumerate().for_each(|(row, sums)| {
            *sums = [0.0; 3];
            for position in body.pattern().range(row) {
                let block = matrix.block(position);
                (0..9).for_each(|at| sums[at / 3] += block[at].abs());
            }
        });
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

    /// Strain energy of displacements that are off by rounding, `(eps/2)^2 |u| . |K| |u| / 2` \[energy\].
    pub fn rounding_energy(&self, displacement: &[f64], rates: &[f64]) -> f64 {
        let terms = self.row_sums.iter().zip(displacement.iter().zip(rates));
        let sum: f64 = terms.map(|(sum, (u, x))| sum * (u.abs() + x.abs()).powi(2)).sum();
        0.125 * f64::EPSILON * f64::EPSILON * sum
    }
}

/// Stiffness number up to which conjugate gradients cost less than factorisations.
///
/// Both are limited by memory. By profiles of the block of `benches` at r = 2 and 4 on an AMD EPYC: an iteration takes 2 ns a
/// coupling of nodes, `12 sqrt(c)` of them a step; a step with a factorisation takes 6 solutions at 1.6 ns an entry of the
/// factor, which has about `15 n^(4/3)` of them for n degrees of freedom, as nested dissection leaves in three dimensions. Times of
/// both solvers side by side cross at c = 170 (r = 2, where this gives 180) and above 600 (r = 4, 500).
fn iterative_limit(body: &Body) -> f64 {
    let iteration = 2.0e-9 * body.pattern().n_blocks() as f64;
    let solution = 1.6e-9 * 15.0 * (body.n_dofs() as f64).powf(4.0 / 3.0);
    (6.0 * solution / (12.0 * iteration)).powi(2)
}

/// Solvers are changed where the stiffness number is this many times beyond the limit.
const CLEARLY: f64 = 4.0;

/// Nodes that one task works on.
const NODES: usize = 2048;

/// Turns the vectors of all nodes, `[n_nodes][3]`.
fn rotate(vectors: &mut [f64], R: &Mat3<f64>) {
    if *R == UNIT {
        return;
    }
    vectors.par_chunks_mut(3 * NODES).for_each(|vectors| {
        for v in vectors.as_chunks_mut::<3>().0 {
            *v = [0, 1, 2].map(|a| R[a][0] * v[0] + R[a][1] * v[1] + R[a][2] * v[2]);
        }
    });
}

fn transposed(A: &Mat3<f64>) -> Mat3<f64> {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| A[j][i]))
}
