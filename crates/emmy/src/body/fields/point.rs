//! Stress, strain and energy at a point.

use super::projected::ProjectedKind;
use crate::input::Region;
use crate::material::{Link, Material, VolumeMeasure};
use crate::mesh::Mesh;
use crate::tensor::{Mat3, Sym, det_of_identity_plus, eigen, green_lagrange, identity_plus_times_sym, sym};

/// State of the material at a point, or a mean of several.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct PointState {
    /// W per reference volume.
    pub(super) energy: f64,
    /// Second Piola-Kirchhoff stress.
    pub(super) second: Sym<f64>,
    pub(super) cauchy: Sym<f64>,
    /// Green-Lagrange strain.
    pub(super) strain: Sym<f64>,
    /// J = det F.
    pub(super) volume_ratio: f64,
}

impl PointState {
    /// The state of a region's material at a displacement gradient; NaN if det F is not positive.
    pub(super) fn new(region: &Region, G: &Mat3<f64>) -> Self {
        let J = det_of_identity_plus(G);
        let strain = green_lagrange(G);
        let response = region.material.response(&strain).filter(|_| J > 0.0);
        match response {
            Some((energy, second)) => PointState::of_response(G, J, strain, (energy, second)),
            None => PointState { volume_ratio: J, ..PointState::undefined() },
        }
    }

    fn of_response(G: &Mat3<f64>, J: f64, strain: Sym<f64>, (energy, second): (f64, Sym<f64>)) -> Self {
        let P = identity_plus_times_sym(G, &second);
        let cauchy = sym(|i, j| (P[i][j] + (0..3).map(|k| P[i][k] * G[j][k]).sum::<f64>()) / J);
        PointState { energy, second, cauchy, strain, volume_ratio: J }
    }

    /// The state at a quadrature point of a cell with a projected volume, by theta and the pressure there.
    ///
    /// ```math
    /// W = W_p(E) + U(theta),      S = S_p(E) + pbar dtheta/dE
    /// ```
    pub(super) fn of_projection(kind: &ProjectedKind, G: &Mat3<f64>, (theta, pressure): (f64, f64)) -> Self {
        let J = det_of_identity_plus(G);
        if J.is_nan() || J <= 0.0 {
            return PointState { volume_ratio: J, ..PointState::undefined() };
        }
        let strain = green_lagrange(G);
        let material = kind.points.response::<f64>();
        let mut second = [0.0; 6];
        material.stress(&strain, &mut second);
        let direction = kind.law.measure().direction(&strain);
        second.iter_mut().zip(direction).for_each(|(S, B)| *S += pressure * B);
        let energy = material.strain_energy(&strain) + kind.law.energy(theta);
        PointState::of_response(G, J, strain, (energy, second))
    }

    /// The state of a region's material at a displacement gradient with another volume theta.
    ///
    /// ```math
    /// F' = s F,   s^3 = (1 + theta)/J,      W = W(F'),      sigma = sigma(F')
    /// ```
    ///
    /// If theta is tr E, the trace of E is replaced.
    pub(super) fn with_volume(region: &Region, measure: VolumeMeasure, G: &Mat3<f64>, theta: f64) -> Self {
        let J = det_of_identity_plus(G);
        let strain = green_lagrange(G);
        let (stretched, scale) = with_volume(measure, &strain, theta);
        let is_defined = J > 0.0 && scale.is_finite() && scale > 0.0;
        let Some((energy, second)) = region.material.response(&stretched).filter(|_| is_defined) else {
            return PointState { volume_ratio: J, ..PointState::undefined() };
        };
        let second = second.map(|component| component / scale);
        PointState::of_response(G, J, strain, (energy, second))
    }

    /// The state of a link: for a bar, stresses along its axis with an unchanged cross section; springs and
    /// attractions, which have no volume, have no stress and a volume ratio of 1.
    pub(super) fn of_link(link: &Link, mesh: &Mesh, cell: usize, displacement: &[f64]) -> Self {
        let area = link.area();
        let state = LinkState::new(link, mesh, cell, displacement);
        if area == 0.0 {
            return PointState { volume_ratio: 1.0, ..PointState::default() };
        }
        let along = |axis: [f64; 3], size: f64| sym(|i, j| size * axis[i] * axis[j]);
        let stress = state.force / area;
        PointState {
            energy: state.energy / (area * state.reference_length),
            second: along(state.reference_axis, stress * state.reference_length / state.length),
            cauchy: along(state.axis, stress),
            strain: along(state.reference_axis, state.strain),
            volume_ratio: state.length / state.reference_length,
        }
    }

    fn undefined() -> Self {
        let tensor = [f64::NAN; 6];
        PointState {
            energy: f64::NAN,
            second: tensor,
            cauchy: tensor,
            strain: tensor,
            volume_ratio: f64::NAN,
        }
    }

    /// Adds a multiple of another state.
    pub(super) fn add(&mut self, weight: f64, other: &PointState) {
        self.energy += weight * other.energy;
        self.volume_ratio += weight * other.volume_ratio;
        for component in 0..6 {
            self.second[component] += weight * other.second[component];
            self.cauchy[component] += weight * other.cauchy[component];
            self.strain[component] += weight * other.strain[component];
        }
    }

    /// The state over a number.
    pub(super) fn over(self, weight: f64) -> Self {
        let over = |tensor: Sym<f64>| tensor.map(|component| component / weight);
        PointState {
            energy: self.energy / weight,
            second: over(self.second),
            cauchy: over(self.cauchy),
            strain: over(self.strain),
            volume_ratio: self.volume_ratio / weight,
        }
    }

    /// Square roots of the eigenvalues of `C = I + 2 E`, the largest first.
    pub(super) fn principal_stretches(&self) -> [f64; 3] {
        // Rounding may take a stretch of nearly zero below it.
        let mut stretches = eigen(&self.strain).0.map(|e| (1.0 + 2.0 * e).max(0.0).sqrt());
        if self.strain[0].is_nan() {
            return [f64::NAN; 3];
        }
        stretches.sort_by(|a, b| b.total_cmp(a));
        stretches
    }
}

/// A strain with another volume, and the factor s of its deformation gradient: `C' = s^2 C`; without cancellation at
/// small strain.
fn with_volume(measure: VolumeMeasure, strain: &Sym<f64>, theta: f64) -> (Sym<f64>, f64) {
    let diagonal = |component: usize| if component < 3 { 1.0 } else { 0.0 };
    let change = measure.change(strain);
    let component = |value: &dyn Fn(usize) -> f64| [0, 1, 2, 3, 4, 5].map(value);
    match measure {
        VolumeMeasure::Ratio => {
            let excess = ((theta.ln_1p() - change.ln_1p()) / 3.0).exp_m1();
            let square = excess * (2.0 + excess);
            (component(&|c| strain[c] + square * (strain[c] + 0.5 * diagonal(c))), 1.0 + excess)
        }
        VolumeMeasure::Trace => (component(&|c| strain[c] + (theta - change) / 3.0 * diagonal(c)), 1.0),
    }
}

/// Equivalent stress of von Mises, by differences of the normal stresses: a pressure leaves nothing.
///
/// ```math
/// sqrt(3/2 s : s) = sqrt( ((xx - yy)^2 + (yy - zz)^2 + (zz - xx)^2)/2 + 3 (xy^2 + yz^2 + xz^2) )
/// ```
pub(super) fn von_mises(stress: &Sym<f64>) -> f64 {
    let square = |i: usize, j: usize| (stress[i] - stress[j]).powi(2);
    let shears: f64 = stress[3..].iter().map(|s| s * s).sum();
    (0.5 * (square(0, 1) + square(1, 2) + square(2, 0)) + 3.0 * shears).sqrt()
}

/// Force in a link, positive in tension.
///
/// ```math
/// N = dV/dl = dV/d(tr E) l/L^2
/// ```
pub(super) fn axial_force(link: &Link, mesh: &Mesh, cell: usize, displacement: &[f64]) -> f64 {
    LinkState::new(link, mesh, cell, displacement).force
}

/// A link as it is stretched.
struct LinkState {
    reference_axis: [f64; 3],
    axis: [f64; 3],
    reference_length: f64,
    length: f64,
    /// `tr E = (l^2/L^2 - 1)/2`.
    strain: f64,
    /// Of the whole link.
    energy: f64,
    force: f64,
}

impl LinkState {
    fn new(link: &Link, mesh: &Mesh, cell: usize, displacement: &[f64]) -> Self {
        let [a, b] = [0, 1].map(|end| mesh.cell(cell).nodes[end] as usize);
        let span = [0, 1, 2].map(|i| mesh.points()[b][i] - mesh.points()[a][i]);
        let change = [0, 1, 2].map(|i| displacement[3 * b + i] - displacement[3 * a + i]);
        let now = [0, 1, 2].map(|i| span[i] + change[i]);
        let [reference_length, length] = [span, now].map(|x| x.iter().map(|x| x * x).sum::<f64>().sqrt());
        let square = reference_length * reference_length;
        let strain = (0..3).map(|i| (span[i] + 0.5 * change[i]) * change[i]).sum::<f64>() / square;
        let law = link.with_length(reference_length);
        let E = [strain, 0.0, 0.0, 0.0, 0.0, 0.0];
        LinkState {
            reference_axis: span.map(|x| x / reference_length),
            axis: now.map(|x| x / length),
            reference_length,
            length,
            strain,
            energy: law.strain_energy(&E),
            force: law.stress(&E)[0] * length / square,
        }
    }
}
