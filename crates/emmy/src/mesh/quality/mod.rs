//! Quality of the cells of a mesh in the reference configuration.

mod sample;
#[cfg(test)]
mod tests;

use crate::error::{Error, Result};
use crate::mesh::{Cell, Mesh};
use sample::Measures;
pub(super) use sample::samples;

/// The worst value of a measure and its cell.
///
/// ```
/// // The second cell is the flat one.
/// let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [4.0, 1.0, 0.0]];
/// let mesh = emmy::mesh::Mesh::from_cells(emmy::mesh::CellKind::Quad4, &points, &[[0, 1, 4, 3], [1, 2, 5, 4]])?;
/// assert_eq!(emmy::mesh::quality(&mesh).aspect_ratio, emmy::mesh::Worst { value: 3.0, cell: 1 });
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Worst {
    /// The value.
    pub value: f64,
    /// Index of the first cell with this value.
    pub cell: usize,
}

/// Quality of a mesh: the worst cell by each of three measures, the volume, the inverted cells.
///
/// ```
/// let mesh = emmy::mesh::block([2.0, 1.0, 1.0], [1, 1, 1])?;
/// let quality = emmy::mesh::quality(&mesh);
/// assert_eq!((quality.aspect_ratio.value, quality.volume), (2.0, 2.0));
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Quality {
    /// Smallest det(dX/dxi) of a cell, at its quadrature points and nodes, divided by its mean over the cell: 1 for a
    /// parallelepiped, a straight tetrahedron, or a pyramid over a parallelogram; less if faces are warped or curved;
    /// not positive if the map folds. (In a pyramid det is constant along a ray from the apex. At the apex, where it
    /// has no single value, the ray along the axis is taken.) In a plane det is the determinant in the two coordinates.
    pub jacobian_ratio: Worst,
    /// Smallest volume spanned by the three edges at a corner, divided by the product of their lengths, relative to the
    /// cell with equal edges (cube, regular tetrahedron, ...): 1 at best, near zero for a flat cell. At the apex of a
    /// pyramid, every three successive edges count; in a plane, it is the area spanned by two edges. Source: Knupp
    /// (2000), IJNME 48, 1165-1185.
    pub scaled_jacobian: Worst,
    /// Largest ratio of the longest to the shortest edge of a cell (distance of the corners).
    pub aspect_ratio: Worst,
    /// Total volume \[length^3\]; of plane cells the area, of links the length.
    pub volume: f64,
    /// Cells whose det(dX/dxi) is not positive at one of their quadrature points, ascending.
    pub inverted: Vec<usize>,
}

/// Quality of the cells of a mesh, inverted ones included.
///
/// ```
/// let quality = emmy::mesh::quality(&emmy::mesh::l_block(1.0)?);
/// assert_eq!((quality.volume, quality.inverted.len()), (117.0, 0));
/// # Ok::<(), emmy::Error>(())
/// ```
pub fn quality(mesh: &Mesh) -> Quality {
    let cells: Vec<usize> = (0..mesh.n_cells()).collect();
    quality_of(mesh, &cells)
}

/// Quality of some cells, at least one.
///
/// ```
/// use emmy::internals::mesh::quality_of;
/// let mesh = emmy::mesh::l_block(1.0)?;
/// assert_eq!(quality_of(&mesh, &[7, 8]).aspect_ratio, emmy::mesh::Worst { value: 1.0, cell: 7 });
/// # Ok::<(), emmy::Error>(())
/// ```
pub fn quality_of(mesh: &Mesh, cells: &[usize]) -> Quality {
    let samples = samples();
    let cell_of = |index: usize| mesh.cell(cells[index]);
    let measure = |cell: Cell| samples[&cell.kind].measures(&positions(mesh, cell));
    let measures: Vec<Measures> = (0..cells.len()).map(|index| measure(cell_of(index))).collect();
    let own = |worst: Worst| Worst { cell: cells[worst.cell], ..worst };
    let smallest = |measure: fn(&Measures) -> f64| own(worst(measures.iter().map(measure), |a, b| a < b));
    let largest = |measure: fn(&Measures) -> f64| own(worst(measures.iter().map(measure), |a, b| a > b));
    Quality {
        jacobian_ratio: smallest(|measures| measures.jacobian_ratio),
        scaled_jacobian: smallest(|measures| measures.scaled_jacobian),
        aspect_ratio: largest(|measures| measures.aspect_ratio),
        volume: measures.iter().map(|measures| measures.volume).sum(),
        inverted: (0..cells.len())
            .filter(|&index| measures[index].is_inverted())
            .map(|index| cells[index])
            .collect(),
    }
}

/// Checks that no cell is inverted or degenerate.
///
/// # Errors
/// [`Error::InvertedCell`] with the first cell whose det(dX/dxi) is not positive at one of its quadrature points,
/// [`Error::NotFinite`] if it overflows.
///
/// ```
/// let mesh = emmy::mesh::l_block(1.0)?;
/// assert_eq!(emmy::mesh::check(&mesh), Ok(()));
/// # Ok::<(), emmy::Error>(())
/// ```
pub fn check(mesh: &Mesh) -> Result<()> {
    let samples = samples();
    for (index, cell) in mesh.cells().enumerate() {
        let measures = samples[&cell.kind].measures(&positions(mesh, cell));
        let is_huge = |cell: Cell| positions(mesh, cell).iter().flatten().any(|x| x.abs() > HUGE);
        if !(measures.smallest_det.is_finite() && measures.volume.is_finite()) && is_huge(cell) {
            let what = format!("the volume of cell {index} ({})", cell.kind);
            return Err(Error::NotFinite { what, value: measures.volume });
        }
        if measures.is_inverted() {
            return Err(Error::InvertedCell { cell: index, kind: cell.kind, det: measures.smallest_det });
        }
    }
    Ok(())
}

/// Coordinates above this may have volumes that overflow.
const HUGE: f64 = 1e100;

fn positions(mesh: &Mesh, cell: Cell) -> Vec<[f64; 3]> {
    cell.nodes.iter().map(|&node| mesh.points()[node as usize]).collect()
}

/// First value that is worse than all before; NaN is the worst.
fn worst(values: impl Iterator<Item = f64>, is_worse: impl Fn(f64, f64) -> bool) -> Worst {
    let values = values.enumerate().map(|(cell, value)| Worst { value, cell });
    let is_worse = |b: f64, a: f64| is_worse(b, a) || (b.is_nan() && !a.is_nan());
    let worse = |a: Worst, b: Worst| if is_worse(b.value, a.value) { b } else { a };
    values.reduce(worse).expect("a mesh has cells")
}
