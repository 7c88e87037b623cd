//! The equations of equilibrium, and their linear systems.

use super::inverse::{Found, Inverse};
use super::joints::Joints;
use crate::average::{Request, Rule};
use crate::body::{Body, Interface};
use crate::error::{Error, Result};
use crate::input::Span;
use crate::newton::{Sizes, System, Tangent};
use crate::nodal;
use crate::sparse::{Gmres, LinearSystem, SparseLu, StageMatrix};
use crate::time::State;
use crate::time::classic::stage_coefficients;
use crate::time::equations::Equations;

/// Iterations of GMRES before the stiffness is factorised with its follower loads.
const MAX_LINEAR_ITERATIONS: usize = 60;

/// The same for the incomplete factors of a team.
const MAX_ITERATIONS_OF_RANKS: usize = 600;

/// Rounding floor of the residual over `eps || |K| |u| ||`: rounding errors of many terms partly cancel.
const FLOOR: f64 = 0.25;

/// A correction beyond this multiple of the size of the body shows a stiffness that is singular but for rounding.
const LARGEST_CORRECTION: f64 = 1e6;

/// The equations of a step without inertia. The unknowns are the increment of the displacement, then multipliers of
/// constraints and local unknowns, `[function]`.
#[derive(Debug)]
pub(super) struct StaticSystem<'a> {
    pub(super) equations: Equations<'a>,
    /// Time at the end of the step.
    pub(super) time: f64,
    inverse: Inverse,
    gmres: Gmres,
    /// Constraints, if there are some.
    pub(super) joints: Option<Joints>,
    /// Factorisation with follower loads, where GMRES fails.
    lu: Option<SparseLu>,
    /// Whether a stiffness that is not positive definite ends the iteration.
    pub(super) must_be_definite: bool,
    /// Residual at the start of the step, under the loads at its end.
    pub(super) first: Vec<f64>,
    /// Displacement of the driven degrees of freedom in the step.
    shift: Vec<f64>,
    /// Norm of the step, linearised at its start.
    pub(super) predicted: Option<f64>,
    /// Largest extent of the mesh, or of the mechanism.
    pub(super) size: f64,
    floor: f64,
    /// Whether there is a tangent in the step.
    is_linearised: bool,
    right: Vec<f64>,
    pub(super) rest: Vec<f64>,
}

impl<'a> StaticSystem<'a> {
    pub(super) fn new(body: &'a Body) -> Result<Self> {
        let zero = vec![0.0; body.n_dofs()];
        let coefficients = stage_coefficients(Rule::at_end(), 0.0, 1.0);
        let equations = Equations::new(body, coefficients);
        Ok(StaticSystem {
            time: 0.0,
            inverse: Inverse::new(body)?,
            gmres: Gmres::default(),
            joints: Joints::new(body)?,
            lu: None,
            must_be_definite: true,
            first: vec![0.0; equations.blocks.len()],
            equations,
            shift: zero.clone(),
            predicted: None,
            size: size(body),
            floor: 0.0,
            is_linearised: false,
            right: zero.clone(),
            rest: zero,
        })
    }

    /// Sets the step from a state.
    ///
    /// # Errors
    /// [`Error::NotFiniteAt`].
    pub(super) fn start(&mut self, state: &State, step_size: f64) -> Result<()> {
        self.time = state.time + step_size;
        self.equations.start(&state.displacement, 1.0);
        self.equations.begin(Span::new(state.time, step_size), state).map(|_| ())
    }

    /// First unknowns of a step that starts in equilibrium: with moving supports, the solution of the equations
    /// linearised there.
    pub(super) fn predict(&mut self, unknowns: &mut [f64]) -> Result<()> {
        (self.floor, self.predicted, self.is_linearised) = (0.0, None, false);
        let body = self.equations.body;
        let [x, multipliers, local] = self.equations.blocks.split_mut(unknowns);
        x.fill(0.0);
        if let Some(joints) = &self.joints {
            multipliers.copy_from_slice(&joints.multipliers);
        }
        self.equations.set_local_at_start(local)?;
        let mut first = std::mem::take(&mut self.first);
        let outcome = self.residual(unknowns, &mut first);
        self.first = first;
        outcome?;
        if !body.is_driven() {
            return Ok(());
        }
        self.equations.drive(&mut self.shift);
        self.factorize(unknowns)?;
        let [x, _, local] = self.equations.blocks.split_mut(unknowns);
        let step = self.linear_step(x)?;
        self.predicted = Some(body.space.norm(&step));
        x.copy_from_slice(&step);
        self.add_local_response(x, local);
        // Exactly there, not but for rounding.
        self.equations.drive(x);
        Ok(())
    }

    /// Sets the right side of a correction: the negative residual, without the local unknowns after the first tangent.
    fn condense(&mut self, residual: &[f64], of_local: &[f64]) {
        self.right.iter_mut().zip(residual).for_each(|(b, r)| *b = -r);
        if self.is_linearised {
            let Equations { body, coefficients, assembly, .. } = &self.equations;
            body.add_local_force(&coefficients.rule, assembly, 1.0, of_local, &mut self.right);
            body.space.clear_inactive(&mut self.right);
        }
    }

    /// Adds the changes of the local unknowns with a change of the displacement.
    fn add_local_response(&self, change: &[f64], local: &mut [f64]) {
        let Equations { body, coefficients, assembly, .. } = &self.equations;
        body.add_local_response(&coefficients.rule, assembly, change, local);
    }

    /// The step from the start that the equations give, linearised with the tangent that was set last, near x.
    pub(super) fn linear_step(&mut self, x: &[f64]) -> Result<Vec<f64>> {
        let body = self.equations.body;
        let mut residual = self.rest.clone();
        self.multiply(&self.shift.clone(), &mut residual);
        residual.iter_mut().zip(&self.first).for_each(|(r, first)| *r += first);
        let mut step = self.rest.clone();
        self.right.iter_mut().zip(&residual).for_each(|(b, r)| *b = -r);
        let shifted = self.displacement(&self.shift);
        self.solve_beside(x, &shifted, PREDICTION, &mut step)?;
        body.space.complete("linear step", &mut step);
        step.iter_mut().zip(&self.shift).for_each(|(step, shift)| *step += shift);
        Ok(step)
    }

    /// Sets the exact tangent, and factorises it without the follower loads.
    fn factorize(&mut self, unknowns: &[f64]) -> Result<()> {
        self.equations.assemble(unknowns, Request::Tangent)?;
        self.is_linearised = true;
        let body = self.equations.body;
        self.lu = None;
        let is_definite = self.factorize_matrix(unknowns, false)?;
        if !is_definite && self.must_be_definite {
            return Err(not_definite());
        }
        let [x, ..] = self.equations.blocks.split(unknowns);
        let displacement = self.displacement(x);
        let matrix = &self.equations.assembly.matrix;
        self.floor = FLOOR * f64::EPSILON * absolute_product(body, matrix, &displacement);
        self.floor += FLOOR * f64::EPSILON * self.square_of_constraints(&[body.constraints().size()]).sqrt();
        self.equations.add_external_tangent(x)
    }

    /// Factorises the matrix as it is, beside the constraints. Returns whether it is positive definite.
    fn factorize_matrix(&mut self, unknowns: &[f64], is_softened: bool) -> Result<bool> {
        let body = self.equations.body;
        let [x, multipliers, _] = self.equations.blocks.split(unknowns);
        let displacement = self.displacement(x);
        let matrix = &self.equations.assembly.matrix;
        match &mut self.joints {
            None => self.inverse.set(body, matrix),
            Some(joints) => {
                let at = (&displacement[..], self.time);
                joints.factorize((body, matrix), at, (multipliers, is_softened), &mut self.inverse)
            }
        }
    }

    /// Whether the symmetric stiffness with follower loads is positive definite; not known on a team.
    pub(super) fn is_definite_under_loads(&mut self, unknowns: &[f64]) -> Result<bool> {
        self.equations.assemble_tangent(unknowns)?;
        self.factorize_matrix(unknowns, true)
    }

    /// The displacement at the end of the step.
    pub(super) fn displacement(&self, x: &[f64]) -> Vec<f64> {
        self.equations.displacement.iter().zip(x).map(|(u, x)| u + x).collect()
    }

    /// The product of the tangent that was set last with a change of the displacement.
    fn multiply(&mut self, change: &[f64], product: &mut [f64]) {
        let body = self.equations.body;
        self.equations.assembly.matrix.multiply(body.pattern(), change, product);
        if let Some(interface) = self.joints.as_ref().and_then(Joints::interface) {
            interface.add_product(change, product);
        }
        body.space.clear_inactive(product);
    }

    /// Square of the residual of the displacement that would mend the residuals of constraints.
    fn square_of_constraints(&self, of_constraints: &[f64]) -> f64 {
        let stiffness = self.joints.as_ref().map_or(0.0, Joints::mean_stiffness);
        stiffness.powi(2) * of_constraints.iter().map(|c| c * c).sum::<f64>()
    }

    /// Solves as [`StaticSystem::solve`], so that the constraints hold to first order after the change from a
    /// displacement. Returns the iterations and the changes of the multipliers.
    ///
    /// # Errors
    /// As [`StaticSystem::solve`].
    fn solve_beside(
        &mut self,
        x: &[f64],
        displacement: &[f64],
        tolerance: f64,
        dx: &mut [f64],
    ) -> Result<(usize, Vec<f64>)> {
        let body = self.equations.body;
        let Some(interface) = self.joints.as_ref().and_then(Joints::interface) else {
            return Ok((self.solve(x, tolerance, dx)?, Vec::new()));
        };
        let dependent: Vec<usize> = interface.constraints.dependent().collect();
        let values = interface.constraints.values(body.constraints(), displacement);
        // Any change that closes the constraints, and an allowed one beside it.
        let mut closing = self.rest.clone();
        dependent.iter().zip(&values).for_each(|(&dof, value)| closing[dof] = -value);
        let right = self.right.clone();
        let mut product = self.rest.clone();
        self.multiply(&closing, &mut product);
        self.right.iter_mut().zip(&product).for_each(|(b, y)| *b -= y);
        if let Some(interface) = self.joints.as_ref().and_then(Joints::interface) {
            interface.constraints.gather(&mut self.right);
        }
        let iterations = self.solve(x, tolerance, dx)?;
        dx.iter_mut().zip(&closing).for_each(|(dx, closing)| *dx += closing);
        self.multiply(dx, &mut product);
        let of_sums: Vec<f64> = dependent.iter().map(|&dof| right[dof] - product[dof]).collect();
        self.right.copy_from_slice(&right);
        let interface = self.joints.as_mut().and_then(Joints::interface_mut);
        let changes = interface.map(|interface| interface.constraints.multipliers(&of_sums));
        Ok((iterations, changes.unwrap_or_default()))
    }

    /// Solves `K dx = b` for the right side with the tangent that was set last.
    ///
    /// # Errors
    /// [`Error::Singular`], [`Error::Linear`], [`Error::OutOfMemory`].
    fn solve(&mut self, x: &[f64], tolerance: f64, dx: &mut [f64]) -> Result<usize> {
        let body = self.equations.body;
        let mut iterations = self.iterate(tolerance, dx)?;
        let has_lu = self.joints.is_none() && !body.space.is_shared();
        if iterations.is_none() && self.lu.is_none() && has_lu {
            let lu = SparseLu::new(&self.equations.assembly.matrix, body.pattern(), body.fixed());
            self.lu = Some(lu.map_err(|_| self.singular(x, dx))?);
            iterations = self.iterate(tolerance, dx)?;
        }
        let mut size = [dx.iter().map(|dx| dx.abs()).fold(0.0, f64::max)];
        body.space.largest_of_ranks("largest correction", &mut size);
        let iterations = iterations.filter(|_| size[0] <= LARGEST_CORRECTION * self.size);
        iterations.ok_or_else(|| self.singular(x, dx))
    }

    /// Solves with GMRES, on a team without follower loads with conjugate gradients as long as the stiffness is
    /// positive; `None` if it misses the tolerance.
    ///
    /// # Errors
    /// [`Error::Linear`] if the stiffness must be positive definite and is not.
    fn iterate(&mut self, tolerance: f64, dx: &mut [f64]) -> Result<Option<usize>> {
        let body = self.equations.body;
        let matrix = &mut self.equations.assembly.matrix;
        let mut limit = MAX_LINEAR_ITERATIONS;
        if let Inverse::OfRanks(inverse) = &mut self.inverse {
            limit = MAX_ITERATIONS_OF_RANKS;
            if body.is_symmetric() {
                match inverse.solve(body, matrix, &self.right, dx, tolerance) {
                    Found::Solution(iterations) => return Ok(Some(iterations)),
                    Found::NotDefinite if self.must_be_definite => return Err(not_definite()),
                    Found::NotDefinite | Found::Nothing => {}
                }
            }
        }
        let interface = self.joints.as_ref().and_then(Joints::interface);
        let (inverse, lu) = (&mut self.inverse, self.lu.as_ref());
        let mut system = Linearised { body, matrix, inverse, lu, interface };
        let solution = self.gmres.solve(&mut system, &self.right, dx, tolerance, limit);
        let mut faults = [dx.iter().filter(|dx| !dx.is_finite()).count() as f64];
        body.space.largest_of_ranks("corrections that are not finite", &mut faults);
        let is_solved = solution.relative_residual <= tolerance && faults == [0.0];
        Ok(is_solved.then_some(solution.iterations))
    }

    /// The error of a singular stiffness, at a node without any, or else at the one that moves most.
    fn singular(&self, x: &[f64], dx: &[f64]) -> Error {
        let body = self.equations.body;
        let stiffness = |dof: usize| {
            let diagonal = body.pattern().position(dof / 3, dof / 3).unwrap_or(0);
            self.equations.assembly.matrix.block(diagonal)[4 * (dof % 3)].abs()
        };
        let free = || (0..3 * body.space.own_nodes().end).filter(|&dof| !body.fixed()[dof]);
        let mut largest = [free().map(stiffness).fold(0.0, f64::max)];
        body.space.largest_of_ranks("largest stiffness", &mut largest);
        let has_own = |dof: &usize| !body.mechanism.is_rigid(dof / 3);
        let without = free()
            .filter(has_own)
            .find(|&dof| stiffness(dof) <= f64::EPSILON * largest[0])
            .map(|dof| dof / 3);
        let node = body.space.lowest_node(without).unwrap_or_else(|| largest_node(body, dx));
        let position = |node: usize| body.space.position(&self.displacement(x), node);
        Error::Singular { fraction: self.time, node, position: body.space.at_node(node, position) }
    }
}

/// Largest extent of a body, with the places of its joints; infinite for a single point, from which nothing is far.
fn size(body: &Body) -> f64 {
    let extent = body.mesh().extent().into_iter().fold(0.0, f64::max);
    let size = if body.mechanism.is_empty() { extent } else { extent.max(body.constraints().size()) };
    if size > 0.0 { size } else { f64::INFINITY }
}

fn not_definite() -> Error {
    Error::Linear { reason: "the stiffness is not positive definite".into() }
}

/// Relative tolerance of the linear system of a prediction.
const PREDICTION: f64 = 1e-6;

impl System for StaticSystem<'_> {
    fn residual(&mut self, unknowns: &[f64], residual: &mut [f64]) -> Result<Sizes> {
        self.equations.full_residual(unknowns, residual)?;
        let [residual, of_constraints, of_local] = self.equations.blocks.split_mut(residual);
        let Equations { body, force: internal, .. } = &self.equations;
        // Reactions count: a body that its supports alone strain is in balance with nothing else.
        self.right.iter_mut().enumerate().for_each(|(at, load)| *load = self.equations.load(at));
        let scale = body.space.norm(&self.right).max(body.space.norm(internal));
        body.space.clear_inactive(residual);
        self.condense(residual, of_local);
        let norm = self.equations.body.space.norm(&self.right);
        let residual = norm.hypot(self.square_of_constraints(of_constraints).sqrt());
        Ok(Sizes { residual, scale, floor: self.floor })
    }

    fn correction(
        &mut self,
        x: &[f64],
        residual: &[f64],
        tolerance: f64,
        tangent: Tangent,
        dx: &mut [f64],
    ) -> Result<usize> {
        if tangent != Tangent::LastExact {
            self.factorize(x)?;
        }
        let blocks = self.equations.blocks;
        let [of_displacement, _, of_local] = blocks.split(residual);
        self.condense(of_displacement, of_local);
        let [dx, of_multipliers, change] = blocks.split_mut(dx);
        let displacement = self.displacement(blocks.split(x)[0]);
        let (iterations, changes) = self.solve_beside(x, &displacement, tolerance, dx)?;
        of_multipliers.copy_from_slice(&changes);
        let body = self.equations.body;
        body.space.complete("correction", dx);
        change.iter_mut().zip(of_local).for_each(|(change, r)| *change = -r);
        self.add_local_response(dx, change);
        self.predicted.get_or_insert_with(|| body.space.norm(dx));
        Ok(iterations)
    }

    fn refactorization_cost(&self) -> f64 {
        self.inverse.cost()
    }
}

/// The linearised equations, preconditioned by the factorised stiffness without follower loads, or else solved by the
/// factorisation with them.
struct Linearised<'a> {
    body: &'a Body,
    matrix: &'a mut StageMatrix,
    inverse: &'a mut Inverse,
    lu: Option<&'a SparseLu>,
    interface: Option<&'a Interface>,
}

impl LinearSystem for Linearised<'_> {
    fn product(&mut self, x: &[f64], y: &mut [f64]) {
        self.matrix.multiply(self.body.pattern(), x, y);
        if let Some(interface) = self.interface {
            interface.add_product(x, y);
            interface.constraints.gather(y);
        }
        self.body.space.clear_inactive(y);
    }

    fn precondition(&mut self, x: &[f64], y: &mut [f64]) {
        // Only a lack of memory makes the solution fail: the unknowns are then left as they are, and GMRES fails.
        if let Some(lu) = self.lu
            && lu.solve(x, y).is_ok()
        {
            return;
        }
        y.copy_from_slice(x);
        self.body.space.clear_inactive(y);
        self.inverse.apply(self.body, y);
        if let Some(interface) = self.interface {
            interface.correct(self.body, |b| self.inverse.apply(self.body, b), y);
        }
    }

    fn dot(&self, x: &[f64], y: &[f64]) -> f64 {
        self.body.space.dot(x, y)
    }
}

/// Norm of `|K| |u|` on the free degrees of freedom.
fn absolute_product(body: &Body, matrix: &StageMatrix, displacement: &[f64]) -> f64 {
    let pattern = body.pattern();
    let mut square = 0.0;
    for node in body.space.counted_nodes() {
        let mut sum = [0.0; 3];
        for (position, &column) in pattern.range(node).zip(pattern.row(node)) {
            let u = &displacement[3 * column as usize..][..3];
            for (i, row) in matrix.block(position).chunks_exact(3).enumerate() {
                sum[i] += row.iter().zip(u).map(|(k, u)| (k * u).abs()).sum::<f64>();
            }
        }
        let free = (0..3).filter(|i| !nodal::at(body.fixed(), node)[*i]);
        square += free.map(|i| sum[i] * sum[i]).sum::<f64>();
    }
    let mut square = [square];
    body.space.sum_ranks("squares of the rounding", &mut square);
    square[0].sqrt()
}

/// Node with the largest vector, `[n_nodes][3]`; NaN exceeds every number.
pub(super) fn largest_node(body: &Body, vectors: &[f64]) -> usize {
    let squares = vectors.chunks_exact(3).map(|v| v.iter().map(|v| v * v).sum::<f64>().abs());
    let own = squares.take(body.space.own_nodes().end).enumerate().max_by(|(_, a), (_, b)| a.total_cmp(b));
    let (node, size) = own.unwrap_or_default();
    let mut most = [size];
    body.space.largest_of_ranks("largest vector", &mut most);
    body.space.lowest_node((size == most[0] || size.is_nan()).then_some(node)).unwrap_or(0)
}
