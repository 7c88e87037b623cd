//! The constraints of a body, and their part in the equations of a step.

use super::constraint::Constraint;
use crate::force::StepInput;
use crate::nodal;

/// The constraints of a body, with the nodes that they join.
#[derive(Debug, Default)]
pub(crate) struct Constraints {
    rows: Vec<Constraint>,
    /// Nodes of the constraints, ascending.
    nodes: Vec<u32>,
    /// |G|^2 of each constraint in the reference configuration.
    squares: Vec<f64>,
    is_grounded: bool,
}

/// Derivatives of the equations of a step by the rates of the joint nodes, `n = 3 k n_nodes` of them, and by the
/// multipliers, m of them; dense, row by row.
#[derive(Debug, Default)]
pub(crate) struct Derivatives {
    /// Of the constraints by the rates, `[m][n]`.
    pub rates: Vec<f64>,
    /// Of the forces by the multipliers, `[n][m]`.
    pub multipliers: Vec<f64>,
    /// Of the forces by the rates, at fixed multipliers, `[n][n]`.
    pub forces: Vec<f64>,
}

impl Constraints {
    /// Some constraints; `is_grounded`: whether one of them joins the body to the ground.
    pub(crate) fn new(rows: Vec<Constraint>, is_grounded: bool) -> Self {
        let mut nodes: Vec<u32> = rows.iter().flat_map(Constraint::nodes).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let squares = rows.iter().map(Constraint::square_of_gradient).collect();
        Constraints { rows, nodes, squares, is_grounded }
    }

    /// Number of constraints.
    pub(crate) fn len(&self) -> usize {
        self.rows.len()
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Whether one of them joins the body to the ground: then their forces have a resultant.
    pub(crate) fn is_grounded(&self) -> bool {
        self.is_grounded
    }

    /// Degrees of freedom of the joint nodes.
    pub(crate) fn dofs(&self) -> impl Iterator<Item = usize> {
        self.nodes.iter().flat_map(|&node| nodal::dofs(node as usize))
    }

    /// Sets the residuals `C_i = G(q_i) x_i + Phi(q_1)`, `residual: [k][n]`.
    pub(crate) fn set_residual(&self, step: &StepInput<'_>, residual: &mut [f64]) {
        let (n_dofs, n) = (step.displacement.len(), self.len());
        for (c, row) in self.rows.iter().enumerate() {
            let start = row.value(&|dof| step.displacement[dof]);
            for i in 0..step.rule.degree() {
                let rates = &step.rates[i * n_dofs..];
                residual[i * n + c] =
                    row.rate(&|dof| step.displacement_in(i, dof), &|dof| rates[dof]) + start;
            }
        }
    }

    /// Square of the rates `C_i / |G|^2 G^T` that mend the residuals.
    pub(crate) fn square_of_residual(&self, residual: &[f64]) -> f64 {
        let of_stages =
            residual.chunks_exact(self.len()).flat_map(|of_stage| of_stage.iter().zip(&self.squares));
        of_stages.map(|(residual, square)| residual * residual / square).sum()
    }

    /// Adds a multiple of the forces `G(q_i)^T Lambda_i` of a stage, `force: [n_nodes][3]`; `multipliers: [k][n]`.
    pub(crate) fn add_force(
        &self,
        step: &StepInput<'_>,
        stage: usize,
        (factor, multipliers): (f64, &[f64]),
        force: &mut [f64],
    ) {
        let of_stage = &multipliers[stage * self.len()..];
        for (row, multiplier) in self.rows.iter().zip(of_stage) {
            let add = &mut |dof: usize, value: f64| force[dof] += factor * multiplier * value;
            row.for_each_gradient(&|dof| step.displacement_in(stage, dof), add);
        }
    }

    /// Sets the derivatives at a step with multipliers.
    ///
    /// ```math
    /// dC_i/dx_j = delta_ij G(q_i) + a_ij G'(x_i),    df_i/dLambda_i = G(q_i)^T,    df_i/dx_j = a_ij Lambda_i G'
    /// ```
    pub(crate) fn set_derivatives(
        &self,
        step: &StepInput<'_>,
        multipliers: &[f64],
        derivatives: &mut Derivatives,
    ) {
        let (k, n_dofs) = (step.rule.degree(), step.displacement.len());
        let (of_stage, rows) = (3 * self.nodes.len(), self.len());
        let (n, m) = (k * of_stage, k * rows);
        let Derivatives { rates, multipliers: by_multipliers, forces } = derivatives;
        for (table, len) in [(&mut *rates, m * n), (&mut *by_multipliers, n * m), (&mut *forces, n * n)] {
            table.clear();
            table.resize(len, 0.0);
        }
        let local = |dof: usize| match self.nodes.binary_search(&((dof / 3) as u32)) {
            Ok(node) | Err(node) => nodal::dof(node, dof % 3),
        };
        let a = step.rule.coefficients();
        for (i, c) in (0..k).flat_map(|i| (0..rows).map(move |c| (i, c))) {
            let (row, at) = (&self.rows[c], i * rows + c);
            row.for_each_gradient(&|dof| step.displacement_in(i, dof), &mut |dof, value| {
                let column = i * of_stage + local(dof);
                rates[at * n + column] += value;
                by_multipliers[column * m + at] += value;
            });
            let x = &step.rates[i * n_dofs..];
            row.for_each_curvature(&mut |[node, other], value| {
                for (d, j) in (0..3).flat_map(|d| (0..k).map(move |j| (d, j))) {
                    let (own, other) = (nodal::dof(node as usize, d), nodal::dof(other as usize, d));
                    let weight = a[i * k + j] * value;
                    let column = j * of_stage + local(own);
                    rates[at * n + column] += weight * x[other];
                    forces[(i * of_stage + local(other)) * n + column] += weight * multipliers[at];
                }
            });
        }
    }
}
