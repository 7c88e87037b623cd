//! Springs to the ground.

use std::sync::Arc;

use super::integral::Scratch;
use super::interface::{Book, Force, ForceMemory, Side};
use super::source::{ForceSource, Site};
use super::step::StepInput;
use super::strain_state::StrainState;
use crate::average::Request;
use crate::error::{Error, Result};
use crate::input::GroundSpring;
use crate::mass::points::own_nodes;
use crate::nodal;
use crate::space::geometry::for_each_facet_point;
use crate::sparse::RowPart;

/// Springs to the ground: a linear force.
#[derive(Debug)]
struct GroundSprings {
    /// Node of the force, node of the displacement, and the stiffness between them; ascending.
    pairs: Vec<(u32, u32, f64)>,
    /// Position of each pair in the pattern.
    positions: Vec<u32>,
}

impl ForceSource for GroundSpring {
    fn force(&self, _: usize, site: &Site<'_>) -> Result<Arc<dyn Force>> {
        let GroundSpring { group, stiffness } = self;
        if !(*stiffness > 0.0 && stiffness.is_finite()) {
            return Err(Error::NotPositive { what: "stiffness of springs".into(), value: *stiffness });
        }
        let (mesh, n_own) = (site.mesh, site.n_own);
        let nodes = own_nodes(mesh, group, n_own)?;
        let Ok(facets) = mesh.groups().facets(group) else {
            let pairs = nodes.into_iter().map(|node| (node, node, *stiffness)).collect();
            return Ok(Arc::new(GroundSprings::new(pairs, site)));
        };
        let mut all = Vec::new();
        for_each_facet_point(mesh, facets, site.section, |nodes, point| {
            for (&row, N_A) in nodes.iter().zip(point.shapes).filter(|(row, _)| (**row as usize) < n_own) {
                let columns = nodes.iter().zip(point.shapes);
                all.extend(columns.map(|(&column, N_B)| (row, column, stiffness * point.weight * N_A * N_B)));
            }
        });
        all.sort_by_key(|&(row, column, _)| (row, column));
        let mut pairs: Vec<(u32, u32, f64)> = Vec::new();
        for (row, column, stiffness) in all {
            match pairs.last_mut() {
                Some(last) if (last.0, last.1) == (row, column) => last.2 += stiffness,
                _ => pairs.push((row, column, stiffness)),
            }
        }
        Ok(Arc::new(GroundSprings::new(pairs, site)))
    }
}

impl GroundSprings {
    fn new(pairs: Vec<(u32, u32, f64)>, site: &Site<'_>) -> Self {
        let position =
            |&(row, column, _): &(u32, u32, f64)| site.pattern.position(row as usize, column as usize);
        let positions = pairs.iter().filter_map(position).map(|position| position as u32).collect();
        GroundSprings { pairs, positions }
    }
}

impl Force for GroundSprings {
    fn book(&self) -> Book {
        Book::Stored
    }

    fn side(&self) -> Side {
        Side::Outside
    }

    fn assemble(
        &self,
        (step, request): (&StepInput<'_>, Request),
        _: &ForceMemory,
        _: usize,
        _: &mut Scratch,
        sink: &mut RowPart,
    ) -> Result<()> {
        for (&(row, column, stiffness), &position) in self.pairs.iter().zip(&self.positions) {
            if !sink.owns(row) {
                continue;
            }
            for i in 0..step.rule.degree() {
                sink.add_force(i, row, spring_force(stiffness, column as usize, step, i));
            }
            if request == Request::Stress {
                continue;
            }
            for (stages, rate) in step.rule.mean().rates.iter().enumerate() {
                let block = sink.block_mut(position as usize, stages);
                (0..3).for_each(|d| block[4 * d] += step.tangent_factor * stiffness * rate);
            }
        }
        Ok(())
    }

    fn for_each_reaction(
        &self,
        (step, _): (&StepInput<'_>, &ForceMemory),
        stage: usize,
        visit: &mut dyn FnMut(usize, [f64; 3]),
    ) {
        for &(row, column, stiffness) in &self.pairs {
            visit(row as usize, spring_force(stiffness, column as usize, step, stage).map(|f| -f));
        }
    }

    fn add_start_gradient(&self, step: &StepInput<'_>, adjoint: &[f64], gradient: &mut [f64]) {
        let n = step.displacement.len();
        for &(row, column, stiffness) in &self.pairs {
            for d in 0..3 {
                let adjoint = adjoint[3 * row as usize + d..].iter().step_by(n);
                let stages = step.rule.mean().start.iter().zip(adjoint);
                gradient[3 * column as usize + d] +=
                    stiffness * stages.map(|(start, mu)| start * mu).sum::<f64>();
            }
        }
    }

    fn strain_state(&self, displacement: &[f64], _: &[f64]) -> StrainState {
        let at = |node: u32| nodal::at(displacement, node as usize);
        let product = |a: u32, b: u32| at(a).iter().zip(at(b)).map(|(a, b)| a * b).sum::<f64>();
        let energies = self.pairs.iter().map(|&(row, column, k)| 0.5 * k * product(row, column));
        StrainState { strain_energy: energies.sum(), ..StrainState::NONE }
    }
}

/// Stage average of the force of a spring on the ground, by the displacement of a node.
fn spring_force(stiffness: f64, node: usize, step: &StepInput<'_>, stage: usize) -> [f64; 3] {
    let k = step.rule.degree();
    let mean = step.rule.mean();
    let n = step.displacement.len();
    [0, 1, 2].map(|d| {
        let dof = nodal::dof(node, d);
        let rates = (0..k).map(|j| mean.rates[stage * k + j] * step.rates[j * n + dof]);
        stiffness * (mean.start[stage] * step.displacement[dof] + rates.sum::<f64>())
    })
}
