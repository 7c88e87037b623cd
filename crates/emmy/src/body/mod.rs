//! The body: the semidiscrete Hamiltonian system of section 2. Terms, mass, loads, supports, invariants.

#![allow(non_snake_case)]

mod geometry;
mod history;
mod input;
mod invariants;
mod loads;
mod mass;
mod regions;
mod solid;
mod term;

use std::ops::Range;

pub use geometry::CellTable;
pub use history::History;
pub use input::{InitialVelocity, Load, LoadKind, Region, Support};
pub use invariants::sum;
pub use loads::LoadResultant;
pub use mass::MassSolver;
pub use regions::RegionSummary;
pub use solid::Scratch;
pub use term::{StepInput, Term};

use loads::LoadVector;
use rayon::prelude::*;
use regions::RegionOfCell;

use crate::average::Want;
use crate::error::{Error, Result};
use crate::mesh::Mesh;
use crate::sparse::{Pattern, StageMatrix, nested_dissection};

/// An elastic body, discretised in space: everything but its state of motion.
///
/// ```
/// use emmy::{body::{Body, Region}, material::NeoHooke, mesh};
/// let rubber = NeoHooke::new(1000.0, 500.0)?;
/// let body = Body::new(mesh::l_block(1.0)?, vec![Region::new(None, 0.5, rubber)], &[], &[])?;
/// assert!((body.regions()[0].mass - 0.5 * 117.0).abs() < 1e-12);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug)]
pub struct Body {
    mesh: Mesh,
    regions: Vec<RegionSummary>,
    region_of_cell: Vec<u32>,
    terms: Vec<Box<dyn Term>>,
    pattern: Pattern,
    parts: Vec<Range<usize>>,
    node_order: Vec<usize>,
    mass: Vec<f64>,
    lumped_mass: Vec<f64>,
    fixed: Vec<bool>,
    loads: Vec<LoadVector>,
}

impl Body {
    /// The body of a mesh. Nodes of plane cells are fixed along z.
    ///
    /// # Errors
    /// [`Error::UnknownGroup`], [`Error::RegionCover`] if the regions do not cover the cells, [`Error::NotPositive`]
    /// for a density, [`Error::InvertedCell`], [`Error::NotFinite`] for a load, [`Error::Linear`].
    pub fn new(mesh: Mesh, regions: Vec<Region>, supports: &[Support], loads: &[Load]) -> Result<Self> {
        let of_cell = RegionOfCell::new(&mesh, &regions)?;
        let mut terms = regions::terms(&mesh, &regions, &of_cell)?;
        let couplings = terms.iter().flat_map(|term| {
            let (nodes, length) = term.couplings();
            nodes.chunks_exact(length)
        });
        let pattern = Pattern::new(mesh.n_nodes(), couplings);
        // One part a thread; fewer where there is too little to share.
        let n_parts = rayon::current_num_threads().min(mesh.n_nodes() / 64).max(1);
        let parts = pattern.divided(n_parts);
        terms.iter_mut().for_each(|term| term.attach(&pattern, &parts));
        let section = of_cell.sections(&mesh, &regions);
        let density_of_cell = of_cell.densities(&mesh, &regions);
        let loads = loads.iter().map(|load| LoadVector::new(&mesh, load, &section, &density_of_cell));
        Ok(Body {
            loads: loads.collect::<Result<_>>()?,
            fixed: fixed_dofs(&mesh, supports)?,
            mass: regions::mass(&mesh, &pattern, &density_of_cell),
            lumped_mass: regions::lumped_mass(&mesh, &density_of_cell),
            regions: regions::summaries(&mesh, &regions, &of_cell),
            region_of_cell: of_cell.into_indices(),
            node_order: nested_dissection(&pattern)?,
            terms,
            pattern,
            parts,
            mesh,
        })
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Number of degrees of freedom, fixed ones included.
    pub fn n_dofs(&self) -> usize {
        self.mesh.n_dofs()
    }

    /// Number of degrees of freedom that are not fixed.
    pub fn n_free_dofs(&self) -> usize {
        self.fixed.iter().filter(|fixed| !**fixed).count()
    }

    /// Which degrees of freedom are fixed, `[n_nodes][3]`.
    pub fn fixed(&self) -> &[bool] {
        &self.fixed
    }

    /// Volume, mass, centre and inertia of each region.
    pub fn regions(&self) -> &[RegionSummary] {
        &self.regions
    }

    /// Region of each cell.
    pub fn region_of_cell(&self) -> &[u32] {
        &self.region_of_cell
    }

    /// Couplings between nodes.
    pub fn pattern(&self) -> &Pattern {
        &self.pattern
    }

    /// Consistent mass matrix M_AB, one number a coupling of the pattern \[mass\].
    pub fn mass(&self) -> &[f64] {
        &self.mass
    }

    /// Lumped mass, one number a node \[mass\].
    ///
    /// Row sums of the consistent mass for linear cells. Row sums of quadratic cells are negative at corners; there the
    /// diagonal of a cell's consistent mass is scaled to the mass of the cell (Hinton, Rock and Zienkiewicz 1976):
    ///
    /// ```math
    /// m_A = sum_cells m_cell M_AA / sum_B M_BB
    /// ```
    pub fn lumped_mass(&self) -> &[f64] {
        &self.lumped_mass
    }

    /// Fill-reducing order of the nodes, `order[new] = old`.
    pub fn node_order(&self) -> &[usize] {
        &self.node_order
    }

    /// Memory for the assembly with time elements of a degree.
    pub fn assembly(&self, degree: usize) -> Assembly {
        let n_nodes = self.mesh.cells().map(|cell| cell.nodes.len()).max().unwrap_or(0);
        let part = || Part { scratch: Scratch::new(degree, n_nodes), outcome: Ok(()) };
        Assembly {
            matrix: StageMatrix::new(&self.pattern, &self.parts, degree),
            parts: self.parts.iter().map(|_| part()).collect(),
        }
    }

    /// Stage averages of the internal force; with [`Want::Tangent`] also the stage matrix
    /// `mass_coefficients_ij M + tangent_factor df_i/dx_j`.
    ///
    /// # Errors
    /// [`Error::Inverted`] if a cell is turned inside out.
    pub fn assemble(
        &self,
        step: &StepInput<'_>,
        want: Want,
        mass_coefficients: &[f64],
        assembly: &mut Assembly,
    ) -> Result<()> {
        let rows = assembly.matrix.parts_mut();
        let work = |(index, (sink, part)): (usize, (&mut crate::sparse::RowPart, &mut Part))| {
            sink.clear_force();
            if want == Want::Tangent {
                sink.set_blocks(&self.mass, mass_coefficients);
            }
            let mut terms = self.terms.iter();
            part.outcome =
                terms.try_for_each(|term| term.assemble(step, want, index, &mut part.scratch, sink));
        };
        if rows.len() == 1 {
            rows.iter_mut().zip(&mut assembly.parts).enumerate().for_each(work);
        } else {
            rows.par_iter_mut().zip(&mut assembly.parts).enumerate().for_each(work);
        }
        assembly.parts.iter().try_for_each(|part| part.outcome.clone())
    }

    /// Momentum and velocity of an initial velocity field: `(p, v)`, both `[n_nodes][3]`; fixed components do not move.
    ///
    /// # Errors
    /// [`Error::UnknownGroup`], [`Error::NotFinite`].
    pub fn initial_motion(&self, fields: &[InitialVelocity]) -> Result<(Vec<f64>, Vec<f64>)> {
        let mut velocity = vec![0.0; self.n_dofs()];
        for field in fields {
            let nodes = match &field.group {
                Some(name) => self.mesh.group_nodes(name)?,
                None => (0..self.mesh.n_nodes() as u32).collect(),
            };
            for node in nodes {
                let v = field.at(self.mesh.points()[node as usize]);
                if let Some(&value) = v.iter().find(|value| !value.is_finite()) {
                    return Err(Error::NotFinite { what: "initial velocity".into(), value });
                }
                velocity[3 * node as usize..3 * node as usize + 3].copy_from_slice(&v);
            }
        }
        velocity.iter_mut().zip(&self.fixed).filter(|(_, fixed)| **fixed).for_each(|(v, _)| *v = 0.0);
        let mut momentum = vec![0.0; self.n_dofs()];
        self.mass_product(&velocity, &mut momentum);
        Ok((momentum, velocity))
    }
}

/// Stage forces and matrix of a body, with the working memory of their assembly.
#[derive(Debug)]
pub struct Assembly {
    /// Forces and matrix.
    pub matrix: StageMatrix,
    parts: Vec<Part>,
}

#[derive(Debug)]
struct Part {
    scratch: Scratch,
    outcome: Result<()>,
}

fn fixed_dofs(mesh: &Mesh, supports: &[Support]) -> Result<Vec<bool>> {
    let mut fixed = vec![false; mesh.n_dofs()];
    fix_planes(mesh, &mut fixed);
    for support in supports {
        for node in mesh.group_nodes(&support.group)? {
            (0..3).for_each(|i| fixed[3 * node as usize + i] |= support.fix[i]);
        }
    }
    Ok(fixed)
}

/// Plane strain: nodes of plane cells do not leave the plane.
fn fix_planes(mesh: &Mesh, fixed: &mut [bool]) {
    for cell in mesh.cells().filter(|cell| cell.kind.dimension() == 2) {
        cell.nodes.iter().for_each(|&node| fixed[3 * node as usize + 2] = true);
    }
}
