//! Built-in shapes: a block of bricks, a rectangle, the L-shaped block of Betsch and Steinmann (2001), Section 5, a
//! ring, a cylinder and a ball.

mod bricks;
mod round;

pub use bricks::{block, l_block, rectangle};
pub use round::{FEWEST_AROUND, ball, ball_count, cylinder, cylinder_count, ring};

#[cfg(test)]
use super::Mesh;
use crate::error::{Error, Result};

/// Largest number of cells of a built-in shape: more are probably a typing error, and would not fit into memory.
pub const MAX_CELLS: f64 = 2e7;

/// Checks the number of cells of a built-in shape before it is made.
///
/// # Errors
/// [`Error::TooManyCells`].
pub fn check_count(count: f64) -> Result<()> {
    if count <= MAX_CELLS { Ok(()) } else { Err(Error::TooManyCells { count }) }
}

fn positive(what: &str, value: f64) -> Result<()> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(Error::NotPositive { what: what.to_string(), value })
}

/// Corners of the hexahedron in VTK order.
const CORNERS: [[usize; 3]; 8] =
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn end_faces_of_the_l_block_lie_where_the_paper_loads_it() {
        let mesh = l_block(0.5).unwrap();
        assert_eq!(mesh.n_cells(), 8 * 117);
        for node in mesh.group_nodes("face-a").unwrap() {
            assert_eq!(mesh.points()[node as usize][1], 10.0);
        }
        assert_eq!(mesh.group_nodes("face-b").unwrap().len(), 49);
        for node in mesh.group_nodes("face-b").unwrap() {
            assert_eq!(mesh.points()[node as usize][0], 6.0);
        }
    }

    #[test]
    fn box_groups_are_its_six_faces() {
        let mesh = block([2.0, 8.0, 3.0], [2, 4, 3]).unwrap();
        let count = |name| mesh.groups().facets(name).unwrap().len();
        assert_eq!(["x-min", "x-max", "y-min", "y-max", "z-min", "z-max"].map(count), [12, 12, 6, 6, 8, 8]);
        for node in mesh.group_nodes("z-max").unwrap() {
            assert_eq!(mesh.points()[node as usize][2], 3.0);
        }
    }

    #[test]
    fn rectangle_groups_are_its_four_edges() {
        let mesh = rectangle([2.0, 8.0], [3, 5]).unwrap();
        for (name, axis, value, n) in
            [("x-min", 0, 0.0, 5), ("x-max", 0, 2.0, 5), ("y-min", 1, 0.0, 3), ("y-max", 1, 8.0, 3)]
        {
            assert_eq!(mesh.groups().facets(name).unwrap().len(), n);
            for node in mesh.group_nodes(name).unwrap() {
                assert!((mesh.points()[node as usize][axis] - value).abs() < 1e-15, "{name}");
            }
        }
    }

    #[test]
    fn shapes_of_more_cells_than_memory_are_rejected_at_once() {
        let count = |made: Result<Mesh>| match made {
            Err(Error::TooManyCells { count }) => count,
            other => panic!("{other:?}"),
        };
        assert_eq!(count(block([1.0; 3], [1000; 3])), 1e9);
        assert_eq!(count(block([1.0; 3], [usize::MAX; 3])), (2f64.powi(64)).powi(3));
        assert_eq!(count(rectangle([1.0; 2], [5000, 4001])), 20_005_000.0);
        assert!((count(l_block(1e-9)) / 117e27 - 1.0).abs() < 1e-12);
        assert_eq!(
            block([1.0; 3], [1000; 3]).unwrap_err().to_string(),
            "this makes 1.0e9 cells; the limit is 2e7"
        );
    }

    #[test]
    fn sizes_must_be_positive() {
        assert!(rectangle([1.0, -1.0], [1, 1]).is_err());
        assert!(block([1.0, -1.0, 1.0], [1, 1, 1]).is_err());
        assert!(block([1.0, 1.0, 1.0], [1, 0, 1]).is_err());
        assert!(l_block(f64::NAN).is_err());
        assert_eq!(l_block(0.3).unwrap_err(), Error::CellSize { value: 0.3 });
        assert!(l_block(0.333333333).is_ok());
    }
}
