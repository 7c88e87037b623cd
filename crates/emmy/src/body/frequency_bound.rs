//! An upper bound of the largest natural frequency from the cells alone, without a matrix.

use super::system::Body;
use crate::element::{Jacobians, element};
use crate::force::ContactSummary;
use crate::input::{Region, RegionMaterial};
use crate::mesh::{Cell, CellKind, Mesh};
use crate::space::geometry::{ReferenceTable, inverse, positions};
use crate::sparse::largest_eigenvalue;
use crate::tensor::{Mat3, det, dot3, mat3};

impl Body {
    /// Upper bound of `omega_max^2`, the largest eigenvalue of `M^-1 K` with the lumped mass M and the stiffness K at
    /// rest \[1/time^2\]; `None` if the body has links, incompatible modes, ties, or springs and attractions to the
    /// ground.
    ///
    /// The largest eigenvalue of a body is at most that of one of its cells (Fried 1972), and that of a cell at most
    ///
    /// ```math
    /// (c / rho) L max_q(|J_q^-1|^2 det J_q) / j
    /// ```
    ///
    /// with the largest eigenvalue c of the elasticity at rest, the spectral norm of the inverse Jacobians at the
    /// points q of the strain energy, the largest eigenvalue L of the Laplacian in the reference cell with its lumped
    /// mass, and the least factor j from a lumped mass there to one here. It is exact for a single cube.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let rubber = Region::new(SaintVenantKirchhoff::new(0.0, 8.0)?, 2.0); // Young's modulus 16, no lateral strain
    /// let body = Body::builder(mesh::block([1.0; 3], [2; 3])?).region(rubber).build()?;
    /// let bound = body.frequency_bound()?.unwrap();
    /// assert!((bound - (2.0 * 8f64.sqrt() / 0.5).powi(2)).abs() < 1e-10); // (2 c / h)^2, c^2 = E / rho
    /// # Ok::<(), emmy::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`crate::Error::Linear`] if an eigenvalue is not found; [`crate::Error::NotOnTeam`].
    pub fn frequency_bound(&self) -> crate::Result<Option<f64>> {
        self.space.check_whole("a bound of the frequencies")?;
        let has_links = self.made_of.iter().any(|region| region.link().is_some());
        if has_links || self.has_ground() || !self.space.internal_dofs().is_empty() || self.has_ties() {
            return Ok(None);
        }
        let stiffness = self.made_of.iter().map(specific_stiffness).collect::<crate::Result<Vec<_>>>()?;
        let mut kinds: [Option<Reference>; CellKind::ALL.len()] = Default::default();
        let mut largest: f64 = 0.0;
        for (cell, &region) in self.mesh().cells().zip(&self.region_of_cell) {
            let own = &mut kinds[cell.kind as usize];
            let reference = match own {
                Some(reference) => reference,
                None => own.insert(Reference::new(cell.kind)?),
            };
            let stiffness = stiffness[region as usize];
            largest = largest.max(stiffness * reference.factor(self.mesh(), cell, largest / stiffness));
        }
        Ok(Some(largest))
    }

    /// Upper bound of what contact adds to `omega_max^2` with the lumped mass while its layers are half as thick as at
    /// rest \[1/time^2\], for nodes of linear facets; `None` without contact.
    ///
    /// A layer has the stiffness psi'' over its area a, of which each node has a part. With the shares N_A of the nodes
    /// in a point, `(sum_A N_A x_A)^2 <= sum_A N_A x_A^2`, so that the parts of the nodes bound the whole:
    ///
    /// ```math
    /// max_A psi'' a_A / m_A
    /// ```
    pub(crate) fn contact_frequency_bound(&self) -> Option<f64> {
        let rest = vec![0.0; self.n_dofs()];
        let mut stiffness = vec![0.0; self.mesh().n_nodes()];
        let contacts = self.forces_of_contact();
        for force in &contacts {
            let own = force.contact().map_or(0.0, ContactSummary::stiffness_at_half);
            force.for_each_contact_node(&rest, &mut |node, at_node| stiffness[node] += own * at_node.area);
        }
        let nodes = stiffness.iter().zip(self.lumped_mass()).enumerate();
        let is_free = |node: usize| self.fixed()[3 * node..3 * node + 3].contains(&false);
        let parts = nodes.filter(|(node, (_, mass))| **mass > 0.0 && is_free(*node)).map(|(_, (k, m))| k / m);
        (!contacts.is_empty()).then(|| parts.fold(0.0, f64::max))
    }
}

/// Largest eigenvalue of the elasticity at rest, as a form in the strain tensor, over the density.
fn specific_stiffness(region: &Region) -> crate::Result<f64> {
    let RegionMaterial::Solid(material) = &region.material else { return Ok(0.0) };
    let (mut stress, mut elasticity) = ([0.0; 6], [[0.0; 6]; 6]);
    material.response::<f64>().stress_and_elasticity(&[0.0; 6], &mut stress, &mut elasticity);
    // A doubled shear strain stands for two components.
    let scale = |a: usize| if a < 3 { 1.0 } else { std::f64::consts::SQRT_2 };
    let form: Vec<f64> =
        (0..36).map(|at| elasticity[at / 6][at % 6] * scale(at / 6) * scale(at % 6)).collect();
    Ok(largest_eigenvalue(&form)? / region.density)
}

/// The reference cell of a kind.
struct Reference {
    kind: CellKind,
    /// Largest eigenvalue of the Laplacian with the lumped mass.
    laplacian: f64,
    at_energy: Jacobians,
    at_mass: Jacobians,
    weights_of_mass: Vec<f64>,
    /// Determinants of the Jacobians of a cell, at the points of the mass.
    dets: Vec<f64>,
}

/// Relative difference that is rounding.
const ROUNDING: f64 = 1e-12;

impl Reference {
    fn new(kind: CellKind) -> crate::Result<Self> {
        let n = kind.n_nodes();
        let energy = ReferenceTable::new(element(kind), element(kind).quadrature(), n);
        let mass = ReferenceTable::new(element(kind), element(kind).mass_quadrature(), n);
        let sum = |of: &dyn Fn(usize) -> f64| -> f64 {
            (0..mass.weights.len()).map(|q| mass.weights[q] * of(q)).sum()
        };
        let own = |a: usize| match is_linear(kind) {
            true => sum(&|q| mass.shapes_at(q)[a]),
            false => sum(&|q| mass.shapes_at(q)[a].powi(2)),
        };
        let shares: Vec<f64> = (0..n).map(own).collect();
        let scale = sum(&|_| 1.0) / shares.iter().sum::<f64>();
        let lumped: Vec<f64> = shares.iter().map(|share| share * scale).collect();
        let dot = |q: usize, a: usize, b: usize| -> f64 {
            let gradients = energy.gradients_at(q);
            (0..3).map(|i| gradients[a][i] * gradients[b][i]).sum()
        };
        let entry = |a: usize, b: usize| -> f64 {
            let entry = (0..energy.weights.len()).map(|q| energy.weights[q] * dot(q, a, b)).sum::<f64>();
            entry / (lumped[a] * lumped[b]).sqrt()
        };
        let matrix: Vec<f64> = (0..n * n).map(|at| entry(at / n, at % n)).collect();
        Ok(Reference {
            kind,
            laplacian: largest_eigenvalue(&matrix)?,
            at_energy: Jacobians::new(kind, &energy.points),
            at_mass: Jacobians::new(kind, &mass.points),
            weights_of_mass: mass.weights,
            dets: Vec::new(),
        })
    }

    /// Bound of a cell, with c / rho = 1; 0 if it is at most a known one.
    fn factor(&mut self, mesh: &Mesh, cell: Cell<'_>, known: f64) -> f64 {
        let X = positions(mesh, cell.nodes);
        self.at_mass.dets(&X, &mut self.dets);
        let (mut least, mut most, mut volume, mut reference) = (f64::INFINITY, 0f64, 0.0, 0.0);
        for (&weight, &det) in self.weights_of_mass.iter().zip(&self.dets) {
            (least, most) = (least.min(det), most.max(det));
            volume += weight * det;
            reference += weight;
        }
        let mass = if is_linear(self.kind) { least } else { volume / reference * least / most };
        let of_known = known * mass / self.laplacian;
        let mut stiffness = of_known;
        for J in self.at_energy.of(&X) {
            // J^-1 times det J.
            let mut adjugate = inverse(&J, 1.0);
            if self.kind.dimension() == 2 {
                // Nothing changes across the plane.
                adjugate[2] = [0.0; 3];
            }
            let (gram, det) = (gram(&adjugate), det(&J));
            // The largest sum of a row is never smaller, and cheaper.
            if largest_row_sum(&gram) > stiffness * det * (1.0 + ROUNDING) {
                stiffness = stiffness.max(largest_root(&gram) / det);
            }
        }
        if stiffness > of_known { self.laplacian * stiffness / mass } else { 0.0 }
    }
}

fn is_linear(kind: CellKind) -> bool {
    kind.n_corners() == kind.n_nodes()
}

/// `A A^T`, whose largest eigenvalue is the square of the spectral norm of A.
fn gram(A: &Mat3<f64>) -> Mat3<f64> {
    mat3(|i, j| dot3(A[i], A[j]))
}

/// Largest sum of the absolute values of a row.
fn largest_row_sum(A: &Mat3<f64>) -> f64 {
    A.iter().map(|row| row[0].abs() + row[1].abs() + row[2].abs()).fold(0.0, f64::max)
}

/// Largest eigenvalue of a symmetric matrix, by the roots of its characteristic polynomial.
fn largest_root(A: &Mat3<f64>) -> f64 {
    let mean = (A[0][0] + A[1][1] + A[2][2]) / 3.0;
    let rest: Mat3<f64> = [0, 1, 2].map(|i| [0, 1, 2].map(|j| A[i][j] - if i == j { mean } else { 0.0 }));
    let size = (rest.iter().flatten().map(|x| x * x).sum::<f64>() / 6.0).sqrt();
    if size == 0.0 {
        return mean;
    }
    let third = det(&rest.map(|row| row.map(|x| x / size))) / 2.0;
    mean + 2.0 * size * (third.clamp(-1.0, 1.0).acos() / 3.0).cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn norms_are_largest_singular_values() {
        let square = |A: &Mat3<f64>| {
            let gram = gram(A);
            assert!(largest_row_sum(&gram) >= largest_root(&gram) * (1.0 - 1e-14));
            largest_root(&gram)
        };
        assert_eq!(square(&[[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]]), 4.0);
        // A rotation by 30 degrees of a stretch with 3, 1, 1/2.
        let (s, c) = (0.5, 0.75f64.sqrt());
        let A = [[3.0 * c, -s, 0.0], [3.0 * s, c, 0.0], [0.0, 0.0, 0.5]];
        assert!((square(&A) - 9.0).abs() < 1e-14);
        assert!((square(&[[0.0, 7.0, 0.0], [0.0; 3], [0.0; 3]]) - 49.0).abs() < 1e-13);
    }
}
