//! Forces of the ground: springs, and attraction to points of space.

use std::ops::Range;

use super::integral::Scratch;
use super::solid::SolidTerm;
use super::step::StepInput;
use super::term::{StrainState, Term};
use crate::average::Request;
use crate::error::{Error, Result};
use crate::input::{GroundAttraction, GroundSpring, PointTerms};
use crate::mass::points::own_nodes;
use crate::material::Link;
use crate::mesh::Mesh;
use crate::space::CellTable;
use crate::space::geometry::for_each_facet_point;
use crate::sparse::{Pattern, RowPart};

/// Terms of all springs and attractions to the ground at the first `n_own` nodes; `masses`: those that are attracted,
/// `[n_nodes]`.
pub(crate) fn ground_terms(
    mesh: &Mesh,
    nodal: &PointTerms,
    section: &[f64],
    masses: &[f64],
    n_own: usize,
) -> Result<Vec<Box<dyn Term>>> {
    let springs = nodal.springs.iter().map(|spring| ground_springs(mesh, spring, section, n_own));
    let attractions = nodal.attractions.iter();
    springs.chain(attractions.map(|attraction| ground_attraction(mesh, attraction, masses, n_own))).collect()
}

/// Springs to the ground: a linear force.
#[derive(Debug)]
struct GroundSprings {
    /// Node of the force, node of the displacement, and the stiffness between them; ascending.
    pairs: Vec<(u32, u32, f64)>,
    /// Position of each pair in the pattern.
    positions: Vec<u32>,
}

/// Term of the springs of a group.
fn ground_springs(
    mesh: &Mesh,
    spring: &GroundSpring,
    section: &[f64],
    n_own: usize,
) -> Result<Box<dyn Term>> {
    let GroundSpring { group, stiffness } = spring;
    if !(*stiffness > 0.0 && stiffness.is_finite()) {
        return Err(Error::NotPositive { what: "stiffness of springs".into(), value: *stiffness });
    }
    let nodes = own_nodes(mesh, group, n_own)?;
    let Ok(facets) = mesh.groups().facets(group) else {
        let pairs = nodes.into_iter().map(|node| (node, node, *stiffness)).collect();
        return Ok(Box::new(GroundSprings { pairs, positions: Vec::new() }));
    };
    let mut all = Vec::new();
    for_each_facet_point(mesh, facets, section, |nodes, point| {
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
    Ok(Box::new(GroundSprings { pairs, positions: Vec::new() }))
}

impl Term for GroundSprings {
    fn couplings(&self) -> (&[u32], usize) {
        // Those of the cells.
        (&[], 1)
    }

    fn n_points(&self) -> usize {
        0
    }

    fn attach(&mut self, pattern: &Pattern, _: &[Range<usize>]) {
        let position = |&(row, column, _): &(u32, u32, f64)| pattern.position(row as usize, column as usize);
        self.positions = self.pairs.iter().filter_map(position).map(|position| position as u32).collect();
    }

    fn assemble(
        &self,
        step: &StepInput<'_>,
        request: Request,
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

    fn for_each_spring_force(
        &self,
        step: &StepInput<'_>,
        stage: usize,
        visit: &mut dyn FnMut(usize, [f64; 3]),
    ) {
        for &(row, column, stiffness) in &self.pairs {
            visit(row as usize, spring_force(stiffness, column as usize, step, stage));
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

    fn strain_state(&self, displacement: &[f64]) -> StrainState {
        let at = |node: u32| &displacement[3 * node as usize..][..3];
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
        let dof = 3 * node + d;
        let rates = (0..k).map(|j| mean.rates[stage * k + j] * step.rates[j * n + dof]);
        stiffness * (mean.start[stage] * step.displacement[dof] + rates.sum::<f64>())
    })
}

/// Term of an attraction: links from the masses to a fixed point.
///
/// Source of the potential: Newton's law of gravitation.
fn ground_attraction(
    mesh: &Mesh,
    attraction: &GroundAttraction,
    masses: &[f64],
    n_own: usize,
) -> Result<Box<dyn Term>> {
    let mut nodes = match &attraction.group {
        Some(group) => mesh.volume_nodes(group)?,
        None => (0..mesh.n_nodes() as u32).collect(),
    };
    nodes.retain(|&node| (node as usize) < n_own);
    let (mut gradients, mut energies) = (Vec::new(), Vec::new());
    for &node in &nodes {
        let X = mesh.points()[node as usize];
        let c = attraction.centre;
        let r = [0, 1, 2].map(|i| X[i] - c[i]);
        let square: f64 = r.iter().map(|x| x * x).sum();
        if square == 0.0 || !square.is_finite() {
            return Err(Error::NotPositive {
                what: "distance of a mass from the centre of attraction".into(),
                value: square,
            });
        }
        // The gradient of the shape function of the moving end, along the first coordinate: t/L.
        gradients.push([r.map(|x| x / square), [0.0; 3], [0.0; 3]]);
        // A node without mass has no attraction: a strength of zero is invalid.
        let strength = attraction.strength * masses[node as usize];
        energies.push(
            Link::attraction(if strength == 0.0 { f64::MIN_POSITIVE } else { strength })?
                .with_length(square.sqrt()),
        );
    }
    let table = CellTable {
        cells: vec![0; nodes.len()],
        n_nodes: 1,
        n_modes: 0,
        mode_gradients: Vec::new(),
        reference_gradients: vec![[1.0, 0.0, 0.0]],
        inverse_jacobians: gradients,
        weights: vec![1.0; nodes.len()],
        nodes,
    };
    Ok(Box::new(SolidTerm::links(energies, table)?))
}
