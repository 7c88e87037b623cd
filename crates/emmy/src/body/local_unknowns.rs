//! Pressures of cells with a projected volume: unknowns of each cell, eliminated cell by cell.
//!
//! The stage forces are linear in the pressures pi_l. The pressures p_l that belong to a deformation are functions of
//! its rates. With the forces g_l of unit pressures, a correction of both unknowns is
//!
//! ```math
//! K_0 dx_j + g_l dpi_l = -R(x, pi),      dpi_l = p_l(x) - pi_l + W_lj dx_j
//! ```

use super::forces::Assembly;
use super::system::Body;
use crate::average::{Rule, VolumeDamping};
use crate::force::PressureCells;
use crate::sparse::reduce::dot;

/// A function of the pressure in a cell, as it was linearised last.
struct Function<'a> {
    number: usize,
    nodes: &'a [u32],
    /// `[l][n_nodes][3]`.
    forces: &'a [f64],
    /// `[l][j][n_nodes][3]`.
    responses: &'a [f64],
    viscous_time: f64,
}

/// Damping of volumes in reused derivatives.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ReusedDamping {
    /// Rate of the viscosity in these derivatives \[1/time\].
    pub viscous_rate: f64,
    /// Rate of the viscosity in the step \[1/time\].
    pub inverse_time: f64,
    /// Factor on the stiffness, of a dissipative scheme.
    pub dissipative: f64,
}

impl Body {
    /// Number of functions of the pressure in all cells; on a team, those of cells that count here come first.
    pub(crate) fn n_local(&self) -> usize {
        self.pressure_cells().map(|cells| cells.n_pressures()).sum()
    }

    /// Whether some cell, of any rank, has pressures.
    pub(crate) fn has_local(&self) -> bool {
        self.has_local
    }

    /// Number of functions of the pressure in the cells that count here.
    fn n_counted_local(&self) -> usize {
        let cells = self.counted_forces().filter_map(|force| force.pressure_cells());
        cells.map(|cells| cells.n_pressures()).sum()
    }

    pub(super) fn pressure_cells(&self) -> impl Iterator<Item = PressureCells<'_>> {
        self.forces().filter_map(|force| force.pressure_cells())
    }

    /// Copies the pressures of the deformation assembled last, `[function][l]`.
    pub(crate) fn copy_local(&self, assembly: &Assembly, pressures: &mut [f64]) {
        let mut copied = 0;
        for cells in self.pressure_cells() {
            for results in assembly.pressure_results(cells.numbers.term) {
                let own = &results.pressures;
                pressures[copied..copied + own.len()].copy_from_slice(own);
                copied += own.len();
            }
        }
    }

    /// The functions of all cells, with the tangent assembled last, which has n stages and pressures.
    fn pressure_functions<'a>(
        &'a self,
        assembly: &'a Assembly,
        n: usize,
        k: usize,
    ) -> impl Iterator<Item = Function<'a>> {
        self.pressure_cells().flat_map(move |cells| {
            let PressureCells { nodes, n_nodes, numbers, viscous_time, .. } = cells;
            let size = 3 * n_nodes * n;
            let results = assembly.pressure_results(numbers.term).zip(&numbers.saved);
            results.flat_map(move |(results, saved)| {
                let tables = results.forces.chunks_exact(size).zip(results.responses.chunks_exact(size * k));
                tables.enumerate().map(move |(index, (forces, responses))| {
                    let cell = saved.start + index / numbers.n_functions;
                    let number = numbers.first + saved.start * numbers.n_functions + index;
                    Function {
                        number,
                        nodes: &nodes[cell * n_nodes..(cell + 1) * n_nodes],
                        forces,
                        responses,
                        viscous_time,
                    }
                })
            })
        })
    }

    /// Adds the stage forces of pressures, with the exact tangent assembled last; `pressures: [function][l]`,
    /// `force: [k][n_nodes][3]`.
    ///
    /// ```math
    /// f_i = factor sum_l weight_il g_l pi_l
    /// ```
    pub(crate) fn add_local_force(
        &self,
        rule: &Rule,
        assembly: &Assembly,
        factor: f64,
        pressures: &[f64],
        force: &mut [f64],
    ) {
        let n = rule.n_pressures();
        for function in self.pressure_functions(assembly, n, rule.degree()) {
            let own = &pressures[function.number * n..(function.number + 1) * n];
            let unit_forces = function.forces.chunks_exact(3 * function.nodes.len());
            for ((l, pressure), unit) in own.iter().enumerate().zip(unit_forces) {
                for (i, force) in force.chunks_exact_mut(self.n_dofs()).enumerate() {
                    let weight = factor * rule.pressure_weight(i, l) * pressure;
                    if weight != 0.0 {
                        add_multiple(weight, unit, function.nodes, force);
                    }
                }
            }
        }
        self.space.gather(force);
    }

    /// Adds the changes of the pressures with the rates, with the exact tangent assembled last.
    ///
    /// ```math
    /// dpi_l = sum_j W_lj dx_j
    /// ```
    pub(crate) fn add_local_response(
        &self,
        rule: &Rule,
        assembly: &Assembly,
        rates: &[f64],
        pressures: &mut [f64],
    ) {
        let (n, k) = (rule.n_pressures(), rule.degree());
        for function in self.pressure_functions(assembly, n, k) {
            let own = &mut pressures[function.number * n..(function.number + 1) * n];
            let size = 3 * function.nodes.len();
            for (pressure, responses) in own.iter_mut().zip(function.responses.chunks_exact(size * k)) {
                let stages = responses.chunks_exact(size).zip(rates.chunks_exact(self.n_dofs()));
                *pressure += stages.map(|(response, x)| product(response, function.nodes, x)).sum::<f64>();
            }
        }
    }

    /// Trace of the part of a stiffness that comes through the pressures of cells that count here, `sum g . W`.
    pub(crate) fn local_stiffness(&self, assembly: &Assembly) -> f64 {
        let n = self.n_counted_local();
        let functions = self.pressure_functions(assembly, 1, 1).filter(|function| function.number < n);
        functions.map(|function| dot(function.forces, function.responses)).sum()
    }

    /// [`Body::add_local_force`] with one tangent for all stages, that of a rule with one stage.
    pub(crate) fn add_reused_local_force(
        &self,
        rule: &Rule,
        assembly: &Assembly,
        factor: f64,
        pressures: &[f64],
        force: &mut [f64],
    ) {
        let n = rule.n_pressures();
        for function in self.pressure_functions(assembly, 1, 1) {
            let own = &pressures[function.number * n..(function.number + 1) * n];
            for (i, force) in force.chunks_exact_mut(self.n_dofs()).enumerate() {
                let terms = own.iter().enumerate().map(|(l, pressure)| rule.pressure_weight(i, l) * pressure);
                add_multiple(factor * terms.sum::<f64>(), function.forces, function.nodes, force);
            }
        }
        self.space.gather(force);
    }

    /// [`Body::add_local_response`] with one tangent for all stages, that of a rule with one stage, at half a rate.
    ///
    /// ```math
    /// dpi_l = 2/(1 + 2 rate t_v) sum_j (integral_lj + damping_lj) W dx_j
    /// ```
    pub(crate) fn add_reused_local_response(
        &self,
        rule: &Rule,
        assembly: &Assembly,
        damping: &ReusedDamping,
        rates: &[f64],
        pressures: &mut [f64],
    ) {
        let n = rule.n_pressures();
        let ReusedDamping { viscous_rate, inverse_time, dissipative } = *damping;
        for function in self.pressure_functions(assembly, 1, 1) {
            let time = function.viscous_time;
            let factor = 2.0 / (1.0 + 2.0 * viscous_rate * time);
            let damping = VolumeDamping { viscous: time * inverse_time, dissipative };
            let own = &mut pressures[function.number * n..(function.number + 1) * n];
            for (j, rates) in rates.chunks_exact(self.n_dofs()).enumerate() {
                let change = factor * product(function.responses, function.nodes, rates);
                let terms = own.iter_mut().enumerate();
                terms.for_each(|(l, pressure)| {
                    *pressure +=
                        (rule.pressure_integral(l, j) + rule.reused_volume_damping(&damping, l, j)) * change;
                });
            }
        }
    }
}

/// Adds a multiple of a vector of a cell, `[n_nodes][3]`.
fn add_multiple(factor: f64, of_cell: &[f64], nodes: &[u32], vector: &mut [f64]) {
    for (own, &node) in of_cell.as_chunks::<3>().0.iter().zip(nodes) {
        let sum = &mut vector.as_chunks_mut::<3>().0[node as usize];
        (0..3).for_each(|d| sum[d] += factor * own[d]);
    }
}

/// Scalar product with a vector of a cell, `[n_nodes][3]`.
fn product(of_cell: &[f64], nodes: &[u32], vector: &[f64]) -> f64 {
    let vectors = vector.as_chunks::<3>().0;
    let terms = of_cell.as_chunks::<3>().0.iter().zip(nodes);
    terms.map(|(own, &node)| (0..3).map(|d| own[d] * vectors[node as usize][d]).sum::<f64>()).sum()
}
