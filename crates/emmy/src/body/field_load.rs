//! Loads given by a function of position and time.

use super::field::Field;
use super::geometry::{for_each_facet_point, for_each_volume_point};
use super::load_vector::cells_of;
use super::{FieldDomain, Load, TimeFunction};
use crate::average::Rule;
use crate::error::Result;
use crate::mesh::Mesh;

/// A load by a field: the points at which the field is evaluated, and the weights of the nodes at each.
#[derive(Debug)]
pub(super) struct FieldLoad {
    /// Number of the load.
    pub(super) load: usize,
    pub(super) field: Field,
    pub(super) time_function: TimeFunction,
    /// Reference positions.
    points: Vec<[f64; 3]>,
    /// End of the entries of each point in `node_weights`.
    ends: Vec<usize>,
    /// Nodes with weight times shape function \[length^2 or length^3\].
    node_weights: Vec<(u32, f64)>,
}

/// Points of a field at which its change over time is checked.
const POINTS_OF_SIGNALS: usize = 4;

/// Times at which those points, and evaluations with which all points are searched for a value that is not finite.
const TIMES: usize = 1000;
const MAX_EVALUATIONS: usize = 100_000;

impl FieldLoad {
    /// The load; `None` if it is not a field.
    ///
    /// # Errors
    /// [`crate::Error::UnknownGroup`].
    pub(super) fn new(mesh: &Mesh, index: usize, load: &Load, section: &[f64]) -> Result<Option<Self>> {
        let Some((field, domain)) = load.kind.field() else { return Ok(None) };
        let mut table = FieldLoad {
            load: index,
            field: field.clone(),
            time_function: load.time_function.clone(),
            points: Vec::new(),
            ends: Vec::new(),
            node_weights: Vec::new(),
        };
        match domain {
            FieldDomain::Facets(group) => {
                for_each_facet_point(mesh, mesh.groups().facets(group)?, section, |nodes, point| {
                    table.push(nodes, point.position, point.weight, point.shapes);
                });
            }
            FieldDomain::Cells(group) => {
                let cells = cells_of(mesh, group)?;
                for_each_volume_point(mesh, cells.into_iter(), |cell, nodes, point| {
                    table.push(nodes, point.position, section[cell] * point.weight, point.shapes);
                });
            }
        }
        Ok(Some(table))
    }

    /// Its components over time, with the factor, at some of its points.
    pub(super) fn components(
        &self,
    ) -> impl Iterator<Item = impl Fn(f64) -> f64 + Send + Sync + 'static> + '_ {
        let every = self.points.len().div_ceil(POINTS_OF_SIGNALS).max(1);
        self.points.iter().step_by(every).flat_map(move |&X| {
            (0..3).map(move |component| {
                let field = self.field.clone();
                let time_function = self.time_function.clone();
                move |time| time_function.value(time) * field.at(X, time)[component]
            })
        })
    }

    /// A point and a time of a span at which the load is not a finite number.
    pub(super) fn find_not_finite(&self, span: [f64; 2]) -> Option<([f64; 3], f64)> {
        let n_points = self.points.len().max(1);
        let few = self.not_finite_among(n_points.div_ceil(POINTS_OF_SIGNALS), TIMES, span);
        few.or_else(|| self.not_finite_among(1, (MAX_EVALUATIONS / n_points).clamp(1, TIMES), span))
    }

    /// The same among every so many points, at so many times.
    fn not_finite_among(
        &self,
        every: usize,
        n_times: usize,
        [start, end]: [f64; 2],
    ) -> Option<([f64; 3], f64)> {
        let is_undefined = |X: [f64; 3], time: f64| self.field.at(X, time).iter().any(|x| !x.is_finite());
        let times = (0..=n_times).map(|i| start + (end - start) * i as f64 / n_times as f64);
        times.filter(|&time| self.time_function.value(time) != 0.0).find_map(|time| {
            let X = self.points.iter().step_by(every).find(|&&X| is_undefined(X, time))?;
            Some((*X, time))
        })
    }

    fn push(&mut self, nodes: &[u32], position: [f64; 3], weight: f64, shapes: &[f64]) {
        self.points.push(position);
        self.node_weights.extend(nodes.iter().zip(shapes).map(|(&node, N)| (node, weight * N)));
        self.ends.push(self.node_weights.len());
    }

    /// Adds the nodal forces at a time, `force: [n_nodes][3]`. Returns whether the factor over time is not zero.
    pub(super) fn add_at(&self, time: f64, force: &mut [f64]) -> bool {
        self.add(time, &[1.0], force)
    }

    /// Adds the stage averages over a step, by [`Rule::smooth_quadrature`], `force: [k][n_nodes][3]`; `stage_weights`:
    /// memory for k numbers. Returns whether the load acts.
    pub(super) fn add_averages(
        &self,
        time: f64,
        h: f64,
        rule: &Rule,
        stage_weights: &mut [f64],
        force: &mut [f64],
    ) -> bool {
        let mut acts = false;
        for (&[alpha], w) in rule.smooth_quadrature().iter() {
            for (i, stage_weight) in stage_weights.iter_mut().enumerate() {
                *stage_weight = w * rule.basis(i, alpha) / rule.weights()[i];
            }
            acts |= self.add(time + alpha * h, stage_weights, force);
        }
        acts
    }

    /// Adds the nodal forces at a time to every stage, times its weight.
    fn add(&self, time: f64, stage_weights: &[f64], force: &mut [f64]) -> bool {
        let factor = self.time_function.value(time);
        let n_dofs = force.len() / stage_weights.len();
        let mut begin = 0;
        if factor == 0.0 {
            return false;
        }
        for (&X, &end) in self.points.iter().zip(&self.ends) {
            let value = self.field.at(X, time).map(|value| factor * value);
            for &(node, weight) in &self.node_weights[begin..end] {
                for (force, stage_weight) in force.chunks_exact_mut(n_dofs).zip(stage_weights) {
                    (0..3).for_each(|i| force[3 * node as usize + i] += stage_weight * weight * value[i]);
                }
            }
            begin = end;
        }
        true
    }
}
