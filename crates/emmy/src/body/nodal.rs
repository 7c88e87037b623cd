//! Masses and forces at single nodes: point masses, springs to the ground, attraction to points of space.

use std::ops::Range;

use super::geometry::{CellTable, add_facet_areas};
use super::input::{GroundAttraction, GroundSpring, PointMass, PointTerms};
use super::integral::Scratch;
use super::regions::RegionSummary;
use super::solid::SolidTerm;
use super::step::StepInput;
use super::term::{StrainState, Term};
use crate::average::Request;
use crate::error::{Error, Result};
use crate::material::Link;
use crate::mesh::Mesh;
use crate::sparse::{Pattern, RowPart};

/// Point mass of every node, `[n_nodes]`.
pub(super) fn point_masses(mesh: &Mesh, masses: &[PointMass]) -> Result<Vec<f64>> {
    let mut of_node = vec![0.0; mesh.n_nodes()];
    for PointMass { group, mass } in masses {
        if !(*mass > 0.0 && mass.is_finite()) {
            return Err(Error::NotPositive { what: "point mass".into(), value: *mass });
        }
        mesh.group_nodes(group)?.into_iter().for_each(|node| of_node[node as usize] += mass);
    }
    Ok(of_node)
}

/// A node that is free to move in some direction must have a mass.
pub(super) fn check_masses(mesh: &Mesh, lumped_mass: &[f64], fixed: &[bool]) -> Result<()> {
    let is_lost = |node: &usize| lumped_mass[*node] == 0.0 && fixed[3 * node..3 * node + 3].contains(&false);
    match (0..mesh.n_nodes()).find(is_lost) {
        Some(node) => Err(Error::NoMass { node, position: mesh.points()[node] }),
        None => Ok(()),
    }
}

/// Terms of all springs and attractions to the ground at the first `n_own` nodes.
pub(super) fn ground_terms(
    mesh: &Mesh,
    nodal: &PointTerms,
    section: &[f64],
    lumped_mass: &[f64],
    n_own: usize,
) -> Result<Vec<Box<dyn Term>>> {
    let springs = nodal.springs.iter().map(|spring| ground_springs(mesh, spring, section, n_own));
    let attractions = nodal.attractions.iter();
    springs
        .chain(attractions.map(|attraction| ground_attraction(mesh, attraction, lumped_mass, n_own)))
        .collect()
}

/// The first `n_own` nodes of a group; without a name all of them.
fn own_nodes(mesh: &Mesh, group: Option<&str>, n_own: usize) -> Result<Vec<u32>> {
    let mut nodes = match group {
        Some(group) => mesh.group_nodes(group)?,
        None => (0..mesh.n_nodes() as u32).collect(),
    };
    nodes.retain(|&node| (node as usize) < n_own);
    Ok(nodes)
}

/// Mass, centre and inertia of the point masses of a group at the first `n_own` nodes, like a region without cells.
pub(super) fn summary(mesh: &Mesh, mass: &PointMass, n_own: usize) -> Result<RegionSummary> {
    let nodes = own_nodes(mesh, Some(&mass.group), n_own)?;
    let point = |&node: &u32| RegionSummary {
        group: Some(mass.group.clone()),
        n_cells: 0,
        volume: 0.0,
        mass: mass.mass,
        centre: mesh.points()[node as usize],
        inertia: [[0.0; 3]; 3],
    };
    let points: Vec<RegionSummary> = nodes.iter().map(point).collect();
    Ok(RegionSummary { group: Some(mass.group.clone()), ..RegionSummary::combined(&points) })
}

/// Springs to the ground at single nodes: a linear force.
#[derive(Debug)]
struct GroundSprings {
    nodes: Vec<u32>,
    stiffness: Vec<f64>,
    /// Position in the pattern of each node with itself.
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
    let nodes = own_nodes(mesh, Some(group), n_own)?;
    let mut shares = vec![1.0; mesh.n_nodes()];
    if let Ok(facets) = mesh.groups().facets(group) {
        shares.fill(0.0);
        add_facet_areas(mesh, facets, section, &mut shares);
    }
    let stiffness = nodes.iter().map(|&node| stiffness * shares[node as usize]).collect();
    Ok(Box::new(GroundSprings { nodes, stiffness, positions: Vec::new() }))
}

impl Term for GroundSprings {
    fn couplings(&self) -> (&[u32], usize) {
        (&self.nodes, 1)
    }

    fn n_points(&self) -> usize {
        0
    }

    fn attach(&mut self, pattern: &Pattern, _: &[Range<usize>]) {
        let diagonal = |&node: &u32| pattern.position(node as usize, node as usize);
        self.positions = self.nodes.iter().filter_map(diagonal).map(|position| position as u32).collect();
    }

    fn assemble(
        &self,
        step: &StepInput<'_>,
        request: Request,
        _: usize,
        _: &mut Scratch,
        sink: &mut RowPart,
    ) -> Result<()> {
        let springs = self.nodes.iter().zip(&self.stiffness).zip(&self.positions);
        for ((&node, &stiffness), &position) in springs {
            if !sink.owns(node) {
                continue;
            }
            for i in 0..step.rule.degree() {
                sink.add_force(i, node, spring_force(stiffness, node as usize, step, i));
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
        for (&node, &stiffness) in self.nodes.iter().zip(&self.stiffness) {
            visit(node as usize, spring_force(stiffness, node as usize, step, stage));
        }
    }

    fn add_start_gradient(&self, step: &StepInput<'_>, adjoint: &[f64], gradient: &mut [f64]) {
        let n = step.displacement.len();
        for (&node, stiffness) in self.nodes.iter().zip(&self.stiffness) {
            for dof in 3 * node as usize..3 * node as usize + 3 {
                let stages = step.rule.mean().start.iter().zip(adjoint[dof..].iter().step_by(n));
                gradient[dof] += stiffness * stages.map(|(start, mu)| start * mu).sum::<f64>();
            }
        }
    }

    fn strain_state(&self, displacement: &[f64]) -> StrainState {
        let square = |node: u32| displacement[3 * node as usize..][..3].iter().map(|u| u * u).sum::<f64>();
        let energies = self.nodes.iter().zip(&self.stiffness).map(|(&node, k)| 0.5 * k * square(node));
        StrainState { strain_energy: energies.sum(), ..StrainState::NONE }
    }
}

/// Stage average of the force of a spring on the ground.
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
    lumped_mass: &[f64],
    n_own: usize,
) -> Result<Box<dyn Term>> {
    let nodes = own_nodes(mesh, attraction.group.as_deref(), n_own)?;
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
        let strength = attraction.strength * lumped_mass[node as usize];
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
