//! The turn of a stiffness with the parts of a body.

use std::ops::Range;

use rayon::prelude::*;

use super::strain_rates::StrainRateTransform;
use crate::average::Rule;
use crate::body::Body;
use crate::nodal;
use crate::tensor::Mat3;
use crate::tensor::rotation::{IDENTITY, image, transposed};
use crate::time::best_fit;
use crate::unknowns::Component;

/// A part of the body, which turns like a rigid body from the configuration of K to the Gauss points of a step.
#[derive(Debug)]
pub(super) struct Turning {
    /// Its nodes without incompatible modes, which are not points of the body.
    points: Component,
    dofs: Vec<Range<usize>>,
    /// Rotations from K to the Gauss points, `[k]`.
    rotations: Vec<Mat3<f64>>,
    strain_rates: StrainRateTransform,
    /// Whether it spins under a rule with strain rates.
    is_spinning: bool,
    /// Largest component of its spins, as angles of a step.
    largest_spin: f64,
}

/// Smallest turn that a K in 16 bits notices \[rad\].
const LEAST_TURN: f64 = 2e-3;

impl Turning {
    /// Memory for the parts of a body that turn: its components, if supports hold nothing of them, or the body. Rigid
    /// bodies without nodes of a mesh do not: their mass has no orientation.
    pub(super) fn all(degree: usize, body: &Body, components: &[Component]) -> Vec<Self> {
        let turning = |component: &Component| Turning {
            points: component.retained(|node| node < body.mesh().n_nodes()),
            dofs: component.retained(|node| !body.mechanism.is_free_of_mesh(node)).dofs(),
            rotations: vec![IDENTITY; degree],
            strain_rates: StrainRateTransform::new(degree),
            is_spinning: false,
            largest_spin: 0.0,
        };
        let mut all: Vec<Turning> = match components.is_empty() {
            true => vec![turning(&Component::whole(body.n_dofs() / 3))],
            false => components.iter().filter(|component| !body.holds(component)).map(turning).collect(),
        };
        all.retain(|turning| !turning.dofs.is_empty());
        all
    }

    /// Sets the rotations.
    pub(super) fn orient(&mut self, rotations: impl Iterator<Item = Mat3<f64>>) {
        self.rotations.iter_mut().zip(rotations).for_each(|(own, R)| *own = R);
    }

    /// Sets the spins of a step.
    pub(super) fn set_spins(&mut self, rule: &Rule, spins: &[[f64; 3]]) {
        self.largest_spin = spins.iter().flatten().fold(0.0, |most: f64, w| most.max(w.abs()));
        self.is_spinning = rule.is_energy_momentum() && spins.iter().flatten().any(|w| *w != 0.0);
        if self.is_spinning {
            self.strain_rates.set_spins(rule, spins);
        }
    }

    /// Fits the rotations from the positions of K, and the spins, to the rates of a step from a displacement; `spins`:
    /// memory for k.
    pub(super) fn fit(
        &mut self,
        (body, rule): (&Body, &Rule),
        positions: &[f64],
        (displacement, rates): (&[f64], &[f64]),
        spins: &mut [[f64; 3]],
    ) {
        let (n, k) = (displacement.len(), self.rotations.len());
        let a = rule.coefficients();
        for (i, (R, spin)) in self.rotations.iter_mut().zip(spins.iter_mut()).enumerate() {
            let position = |node: usize| {
                let mut q = body.space.position(displacement, node);
                for (a, rates) in a[i * k..].iter().zip(rates.chunks_exact(n)) {
                    let x = nodal::at(rates, node);
                    (0..3).for_each(|d| q[d] += a * x[d]);
                }
                q
            };
            let of_stage = &rates[i * n..];
            *R = best_fit::rotation(&self.points, |node| nodal::at(positions, node), position);
            [_, *spin] = best_fit::rates(&self.points, position, |node| nodal::at(of_stage, node));
        }
        self.set_spins(rule, spins);
    }

    /// Leaves out turns that change K less than its precision in the solvers.
    pub(super) fn settle(&mut self) {
        let units = IDENTITY.as_flattened().iter().cycle();
        let changes = self.rotations.as_flattened().as_flattened().iter().zip(units);
        if changes.map(|(own, unit)| (own - unit).abs()).fold(0.0, f64::max) < LEAST_TURN {
            self.rotations.fill(IDENTITY);
            self.is_spinning &= self.largest_spin > LEAST_TURN;
        }
    }

    /// The rotation from K to the first Gauss point.
    pub(super) fn rotation(&self) -> &Mat3<f64> {
        &self.rotations[0]
    }

    /// Turns stages, `[k][n_nodes][3]`, back to the orientation of K.
    pub(super) fn turn_back(&self, stages: &mut [f64]) {
        let n = stages.len() / self.rotations.len();
        for (stage, R) in stages.chunks_exact_mut(n).zip(&self.rotations) {
            rotate(stage, &self.dofs, &transposed(R));
        }
    }

    /// Turns stages forward from the orientation of K.
    pub(super) fn turn_forward(&self, stages: &mut [f64]) {
        let n = stages.len() / self.rotations.len();
        for (stage, R) in stages.chunks_exact_mut(n).zip(&self.rotations) {
            rotate(stage, &self.dofs, R);
        }
    }

    /// Whether it spins under a rule with strain rates.
    pub(super) fn is_spinning(&self) -> bool {
        self.is_spinning
    }

    /// Changes the rates that strain the part to rates; `old`: a copy of them.
    pub(super) fn unstrain(&self, old: &[f64], stages: &mut [f64]) {
        self.strain_rates.apply_inverse(old, stages, &self.dofs);
    }

    /// Its nodes.
    pub(super) fn nodes(&self) -> impl Iterator<Item = usize> + '_ {
        self.dofs.iter().flat_map(|dofs| dofs.start / 3..dofs.end / 3)
    }

    /// Whether it has a node.
    pub(super) fn has(&self, node: u32) -> bool {
        self.dofs.iter().any(|dofs| dofs.contains(&nodal::dof(node as usize, 0)))
    }

    /// Turns a node of stages, `[k][n/3][3]`, forward from the orientation of K.
    pub(super) fn turn_node(&self, node: usize, stages: &mut [f64]) {
        let n = stages.len() / self.rotations.len();
        for (stage, R) in stages.chunks_exact_mut(n).zip(&self.rotations) {
            let own = nodal::at_mut(stage, node);
            *own = image(R, own);
        }
    }

    /// Changes the rates of a node that strain the part to rates; `old`: a copy of them.
    pub(super) fn unstrain_node(&self, node: usize, old: &[f64], stages: &mut [f64]) {
        let dofs = nodal::dofs(node);
        self.strain_rates.apply_inverse(old, stages, &[dofs]);
    }
}

/// Turns a table of the displacements of some nodes under unit forces on them, `[k][nodes][3]` in both directions, from
/// the orientation of K to that of the step. `unstrains`: whether rates that strain a part become rates; `memory`: for
/// as many numbers.
pub(super) fn turn_table(
    parts: &[Turning],
    unstrains: bool,
    nodes: &[u32],
    (table, memory): (&mut [f64], &mut [f64]),
) {
    let n = table.len().isqrt();
    let of_node = |node: u32| parts.iter().find(|part| part.has(node));
    let turning = || nodes.iter().enumerate().filter_map(|(number, &node)| Some((number, of_node(node)?)));
    for (number, part) in turning() {
        table.chunks_exact_mut(n).for_each(|row| part.turn_node(number, row));
    }
    transpose(table, memory);
    for (number, part) in turning() {
        memory.chunks_exact_mut(n).for_each(|row| part.turn_node(number, row));
        if unstrains && part.is_spinning() {
            table.copy_from_slice(memory);
            let rows = table.chunks_exact(n).zip(memory.chunks_exact_mut(n));
            rows.for_each(|(old, row)| part.unstrain_node(number, old, row));
        }
    }
    transpose(memory, table);
}

/// Sets the transpose of a square table.
fn transpose(table: &[f64], transposed: &mut [f64]) {
    let n = table.len().isqrt();
    for (i, row) in table.chunks_exact(n).enumerate() {
        row.iter().enumerate().for_each(|(j, x)| transposed[j * n + i] = *x);
    }
}

/// Nodes of one task.
const NODES: usize = 2048;

/// Turns the vectors of nodes, `[n_nodes][3]`, in some ranges of degrees of freedom.
fn rotate(vectors: &mut [f64], turning: &[Range<usize>], R: &Mat3<f64>) {
    if *R == IDENTITY {
        return;
    }
    for range in turning {
        vectors[range.clone()].par_chunks_mut(3 * NODES).for_each(|vectors| {
            for v in vectors.as_chunks_mut::<3>().0 {
                *v = [0, 1, 2].map(|a| R[a][0] * v[0] + R[a][1] * v[1] + R[a][2] * v[2]);
            }
        });
    }
}
