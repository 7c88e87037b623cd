//! Dead loads of a body over a step and at a time; resultants of all loads.

use super::system::Body;
use crate::average::Rule;
use crate::error::Result;
use crate::force::LoadMemory;
use crate::input::NotFinite;

/// Resultant of a load at factor 1 in the reference configuration.
///
/// ```
/// use emmy::prelude::*;
/// let body = Body::builder(mesh::block([2.0, 1.0, 1.0], [1; 3])?)
///     .region(Region::new(NeoHooke::new(1000.0, 500.0)?, 1.0))
///     .load(Load::traction("x-max", [0.0, 0.0, 3.0]))
///     .build()?;
/// let resultant = body.load_resultants()[0];
/// assert!((resultant.force[2] - 3.0).abs() < 1e-14 && (resultant.torque[1] + 6.0).abs() < 1e-14);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadResultant {
    /// Force \[force\].
    pub force: [f64; 3],
    /// Torque about the origin \[force length\].
    pub torque: [f64; 3],
}

impl Body {
    /// Memory for the evaluation of the dead loads in a number of stages.
    pub(crate) fn load_memory(&self, n_stages: usize) -> LoadMemory {
        LoadMemory::new(n_stages, &self.fields)
    }

    /// Stage averages of the dead loads over a step, exact for every kink of the time functions; fields are integrated
    /// by [`Rule::smooth_quadrature`].
    ///
    /// ```math
    /// f_i^ext = (1/b_i) integral_0^1 l_i F_ext dalpha
    /// ```
    ///
    /// `force: [k][n_nodes][3]`; `memory`: for k stages. Returns whether any load acts.
    ///
    /// # Errors
    /// [`crate::Error::NotFiniteAt`].
    pub(crate) fn stage_loads(
        &self,
        rule: &Rule,
        time: f64,
        step_size: f64,
        memory: &mut LoadMemory,
        force: &mut [f64],
    ) -> Result<bool> {
        force.fill(0.0);
        let mut acts = false;
        for load in self.loads.iter() {
            let averages = load.time_function.averages(time, step_size, rule, &mut memory.of_stages);
            averages.map_err(|found| load.not_finite(found))?;
            for (&factor, force) in memory.of_stages.iter().zip(force.chunks_exact_mut(self.n_dofs())) {
                if factor != 0.0 {
                    acts = true;
                    force.iter_mut().zip(&load.force).for_each(|(sum, f)| *sum += factor * f);
                }
            }
        }
        for field in self.fields.iter() {
            // A field may fail at a point of one rank alone; whether it acts depends on the time alone.
            acts |= self.agree(field.add_averages(time, step_size, rule, memory, force))?;
        }
        Ok(acts)
    }

    /// The first time after another at which the time function of a load or a driven support has a kink or a jump; of
    /// the kinks of a measured table only the corners count.
    pub(crate) fn next_corner(&self, after: f64) -> Option<f64> {
        let loads = self.loads.iter().map(|load| &load.time_function);
        let fields = self.fields.iter().map(|field| &field.time_function);
        let pressures = self.pressures.iter().map(|pressure| &pressure.time_function);
        let drives = self.drives.iter().flat_map(|drive| drive.time_functions());
        let all = loads.chain(fields).chain(pressures).chain(drives);
        all.filter_map(|time_function| time_function.next_corner(after)).min_by(f64::total_cmp)
    }

    /// Dead loads at a time (after a jump of a time function at this time), `force: [n_nodes][3]`. Returns whether any
    /// load acts.
    ///
    /// # Errors
    /// [`crate::Error::NotFiniteAt`].
    pub fn loads_at(&self, time: f64, force: &mut [f64]) -> Result<bool> {
        self.set_loads_at(time, &mut self.load_memory(1), force)
    }

    /// [`Body::loads_at`] without allocation.
    pub(crate) fn set_loads_at(&self, time: f64, memory: &mut LoadMemory, force: &mut [f64]) -> Result<bool> {
        force.fill(0.0);
        let mut acts = false;
        for load in self.loads.iter() {
            let factor = load.time_function.value(time);
            if !factor.is_finite() {
                return Err(load.not_finite(NotFinite { time, value: factor }));
            }
            if factor != 0.0 {
                acts = true;
                force.iter_mut().zip(&load.force).for_each(|(sum, f)| *sum += factor * f);
            }
        }
        for field in self.fields.iter() {
            acts |= self.agree(field.add_at(time, memory, force))?;
        }
        Ok(acts)
    }

    /// The first load by a field that is not a finite number at one of its points between two times: its number, the point
    /// and the time. 1000 times are tried at a few points, fewer at all of them; a costly field is tried at the start only.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// use emmy::body::Field;
    /// let field = Field::new(|X, t| [X[0] / (t - 0.5), 0.0, 0.0]);
    /// let load = Load::new(LoadKind::BodyForceField { group: None, field });
    /// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 1.0);
    /// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).load(load).build()?;
    /// assert!(matches!(body.field_not_finite(0.0, 1.0), Some((0, _, 0.5))));
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn field_not_finite(&self, start: f64, end: f64) -> Option<(usize, [f64; 3], f64)> {
        self.fields.iter().find_map(|field| {
            let found = field.find_not_finite([start, end]);
            let (X, time) = self.of_lowest_rank(found)?;
            Some((field.load, X, time))
        })
    }

    /// Resultant of every load at factor 1 in the reference configuration; for a field, with its time function, at t =
    /// 0, or NaN if it is not finite there.
    pub fn load_resultants(&self) -> Vec<LoadResultant> {
        let rest = vec![0.0; self.n_dofs()];
        let resultant =
            |force: &[f64]| LoadResultant { force: self.sum(force), torque: self.moment(&rest, force) };
        let mut resultants: Vec<(usize, LoadResultant)> =
            self.loads.iter().map(|load| (load.load, resultant(&load.force))).collect();
        for field in self.fields.iter() {
            let mut force = rest.clone();
            if field.add_at(0.0, &mut self.load_memory(1), &mut force).is_err() {
                force.fill(f64::NAN);
            }
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
