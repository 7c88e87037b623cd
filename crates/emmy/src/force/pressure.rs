//! Follower pressures: loads that rotate and grow with their surface.

use super::facets::{FacetTable, NodalVectors};
use super::step::StepInput;
use crate::average::FollowerRule;
use crate::error::{Error, Result};
use crate::input::{Load, LoadKind, NotFinite, SignalTarget, TimeFunction};
use crate::mesh::Mesh;
use crate::sparse::{Pattern, StageMatrix};

/// A pressure on a facet group with its factor over time.
#[derive(Debug)]
pub(crate) struct Pressure {
    /// Number of the load.
    pub(crate) load: usize,
    pressure: f64,
    pub(crate) time_function: TimeFunction,
    tables: Vec<FacetTable>,
}

impl Pressure {
    /// The pressure; `None` for another load.
    ///
    /// # Errors
    /// [`Error::UnknownGroup`], [`Error::NotFinite`], [`Error::PressureInside`].
    pub(crate) fn new(
        mesh: &Mesh,
        pattern: &Pattern,
        index: usize,
        load: &Load,
        section: &[f64],
    ) -> Result<Option<Self>> {
        let LoadKind::Pressure { group, pressure } = &load.kind else { return Ok(None) };
        let pressure = *pressure;
        let time_function = load.time_function.clone();
        if !pressure.is_finite() {
            return Err(Error::NotFinite { what: "pressure".into(), value: pressure });
        }
        let facets = mesh.groups().facets(group)?;
        // On a team the rank that owns a node of an inner facet has both of its cells.
        if let Some(facet) = mesh.inner_facet(facets) {
            let nodes: Vec<[f64; 3]> =
                mesh.facet_nodes(facet).map(|node| mesh.points()[node as usize]).collect();
            let at = [0, 1, 2].map(|i| nodes.iter().map(|x| x[i]).sum::<f64>() / nodes.len() as f64);
            return Err(Error::PressureInside { group: group.clone(), at });
        }
        let tables = FacetTable::of(mesh, pattern, facets, section);
        Ok(Some(Pressure { load: index, pressure, time_function, tables }))
    }

    /// The factor at a time.
    ///
    /// # Errors
    /// [`Error::NotFiniteAt`].
    pub(crate) fn factor(&self, time: f64) -> Result<f64> {
        let value = self.time_function.value(time);
        if value.is_finite() { Ok(value) } else { Err(self.not_finite(NotFinite { time, value })) }
    }

    /// The error of a factor that is not a finite number.
    pub(crate) fn not_finite(&self, found: NotFinite) -> Error {
        SignalTarget::Load(self.load).not_finite(self.time_function.text().unwrap_or_default(), found)
    }

    /// The pressure with another factor over time.
    pub(crate) fn with_time_function(&self, time_function: TimeFunction) -> Pressure {
        Pressure { load: self.load, pressure: self.pressure, time_function, tables: self.tables.clone() }
    }

    /// Adds the force of a factor at a displacement, `force: [n_nodes][3]`.
    pub(crate) fn add_force(&self, mesh: &Mesh, displacement: &[f64], factor: f64, force: &mut [f64]) {
        for table in &self.tables {
            for (nodes, _, section) in table.facets() {
                let q = positions(mesh, nodes, |dof| displacement[dof]);
                let factor = section * self.pressure * factor;
                for (&node, f) in nodes.iter().zip(table.force(&q)) {
                    (0..3).for_each(|i| force[3 * node as usize + i] += factor * f[i]);
                }
            }
        }
    }

    /// Adds stage averages, `force: [k][n_nodes][3]`; `factors`: p_m at the points.
    pub(crate) fn add_stage_forces(
        &self,
        mesh: &Mesh,
        step: &StepInput<'_>,
        rule: &FollowerRule,
        factors: &[f64],
        force: &mut [f64],
    ) {
        let n_dofs = step.displacement.len();
        for table in &self.tables {
            for (nodes, _, section) in table.facets() {
                for (m, factor) in factors.iter().enumerate() {
                    let q = positions(mesh, nodes, |dof| displacement_at(step, rule.integrals(m), dof));
                    let f = table.force(&q);
                    for (force, stage_weight) in force.chunks_exact_mut(n_dofs).zip(rule.stage_weights(m)) {
                        let factor = section * self.pressure * factor * stage_weight;
                        for (&node, f) in nodes.iter().zip(&f) {
                            (0..3).for_each(|i| force[3 * node as usize + i] += factor * f[i]);
                        }
                    }
                }
            }
        }
    }

    /// Adds the derivatives `- s^2 df_i/dx_j` to the stage matrix.
    pub(crate) fn add_stage_tangent(
        &self,
        mesh: &Mesh,
        step: &StepInput<'_>,
        rule: &FollowerRule,
        factors: &[f64],
        matrix: &mut StageMatrix,
    ) {
        for table in &self.tables {
            for (nodes, pairs, section) in table.facets() {
                for (m, factor) in factors.iter().enumerate() {
                    let integrals = rule.integrals(m);
                    let stage_weights = rule.stage_weights(m);
                    let q = positions(mesh, nodes, |dof| displacement_at(step, integrals, dof));
                    let c = table.derivative(&q);
                    let n = nodes.len();
                    let k = integrals.len();
                    let factor = -step.tangent_factor * section * self.pressure * factor;
                    for (A, &node) in nodes.iter().enumerate() {
                        let Some(part) = matrix.parts_mut().iter_mut().find(|part| part.owns(node)) else {
                            continue;
                        };
                        for B in 0..n {
                            for stages in 0..k * k {
                                let weight = factor * stage_weights[stages / k] * integrals[stages % k];
                                let block = part.block_mut(pairs[A * n + B] as usize, stages);
                                add_cross_product(block, weight, c[A][B]);
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Adds the matrix of `v -> weight c x v` to a block, row by row.
fn add_cross_product(block: &mut [f64], weight: f64, c: [f64; 3]) {
    let [x, y, z] = c.map(|c| weight * c);
    for (entry, value) in [(1, -z), (2, y), (3, z), (5, -x), (6, -y), (7, x)] {
        block[entry] += value;
    }
}

/// A component of the displacement at the point of a step with the integrals L_j of the basis.
fn displacement_at(step: &StepInput<'_>, integrals: &[f64], dof: usize) -> f64 {
    let rates = step.rates[dof..].iter().step_by(step.displacement.len());
    step.displacement[dof] + integrals.iter().zip(rates).map(|(L_j, x)| L_j * x).sum::<f64>()
}

/// Current positions of a facet's nodes.
fn positions(mesh: &Mesh, nodes: &[u32], displacement: impl Fn(usize) -> f64) -> NodalVectors {
    let mut q = NodalVectors::default();
    for (q, &node) in q.iter_mut().zip(nodes) {
        let X = mesh.points()[node as usize];
        *q = [0, 1, 2].map(|i| X[i] + displacement(3 * node as usize + i));
    }
    q
}
