//! Planes of symmetry: the component that they fix.

use crate::error::{Error, Result};
use crate::mesh::Mesh;

/// Facets lie in one plane if their distances from it do not exceed this part of the size of the mesh.
const FLAT: f64 = 1e-9;

/// The axis that is normal to the plane of a facet group.
///
/// # Errors
/// [`Error::UnknownGroup`], [`Error::Support`] unless all facets lie in one plane normal to a coordinate axis.
///
/// ```
/// let mesh = emmy::mesh::block([1.0, 2.0, 1.0], [1, 2, 1])?;
/// assert_eq!(emmy::internals::body::symmetry_axis(&mesh, "y-min")?, 1);
/// # Ok::<(), emmy::Error>(())
/// ```
pub fn symmetry_axis(mesh: &Mesh, group: &str) -> Result<usize> {
    let [least, most] = mesh.facet_bounds(group)?;
    // The plane of a plane mesh is not a plane of symmetry of its edges.
    let axes = if mesh.is_plane() { 0..2 } else { 0..3 };
    let size = mesh.extent().into_iter().fold(0.0, f64::max);
    let flat: Vec<usize> = axes.filter(|&axis| most[axis] - least[axis] <= FLAT * size).collect();
    match flat[..] {
        [axis] => Ok(axis),
        _ => {
            let reason = "a plane of symmetry must be normal to the x, y or z axis, and all facets of the group must lie in \
                          it; oblique planes are not supported";
            Err(Error::Support { group: group.to_string(), reason: reason.to_string() })
        }
    }
}
