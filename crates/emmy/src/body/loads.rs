//! Dead loads of a body over a step and at a time; resultants of all loads.

use super::{Body, sum};
use crate::average::Rule;

/// Resultant of a load at factor 1 in the reference configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadResultant {
    /// Force \[force\].
    pub force: [f64; 3],
    /// Torque about the origin \[force length\].
    pub torque: [f64; 3],
}

impl Body {
    /// Stage averages of the dead loads over a step, exact for every kink of the time functions; fields are integrated
    /// by [`Rule::smooth_quadrature`].
    ///
    /// ```math
    /// f_i^ext = (1/b_i) integral_0^1 l_i F_ext dalpha
    /// ```
    ///
    /// `force: [k][n_nodes][3]`; `averages`: memory for k numbers. Returns whether any load acts.
    pub fn stage_loads(
        &self,
        rule: &Rule,
        time: f64,
        step_size: f64,
        averages: &mut [f64],
        force: &mut [f64],
    ) -> bool {
        force.fill(0.0);
        let mut acts = false;
        for load in self.loads.iter() {
            load.time_function.averages(time, step_size, rule, averages);
            for (&factor, force) in averages.iter().zip(force.chunks_exact_mut(self.n_dofs())) {
                if factor != 0.0 {
                    acts = true;
                    force.iter_mut().zip(&load.force).for_each(|(sum, f)| *sum += factor * f);
                }
            }
        }
        for field in self.fields.iter() {
            acts |= field.add_averages(time, step_size, rule, averages, force);
        }
        acts
    }

    /// The first time after another at which the time function of a load or a driven support has a kink or a jump.
    pub fn next_kink(&self, after: f64) -> Option<f64> {
        let loads = self.loads.iter().map(|load| &load.time_function);
        let fields = self.fields.iter().map(|field| &field.time_function);
        let pressures = self.pressures.iter().map(|pressure| &pressure.time_function);
        let drives = self.drives.iter().flat_map(|drive| drive.time_functions());
        let all = loads.chain(fields).chain(pressures).chain(drives);
        all.filter_map(|time_function| time_function.next_kink(after)).min_by(f64::total_cmp)
    }

    /// Dead loads at a time (after a jump of a time function at this time), `force: [n_nodes][3]`. Returns whether any
    /// load acts.
    pub fn loads_at(&self, time: f64, force: &mut [f64]) -> bool {
        force.fill(0.0);
        let mut acts = false;
        for load in self.loads.iter() {
            let factor = load.time_function.value(time);
            if factor != 0.0 {
                acts = true;
                force.iter_mut().zip(&load.force).for_each(|(sum, f)| *sum += factor * f);
            }
        }
        for field in self.fields.iter() {
            acts |= field.add_at(time, force);
        }
        acts
    }

    /// Resultant of every load at factor 1 in the reference configuration; for a field, with its time function, at t =
    /// 0.
    pub fn load_resultants(&self) -> Vec<LoadResultant> {
        let rest = vec![0.0; self.n_dofs()];
        let resultant =
            |force: &[f64]| LoadResultant { force: sum(force), torque: self.moment(&rest, force) };
        let mut resultants: Vec<(usize, LoadResultant)> =
            self.loads.iter().map(|load| (load.load, resultant(&load.force))).collect();
        for field in self.fields.iter() {
            let mut force = rest.clone();
            field.add_at(0.0, &mut force);
            resultants.push((field.load, resultant(&force)));
        }
        for pressure in self.pressures.iter() {
            let mut force = rest.clone();
            pressure.add_force(&self.mesh, &rest, 1.0, &mut force);
            resultants.push((pressure.load, resultant(&force)));
        }
        resultants.sort_by_key(|(load, _)| *load);
        resultants.into_iter().map(|(_, resultant)| resultant).collect()
    }
}
