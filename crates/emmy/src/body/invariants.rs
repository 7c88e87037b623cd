//! Energies and momenta of a state (section 2).

use super::Body;

/// Sum of a nodal vector, `[n_nodes][3]`.
pub fn sum(vector: &[f64]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for v in vector.chunks_exact(3) {
        (0..3).for_each(|i| sum[i] += v[i]);
    }
    sum
}

impl Body {
    /// Moment `sum_A q_A x v_A` about the origin of a nodal vector at a displacement, both `[n_nodes][3]`.
    pub fn moment(&self, displacement: &[f64], vector: &[f64]) -> [f64; 3] {
        let mut moment = [0.0; 3];
        let nodes = self.mesh().points().iter().zip(displacement.chunks_exact(3)).zip(vector.chunks_exact(3));
        for ((X, u), v) in nodes {
            let q = [X[0] + u[0], X[1] + u[1], X[2] + u[2]];
            moment[0] += q[1] * v[2] - q[2] * v[1];
            moment[1] += q[2] * v[0] - q[0] * v[2];
            moment[2] += q[0] * v[1] - q[1] * v[0];
        }
        moment
    }

    /// Strain energy V of a displacement, with the potential of springs and attractions to the ground \[energy\].
    pub fn strain_energy(&self, displacement: &[f64]) -> f64 {
        self.terms.iter().chain(self.ground.iter()).map(|term| term.strain_energy(displacement)).sum()
    }
}
