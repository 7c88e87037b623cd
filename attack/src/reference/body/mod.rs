//! The body: energies, forces of time elements and of single configurations, masses and loads.

mod averages;
mod cell;
mod forces;
mod loads;

use super::element::Element;
use super::energies::{Energy, Tensor};
use super::history::History;
use super::mesh::{Item, Mesh};
use super::numbers::{Matrix, lagrange_integral, plus};

const UNIT: Tensor = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// A dead load: nodal forces with a factor over time.
#[derive(Debug, Clone)]
pub struct Dead {
    /// Force at each degree of freedom, at points of the body with their own function of time if it is a wave.
    pub parts: Vec<(Vec<f64>, Wave)>,
    /// Factor over time.
    pub history: History,
}

/// Factor `cos(phase + rate t)` of a part of a load.
#[derive(Debug, Clone, Copy)]
pub struct Wave {
    /// Phase.
    pub phase: f64,
    /// Angular frequency.
    pub rate: f64,
}

/// A wave that is 1.
pub const STEADY: Wave = Wave { phase: 0.0, rate: 0.0 };

impl Dead {
    /// The force at a time; `is_before`: before a jump.
    pub fn at(&self, t: f64, is_before: bool) -> Vec<f64> {
        let t_side = if is_before { t - 1e-12 } else { t };
        let factor = self.history.at(t_side);
        let mut force = vec![0.0; self.parts[0].0.len()];
        for (part, wave) in &self.parts {
            let own = factor * (wave.phase + wave.rate * t).cos();
            force.iter_mut().zip(part).for_each(|(sum, f)| *sum += own * f);
        }
        force
    }
}

/// Attraction of nodes to a point.
#[derive(Debug, Clone)]
pub struct Attraction {
    /// The point.
    pub centre: [f64; 3],
    /// Strength times mass of each node.
    pub strengths: Vec<f64>,
}

/// A point of a cell.
#[derive(Debug, Clone)]
struct Point {
    weight: f64,
    gradients: Vec<[f64; 3]>,
}

/// A cell of the body.
#[derive(Debug, Clone)]
pub struct Cell {
    /// Nodes, then internal ones.
    nodes: Vec<usize>,
    points: Vec<Point>,
    /// Projection of a field at the points.
    projection: Option<Matrix>,
    /// Part of the volume's energy that stays at the points.
    share: f64,
    material: Material,
    /// Whether it is in the group `two`.
    pub is_second: bool,
    /// Points of the mass: weight times density, and shape functions.
    mass_points: Vec<(f64, Vec<f64>)>,
    /// Functions of the lumped mass at the same points: shape functions, or their scaled squares in quadratic cells.
    lumped_shapes: Vec<Vec<f64>>,
}

/// Formulation of cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Formulation {
    /// As it is.
    Standard,
    /// Constant pressure.
    Constant,
    /// Linear pressure.
    Linear,
    /// Incompatible modes.
    Modes,
}

/// Material of a region.
#[derive(Debug, Clone)]
pub struct Material {
    /// Energy.
    pub energy: Energy,
    /// Density.
    pub density: f64,
    /// Viscosity: time, shear, bulk.
    pub viscosity: [f64; 3],
    /// Formulation.
    pub formulation: Formulation,
}

/// Forces of a step.
#[derive(Debug, Clone)]
pub struct StageForces {
    /// Forces of cells, springs and attractions at each stage.
    pub internal: Vec<Vec<f64>>,
    /// The part of springs.
    pub springs: Vec<Vec<f64>>,
    /// The part of attractions.
    pub attraction: Vec<Vec<f64>>,
    /// Energy that viscosity and the dissipation of strains take.
    pub dissipated: f64,
}

/// A body.
#[derive(Debug, Clone)]
pub struct Body {
    /// Reference positions of the nodes.
    pub points: Vec<[f64; 3]>,
    /// Number of nodes with internal ones.
    pub n_all: usize,
    /// Whether it is plane.
    pub is_plane: bool,
    /// Thickness of a plane body.
    pub thickness: f64,
    /// Cells.
    pub cells: Vec<Cell>,
    /// Consistent mass, with point masses.
    pub mass: Matrix,
    /// Lumped mass, with point masses.
    pub lumped: Vec<f64>,
    /// Rate of the drag.
    pub drag: f64,
    /// Springs to the ground: matrices between nodes.
    pub springs: Vec<(usize, usize, f64)>,
    /// Attraction to a point.
    pub attraction: Option<Attraction>,
    /// Dead loads.
    pub dead: Vec<Dead>,
    /// Pressure with its history on facets.
    pub pressure: Option<(Vec<Item>, f64, History)>,
}

/// A point in a deformed cell.
#[derive(Debug, Clone)]
pub struct PointState {
    /// Its volume.
    pub weight: f64,
    /// Deformation gradient.
    pub f: Tensor,
    /// Energy per volume.
    pub energy: f64,
    /// Second stress of Piola and Kirchhoff.
    pub stress: Tensor,
    /// det F.
    pub ratio: f64,
}

/// Path of the assumed strain at a point.
struct Path {
    start: Tensor,
    f: Vec<Tensor>,
    rates: Vec<Tensor>,
}

impl Path {
    fn strain(&self, element: &Element, alpha: f64) -> Tensor {
        let twice = |j: usize| 2.0 * lagrange_integral(&element.c, j, alpha);
        self.rates.iter().enumerate().fold(self.start, |c, (j, rate)| plus(&c, twice(j), rate))
    }
}

/// Average of a stage at a point.
struct Averaged {
    f: Tensor,
    strain_rate: Tensor,
    stress: Tensor,
    /// Rate of the projected volume, and the tensor N of the own volume.
    volume: Option<(f64, Tensor)>,
}

impl Body {
    /// A body of a mesh; the second material is that of the group `two`.
    pub fn new(mesh: &Mesh, materials: &[Material; 2]) -> Self {
        let n = mesh.points.len();
        let mut n_all = n;
        let mut cells = Vec::new();
        for (item, &is_second) in mesh.cells.iter().zip(&mesh.is_second) {
            let material = &materials[usize::from(is_second)];
            let cell = Cell::new(item, mesh, material, n_all, is_second);
            n_all += cell.nodes.len() - item.nodes.len();
            cells.push(cell);
        }
        let mut mass = vec![vec![0.0; n]; n];
        let mut lumped = vec![0.0; n];
        for cell in &cells {
            for (weight, _, functions) in cell.load_points(true) {
                functions.iter().zip(&cell.nodes).for_each(|(own, &node)| lumped[node] += weight * own);
            }
            for (weight, shapes) in &cell.mass_points {
                for i in 0..shapes.len() {
                    for j in 0..shapes.len() {
                        mass[cell.nodes[i]][cell.nodes[j]] += weight * shapes[i] * shapes[j];
                    }
                }
            }
        }
        Body {
            points: mesh.points.clone(),
            n_all,
            is_plane: mesh.is_plane(),
            thickness: mesh.thickness,
            cells,
            mass,
            lumped,
            drag: 0.0,
            springs: Vec::new(),
            attraction: None,
            dead: Vec::new(),
            pressure: None,
        }
    }

    /// Number of nodes without internal ones.
    pub fn n_nodes(&self) -> usize {
        self.points.len()
    }

    /// Row sums of the consistent mass.
    pub fn row_sums(&self) -> Vec<f64> {
        self.mass.iter().map(|row| row.iter().sum()).collect()
    }
}
