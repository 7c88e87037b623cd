//! Surface elements without solid cells that do not lie in a plane z = const.

use std::path::Path;

use emmy::internals::number::short;

use super::MeshError;

/// The surface elements of a file.
#[derive(Debug, Default)]
pub(super) struct Surfaces {
    /// Whether there are triangles, and quadrilaterals.
    pub(super) has: [bool; 2],
    /// Their nodes.
    pub(super) points: Vec<[f64; 3]>,
}

impl Surfaces {
    /// The error for a node with another z than the first one, with advice for surfaces in another plane and for other
    /// surfaces.
    pub(super) fn error(
        &self,
        file: &Path,
        node: &str,
        [z, plane]: [f64; 2],
        advice: [&'static str; 2],
    ) -> MeshError {
        let found = match self.has {
            [true, false] => "triangles",
            [false, _] => "quadrilaterals",
            [true, true] => "triangles and quadrilaterals",
        };
        let place = format!("{node} is at z = {} and the first one at z = {}", short(z), short(plane));
        let [turn, other] = advice;
        let advice = if self.are_flat() { turn } else { other };
        MeshError::SurfaceAlone { file: file.to_path_buf(), found, place, advice }
    }

    /// Whether all lie in one plane.
    fn are_flat(&self) -> bool {
        let Some(&origin) = self.points.first() else { return false };
        let from = |point: &[f64; 3]| [0, 1, 2].map(|i| point[i] - origin[i]);
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let longest = |vectors: &mut dyn Iterator<Item = [f64; 3]>| {
            vectors.max_by(|&a, &b| dot(a, a).total_cmp(&dot(b, b))).unwrap_or_default()
        };
        let edge = longest(&mut self.points.iter().map(from));
        let normal = longest(&mut self.points.iter().map(|point| cross(edge, from(point))));
        let bound = 1e-9 * dot(normal, normal).sqrt() * dot(edge, edge).sqrt();
        bound > 0.0 && self.points.iter().all(|point| dot(normal, from(point)).abs() <= bound)
    }
}
