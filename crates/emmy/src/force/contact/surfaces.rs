//! Contact between the surfaces of bodies.

use std::sync::{Mutex, PoisonError};

use super::LEFT;
use crate::average::{Request, Rule};
use crate::contact::{ActingPair, SurfaceLayer, SurfaceMemory, SurfaceNode, SurfaceSearch};
use crate::error::{Error, Result};
use crate::force::contact_summary::ContactSummary;
use crate::force::integral::Scratch;
use crate::force::interface::{Book, Force, ForceMemory, Side};
use crate::force::step::StepInput;
use crate::force::strain_state::{ContactAtNode, ContactState, StrainState};
use crate::nodal;
use crate::sparse::{Couplings, RowPart};
use crate::tensor::Mat3;

/// Layers between surfaces that store energy where these come near each other.
#[derive(Debug)]
pub(super) struct SurfaceContact {
    pub summary: ContactSummary,
    pub layer: SurfaceLayer,
    /// Memory for states, and for bounds; no result depends on it.
    pub search: Mutex<SurfaceSearch>,
    pub bound: Mutex<SurfaceSearch>,
}

/// Most nodes of a pair: nine of each facet.
const MAX_NODES: usize = 18;

/// The nodes of a pair, with their shares in its entities.
struct PairNodes {
    n: usize,
    nodes: [u32; MAX_NODES],
    shares: [[f64; 4]; MAX_NODES],
}

impl PairNodes {
    fn new(layer: &SurfaceLayer, acting: &ActingPair<'_>) -> Self {
        let mut own = PairNodes { n: 0, nodes: [0; MAX_NODES], shares: [[0.0; 4]; MAX_NODES] };
        for (a, entity) in acting.pair.entities[..acting.pair.kind.n_entities()].iter().enumerate() {
            for (number, share) in layer.surface.entity(*entity) {
                let node = layer.surface.nodes[number];
                let known = own.nodes[..own.n].iter().position(|other| *other == node);
                let at = known.unwrap_or_else(|| {
                    own.nodes[own.n] = node;
                    own.n += 1;
                    own.n - 1
                });
                own.shares[at][a] += share;
            }
        }
        own
    }

    fn iter(&self) -> impl Iterator<Item = (u32, &[f64; 4])> {
        self.nodes[..self.n].iter().copied().zip(&self.shares)
    }
}

impl SurfaceContact {
    fn position(&self, displacement: &[f64], number: usize) -> [f64; 3] {
        let (X, u) = (self.layer.surface.positions[number], self.at_node(displacement, number));
        [0, 1, 2].map(|d| X[d] + u[d])
    }

    fn at_node(&self, vectors: &[f64], number: usize) -> [f64; 3] {
        nodal::at(vectors, self.layer.surface.nodes[number] as usize)
    }
}

impl Force for SurfaceContact {
    fn book(&self) -> Book {
        Book::Stored
    }

    fn side(&self) -> Side {
        Side::Inside
    }

    fn has_couplings(&self) -> bool {
        true
    }

    fn memory(&self, rule: &Rule) -> ForceMemory {
        ForceMemory::new(SurfaceMemory::new(&self.layer, rule))
    }

    fn prepare(&self, (step, request): (&StepInput<'_>, Request), memory: &mut ForceMemory) -> Result<()> {
        let n = step.displacement.len();
        let position = |number: usize| self.position(step.displacement, number);
        let rate =
            |stage: usize, number: usize| self.at_node(&step.rates[stage * n..(stage + 1) * n], number);
        let wants_tangents = request == Request::Tangent;
        let outcome = self.layer.evaluate(step.rule, position, rate, wants_tangents, memory.of_mut());
        outcome.map_err(|at| Error::Passed { contact: self.summary.name.clone(), at })
    }

    fn assemble(
        &self,
        _: (&StepInput<'_>, Request),
        memory: &ForceMemory,
        _: usize,
        _: &mut Scratch,
        sink: &mut RowPart,
    ) -> Result<()> {
        let (rows, nodes) = (sink.rows(), &self.layer.surface.nodes);
        let memory: &SurfaceMemory = memory.of();
        let [first, last] =
            [rows.start, rows.end].map(|row| nodes.partition_point(|&node| (node as usize) < row));
        for (stage, forces) in memory.forces().iter().enumerate() {
            for (node, force) in nodes[first..last].iter().zip(&forces[first..last]) {
                sink.add_force(stage, *node, *force);
            }
        }
        Ok(())
    }

    fn add_couplings(&self, step: &StepInput<'_>, memory: &ForceMemory, couplings: &mut Couplings) {
        let memory: &SurfaceMemory = memory.of();
        for acting in memory.acting() {
            let nodes = PairNodes::new(&self.layer, &acting);
            for (column, shares) in nodes.iter() {
                for (stages, tangent) in acting.tangents.iter().enumerate() {
                    let of_column = tangent.map(|row| {
                        let mut sum = Mat3::default();
                        for (block, share) in row.iter().zip(shares).filter(|(_, share)| **share != 0.0) {
                            add(&mut sum, *share, block);
                        }
                        sum
                    });
                    for (row, shares) in nodes.iter() {
                        let sums = &mut couplings.block_mut(row, column)[9 * stages..][..9];
                        for (block, share) in of_column.iter().zip(shares).filter(|(_, share)| **share != 0.0)
                        {
                            let entries = sums.iter_mut().zip(block.as_flattened());
                            entries.for_each(|(sum, entry)| *sum += step.tangent_factor * share * entry);
                        }
                    }
                }
            }
        }
    }

    fn strain_state(&self, displacement: &[f64], _: &[f64]) -> StrainState {
        // A panic leaves a list that holds for its boxes, or none.
        let mut search = self.search.lock().unwrap_or_else(PoisonError::into_inner);
        let state = self.layer.state(|number| self.position(displacement, number), &mut search);
        let contact = ContactState {
            energy: state.energy,
            smallest_gap: state.smallest_gap / self.layer.layer.thickness,
            n_points: state.n_points,
        };
        StrainState { contact, ..StrainState::NONE }
    }

    fn for_each_reaction(
        &self,
        (_, memory): (&StepInput<'_>, &ForceMemory),
        stage: usize,
        visit: &mut dyn FnMut(usize, [f64; 3]),
    ) {
        let (memory, surface): (&SurfaceMemory, _) = (memory.of(), &self.layer.surface);
        let forces = surface.nodes.iter().zip(&surface.body_of).zip(&memory.forces()[stage]);
        // The force on the first body counts as that of the contact.
        for ((node, _), force) in forces.filter(|((_, body), _)| **body == 0) {
            visit(*node as usize, force.map(|f| -f));
        }
    }

    fn bounds(&self) -> bool {
        true
    }

    fn largest_part(&self, step: &StepInput<'_>, _: &ForceMemory, correction: &[f64]) -> f64 {
        let n = step.displacement.len();
        let sum = |rates: &[f64], number: usize| {
            let mut sum = [0.0; 3];
            for (rates, weight) in rates.chunks_exact(n).zip(step.rule.weights()) {
                let x = self.at_node(rates, number);
                (0..3).for_each(|d| sum[d] += weight * x[d]);
            }
            sum
        };
        let at_end = |number: usize| {
            let (start, moved) = (self.position(step.displacement, number), sum(step.rates, number));
            [0, 1, 2].map(|d| start[d] + moved[d])
        };
        let mut search = self.bound.lock().unwrap_or_else(PoisonError::into_inner);
        self.layer.largest_part(at_end, |number| sum(correction, number), LEFT, &mut search)
    }

    fn is_sudden(&self, _: &StepInput<'_>, memory: &ForceMemory) -> bool {
        memory.of::<SurfaceMemory>().acts()
    }

    fn contact(&self) -> Option<&ContactSummary> {
        Some(&self.summary)
    }

    fn for_each_contact_node(&self, displacement: &[f64], visit: &mut dyn FnMut(usize, ContactAtNode)) {
        let mut search = self.search.lock().unwrap_or_else(PoisonError::into_inner);
        let position = |number: usize| self.position(displacement, number);
        let nodes = self.layer.surface.nodes.iter().zip(self.layer.nodes(position, &mut search));
        for (node, SurfaceNode { pressure, area, gap }) in nodes {
            let gap = if gap.is_finite() { gap } else { f64::NAN };
            visit(*node as usize, ContactAtNode { pressure, area, gap });
        }
    }

    fn without_adjoint(&self) -> Option<&'static str> {
        Some("contact is not covered")
    }
}

fn add(sum: &mut Mat3<f64>, share: f64, block: &Mat3<f64>) {
    let entries = sum.as_flattened_mut().iter_mut().zip(block.as_flattened());
    entries.for_each(|(sum, entry)| *sum += share * entry);
}
