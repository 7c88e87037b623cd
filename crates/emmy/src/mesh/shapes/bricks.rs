//! Shapes of equal bricks and rectangles on a grid.

use super::{CORNERS, check_count, positive};
use crate::error::{Error, Result};
use crate::mesh::{CellKind, Facet, Mesh, MeshBuilder};

/// Box `[0, size]` of equal hex8 cells, groups `body` and `x-min` ... `z-max`.
///
/// `size`: edge lengths \[length\]; `cells`: number of cells along each edge.
///
/// # Errors
/// [`Error::NotPositive`] if an edge or a number of cells is not positive; [`Error::TooManyCells`].
///
/// ```
/// let mesh = emmy::mesh::block([2.0, 8.0, 2.0], [2, 8, 2])?;
/// assert_eq!((mesh.n_nodes(), mesh.n_cells()), (81, 32));
/// # Ok::<(), emmy::Error>(())
/// ```
pub fn block(size: [f64; 3], cells: [usize; 3]) -> Result<Mesh> {
    for i in 0..3 {
        positive("box size", size[i])?;
        positive("number of box cells", cells[i] as f64)?;
    }
    check_count(cells.map(|n| n as f64).iter().product())?;
    let mut grid = Grid::new([0, 1, 2].map(|i| size[i] / cells[i] as f64), cells);
    grid.fill([[0, cells[0]], [0, cells[1]], [0, cells[2]]])?;
    for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
        grid.facet_group(&format!("{letter}-min"), 2 * axis, |cell| cell[axis] == 0);
        grid.facet_group(&format!("{letter}-max"), 2 * axis + 1, |cell| cell[axis] + 1 == cells[axis]);
    }
    grid.build()
}

/// Rectangle `[0, size]` of equal quad4 cells in the plane z = 0, for plane strain; groups `body`, `x-min`, `x-max`,
/// `y-min`, `y-max`.
///
/// `size`: edge lengths \[length\]; `cells`: number of cells along each edge.
///
/// # Errors
/// [`Error::NotPositive`] if an edge or a number of cells is not positive; [`Error::TooManyCells`].
///
/// ```
/// let mesh = emmy::mesh::rectangle([2.0, 8.0], [2, 8])?;
/// assert_eq!((mesh.n_nodes(), mesh.groups().facets("x-max")?.len()), (27, 8));
/// # Ok::<(), emmy::Error>(())
/// ```
pub fn rectangle(size: [f64; 2], cells: [usize; 2]) -> Result<Mesh> {
    for i in 0..2 {
        positive("rectangle size", size[i])?;
        positive("number of rectangle cells", cells[i] as f64)?;
    }
    check_count(cells.map(|n| n as f64).iter().product())?;
    let [dx, dy] = [0, 1].map(|i| size[i] / cells[i] as f64);
    let mut grid = Grid::new([dx, dy, 1.0], [cells[0], cells[1], 0]);
    for i in 0..cells[0] {
        for j in 0..cells[1] {
            grid.cell(CellKind::Quad4, &CORNERS[..4], [i, j, 0])?;
        }
    }
    // Edges of a quadrilateral go round: y-min, x-max, y-max, x-min.
    grid.facet_group("x-min", 3, |cell| cell[0] == 0);
    grid.facet_group("x-max", 1, |cell| cell[0] + 1 == cells[0]);
    grid.facet_group("y-min", 0, |cell| cell[1] == 0);
    grid.facet_group("y-max", 2, |cell| cell[1] + 1 == cells[1]);
    grid.build()
}

/// L-shaped block, the union of `[0,3]x[0,10]x[0,3]` and `[3,6]x[0,3]x[0,3]`, of cubes with edge `cell_size`.
///
/// Groups: `body`, `face-a` (y = 10), `face-b` (x = 6). The edges 3, 10 and 6 ask for a cell size of 1/n.
///
/// ```
/// assert_eq!(emmy::mesh::l_block(0.5)?.n_cells(), 8 * 117);
/// # Ok::<(), emmy::Error>(())
/// ```
///
/// # Errors
/// [`Error::NotPositive`], [`Error::TooManyCells`], or [`Error::CellSize`] if the cell size is not 1/n for a whole
/// number n.
pub fn l_block(cell_size: f64) -> Result<Mesh> {
    positive("cell size", cell_size)?;
    check_count(117.0 / cell_size.powi(3))?;
    let r = (1.0 / cell_size).round() as usize;
    if r == 0 || (cell_size * r as f64 - 1.0).abs() > 1e-6 {
        return Err(Error::CellSize { value: cell_size });
    }
    let mut grid = Grid::new([1.0 / r as f64; 3], [6 * r, 10 * r, 3 * r]);
    grid.fill([[0, 3 * r], [0, 10 * r], [0, 3 * r]])?;
    grid.fill([[3 * r, 6 * r], [0, 3 * r], [0, 3 * r]])?;
    grid.facet_group("face-a", 3, |cell| cell[1] + 1 == 10 * r);
    grid.facet_group("face-b", 1, |cell| cell[0] + 1 == 6 * r);
    grid.build()
}

/// Bricks on a regular grid; nodes are numbered as they are first met.
struct Grid {
    cell_size: [f64; 3],
    builder: MeshBuilder,
    /// Number of points along each edge of the box around all cells.
    n_points: [usize; 3],
    /// Node at each point of the box, or `NO_NODE`.
    node_at: Vec<u32>,
    cells: Vec<[usize; 3]>,
}

const NO_NODE: u32 = u32::MAX;

impl Grid {
    /// A grid of cells of a size, at most `n_cells` along each edge.
    fn new(cell_size: [f64; 3], n_cells: [usize; 3]) -> Self {
        let n_points = n_cells.map(|n| n + 1);
        let node_at = vec![NO_NODE; n_points.into_iter().product()];
        Grid { cell_size, builder: MeshBuilder::new(), n_points, node_at, cells: Vec::new() }
    }

    fn node(&mut self, at: [usize; 3]) -> u32 {
        let [_, m, n] = self.n_points;
        let node = &mut self.node_at[(at[0] * m + at[1]) * n + at[2]];
        if *node == NO_NODE {
            *node = self.builder.point([0, 1, 2].map(|i| at[i] as f64 * self.cell_size[i]));
        }
        *node
    }

    fn fill(&mut self, range: [[usize; 2]; 3]) -> Result<()> {
        for i in range[0][0]..range[0][1] {
            for j in range[1][0]..range[1][1] {
                for k in range[2][0]..range[2][1] {
                    self.cell(CellKind::Hex8, &CORNERS, [i, j, k])?;
                }
            }
        }
        Ok(())
    }

    fn cell(&mut self, kind: CellKind, corners: &[[usize; 3]], at: [usize; 3]) -> Result<()> {
        let nodes: Vec<u32> = corners.iter().map(|c| self.node([0, 1, 2].map(|i| at[i] + c[i]))).collect();
        self.builder.cell(kind, &nodes)?;
        self.cells.push(at);
        Ok(())
    }

    fn facet_group(&mut self, name: &str, local: usize, member: impl Fn([usize; 3]) -> bool) {
        let cells = self.cells.iter().enumerate().filter(|(_, at)| member(**at));
        self.builder
            .facet_group(name, cells.map(|(cell, _)| Facet { cell: cell as u32, local: local as u8 }));
    }

    fn build(mut self) -> Result<Mesh> {
        self.builder.cell_group("body", 0..self.cells.len() as u32);
        self.builder.build()
    }
}
