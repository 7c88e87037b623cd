//! Loads given by a function of position and time.

use super::load_vector::cells_of;
use crate::average::Rule;
use crate::error::{Error, Result};
use crate::input::pole::pole;
use crate::input::{Field, FieldDomain, Load, NotFinite, SignalTarget, TimeFunction};
use crate::mass::Spread;
use crate::mesh::Mesh;
use crate::number::short_vector;
use crate::space::geometry::{MassKind, for_each_facet_point, for_each_mass_point};

/// A load by a field: the points at which the field is evaluated, and the weights of the nodes at each.
#[derive(Debug, Clone)]
pub(crate) struct FieldLoad {
    /// Number of the load.
    pub(crate) load: usize,
    pub(crate) field: Field,
    pub(crate) time_function: TimeFunction,
    /// Reference positions.
    points: Vec<[f64; 3]>,
    /// Some of them, of all ranks, at which the change over time is checked.
    pub(crate) samples: Vec<[f64; 3]>,
    /// End of the entries of each point in `node_weights`.
    ends: Vec<usize>,
    /// Nodes with weight times shape function \[length^2 or length^3\].
    node_weights: Vec<(u32, f64)>,
}

/// Memory for the evaluation of the dead loads of a body, so that a step allocates none.
#[derive(Debug, Default)]
pub(crate) struct LoadMemory {
    /// Averages of a time function, or weights of the stages, `[k]`.
    pub(crate) of_stages: Vec<f64>,
    /// Vectors of a field at its points.
    values: Vec<[f64; 3]>,
}

impl LoadMemory {
    pub(crate) fn new(n_stages: usize, fields: &[FieldLoad]) -> Self {
        let n_points = fields.iter().map(|field| field.points.len()).max().unwrap_or(0);
        LoadMemory { of_stages: vec![0.0; n_stages], values: vec![[0.0; 3]; n_points] }
    }
}

/// Points of a field at which its change over time is checked.
pub(crate) const POINTS_OF_SIGNALS: usize = 4;

/// Times at which those points, and evaluations with which all points are searched for a value that is not finite.
const TIMES: usize = 1000;
const MAX_EVALUATIONS: usize = 100_000;

/// A few points among many, evenly.
pub(crate) fn samples(points: &[[f64; 3]]) -> Vec<[f64; 3]> {
    points.iter().step_by(points.len().div_ceil(POINTS_OF_SIGNALS).max(1)).copied().collect()
}

impl FieldLoad {
    /// The load; `None` if it is not a field. `section`: thickness of plane cells, `density_of_cell`: mass per measure of
    /// each cell, `point_masses: [n_nodes]`, `spread`: further masses, `mass`: the kind of mass on which body forces and
    /// accelerations act.
    ///
    /// # Errors
    /// [`crate::Error::UnknownGroup`].
    pub(crate) fn new(
        mesh: &Mesh,
        index: usize,
        load: &Load,
        (section, density_of_cell, point_masses): (&[f64], &[f64], &[f64]),
        (spread, mass): (&Spread, MassKind),
    ) -> Result<Option<Self>> {
        let Some((field, domain)) = load.kind.field() else { return Ok(None) };
        let mut table = FieldLoad {
            load: index,
            field: field.clone(),
            time_function: load.time_function.clone(),
            points: Vec::new(),
            samples: Vec::new(),
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
                for_each_mass_point(mesh, cells.into_iter(), mass, &mut |cell, nodes, point| {
                    table.push(nodes, point.position, section[cell] * point.weight, point.shapes);
                });
            }
            FieldDomain::Masses(group) => {
                let cells = cells_of(mesh, group)?;
                for_each_mass_point(mesh, cells.into_iter(), mass, &mut |cell, nodes, point| {
                    table.push(nodes, point.position, density_of_cell[cell] * point.weight, point.shapes);
                });
                let masses = point_masses.iter().enumerate().filter(|(_, mass)| **mass > 0.0);
                for (node, &point_mass) in masses.filter(|_| group.is_none()) {
                    table.push(&[node as u32], mesh.points()[node], point_mass, &[1.0]);
                }
                if group.is_none() {
                    spread.for_each_point(mesh, section, mass, |nodes, point| {
                        table.push(nodes, point.position, point.weight, point.shapes);
                    });
                }
            }
        }
        table.samples = samples(&table.points);
        Ok(Some(table))
    }

    /// Its components over time at some of its points, with the factor: how many they are, and a function that sets them
    /// for each time, `[n_times][n]`.
    pub(crate) fn components(&self) -> (usize, impl Fn(&[f64], &mut [f64]) + Send + Sync + 'static) {
        let points = self.samples.clone();
        let (field, time_function) = (self.field.clone(), self.time_function.clone());
        let set = move |points: &[[f64; 3]], times: &[f64], values: &mut [f64]| {
            let mut vectors = [[0.0; 3]; POINTS_OF_SIGNALS];
            let vectors = &mut vectors[..points.len()];
            for (&time, values) in times.iter().zip(values.chunks_exact_mut(3 * points.len())) {
                field.set_at(points, time, vectors);
                let factor = time_function.value(time);
                let all = values.iter_mut().zip(vectors.as_flattened());
                all.for_each(|(value, component)| *value = factor * component);
            }
        };
        (3 * points.len(), move |times: &[f64], values: &mut [f64]| set(&points, times, values))
    }

    /// A point and a time of a span at which the load is not a finite number; of a costly field, at the start of the span
    /// only, because a step names a value that is not finite.
    pub(crate) fn find_not_finite(&self, span: [f64; 2]) -> Option<([f64; 3], f64)> {
        if self.field.is_costly() {
            return self.not_finite_among(1, 0, span);
        }
        let n_points = self.points.len().max(1);
        let few = self.not_finite_among(n_points.div_ceil(POINTS_OF_SIGNALS), TIMES, span);
        few.or_else(|| self.not_finite_among(1, (MAX_EVALUATIONS / n_points).clamp(1, TIMES), span))
            .or_else(|| self.find_pole(span))
    }

    /// A pole over time at one of a few points.
    fn find_pole(&self, span: [f64; 2]) -> Option<([f64; 3], f64)> {
        self.samples.iter().find_map(|&X| {
            let size = |time: f64| {
                let value = self.field.at(X, time).iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
                self.time_function.value(time) * value
            };
            Some((X, pole(size, span)?))
        })
    }

    /// The same among every so many points, at the start and at so many further times.
    fn not_finite_among(
        &self,
        every: usize,
        n_times: usize,
        [start, end]: [f64; 2],
    ) -> Option<([f64; 3], f64)> {
        let points: Vec<[f64; 3]> = self.points.iter().step_by(every).copied().collect();
        let mut values = vec![[0.0; 3]; points.len()];
        let times = (0..=n_times).map(|i| start + (end - start) * i as f64 / n_times.max(1) as f64);
        times.filter(|&time| self.time_function.value(time) != 0.0).find_map(|time| {
            self.field.set_at(&points, time, &mut values);
            let place = values.iter().position(|value| value.iter().any(|x| !x.is_finite()))?;
            Some((points[place], time))
        })
    }

    fn push(&mut self, nodes: &[u32], position: [f64; 3], weight: f64, shapes: &[f64]) {
        self.points.push(position);
        self.node_weights.extend(nodes.iter().zip(shapes).map(|(&node, N)| (node, weight * N)));
        self.ends.push(self.node_weights.len());
    }

    /// Adds the nodal forces at a time, `force: [n_nodes][3]`. Returns whether the factor over time is not zero.
    ///
    /// # Errors
    /// [`Error::NotFiniteAt`].
    pub(crate) fn add_at(&self, time: f64, memory: &mut LoadMemory, force: &mut [f64]) -> Result<bool> {
        let factor = self.time_function.value(time);
        if !factor.is_finite() {
            return Err(self.factor_not_finite(NotFinite { time, value: factor }));
        }
        self.add((time, factor), &[1.0], &mut memory.values, force)
    }

    /// Adds the stage averages over a step, by [`Rule::smooth_quadrature`], `force: [k][n_nodes][3]`. Returns whether
    /// the load acts.
    ///
    /// # Errors
    /// [`Error::NotFiniteAt`].
    pub(crate) fn add_averages(
        &self,
        time: f64,
        h: f64,
        rule: &Rule,
        memory: &mut LoadMemory,
        force: &mut [f64],
    ) -> Result<bool> {
        let LoadMemory { of_stages, values } = memory;
        let mut acts = Ok(false);
        let quadrature = rule.smooth_quadrature();
        let factors =
            self.time_function.for_each_value(time, h, [0.0, 1.0], quadrature, |alpha, w, factor| {
                let Ok(acted) = acts else { return };
                for (i, stage_weight) in of_stages.iter_mut().enumerate() {
                    *stage_weight = w * rule.basis(i, alpha) / rule.weights()[i];
                }
                acts =
                    self.add((time + alpha * h, factor), of_stages, values, force).map(|acts| acts || acted);
            });
        factors.map_err(|found| self.factor_not_finite(found))?;
        acts
    }

    /// Adds the nodal forces at a time with a factor to every stage, times its weight; `values`: memory for a vector at
    /// each point.
    fn add(
        &self,
        (time, factor): (f64, f64),
        stage_weights: &[f64],
        values: &mut [[f64; 3]],
        force: &mut [f64],
    ) -> Result<bool> {
        let n_dofs = force.len() / stage_weights.len();
        let mut begin = 0;
        if factor == 0.0 {
            return Ok(false);
        }
        let values = &mut values[..self.points.len()];
        self.field.set_at(&self.points, time, values);
        for ((value, &X), &end) in values.iter().zip(&self.points).zip(&self.ends) {
            let value = value.map(|value| factor * value);
            if let Some(&value) = value.iter().find(|value| !value.is_finite()) {
                return Err(self.not_finite(X, time, value));
            }
            for &(node, weight) in &self.node_weights[begin..end] {
                for (force, stage_weight) in force.chunks_exact_mut(n_dofs).zip(stage_weights) {
                    (0..3).for_each(|i| force[3 * node as usize + i] += stage_weight * weight * value[i]);
                }
            }
            begin = end;
        }
        Ok(true)
    }

    fn factor_not_finite(&self, found: NotFinite) -> Error {
        SignalTarget::Load(self.load).not_finite(self.time_function.text().unwrap_or_default(), found)
    }

    fn not_finite(&self, X: [f64; 3], time: f64, value: f64) -> Error {
        let load = SignalTarget::Load(self.load).with_text(self.field.text());
        Error::NotFiniteAt { what: format!("{load} at {}", short_vector(X)), time, value }
    }
}
