//! Arrays of the frames at the nodes of the surface.

use crate::report::fields::ColourField;
use crate::report::surface::Surface;
use crate::vector::{Vector, minus, norm};

/// The nodes of the surface, by which arrays of the frames are read.
#[derive(Debug)]
pub(super) struct Nodal {
    /// Index in the mesh of each node.
    nodes: Vec<u32>,
    /// Whether a node has values. Beside a surface, those of links alone have none: most are the axes of rigid bodies.
    has_values: Vec<bool>,
    /// Reference positions.
    points: Vec<Vector>,
}

impl Nodal {
    /// The nodes of a surface. `points`: of the mesh.
    pub(super) fn new(points: &[Vector], surface: &Surface) -> Self {
        let own = surface.nodes.iter().map(|&node| points[node as usize]).collect();
        let mut has_values = vec![surface.triangles.is_empty(); surface.nodes.len()];
        surface.triangles.iter().flatten().for_each(|&node| has_values[node as usize] = true);
        Nodal { nodes: surface.nodes.clone(), has_values, points: own }
    }

    /// Reference positions.
    pub(super) fn points(&self) -> &[Vector] {
        &self.points
    }

    /// Values of a field from its array; NaN where there are none.
    pub(super) fn values(&self, field: &ColourField, array: &[f64]) -> Vec<f64> {
        let n = field.array.1;
        let value = |(&node, has): (&u32, &bool)| {
            let own = array.get(n * node as usize..)?.get(..n)?;
            has.then(|| (field.value)(own))
        };
        self.nodes.iter().zip(&self.has_values).map(|own| value(own).unwrap_or(f64::NAN)).collect()
    }

    /// Displacements from their array; NaN where there are none.
    pub(super) fn displacements(&self, array: &[f64]) -> Vec<Vector> {
        let (vectors, _) = array.as_chunks();
        self.nodes.iter().map(|&node| vectors.get(node as usize).copied().unwrap_or([f64::NAN; 3])).collect()
    }

    /// Lengths of what a mode adds to the body at rest, relative to the largest; NaN where there are no values.
    pub(super) fn lengths_of_mode(&self, displacements: &[Vector], at_rest: &[Vector]) -> Vec<f64> {
        let added = displacements.iter().zip(at_rest).zip(&self.has_values);
        let lengths = added.map(|((&u, &rest), has)| if *has { norm(minus(u, rest)) } else { f64::NAN });
        let lengths: Vec<f64> = lengths.collect();
        let largest = lengths.iter().copied().fold(0.0, f64::max);
        lengths.into_iter().map(|length| length / largest).collect()
    }

    /// Positions with a displacement.
    pub(super) fn moved(&self, displacements: &[Vector]) -> Vec<Vector> {
        self.points.iter().zip(displacements).map(|(x, u)| [0, 1, 2].map(|i| x[i] + u[i])).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::fields::MOTION;

    #[test]
    fn links_beside_a_surface_have_no_values() {
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 5.0]];
        let links = Surface { nodes: vec![0, 3], links: vec![[0, 1]], ..Surface::default() };
        // Node 3 of the mesh is the third of the surface.
        let surface = Surface {
            nodes: vec![0, 1, 3, 2],
            triangles: vec![[0, 1, 3]],
            links: vec![[0, 2]],
            ..Surface::default()
        };
        let array: Vec<f64> = [[3.0, 4.0, 0.0], [0.0; 3], [0.0, 0.0, 2.0], [0.0, 9.0, 0.0]].concat();
        let values = |surface: &Surface| Nodal::new(&points, surface).values(&MOTION, &array);
        assert_eq!(values(&links), [5.0, 9.0]);
        let own = values(&surface);
        assert_eq!((own[0], own[1], own[3]), (5.0, 0.0, 2.0));
        assert!(own[2].is_nan());
        let nodal = Nodal::new(&points, &surface);
        assert_eq!(nodal.moved(&nodal.displacements(&array))[2], [0.0, 9.0, 5.0]);
        // A frame without the array has no values.
        assert!(nodal.values(&MOTION, &[]).iter().all(|value| value.is_nan()));
        assert!(nodal.displacements(&array[..9])[2].iter().all(|u| u.is_nan()));
    }
}
