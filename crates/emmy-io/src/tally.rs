//! Balances over a whole run: the worst of each, and how far they add up.

use emmy::body::Body;
use emmy::motion::{Record, View};
use emmy::sparse::SolverChoice;

/// The worst of a quantity, and the step it was in.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Worst {
    /// Its size.
    pub value: f64,
    /// Number of the step.
    pub step: usize,
}

impl Worst {
    fn see(&mut self, value: f64, step: usize) {
        // NaN is the worst of all.
        if value.abs() > self.value || (value.is_nan() && !self.value.is_nan()) {
            *self = Worst { value: value.abs(), step };
        }
    }
}

/// The largest displacement of a node, and where and when it was.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Displacement {
    /// Its norm \[length\].
    pub value: f64,
    /// Number of the step.
    pub step: usize,
    /// Time \[time\].
    pub time: f64,
    /// Index of the node.
    pub node: usize,
    /// The node in the reference configuration.
    pub point: [f64; 3],
}

impl Displacement {
    fn see(&mut self, view: View<'_>) {
        let squares =
            view.state.displacement.as_chunks().0.iter().map(|[x, y, z]: &[f64; 3]| x * x + y * y + z * z);
        let (node, square) =
            squares.enumerate().fold((0, 0.0), |most, own| if own.1 > most.1 { own } else { most });
        if square.sqrt() > self.value {
            let (step, time) = (view.record.step, view.record.time);
            *self = Displacement {
                value: square.sqrt(),
                step,
                time,
                node,
                point: view.body.mesh().points()[node],
            };
        }
    }
}

/// What a run adds up to.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tally {
    /// Number of steps.
    pub steps: usize,
    /// Time reached \[time\].
    pub time: f64,
    /// Newton iterations.
    pub newton_iterations: usize,
    /// Iterations of the linear solver.
    pub linear_iterations: usize,
    /// How often the stiffness that the linear solver works with was made anew.
    pub renewals: usize,
    /// Steps that needed the exact tangent.
    pub steps_with_exact_tangent: usize,
    /// The linear solver of the last step that had one.
    pub solver: Option<SolverChoice>,
    /// Steps that ended at the rounding floor instead of the tolerance.
    pub steps_at_rounding_floor: usize,
    /// What rounding did to energy and momenta, relative to them: the sum over the steps that ended at the rounding floor.
    pub rounding: f64,
    /// Steps that missed a part of a load or a given motion.
    pub unresolved_loads: usize,
    /// Worst defect of a step's energy balance \[energy\].
    pub energy: Worst,
    /// Worst defect of a step's linear momentum balance.
    pub linear_momentum: Worst,
    /// Worst defect of a step's angular momentum balance.
    pub angular_momentum: Worst,
    /// Largest displacement of a node.
    pub displacement: Displacement,
    /// Largest T + |V| \[energy\]: the total energy, but where an attraction makes V negative.
    pub largest_energy: f64,
    /// Largest norm of the linear momentum.
    pub largest_linear_momentum: f64,
    /// Largest norm of the angular momentum.
    pub largest_angular_momentum: f64,
    /// Largest linear momentum that the largest kinetic energy allows, `sqrt(2 T m)`.
    pub linear_momentum_scale: f64,
    /// Largest angular momentum that the largest kinetic energy allows in the reference configuration, `sqrt(2 T I)`.
    pub angular_momentum_scale: f64,
    /// Sum of the energy residuals so far \[energy\].
    pub accumulated_energy: f64,
    /// Sum of the norms of the angular momentum residuals so far, without those that are rounding only.
    pub accumulated_angular_momentum: f64,
    /// Total energy after the last step \[energy\].
    pub total_energy: f64,
    /// Work of the loads since the start \[energy\].
    pub external_work: f64,
    /// What viscosity, drag and the scheme took out of the body since the start \[energy\].
    pub dissipated_energy: f64,
    /// How often a step was cut by two.
    pub cuts: usize,
    /// How often a step was done again because of its error.
    pub refusals: usize,
    /// Supports that were released.
    pub releases: usize,
    /// Steps whose degree is not that of the step before.
    pub degree_changes: usize,
    /// Degree of the last step; 0 before there is one.
    degree: usize,
    largest_kinetic_energy: f64,
}

/// An angular momentum residual below this part of sqrt(2 T I) is rounding: a body that does not turn on the whole has
/// |L| = 0 but for rounding, and no residual could be small next to that.
const ROUNDING: f64 = 1e-13;

impl Tally {
    /// Adds a step, or the start.
    pub fn add(&mut self, view: View<'_>) {
        let record = view.record;
        self.steps = record.step;
        self.time = record.time;
        self.newton_iterations += record.newton_iterations;
        self.linear_iterations += record.linear_iterations;
        self.renewals += record.renewals;
        self.steps_with_exact_tangent += usize::from(record.took_exact_tangent);
        self.solver = record.solver.or(self.solver);
        self.steps_at_rounding_floor += usize::from(record.at_rounding_floor);
        self.rounding = record.rounding;
        self.unresolved_loads += usize::from(record.is_unresolved);
        self.cuts += record.cuts;
        self.refusals += record.refusals;
        self.releases += record.releases;
        self.degree_changes += usize::from(self.degree != 0 && self.degree != record.degree);
        self.degree = record.degree;
        self.energy.see(record.energy_residual, record.step);
        self.linear_momentum.see(record.linear_momentum_residual, record.step);
        self.angular_momentum.see(record.angular_momentum_residual, record.step);
        (self.total_energy, self.external_work) = (record.total_energy, record.external_work);
        self.dissipated_energy = record.dissipated_energy;
        self.displacement.see(view);
        self.add_balances(record, view.body);
    }

    /// All but the solver, for a checkpoint.
    pub(crate) fn numbers(&self) -> [f64; 38] {
        [
            self.steps as f64,
            self.time,
            self.newton_iterations as f64,
            self.linear_iterations as f64,
            self.renewals as f64,
            self.steps_with_exact_tangent as f64,
            self.steps_at_rounding_floor as f64,
            self.energy.value,
            self.energy.step as f64,
            self.linear_momentum.value,
            self.linear_momentum.step as f64,
            self.angular_momentum.value,
            self.angular_momentum.step as f64,
            self.largest_energy,
            self.largest_angular_momentum,
            self.accumulated_energy,
            self.accumulated_angular_momentum,
            self.total_energy,
            self.external_work,
            self.cuts as f64,
            self.releases as f64,
            self.largest_kinetic_energy,
            self.largest_linear_momentum,
            self.linear_momentum_scale,
            self.angular_momentum_scale,
            self.refusals as f64,
            self.dissipated_energy,
            self.degree_changes as f64,
            self.degree as f64,
            self.displacement.value,
            self.displacement.step as f64,
            self.displacement.time,
            self.displacement.node as f64,
            self.displacement.point[0],
            self.displacement.point[1],
            self.displacement.point[2],
            self.rounding,
            self.unresolved_loads as f64,
        ]
    }

    /// The tally of its numbers.
    pub(crate) fn of(n: [f64; 38], solver: Option<SolverChoice>) -> Self {
        let worst = |at: usize| Worst { value: n[at], step: n[at + 1] as usize };
        Tally {
            steps: n[0] as usize,
            time: n[1],
            newton_iterations: n[2] as usize,
            linear_iterations: n[3] as usize,
            renewals: n[4] as usize,
            steps_with_exact_tangent: n[5] as usize,
            solver,
            steps_at_rounding_floor: n[6] as usize,
            energy: worst(7),
            linear_momentum: worst(9),
            angular_momentum: worst(11),
            largest_energy: n[13],
            largest_angular_momentum: n[14],
            accumulated_energy: n[15],
            accumulated_angular_momentum: n[16],
            total_energy: n[17],
            external_work: n[18],
            cuts: n[19] as usize,
            releases: n[20] as usize,
            largest_kinetic_energy: n[21],
            largest_linear_momentum: n[22],
            linear_momentum_scale: n[23],
            angular_momentum_scale: n[24],
            refusals: n[25] as usize,
            dissipated_energy: n[26],
            degree_changes: n[27] as usize,
            degree: n[28] as usize,
            displacement: Displacement {
                value: n[29],
                step: n[30] as usize,
                time: n[31],
                node: n[32] as usize,
                point: [n[33], n[34], n[35]],
            },
            rounding: n[36],
            unresolved_loads: n[37] as usize,
        }
    }

    fn add_balances(&mut self, record: &Record, body: &Body) {
        let norm = |vector: [f64; 3]| vector.iter().map(|v| v * v).sum::<f64>().sqrt();
        self.largest_energy = self.largest_energy.max(record.kinetic_energy + record.strain_energy.abs());
        self.largest_kinetic_energy = self.largest_kinetic_energy.max(record.kinetic_energy);
        self.largest_linear_momentum = self.largest_linear_momentum.max(norm(record.linear_momentum));
        self.largest_angular_momentum = self.largest_angular_momentum.max(norm(record.angular_momentum));
        let mass = body.regions().iter().map(|region| region.mass).sum::<f64>();
        self.linear_momentum_scale = (2.0 * self.largest_kinetic_energy * mass).sqrt();
        self.angular_momentum_scale = (2.0 * self.largest_kinetic_energy * polar_inertia(body)).sqrt();
        self.accumulated_energy += record.energy_residual;
        let residual = record.angular_momentum_residual;
        if residual > ROUNDING * self.angular_momentum_scale || residual.is_nan() {
            self.accumulated_angular_momentum += residual;
        }
    }

    /// Correct digits that rounding leaves of energy and momenta, by the sum over all steps.
    pub fn digits_left(&self) -> f64 {
        -self.rounding.clamp(f64::EPSILON, 1.0).log10()
    }

    /// Accumulated energy residual over the largest T + |V|.
    pub fn energy_drift(&self) -> f64 {
        ratio(self.accumulated_energy.abs(), self.largest_energy)
    }

    /// Accumulated angular momentum residual over the largest |L|.
    pub fn angular_momentum_drift(&self) -> f64 {
        ratio(self.accumulated_angular_momentum, self.largest_angular_momentum)
    }
}

fn ratio(part: f64, whole: f64) -> f64 {
    if part == 0.0 { 0.0 } else { part / whole }
}

/// Integral of density times squared distance from the origin, reference configuration.
fn polar_inertia(body: &Body) -> f64 {
    let of_region = |region: &emmy::body::RegionSummary| {
        let about_centre = (0..3).map(|i| region.inertia[i][i]).sum::<f64>() / 2.0;
        about_centre + region.mass * region.centre.iter().map(|x| x * x).sum::<f64>()
    };
    body.regions().iter().map(of_region).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn worst_keeps_its_step_and_nan_is_worst() {
        let mut worst = Worst::default();
        for (step, value) in [(1, 0.5), (2, -2.0), (3, 1.0)] {
            worst.see(value, step);
        }
        assert_eq!(worst, Worst { value: 2.0, step: 2 });
        worst.see(f64::NAN, 4);
        worst.see(9.0, 5);
        assert!(worst.value.is_nan() && worst.step == 4);
    }
}
