//! Loads given by a function of position and time.

use std::sync::Arc;

use super::dead::{DeadLoad, cells_of};
use super::interface::{Book, Force, ForceMemory, OverTime, Side};
use super::signal::{POINTS_OF_SIGNALS, Signal};
use super::source::Site;
use super::step::{Sampling, StepStart};
use crate::average::Rule;
use crate::error::{Error, Result};
use crate::input::pole::pole;
use crate::input::{Field, FieldDomain, Load, SignalTarget, TimeFunction};
use crate::nodal;
use crate::number::short_vector;
use crate::space::geometry::{for_each_facet_point, for_each_mass_point};
use crate::team::Subdomain;

/// A load by a field: the points at which the field is evaluated, and the weights of the nodes at each.
#[derive(Debug, Clone)]
pub(crate) struct FieldLoad {
    number: usize,
    field: Field,
    time_function: TimeFunction,
    /// Reference positions.
    points: Vec<[f64; 3]>,
    /// End of the entries of each point in `node_weights`.
    ends: Vec<usize>,
    /// Nodes with weight times shape function \[length^2 or length^3\].
    node_weights: Vec<(u32, f64)>,
}

/// Memory for the evaluation of a field, so that a step allocates none.
#[derive(Debug)]
struct FieldMemory {
    /// Weights of the stages, `[k]`.
    of_stages: Vec<f64>,
    /// Vectors of the field at its points.
    values: Vec<[f64; 3]>,
}

/// Times at which a few points, and evaluations with which all points are searched for a value that is not finite.
const TIMES: usize = 1000;
const MAX_EVALUATIONS: usize = 100_000;

/// A few points among many, evenly.
fn samples(points: &[[f64; 3]]) -> Vec<[f64; 3]> {
    points.iter().step_by(points.len().div_ceil(POINTS_OF_SIGNALS).max(1)).copied().collect()
}

impl FieldLoad {
    /// The load.
    ///
    /// # Errors
    /// [`crate::Error::UnknownGroup`].
    pub(super) fn new(
        number: usize,
        load: &Load,
        (field, domain): (&Field, FieldDomain<'_>),
        site: &Site<'_>,
    ) -> Result<Self> {
        let Site { mesh, section, .. } = *site;
        let mut table = FieldLoad {
            number,
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
                for_each_mass_point(mesh, cells.into_iter(), site.kind, |cell, nodes, point| {
                    table.push(nodes, point.position, section[cell] * point.weight, point.shapes);
                });
            }
            FieldDomain::Masses(group) => {
                let cells = cells_of(mesh, group)?;
                for_each_mass_point(mesh, cells.into_iter(), site.kind, |cell, nodes, point| {
                    table.push(
                        nodes,
                        point.position,
                        site.density_of_cell[cell] * point.weight,
                        point.shapes,
                    );
                });
                let masses = site.point_masses.iter().enumerate().filter(|(_, mass)| **mass > 0.0);
                for (node, &point_mass) in masses.filter(|_| group.is_none()) {
                    table.push(&[node as u32], mesh.points()[node], point_mass, &[1.0]);
                }
                if group.is_none() {
                    site.spread.for_each_point(mesh, section, site.kind, |nodes, point| {
                        table.push(nodes, point.position, point.weight, point.shapes);
                    });
                }
            }
        }
        Ok(table)
    }

    /// Its components over time at some points, with the factor: how many they are, and a function that sets them for
    /// each time, `[n_times][n]`.
    fn components(
        &self,
        points: Vec<[f64; 3]>,
    ) -> (usize, impl Fn(&[f64], &mut [f64]) + Send + Sync + 'static) {
        let n = 3 * points.len();
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
        (n, move |times: &[f64], values: &mut [f64]| set(&points, times, values))
    }

    /// A point and a time of a span at which the load is not a finite number; of a costly field, at the start of the
    /// span only, because a step names a value that is not finite.
    fn first_not_finite(&self, span: [f64; 2]) -> Option<([f64; 3], f64)> {
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
        samples(&self.points).into_iter().find_map(|X| {
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

    /// Adds the stage averages over a step, by [`Rule::smooth_quadrature`], `force: [k][n_nodes][3]`. Returns whether
    /// the load acts.
    ///
    /// # Errors
    /// [`Error::NotFiniteAt`].
    fn add_averages(
        &self,
        time: f64,
        h: f64,
        rule: &Rule,
        memory: &mut FieldMemory,
        force: &mut [f64],
    ) -> Result<bool> {
        let FieldMemory { of_stages, values } = memory;
        let mut acts = Ok(false);
        let quadrature = rule.smooth_quadrature();
        for [from, to] in self.time_function.long_segments(time, h) {
            let factors =
                self.time_function.for_each_value(time, h, [from, to], quadrature, |alpha, w, factor| {
                    let Ok(acted) = acts else { return };
                    for (i, stage_weight) in of_stages.iter_mut().enumerate() {
                        *stage_weight = w * (to - from) * rule.basis(i, alpha) / rule.weights()[i];
                    }
                    let add = self.add((time + alpha * h, factor), of_stages, values, force);
                    acts = add.map(|acts| acts || acted);
                });
            factors.map_err(|found| self.not_finite(found))?;
        }
        acts
    }

    /// The nodal forces at a time, `[n_nodes][3]`.
    ///
    /// # Errors
    /// [`Error::NotFiniteAt`].
    fn force_at(&self, time: f64, n_dofs: usize) -> Result<Vec<f64>> {
        let (mut force, mut values) = (vec![0.0; n_dofs], vec![[0.0; 3]; self.points.len()]);
        let factor = self.factor(time)?;
        self.add((time, factor), &[1.0], &mut values, &mut force)?;
        Ok(force)
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
                return Err(self.value_not_finite(X, time, value));
            }
            for &(node, weight) in &self.node_weights[begin..end] {
                for (force, stage_weight) in force.chunks_exact_mut(n_dofs).zip(stage_weights) {
                    nodal::add(force, node as usize, value.map(|value| stage_weight * weight * value));
                }
            }
            begin = end;
        }
        Ok(true)
    }

    fn value_not_finite(&self, X: [f64; 3], time: f64, value: f64) -> Error {
        let load = SignalTarget::Load(self.number).with_text(self.field.text());
        Error::NotFiniteAt { what: format!("{load} at {}", short_vector(X)), time, value }
    }
}

impl Force for FieldLoad {
    fn book(&self) -> Book {
        Book::Work
    }

    fn side(&self) -> Side {
        Side::Outside
    }

    fn memory(&self, rule: &Rule) -> ForceMemory {
        let (of_stages, values) = (vec![0.0; rule.degree()], vec![[0.0; 3]; self.points.len()]);
        ForceMemory::new(FieldMemory { of_stages, values })
    }

    fn begin(&self, start: &StepStart<'_>, memory: &mut ForceMemory, steady: &mut [f64]) -> Result<bool> {
        let memory = memory.of_mut::<FieldMemory>();
        let StepStart { rule, points, span, sampling, .. } = *start;
        if sampling == Sampling::Averages {
            return self.add_averages(span.start, span.size, rule, memory, steady);
        }
        let mut acts = false;
        for (m, alpha) in points.alphas().enumerate() {
            let time = span.time(alpha);
            let factor = self.factor(time)?;
            acts |= self.add((time, factor), points.stage_weights(m), &mut memory.values, steady)?;
        }
        Ok(acts)
    }

    fn is_steady(&self) -> bool {
        true
    }

    fn over_time(&self) -> Option<&dyn OverTime> {
        Some(self)
    }
}

impl OverTime for FieldLoad {
    fn number(&self) -> usize {
        self.number
    }

    fn time_function(&self) -> &TimeFunction {
        &self.time_function
    }

    fn signal(&self, ranks: &Subdomain) -> Option<Signal> {
        let mut own = [[f64::NAN; 3]; POINTS_OF_SIGNALS];
        own.iter_mut().zip(samples(&self.points)).for_each(|(own, X)| *own = X);
        let of_ranks = ranks.gather("points of a field", own.as_flattened());
        let points: Vec<[f64; 3]> =
            of_ranks.as_chunks().0.iter().copied().filter(|X: &[f64; 3]| X[0].is_finite()).collect();
        let (n_components, components) = self.components(samples(&points));
        let kinks = self.time_function.corners_after(f64::NEG_INFINITY).collect();
        let signal = Signal::of_field(&self.field, self.number, kinks, n_components, components);
        (n_components > 0).then_some(signal)
    }

    fn in_proportion(&self, time: f64, n_dofs: usize) -> Arc<dyn Force> {
        // A load that is not finite stays so: the march then fails.
        let force = self.force_at(time, n_dofs).unwrap_or_else(|_| vec![f64::NAN; n_dofs]);
        Arc::new(DeadLoad { number: self.number, force, time_function: TimeFunction::ramp(1.0) })
    }

    fn add_unit_force(&self, force: &mut [f64]) {
        let own = self.force_at(0.0, force.len()).unwrap_or_else(|_| vec![f64::NAN; force.len()]);
        force.iter_mut().zip(own).for_each(|(sum, f)| *sum += f);
    }

    fn find_not_finite(&self, span: [f64; 2]) -> Option<([f64; 3], f64)> {
        self.first_not_finite(span)
    }
}
