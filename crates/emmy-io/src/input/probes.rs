//! Probes: the nodes nearest to their points.

use emmy::internals::number::{short, short_vector};
use emmy::mesh::Mesh;

use super::settings::Probe;

/// Distance between a probe's point and its node, relative to the size of the mesh, above which there is a remark.
const FAR: f64 = 1e-6;

/// Finds the node of every probe, with a note if it is not at the requested point.
pub(super) fn find(mesh: &Mesh, probes: &mut [Probe], notes: &mut Vec<String>) {
    let size = size(mesh);
    for probe in probes {
        probe.node = mesh.nearest_node(probe.point);
        let at = mesh.points()[probe.node];
        let distance = (0..3).map(|i| (at[i] - probe.point[i]).powi(2)).sum::<f64>().sqrt();
        if distance > FAR * size {
            notes.push(format!(
                "probe `{}`: the nearest node, {}, is {} away, at {}",
                probe.name,
                probe.node,
                short(distance),
                short_vector(at)
            ));
        }
    }
}

/// Diagonal of the box around the mesh.
fn size(mesh: &Mesh) -> f64 {
    let extent = |i: usize| {
        let coordinates = mesh.points().iter().map(|point| point[i]);
        let (low, high) =
            coordinates.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        high - low
    };
    (0..3).map(|i| extent(i).powi(2)).sum::<f64>().sqrt()
}
