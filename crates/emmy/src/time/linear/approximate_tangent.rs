//! The tangent of a step, approximated by one stiffness.

use rayon::prelude::*;

use super::mode_solvers::{ElasticStiffness, ModeSolvers, Stiffness, separated};
use super::turning::{Turning, turn_table};
use crate::average::{Request, Rule};
use crate::body::{Assembly, Body, ReusedDamping};
use crate::error::Result;
use crate::force::{StepDamping, StepInput};
use crate::polynomial::lagrange_integral;
use crate::quadrature::gauss;
use crate::sparse::{Couplings, Solver, SolverChoice};
use crate::tensor::Mat3;
use crate::tensor::rotation::{IDENTITY, exp, product};
use crate::time::Memory;
use crate::time::rigid_step::RigidStep;
use crate::time::stage_coefficients::StageCoefficients;

/// `df_i/dx_j ~ w_ij K` with the stiffness K at one displacement, in the middle of a step. It is symmetric for every
/// scheme, and reused until the iteration becomes slow.
#[derive(Debug)]
pub(crate) struct ApproximateTangent {
    solvers: ModeSolvers,
    /// Modulus of the largest eigenvalue of the response.
    response_size: f64,
    /// Integrals of the basis up to the middle of the step, or to its end if the rule evaluates the middle itself,
    /// `[k]`.
    integrals: Vec<f64>,
    rule: Rule,
    assembly: Assembly,
    /// K without viscosities, if the solvers take them apart.
    elastic: Option<ElasticStiffness>,
    /// Rotation from the body of K to the body in the middle of the step.
    orientation: Mat3<f64>,
    /// Rotation vector of the step.
    rotation: [f64; 3],
    /// The parts that turn: the components, or the body.
    turning: Vec<Turning>,
    /// Whether there are several components, whose rotations are fitted.
    has_components: bool,
    /// Number of the part of each node; empty without couplings.
    part_of: Vec<u32>,
    /// Whether the solvers have couplings.
    has_couplings: bool,
    /// Memory for the spins of a part.
    spins: Vec<[f64; 3]>,
    /// Memory for stages.
    turned: Vec<f64>,
    /// The time s of the stage equations in the present solvers.
    time_scale_of_factors: Option<f64>,
    /// Factor on viscosities in K.
    viscous_rate: f64,
    /// Factor on the elasticity at rest, of a dissipative scheme.
    dissipation: f64,
    /// Displacement of K.
    displacement: Vec<f64>,
    rates: Vec<f64>,
    /// Positions of K.
    positions: Vec<f64>,
    /// `sum_m |K_lm|` of each row l.
    row_sums: Vec<f64>,
    /// Pressures of K, `[function]`.
    local: Vec<f64>,
    /// Stage forces of local unknowns.
    local_force: Vec<f64>,
    /// Part of M + s^2 K that is not the stiffness of the projected volumes, by traces.
    soft_part: f64,
}

impl ApproximateTangent {
    /// Allocates memory; solvers are created with the first stiffness.
    ///
    /// # Errors
    /// [`crate::Error::Linear`].
    pub(crate) fn new(body: &Body, coefficients: &StageCoefficients, solver: Solver) -> Result<Self> {
        let n = body.n_dofs();
        let nodes = coefficients.rule.nodes();
        let (rule, until) = if coefficients.rule.is_energy_momentum() && nodes.len() == 1 {
            (Rule::straining_rates(), 1.0)
        } else {
            (Rule::standard(1, &gauss(1)), 0.5)
        };
        let solvers = ModeSolvers::new(body, coefficients, solver)?;
        let elastic = separated(body, nodes.len()).then(ElasticStiffness::default);
        let components = body.turning_components();
        let turning = Turning::all(nodes.len(), body, &components);
        let mut part_of = if body.has_couplings() { vec![u32::MAX; n / 3] } else { Vec::new() };
        if !part_of.is_empty() {
            let parts = (0..).zip(&turning);
            parts.for_each(|(number, part)| part.nodes().for_each(|node| part_of[node] = number));
        }
        Ok(ApproximateTangent {
            // m^-1 w is the square of w.
            response_size: solvers.largest_modulus().sqrt(),
            solvers,
            viscous_rate: 0.0,
            dissipation: coefficients.scheme_excess(),
            integrals: (0..nodes.len()).map(|j| lagrange_integral(nodes, j, until)).collect(),
            assembly: body.assembly_to_keep(&rule),
            elastic,
            rule,
            orientation: IDENTITY,
            rotation: [0.0; 3],
            turning,
            has_components: !components.is_empty(),
            part_of,
            has_couplings: false,
            spins: vec![[0.0; 3]; nodes.len()],
            turned: vec![0.0; n * nodes.len()],
            time_scale_of_factors: None,
            displacement: vec![0.0; n],
            rates: vec![0.0; n],
            positions: vec![0.0; body.mesh().n_dofs()],
            row_sums: vec![0.0; n],
            local: vec![0.0; body.n_local()],
            soft_part: 1.0,
            local_force: vec![0.0; if body.n_local() > 0 { n * nodes.len() } else { 0 }],
        })
    }

    /// Whether there is a stiffness.
    pub(crate) fn is_factorised(&self) -> bool {
        self.time_scale_of_factors.is_some()
    }

    /// Takes the stiffness in the middle of a step from a displacement with rates x and local unknowns,
    /// `[function][n]`; at its start, if the middle is inverted. The local unknowns of K are means over the step: those
    /// of a predicted configuration would contain the error of the prediction times the bulk modulus.
    ///
    /// # Errors
    /// [`crate::Error::Inverted`], [`crate::Error::Linear`].
    pub(crate) fn refactorize(
        &mut self,
        (body, rule): (&Body, &Rule),
        displacement: &[f64],
        rates: &[f64],
        local: &[f64],
        time_scale: f64,
    ) -> Result<()> {
        self.time_scale_of_factors = None;
        self.orientation = IDENTITY;
        if let ([part], false) = (&mut self.turning[..], self.has_components) {
            part.orient(rotations(rule, &self.rotation, &IDENTITY));
        }
        self.set_midpoint(displacement, rates);
        set_means(local, &mut self.local);
        // With the size of w, viscosities have the same weight as in the stage equations.
        self.viscous_rate = 0.5 / (time_scale * self.response_size);
        if self.assemble(body).is_err() {
            self.displacement.copy_from_slice(displacement);
            self.rates.fill(0.0);
            self.assemble(body)?;
        }
        self.sum_rows(body);
        self.set(body, time_scale)?;
        self.turn_parts((body, rule), displacement, rates);
        Ok(())
    }

    /// Keeps the data that the next steps depend on. The stiffness itself follows from displacement and rates.
    pub(crate) fn save(&self, memory: &mut Memory) {
        memory.save_nodal("tangent.displacement", &self.displacement);
        memory.save_nodal("tangent.rates", &self.rates);
        memory.save_local("tangent.pressures", &self.local);
        memory.save_number("tangent.viscous_rate", self.viscous_rate);
        memory.save("tangent.orientation", self.orientation.as_flattened());
        memory.save("tangent.rotation", &self.rotation);
        memory.save_option("tangent.made_for", self.time_scale_of_factors);
        self.solvers.save(memory);
    }

    /// Restores the data of [`ApproximateTangent::save`], and computes stiffness and factors again.
    ///
    /// # Errors
    /// [`crate::Error::Memory`], [`crate::Error::Inverted`], [`crate::Error::Linear`].
    pub(crate) fn restore(&mut self, body: &Body, memory: &Memory) -> Result<()> {
        memory.fill("tangent.displacement", &mut self.displacement)?;
        memory.fill("tangent.rates", &mut self.rates)?;
        memory.fill("tangent.pressures", &mut self.local)?;
        self.viscous_rate = memory.number("tangent.viscous_rate")?;
        memory.fill("tangent.orientation", self.orientation.as_flattened_mut())?;
        self.rotation = memory.array("tangent.rotation")?;
        self.time_scale_of_factors = None;
        self.solvers.restore(body, memory)?;
        if let Some(time_scale) = memory.option("tangent.made_for")? {
            self.assemble(body)?;
            self.sum_rows(body);
            self.set(body, time_scale)?;
        }
        Ok(())
    }

    /// Sets displacement and rates at which the rule of K evaluates the middle of the step.
    fn set_midpoint(&mut self, displacement: &[f64], rates: &[f64]) {
        let n = displacement.len();
        self.displacement.copy_from_slice(displacement);
        self.rates.fill(0.0);
        let sum = if self.rule.is_energy_momentum() { &mut self.rates } else { &mut self.displacement };
        for (rates, integral) in rates.chunks_exact(n).zip(&self.integrals) {
            sum.iter_mut().zip(rates).for_each(|(sum, x)| *sum += integral * x);
        }
    }

    /// Advances to the next step, in which a body of one component rotates by a rotation vector: `M + lambda K` rotates
    /// with it, so that K stays accurate in any rotation. Returns whether `P^-1` changes.
    pub(crate) fn turn(&mut self, step: &RigidStep, rule: &Rule) -> bool {
        let [part] = &mut self.turning[..] else { return false };
        if self.has_components {
            return false;
        }
        let changes = [self.rotation, step.rotation] != [[0.0; 3]; 2];
        for half in [&self.rotation, &step.rotation] {
            self.orientation = product(&exp(&half.map(|w| 0.5 * w)), &self.orientation);
        }
        self.rotation = step.rotation;
        part.orient(rotations(rule, &step.rotation, &self.orientation));
        part.set_spins(rule, &step.spins);
        changes
    }

    /// Turns the components with the rates of a step from a displacement. Returns whether `P^-1` changes.
    pub(crate) fn turn_parts(&mut self, body: (&Body, &Rule), displacement: &[f64], rates: &[f64]) -> bool {
        if !self.has_components || !self.is_factorised() {
            return false;
        }
        let ApproximateTangent { turning, positions, spins, .. } = self;
        for part in &mut *turning {
            part.fit(body, positions, (displacement, rates), spins);
            // Between joints, even a small turn matters.
            if body.0.constraints().is_empty() {
                part.settle();
            }
        }
        !self.turning.is_empty()
    }

    /// The solver, once there is one.
    pub(crate) fn choice(&self) -> Option<SolverChoice> {
        self.solvers.choice()
    }

    /// Sets the solvers to a time s, with the present stiffness. Returns whether they change.
    ///
    /// # Errors
    /// [`crate::Error::Linear`].
    pub(crate) fn rescale(&mut self, body: &Body, time_scale: f64) -> Result<bool> {
        if self.time_scale_of_factors.is_some_and(|own| (own - time_scale).abs() <= SAME_SCALE * time_scale) {
            return Ok(false);
        }
        self.set(body, time_scale).map(|()| true)
    }

    fn assemble(&mut self, body: &Body) -> Result<()> {
        if let Some(elastic) = &mut self.elastic {
            elastic.invalidate();
        }
        let factor = self.rate_factor(body);
        let undamped = undamped(&self.rule, &self.displacement, &self.rates, &self.local);
        let step = StepInput {
            tangent_factor: factor,
            damping: StepDamping { inverse_step_size: self.viscous_rate, dissipation: 0.0 },
            ..undamped
        };
        body.assemble(&step, Request::Tangent, &[0.0], &mut self.assembly)
    }

    /// Factor on derivatives by a rate in K: dP/dF' is half of dP/dF in the middle; with viscosities it is
    /// `K (1 + 2 rate t_v)/2`, if the modes contain them.
    fn rate_factor(&self, body: &Body) -> f64 {
        2.0 / (1.0 + 2.0 * self.viscous_rate * body.viscous_time())
    }

    fn set(&mut self, body: &Body, time_scale: f64) -> Result<()> {
        self.time_scale_of_factors = None;
        self.set_soft_part(body, time_scale);
        self.set_positions(body);
        let stiffness = Stiffness {
            matrix: &self.assembly.matrix,
            viscous_rate: self.viscous_rate,
            elastic: self.elastic.as_mut(),
            undamped: &undamped(&self.rule, &self.displacement, &self.rates, &self.local),
            positions: &self.positions,
            soft_part: self.soft_part,
        };
        self.solvers.set(body, stiffness, time_scale)?;
        self.time_scale_of_factors = Some(time_scale);
        Ok(())
    }

    /// Sets the positions at which the rule of K evaluates the forces.
    fn set_positions(&mut self, body: &Body) {
        let points = body.mesh().points().as_flattened();
        let moved = self.displacement.iter().zip(&self.rates).map(|(u, x)| u + 0.5 * x);
        self.positions.iter_mut().zip(points).zip(moved).for_each(|((own, X), u)| *own = X + u);
    }

    fn set_soft_part(&mut self, body: &Body, time_scale: f64) {
        if !body.has_local() {
            return;
        }
        let diagonal = |node: usize| body.pattern().position(node, node).map_or(0, |position| position);
        let of_node = |node: usize| [0, 4, 8].map(|at| self.assembly.matrix.block(diagonal(node))[at]);
        let stiffness: f64 = body.space.counted_nodes().flat_map(of_node).sum();
        let mass = 3.0 * body.total_lumped_mass();
        let mut traces = [stiffness, self.rate_factor(body) * body.local_stiffness(&self.assembly)];
        body.space.sum_ranks("traces of stiffnesses", &mut traces);
        let [stiffness, volumes] = traces;
        let square = time_scale * time_scale * self.response_size;
        self.soft_part = (mass + square * (stiffness - volumes).max(0.0)) / (mass + square * stiffness);
    }

    /// Part of M + s^2 K that is not the stiffness of the projected volumes. A pressure error moves the body,
    /// and changes the energy, by this fraction of an equal force error.
    pub(crate) fn soft_part(&self) -> f64 {
        self.soft_part
    }

    /// Cost of a new stiffness, in corrections with the old one.
    pub(crate) fn refactorization_cost(&self) -> f64 {
        self.solvers.refactorization_cost()
    }

    /// Whether [`ApproximateTangent::couple`] works. The flexibility of constraints would have to follow the couplings.
    pub(crate) fn takes_couplings(&self, body: &Body) -> bool {
        self.is_factorised() && body.constraints().is_empty() && self.solvers.takes_couplings()
    }

    /// Adds the symmetric part of the couplings of a stage matrix, in the place of earlier ones.
    pub(crate) fn couple(&mut self, couplings: &Couplings) {
        self.has_couplings = !couplings.is_empty();
        let ApproximateTangent { solvers, turning, part_of, .. } = self;
        let part = |node: usize| turning.get(*part_of.get(node)? as usize);
        solvers.couple(couplings, &|node| part(node).map_or(IDENTITY, |part| *part.rotation()));
    }

    /// Solves the linearised stage equations to a relative tolerance. Returns the number of iterations, `None` if a
    /// solver missed the tolerance.
    ///
    /// `r`: negative residual, `[k][n_nodes][3]`, and on input the local unknowns of the rates less those of the step;
    /// `z`: corrections of the rates and of these local unknowns.
    pub(crate) fn solve(
        &mut self,
        (body, rule): (&Body, &Rule),
        r: &[f64],
        (z, local): (&mut [f64], &mut [f64]),
        tolerance: f64,
    ) -> Option<usize> {
        self.turn_back(r);
        z.fill(0.0);
        if let Some(s) = self.time_scale_of_factors.filter(|_| !local.is_empty()) {
            body.add_reused_local_force(rule, &self.assembly, -s * s, local, &mut self.turned);
            // Supports do not move under a change of local unknowns.
            body.space.clear_inactive(&mut self.turned);
        }
        let iterations = self.solve_turned(body, z, tolerance);
        let damping = ReusedDamping {
            viscous_rate: self.viscous_rate,
            inverse_time: self.time_scale_of_factors.map_or(0.0, f64::recip),
            dissipative: self.dissipation,
        };
        body.add_reused_local_response(rule, &self.assembly, &damping, z, local);
        self.turn_forward(z);
        iterations
    }

    /// Solves for stage forces in the orientation of K.
    pub(crate) fn solve_unturned(
        &mut self,
        body: &Body,
        r: &[f64],
        z: &mut [f64],
        tolerance: f64,
    ) -> Option<usize> {
        self.turned.copy_from_slice(r);
        self.solve_turned(body, z, tolerance)
    }

    /// Solves for the forces in `turned`, without turning forward.
    fn solve_turned(&mut self, body: &Body, z: &mut [f64], tolerance: f64) -> Option<usize> {
        let iterations = self.solvers.solve(&self.turned, z, tolerance);
        body.space.follow(z);
        // With couplings, it is these that may be indefinite.
        if iterations.is_none() && !self.has_couplings {
            self.solvers.fall_back(body.space.is_shared());
            self.time_scale_of_factors = None;
        }
        iterations
    }

    /// Turns a table of the displacements of some nodes under unit forces on them, `[k][nodes][3]` in both directions,
    /// from the orientation of K to that of the step; `memory`: for as many numbers.
    pub(crate) fn turn_table(&self, nodes: &[u32], table: &mut [f64], memory: &mut [f64]) {
        turn_table(&self.turning, !self.solvers.is_of_mass(), nodes, (table, memory));
    }

    /// Adds the stage forces of local unknowns in the present orientation, times the square of the time scale, with the
    /// forces of unit local unknowns in K.
    pub(crate) fn add_local_force(&mut self, (body, rule): (&Body, &Rule), local: &[f64], r: &mut [f64]) {
        let Some(s) = self.time_scale_of_factors.filter(|_| !local.is_empty()) else { return };
        let mut force = std::mem::take(&mut self.local_force);
        force.fill(0.0);
        body.add_reused_local_force(rule, &self.assembly, s * s, local, &mut force);
        self.turning.iter().for_each(|part| part.turn_forward(&mut force));
        r.iter_mut().zip(&force).for_each(|(r, force)| *r += force);
        self.local_force = force;
    }

    /// `z = P^-1 r`, a linear map that approximates the inverse of the linearised stage equations.
    pub(crate) fn precondition(&mut self, r: &[f64], z: &mut [f64]) {
        self.turn_back(r);
        z.fill(0.0);
        self.solvers.precondition(&self.turned, z);
        self.turn_forward(z);
    }

    /// Sets `turned` to the stages, rotated back to the orientation of K.
    fn turn_back(&mut self, stages: &[f64]) {
        self.turned.copy_from_slice(stages);
        self.turning.iter().for_each(|part| part.turn_back(&mut self.turned));
    }

    /// Turns stages forward from the orientation of K.
    fn turn_forward(&mut self, stages: &mut [f64]) {
        self.turning.iter().for_each(|part| part.turn_forward(stages));
        // Where the mass dominates, the change of basis would harm the mass terms more than it helps K.
        if self.solvers.is_of_mass() || !self.turning.iter().any(Turning::is_spinning) {
            return;
        }
        self.turned.copy_from_slice(stages);
        for part in self.turning.iter().filter(|part| part.is_spinning()) {
            part.unstrain(&self.turned, stages);
        }
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

    /// Norm of `|s^2 K| |u|` over the free degrees of freedom, with similar u at neighbours; the rounding of the forces
    /// is eps times this.
    pub(crate) fn rounding_size(
        &self,
        body: &Body,
        displacement: &[f64],
        rates: &[f64],
        time_scale: f64,
    ) -> f64 {
        let square = |dof: usize| match body.space.inactive()[dof] {
            true => 0.0,
            false => (self.row_sums[dof] * (displacement[dof].abs() + rates[dof].abs())).powi(2),
        };
        let mut sum = [body.space.counted_dofs().map(square).sum::<f64>()];
        body.space.sum_ranks("squares of the rounding", &mut sum);
        time_scale * time_scale * sum[0].sqrt()
    }

    /// Strain energy of displacements with rounding errors, `(eps/2)^2 |u| . |K| |u| / 2` \[energy\].
    pub(crate) fn rounding_energy(&self, body: &Body, displacement: &[f64], rates: &[f64]) -> f64 {
        let term = |dof: usize| self.row_sums[dof] * (displacement[dof].abs() + rates[dof].abs()).powi(2);
        let mut sum = [body.space.counted_dofs().map(term).sum::<f64>()];
        body.space.sum_ranks("energy of the rounding", &mut sum);
        0.125 * f64::EPSILON * f64::EPSILON * sum[0]
    }
}

/// The step without viscosities at which K is taken: dP/dF' is half of dP/dF.
fn undamped<'a>(
    rule: &'a Rule,
    displacement: &'a [f64],
    rates: &'a [f64],
    local: &'a [f64],
) -> StepInput<'a> {
    StepInput {
        tangent_factor: 2.0,
        local: (!local.is_empty()).then_some(local),
        ..StepInput::undamped(rule, displacement, rates)
    }
}

/// Sets the mean pressure of each function; `local: [function][n]`.
fn set_means(local: &[f64], means: &mut [f64]) {
    let n = local.len().checked_div(means.len()).unwrap_or(1);
    for (mean, of_function) in means.iter_mut().zip(local.chunks_exact(n)) {
        *mean = of_function.iter().sum::<f64>() / n as f64;
    }
}

/// Times s that differ by less are equal: the halves of an interval differ by rounding.
const SAME_SCALE: f64 = 1e-9;

/// Rotations from the configuration of K to the Gauss points of a step with a rotation vector, given the one to its
/// middle.
fn rotations<'r>(
    rule: &'r Rule,
    rotation: &'r [f64; 3],
    to_middle: &'r Mat3<f64>,
) -> impl Iterator<Item = Mat3<f64>> + 'r {
    rule.nodes().iter().map(move |c| product(&exp(&rotation.map(|w| (c - 0.5) * w)), to_middle))
}
